"""Files of designs: JSON, schema lmi-design/1, whose certificate is proved about the plant and the gain beside it.

Plant and gain are JSON numbers, read as doubles and taken for the rationals that these are; the certificate's numbers
are texts "p/q". A dual design holds A, B, Q, R, S, M and a gain K, u = -K x, which stabilises A - B K exactly when
L = K' stabilises A' - L B': it is read as the observer of A', B', Q, R, S. Standard library only.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from fractions import Fraction
from math import isfinite
from typing import Any

from derive.errors import InputError
from lmi.certificate.arithmetic import Exact
from lmi.certificate.design import Decay, DesignCertificate, Floor, Norm
from lmi.certificate.file import (
    MATRICES,
    OUTPUTS,
    STATES,
    JsonNumber,
    read_matrix,
    read_rational,
    require_keys,
    require_size,
    rows_of,
    shown,
    written,
)
from lmi.certificate.sandwich import Certificate, ExactPlant

__all__ = ["CERTIFICATE", "DESIGN", "DUAL_MATRICES", "Design", "design_certificate_dict", "design_from_dict"]

DESIGN = "lmi-design/1"
CERTIFICATE = "lmi-design-certificate/1"

DUAL_MATRICES = ("A", "B", "Q", "R", "S", "M")

WORK = 2 * 10**9
"""Largest (n + l)^3 times the bits of the longest integer: about a minute for all inequalities together."""

DIGITS = 1200
"""Most characters of a number of the plant."""


@dataclass(frozen=True)
class Design:
    """A gain, what is claimed about it, and what the file states besides.

    Attributes:
        certificate: what is to be proved.
        dual: whether it is a state feedback, read as the observer of the dual plant.
        period: sampling period [s] of a discrete plant, 1 when not given.
        gamma: the H-infinity norm that was asked for, or None.
        decay: the decay rate [1/s] that was asked for, or None.
    """

    certificate: DesignCertificate
    dual: bool
    period: Fraction
    gamma: Fraction | None
    decay: Fraction | None


def design_from_dict(data: Any) -> Design:
    """Check plain data and return its design.

    Raises:
        InputError: with one line.
    """
    require_keys("design", data, ("schema", "plant", "objective", "gain", "achieved", "certificate"))
    if data["schema"] != DESIGN:
        raise InputError(f'schema: expected "{DESIGN}", got {shown(data["schema"])}; it is another kind of file')
    objective = data["objective"]
    require_keys("objective", objective, ("name",), ("gamma", "decay", "dual"))
    if not isinstance(objective["name"], str):
        raise InputError(f'objective.name: expected a text, got {shown(objective["name"])}; write "hinf"')
    dual = objective.get("dual", False)
    if not isinstance(dual, bool):
        raise InputError(f"objective.dual: expected true or false, got {shown(dual)}; choose one")
    plant, period = _plant(data["plant"], dual)
    gain = _doubles("gain", data["gain"])
    certificate = _certificate(data["certificate"], plant, gain.T if dual else gain)
    return Design(certificate, dual, period, _asked("gamma", objective), _asked("decay", objective))


def _asked(key: str, objective: Mapping[str, Any]) -> Fraction | None:
    value = objective.get(key)
    return None if value is None else _double(f"objective.{key}", value)


def _plant(data: Any, dual: bool) -> tuple[ExactPlant, Fraction]:
    keys = DUAL_MATRICES if dual else MATRICES
    require_keys("plant", data, ("time", *keys), ("name", "dt"))
    time = data["time"]
    if time not in ("continuous", "discrete"):
        raise InputError(f'plant.time: expected "continuous" or "discrete", got {shown(time)}; choose one')
    A, C, W, V, N, M = (_doubles(f"plant.{key}", data[key]) for key in keys)
    dt = data.get("dt")
    period = Fraction(1) if dt is None else _double("plant.dt", dt)
    if period <= 0 or (dt is not None and time == "continuous"):
        raise InputError(f"plant.dt: expected a positive number in discrete time only, got {shown(dt)}; remove it")
    return ExactPlant(time, A.T, C.T, W, V, N, M) if dual else ExactPlant(time, A, C, W, V, N, M), period


def _certificate(data: Any, plant: ExactPlant, gain: Exact) -> DesignCertificate:
    require_keys("certificate", data, ("schema", "cost"), ("decay", "norm", "floor"))
    if data["schema"] != CERTIFICATE:
        raise InputError(f'certificate.schema: expected "{CERTIFICATE}", got {shown(data["schema"])}; make it anew')
    P_lo, P_up, X = _matrices("cost", data["cost"], ("P_lo", "P_up", "X"))
    cost = Certificate(plant, P_lo, P_up, X, gain)
    decay, norm, floor = (data.get(key) for key in ("decay", "norm", "floor"))
    certificate = DesignCertificate(
        cost,
        None if decay is None else Decay(*_with_number("decay", decay, _bound(plant), "Y")),
        None if norm is None else Norm(*_with_number("norm", norm, "gamma", *_norm_keys(plant))),
        None if floor is None else Floor(*_matrices("floor", floor, _floor_keys(plant))),
    )
    matrices = _all_matrices(certificate)
    require_size(plant, matrices)
    _require_time(plant, matrices)
    return certificate


def _require_time(plant: ExactPlant, matrices: list[Exact]) -> None:
    """Refuse what would take minutes to decide: a design has three times the inequalities of a sandwich."""
    work = (plant.n + plant.l) ** 3 * max(X.bits for X in matrices)
    if work > WORK:
        raise InputError(
            f"certificate: expected (n + l)^3 times the bits of its integers to be at most {WORK}, got {work}; "
            "round its matrices to fewer digits, or certify the cost alone with --plant and --gain"
        )


def _bound(plant: ExactPlant) -> str:
    return "rate" if plant.is_continuous else "radius"


def _norm_keys(plant: ExactPlant) -> tuple[str, ...]:
    return ("P",) if plant.is_continuous else ("P", "G")


def _floor_keys(plant: ExactPlant) -> tuple[str, ...]:
    return ("Z", "H") if plant.is_continuous else ("Z", "H", "K")


def _matrices(name: str, data: Any, keys: tuple[str, ...]) -> list[Exact]:
    require_keys(f"certificate.{name}", data, keys)
    return [read_matrix(f"certificate.{name}.{key}", data[key]) for key in keys]


def _with_number(name: str, data: Any, number: str, *matrices: str) -> tuple[Any, ...]:
    """Read a rational and matrices."""
    require_keys(f"certificate.{name}", data, (number, *matrices))
    value = read_rational(f"certificate.{name}.{number}", data[number])
    return value, *(read_matrix(f"certificate.{name}.{key}", data[key]) for key in matrices)


def _all_matrices(certificate: DesignCertificate) -> list[Exact]:
    cost, decay, norm, floor = certificate.cost, certificate.decay, certificate.norm, certificate.floor
    found = [cost.P_lo, cost.P_up, cost.X, cost.gain, *(getattr(cost.plant, key) for key in MATRICES)]
    if decay is not None:
        found += [decay.Y, Exact.of([[decay.bound]])]
    if norm is not None:
        found += [norm.P, Exact.of([[norm.gamma]]), *([] if norm.G is None else [norm.G])]
    if floor is not None:
        found += [X for X in (floor.Z, floor.H, floor.K) if X is not None]
    return found


def _doubles(name: str, rows: Any) -> Exact:
    """Read a list of rows of JSON numbers as doubles, which are then exact."""
    if not (isinstance(rows, list) and rows and all(isinstance(row, list) and row for row in rows)):
        raise InputError(f"{name}: expected a list of rows, got {shown(rows)}; write [[0.5]] for one number")
    if len(rows) > STATES or len(rows[0]) > OUTPUTS:
        raise InputError(f"{name}: expected at most {STATES} rows and columns, got {len(rows)} x {len(rows[0])}")
    if any(len(row) != len(rows[0]) for row in rows):
        raise InputError(f"{name}: expected rows of equal length; complete the shorter ones")
    return Exact.of([[_double(f"{name}[{i}][{j}]", x) for j, x in enumerate(row, 1)] for i, row in enumerate(rows, 1)])


def _double(name: str, value: Any) -> Fraction:
    """Read a JSON number as the rational that its double is."""
    if not isinstance(value, JsonNumber) or len(value.text) > DIGITS:
        raise InputError(f"{name}: expected a number, got {shown(value)}; write 0.5")
    number = float(value.text)
    if not isfinite(number):
        raise InputError(f"{name}: expected a finite number, got {shown(value)}; write 0.5")
    return Fraction(number)


def design_certificate_dict(certificate: DesignCertificate) -> dict[str, Any]:
    """Return a certificate as plain data, without the plant and the gain."""
    cost, decay, norm, floor = certificate.cost, certificate.decay, certificate.norm, certificate.floor
    data: dict[str, Any] = {"schema": CERTIFICATE}
    data["cost"] = {key: rows_of(getattr(cost, key)) for key in ("P_lo", "P_up", "X")}
    if decay is not None:
        data["decay"] = {_bound(certificate.plant): written(decay.bound), "Y": rows_of(decay.Y)}
    if norm is not None:
        matrices = {key: rows_of(getattr(norm, key)) for key in _norm_keys(certificate.plant)}
        data["norm"] = {"gamma": written(norm.gamma), **matrices}
    if floor is not None:
        data["floor"] = {key: rows_of(getattr(floor, key)) for key in _floor_keys(certificate.plant)}
    return data
