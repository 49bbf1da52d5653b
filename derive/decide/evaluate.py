"""The value of a term at an exact instance; inverses are computed, whether they are justified or not."""

from __future__ import annotations

from typing import Any

from derive.decide.gradient import gradient_of
from derive.decide.signals import expanded
from derive.decide.workspace import Workspace
from derive.kernel import Rejected
from derive.matrix.instance import Instance, beside, one, stack
from derive.rules import expect
from derive.terms import (
    Block,
    Dot,
    Equation,
    Expect,
    Gradient,
    Identity,
    Inverse,
    Neg,
    Number,
    Product,
    Sum,
    Symbol,
    Term,
    Trace,
    Transpose,
    Zero,
    lower,
)

__all__ = ["NoValue", "Point"]


class NoValue(Exception):  # noqa: N818 - what was found about a term
    """A term has no value at an instance: an inverse of a singular matrix, shapes that do not fit, a letter unknown."""


class Point:
    """An instance with the reading by which operators are evaluated; values of subterms are kept."""

    def __init__(self, instance: Instance, work: Workspace):
        self.instance, self.work = instance, work
        self.known: dict[Term, Any] = {}

    def value(self, term: Term) -> Any:
        """Return a matrix, or a number for a scalar or trace.

        Raises:
            NoValue: there is none.
        """
        found = self.known.get(term)
        if found is None:
            try:
                found = self.known[term] = self._value(term)
            except (LookupError, ValueError, ZeroDivisionError, TypeError, Rejected) as error:
                raise NoValue(str(error)) from error
        return found

    def _value(self, term: Term) -> Any:
        from flint import fmpq, fmpq_mat

        match term:
            case Number(value):
                return fmpq(value.numerator, value.denominator)
            case Symbol(scalar=True, name=name):
                return self.instance.scalars[name]
            case Symbol():
                return self.instance.values[term.letter]
            case Identity(size):
                return one(self.instance.size(size))
            case Zero(rows, cols):
                return fmpq_mat(self.instance.size(rows), self.instance.size(cols))
            case Neg(body):
                return self.value(body) * -1
            case Sum(addends):
                total = self.value(addends[0])
                for addend in addends[1:]:
                    total = total + self.value(addend)
                return total
            case Product(factors):
                total = self.value(factors[0])
                for factor in factors[1:]:
                    total = total * self.value(factor)
                return total
            case Transpose(body):
                return self.value(body).transpose()
            case Inverse(body):
                return self.value(body).inv()
            case Trace(body):
                matrix = self.value(body)
                if matrix.nrows() != matrix.ncols():
                    raise ValueError("the trace is that of a square matrix")
                return sum((matrix[i, i] for i in range(matrix.nrows())), fmpq(0))
            case Block(rows):
                return stack([r for row in rows for r in beside([self.value(t) for t in row])])
            case Dot():
                grid = lower(term, self.work.reading)
                return stack([r for row in grid for r in beside([self.instance.evaluate(p) for p in row])])
            case Gradient():
                found = gradient_of(Equation(term, "=", Zero("", "")), self.work)
                if found is None:
                    raise ValueError("no rule gives this gradient")
                return self.instance.evaluate(found)
            case Expect():
                image = expanded(Equation(term, "=", Zero("", "")), self.work)[0]
                return self.instance.evaluate(expect(image, self.work.reading.context))
            case _:
                raise ValueError(f"{type(term).__name__} is not evaluated")
