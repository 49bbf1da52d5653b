"""Positivity, comparison, uniqueness and operators: what each rule accepts, and what it must reject."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction

import pytest

from derive.kernel import Alphabet, Letter, Poly, Rejected, Term, identity
from derive.rules import (
    Comparison,
    Context,
    Fact,
    Positivity,
    Square,
    Uniqueness,
    at_start,
    differentiate,
    expect,
    replay_comparison,
    replay_positivity,
    replay_uniqueness,
    sift,
    substitute,
    variation,
)

SIZES = {"C": ("m", "n"), "R": ("m", "m"), "x": ("n", "1"), "w": ("n", "1"), "v": ("m", "1"), "y": ("m", "1")}
SYMMETRIC = {"P", "H", "Q", "R", "W", "D", "X", "N", "dP"}
LETTERS = Alphabet(
    {
        name: Letter(name, *SIZES.get(name, ("n", "n")), symmetric=name in SYMMETRIC)
        for name in (*SYMMETRIC, *SIZES, "A", "B", "Ai", "M", "L", "K", "dL", "Phi", "Y")
    },
    frozenset({"a", "s"}),
)


def poly(rows, cols, *terms):
    """Build a polynomial from (coefficient, letters, scalars)."""
    return Poly({(tuple(s.split()), tuple(w.split())): c for c, w, s in terms}, rows, cols)


def square(*terms):
    return poly("n", "n", *((c, w, "") for c, w in terms))


def letter(name):
    return Poly({((), (name,)): 1}, *LETTERS.shape(name))


def term(relation, left="", right="", coefficient=1):
    return Term(Fraction(coefficient), (), tuple(left.split()), relation, False, tuple(right.split()))


def facts(**kinds):
    return {name: Fact(kind, ((letter(name),),)) for name, kind in kinds.items()}


# ------------------------------------------------------------------------------------------------ positivity
# A P A' + 2 B Q B' >= 0 and, with A Ai = I and P > 0, > 0
CONTEXT = Context(
    LETTERS,
    relations={"inverse": square((1, "A Ai"), (-1, "")), "same": square((1, "K"), (-1, "A"))},
    facts={**facts(P="pd", Q="psd", M="hurwitz"), "I": Fact("pd", ((identity("n"),),))},
    nonnegative=frozenset({"a", "∫τ"}),
)
CLAIM = ((square((1, "K P K'"), (2, "B Q B'")),),)
SQUARES = (Square(Fraction(1), (), ((letter("A"),),), "P"), Square(Fraction(2), (), ((letter("B"),),), "Q"))
# K P K' - A P A' = (K - A) P K' + A P (K - A)'
TERMS = (((term("same", "", "P K'"), Term(Fraction(1), (), ("A", "P"), "same", True, ())),),)
PROOF = Positivity(CLAIM, SQUARES, TERMS, 0, letter("Ai"), (term("inverse"),))


def positive(proof, claim=None, context=CONTEXT):
    return replay_positivity(proof, claim or proof.claim, context)


def test_sum_of_squares():
    assert positive(PROOF) == "pd"
    assert positive(replace(PROOF, strict=None)) == "psd"


@pytest.mark.parametrize(
    ("change", "match"),
    [
        ({"terms": (((),),)}, "do not make up the claim"),
        ({"terms": ()}, "every block needs its certificate"),
        ({"terms": (((), ()),)}, "every block needs its certificate"),
        ({"squares": SQUARES[:1]}, "do not make up the claim"),
        ({"squares": (SQUARES[0], replace(SQUARES[1], coefficient=Fraction(3)))}, "do not make up the claim"),
        ({"squares": (replace(SQUARES[0], factor=((letter("B"),),)), SQUARES[1])}, "do not make up the claim"),
        ({"squares": (replace(SQUARES[0], fact="M"), SQUARES[1])}, "no fact M of kind psd or pd"),
        ({"squares": (replace(SQUARES[0], fact="W"), SQUARES[1])}, "no fact W"),
        ({"squares": (replace(SQUARES[0], factor=()), SQUARES[1])}, "another number of blocks"),
        ({"squares": (replace(SQUARES[0], factor=((letter("A"), letter("A")),)), SQUARES[1])}, "another number"),
        ({"strict": 1}, "no fact Q of kind pd"),
        ({"strict": 2}, "no such square"),
        ({"strict": -1}, "no such square"),
        ({"inverse": None}, "a right inverse"),
        ({"inverse": letter("A")}, "do not make up the claim"),
        ({"inverse_terms": ()}, "do not make up the claim"),
        ({"inverse": letter("C")}, "cannot multiply"),
    ],
)
def test_a_changed_positivity_proof_is_rejected(change, match):
    with pytest.raises(Rejected, match=match):
        positive(replace(PROOF, **change))


def test_positivity_of_another_claim():
    with pytest.raises(Rejected, match="another claim"):
        positive(PROOF, ((square((1, "K P K'")),),))


@pytest.mark.parametrize(
    "square_", [replace(SQUARES[0], coefficient=Fraction(-1)), replace(SQUARES[0], scalars=("s",))]
)
def test_a_negative_square_is_rejected(square_):
    claim = ((poly("n", "n", (square_.coefficient, "A P A'", " ".join(square_.scalars))),),)
    with pytest.raises(Rejected, match="may be negative"):
        positive(Positivity(claim, (square_,), (((),),)))


@pytest.mark.parametrize(("coefficient", "scalars"), [(0, ""), (1, "a")])
def test_a_coefficient_that_may_vanish_is_not_strict(coefficient, scalars):
    claim = ((poly("n", "n", (coefficient, "A P A'", scalars)),),)
    square_ = Square(Fraction(coefficient), tuple(scalars.split()), ((letter("A"),),), "P")
    proof = Positivity(claim, (square_,), (((),),))
    assert positive(proof) == "psd"
    with pytest.raises(Rejected, match="may vanish"):
        positive(replace(proof, strict=0, inverse=letter("Ai"), inverse_terms=(term("inverse"),)))


def test_an_integral_of_squares():
    claim = ((poly("n", "n", (1, "Phi@t,τ P Phi'@t,τ", "∫τ")),),)
    square_ = Square(Fraction(1), ("∫τ",), ((Poly({((), ("Phi@t,τ",)): 1}, "n", "n"),),), "P")
    assert positive(Positivity(claim, (square_,), (((),),))) == "psd"
    with pytest.raises(Rejected, match="may be negative"):
        positive(Positivity(claim, (square_,), (((),),)), context=replace(CONTEXT, nonnegative=frozenset()))


@pytest.mark.parametrize("complex_", ["A", "s"])
def test_a_complex_factor_makes_no_square(complex_):
    claim = ((poly("n", "n", (1, "A P A'", "s s")),),)
    proof = Positivity(claim, (Square(Fraction(1), (), ((poly("n", "n", (1, "A", "s")),),), "P"),), (((),),))
    assert positive(proof) == "psd"
    with pytest.raises(Rejected, match="may be complex"):
        positive(proof, context=replace(CONTEXT, complex=frozenset({complex_})))


def test_blocks():
    column = (letter("A"),), (letter("C"),)
    claim = (
        (square((1, "A P A'")), poly("n", "m", (1, "A P C'", ""))),
        (poly("m", "n", (1, "C P A'", "")), poly("m", "m", (1, "C P C'", ""))),
    )
    proof = Positivity(claim, (Square(Fraction(1), (), column, "P"),), (((), ()), ((), ())))
    assert positive(proof) == "psd"
    with pytest.raises(Rejected, match="one block"):
        positive(replace(proof, strict=0, inverse=letter("Ai")))
    turned = (claim[0], (claim[1][0].scale(-1), claim[1][1]))
    with pytest.raises(Rejected, match="do not make up the claim"):
        positive(replace(proof, claim=turned), turned)


@pytest.mark.parametrize(
    "claim",
    [
        ((square((1, "A P A'")), square((1, "A P A'"))),),
        ((square((1, "A P A'")),), (square((1, "A P A'")),)),
        ((Poly({}, "n", "m"),),),
        ((Poly({}, "n", "n"), Poly({}, "m", "n")), (Poly({}, "m", "n"), Poly({}, "m", "m"))),
    ],
)
def test_only_square_block_matrices_are_positive(claim):
    proof = Positivity(claim, (), tuple(tuple(() for _ in row) for row in claim))
    with pytest.raises(Rejected, match="square block matrices"):
        positive(proof)


def test_strictness_needs_a_factor_of_one_block():
    core = ((letter("P"), Poly({}, "n", "n")), (Poly({}, "n", "n"), letter("P")))
    context = replace(CONTEXT, facts={"both": Fact("pd", core)})
    claim = ((square((1, "A P A'"), (1, "B P B'")),),)
    square_ = Square(Fraction(1), (), ((letter("A"), letter("B")),), "both")
    proof = Positivity(claim, (square_,), (((),),))
    assert positive(proof, context=context) == "psd"
    with pytest.raises(Rejected, match="one block"):
        positive(replace(proof, strict=0, inverse=letter("Ai"), inverse_terms=(term("inverse"),)), context=context)


def test_the_core_of_a_square_is_square():
    context = replace(CONTEXT, facts={"P": Fact("psd", ((letter("P"), letter("P")),))})
    with pytest.raises(Rejected, match="square block matrices"):
        positive(replace(PROOF, strict=None), context=context)


# ------------------------------------------------------------------------------------------------ comparison
def equation(kind):
    if kind == "stein":
        return square((1, "M D M'"), (-1, "D"), (1, "Q"))
    return square((1, "M D"), (1, "D M'"), (1, "Q"))


def comparison_context(kind, **changes):
    stable = {"lyapunov": "hurwitz", "stein": "schur"}.get(kind)
    about = facts(M=stable) if stable else {"M": Fact("initial", ((letter("D"),),))}
    base = Context(
        LETTERS,
        relations={"equation": equation(kind)} if kind != "transient" else {},
        facts={**about, **facts(Q="psd", P="pd")},
        derivatives={"D": equation(kind)} if kind == "transient" else {},
    )
    return replace(base, **changes)


def compare(case, context=None, **changes):
    terms = (term("equation"),) if case != "transient" else ()
    proof = Comparison(case, letter("D"), letter("M"), "M", "Q", terms)
    return replay_comparison(replace(proof, **changes), letter("D"), context or comparison_context(case))


@pytest.mark.parametrize("kind", ["lyapunov", "stein", "transient"])
def test_comparison(kind):
    assert compare(kind) == "psd"


@pytest.mark.parametrize(
    ("change", "match"),
    [
        ({"claim": letter("P")}, "another claim"),
        ({"kind": "stein"}, "no fact M of kind schur"),
        ({"kind": "guess"}, "not about this matrix"),
        ({"stable": "Q"}, "no fact Q of kind hurwitz"),
        ({"matrix": letter("A")}, "not about this matrix"),
        ({"forcing": "M"}, "no fact M of kind psd or pd"),
        ({"forcing": "P"}, "do not make up the claim"),
        ({"terms": ()}, "do not make up the claim"),
        ({"terms": (term("equation", coefficient=-1),)}, "do not make up the claim"),
    ],
)
def test_a_changed_comparison_is_rejected(change, match):
    with pytest.raises(Rejected, match=match):
        compare("lyapunov", **change)


def test_comparison_needs_the_right_facts():
    with pytest.raises(Rejected, match="may be complex"):
        compare("lyapunov", comparison_context("lyapunov", complex=frozenset({"M"})))
    wrong = {**facts(Q="psd"), "M": Fact("schur", ((letter("M"),),))}
    with pytest.raises(Rejected, match="no fact M of kind hurwitz"):
        compare("lyapunov", comparison_context("lyapunov", facts=wrong))
    block = {**facts(M="hurwitz"), "Q": Fact("psd", ((letter("Q"), letter("Q")), (letter("Q"), letter("Q"))))}
    with pytest.raises(Rejected, match="several blocks"):
        compare("lyapunov", comparison_context("lyapunov", facts=block))
    for shape in (((letter("Q"), letter("Q")),), ((letter("Q"),), (letter("Q"),))):
        with pytest.raises(Rejected, match="several blocks"):
            compare("lyapunov", comparison_context("lyapunov", facts={**block, "Q": Fact("psd", shape)}))
    other = {**facts(Q="psd"), "M": Fact("initial", ((letter("P"),),))}
    with pytest.raises(Rejected, match="not about this matrix"):
        compare("transient", comparison_context("transient", facts=other))
    with pytest.raises(Rejected, match="derivative of D is not declared"):
        compare("transient", comparison_context("transient", derivatives={}))


# ------------------------------------------------------------------------------------------------ uniqueness
# Y and X Phi with Y' = A Y, X constant... both solve Z' = A Z and start at Phi(t0,t0) X = X
FLOW = Context(
    LETTERS,
    relations={"start": square((1, "Y@t0"), (-1, "Phi@t0,t0 X"))},
    derivatives={
        "Y@t": Poly({((), ("A", "Y@t")): 1}, "n", "n"),
        "Phi@t,t0": Poly({((), ("A", "Phi@t,t0")): 1}, "n", "n"),
    },
    constants=frozenset({"X", "A"}),
)
SAME = square((1, "Y@t"), (-1, "Phi@t,t0 X"))
UNIQUE = Uniqueness(SAME, letter("A"), Poly({}, "n", "n"), (), (term("start"),))


def test_uniqueness():
    replay_uniqueness(UNIQUE, SAME, FLOW)


def test_uniqueness_with_coefficients_on_both_sides():
    """Z = Y X Y' and W solve the same Lyapunov equation without forcing."""
    context = replace(
        FLOW,
        relations={"start": square((1, "W@t0"), (-1, "Y@t0 X Y'@t0"))},
        derivatives={**FLOW.derivatives, "W@t": square((1, "A W@t"), (1, "W@t A'"))},
    )
    claim = square((1, "W@t"), (-1, "Y@t X Y'@t"))
    proof = Uniqueness(claim, letter("A"), LETTERS.transpose(letter("A")), (), (term("start"),))
    replay_uniqueness(proof, claim, context)
    with pytest.raises(Rejected, match="do not make up the claim"):
        replay_uniqueness(replace(proof, right=LETTERS.transpose(letter("A")).scale(-1)), claim, context)


@pytest.mark.parametrize(
    ("change", "context", "match"),
    [
        ({"claim": square((1, "Y@t"))}, {}, "another claim"),
        ({"left": letter("B")}, {}, "do not make up the claim"),
        ({"right": letter("A")}, {}, "do not make up the claim"),
        ({"initial_terms": ()}, {}, "do not make up the claim"),
        ({"rate_terms": (term("start"),)}, {}, "do not make up the claim"),
        ({"left": poly("n", "n", (1, "A", "δ(t,τ)"))}, {}, "continuous"),
        ({}, {"random": frozenset({"A"})}, "continuous"),
        ({}, {"derivatives": {}}, "not declared"),
        ({}, {"constants": frozenset({"A"})}, "derivative of X is not declared"),
    ],
)
def test_a_changed_uniqueness_proof_is_rejected(change, context, match):
    with pytest.raises(Rejected, match=match):
        replay_uniqueness(replace(UNIQUE, **change), SAME, replace(FLOW, **context))


def test_value_at_the_start():
    full = poly("n", "n", (1, "Phi@t,τ", "∫τ"), (1, "Phi@t,t0 X", ""))
    assert at_start(full, FLOW) == square((1, "Phi@t0,t0 X"))
    with pytest.raises(Rejected, match="value of B at t0 is not declared"):
        at_start(letter("B"), FLOW)


# ------------------------------------------------------------------------------------------------ d/dt
MOVING = Context(
    LETTERS,
    derivatives={
        "X": square((1, "A X"), (1, "X A'"), (1, "W")),
        "Y": square((1, "A Y")),
        "Phi@t,τ": Poly({((), ("A", "Phi@t,τ")): 1}, "n", "n"),
    },
    constants=frozenset({"A", "B", "N"}),
)


def test_product_rule_and_transposes():
    rate = square((1, "A Y B Y'"), (1, "Y B Y' A'"))
    assert differentiate(square((1, "Y B Y'")), MOVING) == rate
    assert differentiate(square((1, "B X")), MOVING) == square((1, "B A X"), (1, "B X A'"), (1, "B W"))
    assert differentiate(square((3, "A B"), (1, "Phi@τ,t0")), MOVING) == Poly({}, "n", "n")


def test_leibniz_rule():
    integral = poly("n", "n", (1, "Phi@t,τ N Phi'@t,τ", "∫τ"))
    rate = poly(
        "n", "n", (1, "Phi@t,t N Phi'@t,t", ""), (1, "A Phi@t,τ N Phi'@t,τ", "∫τ"), (1, "Phi@t,τ N Phi'@t,τ A'", "∫τ")
    )
    assert differentiate(integral, MOVING) == rate


@pytest.mark.parametrize(
    ("moving", "match"),
    [
        (square((1, "M")), "derivative of M is not declared"),
        (square((1, "A@t")), "derivative of A@t is not declared"),
        (square((1, "Phi@t,σ")), "derivative of Phi@t,σ is not declared"),
        (poly("n", "n", (1, "A", "δ(t,τ)")), "delta is not differentiated"),
    ],
)
def test_an_undeclared_derivative_is_rejected(moving, match):
    with pytest.raises(Rejected, match=match):
        differentiate(moving, MOVING)


def test_a_derivative_is_not_captured():
    context = replace(MOVING, derivatives={"Y": Poly({((), ("Phi@τ,t0",)): 1}, "n", "n")})
    with pytest.raises(Rejected, match="capture what stands for Y"):
        differentiate(poly("n", "n", (1, "Phi@σ,τ Y", "∫τ")), replace(context, constants=frozenset()))
    inner = replace(MOVING, derivatives={"Y": poly("n", "n", (1, "Phi@σ,τ", "∫τ"))})
    with pytest.raises(Rejected, match="captured"):
        differentiate(square((1, "Phi@τ,t0 Y")), inner)


# ------------------------------------------------------------------------------------------------ E[.]
NOISY = Context(
    LETTERS,
    moments={
        ("w@τ", "w'@σ"): poly("n", "n", (1, "W", "δ(τ,σ)")),
        ("w@t", "w'@τ"): poly("n", "n", (1, "W", "δ(t,τ)")),
        ("x", "x'"): letter("P"),
        ("x", "v'"): Poly({}, "n", "m"),
    },
    random=frozenset({"x", "w", "v"}),
    uncentred=frozenset({"y"}),
)


def test_expectation():
    before = square((1, "A x x' A'"), (2, "B"))
    assert expect(before, NOISY) == square((1, "A P A'"), (2, "B"))
    assert expect(poly("n", "1", (1, "A x", "")), NOISY) == Poly({}, "n", "1")
    assert expect(poly("n", "n", (1, "x v' C", "")), NOISY) == Poly({}, "n", "n")
    assert expect(poly("n", "n", (1, "C' v x'", "")), NOISY) == Poly({}, "n", "n")


@pytest.mark.parametrize(
    ("moment", "match"),
    [
        (square((1, "w@τ x'")), r"moment E\[w@τ x'\] is not declared"),
        (poly("m", "m", (1, "v v'", "")), "is not declared"),
        (poly("1", "1", (1, "x' A x", "")), "no rule for the expectation"),
        (poly("1", "1", (1, "x' x", "")), "is not declared"),
        (square((1, "x x' x x'")), "no rule for the expectation"),
        (poly("m", "n", (1, "y x'", "")), "no declared mean"),
        (poly("m", "1", (1, "y", "")), "no declared mean"),
    ],
)
def test_an_undeclared_moment_is_rejected(moment, match):
    with pytest.raises(Rejected, match=match):
        expect(moment, NOISY)


def test_white_noise():
    both = poly("n", "n", (1, "Phi@t,τ w@τ w'@σ Phi'@t,σ", "∫σ ∫τ"))
    (((scalars, word), c),) = expect(both, NOISY).terms.items()
    assert (c, len(scalars), word[1]) == (1, 1, "W")
    assert word in (("Phi@t,τ", "W", "Phi'@t,τ"), ("Phi@t,σ", "W", "Phi'@t,σ"))
    end = poly("n", "n", (1, "B w@t w'@τ Phi'@t,τ", "∫τ"))
    assert expect(end, NOISY) == poly("n", "n", (Fraction(1, 2), "B W Phi'@t,t", ""))


def test_a_moment_is_not_captured():
    context = replace(NOISY, moments={("x", "x'"): Poly({((), ("Phi@τ,t0",)): 1}, "n", "n")})
    with pytest.raises(Rejected, match="capture"):
        expect(poly("n", "n", (1, "Phi@t,τ x x'", "∫τ")), context)


def test_deltas_that_cannot_be_integrated_stay():
    for scalars in ("δ(t,τ)", "δ(τ,t)", "δ(τ,σ)", "∫τ δ(τ,σ)", "∫τ δ(t0,τ)", "∫τ δ(τ,τ)"):
        kept = poly("n", "n", (1, "Phi@t,τ", scalars))
        assert sift(kept) == kept
    for scalars in ("δ(t,τ) δ(t,τ) ∫τ", "δ(t,τ) δ(t0,τ) ∫τ", "δ(t,τ) δ(τ,σ) ∫σ ∫τ"):
        with pytest.raises(Rejected, match="has a meaning"):
            sift(poly("n", "n", (1, "A", scalars)))
    two = poly("n", "n", (1, "Phi@τ,σ", "δ(τ,t1) δ(σ,t2) ∫t1 ∫t2 ∫σ ∫τ"))
    assert not any(s.startswith("δ") for m, _ in sift(two).terms for s in m)


# ------------------------------------------------------------------------------------------------ maps and gradients
def test_substitution():
    images = {"A": letter("B"), "C'": poly("n", "m", (2, "K C'", ""))}
    before = poly("m", "n", (1, "C A P", "s"), (1, "C", ""))
    assert substitute(before, images, LETTERS) == poly("m", "n", (2, "C K' B P", "s"), (2, "C K'", ""))
    with pytest.raises(Rejected, match="image of P is not symmetric"):
        substitute(before, {"P": letter("K")}, LETTERS)
    assert substitute(before, {"P": letter("Q")}, LETTERS) == poly("m", "n", (1, "C A Q", "s"), (1, "C", ""))
    with pytest.raises(Rejected, match="image of A is m x n, expected n x n"):
        substitute(before, {"A": letter("C")}, LETTERS)


STILL = Context(LETTERS, parameters=frozenset({"A", "P", "K"}))


def test_variation():
    moved = variation(square((1, "A L P L'"), (1, "K")), "L", "dL", STILL)
    assert moved == square((1, "A dL P L'"), (1, "A L P dL'"))
    integral = poly("n", "n", (1, "L A", "∫τ"))
    assert variation(integral, "L", "dL", STILL) == poly("n", "n", (1, "dL A", "∫τ"))


@pytest.mark.parametrize(
    ("moved", "letter_", "change", "context", "match"),
    [
        (square((1, "L B")), "L", "dL", {}, "B may depend on L"),
        (square((1, "L@τ")), "L@t", "dL@t", {}, "L@τ may depend on L@t"),
        (square((1, "L@τ")), "L@t", "dL@t", {"parameters": frozenset({"L", "dL"})}, "L@τ may depend on L@t"),
        (square((1, "L dL")), "L", "dL", {}, "dL may depend on L"),
        (square((1, "L dL@τ")), "L", "dL", {"parameters": frozenset({"L", "dL"})}, "dL@τ may depend on L"),
        (square((1, "L K")), "L", "dP", {}, "dP is not a direction of L"),
        (square((1, "P K")), "P", "dL", {}, "dL is not a direction of P"),
        (square((1, "L K")), "L", "C", {}, "C is not a direction of L"),
        (square((1, "L")), "L", "dL", {"relations": {"r": square((1, "dL"), (-1, ""))}}, "not a free direction"),
    ],
)
def test_a_gradient_needs_a_free_direction(moved, letter_, change, context, match):
    with pytest.raises(Rejected, match=match):
        variation(moved, letter_, change, replace(STILL, **context))
