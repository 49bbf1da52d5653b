r"""What a spelled name means: \hat{x}_{k|k-1}, \mathbf{P}_\infty, P_k^-, \sigma_v^2, each in its theory.

A name is spelled ``accents letter_sub^sup``: "hat x_k", "P_k^+", "Phi_y". A theory knows names with an index under the
index #, and functions of time or frequency under "P()", "Phi_y(s)".
"""

from __future__ import annotations

import re
import unicodedata
from collections.abc import Mapping

from derive.interpret.shapes import NotUnderstood
from derive.latex.alphabet import ACCENTS, GREEK
from derive.latex.syntax import Name
from derive.terms import Symbol, Term
from derive.theory.claims.base import INDEX, ClaimTheory, at_index, count

LETTERS = {char: name for name, char in GREEK.items()}
SAME = {"overline": "bar", "widehat": "hat", "widetilde": "tilde"}
CONDITIONAL = re.compile(r"^(.+)\|(.+)$")
DOT = {"dot": 1, "ddot": 2}
MARKS = {mark: name for name, (_, _, mark) in ACCENTS.items()}


def spell(name: Name, notation: Mapping[str, str]) -> str:
    """Return the spelling of a name, in the letters of the theory.

    Raises:
        NotUnderstood: a letter whose role the notation gives to another.
    """
    letter = LETTERS.get(name.letter, name.letter)
    accents = [SAME.get(a, a) for a in name.accents if a not in DOT]
    plain, sub, sup = " ".join([*accents, letter]), tidy(name.sub), tidy(name.sup)
    full = plain + (f"_{sub}" if sub else "") + (f"^{sup}" if sup else "")
    if full in notation or not notation:
        return notation.get(full, full)
    if plain not in notation and letter not in notation:
        _check_free(plain, notation)
        return full
    role = notation[plain] if plain in notation else " ".join([*accents, notation[letter]])
    head, _, own = role.partition("^")
    sub = f",{sub}" if sub and "_" in head else f"_{sub}" if sub else ""
    sup = sup or own
    return head + sub + (f"^{sup}" if sup else "")


def _check_free(letter: str, notation: Mapping[str, str]) -> None:
    taken = next((mine for mine, role in notation.items() if role == letter), None)
    if taken is not None:
        raise NotUnderstood(f"{letter}: the notation gives its role to {taken}; say what {letter} stands for")


def tidy(index: str) -> str:
    """Return an index without spaces, braces and brackets, Greek letters and accents by name: z-ȳ is z-bary."""
    out = ""
    for char in unicodedata.normalize("NFD", index):
        if char in MARKS:
            out = out[:-1] + MARKS[char] + out[-1:]
        else:
            out += LETTERS.get(char, char)
    return re.sub(r"[\\{}()\s]", "", out.replace("infty", "∞").replace("overline", "bar"))


def derivatives(name: Name) -> int:
    """Return how often a name is differentiated, by its dots."""
    return sum(DOT.get(a, 0) for a in name.accents)


def look_up(spelled: str, theory: ClaimTheory) -> Term | None:
    """Return what a spelled name stands for; None if the theory does not know it.

    Raises:
        NotUnderstood: an index that the theory cannot read.
    """
    found = theory.names.get(spelled)
    if found is not None:
        return found
    head, _, sup = spelled.partition("^")
    head, _, sub = head.partition("_")
    rest, comma, index = sub.rpartition(",")
    given = CONDITIONAL.match(index)
    if given:
        index, mark = conditional(spelled, *given.groups())
        sup = sup or mark
    if not INDEX.match(index):
        return None
    stem = f"{head}_{rest}{comma}#" + (f"^{sup}" if sup else "")
    found = theory.names.get(stem)
    if given and found is None and sup == "-":
        found = theory.names.get(stem.removesuffix("^-"))
    return at_index(found, index) if isinstance(found, Symbol) and "#" in found.name else found


def conditional(spelled: str, at: str, given: str) -> tuple[str, str]:
    """Return the index of x_{k|k-1}, and - for a prediction, + for a filtered value.

    Raises:
        NotUnderstood: it is neither.
    """
    if INDEX.match(at) and INDEX.match(given):
        (letter, here), (other, there) = count(at), count(given)
        if letter == other and here - there in (0, 1):
            return at, "-" if here > there else "+"
    raise NotUnderstood(f"{spelled}: expected an index k|k-1 (prediction) or k|k (filtered), got {at}|{given}")


def unknown(spelled: str, theory: ClaimTheory) -> NotUnderstood:
    """Return the error for a name that a theory does not know, with what is close."""
    letter = spelled.partition("_")[0].partition("^")[0]
    close = [n.replace("#", "k") for n in theory.names if n.partition("_")[0].partition("^")[0] == letter]
    known = close or list(dict.fromkeys(n.replace("#", "k").partition("(")[0] for n in theory.names))
    listed = ", ".join(known[:24])
    remedy = "define it in an assumption, or say its role in a notation"
    return NotUnderstood(f"{spelled}: no letter of {theory.key}, which has {listed}; {remedy}")
