"""Nothing in a graph breaks the rules of findings, and their order in it changes nothing."""

from dataclasses import replace

from hypothesis import example, given
from hypothesis import strategies as st

from rtron.findings import app_facts, find_findings, take_inventory
from rtron.reports.app.inventory_rows import inventory_to_json, mover_rows
from rtron.vocabulary import (
    Action,
    ActionRole,
    Direction,
    Durability,
    Endpoint,
    InteractionGraph,
    Liveliness,
    Node,
    NodeParameter,
    QoS,
    Reliability,
    Resolution,
    Service,
    ServiceClient,
    Trust,
    UnresolvedItem,
    WiringFact,
    WiringFactKind,
)
from rtron.vocabulary.enums import HiddenPart

NODES = ["/a", "/b", "/mux", "/rviz", "/bridge"]
NAMES = ["/cmd_vel", "/nav/cmd_vel", "/cmd_ve", "/scan", "/x/goal", "/x/feedback", "/{?}/scan", "{"]
TYPES = [
    "geometry_msgs/Twist",
    "geometry_msgs/msg/TwistStamped",
    "sensor_msgs/msg/LaserScan",
    "control_msgs/FollowJointTrajectoryActionGoal",
    "",
    "*",
]
PACKAGES = ["twist_mux", "rviz2", "rosbridge_server", "nav2_controller", "base", ""]
PARAMETERS = ["use_sim_time", "cmd_vel_timeout", "x.cmd_timeout", "address", ""]
PARAMETERS += ["topics.nav.topic", "topics.nav.priority", "max_vel"]
MISSING = ["", "p/a", "a.launch", "/b/a.launch"]


def tuples(strategy, size, **keys):
    return st.lists(strategy, max_size=size, **keys).map(tuple)


def graphs_of(node, name, type, text):
    """Return a strategy of graphs whose words are drawn from strategies."""
    times = st.integers(-1, 2)
    qos = st.builds(
        QoS,
        reliability=st.sampled_from(Reliability),
        durability=st.sampled_from(Durability),
        liveliness=st.sampled_from(Liveliness),
        deadline=times,
        lease=times,
    )
    end = st.builds(
        Endpoint,
        node=node,
        topic=name,
        type=type,
        direction=st.sampled_from(Direction),
        implicit=st.booleans(),
        resolution=st.sampled_from(Resolution),
        qos=st.none() | qos,
    )
    nodes = st.builds(
        Node, name=node, package=st.sampled_from(PACKAGES) | text, unread=st.booleans()
    )
    value = st.none() | st.booleans() | st.floats() | st.integers() | text
    parameter = st.builds(
        NodeParameter, node=node, name=st.sampled_from(PARAMETERS) | text, value=value
    )
    note = st.builds(
        UnresolvedItem,
        what=text,
        why=text,
        missing=st.sampled_from(MISSING) | text,
        hides=st.none() | st.sampled_from(HiddenPart),
    )
    others = tuples(name | text, 3)
    fact = st.builds(
        WiringFact,
        kind=st.sampled_from(WiringFactKind),
        subject=node | name | text,
        value=text,
        others=others,
    )
    side = {"node": node, "name": name, "type": type, "implicit": st.booleans()}
    action = st.builds(Action, node=node, name=name, type=type, role=st.sampled_from(ActionRole))
    return st.builds(
        InteractionGraph,
        app=st.just("app"),
        ros=st.sampled_from([1, 2]),
        nodes=tuples(nodes, 5, unique_by=lambda each: each.name),
        endpoints=tuples(end, 20),
        services=tuples(st.builds(Service, **side), 3),
        clients=tuples(st.builds(ServiceClient, **side), 3),
        actions=tuples(action, 3),
        parameters=tuples(parameter, 4),
        unresolved=tuples(note, 3),
        wiring=tuples(fact, 4),
    )


NOTE_TEXT = st.sampled_from(["node /a (p/a)", "node /b (p/b)", "include x", "?"])
graphs = graphs_of(
    st.sampled_from(NODES), st.sampled_from(NAMES), st.sampled_from(TYPES), NOTE_TEXT
)
hostile = graphs_of(st.text(max_size=3), st.text(max_size=3), st.text(max_size=3), st.text())


@given(graphs | hostile)
def test_no_graph_breaks_the_rules(graph):
    for finding in find_findings(app_facts(graph)):
        assert all((finding.summary, finding.cause, finding.remedy, finding.fingerprint))


@given(graphs | hostile)
def test_no_graph_breaks_the_inventory(graph):
    movers = take_inventory(app_facts(graph))
    assert all(row.text for mover in movers for row in mover_rows(mover))
    assert all(list(mover_rows(mover)) for mover in movers)
    assert len(inventory_to_json(movers)) == len(movers)


@given(graphs)
def test_the_order_of_a_graph_changes_nothing_in_its_inventory(graph):
    turned = replace(graph, endpoints=graph.endpoints[::-1])
    assert take_inventory(app_facts(turned)) == take_inventory(app_facts(graph))


@given(graphs | hostile)
@example(
    InteractionGraph(
        app="app",
        ros=1,
        wiring=tuple(
            WiringFact(kind=kind, subject="/a", value="p", others=("q",))
            for kind in (
                WiringFactKind.SECTION_WITHOUT_NODE,
                WiringFactKind.MISSPELT_PARAMETER,
                WiringFactKind.UNREAD_PARAMETER,
            )
        ),
    )
)
def test_a_finding_has_an_id_of_its_own(graph):
    ids = [finding.id for finding in find_findings(app_facts(graph))]
    assert len(ids) == len(set(ids))


@given(graphs, st.randoms(use_true_random=False))
def test_the_order_of_the_endpoints_changes_nothing(graph, random):
    ends = list(graph.endpoints)
    random.shuffle(ends)
    turned = replace(graph, endpoints=tuple(ends))
    assert identities(turned) == identities(graph)


def identities(graph):
    return [(each.id, each.severity, each.fingerprint) for each in find_findings(app_facts(graph))]


@given(graphs)
def test_the_worst_comes_first(graph):
    order = ["high", "medium", "low"]
    found = [order.index(finding.severity) for finding in find_findings(app_facts(graph))]
    assert found == sorted(found)


def test_a_huge_name_does_no_harm():
    name = "/" + "detect/goal" * 100_000
    ends = tuple(
        Endpoint(node=name, topic=name + str(direction), type="a/B", direction=direction)
        for direction in Direction
    )
    graph = InteractionGraph(app="", nodes=(Node(name=name, trust=Trust.OWN),), endpoints=ends)
    assert {each.rule for each in find_findings(app_facts(graph))} == {"incomplete_launch"}
