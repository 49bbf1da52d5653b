"""Rules for determinants, traces and roots of polynomials: how matrices become functions of a frequency.

Each rule takes a statement and the steps it is linked to, and accepts or raises Rejected. They search nothing.

instance: a step about arbitrary parameters, with others in their place. sum over: a step that holds for every index,
summed. conjugate: the roots of a real polynomial may be replaced by their conjugates. same roots: equal products over
roots have equal sums over roots. linear: the sum or difference of two improper integrals. modulus: ln |f| where f is a
quotient of products over roots. mirrored: ln f on the unit circle, where f is made of det(sI - M) and det(I - sM), by
ln |det(sI - M)|. roots' trace: tr M is the sum of the real parts of the eigenvalues. exchange:
det(I + XY) = det(I + YX). single: a matrix with one row and column is its determinant. positive: det M > 0 for M > 0,
and tr(MP) >= 0 for M, P >= 0. resolvent: tr(X (sI - M)^-1 Y) tends to 0. Standard library only.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import fields
from fractions import Fraction

from derive.calculus import reflect
from derive.functions import (
    ON_CIRCLE,
    Definite,
    Infinity,
    Limit,
    Log,
    Quotient,
    Rate,
    Start,
    point_of,
    put,
    square_of,
    total,
    value,
)
from derive.kernel import Poly, Rejected, identity, parts
from derive.real import AXIS, COMPLEX, FREQUENCY, ONE, TIME, UNIT, ZERO, scalar, scalars_of
from derive.spectral import At, Det, Entry, ImaginaryPart, Modulus, RealPart, Roots, Total
from derive.terms import Equation, Identity, Neg, Product, Reading, Sum, Symbol, Term, Trace, Zero, lower, walk

Links = Sequence[Equation]
HALF = Fraction(1, 2)


# ------------------------------------------------------------------------------------------------ substitution
def check_instance(statement: Equation, links: Links, reading: Reading) -> None:
    """Accept a step with terms in the place of parameters of which the theory assumes nothing."""
    (lemma,) = _exactly(1, links)
    images: dict[Term, Term] = {}
    _match(lemma, statement, images, reading)
    if Equation(put(lemma.lhs, images), lemma.relation, put(lemma.rhs, images)) != statement or not images:
        raise Rejected("the statement is no instance of the step")
    names, nodes = {s.name for s in images if isinstance(s, Symbol)}, [n for side in _sides(lemma) for n in walk(side)]
    for symbol in (n for n in nodes if isinstance(n, Symbol)):
        if symbol not in images and (symbol.name in names or any(reading.real.varies(symbol.name, p) for p in names)):
            raise Rejected(f"{symbol.name} stands for something that depends on a parameter")
    bound = {n.symbol.name for n in nodes if isinstance(n, (Limit, Definite, Rate, Start, At))}
    bound |= {n.index.name for n in nodes if isinstance(n, (Total, Roots))}
    exempt = reading.real.running - reading.real.generic  # exceptions must not move with a running parameter
    bound |= {FREQUENCY, COMPLEX, TIME, *exempt} if reading.real.generic else set()
    used = {n.name for n in nodes if isinstance(n, Symbol)}
    bound |= {v for v in reading.real.generic if any(reading.real.varies(name, v) for name in used)}
    if len(names) != len(images) or bound & names:
        raise Rejected("a parameter has two images, or is a variable of the step")
    for image in images.values():
        poly = value(image, reading)
        if any(reading.real.varies(s, v) for s in scalars_of(poly) for v in bound):
            raise Rejected("the image of a parameter depends on a variable of the step, or on one with exceptions")
        if not is_real(poly, reading):
            raise Rejected("the image of a parameter is not known to be real")
    _readable(statement, reading)


def _match(pattern: Term | Equation, found: Term | Equation, images: dict[Term, Term], reading: Reading) -> None:
    if isinstance(pattern, Symbol) and pattern.name in reading.real.arbitrary and isinstance(found, Term):
        images.setdefault(pattern, found)
        return
    if type(pattern) is not type(found):
        return
    for f in fields(pattern):  # pyright: ignore[reportArgumentType]
        for one, two in zip(*(_terms(getattr(t, f.name)) for t in (pattern, found)), strict=False):
            _match(one, two, images, reading)


def _terms(item: object) -> list[Term]:
    return (
        [item]
        if isinstance(item, Term)
        else [t for t in item if isinstance(t, Term)]
        if isinstance(item, tuple)
        else []
    )


def check_sum(statement: Equation, links: Links, reading: Reading) -> None:
    """Accept the sum over an index of a step: of both sides, of a limit, or of an improper integral."""
    (lemma,) = _exactly(1, links)
    found = statement.lhs.body if isinstance(statement.lhs, (Limit, Definite)) else statement.lhs
    if not isinstance(found, Total):
        raise Rejected("the left-hand side is not a sum")
    index, count = found.index, found.count

    def over(body: Term) -> Total:
        return Total(body, index, count)

    match lemma:
        case Equation(Limit(body, x, point), "=", limit):
            wanted = Equation(Limit(over(body), x, point), "=", over(limit))
        case Equation(Definite(body, x, lower, Infinity() as upper), "=", integral) if point_of(lower) == "0":
            wanted = Equation(Definite(over(body), x, lower, upper), "=", over(integral))
        case Equation(lhs, "≥", Zero()):
            wanted = Equation(over(lhs), "≥", lemma.rhs)
        case Equation(lhs, "=" | "≥" as relation, rhs):
            wanted = Equation(over(lhs), relation, over(rhs))
        case _:
            raise Rejected("a step with this relation is not summed")
    if statement != wanted:
        raise Rejected("the sum is of something else than the step")
    _readable(statement, reading)


def check_linear(statement: Equation, links: Links, reading: Reading) -> None:
    """Accept the improper integral of f + g, f - g or c f, with c a number, from those of f and g."""
    match statement.lhs:
        case Definite(body, symbol, lower, Infinity() as upper) if point_of(lower) == "0":
            ends = (symbol, lower, upper)
        case _:
            raise Rejected("it is no improper integral")
    found: list[tuple[Poly, Poly]] = []
    for link in links:
        match link:
            case Equation(Definite(f, x, low, high), "=", v) if (x, low, high) == ends:
                found.append((value(f, reading), value(v, reading)))
            case _:
                raise Rejected("a link is no integral between the same ends")
    _readable(statement, reading)
    wanted = value(body, reading), value(statement.rhs, reading)
    match found:
        case [(f, v)]:
            offers = [(f.scale(c), v.scale(c)) for c in _ratios(wanted[0], f)]
        case [(f, v), (g, w)]:
            offers = [(f + g, v + w), (f - g, v - w)]
        case _:
            raise Rejected("one or two integrals are combined")
    if wanted not in offers:
        raise Rejected("the integrand or the value is not the combination of the links")


def _ratios(poly: Poly, other: Poly) -> list[Fraction]:
    key = next(iter(other.terms), None)
    return [poly.terms[key] / other.terms[key]] if key is not None and key in poly.terms else []


# ------------------------------------------------------------------------------------------------ roots
def check_conjugate(statement: Equation, links: Links, reading: Reading) -> None:
    """Accept sum f(Re, Im) = sum f(Re, -Im) over the roots of one real polynomial."""
    _exactly(0, links)
    match statement:
        case Equation(Total(f, i, m), "=", Total(g, j, n)) if (i, m) == (j, n):
            left, right = value(f, reading), value(g, reading)
        case _:
            raise Rejected("both sides must be sums over the same index")
    _readable(statement, reading)
    real = reading.real
    moved = [
        y
        for y in real.families.values()
        if y.index == i.name and any(_uses(left, p, reading) for p in (y.real, y.imaginary))
    ]
    if len(moved) != 1 or reflect(left, moved[0].imaginary, real) != right:
        raise Rejected("it is no sum over one family and its conjugate")


def _uses(poly: Poly, name: str, reading: Reading) -> bool:
    return any(reading.real.varies(s, name) for s in scalars_of(poly))


def check_same_roots(statement: Equation, links: Links, reading: Reading) -> None:
    """Accept equal sums of a function over the roots of two products that are equal for all s."""
    (lemma,) = _exactly(1, links)
    if lemma.relation not in ("=", ":=") or statement.relation != "=":
        raise Rejected("the link is no equation")
    template: Term | None = None
    for product, side in zip(_sides(lemma), _sides(statement), strict=True):
        factors = product.factors if isinstance(product, Product) else (product,)
        sums = side.addends if isinstance(side, Sum) else (side,)
        if len(factors) != len(sums):
            raise Rejected("there are as many sums as products over roots")
        for factor, addend in zip(factors, sums, strict=True):
            match factor, addend:
                case Roots(point, root, index, count), Total(body, i, m) if (index, count) == (i, m):
                    parts_of = _parts_at(point, root)
                case _:
                    raise Rejected("each factor is a product over roots, each addend a sum over them")
            if template is None:
                if isinstance(point, Neg):
                    raise Rejected("the first product is read at s")
                template, first = body, parts_of
            elif put(template, dict(zip(first, parts_of, strict=True))) != body:
                raise Rejected("the sums are of different functions")
            _check_function(body, root, reading)
    _readable(statement, reading)


def _parts_at(point: Term, root: Symbol) -> tuple[Term, Term]:
    """Return the real and imaginary part of the zeros of a product over roots, at s or at -s."""
    plain = RealPart(root), ImaginaryPart(root)
    return (Neg(plain[0]), Neg(plain[1])) if isinstance(point, Neg) else plain


def _check_function(template: Term, root: Symbol, reading: Reading) -> None:
    """Reject a template that depends on more than the parts of one root."""
    family = reading.real.families[root.name]
    for s in scalars_of(value(template, reading)):
        others = [y for y in reading.real.families.values() if y is not family]
        if any(reading.real.varies(s, p) for y in others for p in (y.real, y.imaginary)):
            raise Rejected("the function depends on other roots")


def check_modulus(statement: Equation, links: Links, reading: Reading) -> None:
    """Accept ln |f| as half the sum of the logarithms of squared distances to the zeros, minus that to the poles.

    The point is on the imaginary axis or the unit circle, along the reals or anywhere, and |xy| = |x| |y| is all that
    is used: both sides are functions that may have no value at the zeros and poles themselves, finitely many points.
    Without the bars f must be positive, which it is on the axis if each product occurs at s and at -s, so that
    f = |g|^2 there; on the circle f p(s) p(-s) is not positive, and has no logarithm by this rule.
    """
    (lemma,) = _exactly(1, links)
    match statement:
        case Equation(Log(Modulus(At(body, _, point))), "=", rhs):
            square = False
        case Equation(Log(At(body, _, point)), "=", rhs):
            square = True
        case _:
            raise Rejected("the left-hand side is no logarithm of a function at a point")
    if lemma.relation != "=" or lemma.lhs != body:
        raise Rejected("the link says something else of the function")
    place = _place(point)
    top, bottom = (lemma.rhs.top, lemma.rhs.bottom) if isinstance(lemma.rhs, Quotient) else (lemma.rhs, None)
    result = ZERO
    for sign, side in ((HALF, top), (-HALF, bottom)):
        factors = () if side is None else side.factors if isinstance(side, Product) else (side,)
        if not all(isinstance(f, Roots) for f in factors):
            raise Rejected("the function is no quotient of products over roots")
        if square and (place != (ZERO, scalar(FREQUENCY)) or not _palindromic(factors)):
            raise Rejected("the function is not known to be positive on the axis")
        for factor in factors:
            assert isinstance(factor, Roots)
            result = result + _distances(factor, place, reading).scale(sign)
    value(statement.lhs, reading)
    if value(rhs, reading) != result:
        raise Rejected("the right-hand side is not the sum of the logarithms of the distances")


def _palindromic(factors: Sequence[Term]) -> bool:
    plain = sorted(f.root.name for f in factors if isinstance(f, Roots) and not isinstance(f.point, Neg))
    turned = sorted(f.root.name for f in factors if isinstance(f, Roots) and isinstance(f.point, Neg))
    return plain == turned


def _place(point: Term) -> tuple[Poly, Poly] | None:
    """Return the real and the imaginary part of a point: s, which is real, jω, or x + jy; none on the unit circle."""
    match point:
        case Quotient() if point == ON_CIRCLE:
            return None
        case Symbol(name=x):
            return scalar(x), ZERO
        case Product((_, Symbol(name=y))):
            return ZERO, scalar(y)
        case Sum((Symbol(name=x), Product((_, Symbol(name=y))))):
            return scalar(x), scalar(y)
        case _:
            raise Rejected("the point is neither s, nor jω, nor x + jy, nor on the unit circle")


def _distances(factor: Roots, place: tuple[Poly, Poly] | None, reading: Reading) -> Poly:
    """Return the sum of ln |point - root|^2 over the roots of a real polynomial.

    For z = (1 + jω)/(1 - jω) on the circle and λ = a + jb, (1 - jω)(z - λ) = (1 - a - ωb) + j (ω(1 + a) - b), and
    |1 - jω|^2 = 1 + ω^2.
    """
    family, real = reading.real.families[factor.root.name], reading.real
    re, im = scalar(family.real), scalar(family.imaginary)
    if isinstance(factor.point, Neg):
        re = -re  # |-s - λ| = |s + λ|, and the conjugates are roots as well
    if place is None:
        w = scalar(FREQUENCY)
        along, across, less = ONE - re - w * im, w * (ONE + re) - im, _log_of(ONE + w * w, reading)
    else:
        along, across, less = place[0] - re, place[1] - im, ZERO
    return total(_log_of(along * along + across * across, reading) - less, family.index, family.count, real)


def _log_of(poly: Poly, reading: Reading) -> Poly:
    name = reading.real.find("log", poly)
    if name is None:
        raise Rejected("the logarithm of a distance is not declared")
    return scalar(name)


def check_mirrored(statement: Equation, links: Links, reading: Reading) -> None:
    """Accept ln f = ln c + 2 ln |det(zI - M)| - 2 ln |det(zI - N)| for z on the unit circle.

    f det(sI - N) det(I - sN) = c det(sI - M) det(I - sM);  M, N real and of one size n, free of s;  c > 0, free of s

    There 1/z is the conjugate of z, so that det(I - zM) = z^n det(I/z - M) is z^n times the conjugate of
    det(zI - M), as M is real; z^n is the same on both sides and cancels, for M and N are of one size. What is left,
    f |det(zI - N)|^2 = c |det(zI - M)|^2, makes f positive but for the eigenvalues of M and N on the circle, which are
    finitely many points. The link is an identity between rational functions of s, which holds on the circle as well.
    That c > 0, and a number, is why its logarithm is declared.
    """
    (lemma,) = _exactly(1, links)
    match statement, lemma:
        case (
            Equation(Log(At(f, s, point)), "=", rhs),
            Equation(
                Product((f1, Det() as at_n, Det() as inner_n)), "=", Product((c, Det() as at_m, Det() as inner_m))
            ),
        ) if f == f1 and point == ON_CIRCLE:
            pass
        case _:
            raise Rejected("it is about ln f on the circle, and f by det(sI - M) and det(I - sM)")
    sizes = [_mirrored(*pair, reading) for pair in ((at_m, inner_m), (at_n, inner_n))]
    if sizes[0] != sizes[1]:
        raise Rejected("the matrices are of different sizes")
    constant = value(Log(c), reading)
    if any(_uses(value(c, reading), v, reading) for v in (COMPLEX, FREQUENCY)):
        raise Rejected("the factor beside the determinants depends on s")
    moduli = [value(Log(Modulus(At(d, s, point))), reading).scale(2) for d in (at_m, at_n)]
    value(statement.lhs, reading)
    if value(rhs, reading) != constant + moduli[0] - moduli[1]:
        raise Rejected("the right-hand side is not the sum of the logarithms")


def _mirrored(at: Det, inner: Det, reading: Reading) -> str:
    """Return the size of M for det(sI - M) and det(I - sM), M real and free of s."""
    one, two = square_of(at.body, reading), square_of(inner.body, reading)
    point = identity(one.rows).scale(1, (COMPLEX,))
    matrix = point - one
    real = reading.context.is_real(matrix) and is_real(matrix, reading)
    if not real or any(_uses(matrix, v, reading) for v in (COMPLEX, FREQUENCY)):
        raise Rejected("the first determinant is not that of sI - M with M real")
    if two != identity(one.rows) - matrix.scale(1, (COMPLEX,)):
        raise Rejected("the second determinant is not that of I - sM")
    return one.rows


def check_trace_of_roots(statement: Equation, links: Links, reading: Reading) -> None:
    """Accept tr M = sum of Re over the roots of det(sI - M), for a real matrix M."""
    (lemma,) = _exactly(1, links)
    match lemma, statement:
        case (
            Equation(Det(body), "=", Roots(Symbol(name=name), root, index, count)),
            Equation(Trace(matrix), "=", Total(RealPart(other), i, m)),
        ) if name == COMPLEX and (root, index, count) == (other, i, m):
            ((poly,),), ((rest,),) = lower(body, reading), lower(matrix, reading)
            point = identity(poly.rows).scale(1, (COMPLEX,))
            if point - poly != rest or not reading.context.is_real(rest) or _uses(rest, COMPLEX, reading):
                raise Rejected("the determinant is not that of sI - M with M real")
            _readable(statement, reading)
        case _:
            raise Rejected("it takes det(sI - M) as a product over roots, and a trace as the sum of their real parts")


# ------------------------------------------------------------------------------------------------ matrices
def check_exchange(statement: Equation, links: Links, reading: Reading) -> None:
    """Accept det(I + XY) = det(I + YX)."""
    _exactly(0, links)
    match statement:
        case Equation(Det(Sum((Identity(), Product(xs)))), "=", Det(Sum((Identity(), Product(ys))))):
            if not any(xs[k:] + xs[:k] == ys for k in range(1, len(xs))):
                raise Rejected("the factors are not exchanged")
            _readable(statement, reading)
        case _:
            raise Rejected("it is about det(I + XY) and det(I + YX)")


def check_single(statement: Equation, links: Links, reading: Reading) -> None:
    """Accept det X = X for a matrix with one row and one column."""
    _exactly(0, links)
    match statement:
        case Equation(Det(body), "=", Entry(other)) if body == other:
            _readable(statement, reading)
        case _:
            raise Rejected("it is about a determinant and the only entry")


def determinant_claim(statement: Equation, reading: Reading) -> Poly:
    """Return the difference of two products of matrices, whose determinants are then the products of theirs."""
    sides: list[Poly] = []
    for side in _sides(statement):
        factors = side.factors if isinstance(side, Product) else (side,)
        if not all(isinstance(f, Det) for f in factors):
            raise Rejected("both sides must be products of determinants")
        matrices = [square_of(f.body, reading) for f in factors if isinstance(f, Det)]
        product = matrices[0]
        for matrix in matrices[1:]:
            product = product * matrix
        sides.append(product)
    return sides[0] - sides[1]


def check_positive(statement: Equation, facts: Sequence[str], reading: Reading) -> None:
    """Accept det V > 0 from V > 0, and tr(M P) >= 0 from M >= 0 and P >= 0."""
    found = [reading.context.facts[name] for name in facts if name in reading.context.facts]
    if len(found) != len(facts) or value(statement.rhs, reading) != ZERO:
        raise Rejected("a fact is missing, or the right-hand side is not zero")
    match statement.lhs, statement.relation, [f.kind for f in found]:
        case Det(body), ">", ["pd"]:
            accepted = found[0].matrix == lower(body, reading)
        case Trace(body), "≥", ["psd" | "pd", "psd" | "pd"]:
            ((m,),), ((p,),) = found[0].matrix, found[1].matrix
            accepted = lower(body, reading) == ((m * p,),)
            if not any(reading.context.alphabet.transpose(x) == x for x in (m, p)):
                raise Rejected("one of the matrices must be symmetric")
        case _:
            raise Rejected("it is no determinant or trace of what is known to be positive")
    if not accepted:
        raise Rejected("the facts are about other matrices")
    if not all(reading.context.is_real(x) for fact in found for row in fact.matrix for x in row):
        raise Rejected("the matrices are not known to be real")
    value(statement.lhs, reading)


def check_resolvent(statement: Equation, links: Links, reading: Reading) -> None:
    """Accept that tr(X (sI - M)^-1 Y) tends to 0 as s grows along the reals, with X, Y, M free of s."""
    _exactly(0, links)
    match statement:
        case Equation(Limit(Trace(body), Symbol(name=name), Infinity()), "=", zero) if name == COMPLEX:
            ((poly,),) = lower(body, reading)
            if poly.rows != poly.cols:
                raise Rejected("a trace is that of a square matrix")
        case _:
            raise Rejected("it is about the limit of a trace")
    if value(zero, reading) != ZERO:
        raise Rejected("the limit is zero")
    names = {letter: poly for poly, letter in reading.inverses.items()}
    for m, w in poly.terms:
        inverses = [parts(a)[0] for a in w if parts(a)[0] in names]
        resolvents = [a for a in inverses if _is_resolvent(names[a], reading)]
        if any(reading.real.varies(s, COMPLEX) for s in m) or len(resolvents) != 1:
            raise Rejected("each product has one resolvent, and no s beside it")
        rest = {parts(a)[0] for a in w}.difference(resolvents)
        if rest & reading.context.complex:
            raise Rejected("another factor depends on s")


def _is_resolvent(poly: Poly, reading: Reading) -> bool:
    rest = poly - identity(poly.rows).scale(1, (COMPLEX,))
    return bool(reading.context.is_real(rest)) and not _uses(rest, COMPLEX, reading)


def real_coefficients(poly: Poly, reading: Reading) -> bool:
    """Tell whether a function of s is rational with real coefficients: it takes conjugate values at conjugate points.

    What is shown of such a function for large real s is then true of it on the axis as well.
    """
    real = reading.real

    def known(s: str) -> bool | None:
        atom = real.atoms.get(s)
        if s in AXIS or atom is None:
            return s not in AXIS
        if atom.kind in RATIONAL:
            return None
        return not real.varies(s, COMPLEX) and not real.varies(s, FREQUENCY)

    return _made_of(poly, known, reading)


def is_real(poly: Poly, reading: Reading, point: bool = False) -> bool:
    """Tell whether a number is real: the imaginary unit and complex matrices are not in it, s only if it is real."""

    def known(s: str) -> bool | None:
        atom = reading.real.atoms.get(s)
        if s in (COMPLEX, UNIT) or (atom is not None and atom.kind == "roots"):
            return point and s != UNIT
        return None if atom is not None and atom.kind in RATIONAL else True  # others are declared of real numbers

    return _made_of(poly, known, reading)


RATIONAL = ("defined", "reciprocal", "roots", "det", "trace")


def _made_of(poly: Poly, known: Callable[[str], bool | None], reading: Reading) -> bool:
    """Tell whether all scalars of a polynomial are known as good, or made of such, and so the letters of matrices."""
    meanings, complex_letters = dict(_meanings(reading)), reading.context.complex

    def good(p: Poly, above: frozenset[str]) -> bool:
        letters = {parts(a)[0] for _, w in p.terms for a in w} & complex_letters
        return all(number(s, above) for s in scalars_of(p)) and all(
            a in meanings and a not in above and good(meanings[a], above | {a}) for a in letters
        )

    def number(s: str, above: frozenset[str]) -> bool:
        found = known(s)
        return good(reading.real.atoms[s].of, above) if found is None else found

    return good(poly, frozenset())


def _meanings(reading: Reading) -> Iterator[tuple[str, Poly]]:
    """Iterate over the letters that may be complex, with what they are the inverse of, or what defines them."""
    yield from ((letter, poly) for poly, letter in reading.inverses.items())
    others = reading.context.complex - _inverse_names(reading)
    for poly in reading.context.relations.values():
        single = [w[0] for m, w in poly.terms if not m and len(w) == 1 and w[0] in others]
        if len(single) == 1:
            rest = {(m, w): c for (m, w), c in poly.terms.items() if w != (single[0],)}
            if not any(parts(a)[0] in others for _, w in rest for a in w):
                yield single[0], Poly(rest, poly.rows, poly.cols)


def _inverse_names(reading: Reading) -> set[str]:
    return set(reading.inverses.values())


# ------------------------------------------------------------------------------------------------ helpers
def _sides(statement: Equation) -> tuple[Term, Term]:
    return statement.lhs, statement.rhs


def _exactly(number: int, links: Links) -> Links:
    if len(links) != number:
        raise Rejected(f"the rule takes {number} steps, the proof names {len(links)}")
    return links


def _readable(statement: Equation, reading: Reading) -> None:
    """Reject what cannot be read; of a limit, which the rule itself gives, the body is read."""
    for side in _sides(statement):
        value(side.body if isinstance(side, Limit) else side, reading)


CHECKS: Mapping[str, Callable[[Equation, Links, Reading], None]] = {
    "instance": check_instance,
    "sum over": check_sum,
    "linear": check_linear,
    "conjugate": check_conjugate,
    "same roots": check_same_roots,
    "modulus": check_modulus,
    "mirrored": check_mirrored,
    "trace of roots": check_trace_of_roots,
    "exchange": check_exchange,
    "single": check_single,
    "resolvent": check_resolvent,
}
