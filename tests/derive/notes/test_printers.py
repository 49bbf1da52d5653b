"""Printers: the exact text of every kind of term, in LaTeX and in plain text, and the shape of the MathML."""

from __future__ import annotations

import unicodedata
from fractions import Fraction
from xml.etree import ElementTree

import pytest

from derive.functions import Quotient
from derive.latex import latex, mathml, plain
from derive.latex.boxes import split, width
from derive.latex.layout import layout
from derive.latex.mathml import math
from derive.terms import (
    Delta,
    Dot,
    Equation,
    Expect,
    Glyph,
    Gradient,
    Identity,
    Image,
    Integral,
    Inverse,
    Neg,
    Number,
    Product,
    Sum,
    Symbol,
    Trace,
    Transpose,
    Zero,
    block,
)


def letter(name, **look):
    return Symbol(name, "n", "n", Glyph(look.pop("glyph", name[0]), **look))


A, B, C, L, P, Q, R, V, w, x = map(letter, "ABCLPQRVwx")
x_bar, P_e, P_plus = letter("x bar", accent="bar"), letter("P_e", sub="e"), letter("P+", sup="+")
P_k, B_ed = letter("P k-1", sub="k-1"), letter("B_ed", sub="ed")
xi, Phi = letter("xi", glyph="xi"), letter("Phi", glyph="Φ")
sigma = Symbol("sigma", glyph=Glyph("sigma", sub="ξ", sup="2"), scalar=True)
half = Number(Fraction(1, 2))
N, kappa, rho = (Symbol(name, glyph=Glyph(name), scalar=True) for name in ("N", "kappa", "rho"))

TABLE = [
    ((A - L * C).T, r"(A - L C)^\top", "(A - L C)'"),
    ((A * B).T, r"(A B)^\top", "(A B)'"),
    ((C * P * C.T + R).inv, r"(C P C^\top + R)^{-1}", "(C P C' + R)^-1"),
    (A + Neg(B), "A - B", "A - B"),
    (Neg(Neg(x)), "-(-x)", "-(-x)"),
    (A - Neg(x), "A - (-x)", "A - (-x)"),
    (Neg(A + B), "-(A + B)", "-(A + B)"),
    (A - (B - C), "A - (B - C)", "A - (B - C)"),
    (Sum((A, Sum((Neg(B), C)))), "A - B + C", "A - B + C"),
    (-A * x, "-A x", "-A x"),
    (B - A * x, "B - A x", "B - A x"),
    (B + (-A * x), "B - A x", "B - A x"),
    (A * Neg(B) * C, "A (-B) C", "A (-B) C"),
    (2 * (A + B), "2 (A + B)", "2 (A + B)"),
    (Product((half, A)), r"\tfrac12 A", "1/2 A"),
    (Product((A, half, B)), r"A \cdot \tfrac12 B", "A * 1/2 B"),
    (Product((half, A)).T, r"(\tfrac12 A)^\top", "(1/2 A)'"),
    (A + Product((Number(Fraction(-2)), B)), "A - 2 B", "A - 2 B"),
    (Product((Number(Fraction(2, 15)), A)), r"\tfrac{2}{15} A", "2/15 A"),
    (Quotient(kappa, rho), r"\frac{\kappa}{\rho}", None),
    (Quotient(N, V), r"\frac{N}{V}", None),
    (Dot(x), r"\dot x", "x\u0307"),
    (Dot(x_bar), r"\dot{\bar x}", "x\u0304\u0307"),
    (Dot(P_e), r"\dot P_e", "P\u0307_e"),
    (Dot(P_e).T, r"\dot P_e^\top", "P\u0307_e'"),
    (Dot(P_plus).T, r"(\dot P^+)^\top", "(P\u0307^+)'"),
    (Dot(xi), r"\dot\xi", "ξ\u0307"),
    (Dot(Phi.at("t", "τ")), r"\dot\Phi(t,\tau)", "Φ\u0307(t,τ)"),
    (Dot(x * x.T), r"\frac{\mathrm{d}}{\mathrm{d}t}(x x^\top)", "d/dt (x x')"),
    (Dot(x * x.T) * A, r"\left(\frac{\mathrm{d}}{\mathrm{d}t}(x x^\top)\right) A", "(d/dt (x x')) A"),
    (Dot(Expect(x * x.T)), r"\frac{\mathrm{d}}{\mathrm{d}t}\mathbb{E}[x x^\top]", "d/dt E[x x']"),
    (
        Integral(Phi.at("t", "τ") * w.at("τ"), "τ"),
        r"\int_{t_0}^{t} \Phi(t,\tau) w(\tau)\,\mathrm{d}\tau",
        "∫_{t_0}^t Φ(t,τ) w(τ) dτ",
    ),
    (Integral(A + B, "τ1"), r"\int_{t_0}^{t} (A + B)\,\mathrm{d}\tau_1", None),
    (Integral(A, "τ") * B, r"\left(\int_{t_0}^{t} A\,\mathrm{d}\tau\right) B", None),
    (A * Delta("t", "τ"), r"A \delta(t - \tau)", "A δ(t - τ)"),
    (Trace(A * P + Q), r"\operatorname{tr}(A P + Q)", "tr(A P + Q)"),
    (Gradient(Trace(P), L), r"\frac{\partial}{\partial L}\operatorname{tr}(P)", "∂/∂L tr(P)"),
    (block([[A, Zero("n", "n")], [L * C, A]]), r"\begin{bmatrix} A & 0 \\ L C & A \end{bmatrix}", "[A, 0; L C, A]"),
    (block([[A], [B]]).T, r"\begin{bmatrix} A \\ B \end{bmatrix}^\top", "[A; B]'"),
    (Expect(block([[A]])), r"\mathbb{E}\left[\begin{bmatrix} A \end{bmatrix}\right]", "E[[A]]"),
    (Image("duality", A * P), r"\mathcal{D}[A P]", "D[A P]"),
    (Image("dual in continuous time", A * P), r"\mathcal{D}_c[A P]", "D_c[A P]"),
    (P_plus.T, r"(P^+)^\top", "(P^+)'"),
    (P_k.T, r"P_{k-1}^\top", "P_{k-1}'"),
    (P_k.inv, "P_{k-1}^{-1}", "P_{k-1}^-1"),
    (Inverse(Transpose(A)), r"(A^\top)^{-1}", "(A')^-1"),
    (Phi.at("t0", "τ1").T, r"\Phi(t_0,\tau_1)^\top", "Φ(t_0,τ_1)'"),
    (B_ed * xi, r"B_{ed} \xi", "B_ed ξ"),
    (Product((sigma, Identity("n"))), r"\sigma_\xi^2 I", "σ_ξ^2 I"),
    (Symbol("x", glyph=Glyph("x"), args=("t",), show_args=()), "x", "x"),
    (letter("s", upright=True), r"\mathrm{s}", "s"),
    (Equation(P, "⪰", Zero("", "")), r"P \succeq 0", "P >= 0"),
    (Equation(P, "≻", Zero("", "")), r"P \succ 0", "P > 0"),
    (Equation(Dot(P), ":=", A * P), r"\dot P := A P", "P\u0307 := A P"),
]


@pytest.mark.parametrize(("term", "tex", "text"), TABLE, ids=[t[1] for t in TABLE])
def test_exact_text(term, tex, text):
    assert latex(term) == tex
    assert text is None or plain(term) == text


def letters(text):
    """Return the letters and digits of a text; accents are dropped, script and italic variants taken as plain ones."""
    return [c for c in unicodedata.normalize("NFKD", text) if c.isalnum()]


@pytest.mark.parametrize("term", [t[0] for t in TABLE], ids=[t[1] for t in TABLE])
def test_mathml_has_the_letters_of_the_text_in_its_order(term):
    tree = ElementTree.fromstring(mathml(term, display=True))
    assert tree.tag == "math"
    assert letters("".join(tree.itertext())) == letters(plain(term))


def test_scripts_on_brackets_stay_low_and_tall_brackets_stretch():
    assert '<msup><mpadded height=".62em"><mo stretchy="false">(</mo>' in mathml((A * B).T)
    for tall in (mathml(Expect(block([[A], [B]]))), mathml(Integral(A, "τ").T)):
        assert "mpadded" not in tall
        assert 'stretchy="false"' not in tall


def test_a_minus_sign_says_where_it_stands():
    assert "<mrow><mo>−</mo><mn>1</mn></mrow>" in mathml(A.inv)
    assert '<mo form="prefix">−</mo>' in mathml(Equation(A, "=", -B))
    assert "<mi>A</mi><mo>−</mo><mi>B</mi>" in mathml(A - B)


def test_screen_readers_are_told_what_is_applied_and_what_is_multiplied():
    assert "<mi>A</mi><mo>\u2062</mo><mi>B</mi>" in mathml(A * B)
    assert "<mi>tr</mi><mo>\u2061</mo>" in mathml(Trace(A))


def test_an_equation_may_be_broken_before_its_relation_and_signs_but_not_inside_brackets():
    pieces = split(layout(Equation(P, "=", A * (P - Q) * A.T + Q - R)))
    assert len(pieces) == 4
    assert [math(p).count("<mo>−</mo>") for p in pieces] == [0, 1, 0, 1]
    whole = "".join(math(p).removeprefix("<math>").removesuffix("</math>") for p in pieces)
    assert f"<math>{whole}</math>" == mathml(Equation(P, "=", A * (P - Q) * A.T + Q - R))


def test_width_grows_with_what_is_written():
    terms = [A, A * P, A * P + Q, A * P * A.T + Q, block([[A, A * P * A.T + Q], [P, Q]])]
    widths = [width(layout(t)) for t in terms]
    assert widths == sorted(widths)
    assert len(set(widths)) == len(widths)
