r"""Which formulas of LaTeX are displayed, what is passed over, and how a display falls into equations."""

import pytest

from derive.check.formula import Broken, Formula, Steer
from derive.check.rows import equations
from derive.check.tex import scan_tex


def displayed(text):
    return [(e.latex, e.line) for e in scan_tex(text) if isinstance(e, Formula) and e.displayed]


def rows(source, name=""):
    """Return (LaTeX without blanks, name) of the equations of a display."""
    return [("".join(r.latex.split()), r.name) for r in equations(source, name)]


@pytest.mark.parametrize("text", [r"\[P = Q\]", "$$P = Q$$", "\\[ % \\] is a comment\nP = Q\\]"])
def test_displays(text):
    ((latex, line),) = displayed(f"text\n{text}")
    assert rows(latex) == [("P=Q", "")]
    assert line == 2


@pytest.mark.parametrize("name", ["equation", "align", "gather", "multline", "eqnarray", "displaymath", "flalign"])
@pytest.mark.parametrize("star", ["", "*"])
def test_environments(name, star):
    text = f"\\begin{{{name}{star}}}\nP = Q\n\\end{{{name}{star}}}"
    ((latex, line),) = displayed(f"a\n\n{text}\nb")
    assert (latex, line) == (text, 3)
    assert rows(latex) == [("P=Q", "")]


@pytest.mark.parametrize(
    "text",
    [
        "% $$P = Q$$",
        "\\begin{verbatim}\n$$P = Q$$\n\\end{verbatim}",
        "\\begin{lstlisting}\n\\[P = Q\\]\n\\end{lstlisting}",
        "\\verb|$$P = Q$$|",
        "\\verb*+\\[P = Q\\]+",
        "\\iffalse $$P = Q$$ \\fi",
        "\\end{document} $$P = Q$$",
        "inline $P = Q$ and \\(P = Q\\)",
        "50\\% of \\$\\$ 3",
        "\\begin{math}P = Q\\end{math}",
    ],
)
def test_what_is_no_display_is_passed_over(text):
    assert displayed(text) == []


def test_inline_formulas_are_found():
    found = [e.latex for e in scan_tex("$a$ \\(b\\) \\begin{math}c\\end{math}") if isinstance(e, Formula)]
    assert found == ["a", "b", "\\begin{math}c\\end{math}"]


def test_comments_steer():
    text = "% derive: theory=lqr-ct\nwith $V = I$ % derive: given\n"
    text += "\\begin{equation} % derive: skip\nP = Q\n\\end{equation}"
    events = list(scan_tex(text))
    assert [e for e in events if isinstance(e, Steer)] == [Steer("theory=lqr-ct", 1), Steer("given", 2, alone=False)]
    assert [e.before for e in events if isinstance(e, Formula)] == ["", "skip"]


@pytest.mark.parametrize(("text", "sign"), [("a\n\\[ P", "\\["), ("a\n$$ P", "$$"), ("a\n\\begin{align} P", "align")])
def test_a_display_without_end_is_told_with_its_line(text, sign):
    (broken,) = scan_tex(text)
    assert isinstance(broken, Broken)
    assert (broken.line, sign in broken.message) == (2, True)


# ------------------------------------------------------------------------------------------------ rows
@pytest.mark.parametrize(
    ("source", "expected"),
    [
        (r"P = Q \tag{3}", [("P=Q", "3")]),
        (r"P = Q \tag*{(3)}", [("P=Q", "3")]),
        (r"\label{eq:p} P = Q, \quad (7)", [("P=Q", "7")]),
        (r"P = Q. (3)", [("P=Q", "3")]),
        (r"\begin{equation}\label{eq:p} P = Q.\end{equation}", [("P=Q", "eq:p")]),
        (r"\begin{align}a&=b\label{q}\\ c&=d \nonumber\\ -e&=f\tag{3}\end{align}.",
         [("a=b", "q"), ("c=d", ""), ("-e=f", "3")]),
        (r"\begin{aligned}a&=b\\ c&=d \tag{2}\end{aligned}", [("a=b", "2a"), ("c=d", "2b")]),
        (r"\begin{equation}\label{x}\begin{split}a&=b\\&\quad+c\\ d&=e\end{split}\end{equation}",
         [("a=b\\quad+c", "x-1"), ("d=e", "x-2")]),
        (r"\begin{gather}a=b\\ c=d\end{gather}", [("a=b", ""), ("c=d", "")]),
        (r"\begin{multline}a=b\\ +c\end{multline}", [("a=b+c", "")]),
        (r"\begin{eqnarray} a &=& b \\ &=& c \\ d &=& e\end{eqnarray}", [("a=b=c", ""), ("d=e", "")]),
        (r"\begin{aligned}a&=b + \\ &+ c\end{aligned}", [("a=b+c", "")]),
        (r"\begin{aligned}a&=b = \\ &= c\end{aligned}", [("a=b=c", "")]),
        (r"\begin{align}a&=b,&c&=d\end{align}", [("a=b,c=d", "")]),
        (r"\begin{align}a&=b&c&=d\end{align}", [("a=b,c=d", "")]),
        (r"\begin{cases}\dot x&=y\\ z&=w\end{cases}", [(r"\dotx=y", ""), ("z=w", "")]),
        (r"M = \begin{bmatrix}a&b\\c&d\end{bmatrix}", [(r"M=\begin{bmatrix}a&b\\c&d\end{bmatrix}", "")]),
        (r"\begin{align}M &= \begin{bmatrix}a&b\\c&d\end{bmatrix}\\ x&=y\end{align}",
         [(r"M=\begin{bmatrix}a&b\\c&d\end{bmatrix}", ""), ("x=y", "")]),
        ("a = b % not c\n+ d \\,", [("a=b+d", "")]),
        (r"a = 50\%", [(r"a=50\%", "")]),
        (r"\label{alone}", []),
    ],
)  # fmt: skip
def test_equations_of_a_display(source, expected):
    assert rows(source) == expected


def test_letters_keep_their_columns():
    source = "\\begin{align} % said\n  P &= Q \\label{a} \\\\\n  R &= S\\end{align}"
    for row in equations(source):
        assert source[row.offset] == row.latex[0]
        assert [i for i, c in enumerate(row.latex) if c == "="] == [source[row.offset :].index("=")]


def test_environments_inside_each_other_are_bounded():
    assert len(equations("\\begin{aligned}" * 200 + "a" + "\\end{aligned}" * 200)) == 1
