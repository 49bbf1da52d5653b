"""Rules by which one letter or scalar of an instance follows from the others."""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from typing import TYPE_CHECKING

from derive.kernel import Poly, parts
from derive.matrix.instance import Instance, stack, unknowns

if TYPE_CHECKING:
    from flint import fmpq

__all__ = ["Rule"]


@dataclass(frozen=True)
class Rule:
    """How one letter or scalar follows from others: by inverting ``poly``, or by solving poly = 0 for it."""

    target: str
    kind: str  # 'inverse', 'matrix' or 'scalar'
    poly: Poly

    def apply(self, instance: Instance) -> bool:
        """Set the target's value; False if there is none."""
        if self.kind == "inverse":
            return _invert(self, instance)
        return (_solve if self.kind == "matrix" else _solve_scalar)(self, instance)


def _invert(rule: Rule, instance: Instance) -> bool:
    value = instance.evaluate(rule.poly)
    if value.nrows() != value.ncols() or value.det() == 0:
        return False
    instance.values[rule.target] = value.inv()
    return True


def _solve(rule: Rule, instance: Instance) -> bool:
    """Solve poly(X) = 0, linear in X, for the solution whose free entries are zero; X = f is read off."""
    if _read_off(rule, instance):
        return True
    directions = _directions(rule.target, instance)
    zero = directions[0] * 0
    start = _entries(rule, instance, zero)
    columns = [[a - b for a, b in zip(_entries(rule, instance, d), start, strict=True)] for d in directions]
    system = stack([[*(c[i] for c in columns), -start[i]] for i in range(len(start))])
    echelon, rank = system.rref()
    total = zero
    for i in range(rank):
        pivot = next(j for j in range(len(directions) + 1) if echelon[i, j] != 0)
        if pivot == len(directions):
            return False
        total += directions[pivot] * echelon[i, len(directions)]
    instance.values[rule.target] = total
    return True


def _read_off(rule: Rule, instance: Instance) -> bool:
    """Set X = -f / c for a relation c X + f with X alone in one term; False if it is not of this form."""
    key = (), (rule.target,)
    symmetric = instance.alphabet.letters[parts(rule.target)[0]].symmetric
    rest = Poly({k: c for k, c in rule.poly.terms.items() if k != key}, rule.poly.rows, rule.poly.cols)
    if key not in rule.poly.terms or rule.target in unknowns(rest):
        return False
    factor = rule.poly.terms[key]
    value = instance.evaluate(rest) * fmpq_of(-1 / factor)
    if symmetric and value != value.transpose():
        return False
    instance.values[rule.target] = value
    return True


def fmpq_of(value: Fraction) -> fmpq:
    """Return a fraction of the standard library as a rational number of FLINT."""
    from flint import fmpq

    return fmpq(value.numerator, value.denominator)


def _entries(rule: Rule, instance: Instance, value) -> list:
    instance.values[rule.target] = value
    return instance.evaluate(rule.poly).entries()


def _directions(target: str, instance: Instance) -> list:
    """Return a basis of the values that a letter may take."""
    from flint import fmpq_mat

    rows, cols = instance.shape(target)
    symmetric = instance.alphabet.letters[parts(target)[0]].symmetric
    basis = []
    for i in range(rows):
        for j in range(i if symmetric else 0, cols):
            unit = fmpq_mat(rows, cols)
            unit[i, j] = 1
            if symmetric:
                unit[j, i] = 1
            basis.append(unit)
    return basis


def _solve_scalar(rule: Rule, instance: Instance) -> bool:
    """Solve a + b x = 0 for a central scalar."""
    from flint import fmpq

    instance.scalars[rule.target] = fmpq(0)
    a = instance.central(rule.poly)
    instance.scalars[rule.target] = fmpq(1)
    b = instance.central(rule.poly) - a
    if b == 0:
        return False
    instance.scalars[rule.target] = -a / b
    return True
