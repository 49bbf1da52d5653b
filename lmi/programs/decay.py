"""The decay of the error: every mode of A - L C is to the left of -a, or inside the circle of radius r.

    continuous: X A - Y C + (X A - Y C)' + 2 a X <= 0
    discrete:   [[r^2 X, (X A - Y C)'], [X A - Y C, X]] >= 0

For X > 0 both say that e'X e falls at least as exp(-2 a t), or as r^(2 k). Without other specifications that is no more
than the modes say; with others, which share X, it is sufficient only.

Source: S. Boyd, L. El Ghaoui, E. Feron and V. Balakrishnan, Linear Matrix Inequalities in System and Control Theory,
SIAM 1994, section 5.1.3.
"""

import cvxpy as cp

from lmi.programs.observer import Specification, Unknowns

__all__ = ["decay"]


def decay(rate: float) -> Specification:
    """Ask for modes with Re <= -rate, in discrete time for moduli of at most rate.

    Args:
        rate: a [1/s], in discrete time the radius r.
    """

    def constraints(unknowns: Unknowns) -> list[cp.Constraint]:
        F, X = unknowns.drift, unknowns.X
        if unknowns.plant.is_continuous:
            return [-(F + F.T + 2 * rate * X) >> 0]
        return [cp.bmat([[rate**2 * X, F.T], [F, X]]) >> 0]

    return constraints
