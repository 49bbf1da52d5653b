"""Formulas as SymPy expressions: the same formula, seen through numbers and through printing."""

import numpy as np
import pytest
import sympy

from derive.errors import InputError
from derive.export import shape, to_sympy
from derive.terms import Delta, Dot, Equation, Expect, Identity, Integral, Number, Trace, Zero, block
from derive.theory import LECTURES, lecture, theory


def evaluated(expression, values):
    """Return a SymPy matrix expression with matrices put in for its symbols."""
    found = expression.subs({s: sympy.Matrix(values[s.name]) for s in expression.atoms(sympy.MatrixSymbol)})
    return np.array(found.doit(), dtype=float)


def test_it_is_the_same_formula():
    s = theory("luenberger-dt").symbols
    A, C, P, R = s["A"], s["C"], s["P"], s["R"]
    expression = to_sympy(A * P * C.T * (C * P * C.T + R).inv - 2 * (A * P * C.T))
    rng = np.random.default_rng(0)
    a, c, root = rng.integers(-3, 4, (2, 2)), rng.integers(-3, 4, (1, 2)), rng.integers(-3, 4, (2, 2))
    p, r = root @ root.T, np.array([[2]])
    names = {"A": a, "C": c, "P": p, "R": r}
    expected = a @ p @ c.T @ np.linalg.inv(c @ p @ c.T + r) - 2 * a @ p @ c.T
    sizes = {sympy.Symbol(n, integer=True, positive=True): k for n, k in (("n", 2), ("l", 1))}
    assert np.allclose(evaluated(expression.subs(sizes), names), expected)


def test_operators_print_as_they_do():
    s = theory("observer-ct").symbols
    x, A = s["x"], s["A"]
    found = to_sympy(Equation(Dot(x), "=", A * x))
    assert isinstance(found, sympy.Eq)
    assert sympy.latex(found.lhs) == r"\dot x"
    assert [str(d) for d in found.lhs.shape] == ["n", "1"]
    assert sympy.latex(to_sympy(Expect(x * x.T))).startswith(r"\mathbb{E}")
    assert str(to_sympy(Integral(A * Delta("t", "τ"), "τ")).shape) == "(n, n)"


def test_zeros_blocks_traces_and_scalars():
    s = theory("observer-ct").symbols
    A, C = s["A"], s["C"]
    assert to_sympy(Equation(A - A, "=", Zero("", ""))).rhs == sympy.ZeroMatrix(*to_sympy(A).shape)
    assert shape(block([[A], [C]])) == ("n+l", "n")
    assert shape(C.T) == ("n", "l")
    assert shape(A * C.T) == ("n", "l")
    assert to_sympy(block([[A], [C]])).blockshape == (2, 1)
    assert isinstance(to_sympy(Trace(A)), sympy.Trace)
    assert to_sympy(Number(sympy.Rational(1, 2)) * Identity("n")) == sympy.Identity(to_sympy(A).rows) / 2


def test_an_inequality_has_no_counterpart():
    P = theory("observer-ct").symbols["P"]
    with pytest.raises(InputError, match="expected an equation"):
        to_sympy(Equation(P, "⪰", Zero("", "")))


@pytest.mark.parametrize("key", LECTURES)
def test_every_equation_of_every_lecture_has_one(key):
    for step in lecture(key).steps:
        if step.statement.relation == "=" and step.rule != "gradient":
            assert isinstance(to_sympy(step.statement), sympy.Eq), step.name
