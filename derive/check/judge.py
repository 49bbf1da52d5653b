"""One claim from its LaTeX to its verdict: read, understand, decide."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import replace
from typing import TYPE_CHECKING, Any

from derive.check.item import Item, Setting
from derive.check.result import ERROR, Result
from derive.claim import Answer, Claim, Verdict
from derive.errors import InputError

if TYPE_CHECKING:
    from derive.interpret import Statement
    from derive.latex.syntax import Display

__all__ = ["Decide", "judge", "read_assumed", "read_item", "unreadable"]

Decide = Callable[..., Answer]
NO_THEORY = (
    "no theory is named and none can be guessed; name it with theory=KEY in a comment of the document, or --theory KEY"
)
SHARE = 0.9  # of the time for a claim, for its decision


def judge(item: Item, seconds: float = 10.0, decide: Decide | None = None) -> Result | None:
    """Return what is said of a claim; None if it is none: a display that relates nothing.

    Args:
        item: the claim, its letters and macros.
        seconds: bound on the time.
        decide: how a statement is decided; by default ``derive.decide.decide``.
    """
    start = time.perf_counter()
    result = _judge(item, seconds * SHARE, decide)
    return replace(result, seconds=round(time.perf_counter() - start, 4)) if result else None


def _judge(item: Item, seconds: float, decide: Decide | None) -> Result | None:
    from derive.interpret import Misfit, echo, shapes

    claim, display = item.claim, None
    try:
        display = read_item(item, claim.latex)
        if not (item.explicit or relates(display)):
            return None
        if not claim.theory:
            return Result(claim, "undecided", Answer(Verdict.undecided, notes=(NO_THEORY,)))
        statement = _understood(item, display)
        read_as, found_shapes = echo(statement), shapes(statement)
        answer = _decided(statement, seconds, decide, explain=not claim.file)
    except Misfit as error:
        return Result(claim, "refuted", _misfit(item, display, str(error)))
    except InputError as error:
        return _error(claim, error)
    answer = replace(answer, certificate=_signed(answer, item, statement))
    return Result(claim, str(answer.verdict), answer, read_as, found_shapes)


def _misfit(item: Item, display: Display | None, message: str) -> Answer:
    """Return the answer on a formula whose shapes do not fit, with the nearest true one."""
    from derive.decide.misfit import nearest_fitting
    from derive.theory.claims import claim_theory

    found = None
    if display is not None and not item.claim.scalar:
        setting = item.setting
        theory, given = claim_theory(item.claim.theory), read_assumed(setting)
        found = nearest_fitting(display, theory, assume=given, notation=setting.notation)
    nearest, why = found or (None, "")
    return Answer(Verdict.refuted, "types", nearest=nearest, notes=tuple(filter(None, (message, why))))


def unreadable(item: Item) -> Result | None:
    """Return the result of a claim that cannot even be read; None if it can."""
    if item.message:
        return Result(item.claim, ERROR, message=_one_line(item.message))
    try:
        read_item(item, item.claim.latex)
    except InputError as error:
        return _error(item.claim, error)
    return None


def read_item(item: Item, latex: str) -> Display:
    """Read a formula with the macros of its document.

    Raises:
        Unreadable: it is no formula.
    """
    from derive.latex.grammar import read

    return read(latex, macros=item.setting.macros)


def relates(display: Display) -> bool:
    """Whether a display states a relation."""
    from derive.latex.syntax import Related, walk

    return any(isinstance(node, Related) for s in display.statements for node in walk(s))


def _understood(item: Item, display: Display) -> Statement:
    from derive.interpret import understand
    from derive.theory.claims import claim_theory

    return understand(
        display,
        claim_theory(item.claim.theory),
        assume=read_assumed(item.setting),
        scalar=item.claim.scalar,
        notation=item.setting.notation,
    )


def read_assumed(setting: Setting) -> list[Display]:
    """Read what is assumed.

    Raises:
        InputError: one of the assumptions cannot be read; says where it stands.
    """
    found: list[Display] = []
    for latex, origin in zip(setting.assume, setting.origins, strict=True):
        from derive.latex.grammar import read

        try:
            found.append(read(latex, macros=setting.macros))
        except InputError as error:
            place = f" ({origin})" if origin else ""
            raise InputError(f"assume {latex[:60]!r}{place}: {error}") from None
    return found


def _decided(statement: Statement, seconds: float, decide: Decide | None, explain: bool = False) -> Answer:
    """Decide a statement; what fails by itself leaves the claim undecided, and says so.

    A claim that stands by itself is told which of the hypotheses it cannot do without, by an instance each.
    """
    from derive.decide import decide as usual

    try:
        return decide(statement, seconds=seconds) if decide else usual(statement, seconds=seconds, explain=explain)
    except InputError:
        raise
    except MemoryError:
        return Answer(Verdict.undecided, notes=("the decision needs more memory than there is",))
    except Exception as error:
        failed = f"the decision failed ({type(error).__name__}: {' '.join(str(error).split())[:200]}); please report it"
        return Answer(Verdict.undecided, notes=(failed,))


def _error(claim: Claim, error: InputError) -> Result:
    """Return the result of a claim that cannot be read, with the place if there is one."""
    from derive.latex.tokens import Unreadable, caret

    if not isinstance(error, Unreadable):
        return Result(claim, ERROR, message=_one_line(str(error)))
    line = claim.line + claim.latex.count("\n", 0, error.column) if claim.line else 0
    return Result(replace(claim, line=line), ERROR, message=_one_line(str(error)), excerpt=caret(claim.latex, error))


def _one_line(message: str) -> str:
    text = " ".join(message.split())
    return text if len(text) <= 400 else f"{text[:400]}..."


def _signed(answer: Answer, item: Item, statement: Statement) -> dict[str, Any] | None:
    """Return the certificate with the text of the claim.

    Certificates are replayed without macros and notation: where the claim uses them, its canonical LaTeX takes the
    place of what was typed, if it reads the same; otherwise there is no certificate on file.
    """
    if answer.certificate is None:
        return None
    from derive.decide.certificate import signed

    if not (item.setting.macros or item.setting.notation):
        return signed(answer.certificate, item.claim)
    plain = replace(item, setting=replace(item.setting, macros={}, notation={}))
    for latex in dict.fromkeys((item.claim.latex, _echo(statement))):
        try:
            again = _understood(plain, read_item(plain, latex))
        except InputError:
            continue
        if again.equations == statement.equations and again.assumed == statement.assumed:
            return signed(answer.certificate, replace(item.claim, latex=latex))
    return None


def _echo(statement: Statement) -> str:
    from derive.interpret import echo

    return echo(statement)
