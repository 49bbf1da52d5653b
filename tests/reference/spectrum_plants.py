"""Plants with numbers for the lecture on the frequency domain, each with the hypotheses that a step rests on.

A letter is free unless a hypothesis that the step names ties it: the gain of a step that does not rest on the gain's
equation is any matrix, so that a step holds here only if it names all that it needs.
"""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass

import numpy as np
from scipy.linalg import block_diag, solve_continuous_are, solve_continuous_lyapunov, sqrtm

from derive.context import Declared, DeclaredFact, Theory
from derive.terms import Symbol
from tests.reference.spectrum_values import TOLERANCE, World, gap

SAME = 1e-5  # two roots nearer than this are one


@dataclass(frozen=True)
class Plant:
    """A state matrix, which of its modes the noise drives, and the number of outputs."""

    name: str
    A: np.ndarray
    outputs: int
    driven: tuple[float, ...] = ()  # weights of the process noise, one a state; all of them if left out
    seen: tuple[float, ...] = ()  # the same for the outputs


def _mix(blocks: list[np.ndarray], rng: np.random.Generator) -> np.ndarray:
    """Return a matrix with the eigenvalues of the blocks, in other coordinates."""
    A = block_diag(*blocks)
    T = np.eye(len(A)) + 0.4 * rng.standard_normal(A.shape)
    return T @ A @ np.linalg.inv(T)


def _turn(re: float, im: float) -> np.ndarray:
    return np.array([[re, im], [-im, re]])


def plants() -> list[Plant]:
    """Return plants with one to four states: stable, unstable, on the axis, repeated, complex, with hidden modes."""
    rng = np.random.default_rng(1807)
    stable, unstable = np.array([[-1.3]]), np.array([[0.8]])
    return [
        Plant("one stable state", stable, 1),
        Plant("integrator", np.zeros((1, 1)), 1),
        Plant("unstable pair", _turn(0.4, 1.7), 1),
        Plant("double integrator", np.array([[0.0, 1.0], [0.0, 0.0]]), 1),
        Plant("undamped pair", _turn(0.0, 1.0), 1),
        Plant("repeated unstable", _mix([np.array([[0.6, 1.0], [0.0, 0.6]]), stable], rng), 2),
        Plant("mixed", _mix([_turn(-0.5, 2.0), unstable], rng), 2),
        Plant("four states", _mix([_turn(0.3, 0.9), _turn(-0.2, 3.0)], rng), 2),
        Plant("hidden modes", np.diag([-0.7, 0.5, -1.9]), 2, driven=(1, 1, 0), seen=(0, 1, 1)),
        Plant("not excited on the axis", block_diag([[0.0]], _turn(0.5, 1.2)), 1, driven=(0, 1, 1)),
    ]


# ------------------------------------------------------------------------------------------------ letters
def world(theory: Theory, plant: Plant, assumed: Collection[str], seed: int = 0) -> World | None:
    """Return numbers for all letters of the theory; None if the plant cannot satisfy what is assumed."""
    rng = np.random.default_rng([seed, *map(ord, plant.name)])
    matrices = _open_loop(plant, set(assumed), rng)
    if matrices is None:
        return None
    m, outputs = matrices["C"].shape[::-1]
    A, C, K = (matrices[k] for k in "ACK")
    roots = {"λ": _eig(A), "μ": _eig(A - K @ C), "μ_N": _eig(A - matrices["K_N"] @ C)}
    roots |= {"φ": _random_roots(m, rng), "η": _random_roots(m, rng, stable="poles are stable" in assumed)}
    roots |= _lowest_terms(matrices, roots)
    counts = {f.count: len(roots[name]) for name, f in theory.families.items()}
    information = np.linalg.eigvalsh(C.T @ np.linalg.inv(matrices["V"]) @ C)
    numbers = {
        "π": np.pi, "j": 1j, "s": complex(*rng.uniform(0.5, 3.0, 2)), "ω": rng.uniform(0.3, 3.0),
        "α": rng.uniform(-2.0, 2.0), "β": rng.uniform(-2.0, 2.0),
        "σ0": 1.0 if "σ0 = 1" in assumed else rng.uniform(0.3, 2.0),
        "ω0": 0.0 if "ω0 = 0" in assumed else rng.uniform(-2.0, 2.0),
        "r": rng.uniform(0.3, 2.0), "ρ": rng.uniform(0.3, 2.0),
        "λmin": max(information[0], 0.0) if "least eigenvalue" in assumed else rng.uniform(0.1, 2.0),
        "λmax": information[-1] if "largest eigenvalue" in assumed else rng.uniform(0.1, 2.0),
        "σ_v^2": 1.0 if "σ_v^2 = 1" in assumed else matrices["V"][0, 0] if "V = σ_v^2" in assumed else 1.7,
    }  # fmt: skip
    definitions = {
        d.statement.lhs.name: d.statement.rhs
        for d in theory.declared.values()
        if isinstance(d, Declared) and d.kind == "definition" and isinstance(d.statement.lhs, Symbol)
    }
    return World(matrices, roots, numbers, {"1": 1, "l": outputs, "m": m, **counts}, definitions)


def _open_loop(plant: Plant, assumed: set[str], rng: np.random.Generator) -> dict[str, np.ndarray] | None:
    """Return the matrices of the plant and its filters, with what is assumed of W, V, C and A."""
    A, m = plant.A.copy(), len(plant.A)
    outputs = 1 if "l = 1" in assumed else m if "λmin > 0" in assumed else plant.outputs
    driven = np.diag(plant.driven or (1.0,) * m)
    seen = np.diag(plant.seen or (1.0,) * m)
    if "A stable" in assumed:
        A -= (max(0.0, _eig(A).real.max()) + 0.4) * np.eye(m)
    if "W = 0" in assumed and np.abs(_eig(A).real).min() < SAME:
        A += 0.3 * np.eye(m)  # what is not driven is not on the axis
    B = driven @ rng.standard_normal((m, 1))
    root = driven @ rng.standard_normal((m, m + 1))
    W = np.zeros((m, m)) if "W = 0" in assumed else B @ B.T if "W = BB'" in assumed else root @ root.T
    if "W = BB'" not in assumed:
        B = rng.standard_normal((m, 1))
    C = rng.standard_normal((outputs, m)) @ seen
    V = _positive(outputs, rng)
    if "V = σ_v^2" in assumed:
        V = (1.0 if "σ_v^2 = 1" in assumed else 0.6) * np.eye(outputs)
    if "V = I" in assumed:
        V = np.eye(outputs)
    if ("λmin > 0" in assumed and plant.seen) or (_axis(A, W) and {"W = 0", "W = BB'"} & assumed):
        return None
    N = root @ rng.standard_normal((m + 1, outputs)) @ np.real(sqrtm(V)) / np.sqrt(4.0 * (m + 1) * outputs)
    N = np.zeros((m, outputs)) if {"W = 0", "W = BB'"} & assumed else N
    found = {"A": A, "B": B, "C": C, "W": W, "V": V, "N": N, "V^1/2": np.real(sqrtm(V))}
    found |= _filter(found, assumed, np.zeros((m, outputs)), "", rng) | _filter(found, assumed, N, "_N", rng)
    error = C @ found["P"] @ C.T
    found["Sigma"] = error if "output error covariance" in assumed else _positive(outputs, rng)
    return found


def _filter(letters: dict[str, np.ndarray], assumed: set[str], N: np.ndarray, sub: str, rng: np.random.Generator):
    """Return P and K: those of the strong solution, or any that satisfy what is assumed."""
    A, C, W, V = (letters[k] for k in "ACWV")
    tail = " with cross-covariance" if sub else ""
    strong = bool({"strong solution" + tail, "zeros of det(I + L)"} & assumed)
    P, seen = _riccati(A, C, W, V, N), np.linalg.pinv(C) @ C
    if not strong:
        if "Riccati equation" + tail not in assumed:
            P = _positive(len(A), rng)
            P -= seen @ P @ seen if "CK = 0" in assumed else 0.0
        elif "P >= 0" not in assumed:
            P = _another(letters, N, P)
    K = (P @ C.T + N) @ np.linalg.inv(V)
    if not ("gain" + tail in assumed or strong):
        K = rng.standard_normal(K.shape)
        K -= seen @ K if "CK = 0" in assumed else 0.0
    return {"P" + sub: P, "K" + sub: K}


def _riccati(A: np.ndarray, C: np.ndarray, W: np.ndarray, V: np.ndarray, N: np.ndarray) -> np.ndarray:
    """Return the strong solution; a first state on the axis that is not excited has no error."""
    hidden = int(_axis(A, W))
    return block_diag(
        np.zeros((hidden, hidden)),
        solve_continuous_are(A[hidden:, hidden:].T, C[:, hidden:].T, W[hidden:, hidden:], V, s=N[hidden:]),
    )


def _axis(A: np.ndarray, W: np.ndarray) -> bool:
    """Tell whether the first state is an integrator that nothing excites."""
    return not (A[0].any() or A[1:, 0].any() or W[0].any())


def _another(letters: dict[str, np.ndarray], N: np.ndarray, P: np.ndarray) -> np.ndarray:
    """Return another solution P - D of the Riccati equation, with Y = inv(D), A_c'Y + Y A_c + C'V^-1C = 0."""
    A, C, V = (letters[k] for k in "ACV")
    over = np.linalg.inv(V)
    closed = A - (P @ C.T + N) @ over @ C
    if np.abs(_eig(closed).real).min() < SAME:
        return P
    Y = solve_continuous_lyapunov(closed.T, -C.T @ over @ C)
    return P - np.linalg.inv(Y) if np.linalg.cond(Y) < 1e4 else P


def _positive(n: int, rng: np.random.Generator) -> np.ndarray:
    X = rng.standard_normal((n, n))
    return X @ X.T / n + 0.5 * np.eye(n)


# ------------------------------------------------------------------------------------------------ roots
def _eig(A: np.ndarray) -> np.ndarray:
    return np.linalg.eigvals(A).astype(complex)


def _random_roots(m: int, rng: np.random.Generator, stable: bool = False) -> np.ndarray:
    """Return the roots of a real polynomial: pairs of conjugates, and one real root if their number is odd."""
    re, im = rng.uniform(-2.0, 2.0, m), rng.uniform(0.2, 2.0, m // 2)
    re = -np.abs(re) - 0.1 if stable else re
    pairs = re[: m // 2] + 1j * im
    return np.concatenate([pairs, pairs.conj(), re[m // 2 : m // 2 + m % 2]])


def _lowest_terms(letters: dict[str, np.ndarray], roots: dict[str, np.ndarray]) -> dict[str, np.ndarray]:
    """Return zeros and poles of det(Phi_y)/det V and of det(I + L) after cancelling, and what cancels.

    The zeros of the spectrum are the eigenvalues of its inverse in state space, without any Riccati equation.
    """
    A, C, W, V = (letters[k] for k in "ACWV")
    zeros = _eig(np.block([[A, W], [C.T @ np.linalg.inv(V) @ C, -A.T]]))
    poles = np.concatenate([roots["λ"], -roots["λ"]])
    top, bottom, both = _cancel(zeros, poles)
    zeta, pi, _ = _cancel(roots["μ"], roots["λ"])
    return {"φ'": top, "η'": bottom, "κ": both, "ζ": zeta, "π'": pi, "ν": -roots["λ"]}


def _cancel(zeros: np.ndarray, poles: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return the zeros and poles that are left when equal ones are struck out in pairs, and the poles struck out."""
    left, kept, struck = list(zeros), list[complex](), list[complex]()
    for pole in poles:
        near = min(left, key=lambda z: abs(z - pole), default=None)
        if near is not None and abs(near - pole) < SAME * (1.0 + abs(pole)):
            left.remove(near)
            struck.append(pole)
        else:
            kept.append(pole)
    return np.array(left), np.array(kept), np.array(struck)


# ------------------------------------------------------------------------------------------------ hypotheses
def satisfied(theory: Theory, world: World, name: str) -> bool:
    """Tell whether a hypothesis or definition holds; what holds for all but finitely many points is not looked at."""
    item = theory.declared[name]
    if isinstance(item, Declared) and not item.generic:
        return gap(item.statement, world) < TOLERANCE
    return not (isinstance(item, DeclaredFact) and item.kind == "single") or world.sizes["l"] == 1
