"""Scalar closed forms: corollary 2 against SymPy's integrate, and evaluation against a loop and a formula by hand."""

from __future__ import annotations

import multiprocessing
import time
from typing import Any

import numpy as np

from tests.benchmark.table import Row, best_of

POINTS, SAMPLE, SPEEDUP, SLOWER = 1_000_000, 200, 1000.0, 1.5
RUNS = 20  # by turns, so that both see the same machine
LIMIT = 10.0  # seconds given to SymPy
WHOLE = 10.0  # seconds for the lecture, derived and replayed


def scalar() -> list[Row]:
    """Return the time of the lectures, of SymPy on the same integral, and of a million covariances."""
    return [*map(_lecture, ("scalar", "spectrum")), _integral(), *_evaluation()]


def _lecture(key: str) -> Row:
    from derive.theory import lecture

    start = time.process_time()
    current = lecture(key)
    outcomes = current.verify()
    seconds = time.process_time() - start
    proved = sum(o.accepted for o in outcomes)
    value = f"{proved} of {len(outcomes)} steps, {seconds:.1f} s of processor time"
    wanted = f"all, {WHOLE:.0f} s"
    return Row(f"lecture {key} derived and replayed", value, wanted, proved == len(outcomes) and seconds <= WHOLE)


def _integral() -> Row:
    process = multiprocessing.get_context("spawn").Process(target=integrate_with_sympy)
    start = time.perf_counter()
    process.start()
    process.join(LIMIT)
    seconds, done = time.perf_counter() - start, not process.is_alive() and process.exitcode == 0
    process.kill()
    said = f"an answer after {seconds:.1f} s" if done else f"no answer within {LIMIT:.0f} s"
    return Row("corollary 2, SymPy's integrate", said, "proved here", ok=True)


def integrate_with_sympy() -> None:
    """Ask SymPy for the integral of corollary 2; ends with 0 if it is evaluated."""
    import sympy

    w, A = sympy.symbols("omega A", real=True)
    C, W, V = sympy.symbols("C W V", positive=True)
    body = sympy.log(1 + C**2 * W / (V * (w**2 + A**2)))
    found = sympy.integrate(body, (w, -sympy.oo, sympy.oo))
    raise SystemExit(1 if found.has(sympy.Integral) else 0)


def by_hand(A: Any, C: Any, W: Any, V: Any) -> Any:
    """Return the upper root by the quadratic formula, as one writes it."""
    return V * (A + np.sqrt(A**2 + C**2 * W / V)) / C**2


def _evaluation() -> list[Row]:
    from scipy.linalg import solve_continuous_are

    from derive.scalar.library import formula

    rng = np.random.default_rng(0)
    A, C, W, V = rng.normal(size=POINTS), 1 + rng.random(POINTS), rng.random(POINTS), 1 + rng.random(POINTS)
    ours = formula("care_covariance").to_numpy()
    runs = [(best_of(1, lambda: ours(A, C, W, V)), best_of(1, lambda: by_hand(A, C, W, V))) for _ in range(RUNS)]
    (seconds, found), (hand, expected) = (min(column, key=lambda run: run[0]) for column in zip(*runs, strict=True))
    loop, solved = best_of(3, lambda: [solve_continuous_are(A[i], C[i], W[i], V[i])[0, 0] for i in range(SAMPLE)])
    loop *= POINTS / SAMPLE
    same = np.allclose(found, expected, rtol=1e-6, atol=1e-9) and np.allclose(found[:SAMPLE], solved, rtol=1e-8)
    return [
        Row(
            f"{POINTS:.0e} covariances",
            f"{1e3 * seconds:.0f} ms, a loop of SciPy {loop:.0f} s, {loop / seconds:.0f} times",
            f"{SPEEDUP:.0f} times", bool(same) and loop >= SPEEDUP * seconds,
        ),
        Row(
            "quadratic formula by hand", f"{1e3 * hand:.0f} ms, ours {seconds / hand:.2f} times that",
            f"{SLOWER} times", bool(same) and seconds <= SLOWER * hand,
        ),
    ]  # fmt: skip
