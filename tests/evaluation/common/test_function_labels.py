"""Classifications beside labels."""

import json

import pytest

from evaluation.common.function_labels import Label, main, read_labels, score
from rtron.functions.classifier.result import Classification, DecisionSource
from rtron.vocabulary import FunctionType as T


def label(repo, primary, functions=(), accepted=()):
    return Label(
        repo=repo,
        primary=frozenset(primary),
        functions=frozenset(functions),
        accepted=frozenset(accepted),
    )


def found(repo, *functions, decided_by=DecisionSource.NAME):
    return Classification(
        repo=repo, functions=functions, primary=functions[0], decided_by=decided_by
    )


LABELS = [
    label("right", [T.MOBILE], [T.MOBILE, T.TELEOPERATION]),
    label("either", [T.SENSORS, T.SUPPORT], [T.SENSORS], [T.SUPPORT]),
    label("wrong", [T.MAPPING], [T.MAPPING]),
    label("unknown", [T.RECOGNITION], [T.RECOGNITION]),
    label("other", [T.EXTENSION], [T.EXTENSION]),
    label("absent", [T.SPEAKER], [T.SPEAKER]),
]
FOUND = {
    each.repo: each
    for each in (
        found("right", T.MOBILE),
        found("either", T.SUPPORT),
        found("wrong", T.SENSORS),
        found("unknown", T.EXTENSION, decided_by=DecisionSource.NONE),
        found("other", T.EXTENSION, decided_by=DecisionSource.NONE),
    )
}


def test_the_score():
    whole = score(LABELS, FOUND)
    assert len(whole.pairs) == 5
    assert whole.automation == pytest.approx(2 / 3)
    assert whole.precision == pytest.approx(2 / 3)
    assert whole.decided == pytest.approx(3 / 5)
    assert whole.accuracy == pytest.approx(3 / 5)
    assert whole.agreement == pytest.approx((1 + 0.5 + 1) / 5)
    assert whole.f1 == pytest.approx(2 * 2 / (2 * 2 + 2 + 4))


def test_the_faults():
    assert list(score(LABELS, FOUND).differences()) == [
        "PART  right: Mobile (Mobile), extra none, missed Teleoperation",
        "PART  either: Support (Sensors/Support), extra none, missed Sensors",
        "WRONG wrong: Sensors (Mapping), extra Sensors, missed Mapping",
        "WRONG unknown: Extension (Recognition), extra Extension, missed Recognition",
    ]


def test_nothing_has_no_share():
    nothing = score([], {})
    assert (nothing.automation, nothing.precision, nothing.f1) == (0, 0, 0)
    assert (nothing.decided, nothing.accuracy, nothing.agreement) == (0, 0, 0)


def test_what_the_command_wrote_is_scored(tmp_path, capsys):
    labels, classes = tmp_path / "labels.jsonl", tmp_path / "classes.jsonl"
    either = {"primary": ["Sensors", "Support"], "functions": ["Sensors"], "also_accepted": []}
    labels.write_text(json.dumps({"repo": "either", **either}))
    sensors = {"functions": ["Sensors"], "probabilities": {"Sensors": 0.9}, "decided_by": "name"}
    classified = [{"repo": repo, **sensors} for repo in ("either", "zzz")]
    classes.write_text("\n".join(map(json.dumps, classified)))
    main([str(labels), str(classes)])
    rows = capsys.readouterr().out.splitlines()
    assert [row.split()[0] for row in rows[:4]] == ["develop", "check", "all", "first"]
    assert rows[3].startswith("first functions: 1 answers, Brier 0.1600")
    assert rows[5].split() == ["0.90", "to", "0.95", "1", "0.900", "0.500"]
    assert rows[2].split(maxsplit=1)[1] == (
        "1 repositories, decided 1.000, correct of these 1.000, of all 1.000, "
        "agreement 0.500, F1 1.000"
    )


def test_labels_are_read_and_halved(tmp_path):
    path = tmp_path / "labels.jsonl"
    lines = [
        {"repo": f"r{n}", "primary": ["Mobile"], "functions": ["Mobile"], "also_accepted": []}
        for n in range(40)
    ]
    path.write_text("\n".join(map(json.dumps, lines)))
    labels = read_labels(path)
    assert labels[0] == label("r0", [T.MOBILE], [T.MOBILE])
    assert {each.half for each in labels} == {0, 1}
    assert [each.half for each in labels] == [each.half for each in read_labels(path)]
