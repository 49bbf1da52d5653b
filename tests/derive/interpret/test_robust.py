"""Formulas with a few signs changed: each has a meaning, or an error of one line that says why not."""

from __future__ import annotations

import random
import re

import pytest

from derive.errors import InputError
from derive.interpret import echo, shapes, understand
from derive.latex.grammar import read
from derive.theory.claims import THEORIES, claim_theory
from tests.reference.corpus import entries

TOKEN = re.compile(r"\\[A-Za-z]+|[A-Za-z]|\d|\s+|.")


def changed(latex: str, signs: list[str], generator: random.Random) -> str:
    """Return a formula with one to three signs put in, taken out, replaced or exchanged."""
    found = TOKEN.findall(latex)
    for _ in range(generator.randint(1, 3)):
        i, j = generator.randrange(len(found)), generator.randrange(len(found))
        match generator.randrange(4):
            case 0:
                found[i] = generator.choice(signs)
            case 1:
                found.insert(i, generator.choice(signs))
            case 2 if len(found) > 1:
                del found[i]
            case _:
                found[i], found[j] = found[j], found[i]
    return "".join(found)


@pytest.mark.parametrize("seed", range(4))
def test_a_changed_formula_has_a_meaning_or_an_error(seed: int):
    generator = random.Random(seed)
    pool = list(entries())
    signs = [t for entry in pool for t in TOKEN.findall(entry.latex)]
    meant, refused = 0, list[str]()
    for _ in range(500):
        entry = generator.choice(pool)
        key = entry.theory if generator.random() < 0.8 else generator.choice(list(THEORIES))
        assume = [changed(a, signs, generator) for a in (*entry.assume, generator.choice(pool).latex)[:2]]
        try:
            display, given = read(changed(entry.latex, signs, generator)), [read(a) for a in assume]
        except InputError:
            continue
        try:
            found = understand(display, claim_theory(key), assume=given, scalar=entry.scalar)
        except InputError as error:
            refused.append(str(error))
            continue
        assert echo(found)
        assert shapes(found) is not None
        assert found.theory.reading.adopted <= found.theory.theory.declared.keys()
        meant += 1
    assert meant
    assert refused
    assert not any("\n" in message for message in refused)
