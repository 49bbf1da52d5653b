"""Read the syntax of a formula as typed terms of a theory."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import fields, replace
from typing import TYPE_CHECKING

from derive.interpret import arithmetic, functions, operators, powers
from derive.interpret.names import derivatives, look_up, spell, unknown
from derive.interpret.shapes import NotUnderstood, Shapes, Typed
from derive.interpret.times import difference, index_of, literal, time_of
from derive.latex import latex, plain
from derive.latex import syntax as s
from derive.latex.alphabet import GREEK
from derive.spectral import At
from derive.terms import Delta, Dot, Glyph, Symbol, Term

if TYPE_CHECKING:
    from derive.theory.claims.base import ClaimTheory

EXTREME = {"underline lambda": True, "bar lambda": False, "lambda_min": True, "lambda_max": False}
GREEK_NUMBERS = frozenset("αβγδεζηθικλμνξοπρστυφχψωϵ")


class Reader:
    """Read formulas in one theory; what is found of shapes and new letters is shared between them."""

    def __init__(self, theory: ClaimTheory, *, scalar: bool = False, notation: Mapping[str, str] | None = None) -> None:
        self.theory, self.scalar, self.notation = theory, scalar, notation or {}
        self.shapes = Shapes()
        self.new: dict[str, Symbol] = {}
        self.functions: dict[str, tuple[str, s.Node]] = {}
        self.roots: dict[str, tuple[Symbol, Symbol]] = {}
        self.blocks: dict[str, s.Node] = {}
        self.eigenvalues: dict[str, tuple[Symbol, Term, str]] = {}
        self.sizes: dict[str, str] = {}
        self.times: list[str] = []
        self.moving: frozenset[str] = frozenset()
        self.open = False  # whether a letter that the theory does not know is a new one

    def read(self, node: s.Node) -> Typed:
        """Return the typed meaning of a node.

        Raises:
            NotUnderstood: it has none, or two.
            Misfit: its shapes do not fit.
        """
        handler = HANDLERS.get(type(node))
        try:
            if handler is None:
                raise NotUnderstood(f"{KINDS.get(type(node), 'this')} has no meaning here; expected a term")
            return handler(node, self)
        except NotUnderstood as error:
            error.span = error.span or node.span
            raise

    def call(self, function: str, arguments: list[Typed]) -> Typed:
        """Return a named function of terms that are read already."""
        return functions.call(function, arguments, self)

    # -------------------------------------------------------------------------------------------- names
    def typed(self, term: Term) -> Typed:
        """Return a letter with its shape; where all dimensions are 1, the only eigenvalue of A is A."""
        if self.scalar and isinstance(term, Symbol) and term.name == "λ":
            term = self.theory.names["A"]
        if self.scalar or not isinstance(term, Symbol) or term.scalar:
            return term, None
        return term, (term.rows, term.cols)

    def named(self, name: s.Name) -> Typed | None:
        """Return what a name stands for; None if nothing."""
        spelled = spell(name, self.notation)
        if spelled in self.blocks:
            return self.read(self.blocks[spelled])
        term = self.new.get(spelled)
        if term is None and spelled in self.moving:
            term = self.theory.names.get(spelled + "()")
        if term is None:
            term = look_up(spelled, self.theory)
        return None if term is None else self.typed(term)

    def name(self, node: s.Name) -> Typed:
        """Read a letter, with dots for its derivatives."""
        found = self.named(node)
        if found is None:
            found = self._other(node)
        term, shape = found
        for _ in range(derivatives(node)):
            term = Dot(term)
        return term, shape

    def _other(self, node: s.Name) -> Typed:
        spelled = spell(node, self.notation)
        letter, _, sub = spelled.partition("_")
        if letter == "I" and not node.accents and not node.sup:
            typed = operators.identity(self)
            if sub and typed[1] is not None:
                self.shapes.same(typed[1][0], sub)
            return typed
        if spelled == "t" and any(
            "()" in name or (isinstance(term, Symbol) and term.args) for name, term in self.theory.names.items()
        ):
            return Symbol("t", scalar=True), None
        if not self.open:
            raise unknown(spelled, self.theory)
        return self.typed(self.introduce(node))

    def introduce(self, node: s.Name) -> Symbol:
        """Return a new letter: small Greek ones are numbers, others matrices whose shape follows from their use."""
        spelled = spell(node, self.notation)
        accent = next((a for a in node.accents if a in ("hat", "bar", "tilde")), "")
        glyph = Glyph(node.letter if len(node.letter) == 1 else "\\" + node.letter, accent, node.sub, node.sup)
        number = self.scalar or _is_greek(node.letter)
        name = spelled if spelled not in self.theory.theory.symbols else spelled + " (given)"
        if number:
            symbol = Symbol(name, glyph=glyph, scalar=True)
        else:
            symbol = Symbol(name, self.shapes.fresh(), self.shapes.fresh(), glyph)
        self.new[spelled] = symbol
        return symbol

    def matrix_root(self, term: Term) -> Typed:
        """Return the letter for the root of a symmetric letter, positive as that is.

        Raises:
            NotUnderstood: the term is no symmetric letter.
        """
        if not isinstance(term, Symbol) or not term.symmetric:
            raise NotUnderstood(f"{latex(term)}^{{1/2}}: only the root of a symmetric letter is read, such as V")
        look = term.glyph
        glyph = Glyph(look.letter, look.accent, look.sub, "1/2")
        root = Symbol(f"{term.name}^1/2", term.rows, term.cols, glyph, symmetric=True)
        self.roots[root.name] = root, term
        return self.typed(root)

    def extreme(self, least: bool, typed: Typed) -> Typed:
        """Return the letter for the least or largest eigenvalue of a symmetric matrix."""
        term, shape = typed
        if shape is None:
            return typed
        arithmetic.square(typed, "an eigenvalue", self)
        kind = "min" if least else "max"
        name = f"λ{kind}({plain(term)})"
        glyph = Glyph("λ", sub=kind)
        symbol = Symbol(name, glyph=glyph, scalar=True, show_args=(latex(term),) if isinstance(term, Symbol) else None)
        self.eigenvalues[name] = symbol, term, "least" if least else "largest"
        return symbol, None

    # -------------------------------------------------------------------------------------------- applied
    def applied(self, node: s.Applied) -> Typed:
        """Read a letter at times, indices or frequencies."""
        head = node.head
        if not isinstance(head, s.Name) and self.multiplies(node):
            return arithmetic.times(s.Times((head, s.Fenced(node.arguments[0]))), self)
        if isinstance(head, s.Transposed):
            return powers.transpose(self.applied(s.Applied(head.body, node.arguments)), head.mark, self)
        if isinstance(head, s.Inverted):
            return powers.inverse(self.applied(s.Applied(head.body, node.arguments)), self)
        if isinstance(head, s.Raised) and powers.constant(head.exponent) is not None:
            exponent = powers.constant(head.exponent)
            assert exponent is not None
            return powers.power(self.applied(s.Applied(head.body, node.arguments)), exponent, self)
        if not isinstance(head, s.Name):
            return arithmetic.times(s.Times((head, *(s.Fenced(a) for a in node.arguments))), self)
        spelled = spell(head, self.notation)
        found = self._applied_name(head, spelled, node.arguments)
        if found is None:
            found = self._product(head, spelled, node.arguments)
        term, shape = found
        for _ in range(derivatives(head)):
            term = Dot(term)
        return term, shape

    def multiplies(self, node: s.Applied) -> bool:
        """Return whether what looks like an application is a product, as its letter is no function in the theory."""
        head = node.head
        while isinstance(head, (s.Transposed, s.Inverted, s.Raised)):
            head = head.body
        if not isinstance(head, s.Name) or len(node.arguments) != 1 or time_of(node.arguments[0]) is not None:
            return False
        return self._applied_name(head, spell(head, self.notation), node.arguments) is None

    def _applied_name(self, head: s.Name, spelled: str, arguments: tuple[s.Node, ...]) -> Typed | None:
        if spelled == "delta" and len(arguments) == 1:
            return self._delta(arguments[0])
        if spelled in self.functions and len(arguments) == 1:
            parameter, body = self.functions[spelled]
            return self.read(replaced(body, parameter, arguments[0]))
        if spelled in self.blocks:
            return self.read(applied_within(self.blocks[spelled], arguments))
        if spelled in EXTREME and len(arguments) == 1:
            return self.extreme(EXTREME[spelled], self.read(arguments[0]))
        key = f"{spelled}({','.join(map(literal, arguments))})"
        found = self.new.get(key) or self.theory.names.get(key)
        if found is not None:
            return self.typed(found)
        function = self.theory.names.get(spelled + "(s)")
        if isinstance(function, Symbol) and len(arguments) == 1:
            return At(function, self.theory.theory.symbols["s"], self.read(arguments[0])[0]), self.typed(function)[1]
        moving = self.theory.names.get(spelled + "()") or self.new.get(spelled) or look_up(spelled, self.theory)
        times = [time_of(a) for a in arguments]
        if isinstance(moving, Symbol) and moving.args and len(moving.args) == len(times) and None not in times:
            return self.typed(moving.at(*(t for t in times if t is not None)))
        if len(arguments) == 1 and (index := index_of(arguments[0])):
            at = look_up(f"{spelled}_{index}", self.theory)
            return None if at is None else self.typed(at)
        return None

    def _product(self, head: s.Name, spelled: str, arguments: tuple[s.Node, ...]) -> Typed:
        """Read what looks like an application as a product, unless its argument can only be a time."""
        known = self.named(head)
        if known is not None and isinstance(known[0], Symbol) and known[0].name in self.theory.theory.families:
            raise NotUnderstood(f"{spelled}(...): that of A alone is read, as in \\lambda_i(A)")
        if known is None and not self.open and spelled != "I":
            raise unknown(f"{spelled}({', '.join(map(literal, arguments))})", self.theory)
        if len(arguments) != 1 or time_of(arguments[0]) is not None:
            raise NotUnderstood(f"{spelled}(...): {spelled} is no function of time in {self.theory.key}")
        return arithmetic.times(s.Times((head, s.Fenced(arguments[0]))), self)

    def _delta(self, argument: s.Node) -> Typed:
        """Read the Dirac delta of a difference of times, or of a lag between two times of the formula."""
        lag = time_of(argument)
        pair = difference(self.times, lag) if lag is not None else None
        if isinstance(argument, s.Plus) and len(argument.addends) > 1 and argument.addends[-1][0] == "-":
            before = argument.addends[:-1]
            first = time_of(before[0][1] if len(before) == 1 else s.Plus(before))
            second = time_of(argument.addends[-1][1])
            pair = (first, second) if first is not None and second is not None else pair
        if pair is not None:
            return Delta(*pair), None
        raise NotUnderstood("δ: expected the difference of two times, as in \\delta(t-\\tau)")


def replaced(node: s.Node, parameter: str, argument: s.Node) -> s.Node:
    """Return a node with an argument in the place of a letter."""
    if isinstance(node, s.Name) and node.letter == parameter and not (node.sub or node.sup or node.accents):
        return s.Fenced(argument) if not isinstance(argument, (s.Name, s.Digits)) else argument

    def within(part: object) -> object:
        if isinstance(part, s.Node):
            return replaced(part, parameter, argument)
        return tuple(map(within, part)) if isinstance(part, tuple) else part  # type: ignore[reportUnknownVariableType]

    return replace(node, **{f.name: within(getattr(node, f.name)) for f in fields(node) if f.name != "span"})


def applied_within(node: s.Node, arguments: tuple[s.Node, ...]) -> s.Node:
    """Return a block matrix whose letters are taken at some times."""
    if isinstance(node, s.Name):
        return s.Applied(node, arguments)

    def within(part: object) -> object:
        if isinstance(part, s.Node):
            return applied_within(part, arguments)
        return tuple(map(within, part)) if isinstance(part, tuple) else part  # type: ignore[reportUnknownVariableType]

    return replace(node, **{f.name: within(getattr(node, f.name)) for f in fields(node) if f.name != "span"})


def _is_greek(letter: str) -> bool:
    return GREEK.get(letter, letter) in GREEK_NUMBERS


KINDS: Mapping[type[s.Node], str] = {
    s.Listed: "a list",
    s.Cases: "a definition by cases",
    s.Related: "a relation inside a formula",
    s.Given: "a conditional expectation",
}
HANDLERS: Mapping[type[s.Node], Callable[..., Typed]] = {
    **arithmetic.HANDLERS,
    **powers.HANDLERS,
    **functions.HANDLERS,
    **operators.HANDLERS,
    s.Name: lambda node, reader: reader.name(node),
    s.Applied: lambda node, reader: reader.applied(node),
}
