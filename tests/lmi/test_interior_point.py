"""The interior-point method: its linear algebra against dense oracles, its answers against the Riccati equation."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from derive.numeric.plant import Plant, plant_from_mapping
from derive.numeric.riccati import solve_riccati
from lmi import interior_point
from lmi.interior_point import _Cone, solve_interior_point


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
