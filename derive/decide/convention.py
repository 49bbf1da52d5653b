"""The convention in which a refuted claim holds: another Riccati equation, gain, covariance or sign of the error.

Each neighbour replaces letters all over the claim; it is proved before it is said.
"""

from __future__ import annotations

import time
from collections.abc import Mapping
from dataclasses import dataclass, fields, replace

from derive.decide.matrix import prove_statement
from derive.decide.nearest import Surroundings, with_equations
from derive.interpret.statement import Statement
from derive.terms import Block, Equation, Neg, Symbol, Term, Transpose, walk
from derive.theory.claims.base import ClaimTheory, indexed_name, split_index

__all__ = ["conventions", "letters"]

SECONDS = 3.0  # in all


@dataclass(frozen=True)
class Neighbour:
    """Letters to be replaced, and what is said if the claim holds then; # stands for any index."""

    images: Mapping[str, str]  # a name, with ' for its transpose and - for its negative
    sentence: str


RICCATI = Neighbour({"A": "A'"}, "true for the control Riccati equation, with A' for A, not the filter's")
FILTER = Neighbour({"A": "A'"}, "true for the filter's Riccati equation, with A' for A, not the regulator's")
NEIGHBOURS: Mapping[str, tuple[Neighbour, ...]] = {
    "luenberger-dt": (
        Neighbour({"L": "L_f"}, "true for the filter gain L_f, not the predictor gain L"),
        Neighbour({"L_f": "L"}, "true for the predictor gain L, not the filter gain L_f"),
        Neighbour({"L_#": "L^f_#"}, "true for the filter gain, not the predictor gain"),
        Neighbour({"P": "P+"}, "true for the covariance P+ of the filtered estimate, not the predicted one"),
        Neighbour({"P+": "P"}, "true for the covariance P of the predicted estimate, not the filtered one"),
        Neighbour({"P_#": "P+_#"}, "true for the covariances of the filtered estimate, not the predicted one"),
        Neighbour({"e_#": "-e_#"}, "true for the error e = x - xhat, of the other sign"),
        Neighbour({"w_#": "-w_#"}, "true for process noise of the other sign"),
        RICCATI,
    ),
    "kalman-bucy": (RICCATI, Neighbour({"e": "-e"}, "true for the innovation of the other sign")),
    "observer-ct": (RICCATI, Neighbour({"e": "-e"}, "true for the error e = o - x, of the other sign")),
    "covariance-ct": (),
    "lqr-ct": (FILTER, Neighbour({"K": "-K"}, "true for u = K x, the gain of the other sign")),
    "lqr-dt": (FILTER, Neighbour({"K": "-K"}, "true for u = K x, the gain of the other sign")),
}


def conventions(around: Surroundings, seconds: float = SECONDS) -> tuple[str, ...]:
    """Return in which neighbouring convention a refuted statement holds."""
    statement, deadline = around.statement, time.monotonic() + seconds
    for neighbour in NEIGHBOURS.get(statement.theory.key, ()):
        images = _images(neighbour, statement)
        if not images or time.monotonic() > deadline:
            continue
        changed = tuple(
            Equation(_replaced(e.lhs, images), e.relation, _replaced(e.rhs, images)) for e in statement.equations
        )
        if around.holds(changed) and prove_statement(with_equations(statement, changed), deadline - time.monotonic()):
            return (neighbour.sentence,)
    return ()


def letters(statement: Statement) -> list[Symbol]:
    """Return the letters that stand in a neighbouring convention."""
    found = [_images(n, statement) for n in NEIGHBOURS.get(statement.theory.key, ())]
    return [n for images in found for image in images.values() for n in walk(image) if isinstance(n, Symbol)]


def _images(neighbour: Neighbour, statement: Statement) -> dict[str, Term]:
    """Return the images of the claim's letters; empty if it has none of them."""
    found: dict[str, Term] = {}
    for symbol in statement.symbols:
        stem, index = split_index(symbol.name)
        pattern = stem + "_#" if index and symbol.name not in neighbour.images else symbol.name
        if pattern in neighbour.images:
            image = _image(neighbour.images[pattern], index, symbol, statement.theory)
            if image is None:
                return {}
            found[symbol.letter] = image
    return found


def _image(text: str, index: str, symbol: Symbol, theory: ClaimTheory) -> Term | None:
    name = text.strip("-'")
    name = indexed_name(name, index) if name.endswith("#") else name
    target = symbol if name == symbol.name else _known(name, theory)
    if target is None or (target.rows, target.cols) != (symbol.rows, symbol.cols):
        return None
    return Neg(target) if text.startswith("-") else Transpose(target) if text.endswith("'") else target


def _known(name: str, theory: ClaimTheory) -> Symbol | None:
    return theory.theory.symbols.get(name) or theory.about({name}).theory.symbols.get(name)


def _replaced(term: Term, images: Mapping[str, Term]) -> Term:
    """Put the images in the place of letters; A'' is A again."""
    if isinstance(term, Symbol):
        return images.get(term.letter, term)
    if isinstance(term, Transpose):
        body = _replaced(term.body, images)
        return body.body if isinstance(body, Transpose) else Transpose(body)
    if isinstance(term, Block):
        return Block(tuple(tuple(_replaced(t, images) for t in row) for row in term.rows))
    values = {f.name: _below(getattr(term, f.name), images) for f in fields(term)}  # type: ignore[arg-type]
    return replace(term, **values)  # type: ignore[type-var]


def _below(value: object, images: Mapping[str, Term]) -> object:
    if isinstance(value, Term):
        return _replaced(value, images)
    if isinstance(value, tuple) and value and all(isinstance(v, Term) for v in value):
        return tuple(_replaced(v, images) for v in value)
    return value
