"""Lecture notes: one document model and its writers.

>>> import derive
>>> page = derive.notes.page(["observer"])
>>> page.proved == page.total
True
"""

from derive.notes.handout import FORMATS, page, write_notes

__all__ = ["FORMATS", "page", "write_notes"]
