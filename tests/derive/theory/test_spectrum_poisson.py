"""Poisson's formula in the half plane: numbers against quadrature, false statements, each hypothesis of the rules."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction
from functools import cache
from itertools import pairwise
from math import atan, inf, log, pi

import numpy as np
import pytest
from scipy.integrate import quad

from derive.context import Theory
from derive.derivation import Step, check, learn
from derive.functions import PI, Abs, Definite, Infinity, Limit, Log, Max, Power, Quotient, Rate, value
from derive.kernel import Rejected
from derive.parameter import check_any_sign, check_logarithms, check_parameter, regular_logarithm
from derive.real import scalar
from derive.roots import check_instance, check_modulus
from derive.spectral import At, Det, ImaginaryPart, Modulus, RealPart, Roots, Total
from derive.terms import Equation, Identity, Neg, Number, Product, Reading, Sum, Symbol, Term, Zero
from derive.theory import spectrum, spectrum_dt, spectrum_half_plane, spectrum_poisson
from derive.theory.spectrum_roots import on_axis
from tests.derive.theory.mutants import mutants

ZERO, ONE = Zero("", ""), Number(Fraction(1))
NUMBERED = "Poisson-Jensen formula"
LEMMAS = ("decaying lemma", "lemma for r > 0", "Poisson lemma")
MIRROR = {"σ0": 0.7, "ω0": 0.4, "r": 0.7, "α": -0.7, "β": 0.4}


# ------------------------------------------------------------------------------------------------ numbers
def definition(name: str) -> Term:
    """Return what a symbol stands for, in the theory of either lecture."""
    return next(t.statement(name).rhs for t in (spectrum.theory(), spectrum_dt.theory()) if name in t.declared)


def number(term: Term, at: dict[str, float], roots: dict[str, np.ndarray], i: int = 0) -> float:
    """Evaluate a term as a reader understands it, with quadrature for integrals."""
    of = lambda t: number(t, at, roots, i)  # noqa: E731
    match term:
        case Symbol(name=name) if name in at:
            return at[name]
        case Symbol(name=name):
            return of(definition(name))
        case Number(x):
            return float(x)
        case Zero():
            return 0.0
        case Neg(body):
            return -of(body)
        case Sum(addends):
            return sum(map(of, addends))
        case Product(factors):
            return float(np.prod([of(f) for f in factors]))
        case Quotient(top, bottom):
            return of(top) / of(bottom)
        case Power(body, exponent):
            return of(body) ** exponent
        case Abs(body):
            return abs(of(body))
        case Max(body):
            return max(0.0, of(body))
        case RealPart(root):
            return roots[root.name][i].real
        case ImaginaryPart(root):
            return roots[root.name][i].imag
        case Total(body):
            return sum(number(body, at, roots, k) for k in range(len(roots["φ"])))
        case Log(Modulus(At(Symbol(name="f"), _, point))):
            s = plane(point, at)
            return log(abs(np.prod(s - roots["φ"]) / np.prod(s - roots["η"])))
        case Log(body):
            return log(of(body))
        case Definite(body, x, low):
            return integral(lambda w: number(body, {**at, x.name: w}, roots, i), isinstance(low, Neg))
        case _:
            raise NotImplementedError(type(term).__name__)


def plane(point: Term, at: dict[str, float]) -> complex:
    match point:
        case Product((_, Symbol(name=y))):
            return 1j * at[y]
        case Sum((Symbol(name=x), Product((_, Symbol(name=y))))):
            return complex(at[x], at[y])
        case _:
            raise NotImplementedError


def integral(f, whole: bool) -> float:
    """Integrate over the frequencies, in the angle whose tangent they are."""
    g = lambda a: f(np.tan(a)) / np.cos(a) ** 2  # noqa: E731
    marks = [-atan(2.0), -atan(0.9), -atan(0.4), atan(0.4), atan(0.9), atan(2.0)]
    ends = [-pi / 2, *marks, pi / 2] if whole else [0.0, *(m for m in marks if m > 0), pi / 2]
    return sum(quad(g, a, b, limit=200, epsabs=1e-11)[0] for a, b in pairwise(ends))


PLACES = (
    {"σ0": 0.5, "ω0": 0.9, "r": 1.3, "α": 1.3, "β": 0.4},
    {"σ0": 2.0, "ω0": 0.0, "r": 0.2, "α": -0.2, "β": 2.0},
    {"σ0": 1.0, "ω0": -0.4, "r": 3.0, "α": 0.0, "β": 0.9},
    MIRROR,
)


@pytest.mark.parametrize("place", PLACES)
@pytest.mark.parametrize("name", LEMMAS)
def test_the_lemmas_hold_by_quadrature(name, place):
    step = spectrum.lecture().step(name)
    pi_ = {**place, "π": pi}
    assert number(step.statement.lhs, pi_, {}) == pytest.approx(number(step.statement.rhs, pi_, {}), abs=1e-7)


FUNCTIONS = {
    "two zeros to the right": ([1 + 2j, 1 - 2j, -0.5], [-1 + 0.4j, -1 - 0.4j, -3]),
    "zeros on the axis": ([0.9j, -0.9j, 2], [-1, -2, -0.3]),
    "minimum phase": ([-1, -2], [-0.5 + 2j, -0.5 - 2j]),
}


@pytest.mark.parametrize("name", FUNCTIONS)
@pytest.mark.parametrize("point", [0.5 + 0.9j, 3 + 0j, 0.2 - 2j])
def test_equation_8_holds_by_quadrature(name, point):
    zeros, poles = (np.array(r, dtype=complex) for r in FUNCTIONS[name])
    statement = spectrum.lecture().step(NUMBERED).statement
    at, roots = {"σ0": point.real, "ω0": point.imag, "π": pi}, {"φ": zeros, "η": poles}
    left = number(statement.lhs, at, roots)
    assert left == pytest.approx(number(statement.rhs, at, roots), abs=1e-6)
    printed = log(abs(np.prod(point - zeros) / np.prod(point - poles)))  # the source's own right-hand side
    printed -= sum(log(abs((point - z) / (point + z.conjugate()))) for z in zeros if z.real > 0)
    assert left == pytest.approx(printed, abs=1e-6)


def test_an_unstable_pole_is_not_covered():
    """f = (s + 2)/(s - 1) at 2 + j: the two sides differ, and the step names the hypothesis."""
    statement = spectrum.lecture().step(NUMBERED).statement
    at, roots = {"σ0": 2.0, "ω0": 1.0, "π": pi}, {"φ": np.array([-2 + 0j]), "η": np.array([1 + 0j])}
    assert number(statement.lhs, at, roots) < 0.3 < 1.0 < number(statement.rhs, at, roots)
    assert {"poles are stable", "distance of s0 to φ > 0", "σ0 > 0"} <= spectrum.lecture().rests_on(NUMBERED)


# ------------------------------------------------------------------------------------------------ false statements
@cache
def stages() -> dict[str, tuple[Step, Reading, dict[str, Step]]]:
    """Return the steps of this part with what may be used before each."""
    item, earlier, found = spectrum.lecture(), dict[str, Step](), {}
    reading = item.theory.reading()
    for step in item.steps:
        found[step.name] = step, reading, dict(earlier)
        earlier[step.name] = step
        reading = learn(reading, item.theory, step)
        if step.name == NUMBERED:
            return found
    raise AssertionError


@pytest.mark.parametrize("name", [*LEMMAS, NUMBERED, "Poisson integral of f", "before and behind", "rate: integral"])
def test_mutated_statements_are_rejected(name):
    step, reading, earlier = stages()[name]
    check(step, reading, earlier)
    tried = 0
    for side in ("lhs", "rhs"):
        for other in mutants(getattr(step.statement, side)):
            statement = replace(step.statement, **{side: other})
            if not same(statement, step.statement, reading):
                tried += 1
                with pytest.raises(Rejected):
                    check(replace(step, statement=statement), reading, earlier)
    assert tried > 10


def same(one: Equation, other: Equation, reading: Reading) -> bool:
    """Tell whether two statements read the same: a root and its conjugate, say, were exchanged."""
    try:
        first, second = (value(e.lhs, reading) - value(e.rhs, reading) for e in (one, other))
        return first == second
    except Rejected:
        return one == other


def swap(term: Term, old: Term, new: Term) -> Term:
    from derive.functions import replaced

    return replaced(term, old, new)  # type: ignore[arg-type]


def test_the_sign_of_sigma_a_missing_modulus_and_a_factor_are_not_accepted():
    step, reading, earlier = stages()["Poisson lemma"]
    lhs, rhs, t = step.statement.lhs, step.statement.rhs, spectrum.theory()
    alpha, sigma = t.symbols["α"], t.symbols["σ0"]
    for wrong in (
        swap(rhs, sigma, Neg(sigma)), swap(rhs, Abs(alpha), alpha), swap(rhs, Abs(alpha), Neg(Abs(alpha))), 2 * rhs,
        swap(rhs, PI, 2 * PI),
    ):  # fmt: skip
        with pytest.raises(Rejected):
            check(replace(step, statement=Equation(lhs, "=", wrong)), reading, earlier)
    step, reading, earlier = stages()[NUMBERED]
    check(step, reading, earlier)
    lhs, rhs, phi = step.statement.lhs, step.statement.rhs, RealPart(t.symbols["φ"])
    for wrong in (swap(rhs, Max(phi), phi), swap(rhs, Max(phi), Abs(phi)), 2 * rhs, rhs.addends[0], -rhs):  # type: ignore[attr-defined]
        with pytest.raises(Rejected):
            check(replace(step, statement=Equation(lhs, "=", wrong)), reading, earlier)


# ------------------------------------------------------------------------------------------------ rule: parameter
def given():
    step, reading, earlier = stages()["decaying lemma"]
    return step.statement, [earlier[n].statement for n in step.proof.links], reading


def refused(check_rule, statement, links, reading):
    with pytest.raises(Rejected):
        check_rule(statement, links, reading)


def test_every_link_is_needed():
    statement, links, reading = given()
    check_parameter(statement, links, reading)
    for k in range(len(links)):
        refused(check_parameter, statement, [*links[:k], *links[k + 1 :]], reading)
        refused(check_parameter, statement, [*links, links[k]], reading)


def test_the_derivative_must_have_one_sign():
    statement, links, reading = given()
    for sign in (
        replace(links[3], relation="≠"), replace(links[3], rhs=ONE), Equation(Neg(ONE) * ONE, "≥", Neg(ONE)),
        Equation(stages()["kernels > 0"][0].statement.lhs, ">", ZERO), Equation(links[1].rhs, "=", links[1].rhs),
    ):  # fmt: skip
        refused(check_parameter, statement, [*links[:3], sign, *links[4:]], reading)


def test_the_links_must_be_about_one_function():
    statement, links, reading = given()
    half = statement.lhs
    assert isinstance(half, Definite)
    for wrong in (
        [Equation(replace(links[0].lhs, body=2 * links[0].lhs.body), "=", links[0].rhs), *links[1:]],  # type: ignore[attr-defined,call-overload]
        [replace(links[0], rhs=2 * links[0].rhs), *links[1:]],
        [links[0], links[2], *links[2:]],
        [*links[:2], Equation(links[2].lhs, "=", 2 * links[2].rhs), *links[3:]],
        [*links[:2], links[1], *links[3:]],
    ):
        refused(check_parameter, statement, wrong, reading)
    refused(check_parameter, Equation(half, "=", 2 * statement.rhs), links, reading)
    refused(check_parameter, Equation(replace(half, body=2 * half.body), "=", statement.rhs), links, reading)
    refused(check_parameter, Equation(replace(half, lower=Neg(Infinity())), "=", statement.rhs), links, reading)


def test_both_sides_must_agree_at_the_same_end():
    statement, links, reading = given()
    f, v = links[4], links[5]
    assert isinstance(f.lhs, Limit)
    assert isinstance(v.lhs, Limit)
    nearby, early = (Equation(replace(e, point=ZERO), "=", ZERO) for e in (v.lhs, f.lhs))
    for ends in ((f, nearby), (f, replace(v, rhs=PI)), (replace(f, rhs=ONE), v), (early, v)):
        refused(check_parameter, statement, [*links[:4], *ends], reading)
    r = links[1].lhs.symbol  # type: ignore[attr-defined]
    moving = (replace(f, rhs=r), replace(v, rhs=r))
    refused(check_parameter, statement, [*links[:4], *moving], reading)


def renamed(equations, old, new):
    return [Equation(swap(e.lhs, old, new), e.relation, swap(e.rhs, old, new)) for e in equations]


def rates_renamed(equations, old, new):
    """Rename the parameter, as the variable of derivatives and limits as well."""

    def of(term: Term) -> Term:
        body = swap(term, old, new)
        return replace(body, symbol=new) if isinstance(body, (Rate, Limit)) and body.symbol == old else body

    return [Equation(of(e.lhs), e.relation, of(e.rhs)) for e in equations]


def test_a_parameter_with_exceptions_or_hypotheses_does_not_run():
    statement, links, reading = given()
    t = spectrum.theory()
    r = t.symbols["r"]
    for name in ("ρ", "σ0", "ω0", "β", "α"):
        moved = rates_renamed([statement, *links[1:]], r, t.symbols[name])
        with pytest.raises(Rejected, match="running"):
            check_parameter(moved[0], [links[0], *moved[1:]], reading)


def small(f, g, w, base=(ZERO, ZERO), end=ZERO):
    """A theory where ∫ ω dω = c would be given, and the links of a statement about ∫ f dω."""
    t, x, r, c = running()
    p = t.run("ρ")
    forms = f(x, r, p), g(x, r, p)
    for k, body in enumerate((*forms, g(x, p, p), base[0](x, r) if callable(base[0]) else base[0])):
        t.atom("improper", body, name=f"integral {k}")
    v, rate = f(c, r, p), w(c, r, p)
    f0, v0 = (b(y, r) if callable(b) else b for b, y in zip(base, (x, c), strict=True))
    whole = lambda body: Definite(body, x, ZERO, Infinity())  # noqa: E731
    links = [
        Equation(whole(g(x, p, p)), "=", w(c, p, p)), Equation(Rate(forms[0], r), "=", forms[1]),
        Equation(Rate(v, r), "=", rate), Equation(forms[1], "≥", ZERO), Equation(Limit(forms[0], r, end), "=", f0),
        Equation(Limit(v, r, end), "=", v0), *([Equation(whole(f0), "=", v0)] if base != (ZERO, ZERO) else []),
    ]  # fmt: skip
    check_parameter(Equation(whole(forms[0]), "=", v), links, t.reading())


def test_the_inner_parameter_occurs_nowhere_else():
    """∫ g(r, ρ) at r = ρ says nothing of r ≠ ρ."""
    small(lambda x, r, p: r * r * x, lambda x, r, p: 2 * r * x, lambda x, r, p: 2 * r * x)
    with pytest.raises(Rejected, match="ρ"):
        small(lambda x, r, p: r * r * p * x, lambda x, r, p: 2 * r * p * x, lambda x, r, p: 2 * r * p * x)


def test_the_parameter_starts_at_zero_or_at_infinity():
    f, g = (lambda x, r, p: r * r * x), (lambda x, r, p: 2 * r * x)
    small(f, g, g)
    with pytest.raises(Rejected, match="infinity"):
        small(f, g, g, end=Symbol("t", scalar=True))


def test_the_base_may_be_an_integral_but_does_not_move():
    f, g = (lambda x, r, p: r * r * x + x), (lambda x, r, p: 2 * r * x)
    same_base, moving = (lambda x, r: x), (lambda x, r: r * x)
    small(f, g, g, (same_base, same_base))
    with pytest.raises(Rejected, match="limit"):
        small(f, g, g, (moving, moving))


# ------------------------------------------------------------------------------------------------ rule: any sign
def evened():
    step, reading, earlier = stages()["Poisson lemma"]
    return step.statement, [earlier[n].statement for n in step.proof.links], reading


def test_any_sign_needs_every_link_and_an_arbitrary_parameter():
    statement, links, reading = evened()
    check_any_sign(statement, links, reading)
    for k in range(3):
        refused(check_any_sign, statement, [*links[:k], *links[k + 1 :]], reading)
    t = spectrum.theory()
    for name in ("ρ", "σ0", "ω0", "β", "r"):
        other = renamed([statement], t.symbols["α"], t.symbols[name])[0]
        refused(check_any_sign, other, links, reading)
    refused(check_any_sign, statement, [links[0], links[1], Equation(links[2].lhs, "≠", ZERO)], reading)
    twice = swap(statement.rhs, t.symbols["β"], t.symbols["α"])
    refused(check_any_sign, Equation(statement.lhs, "=", twice), links, reading)


def test_any_sign_needs_an_even_integrand():
    """With ω - r for ω - β the distance depends on the sign of r."""
    t = Theory("odd", "A theory with an odd integrand")
    w, r, a = t.scalar("ω"), t.run("r"), t.parameter("α")
    t.assume("ω > 0", w, ">")
    t.assume("1 > 0", ONE, ">")
    f, F = r * w, a * w
    t.atom("improper", f, name="integral of f")
    t.atom("improper", F, name="integral of F")
    t.atom("absolute", a, name="|α|")
    statement = Equation(Definite(F, w, ZERO, Infinity()), "=", Abs(a))
    links = [Equation(Definite(f, w, ZERO, Infinity()), "=", r), Equation(Rate(f, r), "=", w), Equation(w, "≥", ZERO)]
    with pytest.raises(Rejected, match="even"):
        check_any_sign(statement, links, t.reading())


def test_any_sign_is_about_a_parameter_that_occurs_nowhere_else():
    t, w, r, c = running()
    a = t.parameter("α")
    t.atom("absolute", a, name="|α|")
    for extra in (c, a):
        for name, x in (("r", r), ("α", a)):
            t.atom("improper", x * x * extra * w, name=f"integral {name} {extra.name}")
    forms = [(r * r * e * w, a * a * e * w, r * r * e * c, Abs(a) * Abs(a) * e * c) for e in (c, a)]
    for k, (f, F, v, V) in enumerate(forms):
        half = lambda body: Definite(body, w, ZERO, Infinity())  # noqa: E731
        links = [Equation(half(f), "=", v), Equation(Rate(f, r), "=", 2 * r * w), Equation(2 * r * w, "≥", ZERO)]
        if k == 0:
            check_any_sign(Equation(half(F), "=", V), links, t.reading())
        else:
            refused(check_any_sign, Equation(half(F), "=", V), links, t.reading())


# ------------------------------------------------------------------------------------------------ hypotheses on r
def running():
    t = Theory("running", "A theory with a running parameter")
    w, r, c = t.scalar("ω"), t.run("r"), t.scalar("c")
    t.assume("ω > 0", w, ">")
    return t, w, r, c


@pytest.mark.parametrize(
    "assume",
    [
        lambda t, w, r, c: t.assume("r > 1", r - ONE, ">"),
        lambda t, w, r, c: t.assume("r = c", r, "=", c),
        lambda t, w, r, c: t.assume("c > r", c, ">", r),
        lambda t, w, r, c: t.define("r^2", r * r, c),
        lambda t, w, r, c: t.define("r", r, c),
        lambda t, w, r, c: (t.define("c", c, r + ONE), t.assume("c > 2", c - 2 * ONE, ">")),
        lambda t, w, r, c: t.generic("moving", w - r, c, w),
        lambda t, w, r, c: t.generic("moving too", w, r, w),
        lambda t, w, r, c: t.generic("depends on ω", r - c, w, r),
        lambda t, w, r, c: t.generic("shifted by ω", r - w, c, r),
        lambda t, w, r, c: t.fact("regular", "invertible", r * Identity("m")),
    ],
)
def test_nothing_but_the_sign_may_be_assumed(assume):
    t, w, r, c = running()
    t.reading()
    assume(t, w, r, c)
    with pytest.raises(Rejected):
        t.reading()


def test_exceptional_values_of_the_parameter_may_be_declared_and_disqualify_it():
    t, _, r, c = running()
    t.generic("r ≠ c", r - c, ZERO, r)
    assert t.reading().real.generic == {"r"}


def test_an_instance_does_not_move_the_exceptions_with_the_parameter():
    """(ω - β)^2 > 0 for all but one ω, which is r if r is put for β."""
    t, w, r, c = running()
    b = t.parameter("β")
    t.generic("ω ≠ β", w - b, ZERO, w)
    lemma = Equation(Power(w - b, 2), "≥", ZERO)
    check_instance(Equation(Power(w - c, 2), "≥", ZERO), [lemma], t.reading())
    refused(check_instance, Equation(Power(w - r, 2), "≥", ZERO), [lemma], t.reading())


def smooth_case(kind):
    """The integrand 1 - or what else depends on r in a way whose derivative is not what it seems."""
    t, w, r, _ = running()
    if kind == "modulus":
        t.atom("absolute", r - w, name="|r - ω|")
        return t, w, r, Abs(r - w)
    t.matrix("M", "n", "n", constant=True)
    body = Det(t.symbols["M"])
    t.atom("spectral", body, name="det M")
    return t, w, r, body


@pytest.mark.parametrize("kind", ["modulus", "determinant"])
def test_functions_without_a_continuous_derivative_in_the_parameter(kind):
    t, w, r, f = smooth_case(kind)
    t.atom("improper", f, name="integral")
    t.atom("improper", ZERO, name="nothing")
    whole = Definite(f, w, ZERO, Infinity())
    links = [
        Equation(Definite(ZERO, w, ZERO, Infinity()), "=", ZERO), Equation(Rate(f, r), "=", ZERO),
        Equation(Rate(ZERO, r), "=", ZERO), Equation(ZERO, "≥", ZERO), Equation(Limit(f, r, ZERO), "=", ZERO),
        Equation(Limit(ZERO, r, ZERO), "=", ZERO),
    ]  # fmt: skip
    with pytest.raises(Rejected, match="depend"):
        check_parameter(Equation(whole, "=", ZERO), links, t.reading())


# ------------------------------------------------------------------------------------------------ smaller rules
def test_logarithms_of_products():
    step, reading, earlier = stages()["before and behind"]
    statement, (link,) = step.statement, [earlier[n].statement for n in step.proof.links]
    check_logarithms(statement, [link], reading)
    refused(check_logarithms, statement, [], reading)
    refused(check_logarithms, Equation(statement.rhs, "=", statement.lhs), [link], reading)
    first, second = statement.lhs.addends  # type: ignore[attr-defined]
    for wrong in (first, first - second, first + first, 2 * (first + second)):
        refused(check_logarithms, Equation(wrong, "=", statement.rhs), [link], reading)
    refused(check_logarithms, statement, [replace(link, relation="≥")], reading)


def test_a_logarithm_is_continuous_where_its_argument_stays_positive():
    _, reading, _ = stages()["rate: integral"]
    assert regular_logarithm("ln u- ρ", "ω", reading)
    assert regular_logarithm("ln k+", "ω", reading)
    for name in ("ln u-", "ln ω^2", "ln u- φ", "1/k+", "σ0"):  # roots on the axis, at 0; no logarithms
        assert not regular_logarithm(name, "ω", reading)


def test_other_logarithms_are_not_known_to_be_continuous():
    """ln(c + ω), ln(c - ω^2) and ln(c ω^2 + 1) with c > 1/4: no square of a shift and a positive number."""
    t, w, _, c = running()
    t.assume("c > 0", c, ">")
    t.assume("c > 1/4", c - Number(Fraction(1, 4)), ">")
    t.assume("1 > 0", ONE, ">")
    for name, body in (("sum", c + w), ("difference", c - w * w), ("multiple", c * w * w + ONE)):
        t.assume(f"{name} > 0", body, ">")
        t.atom("log", body, f"{name} > 0", name)
        assert not regular_logarithm(name, "ω", t.reading())
    t.assume("square > 0", w * w + c, ">")
    t.atom("log", w * w + c, "square > 0", "square")
    assert regular_logarithm("square", "ω", t.reading())


def test_an_integral_over_the_whole_axis_is_that_of_the_even_part():
    _, reading, _ = stages()[NUMBERED]
    t = spectrum.theory()
    both = value(spectrum_poisson.half(t, spectrum_poisson.kernels(t) * on_axis(t, t.symbols["f"])), reading)
    assert value(spectrum_half_plane.poisson(t), reading) == both * scalar("1/π")


def test_a_function_at_a_point_depends_on_what_the_point_is():
    t = Theory("point", "A function at a point that moves")
    s, w, j, c = (t.scalar(n) for n in ("s", "ω", "j", "c"))
    x = t.scalar("x")
    t.define("x", x, w + c)
    y = t.scalar("y")
    body = Log(Modulus(At(s + ONE, s, Sum((x, Product((j, y)))))))
    t.atom("spectral", body, name="ln|f|")
    real = t.reading().real
    assert [v for v in ("ω", "y", "s") if real.varies("ln|f|", v)] == ["ω", "y"]
    for bad in (Sum((w, Product((j, y)))), Sum((x, Product((j, w)))), Sum((s, Product((j, y))))):
        with pytest.raises(Rejected, match="stay what they are"):
            value(Log(Modulus(At(s + ONE, s, bad))), t.reading())


def test_a_function_that_is_positive_on_the_axis_is_complex_elsewhere():
    """f(s) = p(s) p(-s) is |p|^2 on the axis; at s0 its logarithm is not the sum of those of the distances."""
    t = spectrum.theory()
    s, root, i, m = (t.symbols[k] for k in ("s", "φ", "i", "m"))
    f = Product((Roots(s, root, i, m), Roots(Neg(s), root, i, m)))
    point = Sum((t.symbols["σ0"], Product((t.symbols["j"], t.symbols["ω0"]))))
    statement = Equation(Log(At(f, s, point)), "=", ZERO)
    with pytest.raises(Rejected, match="positive on the axis"):
        check_modulus(statement, [Equation(f, "=", f)], t.reading())


def test_infinity_is_where_quadrature_ends():
    assert quad(lambda w: 1 / (1 + w * w), 0, inf)[0] == pytest.approx(integral(lambda w: 1 / (1 + w * w), False))
