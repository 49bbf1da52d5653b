"""The discrete spectrum: its factors at a plant, and Jensen's formula on the circle against quadrature."""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise
from math import log, pi

import numpy as np
import pytest
from scipy.integrate import quad
from scipy.linalg import solve_discrete_are

from derive.derivation import Step, check, claims, learn
from derive.functions import Max
from derive.kernel import Rejected
from derive.spectral import ImaginaryPart, RealPart
from derive.terms import Equation, Reading
from derive.theory import spectrum, spectrum_circle
from derive.theory.spectrum_circle import excess
from tests.derive.theory.mutants import mutants
from tests.derive.theory.test_spectrum_poisson import number, same, swap

A = np.array([[1.6, 0.7, 0.0], [-0.9, 1.1, 0.2], [0.0, 0.0, -0.4]])  # a pair outside the circle, one inside
C = np.array([[1.0, 0.0, 0.3], [0.0, 0.4, 1.0]])
Q, R = np.diag([0.5, 0.1, 0.2]), np.array([[0.3, 0.1], [0.1, 0.4]])
EIGENVALUES = (0.3 + 0.4j, 1.6 + 0.7j, -2 + 0j, 0j, 1 + 0j, 0.6 + 0.8j, -0.999 + 0j, 1j)
NAMES = ("discrete factorisation", "determinant d", "discrete spectrum and loops", "positive parts", "circle lemma")


def predictor():
    P = solve_discrete_are(A.T, C.T, Q, R)
    S = C @ P @ C.T + R
    return P, S, A @ P @ C.T @ np.linalg.inv(S)


def spectrum_at(z: complex) -> np.ndarray:
    F, N = np.linalg.inv(z * np.eye(3) - A), np.linalg.inv(np.eye(3) / z - A)
    return C @ F @ Q @ N.T @ C.T + R


@pytest.mark.parametrize("z", [0.3 + 1.1j, -2.0 + 0.1j, np.exp(0.7j)])
def test_the_factors_at_a_plant(z):
    _, S, K = predictor()
    F, N = np.linalg.inv(z * np.eye(3) - A), z * np.linalg.inv(np.eye(3) - z * A)
    product = (np.eye(2) + C @ F @ K) @ S @ (np.eye(2) + C @ N @ K).T
    assert spectrum_at(z) == pytest.approx(product, abs=1e-9)
    loops = [np.linalg.det(z * np.eye(3) - M) * np.linalg.det(np.eye(3) - z * M) for M in (A, A - K @ C)]
    assert np.linalg.det(spectrum_at(z)) * loops[0] == pytest.approx(np.linalg.det(S) * loops[1])


def test_what_follows_for_the_innovation_covariance():
    """ln det(CPC' + R) = (1/2π) ∫ ln det Φ dθ + 2 Σ max(0, ln|λ|): each factor by Jensen's formula."""
    _, S, K = predictor()
    mean = quad(lambda a: log(np.linalg.det(spectrum_at(np.exp(1j * a))).real), -pi, pi, limit=300)[0] / (2 * pi)
    outside = sum(max(0.0, log(abs(x))) for x in np.linalg.eigvals(A))
    assert outside > 0.5
    assert max(abs(np.linalg.eigvals(A - K @ C))) < 1
    assert log(np.linalg.det(S)) == pytest.approx(mean + 2 * outside)


@pytest.mark.parametrize("root", EIGENVALUES)
def test_the_circle_lemma_holds_by_quadrature(root):
    statement = spectrum_circle.lecture().step("circle lemma").statement
    at, roots = {"π": pi, "σ0": 1.0, "ω0": 0.0}, {"λ": np.array([root])}
    right = number(statement.rhs, at, roots)
    assert right == pytest.approx(4 * pi * max(0.0, log(max(abs(root), 1e-300))), abs=1e-12)
    assert number(statement.lhs, at, roots) == pytest.approx(right, abs=1e-4)
    points = sorted({float(np.angle(root)), -float(np.angle(root))})
    angle = lambda a: log(abs(np.exp(1j * a) - root) ** 2)  # noqa: E731
    ends = [-pi, *(p for p in points if abs(p) < pi), pi]
    parts = [quad(angle, a + 1e-13, b - 1e-13, limit=300)[0] for a, b in pairwise(ends)]
    assert sum(parts) == pytest.approx(right, abs=1e-4)


def reads_the_same(statement: Equation, step: Step, reading: Reading) -> bool:
    if step.rule == "identity":
        try:
            return claims(statement, "identity", reading) == claims(step.statement, "identity", reading)
        except Rejected:
            return False
    return same(statement, step.statement, reading)


def test_every_step_of_the_circle_replays():
    outcomes = spectrum_circle.lecture().verify()
    assert [o for o in outcomes if not o.accepted] == []
    assert len(outcomes) > 100


@pytest.mark.parametrize("part", [spectrum, spectrum_circle])
def test_mutated_statements_are_rejected(part):
    item, earlier, tried = part.lecture(), {}, 0
    reading = item.theory.reading()
    for step in item.steps:
        if step.name in NAMES:
            for side in ("lhs", "rhs"):
                for other in mutants(getattr(step.statement, side)):
                    statement = replace(step.statement, **{side: other})
                    if reads_the_same(statement, step, reading):
                        continue
                    tried += 1
                    with pytest.raises(Rejected):
                        check(replace(step, statement=statement), reading, earlier)
        if step.name == "circle lemma":
            t = item.theory
            root = t.symbols["λ"]
            for wrong in (
                2 * step.statement.rhs, swap(step.statement.rhs, Max(excess(t)), excess(t)),
                swap(step.statement.rhs, RealPart(root), ImaginaryPart(root)),
            ):  # fmt: skip
                with pytest.raises(Rejected):
                    check(replace(step, statement=Equation(step.statement.lhs, "=", wrong)), reading, earlier)
        earlier[step.name] = step
        reading = learn(reading, item.theory, step)
    assert tried > 20


def test_what_the_circle_lemma_rests_on():
    needed = spectrum_circle.lecture().rests_on("circle lemma")
    assert {"σ0 = 1", "ω0 = 0", "no eigenvalue at -1"} <= needed
    assert not {"poles are stable", "strong solution"} & needed
