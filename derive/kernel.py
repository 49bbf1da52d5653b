"""The trusted core: what it accepts holds for matrices of every size. It expands and compares; it searches nothing.

A matrix statement f = 0 is accepted with a certificate f = sum c_i l_i r_i s_i, where r_i is a declared relation
(r_i = 0) or its transpose, l_i and s_i are words of matching type and c_i central scalars. Under a trace, words count
up to rotation and transposition. Positivity and operators are rules of their own (rules.py), each reduced to such
identities. Standard library only.

A letter is written ``A``, its transpose ``A'``; ``Phi@t,τ`` is Phi at the times (t, τ). The central scalar ``∫τ`` binds
τ over [t0, t]; ``δ(τ,σ)`` is the Dirac delta of white noise.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from fractions import Fraction
from functools import cache
from itertools import pairwise

Word = tuple[str, ...]
Scalars = tuple[str, ...]
Key = tuple[Scalars, Word]
ANY = ""  # both dimensions of a central relation: it fits between any two words


class Rejected(Exception):  # noqa: N818 - what a checker says, not what went wrong in it
    """A certificate that does not prove its claim; the message says where it fails."""


@dataclass(frozen=True)
class Letter:
    """A matrix variable of type rows x cols (dimension names); a symmetric letter is its own transpose."""

    name: str
    rows: str
    cols: str
    symmetric: bool = False


class Poly:
    """A polynomial sum c * scalars * word of type rows x cols; words are products in order, () is the identity."""

    __slots__ = ("cols", "rows", "terms")

    def __init__(self, terms: Mapping[Key, Fraction | int], rows: str, cols: str):
        self.terms: dict[Key, Fraction] = {
            k: c if isinstance(c, Fraction) else Fraction(c) for k, c in terms.items() if c
        }
        self.rows, self.cols = rows, cols

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Poly) and (self.rows, self.cols, self.terms) == (other.rows, other.cols, other.terms)

    def __hash__(self) -> int:
        return hash((self.rows, self.cols, frozenset(self.terms.items())))

    def __add__(self, other: Poly) -> Poly:
        if (self.rows, self.cols) != (other.rows, other.cols):
            raise Rejected(f"cannot add {self.rows} x {self.cols} and {other.rows} x {other.cols}")
        terms = dict(self.terms)
        for key, c in other.terms.items():
            terms[key] = terms.get(key, Fraction(0)) + c
        return Poly(terms, self.rows, self.cols)

    def __neg__(self) -> Poly:
        return self.scale(-1)

    def __sub__(self, other: Poly) -> Poly:
        return self + other.scale(-1)

    def __mul__(self, other: Poly) -> Poly:
        if self.cols != other.rows and ANY not in (self.cols, other.rows):
            raise Rejected(f"cannot multiply {self.rows} x {self.cols} and {other.rows} x {other.cols}")
        terms: dict[Key, Fraction | int] = {}
        for (m, v), c in self.terms.items():
            for (n, w), d in other.terms.items():
                if (m and captures(m, n, w)) or (n and captures(n, m, v)):
                    raise Rejected(f"a factor would be captured by an integral in {v} {w}")
                key = (times(m, n), v + w)
                terms[key] = terms.get(key, 0) + c * d
        return Poly(terms, self.rows or other.rows, other.cols or self.cols)

    def scale(self, factor: Fraction | int, scalars: Scalars = ()) -> Poly:
        """Multiply by a rational number and central scalars; ∫τ integrates over τ."""
        if scalars and any(captures(m, scalars, ()) for m, _ in self.terms):
            raise Rejected(f"a factor of {scalars} would be captured by an integral")
        return Poly({(times(scalars, m), w): c * factor for (m, w), c in self.terms.items()}, self.rows, self.cols)


def times(m: Scalars, n: Scalars) -> Scalars:
    """Multiply two monomials of central scalars; a variable of integration is bound once, and is none of the limits."""
    product = tuple(sorted(m + n)) if m and n else m or n
    if any(a == b and a.startswith("∫") for a, b in pairwise(product)) or {"∫t", "∫t0"}.intersection(product):
        raise Rejected(f"a variable of integration is bound twice, or a limit, in {product}")
    return product


def bound(scalars: Scalars) -> set[str]:
    """Return the variables of integration that a monomial binds."""
    return {s[1:] for s in scalars if s.startswith("∫")}


def captures(m: Scalars, n: Scalars, word: Word) -> bool:
    """Tell whether an integral in m binds a time that occurs in n or in the word."""
    inside = bound(m)
    return bool(inside) and not inside.isdisjoint(times_of(n, word))


def times_of(scalars: Scalars, word: Word) -> set[str]:
    """Return the time arguments that occur in letters, deltas and integrals."""
    deltas = {a for s in scalars if s.startswith("δ") for a in s[2:-1].split(",")}
    return deltas | bound(scalars) | {a for letter in word if "@" in letter for a in parts(letter)[2]}


def identity(dimension: str) -> Poly:
    """Return the identity matrix of the given dimension name."""
    return Poly({((), ()): 1}, dimension, dimension)


@cache
def parts(letter: str) -> tuple[str, bool, tuple[str, ...]]:
    """Split a letter into base name, transposed or not, and time arguments."""
    head, _, arguments = letter.partition("@")
    return head.removesuffix("'"), head.endswith("'"), tuple(arguments.split(",")) if arguments else ()


@dataclass(frozen=True)
class Alphabet:
    """The letters and central scalars that may occur, and their types."""

    letters: Mapping[str, Letter]
    scalars: frozenset[str] = frozenset()

    def shape(self, letter: str) -> tuple[str, str]:
        """Return (rows, cols) of a letter or transposed letter."""
        name, primed, _ = parts(letter)
        if name not in self.letters:
            raise Rejected(f"unknown letter {letter}")
        found = self.letters[name]
        return (found.cols, found.rows) if primed else (found.rows, found.cols)

    def flip(self, letter: str) -> str:
        """Return the transpose of a letter."""
        name, primed, _ = parts(letter)
        if self.letters[name].symmetric:
            return letter
        return name + ("" if primed else "'") + letter[len(name) + primed :]

    def transpose(self, poly: Poly) -> Poly:
        """Return the transpose: words reversed, letters transposed."""
        flipped = {(m, tuple(self.flip(a) for a in reversed(w))): c for (m, w), c in poly.terms.items()}
        return Poly(flipped, poly.cols, poly.rows)

    def word_shape(self, word: Word, default: str) -> tuple[str, str]:
        """Return (rows, cols) of a product; the empty word is the identity of the default dimension."""
        if not word:
            return default, default
        shapes = [self.shape(a) for a in word]
        for i, (a, b) in enumerate(pairwise(shapes)):
            if a[1] != b[0]:
                raise Rejected(f"ill-typed product {word[i]} {word[i + 1]}: {' x '.join(a)} times {' x '.join(b)}")
        return shapes[0][0], shapes[-1][1]

    def check(self, poly: Poly, trace: bool = False) -> None:
        """Reject a polynomial with an unknown symbol or a word of another type (under a trace: a word not square)."""
        for m, w in poly.terms:
            unknown = [s for s in m if s not in self.scalars and s[:1] not in ("∫", "δ")]
            rows, cols = self.word_shape(w, poly.rows)
            wrong = rows != cols if trace else (rows, cols) != (poly.rows, poly.cols)
            if unknown or wrong or times(tuple(sorted(m)), ()) != m:
                raise Rejected(f"ill-typed term {m} {w}: {rows} x {cols} in {poly.rows} x {poly.cols}, or {unknown}")

    def cyclic(self, poly: Poly) -> dict[Key, Fraction]:
        """Return tr(poly), each word replaced by the least of its rotations and their transposes; tr I is a letter."""
        out: dict[Key, Fraction] = {}
        for (m, w), c in poly.terms.items():
            turned = tuple(self.flip(a) for a in reversed(w))
            least = min((v[i:] + v[:i] for v in (w, turned) for i in range(len(w))), default=(f"@{poly.rows}",))
            out[m, least] = out.get((m, least), Fraction(0)) + c
        return {k: c for k, c in out.items() if c}


def at_time(poly: Poly, variable: str, value: str) -> Poly:
    """Set a time variable: f(..., variable, ...) becomes f(..., value, ...) in letters and deltas."""

    def move(name: str) -> str:
        head, sign, tail = name[:-1].partition("(") if name.startswith("δ") else name.partition("@")
        return head + sign + ",".join(value if a == variable else a for a in tail.split(",")) + ")" * (sign == "(")

    terms: dict[Key, Fraction] = {}
    for (m, w), c in poly.terms.items():
        key = tuple(sorted(map(move, m))), tuple(map(move, w))
        terms[key] = terms.get(key, Fraction(0)) + c
    return Poly(terms, poly.rows, poly.cols)


def sample(poly: Poly) -> Poly:
    """Write f(τ) δ(t,τ) as f(t) δ(t,τ), the sampling property of the Dirac delta."""
    if not any(s.startswith("δ") for m, _ in poly.terms for s in m):
        return poly
    total = Poly({}, poly.rows, poly.cols)
    for (m, w), c in poly.terms.items():
        term = Poly({((), w): c}, poly.rows, poly.cols)
        for delta in (d for d in m if d.startswith("δ")):
            one, two = delta[2:-1].split(",")
            term = at_time(term, two, one)
        total = total + term.scale(1, m)
    return total


@dataclass(frozen=True)
class Term:
    """One addend c * scalars * left * relation * right of a certificate."""

    coefficient: Fraction
    scalars: Scalars
    left: Word
    relation: str
    transposed: bool
    right: Word


@dataclass(frozen=True)
class Certificate:
    """The claim f = 0 (under a trace: tr f = 0) and the addends that make up f."""

    claim: Poly
    terms: tuple[Term, ...] = ()
    trace: bool = False


def replay(certificate: Certificate, claim: Poly, relations: Mapping[str, Poly], alphabet: Alphabet) -> None:
    """Accept f = sum c_i l_i r_i s_i by expansion, or raise Rejected."""

    def normal(poly: Poly) -> Mapping[Key, Fraction]:
        alphabet.check(poly, certificate.trace)
        return alphabet.cyclic(sample(poly)) if certificate.trace else sample(poly).terms

    if certificate.claim != claim:
        raise Rejected("the certificate belongs to another claim")
    rest = dict(normal(claim))
    for t in certificate.terms:
        if t.relation not in relations:
            raise Rejected(f"undeclared relation {t.relation}")
        r = alphabet.transpose(relations[t.relation]) if t.transposed else relations[t.relation]
        if ANY in (r.rows, r.cols) and (r.rows != r.cols or any(w for _, w in r.terms)):
            raise Rejected(f"the central relation {t.relation} contains letters")
        addend = Poly({((), t.left): t.coefficient}, *alphabet.word_shape(t.left, r.rows or claim.rows))
        addend = addend * r * Poly({((), t.right): 1}, *alphabet.word_shape(t.right, r.cols or addend.cols))
        addend = addend.scale(1, t.scalars)
        if not certificate.trace and (addend.rows, addend.cols) != (claim.rows, claim.cols):
            raise Rejected(f"ill-typed cofactors of {t.relation}: {addend.rows} x {addend.cols}")
        for key, c in normal(addend).items():
            rest[key] = rest.get(key, Fraction(0)) - c
    if any(rest.values()):
        raise Rejected(f"the addends do not make up the claim; {sum(map(bool, rest.values()))} terms remain")
