"""False claims get an exact counterexample that satisfies every hypothesis; true ones never do."""

from __future__ import annotations

import json
from dataclasses import replace
from fractions import Fraction

import pytest

from derive.claim import Counterexample, Verdict
from derive.kernel import Poly
from derive.matrix import Hypotheses, refute
from derive.matrix.plan import make_plans
from derive.matrix.recheck import confirm
from derive.rules import Context, Fact
from tests.reference.algebra import Expr, Setting
from tests.reference.mutants import mutants
from tests.reference.theorems import Theorem, theorems

ALL = theorems()


def zero(poly: Poly) -> Poly:
    return Poly({}, poly.rows, poly.cols)


def search(theorem: Theorem, seconds: float = 20.0) -> Counterexample | None:
    return refute(theorem.claim, zero(theorem.claim), theorem.hypotheses, trace=theorem.trace, seconds=seconds)


def sides(lhs: Expr, rhs: Expr, **options) -> Counterexample | None:
    return refute(lhs.poly, rhs.poly, lhs.setting.hypotheses, **options)


@pytest.mark.parametrize("theorem", [t for t in ALL if t.true], ids=lambda t: t.name)
def test_true_theorems_are_not_refuted(theorem):
    assert search(theorem, seconds=0.05) is None


@pytest.mark.parametrize("theorem", [t for t in ALL if not t.true] + mutants(ALL), ids=lambda t: t.name)
def test_false_claims_are_refuted(theorem):
    found = search(theorem)
    assert found is not None
    assert found.left != found.right
    assert confirm(found, theorem.claim, zero(theorem.claim), theorem.hypotheses)


# ------------------------------------------------------------------------------------------------ the printed gain
def printed_gain(A_in_gain: bool):
    s = Setting()
    A, C = s.matrix("A", "n", "n"), s.matrix("C", "m", "n")
    P, Q, R = s.symmetric("P", "n", "psd"), s.symmetric("Q", "n", "psd"), s.symmetric("R", "m", "pd")
    Si = s.inverse("Si", C * P * C.T + R)
    L = A * P * C.T * Si if A_in_gain else P * C.T * Si
    after = (A - L * C) * P * (A - L * C).T + Q + L * R * L.T
    return after, A * P * A.T + Q - A * P * C.T * Si * C * P * A.T


def test_the_printed_gain_of_the_luenberger_notes():
    found = sides(*printed_gain(A_in_gain=False))
    assert str(found) == "A = 2, C = P = Q = R = 1: left 7/2, right 3"
    assert sides(*printed_gain(A_in_gain=True), seconds=0.1) is None


def test_a_loewner_claim():
    """The printed gain is worse than the true one, never better."""
    printed, best = printed_gain(A_in_gain=False)
    assert sides(printed, best, relation="⪰", seconds=0.2) is None
    found = sides(best, printed, relation="⪰")
    assert found.relation == "⪰"
    assert found.left[0][0] < found.right[0][0]
    strict = sides(printed, best, relation="≻")
    assert strict.left == strict.right


def test_a_loewner_claim_that_fails_in_two_dimensions_only():
    """A A' >= A' A holds for scalars (equality) and fails for a nilpotent A."""
    s = Setting()
    A = s.matrix("A", "n", "n")
    found = sides(A * A.T, A.T * A, relation="⪰")
    assert found.sizes["n"] == 2


# ------------------------------------------------------------------------------------------------ hypotheses
def test_the_noise_of_a_riccati_equation_is_solved_for():
    s = Setting()
    A, C = s.matrix("A", "n", "n"), s.matrix("C", "m", "n")
    P, W, V = s.symmetric("P", "n", "psd"), s.symmetric("W", "n", "psd"), s.symmetric("V", "m", "pd")
    Vi = s.inverse("Vi", V)
    s.assume("riccati", A * P + P * A.T + W - P * C.T * Vi * C * P)
    s.stable("closed loop", "hurwitz", A - P * C.T * Vi * C)
    plan = make_plans(s.hypotheses, [P.poly])[0]
    assert {rule.target for rule in plan.rules} == {"W", "Vi"}
    found = sides(A * P + P * A.T, -W)
    (a,), (c,), (p,), (w,), (v,) = (found.values[x][0] for x in "ACPWV")
    assert 2 * a * p + w == p * c / v * c * p
    assert a - p * c / v * c < 0 <= min(p, w)
    assert sides(A * P + P * A.T + W, P * C.T * Vi * C * P, seconds=0.1) is None


def test_an_unstable_solution_is_no_counterexample():
    """A = 2, Q = 0 has the roots 0 and 3 of its Riccati equation; only the second stabilises."""
    s = Setting()
    A, C = s.matrix("A", "n", "n"), s.matrix("C", "m", "n")
    P, Q, R = s.symmetric("P", "n", "psd"), s.symmetric("Q", "n", "psd"), s.symmetric("R", "m", "pd")
    Si = s.inverse("Si", C * P * C.T + R)
    s.assume("riccati", A * P * A.T + Q - A * P * C.T * Si * C * P * A.T - P)
    plain = sides(P * C.T * Si * C * P, P - P)
    assert plain.values["P"] != ((0,),)
    s.stable("closed loop", "schur", A - A * P * C.T * Si * C)
    found = sides(A * P * A.T + Q, P)
    a, c, p, r = (found.values[x][0][0] for x in "ACPR")
    assert abs(a - a * p * c / (c * p * c + r) * c) < 1


def test_facts_on_expressions_and_blocks():
    s = Setting()
    W, V, N = s.symmetric("W", "n"), s.symmetric("V", "n", "pd"), s.matrix("N", "n", "n")
    s.facts["joint"] = Fact("psd", ((W.poly, N.poly), (N.T.poly, V.poly)))
    Vi = s.inverse("Vi", V)
    assert sides(W, N * Vi * N.T, relation="⪰", seconds=0.3) is None
    found = sides(W, N * Vi * N.T + V, relation="⪰")
    assert found.left < found.right
    s.facts["invertible"] = Fact("invertible", ((N.poly,),))
    assert sides(N, N - N).values["N"] != ((0,),)


def test_definitions_elsewhere_and_integrals_do_not_matter():
    s = Setting()
    A, B, X = s.matrices("A B X", "n", "n")
    s.assume("X := A B", X - A * B)
    s.relations["Y"] = Poly({(("∫τ",), ("A@τ",)): 1, ((), ("Z",)): -1}, "n", "n")
    s.matrix("Z", "n", "n")
    found = sides(A * B, B * A)
    assert "X" not in found.values
    assert sides(X, B * A).values.keys() == {"A", "B", "X"}


def test_integrals_that_matter_vanish_at_the_start():
    """X(t) = Phi X(t0) Phi' + (an integral of Phi N Phi'): at t = t0 every X(t0) >= 0 occurs."""
    s = Setting()
    s.matrix("Phi", "n", "n"), s.symmetric("N", "n", "psd"), s.matrix("A", "n", "n")
    s.symmetric("X", "n")
    X, A, N = (Poly({((), (a,)): 1}, "n", "n") for a in ("X@t", "A", "N"))
    flow = {((), ("Phi@t,t0", "X@t0", "Phi'@t,t0")): -1, (("∫τ",), ("Phi@t,τ", "N", "Phi'@t,τ")): -1}
    s.relations["X"] = X + Poly(flow, "n", "n")
    s.relations["Phi"] = Poly({((), ("Phi@t,t",)): 1, ((), ()): -1}, "n", "n")
    s.facts["X0"] = Fact("initial", ((X,),))
    found = refute(A * X, X * A, s.hypotheses)
    assert "X@t0" in found.values
    assert refute(X, zero(X), s.hypotheses, relation="⪰", seconds=0.3) is None
    assert refute(X, N, s.hypotheses, relation="⪰") is not None
    inverse = s.inverse("Ni", Expr(N, s) + s.eye("n")).poly
    assert "Ni" in refute(A * X * inverse, X, s.hypotheses).values
    integral = Poly({(("∫τ",), ("Phi@t,τ", "N", "Phi'@t,τ")): 1}, "n", "n")
    assert refute(integral, zero(X), s.hypotheses, seconds=0.1) is None
    assert refute(integral + X, zero(X), s.hypotheses) is not None


# ------------------------------------------------------------------------------------------------ a whole theory
def filter_theory():
    """The steady filter with its lemmas, another gain, and another solution of its Riccati equation."""
    s = Setting()
    A, C = s.matrix("A", "n", "n"), s.matrix("C", "m", "n")
    Q, R, P = s.symmetric("Q", "n", "psd"), s.symmetric("R", "m", "pd"), s.symmetric("P", "n", "psd")
    L, L_k, G = s.matrix("L", "n", "m"), s.matrix("L_k", "n", "m"), s.matrix("L_G", "n", "m")
    P_G, P_o = s.symmetric("P_G", "n", "psd"), s.symmetric("P_o", "n", "psd")
    Si, So = s.inverse("Si", C * P * C.T + R), s.inverse("So", C * P_o * C.T + R)

    def step(gain: Expr, X: Expr) -> Expr:
        return (A - gain * C) * X * (A - gain * C).T + Q + gain * R * gain.T

    s.assume("covariance of another gain", step(G, P_G) - P_G)
    s.assume("L_k = L", L_k - L)
    s.assume("stationary gain", L * (C * P * C.T + R) - A * P * C.T)
    s.assume("another solution", A * P_o * A.T + Q - A * P_o * C.T * So * C * P_o * A.T - P_o)
    s.assume("lemma: gain", L - A * P * C.T * Si)
    s.assume("Riccati", A * P * A.T + Q - A * P * C.T * Si * C * P * A.T - P)
    s.assume("lemma: Stein", step(L, P) - P)
    s.stable("closed loop", "schur", A - L_k * C)
    s.stable("other closed loop", "schur", A - G * C)
    return s, A, C, Q, P, L, P_G


def test_lemmas_among_the_hypotheses_do_not_get_in_the_way():
    s, A, C, Q, P, L, P_G = filter_theory()
    plan = make_plans(s.hypotheses, [P.poly])[0]
    targets = {rule.target for rule in plan.rules}
    assert targets == {"Q", "P_G", "L", "L_k", "Si", "So", "P_o", "L_G"}
    assert {rule.target for rule in make_plans(s.hypotheses, [P.poly])[1].rules} == targets - {"P_o", "L_G"}
    found = sides(A * P * A.T + Q, P)
    assert found is not None
    assert found.values["P_o"] == found.values["P"]
    assert "P_G" in found.values
    assert "P_G" not in str(found)
    assert sides(P, (A - L * C) * P * A.T + Q, seconds=0.2) is None
    assert sides(A * P, P * A.T, seconds=20).sizes["n"] == 2
    assert sides(P_G, P, relation="⪰", seconds=0.3) is None
    assert sides(P, P_G, relation="⪰") is not None


def test_deltas_vanish_between_different_times():
    s = Setting()
    S, R = s.symmetric("S", "m", "psd"), s.matrix("R", "m", "m")
    s.relations["white"] = Poly({((), ("R@t,τ",)): 1, (("δ(t,τ)",), ("S",)): -1}, "m", "m")
    s.relations["again"] = Poly({((), ("R@t,τ",)): 1, (("δ(t,τ)",), ("S",)): -1, ((), ("R@t,τ", "S")): 1}, "m", "m")
    found = sides(S * S, S)
    assert found.values["R@t,τ"] == ((0,),)
    delta = Poly({(("δ(t,τ)",), ("S",)): 1}, "m", "m")
    assert refute(delta, zero(delta), s.hypotheses) is None
    assert R.poly.rows == "m"


def test_variation_of_constants_is_met_by_the_first_value():
    s = Setting()
    A, x = s.matrix("A", "n", "n"), s.matrix("x", "n", "n")
    s.matrix("Phi", "n", "n")
    flow = {((), ("x",)): 1, ((), ("Phi@t,t0", "x@t0")): -1, (("∫τ",), ("Phi@t,τ", "A")): -1}
    s.relations["flow"] = Poly(flow, "n", "n")
    assert sides(A * x, x * A).values.keys() == {"A", "x"}
    s.relations["start"] = Poly({((), ("x@t0",)): 1, ((), ("A",)): -1}, "n", "n")
    assert sides(A * x, x * A).values.keys() >= {"x@t0"}


def test_a_linear_relation_is_solved():
    s = Setting()
    A, X, W = s.matrix("A", "n", "n"), s.symmetric("X", "n"), s.symmetric("W", "n", "pd")
    s.assume("Lyapunov", A * X + X * A.T + W * W)
    s.stable("A", "hurwitz", A)
    found = sides(X * X, X)
    assert found is not None
    assert sides(X, X - X, relation="⪰", seconds=0.3) is None


def test_central_scalars():
    s = Setting()
    X, z, zi = s.matrix("X", "n", "m"), s.scalar("z"), s.scalar("zi")
    s.central("z zi = 1", (1, ("z", "zi")), (-1, ()))
    assert sides(z * (zi * X), X, seconds=0.1) is None
    found = sides(z * X, X)
    assert found.scalars["z"] * found.scalars["zi"] == 1
    assert found.scalars["z"] != 1
    assert "z = 2" in str(found)


def test_a_relation_among_scalars_times_an_identity():
    s = Setting()
    X, z, zi = s.matrix("X", "n", "m"), s.scalar("z"), s.scalar("zi")
    s.assume("z zi = 1", z * (zi * s.eye("n")) - s.eye("n"))
    found = sides(z * X, X)
    assert found.scalars["z"] * found.scalars["zi"] == 1


def test_nonnegative_scalars():
    s = Setting()
    P, a = s.symmetric("P", "n", "psd"), s.scalar("a")
    problem = s.hypotheses
    claim = a * P
    assert refute(claim.poly, zero(claim.poly), problem, relation="⪰").scalars["a"] < 0
    problem = replace(problem, nonnegative=frozenset({"a"}))
    assert refute(claim.poly, zero(claim.poly), problem, relation="⪰", seconds=0.2) is None


def test_a_central_relation_without_solution_is_no_instance():
    s = Setting()
    X, q, z = s.matrix("X", "n", "m"), s.scalar("q"), s.scalar("z")
    s.central("(q + 1) z = 1", (1, ("q", "z")), (1, ("z",)), (-1, ()))
    assert sides(q * (z * X) + z * X, X, seconds=0.1) is None
    assert sides(q * X, X).scalars["q"] != -1


def test_scalars_commute_and_symmetric_matrices_do_not():
    s = Setting()
    a, b = s.matrices("a b", "1", "1")
    assert sides(a * b, b * a) is None
    P, Q = s.symmetric("P", "n"), s.symmetric("Q", "n", "psd")
    found = sides(P * Q, Q * P)
    assert found.sizes["n"] == 2
    assert found.values["P"][0][1] == found.values["P"][1][0]


def test_traces_of_different_sizes():
    s = Setting()
    A, B = s.matrix("A", "n", "m"), s.matrix("B", "m", "n")
    assert sides(A * B, B * A, trace=True, seconds=0.1) is None
    found = sides(s.eye("n"), s.eye("m"), trace=True)
    assert found.sizes["n"] != found.sizes["m"]


def test_contradictory_hypotheses_refute_nothing():
    s = Setting()
    P = s.symmetric("P", "n", "pd")
    s.assume("P = 0", P)
    assert sides(P, P + P, seconds=0.2) is None


# ------------------------------------------------------------------------------------------------ the second opinion
def example() -> tuple[Counterexample, Expr, Expr, Hypotheses]:
    printed, best = printed_gain(A_in_gain=False)
    found = sides(printed, best)
    assert found is not None
    return found, printed, best, printed.setting.hypotheses


@pytest.mark.parametrize(
    "change",
    [
        {"left": ((Fraction(3),),)},
        {"values": {"A": ((Fraction(1),),)}},
        {"values": {"Si": ((Fraction(1),),)}},
        {"values": {"P": ((Fraction(-1),),)}},
        {"values": {"R": ((Fraction(0),),)}},
        {"values": {"A": ((Fraction(2), Fraction(0)),)}},
        {"relation": "⪰"},
    ],
)
def test_a_changed_counterexample_is_not_confirmed(change):
    found, lhs, rhs, problem = example()
    assert confirm(found, lhs.poly, rhs.poly, problem)
    if "values" in change:
        change = {"values": {**found.values, **change["values"]}}
    assert not confirm(replace(found, **change), lhs.poly, rhs.poly, problem)


def test_each_hypothesis_is_tested_on_its_own():
    found, lhs, rhs, problem = example()
    lhs, rhs = lhs.poly, rhs.poly
    alone = replace(problem, relations={})
    wrong = replace(found, values={**found.values, "Si": ((Fraction(1),),)})
    assert confirm(found, lhs, rhs, alone)
    assert not confirm(wrong, lhs, rhs, alone)
    scalar = replace(found, scalars={"a": Fraction(-1)})
    assert confirm(scalar, lhs, rhs, problem)
    assert not confirm(scalar, lhs, rhs, replace(problem, nonnegative=frozenset({"a"})))
    lopsided = ((Fraction(0), Fraction(1)), (Fraction(0), Fraction(0)))
    s = Setting()
    P = s.symmetric("P", "n")
    none = ((Fraction(0),) * 2,) * 2
    assert not confirm(Counterexample({"n": 2}, {"P": lopsided}, lopsided, none), P.poly, zero(P.poly), s.hypotheses)


def test_hypotheses_of_a_context():
    s = Setting()
    A = s.matrix("A", "n", "n")
    s.inverse("Ai", A)
    context = Context(s.alphabet, s.relations, s.facts, frozenset({"a"}))
    problem = Hypotheses.of(context, {A.poly: "Ai"})
    assert (problem.inverses, problem.relations, problem.nonnegative) == ({"Ai": A.poly}, s.relations, {"a"})


@pytest.mark.parametrize(
    ("kind", "good", "bad"),
    [
        ("psd", [[1, 1], [1, 1]], [[1, 2], [2, 1]]),
        ("pd", [[2, 1], [1, 2]], [[1, 1], [1, 1]]),
        ("pd", [[2, 1], [1, 2]], [[2, 1], [0, 2]]),
        ("hurwitz", [[-1, 9], [0, -1]], [[0, 1], [-1, 0]]),
        ("schur", [[0, 9], [0, 0]], [[0, 1], [1, 0]]),
        ("invertible", [[0, 1], [1, 0]], [[1, 1], [1, 1]]),
        ("initial", [[-1, 0], [0, -1]], None),
    ],
)
def test_both_opinions_on_facts(kind, good, bad):
    from flint import fmpq_mat

    from derive.matrix.exact import PROPERTIES

    s = Setting()
    X = s.matrix("X", "n", "n")
    s.facts["X"] = Fact(kind, ((X.poly,),))
    for value, expected in ((good, True), (bad, False)):
        if value is not None:
            entries = tuple(tuple(map(Fraction, row)) for row in value)
            none = ((Fraction(0),) * 2,) * 2
            found = Counterexample({"n": 2}, {"X": entries}, entries, none)
            assert confirm(found, X.poly, zero(X.poly), s.hypotheses) == expected
            if kind in PROPERTIES:
                assert PROPERTIES[kind](fmpq_mat(2, 2, [x for row in value for x in row])) == expected


def test_counterexamples_are_json_and_one_line():
    found = example()[0]
    data = json.loads(json.dumps(found.to_json()))
    assert data["values"]["A"] == [["2"]]
    assert (data["left"], data["right"], data["relation"]) == ([["7/2"]], [["3"]], "=")
    matrix = replace(found, values={"A": ((Fraction(0), Fraction(1)),)}, scalars={"z": Fraction(1, 2)})
    assert str(matrix) == "A = [[0, 1]], z = 1/2: left 7/2, right 3"
    assert [str(v) for v in Verdict] == ["proved", "refuted", "supported", "undecided"]
