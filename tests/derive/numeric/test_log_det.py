"""The logarithmic integral enclosed three ways, against the Riccati equation, closed forms and plain quadrature."""

from dataclasses import replace

import numpy as np
import pytest
from flint import acb, acb_mat, arb, fmpq_poly
from scipy.integrate import quad

from derive.numeric.balls import exact, working_bits
from derive.numeric.eigenvalues import _components, enclosed_eigenvalues
from derive.numeric.enclosure import enclose_riccati
from derive.numeric.log_det import (
    enclose_by_eigenvalues,
    enclose_by_polynomials,
    enclose_by_quadrature,
    enclose_log_det,
)
from derive.numeric.log_integral import _tail
from derive.numeric.plant import Plant
from derive.numeric.riccati import solve_riccati
from derive.numeric.spectral_polynomials import spectral_polynomials
from derive.numeric.spectrum import hamiltonian_route, output_cost, output_error_integral
from tests.derive.numeric import references
from tests.derive.numeric.plants import OSCILLATOR, STABILISING, STRONG, continuous, discrete, random_plant

TIMES = ["continuous", "discrete"]
WAYS = [enclose_by_eigenvalues, enclose_by_polynomials, enclose_by_quadrature]
HIGH = 300


def chain(masses: int, damping: float, time: str = "continuous") -> Plant:
    """Return masses between springs, the last one driven and the first one seen, all modes with this damping ratio."""
    K = 2 * np.eye(masses) - np.eye(masses, k=1) - np.eye(masses, k=-1)
    sizes, modes = np.linalg.eigh(K)
    D = modes @ np.diag(2 * damping * np.sqrt(sizes)) @ modes.T
    A = np.block([[np.zeros((masses, masses)), np.eye(masses)], [-K, -D]])
    W = np.diag([0.0] * (2 * masses - 1) + [1.0])
    V = 0.01
    if time == "discrete":
        from scipy.linalg import expm

        n = 2 * masses
        both = expm(0.1 * np.block([[-A, W], [np.zeros((n, n)), A.T]]))
        A = both[n:, n:].T
        W, V = A @ both[:n, n:], 0.1
        W = (W + W.T) / 2
    n = 2 * masses
    return Plant(time=time, A=A, C=np.eye(1, n), W=W, V=np.eye(1) * V, N=np.zeros((n, 1)), M=np.eye(n))


def truth_of(plant):
    """Return the output cost by an independent solution of the Riccati equation to 70 digits."""
    P = references.reference(plant, solve_riccati(plant).P)
    C, V = exact(plant.C), exact(plant.V)
    output = C * P * C.transpose()
    return V.solve(output).trace() if plant.is_continuous else (output + V).det().log()


@pytest.mark.parametrize("time", TIMES)
@pytest.mark.parametrize("n", [1, 2, 3, 4])
@pytest.mark.parametrize("cross", [False, True])
def test_three_ways_hold_a_reference_of_seventy_digits(time, n, cross):
    plant = random_plant(time, n, seed=n + 20, cross=cross)
    with working_bits(HIGH):
        truth = truth_of(plant)
    for way, digits in zip(WAYS, (60, 60, 12), strict=True):
        found = way(plant, digits)
        assert (found.status, found.reason) == ("verified", "")
        assert found.digits >= digits
        with working_bits(HIGH):
            assert found.value.overlaps(truth), way
            assert (found.integral + found.unstable_term).overlaps(truth), way


@pytest.mark.parametrize(("plant", "P", "modes"), STRONG.values(), ids=STRONG)
def test_unexcited_boundary_modes_need_no_exception(plant, P, modes):
    found = enclose_log_det(plant)
    assert found.status == "verified"
    assert float(abs(found.value - output_cost(plant, np.array(P, float))).abs_upper()) < 1e-15
    for way in WAYS[1:]:
        assert way(plant).value.overlaps(found.value)


@pytest.mark.parametrize(("plant", "P"), STABILISING.values(), ids=STABILISING)
def test_degenerate_plants(plant, P):
    found = enclose_log_det(plant)
    assert found.status == "verified"
    assert float(abs(found.value - output_cost(plant, np.array(P, float))).abs_upper()) < 1e-15


@pytest.mark.parametrize(
    ("plant", "mode"),
    [
        (continuous(A=0, C=1, W=1, V=1), " 0"),
        (continuous(A=OSCILLATOR, C=[[1, 0]], W=np.diag([0, 1]), V=1), "1j"),
        (discrete(A=1, C=1, Q=1, R=1), " 1"),
    ],
)
def test_excited_boundary_modes_stop_only_the_quadrature(plant, mode):
    refused = enclose_by_quadrature(plant)
    assert (refused.status, refused.digits) == ("open", 0)
    assert refused.reason.endswith(mode)
    assert not refused.value.is_finite()
    exact_cost = enclose_riccati(plant).output_cost
    assert enclose_by_polynomials(plant).value.overlaps(exact_cost)
    assert enclose_by_eigenvalues(plant).value.overlaps(exact_cost)


DEGENERATE = {
    "repeated modes": continuous(A=-np.eye(3), C=np.ones((1, 3)), W=np.eye(3), V=1),
    "a Jordan block": continuous(A=[[-1, 1, 0], [0, -1, 1], [0, 0, -1]], C=[[1, 0, 0]], W=np.diag([0, 0, 1]), V=1),
    "two equal loops": continuous(A=np.diag([1, 1]), C=np.eye(2), W=np.eye(2), V=np.eye(2)),
    "uncontrollable modes": continuous(A=np.diag([-1, 2, -3]), C=[[1, 1, 1]], W=np.diag([1, 0, 0]), V=1),
    "C of low rank": continuous(A=[[0, 1], [-2, 1]], C=[[1, 0], [2, 0], [0, 0]], W=np.eye(2), V=np.eye(3)),
    "a delay line": discrete(A=np.eye(4, k=1), C=np.eye(1, 4), Q=np.diag([0, 0, 0, 1]), R=1),
    "repeated modes, discrete": discrete(A=np.diag([0.5, 0.5, 0.5]), C=np.ones((1, 3)), Q=np.eye(3), R=1),
    "uncontrollable modes, discrete": discrete(A=np.diag([0.5, 2, 0]), C=[[1, 1, 1]], Q=np.diag([1, 0, 0]), R=1),
    "C of low rank, discrete": discrete(A=[[0, 1], [-2, 1]], C=[[1, 0], [2, 0]], Q=np.eye(2), R=np.eye(2)),
    "closed loop with a double mode": continuous(A=[[0, 1], [0, 0]], C=[[1, 0]], W=np.diag([4, 1]), V=1),
}
"""Plants with multiple eigenvalues of F or of the Hamiltonian matrix."""


@pytest.mark.parametrize("plant", DEGENERATE.values(), ids=DEGENERATE)
def test_multiple_and_hidden_modes(plant):
    found, cost = enclose_log_det(plant, digits=25), enclose_riccati(plant, digits=40).output_cost
    assert (found.status, found.digits >= 25) == ("verified", True)
    assert found.value.overlaps(cost)
    assert enclose_by_polynomials(plant).value.overlaps(cost)
    eigenvalues = enclose_by_eigenvalues(plant)
    assert eigenvalues.status == "open" or eigenvalues.value.overlaps(cost)


def test_an_oscillator_by_its_closed_form():
    plant = continuous(A=[[0, 1], [-4, -1e-6]], C=[[1, 0]], W=np.diag([0, 3]), V=0.5)
    with working_bits(HIGH):
        truth = references.damped_oscillator(4, 1e-6, 3, 0.5)[0, 0] / arb(0.5)
        assert enclose_log_det(plant, 40).value.overlaps(truth)


def test_the_golden_plant():
    found = enclose_log_det(discrete(A=1, C=1, Q=1, R=1), 40)
    with working_bits(HIGH):
        assert found.value.overlaps(((3 + arb(5).sqrt()) / 2).log())
    assert found.digits >= 40


def response(plant, w, A, W, N):
    """Return ln det of C X W X* C' + C X N + N' X* C' + V, X = (s - A)^-1."""
    s = 1j * w if plant.is_continuous else np.exp(1j * w)
    CX = plant.C @ np.linalg.inv(s * np.eye(plant.n) - A)
    return np.linalg.slogdet(CX @ W @ CX.conj().T + CX @ N + (CX @ N).conj().T + plant.V)[1]


@pytest.mark.parametrize("time", TIMES)
def test_the_integral_is_the_integral(time):
    plant = random_plant(time, 3, 2, seed=31)
    gain = plant.N @ np.linalg.inv(plant.V)
    F, W = plant.A - gain @ plant.C, plant.W - gain @ plant.N.T
    noise = np.linalg.slogdet(plant.V)[1] if time == "continuous" else 0.0
    end = np.inf if time == "continuous" else np.pi
    value = quad(lambda w: response(plant, w, F, W, 0 * plant.N) - noise, 0, end, epsabs=1e-12, epsrel=1e-12)[0] / np.pi
    assert float(enclose_log_det(plant).integral.mid()) == pytest.approx(value, rel=1e-9)


def test_the_output_spectrum_with_its_cross_term():
    """tr(CPC'V^-1) + tr(CNV^-1) = (1/2 pi) int ln(det Phi_y / det V) dw + 2 sum max(0, Re lambda_i(A))."""
    plant = random_plant("continuous", 3, 2, seed=32)
    noise = np.linalg.slogdet(plant.V)[1]
    value = quad(lambda w: response(plant, w, plant.A, plant.W, plant.N) - noise, 0, np.inf, limit=200)[0] / np.pi
    unstable = 2 * np.maximum(np.linalg.eigvals(plant.A).real, 0).sum()
    feedthrough = np.trace(plant.C @ plant.N @ np.linalg.inv(plant.V))
    assert float(enclose_log_det(plant).value.mid()) + feedthrough == pytest.approx(value + unstable, rel=1e-9)


@pytest.mark.parametrize("time", TIMES)
@pytest.mark.parametrize("damping", [1e-3, 1e-6])
def test_adaptive_quadrature_is_good_to_thirteen_digits(time, damping):
    plant = chain(5, damping, time)
    truth = enclose_log_det(plant)
    assert truth.digits >= 20
    error = float(abs((truth.value - output_error_integral(plant).value) / truth.value).abs_upper())
    assert error <= 1e-13
    assert hamiltonian_route(plant).value == pytest.approx(float(truth.value.mid()), rel=1e-12)


@pytest.mark.parametrize("terms", [1, 2, 3, 10, 100])
def test_the_rest_of_the_series_is_in_the_ball(terms):
    """int_e^inf ln((w^2 + 4)/(w^2 + 1)) dw = pi - e ln((e^2 + 4)/(e^2 + 1)) - 4 atan(e/2) + 2 atan(e)."""
    with working_bits(250):
        e = arb(4)
        found = _tail(fmpq_poly([-4, 1]), fmpq_poly([-1, 1]), arb(4), e, terms)
        truth = arb.pi() - e * ((e**2 + 4) / (e**2 + 1)).log() - 4 * (e / 2).atan() + 2 * e.atan()
        assert found.overlaps(truth)
        assert found.rad() < 40 * arb(4) ** -terms


def test_steep_spectra():
    """Between its slow modes and its bandwidth det Phi falls like w^-8, through twenty orders of magnitude."""
    plant = continuous(A=np.eye(4, k=1) - 0.05 * np.eye(4), C=np.eye(1, 4), W=np.diag([0, 0, 0, 1e8]), V=1)
    found = enclose_by_quadrature(plant)
    assert (found.status, found.digits >= 15) == ("verified", True)
    assert found.value.overlaps(enclose_by_polynomials(plant).value)


@pytest.mark.parametrize("time", TIMES)
def test_another_plant_has_another_integral(time):
    plant = random_plant(time, 3, 1, seed=33)
    values = [enclose_log_det(replace(plant, W=plant.W * factor)).value for factor in (1, 1 + 1e-12)]
    assert not values[0].overlaps(values[1])


@pytest.mark.parametrize("time", TIMES)
def test_more_digits_are_narrower_balls(time):
    plant = random_plant(time, 4, 2, seed=34)
    found = [enclose_log_det(plant, digits) for digits in (10, 30, 60)]
    assert [e.digits >= d for e, d in zip(found, (10, 30, 60), strict=True)] == [True] * 3
    assert found[0].value.rad() > found[1].value.rad() > found[2].value.rad()
    assert found[0].value.contains(found[2].value)


@pytest.mark.parametrize("time", TIMES)
def test_the_spectrum_is_a_quotient_of_the_polynomials(time):
    plant = random_plant(time, 3, 2, seed=35)
    p = spectral_polynomials(plant)
    gain = plant.N @ np.linalg.inv(plant.V)
    F, W = plant.A - gain @ plant.C, plant.W - gain @ plant.N.T
    for w in (0.1, 1.0, 3.0):
        x = -(w**2) if time == "continuous" else 2 * np.cos(w)
        top, bottom = (
            sum(float(c.p) / float(c.q) * x**k for k, c in enumerate(q.coeffs())) for q in (p.numerator, p.denominator)
        )
        assert np.log(top / bottom) == pytest.approx(response(plant, w, F, W, 0 * plant.N), rel=1e-10)
    np.testing.assert_allclose([float(c.p) / float(c.q) for c in reversed(p.feedback.coeffs())], np.poly(F), rtol=1e-9)


def test_eigenvalues_are_held_with_their_multiplicity():
    known = [2.0, 2.0, -1.0, 0.5, 0.5, 0.5]
    T = np.array([[1, 2, 0, 1, 3, 1], [0, 1, 1, 0, 2, 1], [0, 0, 1, 2, 1, 0], [0, 0, 0, 1, 1, 2], [0, 0, 0, 0, 1, 1],
                  [0, 0, 0, 0, 0, 1.0]])  # fmt: skip
    H = T @ np.diag(known) @ np.round(np.linalg.inv(T))
    with working_bits(150):
        boxes = enclosed_eigenvalues(acb_mat(exact(H)), 80)
        assert boxes is not None
        for value in set(known):
            assert sum(box.contains(acb(value)) for box in boxes) == known.count(value)
            assert all(float(box.rad()) < 1e-6 for box in boxes)


def test_eigenvalues_of_random_matrices():
    H = np.random.default_rng(2).standard_normal((12, 12))
    with working_bits(150):
        boxes = enclosed_eigenvalues(acb_mat(exact(H)), 100)
        assert boxes is not None
        assert sum(boxes, acb(0)).real.overlaps(exact(H).trace())
        product = acb(1)
        for box in boxes:
            product *= box
        assert product.real.overlaps(exact(H).det())
        assert all(float(box.rad()) < 1e-30 for box in boxes)
    for box, value in zip(sorted(boxes, key=_place), sorted(np.linalg.eigvals(H), key=_place), strict=True):
        assert complex(box.mid()) == pytest.approx(value, abs=1e-12)


def _place(z):
    return complex(z.mid() if isinstance(z, acb) else z).real, complex(z.mid() if isinstance(z, acb) else z).imag


def test_overlapping_discs_are_one_box():
    """The eigenvalues +-0.03 lie outside the second row's disc of radius 0.001, inside the union."""
    with working_bits(100):
        for box in _components(acb_mat([[0, 1], [0.001, 0]])):
            assert box.contains(acb(arb(0.001).sqrt()))
            assert box.contains(-acb(arb(0.001).sqrt()))
        apart = _components(acb_mat([[0, 0.001], [0.001, 1]]))
        assert not apart[0].overlaps(apart[1])


def test_defective_matrices_are_refused_or_held():
    with working_bits(150):
        for size in (2, 3, 4):
            boxes = enclosed_eigenvalues(acb_mat(exact(np.eye(size) + np.eye(size, k=1))), 80)
            assert boxes is None or all(box.contains(acb(1)) for box in boxes)
