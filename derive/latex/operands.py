r"""Operands: groups in brackets, fractions, roots, matrices, cases, and letters that are applied to arguments."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction
from typing import NoReturn

from derive.latex.names import Names
from derive.latex.syntax import (
    Barred,
    Blank,
    Cases,
    Digits,
    Dotted,
    Expected,
    Fenced,
    Given,
    Infinite,
    Listed,
    Matrix,
    Name,
    Node,
    Plus,
    Radical,
    Related,
    Times,
)
from derive.latex.tokens import Token, Unreadable
from derive.latex.vocabulary import (
    ACCENT_COMMANDS,
    BLACKBOARD,
    BRACED,
    CLOSING,
    DOTS,
    ELLIPSES,
    EXPECTATIONS,
    FRACTIONS,
    FUNCTION_COMMANDS,
    FUNCTIONS,
    MATRICES,
    NO_OPERANDS,
    ROMAN,
    SIGNS_OF_MULTIPLICATION,
    SIZES,
    STYLES,
    UNMARKED,
)

FENCES = {"(": "(", "[": "[", "\\{": "{", "|": "|", "‖": "‖"}
MULTIPLYING = SIGNS_OF_MULTIPLICATION | {"/"}
SCRIPTS = frozenset(("^", "_", "'"))
ONE = Digits(Fraction(1))


class Operands(Names):
    """Reads what a sum or product is made of."""

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

    # -------------------------------------------------------------------------------------------- atoms
    def atom(self) -> Node:
        """Read an operand without its scripts."""
        token = self.look()
        if token.kind == "letter":
            return self.letter()
        if token.kind == "number":
            return self.number()
        if token.kind == "delimiter" and self.starts_operand(token):
            return self.fenced()
        if token.kind == "begin":
            return self.cases() if token.text in ("cases", "dcases") else self.matrix()
        if token.text == "{" and token.kind == "sign":
            return self.upright_name() or self.group()
        if token.kind == "command":
            return self.command()
        self.fail("a formula")

    def number(self) -> Digits:
        """Read a number; 1e-3 would be a product on the page."""
        token, letter, sign = self.take(), self.look(), self.look(1)
        if token.text.count(".") > 1:
            self.fail("a number with one point", token)
        beside = letter.text in ("e", "E") and letter.start == token.end and sign.start == letter.end
        if beside and (sign.kind == "number" or (sign.text in "+-" and self.look(2).start == sign.end)):
            self.ambiguous(token, f"{token.text} \\cdot 10^n", f"{token.text} e + n")
        return Digits(Fraction(token.text), span=(token.start, token.end))

    def letter(self) -> Node:
        """Read a letter; a run of letters that spells a function is refused."""
        token, run = self.take(), ""
        if len(token.text) == 1:
            i = self.at - 1
            before = self.tokens[i - 1] if i else token
            if before.kind != "letter" or before.end != token.start or len(before.text) > 1:
                while self.tokens[i].kind == "letter" and (not run or self.tokens[i].start == self.tokens[i - 1].end):
                    run += self.tokens[i].text if len(self.tokens[i].text) == 1 and len(run) < 8 else "?"
                    i += 1
        if run in UNMARKED or (len(run) > 3 and run[1:] in ("hat", "bar", "tilde", "dot")):
            self.ambiguous(token, rf"\{run}", " ".join(run))
        return Name(token.text, span=(token.start, token.end))

    def upright_name(self) -> Node | None:
        r"""Read ``\mathrm{x}`` or ``{\rm x}`` as a letter or a function; None if there is none."""
        start = self.look()
        word = self.upright()
        if not word:
            return None
        if word in FUNCTIONS:
            return self.function(FUNCTIONS[word], start)
        if word in EXPECTATIONS and self.look().text in ("[", "(", "\\{"):
            return self.expectation(start)
        if len(word) > 1 and word[1:] in FUNCTIONS:
            name = Name(word[0], span=(start.start, start.end))
            return Times((name, self.function(FUNCTIONS[word[1:]], start)), span=self.span(start))
        return Name(word, span=self.span(start))

    def function(self, function: str, start: Token) -> Node:
        """Read the arguments of a named function."""
        raise NotImplementedError

    def operator(self, token: Token) -> Node | None:
        """Read a sum over an index, an integral or a product over an index; None if it is none of them."""
        raise NotImplementedError

    def command(self) -> Node:
        """Read an operand that starts with a command."""
        token = self.look()
        name = token.text
        if name in ROMAN:
            return self.upright_name() or self._styled()
        if name in STYLES:
            return self._styled()
        if name == "mathbb":
            return self._blackboard()
        if name in ACCENT_COMMANDS:
            return self._accented()
        if name in FRACTIONS:
            return self.fraction()
        if name == "sqrt":
            return self._root()
        if name in FUNCTION_COMMANDS:
            self.at += 1
            return self.function(FUNCTION_COMMANDS[name], token)
        if name in BRACED:
            return self._braced()
        if name == "infty":
            self.at += 1
            return Infinite(span=(token.start, token.end))
        if name in ELLIPSES:
            self.at += 1
            return Blank("…", span=(token.start, token.end))
        if name in ("partial", "jmath", "imath", "hbar"):
            self.at += 1
            return Name({"jmath": "j", "imath": "i"}.get(name, name), span=(token.start, token.end))
        operator = self.operator(token)
        if operator is None:
            known = name in NO_OPERANDS or name in SIZES
            self.fail("a formula" if known else "a command that is known here, or a macro that the document defines")
        return operator

    def _styled(self) -> Node:
        r"""Read ``\mathbf{x}``: what it holds, without the style."""
        start = self.take()
        if self.look().text == "{" and self.look().kind == "sign":
            node = self.upright_name() or self.group(styled=True)
        else:
            with self.deeper(start):
                node = self.atom()
        if start.text in ("mathbf", "mathsf", "mathcal") and node == Name("E") and self.look().text in ("[", "\\{"):
            return self.expectation(start)
        return replace(node, span=self.span(start))

    def _blackboard(self) -> Node:
        start = self.take()
        braced = self.took("{")
        letter = self.take()
        if (braced and not self.took("}")) or (letter.text not in BLACKBOARD and letter.text != "E"):
            self.fail("one of the letters E, R, C, N, Z, Q, S, P, V, I", letter)
        if letter.text == "E":
            return self.expectation(start)
        if letter.text == "1":
            return replace(ONE, span=self.span(start))
        return Name(BLACKBOARD[letter.text], span=self.span(start))

    def expectation(self, start: Token) -> Node:
        """Read the brackets, bars or norm of an expectation."""
        token = self.look()
        if token.kind != "delimiter" or not self.starts_operand(token):
            self.fail("a bracket after the E of an expectation")
        body = self.fenced()
        inner = body.body if isinstance(body, Fenced) and token.text in ("(", "[", "\\{") else body
        return Expected(inner, span=self.span(start))

    def _accented(self) -> Node:
        start = self.take()
        accent = ACCENT_COMMANDS[start.text]
        node = self.argument()
        if isinstance(node, Name) and not node.sup:
            return replace(node, accents=(*node.accents, accent), span=self.span(start))
        if accent in DOTS:
            return Dotted(node, DOTS[accent], span=self.span(start))
        if accent == "bar":
            return Barred(node, span=self.span(start))
        self.fail(f"a letter under \\{start.text}", start)

    def _root(self) -> Node:
        start, index = self.take(), None
        if self.look().text == "[":
            self.at += 1
            index = self.expression()
            if not self.took("]", "delimiter"):
                self.fail("the ] of the index of this root", self.look())
        if self.look().text == "(":
            inner = self.fenced()
            return Radical(inner.body if isinstance(inner, Fenced) else inner, index, span=self.span(start))
        return Radical(self.argument(), index, span=self.span(start))

    def _braced(self) -> Node:
        r"""Read ``\underbrace{X}_{text}`` as X."""
        start = self.take()
        node = self.argument()
        if self.took(BRACED[start.text]):
            self.index()
        return replace(node, span=self.span(start))

    def fraction(self) -> Node:
        """Read a fraction, or a derivative that is written as one."""
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
            if not isinstance(condition, Related):
                self.fail("a relation as the condition of a case", token)
        while self.look().kind == "word" or self.look().text in (",", ".", ";"):
            self.at += 1
        return condition
