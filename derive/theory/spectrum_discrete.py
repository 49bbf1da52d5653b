"""Discrete time: the output spectrum factors as in continuous time, with the innovation covariance in the middle.

The matrix part of the discrete counterpart of theorem 1; the letter s stands for z, a point of the plane where zI - A
and I - zA are regular. With the strong solution P of the Riccati equation, S = CPC' + R and the predictor's gain K,

    Phi(z) = C (zI - A)^-1 Q (z^-1 I - A)^-T C' + R = (I + C (zI - A)^-1 K) S (I + C (z^-1 I - A)^-1 K)'.

No inverse of z is needed: (z^-1 I - A)^-1 = z (I - zA)^-1.
"""

from __future__ import annotations

from derive.context import Theory
from derive.derivation import Rule
from derive.spectral import Det
from derive.terms import Equation, Glyph, Identity, Product, Term, Zero
from derive.theory.builder import SquareOf
from derive.theory.spectrum_builder import SpectrumBuilder
from derive.theory.spectrum_filter import GENERIC, resolvent

INVERSES = ["(sI-A)^-1", "(I-sA)^-1"]


def declare(t: Theory) -> None:
    """Declare the discrete plant, its steady predictor, and the spectrum of its output."""
    A, C = t.symbols["A"], t.symbols["C"]
    Q = t.matrix("Q_d", "m", "m", Glyph("Q"), symmetric=True, meaning="covariance of the process noise")
    R = t.matrix("R_d", "l", "l", Glyph("R"), symmetric=True, meaning="covariance of the measurement noise")
    P = t.matrix("P_d", "m", "m", Glyph("P", sub="d"), symmetric=True, meaning="steady covariance of the prediction")
    S = t.matrix("S_d", "l", "l", Glyph("S"), symmetric=True, meaning="covariance of the innovation")
    K = t.matrix("K_d", "m", "l", Glyph("K", sub="d"), meaning="gain of the predictor")
    t.assume("R_d > 0", R, "≻", Zero("l", "l"), "the output is noisy")
    t.assume("P_d >= 0", P, "⪰", Zero("m", "m"), "a covariance")
    t.define("S_d", S, C * P * C.T + R)
    t.inverse("S_d^-1", S, "l", symmetric=True, because="S_d > 0")
    riccati = A * P * A.T - P + Q - A * P * C.T * S.inv * C * P * A.T
    t.assume("discrete Riccati equation", riccati, "=", Zero("m", "m"), "the prediction's covariance is steady")
    t.assume("discrete gain", K, "=", A * P * C.T * S.inv, "the gain of the predictor")
    t.fact("I - sA regular", "invertible", _inner(t, A), GENERIC)
    t.inverse("(I-sA)^-1", _inner(t, A), "m", because="I - sA regular")
    Phi = t.matrix("Phi_d", "l", "l", Glyph("Φ", sub="d"), show_args=("s",), meaning="spectrum of the output")
    t.complex.add("Phi_d")
    t.define("Phi_d", Phi, C * resolvent(t) * Q * mirrored(t).T * C.T + R)
    for name, body in (
        ("Phi_d", Phi), ("S_d", S), ("factor d", factor(t)), ("mirrored factor d", factor(t, mirror=True)),
        ("exchanged d", Identity("m") + K * C * resolvent(t)), ("I - sA", _inner(t, A)),
        ("mirrored and exchanged d", Identity("m") + K * C * mirrored(t)),
        ("closed loop d", _point(t, A - K * C)), ("mirrored closed loop d", _inner(t, A - K * C)),
    ):  # fmt: skip
        t.atom("spectral", Det(body), name=f"det {name}")


def _point(t: Theory, matrix: Term) -> Term:
    return t.symbols["s"] * Identity("m") - matrix


def _inner(t: Theory, matrix: Term) -> Term:
    return Identity("m") - t.symbols["s"] * matrix


def mirrored(t: Theory) -> Term:
    """Return z (I - zA)^-1, the resolvent at 1/z."""
    return t.symbols["s"] * _inner(t, t.symbols["A"]).inv


def factor(t: Theory, *, mirror: bool = False) -> Term:
    """Return I + C (zI - A)^-1 K, or the same at 1/z."""
    return Identity("l") + t.symbols["C"] * (mirrored(t) if mirror else resolvent(t)) * t.symbols["K_d"]


def derive(b: SpectrumBuilder) -> None:
    """Derive the factorisation of the discrete spectrum and of its determinant."""
    t = b.theory
    A, C, K, S, Phi = (t.symbols[k] for k in ("A", "C", "K_d", "S_d", "Phi_d"))
    b.heading("Discrete time: the spectrum by the innovation covariance")
    b.say("With s for z, and the predictor in its steady state:")
    b.given("R_d > 0", "P_d >= 0", "S_d")
    squares = [SquareOf(C, "P_d >= 0"), SquareOf(Identity("l"), "R_d > 0")]
    b.positive("S_d > 0", Equation(S, "≻", Zero("l", "l")), "a sum of squares", squares, ["S_d"], witness=Identity("l"))
    b.given("discrete Riccati equation", "discrete gain", "Phi_d")
    product = factor(t) * S * factor(t, mirror=True).T
    known = ["Phi_d", "S_d", "S_d^-1", "discrete Riccati equation", "discrete gain", *INVERSES]
    b.state("discrete factorisation", Equation(Phi, "=", product), "the Riccati equation, and both inverses", known)
    dets = Product((Det(factor(t)), Det(S), Det(factor(t, mirror=True).T)))
    rule: Rule = "determinant"
    b.state(
        "determinant d",
        Equation(Det(Phi), "=", dets),
        "the determinant of a product",
        ["discrete factorisation"],
        rule=rule,
    )
    b.say("Both factors are closed loop over open loop, here and at the mirrored point:")
    for name, mirror, inverse in (("", False, INVERSES[0]), ("mirrored ", True, INVERSES[1])):
        F, point = (mirrored(t), _inner) if mirror else (resolvent(t), _point)
        exchanged = Det(Identity("m") + K * C * F)
        b.linked(
            f"{name}exchange d",
            Equation(Det(factor(t, mirror=mirror)), "=", exchanged),
            "exchange",
            "det(I + XY) = det(I + YX)",
            [],
        )
        loops = Equation(Product((exchanged, Det(point(t, A)))), "=", Det(point(t, A - K * C)))
        b.state(f"{name}loops d", loops, "the determinant of a product", [inverse], rule=rule)
    whole = Product((Det(Phi), Det(_point(t, A)), Det(_inner(t, A))))
    loops = Product((Det(S), Det(_point(t, A - K * C)), Det(_inner(t, A - K * C))))
    b.state(
        "discrete spectrum and loops", Equation(whole, "=", loops), "both factors",
        ["determinant d", "exchange d", "mirrored exchange d", "loops d", "mirrored loops d"],
    )  # fmt: skip
