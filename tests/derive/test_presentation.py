"""A letter that prints as what it stands for is a letter to the kernel, and a leaf of its statement."""

from __future__ import annotations

import pytest

from derive.context import Theory
from derive.derivation import claims
from derive.document import document_from_json, lecture_to_json
from derive.functions import Infinity, Limit
from derive.kernel import Rejected
from derive.latex import latex, mathml, plain
from derive.presentation import Named
from derive.terms import Equation, Expect, Symbol, lower, walk
from derive.theory import lecture

x, y = Symbol("x", "n", "1"), Symbol("y", "n", "1")
LIMIT = Named("a", "n", "1", shows=Limit(Expect(x), Symbol("t", scalar=True), Infinity()))
SUM = Named("b", "n", "1", shows=x + y)


@pytest.fixture
def theory():
    t = Theory("test", "Test")
    for name in ("a", "b"):
        t.matrix(name, "n", "1")
    return t


def test_it_prints_as_what_it_shows():
    assert plain(LIMIT) == "lim_{t->∞} E[x]"
    assert latex(LIMIT) == r"\lim_{t\to\infty} \mathbb{E}[x]"
    assert mathml(SUM) == mathml(x + y)


def test_it_is_put_in_parentheses_like_what_it_shows():
    assert plain(SUM.T) == "(x + y)'"
    assert plain(SUM * x.T) == "(x + y) x'"
    assert plain(SUM + x) == "(x + y) + x"


def test_the_kernel_sees_a_letter(theory):
    assert lower(SUM, theory.reading()) == lower(Symbol("b", "n", "1"), theory.reading())
    assert list(walk(SUM)) == [SUM]


def test_what_it_shows_proves_nothing(theory):
    """Two letters that print alike are two letters; and what is shown need not be known to the theory."""
    alike = Named("a", "n", "1", shows=x + y)
    assert plain(alike) == plain(SUM)
    (claim,) = claims(Equation(SUM, "=", alike), "identity", theory.reading())
    assert len(claim.claim.terms) == 2
    with pytest.raises(Rejected, match="unknown letter x"):
        lower(x + y, theory.reading())


def test_a_file_names_it_and_shows_it_again():
    item = lecture("kalman-bucy")
    read = document_from_json(lecture_to_json(item))
    assert [latex(r.statement) for r in read.given if r.number in ("u1", "u2", "u3", "u5")] == [
        latex(item.theory.statement(name)) for name in ("autocorrelation", "spectrum", "inversion", "white")
    ]
    assert r"\int_{-\infty}^{\infty}" in latex(item.theory.statement("spectrum"))
