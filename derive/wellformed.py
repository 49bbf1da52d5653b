"""What may stand in a file: JSON of the right shape, names of the installed theory, statements of bounded size.

Every check raises InputError with one line. Standard library only.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Mapping
from functools import reduce
from operator import mul
from typing import Any

from derive import kernel
from derive.context import Theory
from derive.derivation import Proof
from derive.errors import InputError
from derive.functions import Power, Quotient, Rate
from derive.kernel import Poly
from derive.terms import Block, Dot, Image, Inverse, Product, Sum, Term, walk

EXPANSION = 2_000  # products that one statement may expand to
LENGTH = 400  # factors of one product
FACTORS = 1_000  # facts and squares in one certificate of sign
WORK = 1_000_000  # letters that one certificate of positivity, comparison or uniqueness may expand to
TIME = re.compile(r"[A-Za-zα-ω][0-9]{0,3}")  # what prints as one variable


def a_list(data: Any, name: str) -> list[Any]:
    """Return data if it is a list."""
    if not isinstance(data, list):
        raise InputError(f"{name}: expected a list, got {shown(data)}")
    return data


def a_dict(data: Any, name: str, keys: Iterable[str] | None = None) -> dict[str, Any]:
    """Return data if it is an object (with exactly these keys)."""
    if not isinstance(data, dict):
        raise InputError(f"{name}: expected an object, got {shown(data)}")
    if keys is not None and set(data) != set(keys):
        wrong = sorted(set(data) ^ set(keys))[0]
        raise InputError(f"{name}: expected the keys {', '.join(keys)}, got one too many or few: {shown(wrong)}")
    return data


def shown(value: Any) -> str:
    """Return a short text of a value for a message."""
    if isinstance(value, (list, dict)):
        return f"{'a list' if isinstance(value, list) else 'an object'} of {len(value)}"
    return ascii(value) if isinstance(value, (bool, type(None))) else repr(str(value)[:40])


def check_time(theory: Theory, text: str) -> None:
    """Check the name of a time."""
    if not TIME.fullmatch(text) or text in theory.symbols:
        raise InputError(f"{shown(text)}: expected a time such as t or τ")


def check_size(theory: Theory, text: str) -> None:
    """Check the name of a dimension."""
    if text and text not in theory.sizes():
        raise InputError(f"{shown(text)}: not a dimension of the theory {theory.key}")


def check_letter(theory: Theory, text: str) -> None:
    """Check a letter as the kernel writes it: name, one prime at most and none on a symmetric letter, times."""
    name, primed, times = kernel.parts(text)
    symbol = theory.symbols.get(name)
    written = name + "'" * primed + ("@" + ",".join(times) if times else "")
    if symbol is None or symbol.scalar or (primed and symbol.symmetric) or written != text:
        raise InputError(f"{shown(text)}: not a letter of the theory {theory.key}")
    for time in times:
        check_time(theory, time)


def check_scalar(theory: Theory, text: str) -> None:
    """Check a central scalar: a symbol of the theory, ∫τ or δ(τ,σ)."""
    delta = re.fullmatch(r"δ\(([^,]*),([^,]*)\)", text)
    symbol = theory.symbols.get(text)
    if delta or text.startswith("∫"):
        for time in delta.groups() if delta else (text[1:],):
            check_time(theory, time)
    elif symbol is None or not symbol.scalar:
        raise InputError(f"{shown(text)}: not a scalar of the theory {theory.key}")


def check_map(theory: Theory, text: str) -> None:
    """Check the name of a map of letters."""
    if text not in theory.maps:
        raise InputError(f"{shown(text)}: not a map of the theory {theory.key}")


CHECKS: Mapping[str, Callable[[Theory, str], None]] = {
    **dict.fromkeys(("word", "left", "right"), check_letter),
    **dict.fromkeys(("size", "rows", "cols"), check_size),
    **dict.fromkeys(("variable", "one", "two"), check_time),
    "scalars": check_scalar,
    "map": check_map,
}


def check_work(proof: Proof) -> None:
    """Bound the number of letters that a proof makes the kernel write, beside the claim's."""
    work = 0
    if proof.positivity:
        factors = [[f for row in s.factor for f in row] for s in proof.positivity.squares]
        work += sum(_work(factor, factor) for factor in factors)
    if proof.comparison:
        matrix, claim = proof.comparison.matrix, proof.comparison.claim
        work += len(matrix.terms) * _work([matrix], [claim])
    if proof.uniqueness:
        work += _work([proof.uniqueness.left, proof.uniqueness.right], [proof.uniqueness.claim])
    signs = [s for s in (proof.sign, *((proof.induction.start, proof.induction.step) if proof.induction else ())) if s]
    if sum(len(p.facts) + 2 * len(p.squares) for sign in signs for p in sign.products) > FACTORS:
        raise InputError(f"expected a certificate of sign of at most {FACTORS} factors, got more")
    if work > WORK:
        raise InputError(f"expected a certificate of at most {WORK} letters, got more; prove it in smaller steps")


def _work(left: Iterable[Poly], right: Iterable[Poly]) -> int:
    """Return the number of letters in the product of two sums of polynomials."""
    words, others = ([word for poly in side for _, word in poly.terms] for side in (left, right))
    return sum(len(w) + 1 for w in words) * len(others) + sum(len(w) + 1 for w in others) * len(words)


def expansion(term: Term, theory: Theory) -> tuple[int, int]:
    """Bound the number of products and the longest product that a term expands to.

    Raises:
        InputError: more than the kernel is asked to expand in one statement.
    """
    below = [expansion(child, theory) for child in term.children()]
    count, length = sum(c for c, _ in below) or 1, max((n for _, n in below), default=1)
    match term:
        case Product():
            count, length = reduce(mul, (c for c, _ in below), 1), sum(n for _, n in below)
        case Power(_, exponent) if exponent > LENGTH:
            raise InputError(f"expected an exponent of at most {LENGTH}, got more")
        case Power(_, exponent):
            count, length = count ** max(exponent, 1), length * max(exponent, 1)
        case Quotient(_, bottom):
            nested = any(isinstance(node, Quotient) for node in walk(bottom))  # its reciprocal is sought in two ways
            count, length = below[0][0] * (2 * below[1][0] if nested else 1), below[0][1] + below[1][1]
        case Inverse():
            count, length = 1, 1
        case Dot() | Rate():
            count, length = count * length * 8, length + 8
        case Image(name):
            widest = max((expansion(image, theory)[0] for image in theory.maps[name].values()), default=1)
            count = count * min(widest, EXPANSION) ** min(length, 20)
        case Sum() | Block() | _:
            pass
    if length > LENGTH:
        raise InputError(f"expected products of at most {LENGTH} factors, got more; write it in smaller steps")
    if count > EXPANSION:
        raise InputError(f"expected a statement of at most {EXPANSION} products, got more; write it in smaller steps")
    return count, length
