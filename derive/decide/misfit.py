"""The nearest true formula to one whose shapes do not fit: C for C', two factors swapped, one too many or too few.

A formula that does not fit has no typed terms, so the edits are made in its syntax; what fits afterwards is proved.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import fields, replace
from itertools import islice

from derive.claim import Nearest
from derive.decide.matrix import prove_statement
from derive.errors import InputError
from derive.interpret import echo, understand
from derive.latex import syntax as s
from derive.theory.claims.base import ClaimTheory

__all__ = ["nearest_fitting"]

MOST = 60  # edits that are read again
FITTING = 8  # of them, that fit and are proved or not
EXPLAINED = "The shapes fit with {}: C leads from the state to the output, its transpose back."


def nearest_fitting(
    display: s.Display,
    theory: ClaimTheory,
    *,
    assume: Sequence[s.Display] = (),
    notation: Mapping[str, str] | None = None,
) -> tuple[Nearest, str] | None:
    """Search for a true formula that differs at one place from one whose shapes do not fit.

    Returns:
        The formula with the edit in words, and a sentence that explains it or ""; None if no single edit is true.
    """
    fitting = 0
    for edited, words in islice(_edits(display), MOST):
        try:
            statement = understand(edited, theory, assume=assume, notation=notation)
        except InputError:
            continue
        fitting += 1
        if prove_statement(statement, seconds=2.0):
            why = EXPLAINED.format(words) if words.endswith(("C' for C", "C for C'")) else ""
            return Nearest(echo(statement), words), why
        if fitting == FITTING:
            return None
    return None


def _edits(node: s.Node) -> Iterator[tuple[s.Display, str]]:
    """Iterate over edited displays: transposes first, then swapped factors, then one factor less."""
    found: list[tuple[int, s.Node, str]] = sorted(_at(node), key=lambda item: item[0])
    yield from ((edited, words) for _, edited, words in found if isinstance(edited, s.Display))


def _at(node: s.Node) -> Iterator[tuple[int, s.Node, str]]:
    yield from _here(node)
    for f in fields(node):
        value = getattr(node, f.name)
        if isinstance(value, s.Node):
            yield from ((cost, replace(node, **{f.name: new}), words) for cost, new, words in _at(value))
        elif isinstance(value, tuple):
            for i, item in enumerate(value):
                for cost, new, words in _in(item):
                    yield cost, replace(node, **{f.name: (*value[:i], new, *value[i + 1 :])}), words


def _in(item: object) -> Iterator[tuple[int, object, str]]:
    """Iterate over the edits of an entry of a tuple: a node, or an addend with its sign."""
    if isinstance(item, s.Node):
        yield from _at(item)
    elif isinstance(item, tuple) and len(item) == 2 and isinstance(item[1], s.Node):
        yield from ((cost, (item[0], new), words) for cost, new, words in _at(item[1]))


def _here(node: s.Node) -> Iterator[tuple[int, s.Node, str]]:
    match node:
        case s.Transposed(body):
            yield 0, body, f"{_shown(body)} for {_shown(node)}"
        case s.Name():
            yield 0, s.Transposed(node), f"{_shown(node)}' for {_shown(node)}"
        case s.Times(factors):
            for i in range(len(factors) - 1):
                swapped = (*factors[:i], factors[i + 1], factors[i], *factors[i + 2 :])
                yield 1, s.Times(swapped), f"{_shown(factors[i])} and {_shown(factors[i + 1])} swapped"
            if len(factors) > 1 and (turned := _turned(factors)):
                yield 1, s.Times(turned), f"the two transposes of {_shown(node)} exchanged"
            for i, factor in enumerate(factors):
                rest = (*factors[:i], *factors[i + 1 :])
                yield 2, rest[0] if len(rest) == 1 else s.Times(rest), f"without the factor {_shown(factor)}"
        case _:
            pass


def _turned(factors: tuple[s.Node, ...]) -> tuple[s.Node, ...] | None:
    """Return X Y X' for X' Y X, and the other way round."""
    match factors[0], factors[-1]:
        case s.Transposed(body) as first, last if body == last:
            return (last, *factors[1:-1], first)
        case first, s.Transposed(body) as last if body == first:
            return (last, *factors[1:-1], first)
        case _:
            return None


def _shown(node: s.Node) -> str:
    """Return a short text of a node."""
    match node:
        case s.Name(letter, accents, sub, sup):
            return letter + "".join(f" {a}" for a in accents) + (f"_{sub}" if sub else "") + (f"^{sup}" if sup else "")
        case s.Transposed(body):
            return _shown(body) + "'"
        case s.Inverted(body):
            return _shown(body) + "^-1"
        case s.Fenced(body):
            return f"({_shown(body)})"
        case s.Times(factors):
            return " ".join(map(_shown, factors))
        case s.Plus(addends):
            text = "".join(f" {sign} {_shown(body)}" for sign, body in addends)
            return text.removeprefix(" + ").strip()
        case s.Digits(value):
            return str(value)
        case _:
            return "a term"
