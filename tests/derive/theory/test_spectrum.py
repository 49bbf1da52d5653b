"""A second opinion on the frequency domain: every step as a reader understands it, with numbers, at plants.

The plants satisfy what a step rests on and are otherwise free, so that a step which holds names all that it needs.
"""

from __future__ import annotations

from collections import defaultdict
from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from scipy.integrate import quad

from derive.context import Declared, DeclaredFact
from derive.derivation import Erratum, check
from derive.functions import Limit, Log, Max
from derive.kernel import Rejected
from derive.spectral import RealPart, Total
from derive.terms import Equation, Number, Product, Term, Trace
from derive.theory import kalman_bucy, spectrum
from tests.derive.theory.mutants import judged, mutants, swapped_in, walk
from tests.reference.spectrum_plants import Plant, plants, satisfied, world
from tests.reference.spectrum_values import TOLERANCE, NoValueError, Place, World, gap, integral, sides

CLOSE, APART = TOLERANCE, 1e-3
PLANTS = {plant.name: plant for plant in plants()}
FEW = ("unstable pair", "mixed", "hidden modes", "undamped pair")


@cache
def assumed(name: str) -> frozenset[str]:
    """Return the hypotheses and definitions that a step rests on."""
    declared = spectrum.theory().declared
    return frozenset(n for n in rests_on(name) if isinstance(declared.get(n), (Declared, DeclaredFact)))


@cache
def rests_on(name: str) -> frozenset[str]:
    return spectrum.lecture().rests_on(name)


@cache
def instance(plant: str, names: frozenset[str]) -> World | None:
    return world(spectrum.theory(), PLANTS[plant], names)


def chosen(plant: str, name: str) -> World:
    """Return a plant with what a step rests on, which it can satisfy."""
    found = instance(plant, assumed(name))
    assert found is not None
    return found


def evidence_on_25() -> tuple[Erratum, Equation, Equation]:
    """Return the erratum on (25), what the source prints, and the true form."""
    (erratum,) = [e for e in spectrum.lecture().errata if e.number == "25"]
    assert isinstance(erratum.printed, Equation)
    assert erratum.true is not None
    return erratum, erratum.printed, erratum.true


@cache
def numbered():
    return [s for s in spectrum.lecture().steps if s.number or s.name.startswith("theorem")]


# ------------------------------------------------------------------------------------------------ true
@pytest.mark.parametrize("plant", PLANTS)
def test_every_step_holds(plant):
    """Numbered equations are tried at every plant, other steps at every third."""
    left_out, turn = set(), list(PLANTS).index(plant)
    for number, step in enumerate(spectrum.lecture().steps):
        place = instance(plant, assumed(step.name)) if step in numbered() or (number + turn) % 3 == 0 else None
        if place is not None:
            assert gap(step.statement, place) < CLOSE, step.name
        elif step in numbered():
            left_out.add(step.name)
    assert all({"W = 0", "W = BB'", "λmin > 0"} & rests_on(name) for name in left_out)


def test_every_plant_satisfies_what_its_steps_rest_on():
    sets = {assumed(step.name) for step in numbered()}
    for plant in PLANTS:
        for names in sets:
            place = instance(plant, names)
            wrong = [n for n in names if place is not None and not satisfied(spectrum.theory(), place, n)]
            assert not wrong, plant


@pytest.mark.parametrize(("a", "b"), [(0.0, 0.7), (0.0, 0.0), (-1.1, 0.0), (1e-3, 2.0)])
def test_one_root_on_an_axis(a, b):
    """The statements about any root α + jβ hold on the imaginary axis and on the real one."""
    tried = 0
    for step in spectrum.lecture().steps:
        if {"α", "β"} & {getattr(n, "name", "") for side in terms(step.statement) for n in below(side)}:
            place = chosen("one stable state", step.name)
            changed = replace(place, numbers={**place.numbers, "α": a, "β": b}, known={})
            assert gap(step.statement, changed) < CLOSE, step.name
            tried += 1
    assert tried >= 25


def terms(statement: Equation) -> tuple[Term, Term]:
    return statement.lhs, statement.rhs


def below(term: Term):
    yield term
    for child in term.children():
        yield from below(child)


# ------------------------------------------------------------------------------------------------ false
def differs(statement: Equation, name: str, plants=PLANTS) -> bool:
    """Tell whether both sides have values at some plant, and these are apart."""
    for plant in plants:
        place = instance(plant, assumed(name))
        try:
            if place is not None and gap(statement, place) > APART:
                return True
        except (NoValueError, np.linalg.LinAlgError):
            continue
    return False


def changed(term: Term, old: type[Term], new) -> Term:
    """Return the first mutation that replaces a node of one kind by what ``new`` makes of it."""
    if isinstance(term, old):
        return new(term)
    for f, value in ((f, getattr(term, f)) for f in getattr(term, "__dataclass_fields__", {}) if f != "symbol"):
        parts = value if isinstance(value, tuple) else (value,)
        for i, part in enumerate(parts):
            if isinstance(part, Term) and (found := changed(part, old, new)) != part:
                fresh = (*parts[:i], found, *parts[i + 1 :]) if isinstance(value, tuple) else found
                return replace(term, **{f: fresh})  # type: ignore[type-var]
    return term


MUTATIONS = {
    "maximum dropped": (Max, lambda term: term.body),
    "real part of another family": (RealPart, lambda term: RealPart(spectrum.theory().symbols["φ"])),
    "number doubled": (Number, lambda term: Number(2 * term.value)),
    "logarithm doubled": (Log, lambda term: Product((Number(2), term))),
    "sum dropped": (Total, lambda term: Number(0)),
}


@pytest.mark.parametrize("kind", MUTATIONS)
def test_theorems_with_a_piece_changed_do_not_hold(kind):
    found = defaultdict(set)
    for name in ("proposition 2", "theorem 1", "Bode integral", "theorem 2", "theorem 1 with cross-covariance"):
        statement = spectrum.lecture().step(name).statement
        other = replace(statement, rhs=changed(statement.rhs, *MUTATIONS[kind]))
        if other != statement:
            found[differs(other, name)].add(name)
    assert found[True]
    assert not found[False], found


def test_a_mutation_of_each_numbered_equation_does_not_hold():
    for step in numbered():
        others = [replace(step.statement, rhs=rhs) for rhs in mutants(step.statement.rhs, swapped_in("spectrum"))]
        others += [replace(step.statement, lhs=lhs) for lhs in mutants(step.statement.lhs, swapped_in("spectrum"))]
        assert any(differs(other, step.name) for other in others), step.name


def test_the_gain_without_the_intensity_of_the_noise_fails():
    for name in ("trace of KC", "theorem 1", "Bode integral", "spectral factorisation"):
        plant = chosen("mixed", name)
        P, C, A = (plant.matrices[k] for k in ("P", "C", "A"))
        K = P @ C.T
        roots = {**plant.roots, "μ": np.linalg.eigvals(A - K @ C)}
        wrong = replace(plant, matrices={**plant.matrices, "K": K}, roots=roots, known={})
        statements = [spectrum.lecture().step(name).statement, spectrum.theory().statement("gain")]
        assert gap(statements[1], wrong) > APART
        assert gap(statements[0], wrong) > APART or name == "theorem 1"  # which does not speak of the gain


def test_what_the_replay_accepts_is_true():
    """Of all mutations of all steps, those that the kernel accepts are true as well, with numbers."""
    accepted = [(step, statement) for step, statement, _, accepted in judged("spectrum") if accepted]
    assert len(accepted) > 100
    for step, statement in accepted:
        for place in (chosen(plant, step.name) for plant in FEW if instance(plant, assumed(step.name)) is not None):
            if step.rule != "resolvent" or square(statement.lhs, place):
                assert gap(statement, place) < CLOSE, (step.name, str(statement))


def square(limit: Term, place: World) -> bool:
    """Tell whether the matrix under the trace of a limit is square."""
    assert isinstance(limit, Limit)
    assert isinstance(limit.body, Trace)
    matrix = Place(place).matrix(limit.body.body)
    return matrix.shape[0] == matrix.shape[1]


def test_a_trace_of_a_matrix_that_is_not_square_is_rejected():
    step, reading, earlier = next(row for row in walk("spectrum") if row[0].name == "the resolvent vanishes")
    limit = step.statement.lhs
    assert isinstance(limit, Limit)
    assert isinstance(limit.body, Trace)
    assert isinstance(limit.body.body, Product)
    wide = replace(limit, body=Trace(Product(limit.body.body.factors[:-1])))  # C A (sI - A)^-1 without K
    with pytest.raises(Rejected):
        check(replace(step, statement=replace(step.statement, lhs=wide)), reading, earlier)


# ------------------------------------------------------------------------------------------------ the erratum
def test_the_evidence_on_25():
    erratum, printed, true = evidence_on_25()
    values = {str(symbol): float(value) for symbol, value in erratum.evidence[0].values}
    assert values == {"A": -1.0, "C": 1.0, "W": 1.0, "V": 1.0}
    place = world(spectrum.theory(), Plant("of the erratum", np.array([[-1.0]]), 1), assumed(erratum.proved_by))
    assert place is not None
    place = replace(place, matrices={**place.matrices, **{k: np.array([[v]]) for k, v in values.items()}}, known={})
    ratio = spectrum.theory().statement("lowest terms").lhs
    for s in (0.3 + 0.4j, 2.0, -1.7j):  # (2 - s^2)/(1 - s^2), with the poles 1 and -1
        value = Place(place, variables={"s": s}).number(ratio)
        assert abs(value - (2 - s**2) / (1 - s**2)) < CLOSE
    assert sorted(place.roots["η'"].real) == pytest.approx([-1.0, 1.0])
    right, left = sides(printed, Place(place))
    assert [str(round(float(x))) for x in (left, right)] == [text for _, text in erratum.evidence[0].results]
    assert gap(printed, place) > APART
    assert gap(true, place) < CLOSE


def test_25_fails_wherever_a_stable_mode_is_seen_and_driven_and_its_true_form_nowhere():
    erratum, printed, true = evidence_on_25()
    places = {plant: chosen(plant, erratum.proved_by) for plant in PLANTS}
    fails = {plant for plant, place in places.items() if gap(printed, place) > APART}
    assert {"one stable state", "mixed"} <= fails
    assert not {"unstable pair", "integrator", "double integrator"} & fails
    assert all(gap(true, place) < CLOSE for place in places.values())


# ------------------------------------------------------------------------------------------------ the instruments
def test_the_quadrature_against_another():
    for a, b in ((0.4, 1.3), (1e-4, 2.0), (0.0, 0.8)):
        f = lambda w, a=a, b=b: np.log(((w - b) ** 2 + a * a) / (w * w + 1.0))  # noqa: E731
        g = lambda w, f=f: f(w) + f(-w)  # noqa: E731
        points = [quad(g, low, high, limit=400)[0] for low, high in ((0, b), (b, 4.0), (4.0, np.inf))]
        assert integral(g, 0.0, np.inf, [b], 3.0) == pytest.approx(sum(points), abs=1e-7)
        assert integral(g, -np.inf, np.inf, [b], 3.0) == pytest.approx(2.0 * sum(points), abs=1e-7)
        assert integral(g, np.inf, 0.0, [b], 3.0) == -integral(g, 0.0, np.inf, [b], 3.0)


def test_what_has_no_value_is_refused():
    place = chosen("mixed", "theorem 1")
    t = spectrum.theory()
    with pytest.raises(NoValueError, match="has no number None"):
        Place(place).number(RealPart(t.symbols["λ"]))
    with pytest.raises(NoValueError, match="order of complex numbers"):
        Place(place).number(Max(t.symbols["s"]))
    with pytest.raises(NoValueError, match="diverges"):
        integral(lambda w: 1.0 / w, 1.0, np.inf, [], 1.0)


def test_the_filter_is_the_one_of_its_lecture():
    """What this theory assumes as equations (2) and (3) is what the lecture on the filter states."""
    t = spectrum.theory()
    assert spelled(t.statement("Riccati equation").lhs) == spelled(kalman_bucy.riccati().statement.lhs)


def spelled(term: Term) -> str:
    """Return a term as text that does not depend on the names of dimensions."""
    name = getattr(term, "name", type(term).__name__)
    return f"{name}({' '.join(map(spelled, term.children()))})"
