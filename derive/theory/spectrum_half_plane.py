"""The value of a rational function in the right half plane from its modulus on the axis: equation (8) of the source.

Poisson's formula is summed over zeros and poles; s0 = σ0 + jω0 is a point with σ0 > 0.
"""

from __future__ import annotations

from derive.context import Theory
from derive.functions import PI, Abs, Definite, Infinity, Log, Max, Quotient
from derive.spectral import At, ImaginaryPart, Modulus, RealPart, Total
from derive.terms import Equation, Neg, Product, Sum, Symbol, Term
from derive.theory.scalar_builder import ScalarBuilder
from derive.theory.scalar_continuous import ONE, ZERO, square
from derive.theory.spectrum_poisson import Row, far, half, integral, integrand, kernel, kernels, positive
from derive.theory.spectrum_roots import HALF, QUARTER, SIDES, SOURCE, _pair, on_axis, shifted


# ------------------------------------------------------------------------------------------------ declarations
def declare(t: Theory) -> None:
    """Declare the distances of s0 to the zeros and poles of f, and what is integrated."""
    for root in (t.symbols["φ"], t.symbols["η"]):
        _declare_family(t, root)
    _declare_function(t)


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


# ------------------------------------------------------------------------------------------------ equation (8)
def derive(b: ScalarBuilder) -> None:
    """Derive equation (8)."""
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
        (f"m{sign} {name}", far(t, Abs(re), im, k), ["σ0 > 0", f"|Re {name}| ≥ 0"], [shifted(t.symbols["ω0"], im, k)])
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
