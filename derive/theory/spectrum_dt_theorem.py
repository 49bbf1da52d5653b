"""The discrete counterpart of theorem 1: the determinant of the innovation covariance by the spectrum of the output.

    ln det(CPC' + R) = (1/2π) ∫ ln det Phi(e^{jω}) dω + 2 Σ max(0, ln |λ_i(A)|),  the integral over -π < ω < π

P >= 0 is the stabilising solution of the Riccati equation, or the strong one: the eigenvalues of A - KC are in the unit
disc or on the circle. A may be singular, where max(0, ln 0) is 0, and have eigenvalues on the circle, -1 as well. Those
at -1, of open and closed loop, are numbered apart, for the variable of the integral takes -1 to infinity.
"""

from __future__ import annotations

from derive.context import Theory
from derive.derivation import Step
from derive.functions import PI, Definite, Log, Max, Quotient
from derive.spectral import At, Det, Distance, Growth, Modulus, Total
from derive.terms import Equation, Glyph, Neg, Product, Symbol, Term
from derive.theory.scalar_continuous import ONE, ZERO
from derive.theory.spectrum_builder import SpectrumBuilder
from derive.theory.spectrum_circle import (
    PAIRS,
    angle,
    both,
    centre,
    centre_integral,
    circle,
    constant,
    declare_distances,
    declare_growth,
    declare_root,
    derive_at_minus_one,
    derive_growth,
    derive_jensen,
    derive_number,
    derive_root,
    excess,
    over,
    parts,
    point,
    weight,
)
from derive.theory.spectrum_discrete import at, closed_loop
from derive.theory.spectrum_poisson import FOUR
from derive.theory.spectrum_roots import HALF, half, over_roots

OPEN, CLOSED = ("ζ", "χ"), ("ξ", "ψ")  # eigenvalues other than -1, and those at -1


# ------------------------------------------------------------------------------------------------ terms
def around(t: Theory, body: Term) -> Term:
    """Return the mean over the circle, of a function of e^{jω}."""
    return Quotient(ONE, 2 * PI) * Definite(body, t.symbols["ω"], Neg(PI), PI)


def log_spectrum(t: Theory, place: Term) -> Log:
    """Return ln det Phi at a point."""
    return Log(At(Det(t.symbols["Phi"]), t.symbols["s"], place))


def log_modulus(t: Theory, matrix: Term) -> Log:
    """Return ln |det(zI - M)| at a point z of the circle."""
    return Log(Modulus(At(Det(at(t, matrix)), t.symbols["s"], point(t))))


def log_innovation(t: Theory) -> Log:
    """Return ln det S."""
    return Log(Det(t.symbols["S"]))


def innovation(t: Theory) -> Term:
    """Return CPC' + R."""
    C, P, R = (t.symbols[k] for k in "CPR")
    return C * P * C.T + R


def product(t: Theory, *names: str) -> Term:
    """Return the product of (s - root) over one or two families."""
    factors = tuple(over_roots(t, t.symbols[n], t.symbols["s"]) for n in names)
    return factors[0] if len(factors) == 1 else Product(factors)


def contributions(t: Theory, names: tuple[str, str]) -> Term:
    """Return what all eigenvalues of a matrix contribute to the integral over half of the circle."""
    one, other = (over(t, t.symbols[n], circle(t, t.symbols[n])) for n in names)
    return one + other


def outside(t: Theory, name: str = "λ") -> Total:
    """Return the sum of max(0, ln|λ|)."""
    return over(t, t.symbols[name], Growth(t.symbols[name]))


# ------------------------------------------------------------------------------------------------ declarations
def declare(t: Theory) -> None:
    """Declare the eigenvalues of A and of A - KC, those at -1 apart, and the logarithms of the determinants."""
    A, S = t.symbols["A"], t.symbols["S"]
    t.roots("λ", t.symbols["i"], t.symbols["m"], Glyph("λ", sub="i"), of="A", meaning="eigenvalues of A")
    for name, index, count, meaning in (
        ("ζ", "k", "n", "eigenvalues of A other than -1"), ("χ", "q", "p", "eigenvalues of A at -1"),
        ("ξ", "h", "d", "eigenvalues of A - KC other than -1"), ("ψ", "g", "c", "eigenvalues of A - KC at -1"),
    ):  # fmt: skip
        where = t.scalar(f"number {index}", Glyph(index), meaning="number of a root")
        many = t.scalar(f"count {count}", Glyph(count), meaning="number of roots")
        t.roots(name, where, many, Glyph(name, sub=index), meaning=meaning)
    for name in ("λ", *OPEN, *CLOSED):
        t.atom("spectral", product(t, name), name=f"product {name}")
    t.define("eigenvalues of A", Det(at(t, A)), product(t, "λ"), "counted as often as they occur")
    t.define("eigenvalues of A at -1 apart", product(t, "λ"), product(t, *OPEN), "those at -1 are numbered apart")
    t.define("eigenvalues of A - KC", Det(at(t, closed_loop(t))), product(t, *CLOSED), "those at -1 are numbered apart")
    declare_growth(t, t.symbols["λ"])
    for other, end in (OPEN, CLOSED):
        declare_root(t, t.symbols[other])
        a, c = parts(t.symbols[end])
        t.assume(f"Re {end} = -1", a, "=", Neg(ONE), text="an eigenvalue at -1")
        t.assume(f"Im {end} = 0", c, "=", ZERO, text="an eigenvalue at -1")
        declare_distances(t, t.symbols[end])
    disc = Neg(excess(t.symbols["ξ"]))
    t.assume("strong solution", disc, "≥", text="the stabilising solution, or the strong one: no eigenvalue is outside")
    t.atom("spectral", Det(innovation(t)), name="det(CPC'+R)")
    t.atom("log", Det(S), "det S > 0", "ln det S")
    t.atom("log", Det(innovation(t)), "det(CPC'+R) > 0", "ln det(CPC'+R)")
    for name, log in (
        ("det Phi", log_spectrum(t, point(t))), ("|det(zI - A)|", log_modulus(t, A)),
        ("|det(zI - A + KC)|", log_modulus(t, closed_loop(t))),
    ):  # fmt: skip
        t.atom("spectral", log, name=f"ln {name}")
    for name, body in integrands(t).items():
        t.atom("improper", body, name=f"circle integral of {name}")


def integrands(t: Theory) -> dict[str, Term]:
    """Return what is integrated over half of the circle."""
    opened, closed = contributions(t, OPEN), contributions(t, CLOSED)
    log = constant(t, log_innovation(t))
    return {
        "ln 4": constant(t, 2 * Log(FOUR)), "-1": constant(t, 2 * Log(FOUR)) - centre(t), "the open loop": opened,
        "the closed loop": closed, "both loops": closed - opened, "half of both": HALF * (closed - opened),
        "ln det S": log, "all": log + HALF * (closed - opened),
        "ln det Phi": Product((weight(t), log_spectrum(t, point(t)))),
    }  # fmt: skip


# ------------------------------------------------------------------------------------------------ derivation
def derive(b: SpectrumBuilder) -> None:
    """Derive the discrete counterpart of theorem 1."""
    t = b.theory
    b.heading("Jensen's formula for each eigenvalue")
    b.say(
        "Eigenvalues are the roots of the characteristic polynomial; those at -1 have numbers of their own. An "
        "eigenvalue other than -1 is, times a factor, at the same distance from the point of the circle as its image "
        "from the point of the axis:"
    )
    names = ("eigenvalues of A", "eigenvalues of A at -1 apart", "eigenvalues of A - KC")
    b.given(*names)
    derive_root(b, t.symbols["ζ"])
    _derive_mean(b, t.symbols["ζ"])
    b.say("The same for the closed loop:")
    derive_root(b, t.symbols["ξ"])
    b.say("which has no eigenvalue outside of the circle:")
    b.given("strong solution")
    _derive_no_growth(b, t.symbols["ξ"], ["strong solution"])
    b.say("Eigenvalues at -1 contribute nothing:")
    _derive_at_minus_one(b)
    b.heading("The determinant of the innovation covariance")
    _derive_logarithm(b)
    _derive_integral(b)
    _derive_theorem(b)


def _derive_mean(b: SpectrumBuilder, root: Symbol) -> None:
    t, name = b.theory, root.name
    b.say("which is Jensen's formula on the circle, in the angle:")
    mean = Equation(around(t, Log(Distance(angle(t), root))), "=", 2 * Growth(root))
    b.state(f"Jensen's formula for {name}", mean, "the integrand at both conjugates", [f"circle lemma of {name}"])


def _derive_no_growth(b: SpectrumBuilder, root: Symbol, using: list[str], identities: tuple[str, ...] = ()) -> None:
    """Derive max(0, ln|λ|) = 0 for a family that is in the disc, and the sum."""
    t, name, part = b.theory, root.name, Max(excess(root))
    facts = [f"max(0,|{name}|^2-1) ≥ 0", f"max(0,|{name}|^2-1) ≥ its argument", *using]
    b.equal(f"no {name} outside", Equation(part, "=", ZERO), facts, identities=identities, reason="it is not positive")
    b.state(f"four and {name}", Equation(Product((ONE + part, FOUR)), "=", FOUR), "times 4", [f"no {name} outside"])
    logs = Equation(Log(ONE + part) + Log(FOUR), "=", Log(FOUR))
    b.linked(f"log of four and {name}", logs, "logarithms", "of a product", [f"four and {name}"])
    none = Equation(Growth(root), "=", ZERO)
    b.state(f"no growth of {name}", none, "ln 1 is 0", [f"log of four and {name}"])
    zero = Equation(over(t, root, none.lhs), "=", over(t, root, ZERO))
    b.linked(f"no growth of {name}, summed", zero, "sum over", "summed", [f"no growth of {name}"])


def _derive_at_minus_one(b: SpectrumBuilder) -> None:
    t = b.theory
    derive_number(b, "ln 4", 2 * Log(FOUR))
    body = integrands(t)["-1"]
    value = Product((PI, 2 * Log(FOUR))) - centre_integral(t)
    links = ["number lemma: ln 4", "centre: integral"]
    b.linked("-1: integral", Equation(half(t, body), "=", value), "linear", "the difference", links)
    for root in (t.symbols["χ"], t.symbols["ψ"]):
        where = (f"Re {root.name} = -1", f"Im {root.name} = 0")
        derive_at_minus_one(b, root, body)
        derive_growth(b, root)
        _derive_no_growth(b, root, [], where)
        known = [f"{root.name} on the circle, integral", "-1: integral", f"no growth of {root.name}"]
        derive_jensen(b, root, [*known, *(f"far centre{sign}, logarithm" for sign in "-+")])


def _derive_logarithm(b: SpectrumBuilder) -> None:
    """Derive ln det Phi on the circle, by the eigenvalues of both loops."""
    t = b.theory
    A, S = t.symbols["A"], t.symbols["S"]
    b.positive_number("det S > 0", Equation(Det(S), ">", ZERO), "a positive definite matrix", ["S > 0"])
    b.say("On the circle det(I - zM) is, but for a power of z, the conjugate of det(zI - M), for M is real:")
    loops = 2 * log_modulus(t, closed_loop(t)) - 2 * log_modulus(t, A)
    log = log_spectrum(t, point(t))
    b.linked(
        "ln det Phi on the circle",
        Equation(log, "=", log_innovation(t) + loops),
        "mirrored",
        "the factor is closed loop over open loop",
        ["spectrum and loops"],
    )
    known = list[str]()
    for loop, matrix, names in (("open", A, OPEN), ("closed", closed_loop(t), CLOSED)):
        known += _derive_modulus(b, loop, matrix, names)
    pairs = {n: over(t, t.symbols[n], both(t, t.symbols[n])[0] + both(t, t.symbols[n])[1]) for n in (*OPEN, *CLOSED)}
    opened, closed = (pairs[a] + pairs[c] for a, c in (OPEN, CLOSED))
    b.state(
        "ln det Phi by eigenvalues",
        Equation(log, "=", log_innovation(t) + HALF * (closed - opened)),
        "pairs of conjugates",
        ["ln det Phi on the circle", *known],
    )


def _derive_modulus(b: SpectrumBuilder, loop: str, matrix: Term, names: tuple[str, str]) -> list[str]:
    """Derive ln|det(zI - M)| by the eigenvalues, and that conjugates are at the same distances; return the steps."""
    t, name = b.theory, f"characteristic polynomial of the {loop} loop"
    using = ["eigenvalues of A", "eigenvalues of A at -1 apart"] if loop == "open" else ["eigenvalues of A - KC"]
    b.state(name, Equation(Det(at(t, matrix)), "=", product(t, *names)), "by its roots", using)
    one, other = (over(t, t.symbols[n], both(t, t.symbols[n])[0]) for n in names)
    logs = Equation(log_modulus(t, matrix), "=", HALF * one + HALF * other)
    b.linked(f"modulus of the {loop} loop", logs, "modulus", "the modulus of a product", [name])
    for n in names:
        first, second = (over(t, t.symbols[n], log) for log in both(t, t.symbols[n]))
        b.linked(f"conjugates of {n}", Equation(first, "=", second), "conjugate", PAIRS, [])
    return [f"modulus of the {loop} loop", *(f"conjugates of {n}" for n in names)]


def _derive_integral(b: SpectrumBuilder) -> None:
    """Derive the integral of ln det Phi over half of the circle."""
    t, bodies = b.theory, integrands(b.theory)
    values = {n: over(t, t.symbols[n], 4 * PI * Growth(t.symbols[n])) for n in (*OPEN, *CLOSED)}
    opened, closed = (values[a] + values[c] for a, c in (OPEN, CLOSED))
    for name, value, (a, c) in (("the open loop", opened, OPEN), ("the closed loop", closed, CLOSED)):
        links = [f"circle lemma of {a}, summed", f"circle lemma of {c}, summed"]
        _linear(b, name, bodies[name], value, links)
    _linear(b, "both loops", bodies["both loops"], closed - opened, ["the closed loop", "the open loop"])
    _linear(b, "half of both", bodies["half of both"], HALF * (closed - opened), ["both loops"])
    derive_number(b, "ln det S", log_innovation(t))
    whole = Product((PI, log_innovation(t))) + HALF * (closed - opened)
    _linear(b, "all", bodies["all"], whole, ["number lemma: ln det S", "half of both"])


def _linear(b: SpectrumBuilder, name: str, body: Term, value: Term, links: list[str]) -> Step:
    links = [link if link.startswith(("circle", "number")) else f"integral of {link}" for link in links]
    return b.linked(f"integral of {name}", Equation(half(b.theory, body), "=", value), "linear", "both", links)


def _derive_theorem(b: SpectrumBuilder) -> None:
    t, bodies = b.theory, integrands(b.theory)
    weighted = Equation(bodies["ln det Phi"], "=", bodies["all"])
    b.state("ln det Phi, weighted", weighted, "times the derivative of the angle", ["ln det Phi by eigenvalues"])
    halves = Equation(half(t, weighted.lhs), "=", half(t, weighted.rhs))
    b.linked("half of the circle", halves, "same argument", "the same integrand", ["ln det Phi, weighted"])
    roots = [t.symbols[n] for n in ("λ", *OPEN)]
    sums = [over(t, r, Log(ONE + Max(excess(r)))) for r in roots]
    split = t.statement("eigenvalues of A at -1 apart")
    b.state(
        "eigenvalues at -1 apart", Equation(split.lhs, "=", split.rhs), "definition", ["eigenvalues of A at -1 apart"]
    )
    derive_growth(b, roots[0])
    b.linked(
        "all eigenvalues",
        Equation(sums[0], "=", sums[1] + sums[2]),
        "same roots",
        "equal polynomials have equal roots",
        ["eigenvalues at -1 apart"],
    )
    _derive_innovation(b)
    b.say("The discrete counterpart of theorem 1, for any A:")
    known = ["half of the circle", "integral of all", "all eigenvalues", "log of the innovation covariance"]
    known += [f"no growth of {n}, summed" for n in ("ξ", "χ", "ψ")]
    mean = around(t, log_spectrum(t, angle(t)))
    b.state(
        "discrete theorem 1",
        Equation(Log(Det(innovation(t))), "=", mean + 2 * outside(t)),
        "the closed loop contributes nothing",
        known,
    )


def _derive_innovation(b: SpectrumBuilder) -> None:
    """Derive ln det S = ln det(CPC' + R)."""
    t = b.theory
    dets = Det(innovation(t)), Det(t.symbols["S"])
    b.state("innovation covariance", Equation(dets[0], "=", dets[1]), "definition", ["S"], rule="determinant")
    b.sign(
        "det(CPC'+R) > 0",
        Equation(dets[0], ">", ZERO),
        "definition",
        ["det S > 0"],
        identities=["innovation covariance"],
    )
    logs = Equation(Log(dets[0]), "=", Log(dets[1]))
    b.linked("log of the innovation covariance", logs, "same argument", "the same number", ["innovation covariance"])
