"""The lecture on the Luenberger observer: what it rests on, what it refuses, and the errata of its source."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction
from itertools import product

import pytest

from derive.context import Declared, DeclaredFact, Theory
from derive.derivation import Given, learn
from derive.kernel import Rejected
from derive.matrix.hypotheses import Hypotheses
from derive.matrix.refute import refute
from derive.terms import Equation, Expect, Glyph, Gradient, Identity, Inverse, Trace, Zero, lower
from derive.theory import duality, luenberger
from derive.theory.builder import Builder, NotDerived, SquareOf
from derive.theory.exact import value
from derive.theory.luenberger_formulas import any_gain, innovation, optimal_gain, riccati_step, riccati_step_with_cross

SIGNALS = {"plant", "observer", "output k-1", "error", "error k-1"}
MOMENTS = {"P_k", "P_{k-1}", "Q_{k-1}", "R_{k-1}", "S_{k-1}", "e and v", "e and w"}
INNOVATION = {"P_{k-1} >= 0", "R_{k-1} > 0"}
RECURSION = SIGNALS | MOMENTS | INNOVATION | {"stationary gain", "optimal gain"}
LIMIT = {"P_{k-1} = P", "P >= 0", "R > 0", "constant R", "constant S"}
STEADY = RECURSION | LIMIT | {"P_k = P", "constant Q"}
RESTS_ON = {
    "error recursion": SIGNALS,
    "e_k and w_j": SIGNALS | {"e and w_j", "v and w_j", "w and w_j"},
    "e_k and v_j": SIGNALS | {"e and v_j", "v and v_j", "w and v_j"},
    "covariance recursion with cross-covariance": SIGNALS | MOMENTS,
    "covariance recursion": SIGNALS | MOMENTS | {"E[w v'] = 0"},
    "P_k >= 0": SIGNALS | MOMENTS | {"P_{k-1} >= 0", "joint noise"},
    "innovation covariance": INNOVATION,
    "gradient": set(),
    "gain with cross-covariance": INNOVATION | {"stationary gain"},
    "Loewner minimum": SIGNALS | MOMENTS | INNOVATION | {"stationary gain"},
    "attained": INNOVATION | {"stationary gain"},
    "gain": INNOVATION | {"stationary gain", "optimal gain", "E[w v'] = 0"},
    "Riccati recursion": RECURSION | {"E[w v'] = 0"},
    "Riccati equation": STEADY | {"S = 0"},
    "steady gain": INNOVATION | LIMIT | {"stationary gain", "optimal gain", "L_k = L", "S = 0"},
    "Stein equation": STEADY | {"S = 0", "L_k = L"},
    "steady optimum": STEADY | {"L_k = L", "A - L~ C Schur", "covariance of another gain"},
    "largest solution": STEADY | {"L_k = L", "A - L C Schur", "another solution", "L_o", "P_o >= 0"},
    "difference of two steps": {"L_1", "L_2", "P_1 >= 0", "P_2 >= 0", "R > 0"},
    "monotone step": {"L_1", "L_2", "P_1 >= 0", "P_2 >= 0", "P_1 >= P_2", "R > 0"},
    "Joseph form": {"P+", "L_f", "P >= 0", "R > 0"},
    "gain from the filtered covariance": {"P+", "L_f", "P >= 0", "R > 0"},
    "Riccati equation in information form": STEADY | {"S = 0"},
    "information form": {"P+", "L_f", "P >= 0", "P > 0", "R > 0"},
    "remaining noise": {"steady joint noise", "R > 0"},
    "reduction": {"P >= 0", "R > 0"},
    "spectral factorisation": STEADY | {"S = 0", "L_k = L", "z z^-1", "z I - A", "z^-1 I - A"},
}


@pytest.fixture(scope="module")
def lecture():
    return luenberger.lecture()


@pytest.fixture
def taught(lecture):
    """A builder that knows every lemma of the lecture."""
    b = Builder(luenberger.theory(), "test", "test")
    for step in lecture.steps:
        b.record(step)
    return b


@pytest.fixture
def s():
    return luenberger.theory().symbols


@pytest.mark.parametrize("name", RESTS_ON)
def test_what_a_theorem_rests_on(lecture, name):
    assert lecture.rests_on(name) == RESTS_ON[name]


@pytest.mark.parametrize("module", [luenberger, duality])
def test_what_is_used_is_shown(module):
    """Every definition and hypothesis that a step rests on is displayed in the lecture."""
    item = module.lecture()
    shown = {row.name for block_ in item.items if isinstance(block_, Given) for row in block_.rows}
    for step in item.steps:
        equations = {n for n in item.rests_on(step.name) if isinstance(item.theory.declared.get(n), Declared)}
        assert equations <= shown, step.name


def test_results_are_functions():
    numbers = [f().number for f in (luenberger.covariance_recursion, luenberger.gain, luenberger.riccati)]
    assert numbers == ["2", "3", "4"]
    assert luenberger.error_recursion().number == "2"
    assert (luenberger.algebraic_riccati().number, luenberger.steady_gain().number) == ("5", "u3")
    assert luenberger.optimality().statement.relation == "⪰"


def test_cases_are_marked():
    """A checker that holds the theory in force leaves these out: they are assumed where a step names them."""
    declared = luenberger.theory().declared.values()
    cases = {d.name for d in declared if isinstance(d, (Declared, DeclaredFact)) and d.case}
    assert cases == {"P_{k-1} = P", "P_k = P", "L_k = L", "P > 0", "A - L C Schur"}


def test_error_recursion_agrees_with_the_signals(lecture, s):
    """Step plant and observer on numbers, and compare their difference with the recursion."""
    for a, c, gain, state, guess, w, v in product((2, -1), (1, 3), (1, -2), (1, 5), (0, 2), (1, -4), (3, 7)):
        at = {"A": a, "B": 2, "C": c, "L_k": gain, "x_{k-1}": state, "xhat_{k-1}": guess, "u_{k-1}": 5}
        at |= {"w_{k-1}": w, "v_{k-1}": v, "y_{k-1}": c * state + v, "e_{k-1}": guess - state}
        after = [value(luenberger.theory().statement(name).rhs, at) for name in ("observer", "plant")]
        assert after[0] - after[1] == value(lecture.step("error recursion").statement.rhs, at)


# ------------------------------------------------------------------------------------------------ must reject
def refuse(b: Builder, lhs, rhs, *using: str, rule="identity"):
    with pytest.raises(NotDerived):
        b.state("mutant", Equation(lhs, "=", rhs), "", using, rule=rule)


def test_signs_of_the_error_recursion(taught, s):
    A, C, L, e, v, w = (s[k] for k in ("A", "C", "L_k", "e_{k-1}", "v_{k-1}", "w_{k-1}"))
    using = ["error", "error k-1", "observer", "plant", "output k-1"]
    moved = (A - L * C) * e
    taught.state("true", Equation(s["e_k"], "=", moved + L * v - w), "", using)
    for wrong in (moved + L * v + w, moved - L * v - w, (A + L * C) * e + L * v - w, moved.T.T + L * v):
        refuse(taught, s["e_k"], wrong, *using)


def test_terms_of_the_covariance_recursion(taught, s):
    A, C, L, P, Q, R, S = (s[k] for k in ("A", "C", "L_k", "P_{k-1}", "Q_{k-1}", "R_{k-1}", "S_{k-1}"))
    e_k, using = s["e_k"], ["error recursion"]
    closed = A - L * C
    cross = "covariance recursion with cross-covariance"
    for wrong in (
        Q + closed * P * closed.T,  # L R L' is missing
        Q + closed * P * closed + L * R * L.T,  # a transpose is missing
        Q + closed.T * P * closed + L * R * L.T,  # transposes are swapped
        any_gain(A, C, L, P, Q, R) - S * L.T - S * L.T,
        any_gain(A, C, L, P, Q, R) + L * S.T + S * L.T,
    ):
        refuse(taught, s["P_k"], wrong, cross)
    refuse(taught, s["P_k"], any_gain(A, C, L, P, Q, R), cross)  # it needs S = 0
    refuse(taught, Expect(e_k * s["w_{k-1}"].T), Zero("n", "n"), *using, rule="apply")


def test_gain_with_a_piece_missing(taught, s):
    A, C, L, P, Q, R, S = (s[k] for k in ("A", "C", "L_k", "P_{k-1}", "Q_{k-1}", "R_{k-1}", "S_{k-1}"))
    inverse = innovation(C, P, R).inv
    using = ["optimal gain", "gain with cross-covariance", "E[w v'] = 0", "Sigma_k^-1"]
    taught.state("true", Equation(L, "=", A * P * C.T * inverse), "", using)
    for wrong in (P * C.T * inverse, A.T * P * C.T * inverse, -A * P * C.T * inverse, 2 * A * P * C.T * inverse):
        refuse(taught, L, wrong, *using)
    refuse(taught, L, A * P * C.T * inverse, *using[:2])  # it needs S = 0
    refuse(taught, any_gain(A, C, P * C.T * inverse, P, Q, R), riccati_step(A, C, P, Q, R), *using)
    refuse(taught, s["P_k"], riccati_step_with_cross(A, C, P, Q, R, -S), "Riccati recursion with cross-covariance")
    refuse(taught, L, Inverse(C * P * C.T), *using)  # nobody says that C P C' has an inverse


def test_gradient_with_a_piece_missing(taught, s):
    A, C, L, P, Q, R, S = (s[k] for k in ("A", "C", "L_k", "P_{k-1}", "Q_{k-1}", "R_{k-1}", "S_{k-1}"))
    slope = Gradient(Trace(any_gain(A, C, L, P, Q, R, S)), L)
    sigma = innovation(C, P, R)
    for wrong in (2 * (L * sigma - P * C.T - S), 2 * (L * sigma - A * P * C.T), L * sigma - A * P * C.T - S):
        refuse(taught, slope, wrong, rule="gradient")
    cost = Gradient(Trace(s["P_k"]), L)  # the covariance after the step depends on the gain
    refuse(taught, cost, Zero("n", "l"), rule="gradient")


def test_steady_forms_with_a_piece_missing(taught, s):
    A, C, L, P, Q, R, L_f, after = (s[k] for k in ("A", "C", "L", "P", "Q", "R", "L_f", "P+"))
    one, weight, steady = Identity("n"), C.T * R.inv * C, ["Riccati equation", "steady gain", "Sigma^-1", "R^-1"]
    taught.state("true", Equation(P, "=", Q + (A - L * C) * P * (A - L * C).T + L * R * L.T), "", steady)
    refuse(taught, P, Q + (A - L * C) * P * (A - L * C).T, *steady)
    refuse(taught, L, P * C.T * innovation(C, P, R).inv, *steady)
    refuse(taught, L, L_f, "L_f", *steady)
    refuse(taught, P, A * P * (one + weight * P).inv * A + Q, "Z", *steady)
    refuse(taught, after.inv, P.inv - weight, "P+", "P^-1", "P+^-1", "Sigma^-1", "R^-1")


def test_comparison_in_the_wrong_direction(taught, s):
    A, C, L, free = (s[k] for k in ("A", "C", "L", "L~"))
    using = ["covariance of another gain", "closed loop", "steady gain with cross-covariance", "Sigma^-1"]
    with pytest.raises(NotDerived):
        taught.compare(
            "mutant",
            "stein",
            Equation(s["P"], "⪰", s["P~"]),
            "",
            A - free * C,
            "A - L~ C Schur",
            "steady square",
            using,
        )
    with pytest.raises(NotDerived, match="no certificate for mutant"):
        taught.compare(
            "mutant",
            "stein",
            Equation(s["P"], "⪰", s["P_o"]),
            "",
            A - L * C,
            "A - L~ C Schur",
            "square of the other solution",
            ["closed loop", "another solution", "L_o", "Sigma_o^-1"],
        )


def test_inverse_of_a_semidefinite_matrix(s):
    """P >= 0 alone is no reason for an inverse, nor is a covariance C P C' without noise."""
    b = Builder(luenberger.theory(), "test", "test")
    with pytest.raises(NotDerived, match="not declared, or whose reason is not proved"):
        b.state("mutant", Equation(s["P_{k-1}"].inv, "=", s["P_{k-1}"].inv), "")
    with pytest.raises(NotDerived):
        b.positive(
            "mutant",
            Equation(s["C"] * s["P_{k-1}"] * s["C"].T, "≻", Zero("", "")),
            "",
            [SquareOf(s["C"], "P_{k-1} >= 0")],
            witness=s["C"].T,
        )


# ------------------------------------------------------------------------------------------------ inverse by identities
def shift_theory(explicit_sign: int = 1) -> tuple[Theory, Builder]:
    """N N = 0, and (I - N)^-1 declared with the explicit inverse I + N (or a wrong one)."""
    t = Theory("shift", "Nilpotent shift")
    N, one = t.matrix("N", "n", "n"), Identity("n")
    t.assume("N N = 0", N * N, "=", Zero("n", "n"))
    explicit = one + N if explicit_sign > 0 else one - N
    t.inverse("X", one - N, "n", because=("right", "left"), by=explicit)
    return t, Builder(t, "shift", "Nilpotent shift")


def test_inverse_by_two_identities():
    t, b = shift_theory()
    N, one = t.symbols["N"], Identity("n")
    statement = Equation((one - N).inv, "=", one + N)
    b.state("right", Equation((one - N) * (one + N), "=", one), "", ["N N = 0"])
    with pytest.raises(NotDerived, match="not declared, or whose reason is not proved"):
        b.state("inverse", statement, "", ["X"])
    b.state("left", Equation((one + N) * (one - N), "=", one), "", ["N N = 0"])
    b.state("inverse", statement, "", ["X", "right", "left"])
    assert [o for o in b.lecture().verify() if not o.accepted] == []


def test_inverse_by_identities_about_another_matrix():
    t, b = shift_theory(explicit_sign=-1)
    N, one = t.symbols["N"], Identity("n")
    b.state("right", Equation((one - N) * (one + N), "=", one), "", ["N N = 0"])
    with pytest.raises(Rejected, match="not a reason why X exists"):
        b.state("left", Equation((one + N) * (one - N), "=", one), "", ["N N = 0"])


def test_inverse_by_the_same_side_twice():
    t = Theory("one-sided", "One-sided inverse")
    M, Y = t.matrix("M", "n", "n", Glyph("M")), t.matrix("Y", "n", "n")
    t.assume("right", M * Y, "=", Identity("n"))
    t.inverse("X", M, "n", because=("right", "right"), by=Y)
    with pytest.raises(Rejected, match="not a reason why X exists"):
        t.reading()


# ------------------------------------------------------------------------------------------------ errata
def results(lecture, number: str, finding: str) -> list[dict[str, str]]:
    erratum = next(e for e in lecture.errata if (e.number, e.finding) == (number, finding))
    return [dict(e.results) for e in erratum.evidence]


def test_errata_show_their_evidence(lecture):
    assert results(lecture, "2", "false") == [
        {"cross terms": "-1/2", "cross terms as printed": "1/2", "covariance": "1", "covariance as printed": "2"}
    ]
    assert results(lecture, "2", "assumption") == [{"covariance": "1", "covariance as printed": "3/2"}]
    assert results(lecture, "u1", "false") == [{"covariance": "3/2", "covariance as printed": "5/2"}]
    assert results(lecture, "3", "false") == [
        {"covariance with the printed gain": "7/2", "covariance with the correct gain": "3", "equation 4": "3"}
    ]
    assert results(lecture, "u3", "false") == [
        {
            "error matrix with the printed gain": "(7 − √5)/4 ≈ 1.191",
            "error matrix with the correct gain": "(3 − √5)/2 ≈ 0.382",
        }
    ]
    assert results(lecture, "5", "incomplete") == [
        {"smaller root": "0", "larger root": "3", "error matrix at the largest root": "1/2"},
        {"only root": "0", "error matrix at the largest root": "1"},
        {"only root": "-1/3", "error matrix at the largest root": "2"},
    ]


def test_errata_name_a_proved_statement(lecture):
    assert len(lecture.errata) == 7
    for erratum in lecture.errata:
        assert erratum.true == lecture.step(erratum.proved_by).statement
        assert erratum.finding in ("false", "incomplete", "assumption", "silent")


FACTS = ("P_{k-1} >= 0", "R_{k-1} > 0", "P >= 0", "Q >= 0", "R > 0", "joint noise")
STEADY_STATE = ("Riccati equation with cross-covariance", "steady gain with cross-covariance", "S = 0")


def hypotheses(lecture, *names: str) -> Hypotheses:
    """Return the named declarations and lemmas of the lecture as what a counterexample must satisfy."""
    reading = lecture.theory.reading()
    for step in lecture.steps:
        reading = learn(reading, lecture.theory, step)
    found = Hypotheses.of(reading.context, reading.inverses)
    return replace(
        found,
        relations={k: v for k, v in found.relations.items() if k in names or k.rpartition(".")[0] in names},
        facts={k: v for k, v in found.facts.items() if k in FACTS},
        inverses={k: v for k, v in found.inverses.items() if k in names},
    )


@pytest.mark.parametrize(
    ("number", "finding", "names"),
    [
        ("2", "assumption", ["covariance recursion with cross-covariance"]),
        ("3", "false", ["stationary gain", "optimal gain", "E[w v'] = 0", "Sigma_k^-1"]),
        ("u3", "false", [*STEADY_STATE, "Sigma^-1"]),
    ],
)
def test_printed_formulas_are_refuted(lecture, number, finding, names):
    """The machine finds a counterexample to what is printed, and none to what is derived."""
    erratum = next(e for e in lecture.errata if (e.number, e.finding) == (number, finding))
    problem, reading = hypotheses(lecture, *names), lecture.theory.reading()
    for step in lecture.steps:
        reading = learn(reading, lecture.theory, step)
    printed, true = (
        [lower(side, reading)[0][0] for side in (statement.lhs, statement.rhs)]
        for statement in (erratum.printed, erratum.true)
    )
    found = refute(*printed, problem)
    assert found is not None
    assert found.left != found.right
    assert refute(*true, problem, seconds=0.3) is None


def test_printed_sign_is_refuted(lecture):
    """With the sign as printed the covariance differs from the true one, and only with a cross-covariance."""
    reading = lecture.theory.reading()
    sides = [
        lower(lecture.step(name).statement.rhs, reading)[0][0]
        for name in ("opposite sign", "covariance recursion with cross-covariance")
    ]
    assert refute(*sides, hypotheses(lecture)) is not None
    assert refute(*sides, hypotheses(lecture, "E[w v'] = 0"), seconds=0.3) is None


def test_gain_formula_at_numbers(s):
    """A=2, C=P=Q=R=1: the gain is 1, and no other gain gives a smaller covariance."""
    A, C, L, P, Q, R = (s[k] for k in ("A", "C", "L_k", "P_{k-1}", "Q_{k-1}", "R_{k-1}"))
    at = {"A": 2, "C": 1, "P_{k-1}": 1, "Q_{k-1}": 1, "R_{k-1}": 1}
    best = value(optimal_gain(A, C, P, R), at)
    costs = {
        x: value(any_gain(A, C, L, P, Q, R), {**at, "L_k": x}) for x in (best, *(Fraction(i, 4) for i in range(9)))
    }
    assert best == 1
    assert min(costs.values()) == costs[best] == 3
