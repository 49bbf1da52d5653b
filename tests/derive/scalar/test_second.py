"""Plants of order two and three: closed forms against other solvers, mutated statements, and exports that agree."""

from __future__ import annotations

import itertools
from dataclasses import replace
from functools import partial

import mpmath
import numpy as np
import pytest
from scipy.linalg import solve_continuous_are

from derive.context import Theory
from derive.derivation import check, learn
from derive.errors import InputError
from derive.functions import Power, Quotient, Root, value
from derive.kernel import Rejected
from derive.scalar.second_order import FORMULAS, formula
from derive.terms import Equation, Zero
from derive.theory import lecture, scalar, scalar_builder
from derive.theory.builder import NotDerived
from derive.theory.scalar_builder import ScalarBuilder
from tests.derive.scalar.test_formula import agree, compiled, javascript
from tests.derive.scalar.test_lecture import Point

ZERO = Zero("", "")
GRID = {
    "c0": (-1.0, 0.0, 1e-6, 2.0), "c2": (-3.0, -0.5, 0.0, 4.0), "w1": (-1.0, 0.0, 1e-9, 3.0), "w2": (0.0, 1e-9, 2.0),
    "V": (0.0, 0.25, 3.0), "ω0": (0.0, 0.1, 2.0, -1.0), "ζ": (-0.3, 0.0, 1e-6, 0.7, 2.0),
}  # fmt: skip
UPPER = np.triu_indices(2)


@pytest.fixture(scope="module")
def walked():
    """Return each step with what may be used before it, and what may be used at the end."""
    item, earlier, out = lecture("scalar"), {}, {}
    reading = item.theory.reading()
    for step in item.steps:
        out[step.name] = step, reading, dict(earlier)
        earlier[step.name] = step
        reading = learn(reading, item.theory, step)
    return out, reading


def points(name: str) -> list[tuple[float, ...]]:
    return list(itertools.product(*(GRID[s.name] for s in formula(name).program.arguments)))


# ------------------------------------------------------------------------------------------------ formulas
@pytest.mark.parametrize("name", FORMULAS)
def test_branches_are_sides_of_proved_steps(name):
    formula(name).check()


@pytest.mark.parametrize("name", FORMULAS)
def test_exports_agree(name, tmp_path):
    made, where = formula(name), points(name)
    values = made.to_numpy()(*np.array(where).T)
    casadi, c, js = made.to_casadi(), compiled(made, tmp_path), javascript(made, where)
    assert np.isfinite(values).sum() > len(where) / 4
    for x, number, other in zip(where, values, js, strict=True):
        for found in (float(casadi(*x)), c(*x), other):
            assert agree(number, found), (x, number, found)


def riccati(A, W, V) -> np.ndarray:
    C = np.eye(1, len(A))
    return solve_continuous_are(np.transpose(A), C.T, W, np.array([[V]]))


def entries(plant: str, *at: float) -> np.ndarray:
    return np.array([formula(f"{plant}_{k}").to_numpy()(*at) for k in ("p11", "p12", "p22")])


def test_double_integrator_is_that_of_scipy():
    for w1, w2, V in itertools.product((0.0, 0.3, 20.0), (1e-3, 1.0, 50.0), (0.01, 1.0, 7.0)):
        P = riccati([[0.0, 1.0], [0.0, 0.0]], np.diag([w1, w2]), V)
        np.testing.assert_allclose(entries("double_integrator", w1, w2, V), P[UPPER], rtol=1e-10)


def test_oscillator_is_that_of_scipy():
    grid = (0.0, 0.1, 1.0, 5.0), (-1.0, -0.1, 0.0, 0.01, 0.7, 3.0), (0.05, 1.0, 50.0), (0.1, 1.0, 7.0)
    for o, zeta, w2, V in itertools.product(*grid):
        P = riccati([[0.0, 1.0], [-o * o, -2 * zeta * o]], np.diag([0.0, w2]), V)
        np.testing.assert_allclose(entries("oscillator", o, zeta, w2, V), P[UPPER], rtol=1e-10, atol=1e-10 * P.max())


@pytest.mark.parametrize(
    ("o", "zeta", "w2", "V"), [(1, 1e-6, 1e-12, 1), (100, 0.5, 1e-9, 1), (1, 3, 1e-16, 2), (3, 0, 1e-14, 1)]
)
def test_oscillator_does_not_cancel(o, zeta, w2, V):
    with mpmath.workdps(80):
        o_, z_, w_, V_ = map(mpmath.mpf, (o, zeta, w2, V))
        k = mpmath.sqrt(4 * z_**2 * o_**2 - 2 * o_**2 + 2 * mpmath.sqrt(o_**4 + w_ / V_)) - 2 * z_ * o_
        exact = [V_ * k, V_ * k**2 / 2, o_**2 * V_ * k + 2 * z_ * o_ * V_ * k**2 / 2 + V_ * k**3 / 2]
        np.testing.assert_allclose(entries("oscillator", o, zeta, w2, V), [float(x) for x in exact], rtol=1e-14)


@pytest.mark.parametrize(
    ("plant", "at", "P"),
    [
        ("double_integrator", (0, 1, 1), (np.sqrt(2), 1, np.sqrt(2))),  # the textbook's numbers
        ("double_integrator", (4, 0, 9), (6, 0, 0)),  # velocity known: sqrt(V W1)
        ("double_integrator", (0, 0, 1), (0, 0, 0)),
        ("oscillator", (0, 0.5, 1, 1), (np.sqrt(2), 1, np.sqrt(2))),  # without a spring, a double integrator
        ("oscillator", (2, 0.5, 0, 1), (0, 0, 0)),
        ("oscillator", (2, 0, 0, 1), (0, 0, 0)),  # undamped and unexcited: the strong solution
        ("oscillator", (1, -0.5, 0, 3), (6, 6, 12)),  # negative damping: the closed loop is its mirror image
        ("oscillator", (1, 0.5, -1, 1), (np.nan, np.nan, np.nan)),
        ("double_integrator", (-1, 1, 1), (np.nan, np.nan, np.nan)),
    ],
)
def test_degenerate_values(plant, at, P):
    np.testing.assert_allclose(entries(plant, *at), P, rtol=1e-14)


def test_factor_is_that_of_the_roots():
    a1, a0 = formula("spectral_factor_linear").to_numpy(), formula("spectral_factor_constant").to_numpy()
    for c0, c2 in ((2.0, 1.0), (0.3, -1.0), (1.0, 2.0), (5.0, 30.0)):
        roots = np.roots([1, 0, -c2, 0, c0])  # in s, with s^2 = -ω^2
        np.testing.assert_allclose([1, a1(c0, c2), a0(c0, c2)], np.poly(roots[roots.real < 0]), rtol=1e-12)
    assert np.isnan(a1(1.0, -2.0))  # a root on the axis


def test_a_wrong_program_is_rejected():
    made = formula("oscillator_p11")
    first, *others = made.program.branches
    for body in (2 * first.body, -first.body, Power(first.body, 2)):
        program = replace(made.program, branches=(replace(first, body=body), *others))
        with pytest.raises(InputError, match="is not what the step"):
            replace(made, program=program).check()


def test_unknown_formula():
    with pytest.raises(InputError, match="unknown; known are spectral_factor_linear"):
        formula("oscillator_p21")


# ------------------------------------------------------------------------------------------------ any plant
def at_point(reading, known: dict[str, float]):
    """Return the value of each letter of the lecture, with parameters given."""
    point = Point(0, reading, ())
    point.known |= known
    return point.scalar


def test_any_plant_of_order_two(walked):
    rng = np.random.default_rng(1)
    for _ in range(30):
        b0, b1, w1, w2, V = *rng.uniform(-3, 3, 2), *rng.uniform(0.05, 3, 3)
        p = at_point(walked[1], {"b0": b0, "b1": b1, "w1": w1, "w2": w2, "V": V})
        P = riccati([[0, 1], [-b0, -b1]], np.diag([w1, w2]), V)
        found = [p("P11"), p("P12"), p("P22")]
        np.testing.assert_allclose(found, P[UPPER], rtol=1e-9, atol=1e-10 * P.max())
        loop = np.poly([[-p("K1"), 1], [-b0 - p("K2"), -b1]])
        np.testing.assert_allclose(loop, [1, p("f1"), p("f0")], rtol=1e-9)
        assert np.roots(loop).real.max() < 0


def test_any_plant_of_order_three(walked):
    rng = np.random.default_rng(2)
    for _ in range(20):
        b0, b1, b2, w1, w2, w3, V = *rng.uniform(-3, 3, 3), *rng.uniform(0.05, 3, 4)
        A = np.array([[0, 1, 0], [0, 0, 1], [-b0, -b1, -b2]])
        P = riccati(A, np.diag([w1, w2, w3]), V)
        K = P[:, [0]] / V
        _, a2, a1, a0 = np.poly(A - K @ np.eye(1, 3))
        known = {"cubic b0": b0, "cubic b1": b1, "cubic b2": b2, "cubic a1": a1, "cubic a2": a2, "cubic c0": a0**2}
        p = at_point(walked[1], known | {"w1": w1, "w2": w2, "w3": w3, "V": V})
        found = [p(f"cubic P{i}{j}") for i in (1, 2, 3) for j in range(i, 4)]
        np.testing.assert_allclose(found, P[np.triu_indices(3)], rtol=1e-7, atol=1e-9 * P.max())
        c0, c2, c4 = (p_of(walked, name, p) for name in ("c0", "c2", "c4"))
        assert c0 == pytest.approx(a0**2)
        roots = np.roots([1, 0, -2 * c4, -8 * np.sqrt(c0), c4**2 - 4 * c2])
        assert max(roots[abs(roots.imag) < 1e-6].real) == pytest.approx(a2)


def p_of(walked, name: str, p) -> float:
    """Return a coefficient of the spectrum of the plant by the right-hand side of its declaration."""
    statement, reading = lecture("scalar").theory.statement(f"cubic plant {name}"), walked[1]
    poly = value(statement.rhs, reading)
    return sum(float(c) * np.prod([p(s) for s in m]) for (m, _), c in poly.terms.items())


# ------------------------------------------------------------------------------------------------ must reject
@pytest.fixture
def builder(walked, monkeypatch):
    """Return a builder that knows the whole lecture and gives up after half a second."""
    prove = partial(scalar_builder.prove_identity, seconds=0.5)
    monkeypatch.setattr(scalar_builder, "prove_identity", prove)
    b = ScalarBuilder(lecture("scalar").theory, "scalar", "mutants")
    b.reading = walked[1]
    return b


def test_true_statements_are_proved_by_that_builder(builder):
    """So that what follows is rejected for what it says."""
    s = builder.theory.symbols
    builder.state("again", Equation(s["P11"], "=", s["V"] * (s["f1"] - s["b1"])), "")
    builder.state("cubic again", Equation(s["cubic P11"], "=", s["V"] * (s["cubic a2"] - s["cubic b2"])), "")


MUTANTS = {
    "the sign of b1": lambda s: (s["P11"], s["V"] * (s["f1"] + s["b1"])),
    "a lost V": lambda s: (s["P11"], s["f1"] - s["b1"]),
    "a lost root": lambda s: (s["a1"], s["c2"] + 2 * Root(s["c0"])),
    "a factor 2 under the root": lambda s: (s["a1"], Root(s["c2"] + Root(s["c0"]))),
    "a sign under the root": lambda s: (s["a1"], Root(s["c2"] - 2 * Root(s["c0"]))),
    "the factor with a0 for a1": lambda s: (
        Power(s["Ω"], 4) + s["c2"] * Power(s["Ω"], 2) + s["c0"],
        Power(s["a0"] - Power(s["Ω"], 2), 2) + Power(s["a0"], 2) * Power(s["Ω"], 2),
    ),
    "entry 11 with a factor 2": lambda s: (
        s["P12"] + s["w1"] - Quotient(Power(s["P11"], 2), s["V"]), ZERO,
    ),
    "entry 22 with a sign": lambda s: (
        2 * s["b0"] * s["P12"] - 2 * s["b1"] * s["P22"] + s["w2"] - Quotient(Power(s["P12"], 2), s["V"]), ZERO,
    ),
    "the open loop": lambda s: (s["K1"] + s["b1"], s["b1"]),
    "the determinant without a factor 2": lambda s: (
        s["V"] * (s["f0"] - s["b0"]) * (s["P11"] * s["P22"] - Power(s["P12"], 2)),
        s["w1"] * Power(s["P12"], 2) + s["w2"] * Power(s["P11"], 2),
    ),
    "the value with a sign": lambda s: (Quotient(s["cubic P11"], s["V"]), s["cubic a2"] + s["cubic b2"]),
    "the value with another coefficient": lambda s: (Quotient(s["cubic P11"], s["V"]), s["cubic a1"] - s["cubic b1"]),
    "K2 without b2 K1": lambda s: (s["cubic P12"], s["V"] * (s["cubic a1"] - s["cubic b1"])),
}  # fmt: skip


@pytest.mark.parametrize("name", MUTANTS)
def test_mutated_formulas_are_not_derived(builder, name):
    left, right = MUTANTS[name](builder.theory.symbols)
    with pytest.raises(NotDerived):
        builder.state("mutant", Equation(left, "=", right), "")


CASED = {
    "the quartic with 4 for 8": lambda s: (
        Power(Power(s["cubic a2"], 2) - s["cubic c4"], 2) - 4 * s["cubic a0"] * s["cubic a2"] - 4 * s["cubic c2"],
        ["cubic a2^2 - 2 a1 = c4", "cubic a1^2 - 2 a0 a2 = c2"],
    ),
    "P11 of two integrators without a root": lambda s: (
        s["P11"] - s["V"] * (s["w1"] + 2 * Root(s["V"] * s["w2"])), ["double integrator, P11"],
    ),
    "P12 of the oscillator without a half": lambda s: (
        s["P12"] - s["V"] * Power(s["κ"], 2), ["oscillator, P12"],
    ),
}  # fmt: skip


@pytest.mark.parametrize("name", CASED)
def test_mutated_cases_are_not_derived(builder, name):
    left, using = CASED[name](builder.theory.symbols)
    with pytest.raises(NotDerived):
        builder.state("mutant", Equation(left, "=", ZERO), "", using)


def test_wrong_signs_are_not_derived(builder):
    s = builder.theory.symbols
    det = s["P11"] * s["P22"] - Power(s["P12"], 2)
    known = {"identities": ["determinant of order two"], "squares": [s["P12"]], "alone": True}
    facts = ["P11 > 0", "w1 >= 0", "a0 > b0", "V > 0"]
    builder.sign("again", Equation(det, ">", ZERO), "", [*facts, "w2 > 0"], **known)
    for statement, using in (
        (Equation(det, ">", ZERO), [*facts, "w2 >= 0"]),
        (Equation(-det, "≥", ZERO), [*facts, "w2 > 0"]),
        (Equation(det, ">", s["P11"]), [*facts, "w2 > 0"]),
    ):
        with pytest.raises(NotDerived):
            builder.sign("mutant", statement, "", using, **known)


@pytest.mark.parametrize(
    ("step", "fact"),
    [
        ("det P > 0", "w2 > 0"),
        ("factor is Hurwitz", "a1 > 0"),
        ("c2 + 2√c0 > 0", "spectrum at √c0"),
        ("cubic largest root", "cubic a2 a1 > a0"),
        ("cubic factor is Hurwitz", "cubic a2 a1 > a0"),
        ("a0 of X, one way", "X leaves a0 >= 0"),
        ("cubic a2 of X, one way", "cubic x2 x1 > x0"),
    ],
)
def test_a_case_is_needed(walked, step, fact):
    found, reading, earlier = walked[0][step]
    check(found, reading, earlier)
    facts = {k: f for k, f in reading.context.facts.items() if k != fact}
    with pytest.raises(Rejected):
        check(found, replace(reading, context=replace(reading.context, facts=facts)), earlier)


def test_the_letters_of_one_part_are_not_those_of_another():
    t = Theory("scalar", "parts")
    for part in scalar.PARTS:
        symbols, declared = dict(t.symbols), dict(t.declared)
        part.declare(t)
        again = [k for k, v in symbols.items() if t.symbols[k] is not v]
        assert again + [k for k, v in declared.items() if t.declared[k] is not v] == [], part.__name__


def test_what_the_values_rest_on():
    item = lecture("scalar")
    assert not {"w2 > 0", "b0 = 0"} & item.rests_on("only P22")  # the strong solution, for any plant
    assert "w2 > 0" in item.rests_on("det P > 0")
    assert "w1 = 0" not in item.rests_on("double integrator, P22")
    assert {"cubic a2 > 0", "cubic a2 a1 > a0", "cubic x2 x1 > x0"} <= item.rests_on("cubic value")
