"""Zeros and poles of the spectrum: theorem 2 of the source, the poles of the open loop, and what (25) should say."""

from __future__ import annotations

from fractions import Fraction

from derive.context import Theory
from derive.derivation import Evidence
from derive.functions import Abs, Log, Max, Quotient
from derive.spectral import At, Det, Modulus, RealPart, Roots, Total
from derive.terms import Equation, Glyph, Identity, Neg, Product
from derive.theory.scalar_continuous import ZERO
from derive.theory.spectrum_builder import SpectrumBuilder
from derive.theory.spectrum_filter import log_spectrum, output_cost, resolvent, spectrum_ratio, unstable
from derive.theory.spectrum_roots import SOURCE, derive_first_term, over_roots, whole


# ------------------------------------------------------------------------------------------------ declarations
def declare(t: Theory) -> None:
    """Declare zeros and poles in lowest terms, of the spectrum and of the open loop."""
    s, i, m = (t.symbols[k] for k in ("s", "i", "m"))
    a = t.symbols["α"]
    t.atom("part", Neg(a), name="max(0,-α)")
    for name in ("λ", "μ"):
        t.atom("part", Neg(RealPart(t.symbols[name])), name=f"max(0,-Re {name})")
        t.atom("spectral", Total(Max(Neg(RealPart(t.symbols[name]))), i, m), name=f"sum max - {name}")
    for index, count, roots in (
        ("j", "n", (("φ'", "φ", "zeros of the spectrum"), ("η'", "η", "poles of the spectrum"))),
        ("k", "r", (("ζ", "ζ", "zeros of det(I + L)"), ("π'", "π", "poles of det(I + L)"))),
        ("q'", "p'", (("κ", "κ", "poles that cancel"),)),
    ):
        letter = index[0] if index != "j" else "j"
        where = t.scalar(f"number {index}", Glyph(letter), meaning="number of a root")
        many = t.scalar(f"count {count}", Glyph(count[0]), meaning="number of roots")
        for name, glyph, meaning in roots:
            root = t.roots(name, where, many, Glyph(glyph, sub=letter), meaning=meaning)
            t.atom("spectral", Roots(s, root, where, many), name=f"product {name}")
            t.atom("reciprocal", Roots(s, root, where, many), f"product {name} ≠ 0", f"1/product {name}")
            t.atom("part", RealPart(root), name=f"max(0,Re {name})")
            t.atom("spectral", Total(Max(RealPart(root)), where, many), name=f"sum max {name}")
    turned = t.roots("ν", i, m, Glyph("ν", sub="i"), meaning="mirror images of the eigenvalues of A")
    t.define("mirror image", RealPart(turned), Neg(RealPart(t.symbols["λ"])), "mirrored at the origin")
    t.atom("spectral", Roots(s, turned, i, m), name="product ν")
    t.atom("part", RealPart(turned), name="max(0,Re ν)")
    t.atom("spectral", Total(Max(RealPart(turned)), i, m), name="sum max ν")
    t.define(
        "lowest terms", spectrum_ratio(t), Quotient(over(t, "φ'"), over(t, "η'")), "zeros and poles in lowest terms"
    )
    L = Identity("l") + t.symbols["L"]
    t.define(
        "lowest terms of det(I + L)", Det(L), Quotient(over(t, "ζ"), over(t, "π'")), "zeros and poles in lowest terms"
    )
    t.assume("zeros of det(I + L)", Neg(RealPart(t.symbols["ζ"])), "≥", text="they are among the eigenvalues of A - KC")
    common = Product((over(t, "η'"), over(t, "κ")))
    t.define("poles with those that cancel", common, Product((over(t, "λ"), over(t, "ν"))), "all that may occur")
    t.atom("spectral", Log(Modulus(At(spectrum_ratio(t), s, s))), name="ln|spectrum(s)|")


def over(t: Theory, name: str) -> Roots:
    """Return the product of (s - root) over a family."""
    return over_roots(t, t.symbols[name], t.symbols["s"])


def positive(t: Theory, name: str) -> Total:
    """Return the sum of the positive real parts of a family."""
    root = t.symbols[name]
    product = over(t, name)
    return Total(Max(RealPart(root)), product.index, product.count)


# ------------------------------------------------------------------------------------------------ derivation
def derive(b: SpectrumBuilder) -> None:
    """Derive theorem 2, the poles of the open loop, and the true form of (25)."""
    _derive_open_loop_poles(b)
    _derive_theorem(b)
    _derive_bound(b)


def _derive_open_loop_poles(b: SpectrumBuilder) -> None:
    t = b.theory
    b.say("The unstable poles of L are the unstable eigenvalues of A: what cancels against the closed loop is stable.")
    b.given("lowest terms of det(I + L)", "zeros of det(I + L)")
    link = Equation(Product((over(t, "ζ"), over(t, "λ"))), "=", Product((over(t, "π'"), over(t, "μ"))))
    b.state(
        "zeros and poles of det(I + L)",
        link,
        "multiply out",
        ["lowest terms of det(I + L)", "det(I + L)", "factor by its roots"],
    )
    sums = Equation(positive(t, "ζ") + positive(t, "λ"), "=", positive(t, "π'") + positive(t, "μ"))
    b.linked(
        "unstable zeros and poles",
        sums,
        "same roots",
        "equal polynomials have equal roots",
        ["zeros and poles of det(I + L)"],
    )
    for name, why in (("ζ", "zeros of det(I + L)"), ("μ", "strong solution")):
        part = Max(RealPart(t.symbols[name]))
        b.equal(
            f"no unstable {name}",
            Equation(part, "=", ZERO),
            [f"max(0,Re {name}) ≥ 0", why],
            reason="it is not positive",
        )
        total = positive(t, name)
        b.linked(
            f"no unstable {name}, summed",
            Equation(total, "=", Total(ZERO, total.index, total.count)),
            "sum over",
            "summed",
            [f"no unstable {name}"],
        )
    b.state(
        "poles of the open loop",
        Equation(positive(t, "π'"), "=", unstable(t)),
        "the stable ones do not count",
        ["unstable zeros and poles", "no unstable ζ, summed", "no unstable μ, summed"],
        number="21",
        source=SOURCE,
    )


def _derive_theorem(b: SpectrumBuilder) -> None:
    t = b.theory
    C, V, W, Phi, s, i, m = (t.symbols[k] for k in ("C", "V", "W", "Phi_y", "s", "i", "m"))
    b.heading("Theorem 2: zeros and poles of the spectrum")
    F, G = resolvent(t), resolvent(t, -1)
    b.state(
        "Popov function over V",
        Equation(Phi * V.inv, "=", C * F * W * G.T * C.T * V.inv + Identity("l")),
        "V is invertible",
        ["Phi_y", "V^-1"],
        number="u16",
        source=SOURCE,
    )
    product = Product((Det(Phi * V.inv), Det(V)))
    b.state(
        "determinant of the quotient",
        Equation(product, "=", Det(Phi)),
        "the determinant of a product",
        ["V^-1"],
        rule="determinant",
    )
    open_loop, closed = t.symbols["λ"], t.symbols["μ"]
    signed = [[(r, 1), (r, -1)] for r in (closed, open_loop)]
    first = derive_first_term(
        b, "spectrum", spectrum_ratio(t), signed[0], signed[1], ZERO, "spectrum by its roots", number="u17"
    )
    b.say("In lowest terms zeros and poles are fewer, and what cancels leaves both sums alike:")
    b.given("lowest terms")
    at_minus = {n: over_roots(t, t.symbols[n], Neg(s)) for n in ("λ", "μ")}
    left = Product((over(t, "φ'"), over(t, "λ"), at_minus["λ"]))
    right = Product((over(t, "η'"), over(t, "μ"), at_minus["μ"]))
    b.state("zeros and poles", Equation(left, "=", right), "multiply out", ["lowest terms", "spectrum by its roots"])
    turned = {n: Total(Max(Neg(RealPart(t.symbols[n]))), i, m) for n in ("λ", "μ")}
    sums = Equation(
        positive(t, "φ'") + positive(t, "λ") + turned["λ"], "=", positive(t, "η'") + positive(t, "μ") + turned["μ"]
    )
    b.linked("sums over zeros and poles", sums, "same roots", "equal polynomials have equal roots", ["zeros and poles"])
    a = t.symbols["α"]
    facts = [f"max(0,{x}) {k}" for x in ("α", "-α") for k in ("≥ 0", "≥ its argument")]
    b.equal("negative part", Equation(Max(Neg(a)), "=", Max(a) - a), facts, reason="one of the two parts is zero")
    b.state("both parts", Equation(Max(a) + Max(Neg(a)), "=", Abs(a)), "both", ["negative part", "modulus"])
    for root in (open_loop, closed):
        re = RealPart(root)
        b.linked(
            f"parts of {root.name}",
            Equation(Max(re) + Max(Neg(re)), "=", Abs(re)),
            "instance",
            "for each eigenvalue",
            ["both parts"],
        )
        b.linked(
            f"parts of {root.name}, summed",
            Equation(Total(Max(re) + Max(Neg(re)), i, m), "=", Total(Abs(re), i, m)),
            "sum over",
            "summed",
            [f"parts of {root.name}"],
        )
    difference = positive(t, "φ'") - positive(t, "η'")
    known = ["sums over zeros and poles", "parts of λ, summed", "parts of μ, summed"]
    b.state(
        "integral by zeros and poles",
        Equation(whole(b, log_spectrum(t)), "=", first + difference),
        "proposition 2 for the spectrum",
        ["log-integral of Phi_y", "first term of spectrum", *known],
        number="u15",
        source=SOURCE,
    )
    b.state(
        "theorem 2", Equation(output_cost(t), "=", difference + 2 * unstable(t)), "theorem 1; the first term is zero",
        ["theorem 1", "integral by zeros and poles", "first term of spectrum"], number="24", source=SOURCE,
    )  # fmt: skip


def _derive_bound(b: SpectrumBuilder) -> None:
    t = b.theory
    i, m, kappa = t.symbols["i"], t.symbols["m"], t.symbols["κ"]
    open_loop, turned = t.symbols["λ"], t.symbols["ν"]
    b.say("The poles of the spectrum are among the eigenvalues of A and their mirror images; some may cancel:")
    b.given("mirror image", "poles with those that cancel")
    product = t.statement("poles with those that cancel")
    b.state("all poles", Equation(product.lhs, "=", product.rhs), "definition", ["poles with those that cancel"])
    sums = Equation(positive(t, "η'") + positive(t, "κ"), "=", positive(t, "λ") + positive(t, "ν"))
    b.linked("sums over all poles", sums, "same roots", "equal polynomials have equal roots", ["all poles"])
    re = RealPart(open_loop)
    facts = [f"max(0,Re {x}) {k}" for x in ("λ", "ν") for k in ("≥ 0", "≥ its argument")]
    image = Equation(Max(RealPart(turned)), "=", Max(re) - re)
    b.equal("mirrored part", image, facts, identities=["mirror image"], reason="one of the two parts is zero")
    mirrored = Equation(Max(re) + Max(RealPart(turned)), "=", Abs(re))
    b.state("eigenvalue and mirror image", mirrored, "both", ["mirrored part", "modulus of λ"])
    b.linked(
        "eigenvalues and mirror images",
        Equation(Total(mirrored.lhs, i, m), "=", Total(mirrored.rhs, i, m)),
        "sum over",
        "summed",
        ["eigenvalue and mirror image"],
    )
    total = positive(t, "κ")
    b.sign("cancelled part", Equation(Max(RealPart(kappa)), "≥", ZERO), "a positive part", ["max(0,Re κ) ≥ 0"])
    b.linked("cancelled parts", Equation(total, "≥", ZERO), "sum over", "summed", ["cancelled part"])
    bound = Equation(Total(Abs(re), i, m), "≥", positive(t, "η'"))
    b.sign("bound on the poles", bound, "the sum over those that cancel is not negative", ["cancelled parts"],
           identities=["sums over all poles", "eigenvalues and mirror images"], alone=True)  # fmt: skip
    printed = Equation(2 * unstable(t), "≥", positive(t, "η'"))
    b.erratum(
        SOURCE, "25", "false", printed,
        "The poles of the determinant of the spectrum are eigenvalues of A or of -A: a stable eigenvalue gives an "
        "unstable pole as well. For A = -1 and C = W = V = 1 the spectrum is (2 - s²)/(1 - s²), with the poles 1 and "
        "-1.",
        evidence=[_evidence(t)], true=bound, proved_by="bound on the poles",
    )  # fmt: skip


def _evidence(t: Theory) -> Evidence:
    """Evaluate both sides of (25) for one state, exactly."""
    A, C, W, V = Fraction(-1), Fraction(1), Fraction(1), Fraction(1)
    poles = sorted({A, -A}) if C * W * C != 0 else []
    left, right = sum(max(Fraction(0), p) for p in poles), 2 * max(Fraction(0), A)
    if left <= right:
        raise ValueError("the instance does not refute (25)")
    values = tuple((t.symbols[k], str(v)) for k, v in (("A", A), ("C", C), ("W", W), ("V", V)))
    return Evidence(values, (("left-hand side of (25)", str(left)), ("its right-hand side", str(right))))
