"""Finding certificates that no gain has a smaller H-infinity norm; `lmi.certificate.design` decides.

For a level g above the smallest let P solve the filtering Riccati equation (F, q: the plant without its cross term)
    continuous: F P + P F' + q - P (C'V^-1 C - g^-2 M) P = 0,
    discrete:   P = F U F' + q,  U = (P^-1 + C'V^-1 C - g^-2 M)^-1.
Then H = P^-1 (and K = U F'H) make T = F + q H antistable (K Schur, T = I), any R >= 0 gives a certificate with
T Z + Z T' = R (Z - K Z K' = R), and among R = v v' the best v is an eigenvector: both traces in the bound are quadratic
in v. As g falls to the smallest level, the bound rises to it.

Stable modes that the noise leaves alone make P singular. They are split off exactly: Z vanishes on them.
"""

from collections.abc import Iterator
from dataclasses import dataclass, replace
from fractions import Fraction
from math import sqrt
from typing import Any, cast

import numpy as np
from flint import arb, arb_mat
from numpy.typing import NDArray

from derive.numeric.balls import exact, identity, middle, working_bits
from derive.numeric.lyapunov import solve_lyapunov
from derive.numeric.newton import lyapunov_in_balls
from derive.numeric.plant import Plant
from lmi.certificate.arithmetic import Exact
from lmi.certificate.design import Floor, floor_checks, proper, reduced_noise
from lmi.certificate.sandwich import ExactPlant
from lmi.certification.boundary import Reduced, without_forgotten
from lmi.certification.frame import Grid, sizes
from lmi.certification.instability import is_stable
from lmi.certification.sandwich import NotCertifiedError
from lmi.scaling import balanced, scaled_plant

__all__ = ["certified_floor"]

Matrix = NDArray[np.floating[Any]]

BITS = 320
"""Working precision."""

LOSS_BITS = 30
"""R = v v' + 2^-k I with a k that lowers the bound by about 2^-30, relative: what rounding may take away."""

MARGIN_BITS = 120
"""Largest k."""

SPARE = 16
"""Bits by which the grid is finer than that."""

ABOVE = tuple(10.0**-k for k in range(4, 14))
"""By how much the level exceeds the smallest one, relative; the best certificate is taken."""

AXIS_RTOL = 1e-12
"""Eigenvalues nearer to the boundary than this, relative, have no side."""

SYMMETRIC_RTOL = 1e-6
"""A solution that is less symmetric than this, relative, is none."""

DOUBLINGS = 60
HALVINGS = 50
LEVEL_RTOL = 1e-14


def certified_floor(plant: ExactPlant, floor: float, reached: float) -> Floor:
    """Prove that no stabilising gain has an H-infinity norm below `floor`.

    Args:
        plant: as it is; its noise and weight are enlarged as the verifier does where they are not semidefinite.
        floor: to be proved.
        reached: a norm that some gain reaches, or a guess of one.

    Raises:
        NotCertifiedError: no proof found.
    """
    if not floor > 0:
        raise NotCertifiedError(f"floor {floor:g}: expected a positive norm")
    plant, _, semidefinite = proper(plant)
    if not all(check.holds for check in semidefinite):
        raise NotCertifiedError("floor: the noise or the weight is not semidefinite")
    best = 0.0
    for found in _proposals(plant, floor, reached):
        checks, squared = floor_checks(plant, found)
        if squared is not None and all(check.holds for check in checks):
            if squared >= Fraction(floor) ** 2:
                return found
            best = max(best, sqrt(squared))
    proved = f", proved is {best:.10g}" if best else ""
    raise NotCertifiedError(f"floor {floor:.10g}: no proof that every gain has at least that H-infinity norm{proved}")


def _proposals(plant: ExactPlant, floor: float, reached: float) -> Iterator[Floor]:
    """Iterate over certificates, what looks like the best one first."""
    reduced = without_forgotten(plant)
    if reduced is not None and reduced.m == 0:
        raise NotCertifiedError("floor: the noise leaves every mode alone that does not decay by itself")
    filtering = Filtering.of(plant if reduced is None else reduced.smaller(plant))
    smallest = filtering.smallest_level(floor, max(reached, floor))
    levels = [level for level in (filtering.level(smallest * (1 + share)) for share in ABOVE) if level is not None]
    for level in sorted(levels, key=lambda level: -level.bound)[:3]:
        try:
            with working_bits(BITS):
                found = filtering.certificate(level)
                yield found if reduced is None else _lifted(found, reduced)
        except (ArithmeticError, ValueError):
            continue


def _lifted(floor: Floor, reduced: Reduced) -> Floor:
    """Return Z = U Z_r U', U'H U = H_r and K U = U K_r for the whole plant: F U = U F_r, q = U q_r U'."""
    left = reduced.left_inverse()
    K = None if floor.K is None else reduced.basis @ floor.K @ left
    return Floor(reduced.lifted(floor.Z), left.T @ floor.H @ left, K)


@dataclass(frozen=True, eq=False)
class Level:
    """What a level above the smallest one gives, in floating point and balanced coordinates.

    Attributes:
        H: P^-1 (n, n).
        K: U F'H (n, n); None in continuous time.
        v: of R = v v' + 2^-margin I (n,), |v| = 1.
        margin: in bits.
        bound: of the norm of every gain.
    """

    H: Matrix
    K: Matrix | None
    v: Matrix
    margin: int
    bound: float


@dataclass(frozen=True, eq=False)
class Filtering:
    """The filtering Riccati equation of a plant, in balanced coordinates x = t x_balanced, t powers of two.

    Attributes:
        exact: the plant, without its cross term.
        plant: the same in floating point and balanced coordinates.
        unit: an H-infinity norm of 1 in these coordinates is this much in the plant's.
        rate: 1 in these coordinates is this rate [1/s] in the plant's.
        exponents: of t.
    """

    exact: ExactPlant
    plant: Plant
    unit: float
    rate: float
    exponents: tuple[int, ...]

    @classmethod
    def of(cls, plant: ExactPlant) -> "Filtering":
        """Remove the cross term and balance."""
        F, q, _ = reduced_noise(plant)
        zero = Exact(((0,) * plant.l,) * plant.n)
        simple = replace(plant, A=F, W=q, N=zero)
        A, C, W, V, N, M = (_floats(getattr(simple, key)) for key in ("A", "C", "W", "V", "N", "M"))
        numeric = Plant(time=plant.time, A=A, C=C, W=(W + W.T) / 2, V=V, N=N, M=M)
        scaling = balanced(numeric)
        t = np.diag(scaling.T)
        weight = M * np.outer(t, t)
        size = float(np.linalg.norm(weight, 2)) or 1.0
        scaled = replace(scaled_plant(numeric, scaling), M=weight / size)
        exponents = tuple(int(k) for k in np.round(np.log2(t)))
        return cls(simple, scaled, float(np.sqrt(size / scaling.rate)), scaling.rate, exponents)

    def smallest_level(self, floor: float, reached: float) -> float:
        """Return the smallest level at which the Riccati equation has the solution sought, by bisection.

        Raises:
            NotCertifiedError: the floor is above it, or there is none.
        """
        lower, upper = floor, reached
        if self.level(lower) is not None:
            raise NotCertifiedError(f"floor {floor:.10g}: some gain seems to have a smaller H-infinity norm")
        for _ in range(DOUBLINGS):
            if self.level(upper) is not None:
                break
            lower, upper = upper, upper * (1 + 1e-6) if upper == reached else 2 * upper
        else:
            raise NotCertifiedError("floor: no level found at which the filtering Riccati equation has a solution")
        for _ in range(HALVINGS):
            if upper - lower <= LEVEL_RTOL * upper:
                break
            centre = (lower + upper) / 2
            lower, upper = (lower, centre) if self.level(centre) is not None else (centre, upper)
        return upper

    def level(self, gamma: float) -> Level | None:
        """Solve the Riccati equation at a level; None when it has no suitable solution."""
        try:
            with np.errstate(all="ignore"):
                return self._level((self.unit / gamma) ** 2)
        except (np.linalg.LinAlgError, ValueError):
            return None

    def _level(self, weight: float) -> Level | None:
        plant, weighted = self.plant, weight * self.plant.M
        information = plant.C.T @ np.linalg.solve(plant.V, plant.C)
        H = (_inverse_filtering if plant.is_continuous else _inverse_prediction)(plant, information - weighted)
        if H is None or np.linalg.eigvalsh(H if plant.is_continuous else H - weighted)[0] <= 0:
            return None
        K = None if plant.is_continuous else np.linalg.solve(H + information - weighted, plant.A.T @ H)
        carried = -(plant.A + plant.W @ H) if K is None else K
        if not is_stable(carried, plant.time):
            return None
        price = H.T @ plant.W @ H + (information if K is None else K.T @ information @ K)
        return self._best(H, K, carried, price)

    def _best(self, H: Matrix, K: Matrix | None, carried: Matrix, price: Matrix) -> Level | None:
        """Choose v: tr(M Z) and the price of Z are v'X v with X the solutions of adjoint Lyapunov equations."""
        from scipy.linalg import eigh

        gained, paid = (solve_lyapunov(carried.T, X, self.plant.time) for X in (self.plant.M, price))
        paid = paid + 1e-14 * np.linalg.norm(paid, 2) * np.eye(len(paid))
        values, vectors = cast(tuple[Matrix, Matrix], eigh(gained, paid))
        v = vectors[:, -1] / np.linalg.norm(vectors[:, -1])
        margin = LOSS_BITS + int(np.ceil(np.log2(max(np.trace(paid) / (v @ paid @ v), 1.0))))
        return Level(H, K, v, min(margin, MARGIN_BITS), self.unit * float(np.sqrt(max(values[-1], 0.0))))

    def certificate(self, level: Level) -> Floor:
        """Bring H and K to the plant's coordinates, exactly, and solve for Z in high precision."""
        n, grid = self.plant.n, Grid(self.exponents)
        H = self._moved(level.H, -1, -1)
        K = None if level.K is None else self._moved(level.K, 1, -1)
        v = exact(level.v[:, None])
        R = v * v.transpose() + identity(n) * arb(2) ** -level.margin
        F, q = self._balls(self.exact.A, -1, 1), self._balls(self.exact.W, -1, -1)
        H_balls = exact(level.H)
        if level.K is None:
            T = (F + q * H_balls) * (1 / arb(self.rate))
            Z = middle(lyapunov_in_balls((-T).mid(), R, "continuous"))
            return Floor(grid.covariance(Z, level.margin + sizes(T) + SPARE), H)
        K_balls = exact(level.K)
        excess = F * K_balls + q * H_balls - identity(n)
        Z = middle(lyapunov_in_balls(K_balls, R, "discrete"))
        for _ in range(8):
            correction = excess * Z
            Z = middle(lyapunov_in_balls(K_balls, middle(R - correction - correction.transpose()), "discrete"))
        return Floor(grid.covariance(Z, level.margin + sizes(K_balls) + SPARE), H, K)

    def _moved(self, X: Matrix, left: int, right: int) -> Exact:
        """Return t^left X t^right as rationals."""
        t = [Fraction(2) ** k for k in self.exponents]
        return Exact.of(
            [
                [Fraction(x) * t[i] ** left * t[j] ** right for j, x in enumerate(row)]
                for i, row in enumerate(X.tolist())
            ]
        )

    def _balls(self, X: Exact, left: int, right: int) -> arb_mat:
        """Return t^left X t^right as balls."""
        t = [arb(2) ** k for k in self.exponents]
        rows = enumerate(X.numerators)
        return arb_mat(
            [[arb(x) / X.denominator * t[i] ** left * t[j] ** right for j, x in enumerate(row)] for i, row in rows]
        )


def _inverse_filtering(plant: Plant, curvature: Matrix) -> Matrix | None:
    """Return H = P^-1, F P + P F' + q - P (curvature) P = 0: [I; H]^-1 spans a stable subspace of a Hamiltonian matrix.

    SciPy's solver of Riccati equations answers also where no stabilising solution exists.
    """
    from scipy.linalg import schur

    n = plant.n
    hamiltonian = np.block([[plant.A.T, -curvature], [-plant.W, -plant.A]])
    size = np.linalg.norm(hamiltonian, 2)
    if np.abs(np.linalg.eigvals(hamiltonian).real).min() <= AXIS_RTOL * size:
        return None
    _, vectors, stable = cast(tuple[Matrix, Matrix, int], schur(hamiltonian, sort="lhp"))
    if stable != n:
        return None
    H = np.linalg.solve(vectors[n:, :n].T, vectors[:n, :n].T)
    return _symmetric(H)


def _inverse_prediction(plant: Plant, curvature: Matrix) -> Matrix | None:
    """Return H = P^-1, P = F (P^-1 + curvature)^-1 F' + q: [H; I] spans a stable subspace of a symplectic pencil."""
    from scipy.linalg import ordqz

    n, one, zero = plant.n, np.eye(plant.n), np.zeros((plant.n, plant.n))
    left = np.block([[plant.A.T, zero], [-plant.W, one]])
    right = np.block([[one, curvature], [zero, plant.A]])
    *_, alpha, beta, _, vectors = ordqz(left, right, sort="iuc", output="real")
    sizes = np.abs(alpha) - np.abs(beta)
    if np.abs(sizes).min() <= AXIS_RTOL * np.maximum(np.abs(alpha), np.abs(beta)).max() or np.sum(sizes < 0) != n:
        return None
    H = np.linalg.solve(vectors[n:, :n].T, vectors[:n, :n].T)
    return _symmetric(H)


def _symmetric(H: Matrix) -> Matrix | None:
    if not np.isfinite(H).all() or np.abs(H - H.T).max() > SYMMETRIC_RTOL * np.abs(H).max():
        return None
    return (H + H.T) / 2


def _floats(X: Exact) -> Matrix:
    return np.array([[float(Fraction(x, X.denominator)) for x in row] for row in X.numerators])
