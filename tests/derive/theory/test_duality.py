"""The duality lecture: maps that are applied and checked, and what a map must not do."""

from __future__ import annotations

import pytest

from derive.context import Theory
from derive.kernel import Rejected
from derive.terms import Dot, Equation, Identity, Image, MissingInverse, Symbol, Term, lower
from derive.theory import THEORIES, duality, kalman_bucy, luenberger, regulator, theory
from derive.theory.builder import Builder, NotDerived
from derive.theory.exact import riccati_roots, value
from derive.theory.luenberger_formulas import innovation, optimal_gain, riccati_step
from derive.theory.regulator import cost_of_gain, cost_rate, cost_to_go, regulator_gain, weight

RESTS_ON = {
    "cost of an input": {"plant", "cost to go", "optimal gain", "S_k >= 0", "R > 0"},
    "optimal input": {"plant", "cost to go", "optimal gain", "S_k >= 0", "R > 0"},
    "steady cost of a gain": {"steady cost to go", "steady gain", "S >= 0", "R > 0"},
    "image of the steady weight": set(),
    "image of the Riccati equation": {"Riccati equation"},
    "image of the steady gain": {"steady gain of the observer"},
    "image of the completed square": {"Riccati recursion", "gain of the observer", "P_{k-1} >= 0", "R > 0"},
    "image of the observer's Riccati equation": {"steady cost to go"},
    "image of the observer's gain": {"steady gain"},
    "gain there and back": set(),
    "image of the printed gain": set(),
    "rate of the cost": {
        "plant in continuous time",
        "cost to go in continuous time",
        "optimal gain in continuous time",
        "R > 0",
    },
    "image of the Riccati equation in continuous time": {
        "cost to go in continuous time",
        "Riccati equation in continuous time",
    },
    "image of the gain in continuous time": {"gain of the observer in continuous time"},
    "image of the algebraic Riccati equation": {"steady covariance in continuous time"},
    "image of the filter's gain": {"steady gain in continuous time"},
}


@pytest.fixture(scope="module")
def lecture():
    return duality.lecture()


@pytest.fixture
def taught(lecture):
    b = Builder(duality.theory(), "test", "test")
    for step in lecture.steps:
        b.record(step)
    return b


@pytest.fixture
def s():
    return duality.theory().symbols


@pytest.mark.parametrize("name", RESTS_ON)
def test_what_a_theorem_rests_on(lecture, name):
    assert lecture.rests_on(name) == RESTS_ON[name]


def test_results_are_functions(lecture, s):
    assert duality.gain_image().statement.rhs == s["L"].T
    assert duality.riccati_image().statement.rhs == s["P"]


def test_the_observer_is_the_one_of_its_lectures(s):
    """What this theory defines as the observer's equations is what the other lectures prove."""
    t = duality.theory()
    assert t.statement("Riccati equation").rhs == luenberger.algebraic_riccati().statement.rhs
    assert t.statement("steady gain of the observer").rhs == luenberger.steady_gain().statement.rhs
    ours = t.statement("steady covariance in continuous time").lhs
    assert spelled(ours).replace("P_inf", "P") == spelled(kalman_bucy.riccati().statement.lhs)


def spelled(term: Term) -> str:
    """Return a term as text that does not depend on the names of dimensions."""
    return (
        term.name if isinstance(term, Symbol) else f"{type(term).__name__}({' '.join(map(spelled, term.children()))})"
    )


@pytest.mark.parametrize("key", ["lqr-dt", "lqr-ct"])
def test_regulator_theories(key):
    """The regulator is derived over its own theory as well, with inputs of any dimension."""
    t = theory(key)
    assert t.key == key
    assert {"A", "B", "Q", "R", "S", "K"} <= set(t.symbols)
    assert t.symbols["B"].cols == "p"
    b = Builder(t, key, t.title)
    (regulator.derive_discrete if key == "lqr-dt" else regulator.derive_continuous)(b)
    assert [o for o in b.lecture().verify() if not o.accepted] == []
    assert key in THEORIES


# ------------------------------------------------------------------------------------------------ must reject
def refuse(b: Builder, lhs: Term, rhs: Term, *using: str):
    with pytest.raises(NotDerived):
        b.state("mutant", Equation(lhs, "=", rhs), "", using)


def test_images_with_a_piece_missing(taught, s):
    A, B, C, P, Q, R, S, L, K = (s[k] for k in ("A", "B", "C", "P", "Q", "R", "S", "L", "K"))
    gain, cost = Image("dual", regulator_gain(A, B, S, R)), Image("dual", cost_to_go(A, B, S, Q, R))
    inverse, using = innovation(C, P, R).inv, "steady gain of the observer"
    taught.state("true", Equation(gain, "=", L.T), "", [using])
    refuse(taught, gain, (P * C.T * inverse).T)  # the printed gain
    refuse(taught, gain, optimal_gain(A, C, P, R))  # without the transpose
    refuse(taught, gain, L, using)
    refuse(taught, cost, riccati_step(A.T, C, P, Q, R))
    refuse(taught, cost, riccati_step(A, C, P, R, Q))
    refuse(taught, Image("original", L), K)
    refuse(taught, Image("original", P * C.T * inverse), (weight(B, S, R).inv * B.T * S * A).T)


def test_time_is_reversed(taught, s):
    S, P = s["S_t"], s["P_t"]
    using = ["cost to go in continuous time", "Riccati equation in continuous time"]
    refuse(taught, Image("dual in continuous time", Dot(S)), Dot(P), *using)


def test_regulator_with_a_piece_missing(taught, s):
    A, B, Q, R, M, S, K, x, u = (s[k] for k in ("A", "B", "Q", "R", "M", "S_k", "K_{k-1}", "x_{k-1}", "u_{k-1}"))
    using = ["optimal gain", "cost to go", "weight_k^-1", "plant"]
    square = (M - K).T * weight(B, S, R) * (M - K)
    refuse(taught, cost_of_gain(A, B, M, S, Q, R), s["S_{k-1}"] + (M + K).T * weight(B, S, R) * (M + K), *using)
    refuse(taught, cost_of_gain(A, B, M, S, Q, R), s["S_{k-1}"] - square, *using)
    refuse(taught, K, weight(B, S, R).inv * B.T * S, *using)
    left = x.T * Q * x + u.T * R * u + s["x_k"].T * S * s["x_k"]
    wrong = (u - K * x).T * weight(B, S, R) * (u - K * x)
    refuse(taught, left, x.T * s["S_{k-1}"] * x + wrong, *using)
    rate = ["R^-1", "cost to go in continuous time", "optimal gain in continuous time", "plant in continuous time"]
    x, u, S, K = (s[k] for k in ("x", "u", "S_t", "K_t"))
    refuse(taught, Dot(x.T * S * x) + x.T * Q * x + u.T * R * u, (u - K * x).T * R * (u - K * x), *rate)
    refuse(taught, -Dot(S), cost_rate(A.T, B, S, Q, R), *rate)


def two_weights(images: dict[str, str], second: bool = True) -> Theory:
    """X and Y positive with inverses, and a map of the given letters."""
    t = Theory("weights", "Two weights")
    for name in ("X", "Y"):
        matrix = t.matrix(name, "n", "n", symmetric=True)
        t.assume(f"{name} > 0", matrix, "≻")
        if name == "X" or second:
            t.inverse(f"{name}^-1", matrix, "n", symmetric=True, because=f"{name} > 0")
    t.matrix("Z", "n", "n")
    t.maps["swap"] = {name: t.symbols[image] for name, image in images.items()}
    return t


def image_of_inverse(t: Theory) -> Term:
    return Image("swap", t.symbols["X"].inv)


def test_a_map_sends_inverses_to_inverses():
    t = two_weights({"X": "Y", "X^-1": "Y^-1"})
    reading = t.reading()
    assert lower(image_of_inverse(t), reading) == lower(t.symbols["Y"].inv, reading)


@pytest.mark.parametrize("images", [{"X": "Y"}, {"X^-1": "Y^-1"}, {"X": "Y", "X^-1": "X^-1"}, {"X": "Y", "X^-1": "Y"}])
def test_a_map_that_sends_an_inverse_elsewhere(images):
    t = two_weights(images)
    with pytest.raises(Rejected, match="does not send X\\^-1 to the inverse of the image"):
        lower(image_of_inverse(t), t.reading())


def test_a_map_to_a_matrix_without_declared_inverse():
    t = two_weights({"X": "Y", "X^-1": "Y"}, second=False)
    with pytest.raises(MissingInverse):
        lower(image_of_inverse(t), t.reading())


def test_a_map_of_a_symmetric_letter_to_another_matrix():
    with pytest.raises(Rejected, match="sends the symmetric X to a matrix that is not"):
        two_weights({"X": "Z"}).reading()


def test_a_map_to_another_type():
    t = two_weights({})
    wide = t.matrix("U", "n", "m")
    t.maps["swap"] = {"Z": wide}
    with pytest.raises(Rejected, match="expected n x n"):
        lower(Image("swap", t.symbols["Z"]), t.reading())


def test_an_image_is_no_consequence():
    """A map need not respect the relations, so that equal terms may have different images."""
    t = two_weights({"X": "Y", "X^-1": "Y^-1"})
    t.assume("X X = I", t.symbols["X"] * t.symbols["X"], "=", Identity("n"))
    b = Builder(t, "test", "test")
    lhs, rhs = Image("swap", t.symbols["X"] * t.symbols["X"]), Image("swap", Identity("n"))
    refuse(b, lhs, rhs, "X X = I")
    with pytest.raises(NotDerived, match="need not respect the relations"):
        b.state("mutant", Equation(lhs, "=", rhs), "", ["X X = I"], rule="apply")


# ------------------------------------------------------------------------------------------------ errata, numbers
def test_erratum_of_the_table(lecture):
    (erratum,) = lecture.errata
    assert (erratum.source, erratum.finding) == ("002", "incomplete")
    assert erratum.true == lecture.step(erratum.proved_by).statement
    assert dict(erratum.evidence[0].results) == {
        "closed loop with the gain of the regulator": "(3 − √5)/2 ≈ 0.382",
        "closed loop with the image of the printed gain": "(7 − √5)/4 ≈ 1.191",
    }


def test_scalar_regulator_and_observer_have_equal_gains(s):
    """For 1 x 1 plants transposes do nothing: K of (A, B) is L of (A, C = B)."""
    for a, b in ((2, 1), (1, 3), (-3, 2)):
        cost = riccati_roots(a, b, 1, 1)[-1]
        K = value(regulator_gain(s["A"], s["B"], s["S"], s["R"]), {"A": a, "B": b, "R": 1, "S": cost})
        L = value(optimal_gain(s["A"], s["C"], s["P"], s["R"]), {"A": a, "C": b, "R": 1, "P": cost})
        assert K == L
        assert abs(float(a - b * K)) < 1
