"""Which formulas of Markdown are displayed, in which line they stand, and what their names are."""

import pytest

from derive.check.formula import Broken, Formula, Steer
from derive.check.markdown import scan_markdown


def displayed(text):
    """Return (LaTeX, line, name) of the displayed formulas."""
    return [(e.latex, e.line, e.name) for e in scan_markdown(text) if isinstance(e, Formula) and e.displayed]


def inline(text):
    return [e.latex for e in scan_markdown(text) if isinstance(e, Formula) and not e.displayed]


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("$$P = Q$$", ("P = Q", 1, "")),
        ("text\n\n$$\nP = Q\n$$\n", ("P = Q", 4, "")),
        ("in a line $$P = Q$$ of text", ("P = Q", 1, "")),
        ("$$ P = Q $$ {#eq:gain}", ("P = Q", 1, "eq:gain")),  # Quarto, pandoc-crossref
        ("$$\nP = Q\n$$ {#eq-gain .x}", ("P = Q", 2, "eq-gain")),
        ("$$\nP = Q\n$$ (eq:gain)", ("P = Q", 2, "eq:gain")),  # MyST dollarmath
        ("(eq:gain)=\n$$\nP = Q\n$$", ("P = Q", 3, "eq:gain")),  # a MyST target
        ("$$\nP = Q\n$$ ^gain", ("P = Q", 2, "gain")),  # an Obsidian block
        ("$$P = Q$$\n^gain\n", ("P = Q", 1, "gain")),
        ("$$P = Q,$$\n (1)\n", ("P = Q,", 1, "1")),  # a number below, as converters write it
        ("(31.10)\\[P = Q\\]", ("P = Q", 1, "31.10")),
        ("\\[\nP = Q\n\\]", ("P = Q", 2, "")),
        ("```math\nP = Q\n```", ("P = Q", 2, "")),  # GitHub, GitLab
        ("~~~math\nP = Q\n~~~", ("P = Q", 2, "")),
        ("```{math}\n:label: gain\n\nP = Q\n```", ("P = Q", 4, "gain")),  # a MyST directive
        ("```{math}\n---\nlabel: gain\n---\nP = Q\n```", ("P = Q", 5, "gain")),
        ("```{math} P = Q\n```", ("P = Q", 1, "")),
        (":::{math}\nP = Q\n:::", ("P = Q", 2, "")),
        ("````{note}\n```{math}\nP = Q\n```\n````", ("P = Q", 3, "")),
        ("> [!note]\n> $$\n> P = Q\n> $$", ("P = Q", 3, "")),
        ("- item\n\n    $$\n    P = Q\n    $$", ("P = Q", 4, "")),
        ("```{=latex}\n\\begin{equation}P = Q\\end{equation}\n```", ("\\begin{equation}P = Q\\end{equation}", 2, "")),
        ("\\begin{align}\nP &= Q\n\\end{align}", ("\\begin{align}\nP &= Q\n\\end{align}", 1, "")),
        ("$$a \\$ b$$", ("a \\$ b", 1, "")),
        ("$$P$$\n$$ = Q$$", ("P  \n   = Q", 1, "")),  # goes on in the next display
        ("$$P$$\n\n$$= Q$$\n (2)", ("P  \n\n  = Q", 1, "2")),
    ],
)
def test_a_display_is_found_in_its_line_with_its_name(text, expected):
    assert displayed(text) == [expected]


@pytest.mark.parametrize(
    "text",
    [
        "```python\n$$ P = Q $$\n```",
        "~~~\n$$ P = Q $$\n~~~",
        "```\n$$ P = Q $$\n",  # a fence without end
        "```{code-block} md\n$$ P = Q $$\n```",
        "```{python}\n$$ P = Q $$\n```",
        "`$$ P = Q $$`",
        "`` ` $$ P = Q $$ ``",
        "<!-- $$ P = Q $$ -->",
        "<!--\n$$ P = Q $$\n-->",
        "%% $$ P = Q $$ %%",
        "%%\n$$ P = Q $$\n%%",
        "<pre>\n$$ P = Q $$\n</pre>",
        "<code>$$ P = Q $$</code>",
        "    $$ P = Q $$",
        "text\n\n    $$ P = Q $$",
        "\\$\\$ P = Q \\$\\$",
        "it costs $5, or US$$ a lot\n\nand $$ more",
        "an escaped \\[bracket\\](link)",
        "\\[escaped\\](link)",
    ],
)
def test_what_is_no_formula_is_passed_over(text):
    assert displayed(text) == []


def test_inline_formulas_and_money():
    text = "Let $V = I$ cost $5 and $10, or $5-$6, \\$3, `$x$`, $`R = 1`$, and $a$-$b$."
    assert inline(text) == ["V = I", "R = 1", "a", "b"]


def test_several_formulas_of_a_directive_are_told_apart():
    text = "```{math}\n:label: eq\n\nP = Q\n\nR = S\n```"
    assert displayed(text) == [("P = Q", 4, "eq-1"), ("R = S", 6, "eq-2")]


def test_a_fence_closes_only_with_a_mark_of_its_length():
    assert displayed("````\n```\n$$no = no$$\n```\n````\n$$P = Q$$") == [("P = Q", 6, "")]


def test_comments_steer():
    text = "<!-- derive: theory=lqr-dt -->\na $V$ <!-- derive: claim --> b\n%% derive: skip %%\n<!-- said -->"
    found = [e for e in scan_markdown(text) if isinstance(e, Steer)]
    assert found == [Steer("theory=lqr-dt", 1), Steer("claim", 2, alone=False), Steer("skip", 3)]


def test_a_display_without_end_is_told_with_its_line():
    assert list(scan_markdown("a\n\n$$\nP = Q\n")) == [
        Broken("expected $$ that ends the display, got the end of the text", 3)
    ]
    (broken,) = scan_markdown("\n\\begin{align}\nP")
    assert (broken.line, "\\end{align}" in broken.message) == (2, True)


def test_lines_count_from_where_the_text_begins():
    assert [e.line for e in scan_markdown("\n$$P = Q$$", first=10)] == [11]
