"""Formulas as they were written, read in a theory: typed terms, shapes, and what is assumed."""
