"""The plant of an estimation problem: what is given, checked once where it enters."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from os import PathLike
from pathlib import Path
from typing import Any, cast

import numpy as np

from derive.errors import InputError
from derive.numeric.fields import (
    check_keys,
    check_shape,
    positive_definite,
    positive_semidefinite,
    read_matrix,
    read_names,
    read_text,
    symmetric,
)
from derive.numeric.modes import Matrix, Time, format_mode, undetectable_mode

__all__ = ["Plant", "example_plant", "load_plant", "plant_from_mapping"]

SYNONYMS = {"Q": "W", "R": "V", "S": "N"}
GENERAL = ("B_d", "D_d", "D_r", "S_dd", "S_rr", "S_dr")
KEYS = (
    *("time", "A", "C", "W", "V", "N", *SYNONYMS, *GENERAL),
    *("M", "B", "D_u", "P0", "dt", "name", "source", "states", "outputs", "units"),
)


@dataclass(frozen=True, eq=False, kw_only=True)
class Plant:
    """A linear plant with white process and measurement noise.

    Continuous: x' = A x + B u + w, y = C x + D_u u + v, E[w(t+s) w(t)'] = W delta(s), V and N = E[w v'] likewise.
    Discrete: x_{k+1} = A x_k + B u_k + w_k, y_k = C x_k + D_u u_k + v_k, with covariances W (Q), V (R), N (S).

    Build it with `plant_from_mapping` or `load_plant`, which check what the constructor takes on trust. Arrays are
    read-only.

    Attributes:
        time: "continuous" or "discrete".
        A: state matrix (n, n).
        C: output matrix (l, n).
        W: process noise (n, n), intensity [state]^2/[s] or covariance [state]^2, positive semidefinite.
        V: measurement noise (l, l), intensity [output]^2 [s] or covariance [output]^2, positive definite.
        N: cross term (n, l), zero when the noises are uncorrelated.
        M: weight (n, n) of the cost tr(M P), the identity unless given.
        B: input matrix (n, m), or None.
        D_u: feedthrough (l, m), or None.
        P0: error covariance at the start (n, n), or None.
        dt: sampling period [s] of a discrete plant, or None.
        name: what to call it.
        source: where the numbers come from.
        states: n names.
        outputs: l names.
        units: unit of a state or output by its name.
    """

    time: Time
    A: Matrix
    C: Matrix
    W: Matrix
    V: Matrix
    N: Matrix
    M: Matrix
    B: Matrix | None = None
    D_u: Matrix | None = None
    P0: Matrix | None = None
    dt: float | None = None
    name: str = "plant"
    source: str = ""
    states: tuple[str, ...] = ()
    outputs: tuple[str, ...] = ()
    units: Mapping[str, str] = field(default_factory=dict)

    @property
    def n(self) -> int:
        """Number of states."""
        return len(self.A)

    @property
    def l(self) -> int:  # noqa: E743 (the field's letter for the number of outputs)
        """Number of outputs."""
        return len(self.C)

    @property
    def is_continuous(self) -> bool:
        """Whether time is continuous."""
        return self.time == "continuous"


def load_plant(path: str | PathLike[str]) -> Plant:
    """Read a plant from a .toml, .json, .npz or .mat file.

    Raises:
        InputError: the file cannot be read, or its plant is not one; the message starts with the file's name.
    """
    from derive.numeric.files import read_mapping

    path = Path(path)
    data = read_mapping(path)
    try:
        return plant_from_mapping(data, name=path.stem)
    except InputError as error:
        raise InputError(f"{path}: {error}") from None


def example_plant() -> Plant:
    """Return the L-1011 aircraft (CAREX, example 1.3), dual: its A', B', Q, R are the plant's A, C, W, V.

    Source: S. Beale and B. Shafai, 1989; the full citation is the plant's `source`.
    """
    from importlib.resources import as_file, files

    with as_file(files("derive") / "data" / "l1011.toml") as path:
        return load_plant(path)


def plant_from_mapping(data: Mapping[str, Any], name: str = "plant") -> Plant:
    """Check a mapping of keys to numbers and return its plant.

    The noise is given as W, V and N (or Q, R and S), or in the general form x' = A x + B_d d, y = C x + D_d d + D_r r
    with intensities S_dd, S_rr, S_dr of (d, r), which is reduced to W, V and N.

    Args:
        data: `time`, `A`, `C` and the noise; optionally M, B, D_u, P0, dt, name, source, states, outputs, units.
        name: name of the plant when the mapping has none.

    Returns:
        The plant: W >= 0, V > 0, [[W, N], [N', V]] >= 0 and (A, C) detectable, all shapes fit.

    Raises:
        InputError: with one line that says what was expected, what was got and the remedy.
    """
    if not isinstance(data, Mapping):
        raise InputError(
            f"plant: expected a mapping of keys to values, got {type(data).__name__}; give A, C, W, V by name"
        )
    check_keys(data, KEYS)
    data = _without_synonyms({key: value for key, value in data.items() if value is not None})
    time = _time(data)
    A = read_matrix("A", _required(data, "A"))
    n = check_shape("A", A, (len(A), len(A))).shape[0]
    C = read_matrix("C", _required(data, "C"))
    l = check_shape("C", C, (len(C), n)).shape[0]  # noqa: E741 (the field's letter for the number of outputs)
    W, V, N = _noise(data, n, l)
    mode = undetectable_mode(A, C, time)
    if mode is not None:
        raise InputError(
            f"(A, C): not detectable: mode {format_mode(mode)} is unobservable; "
            "measure an output that sees it, or remove it from the plant"
        )
    states = read_names("states", data["states"], n) if "states" in data else _numbered("x", n)
    outputs = read_names("outputs", data["outputs"], l) if "outputs" in data else _numbered("y", l)
    B, D_u = _inputs(data, n, l)
    return Plant(
        time=time,
        A=_frozen(A),
        C=_frozen(C),
        W=_frozen(W),
        V=_frozen(V),
        N=_frozen(N),
        M=_frozen(_weight(data, "M", n) if "M" in data else np.eye(n)),
        B=B,
        D_u=D_u,
        P0=_frozen(_weight(data, "P0", n)) if "P0" in data else None,
        dt=_period(data, time),
        name=read_text("name", data["name"]) if "name" in data else name,
        source=read_text("source", data["source"]) if "source" in data else "",
        states=states,
        outputs=outputs,
        units=_units(data.get("units", {}), (*states, *outputs)),
    )


def _required(data: Mapping[str, Any], key: str) -> Any:
    if key not in data:
        raise InputError(f"{key}: missing key, expected {_MEANING[key]}; add it")
    return data[key]


_MEANING = {
    "time": '"continuous" or "discrete"',
    "A": "the state matrix",
    "C": "the output matrix",
    "W": "the process noise W (or Q, or B_d with S_dd)",
    "V": "the measurement noise V (or R, or D_r with S_rr)",
    "B_d": "the disturbance matrix of the general form",
    "S_dd": "the intensity of d in the general form",
    "D_r": "the matrix of r in the general form",
    "S_rr": "the intensity of r in the general form",
}


def _without_synonyms(data: dict[str, Any]) -> dict[str, Any]:
    for other, key in SYNONYMS.items():
        if other in data and key in data:
            raise InputError(f"{other}: expected one of {key} and {other}, got both; they mean the same, keep one")
    return {SYNONYMS.get(key, key): value for key, value in data.items()}


def _time(data: Mapping[str, Any]) -> Time:
    time = _required(data, "time")
    if time not in ("continuous", "discrete"):
        raise InputError(f'time: expected "continuous" or "discrete", got {time!r:.40}; choose one')
    return cast(Time, time)


def _noise(data: Mapping[str, Any], n: int, l: int) -> tuple[Matrix, Matrix, Matrix]:  # noqa: E741
    """Return W, V, N, from the keys of that name or from the general form."""
    if any(key in data for key in GENERAL):
        given = [key for key in ("W", "V", "N") if key in data]
        if given:
            raise InputError(f"{given[0]}: expected W, V, N or the general form B_d, S_dd, ..., got both; keep one")
        W, V, N = _general_form(data, n, l)
    else:
        W = check_shape("W", read_matrix("W", _required(data, "W")), (n, n))
        V = check_shape("V", read_matrix("V", _required(data, "V")), (l, l))
        N = check_shape("N", read_matrix("N", data["N"]), (n, l)) if "N" in data else np.zeros((n, l))
    W = positive_semidefinite("W", symmetric("W", W))
    V = positive_definite("V", symmetric("V", V))
    _joint("[[W, N], [N', V]]", W, N, V, "the cross term is too large for W and V")
    return W, V, N


def _general_form(data: Mapping[str, Any], n: int, l: int) -> tuple[Matrix, Matrix, Matrix]:  # noqa: E741
    """Reduce the general form: W = B_d S_dd B_d', N = B_d (S_dd D_d' + S_dr D_r'), V the intensity of D_d d + D_r r."""
    B_d = read_matrix("B_d", _required(data, "B_d"))
    p = check_shape("B_d", B_d, (n, B_d.shape[1])).shape[1]
    S_dd = symmetric("S_dd", check_shape("S_dd", read_matrix("S_dd", _required(data, "S_dd")), (p, p)))
    D_r = read_matrix("D_r", _required(data, "D_r"))
    q = check_shape("D_r", D_r, (l, D_r.shape[1])).shape[1]
    S_rr = symmetric("S_rr", check_shape("S_rr", read_matrix("S_rr", _required(data, "S_rr")), (q, q)))
    D_d = check_shape("D_d", read_matrix("D_d", data["D_d"]), (l, p)) if "D_d" in data else np.zeros((l, p))
    S_dr = check_shape("S_dr", read_matrix("S_dr", data["S_dr"]), (p, q)) if "S_dr" in data else np.zeros((p, q))
    _joint("[[S_dd, S_dr], [S_dr', S_rr]]", S_dd, S_dr, S_rr, "the cross term is too large for S_dd and S_rr")
    cross = D_d @ S_dr @ D_r.T
    V = D_d @ S_dd @ D_d.T + cross + cross.T + D_r @ S_rr @ D_r.T
    return B_d @ S_dd @ B_d.T, V, B_d @ (S_dd @ D_d.T + S_dr @ D_r.T)


def _joint(name: str, first: Matrix, cross: Matrix, second: Matrix, remedy: str) -> None:
    positive_semidefinite(name, np.block([[first, cross], [cross.T, second]]), remedy)


def _weight(data: Mapping[str, Any], key: str, n: int) -> Matrix:
    matrix = check_shape(key, read_matrix(key, data[key]), (n, n))
    return positive_semidefinite(key, symmetric(key, matrix), "correct its entries")


def _inputs(data: Mapping[str, Any], n: int, l: int) -> tuple[Matrix | None, Matrix | None]:  # noqa: E741
    B = read_matrix("B", data["B"]) if "B" in data else None
    D_u = read_matrix("D_u", data["D_u"]) if "D_u" in data else None
    if B is not None:
        check_shape("B", B, (n, B.shape[1]))
    if D_u is not None:
        check_shape("D_u", D_u, (l, D_u.shape[1] if B is None else B.shape[1]))
    return (None if B is None else _frozen(B)), (None if D_u is None else _frozen(D_u))


def _period(data: Mapping[str, Any], time: Time) -> float | None:
    if "dt" not in data:
        return None
    dt = read_matrix("dt", data["dt"])
    if dt.size != 1 or dt[0, 0] <= 0:
        raise InputError(f"dt: expected a positive number of seconds, got {data['dt']!r:.40}; give the sampling period")
    if time == "continuous":
        raise InputError('dt: expected only with time = "discrete", got "continuous"; remove dt or change time')
    return float(dt[0, 0])


def _units(value: Any, names: tuple[str, ...]) -> Mapping[str, str]:
    if not isinstance(value, Mapping):
        raise InputError(
            f'units: expected a table of units by name, got {value!r:.40}; write units = {{ {names[0]} = "m" }}'
        )
    check_keys(value, names)
    return {key: read_text(f"units.{key}", unit) for key, unit in value.items()}


def _numbered(letter: str, count: int) -> tuple[str, ...]:
    return tuple(f"{letter}{i}" for i in range(1, count + 1))


def _frozen(matrix: Matrix) -> Matrix:
    matrix = np.array(matrix, dtype=float)
    matrix.setflags(write=False)
    return matrix
