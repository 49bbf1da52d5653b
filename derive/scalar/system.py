"""Letters of real numbers with values, facts of sign, and equations that remain.

An equation between fractions that is linear in a letter, with a factor that is known not to vanish, gives that letter
away: the Riccati equation gives the process noise, so that covariance and plant stay free. Part of the trust base.
Standard library only.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from fractions import Fraction
from typing import Any

from derive.kernel import ANY, Poly
from derive.scalar.ratio import Beyond, Numbers, Ratio, Ring, name_of, plain
from derive.terms import Symbol, Term

__all__ = ["KINDS", "POWERS", "ROOTS", "Case", "Choice", "Split", "System", "proportional", "sign_of"]

KINDS = {"≥": "nonnegative", "⪰": "nonnegative", ">": "positive", "≻": "positive", "≠": "nonzero"}
POWERS = tuple(f"exp {i}" for i in range(1, 5))  # letters for exponentials
ROOTS = tuple(f"√{i}" for i in range(1, 9))  # letters for roots

Choice = tuple[tuple[str, Any], ...]  # kinds of fact and polynomials, of which one holds
Case = tuple[str, Poly]  # "=" or a kind of fact, and the polynomial in letters


class Split(Exception):  # noqa: N818 - a question, no fault
    """The sign of a polynomial decides what a term is, and it is not known."""

    def __init__(self, poly: Poly):
        super().__init__("a sign decides")
        self.poly = poly


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
                self.know(names[0], 0 if kind == "nonzero" else 1 if c > 0 else -1, kind != "nonnegative")
                self._strictly(name, names[0], origin)

    def _strictly(self, name: str, letter: str, origin: str) -> None:
        """Note x > 0 of a letter that is known to be >= 0 and not zero, if no fact says so."""
        sign, strict = self.signs[letter]
        value = self.ring.letter(letter)
        said = any(k == "positive" and proportional(self.ring, p, value) for k, p in self.facts.values())
        if sign and strict and not said:
            turned = value if sign > 0 else -value
            self.facts[f"{name}, strictly"], self.origins[f"{name}, strictly"] = ("positive", turned), origin

    def know(self, letter: str, sign: int, strict: bool) -> None:
        """Note the sign of a letter (0: only that it is not zero), and whether it is strict."""
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
                found = None if name in dict.fromkeys(r for _, r in self.roots) else self.solve(top, "")
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
        found = self.solve(top, name_of(lhs) if isinstance(lhs, Symbol) else "")
        if found is None:
            self.relations[name] = top
        else:
            self.give(*found, name)

    def solve(self, top: Any, wanted: str) -> tuple[str, Ratio] | None:
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
