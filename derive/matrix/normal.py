"""The normal form of a polynomial under some relations, to see what a claim is about; it proves nothing by itself."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from derive.kernel import Alphabet, Poly
from derive.matrix.completion import Completion
from derive.matrix.order import Codec, weigh
from derive.matrix.search import declare

__all__ = ["reduced"]

DEGREE = 12


def reduced(poly: Poly, relations: Mapping[str, Poly], alphabet: Alphabet, eliminate: Sequence[str] = ()) -> Poly:
    """Rewrite a polynomial by the relations as they stand, without completing them."""
    codec = Codec(alphabet, weigh(relations, eliminate))
    completion = Completion(codec, DEGREE)
    declare(completion, relations)
    rest, _ = completion.reduce(codec.encode(poly), poly.rows)
    found = codec.decode(rest, poly.rows)
    return Poly(found.terms, poly.rows, poly.cols)
