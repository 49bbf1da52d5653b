r"""Names with their marks, and scripts: accents, indices as text, transposes, inverses, powers, primes."""

from __future__ import annotations

import re
import unicodedata
from collections.abc import Callable
from dataclasses import replace
from fractions import Fraction

from derive.latex.alphabet import GREEK
from derive.latex.cursor import Cursor
from derive.latex.syntax import Digits, Fenced, Inverted, Name, Node, Over, Plus, Raised, Span, Transposed
from derive.latex.tokens import Token
from derive.latex.vocabulary import ACCENT_COMMANDS, COMBINING, ELLIPSES, FUNCTIONS, MARKS, ROMAN, STYLES, TRANSPOSES

Exponent = Callable[[Node, Span], Node]
WORD = re.compile(r"[A-Za-z0-9]+(?: [A-Za-z0-9]+)*")
UNDRESSED = STYLES | ROMAN | {"mathbb"}
LOOKAHEAD = 10  # tokens of a script that is told by its pattern


class Names(Cursor):
    """Reads letters, words in upright type, and what stands below and above them."""

    def expression(self) -> Node:
        """Read a sum; the grammar of sums builds on names."""
        raise NotImplementedError

    def argument(self) -> Node:
        """Read a group, or the single token that is the argument of a command."""
        raise NotImplementedError

    def upright(self) -> str:
        r"""Go past ``\mathrm{word}`` and return the word, or return nothing and stay."""
        start, token = self.at, self.look()
        braced = (
            token.text == "{" and token.kind == "sign" and self.look(1).text == "rm" and self.look(1).kind == "command"
        )
        if not braced and (token.kind != "command" or token.text not in ROMAN):
            return ""
        self.at += 2 if braced else 1
        if not braced and token.text != "rm" and not self.took("{"):
            word = self.look().text if self.look().kind == "letter" else ""
            self.at = self.at + 1 if word else start
            return word
        letters: list[str] = []
        while self.look().kind == "letter" and (braced or token.text != "rm" or not letters):
            letters.append(self.take().text)
        closed = token.text == "rm" or self.took("}")
        if not closed or not letters or (len(letters) > 1 and any(len(x) > 1 for x in letters)):
            self.at = start
            return ""
        return "".join(letters)

    # -------------------------------------------------------------------------------------------- indices
    def index(self) -> str:
        """Read what stands below a letter as text without braces, styles and spaces."""
        start, pieces, accents, depth = self.look(), list[str](), list[str](), 0
        while True:
            token = self.take()
            if token.text == "{" and token.kind == "sign":
                depth += 1
            elif token.text == "}" and token.kind == "sign" and depth:
                depth -= 1
            elif token.kind == "command" and token.text in ACCENT_COMMANDS:
                accents.append(COMBINING[ACCENT_COMMANDS[token.text]])
            elif token.kind != "command" or token.text not in UNDRESSED:
                pieces.append(self._piece(token) + "".join(reversed(accents)))
                accents.clear()
                if not depth:
                    self._one_digit(token, "_")
            if not depth and pieces:
                return unicodedata.normalize("NFC", "".join(pieces))
            if not depth and token.text == "}":
                self.fail("an index", start)

    def _piece(self, token: Token) -> str:
        if token.kind == "letter":
            return GREEK.get(token.text, token.text) if len(token.text) > 1 else token.text
        if token.kind == "number" or (token.kind == "sign" and token.text in "+-*/,:!'_^."):
            return token.text
        if token.kind == "word" and WORD.fullmatch(token.text):
            return token.text.replace(" ", "")
        if token.kind == "delimiter" and token.text in ("(", ")", "[", "]", "|"):
            return token.text
        if token.kind == "command" and token.text in MARKS:
            return MARKS[token.text]
        if token.kind == "command" and token.text in FUNCTIONS:
            return FUNCTIONS[token.text]
        if token.kind == "command" and token.text in ELLIPSES:
            return "…"
        self.fail("an index of letters, numbers and signs", token)

    def _one_digit(self, token: Token, mark: str) -> None:
        """Refuse x_10, which LaTeX sets as x_1 0."""
        if token.kind == "number" and len(token.text) > 1:
            one, rest = token.text[0], token.text[1:]
            self.ambiguous(token, f"{mark}{{{token.text}}}", f"{mark}{one} \\cdot {rest}")

    # -------------------------------------------------------------------------------------------- exponents
    def exponent(self) -> Exponent | str:
        """Read what stands above a letter or group: a transpose, an inverse, a power; a mark of the letter as text."""
        start = self.look()
        shape, after = self._shape()
        special = self._special(shape, start)
        if special is not None:
            self.at = after
            return special
        if start.text == "-" and start.kind == "sign":
            following = self.look(1)
            if following.start == start.end and following.kind in ("number", "letter", "command"):
                self.ambiguous(start, f"^{{-{following.text}}}", f"^{{-}} {following.text}")
            self.at += 1
            return "-"
        self._one_digit(start, "^")
        if start.kind == "delimiter":
            self.fail("an exponent in braces")
        power = self.argument()
        shape = _mark_of(power)
        special = self._special(shape, start) if shape else None
        if special is not None:
            return special
        return lambda body, span: self._raise(body, power, start, span)

    def _shape(self) -> tuple[tuple[str, ...], int]:
        """Return a short script as texts without braces and styles, and the place behind it."""
        texts, depth, i = list[str](), 0, self.at
        while i < self.at + LOOKAHEAD and i < len(self.tokens) - 1:
            token = self.tokens[i]
            i += 1
            if token.kind == "sign" and token.text in "{}":
                depth += 1 if token.text == "{" else -1
            elif token.kind == "command" and token.text in UNDRESSED:
                continue
            else:
                texts.append(token.text)
            if depth < 0 or (not depth and (texts or token.text == "}")):
                break
        return (tuple(texts), i) if not depth else ((), self.at)

    def _special(self, shape: tuple[str, ...], start: Token) -> Exponent | str | None:
        match shape:
            case (mark,) if mark in TRANSPOSES:
                return lambda body, span: Transposed(body, TRANSPOSES[mark], span=span)
            case ("-", "1"):
                return lambda body, span: Inverted(body, span=span)
            case ("-", mark) | ("-", "1", mark) if mark in TRANSPOSES:
                return lambda body, span: self._inverse_transpose(body, mark, span)
            case (mark, "/", "2") if mark in TRANSPOSES:
                half = Over(Digits(Fraction(1)), Digits(Fraction(2)))
                return lambda body, span: Transposed(Raised(body, half, span=span), TRANSPOSES[mark], span=span)
            case ("-",) if start.text == "{":
                return "-"
            case ("+",):
                return "+"
            case ("star",) | ("circ",):
                return MARKS[shape[0]]
            case ("(", one, ")") if one in "+-" or len(one) < 3:
                return f"({one})"
            case (word,) if WORD.fullmatch(word) and any(t.kind == "word" for t in self.tokens[self.at : self.at + 2]):
                return word.replace(" ", "")
            case (*letters,) if len(letters) > 1 and self._is_word(letters):
                return "".join(letters)
            case _:
                return None

    def _is_word(self, letters: list[str]) -> bool:
        """Return whether the script is set in upright letters or as text."""
        set_upright = any(t.kind == "word" or (t.kind == "command" and t.text in ROMAN) for t in
                          self.tokens[self.at : self.at + 3])  # fmt: skip
        return set_upright and all(len(x) == 1 and x.isalpha() for x in letters)

    def _inverse_transpose(self, body: Node, mark: str, span: Span) -> Node:
        if body == Name("e") and mark == "T":
            self.ambiguous(replace(body, span=span), "\\exp(-T)", "e^{-\\top}")
        return Transposed(Inverted(body, span=span), TRANSPOSES[mark], span=span)

    def _raise(self, body: Node, power: Node, start: Token, span: Span) -> Node:
        """Return a power; a matrix with ^t is a transpose or a power."""
        if power == Name("t") and not isinstance(body, Digits) and body != Name("e"):
            self.ambiguous(start, "a transpose ^\\top", "a power ^{(t)}")
        return Raised(body, power, span=span)

    # -------------------------------------------------------------------------------------------- marks together
    def marks(self) -> tuple[str, str, list[Exponent]]:
        """Read the scripts and primes behind a letter or group: index, mark above, and exponents in order."""
        sub, sup, exponents, raised = "", "", list[Exponent](), False
        while True:
            token = self.look()
            if token.text == "_" and token.kind == "sign":
                if sub:
                    self.fail("one index, all of it in braces")
                self.at += 1
                sub = self.index()
            elif token.text == "^" and token.kind == "sign":
                if raised:
                    self.fail("one exponent, all of it in braces")
                self.at += 1
                above = self.exponent()
                sup, exponents, raised = (above, [], True) if isinstance(above, str) else ("", [above], True)
            elif token.text == "'" or (token.kind == "command" and token.text in ("top", "dagger")):
                if len(exponents) > 1:
                    self.fail("one transpose")
                exponents.append(self._prime())
                raised = True
            else:
                return sub, sup, exponents

    def _prime(self) -> Exponent:
        token, mark = self.take(), "prime" if self.tokens[self.at - 1].text == "'" else self.tokens[self.at - 1].text
        if self.look().text == "'":
            self.ambiguous(token, "a second derivative \\ddot", "a transpose of a transpose")
        return lambda body, span: Transposed(body, mark, span=span)

    def indexed(self, node: Node, sub: str, sup: str, start: Token) -> Node:
        """Return a node with its index and its mark above."""
        if not sub and not sup:
            return node
        if isinstance(node, Name) and not (node.sub and sub) and not (node.sup and sup):
            return replace(node, sub=sub or node.sub, sup=sup or node.sup, span=self.span(start))
        if isinstance(node, Fenced) and node.fence in ("|", "‖", "[") and not sup:
            return replace(node, sub=sub, span=self.span(start))
        self.fail(f"a letter in front of the {'index ' + sub if sub else 'mark ' + sup}", start)


def _mark_of(power: Node) -> tuple[str, ...]:
    """Return the shape of a power that is a transpose or an inverse, whatever holds its letters together."""
    match power:
        case Name(letter, (), "", "") if letter in TRANSPOSES:
            return (letter,)
        case Plus((("-", Digits(value)),)) if value == 1:
            return ("-", "1")
        case Plus((("-", Name(letter, (), "", "")),)) if letter in TRANSPOSES:
            return ("-", letter)
        case Over(Name(letter, (), "", ""), Digits(value)) if letter in TRANSPOSES and value == 2:
            return (letter, "/", "2")
        case _:
            return ()
