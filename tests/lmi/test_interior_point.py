"""The interior-point method: its linear algebra against dense oracles, its answers against the Riccati equation."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from derive.numeric.plant import Plant, plant_from_mapping
from derive.numeric.riccati import solve_riccati
from lmi import interior_point
from lmi.central_path import central_point, rough_covariance
from lmi.covariance import solve_covariance
from lmi.interior_point import _Cone, solve_interior_point
from lmi.programs.optimal_covariance_dual import optimal_covariance_dual
from lmi.routes import ROUTES
from lmi.scaling import balanced, recentred, scaled_plant
from tests.derive.numeric.plants import EDGES


def _plant(time: str, n: int, l: int, seed: int, **changes: Any) -> Plant:  # noqa: E741
    rng = np.random.default_rng(seed)
    A, C = rng.standard_normal((n, n)), rng.standard_normal((l, n))
    joint = rng.standard_normal((n + l, n + l))
    J = joint @ joint.T + 0.1 * np.eye(n + l)
    data = {"A": A, "C": C, "W": J[:n, :n], "V": J[n:, n:], "N": J[:n, n:], **changes}
    return plant_from_mapping({"time": time, **{k: np.asarray(v).tolist() for k, v in data.items()}})


def _symmetric(rng: np.random.Generator, n: int) -> np.ndarray[Any, Any]:
    X = rng.standard_normal((n, n))
    return X + X.T


@pytest.mark.parametrize("time", ["continuous", "discrete"])
def test_adjoint(time: str) -> None:
    """<F(P) - J, Z> = <P, F*(Z)>."""
    rng = np.random.default_rng(1)
    cone = _Cone.of(_plant(time, 4, 2, 0))
    P, Z = _symmetric(rng, 4), _symmetric(rng, 6)
    assert np.sum(cone.linear(P) * Z) == pytest.approx(np.sum(P * cone.adjoint(Z)), rel=1e-12)


@pytest.mark.parametrize("time", ["continuous", "discrete"])
def test_normal_matrix(time: str) -> None:
    """Column by column, against F*(sym(Z F(P) S^-1)) for unit matrices P."""
    rng = np.random.default_rng(2)
    n, cone = 4, _Cone.of(_plant(time, 4, 2, 0))
    Z, inverse = (X @ X.T for X in rng.standard_normal((2, 6, 6)))
    rows, columns = np.triu_indices(n)
    weight = np.where(rows == columns, 1.0, np.sqrt(2.0))
    dense = []
    for i, j in zip(rows, columns, strict=True):
        P = np.zeros((n, n))
        P[i, j] = P[j, i] = 1.0 if i == j else np.sqrt(0.5)
        image = Z @ cone.linear(P) @ inverse
        dense.append(cone.adjoint((image + image.T) / 2)[rows, columns] * weight)
    np.testing.assert_allclose(cone.normal_matrix(Z, inverse), np.array(dense).T, rtol=1e-10, atol=1e-10)


@pytest.mark.parametrize("time", ["continuous", "discrete"])
@pytest.mark.parametrize(("n", "l"), [(1, 1), (2, 1), (3, 3), (8, 2), (20, 6)])
def test_agrees_with_riccati(time: str, n: int, l: int) -> None:  # noqa: E741
    """Random plants with a cross term, most of them unstable."""
    plant = _plant(time, n, l, seed=n)
    found, known = solve_interior_point(plant), solve_riccati(plant)
    assert found.status == "solved"
    assert found.P is not None
    assert found.gain is not None
    np.testing.assert_allclose(found.P, known.P, rtol=0, atol=1e-10 * np.linalg.norm(known.P))
    np.testing.assert_allclose(found.gain, known.gain, rtol=0, atol=1e-9 * np.linalg.norm(known.gain))


@pytest.mark.parametrize("time", ["continuous", "discrete"])
def test_unexcited_unstable_plant(time: str) -> None:
    """W = 0 and an unstable mode: P is singular."""
    A = np.diag([2.0, 0.5]) if time == "discrete" else np.diag([2.0, -0.5])
    plant = _plant(time, 2, 1, 0, A=A, C=[[1.0, 1.0]], W=np.zeros((2, 2)), V=[[1.0]], N=np.zeros((2, 1)))
    found = solve_interior_point(plant)
    assert found.P is not None
    np.testing.assert_allclose(found.P, solve_riccati(plant).P, atol=1e-8)


def test_boundary_mode_is_refused() -> None:
    """An integrator that nothing excites has a strong solution only, and the dual no solution."""
    found = solve_interior_point(_plant("continuous", 1, 1, 0, A=[[0.0]], C=[[1.0]], W=[[0.0]], V=[[1.0]], N=[[0.0]]))
    assert found.P is None
    assert found.status.startswith("failed: no start")


def test_a_wrong_answer_of_the_riccati_equation_is_not_repeated(monkeypatch: pytest.MonkeyPatch) -> None:
    """Coordinates from a covariance that is off by half its size change the way, not the end."""
    plant = _plant("continuous", 4, 2, 7)
    known = solve_riccati(plant).P

    def doubled(plant: Plant, scaling: Any, P_z: Any, uncertainty: float) -> Any:
        return recentred(plant, scaling, 1.5 * P_z, uncertainty)

    recentred = interior_point.recentred
    monkeypatch.setattr(interior_point, "recentred", doubled)
    found = solve_interior_point(plant)
    assert found.P is not None
    np.testing.assert_allclose(found.P, known, atol=1e-10 * np.linalg.norm(known))


@pytest.mark.parametrize("time", ["continuous", "discrete"])
def test_no_riccati_equation_is_solved_on_the_way(time: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """Neither SciPy's solvers nor the Riccati route are asked, so that the answer can confirm theirs."""
    plant = _plant(time, 6, 2, 3)
    known = solve_riccati(plant).P

    def refuse(*args: Any, **kwargs: Any) -> Any:
        raise AssertionError("a Riccati equation was solved")

    for name in ("scipy.linalg.solve_continuous_are", "scipy.linalg.solve_discrete_are"):
        monkeypatch.setattr(name, refuse)
    monkeypatch.setattr("derive.numeric.riccati.solve_riccati", refuse)
    for P in (solve_interior_point(plant).P, solve_covariance(plant, optimal_covariance_dual).P):
        assert P is not None
        np.testing.assert_allclose(P, known, rtol=0, atol=1e-9 * np.linalg.norm(known))


@pytest.mark.parametrize("time", ["continuous", "discrete"])
def test_the_start_is_far_from_the_answer(time: str) -> None:
    """A start that is the answer would leave the method nothing to do."""
    for seed in range(5):
        plant = _plant(time, 4, 1, seed)
        found, rough = solve_interior_point(plant), rough_covariance(plant)
        assert found.P is not None
        assert rough is not None
        assert np.linalg.eigvalsh(rough - found.P)[0] > -1e-9 * np.linalg.norm(rough)
        assert found.history[0] > 1e-3
        assert len(found.history) > 5


@pytest.mark.parametrize("time", ["continuous", "discrete"])
def test_central_point_is_on_the_path(time: str) -> None:
    """F(P) Z = mu I up to the tolerance of the start, and Z solves the adjoint equation."""
    plant = _plant(time, 4, 2, 1)
    scaling = recentred(plant, balanced(plant), balanced(plant).scaled_covariance(solve_riccati(plant).P), 0.0)
    scaled = scaled_plant(plant, scaling)
    cone = _Cone.of(scaled)
    P, Z = central_point(scaled, np.eye(4))
    product = (cone.J + cone.linear(P)) @ Z
    mu = np.trace(product) / 6
    assert mu > 1e-3
    np.testing.assert_allclose(product, mu * np.eye(6), atol=0.2 * mu)
    np.testing.assert_allclose(cone.adjoint(Z), -np.eye(4), atol=1e-10)


def test_above_its_size_a_general_program_leaves_its_place_to_the_interior_point() -> None:
    plant = _plant("continuous", 13, 3, 0)
    routes = {spec.name: spec for spec in ROUTES}
    for name in ("lmi-primal", "lmi-h2"):
        status = routes[name].run(plant).status
        assert status == "not attempted: 13 states, above 12 the interior-point route takes its place"
    assert routes["interior-point"].run(plant).status == "solved"
    assert "riccati" in routes["interior-point"].independent_of
    assert "interior-point" in routes["riccati"].independent_of
    assert not {"lmi-dual", "lmi-primal", "lmi-h2"} & set(routes["interior-point"].independent_of)


@pytest.mark.parametrize("name", ["almost on the boundary, stable", "almost on the circle"])
def test_a_start_that_is_almost_the_answer_is_not_returned(name: str) -> None:
    """Beside the boundary only the last piece of the path exists, and Kleinman's iteration alone would find its end."""
    found = solve_interior_point(EDGES[name])
    assert found.P is None
    assert found.status.startswith("failed: no point inside the cone")


def test_a_covariance_of_zero_is_reached_from_a_start_inside() -> None:
    found = solve_interior_point(_plant("continuous", 1, 1, 0, A=[[-1]], C=[[1]], W=[[0]], V=[[1]], N=[[0]]))
    assert found.P is not None
    assert (found.status, abs(found.P[0, 0]) < 1e-12, found.history[0] > 1e-3) == ("solved", True, True)
