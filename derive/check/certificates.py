"""Certificates of proved claims as files, which `derive verify` replays."""

from __future__ import annotations

import json
import re
from pathlib import Path

from derive.check.result import Report
from derive.files import make_folder, write

__all__ = ["write_certificates"]


def write_certificates(report: Report, folder: Path) -> list[Path]:
    """Write one file for each proved claim that has a certificate; they are numbered as the claims are.

    Raises:
        InputError: the folder or a file cannot be written.
    """
    make_folder(folder)
    found: list[Path] = []
    for number, result in enumerate(report.results, 1):
        if result.verdict == "proved" and result.answer and result.answer.certificate:
            name = re.sub(r"[^A-Za-z0-9.-]+", "-", result.claim.id).strip("-.")[:60] or "claim"
            path = folder / f"{number:03d}-{name}.json"
            write(path, json.dumps(result.answer.certificate, ensure_ascii=False, indent=1) + "\n")
            found.append(path)
    return found
