"""Theories: typed symbols, definitions and hypotheses, and how a statement extends what may be used.

A theory is declared in Python and installed with the package. A derivation starts from ``theory.reading()`` and grows
it by ``adopt``, one proved statement at a time; files carry names only, never relations.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, replace
from fractions import Fraction
from typing import Any, Literal

from derive.functions import Limit, Power, Start, behind, is_scalar, value
from derive.kernel import Alphabet, Letter, Poly, Rejected, identity
from derive.real import (
    COMPLEX,
    FREQUENCY,
    RESERVED,
    STEPS,
    SUPPOSED,
    TIME,
    UNIT,
    Family,
    Progression,
    Real,
    constant,
    scalar,
    scalars_of,
)
from derive.roots import is_real
from derive.rules import Context, Fact, Grid
from derive.scalars import adopt_atom, adopt_scalar
from derive.spectral import Det, Roots
from derive.terms import (
    Dot,
    Equation,
    Expect,
    Glyph,
    MissingInverse,
    Number,
    Product,
    Reading,
    Sum,
    Symbol,
    Term,
    Trace,
    Transpose,
    Zero,
    lower,
    walk,
)

FACT_OF = {"⪰": "psd", "≻": "pd"}
KINDS = ("hurwitz", "schur", "invertible", "initial", "single")  # hypotheses on a matrix that are no (in)equality


@dataclass(frozen=True)
class Declared:
    """A definition (:=) or hypothesis of a theory: its name, what it says, and a sentence for the reader.

    A hypothesis that is a ``case`` (P > 0 of the information form) is made only by the steps that name it; the theory
    does not always hold it in force.
    """

    name: str
    statement: Equation
    kind: Literal["definition", "hypothesis"]
    text: str = ""
    case: bool = False
    generic: str = ""  # the variable, if it holds for all but finitely many of its values
    every: bool = False  # it holds for every number of steps: the start of a sequence, or a recursion


@dataclass(frozen=True)
class DeclaredInverse:
    """A letter for the inverse of a term; it may be used once its reason is there.

    The reason is the name of a fact (M > 0, or M invertible), or the term ``by`` and the names of two proved
    identities M * by = I and by * M = I.
    """

    name: str
    of: Term
    because: str | tuple[str, str]
    by: Term | None = None


@dataclass(frozen=True)
class DeclaredFact:
    """A hypothesis that is no (in)equality: 'hurwitz', 'schur', 'invertible', 'initial' (>= 0 at t0)."""

    name: str
    kind: str
    matrix: Term
    text: str = ""
    case: bool = False


@dataclass(frozen=True)
class DeclaredAtom:
    """A scalar that stands for a root, quotient or function of another; it may be used once its reason is there.

    The reason is the name of a fact on the argument, where the function is not defined everywhere.
    """

    name: str
    kind: str
    of: Term
    because: str = ""


@dataclass
class Theory:
    """Symbols, definitions and hypotheses under one key; filled by its module's ``theory()`` function."""

    key: str
    title: str
    symbols: dict[str, Symbol] = field(default_factory=dict[str, Symbol])
    declared: dict[str, Declared | DeclaredInverse | DeclaredFact | DeclaredAtom] = field(default_factory=dict)
    random: set[str] = field(default_factory=set[str])
    uncentred: set[str] = field(default_factory=set[str])
    constant: set[str] = field(default_factory=set[str])
    parameters: set[str] = field(default_factory=set[str])
    nonnegative: set[str] = field(default_factory=set[str])
    complex: set[str] = field(default_factory=set[str])
    arbitrary: set[str] = field(default_factory=set[str])
    running: set[str] = field(default_factory=set[str])
    families: dict[str, Family] = field(default_factory=dict[str, Family])
    sequences: dict[str, tuple[Term, Symbol]] = field(default_factory=dict)  # x_0, x_{k+1}
    maps: dict[str, dict[str, Term]] = field(default_factory=dict)
    speaks_of: dict[str, frozenset[str]] = field(default_factory=dict)  # scalars in a declaration

    def matrix(
        self,
        name: str,
        rows: str,
        cols: str,
        glyph: Glyph | None = None,
        *,
        symmetric: bool = False,
        random: bool = False,
        constant: bool = True,
        parameter: bool = True,
        show_args: tuple[str, ...] | None = None,
        meaning: str = "",
        unit: str = "",
    ) -> Symbol:
        """Declare a matrix or vector; constant in time and untouched by the gain unless said otherwise."""
        symbol = Symbol(
            name, rows, cols, glyph or Glyph(name), symmetric, show_args=show_args, meaning=meaning, unit=unit
        )
        self.symbols[name] = symbol
        for flag, names in ((random, self.random), (constant, self.constant), (parameter, self.parameters)):
            if flag:
                names.add(name)
        return symbol

    def varying(
        self,
        name: str,
        rows: str,
        cols: str,
        glyph: Glyph | None = None,
        *,
        symmetric: bool = False,
        parameter: bool = True,
        meaning: str = "",
        unit: str = "",
    ) -> Symbol:
        """Declare a matrix that varies with time: M means M(t), and the argument is printed when it is another time."""
        plain = self.matrix(
            name,
            rows,
            cols,
            glyph,
            symmetric=symmetric,
            constant=False,
            parameter=parameter,
            meaning=meaning,
            unit=unit,
        )
        self.symbols[name] = replace(plain, args=("t",), show_args=())
        return self.symbols[name]

    def signal(
        self,
        name: str,
        rows: str,
        glyph: Glyph | None = None,
        *,
        mean: Literal["zero", "any"] = "zero",
        meaning: str = "",
        unit: str = "",
    ) -> Symbol:
        """Declare a random signal x = x(t); with a mean that is not zero its expectation has no rule."""
        symbol = self.varying(name, rows, "1", glyph, parameter=False, meaning=meaning, unit=unit)
        (self.random if mean == "zero" else self.uncentred).add(name)
        return symbol

    def scalar(self, name: str, glyph: Glyph | None = None, *, nonnegative: bool = False, meaning: str = "") -> Symbol:
        """Declare a central scalar, which may be complex unless it is said to be >= 0."""
        self.symbols[name] = symbol = Symbol(name, glyph=glyph or Glyph(name), scalar=True, meaning=meaning)
        (self.nonnegative if nonnegative else self.complex).add(name)
        return symbol

    def parameter(self, name: str, glyph: Glyph | None = None, *, meaning: str = "") -> Symbol:
        """Declare a real parameter that stays arbitrary: no hypothesis may speak of it, and any real may replace it."""
        self.arbitrary.add(name)
        return self.scalar(name, glyph, meaning=meaning)

    def run(self, name: str, glyph: Glyph | None = None, *, meaning: str = "") -> Symbol:
        """Declare a parameter r > 0, to differentiate under an integral; nothing else may be assumed of it."""
        self.running.add(name)
        symbol = self.scalar(name, glyph, nonnegative=True, meaning=meaning)
        self.assume(f"{name} > 0", symbol, ">", text=meaning)
        return symbol

    def roots(
        self, name: str, index: Symbol, count: Symbol, glyph: Glyph | None = None, *, of: str = "", meaning: str = ""
    ) -> Symbol:
        """Declare the roots of a monic polynomial with real coefficients, numbered by an index from 1 to a count."""
        root = replace(self.scalar(name, glyph, meaning=meaning), show_args=(of,) if of else None)
        self.symbols[name] = root
        parts = f"Re {name}", f"Im {name}"
        for part in parts:
            self.scalar(part)
        self.families[name] = Family(*parts, index.name, count.name)
        return root

    def sequence(self, member: Symbol, start: Term, after: Symbol, text: str = "") -> None:
        """Declare that a scalar is the member x_k of a sequence: x_0 is ``start``, and ``after`` stands for x_{k+1}.

        The start is a number or a parameter; ``after`` is defined by x_k, or a letter of which a recursion speaks.
        """
        self.sequences[member.name] = start, after
        name, statement = first_of(member.name), Equation(Start(member, self.symbols[STEPS]), ":=", start)
        self.declared[name] = Declared(name, statement, "definition", text, every=True)

    def recur(self, name: str, lhs: Term, rhs: Term, text: str = "") -> Equation:
        """Declare an equation between the members x_k and x_{k+1} of sequences that holds for every k."""
        statement = Equation(lhs, "=", rhs)
        self.declared[name] = Declared(name, statement, "definition", text, every=True)
        return statement

    def generic(self, name: str, x: Term, a: Term, variable: Symbol, text: str = "") -> Equation:
        """Declare x^2 + a^2 > 0, which fails for one value of the variable at most: x is the variable and a shift."""
        statement = Equation(Sum((Power(x, 2), Power(a, 2))), ">", Zero("", ""))
        self.declared[name] = Declared(name, statement, "hypothesis", text, generic=variable.name)
        return statement

    def direction(self, symbol: Symbol) -> Symbol:
        """Declare the letter along which gradients with respect to a symbol are taken."""
        return self.matrix("δ" + symbol.name, symbol.rows, symbol.cols, parameter=False)

    def define(self, name: str, lhs: Term, rhs: Term, text: str = "") -> Equation:
        """Declare lhs := rhs, a definition of the source or of the theory."""
        statement = Equation(lhs, ":=", rhs)
        self.declared[name] = Declared(name, statement, "definition", text)
        return statement

    def assume(
        self, name: str, lhs: Term, relation: str, rhs: Term | None = None, text: str = "", *, case: bool = False
    ) -> Equation:
        """Declare a hypothesis; ``rhs`` is zero when left out, a ``case`` is not always in force."""
        statement = Equation(lhs, relation, rhs if rhs is not None else Zero("", ""))
        self.declared[name] = Declared(name, statement, "hypothesis", text, case)
        return statement

    def fact(self, name: str, kind: str, matrix: Term, text: str = "", *, case: bool = False) -> None:
        """Declare that a matrix is Hurwitz, Schur or invertible, or at least 0 at the initial time."""
        self.declared[name] = DeclaredFact(name, kind, matrix, text, case)

    def inverse(
        self,
        name: str,
        of: Term,
        rows: str,
        *,
        symmetric: bool = False,
        because: str | tuple[str, str],
        by: Term | None = None,
    ) -> None:
        """Declare the letter for an inverse, usable once the fact ``because`` holds, or two identities with ``by``."""
        self.symbols[name] = Symbol(name, rows, rows, Glyph(name), symmetric)
        self.declared[name] = DeclaredInverse(name, of, because, by)

    def atom(self, kind: str, of: Term, because: str = "", name: str = "") -> Symbol:
        """Declare that a function of a scalar is read: root, reciprocal, absolute, part, exp, log, arctan, integral."""
        name = name or f"{kind} {len(self.declared)}"
        self.symbols[name] = symbol = Symbol(name, glyph=Glyph(name), scalar=True)
        self.declared[name] = DeclaredAtom(name, kind, of, because)
        return symbol

    def statement(self, name: str) -> Equation:
        """Return what a definition or hypothesis says."""
        item = self.declared[name]
        if not isinstance(item, Declared):
            raise Rejected(f"{name} is not an equation")
        return item.statement

    def alphabet(self) -> Alphabet:
        """Return the kernel's alphabet of this theory."""
        letters = {s.name: Letter(s.name, s.rows, s.cols, s.symmetric) for s in self.symbols.values() if not s.scalar}
        return Alphabet(letters, frozenset(s.name for s in self.symbols.values() if s.scalar))

    def reading(self) -> Reading:
        """Return what may be used at the start: definitions, hypotheses, and inverses whose reason is a hypothesis."""
        context = Context(
            self.alphabet(),
            nonnegative=frozenset(self.nonnegative),
            constants=frozenset(self.constant),
            parameters=frozenset(self.parameters),
            random=frozenset(self.random),
            uncentred=frozenset(self.uncentred),
            complex=frozenset(self.complex),
            facts={f"I{s}": Fact("pd", ((identity(s),),)) for s in self.sizes()},
        )
        generic = frozenset(d.generic for d in self.declared.values() if isinstance(d, Declared) and d.generic)
        self._check_scalars()
        if any(name in SUPPOSED or owner(name) != name for name in self.declared):
            raise Rejected("a declaration has a name of its own, not that of a part or of what a proof supposes")
        real = Real(
            families=dict(self.families),
            sequences=self._progressions(),
            arbitrary=frozenset(self.arbitrary),
            cases=self._cases(),
            pending=self._pending(),
            generic=generic,
            running=frozenset(self.running),
        )
        reading = Reading(context, real=real)
        for name, images in self.maps.items():
            lowered = {self.symbols[letter].letter: lower(image, reading)[0][0] for letter, image in images.items()}
            for letter in images:
                found = lowered[self.symbols[letter].letter]
                if self.symbols[letter].symmetric and context.alphabet.transpose(found) != found:
                    raise Rejected(f"the map {name} sends the symmetric {letter} to a matrix that is not")
            reading = replace(reading, maps={**reading.maps, name: lowered})
        return self.settle(reading)

    def _cases(self) -> frozenset[str]:
        """Return the names of the hypotheses that are not always in force."""
        declared = [d for d in self.declared.values() if isinstance(d, (Declared, DeclaredFact)) and d.case]
        return frozenset(d.name for d in declared)

    def _pending(self) -> frozenset[str]:
        """Return the scalars that stand for others: those defined, and atoms."""
        named = {d.name for d in self.declared.values() if isinstance(d, DeclaredAtom)}
        for item in self.declared.values():
            if (
                isinstance(item, Declared)
                and item.statement.relation == ":="
                and isinstance(item.statement.lhs, Symbol)
            ):
                named |= {item.statement.lhs.name} if item.statement.lhs.scalar else set()
        return frozenset(named)

    def _check_scalars(self) -> None:
        """Reject names of scalars that the rules for numbers would take for something else."""
        counts = {f.index: f.count for f in self.families.values()}
        taken = _names(self.families)
        if self.running & (taken | RESERVED | self.arbitrary):
            raise Rejected("a running parameter is declared as something else as well")
        if self.arbitrary & (taken | RESERVED | self.nonnegative) or {COMPLEX, UNIT} & self.nonnegative:
            raise Rejected("an arbitrary parameter, s or j is declared as something else as well")
        if taken & RESERVED or any(counts[f.index] != f.count for f in self.families.values()):
            raise Rejected("roots are numbered by an index of their own, from 1 to one count")
        if self.nonnegative & self._pending():
            raise Rejected("a number that stands for another is nonnegative by its definition, or by a hypothesis")

    def _progressions(self) -> dict[str, Progression]:
        """Return the sequences, each of scalars of its own that nothing else has a meaning for."""
        pending, atoms = self._pending(), {d.name for d in self.declared.values() if isinstance(d, DeclaredAtom)}
        letters = [*self.sequences, *(after.name for _, after in self.sequences.values())]
        taken = {*RESERVED, STEPS, *self.running, *self.arbitrary} | _names(self.families)
        if self.sequences and STEPS in {*self.running, *self.arbitrary, *pending} | _names(self.families):
            raise Rejected(f"{STEPS} is the number of steps, and stands for nothing else")
        if len(set(letters)) < len(letters) or {*taken, *atoms, *self.nonnegative} & {*letters}:
            raise Rejected("a member of a sequence is declared as something else as well")
        if pending & self.sequences.keys():
            raise Rejected("a member of a sequence is defined by its start and the one before, and by nothing else")
        found = dict[str, Progression]()
        for name, (start, after) in self.sequences.items():
            match start:
                case Number(value=number):
                    found[name] = Progression(constant(number), after.name, first_of(name))
                case Symbol(name=first, scalar=True) if first not in {*taken, *letters, *pending}:
                    found[name] = Progression(scalar(first), after.name, first_of(name))
                case _:
                    raise Rejected(f"{name} starts neither at a number nor at a parameter")
        return found

    def settle(self, reading: Reading, learnt: Equation | None = None) -> Reading:
        """Adopt every declaration whose reasons are available by now, in the order of declaration.

        An equation that was ``learnt`` is a reason for nothing but an inverse that waits for two identities.
        """
        if learnt is not None and learnt.relation == "=" and not any(self._wait_for_identities(reading)):
            return reading
        for item in self.declared.values():
            if item.name in reading.adopted or _waits(item, reading):
                continue
            if not self._early(item, reading):
                try:
                    reading = declare(reading, item)
                except MissingInverse:
                    continue
        return reading

    def _wait_for_identities(self, reading: Reading) -> Iterator[bool]:
        for item in self.declared.values():
            if isinstance(item, DeclaredInverse) and item.name not in reading.adopted:
                yield not isinstance(item.because, str)

    def _early(self, item: Declared | DeclaredInverse | DeclaredFact | DeclaredAtom, reading: Reading) -> bool:
        """Tell whether a declaration speaks of a scalar whose definition is not adopted yet."""
        if item.name not in self.speaks_of:
            names = {n.name for t in terms_of(item) for n in walk(t) if isinstance(n, Symbol) and n.scalar}
            self.speaks_of[item.name] = frozenset(names)
        used = self.speaks_of[item.name]
        return bool(used) and any(
            isinstance(d.statement.lhs, Symbol) and d.statement.lhs.name in used
            for d in self.declared.values()
            if isinstance(d, Declared) and defines(d) and d is not item and d.name not in reading.adopted
        )

    def sizes(self) -> set[str]:
        """Return the names of the dimensions."""
        return {size for s in self.symbols.values() for size in (s.rows, s.cols) if size}


def _names(families: Mapping[str, Family]) -> set[str]:
    """Return the scalars that stand for roots, their parts, indices and counts."""
    return {n for f in families.values() for n in (f.real, f.imaginary, f.index, f.count)} | set(families)


def first_of(member: str) -> str:
    """Return the name of the definition of the first member of a sequence."""
    return f"{member} at the start"


def _waits(item: Declared | DeclaredInverse | DeclaredFact | DeclaredAtom, reading: Reading) -> bool:
    """Tell whether the fact by which an atom exists is not there yet."""
    return isinstance(item, DeclaredAtom) and bool(item.because) and item.because not in reading.context.facts


def defines(item: Declared) -> bool:
    """Tell whether a declaration is a definition, and no recursion."""
    return item.kind == "definition" and not item.every


def terms_of(item: Declared | DeclaredInverse | DeclaredFact | DeclaredAtom) -> tuple[Term, ...]:
    """Return the terms that a declaration speaks of."""
    if isinstance(item, Declared):
        return item.statement.lhs, item.statement.rhs
    return (item.matrix,) if isinstance(item, DeclaredFact) else (item.of,)


def declare(reading: Reading, item: Declared | DeclaredInverse | DeclaredFact | DeclaredAtom) -> Reading:
    """Extend a reading by one declaration of the theory."""
    _check_hypothesis(item, reading)
    if isinstance(item, Declared) and item.statement.relation == ":=" and isinstance(item.statement.lhs, Symbol):
        below = frozenset(n.name for n in walk(item.statement.rhs) if isinstance(n, Symbol))
        letters = {**reading.real.letters, item.statement.lhs.name: below}
        _check_letter(item.statement, reading)
        reading = replace(reading, real=replace(reading.real, letters=letters))
    reading = replace(
        reading, real=replace(reading.real, fixed={**reading.real.fixed, item.name: _fixed(item, reading)})
    )
    if isinstance(item, Declared):
        reading = adopt(reading, item.name, item.statement)
    elif isinstance(item, DeclaredFact):
        if item.kind not in KINDS:
            raise Rejected(f"{item.name}: {item.kind} is no kind of matrix")
        reading = _with_fact(reading, item.name, Fact(item.kind, lower(item.matrix, reading)))
    elif isinstance(item, DeclaredAtom):
        reading = adopt_atom(reading, item.name, item.kind, item.of, item.because)
    else:
        reading = adopt_inverse(reading, item)
    return replace(reading, adopted=reading.adopted | {item.name})


def _check_letter(statement: Equation, reading: Reading) -> None:
    """Reject the definition of a matrix that depends on s or j, unless the letter is said to be complex."""
    lhs = statement.lhs
    if isinstance(lhs, Symbol) and not lhs.scalar and lhs.name not in reading.context.complex:
        polys = [poly for row in lower(statement.rhs, reading) for poly in row]
        if any(behind(poly, reading) & {COMPLEX, UNIT} for poly in polys):
            raise Rejected(f"{lhs.name} is not declared to be complex, but what it stands for may be")


def _fixed(item: Declared | DeclaredInverse | DeclaredFact | DeclaredAtom, reading: Reading) -> frozenset[str]:
    """Return the scalars that a hypothesis holds at some value, and that no limit or derivative may move.

    x > 0 and x ≥ 0 are true of all values that a variable takes, but the number of steps is 0 as well; so is an
    equation between functions of s. What is declared for every number of steps holds k nowhere.
    """
    if isinstance(item, (DeclaredInverse, DeclaredAtom)) or (isinstance(item, Declared) and item.generic):
        return frozenset()
    real = reading.real
    nodes = [n for t in terms_of(item) for n in walk(t)]
    found = reading.real.reached(n.name for n in nodes if isinstance(n, Symbol))
    found -= {name for f in reading.real.families.values() for name in (f.index, f.count)}
    functions = [n for node in nodes if isinstance(node, (Det, Trace, Roots)) for n in walk(node)]
    if isinstance(item, DeclaredFact) or any(isinstance(n, Symbol) and n.name == COMPLEX for n in functions):
        found -= {COMPLEX}
    if any(isinstance(n, Symbol) and not n.scalar and n.name in reading.context.complex for n in nodes):
        found -= {COMPLEX}
    match item:
        case Declared(every=True):
            return frozenset(found - {STEPS})
        case Declared(statement=Equation(Symbol(name=name), ">" | "≥", Zero())) if not (
            name in real.atoms or (real.sequences and real.varies(name, STEPS))
        ):
            return frozenset()
        case Declared(statement=Equation(Symbol(scalar=True), ":=", _)):
            return frozenset()
        case Declared(statement=Equation(Limit(_, symbol, _), _, _)):
            return frozenset(found - {symbol.name})
        case _:
            return frozenset(found)


def _check_hypothesis(item: Declared | DeclaredInverse | DeclaredFact | DeclaredAtom, reading: Reading) -> None:
    """Reject a hypothesis on an arbitrary parameter, unless it holds for all but one value of a variable.

    A scalar may be defined by one, and an atom made of it: its reason is a fact that is proved. The same for a running
    parameter r, of which it is known that r > 0.
    """
    if isinstance(item, DeclaredAtom):
        return
    real, names = reading.real, {n.name for t in terms_of(item) for n in walk(t) if isinstance(n, Symbol)}
    _check_recursion(item, names, reading)
    match item:
        case Declared(statement=Equation(Sum((Power(x, 2), Power(a, 2))), ">", Zero())) if item.generic:
            shift, width = value(x, reading) - scalar(item.generic), value(a, reading)
            used, steps = scalars_of(shift) | scalars_of(width), (STEPS,) if real.sequences else ()
            variables = (COMPLEX, FREQUENCY, TIME, *steps, *real.running)
            moving = any(real.varies(s, v) for s in used for v in variables)
            if (
                item.generic not in (COMPLEX, FREQUENCY, *real.running)
                or moving
                or not (is_real(shift, reading) and is_real(width, reading))
            ):
                raise Rejected(
                    f"{item.name}: x must be the variable and a real shift, a must be real and not depend on it"
                )
        case Declared(statement=Equation(Symbol(name=r), ">", Zero())) if r in real.running and not item.generic:
            pass
        case Declared(statement=Equation(Symbol(scalar=True) as lhs, ":=", _)) if not item.generic:
            if lhs.name in RESERVED | real.arbitrary | real.running | _names(real.families):
                raise Rejected(f"{item.name}: {lhs.name} has a meaning already")
        case _ if getattr(item, "generic", "") or real.reached(names) & (real.arbitrary | real.running):
            raise Rejected(f"{item.name}: nothing may be assumed of an arbitrary or running parameter")
        case _:
            pass


def _check_recursion(
    item: Declared | DeclaredInverse | DeclaredFact | DeclaredAtom, names: set[str], reading: Reading
) -> None:
    """Reject a next member that depends on what the rules vary, and what is said of every k but is no recursion."""
    if not isinstance(item, Declared):
        return
    lhs, real, next_ = item.statement.lhs, reading.real, reading.real.following
    defines = item.statement.relation == ":=" and isinstance(lhs, Symbol) and lhs.name in next_
    starts = isinstance(lhs, Start) and item.statement.relation == ":="
    if item.every and not starts and (item.statement.relation != "=" or not names & (next_ - real.pending)):
        raise Rejected(f"{item.name}: it does not say how a sequence goes on")
    if item.every and not starts and not scalars_of(value(lhs, reading) - value(item.statement.rhs, reading)) & next_:
        raise Rejected(f"{item.name}: the next member drops out of it")
    varied = {COMPLEX, UNIT, FREQUENCY, *real.arbitrary, *real.running} | _names(real.families)
    if (defines or item.every) and real.reached(names) & (varied | ({TIME} if item.every else set())):
        raise Rejected(f"{item.name}: a sequence depends on nothing that the rules vary")
    if defines and not is_real(value(item.statement.rhs, reading), reading):
        raise Rejected(f"{item.name}: a sequence consists of real numbers")


def adopt(reading: Reading, name: str, statement: Equation) -> Reading:
    """Extend a reading by a statement that is declared or proved.

    d/dt x = f and E[a b'] = f become entries of the tables of derivatives and moments, X >= 0 and X > 0 facts,
    everything else a relation lhs - rhs = 0 (one a block).
    """
    context, lhs, rhs = reading.context, statement.lhs, statement.rhs
    if is_scalar(statement):
        return adopt_scalar(reading, name, statement)
    if statement.relation in FACT_OF:
        matrix = lower(lhs, reading) if _is_zero(rhs) else _difference(statement, reading)
        return _with_fact(reading, name, Fact(FACT_OF[statement.relation], matrix))
    if statement.relation not in ("=", ":="):
        raise Rejected(f"{statement.relation} is no relation between matrices")
    match lhs:
        case Dot(Symbol() as x) if x.letter not in context.derivatives:
            ((rate,),) = lower(rhs, reading)
            context = replace(context, derivatives={**context.derivatives, x.letter: rate})
            return replace(reading, context=context, origins={**reading.origins, x.letter: name})
        case Expect(Product((Symbol() as a, Transpose(Symbol() as b)))):
            ((moment,),) = lower(rhs, reading)
            key = (a.letter, context.alphabet.flip(b.letter))
            if key not in context.moments:
                context = replace(context, moments={**context.moments, key: moment})
                return replace(reading, context=context, origins={**reading.origins, key: name})
        case _:
            pass
    grid = _difference(statement, reading)
    named = {
        name if len(grid) == len(row) == 1 else f"{name}[{i + 1},{j + 1}]": p
        for i, row in enumerate(grid)
        for j, p in enumerate(row)
        if p.terms
    }
    return replace(reading, context=replace(context, relations={**context.relations, **named}))


def adopt_inverse(reading: Reading, item: DeclaredInverse) -> Reading:
    """Extend a reading by the two relations of an inverse, if its reason holds.

    M X = I, X M = I;  the inverse of a matrix that may be complex may be complex

    Raises:
        MissingInverse: the reason is not proved yet.
        Rejected: the reason is about something else.
    """
    context = reading.context
    ((poly,),) = lower(item.of, reading)
    _check_reason(item, poly, reading)
    if context.alphabet.letters[item.name].symmetric and context.alphabet.transpose(poly) != poly:
        raise Rejected(f"{item.name} is declared symmetric, but what it inverts is not")
    inverse = Poly({((), (item.name,)): Fraction(1)}, poly.cols, poly.rows)
    relations = {
        **context.relations,
        f"{item.name}.right": poly * inverse - identity(poly.rows),
        f"{item.name}.left": inverse * poly - identity(poly.cols),
    }
    because = (item.because,) if isinstance(item.because, str) else item.because
    real = replace(reading.real, reasons={**reading.real.reasons, item.name: because})
    unreal = context.complex if context.is_real(poly) else context.complex | {item.name}
    context = replace(context, relations=relations, complex=unreal)
    return replace(reading, context=context, inverses={**reading.inverses, poly: item.name}, real=real)


def _check_reason(item: DeclaredInverse, poly: Poly, reading: Reading) -> None:
    """Reject an inverse of M without a reason: M > 0, M invertible, or M X = I and X M = I for the term X."""
    context = reading.context
    if isinstance(item.because, str):
        fact = context.facts.get(item.because)
        found = fact and fact.kind in ("pd", "invertible") and fact.matrix == ((poly,),)
        missing = [] if fact else [item.because]
    else:
        ((by,),) = lower(item.by or item.of, reading)
        wanted = (poly * by - identity(poly.rows), by * poly - identity(poly.cols))
        missing = [name for name in item.because if name not in context.relations]
        found = all(context.relations.get(n) == p for n, p in zip(item.because, wanted, strict=True))
    if missing:
        raise MissingInverse(f"{' and '.join(missing)} not proved yet")
    if not found:
        raise Rejected(f"{item.because} is not a reason why {item.name} exists")


class Consulted(dict):  # type: ignore[type-arg]
    """A table of derivatives or moments that notes which of its entries were read."""

    def __init__(self, table: Mapping[Any, Poly]):
        super().__init__(table)
        self.read: set[Any] = set()

    def get(self, key: Any, default: Any = None) -> Any:
        """Return the entry and note it."""
        if key in self:
            self.read.add(key)
        return super().get(key, default)

    def __getitem__(self, key: Any) -> Poly:
        self.read.add(key)
        return super().__getitem__(key)


def consulting(reading: Reading) -> tuple[Reading, Consulted, Consulted]:
    """Return the reading with tables that note what is read."""
    derivatives, moments = Consulted(reading.context.derivatives), Consulted(reading.context.moments)
    context = replace(reading.context, derivatives=derivatives, moments=moments)
    return replace(reading, context=context), derivatives, moments


def names_of(name: str, relations: Mapping[str, Poly]) -> list[str]:
    """Return the relations that a declaration or lemma stands for: itself, its blocks, or both sides of an inverse."""
    return [r for r in relations if r == name or r.startswith((name + "[", name + "."))]


def owner(name: str) -> str:
    """Return the declaration or lemma that a relation stands for."""
    return re.sub(r"(\[\d+,\d+\]|\.left|\.right)$", "", name)


def _with_fact(reading: Reading, name: str, fact: Fact) -> Reading:
    return replace(reading, context=replace(reading.context, facts={**reading.context.facts, name: fact}))


def _is_zero(term: Term) -> bool:
    return isinstance(term, Zero)


def _difference(statement: Equation, reading: Reading) -> Grid:
    if _is_zero(statement.rhs):
        return lower(statement.lhs, reading)
    lhs, rhs = lower(statement.lhs, reading), lower(statement.rhs, reading)
    if len(lhs) != len(rhs) or len(lhs[0]) != len(rhs[0]):
        raise Rejected("the two sides have different block shapes")
    return tuple(tuple(p - q for p, q in zip(r, s, strict=True)) for r, s in zip(lhs, rhs, strict=True))
