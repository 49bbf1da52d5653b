"""The subspace of unexcited boundary modes in rational arithmetic, off which the covariance is bounded from below.

With F = A - N V^-1 C and q = W - N V^-1 N', let Z span the left-invariant subspace of F on which all modes are on the
boundary and q Z = 0. P* vanishes on it, F(P) >= 0 leaves no room there, and only a P_lo with P_lo Z = 0 exactly can be
close to P*. With U spanning the complement, F U = U F_r, q = U q_r U', and for P = U Pi U' the Riccati operator is
U (that of F_r, C U, q_r at Pi) U': a strict lower bound Pi of the smaller plant gives F(P) >= 0.
"""

from collections.abc import Callable
from dataclasses import dataclass
from fractions import Fraction
from typing import Any, cast

from flint import fmpq, fmpq_mat, fmpq_poly

from lmi.certificate.arithmetic import Exact
from lmi.certificate.sandwich import ExactPlant

__all__ = ["Reduced", "unseen", "without_boundary", "without_forgotten"]

LARGEST = 60
"""States up to which polynomials are factored in seconds."""

CLOSE = 1e-15
"""Distance of a computed root from the boundary, relative to 1 + its size, below which an irreducible factor that is
its own mirror image is taken to have its roots there."""


@dataclass(frozen=True, eq=False)
class Reduced:
    """A plant without its unexcited boundary modes, and without its cross term.

    Attributes:
        Z: basis (n, n - m) of the left-invariant subspace of the modes that are removed, Z'F = T Z'.
        U: basis (n, m) of the states that are kept, Z'U = 0, P = U Pi U'.
        F: state matrix (m, m).
        C: output matrix (l, m).
        q: process noise (m, m).
        V: measurement noise (l, l).
    """

    Z: fmpq_mat
    U: fmpq_mat
    F: fmpq_mat
    C: fmpq_mat
    q: fmpq_mat
    V: fmpq_mat

    @property
    def m(self) -> int:
        """Number of states that are kept."""
        return self.U.ncols()

    def lifted(self, Pi: Exact) -> Exact:
        """Return U Pi U'."""
        return self.basis @ Pi @ self.basis.T

    @property
    def basis(self) -> Exact:
        """U."""
        return _exact(self.U)

    def smaller(self, plant: ExactPlant) -> ExactPlant:
        """Return the plant of the states that are kept, without its cross term."""
        M = self.U.transpose() * _rational(plant.M) * self.U
        A, C, W, V, weight = (_exact(X) for X in (self.F, self.C, self.q, self.V, M))
        return ExactPlant(plant.time, A, C, W, V, Exact(((0,) * plant.l,) * self.m), weight)

    def left_inverse(self) -> Exact:
        """Return (U'U)^-1 U'."""
        return _exact((self.U.transpose() * self.U).solve(self.U.transpose()))


def without_boundary(plant: ExactPlant) -> Reduced | None:
    """Remove the unexcited boundary modes, found exactly; None when there are none, or the plant is large."""
    return _without(plant, lambda polynomial: _boundary_factor(polynomial, plant.is_continuous))


def without_forgotten(plant: ExactPlant) -> Reduced | None:
    """Remove the unexcited modes that are stable or on the boundary; None when there are none, or the plant is large.

    A polynomial whose roots are on both sides is left alone.
    """
    return _without(plant, lambda polynomial: _forgotten_factor(polynomial, plant.is_continuous))


def unseen(plant: ExactPlant) -> tuple[Exact, Exact] | None:
    """Return U (n, m) and T (m, m) with A U = U T and C U = 0, m as large as possible; None when the plant is large."""
    if plant.n > LARGEST:
        return None
    A, C = _rational(plant.A), _rational(plant.C)
    U = _unexcited(A.transpose(), C.transpose() * C)
    if U is None:
        return None
    return _exact(U), _exact((U.transpose() * U).solve(U.transpose() * A * U))


def _without(plant: ExactPlant, chosen: Callable[[fmpq_poly], fmpq_poly]) -> Reduced | None:
    if plant.n > LARGEST:
        return None
    A, C, W, V, N = (_rational(X) for X in (plant.A, plant.C, plant.W, plant.V, plant.N))
    gain = V.solve(N.transpose()).transpose()
    F, q = A - gain * C, W - gain * N.transpose()
    Z = _unexcited(F, q)
    if Z is None:
        return None
    T = (Z.transpose() * Z).solve(Z.transpose() * F.transpose() * Z)
    annihilator = chosen(T.charpoly())
    Y = _kernel(_evaluated(annihilator, T))
    if Y is None:
        return None
    Z = Z * Y
    U = _kernel(Z.transpose())
    if U is None:
        nothing = fmpq_mat(0, 0)
        return Reduced(Z, fmpq_mat(plant.n, 0), nothing, fmpq_mat(plant.l, 0), nothing, V)
    left = (U.transpose() * U).solve(U.transpose())
    return Reduced(Z, U, left * F * U, C * U, left * q * left.transpose(), V)


def _unexcited(F: fmpq_mat, q: fmpq_mat) -> fmpq_mat | None:
    """Return a basis Z of the largest subspace with F'Z in its span and q Z = 0."""
    Z = _kernel(q)
    while Z is not None:
        outside = _kernel(Z.transpose())
        if outside is None:
            return Z
        Y = _kernel(outside.transpose() * F.transpose() * Z)
        if Y is None or Y.ncols() == Z.ncols():
            return Z if Y is not None else None
        Z = Z * Y
    return None


def _boundary_factor(polynomial: fmpq_poly, continuous: bool) -> fmpq_poly:
    """Return the product of the factors of a polynomial whose roots are on the boundary."""
    product = fmpq_poly([1])
    for factor, power in polynomial.factor()[1]:
        roots = cast(Any, factor.numer().complex_roots())
        if _mirrored(factor, continuous) and all(_on_boundary(complex(root), continuous) for root, _ in roots):
            product *= factor**power
    return product


def _forgotten_factor(polynomial: fmpq_poly, continuous: bool) -> fmpq_poly:
    """Return the product of the factors of a polynomial whose roots are stable or on the boundary."""
    product = fmpq_poly([1])
    for factor, power in polynomial.factor()[1]:
        roots = [complex(root) for root, _ in cast(Any, factor.numer().complex_roots())]
        if all((root.real if continuous else abs(root) - 1) <= CLOSE * (1 + abs(root)) for root in roots):
            product *= factor**power
    return product


def _mirrored(factor: fmpq_poly, continuous: bool) -> bool:
    """Tell whether the mirror image of each root in the boundary is a root: p(-s) = +-p(s), z^n p(1/z) = +-p(z)."""
    coefficients = factor.coeffs()
    image = [(-1) ** k * c for k, c in enumerate(coefficients)] if continuous else coefficients[::-1]
    return image in (coefficients, [-c for c in coefficients])


def _on_boundary(root: complex, continuous: bool) -> bool:
    distance = root.real if continuous else abs(root) - 1
    return abs(distance) <= CLOSE * (1 + abs(root))


def _evaluated(polynomial: fmpq_poly, T: fmpq_mat) -> fmpq_mat:
    """Return p(T)."""
    n = T.nrows()
    identity = fmpq_mat(n, n, [int(i == j) for i in range(n) for j in range(n)])
    result = fmpq_mat(n, n)
    for coefficient in reversed(polynomial.coeffs()):
        result = result * T + identity * coefficient
    return result


def _kernel(X: fmpq_mat) -> fmpq_mat | None:
    """Return a basis (columns) of the kernel, or None when it is trivial."""
    reduced, rank = X.rref()
    n = X.ncols()
    if rank == n:
        return None
    rows = reduced.tolist()[:rank]
    pivots = [next(j for j, x in enumerate(row) if x != 0) for row in rows]
    free = [j for j in range(n) if j not in pivots]
    basis = fmpq_mat(n, len(free))
    for k, j in enumerate(free):
        basis[j, k] = fmpq(1)
        for i, pivot in enumerate(pivots):
            basis[pivot, k] = -rows[i][j]
    return basis


def _rational(X: Exact) -> fmpq_mat:
    return fmpq_mat([[fmpq(x, X.denominator) for x in row] for row in X.numerators])


def _exact(X: fmpq_mat) -> Exact:
    return Exact.of([[_fraction(x) for x in row] for row in X.tolist()])


def _fraction(x: fmpq) -> Fraction:
    return Fraction(int(x.p), int(x.q))
