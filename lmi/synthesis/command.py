"""What `lmi design PLANT` prints: the gain, what it achieves, and what is proved of it."""

import json
from collections.abc import Iterator

import numpy as np

from derive.numeric.modes import format_mode
from lmi.synthesis.designs import Design
from lmi.synthesis.file import design_text
from lmi.synthesis.request import Request

__all__ = ["design_lines"]

DIGITS = 10

COSTLY = 10
"""Times the least cost, from which on a gain of the smallest norm is worth a hint."""

LOOSER = 1.02
"""Times the smallest norm, which the hint suggests."""


def design_lines(design: Design) -> Iterator[str]:
    """Iterate over the lines that report a design."""
    plant, request = design.plant, design.request
    what = "inputs" if request.dual else "outputs"
    yield f"{plant.name}: {plant.time} time, states {plant.n}, {what} {plant.l}"
    if design.gain is not None and design.achieved is not None:
        yield "gain K, u = -Kx" if request.dual else "gain L"
        yield from _rows(design.gain)
        loop = "A - BK" if request.dual else "A - LC"
        yield f"modes of {loop}: {', '.join(format_mode(mode) for mode in design.achieved.modes)}"
        yield from _computed(design)
    yield from _proved(design)
    yield f"{design.verdict.value}{': ' if design.reason else ''}{design.reason}"


def _rows(matrix: np.ndarray) -> Iterator[str]:
    texts = [[f"{x:.{DIGITS}g}" for x in row] for row in matrix.tolist()]
    width = max(len(text) for row in texts for text in row)
    for row in texts:
        yield "  " + "  ".join(text.rjust(width) for text in row)


def _computed(design: Design) -> Iterator[str]:
    found = design.achieved
    if found is None:
        return
    unit = "at omega =" if design.plant.is_continuous else "at theta ="
    yield f"computed: H2 norm {found.h2:.{DIGITS}g}, H-infinity norm {found.hinf.upper:.{DIGITS}g} " + (
        f"{unit} {found.hinf.frequency:.4g}, decay rate {found.decay:.6g}"
    )


def _proved(design: Design) -> Iterator[str]:
    """Iterate over what the certificate proves, read back from the text that would be written."""
    if design.certificate is None:
        return
    from lmi.certificate.design import verify_design
    from lmi.certificate.design_file import design_from_dict
    from lmi.certificate.design_report import design_lines as proved_lines
    from lmi.certificate.file import JsonNumber

    data = json.loads(design_text(design), parse_float=JsonNumber, parse_int=JsonNumber)
    written = design_from_dict(data)
    _, bounds = verify_design(written.certificate)
    if bounds is not None:
        yield from proved_lines(written, bounds)
        if design.achieved is not None and bounds.cost.cost.upper > COSTLY * bounds.cost.cost.lower:
            yield from _hint(design.request, design.achieved.hinf.upper)


def _hint(request: Request, norm: float) -> Iterator[str]:
    """Say how to get a smaller gain where the smallest norm was sought: near it, gains grow without bound."""
    if request.objective == "hinf" and request.gamma is None:
        yield f"near the smallest norm gains are large; --gamma {LOOSER * norm:.3g} finds one that costs less"
