"""Making exact certificates: floating point and high precision propose the matrices, `lmi.certificate` decides.

In coordinates in which P* has about a unit diagonal, and with D of loop D + D loop' = -I (discrete: loop D loop' - D),
    P_lo = P* - h D: F(P_lo) >= 0, because the Riccati operator is about h I there;
    P_up = P_L + h D: G_L(P_up) = -h I;
    X = D.
All three are rounded to a grid so fine that the inequalities survive. Nothing here is trusted.
"""

from collections.abc import Callable, Iterator
from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np
from flint import arb, arb_mat
from numpy.typing import NDArray

from derive.numeric.balls import identity, middle, norm, positive_definite, working_bits
from derive.numeric.newton import Equation, lyapunov_in_balls, refined
from derive.numeric.plant import Plant
from derive.numeric.riccati import solve_riccati
from lmi.certificate.arithmetic import Exact
from lmi.certificate.sandwich import Bounds, Certificate, ExactPlant, exact_plant, verify
from lmi.certification.frame import Frame, Grid, binary_logarithm, sizes, unit_variances
from lmi.certification.instability import instability, is_stable
from lmi.certification.strong import strong_solution

__all__ = ["Certified", "NotCertifiedError", "UnstableGainError", "certified"]

Matrix = NDArray[np.floating[Any]]

GAP_BITS = 100
"""Binary digits of the sandwich: (P_up - P_lo) / P* is about 2^-100 in each variance."""

PRECISIONS = (320, 640, 1280)
"""Working precisions in bits, tried in this order."""

RATE_BITS = 100
"""The boundary modes of a strong solution are moved inside by 2^-100."""

SHORT_BITS = 20
"""Bits to which a P* on the boundary is rounded, to meet one whose numbers are short."""

LARGEST = 200
"""States up to which a certificate is made."""

SPARE = 8
"""Bits by which the grid is finer than the inequalities need."""

KLEINMAN_STEPS = 80
"""Steps of Kleinman's iteration, each of which halves what boundary modes leave of the error."""

LARGE = 12
"""States above which fewer of these steps are taken."""

FEWER_STEPS = 30

REGULARISING = (1e-6, 1e-3, 1.0)
"""Noise added, relative to the states' natural size, to find a gain that stabilises where the optimum does not."""


class NotCertifiedError(ArithmeticError):
    """No certificate was found; the message says what stood in the way."""


class UnstableGainError(NotCertifiedError):
    """The gain is proved not to stabilise; the message says how."""


class Certified(NamedTuple):
    """A certificate that was verified, and what it proves."""

    certificate: Certificate
    bounds: Bounds


def certified(plant: Plant, gain: Matrix | None = None) -> Certified:
    """Make a certificate of the plant's optimum, and of a gain if one is given; it is verified exactly.

    Args:
        plant: V > 0, (A, C) detectable.
        gain: L (n, l) in doubles, or None for the optimal one.

    Returns:
        The certificate and what it proves.

    Raises:
        UnstableGainError: the gain is proved not to stabilise.
        NotCertifiedError: none was found, and no proof that there is none.

    Example:
        >>> from derive.numeric.plant import example_plant
        >>> certificate, bounds = certified(example_plant())
        >>> bounds.trace.width * 10**29 < bounds.trace.upper
        True
    """
    if plant.n > LARGEST:
        raise NotCertifiedError(f"{plant.n} states, certificates are made for up to {LARGEST}")
    looks_stable = gain is None or is_stable(plant.A - gain @ plant.C, plant.time)
    if not looks_stable:
        _require_stable(plant, gain)
    problem = "no gain found that makes A - LC stable"
    for propose in _attempts(plant, exact_plant(plant), gain):
        try:
            for certificate in propose():
                found, bounds = verify(certificate)
                if bounds is not None:
                    return Certified(certificate, bounds)
                problem = ", ".join(check.statement for check in found if not check.holds)
        except (ArithmeticError, ValueError) as error:
            problem = " ".join(str(error).split())
    if looks_stable:
        _require_stable(plant, gain)
    raise NotCertifiedError(problem)


def _require_stable(plant: Plant, gain: Matrix | None) -> None:
    unstable = None if gain is None else instability(plant, gain)
    if unstable is not None:
        raise UnstableGainError(f"the gain does not stabilise: {unstable}")


Proposals = Callable[[], list[Certificate]]


def _attempts(plant: Plant, fixed: ExactPlant, gain: Matrix | None) -> Iterator[Proposals]:
    """Iterate over ways to propose certificates, the cheapest first."""
    given = None if gain is None else Exact.of_floats(gain.tolist())
    if given is None and not (plant.W.any() or plant.N.any()) and is_stable(plant.A, plant.time):
        yield lambda: _without_noise(plant, fixed)
    solution = solve_riccati(plant)
    if solution.status == "stabilising":
        yield lambda: _from_solution(plant, fixed, given, solution.P)
    else:
        for bits in PRECISIONS:
            yield lambda bits=bits: _from_strong(plant, fixed, given, bits)
    for bits in PRECISIONS:
        yield lambda bits=bits: _from_gain(plant, fixed, given, bits)


def _without_noise(plant: Plant, fixed: ExactPlant) -> list[Certificate]:
    """Propose P* = 0 and L = 0: what noise leaves alone, a stable plant forgets."""
    with working_bits(PRECISIONS[0]):
        frame = Frame.of(plant, Equation.of(plant))
        D, rate = _witness(frame.A.mid(), frame.equation)
        X = Grid.of(frame.equation.scaling).covariance(D, _finer(frame.A, rate))
    zero = _zero(fixed)
    return [Certificate(fixed, zero, zero, X, Exact(((0,) * plant.l,) * plant.n))]


def _from_solution(plant: Plant, fixed: ExactPlant, given: Exact | None, P: Matrix) -> list[Certificate]:
    """Refine a stabilising solution; the gain is the optimal one, rounded to doubles."""
    with working_bits(PRECISIONS[0]):
        equation = Equation.of(plant)
        equation, centre = unit_variances(equation, refined(equation, equation.scaled(P)))
        frame, grid = Frame.of(plant, equation), Grid.of(equation.scaling)
        L = given or grid.gain(frame.gain(centre), None)
        P_up, X = _upper(frame, grid, L)
        return [Certificate(fixed, _lower(equation, grid, centre), P_up, X, L)]


def _from_strong(plant: Plant, fixed: ExactPlant, given: Exact | None, bits: int) -> list[Certificate]:
    """Propose bounds of a strong solution: exact on the boundary modes from below, moved inside from above."""
    with working_bits(bits):
        strong = strong_solution(fixed)
        if strong is None:
            raise NotCertifiedError("modes near the boundary that are not exactly on it, or cannot be split off")
        equation = Equation.of(plant)
        equation, P = unit_variances(equation, strong.nearby(equation, arb(2) ** -RATE_BITS))
        frame, grid = Frame.of(plant, equation), Grid.of(equation.scaling)
        L = given or grid.gain(frame.gain(P), bits // 2)
        P_up, X = _upper(frame, grid, L)
        below = [_zero(fixed)]
        if strong.equation is not None and strong.Pi is not None:
            Pi = _lower(strong.equation, Grid.of(strong.equation.scaling), strong.Pi)
            below = [strong.reduced.lifted(Pi), *below]
    return [Certificate(fixed, P_lo, P_up, X, L) for P_lo in below]


def _from_gain(plant: Plant, fixed: ExactPlant, given: Exact | None, bits: int) -> list[Certificate]:
    """Let Kleinman's iteration fall from the covariance of a stabilising gain.

    Where it does not settle, its last iterate still bounds P* from above, and from below either P* itself, if its
    numbers are short, or 0.
    """
    with working_bits(bits):
        frame = Frame.of(plant, Equation.of(plant))
        start = Grid.of(frame.equation.scaling).scaled_gain(Exact.of_floats(_stabilising_gain(plant).tolist()))
        P, settled = _kleinman(frame.equation, _covariance(frame, start))
        equation, P = unit_variances(frame.equation, P)
        frame, grid = Frame.of(plant, equation), Grid.of(equation.scaling)
        L = given or grid.gain(frame.gain(P), bits // 2)
        P_up, X = _upper(frame, grid, L)
        below = [_lower(equation, grid, P)] if settled else [grid.covariance(P, SHORT_BITS), _zero(fixed)]
    return [Certificate(fixed, P_lo, P_up, X, L) for P_lo in below]


def _zero(fixed: ExactPlant) -> Exact:
    return Exact(((0,) * fixed.n,) * fixed.n)


def _stabilising_gain(plant: Plant) -> Matrix:
    """Return the optimal gain in floating point, or that for more noise where it leaves modes on the boundary."""
    solution = solve_riccati(plant)
    if solution.status == "stabilising":
        return solution.gain
    t = Equation.of(plant).scaling.astype(float)
    rate = (float(np.linalg.norm(plant.A * t / t[:, None], 2)) or 1.0) if plant.is_continuous else 1.0
    for size in REGULARISING:
        solution = solve_riccati(replace(plant, W=plant.W + size * rate * np.diag(t * t)))
        if solution.status == "stabilising":
            return solution.gain
    raise NotCertifiedError("no gain found that makes A - LC stable; is (A, C) detectable?")


def _covariance(frame: Frame, L: arb_mat) -> arb_mat:
    """Return P_L."""
    loop = frame.loop(L)
    _witness(loop, frame.equation)
    return middle(lyapunov_in_balls(loop, frame.noise(L), frame.equation.time))


def _kleinman(equation: Equation, P: arb_mat) -> tuple[arb_mat, bool]:
    """Take Newton steps from above, and tell whether they settled."""
    steps = KLEINMAN_STEPS if equation.n <= LARGE else FEWER_STEPS
    for _ in range(steps):
        step = middle(lyapunov_in_balls(equation.closed_loop(P), middle(equation.residual(P)), equation.time))
        P = middle(P + step)
        if norm(step) <= norm(P) * arb(2) ** -(2 * GAP_BITS):
            return P, True
    return P, False


def _lower(equation: Equation, grid: Grid, P: arb_mat) -> Exact:
    """Return P_lo = P* - h D."""
    loop = equation.closed_loop(P).mid()
    D, rate = _witness(loop, equation)
    k = max(GAP_BITS, binary_logarithm(norm(equation.curvature(P))) + rate + SPARE)
    return grid.covariance(P - D * arb(2) ** -k, k + _finer(loop, rate))


def _upper(frame: Frame, grid: Grid, L: Exact) -> tuple[Exact, Exact]:
    """Return P_up = P_L + h D and X = D."""
    scaled = grid.scaled_gain(L)
    loop = frame.loop(scaled)
    D, rate = _witness(loop, frame.equation)
    P, finer = middle(lyapunov_in_balls(loop, frame.noise(scaled), frame.equation.time)), _finer(loop, rate)
    return grid.covariance(P + D * arb(2) ** -GAP_BITS, GAP_BITS + finer), grid.covariance(D, finer)


def _witness(loop: arb_mat, equation: Equation) -> tuple[arb_mat, int]:
    """Return D with loop D + D loop' = -2^-rate I (discrete: loop D loop' - D) and a diagonal of at most 1."""
    D = middle(lyapunov_in_balls(loop, identity(loop.nrows()), equation.time))
    if not (all(x.is_finite() for x in D.entries()) and positive_definite(D)):
        raise NotCertifiedError(
            "no X > 0 found with (A - LC)X + X(A - LC)' < 0, in discrete time (A - LC)X(A - LC)' < X"
        )
    rate = max(binary_logarithm(D[i, i]) for i in range(D.nrows()))
    return D * arb(2) ** -rate, rate


def _finer(loop: arb_mat, rate: int) -> int:
    """Return by how many bits the grid has to be finer than h, for rounding to stay below 2^-rate h."""
    return max(0, sizes(loop) + rate) + SPARE
