import json

from finding_cases import HIGH, LOW, MEDIUM, TRIAGE
from report_cases import CONTENDED, EVENT, REPORT, report_of

from rtron.reports.app.risks_json import risks_to_json
from rtron.sources.ignores import read_baseline
from rtron.vocabulary import Domain, Triage


def test_keys_are_those_of_the_contract():
    document = json.loads(json.dumps(risks_to_json(REPORT)))
    assert document["schema"] == "rtron.risks/2"
    assert document["summary"] == {"GR-ST": 1, "GR-MT": 0, "RSR": 0, "MSR": 2}
    assert document["not_run"] == {"rsr_image": "the graph holds no message types"}
    assert document["coordination_nodes"] == {
        "GRCN": {"Perception": 0, "Planning": 0, "Control": 1},
        "fps_monitor": 2,
        "RSRCN": 1,
        "MSRCN": 1,
    }
    assert document["risks"][0] == {
        "id": "MSR-event:/detect/sign",
        "kind": "MSR",
        "rule": "msr",
        "role_nodes": {"event": ["/detect"]},
        "topics": ["/detect/sign"],
        "message_type": "std_msgs/UInt8",
        "successors": ["/lane"],
        "domain": "Perception",
        "severity": "low",
        "reason": "because",
        "one_to_one": False,
        "evidence": [],
    }
    assert document["risks"][1]["evidence"][0] == {"file": "src/1.py", "line": 1}


def test_risks_keep_their_order():
    assert [risk["kind"] for risk in risks_to_json(REPORT)["risks"]] == ["MSR", "GR-ST", "MSR"]


def test_lesser_domains_are_counted_only_where_they_have_nodes():
    report = report_of(CONTENDED, EVENT, grcn={Domain.DRIVERS: 2, Domain.OTHERS: 0})
    assert risks_to_json(report)["coordination_nodes"]["GRCN"] == {
        "Perception": 0,
        "Planning": 0,
        "Control": 0,
        "Drivers": 2,
    }


def test_findings_say_whether_they_are_new_and_why_they_are_ignored():
    document = risks_to_json(REPORT, TRIAGE)
    assert [(each["id"], each["is_new"]) for each in document["findings"]] == [
        (HIGH.id, True),
        (LOW.id, False),
    ]
    (ignored,) = document["ignored"]
    assert (ignored["finding"]["id"], ignored["topic"]) == (MEDIUM.id, "/arm")
    assert ignored["place"] == {"file": "rtron.toml", "line": 3}
    assert document["gone"] == ["no_server:/plan"]
    assert [each["rule"] for each in document["unused_ignores"]] == ["no_server"]


def test_a_folded_finding_names_the_one_that_tells_of_it():
    triage = Triage(findings=(HIGH, MEDIUM), known=(LOW,), folds={MEDIUM.id: HIGH.id})
    found = {each["id"]: each["folded_under"] for each in risks_to_json(REPORT, triage)["findings"]}
    assert found == {HIGH.id: "", MEDIUM.id: HIGH.id, LOW.id: ""}


def test_a_report_is_the_baseline_of_the_next_scan(tmp_path):
    path = tmp_path / "last.json"
    path.write_text(json.dumps(risks_to_json(REPORT, TRIAGE)))
    baseline = read_baseline(path)
    assert baseline.findings == {each.fingerprint: each.id for each in (HIGH, LOW, MEDIUM)}
    assert baseline.risks == {risk.id for risk in REPORT.risks}
