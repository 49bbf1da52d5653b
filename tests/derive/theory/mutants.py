"""Single-site mutations of presentation terms: a dropped addend, a changed sign, a lost transpose, swapped factors."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import fields, replace

from derive.terms import Block, Neg, Number, Product, Sum, Symbol, Term, Transpose


def mutants(term: Term) -> Iterator[Term]:
    """Iterate over the terms that differ from ``term`` at one place."""
    match term:
        case Sum(addends):
            for i, addend in enumerate(addends):
                rest = (*addends[:i], *addends[i + 1 :])
                yield rest[0] if len(rest) == 1 else Sum(rest)
                flipped = addend.body if isinstance(addend, Neg) else Neg(addend)
                yield Sum((*addends[:i], flipped, *addends[i + 1 :]))
        case Product(factors):
            for i in range(len(factors) - 1):
                swapped = (*factors[:i], factors[i + 1], factors[i], *factors[i + 2 :])
                if not any(isinstance(f, Number) or getattr(f, "scalar", False) for f in factors[i : i + 2]):
                    yield Product(swapped)
        case Transpose(body):
            yield body
        case Symbol(scalar=False):
            yield Transpose(term)
            return
        case _:
            pass
    yield from _below(term)


def _below(term: Term) -> Iterator[Term]:
    if isinstance(term, Block):
        for i, row in enumerate(term.rows):
            for j, entry in enumerate(row):
                for other in mutants(entry):
                    line = (*row[:j], other, *row[j + 1 :])
                    yield Block((*term.rows[:i], line, *term.rows[i + 1 :]))
        return
    for f in fields(term):  # type: ignore[arg-type]
        value = getattr(term, f.name)
        if isinstance(value, Term) and f.name != "symbol":
            for other in mutants(value):
                yield replace(term, **{f.name: other})  # type: ignore[type-var]
        elif isinstance(value, tuple):
            for i, entry in enumerate(value):
                if isinstance(entry, Term):
                    for other in mutants(entry):
                        yield replace(term, **{f.name: (*value[:i], other, *value[i + 1 :])})  # type: ignore[type-var]
