"""The frequency domain in discrete time: every step with numbers at plants, the theorem by other routes, mutations."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction
from functools import cache
from itertools import pairwise
from math import log, pi

import numpy as np
import pytest
from scipy.integrate import quad
from scipy.linalg import solve_discrete_are

from derive.context import Declared, DeclaredFact
from derive.derivation import check
from derive.functions import PI, Log, Max, Quotient, put
from derive.kernel import Rejected
from derive.spectral import Det, Growth, ImaginaryPart, RealPart
from derive.terms import Equation, Neg, Number, Product, Sum, Term, Trace, Zero
from derive.theory import spectrum_dt
from derive.theory.spectrum_circle import angle, point
from derive.theory.spectrum_dt_matrix import outside
from derive.theory.spectrum_roots import HALF, axis
from tests.derive.theory.mutants import judged, mutants, swapped_in, walk
from tests.reference.spectrum_dt_plants import plants, world
from tests.reference.spectrum_values import TOLERANCE, NoValueError, Place, World, gap, sides

CLOSE, APART = TOLERANCE, 1e-3
PLANTS = {plant.name: plant for plant in plants()}
THEOREM = "discrete theorem 1"
A = np.array([[1.6, 0.7, 0.0], [-0.9, 1.1, 0.2], [0.0, 0.0, -0.4]])  # a pair outside the circle, one inside
C = np.array([[1.0, 0.0, 0.3], [0.0, 0.4, 1.0]])
Q, R = np.diag([0.5, 0.1, 0.2]), np.array([[0.3, 0.1], [0.1, 0.4]])
EIGENVALUES = (0.3 + 0.4j, 1.6 + 0.7j, -2 + 0j, 0j, 1 + 0j, 0.6 + 0.8j, -0.999 + 0j, 1j)


@cache
def assumed(name: str) -> frozenset[str]:
    """Return the hypotheses and definitions that a step rests on."""
    declared = spectrum_dt.theory().declared
    return frozenset(
        n for n in spectrum_dt.lecture().rests_on(name) if isinstance(declared.get(n), (Declared, DeclaredFact))
    )


@cache
def instance(plant: str, names: frozenset[str]) -> World:
    return world(spectrum_dt.theory(), PLANTS[plant], names)


def statement(name: str) -> Equation:
    return spectrum_dt.lecture().step(name).statement


# ------------------------------------------------------------------------------------------------ true
@pytest.mark.parametrize("plant", PLANTS)
def test_every_step_holds(plant):
    for step in spectrum_dt.lecture().steps:
        assert gap(step.statement, instance(plant, assumed(step.name))) < CLOSE, step.name


@pytest.mark.parametrize("plant", PLANTS)
def test_the_theorem_by_quadrature_in_the_angle(plant):
    """Without the terms of the lecture: the plant's matrices, SciPy's Riccati solution, the angle as the variable."""
    place = instance(plant, assumed(THEOREM))
    A, C, Q, R, P = (place.matrices[k] for k in "ACQRP")
    one = np.eye(len(A))

    def log_det(a: float) -> float:
        z = np.exp(1j * a)
        F = np.linalg.solve(z * one - A, one)
        return log(np.linalg.det(C @ F @ Q @ F.conj().T @ C.T + R).real)

    angles = sorted({round(abs(np.angle(x)), 9) for x in np.linalg.eigvals(A)} - {round(pi, 9), 0.0})
    ends = [1e-7, *angles, pi - 1e-7]  # a pole at 1 or -1 is left out, and 1e-6 of the mean with it
    mean = sum(quad(log_det, a, b, limit=300)[0] for a, b in pairwise(ends)) / pi
    outside = sum(max(0.0, log(abs(x))) for x in np.linalg.eigvals(A) if x)
    assert log(np.linalg.det(C @ P @ C.T + R)) == pytest.approx(mean + 2 * outside, abs=1e-5)


def test_the_theorem_at_a_plant_by_hand():
    P = solve_discrete_are(A.T, C.T, Q, R)
    S = C @ P @ C.T + R
    K = A @ P @ C.T @ np.linalg.inv(S)

    def spectrum_at(z: complex) -> np.ndarray:
        F, N = np.linalg.inv(z * np.eye(3) - A), np.linalg.inv(np.eye(3) / z - A)
        return C @ F @ Q @ N.T @ C.T + R

    for z in (0.3 + 1.1j, -2.0 + 0.1j, np.exp(0.7j)):
        loops = [np.linalg.det(z * np.eye(3) - M) * np.linalg.det(np.eye(3) - z * M) for M in (A, A - K @ C)]
        assert np.linalg.det(spectrum_at(z)) * loops[0] == pytest.approx(np.linalg.det(S) * loops[1])
    mean = quad(lambda a: log(np.linalg.det(spectrum_at(np.exp(1j * a))).real), -pi, pi, limit=300)[0] / (2 * pi)
    outside = sum(max(0.0, log(abs(x))) for x in np.linalg.eigvals(A))
    assert outside > 0.5
    assert max(abs(np.linalg.eigvals(A - K @ C))) < 1
    assert log(np.linalg.det(S)) == pytest.approx(mean + 2 * outside)


@pytest.mark.parametrize("root", EIGENVALUES)
@pytest.mark.parametrize("name", ["circle lemma of ζ", "Jensen's formula for ζ"])
def test_one_eigenvalue_by_quadrature(name, root):
    place = instance("mixed", assumed(name))
    place = replace(place, roots={**place.roots, "ζ": np.array([root, root.conjugate()])}, known={})
    assert gap(statement(name), place) < CLOSE
    ends = [-pi, *sorted({a for a in (np.angle(root), -np.angle(root)) if abs(a) < pi}), pi]
    angle = lambda a: log(abs(np.exp(1j * a) - root) ** 2)  # noqa: E731
    mean = sum(quad(angle, a + 1e-13, b - 1e-13, limit=300)[0] for a, b in pairwise(ends)) / (2 * pi)
    right = sides(statement("Jensen's formula for ζ"), Place(place, indices={"k": 0}))[1]
    assert right == pytest.approx(mean, abs=1e-5)
    assert right == pytest.approx(2 * max(0.0, log(max(abs(root), 1e-300))), abs=1e-12)


# ------------------------------------------------------------------------------------------------ false
KEY_STEPS = (
    "factorisation", "spectrum and loops", "ln det Phi on the circle", "modulus for A", "circle lemma of ζ",
    "Jensen's formula for ζ", "no growth of ξ", "all eigenvalues", "Jensen's formula for A", "half of the circle",
    THEOREM,
)  # fmt: skip
SAME = ("C P' C'", "(C')'", "C' + R'", "Φ_y(e^jω)'", "(∫_{-π}^π ln(det Φ_y(e^jω)) dω) 1/(2 π)")  # the theorem, as well


def every_mutant(name: str):
    whole, families = statement(name), swapped_in("spectrum-dt")
    for side in ("lhs", "rhs"):
        yield from (replace(whole, **{side: other}) for other in mutants(getattr(whole, side), families))


def differs(other: Equation, name: str) -> bool | None:
    """Tell whether both sides are apart at some plant; None if they have no value, for their types do not fit."""
    found = list[bool]()
    for plant in ("mixed", "not driven at 1 and -1", "singular and unstable"):
        try:
            found.append(gap(other, instance(plant, assumed(name))) > APART)
        except (NoValueError, np.linalg.LinAlgError, ValueError):
            continue
    return any(found) if found else None


def test_mutations_of_the_theorem_do_not_hold():
    found = [(differs(other, THEOREM), str(other)) for other in every_mutant(THEOREM)]
    assert sum(wrong is True for wrong, _ in found) >= 20
    same = [text for wrong, text in found if wrong is False]
    assert same
    assert all(any(part in text for part in SAME) for text in same), same


def swap(whole: Equation, old: Term, new: Term) -> Equation:
    return replace(whole, lhs=put(whole.lhs, {old: new}), rhs=put(whole.rhs, {old: new}))


def below(term: Term):
    yield term
    for child in term.children():
        yield from below(child)


def theorem_with(change) -> Equation:
    whole = statement(THEOREM)
    assert isinstance(whole.rhs, Sum)
    return replace(whole, rhs=Sum(tuple(map(change, whole.rhs.addends))))


def others() -> dict[str, Equation]:
    """Return formulas near to the theorem that are false."""
    t = spectrum_dt.theory()
    root, C, P, R = (t.symbols[k] for k in ("λ", "C", "P", "R"))
    whole, growth = statement(THEOREM), Growth(root)
    size = Sum((Product((RealPart(root), RealPart(root))), Product((ImaginaryPart(root), ImaginaryPart(root)))))
    return {
        "the sum once": swap(whole, Number(Fraction(2)), Number(Fraction(1))),
        "the sum subtracted": theorem_with(lambda a: Neg(a) if any(n == growth for n in below(a)) else a),
        "|λ|^2 - 1 for its logarithm": swap(whole, growth, Max(size - Number(Fraction(1)))),
        "the real part, as in continuous time": swap(whole, growth, Max(RealPart(root))),
        "without the maximum": swap(whole, growth, Number(Fraction(1, 2)) * Log(size)),
        "eigenvalues of the closed loop": swap(whole, outside(t), outside(t, "ξ")),
        "the sum of squares": swap(whole, growth, growth * growth),
        "the trace": replace(whole, lhs=Log(Trace(C * P * C.T + R))),
        "the error without noise": replace(whole, lhs=Log(Det(C * P * C.T))),
        "the measurement noise": replace(whole, lhs=Log(Det(R))),
        "the mean by π": swap(whole, Quotient(Number(Fraction(1)), 2 * PI), Quotient(Number(Fraction(1)), PI)),
        "half of the circle": swap(whole, Neg(PI), Zero("", "")),
        "the axis": swap(whole, angle(t), axis(t)),
        "inside the circle": swap(whole, angle(t), HALF * angle(t)),
        "the point in half of the angle's tangent": swap(whole, angle(t), point(t)),
    }


@pytest.mark.parametrize("name", others())
def test_formulas_near_to_the_theorem_are_rejected_and_false(name):
    other = others()[name]
    step, reading, earlier = next(row for row in walk("spectrum-dt") if row[0].name == THEOREM)
    check(step, reading, earlier)
    with pytest.raises(Rejected):
        check(replace(step, statement=other), reading, earlier)
    assert differs(other, THEOREM) is not False


@pytest.mark.parametrize("name", KEY_STEPS)
def test_mutations_are_rejected_or_true(name):
    step, reading, earlier = next(row for row in walk("spectrum-dt") if row[0].name == name)
    rejected = 0
    for other in every_mutant(name):
        try:
            check(replace(step, statement=other), reading, earlier)
        except Rejected:
            rejected += 1
        else:
            assert differs(other, name) is False, str(other)
    assert rejected >= 1


def test_what_the_replay_accepts_is_true():
    accepted = [(step, other) for step, other, _, accepted in judged("spectrum-dt") if accepted]
    assert accepted
    for step, other in accepted:
        for plant in ("mixed", "not driven at 1 and -1"):
            assert gap(other, instance(plant, assumed(step.name))) < CLOSE, (step.name, str(other))


# ------------------------------------------------------------------------------------------------ hypotheses
def test_what_the_theorem_rests_on():
    """No detectability, no Q >= 0, nothing of the eigenvalues of A: the strong solution is all that is asked for."""
    declared = spectrum_dt.theory().declared
    hypotheses = {n for n in assumed(THEOREM) if getattr(declared[n], "kind", "") != "definition"}
    assert hypotheses == {
        "R > 0", "P >= 0", "Riccati equation", "gain", "strong solution", "sI - A regular", "I - sA regular",
        "π > 0", "σ0 > 0", "σ0 = 1", "ω0 = 0", "r > 0", "ρ > 0", "n-", "n+",  # of the variables of the proof
        "ζ ≠ -1", "ξ ≠ -1", "Re χ = -1", "Im χ = 0", "Re ψ = -1", "Im ψ = 0",  # how eigenvalues are numbered
    }  # fmt: skip


def test_another_solution_of_the_riccati_equation_does_not_do():
    """With eigenvalues of A - KC outside of the circle the formula is off by them."""
    names = assumed(THEOREM) - {"strong solution"}
    found = 0
    for plant in ("unstable", "mixed", "stable"):
        place = instance(plant, names)
        closed = place.matrices["A"] - place.matrices["K"] @ place.matrices["C"]
        outside = sum(max(0.0, log(abs(x))) for x in np.linalg.eigvals(closed))
        left, right = sides(statement(THEOREM), Place(place))
        assert left + 2 * outside == pytest.approx(float(right), abs=1e-6) or outside == 0.0
        found += outside > 0.0
        assert (abs(float(left - right)) < CLOSE) == (outside == 0.0)
    assert found


def test_a_predictor_with_another_gain_does_not_do():
    place = instance("mixed", assumed("ln det Phi on the circle"))
    wrong = replace(place, matrices={**place.matrices, "K": 1.1 * place.matrices["K"]}, known={})
    assert gap(statement("ln det Phi on the circle"), wrong) > APART
    assert gap(spectrum_dt.theory().statement("gain"), wrong) > APART
