"""Numbers that satisfy the cases of plants of order two and three, so that their steps can be tried at random points.

A case maps scalars to functions of a point, which is asked for other scalars by ``p(name)``.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

Value = Callable[[Callable[[str], float]], float]
POSITIVE = frozenset(("c0", "w1", "w2", "w3", "c0 (3)", "a2 (3)", "r (3)"))
PAIRS = ("11", "12", "22")
TRIPLES = ("11", "12", "13", "22", "23", "33")


def _root(a0: str, a1: str) -> dict[str, Value]:
    def root(p) -> complex:
        return np.roots([1, p(a1), p(a0)])[0]

    return {"α": lambda p: root(p).real, "β": lambda p: root(p).imag}


def _root_of_third() -> dict[str, Value]:
    def root(p) -> complex:
        return np.roots([1, p("a2 (3)"), p("a1 (3)"), p("a0 (3)")])[0]

    return {"α": lambda p: root(p).real, "β": lambda p: root(p).imag}


def _least_root(p) -> float:
    c4 = p("c4 (3)")
    roots = np.roots([1, 0, -2 * c4, -8 * p("a0 (3)"), c4**2 - 4 * p("c2 (3)")])
    return min(roots[abs(roots.imag) < 1e-9].real)


C4: dict[str, Value] = {"c4 (3)": lambda p: p("a2 (3)") ** 2 - 2 * p("a1 (3)")}
C2: dict[str, Value] = {"c2 (3)": lambda p: p("a1 (3)") ** 2 - 2 * p("a0 (3)") * p("a2 (3)")}
HURWITZ: dict[str, Value] = {"a1 (3)": lambda p: p("a0 (3)") / p("a2 (3)") + 0.3}
SECOND: dict[str, Value] = {f"X{k}": lambda p, k=k: p(f"P{k}") for k in PAIRS}
THIRD: dict[str, Value] = {f"X{k} (3)": lambda p, k=k: p(f"P{k} (3)") for k in TRIPLES}
NOISE: dict[str, Value] = {
    "w1": lambda p: p("V") * (p("c4 (3)") - p("b2 (3)") ** 2 + 2 * p("b1 (3)")),
    "w2": lambda p: (
        p("V") * (p("c2 (3)") - p("b1 (3)") ** 2 + 2 * p("b0 (3)") * p("b2 (3)"))
        - p("w1") * (p("b2 (3)") ** 2 - 2 * p("b1 (3)"))
    ),
    "w3": lambda p: p("V") * (p("c0 (3)") - p("b0 (3)") ** 2) - p("w1") * p("b1 (3)") ** 2 - p("w2") * p("b2 (3)") ** 2,
}
BUTTERWORTH: dict[str, Value] = {
    "c0 (3)": lambda p: p("r (3)") ** 6,
    "a1 (3)": lambda p: 2 * p("r (3)") ** 2,
    "a2 (3)": lambda p: 2 * p("r (3)"),
}


def _zero(name: str) -> dict[str, Value]:
    return {name: lambda _: 0.0}


WITNESSES: dict[str, dict[str, Value]] = {
    "x0^2 = c0": {"x0": lambda p: p("a0")},
    "x1^2 - 2 x0 = c2": {"x0": lambda p: p("a0"), "x1": lambda p: p("a1")},
    "real part, factor": _root("a0", "a1"),
    "real part, closed loop": _root("f0", "f1"),
    **{f"Riccati equation {k} of X": SECOND for k in PAIRS},
    "X leaves a0 >= 0": SECOND,
    "b0 = 0": _zero("b0"),
    "b1 = 0": _zero("b1"),
    "w1 = 0": _zero("w1"),
    "w2 = 0": _zero("w2"),
    "b0 = ω0^2": {"b0": lambda p: p("ω0") ** 2},
    "b1 = 2 ζ ω0": {"b1": lambda p: 2 * p("ζ") * p("ω0")},
    "a2^2 - 2 a1 = c4 (3)": C4,
    "a1^2 - 2 a0 a2 = c2 (3)": C2,
    "a2 a1 > a0 (3)": HURWITZ,
    "real part (3)": _root_of_third(),
    "root of the quartic (3)": {"y (3)": _least_root},
    **{f"plant c{i} (3)": {**HURWITZ, **C4, **C2, **NOISE} for i in (0, 2, 4)},
    **{f"Riccati equation {k} of X (3)": {**HURWITZ, **C4, **C2, **NOISE, **THIRD} for k in TRIPLES},
    "x0 > 0 (3)": {**HURWITZ, **THIRD},
    **{f"b{i} (3) = 0": _zero(f"b{i} (3)") for i in (0, 1, 2)},
    "W3 = V r^6 (3)": {**NOISE, **BUTTERWORTH, **_zero("w1"), **_zero("w2")},
}
LAST = ("W3 = V r^6 (3)", "a2 > 0 (3)")  # what a later case says holds


def assigned(cases) -> dict[str, Value]:
    """Return how scalars are chosen so that the cases hold."""
    chosen: dict[str, Value] = {}
    for case in sorted(cases, key=lambda c: (c in LAST, c)):
        chosen |= WITNESSES.get(case, {})
    return chosen
