"""A validation as plain data: schema lmi-validate/1, for files and for the page that `-o` writes."""

from typing import Any

import numpy as np

from derive.numeric.plant import Plant
from derive.numeric.simulation import LEVEL, Estimate, Sample
from lmi.certification.outcome import CertificateOutcome
from lmi.comparison import Route
from lmi.report.lines import verdict_line
from lmi.validation import FilterForm, Validation

__all__ = ["as_dict"]


def as_dict(validation: Validation) -> dict[str, Any]:
    """Return the data; what is no number becomes None."""
    return {
        "schema": "lmi-validate/1",
        "plant": _plant(validation.plant),
        "routes": [_route(route) for route in validation.routes],
        "covariance": _matrix(validation.routes[0].P),
        "filter": _filter(validation.filter_form),
        "enclosure": validation.enclosure.as_dict(),
        "certificate": validation.certificate.as_dict(),
        "certificate_status": validation.certificate.status,
        "bounds": _bounds(validation.certificate),
        "verdict": validation.verdict.value,
        "reason": verdict_line(validation).partition(": ")[2],
    }


def _plant(plant: Plant) -> dict[str, Any]:
    """Return the keys of a plant file."""
    data: dict[str, Any] = {"name": plant.name, "time": plant.time}
    data |= {key: getattr(plant, key).tolist() for key in ("A", "C", "W", "V", "N", "M")}
    return data


def _route(route: Route) -> dict[str, Any]:
    return {
        "name": route.name,
        "trace": _finite(route.trace),
        "cost": _finite(route.cost),
        "output": _finite(route.output),
        "gain": _matrix(route.gain),
        "status": route.status,
        "relative_difference": _finite(route.relative_difference),
        "difference": _finite(route.difference),
        "difference_from": route.difference_from,
        "residual": _finite(route.residual),
        "output_error": route.output_error,
        "output_digits": route.output_digits,
        "interval": None if route.sample is None else _interval(route.sample.trace),
        "sample": None if route.sample is None else _sample(route.sample),
        "iterations": route.iterations,
        "history": [_finite(value) for value in route.history],
        "seconds": route.seconds,
        "independent_of": list(route.independent_of),
    }


def _sample(sample: Sample) -> dict[str, Any]:
    return {
        "level": LEVEL,
        "cost_interval": _interval(sample.cost),
        "variance_intervals": [_interval(variance) for variance in sample.variances],
        "runs": sample.runs,
        "steps": sample.steps,
        "skipped": sample.skipped,
        "step": sample.step,
        "running": [{"runs": runs, "cost": _finite(x.value), "interval": _interval(x)} for runs, x in sample.running],
    }


def _interval(estimate: Estimate) -> list[float | None]:
    return [_finite(end) for end in estimate.interval]


def _filter(form: FilterForm | None) -> dict[str, Any] | None:
    if form is None:
        return None
    return {"trace": form.trace, "cost": form.cost, "covariance": _matrix(form.P), "gain": _matrix(form.gain)}


def _bounds(certificate: CertificateOutcome) -> dict[str, Any] | None:
    """Return what the certificate proves as decimals that are rounded outwards, texts as JSON's numbers would round."""
    if certificate.certified is None:
        return None
    from lmi.certificate.report import ends

    bounds = certificate.certified.bounds
    variances = [list(ends(interval)) for interval in bounds.variances]
    sums = {"trace": list(ends(bounds.trace)), "cost": list(ends(bounds.cost))}
    return {**sums, "variances": variances, "is_covariance": bounds.is_covariance}


def _matrix(values: Any) -> list[list[float]] | None:
    return None if values is None or not np.isfinite(values).all() else np.asarray(values, dtype=float).tolist()


def _finite(value: float | None) -> float | None:
    return value if value is not None and np.isfinite(value) else None
