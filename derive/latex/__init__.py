"""Printers from the presentation tree: LaTeX, MathML and plain text."""

from derive.latex.mathml import mathml
from derive.latex.plain import plain
from derive.latex.tex import latex

__all__ = ["latex", "mathml", "plain"]
