"""Sentences for mistakes that are often made in the equations of optimal estimation."""

from __future__ import annotations

from collections.abc import Mapping

from derive.decide.edits import Edit

__all__ = ["sentence"]

INSERTED: Mapping[str, str] = {
    "V^-1": "The gain weighs the innovation by the inverse intensity of the measurement noise.",
    "R^-1": "What a measurement tells is weighed by the inverse covariance of its noise.",
    "C'": "The gain maps outputs to states: C' leads from the output to the state.",
    "C": "The innovation is a difference of outputs: C leads from the state to the output.",
}
PREDICTOR = "The predictor's gain carries the estimate one step on, so A stands in front; the filter's gain has no A."
ADDED = {
    "L": "The gain feeds measurement noise into the estimate; its covariance enters as {piece}.",
    "K": "The gain feeds measurement noise into the estimate; its intensity enters as {piece}.",
    "Q": "Process noise adds its covariance at every step.",
    "W": "Process noise adds its intensity.",
}
KINDS = {
    "factor 2": "A factor 2 too many or too few: the gradient of a quadratic form has one, its square has none.",
    "swap": "Matrices do not commute: the order of the factors matters.",
    "order": "The inequality holds the other way round.",
    "strict": "Equality is possible, so the inequality is not strict.",
}
ESTIMATION = ("luenberger-dt", "kalman-bucy", "observer-ct")


def sentence(edit: Edit, theory: str) -> str:
    """Return a sentence that explains a mistake by the edit that mends it, or ""."""
    if edit.kind in KINDS:
        return KINDS[edit.kind]
    if edit.kind == "transpose":
        return "A matrix stands where its transpose belongs, or the other way round."
    if theory not in ESTIMATION:
        return ""
    if edit.kind in ("plus", "minus"):
        return _sign(edit.kind, edit.piece)
    if edit.kind == "factor":
        return PREDICTOR if edit.piece == "A" and theory == "luenberger-dt" else INSERTED.get(edit.piece, "")
    if edit.kind == "inverse" and edit.piece in ("R", "V"):
        return INSERTED[f"{edit.piece}^-1"]
    if edit.kind == "addend":
        return ADDED.get(edit.piece[:1], "").format(piece=edit.piece)
    return ""


def _sign(kind: str, piece: str) -> str:
    """Explain a sign: a quadratic term with an inverse, the gain times C, noise under the gain, process noise."""
    if kind == "minus" and "C'" in piece and "^-1" in piece:
        return "A measurement reduces the covariance: what is gained from it enters with a minus sign."
    if kind == "minus" and piece[:1] in "LK" and piece.endswith(" C"):
        return (
            "The gain multiplies the innovation, output less its estimate: the error matrix is A less the gain times C."
        )
    if kind == "plus" and (piece[:1] in "LK" and piece.endswith("'")):
        return "The gain feeds measurement noise into the estimate; that adds to the covariance."
    if kind == "plus" and piece[:1] in "QW":
        return "Process noise adds to the covariance."
    return ""
