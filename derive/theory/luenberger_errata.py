"""Errata of the lecture notes "Optimal Luenberger Observer", each with an instance computed exactly.

The plants of the instances are scalar; their values are computed when the lecture is built, from the same formulas
that the lecture derives.
"""

from __future__ import annotations

from collections.abc import Mapping
from fractions import Fraction

from derive.derivation import Evidence
from derive.terms import Equation, Expect, Symbol, Term
from derive.theory.builder import Builder
from derive.theory.exact import Real, riccati_roots, value
from derive.theory.luenberger_formulas import any_gain, innovation, optimal_gain, riccati_step

SOURCE = "002"
HALF = Fraction(1, 2)
TRANSIENT = ("P_{k-1}", "Q_{k-1}", "R_{k-1}", "S_{k-1}")


def evidence(b: Builder, values: Mapping[str, Real | int], **results: Real) -> Evidence:
    """Return an instance: the values of its letters, and what each formula gives there."""
    return Evidence(
        tuple((b.theory.symbols[name], str(number)) for name, number in values.items()),
        tuple((text.replace("_", " "), str(number)) for text, number in results.items()),
    )


def _transient(b: Builder) -> tuple[Symbol, ...]:
    return tuple(b.theory.symbols[k] for k in ("A", "C", "L_k", *TRANSIENT))


def sign(b: Builder) -> None:
    """Equation (2), first row: the sign of the process noise."""
    s = b.theory.symbols
    A, C, L, P, Q, R, S = _transient(b)
    e, w, v = s["e_{k-1}"], s["w_{k-1}"], s["v_{k-1}"]
    printed = w + (A - L * C) * e + L * v
    b.say("With the process noise added instead of subtracted, the cross terms would change their sign:")
    step = b.state(
        "opposite sign",
        Equation(Expect(printed * printed.T), "=", any_gain(A, C, L, P, Q, R) + L * S.T + S * L.T),
        "expectation is linear",
        lemma=False,
    )
    at = {"A": 1, "C": 1, "L_k": HALF, "P_{k-1}": 1, "Q_{k-1}": 1, "R_{k-1}": 1, "S_{k-1}": HALF}
    b.erratum(
        SOURCE,
        "2",
        "false",
        Equation(s["e_k"], "=", printed),
        "The error is the estimate minus the state, so the process noise enters with a minus sign. Without a "
        "cross-covariance the slip cancels in the covariance; with one it does not.",
        evidence=(
            evidence(
                b,
                at,
                cross_terms=value(-L * S.T - S * L.T, at),
                cross_terms_as_printed=value(L * S.T + S * L.T, at),
                covariance=value(any_gain(A, C, L, P, Q, R, S), at),
                covariance_as_printed=value(step.statement.rhs, at),
            ),
        ),
        true=b.steps["error recursion"].statement,
        proved_by="error recursion",
    )


def cross_covariance(b: Builder) -> None:
    """Equation (2), second row: it needs uncorrelated noises."""
    A, C, L, P, Q, R, S = _transient(b)
    at = {"A": 1, "C": 1, "L_k": HALF, "P_{k-1}": 1, "Q_{k-1}": 1, "R_{k-1}": 1, "S_{k-1}": HALF}
    b.erratum(
        SOURCE,
        "2",
        "assumption",
        Equation(b.theory.symbols["P_k"], "=", any_gain(A, C, L, P, Q, R)),
        "The recursion needs process and measurement noise of the same time to be uncorrelated, which the source does "
        "not say. In general two cross terms are subtracted.",
        evidence=(
            evidence(
                b,
                at,
                covariance=value(any_gain(A, C, L, P, Q, R, S), at),
                covariance_as_printed=value(any_gain(A, C, L, P, Q, R), at),
            ),
        ),
        true=b.steps["covariance recursion with cross-covariance"].statement,
        proved_by="covariance recursion with cross-covariance",
    )


def index_of_noise(b: Builder) -> None:
    """The covariances Q_{k-1} and R_{k-1} carry the index of their own noise."""
    s = b.theory.symbols
    A, C, L, P, Q, R, _ = _transient(b)
    b.say("The covariances carry the index of the noise that enters:")
    for name, noise, covariance in (("process noise", s["w_{k-1}"], Q), ("measurement noise", s["v_{k-1}"], R)):
        own = Equation(covariance, "=", Expect(noise * noise.T))
        b.state(f"index of the {name}", own, "definition", lemma=False)
    at = {"A": 1, "C": 1, "L_k": HALF, "P_{k-1}": 1, "R_{k-1}": 1}
    first, second = ({**at, "Q_{k-1}": q} for q in (1, 2))
    b.erratum(
        SOURCE,
        "u1",
        "false",
        (Equation(Q, "=", Expect(s["w_k"] * s["w_k"].T)), ", ", Equation(R, "=", Expect(s["v_k"] * s["v_k"].T))),
        "The covariances belong to the noise of their own index; in (2) it is ",
        s["w_{k-1}"],
        " that enters. For noise whose covariance changes with time, here from 1 at the time 0 to 2 at the time 1, the "
        "index as printed gives another ",
        s["P_k"],
        " at k = 1.",
        evidence=(
            evidence(
                b,
                at,
                covariance=value(any_gain(A, C, L, P, Q, R), first),
                covariance_as_printed=value(any_gain(A, C, L, P, Q, R), second),
            ),
        ),
        true=b.steps["index of the process noise"].statement,
        proved_by="index of the process noise",
    )


def stationary_point(b: Builder) -> None:
    """The stationary point: of what, and why it is a minimum."""
    s = b.theory.symbols
    b.erratum(
        SOURCE,
        "3",
        "incomplete",
        ("∂", s["P_k"], "/∂", s["L_k"], " = 0"),
        "A matrix has no stationary point by itself; it is the trace whose gradient vanishes. Completing the square "
        "shows more: the covariance itself is least there, so that the trace, or any other increasing function of the "
        "covariance, is minimised too.",
        true=b.steps["Loewner minimum"].statement,
        proved_by="Loewner minimum",
    )


def gain(b: Builder) -> None:
    """Equation (3): the state matrix is missing."""
    A, C, L, P, Q, R, _ = _transient(b)
    at = {"A": 2, "C": 1, "P_{k-1}": 1, "Q_{k-1}": 1, "R_{k-1}": 1}
    printed = P * C.T * innovation(C, P, R).inv
    results = {
        text: value(any_gain(A, C, L, P, Q, R), {**at, "L_k": value(formula, at)})
        for text, formula in (
            ("covariance_with_the_printed_gain", printed),
            ("covariance_with_the_correct_gain", optimal_gain(A, C, P, R)),
        )
    }
    b.erratum(
        SOURCE,
        "3",
        "false",
        Equation(L, "=", printed),
        "The state matrix ",
        A,
        " is missing: the printed formula is the gain of the filter form, which corrects before it predicts. Put into "
        "(2) it gives a larger covariance than (4).",
        evidence=(evidence(b, at, **results, equation_4=value(riccati_step(A, C, P, Q, R), at)),),
        true=b.steps["gain"].statement,
        proved_by="gain",
    )


def roots(b: Builder) -> None:
    """Equation (5): which of its roots is meant."""
    s = b.theory.symbols
    A, C, P, Q, R = (s[k] for k in ("A", "C", "P", "Q", "R"))
    found: list[Evidence] = []
    for a, c, q in ((2, 1, 0), (1, 1, 0), (2, 0, 1)):
        at: dict[str, Real | int] = {"A": a, "C": c, "Q": q, "R": 1}
        several = list(dict.fromkeys(riccati_roots(a, c, q, 1)))
        for p in several:
            if value(riccati_step(A, C, P, Q, R), {**at, "P": p}) != p:
                raise ValueError(f"{p} is not a root of the Riccati equation at {at}")
        names = ("smaller_root", "larger_root") if len(several) == 2 else ("only_root",)
        results = dict(zip(names, several, strict=True))
        largest: dict[str, Real | int] = {**at, "P": several[-1]}
        closed_loop = value(A - optimal_gain(A, C, P, R) * C, largest)
        found.append(evidence(b, at, **results, error_matrix_at_the_largest_root=closed_loop))
    b.erratum(
        SOURCE,
        "5",
        "incomplete",
        Equation(P, "=", riccati_step(A, C, P, Q, R)),
        "The equation may have several roots, and none that is a covariance. The steady covariance is the stabilising "
        "root, or its limit, the strong root, if noise does not reach a mode on the unit circle. The recursion (4) "
        "reaches it from every positive start; an unstable mode that starts at 0 and gets no noise stays there. For "
        "the last plant, whose output does not see its unstable state, the only root is negative: (A, C) must be "
        "detectable.",
        evidence=found,
        true=b.steps["largest solution"].statement,
        proved_by="largest solution",
    )


def steady_gain(b: Builder) -> None:
    """The gain of the infinite horizon: the state matrix is missing, and the observer may diverge."""
    s = b.theory.symbols
    A, C, L, P, R = (s[k] for k in ("A", "C", "L", "P", "R"))
    at: dict[str, Real | int] = {"A": 2, "C": 1, "Q": 1, "R": 1}
    at["P"] = riccati_roots(2, 1, 1, 1)[-1]
    printed = P * C.T * innovation(C, P, R).inv

    def error_matrix(gain: Term) -> Real:
        return value(A - L * C, {**at, "L": value(gain, at)})

    b.erratum(
        SOURCE,
        "u3",
        "false",
        Equation(L, "=", printed),
        "As in (3) the state matrix is missing. An observer with the printed gain may diverge: here its error grows at "
        "every step by the factor shown.",
        evidence=(
            evidence(
                b,
                at,
                error_matrix_with_the_printed_gain=error_matrix(printed),
                error_matrix_with_the_correct_gain=error_matrix(optimal_gain(A, C, P, R)),
            ),
        ),
        true=b.steps["steady gain"].statement,
        proved_by="steady gain",
    )
