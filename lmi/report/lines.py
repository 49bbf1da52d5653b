"""What a validation says in words: what is proved, the filter form, and the verdict with its reason."""

from collections.abc import Iterator

import numpy as np

from derive.numeric.modes import format_mode
from lmi.comparison import AGREEMENT, Route
from lmi.enclosure import Number
from lmi.validation import Validation, Verdict

__all__ = ["filter_line", "proved_lines", "status_lines", "verdict_line", "weighted"]


def weighted(validation: Validation) -> bool:
    """Tell whether tr(M P) is something else than tr P."""
    return bool((np.eye(validation.plant.n) != validation.plant.M).any())


def status_lines(validation: Validation) -> Iterator[str]:
    """Iterate over the reasons of the routes that give one."""
    yield from (f"{route.name}: {route.status}" for route in validation.routes if ":" in route.status)


def filter_line(validation: Validation) -> str:
    """Return the covariance after the measurement in one line; nothing in continuous time."""
    form = validation.filter_form
    if form is None:
        return ""
    name, value = ("tr MP+", form.cost) if weighted(validation) else ("tr P+", form.trace)
    return f"filter form, after the measurement: {name} = {value:.6g}"


def proved_lines(validation: Validation) -> Iterator[str]:
    """Iterate over what is proved of the optimum, and why the rest is not."""
    plant, proved = validation.plant, validation.enclosure
    output = "tr(CPC'V^-1)" if plant.is_continuous else "ln det(CPC'+R)"
    if proved.found is None or proved.output is None:
        yield f"{output}: not enclosed: {proved.status}"
    else:
        yield f"{output} = {proved.output}"
        yield f"  = {_sum(validation)}"
        if validation.reads_as_boundary:
            yield "  for the plant's numbers as they are; the routes read modes beside the boundary as on it"
    name, covariance = ("tr(MP)", proved.cost) if weighted(validation) else ("tr P", proved.trace)
    if covariance is not None:
        yield f"{name} = {covariance}"
    elif proved.reason:
        yield f"{name}: not enclosed: {proved.reason}"
    yield from _sensitive(validation)


def _sensitive(validation: Validation) -> Iterator[str]:
    """Say how far P follows the plant's numbers, and which modes make it do so."""
    proved = validation.enclosure
    if proved.condition:
        data = "A, W, C'V^-1 C" if validation.plant.is_continuous else "A, Q, C'R^-1 C"
        yield f"condition: P changes by up to {proved.condition:.2g} times a relative change of {data}"
    if proved.near_boundary:
        modes = dict.fromkeys(map(format_mode, proved.near_boundary))
        yield f"modes of A - LC on the boundary of stability or beside it: {', '.join(modes)}"


def _sum(validation: Validation) -> str:
    """Return the terms that make up the output cost."""
    terms = validation.enclosure.terms
    text = f"{_short(terms['integral'])} (integral) + {_short(terms['unstable_term'])} (unstable modes)"
    if not (validation.plant.N.any() and validation.plant.is_continuous):
        return text
    cross = _short(terms["cross_term"])
    return f"{text} {f'+ {cross[1:]}' if cross[0] == '-' else f'- {cross}'} (tr CNV^-1)"


def _short(number: Number | None) -> str:
    return "?" if number is None else f"{float(number.value):.6g}"


def verdict_line(validation: Validation) -> str:
    """Return the verdict in one line: who confirms, or who disagrees and by how much."""
    riccati, confirming = validation.routes[0], validation.confirming
    match validation.verdict:
        case Verdict.AGREE:
            worst = max(route.relative_difference or 0.0 for route in confirming)
            strong = " (strong solution)" if riccati.status == "strong" else ""
            names = ", ".join(route.name for route in confirming)
            return f"agree: {names} confirm riccati{strong} to {worst:.0e}"
        case Verdict.DISAGREE:
            if validation.excluded:
                return "disagree: the certificate proves the tr P of riccati wrong"
            names = ", ".join(_objection(route) for route in validation.routes if route.disagrees)
            return f"disagree: tolerance {AGREEMENT:.0e}, {names}"
        case Verdict.UNCONFIRMED if confirming:
            return "unconfirmed: there is no certificate"
        case Verdict.UNCONFIRMED:
            return "unconfirmed: no route independent of riccati is accurate enough"


def _objection(route: Route) -> str:
    if route.excluded:
        return f"{route.name} is proved wrong"
    if route.sample is not None:
        return f"{route.name} {route.status.removeprefix('disagrees: ')}"
    return f"{route.name} differs from riccati by {route.relative_difference:.0e}"
