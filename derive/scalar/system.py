"""What a theory says of real numbers: letters that others stand for, facts of sign, and equations that remain.

With every dimension 1, each relation of a theory is an equation between fractions. One that is linear in a letter, with
a factor that is known not to vanish, gives that letter away: the Riccati equation gives the process noise, so that
covariance and plant stay free. A hypothesis M >= 0 becomes a fact of sign, a stabilising solution the closed condition
of the strong one. Part of the trust base: what is read here is what a proof may use. Standard library only.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from fractions import Fraction
from itertools import combinations
from typing import Any

from derive.context import Declared, DeclaredAtom, DeclaredFact, DeclaredInverse
from derive.interpret.statement import Statement
from derive.kernel import ANY, Poly
from derive.latex import plain as text
from derive.real import CIRCLE
from derive.scalar.ratio import Beyond, Numbers, Ratio, Ring, name_of, plain
from derive.terms import Block, Dot, Equation, Neg, Number, Product, Sum, Symbol, Term, Zero, walk

__all__ = ["POWERS", "ROOTS", "Case", "Split", "System", "names_in", "system"]

KINDS = {"≥": "nonnegative", "⪰": "nonnegative", ">": "positive", "≻": "positive", "≠": "nonzero"}
ONE = Number(Fraction(1))
POWERS = tuple(f"exp {i}" for i in range(1, 5))  # letters for exponentials
ROOTS = tuple(f"√{i}" for i in range(1, 9))  # letters for roots
COMPLEX = ("s", "z", "j")

Choice = tuple[tuple[str, Any], ...]  # kinds of fact and polynomials, of which one holds
Case = tuple[str, Poly]  # "=" or a kind of fact, and the polynomial in letters


class Split(Exception):  # noqa: N818 - a question, no fault
    """The sign of a polynomial decides what a term is, and it is not known."""

    def __init__(self, poly: Poly):
        super().__init__("a sign decides")
        self.poly = poly


@dataclass(frozen=True)
class Condition:
    """A hypothesis of sign: term of a kind, and the name of the declaration that it comes from."""

    name: str
    kind: str
    term: Term
    origin: str


@dataclass
class System:
    """Letters with values, and what is known of the others.

    ``facts`` are named polynomials with their kind, ``relations`` named polynomials that are zero; ``origins`` the
    declarations that they come from. Of each tuple in ``alternatives`` one holds. ``roots`` are letters with r >= 0 and
    r^2 = s, ``exponentials`` letters with their arguments. ``impossible`` names a fact that is a false statement about
    numbers.
    """

    ring: Ring
    values: dict[str, Ratio] = field(default_factory=dict[str, Ratio])
    facts: dict[str, tuple[str, Any]] = field(default_factory=dict[str, tuple[str, Any]])
    relations: dict[str, Any] = field(default_factory=dict[str, Any])
    origins: dict[str, str] = field(default_factory=dict[str, str])
    solved: dict[str, str] = field(default_factory=dict[str, str])  # letter -> declaration that gives it
    alternatives: list[Choice] = field(default_factory=list[Choice])
    signs: dict[str, tuple[int, bool]] = field(default_factory=dict[str, tuple[int, bool]])  # of letters; strict
    roots: list[tuple[Ratio, str]] = field(default_factory=list[tuple[Ratio, str]])
    exponentials: list[tuple[Ratio, str]] = field(default_factory=list[tuple[Ratio, str]])
    impossible: str = ""
    consulted: set[str] = field(default_factory=set[str])  # letters and facts whose sign was asked for

    # ------------------------------------------------------------------------------------- at sight
    def sight(self, poly: Any) -> tuple[int, bool] | None:
        """Return the sign of a polynomial all of whose addends have it (0: unknown), and whether one is not zero."""
        found, strict, used = 0, False, set[str]()
        for (names, _), c in self.ring.poly(poly).terms.items():
            used.update(names)
            sign, firm = 1 if c > 0 else -1, True
            for name in set(names):
                known, above = self.signs.get(name, (0, False))
                odd = names.count(name) % 2
                if odd and not known:
                    return None
                sign, firm = sign * (known if odd else 1), firm and above
            if found and sign != found:
                return None
            found, strict = sign, strict or firm
        self.consulted |= used
        return found, strict

    def positive(self, poly: Any) -> bool:
        """Tell whether a polynomial is positive at sight."""
        return self.sight(poly) == (1, True)

    def nonzero(self, poly: Any) -> bool:
        """Tell whether a polynomial is known not to vanish: at sight, or because a fact says so up to a factor."""
        found = self.sight(poly)
        if found is not None and found[1]:
            return True
        for name, (kind, p) in self.facts.items():
            if kind != "nonnegative" and proportional(self.ring, poly, p):
                self.consulted.add(name)
                return True
        return False

    # ------------------------------------------------------------------------------------- building
    def numbers(self) -> Numbers:
        """Return a reader of hypotheses: they are meaningful, so what they divide by is not zero."""
        return Numbers(self.ring, self.values, _Given(self))

    def fact(self, name: str, kind: str, poly: Any, origin: str) -> None:
        """Note a fact, unless it is a statement about numbers."""
        plain = self.ring.poly(poly)
        if not any(m for m, _ in plain.terms):
            value = plain.terms.get(((), ()), Fraction(0))
            true = {"nonnegative": value >= 0, "positive": value > 0, "nonzero": value != 0}[kind]
            self.impossible = self.impossible or ("" if true else origin)
            return
        self.facts[name], self.origins[name] = (kind, poly), origin
        if len(plain.terms) == 1 and kind in ("nonnegative", "positive", "nonzero"):
            (((names, _), c),) = plain.terms.items()
            if len(names) == 1:
                self._know(names[0], 0 if kind == "nonzero" else 1 if c > 0 else -1, kind != "nonnegative")
                self._strictly(name, names[0], origin)

    def _strictly(self, name: str, letter: str, origin: str) -> None:
        """Note x > 0 of a letter that is known to be >= 0 and not zero, if no fact says so."""
        sign, strict = self.signs[letter]
        value = self.ring.letter(letter)
        said = any(k == "positive" and proportional(self.ring, p, value) for k, p in self.facts.values())
        if sign and strict and not said:
            turned = value if sign > 0 else -value
            self.facts[f"{name}, strictly"], self.origins[f"{name}, strictly"] = ("positive", turned), origin

    def _know(self, letter: str, sign: int, strict: bool) -> None:
        known, above = self.signs.get(letter, (0, False))
        self.signs[letter] = known or sign, above or strict

    def give(self, letter: str, value: Ratio, origin: str) -> None:
        """Let a letter stand for a fraction, also in what is there already."""
        numbers = Numbers(self.ring, {letter: value}, _Given(self))
        for name, old in list(self.values.items()):
            if letter in letters(self.ring, old):
                self.values[name] = _inserted(old, numbers)
        self.values[letter], self.solved[letter] = value, origin

    def settle(self) -> None:
        """Insert what letters stand for in facts and equations, and solve equations, until nothing changes."""
        changed = True
        while changed:
            changed = False
            for name, poly in list(self.relations.items()):
                top = self._rewritten(poly)
                if not self.ring.poly(top).terms:
                    del self.relations[name]
                    continue
                self.relations[name] = top
                found = None if name in dict.fromkeys(r for _, r in self.roots) else self._solve(top, "")
                if found is not None:
                    del self.relations[name]
                    self.give(*found, self.origins.get(name, name))
                    changed = True
                elif not any(m for m, _ in self.ring.poly(top).terms):
                    self.impossible = self.origins.get(name, name)
        facts, self.facts = self.facts, {}
        for name, (kind, poly) in facts.items():
            self.fact(name, kind, self._rewritten(poly, sign=True), self.origins[name])
        if self.values:
            numbers = Numbers(self.ring, self.values, _Given(self))
            self.roots = [(_inserted(s, numbers), name) for s, name in self.roots]
        self.alternatives = [c for choice in self.alternatives if (c := self._open(choice))]

    def _open(self, choice: Choice) -> Choice | None:
        """Drop alternatives that are false at sight; the last that is left is a fact."""
        left = tuple(c for c in choice if not self._false(*c))
        if len(left) == 1:
            self.fact(f"detectable {len(self.facts)}", *left[0], "detectable")
        elif not left:
            self.impossible = self.impossible or "detectable"
        return left if len(left) > 1 else None

    def _false(self, kind: str, poly: Any) -> bool:
        found = self.sight(poly)
        if not self.ring.poly(poly).terms:
            return kind != "nonnegative"
        return kind == "positive" and found is not None and found[0] < 0

    def _rewritten(self, poly: Any, sign: bool = False) -> Any:
        if not set(self.values) & {x for m, _ in self.ring.poly(poly).terms for x in m}:
            return poly
        numbers = self.numbers()
        value = numbers.evaluate(self.ring.poly(poly))
        return numbers.same_sign(value) if sign else value.top

    def equation(self, name: str, lhs: Term, rhs: Term) -> None:
        """Take up an equation: solve it for a letter, or keep it."""
        numbers = self.numbers()
        top = numbers.add(numbers.read(lhs), numbers.negative(numbers.read(rhs))).top
        self.origins[name] = name
        plain = self.ring.poly(top).terms
        if not plain:
            return
        if not any(m for m, _ in plain):
            self.impossible = self.impossible or name
            return
        found = self._solve(top, name_of(lhs) if isinstance(lhs, Symbol) else "")
        if found is None:
            self.relations[name] = top
        else:
            self.give(*found, name)

    def _solve(self, top: Any, wanted: str) -> tuple[str, Ratio] | None:
        """Return a letter in which a polynomial is linear, with a factor that does not vanish, and its value."""
        plain = self.ring.poly(top)
        counts = {x: max(m.count(x) for m, _ in plain.terms) for m, _ in plain.terms for x in m}
        best: tuple[int, int, str, Poly, Poly] | None = None
        for i, x in enumerate(sorted(counts)):
            if counts[x] != 1 or x.startswith("√"):
                continue
            factor = Poly(
                {(tuple(n for n in m if n != x), ()): c for (m, _), c in plain.terms.items() if x in m}, ANY, ANY
            )
            rest = Poly({k: c for k, c in plain.terms.items() if x not in k[0]}, ANY, ANY)
            number = not any(m for m, _ in factor.terms)
            if number or self.nonzero(self.ring.of(factor)):
                rank = 0 if x == wanted else 1 if number else 2
                if best is None or (rank, -i) < best[:2]:
                    best = rank, -i, x, factor, rest
        if best is None:
            return None
        numbers = self.numbers()
        _, _, x, factor, rest = best
        return x, numbers.over(Ratio(self.ring.of(-rest)), Ratio(self.ring.of(factor)))

    def root(self, poly: Any) -> str:
        """Return the letter of the root of a polynomial."""
        for s, name in self.roots:
            if not s.bottom and s.top == poly:
                return name
        if len(self.roots) == len(ROOTS):
            raise Beyond("more roots than are decided at once")
        name = ROOTS[len(self.roots)]
        r = self.ring.letter(name)
        self.roots.append((Ratio(poly), name))
        self.relations[name], self.origins[name] = r * r - poly, ""
        self.fact(f"{name} ≥ 0", "nonnegative", r, "")
        return name

    def exponential(self, argument: Ratio, sign: int, numbers: Numbers) -> Ratio:
        """Return exp of a number whose sign is known, as a power of the exponential of its part without a factor."""
        top = self.ring.poly(argument.top)
        if not top.terms:
            return numbers.number(1)
        times = proportional(self.ring, argument.top, self.ring.of(plain(top))) or Fraction(1)
        if abs(times.numerator) > 8:
            raise Beyond("an exponential of a large multiple")
        base = Ratio(self.ring.of(plain(top).scale(Fraction(1, times.denominator))), argument.bottom)
        letter = self._letter_of_exp(base, sign if times > 0 else -sign, numbers)
        power = numbers.number(1)
        for _ in range(abs(times.numerator)):
            power = numbers.multiply(power, Ratio(self.ring.letter(letter)))
        return power if times > 0 else numbers.over(numbers.number(1), power)

    def _letter_of_exp(self, base: Ratio, sign: int, numbers: Numbers) -> str:
        """Return the letter e of exp(x): e > 0, e >= 1 + x, and e >= 1 or e <= 1 as the sign of x says."""
        for known, name in self.exponentials:
            if base.top * numbers.product_of(known.bottom) == known.top * numbers.product_of(base.bottom):
                return name
        if len(self.exponentials) == len(POWERS):
            raise Beyond("more exponentials than are decided at once")
        name = POWERS[len(self.exponentials)]
        self.exponentials.append((base, name))
        value, one = self.ring.letter(name), self.ring.constant(Fraction(1))
        tangent = numbers.add(Ratio(value - one), numbers.negative(base))
        self.fact(f"{name} > 0", "positive", value, "")
        self.fact(f"{name} beside 1", "nonnegative", value - one if sign > 0 else one - value, "")
        self.fact(f"{name} above its tangent", "nonnegative", numbers.same_sign(tangent), "")
        return name


class _Given:
    """Answers for hypotheses: they are given, and so is what they need."""

    def __init__(self, system: System):
        self.system = system

    def nonzero(self, poly: Any) -> None:
        if not self.system.nonzero(poly) and self.system.ring.poly(poly).terms:
            name = f"defined {len(self.system.facts)}"
            self.system.fact(name, "nonzero", poly, "")
        elif not self.system.ring.poly(poly).terms:
            self.system.impossible = self.system.impossible or "a division by zero"

    def sign(self, poly: Any) -> int:
        return sign_of(self.system, poly)

    def positive(self, poly: Any) -> bool:
        return self.system.positive(poly)

    def square(self, poly: Any) -> tuple[Any, Any]:
        self.system.fact(f"radicand {len(self.system.facts)}", "nonnegative", poly, "")
        return self.system.ring.constant(Fraction(1)), poly

    def root(self, poly: Any) -> Any:
        return self.system.ring.letter(self.system.root(poly))

    def exponential(self, argument: Ratio) -> Ratio:
        raise Beyond("an exponential that is assumed is not decided")


def sign_of(known: System, poly: Any) -> int:
    """Return s with s * poly >= 0, at sight or by a fact.

    Raises:
        Split: the sign is not known.
    """
    found = known.sight(poly)
    if found is not None:
        return found[0] or 1
    for name, (kind, p) in known.facts.items():
        ratio = proportional(known.ring, poly, p) if kind != "nonzero" else None
        if ratio is not None:
            known.consulted.add(name)
            return 1 if ratio > 0 else -1
    raise Split(known.ring.poly(poly))


def proportional(ring: Ring, one: Any, two: Any) -> Fraction | None:
    """Return c with one = c * two, if there is one."""
    if ring.size(one) != ring.size(two):
        return None
    a, b = ring.poly(one).terms, ring.poly(two).terms
    if not a or a.keys() != b.keys():
        return None
    key = next(iter(a))
    ratio = a[key] / b[key]
    return ratio if all(c == ratio * b[k] for k, c in a.items()) else None


def letters(ring: Ring, value: Ratio) -> set[str]:
    """Return the letters in a fraction."""
    polys = (value.top, *(f for f, _ in value.bottom))
    return {x for p in polys for m, _ in ring.poly(p).terms for x in m}


def _inserted(value: Ratio, numbers: Numbers) -> Ratio:
    ring, total = numbers.ring, numbers.evaluate(numbers.ring.poly(value.top))
    for factor, exponent in value.bottom:
        below = numbers.evaluate(ring.poly(factor))
        for _ in range(exponent):
            total = numbers.over(total, below)
    return total


# ---------------------------------------------------------------------------------------------- reading a theory
def system(
    statement: Statement, ring: Ring, cases: Sequence[Case] = (), without: frozenset[str] = frozenset()
) -> System:
    """Read all that a statement's theory says of numbers; ``cases`` are assumed as well, ``without`` is left out.

    Raises:
        Beyond: an assumption that is not about real numbers.
        Split: an assumption has |.| of a number whose sign is not known.
    """
    found = System(ring)
    theory, assumed = statement.theory.theory, frozenset(statement.assumed)
    unknown = [e.relation for e in statement.theory.conditions if e.relation not in (*KINDS, "=", ":=")]
    if unknown:
        raise Beyond(f"the relation {unknown[0]} is not decided between numbers")
    if statement.scalar:
        found.values |= {n: found.numbers().number(1) for n in theory.sizes() if n in theory.symbols}
    items = [item for name, item in theory.declared.items() if name not in without]
    conditions = [c for item in items for c in _conditions(item, assumed)]
    extra = [e for e in statement.theory.conditions if text(e) not in without]
    conditions += [Condition(text(e), KINDS[e.relation], e.lhs - e.rhs, text(e)) for e in extra if e.relation in KINDS]
    for c in conditions:  # the signs of letters come first: they tell what may be divided by
        match c.term:
            case Symbol() | Sum((Symbol(), Neg(Zero() | Number(Fraction(numerator=0))))):
                letter = c.term if isinstance(c.term, Symbol) else c.term.addends[0]
                found._know(name_of(letter), 0 if c.kind == "nonzero" else 1, c.kind != "nonnegative")  # type: ignore[arg-type]
            case Neg(Symbol() as letter) if c.kind != "nonzero":
                found._know(name_of(letter), -1, c.kind == "positive")
            case _:
                pass
    for i, (relation, poly) in enumerate(cases):
        if relation != "=":
            found.fact(f"case {i + 1}", relation, ring.of(poly), "")
    for i, (relation, poly) in enumerate(cases):
        if relation == "=":
            value = found.numbers().evaluate(poly)
            solved = found._solve(value.top, "")
            name = f"case {i + 1}"
            found.origins[name] = ""
            if solved is not None:
                found.give(*solved, "")
            else:
                found.relations[name] = value.top
    user = [(text(e), e.lhs, e.rhs) for e in extra if e.relation in ("=", ":=")]
    user += [e for item in items if item.name in assumed for e in _equations(item, strict=True)]
    for name, lhs, rhs in user:
        found.equation(name, lhs, rhs)
    for item in items:
        if item.name not in assumed:
            for name, lhs, rhs in _equations(item, strict=False):
                try:
                    found.equation(name, lhs, rhs)
                except Beyond:
                    continue
    for c in conditions:
        try:
            poly = found.numbers().same_sign(found.numbers().read(c.term))
            found.fact(c.name, c.kind, poly, c.origin)
        except Beyond:
            if c.origin in assumed or c.origin in map(text, extra):
                raise
    for item in items:
        if isinstance(item, DeclaredFact) and item.case and item.name not in assumed:
            found.alternatives += _detectable(item, found)
    found.settle()
    found.consulted.clear()
    return found


def _equations(item: object, strict: bool) -> Iterator[tuple[str, Term, Term]]:
    """Iterate over the equations that a declaration makes between numbers."""
    match item:
        case Declared(name=name, statement=Equation(lhs, "=" | ":=", rhs), case=False):
            sides = _entries(lhs, rhs)
            yield from ((name if i == 0 else f"{name} {i + 1}", a, b) for i, (a, b) in enumerate(sides))
        case DeclaredInverse(name=name, of=of):
            yield name, Symbol(name, scalar=True) * of, ONE
        case DeclaredAtom() if strict:
            raise Beyond("a function that is assumed")
        case _:
            return


def _entries(lhs: Term, rhs: Term) -> list[tuple[Term, Term]]:
    if isinstance(lhs, Block) and isinstance(rhs, Block):
        pairs = zip((x for r in lhs.rows for x in r), (x for r in rhs.rows for x in r), strict=True)
        return list(pairs)
    return [(lhs, rhs)]


def _conditions(item: object, assumed: frozenset[str]) -> Iterator[Condition]:
    """Iterate over what a declaration says of signs; a stabilising solution may be at the boundary."""
    match item:
        case Declared(name=name, statement=Equation(lhs, relation, rhs), case=False) if relation in KINDS:
            plain = isinstance(rhs, Zero) or rhs == Number(Fraction(0))
            yield from _minors(name, KINDS[relation], lhs if plain else lhs - rhs)
        case DeclaredFact(name=name, kind=kind, matrix=matrix, case=case):
            firm = "nonnegative" if case and name not in assumed else "positive"
            match kind:
                case "hurwitz":
                    yield Condition(name, firm, Neg(matrix), name)
                case "schur":
                    yield Condition(f"{name}, below", firm, ONE - matrix, name)
                    yield Condition(f"{name}, above", firm, ONE + matrix, name)
                case "invertible":
                    yield Condition(name, "nonzero", matrix, name)
                case "psd":
                    yield from _minors(name, "nonnegative", matrix)
                case "pd":
                    yield from _minors(name, "positive", matrix)
                case _:
                    return
        case _:
            return


def _minors(name: str, kind: str, matrix: Term) -> Iterator[Condition]:
    """Iterate over the principal minors of a block matrix of numbers, of up to three rows."""
    if not isinstance(matrix, Block):
        yield Condition(name, kind, matrix, name)
        return
    size = len(matrix.rows)
    if size > 3 or any(len(row) != size for row in matrix.rows) or any(isinstance(x, Block) for x in matrix.children()):
        return
    for k in range(1, size + 1):
        for chosen in combinations(range(size), k):
            yield Condition(f"{name} {chosen}", kind, _determinant(matrix.rows, chosen, chosen), name)


def _determinant(rows: tuple[tuple[Term, ...], ...], i: tuple[int, ...], j: tuple[int, ...]) -> Term:
    if len(i) == 1:
        return rows[i[0]][j[0]]
    parts = [Product((rows[i[0]][c], _determinant(rows, i[1:], (*j[:n], *j[n + 1 :])))) for n, c in enumerate(j)]
    return Sum(tuple(Neg(p) if n % 2 else p for n, p in enumerate(parts)))


def _detectable(item: DeclaredFact, found: System) -> list[Choice]:
    """Return the alternatives of X - G H with the gain G: the output sees the state, H ≠ 0, or X is stable."""
    match item.matrix:
        case Sum((X, Neg(Product((G, H))))):
            pass
        case _:
            return []
    gain = G if isinstance(G, Symbol) and name_of(G) in found.solved else H
    seen = H if gain is G else G
    numbers = found.numbers()
    x, h = numbers.read(X), numbers.read(seen)
    if item.kind == "hurwitz":
        stable: Ratio = numbers.negative(x)
    else:
        stable = numbers.add(numbers.number(1), numbers.negative(numbers.multiply(x, x)))
    return [(("nonzero", h.top), ("positive", numbers.same_sign(stable)))]


# ---------------------------------------------------------------------------------------------- names
def names_in(statement: Statement) -> list[str]:
    """Return the letters of real numbers that a statement and its theory use, those that others are made of last."""
    found: dict[str, None] = {}
    theory = statement.theory.theory
    sides = [t for e in (*statement.equations, *statement.theory.conditions) for t in (e.lhs, e.rhs)]
    claimed = {name for t in sides for name in _names(t)}
    roots = {*theory.families, *(f.index for f in theory.families.values())}
    barred = {n for n in claimed if n in theory.complex and (n in COMPLEX or not theory.symbols[n].scalar)} | {
        n for n in claimed if n in roots or n == CIRCLE
    }
    if barred:
        raise Beyond(f"{min(barred)} is no real letter")
    if claimed & (theory.random | theory.uncentred):
        raise Beyond("signals are no numbers")
    for item in theory.declared.values():
        if isinstance(item, DeclaredInverse):
            found[item.name] = None
        found |= dict.fromkeys(name for t in _terms(item) for name in _names(t))
    return list(found | dict.fromkeys(sorted(claimed)))


def _terms(item: object) -> tuple[Term, ...]:
    match item:
        case Declared(statement=statement):
            return statement.lhs, statement.rhs
        case DeclaredFact(matrix=matrix):
            return (matrix,)
        case DeclaredInverse(of=of) | DeclaredAtom(of=of):
            return (of,)
        case _:
            return ()


def _names(term: Term) -> Iterator[str]:
    for node in walk(term):
        if isinstance(node, Symbol):
            try:
                yield name_of(node)
            except Beyond:
                continue
        if isinstance(node, Dot):
            yield from ("d/dt " + n.name for n in walk(node) if isinstance(n, Symbol) and n.args)


Known = Mapping[str, Ratio]
