r"""Formulas of Markdown in the dialects that people write: GitHub, MyST, Quarto, Obsidian, pandoc.

Displayed are ``$$ ... $$``, ``\[ ... \]`` on lines of their own, environments such as ``\begin{align}``, fences
```` ```math ```` and the directive ``{math}``; everything inside code, comments and HTML blocks of code is passed over.
One pass from left to right, linear in the length of the text.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from itertools import pairwise

from derive.check.formula import Broken, Event, Formula, Places, Steer
from derive.check.rows import NUMBERED_ROWS, ONE_EQUATION
from derive.check.tex import DIRECTIVE, environment_end, scan_tex

__all__ = ["scan_markdown"]

PREFIX = r"(?P<prefix>[ \t]*(?:>[ \t]?)*(?:(?:[-*+]|\d{1,9}[.)])[ \t]+)?)"
TOKEN = re.compile(
    rf"^{PREFIX}(?P<fence>`{{3,}}(?=[^`\n]*$)|~{{3,}}|:{{3,}})(?P<info>[^\n]*)$"
    r"|(?P<comment><!--)|(?P<obsidian>%%)|(?P<html><(?P<tag>pre|script|style|textarea|code)\b)"
    r"|(?P<code>`+)|(?P<bracket>\\\[)"
    rf"|(?P<begin>\\begin\{{(?P<environment>{'|'.join(sorted(NUMBERED_ROWS | ONE_EQUATION))})(?P<star>\*?)\}})"
    r"|(?P<escape>\\.)|(?P<display>\$\$)|(?P<inline>\$)",
    re.MULTILINE | re.IGNORECASE,
)
MATH_END = re.compile(r"(?:[^\\$]++|\\.|\$(?!\$))*+(?P<end>\$\$)", re.DOTALL)
INLINE_END = re.compile(r"(?:[^\\$\n`]++|\\.|\n(?![ \t]*\n))*+(?P<end>\$)|`[^`\n]++`(?P<github>\$)", re.DOTALL)
GOES_ON = re.compile(
    r"[ \t]*\n(?:[ \t>]*\n)?[ \t>]*\$\$(?=\s*(?:[-=+−<>]|\\(?:leq?|geq?|preceq|succeq|equiv)(?![A-Za-z])))"
)
BRACKET_END = re.compile(r"\\\]")
BLANK_LINE = re.compile(r"\n[ \t]*\n")
OPTIONS = re.compile(
    r"\s*?(?:\n[ \t]*:[\w-]+:[^\n]*|\n[ \t]*---[ \t]*\n(?:[^\n]*\n){0,20}?[ \t]*---[ \t]*(?=\n))+", re.DOTALL
)
LABEL = re.compile(r"(?:label|name):[ \t]*(?P<name>[^\s]+)")
NUMBER_BEFORE = re.compile(r"\((\d+(?:\.\d+)*[a-z]?)\)[ \t]*\Z")
TARGET_ABOVE = re.compile(r"(?:\A|\n)[ \t>]*\((?P<name>[\w:.\-]+)\)=[ \t]*\n[ \t>]*\Z")
NAME_AFTER = re.compile(
    r"[ \t]*[.,;]?[ \t]*(?:\{[^}\n]{0,200}?#(?P<id>[\w:.\-]+)[^}\n]{0,200}\}|\((?P<label>[\w:.\-]+)\)[ \t]*$"
    r"|(?:\n[ \t>]*)?\^(?P<block>[\w\-]+)[ \t]*$|\n[ \t>]*\((?P<number>\d+(?:\.\d+)*[a-z]?)\)[ \t]*$)",
    re.MULTILINE,
)
LIST_ITEM = re.compile(r"[ ]{0,3}(?:[-*+]|\d{1,9}[.)]|\[\^[^\]\n]*\]:|:)[ \t]+")
TEXT_DIRECTIVE = re.compile(
    r"\{(?:prf:[\w-]+|proof:[\w-]+|admonition|attention|aside|card|caution|danger|definition|div|dropdown|epigraph"
    r"|error|example|exercise[\w-]*|grid[\w-]*|hint|important|lemma|margin|note|remark|seealso|sidebar|solution[\w-]*"
    r"|tab-[\w]+|theorem|tip|topic|warning)\}"
)
NEAR = 300  # how far before a display its name may stand

Reading = tuple[Sequence[Event], int]  # what is found, and where reading goes on


def scan_markdown(text: str, first: int = 1) -> Iterator[Event]:
    """Iterate over the formulas of a text that begins at line ``first``, and over the comments that steer."""
    return Scanner(text, first).events()


class Scanner:
    """Reads one text; ``open_fences`` are the directives whose content is Markdown."""

    def __init__(self, text: str, first: int):
        self.text, self.places = text, Places(text, first)
        self.open_fences: list[str] = []
        self.unclosed: set[str] = set()  # runs of backticks that nothing closes
        self.code = indented_code(text)

    def events(self) -> Iterator[Event]:
        """Iterate over what the text holds."""
        readers = {"info": self._fence, "comment": self._comment, "obsidian": self._obsidian, "html": self._html,
                   "code": self._code, "bracket": self._bracket, "begin": self._begin, "escape": self._escape,
                   "display": self._display, "inline": self._inline}  # fmt: skip
        position = 0
        while match := TOKEN.search(self.text, position):
            if self.code[self.places.row(match.start())]:
                position = self.places.end(match.start())
            else:
                found, position = readers[match.lastgroup or ""](match)
                yield from found

    # ------------------------------------------------------------------------------------------- passed over
    def _escape(self, match: re.Match[str]) -> Reading:
        return (), match.end()

    def _html(self, match: re.Match[str]) -> Reading:
        end = re.compile(rf"</{match['tag']}\s*>", re.IGNORECASE).search(self.text, match.end())
        return (), end.end() if end else len(self.text)

    def _code(self, match: re.Match[str]) -> Reading:
        run = match["code"]
        end = None if run in self.unclosed else re.compile(rf"(?<!`){run}(?!`)").search(self.text, match.end())
        if not end:
            self.unclosed.add(run)
        return (), end.end() if end and not BLANK_LINE.search(self.text, match.end(), end.end()) else match.end()

    def _comment(self, match: re.Match[str]) -> Reading:
        end = self.text.find("-->", match.end())
        stop = end if end >= 0 else len(self.text)
        return self._steered(match.start(), match.end(), stop, min(stop + 3, len(self.text)))

    def _obsidian(self, match: re.Match[str]) -> Reading:
        end = self.text.find("%%", match.end())
        inside = self.text[match.end() : end]
        if end < 0 or ("\n" in inside and not self._alone(match.start(), match.end())):
            return (), match.end()
        return self._steered(match.start(), match.end(), end, end + 2)

    def _steered(self, start: int, inner: int, stop: int, end: int) -> Reading:
        found = DIRECTIVE.match(self.text[inner:stop].strip())
        return [Steer(found[1].strip(), self.places.line(start), self._alone(start, end))] if found else [], end

    def _alone(self, start: int, end: int) -> bool:
        """Whether nothing else stands on the lines of an extent."""
        before, after = self.text[self.places.start(start) : start], self.text[end : self.places.end(end)]
        return not before.strip(" \t>") and not after.strip()

    # ------------------------------------------------------------------------------------------- fences
    def _fence(self, match: re.Match[str]) -> Reading:
        mark, info = match["fence"], match["info"].strip()
        if not info and self.open_fences and mark.startswith(self.open_fences[-1]):
            self.open_fences.pop()
            return (), match.end()
        is_math = info == "math" or info.startswith("{math}")
        if not is_math and (mark[0] == ":" or TEXT_DIRECTIVE.match(info)):
            self.open_fences += [mark] if info else []
            return (), match.end()
        end = re.compile(rf"^[ \t>]*{mark}{mark[0]}*[ \t]*$", re.MULTILINE).search(self.text, match.end())
        stop, after = (end.start(), end.end()) if end else (len(self.text), len(self.text))
        if is_math:
            start = match.start("info") + match["info"].index("math") + len("math}" if "{" in info else "math")
            return list(self._of_fence(match.start(), start, stop, match["prefix"])), after
        if info in ("{=latex}", "{=tex}"):
            return list(scan_tex(self.text[match.end() : stop], self.places.line(match.end()))), after
        return (), after

    def _of_fence(self, fence: int, start: int, stop: int, prefix: str) -> Iterator[Formula]:
        """Iterate over the formulas of a fence; blank lines stand between them."""
        options = OPTIONS.match(self.text, start, stop)
        label = LABEL.search(options[0]) if options else TARGET_ABOVE.search(self.text, max(0, fence - NEAR), fence)
        start = options.end() if options else start
        ends = [m.start() for m in BLANK_LINE.finditer(self.text, start, stop)]
        extents = [(a, b) for a, b in pairwise([start, *ends, stop]) if self.text[a:b].strip()]
        for i, (a, b) in enumerate(extents):
            name = label["name"] + (f"-{i + 1}" if len(extents) > 1 else "") if label else ""
            yield self._formula(a, b, prefix, name)

    # ------------------------------------------------------------------------------------------- formulas
    def _inline(self, match: re.Match[str]) -> Reading:
        end = INLINE_END.match(self.text, match.end())
        inside = end[0][:-1] if end else ""
        if not end or not inside or inside != inside.strip() or self.text[end.end() : end.end() + 1].isdigit():
            return (), match.end()  # an amount of money
        return [Formula(inside.strip("`"), self.places.line(match.end()), displayed=False)], end.end()

    def _display(self, match: re.Match[str]) -> Reading:
        end = MATH_END.match(self.text, match.end())
        block = not self._before(match.start())[1]
        if end and (block or not BLANK_LINE.search(self.text, match.end(), end.end())):
            while (more := GOES_ON.match(self.text, end.end())) and (last := MATH_END.match(self.text, more.end())):
                end = last
            return self._displayed(match.start(), match.end(), end.start("end"), end.end())
        message = "expected $$ that ends the display, got the end of the text"
        return [Broken(message, self.places.line(match.start()))] if block else [], match.end()

    def _bracket(self, match: re.Match[str]) -> Reading:
        end = BRACKET_END.search(self.text, match.end())
        if self._before(match.start())[1] or not end:
            return (), match.end()
        after = self.text[end.end() : self.places.end(end.end())]
        link = after.startswith("(") and not after[1:2].isdigit()
        if link or (after.strip(" \t.,;") and not NAME_AFTER.match(self.text, end.end())):
            return (), match.end()
        return self._displayed(match.start(), match.end(), end.start(), end.end())

    def _begin(self, match: re.Match[str]) -> Reading:
        stop = environment_end(self.text, match)
        if stop is not None:
            return self._displayed(match.start(), match.start(), stop, stop)
        message = f"expected \\end{{{match['environment']}}}, got the end of the text"
        return [Broken(message, self.places.line(match.start()))], len(self.text)

    def _displayed(self, start: int, inner: int, stop: int, end: int) -> Reading:
        """Return the display between two positions, with the name that stands beside it."""
        prefix, _, number = self._before(start)
        after, above = NAME_AFTER.match(self.text, end), TARGET_ABOVE.search(self.text, max(0, start - NEAR), start)
        name = after[after.lastgroup or ""] if after else number or (above["name"] if above else "")
        return [self._formula(inner, stop, prefix, name)], after.end() if after else end

    def _formula(self, start: int, stop: int, prefix: str, name: str) -> Formula:
        """Return the formula in an extent, without the marks of a quotation around it."""
        latex = self.text[start:stop].replace("$$", "  ")
        if ">" in prefix:
            latex = re.sub(r"\n[ \t]*(?:>[ \t]?)+", "\n", latex)
        blank = latex[: len(latex) - len(latex.lstrip())].count("\n")
        return Formula(latex.strip(), self.places.line(start) + blank, name)

    def _before(self, position: int) -> tuple[str, str, str]:
        """Return what stands before a position on its line: a prefix, text, and a number such as (31.10)."""
        line = self.text[max(self.places.start(position), position - NEAR) : position]
        prefix = re.match(PREFIX, line)
        rest = line[prefix.end() if prefix else 0 :].strip()
        number = NUMBER_BEFORE.fullmatch(rest)
        return (prefix[0] if prefix else "", "", number[1]) if number else (prefix[0] if prefix else "", rest, "")


def indented_code(text: str) -> list[bool]:
    """Tell of each line whether it is code by its indentation: after a blank line, and not inside a list."""
    found: list[bool] = []
    blank, code, item = True, False, False
    for line in text.split("\n"):
        indented = line.startswith(("    ", "\t"))
        if not line.strip():
            found.append(False)
            blank = True
            continue
        code = indented and (code or blank) and not item
        item = bool(LIST_ITEM.match(line)) or (item and line[0] in " \t")
        found.append(code)
        blank = False
    return found
