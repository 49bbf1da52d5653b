r"""Operands: letters, numbers, accents, styles, roots, expectations."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction

from derive.latex.groups import ONE, Groups
from derive.latex.syntax import Barred, Blank, Digits, Dotted, Expected, Fenced, Infinite, Name, Node, Radical, Times
from derive.latex.tokens import Token
from derive.latex.vocabulary import (
    ACCENT_COMMANDS,
    BLACKBOARD,
    BRACED,
    DOTS,
    ELLIPSES,
    EXPECTATIONS,
    FRACTIONS,
    FUNCTION_COMMANDS,
    FUNCTIONS,
    NO_OPERANDS,
    ROMAN,
    SIZES,
    STYLES,
    UNMARKED,
)


class Operands(Groups):
    """Reads what a sum or product is made of."""

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
