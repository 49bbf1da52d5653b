"""Steady states: covariance, gain and closed loop of the filter, with common noise, and of the regulator."""

from __future__ import annotations

from fractions import Fraction

from derive.functions import Power, Quotient, Root
from derive.scalar.formula import Formula
from derive.scalar.letters import NOTHING, compare, scalar_lecture, symbols
from derive.scalar.program import Branch, Let, Program
from derive.terms import Equation, Number, Symbol, Term

__all__ = ["FORMULAS"]

ONE, HALF = Number(Fraction(1)), Number(Fraction(1, 2))
Forms = tuple[tuple[Term, str], tuple[Term, str], tuple[Term, str]]  # body and step where it grows, decays, is double


def _made(name: str, statement: Equation, defined: str, step: str, roles: tuple[str, ...], arguments: str,
          lets: tuple[Let, ...], branches: tuple[Branch, ...], source: str = "") -> Formula:  # fmt: skip
    program = Program(name, symbols(arguments), lets, branches)
    return Formula(name, statement, defined, step, roles, program, scalar_lecture, source=source)


def _three(rises: Term, root: Term, noise: Term, C: Term, forms: Forms) -> tuple[Branch, ...]:
    """Return the branches of an upper root: two forms of which one does not cancel, and the double root."""
    (large, first), (small, second), (double, third) = forms
    return (
        Branch((compare(rises, ">"), compare(C, "≠")), large, first),
        Branch((compare(root, ">", rises),), small, second),
        Branch((compare(noise, "="), compare(C, "≠")), double, third),
    )


# ------------------------------------------------------------------------------------------------ continuous time
EXISTS = "V > 0, W >= 0, C ≠ 0; where C = 0 the state must be stable"


def _root() -> Let:
    A, C, W, V, S = symbols("A C W V S")
    return Let(S, Root(Power(A, 2) + Quotient(Power(C, 2) * W, V)))


def care_covariance() -> Formula:
    """P = V (A + sqrt(A^2 + C^2 W/V))/C^2."""
    A, C, W, V, S, P = symbols("A C W V S P")
    forms = (
        (Quotient(V * (A + S), Power(C, 2)), "P from its definition"), (Quotient(W, S - A), "same covariance"),
        (NOTHING, "double root"),
    )  # fmt: skip
    roles = ("Riccati equation", "closed loop", "P >= 0", "P- <= 0", "same covariance", "unseen")
    return _made(
        "care_covariance", Equation(P, "=", Quotient(V * (A + _root().body), Power(C, 2))), EXISTS,
        "P from its definition", roles, "A C W V", (_root(),), _three(A, S, W, C, forms), "001 (31)",
    )  # fmt: skip


def care_gain() -> Formula:
    """K = (A + sqrt(A^2 + C^2 W/V))/C."""
    A, C, W, V, S, K = symbols("A C W V S K")
    forms = (
        (Quotient(A + S, C), "gain in closed form"), (Quotient(W * C, V * (S - A)), "gain without a division by C"),
        (NOTHING, "double root, gain"),
    )  # fmt: skip
    return _made(
        "care_gain", Equation(K, "=", Quotient(A + _root().body, C)), EXISTS, "gain in closed form", ("closed loop",),
        "A C W V", (_root(),), _three(A, S, W, C, forms),
    )  # fmt: skip


def care_closed_loop() -> Formula:
    """A - K C = -sqrt(A^2 + C^2 W/V)."""
    A, C, S, K = symbols("A C S K")
    branches = (
        Branch((compare(C, "≠"),), -S, "closed loop"),
        Branch((compare(S, ">", A),), -S, "closed loop without a division by C"),
    )
    return _made(
        "care_closed_loop", Equation(A - K * C, "=", -_root().body), EXISTS, "closed loop",
        ("closed loop without a division by C", "other closed loop"), "A C W V", (_root(),), branches,
    )  # fmt: skip


# ------------------------------------------------------------------------------------------------ common noise
COMMON = "V > 0, N^2 <= V W, C ≠ 0; where C = 0 the state must be stable"


def _common() -> tuple[Let, ...]:
    A, C, W, V, N, F, q, S = symbols("A C W V N F q S_N")
    return (
        Let(F, Quotient(A * V - N * C, V)), Let(q, Quotient(V * W - Power(N, 2), V)),
        Let(S, Root(Power(F, 2) + Quotient(Power(C, 2) * q, V))),
    )  # fmt: skip


def care_cross_covariance() -> Formula:
    """P = V (F + sqrt(F^2 + C^2 q/V))/C^2 with F = A - N C/V, q = W - N^2/V."""
    C, V, F, q, S, P = symbols("C V F q S_N P_N")
    large, tail = Quotient(V * (F + S), Power(C, 2)), " with common noise"
    forms = (
        (large, "P_N from its definition"), (Quotient(q, S - F), "same covariance" + tail),
        (NOTHING, "double root" + tail),
    )  # fmt: skip
    roles = ("Riccati equation" + tail, "closed loop" + tail, "P_N >= 0", "S_N >= 0")
    return _made(
        "care_cross_covariance", Equation(P, "=", large), COMMON, "P_N from its definition", roles, "A C W V N",
        _common(), _three(F, S, q, C, forms),
    )  # fmt: skip


def care_cross_gain() -> Formula:
    """K = (P C + N)/V = (A + sqrt(F^2 + C^2 q/V))/C."""
    A, C, V, N, F, q, S, K = symbols("A C V N F q S_N K_N")
    tail = " with common noise"
    forms = (
        (Quotient(F + S, C) + Quotient(N, V), "gain" + tail),
        (Quotient(Quotient(q * C, S - F) + N, V), "same gain" + tail), (Quotient(N, V), f"double root{tail}, gain"),
    )  # fmt: skip
    return _made(
        "care_cross_gain", Equation(K, "=", Quotient(A + S, C)), COMMON, "gain" + tail, ("closed loop" + tail,),
        "A C W V N", _common(), _three(F, S, q, C, forms),
    )  # fmt: skip


# ------------------------------------------------------------------------------------------------ discrete time
EXISTS_D = "R > 0, Q >= 0, C ≠ 0; where C = 0 the state must be stable"


def _lets(letters: str, A: Term, C: Term, Q: Term, R: Term) -> tuple[Let, ...]:
    """Return b, T and, if there is a letter for it, the innovation covariance."""
    b, T, *lam = symbols(letters)
    beta = (A - ONE) * (A + ONE) * R + Power(C, 2) * Q
    lets = (Let(b, beta), Let(T, Root(Power(b, 2) + 4 * Power(C, 2) * Q * R)))
    return (*lets, *(Let(x, _innovation(A, C, Q, R, T)) for x in lam))


def _innovation(A: Term, C: Term, Q: Term, R: Term, T: Term) -> Term:
    return HALF * (Power(A, 2) * R + Power(C, 2) * Q + R + T)


def _roots(b: Symbol, T: Symbol, C: Term, Q: Term, R: Term) -> tuple[Term, Term]:
    return Quotient(b + T, 2 * Power(C, 2)), Quotient(2 * Q * R, T - b)


def dare_covariance() -> Formula:
    """M = (b + T)/(2 C^2) with b = A^2 R + C^2 Q - R, T = sqrt(b^2 + 4 C^2 Q R)."""
    A, C, Q, R, b, T, M = symbols("A C Q R b T M")
    large, small = _roots(b, T, C, Q, R)
    forms = (
        (large, "M from its definition"), (small, "same discrete covariance"), (NOTHING, "double root on the circle")
    )  # fmt: skip
    roles = ("discrete Riccati equation", "discrete closed loop", "inside the circle", "both innovation covariances")
    return _made(
        "dare_covariance", Equation(M, "=", large), EXISTS_D, "M from its definition", roles, "A C Q R",
        _lets("b T", A, C, Q, R), _three(b, T, Q, C, forms), "002 (5)",
    )  # fmt: skip


def dare_filtered_covariance() -> Formula:
    """P+ = M R/(C^2 M + R)."""
    A, C, Q, R, b, T, M, lam, plus = symbols("A C Q R b T M λ M+")
    large, small = _roots(b, T, C, Q, R)
    forms = (
        (Quotient(large * R, lam), "filtered covariance in closed form"),
        (Quotient(small * R, lam), "filtered covariance without a division by C"), (NOTHING, "filtered double root"),
    )  # fmt: skip
    return _made(
        "dare_filtered_covariance", Equation(plus, "=", Quotient(M * R, Power(C, 2) * M + R)), EXISTS_D,
        "filtered covariance", ("predictor from filter", "filter from predictor"), "A C Q R",
        _lets("b T λ", A, C, Q, R), _three(b, T, Q, C, forms),
    )  # fmt: skip


def dare_gain() -> Formula:
    """L = A M C/(C^2 M + R), the gain of the predictor."""
    A, C, Q, R, b, T, lam, L = symbols("A C Q R b T λ L")
    large, small = _roots(b, T, C, Q, R)
    forms = (
        (Quotient(A * C * large, lam), "predictor gain"),
        (Quotient(A * C * small, lam), "predictor gain without a division by C"),
        (NOTHING, "double root on the circle, gain"),
    )  # fmt: skip
    return _made(
        "dare_gain", Equation(L, "=", Quotient(A * C * large, lam)), EXISTS_D, "predictor gain",
        ("discrete closed loop", "gains"), "A C Q R", _lets("b T λ", A, C, Q, R), _three(b, T, Q, C, forms),
    )  # fmt: skip


def dare_closed_loop() -> Formula:
    """A - L C = A R/(C^2 M + R)."""
    A, C, Q, R, b, T, lam, L = symbols("A C Q R b T λ L")
    loop = Quotient(A * R, lam)
    branches = (
        Branch((compare(C, "≠"),), loop, "predictor loop"),
        Branch((compare(T, ">", b),), loop, "predictor loop without a division by C"),
    )
    return _made(
        "dare_closed_loop", Equation(A - L * C, "=", loop), EXISTS_D, "predictor loop", ("inside the circle",),
        "A C Q R", _lets("b T λ", A, C, Q, R), branches,
    )  # fmt: skip


COMMON_D = "R > 0, S^2 <= Q R, C ≠ 0; where C = 0 the state must be stable"


def _common_discrete() -> tuple[Let, ...]:
    A, C, Q, R, N, F, q = symbols("A C Q R S_d F_d q_d")
    plant = Let(F, Quotient(A * R - N * C, R)), Let(q, Quotient(Q * R - Power(N, 2), R))
    return (*plant, *_lets("b_S T_S", F, C, q, R))


def dare_cross_covariance() -> Formula:
    """The same root for F = A - S C/R, q = Q - S^2/R."""
    C, R, q, b, T, M = symbols("C R q_d b_S T_S M_S")
    large, small = _roots(b, T, C, q, R)
    tail = " with common noise"
    forms = (
        (large, "M_S from its definition"), (small, "same discrete covariance" + tail),
        (NOTHING, "double root on the circle" + tail),
    )  # fmt: skip
    roles = tuple(name + tail for name in ("discrete Riccati equation", "discrete closed loop", "inside the circle"))
    return _made(
        "dare_cross_covariance", Equation(M, "=", large), COMMON_D, "M_S from its definition", roles, "A C Q R S_d",
        _common_discrete(), _three(b, T, q, C, forms),
    )  # fmt: skip


def dare_cross_gain() -> Formula:
    """L = (A M C + S)/(C^2 M + R)."""
    A, C, R, N, F, q, b, T, L = symbols("A C R S_d F_d q_d b_S T_S L_S")
    large, small = _roots(b, T, C, q, R)
    half, tail = _innovation(F, C, q, R, T), " with common noise"
    forms = (
        (Quotient(A * C * large + N, half), "predictor gain" + tail),
        (Quotient(A * C * small + N, half), "same predictor gain" + tail),
        (Quotient(N, R), f"double root on the circle{tail}, gain"),
    )  # fmt: skip
    return _made(
        "dare_cross_gain", Equation(L, "=", forms[0][0]), COMMON_D, "predictor gain" + tail,
        ("discrete closed loop" + tail,), "A C Q R S_d", _common_discrete(), _three(b, T, q, C, forms),
    )  # fmt: skip


# ------------------------------------------------------------------------------------------------ regulator
CONTROLLED = "R > 0, Q >= 0, B ≠ 0; where B = 0 the state must be stable"


def _root_of_regulator() -> Let:
    A, B, Q, R, S = symbols("A B Q R S_B")
    return Let(S, Root(Power(A, 2) + Quotient(Power(B, 2) * Q, R)))


def lqr_cost_continuous() -> Formula:
    """X = R (A + sqrt(A^2 + B^2 Q/R))/B^2."""
    A, B, Q, R, S, X = symbols("A B Q R S_B X_B")
    forms = (
        (Quotient(R * (A + S), Power(B, 2)), "cost of the regulator"),
        (Quotient(Q, S - A), "cost without a division by B"), (NOTHING, "double root of the regulator"),
    )  # fmt: skip
    body = Quotient(R * (A + _root_of_regulator().body), Power(B, 2))
    return _made(
        "lqr_cost_continuous", Equation(X, "=", body), CONTROLLED, "cost of the regulator",
        ("Riccati equation of the regulator", "X_B >= 0"), "A B Q R", (_root_of_regulator(),),
        _three(A, S, Q, B, forms),
    )  # fmt: skip


def lqr_gain_continuous() -> Formula:
    """K = (A + sqrt(A^2 + B^2 Q/R))/B, u = -K x."""
    A, B, Q, R, S, K = symbols("A B Q R S_B K_B")
    forms = (
        (Quotient(A + S, B), "gain of the regulator"),
        (Quotient(Q * B, R * (S - A)), "gain without a division by B"), (NOTHING, "double root of the regulator, gain"),
    )  # fmt: skip
    return _made(
        "lqr_gain_continuous", Equation(K, "=", Quotient(A + _root_of_regulator().body, B)), CONTROLLED,
        "gain of the regulator", ("closed loop of the regulator",), "A B Q R", (_root_of_regulator(),),
        _three(A, S, Q, B, forms),
    )  # fmt: skip


def lqr_cost_discrete() -> Formula:
    """X = (b + T)/(2 B^2)."""
    A, B, Q, R, b, T, X = symbols("A B Q R b_B T_B M_B")
    large, small = _roots(b, T, B, Q, R)
    forms = (
        (large, "discrete cost of the regulator"), (small, "discrete cost without a division by B"),
        (NOTHING, "double root of the regulator on the circle"),
    )  # fmt: skip
    return _made(
        "lqr_cost_discrete", Equation(X, "=", large), CONTROLLED, "discrete cost of the regulator",
        ("discrete Riccati equation of the regulator", "M >= 0_B"), "A B Q R", _lets("b_B T_B", A, B, Q, R),
        _three(b, T, Q, B, forms),
    )  # fmt: skip


def lqr_gain_discrete() -> Formula:
    """F = A B X/(B^2 X + R), u = -F x."""
    A, B, Q, R, b, T, F = symbols("A B Q R b_B T_B F_B")
    large, small = _roots(b, T, B, Q, R)
    half = _innovation(A, B, Q, R, T)
    forms = (
        (Quotient(A * B * large, half), "discrete gain of the regulator"),
        (Quotient(A * B * small, half), "discrete gain without a division by B"),
        (NOTHING, "double root of the regulator on the circle, gain"),
    )  # fmt: skip
    return _made(
        "lqr_gain_discrete", Equation(F, "=", forms[0][0]), CONTROLLED, "discrete gain of the regulator",
        ("discrete closed loop of the regulator", "the regulator is inside the circle"), "A B Q R",
        _lets("b_B T_B", A, B, Q, R), _three(b, T, Q, B, forms),
    )  # fmt: skip


FORMULAS = (
    care_covariance, care_gain, care_closed_loop, care_cross_covariance, care_cross_gain,
    dare_covariance, dare_filtered_covariance, dare_gain, dare_closed_loop, dare_cross_covariance, dare_cross_gain,
    lqr_cost_continuous, lqr_gain_continuous, lqr_cost_discrete, lqr_gain_discrete,
)  # fmt: skip
