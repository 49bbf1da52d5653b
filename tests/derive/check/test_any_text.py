"""Whatever a document holds: scanning it ends, raises nothing but InputError, and formulas stand where it says."""

import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

from derive.check.collect import collect
from derive.check.documents import items_of_stdin
from derive.check.formula import Formula
from derive.check.frontmatter import split_front_matter
from derive.check.item import Setting
from derive.check.markdown import scan_markdown
from derive.check.notebook import cells
from derive.check.rows import equations
from derive.check.tex import scan_tex
from derive.errors import InputError

PIECES = [
    "$$", "$", "\\[", "\\]", "\\(", "\\)", "\n", "\n\n", "```", "````", "~~~", ":::", "math", "{math}", "{note}", "`",
    "``", "<!--", "-->", "%%", "%", "derive: ", "given", "claim", "skip", "theory=lqr-ct", "assume=", "> ", "- ",
    "    ", "\t", "\\begin{align}", "\\end{align}", "\\begin{aligned}", "\\end{aligned}", "\\begin{equation*}",
    "\\end{equation*}", "\\\\", "&", "=", "+", "P", "Q", "{", "}", "\\", "\\label{a}", "\\tag{1}", "(1)", "{#eq:a}",
    "^b", "(a)=", "<pre>", "</pre>", "\\verb|", "|", "\\iffalse", "\\fi", "\\begin{verbatim}", "\\end{verbatim}",
    "---\n", "derive:\n", ":label: x\n", "é", "\0", "\\newcommand{\\a}{b}", "\\def\\a{",
]  # fmt: skip
TEXTS = st.lists(st.sampled_from(PIECES), max_size=40).map("".join)


@pytest.mark.parametrize("scan", [scan_markdown, scan_tex])
@settings(max_examples=300, deadline=None)
@given(text=TEXTS)
@example(text="$$\n> P\n$$")
@example(text="> $$\n> P\n> $$")
def test_formulas_stand_where_it_says(scan, text):
    lines = text.split("\n")
    for event in scan(text):
        assert 1 <= event.line <= len(lines)
        if isinstance(event, Formula) and event.latex.strip():
            first, line = event.latex.strip().split("\n")[0], lines[event.line - 1]
            assert first.strip() in line or first.strip() in line.replace("$$", "  ")


@settings(max_examples=300, deadline=None)
@given(text=TEXTS)
def test_claims_stand_in_lines_of_the_text(text):
    for scan in (scan_markdown, scan_tex):
        items, _ = collect(list(scan(text)), "n", Setting())
        assert all(0 < i.claim.line <= text.count("\n") + 1 for i in items)
        assert len({(i.claim.line, i.claim.latex, i.claim.id, i.message) for i in items}) <= len(items)


@settings(max_examples=300, deadline=None)
@given(text=TEXTS)
def test_letters_of_an_equation_keep_their_columns(text):
    for row in equations(text):
        kept = [(c, text[row.offset + i]) for i, c in enumerate(row.latex) if c not in " ,"]
        assert all(ours == theirs for ours, theirs in kept)


def message(call):
    """Return what a call complains of, if it raises InputError."""
    try:
        call()
    except InputError as error:
        return str(error)
    return ""


@settings(max_examples=300, deadline=None)
@given(text=TEXTS)
@example(text="---\n---\n")
def test_heads_and_notebooks_raise_nothing_else(text):
    assert "\n" not in message(lambda: split_front_matter(text))
    assert "\n" not in message(lambda: list(cells(text, "n")))


@settings(max_examples=300, deadline=None)
@given(data=st.one_of(st.binary(max_size=60), TEXTS.map(str.encode)))
def test_standard_input_raises_nothing_else(data):
    assert "\n" not in message(lambda: items_of_stdin(data, Setting()))
