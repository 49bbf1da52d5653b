"""The dual problem: the gain K of state feedback u = -K x is, transposed, an observer gain of the transposed plant."""

from collections.abc import Mapping
from os import PathLike
from pathlib import Path
from typing import Any

import numpy as np

from derive.errors import InputError
from derive.numeric.fields import Fields
from derive.numeric.plant import Plant, plant_from_mapping

__all__ = ["dual_from_mapping", "load_dual"]

MATRICES = ("A", "B", "Q", "R", "S", "M")

SHARED = ("time", "dt", "name", "source", "states", "units")
NOISE = ("W", "V", "N")
UNUSED = ("C", "D_u", "outputs")
"""Keys of a plant that state feedback does not depend on."""


def load_dual(path: str | PathLike[str]) -> Plant:
    """Read a regulator's problem from a .toml, .json, .npz or .mat file and return its dual.

    Raises:
        InputError: the file cannot be read, or its plant is not one; the message starts with the file's name.
    """
    from derive.numeric.files import read_mapping

    path = Path(path)
    data = read_mapping(path)
    try:
        return dual_from_mapping(data, name=path.stem)
    except InputError as error:
        raise InputError(f"{path}: {error}") from None


def dual_from_mapping(data: Mapping[str, Any], name: str = "plant") -> Plant:
    """Check a regulator's problem and return the observer's problem with the same numbers.

    The regulator x' = A x + B u + d, u = -K x, has the cost of x'Q x + 2 x'S u + u'R u for a white noise d of intensity
    M; in discrete time likewise. The observer of x' = A'x + w, y = B'x + v with noise Q, R, S and the weight M has the
    gain L = K' and the same cost: tr(M P) is what the regulator pays, P solves both Riccati equations.

    Args:
        data: `time`, `A`, `B`, `Q`, `R`, optionally `S`, `M`, `dt`, `name`, `source`, `states`, `units`. The outputs
            `C`, `D_u`, `outputs` may be there and do not matter.
        name: name of the plant when the mapping has none.

    Returns:
        The plant with A', B', Q, R, S, M in the place of A, C, W, V, N, M.

    Raises:
        InputError: with one line that says what was expected, what was got and the remedy.

    Source: H. Kwakernaak and R. Sivan, Linear Optimal Control Systems, Wiley 1972, section 4.4.3.

    Example:
        >>> weights = {"Q": [[1, 0], [0, 0]], "R": 1}
        >>> plant = dual_from_mapping({"time": "continuous", "A": [[0, 1], [0, 0]], "B": [[0], [1]], **weights})
        >>> plant.A.tolist(), plant.C.tolist()
        ([[0.0, 0.0], [1.0, 0.0]], [[0.0, 1.0]])
    """
    if not isinstance(data, Mapping):
        raise InputError(f"plant: expected keys with values, got {type(data).__name__}; give A, B, Q, R by name")
    for key in NOISE:
        if data.get(key) is not None:
            raise InputError(f"{key}: expected the weights Q, R, S of the dual problem, got noise; rename or remove it")
    try:
        return _dual(Fields.of(data, (*SHARED, *MATRICES, *UNUSED), {}), name)
    except InputError as error:
        raise InputError(_renamed(str(error))) from None


def _dual(fields: Fields, name: str) -> Plant:
    A, B = _square(fields), fields.matrix("B", None, None, "the input matrix")
    n, m = len(A), B.shape[1]
    if len(B) != n:
        raise InputError(f"B: expected shape ({n}, any), got {B.shape}; states are counted by A")
    Q = fields.matrix("Q", n, n, "the weight of the states")
    R = fields.matrix("R", m, m, "the weight of the inputs")
    weights = {"W": Q, "V": R, "N": fields.optional("S", n, m), "M": fields.optional("M", n, n)}
    shared = {key: fields.values[key] for key in SHARED if key in fields}
    return plant_from_mapping({**shared, "A": A.T, "C": B.T, **weights}, name)


def _square(fields: Fields) -> np.ndarray:
    A = fields.matrix("A", None, None, "the state matrix")
    if A.shape[0] != A.shape[1]:
        raise InputError(
            f"A: expected a square matrix, got shape {A.shape}; A maps the state to its rate or next value"
        )
    return A


def _renamed(message: str) -> str:
    """Say in the regulator's words what the observer's problem lacks."""
    words = {
        "(A, C): not detectable": "(A, B): not stabilisable",
        "is unobservable; measure an output that sees it": "is uncontrollable; add an input that moves it",
        "[[W, N], [N', V]]": "[[Q, S], [S', R]]",
        "N is too large for W and V": "S is too large for Q and R",
        "every output needs some noise": "every input needs some weight",
        "a covariance has": "a weight has",
        "outputs by C": "inputs by B",
    }
    for word, other in words.items():
        message = message.replace(word, other)
    name, colon, rest = message.partition(":")
    return f"{ {'W': 'Q', 'V': 'R', 'N': 'S'}.get(name, name) }{colon}{rest}"
