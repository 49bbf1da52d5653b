"""Terms and equations as SymPy expressions of matrix symbols.

Operators without a counterpart on matrix expressions (d/dt, E[.], integrals) become one symbol that prints as they do.
SymPy is where the formula may be used further; it has no part in proving it.
"""

from __future__ import annotations

from functools import reduce
from operator import mul
from typing import Any

from derive.analysis import is_scalar
from derive.errors import InputError
from derive.latex import latex
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
from derive.terms import (
    Block,
    Equation,
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
)

__all__ = ["to_sympy"]

NOTHING = ("", "")  # the shape of a bare zero


def to_sympy(statement: Term | Equation) -> Any:
    """Return a SymPy matrix expression, or Eq(lhs, rhs) that is not evaluated.

    Raises:
        InputError: an inequality, since SymPy has no order of symmetric matrices.
    """
    import sympy

    if isinstance(statement, Equation) and is_scalar(statement):
        return _numbers(statement)
    if isinstance(statement, Term):
        return _matrix(statement, shape(statement))
    if statement.relation not in ("=", ":="):
        raise InputError(f"{latex(statement)}: expected an equation, got the relation {statement.relation}")
    wanted = next((s for s in map(shape, (statement.lhs, statement.rhs)) if s != NOTHING), NOTHING)
    return sympy.Eq(_matrix(statement.lhs, wanted), _matrix(statement.rhs, wanted), evaluate=False)


def _numbers(statement: Equation) -> Any:
    """Return a statement about real scalars, an equation or an inequality."""
    import sympy

    relations = {"=": sympy.Eq, ":=": sympy.Eq, "≥": sympy.Ge, ">": sympy.Gt, "≠": sympy.Ne}
    return relations[statement.relation](_number(statement.lhs), _number(statement.rhs), evaluate=False)


def _number(term: Term) -> Any:
    from derive.scalar.formula import real_expression

    return real_expression(term, _spectral)


def _spectral(term: Term) -> Any:
    """Return a number of the frequency domain; roots are numbered by the index that they print."""
    import sympy

    match term:
        case Det(body):
            return sympy.Determinant(_matrix(body, shape(body)))
        case Trace(body) | Entry(body):
            return sympy.Trace(_matrix(body, shape(body)))
        case RealPart(root):
            return sympy.re(_root(root))
        case ImaginaryPart(root):
            return sympy.im(_root(root))
        case Distance(point, Conjugate(root)):
            return sympy.Abs(_number(point) - sympy.conjugate(_root(root))) ** 2
        case Distance(point, Symbol() as root):
            return sympy.Abs(_number(point) - _root(root)) ** 2
        case Roots(point, root, index, count):
            return sympy.Product(_number(point) - _root(root), (_index(index), 1, _number(count)))
        case Total(body, index, count):
            return sympy.Sum(_number(body), (_index(index), 1, _number(count)))
        case Modulus(body):
            return sympy.Abs(_number(body))
        case Growth(root):
            return sympy.log(sympy.Max(1, sympy.Abs(_root(root))))
        case At(body, symbol, point):
            return sympy.Subs(_number(body), _number(symbol), _number(point))
        case TimesLog(x, a):
            return _number(x) * sympy.log(_number(x) ** 2 + _number(a) ** 2)
        case TimesArctan(x, a):
            return sympy.Abs(_number(a)) * sympy.atan(_number(x) / sympy.Abs(_number(a)))
        case _:
            raise InputError(f"{latex(term)}: expected a number")


def _root(root: Symbol) -> Any:
    import sympy

    base: Any = sympy.IndexedBase(root.name, complex=True)
    return base[sympy.Symbol(root.glyph.sub, integer=True)]


def _index(index: Symbol) -> Any:
    import sympy

    return sympy.Symbol(index.glyph.letter or index.name, integer=True)


def shape(term: Term) -> tuple[str, str]:
    """Return the names of the dimensions of a term; blocks are counted like 'n+l', a bare zero has none."""
    match term:
        case Symbol(rows=rows, cols=cols) | Zero(rows, cols):
            return rows, cols
        case Identity(size):
            return size, size
        case Transpose(body) | Inverse(body):
            return _flipped(shape(body))
        case Sum(addends):
            return next((s for s in map(shape, addends) if s != NOTHING), NOTHING)
        case Product(factors):
            shapes = [s for s in map(shape, factors) if s != NOTHING]
            return (shapes[0][0], shapes[-1][1]) if shapes else NOTHING
        case Block(rows):
            return "+".join(shape(row[0])[0] for row in rows), "+".join(shape(t)[1] for t in rows[0])
        case Trace() | Number():
            return NOTHING
        case _:
            return next(map(shape, term.children()), NOTHING)


def _flipped(pair: tuple[str, str]) -> tuple[str, str]:
    return pair[1], pair[0]


def _matrix(term: Term, wanted: tuple[str, str]) -> Any:
    import sympy

    match term:
        case Symbol(scalar=True):
            return sympy.Symbol(latex(term))
        case Number(value):
            return sympy.Rational(value.numerator, value.denominator)
        case Identity(size):
            return sympy.Identity(_size(size))
        case Zero(rows, cols):
            return (
                sympy.ZeroMatrix(*map(_size, (rows, cols) if rows else wanted)) if wanted != NOTHING else sympy.S.Zero
            )
        case Neg(body):
            return -_matrix(body, wanted)
        case Sum(addends):
            return reduce(lambda a, b: a + b, (_matrix(a, wanted) for a in addends))
        case Product(factors):
            return reduce(mul, (_matrix(f, shape(f)) for f in factors))
        case Transpose(body):
            return _matrix(body, _flipped(wanted)).T
        case Inverse(body):
            return _matrix(body, _flipped(wanted)).I
        case Trace(body):
            return sympy.Trace(_matrix(body, shape(body)))
        case Block(rows):
            return sympy.BlockMatrix([[_matrix(t, shape(t)) for t in row] for row in rows])
        case _:
            return sympy.MatrixSymbol(latex(term), *map(_size, shape(term)))


def _size(name: str) -> Any:
    import sympy

    numbers = [
        sympy.Integer(part) if part.isdigit() else sympy.Symbol(part, integer=True, positive=True)
        for part in name.split("+")
    ]
    return reduce(lambda a, b: a + b, numbers)
