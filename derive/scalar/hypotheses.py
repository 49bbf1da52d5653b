"""What a theory says of real numbers: its equations, and its hypotheses as facts of sign.

With every dimension 1, M >= 0 is a fact of sign, and a stabilising solution gives the closed condition of the strong
one, with the alternatives by which the plant is detectable: the output sees the state, or the state is stable. Part of
the trust base: what is read here is what a proof may use. Standard library only.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from fractions import Fraction
from itertools import combinations

from derive.context import Declared, DeclaredAtom, DeclaredFact, DeclaredInverse
from derive.interpret.statement import Statement
from derive.latex import plain as text
from derive.real import CIRCLE
from derive.scalar.ratio import Beyond, Ratio, Ring, name_of
from derive.scalar.system import KINDS, Case, Choice, System
from derive.terms import Block, Dot, Equation, Neg, Number, Product, Sum, Symbol, Term, Zero, walk

__all__ = ["names_in", "system"]

ONE = Number(Fraction(1))
COMPLEX = ("s", "z", "j")


@dataclass(frozen=True)
class Condition:
    """A hypothesis of sign: term of a kind, and the name of the declaration that it comes from."""

    name: str
    kind: str
    term: Term
    origin: str


def system(
    statement: Statement, ring: Ring, cases: Sequence[Case] = (), without: frozenset[str] = frozenset()
) -> System:
    """Read all that a statement's theory says of numbers; ``cases`` are assumed as well, ``without`` is left out.

    Raises:
        Beyond: an assumption that is not about real numbers.
        Split: an assumption has |.| of a number whose sign is not known.
    """
    found = System(ring)
    theory, assumed = statement.theory.theory, frozenset(statement.assumed)
    unknown = [e.relation for e in statement.theory.conditions if e.relation not in (*KINDS, "=", ":=")]
    if unknown:
        raise Beyond(f"the relation {unknown[0]} is not decided between numbers")
    if statement.scalar:
        found.values |= {n: found.numbers().number(1) for n in theory.sizes() if n in theory.symbols}
    items = [item for name, item in theory.declared.items() if name not in without]
    conditions = [c for item in items for c in _conditions(item, assumed)]
    extra = [e for e in statement.theory.conditions if text(e) not in without]
    conditions += [Condition(text(e), KINDS[e.relation], e.lhs - e.rhs, text(e)) for e in extra if e.relation in KINDS]
    for c in conditions:  # the signs of letters come first: they tell what may be divided by
        match c.term:
            case Symbol() | Sum((Symbol(), Neg(Zero() | Number(Fraction(numerator=0))))):
                letter = c.term if isinstance(c.term, Symbol) else c.term.addends[0]
                found.know(name_of(letter), 0 if c.kind == "nonzero" else 1, c.kind != "nonnegative")  # type: ignore[arg-type]
            case Neg(Symbol() as letter) if c.kind != "nonzero":
                found.know(name_of(letter), -1, c.kind == "positive")
            case _:
                pass
    for i, (relation, poly) in enumerate(cases):
        if relation != "=":
            found.fact(f"case {i + 1}", relation, ring.of(poly), "")
    for i, (relation, poly) in enumerate(cases):
        if relation == "=":
            value = found.numbers().evaluate(poly)
            solved = found.solve(value.top, "")
            name = f"case {i + 1}"
            found.origins[name] = ""
            if solved is not None:
                found.give(*solved, "")
            else:
                found.relations[name] = value.top
    user = [(text(e), e.lhs, e.rhs) for e in extra if e.relation in ("=", ":=")]
    user += [e for item in items if item.name in assumed for e in _equations(item, strict=True)]
    for name, lhs, rhs in user:
        found.equation(name, lhs, rhs)
    for item in items:
        if item.name not in assumed:
            for name, lhs, rhs in _equations(item, strict=False):
                try:
                    found.equation(name, lhs, rhs)
                except Beyond:
                    continue
    for c in conditions:
        try:
            poly = found.numbers().same_sign(found.numbers().read(c.term))
            found.fact(c.name, c.kind, poly, c.origin)
        except Beyond:
            if c.origin in assumed or c.origin in map(text, extra):
                raise
    for item in items:
        if isinstance(item, DeclaredFact) and item.case and item.name not in assumed:
            found.alternatives += _detectable(item, found)
    found.settle()
    found.consulted.clear()
    return found


def _equations(item: object, strict: bool) -> Iterator[tuple[str, Term, Term]]:
    """Iterate over the equations that a declaration makes between numbers."""
    match item:
        case Declared(name=name, statement=Equation(lhs, "=" | ":=", rhs), case=False):
            sides = _entries(lhs, rhs)
            yield from ((name if i == 0 else f"{name} {i + 1}", a, b) for i, (a, b) in enumerate(sides))
        case DeclaredInverse(name=name, of=of):
            yield name, Symbol(name, scalar=True) * of, ONE
        case DeclaredAtom() if strict:
            raise Beyond("a function that is assumed")
        case _:
            return


def _entries(lhs: Term, rhs: Term) -> list[tuple[Term, Term]]:
    if isinstance(lhs, Block) and isinstance(rhs, Block):
        pairs = zip((x for r in lhs.rows for x in r), (x for r in rhs.rows for x in r), strict=True)
        return list(pairs)
    return [(lhs, rhs)]


def _conditions(item: object, assumed: frozenset[str]) -> Iterator[Condition]:
    """Iterate over what a declaration says of signs; a stabilising solution may be at the boundary."""
    match item:
        case Declared(name=name, statement=Equation(lhs, relation, rhs), case=False) if relation in KINDS:
            plain = isinstance(rhs, Zero) or rhs == Number(Fraction(0))
            yield from _minors(name, KINDS[relation], lhs if plain else lhs - rhs)
        case DeclaredFact(name=name, kind=kind, matrix=matrix, case=case):
            firm = "nonnegative" if case and name not in assumed else "positive"
            match kind:
                case "hurwitz":
                    yield Condition(name, firm, Neg(matrix), name)
                case "schur":
                    yield Condition(f"{name}, below", firm, ONE - matrix, name)
                    yield Condition(f"{name}, above", firm, ONE + matrix, name)
                case "invertible":
                    yield Condition(name, "nonzero", matrix, name)
                case "psd":
                    yield from _minors(name, "nonnegative", matrix)
                case "pd":
                    yield from _minors(name, "positive", matrix)
                case _:
                    return
        case _:
            return


def _minors(name: str, kind: str, matrix: Term) -> Iterator[Condition]:
    """Iterate over the principal minors of a block matrix of numbers, of up to three rows."""
    if not isinstance(matrix, Block):
        yield Condition(name, kind, matrix, name)
        return
    size = len(matrix.rows)
    if size > 3 or any(len(row) != size for row in matrix.rows) or any(isinstance(x, Block) for x in matrix.children()):
        return
    for k in range(1, size + 1):
        for chosen in combinations(range(size), k):
            yield Condition(f"{name} {chosen}", kind, _determinant(matrix.rows, chosen, chosen), name)


def _determinant(rows: tuple[tuple[Term, ...], ...], i: tuple[int, ...], j: tuple[int, ...]) -> Term:
    if len(i) == 1:
        return rows[i[0]][j[0]]
    parts = [Product((rows[i[0]][c], _determinant(rows, i[1:], (*j[:n], *j[n + 1 :])))) for n, c in enumerate(j)]
    return Sum(tuple(Neg(p) if n % 2 else p for n, p in enumerate(parts)))


def _detectable(item: DeclaredFact, found: System) -> list[Choice]:
    """Return the alternatives of X - G H with the gain G: the output sees the state, H ≠ 0, or X is stable."""
    match item.matrix:
        case Sum((X, Neg(Product((G, H))))):
            pass
        case _:
            return []
    gain = G if isinstance(G, Symbol) and name_of(G) in found.solved else H
    seen = H if gain is G else G
    numbers = found.numbers()
    x, h = numbers.read(X), numbers.read(seen)
    if item.kind == "hurwitz":
        stable: Ratio = numbers.negative(x)
    else:
        stable = numbers.add(numbers.number(1), numbers.negative(numbers.multiply(x, x)))
    return [(("nonzero", h.top), ("positive", numbers.same_sign(stable)))]


# ---------------------------------------------------------------------------------------------- names
def names_in(statement: Statement) -> list[str]:
    """Return the letters of real numbers that a statement and its theory use, those that others are made of last."""
    found: dict[str, None] = {}
    theory = statement.theory.theory
    sides = [t for e in (*statement.equations, *statement.theory.conditions) for t in (e.lhs, e.rhs)]
    claimed = {name for t in sides for name in _names(t)}
    roots = {*theory.families, *(f.index for f in theory.families.values())}
    barred = {n for n in claimed if n in theory.complex and (n in COMPLEX or not theory.symbols[n].scalar)} | {
        n for n in claimed if n in roots or n == CIRCLE
    }
    if barred:
        raise Beyond(f"{min(barred)} is no real letter")
    if claimed & (theory.random | theory.uncentred):
        raise Beyond("signals are no numbers")
    for item in theory.declared.values():
        if isinstance(item, DeclaredInverse):
            found[item.name] = None
        found |= dict.fromkeys(name for t in _terms(item) for name in _names(t))
    return list(found | dict.fromkeys(sorted(claimed)))


def _terms(item: object) -> tuple[Term, ...]:
    match item:
        case Declared(statement=statement):
            return statement.lhs, statement.rhs
        case DeclaredFact(matrix=matrix):
            return (matrix,)
        case DeclaredInverse(of=of) | DeclaredAtom(of=of):
            return (of,)
        case _:
            return ()


def _names(term: Term) -> Iterator[str]:
    for node in walk(term):
        if isinstance(node, Symbol):
            try:
                yield name_of(node)
            except Beyond:
                continue
        if isinstance(node, Dot):
            yield from ("d/dt " + n.name for n in walk(node) if isinstance(n, Symbol) and n.args)
