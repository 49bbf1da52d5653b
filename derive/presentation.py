"""Letters that the page writes out: what the kernel only names, such as a limit of averages or a Fourier integral."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field

from derive.terms import Symbol, Term, Zero


@dataclass(frozen=True)
class Named(Symbol):
    """A letter that prints as what it stands for; the kernel knows of it no more than the theory declares.

    >>> from derive.latex import plain
    >>> from derive.terms import Expect
    >>> plain(Named("mean", "n", "1", shows=Expect(Symbol("x", "n", "1"))))
    'E[x]'
    """

    shows: Term = field(default=Zero("", ""), compare=False)

    def children(self) -> Iterator[Term]:
        """Return nothing: a letter is a leaf, what it shows is no part of a statement."""
        return iter(())
