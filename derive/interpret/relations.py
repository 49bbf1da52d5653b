"""Relations between terms: equations and inequalities, chains of them, and those of a whole display."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

from derive.interpret.arithmetic import adapted, common
from derive.interpret.shapes import Misfit, NotUnderstood, Typed
from derive.latex import latex
from derive.latex import syntax as s
from derive.terms import Equation

if TYPE_CHECKING:
    from derive.interpret.reader import Reader

ORDER = {"≥": ("⪰", "≥"), ">": ("≻", ">"), "⪰": ("⪰", "≥"), "≻": ("≻", ">")}
LOGIC = frozenset(["or", "either", "if", "iff", "unless", "except", "when", "whenever", "then", "implies", "not"])
TURNED = {"≤": "≥", "<": ">", "⪯": "⪰", "≺": "≻"}
EXPECTED = "expected an equation or an inequality, as in P = A P A^T + Q or P \\succeq 0"


def relations(display: s.Display) -> Iterator[s.Related]:
    """Iterate over the relations of a display.

    Raises:
        NotUnderstood: words between them that make another statement of them than all together.
    """
    for word in (w for words in display.words for w in words.lower().split()):
        if word.strip(".,;:") in LOGIC:
            raise NotUnderstood(f'"{word}" between formulas: write each as a claim, and conditions as assumptions')
    for statement in display.statements:
        yield from _relations(statement)


def _relations(node: s.Node) -> Iterator[s.Related]:
    match node:
        case s.Related():
            yield node
        case s.Listed(items):
            for item in items:
                yield from _relations(item)
        case s.Cases(rows):
            for value, condition in rows:
                if condition is not None:
                    raise NotUnderstood("a definition by cases: write each case as a formula, its condition assumed")
                yield from _relations(value)
        case _:
            raise NotUnderstood(f"a formula without a relation: {EXPECTED}")


def compared(node: s.Related, reader: Reader) -> list[Equation]:
    """Return the equations and inequalities of a chain a = b <= c."""
    sides = [reader.read(side) for side in node.sides]
    return [relate(a, sign, b, reader) for a, sign, b in zip(sides, node.relations, sides[1:], strict=False)]


def relate(lhs: Typed, sign: str, rhs: Typed, reader: Reader) -> Equation:
    """Return one relation between two terms of the same shape, sides swapped where the page has ≤.

    Raises:
        Misfit: the shapes differ, or an order is stated between matrices that are not square.
        NotUnderstood: a sign that is no relation between terms.
    """
    if sign in TURNED:
        lhs, sign, rhs = rhs, TURNED[sign], lhs
    shape = common([lhs, rhs], reader)
    left, right = adapted(lhs, shape, reader), adapted(rhs, shape, reader)
    if sign in ORDER:
        if shape is not None and not reader.shapes.same(*shape):
            raise Misfit(f"shapes: an order is one of square matrices; {latex(left)} is {reader.shapes.show(shape)}")
        return Equation(left, ORDER[sign][shape is None], right)
    if sign in ("=", ":=", "≠", "≡"):
        return Equation(left, "≠" if sign == "≠" else "=", right)
    raise NotUnderstood(f"{sign}: no relation that is decided; {EXPECTED}")


def settled(equation: Equation, reader: Reader) -> Equation:
    """Return an equation with all dimensions found."""
    settle = reader.shapes.settle
    return Equation(settle(equation.lhs), equation.relation, settle(equation.rhs))
