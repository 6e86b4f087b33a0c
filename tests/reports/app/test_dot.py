import re
from dataclasses import replace

import pytest
from hypothesis import given
from hypothesis import strategies as st
from report_cases import CMD_VEL, GRAPH, REPORT, SIGN, hears, report_of, risk, speaks

from rtron.reports.app.dot import graph_to_dot
from rtron.vocabulary import FunctionType, InteractionGraph, Node, RiskKind, RiskRole

QUOTED = r'"(?:[^"\\]|\\.)*"'
ATTRIBUTE = rf"\w+=(?:{QUOTED}|[\w.]+)"
LINE = re.compile(
    rf"""\s*(?:
      (?:digraph|subgraph)\ \w+\ \{{ | \}}
      | \w+(?:\ ->\ \w+)?(?:\ \[{ATTRIBUTE}(?:,\ {ATTRIBUTE})*\])?
      | {ATTRIBUTE}(?:;\ {ATTRIBUTE})*
    )""",
    re.VERBOSE,
)


def parsed(dot):
    """Return the looks of vertices by label and of edges by their ends' labels."""
    for row in dot.splitlines():
        assert LINE.fullmatch(row), row
    braces = re.sub(QUOTED, "", dot)
    assert braces.count("{") == braces.count("}") == 2
    labels, looks, edges = {}, {}, {}
    for id, label, look in re.findall(rf"^  (\w+) \[label=({QUOTED}), (.*)\]$", dot, re.MULTILINE):
        labels[id] = id[0] + label[1:-1]
        looks[labels[id]] = look
    for tail, head, look in re.findall(r"^  (\w+) -> (\w+)(.*)$", dot, re.MULTILINE):
        edges[labels[tail], labels[head]] = look
    return looks, edges


def test_nodes_are_ellipses_and_topics_boxes():
    looks, edges = parsed(graph_to_dot(GRAPH, report_of()))
    assert looks["n/base"] == 'shape=ellipse, fillcolor="gray85"'
    assert looks[f"t{CMD_VEL}"] == 'shape=box, fillcolor="white"'
    assert edges["n/lane", f"t{CMD_VEL}"] == ""
    assert (f"t{CMD_VEL}", "n/base") in edges


def test_a_function_is_a_tooltip():
    nodes = (Node(name="/lane", function=FunctionType.PATH_TRACKING), Node(name="/base"))
    looks, _ = parsed(graph_to_dot(replace(GRAPH, nodes=nodes), report_of()))
    assert looks["n/lane"] == 'shape=ellipse, fillcolor="gray85", tooltip="Path Tracking"'
    assert "tooltip" not in looks["n/base"]


def test_implicit_endpoints_are_left_out():
    assert "rosout" not in graph_to_dot(GRAPH, REPORT)


def test_general_risks_colour_the_arrows():
    multi = risk(
        RiskKind.GR_MT,
        role_nodes={RiskRole.PUBLISHER: ("/detect",)},
        topics=(SIGN, CMD_VEL),
        successors=("/lane",),
    )
    _, edges = parsed(graph_to_dot(GRAPH, report_of(*REPORT.risks, multi)))
    assert edges["n/teleop", f"t{CMD_VEL}"] == ' [color="blue", penwidth=2]'
    assert edges[f"t{CMD_VEL}", "n/base"] == ' [color="blue", penwidth=2]'
    assert edges["n/detect", f"t{SIGN}"] == ' [color="red", penwidth=2]'
    assert edges[f"t{SIGN}", "n/lane"] == ' [color="red", penwidth=2]'
    assert edges["n/lane", f"t{CMD_VEL}"] == ' [color="blue:red", penwidth=2]'
    assert edges["t/camera/image", "n/detect"] == ""


def test_mission_risks_colour_the_topics():
    looks, _ = parsed(graph_to_dot(GRAPH, REPORT))
    assert "style=striped" in looks[f"t{SIGN}"]
    assert 'fillcolor="plum"' in looks[f"t{CMD_VEL}"]


def test_robot_risks_colour_the_nodes():
    nodes = {RiskRole.IMAGE: ("/detect",), RiskRole.MAX_VEL: ("/lane",)}
    looks, _ = parsed(graph_to_dot(GRAPH, report_of(risk(RiskKind.RSR, role_nodes=nodes))))
    assert "yellow" in looks["n/detect"]
    assert "orange" in looks["n/lane"]


def test_a_node_and_a_topic_of_one_name_are_two():
    looks, edges = parsed(
        graph_to_dot(InteractionGraph(app="", endpoints=(speaks("/x", "/x"),)), report_of())
    )
    assert {"n/x", "t/x"} <= set(looks)
    assert list(edges) == [("n/x", "t/x")]


@pytest.mark.parametrize(
    ("hostile", "label"),
    [
        ('"];evil[label="', r"\"];evil[label=\""),
        ("\\", r"\\"),
        ("\\N", r"\\N"),
        ("a\nb", r"a\\nb"),
        ("\x1b[31m", r"\\x1b[31m"),
        ("<b>", "<b>"),
    ],
)
def test_names_cannot_leave_their_quotes(hostile, label):
    graph = InteractionGraph(app=hostile, endpoints=(hears(hostile, hostile),))
    looks, _ = parsed(graph_to_dot(graph, report_of()))
    assert {f"n{label}", f"t{label}"} <= set(looks)


@given(st.text(), st.text())
def test_any_name_gives_valid_dot(node, topic):
    graph = InteractionGraph(app=node, endpoints=(hears(node, topic),))
    _, edges = parsed(graph_to_dot(graph, report_of()))
    assert len(edges) == 1
