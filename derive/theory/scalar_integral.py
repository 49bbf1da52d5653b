"""The log-integral of the scalar estimator, corollary 2 of the source: an antiderivative and its limits."""

from __future__ import annotations

from derive.context import Theory
from derive.functions import PI, Abs, Arctan, Definite, Infinity, Limit, Log, Max, Quotient, Rate
from derive.terms import Equation, Glyph, Neg, Term
from derive.theory.scalar_builder import ScalarBuilder
from derive.theory.scalar_continuous import ONE, ZERO, square

SOURCE = "001"


def declare(t: Theory) -> None:
    """Declare the frequency, the integrand and its antiderivatives."""
    A, W, g, S = (t.symbols[k] for k in ("A", "W", "g", "S"))
    pi = t.symbols["π"] = PI
    t.assume("π > 0", pi, ">", text="the circle's number is positive")
    t.atom("reciprocal", pi, "π > 0", "1/π")
    w = t.scalar("ω", meaning="frequency")
    t.assume("ω > 0", w, ">", text="half of the axis is enough, the integrand is even")
    t.atom("reciprocal", w, "ω > 0", "1/ω")
    t.assume("A ≠ 0", A, "≠", text="the state moves by itself", case=True)
    t.atom("reciprocal", Abs(A), "|A| > 0", "1/|A|")
    for name, x, why in (("S", S, "S^2 > 0"), ("|A|", A, "A^2 > 0")):
        t.atom("reciprocal", square(w) + square(x), f"ω^2 + {name}^2 > 0", f"1/(ω^2+{name}^2)")
        t.atom("log", square(w) + square(x), f"ω^2 + {name}^2 > 0", f"ln(ω^2+{name}^2)")
        t.atom("log", square(x), why, f"ln {name}^2")
    t.atom("log", square(w), "ω^2 > 0", "ln ω^2")
    for name, x in (("S", S), ("|A|", Abs(A))):
        t.atom("arctan", Quotient(w, x), name=f"arctan ω/{name}")
        t.atom("reciprocal", ONE + square(Quotient(w, x)), f"1 + (ω/{name})^2 > 0", f"1/(1+(ω/{name})^2)")
    ratio, bare = t.scalar("ℓ", meaning="integrand"), t.scalar("ℓ0", Glyph("ℓ", sub="0"), meaning="integrand for A = 0")
    t.define("ℓ", ratio, Log(Quotient(square(w) + square(S), square(w) + square(A))))
    t.define("ℓ0", bare, Log(Quotient(square(w) + square(S), square(w))))
    t.atom("log", spectrum(A, W, g, w), "spectrum > 0", "ln of the spectrum")
    for name, integrand in (("ℓ", ratio), ("ℓ0", bare), ("ln of the spectrum", Log(spectrum(A, W, g, w)))):
        t.atom("improper", integrand, name=f"integral of {name}")
    _declare_unit(t)


def _declare_unit(t: Theory) -> None:
    """Declare the case of unit measurement noise and process noise of intensity ε^2."""
    A, C, V, W, w = (t.symbols[k] for k in ("A", "C", "V", "W", "ω"))
    epsilon = t.scalar("ε", Glyph("ε"), meaning="square root of the intensity of the process noise")
    t.assume("V = 1", V, "=", ONE, text="unit intensity of the measurement noise", case=True)
    t.assume("W = ε^2", W, "=", square(epsilon), text="intensity of the process noise", case=True)
    t.atom("log", _unit_spectrum(A, C, epsilon, w), "unit spectrum > 0", "ln of the unit spectrum")
    t.atom("improper", Log(_unit_spectrum(A, C, epsilon, w)), name="integral of ln of the unit spectrum")


def _unit_spectrum(A: Term, C: Term, epsilon: Term, w: Term) -> Term:
    """Return ε^2 C^2 |1/(jω - A)|^2 + 1."""
    return square(epsilon) * square(C) * Quotient(ONE, square(w) + square(A)) + ONE


def spectrum(A: Term, W: Term, g: Term, w: Term) -> Term:
    """Return the output spectrum over the noise intensity, 1 + g W/(ω^2 + A^2)."""
    return ONE + Quotient(g * W, square(w) + square(A))


def derive(b: ScalarBuilder) -> None:
    """Derive corollary 2."""
    _derive_signs(b)
    _derive_general(b)
    _derive_unit(b, "")
    _derive_integrator(b)
    _derive_silence(b)


def _derive_signs(b: ScalarBuilder) -> None:
    s = b.theory.symbols
    A, W, g, S, w = (s[k] for k in ("A", "W", "g", "S", "ω"))
    b.heading("The covariance as an integral over frequency")
    b.say("The output spectrum, divided by the intensity of the sensor noise, is a quotient of squares:")
    b.given("ω > 0")
    b.sign("ω^2 > 0", Equation(square(w), ">", ZERO), "a square", ["ω > 0"])
    for name, x in (("S", S), ("|A|", A)):
        b.sign(f"ω^2 + {name}^2 > 0", Equation(square(w) + square(x), ">", ZERO), "squares", ["ω > 0"], squares=[x])
    b.state(
        "spectral factor",
        Equation(spectrum(A, W, g, w), "=", Quotient(square(w) + square(S), square(w) + square(A))),
        "S^2 = A^2 + g W",
    )
    for name, x in (("S", S), ("|A|", A)):
        b.sign(
            f"1/(ω^2+{name}^2) > 0", Equation(Quotient(ONE, square(w) + square(x)), ">", ZERO),
            "a reciprocal has the sign of its number", [f"ω^2 + {name}^2 > 0"],
        )  # fmt: skip
    b.sign(
        "spectrum > 0", Equation(spectrum(A, W, g, w), ">", ZERO), "one plus a nonnegative number",
        ["g >= 0", "W >= 0", "1/(ω^2+|A|^2) > 0"],
    )  # fmt: skip
    b.sign("1/ω > 0", Equation(Quotient(ONE, w), ">", ZERO), "a reciprocal has the sign of its number", ["ω > 0"])
    b.sign("S^2 > 0", Equation(square(S), ">", ZERO), "a square", ["S > 0"])
    b.sign("1/S > 0", Equation(Quotient(ONE, S), ">", ZERO), "a reciprocal has the sign of its number", ["S > 0"])
    b.sign(
        "1 + (ω/S)^2 > 0", Equation(ONE + square(Quotient(w, S)), ">", ZERO), "one plus a square", [],
        squares=[Quotient(w, S)],
    )  # fmt: skip


def _antiderivative(w: Term, S: Term, ratio: Term, other: Term | None = None) -> Term:
    first = w * ratio + 2 * S * Arctan(Quotient(w, S))
    return first if other is None else first - 2 * other * Arctan(Quotient(w, other))


def _derive_general(b: ScalarBuilder) -> None:
    s = b.theory.symbols
    A, S, w, ratio = (s[k] for k in ("A", "S", "ω", "ℓ"))
    b.say("First let the state move by itself.")
    b.given("A ≠ 0")
    b.sign("S is positive", Equation(S, ">", ZERO), "S^2 is at least A^2", ["A ≠ 0", "S >= 0", "g >= 0", "W >= 0"])
    b.sign(
        "|A| > 0", Equation(Abs(A), ">", ZERO), "it is nonnegative, and its square is positive", ["|A| ≥ 0", "A ≠ 0"]
    )
    b.sign("A^2 > 0", Equation(square(A), ">", ZERO), "a square", ["A ≠ 0"])
    b.sign("1/|A| > 0", Equation(Quotient(ONE, Abs(A)), ">", ZERO), "as before", ["|A| > 0"])
    b.sign(
        "1 + (ω/|A|)^2 > 0", Equation(ONE + square(Quotient(w, Abs(A))), ">", ZERO), "one plus a square", [],
        squares=[Quotient(w, Abs(A))],
    )  # fmt: skip
    b.given("ℓ")
    G = _antiderivative(w, S, ratio, Abs(A))
    b.state("antiderivative", Equation(Rate(G, w), "=", ratio), "differentiate")
    b.say("At infinity the first term vanishes, because ln x is at most x - 1:")
    _derive_bounds(b, "", ratio)
    b.state(
        "antiderivative at infinity", Equation(Limit(G, w, Infinity()), "=", PI * S - PI * Abs(A)),
        "arctan tends to π/2", ["limit of the first term"],
    )  # fmt: skip
    b.state("antiderivative at zero", Equation(Limit(G, w, ZERO), "=", ZERO), "every term vanishes")
    half = Definite(ratio, w, ZERO, Infinity())
    b.linked(
        "root lemma", Equation(half, "=", PI * S - PI * Abs(A)), "integral", "the difference of the limits",
        ["antiderivative", "antiderivative at infinity", "antiderivative at zero"],
    )  # fmt: skip
    factor = Quotient(square(w) + square(S), square(w) + square(A))
    _derive_corollary(b, "", ratio, factor, "spectral factor", [])


def _derive_bounds(b: ScalarBuilder, tail: str, ratio: Term) -> None:
    s = b.theory.symbols
    W, g, w = (s[k] for k in ("W", "g", "ω"))
    bound, case = Quotient(g * W, w), ["A = 0"] if tail else []
    log = "ln ω^2" if tail else "ln(ω^2+|A|^2)"
    pos = ["1/ω > 0"] if tail else ["1/(ω^2+|A|^2) > 0"]
    b.sign(
        "integrand >= 0" + tail, Equation(ratio, "≥", ZERO), "the spectrum is at least one",
        [f"{log} - ln(ω^2+S^2) ≤", "1/(ω^2+S^2) > 0", "g >= 0", "W >= 0"], identities=case,
    )  # fmt: skip
    b.sign(
        "integrand at most" + tail, Equation(Quotient(g * W, square(w)), "≥", ratio), "ln x is at most x - 1",
        [f"ln(ω^2+S^2) - {log} ≤", *pos, "1/ω > 0", "g >= 0", "W >= 0"], identities=case,
        squares=[s["A"] * Quotient(ONE, w)],
        degree=4 if not tail else 3,
    )  # fmt: skip
    b.sign(
        "above" + tail, Equation(bound, "≥", w * ratio), "times the frequency", ["integrand at most" + tail, "ω > 0"],
    )  # fmt: skip
    b.sign(
        "below" + tail, Equation(bound, "≥", -(w * ratio)), "the frequency and the integrand are not negative",
        ["integrand >= 0" + tail, "ω > 0", "g >= 0", "W >= 0", "1/ω > 0"],
    )  # fmt: skip
    b.linked(
        "limit of the first term" + tail, Equation(Limit(w * ratio, w, Infinity()), "=", ZERO), "squeeze",
        "between bounds that vanish", ["above" + tail, "below" + tail],
    )  # fmt: skip


def _derive_corollary(b: ScalarBuilder, tail: str, ratio: Term, factor: Term, link: str, case: list[str]) -> None:
    s = b.theory.symbols
    A, C, V, W, g, S, P, w = (s[k] for k in ("A", "C", "V", "W", "g", "S", "P", "ω"))
    body = Log(spectrum(A, W, g, w))
    b.linked("logarithm" + tail, Equation(body, "=", Log(factor)), "same argument", "the spectral factor", [link])
    b.state("integrand" + tail, Equation(body, "=", ratio), "the same", ["logarithm" + tail])
    b.linked(
        "half the integral" + tail,
        Equation(Definite(body, w, ZERO, Infinity()), "=", Definite(ratio, w, ZERO, Infinity())),
        "same argument", "the same integrand", ["integrand" + tail],
    )  # fmt: skip
    whole = Quotient(ONE, 2 * PI) * Definite(body, w, Neg(Infinity()), Infinity())
    known = ["half the integral" + tail, "root lemma" + tail]
    b.state("integral" + tail, Equation(whole, "=", S - Abs(A)), "the integrand is even", [*known, *case])
    b.state(
        "corollary 2" + tail, Equation(P, "=", Quotient(V, square(C)) * (whole + 2 * Max(A))),
        "|A| is 2 max(0, A) - A, and P the stabilising root", ["|A| by the maximum", "integral" + tail],
        number="31", source=SOURCE,
    )  # fmt: skip


def _derive_unit(b: ScalarBuilder, tail: str) -> None:
    s = b.theory.symbols
    A, C, W, g, P, epsilon, w = (s[k] for k in ("A", "C", "W", "g", "P", "ε", "ω"))
    unit, body = _unit_spectrum(A, C, epsilon, w), spectrum(A, W, g, w)
    b.say("With unit measurement noise, and ", W, " = ", square(epsilon), ", this is a formula for the output's error:")
    b.given("V = 1", "W = ε^2")
    b.state("unit spectrum", Equation(unit, "=", body), "the intensities", ["V = 1", "W = ε^2"])
    b.sign("unit spectrum > 0", Equation(unit, ">", ZERO), "one plus squares", ["1/(ω^2+|A|^2) > 0"],
           squares=[epsilon * C])  # fmt: skip
    b.linked("unit logarithm", Equation(Log(unit), "=", Log(body)), "same argument", "the same", ["unit spectrum"])
    halves = [Definite(Log(f), w, ZERO, Infinity()) for f in (unit, body)]
    b.linked("half the unit integral", Equation(halves[0], "=", halves[1]), "same argument", "the same integrand",
             ["unit logarithm"])  # fmt: skip
    whole = Quotient(ONE, 2 * PI) * Definite(Log(unit), w, Neg(Infinity()), Infinity())
    b.state(
        "unit corollary 2" + tail, Equation(square(C) * P, "=", whole + 2 * Max(A)), "corollary 2 with V = 1",
        ["corollary 2" + tail, "half the unit integral", "V = 1"], number="35", source=SOURCE,
    )  # fmt: skip


def _derive_integrator(b: ScalarBuilder) -> None:
    s = b.theory.symbols
    A, W, g, S, w, ratio = (s[k] for k in ("A", "W", "g", "S", "ω", "ℓ0"))
    tail = " of an integrator"
    b.say("An integrator has its singularity on the axis; the integral exists all the same.")
    b.given("ℓ0")
    factor = Quotient(square(w) + square(S), square(w))
    b.equal(
        "no maximum", Equation(Max(A), "=", ZERO), ["max(0,A) ≥ 0"], identities=["A = 0"], reason="its square is zero"
    )
    b.state("no modulus", Equation(Abs(A), "=", ZERO), "2 max(0, A) - A", ["|A| by the maximum", "no maximum", "A = 0"])
    b.state("spectral factor" + tail, Equation(spectrum(A, W, g, w), "=", factor), "S^2 = g W", ["A = 0"])
    G = _antiderivative(w, S, ratio)
    b.state("antiderivative" + tail, Equation(Rate(G, w), "=", ratio), "differentiate")
    _derive_bounds(b, tail, ratio)
    b.state(
        "at infinity" + tail, Equation(Limit(G, w, Infinity()), "=", PI * S), "arctan tends to π/2",
        ["limit of the first term" + tail],
    )  # fmt: skip
    b.state("at zero" + tail, Equation(Limit(G, w, ZERO), "=", ZERO), "x ln x vanishes with x")
    b.linked(
        "root lemma" + tail, Equation(Definite(ratio, w, ZERO, Infinity()), "=", PI * S), "integral",
        "the difference of the limits", ["antiderivative" + tail, "at infinity" + tail, "at zero" + tail],
    )  # fmt: skip
    _derive_corollary(b, tail, ratio, factor, "spectral factor" + tail, ["no modulus"])


def _derive_silence(b: ScalarBuilder) -> None:
    s = b.theory.symbols
    A, C, V, W, g, P, w = (s[k] for k in ("A", "C", "V", "W", "g", "P", "ω"))
    body, tail = Log(spectrum(A, W, g, w)), " of an integrator without noise"
    b.say("An integrator without process noise has the spectrum one, and the double root:")
    b.state("spectrum" + tail, Equation(spectrum(A, W, g, w), "=", ONE), "no process noise", ["W = 0"])
    b.linked("logarithm" + tail, Equation(body, "=", Log(ONE)), "same argument", "the spectrum", ["spectrum" + tail])
    b.state("integrand" + tail, Equation(Rate(ZERO, w), "=", body), "both are zero",
            ["logarithm" + tail, "logarithm of one"])  # fmt: skip
    for point, name in ((Infinity(), "at infinity"), (ZERO, "at zero")):
        b.state(name + tail, Equation(Limit(ZERO, w, point), "=", ZERO), "a constant")
    b.linked("half the integral" + tail, Equation(Definite(body, w, ZERO, Infinity()), "=", ZERO), "integral",
             "zero is an antiderivative", ["integrand" + tail, "at infinity" + tail, "at zero" + tail])  # fmt: skip
    whole = Quotient(ONE, 2 * PI) * Definite(body, w, Neg(Infinity()), Infinity())
    b.state(
        "corollary 2" + tail, Equation(P, "=", Quotient(V, square(C)) * (whole + 2 * Max(A))), "both sides are zero",
        ["half the integral" + tail, "no maximum", "double root"], number="31", source=SOURCE,
    )  # fmt: skip
