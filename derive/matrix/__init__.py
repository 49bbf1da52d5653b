"""Noncommutative algebra: normal form, proof search with cofactors, exact refutation."""
