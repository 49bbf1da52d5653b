"""Plants from the state-space systems of python-control and scipy.signal, neither of which is imported."""

from typing import Any

import numpy as np

from derive.errors import InputError
from derive.numeric.plant import Plant, plant_from_mapping

__all__ = ["plant_from_system"]

MATRICES = ("A", "B", "C", "D")

NUMBERED = ("sys[", "$")
"""How the names begin that python-control makes up."""


def plant_from_system(system: Any, **keys: Any) -> Plant:
    """Take A, B, C, D, the sampling period and the names from a system, and the noise from the keys.

    x' = A x + B u + w, y = C x + D u + v, or x_{k+1} = A x_k + B u_k + w_k: D becomes D_u. Noise that enters with an
    input is given in the general form, for example B_d=system.B with S_dd.

    Args:
        system: a StateSpace of python-control or scipy.signal, or anything with A, B, C, D and dt. Time is continuous
            when dt is None or 0, discrete when it is a period [s], or True for one that is not given.
        keys: W, V, N (Q, R, S) or the general form, and any other key of a plant but A, B, C, D_u and dt;
            time="discrete" reads a system without dt as discrete.

    Returns:
        The plant, checked as by `plant_from_mapping`.

    Raises:
        InputError: the system is no state-space system, or its plant is not one.

    Example:
        >>> from scipy.signal import StateSpace
        >>> system = StateSpace([[0, 1], [-2, -1]], [[0], [1]], [[1, 0]], [[0]])
        >>> plant = plant_from_system(system, B_d=system.B, S_dd=1, D_r=1, S_rr=0.01)
        >>> plant.time, plant.W.tolist(), plant.V.tolist()
        ('continuous', [[0.0, 0.0], [0.0, 1.0]], [[0.01]])
    """
    data = _read(system)
    for key in keys:
        if key in ("A", "B", "C", "D", "D_u", "dt"):
            raise InputError(f"{key}: expected from the system alone, got it as a key too; remove it")
    time = keys.get("time")
    if time is not None and time != data["time"] and getattr(system, "dt", None) is not None:
        raise InputError(f"time: expected {data['time']}, as the system's dt says, got {time!r}; remove it")
    name = str(getattr(system, "name", None) or "system")
    return plant_from_mapping(data | keys, name="system" if name.startswith(NUMBERED) else name)


def _read(system: Any) -> dict[str, Any]:
    """Return the keys of a plant that a system has."""
    if not all(hasattr(system, key) for key in MATRICES):
        kind = type(system).__name__
        remedy = "convert it with .to_ss()" if hasattr(system, "to_ss") else "give a StateSpace"
        raise InputError(f"system: expected a state-space system with A, B, C, D, got {kind:.40}; {remedy}")
    A, B, C, D = (np.asarray(getattr(system, key)) for key in MATRICES)
    data: dict[str, Any] = {"A": A, "C": C, **_time(getattr(system, "dt", None))}
    if B.size:
        data |= {"B": B, "D_u": D}
    for key, labels in (("states", "state_labels"), ("outputs", "output_labels")):
        names = getattr(system, labels, None)
        if names:
            data[key] = list(names)
    return data


def _time(dt: Any) -> dict[str, Any]:
    if dt is None or (not isinstance(dt, bool) and dt == 0):
        return {"time": "continuous"}
    return {"time": "discrete"} if dt is True else {"time": "discrete", "dt": dt}
