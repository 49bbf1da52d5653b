"""Induction over the number of steps: what holds at the start, and of each step if of the one before, holds for all.

A theory may declare sequences. Then the scalar ``k`` is the number of steps, which ranges over 0, 1, 2, ..., and a
sequence x is a scalar x_k together with its first member x_0, in which k does not occur, and a scalar that stands for
x_{k+1}. That scalar is defined by x_k, as in ρ^{k+1} := ρ ρ^k with ρ^0 := 1, which determines the sequence; or it is a
letter that obeys an equation declared for every k, a recursion.

A statement in which such scalars occur says that it is true for every k, and so does every definition, hypothesis and
lemma that a proof by induction may use: a hypothesis that speaks of k or of a member of a sequence (k = 3, x_k > 0)
may hold for some k only, and is rejected wherever an induction rests on it, through lemmas and the reasons why
reciprocals, roots and logarithms exist as well. Only a recursion is declared for every k; that k >= 0 is proved.

Let S(k) be p = 0, p >= 0, p > 0 or p ≠ 0. Two certificates are replayed:

    start: S(0), where p is evaluated at k = 0: k is 0, and each x_k is x_0;
    step: S(k+1), from S(k), which is named ``claim at k``: k is k + 1, and each x_k is what stands for x_{k+1}.

Both are about an arbitrary k, so S(0) holds, and S(k+1) holds for each k for which S(k) does; the set of all k with
S(k) contains 0 and with each number the next, so that it is all natural numbers. ``claim at k`` is the claim itself at
k, and is there in the certificate of the step only; S(k+1) is available nowhere.

What is evaluated must exist: a reciprocal, root or logarithm in p needs to be declared, for k and for k + 1 (at the
start: for the value there), each with its reason, a fact that is proved for every k. That d_k > 0 for every k, by
induction, is such a reason. Limits, derivatives and integrals do not occur in S. Standard library only.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

from derive.calculus import at_origin, substituted
from derive.functions import Abs, Arctan, Exp, Log, Max, Power, Quotient, Root, over, value
from derive.kernel import Certificate, Poly, Rejected, replay
from derive.real import HYPOTHESIS, ONE, SIGNS, STEPS, Real, Sign, reciprocal, scalar, scalars_of
from derive.rules import Fact
from derive.scalars import check_sign
from derive.terms import Equation, Neg, Number, Product, Reading, Sum, Symbol, Term, Zero, walk

MEMBERWISE = ("root", "absolute", "part", "exp", "log", "arctan")  # functions whose next value is that of the next
ALGEBRAIC = (Symbol, Number, Zero, Neg, Sum, Product, Power, Quotient, Root, Abs, Max, Exp, Log, Arctan)


@dataclass(frozen=True)
class Induction:
    """The certificates of sign of an inequality: at the start, and one step later."""

    start: Sign
    step: Sign


@dataclass(frozen=True)
class Claim:
    """What is shown of every number of steps: p at k, at 0 and at k + 1, and its relation to zero."""

    now: Poly
    start: Poly
    later: Poly
    relation: str

    def supposed(self, reading: Reading) -> Reading:
        """Return what the step may use: all that is known, and the claim at k."""
        context = reading.context
        if self.relation == "=":
            context = replace(context, relations={**context.relations, HYPOTHESIS: self.now})
        else:
            context = replace(context, facts={**context.facts, HYPOTHESIS: Fact(SIGNS[self.relation], ((self.now,),))})
        return replace(reading, context=context)


def claim_of(statement: Equation, reading: Reading) -> Claim:
    """Read a statement about every number of steps, or raise Rejected."""
    if not reading.real.sequences:
        raise Rejected("an induction needs a theory with sequences")
    if statement.relation not in ("=", *SIGNS):
        raise Rejected(f"{statement.relation} is not shown by induction")
    if not all(isinstance(node, ALGEBRAIC) for node in _nodes(statement)):
        raise Rejected("an induction is about sums, products, quotients and functions of numbers")
    now = value(statement.lhs, reading) - value(statement.rhs, reading)
    return Claim(now, at_origin(now, STEPS, reading.real), following(now, reading.real), statement.relation)


def following(poly: Poly, real: Real) -> Poly:
    """Return the value at k + 1 of a polynomial in k, members of sequences and functions of them."""

    def image(name: str) -> Poly:
        if name == STEPS:
            return scalar(STEPS) + ONE
        if name in real.sequences:
            return scalar(real.sequences[name].after)
        atom = real.atoms.get(name)
        if atom is None:
            raise Rejected(f"the value of {name} at the next step is not known")
        of = following(atom.of, real) if atom.kind in ("defined", "reciprocal", *MEMBERWISE) else None
        if of is not None and atom.kind in ("defined", "reciprocal"):
            return of if atom.kind == "defined" else reciprocal(of, real)
        found = real.find(atom.kind, of) if of is not None else None
        if found is None:
            raise Rejected(f"the value of {name} at the next step is not declared")
        return scalar(found)

    return substituted(poly, STEPS, real, image)


def check_induction(
    statement: Equation, identities: Sequence[Certificate], signs: Induction | None, reading: Reading
) -> None:
    """Replay a proof by induction, or raise Rejected."""
    claim = claim_of(statement, reading)
    supposed = claim.supposed(reading)
    if claim.relation == "=":
        if signs is not None or len(identities) != 2 or any(c.trace for c in identities):
            raise Rejected("an induction of an equation has two identities, at the start and one step later")
        start, step = identities
        replay(start, claim.start, reading.context.relations, reading.context.alphabet)
        replay(step, claim.later, supposed.context.relations, supposed.context.alphabet)
        return
    if signs is None or identities:
        raise Rejected("an induction of an inequality has two certificates of sign, at the start and one step later")
    check_sign(signs.start, claim.start, claim.relation, reading)
    check_sign(signs.step, claim.later, claim.relation, supposed)


def starts_in(statement: Equation, reading: Reading) -> set[str]:
    """Return the names of the definitions of the first members of all sequences in a statement."""
    real = reading.real
    below = real.reached(scalars_of(claim_of(statement, reading).now))
    return {real.sequences[name].name for name in below & real.sequences.keys()}


def atoms_in(statement: Equation, reading: Reading) -> set[str]:
    """Return the functions that the sides of a statement are made of, for k, at the start and one step later."""
    claim, found = claim_of(statement, reading), set[str]()
    for node in _nodes(statement):
        found |= scalars_of(over(node.bottom, reading) if isinstance(node, Quotient) else value(node, reading))
    for poly in (claim.now, claim.start, claim.later):
        found |= scalars_of(poly)
    return reading.real.reached(found) & reading.real.atoms.keys()


def _nodes(statement: Equation) -> list[Term]:
    return [node for side in (statement.lhs, statement.rhs) for node in walk(side)]
