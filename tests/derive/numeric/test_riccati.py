"""Riccati equations: residuals in the plant's own letters, known answers, and what no change of coordinates alters."""

import os
from dataclasses import replace

import numpy as np
import pytest

import derive.numeric.riccati as riccati_module
from derive.numeric.boundary import unexcited_boundary
from derive.numeric.enclosure import enclose_riccati
from derive.numeric.extended import cholesky, divided, forward
from derive.numeric.modes import distance_to_stability
from derive.numeric.plant import Plant, example_plant, plant_from_mapping
from derive.numeric.riccati import solve_riccati
from tests.benchmark.published import COLLECTIONS, published
from tests.derive.numeric.plants import (
    EDGES,
    NOTHING,
    OSCILLATOR,
    STABILISING,
    STRONG,
    continuous,
    discrete,
    random_plant,
)

TIMES = ["continuous", "discrete"]

SINGULAR = "V: expected positive definite"
REFUSED = {"carex_2_5": "1j on the boundary", **dict.fromkeys(("darex_1_1", "darex_1_2", "darex_1_4"), SINGULAR)}
"""Published examples without a stabilising solution, or with a singular weight of the input."""


def equation(plant, P):
    """Return the left-hand side of the Riccati equation and the gain, written out as in the docstring."""
    A, C, W, V, N = plant.A, plant.C, plant.W, plant.V, plant.N
    if plant.is_continuous:
        K = P @ C.T + N
        return A @ P + P @ A.T + W - K @ np.linalg.solve(V, K.T), np.linalg.solve(V, K.T).T
    K, S = A @ P @ C.T + N, C @ P @ C.T + V
    return A @ P @ A.T - P + W - K @ np.linalg.solve(S, K.T), np.linalg.solve(S, K.T).T


def assert_solves(plant, solution):
    residual, gain = equation(plant, solution.P)
    size = np.linalg.norm(plant.A) * np.linalg.norm(solution.P) + np.linalg.norm(plant.W)
    assert np.linalg.norm(residual) <= 1e-13 * size
    np.testing.assert_allclose(solution.gain, gain, rtol=1e-10, atol=1e-12 * np.abs(gain).max(initial=0))
    np.testing.assert_array_equal(solution.P, solution.P.T)
    modes = np.linalg.eigvals(plant.A - solution.gain @ plant.C)
    np.testing.assert_allclose(np.poly(modes), np.poly(solution.closed_loop), rtol=1e-8, atol=1e-8)


@pytest.mark.parametrize("time", TIMES)
@pytest.mark.parametrize("n", range(1, 11))
@pytest.mark.parametrize("cross", [False, True])
def test_random_plants(time, n, cross):
    plant = random_plant(time, n, seed=n, cross=cross)
    solution = solve_riccati(plant)
    assert (solution.status, len(solution.boundary_modes)) == ("stabilising", 0)
    assert solution.residual < 1e-17
    assert distance_to_stability(solution.closed_loop, time).max() < 0
    assert_solves(plant, solution)


@pytest.mark.parametrize(("plant", "P", "modes"), STRONG.values(), ids=STRONG)
def test_strong_solutions(plant, P, modes):
    solution = solve_riccati(plant)
    assert solution.status == "strong"
    np.testing.assert_allclose(solution.P, P, atol=1e-14)
    np.testing.assert_allclose(solution.boundary_modes, modes, atol=1e-14)
    np.testing.assert_allclose(solution.closed_loop[plant.n - len(modes) :], modes, atol=1e-14)
    assert distance_to_stability(solution.closed_loop[: plant.n - len(modes)], plant.time).max(initial=-1) < 0
    assert_solves(plant, solution)


@pytest.mark.parametrize(("plant", "P"), STABILISING.values(), ids=STABILISING)
def test_stabilising_solutions(plant, P):
    solution = solve_riccati(plant)
    assert solution.status == "stabilising"
    np.testing.assert_allclose(solution.P, P, rtol=1e-15, atol=1e-300)
    assert_solves(plant, solution)


def test_the_cross_term_can_be_removed_by_hand():
    plant = random_plant("discrete", 5, 2, seed=3)
    removed = plant.N @ np.linalg.inv(plant.V)
    data = {"A": plant.A - removed @ plant.C, "W": plant.W - removed @ plant.N.T, "N": np.zeros((5, 2))}
    same = solve_riccati(replace(plant, **data))
    solution = solve_riccati(plant)
    np.testing.assert_allclose(solution.P, same.P, rtol=1e-12)
    np.testing.assert_allclose(solution.gain, same.gain + removed, rtol=1e-11)


@pytest.mark.parametrize("time", TIMES)
def test_units_change_nothing_but_units(time):
    plant = random_plant(time, 6, 2, seed=7)
    x, y = 10.0 ** np.arange(-9, 9, 3), np.array([1e-6, 1e6])
    X, Y = np.diag(x), np.diag(y)
    scaled = replace(plant, A=X @ plant.A @ np.diag(1 / x), C=Y @ plant.C @ np.diag(1 / x), W=X @ plant.W @ X,
                     V=Y @ plant.V @ Y, N=X @ plant.N @ Y)  # fmt: skip
    ours, theirs = solve_riccati(plant), solve_riccati(scaled)
    np.testing.assert_allclose(theirs.P, X @ ours.P @ X, rtol=1e-11)
    np.testing.assert_allclose(theirs.gain, X @ ours.gain @ np.diag(1 / y), rtol=1e-11)


@pytest.mark.parametrize("time", TIMES)
def test_similar_plants_have_congruent_covariances(time):
    plant = random_plant(time, 5, 2, seed=8)
    T = np.random.default_rng(0).standard_normal((5, 5)) + 3 * np.eye(5)
    inverse = np.linalg.inv(T)
    W = T @ plant.W @ T.T
    moved = replace(plant, A=T @ plant.A @ inverse, C=plant.C @ inverse, W=(W + W.T) / 2, N=T @ plant.N)
    np.testing.assert_allclose(solve_riccati(moved).P, T @ solve_riccati(plant).P @ T.T, rtol=1e-10)


def test_duality_with_the_regulator():
    from scipy.linalg import solve_continuous_are, solve_discrete_are

    for time, solve in (("continuous", solve_continuous_are), ("discrete", solve_discrete_are)):
        plant = random_plant(time, 5, 2, seed=9)
        cost = solve(plant.A.T, plant.C.T, plant.W, plant.V, s=plant.N)
        np.testing.assert_allclose(solve_riccati(plant).P, cost, rtol=1e-9)


def test_more_noise_means_more_error():
    plant = random_plant("continuous", 4, 2, seed=2, cross=False)
    P = solve_riccati(plant).P
    for change in ({"W": plant.W + 0.1 * np.eye(4)}, {"V": 1.1 * plant.V}):
        assert np.linalg.eigvalsh(solve_riccati(replace(plant, **change)).P - P)[0] > 0


@pytest.mark.parametrize("order", [2, 3, 4, 5])
@pytest.mark.parametrize("time", TIMES)
def test_chains_of_integrators_in_any_coordinates(order, time):
    T = np.linalg.qr(np.random.default_rng(order).standard_normal((order, order)))[0]
    boundary = 0.0 if time == "continuous" else 1.0
    A = np.diag(np.ones(order - 1), 1) + boundary * np.eye(order)
    data = {"time": time, "A": T @ A @ T.T, "C": np.eye(1, order) @ T.T, "W": np.zeros((order, order)), "V": 1}
    solution = solve_riccati(plant_from_mapping(data))
    assert solution.status == "strong"
    np.testing.assert_array_equal(solution.P, 0)
    np.testing.assert_allclose(solution.boundary_modes, boundary, atol=1e-7)


@pytest.mark.parametrize("seed", range(6))
def test_boundary_modes_hide_in_a_mixture(seed):
    """Two oscillators and an integrator drive, without noise of their own, excited and unstable modes."""
    from scipy.linalg import block_diag

    rng = np.random.default_rng(seed)
    fast = 3 * np.array(OSCILLATOR)
    A = block_diag(OSCILLATOR, fast, 0, [[-1, 2], [0, -0.5]], 0.5)
    A[5:, :5] = rng.standard_normal((3, 5))
    G = np.vstack([np.zeros((5, 2)), rng.standard_normal((3, 2))])
    C, T = rng.standard_normal((2, 8)), rng.standard_normal((8, 8))
    plain = solve_riccati(continuous(A=A, C=C, W=G @ G.T, V=np.eye(2)))
    W, inverse = T @ G @ G.T @ T.T, np.linalg.inv(T)
    mixed = solve_riccati(continuous(A=T @ A @ inverse, C=C @ inverse, W=(W + W.T) / 2, V=np.eye(2)))
    assert (plain.status, mixed.status) == ("strong", "strong")
    np.testing.assert_allclose(mixed.boundary_modes, [-3j, -1j, 0, 1j, 3j], atol=1e-11)
    np.testing.assert_allclose(plain.P[:5], 0, atol=1e-14)
    np.testing.assert_allclose(mixed.P, T @ plain.P @ T.T, rtol=0, atol=1e-11 * np.abs(mixed.P).max())


def test_a_mode_near_the_boundary_is_not_on_it():
    slow = solve_riccati(continuous(A=[[1e-6, 0], [0, -1]], C=[[1, 1]], W=np.diag([0, 1]), V=1))
    assert slow.status == "stabilising"
    assert slow.P[0, 0] > 1e-6
    excited = solve_riccati(continuous(A=OSCILLATOR, C=[[1, 0]], W=np.diag([0, 1e-8]), V=1))
    assert excited.status == "stabilising"
    np.testing.assert_allclose(np.trace(excited.P), 2e-4, rtol=1e-4)


def test_a_slow_mode_beside_a_fast_one_is_not_on_the_boundary():
    """Relative to the fast mode, 1e9 times faster, the slow ones look as if they were."""
    unstable = solve_riccati(continuous(A=np.diag([1e-3, -1e9]), C=[[1, 1]], W=NOTHING, V=1))
    assert unstable.status == "stabilising"
    np.testing.assert_allclose(unstable.P, np.diag([2e-3, 0]), rtol=1e-12, atol=1e-18)
    stable = solve_riccati(continuous(A=np.diag([-1e-3, -1e9]), C=[[1, 1]], W=NOTHING, V=1))
    assert stable.status == "stabilising"
    np.testing.assert_array_equal(stable.P, 0)


def test_faint_noise_is_noise():
    """An integrator driven with 1e-20 of the noise of its neighbour has P = sqrt(W V) = 1e-10, not 0."""
    solution = solve_riccati(continuous(A=np.diag([0, -1]), C=np.eye(2), W=np.diag([1e-20, 1]), V=np.eye(2)))
    assert solution.status == "stabilising"
    np.testing.assert_allclose(np.diag(solution.P), [1e-10, np.sqrt(2) - 1], rtol=1e-13)


def test_a_long_chain_of_integrators():
    """CAREX example 4.1, dual: x_1n = sqrt(q r) = 1, and others reach 5e8 at n = 21."""
    W = np.zeros((21, 21))
    W[0, 0] = 1.0
    solution = solve_riccati(continuous(A=np.eye(21, k=-1), C=np.eye(21)[-1:], W=W, V=1))
    assert solution.status == "stabilising"
    np.testing.assert_allclose(solution.P[0, -1], 1.0, rtol=1e-11)


def test_stable_modes_without_noise_are_no_boundary():
    split = unexcited_boundary(np.diag([-1.0, 0.0]), np.diag([0.0, 1.0]), "continuous", 1.0, np.eye(2))
    assert (len(split.modes), split.kept.shape, split.removed.shape) == (0, (2, 2), (2, 0))


def test_faint_noise_excites_unless_it_is_the_rounding_of_strong_noise():
    faint = np.diag([1.0, 1e-30])
    for noise, modes in ((faint, 0), (np.ones((2, 2)), 1)):
        split = unexcited_boundary(np.diag([-1.0, 0.0]), faint, "continuous", 1.0, noise)
        assert len(split.modes) == modes


@pytest.mark.parametrize("c", [1.0, 0.7, 1 / 3, 1e-5])
def test_a_cross_term_that_cancels_a_to_rounding(c):
    """F = A - N V^-1 C and W - N V^-1 N' are 0 but for rounding relative to A and W."""
    solution = solve_riccati(continuous(A=2, C=c, W=(2 / c) ** 2, V=1, N=2 / c))
    assert (solution.status, solution.P[0, 0]) == ("strong", 0)
    assert abs(solution.boundary_modes[0]) < 1e-15


def test_an_impossible_plant_fails_without_a_crash():
    hidden = Plant(time="continuous", A=np.eye(1), C=np.zeros((1, 1)), W=np.eye(1), V=np.eye(1), N=np.zeros((1, 1)),
                   M=np.eye(1))  # fmt: skip
    assert solve_riccati(hidden).status == "failed"


def test_the_example():
    plant = example_plant()
    solution = solve_riccati(plant)
    assert (solution.status, solution.newton_steps > 0) == ("stabilising", True)
    assert_solves(plant, solution)


DAMPED = np.array([[0.0, 1.0], [-2.0, -1.0]])
ILL_CONDITIONED = {
    "two sensors almost alike": continuous(A=-1, C=[[1], [2]], W=1, V=[[1, 1 - 1e-12], [1 - 1e-12, 1]]),
    "sharp sensor": continuous(A=DAMPED, C=[[1e20, 0]], W=np.eye(2), V=1),
    "slow states": continuous(A=1e-20 * DAMPED, C=[[1, 0]], W=np.eye(2), V=1),
    "fast growth": discrete(A=1e20 * DAMPED, C=[[1, 0]], Q=np.eye(2), R=1),
    "almost on the circle": EDGES["almost on the circle"],
    "oscillator with weak noise": continuous(A=OSCILLATOR, C=[[1, 0]], W=np.diag([0, 1e-24]), V=1),
}


@pytest.mark.parametrize("name", ILL_CONDITIONED)
def test_the_stated_error_holds_where_double_precision_ends(name):
    plant = ILL_CONDITIONED[name]
    solution, enclosure = solve_riccati(plant), enclose_riccati(plant, digits=20)
    assert (solution.status, solution.reason, enclosure.status) == ("stabilising", "", "verified")
    assert enclosure.distance(solution.P) <= np.linalg.norm(solution.error)
    assert solution.relative_error < 1e-13


@pytest.mark.parametrize("time", TIMES)
@pytest.mark.parametrize("a", [0.5, 2.0])
def test_the_condition_number_of_a_scalar_is_attained(time, a):
    """A, W and V grow together by 1e-6, all of which makes P grow."""
    data = {"time": time, "A": a, "C": 3, "W": 5, "V": 2}
    solution = solve_riccati(plant_from_mapping(data))
    more = {key: data[key] * (1 + 1e-6) for key in "AWV"}
    growth = solve_riccati(plant_from_mapping({**data, **more})).P[0, 0] / solution.P[0, 0] - 1
    np.testing.assert_allclose(growth / 1e-6, solution.condition, rtol=1e-4)


@pytest.mark.parametrize("time", TIMES)
def test_the_condition_number_is_a_bound(time):
    plant = random_plant(time, 4, 2, seed=5, cross=False)
    solution = solve_riccati(plant)
    rng = np.random.default_rng(0)
    for _ in range(10):
        D = rng.standard_normal((4, 4))
        for key, change in (("A", D), ("W", D @ D.T)):
            X = getattr(plant, key)
            changed = X + 1e-6 * change * np.linalg.norm(X, 2) / np.linalg.norm(change, 2)
            moved = solve_riccati(replace(plant, **{key: changed})).P - solution.P
            relative = np.linalg.norm(moved, 2) / np.linalg.norm(solution.P, 2) / 1e-6
            assert 1e-3 * solution.condition < relative < solution.condition


def test_floating_point_alone_does_not_decide_beside_the_boundary(monkeypatch):
    """An indefinite W puts the closed loop at j and -j; its computed eigenvalues are stable, by 3e-10."""
    W = -np.array([[11.0, 5.0], [5.0, 2.0]])
    plant = replace(continuous(A=[[3, 4], [1, 2]], C=[[1, 1]], W=NOTHING, V=1), W=W)
    for largest in (64, 1):
        monkeypatch.setattr(riccati_module, "LARGEST", largest)
        solution = solve_riccati(plant)
        assert (solution.status, np.isinf(solution.condition), np.isinf(solution.relative_error)) == (
            "failed",
            True,
            True,
        )
        assert solution.reason.endswith("1j on the boundary or too near to tell")


def test_modes_near_the_boundary_are_named():
    near = solve_riccati(continuous(A=np.diag([-1e-9, -1]), C=[[1, 1]], W=np.diag([0, 1]), V=1))
    np.testing.assert_allclose(near.near_boundary, [-1e-9], rtol=1e-6)
    assert len(solve_riccati(example_plant()).near_boundary) == 0
    strong = solve_riccati(STRONG["oscillator without noise"][0])
    np.testing.assert_array_equal(strong.near_boundary, strong.boundary_modes)


def test_noise_that_is_faint_beside_other_noise_excites_all_the_same():
    """Both states are driven, although in balanced coordinates one is with 1e-40 of the noise of the other."""
    plant = continuous(A=1e-40 * np.array([[0, 1], [-2, -1]]), C=[[1, 0]], W=np.eye(2), V=1)
    solution = solve_riccati(plant)
    assert (solution.status, len(solution.boundary_modes)) == ("stabilising", 0)
    p12 = np.sqrt(2) - 1  # the equations without the terms that are 1e-40 of the others
    np.testing.assert_allclose(solution.P, [[1, p12], [p12, 1e40 * p12]], rtol=1e-15)


@pytest.mark.parametrize("V", [np.zeros((1, 1)), -np.eye(1)])
def test_measurements_without_noise_are_refused_by_name(V):
    solution = solve_riccati(replace(continuous(A=-1, C=1, W=1, V=1), V=V))
    assert (solution.status, solution.reason[:27]) == ("failed", "V: expected positive defini")
    assert np.isinf(solution.error).all()


def test_extended_precision():
    rng = np.random.default_rng(0)
    G, X = rng.standard_normal((4, 4)), rng.standard_normal((3, 4))
    V = (G @ G.T + np.eye(4)).astype(np.longdouble)
    T = cholesky(V)
    np.testing.assert_allclose(T @ T.T, V, rtol=1e-17, atol=1e-17)
    np.testing.assert_allclose(T @ forward(T, X.T), X.T, rtol=1e-15)
    np.testing.assert_allclose(divided(X.astype(np.longdouble), V) @ V, X, rtol=1e-15, atol=1e-16)


@pytest.mark.skipif("DERIVE_BENCH" not in os.environ, reason="set DERIVE_BENCH to a folder of CAREX and DAREX archives")
@pytest.mark.parametrize("collection", COLLECTIONS)
def test_published_collections(collection):
    for example in published(collection):
        if example.plant.n > 64:
            continue
        solution = solve_riccati(example.plant)
        if example.name in REFUSED:
            assert (solution.status, REFUSED[example.name] in solution.reason) == ("failed", True)
        else:
            assert example.error(solution.P) < 1.5e-16, example.name
            assert np.all(np.abs(solution.P - example.truth - example.rest) <= solution.error), example.name
