"""The corpus of claims: the checker's verdicts and times, and what SymPy says of the same claims."""

from __future__ import annotations

import inspect
import multiprocessing
import signal
import statistics
import time
from collections import Counter
from collections.abc import Callable, Iterator
from typing import Any

from tests.benchmark.table import Row
from tests.reference.corpus import Entry, entries

DECIDED, MEDIAN, LATE, NEARLY_ALL = 0.97, 0.040, 0.400, 0.95
LIMIT = 5.0  # seconds a claim given to SymPy
TOLD = {True: "proved", False: "refuted"}


def claims() -> list[Row]:
    """Return the verdicts and times of the checker, then those of SymPy on the equalities among the same claims."""
    return [*_ours(), *_peers()]


# ------------------------------------------------------------------------------------------------ ours
def _ours() -> Iterator[Row]:
    import derive
    from derive.claim import Claim

    wrong, decided, seconds = 0, 0, list[float]()
    for entry in entries():
        start = time.perf_counter()
        claim = Claim(entry.latex, entry.theory, entry.assume, entry.scalar, file="corpus")
        verdict = derive.check(claim).results[0].verdict
        seconds.append(time.perf_counter() - start)
        wrong += verdict == TOLD[not entry.truth]
        decided += verdict in TOLD.values()
    yield Row("claims decided wrongly", f"{wrong} of {len(seconds)}", "0", wrong == 0)
    share = decided / len(seconds)
    yield Row("claims decided", f"{decided} of {len(seconds)}, {share:.1%}", f"{DECIDED:.0%}", share >= DECIDED)
    middle, late = statistics.median(seconds), sorted(seconds)[int(NEARLY_ALL * len(seconds))]
    yield Row("seconds a claim, median", f"{1e3 * middle:.0f} ms", f"{1e3 * MEDIAN:.0f} ms", middle <= MEDIAN)
    text = f"{1e3 * late:.0f} ms, longest {max(seconds):.1f} s"
    yield Row("seconds a claim, 95 of 100", text, f"{1e3 * LATE:.0f} ms", late <= LATE)


# ------------------------------------------------------------------------------------------------ SymPy
def _peers() -> Iterator[Row]:
    equalities = [i for i, e in enumerate(entries()) if e.sides is not None and e.relation == "="]
    for name in OPINIONS:
        with multiprocessing.get_context("spawn").Pool(1) as pool:
            found = pool.starmap(ask, [(name, i) for i in equalities])
        kinds = Counter(kind for kind, _ in found)
        told = ", ".join(f"{kinds[kind]} {kind}" for kind in ("right", "wrong", "undecided", "no answer"))
        middle = statistics.median(seconds for _, seconds in found)
        yield Row(f"SymPy's {name}, {len(equalities)} equalities", f"{told}; median {1e3 * middle:.0f} ms", "", ok=True)


def ask(name: str, number: int) -> tuple[str, float]:
    """Return whether SymPy is right on an entry, and how long it took; in a process of its own."""
    entry = list(entries())[number]
    signal.signal(signal.SIGALRM, _stop)
    signal.setitimer(signal.ITIMER_REAL, LIMIT)
    start = time.perf_counter()
    try:
        opinion = OPINIONS[name](*_sides(entry))
    except Exception:  # SymPy raises errors of many kinds on matrix expressions
        return "no answer", time.perf_counter() - start
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0)
    kind = "undecided" if opinion is None else "right" if opinion == entry.truth else "wrong"
    return kind, time.perf_counter() - start


def _stop(*_: Any) -> None:
    raise TimeoutError


def _simplify(left: Any, right: Any) -> bool | None:
    """Return True where simplify(left - right) is zero, False where it is another number."""
    import sympy

    difference = sympy.simplify(left - right)
    if difference.is_zero or difference == 0 or getattr(difference, "is_ZeroMatrix", False):
        return True
    return False if difference.is_number else None


def _equals(left: Any, right: Any) -> bool | None:
    """Return what left.equals(right) says."""
    return left.equals(right)


OPINIONS: dict[str, Callable[[Any, Any], bool | None]] = {"simplify(lhs - rhs)": _simplify, ".equals": _equals}


def _sides(entry: Entry) -> tuple[Any, Any]:
    """Return both sides with SymPy's letters: gains by their definitions, scalar covariances in closed form."""
    assert entry.sides is not None
    letters = _scalars(entry.theory) if entry.scalar else _matrices(entry.theory)
    return entry.sides(**{name: letters[name] for name in inspect.signature(entry.sides).parameters})


def _scalars(theory: str) -> dict[str, Any]:
    import sympy

    A, B, C = sympy.symbols("A B C", real=True, nonzero=True)
    Q, W, Pm = sympy.symbols("Q W Pm", nonnegative=True)
    R, V = sympy.symbols("R V", positive=True)
    if theory == "luenberger-dt":
        part = A**2 * R + C**2 * Q - R
        P = (part + sympy.sqrt(part**2 + 4 * C**2 * Q * R)) / (2 * C**2)
        gain = {"L": A * P * C / (C**2 * P + R), "Lf": P * C / (C**2 * P + R), "Lk": A * Pm * C / (C**2 * Pm + R)}
        after = {"Pp": P * R / (C**2 * P + R), "Pk": A**2 * R * Pm / (C**2 * Pm + R) + Q}
        return {"A": A, "C": C, "Q": Q, "R": R, "Pm": Pm, "P": P, **gain, **after}
    if theory == "kalman-bucy":
        P = (A * V + sympy.sqrt(A**2 * V**2 + C**2 * V * W)) / C**2
        return {"A": A, "C": C, "W": W, "V": V, "P": P, "K": P * C / V}
    if theory == "lqr-ct":
        S = (A * R + sympy.sqrt(A**2 * R**2 + B**2 * Q * R)) / B**2
        return {"A": A, "B": B, "Q": Q, "R": R, "S": S, "K": B * S / R}
    part = A**2 * R + B**2 * Q - R
    S = (part + sympy.sqrt(part**2 + 4 * B**2 * Q * R)) / (2 * B**2)
    return {"A": A, "B": B, "Q": Q, "R": R, "S": S, "K": A * B * S / (B**2 * S + R)}


def _matrices(theory: str) -> dict[str, Any]:
    import sympy

    n, l, p = sympy.symbols("n l p", integer=True, positive=True)  # noqa: E741
    square = {name: sympy.MatrixSymbol(name, n, n) for name in ("A", "Q", "W", "P", "Pm", "S")}
    A, P, Pm, S = (square[name] for name in ("A", "P", "Pm", "S"))
    B, C = sympy.MatrixSymbol("B", n, p), sympy.MatrixSymbol("C", l, n)
    size = p if theory.startswith("lqr") else l
    R, V = sympy.MatrixSymbol("R", size, size), sympy.MatrixSymbol("V", l, l)
    letters = {**square, "B": B, "C": C, "R": R, "V": V, "I": sympy.Identity(n), "E": sympy.Identity(size)}
    if theory == "kalman-bucy":
        return {**letters, "K": P * C.T * V.inverse()}
    if theory == "lqr-ct":
        return {**letters, "K": R.inverse() * B.T * S}
    if theory == "lqr-dt":
        return {**letters, "K": (B.T * S * B + R).inverse() * B.T * S * A}
    Lf = P * C.T * (C * P * C.T + R).inverse()
    Lk = A * Pm * C.T * (C * Pm * C.T + R).inverse()
    Pk = A * Pm * A.T + letters["Q"] - Lk * C * Pm * A.T
    L = sympy.MatrixSymbol("L", n, l) if theory == "observer-ct" else A * Lf
    return {**letters, "L": L, "Lf": Lf, "Lk": Lk, "Pk": Pk, "Pp": P - Lf * C * P}
