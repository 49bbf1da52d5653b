"""Formulas as they were written, read in a theory: typed terms, shapes, and what is assumed."""

from derive.interpret.guess import guess
from derive.interpret.meaning import echo, shapes, understand
from derive.interpret.shapes import Misfit, NotUnderstood
from derive.interpret.statement import Statement

__all__ = ["Misfit", "NotUnderstood", "Statement", "echo", "guess", "shapes", "understand"]
