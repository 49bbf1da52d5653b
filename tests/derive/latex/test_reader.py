"""What each construct is read as: the tree for the basic ones, canonical LaTeX for the rest."""

from __future__ import annotations

from fractions import Fraction

import pytest

from derive.latex.grammar import read
from derive.latex.macros import definitions, table
from derive.latex.spell import spell
from derive.latex.syntax import (
    Applied,
    Barred,
    Blank,
    Called,
    Cases,
    Differentiated,
    Digits,
    Dotted,
    Expected,
    Fenced,
    Given,
    Infinite,
    Integrated,
    Inverted,
    Listed,
    Matrix,
    Name,
    Over,
    Plus,
    Radical,
    Raised,
    Related,
    Summed,
    Times,
    Transposed,
)

A, B, C, P, R, t = map(Name, "ABCPRt")
ZERO, ONE, TWO = (Digits(Fraction(n)) for n in (0, 1, 2))


def tree(latex: str, **options):
    (statement,) = read(latex, **options).statements
    return statement


TREES = {
    # products and sums keep their order
    "A B C": Times((A, B, C)),
    "A + B - C": Plus((("+", A), ("+", B), ("-", C))),
    "-A B": Plus((("-", Times((A, B))),)),
    r"A \cdot B \times C": Times((A, B, C)),
    r"A \pm B": Plus((("+", A), ("±", B))),
    "2 (A + B)": Times((TWO, Fenced(Plus((("+", A), ("+", B)))))),
    "A [B] C": Times((A, Fenced(B, "["), C)),
    # names
    r"\hat{\dot x}_k": Name("x", ("dot", "hat"), "k"),
    r"\hat{\mathbf{x}}_{k|k-1}": Name("x", ("hat",), "k|k-1"),
    r"\bm{\Phi}_{\mathrm{ss}}": Name("Phi", sub="ss"),
    r"\mathcal{H}_\infty": Name("H", sub="∞"),
    r"\Sigma_{\mathbf{z}-\overline{\mathbf{y}}}": Name("Sigma", sub="z-ȳ"),
    r"R_{\boldsymbol\xi \boldsymbol\xi}": Name("R", sub="ξξ"),
    r"P_k^+": Name("P", sub="k", sup="+"),
    r"\hat x^{-}_{k+1}": Name("x", ("hat",), "k+1", "-"),
    r"x^{(i)}_k": Name("x", sub="k", sup="(i)"),
    r"L^\star": Name("L", sup="⋆"),
    r"x_{t_0}": Name("x", sub="t_0"),
    r"y_{1:k}": Name("y", sub="1:k"),
    r"L_\mathrm{opt}": Name("L", sub="opt"),
    r"x^{\text{ref}}": Name("x", sup="ref"),
    r"\mathbb{R}": Name("ℝ"),
    # exponents
    r"A^\top": Transposed(A, "top"),
    "A^T": Transposed(A, "T"),
    r"A^{\mathsf T}": Transposed(A, "T"),
    r"A^{\rm T}": Transposed(A, "T"),
    "A^*": Transposed(A, "star"),
    "A'": Transposed(A, "prime"),
    r"A^\dagger": Transposed(A, "dagger"),
    "A^H": Transposed(A, "H"),
    "A^{-1}": Inverted(A),
    r"A^{-\top}": Transposed(Inverted(A), "top"),
    "A^{-T}": Transposed(Inverted(A), "T"),
    "A^{1/2}": Raised(A, Over(ONE, TWO)),
    r"A^{-\frac12}": Raised(A, Plus((("-", Over(ONE, TWO)),))),
    r"A^{\top/2}": Transposed(Raised(A, Over(ONE, TWO)), "top"),
    "A^k": Raised(A, Name("k")),
    "(A B)^{-1}'": Transposed(Inverted(Fenced(Times((A, B)))), "prime"),
    "e^{A t}": Raised(Name("e"), Times((A, t))),
    # fractions, roots, bars
    r"\frac12 A": Times((Over(ONE, TWO), A)),
    r"\dfrac{A}{2}": Over(A, TWO),
    "A B/C": Over(Times((A, B)), C),
    "A/(B C)": Over(A, Fenced(Times((B, C)))),
    r"\sqrt{A}": Radical(A),
    r"\sqrt[3]{A}": Radical(A, Digits(Fraction(3))),
    "|A|": Fenced(A, "|"),
    r"\|A\|_2": Fenced(A, "‖", "2"),
    r"\left\lVert A \right\rVert_\infty": Fenced(A, "‖", "∞"),
    "|A| B |C|": Times((Fenced(A, "|"), B, Fenced(C, "|"))),
    "0.125": Digits(Fraction(1, 8)),
    # application
    "P(t)": Applied(P, (t,)),
    "P(t)^T": Transposed(Applied(P, (t,)), "T"),
    "P^T(t)": Applied(Transposed(P, "T"), (t,)),
    "e^{A t}(t - k)": Times((Raised(Name("e"), Times((A, t))), Fenced(Plus((("+", t), ("-", Name("k"))))))),
    r"P(z - \hat z)": Times((P, Fenced(Plus((("+", Name("z")), ("-", Name("z", ("hat",)))))))),
    r"\Phi(t, t_0)": Applied(Name("Phi"), (t, Name("t", sub="0"))),
    r"P(k|k-1)": Applied(P, (Given(Name("k"), Plus((("+", Name("k")), ("-", ONE)))),)),
    r"P(\infty)": Applied(P, (Infinite(),)),
    "P[k]": Applied(P, (Name("k"),)),
    r"\lambda_i(A)": Applied(Name("lambda", sub="i"), (A,)),
    "P(A + B)": Times((P, Fenced(Plus((("+", A), ("+", B)))))),
    # functions
    r"\det A": Called("det", (A,)),
    r"\operatorname{tr}(A B)": Called("tr", (Times((A, B)),)),
    r"\mathrm{tr}\,P": Called("tr", (P,)),
    r"\max\{0, \Re[\lambda]\}": Called("max", (ZERO, Called("Re", (Name("lambda"),)))),
    r"\min_L \operatorname{tr} P": Called("min", (Called("tr", (P,)),), Name("L")),
    r"\operatorname*{arg\,min}_L J": Called("argmin", (Name("J"),), Name("L")),
    r"\lim_{t \to \infty} P": Called("lim", (P,), Related((t, Infinite()), ("→",))),
    r"\det[A]^{-1}": Called("det", (Inverted(Fenced(A, "[")),)),
    r"\sin^2 t": Raised(Called("sin", (t,)), TWO),
    r"\ln 2\pi": Called("ln", (Times((TWO, Name("pi"))),)),
    # expectations
    r"\mathbb{E}[A]": Expected(A),
    r"E\{A\}": Expected(A),
    r"\operatorname{E}\left[A\right]": Expected(A),
    r"\mathbf{E}[A]": Expected(A),
    r"\mathbb E[A | B]": Expected(Given(A, B)),
    # operators
    r"\sum_{i=1}^{n} A": Summed(A, Name("i"), ONE, Name("n")),
    r"\prod_i A B": Summed(Times((A, B)), Name("i"), None, None, "prod"),
    r"\int_0^t A B \, dt": Integrated(Times((A, B)), t, ZERO, t),
    r"\int \mathrm dt\, A": Integrated(A, t),
    r"\int A {\rm d} t": Integrated(A, t),
    r"\int \frac{dt}{t}": Integrated(Over(ONE, t), t),
    r"\int A \frac{dt}{2} B": Integrated(Times((A, Over(ONE, TWO), B)), t),
    r"\frac{d}{dt} A B": Differentiated(Times((A, B)), t),
    r"\frac{\mathrm{d} A}{\mathrm{d} t}": Differentiated(A, t),
    r"dP/dt": Differentiated(P, t),
    r"\frac{d^2 P}{dt^2}": Differentiated(P, t, 2),
    r"\frac{\partial \operatorname{tr} P}{\partial A}": Differentiated(Called("tr", (P,)), A, 1, True),
    r"\dot{A B}": Dotted(Times((A, B))),
    r"\overline{A B}": Barred(Times((A, B))),
    # matrices
    r"\begin{bmatrix} A & B \\ 0 & C \end{bmatrix}": Matrix(((A, B), (ZERO, C))),
    r"\left(\begin{array}{cc} A & B \end{array}\right)": Matrix(((A, B),), "("),
    r"\begin{bmatrix} A & * \\ B & C \end{bmatrix}": Matrix(((A, Blank("*")), (B, C))),
    r"f = \begin{cases} A, & t > 0 \\ B, & \text{otherwise} \end{cases}": Related(
        (Name("f"), Cases(((A, Related((t, ZERO), (">",))), (B, None)))), ("=",)
    ),
    # relations
    r"A \preceq B \prec C": Related((A, B, C), ("⪯", "≺")),
    r"A := B \triangleq C": Related((A, B, C), (":=", ":=")),
    r"A \overset{\text{def}}{=} B": Related((A, B), (":=",)),
    r"= A": Related((Blank(), A), ("=",)),
    r"A = \dots": Related((A, Blank("…")), ("=",)),
    r"A, B \succ 0": Related((Listed((A, B)), ZERO), ("≻",)),
    r"t = 0, 1, \dots": Related((t, Listed((ZERO, ONE, Blank("…")))), ("=",)),
}


@pytest.mark.parametrize("latex", TREES)
def test_tree(latex):
    assert tree(latex) == TREES[latex]


SPELLED = {
    r"ẋ = A x + w": r"\dot{x} = A x + w",
    r"x̂ₖ₊₁ = A x̂ₖ": r"\hat{x}_{k+1} = A \hat{x}_{k}",
    r"Aᵀ R⁻¹ A ⪰ 0": r"A^{T} R^{-1} A \succeq 0",
    r"½ x² ≤ ∫₀ᵗ y dt": r"\frac{1}{2} x^{2} \le \int_{0}^{t} y \, d t",
    r"Φ(t,τ) − I ≠ 0": r"\Phi(t, \tau) - I \ne 0",
    r"√(a+b) → ∞": r"\sqrt{a + b} \to \infty",
    r"𝐀𝐱 ∈ ℝ": r"A x \in \mathbb{R}",
    r"𝔼[x x⊤]": r"\mathbb{E}[x x^{\top}]",
    r"\begin{aligned} P &= A P A^T \\ &\quad + Q, \\ L &= P C^T \end{aligned}": r"P = A P A^{T} + Q ;\quad L = P C^{T}",
    r"\begin{align*} a &= b = \\ &= c + \\ &+ d \nonumber \end{align*}": "a = b = c + d",
    r"\begin{eqnarray} a & = & b \\ & = & c \end{eqnarray}": "a = b = c",
    r"\begin{gather} a = b \\ -c = d \end{gather}": r"a = b ;\quad -c = d",
    r"\begin{align} a &= b & c &= d \end{align}": r"a = b ;\quad c = d",
    r"\begin{cases} a &= b, \\ c &= d. \end{cases}": r"a = b ;\quad c = d",
    r"\left\{ \begin{array}{rcl} a & = & b \\ c & = & d \end{array} \right.": r"a = b ;\quad c = d",
    r"\begin{array}{rcl} a & = & b \\ & = & d \end{array}": "a = b = d",
    r"a = \left( b + \right. \\ \left. + c \right)": "a = (b + c)",
    r"a = (b \\ & + c)": "a = (b + c)",
    r"P \to 0 \text{ as } t \to \infty": r"P \to 0 \text{as} t \to \infty",
    r"\forall k, P_k \succeq 0": r"\text{for all} k ;\quad P_{k} \succeq 0",
    r"a = b \quad c = d": r"a = b ;\quad c = d",
    r"a = b, \qquad (31.10)": r"a = b \tag{31.10}",
    r"$$ a = b \label{eq:a} \tag{7} $$": r"a = b \label{eq:a} \tag{7}",
    r"\[\begin{split} a = b \end{split}\]": "a = b",
    r"\boxed{a = b}": "a = b",
    r"a = b % a comment = c": "a = b",
    r"\underbrace{A P}_{\text{first}} + \underbrace{P A'}_{second}": "A P + P A'",
    r"\mathbf{P A}^\top": r"P A^{\top}",
    r"\frac{1}{2\pi}\int f d\omega + 1": r"\frac{1}{2 \pi} \int f \, d \omega + 1",
    r"\int_0^t \int_0^s f dt ds": r"\int_{0}^{t} \int_{0}^{s} f \, d t \, d s",
    r"\int B_d d(\tau) \, d\tau": r"\int B_{d} d(\tau) \, d \tau",
    r"1/(2\pi) \int f d\omega": r"\frac{1}{(2 \pi)} \int f \, d \omega",
    r"F (P^-)^{-1}": r"F \cdot (P^{-})^{-1}",
    r"\operatorname{str} L(s)": r"s \operatorname{tr}(L(s))",
    r"||x|| + \lvert y\rvert": r"\left\| x \right\| + \left| y \right|",
    r"x \in [0, T)": r"x \in [0, T)",
    r"\int d r^2 \, dt": r"\int d \cdot r^{2} \, d t",
    r"p(x|y) = \delta(x)": r"p(x \mid y) = \delta(x)",
    r"\rho(A - L C) < 1": r"\rho(A - L C) < 1",
    r"\int_0^t dt": r"\int_{0}^{t} 1 \, d t",
    r"\begin{bmatrix} [c] A \\ [b] B \end{bmatrix}": r"\begin{bmatrix} [c] A \\ [b] B \end{bmatrix}",
    r"\begin{aligned}[t] a &= b \\[2pt] c &= d \\*[-1.5ex] e &= f \end{aligned}": r"a = b ;\quad c = d ;\quad e = f",
    r"\begin{array}[c]{rl} a &= b \\ [c] d &= f \end{array}": r"a = b ;\quad [c] d = f",
    r"a = b: c = d": r"a = b ;\quad c = d",
    r"\underset{L}{\min} J(L_1, L_2)": r"\min_{L} J(L_{1}, L_{2})",
}


@pytest.mark.parametrize("latex", SPELLED)
def test_spelled(latex):
    display = read(latex)
    assert spell(display) == SPELLED[latex]
    assert read(SPELLED[latex]) == display


def test_words_stand_around_statements():
    display = read(r"\text{where } a = b, \text{ and } c = d \text{ for all } k")
    assert display.words == ("where", "and", "for all", "")
    assert len(display.statements) == 3


def test_spans_are_columns_of_the_source():
    source = r"P = A  \hat x_{k} + \frac{1}{2}"
    right = tree(source).sides[1]
    assert [source[slice(*node.span)] for _, node in right.addends] == [r"A  \hat x_{k}", r"\frac{1}{2}"]
    assert source[slice(*right.addends[0][1].factors[1].span)] == r"\hat x_{k}"


def test_a_name_can_be_declared_a_function():
    assert tree("f(x)", functions=["f"]) == Applied(Name("f"), (Name("x"),))


# ------------------------------------------------------------------------------------------------ macros
PREAMBLE = r"""
\newcommand{\bx}{\mathbf{x}}
\renewcommand{\vec}[1]{\boldsymbol{#1}}
\newcommand\norm[1]{\left\lVert #1 \right\rVert}
\newcommand{\inner}[2]{#1^\top #2}
\def\T{^\top}
\def\pair#1#2{(#1, #2)}
\DeclareMathOperator{\trace}{tr}
\DeclareMathOperator*{\argmin}{arg\,min}
\newcommand{\withdefault}[2][x]{#1#2}
"""
MACROS = {
    r"\bx_k": "x_{k}",
    r"\vec{A}": "A",
    r"\norm{\bx}_2": r"\left\| x \right\|_{2}",
    r"\inner{a}{b} = 0": r"a^{\top} b = 0",
    r"A\T B": r"A^{\top} B",
    r"\Phi\pair{t}{s}": r"\Phi(t, s)",
    r"\trace(A B)": r"\operatorname{tr}(A B)",
    r"\argmin_L J": r"\operatorname{arg\,min}_{L} J",
}


@pytest.mark.parametrize("latex", MACROS)
def test_macros_of_a_document(latex):
    assert spell(read(latex, macros=definitions(PREAMBLE))) == MACROS[latex]


def test_a_macro_with_a_default_argument_is_left_out():
    assert "withdefault" not in definitions(PREAMBLE)


def test_macro_tables_of_notebooks():
    macros = table({r"\RR": r"\mathbb{R}", "norm": [r"\|#1\|", 1], r"\half": r"\frac{#1}{2}", "bad key": 3})
    assert macros == {"RR": (0, r"\mathbb{R}"), "norm": (1, r"\|#1\|"), "half": (1, r"\frac{#1}{2}")}
    assert spell(read(r"\half{x} \in \RR", macros=macros)) == r"\frac{x}{2} \in \mathbb{R}"


def test_tokens_of_a_macro_stand_where_it_was_used():
    source = r"A + \bx"
    plus = tree(source, macros=definitions(PREAMBLE))
    assert source[slice(*plus.addends[1][1].span)] == r"\bx"
