"""The value of a rational function in the right half plane from its modulus on the axis: equation (8) of the source.

One root is integrated against Poisson's kernel by differentiation in its distance from the axis; where that is large,
the root contributes nothing. A rational function is the sum over its roots.
"""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction

from derive.context import Theory
from derive.derivation import Derived
from derive.functions import PI, Abs, Definite, Infinity, Limit, Log, Max, Quotient, Rate
from derive.spectral import At, ImaginaryPart, Modulus, RealPart, TimesArctan, Total
from derive.terms import Equation, Glyph, Neg, Number, Product, Sum, Symbol, Term
from derive.theory.scalar_builder import ScalarBuilder
from derive.theory.scalar_continuous import ONE, ZERO, square
from derive.theory.spectrum_roots import HALF, QUARTER, SIDES, SOURCE, _pair, _shifted, on_axis

TWO, FOUR = Number(Fraction(2)), Number(Fraction(4))


# ------------------------------------------------------------------------------------------------ terms
def shift(t: Theory, side: int) -> Term:
    """Return ω - ω0 or ω + ω0."""
    return _shifted(t.symbols["ω"], t.symbols["ω0"], side)


def kernel(t: Theory, side: int = -1) -> Quotient:
    """Return Poisson's kernel of the half plane, σ0 / (σ0^2 + (ω - ω0)^2), or its mirror image."""
    return Quotient(t.symbols["σ0"], square(t.symbols["σ0"]) + square(shift(t, side)))


def kernels(t: Theory) -> Term:
    """Return the kernel and its mirror image."""
    return kernel(t, -1) + kernel(t, 1)


def near(t: Theory, a: Term, c: Term, side: int) -> Term:
    """Return |jω - λ|^2 for the root λ = a + jc, or for its conjugate."""
    return square(_shifted(t.symbols["ω"], c, side)) + square(a)


def far(t: Theory, a: Term, c: Term, side: int) -> Term:
    """Return |s0 + conj λ|^2 for the root λ = a + jc, or |s0 + λ|^2."""
    return square(t.symbols["σ0"] + a) + square(_shifted(t.symbols["ω0"], c, side))


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


def half(t: Theory, body: Term) -> Definite:
    """Return the integral over the positive frequencies."""
    return Definite(body, t.symbols["ω"], ZERO, Infinity())


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
    for name in ("r", "ρ"):
        _declare_running(t, name)
    _declare_antiderivative(t)
    for sign, k in SIDES:
        _read(t, far(t, Abs(t.symbols["α"]), t.symbols["β"], k), f"m{sign} |α|")
    t.atom("improper", integrand(t, t.symbols["α"], t.symbols["β"]), name="Poisson integral of a root")
    for root in (t.symbols["φ"], t.symbols["η"]):
        _declare_family(t, root)
    _declare_function(t)


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
        t.atom("spectral", TimesArctan(_shifted(w, c, k), a), name=f"ρ arctan{sign}")
    for sign, k in SIDES:
        gap = _shifted(w0, c, k)
        t.generic(f"n{sign}", a - sigma, gap, a, "except where the root is the mirror image of s0")
        mirror = square(a - sigma) + square(gap)
        t.atom("reciprocal", mirror, f"n{sign}", f"1/n{sign}")
        low, high = (logs["-"], logs["+"]) if k < 0 else (_crossed(t, 1), _crossed(t, -1))
        own, other = (Sum(tuple(TimesArctan(_shifted(w, x, j), y) for _, j in SIDES)) for x, y in ((w0, sigma), (c, a)))
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


def _declare_family(t: Theory, root: Symbol) -> None:
    """Declare the logarithms of |s0 + conj λ|^2, with |Re λ| for the real part, and their sums."""
    re, im = RealPart(root), ImaginaryPart(root)
    for sign, k in SIDES:
        u, name = far(t, Abs(re), im, k), f"m{sign} {root.name}"
        t.atom("log", u, f"{name} > 0", f"ln {name}")
        t.atom("spectral", over(t, Log(u)), name=f"sum ln {name}")
    t.atom("log", to_root(t, re, im), f"distance of s0 to {root.name} > 0", f"ln distance {root.name}")
    t.atom("spectral", over(t, Log(to_root(t, re, im))), name=f"sum ln distance {root.name}")
    t.atom("improper", integrand(t, re, im), name=f"Poisson integral of {root.name}")


def over(t: Theory, body: Term) -> Total:
    """Return the sum over the zeros or poles."""
    return Total(body, t.symbols["i"], t.symbols["m"])


def to_root(t: Theory, a: Term, c: Term) -> Term:
    """Return |s0 - λ|^2 for λ = a + jc."""
    return square(t.symbols["σ0"] - a) + square(t.symbols["ω0"] - c)


def value_at(t: Theory) -> Log:
    """Return ln|f(s0)|."""
    point = Sum((t.symbols["σ0"], Product((t.symbols["j"], t.symbols["ω0"]))))
    return Log(Modulus(At(t.symbols["f"], t.symbols["s"], point)))


def _declare_function(t: Theory) -> None:
    zero, pole = t.symbols["φ"], t.symbols["η"]
    re, im = RealPart(zero), ImaginaryPart(zero)
    t.assume("distance of s0 to φ > 0", to_root(t, re, im), ">", text="s0 is no zero of f", case=True)
    for name, u in (("before", to_root(t, Max(re), im)), ("behind", far(t, Max(re), im, -1))):
        t.atom("log", u, f"{name} > 0", f"ln {name}")
        t.atom("spectral", over(t, Log(u)), name=f"sum ln {name}")
    t.atom("spectral", value_at(t), name="ln|f(s0)|")
    pair, log = _pair(t, zero, pole), on_axis(t, t.symbols["f"])
    for name, body in (
        ("a pair of roots", kernels(t) * pair), ("the roots", over(t, kernels(t) * pair)),
        ("the weighted roots", QUARTER * over(t, kernels(t) * pair)), ("ln|f|", kernels(t) * log),
    ):  # fmt: skip
        t.atom("improper", body, name=f"Poisson integral of {name}")


# ------------------------------------------------------------------------------------------------ one root
def derive(b: ScalarBuilder) -> None:
    """Derive Poisson's formula for one root, and equation (8)."""
    t = b.theory
    b.heading("Poisson's formula in the right half plane")
    b.say("Let s0 = ", t.symbols["σ0"], " + j", t.symbols["ω0"], " be any point with")
    b.given("σ0 > 0")
    _derive_signs(b)
    _derive_antiderivative(b)
    _derive_rate(b)
    _derive_start(b)
    _derive_lemma(b)
    _derive_function(b)


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
        rows += [(f"u{sign} {name}", near(t, a, c, k), known, [_shifted(w, c, k)]) for sign, k in SIDES]
        rows += [(f"m{sign} {name}", far(t, a, c, k), ["σ0 > 0", *known], [_shifted(w0, c, k)]) for sign, k in SIDES]
    rows.append(("u(0) ρ", square(c) + square(t.symbols["ρ"]), ["ρ > 0"], [c]))
    positive(b, rows)


def _turns(t: Theory) -> Term:
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
            u = square(_shifted(w, im, k)) + square(re)
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
    G = t.symbols["H-"] + t.symbols["H+"] - Quotient(FOUR, a * sigma) * _turns(t)
    _by_antiderivative(b, "rate", G, g, value, ["rate of H-", "rate of H+", "|σ0| = σ0"])


def _by_antiderivative(b: ScalarBuilder, name: str, G: Term, g: Term, value: Term, using: Sequence[str]) -> None:
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
            squares=[_shifted(w, c, k)],
        )
    b.sign("decreasing", Equation(Neg(rates(t, r)[0]), "≥", ZERO), "a product", ["kernels > 0", "gap-", "gap+"])


def _derive_start(b: ScalarBuilder) -> None:
    """Derive that integrand and value vanish as r tends to infinity."""
    t = b.theory
    r, c, sigma, w0, w = (t.symbols[k] for k in ("r", "β", "σ0", "ω0", "ω"))
    b.say("and vanishes far from the axis:")
    for sign, k in SIDES:
        _squeeze(b, f"u{sign} r", near(t, r, c, k), r, ZERO, square(_shifted(w, c, k)))
        _squeeze(b, f"m{sign} r", far(t, r, c, k), r, 2 * sigma, square(sigma) + square(_shifted(w0, c, k)))
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
    _by_antiderivative(b, "far root", Quotient(ONE, sigma) * log * _turns(t), kernels(t) * log, PI * log, ["|σ0| = σ0"])
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
        (f"m{sign} |α|", far(t, Abs(alpha), c, k), ["σ0 > 0", "|α| ≥ 0"], [_shifted(t.symbols["ω0"], c, k)])
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


# ------------------------------------------------------------------------------------------------ a rational function
def _derive_function(b: ScalarBuilder) -> None:
    t = b.theory
    zero, pole = (t.symbols[k] for k in ("φ", "η"))
    b.say("For the zeros and the poles of f:")
    for root in (zero, pole):
        _derive_family(b, root)
    _derive_sum(b)
    _derive_poles(b)
    _derive_zeros(b)
    b.say("ln|f(s0)| by the same distances:")
    logs = [over(t, Log(to_root(t, RealPart(r), ImaginaryPart(r)))) for r in (zero, pole)]
    b.linked(
        "ln|f(s0)| by its roots",
        Equation(value_at(t), "=", HALF * logs[0] - HALF * logs[1]),
        "modulus",
        "the modulus of a product",
        ["f by its roots"],
    )
    re, im = RealPart(zero), ImaginaryPart(zero)
    lost = over(t, HALF * Log(Quotient(to_root(t, Max(re), im), far(t, Max(re), im, -1))))
    b.say("A zero z in the right half plane contributes ln|(s0 - z)/(s0 + conj z)| to the sum, any other ln 1:")
    known = [
        "Poisson integral of f",
        "ln|f(s0)| by its roots",
        "distances to the poles, summed",
        "before and behind, summed",
    ]
    b.state(
        "Poisson-Jensen formula",
        Equation(poisson(t), "=", value_at(t) - lost),
        "both sides by their roots",
        known,
        number="8",
        source=SOURCE,
    )


def poisson(t: Theory) -> Term:
    """Return (1/π) times the integral of Poisson's kernel and ln|f| over the frequency axis."""
    body = kernel(t) * on_axis(t, t.symbols["f"])
    return Quotient(ONE, PI) * Definite(body, t.symbols["ω"], Neg(Infinity()), Infinity())


def _derive_family(b: ScalarBuilder, root: Symbol) -> None:
    t, re, im, name = b.theory, RealPart(root), ImaginaryPart(root), root.name
    rows: list[Row] = [
        (f"m{sign} {name}", far(t, Abs(re), im, k), ["σ0 > 0", f"|Re {name}| ≥ 0"], [_shifted(t.symbols["ω0"], im, k)])
        for sign, k in SIDES
    ]
    positive(b, rows)
    one = Equation(half(t, integrand(t, re, im)), "=", integral(t, Abs(re), im))
    b.linked(f"Poisson lemma of {name}", one, "instance", "for each root", ["Poisson lemma"])
    low, high = (over(t, Log(far(t, Abs(re), im, k))) for _, k in SIDES)
    b.linked(
        f"conjugates far from {name}",
        Equation(low, "=", high),
        "conjugate",
        "complex roots come in conjugate pairs",
        [],
    )


def _derive_sum(b: ScalarBuilder) -> None:
    """Derive the Poisson integral of ln|f| by the roots of f."""
    t = b.theory
    zero, pole, f = (t.symbols[k] for k in ("φ", "η", "f"))
    log, pair = on_axis(t, f), kernels(t) * _pair(t, zero, pole)
    one, other = (integral(t, Abs(RealPart(r)), ImaginaryPart(r)) for r in (zero, pole))
    both = over(t, one - other)
    b.linked(
        "Poisson integral of a pair",
        Equation(half(t, pair), "=", one - other),
        "linear",
        "a zero less a pole",
        ["Poisson lemma of φ", "Poisson lemma of η"],
    )
    b.linked(
        "Poisson integral of all pairs",
        Equation(half(t, over(t, pair)), "=", both),
        "sum over",
        "summed over the roots",
        ["Poisson integral of a pair"],
    )
    b.linked(
        "Poisson integral of the weighted pairs",
        Equation(half(t, QUARTER * over(t, pair)), "=", QUARTER * both),
        "linear",
        "times a number",
        ["Poisson integral of all pairs"],
    )
    b.state("ln|f|, weighted", Equation(kernels(t) * log, "=", QUARTER * over(t, pair)), "by the roots", ["ln f, even"])
    b.linked(
        "Poisson integral of half the axis",
        Equation(half(t, kernels(t) * log), "=", half(t, QUARTER * over(t, pair))),
        "same argument",
        "the same integrand",
        ["ln|f|, weighted"],
    )
    logs = [over(t, Log(far(t, Abs(RealPart(r)), ImaginaryPart(r), -1))) for r in (zero, pole)]
    known = [
        "Poisson integral of half the axis",
        "Poisson integral of the weighted pairs",
        "conjugates far from φ",
        "conjugates far from η",
    ]
    b.state(
        "Poisson integral of f", Equation(poisson(t), "=", HALF * logs[0] - HALF * logs[1]), "ln|f| is even in ω", known
    )


def _derive_poles(b: ScalarBuilder) -> None:
    t, pole = b.theory, b.theory.symbols["η"]
    re, im = RealPart(pole), ImaginaryPart(pole)
    one, other = far(t, Abs(re), im, -1), to_root(t, re, im)
    b.say("Stable poles are at these distances from s0:")
    b.given("poles are stable")
    positive(b, [("distance of s0 to η", other, ["σ0 > 0", "poles are stable"], [t.symbols["ω0"] - im])])
    b.state("distance to a pole", Equation(one, "=", other), "the pole is stable", ["stable poles"])
    b.linked(
        "distances to the poles",
        Equation(Log(one), "=", Log(other)),
        "same argument",
        "the same number",
        ["distance to a pole"],
    )
    b.linked(
        "distances to the poles, summed",
        Equation(over(t, Log(one)), "=", over(t, Log(other))),
        "sum over",
        "summed over the poles",
        ["distances to the poles"],
    )


def _derive_zeros(b: ScalarBuilder) -> None:
    t, zero = b.theory, b.theory.symbols["φ"]
    re, im = RealPart(zero), ImaginaryPart(zero)
    here, there = to_root(t, re, im), far(t, Abs(re), im, -1)
    before, behind = to_root(t, Max(re), im), far(t, Max(re), im, -1)
    b.say("and those of the zeros are told apart by the sign of the real part, where s0 is no zero:")
    b.given("distance of s0 to φ > 0")
    facts = ["distance of s0 to φ > 0", "behind > 0", "m- φ > 0"]
    positive(b, [("behind", behind, ["σ0 > 0", "max(0,Re φ) ≥ 0"], [t.symbols["ω0"] - im])])
    b.state(
        "distances to a zero", Equation(here * behind, "=", before * there), "max(0, x) is x or 0", ["modulus of φ"]
    )
    b.sign(
        "before > 0",
        Equation(before, ">", ZERO),
        "the other factors are positive",
        facts,
        identities=["distances to a zero"],
    )
    product = Equation(Log(here) + Log(behind), "=", Log(before) + Log(there))
    b.linked("before and behind", product, "logarithms", "the logarithm of a product", ["distances to a zero"])
    b.linked(
        "before and behind, summed",
        Equation(over(t, product.lhs), "=", over(t, product.rhs)),
        "sum over",
        "summed over the zeros",
        ["before and behind"],
    )
