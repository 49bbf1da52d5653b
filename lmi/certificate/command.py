"""What `lmi certify FILE` does: read, decide, report. No number of the file but its matrices is used."""

from collections.abc import Mapping
from fractions import Fraction

from derive.errors import InputError
from lmi.certificate.arithmetic import TooLargeError
from lmi.certificate.design import verify_design
from lmi.certificate.design_file import DESIGN, DUAL_MATRICES, Design, design_from_dict
from lmi.certificate.design_report import design_lines, unproved
from lmi.certificate.file import MATRICES, certificate_from_dict, read_json
from lmi.certificate.report import proved_lines, rejected_line
from lmi.certificate.sandwich import Certificate, exact_plant, verify

__all__ = ["certify_file"]

Outcome = tuple[list[str], int]

DUAL_NAMES: dict[str, str] = dict(zip(MATRICES, DUAL_MATRICES, strict=True))


def certify_file(path: str, plant_path: str | None) -> Outcome:
    """Verify a certificate or a design, and that it is about a plant if one is given.

    Returns:
        Lines to print, and 0, 1 or 3 for the command line.

    Raises:
        InputError: the file is neither, or the plant none.
    """
    data = read_json(path)
    is_design = isinstance(data, Mapping) and data.get("schema") == DESIGN
    if is_design and data.get("certificate", "") is None:
        return ["not certified: the design holds no certificate"], 3
    try:
        read = design_from_dict(data) if is_design else certificate_from_dict(data)
    except InputError as error:
        raise InputError(f"{path}: {error}") from None
    difference = _difference(read, plant_path)
    if difference:
        return [f"rejected: made for another plant: {difference} differs"], 1
    try:
        return _decide_design(read) if isinstance(read, Design) else _decide(read)
    except TooLargeError as error:
        return [f"not certified: {error}"], 3


def _difference(read: Design | Certificate, path: str | None) -> str:
    """Return the first key in which the plant differs from that of a file, or nothing."""
    if path is None:
        return ""
    if isinstance(read, Certificate):
        from derive.numeric.plant import load_plant

        return read.plant.differs_in(exact_plant(load_plant(path)))
    return _design_difference(read, path)


def _design_difference(design: Design, path: str) -> str:
    from derive.numeric.dual import load_dual
    from derive.numeric.plant import load_plant

    plant = load_dual(path) if design.dual else load_plant(path)
    key = design.certificate.plant.differs_in(exact_plant(plant))
    if not key and Fraction(plant.dt or 1) != design.period:
        return "dt"
    return DUAL_NAMES.get(key, key) if design.dual else key


def _decide(certificate: Certificate) -> Outcome:
    found, bounds = verify(certificate)
    return ([rejected_line(found)], 1) if bounds is None else ([*proved_lines(certificate, bounds), "certified"], 0)


def _decide_design(design: Design) -> Outcome:
    found, bounds = verify_design(design.certificate)
    if bounds is None:
        return [rejected_line(found)], 1
    missing = unproved(design, bounds)
    if missing:
        return [f"rejected: {line}" for line in missing], 1
    return [*design_lines(design, bounds), "certified"], 0
