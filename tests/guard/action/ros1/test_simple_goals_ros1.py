"""Goals without an id, in ROS 1: followed to the goal that appears next, in memory."""

from ros1_action_in_memory import (
    ONE,
    POSE,
    RESULT,
    SERVER,
    STATUSES,
    TWO,
    SimpleGoalApp,
    active,
    framed,
    simple_stream,
    status_message,
)

from rtron.guard.coordinator import Coordinator
from rtron.guard.transport.common.memory import MemoryTransport
from rtron.guard.transport.common.protocol import Peer
from rtron.messages.ros1.actions import (
    PREEMPTED,
    SUCCEEDED,
    GoalID,
    GoalStatus,
    read_cancel,
    result_message,
)
from rtron.vocabulary import SECOND


def test_a_goal_without_an_id_is_done_when_the_goal_is_that_appeared_next():
    app = SimpleGoalApp()
    app.publish_pose(ONE, b"first")
    app.publish_pose(TWO, b"second")
    app.serve(*active(b"s1"))
    app.finish(b"another")
    assert app.simple == [b"first"]
    app.finish(b"s1")
    assert app.simple == [b"first", b"second"]
    app.serve(GoalStatus(GoalID(b"s1", 0), SUCCEEDED), *active(b"s2"))
    assert app.simple == [b"first", b"second"]


def test_an_action_waits_while_a_goal_without_an_id_is_in_progress():
    app = SimpleGoalApp()
    app.publish_pose(ONE, b"first")
    app.serve(*active(b"s1"))
    app.send_goal(ONE, b"a")
    assert app.started() == []
    app.finish(b"s1")
    assert app.started() == [b"a"]


def test_a_goal_without_an_id_waits_for_an_action():
    app = SimpleGoalApp()
    app.send_goal(ONE, b"a")
    app.publish_pose(ONE, b"first")
    assert app.simple == []
    app.finish(b"a")
    assert app.simple == [b"first"]


def test_a_client_s_goal_that_is_refused_is_not_the_pose_s():
    app = SimpleGoalApp()
    app.publish_pose(ONE, b"first")
    app.publish_pose(TWO, b"second")
    app.send_goal("/rogue", b"a")
    assert app.simple == [b"first"]
    app.serve(*active(b"s1"))
    app.finish(b"s1")
    assert app.simple == [b"first", b"second"]


def test_a_pose_that_becomes_no_goal_holds_up_nobody():
    app = SimpleGoalApp()
    app.publish_pose(ONE, b"first")
    app.publish_pose(TWO, b"second")
    app.send_goal(ONE, b"a")
    app.transport.advance(5 * SECOND - 1)
    assert (app.simple, app.started()) == ([b"first"], [])
    app.transport.advance(1)
    assert (app.simple, app.started()) == ([b"first", b"second"], [])
    app.transport.advance(5 * SECOND)
    assert app.started() == [b"a"]


def test_a_followed_goal_that_is_cancelled_gives_its_turn_to_the_next():
    app = SimpleGoalApp()
    app.publish_pose(ONE, b"first")
    app.publish_pose(TWO, b"second")
    app.serve(*active(b"s1"))
    app.coordinator.streams[1].pipeline.bar("a test", ["flow1"], "an area is closed")
    app.coordinator.recheck()
    app.finish(b"s1", PREEMPTED)
    assert app.simple == [b"first", b"second"]


def test_a_block_cancels_the_goal_that_was_followed():
    app = SimpleGoalApp()
    app.publish_pose(ONE, b"first")
    app.serve(*active(b"s1"))
    app.coordinator.streams[1].pipeline.bar("a test", ["flow1"], "an area is closed")
    app.coordinator.recheck()
    app.coordinator.recheck()
    assert [read_cancel(message).id for message in app.cancels] == [b"s1"]


def test_without_a_guarded_action_the_public_topics_tell():
    transport = MemoryTransport()
    coordinator = Coordinator(transport, [simple_stream()])
    coordinator.open()
    out, cancels = transport.listen("/rtron/act_simple/goal/out"), transport.listen("/act/cancel")
    give = transport.publisher("/rtron/act_simple/goal/flow1", Peer(ONE, POSE))
    tell = transport.publisher("/act/status", Peer(SERVER, STATUSES))
    end = transport.publisher("/act/result", Peer(SERVER, RESULT))
    tell(status_message(*active(b"old")))
    give(b"first")
    give(b"second")
    tell(status_message(*active(b"old", b"s1")))
    end(result_message(0, GoalStatus(GoalID(b"old", 0), SUCCEEDED), b""))
    tell(framed(bytes(3)))
    assert out == [b"first"]
    tell(status_message(GoalStatus(GoalID(b"s1", 0), SUCCEEDED)))
    assert out == [b"first", b"second"]
    end(result_message(0, GoalStatus(GoalID(b"quick", 0), SUCCEEDED), b""))
    give(b"third")
    assert out == [b"first", b"second", b"third"]
    tell(status_message(*active(b"s3")))
    coordinator.streams[0].pipeline.bar("a test", ["flow1"], "an area is closed")
    coordinator.recheck()
    assert [read_cancel(message).id for message in cancels] == [b"s3"]
