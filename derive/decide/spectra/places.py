"""Exact plants at which claims of the frequency domain are evaluated: small ones whose covariance is rational.

A plant is built from its covariance: W = P C'V^-1 C P - A P - P A' has to be >= 0, and A - K C stable, or
of order one on the boundary (the strong solution).
"""

from __future__ import annotations

import random
from collections.abc import Iterator
from dataclasses import replace
from functools import cache
from itertools import product
from typing import Any

from flint import acb, arb, fmpq, fmpq_mat, fmpq_poly

from derive.context import Declared, DeclaredFact, Theory
from derive.decide.spectra.evaluate import Place, value
from derive.decide.spectra.numbers import NoValue, Value, less
from derive.decide.spectra.ratio import Fractional, Undefined, roots
from derive.interpret.statement import Statement
from derive.matrix.exact import PROPERTIES, hurwitz, positive_semidefinite
from derive.matrix.instance import one
from derive.terms import Equation, Symbol, Term, Zero, walk

__all__ = ["admissible", "decided", "difference", "places", "speaks_of_known_functions"]

SEED, DRAWS, WANTED = 7, 4000, 14
FIRST = 40  # plants of order one that come before larger ones, so that some of each are tried
FUNCTIONS = frozenset("fpqφηζ")  # letters of a function of s, its zeros and poles
FACTS = {"⪰": "psd", "≻": "pd"}


def places(statement: Statement) -> Iterator[Place]:
    """Iterate over plants that satisfy all hypotheses and assumptions of a statement, the smallest first."""
    for place in _plants(statement.scalar):
        for complete in _completed(place, statement):
            if admissible(complete, statement):
                yield complete


# ------------------------------------------------------------------------------------------------ plants
@cache
def _plants(scalar: bool) -> tuple[Place, ...]:
    small = tuple(_of_order_one())
    return small if scalar else (*small[:FIRST], *_by_hand(), *_drawn(), *small[FIRST:])


def _of_order_one() -> Iterator[Place]:
    """Iterate over scalar plants, unexcited and unobserved ones and integrators among them."""
    values = [fmpq(x) for x in (1, 0, -1, 2, -2)]
    found: list[tuple[fmpq, dict[str, fmpq]]] = []
    for a, c, v, p in product(values, [fmpq(1), fmpq(2), fmpq(0), fmpq(-1)], (fmpq(1), fmpq(4)), range(4)):
        w = c * c * p * p / v - 2 * a * p
        closed = a - c * c * p / v
        if w >= 0 and closed <= 0 and (c != 0 or a < 0):
            cost = abs(a) + abs(c - 1) + abs(v - 1) + abs(fmpq(p) - 1) + w / 4
            found.append((cost, {"A": a, "C": c, "V": v, "P": fmpq(p), "W": w}))
    for _, plant in sorted(found, key=lambda x: x[0]):
        yield _place({name: fmpq_mat(1, 1, [x]) for name, x in plant.items()}, 1, 1)


def _by_hand() -> Iterator[Place]:
    """Iterate over a double integrator, and a plant of two outputs that nothing excites."""
    double = {"A": [0, 1, 0, 0], "C": [1, 0], "V": [1], "P": [2, 2, 2, 4], "W": [0, 0, 0, 4]}
    yield _place(_matrices(double, 2, 1), 2, 1)
    quiet = {"A": [1, 0, 0, -1], "C": [1, 0, 0, 1], "V": [1, 0, 0, 1], "P": [2, 0, 0, 0], "W": [0, 0, 0, 0]}
    yield _place(_matrices(quiet, 2, 2), 2, 2)
    turning = {"A": [0, 1, -1, 0], "C": [1, 0, 0, 1], "V": [1, 0, 0, 1], "P": [0, 0, 0, 0], "W": [0, 0, 0, 0]}
    yield _place(_matrices(turning, 2, 2), 2, 2)


def _drawn() -> Iterator[Place]:
    """Iterate over random plants of order two and three."""
    generator, found = random.Random(SEED), 0
    for i in range(DRAWS):
        n, l = ((2, 1), (2, 2), (3, 2))[i % 3]  # noqa: E741
        A, C, G = (
            fmpq_mat(r, c, [generator.randint(-2, 2) for _ in range(r * c)]) for r, c in ((n, n), (l, n), (n, n))
        )
        V, P = one(l) * generator.choice((1, 4)), G * G.transpose()
        W = P * C.transpose() * V.inv() * C * P - A * P - P * A.transpose()
        if positive_semidefinite(W) and hurwitz(A - P * C.transpose() * V.inv() * C):
            yield _place({"A": A, "C": C, "V": V, "P": P, "W": W}, n, l)
            found += 1
        if found == WANTED:
            return


def _matrices(rows: dict[str, list[int]], n: int, l: int) -> dict[str, fmpq_mat]:  # noqa: E741
    shapes = {"A": (n, n), "C": (l, n), "V": (l, l), "P": (n, n), "W": (n, n)}
    return {name: fmpq_mat(*shapes[name], entries) for name, entries in rows.items()}


def _place(letters: dict[str, fmpq_mat], n: int, l: int) -> Place:  # noqa: E741
    K = letters["P"] * letters["C"].transpose() * letters["V"].inv()
    eigenvalues = roots(fmpq_poly(list(letters["A"].charpoly())))
    return Place({"m": n, "l": l}, {**letters, "K": K}, families={"λ": eigenvalues})


# ------------------------------------------------------------------------------------------------ what is given
def _completed(place: Place, statement: Statement) -> Iterator[Place]:
    """Iterate over the ways to give values to what else a statement mentions."""
    theory = statement.theory.theory
    if any(size.isdigit() and place.sizes.get(name, 1) != int(size) for name, size in _fixed(statement)):
        return
    place = replace(place, definitions=_definitions(theory), numbers={"m": Fractional.of(place.sizes["m"])})
    names = {n.name for t in _terms(statement) for n in walk(t) if isinstance(n, Symbol)}
    if names & {"B", "varepsilon"}:
        root = _factor(place.letters["W"])
        if root is None:
            return
        place = replace(place, letters={**place.letters, "B": root}, sizes={**place.sizes, "p": root.ncols()})
        if "varepsilon" in names:
            place = replace(place, numbers={**place.numbers, "varepsilon": Fractional.of(root[0, 0])})
    if "V^1/2" in names:
        scale = 2 if place.letters["V"][0, 0] == 4 else 1  # V is I or 4 I
        place = replace(place, letters={**place.letters, "V^1/2": one(place.sizes["l"]) * scale})
    place = replace(place, numbers={**place.numbers, **_extremes(theory, place)})
    if names & FUNCTIONS:
        yield from _with_function(place, statement, names)
    else:
        yield place


def _extremes(theory: Theory, place: Place) -> dict[str, Any]:
    """Return the extreme eigenvalues that a statement mentions."""
    found: dict[str, Any] = {}
    for name, item in theory.declared.items():
        kind, _, of = name.partition(" eigenvalue of ")
        if of and kind in ("least", "largest") and isinstance(item, Declared):
            symbol = next(n for n in walk(item.statement.lhs) if isinstance(n, Symbol) and n.name not in place.letters)
            zeroed = replace(place, numbers={**place.numbers, symbol.name: Fractional.of(0)})
            matrix = _matrix(value(item.statement.lhs, zeroed))
            polynomial = fmpq_poly(list((matrix if kind == "least" else -matrix).charpoly()))
            found[symbol.name] = _extreme([root.real for root in roots(polynomial)], kind)
    return found


def _extreme(values: list[arb], kind: str) -> arb:
    total = values[0]
    for x in values[1:]:
        total = total.min(x) if kind == "least" else total.max(x)
    return total


def _fixed(statement: Statement) -> Iterator[tuple[str, str]]:
    """Iterate over the dimensions that a statement fixes."""
    symbols, outline = statement.theory.theory.symbols, statement.theory.outline
    for name, size in (("C", "l"), ("A", "m")):
        if outline is not None and name in symbols:
            yield size, symbols[name].rows
    if statement.scalar:
        yield from (("l", "1"), ("m", "1"))


def _definitions(theory: Theory) -> dict[str, Term]:
    found: dict[str, Term] = {}
    for item in theory.declared.values():
        if isinstance(item, Declared) and item.statement.relation in ("=", ":="):
            lhs = item.statement.lhs
            if isinstance(lhs, Symbol) and lhs.name not in found:
                found[lhs.name] = item.statement.rhs
    return found


def _terms(statement: Statement) -> Iterator[Term]:
    declared = [d for n, d in statement.theory.theory.declared.items() if n in statement.assumed]
    equations = [*statement.equations, *statement.theory.conditions]
    equations += [d.statement for d in declared if isinstance(d, Declared)]
    for e in equations:
        yield from (e.lhs, e.rhs)


def _factor(W: fmpq_mat) -> fmpq_mat | None:
    """Return B with one column and W = B B', or None."""
    n = W.nrows()
    if W.rank() > 1:
        return None
    at = next((i for i in range(n) if W[i, i] != 0), None)
    if at is None:
        return fmpq_mat(n, 1)
    size = W[at, at]
    if not (size.p.is_square() and size.q.is_square()):
        return None
    root = fmpq(size.p.isqrt(), size.q.isqrt())
    return fmpq_mat(n, 1, [W[i, at] / root for i in range(n)])


def _with_function(place: Place, statement: Statement, names: set[str]) -> Iterator[Place]:
    """Iterate over the values of f: what it is given as, or quotients of polynomials."""
    given = _definition_of_f(statement)
    if given is not None and not {n.name for n in walk(given) if isinstance(n, Symbol)} & {"p", "q"}:
        try:
            f = value(given, place)
        except (Undefined, NoValue, ZeroDivisionError):
            return
        f = f[0][0] if isinstance(f, list) else f
        if isinstance(f, Fractional) and f.is_real:
            yield _having(place, f.re, f.den)
        return
    if place.sizes["m"] == 1 and place.letters["A"] == fmpq_mat(1, 1, [0]):
        return
    generator = random.Random(SEED + place.sizes["m"] + int(place.letters["A"][0, 0].p))
    for _ in range(3):
        degree = generator.randint(1, 3)
        p, q = (_monic(generator, degree) for _ in range(2))
        chosen = _having(place, p, q)
        numbers = {**chosen.numbers, "σ0": Fractional.of(generator.choice((1, 2))), "ω0": Fractional.of(1)}
        yield replace(chosen, numbers=numbers)


def speaks_of_known_functions(statement: Statement) -> bool:
    """Tell whether f is given where a statement is about it, its zeros or its poles."""
    names = {n.name for e in statement.equations for t in (e.lhs, e.rhs) for n in walk(t) if isinstance(n, Symbol)}
    return not names & FUNCTIONS or _definition_of_f(statement) is not None


def _definition_of_f(statement: Statement) -> Term | None:
    for c in statement.theory.conditions:
        if c.relation in ("=", ":=") and str(c.lhs) == "f(s)":
            return c.rhs
    return None


def _monic(generator: random.Random, degree: int) -> fmpq_poly:
    total = fmpq_poly([1])
    while total.degree() < degree:
        a, b = generator.randint(-3, 3), generator.randint(0, 2)
        pair = b and total.degree() + 2 <= degree
        total *= fmpq_poly([a * a + b * b, -2 * a, 1]) if pair else fmpq_poly([-a, 1])
    return total


def _having(place: Place, top: fmpq_poly, bottom: fmpq_poly) -> Place:
    f = Fractional.make(top, fmpq_poly(), bottom)
    zeros, poles = roots(f.re), roots(f.den)
    functions = {"f": f, "p": Fractional.make(top, fmpq_poly(), fmpq_poly([1])),
                 "q": Fractional.make(bottom, fmpq_poly(), fmpq_poly([1]))}  # fmt: skip
    families = {**place.families, "φ": zeros, "η": poles, "ζ": [z for z in zeros if z.real > 0]}
    return replace(place, functions=functions, families=families)


# ------------------------------------------------------------------------------------------------ hypotheses
def admissible(place: Place, statement: Statement) -> bool:
    """Tell whether a plant satisfies what is assumed."""
    theory = statement.theory.theory
    try:
        for name in statement.assumed:
            item = theory.declared.get(name)
            if isinstance(item, Declared) and not _holds(item.statement, place):
                return False
            if isinstance(item, DeclaredFact) and not PROPERTIES[item.kind](_matrix(value(item.matrix, place))):
                return False
        return all(_holds(c, place) for c in statement.theory.conditions if not _defines_function(c))
    except (Undefined, NoValue, LookupError, ValueError, ZeroDivisionError):
        return False


def _defines_function(equation: Equation) -> bool:
    return str(equation.lhs) in ("f(s)", "L(s)") or str(equation.lhs) == str(equation.rhs)


def _holds(equation: Equation, place: Place) -> bool:
    """Tell whether a relation certainly holds."""
    return decided(equation, place) is True


def decided(equation: Equation, place: Place) -> bool | None:
    """Tell whether a relation holds at a plant; None if the balls do not tell.

    A relation about the roots of a family holds if it does for all of them. Balls tell no equality.
    """
    free = [n.name for t in (equation.lhs, equation.rhs) for n in walk(t)
            if isinstance(n, Symbol) and n.name in place.families]  # fmt: skip
    if free and place.root is None and not _is_summed(equation):
        each = [decided(equation, replace(place, root=(free[0], root))) for root in place.families[free[0]]]
        return False if False in each else None if None in each else True
    gap = difference(equation, place)
    match equation.relation:
        case "=" | ":=" | "≠":
            same = _zero(gap)
            return same if same is None or equation.relation != "≠" else not same
        case "⪰" | "≻":
            return PROPERTIES[FACTS[equation.relation]](_matrix(gap))
        case "≥" | ">":
            return _sign(gap, strict=equation.relation == ">")
        case _:
            return None


def _zero(gap: Value) -> bool | None:
    entries = [x for row in gap for x in row] if isinstance(gap, list) else [gap]
    exact = [x.is_zero if isinstance(x, Fractional) else None if x.contains(0) else False for x in entries]
    return False if False in exact else None if None in exact else True


def _sign(gap: Value, strict: bool) -> bool | None:
    x = gap[0][0] if isinstance(gap, list) else gap
    number = x.number() if isinstance(x, Fractional) else None
    if number is not None:
        return number > 0 if strict else number >= 0
    if isinstance(x, Fractional):
        raise NoValue("a function of s is compared")
    x = x.real if isinstance(x, acb) else x
    return True if x > 0 else False if x < 0 else None


def _is_summed(equation: Equation) -> bool:
    from derive.spectral import Total

    return any(isinstance(n, Total) for t in (equation.lhs, equation.rhs) for n in walk(t))


def difference(equation: Equation, place: Place) -> Value:
    """Return lhs - rhs."""
    if isinstance(equation.rhs, Zero) and not equation.rhs.rows:
        return value(equation.lhs, place)
    left, right = value(equation.lhs, place), value(equation.rhs, place)
    if isinstance(left, list) and not isinstance(right, list):
        left = left[0][0] if len(left) == len(left[0]) == 1 else left
    elif isinstance(right, list) and not isinstance(left, list):
        right = right[0][0] if len(right) == len(right[0]) == 1 else right
    if isinstance(left, list) != isinstance(right, list):
        raise NoValue("a matrix is compared with a number")
    return less(left, right)


def _matrix(gap: Value) -> fmpq_mat:
    rows = gap if isinstance(gap, list) else [[gap]]
    numbers = [x.number() if isinstance(x, Fractional) else None for row in rows for x in row]
    if any(x is None for x in numbers):
        raise NoValue("a matrix that is not exact")
    return fmpq_mat(len(rows), len(rows[0]), [x for x in numbers if x is not None])
