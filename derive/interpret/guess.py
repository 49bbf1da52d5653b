"""Which theory formulas are about, by the letters and the shapes that they use."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

from derive.interpret.meaning import understand
from derive.interpret.names import spell
from derive.interpret.shapes import NotUnderstood
from derive.latex import syntax as s
from derive.theory.claims import THEORIES, claim_theory

ENOUGH = 2  # letters, without which nothing is guessed


def guess(displays: Sequence[s.Display], notation: Mapping[str, str] | None = None) -> tuple[str, str] | None:
    """Return the key of the only theory in which every formula has a meaning, and why; None if that is not clear.

    A formula that has a meaning in no theory is left out, and so is one with fewer than two letters.
    """
    read = [d for d in displays if len(_letters(d)) >= ENOUGH]
    for scalar in (False, True):
        fits = {key: [_has_meaning(d, key, notation, scalar) for d in read] for key in THEORIES}
        meant = [i for i in range(len(read)) if any(fit[i] for fit in fits.values())]
        possible = [key for key, fit in fits.items() if meant and all(fit[i] for i in meant)]
        if len(possible) == 1:
            letters = dict.fromkeys(letter for i in meant for letter in _letters(read[i]))
            said = f"{len(meant)} of {len(displays)} formulas" if len(displays) > 1 else "the formula"
            return possible[0], f"{said}, with the letters {', '.join(letters)}, can be read in this theory alone"
        if meant:
            return None
    return None


def _has_meaning(display: s.Display, key: str, notation: Mapping[str, str] | None, scalar: bool) -> bool:
    try:
        understand(display, claim_theory(key), scalar=scalar, notation=notation)
    except NotUnderstood:
        return False
    return True


def _letters(display: s.Display) -> list[str]:
    return list(dict.fromkeys(_spelled(display)))


def _spelled(display: s.Display) -> Iterator[str]:
    for node in s.walk(display):
        if isinstance(node, s.Name) and node.letter != "I":
            yield spell(node, {})
