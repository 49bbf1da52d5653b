"""Claims of the frequency domain: theorems prove, exact plants refute, and what is evaluated agrees with quadrature."""

from __future__ import annotations

import json
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy.integrate import quad

from derive.check.item import Item, Setting
from derive.check.judge import judge
from derive.claim import Answer, Claim, Verdict
from derive.decide import decide
from derive.decide.spectra.evaluate import Place, value
from derive.decide.spectra.places import places
from derive.decide.spectra.ratio import Fractional, determinant, inverted
from derive.errors import InputError
from derive.interpret import understand
from derive.interpret.statement import Statement
from derive.kernel import Rejected
from derive.latex.grammar import read
from derive.replay import verify_data
from derive.theory.claims import claim_theory

COST = r"\operatorname{tr}(C P C^T V^{-1})"
MEAN = r"\frac{1}{2\pi} \int_{-\infty}^{\infty} \ln \frac{\det \Phi_y(\omega)}{\det V} d\omega"
SUM = r"\sum_{i=1}^{m} \max\{0, \Re[\lambda_i(A)]\}"
LOOP = r"I + C (j\omega I - A)^{-1} K"
BODE = rf"\frac{{1}}{{2\pi}} \int_{{-\infty}}^{{\infty}} \ln |\det[{LOOP}]| d\omega"
STABLE = (r"\Re[\lambda_i(A)] < 0",)
QUIET = ("W = 0",)


def statement(latex: str, assume: tuple[str, ...] = (), scalar: bool = False) -> Statement:
    return understand(read(latex), claim_theory("kalman-bucy"), assume=[read(a) for a in assume], scalar=scalar)


def answer(latex: str, assume: tuple[str, ...] = (), scalar: bool = False) -> Answer:
    return decide(statement(latex, assume, scalar))


PROVED = [
    (f"{COST} = {MEAN} + 2 {SUM}", ()),
    (f"{MEAN} = {COST} - 2 {SUM}", ()),
    (f"2 {SUM} = {COST} - {MEAN}", ()),
    (rf"\operatorname{{tr}}(K C) = {MEAN} + 2 {SUM}", ()),
    (rf"\operatorname{{tr}}(V^{{-1}} C P C^T) = {MEAN} + 2 {SUM}", ()),
    (f"{COST} = {MEAN}", STABLE),
    (f"{COST} = 2 {SUM}", QUIET),
    (f"{BODE} = \\frac12 {COST} - {SUM}", ()),
    (f"2 {BODE} = {MEAN}", ()),
    (rf"\operatorname{{tr}}(A - K C) = \operatorname{{tr}} A - {MEAN} - 2 {SUM}", ()),
    (r"\sum_{i=1}^{m} \Re[\lambda_i(A)] = \operatorname{tr} A", ()),
    (rf"\sum_{{i=1}}^{{m}} |\Re[\lambda_i(A)]| = 2 {SUM} - \operatorname{{tr}} A", ()),
    (r"\lim_{s \to \infty} s \operatorname{tr}(C (s I - A)^{-1} K) = \operatorname{tr}(C P C^T V^{-1})", ()),
    (f"{COST} \\ge {MEAN}", ()),
]
REFUTED = [
    (f"{COST} = {MEAN}", ()),
    (f"{COST} = {MEAN} + {SUM}", ()),
    (f"{COST} = {MEAN} - 2 {SUM}", ()),
    (f"{COST} = 2 {MEAN} + 2 {SUM}", ()),
    (f"{COST} = {MEAN.replace('2', '', 1)} + 2 {SUM}", ()),
    (rf"\operatorname{{tr}}(C P C^T) = {MEAN} + 2 {SUM}", ()),
    (rf"\operatorname{{tr}}(P) = {MEAN} + 2 {SUM}", ()),
    (rf"{COST} = {MEAN.replace('det V', 'det W')} + 2 {SUM}", ()),
    (rf"{COST} = {MEAN} + 2 \sum_{{i=1}}^{{m}} \Re[\lambda_i(A)]", ()),
    (rf"{COST} = {MEAN} + 2 \sum_{{i=1}}^{{m}} |\Re[\lambda_i(A)]|", ()),
    (f"{COST} = 2 {SUM}", ()),
    (f"{BODE} = \\frac12 {COST} + {SUM}", ()),
    (f"{BODE} = {COST} - {SUM}", ()),
    (f"{BODE.replace('+ C', '- C')} = \\frac12 {COST} - {SUM}", ()),
    (f"{BODE} = - \\frac12 {COST} + {SUM}", ()),
    (r"\sum_{i=1}^{m} |\Re[\lambda_i(A)]| = \operatorname{tr} A", ()),
    (r"\lim_{s \to \infty} s \operatorname{tr}(C (s I - A)^{-1} K) = 0", ()),
    (r"\lim_{s \to \infty} \frac12 s \operatorname{tr}(C (s I - A)^{-1} K) = \operatorname{tr}(C P C^T V^{-1})", ()),
    (f"{MEAN} \\ge {COST}", ()),
    (f"{SUM} \\ge {COST}", ()),
    (f"{COST} = {MEAN} + 2 {SUM} + 1", ()),
]  # fmt: skip


@pytest.mark.parametrize(("latex", "assume"), PROVED)
def test_theorems_prove(latex: str, assume: tuple[str, ...]) -> None:
    found = answer(latex, assume)
    assert found.verdict is Verdict.proved, found.notes
    assert found.certificate is not None


@pytest.mark.parametrize(("latex", "assume"), REFUTED)
def test_near_misses_are_refuted_at_a_plant(latex: str, assume: tuple[str, ...]) -> None:
    found = answer(latex, assume)
    assert found.verdict is Verdict.refuted
    assert found.counterexample is not None
    assert "A" in found.counterexample.values


def test_the_nearest_formula_is_proved_and_named() -> None:
    found = answer(f"{COST} = {MEAN} - 2 {SUM}")
    assert found.nearest is not None
    assert found.nearest.edit == "the sign of one term"
    assert answer(found.nearest.latex).verdict is Verdict.proved


def test_a_one_sided_integral_is_explained() -> None:
    found = answer(f"{COST} = {MEAN.replace('2', '', 1)} + 2 {SUM}")
    assert found.nearest is not None
    assert found.nearest.edit == "a factor 1/2 of one term"
    assert any("two-sided" in note for note in found.notes)


def test_a_vanishing_eigenvalue_makes_a_bound_undefined() -> None:
    bound = rf"\operatorname{{tr}} P \ge \frac{{1}}{{\overline{{\lambda}}(C^T V^{{-1}} C)}} {COST}"
    found = answer(bound)
    assert (found.verdict, found.method) == (Verdict.refuted, "undefined")
    assert "C = 0" in str(found.counterexample)
    assert answer(bound, (r"C \neq 0",)).verdict is Verdict.proved


def test_what_only_balls_show_is_supported() -> None:
    found = answer(f"{COST} \\ge 2 {SUM}")
    assert (found.verdict, found.method) == (Verdict.supported, "enclosures")
    assert "at 80 plants" in found.notes[0]


def test_a_function_that_is_not_given_is_asked_for() -> None:
    """Zeros and poles of what? The sources say so in words."""
    claim = r"\sum_{i=1}^{m} \max\{0, \Re[\varphi_i]\} = 0"
    found = answer(claim)
    assert found.verdict is Verdict.undecided
    assert "f(s)" in found.notes[0]
    assert answer(claim, (r"f(s) = \det[\Phi_y(s) V^{-1}]",)).verdict is Verdict.refuted


def test_assumptions_that_no_plant_satisfies_prove_nothing() -> None:
    found = answer(f"{COST} = {MEAN} + 2 {SUM}", (r"\Re[\lambda_i(A)] < 0", r"\Re[\lambda_i(A)] > 0"))
    assert found.verdict is Verdict.undecided


# ------------------------------------------------------------------------------------------------ values
def _place(latex: str) -> tuple[Place, Any]:
    found = statement(latex)
    return next(p for p in places(found) if p.sizes["m"] == 2), found.equations[0]


@pytest.mark.parametrize("number", range(6))
def test_integrals_agree_with_quadrature(number: int) -> None:
    found = statement(f"{MEAN} = 0")
    candidates = [p for p in places(found) if p.letters["W"].rank() or number == 0]
    place = candidates[number * len(candidates) // 6]
    A, C, W, V = (
        np.array([[float(x.p) / float(x.q) for x in row] for row in place.letters[k].tolist()]) for k in "ACWV"
    )

    def integrand(w: float) -> float:
        F = np.linalg.inv(1j * w * np.eye(len(A)) - A)
        return float(np.log((np.linalg.det(C @ F @ W @ F.conj().T @ C.T + V) / np.linalg.det(V)).real))

    parts = [(0, 1), (1, 10), (10, np.inf)]
    wanted = sum(quad(integrand, a, b, epsabs=1e-10, limit=400)[0] for a, b in parts) / np.pi
    ball = value(found.equations[0].lhs, place)
    assert float(ball.real.mid() if hasattr(ball, "real") else ball.mid()) == pytest.approx(wanted, abs=2e-6)


def test_poissons_integral_agrees_with_quadrature() -> None:
    given = (
        r"f(s) = \frac{p(s)}{q(s)}",
        r"\lim_{s \to \infty} f(s) = 1",
        r"s_0 = \sigma_0 + j \omega_0",
        r"\sigma_0 > 0",
    )
    kernel = r"\frac{\sigma_0}{\sigma_0^2 + (\omega - \omega_0)^2}"
    latex = rf"\frac{{1}}{{\pi}} \int_{{-\infty}}^{{\infty}} {kernel} \ln|f(j\omega)| d\omega = 0"
    found = statement(latex, given)
    place = next(p for p in places(found) if all(not z.real.contains(0) for z in p.families["φ"] + p.families["η"]))
    f, numbers = place.functions["f"], place.numbers
    s0, w0 = (float(numbers[k].number()) if isinstance(numbers[k], Fractional) else 0.0 for k in ("σ0", "ω0"))
    top, bottom = ([float(c.p) / float(c.q) for c in p.coeffs()] for p in (f.re, f.den))

    def integrand(w: float) -> float:
        s = 1j * w
        ratio = np.polynomial.polynomial.polyval(s, top) / np.polynomial.polynomial.polyval(s, bottom)
        return s0 / (s0**2 + (w - w0) ** 2) * float(np.log(abs(ratio)))

    cuts = [-np.inf, -10, -1, 0, 1, 10, np.inf]
    wanted = sum(quad(integrand, a, b, limit=400)[0] for a, b in pairwise(cuts)) / np.pi
    assert float(value(found.equations[0].lhs, place).mid()) == pytest.approx(wanted, abs=1e-7)


def test_rational_functions() -> None:
    from flint import fmpq_poly

    def function(*coefficients: int) -> Fractional:
        return Fractional.make(fmpq_poly(list(coefficients)), fmpq_poly(), fmpq_poly([1]))

    matrix = [[function(1, 1), function(2)], [function(0, 1), function(3, 0, 1)]]
    product = [
        [
            sum((a * b for a, b in zip(row, column, strict=True)), function(0))
            for column in zip(*inverted(matrix), strict=True)
        ]
        for row in matrix
    ]
    assert product == [[function(1), function(0)], [function(0), function(1)]]
    assert determinant(matrix) == function(1, 1) * function(3, 0, 1) - function(2) * function(0, 1)


# ------------------------------------------------------------------------------------------------ certificates
def _certificate() -> dict[str, Any]:
    claim = Claim(f"{COST} = {MEAN} + 2 {SUM}", "kalman-bucy")
    result = judge(Item(claim, Setting(theory="kalman-bucy")))
    assert result is not None
    assert result.answer is not None
    assert result.answer.certificate is not None
    return json.loads(json.dumps(result.answer.certificate))


def test_a_certificate_replays_and_a_changed_one_does_not(tmp_path: Path) -> None:
    data = _certificate()
    assert verify_data(data, "x").accepted
    changes = [
        {"latex": f"{COST} = {MEAN} + {SUM}"},
        {"latex": f"{COST} = {MEAN}"},
        {"relations": ["theorem 2"]},
        {"relations": []},
        {"theory": "luenberger-dt"},
        {"scalar": True},
        {"lecture": "scalar"},
        {"rule": "identity"},
        {"symbols": []},
    ]
    for change in changes:
        try:
            accepted = verify_data({**data, **change}, "x").accepted
        except (InputError, Rejected):
            accepted = False
        assert not accepted, change
