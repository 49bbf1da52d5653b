"""Proof and replay times of the theorem table, and what becomes of its mutants."""

from __future__ import annotations

import time

from derive.kernel import Certificate, Poly, Rejected, replay
from derive.matrix import prove, refute
from tests.benchmark.table import Row, best_of
from tests.reference.mutants import mutants
from tests.reference.theorems import Theorem, theorems

PROOF, REPLAY = 0.050, 0.005  # seconds a theorem
RUNS = 10


def prover() -> list[Row]:
    """Return the times of every theorem, then the counts of refuted claims and mutants."""
    table = theorems()
    rows = [row for t in table for row in (_proved(t) if t.true and t.provable else _not_proved(t))]
    return rows + _mutants(table)


def search(theorem: Theorem, seconds: float = 5.0) -> Certificate | None:
    """Run the prover on a theorem."""
    problem = theorem.hypotheses
    return prove(theorem.claim, problem.relations, problem.alphabet, trace=theorem.trace, seconds=seconds)


def replays(certificate: Certificate, theorem: Theorem) -> bool:
    """Tell whether the kernel accepts a certificate."""
    try:
        replay(certificate, theorem.claim, theorem.hypotheses.relations, theorem.hypotheses.alphabet)
    except Rejected:
        return False
    return True


def _proved(theorem: Theorem) -> list[Row]:
    found, certificate = best_of(RUNS, lambda: search(theorem))
    if certificate is None:
        return [Row(theorem.name, "no proof", "proved", ok=False)]
    checked, accepted = best_of(RUNS, lambda: replays(certificate, theorem))
    value = f"proof {1e3 * found:.1f} ms, replay {1e3 * checked:.1f} ms, {len(certificate.terms)} addends"
    target = f"{1e3 * PROOF:.0f} ms, {1e3 * REPLAY:.0f} ms"
    return [Row(theorem.name, value, target, accepted and found <= PROOF and checked <= REPLAY)]


def _not_proved(theorem: Theorem) -> list[Row]:
    if theorem.true:
        return [Row(theorem.name, "proved" if search(theorem) else "not proved", "not proved", search(theorem) is None)]
    seconds, refuted = best_of(RUNS, lambda: _refute(theorem))
    value = f"refuted, {1e3 * seconds:.1f} ms" if refuted else "not refuted"
    return [Row(theorem.name, value, "refuted, not proved", refuted and search(theorem, seconds=1) is None)]


def _refute(theorem: Theorem) -> bool:
    zero = Poly({}, theorem.claim.rows, theorem.claim.cols)
    return refute(theorem.claim, zero, theorem.hypotheses, trace=theorem.trace) is not None


def _mutants(table: list[Theorem]) -> list[Row]:
    all_ = mutants(table)
    start = time.perf_counter()
    refuted = sum(map(_refute, all_))
    seconds = time.perf_counter() - start
    proved = sum(search(t, seconds=0.1) is not None for t in all_)
    return [
        Row(
            "mutants refuted",
            f"{refuted} of {len(all_)}, {1e3 * seconds / len(all_):.1f} ms each",
            "all",
            refuted == len(all_),
        ),
        Row("mutants proved", str(proved), "0", proved == 0),
    ]
