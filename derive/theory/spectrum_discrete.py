"""Discrete time: the output spectrum factors as in continuous time, with the innovation covariance in the middle.

The letter s stands for z, a point of the plane where zI - A and I - zA are regular. With the strong solution P of the
Riccati equation, S = CPC' + R and the predictor's gain K,

    Phi(z) = C (zI - A)^-1 Q (z^-1 I - A)^-T C' + R = (I + C (zI - A)^-1 K) S (I + C (z^-1 I - A)^-1 K)'.

No inverse of z is needed: (z^-1 I - A)^-1 = z (I - zA)^-1. A may be singular, and have eigenvalues on the unit circle.
"""

from __future__ import annotations

from derive.context import Theory
from derive.derivation import Rule
from derive.spectral import Det
from derive.terms import Equation, Glyph, Identity, Product, Term, Zero
from derive.theory.builder import SquareOf
from derive.theory.spectrum_builder import SpectrumBuilder

GENERIC = "s is a generic point"
INVERSES = ["(sI-A)^-1", "(I-sA)^-1"]


def declare(t: Theory) -> None:
    """Declare the discrete plant, its steady predictor, and the spectrum of its output."""
    A = t.matrix("A", "m", "m", meaning="state matrix")
    C = t.matrix("C", "l", "m", meaning="output matrix")
    Q = t.matrix("Q", "m", "m", symmetric=True, meaning="covariance of the process noise")
    R = t.matrix("R", "l", "l", symmetric=True, meaning="covariance of the measurement noise")
    P = t.matrix("P", "m", "m", symmetric=True, meaning="steady covariance of the prediction")
    S = t.matrix("S", "l", "l", symmetric=True, meaning="covariance of the innovation")
    K = t.matrix("K", "m", "l", meaning="gain of the predictor")
    t.assume("R > 0", R, "≻", Zero("l", "l"), "the output is noisy")
    t.assume("P >= 0", P, "⪰", Zero("m", "m"), "a covariance")
    t.define("S", S, C * P * C.T + R)
    t.inverse("S^-1", S, "l", symmetric=True, because="S > 0")
    riccati = A * P * A.T - P + Q - A * P * C.T * S.inv * C * P * A.T
    t.assume("Riccati equation", riccati, "=", Zero("m", "m"), "the covariance of the prediction is steady")
    t.assume("gain", K, "=", A * P * C.T * S.inv, "the gain of the predictor")
    for name, matrix in (("sI - A", at(t, A)), ("I - sA", mirrored(t, A))):
        t.fact(f"{name} regular", "invertible", matrix, GENERIC)
        t.inverse(f"({name.replace(' ', '')})^-1", matrix, "m", because=f"{name} regular")
    Phi = t.matrix("Phi", "l", "l", Glyph("Φ", sub="y"), show_args=("s",), meaning="spectrum of the output")
    t.complex.add("Phi")
    t.define("Phi", Phi, C * resolvent(t) * Q * resolvent(t, mirror=True).T * C.T + R)
    for name, body in (
        ("Phi", Phi), ("S", S), ("factor", factor(t)), ("mirrored factor", factor(t, mirror=True)),
        ("exchanged", exchanged(t)), ("mirrored and exchanged", exchanged(t, mirror=True)),
        ("open loop", at(t, A)), ("mirrored open loop", mirrored(t, A)),
        ("closed loop", at(t, A - K * C)), ("mirrored closed loop", mirrored(t, A - K * C)),
    ):  # fmt: skip
        t.atom("spectral", Det(body), name=f"det {name}")


def at(t: Theory, matrix: Term) -> Term:
    """Return zI - M."""
    return t.symbols["s"] * Identity("m") - matrix


def mirrored(t: Theory, matrix: Term) -> Term:
    """Return I - zM."""
    return Identity("m") - t.symbols["s"] * matrix


def closed_loop(t: Theory) -> Term:
    """Return A - KC."""
    return t.symbols["A"] - t.symbols["K"] * t.symbols["C"]


def resolvent(t: Theory, *, mirror: bool = False) -> Term:
    """Return (zI - A)^-1, or z (I - zA)^-1, the same at 1/z."""
    A = t.symbols["A"]
    return t.symbols["s"] * mirrored(t, A).inv if mirror else at(t, A).inv


def factor(t: Theory, *, mirror: bool = False) -> Term:
    """Return I + C (zI - A)^-1 K, or the same at 1/z."""
    return Identity("l") + t.symbols["C"] * resolvent(t, mirror=mirror) * t.symbols["K"]


def exchanged(t: Theory, *, mirror: bool = False) -> Term:
    """Return I + K C (zI - A)^-1, or the same at 1/z."""
    return Identity("m") + t.symbols["K"] * t.symbols["C"] * resolvent(t, mirror=mirror)


def derive(b: SpectrumBuilder) -> None:
    """Derive the factorisation of the discrete spectrum and of its determinant."""
    t = b.theory
    A, C, S, Phi = (t.symbols[k] for k in ("A", "C", "S", "Phi"))
    b.heading("The spectrum by the innovation covariance")
    b.say("With s for z, and the predictor in its steady state:")
    b.given("R > 0", "P >= 0", "S")
    squares = [SquareOf(C, "P >= 0"), SquareOf(Identity("l"), "R > 0")]
    b.positive("S > 0", Equation(S, "≻", Zero("l", "l")), "a sum of squares", squares, ["S"], witness=Identity("l"))
    b.given("Riccati equation", "gain", "Phi")
    product = factor(t) * S * factor(t, mirror=True).T
    known = ["Phi", "S", "S^-1", "Riccati equation", "gain", *INVERSES]
    b.state("factorisation", Equation(Phi, "=", product), "the Riccati equation, and both inverses", known)
    dets = Product((Det(factor(t)), Det(S), Det(factor(t, mirror=True).T)))
    rule: Rule = "determinant"
    b.state(
        "determinant of the spectrum",
        Equation(Det(Phi), "=", dets),
        "the determinant of a product",
        ["factorisation"],
        rule=rule,
    )
    b.say("Both factors are closed loop over open loop, here and at the mirrored point:")
    for name, mirror, inverse, point in (("", False, INVERSES[0], at), ("mirrored ", True, INVERSES[1], mirrored)):
        one, other = Det(factor(t, mirror=mirror)), Det(exchanged(t, mirror=mirror))
        b.linked(f"{name}exchange", Equation(one, "=", other), "exchange", "det(I + XY) = det(I + YX)", [])
        loops = Equation(Product((other, Det(point(t, A)))), "=", Det(point(t, closed_loop(t))))
        b.state(f"{name}loops", loops, "the determinant of a product", [inverse], rule=rule)
    whole = Product((Det(Phi), Det(at(t, A)), Det(mirrored(t, A))))
    loops = Product((Det(S), Det(at(t, closed_loop(t))), Det(mirrored(t, closed_loop(t)))))
    b.state(
        "spectrum and loops", Equation(whole, "=", loops), "both factors",
        ["determinant of the spectrum", "exchange", "mirrored exchange", "loops", "mirrored loops"],
    )  # fmt: skip
