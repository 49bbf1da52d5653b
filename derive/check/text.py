"""The report for readers: one line a claim that tools can follow (file:line), and below it what was understood."""

from __future__ import annotations

from collections.abc import Iterator

from derive.check.result import ERROR, WORDS, Report, Result
from derive.claim import Answer

__all__ = ["complaints", "summary", "text_report"]

LONGEST = 300  # characters of one value


def text_report(report: Report) -> str:
    """Return the whole report."""
    told: set[tuple[str, str]] = set()  # a guess is told once for each file
    blocks: list[str] = []
    for result in report.results:
        guess = (result.claim.file, result.guessed)
        blocks.append("\n".join(_block(result, "" if guess in told else result.guessed)))
        told.add(guess)
    return "\n\n".join([*blocks, summary(report)])


def summary(report: Report) -> str:
    """Return the last line: how many claims got each word."""
    total, counts = len(report.results), report.counts
    if not total:
        return "no claims"
    words = [f"{counts[w]} {w}{'s' * (w == ERROR and counts[w] > 1)}" for w in WORDS if counts[w]]
    return f"{total} {'claim' if total == 1 else 'claims'}: {', '.join(words)}"


def complaints(report: Report) -> list[str]:
    """Return what belongs on standard error: a line for each file, and one for all claims that cannot be read."""
    unread = [r for r in report.results if r.verdict == ERROR]
    if not unread:
        return list(report.errors)
    first = unread[0]
    place = f"{first.claim.file}:{first.claim.line}: " if first.claim.file else ""
    more = f" (and {len(unread) - 1} more)" if len(unread) > 1 else ""
    return [*report.errors, f"{place}{first.message}{more}"]


def _block(result: Result, guessed: str) -> Iterator[str]:
    yield _head(result)
    if result.verdict == ERROR:
        yield from (f"    {line}" for line in result.excerpt.split("\n") if result.excerpt)
        return
    yield from _row("read as", result.read_as)
    yield from _row("shapes", ", ".join(f"{name}: {shape}" for name, shape in result.shapes.items()))
    yield from _row("guessed", guessed)
    if result.answer:
        yield from _reasons(result.answer)


def _head(result: Result) -> str:
    """Return the line with place and verdict: notes.md:12: (3) refuted (exact instance), luenberger-dt."""
    claim = result.claim
    place = f"{claim.file}:{claim.line}: " if claim.file else ""
    name = f"({claim.name}) " if claim.name else f"{claim.id} "
    if result.verdict == ERROR:
        return f"{place}{name}error: {result.message}"
    method = f" ({result.answer.method})" if result.answer and result.answer.method else ""
    theory = f", {claim.theory}" if claim.theory else ""
    return f"{place}{name}{result.verdict}{method}{theory}"


def _reasons(answer: Answer) -> Iterator[str]:
    """Iterate over the lines that say why."""
    yield from _row("at", str(answer.counterexample) if answer.counterexample else "")
    if answer.nearest:
        yield from _row("nearest", f"{answer.nearest.latex}   ({answer.nearest.edit}; proved)")
    yield from _row("uses", ", ".join(answer.hypotheses_used))
    yield from _row("not used", ", ".join(answer.hypotheses_not_needed))
    yield from _row("added", ", ".join(answer.hypotheses_added))
    yield from _row("given", ", ".join(answer.assumed))
    for name, example in answer.needed.items():
        yield from _row("needs", f"{name}: without it {example}")
    for note in answer.notes:
        yield from _row("note", note)


def _row(name: str, value: str) -> Iterator[str]:
    if value:
        value = " ".join(value.split())
        yield f"    {name:<8} {value if len(value) <= LONGEST else value[:LONGEST] + '...'}"
