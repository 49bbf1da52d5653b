"""The certificate of a validation: what is proved about the optimum, and whether Riccati's answer fits in."""

from dataclasses import dataclass
from fractions import Fraction
from time import perf_counter
from typing import Any

import numpy as np

from derive.numeric.plant import Plant
from lmi.certification.sandwich import Certified

__all__ = ["CertificateOutcome", "attempt_certificate"]

LARGEST = 100
"""States up to which making a certificate takes seconds."""


@dataclass(frozen=True, eq=False)
class CertificateOutcome:
    """A certificate of a plant's optimum, or why there is none.

    Attributes:
        status: "certified", or why not.
        certified: the certificate with what it proves, or None.
        seconds: time taken.
    """

    status: str
    certified: Certified | None = None
    seconds: float = 0.0

    def excludes(self, trace: float | None, tolerance: float) -> bool:
        """Tell whether tr P is proved to be elsewhere than this, by more than a tolerance."""
        if self.certified is None or trace is None or not np.isfinite(trace):
            return False
        proved, value, slack = self.certified.bounds.trace, Fraction(trace), Fraction(tolerance)
        return not proved.lower - slack <= value <= proved.upper + slack

    def as_dict(self) -> dict[str, Any] | None:
        """Return the certificate as plain data, schema lmi-certificate/1, or None."""
        from lmi.certificate.file import certificate_dict

        return None if self.certified is None else certificate_dict(self.certified.certificate)

    def line(self, weighted: bool) -> str:
        """Return one line for the report, about tr(M P) where there is a weight."""
        if self.certified is None:
            return f"no certificate: {self.status}"
        from lmi.certificate.report import above

        bounds = self.certified.bounds
        lower, width = above(bounds.cost if weighted else bounds.trace)
        return f"certified: {lower} <= {'tr(MP)' if weighted else 'tr P'} <= that + {width}"


def attempt_certificate(plant: Plant) -> CertificateOutcome:
    """Certify the optimum of a plant; what goes wrong becomes the status."""
    if plant.n > LARGEST:
        return CertificateOutcome(f"not attempted: {plant.n} states, a validation certifies up to {LARGEST}")
    from lmi.certification.sandwich import NotCertifiedError, certified

    start = perf_counter()
    try:
        with np.errstate(all="ignore"):
            found = certified(plant)
    except NotCertifiedError as error:
        return CertificateOutcome(f"not certified: {error}", seconds=perf_counter() - start)
    return CertificateOutcome("certified", found, perf_counter() - start)
