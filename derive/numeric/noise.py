"""The noise of a plant: intensities W, V, N as they are given, or reduced from the general form."""

import numpy as np

from derive.errors import InputError
from derive.numeric.fields import Fields, positive_definite, positive_semidefinite, symmetric
from derive.numeric.modes import Matrix

__all__ = ["GENERAL_FORM", "read_noise"]

GENERAL_FORM = ("B_d", "D_d", "D_r", "S_dd", "S_rr", "S_dr")


def read_noise(fields: Fields, n: int, l: int) -> tuple[Matrix, Matrix, Matrix]:  # noqa: E741 (number of outputs)
    """Return W >= 0, V > 0 and N with [[W, N], [N', V]] >= 0, from the keys of that name or from the general form.

    Args:
        fields: the plant's keys and values.
        n: number of states.
        l: number of outputs.

    Raises:
        InputError: both forms given, a key missing, a wrong shape, asymmetric or indefinite noise.
    """
    W_name, V_name, N_name = (fields.names.get(key, key) for key in ("W", "V", "N"))
    if any(key in fields for key in GENERAL_FORM):
        for key in ("W", "V", "N"):
            if key in fields:
                name = fields.names[key]
                raise InputError(f"{name}: expected W, V, N or the general form B_d, S_dd, ..., got both; keep one")
        W, V, N = _general_form(fields, n, l)
    else:
        W = fields.matrix("W", n, n, "the process noise W (or Q, or B_d with S_dd)")
        V = fields.matrix("V", l, l, "the measurement noise V (or R, or D_r with S_rr)")
        N = fields.optional("N", n, l)
    N = np.zeros((n, l)) if N is None else N
    W = positive_semidefinite(W_name, symmetric(W_name, W))
    V = positive_definite(V_name, symmetric(V_name, V))
    _joint((W_name, N_name, V_name), W, N, V)
    return W, V, N


def _general_form(fields: Fields, n: int, l: int) -> tuple[Matrix, Matrix, Matrix]:  # noqa: E741
    """Reduce x' = A x + B_d d, y = C x + D_d d + D_r r with intensities S_dd, S_rr, S_dr of (d, r).

    W = B_d S_dd B_d', N = B_d (S_dd D_d' + S_dr D_r'),
    V = D_d S_dd D_d' + D_d S_dr D_r' + D_r S_rd D_d' + D_r S_rr D_r'.
    """
    B_d = fields.matrix("B_d", n, None, "the disturbance matrix of the general form")
    p = B_d.shape[1]
    S_dd = symmetric("S_dd", fields.matrix("S_dd", p, p, "the intensity of d in the general form"))
    D_d = fields.optional("D_d", l, p)
    D_d = np.zeros((l, p)) if D_d is None else D_d
    D_r = fields.matrix("D_r", l, None, "the matrix of r in the general form")
    q = D_r.shape[1]
    S_rr = symmetric("S_rr", fields.matrix("S_rr", q, q, "the intensity of r in the general form"))
    S_dr = fields.optional("S_dr", p, q)
    S_dr = np.zeros((p, q)) if S_dr is None else S_dr
    _joint(("S_dd", "S_dr", "S_rr"), S_dd, S_dr, S_rr)
    cross = D_d @ S_dr @ D_r.T
    V = D_d @ S_dd @ D_d.T + cross + cross.T + D_r @ S_rr @ D_r.T
    return B_d @ S_dd @ B_d.T, V, B_d @ (S_dd @ D_d.T + S_dr @ D_r.T)


def _joint(names: tuple[str, str, str], first: Matrix, cross: Matrix, second: Matrix) -> None:
    a, b, c = names
    matrix = np.block([[first, cross], [cross.T, second]])
    positive_semidefinite(f"[[{a}, {b}], [{b}', {c}]]", matrix, f"{b} is too large for {a} and {c}")
