"""The scalar lecture: a second opinion by numbers, and what its rules must reject."""

from __future__ import annotations

import json
import math
import random
from dataclasses import replace
from fractions import Fraction
from typing import Any

import pytest

from derive.context import Declared, DeclaredAtom, declare
from derive.derivation import check, learn
from derive.document import lecture_to_json
from derive.functions import PI, Abs, Definite, Infinity, Limit, Log, Power, Quotient, Rate, Start, value
from derive.kernel import Poly, Rejected
from derive.real import atom_relation, scalars_of
from derive.replay import verify_file
from derive.terms import Equation, MissingInverse, Neg, Number, Zero
from derive.theory import lecture
from tests.derive.scalar.witnesses import POSITIVE, assigned

ZERO = Zero("", "")
ATOMS = {
    "root": lambda x: math.sqrt(max(x, 0.0)), "reciprocal": lambda x: 1 / x, "absolute": abs,
    "part": lambda x: max(0.0, x), "exp": math.exp, "log": math.log, "arctan": math.atan, "defined": lambda x: x,
}  # fmt: skip


@pytest.fixture(scope="module")
def walked():
    item, earlier, out = lecture("scalar"), {}, []
    reading = item.theory.reading()
    for step in item.steps:
        out.append((step, reading, dict(earlier)))
        earlier[step.name] = step
        reading = learn(reading, item.theory, step)
    return {step.name: (step, before, steps) for step, before, steps in out}, reading


# ------------------------------------------------------------------------------------------------ second opinion
class Outside(Exception):  # noqa: N818
    """The point is outside of a case."""


class Point:
    """Random numbers for the parameters; atoms by their functions, sequences by their steps, and cases imposed."""

    def __init__(self, seed: int, reading, cases):
        rng = random.Random(seed)
        self.real, self.rng, self.known = reading.real, rng, {"π": math.pi}
        self.recursions = {"P_k'": reading.context.relations["recursion"]}
        for name in cases:
            if name.endswith("= 0") and name[0] in "ACWQ" and len(name) == 5:
                self.known[name[0]] = 0.0
        if "A^2 = 1" in cases:
            self.known["A"] = rng.choice((1.0, -1.0))
        if "P0 = 0" in cases:
            self.known["P0"] = 0.0
        if "S = 0" in cases:
            self.known |= {"A": 0.0, "W": 0.0}
        if "A < 0" in cases:
            self.known["A"] = -rng.random() - 0.1
        self.assigned = assigned(cases)
        self.impose(cases)

    def impose(self, cases) -> None:
        """Choose some parameters so that cases that are equations between several hold."""
        known, draw = self.known, self.scalar
        if "T = 0" in cases:
            known |= {"A": self.rng.choice((1.0, -1.0)), "Q": 0.0}
        if "F = 0" in cases:
            known["N"] = draw("A") * draw("V") / draw("C")
        if "q = 0" in cases:
            known["W"] = draw("N") ** 2 / draw("V")
        if "q_d = 0" in cases:
            known["Q"] = draw("S_d") ** 2 / draw("R")
        if "F_d^2 = 1" in cases:
            known["A"] = self.rng.choice((1.0, -1.0)) + draw("S_d") * draw("C") / draw("R")
        if "W = ε^2" in cases:
            known |= {"W": draw("ε") ** 2, "V": 1.0}
        known["k"] = self.rng.choice((0, 1, 2, 3, 5, 8))

    def scalar(self, name: str) -> float:
        if name not in self.known:
            atom = self.real.atoms.get(name)
            if name in self.assigned:
                self.known[name] = self.assigned[name](self.scalar)
            elif name in self.real.sequences:
                self.known[name] = self.member(name, self.scalar("k"))
            elif name in self.real.following and atom is None:
                self.draw_parameters()
                (member,) = (m for m, s in self.real.sequences.items() if s.after == name)
                self.known[name] = self.next(member)
            elif atom is None:
                positive = name in ("V", "R", "W", "Q", "P0", "P1", "t", "ω") or name in POSITIVE
                self.known[name] = self.rng.uniform(0.1, 2) if positive else self.rng.uniform(-2, 2)
            elif atom.kind in ("integral", "improper"):
                self.known[name] = self.integral(atom)
            else:
                x = self.value(atom.of)
                if atom.kind == "reciprocal" and abs(x) < 1e-9:
                    raise Outside(name)
                self.known[name] = ATOMS[atom.kind](x)
        return self.known[name]

    def member(self, name: str, steps: int) -> float:
        """Go from the start step by step."""
        names = {n for n in self.real.reached({name}) if n in self.real.sequences}
        self.draw_parameters()
        fixed = {n: v for n, v in self.known.items() if not self.real.varies(n, "k")}
        current, known = {n: self.value(self.real.sequences[n].start) for n in names}, self.known
        for k in range(steps):
            self.known = {**fixed, **current, "k": k}
            current = {n: self.next(n) for n in names}
        self.known = known
        return current[name]

    def draw_parameters(self) -> None:
        """Draw once what the sequences depend on, not anew at every step."""
        used = {s for p in self.recursions.values() for s in scalars_of(p)} | {"P0", "ρ"}
        for name in sorted(self.real.reached(used)):
            if not self.real.varies(name, "k"):
                self.scalar(name)

    def next(self, member: str) -> float:
        """Return the next member: by its definition, or from the recursion, which is linear in it."""
        after = self.real.sequences[member].after
        if after in self.real.atoms:
            return self.value(self.real.atoms[after].of)
        known, ends = self.known, list[float]()
        for guess in (0.0, 1.0):
            self.known = {**known, after: guess}
            ends.append(self.value(self.recursions[after]))
        self.known = known
        return ends[0] / (ends[0] - ends[1])

    def integral(self, atom) -> float:
        """Integrate by Gauss and Legendre; an axis from 0 to infinity through ω = tan θ."""
        import numpy as np

        x, w = np.polynomial.legendre.leggauss(200)
        for parameter in "ACWV":
            self.scalar(parameter)  # drawn once, not anew at every node
        variable, upper = ("t", self.scalar("t")) if atom.kind == "integral" else ("ω", 1.0)
        dependent = [n for n in self.real.atoms if self.real.varies(n, variable)]
        kept, total = dict(self.known), 0.0
        for node, weight in zip((x + 1) / 2, w / 2, strict=True):
            self.known = {k: v for k, v in kept.items() if k not in dependent}
            if variable == "t":
                self.known["t"], scale = node * upper, upper
            else:
                scale = math.pi / 2 / math.cos(math.pi / 2 * node) ** 2
                self.known["ω"] = math.tan(math.pi / 2 * node)
            total += weight * scale * self.value(atom.of)
        self.known = kept
        return total

    def value(self, poly: Poly) -> float:
        return sum(float(c) * math.prod(map(self.scalar, m)) for (m, _), c in poly.terms.items())

    def scale(self, poly: Poly) -> float:
        return 1 + sum(abs(float(c)) * math.prod(abs(self.scalar(s)) for s in m) for (m, _), c in poly.terms.items())


def test_statements_hold_at_random_numbers(walked):
    steps, reading = walked
    item, tried, count = lecture("scalar"), set(), 0
    for seed in range(6):
        for name, (step, _, _) in steps.items():
            if step.rule in ("squeeze", "chain"):
                continue
            rests = item.rests_on(name) | set(step.uses)
            cases = {c for c in rests if getattr(item.theory.declared.get(c), "kind", "") == "hypothesis"}
            poly = value(step.statement.lhs, reading) - value(step.statement.rhs, reading)
            try:
                point = Point(seed, reading, cases)
                if not holds(item, cases, point, reading):
                    continue
                found, size = point.value(poly), point.scale(poly)
            except (Outside, ValueError, OverflowError):
                continue
            tried.add(name)
            count += 1
            if step.statement.relation == "=":
                loose = 1e-3 if any(s.startswith("integral of") for s in scalars_of(poly)) else 1e-5
                assert abs(found) <= loose * size, name
            else:
                assert found >= -1e-5 * size, name  # a double root has half of the digits
    assert count > 600
    assert len(tried) > 0.95 * len(steps)


def holds(item, cases, point, reading) -> bool:
    for case in cases:
        statement = item.theory.statement(case)
        x = point.value(value(statement.lhs, reading) - value(statement.rhs, reading))
        if not {"≥": x >= -1e-9, ">": x > 1e-9, "≠": x != 0, "=": abs(x) < 1e-9}[statement.relation]:
            return False
    return True


# ------------------------------------------------------------------------------------------------ must reject
def rejects(walked, name, **changes):
    step, reading, earlier = walked[0][name]
    check(step, reading, earlier)
    with pytest.raises(Rejected):
        check(replace(step, **changes), reading, earlier)


def test_wrong_formulas_are_rejected(walked):
    t = lecture("scalar").theory.symbols
    A, S, K, C, W, g, P, V = (t[k] for k in ("A", "S", "K", "C", "W", "g", "P", "V"))
    two = Number(Fraction(2))
    rejects(walked, "closed loop", statement=Equation(A - K * C, "=", S))  # the wrong root
    rejects(walked, "Riccati equation", statement=Equation(2 * A * P + W + g * Power(P, 2), "=", ZERO))
    rejects(walked, "Riccati equation", statement=Equation(A * P + W - g * Power(P, 2), "=", ZERO))
    rejects(walked, "integrator", statement=Equation(P, "=", two * walked[0]["integrator"][0].statement.rhs))
    rejects(walked, "no process noise", statement=Equation(P, "=", Quotient(V * Abs(A), Power(C, 2))))
    rejects(walked, "S + A >= 0", statement=Equation(-S - A, "≥", ZERO))
    rejects(walked, "P >= 0", statement=Equation(P, ">", ZERO))
    rejects(walked, "1/V > 0", statement=Equation(Neg(Quotient(Number(Fraction(1)), V)), ">", ZERO))


def test_wrong_analysis_is_rejected(walked):
    t = lecture("scalar").theory.symbols
    A, S, w = t["A"], t["S"], t["ω"]
    steps = walked[0]
    G = steps["antiderivative"][0].statement.lhs.body
    wrong = Rate(G + w, w)
    rejects(walked, "antiderivative", statement=Equation(wrong, "=", t["ℓ"]))
    rejects(walked, "antiderivative at infinity", statement=Equation(Limit(G, w, ZERO), "=", PI * S - PI * Abs(A)))
    rejects(walked, "antiderivative at zero", statement=Equation(Limit(G, w, Infinity()), "=", ZERO))
    half = Definite(t["ℓ"], w, ZERO, Infinity())
    rejects(walked, "root lemma", statement=Equation(half, "=", PI * Abs(A) - PI * S))
    rejects(walked, "root lemma", statement=Equation(half, "=", 2 * PI * S - 2 * PI * Abs(A)))
    whole = Definite(t["ℓ"], w, Neg(Infinity()), Infinity())
    rejects(walked, "root lemma", statement=Equation(whole, "=", PI * S - PI * Abs(A)))
    step = steps["root lemma"][0]
    a, b, c = step.proof.links
    rejects(walked, "root lemma", proof=replace(step.proof, links=(a, c, b)))
    first = Limit(w * t["ℓ"], w, Infinity())
    rejects(walked, "limit of the first term", statement=Equation(first, "=", S))
    rejects(walked, "limit of the first term", statement=Equation(Limit(w * t["ℓ"], w, ZERO), "=", ZERO))
    other = Log(Quotient(Power(w, 2) + Power(A, 2), Power(w, 2) + Power(S, 2)))
    rejects(walked, "logarithm", statement=Equation(steps["logarithm"][0].statement.lhs, "=", other))
    rejects(walked, "start", statement=Equation(Start(t["P0(t)"], t["t"]), "=", t["P1"]))
    rejects(walked, "decay", statement=Equation(steps["decay"][0].statement.lhs, "=", Number(Fraction(1)) - S * t["h"]))


def test_nothing_waits_in_vain(walked):
    """To try every declaration after every step takes up no more than to wait for what each needs."""
    item, steps = lecture("scalar"), list(walked[0].values())
    for _, reading, _ in steps[:: len(steps) // 25]:
        for declaration in (d for name, d in item.theory.declared.items() if name not in reading.adopted):
            with pytest.raises(MissingInverse):
                declare(reading, declaration)


def test_a_case_is_needed(walked):
    """Without the case, the step has no proof."""
    for name, case in (("|C| > 0", "C ≠ 0"), ("S is positive", "A ≠ 0"), ("limit of the decay", "S > 0")):
        step, reading, earlier = walked[0][name]
        facts = {k: f for k, f in reading.context.facts.items() if k != case}
        with pytest.raises(Rejected):
            check(step, replace(reading, context=replace(reading.context, facts=facts)), earlier)


def test_a_certificate_of_sign_is_believed_only_if_it_adds_up(walked):
    step, reading, earlier = walked[0]["S + A >= 0"]
    sign = step.proof.sign
    first, *others = sign.products
    for products in (
        tuple(others), (replace(first, coefficient=-first.coefficient), *others),
        (replace(first, coefficient=2 * first.coefficient), *others),
        (replace(first, facts=("no such fact",)), *others),
    ):  # fmt: skip
        with pytest.raises(Rejected):
            check(replace(step, proof=replace(step.proof, sign=replace(sign, products=products))), reading, earlier)
    with pytest.raises(Rejected, match="no product is positive"):
        check(replace(step, proof=replace(step.proof, sign=replace(sign, products=(), terms=()))), reading, earlier)


def test_the_hypotheses_of_each_step_can_hold_together(walked):
    """z3 finds a point for the cases that a step names, so that no step is true of nothing."""
    import z3

    item, reading = lecture("scalar"), walked[1]
    always = [
        n for n, d in item.theory.declared.items() if isinstance(d, Declared) and d.kind == "hypothesis" and not d.case
    ] + ["recursion"]
    sets = {frozenset(c for c in item.rests_on(n) if isinstance(d := item.theory.declared.get(c), Declared) and d.case)
            for n in walked[0]}  # fmt: skip
    for cases in sets:
        solver, seen = z3.Solver(), set()
        solver.set("timeout", 5000)

        def real(poly):
            return z3.Sum(
                [z3.Product([z3.RealVal(str(c)), *(z3.Real(s) for s in m)]) for (m, _), c in poly.terms.items()]
            )

        waiting = set()
        for name in (*always, *cases):
            e = item.theory.statement(name)
            poly = value(e.lhs, reading) - value(e.rhs, reading)
            x: Any = real(poly)
            waiting |= scalars_of(poly)
            solver.add({"≥": x >= 0, ">": x > 0, "≠": x != 0, "=": x == 0}[e.relation])
        while waiting:
            s = waiting.pop()
            seen.add(s)
            atom = reading.real.atoms.get(s)
            relation = atom and atom_relation(atom)
            if atom and relation is not None:
                solver.add(real(relation) == 0)
                waiting |= scalars_of(atom.of) - seen
                if atom.kind in ("root", "absolute", "part"):
                    solver.add(z3.Real(s) >= 0)
                if atom.kind == "part":
                    solver.add(z3.Real(s) >= real(atom.of))
        assert solver.check() == z3.sat, sorted(cases)


# ------------------------------------------------------------------------------------------------ files
def test_the_file_replays(tmp_path):
    path = tmp_path / "scalar.json"
    data = json.loads(json.dumps(lecture_to_json(lecture("scalar"))))
    path.write_text(json.dumps(data), encoding="utf-8")
    (report,) = verify_file(path)
    assert report.accepted
    assert report.authority == "kernel"
    step = next(s for s in data["steps"] if s["name"] == "corollary 2")
    step["certificates"][0]["terms"][0]["coefficient"] = "7"
    path.write_text(json.dumps(data), encoding="utf-8")
    (report,) = verify_file(path)
    rejected = [o.step for o in report.outcomes if not o.accepted]
    assert rejected == ["corollary 2", "unit corollary 2"]  # and what rests on it


def test_corollary_2_is_reached_by_named_steps_only():
    item = lecture("scalar")
    rests = item.rests_on("corollary 2")
    assert {"A ≠ 0", "C ≠ 0", "W >= 0", "V > 0"} <= rests
    assert "A = 0" not in rests
    assert "A = 0" in item.rests_on("corollary 2 of an integrator")
    assert all(a.because in (*item.theory.declared, *(s.name for s in item.steps), "", f"{'e^(-2St)'} > 0")
               for a in item.theory.declared.values() if isinstance(a, DeclaredAtom))  # fmt: skip
