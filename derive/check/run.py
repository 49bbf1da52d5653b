"""A run of the checker: from arguments to a report."""

from __future__ import annotations

import os
import sys
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import replace
from os import PathLike, fspath

from derive.check.documents import STDIN, is_file, items_of, items_of_claims, items_of_stdin
from derive.check.files import LIMIT
from derive.check.item import Item, Setting
from derive.check.judge import Decide, judge, read_assumed, unreadable
from derive.check.result import Report
from derive.claim import Claim
from derive.errors import InputError

__all__ = ["check", "usable_cores"]

Argument = str | Claim | PathLike[str]


def check(
    claims: Argument | Iterable[Argument],
    *,
    theory: str = "",
    assume: Iterable[str] = (),
    scalar: bool = False,
    timeout: float = 10.0,
    jobs: int = 0,
    progress: Callable[[int, int], None] | None = None,
    decide: Decide | None = None,
) -> Report:
    r"""Check claims and documents.

    Args:
        claims: a claim in LaTeX, a file, or several of both; "-" is standard input. A text is a file if one of that
            name exists or if it ends in .md, .tex, .ipynb or .jsonl.
        theory: in which claims are read that name none; guessed if empty.
        assume: relations in LaTeX that are given.
        scalar: read every dimension as 1.
        timeout: seconds for each claim.
        jobs: how many processes decide; 0 for this one, which cannot be ended when a claim takes too long.
        progress: told how many claims are done, and of how many.
        decide: how a statement is decided, in this process; by default ``derive.decide.decide``.

    Returns:
        A report with one result a claim, in order.

    Raises:
        InputError: an unknown theory, an assumption that cannot be read.

    Example:
        >>> import derive
        >>> str(derive.check(r"P_k = P_k^\top", theory="luenberger-dt").results[0].verdict)
        'proved'
    """
    arguments = [claims] if isinstance(claims, str | Claim | PathLike) else list(claims)
    setting = _setting(theory, tuple(assume), scalar)
    items, errors = _collected(arguments, setting)
    return _report(items, errors, timeout, jobs, progress or (lambda done, of: None), decide)


def _setting(theory: str, assume: tuple[str, ...], scalar: bool) -> Setting:
    """Check what holds for all claims."""
    from derive.theory.claims import THEORIES

    if theory and theory not in THEORIES:
        raise InputError(f"theory: expected {', '.join(THEORIES)}, got {theory!r}")
    setting = Setting(theory, assume, ("",) * len(assume), scalar)
    read_assumed(setting)
    return setting


def _collected(arguments: Sequence[Argument], setting: Setting) -> tuple[list[Item], list[str]]:
    """Return the claims of all arguments, and what is wrong with files that hold none."""
    items, errors, plain = list[Item](), list[str](), 0
    for argument in arguments:
        try:
            if isinstance(argument, Claim):
                items.append(_of_claim(argument, setting))
            elif not isinstance(argument, str) or is_file(argument):
                items += items_of(fspath(argument), setting)
            elif argument == STDIN:
                items += items_of_stdin(sys.stdin.buffer.read(LIMIT + 1), setting)
            else:
                items += items_of_claims([argument], setting, start=plain)
                plain += 1
        except InputError as error:
            errors.append(str(error))
    return items, errors


def _of_claim(claim: Claim, setting: Setting) -> Item:
    """Return a claim with what holds for all."""
    setting = replace(setting, theory=claim.theory or setting.theory, scalar=claim.scalar or setting.scalar)
    for latex in claim.assume:
        setting = setting.assuming(latex, "")
    return Item(replace(claim, theory=setting.theory, assume=setting.assume, scalar=setting.scalar), setting, True)


def _report(
    items: Sequence[Item],
    errors: Sequence[str],
    timeout: float,
    jobs: int,
    progress: Callable[[int, int], None],
    decide: Decide | None,
) -> Report:
    from derive.check.guessing import guessed, justified

    pairs = guessed(items)
    found = [unreadable(item) for item, _ in pairs]
    left = [item for (item, _), known in zip(pairs, found, strict=True) if known is None]
    if jobs and decide is None and left:
        from derive.check.pool import judge_side_by_side

        judged = judge_side_by_side(left, timeout, jobs, progress)
    else:
        judged = [judge(item, timeout, decide) for item in counted(left, progress)]
    rest = iter(judged)
    results = [
        replace(r, guessed=why)
        for known, (_, why) in zip(found, pairs, strict=True)
        if (r := known or next(rest)) is not None
    ]
    return Report(tuple(justified(results)), tuple(errors))


def counted(items: Sequence[Item], progress: Callable[[int, int], None]) -> Iterator[Item]:
    """Iterate over claims, telling how many are done."""
    for done, item in enumerate(items):
        yield item
        progress(done + 1, len(items))


def usable_cores() -> int:
    """Return how many cores this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1
