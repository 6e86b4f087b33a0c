"""The graph of an app that runs in a ROS 2 domain: real nodes of rclpy, with and without fault."""

import json
import signal
from contextlib import closing

import pytest

pytest.importorskip("rclpy", reason="needs ROS 2")

from harness import wait_for
from ros2_harness import Ros2

from rtron.errors import InputError, SourceError
from rtron.planning.proposal.policy_defaults import propose_plan, unguardable_topics
from rtron.risks import discover_risks
from rtron.sources.graph_json import graph_to_json, parse_graph
from rtron.sources.live.ros2 import domain as asking
from rtron.sources.live.ros2.domain import DomainReader
from rtron.sources.live.ros2.source import Ros2LiveSource
from rtron.vocabulary import (
    Action,
    ActionRole,
    Direction,
    Durability,
    Mode,
    Reliability,
    Resolution,
    Service,
)
from rtron.wire.ros2.endpoints import clients_of, servers_of, service_endpoints_of_node
from rtron.wire.ros2.session import Ros2Session

pytestmark = pytest.mark.ros2
LONG_S = 60.0
"""Time for an app that settles: a busy machine is not a restless graph."""
TWIST = "geometry_msgs/msg/Twist"
FIBONACCI = "test_msgs/action/Fibonacci"
APP = (
    ("/robot/nav", ">/cmd_vel:geometry_msgs/Twist", "</clock:rosgraph_msgs/Clock",
     ">/_secret:std_msgs/String", "+/start", "!/go"),
    ("/teleop", ">/cmd_vel:geometry_msgs/Twist@sensor", "-/start", "?/go"),
    ("/teleop", ">/map:std_msgs/String@latched", ">/mixed:std_msgs/String"),
    ("/base", "</cmd_vel:geometry_msgs/Twist@sensor", "/twin", "/twin", "/mixed",
     "</mixed:std_msgs/Bool", "/rviz", "</go/_action/status:action_msgs/GoalStatusArray"),
)  # fmt: skip


@pytest.fixture(scope="module")
def app(tmp_path_factory):
    """Run the app."""
    with pytest.MonkeyPatch.context() as patch, Ros2(tmp_path_factory.mktemp("app")) as ros2:
        patch.setenv("ROS_AUTOMATIC_DISCOVERY_RANGE", "LOCALHOST")
        for words in APP:
            ros2.node("node_group.py", *words)
        yield ros2


@pytest.fixture(scope="module")
def graph(app):
    return Ros2LiveSource(app.domain, LONG_S).read()


@pytest.fixture
def session(app):
    session = Ros2Session(app.domain)
    yield session
    session.close()


def ends(graph, topic):
    marks = {Direction.PUBLISH: ">", Direction.SUBSCRIBE: "<"}
    return sorted((e.node, marks[e.direction]) for e in graph.endpoints if e.topic == topic)


def unresolved(graph):
    return {each.what: each.why for each in graph.unresolved}


def test_nodes_and_topics_are_the_apps_and_nothing_of_ours(graph):
    assert graph.ros == 2
    names = {"/robot/nav", "/teleop", "/base", "/twin", "/mixed", "/rviz"}
    assert {node.name for node in graph.nodes} == names
    plain = {topic.name for topic in graph.topics if not topic.name.startswith("/go/")}
    implied = {"/rosout", "/parameter_events", "/clock", "/_secret"}
    assert plain == {"/cmd_vel", "/map", "/mixed"} | implied
    assert ends(graph, "/cmd_vel") == [("/base", "<"), ("/robot/nav", ">"), ("/teleop", ">")]
    assert {e.type for e in graph.publishers("/cmd_vel")} == {TWIST}
    assert {e.resolution for e in graph.endpoints} == {Resolution.OBSERVED}


def test_endpoints_have_their_qos_and_gid(graph):
    (latched,) = graph.publishers("/map")
    (heard,) = graph.subscribers("/cmd_vel")
    assert latched.qos.durability is Durability.TRANSIENT_LOCAL
    assert latched.qos.reliability is Reliability.RELIABLE
    assert heard.qos.reliability is Reliability.BEST_EFFORT
    gids = [endpoint.gid for endpoint in graph.endpoints]
    assert len(set(gids)) == len(gids)
    assert {len(gid) for gid in gids} == {32}


def test_what_the_client_library_adds_or_hides_is_implicit(graph):
    implicit = {e.topic for e in graph.endpoints if e.implicit and "_action" not in e.topic}
    assert implicit == {"/rosout", "/parameter_events", "/clock", "/_secret"}
    services = {s.name: s.implicit for s in graph.services if s.node == "/base"}
    assert services["/base/describe_parameters"]
    assert services["/base/get_type_description"]
    assert set(services.values()) == {True}


def test_services_have_a_type_and_are_their_servers(graph):
    (start,) = (service for service in graph.services if service.name == "/start")
    assert start == Service(node="/robot/nav", name="/start", type="std_srvs/srv/Trigger")
    assert not [service for service in graph.services if "_action" in service.name]


def test_an_action_is_one_entry_a_side(graph):
    assert graph.actions == (
        Action(node="/robot/nav", name="/go", type=FIBONACCI, role=ActionRole.SERVER),
        Action(node="/teleop", name="/go", type=FIBONACCI, role=ActionRole.CLIENT),
    )


def test_who_only_watches_an_action_stays_an_implicit_subscriber(graph):
    seen = [(e.node, e.topic, e.implicit) for e in graph.endpoints if "_action" in e.topic]
    assert seen == [("/rviz", "/go/_action/status", True)]


def test_doubles_and_mixed_types_are_told(graph):
    told = unresolved(graph)
    assert set(told) == {"/teleop", "/twin", "/mixed"}
    assert told["/teleop"].startswith("is the name of 2 nodes in 2 processes")
    assert told["/twin"].startswith("is the name of 2 nodes in one process")
    assert "std_msgs/msg/Bool (/mixed), std_msgs/msg/String (/teleop)" in told["/mixed"]
    (teleop,) = (each for each in graph.unresolved if each.what == "/teleop")
    gids = {e.gid[:24] for e in graph.endpoints if e.node == "/teleop"}
    assert {place.file for place in teleop.evidence} == gids


def test_it_goes_through_json_unchanged(graph):
    document = json.dumps(graph_to_json(graph)).encode()
    assert parse_graph(document, "graph.json") == graph


def test_risks_and_a_plan_come_of_it(graph):
    report = discover_risks(graph)
    plan = propose_plan(graph, report)
    assert plan.ros == 2
    (velocity,) = (node for node in plan.grcn if node.topic == "/cmd_vel")
    assert velocity.mode is Mode.ENFORCE
    assert {flow.publisher for flow in velocity.flows} == {"/robot/nav", "/teleop"}
    assert velocity.successors == ("/base",)
    assert "MSR-action:/go" in {risk.id for risk in report.risks}
    assert not [risk for risk in report.risks if "/parameter_events" in risk.topics]
    assert unguardable_topics(graph, report) == ()


def test_the_names_lead_to_the_same_services_as_the_gids(session):
    node = session.node("/_asking")
    for ends_now in (servers_of, clients_of):
        wait_for(
            lambda ends_now=ends_now: [e.node for e in ends_now(node, "/start") if e.node],
            what="the names of both ends",
        )
    named = [
        end for end in service_endpoints_of_node(node, "nav", "/robot") if end.service == "/start"
    ]
    (end,) = servers_of(node, "/start")
    assert [(e.service, e.is_server, e.node, e.type) for e in named] == [
        (end.service, end.is_server, end.node, end.type)
    ]
    assert [(e.node, e.is_server) for e in clients_of(node, "/start")] == [("/teleop", False)]


@pytest.mark.long
def test_a_node_that_is_gone_is_not_there(app):
    leaving = app.node("node_group.py", "/leaving", ">/left:std_msgs/String")
    wait_for(
        lambda: ends(Ros2LiveSource(app.domain, LONG_S).read(), "/left") == [("/leaving", ">")],
        what="the node",
    )
    leaving.tell(signal.SIGINT)
    wait_for(
        lambda: not ends(Ros2LiveSource(app.domain, LONG_S).read(), "/left"), what="the node's end"
    )


@pytest.mark.parametrize(
    ("limit", "what"), [("MAX_NAMES", "topics"), ("MAX_ENDPOINTS", "endpoints")]
)
def test_a_domain_too_large_is_refused(app, monkeypatch, limit, what):
    monkeypatch.setattr(asking, limit, 6)
    with pytest.raises(SourceError, match=f"more than 6 ({what}|nodes)"):
        Ros2LiveSource(app.domain, LONG_S).read()


@pytest.fixture
def domain(session):
    with closing(DomainReader(session, "/_asking")) as domain:
        yield domain


def test_a_look_that_takes_too_long_is_ended(domain):
    wait_for(lambda: domain.snapshot(LONG_S).endpoints, what="an endpoint")
    with pytest.raises(SourceError, match="more than there is time for"):
        domain.snapshot(0.0)


def test_names_that_are_none_are_counted_and_left_out(session, domain, monkeypatch):
    wait_for(lambda: domain.snapshot(LONG_S).endpoints, what="an endpoint")
    bad = [("/{node}/x", ["a"]), ("/a b", ["b"]), ("", ["c"]), ("/é\n", ["d"])]
    node = session.node("/_asking")
    honest = node.get_topic_names_and_types

    def lying(**options):
        return honest(**options) if options else [*bad, *honest()]

    monkeypatch.setattr(node, "get_topic_names_and_types", lying)
    assert domain.snapshot(LONG_S).malformed == len(bad)


def test_names_that_are_no_text_are_an_error(session, domain, monkeypatch):
    def undecodable(**_):
        b"\xff".decode()

    monkeypatch.setattr(session.node("/_asking"), "get_topic_names_and_types", undecodable)
    with pytest.raises(SourceError, match="no text"):
        domain.fingerprint()
    with pytest.raises(SourceError, match="no text"):
        domain.snapshot(LONG_S)


def test_a_stranger_with_our_nodes_name_is_seen(app, session):
    name = "/_asking"
    other = app.node("node_group.py", name, ">/hidden_by_name:std_msgs/String")
    with closing(DomainReader(session, name)) as domain:
        wait_for(lambda: name in domain.snapshot(LONG_S).nodes, what="the other of that name")
        wait_for(lambda: domain.snapshot(LONG_S).all_named, what="its name")
        ends = domain.snapshot(LONG_S).endpoints
    assert {end.node for end in ends if end.topic == "/hidden_by_name"} == {name}
    other.tell(signal.SIGINT)


def test_nobody_is_an_error_with_help(ros2, monkeypatch):
    monkeypatch.setenv("ROS_AUTOMATIC_DISCOVERY_RANGE", "LOCALHOST")
    with pytest.raises(SourceError, match=f"no node is seen in ROS 2 domain {ros2.domain}") as told:
        Ros2LiveSource(ros2.domain, 0.1).read()
    assert "--domain" in told.value.help


@pytest.mark.parametrize("domain", ["233", "-1", "seven", "1" * 5000])
def test_a_domain_that_is_none_is_an_error_and_no_end_of_the_process(monkeypatch, domain):
    monkeypatch.setenv("ROS_DOMAIN_ID", domain)
    with pytest.raises(InputError, match="there is no ROS 2 domain") as told:
        Ros2LiveSource(None, LONG_S).read()
    assert len(str(told.value)) < 100


def test_what_is_read_is_said(monkeypatch):
    monkeypatch.setenv("ROS_DOMAIN_ID", "7")
    monkeypatch.setenv("ROS_AUTOMATIC_DISCOVERY_RANGE", "LOCALHOST")
    assert Ros2LiveSource(None, 1).domain_description.startswith("ROS 2 domain 7 (rmw_")
    assert Ros2LiveSource(3, 1).domain_description.endswith(", this machine only)")
    monkeypatch.setenv("ROS_AUTOMATIC_DISCOVERY_RANGE", "SUBNET")
    assert Ros2LiveSource(0, 1).domain_description.endswith(", discovery range SUBNET)")
    monkeypatch.setenv("ROS_LOCALHOST_ONLY", "1")
    assert Ros2LiveSource(0, 1).domain_description.endswith(", this machine only)")


def test_the_command_line_reads_it(app):
    words = ("scan", "--live", "--ros", "2", "--timeout", str(LONG_S))
    scan = app.rtron(*words)
    wait_for(lambda: scan.ended, what="the scan")
    assert scan.code == 1, scan.log
    assert f"the app running in ROS 2 domain {app.domain} (rmw_" in scan.log
    assert "/teleop" in scan.log
    assert "rtron plan --live --ros 2 -o rtron.yaml" in scan.log
    plan = app.rtron("plan", "--live", "--domain", app.domain, "--timeout", LONG_S, "-o", "-")
    wait_for(lambda: plan.ended, what="the plan")
    assert plan.code == 0, plan.log
    assert "ros: 2" in plan.log
