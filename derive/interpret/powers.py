"""Powers, roots, inverses and transposes."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from fractions import Fraction
from typing import TYPE_CHECKING

from derive.functions import Power, Root
from derive.interpret.arithmetic import ONE, divided, product, square
from derive.interpret.shapes import NotUnderstood, Typed, rebuilt
from derive.latex import latex
from derive.latex import syntax as s
from derive.spectral import Conjugate
from derive.terms import Identity, Inverse, Neg, Number, Product, Symbol, Term, Transpose, walk

if TYPE_CHECKING:
    from derive.interpret.reader import Reader

CONJUGATE = frozenset({"star", "*", "ast", "H", "dagger", "†"})
COMPLEX = frozenset({"s", "j", "z"})
BITS = 10_000  # of a number, written out


def beside(node: s.Raised | s.Inverted | s.Transposed, reader: Reader) -> Typed | None:
    """Read a script behind a letter and brackets as one of the brackets if they are two factors: P (s - 1)^{-1}."""
    core: s.Node = node
    while isinstance(core, (s.Raised, s.Inverted, s.Transposed)):
        core = core.body
    if not isinstance(core, s.Applied) or not reader.multiplies(core):
        return None
    return reader.read(s.Times((core.head, _rescripted(node, s.Fenced(core.arguments[0])))))


def _rescripted(node: s.Node, body: s.Node) -> s.Node:
    """Return the scripts of a node around another body."""
    if not isinstance(node, (s.Raised, s.Inverted, s.Transposed)):
        return body
    return replace(node, body=_rescripted(node.body, body))


def raised(node: s.Raised, reader: Reader) -> Typed:
    """Read a power: natural and negative numbers, halves, and e to a number."""
    if (product := beside(node, reader)) is not None:
        return product
    if isinstance(node.body, s.Name):
        named = reader.named(s.Name(node.body.letter, node.body.accents, node.body.sub, exponent_text(node.exponent)))
        if named is not None:
            return named
        if node.body.letter == "e" and not node.body.sub and constant(node.exponent) is None:
            return reader.call("exp", [reader.read(node.exponent)])
    exponent = constant(node.exponent)
    if exponent is None:
        raise NotUnderstood("an exponent: expected a number, T, or a letter's own mark")
    return power(reader.read(node.body), exponent, reader)


def exponent_text(node: s.Node) -> str:
    """Return an exponent that may belong to the name below it, such as the 2 of a variance or the f of a filter."""
    match node:
        case s.Digits(value):
            return str(value)
        case s.Name(letter, (), "", ""):
            return letter
        case s.Fenced(body):
            return exponent_text(body)
        case s.Infinite():
            return "∞"
        case _:
            return "?"


def constant(node: s.Node) -> Fraction | None:
    """Return the number that an exponent is."""
    match node:
        case s.Digits(value):
            return value
        case s.Fenced(body):
            return constant(body)
        case s.Plus(((sign, body),)):
            value = constant(body)
            return -value if value is not None and sign == "-" else value
        case s.Over(top, bottom):
            above, below = constant(top), constant(bottom)
            return above / below if above is not None and below else None
        case _:
            return None


def power(typed: Typed, exponent: Fraction, reader: Reader) -> Typed:
    """Return a power of a number or of a square matrix."""
    term, shape = typed
    square(typed, "a power", reader)
    if exponent < 0:
        return inverse(power(typed, -exponent, reader), reader)
    if exponent.denominator == 2:
        root = (Root(term), None) if shape is None else reader.matrix_root(term)
        return power(root, exponent * 2, reader)
    if exponent.denominator != 1 or exponent > 64:
        raise NotUnderstood(f"{latex(term)} to the power {exponent}: expected a whole number up to 64, or its half")
    if exponent == 0:
        return (ONE, None) if shape is None else (Identity(shape[0]), shape)
    if shape is None:
        if isinstance(term, Number):
            if exponent * max(term.value.numerator.bit_length(), term.value.denominator.bit_length()) > BITS:
                raise NotUnderstood(f"a number of more than {BITS} bits")
            return Number(term.value ** int(exponent)), None
        return (term if exponent == 1 else Power(term, int(exponent))), None
    return product([term for _ in range(int(exponent))]), shape


def inverse(typed: Typed, reader: Reader) -> Typed:
    """Return the inverse of a square matrix, or one over a number."""
    term, shape = typed
    if shape is None:
        return divided((ONE, None), typed, reader)
    square(typed, "an inverse", reader)
    return Inverse(term), shape


def inverted(node: s.Inverted, reader: Reader) -> Typed:
    """Read an inverse."""
    return beside(node, reader) or inverse(reader.read(node.body), reader)


def radical(node: s.Radical, reader: Reader) -> Typed:
    """Read a square root of a number."""
    if node.index is not None and constant(node.index) != 2:
        raise NotUnderstood("a root: only square roots are read")
    return power(reader.read(node.body), Fraction(1, 2), reader)


# ------------------------------------------------------------------------------------------------ transposes
def transposed(node: s.Transposed, reader: Reader) -> Typed:
    """Read a transpose; with a star it is the conjugate transpose where jω occurs."""
    return beside(node, reader) or transpose(reader.read(node.body), node.mark, reader)


def transpose(typed: Typed, mark: str, reader: Reader) -> Typed:
    """Return the transpose of a term."""
    term, shape = typed
    if mark in CONJUGATE:
        root = isinstance(term, Symbol) and term.name in reader.theory.theory.families
        term = Conjugate(term) if root and isinstance(term, Symbol) else conjugated(term, reader)
    return (term, None) if shape is None else (Transpose(term), (shape[1], shape[0]))


def conjugated(term: Term, reader: Reader) -> Term:
    """Return the complex conjugate of a term with real matrices: jω becomes -jω. That of a root has its own sign.

    Raises:
        NotUnderstood: the term contains s, of which the conjugate and -s are two readings.
    """
    names = {n.name for n in walk(term) if isinstance(n, Symbol)}
    spectra = [n for n in names if n in reader.theory.theory.complex and n not in COMPLEX and n != "ω"]
    if spectra:
        raise NotUnderstood(f"a star on {spectra[0]}: write the transpose, or the value at the opposite frequency")
    if names & {"s", "z"}:
        raise NotUnderstood("a star on a function of s: the conjugate, or the value at -s transposed; write which")
    return _turned(term) if "j" in names else term


def _turned(term: Term) -> Term:
    """Return a term with -j for j."""
    match term:
        case Product(factors) if any(isinstance(f, Symbol) and f.name == "j" for f in factors):
            return Neg(Product(tuple(f if isinstance(f, Symbol) else _turned(f) for f in factors)))
        case Neg(Product(factors)) if any(isinstance(f, Symbol) and f.name == "j" for f in factors):
            return Product(tuple(f if isinstance(f, Symbol) else _turned(f) for f in factors))
        case Symbol(name="j"):
            return Neg(term)
        case _:
            return rebuilt(term, _turned)


HANDLERS: Mapping[type[s.Node], Callable[..., Typed]] = {
    s.Raised: raised,
    s.Radical: radical,
    s.Inverted: inverted,
    s.Transposed: transposed,
}
