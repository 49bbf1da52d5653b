"""False statements about every number of steps, and about functions of s, ω or t, that a forged proof might get past.

Each is the smallest that one gap would let through. The theories are satisfiable.
"""

from __future__ import annotations

import re
from dataclasses import replace
from fractions import Fraction

import pytest

from derive.context import Theory
from derive.derivation import Proof, Step, verify
from derive.functions import ON_CIRCLE, Definite, Exp, Infinity, Limit, Log, Power, Quotient, Rate
from derive.induction import Induction, claim_of
from derive.kernel import Certificate, Poly, Rejected
from derive.kernel import Term as Addend
from derive.real import HYPOTHESIS, NEGATION, Sign, SignProduct, constant, scalar
from derive.rules import Positivity, Square
from derive.spectral import At, Det, Modulus, RealPart, Roots
from derive.terms import Equation, Identity, Neg, Number, Product, Symbol, Term, Trace, Zero
from tests.derive.scalar.test_false_statements import linked, same, sign
from tests.derive.scalar.test_induction import counting, free, sequence

ZERO, ONE, NONE, UNIT = Zero("", ""), Number(Fraction(1)), Number(Fraction(0)), Fraction(1)


def number(n: int) -> Number:
    return Number(Fraction(n))


def theory(*scalars: str) -> tuple[Theory, list[Symbol]]:
    t = Theory("attack", "A theory for one attack")
    return t, [t.scalar(name) for name in scalars]


def complaints(t: Theory, *steps: Step) -> list[str]:
    """Return why the last step is not accepted, or the theory itself is not."""
    try:
        outcomes = verify(t, steps)
    except Rejected as error:
        return [str(error)]
    return [] if outcomes[-1].accepted else [o.message for o in outcomes if not o.accepted]


def refused(t: Theory, *steps: Step, match: str) -> None:
    found = complaints(t, *steps)
    assert any(re.search(match, message) for message in found), found


def accepted(t: Theory, *steps: Step) -> None:
    outcomes = verify(t, steps)
    assert all(o.accepted for o in outcomes), [o for o in outcomes if not o.accepted]


def use(name: str, coefficient: int = 1, *scalars: str) -> Addend:
    return Addend(Fraction(coefficient), tuple(sorted(scalars)), (), name, False, ())


def identity(name: str, lhs: Term, rhs: Term, claim: Poly, *terms: Addend, uses: tuple[str, ...] = ()) -> Step:
    proof = Proof(identities=(Certificate(claim, terms),))
    return Step(name, Equation(lhs, "=", rhs), "scalar", (), proof, uses, lemma=True)


def induction(t: Theory, statement: Equation, *step: Addend, uses: tuple[str, ...]) -> Step:
    """An induction of an equation that is an identity at the start."""
    reading = t.reading()
    claim = claim_of(statement, reading)
    proof = Proof(identities=(Certificate(claim.start), Certificate(claim.later, step)))
    starts = tuple(p.name for p in reading.real.sequences.values())
    return Step("every k", statement, "induction", (), proof, (*uses, *starts), lemma=True)


# ------------------------------------------------------------------------------------------------ what a step rests on
@pytest.mark.parametrize("name", ["L.left", "L[1,1]", "L"])
def test_a_lemma_whose_name_hides_what_it_rests_on(name: str):
    """y_{k+1} = y_k + k is not 0 for every k; k = 0 is a case, and a lemma called L.left is no part of an L."""
    t, (k,) = theory("k")
    y = sequence(t, "y", NONE, lambda y: y + k)
    t.assume("k = 0", k, "=", ZERO, case=True)
    lemma = identity(name, k, ZERO, scalar("k"), use("k = 0"), uses=("k = 0",))
    claim = induction(t, Equation(y, "=", ZERO), use("y'"), use(HYPOTHESIS), use(name), uses=("y'", name, "L"))
    refused(t, lemma, claim, match="holds k at some value" if name == "L" else "the name of a part of L")


def test_a_lemma_by_the_name_of_what_is_known_anyhow():
    """What is called In, as the identity matrix is, need not be named by the steps that use it."""
    t, (x,) = theory("x")
    t.matrix("A", "n", "n")
    refused(t, same(x, x, "In"), match="is taken")
    accepted(t, same(x, x, "of size n"))


@pytest.mark.parametrize("name", [HYPOTHESIS, NEGATION, "M.left"])
def test_a_declaration_by_a_name_that_no_certificate_has_to_give(name: str):
    t, (k,) = theory("k")
    counting(t)
    t.assume(name, k, "=", ZERO, case=True)
    refused(t, same(k, k), match="a name of its own")


def test_a_number_that_is_nonnegative_for_some_steps_only():
    """c = k - 5 is not nonnegative for every k, nor is y_{k+1} = y_k + c tr P^2: that is -5 tr P^2 for k = 1."""
    t, (k,) = theory("k")
    c, P = t.scalar("c", nonnegative=True), t.matrix("P", "n", "n", symmetric=True)
    t.define("c", c, k - number(5))
    t.assume("P psd", P, "⪰", Zero("n", "n"))
    t.atom("spectral", Trace(P * P), name="tr PP")
    y = sequence(t, "y", NONE, lambda y: y + c * Trace(P * P))
    p, one = Poly({(("c",), ("P",)): 1}, "n", "n"), Poly({((), ()): 1}, "n", "n")
    square = Positivity(((p,),), (Square(UNIT, ("c",), ((one,),), "P psd"),), (((),),))
    statement = Equation(y, "≥", ZERO)
    products = [SignProduct(UNIT, (fact,)) for fact in (NEGATION, HYPOTHESIS, "trace")]
    signs = Induction(
        Sign(constant(0), "≥", (SignProduct(UNIT, (NEGATION,)),), ()),
        Sign(scalar("y'"), "≥", tuple(products), (use("y'", -1),)),
    )
    refused(
        t,
        Step("c P", Equation(c * P, "⪰", Zero("n", "n")), "positivity", (), Proof(positivity=square), lemma=True),
        linked(Equation(Trace(c * P * P), "≥", ZERO), "positive", "c P", "P psd", name="trace"),
        Step("every k", statement, "induction", (), Proof(induction=signs), ("y at the start",), lemma=True),
        match="stands for another",
    )


# ------------------------------------------------------------------------------------------------ what varies
def test_a_sequence_that_grows_with_time():
    """x_k = k c t is not constant in t, which occurs in the integral from 0 to t alone."""
    t, (_, time, tau, c) = theory("k", "t", "τ", "c")
    t.atom("integral", c, name="∫ c")
    x = sequence(t, "x", NONE, lambda x: x + Definite(c, tau, ZERO, time))
    refused(t, same(Rate(x, time), ZERO), match="derivative of x")
    refused(t, same(Limit(x, time, Infinity()), x), match="limit of x")


def test_a_hypothesis_that_holds_t_through_an_integral():
    """h = ∫ c over (0, t) is 3 for one t; its limit is not 3."""
    t, (time, tau, c, h) = theory("t", "τ", "c", "h")
    t.atom("integral", c, name="∫ c")
    t.define("h", h, Definite(c, tau, ZERO, time))
    t.assume("h = 3", h, "=", number(3), case=True)
    three, poly = number(3), scalar("h") - constant(3)
    above = sign(Equation(ZERO, "≥", h - three), -poly, [SignProduct(UNIT, (NEGATION,))], [use("h = 3")], "above")
    below = sign(Equation(ZERO, "≥", three - h), poly, [SignProduct(UNIT, (NEGATION,))], [use("h = 3", -1)], "below")
    accepted(t, above, below)
    whole = linked(Equation(Limit(h, time, Infinity()), "=", three), "squeeze", "above", "below", name="limit")
    refused(t, above, below, whole, match="h = 3, which holds t")


@pytest.mark.parametrize("where", ["axis", "circle"])
def test_a_hypothesis_that_holds_a_frequency_through_a_logarithm(where: str):
    """g = ln|p(z)| is 5 at one ω; its integral is not that of 5."""
    t, (s, j, w, i, m, g) = theory("s", "j", "ω", "i", "m", "g")
    p = Roots(s, t.roots("λ", i, m), i, m)
    t.atom("spectral", p, name="p")
    log = Log(Modulus(At(p, s, Product((j, w)) if where == "axis" else ON_CIRCLE)))
    t.atom("spectral", log, name="ln|p|")
    t.define("g", g, log)
    t.assume("g = 5", g, "=", number(5), case=True)
    for body, name in ((g, "∫ g"), (number(5), "∫ 5")):
        t.atom("improper", body, name=name)
    lemma = identity("lemma", g, number(5), scalar("g") - constant(5), use("g = 5"), uses=("g = 5",))
    accepted(t, lemma)
    sides = [Definite(body, w, ZERO, Infinity()) for body in (g, number(5))]
    refused(t, lemma, linked(Equation(sides[0], "=", sides[1]), "same argument", "lemma"), match="g = 5, which holds ω")


def test_a_number_is_not_every_s():
    """tr A = s holds at one s, though a trace occurs in it: h = (s - tr A + 1) p is p there, and |h| is not |p|."""
    t, (s, j, w, i, m, h) = theory("s", "j", "ω", "i", "m", "h")
    A = t.matrix("A", "n", "n")
    p, axis = Roots(s, t.roots("λ", i, m), i, m), Product((j, w))
    t.atom("spectral", Trace(A), name="tr A")
    t.atom("spectral", p, name="p")
    t.define("h", h, s * p - Trace(A) * p + p)
    t.assume("tr A = s", Trace(A), "=", s, case=True)
    for f in (h, p):
        t.atom("spectral", Log(Modulus(At(f, s, axis))), name=f"ln {len(t.declared)}")
    lemma = identity(
        "lemma", h, p, scalar("h") - scalar("p"), use("h"), use("tr A = s", -1, "p"), uses=("h", "tr A = s")
    )
    accepted(t, lemma)
    sides = [Log(Modulus(At(f, s, axis))) for f in (h, p)]
    refused(
        t, lemma, linked(Equation(sides[0], "=", sides[1]), "same argument", "lemma"), match="tr A = s, which holds s"
    )


def test_a_matrix_that_hides_s():
    """M = sA is no real matrix: tr M is not constant in s, nor is sI - M the matrix whose roots are numbered."""
    t, (s,) = theory("s")
    A, M = t.matrix("A", "n", "n"), t.matrix("M", "n", "n")
    t.define("M", M, s * A)
    t.atom("spectral", Trace(M), name="tr M")
    refused(t, same(Limit(Trace(M), s, Infinity()), Trace(M)), match="M is not declared to be complex")
    t, (s,) = theory("s")
    A, M, N = (t.matrix(name, "n", "n") for name in "AMN")
    t.complex.add("N")
    t.define("N", N, s * Identity("n") - A)
    t.define("M", M, 2 * N)
    t.atom("spectral", Det(M), name="det M")
    refused(t, same(Det(M), Det(M)), match="M is not declared to be complex")


# ------------------------------------------------------------------------------------------------ the number of steps
def test_the_number_of_steps_is_no_variable_of_integration():
    t, (k, time, tau) = theory("k", "t", "τ")
    counting(t)
    t.atom("integral", time * time, name="∫ t^2")
    whole = [Definite(x * x, x, ZERO, time) for x in (tau, k)]
    accepted(t, same(whole[0], whole[0]))
    refused(t, same(whole[1], whole[0]), match="do not vary continuously")


def test_a_recursion_in_which_the_next_member_drops_out():
    """c + 0 x_{k+1} = k is said of every k, and c is a number."""
    t, (k, c) = theory("k", "c")
    free(t)
    t.recur("goes on", c + NONE * t.symbols["x'"], k)
    refused(t, same(k, k), match="drops out")


# ------------------------------------------------------------------------------------------------ functions and limits
def test_an_integral_across_a_pole_that_a_hypothesis_excludes():
    """∫ -1/(ω - 3)^2 dω over (0, ∞) is not 1/3, though ω ≠ 3 for the ω of a hypothesis."""
    t, (w,) = theory("ω")
    t.assume("ω ≠ 3", w - number(3), "≠")
    t.atom("reciprocal", w - number(3), "ω ≠ 3", "1/(ω-3)")
    over = Quotient(ONE, w - number(3))
    body = Neg(Power(over, 2))
    t.atom("improper", body, name="∫")
    ends = [
        same(Limit(over, w, Infinity()), ZERO, "high"),
        same(Limit(over, w, ZERO), Neg(Quotient(ONE, number(3))), "low"),
    ]
    whole = linked(Equation(Definite(body, w, ZERO, Infinity()), "=", Quotient(ONE, number(3))), "integral",
                   "rate", "high", "low", name="whole")  # fmt: skip
    accepted(t, same(over, over))
    refused(t, same(Rate(over, w), body, "rate"), *ends, whole, match="ω ≠ 3, which holds ω")


def decaying() -> tuple[Theory, Term, Symbol]:
    """e^{-(c - 3) z}, with c > 3 as a case, and as a lemma that rests on it."""
    t, (c, z) = theory("c", "z")
    t.assume("case", c - number(3), ">", ZERO, case=True)
    body = Neg(Product((c - number(3), z)))
    t.atom("exp", body, name="e")
    return t, Exp(body), z


def test_a_limit_that_needs_a_case():
    t, e, z = decaying()
    c = t.symbols["c"]
    products = [SignProduct(UNIT, ("case",)), SignProduct(UNIT, (NEGATION,))]
    lemma = sign(Equation(c - number(3), ">", ZERO), scalar("c") - constant(3), products, [], "lemma")
    limit = same(Limit(e, z, Infinity()), ZERO, "limit")
    for names in (("case",), ("lemma",)):
        accepted(t, lemma, replace(limit, uses=names))
    refused(t, lemma, limit, match="the limit of e is not known")
    again = replace(limit, name="again")
    accepted(t, lemma, replace(limit, uses=("lemma",)), replace(again, uses=("limit",)))
    refused(t, lemma, replace(limit, uses=("lemma",)), again, match="the limit of e is not known")


def test_two_limits_in_two_cases():
    """e^{cz} tends to 0 or is 1, as c < 0 or c = 0; that in the case which a step names counts."""
    t, (c, z) = theory("c", "z")
    t.atom("exp", c * z, name="e")
    limit = Limit(Exp(c * z), z, Infinity())
    for name, x in (("to 0", ZERO), ("to 1", ONE)):
        t.assume(name, limit, "=", x, case=True)
    for case, x, y in (("to 0", ZERO, ONE), ("to 1", ONE, ZERO)):
        accepted(t, replace(same(limit, x), uses=(case,)))
        refused(t, replace(same(limit, y), uses=(case,)), match="another claim")
        refused(t, same(limit, x), match="not known")


def test_the_limit_of_a_sum_in_a_case():
    t, (c, z) = theory("c", "z")
    t.atom("exp", c * z, name="e")
    limit = Limit(z * Exp(c * z) + Exp(c * z), z, Infinity())
    t.assume("to 0", limit, "=", ZERO, case=True)
    accepted(t, replace(same(limit, ZERO), uses=("to 0",)))
    refused(t, same(limit, ZERO), match="not known")


def test_an_integral_that_is_nonnegative_in_a_case():
    """∫ c over (0, t) is negative for t < 0; that t ≥ 0 is a case, which no step names."""
    for case in (False, True):
        t, (time, tau, c) = theory("t", "τ", "c")
        t.assume("t ≥ 0", time, "≥", case=case)
        t.assume("c > 0", c, ">")
        t.atom("integral", c, "c > 0", name="∫ c")
        products = [SignProduct(UNIT, (fact,)) for fact in ("∫ c ≥ 0", NEGATION)]
        step = sign(Equation(Definite(c, tau, ZERO, time), "≥", ZERO), scalar("∫ c"), products)
        if case:
            refused(t, step, match="no fact")
        else:
            accepted(t, step)


# ------------------------------------------------------------------------------------------------ no roots at all
def numbered(*conditions: tuple[str, str, int, int]) -> tuple[Theory, Symbol]:
    """A number c and roots λ, of each of which relations a Re λ + b c are declared; there need not be any."""
    t, (i, m, c) = theory("i", "m", "c")
    re = RealPart(t.roots("λ", i, m))
    for name, relation, a, b in conditions:
        t.assume(name, number(a) * re + number(b) * c, relation, ZERO)
    return t, c


def test_a_number_from_what_is_said_of_roots_that_may_not_exist():
    """A polynomial of degree 0 has no roots: what is said of each of them says nothing of c."""
    t, c = numbered(("left", ">", -1, 1), ("right", ">", 1, 0))
    facts = [SignProduct(UNIT, (fact,)) for fact in ("left", "right", NEGATION)]
    refused(t, sign(Equation(c, ">", ZERO), scalar("c"), facts), match="no root")
    t, c = numbered(("one", "=", 1, -1), ("two", "=", 1, -2))
    refused(t, identity("c", c, ZERO, scalar("c"), use("one"), use("two", -1)), match="no root")
    t, c = numbered(("left", "≥", -1, 1), ("right", "≥", 1, 0))
    re = RealPart(t.symbols["λ"])
    facts = [SignProduct(UNIT, (fact,)) for fact in ("left", NEGATION)]
    accepted(t, sign(Equation(c, "≥", re), scalar("c") - scalar("Re λ"), facts))


def test_a_chain_through_a_root_that_may_not_exist():
    """c = Re λ and Re λ = 0 for each root, of which there are none."""
    t, c = numbered(("one", "=", 1, -1), ("two", "=", 1, 0))
    re = RealPart(t.symbols["λ"])
    first = identity("first", c, re, scalar("c") - scalar("Re λ"), use("one", -1))
    then = identity("then", re, NONE, scalar("Re λ"), use("two"))
    accepted(t, first, then)
    refused(t, first, then, linked(Equation(c, "=", NONE), "chain", "first", "then", name="c"), match="no root")


def test_a_limit_between_bounds_for_each_root():
    """1 - c and c - 1 are at least (Re λ)^2 for each root: without roots c is any number."""
    t, c = numbered()
    z, re = t.scalar("z"), RealPart(t.symbols["λ"])
    t.assume("z > 0", z, ">")
    t.atom("reciprocal", z, "z > 0", "1/z")
    t.assume("above", ONE - c - re * re, "≥", ZERO)
    t.assume("below", c - ONE - re * re, "≥", ZERO)
    bound, steps = re * re * Quotient(ONE, z), list[Step]()
    square = scalar("Re λ") * scalar("Re λ")
    over = SignProduct(UNIT, ("z > 0",), (scalar("1/z") * scalar("Re λ"),))
    for name, gap, poly in (
        ("above", c - ONE, scalar("c") - constant(1)),
        ("below", ONE - c, constant(1) - scalar("c")),
    ):
        products = [over, SignProduct(UNIT, (name,)), SignProduct(UNIT, (), (scalar("Re λ"),))]
        products.append(SignProduct(UNIT, (NEGATION,)))
        terms = [use("1/z", 1, "1/z", "Re λ", "Re λ")]
        claim = square * scalar("1/z") - poly
        steps.append(sign(Equation(bound, "≥", gap), claim, products, terms, name=f"bound {name}"))
    accepted(t, *steps)
    last = linked(Equation(Limit(c, z, Infinity()), "=", ONE), "squeeze", "bound above", "bound below", name="limit")
    refused(t, *steps, last, match="no root")
