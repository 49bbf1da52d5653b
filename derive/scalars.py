"""How statements about real scalars are proved and taken up: the rules beside the kernel's identity for scalars.

scalar: the difference of both sides is zero, an identity. same rate: both sides have the same derivative in t and the
same value at 0. sign: >=, > or ≠ by a certificate of sign. both: a = b from a >= b and b >= a. squeeze: the limit of f
is v, because f - v and v - f are at most b and c, whose limits are zero. integral: from an antiderivative and its
limits. Those about determinants and roots are in roots.py.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from derive.calculus import at_origin, derivative
from derive.functions import PI, Definite, Infinity, Limit, Log, Rate, point_of, spectral_atom, value, variable
from derive.kernel import Poly, Rejected
from derive.parameter import CHECKS as PARAMETER
from derive.parameter import regular_logarithm
from derive.real import (
    COMPLEX,
    FREQUENCY,
    LOGARITHMS,
    SIGNS,
    TIME,
    ZERO,
    Atom,
    Sign,
    atom_facts,
    atom_relation,
    log_facts,
    needs,
    replay_sign,
    scalar,
    scalars_of,
)
from derive.roots import CHECKS, is_real, real_coefficients
from derive.rules import Fact
from derive.spectral import At, Modulus
from derive.terms import Equation, MissingInverse, Reading, Symbol, Term

RULES = frozenset({"sign", "both", "squeeze", "integral", "same argument", *CHECKS, *PARAMETER})
KINDS = ("root", "reciprocal", "absolute", "part", "exp", "log", "arctan", "integral", "improper", "spectral")
ANYWHERE = ("reciprocal", "defined", "roots", "det", "trace", "log modulus", "log value")  # atoms of complex numbers


# ------------------------------------------------------------------------------------------------ taking up
def adopt_scalar(reading: Reading, name: str, statement: Equation) -> Reading:
    """Extend a reading by a statement about scalars that is declared or proved."""
    lhs, rhs = statement.lhs, statement.rhs
    real, context = reading.real, reading.context
    if statement.relation not in ("=", ":=", *SIGNS):
        raise Rejected(f"{statement.relation} is no relation between numbers")
    if statement.relation in SIGNS:
        difference = value(lhs, reading) - value(rhs, reading)
        fact = Fact(SIGNS[statement.relation], ((difference,),))
        return replace(reading, context=replace(context, facts={**context.facts, name: fact}))
    match lhs:
        case Limit(body, symbol, point):
            limited = value(body, reading)
            if len(limited.terms) == 1:
                (((m, _), c),) = limited.terms.items()
                known = name, (symbol.name, point_of(point), m), value(rhs, reading).scale(1 / c)
                real = replace(real, named=(*real.named, known), limits={known[1]: known[2], **real.limits})
            elif limited.terms:
                known = symbol.name, point_of(point), limited, value(rhs, reading), name
                real = replace(real, sums=(*real.sums, known))
            return replace(reading, real=real)
        case Symbol() if statement.relation == ":=":
            atom = Atom(lhs.name, "defined", value(rhs, reading))
            _check_order(atom, reading)
            reading = replace(reading, real=replace(real, atoms={**real.atoms, lhs.name: atom}))
        case _:
            pass
    difference = value(lhs, reading) - value(rhs, reading)
    return replace(reading, context=replace(context, relations={**context.relations, name: difference}))


def adopt_atom(reading: Reading, name: str, kind: str, of: Term, because: str) -> Reading:
    """Extend a reading by an atom, once the fact is there that makes it defined.

    Raises:
        MissingInverse: the reason, or an atom within, is not there yet.
        Rejected: the reason is about something else.
    """
    if kind not in KINDS:
        raise Rejected(f"{name}: {kind} is no function of a number")
    if because and because not in reading.context.facts:
        raise MissingInverse(f"{because} not proved yet")
    try:
        atom = spectral_atom(name, of, reading) if kind == "spectral" else Atom(name, kind, value(of, reading))
    except Rejected as error:
        raise MissingInverse(str(error)) from None
    kind = atom.kind
    if kind in LOGARITHMS and not real_coefficients(atom.of, reading):
        raise Rejected(f"{name}: the coefficients of the function are not known to be real")
    if kind not in ANYWHERE and not all(is_real(p, reading, _s_is_real(reading)) for p in (atom.of, atom.by) if p):
        raise MissingInverse(f"{name}: its argument is not known to be real")
    context, wanted = reading.context, needs(kind)
    if wanted or because:
        fact = context.facts.get(because)
        if fact is None:
            raise MissingInverse(f"{because} not proved yet")
        turned = ((-atom.of,),)
        negative = "negative" in wanted and fact.kind == "positive" and fact.matrix == turned
        if not negative and (fact.matrix != ((atom.of,),) or fact.kind not in (wanted or ("positive",))):
            raise Rejected(f"{because} is not a reason why {name} exists")
    _check_order(atom, reading)
    relation, facts = atom_relation(atom, reading.real), atom_facts(atom)
    if kind == "times log" and relation is None and any(reading.real.varies(s, FREQUENCY) for s in scalars_of(atom.of)):
        raise MissingInverse(f"the logarithm in {name} is not declared yet")
    if kind == "integral" and because and _always(Fact("nonnegative", ((scalar(TIME),),)), reading):
        facts[f"{name} ≥ 0"] = Fact("nonnegative", ((scalar(name),),))
    reasons = {**reading.real.reasons, **({name: (because,)} if because else {})}
    real = replace(reading.real, atoms={**reading.real.atoms, name: atom}, reasons=reasons)
    facts |= log_facts(name, real) if kind == "log" else {}
    relations = {**context.relations, **({name: relation} if relation is not None else {})}
    context = replace(context, relations=relations, facts={**context.facts, **facts})
    return replace(reading, context=context, real=real)


def _check_order(atom: Atom, reading: Reading) -> None:
    """Reject a scalar that is declared twice, or that what it stands for, or an atom or relation, already uses."""
    polys = [p for a in (*reading.real.atoms.values(), atom) for p in (a.of, a.by) if p is not None]
    polys += [f.matrix[0][0] for f in reading.context.facts.values()] + list(reading.context.relations.values())
    used = {s for poly in polys for s in scalars_of(poly)}
    if atom.name in reading.real.atoms or atom.name in used:
        raise Rejected(f"{atom.name} is used before it is declared")


# ------------------------------------------------------------------------------------------------ proving
def scalar_claims(statement: Equation, rule: str, reading: Reading) -> list[Poly]:
    """Return the polynomials to be shown zero: the difference, or its derivative in t and its value at 0."""
    if rule == "scalar":
        return [value(statement.lhs, reading) - value(statement.rhs, reading)]
    difference = value(statement.lhs, reading) - value(statement.rhs, reading)
    variable(replace(PI, name=TIME), reading)
    return [derivative(difference, TIME, reading.real), at_origin(difference, TIME, reading.real)]


def check_scalar(
    statement: Equation, rule: str, sign: Sign | None, links: Sequence[Equation], reading: Reading
) -> None:
    """Replay a step by one of the rules for scalars, or raise Rejected."""
    if rule == "sign":
        if sign is None:
            raise Rejected("the proof is of another kind than the rule")
        check_sign(sign, value(statement.lhs, reading) - value(statement.rhs, reading), statement.relation, reading)
        return
    if statement.relation != "=" and rule not in ("instance", "sum over"):
        raise Rejected(f"the rule {rule!r} proves equations, not {statement.relation}")
    checks = {
        "both": _check_both, "squeeze": _check_squeeze, "integral": _check_integral, "same argument": _check_argument,
        **CHECKS, **PARAMETER,
    }  # fmt: skip
    checks[rule](statement, links, reading)


def check_sign(sign: Sign, claim: Poly, relation: str, reading: Reading) -> None:
    """Replay a certificate of sign about real numbers, or raise Rejected."""
    _check_real(sign, claim, relation, reading)
    replay_sign(sign, claim, relation, reading.context)


def _s_is_real(reading: Reading) -> bool:
    """Tell whether the theory takes s to be real, and large."""
    return Fact("positive", ((scalar(COMPLEX),),)) in reading.context.facts.values()


def _always(fact: Fact, reading: Reading) -> bool:
    """Tell whether the theory declares a fact, and not for a case only."""
    declared = reading.adopted - reading.real.cases
    return any(name in declared and found == fact for name, found in reading.context.facts.items())


def _check_real(sign: Sign, claim: Poly, relation: str, reading: Reading) -> None:
    """Reject a certificate of sign about complex numbers: a square is nonnegative, and order has a meaning, for reals.

    That s is real is a fact that the certificate has to name. A product of numbers different from zero is different
    from zero, complex or not.
    """
    facts = reading.context.facts
    named = [facts[name] for product in sign.products for name in product.facts if name in facts]
    if relation == "≠" and len(sign.products) == 1 and not sign.products[0].squares:
        return
    point = Fact("positive", ((scalar(COMPLEX),),)) in named
    polys = [claim, *(p for product in sign.products for p in product.squares)]
    polys += [fact.matrix[0][0] for fact in named if fact.kind == "nonzero"]
    if not all(is_real(poly, reading, point) for poly in polys):
        raise Rejected("a sign of what is not known to be real")


def _check_both(statement: Equation, links: Sequence[Equation], reading: Reading) -> None:
    difference = value(statement.lhs, reading) - value(statement.rhs, reading)
    shown = [value(e.lhs, reading) - value(e.rhs, reading) for e in links if e.relation in ("≥", ">", "=")]
    if len(shown) != 2 or difference not in shown or -difference not in shown:
        raise Rejected("the two inequalities do not make this equation")


def _check_argument(statement: Equation, links: Sequence[Equation], reading: Reading) -> None:
    """Accept f(u) = f(v) from u = v: for a logarithm, a limit, or an integral over 0 to infinity.

    A limit at infinity takes no more than equality near it, so equality but for finitely many points is enough.
    """
    match statement, links:
        case (Equation(Limit(f, x, Infinity()), "=", v), [Equation(a, "=", b)]) if f == a:
            _ = value(f, reading), value(b, reading)
            if value(Limit(b, x, Infinity()), reading) != value(v, reading) or _moves(v, x, reading):
                raise Rejected("the limit of the equal function is another")
        case Equation(Log(u), "=", Log(v)), [Equation(a, "=", b)] if (u, v) == (a, b) or _same_place(u, v, a, b):
            _ = value(statement.lhs, reading), value(statement.rhs, reading)
        case (
            Equation(Definite(f, x, low, Infinity()), "=", Definite(g, y, bottom, Infinity())),
            [Equation(a, "=", b)],
        ) if (f, g, x, low) == (a, b, y, bottom):
            _ = value(statement.lhs, reading), value(statement.rhs, reading)
        case _:
            raise Rejected("the arguments are not what the link says")


def _same_place(u: Term, v: Term, a: Term, b: Term) -> bool:
    """Tell whether u and v are the functions a and b, or their moduli, at one point."""
    match u, v:
        case (Modulus(At() as f), Modulus(At() as g)) | (At() as f, At() as g):
            return (f.body, g.body) == (a, b) and (f.symbol, f.point) == (g.symbol, g.point)
        case _:
            return False


def _check_squeeze(statement: Equation, links: Sequence[Equation], reading: Reading) -> None:
    """Accept lim f = v from b >= f - v and c >= v - f, where b and c tend to 0."""
    match statement.lhs, links:
        case Limit(body, symbol, point), [Equation(b, "≥", above), Equation(c, "≥", below)]:
            gap = value(body, reading) - value(statement.rhs, reading)
            if (value(above, reading), value(below, reading)) != (gap, -gap):
                raise Rejected("the bounds are on something else")
            if _moves(statement.rhs, symbol, reading):
                raise Rejected("the limit depends on the variable")
            if any(value(Limit(bound, symbol, point), reading) != ZERO for bound in (b, c)):
                raise Rejected("a bound does not tend to zero")
        case _:
            raise Rejected("a squeeze needs a limit and two bounds")


def _moves(term: Term, symbol: Symbol, reading: Reading) -> bool:
    return any(reading.real.varies(s, symbol.name) for s in scalars_of(value(term, reading)))


def _check_integral(statement: Equation, links: Sequence[Equation], reading: Reading) -> None:
    """Accept the integral of f from 0 to infinity: d G = f, and the difference of the limits of G."""
    match statement.lhs, links:
        case (
            Definite(f, x, lower, Infinity() as upper),
            [
                Equation(Rate(G, x1), "=", f1),
                Equation(Limit(G2, x2, Infinity()), "=", above),
                Equation(Limit(G3, x3, low), "=", below),
            ],
        ) if x1 == x2 == x3 == x and G == G2 == G3 and f == f1:
            value(statement.lhs, reading)
            if point_of(lower) != "0" or point_of(low) != "0" or point_of(upper) == "0":
                raise Rejected("the limits are at other ends than the integral")
            if value(statement.rhs, reading) != value(above, reading) - value(below, reading):
                raise Rejected("the value is not the difference of the limits")
            if reading.real.generic and not _continuous(value(G, reading), x.name, reading):
                raise Rejected("the antiderivative is not known to be continuous")
        case _:
            raise Rejected("an integral needs an antiderivative of its integrand, and its limits at both ends")


CONTINUOUS = ("times log", "times arctan")


def _continuous(poly: Poly, variable: str, reading: Reading) -> bool:
    """Tell whether a polynomial in the variable and functions continuous in it, whose derivative may have gaps."""
    real = reading.real

    def moving(p: Poly) -> set[str]:
        return {s for s in scalars_of(real.unfold(p)) if s != variable and real.varies(s, variable)}

    found = [real.atoms[s] for s in moving(poly)]
    odd = [a for a in found if not regular_logarithm(a.name, variable, reading)]
    return all(a.kind in CONTINUOUS and not moving(a.of) and a.by is not None and not moving(a.by) for a in odd)
