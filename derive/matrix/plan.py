"""What to choose and what to compute when an instance of some hypotheses is built.

Inverse letters are computed from what they invert. Every other relation is solved for a letter that occurs linearly in
it: a lone one if there is one (X in X = f, the noise in a Riccati equation), else one that no other letter of the
relation depends on. All other letters are free.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from itertools import chain

from derive.kernel import ANY, Poly, parts
from derive.matrix.hypotheses import Hypotheses
from derive.matrix.instance import Instance, base, stack, unknowns
from derive.rules import Fact

__all__ = ["Plan", "Rule", "make_plan"]


@dataclass(frozen=True)
class Rule:
    """How one letter or scalar follows from others: by inverting ``poly``, or by solving poly = 0 for it."""

    target: str
    kind: str  # 'inverse', 'matrix' or 'scalar'
    poly: Poly

    def apply(self, instance: Instance) -> bool:
        """Set the target's value; False if there is none."""
        if self.kind == "inverse":
            return _invert(self, instance)
        return (_solve if self.kind == "matrix" else _solve_scalar)(self, instance)


@dataclass(frozen=True)
class Plan:
    """Free letters and scalars in order, the rules for the others, and what is left to be tested."""

    free: tuple[str, ...]
    free_scalars: tuple[str, ...]
    rules: tuple[Rule, ...]
    relations: Mapping[str, Poly]
    facts: Mapping[str, Fact]


def make_plan(problem: Hypotheses, claim: Iterable[Poly]) -> Plan | None:
    """Return how to build instances of the hypotheses that bear on a claim; None if one cannot be evaluated.

    A relation that merely defines a letter which occurs nowhere else is left out, as is what shares no letter with
    the claim, directly or through other hypotheses.
    """
    wanted = set[str]().union(*map(unknowns, claim))
    relations, inverses = _peel(problem, wanted)
    relations, facts, inverses, letters = _connected(problem, wanted, relations, inverses)
    polys = [*claim, *relations.values(), *inverses.values(), *(p for f in facts.values() for p in _polys(f))]
    scalars = {s for p in polys for m, _ in p.terms for s in m}
    central = {n: p for n, p in problem.relations.items() if p.rows == ANY}
    scalars |= {s for p in central.values() for m, _ in p.terms for s in m}
    if any(s[0] in "∫δ" for s in scalars):
        return None
    rules = [Rule(name, "inverse", poly) for name, poly in inverses.items()]
    rules += _solved(relations, rules)
    rules += _solved_scalars(central)
    targets = {rule.target for rule in rules}
    order = {name: i for i, name in enumerate(problem.alphabet.letters)}
    free = sorted(letters - targets, key=lambda a: (order.get(parts(a)[0], 0), a))
    return Plan(tuple(free), tuple(sorted(scalars - targets)), _sorted(rules), {**relations, **central}, facts)


def _polys(fact: Fact) -> list[Poly]:
    return [p for row in fact.matrix for p in row]


def _peel(problem: Hypotheses, wanted: set[str]) -> tuple[dict[str, Poly], dict[str, Poly]]:
    """Leave out relations and inverses that only define a letter which occurs nowhere else."""
    inverses = dict(problem.inverses)
    implied = {f for name, poly in inverses.items() for f in _inverse_relations(problem, name, poly)}
    relations = {n: p for n, p in problem.relations.items() if p not in implied and p.rows != ANY}
    fixed = wanted | {a for f in problem.facts.values() for p in _polys(f) for a in unknowns(p)}
    while True:
        counts: dict[str, int] = {}
        for a in chain(*map(unknowns, chain(relations.values(), inverses.values()))):
            counts[a] = counts.get(a, 0) + 1
        gone = [n for n in inverses if n not in fixed and n not in counts]
        for n in gone:
            del inverses[n]
        done = next((n for n, p in relations.items() if _defines_unused(p, counts, fixed, problem)), None)
        if done is not None:
            del relations[done]
        elif not gone:
            return relations, inverses


def _inverse_relations(problem: Hypotheses, name: str, poly: Poly) -> list[Poly]:
    """Return both relations of an inverse, as they are declared and transposed."""
    letter = Poly({((), (name,)): 1}, poly.cols, poly.rows)
    one = Poly({((), ()): 1}, poly.rows, poly.rows)
    both = [poly * letter - one, letter * poly - one]
    return both + [problem.alphabet.transpose(p) for p in both]


def _defines_unused(poly: Poly, counts: Mapping[str, int], fixed: set[str], problem: Hypotheses) -> bool:
    turned = problem.alphabet.transpose(poly)
    for letter in _lone(poly):
        symmetric = problem.alphabet.letters[parts(letter)[0]].symmetric
        free = letter not in fixed and letter not in problem.inverses and counts[letter] == 1
        if free and (not symmetric or turned in (poly, -poly)):
            return True
    return False


def _lone(poly: Poly) -> list[str]:
    """Return the letters that occur once, as a term of their own without scalars."""
    occurrences = [base(a) for _, w in poly.terms for a in w]
    return [base(w[0]) for m, w in poly.terms if len(w) == 1 and not m and occurrences.count(base(w[0])) == 1]


def _connected(
    problem: Hypotheses, wanted: set[str], relations: Mapping[str, Poly], inverses: Mapping[str, Poly]
) -> tuple[dict[str, Poly], dict[str, Fact], dict[str, Poly], set[str]]:
    """Return the hypotheses that share letters with the claim, directly or through others, and all their letters."""
    facts = {n: f for n, f in problem.facts.items() if f.kind != "initial"}
    groups: list[set[str]] = [unknowns(p) for p in relations.values()]
    groups += [set[str]().union(*map(unknowns, _polys(f))) for f in facts.values()]
    groups += [unknowns(p) | {name} for name, p in inverses.items()]
    letters, size = set(wanted), -1
    while size != len(letters):
        size = len(letters)
        for group in groups:
            if group & letters:
                letters |= group
    return (
        {n: p for n, p in relations.items() if unknowns(p) & letters},
        {n: f for n, f in facts.items() if any(unknowns(p) & letters for p in _polys(f))},
        {n: p for n, p in inverses.items() if n in letters},
        letters,
    )


def _solved(relations: Mapping[str, Poly], inverses: list[Rule]) -> list[Rule]:
    """Choose for each relation a letter to solve for, such that no letter depends on itself."""
    rules, solved = list(inverses), list[Rule]()
    for poly in relations.values():
        taken = {rule.target for rule in rules}
        linear = sorted(a for a in unknowns(poly) if all(sum(base(x) == a for x in w) <= 1 for _, w in poly.terms))
        for target in (*_lone(poly), *linear):
            if target not in taken and target not in _depends(unknowns(poly) - {target}, rules):
                rules.append(Rule(target, "matrix", poly))
                solved.append(rules[-1])
                break
    return solved


def _depends(letters: set[str], rules: Iterable[Rule]) -> set[str]:
    """Return the letters that the given ones depend on, themselves included."""
    sources = {rule.target: unknowns(rule.poly) - {rule.target} for rule in rules}
    seen: set[str] = set()
    stack_ = list(letters)
    while stack_:
        letter = stack_.pop()
        if letter not in seen:
            seen.add(letter)
            stack_ += sources.get(letter, ())
    return seen


def _solved_scalars(central: Mapping[str, Poly]) -> list[Rule]:
    rules: list[Rule] = []
    for poly in central.values():
        taken = {rule.target for rule in rules}
        counts = {s: max(m.count(s) for m, _ in poly.terms) for m, _ in poly.terms for s in m}
        target = next((s for s in sorted(counts, reverse=True) if counts[s] == 1 and s not in taken), None)
        if target is not None:
            rules.append(Rule(target, "scalar", poly))
    return rules


def _sorted(rules: list[Rule]) -> tuple[Rule, ...]:
    """Return scalars first, then each rule after those that it depends on."""
    out = [rule for rule in rules if rule.kind == "scalar"]
    waiting = [rule for rule in rules if rule.kind != "scalar"]
    while waiting:
        targets = {rule.target for rule in waiting}
        ready = [r for r in waiting if not (unknowns(r.poly) - {r.target}) & targets] or waiting
        out += ready
        waiting = [rule for rule in waiting if rule not in ready]
    return tuple(out)


# ------------------------------------------------------------------------------------------------ solving
def _invert(rule: Rule, instance: Instance) -> bool:
    value = instance.evaluate(rule.poly)
    if value.nrows() != value.ncols() or value.det() == 0:
        return False
    instance.values[rule.target] = value.inv()
    return True


def _solve(rule: Rule, instance: Instance) -> bool:
    """Solve poly(X) = 0, linear in X, for the solution whose free entries are zero."""
    directions = _directions(rule.target, instance)
    zero = directions[0] * 0
    start = _entries(rule, instance, zero)
    columns = [[a - b for a, b in zip(_entries(rule, instance, d), start, strict=True)] for d in directions]
    system = stack([[*(c[i] for c in columns), -start[i]] for i in range(len(start))])
    echelon, rank = system.rref()
    total = zero
    for i in range(rank):
        pivot = next(j for j in range(len(directions) + 1) if echelon[i, j] != 0)
        if pivot == len(directions):
            return False
        total += directions[pivot] * echelon[i, len(directions)]
    instance.values[rule.target] = total
    return True


def _entries(rule: Rule, instance: Instance, value) -> list:
    instance.values[rule.target] = value
    return instance.evaluate(rule.poly).entries()


def _directions(target: str, instance: Instance) -> list:
    """Return a basis of the values that a letter may take."""
    from flint import fmpq_mat

    rows, cols = instance.shape(target)
    symmetric = instance.alphabet.letters[parts(target)[0]].symmetric
    basis = []
    for i in range(rows):
        for j in range(i if symmetric else 0, cols):
            unit = fmpq_mat(rows, cols)
            unit[i, j] = 1
            if symmetric:
                unit[j, i] = 1
            basis.append(unit)
    return basis


def _solve_scalar(rule: Rule, instance: Instance) -> bool:
    """Solve a + b x = 0 for a central scalar."""
    from flint import fmpq

    instance.scalars[rule.target] = fmpq(0)
    a = instance.central(rule.poly)
    instance.scalars[rule.target] = fmpq(1)
    b = instance.central(rule.poly) - a
    if b == 0:
        return False
    instance.scalars[rule.target] = -a / b
    return True
