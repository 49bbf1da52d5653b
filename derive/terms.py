"""Presentation tree: typed, order-preserving, unevaluated terms, and how they are read as kernel polynomials.

A term prints as it was written; ``lower`` gives its meaning: a grid of kernel polynomials (one by one unless it has
blocks), with d/dt, E[.] and integrals evaluated by the named rules of rules.py. Standard library only.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field, fields
from fractions import Fraction

from derive.display import Displayed
from derive.kernel import Poly, Rejected, identity, parts
from derive.real import Real
from derive.rules import Context, Grid, differentiate, expect, sift, substitute

Size = str


class Term(Displayed):
    """A node of the presentation tree; + - * build sums and products, .T and .inv transposes and inverses."""

    __slots__ = ()

    def __add__(self, other: Term) -> Sum:
        left = self.addends if isinstance(self, Sum) else (self,)
        return Sum((*left, *(other.addends if isinstance(other, Sum) else (other,))))

    def __sub__(self, other: Term) -> Sum:
        return Sum((*(self.addends if isinstance(self, Sum) else (self,)), Neg(other)))

    def __neg__(self) -> Neg:
        return Neg(self)

    def __mul__(self, other: Term) -> Product:
        left = self.factors if isinstance(self, Product) else (self,)
        return Product((*left, *(other.factors if isinstance(other, Product) else (other,))))

    def __rmul__(self, number: int | Fraction) -> Product:
        return Product((Number(Fraction(number)), *(self.factors if isinstance(self, Product) else (self,))))

    @property
    def T(self) -> Transpose:
        """The transpose."""
        return Transpose(self)

    @property
    def inv(self) -> Inverse:
        """The inverse."""
        return Inverse(self)

    def children(self) -> Iterator[Term]:
        """Iterate over the terms directly below this one."""
        for f in fields(self):  # type: ignore[arg-type]
            value = getattr(self, f.name)
            flat = [x for row in value for x in row] if isinstance(self, Block) else value
            yield from (x for x in (flat if isinstance(flat, (tuple, list)) else (flat,)) if isinstance(x, Term))


@dataclass(frozen=True)
class Glyph:
    """How a symbol looks: letter (TeX name or character), accent, subscript, superscript, upright or not."""

    letter: str
    accent: str = ""
    sub: str = ""
    sup: str = ""
    upright: bool = False


@dataclass(frozen=True)
class Symbol(Term):
    """A letter of type rows x cols; ``args`` are its times, ``scalar`` makes it central."""

    name: str
    rows: Size = ""
    cols: Size = ""
    glyph: Glyph = field(default_factory=lambda: Glyph(""), compare=False)
    symmetric: bool = False
    scalar: bool = False
    args: tuple[str, ...] = ()
    show_args: tuple[str, ...] | None = field(default=None, compare=False)
    meaning: str = field(default="", compare=False)
    unit: str = field(default="", compare=False)

    def at(self, *args: str) -> Symbol:
        """Return the symbol at the given times, e.g. Phi.at("t", "τ")."""
        values = {f.name: getattr(self, f.name) for f in fields(self)}
        return Symbol(**{**values, "args": args, "show_args": None})

    @property
    def letter(self) -> str:
        """The kernel's name of this letter."""
        return self.name + ("@" + ",".join(self.args) if self.args else "")


@dataclass(frozen=True)
class Number(Term):
    """A rational number."""

    value: Fraction


@dataclass(frozen=True)
class Identity(Term):
    """The identity matrix of a dimension."""

    size: Size


@dataclass(frozen=True)
class Zero(Term):
    """The zero matrix."""

    rows: Size
    cols: Size


@dataclass(frozen=True)
class Sum(Term):
    """A sum; an addend that is a Neg prints with a minus sign."""

    addends: tuple[Term, ...]


@dataclass(frozen=True)
class Neg(Term):
    """The negative of a term."""

    body: Term


@dataclass(frozen=True)
class Product(Term):
    """A product in order; numbers and scalars stand where they were written."""

    factors: tuple[Term, ...]


@dataclass(frozen=True)
class Transpose(Term):
    """The transpose of a term."""

    body: Term


@dataclass(frozen=True)
class Inverse(Term):
    """The inverse of a term, which must have been declared with its reason."""

    body: Term


@dataclass(frozen=True)
class Dot(Term):
    """The time derivative d/dt."""

    body: Term


@dataclass(frozen=True)
class Expect(Term):
    """The expectation E[.]."""

    body: Term


@dataclass(frozen=True)
class Integral(Term):
    """The integral of body over ``variable`` from t0 to t."""

    body: Term
    variable: str


@dataclass(frozen=True)
class Delta(Term):
    """The Dirac delta at the difference of two times, a central scalar."""

    one: str
    two: str


@dataclass(frozen=True)
class Trace(Term):
    """The trace of a term."""

    body: Term


@dataclass(frozen=True)
class Gradient(Term):
    """The gradient of a trace with respect to a matrix: d tr f = tr(G' dL)."""

    body: Term
    symbol: Symbol


@dataclass(frozen=True)
class Block(Term):
    """A block matrix, rows of terms."""

    rows: tuple[tuple[Term, ...], ...]


@dataclass(frozen=True)
class Image(Term):
    """The image of a term under a named map of letters, such as the duality map."""

    map: str
    body: Term


@dataclass(frozen=True)
class Equation(Displayed):
    """A statement lhs relation rhs; relation is one of = := ⪰ ≻ (Loewner order), between scalars also ≥ > ≠."""

    lhs: Term
    relation: str
    rhs: Term


def block(rows: list[list[Term]]) -> Block:
    """Build a block matrix from nested lists."""
    return Block(tuple(tuple(row) for row in rows))


def walk(term: Term) -> Iterator[Term]:
    """Iterate over a term and everything below it."""
    yield term
    for child in term.children():
        yield from walk(child)


# ------------------------------------------------------------------------------------------------ meaning
class MissingInverse(Rejected):
    """An inverse is used that is not declared, or whose reason is not proved yet."""


@dataclass(frozen=True)
class Reading:
    """What a term is read in.

    The kernel's context, declared inverses, named maps of letters, the names of the adopted declarations, which
    declaration or lemma each entry of the tables of derivatives and moments comes from, and what is known of scalars.
    """

    context: Context
    inverses: Mapping[Poly, str] = field(default_factory=dict[Poly, str])
    maps: Mapping[str, Mapping[str, Poly]] = field(default_factory=dict[str, Mapping[str, Poly]])
    adopted: frozenset[str] = frozenset()
    origins: Mapping[str | tuple[str, str], str] = field(default_factory=dict["str | tuple[str, str]", str])
    real: Real = field(default_factory=Real)


def grid_map(function: Callable[[Poly], Poly], grid: Grid) -> Grid:
    """Apply a function to every block."""
    return tuple(tuple(function(p) for p in row) for row in grid)


def grid_add(a: Grid, b: Grid) -> Grid:
    """Add two block matrices of the same type."""
    if len(a) != len(b) or len(a[0]) != len(b[0]):
        raise Rejected("block matrices of different shape cannot be added")
    return tuple(tuple(p + q for p, q in zip(r, s, strict=True)) for r, s in zip(a, b, strict=True))


def grid_multiply(a: Grid, b: Grid) -> Grid:
    """Multiply two block matrices."""
    if len(a[0]) != len(b):
        raise Rejected("block matrices of these shapes cannot be multiplied")
    out: list[tuple[Poly, ...]] = []
    for row in a:
        line: list[Poly] = []
        for j in range(len(b[0])):
            total = row[0] * b[0][j]
            for k in range(1, len(b)):
                total = total + row[k] * b[k][j]
            line.append(total)
        out.append(tuple(line))
    return tuple(out)


def lower(term: Term, reading: Reading) -> Grid:
    """Read a term as a grid of kernel polynomials; operators are evaluated by their rules.

    Raises:
        Rejected: types that do not fit, an inverse that is not declared, an operator without a rule.
    """
    context = reading.context
    match term:
        case Symbol(scalar=True):
            raise Rejected(f"the scalar {term.name} stands alone where a matrix is expected")
        case Dot(Symbol(name=name, args=args)) if args and "t" not in args:
            raise Rejected(f"the derivative of {name} at ({','.join(args)}) is not that of a constant; write it at t")
        case Symbol():
            return ((Poly({((), (term.letter,)): 1}, *context.alphabet.shape(term.letter)),),)
        case Identity(size):
            return ((identity(size),),)
        case Zero(rows, cols):
            return ((Poly({}, rows, cols),),)
        case Neg(body):
            return grid_map(lambda p: -p, lower(body, reading))
        case Sum(addends):
            total = lower(addends[0], reading)
            for addend in addends[1:]:
                total = grid_add(total, lower(addend, reading))
            return total
        case Product(factors):
            return _lower_product(factors, reading)
        case Transpose(body):
            grid = lower(body, reading)
            return tuple(tuple(context.alphabet.transpose(p) for p in column) for column in zip(*grid, strict=True))
        case Inverse(body):
            return ((_lower_inverse(body, reading),),)
        case Dot(Expect(body)):
            return grid_map(lambda p: expect(differentiate(p, context), context), lower(body, reading))
        case Dot(body):
            return grid_map(lambda p: differentiate(p, context), lower(body, reading))
        case Expect(body):
            return grid_map(lambda p: expect(p, context), lower(body, reading))
        case Integral(body, variable):
            _check_time(variable, context)
            return grid_map(lambda p: sift(p.scale(1, ("∫" + variable,))), lower(body, reading))
        case Block(rows):
            return _lower_block(rows, reading)
        case Image(name, body):
            if name not in reading.maps:
                raise Rejected(f"unknown map {name}")
            return grid_map(lambda p: image(p, name, reading), lower(body, reading))
        case _:
            raise Rejected(f"{type(term).__name__} has no meaning as a matrix here")


def _check_time(variable: str, context: Context) -> None:
    if variable in context.alphabet.scalars or variable in context.alphabet.letters:
        raise Rejected(f"{variable} is a symbol, not a variable of time")


def _lower_product(factors: tuple[Term, ...], reading: Reading) -> Grid:
    number, scalars, matrices = Fraction(1), [], []
    for factor in factors:
        match factor:
            case Number(value):
                number *= value
            case Symbol(scalar=True, args=()):
                scalars.append(factor.name)
            case Delta(one, two):
                _check_time(one, reading.context)
                _check_time(two, reading.context)
                scalars.append("δ({},{})".format(*sorted((one, two), key=lambda a: (a != "t", a))))
            case _:
                matrices.append(lower(factor, reading))
    if not matrices:
        raise Rejected("a product without a matrix has no type; write it times an identity")
    total = matrices[0]
    for matrix in matrices[1:]:
        total = grid_multiply(total, matrix)
    return grid_map(lambda p: p.scale(number, tuple(sorted(scalars))), total)


def _lower_inverse(body: Term, reading: Reading) -> Poly:
    grid = lower(body, reading)
    if len(grid) != 1 or len(grid[0]) != 1:
        raise Rejected("the inverse of a block matrix is written out by blocks")
    return _inverse_of(grid[0][0], reading)


def _inverse_of(poly: Poly, reading: Reading) -> Poly:
    alphabet = reading.context.alphabet
    for candidate, turned in ((poly, False), (alphabet.transpose(poly), True)):
        name = reading.inverses.get(candidate)
        if name is not None:
            letter = alphabet.flip(name) if turned else name
            return Poly({((), (letter,)): 1}, poly.cols, poly.rows)
    raise MissingInverse("an inverse is used that is not declared, or whose reason is not proved yet")


def image(poly: Poly, name: str, reading: Reading) -> Poly:
    """Return the image under a map of letters that sends the inverse of M to the inverse of the image of M.

    Raises:
        Rejected: an inverse goes elsewhere.
        MissingInverse: the image of M has no declared inverse yet.
    """
    images, alphabet = reading.maps[name], reading.context.alphabet
    letters = {parts(a)[0] for _, w in poly.terms for a in w}
    for matrix, letter in reading.inverses.items():
        if letter in letters:
            found = substitute(Poly({((), (letter,)): 1}, matrix.cols, matrix.rows), images, alphabet)
            if found != _inverse_of(image(matrix, name, reading), reading):
                raise Rejected(f"the map {name} does not send {letter} to the inverse of the image of its matrix")
    return substitute(poly, images, alphabet)


def _lower_block(rows: tuple[tuple[Term, ...], ...], reading: Reading) -> Grid:
    out: list[tuple[Poly, ...]] = []
    for row in rows:
        parts = [lower(t, reading) for t in row]
        if len({len(g) for g in parts}) != 1:
            raise Rejected("the blocks of a row have different heights")
        out.extend(tuple(p for g in parts for p in g[i]) for i in range(len(parts[0])))
    if len({len(r) for r in out}) != 1:
        raise Rejected("the rows of a block matrix have different lengths")
    return tuple(out)


def lower_trace(term: Term, reading: Reading) -> Poly:
    """Read a linear combination of traces as one polynomial under the trace."""
    match term:
        case Trace(body):
            grid = lower(body, reading)
            total: Poly | None = None
            for i, row in enumerate(grid):
                total = row[i] if total is None else _under_trace(total, row[i])
            assert total is not None
            return total
        case Neg(body):
            return -lower_trace(body, reading)
        case Product((Number(value), *rest)) if len(rest) == 1:
            return lower_trace(rest[0], reading).scale(value)
        case Sum(addends):
            total = lower_trace(addends[0], reading)
            for addend in addends[1:]:
                total = _under_trace(total, lower_trace(addend, reading))
            return total
        case _:
            raise Rejected(f"{type(term).__name__} is not a combination of traces")


def _under_trace(a: Poly, b: Poly) -> Poly:
    if a.rows != b.rows and any(not w for _, w in (*a.terms, *b.terms)):
        raise Rejected("traces of identities of different sizes are not combined")
    return Poly(a.terms, b.rows, b.cols) + b if a.rows != b.rows else a + b
