"""What `lmi certify FILE` does: read, decide, report. No number of the file but its matrices is used."""

from lmi.certificate import exact_plant, verify
from lmi.certificate_arithmetic import TooLargeError
from lmi.certificate_file import read_certificate
from lmi.certificate_report import proved_lines, rejected_line

__all__ = ["certify_file"]


def certify_file(path: str, plant_path: str | None) -> tuple[list[str], int]:
    """Verify a certificate, and that it is about a plant if one is given.

    Returns:
        Lines to print, and 0, 1 or 3 for the command line.

    Raises:
        InputError: the file is no certificate, or the plant none.
    """
    certificate = read_certificate(path)
    if plant_path is not None:
        from derive.numeric.plant import load_plant

        difference = certificate.plant.differs_in(exact_plant(load_plant(plant_path)))
        if difference:
            return [f"rejected: made for another plant: {difference} differs"], 1
    try:
        found, bounds = verify(certificate)
    except TooLargeError as error:
        return [f"not certified: {error}"], 3
    if bounds is None:
        return [rejected_line(found)], 1
    return [*proved_lines(certificate, bounds), "certified"], 0
