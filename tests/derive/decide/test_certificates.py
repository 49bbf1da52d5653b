"""Certificates of claims replay from their LaTeX and the installed theory; nothing in them can be changed."""

from __future__ import annotations

import copy
import json
from collections.abc import Iterator
from typing import Any

import pytest

from derive.errors import InputError
from derive.replay import verify_data, verify_file
from tests.derive.decide.formulas import ORDER, SOURCES, TEXTBOOK
from tests.derive.decide.reading import DT, KB, certified

KINDS = {
    "identity": (r"L = A P C^T (C P C^T + R)^{-1}", DT, ()),
    "introduced by a formula": (r"(I - L_f C)^{-1} = I + P C^T R^{-1} C", DT, ()),
    "introduced by a lemma": (r"P^+ = (P^{-1} + C^T R^{-1} C)^{-1}", DT, (r"P \succ 0",)),
    "generic": (r"(s I - A) (s I - A)^{-1} = I", KB, ()),
    "several": (r"P^+ = P - L_f C P = (I - L_f C) P", DT, ()),
    "trace": (r"\operatorname{tr}(K C) = \operatorname{tr}(C P C^T V^{-1})", KB, ()),
    "positivity": (r"C P C^T + R \succ 0", DT, ()),
    "trace order": (r"\operatorname{tr}(P C^T R^{-1} C) \ge 0", DT, ()),
    "expectation": (r"\mathbb{E}[e_k e_{k-1}^T] = (A - L_k C) P_{k-1}", DT, ()),
    "gradient": (r"\frac{\partial \operatorname{tr} P_k}{\partial L_k} = 0", DT, ()),
}
OTHER = {DT: r"L = P C^T (C P C^T + R)^{-1}", KB: r"K = P C^T"}


def accepted(data: Any) -> bool:
    try:
        return verify_data(data, "file").accepted
    except (InputError, LookupError, TypeError, ArithmeticError):
        return False


@pytest.mark.parametrize(("latex", "theory", "assume"), SOURCES + TEXTBOOK + ORDER)
def test_certificates_replay(latex, theory, assume):
    data = json.loads(json.dumps(certified(latex, theory, assume)))
    assert data["schema"] == "derive-certificate/1"
    assert accepted(data)


def test_a_file_is_verified(tmp_path):
    data = certified(*KINDS["identity"])
    assert {"theory", "symbols", "relations", "claim", "terms", "trace"} <= set(data)
    path = tmp_path / "claim.json"
    path.write_text(json.dumps(data), encoding="utf-8")
    (report,) = verify_file(path)
    assert (report.accepted, report.theory, report.total) == (True, DT, 1)


def changed(data: Any) -> Iterator[tuple[str, Any]]:
    """Iterate over (place, copy of the data with one change): every key, the ends of every list, and all below."""
    if isinstance(data, dict):
        for key, value in data.items():
            yield key, {k: v for k, v in data.items() if k != key}
            yield key, {**data, key + "x": value}
            for place, other in changed(value):
                yield f"{key}.{place}", {**data, key: other}
    elif isinstance(data, list):
        for i in sorted({0, len(data) - 1} & set(range(len(data)))):
            value = data[i]
            yield str(i), data[:i] + data[i + 1 :]
            for place, other in changed(value):
                yield f"{i}.{place}", [*data[:i], other, *data[i + 1 :]]
        yield "more", [*data, data[0] if data else "A"]
    elif isinstance(data, bool):
        yield "", not data
    elif isinstance(data, str):
        yield "", {"0": "1", "1": "2", "-1": "1"}.get(data, data + "x")
    elif data is None:
        yield "", "A"
    elif isinstance(data, int):
        yield "", data + 1


@pytest.mark.parametrize("kind", KINDS)
def test_no_field_can_be_changed(kind):
    latex, theory, assume = KINDS[kind]
    data = certified(latex, theory, assume)
    assert accepted(data)
    spoiled = {**copy.deepcopy(data), "latex": OTHER[theory]}
    assert not accepted(spoiled)
    rest = {key: value for key, value in data.items() if key not in ("latex", "assume")}
    survived = [place for place, other in changed(rest) if accepted({**other, "latex": latex, "assume": list(assume)})]
    assert survived == []


def test_a_certificate_serves_no_other_claim():
    data = certified(*KINDS["identity"])
    assert not accepted({**data, "latex": r"L = A P C^T (C P C^T + 2 R)^{-1}"})
    assert not accepted({**data, "theory": KB})
    assert not accepted({**data, "scalar": True})


def test_what_an_assumption_proves_is_not_proved_without_it():
    data = certified(*KINDS["introduced by a lemma"])
    assert accepted(data)
    assert not accepted({**data, "assume": []})
    assert not accepted({**data, "assume": [r"Q \succ 0"]})


@pytest.mark.parametrize("key", ["latex", "assume", "scalar", "theory", "steps"])
def test_malformed_certificates_say_so(key):
    data = certified(*KINDS["identity"])
    for value in (None, 3, {"a": 1}, [1]):
        assert not accepted({**data, key: value})
