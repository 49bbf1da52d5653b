"""Plants with numbers for the lecture on the frequency domain in discrete time, with what a step rests on.

A letter is free unless a hypothesis that the step names ties it, as in ``spectrum_plants``.
"""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass

import numpy as np
from scipy.linalg import block_diag, solve_discrete_are

from derive.context import Declared, Theory
from derive.terms import Symbol
from tests.reference.spectrum_values import World

SAME = 1e-5  # an eigenvalue nearer to -1 than this is -1
FAMILIES = {"ζ": "χ", "ξ": "ψ"}  # eigenvalues other than -1, and those at -1


@dataclass(frozen=True)
class DiscretePlant:
    """A state matrix, and how many of its first states, which are decoupled and stay on the circle, nothing drives."""

    name: str
    A: np.ndarray
    outputs: int = 1
    hidden: int = 0


def _turn(size: float, angle: float) -> np.ndarray:
    return size * np.array([[np.cos(angle), np.sin(angle)], [-np.sin(angle), np.cos(angle)]])


def _mix(blocks: list[np.ndarray], rng: np.random.Generator) -> np.ndarray:
    A = block_diag(*blocks)
    T = np.eye(len(A)) + 0.4 * rng.standard_normal(A.shape)
    return T @ A @ np.linalg.inv(T)


def plants() -> list[DiscretePlant]:
    """Return plants inside, on and outside of the circle, singular ones, and such with eigenvalues at -1."""
    rng = np.random.default_rng(3535)
    one = np.array([[1.0]])
    shift = np.array([[0.0, 1.0], [0.0, 0.0]])
    return [
        DiscretePlant("stable", 0.6 * one),
        DiscretePlant("unstable", -1.8 * one),
        DiscretePlant("random walk", one),
        DiscretePlant("driven at -1", -one),
        DiscretePlant("not driven at -1", block_diag(-one, _turn(1.5, 2.0)), hidden=1),
        DiscretePlant("not driven at 1 and -1", np.diag([1.0, -1.0, 0.4, -2.5]), 2, hidden=2),
        DiscretePlant("not driven on the circle", block_diag(_turn(1.0, 0.8), [[1.7]]), 1, hidden=2),
        DiscretePlant("delay", shift),
        DiscretePlant("singular and unstable", _mix([shift, 1.9 * one], rng), 2),
        DiscretePlant("mixed", _mix([_turn(1.4, 1.1), _turn(0.5, 2.3)], rng), 2),
        DiscretePlant("at -1 twice", np.array([[-1.0, 1.0], [0.0, -1.0]])),
        DiscretePlant("nearly on the circle", block_diag(_turn(0.98, 2.9), _turn(1.03, 0.3)), 2),
    ]


def world(theory: Theory, plant: DiscretePlant, assumed: Collection[str], seed: int = 0) -> World:
    """Return numbers for all letters of the theory."""
    rng = np.random.default_rng([seed, *map(ord, plant.name)])
    matrices = _matrices(plant, set(assumed), rng)
    roots = _roots(matrices, set(assumed), rng)
    outputs, states = matrices["C"].shape
    counts = {f.count: len(roots[name]) for name, f in theory.families.items()}
    numbers = {
        "π": np.pi, "j": 1j, "s": complex(*rng.uniform(0.5, 3.0, 2)), "ω": rng.uniform(0.3, 3.0),
        "α": rng.uniform(-2.0, 2.0), "β": rng.uniform(-2.0, 2.0), "γ": rng.uniform(-2.0, 2.0),
        "σ0": 1.0 if "σ0 = 1" in assumed else rng.uniform(0.3, 2.0),
        "ω0": 0.0 if "ω0 = 0" in assumed else rng.uniform(-2.0, 2.0),
        "r": rng.uniform(0.3, 2.0), "ρ": rng.uniform(0.3, 2.0),
    }  # fmt: skip
    definitions = {
        d.statement.lhs.name: d.statement.rhs
        for d in theory.declared.values()
        if isinstance(d, Declared) and d.kind == "definition" and isinstance(d.statement.lhs, Symbol)
        if d.name != "S" or "S" in assumed
    }
    sizes = {"1": 1, "l": outputs, **counts, "m": states}
    return World(matrices, roots, numbers, sizes, definitions, imaged=("ζ", "ξ"))


def positive(n: int, rng: np.random.Generator) -> np.ndarray:
    """Return a positive definite matrix."""
    X = rng.standard_normal((n, n))
    return X @ X.T / n + 0.5 * np.eye(n)


def _matrices(plant: DiscretePlant, assumed: set[str], rng: np.random.Generator) -> dict[str, np.ndarray]:
    """Return the plant and its predictor: strong, or with any P that satisfies what is assumed."""
    A, n, hidden = plant.A, len(plant.A), plant.hidden
    C, R, Q = rng.standard_normal((plant.outputs, n)), positive(plant.outputs, rng), positive(n, rng)
    Q[:hidden], Q[:, :hidden] = 0.0, 0.0
    strong = "strong solution" in assumed
    if strong:
        rest = solve_discrete_are(A[hidden:, hidden:].T, C[:, hidden:].T, Q[hidden:, hidden:], R)
        P = block_diag(np.zeros((hidden, hidden)), rest)
    else:
        P = positive(n, rng)
    S = C @ P @ C.T + R
    K = A @ P @ C.T @ np.linalg.inv(S)
    if not strong and "Riccati equation" in assumed:
        Q = P - A @ P @ A.T + K @ S @ K.T
    K = K if "gain" in assumed or strong else rng.standard_normal(K.shape)
    S = S if "S" in assumed or strong else positive(len(S), rng)
    return {"A": A, "C": C, "Q": Q, "R": R, "P": P, "K": K, "S": S}


def _roots(letters: dict[str, np.ndarray], assumed: set[str], rng: np.random.Generator) -> dict[str, np.ndarray]:
    """Return the eigenvalues of the matrices where that is assumed, and otherwise any that satisfy what is."""
    A, closed = letters["A"], letters["A"] - letters["K"] @ letters["C"]
    known = {
        "ζ": "eigenvalues of A at -1 apart" in assumed,
        "ξ": bool({"eigenvalues of A - KC", "strong solution"} & assumed),
    }
    of_A = known["ζ"] or "eigenvalues of A" in assumed
    found = {"λ": np.linalg.eigvals(A).astype(complex) if of_A else random_roots(len(A), rng)}
    for name, matrix in (("ζ", A), ("ξ", closed)):
        end = FAMILIES[name]
        values = np.linalg.eigvals(matrix).astype(complex) if known[name] else random_roots(5, rng)
        near = np.abs(values + 1.0) < SAME
        found[name], found[end] = values[~near], np.full(near.sum(), -1.0 + 0j)
        if not known[name]:
            found[end] = np.full(2, -1.0 + 0j) if f"Re {end} = -1" in assumed else random_roots(3, rng)
    return found


def random_roots(m: int, rng: np.random.Generator) -> np.ndarray:
    """Return the roots of a real polynomial, inside and outside of the circle."""
    pairs = rng.uniform(0.2, 2.0, m // 2) * np.exp(1j * rng.uniform(0.3, 2.9, m // 2))
    return np.concatenate([pairs, pairs.conj(), rng.uniform(-2.5, 2.5, m % 2)])
