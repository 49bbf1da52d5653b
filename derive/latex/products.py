r"""Sums and products: signs, juxtaposition, strokes, and letters with the brackets behind them."""

from __future__ import annotations

from derive.latex.application import Reading, reading
from derive.latex.groups import ONE
from derive.latex.names import Exponent
from derive.latex.operators import DIFFERENTIALS, Operators
from derive.latex.syntax import (
    Applied,
    Differentiated,
    Fenced,
    Listed,
    Matrix,
    Name,
    Node,
    Over,
    Plus,
    Raised,
    Summed,
    Times,
)
from derive.latex.tokens import Token
from derive.latex.vocabulary import NO_OPERANDS, SIGNS_OF_MULTIPLICATION

SIGNS = {"+": "+", "-": "-", "pm": "±", "mp": "∓"}


class Products(Operators):
    """Reads sums, products and factors."""

    # -------------------------------------------------------------------------------------------- sums
    def expression(self) -> Node:
        """Read a sum."""
        start = self.look()
        addends: list[tuple[str, Node]] = [(self._sign() or "+", self.product(alone=True))]
        signed = start.text in SIGNS and start.kind in ("sign", "command")
        while not (self.integral and self.integral[0] is not None):
            sign = self._sign()
            if not sign:
                break
            self._refuse_spilled_index(addends[-1][1])
            addends.append((sign, self.product(alone=True)))
        if len(addends) == 1 and not signed:
            return addends[0][1]
        if any(isinstance(addend, Plus) and sign != "+" for sign, addend in addends):
            self.refuse_hidden(start)
        return Plus(tuple(_spliced(addends)), span=self.span(start))

    def _sign(self) -> str:
        token = self.look()
        if token.text in SIGNS and token.kind in ("sign", "command"):
            self.at += 1
            return SIGNS[token.text]
        return ""

    def _refuse_spilled_index(self, addend: Node) -> None:
        """Refuse sum_i a_i + b_i, where the second may or may not be summed."""
        last = addend.factors[-1] if isinstance(addend, Times) else addend
        if not isinstance(last, Summed) or not isinstance(last.index, Name):
            return
        following = self.tokens[self.at : self.at + 3]
        if [t.text for t in following[1:]] == ["_", last.index.letter]:
            self.ambiguous(following[0], "\\sum (a_i + b_i)", "(\\sum a_i) + b_i", last)

    # -------------------------------------------------------------------------------------------- products
    def product(self, alone: bool = False) -> Node:
        """Read a product: factors side by side or with a sign, and divisions with a stroke.

        A sum in braces may stand alone, as an addend.
        """
        start, factors, signed = self.look(), list[Node](), False
        while True:
            token = self.look()
            if self.numerator and self.ends_integrand():
                self.integral[0] = self.differential()
                signed = False
            elif factors and not signed and token.text in SIGNS_OF_MULTIPLICATION and token.kind in ("sign", "command"):
                self.at += 1
                signed = True
            elif factors and not signed and token.text == "/" and token.kind == "sign":
                self.at += 1
                factors = self._divided(factors, start)
            elif signed or (self.starts_operand(token) and not self.ends_integrand()):
                if factors and not signed and token.kind == "number":
                    self._refuse_number(token)
                factors.extend(self._factors())
                signed = False
            else:
                break
        if not factors:
            if self.numerator and self.integral[0] is not None:
                return ONE
            self.fail("a formula")
        flat = _flat(factors)
        if any(isinstance(f, Plus) for f in flat) and not (alone and len(flat) == 1):
            self.refuse_hidden(start)
        return flat[0] if len(flat) == 1 else Times(flat, span=self.span(start))

    def starts_operand(self, token: Token) -> bool:
        """Return whether an operand can start with a token."""
        if token.kind == "delimiter":
            bar = token.text in ("|", "‖") and (token.side == "left" or (not token.side and self.bar != token.text))
            return bar or token.text in ("(", "[", "\\{")
        if token.kind == "command":
            return token.text not in NO_OPERANDS
        return token.kind in ("letter", "number", "begin") or (token.text == "{" and token.kind == "sign")

    def _refuse_number(self, token: Token) -> None:
        self.ambiguous(token, f"\\cdot {token.text}", f"an index _{{{token.text}}}")

    def _divided(self, factors: list[Node], start: Token) -> list[Node]:
        """Read what stands behind a stroke; a factor behind it has two readings."""
        at = next((i for i, f in enumerate(factors) if f in DIFFERENTIALS), None)
        if at is not None and self.below_is_d(self.at):
            return [*factors[:at], self._derivative_by_stroke(factors[at:], start)]
        top, bottom = _flat(factors), self.factor()
        if any(isinstance(f, Plus) for f in (*top, bottom)):
            self.refuse_hidden(start)
        token = self.look()
        if token.text == "/" and token.kind == "sign":
            self.ambiguous(token, "a/(b/c)", "(a/b)/c", start)
        grouped = token.kind == "delimiter" and token.text in ("(", "[", "\\{")
        closed = isinstance(bottom, Fenced | Matrix) and not grouped
        if self.starts_operand(token) and not self.ends_integrand() and not closed:
            self.ambiguous(token, "a/(b c)", "(a/b) c", start)
        return [Over(top[0] if len(top) == 1 else Times(top), bottom, span=self.span(start))]

    def _derivative_by_stroke(self, above: list[Node], start: Token) -> Node:
        """Read dX/dt and d/dt X."""
        sign, token = above[0], self.look()
        below = (self.atom(), self.factor())
        rest = _flat(above[1:])
        body = rest[0] if len(rest) == 1 else Times(rest) if rest else self.differentiated(token)
        return Differentiated(body, below[1], 1, sign == Name("partial"), span=self.span(start))

    # -------------------------------------------------------------------------------------------- factors
    def factor(self) -> Node:
        """Read an operand with its scripts and arguments, where a product has two readings."""
        start = self.look()
        factors = self._factors()
        if len(factors) > 1:
            self.ambiguous(start, "the letter with the group behind it", "the letter alone")
        return factors[0]

    def _factors(self) -> list[Node]:
        """Read an operand with its scripts; a letter and a group behind it may be one factor or two."""
        start = self.look()
        node = self.atom()
        before = node.factors[:-1] if isinstance(node, Times) else ()
        node = node.factors[-1] if isinstance(node, Times) else node
        sub, sup, exponents = self.marks()
        return [*before, *self._applied(self.indexed(node, sub, sup, start), exponents, start)]

    def _applied(self, node: Node, exponents: list[Exponent], start: Token) -> list[Node]:
        """Read the group behind a letter as its arguments, or as a factor of its own."""
        token = self.look()
        if not isinstance(node, Name) or token.kind != "delimiter" or not self.starts_operand(token):
            return [self._raised(node, exponents, start)]
        if node.letter == "E" and not exponents and token.text in ("[", "\\{") and not node.sub:
            return [self.scripted(self.expectation(start), start)]
        head = self._raised(node, exponents, start)
        if token.text not in ("(", "[") or (isinstance(head, Raised) and node == Name("e")):
            return [head]
        group = self.fenced()
        if isinstance(group, Fenced) and group.fence in ("(", "[") and self._applies(node, group):
            arguments = group.body.items if isinstance(group.body, Listed) else (group.body,)
            applied = Applied(head, arguments, span=self.span(start))
            return [self.scripted(applied, start)]
        return [head, self.scripted(group, token)]

    def _applies(self, head: Name, group: Fenced) -> bool:
        found = reading(head, group, self.functions)
        if found is Reading.BOTH:
            if isinstance(group.body, Name) and group.body.sup and self.look().text in ("^", "'"):
                return False  # brackets that make room for an exponent: F (P^-)^{-1}
            self.ambiguous(head, f"a product, {head.letter} \\cdot (...)", f"{head.letter} as a function")
        return found is Reading.APPLIED

    def scripted(self, node: Node, start: Token) -> Node:
        """Read the scripts behind a node."""
        sub, sup, exponents = self.marks()
        return self._raised(self.indexed(node, sub, sup, start), exponents, start)

    def _raised(self, node: Node, exponents: list[Exponent], start: Token) -> Node:
        for exponent in exponents:
            node = exponent(node, self.span(start))
        return node


def _flat(factors: list[Node]) -> tuple[Node, ...]:
    """Dissolve products that only braces hold together."""
    return tuple(f for factor in factors for f in (factor.factors if isinstance(factor, Times) else (factor,)))


def _spliced(addends: list[tuple[str, Node]]) -> list[tuple[str, Node]]:
    """Dissolve sums that only braces hold together."""
    out: list[tuple[str, Node]] = []
    for sign, node in addends:
        out.extend(node.addends if sign == "+" and isinstance(node, Plus) else [(sign, node)])
    return out
