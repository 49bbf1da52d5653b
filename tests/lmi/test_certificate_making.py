"""Making certificates: hard and degenerate plants, known answers, changes of units, gains from anywhere."""

from dataclasses import replace
from fractions import Fraction
from itertools import islice

import numpy as np
import pytest

import lmi
from derive.errors import InputError
from derive.numeric.plant import Plant, example_plant, plant_from_mapping
from derive.numeric.riccati import solve_riccati
from lmi.certificate.arithmetic import Exact
from lmi.certificate.sandwich import exact_plant, verify
from lmi.certification.boundary import without_boundary
from lmi.certification.instability import instability
from lmi.certification.sandwich import NotCertifiedError, UnstableGainError, certified
from tests.benchmark.certificates import hard_plants
from tests.derive.numeric.plants import EDGES, STABILISING, STRONG, random_plant

TIMES = ("continuous", "discrete")
EXACT_BOUNDARY = {name: data for name, data in STRONG.items() if name != "rotation"}  # (0.6, 0.8) is no unit vector


def relative(interval):
    return float(interval.width / interval.upper) if interval.upper else 0.0


@pytest.mark.parametrize("time", TIMES)
@pytest.mark.parametrize("n", [1, 2, 3, 5, 8, 13])
def test_random_plants_to_30_digits(time, n):
    plant = random_plant(time, n)
    certificate, bounds = certified(plant)
    P = solve_riccati(plant).P
    assert relative(bounds.trace) < 1e-29
    assert float(bounds.trace.lower) == pytest.approx(np.trace(P), rel=1e-11)
    assert [float(v.upper) for v in bounds.variances] == pytest.approx(np.diag(P), rel=1e-10)
    assert float(bounds.cost.upper) == pytest.approx(np.trace(plant.M @ P), rel=1e-11)
    assert verify(certificate)[1] == bounds


def test_the_gain_of_a_certificate_is_the_optimal_one_in_doubles():
    plant = example_plant()
    gain = certified(plant).certificate.gain
    found = np.array([[float(gain[i, j]) for j in range(plant.l)] for i in range(plant.n)])
    np.testing.assert_allclose(found, solve_riccati(plant).gain, rtol=1e-12)
    assert all(Fraction(found[i, j]) == gain[i, j] for i in range(plant.n) for j in range(plant.l))


@pytest.mark.parametrize(("name", "plant"), list(islice(hard_plants(), 40)), ids=lambda x: x if type(x) is str else "")
def test_hard_plants(name, plant):
    _, bounds = certified(plant)
    assert relative(bounds.trace) < 1e-20


@pytest.mark.parametrize("name", EXACT_BOUNDARY)
def test_strong_solutions_lie_in_their_sandwich(name):
    plant, P, _ = STRONG[name]
    _, bounds = certified(plant)
    assert bounds.is_covariance
    for interval, value in zip(bounds.variances, np.diag(np.asarray(P, float)), strict=True):
        assert float(interval.lower) <= value * (1 + 1e-15)
        assert float(interval.upper) >= value * (1 - 1e-15)
        assert float(interval.width) < 1e-28
    assert bounds.trace.width > 0  # no stabilising gain attains it


def test_a_strong_solution_beside_an_irrational_one_from_both_sides():
    plant = STRONG["oscillator beside an excited stable mode"][0]  # its last variance is sqrt 2 - 1
    last = certified(plant).bounds.variances[2]
    assert (last.lower + 1) ** 2 < 2 < (last.upper + 1) ** 2
    assert float(last.width) < 1e-28


def test_ten_constant_velocities_without_noise():
    ten = np.eye(10)
    plant = plant_from_mapping(
        {
            "time": "discrete",
            "A": np.kron(ten, [[1, 1], [0, 1]]),
            "C": np.kron(ten, [[1, 0]]),
            "W": np.zeros((20, 20)),
            "V": ten,
        }
    )
    _, bounds = certified(plant)
    assert 0 == bounds.trace.lower < bounds.trace.upper < 1e-27


@pytest.mark.parametrize("time", TIMES)
def test_boundary_modes_fed_by_others_and_seen_through_them(time):
    """Two of five modes are on the boundary and unexcited; integer coordinates hide them."""
    T = np.array([[1, 0, 0, 0, 0], [2, 1, 0, 0, 0], [0, -1, 1, 0, 0], [1, 0, 3, 1, 0], [0, 2, 0, -1, 1.0]])
    inverse = np.round(np.linalg.inv(T))
    A = np.diag([-0.5, 0.25, -0.75, 0.0, 0.0])
    A[3:, 3:] = [[0, 1], [-1, 0]]
    A[:3, 3:] = [[1, 0], [0, 2], [1, 1]]
    W = np.diag([1.0, 2, 0, 0, 0])
    data = {"time": time, "C": np.array([[1.0, 1, 1, 0, 1], [0, 0, 1, 1, 0]]) @ inverse, "V": np.eye(2)}
    plant = plant_from_mapping({**data, "A": T @ A @ inverse, "W": T @ W @ T.T})
    certificate, bounds = certified(plant)
    assert relative(bounds.trace) < 1e-25
    hidden = Exact.of_floats(inverse[3:].tolist())  # the left-invariant subspace
    assert not any(any(row) for row in (hidden @ certificate.P_lo).numerators)
    P = solve_riccati(plant).P
    assert float(bounds.trace.lower) == pytest.approx(np.trace(P), rel=1e-7)


def test_a_strong_solution_of_short_numbers_is_met_exactly_where_the_noise_is_no_covariance():
    A, ones = np.array([[3.0, 4.0], [1.0, 2.0]]), np.ones((1, 2))
    W = np.array([[-11.0, -5.0], [-5.0, -2.0]])
    plant = Plant(time="continuous", A=A, C=ones, W=W, V=np.eye(1), N=np.zeros((2, 1)), M=np.eye(2))
    certificate, bounds = certified(plant)  # CAREX, example 2.5 with epsilon = 0: P* = [[2, 1], [1, 1]]
    assert certificate.P_lo.equals(Exact.of([[2, 1], [1, 1]]))
    assert bounds.trace.lower == 3 < bounds.trace.upper < 3 + Fraction(1, 10**20)
    assert not bounds.is_covariance


def test_a_rotation_in_doubles_is_not_on_the_circle_and_its_certificate_knows():
    _, bounds = certified(STRONG["rotation"][0])
    assert 1e-16 < float(bounds.trace.lower) <= float(bounds.trace.upper) < 2e-16
    assert relative(bounds.trace) < 1e-25


@pytest.mark.parametrize("name", EDGES)
def test_plants_at_an_edge_of_the_theory(name):
    plant = EDGES[name]
    _, bounds = certified(plant)
    assert float(bounds.trace.width) < 1e-27
    P = solve_riccati(plant).P
    assert float(bounds.trace.upper) == pytest.approx(np.trace(P), rel=1e-8, abs=1e-12)


@pytest.mark.parametrize("name", STABILISING)
def test_known_values(name):
    plant, P = STABILISING[name]
    _, bounds = certified(plant)
    assert float(bounds.trace.lower) <= P[0][0] <= float(bounds.trace.upper)
    assert float(bounds.trace.width) < 1e-28


@pytest.mark.parametrize(("A", "C", "Q", "R"), [(1, 1, 1, 1), (3, 2, 5, 0.5), (-0.5, 3, 1, 7), (2, 1, 0.25, 1e-6)])
def test_the_discrete_scalar_equation_changes_sign_between_the_bounds(A, C, Q, R):
    _, bounds = certified(plant_from_mapping({"time": "discrete", "A": A, "C": C, "Q": Q, "R": R}))
    A, C, Q, R = map(Fraction, (A, C, Q, R))

    def equation(P):
        return A * A * P + Q - (A * P * C) ** 2 / (C * C * P + R) - P

    assert equation(bounds.trace.upper) < 0 < equation(bounds.trace.lower)


@pytest.mark.parametrize(("A", "C", "W", "V", "N"), [(1, 1, 1, 1, 0), (-3, 0.5, 2, 0.125, 0.3), (0, 4, 1, 1e-8, 0)])
def test_the_continuous_scalar_equation_changes_sign_between_the_bounds(A, C, W, V, N):
    _, bounds = certified(plant_from_mapping({"time": "continuous", "A": A, "C": C, "W": W, "V": V, "N": N}))
    A, C, W, V, N = map(Fraction, (A, C, W, V, N))

    def equation(P):
        return 2 * A * P + W - (P * C + N) ** 2 / V

    assert equation(bounds.trace.upper) < 0 < equation(bounds.trace.lower)


@pytest.mark.parametrize("time", TIMES)
def test_a_stable_plant_without_noise_forgets_exactly(time):
    A = [[-0.5, 0.25], [0.0, -0.25]]
    _, bounds = certified(plant_from_mapping({"time": time, "A": A, "C": [[1, 0]], "W": np.zeros((2, 2)), "V": 1}))
    assert bounds.trace.lower == bounds.trace.upper == 0


@pytest.mark.parametrize("time", TIMES)
@pytest.mark.parametrize(
    ("C", "V"),
    [
        (np.eye(2), np.eye(2)),
        ([[1, 0], [1, 0]], np.eye(2)),
        ([[1, 0], [1, 0]], [[1, 1 - 1e-12], [1 - 1e-12, 1]]),
        ([[1, 0], [2, 0], [0, 1]], np.diag([1e-12, 1, 1e12])),
        ([[0.0, 0.0]], [[1.0]]),
        ([[1e-40, 0.0]], [[1e-40]]),
    ],
    ids=["l = n", "repeated output", "V nearly singular", "l > n", "C = 0", "C tiny"],
)
def test_outputs_of_all_kinds(time, C, V):
    A = np.array([[0.25, 0.5], [0.0, 0.5]]) - (np.eye(2) if time == "continuous" else 0)
    plant = plant_from_mapping({"time": time, "A": A, "C": C, "W": np.eye(2), "V": V})
    assert relative(certified(plant).bounds.trace) < 1e-28


@pytest.mark.parametrize("scale", [1e-40, 1e-9, 1e9, 1e40])
@pytest.mark.parametrize("time", TIMES)
def test_units_of_noise_scale_the_bounds(time, scale):
    scale = float(2.0 ** np.round(np.log2(scale)))
    plant = random_plant(time, 4)
    other = replace(plant, W=plant.W * scale, V=plant.V * scale, N=plant.N * scale)
    one, two = certified(plant).bounds, certified(other).bounds
    assert max(one.trace.lower * Fraction(scale), two.trace.lower) <= min(
        one.trace.upper * Fraction(scale), two.trace.upper
    )
    assert relative(two.trace) < 1e-29


@pytest.mark.parametrize("time", TIMES)
def test_coordinates_change_the_bounds_as_they_change_the_covariance(time):
    plant = random_plant(time, 3)
    T, inverse = np.array([[1.0, 2, 0], [0, 1, -1], [0, 0, 1]]), np.array([[1.0, -2, -2], [0, 1, 1], [0, 0, 1]])
    rounded = {k: np.round(getattr(plant, k) * 2**20) / 2**20 for k in ("A", "C", "W", "V", "N")}  # no rounding below
    plant = replace(plant, **rounded)
    moved = replace(
        plant, A=T @ plant.A @ inverse, C=plant.C @ inverse, W=T @ plant.W @ T.T, N=T @ plant.N, M=inverse.T @ inverse
    )
    one, two = certified(plant).bounds, certified(moved).bounds
    assert max(one.trace.lower, two.cost.lower) <= min(one.trace.upper, two.cost.upper)  # tr(T^-T T^-1 T P T') = tr P
    assert one.trace.lower != two.trace.lower


@pytest.mark.parametrize("time", TIMES)
def test_more_noise_never_makes_the_bounds_fall(time):
    plant = random_plant(time, 4)
    more = replace(plant, W=plant.W + np.diag([2.0**-40, 0, 0, 0]))
    assert certified(plant).bounds.trace.lower < certified(more).bounds.trace.lower


@pytest.mark.parametrize("value", [1e150, 1e-150])
def test_sizes_beyond_squaring_are_refused_by_name(value):
    with pytest.raises(InputError, match="choose other units"):
        lmi.certify({"time": "continuous", "A": -1, "C": 1, "W": value, "V": 1})


def test_an_unobservable_mode_that_is_not_stable_is_refused():
    data = {"time": "continuous", "A": [[1.0, 0.0], [0.0, -1.0]], "C": [[0.0, 1.0]], "W": np.eye(2), "V": np.eye(1)}
    with pytest.raises(InputError, match="not detectable"):
        lmi.certify(data)
    plant = Plant(**{**data, "A": np.array(data["A"]), "C": np.array(data["C"])}, N=np.zeros((2, 1)), M=np.eye(2))
    with pytest.raises(NotCertifiedError):
        certified(plant)


def test_too_many_states_are_refused():
    plant = plant_from_mapping(
        {"time": "continuous", "A": -np.eye(201), "C": np.ones((1, 201)), "W": np.eye(201), "V": 1}
    )
    with pytest.raises(NotCertifiedError, match="201 states"):
        certified(plant)


def test_what_is_not_proved_is_not_returned(monkeypatch):
    import lmi.certification.sandwich as module

    monkeypatch.setattr(module, "_lower", lambda *_: Exact.identity(1) * Fraction(10**6))
    with pytest.raises(NotCertifiedError, match=r"F\(P_lo\) >= 0"):
        certified(plant_from_mapping({"time": "discrete", "A": 1, "C": 1, "Q": 1, "R": 1}))


def test_the_subspace_of_boundary_modes_is_exact():
    third = Fraction(1, 3)  # modes +-j of a matrix with no finite binary expansion, beside one that grows
    A = Exact.of([[third, 2 * third, 1], [-5 * third, -third, 0], [0, 0, 1]])
    zero, plant = Exact.of([[0] * 3] * 3), exact_plant(random_plant("continuous", 3, 1, cross=False))
    reduced = without_boundary(replace(plant, A=A.T, W=zero))
    assert reduced is not None
    assert reduced.F.tolist() == [[1]]
    assert without_boundary(replace(plant, A=A.T)) is None  # all modes are excited
    nothing = without_boundary(replace(plant, A=zero, W=zero))
    assert nothing is not None
    assert nothing.U.ncols() == 0


@pytest.mark.parametrize("time", TIMES)
def test_a_gain_from_elsewhere_is_bounded(time):
    plant = random_plant(time, 5)
    optimum = solve_riccati(plant).gain
    gain = np.round(optimum, 2)
    certificate, bounds = certified(plant, gain)
    assert certificate.gain.equals(Exact.of_floats(gain.tolist()))
    best = certified(plant).bounds
    assert bounds.cost.lower <= best.cost.upper < bounds.cost.upper
    assert instability(plant, gain) is None


@pytest.mark.parametrize("time", TIMES)
@pytest.mark.parametrize("n", [1, 2, 5, 10])
def test_a_gain_that_does_not_stabilise_is_proved_not_to(time, n):
    refuted = 0
    for seed in range(10):
        plant = random_plant(time, n, seed=seed)
        gain = np.random.default_rng([seed, n]).standard_normal((n, plant.l))
        modes = np.linalg.eigvals(plant.A - gain @ plant.C)
        growth = modes.real.max() if time == "continuous" else np.abs(modes).max()
        stable = growth < (0 if time == "continuous" else 1)
        found = instability(plant, gain)
        assert (found is None) == stable
        if found is not None:
            refuted += 1
            assert float(found.rpartition(" ")[2]) <= growth
            with pytest.raises(UnstableGainError, match="does not stabilise"):
                certified(plant, gain)
    assert refuted


@pytest.mark.parametrize("time", TIMES)
def test_a_loop_exactly_on_the_boundary_is_decided_by_routh(time):
    A = np.array([[0.0, 1.0], [-1.0, 0.0]])
    plant = plant_from_mapping({"time": time, "A": A, "C": [[1, 0]], "W": np.eye(2), "V": 1})
    assert "Routh" in str(instability(plant, np.zeros((2, 1))))
    inside = np.array([[2.0**-40], [0.0]]) if time == "continuous" else np.array([[0.0], [-(2.0**-40)]])
    assert instability(plant, inside) is None
    _, bounds = certified(plant, inside)  # slow, but stable: its covariance is large
    assert bounds.trace.upper > 10**6


def test_python_takes_plants_and_gains_as_they_come(tmp_path):
    data = {"time": "discrete", "A": [[2.0]], "C": [[1.0]], "Q": [[1.0]], "R": [[1.0]]}
    path = tmp_path / "plant.json"
    path.write_text(str(data).replace("'", '"'))
    for plant in (data, path, str(path), plant_from_mapping(data)):
        assert float(lmi.certify(plant).bounds.trace.lower) == pytest.approx(2 + 5**0.5)
    assert lmi.certify(data, [[1.5]]).bounds.trace.width > Fraction(1, 1000)
    assert lmi.certify(data, np.array([[1.5]])).bounds.trace.upper == lmi.certify(data, 1.5).bounds.trace.upper
    for wrong in ([[1.0], [2.0]], [[float("nan")]], "1.5"):
        with pytest.raises(InputError, match=r"^gain"):
            lmi.certify(data, wrong)
