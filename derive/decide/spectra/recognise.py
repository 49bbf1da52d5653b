"""What stands in a logarithm or a trace: recognised by proved identities between matrices."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from fractions import Fraction
from itertools import islice

from derive.decide.spectra.form import NoForm
from derive.functions import Abs, Power, Quotient  # fmt: skip
from derive.interpret.shapes import rebuilt
from derive.interpret.statement import Statement
from derive.spectral import Det, Modulus
from derive.terms import (
    Equation,
    Identity,
    Inverse,
    Neg,
    Number,
    Product,
    Sum,
    Symbol,
    Term,
    Trace,
    Transpose,
    walk,
)  # fmt: skip
from derive.theory.claims.base import ClaimTheory
from derive.theory.claims.base import copy as copied

__all__ = ["Recogniser", "bare"]

PROOF = 1.0  # seconds for an identity between matrices
PLACES = 12  # plants at which an identity is tried first


@dataclass
class Recogniser:
    """Compare matrices of one statement with those that the theorems speak of."""

    statement: Statement
    used: list[str] = field(default_factory=list[str])
    matrices: Statement = field(init=False)

    def __post_init__(self) -> None:
        self.matrices = replace(self.statement, theory=_of_matrices(self.statement.theory))

    def symbol(self, name: str) -> Symbol:
        """Return a letter of the theory."""
        return self.statement.theory.theory.symbols[name]

    def proves(self, equation: Equation) -> bool:
        """Tell whether an equation between matrices or traces has a certificate."""
        from derive.decide.matrix import prove_statement

        return self.plausible(equation) and prove_statement(replace(self.matrices, equations=(equation,)), PROOF)

    def plausible(self, equation: Equation) -> bool:
        """Tell whether an equation holds at the first plants that satisfy the assumptions."""
        from derive.decide.spectra.numbers import NoValue
        from derive.decide.spectra.places import decided, places
        from derive.decide.spectra.ratio import Undefined

        try:
            return all(decided(equation, place) is not False for place in islice(places(self.statement), PLACES))
        except (NoValue, Undefined, ValueError):
            return True

    def same_trace(self, one: Term, other: Term) -> bool:
        """Tell whether two matrices have the same trace."""
        return one == other or self.proves(Equation(Trace(one), "=", Trace(other)))

    def recognised_as(self, body: Term) -> tuple[str, int]:
        """Return what the argument of a logarithm is: "spectrum" det(Phi_y V^-1), or "loop" |det(I + L)|.

        The number is its power, +1 or -1.
        """
        from derive.decide.spectra.scalars import recognised

        if self.statement.scalar:
            return recognised(body, self.statement)
        modulus = isinstance(body, Modulus | Abs)
        matrix = self._matrix(body.body if isinstance(body, Modulus | Abs) else body)
        point = self._point(matrix)
        V, C = self.symbol("V"), self.symbol("C")
        spectrum = self._phi(point)
        one = Identity(V.rows)
        loop = one + self.loop(point)
        for kind, equations in (
            ("spectrum", (Equation(matrix * V, "=", spectrum), Equation(V * matrix, "=", spectrum))),
            ("loop", (Equation(matrix, "=", loop),)),
        ):
            if (kind == "loop" and not modulus and not self._along(point)) or C.rows != V.rows:
                continue
            if any(map(self.proves, equations)):
                return kind, 1
        inverse = self._inverse(matrix)
        if inverse is not None and (modulus or self._along(point)) and self.proves(Equation(inverse, "=", loop)):
            return "loop", -1
        raise NoForm("the logarithm of another function")

    def _along(self, point: Term) -> bool:
        return isinstance(point, Symbol)

    def _inverse(self, matrix: Term) -> Term | None:
        match matrix:
            case Inverse(body):
                return body
            case Product((Identity(), Inverse(body))):
                return body
            case _:
                return None

    def _matrix(self, term: Term) -> Term:
        """Return a matrix whose determinant is a number; one with one row and column for a number made of such."""
        match term:
            case Det(body):
                return body
            case Quotient(top, bottom):
                return self._quotient(top, bottom)
            case Trace(body):
                return self._unquoted(body)
            case Number(value):
                return Identity("1") if value == 1 else Product((term, Identity("1")))
            case Sum(addends):
                return Sum(tuple(map(self._matrix, addends)))
            case Neg(body):
                return Neg(self._matrix(body))
            case Product(factors):
                return Product(tuple(x for f in factors for x in self._flat(self._matrix(f))))
            case Power(Modulus(body) | Abs(body), 2):
                matrix = self._matrix(body)
                return Product((*self._flat(matrix), *self._flat(Transpose(_mirrored(matrix)))))
            case _:
                raise NoForm("a number that is no determinant")

    def _unquoted(self, body: Term) -> Term:
        """Write the numbers among the factors of a matrix with one row and column as such matrices."""
        match body:
            case Product(factors):
                made = [self._matrix(f) if isinstance(f, Quotient | Trace) else self._unquoted(f) for f in factors]
                return Product(tuple(x for f in made for x in self._flat(f)))
            case Sum(addends):
                return Sum(tuple(map(self._unquoted, addends)))
            case _:
                return body

    def _flat(self, term: Term) -> tuple[Term, ...]:
        return term.factors if isinstance(term, Product) else (term,)

    def _quotient(self, top: Term, bottom: Term) -> Term:
        below = Inverse(self._matrix(bottom))
        if top == Number(Fraction(1)):
            return below
        return Product((*self._flat(self._matrix(top)), below))

    def _point(self, matrix: Term) -> Term:
        names = {n.name for n in walk(matrix) if isinstance(n, Symbol)}
        s = self.statement.theory.theory.symbols
        if "s" in names or any(name.endswith("(s)") for name in names):
            return s["s"]
        return s["j"] * s["ω"]

    def _resolvents(self, point: Term) -> tuple[Term, Term]:
        A = self.symbol("A")
        factors = point.factors if isinstance(point, Product) else (point,)
        one = Identity(A.rows)
        return Inverse(Product((*factors, one)) - A), Inverse(Neg(Product((*factors, one))) - A)

    def _phi(self, point: Term) -> Term:
        C, W, V = (self.symbol(k) for k in "CWV")
        plus, minus = self._resolvents(point)
        return C * plus * W * minus.T * C.T + V

    def loop(self, point: Term) -> Term:
        """Return C (sI - A)^-1 P C'V^-1."""
        C, P, V = (self.symbol(k) for k in "CPV")
        return C * self._resolvents(point)[0] * P * C.T * V.inv


def _of_matrices(theory: ClaimTheory) -> ClaimTheory:
    """Return a theory with what is assumed of matrices only; tr V = 1 for one row and column says V = I."""
    made = copied(theory.theory, theory.theory.symbols)
    made.declared = dict(theory.theory.declared)
    for c in theory.conditions:
        match c:
            case Equation(Trace(Symbol(rows="1", cols="1") as letter), "=", Number(value)):
                made.assume(f"{letter.name} is a number", letter, "=", Product((Number(value), Identity("1"))))
            case _:
                pass
    return replace(theory, theory=made, conditions=())


def _mirrored(term: Term) -> Term:
    """Return the complex conjugate on the axis: j becomes -j."""

    def change(node: Term) -> Term:
        match node:
            case Product(factors) if any(isinstance(f, Symbol) and f.name == "j" for f in factors):
                return Neg(Product(tuple(f if isinstance(f, Symbol) and f.name == "j" else change(f) for f in factors)))
            case Neg(Product(factors)) if any(isinstance(f, Symbol) and f.name == "j" for f in factors):
                return Product(tuple(f if isinstance(f, Symbol) and f.name == "j" else change(f) for f in factors))
            case Symbol(name="j"):
                return Neg(node)
            case _:
                return rebuilt(node, change)

    return change(term)


def bare(term: Term) -> str:
    """Return a term in one line without spaces."""
    return str(term).replace(" ", "")
