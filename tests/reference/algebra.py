"""A small language for writing matrix claims in tests: letters, products, transposes, inverses, hypotheses."""

from __future__ import annotations

from dataclasses import dataclass, field
from fractions import Fraction

from derive.kernel import ANY, Alphabet, Letter, Poly, identity
from derive.matrix.hypotheses import Hypotheses
from derive.rules import Fact


@dataclass(frozen=True)
class Expr:
    """A polynomial together with the setting that knows its transpose."""

    poly: Poly
    setting: Setting

    def __add__(self, other: Expr) -> Expr:
        return Expr(self.poly + other.poly, self.setting)

    def __sub__(self, other: Expr) -> Expr:
        return Expr(self.poly - other.poly, self.setting)

    def __neg__(self) -> Expr:
        return Expr(-self.poly, self.setting)

    def __mul__(self, other: Expr) -> Expr:
        return Expr(self.poly * other.poly, self.setting)

    def __rmul__(self, factor: int | Fraction | str) -> Expr:
        """Multiply by a number, or by a central scalar given by its name."""
        number, scalars = (1, (factor,)) if isinstance(factor, str) else (factor, ())
        return Expr(self.poly.scale(number, scalars), self.setting)

    @property
    def T(self) -> Expr:
        return Expr(self.setting.alphabet.transpose(self.poly), self.setting)


@dataclass
class Setting:
    """The letters and hypotheses of one group of claims."""

    letters: dict[str, Letter] = field(default_factory=dict)
    scalars: set[str] = field(default_factory=set)
    relations: dict[str, Poly] = field(default_factory=dict)
    facts: dict[str, Fact] = field(default_factory=dict)
    inverses: dict[str, Poly] = field(default_factory=dict)

    @property
    def alphabet(self) -> Alphabet:
        return Alphabet(dict(self.letters), frozenset(self.scalars))

    @property
    def hypotheses(self) -> Hypotheses:
        return Hypotheses(self.alphabet, dict(self.relations), dict(self.facts), dict(self.inverses))

    def matrix(self, name: str, rows: str, cols: str) -> Expr:
        self.letters[name] = Letter(name, rows, cols)
        return Expr(Poly({((), (name,)): 1}, rows, cols), self)

    def matrices(self, names: str, rows: str, cols: str) -> list[Expr]:
        return [self.matrix(name, rows, cols) for name in names.split()]

    def symmetric(self, name: str, size: str, fact: str = "") -> Expr:
        """Declare a symmetric letter, with a fact 'psd' or 'pd' if one is named."""
        self.letters[name] = Letter(name, size, size, symmetric=True)
        poly = Poly({((), (name,)): 1}, size, size)
        if fact:
            self.facts[f"{name} {fact}"] = Fact(fact, ((poly,),))
        return Expr(poly, self)

    def scalar(self, name: str) -> str:
        self.scalars.add(name)
        return name

    def eye(self, size: str) -> Expr:
        return Expr(identity(size), self)

    def inverse(self, name: str, of: Expr) -> Expr:
        """Declare the two-sided inverse of an expression."""
        size, symmetric = of.poly.rows, of.T.poly == of.poly
        self.letters[name] = Letter(name, size, size, symmetric)
        letter = Expr(Poly({((), (name,)): 1}, size, size), self)
        self.assume(f"{name} right", of * letter - self.eye(size))
        self.assume(f"{name} left", letter * of - self.eye(size))
        self.inverses[name] = of.poly
        return letter

    def assume(self, name: str, expr: Expr) -> None:
        """Declare expr = 0."""
        self.relations[name] = expr.poly

    def central(self, name: str, *terms: tuple[int, tuple[str, ...]]) -> None:
        """Declare sum of number * scalars = 0 among central scalars."""
        self.relations[name] = Poly({(m, ()): c for c, m in terms}, ANY, ANY)

    def stable(self, name: str, kind: str, expr: Expr) -> None:
        """Declare expr Hurwitz or Schur."""
        self.facts[name] = Fact(kind, ((expr.poly,),))


def substitute(expr: Expr, letter: str, image: Expr) -> Expr:
    """Replace a letter by an expression, its transpose by the transpose."""
    from derive.rules import substitute as replace

    return Expr(replace(expr.poly, {letter: image.poly}, expr.setting.alphabet), expr.setting)
