"""The syntax of a formula as it was written: untyped nodes in order, each with its place in the source.

What a letter stands for, whether 2(A + B) multiplies or f(t) is applied, and which shapes fit is decided later, in a
theory; a node only says what is on the page. Standard library only.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field, fields
from fractions import Fraction

Span = tuple[int, int]  # columns of the source, from and up to


@dataclass(frozen=True)
class Node:
    """A piece of a formula; ``span`` is where it stands and does not take part in comparisons."""

    span: Span = field(default=(0, 0), compare=False, kw_only=True)

    def children(self) -> Iterator[Node]:
        """Iterate over the nodes directly below this one, in the order in which they are written."""
        for f in fields(self):
            yield from _nodes(getattr(self, f.name))


def _nodes(value: object) -> Iterator[Node]:
    if isinstance(value, Node):
        yield value
    elif isinstance(value, tuple):
        for item in value:  # type: ignore[reportUnknownVariableType]
            yield from _nodes(item)


# ------------------------------------------------------------------------------------------------ leaves
@dataclass(frozen=True)
class Name(Node):
    """A letter with its marks: P, \\hat x_{k|k-1}, \\sigma_v^2's sigma, \\mathbf A, L_f, P^+.

    ``letter`` is the character or the command's name without backslash (``"P"``, ``"Phi"``); styles are dropped.
    ``accents`` from the inside out (``("hat", "dot")``); ``sub`` and ``sup`` are the indices as text without braces,
    styles and spaces, Greek letters and accents as characters (``"k-1"``, ``"k|k-1"``, ``"vv"``, ``"ξξ"``, ``"z-ȳ"``,
    ``"∞"``, ``"+"``).
    """

    letter: str
    accents: tuple[str, ...] = ()
    sub: str = ""
    sup: str = ""


@dataclass(frozen=True)
class Digits(Node):
    """A number in decimal notation, read exactly."""

    value: Fraction


@dataclass(frozen=True)
class Infinite(Node):
    """The sign of infinity."""


@dataclass(frozen=True)
class Blank(Node):
    """What is left open: dots (mark "…"), the argument of a function (·), a symmetric block (*), or nothing at all."""

    mark: str = ""


# ------------------------------------------------------------------------------------------------ arithmetic
@dataclass(frozen=True)
class Plus(Node):
    """A sum; each addend with its sign, "+" or "-" or "±"."""

    addends: tuple[tuple[str, Node], ...]


@dataclass(frozen=True)
class Times(Node):
    """A product in order, by juxtaposition or with a sign of multiplication."""

    factors: tuple[Node, ...]


@dataclass(frozen=True)
class Over(Node):
    """A fraction, or a division with a stroke."""

    top: Node
    bottom: Node


@dataclass(frozen=True)
class Radical(Node):
    """A root; ``index`` is None for the square root."""

    body: Node
    index: Node | None = None


@dataclass(frozen=True)
class Raised(Node):
    """A power; transposes and inverses have nodes of their own."""

    body: Node
    exponent: Node


@dataclass(frozen=True)
class Transposed(Node):
    """A transpose: top, T, star, prime, dagger or H; ``mark`` is how it was written."""

    body: Node
    mark: str = "top"


@dataclass(frozen=True)
class Inverted(Node):
    """An inverse, written with the exponent -1."""

    body: Node


@dataclass(frozen=True)
class Fenced(Node):
    """A group in brackets; ``fence`` is its opening bracket: ( [ { or | or ‖, of an interval both: [) (] .

    ``sub`` is the index of a norm, as text.
    """

    body: Node
    fence: str = "("
    sub: str = ""


@dataclass(frozen=True)
class Applied(Node):
    """A letter followed by arguments that look like times, frequencies or indices: P(t), Phi(t,tau), lambda_i(A).

    ``head`` is a Name, or carries what stands between the letter and its arguments: x^T(t), Phi^{-1}(t,tau).
    """

    head: Node
    arguments: tuple[Node, ...]


@dataclass(frozen=True)
class Called(Node):
    """A named function of its arguments: det tr max min Re Im ln exp sin cos tan arctan diag rank lim inf sup arg.

    ``sub`` is what stands below a max, min or lim, e.g. the relation t -> oo.
    """

    function: str
    arguments: tuple[Node, ...]
    sub: Node | None = None


@dataclass(frozen=True)
class Expected(Node):
    """An expectation E[.]."""

    body: Node


@dataclass(frozen=True)
class Differentiated(Node):
    """A derivative d/dt or partial derivative of n-th order with respect to a node; a dot is an accent of a Name."""

    body: Node
    variable: Node
    order: int = 1
    partial: bool = False


@dataclass(frozen=True)
class Dotted(Node):
    """A dot over a group that is no single letter."""

    body: Node
    order: int = 1


@dataclass(frozen=True)
class Barred(Node):
    """A bar over a group that is no single letter: a mean, or a complex conjugate."""

    body: Node


@dataclass(frozen=True)
class Summed(Node):
    """A sum or product over an index (``sign`` is "sum" or "prod"), with bounds as far as they are written."""

    body: Node
    index: Node | None
    lower: Node | None
    upper: Node | None
    sign: str = "sum"


@dataclass(frozen=True)
class Integrated(Node):
    """An integral of a body over a variable between bounds, as far as they are written."""

    body: Node
    variable: Node
    lower: Node | None = None
    upper: Node | None = None


@dataclass(frozen=True)
class Matrix(Node):
    """A matrix or block matrix, row by row; ``fence`` is its bracket."""

    rows: tuple[tuple[Node, ...], ...]
    fence: str = "["


@dataclass(frozen=True)
class Cases(Node):
    """A definition by cases: values with their conditions (None for otherwise)."""

    rows: tuple[tuple[Node, Related | None], ...]


@dataclass(frozen=True)
class Given(Node):
    """Something under a condition: E[x | y], P(k | k-1)."""

    body: Node
    condition: Node


@dataclass(frozen=True)
class Listed(Node):
    """Several things with commas between them."""

    items: tuple[Node, ...]


# ------------------------------------------------------------------------------------------------ statements
@dataclass(frozen=True)
class Related(Node):
    """A chain a = b <= c; ``relations`` are = := < > ≤ ≥ ≺ ≻ ⪯ ⪰ ≠ → ∈ ∼ ≈ ⇒ ⇔, one less than the sides.

    The arrows ⇒ ⇔ stand between statements and hold together less tightly than the others.
    """

    sides: tuple[Node, ...]
    relations: tuple[str, ...]


@dataclass(frozen=True)
class Display(Node):
    """One displayed formula: its statements in order, the words around them, and its label and number.

    ``words[i]`` stands before statement i, the last one after them all; punctuation is left out. A statement that
    continues the display before it, as in "= C P C'", has a Blank as its first side.
    """

    statements: tuple[Node, ...]
    words: tuple[str, ...] = ()
    label: str = ""
    tag: str = ""


def walk(node: Node) -> Iterator[Node]:
    """Iterate over a node and everything below it."""
    yield node
    for child in node.children():
        yield from walk(child)
