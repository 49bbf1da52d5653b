"""Printers: parentheses exactly where they are needed, factors in the order in which they were written."""

from __future__ import annotations

import re
from fractions import Fraction
from xml.etree import ElementTree

import pytest

from derive.latex import latex, mathml
from derive.terms import (
    Delta,
    Dot,
    Equation,
    Expect,
    Glyph,
    Gradient,
    Identity,
    Integral,
    Neg,
    Number,
    Symbol,
    Trace,
    Zero,
    block,
    walk,
)  # fmt: skip
from derive.theory import LECTURES, lecture

A, B, C, P, R, L = (Symbol(x, "n", "n", Glyph(x)) for x in "ABCPRL")
x_hat = Symbol("xh", "n", "1", Glyph("x", accent="hat", sub="k-1"))
P_e = Symbol("Pe", "n", "n", Glyph("P", sub="e"))
Phi = Symbol("Phi", "n", "n", Glyph("Φ"), args=("t", "τ"))

TABLE = [
    (A - L * C, "A - L C"),
    ((A - L * C) * P, "(A - L C) P"),
    (P * (A - L * C).T, r"P (A - L C)^\top"),
    ((A * B).T, r"(A B)^\top"),
    ((C * P * C.T + R).inv, r"(C P C^\top + R)^{-1}"),
    (A.inv, "A^{-1}"),
    ((A - B).inv.T, r"(A - B)^{-\top}"),
    (A - (B - C), "A - (B - C)"),
    (A + Neg(B), "A - B"),
    (Neg(A + B), "-(A + B)"),
    (A * Neg(B), "A (-B)"),
    (2 * (A + B), "2 (A + B)"),
    (Number(Fraction(1, 2)) * P, r"\tfrac12 P"),
    (Dot(P_e), r"\dot P_e"),
    (Dot(A * B), r"\frac{\mathrm{d}}{\mathrm{d}t}(A B)"),
    (Expect(x_hat * x_hat.T), r"\mathbb{E}[\hat x_{k-1} \hat x_{k-1}^\top]"),
    (Phi, r"\Phi(t,\tau)"),
    (Trace(A * B), r"\operatorname{tr}(A B)"),
    (Identity("n") + A, "I + A"),
    (P * Delta("t", "τ"), r"P \delta(t - \tau)"),
    (Equation(A, "⪰", Zero("", "")), r"A \succeq 0"),
    (Equation(A, ":=", B), "A := B"),
    (block([[A, Zero("n", "n")], [B, C]]), r"\begin{bmatrix} A & 0 \\ B & C \end{bmatrix}"),
]


def squeezed(text: str) -> str:
    return re.sub(r"\s+", "", text)


@pytest.mark.parametrize(("term", "expected"), TABLE)
def test_latex(term, expected):
    assert squeezed(latex(term)) == squeezed(expected)


def test_integral_and_gradient_name_their_variable():
    assert r"\int_{t_0}^{t}" in squeezed(latex(Integral(Phi, "τ"))).replace("_{t_0}^t", "_{t_0}^{t}")
    assert squeezed(latex(Integral(Phi, "τ"))).endswith(squeezed(r"\mathrm{d}\tau"))
    assert r"\partial" in latex(Gradient(Trace(L * P), L))


BOUNDED = ("Gradient", "Image", "Limit", "Start", "Definite")  # a letter stands under the sign, or twice


@pytest.mark.parametrize("key", LECTURES)
def test_every_equation_is_printed_in_order_and_balanced(key):
    """The single Latin capitals of the LaTeX are those of the tree, in its order; MathML is well-formed."""
    for step in lecture(key).steps:
        text = latex(step.statement)
        assert text.count("{") == text.count("}")
        assert text.count(r"\left") == text.count(r"\right")
        ElementTree.fromstring(mathml(step.statement).replace("&ApplyFunction;", ""))
        for side in (step.statement.lhs, step.statement.rhs):
            symbols = [n for n in walk(side) if isinstance(n, Symbol)]
            named = [c for n in symbols for c in (n.glyph.letter, *(n.show_args or ())) if re.fullmatch("[A-Z]", c)]
            if not any(type(n).__name__ in BOUNDED for n in walk(side)):
                bare = re.sub(
                    r"\\operatorname\{\w+\}|\\[A-Za-z]+|\{bmatrix\}|_\{[^{}]*\}|_\w|\\mathrm\{d\}", " ", latex(side)
                )
                letters = [c for c in re.findall("[A-Z]", bare) if c not in "IE" or c in named]
                assert letters == named, text
