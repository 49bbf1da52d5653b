"""Exact numbers for evidence: roots, Riccati roots, values of terms."""

from __future__ import annotations

from fractions import Fraction
from itertools import product

import pytest

from derive.terms import Identity, Number, Symbol, Trace
from derive.theory.exact import Surd, riccati_roots, root, value


@pytest.mark.parametrize(
    "number", [Fraction(0), Fraction(4), Fraction(5), Fraction(8, 9), Fraction(45, 4), Fraction(1, 2)]
)
def test_root_squares_to_the_number(number):
    found = root(number)
    assert found * found == (Surd(number, Fraction(0), found.d) if isinstance(found, Surd) else number)
    assert float(found) >= 0


def test_field_operations():
    x, y = Surd(Fraction(2), Fraction(1), 5), Surd(Fraction(1, 3), Fraction(-2), 5)
    for a, b in ((x, y), (x, Fraction(3, 2)), (y, 2)):
        assert float(a + b) == pytest.approx(float(a) + float(b))
        assert float(b - a) == pytest.approx(float(b) - float(a))
        assert float(a * b) == pytest.approx(float(a) * float(b))
        assert float(1 / a) == pytest.approx(1 / float(a))
    assert (x + 1) * (1 / (x + 1)) == Surd(Fraction(1), Fraction(0), 5)
    with pytest.raises(ValueError, match="not combined"):
        x + Surd(Fraction(0), Fraction(1), 3)


def test_printing():
    assert str(Surd(Fraction(2), Fraction(1), 5)) == "2 + √5 ≈ 4.236"
    assert str(Surd(Fraction(7, 4), Fraction(-1, 4), 5)) == "(7 − √5)/4 ≈ 1.191"
    assert str(Surd(Fraction(1, 2), Fraction(2, 3), 7)) == "(3 + 4√7)/6 ≈ 2.264"
    assert str(Surd(Fraction(3, 2), Fraction(0), 5)) == "3/2"


def test_riccati_roots_solve_the_equation():
    for a, c, q, r in product((0, 1, 2, Fraction(-3, 2)), (1, 2), (0, 1, 3), (1, Fraction(1, 2))):
        for p in riccati_roots(a, c, q, r):
            if p * c * c + r != 0:
                assert q + a * a * p - a * a * c * c * p * p * (1 / (p * c * c + r)) - p == 0 * p
    assert riccati_roots(2, 0, 1, 1) == [Fraction(-1, 3)]


def test_values_of_terms():
    x, y = Symbol("x", "n", "n"), Symbol("y", "n", "n")
    term = (x - Identity("n")) * y.inv + Number(Fraction(1, 2)) * x.T
    assert value(term, {"x": 3, "y": 4}) == Fraction(2)
    with pytest.raises(ValueError, match="Trace has no value"):
        value(Trace(x), {"x": 1})
