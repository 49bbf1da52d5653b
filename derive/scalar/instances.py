"""Small plants that satisfy every hypothesis exactly: a list without end, the smallest first.

Letters that others stand for follow from the free ones, so that a rational covariance gives a rational plant. What is
left of the equations is solved for one letter each, by its rational roots, or by the ball of a root of a quadratic.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from fractions import Fraction
from itertools import zip_longest
from typing import Any

from flint import arb, fmpq, fmpq_poly

from derive.scalar.evaluate import BITS, compare
from derive.scalar.flint_ring import FlintRing, fraction, rational
from derive.scalar.ratio import Ratio
from derive.scalar.system import System

__all__ = ["Instance", "Instances", "Several"]

SIZES = (0, 1, 2, Fraction(1, 2), 3, 4, Fraction(1, 3), Fraction(3, 2), 5)  # absolute values, simplest first
ZERO = fmpq(0)
TRIED = 3_000  # points for the free letters, at most
RELATION = {"nonnegative": "≥", "positive": ">", "nonzero": "≠"}


@dataclass(frozen=True)
class Instance:
    """Values of all letters; ``roots`` says in words what those are that are balls."""

    values: Mapping[str, Any]
    roots: Mapping[str, str] = field(default_factory=dict[str, str])

    def size(self, names: Sequence[str]) -> tuple[Any, ...]:
        """Return a measure of how simple the values of some letters are."""
        values = [fraction(v) for n in names if isinstance(v := self.values.get(n), fmpq)]
        heights = [max(abs(v.numerator), v.denominator) for v in values]
        return (
            len(names) - len(values), max(heights, default=0), sum(heights),
            sum(v < 0 for v in values), sum(v == 0 for v in values),
        )  # fmt: skip


class Several:
    """The instances of several cases, as those of one."""

    def __init__(self, parts: Sequence[Instances]):
        self.parts = parts
        self.free = list(dict.fromkeys(n for p in parts for n in p.free))

    def first(self, count: int, tries: int = TRIED) -> list[Instance]:
        """Return instances of all cases, those of each the simplest first."""
        share = -(-count // len(self.parts))
        found = [p.first(share, tries) for p in self.parts]
        return [i for same in zip_longest(*found) for i in same if i is not None]

    def at(self, point: Mapping[str, Any]) -> list[Instance]:
        """Return the instances in which the free letters have these values."""
        return [i for p in self.parts for i in p.at({n: v for n, v in point.items() if n in p.free})]


class Instances:
    """The instances of a system, found as they are asked for."""

    def __init__(self, system: System, ring: FlintRing, names: Sequence[str]):
        self.system, self.ring = system, ring
        self.last: tuple[Mapping[str, Any], int, tuple[Any, ...] | None] = {}, -1, None
        self.dependent = self._dependent({name for _, name in system.roots})
        solved = {*system.values, *self.dependent}
        self.free = [n for n in names if n not in solved and not n.startswith(("√", "exp "))]
        self.found: list[Instance] = []
        self.tried = 0
        self.points = iter(()) if system.impossible else self._search()

    def _dependent(self, roots: set[str]) -> dict[str, Any]:
        """Return a letter for each equation that remains, with that equation; for that of a root the root."""
        found = {name: poly for name, poly in self.system.relations.items() if name in roots}
        for name, poly in self.system.relations.items():
            if name in roots:
                continue
            degrees = dict(zip(self.ring.names, map(int, poly.degrees()), strict=True))
            usable = [n for n, d in degrees.items() if d and n not in found]
            if usable:
                found[min(usable, key=lambda n: (-(degrees[n] == 2), degrees[n], n))] = poly
        return found

    def first(self, count: int, tries: int = TRIED) -> list[Instance]:
        """Return instances, the simplest first, as many as are found at some points, counted from the beginning."""
        while len(self.found) < count and self.tried < tries:
            point = next(self.points, None)
            if point is None:
                break
            self.tried += 1
            self.found += self.at(point)
        return self.found[:count]

    def at(self, point: Mapping[str, Any]) -> list[Instance]:
        """Return the instances in which the free letters have these values."""
        return [i for i in self._complete(dict(point), {}, list(self.dependent)) if self._allowed(i.values)]

    def allows(self, instance: Instance) -> bool:
        """Tell whether an instance of another system of the same letters satisfies this one for certain."""
        equations = self.system.relations.values()
        if any(compare(self.value(p, instance), "=", fmpq(0)) is not True for p in equations):
            return False
        return self._allowed(instance.values)

    def value(self, poly: Any, instance: Instance) -> Any:
        """Return the value of a polynomial in letters and roots of the system."""
        if not self.system.roots and not self.system.exponentials:
            return self._at(poly, instance.values)
        point = dict(instance.values)
        for s, name in self.system.roots:
            if name not in point:
                inside = self._ratio(s, point)
                point[name] = _ball_root(inside) if inside is not None else arb("nan")
        for argument, name in self.system.exponentials:
            value = self._ratio(argument, point)
            point[name] = arb(value).exp() if value is not None else arb("nan")
        missing = self.ring.letters(poly) - point.keys()
        return arb("nan") if missing else self._at(poly, point)

    # ------------------------------------------------------------------------------------- search
    def _search(self) -> Iterator[dict[str, Any]]:
        pools = [self._pool(name) for name in self.free]
        for choice in _by_weight([len(p) for p in pools]):
            yield {name: pool[i] for name, pool, i in zip(self.free, pools, choice, strict=True)}

    def _pool(self, name: str) -> list[Any]:
        sign, strict = self.system.signs.get(name, (0, False))
        sizes = [x for x in SIZES if x or not strict]
        signed = [x * s for x in sizes for s in ((sign,) if sign else (1, -1)) if x or s >= 0]
        return [rational(Fraction(x)) for x in signed]

    def _complete(self, point: dict[str, Any], said: dict[str, str], open_: list[str]) -> Iterator[Instance]:
        """Solve the equations that remain, each once its other letters are known."""
        if open_:
            ready = (n for n in open_ if self.ring.letters(self.dependent[n]) <= {n, *point})
            name = next(ready, None)
            if name is None:
                return
            for value, words in self._solutions(name, point):
                now = {**said, name: words} if words else said
                yield from self._complete({**point, name: value}, now, [n for n in open_ if n != name])
            return
        found = {name: self._ratio(ratio, point) for name, ratio in self.system.values.items()}
        if None not in found.values():
            yield Instance({**point, **found}, said)

    def _ratio(self, ratio: Ratio, point: Mapping[str, Any]) -> Any:
        """Return the value of a fraction, None where its denominator may be zero."""
        bottom: Any = fmpq(1)
        for factor, exponent in ratio.bottom:
            bottom = bottom * self._at(factor, point) ** exponent
        if (bottom == 0) if isinstance(bottom, fmpq) else bottom.contains(0):
            return None
        return self._at(ratio.top, point) / bottom

    def _at(self, poly: Any, point: Mapping[str, Any]) -> Any:
        row = self._row(point)
        if row is not None:
            return poly(*row)
        total: Any = fmpq(0)
        for names, c in self.ring.terms(poly):
            product: Any = rational(c)
            for name in names:
                product = product * point[name]
            total = product + total if isinstance(product, arb) else total + product
        return total

    def _row(self, point: Mapping[str, Any]) -> tuple[Any, ...] | None:
        """Return the values of all letters in the order of the ring, None if one is a ball; that of the last point."""
        known, size, row = self.last
        if known is not point or size != len(point):
            balls = any(isinstance(v, arb) for v in point.values())
            row = None if balls else tuple(point.get(n, ZERO) for n in self.ring.names)
            self.last = point, len(point), row
        return row

    def _solutions(self, name: str, point: Mapping[str, Any]) -> Iterator[tuple[Any, str]]:
        """Iterate over the real roots of an equation in one letter: rational ones, and those of a quadratic."""
        if any(isinstance(v, arb) for v in point.values()):
            return
        coefficients: dict[int, Any] = {}
        for names, c in self.ring.terms(self.dependent[name]):
            product = rational(c)
            for other in names:
                if other != name:
                    if other not in point:
                        return
                    product = product * point[other]
            power = names.count(name)
            coefficients[power] = coefficients.get(power, fmpq(0)) + product
        poly = fmpq_poly([coefficients.get(k, fmpq(0)) for k in range(max(coefficients) + 1)])
        if poly.degree() < 1:
            if poly.degree() < 0:
                yield from ((v, "") for v in self._pool(name)[:5])
            return
        _, factors = poly.factor()
        for factor, _ in factors:
            if factor.degree() == 1:
                yield -factor[0] / factor[1], ""
            elif factor.degree() == 2:
                yield from _quadratic(factor)

    def _allowed(self, point: Mapping[str, Any]) -> bool:
        """Tell whether all facts hold for certain, and the equations as far as balls tell."""
        if any(compare(self._at(p, point), "=", fmpq(0)) is False for p in self.system.relations.values()):
            return False
        for kind, poly in self.system.facts.values():
            if compare(self._at(poly, point), RELATION[kind], fmpq(0)) is not True:
                return False
        for choice in self.system.alternatives:
            if not any(compare(self._at(p, point), RELATION[kind], fmpq(0)) for kind, p in choice):
                return False
        return True


def _quadratic(poly: Any) -> Iterator[tuple[Any, str]]:
    """Iterate over the real roots of an irreducible quadratic as balls, with their expressions."""
    from flint import ctx

    c, b, a = poly[0], poly[1], poly[2]
    inside = b * b - 4 * a * c
    if inside <= 0:
        return
    before, ctx.prec = ctx.prec, BITS
    try:
        root, middle = arb(inside / (4 * a * a)).sqrt(), arb(-b / (2 * a))
        for sign, mark in ((1, "+"), (-1, "-")):
            yield middle + sign * root, f"{-b / (2 * a)} {mark} sqrt({inside / (4 * a * a)})"
    finally:
        ctx.prec = before


def _rational_root(value: Any) -> Any:
    if value < 0:
        return None
    p, q = value.p.isqrt(), value.q.isqrt()
    return fmpq(p, q) if p * p == value.p and q * q == value.q else None


def _ball_root(value: Any) -> Any:
    """Return a root, enclosed where it is not rational; a radicand that may be negative gives all numbers."""
    if isinstance(value, fmpq):
        exact = _rational_root(value)
        return exact if exact is not None else arb(value).sqrt()
    return value.sqrt()


def _by_weight(lengths: Sequence[int]) -> Iterator[tuple[int, ...]]:
    """Iterate over choices of one index each, those with a small sum first."""
    for weight in range(sum(lengths) - len(lengths) + 1):
        yield from _with_sum(lengths, weight)


def _with_sum(lengths: Sequence[int], weight: int) -> Iterator[tuple[int, ...]]:
    if not lengths:
        if weight == 0:
            yield ()
        return
    for i in range(min(lengths[0] - 1, weight) + 1):
        for rest in _with_sum(lengths[1:], weight - i):
            yield (i, *rest)
