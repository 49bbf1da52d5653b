r"""Operators: named functions, sums, integrals with their differentials, and derivatives."""

from __future__ import annotations

from dataclasses import replace

from derive.latex.application import momentary
from derive.latex.groups import ONE
from derive.latex.operands import Operands
from derive.latex.syntax import (
    Called,
    Differentiated,
    Digits,
    Fenced,
    Integrated,
    Listed,
    Name,
    Node,
    Over,
    Plus,
    Raised,
    Related,
    Summed,
    Times,
)
from derive.latex.tokens import Token, Unreadable
from derive.latex.vocabulary import FUNCTION_COMMANDS, MOMENTS, OPEN_FUNCTIONS, ROMAN, TRIGONOMETRIC

DIFFERENTIALS = (Name("d"), Name("partial"))
THROUGH = frozenset(("det", "tr", "exp"))  # f(X)^T is f(X^T), and for det any power


class Operators(Operands):
    """Reads what acts on the operands behind it."""

    def product(self, alone: bool = False) -> Node:
        """Read a product; ``alone`` says that a sum in braces may be one."""
        raise NotImplementedError

    def factor(self) -> Node:
        """Read an operand with its scripts and arguments."""
        raise NotImplementedError

    # -------------------------------------------------------------------------------------------- functions
    def function(self, function: str, start: Token) -> Node:
        """Read the arguments of a named function: in brackets, or a single factor."""
        if function == "arg" and self.look().text in ("min", "max"):
            function += self.take().text
        sub, power = self._below(), None
        if self.look().text == "^" and self.look().kind == "sign":
            power = self._power(function, start)
        if function in OPEN_FUNCTIONS and (sub is not None or function == "lim") and not self._listed_next():
            return Called(function, (self._following(start),), sub, span=self.span(start))
        token = self.look()
        if token.kind == "delimiter" and token.text in ("(", "[", "\\{") and self.starts_operand(token):
            node = self._bracketed(function, sub, start)
        else:
            node = Called(function, (self._single(function, start),), sub, span=self.span(start))
        return Raised(node, power, span=self.span(start)) if power is not None else node

    def _listed_next(self) -> bool:
        return self.look().kind == "delimiter" and self.look().text == "\\{"

    def _below(self) -> Node | None:
        """Read what stands below a function: a base, a variable, a relation."""
        if not self.took("_"):
            return None
        if self.look().text != "{":
            return self.argument()
        start = self.take()
        with self.inside(start):
            items = self.separated(self.relation)
            if not self.took("}"):
                self.fail(f"an operator or the }} to the {{ in column {start.start + 1}")
        return items[0] if len(items) == 1 else Listed(tuple(items))

    def _power(self, function: str, start: Token) -> Node:
        """Read the power of sin^2 x."""
        self.at += 1
        power = self.argument()
        if not isinstance(power, Digits):
            self.ambiguous(self.look(), f"the inverse function of {function}", f"a power of {function}(...)", start)
        return power

    def _bracketed(self, function: str, sub: Node | None, start: Token) -> Node:
        group = self.fenced()
        inner = group.body if isinstance(group, Fenced) else group
        arguments = inner.items if isinstance(inner, Listed) else (inner,)
        called = Called(function, arguments, sub, span=self.span(start))
        if self.look().text not in ("^", "'") or len(arguments) > 1 or function in OPEN_FUNCTIONS:
            return called
        token = self.look()
        raised = self.scripted(group, token)
        if function == "det" or (function in THROUGH and not isinstance(raised, Raised)):
            return Called(function, (raised,), sub, span=self.span(start))
        self.ambiguous(token, f"({function}(...))^n", f"{function}((...)^n)", start)

    def scripted(self, node: Node, start: Token) -> Node:
        """Read the scripts behind a node."""
        raise NotImplementedError

    def _single(self, function: str, start: Token) -> Node:
        r"""Read an argument without brackets: one factor, or for \sin, \ln and so on a product of numbers and times."""
        if self.look().kind == "sign" and self.look().text in "+-":
            self.fail(f"an argument of {function}; one with a sign needs brackets")
        with self.deeper(start):
            factors = [self.factor()]
            if isinstance(factors[0], Plus):
                self.refuse_hidden(factors[0])
            while function in TRIGONOMETRIC and self._goes_on() and all(map(_plain, factors)):
                factors.append(self.factor())
        if not all(map(_plain, factors)) and len(factors) > 1:
            self._two_readings(function, start)
        self._refuse_more(function, start)
        return factors[0] if len(factors) == 1 else Times(tuple(factors), span=self.span(start))

    def _goes_on(self) -> bool:
        return self.starts_operand(self.look()) and not self._function_next() and not self.at_differential()

    def _function_next(self) -> bool:
        token = self.look()
        return token.kind == "command" and (token.text in FUNCTION_COMMANDS or token.text in ROMAN)

    def _refuse_more(self, function: str, start: Token) -> None:
        """Refuse a factor behind an argument without brackets, which may belong to it."""
        stroke = self.look().text == "/" and self.look().kind == "sign"
        if stroke or self._goes_on():
            self._two_readings(function, start)

    def _two_readings(self, function: str, start: Token) -> None:
        if self.look().text == "/":
            self.ambiguous(self.look(), f"{function}(a/b)", f"({function} a)/b", start)
        self.ambiguous(self.look(), f"{function}(a b)", f"({function} a) b", start)

    # -------------------------------------------------------------------------------------------- sums and integrals
    def operator(self, token: Token) -> Node | None:
        """Read a sum or product over an index, or an integral."""
        if token.text in ("sum", "prod"):
            self.at += 1
            return self._sum(token)
        if token.text == "int":
            self.at += 1
            return self._integral(token)
        if token.text in ("underset", "overset", "stackrel"):
            return self._under(token)
        return None

    def _under(self, start: Token) -> Node:
        r"""Read ``\underset{L}{\min} J``."""
        if start.text != "underset":
            self.fail("a formula", start)
        self.at += 1
        sub = self.argument()
        braced = self.took("{")
        function, token = self.look(), self.look()
        word = self.upright()
        name = word or FUNCTION_COMMANDS.get(function.text, "")
        self.at += not word
        if name == "arg":
            name += self.take().text
        if name not in OPEN_FUNCTIONS or (braced and not self.took("}")):
            self.fail("max, min, inf, sup or lim above this", token)
        return Called(name, (self._following(start),), sub, span=self.span(start))

    def _following(self, start: Token) -> Node:
        """Read the product that an operator in front of it acts on."""
        with self.deeper(start):
            body = self.product()
        self.open_end = self.at
        return body

    def limits(self) -> tuple[Node | None, Node | None]:
        """Read what stands below and above a sign."""
        lower = upper = None
        while self.look().kind == "sign" and self.look().text in "_^":
            if self.look().text == "_":
                if lower is not None:
                    self.fail("one lower bound")
                lower = self._below()
            elif upper is None:
                self.at += 1
                upper = self.argument()
            else:
                self.fail("one upper bound")
        return lower, upper

    def _sum(self, start: Token) -> Node:
        lower, upper = self.limits()
        index = lower
        if isinstance(lower, Related) and lower.relations == ("=",):
            index, lower = lower.sides
        else:
            lower = None
        body = self._following(start)
        return Summed(body, index, lower, upper, start.text, span=self.span(start))

    def at_differential(self, first: bool = False) -> bool:
        r"""Return whether a differential stands here: d tau, \mathrm d tau, {\rm d} tau.

        It is none if its letter is raised, nor if it is applied, unless it comes first behind the sign.
        """
        i = self._behind_d(self.at)
        if i is None:
            return False
        variable, after = self.tokens[i], self.tokens[min(i + 1, len(self.tokens) - 1)]
        if variable.kind != "letter" or (variable.text == "d" and after.kind == "letter"):
            return False
        applied = after.text == "(" and variable.text not in MOMENTS
        return after.text not in ("^", "'") and (first or not applied)

    def _behind_d(self, at: int) -> int | None:
        """Return the place behind a d of a differential, or None."""
        texts = [t.text for t in self.tokens[at : at + 4]]
        if texts[:1] == ["d"]:
            return at + 1
        if texts[:1] and texts[0] in ROMAN and texts[1:2] == ["d"]:
            return at + 2
        if texts[:1] and texts[0] in ROMAN and texts[1:4] == ["{", "d", "}"]:
            return at + 4
        return at + 4 if texts == ["{", "rm", "d", "}"] else None

    def differential(self) -> Node:
        """Go past a differential and return its variable."""
        self.at = self._behind_d(self.at) or self.at
        token = self.take()
        name = Name(token.text, span=(token.start, token.end))
        if not self.took("_"):
            return name
        return replace(name, sub=self.index(), span=self.span(token))

    def _integral(self, start: Token) -> Node:
        lower, upper = self.limits()
        if self.at_differential(first=True):
            variable = self.differential()
            empty = self.at_differential() or not self.starts_operand(self.look())
            body = ONE if empty else self._following(start)
        else:
            body, variable = self._integrand(start)
        return Integrated(body, variable, lower, upper, span=self.span(start))

    def _integrand(self, start: Token) -> tuple[Node, Node]:
        """Read the sum behind the sign up to the differential, which may stand in a fraction."""
        holder: list[Node | None] = [None]
        outer, self.integral, self.numerator = (self.integral, self.numerator), holder, False
        with self.deeper(start):
            body = self.expression()
        variable = holder[0]
        if variable is not None:
            self.open_end = self.at
        elif self.at_differential():
            variable = self.differential()
        else:
            self.fail("an operator or the differential of this integral, such as d\\tau")
        self.integral, self.numerator = outer
        if self.at_differential() and not self.ends_integrand():
            self.ambiguous(self.look(), "the differential of another integral", "a factor d")
        return body, variable

    def ends_integrand(self) -> bool:
        """Return whether a differential stands here, and an integral is open for it."""
        return bool(self.integral) and self.integral[0] is None and self.at_differential()

    # -------------------------------------------------------------------------------------------- fractions
    def fraction(self) -> Node:
        """Read a fraction; with d or partial on top and below it is a derivative."""
        start = self.take()
        measured = (
            self.integral and self.integral[0] is None and self.look().text == "{" and not self._over_differential()
        )
        top = self._measure() if measured else self.argument()
        bottom = self.argument()
        derivative = self.derivative(top, bottom, start)
        if derivative is None and isinstance(bottom, Times) and bottom.factors[0] in DIFFERENTIALS:
            raise Unreadable(start.start, "a derivative, such as \\frac{dx}{dt}, above this d", "another numerator")
        return derivative or Over(top, bottom, span=self.span(start))

    def _measure(self) -> Node:
        """Read the top of a fraction that may hold the differential of the integral around it."""
        start, integral = self.take(), self.integral
        with self.inside(start):
            self.integral, self.numerator = integral, True
            top = self.expression()
            if not self.took("}"):
                self.fail(f"an operator or the }} to the {{ in column {start.start + 1}")
        return top

    def _over_differential(self) -> bool:
        """Return whether the fraction that starts here has a d below, so that it is a derivative."""
        depth, i = 0, self.at
        while i < len(self.tokens) - 1:
            depth += {"{": 1, "}": -1}.get(self.tokens[i].text, 0) if self.tokens[i].kind == "sign" else 0
            i += 1
            if not depth:
                return self.below_is_d(i)
        return False

    def below_is_d(self, at: int) -> bool:
        """Return whether dt or partial x stands at a place, with or without braces."""
        inside = at + 1 if self.tokens[min(at, len(self.tokens) - 1)].text == "{" else at
        behind = self._behind_d(inside)
        if behind is None:
            return self.tokens[min(inside, len(self.tokens) - 1)].text == "partial"
        return self.tokens[min(behind, len(self.tokens) - 1)].kind == "letter"

    def derivative(self, top: Node, bottom: Node, start: Token) -> Node | None:
        """Return the derivative that a top and a bottom with d stand for, or None."""
        below = bottom.factors if isinstance(bottom, Times) else ()
        above = top.factors if isinstance(top, Times) else (top,)
        if len(below) != 2 or below[0] not in DIFFERENTIALS:
            return None
        sign, order = (above[0].body, above[0].exponent) if isinstance(above[0], Raised) else (above[0], ONE)
        variable, degree = (below[1].body, below[1].exponent) if isinstance(below[1], Raised) else (below[1], ONE)
        if sign != below[0] or order != degree or not isinstance(order, Digits) or order.value.denominator != 1:
            return None
        partial, times = sign == Name("partial"), int(order.value)
        if not 1 <= times <= 9:
            return None
        body = above[1] if len(above) == 2 else Times(above[1:], span=top.span)
        if len(above) == 1:
            body = self.differentiated(start)
        return Differentiated(body, variable, times, partial, span=self.span(start))

    def differentiated(self, start: Token) -> Node:
        """Read what d/dt acts on: the product behind it."""
        token = self.look()
        body = self._following(start)
        if isinstance(body, Times) and isinstance(body.factors[0], Fenced) and body.factors[0].fence in ("(", "[", "{"):
            self.ambiguous(token, "d/dt of the product", "d/dt of the brackets alone")
        return body


def _plain(node: Node) -> bool:
    """Return whether a factor belongs to the argument of a function without brackets."""
    return momentary(node) or node == Name("pi")
