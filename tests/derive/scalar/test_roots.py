"""Each rule for determinants, traces and roots, called by itself: what it accepts, and the nearest that it must not."""

from __future__ import annotations

from collections.abc import Sequence

import pytest

from derive.analysis import is_scalar
from derive.calculus import at_origin, derivative, limit, reflect
from derive.context import Theory
from derive.functions import Definite, Infinity, Limit, Log, Power, Quotient, value
from derive.kernel import Rejected
from derive.real import Real, constant, multiply, power, reciprocal, scalar, show
from derive.roots import CHECKS, check_positive, determinant_claim, is_real, real_coefficients
from derive.spectral import At, Det, Entry, ImaginaryPart, Modulus, RealPart, Roots, TimesArctan, TimesLog, Total
from derive.terms import Block, Equation, Identity, Neg, Number, Product, Reading, Sum, Symbol, Term, Trace, Zero

ZERO, ONE, TWO = Zero("", ""), Number(constant(1).terms[(), ()]), Number(constant(2).terms[(), ()])


def equal(lhs: Term, rhs: Term) -> Equation:
    return Equation(lhs, "=", rhs)


class World:
    """A plant, two families of roots and the letters that the rules speak of."""

    def __init__(self) -> None:
        t = self.t = Theory("roots", "Roots")
        s, j, w, i, m, k, n = (t.scalar(x) for x in ("s", "j", "ω", "i", "m", "k", "n"))
        self.s, self.j, self.w, self.i, self.m, self.k, self.n = s, j, w, i, m, k, n
        self.a = t.parameter("α")
        self.b = t.scalar("b")
        t.assume("s > 0", s, ">")
        self.root, self.other = t.roots("λ", i, m), t.roots("μ", i, m)
        self.far = t.roots("ν", k, n)
        self.re, self.im = RealPart(self.root), ImaginaryPart(self.root)
        for root, index, count in ((self.root, i, m), (self.other, i, m), (self.far, k, n)):
            self.family(root, index, count)
        t.atom("spectral", self.sum(Product((self.re, RealPart(self.other)))), name="sum of both")
        self.matrices()

    def family(self, root: Symbol, index: Symbol, count: Symbol) -> None:
        t, re, im = self.t, RealPart(root), ImaginaryPart(root)
        for name, body in (("Re", re), ("Im", im), ("Re^2", re * re), ("Re Im", re * im)):
            t.atom("spectral", Total(body, index, count), name=f"sum {name} {root.name}")
        for sign, point in (("", self.s), ("-", Neg(self.s))):
            t.atom("spectral", Roots(point, root, index, count), name=f"product {sign}{root.name}")
        t.generic(f"axis {root.name}", self.w - im, re, self.w)
        t.generic(f"reals {root.name}", self.s - re, im, self.s)
        for name, u in (
            ("axis", Power(self.w - im, 2) + Power(re, 2)),
            ("reals", Power(self.s - re, 2) + Power(im, 2)),
        ):
            t.atom("log", u, f"{name} {root.name}", f"ln {name} {root.name}")
            t.atom("spectral", Total(Log(u), index, count), name=f"sum ln {name} {root.name}")

    def matrices(self) -> None:
        t = self.t
        self.A, self.X, self.Y = t.matrix("A", "p", "p"), t.matrix("X", "p", "q"), t.matrix("Y", "q", "p")
        self.M, self.P = (t.matrix(x, "p", "p", symmetric=True) for x in "MP")
        self.c = t.matrix("c", "l", "l")
        self.Z = t.matrix("Z", "p", "p")
        t.complex.add("Z")
        for name in "MP":
            t.assume(f"{name} > 0", t.symbols[name], "≻", Zero("p", "p"))
        t.assume("Z > 0", self.Z, "≻", Zero("p", "p"))
        t.fact("l = 1", "single", Identity("l"))
        self.at = self.s * Identity("p") - self.A
        t.fact("regular", "invertible", self.at)
        t.inverse("R", self.at, "p", because="regular")
        for name, body in (
            ("I + XY", Identity("p") + self.X * self.Y), ("I + YX", Identity("q") + self.Y * self.X), ("at", self.at),
            ("A", self.A), ("M", self.M), ("Z", self.Z), ("c", self.c),
        ):  # fmt: skip
            t.atom("spectral", Det(body), name=f"det {name}")
        for name, body in (
            ("A", self.A), ("MP", self.M * self.P), ("AR", self.A * self.at.inv), ("c", self.c), ("Z", self.Z),
            ("ZR", self.Z * self.at.inv),
        ):  # fmt: skip
            t.atom("spectral", Trace(body), name=f"tr {name}")

    def sum(self, body: Term) -> Total:
        return Total(body, self.i, self.m)

    def product(self, root: Symbol, point: Term | None = None) -> Roots:
        index, count = (self.k, self.n) if root == self.far else (self.i, self.m)
        return Roots(point or self.s, root, index, count)


@pytest.fixture(scope="module")
def x() -> World:
    return World()


@pytest.fixture(scope="module")
def reading(x: World) -> Reading:
    found = x.t.reading()
    assert set(x.t.declared) <= found.adopted
    return found


def accepts(rule: str, statement: Equation, links: Sequence[Equation], reading: Reading) -> None:
    CHECKS[rule](statement, links, reading)


def rejects(
    rule: str, statement: Equation, links: Sequence[Equation], reading: Reading, match: str | None = None
) -> None:
    with pytest.raises(Rejected, match=match):
        CHECKS[rule](statement, links, reading)


# ------------------------------------------------------------------------------------------------ the rules
def test_instance(x: World, reading: Reading):
    lemma = equal(x.a * x.a, Power(x.a, 2))
    accepts("instance", equal(x.re * x.re, Power(x.re, 2)), [lemma], reading)
    rejects("instance", equal(x.re * x.re, Power(x.im, 2)), [lemma], reading, "no instance")
    rejects("instance", lemma, [equal(x.b, x.b)], reading, "no instance")
    rejects("instance", equal(x.b, x.b), [equal(x.b, x.b)], reading, "no instance")
    rejects("instance", equal(x.re * x.re, Power(x.re, 2)), [], reading, "takes 1 steps")
    moving = equal(Limit(x.a, x.w, Infinity()), x.a)
    accepts("instance", equal(Limit(x.b, x.w, Infinity()), x.b), [moving], reading)
    rejects("instance", equal(Limit(x.w, x.w, Infinity()), x.w), [moving], reading, "variable")
    rejects(
        "instance",
        equal(Quotient(ONE, x.b), Quotient(ONE, x.b)),
        [equal(Quotient(ONE, x.a), Quotient(ONE, x.a))],
        reading,
    )


def test_sum_over(x: World, reading: Reading):
    one = equal(x.re * x.re, Power(x.re, 2))
    accepts("sum over", equal(x.sum(one.lhs), x.sum(one.rhs)), [one], reading)
    rejects("sum over", equal(x.sum(one.lhs), x.sum(x.im)), [one], reading, "something else")
    rejects("sum over", equal(x.sum(one.lhs), one.rhs), [one], reading, "something else")
    rejects("sum over", one, [one], reading, "not a sum")
    accepts("sum over", Equation(x.sum(one.lhs), "≥", ZERO), [Equation(one.lhs, "≥", ZERO)], reading)
    rejects("sum over", Equation(x.sum(one.lhs), ">", ZERO), [Equation(one.lhs, ">", ZERO)], reading, "not summed")
    rejects("sum over", equal(x.sum(one.lhs), x.sum(one.rhs)), [Equation(one.lhs, "≠", one.rhs)], reading, "not summed")
    limited = equal(Limit(x.re, x.w, Infinity()), x.re)
    accepts("sum over", equal(Limit(x.sum(x.re), x.w, Infinity()), x.sum(x.re)), [limited], reading)
    rejects("sum over", equal(Limit(x.sum(x.re), x.w, ZERO), x.sum(x.re)), [limited], reading)


def test_linear():
    t = Theory("linear", "Linear")
    w, a, b = t.scalar("ω"), t.scalar("a"), t.scalar("b")
    for name, body in (("a", a), ("b", b), ("a + b", a + b), ("a - b", a - b), ("2a", 2 * a)):
        t.atom("improper", body, name=f"∫ {name}")
    reading = t.reading()

    def half(body: Term) -> Definite:
        return Definite(body, w, ZERO, Infinity())

    one, two = equal(half(a), a), equal(half(b), b)
    accepts("linear", equal(half(a + b), a + b), [one, two], reading)
    accepts("linear", equal(half(a - b), a - b), [one, two], reading)
    accepts("linear", equal(half(2 * a), 2 * a), [one], reading)
    rejects("linear", equal(half(a + b), a - b), [one, two], reading, "combination")
    rejects("linear", equal(half(2 * a), a), [one], reading, "combination")
    rejects("linear", equal(half(b), b), [one], reading, "combination")
    rejects("linear", equal(half(a), a), [], reading, "one or two")
    rejects("linear", equal(half(a), a), [equal(a, a)], reading, "same ends")
    rejects("linear", equal(half(a), a), [equal(Definite(a, w, Neg(Infinity()), Infinity()), a)], reading, "same ends")
    rejects("linear", equal(a, a), [one], reading, "no improper")


def test_conjugate(x: World, reading: Reading):
    accepts("conjugate", equal(x.sum(x.im), x.sum(Neg(x.im))), [], reading)
    accepts("conjugate", equal(x.sum(x.re * x.im), x.sum(Neg(x.re * x.im))), [], reading)
    rejects("conjugate", equal(x.sum(x.im), x.sum(x.im * Neg(x.re))), [], reading)
    rejects("conjugate", equal(x.sum(x.re), x.sum(Neg(x.re))), [], reading, "conjugate")
    both = Product((x.re, RealPart(x.other)))
    rejects("conjugate", equal(x.sum(both), x.sum(both)), [], reading, "one family")
    rejects("conjugate", equal(x.im, Neg(x.im)), [], reading, "sums over the same index")
    rejects("conjugate", equal(x.sum(x.im), x.sum(x.im)), [equal(x.b, x.b)], reading, "takes 0")


def test_same_roots(x: World, reading: Reading):
    lemma = equal(x.product(x.root), x.product(x.far))
    far = Total(RealPart(x.far), x.k, x.n)
    accepts("same roots", equal(x.sum(x.re), far), [lemma], reading)
    rejects(
        "same roots", equal(x.sum(x.re), Total(ImaginaryPart(x.far), x.k, x.n)), [lemma], reading, "different functions"
    )
    mirrored = equal(x.product(x.root), x.product(x.far, Neg(x.s)))
    accepts(
        "same roots",
        equal(x.sum(x.re * x.re), Total(Neg(RealPart(x.far)) * Neg(RealPart(x.far)), x.k, x.n)),
        [mirrored],
        reading,
    )
    rejects("same roots", equal(x.sum(x.re), far), [mirrored], reading, "different functions")
    rejects("same roots", equal(far, x.sum(x.re)), [Equation(mirrored.rhs, "=", mirrored.lhs)], reading, "read at s")
    rejects("same roots", equal(x.sum(x.re), far), [Equation(lemma.lhs, "≠", lemma.rhs)], reading, "no equation")
    rejects("same roots", equal(x.sum(x.re) + x.sum(x.re), far), [lemma], reading, "as many sums")
    rejects("same roots", equal(x.re, far), [lemma], reading, "each factor")
    two = equal(x.product(x.root) * x.product(x.other), x.product(x.far))
    rejects(
        "same roots",
        equal(x.sum(x.re * RealPart(x.other)) + x.sum(RealPart(x.other) * x.re), far),
        [two],
        reading,
        "other roots|different",
    )


def test_modulus():
    y = World()
    t, f = y.t, Quotient(y.product(y.root), y.product(y.other))
    axis = Product((y.j, y.w))
    for root in (y.root, y.other):
        t.assume(f"{root.name} ≠ 0 known", y.product(root), "≠")
        t.atom("reciprocal", y.product(root), f"{root.name} ≠ 0 known", f"1/product {root.name}")
    t.define("g", g := t.scalar("g"), f)
    square = y.product(y.root) * y.product(y.root, Neg(y.s))
    t.define("q", q := t.scalar("q"), square)
    for name, log in (
        ("axis", Log(Modulus(At(g, y.s, axis)))), ("reals", Log(Modulus(At(g, y.s, y.s)))),
        ("plain", Log(At(g, y.s, axis))), ("square", Log(At(q, y.s, axis))),
        ("square on the reals", Log(At(q, y.s, y.s))),
    ):  # fmt: skip
        t.atom("spectral", log, name=f"ln {name}")
    reading = t.reading()
    half = constant(1).terms[(), ()] / 2

    def logs(root: Symbol, along: bool = False) -> Term:
        re, im = RealPart(root), ImaginaryPart(root)
        x, w = (y.s - re, im) if along else (y.w - im, re)
        return y.sum(Log(Power(x, 2) + Power(w, 2)))

    lemma, value_of = equal(g, f), half * logs(y.root) - half * logs(y.other)
    accepts("modulus", equal(Log(Modulus(At(g, y.s, axis))), value_of), [lemma], reading)
    along = half * logs(y.root, True) - half * logs(y.other, True)
    accepts("modulus", equal(Log(Modulus(At(g, y.s, y.s))), along), [lemma], reading)
    rejects("modulus", equal(Log(Modulus(At(g, y.s, y.s))), value_of), [lemma], reading, "right-hand side")
    rejects(
        "modulus",
        equal(Log(Modulus(At(g, y.s, axis))), logs(y.root) - logs(y.other)),
        [lemma],
        reading,
        "right-hand side",
    )
    rejects("modulus", equal(Log(At(g, y.s, axis)), value_of), [lemma], reading, "positive on the axis")
    rejects("modulus", equal(Log(Modulus(At(q, y.s, axis))), value_of), [lemma], reading, "something else")
    rejects("modulus", equal(Log(Modulus(At(g, y.s, axis))), value_of), [equal(g, q)], reading, "no quotient")
    rejects("modulus", equal(g, value_of), [lemma], reading, "no logarithm")
    accepts("modulus", equal(Log(At(q, y.s, axis)), logs(y.root)), [equal(q, square)], reading)
    rejects(
        "modulus", equal(Log(At(q, y.s, y.s)), logs(y.root, True)), [equal(q, square)], reading, "positive on the axis"
    )
    rejects("modulus", equal(Log(Modulus(At(g, y.s, ONE))), value_of), [lemma], reading, "neither s")
    rejects(
        "modulus",
        equal(Log(Modulus(At(g, y.s, y.s))), along),
        [equal(g, y.product(y.root, Neg(y.s)))],
        reading,
        "not declared",
    )


def test_trace_of_roots(x: World, reading: Reading):
    lemma = equal(Det(x.at), x.product(x.root))
    accepts("trace of roots", equal(Trace(x.A), x.sum(x.re)), [lemma], reading)
    rejects("trace of roots", equal(Trace(x.A), x.sum(x.im)), [lemma], reading, "it takes")
    rejects("trace of roots", equal(Trace(x.M * x.P), x.sum(x.re)), [lemma], reading, "not that of")
    complex_lemma = equal(Det(x.s * Identity("p") - x.Z), x.product(x.root))
    rejects("trace of roots", equal(Trace(x.Z), x.sum(x.re)), [complex_lemma], reading, "M real")
    rejects(
        "trace of roots",
        equal(Trace(x.A), x.sum(x.re)),
        [equal(Det(x.at), x.product(x.root, Neg(x.s)))],
        reading,
        "it takes",
    )


def test_exchange(x: World, reading: Reading):
    one, two = Det(Identity("p") + x.X * x.Y), Det(Identity("q") + x.Y * x.X)
    accepts("exchange", equal(one, two), [], reading)
    rejects("exchange", equal(one, one), [], reading, "not exchanged")
    rejects("exchange", equal(Det(x.A), Det(x.A)), [], reading, "it is about")
    rejects("exchange", equal(Det(Identity("p") + x.A), Det(Identity("p") + x.A)), [], reading)
    rejects(
        "exchange",
        equal(Det(Identity("p") + 2 * (x.X * x.Y)), Det(Identity("q") + x.Y * x.X)),
        [],
        reading,
        "not exchanged",
    )
    rejects("exchange", equal(one, two), [equal(one, two)], reading, "takes 0")


def test_single(x: World, reading: Reading):
    accepts("single", equal(Det(x.c), Entry(x.c)), [], reading)
    rejects("single", equal(Det(x.A), Entry(x.A)), [], reading, "not known to be 1")
    rejects("single", equal(Det(x.c), Entry(x.c + x.c)), [], reading, "it is about")


def test_determinant(x: World, reading: Reading):
    assert not determinant_claim(equal(Det(x.A) * Det(x.M), Det(x.A * x.M)), reading).terms
    assert determinant_claim(equal(Det(2 * x.A), Det(x.A)), reading).terms
    assert determinant_claim(equal(Det(x.A) * Det(x.M), Det(x.A + x.M)), reading).terms
    for lhs, rhs in (
        (2 * Det(x.A), Det(2 * x.A)), (Det(x.X), Det(x.X)), (Det(x.A), Det(x.c)), (x.b, x.b),
        (Det(Block(((x.A, x.A), (x.A, x.A)))), Det(x.A)), (Det(x.A) + Det(x.M), Det(x.A + x.M)),
    ):  # fmt: skip
        with pytest.raises(Rejected):
            determinant_claim(equal(lhs, rhs), reading)


def test_positive(x: World, reading: Reading):
    check_positive(Equation(Det(x.M), ">", ZERO), ["M > 0"], reading)
    check_positive(Equation(Trace(x.M * x.P), "≥", ZERO), ["M > 0", "P > 0"], reading)
    for statement, facts in (
        (Equation(Det(x.M), ">", ZERO), ["no such fact"]),
        (Equation(Det(x.M), ">", ONE), ["M > 0"]),
        (Equation(Det(x.A), ">", ZERO), ["M > 0"]),
        (Equation(Det(x.Z), ">", ZERO), ["Z > 0"]),
        (Equation(Det(x.M), "≥", ZERO), ["M > 0"]),
        (Equation(Trace(x.M * x.P), "≥", ZERO), ["P > 0", "M > 0"]),
        (Equation(Trace(x.M * x.P), ">", ZERO), ["M > 0", "P > 0"]),
        (Equation(Trace(x.M), "≥", ZERO), ["M > 0"]),
    ):
        with pytest.raises(Rejected):
            check_positive(statement, facts, reading)


def test_resolvent(x: World, reading: Reading):
    R = x.at.inv

    def statement(body: Term, target: Term = ZERO, symbol: Symbol | None = None) -> Equation:
        return equal(Limit(Trace(body), symbol or x.s, Infinity()), target)

    accepts("resolvent", statement(x.A * R), [], reading)
    rejects("resolvent", statement(x.A * R, ONE), [], reading, "zero")
    rejects("resolvent", statement(x.s * (x.A * R)), [], reading, "no s beside")
    rejects("resolvent", statement(x.A), [], reading, "one resolvent")
    rejects("resolvent", statement(R * R), [], reading, "one resolvent")
    rejects("resolvent", statement(x.Z * R), [], reading, "another factor")
    rejects("resolvent", statement(x.A * R, symbol=x.w), [], reading, "limit of a trace")
    rejects("resolvent", equal(Limit(Trace(x.A * R), x.s, ZERO), ZERO), [], reading, "limit of a trace")


# ------------------------------------------------------------------------------------------------ real and complex
def test_what_is_real(x: World, reading: Reading):
    for term, plain, at_real_s, coefficients in (
        (x.b, True, True, True), (x.s, False, True, True), (x.j, False, False, False), (x.w, True, True, False),
        (Det(x.A), True, True, True), (Det(x.at), False, True, True), (Det(x.Z), False, False, False),
        (x.product(x.root), False, True, True), (x.sum(x.re), True, True, True), (x.re, True, True, True),
        (Trace(x.A * x.at.inv), False, True, True), (Log(Power(x.s - x.re, 2) + Power(x.im, 2)), True, True, False),
    ):  # fmt: skip
        poly = value(term, reading)
        found = is_real(poly, reading), is_real(poly, reading, True), real_coefficients(poly, reading)
        assert found == (plain, at_real_s, coefficients), term


# ------------------------------------------------------------------------------------------------ values
def test_entries_traces_and_determinants(x: World, reading: Reading):
    assert value(Entry(x.c + x.s * Identity("l")), reading) == scalar("tr c") + scalar("s")
    assert value(Det(Identity("p")), reading) == constant(1)
    assert value(Det(x.A.T), reading) == value(Det(x.A), reading)
    assert value(Trace(x.b * x.A.T), reading) == scalar("b") * scalar("tr A")
    for term in (
        Trace(x.A * x.A), Det(x.A * x.A), Entry(x.A), Trace(x.X), Det(Block(((x.A, x.A), (x.A, x.A)))),
        Total(x.re, x.k, x.n), Total(x.re, x.k, x.m), Total(x.im * x.im, x.i, x.m), RealPart(x.b), x.A,
        Roots(x.s, x.root, x.k, x.n), Roots(x.w, x.root, x.i, x.m), Log(Modulus(At(x.b, x.w, x.s))),
        Log(Modulus(At(x.b, x.s, ONE))), TimesLog(x.w, x.b), TimesArctan(x.w, x.b),
    ):  # fmt: skip
        if term == Total(x.re, x.k, x.n):
            assert value(term, reading) == scalar("n") * scalar("Re λ")  # the index is another
            continue
        with pytest.raises(Rejected):
            value(term, reading)
    assert is_scalar(equal(Trace(x.A), x.sum(x.re)))
    assert not is_scalar(equal(x.A, x.A))


def test_calculus_knows_its_limits():
    real = Real()
    y, two = scalar("y"), constant(2)
    assert derivative(y * y, "y", real) == y.scale(2)
    assert at_origin(y * y + two, "y", real) == two
    assert reflect(y * y, "y", real) == y * y
    assert reciprocal(two, real) == constant(1).scale(two.terms[(), ()] / 4)
    assert show(y.scale(2)) == "2 y"
    with pytest.raises(Rejected, match="division by zero"):
        reciprocal(constant(0), real)
    with pytest.raises(Rejected, match="different from zero"):
        reciprocal(y, real)
    with pytest.raises(Rejected, match="exponent"):
        power(y, -1)
    with pytest.raises(Rejected, match="too large"):
        multiply(power(y, 400), y)
    reading = Theory("empty", "Empty").reading()
    with pytest.raises(Rejected, match="0 or at infinity"):
        limit(y, "y", "-∞", real, reading.context)
    with pytest.raises(Rejected, match="infinity"):
        limit(y, "y", "∞", real, reading.context)


def test_functions_that_are_continuous_where_they_are_not_defined():
    """x ln(x² + a²) and |a| arctan(x/|a|): derivative, value at 0, and limit."""
    t = Theory("turns", "Turns")
    w, a = t.scalar("ω"), t.parameter("α")
    t.generic("u", w - a, a, w)
    u = Power(w - a, 2) + Power(a, 2)
    t.atom("reciprocal", u, "u", "1/u")
    t.atom("log", u, "u", "ln u")
    t.atom("absolute", a, name="|α|")
    for kind in (TimesLog, TimesArctan):
        t.atom("spectral", kind(w - a, a), name=kind.__name__)
        t.atom("spectral", kind(a, a), name=f"{kind.__name__} at 0")
    reading = t.reading()
    real, x = reading.real, scalar("ω") - scalar("α")
    log, turn = (value(kind(w - a, a), reading) for kind in (TimesLog, TimesArctan))
    assert derivative(log, "ω", real) == scalar("ln u") + (x * x).scale(2) * scalar("1/u")
    assert derivative(turn, "ω", real) == scalar("α") * scalar("α") * scalar("1/u")
    assert at_origin(turn, "ω", real) == -scalar("TimesArctan at 0")
    assert limit(turn, "ω", "∞", real, reading.context) == (scalar("π") * scalar("|α|")).scale(
        constant(1).terms[(), ()] / 2
    )
    for poly in (log, turn):
        with pytest.raises(Rejected):
            reflect(poly, "ω", real)
        with pytest.raises(Rejected):
            derivative(poly, "α", real)
    with pytest.raises(Rejected):
        limit(log, "ω", "∞", real, reading.context)
    with pytest.raises(Rejected):
        value(Sum((TimesArctan(w, a),)), reading)
