"""The Lyapunov and Stein equations as a function that CasADi differentiates."""

from typing import Any

import casadi as ca
import numpy as np

from derive.numeric.lyapunov import solve_lyapunov
from derive.numeric.modes import Time, distance_to_stability

__all__ = ["Lyapunov"]


class Lyapunov(ca.Callback):
    """The function (F, Q) -> X with F X + X F' + Q = 0, in discrete time F X F' - X + Q = 0.

    X is not a number when F is not asymptotically stable, which makes IPOPT shorten its step: the equation has a
    solution beyond the boundary of stability too, but it is no covariance. From a change B of the cost with X follows,
    by the adjoint equation F'Y + Y F + B = 0 (F'Y F - Y + B = 0), a change Y with Q and 2 Y X (2 Y F X) with F. Q and B
    are symmetric. Keep a reference to the object as long as functions that call it are used.

    Args:
        n: size of F, Q, X.
        time: "continuous" or "discrete".
    """

    def __init__(self, n: int, time: Time) -> None:
        ca.Callback.__init__(self)
        self.n = n
        self.time: Time = time
        self.construct("lyapunov")

    def get_n_in(self) -> int:
        """F and Q."""
        return 2

    def get_n_out(self) -> int:
        """X."""
        return 1

    def get_sparsity_in(self, i: int) -> ca.Sparsity:
        """Dense."""
        return ca.Sparsity.dense(self.n, self.n)

    def get_sparsity_out(self, i: int) -> ca.Sparsity:
        """Dense."""
        return ca.Sparsity.dense(self.n, self.n)

    def eval(self, arg: Any) -> list[Any]:
        """Solve the equation."""
        F, Q = np.array(arg[0]), np.array(arg[1])
        stable = np.isfinite(F).all() and np.isfinite(Q).all()
        if stable and np.all(distance_to_stability(np.linalg.eigvals(F), self.time) < 0):
            return [ca.DM(solve_lyapunov(F, Q, self.time))]
        return [ca.DM(np.full((self.n, self.n), np.nan))]

    def has_reverse(self, nadj: int) -> bool:
        """One direction at a time."""
        return nadj == 1

    def get_reverse(self, nadj: int, name: str, inames: Any, onames: Any, opts: Any) -> Any:
        """Solve the adjoint equation, by a call of this same function."""
        F, Q, X, B = (ca.MX.sym(letter, self.n, self.n) for letter in "FQXB")
        Y = self(F.T, (B + B.T) / 2)
        of_F = 2 * Y @ X if self.time == "continuous" else 2 * Y @ F @ X
        return ca.Function(name, [F, Q, X, B], [of_F, Y], inames, onames, opts)
