"""The plant of an estimation problem: what is given, checked once where it enters."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from os import PathLike
from pathlib import Path
from typing import Any, cast

import numpy as np

from derive.errors import InputError
from derive.numeric.fields import Fields, closest, positive_semidefinite, read_names, read_text, show, symmetric
from derive.numeric.modes import Matrix, Time, format_mode, undetectable_mode
from derive.numeric.noise import GENERAL_FORM, read_noise

__all__ = ["Plant", "as_plant", "example_plant", "load_plant", "plant_from_mapping"]

SYNONYMS = {"Q": "W", "R": "V", "S": "N"}
KEYS = (
    *("time", "A", "C", "W", "V", "N", *GENERAL_FORM),
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


def as_plant(plant: "Plant | str | PathLike[str] | Mapping[str, Any]") -> Plant:
    """Return a plant, read from a file or a mapping where it is none.

    Raises:
        InputError: it is something else, or the file or mapping holds no plant.
    """
    if isinstance(plant, Plant):
        return plant
    if isinstance(plant, Mapping):
        return plant_from_mapping(plant)
    if isinstance(plant, str | PathLike):
        return load_plant(plant)
    remedy = "give A, C, W, V by name"
    if hasattr(plant, "A") and hasattr(plant, "C"):
        remedy = "a system lacks the noise: derive.numeric.systems.plant_from_system(system, W=..., V=...)"
    raise InputError(f"plant: expected a file, keys with values or a plant, got {type(plant).__name__}; {remedy}")


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
        raise InputError(f"plant: expected keys with values, got {type(data).__name__}; give A, C, W, V by name")
    fields = Fields.of(data, KEYS, SYNONYMS)
    time = _time(fields)
    A = fields.matrix("A", None, None, "the state matrix")
    n = len(A)
    if A.shape != (n, n):
        raise InputError(
            f"A: expected a square matrix, got shape {A.shape}; A maps the state to its rate or next value"
        )
    C = fields.matrix("C", None, n, "the output matrix")
    l = len(C)  # noqa: E741 (the field's letter for the number of outputs)
    W, V, N = read_noise(fields, n, l)
    _check_detectable(A, C, time)
    B = fields.optional("B", n, None)
    D_u = fields.optional("D_u", l, None if B is None else B.shape[1])
    states, outputs = _names(fields, "states", "x", n), _names(fields, "outputs", "y", l)
    return Plant(
        time=time,
        A=_frozen(A),
        C=_frozen(C),
        W=_frozen(W),
        V=_frozen(V),
        N=_frozen(N),
        M=_frozen(_weight(fields, "M", np.eye(n))),
        B=None if B is None else _frozen(B),
        D_u=None if D_u is None else _frozen(D_u),
        P0=_frozen(_weight(fields, "P0", np.eye(n))) if "P0" in fields else None,
        dt=_period(fields, time),
        name=read_text("name", fields.values.get("name", name)),
        source=read_text("source", fields.values.get("source", "")),
        states=states,
        outputs=outputs,
        units=_units(fields.values.get("units", {}), (*states, *outputs)),
    )


def _time(fields: Fields) -> Time:
    time = fields.required("time", '"continuous" or "discrete"')
    if not isinstance(time, str) or time not in ("continuous", "discrete"):
        raise InputError(f'time: expected "continuous" or "discrete", got {show(time)}; choose one')
    return cast(Time, time)


def _check_detectable(A: Matrix, C: Matrix, time: Time) -> None:
    mode = undetectable_mode(A, C, time)
    if mode is not None:
        raise InputError(
            f"(A, C): not detectable: mode {format_mode(mode)} is unobservable; "
            "measure an output that sees it, or remove it from the plant"
        )


def _weight(fields: Fields, key: str, default: Matrix) -> Matrix:
    matrix = fields.optional(key, len(default), len(default))
    return default if matrix is None else positive_semidefinite(key, symmetric(key, matrix), "correct its entries")


def _names(fields: Fields, key: str, letter: str, count: int) -> tuple[str, ...]:
    if key in fields:
        return read_names(key, fields.values[key], count)
    return tuple(f"{letter}{i}" for i in range(1, count + 1))


def _period(fields: Fields, time: Time) -> float | None:
    if "dt" not in fields:
        return None
    dt = float(fields.matrix("dt", 1, 1)[0, 0])
    if dt <= 0:
        raise InputError(f"dt: expected a positive number of seconds, got {dt:g}; give the sampling period")
    if time == "continuous":
        raise InputError('dt: expected only with time = "discrete", got "continuous"; remove dt or change time')
    return dt


def _units(value: Any, names: tuple[str, ...]) -> Mapping[str, str]:
    if not isinstance(value, Mapping):
        raise InputError(f'units: expected units by name, got {show(value)}; write units = {{ {names[0]} = "m" }}')
    for key in value:
        if key not in names:
            raise InputError(f"units: expected names of states or outputs, got {show(key)}; {closest(str(key), names)}")
    return {key: read_text(f"units.{key}", unit) for key, unit in value.items()}


def _frozen(matrix: Matrix) -> Matrix:
    matrix = np.array(matrix, dtype=float)
    matrix.setflags(write=False)
    return matrix
