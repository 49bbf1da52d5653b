"""Modes on the boundary of stability that the process noise does not excite, where the error covariance vanishes."""

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from derive.numeric.modes import Matrix, Time, distance_to_stability, spectral_scale
from derive.numeric.subspaces import RANK_RTOL, invariant_subspace, nearest, unseen_subspace

__all__ = ["Boundary", "unexcited_boundary"]

CANDIDATE_RTOL = 1e-3
"""Distance from the boundary within which a mode is looked at: a computed quadruple mode is good to eps^(1/4) only."""

BOUNDARY_RTOL = 1e-11
"""Distance of a mode, or of the mean of a cluster, that counts as zero, relative to the size of F on these modes alone.
A mean is accurate where its modes are not."""

CLUSTER_RTOLS = (0.0, 1e-7, 1e-5, 1e-4, 1e-3)
"""Distances at which neighbouring modes are taken as one multiple mode, tried in this order."""


@dataclass(frozen=True, eq=False)
class Boundary:
    """The left-invariant subspace of the unexcited boundary modes.

    Attributes:
        kept: orthonormal basis (n, n - k) of the complement, in which the Riccati equation is left to solve.
        removed: orthonormal basis (n, k) of the subspace, F' removed = removed Lambda and W removed = 0.
        modes: eigenvalues of Lambda (k,), moved onto the boundary.
    """

    kept: Matrix
    removed: Matrix
    modes: NDArray[np.complexfloating[Any, Any]]


def unexcited_boundary(F: Matrix, W: Matrix, time: Time, rate: float, noise: Matrix, slack: float = 1.0) -> Boundary:
    """Find the largest subspace X with F' X in X, W X = 0 and the spectrum of F' on X on the boundary.

    On X every solution P >= 0 vanishes: for a left eigenvector x, 2 Re(lambda) x*Px = |V^(-1/2) C P x|^2 gives
    C P x = 0, so P x is an eigenvector of F that C does not see, hence 0 when (F, C) is detectable; Jordan chains
    follow by induction. With P = U Pi U', U = `kept`, the equation for Pi has U'F U, C U and U'W U, and all its
    boundary modes are excited.

    Args:
        F: A - N V^-1 C (n, n), balanced.
        W: W - N V^-1 N' (n, n), in the same coordinates.
        time: "continuous" or "discrete".
        rate: size of A, to which rounding in F is relative.
        noise: sizes of the entries of the process noise (n, n) to which rounding in W is relative.
        slack: factor on the tolerances, for data that carry the rounding of earlier computations.
    """
    n = len(F)
    scale = max(spectral_scale(F, time), rate)
    nothing = Boundary(np.eye(n), np.zeros((n, 0)), np.zeros(0, complex))
    near = invariant_subspace(F.T, lambda mode: bool(abs(distance_to_stability(mode, time)) <= CANDIDATE_RTOL * scale))
    rtol = slack * n * RANK_RTOL
    near = near @ unseen_subspace(near.T @ F.T @ near, W @ near, rtol * float(np.linalg.norm(noise)), rtol * scale)
    if near.shape[1] == 0:
        return nothing
    restricted = near.T @ F.T @ near
    modes = np.linalg.eigvals(restricted)
    size = spectral_scale(restricted, time)
    tol = max(slack * BOUNDARY_RTOL * size, rtol * scale)
    clusters = _boundary_clusters(list(modes), time, size, tol)
    if not clusters:
        return nothing
    chosen = [mode for cluster in clusters for mode in cluster]
    others = [mode for mode in modes if mode not in chosen]
    removed = near @ invariant_subspace(restricted, lambda mode: nearest(mode, chosen) <= nearest(mode, others))
    if np.any(np.abs(removed.T @ W @ removed) > rtol * np.abs(removed).T @ noise @ np.abs(removed)):
        return nothing  # faint noise beside strong noise, but no rounding
    kept = np.linalg.qr(removed, mode="complete")[0][:, removed.shape[1] :]
    means = np.concatenate([np.full(len(cluster), np.mean(cluster)) for cluster in clusters])
    return Boundary(kept, removed, _snapped(means, time))


def _boundary_clusters(modes: list[complex], time: Time, scale: float, tol: float) -> list[list[complex]]:
    """Return the clusters of modes whose mean is on the boundary, the tightest clusters first."""
    found: list[list[complex]] = []
    for rtol in CLUSTER_RTOLS:
        rest = [mode for mode in modes if not any(mode in cluster for cluster in found)]
        for cluster in _clusters(rest, rtol * scale):
            if abs(distance_to_stability(np.mean(cluster), time)) <= tol:
                found.append(cluster)
    return found


def _clusters(modes: list[complex], distance: float) -> list[list[complex]]:
    """Group modes into chains of neighbours at most `distance` apart."""
    clusters: list[list[complex]] = []
    for mode in modes:
        linked = [group for group in clusters if min(abs(mode - other) for other in group) <= distance]
        clusters = [group for group in clusters if group not in linked]
        clusters.append([mode, *(other for group in linked for other in group)])
    return clusters


def _snapped(modes: NDArray[Any], time: Time) -> NDArray[Any]:
    modes = 1j * np.imag(modes) if time == "continuous" else modes / np.abs(modes)
    return modes[np.lexsort((np.imag(modes), np.real(modes)))]
