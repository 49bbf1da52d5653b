"""The displayed equations of the four sources are read as they are meant, and a chapter in three notations alike."""

from __future__ import annotations

from dataclasses import fields, replace
from pathlib import Path

import pytest

from derive.latex.grammar import read
from derive.latex.spell import spell
from derive.latex.syntax import Applied, Differentiated, Fenced, Name, Node, Transposed, walk

FOLDER = Path(__file__).parent / "displays"
SOURCES = {"observer-notes": 7, "fang-2018": 79, "luenberger-notes": 8, "vander-velde-2004": 10}


def blocks(name: str) -> list[str]:
    return (FOLDER / f"{name}.txt").read_text(encoding="utf-8").strip().split("\n\n")


DISPLAYS = [(name, i, block) for name in SOURCES for i, block in enumerate(blocks(name))]


@pytest.mark.parametrize("name", SOURCES)
def test_every_display_of_the_source_is_here(name):
    assert len(blocks(name)) == SOURCES[name]


@pytest.mark.parametrize(("name", "i", "block"), DISPLAYS, ids=[f"{name}-{i}" for name, i, _ in DISPLAYS])
def test_a_display_is_read_as_the_line_below_it_says(name, i, block):
    formula, meant = block.rsplit("\n% ", 1)
    display = read(formula)
    assert spell(display) == meant
    assert read(meant) == display


@pytest.mark.parametrize("block", blocks("textbook"), ids=range(len(blocks("textbook"))))
def test_three_notations_give_one_tree(block):
    roman, *others = [[plain(s) for s in read(line).statements] for line in block.splitlines()]
    assert len(others) == 2
    for other in others:
        assert other == roman


def plain(node: Node) -> Node:
    """Return a tree with one kind of transpose and of conditional index, and dots for derivatives by time."""
    parts = {f.name: _plain(getattr(node, f.name)) for f in fields(node) if f.name != "span"}
    node = replace(node, **parts)
    match node:
        case Transposed(body):
            return Transposed(body)
        case Applied(Transposed(body), arguments):
            return Transposed(Applied(body, arguments))
        case Fenced(Name(sup="+" | "-") as body, "("):
            return body
        case Differentiated(body, Name("t"), 1):
            return _dotted(body)
        case Name(letter, accents, sub):
            before, _, after = sub.partition("|")
            if after in ("k", "k-1"):
                return Name(letter, accents, before, "+" if before == after else "-")
    return node


def _plain(value):
    if isinstance(value, Node):
        return plain(value)
    return tuple(map(_plain, value)) if isinstance(value, tuple) else value


def _dotted(body: Node) -> Node:
    if isinstance(body, Name):
        return replace(body, accents=(*body.accents, "dot"))
    head = next(n for n in walk(body) if isinstance(n, Name))
    return replace(body, head=_dotted(head))
