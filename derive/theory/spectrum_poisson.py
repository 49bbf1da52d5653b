"""Poisson's formula in the right half plane for the logarithm of the distance to one root.

The integral is differentiated in the distance of the root from the axis; where that is large, the root contributes
nothing.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from fractions import Fraction

from derive.context import Theory
from derive.derivation import Derived
from derive.functions import PI, Abs, Infinity, Limit, Log, Quotient, Rate
from derive.spectral import TimesArctan
from derive.terms import Equation, Glyph, Neg, Number, Sum, Symbol, Term
from derive.theory.scalar_builder import ScalarBuilder
from derive.theory.scalar_continuous import ONE, ZERO, square
from derive.theory.spectrum_roots import SIDES, half, shifted

TWO, FOUR = Number(Fraction(2)), Number(Fraction(4))


# ------------------------------------------------------------------------------------------------ terms
def shift(t: Theory, side: int) -> Term:
    """Return ω - ω0 or ω + ω0."""
    return shifted(t.symbols["ω"], t.symbols["ω0"], side)


def kernel(t: Theory, side: int = -1) -> Quotient:
    """Return Poisson's kernel of the half plane, σ0 / (σ0^2 + (ω - ω0)^2), or its mirror image."""
    return Quotient(t.symbols["σ0"], square(t.symbols["σ0"]) + square(shift(t, side)))


def kernels(t: Theory) -> Symbol:
    """Return the sum of the kernel and its mirror image."""
    return t.symbols["Π"]


def near(t: Theory, a: Term, c: Term, side: int) -> Term:
    """Return |jω - λ|^2 for the root λ = a + jc, or for its conjugate."""
    return square(shifted(t.symbols["ω"], c, side)) + square(a)


def far(t: Theory, a: Term, c: Term, side: int) -> Term:
    """Return |s0 + conj λ|^2 for the root λ = a + jc, or |s0 + λ|^2."""
    return square(t.symbols["σ0"] + a) + square(shifted(t.symbols["ω0"], c, side))


def integrand(t: Theory, a: Term, c: Term) -> Term:
    """Return what a root a + jc and its conjugate contribute to the integral over half of the axis."""
    low, high = (Log(near(t, a, c, k)) for _, k in SIDES)
    return kernels(t) * (low + high)


def integral(t: Theory, a: Term, c: Term) -> Term:
    """Return its integral for a > 0."""
    low, high = (Log(far(t, a, c, k)) for _, k in SIDES)
    return PI * (low + high)


def decaying(t: Theory, a: Term) -> tuple[Term, Term]:
    """Return integrand and integral less those of a root that is a away from the axis, with a >> 1."""
    c, log = t.symbols["β"], 2 * Log(square(a))
    near_logs, far_logs = ([Log(u(t, a, c, k)) for _, k in SIDES] for u in (near, far))
    return kernels(t) * (near_logs[0] + near_logs[1] - log), PI * (far_logs[0] + far_logs[1] - log)


def rates(t: Theory, a: Term) -> tuple[Term, Term]:
    """Return the derivatives of both in a."""
    c, rest = t.symbols["β"], Quotient(FOUR, a)
    low, high = (Quotient(2 * a, near(t, a, c, k)) for _, k in SIDES)
    bottom, top = (Quotient(2 * (t.symbols["σ0"] + a), far(t, a, c, k)) for _, k in SIDES)
    return kernels(t) * (low + high - rest), PI * (bottom + top - rest)


# ------------------------------------------------------------------------------------------------ declarations
def declare(t: Theory) -> None:
    """Declare the point s0, the running distance of a root from the axis, and what is read of both."""
    sigma = t.scalar("σ0", Glyph("σ", sub="0"), nonnegative=True, meaning="real part of s0")
    t.scalar("ω0", Glyph("ω", sub="0"), meaning="imaginary part of s0")
    t.assume("σ0 > 0", sigma, ">", text="s0 is in the right half plane")
    t.run("r", meaning="distance of a root from the axis")
    t.run("ρ", meaning="the same, except where the root is the mirror image of s0")
    t.atom("reciprocal", sigma, "σ0 > 0", "1/σ0")
    t.atom("absolute", sigma, name="|σ0|")
    w0 = t.symbols["ω0"]
    for sign, k in SIDES:
        _read(t, square(sigma) + square(shift(t, k)), f"k{sign}")
        t.atom("spectral", TimesArctan(shift(t, k), sigma), name=f"σ0 arctan{sign}")
    t.atom("spectral", TimesArctan(w0, sigma), name="σ0 arctan(0)")
    _read(t, square(sigma) + square(w0), "k(0)")
    t.scalar("Π", meaning="Poisson's kernel and its mirror image")
    t.symbols["Π"] = both = replace(t.symbols["Π"], show_args=("ω",))
    t.define("Π", both, kernel(t, -1) + kernel(t, 1))
    for name in ("r", "ρ"):
        _declare_running(t, name)
    _declare_antiderivative(t)
    for sign, k in SIDES:
        _read(t, far(t, Abs(t.symbols["α"]), t.symbols["β"], k), f"m{sign} |α|")
    t.atom("improper", integrand(t, t.symbols["α"], t.symbols["β"]), name="Poisson integral of a root")


def _read(t: Theory, u: Term, name: str) -> None:
    t.atom("reciprocal", u, f"{name} > 0", f"1/{name}")
    t.atom("log", u, f"{name} > 0", f"ln {name}")


def _declare_running(t: Theory, name: str) -> None:
    a, c = t.symbols[name], t.symbols["β"]
    t.atom("reciprocal", a, f"{name} > 0", f"1/{name}")
    t.atom("log", square(a), f"{name}^2 > 0", f"ln {name}^2")
    for sign, k in SIDES:
        _read(t, near(t, a, c, k), f"u{sign} {name}")
        _read(t, far(t, a, c, k), f"m{sign} {name}")
    for key, body in (
        ("decaying integrand", decaying(t, a)[0]), ("its rate", rates(t, a)[0]),
        ("far root", kernels(t) * (2 * Log(square(a)))), ("root", integrand(t, a, c)),
    ):  # fmt: skip
        t.atom("improper", body, name=f"integral of the {key} ({name})")


def _declare_antiderivative(t: Theory) -> None:
    a, c, sigma, w0, w = (t.symbols[k] for k in ("ρ", "β", "σ0", "ω0", "ω"))
    t.atom("absolute", a, name="|ρ|")
    _read(t, square(c) + square(a), "u(0) ρ")
    t.atom("spectral", TimesArctan(c, a), name="ρ arctan(0)")
    logs = {sign: Log(near(t, a, c, k)) - Log(square(sigma) + square(shift(t, k))) for sign, k in SIDES}
    for sign, k in SIDES:
        t.atom("spectral", TimesArctan(shifted(w, c, k), a), name=f"ρ arctan{sign}")
    for sign, k in SIDES:
        gap = shifted(w0, c, k)
        t.generic(f"n{sign}", a - sigma, gap, a, "except where the root is the mirror image of s0")
        mirror = square(a - sigma) + square(gap)
        t.atom("reciprocal", mirror, f"n{sign}", f"1/n{sign}")
        low, high = (logs["-"], logs["+"]) if k < 0 else (_crossed(t, 1), _crossed(t, -1))
        own, other = (Sum(tuple(TimesArctan(shifted(w, x, j), y) for _, j in SIDES)) for x, y in ((w0, sigma), (c, a)))
        size = square(gap)
        H = t.scalar(f"H{sign}", Glyph("H", sub="−" if k < 0 else "+"), meaning="antiderivative")
        body = (
            a * sigma * gap * (low - high)
            + Quotient(a, sigma) * (size - square(sigma) + square(a)) * own
            + Quotient(sigma, a) * (size + square(sigma) - square(a)) * other
        )
        t.define(f"H{sign}", H, Quotient(TWO, far(t, a, c, k) * mirror) * body)


def _crossed(t: Theory, k: int) -> Term:
    """Return ln|jω - conj λ|^2 - ln|jω - s0|^2, or its mirror image."""
    return Log(near(t, t.symbols["ρ"], t.symbols["β"], k)) - Log(square(t.symbols["σ0"]) + square(shift(t, -k)))


# ------------------------------------------------------------------------------------------------ one root
def derive(b: ScalarBuilder) -> None:
    """Derive Poisson's formula for one root."""
    t = b.theory
    b.heading("Poisson's formula in the right half plane")
    b.say("Let s0 = ", t.symbols["σ0"], " + j", t.symbols["ω0"], " be any point with")
    b.given("σ0 > 0")
    _derive_signs(b)
    b.say("Poisson's kernel of the half plane and its mirror image add up to")
    b.given("Π")
    _derive_antiderivative(b)
    _derive_rate(b)
    _derive_start(b)
    _derive_lemma(b)


Row = tuple[str, Term, Sequence[str], Sequence[Term]]


def positive(b: ScalarBuilder, rows: Sequence[Row], reason: str = "a sum of squares") -> None:
    """Derive that some terms are positive, each from the facts and squares beside it, and display them together."""
    steps = [
        b.sign(f"{name} > 0", Equation(body, ">", ZERO), reason, known, squares=squares, show=False)
        for name, body, known, squares in rows
    ]
    b.items.append(Derived(tuple(steps)))


def _derive_signs(b: ScalarBuilder) -> None:
    t = b.theory
    sigma, w0, c, w = (t.symbols[k] for k in ("σ0", "ω0", "β", "ω"))
    rows: list[Row] = [("σ0^2", square(sigma), ["σ0 > 0"], [])]
    rows += [(f"k{sign}", square(sigma) + square(shift(t, k)), ["σ0 > 0"], [shift(t, k)]) for sign, k in SIDES]
    rows += [("k(0)", square(sigma) + square(w0), ["σ0 > 0"], [w0])]
    positive(b, rows)
    b.say("Let r be the distance of the root from the axis, and ρ the same where it is not the mirror image of s0:")
    b.given("r > 0", "ρ > 0", "n-", "n+")
    rows = []
    for name in ("r", "ρ"):
        a, known = t.symbols[name], [f"{name} > 0"]
        rows.append((f"{name}^2", square(a), known, []))
        rows += [(f"u{sign} {name}", near(t, a, c, k), known, [shifted(w, c, k)]) for sign, k in SIDES]
        rows += [(f"m{sign} {name}", far(t, a, c, k), ["σ0 > 0", *known], [shifted(w0, c, k)]) for sign, k in SIDES]
    rows.append(("u(0) ρ", square(c) + square(t.symbols["ρ"]), ["ρ > 0"], [c]))
    positive(b, rows)


def turns(t: Theory) -> Term:
    """Return the antiderivative of both kernels times σ0."""
    low, high = (TimesArctan(shift(t, k), t.symbols["σ0"]) for _, k in SIDES)
    return low + high


def _derive_antiderivative(b: ScalarBuilder) -> None:
    """Derive the integral of the derivative in ρ of the decaying integrand."""
    t = b.theory
    w, sigma, w0, a, c = (t.symbols[k] for k in ("ω", "σ0", "ω0", "ρ", "β"))
    b.say("The derivative in ρ of what one root contributes has an antiderivative:")
    b.given("H-", "H+")
    for name in ("σ0", "ρ"):
        x = t.symbols[name]
        b.equal(f"|{name}| = {name}", Equation(Abs(x), "=", x), [f"|{name}| ≥ 0", f"{name} > 0"])
    for sign, k in SIDES:
        for name, re, im in ((f"k{sign}", sigma, w0), (f"u{sign} ρ", a, c)):
            u = square(shifted(w, im, k)) + square(re)
            _squeeze(b, name, u, w, Neg(2 * im) if k < 0 else 2 * im, square(re) + square(im))
    for sign, k in SIDES:
        H, pairs = t.symbols[f"H{sign}"], [kernel(t, j) * Quotient(2 * a, near(t, a, c, -j * k)) for _, j in SIDES]
        b.state(f"rate of H{sign}", Equation(Rate(H, w), "=", pairs[0] + pairs[1]), "partial fractions", [f"H{sign}"])
        top = Quotient(2 * PI * (sigma + a), far(t, a, c, k))
        known = [f"H{sign}", "|σ0| = σ0", "|ρ| = ρ"]
        b.state(
            f"H{sign} far out",
            Equation(Limit(H, w, Infinity()), "=", top),
            "the logarithms cancel, arctan tends to π/2",
            known,
        )
        b.state(f"H{sign} at zero", Equation(Limit(H, w, ZERO), "=", ZERO), "both functions are odd", [f"H{sign}"])
    g, value = rates(t, a)
    G = t.symbols["H-"] + t.symbols["H+"] - Quotient(FOUR, a * sigma) * turns(t)
    by_antiderivative(b, "rate", G, g, value, ["rate of H-", "rate of H+", "|σ0| = σ0", "Π"])


def by_antiderivative(b: ScalarBuilder, name: str, G: Term, g: Term, value: Term, using: Sequence[str]) -> None:
    """Derive an integral over the positive frequencies from an antiderivative that vanishes at 0."""
    w = b.theory.symbols["ω"]
    b.state(f"{name}: antiderivative", Equation(Rate(G, w), "=", g), "differentiate", using)
    b.state(f"{name}: far out", Equation(Limit(G, w, Infinity()), "=", value), "term by term", using)
    b.state(f"{name}: at zero", Equation(Limit(G, w, ZERO), "=", ZERO), "both functions are odd")
    links = [f"{name}: antiderivative", f"{name}: far out", f"{name}: at zero"]
    b.linked(
        f"{name}: integral", Equation(half(b.theory, g), "=", value), "integral", "the difference of the limits", links
    )


def _derive_rate(b: ScalarBuilder) -> None:
    """Derive the derivatives in r, and the sign of that of the integrand."""
    t = b.theory
    r, c, w = t.symbols["r"], t.symbols["β"], t.symbols["ω"]
    b.say("What a root contributes, less a term that does not depend on its imaginary part, decreases with r:")
    for name, body, rate in zip(("integrand", "value"), decaying(t, r), rates(t, r), strict=True):
        b.state(f"rate of the {name}", Equation(Rate(body, r), "=", rate), "differentiate")
    inverse: list[Row] = [
        (f"1/k{sign}", Quotient(ONE, square(t.symbols["σ0"]) + square(shift(t, k))), [f"k{sign} > 0"], [])
        for sign, k in SIDES
    ]
    inverse += [(f"1/u{sign} r", Quotient(ONE, near(t, r, c, k)), [f"u{sign} r > 0"], []) for sign, k in SIDES]
    inverse += [("1/r", Quotient(ONE, r), ["r > 0"], [])]
    inverse += [("kernels", kernels(t), ["σ0 > 0", "1/k- > 0", "1/k+ > 0"], [])]
    positive(b, inverse, "reciprocals of positive numbers")
    for sign, k in SIDES:
        gap = Quotient(TWO, r) - Quotient(2 * r, near(t, r, c, k))
        b.sign(
            f"gap{sign}",
            Equation(gap, "≥", ZERO),
            "a quotient of squares",
            ["1/r > 0", f"1/u{sign} r > 0"],
            squares=[shifted(w, c, k)],
        )
    b.sign("decreasing", Equation(Neg(rates(t, r)[0]), "≥", ZERO), "a product", ["kernels > 0", "gap-", "gap+"])


def _derive_start(b: ScalarBuilder) -> None:
    """Derive that integrand and value vanish as r tends to infinity."""
    t = b.theory
    r, c, sigma, w0, w = (t.symbols[k] for k in ("r", "β", "σ0", "ω0", "ω"))
    b.say("and vanishes far from the axis:")
    for sign, k in SIDES:
        _squeeze(b, f"u{sign} r", near(t, r, c, k), r, ZERO, square(shifted(w, c, k)))
        _squeeze(b, f"m{sign} r", far(t, r, c, k), r, 2 * sigma, square(sigma) + square(shifted(w0, c, k)))
    for name, body in zip(("integrand", "value"), decaying(t, r), strict=True):
        b.state(f"the {name} vanishes", Equation(Limit(body, r, Infinity()), "=", ZERO), "term by term")


def _squeeze(b: ScalarBuilder, name: str, u: Term, x: Symbol, slope: Term, size: Term) -> None:
    """Derive ln u - ln x^2 -> 0 for u = x^2 + slope x + size."""
    ratio, bounds = Log(u) - Log(square(x)), [f"ln {name} from above", f"ln {name} from below"]
    above, below = (Quotient(size, y) if slope == ZERO else Quotient(slope * x + size, y) for y in (square(x), u))
    facts = [f"ln {name} - ln {x.name}^2 ≤", f"ln {x.name}^2 - ln {name} ≤"]
    b.sign(bounds[0], Equation(above, "≥", ratio), "ln x ≤ x - 1", facts[:1])
    b.sign(bounds[1], Equation(Neg(below), "≥", Neg(Log(u)) + Log(square(x))), "ln x ≤ x - 1", facts[1:])
    vanishing = Equation(Limit(ratio, x, Infinity()), "=", ZERO)
    b.linked(f"ln {name} far out", vanishing, "squeeze", "both bounds vanish", bounds)


def _derive_lemma(b: ScalarBuilder) -> None:
    """Derive the Poisson integral of one root, for any real and imaginary part."""
    t = b.theory
    r, c, sigma, alpha = (t.symbols[k] for k in ("r", "β", "σ0", "α"))
    body, value = decaying(t, r)
    links = [
        "rate: integral",
        "rate of the integrand",
        "rate of the value",
        "decreasing",
        "the integrand vanishes",
        "the value vanishes",
    ]
    b.linked(
        "decaying lemma",
        Equation(half(t, body), "=", value),
        "parameter",
        "integrate from r to infinity; the derivative has one sign",
        links,
    )
    log = 2 * Log(square(r))
    by_antiderivative(
        b, "far root", Quotient(ONE, sigma) * log * turns(t), kernels(t) * log, PI * log, ["|σ0| = σ0", "Π"]
    )
    b.linked(
        "lemma for r > 0",
        Equation(half(t, integrand(t, r, c)), "=", integral(t, r, c)),
        "linear",
        "the sum",
        ["decaying lemma", "far root: integral"],
    )
    low, high = (Quotient(2 * r, near(t, r, c, k)) for _, k in SIDES)
    rate = kernels(t) * (low + high)
    b.state("rate in r", Equation(Rate(integrand(t, r, c), r), "=", rate), "differentiate")
    b.sign("increasing", Equation(rate, "≥", ZERO), "a product", ["kernels > 0", "r > 0", "1/u- r > 0", "1/u+ r > 0"])
    b.say("With |α| for r, and the limit where α = 0:")
    rows: list[Row] = [
        (f"m{sign} |α|", far(t, Abs(alpha), c, k), ["σ0 > 0", "|α| ≥ 0"], [shifted(t.symbols["ω0"], c, k)])
        for sign, k in SIDES
    ]
    positive(b, rows)
    b.linked(
        "Poisson lemma",
        Equation(half(t, integrand(t, alpha, c)), "=", integral(t, Abs(alpha), c)),
        "any sign",
        "even in r, monotone as r tends to 0",
        ["lemma for r > 0", "rate in r", "increasing"],
    )
