"""The discrete counterpart of theorem 1: the determinant of the innovation covariance by the spectrum of the output.

    ln det(CPC' + R) = (1/2π) ∫ ln det Phi(e^{jω}) dω + 2 Σ max(0, ln |λ_i(A)|),  the integral over -π < ω < π

P >= 0 is the stabilising solution of the Riccati equation, or the strong one: the eigenvalues of A - KC are in the unit
disc or on the circle. Nothing else is asked of A, which may be singular and have eigenvalues on the circle.
"""

from __future__ import annotations

from collections.abc import Sequence

from derive.context import Theory
from derive.functions import PI, Log
from derive.spectral import At, Det
from derive.terms import Equation, Neg, Product, Term
from derive.theory.scalar_continuous import ZERO
from derive.theory.spectrum_builder import SpectrumBuilder
from derive.theory.spectrum_circle import angle, constant, derive_number, point, same_integrand
from derive.theory.spectrum_dt_matrix import CLOSED, OPEN, around, log_modulus, outside, weighted
from derive.theory.spectrum_roots import half


# ------------------------------------------------------------------------------------------------ terms
def innovation(t: Theory) -> Term:
    """Return CPC' + R."""
    C, P, R = (t.symbols[k] for k in "CPR")
    return C * P * C.T + R


def log_innovation(t: Theory) -> Log:
    """Return ln det S."""
    return Log(Det(t.symbols["S"]))


def log_spectrum(t: Theory, place: Term) -> Log:
    """Return ln det Phi at a point."""
    return Log(At(Det(t.symbols["Phi"]), t.symbols["s"], place))


def loops(t: Theory) -> Term:
    """Return the integrand of the closed loop, less that of the open loop."""
    return weighted(t, log_modulus(t, CLOSED)) - weighted(t, log_modulus(t, OPEN))


def whole(t: Theory) -> Term:
    """Return the integrand of ln det Phi by those of both loops."""
    return constant(t, log_innovation(t)) + 2 * loops(t)


# ------------------------------------------------------------------------------------------------ declarations
def declare(t: Theory) -> None:
    """Declare the logarithms of the determinants, and what is integrated."""
    S = t.symbols["S"]
    t.atom("spectral", Det(innovation(t)), name="det(CPC'+R)")
    t.atom("log", Det(S), "det S > 0", "ln det S")
    t.atom("log", Det(innovation(t)), "det(CPC'+R) > 0", "ln det(CPC'+R)")
    t.atom("spectral", log_spectrum(t, point(t)), name="ln det Phi")
    for name, body in (
        ("both loops", loops(t)), ("both loops twice", 2 * loops(t)), ("ln det S", constant(t, log_innovation(t))),
        ("the sum", whole(t)), ("ln det Phi", weighted(t, log_spectrum(t, point(t)))),
    ):  # fmt: skip
        t.atom("improper", body, name=f"circle integral of {name}")


# ------------------------------------------------------------------------------------------------ derivation
def derive(b: SpectrumBuilder) -> None:
    """Derive the discrete counterpart of theorem 1."""
    t = b.theory
    b.heading("The determinant of the innovation covariance")
    b.positive_number("det S > 0", Equation(Det(t.symbols["S"]), ">", ZERO), "a positive definite matrix", ["S > 0"])
    b.say("On the circle det(I - zM) is, but for a power of z, the conjugate of det(zI - M), for M is real:")
    log = log_spectrum(t, point(t))
    moduli = 2 * log_modulus(t, CLOSED) - 2 * log_modulus(t, OPEN)
    on_circle = Equation(log, "=", log_innovation(t) + moduli)
    name, reason = "ln det Phi on the circle", "the factor is closed loop over open loop"
    b.linked(name, on_circle, "mirrored", reason, ["spectrum and loops"])
    same_integrand(b, "half of the circle", weighted(t, log), whole(t), [name])
    _derive_integral(b)
    _derive_innovation(b)
    b.say(
        "The discrete counterpart of theorem 1, which the source leaves to its reference [35]. P is the stabilising or "
        "the strong solution; A may be singular, with max(0, ln 0) = 0, and have eigenvalues on the circle:"
    )
    known = ["half of the circle, integral", "integral of the sum", "log of the innovation covariance"]
    right = around(t, log_spectrum(t, angle(t))) + 2 * outside(t)
    statement = Equation(Log(Det(innovation(t))), "=", right)
    b.state("discrete theorem 1", statement, "the closed loop contributes nothing", known)


def _derive_integral(b: SpectrumBuilder) -> None:
    """Derive the integral of ln det Phi over half of the circle."""
    t = b.theory
    lemmas, growth = [f"determinant lemma for {loop.matrix}" for loop in (CLOSED, OPEN)], PI * outside(t)
    _linear(b, "both loops", loops(t), Neg(growth), lemmas)
    _linear(b, "both loops twice", 2 * loops(t), 2 * (Neg(growth)), ["integral of both loops"])
    derive_number(b, "ln det S", log_innovation(t))
    value = Product((PI, log_innovation(t))) + 2 * (Neg(growth))
    _linear(b, "the sum", whole(t), value, ["number lemma: ln det S", "integral of both loops twice"])


def _linear(b: SpectrumBuilder, name: str, body: Term, value: Term, links: Sequence[str]) -> None:
    b.linked(
        f"integral of {name}", Equation(half(b.theory, body), "=", value), "linear", "the integral is linear", links
    )


def _derive_innovation(b: SpectrumBuilder) -> None:
    """Derive ln det S = ln det(CPC' + R)."""
    t, name = b.theory, "innovation covariance"
    one, other = Det(innovation(t)), Det(t.symbols["S"])
    b.state(name, Equation(one, "=", other), "definition", ["S"], rule="determinant")
    b.sign("det(CPC'+R) > 0", Equation(one, ">", ZERO), "definition", ["det S > 0"], identities=[name])
    logs = Equation(Log(one), "=", Log(other))
    b.linked(f"log of the {name}", logs, "same argument", "the same number", [name])
