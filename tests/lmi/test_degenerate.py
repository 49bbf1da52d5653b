"""Degenerate plants: each gives the right answer, certified, or one line that names what is wrong."""

import json
from decimal import Decimal, localcontext
from math import sqrt

import numpy as np
import pytest
from click.testing import CliRunner

import lmi
from derive.errors import InputError
from lmi.cli import cli
from lmi.validation import Verdict
from tests.derive.numeric.plants import OSCILLATOR, ROTATION, continuous, discrete

ONE, NOTHING = np.eye(2), np.zeros((2, 2))
FIRST, BLIND = [[1, 0]], [[0, 0]]
DAMPED, GROWING, TURNING = (
    np.array([[0, 1], [-2, -1]]),
    np.array([[0, 1], [2, -1]]),
    np.array([[0.3, -0.4], [0.4, 0.3]]),
)
CHAIN = np.eye(3, k=1) - np.eye(3)
GOLDEN = (1 + sqrt(5)) / 2


def scalar(a, w, g):
    """Return P of x' = a x + w, seen with information g = C'V^-1 C."""
    return (a + sqrt(a * a + w * g)) / g


def damped(w=1, v=1, c=1, rate=1):
    """Return tr P of x' = rate DAMPED x + noise of intensity w I, y = c x_1 + noise of intensity v.

    In the time rate t, with W = w / rate and V = v rate / c^2, the characteristic polynomial s^2 + b s + d of the
    observer is the stable factor of s^4 + 3 s^2 + 4 + (2 - s^2) W / V; sixty digits leave room for the cancellation.
    """
    with localcontext() as context:
        context.prec = 200
        w, v, c, rate = (Decimal(repr(x)) for x in (w, v, c, rate))
        W, V = w / rate, v * rate / c**2
        d = (4 + 2 * W / V).sqrt()
        b = (2 * d - 3 + W / V).sqrt()
        p11, p12 = V * (b - 1), V * (d - 1 - b)
        return float(p11 + 2 * p11 + p12 + p11 * p12 / V)


def oscillator(w, v):
    """Return tr P of x'' + x = w, seen through v: the stable factor of s^4 + 2 s^2 + 1 + w / v is s^2 + b s + d."""
    w, v = Decimal(repr(w)), Decimal(repr(v))
    d = (1 + w / v).sqrt()
    p11 = v * (2 * d - 2).sqrt()
    return float(2 * p11 + p11**3 / (2 * v * v))


def unseen(A, W, time):
    """Return the trace of the covariance that no measurement reduces, by Kronecker products."""
    n = len(A)
    one = np.eye(n)
    K = np.kron(A, one) + np.kron(one, A) if time == "continuous" else np.kron(A, A) - np.eye(n * n)
    return np.trace(np.linalg.solve(K, -W.ravel()).reshape(n, n))


def alike(rho):
    """Return C'V^-1 C of the outputs x and 2 x, whose noises have the correlation rho."""
    rho = Decimal(rho)
    return float((5 - 4 * rho) / (1 - rho * rho))


NEAR = 1 - 1e-10
HUGE, TINY = 1e40, 1e-40

ANSWERED = {
    "W = 0, stable": (continuous(A=DAMPED, C=FIRST, W=NOTHING, V=1), 0),
    "W = 0, stable, discrete": (discrete(A=TURNING, C=FIRST, W=NOTHING, V=1), 0),
    "W = 0, unstable": (continuous(A=GROWING, C=FIRST, W=NOTHING, V=1), 4),
    "W = 0, unstable, discrete": (discrete(A=[[2, 1], [0, 0.5]], C=FIRST, W=NOTHING, V=1), 3),
    "boundary mode excited": (continuous(A=0, C=1, W=4, V=1), 2),
    "boundary modes excited": (continuous(A=OSCILLATOR, C=FIRST, W=np.diag([0, 1]), V=1), oscillator(1, 1)),
    "boundary modes hardly excited": (
        continuous(A=OSCILLATOR, C=FIRST, W=np.diag([0, 1e-6]), V=1),
        oscillator(1e-6, 1),
    ),
    "boundary mode excited, discrete": (discrete(A=1, C=1, Q=1, R=1), GOLDEN),
    "C = 0": (continuous(A=DAMPED, C=BLIND, W=ONE, V=1), unseen(DAMPED, ONE, "continuous")),
    "C = 0, discrete": (discrete(A=TURNING, C=BLIND, Q=ONE, R=1), unseen(TURNING, ONE, "discrete")),
    "l = n": (continuous(A=np.diag([1, -2]), C=ONE, W=ONE, V=ONE), scalar(1, 1, 1) + scalar(-2, 1, 1)),
    "l = n, discrete": (discrete(A=ONE, C=ONE, Q=ONE, R=ONE), 2 * GOLDEN),
    "l > n": (continuous(A=1, C=[[1], [2], [2]], W=1, V=np.eye(3)), scalar(1, 1, 9)),
    "repeated outputs": (continuous(A=1, C=[[1], [1]], W=1, V=ONE), scalar(1, 1, 2)),
    "repeated outputs, equal noise": (continuous(A=1, C=[[1], [1]], W=1, V=[[1, 0.5], [0.5, 1]]), scalar(1, 1, 4 / 3)),
    "repeated outputs, discrete": (discrete(A=1, C=[[1], [1]], Q=1, R=2 * ONE), GOLDEN),
    "V nearly singular": (continuous(A=-1, C=[[1], [2]], W=1, V=[[1, NEAR], [NEAR, 1]]), scalar(-1, 1, alike(NEAR))),
    "V = 1e-14": (continuous(A=1, C=1, W=1, V=1e-14), scalar(1, 1, 1e14)),
    "V = 1 and 1e-14": (
        continuous(A=np.diag([1, -2]), C=ONE, W=ONE, V=np.diag([1, 1e-14])),
        scalar(1, 1, 1) + scalar(-2, 1, 1e14),
    ),
    "R = 1e-14": (discrete(A=0, C=1, Q=5, R=1e-14), 5),
    "n = 1": (continuous(A=1, C=1, W=1, V=1), 1 + sqrt(2)),
    "n = 1, discrete": (discrete(A=2, C=1, Q=1, R=1), 2 + sqrt(5)),
    "n = 1, C = 0": (continuous(A=-1, C=0, W=3, V=1), 1.5),
    "A = 0": (continuous(A=NOTHING, C=ONE, W=np.diag([1, 4]), V=ONE), 3),
    "A = 0, discrete": (discrete(A=NOTHING, C=ONE, Q=np.diag([1, 4]), R=ONE), 5),
    "A defective": (continuous(A=[[1, 1], [0, 1]], C=FIRST, W=NOTHING, V=1), 12),
    "A defective, C = 0": (
        continuous(A=CHAIN, C=[[0, 0, 0]], W=np.eye(3), V=1),
        unseen(CHAIN, np.eye(3), "continuous"),
    ),
    "A nilpotent, discrete": (discrete(A=np.eye(3, k=1), C=[[1, 0, 0]], Q=np.eye(3), R=1), 6),
    "time scale of 1e-9 s": (continuous(A=1e9 * DAMPED, C=FIRST, W=1e9 * ONE, V=1e-9), damped()),
    "time scale of 1e9 s": (continuous(A=1e-9 * DAMPED, C=FIRST, W=1e-9 * ONE, V=1e9), damped()),
    "all noise of 1e40": (continuous(A=DAMPED, C=FIRST, W=HUGE * ONE, V=HUGE), HUGE * damped()),
    "all noise of 1e-40": (continuous(A=DAMPED, C=FIRST, W=TINY * ONE, V=TINY), TINY * damped()),
    "all noise of 1e40, discrete": (discrete(A=1, C=1, Q=HUGE, R=HUGE), HUGE * GOLDEN),
    "all noise of 1e-40, discrete": (discrete(A=1, C=1, Q=TINY, R=TINY), TINY * GOLDEN),
    "W of 1e-40": (continuous(A=DAMPED, C=FIRST, W=TINY * ONE, V=1), damped(w=TINY)),
    "W of 1e20": (continuous(A=DAMPED, C=FIRST, W=1e20 * ONE, V=1), damped(w=1e20)),
    "V of 1e40": (continuous(A=DAMPED, C=FIRST, W=ONE, V=HUGE), damped(v=HUGE)),
    "V of 1e-20": (continuous(A=DAMPED, C=FIRST, W=ONE, V=1e-20), damped(v=1e-20)),
    "C of 1e20": (continuous(A=DAMPED, C=[[1e20, 0]], W=ONE, V=1), damped(c=1e20)),
    "C of 1e-40": (continuous(A=DAMPED, C=[[TINY, 0]], W=ONE, V=1), damped(c=TINY)),
    "A of 1e40": (continuous(A=HUGE * DAMPED, C=FIRST, W=ONE, V=1), damped(rate=HUGE)),
    "A of 1e-20": (continuous(A=1e-20 * DAMPED, C=FIRST, W=ONE, V=1), damped(rate=1e-20)),
    "A of 1e-40": (continuous(A=TINY * DAMPED, C=FIRST, W=ONE, V=1), damped(rate=TINY)),
    "C of 1e40": (continuous(A=DAMPED, C=[[HUGE, 0]], W=ONE, V=1), damped(c=HUGE)),
    "A of 1e-40, discrete": (discrete(A=TINY * DAMPED, C=FIRST, Q=ONE, R=1), 2),
    "A of 1e-9, discrete": (discrete(A=1e-9 * DAMPED, C=FIRST, Q=ONE, R=1), 2),
    "dt of 1e-30 s": (discrete(A=1, C=1, Q=1, R=1, dt=1e-30), GOLDEN),
    "dt of 1e30 s": (discrete(A=1, C=1, Q=1, R=1, dt=1e30), GOLDEN),
    "P0": (continuous(A=DAMPED, C=FIRST, W=ONE, V=1, P0=5 * ONE), damped()),
    "singular M": (continuous(A=DAMPED, C=FIRST, W=ONE, V=1, M=np.diag([1, 0])), damped()),
    "M = 0": (continuous(A=DAMPED, C=FIRST, W=ONE, V=1, M=NOTHING), damped()),
}
"""Name: plant, its tr P in closed form."""

UNEXCITED = {
    "an integrator": continuous(A=0, C=1, W=0, V=1),
    "an oscillator": continuous(A=OSCILLATOR, C=FIRST, W=NOTHING, V=1),
    "a double integrator": continuous(A=[[0, 1], [0, 0]], C=FIRST, W=NOTHING, V=1),
    "a constant": discrete(A=1, C=1, Q=0, R=1),
    "a rotation": discrete(A=ROTATION, C=FIRST, Q=NOTHING, R=1),
}

GOOD = {
    "time": "continuous",
    "A": [[0.0, 1.0], [-2.0, -1.0]],
    "C": [[1.0, 0.0]],
    "W": [[1.0, 0.0], [0.0, 1.0]],
    "V": [[1.0]],
}

REFUSED = {
    "undetectable": (
        {"A": [[1.0, 0.0], [0.0, -1.0]], "C": [[0.0, 1.0]]},
        "(A, C): not detectable: mode 1 is unobservable",
    ),
    "undetectable on the boundary": (
        {"A": [[0.0, 0.0], [0.0, -1.0]], "C": [[0.0, 1.0]]},
        "(A, C): not detectable: mode 0 ",
    ),
    "C = 0, unstable": (
        {"A": [[0.0, 1.0], [2.0, -1.0]], "C": [[0.0, 0.0]]},
        "(A, C): not detectable: mode 1 is unobserva",
    ),
    "V singular": (
        {"C": [[1.0, 0.0], [1.0, 0.0]], "V": [[1.0, 1.0], [1.0, 1.0]]},
        "V: not positive definite: eigenvalue ",
    ),
    "V = 0": ({"V": [[0.0]]}, "V: not positive definite: eigenvalue 0"),
    "W of 1e150": (
        {"W": [[1e150, 0.0], [0.0, 1.0]]},
        "W[1][1]: expected 0 or a size between 1e-50 and 1e+50, got 1e+150; ",
    ),
    "V of 1e-150": (
        {"V": [[1e-150]]},
        "V[1][1]: expected 0 or a size between 1e-50 and 1e+50, got 1e-150; choose other units",
    ),
    "A of 1e150": (
        {"A": [[0.0, 1e150], [-2.0, -1.0]]},
        "A[1][2]: expected 0 or a size between 1e-50 and 1e+50, got 1e",
    ),
    "C of 1e-150": ({"C": [[1e-150, 0.0]]}, "C[1][1]: expected 0 or a size between 1e-50 and 1e+50, got 1e-150; "),
    "dt = 0": ({"time": "discrete", "dt": 0.0}, "dt: expected a positive number of seconds, got 0; "),
    "dt of 1e300 s": (
        {"time": "discrete", "dt": 1e300},
        "dt: expected 0 or a size between 1e-50 and 1e+50, got 1e+300; ",
    ),
    "NaN": ({"A": [[0.0, float("nan")], [-2.0, -1.0]]}, "A[1][2]: expected a finite number, got nan; "),
    "infinity": ({"W": [[float("inf"), 0.0], [0.0, 1.0]]}, "W[1][1]: expected a finite number, got inf; "),
    "no entries": ({"A": []}, "A: expected a matrix with at least one entry, got none; "),
    "rows without entries": ({"C": [[]]}, "C: expected a matrix with at least one entry, got none; "),
    "ragged rows": ({"A": [[0.0, 1.0], [-2.0]]}, "A: expected rows of equal length, got 2 in row 1 and 1 in row 2; "),
    "P0 indefinite": ({"P0": [[1.0, 0.0], [0.0, -1.0]]}, "P0: not positive semidefinite: eigenvalue -1 "),
    "M indefinite": ({"M": [[1.0, 2.0], [2.0, 1.0]]}, "M: not positive semidefinite: eigenvalue -1 "),
}
"""Name: what is changed in a good plant, the beginning of the one line."""


@pytest.mark.parametrize(("plant", "trace"), ANSWERED.values(), ids=ANSWERED)
def test_the_right_answer_by_every_route_that_gives_one(plant, trace):
    validation = lmi.validate(plant)
    assert validation.verdict is Verdict.AGREE
    riccati = validation.route("riccati")
    assert riccati.status == "stabilising"
    assert riccati.trace == pytest.approx(trace, rel=1e-12, abs=1e-300)
    assert riccati.cost == pytest.approx(np.trace(plant.M) / plant.n * trace, rel=1e-12) or plant.M.any()
    for route in validation.routes:
        if route.agrees and route.trace is not None and route.name != "simulation":
            assert route.trace == pytest.approx(trace, rel=1e-6, abs=0 if trace else 1e-6), route
    bounds = validation.certificate.certified.bounds.trace
    assert float(bounds.lower) <= trace * (1 + 1e-12)
    assert float(bounds.upper) >= trace * (1 - 1e-12)
    json.dumps(validation.as_dict(), allow_nan=False)


@pytest.mark.parametrize("plant", UNEXCITED.values(), ids=UNEXCITED)
def test_boundary_modes_that_no_noise_excites_are_left_where_they_are(plant):
    validation = lmi.validate(plant)
    assert (validation.verdict, validation.route("riccati").status) == (Verdict.AGREE, "strong")
    assert validation.route("riccati").trace == 0
    assert validation.certificate.certified.bounds.trace.upper < 1e-15


@pytest.mark.parametrize(("change", "line"), REFUSED.values(), ids=REFUSED)
def test_what_cannot_be_answered_gets_one_line(change, line, tmp_path):
    data = {**GOOD, **change}
    with pytest.raises(InputError) as caught:
        lmi.validate(data)
    assert str(caught.value).startswith(line)
    path = tmp_path / "plant.json"
    path.write_text(json.dumps(data))
    result = CliRunner().invoke(cli, ["validate", str(path)])
    assert (result.exit_code, result.stdout, result.stderr) == (2, "", f"lmi: {path}: {caught.value}\n")


@pytest.mark.parametrize("entry", [1j, "1", None, True, [1.0]])
def test_what_is_no_number_gets_one_line(entry):
    with pytest.raises(InputError, match=r"^A\[1\]\[1\]: expected a real number, got .*; write it as 1 or 1\.0$"):
        lmi.validate({**GOOD, "A": [[entry, 1.0], [-2.0, -1.0]]})


@pytest.mark.parametrize("name", ["n = 1", "an integrator", "C = 0", "M = 0"])
def test_the_shell_prints_a_table_and_nothing_else(name, tmp_path):
    plant = ANSWERED[name][0] if name in ANSWERED else UNEXCITED[name]
    data = {key: getattr(plant, key).tolist() for key in "ACWVNM"}
    path = tmp_path / "plant.json"
    path.write_text(json.dumps({"time": plant.time, **data}))
    result = CliRunner().invoke(cli, ["validate", str(path)])
    assert (result.exit_code, result.stderr) == (0, "")
    assert "certified: " in result.stdout
