"""Numbers of a statement as polynomials in the quantities that the theorems speak of."""

from __future__ import annotations

from collections.abc import Iterator
from fractions import Fraction

from derive.decide.spectra.form import Form, NoForm
from derive.decide.spectra.recognise import Recogniser, bare
from derive.functions import PI, Abs, Definite, Infinity, Limit, Log, Max, Power, Quotient  # fmt: skip
from derive.spectral import At, Modulus, RealPart, Total
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
    Zero,
    walk,
)  # fmt: skip

__all__ = ["COST", "POLES", "TRACE", "UNSTABLE", "Quantities"]

HALF = Fraction(1, 2)
COST, UNSTABLE, TRACE = "T", "S", "tr A"
ZEROS, POLES = "zeros of f", "poles of f"
KERNEL, POINT = "σ_0/(σ_0^2+(ω-ω_0)^2)", "σ_0+jω_0"
BLASCHKE = "(σ_0+jω_0-z_i)/(σ_0+jω_0+z̄_i)"


class Quantities(Recogniser):
    """Read numbers of one statement as forms; notes which steps of the lecture are used."""

    @property
    def nonzero(self) -> frozenset[str]:
        """The quantities that do not vanish; extreme eigenvalues of C'V^-1 C by what is assumed of C."""
        found = {PI.name, "V"}
        for c in self.statement.theory.conditions:
            if c.relation == "≠" and isinstance(c.lhs, Symbol) and c.lhs.name == "C":
                found |= {"λmax", "C"}
        C = self.statement.theory.theory.symbols.get("C")
        declared = self.statement.theory.theory.declared
        for name in self.statement.assumed:
            item = getattr(declared.get(name), "statement", None)
            if isinstance(item, Equation) and item.relation == "≻" and C is not None and item.lhs == C.T * C:
                found |= {"λmax", "λmin"}
        return frozenset(found)

    def form(self, term: Term) -> Form:
        """Return a number as a form."""
        match term:
            case Number(value):
                return Form.number(value)
            case Symbol(scalar=True, name=PI.name):
                return Form.of(PI.name)
            case Symbol(scalar=True, name=name) if self.is_eigenvalue(term):
                return Form.of(self._extreme(name))
            case Zero():
                return Form({})
            case Neg(body):
                return -self.form(body)
            case Sum(addends):
                total = Form({})
                for addend in addends:
                    total += self.form(addend)
                return total
            case Product(factors):
                return self._product(factors)
            case Quotient(top, bottom):
                return self.form(top) * self.form(bottom).reciprocal(self.nonzero)
            case Power(body, exponent) if exponent >= 0:
                return self.form(body).power(exponent)
            case Total(body, _, _):
                return self._over_roots(body)
            case Definite(body, Symbol(name="ω"), Neg(Infinity()), Infinity()):
                return self._integral(body)
            case Limit(body, Symbol(name="s"), Infinity()):
                return self._limit(body)
            case Trace(body):
                return self._trace(body)
            case Identity("1"):
                return Form.number(1)
            case Log(Modulus(At(Symbol(name="f"), Symbol(name="s"), point))) if bare(point) == POINT:
                return Form.of("ln|f(s0)|")
            case Max(Symbol(name="A")) if self.statement.scalar:
                return Form.of(UNSTABLE)
            case Abs(Symbol(name="A")) if self.statement.scalar:
                return Form.of(UNSTABLE) + Form.of(UNSTABLE) - Form.of(TRACE)
            case _:
                return self._letter(term)

    def _product(self, factors: tuple[Term, ...]) -> Form:
        total, matrices = Form.number(1), list[Term]()
        for factor in factors:
            if self._is_number(factor):
                total = total * self.form(factor)
            else:
                matrices.append(factor)
        return total * self._trace(Product(tuple(matrices))) if matrices else total

    def _is_number(self, term: Term) -> bool:
        """Tell whether a factor is a number, or a letter with one row and column that commutes with all."""
        if isinstance(term, Symbol):
            return term.scalar or self._is_single(term)
        kinds = Number | Quotient | Definite | Total | Limit | Trace | Max | Abs | Power
        if isinstance(term, kinds) or term == Identity("1"):
            return True
        return isinstance(term, Sum | Neg | Product) and all(map(self._is_number, term.children()))

    def _is_single(self, symbol: Symbol) -> bool:
        return self.statement.scalar or (symbol.name == "V" and symbol.rows == symbol.cols == "1")

    def _letter(self, term: Term) -> Form:
        match term:
            case Symbol(name=name) if self.statement.scalar and name in "ACVW":
                return Form.of(TRACE if name == "A" else name)
            case Symbol(name="P") if self.statement.scalar:
                return Form.of("P")
            case Symbol(name="V") if self._is_single(term):
                return Form.of("V")
            case Symbol() | Transpose() | Inverse():
                return self._trace(term)
            case _:
                raise NoForm(f"{type(term).__name__} is no quantity of the theorems")

    def is_eigenvalue(self, node: Term) -> bool:
        """Tell whether a letter stands for an extreme eigenvalue."""
        return isinstance(node, Symbol) and node.name.startswith(("λmin(", "λmax("))

    def _extreme(self, name: str) -> str:
        V, C = self.symbol("V"), self.symbol("C")
        kind = name[:4]
        if name != f"{kind}({C.T * V.inv * C})":
            raise NoForm("the eigenvalue of another matrix than C'V^-1 C")
        return kind

    def _trace(self, body: Term) -> Form:
        """Return the trace of a matrix, by a proved equality with a known one."""
        if self.statement.scalar:
            return self._letters(body)
        match body:
            case Limit(inner, Symbol(name="s"), Infinity()):
                return self._limit(inner)
            case Sum(addends):
                total = Form({})
                for addend in addends:
                    total += self._trace(addend)
                return total
            case Neg(inner):
                return -self._trace(inner)
            case Product((Number(number), *rest)) if rest:
                return Form.number(number) * self._trace(Product(tuple(rest)))
            case _:
                pass
        A, C, P, V = (self.symbol(k) for k in "ACPV")
        single = V.rows == "1"
        for known, matrix in (
            (Form.of(COST), C * P * C.T * V.inv),
            (Form.of(TRACE), A),
            (Form.of("tr P"), P),
            (Form.of(COST) * Form.of("V"), C * P * C.T) if single else (Form.of("V"), V),
            (Form.of("V"), V),
        ):
            if matrix is V and not single:
                continue
            if self.same_trace(body, matrix):
                return known
        raise NoForm("the trace of another matrix")

    def _letters(self, body: Term) -> Form:
        """Return a product of letters where all dimensions are 1."""
        match body:
            case Product(factors):
                total = Form.number(1)
                for factor in factors:
                    total = total * self.form(factor)
                return total
            case Transpose(inner):
                return self.form(inner)
            case Inverse(inner):
                return self.form(inner).reciprocal(self.nonzero)
            case _:
                raise NoForm("a letter that the theorems do not speak of")

    def _over_roots(self, body: Term) -> Form:
        """Return the sum of a number over the roots of a family."""
        match body:
            case Neg(inner):
                return -self._over_roots(inner)
            case Product((Number(value), inner)):
                return Form.number(value) * self._over_roots(inner)
            case Max(RealPart(Symbol(name="λ"))):
                return Form.of(UNSTABLE)
            case RealPart(Symbol(name="λ")):
                return Form.of(TRACE)
            case Abs(RealPart(Symbol(name="λ"))) | Modulus(RealPart(Symbol(name="λ"))):
                return Form.of(UNSTABLE) + Form.of(UNSTABLE) - Form.of(TRACE)
            case Log(Modulus(factor)) if bare(factor) == BLASCHKE:
                return Form.of("zeros on the right")
            case Max(RealPart(Symbol(name="φ"))):
                return self._zeros()
            case Max(RealPart(Symbol(name="η"))):
                return self._poles()
            case _:
                raise NoForm("a sum over roots of another kind")

    def _zeros(self) -> Form:
        match self.function():
            case "spectrum":
                self.used.append("theorem 2")
                return self._poles() + self._spectrum()
            case "sensitivity":
                self.used.append("zeros and poles of det(I + L)")
                return Form.of(UNSTABLE)
            case _:
                return Form.of(ZEROS)

    def _poles(self) -> Form:
        kind = self.function()
        return Form({}) if kind == "sensitivity" or (kind == "any" and self.stable("η")) else Form.of(POLES)

    def function(self) -> str:
        """Return what f is: det(Phi_y V^-1), det(I + L)^-1, any quotient p/q that tends to 1, or unknown."""
        given = next((c.rhs for c in self.statement.theory.conditions if str(c.lhs) == "f(s)"), None)
        if given is None:
            return "unknown"
        if any(isinstance(n, Symbol) and n.name in ("p", "q") for n in walk(given)):
            return "any" if self._tends_to_one() else "unknown"
        kind, power = self.recognised_as(given)
        return {("spectrum", 1): "spectrum", ("loop", -1): "sensitivity"}.get((kind, power), "unknown")

    def _tends_to_one(self) -> bool:
        return any(
            isinstance(c.lhs, Limit)
            and c.lhs.point == Infinity()
            and str(c.lhs.body) == "f(s)"
            and c.rhs == Number(Fraction(1))
            for c in self.statement.theory.conditions
        )

    def stable(self, family: str) -> bool:
        """Tell whether all roots of a family are assumed to be in the left half plane."""
        for c in self.statement.theory.conditions:
            match c:
                case Equation(Number(zero), ">", RealPart(Symbol(name=name))) if zero == 0 and name == family:
                    return True
                case _:
                    pass
        return False

    def _spectrum(self) -> Form:
        self.used.append("theorem 1")
        return Form.of(COST) - Form.of(UNSTABLE) - Form.of(UNSTABLE)

    def _integral(self, body: Term) -> Form:
        """Return int body dω, 2 pi times what the theorems say of the logarithms in it."""
        if self._is_poisson(body):
            self.used.append("Poisson-Jensen formula")
            return Form.of(PI.name) * (Form.of("ln|f(s0)|") - Form.of("zeros on the right"))
        total, turn = Form({}), Form.number(2) * Form.of(PI.name)
        for weight, log in self._logarithms(body):
            total += weight * turn * self._mean(log)
        return total

    def _is_poisson(self, body: Term) -> bool:
        """Tell whether an integrand is Poisson's kernel times ln |f|, f having stable poles and f(s0) ≠ 0."""
        match body:
            case Product((Quotient() as weight, Log() as log)) if self._is_function(log, axis=True):
                kernel = bare(weight) == KERNEL
            case _:
                return False
        given = {str(c) for c in self.statement.theory.conditions}
        return kernel and self.stable("η") and {"σ_0 > 0", f"f({POINT}) != 0"} <= given

    def _mean(self, log: Log) -> Form:
        if self._is_function(log, axis=True):
            self.used.append("proposition 2")
            return Form.number(HALF) * Form.of("lim s ln|f|") + self._zeros() - self._poles()
        kind, power = self.recognised_as(log.body)
        if kind == "spectrum":
            return Form.number(power) * self._spectrum()
        self.used.append("Bode integral")
        return Form.number(power) * (Form.number(HALF) * Form.of(COST) - Form.of(UNSTABLE))

    def _limit(self, body: Term) -> Form:
        """Return the limit of a sum of multiples of s ln |.| and s tr L(s)."""
        match body:
            case Sum(addends):
                total = Form({})
                for addend in addends:
                    total += self._limit(addend)
                return total
            case Neg(inner):
                return -self._limit(inner)
            case Product(factors):
                weight, rest = Form.number(1), list[Term]()
                for factor in factors:
                    if isinstance(factor, Number):
                        weight = weight * self.form(factor)
                    else:
                        rest.append(factor)
                point = next((f for f in rest if isinstance(f, Symbol) and f.name == "s"), None)
                if point is None:
                    raise NoForm("a limit of another form")
                rest.remove(point)
                return weight * self._far_out(rest[0] if len(rest) == 1 else Product(tuple(rest)))
            case _:
                raise NoForm("a limit of another form")

    def _far_out(self, term: Term) -> Form:
        """Return lim s x(s)."""
        match term:
            case Sum(addends):
                total = Form({})
                for addend in addends:
                    total += self._far_out(addend)
                return total
            case Neg(inner):
                return -self._far_out(inner)
            case Log() if self._is_function(term, axis=False):
                return Form.of("lim s ln|f|")
            case Log(body):
                kind, power = self.recognised_as(body)
                self.used.append("roll-off" if kind == "loop" else "first term of spectrum")
                return Form.number(power) * Form.of(COST) if kind == "loop" else Form({})
            case Trace(body):
                if not self.same_trace(body, self.loop(self.symbol("s"))):
                    raise NoForm("the limit of another trace")
                self.used.append("limit of s tr L")
                return Form.of(COST)
            case _:
                if self.same_trace(term, self.loop(self.symbol("s"))):
                    self.used.append("limit of s tr L")
                    return Form.of(COST)
                raise NoForm("a limit of another form")

    def _is_function(self, log: Log, axis: bool) -> bool:
        """Tell whether a logarithm is that of |f| on the axis or along the reals, f = p/q tending to 1."""
        match log.body:
            case Modulus(At(Symbol(name="f"), Symbol(name="s"), point)) if axis:
                found = str(point).replace(" ", "") == "jω"
            case Abs(Symbol(name="f")) | Modulus(Symbol(name="f")) if not axis:
                found = True
            case Modulus(At(Symbol(name="f"), Symbol(name="s"), Symbol(name="s"))) if not axis:
                found = True
            case _:
                found = False
        return found and self.function() == "any"

    def _logarithms(self, body: Term) -> Iterator[tuple[Form, Log]]:
        match body:
            case Log():
                yield Form.number(1), body
            case Neg(inner):
                yield from ((-w, log) for w, log in self._logarithms(inner))
            case Sum(addends):
                for addend in addends:
                    yield from self._logarithms(addend)
            case Product(factors) if sum(any(isinstance(n, Log) for n in walk(f)) for f in factors) == 1:
                weight = Form.number(1)
                for f in factors:
                    if not any(isinstance(n, Log) for n in walk(f)):
                        weight = weight * self.form(f)
                inner = next(f for f in factors if any(isinstance(n, Log) for n in walk(f)))
                if {"ω", "s"} & {n.name for f in factors if f is not inner for n in walk(f) if isinstance(n, Symbol)}:
                    raise NoForm("an integrand with a weight")
                yield from ((weight * w, log) for w, log in self._logarithms(inner))
            case _:
                raise NoForm("an integrand that is no sum of logarithms")
