"""A bound g of the H-infinity norm from noise to error, linear in X, Y and g^2.

    continuous: [[F + F', B, E], [B', -I, 0], [E', 0, -g^2 I]] <= 0
    discrete:   [[X, F, B, 0], [F', X, 0, E], [B', 0, I, 0], [0, E', 0, g^2 I]] >= 0
    where F = X A - Y C,  B = X G - Y H,  E E' = M,

says for X > 0 and A - L C stable that M^(1/2) (sI - A + L C)^-1 [I, -L] [[W, N], [N', V]]^(1/2) has no singular value
above g on the boundary of stability (bounded real lemma); in discrete time with z, Q, S, R. It contains the inequality
of `lmi.programs.h2`: X^-1 is at least the error covariance.

Without g^2 as an unknown and with tr(M X^-1) as objective, the optimal X^-1 is the stabilising solution P of
    A P + P A' + W - (P C' + N) V^-1 (P C' + N)' + g^-2 P M P = 0
and the gain the central one, (P C' + N) V^-1 (in discrete time likewise).

Source: C. Scherer, P. Gahinet and M. Chilali, Multiobjective output-feedback control via LMI optimization, IEEE Trans.
Automatic Control 42(7), 1997; D. Bernstein and W. Haddad, Steady-state Kalman filtering with an H-infinity error bound,
Systems & Control Letters 12 (1989) 9-16 (the central gain).
"""

import cvxpy as cp
import numpy as np

from lmi.programs.observer import Specification, Unknowns, factor

__all__ = ["hinf"]


def hinf(gamma_squared: "cp.Variable | float") -> Specification:
    """Ask for an H-infinity norm of at most the root of a number, which may be an unknown itself."""

    def constraints(unknowns: Unknowns) -> list[cp.Constraint]:
        F, X, B, E = unknowns.drift, unknowns.X, unknowns.noise, factor(unknowns.plant.M)
        one, level = np.eye(B.shape[1]), gamma_squared * np.eye(E.shape[1])
        if unknowns.plant.is_continuous:
            zero = np.zeros((B.shape[1], E.shape[1]))
            return [cp.bmat([[-(F + F.T), B, E], [B.T, one, zero], [E.T, zero.T, level]]) >> 0]
        zero = np.zeros((B.shape[1], E.shape[1]))
        states = np.zeros((unknowns.plant.n, B.shape[1])), np.zeros((unknowns.plant.n, E.shape[1]))
        rows = [
            [X, F, B, states[1]],
            [F.T, X, states[0], E],
            [B.T, states[0].T, one, zero],
            [states[1].T, E.T, zero.T, level],
        ]
        return [cp.bmat(rows) >> 0]

    return constraints
