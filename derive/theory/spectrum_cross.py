"""Theorem 1 beyond the source: process and measurement noise that are correlated, E[w(t) v(τ)'] = N δ(t - τ)."""

from __future__ import annotations

from derive.context import Theory
from derive.terms import Equation, Glyph, Trace, Zero
from derive.theory.spectrum_builder import SpectrumBuilder
from derive.theory.spectrum_filter import (
    Filter,
    declare_filter,
    derive_factorisation,
    derive_spectrum,
    log_spectrum,
    resolvent,
    unstable,
)
from derive.theory.spectrum_roots import whole

CROSS = Filter("K_N", "Phi_N", "μ_N", " with cross-covariance")


def declare(t: Theory) -> None:
    """Declare the cross-covariance, its filter and the spectrum of the output."""
    A, C, W, V = (t.symbols[k] for k in "ACWV")
    N = t.matrix("N", "m", "l", meaning="cross-covariance of the noises", unit="[state]*[output]")
    P = t.matrix("P_N", "m", "m", Glyph("P", sub="N"), symmetric=True, meaning="error covariance", unit="[state]^2")
    K = t.matrix("K_N", "m", "l", Glyph("K", sub="N"), meaning="gain with cross-covariance")
    innovation = P * C.T + N
    riccati = A * P + P * A.T + W - innovation * V.inv * innovation.T
    t.assume("Riccati equation" + CROSS.tail, riccati, "=", Zero("m", "m"), "the steady filter, see the lecture on it")
    t.assume("gain" + CROSS.tail, K, "=", innovation * V.inv, "the optimal gain")
    Phi = t.matrix("Phi_N", "l", "l", Glyph("Φ", sub="N"), show_args=("s",), meaning="spectrum of the output")
    t.complex.add("Phi_N")
    F, G = resolvent(t), resolvent(t, -1)
    t.define("Phi_N", Phi, C * F * W * G.T * C.T + C * F * N + N.T * G.T * C.T + V)
    declare_filter(t, CROSS, "ρ")
    for name, body in (("CPC'V^-1", C * P * C.T * V.inv), ("CNV^-1", C * N * V.inv)):
        t.atom("spectral", Trace(body), name=f"tr {name}{CROSS.tail}")


def derive(b: SpectrumBuilder) -> None:
    """Derive tr(CPC'V^-1) + tr(CNV^-1) by the spectrum."""
    t, tail = b.theory, CROSS.tail
    C, K, P, N, V, root = (t.symbols[k] for k in ("C", "K_N", "P_N", "N", "V", CROSS.closed))
    b.heading("Correlated noises")
    b.say("With a cross-covariance N of both noises the same holds for its own filter and spectrum:")
    using = ["Riccati equation" + tail, "gain" + tail, "Phi_N"]
    b.given(*using)
    derive_factorisation(b, CROSS, using)
    b.given(f"eigenvalues {root.name}", "strong solution" + tail)
    derive_spectrum(b, CROSS)
    cost = Trace(C * P * C.T * V.inv) + Trace(C * N * V.inv)
    b.state("trace of KC" + tail, Equation(Trace(K * C), "=", cost), "the gain", ["gain" + tail], rule="trace")
    b.state(
        "theorem 1" + tail,
        Equation(cost, "=", whole(b, log_spectrum(t, CROSS)) + 2 * unstable(t)),
        "as for uncorrelated noises",
        [
            f"log-integral of {CROSS.spectrum}",
            f"closed loop{tail}, summed",
            "modulus of λ, summed",
            "trace by λ",
            f"trace by {root.name}",
            "trace of KC" + tail,
        ],
    )
