"""Search for certificates about scalars: membership in the ideal of the relations, and contradictions of signs.

Products of facts are reduced modulo the relations; z3 combines them to zero by a linear program over the rationals.
Neither is believed: what they find is a certificate that the kernel expands.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from fractions import Fraction
from itertools import combinations_with_replacement
from typing import Any

from derive.kernel import Poly, Term
from derive.real import (
    NEGATION,
    Atom,
    Real,
    Sign,
    SignProduct,
    atom_relation,
    constant,
    contrary,
    scalars_of,
    sign_product,
)
from derive.rules import Fact
from derive.scalar.ideal import Form, Ideal, exact, multiply

__all__ = ["Remainders", "closure", "contradiction", "products", "prove_identity", "prove_sign"]

BASIS = 40  # elements of the Groebner basis before signs are searched


def closure(polys: Sequence[Poly], real: Real, relations: Mapping[str, Poly], expand: bool = True) -> dict[str, Poly]:
    """Return the defining relations of all atoms that occur in the polynomials, directly or within atoms.

    Without ``expand`` definitions are left out, so that a scalar stays what it is called.
    """
    found, waiting, seen = dict[str, Poly](), {s for p in polys for s in scalars_of(p)}, set[str]()
    while waiting:
        s = waiting.pop()
        seen.add(s)
        atom = real.atoms.get(s)
        if atom is not None and (expand or atom.kind != "defined"):
            waiting |= scalars_of(atom.of) - seen
            name = _relation_of(atom, relations)
            if name:
                found[name] = relations[name]
    return dict(sorted(found.items()))


def _relation_of(atom: Atom, relations: Mapping[str, Poly]) -> str | None:
    """Return the name of the relation that an atom stands for; a definition may have another name than its letter."""
    if atom.kind != "defined":
        return atom.name if atom.name in relations else None
    wanted = atom_relation(atom)
    return next((name for name, relation in relations.items() if relation == wanted), None)


def prove_identity(
    claim: Poly, relations: Mapping[str, Poly], order: Sequence[str], seconds: float = 30.0
) -> tuple[Term, ...] | None:
    """Return the addends of a certificate for claim = 0, or None."""
    order = [*order, *sorted(scalars_of(claim) - set(order))]
    return Ideal(relations, order, seconds).member(claim)


def prove_sign(
    claim: Poly,
    relation: str,
    facts: Mapping[str, Fact],
    relations: Mapping[str, Poly],
    order: Sequence[str],
    squares: Sequence[Poly] = (),
    degree: int = 3,
) -> Sign | None:
    """Return a certificate for claim >= 0, > 0 or ≠ 0 from products of at most ``degree`` facts, or None."""
    against = contrary(claim, relation)
    facts = {**facts, **({NEGATION: against} if against else {})}
    relations = {**relations, **({} if against else {NEGATION: claim})}
    ideal = Ideal(relations, [*order, *sorted(scalars_of(claim) - set(order))])
    while len(ideal.rules) < BASIS and ideal.grow():
        pass
    whole = tuple(name for name, fact in facts.items() if name != NEGATION and fact.kind != "nonzero")
    direct = [SignProduct(Fraction(1), names, s) for names in ((), whole) for s in ((), *((q,) for q in squares))]
    direct += [SignProduct(Fraction(1), (NEGATION,))] if against else []
    remainders = Remainders(ideal, facts)
    for d in range(degree + 1):
        found = contradiction(list(products(facts, squares, d)) if d else direct, remainders)
        if found:
            total = constant(0)
            for product in found:
                total = total + sign_product(product, facts)[0]
            terms = ideal.member(total)
            if terms is not None:
                return Sign(claim, relation, tuple(found), terms)
    return None


def products(facts: Mapping[str, Fact], squares: Sequence[Poly], degree: int) -> Iterator[SignProduct]:
    """Iterate over products of facts, of one square and facts, and 1."""
    units = [name for name, fact in facts.items() if fact.kind != "nonzero"]
    pairs = [name for name, fact in facts.items() if fact.kind == "nonzero"]
    chosen = [c for d in range(degree + 1) for c in combinations_with_replacement(units, d)]
    for names in chosen:
        if max(map(names.count, names), default=0) <= 2:
            yield SignProduct(Fraction(1), names)
            for name in pairs:
                yield SignProduct(Fraction(1), (*names, name, name))
            for square in squares:
                yield SignProduct(Fraction(1), names, (square,))


@dataclass
class Remainders:
    """The remainders of products modulo an ideal, each from that of the product with one factor less."""

    ideal: Ideal
    facts: Mapping[str, Fact]
    known: dict[tuple[tuple[str, ...], tuple[Poly, ...]], Form] = field(default_factory=dict)

    def of(self, names: tuple[str, ...], squares: tuple[Poly, ...]) -> Form:
        """Return the remainder of a product."""
        key = names, squares
        if key not in self.known:
            self.known[key] = self.ideal.reduce(self._product(names, squares))[0]
        return self.known[key]

    def _product(self, names: tuple[str, ...], squares: tuple[Poly, ...]) -> Form:
        if names:
            factor = self.ideal.encode(self.facts[names[-1]].matrix[0][0])
            return multiply(self.of(names[:-1], squares), factor)
        if squares:
            factor = self.ideal.encode(squares[-1])
            return multiply(multiply(self.of((), squares[:-1]), factor), factor)
        return {0: 1}

    def positive(self, product: SignProduct) -> bool:
        """Tell whether a product is positive rather than only nonnegative."""
        return not product.squares and all(self.facts[name].kind != "nonnegative" for name in product.facts)


def contradiction(products: Sequence[SignProduct], remainders: Remainders) -> list[SignProduct] | None:
    """Return products with coefficients whose sum is zero in the ideal, one of them positive."""
    columns = Columns([remainders.of(p.facts, p.squares) for p in products])
    columns.simplify()
    strict = {i for i, p in enumerate(products) if remainders.positive(p)}
    values = _combination(columns, strict)
    if values is None:
        return None
    return [SignProduct(c, products[i].facts, products[i].squares) for i, c in values.items() if c]


class Columns:
    """Columns of a linear program sum of c * form = 0, c >= 0, and what each is made of.

    A monomial that has one sign in all columns makes their coefficients zero; one that is in two columns only, with
    unlike signs, ties them to each other.
    """

    def __init__(self, forms: Sequence[Form]):
        self.forms = [dict(form) for form in forms]
        self.weights: list[dict[int, int | Fraction]] = [{i: 1} for i in range(len(forms))]
        self.rows: dict[int, set[int]] = {}
        for i, form in enumerate(forms):
            for m in form:
                self.rows.setdefault(m, set()).add(i)
        self.kept = set(range(len(forms)))

    def simplify(self) -> None:
        """Drop what must be zero, join what is tied, until nothing is left to do."""
        waiting = list(self.rows)
        while waiting:
            m = waiting.pop()
            row = self.rows[m]
            signs = {self.forms[i][m] > 0 for i in row}
            if len(signs) == 1:
                for i in list(row):
                    waiting += self._drop(i)
            elif len(row) == 2:
                waiting += self._join(*sorted(row), m)

    def _drop(self, i: int) -> list[int]:
        self.kept.discard(i)
        for m in self.forms[i]:
            self.rows[m].discard(i)
        return list(self.forms[i])

    def _join(self, i: int, j: int, monomial: int) -> list[int]:
        ratio = exact(-self.forms[i][monomial], self.forms[j][monomial])
        touched = self._drop(j)
        for target, source in ((self.forms[i], self.forms[j]), (self.weights[i], self.weights[j])):
            for m, c in source.items():
                target[m] = target.get(m, 0) + ratio * c
        for m in touched:
            self.rows[m].add(i)
            if not self.forms[i][m]:
                del self.forms[i][m]
                self.rows[m].discard(i)
        return [*touched, *self.forms[i]]


def _combination(columns: Columns, strict: set[int]) -> dict[int, Fraction] | None:
    """Return coefficients >= 0 with sum zero, one of those of the strict columns positive."""
    kept = [i for i in sorted(columns.kept) if columns.forms[i] or not strict.isdisjoint(columns.weights[i])]
    ready = next((i for i in kept if not columns.forms[i]), None)
    if ready is not None:
        found = {ready: Fraction(1)}
    else:
        found = _program({i: columns.forms[i] for i in kept}, [i for i in kept if strict & columns.weights[i].keys()])
    total: dict[int, Fraction] = {}
    for i, c in (found or {}).items():
        for k, weight in columns.weights[i].items():
            total[k] = total.get(k, Fraction(0)) + c * weight
    return total or None


def _program(forms: Mapping[int, Form], strict: Sequence[int]) -> dict[int, Fraction] | None:
    """Return coefficients >= 0 with sum zero, those of the strict columns together at least 1."""
    if not strict:
        return None
    import z3

    context = z3.Context()  # of its own, so that the answer does not depend on what was asked before
    solver, sums = z3.SolverFor("QF_LRA", context), dict[int, list[Any]]()
    unknowns: dict[int, Any] = {i: z3.Real(f"c{i}", context) for i in forms}
    for i, form in forms.items():
        for m, k in form.items():
            sums.setdefault(m, []).append(z3.RealVal(str(k), context) * unknowns[i])
    solver.add(*(c >= 0 for c in unknowns.values()), *(z3.Sum(addends) == 0 for addends in sums.values()))
    total: Any = z3.Sum([unknowns[i] for i in strict])
    solver.add(total >= 1)
    if solver.check() != z3.sat:
        return None
    model: Any = solver.model()
    return {i: Fraction(model.eval(c, model_completion=True).as_fraction()) for i, c in unknowns.items()}
