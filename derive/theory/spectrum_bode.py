"""The Bode integral of the filter: its sensitivity, its open loop, one output, and a faster roll-off."""

from __future__ import annotations

from derive.context import Theory
from derive.functions import Infinity, Limit, Log, Quotient
from derive.spectral import At, Det, Entry, Modulus, RealPart, Roots, Total
from derive.terms import Equation, Identity, Neg, Term, Trace, Zero
from derive.theory.scalar_continuous import ONE, ZERO
from derive.theory.spectrum_builder import SpectrumBuilder
from derive.theory.spectrum_filter import TRACES, factor, output_cost, resolvent, unstable
from derive.theory.spectrum_roots import (
    HALF,
    SOURCE,
    declare_integrals,
    derive_first_term,
    derive_integral,
    derive_same,
    on_axis,
    whole,
)


def declare(t: Theory) -> None:
    """Declare the sensitivity of the filter, its open loop, and one output."""
    A, C, K, open_loop, closed = (t.symbols[k] for k in ("A", "C", "K", "λ", "μ"))
    L = t.matrix("L", "l", "l", show_args=("s",), meaning="open loop of the filter")
    t.complex.add("L")
    t.define("L", L, C * resolvent(t) * K)
    one = Identity("l")
    t.atom("spectral", Det(one + L), name="det(I+L)")
    t.atom("reciprocal", Det(factor(t)), "the factor is regular", "1/det factor")
    t.atom("reciprocal", Det(one + L), "I + L is regular", "1/det(I+L)")
    for name, body in (
        ("CK", C * K), ("L", L), ("CFK", C * resolvent(t) * K), ("CAFK", C * A * resolvent(t) * K)
    ):  # fmt: skip
        t.atom("spectral", Trace(body), name=f"tr {name}")
    declare_integrals(t, "sensitivity", on_axis(t, sensitivity(t)), open_loop, closed)
    t.atom("spectral", along(t, sensitivity(t)), name="ln|sensitivity(s)|")
    t.atom("spectral", along(t, bode(t)), name="ln|1/det(I+L(s))|")
    t.fact("l = 1", "single", one, "one output", case=True)
    t.assume("CK = 0", C * K, "=", Zero("l", "l"), "all entries of L have two more poles than zeros", case=True)
    t.atom("reciprocal", ONE + Entry(L), "1 + L is regular", "1/(1+L)")
    for name, function in (("1/det(I+L)", bode(t)), ("1/(1+L)", single(t))):
        t.atom("spectral", on_axis(t, function), name=f"ln|{name}|")
        t.atom("improper", on_axis(t, function), name=f"integral of ln|{name}|")


def sensitivity(t: Theory) -> Quotient:
    """Return 1 / det[I + C (sI - A)^-1 K]."""
    return Quotient(ONE, Det(factor(t)))


def bode(t: Theory) -> Quotient:
    """Return 1 / det[I + L]."""
    return Quotient(ONE, Det(Identity("l") + t.symbols["L"]))


def single(t: Theory) -> Quotient:
    """Return 1 / (1 + L), for one output."""
    return Quotient(ONE, ONE + Entry(t.symbols["L"]))


def along(t: Theory, function: Term) -> Log:
    """Return ln|f(s)| along the reals."""
    return Log(Modulus(At(function, t.symbols["s"], t.symbols["s"])))


def derive(b: SpectrumBuilder) -> None:
    """Derive the Bode integrals."""
    _derive_bode(b)
    _derive_open_loop(b)
    _derive_feedback(b)


def _derive_bode(b: SpectrumBuilder) -> None:
    t = b.theory
    s, i, m, open_loop, closed = (t.symbols[k] for k in ("s", "i", "m", "λ", "μ"))
    b.heading("The Bode integral of the filter")
    function = sensitivity(t)
    b.sign("the factor is regular", Equation(Det(factor(t)), "≠", ZERO), "a quotient of polynomials that are not zero",
           ["product u(s) μ ≠ 0"], identities=["factor by its roots"])  # fmt: skip
    b.state(
        "sensitivity by its roots",
        Equation(function, "=", Quotient(Roots(s, open_loop, i, m), Roots(s, closed, i, m))),
        "open loop over closed loop",
        ["factor by its roots"],
    )
    derive_integral(b, "sensitivity", on_axis(t, function), open_loop, closed, "sensitivity by its roots")
    limit = HALF * Total(RealPart(closed), i, m) - HALF * Total(RealPart(open_loop), i, m)
    first = derive_first_term(
        b, "sensitivity", function, [(open_loop, 1)], [(closed, 1)], limit, "sensitivity by its roots"
    )
    cost = Neg(HALF * output_cost(t))
    b.say("Its zeros are the eigenvalues of A:")
    sums = ["log-integral of sensitivity", "closed loop, summed", "modulus of λ, summed"]
    integral = whole(b, on_axis(t, function))
    b.state(
        "sensitivity integral",
        Equation(integral, "=", first + unstable(t)),
        "proposition 1 for this function",
        [*sums, "first term of sensitivity"],
        number="17",
        source=SOURCE,
    )
    b.state(
        "sensitivity and cost",
        Equation(first + unstable(t), "=", cost + unstable(t)),
        "the trace of A - KC",
        ["first term of sensitivity", *TRACES],
        number="17",
        source=SOURCE,
    )
    b.state(
        "Bode integral",
        Equation(integral, "=", cost + unstable(t)),
        "both equations",
        ["sensitivity integral", "sensitivity and cost"],
        number="18",
        source=SOURCE,
    )


def _derive_open_loop(b: SpectrumBuilder) -> None:
    t = b.theory
    A, C, K, L, s = (t.symbols[k] for k in ("A", "C", "K", "L", "s"))
    F, one = resolvent(t), Identity("l")
    b.say("With the open loop of the filter as a feedback system")
    b.given("L", numbers=("19",), source=SOURCE)
    b.state("det(I + L)", Equation(Det(one + L), "=", Det(factor(t))), "definition", ["L"], rule="determinant")
    b.sign(
        "I + L is regular",
        Equation(Det(one + L), "≠", ZERO),
        "as before",
        ["product u(s) μ ≠ 0"],
        identities=["factor by its roots", "det(I + L)"],
    )
    b.state("return difference", Equation(bode(t), "=", sensitivity(t)), "definition", ["det(I + L)"])
    derive_same(b, "return difference", on_axis(t, bode(t)), on_axis(t, sensitivity(t)), "return difference")
    b.say("For large s the trace of sL tends to that of CK, because s(sI - A)⁻¹ = I + A(sI - A)⁻¹:")
    b.state("resolvent", Equation(Trace(L), "=", Trace(C * F * K)), "definition", ["L"], rule="trace")
    b.state(
        "s times the resolvent",
        Equation(Trace(s * (C * F * K)), "=", Trace(C * K) + Trace(C * A * F * K)),
        "the inverse",
        ["(sI-A)^-1"],
        rule="trace",
    )
    b.linked(
        "the resolvent vanishes",
        Equation(Limit(Trace(C * A * F * K), s, Infinity()), "=", ZERO),
        "resolvent",
        "its entries are strictly proper",
        [],
    )
    b.state(
        "s tr L",
        Equation(HALF * s * Trace(L), "=", HALF * Trace(C * K) + HALF * Trace(C * A * F * K)),
        "both",
        ["resolvent", "s times the resolvent"],
    )
    slope = Limit(HALF * s * Trace(L), s, Infinity())
    b.linked(
        "limit of s tr L",
        Equation(slope, "=", HALF * Trace(C * K)),
        "same argument",
        "the last term vanishes",
        ["s tr L"],
    )
    b.state("trace of CK", Equation(Trace(C * K), "=", output_cost(t)), "the gain", ["gain"], rule="trace")
    b.state(
        "Bode integral of L",
        Equation(whole(b, on_axis(t, bode(t))), "=", Neg(slope) + unstable(t)),
        "the Bode integral",
        ["integral: return difference", "Bode integral", "limit of s tr L", "trace of CK"],
        number="20",
        source=SOURCE,
    )


def _derive_feedback(b: SpectrumBuilder) -> None:
    t = b.theory
    C, K, L, s = (t.symbols[k] for k in ("C", "K", "L", "s"))
    logs = [along(t, f) for f in (bode(t), sensitivity(t))]
    b.heading("The Bode integral: one output, and a faster roll-off")
    b.linked(
        "return difference along the reals",
        Equation(logs[0], "=", logs[1]),
        "same argument",
        "the same function",
        ["return difference"],
    )
    b.state(
        "s ln|1/det(I+L)|", Equation(s * logs[0], "=", s * logs[1]), "the same", ["return difference along the reals"]
    )
    roots = [Total(RealPart(t.symbols[n]), t.symbols["i"], t.symbols["m"]) for n in ("μ", "λ")]
    first = Limit(s * logs[0], s, Infinity())
    b.linked(
        "roll-off by roots",
        Equation(first, "=", roots[0] - roots[1]),
        "same argument",
        "as for the sensitivity",
        ["s ln|1/det(I+L)|"],
    )
    b.say("This limit is zero exactly where the output error is, so for a filter it needs more than detectability:")
    b.state(
        "roll-off",
        Equation(first, "=", Neg(output_cost(t))),
        "the trace of A - KC",
        ["roll-off by roots", "trace by λ", "trace by μ", "trace of KC"],
    )
    b.given("CK = 0")
    b.state(
        "no slope", Equation(Trace(C * K), "=", Trace(Zero("l", "l"))), "sL(s) tends to CK", ["CK = 0"], rule="trace"
    )
    b.state(
        "fast roll-off",
        Equation(first, "=", ZERO),
        "then tr CK = 0",
        ["trace by λ", "trace by μ", "trace of KC", "no slope", "trace of CK"],
        number="23",
        source=SOURCE,
    )
    b.say("For one output a determinant is the number itself:")
    b.linked("det of one entry", Equation(Det(Identity("l") + L), "=", Entry(Identity("l") + L)), "single", "l = 1", [])
    b.sign(
        "1 + L is regular",
        Equation(ONE + Entry(L), "≠", ZERO),
        "as before",
        ["product u(s) μ ≠ 0"],
        identities=["det of one entry", "factor by its roots", "det(I + L)"],
    )
    b.state("one return difference", Equation(single(t), "=", bode(t)), "l = 1", ["det of one entry"])
    derive_same(b, "one return difference", on_axis(t, single(t)), on_axis(t, bode(t)), "one return difference")
    slope = Limit(HALF * s * Entry(L), s, Infinity())
    b.state(
        "Bode integral of one output",
        Equation(whole(b, on_axis(t, single(t))), "=", Neg(slope) + unstable(t)),
        "(20) for l = 1",
        ["Bode integral of L", "integral: one return difference", "limit of s tr L"],
        number="22",
        source=SOURCE,
    )
