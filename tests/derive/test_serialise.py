"""Files of derivations: round trip, replay, and everything that must be rejected."""

import copy
import json
from dataclasses import replace
from types import SimpleNamespace

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from derive import functions, terms
from derive.context import Theory
from derive.document import document_from_json, lecture_to_json
from derive.errors import InputError
from derive.replay import taught, verify_data, verify_file
from derive.serialise import NODES, Reader, to_json
from derive.terms import Equation, Identity, Image, Product, Sum, Transpose
from derive.theory import LECTURES, lecture, theory

SLOW = settings(deadline=None, suppress_health_check=list(HealthCheck), derandomize=True)


@pytest.fixture(scope="module")
def observer():
    return lecture_to_json(lecture("observer"))


@pytest.fixture
def data(observer):
    """Return a copy that a test may spoil."""
    return copy.deepcopy(observer)


def step(data, name):
    """Return a step of the file by its name."""
    return next(s for s in data["steps"] if s["name"] == name)


def rejected(data):
    """Return the names of what the replay rejects, with the reasons."""
    return {o.step: o.message for o in verify_data(data, "file").outcomes if not o.accepted}


# ------------------------------------------------------------------------------------------------ true files
@pytest.mark.parametrize("key", LECTURES)
def test_every_lecture_round_trips_and_replays(key, tmp_path):
    original = lecture(key)
    path = tmp_path / f"{key}.json"
    path.write_text(json.dumps(lecture_to_json(original), ensure_ascii=False), encoding="utf-8")
    (report,) = verify_file(path)
    assert (report.accepted, report.authority) == (True, "kernel")
    assert report.proved == report.total == len(original.steps) > 0
    back = document_from_json(json.loads(path.read_text(encoding="utf-8")))
    assert [(s.statement, s.proof, s.rule, s.uses) for s in back.steps] == [
        (s.statement, s.proof, s.rule, s.uses) for s in original.steps
    ]


def test_every_kind_of_term_can_be_written():
    classes = (*vars(terms).values(), *vars(functions).values())
    kinds = {c for c in classes if isinstance(c, type) and issubclass(c, terms.Term)} - {terms.Term}
    assert set(NODES.values()) == kinds
    t = theory("observer-ct")
    s = t.symbols
    for term in (
        terms.Block(((s["A"], Identity("n")), (terms.Zero("n", "n"), s["A"].T))),
        terms.Integral(s["Phi"].at("t", "τ") * terms.Delta("t", "τ"), "τ"),
        terms.Gradient(terms.Trace(s["L"] * s["C"]), s["L"]),
        terms.Expect(terms.Dot(s["x"].at("t") * s["x"].T)),
        terms.Number(terms.Fraction(-3, 7)) * s["R_e"].inv,
    ):
        assert Reader(t).read(terms.Term, to_json(term, t), "term") == term


def test_each_certificate_of_a_lecture_is_a_file_of_its_own(observer, tmp_path):
    singles = [c for s in observer["steps"] for c in s["certificates"] if c["schema"] == "derive-certificate/1"]
    assert len(singles) > 20
    assert any("sigma2 written out" in c["relations"] or "xi is white" in c["relations"] for c in singles)
    path = tmp_path / "all.json"
    path.write_text(json.dumps(singles), encoding="utf-8")
    assert all(r.accepted and r.total == 1 for r in verify_file(path))


# ------------------------------------------------------------------------------------------------ must reject
def addends(data, name):
    """Return the addends of the first certificate of a step."""
    return step(data, name)["certificates"][0]["terms"]


def test_changed_coefficient(data):
    addends(data, "sigma2 written out")[0]["coefficient"] = "2"
    assert "do not make up" in rejected(data)["sigma2 written out"]


def test_changed_coefficient_in_the_claim(data):
    step(data, "sigma2 written out")["certificates"][0]["claim"]["terms"][0]["coefficient"] = "5/3"
    assert "another claim" in rejected(data)["sigma2 written out"]


def test_swapped_letters(data):
    addend = next(a for a in addends(data, "sigma2 written out") if len(a["right"]) > 1)
    addend["right"][0], addend["right"][1] = addend["right"][1], addend["right"][0]
    assert "ill-typed" in rejected(data)["sigma2 written out"]


def test_removed_term(data):
    addends(data, "sigma2 written out").pop()
    assert "sigma2 written out" in rejected(data)


def test_certificate_of_another_step(data):
    step(data, "completed square")["certificates"], other = [], step(data, "sigma2 written out")
    other["certificates"] = step(data, "stationary")["certificates"]
    assert {"completed square", "sigma2 written out"} <= set(rejected(data))


def test_renamed_relation(data):
    addend = addends(data, "sigma2 written out")[0]
    addend["relation"] += " "
    assert "undeclared relation" in rejected(data)["sigma2 written out"]


def test_list_of_relations_that_hides_one(data):
    step(data, "sigma2 written out")["certificates"][0]["relations"].pop()
    assert "certificates" in rejected(data)["sigma2 written out"]


def test_hypothesis_that_is_used_but_not_named(data):
    step(data, "square")["uses"] = []
    assert "uses R_e > 0 without naming it" in rejected(data)["square"]


def test_statement_edited_but_not_its_certificate(data):
    spoiled = step(data, "sigma2 written out")
    spoiled["statement"]["rhs"][1].pop()
    assert "another claim" in rejected(data)["sigma2 written out"]


def test_extra_step_that_claims_a_falsehood(data):
    false = copy.deepcopy(step(data, "stationary"))
    t = theory("observer-ct")
    false |= {"name": "false", "statement": to_json(Equation(t.symbols["P"], "=", t.symbols["W"]), t), "latex": "P = W"}
    data["steps"].append(false)
    assert set(rejected(data)) == {"false"}


def test_false_step_without_certificates(data):
    false = copy.deepcopy(step(data, "stationary"))
    false |= {"name": "false", "certificates": []}
    data["steps"].append(false)
    assert set(rejected(data)) == {"false"}


def test_wrong_latex(data):
    step(data, "sigma2 written out")["latex"] += " + 1"
    assert "another latex" in rejected(data)["sigma2 written out"]


def test_lemma_used_before_it_is_proved(data):
    order = [s["name"] for s in data["steps"]]
    square, optimal = order.index("square"), order.index("optimal gain")
    data["steps"][square], data["steps"][optimal] = data["steps"][optimal], data["steps"][square]
    assert "optimal gain" in rejected(data)


def test_name_used_twice(data):
    data["steps"].append(copy.deepcopy(data["steps"][0]))
    assert "is taken" in rejected(data)[data["steps"][0]["name"]]


def test_chain_with_a_missing_link(data):
    chain = step(data, "error dynamics")
    chain["certificates"][0]["links"].pop(1)
    assert "do not meet" in rejected(data)["error dynamics"]


def test_erratum_with_another_true_form(data):
    erratum = next(e for e in data["errata"] if e["true"])
    t = theory("observer-ct")
    erratum["true"] = to_json(Equation(t.symbols["P"], "=", t.symbols["W"]), t)
    assert any("neither declared nor proved" in m for m in rejected(data).values())


def test_erratum_that_names_a_step_which_is_not_there(data):
    next(e for e in data["errata"] if e["proved_by"])["proved_by"] = "elsewhere"
    assert "the step elsewhere is not proved in this file" in rejected(data).values()


@pytest.mark.parametrize(
    ("key", "spoil"),
    [
        ("given", lambda data: data["given"][0].update(latex="x = 0")),
        ("errata", lambda data: next(e for e in data["errata"] if e["true"]).update(true_latex="x = 0")),
        ("symbols", lambda data: data["symbols"].pop()),
    ],
)
def test_what_surrounds_the_steps_is_shown_as_it_is(data, key, spoil):
    spoil(data)
    assert rejected(data) == {key: f"the file shows other {key} than its own"}


def test_definition_that_the_theory_does_not_make(data):
    data["given"][0]["statement"]["rhs"] = "x"
    with pytest.raises(InputError, match="not what the theory observer-ct declares"):
        verify_data(data, "file")


def test_single_certificate_with_a_changed_coefficient(data):
    single = step(data, "sigma2 written out")["certificates"][0]
    assert verify_data(single, "file").accepted
    single["terms"][0]["coefficient"] = "-7"
    assert not verify_data(single, "file").accepted


def test_a_lemma_of_a_lecture_serves_only_when_it_replays(monkeypatch):
    original = lecture("observer")
    lemma = original.step("sigma2 written out")
    false = replace(lemma, name="false", statement=replace(lemma.statement, rhs=theory("observer-ct").symbols["W"]))
    steps = [s for s in original.steps if s.name != lemma.name] + [false, lemma]
    other = SimpleNamespace(theory=original.theory, steps=steps)
    monkeypatch.setattr("derive.theory.lecture", lambda key: other if key == "observer" else lecture(key))
    known = taught(original.theory).context.relations
    assert lemma.name in known
    assert "false" not in known


# ------------------------------------------------------------------------------------------------ malformed
@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", "expected JSON"),
        ("nonsense", "expected JSON"),
        ("[]", "expected an object"),
        ("[" * 100_000, "nested too deeply"),
        ('{"schema": NaN}', "NaN is not a number"),
        ('{"schema": "x", "schema": "y"}', "given twice"),
        ('{"schema": "derive-derivation/2"}', "expected derive-derivation/1"),
        ('{"schema": "derive-certificate/1", "theory": "alchemy"}', "alchemy"),
    ],
)
def test_malformed_file_gives_one_line(text, message, tmp_path):
    path = tmp_path / "file.json"
    path.write_text(text, encoding="utf-8")
    with pytest.raises(InputError, match=message) as caught:
        verify_file(path)
    assert "\n" not in str(caught.value)
    assert str(caught.value).startswith(str(path))


def test_a_file_of_too_many_values(observer, tmp_path, monkeypatch):
    path = tmp_path / "file.json"
    path.write_text(json.dumps(observer), encoding="utf-8")
    monkeypatch.setattr("derive.replay.MARKS", 1000)
    with pytest.raises(InputError, match="at most 1000 values"):
        verify_file(path)
    monkeypatch.setattr("derive.replay.LIMIT", 2**20 // 16)
    with pytest.raises(InputError, match="MB, got more"):
        verify_file(path)


def test_missing_file_folder_and_other_bytes(tmp_path):
    (tmp_path / "latin.json").write_bytes(b"\xff\xfe\x00")
    for path, message in (
        (tmp_path / "none.json", "cannot be read"),
        (tmp_path, "cannot be read"),
        (tmp_path / "latin.json", "UTF-8"),
    ):
        with pytest.raises(InputError, match=message):
            verify_file(path)


@pytest.mark.parametrize("pair", [["A"], ["A", "1", "2"], "A", [1, 2]])
def test_evidence_that_is_no_pair(data, pair):
    next(e for e in data["errata"] if e["evidence"])["evidence"][0]["values"].append(pair)
    with pytest.raises(InputError, match="values: "):
        verify_data(data, "file")


def test_names_the_theory_does_not_know(data):
    for spoil in (
        lambda s: s["statement"].update(lhs="Z"),
        lambda s: s["statement"].update(lhs="A@t,'"),
        lambda s: s["statement"].update(lhs=["Image", "mirror", "A"]),
        lambda s: s["statement"].update(lhs=["Identity", "q"]),
        lambda s: s["certificates"][0]["terms"][0].update(left=["A''"]),
        lambda s: s["certificates"][0]["terms"][0].update(left=["A@"]),
        lambda s: s["certificates"][0]["terms"][0].update(left=["P'"]),
        lambda s: s["certificates"][0]["terms"][0].update(scalars=[""]),
        lambda s: s["certificates"][0]["terms"][0].update(scalars=["δ(t)"]),
        lambda s: s["statement"].update(lhs=["Sum", []]),
        lambda s: s["certificates"][0].update(theory="kalman-bucy"),
        lambda s: s["certificates"][0]["claim"]["terms"].append(s["certificates"][0]["claim"]["terms"][0]),
        lambda s: s["certificates"][0]["claim"]["terms"][0].update(scalars=["∫τ", "δ(t,τ)", "∫σ"]),
        lambda s: s["certificates"].extend([CHAIN, CHAIN]),
        lambda s: s.update(rule="magic"),
        lambda s: s.update(lemma=1),
        lambda s: s["certificates"].append({"schema": "derive-chain/1", "theory": "observer-ct", "links": [3]}),
    ):
        spoiled = copy.deepcopy(data)
        spoil(step(spoiled, "sigma2 written out"))
        with pytest.raises(InputError, match="step 'sigma2 written out'"):
            verify_data(spoiled, "file")


def test_statement_that_explodes_or_nests_without_end(data):
    t = theory("observer-ct")
    A = t.symbols["A"]
    spoiled = step(data, "sigma2 written out")["statement"]
    spoiled["lhs"] = to_json(Product((Sum((A, A)),) * 40), t)
    with pytest.raises(InputError, match="at most 2000 products"):
        verify_data(data, "file")
    deep = A
    for _ in range(100):
        deep = Transpose(deep)
    spoiled["lhs"] = to_json(deep, t)
    with pytest.raises(InputError, match="levels of nesting"):
        verify_data(data, "file")


def test_image_that_explodes():
    t = Theory("wide", "A map that doubles")
    A, B = t.matrix("A", "n", "n"), t.matrix("B", "n", "n")
    t.maps["double"] = {"A": Sum((A, B))}
    reader = Reader(t)
    small, large = (Equation(Image("double", Product((A,) * power)), "=", A) for power in (5, 40))
    assert reader.equation(to_json(small, t)) == small
    with pytest.raises(InputError, match="at most 2000 products"):
        reader.equation(to_json(large, t))


CHAIN = {"schema": "derive-chain/1", "theory": "observer-ct", "links": ["a"], "symbols": [], "relations": ["a"]}
JSON = st.recursive(
    st.none() | st.booleans() | st.integers(-3, 3) | st.floats(allow_nan=False) | st.text(max_size=6)
    | st.sampled_from(["A", "A'", "P", "x@t", "Sum", "Neg", "Product", "∫τ", "δ(t,τ)", "1/2", "=", "⪰", "n", "1"]),
    lambda inner: st.lists(inner, max_size=4) | st.dictionaries(st.text(max_size=4), inner, max_size=3),
    max_leaves=8,
)  # fmt: skip


def places(data, path=()):
    """Return the path to every value in JSON data."""
    yield path
    if isinstance(data, (list, dict)):
        for key in data if isinstance(data, dict) else range(len(data)):
            yield from places(data[key], (*path, key))


@settings(SLOW, max_examples=100)
@given(st.integers(0, 10**6), st.sampled_from(["replace", "delete", "double"]), JSON)
def test_fuzzed_files_are_reported_or_refused(observer, place, edit, value):
    small = {**observer, "steps": observer["steps"][:9] + observer["steps"][-8:], "errata": observer["errata"][:1]}
    spoiled = copy.deepcopy(small)
    choices = list(places(small))[1:]
    *path, last = choices[place % len(choices)]
    where = spoiled
    for key in path:
        where = where[key]
    if edit == "replace":
        where[last] = value
    elif edit == "delete":
        del where[last]
    elif isinstance(where, list):
        where.insert(last, where[last])
    try:
        report = verify_data(spoiled, "file")
    except InputError as error:
        message = str(error)
    else:
        message = "; ".join(o.message for o in report.outcomes)
        assert report.total == len(spoiled["steps"])
    assert "\n" not in message


@settings(SLOW, max_examples=200)
@given(JSON)
def test_arbitrary_terms_are_read_or_refused(data):
    reader = Reader(theory("observer-ct"))
    try:
        statement = reader.equation({"lhs": data, "relation": "=", "rhs": "A"})
    except InputError:
        return
    assert to_json(statement, reader.theory)["lhs"] == data


# ------------------------------------------------------------------------------------------------ bounded work
def test_word_that_is_too_long(data):
    long = {
        "coefficient": "1",
        "scalars": [],
        "left": ["R_e"] * 401,
        "relation": "R_e",
        "transposed": False,
        "right": [],
    }
    step(data, "square")["certificates"][0]["terms"] = [[[long]]]
    with pytest.raises(InputError, match="at most 400 letters"):
        verify_data(data, "file")


@pytest.mark.parametrize(("longest", "squares", "fits"), [(60, 1, True), (60, 8, False), (390, 1, False)])
def test_squares_that_expand_without_end(data, longest, squares, fits):
    certificate = step(data, "square")["certificates"][0]
    terms_ = [{"coefficient": "1", "scalars": [], "word": ["A"] * k + ["L@t"]} for k in range(longest)]
    certificate["squares"][0]["factor"] = [[{"rows": "n", "cols": "l", "terms": terms_}]]
    certificate["squares"] *= squares
    if fits:
        assert "square" in rejected(data)
    else:
        with pytest.raises(InputError, match="at most 1000000 letters"):
            verify_data(data, "file")


def test_product_of_too_many_numbers(data):
    step(data, "square")["statement"]["lhs"] = ["Product", [["Number", "1/3"]] * 401 + ["A"]]
    with pytest.raises(InputError, match="at most 400 factors"):
        verify_data(data, "file")


@pytest.mark.parametrize("symbol", ["s@t", "A@t", "W@τ"])
def test_a_symbol_that_does_not_vary_takes_no_time(symbol):
    with pytest.raises(InputError, match="does not depend on time"):
        Reader(theory("kalman-bucy")).read(terms.Term, symbol, "term")


@pytest.mark.parametrize("time", ["s", "A", "t_0", "t-0"])
def test_a_time_prints_as_a_variable_of_its_own(time):
    with pytest.raises(InputError, match="expected a time"):
        Reader(theory("kalman-bucy")).read(terms.Term, ["Integral", "A", time], "term")


@pytest.mark.parametrize("text", ["a\nderive: 9 of 9 proved", "\x1b[2J", "\u202eP"])
@pytest.mark.parametrize("key", ["name", "reason"])
def test_text_that_takes_over_the_terminal(data, key, text):
    data["steps"][0][key] = text
    with pytest.raises(InputError, match="without control characters"):
        verify_data(data, "file")
