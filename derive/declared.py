"""What a theory declares: definitions and hypotheses, facts, letters for inverses, and scalars for functions."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Literal

from derive.real import Family
from derive.terms import Equation, Term


@dataclass(frozen=True)
class Declared:
    """A definition (:=) or hypothesis of a theory: its name, what it says, and a sentence for the reader.

    A hypothesis that is a ``case`` (P > 0 of the information form) is made only by the steps that name it; the theory
    does not always hold it in force.
    """

    name: str
    statement: Equation
    kind: Literal["definition", "hypothesis"]
    text: str = ""
    case: bool = False
    generic: str = ""  # the variable, if it holds for all but finitely many of its values
    every: bool = False  # it holds for every number of steps: the start of a sequence, or a recursion


@dataclass(frozen=True)
class DeclaredInverse:
    """A letter for the inverse of a term; it may be used once its reason is there.

    The reason is the name of a fact (M > 0, or M invertible), or the term ``by`` and the names of two proved
    identities M * by = I and by * M = I.
    """

    name: str
    of: Term
    because: str | tuple[str, str]
    by: Term | None = None


@dataclass(frozen=True)
class DeclaredFact:
    """A hypothesis that is no (in)equality: 'hurwitz', 'schur', 'invertible', 'initial' (>= 0 at t0)."""

    name: str
    kind: str
    matrix: Term
    text: str = ""
    case: bool = False


@dataclass(frozen=True)
class DeclaredAtom:
    """A scalar that stands for a root, quotient or function of another; it may be used once its reason is there.

    The reason is the name of a fact on the argument, where the function is not defined everywhere.
    """

    name: str
    kind: str
    of: Term
    because: str = ""


Item = Declared | DeclaredInverse | DeclaredFact | DeclaredAtom


def names_of_roots(families: Mapping[str, Family]) -> set[str]:
    """Return the scalars that stand for roots, their parts, indices and counts."""
    return {n for f in families.values() for n in (f.real, f.imaginary, f.index, f.count)} | set(families)


def first_of(member: str) -> str:
    """Return the name of the definition of the first member of a sequence."""
    return f"{member} at the start"


def defines(item: Declared) -> bool:
    """Tell whether a declaration is a definition, and no recursion."""
    return item.kind == "definition" and not item.every


def terms_of(item: Item) -> tuple[Term, ...]:
    """Return the terms that a declaration speaks of."""
    if isinstance(item, Declared):
        return item.statement.lhs, item.statement.rhs
    return (item.matrix,) if isinstance(item, DeclaredFact) else (item.of,)
