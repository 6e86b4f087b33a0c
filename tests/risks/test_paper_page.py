"""Every figure of ours in docs/paper.md is what the code gives."""

import re
from pathlib import Path

import pytest
from autorace import AUTORACE
from home import HOME

from rtron.planning import propose_plan
from rtron.risks import default_lists, discover_risks
from rtron.vocabulary import Domain, RiskKind, RiskRole

PAGE = (Path(__file__).parents[2] / "docs" / "paper.md").read_text(encoding="utf-8")
APPS = {"Home": HOME, "AutoRace": AUTORACE}
REPORTS = {app: discover_risks(graph) for app, graph in APPS.items()}
ROWS = [tuple(cell.strip() for cell in row.split("|")[1:-1]) for row in PAGE.splitlines()]
EXAMPLES = [row for row in ROWS if len(row) == 5 and " on " in row[2]]


def code(words) -> str:
    return " ".join(f"`{word}`" for word in words)


@pytest.mark.parametrize("app", APPS)
def test_the_numbers_of_coordination_nodes(app):
    counted = REPORTS[app].coordination_nodes
    domains = (Domain.PERCEPTION, Domain.PLANNING, Domain.CONTROL)
    numbers = [counted.grcn[domain] for domain in domains]
    numbers += [counted.fps_monitor, counted.rsrcn, counted.msrcn]
    assert (app, "ours", *map(str, numbers)) in ROWS
    assert set(counted.grcn) == set(domains)


@pytest.mark.parametrize("domain", ["Perception", "Planning", "Control"])
def test_the_topics_of_the_grcns_of_home(domain):
    report = REPORTS["Home"]
    general = (RiskKind.GR_ST, RiskKind.GR_MT)
    risky = {topic for risk in report.risks if risk.kind in general for topic in risk.topics}
    topics = [t for t in sorted(risky) if report.topic_classes[t].domain.value == domain]
    assert (domain, code(topics)) in ROWS


def test_the_plan_has_a_grcn_for_each_but_one_for_an_action():
    report = REPORTS["Home"]
    guarded = {grcn.topic for grcn in propose_plan(HOME, report).grcn}
    rows = [row for row in ROWS if len(row) == 2]
    named = {topic for _, topics in rows for topic in re.findall("`(/.+?)`", topics)}
    assert named - guarded == {"/move_base/cancel", "/move_base/status"}
    assert guarded <= named


def test_all_fifteen_examples_stand_in_the_table():
    assert len(EXAMPLES) == 15


@pytest.mark.parametrize("row", EXAMPLES, ids=lambda row: f"{row[0]} {row[1]} {row[2]}")
def test_an_example_is_found_as_the_table_says(row):
    app, _, example, risk_id, found = row
    node, topic = re.findall(r"`(.+?)`", example)
    risk = next(risk for risk in REPORTS[app].risks if risk.id == risk_id.strip("`"))
    assert topic in risk.topics
    high_risk = {name for nodes in risk.role_nodes.values() for name in nodes}
    assert (node in high_risk) == found.startswith("yes")
    assert (node in risk.successors) == found.startswith("as successor")


def test_the_actions_and_events_of_home():
    risks = REPORTS["Home"].risks
    actions = sorted(t for risk in risks if RiskRole.ACTION in risk.role_nodes for t in risk.topics)
    assert code(actions) in PAGE
    msrcn = propose_plan(HOME, REPORTS["Home"]).msrcn
    assert f"\n  {code(topic.topic for topic in msrcn.aflows)}.\n" in PAGE
    events = {flow.topic for flow in msrcn.eflows}
    assert events == {"/objects", "/person_detector/detections", "/odom"}
    assert [t for risk in risks if RiskRole.EVENT in risk.role_nodes for t in risk.topics] == [
        "/odom",
        "/person_detector/detections",
    ]


def test_the_words_of_recognitions():
    assert code(default_lists().recog_topic_name) in PAGE


@pytest.mark.parametrize("app", APPS)
def test_the_sizes_of_the_apps_beside_their_times(app):
    graph = APPS[app]
    sizes = (str(len(graph.nodes)), str(len(graph.topics)))
    assert (app, "ours", *sizes, "", "", "", "< 0.005") in ROWS
