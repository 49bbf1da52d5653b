"""Noncommutative algebra: proof search, exact refutation, positivity."""

from derive.matrix.hypotheses import Hypotheses
from derive.matrix.positivity import prove_comparison, prove_positive, schur_complement, schur_squares
from derive.matrix.refute import refute
from derive.matrix.search import prove

__all__ = ["Hypotheses", "prove", "prove_comparison", "prove_positive", "refute", "schur_complement", "schur_squares"]
