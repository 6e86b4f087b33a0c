import json
import re
from base64 import b64encode
from dataclasses import replace
from hashlib import sha256
from html.parser import HTMLParser

import pytest
from app_graphs import AUTORACE
from hypothesis import given, settings
from hypothesis import strategies as st
from report_cases import CMD_VEL, CONTENDED, GRAPH, REPORT, SIGN, hears, report_of, speaks

from example_budget import examples
from rtron.planning import propose_plan
from rtron.reports.app.html import graph_to_html
from rtron.risks import discover_risks
from rtron.sanitize import sanitize
from rtron.vocabulary import (
    SECOND,
    Area,
    Evidence,
    FrameSource,
    InteractionGraph,
    MissionRule,
    Node,
    Point,
    Resolution,
    Transform,
    Trust,
    WatchedFlow,
)

EVIL = "</script><img src=x onerror=alert(1)><!--\"'&\u2028\x1b$title"


class Page(HTMLParser):
    """The text of each script and style, and every tag with its attributes."""

    def __init__(self, text):
        super().__init__(convert_charrefs=True)
        self.texts, self.tags, self.title = {"script": [], "style": []}, [], ""
        self.feed(text)
        self.close()

    def handle_starttag(self, tag, attrs):
        self.tags.append((tag, dict(attrs)))

    def handle_data(self, data):
        last = self.tags[-1][0] if self.tags else ""
        if last in self.texts and self.cdata_elem:
            self.texts[last].append(data)
        if last == "title":
            self.title += data

    @property
    def data(self):
        return json.loads(self.texts["script"][0])


def page_of(graph=GRAPH, report=REPORT, plan=None):
    return Page(graph_to_html(graph, report, plan))


def autorace():
    report = discover_risks(AUTORACE)
    return AUTORACE, report, propose_plan(AUTORACE, report)


def named(items, name):
    return next(item for item in items if item["name"] == name)


def test_the_page_holds_the_graph():
    data = page_of().data
    assert [node["name"] for node in data["nodes"]] == [node.name for node in GRAPH.nodes]
    first = data["endpoints"][0]
    assert data["nodes"][first["node"]]["name"] == "/lane"
    assert data["topics"][first["topic"]]["name"] == CMD_VEL
    assert (first["publishes"], first["implicit"]) == (True, False)
    assert [e["implicit"] for e in data["endpoints"]].count(True) == 1
    (group,) = data["unresolved"]
    assert (group["title"], group["remedy"]) == (
        "Not followed in the source",
        "look at these places yourself",
    )
    assert group["notes"][0]["evidence"] == ["src/odd.cpp:12"]
    assert data["notRun"] == [["rsr_image", "the graph holds no message types"]]


def test_endpoints_tell_where_they_come_from():
    at = Evidence(file="src/lane.py", line=7)
    endpoints = (
        speaks("/lane", CMD_VEL, declared_name="cmd", resolution=Resolution.MODEL, evidence=(at,)),
        hears("/base", CMD_VEL, declared_name=CMD_VEL),
    )
    said, heard = page_of(replace(GRAPH, endpoints=endpoints)).data["endpoints"]
    assert (said["declared"], said["resolution"]) == ("cmd", "model")
    assert said["evidence"] == ["src/lane.py:7"]
    assert heard["declared"] == ""


def test_the_paper_s_colours():
    data = page_of().data
    assert data["endpoints"][0]["marks"] == ["GR-ST"]
    assert named(data["topics"], SIGN)["marks"] == ["event"]
    assert named(data["topics"], CMD_VEL)["marks"] == ["action"]
    robot = page_of(*autorace()).data["nodes"]
    assert named(robot, "/detect_lane")["marks"] == ["image"]
    assert "max_vel" in named(robot, "/detect_tunnel")["marks"]


def test_risks_stand_worst_first_with_the_numbers_of_their_nodes():
    data = page_of().data
    assert [risk["severity"] for risk in data["risks"]] == ["high", "medium", "low"]
    worst = data["risks"][0]
    assert [data["nodes"][n]["name"] for n in worst["roles"][0][1]] == [
        "/lane",
        "/parking",
        "/teleop",
    ]
    assert worst["reason"] == CONTENDED.reason


def test_the_plan_s_coordination_nodes():
    graph, report, plan = autorace()
    data = page_of(graph, report, plan).data
    kinds = [node["kind"] for node in data["coordination"]]
    assert kinds.count("GRCN") == len(plan.grcn) > 10
    assert (kinds.count("RSRCN"), kinds.count("MSRCN")) == (1, 1)
    assert kinds.count("fps_monitor") == len(plan.fps_monitor) == 5
    velocity = next(c for c in data["coordination"] if c["id"] == "grcn_cmd_vel")
    (guard,) = velocity["guards"]
    first = guard["flows"][0]
    assert data["topics"][guard["topic"]]["name"] == CMD_VEL
    assert [data["nodes"][n]["name"] for n in first["nodes"]] == [first["publisher"]]
    assert page_of(graph, report).data["coordination"] == []


def test_limits_rules_and_cameras_of_the_plan_in_words():
    graph, report, plan = autorace()
    rsrcn = replace(plan.rsrcn, threshold=0.02, max_vel_limit=0.22)
    event = replace(plan.msrcn.eflows[0], present=None, silent=SECOND)
    rule = MissionRule(name="r1", block=(CMD_VEL,), when=event.name, reason=EVIL)
    area = Area(name="hall", frame="map", polygon=(Point(x=0, y=0),) * 3)
    frames = Transform(source="odom", target="map")
    msrcn = replace(plan.msrcn, eflows=(event,), rules=(rule,), areas=(area,), transforms=(frames,))
    camera = WatchedFlow(name="camera", topic="/only/here", publisher="/nobody")
    monitor = replace(plan.fps_monitor[0], camera=camera, source=FrameSource.DETECTIONS)
    plan = replace(plan, grcn=(), rsrcn=rsrcn, msrcn=msrcn, fps_monitor=(monitor,))
    data = page_of(graph, report, plan).data
    fps, limits, mission = data["coordination"]
    assert fps["terms"] == [
        "counts detections only, over 1 s, no faster than /only/here of /nobody"
    ]
    assert [watch["name"] for watch in fps["watches"]] == ["detections", "camera"]
    assert data["topics"][fps["watches"][1]["topic"]]["name"] == "/only/here"
    assert limits["terms"] == ["threshold 0.02 m/frame", "max_vel_limit 0.22 m/s"]
    assert mission["terms"] == [
        "area hall: 3 corners in map",
        "odom lies in map at 0 m, 0 m, 0 rad",
    ]
    assert mission["rules"] == [["r1", f"while {event.name}: block {CMD_VEL}", sanitize(EVIL)]]
    assert mission["watches"][0]["note"] == "set after 1 s without a message"


def test_a_pattern_in_the_plan_means_the_nodes_that_it_names():
    graph, report, plan = autorace()
    flow = replace(plan.grcn[0].flows[0], publisher="/detect_*")
    plan = replace(plan, grcn=(replace(plan.grcn[0], flows=(flow,)),))
    data = page_of(graph, report, plan).data
    meant = data["coordination"][0]["guards"][0]["flows"][0]["nodes"]
    assert {data["nodes"][n]["name"][:8] for n in meant} == {"/detect_"}


def test_names_that_only_a_risk_or_the_plan_knows_are_there():
    _, report, plan = autorace()
    data = page_of(InteractionGraph(app="empty"), report, plan).data
    assert named(data["topics"], CMD_VEL)
    assert named(data["nodes"], "/gazebo")["trust"] == "unknown"


def test_an_empty_graph_is_a_page():
    page = page_of(InteractionGraph(app=""), report_of())
    assert page.title.startswith("app ")
    assert page.data["nodes"] == []


def test_nothing_comes_from_elsewhere():
    text = graph_to_html(*autorace())
    for _, attributes in Page(text).tags:
        assert not {"src", "href", "srcset", "style"} & attributes.keys()
    assert "@import" not in text
    assert re.findall(r"url\((?!#)[^)]*\)", Page(text).texts["style"][0]) == []
    assert len(text) < 300_000


def test_the_policy_allows_the_page_s_own_scripts_and_no_others():
    page = page_of()
    policy = next(a["content"] for _, a in page.tags if "http-equiv" in a)
    rules = dict(part.strip().split(" ", 1) for part in policy.split(";"))
    assert rules["default-src"] == "'none'"
    _, *scripts = page.texts["script"]
    for name, texts in (("script-src", scripts), ("style-src", page.texts["style"])):
        hashes = [b64encode(sha256(text.encode()).digest()).decode() for text in texts]
        assert rules[name].split() == [f"'sha256-{digest}'" for digest in hashes]


def test_the_layout_s_licence_is_in_the_page():
    assert "Copyright (c) 2012-2014 Chris Pettitt" in page_of().texts["script"][1]


def test_the_page_is_the_same_each_time():
    assert graph_to_html(*autorace()) == graph_to_html(*autorace())


def evil_graph(name):
    return InteractionGraph(
        app=name,
        nodes=(Node(name=name, package=name, trust=Trust.OWN),),
        endpoints=(speaks(name, name, type=name, evidence=(Evidence(file=name, line=1),)),),
    )


def test_a_stranger_s_names_stay_text():
    page = page_of(evil_graph(EVIL), report_of(replace(CONTENDED, reason=EVIL)))
    assert not [tag for tag, _ in page.tags if tag == "img"]
    assert len(page.texts["script"]) == 3
    name = page.data["nodes"][0]["name"]
    assert name == EVIL.replace("\u2028", "\\u2028").replace("\x1b", "\\x1b")
    assert page.title.startswith(name)


@given(st.text())
@settings(max_examples=examples(60))
def test_any_name_leaves_the_page_whole(name):
    plain, strange = page_of(evil_graph("a")), page_of(evil_graph(name))
    assert [tag for tag, _ in strange.tags] == [tag for tag, _ in plain.tags]
    assert strange.texts["script"][1:] == plain.texts["script"][1:]
    assert strange.data["nodes"][0]["package"] == sanitize(name)


@pytest.mark.parametrize("name", ["\ud800", "\u202etxt", "\x00"])
def test_names_that_steer_are_spelled_out(name):
    text = graph_to_html(evil_graph(name), report_of(), None)
    text.encode()
    assert name not in text
