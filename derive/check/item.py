"""Claims on their way to a verdict: what is to be judged, and with which letters and macros it is read."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

from derive.claim import Claim

__all__ = ["Item", "Setting"]

Macro = tuple[int, str]  # number of arguments and body


@dataclass(frozen=True)
class Setting:
    """What holds for the claims from some place of a document on.

    ``assume`` are relations in LaTeX; ``origins`` says where each of them stands. ``notation`` gives the theory's
    letter for a letter of the document, {"F": "A"}.
    """

    theory: str = ""
    assume: tuple[str, ...] = ()
    origins: tuple[str, ...] = ()
    scalar: bool = False
    macros: Mapping[str, Macro] = field(default_factory=dict[str, Macro])
    notation: Mapping[str, str] = field(default_factory=dict[str, str])

    def assuming(self, latex: str, origin: str) -> Setting:
        """Return the setting with one more assumption."""
        return Setting(
            self.theory, (*self.assume, latex), (*self.origins, origin), self.scalar, self.macros, self.notation
        )


@dataclass(frozen=True)
class Item:
    """One claim and the setting in which it is read.

    ``explicit`` claims are judged whatever they look like; other displays are claims only if they relate something.
    ``message`` says what is wrong with the place if no claim could be taken from it.
    """

    claim: Claim
    setting: Setting = field(default_factory=Setting)
    explicit: bool = False
    message: str = ""
