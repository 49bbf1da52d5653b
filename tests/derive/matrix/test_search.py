"""The prover decides the theorem table; what it proves replays, and what is random but true is found."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from derive.kernel import Certificate, Letter, Poly, Rejected, Term, replay
from derive.matrix import prove
from derive.matrix.order import weigh
from tests.reference.algebra import Setting
from tests.reference.mutants import mutants
from tests.reference.theorems import Theorem, theorems

ALL = theorems()


def search(theorem: Theorem, **options) -> Certificate | None:
    problem = theorem.hypotheses
    return prove(theorem.claim, problem.relations, problem.alphabet, trace=theorem.trace, **options)


def check(certificate: Certificate | None, theorem: Theorem) -> None:
    assert certificate is not None
    replay(certificate, theorem.claim, theorem.hypotheses.relations, theorem.hypotheses.alphabet)


@pytest.mark.parametrize("theorem", [t for t in ALL if t.true and t.provable], ids=lambda t: t.name)
def test_true_theorems_are_proved(theorem):
    check(search(theorem), theorem)


@pytest.mark.parametrize("theorem", [t for t in ALL if not (t.true and t.provable)], ids=lambda t: t.name)
def test_false_claims_and_those_of_finite_dimension_only_are_not_proved(theorem):
    assert search(theorem, seconds=1) is None


@pytest.mark.parametrize("theorem", mutants(ALL), ids=lambda t: t.name)
def test_mutants_are_not_proved(theorem):
    assert search(theorem, seconds=0.05) is None


# ------------------------------------------------------------------------------------------------ what drives the order
def test_definitions_are_substituted():
    s = Setting()
    A, K, F = s.matrices("A K F", "n", "n")
    s.assume("F := A - K", F - A + K)
    s.assume("K := A A", K - A * A)
    claim = F * A - A * F
    certificate = prove(claim.poly, s.relations, s.alphabet)
    replay(certificate, claim.poly, s.relations, s.alphabet)
    assert {t.relation for t in certificate.terms} == {"F := A - K", "K := A A"}


def test_circular_definitions_do_not_hang():
    s = Setting()
    X, Y = s.matrices("X Y", "n", "n")
    s.assume("X", X - Y * Y)
    s.assume("Y", Y - X * X)
    claim = X - X * X * X * X
    replay(prove(claim.poly, s.relations, s.alphabet), claim.poly, s.relations, s.alphabet)


def test_weights():
    s = Setting()
    A, B, X, Y = s.matrices("A B X Y", "n", "n")
    s.assume("Y", Y - X * X)
    s.assume("X", X - A * B * A)
    assert weigh(s.relations, ()) == {"X": 4, "Y": 9}
    assert weigh(s.relations, ("B",))["X"] > weigh({}, ("B",))["B"] > 1000
    s.relations.clear()
    s.assume("Riccati", A * X + X * A.T + B - X * Y * X)
    assert weigh(s.relations, ()) == {"B": 4}


def test_eliminated_letters_lead():
    s = Setting()
    A, B, C, X = s.matrices("A B C X", "n", "n")
    s.assume("X A = B C B", X * A - B * C * B)
    claim = A * X * A - A * B * C * B
    certificate = prove(claim.poly, s.relations, s.alphabet, eliminate=("X",))
    replay(certificate, claim.poly, s.relations, s.alphabet)


def test_limits_of_degree_and_time():
    hua = next(t for t in ALL if t.name == "Hua")
    assert search(hua, max_degree=1) is None
    assert search(hua, seconds=0) is None
    assert search(hua) is not None


# ------------------------------------------------------------------------------------------------ central scalars
def test_a_leading_scalar_is_not_divided_by():
    s = Setting()
    X, t = s.matrix("X", "n", "n"), s.scalar("s")
    s.assume("s X = 0", t * X)
    assert prove(X.poly, s.relations, s.alphabet) is None
    assert prove((t * (X * X)).poly, s.relations, s.alphabet) is not None


def test_scalars_meet_across_a_gap():
    s = Setting()
    A, B, F, G, W = s.matrices("A B F G W", "n", "n")
    t = s.scalar("s")
    s.assume("s F", t * (F * A) - A)
    s.assume("s G", t * (G * B) - B)
    claim = A * W * G * B - F * A * W * B
    certificate = prove(claim.poly, s.relations, s.alphabet)
    replay(certificate, claim.poly, s.relations, s.alphabet)


def test_two_central_relations():
    s = Setting()
    X, z, zi, q = s.matrix("X", "n", "m"), s.scalar("z"), s.scalar("zi"), s.scalar("q")
    s.central("z zi = 1", (1, ("z", "zi")), (-1, ()))
    s.central("q = 2 z", (1, ("q",)), (-2, ("z",)))
    claim = q * (zi * X) - 2 * X
    replay(prove(claim.poly, s.relations, s.alphabet), claim.poly, s.relations, s.alphabet)
    assert prove((z * X - zi * X).poly, s.relations, s.alphabet) is None
    s.central("z zi = 2", (1, ("z", "zi")), (-2, ()))
    replay(prove(X.poly, s.relations, s.alphabet), X.poly, s.relations, s.alphabet)


def test_a_relation_among_scalars_of_one_size_stays_there():
    s = Setting()
    X, Y, z = s.matrix("X", "n", "n"), s.matrix("Y", "m", "m"), s.scalar("z")
    s.assume("z I_n = I_n", z * s.eye("n") - s.eye("n"))
    claim = z * X - X
    replay(prove(claim.poly, s.relations, s.alphabet), claim.poly, s.relations, s.alphabet)
    assert prove((z * Y - Y).poly, s.relations, s.alphabet) is None
    identity = z * s.eye("m") - s.eye("m")
    assert prove(identity.poly, s.relations, s.alphabet) is None


# ------------------------------------------------------------------------------------------------ integrals
def integral_setting():
    s = Setting()
    s.matrix("Phi", "n", "n"), s.matrix("T", "n", "n"), s.matrix("A", "n", "n")
    flow = Poly({((), ("Phi@t,τ",)): 1}, "n", "n")
    s.relations["T"] = Poly({((), ("T",)): 1}, "n", "n") - flow.scale(1, ("∫τ",))
    return s, flow


def test_integrals_are_opaque_scalars():
    s, flow = integral_setting()
    A, T = (Poly({((), (x,)): 1}, "n", "n") for x in "AT")
    claim = A * T - A * flow.scale(1, ("∫τ",))
    replay(prove(claim, s.relations, s.alphabet), claim, s.relations, s.alphabet)


def test_a_rule_with_an_integral_leaves_its_variable_alone():
    s, _ = integral_setting()
    T, outside = Poly({((), ("T",)): 1}, "n", "n"), Poly({((), ("Phi@τ,t0",)): 1}, "n", "n")
    captured = Poly({((), ("T", "Phi@τ,t0")): 1, (("∫τ",), ("Phi@t,τ", "Phi@τ,t0")): -1}, "n", "n")
    assert prove(captured, s.relations, s.alphabet) is None
    with pytest.raises(Rejected, match="captured"):
        replay(
            Certificate(captured, (Term(Fraction(1), (), (), "T", False, ("Phi@τ,t0",)),)),
            captured,
            s.relations,
            s.alphabet,
        )
    assert prove(T * outside - T * outside, s.relations, s.alphabet) is not None


def test_an_overlap_that_an_integral_would_capture_is_left_alone():
    s, _ = integral_setting()
    s.matrices("B G", "n", "n")
    s.relations["A T"] = Poly({((), ("A", "G")): 1, (("∫τ",), ("Phi@t,τ",)): -1}, "n", "n")
    s.relations["G Phi"] = Poly({((), ("G", "Phi@τ,t0")): 1, ((), ("B", "B")): -1}, "n", "n")
    claim = Poly({((), ("A", "B", "B")): 1, (("∫τ",), ("Phi@t,τ", "Phi@τ,t0")): -1}, "n", "n")
    assert prove(claim, s.relations, s.alphabet) is None


def test_deltas_sample_what_is_left():
    s = Setting()
    s.matrix("L", "n", "m"), s.matrix("R", "m", "m"), s.symmetric("S", "m")
    correlation = Poly({((), ("R@t,τ",)): 1, (("δ(t,τ)",), ("S@t",)): -1}, "m", "m")
    s.relations["white"] = correlation
    both = (("L@t", "R@t,τ", "L'@τ"), ("L@t", "S@t", "L'@t"))
    claim = Poly({((), both[0]): 1, (("δ(t,τ)",), both[1]): -1}, "n", "n")
    replay(prove(claim, s.relations, s.alphabet), claim, s.relations, s.alphabet)
    s.relations["S"] = Poly({((), ("S@t",)): 1, ((), ()): -1}, "m", "m")
    claim = Poly({((), both[0]): 1, (("δ(t,τ)",), ("L@τ", "L'@τ")): -1}, "n", "n")
    replay(prove(claim, s.relations, s.alphabet), claim, s.relations, s.alphabet)
    assert prove(claim.scale(1, ("δ(t,σ)",)), {}, s.alphabet) is None


# ------------------------------------------------------------------------------------------------ traces
def test_traces_of_identities_keep_their_size():
    s = Setting()
    A, B = s.matrix("A", "n", "m"), s.matrix("B", "m", "n")
    s.assume("A B = I", A * B - s.eye("n"))
    claim = B * A
    n, m = Poly({((), ()): 1}, "n", "n"), Poly({((), ()): 1}, "m", "m")
    assert prove(claim.poly - m, s.relations, s.alphabet, trace=True) is None
    turned = Poly({**claim.poly.terms, ((), ()): -1}, n.rows, n.cols)
    replay(prove(turned, s.relations, s.alphabet, trace=True), turned, s.relations, s.alphabet)


def test_a_relation_applies_across_the_ends_of_a_trace():
    s = Setting()
    A, B, P = s.matrix("A", "n", "n"), s.matrix("B", "n", "n"), s.symmetric("P", "n")
    s.assume("AB = P", A * B - P)
    for claim in (B * P * A - P * P, B.T * A.T * P - P * P, P * B.T * A.T - P * A * B):
        replay(prove(claim.poly, s.relations, s.alphabet, trace=True), claim.poly, s.relations, s.alphabet)
    assert prove((B * P * A - P * P).poly, s.relations, s.alphabet) is None


# ------------------------------------------------------------------------------------------------ random combinations
LETTERS = ("A", "B", "A'", "B'", "P")
words = st.lists(st.sampled_from(LETTERS), max_size=3).map(tuple)
numbers = st.fractions(min_value=-3, max_value=3, max_denominator=4).filter(bool)
addends = st.builds(
    Term, numbers, st.sampled_from([(), ("s",)]), words, st.sampled_from(["r1", "r2"]), st.booleans(), words
)
polys = st.dictionaries(st.tuples(st.just(()), words), numbers, min_size=1, max_size=3).map(lambda t: Poly(t, "n", "n"))


def expanded(terms, relations, alphabet) -> Poly:
    total = Poly({}, "n", "n")
    for t in terms:
        relation = alphabet.transpose(relations[t.relation]) if t.transposed else relations[t.relation]
        left, right = (Poly({((), w): 1}, "n", "n") for w in (t.left, t.right))
        total = total + (left * relation * right).scale(t.coefficient, t.scalars)
    return total


def free_setting() -> Setting:
    s = Setting()
    s.matrices("A B", "n", "n")
    s.letters["P"] = Letter("P", "n", "n", symmetric=True)
    s.scalar("s")
    return s


@settings(max_examples=60, deadline=None)
@given(polys, polys, st.lists(addends, min_size=1, max_size=4))
def test_combinations_of_relations_replay_and_are_found(first, second, terms):
    alphabet, relations = free_setting().alphabet, {"r1": first, "r2": second}
    claim = expanded(terms, relations, alphabet)
    replay(Certificate(claim, tuple(terms)), claim, relations, alphabet)
    found = prove(claim, relations, alphabet, max_degree=8, seconds=0.2)
    if found is not None:
        replay(found, claim, relations, alphabet)


@settings(max_examples=60, deadline=None)
@given(polys, polys, st.lists(addends, min_size=1, max_size=4), words, numbers)
def test_a_perturbed_claim_never_replays(first, second, terms, word, shift):
    alphabet, relations = free_setting().alphabet, {"r1": first, "r2": second}
    claim = expanded(terms, relations, alphabet) + Poly({((), word): shift}, "n", "n")
    with pytest.raises(Rejected):
        replay(Certificate(claim, tuple(terms)), claim, relations, alphabet)


def test_the_prover_never_changes_what_it_is_given():
    theorem = next(t for t in ALL if t.name == "Joseph form")
    before = replace(theorem, claim=Poly(dict(theorem.claim.terms), theorem.claim.rows, theorem.claim.cols))
    relations = {n: Poly(dict(p.terms), p.rows, p.cols) for n, p in theorem.hypotheses.relations.items()}
    search(theorem)
    assert (theorem.claim, theorem.hypotheses.relations) == (before.claim, relations)
