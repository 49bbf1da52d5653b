"""How terms about numbers are read: roots, quotients, functions, limits, integrals, and the frequency domain.

A term prints as it was written; ``value`` gives its meaning, a polynomial in central scalars, with derivatives and
limits evaluated by the rules of calculus.py. A root, a quotient or a logarithm is read only where the theory declares
it, which it does with the reason why it is defined. Standard library only.
"""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction

from derive.analysis import (
    Abs,
    Arctan,
    Definite,
    Exp,
    Infinity,
    Limit,
    Log,
    Max,
    Power,
    Quotient,
    Rate,
    Root,
    Start,
    point_of,
    put,
    replaced,
)
from derive.calculus import at_origin, derivative, limit, reflect
from derive.entries import entry_of, single_of, square_of, trace_of
from derive.kernel import ANY, Poly, Rejected, identity
from derive.real import (
    AXIS,
    CIRCLE,
    COMPLEX,
    FREQUENCY,
    INFINITY,
    ONE,
    ORIGIN,
    ROUND,
    STEPS,
    TIME,
    UNIT,
    ZERO,
    Atom,
    Family,
    Real,
    constant,
    multiply,
    power,
    reciprocal,
    scalar,
)
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
from derive.terms import MissingInverse, Neg, Number, Product, Reading, Sum, Symbol, Term, Trace, Zero, walk

PI = Symbol(CIRCLE, scalar=True)
TURN = Product((Symbol(UNIT, scalar=True), Symbol(FREQUENCY, scalar=True)))  # jω
UNITY, BELOW = Number(Fraction(1)), Sum((Number(Fraction(1)), Power(TURN.factors[1], 2)))  # 1 and 1 + ω^2
ANGLE = Exp(TURN)  # the point of the unit circle at the angle ω
ON_CIRCLE = Quotient(Sum((UNITY, TURN)), Sum((UNITY, Neg(TURN))))  # the one at the angle 2 arctan ω


def value(term: Term, reading: Reading) -> Poly:
    """Read a term as a polynomial in scalars.

    Raises:
        Rejected: a root, quotient or logarithm that is not declared, or a function without a rule.
    """
    real = reading.real
    match term:
        case Symbol(scalar=True):
            return _symbol(term, reading)
        case Number(number):
            return constant(number)
        case Zero("", ""):
            return ZERO
        case Neg(body):
            return -value(body, reading)
        case Sum(addends):
            total = ZERO
            for addend in addends:
                total = total + value(addend, reading)
            return total
        case Product(factors):
            total = ONE
            for factor in factors:
                total = multiply(total, value(factor, reading))
            return total
        case Power(body, exponent) if exponent >= 0:
            return power(value(body, reading), exponent)
        case Quotient(top, bottom):
            return multiply(value(top, reading), _over(bottom, reading))
        case Log(Modulus() | At()):
            return _spectral(term, reading)
        case Log(Quotient(top, bottom)):
            return value(Log(top), reading) - value(Log(bottom), reading)
        case Log(Distance(point, root)) if point == ON_CIRCLE:
            return value(Log(_chord(root)), reading)
        case Root(body) | Abs(body) | Max(body) | Exp(body) | Log(body) | Arctan(body):
            return scalar(_atom(term, value(body, reading), real))
        case Rate(body, symbol):
            return derivative(value(body, reading), variable(symbol, reading), real)
        case Start(body, Symbol(name=name) as symbol):
            steps = name == STEPS and real.sequences
            return at_origin(value(body, reading), name if steps else variable(symbol, reading), real)
        case Limit(body, symbol, point):
            return limit(value(body, reading), variable(symbol, reading), point_of(point), real, reading.context)
        case Definite():
            return _integral(term, reading)
        case _:
            return _spectral(term, reading)


def _symbol(symbol: Symbol, reading: Reading) -> Poly:
    """Read a scalar that the theory declares; one that stands for another is read once that is known."""
    real, name = reading.real, symbol.name
    if symbol.args or name not in reading.context.alphabet.scalars:
        raise Rejected(f"{symbol.letter} is no scalar of the theory")
    if name in real.families or name in {f.index for f in real.families.values()}:
        raise Rejected(f"{name} is no number: a root is read by its parts, and an index numbers roots")
    if name in real.pending and name not in real.atoms:
        raise MissingInverse(f"{name} is not defined yet")
    return scalar(name)


def variable(symbol: Symbol, reading: Reading) -> str:
    """Return the name of a variable of a derivative, limit or integral: a scalar that stands for nothing else."""
    real, name = reading.real, symbol.name
    _symbol(symbol, reading)
    parts = {p for f in real.families.values() for p in (f.real, f.imaginary, f.count)}
    if not symbol.scalar or name in real.atoms or name in (CIRCLE, UNIT) or name in parts:
        raise Rejected(f"{name} is no variable")
    if real.sequences and (name == STEPS or real.sequence(name)):
        raise Rejected(f"{name}: the number of steps and the members of a sequence do not vary continuously")
    return name


KINDS = {Root: "root", Abs: "absolute", Max: "part", Exp: "exp", Log: "log", Arctan: "arctan"}


def _atom(term: Term, of: Poly, real: Real) -> str:
    name = real.find(KINDS[type(term)], of)
    if name is None:
        raise MissingInverse(f"a {type(term).__name__.lower()} that is not declared, or whose reason is not proved yet")
    return name


# ------------------------------------------------------------------------------------------------ frequency domain
def _spectral(term: Term, reading: Reading) -> Poly:
    """Read a term of the frequency domain: a family of roots, a determinant or trace, a logarithm on the axis."""
    match term:
        case RealPart(root):
            return scalar(_family(root, reading).real)
        case ImaginaryPart(root):
            return scalar(_family(root, reading).imaginary)
        case Growth(root):
            size = Sum((Power(RealPart(root), 2), Power(ImaginaryPart(root), 2)))
            return value(Log(Sum((UNITY, Max(Sum((size, Neg(UNITY))))))), reading).scale(Fraction(1, 2))
        case Distance(point, root) if point == ON_CIRCLE:
            return value(_chord(root), reading)
        case Distance(point, root):
            return _distance(point, root, reading)
        case Total(body, index, count):
            return total(value(body, reading), index.name, count.name, reading.real)
        case Det() | Roots() | TimesLog() | TimesArctan() | Log():
            atom = spectral_atom("", term, reading)
            if atom.kind == "det" and atom.of == identity(atom.of.rows):
                return ONE
            name = _find(atom, reading)
            if name is None:
                raise MissingInverse(f"{atom.kind}: not declared, or its reason is not proved yet")
            return scalar(name)
        case Trace(body):
            return trace_of(body, reading)
        case Entry(body):
            return entry_of(single_of(body, reading), reading)
        case _:
            raise Rejected(f"{type(term).__name__} has no meaning as a scalar")


def spectral_atom(name: str, term: Term, reading: Reading) -> Atom:
    """Return the atom that a determinant, trace, product over roots, sum or logarithm stands for."""
    match term:
        case Det(body) | Trace(body):
            poly, kind = square_of(body, reading), "det" if isinstance(term, Det) else "trace"
            return Atom(name, kind, poly, over="" if reading.context.is_real(poly) else COMPLEX)
        case Roots(point, root, index, count):
            family = _family(root, reading)
            if (family.index, family.count) != (index.name, count.name):
                raise Rejected(f"the roots {root.name} are numbered otherwise")
            if point not in (Symbol(COMPLEX, scalar=True), Neg(Symbol(COMPLEX, scalar=True))):
                raise Rejected("a product over roots is read at s or -s")
            return Atom(name, "roots", value(point, reading), over=root.name)
        case Total(body, index, _):
            poly = value(body, reading)
            if list(poly.terms.values()) != [1]:
                raise Rejected("a sum is declared of one product")
            return Atom(name, "sum", poly, over=index.name)
        case TimesLog(factor, width):
            return Atom(name, "times log", value(factor, reading), value(width, reading))
        case TimesArctan(factor, width):
            return Atom(name, "times arctan", value(factor, reading), value(width, reading))
        case Log(Modulus(At(body, symbol, point))):
            return Atom(name, "log modulus", value(body, reading), over=_variable(symbol, point))
        case Log(At(body, symbol, point)):
            return Atom(name, "log value", value(body, reading), over=_variable(symbol, point))
        case _:
            raise Rejected(f"{type(term).__name__} stands for no atom")


def _variable(symbol: Symbol, point: Term) -> str:
    """Return the real variable of a point: ω on the imaginary axis and on the circle, s itself along the reals."""
    if symbol.name != COMPLEX:
        raise Rejected("a function is taken at a point of its variable s")
    match point:
        case Symbol(name=name) if name == COMPLEX:
            return COMPLEX
        case Product((Symbol() as j, Symbol() as w)) if (j.name, w.name) == AXIS:
            return FREQUENCY
        case Quotient() if point == ON_CIRCLE:
            return ROUND
        case Sum((Symbol(scalar=True, name=x), Product((Symbol() as j, Symbol(scalar=True, name=y))))) if (
            j.name == AXIS[0]
        ):
            if {x, y} & {COMPLEX, *AXIS} or " " in x + y:
                raise Rejected("a point of the plane has a real and an imaginary part that stay what they are")
            return f"{x} {y}"
        case _:
            raise Rejected("a function is taken on the axis or the unit circle, along the reals, or at a point x + jy")


def _distance(point: Term, root: Term, reading: Reading) -> Poly:
    """Read |point - root|^2 for a point on the imaginary axis, or on the real axis."""
    conjugate = isinstance(root, Conjugate)
    symbol = root.root if isinstance(root, Conjugate) else root
    if not isinstance(symbol, Symbol):
        raise Rejected("a distance is that to a root of a family")
    family = _family(symbol, reading)
    re, im = scalar(family.real), scalar(family.imaginary).scale(-1 if conjugate else 1)
    match point:
        case Product((Symbol() as j, Symbol() as w)) if (j.name, w.name) == AXIS:
            along, across = scalar(FREQUENCY) - im, re
        case Symbol(name=name) | Neg(Symbol(name=name)) if name == COMPLEX:
            along, across = value(point, reading) - re, im
        case _:
            raise Rejected("a distance is taken on the imaginary axis, or along the reals")
    return along * along + across * across


def _chord(root: Term) -> Quotient:
    """Return |(1 + jω)/(1 - jω) - λ|^2 = |(1 - λ) + jω (1 + λ)|^2 / (1 + ω^2) for λ = a + jb, or for its conjugate."""
    symbol = root.root if isinstance(root, Conjugate) else root
    if not isinstance(symbol, Symbol):
        raise Rejected("a distance is that to a root of a family")
    a, b = RealPart(symbol), Neg(ImaginaryPart(symbol)) if isinstance(root, Conjugate) else ImaginaryPart(symbol)
    w, minus = TURN.factors[1], Neg(b)
    along, across = Sum((UNITY, Neg(a), Product((w, minus)))), Sum((Product((w, Sum((UNITY, a)))), minus))
    return Quotient(Sum((Power(along, 2), Power(across, 2))), BELOW)


def _family(root: Symbol, reading: Reading) -> Family:
    family = reading.real.families.get(root.name)
    if family is None:
        raise Rejected(f"{root.name} is no family of roots")
    return family


def _find(atom: Atom, reading: Reading) -> str | None:
    found = reading.real.find(atom.kind, atom.of, atom.by, atom.over)
    if found is None and atom.kind == "det":
        return reading.real.find("det", reading.context.alphabet.transpose(atom.of), None, atom.over)
    return found


def total(poly: Poly, index: str, count: str, real: Real) -> Poly:
    """Return the sum over an index: of each product the part that carries the index, which is declared as a sum."""
    counts = {(f.index, f.count) for f in real.families.values()}
    if (index, count) not in counts:
        raise Rejected(f"{index} is not the index of a family with {count} members")
    result = ZERO
    for (m, _), c in poly.terms.items():
        moving = tuple(s for s in m if real.varies(s, index))
        fixed = Poly({(tuple(s for s in m if s not in moving), ()): c}, ANY, ANY)
        name = real.find("sum", Poly({(moving, ()): 1}, ANY, ANY), None, index) if moving else count
        if name is None:
            raise MissingInverse(f"the sum of {' '.join(moving)} is not declared")
        result = result + multiply(fixed, scalar(name))
    return result


# ------------------------------------------------------------------------------------------------ quotients, integrals
def _over(term: Term, reading: Reading) -> Poly:
    try:
        return over(term, reading)
    except MissingInverse:
        raise
    except Rejected as error:
        raise MissingInverse(str(error)) from None


def over(term: Term, reading: Reading) -> Poly:
    """Return the reciprocal of a term, factor by factor unless the whole is declared."""
    try:
        return reciprocal(value(term, reading), reading.real)
    except Rejected:
        match term:
            case Product(factors):
                total = ONE
                for factor in factors:
                    total = multiply(total, over(factor, reading))
                return total
            case Power(body, exponent):
                return power(over(body, reading), exponent)
            case Quotient(top, bottom):
                over(bottom, reading)  # the quotient exists
                return multiply(value(bottom, reading), over(top, reading))
            case _:
                raise


def _integral(term: Definite, reading: Reading) -> Poly:
    if (term.lower, term.upper) == (Neg(PI), PI):
        term = around(term, reading)
    if (point_of(term.lower), point_of(term.upper)) == (ORIGIN, "t"):
        assert isinstance(term.upper, Symbol)
        variable(term.upper, reading)
        _check_bound(term, reading)
        name = reading.real.find("integral", value(replaced(term.body, term.symbol, term.upper), reading))
        if name is None:
            raise MissingInverse("an integral from 0 to t that is not declared")
        return scalar(name)
    body, bounds = value(term.body, reading), (point_of(term.lower), point_of(term.upper))
    whole = bounds == ("-" + INFINITY, INFINITY)
    mirrored = reflect(body, FREQUENCY, reading.real) if whole else body
    if mirrored != body:  # the limit of the integral over -R to R: that of f(ω) + f(-ω) over half of the axis
        body, whole, bounds = body + mirrored, False, (ORIGIN, INFINITY)
    name = reading.real.find("improper", body)
    if name is None or variable(term.symbol, reading) != FREQUENCY or not (whole or bounds == (ORIGIN, INFINITY)):
        raise MissingInverse("an improper integral that is not declared")
    return scalar(name).scale(2 if whole else 1)


def around(term: Definite, reading: Reading) -> Definite:
    """Return the integral of F(e^{jω}) over -π < ω < π as one over the axis, by the variable tan(ω/2).

    ∫ F(e^{jω}) dω = ∫ 2/(1 + ω^2) F((1 + jω)/(1 - jω)) dω over the axis

    The tangent takes (-π, π) to the axis one to one, and so does its derivative not vanish; e^{jω} becomes
    (1 + jω)/(1 - jω). The rule reads F by its argument: the integrand has ω in e^{jω} and nowhere else.
    """
    others = {n.name for n in walk(put(term.body, {ANGLE: UNITY})) if isinstance(n, Symbol)}
    if variable(term.symbol, reading) != FREQUENCY or any(reading.real.varies(n, FREQUENCY) for n in others):
        raise Rejected(f"around the circle {FREQUENCY} is the angle, and the integrand a function of the point alone")
    weight = Quotient(Number(Fraction(2)), BELOW)
    return replace(
        term, body=Product((weight, put(term.body, {ANGLE: ON_CIRCLE}))), lower=Neg(Infinity()), upper=Infinity()
    )


def _check_bound(term: Definite, reading: Reading) -> None:
    """Reject an integrand with t as well as the variable of integration, or with what is defined by that."""
    name, real = term.symbol.name, reading.real
    if name != TIME:
        variable(term.symbol, reading)
        others = {s.name for s in walk(term.body) if isinstance(s, Symbol) and s.name != name}
        if name in real.atoms or any(real.varies(s, v) for s in others for v in (name, TIME)):
            raise Rejected(f"the integrand depends on {TIME}, or through a symbol on {name}")
