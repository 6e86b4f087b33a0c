import json
from dataclasses import replace
from pathlib import Path

import pytest
from app_graphs import APPS
from finding_cases import HIGH, LOW, MEDIUM, TRIAGE, UNUSED
from hypothesis import given, settings
from hypothesis import strategies as st
from jsonschema import Draft4Validator
from report_cases import CMD_VEL, CONTENDED, GRAPH, REPORT, report_of, risk, speaks

from example_budget import examples
from rtron.reports.app.sarif import (
    FINDING_FINGERPRINT,
    FINGERPRINT,
    physical_location,
    risks_to_sarif,
)
from rtron.risks import discover_risks
from rtron.vocabulary import (
    Domain,
    Evidence,
    FunctionType,
    InteractionGraph,
    Node,
    RiskKind,
    RiskRole,
    Severity,
    Triage,
    UnresolvedItem,
)

FIXTURES = Path(__file__).parents[2] / "fixtures"
SCHEMA = json.loads((FIXTURES / "sarif/sarif-2.1.0-rtm.5.json").read_text(encoding="utf-8"))
VALIDATOR = Draft4Validator(SCHEMA, format_checker=Draft4Validator.FORMAT_CHECKER)
ROOT = Path("/home/me/ws")


def run_of(graph=GRAPH, report=REPORT, root=None, triage=None):
    document = json.loads(risks_to_sarif(graph, report, root, triage))
    VALIDATOR.validate(document)
    (run,) = document["runs"]
    return run


def fingerprint(fake_study, graph=GRAPH):
    (result,) = run_of(graph, report_of(fake_study))["results"]
    return result["partialFingerprints"][FINGERPRINT]


def artifact(file, root=ROOT):
    return physical_location(Evidence(file=file, line=3), root)["artifactLocation"]


@pytest.mark.parametrize("graph", APPS, ids=lambda graph: graph.app)
def test_the_paper_s_apps_are_valid_sarif(graph):
    report = discover_risks(graph)
    results = run_of(graph, report)["results"]
    assert len(results) == len(report.risks) > 20
    assert len({r["partialFingerprints"][FINGERPRINT] for r in results}) == len(results)


def test_the_validator_refuses_what_is_no_sarif():
    document = json.loads(risks_to_sarif(GRAPH, REPORT, None))
    document["runs"][0]["results"][0]["level"] = "high"
    assert not VALIDATOR.is_valid(document)


def test_the_functions_of_nodes_are_told():
    planner = Node(name="/plan", function=FunctionType.PATH_PLANNING, domain=Domain.PLANNING)
    graph = replace(GRAPH, nodes=(planner, Node(name="/unknown")))
    assert run_of(graph)["logicalLocations"] == [
        {
            "fullyQualifiedName": "/plan",
            "kind": "node",
            "properties": {"function": "Path Planning", "domain": "Planning"},
        }
    ]


def test_every_kind_is_a_rule_with_help():
    rules = run_of()["tool"]["driver"]["rules"]
    assert [rule["id"] for rule in rules] == [kind.value for kind in RiskKind]
    for rule in rules:
        assert "Remedy" in rule["help"]["text"]
        assert "`rtron explain " in rule["help"]["markdown"]
        assert rule["shortDescription"]["text"][0].isupper()


def test_results_point_at_their_rules():
    run = run_of()
    for result in run["results"]:
        rule = run["tool"]["driver"]["rules"][result["ruleIndex"]]
        assert rule["id"] == result["ruleId"]


@pytest.mark.parametrize(
    ("severity", "level"),
    [(Severity.HIGH, "error"), (Severity.MEDIUM, "warning"), (Severity.LOW, "note")],
)
def test_severity_is_the_level(severity, level):
    report = report_of(replace(CONTENDED, severity=severity))
    assert run_of(report=report)["results"][0]["level"] == level


def test_the_first_place_is_the_location_and_the_others_related():
    result = run_of(report=report_of(CONTENDED))["results"][0]
    (location,) = result["locations"]
    assert location["physicalLocation"] == {
        "artifactLocation": {"uri": "src/1.py"},
        "region": {"startLine": 1},
    }
    names = [place["fullyQualifiedName"] for place in location["logicalLocations"]]
    assert names == ["/lane", "/parking", "/teleop"]
    lines = [p["physicalLocation"]["region"]["startLine"] for p in result["relatedLocations"]]
    assert lines == [2, 3, 4, 5]
    assert [place["id"] for place in result["relatedLocations"]] == [1, 2, 3, 4]


def test_a_place_says_what_was_read_there():
    at = Evidence(file="src/lane.py", line=7)
    graph = replace(GRAPH, endpoints=(speaks("/lane", CMD_VEL, evidence=(at,)),))
    result = run_of(graph, report_of(replace(CONTENDED, evidence=(at,))))["results"][0]
    assert result["locations"][0]["message"]["text"] == "/lane publishes /cmd_vel"


def test_a_risk_without_evidence_has_its_nodes():
    result = run_of(report=report_of(replace(CONTENDED, evidence=())))["results"][0]
    (location,) = result["locations"]
    assert "physicalLocation" not in location
    assert location["logicalLocations"][0]["fullyQualifiedName"] == "/lane"
    assert result["relatedLocations"] == []


@pytest.mark.parametrize(
    ("file", "uri", "below"),
    [
        ("/home/me/ws/src/a b.py", "src/a%20b.py", True),
        ("/home/me/ws/src/../c.py", "c.py", True),
        ("/home/me/ws/../ws2/c.py", "file:///home/me/ws2/c.py", False),
        ("/home/me/ws2/c.py", "file:///home/me/ws2/c.py", False),
        ("/opt/ros/x.launch", "file:///opt/ros/x.launch", False),
        ("src/a#?.py", "src/a%23%3F.py", False),
        ("c:evil.py", "c%3Aevil.py", False),
        ("http://robot:11311/", "http://robot:11311/", False),
    ],
)
def test_places_below_the_root_are_relative_to_it(file, uri, below):
    assert artifact(file) == {"uri": uri} | ({"uriBaseId": "SRCROOT"} if below else {})


def test_a_relative_root():
    assert artifact("ws/src/a.py", Path("ws")) == {"uri": "src/a.py", "uriBaseId": "SRCROOT"}
    assert artifact("src/a.py", Path()) == {"uri": "src/a.py", "uriBaseId": "SRCROOT"}
    assert artifact("../a.py", Path()) == {"uri": "../a.py"}
    assert "uri" not in run_of(root=Path())["originalUriBaseIds"]["SRCROOT"]


def test_the_root_is_a_folder():
    assert run_of(root=ROOT)["originalUriBaseIds"]["SRCROOT"]["uri"] == "file:///home/me/ws/"
    assert run_of(root=Path("/"))["originalUriBaseIds"]["SRCROOT"]["uri"] == "file:///"
    assert run_of(root=None)["originalUriBaseIds"] == {}


def test_a_line_that_is_not_known_is_no_region():
    assert "region" not in physical_location(Evidence(file="a.py"), None)
    assert physical_location(Evidence(file="a.py", line=1), None)["region"] == {"startLine": 1}


def test_fingerprints_stay_when_lines_and_unrelated_nodes_change():
    before = fingerprint(CONTENDED)
    moved = tuple(Evidence(file=f"lib/{e.file}", line=e.line + 9) for e in CONTENDED.evidence)
    assert fingerprint(replace(CONTENDED, evidence=moved)) == before
    assert fingerprint(replace(CONTENDED, reason="else", severity=Severity.LOW)) == before
    assert fingerprint(replace(CONTENDED, successors=("/base", "/new"))) == before
    grown = replace(GRAPH, nodes=(Node(name="/other"), *GRAPH.nodes))
    assert fingerprint(CONTENDED, grown) == before


@pytest.mark.parametrize(
    "change",
    [
        {"id": "GR-ST:/cmd_vel2"},
        {"topics": ("/cmd_vel2",)},
        {"kind": RiskKind.GR_MT},
        {"rule": "other"},
        {"role_nodes": {RiskRole.PUBLISHER: ("/lane", "/parking")}},
        {"role_nodes": {RiskRole.ACTION: ("/lane", "/parking", "/teleop")}},
    ],
)
def test_fingerprints_tell_risks_apart(change):
    assert fingerprint(replace(CONTENDED, **change)) != fingerprint(CONTENDED)


def test_what_stayed_unresolved_is_a_notification():
    (invocation,) = run_of()["invocations"]
    odd, not_run = invocation["toolExecutionNotifications"]
    assert odd["message"]["text"] == "a publisher of /odd: its name comes from a service call"
    place = odd["locations"][0]["physicalLocation"]
    assert (place["artifactLocation"]["uri"], place["region"]["startLine"]) == ("src/odd.cpp", 12)
    assert odd["descriptor"]["id"] == "unresolved"
    assert not_run["message"]["text"].startswith("rsr_image: ")


def test_the_order_does_not_depend_on_that_of_the_report():
    items = [UnresolvedItem(what=f"x{i}", why="y") for i in range(4)]
    graph = replace(GRAPH, unresolved=tuple(items))
    turned = replace(GRAPH, unresolved=tuple(reversed(items)))
    mixed = replace(REPORT, risks=REPORT.risks[::-1])
    assert risks_to_sarif(graph, REPORT, ROOT) == risks_to_sarif(turned, mixed, ROOT)


def test_a_stranger_s_brackets_are_no_link():
    told = risk(RiskKind.RSR, reason="[look](http://evil) \\")
    text = run_of(report=report_of(told))["results"][0]["message"]["text"]
    assert text == "\\[look\\](http://evil) \\\\"


@given(st.text(), st.text(), st.integers(min_value=-1, max_value=2**31))
@settings(max_examples=examples(60))
def test_any_name_gives_valid_sarif(name, file, line):
    evidence = (Evidence(file=file, line=line),)
    found = risk(RiskKind.MSR, id=name, topics=(name,), reason=name, evidence=evidence)
    unresolved = (UnresolvedItem(what=name, why=name, evidence=evidence),)
    run = run_of(InteractionGraph(app=name, unresolved=unresolved), report_of(found), ROOT)
    assert [result["ruleId"] for result in run["results"]] == ["MSR"]


def test_findings_come_first_with_what_they_say_and_where():
    run = run_of(triage=Triage(findings=(HIGH, LOW)))
    first, second = run["results"][:2]
    assert (first["ruleId"], first["level"], second["level"]) == (HIGH.rule, "error", "note")
    for text in (HIGH.summary, HIGH.cause, HIGH.remedy):
        assert text in first["message"]["text"]
    uri = first["locations"][0]["physicalLocation"]["artifactLocation"]["uri"]
    assert (uri, len(first["relatedLocations"])) == ("src/nav.py", 2)
    assert first["partialFingerprints"] == {FINDING_FINGERPRINT: HIGH.fingerprint}
    assert "baselineState" not in first
    assert HIGH.rule in {rule["id"] for rule in run["tool"]["driver"]["rules"]}


def test_a_folded_finding_is_a_result_that_names_the_one_that_tells_of_it():
    triage = Triage(findings=(HIGH, MEDIUM), folds={MEDIUM.id: HIGH.id})
    results = run_of(triage=triage)["results"][:2]
    assert [each["properties"].get("foldedUnder") for each in results] == [None, HIGH.id]


def test_ignored_findings_are_suppressed_and_known_ones_unchanged():
    comment = replace(TRIAGE, ignored=((MEDIUM, UNUSED),))
    results = {r["properties"]["id"]: r for r in run_of(triage=TRIAGE)["results"]}
    assert results[HIGH.id]["baselineState"] == "new"
    assert results[LOW.id]["baselineState"] == "unchanged"
    (suppression,) = results[MEDIUM.id]["suppressions"]
    assert suppression == {"kind": "external", "justification": "one of them is a [test] rig"}
    in_source = {r["properties"]["id"]: r for r in run_of(triage=comment)["results"]}
    assert in_source[MEDIUM.id]["suppressions"][0]["kind"] == "inSource"
