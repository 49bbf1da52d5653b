"""Sentences for mistakes that are often made in the equations of optimal estimation."""

from __future__ import annotations

from collections.abc import Mapping

from derive.decide.edits import Edit

__all__ = ["sentence"]

INSERTED: Mapping[str, str] = {
    "A": "The predictor's gain carries the estimate one step on, so A stands in front; the filter's gain has no A.",
    "V^-1": "The gain weighs the innovation by the inverse intensity of the measurement noise.",
    "R^-1": "What a measurement tells is weighed by the inverse covariance of its noise.",
    "C'": "The gain maps outputs to states: C' leads from the output to the state.",
    "C": "The innovation is a difference of outputs: C leads from the state to the output.",
}
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


def sentence(edit: Edit, theory: str) -> str:
    """Return a sentence that explains a mistake by the edit that mends it, or ""."""
    if edit.kind in KINDS:
        return KINDS[edit.kind]
    if edit.kind == "sign":
        return _sign(edit.piece)
    if edit.kind == "transpose":
        return f"A transpose is missing or one too many: {edit.piece} is what maps between the right spaces."
    if edit.kind == "factor" and edit.piece in INSERTED and (edit.piece != "A" or theory == "luenberger-dt"):
        return INSERTED[edit.piece]
    if edit.kind == "addend":
        return ADDED.get(edit.piece[:1], "").format(piece=edit.piece)
    return ""


def _sign(piece: str) -> str:
    if ("C'" in piece and "^-1" in piece) or piece[:1] in "LK":
        return "A measurement reduces the covariance: what is gained from it enters with a minus sign."
    return ""
