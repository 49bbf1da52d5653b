"""The gain by nonlinear programming: agrees with the Riccati solution, whose code it does not use."""

import ast
from pathlib import Path

import numpy as np
import pytest

import derive.numeric
from derive.errors import InputError
from derive.numeric.enclosure import enclose_riccati
from derive.numeric.gain_nlp import optimise_gain
from derive.numeric.lyapunov import error_covariance
from derive.numeric.modes import distance_to_stability
from derive.numeric.plant import Plant, example_plant
from derive.numeric.riccati import solve_riccati
from tests.derive.numeric.plants import NOTHING, STABILISING, STRONG, continuous, discrete, random_plant
from tests.derive.numeric.test_log_det import chain

TIMES = ["continuous", "discrete"]
FORMS = ["convex", "reduced"]
FOLDER = Path(derive.numeric.__file__).parent


@pytest.mark.parametrize("time", TIMES)
@pytest.mark.parametrize("form", FORMS)
@pytest.mark.parametrize("n", range(1, 9))
def test_random_plants(time, form, n, capfd):
    plant = random_plant(time, n, seed=n)
    result, solution = optimise_gain(plant, form), enclose_riccati(plant, 20)
    trace = float(solution.trace)
    assert (result.status, result.form) == ("optimal", form)
    assert result.trace == pytest.approx(trace, rel=1e-14)
    np.testing.assert_allclose(result.P, solution.centre, rtol=0, atol=1e-13 * trace)
    gain = solve_riccati(plant).gain
    np.testing.assert_allclose(result.gain, gain, rtol=0, atol=1e-6 * np.abs(gain).max())
    assert distance_to_stability(np.linalg.eigvals(plant.A - result.gain @ plant.C), time).max() < 0
    P = error_covariance(plant.A, plant.C, plant.W, plant.V, plant.N, result.gain, time)
    np.testing.assert_allclose(result.P, P, rtol=1e-8, atol=1e-10 * result.trace)
    assert capfd.readouterr() == ("", "")


@pytest.mark.parametrize("form", FORMS)
def test_the_history_falls_from_the_start_to_the_trace(form):
    result = optimise_gain(random_plant("continuous", 4, 2, seed=1), form)
    assert len(result.history) == result.iterations + 1 > 5
    assert min(result.history) == pytest.approx(result.trace, rel=1e-12)
    assert result.history[0] > 1.1 * result.trace


@pytest.mark.parametrize("time", TIMES)
def test_variances_over_many_orders_of_magnitude(time):
    """One output, many unstable modes and no noise: P spans 16 orders, and double precision loses it elsewhere."""
    rng = np.random.default_rng(3)
    n = 10
    A = rng.standard_normal((n, n)) / np.sqrt(n) + (0.6 * np.eye(n) if time == "continuous" else 0)
    A = A if time == "continuous" else 1.6 * A
    given = (continuous if time == "continuous" else discrete)(
        A=A, C=rng.standard_normal((1, n)), V=1, W=np.zeros((n, n))
    )
    trace = float(enclose_riccati(given, 20).trace)
    assert trace > 1e4
    for form in FORMS:
        result = optimise_gain(given, form)
        assert (result.status, result.trace) == ("optimal", pytest.approx(trace, rel=1e-12))


def test_the_form_is_chosen_by_size():
    small, large = (chain(masses, 0.1) for masses in (1, 9))
    assert optimise_gain(small).form == "convex"
    result = optimise_gain(large)
    assert (result.status, result.form) == ("optimal", "reduced")
    assert result.trace == pytest.approx(float(enclose_riccati(large, 20).trace), rel=1e-13)


def test_an_unknown_form_is_refused():
    with pytest.raises(
        InputError, match=r'^form: expected "automatic", "convex", "reduced" or "full-space", got \'x\''
    ):
        optimise_gain(example_plant(), "x")  # type: ignore[arg-type]


def test_the_example():
    plant = example_plant()
    assert optimise_gain(plant).trace == pytest.approx(np.trace(solve_riccati(plant).P), rel=1e-12)


@pytest.mark.parametrize("form", FORMS)
@pytest.mark.parametrize(("plant", "P", "modes"), STRONG.values(), ids=STRONG)
def test_strong_solutions(form, plant, P, modes):
    result = optimise_gain(plant, form)
    assert result.status == "strong"
    np.testing.assert_allclose(result.P, P, atol=1e-12)


@pytest.mark.parametrize("form", FORMS)
@pytest.mark.parametrize(("plant", "P"), STABILISING.values(), ids=STABILISING)
def test_stabilising_solutions(form, plant, P):
    result = optimise_gain(plant, form)
    assert result.status == "optimal"
    np.testing.assert_allclose(result.P, P, rtol=1e-12, atol=1e-300)


@pytest.mark.parametrize("time", TIMES)
def test_no_other_gain_is_better(time):
    plant = random_plant(time, 3, 2, seed=5)
    best = optimise_gain(plant)
    rng = np.random.default_rng(0)
    for size in (1e-4, 1e-2, 1e-1):
        gain = best.gain + size * rng.standard_normal(best.gain.shape)
        P = error_covariance(plant.A, plant.C, plant.W, plant.V, plant.N, gain, time)
        assert np.linalg.eigvalsh(P - best.P)[0] > -1e-9 * size


@pytest.mark.parametrize("file", sorted(FOLDER.glob("gain_*.py")), ids=lambda file: file.stem)
def test_no_riccati_code_is_used(file):
    """The modules of the route import, directly and through each other, nothing that solves a Riccati equation."""
    assert "_are(" not in file.read_text()
    seen, todo = set(), [f"derive.numeric.{file.stem}"]
    while todo:
        path = FOLDER / f"{todo.pop().removeprefix('derive.numeric.')}.py"
        imported = {node.module for node in ast.walk(ast.parse(path.read_text())) if isinstance(node, ast.ImportFrom)}
        todo += [name for name in imported - seen if name.startswith("derive.numeric.")]
        seen |= imported
    forbidden = {"riccati", "riccati_iterations", "flow", "newton", "enclosure", "scalar", "spectrum", "response"}
    assert "derive.numeric.modes" in seen
    assert not seen & {f"derive.numeric.{name}" for name in forbidden}


def test_a_plant_that_no_gain_stabilises_fails_without_a_crash():
    one = np.eye(1)
    hidden = Plant(time="continuous", A=one, C=0 * one, W=one, V=one, N=0 * one, M=one)
    assert optimise_gain(hidden).status == "failed"


@pytest.mark.parametrize("rate", [1e-6, 1e6])
def test_the_unit_of_time_does_not_matter(rate):
    """x' = r A x + w with W r and V/r is the same plant under another clock; without noise, P is singular besides."""
    for plant in (random_plant("continuous", 4, 2, seed=3), continuous(A=np.diag([1, -1]), C=[[1, 1]], W=NOTHING, V=1)):
        same = continuous(A=rate * plant.A, C=plant.C, W=rate * plant.W, V=plant.V / rate, N=plant.N)
        result = optimise_gain(same)
        assert result.status == "optimal"
        np.testing.assert_allclose(result.P, optimise_gain(plant).P, rtol=1e-9, atol=1e-11)


def test_units_do_not_matter():
    plant = random_plant("continuous", 4, 2, seed=3)
    T, inverse = np.diag([1e-6, 1.0, 1e3, 1e6]), np.diag([1e6, 1.0, 1e-3, 1e-6])
    W = T @ plant.W @ T
    scaled = continuous(A=T @ plant.A @ inverse, C=plant.C @ inverse, W=W, V=plant.V, N=T @ plant.N)
    np.testing.assert_allclose(optimise_gain(scaled).P, T @ optimise_gain(plant).P @ T, rtol=1e-10)
