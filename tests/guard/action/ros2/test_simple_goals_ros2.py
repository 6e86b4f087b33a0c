"""Poses in ROS 2 that a server makes a goal of its own of: followed to that goal, in memory."""

import pytest
from plans import grcn, plan_of
from test_action_stream_ros2 import (
    ABORTED,
    ACCEPTED,
    CANCELED,
    EXECUTING,
    ONE,
    SERVER,
    SUCCEEDED,
    TWO,
    TYPE,
    Act,
    MemoryActionTransport,
    of,
)

from rtron.guard.core.coordinator import Coordinator
from rtron.guard.core.message_types import standard_info
from rtron.guard.transport.common.memory import MemoryTransport
from rtron.guard.transport.common.protocol import Peer
from rtron.messages.common.encoding import Encoding
from rtron.messages.ros2.actions import GoalStatus, status_array
from rtron.vocabulary import (
    SECOND,
    Mode,
    PolicyName,
    Ros2ActionEntity,
    StreamKind,
    build_streams,
    ros2_entity_name,
)

POSE = standard_info("geometry_msgs/PoseStamped", Encoding.CDR)
STATUSES = standard_info("action_msgs/GoalStatusArray", Encoding.CDR)
OUT = "/rtron/goal_pose/out"
GOALS = {"kind": StreamKind.ACTION, "policy": PolicyName.FIFO_QUEUE, "max_age": 60 * SECOND}


def pose_grcn(**more):
    settings = {"type": "geometry_msgs/msg/PoseStamped", "done": "/go"} | GOALS | more
    return grcn("/goal_pose", [ONE, TWO], [SERVER], **settings)


class MemoryCancelTransport(MemoryTransport):
    """A transport in memory on which goals of an action without a guard can be cancelled."""

    def __init__(self):
        super().__init__(Encoding.CDR)
        self.cancelled = []

    def canceller(self, node, action):
        return lambda goal: self.cancelled.append((node, action, goal))


class Poses:
    """Poses of two nodes to the server of an action that has no guard."""

    def __init__(self, *, dry_run=False, served=True, **settings):
        self.transport = MemoryCancelTransport()
        plan = plan_of(pose_grcn(**settings), ros=2)
        self.host = Coordinator(self.transport, build_streams(plan), dry_run=dry_run)
        self.host.open()
        (self.stream,) = self.host.streams
        self.out = self.transport.listen(OUT)
        self._tell = None
        if served:
            self.serve()

    def serve(self, node=SERVER, **more):
        status = ros2_entity_name("/go", Ros2ActionEntity.STATUS)
        self._tell = self.transport.publisher(status, Peer(node, STATUSES, **more))

    def give(self, node, pose):
        topic = {ONE: "/rtron/goal_pose/flow1", TWO: "/rtron/goal_pose/flow2"}[node]
        self.transport.publisher(topic, Peer(node, POSE))(pose)

    def tell(self, *statuses):
        self._tell(status_array(GoalStatus(of(id), 5, status) for id, status in statuses))

    def block(self):
        self.stream.pipeline.bar("a test", ["flow1"], "an area is closed")
        self.host.recheck()


@pytest.mark.parametrize("end", [SUCCEEDED, CANCELED, ABORTED])
def test_a_pose_is_done_when_the_goal_is_that_appeared_next(end):
    poses = Poses()
    poses.tell((9, EXECUTING))
    poses.give(ONE, b"first")
    poses.give(TWO, b"second")
    assert poses.out == [b"first"]
    poses.tell((9, SUCCEEDED), (1, ACCEPTED))
    poses.tell((9, SUCCEEDED), (1, EXECUTING))
    assert poses.out == [b"first"]
    poses.tell((9, SUCCEEDED), (1, end))
    assert poses.out == [b"first", b"second"]
    poses.tell((9, SUCCEEDED), (1, end))
    assert poses.out == [b"first", b"second"]


def test_a_goal_that_is_over_when_it_appears_is_done():
    poses = Poses()
    poses.give(ONE, b"first")
    poses.give(TWO, b"second")
    poses.tell((1, SUCCEEDED))
    assert poses.out == [b"first", b"second"]


def test_a_pose_that_becomes_no_goal_holds_up_nobody():
    poses = Poses()
    poses.give(ONE, b"first")
    poses.give(TWO, b"second")
    poses.transport.advance(5 * SECOND - 1)
    assert poses.out == [b"first"]
    poses.transport.advance(1)
    assert poses.out == [b"first", b"second"]


@pytest.mark.parametrize("more", [{"node": "/eve"}, {"verified": False}])
def test_nobody_else_s_status_counts(more):
    poses = Poses(served=False)
    poses.serve(**more)
    poses.give(ONE, b"first")
    poses.give(TWO, b"second")
    poses.tell((1, EXECUTING))
    poses.tell((1, SUCCEEDED))
    poses.transport.advance(59 * SECOND)
    assert poses.out == [b"first"]


def test_what_cannot_be_read_ends_nothing():
    poses = Poses()
    poses.give(ONE, b"first")
    poses.give(TWO, b"second")
    for garbage in (b"", b"\0\1\0\0", b"\0\1\0\0\xff\xff\xff\xff", b"\0\7\0\0" + bytes(40)):
        poses._tell(garbage)
    assert poses.out == [b"first"]


def test_a_topic_may_tell_the_end_too_and_is_not_given_up():
    """A `done` that is a topic has no status, so no goal is missed."""
    poses = Poses(served=False)
    say = poses.transport.publisher(
        "/go", Peer(SERVER, standard_info("std_msgs/Bool", Encoding.CDR))
    )
    poses.give(ONE, b"first")
    poses.give(TWO, b"second")
    poses.transport.advance(30 * SECOND)
    assert poses.out == [b"first"]
    say(b"\0\1\0\0\1")
    assert poses.out == [b"first", b"second"]


def test_a_block_cancels_the_goal_that_was_followed_once():
    poses = Poses()
    poses.give(ONE, b"first")
    poses.tell((1, EXECUTING))
    poses.block()
    poses.host.recheck()
    assert poses.transport.cancelled == [("/rtron/grcn_goal_pose", "/go", of(1))]


@pytest.mark.parametrize("more", [{"dry_run": True}, {"mode": Mode.OBSERVE}])
def test_who_only_looks_cancels_nothing(more):
    poses = Poses(**more)
    if "mode" in more:
        poses.transport.publisher("/goal_pose", Peer(ONE, POSE))(b"first")
    else:
        poses.give(ONE, b"first")
    poses.tell((1, EXECUTING))
    poses.block()
    assert poses.transport.cancelled == []


class Both(Act):
    """A guarded action whose server takes poses, too, under a guard of their own."""

    def __init__(self, **poses):
        made = {"type": TYPE} | GOALS
        self.plan = plan_of(pose_grcn(**poses), grcn("/go", [ONE, TWO], [SERVER], **made), ros=2)
        self.transport = MemoryActionTransport(Encoding.CDR)
        self.host = Coordinator(self.transport, build_streams(self.plan))
        self.host.open()
        self.poses, self.action = self.host.streams
        self.ends = self.transport.ends
        self.out = self.transport.listen(OUT)
        self.serve()

    give = Poses.give


def test_an_action_waits_while_a_pose_is_in_progress():
    both = Both()
    both.give(ONE, b"first")
    both.ask(ONE, 1)
    both.tell((9, EXECUTING))
    assert both.started() == []
    both.tell((9, SUCCEEDED))
    assert both.started() == [1]


def test_a_pose_waits_for_an_action_and_goes_before_its_next_goal():
    both = Both()
    both.ask(ONE, 1)
    both.accept(1)
    both.ask(TWO, 2)
    both.give(ONE, b"first")
    assert (both.out, both.started()) == ([], [1])
    both.finish(1)
    assert (both.out, both.started()) == ([b"first"], [1])
    both.tell((9, EXECUTING))
    both.tell((9, SUCCEEDED))
    assert both.started() == [1, 2]


def test_of_a_pose_and_a_goal_that_wait_for_a_pose_the_pose_goes_first():
    both = Both()
    both.give(ONE, b"first")
    both.tell((9, EXECUTING))
    both.ask(ONE, 1)
    both.give(TWO, b"second")
    both.tell((9, SUCCEEDED))
    assert (both.out, both.started()) == ([b"first", b"second"], [])
    both.tell((9, SUCCEEDED), (8, EXECUTING))
    both.tell((9, SUCCEEDED), (8, SUCCEEDED))
    assert both.started() == [1]


def test_a_client_s_goal_that_is_refused_is_not_the_pose_s():
    both = Both()
    both.action.pipeline.bar("a test", ["flow2"], "an area is closed")
    both.give(ONE, b"first")
    both.give(TWO, b"second")
    assert both.ask(TWO, 1) == [None]
    assert both.out == [b"first"]
    both.tell((9, EXECUTING))
    both.tell((9, SUCCEEDED))
    assert both.out == [b"first", b"second"]


def test_a_pose_that_becomes_no_goal_gives_the_turn_to_the_action():
    both = Both()
    both.give(ONE, b"first")
    both.give(TWO, b"second")
    both.ask(ONE, 1)
    both.transport.advance(5 * SECOND)
    assert (both.out, both.started()) == ([b"first", b"second"], [])
    both.transport.advance(5 * SECOND - 1)
    assert both.started() == []
    both.transport.advance(1)
    assert both.started() == [1]


def test_a_block_cancels_the_pose_s_goal_at_the_guarded_action():
    both = Both()
    both.give(ONE, b"first")
    both.tell((9, EXECUTING))
    both.poses.pipeline.bar("a test", ["flow1"], "an area is closed")
    both.host.recheck()
    assert list(both.ends.cancels) == [(of(9), 0)]


def test_poses_that_are_only_observed_hold_up_no_action():
    both = Both(mode=Mode.OBSERVE)
    both.transport.publisher("/goal_pose", Peer(ONE, POSE))(b"first")
    both.ask(ONE, 1)
    assert both.started() == [1]


def test_a_server_that_comes_back_frees_both():
    both = Both()
    both.give(ONE, b"first")
    both.tell((9, EXECUTING))
    both.give(TWO, b"second")
    both.action.on_server_lost()
    both.transport.advance(SECOND)
    both.serve(b"second life")
    both.transport.advance(SECOND)
    assert both.out == [b"first", b"second"]
