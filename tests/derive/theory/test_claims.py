"""What claims may use: each declaration is one of a lecture's theory, or a proved step of a lecture, replayed here."""

from __future__ import annotations

import re
from dataclasses import replace
from functools import cache
from itertools import product

import pytest

from derive.context import Declared, DeclaredFact, DeclaredInverse, Theory
from derive.derivation import learn
from derive.functions import put
from derive.kernel import Rejected, replay
from derive.matrix.positivity import prove_positive
from derive.matrix.search import prove
from derive.rules import Grid, Square
from derive.terms import Delta, Equation, Identity, Integral, Reading, Symbol, Term, Zero, lower, walk
from derive.theory import lecture, theory
from derive.theory.claims import THEORIES, claim_theory
from derive.theory.claims.base import ClaimTheory, copy

LECTURES = {
    "observer-ct": "observer",
    "covariance-ct": "covariance",
    "kalman-bucy": "kalman-bucy",
    "luenberger-dt": "luenberger",
    "lqr-ct": "duality",
    "lqr-dt": "duality",
}
# what a lecture writes otherwise: letters of the claims' theory by those of the lecture
LETTERS = {
    "observer-ct": {"P_e": "P", "L": "L*"},
    "luenberger-dt": {"Q": "Q_{k-1}", "R": "R_{k-1}", "S": "S_{k-1}"},
    "lqr-ct": {"S": "S_inf", "K": "K_inf", "S(t)": "S_t", "K(t)": "K_t"},
}
# the gain of the equations is the optimal one
HELP = {"kalman-bucy": ("optimal", "attained"), "luenberger-dt": ("optimal gain",)}
CROSS = {"luenberger-dt": "S", "kalman-bucy": "N"}
# hypotheses that no lecture declares under these letters: covariances and joint intensities are not negative, the
# start is uncertain, transitions continue each other, gain and plant are constant where two times are written alike
HYPOTHESES = {
    "observer-ct": {
        "joint noise", "S_dd >= 0", "S_rr >= 0", "sigma2 >= 0", "P_e >= 0",
        "B_ed constant", "B_er constant", "A_e constant", "L constant",
    },
    "covariance-ct": {
        *(f"{k}({t}) >= 0" for k in "NX" for t in ("t", "τ", "t0")), "joint covariance", "Phi(τ,τ)",
    },
    "kalman-bucy": {"P >= 0", "joint noise", *(f"P({t}) > 0" for t in ("t", "τ", "0"))},
    "luenberger-dt": {"P_k >= 0"},
    "lqr-ct": {"S >= 0", "S(t) >= 0", "u = -K x"},
    "lqr-dt": {"S_{k-1} >= 0", "u_{k-1} = -K x"},
}  # fmt: skip
EQUAL_TIMES = re.compile(r" at (\S+), \1$")  # a definition, at one time twice


def is_hypothesis(name: str, key: str) -> bool:
    """Tell whether a declaration is a hypothesis that is listed above, or a definition at equal times."""
    return name.split(" at ")[0] in HYPOTHESES[key] or EQUAL_TIMES.search(name) is not None


@cache
def final(key: str) -> tuple[Reading, Theory]:
    """Return what a lecture knows at its end, without what holds in cases only."""
    made = lecture(key)
    reading = made.theory.reading()
    for step in made.steps:
        reading = learn(reading, made.theory, step)
    return reading, made.theory


def everything(key: str) -> list[ClaimTheory]:
    """Return the whole theory, and that with correlated noises."""
    whole = claim_theory(key)
    assert whole.outline
    found = [whole]
    if key == "luenberger-dt":
        found.append(whole.about({*whole.outline.usual, "S"}))
        found.append(whole.about({"A", "C", "P_{k-1}", "P_k", "L_k", "P+_{k-1}", "L^f_{k-1}"}))
    if key == "kalman-bucy":
        found.append(whole.about({"A", "C", "P(t)", "K(t)", "W", "V"}))
    return found


def renamed(term: Term, letters: dict[str, str], made: Theory) -> Term:
    """Write a term in the letters of a lecture."""
    images: dict[Term, Term] = {}
    for n in walk(term):
        if isinstance(n, Symbol) and n.name in letters:
            images[n] = replace(made.symbols[letters[n.name]], args=n.args)
    return put(term, images)


def moved(term: Term, times: dict[str, str]) -> Term:
    """Write a term at other times."""

    def at(n: Term) -> Term | None:
        if isinstance(n, Symbol) and n.args:
            return replace(n, args=tuple(times.get(a, a) for a in n.args))
        if isinstance(n, Delta):
            return Delta(times.get(n.one, n.one), times.get(n.two, n.two))
        return Integral(moved(n.body, times), times.get(n.variable, n.variable)) if isinstance(n, Integral) else None

    return put(term, {n: image for n in walk(term) if (image := at(n)) is not None})


def at_t(term: Term) -> Term:
    """Write a term with one or two times as one at t, or at t and τ."""
    times = dict.fromkeys(a for n in walk(term) for a in _times(n))
    return moved(term, dict(zip(times, ("t", "τ"), strict=False))) if len(times) <= 2 else term


def over_first(term: Term) -> Term:
    """Write an integral over τ as one over τ1."""
    return moved(term, {"τ": "τ1"})


def at_first(term: Term) -> Term:
    """Write what is said of t as if it were said of τ1."""
    return moved(term, {"t": "τ1", "τ": "τ1"})


def at_both(term: Term) -> Term:
    """Write a term with two times as one at τ1 and τ2."""
    return moved(at_t(term), {"t": "τ1", "τ": "τ2"})


def _times(term: Term) -> tuple[str, ...]:
    return term.args if isinstance(term, Symbol) else (term.one, term.two) if isinstance(term, Delta) else ()


def indexed(term: Term, old: str, new: str) -> Term:
    """Write a statement on one time as one on another."""
    found = [n for n in walk(term) if isinstance(n, Symbol) and n.name.endswith(old)]
    return put(term, {n: replace(n, name=n.name.removesuffix(old) + new) for n in found})


def earlier(term: Term) -> Term:
    """Write a statement on the time k as one on k-1."""
    return indexed(term, "_k", "_{k-1}")


def later(term: Term) -> Term:
    """Write a statement on the time k-1 as one on k."""
    return indexed(term, "_{k-1}", "_k")


def later_noise(term: Term) -> Term:
    """Write the noise of the time k as that of a later time j."""
    found = [n for n in walk(term) if isinstance(n, Symbol) and n.name in ("w_k", "v_k")]
    return put(term, {n: replace(n, name=n.name[0] + "_j") for n in found})


WAYS = (lambda t: t, at_t, over_first, at_first, at_both, earlier, later, later_noise)


def follows(statement: Equation, by: tuple[str, ...], reading: Reading) -> bool:
    """Tell whether a statement is declared in a lecture, or follows from its named steps and inverses."""
    cases = reading.real.cases
    relations = {n: r for n, r in reading.context.relations.items() if n not in cases or n in by}
    facts = {n: f for n, f in reading.context.facts.items() if n not in cases}
    lhs = lower(statement.lhs, reading)
    if statement.relation in ("⪰", "≻"):
        kinds = ("psd", "pd") if statement.relation == "⪰" else ("pd",)
        known = any(f.kind in kinds and f.matrix == lhs for n, f in facts.items() if not by or n in by)
        return known or (statement.relation == "⪰" and _joseph(lhs, reading))
    right = lower(statement.rhs, reading) if not isinstance(statement.rhs, Zero) else None
    kept = {r: p for r, p in relations.items() if r.split("[")[0] in by or r.endswith((".left", ".right"))}
    for i, row in enumerate(lhs):
        for j, p in enumerate(row):
            claim = p - right[i][j] if right else p
            if not claim.terms or (not by and {claim, -claim} & set(relations.values())):
                continue
            found = prove(claim, kept, reading.context.alphabet, seconds=1.0) if by else None
            if found is None:
                return False
            replay(found, claim, relations, reading.context.alphabet)
    return True


def _joseph(claim: Grid, reading: Reading) -> bool:
    """Tell whether the filtered covariance is a sum of two congruences, by its Joseph form."""
    s = theory("luenberger-dt").symbols
    for after, P, L, R in (("P+", "P", "L_f", "R"), ("P+_{k-1}", "P_{k-1}", "L^f_{k-1}", "R_{k-1}")):
        if lower(s[after], reading) == claim:
            factor = Identity("n") - s[L] * s["C"]
            squares = [
                Square(1, (), lower(f, reading), h)  # type: ignore[arg-type]
                for f, h in ((factor, f"{P} >= 0"), (s[L], f"{R} > 0"))
            ]
            relations = {n: p for n, p in reading.context.relations.items() if n in ("Joseph form", "filter gain")
                         or n == "filtered covariance" or n.endswith((".left", ".right"))}  # fmt: skip
            return prove_positive(claim, replace(reading.context, relations=relations), squares) is not None
    return False


def justified(claims: ClaimTheory, name: str, by: tuple[str, str] | None) -> bool:
    """Tell whether a declaration is one of the lecture's, or the named proved step."""
    item = claims.theory.declared[name]
    key = by[0] if by else LECTURES[claims.key]
    reading, made = final(key)
    letters = LETTERS.get(claims.key, {})
    if isinstance(item, DeclaredInverse):
        return True  # its reason is one of the facts
    if isinstance(item, DeclaredFact):
        return item.case or item.kind == "invertible" or item.name in made.declared
    assert isinstance(item, Declared)
    steps = (by[1], *HELP.get(claims.key, ())) if by else ()
    sides = item.statement.lhs, item.statement.rhs
    for way, names in product(WAYS, (letters, {})):
        try:
            lhs, rhs = (renamed(way(t), names, made) for t in sides)
            if follows(Equation(lhs, item.statement.relation, rhs), steps, reading):
                return True
        except Rejected:
            continue
    return False


@pytest.mark.parametrize("key", THEORIES)
def test_every_declaration_is_one_of_a_lecture(key: str):
    wrong = [
        name
        for claims in everything(key)
        for name in claims.theory.declared
        if not is_hypothesis(name, key) and (claims.proved_by.get(name) or ("", ""))[0] != "spectrum"
        if not justified(claims, name, claims.proved_by.get(name))
    ]
    assert wrong == []


@pytest.mark.parametrize("key", THEORIES)
def test_everything_declared_comes_into_force(key: str):
    for claims in everything(key):
        assert claims.reading.adopted == claims.theory.declared.keys()
        assert claims.proved_by.keys() | claims.optimal | claims.added <= claims.theory.declared.keys()


def test_a_wrong_declaration_is_noticed():
    claims = claim_theory("luenberger-dt").about({"L", "P", "A", "C"})
    wrong = copy(claims.theory)
    L, P, C, R = (wrong.symbols[k] for k in "LPCR")
    wrong.assume("steady gain", L, "=", P * C.T * (C * P * C.T + R).inv)
    assert justified(claims, "steady gain", ("luenberger", "steady gain"))
    assert not justified(replace(claims, theory=wrong), "steady gain", ("luenberger", "steady gain"))
    assert not justified(claims, "Riccati equation", ("luenberger", "steady gain"))


def test_cross_covariance_of_the_filter_is_declared_in_the_lecture_on_its_spectrum():
    claims = claim_theory("kalman-bucy").about({"P", "K", "N"})
    declared = theory("spectrum").declared
    letters = {"P": "P_N", "K": "K_N"}
    for name, (key, step) in claims.proved_by.items():
        if key == "spectrum":
            item, wanted = claims.theory.declared[name], declared[step]
            assert isinstance(item, Declared)
            assert isinstance(wanted, Declared)
            made = theory("spectrum")
            found = Equation(
                renamed(item.statement.lhs, letters, made), "=", renamed(item.statement.rhs, letters, made)
            )
            assert found == wanted.statement


def test_with_a_cross_covariance_the_noises_are_correlated():
    claims = claim_theory("luenberger-dt").about({"S", "w_k", "v_k"})
    item = claims.theory.declared["w and v at k"]
    assert isinstance(item, Declared)
    assert item.statement.rhs == claims.theory.symbols["S"]


@pytest.mark.parametrize(
    ("key", "optimal"),
    [
        ("observer-ct", {"optimal gain"}),
        ("covariance-ct", set()),
        ("kalman-bucy", {"steady gain", "gain at t"}),
        ("luenberger-dt", {"steady gain", "gain"}),
        ("lqr-ct", {"steady gain", "gain at t", "u = -K x"}),
        ("lqr-dt", {"steady gain", "optimal gain at k-1", "u_{k-1} = -K x"}),
    ],
)
def test_what_holds_for_the_optimal_gain_only_is_marked(key: str, optimal: set[str]):
    assert {name for name in claim_theory(key).optimal if not name.endswith(("at τ", "at t0"))} == optimal


def test_what_is_declared_at_t_is_declared_at_the_times_of_a_claim():
    claims = claim_theory("kalman-bucy").about({"P(t)", "K(t)", "@t0"})
    assert {"gain at t", "gain at t0"} <= claims.theory.declared.keys()
    claims = claim_theory("observer-ct").about({"A_e", "L", "@τ"})
    assert {"A_e", "A_e at τ", "optimal gain at τ"} <= claims.theory.declared.keys()


def test_transitions_continue_each_other():
    claims = claim_theory("covariance-ct").about({"Phi", "X", "Phi@t,τ", "Phi@τ,t0", "@t", "@τ", "@t0"})
    assert "Phi(t,t0) by way of τ" in claims.theory.declared
    assert {"X since τ", "noise since τ >= 0", "Phi(t,τ) regular"} <= claims.theory.declared.keys()
    alone = claim_theory("covariance-ct").about({"Phi", "Phi@t,τ", "@t", "@τ"})
    assert not any("by way of" in name for name in alone.theory.declared)


def test_what_bears_on_a_claim_is_small():
    claims = claim_theory("luenberger-dt").about({"P", "L", "A", "C"})
    assert "gain" not in claims.theory.declared
    assert "Riccati equation" in claims.theory.declared
    assert claims.optimal == {"steady gain"}


def test_cross_covariance_is_zero_unless_it_is_mentioned():
    claims = claim_theory("luenberger-dt")
    assert "Riccati equation" in claims.about({"P", "Q"}).theory.declared
    assert "Riccati equation with cross-covariance" in claims.about({"P", "S"}).theory.declared


def test_noise_with_an_index_varies():
    claims = claim_theory("luenberger-dt").about({"P_k", "P_{k-1}", "Q_{k-1}"})
    assert "Q_{k-1} >= 0" in claims.theory.declared
    assert "constant Q_{k-1}" not in claims.theory.declared
    both = claim_theory("luenberger-dt").about({"P_k", "P_{k-1}", "Q_{k-1}", "Q"})
    assert "constant Q_{k-1}" in both.theory.declared
