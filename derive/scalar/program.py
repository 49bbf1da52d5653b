"""Closed forms as programs: guarded branches over one expression language, printed for NumPy, CasADi, C and JavaScript.

A branch (condition, expression) is taken where its condition holds and none before it did; where none holds, the
formula is not defined and the program returns NaN. Expressions are presentation terms, so that what is computed is
what was proved.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from fractions import Fraction
from typing import Any

from derive.errors import InputError
from derive.functions import Abs, Exp, Log, Max, Power, Quotient, Root, put
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
        lines += [line for branch in self.branches for line in _branch(branch, C, "    ")]
        return "\n".join([*lines, *self._nowhere("    return NAN;"), "}", ""])

    def to_javascript(self) -> str:
        """Return the source of a JavaScript function."""
        lines = [f"function {self.name}({', '.join(map(identifier, self.arguments))}) {{"]
        lines += [f"  const {identifier(t.symbol)} = {_text(t.body, JAVASCRIPT)};" for t in self.lets]
        lines += [line for branch in self.branches for line in _branch(branch, JAVASCRIPT, "  ")]
        return "\n".join([*lines, *self._nowhere("  return NaN;"), "}", ""])

    def _nowhere(self, line: str) -> list[str]:
        """Return the line for where no branch is taken, if there may be such a place."""
        return [line] if self.branches[-1].conditions else []


NAMES = {"σ": "sigma", "ω": "omega", "λ": "lambda_", "ρ": "rho", "τ": "tau", "-": "minus", "+": "plus", "'": "_next"}


def identifier(symbol: Symbol) -> str:
    """Return a name that every language accepts."""
    text = "".join(NAMES.get(c, c) for c in symbol.name)
    return "".join(c if (c.isalnum() and c.isascii()) or c == "_" else "_" for c in text).strip("_") or "x"


# ------------------------------------------------------------------------------------------------ text
@dataclass(frozen=True)
class Language:
    """How a constant is declared, and how functions are called."""

    constant: str
    functions: Mapping[str, str]


SAME = ("sqrt", "exp", "log", "expm1", "log1p")  # 1 - exp(x) is written with expm1, ln(1 - x) with log1p
C = Language("const double", {**{k: k for k in SAME}, "abs": "fabs", "max": "fmax"})
JAVASCRIPT = Language("const", {k: f"Math.{k}" for k in (*SAME, "abs", "max")})
SUM, PRODUCT, FACTOR = 0, 1, 2  # what may stand without parentheses


def _branch(branch: Branch, language: Language, indent: str) -> list[str]:
    """Return the lines of a branch; an exponential function that it uses twice is computed once."""
    body, shared = branch.body, list[str]()
    found = list(_exponentials(body))
    for term in sorted(dict.fromkeys(found), key=lambda t: isinstance(t, Exp)):  # 1 - exp(x) before exp(x) in it
        if found.count(term) > 1:
            kind = "power" if isinstance(term, Exp) else "rest"
            name = Symbol(kind + str(len(shared) + 1), scalar=True)
            shared.append(f"{language.constant} {name.name} = {_text(term, language)};")
            body = put(body, {term: name})
    test = " && ".join(_test(c, None, language) for c in branch.conditions)
    value = f"return {_text(body, language)};"
    if not test:
        return [indent + line for line in (*shared, value)]
    if not shared:
        return [f"{indent}if ({test}) {value}"]
    return [f"{indent}if ({test}) {{", *(indent * 2 + line for line in (*shared, value)), f"{indent}}}"]


def _exponentials(term: Term) -> Iterator[Term]:
    """Iterate over exp(x) and 1 - exp(x) in a term, the larger ones alone."""
    match term:
        case Exp() | Sum((Number(Fraction(numerator=1, denominator=1)), Neg(Exp()))):
            yield term
        case _:
            for child in term.children():
                yield from _exponentials(child)


def _text(term: Term, language: Language, place: int = SUM) -> str:
    """Write a term; ``place`` says what it stands in: a sum, a product, or where only a factor can."""
    level, text = _written(term, language)
    return f"({text})" if level < place else text


def _written(term: Term, language: Language) -> tuple[int, str]:
    call = language.functions
    match term:
        case Symbol():
            return FACTOR, identifier(term)
        case Number(value) if value < 0:
            return SUM, f"-{_text(Number(-value), language, FACTOR)}"
        case Number(value):
            exact = value.denominator == 1 or Fraction(float(value)) == value
            return (FACTOR, repr(float(value))) if exact else (PRODUCT, f"{value.numerator}.0/{value.denominator}.0")
        case Zero():
            return FACTOR, "0.0"
        case Neg(body):
            return SUM, f"-{_text(body, language, PRODUCT)}"
        case Sum((Number(Fraction(numerator=1, denominator=1)), Neg(Exp(body)))):
            return SUM, f"-{call['expm1']}({_text(body, language)})"
        case Sum(addends):
            return SUM, "".join(_addend(a, language, first=i == 0) for i, a in enumerate(addends))
        case Product(factors):
            return PRODUCT, "*".join(_text(f, language, FACTOR if i else PRODUCT) for i, f in enumerate(factors))
        case Quotient(top, bottom):
            return PRODUCT, f"{_text(top, language, PRODUCT)}/{_text(bottom, language, FACTOR)}"
        case Power(body, exponent) if exponent > 0:
            return PRODUCT, "*".join([_text(body, language, FACTOR)] * exponent)
        case Max(body):
            return FACTOR, f"{call['max']}(0.0, {_text(body, language)})"
        case Log(Sum((Number(Fraction(numerator=1, denominator=1)), Neg(body)))):
            return FACTOR, f"{call['log1p']}({_text(Neg(body), language)})"
        case Root(body) | Abs(body) | Exp(body) | Log(body):
            return FACTOR, f"{call[FUNCTIONS[type(term)]]}({_text(body, language)})"
        case _:
            raise InputError(f"{type(term).__name__}: no expression for it; export a closed form")


def _addend(term: Term, language: Language, first: bool) -> str:
    if first:
        return _text(term, language)
    sign, body = ("-", term.body) if isinstance(term, Neg) else ("+", term)
    return f" {sign} {_text(body, language, PRODUCT)}"


FUNCTIONS = {Root: "sqrt", Abs: "abs", Max: "max", Exp: "exp", Log: "log"}


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
            return apply(FUNCTIONS[type(term)], _fold(body, env, apply))
        case _:
            raise InputError(f"{type(term).__name__}: no expression for it; export a closed form")
