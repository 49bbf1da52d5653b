"""A program as a tape of NumPy operations, each expression computed once and only while some point needs it."""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from typing import Any

import numpy as np

from derive.errors import InputError
from derive.functions import Abs, Exp, Log, Max, Power, Quotient, Root
from derive.scalar.program import Program
from derive.terms import Equation, Neg, Number, Product, Sum, Symbol, Term, Zero

__all__ = ["Tape"]

UNARY = {Root: np.sqrt, Abs: np.abs, Exp: np.exp, Log: np.log, Neg: np.negative}
LOGICAL = frozenset((np.equal, np.greater, np.greater_equal, np.not_equal, np.logical_and))
TESTS = {"=": np.equal, ">": np.greater, "≥": np.greater_equal, "≠": np.not_equal}


def choose(mask: Any, out: Any, other: Any) -> None:
    """Keep ``out`` where the mask holds, else take ``other``; by bits, since a mask is hard to predict for a branch."""
    bits, room = mask.astype(np.int64), out.view(np.int64)
    np.negative(bits, out=bits)
    change = room ^ np.broadcast_to(np.asarray(other, float), out.shape).view(np.int64)
    np.invert(bits, out=bits)
    np.bitwise_and(bits, change, out=bits)
    np.bitwise_xor(room, bits, out=room)


class Tape:
    """Operations in order; ``plan`` says for each branch how far to go and where its condition and value are."""

    def __init__(self, program: Program):
        self.operations: list[tuple[Any, tuple[int, ...]]] = []
        self.known: dict[Any, int] = {}
        for symbol in program.arguments:
            self._add(("argument", symbol.name), None)
        for let in program.lets:
            self.known["argument", let.symbol.name] = self._term(let.body)
        self.plan: list[tuple[int, int | None, int, int]] = []
        for branch in program.branches:
            tests = [self._test(c) for c in branch.conditions]
            taken = tests[0] if tests else None
            for test in tests[1:]:
                assert taken is not None
                taken = self._add((np.logical_and, taken, test), np.logical_and, taken, test)
            before = len(self.operations)
            value = self._term(branch.body)
            self.plan.append((before, taken, len(self.operations), value))

    def buffers(self, size: int) -> list[Any]:
        """Return room for the result of every operation on at most ``size`` points."""
        return [np.empty(size, bool if f in LOGICAL else float) if inputs else None for f, inputs in self.operations]

    def run(self, arguments: Sequence[Any], out: Any, buffers: Sequence[Any]) -> None:
        """Compute the values at some points; NaN where no branch is taken."""
        values, done = list(arguments), np.zeros(out.shape, bool)
        first = True
        for before, taken, after, value in self.plan:
            self._advance(values, before, buffers, out.size)
            here = values[taken] if taken is not None else np.ones(out.shape, bool)
            if not first and not (here > done).any():
                continue
            self._advance(values, after, buffers, out.size)
            if first:
                out[...] = values[value]
            else:
                choose(done, out, values[value])
            done, first = here | done, False
            if done.all():
                return
        out[~done] = np.nan

    def _advance(self, values: list[Any], stop: int, buffers: Sequence[Any], size: int) -> None:
        for i in range(len(values), stop):
            function, inputs = self.operations[i]
            values.append(function(*(values[k] for k in inputs), out=buffers[i][:size]) if inputs else function)

    def _add(self, key: Any, function: Any, *inputs: int) -> int:
        if key not in self.known:
            self.known[key] = len(self.operations)
            self.operations.append((function, inputs))
        return self.known[key]

    def _apply(self, function: Any, *inputs: int) -> int:
        return self._add((function, *inputs), function, *inputs)

    def _test(self, condition: Equation) -> int:
        return self._apply(TESTS[condition.relation], self._term(condition.lhs), self._term(condition.rhs))

    def _number(self, value: float) -> int:
        return self._add(("number", value), value)

    def _term(self, term: Term) -> int:
        match term:
            case Symbol(name=name):
                return self.known["argument", name]
            case Number(value):
                return self._number(float(value))
            case Zero():
                return self._number(0.0)
            case Sum((Number(Fraction(numerator=1, denominator=1)), Neg(Exp(body)))):
                return self._apply(np.negative, self._apply(np.expm1, self._term(body)))
            case Sum(addends):
                return self._sum(addends)
            case Product(factors):
                return self._fold(np.multiply, [self._term(f) for f in factors])
            case Quotient(top, bottom):
                return self._apply(np.divide, self._term(top), self._term(bottom))
            case Power(body, exponent) if exponent > 0:
                return self._fold(np.multiply, [self._term(body)] * exponent)
            case Log(Sum((Number(Fraction(numerator=1, denominator=1)), Neg(body)))):
                return self._apply(np.log1p, self._apply(np.negative, self._term(body)))
            case Max(body):
                return self._apply(np.maximum, self._number(0.0), self._term(body))
            case Root(body) | Abs(body) | Exp(body) | Log(body) | Neg(body):
                return self._apply(UNARY[type(term)], self._term(body))
            case _:
                raise InputError(f"{type(term).__name__}: no expression for it; export a closed form")

    def _sum(self, addends: Sequence[Term]) -> int:
        total = self._term(addends[0])
        for addend in addends[1:]:
            negative = isinstance(addend, Neg)
            part = self._term(addend.body if isinstance(addend, Neg) else addend)
            total = self._apply(np.subtract if negative else np.add, total, part)
        return total

    def _fold(self, function: Any, inputs: Sequence[int]) -> int:
        total = inputs[0]
        for i in inputs[1:]:
            total = self._apply(function, total, i)
        return total
