"""Rules for an integral that depends on a parameter: differentiation under the integral, and the parameter's sign.

Both are about a running parameter r > 0: a scalar of which the theory assumes nothing else, so that what is proved of
it holds for all r > 0, and outside the same finitely many frequencies for all of them. Standard library only.

parameter: ∫ f dω = v where df/dr = g has one sign, ∫ g dω = dv/dr, and both sides agree where r tends to 0 or infinity.
any sign: the same for |a| in the place of r, with a any real number, 0 as well. logarithms: equal sums of logarithms
from equal products.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from fractions import Fraction

from derive.calculus import reflect
from derive.functions import Abs, Definite, Infinity, Limit, Log, Rate, point_of, replaced, value
from derive.kernel import Poly, Rejected
from derive.real import FREQUENCY, INFINITY, MATRIX, ONE, ORIGIN, ZERO, Real, scalar, scalars_of
from derive.rules import Fact
from derive.terms import Equation, Product, Reading, Sum, Symbol, Term, walk

Links = Sequence[Equation]
QUARTER = Fraction(1, 4)
SMOOTH = ("defined", "reciprocal", "exp", "log", "arctan")  # functions with a continuous derivative where they exist


# ------------------------------------------------------------------------------------------------ the rules
def check_parameter(statement: Equation, links: Links, reading: Reading) -> None:
    """Accept ∫ f dω = v, for all r > 0, from its derivative in r and its value at one end of the range of r.

    ∫ g dω = w;  df/dr = g;  dv/dr = w;  g >= 0 or -g >= 0;  lim f = f0;  lim v = v0;  ∫ f0 dω = v0 unless both are 0

    For all but finitely many ω, the same ones for every r, f has a continuous derivative in r > 0 and f - f0 is the
    integral of g from the end to r. As g has one sign, the integrals over r and ω may be exchanged (Tonelli), and the
    inner one is w = dv/dr; so that the integral of f - f0 is v - v0. The first link may be about another running
    parameter in the place of r, of which finitely many values are excepted.
    """
    match statement, links[:6]:
        case (
            Equation(Definite(f, symbol, low, Infinity()), "=", v),
            [
                Equation(Definite() as inner, "=", w1),
                Equation(Rate(f1, r), "=", g),
                Equation(Rate(v1, r1), "=", w),
                Equation() as sign,
                Equation(Limit(f2, r2, end), "=", f0),
                Equation(Limit(v2, r3, end1), "=", v0),
            ],
        ) if (f, v) == (f1, v1) == (f2, v2) and r == r1 == r2 == r3 and end == end1:
            pass
        case _:
            raise Rejected(
                "it takes an integral, two derivatives, a sign and two limits, of one integrand and one value"
            )
    if symbol.name != FREQUENCY or point_of(low) != ORIGIN or point_of(end) not in (ORIGIN, INFINITY):
        raise Rejected("it is about an integral over ω from 0, and a parameter that tends to 0 or to infinity")
    _check_running(r, (f, v, g, w), reading)
    _check_inner(inner, w1, Definite(g, symbol, low, Infinity()), w, r, (f, v, g, w), reading)
    _check_sign(sign, g, reading)
    base = value(f0, reading), value(v0, reading)
    if any(reading.real.varies(s, r.name) for p in base for s in scalars_of(p)):
        raise Rejected("a limit depends on the parameter")
    _free(base[1], symbol.name, reading.real)
    match links[6:]:
        case []:
            agree = base == (ZERO, ZERO)
        case [Equation(Definite(f3, x, low3, Infinity()), "=", v3)] if (x, low3) == (symbol, low):
            agree = (value(f3, reading), value(v3, reading)) == base
        case _:
            agree = False
    if not agree:
        raise Rejected("the integral and its value are not known to agree where the parameter starts")
    value(statement.lhs, reading)


def check_any_sign(statement: Equation, links: Links, reading: Reading) -> None:
    """Accept ∫ f(|a|) dω = v(|a|) for an arbitrary parameter a, from ∫ f dω = v for all r > 0.

    ∫ f dω = v;  df/dr = g;  g >= 0 or -g >= 0;  f is even in r and is written with a for r

    For a ≠ 0 put |a| for r. For a = 0 let r tend to 0: f tends to its value, monotonically because g has one sign, for
    all but finitely many ω; so the integrals tend to that of the limit (monotone convergence), and v to its value.
    """
    match statement, links:
        case (
            Equation(Definite(F, symbol, low, Infinity()), "=", V),
            [Equation(Definite(f, x, low1, Infinity()), "=", v), Equation(Rate(f1, r), "=", g), sign],
        ) if (symbol, low) == (x, low1) and f == f1:
            pass
        case _:
            raise Rejected("it takes an integral, the derivative of its integrand and a sign")
    if symbol.name != FREQUENCY or point_of(low) != ORIGIN:
        raise Rejected("it is about an integral over ω from 0")
    _check_running(r, (f, v, g), reading)
    _check_sign(sign, g, reading)
    images = [a for a in _symbols(F) if a.name in reading.real.arbitrary]
    chosen = [a for a in images if (replaced(f, r, a), replaced(v, r, Abs(a))) == (F, V)]
    if len(chosen) != 1:
        raise Rejected(
            "the statement is not the link with an arbitrary parameter in the integrand, its modulus beside it"
        )
    (a,) = chosen
    for poly in (value(f, reading), value(v, reading)):
        _free(poly, a.name, reading.real)
    if reflect(value(f, reading), r.name, reading.real) != value(f, reading):
        raise Rejected("the integrand is not even in the parameter")
    _smooth(value(F, reading), a.name, reading.real)
    if a.name in reading.real.generic:
        raise Rejected(f"some values of {a.name} are excepted")
    for side in (F, V):
        if any(reading.real.varies(s, r.name) for s in scalars_of(value(side, reading))):
            raise Rejected(f"{r.name} is left in a symbol that stands for it")
    value(statement.lhs, reading)


def check_logarithms(statement: Equation, links: Links, reading: Reading) -> None:
    """Accept ln a + ln b = ln c + ln d from a b = c d, where all four logarithms are declared."""
    match links:
        case [Equation(one, "=", two)]:
            pass
        case _:
            raise Rejected("it takes one equation between products")
    for side, product in ((statement.lhs, one), (statement.rhs, two)):
        addends = side.addends if isinstance(side, Sum) else (side,)
        factors = product.factors if isinstance(product, Product) and len(addends) > 1 else (product,)
        if addends != tuple(map(Log, factors)):
            raise Rejected("the sums are not those of the logarithms of the factors")
        value(side, reading)


# ------------------------------------------------------------------------------------------------ their hypotheses
def _check_running(r: Symbol, terms: Sequence[Term], reading: Reading) -> None:
    """Reject a parameter of which more than r > 0 is assumed, and functions of it without a continuous derivative."""
    real = reading.real
    if r.name not in real.running or r.name in real.generic:
        raise Rejected(f"{r.name} is no running parameter, or some of its values are excepted")
    if Fact("positive", ((scalar(r.name),),)) not in reading.context.facts.values():
        raise Rejected(f"{r.name} is not known to be positive")
    for term in terms:
        _smooth(value(term, reading), r.name, real)
    for term in terms[1::2]:
        _free(value(term, reading), FREQUENCY, real)


def _check_inner(
    inner: Term, result: Term, wanted: Term, w: Term, r: Symbol, whole: Sequence[Term], reading: Reading
) -> None:
    """Reject a link that is not ∫ g dω = w, in r or in another running parameter that occurs nowhere else."""
    for p in _symbols(inner):
        if p.name in reading.real.running and (inner, result) == (replaced(wanted, r, p), replaced(w, r, p)):
            for term in whole if p != r else ():
                _free(value(term, reading), p.name, reading.real)
            return
    raise Rejected("the first link is not the integral of the derivative")


def _check_sign(sign: Equation, g: Term, reading: Reading) -> None:
    known, poly = value(sign.lhs, reading) - value(sign.rhs, reading), value(g, reading)
    if sign.relation not in ("≥", ">") or known not in (poly, -poly):
        raise Rejected("the derivative is not known to have one sign")


def _smooth(poly: Poly, name: str, real: Real) -> None:
    """Reject what depends on a scalar otherwise than by functions with a continuous derivative."""
    for s in scalars_of(poly):
        atom = real.atoms.get(s)
        if atom is not None and atom.kind in SMOOTH:
            _smooth(atom.of, name, real)
        elif atom is not None:
            _free(scalar(s), name, real)


def _free(poly: Poly, name: str, real: Real) -> None:
    """Reject what a scalar occurs in, however deep; what a determinant or a trace depends on is not looked into."""
    for s in scalars_of(poly):
        atom = real.atoms.get(s)
        if real.varies(s, name) or (atom is not None and atom.kind in MATRIX):
            raise Rejected(f"{s} may depend on {name}")
        for part in (atom.of, atom.by) if atom is not None else ():
            if part is not None and not (atom and atom.kind == "improper" and name == FREQUENCY):
                _free(part, name, real)


def _symbols(term: Term) -> Iterator[Symbol]:
    return iter(dict.fromkeys(n for n in walk(term) if isinstance(n, Symbol)))


# ------------------------------------------------------------------------------------------------ continuity
def regular_logarithm(name: str, variable: str, reading: Reading) -> bool:
    """Tell whether a scalar is ln((x + b)^2 + c) in the variable x with c > 0, which is continuous for all x."""
    atom = reading.real.atoms.get(name)
    if atom is None or atom.kind != "log":
        return False
    powers: dict[int, Poly] = {}
    for (m, w), c in atom.of.terms.items():
        rest = Poly({(tuple(s for s in m if s != variable), w): c}, atom.of.rows, atom.of.cols)
        powers[m.count(variable)] = powers.get(m.count(variable), ZERO) + rest
    if powers.pop(2, None) != ONE or set(powers) > {0, 1}:
        return False
    double, constant = powers.get(1, ZERO), powers.get(0, ZERO)
    least = constant - (double * double).scale(QUARTER)
    if any(reading.real.varies(s, variable) for p in (double, constant) for s in scalars_of(p)):
        return False
    return any(f.kind == "positive" and f.matrix == ((least,),) for f in reading.context.facts.values())


CHECKS: Mapping[str, Callable[[Equation, Links, Reading], None]] = {
    "parameter": check_parameter,
    "any sign": check_any_sign,
    "logarithms": check_logarithms,
}
