"""Derivations: steps with their proofs, lectures made of them, and the replay that trusts neither.

A step states ``before relation after`` and carries what the kernel needs to accept it. ``verify`` starts from the
installed theory, checks the steps in order and lets a proved step serve as a lemma for later ones.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, fields, replace
from functools import cached_property
from itertools import pairwise
from typing import Literal

from derive.context import DeclaredAtom, DeclaredInverse, Theory, adopt, by_name, owner
from derive.display import Displayed
from derive.functions import Definite, Limit, Rate, Start, single_of, value
from derive.induction import Induction, atoms_in, check_induction, starts_in
from derive.kernel import Certificate, Poly, Rejected, replay
from derive.kernel import Term as Addend
from derive.real import COMPLEX, STEPS, SUPPOSED, TIME, Sign, scalars_of
from derive.roots import check_positive, determinant_claim
from derive.rules import (
    Comparison,
    Grid,
    Positivity,
    Uniqueness,
    replay_comparison,
    replay_positivity,
    replay_uniqueness,
    variation,
)
from derive.scalars import RULES, check_scalar, scalar_claims
from derive.spectral import At, Entry
from derive.terms import (
    Dot,
    Equation,
    Expect,
    Gradient,
    Image,
    Integral,
    Neg,
    Reading,
    Sum,
    Term,
    Trace,
    Zero,
    lower,
    lower_trace,
    walk,
)

Rule = Literal[
    "identity", "apply", "trace", "gradient", "positivity", "comparison", "uniqueness", "chain",
    "scalar", "same rate", "sign", "both", "squeeze", "integral", "same argument",
    "instance", "sum over", "linear", "conjugate", "same roots", "modulus", "mirrored", "trace of roots", "determinant",
    "exchange", "positive", "resolvent", "single", "parameter", "any sign", "logarithms", "induction",
]  # fmt: skip
Text = tuple["str | Term | Equation", ...]
PARTS: Mapping[str, tuple[str, ...]] = {
    "positivity": ("positivity",),
    "comparison": ("comparison",),
    "uniqueness": ("uniqueness",),
    "chain": ("links",),
    "induction": ("identities", "induction"),
    **dict.fromkeys((*RULES, "positive"), ("sign", "links")),
}  # the parts of a proof that a rule replays, where they are not the identities
FUNCTIONS = ("modulus", "mirrored", "same roots", "trace of roots")  # rules with links that hold for every s
DIRECTION = "δ"  # the letter along which a gradient is taken, declared as "δ" + the letter's name


@dataclass(frozen=True)
class Proof:
    """What the kernel replays: identities in the order of the blocks, or a certificate of another kind."""

    identities: tuple[Certificate, ...] = ()
    positivity: Positivity | None = None
    comparison: Comparison | None = None
    uniqueness: Uniqueness | None = None
    links: tuple[str, ...] = ()
    sign: Sign | None = None
    induction: Induction | None = None

    def relations(self) -> set[str]:
        """Return the names of the relations and facts that the proof uses."""
        addends: list[Addend] = [t for c in self.identities for t in c.terms]
        names: set[str] = set(self.links)
        if self.positivity:
            addends += [t for row in self.positivity.terms for ts in row for t in ts]
            addends += self.positivity.inverse_terms
            names |= {s.fact for s in self.positivity.squares}
        if self.comparison:
            addends += self.comparison.terms
            names |= {self.comparison.stable, self.comparison.forcing}
        if self.uniqueness:
            addends += self.uniqueness.rate_terms + self.uniqueness.initial_terms
        for sign in (self.sign, *((self.induction.start, self.induction.step) if self.induction else ())):
            addends += sign.terms if sign else ()
            names |= {fact for product in sign.products for fact in product.facts} if sign else set()
        return (names | {t.relation for t in addends}) - SUPPOSED

    def claims(self) -> list[Poly]:
        """Return the polynomials that the certificates are about."""
        signs = (self.sign, *((self.induction.start, self.induction.step) if self.induction else ()))
        found = [part.claim for part in (*self.identities, *signs, self.comparison, self.uniqueness) if part]
        return [*found, *(p for row in (self.positivity.claim if self.positivity else ()) for p in row)]


@dataclass(frozen=True)
class Step(Displayed):
    """One step: the statement, the rule that carries it, a sentence for the reader, the proof, and what it uses.

    ``lemma`` steps may be used by later ones. ``number`` is the equation's number in ``source``, if it has one.
    """

    name: str
    statement: Equation
    rule: Rule
    reason: Text
    proof: Proof
    uses: tuple[str, ...] = ()
    number: str = ""
    source: str = ""
    lemma: bool = False

    @cached_property
    def rests_on(self) -> frozenset[str]:
        """What it names, and what the relations and facts of its proof stand for."""
        return frozenset(map(owner, (*self.uses, *self.proof.relations())))


def claims(statement: Equation, rule: Rule, reading: Reading) -> list[Certificate]:
    """Return the claims (certificates without addends) that a statement stands for under a rule.

    identity: lhs - rhs = 0, block by block. apply: both sides are the same operator, so it is enough that the bodies
    agree. trace: under the trace. gradient: the directional derivative of the trace along H is tr(G' H).
    """
    lhs, rhs = statement.lhs, statement.rhs
    if rule in ("scalar", "same rate"):
        return [Certificate(claim) for claim in scalar_claims(statement, rule, reading)]
    if rule == "determinant":
        return [Certificate(determinant_claim(statement, reading))]
    if rule == "gradient":
        return [Certificate(_gradient_claim(lhs, rhs, reading), trace=True)]
    if rule == "trace":
        return [Certificate(lower_trace(Sum((lhs, Neg(rhs))), reading), trace=True)]
    if rule == "apply":
        for side in (s for s in (lhs, rhs) if isinstance(s, Entry)):
            single_of(side.body, reading)
        lhs, rhs = _bodies(lhs, rhs)
    left, right = lower(lhs, reading), _like(rhs, lhs, reading)
    if len(left) != len(right) or len(left[0]) != len(right[0]):
        raise Rejected("the two sides have different block shapes")
    return [Certificate(p - q) for r, s in zip(left, right, strict=True) for p, q in zip(r, s, strict=True)]


def _bodies(lhs: Term, rhs: Term) -> tuple[Term, Term]:
    """Strip the same operators from both sides."""
    match lhs, rhs:
        case (Dot(a), Dot(b)) | (Expect(a), Expect(b)) | (Trace(a), Trace(b)):
            return (a, b) if not isinstance(a, (Dot, Expect)) else _bodies(a, b)
        case (Entry(a), Entry(b)):
            return a, b
        case (Integral(a, s), Integral(b, t)) if s == t:
            return a, b
        case (Image(f, a), Image(g, b)) if f == g:
            raise Rejected("a map of letters need not respect the relations; state the images instead")
        case _:
            raise Rejected("the rule 'apply' needs the same operator on both sides")


def _gradient_claim(lhs: Term, rhs: Term, reading: Reading) -> Poly:
    if not isinstance(lhs, Gradient):
        raise Rejected("the rule 'gradient' needs a gradient on the left")
    letter, change = lhs.symbol.letter, DIRECTION + lhs.symbol.letter
    moved = variation(lower_trace(lhs.body, reading), letter, change, reading.context)
    ((gradient,),) = _like(rhs, lhs.symbol, reading)
    along = Poly({((), (change,)): 1}, *reading.context.alphabet.shape(letter))
    product = reading.context.alphabet.transpose(gradient) * along
    return Poly(moved.terms, product.rows, product.cols) - product


def _like(term: Term, other: Term, reading: Reading) -> Grid:
    """Read a term; a bare zero takes the type of the other side."""
    if isinstance(term, Zero) and not term.rows:
        return tuple(tuple(Poly({}, p.rows, p.cols) for p in row) for row in lower(other, reading))
    return lower(term, reading)


def order_claim(statement: Equation, reading: Reading) -> Grid:
    """Return lhs - rhs, block by block."""
    left, right = lower(statement.lhs, reading), _like(statement.rhs, statement.lhs, reading)
    return tuple(tuple(p - q for p, q in zip(r, s, strict=True)) for r, s in zip(left, right, strict=True))


def check(step: Step, reading: Reading, earlier: dict[str, Step]) -> None:
    """Replay one step, or raise Rejected."""
    reading = in_force(step, reading, earlier)
    context, proof = reading.context, step.proof
    _check_variables(step, reading, earlier)
    _check_indices(step, reading, earlier)
    parts = PARTS.get(step.rule, ("identities",))
    if any(getattr(proof, f.name) and f.name not in parts for f in fields(proof)):
        raise Rejected(f"a proof by the rule {step.rule!r} has {' and '.join(parts)} and nothing else")
    if step.rule == "chain":
        _check_chain(step, earlier)
    elif step.rule == "induction":
        check_induction(step.statement, proof.identities, proof.induction, reading)
    elif step.rule == "positive":
        check_positive(step.statement, proof.links, reading)
    elif step.rule in RULES:
        links = [earlier[name].statement for name in proof.links if name in earlier]
        if len(links) != len(proof.links):
            raise Rejected("it rests on a step that is not proved before it")
        check_scalar(step.statement, step.rule, proof.sign, links, reading)
    elif step.rule in ("positivity", "comparison"):
        grid = order_claim(step.statement, reading)
        if step.rule == "positivity" and proof.positivity:
            kind = replay_positivity(proof.positivity, grid, context)
        elif step.rule == "comparison" and proof.comparison and len(grid) == len(grid[0]) == 1:
            kind = replay_comparison(proof.comparison, grid[0][0], context)
        else:
            raise Rejected("the proof is of another kind than the rule")
        if step.statement.relation not in ("⪰", "≻") or (step.statement.relation == "≻" and kind != "pd"):
            raise Rejected(f"{step.statement.relation} is not what the certificate shows")
    else:
        if step.statement.relation != "=":
            raise Rejected(f"the rule {step.rule!r} proves equations, not {step.statement.relation}")
        if step.rule == "uniqueness":
            if proof.uniqueness is None:
                raise Rejected("the proof is of another kind than the rule")
            ((claim,),) = order_claim(step.statement, reading)
            replay_uniqueness(proof.uniqueness, claim, context)
            return
        wanted = claims(step.statement, step.rule, reading)
        if len(wanted) != len(proof.identities):
            raise Rejected(f"{len(wanted)} identities are needed, the proof has {len(proof.identities)}")
        for claim, certificate in zip(wanted, proof.identities, strict=True):
            if certificate.trace != claim.trace:
                raise Rejected("a certificate under the trace does not prove the matrices equal")
            replay(certificate, claim.claim, context.relations, context.alphabet)


def _check_variables(step: Step, reading: Reading, earlier: Mapping[str, Step]) -> None:
    """Reject a limit, derivative, integral or induction in a variable that a hypothesis holds at some value.

    The same for s where a function of s is read elsewhere, or a link is an identity between functions of s.
    """
    nodes = [n for side in (step.statement.lhs, step.statement.rhs) for n in walk(side)]
    moving = {n.symbol.name for n in nodes if isinstance(n, (Limit, Rate, Start, Definite))}
    moving |= {TIME} if step.rule == "same rate" else set()
    moving |= {COMPLEX} if step.rule in FUNCTIONS or any(isinstance(n, At) for n in nodes) else set()
    names = {*step.uses, *step.proof.relations()}
    if moving:
        links = [earlier[name].statement for name in step.proof.links if name in earlier]
        names |= {name for statement in (step.statement, *links) for name in _made_of(statement, reading)}
    if step.rule == "induction":
        moving, names = {STEPS}, names | atoms_in(step.statement, reading)
        if unnamed := starts_in(step.statement, reading) - {*step.uses}:
            raise Rejected(f"it rests on {', '.join(sorted(unnamed))} without naming it")
    for name in _behind(names, reading, earlier) if moving else ():
        if moving & reading.real.fixed.get(name, frozenset()):
            raise Rejected(f"it rests on {name}, which holds {' and '.join(moving)} at some value")


def _check_indices(step: Step, reading: Reading, earlier: Mapping[str, Step]) -> None:
    """Reject what is shown of no root from what holds for every root: a polynomial of degree 0 has none."""
    if not reading.real.families:
        return
    context, claims = reading.context, step.proof.claims()
    named = step.proof.relations() - {*step.proof.links}
    used = [context.relations[name] for name in named & context.relations.keys()]
    facts = [context.facts[name] for name in named & context.facts.keys()]
    used += [p for fact in facts for row in fact.matrix for p in row]
    if step.rule not in (*FUNCTIONS, "sum over"):
        used += [p for name in step.proof.links if name in earlier for p in _sides_of(earlier[name], reading)]
        claims = claims or _sides_of(step, reading)
    for index in {family.index for family in reading.real.families.values()}:
        if _carry(used, index, reading) and not _carry(claims, index, reading):
            raise Rejected(f"there may be no root of which it holds: the claim has no index {index}")


def _carry(polys: Sequence[Poly], index: str, reading: Reading) -> bool:
    return any(reading.real.varies(s, index) for poly in polys for s in scalars_of(poly))


def _sides_of(step: Step, reading: Reading) -> list[Poly]:
    """Return the difference of the sides, and what is in a limit, integral or derivative, as far as they are read."""
    found: list[Poly] = []
    lhs, rhs = step.statement.lhs, step.statement.rhs
    for side in (s for s in (lhs, rhs) if isinstance(s, (Limit, Definite, Rate, Start))):
        for term in (side.body, lhs, rhs):
            with suppress(Rejected):
                found.append(value(term, reading))
    with suppress(Rejected):
        found += [] if found else [value(lhs, reading) - value(rhs, reading)]
    with suppress(Rejected):
        found += [] if found else [poly for row in order_claim(step.statement, reading) for poly in row]
    return found


def _made_of(statement: Equation, reading: Reading) -> set[str]:
    """Return the functions that occur in a statement, as far as they can be read, each of which exists for a reason."""
    found = set[str]()
    for node in (n for side in (statement.lhs, statement.rhs) for n in walk(side)):
        with suppress(Rejected):
            found |= scalars_of(value(node, reading))
    return reading.real.reached(found) & reading.real.atoms.keys()


def _below(names: set[str], reading: Reading, earlier: Mapping[str, Step]) -> set[str]:
    """Return the names, and all that they rest on: through steps, and the reasons of atoms."""
    seen, waiting = set[str](), set(map(owner, names))
    while waiting:
        seen.add(name := waiting.pop())
        if name in earlier:
            waiting |= earlier[name].rests_on - seen
        elif name in reading.real.reasons:
            waiting |= set(reading.real.reasons[name]) - seen
    return seen


def _behind(names: set[str], reading: Reading, earlier: Mapping[str, Step]) -> set[str]:
    """Return the names, all that they rest on, and the functions of which relations and facts among them speak."""
    context, real, seen = reading.context, reading.real, set[str]()
    parts = by_name(context.relations)
    while names != seen:
        seen = _below(names, reading, earlier)
        polys = [context.relations[r] for name in seen for r in parts.get(name, ())]
        polys += [p for name in seen & context.facts.keys() for row in context.facts[name].matrix for p in row]
        names = seen | (real.reached({s for poly in polys for s in scalars_of(poly)}) & real.atoms.keys())
    return seen


def hidden_from(step: Step, reading: Reading, earlier: Mapping[str, Step]) -> set[str]:
    """Return the cases that a step does not name, nor what it names rests on, and what is proved in such cases."""
    cases = reading.real.cases
    hidden = set(cases - _below({*step.uses, *step.proof.relations()}, reading, earlier)) if cases else set[str]()
    for name, other in earlier.items() if hidden else ():
        if hidden & other.rests_on:
            hidden.add(name)
    return hidden


def in_force(step: Step, reading: Reading, earlier: Mapping[str, Step]) -> Reading:
    """Return the reading without the facts and limits that are hidden from a step; some rules look for them."""
    real, context, hidden = reading.real, reading.context, hidden_from(step, reading, earlier)
    facts = {name: fact for name, fact in context.facts.items() if name not in hidden}
    limits = {key: limit for name, key, limit in reversed(real.named) if name not in hidden}
    sums = tuple(known for known in real.sums if known[4] not in hidden)
    return replace(reading, context=replace(context, facts=facts), real=replace(real, limits=limits, sums=sums))


def _check_chain(step: Step, earlier: dict[str, Step]) -> None:
    """Accept a = z from a = b, b = c, ..., y = z proved before."""
    links = [earlier.get(name) for name in step.proof.links]
    if not links or any(s is None or s.statement.relation != "=" for s in links):
        raise Rejected("a chain needs equations that are proved before it")
    ends = [(s.statement.lhs, s.statement.rhs) for s in links if s]
    if any(a[1] != b[0] for a, b in pairwise(ends)):
        raise Rejected("the links of the chain do not meet")
    if (ends[0][0], ends[-1][1]) != (step.statement.lhs, step.statement.rhs) or step.statement.relation != "=":
        raise Rejected("the chain has other ends")


@dataclass(frozen=True)
class Outcome:
    """What the replay said of one step: accepted, or the reason why not."""

    step: str
    accepted: bool
    message: str = ""


def verify(theory: Theory, steps: Sequence[Step]) -> list[Outcome]:
    """Replay steps in order from the installed theory; a rejected step serves no later one."""
    reading, earlier, outcomes = theory.reading(), dict[str, Step](), list[Outcome]()
    taken = {*theory.declared, *SUPPOSED}
    for step in steps:
        try:
            if step.name in {*taken, *reading.context.facts, *reading.context.relations}:
                raise Rejected(f"the name {step.name} is taken")
            if owner(step.name) != step.name:
                raise Rejected(f"{step.name} is the name of a part of {owner(step.name)}")
            taken.add(step.name)
            check(step, reading, earlier)
            reading = learn(reading, theory, step)
        except (Rejected, ValueError, IndexError) as error:
            outcomes.append(Outcome(step.name, False, str(error)))
            continue
        earlier[step.name] = step
        outcomes.append(Outcome(step.name, True))
    return outcomes


def learn(reading: Reading, theory: Theory, step: Step) -> Reading:
    """Let a proved step serve as a lemma, and take up declarations that waited for it."""
    return theory.settle(adopt(reading, step.name, step.statement), step.statement) if step.lemma else reading


# ------------------------------------------------------------------------------------------------ lectures
@dataclass(frozen=True)
class Heading:
    """A section of a lecture."""

    title: str


@dataclass(frozen=True)
class Paragraph:
    """Running text; terms and equations in it are typeset inline."""

    text: Text


@dataclass(frozen=True)
class Given:
    """Equations that the source or the theory defines or assumes; they carry no proof."""

    rows: tuple[GivenRow, ...]


@dataclass(frozen=True)
class GivenRow:
    """One defining equation or hypothesis, by its name in the theory."""

    statement: Equation
    name: str = ""
    kind: Literal["definition", "hypothesis"] = "definition"
    number: str = ""
    source: str = ""
    reason: Text = ()


@dataclass(frozen=True)
class Derived(Displayed):
    """A chain of steps, displayed one under the other; ``title`` names what is derived."""

    steps: tuple[Step, ...]


@dataclass(frozen=True)
class Evidence:
    """An exact instance that separates a printed formula from the true one: values and what each side gives."""

    values: tuple[tuple[str | Term, str], ...]
    results: tuple[tuple[str | Term, str], ...]


@dataclass(frozen=True)
class Erratum:
    """A formula of a source that is false, incomplete or silent, with the evidence and the true formula."""

    source: str
    number: str
    finding: Literal["false", "incomplete", "assumption", "silent"]
    printed: Equation | Text
    text: Text
    evidence: tuple[Evidence, ...] = ()
    true: Equation | None = None
    proved_by: str = ""


Item = Heading | Paragraph | Given | Derived | Erratum


@dataclass(frozen=True)
class Lecture(Displayed):
    """A lecture: items in order, over one theory."""

    key: str
    title: str
    theory: Theory
    items: tuple[Item, ...]
    sources: tuple[str, ...] = ()

    @property
    def steps(self) -> tuple[Step, ...]:
        """All steps in order."""
        return tuple(s for item in self.items if isinstance(item, Derived) for s in item.steps)

    @property
    def errata(self) -> tuple[Erratum, ...]:
        """All errata in order."""
        return tuple(item for item in self.items if isinstance(item, Erratum))

    def step(self, name: str) -> Step:
        """Return the step of that name."""
        return next(s for s in self.steps if s.name == name)

    def rests_on(self, name: str) -> frozenset[str]:
        """Return the definitions and hypotheses that a step rests on, through lemmas and the reasons of inverses."""
        step = next((s for s in self.steps if s.name == name), None)
        item = self.theory.declared.get(name)
        if step is None and not (isinstance(item, (DeclaredInverse, DeclaredAtom)) and item.because):
            return frozenset({name})
        because = item.because if isinstance(item, (DeclaredInverse, DeclaredAtom)) else ()
        below = (*step.uses, *step.proof.links) if step else (because,) if isinstance(because, str) else because
        return frozenset().union(*map(self.rests_on, below))

    def verify(self) -> list[Outcome]:
        """Replay every step with the kernel."""
        return verify(self.theory, self.steps)
