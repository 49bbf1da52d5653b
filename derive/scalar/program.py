"""Closed forms as programs: guarded branches over one expression language, printed for NumPy, CasADi, C and JavaScript.

A branch (condition, expression) is taken where its condition holds and none before it did; where none holds, the
formula is not defined and the program returns NaN. Expressions are presentation terms, so that what is computed is
what was proved.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from fractions import Fraction
from typing import Any

from derive.errors import InputError
from derive.functions import Abs, Exp, Log, Max, Power, Quotient, Root
from derive.terms import Equation, Neg, Number, Product, Sum, Symbol, Term, Zero

__all__ = ["Branch", "Let", "Program"]

CHUNK = 32768  # points at a time, so that intermediate results stay in the cache
RELATIONS = {"=": "==", ">": ">", "≥": ">=", "≠": "!="}


@dataclass(frozen=True)
class Let:
    """A name for an expression that several branches share."""

    symbol: Symbol
    body: Term


@dataclass(frozen=True)
class Branch:
    """An expression and the conditions, all of them, under which it is taken; ``step`` is its proof."""

    conditions: tuple[Equation, ...]
    body: Term
    step: str


@dataclass(frozen=True)
class Program:
    """Arguments, shared expressions, and branches in order."""

    name: str
    arguments: tuple[Symbol, ...]
    lets: tuple[Let, ...]
    branches: tuple[Branch, ...]

    def to_numpy(self) -> Callable[..., Any]:
        """Return a function of arrays (broadcast) that returns an array, or a float for numbers."""
        import numpy as np

        from derive.scalar.tape import Tape

        tape = Tape(self)

        def evaluate(*values: Any) -> Any:
            if len(values) != len(self.arguments):
                raise InputError(f"{self.name}: expected {len(self.arguments)} arguments, got {len(values)}")
            arrays = np.broadcast_arrays(*(np.asarray(v, dtype=float) for v in values))
            flat = [a.ravel() for a in arrays]
            out = np.empty(flat[0].shape)
            room = tape.buffers(min(CHUNK, out.size))
            with np.errstate(all="ignore"):
                for i in range(0, out.size, CHUNK):
                    tape.run([a[i : i + CHUNK] for a in flat], out[i : i + CHUNK], room)
            return out.reshape(arrays[0].shape)[()]

        return evaluate

    def to_casadi(self) -> Any:
        """Return a CasADi function of scalars."""
        import casadi

        env: dict[str, Any] = {s.name: casadi.SX.sym(identifier(s)) for s in self.arguments}
        inputs = list(env.values())
        for let in self.lets:
            env[let.symbol.name] = _fold(let.body, env, casadi_function)
        result = casadi.SX(float("nan"))
        for branch in reversed(self.branches):
            tests = [_test(c, env, casadi_function) for c in branch.conditions]
            taken = tests[0] if tests else casadi.SX(1)
            for test in tests[1:]:
                taken = casadi.logic_and(taken, test)
            result = casadi.if_else(taken, _fold(branch.body, env, casadi_function), result)
        return casadi.Function(self.name, inputs, [result])

    def to_c(self) -> str:
        """Return the source of a C99 function of doubles."""
        arguments = ", ".join(f"double {identifier(s)}" for s in self.arguments)
        lines = ["#include <math.h>", "", f"double {self.name}({arguments})", "{"]
        lines += [f"    const double {identifier(t.symbol)} = {_text(t.body, C)};" for t in self.lets]
        for branch in self.branches:
            test = " && ".join(_test(c, None, C) for c in branch.conditions) or "1"
            lines.append(f"    if ({test}) return {_text(branch.body, C)};")
        return "\n".join([*lines, "    return NAN;", "}", ""])

    def to_javascript(self) -> str:
        """Return the source of a JavaScript function."""
        lines = [f"function {self.name}({', '.join(map(identifier, self.arguments))}) {{"]
        lines += [f"  const {identifier(t.symbol)} = {_text(t.body, JAVASCRIPT)};" for t in self.lets]
        for branch in self.branches:
            test = " && ".join(_test(c, None, JAVASCRIPT) for c in branch.conditions) or "true"
            lines.append(f"  if ({test}) return {_text(branch.body, JAVASCRIPT)};")
        return "\n".join([*lines, "  return NaN;", "}", ""])


NAMES = {"σ": "sigma", "ω": "omega", "λ": "lambda_", "ρ": "rho", "τ": "tau", "-": "minus", "+": "plus", "'": "_next"}


def identifier(symbol: Symbol) -> str:
    """Return a name that every language accepts."""
    text = "".join(NAMES.get(c, c) for c in symbol.name)
    return "".join(c if (c.isalnum() and c.isascii()) or c == "_" else "_" for c in text).strip("_") or "x"


# ------------------------------------------------------------------------------------------------ text
@dataclass(frozen=True)
class Language:
    """How functions are called."""

    functions: Mapping[str, str]
    number: Callable[[Fraction], str]


def _decimal(value: Fraction) -> str:
    top, bottom = f"{value.numerator}.0", f"{value.denominator}.0"
    return top if value.denominator == 1 else f"({top}/{bottom})"


SAME = ("sqrt", "exp", "log", "expm1", "log1p")  # 1 - exp(x) is written with expm1, ln(1 - x) with log1p
C = Language({**{k: k for k in SAME}, "abs": "fabs", "max": "fmax"}, _decimal)
JAVASCRIPT = Language({k: f"Math.{k}" for k in (*SAME, "abs", "max")}, _decimal)


def _text(term: Term, language: Language) -> str:
    call = language.functions
    match term:
        case Symbol():
            return identifier(term)
        case Number(value):
            return language.number(value) if value >= 0 else f"(-{language.number(-value)})"
        case Zero():
            return "0.0"
        case Neg(body):
            return f"(-{_text(body, language)})"
        case Sum((Number(Fraction(numerator=1, denominator=1)), Neg(Exp(body)))):
            return f"(-{call['expm1']}({_text(body, language)}))"
        case Sum(addends):
            return "(" + " + ".join(_text(a, language) for a in addends).replace("+ (-", "- (") + ")"
        case Product(factors):
            return "(" + "*".join(_text(f, language) for f in factors) + ")"
        case Quotient(top, bottom):
            return f"({_text(top, language)}/{_text(bottom, language)})"
        case Power(body, exponent) if exponent > 0:
            return "(" + "*".join([_text(body, language)] * exponent) + ")"
        case Root(body):
            return f"{call['sqrt']}({_text(body, language)})"
        case Abs(body):
            return f"{call['abs']}({_text(body, language)})"
        case Max(body):
            return f"{call['max']}(0.0, {_text(body, language)})"
        case Exp(body):
            return f"{call['exp']}({_text(body, language)})"
        case Log(Sum((Number(Fraction(numerator=1, denominator=1)), Neg(body)))):
            return f"{call['log1p']}((-{_text(body, language)}))"
        case Log(body):
            return f"{call['log']}({_text(body, language)})"
        case _:
            raise InputError(f"{type(term).__name__}: no expression for it; export a closed form")


def _test(condition: Equation, env: Mapping[str, Any] | None, language: Any) -> Any:
    if isinstance(language, Language):
        return f"{_text(condition.lhs, language)} {RELATIONS[condition.relation]} {_text(condition.rhs, language)}"
    left, right = _fold(condition.lhs, env or {}, language), _fold(condition.rhs, env or {}, language)
    return {"=": left == right, ">": left > right, "≥": left >= right, "≠": left != right}[condition.relation]


# ------------------------------------------------------------------------------------------------ values
def casadi_function(name: str, value: Any) -> Any:
    """Apply a function of CasADi."""
    import casadi

    if name == "max":
        return casadi.fmax(0, value)
    return getattr(casadi, {"abs": "fabs"}.get(name, name))(value)


def _fold(term: Term, env: Mapping[str, Any], apply: Callable[[str, Any], Any]) -> Any:
    match term:
        case Symbol(name=name):
            return env[name]
        case Number(value):
            return float(value)
        case Zero():
            return 0.0
        case Neg(body):
            return -_fold(body, env, apply)
        case Sum((Number(Fraction(numerator=1, denominator=1)), Neg(Exp(body)))):
            return -apply("expm1", _fold(body, env, apply))
        case Sum(addends):
            return sum((_fold(a, env, apply) for a in addends[1:]), _fold(addends[0], env, apply))
        case Product(factors):
            total = _fold(factors[0], env, apply)
            for factor in factors[1:]:
                total = total * _fold(factor, env, apply)
            return total
        case Quotient(top, bottom):
            return _fold(top, env, apply) / _fold(bottom, env, apply)
        case Power(body, exponent):
            return _fold(body, env, apply) ** exponent
        case Log(Sum((Number(Fraction(numerator=1, denominator=1)), Neg(body)))):
            return apply("log1p", -_fold(body, env, apply))
        case Root(body) | Abs(body) | Max(body) | Exp(body) | Log(body):
            names = {Root: "sqrt", Abs: "abs", Max: "max", Exp: "exp", Log: "log"}
            return apply(names[type(term)], _fold(body, env, apply))
        case _:
            raise InputError(f"{type(term).__name__}: no expression for it; export a closed form")
