"""The worked example in the frequency domain: the output's spectrum as an area, and the poles that add to it."""

from __future__ import annotations

from collections.abc import Mapping
from fractions import Fraction
from typing import Any

from derive.functions import PI, Definite, Infinity, Log, Max, Quotient
from derive.notes.figures import spectrum_area
from derive.notes.model import Block, Display, Figure, Inline, Para, Row, Section
from derive.numeric.output_spectrum import OutputSpectrum, output_spectrum
from derive.numeric.plant import Plant
from derive.spectral import Det, Modulus, RealPart, Total
from derive.terms import Glyph, Neg, Number, Symbol, Term, Trace
from derive.worked_values import proper

__all__ = ["spectrum_section"]


def _letter(name: str, sub: str = "", scalar: bool = False) -> Symbol:
    return Symbol(name + sub, scalar=scalar, glyph=Glyph(name, sub=sub))


A, C, P, N, V, R = map(_letter, "ACPNVR")
PHI = _letter("Φ", "y")
ONE = Number(Fraction(1))
OMEGA, INDEX, COUNT = (_letter(name, scalar=True) for name in "ωin")
POLE = _letter("λ", "i", scalar=True)


def spectrum_section(plant: Plant, validation: Mapping[str, Any], anchor: str) -> list[Block]:
    """Return what the output's spectrum says of the error: the formula, its terms drawn, and what is proved.

    Args:
        plant: the plant.
        validation: what every route says about it, schema lmi-validate/1.
        anchor: of the section.
    """
    curve, (cost, terms) = output_spectrum(plant), formula(plant)
    return [
        Section("Output spectrum", 2, anchor),
        Para(
            (
                "Without the Riccati equation, by the spectrum ",
                PHI,
                " of the output and the eigenvalues ",
                POLE,
                " of ",
                A,
                ":",
            )
        ),
        Display((Row(cost, "=", terms, f"{anchor}-formula"),)),
        _figure(plant, curve),
        *_proof(plant, validation),
    ]


def formula(plant: Plant) -> tuple[Term, Term]:
    """Return both sides of the formula that the figure draws."""
    noise = V if plant.is_continuous else R
    if plant.is_continuous:
        end, growth = Infinity(), RealPart(POLE)
        cost: Term = Trace(C * P * C.T * V.inv)
        cost = cost + Trace(C * N * V.inv) if plant.N.any() else cost
    else:
        end, growth = PI, Log(Modulus(POLE))
        cost = Log(Quotient(Det(C * P * C.T + R), Det(R)))
    log = Log(Quotient(Det(PHI), Det(noise)))
    integral = Quotient(ONE, 2 * PI) * Definite(log, OMEGA, Neg(end), end)
    return cost, integral + 2 * Total(Max(growth), INDEX, COUNT)


def _figure(plant: Plant, curve: OutputSpectrum) -> Figure:
    blocks = [("area", curve.area), ("unstable\npoles", curve.unstable_term)]
    if curve.cross_term:
        blocks.append(("cross\nterm", -curve.cross_term))
    svg = spectrum_area(curve.frequencies, curve.heights, blocks, "sum", plant.is_continuous)
    return Figure(
        svg, _caption(plant, curve), "The output's spectrum as an area, and beside it what adds up to the error."
    )


def _caption(plant: Plant, curve: OutputSpectrum) -> Inline:
    """Return why the area is honest, and the numbers that add up."""
    drawn = "ω/π times the logarithm, over a logarithmic axis" if plant.is_continuous else "1/π times the logarithm"
    cost = Trace(C * P * C.T * V.inv) if plant.is_continuous else formula(plant)[0]
    cross = f" {_signed(-curve.cross_term)} (cross term, from the left)" if curve.cross_term else ""
    return (
        f"The curve is {drawn}, so that the area under it is the first term on the right. "
        f"{_number(curve.area)} (area) {_signed(curve.unstable_term)} (unstable poles){cross} = ",
        cost,
        f" = {_number(curve.total)}.",
    )


def _proof(plant: Plant, validation: Mapping[str, Any]) -> list[Block]:
    """Return what is proved of the numbers, or why nothing is."""
    enclosure = validation.get("enclosure")
    if not enclosure:
        return []
    output = enclosure["output"]
    if output is None:
        return [Para((f"Nothing is proved of these numbers: {enclosure['status']}.",))]
    cost = Trace(C * P * C.T * V.inv) if plant.is_continuous else Log(Det(C * P * C.T + R))
    text: list[str | Term] = ["Proved in ball arithmetic, for the plant's numbers as they are: ", cost, _digits(output)]
    if enclosure["trace"] is not None:
        text += [" and ", Trace(P), _digits(enclosure["trace"])]
    elif enclosure["reason"]:
        text += [f"; nothing of P, {proper(enclosure['reason'])}"]
    return [Para((*text, "."))]


def _digits(number: Mapping[str, Any]) -> str:
    value = number["value"].replace("-", "−")
    if number["radius"] == "0":
        return f" = {value} exactly"
    return (
        f" = {value} to {number['digits']} digits" if number["digits"] else f" = {value} to within {number['radius']}"
    )


def _number(value: float) -> str:
    return f"{value:.6g}".replace("-", "−")


def _signed(value: float) -> str:
    return f"{'−' if value < 0 else '+'} {_number(abs(value))}"
