"""Solutions near a strong one: the boundary modes are moved inside by a chosen rate, by linear equations alone."""

from dataclasses import dataclass

import numpy as np
from flint import arb, arb_mat

from derive.numeric.balls import exact, floats, identity, middle
from derive.numeric.modes import Time
from derive.numeric.newton import Equation, lyapunov_in_balls, refined
from derive.numeric.plant import Plant
from derive.numeric.riccati import solve_riccati
from lmi.certificate.sandwich import ExactPlant
from lmi.certification.boundary import Reduced, without_boundary
from lmi.certification.frame import unit_variances

__all__ = ["Strong", "strong_solution"]


@dataclass(frozen=True, eq=False)
class Strong:
    """The strong solution P* = U Pi U' of a plant with unexcited boundary modes.

    Attributes:
        reduced: the plant without these modes.
        equation: its Riccati equation; None when nothing is left.
        Pi: its stabilising solution, in the coordinates of its equation; None likewise.
    """

    reduced: Reduced
    equation: Equation | None
    Pi: arb_mat | None

    def covariance(self, scaling: arb_mat) -> arb_mat:
        """Return P* in the coordinates x = scaling x_scaled."""
        n = scaling.nrows()
        if self.equation is None or self.Pi is None:
            return arb_mat(n, n)
        U = scaling.inv() * arb_mat(self.reduced.U) * exact(np.diag(self.equation.scaling))
        return middle(U * self.Pi * U.transpose())

    def nearby(self, equation: Equation, rate: arb) -> arb_mat:
        """Return P >= P* whose closed loop has the boundary modes moved inside by about `rate`.

        With Lambda the loop at P*, Z'Lambda = T Z', Lambda E = E T and Z'E = I, and H = E'C'S^-1 C E where S is the
        innovation's covariance at P*, P = P* + E Y^-1 E' turns the Riccati operator into -2 rate E Y^-1 E' <= 0 when
        (T + rate)'Y + Y (T + rate) = H; in discrete time Y + H = T'Y T / (1 - rate)^2, likewise.

        Args:
            equation: of the whole plant, in any coordinates.
            rate: small and positive.
        """
        scaling = exact(np.diag(equation.scaling))
        P = self.covariance(scaling)
        Z = scaling * arb_mat(self.reduced.Z)
        dual = Z * (Z.transpose() * Z).inv()
        T = Z.transpose() * equation.F * dual
        E = self._basis(equation.closed_loop(P), T, dual, scaling)
        H = E.transpose() * equation.curvature(P) * E
        Y = _moved(T.mid(), middle(H), rate, equation.time)
        return middle(P + E * Y.inv() * E.transpose())

    def _basis(self, loop: arb_mat, T: arb_mat, dual: arb_mat, scaling: arb_mat) -> arb_mat:
        """Solve loop E = E T with E = dual + U X, a Sylvester equation for X."""
        m, k = self.reduced.m, T.nrows()
        if m == 0:
            return dual
        U = scaling.inv() * arb_mat(self.reduced.U)
        left = (U.transpose() * U).inv() * U.transpose()
        kept, right = left * loop * U, left * loop * dual
        rows = [[arb(0)] * (m * k) for _ in range(m * k)]
        for i in range(m):
            for j in range(k):
                for p in range(m):
                    rows[i * k + j][p * k + j] += kept[i, p]
                for p in range(k):
                    rows[i * k + j][i * k + p] -= T[p, j]
        X = arb_mat(rows).solve(arb_mat(m * k, 1, [-x for x in right.entries()]))
        return dual + U * arb_mat(m, k, X.entries())


def _moved(T: arb_mat, H: arb_mat, rate: arb, time: Time) -> arb_mat:
    """Solve (T + rate)'Y + Y (T + rate) = H, in discrete time Y + H = T'Y T / (1 - rate)^2."""
    if time == "continuous":
        return middle(lyapunov_in_balls((-(T + identity(T.nrows()) * rate)).transpose().mid(), H, time))
    M = T.inv() * (1 - rate)
    return middle(lyapunov_in_balls(M.transpose().mid(), middle(M.transpose() * H * M), time))


def strong_solution(plant: ExactPlant) -> Strong | None:
    """Solve the plant without its unexcited boundary modes in high precision; None when there are none."""
    reduced = without_boundary(plant)
    if reduced is None:
        return None
    m = reduced.m
    if m == 0:
        return Strong(reduced, None, None)
    F, C, q, V = (arb_mat(X) for X in (reduced.F, reduced.C, reduced.q, reduced.V))
    equation, N = Equation(F, C, q, V, plant.time, np.ones(m)), np.zeros((m, plant.l))
    A, W = floats(F), floats(q)
    small = Plant(time=plant.time, A=A, C=floats(C), W=(W + W.T) / 2, V=floats(V), N=N, M=np.eye(m))
    solution = solve_riccati(small)
    if solution.status != "stabilising":
        return None
    return Strong(reduced, *unit_variances(equation, refined(equation, exact(solution.P), in_balls=True)))
