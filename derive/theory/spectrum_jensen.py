"""The log-integral of a rational function by its zeros and poles: propositions 1 and 2 of the source."""

from __future__ import annotations

from dataclasses import replace

from derive.context import Theory
from derive.functions import Abs, Infinity, Limit, Log, Max, Quotient
from derive.spectral import At, ImaginaryPart, Modulus, RealPart, Roots, Total
from derive.terms import Equation, Glyph, Neg, Symbol
from derive.theory.scalar_builder import ScalarBuilder
from derive.theory.scalar_continuous import ONE
from derive.theory.spectrum_roots import (
    HALF,
    SOURCE,
    declare_family,
    declare_integrals,
    derive_family,
    derive_first_term,
    derive_integral,
    derive_root,
    on_axis,
    root_integrand,
    whole,
)


def declare(t: Theory) -> None:
    """Declare a function by its zeros and poles."""
    i, m, s = (t.symbols[k] for k in ("i", "m", "s"))
    zero, pole = (t.roots(n, i, m, Glyph(n, sub="i"), meaning=f"{w} of f") for n, w in (("φ", "zeros"), ("η", "poles")))
    for root in (zero, pole):
        declare_family(t, root, 1)
        t.atom(
            "improper",
            root_integrand(t.symbols["ω"], RealPart(root), ImaginaryPart(root)),
            name=f"integral of {root.name}",
        )
    p, q, f = (_function(t, n, w) for n, w in (("p", "numerator"), ("q", "denominator"), ("f", "transfer function")))
    t.define("p", p, Roots(s, zero, i, m), "monic, with its zeros")
    t.define("q", q, Roots(s, pole, i, m), "monic of the same order, with the poles")
    t.define("f", f, Quotient(p, q))
    t.assume("f tends to 1", Limit(f, s, Infinity()), "=", ONE, text="both polynomials are monic")
    declare_integrals(t, "f", on_axis(t, f), zero, pole)
    t.atom("spectral", Log(Modulus(At(f, s, s))), name="ln|f(s)|")
    t.assume("poles are stable", Neg(RealPart(pole)), ">", text="all poles of f are stable", case=True)


def _function(t: Theory, name: str, meaning: str) -> Symbol:
    t.scalar(name, meaning=meaning)
    t.symbols[name] = replace(t.symbols[name], show_args=("s",))
    return t.symbols[name]


def derive(b: ScalarBuilder) -> None:
    """Derive propositions 1 and 2."""
    t = b.theory
    f, s, zero, pole, i, m = (t.symbols[k] for k in ("f", "s", "φ", "η", "i", "m"))
    b.heading("A counterpart of Jensen's formula")
    b.say("Let f have numerator and denominator of the same order, with real coefficients, and let it tend to 1:")
    b.given("p", "q", "f", "f tends to 1", numbers=("", "", "5", "6"), source=SOURCE)
    b.state(
        "f by its roots",
        Equation(f, "=", Quotient(Roots(s, zero, i, m), Roots(s, pole, i, m))),
        "both definitions",
        ["f", "p", "q"],
    )
    for root in (zero, pole):
        derive_root(b, root)
        derive_family(b, root, reals=1)
    derive_integral(b, "f", on_axis(t, f), zero, pole, "f by its roots")
    b.say("Along the reals the same modulus gives the first term of the formula:")
    limit = HALF * Total(RealPart(pole), i, m) - HALF * Total(RealPart(zero), i, m)
    first = derive_first_term(b, "f", f, [(zero, 1)], [(pole, 1)], limit, "f by its roots")
    b.say("Proposition 1, for stable poles; zeros on the imaginary axis are allowed:")
    b.given("poles are stable")
    stable = Equation(Abs(RealPart(pole)), "=", Neg(RealPart(pole)))
    b.equal("stable poles", stable, [f"|Re {pole.name}| ≥ 0", "poles are stable"], reason="the real part is negative")
    b.linked(
        "stable poles, summed",
        Equation(Total(stable.lhs, i, m), "=", Total(stable.rhs, i, m)),
        "sum over",
        "summed over the poles",
        ["stable poles"],
    )
    integral, zeros, poles = whole(b, on_axis(t, f)), Total(Max(RealPart(zero)), i, m), Total(Max(RealPart(pole)), i, m)
    known = ["log-integral of f", "first term of f", "modulus of φ, summed"]
    b.state(
        "proposition 1", Equation(integral, "=", first + zeros), "|x| = 2 max(0, x) - x, summed over the zeros",
        [*known, "stable poles, summed"], number="7", source=SOURCE,
    )  # fmt: skip
    b.say("Proposition 2, for any poles:")
    b.given("f", "f tends to 1", numbers=("9", "10"), source=SOURCE)
    b.state(
        "proposition 2", Equation(integral, "=", first + zeros - poles), "|x| = 2 max(0, x) - x, for zeros and poles",
        [*known, "modulus of η, summed"], number="11", source=SOURCE,
    )  # fmt: skip
