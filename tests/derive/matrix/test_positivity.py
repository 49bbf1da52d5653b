"""Squares are found or checked, Schur complements factor, comparisons are proved; wrong ones are not."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction

import pytest

from derive.kernel import Poly, identity
from derive.matrix import prove_comparison, prove_positive, schur_complement, schur_squares
from derive.rules import Context, Fact, Square, replay_comparison, replay_positivity
from tests.reference.algebra import Expr, Setting


def context(setting: Setting, **more) -> Context:
    facts = {**setting.facts, "I n": Fact("pd", ((identity("n"),),))}
    return Context(setting.alphabet, setting.relations, facts, **more)


def letters(names: str):
    """Return a setting with the usual letters, and those of them that are named."""
    s = Setting()
    known = {"A": s.matrix("A", "n", "n"), "B": s.matrix("B", "n", "n")}
    known |= {"L": s.matrix("L", "n", "m"), "C": s.matrix("C", "m", "n")}
    known |= {"P": s.symmetric("P", "n", "pd"), "Q": s.symmetric("Q", "n", "psd"), "R": s.symmetric("R", "m", "pd")}
    return s, *(known[name] for name in names.split())


def grid(*rows: tuple[Expr, ...]):
    return tuple(tuple(e.poly for e in row) for row in rows)


def positive(claim, context_, **options):
    proof = prove_positive(claim, context_, **options)
    return proof and replay_positivity(proof, claim, context_)


def test_squares_are_read_off_the_claim():
    s, A, B, C, L, P, Q, R = letters("A B C L P Q R")
    closed = A - L * C
    assert positive(grid((closed * P * closed.T + 3 * Q + L * R * L.T,)), context(s)) == "psd"
    assert positive(grid((A * P * A.T - A * P * B.T - B * P * A.T + 2 * (B * P * B.T),)), context(s)) == "psd"
    assert positive(grid((A * A.T + 2 * s.eye("n"),)), context(s)) == "psd"


def test_forms_that_are_not_positive():
    s, A, B, P, Q = letters("A B P Q")
    assert positive(grid((A * P * A.T - Q,)), context(s)) is None
    assert positive(grid((A * P * A.T + 2 * (A * P * B.T) + 2 * (B * P * A.T) + B * P * B.T,)), context(s)) is None
    assert positive(grid((A * P * B.T + B * P * A.T,)), context(s)) is None
    assert positive(grid((A * P * B.T,)), context(s)) is None
    assert positive(grid((A * P * A.T,)), replace(context(s), facts={})) is None


def test_identities_of_the_hypotheses_are_used():
    s, C, P, R = letters("C P R")
    Si = s.inverse("Si", C * P * C.T + R)
    K = P * C.T * Si
    joseph = (s.eye("n") - K * C, K)
    claim = grid((P - K * C * P,))
    squares = [Square(Fraction(1), (), grid((f,)), fact) for f, fact in zip(joseph, ("P pd", "R pd"), strict=True)]
    assert positive(claim, context(s), squares=squares) == "psd"
    assert positive(claim, context(s), squares=squares[:1]) is None
    assert positive(claim, context(s), squares=[replace(squares[0], fact="unknown"), squares[1]]) is None
    assert positive(claim, context(s), squares=[replace(squares[0], factor=()), squares[1]]) is None


def test_scalars_and_integrals():
    s, A, P, Q = letters("A P Q")
    a = s.scalar("a")
    claim = grid((a * (A * P * A.T) + Q,))
    assert positive(claim, context(s, nonnegative=frozenset({"a"}))) == "psd"
    assert positive(claim, context(s)) is None
    flow = Poly({(("∫τ",), ("Phi@t,τ", "Q", "Phi'@t,τ")): 1}, "n", "n")
    s.matrix("Phi", "n", "n")
    assert positive(((flow,),), context(s, nonnegative=frozenset({"∫τ"}))) == "psd"


def test_facts_on_sums():
    s, A, B, P, Q = letters("A B P Q")
    s.facts["S pd"] = Fact("psd", (((Q - P).poly,),))
    assert positive(grid((A * Q * A.T - A * P * A.T,)), context(s)) == "psd"
    assert positive(grid((A * Q * A.T - B * P * B.T,)), context(s)) is None


# ------------------------------------------------------------------------------------------------ strictness
def test_strict_positivity():
    s, A, P, Q = letters("A P Q")
    Ai = s.inverse("Ai", A)
    inverses = {poly: name for name, poly in s.inverses.items()}
    both = context(s)
    assert positive(grid((P + Q,)), both, strict=True) == "pd"
    assert positive(grid((A * P * A.T,)), both, strict=True) is None
    assert positive(grid((4 * (A * P * A.T),)), both, strict=True, inverses=inverses) == "pd"
    assert positive(grid((A.T * P * A + Q,)), both, strict=True, inverses=inverses) == "pd"
    assert positive(grid((A * P * A.T,)), both, strict=True, inverse=Ai.poly) == "pd"
    assert positive(grid((A * P * A.T,)), both, strict=True, inverse=A.poly) is None
    assert positive(grid((Q,)), both, strict=True) is None
    assert positive(grid((A * Q * A.T,)), both, strict=True, inverse=Ai.poly) is None


# ------------------------------------------------------------------------------------------------ blocks
def test_a_block_form():
    s, A, C, P, Q, R = letters("A C P Q R")
    claim = grid((A * P * A.T + Q, A * P * C.T), (C * P * A.T, C * P * C.T + R))
    assert positive(claim, context(s)) == "psd"
    worse = grid((A * P * A.T + Q, 2 * (A * P * C.T)), (2 * (C * P * A.T), C * P * C.T + R))
    assert positive(worse, context(s)) is None


def test_schur_complement():
    """[[X, Y], [Y', R]] >= 0 if X - Y R^-1 Y' >= 0 and R > 0, and back by congruence."""
    s, L, R = letters("L R")
    X, Ri = s.symmetric("X", "n"), s.inverse("Ri", R)
    claim = grid((X, L), (L.T, R))
    complement = schur_complement(claim, Ri.poly, s.alphabet)
    assert complement == grid((X - L * Ri * L.T,))
    s.facts["complement"] = Fact("psd", complement)
    squares = schur_squares(claim, Ri.poly, "complement", "R pd")
    assert positive(claim, context(s), squares=squares) == "psd"
    assert positive(claim, context(s), squares=squares[:1]) is None
    assert positive(claim, context(s), squares=schur_squares(claim, R.poly, "complement", "R pd")) is None
    del s.facts["complement"]
    s.facts["joint"] = Fact("psd", claim)
    back = Square(Fraction(1), (), ((identity("n"), -(L * Ri).poly),), "joint")
    assert positive(complement, context(s), squares=[back]) == "psd"


def test_schur_complement_of_three_blocks():
    s, A, C, L, R = letters("A C L R")
    X, Y, Ri = s.symmetric("X", "n"), s.symmetric("Y", "n"), s.inverse("Ri", R)
    claim = grid((X, A, L), (A.T, Y, C.T), (L.T, C, R))
    s.facts["complement"] = Fact("psd", schur_complement(claim, Ri.poly, s.alphabet))
    squares = schur_squares(claim, Ri.poly, "complement", "R pd")
    assert positive(claim, context(s), squares=squares) == "psd"


# ------------------------------------------------------------------------------------------------ comparison
@pytest.mark.parametrize("kind", ["lyapunov", "stein", "transient"])
def test_comparison(kind):
    s = Setting()
    M, D, F, K = s.matrix("M", "n", "n"), s.symmetric("D", "n"), s.symmetric("F", "n", "psd"), s.matrix("K", "n", "n")
    s.assume("M := K K", M - K * K)
    s.stable(
        "M", {"lyapunov": "hurwitz", "stein": "schur", "transient": "initial"}[kind], D if kind == "transient" else M
    )
    rate = K * K * D + D * M.T + F
    if kind != "transient":
        s.assume("equation", K * K * D * M.T - D + F if kind == "stein" else rate)
    full = context(s, derivatives={"D": rate.poly})

    def compare(claim=D, matrix=M, stable="M", forcing="F psd", within=full):
        proof = prove_comparison(kind, claim.poly, matrix.poly, stable, forcing, within)
        return proof and replay_comparison(proof, claim.poly, within)

    assert compare() == "psd"
    assert compare(claim=-D) is None
    assert compare(matrix=K) is None
    assert compare(stable="F psd") is None
    assert compare(forcing="missing") is None
    assert compare(forcing="M") is None
    assert compare(within=replace(full, relations={}, derivatives={})) is None
    assert compare(within=replace(full, facts={})) is None
