"""The verifier: what it accepts is true, and each inequality, broken once, is noticed and named."""

from dataclasses import replace
from fractions import Fraction

import numpy as np
import pytest

import lmi.certificate.arithmetic as arithmetic
from derive.errors import InputError
from derive.numeric.plant import Plant, plant_from_mapping
from derive.numeric.riccati import solve_riccati
from lmi.certificate.arithmetic import Exact, TooLargeError
from lmi.certificate.report import proved_lines
from lmi.certificate.sandwich import Certificate, ExactPlant, exact_plant, verify
from lmi.certificate.stability import proved_unstable, stabilises
from lmi.certification.sandwich import certified

TIMES = ("continuous", "discrete")
TINY = Fraction(1, 2**80)  # far above the margins of a certificate, far below double precision
STATEMENTS = {
    "continuous": ("V > 0", "F(P_lo) >= 0", "X > 0", "(A - LC)X + X(A - LC)' < 0", "G_L(P_up) <= 0"),
    "discrete": ("CP_loC' + R > 0", "F(P_lo) >= 0", "X > 0", "(A - LC)X(A - LC)' - X < 0", "G_L(P_up) <= 0"),
}


def plant_of(time):
    return plant_from_mapping(
        {
            "time": time,
            "A": [[0.5, 1.25, 0.0], [0.0, 0.75, -0.5], [0.25, 0.0, -0.5]],
            "C": [[1.0, 0.0, 0.5], [0.0, 1.0, 0.0]],
            "W": [[1.0, 0.25, 0.0], [0.25, 0.5, 0.0], [0.0, 0.0, 0.75]],
            "V": [[0.5, 0.125], [0.125, 1.0]],
            "N": [[0.25, 0.0], [0.0, 0.125], [0.0, 0.0]],
            "M": [[2.0, 0.5, 0.0], [0.5, 1.0, 0.0], [0.0, 0.0, 0.25]],
        }
    )


@pytest.fixture(params=TIMES)
def certificate(request):
    return certified(plant_of(request.param)).certificate


def failing(certificate):
    checks, bounds = verify(certificate)
    assert (bounds is None) == any(not check.holds for check in checks)
    return {check.statement for check in checks if not check.holds}


def unit(n, i, j=None):
    """Return the symmetric matrix with 1 at (i, j) and (j, i)."""
    j = i if j is None else j
    return Exact.of([[int((p, q) in ((i, j), (j, i))) for q in range(n)] for p in range(n)])


def with_plant(certificate, key, matrix):
    return replace(certificate, plant=replace(certificate.plant, **{key: matrix}))


def test_a_certificate_holds_and_names_its_inequalities(certificate):
    checks, bounds = verify(certificate)
    assert tuple(check.statement for check in checks) == STATEMENTS[certificate.plant.time]
    assert all(check.holds for check in checks)
    assert bounds is not None
    assert bounds.is_covariance
    assert 0 < bounds.trace.width < bounds.trace.upper * Fraction(1, 10**29)


@pytest.mark.parametrize("i", range(3))
def test_a_lower_bound_that_is_too_high_is_rejected(certificate, i):
    _, F, *_ = STATEMENTS[certificate.plant.time]
    assert failing(replace(certificate, P_lo=certificate.P_lo + unit(3, i) * TINY)) == {F}
    assert failing(replace(certificate, P_lo=certificate.P_lo + unit(3, i, (i + 1) % 3) * TINY)) == {F}
    assert failing(replace(certificate, P_lo=certificate.P_up)) == {F}


def test_an_upper_bound_that_is_too_low_is_rejected(certificate):
    *_, G = STATEMENTS[certificate.plant.time]
    for i in range(3):
        assert failing(replace(certificate, P_up=certificate.P_up - unit(3, i) * TINY)) == {G}
    assert failing(replace(certificate, P_up=certificate.P_lo)) == {G}


def test_swapped_bounds_are_rejected(certificate):
    _, F, _, _, G = STATEMENTS[certificate.plant.time]
    assert failing(replace(certificate, P_lo=certificate.P_up, P_up=certificate.P_lo)) == {F, G}


def test_a_witness_must_be_positive_and_strict(certificate):
    _, _, X, stable, _ = STATEMENTS[certificate.plant.time]
    zero = Exact.of([[0] * 3] * 3)
    assert failing(replace(certificate, X=zero)) == {X, stable}
    assert failing(replace(certificate, X=-certificate.X)) == {X, stable}
    indefinite = certificate.X - Exact.identity(3) * Fraction(10**6)
    assert X in failing(replace(certificate, X=indefinite))
    least = min(np.linalg.eigvalsh([[float(certificate.X[i, j]) for j in range(3)] for i in range(3)]))
    shifted = certificate.X - Exact.identity(3) * Fraction(float(least) * (1 + 1e-9))
    assert X in failing(replace(certificate, X=shifted))


def test_a_witness_of_another_loop_is_rejected(certificate):
    *_, stable, _ = STATEMENTS[certificate.plant.time]
    loop = np.array([[0.5, 8.0, 0.0], [0.0, 0.5, 8.0], [0.0, 0.0, 0.5]])
    if certificate.plant.is_continuous:
        loop -= np.eye(3)
    of_another = {"time": certificate.plant.time, "A": loop, "C": np.eye(3), "W": np.eye(3), "V": np.eye(3)}
    other = certified(plant_from_mapping(of_another), np.zeros((3, 3))).certificate.X
    assert failing(replace(certificate, X=other)) == {stable}


def test_bounds_of_another_gain_are_rejected(certificate):
    *_, G = STATEMENTS[certificate.plant.time]
    for i in range(3):
        for j in range(2):
            rows = [[Fraction(int((p, q) == (i, j)), 2**30) for q in range(2)] for p in range(3)]
            assert failing(replace(certificate, gain=certificate.gain + Exact.of(rows))) == {G}


def test_a_gain_that_does_not_stabilise_is_rejected(certificate):
    *_, stable, _ = STATEMENTS[certificate.plant.time]
    assert stable in failing(replace(certificate, gain=-certificate.gain))


def test_measurement_noise_must_be_positive(certificate):
    V, F, *_ = STATEMENTS[certificate.plant.time]
    plant = certificate.plant
    singular = Exact.of([[1, 1], [1, 1]])
    low = certificate.P_lo - Exact.identity(3) * Fraction(100)
    if plant.is_continuous:
        assert V in failing(with_plant(certificate, "V", singular))
        assert V in failing(with_plant(certificate, "V", -plant.V))
    else:
        assert failing(replace(certificate, P_lo=low)) >= {V, F}


def test_an_unmeasured_direction_may_have_no_noise_only_in_discrete_time():
    data = {"A": Exact.of([[Fraction(1, 2)]]), "C": Exact.of([[1]]), "W": Exact.of([[1]]), "N": Exact.of([[0]])}
    plant = ExactPlant("discrete", V=Exact.of([[0]]), M=Exact.of([[1]]), **data)
    one, gain = Exact.of([[1]]), Exact.of([[Fraction(1, 2)]])
    checks, bounds = verify(Certificate(plant, one, one, one, gain))  # P* = Q: the state is measured exactly
    assert bounds is not None, checks
    assert bounds.trace.lower == bounds.trace.upper == 1
    low = Exact.of([[0]])
    assert failing(Certificate(plant, low, one, one, gain)) == {"CP_loC' + R > 0"}


@pytest.mark.parametrize("key", ["A", "C", "W", "V", "N"])
def test_an_edited_plant_is_rejected(certificate, key):
    matrix = getattr(certificate.plant, key)
    for sign in (1, -1):
        rows = [[Fraction(int(i == j), 2**40) * sign for j in range(matrix.shape[1])] for i in range(matrix.shape[0])]
        assert failing(with_plant(certificate, key, matrix + Exact.of(rows)))


def test_an_edited_weight_changes_the_cost_that_is_proved_and_nothing_else(certificate):
    doubled = with_plant(certificate, "M", certificate.plant.M * Fraction(2))
    (_, before), (_, after) = verify(certificate), verify(doubled)
    assert before is not None
    assert after is not None
    assert (after.cost.lower, after.cost.upper) == (2 * before.cost.lower, 2 * before.cost.upper)
    assert (after.trace, after.variances) == (before.trace, before.variances)
    assert doubled.plant.differs_in(certificate.plant) == "M"


def test_plants_differ_in_a_key_by_name(certificate):
    plant = certificate.plant
    assert plant.differs_in(plant) == ""
    assert exact_plant(plant_of(plant.time)).differs_in(plant) == ""
    assert plant.differs_in(replace(plant, time="discrete" if plant.is_continuous else "continuous")) == "time"
    for key in ("A", "C", "W", "V", "N", "M"):
        assert plant.differs_in(replace(plant, **{key: getattr(plant, key) * Fraction(1 + 2**60, 2**60)})) == key


@pytest.mark.parametrize("time", TIMES)
def test_whatever_is_accepted_is_true(time):
    """Random bounds about the optimum, of a size at which some pass and some do not."""
    plant = plant_of(time)
    exact, truth = exact_plant(plant), solve_riccati(plant)
    gain, X = Exact.of_floats(truth.gain.tolist()), certified(plant).certificate.X
    rng = np.random.default_rng(4)
    accepted = rejected = 0
    for _ in range(400):
        shifts = [0.1 * rng.standard_normal((3, 3)) for _ in range(2)]
        sizes = rng.uniform(-0.1, 0.6, 2)
        low = truth.P - sizes[0] * truth.P + (shifts[0] + shifts[0].T) * 0.3
        up = truth.P + sizes[1] * truth.P + (shifts[1] + shifts[1].T) * 0.3
        checks, bounds = verify(
            Certificate(exact, Exact.of_floats(low.tolist()), Exact.of_floats(up.tolist()), X, gain)
        )
        below, above = (np.linalg.eigvalsh(D).min() > -1e-9 for D in (truth.P - low, up - truth.P))
        F, G = (next(c.holds for c in checks if c.statement.startswith(name)) for name in ("F(", "G_L"))
        assert below or not F
        assert above or not G
        accepted += bounds is not None
        rejected += bounds is None
    assert accepted > 10
    assert rejected > 10


@pytest.mark.parametrize("time", TIMES)
def test_a_bound_holds_for_every_stabilising_gain(time):
    plant = plant_of(time)
    low = certified(plant).certificate.P_lo
    floor = np.array([[float(low[i, j]) for j in range(3)] for i in range(3)])
    rng = np.random.default_rng(5)
    optimum = solve_riccati(plant).gain
    for _ in range(20):
        _, bounds = certified(plant, optimum + 0.1 * rng.standard_normal((3, 2)))
        assert all(float(v.upper) > low for v, low in zip(bounds.variances, np.diag(floor), strict=True))
        assert bounds.cost.lower < bounds.cost.upper


def test_noise_that_is_not_semidefinite_is_said_to_be():
    tiny = 2.0**-60
    data = {"time": "continuous", "A": [[-1, 0], [0, -2]], "C": [[1, 1]], "W": [[1, 1], [1, 1 - tiny]], "V": [[1]]}
    plant = plant_from_mapping({**data, "W": [[1, 1], [1, 1]]})
    exact = replace(exact_plant(plant), W=Exact.of([[1, 1], [1, 1 - Fraction(tiny)]]))
    found = certified(plant)
    certificate = replace(found.certificate, plant=exact, P_lo=found.certificate.P_lo - Exact.identity(2) * TINY)
    checks, bounds = verify(replace(certificate, P_lo=certificate.P_lo - Exact.identity(2) * Fraction(1, 2**20)))
    assert found.bounds.is_covariance
    assert bounds is not None, checks
    assert not bounds.is_covariance


def test_what_takes_too_long_beside_the_inequalities_is_said_and_costs_width_only(monkeypatch):
    low = np.array([[1.0, 1.0], [1.0, 1.0]])
    data = {"time": "discrete", "A": [[0.5, 1], [0, 0.5]], "C": [[1, 0]], "W": low, "V": 1, "M": low}
    certificate, known = certified(plant_from_mapping(data))
    assert known.is_covariance
    monkeypatch.setattr(arithmetic, "WORK", 0)
    _, bounds = verify(certificate)
    assert bounds is not None
    assert bounds.is_covariance is None
    assert bounds.trace == known.trace
    assert bounds.cost.lower < known.cost.lower < known.cost.upper < bounds.cost.upper
    assert bounds.cost.width < 2 * known.cost.width
    assert "too large to decide" in list(proved_lines(certificate, bounds))[1]


def test_what_is_no_covariance_may_be_negative():
    one = np.eye(1)
    plant = Plant(time="continuous", A=-one, C=one, W=-one / 2, V=one, N=0 * one, M=one)
    _, bounds = certified(plant)  # 0 = -2 P - 1/2 - P^2, stabilising at P = -1 + 1/sqrt 2
    assert not bounds.is_covariance
    assert bounds.trace.lower < bounds.trace.upper < 0
    assert (bounds.trace.lower + 1) ** 2 < Fraction(1, 2) < (bounds.trace.upper + 1) ** 2
    assert bounds.cost == bounds.trace == bounds.variances[0]


def test_variances_of_a_covariance_are_not_negative():
    plant = plant_from_mapping({"time": "continuous", "A": -1, "C": 1, "W": 1, "V": 1})
    certificate = certified(plant).certificate
    loose = replace(certificate, P_lo=Exact.of([[Fraction(-1, 100)]]))
    _, bounds = verify(loose)
    assert bounds is not None
    assert bounds.trace.lower == bounds.variances[0].lower == bounds.cost.lower == 0


def test_a_weight_semidefinite_but_for_rounding_widens_the_cost():
    M = np.array([[1.0, 1.0], [1.0, 1.0 - 2.0**-53]])
    plant = plant_from_mapping(
        {"time": "discrete", "A": [[0.5, 1], [0, 0.5]], "C": [[1, 0]], "W": np.eye(2), "V": 1, "M": M}
    )
    certificate, bounds = certified(plant)
    exact = sum((Fraction(M[i, j]) * certificate.P_lo[i, j] for i in range(2) for j in range(2)), Fraction(0))
    assert bounds.cost.lower < exact < bounds.cost.upper
    gap = sum(certificate.P_up[i, i] - certificate.P_lo[i, i] for i in range(2))
    assert exact - bounds.cost.lower < gap * Fraction(1, 10**5)
    indefinite = with_plant(certificate, "M", Exact.of([[1, 0], [0, -1]]))
    _, wide = verify(indefinite)
    assert wide is not None
    values = [X[0, 0] - X[1, 1] for X in (certificate.P_lo, certificate.P_up)]
    assert wide.cost.lower <= min(values) - gap
    assert wide.cost.upper >= max(values) + gap


@pytest.mark.parametrize("name", ["P_lo", "P_up", "X"])
def test_matrices_that_are_not_symmetric_are_refused(certificate, name):
    matrix = getattr(certificate, name) + Exact.of([[0, 1, 0], [0, 0, 0], [0, 0, 0]]) * TINY
    with pytest.raises(InputError, match=f"^{name}: expected a symmetric matrix"):
        replace(certificate, **{name: matrix})


@pytest.mark.parametrize("name", ["P_lo", "P_up", "X", "gain"])
def test_wrong_shapes_are_refused(certificate, name):
    with pytest.raises(InputError, match=f"^{name}: expected shape"):
        replace(certificate, **{name: Exact.of([[1]])})


@pytest.mark.parametrize("key", ["A", "C", "W", "V", "N", "M"])
def test_plants_of_wrong_shape_are_refused(certificate, key):
    with pytest.raises(InputError, match="expected shape"):
        replace(certificate.plant, **{key: Exact.of([[1]])})


@pytest.mark.parametrize("key", ["W", "V", "M"])
def test_noise_and_weight_are_symmetric(certificate, key):
    matrix = getattr(certificate.plant, key)
    n = matrix.shape[0]
    skew = Exact.of([[TINY if (i, j) == (0, 1) else Fraction(0) for j in range(n)] for i in range(n)])
    with pytest.raises(InputError, match=f"^{key}: expected a symmetric matrix"):
        replace(certificate.plant, **{key: matrix + skew})


@pytest.mark.parametrize("time", TIMES)
def test_no_witness_shows_a_stable_loop_to_be_unstable(time):
    certificate = certified(plant_of(time)).certificate
    plant, gain, rng = certificate.plant, certificate.gain, np.random.default_rng(6)
    rate = Fraction(0 if time == "continuous" else 1)
    assert not proved_unstable(plant, gain, rate, certificate.X, [Fraction(1), Fraction(0), Fraction(0)])
    for _ in range(300):
        Y = rng.integers(-5, 6, (3, 3))
        v = [Fraction(int(x)) for x in rng.integers(-2, 3, 3)]
        assert not proved_unstable(plant, gain, rate, Exact.of((Y + Y.T).tolist()), v)


def test_routh_is_not_asked_about_many_states():
    n = 31
    zero, one = Exact.of([[0]] * n), Exact.identity(n)
    plant = ExactPlant("continuous", A=one, C=zero.T, W=one, V=Exact.of([[1]]), N=zero, M=one)
    with pytest.raises(TooLargeError, match="31 states"):
        stabilises(plant, zero)


def test_a_witness_of_instability_is_checked_in_every_part():
    one, minus = Exact.of([[1]]), Exact.of([[-1]])
    data = {"C": one, "W": one, "V": one, "N": Exact.of([[0]]), "M": one}
    plant = ExactPlant("continuous", A=Exact.of([[3]]), **data)
    gain, v = Exact.of([[1]]), [Fraction(1)]
    assert proved_unstable(plant, gain, Fraction(1), minus, v)  # the mode is 2
    assert not proved_unstable(plant, gain, Fraction(2), minus, v)  # not strictly beyond
    assert not proved_unstable(plant, gain, Fraction(3), minus, v)
    assert not proved_unstable(plant, gain, Fraction(1), minus, [Fraction(0)])
    assert not proved_unstable(plant, gain, Fraction(1), one, v)
    assert not proved_unstable(plant, gain, Fraction(-6), minus, v)
    stable = replace(plant, A=Exact.of([[0]]))  # the mode is -1
    assert not proved_unstable(stable, gain, Fraction(-2), minus, v)  # nothing follows from a negative rate
    discrete = replace(plant, time="discrete")
    assert proved_unstable(discrete, gain, Fraction(3, 2), minus, v)
    assert not proved_unstable(discrete, gain, Fraction(2), minus, v)
    half = replace(discrete, A=Exact.of([[Fraction(3, 2)]]))  # the mode is 1/2
    assert not proved_unstable(half, gain, Fraction(1, 4), minus, v)
