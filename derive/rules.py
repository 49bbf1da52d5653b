"""Rules beside the identities: positivity, comparison, and the operators d/dt, E[.], the integral over [t0, t].

Each rule ends in identities that the kernel replays, or rewrites a polynomial by a declared table (derivatives,
moments). Like the kernel it searches nothing, and uses the standard library only.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from fractions import Fraction

from derive.kernel import (
    Alphabet,
    Certificate,
    Poly,
    Rejected,
    Scalars,
    Term,
    at_time,
    bound,
    identity,
    parts,
    replay,
    times_of,
)

Grid = tuple[tuple[Poly, ...], ...]


@dataclass(frozen=True)
class Fact:
    """A hypothesis or proved lemma on a (block) matrix: 'psd', 'pd', 'hurwitz', 'schur', or 'initial' (psd at t0)."""

    kind: str
    matrix: Grid


@dataclass(frozen=True)
class Square:
    """The addend c * scalars * F H F', with c >= 0, scalars >= 0 and H the matrix of a psd or pd fact."""

    coefficient: Fraction
    scalars: Scalars
    factor: Grid
    fact: str


@dataclass(frozen=True)
class Positivity:
    """G >= 0 because G = sum of squares; G > 0 if in addition squares[strict] has a pd core and F Z = I."""

    claim: Grid
    squares: tuple[Square, ...]
    terms: tuple[tuple[tuple[Term, ...], ...], ...]
    strict: int | None = None
    inverse: Poly | None = None
    inverse_terms: tuple[Term, ...] = ()


@dataclass(frozen=True)
class Comparison:
    """D >= 0 because M D + D M' + F = 0 with M Hurwitz ('lyapunov'), M D M' - D + F = 0 with M Schur ('stein'),
    or dD/dt = M D + D M' + F with D(t0) >= 0 ('transient'); F >= 0 is a fact, ``stable`` names the fact on M or D(t0).
    """

    kind: str
    claim: Poly
    matrix: Poly
    stable: str
    forcing: str
    terms: tuple[Term, ...]


@dataclass(frozen=True)
class Context:
    """What may be used.

    Letters, relations (each = 0), facts, scalars >= 0, time derivatives, letters constant in time, parameters (letters
    that no choice of a gain changes), moments E[a b'], random letters of mean zero, signals with another mean, whose
    expectation has no rule, and the letters and scalars that may be complex, of which no square is known to be >= 0.
    """

    alphabet: Alphabet
    relations: Mapping[str, Poly] = field(default_factory=dict[str, Poly])
    facts: Mapping[str, Fact] = field(default_factory=dict[str, Fact])
    nonnegative: frozenset[str] = frozenset()
    derivatives: Mapping[str, Poly] = field(default_factory=dict[str, Poly])
    constants: frozenset[str] = frozenset()
    parameters: frozenset[str] = frozenset()
    moments: Mapping[tuple[str, str], Poly] = field(default_factory=dict[tuple[str, str], Poly])
    random: frozenset[str] = frozenset()
    uncentred: frozenset[str] = frozenset()
    complex: frozenset[str] = frozenset()

    def is_real(self, poly: Poly) -> bool:
        """Return whether no letter and no scalar of a polynomial may be complex."""
        return not any(self.complex.intersection((*m, *(parts(a)[0] for a in w))) for m, w in poly.terms)

    def fact(self, name: str, *kinds: str) -> Fact:
        """Return a fact of one of the given kinds, or raise Rejected."""
        if name not in self.facts or self.facts[name].kind not in kinds:
            raise Rejected(f"no fact {name} of kind {' or '.join(kinds)}")
        return self.facts[name]


def replay_positivity(proof: Positivity, claim: Grid, context: Context) -> str:
    """Accept G >= 0 ('psd') or G > 0 ('pd'), or raise Rejected."""
    if proof.claim != claim:
        raise Rejected("the certificate belongs to another claim")
    _check_blocks(claim)
    flip, rest = context.alphabet.transpose, {(i, j): g for i, row in enumerate(claim) for j, g in enumerate(row)}
    for s in proof.squares:
        if s.coefficient < 0 or not context.nonnegative.issuperset(s.scalars):
            raise Rejected(f"the coefficient of {s.fact} may be negative")
        if not all(context.is_real(f) for row in s.factor for f in row):
            raise Rejected(f"the factor of {s.fact} may be complex; its square need not be positive")
        core = context.fact(s.fact, "psd", "pd").matrix
        _check_blocks(core)
        if len(s.factor) != len(claim) or any(len(row) != len(core) for row in s.factor):
            raise Rejected(f"the factor of {s.fact} has another number of blocks")
        for i, j in rest:
            for k, row in enumerate(core):
                for m, h in enumerate(row):
                    rest[i, j] -= (s.factor[i][k] * h * flip(s.factor[j][m])).scale(s.coefficient, s.scalars)
    if len(proof.terms) != len(claim) or any(len(row) != len(claim) for row in proof.terms):
        raise Rejected("every block needs its certificate")
    for (i, j), g in rest.items():
        replay(Certificate(g, proof.terms[i][j]), g, context.relations, context.alphabet)
    if proof.strict is None:
        return "psd"
    if proof.strict not in range(len(proof.squares)):
        raise Rejected("there is no such square")
    square = proof.squares[proof.strict]
    if len(claim) != 1 or len(square.factor[0]) != 1 or proof.inverse is None:
        raise Rejected("strictness needs one block and a right inverse of the factor")
    if square.coefficient <= 0 or square.scalars:
        raise Rejected("a coefficient that may vanish does not make a square strict")
    context.fact(square.fact, "pd")
    injective = square.factor[0][0] * proof.inverse - identity(claim[0][0].rows)
    replay(Certificate(injective, proof.inverse_terms), injective, context.relations, context.alphabet)
    return "pd"


def _check_blocks(grid: Grid) -> None:
    """Reject a block matrix that is not square, or whose blocks do not share their types."""
    sizes = [row[i].rows for i, row in enumerate(grid) if i < len(row)]
    for i, row in enumerate(grid):
        if len(row) != len(grid) or any((b.rows, b.cols) != (sizes[i], sizes[j]) for j, b in enumerate(row)):
            raise Rejected("positivity is about square block matrices")


def replay_comparison(proof: Comparison, claim: Poly, context: Context) -> str:
    """Accept D >= 0 by comparison, or raise Rejected."""
    flip, d, m = context.alphabet.transpose, proof.claim, proof.matrix
    if d != claim:
        raise Rejected("the certificate belongs to another claim")
    wanted = {"lyapunov": ("hurwitz", m), "stein": ("schur", m), "transient": ("initial", d)}
    if proof.kind not in wanted or context.fact(proof.stable, wanted[proof.kind][0]).matrix != (
        (wanted[proof.kind][1],),
    ):
        raise Rejected(f"the fact {proof.stable} is not about this matrix")
    forcing = context.fact(proof.forcing, "psd", "pd").matrix
    if len(forcing) != 1 or len(forcing[0]) != 1:
        raise Rejected(f"the fact {proof.forcing} has several blocks")
    if not context.is_real(m):
        raise Rejected("the matrix of the comparison may be complex")
    f = forcing[0][0]
    equation = m * d * flip(m) - d + f if proof.kind == "stein" else m * d + d * flip(m) + f
    if proof.kind == "transient":
        equation = equation - differentiate(d, context)
    replay(Certificate(equation, proof.terms), equation, context.relations, context.alphabet)
    return "psd"


@dataclass(frozen=True)
class Uniqueness:
    """f = g because D = f - g solves dD/dt = M D + D N and D(t0) = 0: a linear equation has one solution."""

    claim: Poly
    left: Poly
    right: Poly
    rate_terms: tuple[Term, ...]
    initial_terms: tuple[Term, ...]


def replay_uniqueness(proof: Uniqueness, claim: Poly, context: Context) -> None:
    """Accept f - g = 0 by uniqueness of the solution of a linear differential equation, or raise Rejected."""
    if proof.claim != claim:
        raise Rejected("the certificate belongs to another claim")
    noise = context.random | context.uncentred
    if any(m or any(parts(a)[0] in noise for a in w) for side in (proof.left, proof.right) for m, w in side.terms):
        raise Rejected("the coefficients of the linear equation must be continuous in time")
    for equation, terms in zip(
        (rate_equation(claim, proof.left, proof.right, context), at_start(claim, context)),
        (proof.rate_terms, proof.initial_terms),
        strict=True,
    ):
        replay(Certificate(equation, terms), equation, context.relations, context.alphabet)


def rate_equation(d: Poly, left: Poly, right: Poly, context: Context) -> Poly:
    """Return dD/dt - M D - D N."""
    return differentiate(d, context) - left * d - d * right


def at_start(poly: Poly, context: Context) -> Poly:
    """Return the value at t = t0: integrals from t0 to t vanish."""
    kept = {k: c for k, c in poly.terms.items() if not any(s.startswith("∫") for s in k[0])}
    for _, word in kept:
        for a in word:
            if not parts(a)[2] and parts(a)[0] not in context.constants:
                raise Rejected(f"the value of {a} at t0 is not declared")
    return at_time(Poly(kept, poly.rows, poly.cols), "t", "t0")


# ------------------------------------------------------------------------------------------------ operators
def substitute(poly: Poly, images: Mapping[str, Poly], alphabet: Alphabet) -> Poly:
    """Replace letters by polynomials of the same type (transposes follow)."""
    total = Poly({}, poly.rows, poly.cols)
    for (m, w), c in poly.terms.items():
        product = Poly({(m, ()): c}, poly.rows, poly.rows)
        for a in w:
            rows, cols = alphabet.shape(a)
            image = images.get(a) or Poly({((), (a,)): 1}, rows, cols)
            if a not in images and alphabet.flip(a) in images:
                image = alphabet.transpose(images[alphabet.flip(a)])
            if (image.rows, image.cols) != (rows, cols):
                raise Rejected(f"the image of {a} is {image.rows} x {image.cols}, expected {rows} x {cols}")
            if a == alphabet.flip(a) and image != alphabet.transpose(image):
                raise Rejected(f"the image of {a} is not symmetric")
            product = product * image
        total = total + product
    return total


def differentiate(poly: Poly, context: Context) -> Poly:
    """Return d/dt by the product rule and Leibniz's rule (integrals run from t0 to t)."""
    total, alphabet = Poly({}, poly.rows, poly.cols), context.alphabet
    for (m, w), c in poly.terms.items():
        for variable in bound(m):
            inner = tuple(s for s in m if s != "∫" + variable)
            total = total + at_time(Poly({(inner, w): c}, poly.rows, poly.cols), variable, "t")
        if any(s.startswith("δ") for s in m):
            raise Rejected("a Dirac delta is not differentiated")
        for i, a in enumerate(w):
            name, _, arguments = parts(a)
            rate = context.derivatives.get(a)
            if rate is None and alphabet.flip(a) in context.derivatives:
                rate = alphabet.transpose(context.derivatives[alphabet.flip(a)])
            if rate is None and ("t" in arguments or not (arguments or name in context.constants)):
                raise Rejected(f"the time derivative of {a} is not declared")
            if rate:
                total = total + _insert(Poly({(m, w): c}, poly.rows, poly.cols), i, 1, rate)
    return total


def _insert(term: Poly, start: int, length: int, image: Poly) -> Poly:
    """Put a polynomial in the place of some letters of a single term; reject what an integral would capture."""
    (((m, w), c),) = term.terms.items()
    left, replaced, right = w[:start], w[start : start + length], w[start + length :]
    for n, v in image.terms:
        if bound(m) & (times_of(n, v) - bound(n) - times_of((), replaced)):
            raise Rejected(f"an integral would capture what stands for {' '.join(replaced)}")
    inner = Poly({((), left): c}, term.rows, image.rows) * image * Poly({((), right): 1}, image.cols, term.cols)
    return inner.scale(1, m)


def expect(poly: Poly, context: Context) -> Poly:
    """Return E[.]: linear, deterministic factors leave, E[a b'] from the moments; every random letter has mean zero."""
    total = Poly({}, poly.rows, poly.cols)
    for (m, w), c in poly.terms.items():
        if any(parts(a)[0] in context.uncentred for a in w):
            raise Rejected(f"a signal in {' '.join(w)} has no declared mean")
        where = [i for i, a in enumerate(w) if parts(a)[0] in context.random]
        if len(where) == 1:
            continue
        if len(where) not in (0, 2) or (where and where[1] != where[0] + 1):
            raise Rejected(f"no rule for the expectation of {' '.join(w)}")
        if not where:
            total = total + Poly({(m, w): c}, poly.rows, poly.cols)
            continue
        a, b = w[where[0]], w[where[1]]
        moment = context.moments.get((a, b))
        if moment is None and (context.alphabet.flip(b), context.alphabet.flip(a)) in context.moments:
            moment = context.alphabet.transpose(context.moments[context.alphabet.flip(b), context.alphabet.flip(a)])
        if moment is None:
            raise Rejected(f"the moment E[{a} {b}] is not declared")
        total = total + _insert(Poly({(m, w): c}, poly.rows, poly.cols), where[0], 2, moment)
    return sift(total)


def sift(poly: Poly) -> Poly:
    """Integrate Dirac deltas: ∫ f(τ) δ(τ,σ) dτ = f(σ) for σ bound over the same interval, f(t)/2 at the end t."""
    total = Poly({}, poly.rows, poly.cols)
    for (m, w), c in poly.terms.items():
        term = Poly({(m, w): c}, poly.rows, poly.cols)
        for delta in (s for s in m if s.startswith("δ")):
            one, two = delta[2:-1].split(",")
            if "∫" + two not in m:
                one, two = two, one
            if "∫" + two in m and ("∫" + one in m or one == "t") and one != two:
                shared = {v for v in (one, two) if "∫" + v in m}
                if any(shared.intersection(times_of((s,), ())) for s in _without(m, delta) if s.startswith("δ")):
                    raise Rejected(f"no product of {delta} with a delta of the same variable has a meaning")
                inner = tuple(s for s in m if s not in ("∫" + two, delta))
                term = sift(at_time(Poly({(inner, w): c / (2 if one == "t" else 1)}, poly.rows, poly.cols), two, one))
                break
        total = total + term
    return total


def _without(scalars: Scalars, one: str) -> Scalars:
    at = scalars.index(one)
    return scalars[:at] + scalars[at + 1 :]


def variation(poly: Poly, letter: str, change: str, context: Context) -> Poly:
    """Return the directional derivative when ``letter`` moves along ``change``, a letter that poly does not contain."""
    alphabet = context.alphabet
    moved, along = (alphabet.letters[parts(a)[0]] for a in (letter, change))
    if (moved.rows, moved.cols, moved.symmetric) != (along.rows, along.cols, along.symmetric):
        raise Rejected(f"{change} is not a direction of {letter}")
    if any(parts(a)[0] == along.name for r in context.relations.values() for _, w in r.terms for a in w):
        raise Rejected(f"{change} is not a free direction")
    images = {letter: change, alphabet.flip(letter): alphabet.flip(change)}
    total = Poly({}, poly.rows, poly.cols)
    for (m, w), c in poly.terms.items():
        for i, a in enumerate(w):
            if a in images:
                total = total + Poly({(m, (*w[:i], images[a], *w[i + 1 :])): c}, poly.rows, poly.cols)
            elif parts(a)[0] not in context.parameters or parts(a)[0] in (parts(letter)[0], parts(change)[0]):
                raise Rejected(f"{a} may depend on {letter}")
    return total
