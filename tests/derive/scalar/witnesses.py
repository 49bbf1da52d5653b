"""Numbers that satisfy the cases of plants of order two and three, so that their steps can be tried at random points.

A case maps scalars to functions of a point, which is asked for other scalars by ``p(name)``.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

Value = Callable[[Callable[[str], float]], float]
POSITIVE = frozenset(("c0", "w1", "w2", "w3", "cubic c0", "cubic a2"))
PAIRS = ("11", "12", "22")
TRIPLES = ("11", "12", "13", "22", "23", "33")


def _root(a0: str, a1: str) -> dict[str, Value]:
    def root(p) -> complex:
        return np.roots([1, p(a1), p(a0)])[0]

    return {"α": lambda p: root(p).real, "β": lambda p: root(p).imag}


def _root_of_third() -> dict[str, Value]:
    def root(p) -> complex:
        return np.roots([1, p("cubic a2"), p("cubic a1"), p("cubic a0")])[0]

    return {"α": lambda p: root(p).real, "β": lambda p: root(p).imag}


def _least_root(p) -> float:
    c4 = p("cubic c4")
    roots = np.roots([1, 0, -2 * c4, -8 * p("cubic a0"), c4**2 - 4 * p("cubic c2")])
    return min(roots[abs(roots.imag) < 1e-9].real)


C4: dict[str, Value] = {"cubic c4": lambda p: p("cubic a2") ** 2 - 2 * p("cubic a1")}
C2: dict[str, Value] = {"cubic c2": lambda p: p("cubic a1") ** 2 - 2 * p("cubic a0") * p("cubic a2")}
HURWITZ: dict[str, Value] = {"cubic a1": lambda p: p("cubic a0") / p("cubic a2") + 0.3}
SECOND: dict[str, Value] = {f"X{k}": lambda p, k=k: p(f"P{k}") for k in PAIRS}
THIRD: dict[str, Value] = {f"cubic X{k}": lambda p, k=k: p(f"cubic P{k}") for k in TRIPLES}
NOISE: dict[str, Value] = {
    "w1": lambda p: p("V") * (p("cubic c4") - p("cubic b2") ** 2 + 2 * p("cubic b1")),
    "w2": lambda p: (
        p("V") * (p("cubic c2") - p("cubic b1") ** 2 + 2 * p("cubic b0") * p("cubic b2"))
        - p("w1") * (p("cubic b2") ** 2 - 2 * p("cubic b1"))
    ),
    "w3": lambda p: (
        p("V") * (p("cubic c0") - p("cubic b0") ** 2) - p("w1") * p("cubic b1") ** 2 - p("w2") * p("cubic b2") ** 2
    ),
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
    "cubic a2^2 - 2 a1 = c4": C4,
    "cubic a1^2 - 2 a0 a2 = c2": C2,
    "cubic a2 a1 > a0": HURWITZ,
    "cubic real part": _root_of_third(),
    "cubic root of the quartic": {"cubic y": _least_root},
    **{f"cubic plant c{i}": {**HURWITZ, **C4, **C2, **NOISE} for i in (0, 2, 4)},
    **{f"cubic Riccati equation {k} of X": {**HURWITZ, **C4, **C2, **NOISE, **THIRD} for k in TRIPLES},
    "cubic x0 > 0": {**HURWITZ, **THIRD},
}


def assigned(cases) -> dict[str, Value]:
    """Return how scalars are chosen so that the cases hold."""
    chosen: dict[str, Value] = {}
    for case in sorted(cases):
        chosen |= WITNESSES.get(case, {})
    return chosen
