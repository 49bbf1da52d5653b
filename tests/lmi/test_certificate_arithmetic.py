"""Exact arithmetic: definiteness against minors and squares, stability of polynomials against their roots."""

import itertools
from fractions import Fraction

import numpy as np
import pytest

import lmi.certificate.arithmetic as arithmetic
from lmi.certificate.arithmetic import Exact, TooLargeError, is_definite, is_semidefinite, symmetric_block
from lmi.certificate.stability import characteristic_polynomial, is_hurwitz, moved_to_the_half_plane


def exact(rows):
    return Exact.of([[Fraction(x) for x in row] for row in rows])


def as_array(X):
    return np.array([[X[i, j] for j in range(X.shape[1])] for i in range(X.shape[0])], dtype=object)


def determinant(a):
    """Leibniz's formula."""
    n = len(a)
    total = Fraction(0)
    for order in itertools.permutations(range(n)):
        sign = (-1) ** sum(order[i] > order[j] for i in range(n) for j in range(i + 1, n))
        product = Fraction(sign)
        for i, j in enumerate(order):
            product *= a[i][j]
        total += product
    return total


def by_minors(a, strict):
    """Sylvester's criterion: leading minors, where not strict all principal minors."""
    n = len(a)
    if strict:
        return all(determinant([row[:k] for row in a[:k]]) > 0 for k in range(1, n + 1))
    chosen = (rows for k in range(1, n + 1) for rows in itertools.combinations(range(n), k))
    return all(determinant([[a[i][j] for j in rows] for i in rows]) >= 0 for rows in chosen)


@pytest.fixture(params=[True, False], ids=["with a congruence", "by elimination alone"])
def either_way(request, monkeypatch):
    """Run with and without the help of floating point."""
    if not request.param:
        monkeypatch.setattr(arithmetic, "_dominant", lambda table: False)


@pytest.mark.usefixtures("either_way")
def test_definiteness_is_that_of_the_minors():
    rng = np.random.default_rng(0)
    seen = set()
    for _ in range(400):
        n, rank = rng.integers(1, 5), rng.integers(0, 5)
        G = rng.integers(-2, 3, (n, rank))
        M = (G @ G.T - np.diag(rng.integers(0, 2, n) * (rng.random() < 0.5))).tolist()
        M = [[Fraction(int(x), 3) for x in row] for row in M]
        definite, semidefinite = by_minors(M, True), by_minors(M, False)
        assert is_definite(exact(M)) is definite
        assert is_semidefinite(exact(M)) is semidefinite
        seen.add((definite, semidefinite))
    assert seen == {(True, True), (False, True), (False, False)}


@pytest.mark.usefixtures("either_way")
@pytest.mark.parametrize("bits", [60, 400, 4000])
def test_the_smallest_excess_over_a_singular_matrix_decides(bits):
    tiny = Fraction(1, 2**bits)
    v = [Fraction(3, 7), Fraction(-2), Fraction(5, 11)]
    for shift, definite, semidefinite in ((tiny, True, True), (0, False, True), (-tiny, False, False)):
        M = exact([[x * y + (shift if i == j else 0) for j, y in enumerate(v)] for i, x in enumerate(v)])
        assert is_definite(M) is definite
        assert is_semidefinite(M) is semidefinite


@pytest.mark.usefixtures("either_way")
def test_definiteness_does_not_depend_on_units():
    M = np.array([[2, 1, 0], [1, 2, 1], [0, 1, 2]], dtype=object)
    for scale in ([1, 1, 1], [2**300, 1, Fraction(1, 2**300)], [10**40, Fraction(1, 3), 7]):
        s = np.array([Fraction(x) for x in scale], dtype=object)
        assert is_definite(exact((M * np.outer(s, s)).tolist()))
        assert not is_semidefinite(exact(((M - np.diag([0, 2, 0])) * np.outer(s, s)).tolist()))


@pytest.mark.usefixtures("either_way")
def test_a_zero_pivot_needs_a_row_of_zeros():
    assert is_semidefinite(exact([[0, 0, 0], [0, 1, 1], [0, 1, 1]]))
    assert not is_semidefinite(exact([[1, 1, 0], [1, 1, 1], [0, 1, 5]]))
    assert not is_semidefinite(exact([[0, 1], [1, 100]]))
    assert is_semidefinite(exact([[4, 2, 2], [2, 1, 1], [2, 1, 3]]))
    assert not is_definite(exact([[4, 2, 2], [2, 1, 1], [2, 1, 3]]))


def test_a_matrix_that_is_not_symmetric_has_no_sign():
    for decide in (is_definite, is_semidefinite):
        with pytest.raises(ValueError, match="symmetric"):
            decide(exact([[1, 2], [0, 1]]))


def test_what_takes_too_long_is_not_begun(monkeypatch):
    monkeypatch.setattr(arithmetic, "WORK", 10)
    assert is_definite(exact([[2, 1], [1, 2]]))  # by the congruence
    with pytest.raises(TooLargeError, match="2 rows"):
        is_semidefinite(exact([[2**20, 2**20], [2**20, 2**20]]))
    assert is_semidefinite(exact([[0, 0], [0, 0]]))


def test_products_sums_and_traces_are_those_of_fractions():
    rng = np.random.default_rng(1)
    X, Y = (
        [[Fraction(int(a), int(b)) for a, b in zip(p, q, strict=True)] for p, q in zip(num, den, strict=True)]
        for num, den in ((rng.integers(-9, 9, (3, 4)), rng.integers(1, 9, (3, 4))) for _ in range(2))
    )
    x, y = np.array(X, dtype=object), np.array(Y, dtype=object)
    ex, ey = exact(X), exact(Y)
    assert (as_array(ex @ ey.T) == x @ y.T).all()
    assert (as_array(ex + ey) == x + y).all()
    assert (as_array(ex - ey) == x - y).all()
    assert (as_array(ex * Fraction(-2, 3)) == x * Fraction(-2, 3)).all()
    assert ex.trace_of_product(ey.T) == (x @ y.T).trace()
    block = symmetric_block(exact([[1, 2], [2, 3]]), exact([[4], [5]]), exact([[6]]))
    assert as_array(block).tolist() == [[1, 2, 4], [2, 3, 5], [4, 5, 6]]
    assert ex.equals(ex + ey - ey)
    assert not ex.equals(ey)
    assert not ex.equals(ex.T)


def test_doubles_are_the_rationals_that_they_are():
    assert Exact.of_floats([[0.1]])[0, 0] == Fraction(3602879701896397, 36028797018963968)
    assert Exact.of_floats([[5e-324, 1e300]])[0, 0] == Fraction(1, 2**1074)


def polynomial_of(roots, denominator):
    """Return the integer polynomial with roots r / denominator, r Gaussian integers taken with their conjugates."""
    polynomial = np.array([1], dtype=object)
    for re, im in roots:
        d = denominator
        factor = [d, -re] if im == 0 else [d * d, -2 * d * re, re * re + im * im]
        polynomial = np.convolve(polynomial, np.array(factor, dtype=object))
    return [int(x) for x in polynomial]


@pytest.mark.parametrize("sign", [1, -1])
def test_routh_decides_as_the_roots_do(sign):
    rng = np.random.default_rng(2)
    seen = set()
    for _ in range(1500):
        roots = [(int(re), int(im)) for re, im in rng.integers(-4, 3, (rng.integers(1, 6), 2))]
        polynomial = [sign * x for x in polynomial_of(roots, 2)]
        hurwitz = all(re < 0 for re, _ in roots)
        schur = all(re * re + im * im < 4 for re, im in roots)
        assert is_hurwitz(polynomial) is hurwitz
        assert is_hurwitz(moved_to_the_half_plane(polynomial)) is schur
        seen.add((hurwitz, schur))
    assert len(seen) == 4


def test_roots_on_the_boundary_are_not_stable():
    for polynomial in ([1, 0], [1, 0, 1], [1, 1, 1, 1], [1, 0, 2, 0, 1], [1, 0, 0]):
        assert not is_hurwitz(polynomial)
    for polynomial in ([1, -1], [1, 1], [1, 0, 1], [5, -6, 5], [1, -2, 1]):
        assert not is_hurwitz(moved_to_the_half_plane(polynomial))


def test_characteristic_polynomial_annihilates_its_matrix():
    rng = np.random.default_rng(3)
    for n in (1, 2, 5):
        rows = [[Fraction(int(a), 7) for a in row] for row in rng.integers(-9, 9, (n, n))]
        X, value = np.array(rows, dtype=object), np.zeros((n, n), dtype=object)
        polynomial = characteristic_polynomial(exact(rows))
        for c in polynomial:
            value = value @ X + c * np.eye(n, dtype=int)
        assert not value.any()
        assert polynomial[0] > 0
        assert Fraction(polynomial[1], polynomial[0]) == -X.trace()
