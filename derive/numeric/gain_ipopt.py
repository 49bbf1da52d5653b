"""IPOPT by way of CasADi: one call that returns the answer, the multipliers and the points on the way."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import casadi as ca
import numpy as np

from derive.numeric.modes import Matrix

__all__ = ["Run", "inverse", "minimise", "symmetric_basis"]

OPTIONS: dict[str, Any] = {
    "print_time": False,
    "show_eval_warnings": False,
    "error_on_fail": False,
    "ipopt.print_level": 0,
    "ipopt.sb": "yes",
    "ipopt.tol": 1e-11,
    "ipopt.max_iter": 200,
}


@dataclass(frozen=True, eq=False)
class Run:
    """What IPOPT returned; its own word on that is not among it.

    Attributes:
        x: the answer (p,).
        multipliers: of the constraints (q,), for the Lagrangian f + multipliers' g.
        points: x after each iteration, the first one included.
        iterations: how many.
    """

    x: Matrix
    multipliers: Matrix
    points: tuple[Matrix, ...]
    iterations: int


def minimise(nlp: Mapping[str, Any], first: Matrix, options: Mapping[str, Any] | None = None) -> Run:
    """Minimise f(x) subject to g(x) = 0.

    Args:
        nlp: CasADi expressions x, f and, if there are constraints, g.
        first: where to start (p,).
        options: for `casadi.nlpsol`, added to `OPTIONS`; functions for derivatives among them.
    """
    nlp = {"g": ca.MX(0, 1), **nlp}
    recorder = _Recorder(nlp["x"].numel(), nlp["g"].numel())
    chosen = {**OPTIONS, "iteration_callback": recorder, **(options or {})}
    solver = ca.nlpsol("solver", "ipopt", dict(nlp), chosen)
    found = solver(x0=first, lbg=0, ubg=0)
    x, multipliers = (np.array(found[key]).ravel() for key in ("x", "lam_g"))
    return Run(x, multipliers, tuple(recorder.points), int(solver.stats()["iter_count"]))


class _Recorder(ca.Callback):
    """Keep the point of every iteration."""

    def __init__(self, variables: int, constraints: int) -> None:
        ca.Callback.__init__(self)
        self.sizes = {"f": 1, "x": variables, "lam_x": variables, "g": constraints, "lam_g": constraints, "lam_p": 0}
        self.points: list[Matrix] = []
        self.construct("recorder")

    def get_n_in(self) -> int:
        return ca.nlpsol_n_out()

    def get_name_in(self, i: int) -> str:
        return ca.nlpsol_out(i)

    def get_sparsity_in(self, i: int) -> ca.Sparsity:
        return ca.Sparsity.dense(self.sizes[ca.nlpsol_out(i)], 1)

    def eval(self, arg: Any) -> list[int]:
        self.points.append(np.array(arg[0]).ravel())
        return [0]


def symmetric_basis(n: int) -> Matrix:
    """Return S (n^2, n(n+1)/2) with orthonormal columns that span the vec of the symmetric matrices."""
    columns = []
    for i in range(n):
        for j in range(i + 1):
            E = np.zeros((n, n))
            E[i, j] = E[j, i] = 1.0 if i == j else np.sqrt(0.5)
            columns.append(E.ravel())
    return np.array(columns).T


def inverse(n: int) -> Any:
    """Return X -> X^-1, ln det X for X > 0; not a number for others, which makes IPOPT shorten its step."""
    X = ca.SX.sym("X", n, n)
    T = ca.SX(n, n)
    for j in range(n):
        T[j, j] = ca.sqrt(X[j, j] - ca.sumsqr(T[j, :j]))
        for i in range(j + 1, n):
            T[i, j] = (X[i, j] - ca.dot(T[i, :j], T[j, :j])) / T[j, j]
    R = ca.SX(n, n)
    for i in range(n):
        R[i, i] = 1 / T[i, i]
        for j in range(i):
            R[i, j] = -ca.dot(T[i, j:i], R[j:i, j].T) / T[i, i]
    return ca.Function("inverse", [X], [R.T @ R, 2 * ca.sum1(ca.log(ca.diag(T)))])
