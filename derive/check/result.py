"""What the checker says of claims: one result a claim, in the order of the claims."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping
from dataclasses import dataclass, field

from derive.claim import Answer, Claim

__all__ = ["ERROR", "WORDS", "Report", "Result"]

ERROR = "error"
WORDS = ("proved", "refuted", "supported", "undecided", ERROR)
EXIT_CODES = {ERROR: 2, "refuted": 1, "supported": 3, "undecided": 3}  # in the order of their weight


@dataclass(frozen=True)
class Result:
    """What is said of one claim.

    ``verdict`` is one of the four words or "error", with what is wrong in ``message`` and the place in ``excerpt``.
    ``guessed`` says by what the theory was guessed if nobody named it.
    """

    claim: Claim
    verdict: str
    answer: Answer | None = None
    read_as: str = ""
    shapes: Mapping[str, str] = field(default_factory=dict[str, str])
    guessed: str = ""
    message: str = ""
    excerpt: str = ""
    seconds: float = field(default=0.0, compare=False)


@dataclass(frozen=True)
class Report:
    """The results of a run; ``errors`` are the files and options that could not be used, one line each."""

    results: tuple[Result, ...] = ()
    errors: tuple[str, ...] = ()

    @property
    def counts(self) -> dict[str, int]:
        """How many claims got each word."""
        found = Counter(r.verdict for r in self.results)
        return {word: found[word] for word in WORDS}

    @property
    def exit_code(self) -> int:
        """Exit code: 0 all proved; 2 bad input before 1 refuted before 3 supported or undecided."""
        if self.errors:
            return EXIT_CODES[ERROR]
        return next((code for word, code in EXIT_CODES.items() if self.counts[word]), 0)

    def to_json(self) -> dict[str, object]:
        """Return the report as data of schema derive-check/1."""
        from derive.check.entries import report_entries

        return report_entries(self)

    def to_sarif(self) -> dict[str, object]:
        """Return the report as a SARIF 2.1.0 log, for code hosts."""
        from derive.check.sarif import sarif_log

        return sarif_log(self)

    def __str__(self) -> str:
        """Return the report for readers."""
        from derive.check.text import text_report

        return text_report(self)
