r"""Macros of a document: ``\newcommand``, ``\def``, ``\DeclareMathOperator`` and the tables of MyST and KaTeX.

A macro is (number of arguments, body). Expansion works on tokens, never on text; it is bounded in steps and in
tokens, and a macro that leads back to itself is refused.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace

from derive.latex.tokens import MAX_TOKENS, Token, Unreadable, tokenise

Macro = tuple[int, str]
MAX_WORK = 20_000  # tokens moved in the expansion of one formula
NAME = r"\s*\{?\s*\\(?P<name>[A-Za-z]+)\s*\}?\s*"
COMMAND = re.compile(rf"\\(?:re|provide)?newcommand\*?{NAME}(?:\[(?P<count>[0-9])\])?(?P<default>\s*\[)?")
OPERATOR = re.compile(rf"\\DeclareMathOperator\*?{NAME}")
DEFINITION = re.compile(r"\\def\s*\\(?P<name>[A-Za-z]+)(?P<parameters>(?:#[1-9])*)\s*")
MAX_BODY = 2_000


def definitions(text: str) -> dict[str, Macro]:
    r"""Collect the macros that a document defines; those with a default argument are left out."""
    found: dict[str, Macro] = {}
    for match in COMMAND.finditer(text):
        body = braced(text, match.end())
        if body is not None and not match["default"]:
            found[match["name"]] = int(match["count"] or 0), body
    for match in DEFINITION.finditer(text):
        body = braced(text, match.end())
        if body is not None:
            found[match["name"]] = len(match["parameters"]) // 2, body
    for match in OPERATOR.finditer(text):
        body = braced(text, match.end())
        if body is not None:
            found[match["name"]] = 0, rf"\operatorname{{{body}}}"
    return found


def table(entries: Mapping[str, object]) -> dict[str, Macro]:
    r"""Read a table of macros as MyST, MathJax and KaTeX keep it: ``{"\\RR": "\\mathbb{R}", "norm": ["\\|#1\\|", 1]}``.

    Entries that are neither text nor a list of text and number are left out.
    """
    found: dict[str, Macro] = {}
    for name, entry in entries.items():
        body, count = entry, None
        if isinstance(entry, Sequence) and not isinstance(entry, str) and entry:
            body, count = entry[0], entry[1] if len(entry) > 1 else None
        if isinstance(body, str) and re.fullmatch(r"\\?[A-Za-z]+", name):
            numbers = [int(n) for n in re.findall(r"#([1-9])", body)]
            found[name.lstrip("\\")] = count if isinstance(count, int) else max(numbers, default=0), body
    return found


def braced(text: str, position: int) -> str | None:
    """Return what stands between the braces that open at a position, or None."""
    if text[position : position + 1] != "{":
        return None
    depth = 0
    for i in range(position, min(len(text), position + MAX_BODY)):
        if text[i] in "{}" and text[i - 1] != "\\":
            depth += 1 if text[i] == "{" else -1
            if not depth:
                return text[position + 1 : i]
    return None


def expand(tokens: list[Token], macros: Mapping[str, Macro]) -> list[Token]:
    """Put the bodies of macros in the place of their uses; each token of a body stands where the macro was used.

    Raises:
        Unreadable: a macro leads back to itself, lacks an argument, or the formula grows without bound.
    """
    bodies: dict[str, list[Token]] = {}
    rest, out, work = list(reversed(tokens)), list[Token](), 0
    while rest:
        token = rest.pop()
        if token.text not in macros or not (
            token.kind == "command" or (token.kind == "letter" and len(token.text) > 1)
        ):
            out.append(token)
            continue
        if token.text not in bodies:
            _refuse_recursion(token, macros)
            bodies[token.text] = _tokens(token, macros[token.text][1])
        arguments = [_argument(token, rest) for _ in range(macros[token.text][0])]
        body = [*_filled(token, bodies[token.text], arguments)]
        rest.extend(reversed(body))
        work += 1 + len(body) + sum(map(len, arguments))
        if work > MAX_WORK:
            raise Unreadable(token.start, "macros that end", f"\\{token.text}, which grows without bound")
        if len(out) > MAX_TOKENS:
            raise Unreadable(token.start, f"a formula of at most {MAX_TOKENS} letters and signs", "one more")
    return out


def _tokens(macro: Token, body: str) -> list[Token]:
    try:
        return tokenise(body)
    except Unreadable as error:
        raise Unreadable(macro.start, error.expected, f"{error.got} in \\{macro.text}") from None


def _argument(macro: Token, rest: list[Token]) -> list[Token]:
    """Take the next token, or the next group without its braces."""
    if not rest:
        raise Unreadable(macro.end, f"an argument of \\{macro.text}", "the end of the formula")
    token = rest.pop()
    if token.text != "{":
        return [token]
    taken, depth = list[Token](), 1
    while rest:
        token = rest.pop()
        depth += {"{": 1, "}": -1}.get(token.text, 0)
        if not depth:
            return taken
        taken.append(token)
    raise Unreadable(macro.end, f"a closing brace of the argument of \\{macro.text}", "the end of the formula")


def _filled(macro: Token, body: list[Token], arguments: list[list[Token]]) -> Iterator[Token]:
    for token in body:
        if token.kind != "parameter":
            yield replace(token, start=macro.start, end=macro.end)
        elif int(token.text[1]) <= len(arguments):
            yield from arguments[int(token.text[1]) - 1]
        else:
            raise Unreadable(macro.start, f"{len(arguments)} arguments in \\{macro.text}", f"its use of {token.text}")


def _refuse_recursion(macro: Token, macros: Mapping[str, Macro]) -> None:
    """Follow the names that bodies mention, and refuse a way back to the macro."""
    reached, waiting = set[str](), [macro.text]
    while waiting:
        for name in re.findall(r"\\([A-Za-z]+)", macros[waiting.pop()][1]):
            if name == macro.text:
                raise Unreadable(macro.start, "a macro that ends", f"\\{name}, which leads back to itself")
            if name in macros and name not in reached:
                reached.add(name)
                waiting.append(name)
