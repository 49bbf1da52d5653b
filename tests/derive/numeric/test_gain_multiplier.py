"""The convex program: its derivatives, and its multiplier, which is the covariance."""

import numpy as np
import pytest

from derive.numeric.enclosure import enclose_riccati
from derive.numeric.gain_ipopt import OPTIONS, symmetric_basis
from derive.numeric.gain_multiplier import program, solve_for_multiplier
from derive.numeric.gain_nlp import optimise_gain
from derive.numeric.lyapunov import error_covariance
from derive.numeric.modes import distance_to_stability
from tests.derive.numeric.plants import STRONG, random_plant

TIMES = ["continuous", "discrete"]


@pytest.mark.parametrize("time", TIMES)
@pytest.mark.parametrize("n", [1, 3, 6])
def test_the_multiplier_is_the_covariance(time, n):
    plant = random_plant(time, n, seed=2)
    result, truth = optimise_gain(plant, "convex"), enclose_riccati(plant, 20)
    np.testing.assert_allclose(result.multiplier, truth.centre, rtol=0, atol=1e-9 * float(truth.trace))
    np.testing.assert_allclose(result.multiplier, result.P, rtol=0, atol=1e-9 * float(truth.trace))
    assert optimise_gain(plant, "reduced").multiplier is None


def test_the_multiplier_of_a_strong_solution():
    plant, P, _ = STRONG["oscillator beside an excited stable mode"]
    np.testing.assert_allclose(optimise_gain(plant).multiplier, P, rtol=0, atol=1e-9)


@pytest.mark.parametrize("time", TIMES)
def test_every_iterate_stabilises(time):
    """Without the guard of the discrete program its iterates leave the stabilising gains and end elsewhere."""
    for seed in range(6):
        F, C, W, K = _plant(time, seed)
        found = solve_for_multiplier(F, C, W, K, time)
        for gain in found.gains:
            assert distance_to_stability(np.linalg.eigvals(F - gain @ C), time).max() < 0
        P = error_covariance(F, C, W, np.eye(2), np.zeros((4, 2)), found.gain, time)
        np.testing.assert_allclose(found.multiplier, P, rtol=0, atol=1e-8 * np.trace(P))


@pytest.mark.parametrize("time", TIMES)
def test_the_derivatives_are_those_of_the_program(time):
    """Central differences of cost and equation give their gradients, of the Lagrangian's gradient its Hessian."""
    import casadi as ca

    rng = np.random.default_rng(1)
    n, l = 3, 2  # noqa: E741
    F = 0.3 * rng.standard_normal((n, n)) - (0.8 * np.eye(n) if time == "continuous" else 0)
    S = symmetric_basis(n)
    nlp, derivatives = program(F, rng.standard_normal((l, n)), np.eye(n), S, time)
    solver = ca.nlpsol("solver", "ipopt", nlp, {**OPTIONS, **derivatives})
    gradient, jacobian, hessian = (solver.get_function(f"nlp_{name}") for name in ("grad_f", "jac_g", "hess_l"))
    multipliers = rng.standard_normal(6)

    def values(x):
        f, df = map(np.array, gradient(x, []))
        g, dg = map(np.array, jacobian(x, []))
        return f, df, g, dg, df + dg.T @ multipliers[:, None]

    X = np.eye(n) + 0.1 * np.ones((n, n))
    x = np.concatenate([S.T @ X.ravel(), 0.05 * rng.standard_normal(n * l)])
    upper = np.array(hessian(x, [], 1, multipliers))
    second = upper + np.triu(upper, 1).T
    _, df, _, dg, _ = values(x)
    for i, step in enumerate(1e-5 * np.eye(len(x))):
        f, _, g, _, slope = ((a - b) / 2e-5 for a, b in zip(values(x + step), values(x - step), strict=True))
        np.testing.assert_allclose(f.item(), df[i, 0], rtol=1e-7, atol=1e-8)
        np.testing.assert_allclose(g.ravel(), dg[:, i], rtol=1e-7, atol=1e-8)
        np.testing.assert_allclose(slope.ravel(), second[i], rtol=1e-6, atol=1e-6)


def _plant(time, seed):
    """Return F, C, W and a gain that just stabilises."""
    rng = np.random.default_rng([seed, time == "discrete"])
    F = rng.standard_normal((4, 4))
    worst = distance_to_stability(np.linalg.eigvals(F), time).max()
    K = rng.standard_normal((4, 2))
    C = rng.standard_normal((2, 4))
    loop = F - (worst + 0.05) * np.eye(4) if time == "continuous" else 0.95 * F / (1 + worst)
    return loop + K @ C, C, np.eye(4), K
