"""Certificates of gains: what is accepted is true of every mutant, and what is false is named."""

import json
from copy import deepcopy
from dataclasses import replace
from fractions import Fraction
from math import exp, factorial

import numpy as np
import pytest
from click.testing import CliRunner
from scipy.optimize import minimize

import lmi.certificate.design as module
from derive.errors import InputError
from derive.numeric.plant import plant_from_mapping
from lmi.certificate.arithmetic import Exact, TooLargeError
from lmi.certificate.design import Floor, floor_checks, proper, reduced_noise, verify_design
from lmi.certificate.design_file import design_from_dict
from lmi.certificate.design_infeasible import Unseen, floor_squared, keeps_a_mode
from lmi.certificate.design_report import above_exp, below_exp, decay_rate, root_below
from lmi.certificate.file import read_json
from lmi.certificate.sandwich import ExactPlant
from lmi.certification.design import certify_design
from lmi.certification.design_floor import certified_floor
from lmi.cli import cli

TIMES = ("continuous", "discrete")
GAINS = {"continuous": [[2.0], [3.5]], "discrete": [[1.0], [0.75]]}
FLOORS = {"continuous": 0.5, "discrete": 1.0}


def data_of(time):
    return {
        "name": "small",
        "time": time,
        "A": [[0.5, 1.0], [-0.25, 0.75]],
        "C": [[1.0, 0.0]],
        "W": [[1.0, 0.25], [0.25, 0.5]],
        "V": [[0.5]],
        "N": [[0.25], [0.0]],
        "M": [[2.0, 0.5], [0.5, 1.0]],
    }


def norm_of(plant, gain, points=300):
    """Return the largest singular value over frequencies, by linear solves on ever finer grids, or infinity."""
    A, C, W, V, N, M = (np.array(plant[key], dtype=float) for key in ("A", "C", "W", "V", "N", "M"))
    L, n = np.array(gain, dtype=float), len(A)
    loop, noise = A - L @ C, np.hstack([np.eye(n), -L]) @ np.block([[W, N], [N.T, V]]) @ np.vstack([np.eye(n), -L.T])
    modes = np.linalg.eigvals(loop)
    if (modes.real.max() >= 0) if plant["time"] == "continuous" else (np.abs(modes).max() >= 1):
        return np.inf
    low, high, best = 0.0, np.pi * (1 - 1e-9), 0.0
    for _ in range(3):
        angles = np.linspace(low, high, points)
        s = np.exp(1j * angles) if plant["time"] == "discrete" else 1j * np.abs(modes).max() * np.tan(angles / 2)
        R = np.linalg.inv(s[:, None, None] * np.eye(n) - loop)
        squares = np.abs(np.linalg.eigvals(R @ noise @ R.conj().transpose(0, 2, 1) @ M)).max(axis=1)
        peak = int(squares.argmax())
        best = max(best, float(squares[peak]))
        low, high = angles[max(peak - 1, 0)], angles[min(peak + 1, points - 1)]
    return best**0.5


def as_plant(data):
    return plant_from_mapping({key: value for key, value in data.items() if key != "name"})


@pytest.fixture(scope="module", params=TIMES)
def design(request):
    return design_of(request.param)


def design_of(time):
    return {
        "schema": "lmi-design/1",
        "plant": data_of(time),
        "objective": {"name": "hinf", "gamma": None, "decay": None, "dual": False},
        "gain": GAINS[time],
        "achieved": {},
        "certificate": design_certificate(time).as_dict(),
    }


def read(design, tmp_path):
    path = tmp_path / "design.json"
    path.write_text(json.dumps(design))
    return design_from_dict(read_json(path))


def certify(design, tmp_path, *extra):
    path = tmp_path / "design.json"
    path.write_text(design if isinstance(design, str) else json.dumps(design))
    return CliRunner().invoke(cli, ["certify", str(path), *map(str, extra)])


def test_a_design_is_certified_with_bounds_close_to_what_is_true(design, tmp_path):
    checks, bounds = verify_design(read(design, tmp_path).certificate)
    assert bounds is not None, checks
    true = norm_of(design["plant"], design["gain"])
    assert true * (1 - 1e-4) < float(bounds.gamma) < true * (1 + 1e-4)
    assert FLOORS[design["plant"]["time"]] ** 2 <= bounds.floor_squared < bounds.gamma**2
    A, C, L = (np.array(design[key] if key == "gain" else design["plant"][key]) for key in ("A", "C", "gain"))
    modes = np.linalg.eigvals(A - L @ C)
    slowest = modes.real.max() if design["plant"]["time"] == "continuous" else -np.abs(modes).max()
    assert float(bounds.decay) == pytest.approx(-slowest, rel=1e-5)
    assert bounds.enlarged == (0, 0)


def entries(X, path=()):
    """Iterate over the paths to numbers, and to texts of numbers, in nested data."""
    items = X.items() if isinstance(X, dict) else enumerate(X) if isinstance(X, list) else ()
    for key, value in items:
        if isinstance(value, dict | list):
            yield from entries(value, (*path, key))
        elif isinstance(value, float) or (isinstance(value, str) and "/" in value and key != "schema"):
            yield (*path, key)


def at(design, path):
    for key in path:
        design = design[key]
    return design


CHANGES = (
    lambda x: -x,
    lambda x: x * 2,
    lambda x: x * Fraction(1025, 1024),
    lambda x: x * Fraction(1023, 1024),
    lambda x: x + 1,
    lambda x: 0 * x,
)


def mutants(design):
    """Iterate over designs with one number changed, and its mirror image in a symmetric matrix."""
    for path in entries({key: design[key] for key in ("plant", "gain", "certificate")}):
        for change in CHANGES:
            old = at(design, path)
            new = change(Fraction(old))
            mutant = deepcopy(design)
            value = float(new) if isinstance(old, float) else f"{new.numerator}/{new.denominator}"
            at(mutant, path[:-1])[path[-1]] = value
            i, j = path[-2:]
            if isinstance(i, int) and path[-3] not in ("A", "C", "N", "gain", "H", "K", "G"):
                at(mutant, path[:-2])[j][i] = value
            yield mutant


def slowest_mode(design):
    """Return the greatest real part of a mode, in discrete time the greatest modulus."""
    A, C = np.array(design["plant"]["A"]), np.array(design["plant"]["C"])
    modes = np.linalg.eigvals(A - np.array(design["gain"]) @ C)
    return modes.real.max() if design["plant"]["time"] == "continuous" else np.abs(modes).max()


def test_every_accepted_mutant_is_true(design, tmp_path):
    accepted = rejected = 0
    for mutant in mutants(design):
        _, bounds = verify_design(read(mutant, tmp_path).certificate)
        if bounds is None:
            rejected += 1
            continue
        accepted += 1
        norm = norm_of(mutant["plant"], mutant["gain"], 60)
        assert norm <= float(bounds.gamma) * (1 + 1e-9)
        assert bounds.floor_squared <= bounds.gamma**2
        bound = -bounds.decay if mutant["plant"]["time"] == "continuous" else bounds.decay
        assert slowest_mode(mutant) <= float(bound) + 1e-12
    assert accepted > 5
    assert rejected > 200


@pytest.mark.parametrize("time", TIMES)
def test_no_accepted_floor_is_above_the_smallest_norm_of_a_gain(time):
    """Multipliers at random about the best ones, against the norm minimised over gains."""
    data, rng = data_of(time), np.random.default_rng(3)
    plant, found = design_plant(data), certified_floor(design_plant(data), FLOORS[time], 2 * FLOORS[time])
    start = minimize(lambda x: norm_of(data, x[:, None], 60), np.ravel(GAINS[time]), method="Nelder-Mead")
    options = {"xatol": 1e-6, "fatol": 1e-7}
    least = minimize(lambda x: norm_of(data, x[:, None], 100), start.x, method="Nelder-Mead", options=options).fun
    Z, H, K = (np.zeros((2, 2)) if X is None else floats(X) for X in (found.Z, found.H, found.K))
    Z, accepted, rejected, best = Z / np.trace(Z), 0, 0, 0.0
    for step in range(600):
        D = rng.standard_normal((3, 2, 2)) * 10.0 ** -(1 + 6 * step / 600)
        checks, squared = floor_checks(plant, floor_of(plant, Z + D[0], H + D[1], K + D[2]))
        if squared is None or not all(check.holds for check in checks):
            rejected += 1
            continue
        accepted, best = accepted + 1, max(best, float(squared) ** 0.5)
        assert best <= least * (1 + 1e-5)
    assert best > 0.999 * least
    assert accepted > 30
    assert rejected > 30


def floats(X):
    return np.array([[float(X[i, j]) for j in range(X.shape[1])] for i in range(X.shape[0])])


def design_plant(data):
    return ExactPlant(data["time"], *(Exact.of_floats(data[key]) for key in ("A", "C", "W", "V", "N", "M")))


def floor_of(plant, Z, H, K):
    """Return a floor whose matrices are these doubles."""
    Z, H, K = (Exact.of_floats(X.tolist()) for X in ((Z + Z.T) / 2, H, K))
    return Floor(Z, H, None if plant.is_continuous else K)


def unit(n, i, j):
    return Exact.of([[int((p, q) in ((i, j), (j, i))) for q in range(n)] for p in range(n)])


STATEMENTS = {
    "continuous": (
        "Y > 0",
        "(A - LC)Y + Y(A - LC)' + 2aY <= 0",
        "G_L(P) + PMP/gamma^2 <= 0",
        "Z >= 0",
        "TZ + ZT' >= 0",
    ),
    "discrete": (
        "Y > 0",
        "(A - LC)Y(A - LC)' - r^2 Y <= 0",
        "[[P - J_L, (A - LC)P], [P(A - LC)', P - PMP/gamma^2]] >= 0",
        "Z >= 0",
        "TZ + ZT' - Z - KZK' >= 0",
    ),
}


def failing(certificate):
    checks, bounds = verify_design(certificate)
    assert (bounds is None) == any(not check.holds for check in checks)
    return {check.statement for check in checks if not check.holds}


@pytest.fixture
def certificate(design, tmp_path):
    return read(design, tmp_path).certificate


def test_a_better_decay_than_the_slowest_mode_is_rejected(certificate):
    positive, decays, *_ = STATEMENTS[certificate.plant.time]
    decay = certificate.decay
    better = Fraction(1001, 1000) if certificate.plant.is_continuous else Fraction(999, 1000)
    assert failing(replace(certificate, decay=replace(decay, bound=decay.bound * better))) == {decays}
    assert failing(replace(certificate, decay=replace(decay, Y=-decay.Y))) == {positive, decays}
    zero = Exact.of([[0, 0], [0, 0]])
    assert failing(replace(certificate, decay=replace(decay, Y=zero))) == {positive}
    if not certificate.plant.is_continuous:
        assert "r > 0" in failing(replace(certificate, decay=replace(decay, bound=-decay.bound)))


def test_a_smaller_norm_than_the_true_one_is_rejected(certificate):
    _, _, bounded, *_ = STATEMENTS[certificate.plant.time]
    norm = certificate.norm
    assert failing(replace(certificate, norm=replace(norm, gamma=norm.gamma * Fraction(999, 1000)))) == {bounded}
    for i in range(2):
        for sign in (1, -1):
            moved = replace(norm, P=norm.P + unit(2, i, i) * Fraction(sign, 10))
            assert failing(replace(certificate, norm=moved)) == {bounded}
    for gamma in (Fraction(0), -norm.gamma):
        assert failing(replace(certificate, norm=replace(norm, gamma=gamma))) == {"gamma > 0"}


def test_a_floor_needs_each_of_its_inequalities(certificate):
    *_, semidefinite, above = STATEMENTS[certificate.plant.time]
    floor = certificate.floor
    indefinite = floor.Z - Exact.identity(2) * Fraction(10**9)
    assert semidefinite in failing(replace(certificate, floor=replace(floor, Z=indefinite)))
    assert above in failing(replace(certificate, floor=replace(floor, H=floor.H * Fraction(-1))))
    nothing = Exact.of([[0, 0], [0, 0]])
    assert failing(replace(certificate, floor=replace(floor, Z=nothing))) == {"tr(ZE) > 0"}
    if floor.K is not None:
        assert failing(replace(certificate, floor=replace(floor, K=floor.K * Fraction(-1)))) >= {above}


def test_noise_and_weight_that_are_not_semidefinite_prove_no_norm(certificate):
    plant = certificate.plant
    of_weight = replace(plant, M=Exact.of([[1, 2], [2, 1]]))
    assert "M >= 0" in failing(replace(certificate, cost=replace(certificate.cost, plant=of_weight)))
    of_noise = replace(plant, N=Exact.of([[2], [2]]))
    assert "J >= 0" in failing(replace(certificate, cost=replace(certificate.cost, plant=of_noise)))
    of_noise = replace(plant, V=Exact.of([[0]]))
    checks, squared = floor_checks(of_noise, certificate.floor)
    assert squared is None
    assert "V > 0" in {check.statement for check in checks if not check.holds}
    without = replace(certificate, norm=None, floor=None)
    assert failing(replace(without, cost=replace(certificate.cost, plant=of_weight))) == set()


@pytest.mark.parametrize("time", TIMES)
def test_noise_semidefinite_but_for_rounding_is_enlarged_and_that_is_said(time, tmp_path):
    data = data_of(time) | {"W": [[4.0, 4.0], [4.0, 4.0 - 2.0**-51]], "N": [[0.0], [0.0]]}
    certificate = certify_design(as_plant(data), np.array(GAINS[time]), floor=0.1)
    checks, bounds = verify_design(certificate)
    assert bounds is not None, checks
    assert bounds.enlarged == (Fraction(1, 2**50), 0)
    plant, _, _ = proper(certificate.plant)
    assert plant.W[0, 0] == 4 + Fraction(4, 2**50)
    assert plant.W[0, 1] == 4
    worse = replace(certificate.plant, W=Exact.of([[4, 4], [4, 4 - Fraction(1, 2**30)]]))
    assert "J >= 0" in failing(replace(certificate, cost=replace(certificate.cost, plant=worse)))
    assert floor_squared(worse, certificate.floor) is None
    assert floor_squared(certificate.plant, certificate.floor) == bounds.floor_squared
    design = {"schema": "lmi-design/1", "plant": data, "objective": {"name": "hinf"}, "gain": GAINS[time]}
    result = certify(design | {"achieved": {}, "certificate": certificate.as_dict()}, tmp_path)
    assert result.exit_code == 0, result.output
    assert "the noise matrix is not exactly semidefinite: H-infinity norms are those with" in result.stdout


PARTS = [("decay", "Y"), ("norm", "P"), ("norm", "G"), ("floor", "Z"), ("floor", "H"), ("floor", "K")]


@pytest.mark.parametrize(("part", "key"), PARTS)
def test_shapes_and_symmetry_are_required(certificate, part, key):
    value = getattr(certificate, part)
    if getattr(value, key) is None:
        with pytest.raises(InputError, match=f"^{part}.{key}: expected in discrete time"):
            replace(certificate, **{part: replace(value, **{key: Exact.identity(2)})})
        return
    with pytest.raises(InputError, match=f"^{part}.{key}: expected shape"):
        replace(certificate, **{part: replace(value, **{key: Exact.of([[1]])})})
    if key in ("Y", "P", "Z"):
        skew = getattr(value, key) + Exact.of([[0, 1], [0, 0]])
        with pytest.raises(InputError, match=f"^{part}.{key}: expected a symmetric"):
            replace(certificate, **{part: replace(value, **{key: skew})})
    if key in ("G", "K"):
        with pytest.raises(InputError, match=f"^{part}.{key}: expected in discrete time"):
            replace(certificate, **{part: replace(value, **{key: None})})


def test_the_congruence_of_a_norm_changes_nothing_but_the_time_it_takes():
    certificate = design_certificate("discrete")
    for gamma, holds in ((certificate.norm.gamma, True), (certificate.norm.gamma * Fraction(999, 1000), False)):
        for G in (certificate.norm.G, Exact.of([[0, 0], [0, 0]]), Exact.of([[5, -3], [Fraction(1, 7), 2]])):
            checks, _ = verify_design(replace(certificate, norm=replace(certificate.norm, gamma=gamma, G=G)))
            assert all(check.holds for check in checks) == holds


def design_certificate(time):
    return certify_design(as_plant(data_of(time)), np.array(GAINS[time]), floor=FLOORS[time])


def test_the_cross_term_is_removed_exactly():
    rng = np.random.default_rng(8)
    A, C, N = (rng.integers(-9, 10, shape) for shape in ((3, 3), (4, 3), (3, 4)))
    G = rng.integers(-9, 10, (4, 4))
    V, W = G @ G.T + 3 * np.eye(4, dtype=int), N @ N.T
    matrices = (Exact.of(X.tolist()) for X in (A, C, W, V, N, W))
    plant = ExactPlant("discrete", *matrices)
    F, q, information = reduced_noise(plant)
    inverse = np.linalg.inv(V)
    for exact, X in ((F, A - N @ inverse @ C), (q, W - N @ inverse @ N.T), (information, C.T @ inverse @ C)):
        assert np.allclose(floats(exact), X, rtol=1e-12, atol=1e-12)
    determinant = round(np.linalg.det(V))
    assert all((F[i, j] * determinant).denominator == 1 for i in range(3) for j in range(3))


def test_noise_that_takes_too_long_to_invert_is_not_decided(monkeypatch):
    one, many, row = Exact.of([[1]]), Exact.identity(9), Exact.of([[1]] * 9)
    plant = ExactPlant("continuous", one, row, one, many, Exact.of([[0] * 9]), one)
    floor_checks(plant, Floor(one, one))
    monkeypatch.setattr(module, "INVERSE_WORK", 9**4 - 1)
    with pytest.raises(TooLargeError, match="9 outputs"):
        floor_checks(plant, Floor(one, one))


def test_exponentials_are_compared_rigorously():
    tiny = Fraction(1, 10**50)
    for x in (Fraction(1, 3), Fraction(1), Fraction(50), Fraction(-2), Fraction(0.1) * Fraction(0.3)):
        r = Fraction(exp(-float(x)))
        assert below_exp(r * (1 - Fraction(1, 10**12)), x)
        assert above_exp(r * (1 + Fraction(1, 10**12)), x)
        assert not (below_exp(r, x) and above_exp(r, x))
    e = sum((Fraction(1, factorial(k)) for k in range(60)), Fraction(0))  # below e by less than 1e-80
    assert below_exp(1 / e - tiny, Fraction(1))
    assert not below_exp(1 / e + tiny, Fraction(1))
    assert above_exp(1 / e + tiny, Fraction(1))
    assert not above_exp(1 / e - tiny, Fraction(1))
    beyond = Fraction(1, 10**61)
    assert not below_exp((1 + beyond) / e, Fraction(1))
    assert not above_exp((1 - beyond) / e, Fraction(1))
    assert below_exp(Fraction(1), Fraction(0))
    assert not below_exp(1 + tiny, Fraction(0))
    assert not above_exp(Fraction(1), Fraction(0))
    assert above_exp(1 + tiny, Fraction(0))
    assert not below_exp(tiny, Fraction(10**9))
    rate = decay_rate(1 / e + tiny, Fraction(1, 2))
    assert 2 - 8 * tiny < rate < 2
    for x in (Fraction(2), Fraction(1, 10**40), Fraction(10**40) + 1, Fraction(0), Fraction(9, 4)):
        root = root_below(x)
        assert root**2 <= x <= (root + (1 + root) * Fraction(1, 2**150)) ** 2


@pytest.mark.parametrize("time", TIMES)
def test_a_mode_that_no_output_sees_is_kept(time):
    one, zero = Exact.of([[1]]), Exact.of([[0], [0]])
    A = Exact.of([[Fraction(-1, 2), 1], [0, 3]])
    plant = ExactPlant(time, A, Exact.of([[0, 1]]), Exact.identity(2), one, zero, Exact.identity(2))
    unseen, at_it = Unseen(Exact.of([[1], [0]]), Exact.of([[Fraction(-1, 2)]])), Fraction(-1, 2)
    if time == "discrete":
        at_it = -at_it
    assert keeps_a_mode(plant, unseen, at_it)
    assert keeps_a_mode(plant, unseen, at_it - Fraction(1, 10**9))
    assert not keeps_a_mode(plant, unseen, at_it + Fraction(1, 10**9))
    assert not keeps_a_mode(plant, replace(unseen, T=Exact.of([[2]])), at_it)
    assert not keeps_a_mode(plant, Unseen(Exact.of([[2], [7]]), Exact.of([[3]])), at_it)  # C sees it
    assert not keeps_a_mode(plant, Unseen(zero, Exact.of([[3]])), at_it)
    assert not keeps_a_mode(plant, Unseen(one, one), at_it)
    if time == "discrete":
        assert not keeps_a_mode(plant, unseen, Fraction(0))
        assert not keeps_a_mode(plant, unseen, -at_it)
