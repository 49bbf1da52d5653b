"""Whatever comes in, the reader ends in a tree or in one clean line; and what it read it reads again."""

from __future__ import annotations

import random

from hypothesis import given, settings
from hypothesis import strategies as st

from derive.latex.grammar import read
from derive.latex.spell import spell
from derive.latex.syntax import (
    Applied,
    Called,
    Display,
    Expected,
    Fenced,
    Inverted,
    Matrix,
    Name,
    Over,
    Plus,
    Radical,
    Related,
    Summed,
    Times,
    Transposed,
)
from tests.derive.latex.fuzz import FRAGMENTS, Builder, check, mutated, real, source

FORMULAS = real()

names = st.builds(
    Name,
    st.sampled_from(["A", "B", "P", "x", "Phi", "sigma", "R"]),
    st.sampled_from([(), (), ("hat",), ("dot",), ("hat", "dot")]),
    st.sampled_from(["", "", "k", "k-1", "k|k-1", "ξξ", "z-ȳ", "∞", "t_0"]),
    st.sampled_from(["", "", "", "+", "-", "⋆", "(i)", "ref"]),
)
moments = st.sampled_from([Name("t"), Name("s"), Name("k"), Name("t", sub="0"), Plus((("-", Name("tau")),))])


def sums(factors):
    """Return sums of two or three products of the given factors, the first perhaps with a minus sign."""
    products = st.lists(factors, min_size=2, max_size=3).map(lambda f: Times(tuple(f)))
    addends = st.tuples(st.sampled_from("+-"), products | factors)
    return st.lists(addends, min_size=2, max_size=3).map(lambda a: Plus(tuple(a)))


def factors(inner):
    """Return factors with given expressions inside."""
    groups = st.builds(Fenced, inner, st.sampled_from("([|‖"))
    closed = st.one_of(
        groups,
        st.builds(Over, inner, inner),
        st.builds(Radical, inner),
        st.builds(Expected, inner),
        st.builds(lambda name, at: Applied(name, (at,)), names.filter(lambda n: not n.sup), moments),
        st.builds(lambda body: Called("tr", (body,)), inner),
        st.builds(lambda a, b: Called("max", (a, b)), inner, inner),
        st.builds(lambda a, b: Matrix(((a, b), (b, a))), inner, inner),
    )
    return (
        closed
        | st.builds(Transposed, groups, st.sampled_from(["top", "T", "star", "prime"]))
        | st.builds(Inverted, groups)
    )


atoms = names | names.map(Inverted) | st.builds(Transposed, names, st.sampled_from(["top", "dagger", "H"]))
expressions = st.recursive(atoms, lambda inner: sums(factors(inner)) | factors(inner), max_leaves=12)
summed = st.builds(lambda body: Summed(body, Name("i"), None, Name("n")), atoms)
statements = st.builds(
    lambda a, r, b: Related((a, b), (r,)), expressions, st.sampled_from("=≤⪰≻≠→"), expressions | summed
)


@settings(max_examples=200, deadline=None)
@given(st.lists(statements, min_size=1, max_size=3))
def test_a_tree_that_is_spelled_is_read_as_that_tree(trees):
    display = Display(tuple(trees), ("",) * (len(trees) + 1))
    assert read(spell(display)) == display


@settings(max_examples=300, deadline=None)
@given(st.lists(st.sampled_from(FRAGMENTS), max_size=40), st.sampled_from(["", " "]))
def test_soup_of_tokens(fragments, space):
    check(space.join(fragments))


@settings(max_examples=200, deadline=None)
@given(st.text(max_size=60) | st.binary(max_size=60).map(lambda b: b.decode("utf-8", errors="surrogateescape")))
def test_any_text(text):
    check(text)


@settings(max_examples=200, deadline=None)
@given(st.sampled_from(FORMULAS), st.integers(0, 2**32))
def test_mutations_of_formulas(formula, seed):
    check(mutated(formula, random.Random(seed)))


def test_built_formulas_are_mostly_read():
    rng = random.Random(0)
    assert sum(check(Builder(rng).display()) for _ in range(120)) > 55


def test_random_input():
    rng = random.Random(1)
    for _ in range(300):
        check(source(rng, FORMULAS))
