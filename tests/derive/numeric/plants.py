"""Plants for the tests: random ones with a seed, and degenerate ones whose answer is known."""

import numpy as np

from derive.numeric.plant import Plant, plant_from_mapping

OSCILLATOR = [[0.0, 1.0], [-1.0, 0.0]]
ROTATION = [[0.6, -0.8], [0.8, 0.6]]
NOTHING = np.zeros((2, 2))


def random_plant(time: str, n: int, l: int | None = None, seed: int = 0, *, cross: bool = True) -> Plant:  # noqa: E741
    """Return a plant with stable and unstable modes and correlated noises."""
    rng = np.random.default_rng([seed, n, time == "discrete"])
    l = max(1, n // 2) if l is None else l  # noqa: E741
    A = rng.standard_normal((n, n)) / np.sqrt(n)
    G = rng.standard_normal((n + l, n + l)) / np.sqrt(n + l)
    G[n:, n:] += np.eye(l)
    joint = G @ G.T
    data = {"time": time, "A": A, "C": rng.standard_normal((l, n)), "W": joint[:n, :n], "V": joint[n:, n:]}
    return plant_from_mapping({**data, "N": joint[:n, n:]} if cross else data)


def continuous(**data) -> Plant:
    return plant_from_mapping({"time": "continuous", **data})


def discrete(**data) -> Plant:
    return plant_from_mapping({"time": "discrete", **data})


STRONG = {
    "integrator without noise": (continuous(A=0, C=1, W=0, V=1), [[0]], [0]),
    "oscillator without noise": (continuous(A=OSCILLATOR, C=[[1, 0]], W=NOTHING, V=1), NOTHING, [-1j, 1j]),
    "double integrator without noise": (continuous(A=[[0, 1], [0, 0]], C=[[1, 0]], W=NOTHING, V=1), NOTHING, [0, 0]),
    "oscillator beside an excited stable mode": (
        continuous(A=[[0, 1, 0], [-1, 0, 0], [0, 0, -1]], C=[[1, 0, 1]], W=np.diag([0, 0, 1]), V=1),
        np.diag([0, 0, np.sqrt(2) - 1]),
        [-1j, 1j],
    ),
    "integrator beside an unstable mode": (
        continuous(A=[[0, 0], [0, 1]], C=[[1, 1]], W=NOTHING, V=1),
        np.diag([0, 2]),
        [0],
    ),
    "integrator beside a slow unstable mode": (
        continuous(A=np.diag([0, 1e-4, -1]), C=[[1, 1, 1]], W=np.zeros((3, 3)), V=1),
        np.diag([0, 2e-4, 0]),
        [0],
    ),
    "integrator fed by a slow unstable mode": (
        continuous(A=[[0, 1e-4, 0], [0, 1e-4, 0], [0, 0, -1]], C=[[1, 1, 1]], W=np.zeros((3, 3)), V=1),
        5e-5 * np.array([[1, 1, 0], [1, 1, 0], [0, 0, 0]]),
        [0],
    ),
    "cross term that uses up the noise": (continuous(A=2, C=1, W=4, V=1, N=2), [[0]], [0]),
    "constant": (discrete(A=1, C=1, Q=0, R=1), [[0]], [1]),
    "alternation": (discrete(A=-1, C=1, Q=0, R=1), [[0]], [-1]),
    "rotation": (discrete(A=ROTATION, C=[[1, 0]], Q=NOTHING, R=1), NOTHING, [0.6 - 0.8j, 0.6 + 0.8j]),
    "constant beside an unstable mode": (
        discrete(A=[[1, 0], [0, 2]], C=[[1, 1]], Q=NOTHING, R=1),
        np.diag([0, 3]),
        [1],
    ),
}
"""Name: plant, its strong P, the modes that stay on the boundary."""

TWO = np.kron(np.eye(2), OSCILLATOR)
POSITIONS = np.kron(np.eye(2), [[1, 0]])

EDGES = {
    "excited integrators": continuous(A=np.eye(3, k=1), C=np.eye(1, 3), W=np.diag([0, 0, 1]), V=1),
    "excited oscillator": continuous(A=OSCILLATOR, C=[[1, 0]], W=np.diag([0, 1]), V=1),
    "two equal oscillators": continuous(A=TWO, C=POSITIONS, W=np.eye(4), V=np.eye(2)),
    "two equal oscillators, one excited": continuous(A=TWO, C=POSITIONS, W=np.diag([0, 1, 0, 0]), V=np.eye(2)),
    "two equal oscillators in a chain": continuous(
        A=TWO + np.kron(np.eye(2, k=1), np.eye(2)), C=np.eye(1, 4), W=np.zeros((4, 4)), V=1
    ),
    "repeated unstable modes": continuous(A=np.eye(2), C=np.eye(2), W=NOTHING, V=np.eye(2)),
    "unstable Jordan block": continuous(A=[[1, 1], [0, 1]], C=[[1, 0]], W=NOTHING, V=1),
    "repeated stable modes": continuous(A=-np.eye(3), C=np.ones((1, 3)), W=np.eye(3), V=1),
    "uncontrollable unstable mode": continuous(A=np.diag([-1, 2, -3]), C=[[1, 1, 1]], W=np.diag([1, 0, 0]), V=1),
    "uncontrollable boundary mode": continuous(A=np.diag([-1, 0, -3]), C=[[1, 1, 1]], W=np.diag([1, 0, 0]), V=1),
    "unseen stable mode": continuous(A=np.diag([-1, -2]), C=[[1, 0]], W=np.eye(2), V=1),
    "more outputs than states": continuous(
        A=[[0, 1], [-2, 1]], C=[[1, 0], [2, 0], [0, 1]], W=np.eye(2), V=np.eye(3) + 0.5
    ),
    "C of low rank": continuous(A=[[0, 1], [-2, 1]], C=[[1, 0], [2, 0], [0, 0]], W=np.eye(2), V=np.eye(3) + 0.5),
    "C = 0": continuous(A=[[0, 1], [-2, -1]], C=NOTHING, W=np.eye(2), V=np.eye(2)),
    "almost on the boundary, stable": continuous(A=np.diag([-1e-9, -1]), C=[[1, 1]], W=np.diag([0, 1]), V=1),
    "almost on the boundary, unstable": continuous(A=np.diag([1e-9, -1]), C=[[1, 1]], W=np.diag([0, 1]), V=1),
    "cross term of two outputs": continuous(
        A=[[0, 1], [2, -0.3]], C=np.eye(2), W=np.eye(2), V=np.eye(2), N=[[0.2, 0], [0.5, -0.3]]
    ),
    "excited constant": discrete(A=1, C=1, Q=1, R=1),
    "excited rotation": discrete(A=ROTATION, C=[[1, 0]], Q=np.diag([0, 1]), R=1),
    "random walk twice": discrete(A=[[1, 1], [0, 1]], C=[[1, 0]], Q=np.diag([0, 1]), R=1),
    "constant slope": discrete(A=[[1, 1], [0, 1]], C=[[1, 0]], Q=NOTHING, R=1),
    "two equal rotations, one excited": discrete(
        A=np.kron(np.eye(2), ROTATION), C=POSITIONS, Q=np.diag([0, 1, 0, 0]), R=np.eye(2)
    ),
    "delay line": discrete(A=np.eye(3, k=1), C=np.eye(1, 3), Q=np.eye(3), R=1),
    "repeated unstable modes, discrete": discrete(A=2 * np.eye(2), C=np.eye(2), Q=NOTHING, R=np.eye(2)),
    "uncontrollable boundary mode, discrete": discrete(
        A=np.diag([0.5, 1, 0]), C=[[1, 1, 1]], Q=np.diag([1, 0, 0]), R=1
    ),
    "C of low rank, discrete": discrete(A=[[0, 1], [-2, 1]], C=[[1, 0], [2, 0]], Q=np.eye(2), R=np.eye(2) + 0.5),
    "C = 0, discrete": discrete(A=[[0, 0.5], [0.1, 0]], C=[[0, 0]], Q=np.eye(2), R=1),
    "almost on the circle": discrete(A=np.diag([1 + 1e-9, 0.5]), C=[[1, 1]], Q=np.diag([0, 1]), R=1),
    "cross term, discrete": discrete(A=[[1, 1], [0, 1.2]], C=[[1, 0]], Q=np.eye(2), R=1, S=[[0.3], [0.5]]),
}
"""Boundary, repeated and uncontrollable modes, several outputs, C of low rank: plants at an edge of the theory."""

STABILISING = {
    "unstable without noise": (continuous(A=1, C=1, W=0, V=1), [[2]]),
    "stable without noise": (continuous(A=-1, C=1, W=0, V=1), [[0]]),
    "integrator with noise": (continuous(A=0, C=1, W=1, V=1), [[1]]),
    "blind": (continuous(A=-1, C=0, W=3, V=1), [[1.5]]),
    "unstable without noise, discrete": (discrete(A=2, C=1, Q=0, R=1), [[3]]),
    "one step of memory": (discrete(A=0, C=1, Q=5, R=1), [[5]]),
    "golden": (discrete(A=1, C=1, Q=1, R=1), [[(1 + np.sqrt(5)) / 2]]),
    "blind, discrete": (discrete(A=0.5, C=0, Q=3, R=1), [[4]]),
}
"""Name: plant, its stabilising P."""
