"""The nearest true formula between numbers: single edits that hold at every small plant, proved before suggested."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, fields, replace
from fractions import Fraction
from time import monotonic

from derive.claim import Nearest
from derive.functions import Abs, Max, Power, Quotient, Root
from derive.interpret.statement import Statement
from derive.latex import latex, plain
from derive.scalar.argue import Failed, Prover, Unknown
from derive.scalar.evaluate import Undefined, Unsure, holds
from derive.scalar.flint_ring import rational
from derive.scalar.instances import Instance
from derive.scalar.ratio import Beyond, name_of
from derive.scalar.work import Work
from derive.terms import Equation, Inverse, Neg, Number, Product, Sum, Symbol, Term, Transpose, Zero, walk
from derive.theory.claims.base import SCALAR

__all__ = ["Edited", "edits", "nearest_scalar"]

PLANT = ("A", "B", "C", "Q", "R", "W", "V")  # letters that mean the same at every index
TRIED = 6  # edits that hold at the instances and are then proved or not
POINTS = 60
TWO, HALF, ONE = Number(Fraction(2)), Number(Fraction(1, 2)), Number(Fraction(1))


@dataclass(frozen=True)
class Edited:
    """An edited term, what was done in words, and how large a change that is."""

    term: Term
    words: str
    cost: int


def nearest_scalar(statement: Statement, *, seconds: float = 2.0) -> Nearest | None:
    """Return the nearest true formula to a refuted claim of one equation, or None if no single edit is true."""
    if len(statement.equations) != 1:
        return None
    letters, wide = _letters(statement), _widened(statement)
    deadline, tried = monotonic() + seconds, 0
    try:
        work = Work.of(wide, deadline)
    except Beyond:
        return None
    points = _spread(work)
    if not points or work.moving:
        return None
    for edit, changed in _changes(statement.equations[0], letters):
        if not all(_holds(changed, p) for p in points) or _says_nothing(changed):
            continue
        other = replace(wide, equations=(changed,))
        if _proved(other, work, deadline):
            return Nearest(latex(changed), edit.words)
        tried += 1
        if tried >= TRIED or monotonic() > deadline:
            return None
    return None


def _proved(statement: Statement, work: Work, deadline: float) -> bool:
    prover = Prover(statement, work.ring, work.names, deadline, seeds=work.instances.first(POINTS))
    try:
        prover.prove()
    except (Failed, Unknown, Beyond):
        return False
    return True


def _holds(equation: Equation, instance: Instance) -> bool:
    try:
        return holds(equation, instance.values)[0] is not False
    except (Undefined, Unsure, Beyond):
        return False


def _says_nothing(equation: Equation) -> bool:
    """Tell whether an equation holds whatever its letters are, such as P = 0 + P."""
    names = sorted({name_of(n) for side in (equation.lhs, equation.rhs) for n in walk(side) if isinstance(n, Symbol)})
    point = {name: rational(Fraction(7 + 2 * i, 3 + i)) for i, name in enumerate(names)}
    return equation.relation == "=" and _holds(equation, Instance(point))


def _spread(work: Work) -> list[Instance]:
    """Return instances, those with few zeros and ones first: they tell formulas apart."""
    found = work.instances.first(2 * POINTS, 300)
    return sorted(found, key=lambda i: sum(abs(v) in (0, 1) for v in i.values.values()))[:POINTS]


def _letters(statement: Statement) -> list[Symbol]:
    """Return the letters that people write in the theory, steady ones unless the claim has an index or a time."""
    own = [s for s in statement.symbols if s.rows or s.scalar]
    outline = statement.theory.outline
    moving = any("_" in s.name or s.args for s in own)
    if outline is None:
        return own
    theory = statement.theory.theory
    usual = [outline.letters.symbols[n] for n in sorted(outline.usual) if n in outline.letters.symbols]
    usual = [s for s in usual if (s.name in PLANT if moving else not s.args and "_" not in s.name)]
    if statement.theory.conditions or statement.assumed:
        usual = [s for s in usual if s.name in theory.symbols]
    barred = theory.random | theory.uncentred | theory.complex
    return list({s.name: s for s in [*own, *usual] if s in own or s.name not in barred}.values())


def _widened(statement: Statement) -> Statement:
    """Return the statement in a theory that declares what bears on every letter that may be put in."""
    if statement.theory.conditions or statement.assumed:
        return statement
    names = {SCALAR} | {s.name for s in (*_letters(statement), *statement.symbols)}
    return replace(statement, theory=statement.theory.about(names))


# ---------------------------------------------------------------------------------------------- edits
def _changes(equation: Equation, letters: Sequence[Symbol]) -> list[tuple[Edited, Equation]]:
    """Return edited equations, the smallest edit first; a side that is a letter alone stays."""
    found: list[tuple[Edited, Equation]] = []
    if equation.relation in ("≥", ">", "⪰", "≻"):
        turned = Equation(equation.rhs, equation.relation, equation.lhs)
        found.append((Edited(equation.rhs, "the other way round", 1), turned))
    if equation.relation in (">", "≻"):
        found.append((Edited(equation.lhs, "≥ for >", 1), replace(equation, relation="≥")))
    sides = [side for side in ("rhs", "lhs") if not isinstance(getattr(equation, side), (Symbol, Zero))]
    for side in sides or ["rhs"]:
        term = getattr(equation, side)
        for edit in edits(term, letters):
            if equation.relation == "=" or edit.term != Neg(term):  # a bound of the other sign is no bound
                found.append((edit, replace(equation, **{side: edit.term})))
        if not isinstance(term, Sum):
            for letter in letters:
                edit = Edited(Sum((term, letter)), f"with the addend {plain(letter)}", 4)
                found.append((edit, replace(equation, **{side: edit.term})))
    kept = [(e, c) for e, c in found if c.lhs != c.rhs]
    return sorted(kept, key=lambda item: item[0].cost)


def edits(term: Term, letters: Sequence[Symbol]) -> Iterator[Edited]:
    """Iterate over the single edits of a term: signs, factors, letters, exponents, roots, addends."""
    yield from _here(term, letters)
    for rebuild, child in _places(term):
        for edit in edits(child, letters):
            yield replace(edit, term=rebuild(edit.term))


def _places(term: Term) -> Iterator[tuple[Callable[[Term], Term], Term]]:
    """Iterate over the terms directly below, each with the function that puts another in its place."""
    if isinstance(term, (Symbol, Number)):
        return
    for f in fields(term):  # type: ignore[arg-type]
        value = getattr(term, f.name)
        if isinstance(value, Term):
            yield (lambda new, name=f.name: replace(term, **{name: new})), value  # type: ignore[type-var]
        elif isinstance(value, tuple):
            for i, child in enumerate(value):
                if isinstance(child, Term):
                    yield (lambda new, v=value, i=i, name=f.name: _rebuilt(term, name, v, i, new)), child


def _rebuilt(term: Term, name: str, parts: tuple[Term, ...], at: int, new: Term) -> Term:
    """Put a part in its place; a factor 1 is left out."""
    if isinstance(term, Product) and new == ONE and len(parts) > 1:
        rest = (*parts[:at], *parts[at + 1 :])
        return rest[0] if len(rest) == 1 else Product(rest)
    return replace(term, **{name: (*parts[:at], new, *parts[at + 1 :])})  # type: ignore[type-var]


def _here(term: Term, letters: Sequence[Symbol]) -> Iterator[Edited]:
    shown = plain(term)
    if isinstance(term, (Symbol, Product, Quotient, Root, Power, Abs)):
        yield Edited(Neg(term), f"the other sign of {shown}", 2)
        yield Edited(Product((TWO, term)), f"twice {shown}", 3)
        yield Edited(Product((HALF, term)), f"half of {shown}", 3)
    match term:
        case Symbol():
            yield from _letter(term, shown, letters)
        case Number(value) if value:
            for new in (n for n in (value - 1, value + 1, 2 * value, value / 2, -value, 4 * value, value / 4) if n):
                yield Edited(Number(new), f"{new} for {value}", 2)
        case Neg(body):
            yield Edited(body, f"the other sign of {plain(body)}", 2)
        case Sum(parts):
            yield from _sum(parts, letters)
        case Product(factors):
            for i, factor in enumerate(factors):
                rest = (*factors[:i], *factors[i + 1 :])
                cost = 2 if isinstance(factor, Number) else 3
                yield Edited(rest[0] if len(rest) == 1 else Product(rest), f"without the factor {plain(factor)}", cost)
        case Power(body, exponent):
            for new in (exponent - 1, exponent + 1):
                if new > 0:
                    yield Edited(body if new == 1 else Power(body, new), f"the exponent {new} for {exponent}", 2)
        case Root(body):
            yield Edited(body, f"{plain(body)} without root", 2)
        case Abs(body):
            yield Edited(body, f"{plain(body)} for {shown}", 2)
        case Quotient(top, bottom):
            yield Edited(Quotient(bottom, top), f"{plain(Quotient(bottom, top))} for {shown}", 3)
            yield Edited(top, f"without the divisor {plain(bottom)}", 3)
            yield Edited(Root(term), f"the root of {shown}", 3)
            for letter in letters if isinstance(top, Number) else ():
                more = letter if top == ONE else Product((top, letter))
                yield Edited(Quotient(more, bottom), f"with the factor {plain(letter)}", 3)
        case Inverse(body) | Transpose(body):
            yield Edited(body, f"{plain(body)} for {shown}", 3)
        case _:
            return


def _letter(term: Symbol, shown: str, letters: Sequence[Symbol]) -> Iterator[Edited]:
    for other in letters:
        if other.letter != term.letter:
            look = plain(other)
            yield Edited(other, f"{look} for {shown}", 2)
            yield Edited(Product((other, term)), f"{look} {shown} for {shown}", 3)
            yield Edited(Quotient(term, other), f"{shown}/{look} for {shown}", 3)
            yield Edited(Product((Power(other, 2), term)), f"{look}^2 {shown} for {shown}", 4)
    yield Edited(Power(term, 2), f"{shown}^2 for {shown}", 2)
    yield Edited(Abs(term), f"|{shown}| for {shown}", 2)
    yield Edited(Root(term), f"the root of {shown}", 3)
    yield Edited(Max(term), f"max(0, {shown}) for {shown}", 3)
    yield Edited(Quotient(ONE, term), f"1/{shown} for {shown}", 3)


def _sum(parts: tuple[Term, ...], letters: Sequence[Symbol]) -> Iterator[Edited]:
    for i, part in enumerate(parts):
        body = part.body if isinstance(part, Neg) else part
        flipped = body if isinstance(part, Neg) else Neg(part)
        rest = (*parts[:i], *parts[i + 1 :])
        yield Edited(Sum((*parts[:i], flipped, *parts[i + 1 :])), f"the other sign of {plain(body)}", 2)
        yield Edited(rest[0] if len(rest) == 1 else Sum(rest), f"without {plain(body)}", 4)
    yield Edited(Root(Sum(parts)), f"the root of {plain(Sum(parts))}", 3)
    for letter in letters:
        yield Edited(Sum((*parts, letter)), f"with the addend {plain(letter)}", 4)
        yield Edited(Sum((*parts, Neg(letter))), f"less {plain(letter)}", 4)
