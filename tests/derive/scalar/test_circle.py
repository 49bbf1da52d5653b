"""The unit circle: what the rules for it accept, and the nearest that they must not.

Each false statement has a reason beside it why it is false; what is accepted is evaluated with numbers elsewhere.
"""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction

import pytest

from derive.calculus import reflect
from derive.context import Theory
from derive.derivation import Proof, Step, check, verify
from derive.functions import (
    ANGLE,
    ON_CIRCLE,
    PI,
    TURN,
    Definite,
    Exp,
    Infinity,
    Limit,
    Log,
    Max,
    Power,
    Quotient,
    Rate,
    around,
    value,
)
from derive.kernel import Rejected
from derive.real import ROUND, scalar
from derive.roots import check_instance, check_mirrored, check_modulus, check_same_roots
from derive.spectral import At, Conjugate, Det, Distance, Growth, ImaginaryPart, Modulus, RealPart, Roots, Total
from derive.terms import Equation, Identity, Neg, Number, Product, Reading, Sum, Symbol, Term, Zero

ZERO, ONE, TWO = Zero("", ""), Number(Fraction(1)), Number(Fraction(2))
HALF = Fraction(1, 2)


def equal(lhs: Term, rhs: Term) -> Equation:
    return Equation(lhs, "=", rhs)


def chord(re: Term, im: Term, w: Term) -> Term:
    """Return |(1 - λ) + jω (1 + λ)|^2, written out by hand."""
    return Power(ONE - re - w * im, 2) + Power(w * (ONE + re) - im, 2)


class World:
    """Real and complex matrices of two sizes, a spectrum, families of roots, and logarithms on circle and axis."""

    def __init__(self) -> None:
        t = self.t = Theory("circle", "Circle")
        t.symbols["π"] = PI
        t.assume("π > 0", PI, ">")
        t.atom("reciprocal", PI, "π > 0", "1/π")
        self.s, self.j, self.w, self.i, self.m = (t.scalar(x) for x in ("s", "j", "ω", "i", "m"))
        self.axis = Product((self.j, self.w))
        self.a, self.b = t.parameter("α"), t.scalar("b")
        self.below = ONE + Power(self.w, 2)
        t.assume("b > 0", self.b, ">")
        t.assume("1+ω^2 > 0", self.below, ">")
        t.atom("reciprocal", self.below, "1+ω^2 > 0", "1/(1+ω^2)")
        t.atom("log", self.below, "1+ω^2 > 0", "ln(1+ω^2)")
        t.atom("log", self.b, "b > 0", "ln b")
        self.root, self.other = t.roots("λ", self.i, self.m), t.roots("μ", self.i, self.m)
        for root in (self.root, self.other):
            self.family(root)
        self.matrices()
        self.logarithms()
        for name, body in (("α", self.a), ("b", self.b), ("ω", self.w)):
            t.atom("improper", self.weight * body, name=f"∫ {name}")

    @property
    def weight(self) -> Quotient:
        return Quotient(TWO, self.below)

    def family(self, root: Symbol) -> None:
        t, re, im, name = self.t, RealPart(root), ImaginaryPart(root), root.name
        for sign, point in (("", self.s), ("-", Neg(self.s))):
            t.atom("spectral", Roots(point, root, self.i, self.m), name=f"product {sign}{name}")
        for key, a, c in (("", re, im), ("*", re, Neg(im)), ("-", Neg(re), im)):
            t.assume(f"chord{key} {name} > 0", chord(a, c, self.w), ">")
            t.atom("log", chord(a, c, self.w), f"chord{key} {name} > 0", f"ln chord{key} {name}")
            t.atom("spectral", self.sum(Log(chord(a, c, self.w))), name=f"sum ln chord{key} {name}")
        t.generic(f"axis {name}", self.w - im, re, self.w)
        u = Power(self.w - im, 2) + Power(re, 2)
        t.atom("log", u, f"axis {name}", f"ln axis {name}")
        t.atom("spectral", self.sum(Log(u)), name=f"sum ln axis {name}")
        most = Power(re, 2) + Power(im, 2) - ONE
        t.atom("part", most, name=f"part {name}")
        t.assume(f"most {name} > 0", ONE + Max(most), ">")
        t.atom("log", ONE + Max(most), f"most {name} > 0", f"ln most {name}")
        t.atom("spectral", self.sum(Log(ONE + Max(most))), name=f"sum ln most {name}")

    def matrices(self) -> None:
        t = self.t
        self.A, self.B = t.matrix("A", "p", "p"), t.matrix("B", "p", "p")
        self.C, self.S = t.matrix("C", "q", "q"), t.matrix("S", "q", "q", symmetric=True)
        self.Z = t.matrix("Z", "p", "p")
        t.complex.add("Z")
        for name in "ABZ":
            M = t.symbols[name]
            for body in (self.at(M), self.inner(M), Identity("p") + self.s * M, self.s * Identity("p") + M):
                t.atom("spectral", Det(body), name=f"det {len(t.declared)}")
        for body in (self.at(self.C, "q"), self.inner(self.C, "q"), self.S, self.A, self.at(self.s * self.A)):
            t.atom("spectral", Det(body), name=f"det {len(t.declared)}")
        self.f = t.scalar("f")
        t.define("f", self.f, Det(self.at(self.B)))
        t.assume("det S > 0", Det(self.S), ">")
        t.atom("log", Det(self.S), "det S > 0", "ln det S")
        t.assume("s > 0", self.s, ">")
        t.atom("log", self.s, "s > 0", "ln s")

    def at(self, M: Term, size: str = "p") -> Term:
        return self.s * Identity(size) - M

    def inner(self, M: Term, size: str = "p") -> Term:
        return Identity(size) - self.s * M

    def logarithms(self) -> None:
        t = self.t
        bodies = [Det(self.at(M)) for M in (self.A, self.B)] + [Det(self.at(self.C, "q")), self.f]
        bodies += [Roots(p, r, self.i, self.m) for p in (self.s, Neg(self.s)) for r in (self.root, self.other)]
        for body in bodies:
            for point in (ON_CIRCLE, self.axis):
                t.atom("spectral", Log(Modulus(At(body, self.s, point))), name=f"ln|f| {len(t.declared)}")
                t.atom("spectral", Log(At(body, self.s, point)), name=f"ln f {len(t.declared)}")
        t.atom("improper", self.weight * Log(At(self.f, self.s, ON_CIRCLE)), name="∫ ln f")

    def sum(self, body: Term) -> Total:
        return Total(body, self.i, self.m)

    def product(self, root: Symbol, point: Term | None = None) -> Roots:
        return Roots(point or self.s, root, self.i, self.m)

    def log(self, body: Term, point: Term = ON_CIRCLE) -> Log:
        return Log(At(body, self.s, point))

    def modulus(self, body: Term, point: Term = ON_CIRCLE) -> Log:
        return Log(Modulus(At(body, self.s, point)))

    def loops(self, c: Term, top: tuple[Term, Term], bottom: tuple[Term, Term]) -> Equation:
        return equal(Product((self.f, Det(bottom[0]), Det(bottom[1]))), Product((c, Det(top[0]), Det(top[1]))))


@pytest.fixture(scope="module")
def x() -> World:
    return World()


@pytest.fixture(scope="module")
def reading(x: World) -> Reading:
    found = x.t.reading()
    assert set(x.t.declared) <= found.adopted
    return found


def rejects(rule, statement: Equation, links: Sequence[Equation], reading: Reading, match: str | None = None) -> None:
    with pytest.raises(Rejected, match=match):
        rule(statement, links, reading)


# ------------------------------------------------------------------------------------------------ the point
def test_the_point_is_on_the_circle():
    """(1 + jω)/(1 - jω) has modulus 1, and is e^{jθ} for θ = 2 arctan ω."""
    from cmath import exp
    from math import atan

    from tests.reference.spectrum_values import Place
    from tests.reference.spectrum_values import World as Numbers

    for w in (0.0, 0.3, -2.0, 40.0):
        place = Place(Numbers({}, {}, {"j": 1j, "ω": w}, {}, {}))
        assert place.number(ON_CIRCLE) == pytest.approx(exp(2j * atan(w)))
        assert place.number(ANGLE) == pytest.approx(exp(1j * w))


def other_points(x: World) -> dict[str, Term]:
    j, w = x.j, x.w
    minus = Neg(x.axis)
    return {
        "the conjugate point": Quotient(ONE + minus, ONE + x.axis),
        "the point 1": Quotient(ONE + x.axis, ONE + x.axis),
        "on the real axis": Quotient(ONE + w, ONE - w),
        "twice as far": Quotient(TWO + x.axis, ONE - x.axis),
        "not the circle": Quotient(x.axis, ONE - x.axis),
        "another variable": Quotient(ONE + Product((j, x.b)), ONE - Product((j, x.b))),
        "the angle": ANGLE,
    }


@pytest.mark.parametrize("name", other_points(World()))
def test_no_other_point_is_taken_for_it(x: World, reading: Reading, name: str):
    point = other_points(x)[name]
    g = x.product(x.root)
    right = HALF * x.sum(Log(Distance(ON_CIRCLE, x.root)))
    rejects(check_modulus, equal(x.modulus(g, point), right), [equal(g, g)], reading)
    with pytest.raises(Rejected):
        value(x.modulus(g, point), reading)
    with pytest.raises(Rejected):
        value(Log(Distance(point, x.root)), reading)


def test_the_circle_is_not_the_axis(x: World, reading: Reading):
    """ln|f| at jω and at (1 + jω)/(1 - jω) are different functions of ω; both depend on it, and both are even."""
    on_axis, on_circle = (value(x.modulus(Det(x.at(x.A)), p), reading) for p in (x.axis, ON_CIRCLE))
    assert on_axis != on_circle
    for poly in (on_axis, on_circle):
        ((m, _),) = poly.terms
        assert [v for v in ("ω", "s", "b") if reading.real.varies(m[0], v)] == ["ω"]
        assert reflect(poly, "ω", reading.real) == poly
    assert {a.over for a in reading.real.atoms.values() if a.kind == "log modulus"} == {"ω", ROUND}
    for operator in (Rate(x.log(x.f), x.w), Limit(x.log(x.f), x.w, Infinity())):
        with pytest.raises(Rejected):
            value(operator, reading)


def test_a_function_without_real_coefficients_has_no_logarithm_there(x: World):
    t = World().t
    t.atom("spectral", Log(Modulus(At(Det(x.at(x.Z)), x.s, ON_CIRCLE))), name="of a complex matrix")
    with pytest.raises(Rejected, match="not known to be real"):
        t.reading()


# ------------------------------------------------------------------------------------------------ distances
def test_the_distance_to_a_root(x: World, reading: Reading):
    re, im = RealPart(x.root), ImaginaryPart(x.root)
    for root, c in ((x.root, im), (Conjugate(x.root), Neg(im))):
        found = value(Log(Distance(ON_CIRCLE, root)), reading)
        assert found == value(Log(Quotient(chord(re, c, x.w), x.below)), reading)
        assert value(Distance(ON_CIRCLE, root), reading) == value(Quotient(chord(re, c, x.w), x.below), reading)
        assert found != value(Log(chord(re, c, x.w)), reading)  # not without 1 + ω^2
    assert value(Log(Distance(ON_CIRCLE, x.root)), reading) != value(Log(Distance(x.axis, x.root)), reading)


def test_modulus_on_the_circle(x: World, reading: Reading):
    g = x.product(x.root)
    lemma, point = equal(g, g), ON_CIRCLE
    right = HALF * x.sum(Log(Distance(point, x.root)))
    check_modulus(equal(x.modulus(g), right), [lemma], reading)
    for wrong in (
        x.sum(Log(Distance(point, x.root))),  # twice
        Neg(right),
        HALF * x.sum(Log(Distance(x.axis, x.root))),  # of the axis
        HALF * x.sum(Log(Distance(point, x.other))),  # of other roots
        HALF * x.sum(Log(chord(RealPart(x.root), ImaginaryPart(x.root), x.w))),  # without 1 + ω^2
        HALF * Log(Distance(point, x.root)),  # of one root
    ):
        rejects(check_modulus, equal(x.modulus(g), wrong), [lemma], reading, "right-hand side")
    rejects(check_modulus, equal(x.modulus(g, x.axis), right), [lemma], reading, "right-hand side")
    rejects(check_modulus, equal(x.modulus(x.product(x.other)), right), [lemma], reading, "something else")
    rejects(check_modulus, equal(x.modulus(g), right), [Equation(g, "≠", g)], reading, "something else")


def test_modulus_at_minus_the_point(x: World, reading: Reading):
    """|-z - λ| is the distance of z to -λ, or for the conjugates, which are roots as well, to -conj λ."""
    g = x.product(x.root, Neg(x.s))
    turned = Log(Quotient(chord(Neg(RealPart(x.root)), ImaginaryPart(x.root), x.w), x.below))
    check_modulus(equal(x.modulus(g), HALF * x.sum(turned)), [equal(g, g)], reading)
    right = HALF * x.sum(Log(Distance(ON_CIRCLE, x.root)))
    rejects(check_modulus, equal(x.modulus(g), right), [equal(g, g)], reading, "right-hand side")


def test_a_square_on_the_axis_is_none_on_the_circle(x: World, reading: Reading):
    """p(s) p(-s) = (s - λ)(-s - λ) with λ = 1/2 is 1/4 - s^2: 1/4 - z^2 is not positive on the circle."""
    f = Product((x.product(x.root), x.product(x.root, Neg(x.s))))
    t = World().t
    t.atom("spectral", x.log(f), name="ln of both")
    found = t.reading()
    right = x.sum(Log(Distance(ON_CIRCLE, x.root)))
    rejects(check_modulus, equal(x.log(f), right), [equal(f, f)], found, "positive on the axis")


# ------------------------------------------------------------------------------------------------ mirrored
def right_of(x: World, M: Term, N: Term, c: Term) -> Term:
    return Log(c) + 2 * x.modulus(Det(x.at(M))) - 2 * x.modulus(Det(x.at(N)))


def test_mirrored(x: World, reading: Reading):
    A, B, S = x.A, x.B, Det(x.S)
    lemma = x.loops(S, (x.at(A), x.inner(A)), (x.at(B), x.inner(B)))
    right = right_of(x, A, B, S)
    check_mirrored(equal(x.log(x.f), right), [lemma], reading)
    check_mirrored(equal(x.log(x.f), right_of(x, A, B, x.b)), [x.loops(x.b, *_pairs(x, A, B))], reading)
    logs = x.modulus(Det(x.at(A))), x.modulus(Det(x.at(B)))
    for wrong in (
        Log(S) + logs[0] - logs[1],  # once
        Log(S) + 2 * logs[1] - 2 * logs[0],  # upside down
        Log(S) + 2 * logs[0] + 2 * logs[1],
        2 * logs[0] - 2 * logs[1],  # without the constant
        Neg(Log(S)) + 2 * logs[0] - 2 * logs[1],
        Log(x.b) + 2 * logs[0] - 2 * logs[1],  # another constant
        right_of(x, A, A, S),
    ):
        rejects(check_mirrored, equal(x.log(x.f), wrong), [lemma], reading, "right-hand side")
    rejects(check_mirrored, Equation(x.log(x.f), "=", right), [], reading, "takes 1")
    rejects(check_mirrored, equal(x.log(x.f), right), [Equation(lemma.lhs, "≠", lemma.rhs)], reading, "it is about")


def _pairs(x: World, A: Term, B: Term) -> tuple[tuple[Term, Term], tuple[Term, Term]]:
    return (x.at(A), x.inner(A)), (x.at(B), x.inner(B))


def test_mirrored_needs_the_circle(x: World, reading: Reading):
    """On the axis det(I - jωM) is not, but for a power, the conjugate of det(jωI - M); nor is ln f that of |f|."""
    A, B, S = x.A, x.B, Det(x.S)
    lemma, right = x.loops(S, *_pairs(x, A, B)), right_of(x, A, B, S)
    for point in (x.axis, x.s, *other_points(x).values()):
        rejects(check_mirrored, equal(x.log(x.f, point), right), [lemma], reading, "it is about")
    along = Log(S) + 2 * x.modulus(Det(x.at(A)), x.axis) - 2 * x.modulus(Det(x.at(B)), x.axis)
    rejects(check_mirrored, equal(x.log(x.f, x.axis), along), [lemma], reading, "it is about")
    rejects(check_mirrored, equal(x.log(x.f), along), [lemma], reading, "right-hand side")
    rejects(check_mirrored, equal(x.modulus(x.f), right), [lemma], reading, "it is about")
    rejects(check_mirrored, equal(x.log(Det(x.at(A))), right), [lemma], reading, "it is about")


def test_mirrored_needs_both_determinants_of_one_matrix(x: World, reading: Reading):
    A, B, S = x.A, x.B, Det(x.S)
    statement = equal(x.log(x.f), right_of(x, A, B, S))
    bottom = x.at(B), x.inner(B)
    for top, match in (
        ((x.at(A), x.at(A)), "second"),  # det(sI - M)^2
        ((x.at(A), x.inner(B)), "second"),  # of another matrix
        ((x.at(A), Identity("p") + x.s * A), "second"),  # det(I + sM)
        ((x.at(A), A), "second"),
        ((x.inner(A), x.at(A)), "first"),
        ((x.s * Identity("p") + A, x.inner(A)), "second"),
    ):
        rejects(check_mirrored, statement, [x.loops(S, top, bottom)], reading, match)
        rejects(check_mirrored, statement, [x.loops(S, (x.at(A), x.inner(A)), top)], reading, match)


def test_mirrored_needs_real_matrices_of_one_size(x: World, reading: Reading):
    """For M = j the factor det(I - zM) det(zI - M) is (1 - jz)(z - j) = 2z - j(1 + z^2), which is 2z(1 - j cos θ).

    With M of one row and N of two, f = c det(zI - M) det(I - zM) / (det(zI - N) det(I - zN)) keeps a factor 1/z.
    """
    A, B, S = x.A, x.B, Det(x.S)
    statement = equal(x.log(x.f), right_of(x, A, B, S))
    for lemma in (x.loops(S, *_pairs(x, x.Z, B)), x.loops(S, *_pairs(x, A, x.Z))):
        rejects(check_mirrored, statement, [lemma], reading, "M real")
    moving = x.s * A
    lemma = x.loops(S, (x.at(moving), x.inner(moving)), (x.at(B), x.inner(B)))
    rejects(check_mirrored, statement, [lemma], reading, "M real|first")
    other = x.loops(S, (x.at(x.C, "q"), x.inner(x.C, "q")), (x.at(B), x.inner(B)))
    wrong = Log(S) + 2 * x.modulus(Det(x.at(x.C, "q"))) - 2 * x.modulus(Det(x.at(B)))
    rejects(check_mirrored, equal(x.log(x.f), wrong), [other], reading, "sizes")


def test_mirrored_needs_real_numbers_in_its_matrices(x: World):
    """1/(1 + j) is a number without s, and not real; a letter for it is not among those that may be complex."""
    t = World().t
    t.assume("1 + j ≠ 0", ONE + x.j, "≠")
    number = t.atom("reciprocal", ONE + x.j, "1 + j ≠ 0", "1/(1+j)")
    M = number * Identity("p")
    for body in (x.at(M), x.inner(M)):
        t.atom("spectral", Det(body), name=f"det {len(t.declared)}")
    lemma = x.loops(Det(x.S), (x.at(M), x.inner(M)), (x.at(x.B), x.inner(x.B)))
    statement = equal(x.log(x.f), right_of(x, x.A, x.B, Det(x.S)))
    rejects(check_mirrored, statement, [lemma], t.reading(), "M real")


def test_mirrored_needs_a_positive_constant(x: World, reading: Reading):
    """With c = s the factor is no number; ln det A is not declared, for det A may be negative."""
    A, B = x.A, x.B
    moduli = 2 * x.modulus(Det(x.at(A))) - 2 * x.modulus(Det(x.at(B)))
    for c, match in ((x.s, "depends on s"), (Det(A), "log"), (Neg(x.b), "log"), (x.j, "log")):
        lemma = x.loops(c, *_pairs(x, A, B))
        statement = equal(x.log(x.f), Sum((Log(c), *moduli.addends)))
        rejects(check_mirrored, statement, [lemma], reading, match)
        rejects(check_mirrored, equal(x.log(x.f), moduli), [lemma], reading, match)


# ------------------------------------------------------------------------------------------------ around the circle
def circle(body: Term, w: Symbol, lower: Term | None = None, upper: Term = PI) -> Definite:
    return Definite(body, w, lower or Neg(PI), upper)


def test_the_integral_around_the_circle(x: World, reading: Reading):
    found = value(circle(x.log(x.f, ANGLE), x.w), reading)
    assert found == scalar("∫ ln f").scale(2)
    assert value(circle(x.b, x.w), reading) == scalar("∫ b").scale(2)
    assert value(circle(x.b, x.w), reading) != value(Definite(x.b * x.weight, x.w, ZERO, Infinity()), reading)
    inside = around(circle(x.log(x.f, ANGLE), x.w), reading)
    assert inside == Definite(x.weight * x.log(x.f), x.w, Neg(Infinity()), Infinity())


def test_what_is_no_integral_around_the_circle(x: World, reading: Reading):
    log = x.log(x.f, ANGLE)
    for lower, upper in ((ZERO, PI), (Neg(PI), Infinity()), (PI, Neg(PI)), (Neg(2 * PI), 2 * PI), (Neg(x.b), x.b)):
        with pytest.raises(Rejected):
            value(circle(log, x.w, lower, upper), reading)
    for variable in (x.b, x.s, x.j, x.a, PI):
        with pytest.raises(Rejected):
            value(circle(x.b, variable), reading)
    with pytest.raises(Rejected):
        value(log, reading)  # e^{jω} outside of such an integral


def moving_bodies(x: World) -> dict[str, Term]:
    log, twice = x.log(x.f, ANGLE), Exp(Product((TWO, *TURN.factors)))
    return {
        "ω itself": x.w,
        "ω beside the point": x.w * log,
        "the point of the axis": x.log(x.f),
        "the imaginary axis": x.log(x.f, x.axis),
        "a logarithm of ω": Log(x.below),
        "another power of the point": x.log(x.f, twice),
        "the conjugate point": x.log(x.f, Exp(Neg(TURN))),
        "an integral in the same variable": log + Definite(x.weight * x.b, x.w, ZERO, Infinity()),
        "a circle within the circle": circle(log, x.w),
        "a distance on the axis": Log(Distance(x.axis, x.root)),
    }


@pytest.mark.parametrize("name", moving_bodies(World()))
def test_the_angle_occurs_in_the_point_alone(x: World, reading: Reading, name: str):
    """∫ ω dω over (-π, π) is 0, and not the integral of 2ω/(1 + ω^2); what is captured would be another function."""
    with pytest.raises(Rejected, match="function of the point alone"):
        value(circle(moving_bodies(x)[name], x.w), reading)


def test_a_scalar_that_is_defined_by_the_angle(x: World):
    t = World().t
    t.define("g", g := t.scalar("g"), x.w * x.w + x.b)
    t.atom("improper", x.weight * g, name="∫ g")
    with pytest.raises(Rejected, match="function of the point alone"):
        value(circle(g, x.w), t.reading())


def test_a_matrix_that_is_defined_by_the_angle(x: World):
    """∫ det(ωI) dω over (-π, π) is not that of 2 det(ωI)/(1 + ω^2) over the axis."""
    t = World().t
    M = t.matrix("M", "p", "p")
    t.define("M", M, x.w * Identity("p"))
    t.atom("spectral", Det(M), name="det M")
    t.atom("improper", x.weight * Det(M), name="∫ det M")
    with pytest.raises(Rejected):
        value(circle(Det(M), x.w), t.reading())


def test_a_parameter_is_not_replaced_by_what_depends_on_the_angle(x: World, reading: Reading):
    lemma = equal(circle(x.a, x.w), 2 * PI * x.a)
    check_instance(equal(circle(x.b, x.w), 2 * PI * x.b), [lemma], reading)
    for image in (x.w, x.log(x.f), x.log(x.f, ANGLE)):
        rejects(check_instance, equal(circle(image, x.w), 2 * PI * image), [lemma], reading)


def test_an_integral_around_the_circle_does_not_rest_on_a_frequency(x: World):
    """With ω = 1 as a hypothesis 2/(1 + ω^2) is 1; under the integral it is not."""
    t = World().t
    t.assume("ω = 1", x.w, "=", ONE)
    t.assume("mean", circle(x.b, x.w), "=", 2 * PI * x.b)
    statement = equal(circle(x.b, x.w), 2 * PI * x.b)
    step = Step("a", statement, "scalar", (), Proof(), uses=("ω = 1",))
    with pytest.raises(Rejected, match="holds ω at some value"):
        check(step, t.reading(), {})


# ------------------------------------------------------------------------------------------------ growth
def test_growth(x: World, reading: Reading):
    assert value(Growth(x.root), reading) == scalar("ln most λ").scale(HALF)
    assert value(x.sum(Growth(x.root)), reading) == scalar("sum ln most λ").scale(HALF)
    assert value(Growth(x.root), reading) != value(Growth(x.other), reading)
    with pytest.raises(Rejected):
        value(Growth(x.b), reading)
    t = Theory("none", "No logarithm")
    root = t.roots("λ", t.scalar("i"), t.scalar("m"))
    with pytest.raises(Rejected):
        value(Growth(root), t.reading())


def test_growth_of_other_roots(x: World, reading: Reading):
    """Σ over μ of max(0, ln|λ|) is no sum over the roots of the other product."""
    lemma = equal(x.product(x.root), x.product(x.other))
    mixed = equal(x.sum(Growth(x.root)), x.sum(Growth(x.root)))
    rejects(check_same_roots, mixed, [lemma], reading, "other roots")
    rejects(check_same_roots, equal(x.sum(Growth(x.root)), x.sum(Growth(x.other))), [lemma], reading, "different")


# ------------------------------------------------------------------------------------------------ in a derivation
def test_a_link_that_holds_at_one_point_only(x: World):
    """With s = 2 as a hypothesis, f may be anything that is right at 2."""
    t = World().t
    t.assume("s = 2", x.s, "=", TWO, case=True)
    g = x.product(x.root)
    t.define("wrong", h := t.scalar("h"), Product((Fraction(1, 2) * x.s, g)))
    t.atom("spectral", x.modulus(h), name="ln|h|")
    links = Step("h", equal(h, g), "scalar", (), Proof(identities=(_half_of(g, x),)), ("s = 2", "wrong"), lemma=True)
    right = HALF * x.sum(Log(Distance(ON_CIRCLE, x.root)))
    last = Step("modulus of h", equal(x.modulus(h), right), "modulus", (), Proof(links=("h",)), ("h",))
    first, second = verify(t, [links, last])
    assert first.accepted, first.message
    assert "holds s at some value" in second.message


def _half_of(g: Term, x: World):
    from derive.kernel import Certificate
    from derive.kernel import Term as Addend

    claim = scalar("h") - scalar("product λ")
    terms = (
        Addend(Fraction(1), (), (), "wrong", False, ()),
        Addend(Fraction(1, 2), ("product λ",), (), "s = 2", False, ()),
    )
    return Certificate(claim, terms)
