"""Closed forms: their branches are what is proved, and every export computes the same numbers."""

from __future__ import annotations

import ctypes
import itertools
import json
import math
import subprocess
import sysconfig
from dataclasses import replace
from fractions import Fraction

import numpy as np
import pytest
from scipy.linalg import solve_continuous_are, solve_discrete_are

from derive.errors import InputError
from derive.functions import Exp, Log, Power, Quotient, Root
from derive.scalar.library import FORMULAS, formula
from derive.terms import Number

GRID = {
    "A": (-2.0, -1.0, -0.5, 0.0, 0.5, 1.0, 3.0), "C": (-1.5, 0.0, 1.0), "B": (-1.5, 0.0, 1.0),
    "W": (0.0, 1e-9, 2.0), "V": (0.25, 3.0), "Q": (0.0, 1e-9, 2.0), "R": (0.25, 3.0),
    "P0": (0.0, 0.7, 40.0), "t": (0.0, 1e-7, 0.3, 5.0), "k": (0.0, 1.0, 2.0, 30.0),
    "N": (0.0, -0.5, 0.7), "S_d": (0.0, -0.5, 0.7),
}  # fmt: skip


def points(name: str) -> list[tuple[float, ...]]:
    return list(itertools.product(*(GRID[s.name] for s in formula(name).program.arguments)))


def agree(one: float, two: float) -> bool:
    return (math.isnan(one) and math.isnan(two)) or one == two or abs(one - two) <= 1e-12 * max(1.0, abs(one))


@pytest.mark.parametrize("name", FORMULAS)
def test_branches_are_sides_of_proved_steps(name):
    formula(name).check()


@pytest.mark.parametrize("name", FORMULAS)
def test_exports_agree(name, tmp_path):
    made = formula(name)
    where = points(name)
    values = made.to_numpy()(*np.array(where).T)
    casadi, c, js = made.to_casadi(), compiled(made, tmp_path), javascript(made, where)
    assert np.isfinite(values).sum() > len(where) / 2
    for x, value, other in zip(where, values, js, strict=True):
        for found in (float(casadi(*x)), c(*x), other):
            assert agree(value, found), (x, value, found)


def compiled(made, folder):
    source, library = folder / "f.c", folder / "f.so"
    source.write_text(made.to_c())
    compiler = (sysconfig.get_config_var("CC") or "cc").split()[0]
    subprocess.run([compiler, "-O1", "-Wall", "-Werror", "-shared", "-fPIC", source, "-o", library, "-lm"], check=True)
    function = getattr(ctypes.CDLL(str(library)), made.program.name)
    function.restype, function.argtypes = ctypes.c_double, [ctypes.c_double] * len(made.program.arguments)
    return function


def javascript(made, where):
    import quickjs

    context = quickjs.Context()
    context.eval(made.to_javascript())
    call = f"JSON.stringify({json.dumps(where)}.map(x => String({made.program.name}(...x))))"
    return [float(x.replace("Infinity", "inf")) for x in json.loads(context.eval(call))]


def test_covariance_is_that_of_scipy():
    p = formula("care_covariance").to_numpy()
    for A, C, W, V in ((-1.0, 2.0, 0.5, 0.3), (2.0, -1.0, 0.1, 4.0), (0.0, 1.0, 1.0, 1.0)):
        assert p(A, C, W, V) == pytest.approx(solve_continuous_are(A, C, W, V)[0, 0], rel=1e-10)
    m = formula("dare_covariance").to_numpy()
    for A, C, Q, R in ((0.5, 2.0, 0.5, 0.3), (2.0, -1.0, 0.1, 4.0), (1.0, 1.0, 1.0, 1.0)):
        assert m(A, C, Q, R) == pytest.approx(solve_discrete_are(A, C, Q, R)[0, 0], rel=1e-10)


@pytest.mark.parametrize(
    ("name", "at", "value"),
    [
        ("care_covariance", (1, 1, 0, 1), 2.0),  # unstable, not excited: the upper root
        ("care_covariance", (-1, 1, 0, 1), 0.0),
        ("care_covariance", (0, 1, 0, 1), 0.0),  # double root
        ("care_covariance", (0, 2, 9, 4), 3.0),  # sqrt(V W)/|C|
        ("care_covariance", (-2, 0, 3, 1), 0.75),  # -W/(2 A)
        ("care_covariance", (1, 0, 1, 1), math.nan),  # not detectable
        ("care_covariance", (0, 0, 1, 1), math.nan),
        ("care_covariance", (-1e8, 1, 1, 1), 5e-9),  # no cancellation
        ("dare_covariance", (2, 1, 0, 1), 3.0),
        ("dare_covariance", (1, 1, 0, 1), 0.0),
        ("dare_covariance", (0, 1, 5, 1), 5.0),
        ("dare_covariance", (0.5, 0, 3, 1), 4.0),
        ("dare_covariance", (2, 1, 1, 1), 2 + math.sqrt(5)),
        ("dare_covariance", (2, 0, 1, 1), math.nan),
        ("riccati_transient", (1, 1, 0, 1, 0, 50), 0.0),  # neither excited nor uncertain
        ("riccati_transient", (1, 1, 0, 1, 1e-9, 50), 2.0),
        ("riccati_transient", (0, 1, 0, 1, 3, 2), 3 / 7),
        ("riccati_transient", (0, 0, 2, 1, 3, 2), 7.0),
        ("lqr_cost_discrete", (2, 1, 1, 1), 2 + math.sqrt(5)),
        ("care_closed_loop", (1, 0, 1, 1), math.nan),  # no gain moves it
        ("care_closed_loop", (-1, 0, 1, 1), -1.0),
        ("care_cross_covariance", (1, 1, 1, 1, 1), 0.0),  # all process noise is seen: A - N C/V = 0
        ("care_cross_gain", (1, 1, 1, 1, 1), 1.0),
        ("care_cross_covariance", (0, 1, 4, 1, 2), 0.0),  # stable once the common noise is removed
        ("care_cross_covariance", (-1, 0, 3, 1, 0.5), 1.375),  # (W - N^2/V)/2
        ("care_cross_covariance", (1, 0, 3, 1, 0.5), math.nan),
        ("dare_gain", (2, 0, 1, 1), math.nan),
        ("dare_gain", (1, 1, 0, 1), 0.0),
        ("dare_closed_loop", (1, 1, 0, 1), 1.0),  # at the boundary
        ("dare_closed_loop", (0.5, 0, 1, 1), 0.5),
        ("dare_closed_loop", (2, 0, 1, 1), math.nan),
        ("dare_cross_covariance", (2, 1, 1, 1, 1), 0.0),  # A - S C/R = 1 and all process noise is seen
        ("dare_cross_gain", (2, 1, 1, 1, 1), 1.0),
        ("lqr_gain_continuous", (0, 2, 9, 4), 1.5),
        ("lqr_gain_continuous", (0, 2, 0, 4), 0.0),
        ("lqr_gain_continuous", (1, 0, 1, 1), math.nan),
        ("lqr_gain_discrete", (2, 1, 0, 1), 1.5),  # the pole 2 is mirrored to 1/2
        ("lqr_gain_discrete", (1, 1, 0, 1), 0.0),
        ("riccati_recursion", (2, 1, 0, 1, 0, 40), 0.0),  # neither excited nor uncertain
        ("riccati_recursion", (2, 1, 0, 1, 1e-12, 60), 3.0),
        ("riccati_recursion", (1, 1, 0, 1, 3, 2), 3 / 7),
        ("riccati_recursion", (1, 0, 2, 1, 3, 2), 7.0),
        ("riccati_recursion", (0, 1, 5, 1, 3, 1), 5.0),
        ("riccati_recursion", (2, 0, 1, 1, 0, 3), 21.0),  # 1 + 4 + 16
        ("riccati_recursion", (3, 1, 1, 1, 0.25, 0), 0.25),
    ],
)
def test_degenerate_values(name, at, value):
    assert agree(float(formula(name).to_numpy()(*at)), value)


def test_transient_obeys_its_equation():
    f = formula("riccati_transient").to_numpy()
    for A, C, W, V, P0 in ((-1.0, 2.0, 0.5, 0.3, 2.0), (1.5, 1.0, 0.2, 1.0, 0.0), (0.0, 1.0, 1.0, 1.0, 5.0)):
        for t in (0.1, 0.7):
            h = 1e-5
            rate = (f(A, C, W, V, P0, t + h) - f(A, C, W, V, P0, t - h)) / (2 * h)
            P = f(A, C, W, V, P0, t)
            assert rate == pytest.approx(2 * A * P + W - C**2 / V * P**2, rel=1e-6, abs=1e-8)


def test_recursion_is_that_of_exact_numbers():
    """Near the circle, far from it, unobserved, without memory: against the recursion in rational numbers."""
    f = formula("riccati_recursion").to_numpy()
    coefficients = Fraction(0), Fraction(1, 1000), Fraction(1), Fraction(-9, 8), Fraction(1000)
    sensors, small = (Fraction(0), Fraction(1), Fraction(-3, 2)), (Fraction(0), Fraction(1, 2**35), Fraction(4))
    for A, C, Q, P0 in itertools.product(coefficients, sensors, small, small):
        P, R = P0, Fraction(1, 4)
        for k in range(12):
            assert f(*map(float, (A, C, Q, R, P0)), k) == pytest.approx(float(P), rel=2e-12), (A, C, Q, P0, k)
            P = A * A * P * R / (C * C * P + R) + Q


def test_bounds_of_the_error_hold():
    """The theorems of the lecture, in numbers: |error| <= c decay, and the time that the error allowed asks for."""
    f, steady = formula("riccati_transient").to_numpy(), formula("care_covariance").to_numpy()
    for A, C, W, V, P0 in ((1.0, 1.0, 1e-3, 1.0, 0.0), (-1.0, 2.0, 0.5, 0.3, 9.0), (0.5, 1.0, 0.0, 1.0, 1e-6)):
        S, P = math.sqrt(A**2 + C**2 * W / V), steady(A, C, W, V)
        c = abs(P0 - P) * (1 + 2 * S / (S - A + C**2 / V * P0))
        t = np.linspace(0, 30, 200)
        assert (np.abs(f(A, C, W, V, P0, t) - P) <= c * np.exp(-2 * S * t) + 1e-12).all()
        assert abs(f(A, C, W, V, P0, math.log(1 + c / 1e-6) / (2 * S)) - P) <= 1e-6
    g, steady = formula("riccati_recursion").to_numpy(), formula("dare_covariance").to_numpy()
    for A, C, Q, R, P0 in ((1.5, 1.0, 1e-3, 1.0, 0.0), (-0.9, 2.0, 0.5, 0.3, 9.0), (2.0, 1.0, 0.0, 1.0, 1e-6)):
        b, M = A**2 * R + C**2 * Q - R, steady(A, C, Q, R)
        T = math.hypot(b, 2 * C * math.sqrt(Q * R))
        rho = (A * R / (C**2 * M + R)) ** 2
        c = abs(P0 - M) * (1 + T / (C**2 * P0 + (T - b) / 2))
        k = np.arange(200)
        assert (np.abs(g(A, C, Q, R, P0, k) - M) <= c * rho**k + 1e-12).all()
        assert abs(g(A, C, Q, R, P0, math.ceil(math.log(1 + c / 1e-6) / -math.log(rho))) - M) <= 1e-6


def test_common_noise_and_regulator_are_those_of_scipy():
    for A, C, W, V, N in ((-1.0, 2.0, 0.5, 0.3, 0.2), (2.0, -1.0, 0.1, 4.0, -0.3), (0.0, 1.0, 1.0, 1.0, 0.5)):
        P = solve_continuous_are(A, C, W, V, s=N)[0, 0]
        assert formula("care_cross_covariance").to_numpy()(A, C, W, V, N) == pytest.approx(P, rel=1e-9)
        assert formula("care_cross_gain").to_numpy()(A, C, W, V, N) == pytest.approx((P * C + N) / V, rel=1e-9)
        M = solve_discrete_are(A, C, W, V, s=N)[0, 0]
        assert formula("dare_cross_covariance").to_numpy()(A, C, W, V, N) == pytest.approx(M, rel=1e-9)
        L = (A * M * C + N) / (C**2 * M + V)
        assert formula("dare_cross_gain").to_numpy()(A, C, W, V, N) == pytest.approx(L, rel=1e-9)
    for A, B, Q, R in ((-1.0, 2.0, 0.5, 0.3), (2.0, -1.0, 0.1, 4.0), (0.0, 1.0, 1.0, 1.0)):
        X, D = solve_continuous_are(A, B, Q, R)[0, 0], solve_discrete_are(A, B, Q, R)[0, 0]
        assert formula("lqr_cost_continuous").to_numpy()(A, B, Q, R) == pytest.approx(X, rel=1e-9)
        assert formula("lqr_gain_continuous").to_numpy()(A, B, Q, R) == pytest.approx(B * X / R, rel=1e-9)
        assert formula("lqr_cost_discrete").to_numpy()(A, B, Q, R) == pytest.approx(D, rel=1e-9)
        F = A * B * D / (B**2 * D + R)
        assert formula("lqr_gain_discrete").to_numpy()(A, B, Q, R) == pytest.approx(F, rel=1e-9)


def test_arrays_broadcast():
    f = formula("care_covariance").to_numpy()
    assert f(np.ones((3, 1)), np.ones(4), 1.0, 1.0).shape == (3, 4)
    with pytest.raises(InputError, match="expected 4 arguments, got 1"):
        f(1.0)


def mutants():
    made = formula("care_covariance")
    A, C, _, V = made.program.arguments
    S = made.program.lets[0].symbol
    wrong = {
        "the wrong root": Quotient(V * (A - S), Power(C, 2)),
        "a sign": Quotient(V * (S - A), Power(C, 2)),
        "a factor 2": Quotient(2 * V * (A + S), Power(C, 2)),
        "a lost V": Quotient(A + S, Power(C, 2)),
        "a lost square": Quotient(V * (A + S), C),
    }
    for name, body in wrong.items():
        first, *others = made.program.branches
        yield pytest.param(replace(made.program, branches=(replace(first, body=body), *others)), id=name)
    lost = replace(made.program.lets[0], body=Root(Power(A, 2) + Power(C, 2) * made.program.arguments[2]))
    yield pytest.param(replace(made.program, lets=(lost,)), id="a lost V under the root")


@pytest.mark.parametrize("program", list(mutants()))
def test_wrong_programs_are_rejected(program):
    with pytest.raises(InputError, match="is not what the step"):
        replace(formula("care_covariance"), program=program).check()


def test_wrong_powers_are_rejected():
    made = formula("riccati_recursion")
    near, far = made.sequences
    lam, rho = made.program.lets[2].symbol, made.program.lets[3].symbol
    k = made.program.arguments[-1]
    for wrong in (
        replace(far, expression=Exp(k * Log(lam))),  # the power of another number
        replace(far, expression=Exp(rho * Log(k))), replace(far, expression=Exp(k * Log(rho) + rho)),
        replace(far, expression=k), replace(far, start="σ at the start"), replace(far, following="σ'"),
    ):  # fmt: skip
        with pytest.raises(InputError):
            replace(made, sequences=(near, wrong)).check()
    with pytest.raises(InputError, match="a branch is not"):
        replace(made, sequences=(near,)).check()


def test_formula_says_what_it_rests_on():
    made = formula("care_covariance")
    assert {"C ≠ 0", "V > 0", "W >= 0"} <= set(made.hypotheses)
    assert {"Riccati equation", "closed loop", "P >= 0"} <= {s.name for s in made.derivation}
    assert made.latex() == r"P = \frac{V \left(A + \sqrt{A^2 + \frac{C^2 W}{V}}\right)}{C^2}"
    import sympy

    values = dict(zip(sympy.symbols("A C W V", real=True), map(sympy.Rational, (2, 3, 5, 7)), strict=True))
    exact = sympy.N(made.sympy.rhs.subs(values), 30)
    assert float(exact) == pytest.approx(formula("care_covariance").to_numpy()(2, 3, 5, 7), rel=1e-15)


def test_unknown_formula():
    with pytest.raises(InputError, match="unknown; known are care_covariance"):
        formula("care")


def test_numbers_are_exact():
    half = replace(formula("care_closed_loop").program.branches[0], body=Number(Fraction(-1, 3)))
    program = replace(formula("care_closed_loop").program, branches=(half,))
    assert "return -(1.0/3.0);" in program.to_c()
    assert program.to_numpy()(0, 1, 0, 1) == -1 / 3
