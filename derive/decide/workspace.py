"""What one claim is decided with: its theory's reading, what was established on the way, and the provers over it."""

from __future__ import annotations

import time
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from fractions import Fraction

from derive.claim import Counterexample
from derive.context import names_of
from derive.decide.ground import Introduced, Item, Lemma, accept, directions, leave_out, suppose, without_cases
from derive.kernel import Certificate, Letter, Poly, Rejected, Term, identity, replay
from derive.matrix.bearing import bearing
from derive.matrix.hypotheses import Hypotheses
from derive.matrix.instance import unknowns
from derive.matrix.positivity import prove_positive
from derive.matrix.refute import refute
from derive.matrix.sample import holds_at, sample
from derive.matrix.search import prove
from derive.real import UNIT
from derive.rules import Fact, Grid, Positivity, Square
from derive.spectral import RealPart
from derive.terms import Equation, Number, Reading, Symbol, Zero, lower
from derive.theory.claims.base import ClaimTheory

SAMPLES = 2
OVERLAPS = 600  # in one search of a certificate; what is found needs less than 40
MOST = 2500  # instances that are tried for a counterexample; what is found needs a few hundred
ATTEMPT = 3.0  # seconds for one search of a certificate


def proof_reading(theory: ClaimTheory, equations: Iterable[Equation] = ()) -> Reading:
    """Return what a proof may use: the theory without its cases, which hold of instances only.

    Gradients that occur in some equations have letters for their directions.
    """
    reading = without_cases(theory.reading)
    context = reading.context
    along = {name: Letter(name, s.rows, s.cols) for name, s in directions(equations).items()}
    alphabet = replace(context.alphabet, letters={**along, **context.alphabet.letters})
    return replace(reading, context=replace(context, alphabet=alphabet))


def conditions(theory: ClaimTheory) -> dict[str, Fact] | None:
    """Return the assumed relations that only instances know as facts: X ≠ 0, Re λ_i(A) < 0; None for other forms."""
    found: dict[str, Fact] = {}
    for i, equation in enumerate(theory.conditions):
        fact = _condition(equation, theory.reading)
        if fact is None:
            return None
        found[f"condition {i + 1}"] = fact
    return found


def _condition(equation: Equation, reading: Reading) -> Fact | None:
    letters = reading.context.alphabet.letters
    match equation:
        case Equation(Number() | Zero() as zero, ">", RealPart(Symbol(show_args=(name,)))) if name in letters:
            matrix = Poly({((), (name,)): 1}, letters[name].rows, letters[name].cols)
            return Fact("hurwitz", ((matrix,),)) if zero in (Zero("", ""), Number(Fraction(0))) else None
        case Equation(_, "≠", _):
            try:
                return Fact("nonzero", _difference(equation, reading))
            except Rejected:
                return None
        case _:
            return None


def _difference(equation: Equation, reading: Reading) -> Grid:
    left = lower(equation.lhs, reading)
    if isinstance(equation.rhs, Zero) and not equation.rhs.rows:
        return left
    right = lower(equation.rhs, reading)
    return tuple(tuple(p - q for p, q in zip(r, s, strict=True)) for r, s in zip(left, right, strict=True))


@dataclass
class Workspace:
    """A reading that grows while a claim is decided, and the time that is left."""

    theory: ClaimTheory
    deadline: float
    statements: tuple[Equation, ...] = ()
    reading: Reading = field(init=False)
    items: list[Item] = field(default_factory=list[Item])

    def __post_init__(self) -> None:
        self.reading = proof_reading(self.theory, self.statements)

    # -------------------------------------------------------------------------------------------- what is known
    @property
    def left(self) -> float:
        """Seconds that are left."""
        return max(self.deadline - time.monotonic(), 0.0)

    @property
    def attempt(self) -> float:
        """Seconds for one search of a certificate."""
        return min(self.left, ATTEMPT)

    def take(self, *items: Item) -> None:
        """Accept lemmas or inverses, and keep them for the certificate."""
        self.reading = accept(items, self.reading, self.theory.theory)
        self.items += items

    def suppose(self, poly: Poly) -> None:
        """Take up an inverse without reason, to look for an instance that refutes; no proof from it is accepted."""
        self.reading = suppose(Introduced(self.fresh(), poly), self.reading)
        self.items.append(Introduced(self.fresh(), poly))

    def fresh(self) -> str:
        """Return a name for the next inverse."""
        return f"inverse {1 + sum(isinstance(i, Introduced) for i in self.items)}"

    def inverse(self, poly: Poly) -> Poly | None:
        """Return the letter for the inverse of a matrix or of its transpose, if there is one."""
        alphabet = self.reading.context.alphabet
        for candidate, turned in ((poly, False), (alphabet.transpose(poly), True)):
            name = self.reading.inverses.get(candidate)
            if name is not None:
                return Poly({((), (alphabet.flip(name) if turned else name,)): 1}, poly.cols, poly.rows)
        return None

    def problem(self) -> Hypotheses | None:
        """Return what a counterexample has to satisfy; None if not all of it can be tested."""
        extra = conditions(self.theory)
        if extra is None or self.waiting():
            return None
        context, full = self.reading.context, self.theory.reading.context
        relations = {**{n: p for n, p in full.relations.items() if n not in context.relations}, **context.relations}
        letters = {name: poly for poly, name in self.reading.inverses.items()}
        declared = {n: f for n, f in context.facts.items() if n in self.theory.theory.declared}
        facts = {**full.facts, **declared, **extra}
        return Hypotheses(context.alphabet, relations, facts, letters, context.nonnegative)

    def waiting(self) -> list[str]:
        """Return the declarations that wait for the reason of an inverse."""
        return [name for name in self.theory.theory.declared if name not in self.reading.adopted]

    def equations(self, every_gain: bool) -> Hypotheses:
        """Return the equations that a proof may use, without those of the optimal gain if asked so."""
        context = self.reading.context
        relations, optimal = context.relations, self.theory.optimal
        if every_gain:
            relations = leave_out(optimal, relations)
        inverses = {name: poly for poly, name in self.reading.inverses.items()}
        return Hypotheses(context.alphabet, relations, {}, inverses, context.nonnegative)

    # -------------------------------------------------------------------------------------------- provers
    def prove(self, claim: Poly, trace: bool = False, every_gain: bool | None = None) -> Certificate | None:
        """Search for a proof of claim = 0 from few equations first; what is found is replayed.

        Inverses alone; then everything but the optimal gain; then everything.
        """
        stages = self._stages(claim, every_gain)
        for i, relations in enumerate(stages):
            if i and relations == stages[i - 1]:
                continue
            found = self._prove(claim, relations, trace)
            if found:
                return found
        return None

    def _stages(self, claim: Poly, every_gain: bool | None) -> list[Mapping[str, Poly]]:
        letters = unknowns(claim)
        any_gain, all_ = (self.equations(flag) for flag in (True, False))
        known = {f"{name}.{side}" for name in any_gain.inverses for side in ("left", "right", "value")}
        stages: list[Mapping[str, Poly]] = []
        for problem in [any_gain] + [all_] * (not every_gain):
            bears = bearing(problem, letters)
            near = {n for name in bears.inverses for n in names_of(name, problem.relations)}
            if not stages:
                own = {n for name in bears.inverses if name in letters for n in names_of(name, problem.relations)}
                stages.append({n: p for n, p in problem.relations.items() if n in own & known})
            chosen = set(bears.relations) | set(bears.central) | (near & known)
            stages.append({n: p for n, p in problem.relations.items() if n in chosen})
        return stages

    def _prove(self, claim: Poly, relations: Mapping[str, Poly], trace: bool) -> Certificate | None:
        """Search for a proof from some relations, unless a random instance of them tells that there is none."""
        context = self.reading.context
        inverses = {name: poly for poly, name in self.reading.inverses.items() if f"{name}.left" in relations}
        equations = Hypotheses(context.alphabet, relations, {}, inverses, context.nonnegative)
        if claim.terms and not holds_at(self._samples(equations, claim), claim, trace):
            return None
        found = prove(claim, relations, context.alphabet, trace=trace, overlaps=OVERLAPS, seconds=self.attempt)
        if found:
            replay(found, claim, context.relations, context.alphabet)
        return found

    def plausible(self, claim: Poly, trace: bool = False) -> bool:
        """Tell whether claim = 0 holds at random instances of the equations that a proof may use."""
        return not claim.terms or holds_at(self._samples(self.equations(False), claim), claim, trace)

    def _samples(self, equations: Hypotheses, claim: Poly):
        if any(s[0] in "∫δ" for m, _ in claim.terms for s in m):
            return []
        return sample(equations, [claim], SAMPLES)

    def positive(
        self, grid: Grid, strict: bool = False, squares: Sequence[Square] | None = None, inverse: Poly | None = None
    ) -> Positivity | None:
        """Search for a proof of G ⪰ 0, or G ≻ 0."""
        context = self.reading.context
        polys = [p for row in grid for p in row] + [f for s in squares or () for row in s.factor for f in row]
        polys += [h for s in squares or () for row in context.facts[s.fact].matrix for h in row]
        return prove_positive(
            grid,
            replace(context, relations=self.relations_on(polys)),
            squares,
            strict=strict,
            inverse=inverse,
            inverses=self.reading.inverses,
            overlaps=OVERLAPS,
            seconds=self.attempt,
        )

    def relations_on(self, polys: Iterable[Poly], every_gain: bool = False) -> dict[str, Poly]:
        """Return the relations that bear on some polynomials."""
        problem = self.equations(every_gain)
        bears = bearing(problem, set[str]().union(*map(unknowns, polys)))
        near = {n for name in bears.inverses for n in names_of(name, problem.relations)}
        chosen = set(bears.relations) | set(bears.central) | near
        return {n: p for n, p in problem.relations.items() if n in chosen}

    def lemma(self, name: str, poly: Poly, positivity: Positivity, strict: bool = False) -> str:
        """Take up M ⪰ 0 or M ≻ 0 as a fact, and return its name."""
        if name not in self.reading.context.facts:
            self.take(Lemma(name, "pd" if strict else "psd", ((poly,),), positivity))
        return name

    def inverse_is_positive(self, poly: Poly) -> str | None:
        """Return the name of the fact M^-1 ≻ 0 for M ≻ 0 with a letter for its inverse; it is proved when missing."""
        context = self.reading.context
        letter = self.inverse(poly)
        known = next((n for n, f in context.facts.items() if f.kind == "pd" and f.matrix == ((poly,),)), None)
        if letter is None or known is None:
            return None
        found = next((n for n, f in context.facts.items() if f.kind == "pd" and f.matrix == ((letter,),)), None)
        if found:
            return found
        square = Square(Fraction(1), (), ((letter,),), known)
        proof = self.positive(((letter,),), True, [square], poly)
        ((_, (name,)),) = letter.terms
        return self.lemma(f"{name} > 0", letter, proof, strict=True) if proof else None

    def refute(
        self, lhs: Poly, rhs: Poly | None = None, relation: str = "=", trace: bool = False, most: int = MOST
    ) -> Counterexample | None:
        """Search for an exact instance of all hypotheses where lhs relation rhs fails."""
        problem = self.problem()
        zero = Poly({}, lhs.rows, lhs.cols)
        scalars = {s for p in (lhs, rhs or zero) for m, _ in p.terms for s in m}
        if problem is None or UNIT in scalars:  # an instance is real
            return None
        right = zero if rhs is None else rhs
        return refute(lhs, right, problem, relation=relation, trace=trace, most=most, seconds=self.left)

    def proves_inverse(self, of: Poly, by: Poly) -> tuple[tuple[Term, ...], tuple[Term, ...]] | None:
        """Return the addends of M X = I and X M = I."""
        if (by.rows, by.cols) != (of.cols, of.rows):
            return None
        right = self.prove(of * by - identity(of.rows))
        left = self.prove(by * of - identity(of.rows)) if right else None
        return (right.terms, left.terms) if right and left else None
