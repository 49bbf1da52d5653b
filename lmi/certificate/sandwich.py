"""Exact certificates: matrices that sandwich the optimal error covariance, verified with integers alone.

For a symmetric P and a gain L, and in discrete time with Q, R, S for the plant's W, V, N,
    continuous: G_L(P) = (A - L C) P + P (A - L C)' + W - L N' - N L' + L V L',
                F(P) = [[A P + P A' + W, P C' + N], [(P C' + N)', V]];
    discrete:   G_L(P) = (A - L C) P (A - L C)' - P + Q - L S' - S L' + L R L',
                F(P) = [[A P A' - P + Q, A P C' + S], [(A P C' + S)', C P C' + R]].
A certificate (P_lo, P_up, X, L) of a plant is verified when, decided in integers,
    V > 0 (discrete: C P_lo C' + R > 0), F(P_lo) >= 0, X > 0, G_L(P_up) <= 0,
    (A - L C) X + X (A - L C)' < 0 (discrete: (A - L C) X (A - L C)' - X < 0).

Theorem. Then A - L C is stable, every gain K with A - K C stable has an error covariance P_K >= P_lo, and
P_lo <= P* <= P_L <= P_up. Here P* is the greatest solution of the Riccati equation (discrete: with C P C' + R > 0) and
the infimum of all P_K. It is the one solution whose closed loop has no unstable mode: the stabilising one, or the
strong one where modes stay on the boundary. The noise need not be semidefinite for this; where it is not, P_K is the
solution of G_K(P_K) = 0 and no covariance.

Proof. [I, -K] F(P) [I, -K]' = G_K(P), so that G_K(P_lo) >= 0, and P_lo <= P_K by comparison. X proves A - L C stable
(Lyapunov, Stein), and P_L <= P_up by comparison. Kleinman's iteration K <- optimal gain of P_K, from K = L, stays
stable and falls to P* >= P_lo. Each step is in docs/certificates.md.

Nothing here comes from a solver, and only the standard library is used.
"""

from dataclasses import dataclass
from fractions import Fraction
from typing import TYPE_CHECKING, Literal

from derive.errors import InputError
from lmi.certificate.arithmetic import Exact, TooLargeError, is_definite, is_semidefinite, symmetric_block

if TYPE_CHECKING:
    from derive.numeric.plant import Plant

__all__ = ["Bounds", "Certificate", "Check", "ExactPlant", "Interval", "exact_plant", "verify"]

WEIGHT_SHIFTS = (60, 40, 20)
"""Powers of two by which a shift of a weight is smaller than the weight, tried before one that surely suffices."""


@dataclass(frozen=True)
class ExactPlant:
    """A plant whose numbers are rationals: A (n, n), C (l, n), W (n, n), V (l, l), N (n, l) and the weight M (n, n)."""

    time: Literal["continuous", "discrete"]
    A: Exact
    C: Exact
    W: Exact
    V: Exact
    N: Exact
    M: Exact

    def __post_init__(self) -> None:
        n, l = self.n, self.l  # noqa: E741
        for name, shape in {"A": (n, n), "C": (l, n), "W": (n, n), "V": (l, l), "N": (n, l), "M": (n, n)}.items():
            require_shape(name, getattr(self, name), shape, symmetric=name in ("W", "V", "M"))

    @property
    def n(self) -> int:
        """Number of states."""
        return self.A.shape[0]

    @property
    def l(self) -> int:  # noqa: E743 (the field's letter for the number of outputs)
        """Number of outputs."""
        return self.C.shape[0]

    @property
    def is_continuous(self) -> bool:
        """Whether time is continuous."""
        return self.time == "continuous"

    def differs_in(self, other: "ExactPlant") -> str:
        """Return the first key in which two plants differ, or nothing."""
        if self.time != other.time:
            return "time"
        return next((k for k in ("A", "C", "W", "V", "N", "M") if not getattr(self, k).equals(getattr(other, k))), "")

    def loop(self, gain: Exact) -> Exact:
        """Return A - L C."""
        return self.A - gain @ self.C

    def drift(self, loop: Exact, P: Exact) -> Exact:
        """Return loop P + P loop', in discrete time loop P loop' - P."""
        moved = loop @ P
        return moved + moved.T if self.is_continuous else moved @ loop.T - P

    def defect(self, gain: Exact, P: Exact) -> Exact:
        """Return G_L(P)."""
        cross = gain @ self.N.T
        return self.drift(self.loop(gain), P) + self.W - cross - cross.T + gain @ self.V @ gain.T

    def innovation(self, P: Exact) -> Exact:
        """Return V, in discrete time C P C' + R."""
        return self.V if self.is_continuous else self.C @ P @ self.C.T + self.V

    def inequality(self, P: Exact, gain: Exact) -> Exact:
        """Return F(P) congruent by [[I, -L], [0, I]], outputs first: [[S, (Y - L S)'], [.., G_L(P)]].

        S is the innovation's covariance and Y = P C' + N, in discrete time A P C' + S: the sign of F(P) is unchanged,
        and with a gain near the optimal one the blocks aside are small.
        """
        S = self.innovation(P)
        Y = (P if self.is_continuous else self.A @ P) @ self.C.T + self.N
        return symmetric_block(S, (Y - gain @ S).T, self.defect(gain, P))


def require_shape(name: str, X: Exact, shape: tuple[int, int], *, symmetric: bool = False) -> None:
    """Refuse a matrix of another shape, or one that ought to be symmetric and is not.

    Raises:
        InputError: says what was expected and what was got.
    """
    if X.shape != shape:
        raise InputError(f"{name}: expected shape {shape}, got {X.shape}; states are counted by A, outputs by C")
    if symmetric and not X.is_symmetric:
        raise InputError(f"{name}: expected a symmetric matrix, got one that differs from its transpose; correct it")


@dataclass(frozen=True)
class Certificate:
    """What is claimed to sandwich the optimum: symmetric P_lo, P_up, X (n, n) and the gain L (n, l)."""

    plant: ExactPlant
    P_lo: Exact
    P_up: Exact
    X: Exact
    gain: Exact

    def __post_init__(self) -> None:
        n = self.plant.n
        for name in ("P_lo", "P_up", "X"):
            require_shape(name, getattr(self, name), (n, n), symmetric=True)
        require_shape("gain", self.gain, (n, self.plant.l))


@dataclass(frozen=True)
class Check:
    """One inequality of the theorem, and whether the numbers satisfy it exactly."""

    statement: str
    holds: bool


@dataclass(frozen=True)
class Interval:
    """A number between two rationals."""

    lower: Fraction
    upper: Fraction

    @property
    def width(self) -> Fraction:
        """upper - lower."""
        return self.upper - self.lower


@dataclass(frozen=True)
class Bounds:
    """What a verified certificate proves; every interval holds the value of P* and that of P_L, with P* <= P_L.

    Attributes:
        trace: tr P.
        variances: the diagonal of P.
        cost: tr(M P).
        is_covariance: whether [[W, N], [N', V]] >= 0 exactly, so that P is a covariance and no variance is negative;
            None when that takes too long to decide.
    """

    trace: Interval
    variances: tuple[Interval, ...]
    cost: Interval
    is_covariance: bool | None


def exact_plant(plant: "Plant") -> ExactPlant:
    """Take the plant's doubles for the rationals that they are."""
    matrices = {key: Exact.of_floats(getattr(plant, key).tolist()) for key in ("A", "C", "W", "V", "N", "M")}
    return ExactPlant(plant.time, **matrices)


def checks(certificate: Certificate) -> tuple[Check, ...]:
    """Decide every inequality of the theorem, in integers."""
    plant, gain, P_lo = certificate.plant, certificate.gain, certificate.P_lo
    loop_X = plant.drift(plant.loop(gain), certificate.X)
    V, stable = ("V", "(A - LC)X + X(A - LC)'") if plant.is_continuous else ("CP_loC' + R", "(A - LC)X(A - LC)' - X")
    return (
        Check(f"{V} > 0", is_definite(plant.innovation(P_lo))),
        Check("F(P_lo) >= 0", is_semidefinite(plant.inequality(P_lo, gain))),
        Check("X > 0", is_definite(certificate.X)),
        Check(f"{stable} < 0", is_definite(-loop_X)),
        Check("G_L(P_up) <= 0", is_semidefinite(-plant.defect(gain, certificate.P_up))),
    )


def verify(certificate: Certificate) -> tuple[tuple[Check, ...], Bounds | None]:
    """Decide the inequalities, and return what they prove; nothing when one of them fails."""
    found = checks(certificate)
    return found, _bounds(certificate) if all(check.holds for check in found) else None


def _bounds(certificate: Certificate) -> Bounds:
    plant, P_lo, P_up = certificate.plant, certificate.P_lo, certificate.P_up
    is_covariance = _semidefinite_if_known(symmetric_block(plant.W, plant.N, plant.V))
    floor = [max(P_lo[i, i], Fraction(0)) if is_covariance else P_lo[i, i] for i in range(plant.n)]
    variances = tuple(Interval(low, P_up[i, i]) for i, low in enumerate(floor))
    trace = Interval(sum(floor, Fraction(0)), sum((x.upper for x in variances), Fraction(0)))
    return Bounds(trace, variances, _cost(certificate, is_covariance), is_covariance)


def _semidefinite_if_known(M: Exact) -> bool | None:
    try:
        return is_semidefinite(M)
    except TooLargeError:
        return None


def _cost(certificate: Certificate, is_covariance: bool | None) -> Interval:
    """Bound tr(M P) where P_lo <= P <= P_up.

    M >= 0 gives tr(M P_lo) <= tr(M P) <= tr(M P_up). Where only M + d I >= 0, both move outwards by d tr(P_up - P_lo).
    """
    M, gap = certificate.plant.M, certificate.P_up - certificate.P_lo
    shift = _shift(M)
    slack = shift * gap.trace_of_product(Exact.identity(certificate.plant.n))
    lower, upper = (M.trace_of_product(P) for P in (certificate.P_lo, certificate.P_up))
    lower = max(lower, Fraction(0)) if is_covariance and shift == 0 else lower - slack
    return Interval(lower, upper + slack)


def _shift(M: Exact) -> Fraction:
    """Return a d >= 0 with M + d I >= 0, tiny where M is semidefinite but for rounding."""
    if _semidefinite_if_known(M):
        return Fraction(0)
    size = max(sum((abs(M[i, j]) for j in range(M.shape[1])), Fraction(0)) for i in range(M.shape[0]))
    identity = Exact.identity(M.shape[0])
    tried = (size / (1 << bits) for bits in WEIGHT_SHIFTS)
    return next((d for d in tried if _semidefinite_if_known(M + identity * d)), size)
