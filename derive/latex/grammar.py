r"""The reader of formulas: LaTeX, as the field writes it, to a tree that says what is on the page and no more.

``read(r"P_k = A P_{k-1} A^\top + Q")`` is a recursive descent without backtracking: bounded in the length of the
source, in depth and in the work of macros, and linear in the tokens. Nothing is evaluated.

What is conventional, and read so:
  A B/c is (A B)/c, and a stroke before brackets ends with them: 1/(2 \pi) x is (1/(2 \pi)) x.
  \sum, \prod, \lim, \max_L, d/dt act on the product behind them, up to the next + or relation.
  \sin, \ln, ... without brackets take one factor, or numbers and times: \sin\omega t, \ln 2\pi.
  f(X) y is (f(X)) y for every named function f; \det[X]^{-1} is the determinant of the inverse.
  A letter before brackets is a function or a factor by what the brackets hold: see application.py.
  E[..], E\{..\}, \mathrm E(..) are expectations; A^T, A^*, A^H, A', A^\dagger are transposes, A^{T/2} that of a root.
  \mathbf{P A}^\top is P A^\top, as the page shows it; a differential may stand first, last, or in a fraction.
  W, V \succ 0 is said of both; k = 0, 1, 2 of one; a row that starts with a relation goes on with the row before.

What has two readings, and is an error that names both:
  1/2x, a/bc, a/b/c, 1/(2 a)(b + c)     how far the stroke reaches
  \ln a b, \ln a/b, \operatorname{tr} A B  what belongs to the argument
  \operatorname{tr}(A)^2, \sin^{-1} x    what is raised, and the inverse function
  P(A), E(x), \lambda(A - B), f(x)      a product, or a function (unless ``functions`` names it)
  A^-1, x^10, x_10, A 2, 1e-3            what the script holds, a factor or an index
  x'', A^t, e^{-T}                       transposes, derivatives, powers
  {a + b} c, {A B}^T                     groups in braces, which do not show
  \sum_i a_i + b_i, d/dt (a) b           how far the operator reaches
  tr(P), Phi, xhat without a backslash   a word, or the product of its letters
  \int a \, dt \, ds                    a second differential with one sign
"""

from __future__ import annotations

from collections.abc import Collection, Mapping
from dataclasses import replace

from derive.latex.macros import Macro, expand
from derive.latex.products import Products
from derive.latex.rows import frame
from derive.latex.syntax import Blank, Cases, Digits, Display, Listed, Name, Node, Plus, Related, Times, walk
from derive.latex.tokens import Token, Unreadable, sized, tokenise

QUANTIFIERS = frozenset(("all", "any", "each", "every", "for", "as", "when", "if", "with"))


def read(source: str, *, macros: Mapping[str, Macro] | None = None, functions: Collection[str] = ()) -> Display:
    r"""Read one displayed formula.

    Args:
        source: LaTeX or pasted Unicode, with or without its ``$$``, ``\[`` and environments.
        macros: number of arguments and body of the user's macros, by name without backslash.
        functions: letters that are functions whatever their arguments look like, as the trees name them.

    Raises:
        Unreadable: not a formula, or one with two readings; says where, what was expected and what was got.
    """
    tokens, label, tag = frame(list(sized(expand(tokenise(source), macros or {}))))
    return Reader(tokens, source, functions).display(label, tag)


class Reader(Products):
    """Reads statements and chains."""

    def display(self, label: str, tag: str) -> Display:
        """Read all statements of a display."""
        statements, words, commas = list[Node](), list[str](), list[bool]()
        while True:
            between, plain, number = self._separators()
            words.append(between)
            commas.append(plain)
            tag = tag or number
            if self.look().kind == "end":
                break
            statements.append(self._statement())
        if not statements:
            self.fail("a formula")
        merged, kept = _merged(statements, words, commas)
        return Display(merged, kept, label, tag)

    def _separators(self) -> tuple[str, bool, str]:
        """Go past what stands between statements: its words, whether it is a single comma, and a number (12)."""
        words, start = list[str](), self.at
        while True:
            token = self.look()
            if not self._separates(token):
                break
            words.append(token.text if token.kind == "word" else "for all" if token.text == "forall" else "")
            self.at += 1
        plain = self.at == start + 1 and self.tokens[start].text == ","
        number = self._number() if self.at > start else ""
        return " ".join(w for w in words if w), plain, number

    def _separates(self, token: Token) -> bool:
        """Return whether a token stands between statements."""
        return token.kind in ("break", "wide", "column", "word") or token.text in (",", ".", ";", ":", "forall")

    def _number(self) -> str:
        """Go past the number of an equation at the end of the display."""
        one, number, three, end = (self.look(i) for i in range(4))
        if (one.text, three.text, end.kind) == ("(", ")", "end") and number.kind == "number":
            self.at += 3
            return number.text
        return ""

    def _statement(self) -> Node:
        node = self.relation()
        token = self.look()
        if not self._separates(token) and token.kind != "end":
            self.fail("an operator, a relation or the end of the formula")
        if isinstance(_first(node), Cases):
            raise Unreadable(node.span[0], "a left side in front of the cases", "none")
        for part in walk(node):
            if part == Name("partial"):
                raise Unreadable(part.span[0], "a derivative such as \\frac{\\partial f}{\\partial x}", "\\partial")
        return node

    def relation(self) -> Node:
        """Read a chain of relations; one that starts with a relation continues what stood before."""
        start = self.look()
        sides: list[Node] = [Blank(span=(start.start, start.start)) if self._related() else self.expression()]
        relations: list[str] = []
        while self._related():
            relations.append(self._relation())
            sides.append(self.expression())
        return Related(tuple(sides), tuple(relations), span=self.span(start)) if relations else sides[0]

    def _related(self) -> bool:
        token = self.look()
        return token.kind == "relation" or (token.kind == "command" and token.text in ("overset", "stackrel", "not"))

    def _relation(self) -> str:
        r"""Go past a relation; with something set above it, it is a definition: \overset{\text{def}}{=}."""
        token = self.take()
        if token.kind == "relation":
            return token.text
        if token.text == "not":
            if not self.took("=", "relation"):
                self.fail("= after \\not")
            return "≠"
        self.skip_group()
        braced = self.took("{")
        relation = self.take()
        if relation.kind != "relation" or (braced and not self.took("}")):
            self.fail("a relation", relation)
        return ":=" if relation.text == "=" else relation.text


def _first(node: Node) -> Node:
    """Return what a statement starts with."""
    while isinstance(node, Related | Plus | Times):
        node = next(node.children())
    return node


def _merged(statements: list[Node], words: list[str], commas: list[bool]) -> tuple[tuple[Node, ...], tuple[str, ...]]:
    """Read W, V > 0 as one statement about a list, and k = 0, 1, 2 likewise; ``words[i]`` stand before statement i."""
    out, kept, waiting = list[Node](), [words[0]], list[Node]()
    for i, node in enumerate(statements):
        last = out[-1] if out else None
        if isinstance(last, Related) and commas[i] and isinstance(node, Digits | Blank):
            side = last.sides[-1]
            items = side.items if isinstance(side, Listed) else (side,)
            out[-1] = replace(last, sides=(*last.sides[:-1], Listed((*items, node), span=side.span)))
            kept[-1] = words[i + 1]
            continue
        if not isinstance(node, Related) and commas[i + 1] and not QUANTIFIERS & set(words[i].split()):
            waiting.append(node)
        elif waiting and isinstance(node, Related) and commas[i]:
            listed = Listed((*waiting, node.sides[0]), span=waiting[0].span)
            node, waiting = replace(node, sides=(listed, *node.sides[1:])), []
            del out[len(out) - len(listed.items) + 1 :]
            del kept[len(kept) - len(listed.items) + 1 :]
        else:
            waiting = []
        out.append(node)
        kept.append(words[i + 1])
    return tuple(out), tuple(kept)
