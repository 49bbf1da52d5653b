"""Decide claims of the frequency domain: at exact plants, by the theorems of the lecture, or by enclosures alone."""

from __future__ import annotations

import time
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import cache
from itertools import islice
from typing import Any

from flint import ctx

from derive.claim import Answer, Counterexample, Entries, Nearest, Verdict
from derive.decide.spectra.evaluate import Place, value
from derive.decide.spectra.numbers import NoValue
from derive.decide.spectra.places import decided, places, speaks_of_known_functions
from derive.decide.spectra.ratio import Fractional, Undefined
from derive.decide.spectra.theorems import STEPS, prove_by_theorems
from derive.functions import Definite
from derive.interpret.statement import Statement
from derive.kernel import Rejected
from derive.latex import latex
from derive.scalar.example import NumberExample
from derive.terms import Equation, Neg, Number, Product, Sum, Symbol, Term, Zero, walk

__all__ = ["RULE", "certificate", "decide_spectra", "replay_theorems"]

RULE = "theorems"

BITS = 160
MOST, ENOUGH = 80, 5  # plants that are tried; plants at which all is enclosed before a claim counts as supported
DIGITS = 12
SHOWN = ("A", "C", "W", "V", "B", "P")
FACTORS = (Fraction(2), Fraction(1, 2), Fraction(-1))
UNKNOWN_FUNCTION = (
    r"what f is, whose zeros and poles it speaks of, is not given: assume f(s) = \det[\Phi_y(s) V^{-1}], for example, "
    r"or f(s) = \frac{p(s)}{q(s)} for any"
)
EDITS = {Fraction(2): "a factor 2", Fraction(1, 2): "a factor 1/2", Fraction(-1): "the sign"}
ONE_SIDED = (
    "The spectrum is two-sided: the integral runs over all frequencies, with the factor 1/(2π); over positive "
    "frequencies alone it is half as large."
)


@dataclass(frozen=True)
class Trial:
    """What the plants say: where a claim fails and why, at how many plants it holds as far as balls tell."""

    failure: tuple[Place, Equation, str] | None
    enclosed: int
    tried: int


def decide_spectra(statement: Statement, seconds: float = 10.0) -> Answer:
    """Decide a statement with integrals over frequency, determinants, eigenvalues or limits.

    Returns:
        refuted with an exact plant at which balls keep the sides apart, or where a side has no value; proved by the
        theorems of the lecture ``spectrum``; supported by the plants at which both sides are enclosed; or undecided.
    """
    before, ctx.prec = ctx.prec, BITS
    try:
        return _decide(statement, time.monotonic() + seconds)
    finally:
        ctx.prec = before


def _decide(statement: Statement, deadline: float) -> Answer:
    if not speaks_of_known_functions(statement):
        return _undecided(statement, UNKNOWN_FUNCTION)
    trial = tried(statement, deadline)
    if trial.failure is not None:
        return _refuted(statement, trial.failure, deadline)
    if not trial.tried:
        return _undecided(statement, "no plant was found that satisfies what is assumed")
    proved = prove_by_theorems(statement)
    if proved is not None:
        return Answer(
            Verdict.proved,
            f"theorem of {STEPS}",
            proved.theorems,
            assumed=statement.assumed,
            certificate=certificate(statement, proved.theorems),
        )
    if trial.enclosed >= ENOUGH:
        note = f"both sides agree in balls at {trial.enclosed} plants with exact numbers; no proof was found"
        return Answer(Verdict.supported, "enclosures", assumed=statement.assumed, notes=(note,))
    return _undecided(statement, "no theorem shows it, and its sides are evaluated at too few plants")


def _undecided(statement: Statement, note: str) -> Answer:
    return Answer(Verdict.undecided, assumed=statement.assumed, notes=(note,))


def tried(statement: Statement, deadline: float) -> Trial:
    """Evaluate a statement at plants that satisfy its hypotheses, the smallest first.

    A strict inequality whose sides balls do not keep apart at some plant counts as enclosed at none.
    """
    enclosed = count = 0
    equal = False
    for place in islice(places(statement), MOST):
        if time.monotonic() > deadline:
            break
        count += 1
        outcomes: list[bool | None] = []
        for equation in statement.equations:
            try:
                outcome = decided(equation, place)
            except Undefined as error:
                return Trial((place, equation, str(error)), enclosed, count)
            except (NoValue, ValueError, OverflowError):
                break
            if outcome is False:
                return Trial((place, equation, ""), enclosed, count)
            outcomes.append(outcome)
            equal |= outcome is None and equation.relation in (">", "≻")
        enclosed += len(outcomes) == len(statement.equations)
    return Trial(None, 0 if equal else enclosed, count)


# ------------------------------------------------------------------------------------------------ refutation
def _refuted(statement: Statement, failure: tuple[Place, Equation, str], deadline: float) -> Answer:
    place, equation, reason = failure
    example = _example(place, equation, reason)
    found, note = next(_repaired(statement, equation, deadline), (None, "")) if not reason else (None, "")
    index = statement.equations.index(equation)
    notes = (
        *([f"its relation number {index + 1} fails"] if len(statement.equations) > 1 else []),
        *filter(None, [note]),
    )
    return Answer(
        Verdict.refuted,
        "undefined" if reason else "exact instance",
        assumed=statement.assumed,
        counterexample=example,
        nearest=found,
        notes=notes,
    )


def _example(place: Place, equation: Equation, reason: str) -> Counterexample:
    letters = {k: _entries(m) for k, m in place.letters.items() if k in SHOWN}
    also = {f"{k}(s)": _written(f) for k, f in place.functions.items() if k == "f"}
    also |= {k: str(x.number()) for k, x in place.numbers.items() if k in ("σ0", "ω0") and isinstance(x, Fractional)}
    sides = (f"undefined: {reason}", "") if reason else (_side(equation.lhs, place), _side(equation.rhs, place))
    zero = ((Fraction(0),),)
    return NumberExample(dict(place.sizes), letters, zero, zero, equation.relation, also=also, sides=sides)


def _entries(matrix: Any) -> Entries:
    rows, cols = matrix.nrows(), matrix.ncols()
    return tuple(tuple(Fraction(int(matrix[i, j].p), int(matrix[i, j].q)) for j in range(cols)) for i in range(rows))


def _written(f: Fractional) -> str:
    return f"({f.re.str(var='s') if hasattr(f.re, 'str') else f.re})/({f.den})".replace("x", "s")


def _side(term: Term, place: Place) -> str:
    """Return a side in digits, with its exact value where that is a number."""
    if isinstance(term, Zero):
        return "0"
    found = value(term, place)
    rows = found if isinstance(found, list) else [[found]]
    texts = [[_number(x) for x in row] for row in rows]
    return texts[0][0] if len(texts) == len(texts[0]) == 1 else str(texts).replace("'", "")


def _number(x: Any) -> str:
    if isinstance(x, Fractional):
        number = x.number()
        return str(number) if number is not None else _written(x)
    return str(x.str(DIGITS, radius=False))


def _repaired(statement: Statement, failed: Equation, deadline: float) -> Iterator[tuple[Nearest, str]]:
    """Iterate over true formulas that differ by a factor or a sign of one addend, with what explains the slip."""
    for side in ("rhs", "lhs"):
        term: Term = getattr(failed, side)
        addends = term.addends if isinstance(term, Sum) else (term,)
        for i, addend in enumerate(addends):
            for factor in FACTORS:
                changed = Sum((*addends[:i], _scaled(addend, factor), *addends[i + 1 :])) if len(addends) > 1 else None
                repaired = replace(failed, **{side: changed or _scaled(addend, factor)})
                equations = tuple(repaired if e is failed else e for e in statement.equations)
                trial = replace(statement, equations=equations)
                if time.monotonic() < deadline and tried(trial, deadline).failure is None and prove_by_theorems(trial):
                    formula = ", \\quad ".join(map(latex, equations))
                    note = ONE_SIDED if factor > 0 and any(isinstance(n, Definite) for n in walk(addend)) else ""
                    yield Nearest(formula, f"{EDITS[factor]} of one term"), note


def _scaled(term: Term, factor: Fraction) -> Term:
    if factor == -1:
        return term.body if isinstance(term, Neg) else Neg(term)
    if isinstance(term, Neg):
        return Neg(_scaled(term.body, factor))
    factors = term.factors if isinstance(term, Product) else (term,)
    return Product((Number(factor), *factors))


# ------------------------------------------------------------------------------------------------ certificates
def certificate(statement: Statement, theorems: Sequence[str]) -> dict[str, object]:
    """Return the certificate of a statement: the steps of the lecture that show it, without its text."""
    letters = {n.name for e in statement.equations for t in (e.lhs, e.rhs) for n in walk(t) if isinstance(n, Symbol)}
    return {
        "schema": "derive-certificate/1",
        "theory": statement.theory.key,
        "latex": "",
        "assume": [],
        "scalar": statement.scalar,
        "symbols": sorted(letters),
        "relations": sorted(theorems),
        "rule": RULE,
        "lecture": STEPS,
    }


def replay_theorems(data: Mapping[str, object], statement: Statement) -> None:
    """Replay a certificate: the claim is reduced to the theorems again, and their steps are replayed.

    Raises:
        Rejected: the theorems do not show the claim, or the certificate shows something else than its own.
    """
    found = prove_by_theorems(statement)
    if found is None or not any(True for _ in places(statement)):
        raise Rejected("the theorems of the lecture do not show the claim")
    again = {**certificate(statement, found.theorems), "latex": data.get("latex"), "assume": data.get("assume")}
    wrong = sorted(key for key in {*again, *data} if again.get(key) != data.get(key))
    if wrong:
        raise Rejected(f"the file shows another {wrong[0]} than its own")
    missing = sorted(set(found.theorems) - accepted_steps())
    if missing:
        raise Rejected(f"{missing[0]} is no accepted step of the lecture {STEPS}")


@cache
def accepted_steps() -> frozenset[str]:
    """Return the steps of the lecture that replay."""
    from derive.theory import lecture

    return frozenset(outcome.step for outcome in lecture(STEPS).verify() if outcome.accepted)
