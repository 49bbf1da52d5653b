"""The log-integral of one eigenvalue over the unit circle, from Poisson's formula at s0 = 1: Jensen's formula.

With ω = tan(θ/2) the point of the circle is e^{jθ} = (1 + jω)/(1 - jω), dθ = 2/(1 + ω^2) dω, and for λ ≠ -1

    |e^{jθ} - λ|^2 (1 + ω^2) = |1 + λ|^2 |jω - (λ - 1)/(λ + 1)|^2;

the integral over the circle is one in this variable, both half circles together. Eigenvalues on the circle are allowed;
-1 is the image of infinity, and eigenvalues there are numbered apart.
"""

from __future__ import annotations

from collections.abc import Sequence

from derive.context import Theory
from derive.functions import PI, Abs, Exp, Log, Max, Quotient
from derive.spectral import Conjugate, Distance, Growth, ImaginaryPart, RealPart, Total
from derive.terms import Equation, Glyph, Product, Symbol, Term
from derive.theory.scalar_builder import ScalarBuilder
from derive.theory.scalar_continuous import ONE, ZERO, square
from derive.theory.spectrum_poisson import (
    FOUR,
    TWO,
    Row,
    by_antiderivative,
    far,
    integral,
    integrand,
    kernels,
    near,
    positive,
    turns,
)
from derive.theory.spectrum_roots import SIDES, axis, half, shifted

UNIT = ["σ0 = 1", "ω0 = 0"]
PAIRS = "complex roots come in conjugate pairs"


# ------------------------------------------------------------------------------------------------ terms
def parts(root: Symbol) -> tuple[Term, Term]:
    """Return the real and the imaginary part of an eigenvalue."""
    return RealPart(root), ImaginaryPart(root)


def size(root: Symbol) -> Term:
    """Return |1 + λ|^2."""
    a, b = parts(root)
    return square(ONE + a) + square(b)


def excess(root: Symbol) -> Term:
    """Return |λ|^2 - 1."""
    a, b = parts(root)
    return square(a) + square(b) - ONE


def image(t: Theory, root: Symbol) -> tuple[Symbol, Symbol]:
    """Return the real and the imaginary part of (λ - 1)/(λ + 1)."""
    return t.symbols[f"u {root.name}"], t.symbols[f"v {root.name}"]


def point(t: Theory) -> Quotient:
    """Return (1 + jω)/(1 - jω), a point of the circle."""
    return Quotient(ONE + axis(t), ONE - axis(t))


def angle(t: Theory) -> Exp:
    """Return e^{jω}."""
    return Exp(axis(t))


def weight(t: Theory) -> Quotient:
    """Return the derivative of the angle 2 arctan ω."""
    return Quotient(TWO, ONE + square(t.symbols["ω"]))


def both(t: Theory, root: Symbol) -> tuple[Log, Log]:
    """Return ln|z - λ|^2 for a point z of the circle, and the same for the conjugate of λ."""
    return Log(Distance(point(t), root)), Log(Distance(point(t), Conjugate(root)))


def circle(t: Theory, root: Symbol) -> Term:
    """Return what an eigenvalue and its conjugate contribute to the integral over half of the circle."""
    return Product((weight(t), both(t, root)[0] + both(t, root)[1]))


def chord(t: Theory, root: Symbol, side: int) -> Term:
    """Return (1 + ω^2) |z - λ|^2, or the same for the conjugate."""
    (a, b), w = parts(root), t.symbols["ω"]
    return square(shifted(ONE - a, w * b, side)) + square(shifted(w * (ONE + a), b, side))


def constant(t: Theory, number: Term) -> Term:
    """Return a number times the derivative of the angle."""
    return Product((weight(t), number))


def from_plane(t: Theory, a: Term, c: Term) -> Term:
    """Return what a root a + jc of the half plane and its conjugate contribute, less the centre."""
    low, high = (Log(near(t, a, c, k)) for _, k in SIDES)
    return Product((weight(t), low + high - 2 * Log(ONE + square(t.symbols["ω"]))))


def centre(t: Theory) -> Term:
    """Return what the image of 1 contributes to the integral over half of the axis."""
    return integrand(t, t.symbols["σ0"], t.symbols["ω0"])


def centre_integral(t: Theory) -> Term:
    """Return its integral."""
    return integral(t, Abs(t.symbols["σ0"]), t.symbols["ω0"])


def in_plane(t: Theory, a: Term, c: Term) -> Term:
    """Return the integral of that, for a >= 0."""
    return integral(t, a, c) - 2 * PI * Log(FOUR)


# ------------------------------------------------------------------------------------------------ declarations
def declare(t: Theory) -> None:
    """Declare the centre of the circle, and what is integrated for any root."""
    w, sigma, w0, a, c = (t.symbols[k] for k in ("ω", "σ0", "ω0", "α", "β"))
    number = t.parameter("γ", meaning="a number")
    t.assume("σ0 = 1", sigma, "=", ONE, text="the centre of the circle is the image of s0 = 1", case=True)
    t.assume("ω0 = 0", w0, "=", ZERO, text="the centre of the circle is the image of s0 = 1", case=True)
    for sign, k in SIDES:
        t.atom("log", far(t, Abs(sigma), w0, k), f"far centre{sign} > 0", f"ln far centre{sign}")
    below = ONE + square(w)
    t.atom("reciprocal", below, "1+ω^2 > 0", "1/(1+ω^2)")
    t.atom("log", below, "1+ω^2 > 0", "ln(1+ω^2)")
    t.atom("log", FOUR, "4 > 0", "ln 4")
    for name, body in (
        ("the centre", centre(t)), ("the difference", integrand(t, a, c) - centre(t)), ("a root", from_plane(t, a, c)),
        ("a number by the kernel", kernels(t) * number), ("a number", constant(t, number)),
    ):  # fmt: skip
        t.atom("improper", body, name=f"circle integral of {name}")


def over(t: Theory, root: Symbol, body: Term) -> Total:
    """Return the sum over a family."""
    family = t.families[root.name]
    return Total(body, t.symbols[family.index], t.symbols[family.count])


def declare_growth(t: Theory, root: Symbol) -> None:
    """Declare max(0, ln|λ|) of a family, and the sum."""
    name, most = root.name, ONE + Max(excess(root))
    t.atom("part", excess(root), name=f"max(0,|{name}|^2-1)")
    t.atom("log", most, f"max(1,|{name}|^2) > 0", f"ln max(1,|{name}|^2)")
    t.atom("spectral", over(t, root, Log(most)), name=f"sum ln max(1,|{name}|^2)")


def declare_root(t: Theory, root: Symbol) -> None:
    """Declare the image of an eigenvalue other than -1 in the half plane, and its distances from the circle."""
    w, name = t.symbols["ω"], root.name
    t.assume(f"{name} ≠ -1", size(root), ">", text="those at -1 are numbered apart")
    t.atom("reciprocal", size(root), f"{name} ≠ -1", f"1/|1+{name}|^2")
    t.atom("log", size(root), f"{name} ≠ -1", f"ln |1+{name}|^2")
    for letter, top in (("u", excess(root)), ("v", 2 * parts(root)[1])):
        which = "real" if letter == "u" else "imaginary"
        part = t.scalar(
            f"{letter} {name}", Glyph(letter, sub=root.glyph.sub), meaning=f"{which} part of (λ - 1)/(λ + 1)"
        )
        t.define(part.name, part, Quotient(top, size(root)))
    u, v = image(t, root)
    for sign, k in SIDES:
        t.generic(f"image{sign} {name}", shifted(w, v, k), u, w, "except at the image of an eigenvalue on the circle")
        t.atom("log", near(t, u, v, k), f"image{sign} {name}", f"ln image{sign} {name}")
        t.atom("log", far(t, Abs(u), v, k), f"far image{sign} {name} > 0", f"ln far image{sign} {name}")
    t.atom("absolute", u, name=f"|Re image| {name}")
    t.atom("part", u, name=f"max(0,Re image) {name}")
    t.atom("improper", from_plane(t, u, v), name=f"circle integral of the image of {name}")
    t.atom("improper", constant(t, 2 * Log(size(root))), name=f"circle integral of |1+{name}|^2")
    t.atom("improper", scaled_image(t, root), name=f"circle integral of the scaled image of {name}")
    declare_distances(t, root)


def declare_distances(t: Theory, root: Symbol) -> None:
    """Declare the distances of the eigenvalues of a family from the circle, and their integrals."""
    name = root.name
    for sign, k in SIDES:
        u = chord(t, root, k)
        t.atom("log", u, f"chord{sign} {name} > 0", f"ln chord{sign} {name}")
        t.atom("spectral", over(t, root, Log(u)), name=f"sum ln chord{sign} {name}")
    declare_growth(t, root)
    t.atom("improper", circle(t, root), name=f"circle integral of {name}")
    t.atom("improper", over(t, root, circle(t, root)), name=f"circle integral of all {name}")


def scaled_image(t: Theory, root: Symbol) -> Term:
    """Return what the image of an eigenvalue contributes, and the factor |1 + λ|^2."""
    return from_plane(t, *image(t, root)) + constant(t, 2 * Log(size(root)))


# ------------------------------------------------------------------------------------------------ any root
def derive(b: ScalarBuilder) -> None:
    """Derive Poisson's formula at s0 = 1, for any root of the half plane, in the angle of the circle."""
    t = b.theory
    sigma, w0, w, a, c = (t.symbols[k] for k in ("σ0", "ω0", "ω", "α", "β"))
    b.heading("From the half plane to the circle")
    b.say("With ω = tan(θ/2) Poisson's formula at s0 = 1 becomes one on the circle: the point 1 is its centre.")
    b.given(*UNIT)
    far_centre: list[Row] = [
        (f"far centre{sign}", far(t, Abs(sigma), w0, k), ["σ0 > 0", "|σ0| ≥ 0"], [shifted(w0, w0, k)])
        for sign, k in SIDES
    ]
    positive(b, [("1+ω^2", ONE + square(w), [], [w]), ("4", FOUR, [], []), *far_centre])
    for sign, k in SIDES:
        _same(b, f"far centre{sign}", far(t, Abs(sigma), w0, k), FOUR, ["|σ0| = σ0", *UNIT])
        _same(b, f"k{sign} = 1+ω^2", near(t, sigma, w0, k), ONE + square(w), UNIT)
    _derive_constant(b)
    root = integrand(t, a, c)
    b.linked(
        "centre: integral",
        Equation(half(t, centre(t)), "=", centre_integral(t)),
        "instance",
        "for the root 1",
        ["Poisson lemma"],
    )
    b.linked(
        "difference: integral",
        Equation(half(t, root - centre(t)), "=", integral(t, Abs(a), c) - centre_integral(t)),
        "linear",
        "the difference",
        ["Poisson lemma", "centre: integral"],
    )
    known = [f"k{sign} = 1+ω^2, logarithm" for sign in "-+"]
    same_integrand(b, "a root of the half plane", from_plane(t, a, c), root - centre(t), [*known, "Π", *UNIT])
    known = ["a root of the half plane, integral", "difference: integral"]
    known += [f"far centre{sign}, logarithm" for sign in "-+"]
    b.state("half-plane lemma", Equation(half(t, from_plane(t, a, c)), "=", in_plane(t, Abs(a), c)), "s0 = 1", known)


def _same(b: ScalarBuilder, name: str, one: Term, other: Term, using: Sequence[str]) -> None:
    """Derive that two numbers are equal, and so are their logarithms."""
    b.state(name, Equation(one, "=", other), "by their parts", using)
    logs = Equation(Log(one), "=", Log(other))
    b.linked(f"{name}, logarithm", logs, "same argument", "the same number", [name])


def same_integrand(b: ScalarBuilder, name: str, one: Term, other: Term, using: Sequence[str]) -> None:
    """Derive that two integrands are equal, and so are their integrals over half of the axis."""
    b.state(name, Equation(one, "=", other), "by their parts", using)
    halves = Equation(half(b.theory, one), "=", half(b.theory, other))
    b.linked(f"{name}, integral", halves, "same argument", "the same integrand", [name])


def _derive_constant(b: ScalarBuilder) -> None:
    """Derive the integral of a number over half of the circle."""
    t = b.theory
    number = t.symbols["γ"]
    G = Quotient(ONE, t.symbols["σ0"]) * number * turns(t)
    by_antiderivative(b, "number", G, kernels(t) * number, PI * number, ["|σ0| = σ0", "Π"])
    same_integrand(b, "a number", constant(t, number), kernels(t) * number, ["Π", *UNIT])
    known = ["a number, integral", "number: integral"]
    b.state("number lemma", Equation(half(t, constant(t, number)), "=", PI * number), "half of the circle", known)


def derive_number(b: ScalarBuilder, name: str, number: Term) -> None:
    """Derive the integral of one number over half of the circle."""
    one = Equation(half(b.theory, constant(b.theory, number)), "=", Product((PI, number)))
    b.linked(f"number lemma: {name}", one, "instance", "for this number", ["number lemma"])


# ------------------------------------------------------------------------------------------------ Jensen's formula
def derive_root(b: ScalarBuilder, root: Symbol) -> None:
    """Derive the integral of an eigenvalue other than -1 over the circle."""
    t, name = b.theory, root.name
    u, v = image(t, root)
    b.given(f"{name} ≠ -1", f"u {name}", f"v {name}", f"image- {name}", f"image+ {name}")
    _derive_chords(b, root)
    _derive_image(b, root)
    one = Equation(half(t, from_plane(t, u, v)), "=", in_plane(t, Abs(u), v))
    b.linked(f"half-plane lemma of {name}", one, "instance", "for the image", ["half-plane lemma"])
    factor = 2 * Log(size(root))
    derive_number(b, name, factor)
    value = in_plane(t, Abs(u), v) + Product((PI, factor))
    b.linked(
        f"scaled image of {name}",
        Equation(half(t, scaled_image(t, root)), "=", value),
        "linear",
        "the sum",
        [f"half-plane lemma of {name}", f"number lemma: {name}"],
    )
    known = [f"log of chord{sign} {name}" for sign in "-+"]
    same_integrand(b, f"{name} on the circle", circle(t, root), scaled_image(t, root), known)
    known = [f"{name} on the circle, integral", f"scaled image of {name}"]
    known += [f"log of far image{sign} {name}" for sign in "-+"]
    derive_jensen(b, root, known)


def _derive_chords(b: ScalarBuilder, root: Symbol) -> None:
    t, name = b.theory, root.name
    u, v = image(t, root)
    for sign, k in SIDES:
        product = Equation(size(root) * near(t, u, v, k), "=", chord(t, root, k))
        b.state(f"chord{sign} {name}", product, "by their parts", [f"u {name}", f"v {name}"])
        b.sign(
            f"chord{sign} {name} > 0",
            Equation(chord(t, root, k), ">", ZERO),
            "a product",
            [f"{name} ≠ -1", f"image{sign} {name}"],
            identities=[f"chord{sign} {name}"],
        )
        logs = Equation(Log(size(root)) + Log(near(t, u, v, k)), "=", Log(chord(t, root, k)))
        b.linked(f"log of chord{sign} {name}", logs, "logarithms", "of a product", [f"chord{sign} {name}"])


def _derive_image(b: ScalarBuilder, root: Symbol) -> None:
    """Derive |1 + λ|^2 |1 + |Re w| + j Im w|^2 = 4 max(1, |λ|^2) for the image w."""
    t, name, w0 = b.theory, root.name, b.theory.symbols["ω0"]
    u, v = image(t, root)
    facts = [f"{name} ≠ -1"]
    for x in (f"max(0,Re image) {name}", f"max(0,|{name}|^2-1)"):
        facts += [f"{x} ≥ 0", f"{x} ≥ its argument"]
    product = Equation(size(root) * Max(u), "=", Max(excess(root)))
    b.equal(f"positive parts of {name}", product, facts, identities=[f"u {name}"], reason="both are 0 or |λ|² - 1")
    modulus = Equation(Abs(u), "=", 2 * Max(u) - u)
    b.linked(f"modulus of the image of {name}", modulus, "instance", "for this number", ["modulus"])
    rows: list[Row] = [
        (f"far image{sign} {name}", far(t, Abs(u), v, k), ["σ0 > 0", f"|Re image| {name} ≥ 0"], [shifted(w0, v, k)])
        for sign, k in SIDES
    ]
    positive(b, rows)
    derive_growth(b, root)
    for sign, k in SIDES:
        one, most = far(t, Abs(u), v, k), ONE + Max(excess(root))
        known = [f"positive parts of {name}", f"modulus of the image of {name}", f"u {name}", f"v {name}", *UNIT]
        b.state(f"far image{sign} {name}", Equation(size(root) * one, "=", FOUR * most), "by their parts", known)
        logs = Equation(Log(size(root)) + Log(one), "=", Log(FOUR) + Log(most))
        b.linked(f"log of far image{sign} {name}", logs, "logarithms", "of a product", [f"far image{sign} {name}"])


def derive_growth(b: ScalarBuilder, root: Symbol) -> None:
    """Derive that max(1, |λ|^2) is positive."""
    name = root.name
    most = ONE + Max(excess(root))
    positive(b, [(f"max(1,|{name}|^2)", most, [f"max(0,|{name}|^2-1) ≥ 0"], [])], "one, and what is not negative")


def derive_at_minus_one(b: ScalarBuilder, root: Symbol, body: Term) -> None:
    """Derive that what an eigenvalue at -1 contributes is ln 4, less the centre."""
    t, name = b.theory, root.name
    b.given(f"Re {name} = -1", f"Im {name} = 0")
    for sign, k in SIDES:
        where = [f"Re {name} = -1", f"Im {name} = 0"]
        b.state(f"chord{sign} {name}", Equation(chord(t, root, k), "=", FOUR), "by their parts", where)
        b.sign(f"chord{sign} {name} > 0", Equation(chord(t, root, k), ">", ZERO), "it is 4", ["4 > 0"],
               identities=[f"chord{sign} {name}"])  # fmt: skip
        logs = Equation(Log(chord(t, root, k)), "=", Log(FOUR))
        b.linked(f"log of chord{sign} {name}", logs, "same argument", "the same number", [f"chord{sign} {name}"])
    known = [f"log of chord{sign} {name}" for sign in "-+"] + [f"k{sign} = 1+ω^2, logarithm" for sign in "-+"]
    same_integrand(b, f"{name} on the circle", circle(t, root), body, [*known, "Π", *UNIT])


def derive_jensen(b: ScalarBuilder, root: Symbol, using: Sequence[str]) -> None:
    """Derive Jensen's formula for a family, and its sum."""
    t, name = b.theory, root.name
    lemma = Equation(half(t, circle(t, root)), "=", 4 * PI * Growth(root))
    b.state(f"circle lemma of {name}", lemma, "2 max(0, ln|λ|) is ln max(1, |λ|²)", using)
    b.linked(
        f"circle lemma of {name}, summed",
        Equation(half(t, over(t, root, circle(t, root))), "=", over(t, root, 4 * PI * Growth(root))),
        "sum over",
        "summed over the eigenvalues",
        [f"circle lemma of {name}"],
    )
