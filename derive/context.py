"""Theories: typed symbols, definitions and hypotheses.

A theory is declared in Python and installed with the package (declared.py). A derivation starts from
``theory.reading()`` and grows it by ``adopt``, one proved statement at a time (adopting.py); files carry names only,
never relations.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import Literal

from derive.adopting import Consulted, adopt, adopt_inverse, by_name, consulting, declare, names_of, owner
from derive.declared import (
    Declared,
    DeclaredAtom,
    DeclaredFact,
    DeclaredInverse,
    Item,
    defines,
    first_of,
    names_of_roots,
    terms_of,
)
from derive.functions import Power, Start
from derive.kernel import Alphabet, Letter, Rejected, identity
from derive.real import COMPLEX, RESERVED, STEPS, SUPPOSED, UNIT, Family, Progression, Real, constant, scalar
from derive.rules import Context, Fact
from derive.terms import Equation, Glyph, MissingInverse, Number, Reading, Sum, Symbol, Term, Zero, lower
from derive.waiting import Wait, waits_of

__all__ = [
    "Consulted", "Declared", "DeclaredAtom", "DeclaredFact", "DeclaredInverse", "Item", "Theory", "adopt",
    "adopt_inverse", "by_name", "consulting", "declare", "defines", "names_of", "owner", "terms_of",
]  # fmt: skip


@dataclass
class Theory:
    """Symbols, definitions and hypotheses under one key; filled by its module's ``theory()`` function."""

    key: str
    title: str
    symbols: dict[str, Symbol] = field(default_factory=dict[str, Symbol])
    declared: dict[str, Item] = field(default_factory=dict)
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
    waits: tuple[dict[str, Item], dict[str, Wait]] = ({}, {})  # what is declared, and what each waits for

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
        taken = names_of_roots(self.families)
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
        taken = {*RESERVED, STEPS, *self.running, *self.arbitrary} | names_of_roots(self.families)
        if self.sequences and STEPS in {*self.running, *self.arbitrary, *pending} | names_of_roots(self.families):
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
        """Adopt every declaration that what is there allows, until nothing more comes.

        An equation that was ``learnt`` is a reason for nothing but an inverse that waits for two identities.
        """
        if self.waits[0] != self.declared:
            self.waits = dict(self.declared), waits_of(self.declared)
        if learnt is not None and learnt.relation == "=" and not self._wait_for_identities(reading):
            return reading
        before: frozenset[str] | None = None
        while before != reading.adopted:
            before = reading.adopted
            for name, wait in self.waits[1].items():
                if name not in reading.adopted and wait.over(reading):
                    try:
                        reading = declare(reading, self.declared[name])
                    except MissingInverse:
                        continue
        return reading

    def _wait_for_identities(self, reading: Reading) -> bool:
        items = (d for d in self.declared.values() if isinstance(d, DeclaredInverse))
        return any(d.name not in reading.adopted and not isinstance(d.because, str) for d in items)

    def sizes(self) -> set[str]:
        """Return the names of the dimensions."""
        return {size for s in self.symbols.values() for size in (s.rows, s.cols) if size}
