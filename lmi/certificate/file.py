"""Files of certificates: JSON, schema lmi-certificate/1, every number a text "p/q"; sizes are bounded before any work.

Standard library only. Nothing but the plant, the matrices and the gain is read: a file cannot state a bound.
"""

import json
import os
import re
from collections.abc import Mapping
from fractions import Fraction
from math import lcm
from pathlib import Path
from typing import Any

from derive.errors import InputError
from derive.files import write
from lmi.certificate.arithmetic import Exact
from lmi.certificate.sandwich import Certificate, ExactPlant

__all__ = [
    "MATRICES", "OUTPUTS", "SCHEMA", "STATES", "JsonNumber", "certificate_from_dict", "read_certificate", "read_json",
    "read_matrix", "read_rational", "require_keys", "require_size", "rows_of", "shown", "write_certificate", "written",
]  # fmt: skip

SCHEMA = "lmi-certificate/1"

CARRIERS = ("lmi-validate/1",)
"""Schemas that hold a certificate under the key `certificate`."""

BYTES = 64_000_000
STATES = 200
OUTPUTS = 200
DIGITS = 1200
"""Decimal digits of one integer."""

COMMON_BITS = 8000
"""Bits of the common denominator of a matrix."""

SIZE = 200_000
"""Largest (n + l) times the bits of the longest integer."""

RATIONAL = re.compile(r"(-?[0-9]+)(?:/([0-9]+))?")
MATRICES = ("A", "C", "W", "V", "N", "M")


class JsonNumber:
    """A number of JSON, which is no rational: it was rounded, or may have been."""

    def __init__(self, text: str) -> None:
        self.text = text

    def __repr__(self) -> str:
        return self.text


def read_certificate(path: str | os.PathLike[str]) -> Certificate:
    """Read a certificate, or the one that a validation holds.

    Raises:
        InputError: no such file, too large, no JSON, keys missing or unknown, no rationals, wrong shapes.
    """
    data = read_json(path)
    try:
        return certificate_from_dict(data)
    except InputError as error:
        raise InputError(f"{path}: {error}") from None


def read_json(path: str | os.PathLike[str]) -> Any:
    """Read JSON of bounded size whose numbers stay texts and whose keys are given once.

    Raises:
        InputError: no such file, too large, no JSON.
    """
    path = Path(path)
    try:
        if path.is_dir():
            raise InputError(f"{path}: expected a file, got a folder; name the certificate in it")
        if path.stat().st_size > BYTES:
            raise InputError(f"{path}: expected at most {BYTES} bytes, got {path.stat().st_size}; it is no certificate")
        text = path.read_bytes().decode("utf-8-sig")
        return json.loads(
            text, object_pairs_hook=_unique, parse_int=JsonNumber, parse_float=JsonNumber, parse_constant=JsonNumber
        )
    except FileNotFoundError:
        raise InputError(f"{path}: expected a file, found none; check the path") from None
    except OSError as error:
        raise InputError(f"{path}: expected a readable file, got {error.strerror or error}; check the file") from None
    except InputError:
        raise
    except (ValueError, RecursionError) as error:
        what = " ".join(str(error).split())[:120]
        raise InputError(f"{path}: expected JSON, got an error: {what}; write the file anew") from None


def _unique(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    data = dict(pairs)
    if len(data) < len(pairs):
        raise ValueError("a key is given twice")
    return data


def certificate_from_dict(data: Any) -> Certificate:
    """Check plain data and return its certificate.

    Raises:
        InputError: with one line.
    """
    if isinstance(data, Mapping) and data.get("schema") in CARRIERS:
        data = data.get("certificate")
    require_keys("certificate", data, ("schema", "plant", "P_lo", "P_up", "X", "gain"))
    if data["schema"] != SCHEMA:
        raise InputError(f'schema: expected "{SCHEMA}", got {shown(data["schema"])}; it is another kind of file')
    plant = data["plant"]
    require_keys("plant", plant, ("time", *MATRICES))
    if plant["time"] not in ("continuous", "discrete"):
        raise InputError(f'plant.time: expected "continuous" or "discrete", got {shown(plant["time"])}; choose one')
    exact_plant = ExactPlant(plant["time"], *(read_matrix(f"plant.{key}", plant[key]) for key in MATRICES))
    certificate = Certificate(exact_plant, *(read_matrix(key, data[key]) for key in ("P_lo", "P_up", "X", "gain")))
    require_size(exact_plant, _all_matrices(certificate))
    return certificate


def require_size(plant: ExactPlant, matrices: list[Exact]) -> None:
    """Refuse matrices with integers so long that deciding takes more than about a minute.

    Raises:
        InputError: says how long they are.
    """
    size = (plant.n + plant.l) * max(X.bits for X in matrices)
    if size > SIZE:
        raise InputError(
            f"certificate: expected (n + l) times the bits of its integers to be at most {SIZE}, got {size}; "
            "round its matrices to fewer digits"
        )


def _all_matrices(certificate: Certificate) -> list[Exact]:
    plant = certificate.plant
    own = [certificate.P_lo, certificate.P_up, certificate.X, certificate.gain]
    return [*own, *(getattr(plant, key) for key in MATRICES)]


def require_keys(name: str, data: Any, keys: tuple[str, ...], optional: tuple[str, ...] = ()) -> None:
    """Refuse what is no object with these keys, and perhaps the optional ones.

    Raises:
        InputError: names the key that is missing or unknown.
    """
    if not isinstance(data, Mapping):
        raise InputError(f"{name}: expected the keys {', '.join(keys)}, got {shown(data)}; write an object")
    for key in keys:
        if key not in data:
            raise InputError(f"{name}: missing key {key}; expected {', '.join(keys)}")
    for key in data:
        if key not in keys + optional:
            raise InputError(f"{name}: unknown key {shown(key)}; expected {', '.join(keys + optional)}")


def read_matrix(name: str, rows: Any) -> Exact:
    """Read a list of rows of rationals.

    Raises:
        InputError: no rows of equal length, too many, or an entry that is no rational.
    """
    if not (isinstance(rows, list) and rows and all(isinstance(row, list) and row for row in rows)):
        raise InputError(f'{name}: expected a list of rows, got {shown(rows)}; write [["1/2"]] for one number')
    if len(rows) > STATES or len(rows[0]) > OUTPUTS:
        raise InputError(f"{name}: expected at most {STATES} rows and columns, got {len(rows)} x {len(rows[0])}")
    if any(len(row) != len(rows[0]) for row in rows):
        raise InputError(f"{name}: expected rows of equal length; complete the shorter ones")
    values = [[read_rational(f"{name}[{i}][{j}]", x) for j, x in enumerate(row, 1)] for i, row in enumerate(rows, 1)]
    common = 1
    for row in values:
        for x in row:
            common = lcm(common, x.denominator)
            if common.bit_length() > COMMON_BITS:
                raise InputError(
                    f"{name}: expected a common denominator of at most {COMMON_BITS} bits; use powers of two"
                )
    return Exact.of(values)


def read_rational(name: str, value: Any) -> Fraction:
    """Read a rational "p/q".

    Raises:
        InputError: it is none, or too long.
    """
    match = RATIONAL.fullmatch(value) if isinstance(value, str) else None
    if match is None:
        raise InputError(f'{name}: expected a rational as a text "p/q", got {shown(value)}; write "1/2" for 0.5')
    digits = max(len(part) for part in match.groups(default=""))
    if digits > DIGITS:
        raise InputError(f"{name}: expected integers of at most {DIGITS} digits, got {digits}; round it")
    if match[2] is not None and not int(match[2]):
        raise InputError(f"{name}: expected a denominator that is not 0, got {shown(value)}")
    return Fraction(int(match[1]), int(match[2] or 1))


def shown(value: Any) -> str:
    """Return a value as one short line for an error."""
    text = " ".join(repr(value).split())
    return text if len(text) <= 40 else text[:37] + "..."


def certificate_dict(certificate: Certificate) -> dict[str, Any]:
    """Return a certificate as plain data."""
    plant = certificate.plant
    matrices = {key: rows_of(getattr(plant, key)) for key in MATRICES}
    own = {key: rows_of(getattr(certificate, key)) for key in ("P_lo", "P_up", "X", "gain")}
    return {"schema": SCHEMA, "plant": {"time": plant.time, **matrices}, **own}


def rows_of(X: Exact) -> list[list[str]]:
    """Return a matrix as rows of texts "p/q"."""
    return [[written(Fraction(x, X.denominator)) for x in row] for row in X.numerators]


def written(x: Fraction) -> str:
    """Return a rational as a text "p/q"."""
    return f"{x.numerator}/{x.denominator}"


def write_certificate(certificate: Certificate, path: str | os.PathLike[str]) -> None:
    """Write a certificate.

    Raises:
        InputError: the file cannot be written.
    """
    write(Path(path), _text(certificate_dict(certificate)))


def _text(data: Any) -> str:
    """Return JSON with one row of a matrix a line."""
    text = json.dumps(data, indent=1)
    text = re.sub(r'\[\s+"(?=-?[0-9])', '["', text)
    text = re.sub(r'",\s+"(?=-?[0-9])', '", "', text)
    return re.sub(r'"\s+\]', '"]', text) + "\n"
