"""On any graph the rules agree with the naive reading of the algorithm, and nothing breaks them."""

from dataclasses import replace

from hypothesis import given
from hypothesis import strategies as st
from reference_algorithm import naive_risks

from rtron.risks import discover_risks
from rtron.vocabulary import Direction, Endpoint, InteractionGraph, Node, Topic, Trust

NODES = ["/a", "/b", "/c", "/detect", "/rviz"]
TOPICS = [
    "/cmd_vel",
    "/tf",
    "/detect/sign",
    "/faces",
    "/x_max_vel",
    "/x/goal",
    "/x/result",
    "/goal/feedback",
    "/rosout",
    "/plain",
]
TYPES = [
    "geometry_msgs/Twist",
    "geometry_msgs/msg/TwistStamped",
    "geometry_msgs/TwistWithCovariance",
    "sensor_msgs/Image",
    "sensor_msgs/msg/CompressedImage",
    "nav_msgs/Odometry",
    "std_msgs/Float64",
    "std_msgs/msg/Float64",
    "p/DriveActionResult",
    "visualization_msgs/Marker",
    "control_msgs/FollowJointTrajectoryActionGoal",
]
ends = st.builds(
    Endpoint,
    node=st.sampled_from(NODES),
    topic=st.sampled_from(TOPICS),
    type=st.sampled_from(TYPES),
    direction=st.sampled_from(Direction),
)
nodes = st.builds(
    Node,
    name=st.sampled_from(NODES),
    package=st.sampled_from(["rviz", "rqt_graph", "base", ""]),
    trust=st.sampled_from(Trust),
)
graphs = st.builds(
    InteractionGraph,
    app=st.just("app"),
    nodes=st.lists(nodes, max_size=5, unique_by=lambda node: node.name).map(tuple),
    endpoints=st.lists(ends, max_size=30).map(tuple),
)
hostile = st.builds(
    InteractionGraph,
    app=st.text(),
    ros=st.integers(),
    nodes=st.lists(st.builds(Node, name=st.text(), package=st.text()), max_size=4).map(tuple),
    topics=st.lists(
        st.builds(Topic, name=st.text(), types=st.lists(st.text(), max_size=3).map(tuple)),
        max_size=4,
    ).map(tuple),
    endpoints=st.lists(
        st.builds(
            Endpoint,
            node=st.text(max_size=2),
            topic=st.text(max_size=2),
            type=st.text(max_size=2) | st.just("*"),
            direction=st.sampled_from(Direction),
        ),
        max_size=12,
    ).map(tuple),
)


@given(graphs)
def test_discovery_agrees_with_the_naive_reading(graph):
    report = discover_risks(graph)
    naive = naive_risks(graph)
    assert {risk.id for risk in report.risks} == {
        i for i in naive if rule_of(i) not in report.not_run
    }


def rule_of(risk_id):
    return risk_id.split(":")[0].lower().replace("-", "_")


@given(graphs)
def test_the_order_of_the_endpoints_changes_nothing(graph):
    turned = replace(graph, endpoints=graph.endpoints[::-1])
    assert ids(turned) == ids(graph)


def ids(graph):
    return [risk.id for risk in discover_risks(graph).risks]


@given(graphs)
def test_trust_changes_the_severity_and_nothing_else(graph):
    trusted = replace(graph, nodes=tuple(replace(n, trust=Trust.OWN) for n in graph.nodes))
    pairs = zip(discover_risks(graph).risks, discover_risks(trusted).risks, strict=True)
    order = ["low", "medium", "high"]
    for found, milder in pairs:
        assert replace(found, severity=milder.severity) == milder
        assert order.index(found.severity) >= order.index(milder.severity)


@given(hostile)
def test_no_graph_breaks_discovery(graph):
    report = discover_risks(graph)
    assert all(risk.reason and risk.id for risk in report.risks)


def test_a_huge_name_does_no_harm():
    name = "/" + "detect/goal" * 100_000
    ends = tuple(
        Endpoint(node=name, topic=name, type=name, direction=direction) for direction in Direction
    )
    assert {r.rule for r in discover_risks(InteractionGraph(app="", endpoints=ends)).risks} == {
        "msr_event",
        "msr_action",
    }
