"""From documents to claims: settings, comments, notebooks, JSON lines, standard input."""

import json

import pytest

from derive.check.documents import is_file, items_of, items_of_stdin
from derive.check.frontmatter import split_front_matter, yaml_subset
from derive.check.item import Setting
from derive.check.steering import Order, orders
from derive.errors import InputError


def items(tmp_path, name, text, setting=None):
    """Return the claims of a document."""
    (tmp_path / name).write_text(text, encoding="utf-8")
    return items_of(str(tmp_path / name), setting or Setting())


def claims(tmp_path, text, name="n.md"):
    """Return (LaTeX, theory, assumptions, line) of the claims of a document."""
    found = items(tmp_path, name, text)
    assert not any(i.message for i in found), [i.message for i in found]
    return [(i.claim.latex, i.claim.theory, i.claim.assume, i.claim.line) for i in found]


# ------------------------------------------------------------------------------------------------ comments
def test_a_theory_holds_from_its_comment_on_and_starts_afresh(tmp_path):
    text = """$$a = b$$
<!-- derive: theory=kalman-bucy, assume="V = I" -->
$$c = d$$
<!-- derive: assume=C \\neq 0, W = 0 -->
$$e = f$$
<!-- derive: theory=lqr-ct -->
$$g = h$$
"""
    assert claims(tmp_path, text) == [
        ("a = b", "", (), 1),
        ("c = d", "kalman-bucy", ("V = I",), 3),
        ("e = f", "kalman-bucy", ("V = I", r"C \neq 0, W = 0"), 5),
        ("g = h", "lqr-ct", (), 7),
    ]


def test_given_equations_are_assumed_by_what_follows(tmp_path):
    text = """$$a = b$$
<!-- derive: given -->
Let $x = y$ be of no interest.
$$
\\begin{align}
c &= d \\\\
e &= f
\\end{align}
$$
With $V = I$ <!-- derive: given -->, we get
$$g = h$$
"""
    found = items(tmp_path, "n.md", text)
    assert [(i.claim.latex, i.claim.assume) for i in found] == [("a = b", ()), ("g = h", ("c  = d", "e  = f", "V = I"))]
    assert found[1].setting.origins == ("line 6", "line 7", "line 10")


def test_skip_and_claim(tmp_path):
    text = """<!-- derive: skip -->
$$a = b$$
$$c = d$$ <!-- derive: skip -->
where $e = f$ <!-- derive: claim -->
and <!-- derive: claim --> $g = h$
"""
    found = items(tmp_path, "n.md", text)
    assert [(i.claim.latex, i.explicit) for i in found] == [("e = f", True), ("g = h", True)]


def test_scalar_comment(tmp_path):
    found = items(tmp_path, "n.md", "$$a = b$$\n<!-- derive: scalar -->\n$$c = d$$")
    assert [i.claim.scalar for i in found] == [False, True]


def test_comments_of_latex(tmp_path):
    text = "% derive: theory=lqr-dt\n\\begin{equation}\\label{a} % derive: given\nP = Q\n\\end{equation}\n\\[R = S\\]"
    assert claims(tmp_path, text, "n.tex") == [("R = S", "lqr-dt", ("P = Q",), 5)]


@pytest.mark.parametrize(
    ("comment", "said"),
    [
        ("theroy=lqr-ct", "got 'theroy=lqr-ct'"),
        ("theory", "got 'theory'"),
        ("skip=3", "got 'skip=3'"),
        ("", "got nothing"),
        ("skip &", "got '&'"),
    ],
)
def test_a_wrong_comment_is_told_with_its_line(tmp_path, comment, said):
    (item, _) = items(tmp_path, "n.md", f"\n<!-- derive: {comment} -->\n$$a = b$$")
    assert item.claim.line == 2
    assert "expected theory=KEY" in item.message
    assert said in item.message


def test_a_comment_that_speaks_of_no_formula_is_told(tmp_path):
    (item,) = items(tmp_path, "n.md", "\n\n<!-- derive: given -->\ntext")
    assert (item.claim.line, item.message) == (3, "expected a formula after the comment, got none")


def test_orders():
    assert orders('theory=a, given  scalar assume="x = 1, y", skip') == [
        Order("theory", "a"), Order("given"), Order("scalar"), Order("assume", "x = 1, y"), Order("skip"),
    ]  # fmt: skip


# ------------------------------------------------------------------------------------------------ names and lines
def test_ids_are_names_or_numbers_of_unnamed_claims(tmp_path):
    text = "$$a=b$$ (3)\n\n$$c=d$$\n\n\\begin{align}\ne&=f\\label{x}\\\\\n\ng&=h\n\\end{align}"
    found = items(tmp_path, "n.md", text)
    assert [(i.claim.id, i.claim.name, i.claim.line) for i in found] == [
        ("3", "3", 1), ("u1", "", 3), ("x", "x", 6), ("u2", "", 8),
    ]  # fmt: skip


def test_a_display_that_only_defines_macros_is_no_claim(tmp_path):
    (item,) = items(tmp_path, "n.md", "$$\\newcommand{\\T}{^{\\top}}$$\n\n$$\\def\\a{b} P\\T = P$$")
    assert item.claim.latex == "P\\T = P"
    assert item.setting.macros == {"T": (0, "^{\\top}"), "a": (0, "b")}


# ------------------------------------------------------------------------------------------------ head
HEAD = """---
title: "Gain: a note"
abstract: |
  derive: nothing
tags: &x [*x]
derive:
  theory: luenberger-dt   # the text's
  assume: ["R \\\\succ 0", 'C \\neq 0']
  given: Q = I
  scalar: true
  notation:
    F: A
    "\\\\Sigma": P
  macros:
    \\T: ^{\\top}
math:
  '\\norm': ['\\|#1\\|', 1]
---
$$a = b$$
"""


def test_front_matter(tmp_path):
    (item,) = items(tmp_path, "n.md", HEAD)
    assert item.claim.theory == "luenberger-dt"
    assert item.claim.assume == (r"R \succ 0", r"C \neq 0", "Q = I")
    assert item.claim.scalar
    assert item.claim.line == 19
    assert item.setting.notation == {"F": "A", "Sigma": "P"}
    assert item.setting.macros == {"T": (0, "^{\\top}"), "norm": (1, r"\|#1\|")}


@pytest.mark.parametrize(
    ("head", "said"),
    [
        ("derive: &x [a]", "line 2: expected a text"),
        ("derive:\n  theory: *x", "line 3: expected a text"),
        ("derive:\n  theory: !x y", "line 3: expected a text"),
        ("derive:\n  notation: {a: b}", "line 3: expected a text"),
        ("derive:\n  theory: a\n  theory: b", "line 4: expected each key once"),
        ("derive:\n    theory: a\n  scalar: true", "line 4: expected the indentation"),
        ('derive:\n  theory: "\\q"', "line 3: expected \\\\ for a backslash"),
        ("derive:\n  assume: [a", "line 3: expected a list"),
        ("derive:\n  theorem: a", "got 'theorem'"),
        ("derive: yes", "got 'yes'"),
        ("derive:\n  notation:\n  - a", "expected letters of the theory"),
        ("derive:\n  theory:\n  - a", "theory: expected a text"),
        ("derive:\n" + "".join(" " * (i + 1) + "a:\n" for i in range(20)), "at most 8 levels"),
        ("derive:\n" + "  a: b\n" * 20000, "at most 65536 characters"),
    ],
)
def test_a_wrong_head_gives_one_line(tmp_path, head, said):
    with pytest.raises(InputError) as caught:
        items(tmp_path, "n.md", f"---\n{head}\n---\n$$a = b$$")
    assert said in str(caught.value)
    assert "n.md: " in str(caught.value)
    assert "\n" not in str(caught.value)


def test_yaml_subset():
    assert yaml_subset("a: 'it''s'\nb:\n- x\n- \"y\\tz\"\nc: [p, 'q, r']\nd:") == {
        "a": "it's", "b": ["x", "y\tz"], "c": ["p", "q, r"], "d": "",
    }  # fmt: skip


def test_a_rule_is_no_front_matter():
    assert split_front_matter("---\n\ntext\n") == ({}, 0)


def test_notation_file(tmp_path):
    (tmp_path / "letters.toml").write_text('[notation]\nF = "A"\n[macros]\nT = "^{\\\\top}"\n', encoding="utf-8")
    head, comment = (
        "---\nderive:\n  notation: letters.toml\n---\n$$a=b$$",
        "<!-- derive: notation=letters.toml -->\n$$a=b$$",
    )
    for text in (head, comment):
        (item,) = items(tmp_path, "n.md", text)
        assert (item.setting.notation, item.setting.macros) == ({"F": "A"}, {"T": (0, "^{\\top}")})
    (tmp_path / "letters.toml").write_text('F = "A"', encoding="utf-8")
    broken, _ = items(tmp_path, "n.md", comment)
    assert "expected the tables notation and macros, got 'F'" in broken.message


# ------------------------------------------------------------------------------------------------ notebooks
def notebook(*cells):
    return {"cells": [{"cell_type": kind, "source": source, "metadata": {}} for kind, source in cells], "nbformat": 4}


def test_notebooks_give_the_lines_of_the_file(tmp_path):
    data = notebook(
        ("raw", ["---\n", "derive:\n", "  theory: lqr-ct\n", "---\n"]),
        ("markdown", ['A "quoted" \\ text\n', "$$\n", "a = b\n", "$$"]),
        ("code", "$$x = y$$"),
        ("markdown", "one string\n\n$$c = d$$ (3)\n\n$$e = f$$"),
    )
    text = json.dumps(data, indent=1)
    found = items(tmp_path, "n.ipynb", text)
    lines = text.split("\n")
    at = [next(i for i, line in enumerate(lines, 1) if sign in line) for sign in ("a = b", "c = d", "e = f")]
    assert [(i.claim.latex, i.claim.id, i.claim.line) for i in found] == [
        ("a = b", "c2.u1", at[0]), ("c = d", "3", at[1]), ("e = f", "c4.u1", at[2]),
    ]  # fmt: skip
    assert {i.claim.theory for i in found} == {"lqr-ct"}


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("[1]", "expected a notebook"),
        ('{"cells": 3}', "expected a notebook"),
        ('{"cells": [3]}', "cell 1 is none"),
        ('{"cells": [{"cell_type": "markdown", "source": 3}]}', "source in cell 1"),
        ('{"cells": [], "cells": []}', "given twice"),
        ('{"cells": [NaN]}', "NaN is not a number"),
        ('{"cells": [' + "9" * 5000 + "]}", "Exceeds the limit"),
        ("[" * 200_000, "nested too deeply"),
        ("{", "expected JSON"),
    ],
)
def test_a_broken_notebook_gives_one_line(tmp_path, text, said):
    with pytest.raises(InputError, match=said) as caught:
        items(tmp_path, "n.ipynb", text)
    assert "\n" not in str(caught.value)


# ------------------------------------------------------------------------------------------------ JSON lines
def test_json_lines(tmp_path):
    lines = [
        {"id": "x", "theory": "lqr-ct", "latex": "a = b", "assume": ["c = d"], "scalar": True, "expected": "proved"},
        {"latex": "e = f"},
    ]
    text = "\n\n".join(map(json.dumps, lines))
    one, two = items(tmp_path, "n.jsonl", text, Setting("lqr-dt", ("g = h",), ("",)))
    assert (one.claim.id, one.claim.theory, one.claim.assume, one.claim.scalar) == (
        "x",
        "lqr-ct",
        ("g = h", "c = d"),
        True,
    )
    assert (two.claim.id, two.claim.theory, two.claim.assume, two.claim.line) == ("u2", "lqr-dt", ("g = h",), 3)


@pytest.mark.parametrize(
    ("line", "said"),
    [
        ("[]", 'an object with "latex"'),
        ("{}", 'an object with "latex"'),
        ('{"latex": 3}', "latex: expected a text, got '3'"),
        ('{"latex": "a", "assume": "b"}', "assume: expected a list of formulas"),
        ('{"latex": "a", "assume": [1]}', "assume: expected a list of formulas"),
        ('{"latex": "a", "scalar": 1}', "scalar: expected true or false"),
        ('{"latex": "a", "theroy": "b"}', "is theory meant?"),
        ('{"latex": "a", "latex": "b"}', "given twice"),
        ("not json", "expected JSON"),
    ],
)
def test_a_wrong_line_is_told_in_its_place(tmp_path, line, said):
    one, two, three = items(tmp_path, "n.jsonl", f'{{"latex": "a=b"}}\n{line}\n{{"latex": "c=d"}}')
    assert (one.message, three.message) == ("", "")
    assert said in two.message
    assert (two.claim.line, two.claim.id) == (2, "u2")


# ------------------------------------------------------------------------------------------------ arguments
def test_what_is_a_file(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "there").write_text("", encoding="utf-8")
    (tmp_path / "loop").symlink_to("loop")
    assert all(map(is_file, ("there", "loop", "none.md", "none.TEX", "a.ipynb", "b.jsonl", ".")))
    assert not any(map(is_file, ("P = Q", "", "a\0b", "P" * 5000, "-")))


def test_paths_that_are_no_documents(tmp_path):
    (tmp_path / "folder.md").mkdir()
    (tmp_path / "loop.md").symlink_to("loop.md")
    (tmp_path / "bytes.md").write_bytes(b"\xff\xfe")
    (tmp_path / "code.py").write_text("", encoding="utf-8")
    (tmp_path / "line.md").write_text("a" * 2**20, encoding="utf-8")
    with (tmp_path / "big.md").open("wb") as file:
        file.truncate(200 * 2**20)
    said = {
        "folder.md": "got a folder", "loop.md": "cannot be read", "bytes.md": "UTF-8", "code.py": "ends in .md",
        "line.md": "characters a line", "big.md": "at most 32 MB", "none.md": "cannot be read", ".": "got a folder",
    }  # fmt: skip
    for name, part in said.items():
        with pytest.raises(InputError, match=part) as caught:
            items_of(str(tmp_path / name), Setting())
        assert "\n" not in str(caught.value)


def test_a_pipe_is_not_waited_for(tmp_path):
    import os

    os.mkfifo(tmp_path / "pipe.md")
    with pytest.raises(InputError, match="got a pipe"):
        items_of(str(tmp_path / "pipe.md"), Setting())


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("P = Q\n\nR = S\n", [("P = Q", 1), ("R = S", 3)]),
        ("\\begin{aligned}\nP = Q\n\\end{aligned}", [("\\begin{aligned}\nP = Q\n\\end{aligned}", 1)]),
        ("a note\n\n$$P = Q$$", [("P = Q", 3)]),
        ("\\section{A}\n\\[P = Q\\]", [("P = Q", 2)]),
        ('{"latex": "P = Q"}\n{"latex": "R = S"}', [("P = Q", 1), ("R = S", 2)]),
        (json.dumps(notebook(("markdown", "$$P = Q$$"))), [("P = Q", 1)]),
    ],
)
def test_standard_input_is_what_it_looks_like(text, expected):
    found = items_of_stdin(text.encode(), Setting())
    assert [(i.claim.latex, i.claim.line) for i in found] == expected
    assert {i.claim.file for i in found} == {"-"}


def test_windows_line_ends_and_byte_order_marks(tmp_path):
    (tmp_path / "n.md").write_bytes("\ufefftext\r\n\r\n$$\r\nP = Q\r\n$$\r\n".encode())
    (item,) = items_of(str(tmp_path / "n.md"), Setting())
    assert (item.claim.latex, item.claim.line) == ("P = Q", 4)
