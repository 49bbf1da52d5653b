"""Exact certificates of a gain: its cost, the decay of its modes, its H-infinity norm, and how small that can be.

With G_L(P) as in `lmi.certificate`, J = [[W, N], [N', V]] (discrete: Q, S, R), M the weight, and for a gain L
    T_L(s) = M^1/2 (s I - A + L C)^-1 [I, -L] J^1/2,   |T_L| its largest singular value over the boundary of stability,
a certificate is verified when, decided in integers and beside the inequalities of `lmi.certificate`,
    decay a (discrete: radius r):  Y > 0, (A - L C) Y + Y (A - L C)' + 2 a Y <= 0   ((A - L C) Y (A - L C)' <= r^2 Y);
    norm gamma:  M >= 0, J >= 0, and with J_L = [I, -L] J [I, -L]',
                 continuous: G_L(P) + gamma^-2 P M P <= 0;
                 discrete:   [[P - J_L, (A - L C) P], [P (A - L C)', P - gamma^-2 P M P]] >= 0;
    floor:       M >= 0, J >= 0, V > 0, Z >= 0, and with F = A - N V^-1 C, q = W - N V^-1 N',
                 continuous: T Z + Z T' >= 0, T = F + q H;
                 discrete:   O - K Z K' >= 0, O = T Z + Z T' - Z, T = F K + q H.

Theorem. Then every mode of A - L C has Re <= -a (modulus <= r), |T_L| <= gamma, and every stabilising gain has
    |T|^2 >= tr(M Z) / tr(Z (H'q H + C'V^-1 C)),  in discrete time  tr(M O) / tr(Z (H'q H + K'C'V^-1 C K)).
The proof is in docs/certificates.md. P, Z, H and K come from elsewhere and need no trust. Only the standard library is
used.
"""

# pyright: strict

from dataclasses import dataclass, replace
from fractions import Fraction
from typing import Any

from derive.errors import InputError
from lmi.certificate.arithmetic import Exact, TooLargeError, is_definite, is_semidefinite, symmetric_block
from lmi.certificate.sandwich import Bounds, Certificate, Check, ExactPlant, require_shape, verify

__all__ = ["Decay", "DesignBounds", "DesignCertificate", "Floor", "Norm", "proper", "reduced_noise", "verify_design"]

ENLARGEMENTS = (0, 50, 44, 36)
"""Bits k: a noise or weight that fails to be semidefinite has its diagonal enlarged by a relative 2^-k; 0 for not."""

INVERSE_WORK = 4 * 10**9
"""Most outputs to the fourth power times bits for which V is inverted exactly: about a minute."""


@dataclass(frozen=True)
class Decay:
    """What is claimed to bound the modes: the rate a (discrete: the radius r) and the witness Y (n, n)."""

    bound: Fraction
    Y: Exact


@dataclass(frozen=True)
class Norm:
    """What is claimed to bound the H-infinity norm of the gain: gamma and P (n, n), in discrete time any G (n, n).

    The inequality is multiplied by [[I, -G], [0, I]] and its transpose before it is decided. That does not change its
    sign, and makes it almost block diagonal for G = (A - L C)(I - gamma^-2 P M)^-1.
    """

    gamma: Fraction
    P: Exact
    G: Exact | None = None


@dataclass(frozen=True)
class Floor:
    """What is claimed to bound the H-infinity norm of every gain: Z (n, n), H (n, n), in discrete time K (n, n)."""

    Z: Exact
    H: Exact
    K: Exact | None = None


@dataclass(frozen=True)
class DesignCertificate:
    """What is claimed about a gain.

    Attributes:
        cost: the plant, the gain, and the sandwich of its cost tr(M P) with the proof that it stabilises.
        decay: of its modes, or None.
        norm: its H-infinity norm, or None.
        floor: below which no gain's H-infinity norm is, or None.
    """

    cost: Certificate
    decay: Decay | None = None
    norm: Norm | None = None
    floor: Floor | None = None

    def __post_init__(self) -> None:
        n = self.plant.n
        square = (n, n)
        if self.decay is not None:
            require_shape("decay.Y", self.decay.Y, square, symmetric=True)
        if self.norm is not None:
            require_shape("norm.P", self.norm.P, square, symmetric=True)
            self._require_discrete("norm.G", self.norm.G)
        if self.floor is not None:
            require_shape("floor.Z", self.floor.Z, square, symmetric=True)
            require_shape("floor.H", self.floor.H, (n, n))
            self._require_discrete("floor.K", self.floor.K)

    def _require_discrete(self, name: str, X: Exact | None) -> None:
        if (X is None) != self.plant.is_continuous:
            raise InputError(f"{name}: expected in discrete time and only there; change the time or make it anew")
        if X is not None:
            require_shape(name, X, (self.plant.n, self.plant.n))

    @property
    def plant(self) -> ExactPlant:
        """The plant."""
        return self.cost.plant

    @property
    def gain(self) -> Exact:
        """The gain L (n, l)."""
        return self.cost.gain

    def as_dict(self) -> dict[str, Any]:
        """Return it as plain data, schema lmi-design-certificate/1, without the plant and the gain."""
        from lmi.certificate.design_file import design_certificate_dict

        return design_certificate_dict(self)


@dataclass(frozen=True)
class DesignBounds:
    """What a verified certificate proves.

    Attributes:
        cost: of the gain, and of the best one.
        decay: every mode has Re <= -decay, in discrete time modulus <= decay; None for no claim.
        gamma: the H-infinity norm of the gain is at most this; None for no claim.
        floor_squared: the square of the H-infinity norm of every stabilising gain is at least this; None for no claim.
        enlarged: gamma and the floor hold for the plant with the diagonals of (J, M) enlarged by these relative
            amounts, 0 where they are semidefinite.
    """

    cost: Bounds
    decay: Fraction | None
    gamma: Fraction | None
    floor_squared: Fraction | None
    enlarged: tuple[Fraction, Fraction]


def verify_design(certificate: DesignCertificate) -> tuple[tuple[Check, ...], DesignBounds | None]:
    """Decide the inequalities, and return what they prove; nothing when one of them fails."""
    found, bounds = verify(certificate.cost)
    decay, norm, floor = certificate.decay, certificate.norm, certificate.floor
    if decay is not None:
        found += decay_checks(certificate.plant, certificate.gain, decay)
    enlarged, floor_squared = (Fraction(0), Fraction(0)), None
    if norm is not None or floor is not None:
        plant, enlarged, semidefinite = proper(certificate.plant)
        found += semidefinite
        if norm is not None:
            found += norm_checks(plant, certificate.gain, norm)
        if floor is not None:
            more, floor_squared = floor_checks(plant, floor)
            found += more
    if bounds is None or not all(check.holds for check in found):
        return found, None
    gamma = None if norm is None else norm.gamma
    return found, DesignBounds(bounds, None if decay is None else decay.bound, gamma, floor_squared, enlarged)


def proper(plant: ExactPlant) -> tuple[ExactPlant, tuple[Fraction, Fraction], tuple[Check, ...]]:
    """Return the plant with J >= 0 and M >= 0, where rounding spoils that with diagonals enlarged a little.

    Returns:
        The plant, by how much the diagonals of J and M were enlarged, and whether J and M are now semidefinite.
    """
    noise = _enlargement(symmetric_block(plant.W, plant.N, plant.V))
    weight = _enlargement(plant.M)
    checks = (Check("J >= 0", noise is not None), Check("M >= 0", weight is not None))
    noise, weight = noise or Fraction(0), weight or Fraction(0)
    W, V, M = _enlarged(plant.W, noise), _enlarged(plant.V, noise), _enlarged(plant.M, weight)
    return replace(plant, W=W, V=V, M=M), (noise, weight), checks


def _enlargement(M: Exact) -> Fraction | None:
    tried = (Fraction(1, 1 << k) if k else Fraction(0) for k in ENLARGEMENTS)
    return next((d for d in tried if is_semidefinite(_enlarged(M, d))), None)


def _enlarged(M: Exact, d: Fraction) -> Exact:
    """Return M + d diag(M)."""
    if d == 0:
        return M
    n = M.shape[0]
    return M + Exact.of([[d * M[i, j] if i == j else 0 for j in range(n)] for i in range(n)])


def decay_checks(plant: ExactPlant, gain: Exact, decay: Decay) -> tuple[Check, ...]:
    """Decide that every mode of A - L C has Re <= -a, in discrete time modulus <= r."""
    Y, loop = decay.Y, plant.loop(gain)
    moved = loop @ Y
    if plant.is_continuous:
        statement, drift = "(A - LC)Y + Y(A - LC)' + 2aY <= 0", moved + moved.T + Y * (2 * decay.bound)
    else:
        statement, drift = "(A - LC)Y(A - LC)' - r^2 Y <= 0", moved @ loop.T - Y * decay.bound**2
    checks = (Check("Y > 0", is_definite(Y)), Check(statement, is_semidefinite(-drift)))
    return checks if plant.is_continuous else (Check("r > 0", decay.bound > 0), *checks)


def norm_checks(plant: ExactPlant, gain: Exact, norm: Norm) -> tuple[Check, ...]:
    """Decide that the H-infinity norm of the gain is at most gamma, for M >= 0 and J >= 0."""
    if norm.gamma <= 0:
        return (Check("gamma > 0", False),)
    P = norm.P
    PMP = P @ plant.M @ P * (1 / norm.gamma**2)
    if plant.is_continuous:
        return (Check("G_L(P) + PMP/gamma^2 <= 0", is_semidefinite(-(plant.defect(gain, P) + PMP))),)
    moved, G = plant.loop(gain) @ P, norm.G or Exact.identity(plant.n) * Fraction(0)
    noise = plant.defect(gain, P) - plant.drift(plant.loop(gain), P)
    crossed = moved @ G.T
    corner = P - noise - crossed - crossed.T + G @ (P - PMP) @ G.T
    block = symmetric_block(corner, moved - G @ (P - PMP), P - PMP)
    return (Check("[[P - J_L, (A - LC)P], [P(A - LC)', P - PMP/gamma^2]] >= 0", is_semidefinite(block)),)


def floor_checks(plant: ExactPlant, floor: Floor) -> tuple[tuple[Check, ...], Fraction | None]:
    """Decide that the squared H-infinity norm of every stabilising gain is at least a number, and return it."""
    Z, H, K = floor.Z, floor.H, floor.K
    V_definite, Z_semidefinite = Check("V > 0", is_definite(plant.V)), Check("Z >= 0", is_semidefinite(Z))
    if not V_definite.holds:
        return (V_definite, Z_semidefinite), None
    F, q, information = reduced_noise(plant)
    if K is None:
        moved = (F + q @ H) @ Z
        outcome, statement, above = Z, "TZ + ZT' >= 0", moved + moved.T
    else:
        moved = (F @ K + q @ H) @ Z
        outcome, statement = moved + moved.T - Z, "TZ + ZT' - Z - KZK' >= 0"
        above, information = outcome - K @ Z @ K.T, K.T @ information @ K
    price = (H.T @ q @ H + information).trace_of_product(Z)
    checks = (V_definite, Z_semidefinite, Check(statement, is_semidefinite(above)), Check("tr(ZE) > 0", price > 0))
    return checks, plant.M.trace_of_product(outcome) / price if price > 0 else None


def reduced_noise(plant: ExactPlant) -> tuple[Exact, Exact, Exact]:
    """Return F = A - N V^-1 C, q = W - N V^-1 N' and C'V^-1 C."""
    inverse = _inverse(plant.V)
    NV = plant.N @ inverse
    return plant.A - NV @ plant.C, plant.W - NV @ plant.N.T, plant.C.T @ inverse @ plant.C


def _inverse(V: Exact) -> Exact:
    """Invert a positive definite matrix by fraction-free elimination: with B the integers of V, B^-1 = adj B / det B.

    Raises:
        TooLargeError: it would take too long.
    """
    n = V.shape[0]
    if n**4 * V.bits > INVERSE_WORK:
        raise TooLargeError(f"the noise of {n} outputs takes too long to invert exactly")
    rows = [[*row, *(int(i == j) for j in range(n))] for i, row in enumerate(V.numerators)]
    before = 1
    for k, row in enumerate(rows):
        pivot = row[k]
        for i in range(n):
            if i != k:
                factor = rows[i][k]
                rows[i] = [(pivot * x - factor * y) // before for x, y in zip(rows[i], row, strict=True)]
        before = pivot
    return Exact.of([[Fraction(x * V.denominator, before) for x in row[n:]] for row in rows])
