"""A guarded action of ROS 2 in memory: its clients, strangers, and a server that comes and goes."""

import logging

import pytest
from plans import grcn, plan_of
from ros2_action_in_memory import (
    ABORTED,
    ACCEPTED,
    CANCELED,
    EXECUTING,
    INFO,
    ONE,
    SERVER,
    SUCCEEDED,
    TWO,
    TYPE,
    UNKNOWN,
    MemoryActionTransport,
    Reply,
    Ros2ActionApp,
    goal_id,
)

from rtron.guard.action.ros2.endpoints import CancelResponse
from rtron.guard.action.ros2.stream import ObservedActionStream
from rtron.guard.coordinator import Coordinator
from rtron.guard.core.handover_state import HandoverState
from rtron.guard.transport.common.protocol import Peer
from rtron.messages.ros2.actions import GoalMessage
from rtron.policies.goals.status_list import LOST_TIMEOUT
from rtron.vocabulary import SECOND, Mode, PolicyName, Ros2ActionEntity, build_streams


def test_a_goal_that_goes_at_once_is_answered_as_the_server_does():
    app = Ros2ActionApp()
    yes, no = app.send_goal(ONE, 1), None
    assert (app.started(), yes) == ([1], [])
    app.accept(1, stamp=7)
    assert yes == [7]
    app.finish(1)
    no = app.send_goal(ONE, 2)
    app.reject(2)
    assert no == [None]
    assert app.send_goal(TWO, 3) == []
    assert app.started() == [1, 2, 3]


def test_a_goal_that_waits_is_accepted_and_its_result_comes_unchanged():
    app = Ros2ActionApp()
    app.send_goal(ONE, 1)
    (stamp,) = app.send_goal(TWO, 2)
    assert stamp > 0
    assert app.listed() == {2: ACCEPTED}
    waiting, result = app.request_result(TWO, 2), object()
    app.accept(1)
    app.finish(1)
    app.accept(2)
    app.finish(2, SUCCEEDED, result)
    assert waiting == [(SUCCEEDED, result)]
    assert waiting[0][1] is result
    assert app.request_result(TWO, 2) == [(SUCCEEDED, result)]


def test_a_goal_that_waited_and_that_the_server_rejects_is_aborted():
    app = Ros2ActionApp()
    app.send_goal(ONE, 1)
    app.send_goal(TWO, 2)
    app.send_goal(TWO, 3)
    waiting = app.request_result(TWO, 2)
    app.accept(1)
    app.finish(1)
    app.reject(2)
    assert (waiting, app.started()) == ([(ABORTED, None)], [1, 2, 3])
    assert app.listed()[2] == ABORTED


def test_a_goal_that_waited_for_too_long_is_aborted():
    app = Ros2ActionApp(max_age=10 * SECOND)
    app.send_goal(ONE, 1)
    app.send_goal(TWO, 2)
    waiting = app.request_result(TWO, 2)
    app.transport.advance(10 * SECOND - 1)
    assert waiting == []
    app.transport.advance(1)
    assert waiting == [(ABORTED, None)]
    app.accept(1)
    app.finish(1)
    assert app.started() == [1]


def test_goals_that_find_no_room_are_rejected_and_only_those_of_their_flow():
    app = Ros2ActionApp(queue_size=2)
    app.send_goal(ONE, 1)
    for id in (2, 3):
        assert app.send_goal(ONE, id) != [None]
    assert app.send_goal(ONE, 4) == [None]
    assert app.send_goal(TWO, 5) != [None]


def test_an_id_is_used_once():
    app = Ros2ActionApp()
    app.send_goal(ONE, 1)
    assert app.send_goal(ONE, 1) == app.send_goal(TWO, 1) == [None]
    app.accept(1)
    app.finish(1)
    assert app.send_goal(TWO, 1) == [None]
    assert app.started() == [1]


def test_nobody_gets_a_result_but_the_client_and_not_for_ever():
    app = Ros2ActionApp()
    app.send_goal(ONE, 1)
    assert app.request_result(TWO, 1) == app.request_result(ONE, 9) == [(UNKNOWN, None)]
    app.accept(1)
    app.finish(1)
    assert app.request_result(TWO, 1) == [(UNKNOWN, None)]
    app.transport.advance(10 * SECOND - 1)
    assert app.request_result(ONE, 1) == [(SUCCEEDED, "result")]
    app.transport.advance(1)
    assert app.request_result(ONE, 1) == [(UNKNOWN, None)]


def test_so_many_requests_for_a_result_wait():
    app = Ros2ActionApp()
    app.send_goal(ONE, 1)
    waiting = [app.request_result(ONE, 1) for _ in range(9)]
    assert waiting == [[]] * 8 + [[(UNKNOWN, None)]]
    app.accept(1)
    app.finish(1)
    assert waiting[:8] == [[(SUCCEEDED, "result")]] * 8


def test_a_cancel_asks_the_server_for_each_goal_and_lists_those_that_end():
    app = Ros2ActionApp(PolicyName.BLOCK)
    for id in (1, 2):
        app.send_goal(ONE, id)
        app.accept(id)
    app.send_goal(TWO, 3)
    app.accept(3)
    told = app.cancel(ONE)
    assert (told, set(app.endpoints.cancels)) == ([], {(goal_id(1), 0), (goal_id(2), 0)})
    app.endpoints.cancels[goal_id(1), 0](CancelResponse(0, [(goal_id(1), 5)]))
    assert told == []
    app.endpoints.cancels[goal_id(2), 0](CancelResponse(1))
    assert told == [CancelResponse(0, ((goal_id(1), 5),))]


def test_a_cancel_that_the_server_does_not_answer_is_answered():
    app = Ros2ActionApp()
    app.send_goal(ONE, 1)
    app.accept(1)
    told = app.cancel(ONE, 1)
    app.transport.advance(5 * SECOND - 1)
    assert told == []
    app.transport.advance(1)
    assert told == [CancelResponse(1)]


@pytest.mark.parametrize(
    ("id", "stamp", "ended"), [(0, 0, {2, 3}), (2, 0, {2}), (0, 1, set()), (3, 1, {3})]
)
def test_what_a_cancel_means(id, stamp, ended):
    app = Ros2ActionApp()
    app.send_goal(TWO, 1)
    for own in (2, 3):
        app.send_goal(ONE, own)
    (told,) = app.cancel(ONE, id, stamp)
    assert {each[0] for each, _ in told.goals} == ended
    assert told.code == 0
    assert {own for own in (2, 3) if app.request_result(ONE, own) == [(CANCELED, None)]} == ended


def test_a_cancel_of_what_is_not_there_says_so():
    app = Ros2ActionApp()
    app.send_goal(ONE, 1)
    assert app.cancel(TWO, 1) == app.cancel(ONE, 2) == [CancelResponse(2)]
    assert app.cancel(TWO) == [CancelResponse(0)]
    app.accept(1)
    app.finish(1)
    assert app.cancel(ONE, 1) == [CancelResponse(3)]
    assert app.endpoints.cancels == {}


def test_a_cancel_waits_until_the_server_has_the_goal():
    app = Ros2ActionApp()
    app.send_goal(ONE, 1)
    told = app.cancel(ONE)
    assert app.endpoints.cancels == {}
    app.accept(1)
    app.endpoints.cancels[goal_id(1), 0](CancelResponse(0, [(goal_id(1), 5)]))
    assert told == [CancelResponse(0, ((goal_id(1), 5),))]


@pytest.mark.parametrize(
    ("node", "flow", "verified"),
    [
        ("/eve", "unapproved", True),
        ("/eve", "flow1", True),
        (ONE, "flow1", False),
        (TWO, "flow1", True),
    ],
)
def test_strangers_are_shut_out(node, flow, verified):
    app = Ros2ActionApp()
    app.send_goal(ONE, 1)
    app.accept(1)
    assert app.send_goal(node, 2, flow=flow, verified=verified) == [None]
    assert app.cancel(node, flow=flow, verified=verified) == [CancelResponse(1)]
    assert (app.started(), app.endpoints.cancels) == ([1], {})
    assert app.action.pipeline.tallies["unapproved"].dropped == 1


def test_a_strangers_goal_is_not_even_read():
    app, answer, read = Ros2ActionApp(), Reply(), []
    peer = Peer("/eve", INFO, verified=False)
    app.action.on_goal_request("flow1", peer, lambda: read.append(1), answer)
    assert (answer.answers, read) == ([None], [])
    assert app.action.pipeline.tallies["unapproved"].dropped == 1


def test_a_crowd_of_one_strangers_requests_hides_no_other_stranger(caplog):
    app = Ros2ActionApp()
    names = [f"participant {n:024x}" for n in range(3)]
    for name in (*names[:1] * 20, *names[1:]):
        app.send_goal(name, 2, flow="flow1", verified=False)
        app.cancel(name, flow="flow1", verified=False)
    for name in names:
        assert caplog.text.count(f"unapproved client {name} on the private name of flow1") == 1
        assert caplog.text.count(f"{name}: not approved, its cancels are rejected") == 1
    assert app.action.strangers == dict(zip(names, (40, 2, 2), strict=True))


def test_a_stranger_that_the_plan_lets_through_has_goals_of_its_own():
    app = Ros2ActionApp(block_unapproved=False)
    app.send_goal(ONE, 1)
    assert app.send_goal(ONE, 2, flow="unapproved") != [None]
    assert app.cancel(ONE, 2) == [CancelResponse(2)]
    (told,) = app.cancel(ONE, flow="unapproved")
    assert [id for id, _ in told.goals] == [goal_id(2)]
    assert app.endpoints.cancels == {}


def test_without_a_server_goals_are_rejected():
    app = Ros2ActionApp(served=False)
    assert app.send_goal(ONE, 1) == [None]
    app.serve()
    assert app.send_goal(ONE, 2) == []


def test_goals_of_a_server_that_is_gone_are_answered_after_a_while():
    app = Ros2ActionApp()
    first = app.send_goal(ONE, 1)
    app.accept(1)
    app.send_goal(TWO, 2)
    waiting = app.request_result(ONE, 1)
    app.action.on_server_lost()
    app.transport.advance(LOST_TIMEOUT - 1)
    assert (first, waiting) == ([5], [])
    app.transport.advance(1)
    assert waiting == [(ABORTED, None)]
    assert app.started() == [1]
    app.serve(b"second")
    assert app.started() == [1, 2]


def test_a_server_that_is_back_is_asked_again():
    app = Ros2ActionApp()
    app.send_goal(ONE, 1)
    app.accept(1)
    waiting = app.request_result(ONE, 1)
    app.endpoints.results.clear()
    app.action.on_server_lost()
    app.serve()
    app.transport.advance(LOST_TIMEOUT)
    assert waiting == []
    app.finish(1)
    assert waiting == [(SUCCEEDED, "result")]


def test_another_server_knows_none_of_the_goals():
    app = Ros2ActionApp()
    app.send_goal(ONE, 1)
    app.accept(1)
    waiting = app.request_result(ONE, 1)
    app.action.on_server_lost()
    app.serve(b"second")
    assert waiting == [(ABORTED, None)]


def test_a_goal_that_the_server_does_not_know_is_aborted():
    app = Ros2ActionApp()
    app.send_goal(ONE, 1)
    app.accept(1)
    app.send_goal(TWO, 2)
    waiting = app.request_result(ONE, 1)
    app.finish(1, UNKNOWN)
    assert (waiting, app.started()) == ([(ABORTED, None)], [1, 2])


def test_a_goal_that_was_answer_up_and_is_accepted_late_is_cancelled():
    app = Ros2ActionApp()
    answer = app.send_goal(ONE, 1)
    app.action.on_server_lost()
    app.transport.advance(LOST_TIMEOUT)
    app.serve()
    app.accept(1)
    assert answer == [None]
    assert set(app.endpoints.cancels) == {(goal_id(1), 0)}


def test_a_goal_that_was_answered_and_goes_on_is_cancelled():
    app = Ros2ActionApp()
    app.send_goal(ONE, 1)
    app.accept(1)
    app.action.on_server_lost()
    app.transport.advance(LOST_TIMEOUT)
    app.serve()
    app.publish_status((1, EXECUTING))
    assert set(app.endpoints.cancels) == {(goal_id(1), 0)}
    assert app.listed() == {1: ABORTED}


def test_what_was_answered_is_cancelled_at_once_when_the_server_is_back():
    app = Ros2ActionApp(PolicyName.BLOCK)
    app.send_goal(ONE, 1)
    app.accept(1)
    app.send_goal(ONE, 2)
    app.action.on_server_lost()
    app.transport.advance(LOST_TIMEOUT)
    assert app.endpoints.cancels == {}
    app.serve()
    assert set(app.endpoints.cancels) == {(goal_id(1), 0), (goal_id(2), 0)}
    app.endpoints.cancels.clear()
    app.action.on_server_lost()
    app.serve()
    assert app.endpoints.cancels == {}


def test_another_server_is_asked_to_cancel_nothing():
    app = Ros2ActionApp()
    app.send_goal(ONE, 1)
    app.accept(1)
    app.action.on_server_lost()
    app.transport.advance(LOST_TIMEOUT)
    app.serve(b"second")
    app.action.on_server_lost()
    app.serve(b"second")
    assert app.endpoints.cancels == {}


def test_a_goal_goes_on_while_the_server_is_in_doubt_and_no_other_is_sent():
    app = Ros2ActionApp()
    app.send_goal(ONE, 1)
    app.accept(1)
    app.send_goal(TWO, 2)
    waiting, other = app.request_result(ONE, 1), app.request_result(TWO, 2)
    app.doubt()
    assert app.action.details["server"] == SERVER
    assert app.action.details["server in doubt"] == "2 nodes serve it"
    assert app.send_goal(TWO, 3) == [None]
    app.transport.advance(10 * LOST_TIMEOUT)
    assert (waiting, other) == ([], [])
    app.publish_status((1, SUCCEEDED))
    app.finish(1)
    assert (waiting, app.started()) == ([(SUCCEEDED, "result")], [1])
    app.doubt("")
    assert (app.started(), other) == ([1, 2], [])
    assert "server in doubt" not in app.action.details
    app.accept(2)
    app.finish(2)
    app.send_goal(ONE, 4)
    assert app.started() == [1, 2, 4]


def test_a_goal_whose_end_is_told_in_doubt_gets_its_result_in_time():
    app = Ros2ActionApp()
    app.send_goal(ONE, 1)
    app.accept(1)
    waiting = app.request_result(ONE, 1)
    app.doubt()
    app.publish_status((1, CANCELED))
    app.transport.advance(LOST_TIMEOUT)
    assert waiting == [(CANCELED, None)]


@pytest.mark.parametrize("status", [UNKNOWN, SUCCEEDED, ABORTED])
def test_a_result_that_the_server_did_not_tell_is_not_believed_in_doubt(status):
    app = Ros2ActionApp()
    app.send_goal(ONE, 1)
    app.accept(1)
    waiting = app.request_result(ONE, 1)
    app.publish_status((1, EXECUTING))
    app.doubt()
    app.finish(1, status)
    assert waiting == []
    app.endpoints.results.clear()
    app.doubt("")
    app.finish(1)
    assert waiting == [(SUCCEEDED, "result")]


def test_a_no_that_comes_in_doubt_is_followed_by_a_cancel():
    app = Ros2ActionApp()
    answer = app.send_goal(ONE, 1)
    app.doubt()
    app.reject(1)
    assert (answer, set(app.endpoints.cancels)) == ([None], {(goal_id(1), 0)})


def test_goals_wait_although_the_one_in_progress_ends_in_doubt_and_the_server_goes_and_comes():
    app = Ros2ActionApp()
    app.send_goal(ONE, 1)
    app.accept(1)
    app.send_goal(TWO, 2)
    app.doubt()
    app.action.on_server_lost()
    app.serve(b"second")
    assert app.started() == [1]
    app.doubt("")
    assert app.started() == [1, 2]


def test_a_goal_that_is_let_go_in_doubt_is_aborted():
    app = Ros2ActionApp()
    app.send_goal(ONE, 1)
    app.accept(1)
    app.send_goal(TWO, 2)
    waiting = app.request_result(TWO, 2)
    app.doubt()
    app.action.pipeline.finish_action(app.transport.now())
    app.transport.advance(1)
    assert (app.started(), waiting) == ([1], [(ABORTED, None)])


def test_doubt_while_nothing_goes_on_lets_goals_go_afterwards(caplog):
    caplog.set_level(logging.INFO)
    app = Ros2ActionApp()
    app.doubt()
    assert app.send_goal(ONE, 1) == [None]
    assert "of /one: 2 nodes serve it" in caplog.text
    app.doubt("")
    assert app.send_goal(ONE, 2) == []
    assert app.started() == [2]


@pytest.mark.parametrize("accepted", [True, False])
@pytest.mark.parametrize("away", ["in doubt", "gone"])
def test_a_brake_cancels_and_halts_whatever_is_known_of_the_server(away, accepted):
    stopped = []
    app = Ros2ActionApp()
    app.action.stops.on_goal_stopped = lambda node, why: stopped.append((node, why))
    app.send_goal(ONE, 1)
    if accepted:
        app.accept(1)
    if away == "gone":
        app.action.on_server_lost()
    else:
        app.doubt()
    app.action.brake("a test", "a person is there")
    asked = {(goal_id(1), 0)} if accepted or away == "in doubt" else set()
    assert (set(app.endpoints.cancels), stopped) == (asked, [(SERVER, "a person is there")])


def test_who_comes_in_the_place_of_the_server_is_halted_too():
    stopped = []
    app = Ros2ActionApp()
    app.action.stops.on_goal_stopped = lambda node, why: stopped.append((node, why))
    app.send_goal(ONE, 1)
    app.accept(1)
    app.action.brake("a test", "a person is there")
    app.action.on_server_lost()
    app.action.on_server_available("/server2", b"first")
    assert stopped == [(SERVER, "a person is there"), ("/server2", "a person is there")]


def test_the_servers_own_goals_take_the_turn():
    app = Ros2ActionApp()
    app.publish_status((9, EXECUTING))
    assert app.listed() == {9: EXECUTING}
    app.send_goal(ONE, 1)
    assert app.started() == []
    app.publish_status((9, SUCCEEDED))
    assert app.started() == [1]
    app.publish_status((8, EXECUTING))
    app.publish_status()
    app.accept(1)
    app.finish(1)
    app.send_goal(ONE, 2)
    assert app.started() == [1, 2]


def test_the_next_goal_goes_when_the_status_tells_the_end():
    app = Ros2ActionApp()
    app.send_goal(ONE, 1)
    app.accept(1)
    app.send_goal(TWO, 2)
    app.publish_status((7, ABORTED), (1, EXECUTING))
    assert app.started() == [1]
    app.publish_status((1, SUCCEEDED))
    assert app.started() == [1, 2]


def test_a_result_that_does_not_come_is_asked_for_again_and_then_done_without():
    app = Ros2ActionApp()
    app.send_goal(ONE, 1)
    app.accept(1)
    waiting = app.request_result(ONE, 1)
    app.endpoints.results.clear()
    app.publish_status((1, CANCELED))
    app.publish_status((1, CANCELED))
    app.transport.advance(SECOND - 1)
    assert app.endpoints.results == {}
    app.transport.advance(1)
    assert set(app.endpoints.results) == {goal_id(1)}
    app.transport.advance(LOST_TIMEOUT - SECOND - 1)
    assert waiting == []
    app.transport.advance(1)
    assert waiting == [(CANCELED, None)]
    app.finish(1)
    assert waiting == [(CANCELED, None)]


def test_clients_are_told_what_the_server_lists_and_what_waits_here():
    app = Ros2ActionApp()
    app.send_goal(ONE, 1)
    app.accept(1)
    app.send_goal(TWO, 2)
    app.publish_status((1, EXECUTING))
    assert app.listed() == {1: EXECUTING, 2: ACCEPTED}
    app.cancel(TWO, 2)
    assert app.listed() == {1: EXECUTING, 2: CANCELED}
    app.action.on_server_lost()
    app.transport.advance(LOST_TIMEOUT)
    assert app.listed() == {1: ABORTED, 2: CANCELED}
    app.transport.advance(10 * SECOND)
    app.serve()
    assert app.listed() == {}


def test_feedback_goes_to_the_client_and_under_the_public_name():
    app = Ros2ActionApp()
    app.send_goal(TWO, 1)
    app.accept(1)
    message = b"\0\1\0\0" + goal_id(1) + b"more"
    app.action.on_server_message(Ros2ActionEntity.FEEDBACK, message)
    app.finish(1)
    app.action.on_server_message(Ros2ActionEntity.FEEDBACK, message)
    other = b"\0\1\0\0" + goal_id(2)
    app.action.on_server_message(Ros2ActionEntity.FEEDBACK, other)
    app.action.on_server_message(Ros2ActionEntity.FEEDBACK, other[:-1])
    assert app.endpoints.published[Ros2ActionEntity.FEEDBACK] == [(message, ["flow2"])] * 2 + [
        (other, [])
    ]


def test_a_bar_that_rises_cancels_the_goal_once_and_halts_the_server():
    stopped = []
    app = Ros2ActionApp()
    app.action.stops.on_goal_stopped = lambda node, why: stopped.append((node, why))
    app.send_goal(ONE, 1)
    app.action.pipeline.bar("a test", ["flow1"], "an area is closed")
    app.coordinator.recheck()
    assert (app.endpoints.cancels, stopped) == ({}, [(SERVER, "an area is closed")])
    app.accept(1)
    app.coordinator.recheck()
    app.endpoints.cancels.pop((goal_id(1), 0))(CancelResponse(1))
    app.coordinator.recheck()
    assert app.endpoints.cancels == {}
    app.finish(1, CANCELED)
    assert stopped[1:] == [(SERVER, "")]


def test_a_barred_goal_is_aborted_when_its_turn_comes():
    app = Ros2ActionApp()
    app.send_goal(ONE, 1)
    app.accept(1)
    app.send_goal(TWO, 2)
    app.send_goal(ONE, 3)
    waiting = app.request_result(TWO, 2)
    app.action.pipeline.bar("a test", ["flow2"], "an area is closed")
    app.finish(1)
    assert (waiting, app.started()) == ([(ABORTED, None)], [1, 3])


def test_the_next_guard_answers_what_was_asked_of_the_one_before():
    written = []
    app = Ros2ActionApp(handover=HandoverState(write=written.append))
    app.send_goal(ONE, 1)
    app.accept(1)
    app.send_goal(TWO, 2)
    app.request_result(ONE, 1)
    app.request_result(TWO, 2)
    app.transport.advance(SECOND // 100)
    next_app = Ros2ActionApp(handover=HandoverState(written[-1]), served=False)
    next_app.serve(b"another name")
    assert next_app.started() == []
    assert next_app.cancel(TWO, 1) == [CancelResponse(2)]
    next_app.finish(1)
    one, two = (next_app.endpoints.replies[f"{node} {id}"] for node, id in ((ONE, 1), (TWO, 2)))
    assert (one.answers, two.answers) == ([(SUCCEEDED, "result")], [])
    next_app.transport.advance(3 * SECOND)
    assert two.answers == [(ABORTED, None)]
    next_app.send_goal(TWO, 3)
    assert next_app.started() == [3]


def handed_over():
    """Return the documents of a guard that ended while a client waited for its goal's result."""
    written = []
    app = Ros2ActionApp(handover=HandoverState(write=written.append))
    app.send_goal(ONE, 1)
    app.accept(1)
    app.request_result(ONE, 1)
    app.transport.advance(SECOND // 100)
    return written


def test_an_answer_that_ends_with_its_guard_is_given_by_the_one_after():
    written = handed_over()
    second = Ros2ActionApp(handover=HandoverState(written[-1], written.append))
    lost = second.endpoints.replies[f"{ONE} 1"]
    lost.is_reachable = False
    second.finish(1)
    second.publish_status((1, SUCCEEDED))
    second.transport.advance(5 * SECOND)
    assert lost.answers == []
    third = Ros2ActionApp(handover=HandoverState(written[-1]))
    third.finish(1)
    assert third.endpoints.replies[f"{ONE} 1"].answers == [(SUCCEEDED, "result")]


def test_a_result_waits_for_its_client_and_is_given_once():
    written = handed_over()
    second = Ros2ActionApp(handover=HandoverState(written[-1]))
    reply = second.endpoints.replies[f"{ONE} 1"]
    reply.is_reachable = False
    second.finish(1)
    second.publish_status((1, SUCCEEDED))
    second.transport.advance(2 * SECOND - 1)
    reply.is_reachable = True
    second.transport.advance(SECOND)
    assert reply.answers == [(SUCCEEDED, "result")]
    second.send_goal(TWO, 2)
    assert second.started() == [2]


def test_the_next_guard_gives_up_on_a_server_that_it_does_not_find():
    written = handed_over()
    next_app = Ros2ActionApp(handover=HandoverState(written[-1]), served=False)
    next_app.transport.advance(10 * SECOND - 1)
    assert next_app.endpoints.replies[f"{ONE} 1"].answers == []
    next_app.transport.advance(1)
    assert next_app.endpoints.replies[f"{ONE} 1"].answers == [(ABORTED, None)]


def test_a_dry_run_lets_all_pass_and_counts():
    app = Ros2ActionApp(dry_run=True)
    answers = [
        app.send_goal(ONE, 1),
        app.send_goal(TWO, 2),
        app.send_goal("/eve", 3, flow="unapproved"),
    ]
    assert app.started() == [1, 2, 3]
    for id in (1, 2, 3):
        app.accept(id)
    assert answers == [[5], [5], [5]]
    told = app.cancel("/eve", flow="unapproved")
    app.endpoints.cancels[goal_id(0), 0](CancelResponse(0, [(goal_id(1), 5)]))
    assert told == [CancelResponse(0, [(goal_id(1), 5)])]
    tallies = app.action.pipeline.tallies
    assert (tallies["flow1"].passed, tallies["flow2"].held, tallies["unapproved"].dropped) == (
        1,
        1,
        1,
    )
    waiting = app.request_result(TWO, 2)
    app.finish(1)
    app.finish(2)
    assert waiting == [(SUCCEEDED, "result")]


def test_an_action_that_is_only_observed_stays_between_client_and_server():
    plan = plan_of(grcn("/go", [ONE], [SERVER], type=TYPE, mode=Mode.OBSERVE), ros=2)
    transport = MemoryActionTransport()
    coordinator = Coordinator(transport, build_streams(plan))
    coordinator.open()
    assert isinstance(coordinator.streams[0], ObservedActionStream)
    assert not hasattr(transport, "endpoints")


def test_a_goal_knows_its_id():
    goal = GoalMessage.of(b"id", b"goal")
    assert (goal, goal.id) == (b"goal", b"id")
