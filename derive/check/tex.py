r"""Formulas of LaTeX documents: displays, inline mathematics, and comments that steer.

Passed over: comments, ``verbatim`` and its kin, ``\verb``, ``\iffalse ... \fi``, and what follows ``\end{document}``.
Nothing is included or executed.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from functools import cache

from derive.check.formula import Broken, Event, Formula, Places, Steer
from derive.check.rows import NUMBERED_ROWS, ONE_EQUATION

__all__ = ["DIRECTIVE", "environment_end", "scan_tex"]

DISPLAYS = "|".join(sorted(NUMBERED_ROWS | ONE_EQUATION))
LITERAL = "verbatim|Verbatim|lstlisting|minted|comment|filecontents|tikzpicture"
TOKEN = re.compile(
    r"(?P<comment>%(?P<said>[^\n]*))"
    rf"|(?P<begin>\\begin\{{(?P<environment>{DISPLAYS})(?P<star>\*?)\}})"
    rf"|(?P<literal>\\begin\{{(?P<kind>{LITERAL})(?P<mark>\*?)\}})"
    r"|(?P<verb>\\verb\*?(?P<bar>[^A-Za-z\s*]))|(?P<false>\\iffalse(?![A-Za-z]))|(?P<stop>\\end\{document\})"
    r"|(?P<bracket>\\\[)|(?P<round>\\\()|(?P<escape>\\.)|(?P<display>\$\$)|(?P<inline>\$)",
    re.DOTALL,
)
ENDS = {
    "bracket": re.compile(r"(?:[^\\%]++|%[^\n]*+|\\[^\]])*+(?P<end>\\\])", re.DOTALL),
    "round": re.compile(r"(?:[^\\%]++|%[^\n]*+|\\[^)])*+(?P<end>\\\))", re.DOTALL),
    "display": re.compile(r"(?:[^\\$%]++|%[^\n]*+|\\.|\$(?!\$))*+(?P<end>\$\$)", re.DOTALL),
    "inline": re.compile(r"(?:[^\\$%]++|%[^\n]*+|\\.)*+(?P<end>\$)", re.DOTALL),
}
DIRECTIVE = re.compile(r"\s*derive:\s*(.*)", re.DOTALL)
INSIDE = re.compile(r"(?<!\\)%+\s*derive:\s*(given|claim|skip)\b")
LETTER = re.compile(r"\S")
Reading = tuple[Sequence[Event], int]  # what is found, and where reading goes on


def scan_tex(text: str, first: int = 1) -> Iterator[Event]:
    """Iterate over the formulas of a text that begins at line ``first``, and over the comments that steer."""
    places = Places(text, first)
    readers = {"comment": _comment, "begin": _begin, "literal": _literal, "verb": _verb, "false": _false}
    position = 0
    while match := TOKEN.search(text, position):
        kind = match.lastgroup or ""
        if kind == "stop":
            break
        read = readers.get(kind, _delimited if kind in ENDS else _escape)
        found, position = read(text, match, places)
        yield from found


def _comment(text: str, match: re.Match[str], places: Places) -> Reading:
    found = DIRECTIVE.match(match["said"].lstrip("%"))
    alone = not text[places.start(match.start()) : match.start()].strip()
    return [Steer(found[1].strip(), places.line(match.start()), alone)] if found else [], match.end()


def _delimited(text: str, match: re.Match[str], places: Places) -> Reading:
    """Return the formula between two delimiters."""
    kind = match.lastgroup or ""
    end = ENDS[kind].match(text, match.end())
    if end:
        displayed = kind in ("bracket", "display")
        return [_formula(text, match.end(), end.start("end"), places, displayed)], end.end()
    message = f"expected what ends the formula that {match[0]} begins, got the end of the text"
    return [Broken(message, places.line(match.start()))], len(text)


def _begin(text: str, match: re.Match[str], places: Places) -> Reading:
    stop = environment_end(text, match)
    if stop is not None:
        return [_formula(text, match.start(), stop, places, match["environment"] != "math")], stop
    message = f"expected \\end{{{match['environment']}}}, got the end of the text"
    return [Broken(message, places.line(match.start()))], len(text)


def _formula(text: str, inner: int, stop: int, places: Places, displayed: bool) -> Formula:
    letter = LETTER.search(text, inner)
    start = letter.start() if letter and letter.start() < stop else inner
    asked = INSIDE.search(text, start, stop)
    return Formula(text[start:stop].rstrip(), places.line(start), "", displayed, asked[1] if asked else "")


def environment_end(text: str, begin: re.Match[str]) -> int | None:
    r"""Return where the environment that a match begins ends, its ``\end`` included."""
    name = begin["environment"] + begin["star"]
    depth, position = 0, begin.start()
    while piece := _border(name).search(text, position):
        depth += 1 if piece[1] == "begin" else -1
        position = piece.end()
        if depth == 0:
            return position
    return None


@cache
def _border(name: str) -> re.Pattern[str]:
    return re.compile(rf"\\(begin|end)\{{{re.escape(name)}\}}")


# ------------------------------------------------------------------------------------------------ passed over
def _escape(text: str, match: re.Match[str], places: Places) -> Reading:
    return (), match.end()


def _literal(text: str, match: re.Match[str], places: Places) -> Reading:
    end = text.find(f"\\end{{{match['kind']}{match['mark']}}}", match.end())
    return (), end if end >= 0 else len(text)


def _verb(text: str, match: re.Match[str], places: Places) -> Reading:
    end, line = text.find(match["bar"], match.end()), places.end(match.end())
    return (), end + 1 if 0 <= end < line else match.end()


def _false(text: str, match: re.Match[str], places: Places) -> Reading:
    end = text.find("\\fi", match.end())
    return (), end if end >= 0 else len(text)
