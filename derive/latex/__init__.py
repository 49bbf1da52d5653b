"""Printers from the presentation tree: LaTeX and MathML."""
