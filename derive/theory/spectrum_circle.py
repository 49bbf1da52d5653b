"""The log-integral of one eigenvalue over the unit circle, from Poisson's formula at s0 = 1: Jensen's formula.

With ω = tan(θ/2) the point of the circle is e^{jθ} = (1 + jω)/(1 - jω), dθ = 2/(1 + ω^2) dω, and

    |e^{jθ} - λ|^2 = (((1 - Re λ) - ω Im λ)^2 + (ω (1 + Re λ) - Im λ)^2) / (1 + ω^2);

the integral over the circle is meant in this variable, both half circles together. Eigenvalues on the circle are
allowed, -1 is not: it is the image of infinity.
"""

from __future__ import annotations

from functools import cache

from derive.context import Theory
from derive.derivation import Lecture
from derive.functions import PI, Abs, Log, Max, Quotient
from derive.spectral import ImaginaryPart, RealPart
from derive.terms import Equation, Glyph, Symbol, Term
from derive.theory import spectrum_poisson, spectrum_roots
from derive.theory.scalar_builder import ScalarBuilder
from derive.theory.scalar_continuous import ONE, ZERO, square
from derive.theory.spectrum_builder import SpectrumBuilder
from derive.theory.spectrum_poisson import (
    FOUR,
    TWO,
    by_antiderivative,
    far,
    integral,
    integrand,
    kernels,
    near,
    positive,
    turns,
)
from derive.theory.spectrum_roots import SIDES, half, shifted

KEY, THEORY = "spectrum-dt", "spectrum-dt"
UNIT = ["σ0 = 1", "ω0 = 0"]


@cache
def theory() -> Theory:
    """Return the theory ``spectrum-dt``: one root, Poisson's formula, and the eigenvalues of a plant."""
    t = Theory(THEORY, "Frequency domain in discrete time")
    for part in (spectrum_roots, spectrum_poisson):
        part.declare(t)
    index, count = t.symbols["i"], t.symbols["m"]
    t.roots("λ", index, count, Glyph("λ", sub="i"), of="A", meaning="eigenvalues of A")
    declare(t)
    return t


@cache
def lecture() -> Lecture:
    """Return the lecture from one root on the axis to an eigenvalue and the circle, every step proved."""
    b = SpectrumBuilder(theory(), KEY, "Eigenvalues and the unit circle", ("001",))
    for part in (spectrum_roots, spectrum_poisson):
        part.derive(b)
    derive(b)
    return b.lecture()


# ------------------------------------------------------------------------------------------------ terms
def parts(t: Theory) -> tuple[Term, Term]:
    """Return the real and the imaginary part of an eigenvalue."""
    return RealPart(t.symbols["λ"]), ImaginaryPart(t.symbols["λ"])


def size(t: Theory) -> Term:
    """Return |1 + λ|^2."""
    a, b = parts(t)
    return square(ONE + a) + square(b)


def excess(t: Theory) -> Term:
    """Return |λ|^2 - 1."""
    a, b = parts(t)
    return square(a) + square(b) - ONE


def image(t: Theory) -> tuple[Symbol, Symbol]:
    """Return the real and the imaginary part of (λ - 1)/(λ + 1)."""
    return t.symbols["u"], t.symbols["v"]


def chord(t: Theory, side: int) -> Term:
    """Return (1 + ω^2) |e^{jθ} - λ|^2, or the same for the conjugate."""
    (a, b), w = parts(t), t.symbols["ω"]
    return square(shifted(ONE - a, w * b, side)) + square(shifted(w * (ONE + a), b, side))


def circle(t: Theory) -> Term:
    """Return what an eigenvalue and its conjugate contribute to the integral over half of the circle."""
    below = ONE + square(t.symbols["ω"])
    low, high = (Log(Quotient(chord(t, k), below)) for _, k in SIDES)
    return Quotient(TWO, below) * (low + high)


# ------------------------------------------------------------------------------------------------ declarations
def declare(t: Theory) -> None:
    """Declare the image of an eigenvalue in the half plane, and its distances from the circle."""
    w, sigma, w0 = (t.symbols[k] for k in ("ω", "σ0", "ω0"))
    t.assume("σ0 = 1", sigma, "=", ONE, text="the centre of the circle is the image of s0 = 1", case=True)
    t.assume("ω0 = 0", w0, "=", ZERO, text="the centre of the circle is the image of s0 = 1", case=True)
    t.assume("no eigenvalue at -1", size(t), ">", text="-1 is no eigenvalue", case=True)
    t.atom("reciprocal", size(t), "no eigenvalue at -1", "1/|1+λ|^2")
    t.atom("log", size(t), "no eigenvalue at -1", "ln |1+λ|^2")
    for name, top in (("u", excess(t)), ("v", 2 * parts(t)[1])):
        part = t.scalar(name, meaning=f"{'real' if name == 'u' else 'imaginary'} part of (λ - 1)/(λ + 1)")
        t.define(name, part, Quotient(top, size(t)))
    (u, v), below = image(t), ONE + square(w)
    for sign, k in SIDES:
        t.generic(f"image{sign}", shifted(w, v, k), u, w, "except at the image of an eigenvalue on the circle")
        t.atom("log", near(t, u, v, k), f"image{sign}", f"ln image{sign}")
        t.atom("log", far(t, Abs(u), v, k), f"far image{sign} > 0", f"ln far image{sign}")
        t.atom("log", far(t, Abs(sigma), w0, k), f"far centre{sign} > 0", f"ln far centre{sign}")
        t.atom("log", chord(t, k), f"chord{sign} > 0", f"ln chord{sign}")
    t.atom("absolute", u, name="|Re image|")
    t.atom("part", u, name="max(0,Re image)")
    t.atom("part", excess(t), name="max(0,|λ|^2-1)")
    t.atom("reciprocal", below, "1+ω^2 > 0", "1/(1+ω^2)")
    t.atom("log", below, "1+ω^2 > 0", "ln(1+ω^2)")
    t.atom("log", FOUR, "4 > 0", "ln 4")
    t.atom("log", ONE + Max(excess(t)), "max(1,|λ|^2) > 0", "ln max(1,|λ|^2)")
    for name, body in bodies(t).items():
        t.atom("improper", body, name=f"circle: {name}")


def bodies(t: Theory) -> dict[str, Term]:
    """Return the integrands."""
    (u, v), log = image(t), 2 * Log(size(t))
    logs = [Log(near(t, u, v, k)) for _, k in SIDES]
    centre = integrand(t, t.symbols["σ0"], t.symbols["ω0"])
    both = kernels(t) * (logs[0] + logs[1] + log)
    return {
        "image": integrand(t, u, v), "size": kernels(t) * log, "both": both, "centre": centre,
        "rest": both - centre, "eigenvalue": circle(t),
    }  # fmt: skip


# ------------------------------------------------------------------------------------------------ Jensen's formula
def derive(b: ScalarBuilder) -> None:
    """Derive the integral of one eigenvalue over the circle."""
    b.heading("The log-integral of an eigenvalue over the unit circle")
    b.say("With ω = tan(θ/2) Poisson's formula at s0 = 1 becomes one on the circle; let")
    b.given(*UNIT, "no eigenvalue at -1", "u", "v", "image-", "image+")
    _derive_distances(b)
    _derive_integrals(b)
    _derive_size(b)
    _derive_lemma(b)


def _derive_distances(b: ScalarBuilder) -> None:
    t = b.theory
    (u, v), w, w0 = image(t), t.symbols["ω"], t.symbols["ω0"]
    rows = [("1+ω^2", ONE + square(w), [], [w]), ("4", FOUR, [], [])]
    rows += [
        (f"far image{sign}", far(t, Abs(u), v, k), ["σ0 > 0", "|Re image| ≥ 0"], [shifted(w0, v, k)])
        for sign, k in SIDES
    ]
    rows += [
        (f"far centre{sign}", far(t, Abs(t.symbols["σ0"]), w0, k), ["σ0 > 0", "|σ0| ≥ 0"], [shifted(w0, w0, k)])
        for sign, k in SIDES
    ]
    rows += [("max(1,|λ|^2)", ONE + Max(excess(t)), ["max(0,|λ|^2-1) ≥ 0"], [])]
    positive(b, rows, "a sum of squares, or of what is not negative")
    for sign, k in SIDES:
        b.state(f"chord{sign}", Equation(size(t) * near(t, u, v, k), "=", chord(t, k)), "by their parts")
        b.sign(
            f"chord{sign} > 0",
            Equation(chord(t, k), ">", ZERO),
            "a product",
            ["no eigenvalue at -1", f"image{sign}"],
            identities=[f"chord{sign}"],
        )
        logs = Equation(Log(size(t)) + Log(near(t, u, v, k)), "=", Log(chord(t, k)))
        b.linked(f"log of chord{sign}", logs, "logarithms", "the logarithm of a product", [f"chord{sign}"])


def _derive_integrals(b: ScalarBuilder) -> None:
    t = b.theory
    (u, v), sigma, w0, found = image(t), t.symbols["σ0"], t.symbols["ω0"], bodies(t)
    log = 2 * Log(size(t))
    b.linked(
        "image: integral",
        Equation(half(t, found["image"]), "=", integral(t, Abs(u), v)),
        "instance",
        "for this root",
        ["Poisson lemma"],
    )
    G = Quotient(ONE, sigma) * log * turns(t)
    by_antiderivative(b, "size", G, found["size"], PI * log, ["|σ0| = σ0", "Π"])
    b.linked(
        "both: integral",
        Equation(half(t, found["both"]), "=", integral(t, Abs(u), v) + PI * log),
        "linear",
        "the sum",
        ["image: integral", "size: integral"],
    )
    centre = integral(t, Abs(sigma), w0)
    b.linked(
        "centre: integral",
        Equation(half(t, found["centre"]), "=", centre),
        "instance",
        "for the root 1",
        ["Poisson lemma"],
    )
    value = integral(t, Abs(u), v) + PI * log - centre
    b.linked(
        "rest: integral",
        Equation(half(t, found["rest"]), "=", value),
        "linear",
        "the difference",
        ["both: integral", "centre: integral"],
    )


def _derive_size(b: ScalarBuilder) -> None:
    """Derive |1 + λ|^2 |1 + |Re w| + j Im w|^2 = 4 max(1, |λ|^2) for the image w."""
    t = b.theory
    u, v = image(t)
    b.say("The image of an eigenvalue is in the right half plane where the eigenvalue is outside the circle:")
    facts = [
        "no eigenvalue at -1",
        "max(0,Re image) ≥ 0",
        "max(0,|λ|^2-1) ≥ 0",
        "max(0,Re image) ≥ its argument",
        "max(0,|λ|^2-1) ≥ its argument",
    ]
    b.equal("positive parts", Equation(size(t) * Max(u), "=", Max(excess(t))), facts, reason="both are 0 or |λ|² - 1")
    b.linked("modulus of the image", Equation(Abs(u), "=", 2 * Max(u) - u), "instance", "for this number", ["modulus"])
    for sign, k in SIDES:
        product = Equation(size(t) * far(t, Abs(u), v, k), "=", FOUR * (ONE + Max(excess(t))))
        b.state(f"far image{sign}", product, "by their parts", ["positive parts", "modulus of the image", *UNIT])
        logs = Equation(Log(size(t)) + Log(far(t, Abs(u), v, k)), "=", Log(FOUR) + Log(ONE + Max(excess(t))))
        b.linked(f"log of far image{sign}", logs, "logarithms", "the logarithm of a product", [f"far image{sign}"])


def _derive_lemma(b: ScalarBuilder) -> None:
    t = b.theory
    sigma, w0, w = (t.symbols[k] for k in ("σ0", "ω0", "ω"))
    for sign, k in SIDES:
        centre, k_side = far(t, Abs(sigma), w0, k), near(t, sigma, w0, k)
        b.state(f"far centre{sign}", Equation(centre, "=", FOUR), "s0 = 1", ["|σ0| = σ0", *UNIT])
        b.linked(
            f"log of far centre{sign}",
            Equation(Log(centre), "=", Log(FOUR)),
            "same argument",
            "the same number",
            [f"far centre{sign}"],
        )
        b.state(f"k{sign} = 1+ω^2", Equation(k_side, "=", ONE + square(w)), "s0 = 1", UNIT)
        b.linked(
            f"ln k{sign} = ln(1+ω^2)",
            Equation(Log(k_side), "=", Log(ONE + square(w))),
            "same argument",
            "the same number",
            [f"k{sign} = 1+ω^2"],
        )
    known = [f"{name}{sign}" + tail for sign in "-+" for name, tail in (("log of chord", ""), ("ln k", " = ln(1+ω^2)"))]
    b.state("on the circle", Equation(circle(t), "=", bodies(t)["rest"]), "the distances", [*known, *UNIT])
    b.linked(
        "the circle",
        Equation(half(t, circle(t)), "=", half(t, bodies(t)["rest"])),
        "same argument",
        "the same integrand",
        ["on the circle"],
    )
    b.say("Jensen's formula for one eigenvalue and its conjugate, over half of the circle:")
    value = 2 * PI * Log(ONE + Max(excess(t)))
    known = [
        "the circle",
        "rest: integral",
        *(f"{name}{sign}" for sign in "-+" for name in ("log of far image", "log of far centre")),
    ]
    b.state("circle lemma", Equation(half(t, circle(t)), "=", value), "1 + max(0, |λ|² - 1) is max(1, |λ|²)", known)
