"""Derivatives, values at zero, reflections and limits of real numbers that depend on a variable.

A number is a polynomial in scalars (real.py). Each function evaluates it by rules: sums, products, the chain rule, and
what is known of each kind of atom; where no rule applies it raises Rejected. Standard library only.
"""

from __future__ import annotations

from collections.abc import Callable
from fractions import Fraction

from derive.kernel import ANY, Poly, Rejected, Scalars
from derive.real import (
    CIRCLE,
    EVERYWHERE,
    FREQUENCY,
    INFINITY,
    LOGARITHMS,
    ONE,
    ORIGIN,
    ROUND,
    STEPS,
    ZERO,
    Atom,
    Real,
    constant,
    multiply,
    ratio_of,
    reciprocal,
    scalar,
    scalars_of,
)
from derive.rules import Context


def derivative(poly: Poly, variable: str, real: Real) -> Poly:
    """Return d poly/d variable by sum, product and chain rule."""
    total = ZERO
    for (m, _), c in poly.terms.items():
        for i, s in enumerate(m):
            if real.varies(s, variable):
                rest = Poly({((*m[:i], *m[i + 1 :]), ()): c}, ANY, ANY)
                total = total + multiply(rest, rate(s, variable, real))
    return total


def rate(name: str, variable: str, real: Real) -> Poly:
    """Return the derivative of one scalar."""
    if name == variable:
        return ONE
    atom = real.atoms.get(name)
    if atom is None:
        raise Rejected(f"the derivative of {name} is not known")
    inner = derivative(atom.of, variable, real) if atom.kind != "integral" else ZERO
    match atom.kind:
        case "defined":
            return inner
        case "reciprocal":
            return -(scalar(name) * scalar(name) * inner)
        case "exp":
            return scalar(name) * inner
        case "log":
            return inner * reciprocal(atom.of, real)
        case "arctan":
            return inner * reciprocal(ONE + atom.of * atom.of, real)
        case "integral" if variable == "t":
            return atom.of
        case "times log" | "times arctan" if atom.by is not None and not _moves(atom.by, variable, real):
            square, width = atom.of * atom.of, atom.by * atom.by
            over = reciprocal(square + width, real)
            log = real.find("log", square + width) if atom.kind == "times log" else None
            if log is None and atom.kind == "times log":
                raise Rejected(f"the logarithm in {name} is not declared")
            return inner * (scalar(log) + square.scale(2) * over if log else width * over)
        case _:
            raise Rejected(f"no rule for the derivative of {name}, a {atom.kind}")


def _moves(poly: Poly, variable: str, real: Real) -> bool:
    return any(real.varies(s, variable) for s in scalars_of(poly))


def at_origin(poly: Poly, variable: str, real: Real) -> Poly:
    """Return the value where the variable is 0."""
    return substituted(poly, variable, real, lambda name: _atom_at_origin(name, variable, real))


def substituted(poly: Poly, variable: str, real: Real, image: Callable[[str], Poly]) -> Poly:
    """Replace every scalar that depends on a variable by its image."""
    total = ZERO
    for (m, _), c in poly.terms.items():
        product = constant(c)
        for s in m:
            product = multiply(product, image(s) if real.varies(s, variable) else scalar(s))
        total = total + product
    return total


def _atom_at_origin(name: str, variable: str, real: Real) -> Poly:
    if name == variable:
        return ZERO
    if variable == STEPS and name in real.sequences:
        return real.sequences[name].start
    atom = real.atoms.get(name)
    if atom is None:
        raise Rejected(f"the value of {name} at 0 is not known")
    if atom.kind == "integral" and variable == "t":
        return ZERO
    inner = at_origin(atom.of, variable, real)
    match atom.kind:
        case "defined":
            return inner
        case "reciprocal":
            return reciprocal(inner, real)
        case "times log" | "times arctan" if atom.by is not None and not _moves(atom.by, variable, real):
            return _odd(atom, inner, real)
        case "exp" | "arctan" | "root" if inner == ZERO:
            return ONE if atom.kind == "exp" else ZERO
        case "exp" | "arctan" | "log" if real.find(atom.kind, inner):
            return scalar(real.find(atom.kind, inner) or "")
        case _:
            raise Rejected(f"no value of {name} at 0")


def _odd(atom: Atom, inner: Poly, real: Real) -> Poly:
    """Return the value of a function that is odd in its argument, at a point that is declared or minus one."""
    if inner == ZERO:
        return ZERO
    name, turned = real.find(atom.kind, inner, atom.by), real.find(atom.kind, -inner, atom.by)
    if name is None and turned is None:
        raise Rejected(f"no value of {atom.name} at 0")
    return scalar(name) if name else -scalar(turned or "")


def reflect(poly: Poly, variable: str, real: Real) -> Poly:
    """Return the polynomial at minus the variable, which atoms may take into others of their kind."""

    def image(name: str) -> Poly:
        if name == variable:
            return -scalar(name)
        atom = real.atoms.get(name)
        if atom is not None and atom.kind in LOGARITHMS and variable == FREQUENCY and atom.over in (FREQUENCY, ROUND):
            return scalar(name)  # f takes conjugate values at conjugate points, its coefficients are real
        if atom is None or atom.kind not in EVERYWHERE:
            raise Rejected(f"{name} is not even in {variable}")
        found = real.find(atom.kind, reflect(atom.of, variable, real), atom.by, atom.over)
        if found is None:
            raise Rejected(f"{name} is not even in {variable}")
        return scalar(found)

    return substituted(poly, variable, real, image)


def limit(poly: Poly, variable: str, point: str, real: Real, context: Context) -> Poly:
    """Return the limit as the variable, positive, tends to 0 or to infinity: of sums, products and known functions."""
    if point not in (ORIGIN, INFINITY):
        raise Rejected("a limit is taken at 0 or at infinity")
    total = ZERO
    for known in (k for k in real.sums if k[:2] == (variable, point)):
        poly, reached = _less(poly, known[2], known[3], variable, real)
        total = total + reached
    for (m, _), c in poly.terms.items():
        moving = tuple(s for s in m if real.varies(s, variable))
        fixed = Poly({(tuple(s for s in m if s not in moving), ()): c}, ANY, ANY)
        total = total + multiply(fixed, _limit_of_product(moving, variable, point, real, context))
    return total


def _less(poly: Poly, known: Poly, value: Poly, variable: str, real: Real) -> tuple[Poly, Poly]:
    """Subtract the multiple of a sum whose limit is known that removes its first product; return its limit as well."""
    ((first, _), coefficient) = next(iter(known.terms.items()))
    if not first or not all(real.varies(s, variable) for s in first):
        return poly, ZERO
    factor = ZERO
    for (m, _), c in poly.terms.items():
        moving = tuple(s for s in m if real.varies(s, variable))
        if moving == first:
            factor = factor + Poly({(tuple(s for s in m if s not in moving), ()): c / coefficient}, ANY, ANY)
    return poly - factor * known, factor * value


def _limit_of_product(m: Scalars, variable: str, point: str, real: Real, context: Context) -> Poly:
    known = real.limits.get((variable, point, m))
    if known is not None:
        return known
    if len(m) == 2 and point == ORIGIN and variable in m:
        other = real.atoms.get(m[0] if m[1] == variable else m[1])
        if other and other.kind == "log" and other.of == scalar(variable) * scalar(variable):
            return ZERO  # x ln x tends to 0 with x
    for i, s in enumerate(m):
        if s in real.atoms and real.atoms[s].kind == "defined":
            rest = Poly({((*m[:i], *m[i + 1 :]), ()): 1}, ANY, ANY)
            return limit(rest * real.atoms[s].of, variable, point, real, context)
    proper = _limit_of_rational(m, variable, real) if point == INFINITY else None
    if proper is not None:
        return proper
    total = ONE
    for s in m:
        total = total * _limit_of_scalar(s, variable, point, real, context)
    return total


def _limit_of_rational(m: Scalars, variable: str, real: Real) -> Poly | None:
    """Return the limit of x^k times reciprocals of polynomials in x with a number before the highest power, k <= it."""
    degree, leading = 0, Fraction(1)
    for s in m:
        atom = real.atoms.get(s)
        if s == variable:
            degree += 1
        elif atom is not None and atom.kind == "reciprocal":
            powers = [(n.count(variable), n, c) for (n, _), c in atom.of.terms.items()]
            highest = max(k for k, _, _ in powers)
            top = [(n, c) for k, n, c in powers if k == highest]
            if len(top) != 1 or set(top[0][0]) != {variable} or _moves_besides(atom.of, variable, real):
                return None
            degree, leading = degree - highest, leading * top[0][1]
        else:
            return None
    if degree > 0:
        raise Rejected(f"{' '.join(m)} tends to infinity")
    return constant(1 / leading) if degree == 0 else ZERO


def _moves_besides(poly: Poly, variable: str, real: Real) -> bool:
    return any(s != variable and real.varies(s, variable) for s in scalars_of(poly))


def _limit_of_scalar(name: str, variable: str, point: str, real: Real, context: Context) -> Poly:
    known, atom = real.limits.get((variable, point, (name,))), real.atoms.get(name)
    if known is not None:
        return known
    if atom is not None and atom.kind == "defined":
        return limit(atom.of, variable, point, real, context)
    if point == ORIGIN:
        return _atom_at_origin(name, variable, real)
    slope = _slope(atom.of, variable) if atom is not None else None
    if atom is not None and slope is not None and any(real.varies(s, variable) for s in scalars_of(slope)):
        slope = None
    match atom and atom.kind:
        case "reciprocal" if slope == ONE:
            return ZERO
        case "exp" if slope is not None and _positive(-slope, context):
            return ZERO
        case "times arctan" if atom is not None and _is_shift(atom.of, variable, real):
            by = atom.by or ZERO
            width = None if _moves(by, variable, real) else real.find("absolute", by)
            if width is None:
                raise Rejected(f"the modulus in {name} is not declared")
            return scalar(CIRCLE).scale(Fraction(1, 2)) * scalar(width)
        case "arctan" if slope is not None and _positive(slope, context):
            return scalar(CIRCLE).scale(Fraction(1, 2))
        case "reciprocal" if atom is not None:
            return reciprocal(limit(atom.of, variable, point, real, context), real)
        case _:
            raise Rejected(f"the limit of {name} is not known")


def _is_shift(poly: Poly, variable: str, real: Real) -> bool:
    """Tell whether a polynomial is the variable plus what does not depend on it."""
    return not _moves(poly - scalar(variable), variable, real)


def _slope(poly: Poly, variable: str) -> Poly | None:
    """Return c if poly = c * variable."""
    total = ZERO
    for (m, _), c in poly.terms.items():
        if m.count(variable) != 1:
            return None
        rest = list(m)
        rest.remove(variable)
        total = total + Poly({(tuple(rest), ()): c}, ANY, ANY)
    return total


def _positive(poly: Poly, context: Context) -> bool:
    """Tell whether a fact says that the polynomial, or a positive multiple of it, is positive."""
    for fact in context.facts.values():
        if fact.kind == "positive":
            ratio = ratio_of(poly, fact.matrix[0][0]) if poly.terms else None
            if ratio is not None and ratio > 0:
                return True
    return False
