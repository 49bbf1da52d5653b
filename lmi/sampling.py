"""How a sampled covariance stands to a computed one: within its interval, outside of it, or too far to be chance."""

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from derive.numeric.simulation import LEVEL, Estimate, Sample

__all__ = ["FAR", "SampleReading", "read_sample"]

Matrix = NDArray[np.floating[Any]]

FAR = 6.0
"""Standard deviations beyond which a sampled answer disagrees: chance goes there once in 500 million samples."""


@dataclass(frozen=True)
class SampleReading:
    """A sample compared with a covariance.

    Attributes:
        holds: whether the intervals hold tr P and tr(M P).
        score: the largest distance in standard deviations, of tr P, tr(M P) and the variances.
    """

    holds: bool
    score: float

    @property
    def disagrees(self) -> bool:
        """Whether the distance is no chance."""
        return not self.score <= FAR

    @property
    def status(self) -> str:
        """What to say of the sample."""
        if self.disagrees:
            return f"disagrees: differs from riccati by {self.score:.1f} standard deviations"
        if self.holds:
            return "sampled"
        return f"sampled: {self.score:.1f} standard deviations from riccati, outside its {LEVEL:.1%} interval"


def read_sample(sample: Sample, P: Matrix, M: Matrix, slack: Matrix) -> SampleReading:
    """Compare a sample with a covariance.

    Args:
        sample: of simulated errors.
        P: covariance (n, n).
        M: weight of the cost (n, n), M >= 0.
        slack: by how much each variance of P may be off for other reasons than chance (n,).
    """
    mean = (
        (sample.trace, float(np.trace(P)), float(slack.sum())),
        (sample.cost, float(np.trace(M @ P)), _cost(M, slack)),
    )
    variances = zip(sample.variances, np.diag(P), slack, strict=True)
    holds = all(_excess(e, value, room) <= e.half_width for e, value, room in mean)
    score = max(_score(e, float(value), float(room)) for e, value, room in (*mean, *variances))
    return SampleReading(holds, score)


def _cost(M: Matrix, slack: Matrix) -> float:
    """Return by how much tr(M P) may be off: |P_ij| is at most the root of P_ii P_jj."""
    root = np.sqrt(slack)
    return float(root @ np.abs(M) @ root)


def _excess(estimate: Estimate, value: float, slack: float) -> float:
    """Return the distance of a value from an estimate, without what bias and slack explain."""
    return max(estimate.value - value, value - estimate.value - estimate.bias, 0.0) - slack


def _score(estimate: Estimate, value: float, slack: float) -> float:
    if not np.isfinite(value):
        return np.inf
    excess = _excess(estimate, value, slack)
    if excess <= 0:
        return 0.0
    return excess / estimate.deviation if estimate.deviation > 0 else np.inf
