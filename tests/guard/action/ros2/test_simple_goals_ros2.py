"""Poses in ROS 2 that a server makes a goal of its own of: followed to that goal, in memory."""

import pytest
from plans import grcn, plan_of
from ros2_action_in_memory import (
    ABORTED,
    ACCEPTED,
    CANCELED,
    EXECUTING,
    ONE,
    SERVER,
    SUCCEEDED,
    TWO,
    TYPE,
    MemoryActionTransport,
    Ros2ActionApp,
    goal_id,
)

from rtron.guard.coordinator import Coordinator
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

    def goal_canceller(self, node, action):
        return lambda goal: self.cancelled.append((node, action, goal))


class Poses:
    """Poses of two nodes to the server of an action that has no guard."""

    def __init__(self, *, dry_run=False, served=True, **settings):
        self.transport = MemoryCancelTransport()
        plan = plan_of(pose_grcn(**settings), ros=2)
        self.coordinator = Coordinator(self.transport, build_streams(plan), dry_run=dry_run)
        self.coordinator.open()
        (self.stream,) = self.coordinator.streams
        self.out = self.transport.listen(OUT)
        self._tell = None
        if served:
            self.serve()

    def serve(self, node=SERVER, **more):
        status = ros2_entity_name("/go", Ros2ActionEntity.STATUS)
        self._tell = self.transport.publisher(status, Peer(node, STATUSES, **more))

    def publish_pose(self, node, pose):
        topic = {ONE: "/rtron/goal_pose/flow1", TWO: "/rtron/goal_pose/flow2"}[node]
        self.transport.publisher(topic, Peer(node, POSE))(pose)

    def publish_status(self, *statuses):
        self._tell(status_array(GoalStatus(goal_id(id), 5, status) for id, status in statuses))

    def block(self):
        self.stream.pipeline.bar("a test", ["flow1"], "an area is closed")
        self.coordinator.recheck()


@pytest.mark.parametrize("end", [SUCCEEDED, CANCELED, ABORTED])
def test_a_pose_is_done_when_the_goal_is_that_appeared_next(end):
    poses = Poses()
    poses.publish_status((9, EXECUTING))
    poses.publish_pose(ONE, b"first")
    poses.publish_pose(TWO, b"second")
    assert poses.out == [b"first"]
    poses.publish_status((9, SUCCEEDED), (1, ACCEPTED))
    poses.publish_status((9, SUCCEEDED), (1, EXECUTING))
    assert poses.out == [b"first"]
    poses.publish_status((9, SUCCEEDED), (1, end))
    assert poses.out == [b"first", b"second"]
    poses.publish_status((9, SUCCEEDED), (1, end))
    assert poses.out == [b"first", b"second"]


def test_a_goal_that_is_over_when_it_appears_is_done():
    poses = Poses()
    poses.publish_pose(ONE, b"first")
    poses.publish_pose(TWO, b"second")
    poses.publish_status((1, SUCCEEDED))
    assert poses.out == [b"first", b"second"]


def test_a_pose_that_becomes_no_goal_holds_up_nobody():
    poses = Poses()
    poses.publish_pose(ONE, b"first")
    poses.publish_pose(TWO, b"second")
    poses.transport.advance(5 * SECOND - 1)
    assert poses.out == [b"first"]
    poses.transport.advance(1)
    assert poses.out == [b"first", b"second"]


@pytest.mark.parametrize("more", [{"node": "/eve"}, {"verified": False}])
def test_nobody_else_s_status_counts(more):
    poses = Poses(served=False)
    poses.serve(**more)
    poses.publish_pose(ONE, b"first")
    poses.publish_pose(TWO, b"second")
    poses.publish_status((1, EXECUTING))
    poses.publish_status((1, SUCCEEDED))
    poses.transport.advance(59 * SECOND)
    assert poses.out == [b"first"]


def test_what_cannot_be_read_ends_nothing():
    poses = Poses()
    poses.publish_pose(ONE, b"first")
    poses.publish_pose(TWO, b"second")
    for garbage in (b"", b"\0\1\0\0", b"\0\1\0\0\xff\xff\xff\xff", b"\0\7\0\0" + bytes(40)):
        poses._tell(garbage)
    assert poses.out == [b"first"]


def test_a_topic_may_tell_the_end_too_and_is_not_answer_up():
    """A `done` that is a topic has no status, so no goal is missed."""
    poses = Poses(served=False)
    say = poses.transport.publisher(
        "/go", Peer(SERVER, standard_info("std_msgs/Bool", Encoding.CDR))
    )
    poses.publish_pose(ONE, b"first")
    poses.publish_pose(TWO, b"second")
    poses.transport.advance(30 * SECOND)
    assert poses.out == [b"first"]
    say(b"\0\1\0\0\1")
    assert poses.out == [b"first", b"second"]


def test_a_block_cancels_the_goal_that_was_followed_once():
    poses = Poses()
    poses.publish_pose(ONE, b"first")
    poses.publish_status((1, EXECUTING))
    poses.block()
    poses.coordinator.recheck()
    assert poses.transport.cancelled == [("/rtron/grcn_goal_pose", "/go", goal_id(1))]


@pytest.mark.parametrize("more", [{"dry_run": True}, {"mode": Mode.OBSERVE}])
def test_who_only_looks_cancels_nothing(more):
    poses = Poses(**more)
    if "mode" in more:
        poses.transport.publisher("/goal_pose", Peer(ONE, POSE))(b"first")
    else:
        poses.publish_pose(ONE, b"first")
    poses.publish_status((1, EXECUTING))
    poses.block()
    assert poses.transport.cancelled == []


class ActionAndPoses(Ros2ActionApp):
    """A guarded action whose server takes poses, too, under a guard of their own."""

    def __init__(self, **poses):
        made = {"type": TYPE} | GOALS
        self.plan = plan_of(pose_grcn(**poses), grcn("/go", [ONE, TWO], [SERVER], **made), ros=2)
        self.transport = MemoryActionTransport(Encoding.CDR)
        self.coordinator = Coordinator(self.transport, build_streams(self.plan))
        self.coordinator.open()
        self.poses, self.action = self.coordinator.streams
        self.endpoints = self.transport.endpoints
        self.out = self.transport.listen(OUT)
        self.serve()

    publish_pose = Poses.publish_pose


def test_an_action_waits_while_a_pose_is_in_progress():
    app = ActionAndPoses()
    app.publish_pose(ONE, b"first")
    app.send_goal(ONE, 1)
    app.publish_status((9, EXECUTING))
    assert app.started() == []
    app.publish_status((9, SUCCEEDED))
    assert app.started() == [1]


def test_a_pose_waits_for_an_action_and_goes_before_its_next_goal():
    app = ActionAndPoses()
    app.send_goal(ONE, 1)
    app.accept(1)
    app.send_goal(TWO, 2)
    app.publish_pose(ONE, b"first")
    assert (app.out, app.started()) == ([], [1])
    app.finish(1)
    assert (app.out, app.started()) == ([b"first"], [1])
    app.publish_status((9, EXECUTING))
    app.publish_status((9, SUCCEEDED))
    assert app.started() == [1, 2]


def test_of_a_pose_and_a_goal_that_wait_for_a_pose_the_pose_goes_first():
    app = ActionAndPoses()
    app.publish_pose(ONE, b"first")
    app.publish_status((9, EXECUTING))
    app.send_goal(ONE, 1)
    app.publish_pose(TWO, b"second")
    app.publish_status((9, SUCCEEDED))
    assert (app.out, app.started()) == ([b"first", b"second"], [])
    app.publish_status((9, SUCCEEDED), (8, EXECUTING))
    app.publish_status((9, SUCCEEDED), (8, SUCCEEDED))
    assert app.started() == [1]


def test_a_client_s_goal_that_is_refused_is_not_the_pose_s():
    app = ActionAndPoses()
    app.action.pipeline.bar("a test", ["flow2"], "an area is closed")
    app.publish_pose(ONE, b"first")
    app.publish_pose(TWO, b"second")
    assert app.send_goal(TWO, 1) == [None]
    assert app.out == [b"first"]
    app.publish_status((9, EXECUTING))
    app.publish_status((9, SUCCEEDED))
    assert app.out == [b"first", b"second"]


def test_a_pose_that_becomes_no_goal_gives_the_turn_to_the_action():
    app = ActionAndPoses()
    app.publish_pose(ONE, b"first")
    app.publish_pose(TWO, b"second")
    app.send_goal(ONE, 1)
    app.transport.advance(5 * SECOND)
    assert (app.out, app.started()) == ([b"first", b"second"], [])
    app.transport.advance(5 * SECOND - 1)
    assert app.started() == []
    app.transport.advance(1)
    assert app.started() == [1]


def test_a_block_cancels_the_pose_s_goal_at_the_guarded_action():
    app = ActionAndPoses()
    app.publish_pose(ONE, b"first")
    app.publish_status((9, EXECUTING))
    app.poses.pipeline.bar("a test", ["flow1"], "an area is closed")
    app.coordinator.recheck()
    assert list(app.endpoints.cancels) == [(goal_id(9), 0)]


def test_poses_that_are_only_observed_hold_up_no_action():
    app = ActionAndPoses(mode=Mode.OBSERVE)
    app.transport.publisher("/goal_pose", Peer(ONE, POSE))(b"first")
    app.send_goal(ONE, 1)
    assert app.started() == [1]


def test_a_server_that_comes_back_frees_both():
    app = ActionAndPoses()
    app.publish_pose(ONE, b"first")
    app.publish_status((9, EXECUTING))
    app.publish_pose(TWO, b"second")
    app.action.on_server_lost()
    app.transport.advance(SECOND)
    app.serve(b"second life")
    app.transport.advance(SECOND)
    assert app.out == [b"first", b"second"]
