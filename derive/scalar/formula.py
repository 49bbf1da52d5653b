"""Closed forms with their proof: both sides, where they are defined, what they rest on, and exports that agree.

A formula is a proved step of the scalar lecture together with a program that evaluates its right-hand side without
cancellation. Each branch of the program is the side of a proved step; ``check`` reads both and compares.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from fractions import Fraction
from functools import cache, partial
from typing import Any

from derive.derivation import Lecture, Step
from derive.errors import InputError
from derive.functions import Definite, Exp, Limit, Log, Rate, Start, put, value
from derive.kernel import Rejected
from derive.scalar.program import Program
from derive.terms import Equation, Number, Product, Reading, Symbol, Term

__all__ = ["Formula", "Sequence", "behind", "learned"]

ONE = Number(Fraction(1))


@dataclass(frozen=True)
class Sequence:
    """A power exp(k ln x) of x after k steps that stands for a letter: the sequence that starts at one, times x a step.

    Attributes:
        expression: exp(k ln x).
        letter: what it stands for in the lecture.
        start: the definition that says that the letter is one at the start.
        following: the definition that says that it is x times as much next.
    """

    expression: Term
    letter: Symbol
    start: str
    following: str

    def ends(self, following: Term) -> tuple[Equation, Equation]:
        """Return what the two steps have to say; ``following`` is the next letter."""
        match self.expression:
            case Exp(Product((Symbol(name="k"), Log(base)))):
                first = Start(self.letter, Symbol("k", scalar=True))
                return Equation(first, "=", ONE), Equation(following, "=", base * self.letter)
            case _:
                raise InputError("a sequence is a power exp(k ln x)")


@dataclass(frozen=True)
class Formula:
    """A proved closed form.

    Attributes:
        name: what it is called in Python.
        statement: both sides.
        defined: where it is defined.
        step: the step of the lecture that proves the statement.
        roles: steps that say what the value is (root of the equation, sign, closed loop).
        program: how it is evaluated.
        lecture: the lecture that holds the steps.
        source: document and number, if a source has it.
    """

    name: str
    statement: Equation
    defined: str
    step: str
    roles: tuple[str, ...]
    program: Program
    lecture: Callable[[], Lecture]
    source: str = ""
    sequences: tuple[Sequence, ...] = ()

    @property
    def derivation(self) -> tuple[Step, ...]:
        """The steps that prove the formula, its branches and what they mean, with certificates."""
        names = dict.fromkeys((self.step, *self.roles, *(b.step for b in self.program.branches)))
        lecture = self.lecture()
        return tuple(lecture.step(name) for name in names if name in {s.name for s in lecture.steps})

    @property
    def hypotheses(self) -> tuple[str, ...]:
        """The definitions, hypotheses and cases that the derivation rests on."""
        lecture = self.lecture()
        return tuple(sorted(frozenset().union(*(lecture.rests_on(s.name) for s in self.derivation))))

    @property
    def sympy(self) -> Any:
        """The statement as a SymPy equation of real symbols."""
        import sympy

        return sympy.Eq(real_expression(self.statement.lhs), real_expression(self.statement.rhs), evaluate=False)

    def latex(self) -> str:
        """Return the statement as LaTeX."""
        from derive.latex import latex

        return latex(self.statement)

    def _repr_latex_(self) -> str:
        return f"${self.latex()}$"

    def to_numpy(self) -> Callable[..., Any]:
        """Return a function of arrays; NaN where the formula is not defined."""
        return self.program.to_numpy()

    def to_casadi(self) -> Any:
        """Return a CasADi function."""
        return self.program.to_casadi()

    def to_c(self) -> str:
        """Return C source text."""
        return self.program.to_c()

    def to_javascript(self) -> str:
        """Return JavaScript source text."""
        return self.program.to_javascript()

    def check(self, known: Known | None = None) -> None:
        """Compare every branch of the program with the side of the step that proves it.

        Args:
            known: what a replay accepted, from ``behind``; None replays the whole lecture.

        Raises:
            InputError: a step is not accepted, or a branch computes something else than its step says.
        """
        lecture = self.lecture()
        reading, accepted = known or learned(lecture.key)
        lost = [s.name for s in self.derivation if s.name not in accepted]
        if lost:
            raise InputError(f"{self.name}: the step {lost[0]!r} is rejected")
        for let in self.program.lets:
            if not _same(let.body, let.symbol, reading):
                raise InputError(f"{self.name}: {let.symbol.name} is not what the step that defines it says")
        for sequence in self.sequences:
            self._check_sequence(sequence, reading)
        for branch in self.program.branches:
            step, body = lecture.step(branch.step).statement, self.with_letters(branch.body)
            if not any(_same(body, side, reading) for side in (step.rhs, step.lhs)):
                raise InputError(f"{self.name}: a branch is not what the step {branch.step!r} proves")

    def with_letters(self, term: Term) -> Term:
        """Write letters for the sequences in a term."""
        for sequence in self.sequences:
            term = put(term, {sequence.expression: sequence.letter})
        return term

    def _check_sequence(self, sequence: Sequence, reading: Reading) -> None:
        said = [self.lecture().theory.statement(name) for name in (sequence.start, sequence.following)]
        for wanted, found in zip(sequence.ends(said[1].lhs), said, strict=True):
            sides = zip((wanted.lhs, wanted.rhs), (found.lhs, found.rhs), strict=True)
            if not all(_same(one, two, reading) for one, two in sides):
                raise InputError(f"{self.name}: {sequence.letter.name} is not the sequence that the program computes")


Known = tuple[Reading, frozenset[str]]  # what may be used, and the steps that were accepted


@cache
def learned(key: str) -> Known:
    """Return what may be used at the end of a lecture, and the steps that were replayed and accepted."""
    from derive.theory import lecture

    current = lecture(key)
    accepted = frozenset(o.step for o in current.verify() if o.accepted)
    return _after(current, accepted), accepted


def behind(formulas: Iterable[Formula], accepted: frozenset[str]) -> Known:
    """Return what may be used after those steps behind some formulas of a lecture that a replay accepted."""
    formulas = list(formulas)
    lecture = formulas[0].lecture()
    steps = {step.name: step for step in lecture.steps}
    needed, open_ = set[str](), [step.name for formula in formulas for step in formula.derivation]
    while open_:
        name = open_.pop()
        if name not in needed:
            needed.add(name)
            because = getattr(lecture.theory.declared.get(name), "because", ())
            open_ += [because] if isinstance(because, str) else because
            open_ += (*steps[name].uses, *steps[name].proof.links) if name in steps else ()
    return _after(lecture, accepted & needed), accepted


def _after(lecture: Lecture, names: frozenset[str]) -> Reading:
    """Return what may be used after some steps of a lecture."""
    from derive.derivation import learn

    reading = lecture.theory.reading()
    for step in lecture.steps:
        if step.name in names:
            reading = learn(reading, lecture.theory, step)
    return reading


def _same(one: Term, two: Term, reading: Reading) -> bool:
    """Tell whether two terms are the same number, definitions unfolded."""
    from derive.scalar.search import closure, prove_identity

    try:
        claim = value(one, reading) - value(two, reading)
    except Rejected:
        return False
    relations = closure([claim], reading.real, reading.context.relations)
    return not claim.terms or prove_identity(claim, relations, list(reading.real.atoms), 2.0) is not None


def real_expression(term: Term, other: Callable[[Term], Any] | None = None) -> Any:
    """Return a term about scalars as a SymPy expression of real symbols; ``other`` gives terms of other kinds."""
    import sympy

    from derive import functions as f
    from derive import terms as t

    whole: Callable[[Term], Any] = partial(real_expression, other=other)
    simple: Mapping[type[Term], Callable[..., Any]] = {
        t.Sum: lambda *a: sympy.Add(*a), t.Product: lambda *a: sympy.Mul(*a), t.Neg: lambda a: -a,
        f.Quotient: lambda a, b: a / b, f.Root: sympy.sqrt, f.Abs: sympy.Abs, f.Max: lambda a: sympy.Max(0, a),
        f.Exp: sympy.exp, f.Log: sympy.log, f.Arctan: sympy.atan, f.Infinity: lambda: sympy.oo,
    }  # fmt: skip
    match term:
        case t.Symbol(name="π"):
            return sympy.pi
        case t.Symbol():
            return sympy.Symbol(term.name, real=True)
        case t.Number(number):
            return sympy.Rational(number.numerator, number.denominator)
        case t.Zero():
            return sympy.S.Zero
        case f.Power(base, exponent):
            return whole(base) ** exponent
        case Definite(body, symbol, lower, upper):
            return sympy.Integral(whole(body), (whole(symbol), whole(lower), whole(upper)))
        case Limit(body, symbol, point):
            return sympy.Limit(whole(body), whole(symbol), whole(point))
        case f.Start(body, symbol):
            return sympy.Subs(whole(body), whole(symbol), 0)
        case Rate(body, symbol):
            return sympy.Derivative(whole(body), whole(symbol))
        case _ if type(term) in simple:
            return simple[type(term)](*map(whole, term.children()))
        case _ if other is not None:
            return other(term)
        case _:
            raise InputError(f"{type(term).__name__}: expected a term about real numbers")
