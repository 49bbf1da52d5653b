"""The general plant of the lecture notes, x' = A x + B_d d, y = C x + D_d d + D_r r, by every route."""

import numpy as np
import pytest

import lmi
from derive.numeric.balls import floats
from derive.numeric.plant import plant_from_mapping
from tests.derive.numeric.references import reference

TIMES = ("continuous", "discrete")
ROUTES = ("lmi-primal", "lmi-dual", "lmi-h2", "interior-point", "nlp", "integral", "hamiltonian", "closed-form")


def general(time, n=3, l=2, p=2, q=2, seed=0):  # noqa: E741
    """Return the keys of a seeded plant whose disturbances (d, r) are correlated and reach the output both."""
    rng = np.random.default_rng([seed, n, time == "discrete"])
    G = rng.standard_normal((p + q, p + q))
    S = G @ G.T + 0.5 * np.eye(p + q)
    return {
        "time": time,
        "A": rng.standard_normal((n, n)),
        "C": rng.standard_normal((l, n)),
        "B_d": rng.standard_normal((n, p)),
        "D_d": 0.5 * rng.standard_normal((l, p)),
        "D_r": rng.standard_normal((l, q)),
        "S_dd": S[:p, :p],
        "S_rr": S[p:, p:],
        "S_dr": S[:p, p:],
    }


@pytest.mark.parametrize("time", TIMES)
@pytest.mark.parametrize("seed", range(3))
def test_the_reduced_noise_drives_the_error_as_the_disturbances_do(time, seed):
    """Under any gain L the error is driven by (B_d - L D_d) d - L D_r r, or by w - L v."""
    data = general(time, seed=seed)
    plant = plant_from_mapping(data)
    L = np.random.default_rng(seed).standard_normal((3, 2))
    S = np.block([[data["S_dd"], data["S_dr"]], [data["S_dr"].T, data["S_rr"]]])
    inputs = np.hstack([data["B_d"] - L @ data["D_d"], -L @ data["D_r"]])
    reduced = plant.W - L @ plant.N.T - plant.N @ L.T + L @ plant.V @ L.T
    np.testing.assert_allclose(reduced, inputs @ S @ inputs.T, rtol=1e-12, atol=1e-12)
    assert np.linalg.norm(plant.N) > 0.1


@pytest.mark.parametrize("time", TIMES)
def test_every_route_agrees_on_the_general_plant(time):
    data = general(time)
    B_d, D_d, D_r, S_dd, S_rr, S_dr = (data[key] for key in ("B_d", "D_d", "D_r", "S_dd", "S_rr", "S_dr"))
    cross = D_d @ S_dr @ D_r.T
    reduced = {
        **{key: data[key] for key in ("time", "A", "C")},
        "W": B_d @ S_dd @ B_d.T,
        "N": B_d @ (S_dd @ D_d.T + S_dr @ D_r.T),
        "V": D_d @ S_dd @ D_d.T + cross + cross.T + D_r @ S_rr @ D_r.T,
    }
    validation, same = lmi.validate(data), lmi.validate(reduced)
    assert (validation.verdict.value, same.verdict.value) == ("agree", "agree")
    assert all(validation.route(name).agrees for name in ROUTES), [route.status for route in validation.routes]
    P = floats(reference(plant_from_mapping(reduced), validation.route("riccati").P))
    assert validation.route("riccati").trace == pytest.approx(np.trace(P), rel=1e-13)
    bounds = validation.certificate.certified.bounds.trace
    assert float(bounds.lower) == pytest.approx(np.trace(P), rel=1e-13)
    for ours, theirs in zip(validation.routes, same.routes, strict=True):
        if ours.trace is not None and ours.name != "simulation":
            assert ours.trace == pytest.approx(theirs.trace, rel=1e-7)


def test_noise_that_is_the_disturbance_itself_leaves_no_error():
    """y = C x + d shows the disturbance d that drives x' = A x + d: the cross term uses up the process noise."""
    data = {
        "time": "continuous",
        "A": [[-1.0]],
        "C": [[1.0]],
        "B_d": [[1.0]],
        "D_d": [[1.0]],
        "S_dd": 2,
        "D_r": 0,
        "S_rr": 1,
    }
    validation = lmi.validate(data)
    assert (validation.verdict.value, validation.route("riccati").trace) == ("agree", 0)
    np.testing.assert_allclose(validation.route("riccati").gain, [[1.0]])
