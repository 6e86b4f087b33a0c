"""A guarded action of ROS 2 in memory: clients, a stranger and a server that only say and hear."""

import logging
from collections import defaultdict

import pytest
from plans import grcn, plan_of

from rtron.guard.action.ros2.endpoints import CancelResponse, GoalMessage
from rtron.guard.action.ros2.stream import ObservedActionStream
from rtron.guard.core.coordinator import Coordinator
from rtron.guard.core.handover_state import HandoverState
from rtron.guard.transport.common.memory import MemoryTransport
from rtron.guard.transport.common.protocol import Peer, TypeInfo
from rtron.messages.common.encoding import Encoding
from rtron.messages.ros2.actions import GoalStatus, read_statuses, status_array
from rtron.policies.goals.status_list import LOST_TIMEOUT
from rtron.vocabulary import SECOND, Mode, PolicyName, Ros2ActionEntity, StreamKind, build_streams

TYPE = "demo_msgs/action/Go"
INFO = TypeInfo("demo_msgs/Go_Goal", "0" * 32)
ONE, TWO, SERVER = "/one", "/two", "/server"
FLOW = {ONE: "flow1", TWO: "flow2"}
UNKNOWN, ACCEPTED, EXECUTING, CANCELING, SUCCEEDED, CANCELED, ABORTED = range(7)


class Answer:
    """The place of a request: what was answered there."""

    def __init__(self, token=""):
        self.token = token
        self.given = []

    def __call__(self, *given):
        self.given.append(given if len(given) > 1 else given[0])


class MemoryActionEndpoints:
    """Keeps what the guard asks of the server, for a test to answer, and what clients are told."""

    info = INFO

    def __init__(self, hears):
        self.hears = hears
        self.goals, self.cancels, self.results = {}, {}, {}
        self.told = defaultdict(list)
        self.places = {}

    def open(self):
        pass

    def send_goal(self, goal, answered):
        assert goal.id not in self.goals
        self.goals[goal.id] = answered

    def cancel(self, id, stamp, answered):
        self.cancels[id, stamp] = answered

    def get_result(self, id, answered):
        self.results[id] = answered

    def tell(self, end, message, flows=None):
        self.told[end].append((message, flows))

    def place(self, token):
        return self.places.setdefault(token, Answer(token))


class MemoryActionTransport(MemoryTransport):
    """A transport in memory that carries requests."""

    encoding = Encoding.CDR

    def action_ends(self, _stream, _node, hears):
        self.ends = MemoryActionEndpoints(hears)
        return self.ends


class Act:
    """A guarded action with two clients, by default with its server."""

    def __init__(
        self, policy=PolicyName.FIFO_QUEUE, *, will=None, served=True, dry_run=False, **settings
    ):
        made = {"type": TYPE, "kind": StreamKind.ACTION, "policy": policy, "max_age": 60 * SECOND}
        self.plan = plan_of(grcn("/go", [ONE, TWO], [SERVER], **made | settings), ros=2)
        self.transport = MemoryActionTransport()
        self.host = Coordinator(
            self.transport, build_streams(self.plan), handover=will, dry_run=dry_run
        )
        self.host.open()
        (self.action,) = self.host.streams
        self.ends = self.transport.ends
        if served:
            self.serve()

    def doubt(self, why="2 nodes serve it"):
        self.action.on_server_doubt(why)

    def serve(self, incarnation=b"first"):
        self.action.on_server_available(SERVER, incarnation)

    def ask(self, node, id, *, flow="", verified=True, goal=b"\0\1\0\0goal"):
        """Send a goal; return the answers."""
        answer = Answer()
        peer = Peer(node, INFO, verified=verified)
        message = GoalMessage.of(of(id), goal)
        self.action.on_goal_request(flow or FLOW[node], peer, lambda: message, answer)
        return answer.given

    def want(self, node, id, *, flow=""):
        """Ask for a result; return the answers."""
        answer = Answer(f"{node} {id}")
        self.action.on_result_request(flow or FLOW[node], Peer(node, INFO), of(id), answer)
        return answer.given

    def cancel(self, node, id=0, stamp=0, *, flow="", verified=True):
        """Send a cancel; return the answers as (code, ids)."""
        answer = Answer()
        peer = Peer(node, INFO, verified=verified)
        self.action.on_cancel_request(flow or FLOW[node], peer, of(id), stamp, answer)
        return answer.given

    def accept(self, id, stamp=5):
        self.ends.goals[of(id)](stamp)

    def reject(self, id):
        self.ends.goals[of(id)](None)

    def finish(self, id, status=SUCCEEDED, result="result"):
        self.ends.results[of(id)](status, result)

    def tell(self, *statuses):
        told = status_array(GoalStatus(of(id), 5, status) for id, status in statuses)
        self.action.on_server_message(Ros2ActionEntity.STATUS, told)

    def started(self):
        return [id[0] for id in self.ends.goals]

    def listed(self):
        """Return the states that clients were told last."""
        self.transport.advance(SECOND // 10)
        message, flows = self.ends.told[Ros2ActionEntity.STATUS][-1]
        assert flows is None
        return {told.id[0]: told.status for told in read_statuses(message)}


def of(id):
    return bytes([id]) * 16 if id else bytes(16)


def test_a_goal_that_goes_at_once_is_answered_as_the_server_does():
    act = Act()
    yes, no = act.ask(ONE, 1), None
    assert (act.started(), yes) == ([1], [])
    act.accept(1, stamp=7)
    assert yes == [7]
    act.finish(1)
    no = act.ask(ONE, 2)
    act.reject(2)
    assert no == [None]
    assert act.ask(TWO, 3) == []
    assert act.started() == [1, 2, 3]


def test_a_goal_that_waits_is_accepted_and_its_result_comes_unchanged():
    act = Act()
    act.ask(ONE, 1)
    (stamp,) = act.ask(TWO, 2)
    assert stamp > 0
    assert act.listed() == {2: ACCEPTED}
    waiting, result = act.want(TWO, 2), object()
    act.accept(1)
    act.finish(1)
    act.accept(2)
    act.finish(2, SUCCEEDED, result)
    assert waiting == [(SUCCEEDED, result)]
    assert waiting[0][1] is result
    assert act.want(TWO, 2) == [(SUCCEEDED, result)]


def test_a_goal_that_waited_and_that_the_server_rejects_is_aborted():
    act = Act()
    act.ask(ONE, 1)
    act.ask(TWO, 2)
    act.ask(TWO, 3)
    waiting = act.want(TWO, 2)
    act.accept(1)
    act.finish(1)
    act.reject(2)
    assert (waiting, act.started()) == ([(ABORTED, None)], [1, 2, 3])
    assert act.listed()[2] == ABORTED


def test_a_goal_that_waited_for_too_long_is_aborted():
    act = Act(max_age=10 * SECOND)
    act.ask(ONE, 1)
    act.ask(TWO, 2)
    waiting = act.want(TWO, 2)
    act.transport.advance(10 * SECOND - 1)
    assert waiting == []
    act.transport.advance(1)
    assert waiting == [(ABORTED, None)]
    act.accept(1)
    act.finish(1)
    assert act.started() == [1]


def test_goals_that_find_no_room_are_rejected_and_only_those_of_their_flow():
    act = Act(queue_size=2)
    act.ask(ONE, 1)
    for id in (2, 3):
        assert act.ask(ONE, id) != [None]
    assert act.ask(ONE, 4) == [None]
    assert act.ask(TWO, 5) != [None]


def test_an_id_is_used_once():
    act = Act()
    act.ask(ONE, 1)
    assert act.ask(ONE, 1) == act.ask(TWO, 1) == [None]
    act.accept(1)
    act.finish(1)
    assert act.ask(TWO, 1) == [None]
    assert act.started() == [1]


def test_nobody_gets_a_result_but_the_client_and_not_for_ever():
    act = Act()
    act.ask(ONE, 1)
    assert act.want(TWO, 1) == act.want(ONE, 9) == [(UNKNOWN, None)]
    act.accept(1)
    act.finish(1)
    assert act.want(TWO, 1) == [(UNKNOWN, None)]
    act.transport.advance(10 * SECOND - 1)
    assert act.want(ONE, 1) == [(SUCCEEDED, "result")]
    act.transport.advance(1)
    assert act.want(ONE, 1) == [(UNKNOWN, None)]


def test_so_many_requests_for_a_result_wait():
    act = Act()
    act.ask(ONE, 1)
    waiting = [act.want(ONE, 1) for _ in range(9)]
    assert waiting == [[]] * 8 + [[(UNKNOWN, None)]]
    act.accept(1)
    act.finish(1)
    assert waiting[:8] == [[(SUCCEEDED, "result")]] * 8


def test_a_cancel_asks_the_server_for_each_goal_and_lists_those_that_end():
    act = Act(PolicyName.BLOCK)
    for id in (1, 2):
        act.ask(ONE, id)
        act.accept(id)
    act.ask(TWO, 3)
    act.accept(3)
    told = act.cancel(ONE)
    assert (told, set(act.ends.cancels)) == ([], {(of(1), 0), (of(2), 0)})
    act.ends.cancels[of(1), 0](CancelResponse(0, [(of(1), 5)]))
    assert told == []
    act.ends.cancels[of(2), 0](CancelResponse(1))
    assert told == [CancelResponse(0, ((of(1), 5),))]


def test_a_cancel_that_the_server_does_not_answer_is_answered():
    act = Act()
    act.ask(ONE, 1)
    act.accept(1)
    told = act.cancel(ONE, 1)
    act.transport.advance(5 * SECOND - 1)
    assert told == []
    act.transport.advance(1)
    assert told == [CancelResponse(1)]


@pytest.mark.parametrize(
    ("id", "stamp", "ended"),
    [(0, 0, {2, 3}), (2, 0, {2}), (0, 1, set()), (3, 1, {3})],
)
def test_what_a_cancel_means(id, stamp, ended):
    act = Act()
    act.ask(TWO, 1)
    for own in (2, 3):
        act.ask(ONE, own)
    (told,) = act.cancel(ONE, id, stamp)
    assert {each[0] for each, _ in told.goals} == ended
    assert told.code == 0
    assert {own for own in (2, 3) if act.want(ONE, own) == [(CANCELED, None)]} == ended


def test_a_cancel_of_what_is_not_there_says_so():
    act = Act()
    act.ask(ONE, 1)
    assert act.cancel(TWO, 1) == act.cancel(ONE, 2) == [CancelResponse(2)]
    assert act.cancel(TWO) == [CancelResponse(0)]
    act.accept(1)
    act.finish(1)
    assert act.cancel(ONE, 1) == [CancelResponse(3)]
    assert act.ends.cancels == {}


def test_a_cancel_waits_until_the_server_has_the_goal():
    act = Act()
    act.ask(ONE, 1)
    told = act.cancel(ONE)
    assert act.ends.cancels == {}
    act.accept(1)
    act.ends.cancels[of(1), 0](CancelResponse(0, [(of(1), 5)]))
    assert told == [CancelResponse(0, ((of(1), 5),))]


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
    act = Act()
    act.ask(ONE, 1)
    act.accept(1)
    assert act.ask(node, 2, flow=flow, verified=verified) == [None]
    assert act.cancel(node, flow=flow, verified=verified) == [CancelResponse(1)]
    assert (act.started(), act.ends.cancels) == ([1], {})
    assert act.action.pipeline.tallies["unapproved"].dropped == 1


def test_a_strangers_goal_is_not_even_read():
    act, answer, read = Act(), Answer(), []
    peer = Peer("/eve", INFO, verified=False)
    act.action.on_goal_request("flow1", peer, lambda: read.append(1), answer)
    assert (answer.given, read) == ([None], [])
    assert act.action.pipeline.tallies["unapproved"].dropped == 1


def test_a_crowd_of_one_strangers_requests_hides_no_other_stranger(caplog):
    act = Act()
    names = [f"participant {n:024x}" for n in range(3)]
    for name in (*names[:1] * 20, *names[1:]):
        act.ask(name, 2, flow="flow1", verified=False)
        act.cancel(name, flow="flow1", verified=False)
    for name in names:
        assert caplog.text.count(f"unapproved client {name} on the private name of flow1") == 1
        assert caplog.text.count(f"{name}: not approved, its cancels are rejected") == 1
    assert act.action.strangers == dict(zip(names, (40, 2, 2), strict=True))


def test_a_stranger_that_the_plan_lets_through_has_goals_of_its_own():
    act = Act(block_unapproved=False)
    act.ask(ONE, 1)
    assert act.ask(ONE, 2, flow="unapproved") != [None]
    assert act.cancel(ONE, 2) == [CancelResponse(2)]
    (told,) = act.cancel(ONE, flow="unapproved")
    assert [id for id, _ in told.goals] == [of(2)]
    assert act.ends.cancels == {}


def test_without_a_server_goals_are_rejected():
    act = Act(served=False)
    assert act.ask(ONE, 1) == [None]
    act.serve()
    assert act.ask(ONE, 2) == []


def test_goals_of_a_server_that_is_gone_are_answered_after_a_while():
    act = Act()
    first = act.ask(ONE, 1)
    act.accept(1)
    act.ask(TWO, 2)
    waiting = act.want(ONE, 1)
    act.action.on_server_lost()
    act.transport.advance(LOST_TIMEOUT - 1)
    assert (first, waiting) == ([5], [])
    act.transport.advance(1)
    assert waiting == [(ABORTED, None)]
    assert act.started() == [1]
    act.serve(b"second")
    assert act.started() == [1, 2]


def test_a_server_that_is_back_is_asked_again():
    act = Act()
    act.ask(ONE, 1)
    act.accept(1)
    waiting = act.want(ONE, 1)
    act.ends.results.clear()
    act.action.on_server_lost()
    act.serve()
    act.transport.advance(LOST_TIMEOUT)
    assert waiting == []
    act.finish(1)
    assert waiting == [(SUCCEEDED, "result")]


def test_another_server_knows_none_of_the_goals():
    act = Act()
    act.ask(ONE, 1)
    act.accept(1)
    waiting = act.want(ONE, 1)
    act.action.on_server_lost()
    act.serve(b"second")
    assert waiting == [(ABORTED, None)]


def test_a_goal_that_the_server_does_not_know_is_aborted():
    act = Act()
    act.ask(ONE, 1)
    act.accept(1)
    act.ask(TWO, 2)
    waiting = act.want(ONE, 1)
    act.finish(1, UNKNOWN)
    assert (waiting, act.started()) == ([(ABORTED, None)], [1, 2])


def test_a_goal_that_was_given_up_and_is_accepted_late_is_cancelled():
    act = Act()
    answer = act.ask(ONE, 1)
    act.action.on_server_lost()
    act.transport.advance(LOST_TIMEOUT)
    act.serve()
    act.accept(1)
    assert answer == [None]
    assert set(act.ends.cancels) == {(of(1), 0)}


def test_a_goal_that_was_answered_and_goes_on_is_cancelled():
    act = Act()
    act.ask(ONE, 1)
    act.accept(1)
    act.action.on_server_lost()
    act.transport.advance(LOST_TIMEOUT)
    act.serve()
    act.tell((1, EXECUTING))
    assert set(act.ends.cancels) == {(of(1), 0)}
    assert act.listed() == {1: ABORTED}


def test_what_was_answered_is_cancelled_at_once_when_the_server_is_back():
    act = Act(PolicyName.BLOCK)
    act.ask(ONE, 1)
    act.accept(1)
    act.ask(ONE, 2)
    act.action.on_server_lost()
    act.transport.advance(LOST_TIMEOUT)
    assert act.ends.cancels == {}
    act.serve()
    assert set(act.ends.cancels) == {(of(1), 0), (of(2), 0)}
    act.ends.cancels.clear()
    act.action.on_server_lost()
    act.serve()
    assert act.ends.cancels == {}


def test_another_server_is_asked_to_cancel_nothing():
    act = Act()
    act.ask(ONE, 1)
    act.accept(1)
    act.action.on_server_lost()
    act.transport.advance(LOST_TIMEOUT)
    act.serve(b"second")
    act.action.on_server_lost()
    act.serve(b"second")
    assert act.ends.cancels == {}


def test_a_goal_goes_on_while_the_server_is_in_doubt_and_no_other_is_sent():
    act = Act()
    act.ask(ONE, 1)
    act.accept(1)
    act.ask(TWO, 2)
    waiting, other = act.want(ONE, 1), act.want(TWO, 2)
    act.doubt()
    assert act.action.details["server"] == SERVER
    assert act.action.details["server in doubt"] == "2 nodes serve it"
    assert act.ask(TWO, 3) == [None]
    act.transport.advance(10 * LOST_TIMEOUT)
    assert (waiting, other) == ([], [])
    act.tell((1, SUCCEEDED))
    act.finish(1)
    assert (waiting, act.started()) == ([(SUCCEEDED, "result")], [1])
    act.doubt("")
    assert (act.started(), other) == ([1, 2], [])
    assert "server in doubt" not in act.action.details
    act.accept(2)
    act.finish(2)
    act.ask(ONE, 4)
    assert act.started() == [1, 2, 4]


def test_a_goal_whose_end_is_told_in_doubt_gets_its_result_in_time():
    act = Act()
    act.ask(ONE, 1)
    act.accept(1)
    waiting = act.want(ONE, 1)
    act.doubt()
    act.tell((1, CANCELED))
    act.transport.advance(LOST_TIMEOUT)
    assert waiting == [(CANCELED, None)]


@pytest.mark.parametrize("status", [UNKNOWN, SUCCEEDED, ABORTED])
def test_a_result_that_the_server_did_not_tell_is_not_believed_in_doubt(status):
    act = Act()
    act.ask(ONE, 1)
    act.accept(1)
    waiting = act.want(ONE, 1)
    act.tell((1, EXECUTING))
    act.doubt()
    act.finish(1, status)
    assert waiting == []
    act.ends.results.clear()
    act.doubt("")
    act.finish(1)
    assert waiting == [(SUCCEEDED, "result")]


def test_a_no_that_comes_in_doubt_is_followed_by_a_cancel():
    act = Act()
    answer = act.ask(ONE, 1)
    act.doubt()
    act.reject(1)
    assert (answer, set(act.ends.cancels)) == ([None], {(of(1), 0)})


def test_goals_wait_although_the_one_in_progress_ends_in_doubt_and_the_server_goes_and_comes():
    act = Act()
    act.ask(ONE, 1)
    act.accept(1)
    act.ask(TWO, 2)
    act.doubt()
    act.action.on_server_lost()
    act.serve(b"second")
    assert act.started() == [1]
    act.doubt("")
    assert act.started() == [1, 2]


def test_a_goal_that_is_let_go_in_doubt_is_aborted():
    act = Act()
    act.ask(ONE, 1)
    act.accept(1)
    act.ask(TWO, 2)
    waiting = act.want(TWO, 2)
    act.doubt()
    act.action.pipeline.finish_action(act.transport.now())
    act.transport.advance(1)
    assert (act.started(), waiting) == ([1], [(ABORTED, None)])


def test_doubt_while_nothing_goes_on_lets_goals_go_afterwards(caplog):
    caplog.set_level(logging.INFO)
    act = Act()
    act.doubt()
    assert act.ask(ONE, 1) == [None]
    assert "of /one: 2 nodes serve it" in caplog.text
    act.doubt("")
    assert act.ask(ONE, 2) == []
    assert act.started() == [2]


@pytest.mark.parametrize("accepted", [True, False])
@pytest.mark.parametrize("away", ["in doubt", "gone"])
def test_a_brake_cancels_and_halts_whatever_is_known_of_the_server(away, accepted):
    halted = []
    act = Act()
    act.action.on_goal_stopped = lambda node, why: halted.append((node, why))
    act.ask(ONE, 1)
    if accepted:
        act.accept(1)
    if away == "gone":
        act.action.on_server_lost()
    else:
        act.doubt()
    act.action.brake("a test", "a person is there")
    asked = {(of(1), 0)} if accepted or away == "in doubt" else set()
    assert (set(act.ends.cancels), halted) == (asked, [(SERVER, "a person is there")])


def test_who_comes_in_the_place_of_the_server_is_halted_too():
    halted = []
    act = Act()
    act.action.on_goal_stopped = lambda node, why: halted.append((node, why))
    act.ask(ONE, 1)
    act.accept(1)
    act.action.brake("a test", "a person is there")
    act.action.on_server_lost()
    act.action.on_server_available("/server2", b"first")
    assert halted == [(SERVER, "a person is there"), ("/server2", "a person is there")]


def test_the_servers_own_goals_take_the_turn():
    act = Act()
    act.tell((9, EXECUTING))
    assert act.listed() == {9: EXECUTING}
    act.ask(ONE, 1)
    assert act.started() == []
    act.tell((9, SUCCEEDED))
    assert act.started() == [1]
    act.tell((8, EXECUTING))
    act.tell()
    act.accept(1)
    act.finish(1)
    act.ask(ONE, 2)
    assert act.started() == [1, 2]


def test_the_next_goal_goes_when_the_status_tells_the_end():
    act = Act()
    act.ask(ONE, 1)
    act.accept(1)
    act.ask(TWO, 2)
    act.tell((7, ABORTED), (1, EXECUTING))
    assert act.started() == [1]
    act.tell((1, SUCCEEDED))
    assert act.started() == [1, 2]


def test_a_result_that_does_not_come_is_asked_for_again_and_then_done_without():
    act = Act()
    act.ask(ONE, 1)
    act.accept(1)
    waiting = act.want(ONE, 1)
    act.ends.results.clear()
    act.tell((1, CANCELED))
    act.tell((1, CANCELED))
    act.transport.advance(SECOND - 1)
    assert act.ends.results == {}
    act.transport.advance(1)
    assert set(act.ends.results) == {of(1)}
    act.transport.advance(LOST_TIMEOUT - SECOND - 1)
    assert waiting == []
    act.transport.advance(1)
    assert waiting == [(CANCELED, None)]
    act.finish(1)
    assert waiting == [(CANCELED, None)]


def test_clients_are_told_what_the_server_lists_and_what_waits_here():
    act = Act()
    act.ask(ONE, 1)
    act.accept(1)
    act.ask(TWO, 2)
    act.tell((1, EXECUTING))
    assert act.listed() == {1: EXECUTING, 2: ACCEPTED}
    act.cancel(TWO, 2)
    assert act.listed() == {1: EXECUTING, 2: CANCELED}
    act.action.on_server_lost()
    act.transport.advance(LOST_TIMEOUT)
    assert act.listed() == {1: ABORTED, 2: CANCELED}
    act.transport.advance(10 * SECOND)
    act.serve()
    assert act.listed() == {}


def test_feedback_goes_to_the_client_and_under_the_public_name():
    act = Act()
    act.ask(TWO, 1)
    act.accept(1)
    message = b"\0\1\0\0" + of(1) + b"more"
    act.action.on_server_message(Ros2ActionEntity.FEEDBACK, message)
    act.finish(1)
    act.action.on_server_message(Ros2ActionEntity.FEEDBACK, message)
    other = b"\0\1\0\0" + of(2)
    act.action.on_server_message(Ros2ActionEntity.FEEDBACK, other)
    act.action.on_server_message(Ros2ActionEntity.FEEDBACK, other[:-1])
    assert act.ends.told[Ros2ActionEntity.FEEDBACK] == [(message, ["flow2"])] * 2 + [(other, [])]


def test_a_bar_that_rises_cancels_the_goal_once_and_halts_the_server():
    halted = []
    act = Act()
    act.action.on_goal_stopped = lambda node, why: halted.append((node, why))
    act.ask(ONE, 1)
    act.action.pipeline.bar("a test", ["flow1"], "an area is closed")
    act.host.recheck()
    assert (act.ends.cancels, halted) == ({}, [(SERVER, "an area is closed")])
    act.accept(1)
    act.host.recheck()
    act.ends.cancels.pop((of(1), 0))(CancelResponse(1))
    act.host.recheck()
    assert act.ends.cancels == {}
    act.finish(1, CANCELED)
    assert halted[1:] == [(SERVER, "")]


def test_a_barred_goal_is_aborted_when_its_turn_comes():
    act = Act()
    act.ask(ONE, 1)
    act.accept(1)
    act.ask(TWO, 2)
    act.ask(ONE, 3)
    waiting = act.want(TWO, 2)
    act.action.pipeline.bar("a test", ["flow2"], "an area is closed")
    act.finish(1)
    assert (waiting, act.started()) == ([(ABORTED, None)], [1, 3])


def test_the_next_guard_answers_what_was_asked_of_the_one_before():
    written = []
    act = Act(will=HandoverState(write=written.append))
    act.ask(ONE, 1)
    act.accept(1)
    act.ask(TWO, 2)
    act.want(ONE, 1)
    act.want(TWO, 2)
    act.transport.advance(SECOND // 100)
    again = Act(will=HandoverState(written[-1]), served=False)
    again.serve(b"another name")
    assert again.started() == []
    assert again.cancel(TWO, 1) == [CancelResponse(2)]
    again.finish(1)
    one, two = (again.ends.places[f"{node} {id}"] for node, id in ((ONE, 1), (TWO, 2)))
    assert (one.given, two.given) == ([(SUCCEEDED, "result")], [])
    again.transport.advance(3 * SECOND)
    assert two.given == [(ABORTED, None)]
    again.ask(TWO, 3)
    assert again.started() == [3]


def test_the_next_guard_gives_up_on_a_server_that_it_does_not_find():
    written = []
    act = Act(will=HandoverState(write=written.append))
    act.ask(ONE, 1)
    act.accept(1)
    act.want(ONE, 1)
    act.transport.advance(SECOND // 100)
    again = Act(will=HandoverState(written[-1]), served=False)
    again.transport.advance(10 * SECOND - 1)
    assert again.ends.places[f"{ONE} 1"].given == []
    again.transport.advance(1)
    assert again.ends.places[f"{ONE} 1"].given == [(ABORTED, None)]


def test_a_dry_run_lets_all_pass_and_counts():
    act = Act(dry_run=True)
    answers = [act.ask(ONE, 1), act.ask(TWO, 2), act.ask("/eve", 3, flow="unapproved")]
    assert act.started() == [1, 2, 3]
    for id in (1, 2, 3):
        act.accept(id)
    assert answers == [[5], [5], [5]]
    told = act.cancel("/eve", flow="unapproved")
    act.ends.cancels[of(0), 0](CancelResponse(0, [(of(1), 5)]))
    assert told == [CancelResponse(0, [(of(1), 5)])]
    tallies = act.action.pipeline.tallies
    assert (tallies["flow1"].passed, tallies["flow2"].held, tallies["unapproved"].dropped) == (
        1,
        1,
        1,
    )
    waiting = act.want(TWO, 2)
    act.finish(1)
    act.finish(2)
    assert waiting == [(SUCCEEDED, "result")]


def test_an_action_that_is_only_observed_stays_between_client_and_server():
    plan = plan_of(grcn("/go", [ONE], [SERVER], type=TYPE, mode=Mode.OBSERVE), ros=2)
    transport = MemoryActionTransport()
    host = Coordinator(transport, build_streams(plan))
    host.open()
    assert isinstance(host.streams[0], ObservedActionStream)
    assert not hasattr(transport, "ends")


def test_a_goal_knows_its_id():
    goal = GoalMessage.of(b"id", b"goal")
    assert (goal, goal.id) == (b"goal", b"id")
