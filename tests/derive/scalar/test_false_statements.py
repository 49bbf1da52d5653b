"""False statements about numbers that a forged proof, or an honest theory, might get past the rules: none is accepted.

Each is the smallest that one gap would let through; the theories are satisfiable.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from fractions import Fraction

import pytest

from derive.context import Theory
from derive.derivation import Proof, Step, verify
from derive.errors import InputError
from derive.functions import (
    PI,
    Abs,
    Arctan,
    Definite,
    Exp,
    Infinity,
    Limit,
    Log,
    Power,
    Quotient,
    Rate,
    Root,
    Start,
    value,
)
from derive.kernel import ANY, Certificate, Poly, Rejected
from derive.kernel import Term as Addend
from derive.parameter import check_any_sign
from derive.real import Sign, SignProduct, constant, scalar
from derive.scalars import _continuous
from derive.serialise import Reader, to_json
from derive.spectral import At, Det, Entry, ImaginaryPart, Modulus, RealPart, Roots, TimesArctan, Total
from derive.terms import Block, Equation, Identity, Neg, Number, Product, Sum, Symbol, Term, Trace, Zero
from derive.wellformed import check_work

ZERO, ONE, TWO = Zero("", ""), Number(Fraction(1)), Number(Fraction(2))
NOTHING = Poly({}, ANY, ANY)


def theory(*scalars: str) -> tuple[Theory, list[Symbol]]:
    t = Theory("attack", "A theory for one attack")
    return t, [t.scalar(name) for name in scalars]


def same(lhs: Term, rhs: Term, name: str = "step", rule: str = "scalar", count: int = 1, lemma: bool = True) -> Step:
    """A step whose sides read the same, so that nothing remains to be certified."""
    proof = Proof(identities=tuple(Certificate(NOTHING) for _ in range(count)))
    return Step(name, Equation(lhs, "=", rhs), rule, (), proof, lemma=lemma)  # type: ignore[arg-type]


def linked(statement: Equation, rule: str, *links: str, name: str = "step") -> Step:
    return Step(name, statement, rule, (), Proof(links=links), lemma=True)  # type: ignore[arg-type]


def sign(
    statement: Equation, claim: Poly, products: Sequence[SignProduct], terms: Sequence[Addend] = (), name: str = "step"
) -> Step:
    proof = Proof(sign=Sign(claim, statement.relation, tuple(products), tuple(terms)))
    return Step(name, statement, "sign", (), proof, lemma=True)


def rejected(t: Theory, *steps: Step) -> None:
    """The last step is not accepted, or the theory itself is not."""
    try:
        outcomes = verify(t, steps)
    except Rejected:
        return
    assert not outcomes[-1].accepted


def accepted(t: Theory, *steps: Step) -> None:
    assert all(o.accepted for o in verify(t, steps)), [o for o in verify(t, steps) if not o.accepted]


# ------------------------------------------------------------------------------------------------ powers and quotients
def test_a_negative_power_below_a_line():
    t, (x,) = theory("x")
    rejected(t, same(x * Quotient(ONE, Power(TWO, -3)), x))
    rejected(t, same(x * Power(TWO, -1), x))


def test_the_reciprocal_of_a_reciprocal_that_may_not_exist():
    t, (x,) = theory("x")
    rejected(t, same(Quotient(ONE, Quotient(ONE, x)), x))
    t.assume("x ≠ 0", x, "≠")
    t.atom("reciprocal", x, "x ≠ 0", "1/x")
    accepted(t, same(Quotient(ONE, Quotient(ONE, x)), x))


def test_an_unknown_scalar():
    t, _ = theory()
    rejected(t, same(Symbol("x", scalar=True), Symbol("x", scalar=True)))


# ------------------------------------------------------------------------------------------------ limits
def test_the_limit_at_minus_infinity_is_not_that_at_infinity():
    t, (x,) = theory("x")
    t.symbols["π"] = PI
    t.atom("arctan", x, name="arctan x")
    half = Fraction(1, 2) * PI
    t.assume("1 > 0", ONE, ">")
    accepted(t, same(Limit(Arctan(x), x, Infinity()), half))
    rejected(t, same(Limit(Arctan(x), x, Neg(Infinity())), half))


def test_a_limit_at_a_time_is_none_at_infinity():
    t, (x, time) = theory("x", "t")
    t.assume("x > 0", x, ">")
    t.atom("reciprocal", x, "x > 0", "1/x")
    accepted(t, same(Limit(Quotient(ONE, x), x, Infinity()), ZERO))
    rejected(t, same(Limit(Quotient(ONE, x), x, time), ZERO))


def test_arctan_of_a_quotient_that_stays():
    """|ω| arctan(ω/|ω|) grows without bound; its width depends on the variable."""
    t, (w,) = theory("ω")
    t.symbols["π"] = PI
    t.atom("absolute", w, name="|ω|")
    t.atom("spectral", TimesArctan(w, w), name="turn")
    rejected(t, same(Limit(TimesArctan(w, w), w, Infinity()), Fraction(1, 2) * PI * Abs(w)))


def test_a_variable_that_stands_for_another():
    """x is y: lim y/x is 1, not 0."""
    t, (y, x) = theory("y", "x")
    t.define("x", x, y)
    t.assume("x > 0", x, ">")
    t.atom("reciprocal", x, "x > 0", "1/x")
    rejected(t, same(Limit(y * Quotient(ONE, x), x, Infinity()), ZERO))
    rejected(t, same(Rate(y, x), ZERO))


def test_the_circles_number_is_no_variable():
    t, _ = theory()
    t.symbols["π"] = PI
    t.assume("π > 0", PI, ">")
    t.atom("reciprocal", PI, "π > 0", "1/π")
    rejected(t, same(Limit(Quotient(ONE, PI), PI, Infinity()), ZERO))


# ------------------------------------------------------------------------------------------------ derivatives
def test_the_integral_of_a_constant_grows():
    t, (time, c) = theory("t", "c")
    t.atom("integral", c, name="∫ c")
    whole = Definite(c, time, ZERO, time)
    rejected(t, same(Rate(whole, time), ZERO))
    accepted(t, same(Rate(whole, time), c))


def test_the_upper_bound_in_an_integrand():
    """∫ t τ dτ is t³/2, ∫ τ² dτ is t³/3."""
    t, (time, tau) = theory("t", "τ")
    t.atom("integral", time * time, name="∫ t^2")
    rejected(t, same(Definite(time * tau, tau, ZERO, time), Definite(tau * tau, tau, ZERO, time)))


def test_an_integrand_that_is_defined_by_the_variable():
    """x = τ²: its integral is t³/3, not t x."""
    t, (time, tau, x) = theory("t", "τ", "x")
    t.define("x", x, tau * tau)
    t.atom("integral", x, name="∫ x")
    rejected(t, same(Definite(x, tau, ZERO, time), time * x, rule="same rate", count=2))


def test_a_rate_before_the_definition():
    """x = 1/(t + 1) waits for its reason; until then it is not constant."""
    t, (time, x) = theory("t", "x")
    t.assume("t ≥ 0", time, "≥")
    t.atom("reciprocal", time + ONE, "t + 1 > 0", "1/(t+1)")
    t.define("x", x, Quotient(ONE, time + ONE))
    rejected(t, same(Rate(x, time), ZERO))


def test_a_jump_is_no_constant():
    """arctan x + arctan 1/x jumps where x vanishes."""
    t, (time, w) = theory("t", "ω")
    t.generic("distance", time - w, ZERO, time)
    rejected(t, same(w, w))
    t, (time, w) = theory("t", "ω")
    t.generic("distance", w - time, ZERO, w)  # for given t all but one ω, for given ω not all t
    rejected(t, same(w, w))


def test_the_determinant_of_what_moves():
    t, (w, time) = theory("ω", "t")
    A = t.matrix("A", "n", "n")
    moving = w * Identity("n") - A
    t.atom("spectral", Det(moving), name="det")
    rejected(t, same(Rate(Det(moving), w), ZERO))
    P = t.varying("P", "n", "n")
    t.atom("spectral", Det(P), name="det P")
    rejected(t, same(Rate(Det(P), time), ZERO))


def test_roots_move_with_their_parts():
    t, (s, i, m) = theory("s", "i", "m")
    root = t.roots("λ", i, m)
    product = Roots(s, root, i, m)
    t.atom("spectral", product, name="product")
    rejected(t, same(Rate(product, t.symbols["Re λ"]), ZERO))


def test_a_logarithm_on_the_axis_moves_with_its_parameters():
    t, (s, _, w, a) = theory("s", "j", "ω", "a")
    log = Log(Modulus(At(s - a, s, Product((t.symbols["j"], w)))))
    t.atom("spectral", log, name="ln|f|")
    accepted(t, same(log, log))
    rejected(t, same(Rate(log, a), ZERO))


def test_arctan_of_a_pole_is_not_continuous():
    """The derivative of arctan 1/(ω - 1) has an integral of its own, without the jump of π."""
    t, (w,) = theory("ω")
    t.symbols["π"] = PI
    t.assume("ω > 0", w, ">")
    t.generic("distance", w - ONE, ZERO, w)
    square = Power(w - ONE, 2) + Power(ZERO, 2)
    t.atom("reciprocal", square, "distance", "1/u")
    x = (w - ONE) * Quotient(ONE, square)
    t.define("x", t.scalar("x"), x)
    t.atom("spectral", TimesArctan(t.symbols["x"], ONE), name="turn")
    reading = t.reading()
    assert not _continuous(value(TimesArctan(t.symbols["x"], ONE), reading), "ω", reading)


# ------------------------------------------------------------------------------------------------ relations
def test_an_order_of_matrices_is_not_their_equality():
    """C ≠ 0 and P ≥ 0 between matrices, σ ⪰ 0 between numbers have no rule; they do not make anything zero."""
    t, (x,) = theory("x")
    C = t.matrix("C", "n", "n")
    t.assume("C ≠ 0", C, "≠", Zero("n", "n"))
    claim = Poly({((), ("C",)): 1}, "n", "n")
    proof = Proof(identities=(Certificate(claim, (Addend(Fraction(1), (), (), "C ≠ 0", False, ()),)),))
    rejected(t, Step("C = 0", Equation(C, "=", Zero("n", "n")), "identity", (), proof))
    t, (x,) = theory("x")
    t.assume("x ⪰ 0", x, "⪰")
    proof = Proof(identities=(Certificate(scalar("x"), (Addend(Fraction(1), (), (), "x ⪰ 0", False, ()),)),))
    rejected(t, Step("x = 0", Equation(x, "=", ZERO), "scalar", (), proof))


# ------------------------------------------------------------------------------------------------ complex numbers
def use(name: str, coefficient: int = 1) -> Addend:
    return Addend(Fraction(coefficient), (), (), name, False, ())


def test_the_square_of_the_imaginary_unit():
    t, (j,) = theory("j")
    t.assume("j^2", j * j, "=", Neg(ONE))
    products = [SignProduct(Fraction(1), ("¬",)), SignProduct(Fraction(1), (), (scalar("j"),))]
    rejected(t, sign(Equation(Neg(ONE), "≥", ZERO), constant(-1), products, [use("j^2")]))


def test_a_number_that_may_be_complex_has_no_sign():
    """The square of the determinant of a complex matrix, and of a polynomial at a complex number, may be negative."""
    t, (s,) = theory("s")
    M = t.matrix("M", "n", "n")
    t.complex.add("M")
    t.atom("spectral", Det(M), name="det M")
    d = scalar("det M")
    products = [SignProduct(Fraction(1), ("¬",)), SignProduct(Fraction(1), (), (d,))]
    rejected(t, sign(Equation(Power(Det(M), 2), "≥", ZERO), d * d, products))
    s2 = scalar("s") * scalar("s")
    products = [SignProduct(Fraction(1), ("¬",)), SignProduct(Fraction(1), (), (scalar("s"),))]
    rejected(t, sign(Equation(s * s, "≥", ZERO), s2, products))


def test_a_sum_of_squares_of_complex_numbers_may_vanish():
    """p ≠ 0 of a complex p does not make p² + 1 different from zero."""
    t, (s, i, m) = theory("s", "i", "m")
    root = t.roots("λ", i, m)
    p = Roots(s, root, i, m)
    t.atom("spectral", p, name="p")
    statement, q = Equation(Power(p, 2) + ONE, "≠", ZERO), scalar("p") * scalar("p")
    facts = ("p ≠ 0", "p ≠ 0")
    products = [SignProduct(Fraction(1), facts), SignProduct(Fraction(1), ())]
    rejected(t, sign(statement, q + constant(1), products, [use("¬")]))
    accepted(t, sign(Equation(TWO * p, "≠", ZERO), scalar("p").scale(2), [SignProduct(Fraction(4), facts)],
                     [Addend(Fraction(2), ("p",), (), "¬", False, ())]))  # fmt: skip


@pytest.mark.parametrize("kind", ["absolute", "exp", "part"])
def test_functions_are_of_real_numbers(kind: str):
    """e^j > 0 has no meaning, and |j|² is not j²."""
    t, (j,) = theory("j")
    atom = t.atom(kind, j, name="f(j)")
    rejected(t, same(atom, atom))


# ------------------------------------------------------------------------------------------------ arbitrary parameters
def generic() -> tuple[Theory, Step]:
    """(ω - β)² + α² > 0 but for one ω, as a step."""
    t, (w,) = theory("ω")
    a, b = t.parameter("α"), t.parameter("β")
    t.generic("distance", w - b, a, w)
    x = scalar("ω") - scalar("β")
    claim = x * x + scalar("α") * scalar("α")
    products = [SignProduct(Fraction(1), ("distance",)), SignProduct(Fraction(1), ("¬",))]
    statement = Equation(Power(w - b, 2) + Power(a, 2), ">", ZERO)
    return t, sign(statement, claim, products, name="positive")


def test_a_generic_fact_is_not_put_where_it_fails():
    t, positive = generic()
    accepted(t, positive)
    w = t.symbols["ω"]
    accepted(t, positive, linked(Equation(Power(w - TWO, 2) + Power(ZERO, 2), ">", ZERO), "instance", "positive"))
    rejected(t, positive, linked(Equation(Power(w - w, 2) + Power(ZERO, 2), ">", ZERO), "instance", "positive"))


def test_an_instance_of_a_derivative():
    t, _ = theory()
    a, b = t.parameter("α"), t.parameter("β")
    lemma = same(Rate(b * a, a), b, "lemma")
    rejected(t, lemma, linked(Equation(Rate(a * a, a), "=", a), "instance", "lemma"))
    rejected(t, lemma, linked(Equation(Rate(b * b, b), "=", b), "instance", "lemma"))
    lemma = same(Start(b + a, a), b, "lemma")
    rejected(t, lemma, linked(Equation(Start(a + a, a), "=", a), "instance", "lemma"))


def test_an_instance_under_a_sum():
    """Σ α = m α for a number α, which Re λᵢ is not."""
    t, (i, m) = theory("i", "m")
    root, a = t.roots("λ", i, m), t.parameter("α")
    re = RealPart(root)
    t.atom("spectral", Total(re, i, m), name="sum")
    rejected(
        t, same(Total(a, i, m), m * a, "lemma"), linked(Equation(Total(re, i, m), "=", m * re), "instance", "lemma")
    )


def test_an_instance_of_two_symbols_of_one_name():
    t, _ = theory()
    a = t.parameter("α")
    b, other = t.scalar("b"), Symbol("α", scalar=True, args=("t",))
    rejected(t, same(a - other, ZERO, "lemma"), linked(Equation(b - 2 * b, "=", ZERO), "instance", "lemma"))


def test_an_instance_of_what_depends_on_the_parameter():
    """d = det(αI - A), and M = αI, are no constants."""
    t, (d,) = theory("d")
    A, a, b = t.matrix("A", "n", "n"), t.parameter("α"), t.parameter("β")
    at = [Det(x * Identity("n") - A) for x in (a, b)]
    for n, body in zip("ab", at, strict=True):
        t.atom("spectral", body, name=f"det {n}")
    t.define("d", d, at[0])
    claim = scalar("d") - scalar("det a")
    proof = Proof(identities=(Certificate(claim, (use("d"),)),))
    lemma = Step("lemma", Equation(d, "=", at[0]), "scalar", (), proof, lemma=True)
    accepted(t, lemma)
    rejected(t, lemma, linked(Equation(d, "=", at[1]), "instance", "lemma"))
    M = t.matrix("M", "n", "n")
    t.define("M", M, a * Identity("n"))
    with pytest.raises(Rejected, match="arbitrary"):
        t.reading()


def test_the_image_of_a_real_parameter_is_real():
    t, (j,) = theory("j")
    a = t.parameter("α")
    claim = scalar("α") * scalar("α")
    products = [SignProduct(Fraction(1), ("¬",)), SignProduct(Fraction(1), (), (scalar("α"),))]
    lemma = sign(Equation(a * a, "≥", ZERO), claim, products, name="lemma")
    accepted(t, lemma)
    rejected(t, lemma, linked(Equation(j * j, "≥", ZERO), "instance", "lemma"))


def test_nothing_is_assumed_of_a_parameter_by_another_name():
    def fresh() -> tuple[Theory, Symbol]:
        t, _ = theory()
        return t, t.parameter("α")

    t, a = fresh()
    t.define("d", d := t.scalar("d"), a + ONE)
    t.assume("d > 0", d, ">")
    rejected(t, same(a, a))
    t, a = fresh()
    t.define("α", a, TWO)
    rejected(t, same(a, a))
    t, a = fresh()
    t.define("square", Power(a, 2), ONE)
    rejected(t, same(a, a))
    t, a = fresh()
    t.fact("regular", "invertible", a * Identity("n") - t.matrix("A", "n", "n"))
    rejected(t, same(a, a))
    t, a = fresh()
    t.nonnegative.add("α")
    rejected(t, same(a, a))
    t, a = fresh()
    t.generic("α + 1", a + ONE, ZERO, a)
    rejected(t, same(a, a))


# ------------------------------------------------------------------------------------------------ families of roots
def family(*parts: str) -> tuple[Theory, Symbol, Symbol, Symbol]:
    t, (_, i, m) = theory("s", "i", "m")
    return t, t.roots("λ", i, m), i, m


def test_a_root_is_no_number():
    """Σ λᵢ is not m λᵢ, and Σ i is not m i."""
    t, root, i, m = family()
    rejected(t, same(Total(root, i, m), m * root))
    rejected(t, same(Total(i, i, m), Total(i, i, m)))


def test_sums_have_counts():
    t, root, i, m = family()
    t.roots("μ", i, n := t.scalar("n"))
    t.atom("spectral", Total(RealPart(root), i, m), name="sum")
    rejected(t, same(Total(RealPart(root), i, m), Total(RealPart(root), i, n)))


def test_conjugates_have_other_numbers():
    t, root, i, m = family()
    im = ImaginaryPart(root)
    for k, body in enumerate((im, i * im)):
        t.atom("spectral", Total(body, i, m), name=f"sum {k}")
    accepted(t, linked(Equation(Total(im, i, m), "=", Total(Neg(im), i, m)), "conjugate"))
    rejected(t, linked(Equation(Total(i * im, i, m), "=", Total(Neg(i * im), i, m)), "conjugate"))


def test_same_roots_of_a_function_of_another():
    """Written as a letter, Re λᵢ stays where μⱼ is put; its sum over j is n Re λᵢ."""
    t, root, i, m = family()
    s, j2, n = t.symbols["s"], t.scalar("k"), t.scalar("n")
    other = t.roots("μ", j2, n)
    one, two = Roots(s, root, i, m), Roots(s, other, j2, n)
    for k, p in enumerate((one, two)):
        t.atom("spectral", p, name=f"p{k}")
    t.assume("same polynomial", one, "=", two)
    t.atom("spectral", Total(RealPart(root), i, m), name="sum")
    t.atom("spectral", Total(RealPart(other), j2, n), name="other sum")
    claim = scalar("p0") - scalar("p1")
    proof = Proof(identities=(Certificate(claim, (use("same polynomial"),)),))
    lemma = Step("lemma", Equation(one, "=", two), "scalar", (), proof, lemma=True)
    good = Equation(Total(RealPart(root), i, m), "=", Total(RealPart(other), j2, n))
    accepted(t, lemma, linked(good, "same roots", "lemma"))
    letter = t.symbols["Re λ"]
    rejected(t, lemma, linked(Equation(Total(letter, i, m), "=", Total(letter, j2, n)), "same roots", "lemma"))


# ------------------------------------------------------------------------------------------------ matrices
def test_the_determinant_of_blocks_is_not_that_of_the_first():
    t, _ = theory()
    A, B = t.matrix("A", "n", "n"), t.matrix("B", "n", "n")
    zero = Zero("n", "n")
    proof = Proof(identities=(Certificate(Poly({}, "n", "n")),))
    whole = Det(Block(((A, zero), (zero, B))))
    rejected(t, Step("step", Equation(whole, "=", Det(A)), "determinant", (), proof))


def test_a_trace_of_two_matrices_without_symmetry():
    """x'Mx ≥ 0 for M = [0 1; -1 0], and tr M² = -2."""
    t, _ = theory()
    M = t.matrix("M", "n", "n")
    t.assume("M ⪰ 0", M, "⪰", Zero("n", "n"))
    t.atom("spectral", Trace(M * M), name="tr")
    rejected(t, linked(Equation(Trace(M * M), "≥", ZERO), "positive", "M ⪰ 0", "M ⪰ 0"))


def test_the_resolvent_beside_what_grows():
    t, (s, x) = theory("s", "x")
    A, L = t.matrix("A", "n", "n"), t.matrix("L", "n", "n")
    t.complex.add("L")
    t.define("L", L, s * Identity("n"))
    t.define("x", x, s * s)
    t.fact("regular", "invertible", s * Identity("n") - A)
    t.inverse("R", s * Identity("n") - A, "n", because="regular")
    R = (s * Identity("n") - A).inv
    for k, word in enumerate((A * R, L * R)):
        t.atom("spectral", Trace(word), name=f"tr {k}")
    limit = lambda body: Equation(Limit(Trace(body), s, Infinity()), "=", ZERO)  # noqa: E731
    accepted(t, linked(limit(A * R), "resolvent"))
    rejected(t, linked(limit(L * R), "resolvent"))
    rejected(t, linked(limit(x * (A * R)), "resolvent"))


def test_s_is_not_said_to_be_nonnegative():
    """A matrix that depends on s would pass as a constant."""
    t, _ = theory()
    s = t.scalar("s", nonnegative=True)
    rejected(t, same(s, s))


def test_an_entry_needs_its_dimension():
    t, _ = theory()
    A = t.matrix("A", "n", "n")
    proof = Proof(identities=(Certificate(Poly({}, "n", "n")),))
    rejected(t, Step("step", Equation(Entry(A), "=", Entry(A)), "apply", (), proof))


# ------------------------------------------------------------------------------------------------ analytic continuation
def test_what_is_true_of_real_s_only_is_not_put_on_the_axis():
    """|s| + 1 = s + 1 for s > 0; on the axis it is ω + 1, not |jω + 1|."""
    t, (s, j, w) = theory("s", "j", "ω")
    t.assume("s > 0", s, ">")
    t.atom("absolute", s, name="|s|")
    f = Abs(s) + ONE
    t.atom("spectral", Log(Modulus(At(f, s, Product((j, w))))), name="ln|f|")
    rejected(t, same(Log(Modulus(At(f, s, Product((j, w))))), Log(Modulus(At(f, s, Product((j, w)))))))


def test_an_implicit_function_need_not_be_real():
    """L = -(I + L)⁻¹ A has complex solutions only for A = I."""
    t, (s, j, w) = theory("s", "j", "ω")
    L = t.matrix("L", "n", "n")
    t.complex.add("L")
    t.fact("regular", "invertible", Identity("n") + L)
    t.inverse("R", Identity("n") + L, "n", because="regular")
    t.define("L", L, Neg((Identity("n") + L).inv * t.matrix("A", "n", "n")))
    t.atom("spectral", Det(L), name="det")
    log = Log(Modulus(At(Det(L), s, Product((j, w)))))
    t.atom("spectral", log, name="ln")
    rejected(t, same(log, log))


# ------------------------------------------------------------------------------------------------ running parameters
def test_a_symbol_that_stands_for_the_running_parameter():
    """d is r²: the integral of k (r² - d) is 0 for all r, that of k (α² - d) is not."""
    t, (w, d, k) = theory("ω", "d", "k")
    t.assume("ω > 0", w, ">")
    a, r = t.parameter("α"), t.run("r")
    t.define("d", d, Power(r, 2))
    gaps = [k * (Power(x, 2) - d) for x in (r, a)]
    for n, body in zip("ra", gaps, strict=True):
        t.atom("improper", body, name=f"integral {n}")
    halves = [Definite(body, w, ZERO, Infinity()) for body in gaps]
    reading = t.reading()
    with pytest.raises(Rejected, match="stands for it"):
        check_any_sign(
            Equation(halves[1], "=", ZERO),
            [Equation(halves[0], "=", ZERO), Equation(Rate(gaps[0], r), "=", ZERO), Equation(ZERO, "≥", ZERO)],
            reading,
        )


def test_an_exception_does_not_follow_a_running_parameter():
    """(ρ - α)² > 0 but for one ρ, which is ρ itself where α = ρ."""
    t, _ = theory()
    a, r = t.parameter("α"), t.run("ρ")
    t.generic("gap", r - a, ZERO, r)
    gap = scalar("ρ") - scalar("α")
    lemma = sign(
        Equation(Power(r - a, 2) + Power(ZERO, 2), ">", ZERO), gap * gap,
        [SignProduct(Fraction(1), ("gap",)), SignProduct(Fraction(1), ("¬",))], name="lemma",
    )  # fmt: skip
    accepted(t, lemma)
    rejected(t, lemma, linked(Equation(Power(r - r, 2) + Power(ZERO, 2), ">", ZERO), "instance", "lemma"))


def test_a_point_with_an_index_is_no_constant():
    t, _, i, m = family()
    s, j = t.symbols["s"], t.scalar("j")
    point = Sum((t.symbols["Re λ"], Product((j, t.symbols["Im λ"]))))
    log = Log(Modulus(At(s, s, point)))
    t.atom("spectral", log, name="ln|λ|")
    rejected(t, same(Total(log, i, m), m * log))


# ------------------------------------------------------------------------------------------------ held variables
@pytest.mark.parametrize("relation", [">", "="])
def test_a_limit_in_a_variable_that_is_held(relation: str):
    """1/2 ≤ 1/x for x < 1, or x = 1, does not make lim 1/2 zero."""
    t, (x,) = theory("x")
    t.assume("x > 0", x, ">")
    t.atom("reciprocal", x, "x > 0", "1/x")
    t.assume("x held", ONE - x, relation, case=True)
    half, r = constant(Fraction(1, 2)), scalar("1/x")
    upper = Equation(Quotient(ONE, x), "≥", Fraction(1, 2) * ONE)
    # were 1/x < 1/2, x (1/2 - 1/x) + (1 - x)/2 + 1/2 would be zero, and positive
    products = [
        SignProduct(Fraction(1), ("¬", "x > 0")),
        *([SignProduct(Fraction(1, 2), ("x held",))] if relation == ">" else []),
        SignProduct(Fraction(1, 2), ()),
    ]
    held = [] if relation == ">" else [Addend(Fraction(-1, 2), (), (), "x held", False, ())]
    above = sign(upper, r - half, products, [use("1/x", -1), *held], name="above")
    turned = Equation(Quotient(ONE, x), "≥", Fraction(-1, 2) * ONE)
    products = [*products[:1], SignProduct(Fraction(1), ()), SignProduct(Fraction(1, 2), ("x > 0",))]
    below = sign(turned, r + half, products, [use("1/x", -1)], name="below")
    accepted(t, above, below)
    limit = Equation(Limit(Fraction(1, 2) * ONE, x, Infinity()), "=", ZERO)
    rejected(t, above, below, linked(limit, "squeeze", "above", "below"))


def test_a_matrix_that_hides_what_moves():
    t, _ = theory()
    w = t.scalar("ω", nonnegative=True)
    M = t.matrix("M", "n", "n")
    t.define("M", M, w * Identity("n"))
    t.atom("spectral", Det(M), name="det M")
    rejected(t, same(Rate(Det(M), w), ZERO))
    t, _ = theory()
    w, V = t.scalar("ω", nonnegative=True), t.matrix("V", "n", "n", symmetric=True)
    t.assume("V + ω > 0", V + w * Identity("n"), "≻", Zero("n", "n"))
    t.inverse("X", V + w * Identity("n"), "n", symmetric=True, because="V + ω > 0")
    X = (V + w * Identity("n")).inv
    t.atom("spectral", Det(X), name="det X")
    rejected(t, same(Rate(Det(X), w), ZERO))


def test_a_case_that_a_limit_consults_is_named():
    """e^(-at) tends to 0 for a > 0; where a = 0 it is 1."""
    t, (time, a) = theory("t", "a")
    t.assume("a > 0", a, ">", case=True)
    t.assume("a = 0", a, "=", case=True)
    t.atom("exp", Neg(a * time), name="decay")
    step = same(Limit(Exp(Neg(a * time)), time, Infinity()), ZERO)
    rejected(t, step)
    rejected(t, replace(step, uses=("a = 0",)))
    accepted(t, replace(step, uses=("a > 0",)))


# ------------------------------------------------------------------------------------------------ size
def nested(depth: int, wrap: Callable[[Term], Term], term: Term) -> Term:
    for _ in range(depth):
        term = wrap(term)
    return term


@pytest.mark.parametrize(
    "term",
    [
        Power(TWO, 10**9),
        nested(5, lambda x: Power(x, 400), TWO),
        Power(Sum((Symbol("x", scalar=True), ONE)), 50),
        nested(60, lambda x: Quotient(ONE, x), Symbol("x", scalar=True)),
        nested(30, lambda x: Quotient(Quotient(ONE, x), TWO), Symbol("x", scalar=True)),
        nested(20, lambda x: Rate(x, Symbol("x", scalar=True)), Power(Symbol("x", scalar=True), 20)),
    ],
)
def test_a_file_does_not_ask_for_endless_work(term: Term):
    t, (x,) = theory("x")
    with pytest.raises(InputError, match="at most"):
        Reader(t).equation(to_json(Equation(term, "=", x), t))


def test_a_product_of_facts_is_bounded():
    """Squares of a long sum, and definitions that are written out, stay small, whoever asks for them."""
    t, symbols = theory(*"abcdefgh")
    total = Sum(tuple(symbols))
    t.define("y", t.scalar("y"), total)
    t.define("z", t.scalar("z"), Power(t.symbols["y"], 40))
    rejected(t, same(Power(total, 30), ZERO))
    rejected(t, same(Root(t.symbols["z"]), ZERO))
    poly = value(total, t.reading())
    many = SignProduct(Fraction(1), (), (poly,) * 30)
    rejected(t, sign(Equation(total, "≥", ZERO), poly, [many]))
    with pytest.raises(InputError, match="certificate of sign"):
        check_work(Proof(sign=Sign(poly, "≥", (many,) * 20, ())))
