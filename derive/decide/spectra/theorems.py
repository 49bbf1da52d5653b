"""Claims about integrals, limits and sums over eigenvalues, by the theorems of the lecture ``spectrum``.

With T = tr(C P C'V^-1), S = sum max(0, Re λ_i(A)) and L(s) = C (sI - A)^-1 K, for the stabilising or strong P:

    theorem 1           (1/2 pi) int ln(det Phi_y / det V) dω = T - 2 S
    Bode integral       (1/2 pi) int ln |det(I + L(jω))| dω = T/2 - S
    limits              lim s ln |det(I + L(s))| = lim s tr L(s) = T,   lim s ln(det Phi_y(s) / det V) = 0
    zeros and poles     of det(I + L)^-1: sum max(0, Re φ) = S, sum max(0, Re η) = 0; of det(Phi_y V^-1):
                        sum max(0, Re φ) - sum max(0, Re η) = T - 2 S, sum max(0, Re η) <= sum |Re λ_i(A)|
    propositions 1, 2   (1/2 pi) int ln |f(jω)| dω = lim s ln |f(s)| / 2 + sum max(0, Re φ) - sum max(0, Re η)

A claim is read as a polynomial in such quantities; the argument of a logarithm is recognised by a proved identity
between matrices, M V = Phi_y or M = I + L, and a trace by a proved equality of traces. What is left has to vanish, or
to be one of the quantities that are known not to be negative. Zeros and poles that cancel do so in equal numbers, and
those of I + L have real parts <= 0, so that the sums do not depend on cancellations.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from fractions import Fraction

from derive.analysis import put
from derive.decide.spectra.form import Form, NoForm
from derive.decide.spectra.quantities import COST, POLES, TRACE, UNSTABLE, Quantities
from derive.functions import Definite, Infinity, Limit, Log, Max, Quotient  # fmt: skip
from derive.interpret.statement import Statement
from derive.spectral import RealPart, Total
from derive.terms import Equation, Number, Product, Sum, Symbol, Term, Zero, walk  # fmt: skip

__all__ = ["STEPS", "Proved", "prove_by_theorems"]

LETTERS = {TRACE: "A", "A": "A", "C": "C", "V": "V", "W": "W", "P": "P", UNSTABLE: ""}  # of a scalar plant
STEPS = "spectrum"  # the lecture whose steps are named


@dataclass(frozen=True)
class Proved:
    """The theorems by which a claim is proved, and the assumptions that are used."""

    theorems: tuple[str, ...]


def prove_by_theorems(statement: Statement) -> Proved | None:
    """Return by which theorems a statement holds, or None if they do not show it."""
    if statement.theory.key != "kalman-bucy":
        return None
    try:
        reduction = Reduction(statement)
        for equation in statement.equations:
            if not reduction.shows(equation):
                return None
    except NoForm:
        return None
    return Proved(tuple(dict.fromkeys(reduction.used)))


class Reduction(Quantities):
    """Show the relations of one statement."""

    def shows(self, equation: Equation) -> bool:
        """Tell whether the theorems show an equation or inequality."""
        if any(isinstance(n, Limit) and n.symbol.name == "t" for t in (equation.lhs, equation.rhs) for n in walk(t)):
            return self._in_the_limit(equation)
        if self._is_matrix_equation(equation):
            return self._proves_scalar(equation) if self.statement.scalar else self.proves(equation)
        gap = self.form(equation.lhs)
        if not (isinstance(equation.rhs, Zero) and not equation.rhs.rows):
            gap = gap - self.form(equation.rhs)
        gap = self._given(gap)
        if self.statement.scalar and not gap.is_zero and gap.names <= LETTERS.keys():
            return self._proves_scalar(Equation(self._term(gap), equation.relation, Number(Fraction(0))))
        if gap.is_zero:
            return equation.relation in ("=", ":=", "≥")
        if equation.relation != "≥":
            return False
        for name, known in self._nonnegative():
            if any((gap - known * factor).is_zero for factor in self._factors(gap, known)):
                self.used += [name] * bool(name)
                return True
        return False

    def _term(self, form: Form) -> Term:
        """Return a form in the letters of a scalar plant."""
        s = self.statement.theory.theory.symbols
        addends: list[Term] = []
        for key, c in form.terms.items():
            letters = [
                Max(s["A"]) if name == UNSTABLE else s[LETTERS[name]] for name, power in key for _ in range(power)
            ]
            below = [s[LETTERS[name]] for name, power in key for _ in range(-power)]
            top = Product((Number(c), *letters))
            addends.append(Quotient(top, Product(tuple(below))) if below else top)
        return Sum(tuple(addends))

    def _in_the_limit(self, equation: Equation) -> bool:
        """Show lim x(t) = y, t to infinity, for x(t) = y with P(t), K(t) in the place of P, K: these tend to them."""
        ends = {n.point for t in (equation.lhs, equation.rhs) for n in walk(t) if isinstance(n, Limit)}
        if ends != {Infinity()} or equation.relation not in ("=", ":="):
            return False
        s = self.statement.theory.theory.symbols
        sides = [x.body if isinstance(x, Limit) else x for x in (equation.lhs, equation.rhs)]
        limits = [isinstance(x, Limit) for x in (equation.lhs, equation.rhs)]
        if sum(limits) != 1 or any(isinstance(n, Limit) for x in sides for n in walk(x)) or "P(t)" not in s:
            return False
        moving: dict[Term, Term] = {s[k]: s[f"{k}(t)"] for k in "PK" if k in s and f"{k}(t)" in s}
        if "Sigma" in s and "P" in s:
            moving[s["Sigma"]] = s["C"] * s["P(t)"] * s["C"].T
        at_t, fixed = sides if limits[0] else sides[::-1]
        if any(isinstance(n, Symbol) and n in moving for n in walk(at_t)):
            return False
        return self.proves(Equation(at_t, "=", put(fixed, moving)))

    def _proves_scalar(self, equation: Equation) -> bool:
        from derive.claim import Verdict
        from derive.scalar.decision import decide_scalar

        return decide_scalar(replace(self.statement, equations=(equation,)), seconds=2.0).verdict is Verdict.proved

    def _is_matrix_equation(self, equation: Equation) -> bool:
        sides = equation.lhs, equation.rhs
        analytic = any(isinstance(n, Definite | Limit | Total | Log | RealPart) for t in sides for n in walk(t))
        return not analytic and not any(self.is_eigenvalue(n) for t in sides for n in walk(t))

    def _given(self, form: Form) -> Form:
        """Use what is assumed: eigenvalues in the left half plane, no process noise, f known by its determinant."""
        if self.statement.scalar:
            form = form.replaced(COST, Form.of("C", 2) * Form.of("P") * Form.of("V", -1))
            for c in self.statement.theory.conditions:
                if c.relation == "=" and isinstance(c.lhs, Symbol) and c.lhs.name == "V" and isinstance(c.rhs, Number):
                    form = _valued(form, "V", c.rhs.value)
        if self.stable("λ"):
            form = form.replaced(UNSTABLE, Form({}))
        if COST in form.names and self._quiet():
            form = form.replaced(COST, Form.of(UNSTABLE) + Form.of(UNSTABLE))
            self.used.append("cost without process noise")
        return form

    def _quiet(self) -> bool:
        W = self.symbol("W")
        return not self.statement.scalar and self.proves(Equation(W, "=", Zero(W.rows, W.cols)))

    def _nonnegative(self) -> Iterator[tuple[str, Form]]:
        """Iterate over forms that are known not to be negative, with the step that says so."""
        T, S, A = Form.of(COST), Form.of(UNSTABLE), Form.of(TRACE)
        size = S + S - A
        yield from (("", T), ("", S), ("", size), ("", Form.of("tr P")))
        if self.function() == "spectrum":
            yield "bound on the poles", size - Form.of(POLES)
        yield "upper bound", Form.of("λmax") * Form.of("tr P") - T
        yield "lower bound", T - Form.of("λmin") * Form.of("tr P")

    def _factors(self, gap: Form, known: Form) -> Iterator[Form]:
        """Iterate over positive factors by which a form may differ from a known one."""
        units = [Form.number(1), *(Form.of(name, -1) for name in ("λmax", "λmin") if name in self.nonzero)]
        first = next(iter(known.terms.items()))
        for unit in units:
            (key,) = (Form({first[0]: Fraction(1)}) * unit).terms
            ratio = gap.terms.get(key, Fraction(0)) / first[1]
            if ratio > 0:
                yield unit * Form.number(ratio)


def _valued(form: Form, name: str, number: Fraction) -> Form:
    """Put a number that is not zero in the place of a quantity."""
    total = Form({})
    for key, c in form.terms.items():
        powers = dict(key)
        total += Form(
            {tuple(sorted((n, p) for n, p in powers.items() if n != name)): c * number ** powers.get(name, 0)}
        )
    return total
