"""Runs of the checker: what becomes of verdicts, in which order, and with which exit code."""

import json
from fractions import Fraction

import pytest

import derive
from derive.check import Report, Result, check
from derive.check.certificates import write_certificates
from derive.check.guessing import justified
from derive.check.item import Item, Setting
from derive.check.pool import Worker, judge_side_by_side
from derive.check.text import complaints
from derive.claim import Answer, Claim, Counterexample, Nearest, Verdict
from derive.errors import InputError
from derive.replay import verify_file

ONE = ((Fraction(1),),)
EXAMPLE = Counterexample({}, {"A": ((Fraction(2),),)}, ONE, ((Fraction(3),),))
WORD = {"P": Verdict.proved, "Q": Verdict.refuted, "R": Verdict.supported, "A": Verdict.undecided}


def by_letter(statement, *, seconds):
    """Decide a statement by its first letter, to see what becomes of each verdict."""
    verdict = WORD[statement.symbols[0].name]
    if verdict is Verdict.refuted:
        return Answer(verdict, "exact instance", counterexample=EXAMPLE, nearest=Nearest("P = P", "a letter"))
    return Answer(verdict, "kernel", ("used",), ("unused",), notes=("a note",))


def run(*claims, **options):
    return check(claims, **{"theory": "luenberger-dt", "decide": by_letter, **options})


# ------------------------------------------------------------------------------------------------ verdicts
@pytest.mark.parametrize(
    ("claims", "code"),
    [
        (("P = P",), 0),
        (("P = P", "R = R"), 3),
        (("P = P", "A = A"), 3),
        (("R = R", "Q = Q", "A = A"), 1),
        (("Q = Q", "P =", "A = A"), 2),
        (("P = P", "none.md"), 2),
        ((), 0),
    ],
)
def test_exit_codes(claims, code):
    assert run(*claims).exit_code == code


def test_results_come_in_the_order_of_the_claims():
    report = run("A = A", "P = P", "Q =", "R = R", "Q = Q")
    assert [r.verdict for r in report.results] == ["undecided", "proved", "error", "supported", "refuted"]
    assert [r.claim.id for r in report.results] == ["u1", "u2", "u3", "u4", "u5"]
    assert report.counts == {"proved": 1, "refuted": 1, "supported": 1, "undecided": 1, "error": 1}


def test_claims_as_objects_and_paths(tmp_path):
    path = tmp_path / "n.md"
    path.write_text("$$P = P$$", encoding="utf-8")
    claim = Claim("Q = Q", "lqr-dt", ("R = I",), id="mine")
    report = run(path, claim, assume=["A = I"])
    assert [r.claim.id for r in report.results] == ["u1", "mine"]
    assert report.results[1].claim.theory == "lqr-dt"
    assert report.results[1].claim.assume == ("A = I", "R = I")


def test_a_shape_that_does_not_fit_is_refuted_by_its_type():
    (result,) = run("P = A C").results
    assert (result.verdict, result.answer.method) == ("refuted", "types")


def test_a_display_that_relates_nothing_is_a_claim_only_if_somebody_says_so(tmp_path):
    path = tmp_path / "n.md"
    path.write_text("$$P$$\n\n$$P = P$$\n\n$$P + Q$$ <!-- derive: claim -->", encoding="utf-8")
    assert [(r.claim.latex, r.verdict) for r in run(path).results] == [("P = P", "proved"), ("P + Q", "error")]


def test_errors_stand_under_their_column():
    (result,) = run("P = (A").results
    assert result.verdict == "error"
    assert result.message.startswith("column 7: expected ")
    line, caret = result.excerpt.split("\n")
    assert (line, caret.index("^")) == ("P = (A", 6)


def test_an_error_of_a_display_is_told_in_its_own_line(tmp_path):
    path = tmp_path / "n.md"
    path.write_text("text\n$$\nP\n= (A\n$$", encoding="utf-8")
    (result,) = run(path).results
    assert result.claim.line == 4


def test_a_given_that_cannot_be_read_stops_what_rests_on_it(tmp_path):
    path = tmp_path / "n.md"
    path.write_text("$$P = P$$\n<!-- derive: given -->\n$$Q = (A$$\n\n$$P = P$$", encoding="utf-8")
    one, two = run(path).results
    assert (one.verdict, two.verdict) == ("proved", "error")
    assert "(line 3)" in two.message


def test_unknown_theories_and_assumptions_are_told_at_once():
    with pytest.raises(InputError, match=r"theory: expected observer-ct, .*got 'x'"):
        run("P = P", theory="x")
    with pytest.raises(InputError, match=r"assume '\(': column"):
        run("P = P", assume=["("])


def test_a_decision_that_fails_leaves_the_claim_undecided():
    def failing(statement, *, seconds):
        raise ZeroDivisionError("inside")

    (result,) = run("P = P", decide=failing).results
    assert result.verdict == "undecided"
    assert "ZeroDivisionError: inside" in result.answer.notes[0]


def test_contradictory_assumptions_are_an_error():
    def contradictory(statement, *, seconds):
        raise InputError("assume: contradict each other")

    (result,) = run("P = P", decide=contradictory).results
    assert (result.verdict, result.message) == ("error", "assume: contradict each other")


def test_progress_counts_to_the_end():
    told = []
    run("P = P", "P = P", "P =", progress=lambda done, of: told.append((done, of)))
    assert told == [(1, 2), (2, 2)]


# ------------------------------------------------------------------------------------------------ guesses
def result(latex, verdict, letters, used=(), guessed="letters", file="n.md"):
    answer = Answer(Verdict(verdict), "kernel", used, counterexample=EXAMPLE if verdict == "refuted" else None)
    return Result(Claim(latex, "luenberger-dt", file=file), verdict, answer, "", dict.fromkeys(letters, "n×n"), guessed)


def test_a_refutation_on_a_mere_guess_is_none():
    (found,) = justified([result("x", "refuted", ["L", "P"])])
    assert (found.verdict, found.answer.counterexample) == ("undecided", None)
    assert "would be refuted: A = 2: left 1, right 3" in found.answer.notes[0]
    assert "--theory luenberger-dt" in found.answer.notes[1]


@pytest.mark.parametrize(
    ("proved", "verdict"),
    [
        ([result("y", "proved", ["L_k", r"P_{k-1}", "A"], ("gain",))], "refuted"),
        ([result("y", "proved", ["L_k", "A"], ("gain",))], "undecided"),  # P is not confirmed
        ([result("y", "proved", ["L_k", "P"])], "undecided"),  # an identity of any theory
        ([result("y", "proved", ["L_k", "P"], ("gain",), file="other.md")], "undecided"),
        ([result("y", "proved", [r"\hat{L}_k", "P"], ("gain",)), result("z", "refuted", ["L"])], "undecided"),
    ],
)
def test_what_confirms_a_guess(proved, verdict):
    assert justified([*proved, result("x", "refuted", ["L", "P"])])[-1].verdict == verdict


def test_shapes_that_do_not_fit_a_guess_refute_nothing():
    told = Answer(Verdict.refuted, "types", notes=("shapes: C is l×n",))
    misfit = Result(Claim("x", "luenberger-dt", file="n.md"), "refuted", told, guessed="letters")
    found = justified([result("y", "proved", ["L", "P"], ("gain",)), misfit])[-1]
    assert found.verdict == "undecided"
    assert "would be refuted: shapes: C is l×n" in found.answer.notes[0]


def test_a_guess_is_told_once_for_each_file():
    results = [result("x", "proved", ["L"]), result("y", "proved", ["L"]), result("z", "proved", ["L"], file="o.md")]
    assert str(Report(tuple(results))).count("guessed  letters") == 2


def test_a_named_theory_needs_no_confirmation():
    (found,) = justified([result("x", "refuted", ["L"], guessed="")])
    assert found.verdict == "refuted"


def test_a_guess_is_said_and_a_theory_that_is_not_clear_is_asked_for():
    known, unclear = run("L = A P C^T (C P C^T + R)^{-1}", "P = P", theory="", decide=proving).results
    assert (known.claim.theory, known.verdict) == ("luenberger-dt", "proved")
    assert "in this theory alone" in known.guessed
    assert (unclear.verdict, unclear.claim.theory) == ("undecided", "")
    assert "--theory" in unclear.answer.notes[0]


def proving(statement, *, seconds):
    return Answer(Verdict.proved)


# ------------------------------------------------------------------------------------------------ reports
def test_the_text_says_what_was_understood():
    text = str(run("P = P", "Q = Q", "P = (A"))
    assert (
        text
        == r"""u1 proved (kernel), luenberger-dt
    read as  P = P
    shapes   P: n×n
    uses     used
    not used unused
    note     a note

u2 refuted (exact instance), luenberger-dt
    read as  Q = Q
    shapes   Q: n×n
    at       A = 2: left 1, right 3
    nearest  P = P (a letter; proved)

u3 error: column 7: expected an operator or the ) to the ( in column 5, got the end of the formula
    P = (A
          ^

3 claims: 1 proved, 1 refuted, 1 error"""
    )


KEYS = [
    "id", "file", "line", "latex", "read_as", "theory", "verdict", "method", "hypotheses_used", "hypotheses_not_needed",
    "counterexample", "nearest", "certificate", "seconds",
]  # fmt: skip


def test_the_json_has_one_entry_a_claim(tmp_path):
    path = tmp_path / "n.md"
    path.write_text("$$P = P$$\n\n$$Q = Q$$ (7)\n\n$$P = ($$", encoding="utf-8")
    data = json.loads(json.dumps(run(path).to_json()))
    assert list(data) == ["schema", "claims"]
    assert data["schema"] == "derive-check/1"
    assert [list(c)[:14] for c in data["claims"]] == [KEYS] * 3
    one, two, three = data["claims"]
    assert (one["line"], one["verdict"], one["hypotheses_used"], one["certificate"]) == (1, "proved", ["used"], None)
    assert (two["id"], two["nearest"]) == ("7", {"latex": "P = P", "edit": "a letter"})
    assert two["counterexample"]["values"] == {"A": [["2"]]}
    assert (three["verdict"], three["line"], three["message"][:6]) == ("error", 5, "column")
    assert list(run("P = P").to_json()["claims"][0]) == [*KEYS, "notes"]


def test_the_sarif_log_has_the_required_structure(tmp_path):
    path = tmp_path / "a note.md"
    path.write_text("$$P = P$$\n\n$$Q = Q$$\n\n$$R = R$$\n\n$$A = A$$\n\n$$P = ($$", encoding="utf-8")
    log = json.loads(json.dumps(run(path, "none.md").to_sarif()))
    assert (log["version"], "sarif-schema-2.1.0" in log["$schema"]) == ("2.1.0", True)
    (only,) = log["runs"]
    rules = [rule["id"] for rule in only["tool"]["driver"]["rules"]]
    assert [(r["ruleId"], r["level"]) for r in only["results"]] == [
        ("refuted", "error"), ("supported", "note"), ("undecided", "warning"), ("error", "error"),
    ]  # fmt: skip
    for found, line in zip(only["results"], (3, 5, 7, 9), strict=True):
        place = found["locations"][0]["physicalLocation"]
        assert rules[found["ruleIndex"]] == found["ruleId"]
        assert place["artifactLocation"]["uri"].endswith("a%20note.md")
        assert place["region"]["startLine"] == line
        assert found["message"]["text"]
    assert not only["invocations"][0]["executionSuccessful"]
    assert "none.md" in only["invocations"][0]["toolExecutionNotifications"][0]["message"]["text"]


def test_errors_are_one_line_each():
    report = run("P =", "P = (", "none.md")
    files, claims = complaints(report)
    assert files.startswith("none.md: cannot be read")
    assert claims.endswith("(and 1 more)")
    assert "\n" not in files + claims


# ------------------------------------------------------------------------------------------------ certificates
def test_certificates_are_files_that_verify_replays(tmp_path):
    claims = ["L = A P C^T (C P C^T + R)^{-1}", "P = Q", "P = P^T"]
    report = check(claims, theory="luenberger-dt")
    assert [r.verdict for r in report.results] == ["proved", "refuted", "proved"]
    paths = write_certificates(report, tmp_path / "certificates")
    assert [p.name for p in paths] == ["001-u1.json", "003-u3.json"]
    assert all(found.accepted for path in paths for found in verify_file(path))
    assert sorted((tmp_path / "certificates").iterdir()) == paths


def test_a_certificate_of_a_claim_with_macros_is_replayed_without_them(tmp_path):
    path = tmp_path / "n.md"
    path.write_text("\\newcommand{\\T}{^{\\top}}\n$$F = A S C\\T (C S C\\T + R)^{-1}$$", encoding="utf-8")
    head = "---\nderive:\n  theory: luenberger-dt\n  notation:\n    F: L\n    S: P\n---\n"
    path.write_text(head + path.read_text(encoding="utf-8"), encoding="utf-8")
    report = check(path)
    assert report.exit_code == 0, str(report)
    (certificate,) = write_certificates(report, tmp_path / "certificates")
    assert "\\T" not in certificate.read_text(encoding="utf-8").replace("\\Top", "")
    assert all(found.accepted for found in verify_file(certificate))


def test_a_certificate_says_what_the_letters_mean_in_the_theory(tmp_path):
    path = tmp_path / "n.md"
    head = "---\nderive:\n  theory: luenberger-dt\n  notation:\n    P: Q\n    Q: P\n---\n"
    path.write_text(f"{head}$$Q = P + A Q A^T - A Q C^T (C Q C^T + R)^{{-1}} C Q A^T$$", encoding="utf-8")
    report = check(path)
    assert report.exit_code == 0, str(report)
    (certificate,) = write_certificates(report, tmp_path / "certificates")
    assert "P = Q + A P" in certificate.read_text(encoding="utf-8")
    assert all(found.accepted for found in verify_file(certificate))


# ------------------------------------------------------------------------------------------------ processes
def test_two_processes_say_what_one_says():
    claims = ["L = A P C^T (C P C^T + R)^{-1}", "L = P C^T (C P C^T + R)^{-1}", "P = P", "P = (", "A = C"]
    reports = [check(claims, theory="luenberger-dt", jobs=jobs) for jobs in (0, 1, 2)]
    texts = [json.dumps(without_seconds(r.to_json())) for r in reports]
    assert texts[0] == texts[1] == texts[2]
    assert [r.verdict for r in reports[0].results] == ["proved", "refuted", "proved", "error", "refuted"]


def without_seconds(data):
    return {**data, "claims": [{k: v for k, v in c.items() if k != "seconds"} for c in data["claims"]]}


def item(latex):
    return Item(Claim(latex, "luenberger-dt"), Setting("luenberger-dt"), True)


def test_a_claim_that_takes_too_long_is_given_up_and_the_next_is_judged():
    worker = Worker(10.0)
    try:
        worker.seconds = 0.0  # less than any decision takes
        late = worker.judge(item("L = A P C^T (C P C^T + R)^{-1}"))
        worker.seconds = 60.0
        next_ = worker.judge(item("P = P"))
    finally:
        worker.close(for_good=True)
    assert (late.verdict, late.answer.notes) == ("undecided", ("not decided within 0 s; --timeout gives more",))
    assert next_.verdict == "proved"


def test_a_process_that_ends_is_replaced():
    worker = Worker(60.0)
    try:
        worker.process.kill()
        worker.process.wait()
        first = worker.judge(item("P = P"))
        worker._again()
        second = worker.judge(item("P = P"))
    finally:
        worker.close(for_good=True)
    assert (first.verdict, second.verdict) == ("undecided", "proved")


def test_an_interruption_ends_all_processes():
    workers = []

    def interrupt(done, of):
        raise KeyboardInterrupt

    original = Worker._start

    def start(self):
        process = original(self)
        workers.append(process)
        return process

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(Worker, "_start", start)
        with pytest.raises(KeyboardInterrupt):
            judge_side_by_side([item("P = P")] * 5, 60.0, 2, interrupt)
    assert workers
    assert all(process.poll() is not None for process in workers)


# ------------------------------------------------------------------------------------------------ Python
def test_the_module_can_be_called():
    report = derive.check("P = P^T", theory="luenberger-dt")
    assert isinstance(report, Report)
    assert derive.check.check is check
    assert str(report).endswith("1 claim: 1 proved")
