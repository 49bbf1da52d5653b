r"""Definitions of macros inside displays, as people write them for KaTeX, Obsidian and Jupyter."""

from __future__ import annotations

import re

__all__ = ["without_definitions"]

DEFINES = re.compile(r"\\(?:(?:re|provide)?newcommand|DeclareMathOperator|def)\b")


def without_definitions(latex: str) -> str:
    r"""Return a formula whose ``\newcommand`` and the like are blanks, so that every letter keeps its column."""
    if not DEFINES.search(latex):
        return latex
    from derive.latex.macros import COMMAND, DEFINITION, OPERATOR, braced

    for pattern in (COMMAND, DEFINITION, OPERATOR):
        for match in reversed(list(pattern.finditer(latex))):
            body = braced(latex, match.end())
            if body is not None:
                end = match.end() + len(body) + 2
                blanks = re.sub(r"[^\n]", " ", latex[match.start() : end])
                latex = latex[: match.start()] + blanks + latex[end:]
    return latex
