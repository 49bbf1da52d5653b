"""What is no formula, or has two readings, is refused in one line: where, what was expected, what was got."""

from __future__ import annotations

import sys

import pytest

from derive.errors import InputError
from derive.latex.grammar import read
from derive.latex.macros import definitions
from derive.latex.tokens import MAX_SOURCE, Unreadable, caret, tokenise


def refused(source: str, **options) -> Unreadable:
    with pytest.raises(Unreadable) as caught:
        read(source, **options)
    assert isinstance(caught.value, InputError)
    assert "\n" not in str(caught.value)
    assert len(str(caught.value)) < 300
    return caught.value


# source -> (column from 1, words of what was expected, what was got)
BROKEN = {
    "": (1, "a formula", "the end of the formula"),
    "P = ": (4, "a formula", "the end of the formula"),
    "P = A +": (8, "a formula", "the end of the formula"),
    "P = A + + B": (9, "a formula", "+"),
    "P = (A + B": (11, "the ) to the ( in column 5", "the end of the formula"),
    "P = A + B)": (10, "an operator, a relation or the end", ")"),
    "P = [A + B)": (11, "the ] to the [ in column 5", ")"),
    r"P = \left( A + B )": (18, "the ) with its size", ")"),
    r"P = \frac{A}": (13, "a formula", "the end of the formula"),
    r"P = \frac{A": (12, "the } to the { in column 10", "the end of the formula"),
    "P_": (3, "an index", "the end of the formula"),
    "P_k_j": (4, "one index", "_"),
    "P^2^3": (4, "one exponent", "^"),
    "= = A": (3, "a formula", "="),
    r"\foo + 1": (1, "a command that is known here, or a macro", r"\foo"),
    "A @ B": (3, "a formula", "@ (U+0040)"),
    r"\begin{bmatrix} A & B \\ C \end{bmatrix}": (26, "2 cells in each row", "a row with 1"),
    r"\begin{bmatrix} A": (1, r"\end{bmatrix}", "the end of the formula"),
    r"\begin{bmatrix} A \end{pmatrix}": (19, r"\end{bmatrix}", r"\end{pmatrix}"),
    r"A \end{bmatrix}": (3, "a formula", r"\end{bmatrix}"),
    r"\begin{tikzpicture} A \end{tikzpicture}": (1, "an environment for formulas", r"\begin{tikzpicture}"),
    r"\int_0^t A B": (13, "the differential of this integral", "the end of the formula"),
    "|A + B": (7, "the | to the | in column 1", "the end of the formula"),
    r"\hat{A B}": (1, r"a letter under \hat", r"\hat"),
    r"\mathbb{K}": (9, "one of the letters", "K"),
    r"\mathbb{E} x": (12, "a bracket after the E", "x"),
    r"\left< a \right>": (6, r"a bracket after \left", "<"),
    r"\partial A": (1, "a derivative", r"\partial"),
    r"\begin{aligned} P &= A \\ & B \end{aligned}": (29, "a sign or a relation at the start of a row", "B"),
    r"(A \\ B)": (7, "a sign at a line break inside brackets", "B"),
    r"\sum_{i=1^n x_i": (16, "the } to the { in column 6", "the end of the formula"),
    "()": (2, "a formula", ")"),
    "A_{}": (3, "an index", "{"),
    r"\text{only words}": (18, "a formula", "the end of the formula"),
    r"\text{never closed": (6, "a closing brace", "the end of the formula"),
    "$a = b": (1, "a formula", "$"),
    r"\mathrm{tr} -A": (13, "an argument of tr", "-"),
    r"\left[\begin{array}{c|c} A & B \end{array}\right]": (7, "a matrix without rules", r"\begin{array}"),
    r"\left. A \right|_{t=0}": (1, "a formula", r"\left."),
    r"\frac{d^2 x}{dt}": (1, "a derivative", "another numerator"),
    r"\frac{d x + y}{dt}": (1, "a derivative", "another numerator"),
    r"\int_0^t dt^2": (14, "the differential of this integral", "the end of the formula"),
    "A^(t)": (3, "an exponent in braces", "("),
    r"+\begin{cases} a & b = c \end{cases} + 1": (1, "a left side in front of the cases", "none"),
    r"x = \begin{cases} a & = c \end{cases}": (23, "a relation as the condition", "="),
    " " * MAX_SOURCE + "x": (1, "a formula of at most 10000 characters", "10001 characters"),
    "3.4.5": (1, "a number with one point", "3.4.5"),
    r"k \in [0, 1, 2)": (15, "the ] to the [ in column 7", ")"),
}


@pytest.mark.parametrize("source", BROKEN)
def test_broken(source):
    error = refused(source)
    column, expected, got = BROKEN[source]
    assert error.column + 1 == column
    assert expected in error.expected
    assert error.got.startswith(got)
    assert str(error) == f"column {column}: expected {error.expected}, got {error.got}"


# source -> (column from 1, the two readings)
AMBIGUOUS = {
    "1/2x": (4, "a/(b c)", "(a/b) c"),
    "a/bc": (4, "a/(b c)", "(a/b) c"),
    "a/b/c": (4, "a/(b/c)", "(a/b)/c"),
    "1/(2 a) (b + c)": (9, "a/(b c)", "(a/b) c"),
    "1/P(A)": (3, "a product", "P as a function"),
    "P(A)": (1, "a product", "P as a function"),
    r"\lambda(A - B)": (1, "a product", "lambda as a function"),
    "E(x)": (1, "a product", "E as a function"),
    r"\sin a b": (8, "sin(a b)", "(sin a) b"),
    r"\operatorname{tr} A B": (21, "tr(A B)".replace("A B", "a b"), "(tr a) b"),
    r"\ln a/b": (6, "ln(a/b)", "(ln a)/b"),
    r"\operatorname{tr}(P)^2": (21, "(tr(...))^n", "tr((...)^n)"),
    r"\sin^{-1} x": (11, "the inverse function of sin", "a power of sin(...)"),
    "A^-1": (3, "^{-1}", "^{-} 1"),
    "x^10": (3, "^{10}", r"^1 \cdot 0"),
    "x_10": (3, "_{10}", r"_1 \cdot 0"),
    "A 2": (3, r"\cdot 2", "an index _{2}"),
    "1e-3": (1, r"1 \cdot 10^n", "1 e + n"),
    "x''": (2, r"a second derivative \ddot", "a transpose of a transpose"),
    "A^t": (3, r"a transpose ^\top", "a power ^{(t)}"),
    "e^{-T}": (1, r"\exp(-T)", r"e^{-\top}"),
    "{a + b} c": (1, "a group in brackets ( )", "no group"),
    "{a + b}/c": (1, "a group in brackets ( )", "no group"),
    "c/{a + b}": (1, "a group in brackets ( )", "no group"),
    "c - {a + b}": (1, "a group in brackets ( )", "no group"),
    r"{\sum_i a_i} b": (1, "a group in brackets ( )", "no group"),
    r"\det {a + b}": (7, "a group in brackets ( )", "no group"),
    "{A B}^T": (1, "a group in brackets ( )", "no group"),
    "tr(P)": (1, r"\tr", "t r"),
    "Phi + xhat": (1, r"\Phi", "P h i"),
    r"\sum_i a_i + b_i": (14, r"\sum (a_i + b_i)", r"(\sum a_i) + b_i"),
    r"\frac{d}{dt} (A) B": (14, "d/dt of the product", "d/dt of the brackets alone"),
    r"\int A \, dt \, ds": (17, "the differential of another integral", "a factor d"),
}


@pytest.mark.parametrize("source", AMBIGUOUS)
def test_two_readings(source):
    error = refused(source)
    column, one, two = AMBIGUOUS[source]
    assert error.column + 1 == column
    assert one in error.expected
    assert two in error.expected
    assert error.got.endswith("which can be both")


@pytest.mark.parametrize(
    "source",
    ["(1/2) x", r"1/2 \cdot x", "1/(2 a) b", r"\ln(a) b", r"\sin(a b)", "A^{-1}", "(a + b) c", "{A}^T",
     r"\sum_i a_i + b", "P (A + B)", r"P \cdot (A)", r"\operatorname{tr}(A B)", "2 A", "{a + b}"],
)  # fmt: skip
def test_one_reading(source):
    read(source)


def test_caret():
    source = "a = b\n  + \\foo c"
    error = refused(source)
    assert caret(source, error) == "  + \\foo c\n    ^"


def test_caret_of_a_long_line():
    line, below = caret("x + " * 100 + "@", refused("x + " * 100 + "@")).split("\n")
    assert len(line) <= 110
    assert line[below.index("^")] == "@"


# ------------------------------------------------------------------------------------------------ hostile input
N = MAX_SOURCE
TOWER = "{" * 1200
HOSTILE = {
    "python": '__import__("os").system("ls")',
    "input": r"\input{/etc/passwd}",
    "write": r"\write18{ls}",
    "immediate": r"\immediate\write18{ls}",
    "shell": "$(ls)",
    "lua": r"\directlua{os.execute('ls')}",
    "definition": r"\def\a{\a}\a",
    "parentheses": "(" * 20_000,
    "fewer parentheses": "(" * 3000,
    "pairs": "(" * 1500 + ")" * 1500,
    "sized": r"\left(" * 900,
    "braces": "{" * 3000,
    "a line of 1 MB": "x" * 1_000_000,
    "power tower": "x^{" * 1500,
    "closed tower": "x^{" * 1500 + "x" + "}" * 1500,
    "flat tower": "2" + "^2" * 2000,
    "roots": r"\sqrt" * 1500,
    "fractions": r"\frac{" * 1000,
    "accents": r"\hat" * 1500,
    "integrals": r"\int" * 1500,
    "fractions of differentials": r"\int" + r"\frac{d" * 1000,
    "functions": r"\det" * 1500,
    "derivatives": "d/dt " * 1000,
    "bars": "|" * 3000,
    "open bars": "(|a" * 1000,
    "applications": "f(" * 1500,
    "expectations": "E[" * 1500,
    "minus": "-" * 3000,
    "digits": "9" * 3000,
    "slashes": "a/" * 1500,
    "primes": "A" + "'" * 3000,
    "environments": r"\begin{bmatrix}" * 500,
    "arrays": r"\begin{array}{c}" * 500,
    "cases": r"\begin{cases}" * 500,
    "underset": r"\underset{" * 900,
    "upright": r"{\rm " * 1000,
    "operators": r"\operatorname{a" * 600,
    "fraction characters": "½" * 3000,
    "accent characters": "x" + "\u0302" * 3000,
    "NUL": "P = A\0B",
    "bidi": "P = \u202eA\u202c",
    "surrogate": "P = \ud800",
    "emoji": "P = \U0001f600",
    "other script": "P = \u6f22",
    "replacement": "P = \ufffd",
    "wrong UTF-8": b"P = \xff\xfe A".decode("utf-8", errors="surrogateescape"),
    "backslashes": "\\" * 3001,
    "comments": "%" * 3000,
}
CALLS_PER_CHARACTER, CALLS = 40, 12_000


def calls(source: str, **options) -> int:
    """Count the calls of functions while a source is read, or refused."""
    count = 0

    def tick(_frame, event, _argument):
        nonlocal count
        count += event in ("call", "c_call")

    sys.setprofile(tick)
    try:
        read(source, **options)
    except Unreadable:
        pass
    finally:
        sys.setprofile(None)
    return count


@pytest.mark.parametrize("name", HOSTILE)
def test_hostile(name):
    error = refused(HOSTILE[name])
    assert 0 <= error.column <= len(HOSTILE[name])
    assert caret(HOSTILE[name], error).count("\n") == 1
    assert calls(HOSTILE[name]) <= CALLS + CALLS_PER_CHARACTER * min(len(HOSTILE[name]), N)


LONG = {"letters": "A", "sum": "A + ", "chain": "A = ", "products": r"A B^{-1} \cdot ", "applied": "f(t) ",
        "groups": "(A) ", "bars": "|A| ", "rows": r"a = b \\ ", "lists": "A, ", "fractions": r"\frac12 ",
        "accents": "x̂ "}  # fmt: skip


@pytest.mark.parametrize("name", LONG)
def test_steps_grow_with_the_length_and_no_faster(name):
    short, long = (calls(LONG[name] * n + "A") for n in (100, 400))
    assert 3 * short < long < 4.5 * short


def test_frames_stay_far_below_the_limit_of_the_interpreter():
    deepest = 0

    def measure(frame, event, _argument):
        nonlocal deepest
        depth = 0
        while frame is not None:
            depth, frame = depth + 1, frame.f_back
        deepest = max(deepest, depth)

    sys.setprofile(measure)
    try:
        base = len(tokenise("x")) and deepest
        for name in ("fewer parentheses", "integrals", "roots", "expectations", "applications", "fractions", "sized"):
            with pytest.raises(Unreadable):
                read(HOSTILE[name][:600])
    finally:
        sys.setprofile(None)
    assert deepest - base < 400


BOMB = "".join(rf"\newcommand{{\{a}}}{{\{b}\{b}}}" for a, b in zip("abcdefghijklmno", "bcdefghijklmnop", strict=True))
MACROS = {
    "itself": (r"\newcommand{\a}{\a}", r"\a", "which leads back to itself"),
    "each other": (r"\newcommand{\a}{\b}\newcommand{\b}{x \a}", r"1 + \a", "which leads back to itself"),
    "in an argument": (r"\newcommand{\a}[1]{#1}\newcommand{\b}{\a{\b}}", r"\b", "which leads back to itself"),
    "doubling": (BOMB + r"\newcommand{\p}{x}", r"\a", "which grows without bound"),
    "doubling nothing": (BOMB + r"\newcommand{\p}{}", r"\a", "which grows without bound"),
    "nested doubling": (r"\newcommand{\a}[1]{#1#1}", r"\a{" * 900 + "x" + "}" * 900, "which grows without bound"),
    "long": (r"\newcommand{\a}{" + "x" * 1900 + "}", r"\a " * 900, ""),
    "no argument": (r"\newcommand{\a}[1]{#1}", r"\a", "the end of the formula"),
    "open argument": (r"\newcommand{\a}[1]{#1}", r"\a{x", "the end of the formula"),
    "too few parameters": (r"\newcommand{\a}[1]{#1 #2}", r"\a{x}", "its use of #2"),
    "no formula": (r"\newcommand{\a}{@}", r"\a", "@ (U+0040)"),
}  # fmt: skip


@pytest.mark.parametrize("name", MACROS)
def test_macros_end(name):
    preamble, source, got = MACROS[name]
    macros = definitions(preamble)
    assert got in refused(source, macros=macros).got
    assert calls(source, macros=macros) < 800_000
