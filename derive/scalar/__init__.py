"""Closed forms of the scalar estimator: formulas with their proofs, and code exported from them."""
