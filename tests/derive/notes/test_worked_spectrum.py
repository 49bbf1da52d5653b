"""The frequency domain of the worked example: its formula, its numbers, and what it says is proved."""

import re

import pytest

from derive.latex import plain
from derive.notes.html import html
from derive.notes.model import Display, Document, Figure, Para, Section
from derive.numeric.plant import example_plant
from derive.worked_spectrum import formula, spectrum_section
from lmi.validation import validate
from tests.derive.numeric.plants import EDGES, random_plant

NUMBER = re.compile(r"[−-]?\d+(?:\.\d+)?(?:e[−-]?\d+)?")


def text_of(inline):
    return "".join(part if isinstance(part, str) else plain(part) for part in inline)


def section(plant, validation=None):
    validation = validate(plant).as_dict() if validation is None else validation
    return spectrum_section(plant, validation, "anchor"), validation


def test_the_section_of_the_example():
    blocks, _ = section(example_plant())
    assert [type(block) for block in blocks] == [Section, Para, Display, Figure, Para]
    assert text_of(blocks[-1].text) == (
        "Proved in ball arithmetic, for the plant's numbers as they are: tr(C P C' V^-1) = "
        "2.80389428847232845776017144108 to 30 digits and tr(P) = 7.20739784853077421551928464929 to 30 digits."
    )
    page = html(Document("Example", ("about",), tuple(blocks)))
    assert page.count("<svg") == 1
    assert len(blocks[3].svg) < 45_000


@pytest.mark.parametrize("time", ["continuous", "discrete"])
@pytest.mark.parametrize("cross", [False, True])
def test_the_numbers_of_the_caption_add_up(time, cross):
    plant = random_plant(time, 4, 2, seed=60, cross=cross)
    blocks, validation = section(plant)
    (figure,) = (block for block in blocks if isinstance(block, Figure))
    caption = text_of(figure.caption)
    assert ("logarithmic axis" in caption) == (time == "continuous")
    area, poles, *rest = [
        float(x.replace("−", "-")) for x in NUMBER.findall(caption.split("right. ")[1].split(" = ")[0])
    ]
    total = float(NUMBER.findall(caption)[-1].replace("−", "-"))
    proved = {key: float(validation["enclosure"][key]["value"]) for key in ("output", "unstable_term", "cross_term")}
    assert poles == pytest.approx(proved["unstable_term"], rel=1e-4)
    assert poles > 0
    assert len(rest) == (cross and time == "continuous")
    signed = [size if f"+ {size:.6g} (cross" in caption else -size for size in rest]
    assert area + poles + sum(signed) == pytest.approx(total, rel=1e-4)
    assert signed == pytest.approx([-proved["cross_term"]] * len(rest), rel=1e-4)
    if time == "continuous":
        assert total == pytest.approx(proved["output"], rel=1e-5)


def test_the_formula_has_the_terms_of_the_plant():
    cost, terms = (plain(side) for side in formula(example_plant()))
    assert cost == "tr(C P C' V^-1)"
    assert "max(0,Re" in terms
    cost, _ = (plain(side) for side in formula(EDGES["cross term of two outputs"]))
    assert cost == "tr(C P C' V^-1) + tr(C N V^-1)"
    cost, terms = (plain(side) for side in formula(EDGES["cross term, discrete"]))
    assert "N" not in cost
    assert "R" in cost
    assert "max(0,ln" in terms


def test_a_refusal_is_printed_with_its_mode():
    blocks, _ = section(EDGES["uncontrollable boundary mode"])
    text = text_of(blocks[-1].text)
    assert "nothing of P, closed loop: expected stable, got 0, unexcited" in text
    assert "= 0.414213562373095048801688724210 to 30 digits" in text


def test_exact_and_vanishing_numbers():
    blocks, validation = section(EDGES["C = 0"])
    assert "= 0 exactly" in text_of(blocks[-1].text)
    tiny = {"value": "0", "radius": "1.0e-40", "digits": 0}
    blocks, _ = section(EDGES["C = 0"], {**validation, "enclosure": {**validation["enclosure"], "output": tiny}})
    assert "= 0 to within 1.0e-40" in text_of(blocks[-1].text)


def test_without_an_enclosure_nothing_is_called_proved():
    plant = example_plant()
    blocks, _ = section(plant, {"routes": []})
    assert isinstance(blocks[-1], Figure)
    nothing = {"enclosure": {"status": "not attempted: too large", "output": None}}
    blocks, _ = section(plant, nothing)
    assert text_of(blocks[-1].text) == "Nothing is proved of these numbers: not attempted: too large."
