"""Functions of numbers and matrices: trace, determinant, maximum, absolute value, logarithm, limit."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING

from derive.functions import Abs, Arctan, Exp, Limit, Log, Max, Root
from derive.interpret.arithmetic import ONE, single, square
from derive.interpret.powers import COMPLEX
from derive.interpret.shapes import NotUnderstood, Typed
from derive.latex import latex
from derive.latex import syntax as s
from derive.spectral import Det, ImaginaryPart, Modulus, RealPart
from derive.terms import Neg, Number, Sum, Symbol, Term, Trace, Zero, walk

if TYPE_CHECKING:
    from derive.interpret.reader import Reader

OF_NUMBERS: dict[str, Callable[[Term], Term]] = {"ln": Log, "log": Log, "exp": Exp, "arctan": Arctan, "sqrt": Root}


def called(node: s.Called, reader: Reader) -> Typed:
    """Read a named function of its arguments."""
    if node.function in ("lim", "limit"):
        return limit(node, reader)
    if node.sub is not None:
        said = "write it by the natural logarithm" if node.function == "log" else "leave it out"
        raise NotUnderstood(f"{node.function} with an index has no meaning here: {said}")
    arguments = [a for argument in node.arguments for a in listed(argument)]
    return call(node.function, [reader.read(a) for a in arguments], reader)


def listed(node: s.Node) -> tuple[s.Node, ...]:
    """Return the items of a list in brackets, or the node itself."""
    inner = node.body if isinstance(node, s.Fenced) and node.fence in "([{" else node
    return inner.items if isinstance(inner, s.Listed) else (node,)


def call(function: str, arguments: list[Typed], reader: Reader) -> Typed:
    """Return a function of its arguments."""
    if function in ("max", "min"):
        return extremum(function, arguments, reader)
    if len(arguments) != 1:
        raise NotUnderstood(f"{function}: expected one argument, got {len(arguments)}")
    term, shape = arguments[0]
    if function in ("tr", "Tr", "trace", "det"):
        square(arguments[0], "a trace" if function != "det" else "a determinant", reader)
        if shape is None:
            return term, None
        return (Det(term) if function == "det" else Trace(term)), None
    value = as_number(arguments[0], f"the argument of {function}", reader)
    if function in ("Re", "Im"):
        return part(function, value, reader), None
    if function not in OF_NUMBERS:
        raise NotUnderstood(f"{function}: a function that is not read; known are tr det max min Re Im ln exp arctan")
    return OF_NUMBERS[function](value), None


def as_number(typed: Typed, what: str, reader: Reader) -> Term:
    """Return a number; a matrix of one row and column is one."""
    term, shape = typed
    if shape is None:
        return term
    if single(shape, reader):
        return Trace(term)
    raise NotUnderstood(f"shapes: {what} is {latex(term)}, a matrix of {reader.shapes.show(shape)}; expected a number")


def part(function: str, value: Term, reader: Reader) -> Term:
    """Return the real or imaginary part of an eigenvalue; a real number is its own."""
    if isinstance(value, Symbol) and value.name in reader.theory.theory.families:
        return RealPart(value) if function == "Re" else ImaginaryPart(value)
    if is_complex(value, reader):
        raise NotUnderstood(f"{function} {latex(value)}: only that of an eigenvalue is read")
    return value if function == "Re" else Zero("", "")


def is_complex(term: Term, reader: Reader) -> bool:
    """Tell whether a term may be complex."""
    theory = reader.theory.theory
    names = {n.name for n in walk(term) if isinstance(n, Symbol)}
    return bool(names & (COMPLEX | theory.families.keys())) or any(
        n in theory.complex and not theory.symbols[n].scalar for n in names if n in theory.symbols
    )


def extremum(function: str, arguments: list[Typed], reader: Reader) -> Typed:
    """Return max(a, b) as a + max(0, b - a), and min(a, b) as a - max(0, a - b)."""
    if len(arguments) < 2:
        raise NotUnderstood(f"{function}: expected two numbers or more, as in \\max\\{{0, A\\}}")
    values = [as_number(a, f"an argument of {function}", reader) for a in arguments]
    found = values[-1]
    for value in reversed(values[:-1]):
        found = larger(value, found) if function == "max" else Neg(larger(negative(value), negative(found)))
    return found, None


def larger(a: Term, b: Term) -> Term:
    """Return the larger of two numbers."""
    if b == Number(ONE.value * 0):
        a, b = b, a
    if isinstance(a, Number) and a.value == 0:
        return Max(b)
    return Sum((a, Max(b - a)))


def negative(term: Term) -> Term:
    """Return minus a number."""
    if isinstance(term, Number):
        return Number(-term.value)
    return term.body if isinstance(term, Neg) else Neg(term)


def fenced(node: s.Fenced, reader: Reader) -> Typed:
    """Read a group; bars are an absolute value."""
    if node.fence in ("|", "\\vert", "\\lvert"):
        return absolute(reader.read(node.body), reader)
    if node.fence not in ("(", "[", "{", ""):
        raise NotUnderstood("a norm: write which one, by a trace or an eigenvalue")
    return reader.read(node.body)


def absolute(typed: Typed, reader: Reader) -> Typed:
    """Return the absolute value of a number, the modulus of a complex one."""
    term, shape = typed
    if shape is not None and not single(shape, reader):
        said = latex(term)
        raise NotUnderstood(f"|{said}| of a matrix: write \\det({said}), or read all dimensions as 1 (scalar)")
    value = as_number(typed, "an absolute value", reader)
    if is_complex(value, reader):
        return Modulus(value), None
    return (Number(abs(value.value)) if isinstance(value, Number) else Abs(value)), None


def limit(node: s.Called, reader: Reader) -> Typed:
    """Read a limit, whose variable and point stand below it; in the limit of time signals are stationary."""
    match node.sub:
        case s.Related((variable, point), ("→",)):
            pass
        case _:
            raise NotUnderstood("a limit: expected its variable below, as in \\lim_{s \\to \\infty}")
    body, shape = reader.read(node.arguments[0])
    symbol, _ = reader.read(variable)
    if not isinstance(symbol, Symbol) or not symbol.scalar:
        raise NotUnderstood("a limit: expected a variable that is a number, such as s or t")
    return Limit(body, symbol, reader.read(point)[0]), shape


HANDLERS: Mapping[type[s.Node], Callable[..., Typed]] = {s.Called: called, s.Fenced: fenced}
