"""Induction over the number of steps: what it proves, against exact numbers, and what it must not prove.

Each false statement is the smallest that one gap of the rule would let through.
"""

from __future__ import annotations

import json
import random
from collections.abc import Callable
from copy import deepcopy
from dataclasses import replace
from fractions import Fraction
from math import isqrt

import pytest

from derive.context import Theory
from derive.derivation import Proof, Step, verify
from derive.document import lecture_to_json
from derive.errors import InputError
from derive.functions import Abs, Definite, Infinity, Limit, Log, Power, Quotient, Rate, Root, Start, value
from derive.induction import Induction, claim_of, following
from derive.kernel import ANY, Certificate, Poly, Rejected
from derive.kernel import Term as Addend
from derive.real import HYPOTHESIS, NEGATION, Sign, SignProduct, scalars_of
from derive.replay import verify_data
from derive.spectral import Det
from derive.terms import Equation, Glyph, Number, Symbol, Term, Zero
from derive.theory import lecture
from derive.theory.builder import NotDerived
from derive.theory.scalar_builder import ScalarBuilder
from derive.wellformed import check_work

ZERO, ONE, TWO, NONE = Zero("", ""), Number(Fraction(1)), Number(Fraction(2)), Number(Fraction(0))
UNIT = Fraction(1)


# ------------------------------------------------------------------------------------------------ exact numbers
class Outside(Exception):  # noqa: N818
    """The point is outside of a case."""


class Exactly:
    """Rational numbers for all letters; a member of a sequence by its own recursion, in plain arithmetic."""

    def __init__(self, real, A, C, Q, R, P0, k):
        self.real = real
        self.known = {"A": A, "C": C, "Q": Q, "R": R, "P0": P0, "k": Fraction(k)}
        P, total = P0, Fraction(0)
        for _ in range(k):
            P, total = A * A * P * R / (C * C * P + R) + Q, 1 + self.scalar("ρ") * total
        self.known |= {"P_k": P, "σ": total, "ρ^k": self.scalar("ρ") ** k}
        self.known["P_k'"] = A * A * P * R / (C * C * P + R) + Q

    def scalar(self, name: str) -> Fraction:
        if name not in self.known:
            atom = self.real.atoms.get(name)
            if atom is None or atom.kind not in ("defined", "reciprocal", "root", "absolute"):
                raise Outside(name)
            of = self.value(atom.of)
            if atom.kind == "reciprocal" and not of:
                raise Outside(name)
            self.known[name] = {"defined": lambda: of, "reciprocal": lambda: 1 / of, "absolute": lambda: abs(of),
                                "root": lambda: root(of)}[atom.kind]()  # fmt: skip
        return self.known[name]

    def value(self, poly: Poly) -> Fraction:
        total = Fraction(0)
        for (m, _), c in poly.terms.items():
            for s in m:
                c = c * self.scalar(s)
            total += c
        return total


def root(x: Fraction) -> Fraction:
    found = Fraction(isqrt(x.numerator), isqrt(x.denominator))
    assert found * found == x
    return found


def points():
    """Plants with a rational T, the degenerate ones among them, and numbers of steps."""
    rng = random.Random(3)

    def some(low: int = -9) -> Fraction:
        return Fraction(rng.randint(low, 9), rng.randint(1, 5))

    for n in range(60):
        A, C, R, P0 = some(), some(), some(1), some(0)
        C = C or UNIT
        v = R * Fraction(rng.randint(1, 9), 5)
        v = v if v != 2 * R else R
        Q = v * (v + 2 * (A * A - 1) * R) / (2 * C * C * (2 * R - v))  # so that T - b = v
        edge = n % 8
        if edge == 1:
            A = Fraction(0)
            Q = some(0)
        elif edge == 2:
            Q = Fraction(0)
        elif edge == 3:
            C, Q = Fraction(0), some(0)
        elif edge == 4:
            A, Q = rng.choice((UNIT, -UNIT)), Fraction(0)
        elif edge == 5:
            P0 = Q = Fraction(0)
        elif edge == 6:
            A, C, Q = rng.choice((UNIT, -UNIT)), Fraction(0), some(0)
        if Q >= 0:
            yield from ((A, C, Q, R, P0, k) for k in rng.sample(range(9), 4))


@pytest.fixture(scope="module")
def about_steps():
    """The steps of the lecture in which a sequence occurs, with their cases, and what may be used at the end."""
    from derive.derivation import learn

    item, found = lecture("scalar"), {}
    reading = item.theory.reading()
    for step in item.steps:
        reading = learn(reading, item.theory, step)
    for step in item.steps:
        if isinstance(step.statement.lhs, Start | Limit | Rate | Definite):
            continue
        poly = value(step.statement.lhs, reading) - value(step.statement.rhs, reading)
        below = reading.real.reached(scalars_of(poly))
        if below & {"k", *reading.real.sequences}:
            cases = {c for c in item.rests_on(step.name) if getattr(item.theory.declared.get(c), "case", False)}
            found[step.name] = step, poly, cases
    return found, reading, item.theory


def test_every_statement_about_a_number_of_steps_holds_exactly(about_steps):
    found, reading, theory = about_steps
    tried = dict.fromkeys(found, 0)
    for point in (Exactly(reading.real, *numbers) for numbers in points()):
        for name, (step, poly, cases) in found.items():
            try:
                if not all(holds(theory.statement(c), point, reading) for c in cases):
                    continue
                x = point.value(poly)
            except Outside:
                continue
            tried[name] += 1
            assert {"=": x == 0, "≥": x >= 0, ">": x > 0}[step.statement.relation], (name, point.known)
    logarithms = {n for n in found if "ln" in n or "log" in n or "settled" in n or "enough" in n or "larger" in n}
    assert {n for n, count in tried.items() if count < 8} - logarithms - {"(η + c) decay > 0_d"} == set()
    assert {"closed form", "P_k >= 0", "explicit recursion", "recursion on the circle", "counting"} <= tried.keys()


def holds(statement: Equation, point: Exactly, reading) -> bool:
    x = point.value(value(statement.lhs, reading) - value(statement.rhs, reading))
    return {"≥": x >= 0, ">": x > 0, "≠": x != 0, "=": x == 0}[statement.relation]


def test_no_hypothesis_is_made_of_the_number_of_steps():
    """What is assumed in the section on the recursion is a case of the plant, or of its start."""
    theory = lecture("scalar").theory
    reading = theory.reading()
    about = {n for n in theory.declared if "k" in reading.real.fixed.get(n, ())}
    assert about <= {"k >= ln(1 + c/η)/(-ln ρ)"}  # the time asked for
    rests = lecture("scalar").rests_on("closed form")
    declared = {n for n in rests if getattr(theory.declared.get(n), "kind", "") == "hypothesis"}
    assert declared == {"P0 >= 0", "Q >= 0", "R > 0"}


# ------------------------------------------------------------------------------------------------ a small theory
class Small(ScalarBuilder):
    """Sequences over one theory, and proofs by induction about them."""

    def __init__(self, prepare: Callable[[Theory], None] = lambda _: None):
        t = Theory("attack", "A theory for one attack")
        t.scalar("k")
        prepare(t)
        super().__init__(t, "attack", "")

    def proves(self, *statement: Term | str, using: tuple[str, ...] = ()) -> Step:
        lhs, relation, rhs = statement
        return self.induct(f"step {len(self.steps)}", Equation(lhs, relation, rhs), "", using)  # type: ignore[arg-type]

    def fails(self, *statement: Term | str, using: tuple[str, ...] = ()) -> None:
        with pytest.raises(NotDerived):
            self.proves(*statement, using=using)


def sequence(t: Theory, name: str, start: Term, following: Callable[[Symbol], Term] | None = None) -> Symbol:
    """Declare x_k, with x_{k+1} defined by it, or free."""
    x, after = t.scalar(name, Glyph(name, sub="k")), t.scalar(name + "'", Glyph(name, sub="k+1"))
    t.sequence(x, start, after)
    if following is not None:
        t.define(name + "'", after, following(x))
    return x


def counting(t: Theory) -> None:
    """x_0 = 0, x_{k+1} = x_k + 1, so that x is k."""
    sequence(t, "x", NONE, lambda x: x + ONE)


def addend(c: Fraction | int, relation: str, *scalars: str) -> Addend:
    return Addend(Fraction(c), tuple(sorted(scalars)), (), relation, False, ())


def forged(b: Small, statement: Equation, start=(), step=(), uses: tuple[str, ...] = (), name: str = "forged") -> Step:
    """A proof of an equation from given addends, whatever they add up to."""
    claim = claim_of(statement, b.reading)
    proof = Proof((Certificate(claim.start, tuple(start)), Certificate(claim.later, tuple(step))))
    starts = tuple(p.name for p in b.reading.real.sequences.values())
    return Step(name, statement, "induction", (), proof, (*uses, *starts), lemma=True)


def last(b: Small, *steps: Step) -> tuple[bool, str]:
    outcome = verify(b.theory, [*b.steps.values(), *steps])[-1]
    return outcome.accepted, outcome.message


# ------------------------------------------------------------------------------------------------ what is proved
def test_what_is_proved():
    b = Small(counting)
    x, k = b.theory.symbols["x"], b.theory.symbols["k"]
    b.proves(k, "≥", ZERO)
    b.proves(x, "=", k, using=("x'",))
    b.proves(x, "≥", ZERO)
    b.proves(x + ONE, "≠", ZERO, using=("step 2",))
    assert all(o.accepted for o in verify(b.theory, list(b.steps.values())))


def test_an_honest_certificate_is_accepted():
    """The forger of this file is able to write true ones."""
    b = Small(counting)
    x, k = b.theory.symbols["x"], b.theory.symbols["k"]
    step = forged(b, Equation(x, "=", k), step=[addend(1, "x'"), addend(1, HYPOTHESIS)], uses=("x'",))
    assert last(b, step) == (True, "")


def test_the_power_of_zero_is_one_at_the_start():
    def powers(t: Theory) -> None:
        rho = t.scalar("ρ")
        sequence(t, "p", ONE, lambda p: rho * p)
        t.assume("ρ = 0", rho, "=", case=True)

    b = Small(powers)
    p, rho = b.theory.symbols["p"], b.theory.symbols["ρ"]
    b.fails(p, "=", ZERO, using=("ρ = 0",))
    b.fails(p, "=", ONE, using=("ρ = 0",))
    assert b.proves(p * p * rho, "=", ZERO, using=("ρ = 0",))
    b.state("at the start", Equation(Start(p, b.theory.symbols["k"]), "=", ONE), "")


# ------------------------------------------------------------------------------------------------ start and step
def test_a_wrong_start():
    b = Small(counting)
    x, k = b.theory.symbols["x"], b.theory.symbols["k"]
    b.fails(x, "=", k + ONE)
    for start in ([], [addend(1, HYPOTHESIS)], [addend(1, "x'")], [addend(1, "forged")]):
        step = [addend(1, "x'"), addend(1, HYPOTHESIS)]
        assert not last(b, forged(b, Equation(x, "=", k + ONE), start, step, ("x'",)))[0]
    b.fails(-ONE - x, "≥", ZERO)


def test_a_sign_that_is_wrong_at_the_start_only():
    """x_0 = -1, x_{k+1} = x_k^2: from then on it is not negative."""
    b = Small(lambda t: sequence(t, "x", Number(-UNIT), lambda x: x * x) and None)
    x = b.theory.symbols["x"]
    b.fails(x, "≥", ZERO)
    claim = claim_of(Equation(x, "≥", ZERO), b.reading)
    honest = Sign(claim.later, "≥", (SignProduct(UNIT, (NEGATION,)), SignProduct(UNIT, (), (claim.now,))), ())
    for terms, products in (((), (SignProduct(UNIT, (NEGATION,)),)), ((), (SignProduct(UNIT, (HYPOTHESIS,)),))):
        wrong = Sign(claim.start, "≥", products, terms)
        proof = Proof(induction=Induction(wrong, honest))
        step = Step("forged", Equation(x, "≥", ZERO), "induction", (), proof, ("x at the start",), lemma=True)
        assert not last(b, step)[0]


def test_a_step_that_needs_the_conclusion():
    b = Small(counting)
    x = b.theory.symbols["x"]
    b.fails(x, "=", ZERO, using=("x'",))
    for relation in ("forged", "claim at k+1", HYPOTHESIS, NEGATION):
        step = [addend(1, "x'"), addend(1, relation)]
        assert not last(b, forged(b, Equation(x, "=", ZERO), (), step, ("x'",)))[0]


def test_a_lemma_by_the_name_of_the_claim():
    """Neither what an induction supposes nor the negation of a claim may be the name of a step."""
    b = Small(counting)
    k = b.theory.symbols["k"]
    for name in (HYPOTHESIS, NEGATION):
        accepted, message = last(b, forged(b, Equation(k, "=", k), name=name))
        assert not accepted
        assert "is taken" in message


def test_the_claim_is_supposed_in_the_step_only():
    b = Small(counting)
    x, k = b.theory.symbols["x"], b.theory.symbols["k"]
    plain = Certificate(value(x - k, b.reading), (addend(1, HYPOTHESIS),))
    for rule in ("scalar", "identity"):
        assert not last(b, Step("forged", Equation(x, "=", k), rule, (), Proof((plain,)), lemma=True))[0]
    claim = value(x, b.reading)
    sign = Sign(claim, "≥", (SignProduct(UNIT, (HYPOTHESIS,)), SignProduct(UNIT, (NEGATION,))), ())
    assert not last(b, Step("forged", Equation(x, "≥", ZERO), "sign", (), Proof(sign=sign), lemma=True))[0]


def test_a_statement_that_supposes_itself():
    """c does not depend on k: the claim at k is the claim at the start."""

    def other(t: Theory) -> None:
        counting(t)
        t.scalar("c")

    b = Small(other)
    c = b.theory.symbols["c"]
    assert not last(b, forged(b, Equation(c, "=", ZERO), [addend(1, HYPOTHESIS)], [addend(1, HYPOTHESIS)]))[0]
    for relation in ("≥", ">"):
        statement = Equation(c, relation, ZERO)
        sign = Sign(
            value(c, b.reading), relation, (SignProduct(UNIT, (HYPOTHESIS,)), SignProduct(UNIT, (NEGATION,))), ()
        )
        proof = Proof(induction=Induction(sign, sign))
        assert not last(b, Step("forged", statement, "induction", (), proof, lemma=True))[0]


def test_a_statement_that_is_true_up_to_some_step():
    b = Small(counting)
    x, five = b.theory.symbols["x"], Number(Fraction(5))
    b.fails(x * (x - ONE) * (x - TWO), "=", ZERO, using=("x'",))
    b.fails(five, "≥", x, using=("x'",))
    b.fails(x - five, "≠", ZERO, using=("x'",))
    b.proves(x, "≥", ZERO)
    b.fails(five, ">", x, using=("x'", "step 0"))


def test_a_statement_that_is_true_two_steps_later():
    """Of x_{k+1} the rule knows its definition only; a claim is not supposed at k + 1."""
    b = Small(lambda t: sequence(t, "x", NONE, lambda x: ONE - x) and None)
    x, after = b.theory.symbols["x"], b.theory.symbols["x'"]
    b.fails(x, "=", ZERO, using=("x'",))
    assert b.proves(after + x, "=", ONE, using=("x'",))


def test_the_parts_of_a_proof():
    b = Small(counting)
    x, k = b.theory.symbols["x"], b.theory.symbols["k"]
    good = forged(b, Equation(x, "=", k), step=[addend(1, "x'"), addend(1, HYPOTHESIS)], uses=("x'",))
    assert last(b, good)[0]
    start, step = good.proof.identities
    for identities in ((start,), (step,), (step, start), (start, step, step), (), (start, replace(step, trace=True))):
        assert not last(b, replace(good, proof=replace(good.proof, identities=identities)))[0]
    assert not last(b, replace(good, rule="scalar"))[0]
    assert not last(b, replace(good, statement=Equation(x, ":=", k)))[0]
    assert not last(b, replace(good, uses=("x'",)))[0]  # the start is not named
    sign = b.proves(x, "≥", ZERO).proof.induction
    assert sign is not None
    assert not last(b, replace(good, proof=replace(good.proof, induction=sign)))[0]


# ------------------------------------------------------------------------------------------------ hypotheses
def free(t: Theory) -> None:
    """x_0 = 0, x_{k+1} a letter, y_0 = 0 and y_{k+1} = y_k + x_k."""
    x = sequence(t, "x", NONE)
    sequence(t, "y", NONE, lambda y: y + x)


def test_a_recursion_holds_for_every_step_and_a_hypothesis_for_one():
    def stays(t: Theory) -> None:
        free(t)
        t.recur("stays", t.symbols["x'"], t.symbols["x"])

    b = Small(stays)
    assert b.proves(b.theory.symbols["x"], "=", ZERO, using=("stays",))

    def case(t: Theory) -> None:
        free(t)
        t.assume("stays", t.symbols["x'"], "=", t.symbols["x"])

    b = Small(case)
    b.fails(b.theory.symbols["x"], "=", ZERO, using=("stays",))


@pytest.mark.parametrize("relation", [">", "≥"])
def test_a_hypothesis_about_a_particular_member(relation):
    """x_k > 0 may be true now and false later."""

    def positive(t: Theory) -> None:
        free(t)
        t.assume("x is positive", t.symbols["x"], relation, case=True)

    b = Small(positive)
    x, y = b.theory.symbols["x"], b.theory.symbols["y"]
    b.fails(y, "≥", ZERO, using=("x is positive",))
    b.sign("through a lemma", Equation(x + ONE, ">", ONE if relation == ">" else ZERO), "", ["x is positive"])
    b.sign("sign", Equation(x, "≥", ZERO), "", ["x is positive"])
    b.fails(y, "≥", ZERO, using=("sign",))


def test_a_hypothesis_about_a_particular_number_of_steps():
    for name, left, right in (("k = 0", ONE, NONE), ("k = -1", ONE, Number(-UNIT)), ("2 k = 1", TWO, ONE)):

        def fixed(t: Theory, name=name, left=left, right=right) -> None:
            counting(t)
            k = t.symbols["k"]
            t.assume(name, left * k, "=", right, case=True)
            excess = left * k - right
            y = sequence(t, "y", NONE)
            t.define("y'", t.symbols["y'"], y + excess)

        b = Small(fixed)
        y = b.theory.symbols["y"]
        b.fails(y, "=", ZERO, using=(name, "y'"))

    def positive(t: Theory) -> None:
        counting(t)
        t.assume("k > 0", t.symbols["k"], ">", case=True)

    b = Small(positive)
    b.fails(b.theory.symbols["k"], "≥", ZERO, using=("k > 0",))
    b.proves(b.theory.symbols["k"], "≥", ZERO)


def test_a_reciprocal_that_exists_for_some_steps_only():
    """x_k - 3 vanishes at the third step; that it does not is a case."""
    three = Number(Fraction(3))

    def quotient(t: Theory) -> None:
        counting(t)
        x = t.symbols["x"]
        t.assume("x ≠ 3", x - three, "≠", case=True)
        t.assume("x' ≠ 3", t.symbols["x'"] - three, "≠", case=True)
        t.atom("reciprocal", x - three, "x ≠ 3", "1/(x-3)")
        t.atom("reciprocal", t.symbols["x'"] - three, "x' ≠ 3", "1/(x'-3)")

    b = Small(quotient)
    x = b.theory.symbols["x"]
    b.fails(Quotient(x - three, x - three), "=", ONE, using=("1/(x-3)", "1/(x'-3)"))
    b.fails(x - three, "≠", ZERO, using=("x'",))
    twice = Equation(Quotient(ONE, Quotient(ONE, x - three)), "=", x - three)  # the difference reads as zero
    with pytest.raises(NotDerived):
        b.induct("twice", twice, "")
    b.state("now", Equation(Quotient(x - three, x - three), "=", ONE), "", ["x ≠ 3"])  # for a k of the case it is true
    b.fails(Quotient(x - three, x - three), "=", ONE, using=("now",))


def test_a_denominator_that_is_positive_for_every_step():
    def quotient(t: Theory) -> None:
        counting(t)
        t.atom("reciprocal", t.symbols["x"] + ONE, "x + 1 > 0", "1/(x+1)")

    b = Small(quotient)
    x = b.theory.symbols["x"]
    with pytest.raises(NotDerived):
        b.state("early", Equation(Quotient(x + ONE, x + ONE), "=", ONE), "")
    b.induct("x + 1 > 0", Equation(x + ONE, ">", ZERO), "")
    b.state("later", Equation(Quotient(x + ONE, x + ONE), "=", ONE), "")


def test_the_reason_of_a_root_counts_as_well():
    """√y is not negative; that it exists is a case, and y ≥ 0 follows from it for that k only."""

    def rooted(t: Theory) -> None:
        y = sequence(t, "y", NONE, lambda y: y - ONE)
        t.assume("y ≥ 0", y, "≥", case=True)
        t.atom("root", y, "y ≥ 0", "√y")
        sequence(t, "z", NONE, lambda z: z + Root(y))

    b = Small(rooted)
    b.fails(b.theory.symbols["z"], "≥", ZERO, using=("√y ≥ 0",))

    def recurring(t: Theory) -> None:
        y = sequence(t, "y", NONE, lambda y: y - ONE)
        t.assume("y ≥ 0", y, "≥", case=True)
        t.atom("root", y, "y ≥ 0", "√y")
        z = sequence(t, "z", NONE)
        t.recur("goes on", t.symbols["z'"], z + Root(y))

    b = Small(recurring)
    with pytest.raises(NotDerived, match="rests on y ≥ 0, which holds k at some value"):
        b.induct("z ≥ 0", Equation(b.theory.symbols["z"], "≥", ZERO), "", ["√y ≥ 0"], identities=["goes on"])


# ------------------------------------------------------------------------------------------------ k and its members
def rejected_theory(prepare: Callable[[Theory], object]) -> None:
    def read() -> None:
        t = Theory("attack", "A theory for one attack")
        t.scalar("k")
        prepare(t)
        t.reading()

    with pytest.raises(Rejected):
        read()


def test_the_number_of_steps_is_nothing_else():
    counted = (
        lambda t: t.parameter("k"),
        lambda t: t.run("k"),
        lambda t: t.define("k", t.symbols["k"], TWO),
        lambda t: t.atom("root", ONE, name="k"),
        lambda t: t.roots("λ", t.symbols["k"], t.scalar("n")),
        lambda t: t.roots("λ", t.scalar("i"), t.symbols["k"]),
    )
    for prepare in counted:
        rejected_theory(lambda t, prepare=prepare: (counting(t), prepare(t)))


def test_a_member_is_nothing_else():
    def twice(t: Theory) -> None:
        sequence(t, "x", NONE)
        t.sequence(t.scalar("y"), ONE, t.symbols["x'"])

    def nested(t: Theory) -> None:
        x = sequence(t, "x", NONE)
        t.sequence(t.symbols["x'"], NONE, t.scalar("x''"))
        t.recur("goes on", t.symbols["x''"], x)

    for prepare in (
        twice,
        nested,
        lambda t: t.sequence(t.symbols["k"], NONE, t.scalar("k'")),
        lambda t: t.sequence(t.scalar("x"), NONE, t.symbols["k"]),
        lambda t: t.sequence(t.scalar("x"), NONE, t.scalar("x", nonnegative=True)),
        lambda t: t.sequence(t.scalar("x", nonnegative=True), NONE, t.scalar("x'")),
        lambda t: t.sequence(t.scalar("x"), NONE, t.scalar("x'", nonnegative=True)),
        lambda t: t.sequence(t.parameter("x"), NONE, t.scalar("x'")),
        lambda t: t.sequence(t.scalar("x"), NONE, t.run("x'")),
        lambda t: (sequence(t, "x", NONE), t.define("x", t.symbols["x"], TWO)),
        lambda t: (sequence(t, "x", NONE), t.atom("absolute", TWO, name="x'")),
    ):
        rejected_theory(prepare)


def test_a_first_member_does_not_depend_on_the_step():
    for prepare in (
        lambda t: sequence(t, "x", t.symbols["k"]),
        lambda t: (sequence(t, "x", NONE), sequence(t, "y", t.symbols["x"])),
        lambda t: (sequence(t, "x", NONE), sequence(t, "y", t.symbols["x'"])),
        lambda t: sequence(t, "x", t.symbols["k"] + ONE),
        lambda t: (t.define("c", t.scalar("c"), t.symbols["k"]), sequence(t, "x", t.symbols["c"])),
        lambda t: sequence(t, "x", t.parameter("a")),
        lambda t: sequence(t, "x", t.run("r")),
        lambda t: sequence(t, "x", t.scalar("s")),
    ):
        rejected_theory(prepare)


def test_a_sequence_depends_on_nothing_that_the_rules_vary():
    """An arbitrary parameter may be replaced, a running one and ω are integrated over, s and j are not real."""
    declared: dict[str, Callable[[Theory, str], Symbol]] = {
        "a": Theory.parameter, "r": Theory.run, "ω": Theory.scalar, "s": Theory.scalar, "j": Theory.scalar,
    }  # fmt: skip
    for name, declare in declared.items():
        rejected_theory(lambda t, f=declare, n=name: grows(t, f(t, n)))
        rejected_theory(lambda t, f=declare, n=name: (free(t), grows_freely(t, f(t, n))))
    rejected_theory(lambda t: (free(t), grows_freely(t, t.scalar("t"))))
    t = Theory("attack", "A theory for one attack")
    t.scalar("k")
    free(t)
    grows_freely(t, t.scalar("c"))
    assert t.reading().adopted


def test_a_sequence_consists_of_real_numbers():
    def determinant(t: Theory) -> None:
        M = t.matrix("M", "n", "n")
        t.complex.add("M")
        t.atom("spectral", Det(M), name="det M")
        sequence(t, "x", ONE, lambda x: Det(M) * x)

    rejected_theory(determinant)


def test_a_sequence_depends_on_its_parameters():
    """x_k = c^k is not constant in c; a free sequence may depend on anything."""
    for prepare in (lambda t, c: grows(t, c), lambda t, c: (sequence(t, "x", ONE), grows_freely(t, c))):
        t = Theory("attack", "A theory for one attack")
        t.scalar("k")
        c = t.scalar("c")
        prepare(t, c)
        reading, x = t.reading(), t.symbols["x"]
        assert reading.real.varies("x", "c")
        for term in (Rate(x, c), Limit(x, c, Infinity()), Start(x, c), Rate(t.symbols["x'"], c)):
            with pytest.raises(Rejected):
                value(term, reading)


def grows(t: Theory, factor: Symbol) -> None:
    sequence(t, "x", ONE, lambda x: factor * x)


def grows_freely(t: Theory, factor: Symbol) -> None:
    t.recur("goes on", t.symbols["x'"], factor * t.symbols["x"])


def test_a_recursion_says_how_a_sequence_goes_on():
    rejected_theory(lambda t: (free(t), t.recur("x = 1", t.symbols["x"], ONE)))
    rejected_theory(lambda t: (counting(t), t.recur("x' = 1", t.symbols["x'"], ONE)))
    rejected_theory(lambda t: (counting(t), t.recur("k = 1", t.symbols["k"], ONE)))


def test_a_letter_that_depends_on_the_step_through_a_function():
    """c is |x|, or x + 1, and not constant; and what stands for x at the next step is declared or not known."""

    def behind(t: Theory) -> None:
        counting(t)
        x = t.symbols["x"]
        t.atom("absolute", x, name="|x|")
        t.define("c", t.scalar("c"), x)
        t.define("d", t.scalar("d"), Abs(x))

    b = Small(behind)
    t = b.theory
    b.fails(t.symbols["c"], "=", ZERO, using=("x'", "c"))
    b.fails(t.symbols["d"], "=", ZERO, using=("x'", "d"))
    b.fails(Abs(t.symbols["x"]), "≥", ZERO, using=("|x| ≥ 0",))  # |x + 1| is not declared
    with pytest.raises(Rejected, match="at the next step is not declared"):
        following(value(t.symbols["d"], b.reading), b.reading.real)


def test_a_free_next_member_is_not_known_at_the_start():
    b = Small(free)
    for statement in (Equation(b.theory.symbols["x'"], "=", ZERO), Equation(b.theory.symbols["x'"], "≥", ZERO)):
        with pytest.raises(Rejected):
            claim_of(statement, b.reading)


def test_limits_and_derivatives_in_the_number_of_steps():
    def quotient(t: Theory) -> None:
        counting(t)
        t.atom("reciprocal", t.symbols["k"] + ONE, "k + 1 > 0", "1/(k+1)")

    b = Small(quotient)
    x, k = b.theory.symbols["x"], b.theory.symbols["k"]
    b.induct("k + 1 > 0", Equation(k + ONE, ">", ZERO), "")
    over = Quotient(ONE, k + ONE)
    for term in (
        Limit(over, k, Infinity()), Limit(x, k, Infinity()), Rate(x, k), Rate(k, k), Rate(k, x), Limit(over, x, ZERO),
        Definite(over, k, ZERO, Infinity()), Rate(over, k),
    ):  # fmt: skip
        with pytest.raises(Rejected):
            value(term, b.reading)
        with pytest.raises(Rejected):
            claim_of(Equation(term, "=", term), b.reading)
    moved = Equation(Start(x, k), "=", ZERO)  # read, but no statement about every k
    with pytest.raises(Rejected, match="sums, products"):
        claim_of(moved, b.reading)


def test_what_is_proved_for_every_step_is_no_lemma_about_others():
    """k is no parameter that may be replaced: not by -1, not by a half, not by another letter."""

    def other(t: Theory) -> None:
        counting(t)
        t.scalar("i")

    b = Small(other)
    k = b.theory.symbols["k"]
    b.proves(k, "≥", ZERO)
    for image in (Number(-UNIT), Number(Fraction(1, 2)), b.theory.symbols["i"], k + ONE):
        step = Step("forged", Equation(image, "≥", ZERO), "instance", (), Proof(links=("step 0",)), lemma=True)
        assert not last(b, step)[0]


def test_a_theory_without_sequences_has_no_induction():
    t = Theory("attack", "A theory for one attack")
    k = t.scalar("k")
    zero = Certificate(Poly({}, ANY, ANY))
    step = Step("forged", Equation(k, "=", k), "induction", (), Proof((zero, zero)), lemma=True)
    assert not verify(t, [step])[-1].accepted


def test_logarithms_one_step_later_are_declared():
    def powers(t: Theory) -> None:
        p = sequence(t, "p", ONE, lambda p: TWO * p)
        t.atom("log", p, "p > 0", "ln p")
        t.atom("log", TWO, "2 > 0", "ln 2")
        t.atom("log", ONE, "1 > 0", "ln 1")

    b = Small(powers)
    p, k = b.theory.symbols["p"], b.theory.symbols["k"]
    b.induct("p > 0", Equation(p, ">", ZERO), "")
    for name, x in (("2 > 0", TWO), ("1 > 0", ONE)):
        b.sign(name, Equation(x, ">", ZERO), "", [])
    b.fails(Log(p), "=", k * Log(TWO), using=("p'",))


def test_the_exponent_of_a_power_is_a_number():
    with pytest.raises(Rejected):
        value(Power(TWO, -1), Small(counting).reading)


# ------------------------------------------------------------------------------------------------ files
@pytest.fixture(scope="module")
def file(about_steps):
    """The inductions of the lecture as a file, and what they rest on."""
    item, real = lecture("scalar"), about_steps[1].real
    steps = {step.name: step for step in item.steps}
    needed, waiting = set[str](), [s.name for s in item.steps if s.rule == "induction"]
    while waiting:
        name = waiting.pop()
        if name in steps and name not in needed:
            needed.add(name)
            read = [value(side, about_steps[1]) for side in (steps[name].statement.lhs, steps[name].statement.rhs)]
            atoms = real.reached(s for poly in read for s in scalars_of(poly)) | set(steps[name].uses)
            waiting += [
                *steps[name].uses,
                *steps[name].proof.links,
                *(r for a in atoms for r in real.reasons.get(a, ())),
            ]
    data = json.loads(json.dumps(lecture_to_json(item)))
    return {**data, "steps": [s for s in data["steps"] if s["name"] in needed], "errata": []}


def rejected_steps(data) -> list[str]:
    return [o.step for o in verify_data(data, "file").outcomes if not o.accepted and o.step != "symbols"]


def changed(file, name: str, change: Callable[[dict], object]) -> list[str]:
    data = {**file, "steps": [deepcopy(s) if s["name"] == name else s for s in file["steps"]]}
    change(next(s for s in data["steps"] if s["name"] == name))
    return rejected_steps(data)


def test_a_file_with_inductions_replays(file):
    assert rejected_steps(file) == []
    assert sum(s["rule"] == "induction" for s in file["steps"]) >= 9
    assert len(file["steps"]) < 100


@pytest.mark.parametrize("name", ["closed form, multiplied out", "the power as a sum", "counting", "ln ρ^k = k ln ρ"])
def test_a_tampered_induction_of_an_equation_is_rejected(file, name):
    def other_coefficient(part: int) -> Callable[[dict], object]:
        return lambda s: s["certificates"][part]["terms"][0].update(coefficient="7")

    for change in (
        *(other_coefficient(part) for part in (0, 1) if next(s for s in file["steps"] if s["name"] == name)
          ["certificates"][part]["terms"]),
        lambda s: s["certificates"].reverse(),
        lambda s: s["certificates"].pop(),
        lambda s: s.update(rule="scalar"),
        lambda s: s.update(uses=[u for u in s["uses"] if "start" not in u]),
        lambda s: s["certificates"][1].update(terms=[]),
    ):  # fmt: skip
        assert changed(file, name, change)[:1] == [name]


@pytest.mark.parametrize("name", ["d > 0", "ρ^k >= 0", "σ >= 0", "ρ^k > 0", "k >= 0"])
def test_a_tampered_induction_of_a_sign_is_rejected(file, name):
    def swap(s) -> None:
        parts = s["certificates"][0]
        parts["start"], parts["step"] = parts["step"], parts["start"]

    for change in (
        swap,
        lambda s: s["certificates"][0]["step"]["products"][0].update(coefficient="-3"),
        lambda s: s["certificates"][0]["start"].update(products=[]),
        lambda s: s["certificates"][0]["step"].update(products=[]),
        lambda s: s.update(rule="sign"),
    ):
        assert changed(file, name, change)[:1] == [name]


def test_a_certificate_on_file_is_of_bounded_size():
    small = Sign(Poly({}, ANY, ANY), "≥", (), ())
    large = replace(small, products=(SignProduct(UNIT, ("k >= 0",) * 2_000),))
    check_work(Proof(induction=Induction(small, small)))
    for signs in (Induction(small, large), Induction(large, small)):
        with pytest.raises(InputError, match="factors"):
            check_work(Proof(induction=signs))


def test_a_file_cannot_name_what_is_supposed(file):
    def rename(s) -> None:
        s["name"] = HYPOTHESIS

    assert HYPOTHESIS in changed(file, "ρ^k >= 0", rename)
