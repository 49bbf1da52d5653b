"""What a claim stands on: the reading of its theory, and the facts and inverses that were established on the way.

Part of the trust base: ``accept`` takes up nothing whose reason it has not replayed. Standard library only.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace
from fractions import Fraction

from derive.context import Theory, names_of
from derive.derivation import DIRECTION
from derive.kernel import Alphabet, Certificate, Letter, Poly, Rejected, Term, identity, parts, replay
from derive.real import UNIT
from derive.rules import (
    Comparison,
    Context,
    Fact,
    Grid,
    Positivity,
    differentiate,
    replay_comparison,
    replay_positivity,
)
from derive.terms import Equation, Glyph, Gradient, Reading, Symbol, walk

GENERIC = ("s", "z", "ω")  # scalars that a formula writes for a generic point


@dataclass(frozen=True)
class Lemma:
    """M ⪰ 0 or M ≻ 0, by its certificate."""

    name: str
    kind: str
    matrix: Grid
    positivity: Positivity | None = None
    comparison: Comparison | None = None


@dataclass(frozen=True)
class Introduced:
    """A letter for the inverse of M, with the reason why it exists.

    ``because`` names the fact that M is positive definite or invertible. Otherwise ``by`` is the inverse, and the
    addends prove M * by = I and by * M = I; or M is invertible at all but finitely many values of ``generic``.
    """

    letter: str
    of: Poly
    because: str = ""
    by: Poly | None = None
    right: tuple[Term, ...] = ()
    left: tuple[Term, ...] = ()
    generic: str = ""


Item = Lemma | Introduced


def accept(items: Iterable[Item], reading: Reading, theory: Theory) -> Reading:
    """Take up lemmas and inverses in order, each replayed first; or raise Rejected.

    Declarations of the theory that waited for one of these inverses are taken up as well.
    """
    for item in items:
        if (item.name if isinstance(item, Lemma) else item.letter) in theory.declared:
            raise Rejected("a declaration of the theory has this name")
        reading = _with_lemma(item, reading) if isinstance(item, Lemma) else _with_inverse(item, reading)
        reading = without_cases(theory.settle(reading))
    return reading


def without_cases(reading: Reading) -> Reading:
    """Return a reading without its cases, which hold of instances only."""
    context, cases = reading.context, reading.real.cases
    relations = leave_out(cases, context.relations)
    facts = {n: f for n, f in context.facts.items() if n not in cases}
    return replace(reading, context=replace(context, relations=relations, facts=facts))


def leave_out(names: Iterable[str], relations: Mapping[str, Poly]) -> dict[str, Poly]:
    """Return the relations without those of some declarations."""
    gone = {r for name in names for r in names_of(name, relations)}
    return {n: p for n, p in relations.items() if n not in gone}


def _with_lemma(item: Lemma, reading: Reading) -> Reading:
    context = reading.context
    if item.name in context.facts or (item.positivity is None) == (item.comparison is None):
        raise Rejected(f"{item.name}: the name is taken, or it needs one certificate")
    if item.positivity:
        kind = replay_positivity(item.positivity, item.matrix, context)
    elif item.comparison and len(item.matrix) == len(item.matrix[0]) == 1:
        kind = replay_comparison(item.comparison, item.matrix[0][0], context)
    else:
        raise Rejected(f"{item.name}: a comparison is about one block")
    if item.kind not in ("psd", kind):
        raise Rejected(f"{item.name}: {item.kind} is not what the certificate shows")
    facts = {**context.facts, item.name: Fact(item.kind, item.matrix)}
    return replace(reading, context=replace(context, facts=facts))


def _with_inverse(item: Introduced, reading: Reading) -> Reading:
    """Adopt M X = I, X M = I, and what X is where that is known; dX/dt = -X dM/dt X."""
    _check_reason(item, reading.context, reading.inverses)
    return suppose(item, reading)


def suppose(item: Introduced, reading: Reading) -> Reading:
    """Take up an inverse whatever its reason, for instances where it exists; nothing is proved from it."""
    context, of, name = reading.context, item.of, item.letter
    if name in context.alphabet.letters or name in context.alphabet.scalars:
        raise Rejected(f"{name}: the letter is taken")
    context.alphabet.check(of)
    symmetric = context.alphabet.transpose(of) == of
    letters = {**context.alphabet.letters, name: Letter(name, of.rows, of.cols, symmetric)}
    x = Poly({((), (name,)): 1}, of.rows, of.cols)
    relations = {f"{name}.right": of * x - identity(of.rows), f"{name}.left": x * of - identity(of.rows)}
    if item.by is not None:
        relations[f"{name}.value"] = x - item.by
    below = {parts(a)[0] for _, w in of.terms for a in w}
    context = replace(
        context,
        alphabet=Alphabet(letters, context.alphabet.scalars),
        relations={**context.relations, **relations},
        complex=context.complex if context.is_real(of) else context.complex | {name},
        constants=context.constants | ({name} if below <= context.constants else set()),
        parameters=context.parameters | ({name} if below <= context.parameters else set()),
        random=context.random,
    )
    if below & (context.random | context.uncentred):
        raise Rejected(f"{name}: the inverse of a random matrix has no rule")
    context = _with_rate(context, of, x, name)
    return replace(reading, context=context, inverses={**reading.inverses, of: name})


def _with_rate(context: Context, of: Poly, x: Poly, name: str) -> Context:
    if name in context.constants:
        return context
    try:
        rate = differentiate(of, context)
    except Rejected:
        return context
    return replace(context, derivatives={**context.derivatives, name: -(x * rate * x)})


def _check_reason(item: Introduced, context: Context, inverses: Mapping[Poly, str]) -> None:
    of, by = item.of, item.by
    if of.rows != of.cols:
        raise Rejected(f"{item.letter}: its matrix is not square")
    given = [bool(item.because), by is not None, bool(item.generic)]
    if sum(given) != 1:
        raise Rejected(f"{item.letter}: one reason is needed why the inverse exists")
    if by is not None:
        for product, terms in ((of * by, item.right), (by * of, item.left)):
            claim = product - identity(of.rows)
            replay(Certificate(claim, terms), claim, context.relations, context.alphabet)
    elif item.because:
        if context.fact(item.because, "pd", "invertible").matrix != ((of,),):
            raise Rejected(f"{item.because} is about another matrix")
    elif not generic(of, item.generic, context, inverses):
        raise Rejected(f"{item.letter}: not known to be invertible at a generic {item.generic}")


# ------------------------------------------------------------------------------------------------ generic points
def generic(of: Poly, variable: str, context: Context, inverses: Mapping[Poly, str]) -> bool:
    """Tell whether det M is a rational function of a free scalar s that does not vanish identically.

    As s grows, each product of M grows like s^d: d counts its factors s, less its factors (s c I + X)^-1. If the
    products of the highest d have no such factor, and their sum is invertible, so is M for large s.
    """
    proper = {name for poly, name in inverses.items() if variable in _scalars(poly)}
    letters = {parts(a)[0] for _, w in of.terms for a in w}
    if not of.terms or variable not in context.alphabet.scalars or not is_free(variable, context, inverses):
        return False
    moving = _moving(variable, proper, context, inverses)
    if moving & letters or not all(
        _is_pencil(poly, variable, proper | moving) for poly, name in inverses.items() if name in proper
    ):
        return False
    degrees = {key: _degree(key, variable, proper) for key in of.terms}
    top = {key: c for key, c in of.terms.items() if degrees[key] == max(degrees.values())}
    if any(parts(a)[0] in proper for _, w in top for a in w):
        return False
    if len({m.count(UNIT) for m, _ in top}) != 1:
        return False
    lead = Poly({(_without(m, variable), w): c for (m, w), c in top.items()}, of.rows, of.cols)
    known = {fact.matrix for fact in context.facts.values() if fact.kind in ("pd", "invertible")}
    return set(lead.terms) == {((), ())} or ((lead,),) in known or ((-lead,),) in known


def moves(poly: Poly, context: Context, inverses: Mapping[Poly, str]) -> bool:
    """Tell whether a matrix is a function of a generic point."""
    for variable in (s for s in GENERIC if s in context.alphabet.scalars):
        proper = {name for p, name in inverses.items() if variable in _scalars(p)}
        if variable in _scalars(poly) or _letters(poly) & (proper | _moving(variable, proper, context, inverses)):
            return True
    return False


def _moving(variable: str, proper: set[str], context: Context, inverses: Mapping[Poly, str]) -> set[str]:
    """Return the letters that stand for functions of s: lone in an equation with s, and in none without."""
    named = {f"{name}.{side}" for name in inverses.values() for side in ("left", "right", "value")}
    polys = [p for name, p in context.relations.items() if name not in named]
    still = {a for f in context.facts.values() if f.kind != "invertible" for row in f.matrix for p in row
             for _, w in p.terms for a in map(_base, w)}  # fmt: skip
    moving = set[str]()
    while True:
        fast = [p for p in polys if variable in _scalars(p) or (_letters(p) & (proper | moving))]
        still |= {a for p in polys if p not in fast for a in _letters(p)}
        found = {_base(w[0]) for p in fast for _, w in p.terms if len(w) == 1} - still - proper
        found |= {name for poly, name in inverses.items() if _letters(poly) & (proper | moving)}
        if found <= moving:
            return moving
        moving |= found


def is_free(variable: str, context: Context, inverses: Mapping[Poly, str]) -> bool:
    """Tell whether nothing is assumed of a scalar, but what the letters for inverses say."""
    named = {f"{name}.{side}" for name in inverses.values() for side in ("left", "right", "value")}
    assumed = [p for name, p in context.relations.items() if name not in named]
    assumed += [p for name, f in context.facts.items() if f.kind != "invertible" for row in f.matrix for p in row]
    return not any(variable in _scalars(p) for p in assumed)


def _is_pencil(poly: Poly, variable: str, proper: set[str]) -> bool:
    """Tell whether a polynomial is c s I + X, with X free of s."""
    lead = {key for key in poly.terms if variable in key[0]}
    rest = {parts(a)[0] for _, w in poly.terms for a in w}
    return {(_without(m, variable), w, len(m) - m.count(UNIT)) for m, w in lead} == {((), (), 1)} and not rest & proper


def _without(scalars: tuple[str, ...], variable: str) -> tuple[str, ...]:
    return tuple(s for s in scalars if s not in (variable, UNIT))


def _degree(key: tuple[tuple[str, ...], tuple[str, ...]], variable: str, proper: set[str]) -> int:
    scalars, word = key
    return scalars.count(variable) - sum(parts(a)[0] in proper for a in word)


def _scalars(poly: Poly) -> set[str]:
    return {s for m, _ in poly.terms for s in m}


def _letters(poly: Poly) -> set[str]:
    return {_base(a) for _, w in poly.terms for a in w}


def _base(letter: str) -> str:
    return parts(letter)[0]


# ------------------------------------------------------------------------------------------------ names
def directions(equations: Iterable[Equation]) -> dict[str, Symbol]:
    """Return the letters along which the gradients in some equations are taken."""
    nodes = [n for e in equations for side in (e.lhs, e.rhs) for n in walk(side) if isinstance(n, Gradient)]
    names = {DIRECTION + n.symbol.name: n.symbol for n in nodes}
    return {name: Symbol(name, s.rows, s.cols, Glyph(name)) for name, s in names.items()}


def symbols(items: Iterable[Item], theory: Theory, equations: Iterable[Equation]) -> Theory:
    """Return the theory with symbols for introduced inverses and directions, to write and read certificates."""
    alphabet, fresh = theory.alphabet(), directions(equations)
    for item in items:
        if isinstance(item, Introduced):
            symmetric = alphabet.transpose(item.of) == item.of
            fresh[item.letter] = Symbol(item.letter, item.of.rows, item.of.cols, Glyph(item.letter), symmetric)
            letters = {**alphabet.letters, item.letter: Letter(item.letter, item.of.rows, item.of.cols, symmetric)}
            alphabet = Alphabet(letters, alphabet.scalars)
    return replace(theory, symbols={**theory.symbols, **fresh})


def ratio(a: Poly, b: Poly) -> Fraction | None:
    """Return the number c with a = c b, or None."""
    if not b.terms or set(a.terms) != set(b.terms) or (a.rows, a.cols) != (b.rows, b.cols):
        return None
    key = next(iter(b.terms))
    found = a.terms[key] / b.terms[key]
    return found if a == b.scale(found) else None
