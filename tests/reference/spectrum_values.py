"""Numbers for what the lecture on the frequency domain prints: its terms interpreted with NumPy, at given letters.

Each kind of term has the meaning that a reader gives it: an integral is a quadrature, a limit an extrapolation, a
product over roots a product of numbers. Nothing of the program's own reading of a term is used.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from itertools import product
from typing import Any

import numpy as np

from derive.functions import Abs, Arctan, Definite, Exp, Infinity, Limit, Log, Max, Power, Quotient, Rate, Root
from derive.spectral import (
    At,
    Conjugate,
    Det,
    Distance,
    Entry,
    Growth,
    ImaginaryPart,
    Modulus,
    RealPart,
    Roots,
    TimesArctan,
    TimesLog,
    Total,
)
from derive.terms import Equation, Identity, Inverse, Neg, Number, Product, Sum, Symbol, Term, Trace, Transpose, Zero

Values = Any  # a number or an array: one number, or matrix, for each point of a grid
TOLERANCE = 1e-6
NOT_REAL = 1e-7  # relative; the spectrum near a pole on the circle has rounding errors of this size
POINTS = ("α", "β"), ("σ0", "ω0")  # one root, and a point in the right half plane


class NoValueError(ValueError):
    """What is printed has no value at these letters."""


@dataclass(frozen=True)
class World:
    """Letters with numbers: matrices, roots by family, scalars, dimensions, and what the theory defines."""

    matrices: Mapping[str, np.ndarray]
    roots: Mapping[str, np.ndarray]
    numbers: Mapping[str, complex]
    sizes: Mapping[str, int]
    definitions: Mapping[str, Term]
    known: dict[Any, Values] = field(default_factory=dict, compare=False)
    imaged: tuple[str, ...] = ()  # families whose images under (z - 1)/(z + 1) an integrand is singular at

    @cached_property
    def radius(self) -> float:
        """A length: all roots are within it."""
        return max([1.0, *map(abs, self.points)])

    @cached_property
    def breaks(self) -> list[float]:
        """The frequencies of the roots, where an integrand may have a peak or a singularity."""
        found = sorted(abs(z.imag) for z in self.points)
        return [b for a, b in zip([0.0, *found], found, strict=False) if b - a > 1e-9]

    @cached_property
    def angles(self) -> list[float]:
        """The angles of the roots, where an integrand may have a peak on the unit circle."""
        found = sorted(abs(np.angle(z)) for family in self.roots.values() for z in family)
        return [b for a, b in zip([0.0, *found], found, strict=False) if b - a > 1e-9]

    @property
    def points(self) -> list[complex]:
        """The roots, one more and a point, and the images of the circle's points in the half plane."""
        roots = [complex(z) for family in self.roots.values() for z in family]
        images = [(z - 1.0) / (z + 1.0) for name in self.imaged for z in self.roots[name] if abs(z + 1.0) > 1e-9]
        return [*roots, *images, *(complex(self.numbers[a].real, self.numbers[b].real) for a, b in POINTS)]


@dataclass(frozen=True)
class Place:
    """A world with values of variables (numbers or grids of them) and of indices, by the letters they print as."""

    world: World
    variables: Mapping[str, Values] = field(default_factory=dict)
    indices: Mapping[str, int] = field(default_factory=dict)

    def let(self, symbol: Symbol, value: Values) -> Place:
        """Return the place where a variable has a value."""
        return replace(self, variables={**self.variables, symbol.name: value})

    def numbered(self, index: Symbol, k: int) -> Place:
        """Return the place where an index has a value."""
        return replace(self, indices={**self.indices, index.glyph.letter: k})

    # ------------------------------------------------------------------------------------------ matrices
    def matrix(self, term: Term) -> Values:
        """Return the value of a matrix."""
        match term:
            case Symbol(scalar=False, name=name):
                found = self.world.definitions.get(name)
                return self.world.matrices[name] if found is None else self.matrix(found)
            case Identity(size):
                return np.eye(self.world.sizes[size])
            case Zero(rows, cols):
                return np.zeros((self.world.sizes[rows], self.world.sizes[cols]))
            case Neg(body):
                return -self.matrix(body)
            case Sum(addends):
                return self._sum([self.matrix(a) for a in addends])
            case Product(factors):
                total: Values = 1.0
                for factor in (f for f in factors if not is_matrix(f)):
                    total = total * np.asarray(self.number(factor))
                total, rest = np.asarray(total)[..., None, None], [f for f in factors if is_matrix(f)]
                product = self.matrix(rest[0])
                for factor in map(self.matrix, rest[1:]):
                    if product.shape[-1] != factor.shape[-2]:
                        raise NoValueError("a product of matrices that do not fit")
                    product = product @ factor
                return total * product
            case Transpose(body):
                return np.swapaxes(self.matrix(body), -1, -2)
            case Inverse(body):
                return np.linalg.inv(self.matrix(body))
            case _:
                raise NoValueError(f"{type(term).__name__} is no matrix")

    def _sum(self, matrices: list[Values]) -> Values:
        if len({m.shape[-2:] for m in matrices}) != 1:
            raise NoValueError("a sum of matrices that do not fit")
        return sum(matrices[1:], start=matrices[0])

    # ------------------------------------------------------------------------------------------ numbers
    def number(self, term: Term) -> Values:
        """Return the value of a number."""
        match term:
            case Symbol(scalar=True, name=name):
                return self._symbol(name)
            case Number(value):
                return float(value)
            case Zero():
                return 0.0
            case Neg(body):
                return -self.number(body)
            case Sum(addends):
                return sum(self.number(a) for a in addends)
            case Product(factors):
                return math.prod((self.number(f) for f in factors), start=1.0)
            case Quotient(top, bottom):
                return self.number(top) / _nonzero(self.number(bottom))
            case Power(body, exponent):
                return self.number(body) ** exponent
            case Log(body):
                return _log(self.number(body))
            case Abs(body):
                return np.abs(_real(self.number(body)))
            case Max(body):
                return np.maximum(0.0, _real(self.number(body)))
            case Root(body):
                return np.sqrt(_real(self.number(body)))
            case Exp(body):
                return np.exp(self.number(body))
            case Arctan(body):
                return np.arctan(_real(self.number(body)))
            case Limit() | Definite() | Rate():
                return self._known(term)
            case _:
                return self._spectral(term)

    def _symbol(self, name: str) -> Values:
        if name in self.variables:
            return self.variables[name]
        if name in self.world.numbers:
            return self.world.numbers[name]
        if name in self.world.definitions:
            return self.number(self.world.definitions[name])
        raise NoValueError(f"{name} has no value")

    def _spectral(self, term: Term) -> Values:
        match term:
            case Det(body):
                return np.linalg.det(self._square(body))
            case Trace(body):
                return np.trace(self._square(body), axis1=-2, axis2=-1)
            case Entry(body):
                return self._square(body, 1)[..., 0, 0]
            case RealPart(root):
                return self._root(root).real
            case ImaginaryPart(root):
                return self._root(root).imag
            case Growth(root):
                size = abs(self._root(root))
                return math.log(size) if size > 1.0 else 0.0
            case Distance(point, root):
                return np.abs(self.number(point) - self._root(root)) ** 2
            case Total(body, index, count):
                places = (self.numbered(index, k) for k in range(self._count(count)))
                return sum((p.number(body) for p in places), start=0.0)
            case Roots(point, root, index, count):
                places = (self.numbered(index, k) for k in range(self._count(count)))
                return math.prod((p.number(point) - p._root(root) for p in places), start=1.0)
            case Modulus(body):
                return np.abs(self.number(body))
            case At(body, symbol, point):
                return self.let(symbol, self.number(point)).number(body)
            case TimesLog(factor, width):
                x, a = _real(self.number(factor)), _real(self.number(width))
                square = x * x + a * a
                return x * np.log(np.where(square == 0.0, 1.0, square))
            case TimesArctan(factor, width):
                x, a = _real(self.number(factor)), np.abs(_real(self.number(width)))
                return a * np.arctan(x / np.where(a == 0.0, 1.0, a))
            case _:
                raise NoValueError(f"{type(term).__name__} is no number")

    def _square(self, body: Term, size: int | None = None) -> Values:
        matrix = self.matrix(body)
        if matrix.shape[-1] != matrix.shape[-2] or matrix.shape[-1] != (size or matrix.shape[-1]):
            raise NoValueError("a matrix of another type")
        return matrix

    def _count(self, count: Symbol) -> int:
        return self.world.sizes[count.name]

    def _root(self, root: Term) -> complex:
        """Return the root that is meant: of its family, the one with the number that its subscript has here."""
        if isinstance(root, Conjugate):
            return self._root(root.root).conjugate()
        if not isinstance(root, Symbol) or root.name not in self.world.roots:
            raise NoValueError("no root")
        family, k = self.world.roots[root.name], self.indices.get(root.glyph.sub)
        if k is None or k >= len(family):
            raise NoValueError(f"{root.name} has no number {k}")
        return complex(family[k])

    # ------------------------------------------------------------------------------------------ calculus
    def _known(self, term: Limit | Definite | Rate) -> Values:
        """Return a limit, integral or derivative; one without variables of its own is computed once."""
        if self.variables.keys() - {"s"}:
            return self._calculus(term)
        key = term, tuple(sorted(self.indices.items()))
        if key not in self.world.known:
            self.world.known[key] = replace(self, variables={})._calculus(term)
        return self.world.known[key]

    def _calculus(self, term: Limit | Definite | Rate) -> Values:
        function: Callable[[Values], Values] = lambda x: self.let(term.symbol, x).number(term.body)  # noqa: E731
        if not isinstance(term, Definite) and any(isinstance(n, Definite) for n in _nodes(term.body)):
            one, function = function, lambda xs: np.array([one(x) for x in np.atleast_1d(xs)])
        match term:
            case Rate(_, symbol):
                return derivative(function, self.number(symbol))
            case Limit(_, _, Infinity()):
                return at_infinity(function, self.world.radius)
            case Limit(_, _, point):
                return function(self.number(point) + 1e-13)
            case Definite(_, _, lower, upper):
                size = max([self.world.radius, *(abs(x) for x in self.variables.values() if np.ndim(x) == 0)])
                low, high = self._bound(lower), self._bound(upper)
                breaks = self.world.angles if (low, high) == (-math.pi, math.pi) else self.world.breaks
                return integral(function, low, high, breaks, size)

    def _bound(self, term: Term) -> float:
        match term:
            case Infinity():
                return math.inf
            case Neg(Infinity()):
                return -math.inf
            case _:
                return float(self.number(term))


def _nodes(term: Term) -> Iterator[Term]:
    yield term
    for child in term.children():
        yield from _nodes(child)


def is_matrix(term: Term) -> bool:
    """Tell whether a term is a matrix rather than a number."""
    match term:
        case Symbol(scalar=scalar):
            return not scalar
        case Identity():
            return True
        case Zero(rows, _):
            return bool(rows)
        case Neg(body) | Transpose(body) | Inverse(body):
            return is_matrix(body)
        case Sum(parts) | Product(parts):
            return any(map(is_matrix, parts))
        case _:
            return False


def _real(x: Values) -> Values:
    """Return real numbers as such; rounding leaves an imaginary part where a grid comes near to a singularity."""
    if np.mean(np.abs(np.imag(x)) > NOT_REAL * (1.0 + np.abs(x))) > 0.1:
        raise NoValueError("an order of complex numbers")
    return np.real(x)


def _nonzero(x: Values) -> Values:
    if np.any(x == 0.0):
        raise NoValueError("a division by zero")
    return x


def _log(x: Values) -> Values:
    """Return the logarithm of positive numbers; rounding may turn the sign where a grid comes near to a singularity."""
    x = _real(x)
    if np.mean(x < 0.0) > 0.1:
        raise NoValueError("the logarithm of a negative number")
    return np.log(np.maximum(np.abs(x), np.finfo(float).tiny))


# ------------------------------------------------------------------------------------------------ quadrature, limits
def _tanh_sinh() -> tuple[np.ndarray, np.ndarray]:
    """Return nodes between 0 and 1 and weights; integrable singularities at the ends do no harm."""
    t = np.arange(-59, 60) / 20.0  # no node nearer to an end than 1e-13
    u = math.pi / 2.0 * np.sinh(t)
    nodes, slopes = 1.0 / (1.0 + np.exp(-2.0 * u)), math.pi / 4.0 * np.cosh(t) / np.cosh(u) ** 2
    return nodes, slopes / 20.0


NODES, WEIGHTS = _tanh_sinh()
FAREST = 1e-5
FAR = np.polynomial.legendre.leggauss(40)  # nodes in ln(1/x), and weights


def integral(f: Callable[[Values], Values], low: float, high: float, breaks: list[float], radius: float) -> float:
    """Return the integral of f: pieces between breaks, and the rest of the axis by the variable 1/x.

    Raises:
        NoValueError: f does not decay like 1/x^2 or ln(x)/x^2.
    """
    if low > high:
        return -integral(f, high, low, breaks, radius)
    if low < 0.0 or high < 0.0:
        left = integral(lambda x: f(-x), max(0.0, -high), -low, breaks, radius)
        return left + (integral(f, 0.0, high, breaks, radius) if high > 0.0 else 0.0)
    end = min(high, 4.0 * radius)
    edges = np.array([low, *(b for b in breaks if low < b < end), max(low, end)])
    points = edges[:-1, None] + np.diff(edges)[:, None] * NODES
    values = np.broadcast_to(f(points.ravel()), points.size).reshape(points.shape)
    total = float(np.sum(values * WEIGHTS * np.diff(edges)[:, None]))
    if math.isfinite(high):
        return total
    return total + _rest(lambda u: f(end / u) * end / u**2)


def _rest(g: Callable[[Values], Values]) -> float:
    """Return the integral of g from 0 to 1, where g is like a + b ln u near 0."""
    half = -np.log(FAREST) / 2.0
    u = np.exp(half * (FAR[0] - 1.0))
    middle = half * float(np.sum(g(u) * u * FAR[1]))
    last, next_to_last = g(FAREST * np.array([1.0, 2.0]))
    if abs(last) > 1.5 * abs(next_to_last) + 1e-3:
        raise NoValueError("an integral that diverges")
    return middle + FAREST * float(last - (next_to_last - last) / math.log(2.0))


def at_infinity(f: Callable[[Values], Values], radius: float) -> float:
    """Return the limit of f, analytic in 1/x: polynomial extrapolation from large x.

    Raises:
        NoValueError: f grows.
    """
    x = 32.0 * radius * 2.0 ** np.arange(7)
    row = np.broadcast_to(f(x), x.shape)
    steps = np.abs(np.diff(row))
    if steps[-1] > 0.75 * steps[-2] + 1e-6:
        raise NoValueError("a limit that is infinite")
    for k in range(1, len(x)):
        row = (2.0**k * row[1:] - row[:-1]) / (2.0**k - 1.0)
    return float(_real(row[0]))


def derivative(f: Callable[[Values], Values], x: float) -> float:
    """Return f'(x): central differences, extrapolated."""
    h = 0.02 * 0.5 ** np.arange(4)
    row = (f(x + h) - f(x - h)) / (2.0 * h)
    for k in range(1, 4):
        row = (4.0**k * row[1:] - row[:-1]) / (4.0**k - 1.0)
    return float(row[0])


# ------------------------------------------------------------------------------------------------ statements
def sides(statement: Equation, place: Place) -> tuple[Values, Values]:
    """Return the values of both sides."""
    read = place.matrix if is_matrix(statement.lhs) else place.number
    return read(statement.lhs), 0.0 if statement.rhs == Zero("", "") else read(statement.rhs)


def gap_at(statement: Equation, place: Place) -> float:
    """Return by how much a statement fails, relative to its numbers (or to 1, if these are smaller).

    Raises:
        NoValueError: a side has no value.
    """
    left, right = sides(statement, place)
    scale = max(1.0, float(np.max(np.abs(left))), float(np.max(np.abs(right))))
    match statement.relation:
        case "=" | ":=":
            found = np.max(np.abs(left - right))
        case "≥":
            found = np.max(_real(right - left))
        case ">":
            found = np.max(_real(right - left)) if np.all(_real(left) != _real(right)) else 1.0
        case "⪰" | "≻":
            found = -np.min(np.linalg.eigvalsh(left - right))
        case "≠":
            found = 0.0 if np.all(np.abs(left - right) > TOLERANCE) else 1.0
        case relation:
            raise NoValueError(f"the relation {relation}")
    if not math.isfinite(found):
        raise NoValueError("no finite number")
    return max(0.0, float(found)) / scale


def places(statement: Equation, world: World) -> Iterator[Place]:
    """Iterate over what a statement speaks of: every number of a root that it leaves free."""
    letters: dict[str, int] = {}
    for side in (statement.lhs, statement.rhs):
        for letter, name in _free(side, frozenset(), world):
            letters[letter] = min(letters.get(letter, 9**9), len(world.roots[name]))
    for numbers in product(*map(range, letters.values())):
        yield Place(world, indices=dict(zip(letters, numbers, strict=True)))


def _free(term: Term, bound: frozenset[str], world: World) -> Iterator[tuple[str, str]]:
    """Iterate over the subscripts of roots that no sum or product binds, with their families."""
    match term:
        case Total(_, index, _) | Roots(_, _, index, _):
            bound = bound | {index.glyph.letter}
        case Symbol(scalar=True, glyph=glyph, name=name) if name in world.roots and glyph.sub not in bound:
            yield glyph.sub, name
        case Symbol(scalar=True, name=name) if name in world.definitions:
            yield from _free(world.definitions[name], bound, world)
        case _:
            pass
    for child in term.children():
        yield from _free(child, bound, world)


def gap(statement: Equation, world: World) -> float:
    """Return by how much a statement fails at the worst of its places; s is complex, and real where it must be.

    Raises:
        NoValueError: a side has no value.
    """
    found = [0.0]
    for place in places(statement, world):
        try:
            found.append(gap_at(statement, place))
        except NoValueError:
            found.append(gap_at(statement, replace(place, variables={"s": world.radius + 1.7})))
    return max(found)
