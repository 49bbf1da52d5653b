r"""Groups: brackets and bars, braces, matrices and definitions by cases."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction
from typing import NoReturn

from derive.latex.names import Names
from derive.latex.syntax import Blank, Cases, Digits, Fenced, Given, Listed, Matrix, Name, Node, Plus, Related, Times
from derive.latex.tokens import Token, Unreadable
from derive.latex.vocabulary import CLOSING, MATRICES, SIGNS_OF_MULTIPLICATION, STYLES

FENCES = {"(": "(", "[": "[", "\\{": "{", "|": "|", "‖": "‖"}
MULTIPLYING = SIGNS_OF_MULTIPLICATION | {"/"}
SCRIPTS = frozenset(("^", "_", "'"))
ONE = Digits(Fraction(1))


class Groups(Names):
    """Reads what stands between an opening and a closing mark."""

    def atom(self) -> Node:
        """Read an operand without its scripts."""
        raise NotImplementedError

    # -------------------------------------------------------------------------------------------- brackets
    def fenced(self) -> Fenced | Matrix:
        """Read a group between brackets or bars; a bare array between brackets is a matrix."""
        start = self.take()
        if start.text == "|" and not start.side and self.look().text == "|" and self.look().start == start.end:
            return self._doubled(start)
        with self.inside(start, start.text if start.text in ("|", "‖") else ""):
            body = self.content(start)
            close = self.look()
            fence = self._closed(start, close, body)
            self.at += 1
        if isinstance(body, Matrix) and not body.fence:
            return replace(body, fence=fence, span=self.span(start))
        return Fenced(body, fence, span=self.span(start))

    def _doubled(self, start: Token) -> Fenced:
        """Read a norm that is written with two bars on each side."""
        self.at += 1
        with self.inside(start, "|"):
            body = self.expression()
            if not (self.took("|", "delimiter") and self.took("|", "delimiter")):
                self.fail("two bars that end the norm, or \\lVert \\rVert")
        return Fenced(body, "‖", span=self.span(start))

    def _closed(self, start: Token, close: Token, body: Node) -> str:
        """Return the fence if a token closes the group, else raise what was expected."""
        wanted = CLOSING[start.text]
        sized = {"left": "right"}.get(start.side, "")
        if close.kind == "delimiter" and close.side == sized and close.text == wanted:
            return FENCES[start.text]
        halves = start.text in ("(", "[") and close.text in (")", "]") and close.kind == "delimiter"
        if halves and isinstance(body, Listed) and len(body.items) == 2:
            return start.text + close.text
        right = " with its size" * bool(sized)
        self.fail(f"an operator or the {wanted}{right} to the {start.text} in column {start.start + 1}")

    def content(self, start: Token) -> Node:
        """Read what stands between brackets: one thing, several with commas, or one under a condition."""
        items = self.separated(self._item)
        body = items[0] if len(items) == 1 else Listed(tuple(items), span=self.span(start))
        if self.look().text == "|" and self.look().side == "middle":
            self.at += 1
            items = self.separated(self._item)
            condition = items[0] if len(items) == 1 else Listed(tuple(items))
            return Given(body, condition, span=self.span(start))
        return body

    def _item(self) -> Node:
        token = self.look()
        alone = self.look(1).text in (")", "]", "\\}", ",", "|")
        if alone and token.kind == "command" and token.text in ("cdot", "bullet"):
            self.at += 1
            return Blank("·", span=(token.start, token.end))
        return self.expression()

    # -------------------------------------------------------------------------------------------- groups
    def argument(self) -> Node:
        """Read a group in braces, or the single token that is the argument of a command."""
        token = self.look()
        while token.kind == "command" and token.text in STYLES:
            self.at += 1
            token = self.look()
        if token.kind == "number" and len(token.text) > 1 and "." not in token.text:
            self.tokens[self.at] = replace(token, text=token.text[1:], start=token.start + 1)
            return Digits(Fraction(int(token.text[0])), span=(token.start, token.start + 1))
        if token.kind != "sign" or token.text != "{":
            with self.deeper(token):
                return self.atom()
        self.at += 1
        with self.inside(token):
            node = self.expression()
            if not self.took("}"):
                self.fail(f"an operator or the }} to the {{ in column {token.start + 1}")
        return node

    def group(self, styled: bool = False) -> Node:
        r"""Read braces that only group: what they hold must be seen without them.

        A script behind a product in bold letters is one of its last letter, as the page shows it: \mathbf{PA}^\top.
        """
        start = self.look()
        node = self.argument()
        after, ended = self.look(), self.open_end == self.at - 1
        scripted = after.text in SCRIPTS
        sticks = isinstance(node, Times) and not (styled and isinstance(node.factors[-1], Name))
        spills = ended and (scripted or after.text in MULTIPLYING or self.starts_operand(after))
        if spills or (scripted and (sticks or isinstance(node, Plus))):
            self.refuse_hidden(start)
        return node

    def refuse_hidden(self, start: Token | Node) -> NoReturn:
        """Raise the error that braces group what is seen as no group."""
        self.ambiguous(start, "a group in brackets ( )", "no group, as braces do not show")

    def starts_operand(self, token: Token) -> bool:
        """Return whether an operand can start with a token."""
        raise NotImplementedError

    # -------------------------------------------------------------------------------------------- matrices
    def matrix(self) -> Matrix:
        """Read a matrix, row by row; all rows have the same number of cells."""
        begin = self.take()
        if "|" in begin.side:
            self.fail("a matrix without rules, as [A|B; C|D] may be a block matrix or a transfer function", begin)
        with self.inside(begin):
            rows = self._rows(begin)
            self.at += 1
        for row in rows:
            if len(row) != len(rows[0]):
                expected = f"{len(rows[0])} cells in each row, as in the first"
                raise Unreadable(row[0].span[0], expected, f"a row with {len(row)}")
        return Matrix(tuple(map(tuple, rows)), MATRICES[begin.text], span=self.span(begin))

    def _rows(self, begin: Token) -> list[list[Node]]:
        rows: list[list[Node]] = [[self._cell()]]
        while self.look().kind != "finish":
            token = self.take()
            if token.kind == "cell":
                rows[-1].append(self._cell())
            elif token.kind == "row" and self.look().kind != "finish":
                rows.append([self._cell()])
            elif token.kind != "row":
                self.fail(f"an operator, &, \\\\ or \\end{{{begin.text}}}", token)
        return rows

    def _cell(self) -> Node:
        token = self.look()
        if token.kind in ("cell", "row", "finish"):
            return Blank("", span=(token.start, token.start))
        if token.text in ("*", "ast", "star", "bullet") and self.look(1).kind in ("cell", "row", "finish"):
            self.at += 1
            return Blank("*", span=(token.start, token.end))
        return self.expression()

    def cases(self) -> Cases:
        """Read a definition by cases: values and their conditions."""
        begin, rows = self.take(), list[tuple[Node, Related | None]]()
        with self.inside(begin):
            while self.look().kind != "finish":
                rows.append((self.expression(), self._condition()))
                if self.look().kind not in ("row", "finish"):
                    self.fail(f"the end of the row or \\end{{{begin.text}}}")
                while self.look().kind == "row":
                    self.at += 1
            self.at += 1
        return Cases(tuple(rows), span=self.span(begin))

    def relation(self) -> Node:
        """Read a chain of relations."""
        raise NotImplementedError

    def _condition(self) -> Related | None:
        condition = None
        while self.look().kind in ("cell", "word", "wide") or self.look().text in (",", ".", ";"):
            self.at += 1
        if self.look().kind not in ("row", "finish"):
            token, condition = self.look(), self.relation()
            if not isinstance(condition, Related) or condition.sides[0] == Blank():
                self.fail("a relation as the condition of a case", token)
        while self.look().kind == "word" or self.look().text in (",", ".", ";"):
            self.at += 1
        return condition
