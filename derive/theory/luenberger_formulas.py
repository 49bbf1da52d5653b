"""Formulas of the discrete-time observer that several sections write out, as terms."""

from __future__ import annotations

from typing import Literal

from derive.context import Theory
from derive.terms import Glyph, Symbol, Term


def covariance(t: Theory, name: str, size: str, glyph: Glyph, meaning: str, *, parameter: bool = True) -> Symbol:
    """Declare a symmetric matrix of the unit of a covariance, of states (size n) or outputs (size l)."""
    unit = {"n": "[state]^2", "l": "[output]^2"}[size]
    return t.matrix(
        name, size, size, glyph, symmetric=True, constant=False, parameter=parameter, meaning=meaning, unit=unit
    )


def signal(
    t: Theory, name: str, rows: str, glyph: Glyph, meaning: str, mean: Literal["zero", "any"] = "zero"
) -> Symbol:
    """Declare the value of a signal at one instant; with a mean that is not zero its expectation has no rule."""
    unit = {"n": "[state]", "l": "[output]"}.get(rows, "")
    if mean == "any":
        t.uncentred.add(name)
    return t.matrix(
        name, rows, "1", glyph, random=mean == "zero", constant=False, parameter=False, meaning=meaning, unit=unit
    )


def gain(t: Theory, name: str, glyph: Glyph, meaning: str) -> Symbol:
    """Declare a gain, which no other gain changes."""
    return t.matrix(name, "n", "l", glyph, constant=False, meaning=meaning, unit="[state]/[output]")


def innovation(C: Term, P: Term, R: Term) -> Term:
    """Return the innovation covariance C P C' + R."""
    return C * P * C.T + R


def any_gain(A: Term, C: Term, L: Term, P: Term, Q: Term, R: Term, S: Term | None = None) -> Term:
    """Return the next covariance for a gain L.

    Q + (A - L C) P (A - L C)' + L R L' - L S' - S L'
    """
    after = Q + (A - L * C) * P * (A - L * C).T + L * R * L.T
    return after - L * S.T - S * L.T if S is not None else after


def riccati_step(A: Term, C: Term, P: Term, Q: Term, R: Term) -> Term:
    """Return the right-hand side of the Riccati equation.

    Q + A P A' - A P C' (C P C' + R)^-1 C P A'
    """
    return Q + A * P * A.T - A * P * C.T * innovation(C, P, R).inv * C * P * A.T


def riccati_step_with_cross(A: Term, C: Term, P: Term, Q: Term, R: Term, S: Term) -> Term:
    """Return the right-hand side of the Riccati equation with the cross-covariance S.

    Q + A P A' - (A P C' + S) (C P C' + R)^-1 (A P C' + S)'
    """
    cross = A * P * C.T + S
    return Q + A * P * A.T - cross * innovation(C, P, R).inv * cross.T


def optimal_gain(A: Term, C: Term, P: Term, R: Term, S: Term | None = None) -> Term:
    """Return the gain of the predictor.

    (A P C' + S) (C P C' + R)^-1
    """
    cross = A * P * C.T
    return (cross if S is None else cross + S) * innovation(C, P, R).inv
