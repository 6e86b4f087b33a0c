"""From what a domain told to a graph, and when it has told enough: strangers included."""

import pytest

pytest.importorskip("rclpy", reason="needs ROS 2")

from hypothesis import given
from hypothesis import strategies as st

from rtron.planning.proposal.policy_defaults import unguardable_topics
from rtron.risks import discover_risks
from rtron.sources.graph_json import graph_to_json
from rtron.sources.live.ros2.actions import action_member
from rtron.sources.live.ros2.domain import Snapshot
from rtron.sources.live.ros2.source import discover_graph, graph_of_snapshot
from rtron.vocabulary import ActionRole, Direction, QoS
from rtron.wire.ros2.endpoints import Ros2Endpoint, Ros2ServiceEndpoint

pytestmark = pytest.mark.ros2
TWIST = "geometry_msgs/msg/Twist"
HERE, THERE = bytes(range(12)), bytes(range(1, 13))


def end(node, topic, mark, type=TWIST, hash="h", participant=HERE):
    return Ros2Endpoint(
        topic=topic,
        direction=Direction.PUBLISH if mark == ">" else Direction.SUBSCRIBE,
        node=node,
        type=type,
        type_hash=hash,
        gid=participant + bytes(4),
        qos=QoS(),
    )


def side(node, service, type, *, serves):
    return Ros2ServiceEndpoint(
        service=service, is_server=serves, node=node, type=type, gid=HERE + bytes(4)
    )


def told(graph):
    return {each.what: each.why for each in graph.unresolved}


def test_an_endpoint_of_nobody_is_told_and_counts_as_a_publisher():
    ends = (end("", "/cmd_vel", ">"), end("/a", "/cmd_vel", ">", participant=THERE))
    seen = Snapshot(nodes=("/a", "/b"), endpoints=(*ends, end("/b", "/cmd_vel", "<")))
    graph = graph_of_snapshot(seen)
    name = f"{{participant {HERE.hex()}}}"
    assert told(graph)[name].startswith("has 1 endpoints and does not say whose")
    report = discover_risks(graph)
    assert "GR-ST:/cmd_vel" in {risk.id for risk in report.risks}
    assert [p.location for p in unguardable_topics(graph, report)] == [name]


def test_one_type_in_two_definitions_is_told():
    ends = (end("/a", "/t", ">", hash="x"), end("/b", "/t", "<", hash="y"))
    assert "2 definitions here: /a, /b" in told(graph_of_snapshot(Snapshot(endpoints=ends)))["/t"]
    unknown = (end("/a", "/t", ">", hash="x"), end("/b", "/t", "<", hash=""))
    assert told(graph_of_snapshot(Snapshot(endpoints=unknown))) == {}


def test_many_types_are_told_in_short():
    ends = tuple(end(f"/n{n}", "/t", ">", type=f"a/msg/B{n}") for n in range(100))
    why = told(graph_of_snapshot(Snapshot(endpoints=ends)))["/t"]
    assert why.startswith("has 100 types")
    assert why.endswith("and 92 more")


@pytest.mark.parametrize(
    ("name", "type", "action"),
    [
        ("/go/_action/feedback", "p/action/Go_FeedbackMessage", "/go"),
        ("/go/_action/status", "action_msgs/msg/GoalStatusArray", "/go"),
        ("/go/_action/send_goal", "p/action/Go_SendGoal", "/go"),
        ("/go/_action/get_result", "p/action/Go_GetResult", "/go"),
        ("/go/_action/cancel_goal", "action_msgs/srv/CancelGoal", "/go"),
        ("/go/_action/feedback", TWIST, None),
        ("/go/_action/status", "p/action/Go_FeedbackMessage", None),
        ("/go/_action/send_goal", "p/srv/Go_SendGoal", None),
        ("/_action/feedback", "p/action/Go_FeedbackMessage", None),
        ("/go/_action/x/feedback", "p/action/Go_FeedbackMessage", None),
        ("/go/feedback", "p/action/Go_FeedbackMessage", None),
        ("", "", None),
    ],
)
def test_what_is_a_part_of_an_action(name, type, action):
    part = action_member(name, type)
    assert (part.action if part else None) == action


def test_who_only_cancels_or_only_tells_is_a_side_too():
    services = (side("/c", "/go/_action/cancel_goal", "action_msgs/srv/CancelGoal", serves=False),)
    ends = (end("/liar", "/go/_action/feedback", ">", type="p/action/Go_FeedbackMessage"),)
    graph = graph_of_snapshot(Snapshot(endpoints=ends, services=services))
    assert [(a.node, a.role, a.type) for a in graph.actions] == [
        ("/c", ActionRole.CLIENT, "p/action/Go"),
        ("/liar", ActionRole.SERVER, "p/action/Go"),
    ]
    assert (graph.endpoints, graph.services) == ((), ())


def test_two_types_of_one_action_are_told():
    services = (
        side("/a", "/go/_action/send_goal", "p/action/Go_SendGoal", serves=True),
        side("/b", "/go/_action/send_goal", "p/action/Stop_SendGoal", serves=False),
    )
    graph = graph_of_snapshot(Snapshot(services=services))
    assert "p/action/Go (/a), p/action/Stop (/b)" in told(graph)["/go"]


NAMES = st.text(max_size=12) | st.sampled_from(
    ["/a", "/go/_action/status", "/\x1b[31m", "/ a", "/go/_action/send_goal", "", "/_action/"]
)
TYPES = NAMES | st.sampled_from([TWIST, "action_msgs/msg/GoalStatusArray", "p/action/Go_SendGoal"])
ENDS = st.builds(end, NAMES, NAMES, st.sampled_from("<>"), TYPES, NAMES, st.binary(max_size=16))
SIDES = st.builds(side, NAMES, NAMES, TYPES, serves=st.booleans())


@given(st.lists(NAMES), st.lists(ENDS, max_size=20), st.lists(SIDES, max_size=20))
def test_whatever_they_are_called_there_is_a_graph(nodes, ends, sides):
    seen = Snapshot(nodes=tuple(nodes), endpoints=tuple(ends), services=tuple(sides))
    graph = graph_of_snapshot(seen)
    assert graph_to_json(graph)["schema"] == "rtron.graph/1"
    discover_risks(graph)
    parts = [e for e in ends if not action_member(e.topic, e.type)]
    assert len(graph.endpoints) >= len(parts)


class SnapshotSequence:
    """Stands for a domain: tells one snapshot after the other, the last for ever."""

    def __init__(self, *snapshots):
        self.left = list(snapshots)
        self.snapshots = 0

    def fingerprint(self):
        return len(self.left)

    def snapshot(self, timeout):
        self.snapshots += 1
        return self.left.pop(0) if len(self.left) > 1 else self.left[0]


@pytest.fixture
def quick(monkeypatch):
    monkeypatch.setattr("rtron.sources.live.ros2.source.MIN_DISCOVERY_S", 0.0)
    monkeypatch.setattr("rtron.sources.live.ros2.source._POLL_S", 0.0)


WHOLE = Snapshot(nodes=("/a",), endpoints=(end("/a", "/t", ">"),))
NAMELESS = Snapshot(nodes=("/a",), endpoints=(end("", "/t", ">"),))


@pytest.mark.usefixtures("quick")
@pytest.mark.parametrize(
    "before", [[], [Snapshot()], [Snapshot(), Snapshot()], [NAMELESS, NAMELESS], [NAMELESS]]
)
def test_it_waits_for_two_looks_that_agree_with_all_names(before):
    found = discover_graph(SnapshotSequence(*before, WHOLE), 60.0)
    assert (found.snapshot, found.is_stable) == (WHOLE, True)


@pytest.mark.usefixtures("quick")
@pytest.mark.parametrize("last", [Snapshot(), NAMELESS])
def test_it_does_not_wait_for_ever(last):
    assert discover_graph(SnapshotSequence(last), 0.05).snapshot == last


def test_a_graph_that_changes_to_the_end_is_not_still():
    changing = (Snapshot(nodes=(f"/n{n}",)) for n in range(1000))
    assert not discover_graph(SnapshotSequence(*changing), 0.1).is_stable
