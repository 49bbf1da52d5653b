"""A place in the tokens of a formula: looking, taking, brackets that are open, and errors."""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterator
from contextlib import contextmanager
from typing import NoReturn, TypeVar

from derive.latex.syntax import Node, Span
from derive.latex.tokens import Token, Unreadable

MAX_DEPTH = 30  # brackets, fractions, scripts and operators inside each other
T = TypeVar("T")


class Cursor:
    """Tokens and the place in them; every method that moves goes forward only."""

    def __init__(self, tokens: list[Token], source: str, functions: Collection[str] = ()) -> None:
        end = len(source.rstrip())
        self.source = source
        self.tokens = [*tokens, Token("end", "", end, end)]
        self.functions = functions
        self.at = 0
        self.depth = 0
        self.bar = ""  # the bar that would close the group which is open: | or ‖ or none
        self.integral: list[Node | None] = []  # the integral that is open at this level: its differential, once found
        self.open_end = -1  # where an operator ended that acts on all that follows, such as a sum
        self.numerator = False  # whether this is the top of a fraction in an integral, which may hold the differential

    def look(self, ahead: int = 0) -> Token:
        """Return the token at the place, or some tokens ahead."""
        return self.tokens[min(self.at + ahead, len(self.tokens) - 1)]

    def take(self) -> Token:
        """Return the token at the place and go past it."""
        token = self.look()
        self.at += 1
        return token

    def took(self, text: str, kind: str = "sign") -> bool:
        """Go past a token if it is this one."""
        found = self.look().text == text and self.look().kind == kind
        self.at += found
        return found

    def span(self, start: Token) -> Span:
        """Return the columns from a token up to the place."""
        return start.start, max(start.end, self.tokens[self.at - 1].end if self.at else 0)

    def skip_group(self) -> None:
        """Go past a group in braces, or a single token."""
        depth = 0
        while True:
            token = self.take()
            depth += {"{": 1, "}": -1}.get(token.text, 0) if token.kind == "sign" else 0
            if depth <= 0 or token.kind == "end":
                return

    # -------------------------------------------------------------------------------------------- errors
    def fail(self, expected: str, token: Token | None = None) -> NoReturn:
        """Raise the error that something else was expected at a token, or here."""
        token = token or self.look()
        raise Unreadable(token.start, expected, token.shown())

    def ambiguous(self, at: Token | Node, one: str, two: str, since: Token | Node | None = None) -> NoReturn:
        """Raise the error that a formula has two readings; it shows the source from ``since`` up to here."""
        column, start = (x.start if isinstance(x, Token) else x.span[0] for x in (at, since or at))
        got = " ".join(self.source[start : max(self.look().end, start + 1)].split())
        raise Unreadable(column, f"either {one} or {two}", f"{got[:40]}, which can be both")

    @contextmanager
    def deeper(self, start: Token) -> Iterator[None]:
        """Count a nesting."""
        self.depth += 1
        if self.depth > MAX_DEPTH:
            raise Unreadable(start.start, f"at most {MAX_DEPTH} groups inside each other", "one more")
        yield
        self.depth -= 1

    @contextmanager
    def inside(self, start: Token, bar: str = "") -> Iterator[None]:
        """Count a nesting in brackets or braces, where no integral ends and only the given bar closes."""
        outer = self.bar, self.integral, self.numerator
        self.bar, self.integral, self.numerator = bar, [], False
        with self.deeper(start):
            yield
        self.bar, self.integral, self.numerator = outer

    def separated(self, item: Callable[[], T], separator: str = ",") -> list[T]:
        """Read items with a sign between them."""
        items = [item()]
        while self.took(separator):
            items.append(item())
        return items
