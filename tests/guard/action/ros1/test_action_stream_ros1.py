"""A guarded action of ROS 1 in memory: whose goals go, wait, are cancelled and answered."""

import struct

import pytest
from plans import grcn, plan_of
from ros1_action_in_memory import (
    CANCEL,
    GOAL,
    GOAL_TYPE,
    ONE,
    RESULT,
    SERVER,
    STATUSES,
    TWO,
    Ros1ActionApp,
    active,
    cancel_of,
    framed,
    goal_message,
)
from streams import stage, stream

from rtron.guard.core.handover_state import HandoverState
from rtron.guard.core.message_types import standard_info
from rtron.guard.replay.player import RecordingPlayer
from rtron.guard.replay.recorded_streams import RecordedStream
from rtron.guard.transport.common.protocol import Peer
from rtron.messages.common.encoding import Encoding
from rtron.messages.ros1.actions import (
    ABORTED,
    ACTIVE,
    PENDING,
    PREEMPTED,
    RECALLED,
    REJECTED,
    SUCCEEDED,
    GoalID,
    GoalStatus,
    cancel_message,
    read_cancel,
    read_goal,
    result_message,
)
from rtron.policies.goals.registry import ID_REUSE_DELAY, MAX_GOALS
from rtron.policies.goals.status_list import LOST_TIMEOUT, UNREAD_TIMEOUT
from rtron.vocabulary import SECOND, Flow, OnSilence, PolicyName, StreamKind


@pytest.fixture
def app():
    app = Ros1ActionApp()
    app.serve()
    return app


def test_one_goal_at_a_time_and_who_waits_is_pending(app):
    app.send_goal(ONE, b"a")
    app.send_goal(TWO, b"b")
    assert app.started() == [b"a"]
    assert app.listed() == {b"a": PENDING, b"b": PENDING}
    app.serve(*active(b"a"))
    assert app.listed() == {b"a": ACTIVE, b"b": PENDING}
    app.finish(b"a")
    assert app.started() == [b"a", b"b"]
    assert app.answers() == [(b"a", SUCCEEDED)]


def test_a_terminal_status_lets_the_next_go_and_the_result_is_still_handed_on(app):
    app.send_goal(ONE, b"a")
    app.send_goal(TWO, b"b")
    app.serve(GoalStatus(GoalID(b"a", 0), SUCCEEDED))
    assert app.started() == [b"a", b"b"]
    app.finish(b"a")
    assert app.started() == [b"a", b"b"]
    assert app.answers() == [(b"a", SUCCEEDED)]


def test_another_goals_end_does_not_end_the_turn(app):
    app.send_goal(ONE, b"a")
    app.send_goal(TWO, b"b")
    app.finish(b"stranger")
    app.serve(*active(b"a"), GoalStatus(GoalID(b"stranger", 0), SUCCEEDED))
    assert app.started() == [b"a"]


def test_results_come_once(app):
    app.send_goal(ONE, b"a")
    app.finish(b"a")
    app.finish(b"a", ABORTED)
    assert app.answers() == [(b"a", SUCCEEDED)]


def test_a_result_waits_for_a_client_that_does_not_hear_the_guard_yet(app):
    app.send_goal(ONE, b"a")
    app.transport.unreachable.add(ONE)
    app.finish(b"a")
    app.transport.advance(SECOND)
    assert app.answers() == []
    app.transport.unreachable.remove(ONE)
    app.transport.advance(SECOND // 50)
    assert app.answers() == [(b"a", SUCCEEDED)]


def test_a_result_of_a_client_that_stays_away_is_sent_once(app):
    app.send_goal(ONE, b"a")
    app.transport.unreachable.add(ONE)
    app.finish(b"a")
    app.transport.advance(3 * SECOND)
    app.transport.unreachable.remove(ONE)
    app.transport.advance(SECOND)
    assert app.answers() == [(b"a", SUCCEEDED)]


def test_results_of_clients_that_stay_away_are_bounded(app):
    app.transport.unreachable.add(ONE)
    ids = [b"%d" % number for number in range(65)]
    for id in ids:
        app.send_goal(ONE, id)
        app.finish(id)
    assert app.answers() == [(ids[0], SUCCEEDED)]


def test_a_blocked_flow_is_rejected_with_the_reason(app):
    app.send_goal("/rogue", b"a")
    assert app.answers() == [(b"a", REJECTED)]
    assert app.started() == []
    assert app.listed() == {b"a": REJECTED}
    assert b"flow3 is blocked" in app.results[0]


def test_a_stranger_is_not_heard_and_not_answered(app):
    app.send_goal(ONE, b"a")
    app.send_goal("/stranger", b"b")
    app.cancel("/stranger", b"a")
    app.cancel("/stranger")
    assert app.started() == [b"a"]
    assert (app.cancels, app.answers()) == ([], [])


def test_a_stranger_that_may_speak_touches_only_its_own(app):
    app = Ros1ActionApp(block_unapproved=False)
    app.serve()
    app.send_goal(ONE, b"a")
    app.send_goal("/stranger", b"b")
    app.send_goal("/other", b"c")
    app.cancel("/stranger")
    assert app.answers() == [(b"b", RECALLED)]
    assert app.cancels == []


def test_cancels_touch_only_their_own_goals(app):
    app.send_goal(ONE, b"a")
    app.send_goal(TWO, b"b")
    app.cancel(TWO, b"a")
    app.cancel(TWO)
    assert (app.cancels, app.answers()) == ([], [(b"b", RECALLED)])
    app.cancel(ONE)
    assert [read_cancel(message) for message in app.cancels] == [GoalID(b"a", 0)]


@pytest.mark.parametrize(("stamp", "gone"), [(4, []), (5, [b"b"]), (7, [b"b", b"c"])])
def test_a_cancel_with_a_stamp_means_what_came_before(app, stamp, gone):
    app.send_goal(ONE, b"a", stamp=1)
    app.send_goal(TWO, b"b", stamp=5)
    app.send_goal(TWO, b"c", stamp=7)
    app.cancel(TWO, stamp=stamp)
    assert [id for id, _ in app.answers()] == gone


def test_a_cancel_may_come_before_its_goal(app):
    app.cancel(TWO, b"a")
    app.cancel(ONE, b"b")
    app.send_goal(ONE, b"a")
    app.send_goal(ONE, b"b")
    assert app.started() == [b"a"]
    assert app.answers() == [(b"b", RECALLED)]


def test_a_cancel_is_not_remembered_for_ever(app):
    app.cancel(ONE, b"a")
    app.transport.advance(ID_REUSE_DELAY)
    app.send_goal(ONE, b"a")
    assert app.started() == [b"a"]


def test_cancelled_goals_leave_their_room_to_others():
    app = Ros1ActionApp(queue_size=1)
    app.serve()
    app.send_goal(ONE, b"a")
    app.send_goal(ONE, b"b")
    app.send_goal(ONE, b"c")
    assert app.answers() == [(b"c", REJECTED)]
    app.cancel(ONE, b"b")
    app.send_goal(ONE, b"d")
    app.send_goal(TWO, b"e")
    app.finish(b"a")
    assert app.started() == [b"a", b"d"]
    app.serve()
    over = {b"a": SUCCEEDED, b"b": RECALLED, b"c": REJECTED}
    assert app.listed() == over | {b"d": PENDING, b"e": PENDING}


def test_the_id_of_anothers_goal_is_not_taken(app):
    app.send_goal(ONE, b"a")
    app.send_goal(TWO, b"a")
    app.finish(b"a")
    app.send_goal(TWO, b"a")
    assert app.started() == [b"a"]
    assert app.answers() == [(b"a", SUCCEEDED)]


def test_an_id_may_be_used_again_by_its_client(app):
    for _ in range(2):
        app.send_goal(ONE, b"a")
        app.finish(b"a")
        app.transport.advance(ID_REUSE_DELAY)
    assert app.started() == [b"a", b"a"]


@pytest.mark.parametrize(("latching", "runs"), [(True, 1), (False, 2)])
def test_a_latched_goal_does_not_run_again_over_a_new_connection(app, latching, runs):
    for _ in range(2):
        say = app.transport.publisher("/rtron/act/goal/flow1", Peer(ONE, GOAL, latching))
        say(goal_message(b"a"))
        app.finish(b"a")
        app.transport.advance(ID_REUSE_DELAY)
    assert app.started() == [b"a"] * runs


def test_an_empty_id_gets_a_name(app):
    app.send_goal(ONE, b"")
    app.send_goal(ONE, b"")
    (id,) = app.started()
    assert id.startswith(b"/rtron/grcn_act-1-")
    app.finish(id)
    assert len(set(app.started())) == 2


@pytest.mark.parametrize(("length", "started"), [(1024, 1), (1025, 0)])
def test_a_huge_id_is_dropped(app, length, started):
    app.send_goal(ONE, b"a" * length)
    assert len(app.started()) == started


@pytest.mark.parametrize(
    "body", [b"", bytes(15), bytes(16 + 8), bytes(16 + 8) + b"\xff\xff\xff\x7f"]
)
def test_what_is_no_goal_is_dropped(app, body):
    app.publish("/rtron/act/goal/flow1", ONE, GOAL, framed(body))
    app.publish("/rtron/act/cancel/flow1", ONE, CANCEL, framed(body[:5]))
    app.send_goal(ONE, b"a")
    assert app.started() == [b"a"]


def test_without_a_server_goals_are_rejected():
    app = Ros1ActionApp()
    app.send_goal(ONE, b"a")
    assert (app.started(), app.statuses) == ([], [])


@pytest.mark.parametrize("deaf", [True, False])
def test_clients_see_the_server_once_it_hears_the_guard(deaf):
    app = Ros1ActionApp()
    if deaf:
        app.transport.unreachable.add(SERVER)
    app.serve()
    assert (app.statuses == []) == deaf
    app.send_goal(ONE, b"a")
    assert app.answers() == ([(b"a", REJECTED)] if deaf else [])


def test_goals_are_aborted_when_their_server_is_gone(app):
    app.send_goal(ONE, b"a")
    app.serve(*active(b"a"))
    app.transport.leave("/rtron/act/status/server", Peer(SERVER, STATUSES))
    app.transport.advance(LOST_TIMEOUT - 1)
    assert app.answers() == []
    app.transport.advance(1)
    assert app.answers() == [(b"a", ABORTED)]
    app.finish(b"a")
    assert app.answers() == [(b"a", ABORTED)]


def test_goals_are_aborted_when_a_new_server_does_not_know_them(app):
    app.send_goal(ONE, b"a")
    app.send_goal(TWO, b"b")
    app.serve(*active(b"a"))
    app.transport.advance(LOST_TIMEOUT)
    app.serve()
    assert app.answers() == [(b"a", ABORTED)]
    assert app.started() == [b"a", b"b"]


def test_a_goal_that_a_busy_server_has_still_to_read_is_not_answered_for_it(app):
    app.send_goal(ONE, b"a")
    app.transport.advance(UNREAD_TIMEOUT - 1)
    app.serve()
    assert app.answers() == []
    app.serve(*active(b"a"))
    app.finish(b"a")
    assert app.answers() == [(b"a", SUCCEEDED)]


def test_a_goal_that_a_server_never_lists_is_aborted(app):
    app.send_goal(ONE, b"a")
    app.transport.advance(UNREAD_TIMEOUT)
    app.serve()
    assert app.answers() == [(b"a", ABORTED)]


def test_a_result_that_does_not_come_is_made_good_from_the_status(app):
    app.send_goal(ONE, b"a")
    over = GoalStatus(GoalID(b"a", 0), SUCCEEDED)
    app.serve(over)
    app.transport.advance(LOST_TIMEOUT - 1)
    app.serve(over)
    assert app.answers() == []
    app.transport.advance(1)
    app.serve(over)
    assert app.answers() == [(b"a", SUCCEEDED)]
    app.finish(b"a")
    assert app.answers() == [(b"a", SUCCEEDED)]


def test_a_goal_that_was_answered_for_a_lost_server_is_cancelled_when_it_is_back(app):
    app.send_goal(ONE, b"a")
    app.serve(*active(b"a"))
    app.transport.leave("/rtron/act/status/server", Peer(SERVER, STATUSES))
    app.transport.advance(LOST_TIMEOUT)
    app.transport.publisher("/rtron/act/status/server", Peer(SERVER, STATUSES))
    assert app.answers() == [(b"a", ABORTED)]
    app.serve(*active(b"a"))
    assert [read_cancel(message).id for message in app.cancels] == [b"a"]


def test_a_goal_that_waited_too_long_is_recalled():
    app = Ros1ActionApp(max_age=SECOND)
    app.serve()
    app.send_goal(ONE, b"a")
    app.send_goal(TWO, b"b")
    app.transport.advance(SECOND)
    assert app.answers() == [(b"b", RECALLED)]
    app.finish(b"a")
    assert app.started() == [b"a"]


def test_a_goal_that_a_rule_refuses_when_its_turn_comes_holds_up_nobody():
    app = Ros1ActionApp()
    app.serve()
    for node, id in ((ONE, b"a"), (TWO, b"b"), (ONE, b"c")):
        app.send_goal(node, id)
    app.action.pipeline.policies[0].observe_done(0)
    app.action.pipeline.bar("a rule", ["flow2"], "an area is closed")
    app.finish(b"a")
    app.transport.advance(0)
    assert app.started() == [b"a", b"c"]
    assert (b"b", RECALLED) in app.answers()


def test_goals_wait_for_a_server_that_is_gone(app):
    app.send_goal(ONE, b"a")
    app.send_goal(TWO, b"b")
    app.transport.leave("/rtron/act/status/server", Peer(SERVER, STATUSES))
    app.transport.advance(LOST_TIMEOUT)
    assert (app.answers(), app.started()) == ([(b"a", ABORTED)], [b"a"])
    app.transport.advance(SECOND)
    app.reconnect_server()
    app.serve()
    assert app.started() == [b"a", b"b"]


def test_goals_go_on_when_a_server_is_back_that_has_one_of_its_own(app):
    app.send_goal(ONE, b"a")
    app.send_goal(TWO, b"b")
    app.serve(*active(b"a"))
    app.transport.leave("/rtron/act/status/server", Peer(SERVER, STATUSES))
    app.reconnect_server()
    app.serve(*active(b"s1"))
    assert app.started() == [b"a"]
    app.serve(GoalStatus(GoalID(b"s1", 0), SUCCEEDED))
    assert app.started() == [b"a", b"b"]


def test_goals_reach_the_server_in_the_order_of_their_stamps(app):
    app.send_goal(ONE, b"a", stamp=5)
    app.send_goal(TWO, b"b", stamp=3)
    app.send_goal(ONE, b"c", stamp=7)
    app.finish(b"a")
    app.finish(b"b")
    assert [read_goal(message).stamp for message in app.to_server] == [5, 5, 7]


def test_a_goal_that_is_over_stays_listed_until_its_result_has_surely_come(app):
    app.send_goal(ONE, b"a")
    app.serve(*active(b"a"))
    app.finish(b"a")
    app.serve()
    assert app.listed() == {b"a": SUCCEEDED}
    app.transport.advance(ID_REUSE_DELAY)
    app.serve()
    assert app.listed() == {}


def test_goals_that_are_not_over_are_bounded():
    app = Ros1ActionApp(queue_size=2000)
    app.serve()
    for number in range(MAX_GOALS + 1):
        app.send_goal(ONE, b"%d" % number)
    assert app.answers() == [(b"%d" % MAX_GOALS, REJECTED)]


def test_the_highest_goes_next():
    app = Ros1ActionApp(PolicyName.PRIORITY_QUEUE)
    app.serve()
    for id in (b"a", b"b"):
        app.send_goal(ONE, id)
    app.send_goal(TWO, b"c")
    app.finish(b"a")
    app.finish(b"c")
    assert app.started() == [b"a", b"c", b"b"]


def test_a_goal_of_the_servers_own_has_the_turn(app):
    app.serve(*active(b"/server-1"))
    app.send_goal(ONE, b"a")
    assert app.started() == []
    app.serve(GoalStatus(GoalID(b"/server-1", 0), PREEMPTED))
    assert app.started() == [b"a"]


DRIVING = Flow(name="flow1", publisher=SERVER, priority=1, on_silence=OnSilence.RELEASE)


def test_a_block_that_rises_cancels_the_goal_and_stops_what_it_moves():
    velocity = stream(stage(flows=(DRIVING,)), flows=(DRIVING,))
    app = Ros1ActionApp(PolicyName.FIFO_QUEUE, velocity)
    app.serve()
    app.send_goal(ONE, b"a")
    app.serve(*active(b"a"))
    twist = standard_info("geometry_msgs/Twist", Encoding.ROS1)
    driver = app.transport.listen("/rtron/cmd_vel/out")
    go = framed(struct.pack("<6d", 1, 0, 0, 0, 0, 0))
    app.publish("/rtron/cmd_vel/flow1", SERVER, twist, go)
    app.action.pipeline.bar("a test", ["flow1"], "an area is closed")
    app.coordinator.recheck()
    assert [read_cancel(message).id for message in app.cancels] == [b"a"]
    app.publish("/rtron/cmd_vel/flow1", SERVER, twist, go)
    app.transport.advance(2 * SECOND)
    assert driver.count(go) == 1
    assert driver[-1] == framed(bytes(48))
    app.finish(b"a", PREEMPTED)
    app.publish("/rtron/cmd_vel/flow1", SERVER, twist, go)
    assert driver[-1] == go
    assert len(app.cancels) == 1


def test_the_next_guard_knows_whose_goals_there_are():
    written = []
    app = Ros1ActionApp(handover=HandoverState(write=written.append))
    app.serve()
    app.send_goal(ONE, b"a")
    app.send_goal(TWO, b"b")
    app.transport.advance(SECOND // 100)
    next_app = Ros1ActionApp(handover=HandoverState(written[-1]))
    next_app.serve(*active(b"a"))
    assert next_app.listed() == {b"a": ACTIVE, b"b": PENDING}
    next_app.send_goal(ONE, b"c")
    next_app.cancel(TWO)
    assert (next_app.started(), next_app.cancels) == ([], [])
    next_app.cancel(ONE, b"a")
    assert [read_cancel(message).id for message in next_app.cancels] == [b"a"]
    next_app.transport.advance(3 * SECOND)
    assert (b"b", RECALLED) in next_app.answers()
    next_app.finish(b"a", PREEMPTED)
    assert next_app.started() == [b"c"]


def test_a_recording_of_the_app_without_a_guard_is_judged_as_a_whole():
    app = Ros1ActionApp()
    goal, cancel, result = (
        RecordedStream(f"/act/{part}", info.type, info.md5sum, info.definition, node)
        for part, info, node in (
            ("goal", GOAL, ONE),
            ("cancel", CANCEL, ONE),
            ("result", RESULT, SERVER),
        )
    )
    rows = [
        (goal, goal_message(b"a")),
        (goal, goal_message(b"b")),
        (goal, goal_message(b"c")),
        (cancel, cancel_of(b"b")),
        (result, result_message(0, GoalStatus(GoalID(b"a", 0), SUCCEEDED), bytes(8))),
    ]
    flows = tuple(app.stream.flows[:1])
    settings = {"type": GOAL_TYPE, "kind": StreamKind.ACTION, "policy": PolicyName.FIFO_QUEUE}
    plan = plan_of(grcn("/act/goal", (), [SERVER], flows=flows, max_age=60 * SECOND, **settings))
    found = RecordingPlayer(plan).play(((n, *row) for n, row in enumerate(rows)), lambda _: None)
    ((count, _),) = (stream.flows for stream in found.streams)
    assert (count.passed, count.held, count.dropped) == (2, 2, 1)


def test_a_goal_that_was_answered_is_not_again_by_the_next_guard():
    written = []
    app = Ros1ActionApp(handover=HandoverState(write=written.append))
    app.serve()
    app.send_goal(ONE, b"a")
    app.transport.advance(SECOND)
    app.finish(b"a")
    next_app = Ros1ActionApp(handover=HandoverState(written[-1]))
    next_app.serve()
    next_app.transport.advance(LOST_TIMEOUT)
    next_app.serve()
    next_app.finish(b"a")
    assert next_app.answers() == []


def test_the_next_guard_knows_the_stamp_of_the_last_goal():
    written = []
    app = Ros1ActionApp(handover=HandoverState(write=written.append))
    app.serve()
    app.send_goal(ONE, b"a", stamp=9 * SECOND)
    app.finish(b"a")
    next_app = Ros1ActionApp(handover=HandoverState(written[-1]))
    next_app.serve()
    next_app.send_goal(ONE, b"b", stamp=5 * SECOND)
    assert read_goal(next_app.to_server[0]).stamp == 9 * SECOND


def test_a_cancel_message_means_one_goal():
    assert read_cancel(cancel_message(b"x")) == GoalID(b"x", 0)
