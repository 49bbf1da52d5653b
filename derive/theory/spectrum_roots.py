"""The log-integral of one root, by an antiderivative and its limits, and of a polynomial, as the sum over its roots."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from fractions import Fraction

from derive.context import Theory
from derive.derivation import Step
from derive.functions import PI, Abs, Definite, Infinity, Limit, Log, Max, Quotient, Rate
from derive.spectral import (
    At,
    Conjugate,
    Distance,
    ImaginaryPart,
    Modulus,
    RealPart,
    Roots,
    TimesArctan,
    TimesLog,
    Total,
)
from derive.terms import Equation, Glyph, Neg, Product, Sum, Symbol, Term
from derive.theory.scalar_builder import ScalarBuilder
from derive.theory.scalar_continuous import ONE, ZERO, square

SOURCE = "001"
HALF, QUARTER = Fraction(1, 2), Fraction(1, 4)
SIDES = (("-", -1), ("+", 1))  # ω - β and ω + β


# ------------------------------------------------------------------------------------------------ declarations
def declare(t: Theory) -> None:
    """Declare the frequency, and an arbitrary root with its logarithms."""
    pi = t.symbols["π"] = PI
    t.assume("π > 0", pi, ">", text="the circle's number is positive")
    t.atom("reciprocal", pi, "π > 0", "1/π")
    t.scalar("s", meaning="a complex number")
    t.scalar("j", Glyph("j", upright=True), meaning="imaginary unit")
    t.scalar("i", meaning="number of a root")
    t.scalar("m", meaning="number of states")
    w = t.scalar("ω", meaning="frequency")
    t.assume("ω > 0", w, ">", text="half of the axis is enough where the integrand is even")
    t.assume("s > 0", t.symbols["s"], ">", text="where s is real, it is large", case=True)
    a, b = t.parameter("α", meaning="real part of a root"), t.parameter("β", meaning="imaginary part of a root")
    t.atom("absolute", a, name="|α|")
    t.atom("part", a, name="max(0,α)")
    for name in ("ω", "s"):
        variable = t.symbols[name]
        t.atom("reciprocal", variable, f"{name} > 0", f"1/{name}")
        t.atom("log", square(variable), f"{name}^2 > 0", f"ln {name}^2")
    for sign, shift in SIDES:
        x = shifted(w, b, shift)
        t.generic(f"distance{sign}", x, a, w, "except at the frequency of a root on the axis")
        _distance(t, square(x) + square(a), f"u{sign}", f"distance{sign}")
        t.atom("spectral", TimesLog(x, a), name=f"x ln u{sign}")
        t.atom("spectral", TimesArctan(x, a), name=f"arctan{sign}")
    t.generic("distance along the reals", t.symbols["s"] - a, b, t.symbols["s"], "except at a real root")
    _distance(t, square(t.symbols["s"] - a) + square(b), "u(s)", "distance along the reals")
    t.atom("spectral", TimesLog(w, ZERO), name="ω ln ω^2")
    t.atom("spectral", TimesLog(b, a), name="β ln u(0)")
    t.atom("spectral", TimesArctan(b, a), name="arctan(0)")
    t.atom("improper", root_integrand(w, a, b), name="integral of a root")
    low, high = (TimesLog(shifted(w, b, k), a) for _, k in SIDES)
    turns = [TimesArctan(shifted(w, b, k), a) for _, k in SIDES]
    G = t.scalar("G", meaning="antiderivative")
    t.symbols["G"] = G = replace(G, show_args=("ω",))
    t.define("G", G, low + high - 2 * TimesLog(w, ZERO) + 2 * turns[0] + 2 * turns[1], "0 where a factor vanishes")


def _distance(t: Theory, u: Term, name: str, why: str) -> None:
    t.atom("reciprocal", u, why, f"1/{name}")
    t.atom("log", u, why, f"ln {name}")


def shifted(w: Term, b: Term, sign: int) -> Term:
    """Return w + b or w - b."""
    return w + b if sign > 0 else w - b


def root_integrand(w: Term, a: Term, b: Term) -> Term:
    """Return ln|jω - λ|^2 + ln|jω - conj λ|^2 - 2 ln ω^2 for the root λ = a + jb."""
    low, high = square(w - b) + square(a), square(w + b) + square(a)
    return Log(low) + Log(high) - 2 * Log(square(w))


def axis(t: Theory) -> Product:
    """Return jω."""
    return Product((t.symbols["j"], t.symbols["ω"]))


def declare_family(t: Theory, root: Symbol, *signs: int) -> None:
    """Declare what the rules read of a family of roots: logarithms of distances, sums of parts, products."""
    index, count = t.symbols[t.families[root.name].index], t.symbols[t.families[root.name].count]
    re, im, w, s, name = RealPart(root), ImaginaryPart(root), t.symbols["ω"], t.symbols["s"], root.name
    for sign, shift in SIDES:
        t.generic(f"distance{sign} {name}", shifted(w, im, shift), re, w, "except at the frequency of a root")
        t.atom("log", square(shifted(w, im, shift)) + square(re), f"distance{sign} {name}", f"ln u{sign} {name}")
        t.atom(
            "spectral",
            Total(Log(square(shifted(w, im, shift)) + square(re)), index, count),
            name=f"sum ln u{sign} {name}",
        )
    for shift in signs:
        x, key = shifted(s, re, -shift), f"u(s){'' if shift > 0 else '-'} {name}"
        t.generic(f"distance {key}", x, im, s, "except at a real root")
        t.atom("log", square(x) + square(im), f"distance {key}", f"ln {key}")
        t.atom("spectral", Total(Log(square(x) + square(im)), index, count), name=f"sum ln {key}")
        point = s if shift > 0 else Neg(s)
        t.atom("spectral", Roots(point, root, index, count), name=f"product {key}")
        t.atom("reciprocal", Roots(point, root, index, count), f"product {key} ≠ 0", f"1/product {key}")
    t.atom("absolute", re, name=f"|Re {name}|")
    t.atom("part", re, name=f"max(0,Re {name})")
    for key, body in (("Re", re), ("|Re|", Abs(re)), ("max", Max(re))):
        t.atom("spectral", Total(body, index, count), name=f"sum {key} {name}")


def declare_integrals(t: Theory, name: str, log: Term, zeros: Symbol, poles: Symbol) -> None:
    """Declare the logarithm of a quotient on the axis and its integral over half of the axis."""
    i, m = t.symbols["i"], t.symbols["m"]
    t.atom("spectral", log, name=f"ln {name}")
    t.atom("improper", log, name=f"integral of ln {name}")
    pair = _pair(t, zeros, poles)
    t.atom("improper", Total(pair, i, m), name=f"integral of the roots of {name}")
    t.atom("improper", weight(log) * Total(pair, i, m), name=f"integral of the weighted roots of {name}")
    t.atom("improper", pair, name=f"integral of one root of {name}")


def on_axis(t: Theory, function: Term) -> Log:
    """Return ln|f(jω)|."""
    return Log(Modulus(At(function, t.symbols["s"], axis(t))))


def weight(log: Term) -> Fraction:
    """Return the weight of the squared distances of both conjugates: 1/4 in ln|f|, 1/2 in ln f for f = |g|^2."""
    return QUARTER if isinstance(log, Log) and isinstance(log.body, Modulus) else HALF


def _both(t: Theory, root: Symbol) -> tuple[Log, Log]:
    """Return ln|jω - root|^2, and the same for the conjugate."""
    return Log(Distance(axis(t), root)), Log(Distance(axis(t), Conjugate(root)))


def _pair(t: Theory, zeros: Symbol, poles: Symbol) -> Term:
    """Return the integrand of one zero less that of one pole, each with its conjugate."""
    one, other = _both(t, zeros), _both(t, poles)
    return one[0] + one[1] - other[0] - other[1]


# ------------------------------------------------------------------------------------------------ one root
def derive(b: ScalarBuilder) -> None:
    """Derive the integral of one root, and its decay along the reals."""
    _derive_root(b)
    _derive_along_the_reals(b)
    _derive_part(b)


def _derive_root(b: ScalarBuilder) -> None:
    t = b.theory
    w, a, c = (t.symbols[k] for k in ("ω", "α", "β"))
    b.heading("The log-integral of one root")
    b.say("Let ", a, " + j", c, " be any root. With its conjugate it contributes to the logarithm of a modulus")
    b.given("ω > 0")
    b.sign("ω^2 > 0", Equation(square(w), ">", ZERO), "a square", ["ω > 0"])
    G, turns = t.symbols["G"], [TimesArctan(shifted(w, c, k), a) for _, k in SIDES]
    b.say("An antiderivative, continuous also at the frequency of a root on the axis:")
    b.given("G")
    b.state("antiderivative", Equation(Rate(G, w), "=", root_integrand(w, a, c)), "differentiate")
    ratios = {sign: Log(square(shifted(w, c, k)) + square(a)) - Log(square(w)) for sign, k in SIDES}
    for sign, k in SIDES:
        _derive_tail(b, w, a, c, sign, k)
    far = w * ratios["-"] + w * ratios["+"] - c * ratios["-"] + c * ratios["+"] + 2 * turns[0] + 2 * turns[1]
    b.state("antiderivative far out", Equation(G, "=", far), "the terms with ln ω² cancel")
    limit = 2 * PI * Abs(a)
    b.linked(
        "at infinity", Equation(Limit(G, w, Infinity()), "=", limit), "same argument",
        "the logarithms cancel, arctan tends to π/2", ["antiderivative far out"],
    )  # fmt: skip
    b.state("at zero", Equation(Limit(G, w, ZERO), "=", ZERO), "both functions are odd")
    b.linked(
        "root lemma", Equation(Definite(root_integrand(w, a, c), w, ZERO, Infinity()), "=", limit), "integral",
        "the difference of the limits", ["antiderivative", "at infinity", "at zero"],
    )  # fmt: skip


def _derive_tail(b: ScalarBuilder, w: Symbol, a: Symbol, c: Symbol, sign: str, k: int) -> None:
    """Derive the limits of ln(u/ω²) and of ω ln(u/ω²), with u = (ω ± β)² + α²."""
    u, slope, size = square(shifted(w, c, k)) + square(a), 2 * c, square(a) + square(c)
    ratio, shift = Log(u) - Log(square(w)), slope if k > 0 else -slope
    up, down, name = f"ln u{sign} - ln ω^2 ≤", f"ln ω^2 - ln u{sign} ≤", f" ({sign}β)"
    above = shifted(Quotient(size, square(w)), Quotient(slope, w), k)
    below = Neg(Quotient(shifted(size, slope * w, k), u))
    b.sign("above" + name, Equation(above, "≥", ratio), "ln x ≤ x - 1", [up])
    b.sign("below" + name, Equation(below, "≥", -ratio), "ln x ≤ x - 1", [down])
    bounds = ["above" + name, "below" + name]
    b.linked(
        "logarithm" + name, Equation(Limit(ratio, w, Infinity()), "=", ZERO), "squeeze", "both bounds vanish", bounds
    )
    rest = shifted((3 * square(c) - square(a)) * w, slope * size, k)
    gap, turned = shifted(w * ratio, slope, -k), shifted(-(w * ratio), slope, k)
    bounds = ["above, times ω" + name, "below, times ω" + name]
    b.sign(bounds[0], Equation(Quotient(size, w), "≥", gap), "the first bound", [up, "ω > 0"])
    b.sign(bounds[1], Equation(Quotient(rest, u), "≥", turned), "the second bound", [down, "ω > 0"])
    b.linked(
        "tail" + name, Equation(Limit(w * ratio, w, Infinity()), "=", shift), "squeeze", "both bounds vanish", bounds
    )


def _derive_along_the_reals(b: ScalarBuilder) -> None:
    t = b.theory
    s, a, c = (t.symbols[k] for k in ("s", "α", "β"))
    u, size = square(s - a) + square(c), square(a) + square(c)
    ratio, rest = Log(u) - Log(square(s)), (3 * square(a) - square(c)) * s - 2 * a * size
    up, down = "ln u(s) - ln s^2 ≤", "ln s^2 - ln u(s) ≤"
    b.say("Along the reals the same logarithm decays like 1/s:")
    b.given("s > 0")
    b.sign("s^2 > 0", Equation(square(s), ">", ZERO), "a square", ["s > 0"])
    b.sign("above, times s", Equation(Quotient(size, s), "≥", s * ratio + 2 * a), "ln x ≤ x - 1", [up, "s > 0"])
    b.sign("below, times s", Equation(Quotient(rest, u), "≥", -(2 * a) - s * ratio), "ln x ≤ x - 1", [down, "s > 0"])
    b.linked(
        "along the reals", Equation(Limit(s * ratio, s, Infinity()), "=", -(2 * a)), "squeeze", "both bounds vanish",
        ["above, times s", "below, times s"],
    )  # fmt: skip


def _derive_part(b: ScalarBuilder) -> None:
    a = b.theory.symbols["α"]
    b.say("The modulus of a real number by its positive part:")
    b.equal("modulus", Equation(Abs(a), "=", 2 * Max(a) - a), ["|α| ≥ 0", "max(0,α) ≥ 0", "max(0,α) ≥ its argument"])


# ------------------------------------------------------------------------------------------------ a family of roots
def derive_family(b: ScalarBuilder, root: Symbol, *, reals: int = 0) -> None:
    """Derive for the roots of a real polynomial: |Re| by the positive part, and the decay along the reals, in sums.

    ``reals`` is 1 for the decay at s, -1 for that at -s as well.
    """
    t, re = b.theory, RealPart(root)
    i, m = t.symbols[t.families[root.name].index], t.symbols[t.families[root.name].count]
    one = Equation(Abs(re), "=", 2 * Max(re) - re)
    _instance(b, f"modulus of {root.name}", one, "modulus", i, m)
    s, im = t.symbols["s"], ImaginaryPart(root)
    for sign in (1, -1)[: (0, 1, 2)[abs(reals) + (reals < 0)]]:
        part = re if sign > 0 else Neg(re)
        ratio = Log(square(s - part) + square(im)) - Log(square(s))
        decay = Equation(Limit(s * ratio, s, Infinity()), "=", -(2 * part))
        _instance(b, f"decay of {root.name}" + "-" * (sign < 0), decay, "along the reals", i, m)


def _instance(b: ScalarBuilder, name: str, one: Equation, lemma: str, i: Symbol, m: Symbol) -> None:
    """Put a root into a lemma about arbitrary numbers, and sum over the roots."""
    b.linked(name, one, "instance", "for each root", [lemma])
    match one:
        case Equation(Limit(body, x, point), relation, rhs):
            whole = Equation(Limit(Total(body, i, m), x, point), relation, Total(rhs, i, m))
        case Equation(Definite(body, x, lower, upper), relation, rhs):
            whole = Equation(Definite(Total(body, i, m), x, lower, upper), relation, Total(rhs, i, m))
        case Equation(lhs, relation, rhs):
            whole = Equation(Total(lhs, i, m), relation, Total(rhs, i, m))
    b.linked(f"{name}, summed", whole, "sum over", "summed over the roots", [name])


def derive_root(b: ScalarBuilder, root: Symbol) -> None:
    """Put each root of a family into the root lemma."""
    w, re, im = b.theory.symbols["ω"], RealPart(root), ImaginaryPart(root)
    integral = half(b.theory, root_integrand(w, re, im))
    b.linked(
        f"root lemma of {root.name}",
        Equation(integral, "=", 2 * PI * Abs(re)),
        "instance",
        "for each root",
        ["root lemma"],
    )


def scaled(number: Fraction, term: Term) -> Term:
    """Return number * term, the term itself for 1."""
    return term if number == 1 else number * term


def derive_integral(b: ScalarBuilder, name: str, log: Term, zeros: Symbol, poles: Symbol, by_roots: str) -> Step:
    """Derive (1/2π) ∫ ln|f(jω)| dω = ½ Σ|Re zeros| - ½ Σ|Re poles| from ``by_roots``; twice that for f = |g|^2."""
    t, part = b.theory, weight(log)
    i, m = t.symbols["i"], t.symbols["m"]
    sums = {r.name: [Total(log, i, m) for log in _both(t, r)] for r in (zeros, poles)}
    one = scaled(2 * part, sums[zeros.name][0]) - scaled(2 * part, sums[poles.name][0])
    b.linked(f"ln {name} on the axis", Equation(log, "=", one), "modulus", "the modulus of a product", [by_roots])
    for root in (zeros, poles):
        if f"conjugates of {root.name}" not in b.steps:
            pair = Equation(sums[root.name][0], "=", sums[root.name][1])
            b.linked(f"conjugates of {root.name}", pair, "conjugate", "complex roots come in conjugate pairs", [])
    pair, conjugates = _pair(t, zeros, poles), [f"conjugates of {r.name}" for r in (zeros, poles)]
    even = Total(pair, i, m)
    b.state(
        f"ln {name}, even",
        Equation(log, "=", part * even),
        "pairs of conjugates",
        [f"ln {name} on the axis", *conjugates],
    )
    value = 2 * PI * Abs(RealPart(zeros)) - 2 * PI * Abs(RealPart(poles))
    b.linked(
        f"one root of {name}", Equation(half(t, pair), "=", value), "linear", "a zero less a pole",
        [f"root lemma of {r.name}" for r in (zeros, poles)],
    )  # fmt: skip
    b.linked(
        f"roots of {name}",
        Equation(half(t, even), "=", Total(value, i, m)),
        "sum over",
        "summed over the roots",
        [f"one root of {name}"],
    )
    b.linked(
        f"weighted roots of {name}",
        Equation(half(t, part * even), "=", part * Total(value, i, m)),
        "linear",
        "times a number",
        [f"roots of {name}"],
    )
    b.linked(
        f"half of the axis of {name}",
        Equation(half(t, log), "=", half(t, part * even)),
        "same argument",
        "the same integrand",
        [f"ln {name}, even"],
    )
    moduli = [scaled(2 * part, Total(Abs(RealPart(r)), i, m)) for r in (zeros, poles)]
    return b.state(
        f"log-integral of {name}",
        Equation(whole(b, log), "=", moduli[0] - moduli[1]),
        "the integrand is even", [f"half of the axis of {name}", f"weighted roots of {name}"],
    )  # fmt: skip


def derive_same(b: ScalarBuilder, name: str, new: Log, old: Log, link: str) -> None:
    """Derive that the logarithms of one function, written in two ways, are the same, and so are their integrals."""
    first, second = f"logarithm: {name}", f"integral: {name}"
    b.linked(first, Equation(new, "=", old), "same argument", "the same function", [link])
    halves = [half(b.theory, log) for log in (new, old)]
    b.linked(second, Equation(halves[0], "=", halves[1]), "same argument", "the same integrand", [first])


def over_roots(t: Theory, root: Symbol, point: Term) -> Roots:
    """Return the product of (point - root) over a family of roots."""
    family = t.families[root.name]
    return Roots(point, root, t.symbols[family.index], t.symbols[family.count])


def half(t: Theory, body: Term) -> Definite:
    """Return the integral over the positive frequencies."""
    return Definite(body, t.symbols["ω"], ZERO, Infinity())


def whole(b: ScalarBuilder, body: Term) -> Term:
    """Return (1/2π) times the integral over the frequency axis."""
    return Quotient(ONE, 2 * PI) * Definite(body, b.theory.symbols["ω"], Neg(Infinity()), Infinity())


# ------------------------------------------------------------------------------------------------ along the reals
def _along(b: ScalarBuilder, root: Symbol, sign: int) -> Total:
    """Return the sum of ln|s - root|^2 along the reals, or of ln|-s - root|^2."""
    s, i, m = (b.theory.symbols[k] for k in ("s", "i", "m"))
    return Total(Log(Distance(s if sign > 0 else Neg(s), root)), i, m)


def derive_first_term(
    b: ScalarBuilder,
    name: str,
    function: Term,
    zeros: Sequence[tuple[Symbol, int]],
    poles: Sequence[tuple[Symbol, int]],
    limit: Term,
    by_roots: str,
    number: str = "",
) -> Limit:
    """Derive lim s ln|f(s)|/2 as s grows along the reals, root by root; the roots come with the sign of s."""
    t = b.theory
    s, i, m = (t.symbols[k] for k in ("s", "i", "m"))
    log = Log(Modulus(At(function, s, s)))
    signed = [*((r, k, 1) for r, k in zeros), *((r, k, -1) for r, k in poles)]
    logs = [Neg(HALF * _along(b, r, k)) if side < 0 else HALF * _along(b, r, k) for r, k, side in signed]
    b.linked(
        f"ln|{name}| along the reals",
        Equation(log, "=", Sum(tuple(logs))),
        "modulus",
        "the modulus of a product",
        [by_roots],
    )
    decay = [QUARTER * Total(s * (_along(b, r, k).body - Log(square(s))), i, m) for r, k, _ in signed]
    decays = Sum(tuple(Neg(d) if side < 0 else d for d, (_, _, side) in zip(decay, signed, strict=True)))
    b.state(
        f"s ln|{name}|",
        Equation(HALF * s * log, "=", decays),
        "the terms with ln s² cancel",
        [f"ln|{name}| along the reals"],
    )
    first = Limit(HALF * s * log, s, Infinity())
    b.linked(
        f"first term of {name}",
        Equation(first, "=", limit),
        "same argument",
        "root by root",
        [f"s ln|{name}|"],
        number=number,
        source=SOURCE if number else "",
    )
    return first
