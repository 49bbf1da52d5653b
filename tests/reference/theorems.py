"""Matrix theorems of estimation and control that the prover must decide, true ones and false ones.

Each function builds one group of claims under common hypotheses. ``theorems()`` lists them all.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from derive.kernel import Poly
from derive.matrix.hypotheses import Hypotheses
from tests.reference.algebra import Expr, Setting, substitute


@dataclass(frozen=True)
class Theorem:
    """A claim = 0 (under a trace: tr claim = 0) and whether it is true."""

    name: str
    claim: Poly
    hypotheses: Hypotheses
    true: bool = True
    trace: bool = False
    provable: bool = True  # False: true for matrices, but not for operators in general


def theorem(name: str, claim: Expr, true: bool = True, trace: bool = False, provable: bool = True) -> Theorem:
    return Theorem(name, claim.poly, claim.setting.hypotheses, true, trace, provable)


def discrete_filter() -> Iterator[Theorem]:
    """The filter's covariance as a function of the gain, with cross-covariance S (Luenberger notes, 3 and 4)."""
    s = Setting()
    A, C, L, H = s.matrix("A", "n", "n"), s.matrix("C", "m", "n"), s.matrix("L", "n", "m"), s.matrix("H", "n", "m")
    P, Q, R = s.symmetric("P", "n", "psd"), s.symmetric("Q", "n", "psd"), s.symmetric("R", "m", "pd")
    S = s.matrix("S", "n", "m")
    innovation = C * P * C.T + R
    Si = s.inverse("Si", innovation)
    best = (A * P * C.T + S) * Si
    after = (A - L * C) * P * (A - L * C).T + Q - L * S.T - S * L.T + L * R * L.T
    least = A * P * A.T + Q - (A * P * C.T + S) * Si * (A * P * C.T + S).T
    square = (L - best) * innovation * (L - best).T
    yield theorem("completing the square, discrete", after - least - square)
    yield theorem("covariance at the best gain", substitute(after, "L", best) - least)
    slope = (H * C) * P * (L * C - A).T
    slope = slope + slope.T + H * R * L.T + L * R * H.T - H * S.T - S * H.T
    yield theorem("gradient of tr P in the gain", slope - 2 * ((L * innovation - A * P * C.T - S) * H.T), trace=True)


def discrete_filter_printed() -> Iterator[Theorem]:
    """The printed gain of the Luenberger notes (3) lacks A."""
    s = Setting()
    A, C = s.matrix("A", "n", "n"), s.matrix("C", "m", "n")
    P, Q, R = s.symmetric("P", "n", "psd"), s.symmetric("Q", "n", "psd"), s.symmetric("R", "m", "pd")
    Si = s.inverse("Si", C * P * C.T + R)
    after = Q + A * P * A.T - A * P * C.T * Si * C * P * A.T

    def covariance(L: Expr) -> Expr:
        return (A - L * C) * P * (A - L * C).T + Q + L * R * L.T

    yield theorem("(3) into (2) gives (4), corrected gain", covariance(A * P * C.T * Si) - after)
    yield theorem("(3) into (2) gives (4), printed gain", covariance(P * C.T * Si) - after, true=False)


def continuous_filter() -> Iterator[Theorem]:
    """Completing the square in continuous time, with cross intensity S."""
    s = Setting()
    A, C, L, S = s.matrix("A", "n", "n"), s.matrix("C", "m", "n"), s.matrix("L", "n", "m"), s.matrix("S", "n", "m")
    P, Q, R = s.symmetric("P", "n", "psd"), s.symmetric("Q", "n", "psd"), s.symmetric("R", "m", "pd")
    Ri = s.inverse("Ri", R)
    best = (P * C.T + S) * Ri
    rate = (A - L * C) * P + P * (A - L * C).T + Q - L * S.T - S * L.T + L * R * L.T
    least = A * P + P * A.T + Q - best * R * best.T
    yield theorem("completing the square, continuous", rate - least - (L - best) * R * (L - best).T)
    moved = A - S * Ri * C
    reduced = moved * P + P * moved.T + Q - S * Ri * S.T - P * C.T * Ri * C * P
    yield theorem("cross intensity moved into A and Q", least - reduced)


def observer_feedthrough() -> Iterator[Theorem]:
    """The observer's best gain when disturbance and measurement noise reach the output (observer notes)."""
    s = Setting()
    A, C, L = s.matrix("A", "n", "n"), s.matrix("C", "m", "n"), s.matrix("L", "n", "m")
    Bd, Dd, Dr = s.matrix("Bd", "n", "d"), s.matrix("Dd", "m", "d"), s.matrix("Dr", "m", "r")
    P, Sdd, Srr = s.symmetric("P", "n", "psd"), s.symmetric("Sdd", "d", "psd"), s.symmetric("Srr", "r", "psd")
    Sdr = s.matrix("Sdr", "d", "r")
    Bed, Ber = Bd - L * Dd, -(L * Dr)
    intensity = Bed * Sdd * Bed.T + Bed * Sdr * Ber.T + Ber * Sdr.T * Bed.T + Ber * Srr * Ber.T
    R = Dd * Sdd * Dd.T + Dd * Sdr * Dr.T + Dr * Sdr.T * Dd.T + Dr * Srr * Dr.T
    Ri = s.inverse("Ri", R)
    cross = P * C.T + Bd * Sdd * Dd.T + Bd * Sdr * Dr.T
    best = cross * Ri
    rate = (A - L * C) * P + P * (A - L * C).T + intensity
    least = A * P + P * A.T + Bd * Sdd * Bd.T - best * cross.T
    yield theorem("best gain with feedthrough", rate - least - (L - best) * R * (L - best).T)
    x, o, u, d, r = (s.matrix(v, k, "1") for v, k in (("x", "n"), ("o", "n"), ("u", "u"), ("d", "d"), ("r", "r")))
    B, Du = s.matrix("B", "n", "u"), s.matrix("Du", "m", "u")
    y, guess = C * x + Du * u + Dd * d + Dr * r, C * o + Du * u
    error = A * x + B * u + Bd * d - (A * o + B * u + L * (y - guess))
    yield theorem("error dynamics (31.10)", error - ((A - L * C) * (x - o) + Bed * d + Ber * r))


def filter_forms() -> Iterator[Theorem]:
    """Joseph, information and inversion forms of the measurement update."""
    s = Setting()
    C, P, R, one = s.matrix("C", "m", "n"), s.symmetric("P", "n", "pd"), s.symmetric("R", "m", "pd"), s.eye("n")
    Si = s.inverse("Si", C * P * C.T + R)
    K = P * C.T * Si
    yield theorem("Joseph form", (one - K * C) * P * (one - K * C).T + K * R * K.T - (one - K * C) * P)
    Pi, Ri = s.inverse("Pi", P), s.inverse("Ri", R)
    Y = s.inverse("Y", Pi + C.T * Ri * C)
    yield theorem("information form", Y - (P - P * C.T * Si * C * P))
    yield theorem("gain in information form", K - Y * C.T * Ri)
    yield theorem("matrix inversion lemma", Si - (Ri - Ri * C * Y * C.T * Ri))


def inverses() -> Iterator[Theorem]:
    """Identities between inverses."""
    s = Setting()
    A, U, C, V = (s.matrix(k, *t) for k, t in (("A", "nn"), ("U", "nm"), ("C", "mm"), ("V", "mn")))
    Ai, Ci = s.inverse("Ai", A), s.inverse("Ci", C)
    X, Y = s.inverse("X", A + U * C * V), s.inverse("Y", Ci + V * Ai * U)
    yield theorem("Woodbury, nonsymmetric", X - (Ai - Ai * U * Y * V * Ai))
    s = Setting()
    A, B = s.matrix("A", "n", "m"), s.matrix("B", "m", "n")
    X, Y = s.inverse("X", s.eye("n") + A * B), s.inverse("Y", s.eye("m") + B * A)
    yield theorem("push-through", A * Y - X * A)
    yield theorem("push-through under the trace", X * A * B - A * Y * B, trace=True)
    s = Setting()
    a, b = s.matrices("a b", "n", "n")
    ai, bi = s.inverse("ai", a), s.inverse("bi", b)
    X = s.inverse("X", bi - a)
    Y = s.inverse("Y", ai + X)
    yield theorem("Hua", a - Y - a * b * a)
    s = Setting()
    a, b = s.matrices("a b", "n", "n")
    ai, bi = s.inverse("ai", a), s.inverse("bi", b)
    X, Y = s.inverse("X", ai + bi), s.inverse("Y", a + b)
    yield theorem("parallel sum", X - a * Y * b)
    s = Setting()
    A, B = s.matrices("A B", "n", "n")
    X, Ai, Bi = s.inverse("X", A * B), s.inverse("Ai", A), s.inverse("Bi", B)
    yield theorem("(AB)^-1 = B^-1 A^-1", X - Bi * Ai)
    yield theorem("(AB)^-1 = A^-1 B^-1", X - Ai * Bi, true=False)
    s = Setting()
    A, B = s.matrices("A B", "n", "n")
    s.assume("AB = I", A * B - s.eye("n"))
    yield theorem("AB = I gives BA = I", B * A - s.eye("n"), provable=False)


def block_inverse() -> Iterator[Theorem]:
    """The inverse of a block matrix through the Schur complement."""
    s = Setting()
    A, B, C, D = (s.matrix(k, *t) for k, t in (("A", "nn"), ("B", "nm"), ("C", "mn"), ("D", "mm")))
    Ai = s.inverse("Ai", A)
    Z = s.inverse("Z", D - C * Ai * B)
    inverse = ((Ai + Ai * B * Z * C * Ai, -(Ai * B * Z)), (-(Z * C * Ai), Z))
    one = ((s.eye("n"), None), (None, s.eye("m")))
    for i, row in enumerate(((A, B), (C, D))):
        for j in (0, 1):
            product, target = row[0] * inverse[0][j] + row[1] * inverse[1][j], one[i][j]
            yield theorem(f"Schur block inverse {i}{j}", product - target if target else product)


def duality() -> Iterator[Theorem]:
    """The regulator's Riccati equation and gain under A -> A', B -> C'."""
    s = Setting()
    A, C, B = s.matrix("A", "n", "n"), s.matrix("C", "m", "n"), s.matrix("B", "n", "m")
    P, Q, R = s.symmetric("P", "n", "psd"), s.symmetric("Q", "n", "psd"), s.symmetric("R", "m", "pd")
    Sr, Sf = s.inverse("Sr", B.T * P * B + R), s.inverse("Sf", C * P * C.T + R)
    regulator, gain = A.T * P * A + Q - A.T * P * B * Sr * B.T * P * A, Sr * B.T * P * A
    estimator = A * P * A.T + Q - A * P * C.T * Sf * C * P * A.T

    def dual(expr: Expr) -> Expr:
        from derive.rules import substitute as replace

        images = {"A": A.T.poly, "B": C.T.poly, "Sr": Sf.poly}
        return Expr(replace(expr.poly, images, s.alphabet), s)

    yield theorem("regulator's equation maps to the filter's", dual(regulator) - estimator)
    yield theorem("regulator's gain maps to L'", dual(gain) - (A * P * C.T * Sf).T)
    yield theorem("regulator's gain maps to the printed L'", dual(gain) - (P * C.T * Sf).T, true=False)


def continuous_riccati() -> Iterator[Theorem]:
    """Consequences of the filter's algebraic Riccati equation in continuous time (Fang 2018, Theorem 1)."""
    s = Setting()
    A, C, t = s.matrix("A", "n", "n"), s.matrix("C", "m", "n"), s.scalar("s")
    P, W, V = s.symmetric("P", "n", "psd"), s.symmetric("W", "n", "psd"), s.symmetric("V", "m", "pd")
    Vi, one, eye = s.inverse("Vi", V), s.eye("n"), s.eye("m")
    F, G, K = s.inverse("F", t * one - A), s.inverse("G", -(t * one) - A), P * C.T * Vi
    s.assume("riccati", A * P + P * A.T + W - P * C.T * Vi * C * P)
    factors = (eye + C * F * K) * V * (eye + C * G * K).T
    yield theorem("spectral factorisation, continuous", factors - (C * F * W * G.T * C.T + V))
    Z = s.inverse("Z", t * one - A + K * C)
    yield theorem("inverse of the return difference", (eye + C * F * K) * (eye - C * Z * K) - eye)
    yield theorem("closed-loop Lyapunov form", (A - K * C) * P + P * (A - K * C).T + W + K * V * K.T)
    s = Setting()
    A, C = s.matrix("A", "n", "n"), s.matrix("C", "m", "n")
    P, W, V = s.symmetric("P", "n", "pd"), s.symmetric("W", "n", "psd"), s.symmetric("V", "m", "pd")
    Vi, Pi = s.inverse("Vi", V), s.inverse("Pi", P)
    s.assume("riccati", A * P + P * A.T + W - P * C.T * Vi * C * P)
    yield theorem("Riccati equation of P^-1", Pi * A + A.T * Pi + Pi * W * Pi - C.T * Vi * C)


def two_solutions() -> Iterator[Theorem]:
    """Two solutions of one Riccati equation; the Hamiltonian matrix is similar to a triangular one."""
    s = Setting()
    A, C = s.matrix("A", "n", "n"), s.matrix("C", "m", "n")
    P1, P2, W, V = (
        s.symmetric("P1", "n"),
        s.symmetric("P2", "n"),
        s.symmetric("W", "n", "psd"),
        s.symmetric("V", "m", "pd"),
    )
    Vi = s.inverse("Vi", V)
    for name, P in (("riccati 1", P1), ("riccati 2", P2)):
        s.assume(name, A * P + P * A.T + W - P * C.T * Vi * C * P)
    F1, F2 = A - P1 * C.T * Vi * C, A - P2 * C.T * Vi * C
    yield theorem("difference of two solutions", F1 * (P1 - P2) + (P1 - P2) * F2.T)
    del s.relations["riccati 2"], s.letters["P2"]
    zero, one, M = A - A, s.eye("n"), C.T * Vi * C
    hamiltonian, shear, back = ((A.T, -M), (-W, -A)), ((one, zero), (P1, one)), ((one, zero), (-P1, one))
    similar = multiply(back, multiply(hamiltonian, shear))
    target = ((F1.T, -M), (zero, -F1))
    for i in (0, 1):
        for j in (0, 1):
            yield theorem(f"Hamiltonian made triangular {i}{j}", similar[i][j] - target[i][j])


def multiply(a, b):
    """Multiply two 2 x 2 block matrices."""
    return tuple(tuple(a[i][0] * b[0][j] + a[i][1] * b[1][j] for j in (0, 1)) for i in (0, 1))


def differential() -> Iterator[Theorem]:
    """Differential equations of covariances; the derivatives are written out."""
    s = Setting()
    A, B, Phi = s.matrix("A", "n", "n"), s.matrix("B", "n", "m"), s.matrix("Phi", "n", "n")
    N, X0, J = s.symmetric("N", "m", "psd"), s.symmetric("X0", "n", "psd"), s.symmetric("J", "n", "psd")
    X = Phi * X0 * Phi.T + J
    rate = (A * Phi) * X0 * Phi.T + Phi * X0 * (A * Phi).T + A * J + J * A.T + B * N * B.T
    yield theorem("dX/dt = AX + XA' + BNB'", rate - (A * X + X * A.T + B * N * B.T))
    s = Setting()
    A, C, X, Y = s.matrix("A", "n", "n"), s.matrix("C", "m", "n"), s.matrix("X", "n", "n"), s.matrix("Y", "n", "n")
    W, V = s.symmetric("W", "n", "psd"), s.symmetric("V", "m", "pd")
    Vi, Xi = s.inverse("Vi", V), s.inverse("Xi", X)
    P, dX, dY = Y * Xi, -(A.T * X) + C.T * Vi * C * Y, W * X + A * Y
    rate = dY * Xi - Y * Xi * dX * Xi
    yield theorem("linear-fractional solution", rate - (A * P + P * A.T + W - P * C.T * Vi * C * P))


def discrete_riccati() -> Iterator[Theorem]:
    """Consequences of the filter's algebraic Riccati equation in discrete time."""
    s = Setting()
    A, C = s.matrix("A", "n", "n"), s.matrix("C", "m", "n")
    P, Q, R = s.symmetric("P", "n", "psd"), s.symmetric("Q", "n", "psd"), s.symmetric("R", "m", "pd")
    Si = s.inverse("Si", C * P * C.T + R)
    s.assume("riccati", A * P * A.T + Q - A * P * C.T * Si * C * P * A.T - P)
    L = A * P * C.T * Si
    yield theorem("closed-loop Stein form", (A - L * C) * P * (A - L * C).T + Q + L * R * L.T - P)
    Ri = s.inverse("Ri", R)
    Z = s.inverse("Z", s.eye("n") + C.T * Ri * C * P)
    yield theorem("P = A P (I + C'R^-1 C P)^-1 A' + Q", A * P * Z * A.T + Q - P)


def discrete_spectrum() -> Iterator[Theorem]:
    """Spectral factorisation on the circle z zi = 1."""
    s = Setting()
    A, C, z, zi = s.matrix("A", "n", "n"), s.matrix("C", "m", "n"), s.scalar("z"), s.scalar("zi")
    P, Q, R = s.symmetric("P", "n", "psd"), s.symmetric("Q", "n", "psd"), s.symmetric("R", "m", "pd")
    one, eye, innovation = s.eye("n"), s.eye("m"), C * P * C.T + R
    Si, F, G = s.inverse("Si", innovation), s.inverse("F", z * one - A), s.inverse("G", zi * one - A)
    s.central("z zi = 1", (1, ("z", "zi")), (-1, ()))
    s.assume("riccati", A * P * A.T + Q - A * P * C.T * Si * C * P * A.T - P)
    L = A * P * C.T * Si
    factors = (eye + C * F * L) * innovation * (eye + C * G * L).T
    yield theorem("spectral factorisation, discrete", factors - (C * F * Q * G.T * C.T + R))


def discrete_reduction() -> Iterator[Theorem]:
    """Cross-covariance moved into A and Q; difference of two steps; symmetry of the information step."""
    s = Setting()
    A, C, S = s.matrix("A", "n", "n"), s.matrix("C", "m", "n"), s.matrix("S", "n", "m")
    P, Q, R = s.symmetric("P", "n", "psd"), s.symmetric("Q", "n", "psd"), s.symmetric("R", "m", "pd")
    Ri, Si = s.inverse("Ri", R), s.inverse("Si", C * P * C.T + R)
    moved = A - S * Ri * C
    step = A * P * A.T + Q - (A * P * C.T + S) * Si * (A * P * C.T + S).T
    reduced = moved * P * moved.T + Q - S * Ri * S.T - moved * P * C.T * Si * C * P * moved.T
    yield theorem("cross-covariance moved into A and Q", step - reduced)
    s = Setting()
    A, C, Q, R = (
        s.matrix("A", "n", "n"),
        s.matrix("C", "m", "n"),
        s.symmetric("Q", "n", "psd"),
        s.symmetric("R", "m", "pd"),
    )
    P1, P2 = s.symmetric("P1", "n", "psd"), s.symmetric("P2", "n", "psd")
    S1, S2 = s.inverse("S1", C * P1 * C.T + R), s.inverse("S2", C * P2 * C.T + R)

    def step_of(P: Expr, Si: Expr) -> Expr:
        return A * P * A.T + Q - A * P * C.T * Si * C * P * A.T

    difference = (A - A * P1 * C.T * S1 * C) * (P1 - P2) * (A - A * P2 * C.T * S2 * C).T
    yield theorem("difference of two Riccati steps", step_of(P1, S1) - step_of(P2, S2) - difference)
    s = Setting()
    H, P, one = s.symmetric("H", "n", "psd"), s.symmetric("P", "n", "psd"), s.eye("n")
    Z = s.inverse("Z", one + H * P)
    yield theorem("P (I + H P)^-1 is symmetric", P * Z - (P * Z).T)
    Y = s.inverse("Y", one + P * H)
    yield theorem("P (I + H P)^-1 = (I + P H)^-1 P", P * Z - Y * P)


def scaled_resolvents() -> Iterator[Theorem]:
    """Rules whose leading coefficient is a central scalar."""
    s = Setting()
    F, B, t = s.matrix("F", "n", "n"), s.matrix("B", "n", "n"), s.scalar("s")
    s.assume("s F = B", t * F - B)
    yield theorem("s F = B makes F and B commute", B * F - F * B)
    s = Setting()
    A, t, q = s.matrix("A", "n", "n"), s.scalar("s"), s.scalar("q")
    F, G = s.inverse("F", t * s.eye("n") - A), s.inverse("G", q * s.eye("n") - A)
    yield theorem("resolvent identity", F - G - (q * (F * G) - t * (F * G)))
    s = Setting()
    X, Y, z, zi = s.matrix("X", "n", "m"), s.matrix("Y", "n", "m"), s.scalar("z"), s.scalar("zi")
    s.central("z zi = 1", (1, ("z", "zi")), (-1, ()))
    s.assume("z X = Y", z * X - Y)
    yield theorem("division by z through its inverse", X - zi * Y)


GROUPS = (
    discrete_filter, discrete_filter_printed, continuous_filter, observer_feedthrough, filter_forms, inverses,
    block_inverse, duality, continuous_riccati, two_solutions, differential, discrete_riccati, discrete_spectrum,
    discrete_reduction, scaled_resolvents,
)  # fmt: skip


def theorems() -> list[Theorem]:
    """Return every theorem, true and false."""
    return [t for group in GROUPS for t in group()]
