"""The arguments of the checker: files of claims and documents, standard input, claims as they stand."""

from __future__ import annotations

import os
import re
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

from derive.check.collect import collect
from derive.check.files import decoded, lines_checked, read_text
from derive.check.frontmatter import split_front_matter
from derive.check.item import Item, Setting
from derive.check.jsonl import claims_of_lines
from derive.check.markdown import scan_markdown
from derive.check.notation import with_front_matter
from derive.check.notebook import cells, events_of
from derive.check.tex import scan_tex
from derive.claim import Claim
from derive.errors import InputError

__all__ = ["STDIN", "is_file", "items_of", "items_of_claims", "items_of_stdin"]

STDIN = "-"
READERS = {
    ".md": "markdown", ".markdown": "markdown", ".qmd": "markdown", ".rmd": "markdown", ".txt": "markdown",
    ".tex": "tex", ".ltx": "tex", ".ipynb": "notebook", ".jsonl": "jsonl",
}  # fmt: skip
NAMES = (".md", ".tex", ".ipynb", ".jsonl")
TEX = re.compile(r"\\documentclass|\\begin\{document\}|\\section\*?\{|\\usepackage")
DISPLAY = re.compile(
    r"\$\$|\\\[|^[ \t>]*(?:```|~~~|:::)|\\begin\{(?:equation|align|gather|multline)\*?\}", re.MULTILINE
)


def is_file(argument: str) -> bool:
    """Whether an argument means a file: it exists, or its name ends like that of a document."""
    return argument.lower().endswith(NAMES) or os.path.lexists(argument)


def items_of(path: str, setting: Setting) -> list[Item]:
    """Return the claims of a file.

    Raises:
        InputError: it cannot be read, or is no document.
    """
    kind = READERS.get(Path(path).suffix.lower())
    if kind is None and os.path.isdir(path):
        raise InputError(f"{path}: expected a file, got a folder; name the files in it")
    if kind is None:
        raise InputError(f"{path}: expected a file that ends in {', '.join(NAMES)}, got another; rename it")
    return _of_text(read_text(Path(path)), kind, path, setting)


def items_of_stdin(data: bytes, setting: Setting) -> list[Item]:
    """Return the claims of what stands on standard input: a document of any kind, or claims line by line.

    Raises:
        InputError: too large, not UTF-8, or a broken notebook.
    """
    text = decoded(data, "standard input")
    kind = _guessed(text)
    if kind:
        return _of_text(text, kind, STDIN, setting)
    whole = "\\begin" in text or "\\\\" in text
    lines = [(1, text)] if whole else [(i, line) for i, line in enumerate(text.split("\n"), 1)]
    claims = [(i, latex.strip()) for i, latex in lines if latex.strip()]
    return items_of_claims([latex for _, latex in claims], setting, STDIN, [i for i, _ in claims])


def items_of_claims(
    claims: Sequence[str], setting: Setting, file: str = "", lines: Sequence[int] = (), start: int = 0
) -> list[Item]:
    """Return claims that stand by themselves, numbered u1, u2, ..."""
    s = setting
    return [
        Item(Claim(latex, s.theory, s.assume, s.scalar, f"u{start + i + 1}", file, lines[i] if lines else 0), s, True)
        for i, latex in enumerate(claims)
    ]


def _guessed(text: str) -> str:
    """Return the kind of a text by what it looks like; nothing if it holds claims alone."""
    if text.lstrip().startswith("{") and '"' in text:
        return "notebook" if '"cells"' in text and not text.lstrip().startswith('{"latex"') else "jsonl"
    if TEX.search(text):
        return "tex"
    return "markdown" if DISPLAY.search(text) or "<!-- derive:" in text or text.startswith("---\n") else ""


def _of_text(text: str, kind: str, file: str, setting: Setting) -> list[Item]:
    if kind == "jsonl":
        return claims_of_lines(text, file, setting)
    if kind == "notebook":
        return _of_notebook(text, file, setting)
    lines_checked(text, file)
    setting = _with_macros(setting, text)
    if kind == "tex":
        return collect(list(scan_tex(text)), file, setting)[0]
    setting, body = _with_head(setting, text, file)
    events = scan_markdown(text[body:], text.count("\n", 0, body) + 1)
    return collect(list(events), file, setting)[0]


def _of_notebook(text: str, file: str, setting: Setting) -> list[Item]:
    items: list[Item] = []
    for cell in cells(text, file):
        if cell.number == 1 and cell.kind in ("raw", "markdown"):
            setting, _ = _with_head(setting, cell.text, file)
        if cell.kind == "markdown":
            lines_checked(cell.text, f"{file}: cell {cell.number}")
            setting = _with_macros(setting, cell.text)
            found, setting = collect(events_of(cell), file, setting, f"c{cell.number}.")
            items += found
    return items


def _with_macros(setting: Setting, text: str) -> Setting:
    if "\\newcommand" not in text and not re.search(r"\\(?:def\s*\\|renew|provide|DeclareMath)", text):
        return setting
    from derive.latex.macros import definitions

    return replace(setting, macros={**setting.macros, **definitions(text)})


def _with_head(setting: Setting, text: str, file: str) -> tuple[Setting, int]:
    """Return the setting with what the head of a document says, and where its body begins."""
    try:
        data, body = split_front_matter(text)
        return with_front_matter(setting, data, Path(file).parent), body
    except InputError as error:
        raise InputError(f"{file}: {error}") from None
