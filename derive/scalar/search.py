"""Search for certificates about scalars: membership in the ideal of the relations, and contradictions of signs.

SymPy multiplies and divides polynomials here, z3 solves a linear program over the rationals; neither is believed: what
they find is a certificate that the kernel expands.
"""

from __future__ import annotations

import time
from collections.abc import Iterator, Mapping, Sequence
from fractions import Fraction
from itertools import combinations_with_replacement
from typing import Any

from derive.kernel import ANY, Poly, Term
from derive.real import NEGATION, Real, Sign, SignProduct, constant, contrary, scalars_of, sign_product
from derive.rules import Fact

__all__ = ["Ideal", "closure", "prove_identity", "prove_sign"]


def closure(polys: Sequence[Poly], real: Real, relations: Mapping[str, Poly], expand: bool = True) -> dict[str, Poly]:
    """Return the defining relations of all atoms that occur in the polynomials, directly or within atoms.

    Without ``expand`` definitions are left out, so that a scalar stays what it is called.
    """
    found, waiting = dict[str, Poly](), {s for p in polys for s in scalars_of(p)}
    names = {a.name: name for name, a in _relations_of(real, relations).items()}
    seen = set[str]()
    while waiting:
        s = waiting.pop()
        seen.add(s)
        atom = real.atoms.get(s)
        if atom is not None and (expand or atom.kind != "defined"):
            waiting |= scalars_of(atom.of) - seen
            if s in names:
                found[names[s]] = relations[names[s]]
    return dict(sorted(found.items()))


def _relations_of(real: Real, relations: Mapping[str, Poly]) -> dict[str, Any]:
    from derive.real import atom_relation

    out = {name: real.atoms[name] for name in relations if name in real.atoms}
    wanted = {atom_relation(a): a for a in real.atoms.values() if a.kind == "defined"}
    return {**out, **{name: wanted[p] for name, p in relations.items() if p in wanted}}


class Ideal:
    """Polynomials that are zero, completed to a Groebner basis on demand; every element knows where it comes from."""

    def __init__(self, relations: Mapping[str, Poly], order: Sequence[str], seconds: float = 30.0):
        from sympy import QQ, ring
        from sympy.polys.orderings import lex

        names = list(dict.fromkeys([*order, *(s for p in relations.values() for s in sorted(scalars_of(p)))]))
        self.index = {name: i for i, name in enumerate(reversed(names))}
        self.names = list(reversed(names))
        self.ring = ring([f"x{i}" for i in range(len(names))] or ["x0"], QQ, lex)[0]
        self.relations = list(relations)
        self.deadline = time.monotonic() + seconds
        self.basis: list[tuple[Any, dict[int, Any]]] = []
        self.pairs: list[tuple[int, int]] = []
        for i, poly in enumerate(relations.values()):
            self._add(self.encode(poly), {i: self.ring.one})

    def encode(self, poly: Poly) -> Any:
        """Return a SymPy polynomial."""
        from sympy import QQ

        out: dict[Any, Any] = {}
        for (m, _), c in poly.terms.items():
            exponents = [0] * self.ring.ngens
            for s in m:
                exponents[self.index[s]] += 1
            out[tuple(exponents)] = QQ(c.numerator, c.denominator)
        return self.ring.from_dict(out)

    def decode(self, poly: Any) -> Poly:
        """Return a kernel polynomial."""
        terms = {
            (tuple(sorted(s for i, e in enumerate(m) for s in [self.names[i]] * e)), ()): Fraction(
                int(c.numerator), int(c.denominator)
            )
            for m, c in poly.terms()
        }
        return Poly({k: c for k, c in terms.items() if c}, ANY, ANY)

    def reduce(self, poly: Any) -> tuple[Any, dict[int, Any]]:
        """Return the remainder, and the cofactors of the relations that were subtracted."""
        used: dict[int, Any] = {}
        if not poly or not self.basis:
            return poly, used
        quotients, rest = poly.div([g for g, _ in self.basis])
        for q, (_, source) in zip(quotients, self.basis, strict=True):
            if q:
                for i, h in source.items():
                    used[i] = used.get(i, self.ring.zero) + q * h
        return rest, used

    def grow(self) -> bool:
        """Take up one more element of the Groebner basis; False if there is none, or no time."""
        while self.pairs and time.monotonic() < self.deadline:
            i, j = self.pairs.pop(0)
            (f, source_f), (g, source_g) = self.basis[i], self.basis[j]
            lcm = tuple(map(max, f.LM, g.LM))
            if sum(lcm) == sum(f.LM) + sum(g.LM):
                continue
            up = [self.ring.from_dict({tuple(a - b for a, b in zip(lcm, h.LM, strict=True)): 1 / h.LC}) for h in (f, g)]
            rest, used = self.reduce(up[0] * f - up[1] * g)
            if rest:
                source = {k: up[0] * h for k, h in source_f.items()}
                for k, h in source_g.items():
                    source[k] = source.get(k, self.ring.zero) - up[1] * h
                for k, h in used.items():
                    source[k] = source.get(k, self.ring.zero) - h
                self._add(rest, source)
                return True
        return False

    def _add(self, poly: Any, source: dict[int, Any]) -> None:
        new = len(self.basis)
        self.basis.append((poly, source))
        size = lambda pair: sum(map(max, self.basis[pair[0]][0].LM, self.basis[pair[1]][0].LM))  # noqa: E731
        self.pairs = sorted([*self.pairs, *((i, new) for i in range(new))], key=size)

    def member(self, claim: Poly) -> tuple[Term, ...] | None:
        """Return the addends that make up a polynomial of the ideal, else None."""
        rest, total = self.encode(claim), dict[int, Any]()
        while True:
            rest, used = self.reduce(rest)
            for i, h in used.items():
                total[i] = total.get(i, self.ring.zero) + h
            if not rest:
                return tuple(self._terms(total))
            if not self.grow():
                return None

    def _terms(self, cofactors: Mapping[int, Any]) -> Iterator[Term]:
        for i, h in cofactors.items():
            for (m, _), c in self.decode(h).terms.items():
                yield Term(c, m, (), self.relations[i], False, ())


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
    while len(ideal.basis) < 40 and ideal.grow():
        pass
    whole = tuple(name for name, fact in facts.items() if name != NEGATION and fact.kind != "nonzero")
    direct = [SignProduct(Fraction(1), names, s) for names in ((), whole) for s in ((), *((q,) for q in squares))]
    direct += [SignProduct(Fraction(1), (NEGATION,))] if against else []
    for d in range(degree + 1):
        found = _contradiction(list(_products(facts, squares, d)) if d else direct, facts, ideal)
        if found:
            total = constant(0)
            for product in found:
                total = total + sign_product(product, facts)[0]
            terms = ideal.member(total)
            if terms is not None:
                return Sign(claim, relation, tuple(found), terms)
    return None


def _products(facts: Mapping[str, Fact], squares: Sequence[Poly], degree: int) -> Iterator[SignProduct]:
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


def _contradiction(
    products: Sequence[SignProduct], facts: Mapping[str, Fact], ideal: Ideal
) -> list[SignProduct] | None:
    """Return products with coefficients whose sum is zero in the ideal, one of them positive."""
    import z3

    context = z3.Context()  # of its own, so that the answer does not depend on what was asked before
    solver, sums = z3.SolverFor("QF_LRA", context), dict[Any, list[Any]]()
    unknowns, strict = [z3.Real(f"c{i}", context) for i in range(len(products))], []
    for product, c in zip(products, unknowns, strict=True):
        value, positive = sign_product(product, facts)
        rest, _ = ideal.reduce(ideal.encode(value))
        for m, k in rest.terms():
            sums.setdefault(m, []).append(z3.RealVal(f"{int(k.numerator)}/{int(k.denominator)}", context) * c)
        strict += [c] if positive else []
        solver.add(c >= 0)
    solver.add(*(z3.Sum(addends) == 0 for addends in sums.values()), z3.Sum(strict) >= 1)
    if not strict or solver.check() != z3.sat:
        return None
    model = solver.model()
    values = [model.eval(c, model_completion=True).as_fraction() for c in unknowns]
    return [SignProduct(Fraction(v), p.facts, p.squares) for v, p in zip(values, products, strict=True) if v]
