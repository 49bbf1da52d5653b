"""The closed forms of the scalar estimator and regulator, ready to be evaluated and exported."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction

from derive.derivation import Lecture
from derive.functions import Exp, Power, Quotient, Root
from derive.scalar.formula import Formula, rename
from derive.scalar.program import Branch, Let, Program
from derive.terms import Equation, Number, Symbol, Term, Zero

__all__ = ["FORMULAS", "formula"]

ZERO, ONE = Zero("", ""), Number(Fraction(1))


def _lecture() -> Lecture:
    from derive.theory import lecture

    return lecture("scalar")


def _symbol(name: str) -> Symbol:
    from derive.theory import theory

    return theory("scalar").symbols[name]


def _symbols(names: str) -> tuple[Symbol, ...]:
    return tuple(map(_symbol, names.split()))


def _root() -> Let:
    A, C, W, V, S = _symbols("A C W V S")
    return Let(S, Root(Power(A, 2) + Quotient(Power(C, 2) * W, V)))


def _is(left: Term, relation: str, right: Term = ZERO) -> Equation:
    return Equation(left, relation, right)


def _covariance() -> Formula:
    A, C, W, V, S, P = _symbols("A C W V S P")
    upper = Quotient(V * (A + S), Power(C, 2))
    program = Program(
        "care_covariance", (A, C, W, V), (_root(),),
        (
            Branch((_is(A, ">"), _is(C, "≠")), upper, "P from its definition"),
            Branch((_is(S, ">", A),), Quotient(W, S - A), "same covariance"),
            Branch((_is(W, "="), _is(C, "≠")), ZERO, "double root"),
        ),
    )  # fmt: skip
    roles = ("Riccati equation", "closed loop", "P >= 0", "P- <= 0", "same covariance", "unseen")
    return Formula(
        "care_covariance", Equation(P, "=", Quotient(V * (A + Root(_root_body())), Power(C, 2))),
        "V > 0, W >= 0, C ≠ 0; where C = 0 the state must be stable", "P from its definition", roles, program, _lecture,
        source="001 (31)",
    )  # fmt: skip


def _root_body() -> Term:
    body = _root().body
    assert isinstance(body, Root)
    return body.body


def _gain() -> Formula:
    A, C, W, V, S, K = _symbols("A C W V S K")
    program = Program(
        "care_gain", (A, C, W, V), (_root(),),
        (
            Branch((_is(A, ">"), _is(C, "≠")), Quotient(A + S, C), "gain in closed form"),
            Branch((_is(S, ">", A),), Quotient(W * C, V * (S - A)), "gain without a division by C"),
            Branch((_is(W, "="), _is(C, "≠")), ZERO, "double root, gain"),
        ),
    )  # fmt: skip
    return Formula(
        "care_gain", Equation(K, "=", Quotient(A + Root(_root_body()), C)), "as the covariance", "gain in closed form",
        ("closed loop",), program, _lecture,
    )  # fmt: skip


def _loop() -> Formula:
    A, C, W, V, S, K = _symbols("A C W V S K")
    program = Program("care_closed_loop", (A, C, W, V), (_root(),), (Branch((), -S, "closed loop"),))
    return Formula(
        "care_closed_loop", Equation(A - K * C, "=", -Root(_root_body())), "V > 0, W >= 0", "closed loop",
        ("closed loop without a division by C", "other closed loop"), program, _lecture,
    )  # fmt: skip


def _discrete() -> Formula:
    A, C, Q, R, b, T, M = _symbols("A C Q R b T M")
    beta = (A - ONE) * (A + ONE) * R + Power(C, 2) * Q
    lets = (Let(b, beta), Let(T, Root(Power(b, 2) + 4 * Power(C, 2) * Q * R)))
    program = Program(
        "dare_covariance", (A, C, Q, R), lets,
        (
            Branch((_is(b, ">"), _is(C, "≠")), Quotient(b + T, 2 * Power(C, 2)), "M from its definition"),
            Branch((_is(T, ">", b),), Quotient(2 * Q * R, T - b), "same discrete covariance"),
            Branch((_is(Q, "="), _is(C, "≠")), ZERO, "double root on the circle"),
        ),
    )  # fmt: skip
    roles = ("discrete Riccati equation", "discrete closed loop", "inside the circle", "both innovation covariances")
    return Formula(
        "dare_covariance", Equation(M, "=", Quotient(b + T, 2 * Power(C, 2))),
        "R > 0, Q >= 0, C ≠ 0; where C = 0 the state must be stable", "M from its definition", roles, program, _lecture,
        source="002 (5)",
    )  # fmt: skip


def _filtered() -> Formula:
    predictor, plus = _discrete(), _symbol("M+")
    A, C, Q, R, T, M, lam = _symbols("A C Q R T M λ")
    names = "filtered covariance in closed form", "filtered covariance without a division by C", "filtered double root"
    branches = tuple(
        Branch(b.conditions, Quotient(b.body * R, lam) if b.body != ZERO else ZERO, name)
        for b, name in zip(predictor.program.branches, names, strict=True)
    )
    half = Let(lam, Number(Fraction(1, 2)) * (Power(A, 2) * R + Power(C, 2) * Q + R + T))
    lets = (*predictor.program.lets, half)
    program = replace(predictor.program, name="dare_filtered_covariance", lets=lets, branches=branches)
    return Formula(
        "dare_filtered_covariance", Equation(plus, "=", Quotient(M * R, Power(C, 2) * M + R)), predictor.defined,
        "filtered covariance", ("predictor from filter", "filter from predictor"), program, _lecture,
    )  # fmt: skip


def _transient() -> Formula:
    A, C, W, V, g, S, start, time, P_t = _symbols("A C W V g S P0 t P0(t)")
    decay = Exp(-2 * S * time)
    rest = ONE - decay

    def explicit(plus: Term, minus: Term) -> Term:
        return Quotient(2 * S * start * decay + (start * plus + W) * rest, 2 * S * decay + (minus + g * start) * rest)

    program = Program(
        "riccati_transient", (A, C, W, V, start, time),
        (Let(g, Quotient(Power(C, 2), V)), Let(S, Root(Power(A, 2) + g * W))),
        (
            Branch((_is(start, "="), _is(W, "=")), ZERO, "zero stays zero"),
            Branch((_is(S, ">"), _is(A, ">")), explicit(S + A, Quotient(g * W, S + A)), "explicit, unstable"),
            Branch((_is(S, ">"),), explicit(S + A, S - A), "explicit solution"),
            Branch((), Quotient(start + W * time, ONE + g * start * time), "solution of an integrator"),
        ),
    )  # fmt: skip
    return Formula(
        "riccati_transient", Equation(P_t, "=", explicit(S + A, S - A)),
        "V > 0, W >= 0, P(0) >= 0, t >= 0; S > 0, else A = C W = 0",
        "explicit solution", ("start", "Riccati differential equation", "P(t) >= 0", "distance to the steady state"),
        program, _lecture,
    )  # fmt: skip


def _dual(original: Formula, name: str, letters: dict[str, str]) -> Formula:
    """Return the formula of the regulator: the duality map renames the letters, and A' = A for numbers."""
    pairs = tuple((_symbol(old), Symbol(new, scalar=True)) for old, new in letters.items())
    program = original.program

    def equation(e: Equation) -> Equation:
        return Equation(rename(e.lhs, pairs), e.relation, rename(e.rhs, pairs))

    moved = Program(
        name, tuple(rename(s, pairs) for s in program.arguments),  # type: ignore[misc]
        tuple(Let(rename(t.symbol, pairs), rename(t.body, pairs)) for t in program.lets),  # type: ignore[arg-type]
        tuple(Branch(tuple(map(equation, b.conditions)), rename(b.body, pairs), b.step) for b in program.branches),
    )  # fmt: skip
    return replace(
        original, name=name, statement=equation(original.statement), program=moved, renamed=pairs, source="",
        defined=f"dual of {original.name}",
    )  # fmt: skip


FORMULAS = (
    "care_covariance", "care_gain", "care_closed_loop", "dare_covariance", "dare_filtered_covariance",
    "riccati_transient", "lqr_cost_continuous", "lqr_cost_discrete",
)  # fmt: skip


def formula(name: str) -> Formula:
    """Return a closed form by its name.

    Raises:
        InputError: no such formula.
    """
    from derive.errors import InputError

    makers = {
        "care_covariance": _covariance, "care_gain": _gain, "care_closed_loop": _loop, "dare_covariance": _discrete,
        "dare_filtered_covariance": _filtered, "riccati_transient": _transient,
        "lqr_cost_continuous": lambda: _dual(
            _covariance(), "lqr_cost_continuous", {"C": "B", "W": "Q", "V": "R", "P": "X"}
        ),
        "lqr_cost_discrete": lambda: _dual(_discrete(), "lqr_cost_discrete", {"C": "B", "M": "X"}),
    }  # fmt: skip
    if name not in makers:
        raise InputError(f"formula {name!r}: unknown; known are {', '.join(FORMULAS)}")
    return makers[name]()
