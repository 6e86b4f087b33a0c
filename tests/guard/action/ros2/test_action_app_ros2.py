"""Goals of two clients through the guard to a real action server of ROS 2."""

import json
from collections import Counter
from random import Random

import pytest

pytest.importorskip("rclpy", reason="needs ROS 2")
from action_msgs.msg import GoalInfo, GoalStatus, GoalStatusArray
from harness import wait_for
from rclpy.qos import qos_profile_action_status_default
from ros2_action_app import (
    ACTION,
    ONE,
    SERVER,
    TWO,
    TYPE,
    Client,
    ForgedServer,
    GuardThread,
    Server,
)

from rtron.guard.audit.common.alarm_response import AlarmResponse
from rtron.guard.audit.ros2.auditor import Ros2Auditor
from rtron.guard.core.handover_state import HandoverState
from rtron.guard.lanes.bulk.command_nodes import CommandNodes
from rtron.guard.lanes.exchange.process_connection import ProcessConnection
from rtron.policies.goals.status_list import LOST_TIMEOUT
from rtron.vocabulary import (
    MSRCN,
    AlarmKind,
    Flow,
    GuardedTopic,
    MessageDefinition,
    MissionRule,
    Mode,
    OnForeign,
    PolicyName,
    Ros2ActionEntity,
    output_topic,
    ros2_entity_name,
)

pytestmark = [
    pytest.mark.ros2,
    # rclpy's own call, where a second server hears a request for the result of a goal it has not
    pytest.mark.filterwarnings("ignore:Deprecated in favor of:DeprecationWarning"),
]


def test_goals_go_one_by_one_in_the_order_of_arrival(start_action_app):
    app = start_action_app()
    app.one.send_goal(1)
    wait_for(lambda: app.server.started == [1], what="the first goal")
    app.two.send_goal(2)
    wait_for(lambda: 2 in app.two.handles, what="a goal that waits to be accepted")
    app.one.send_goal(3)
    wait_for(lambda: 3 in app.one.handles, what="another to be accepted")
    assert app.server.started == [1]
    for client, order in ((app.one, 1), (app.two, 2), (app.one, 3)):
        wait_for(lambda c=client, o=order: [o] in c.feedback, what=f"feedback of {order}")
        app.server.finish(order)
    wait_for(lambda: app.one.answers[3], what="the last answer")
    assert app.server.started == [1, 2, 3]
    wait_for(lambda: app.two.answers[2], what="the answer to the other client")
    assert app.one.answers == {1: [("succeeded", [1, 2])], 3: [("succeeded", [3, 4])]}
    assert app.two.answers == {2: [("succeeded", [2, 3])]}
    assert (app.one.feedback, app.two.feedback) == ([[1], [3]], [[2]])


def flows(*ranked):
    return tuple(
        Flow(name=f"flow{n}", publisher=node, priority=priority)
        for n, (node, priority) in enumerate(ranked, 1)
    )


def test_the_higher_flow_goes_first_and_interrupts_nothing(start_action_app):
    app = start_action_app(PolicyName.PRIORITY_QUEUE, flows=flows((ONE, 1), (TWO, 2)))
    app.one.send_goal(1)
    wait_for(lambda: app.server.started, what="the first goal")
    app.one.send_goal(3)
    wait_for(lambda: 3 in app.one.handles, what="the lower goal to wait")
    app.two.send_goal(2)
    wait_for(lambda: 2 in app.two.handles, what="the higher goal to wait")
    for order in (1, 2, 3):
        app.server.finish(order)
    wait_for(lambda: app.one.answers[3], what="the last answer")
    assert app.server.started == [1, 2, 3]


def test_a_client_cancels_only_its_own_goals(start_action_app):
    app = start_action_app()
    app.one.send_goal(1)
    wait_for(lambda: 1 in app.one.handles, what="the first goal")
    for client, order in ((app.two, 2), (app.one, 3), (app.two, 4)):
        client.send_goal(order)
        wait_for(lambda client=client, order=order: order in client.handles, what=f"goal {order}")
    others = app.two.cancel_raw(goal_info=GoalInfo(goal_id=app.one.handles[3].goal_id))
    wait_for(others.done, what="the answer about another's goal")
    assert (others.result().return_code, others.result().goals_canceling) == (2, [])
    everything = app.two.cancel_raw()
    wait_for(everything.done, what="the answer about all of its goals")
    assert everything.result().return_code == 0
    assert ids(everything) == {id_of(app.two, 2), id_of(app.two, 4)}
    wait_for(lambda: app.two.answers[2] and app.two.answers[4], what="the ends of two's goals")
    assert app.two.answers == {2: [("canceled", [])], 4: [("canceled", [])]}
    assert (app.one.answers, app.server.cancels) == ({1: [], 3: []}, [])
    both = app.one.cancel_raw()
    wait_for(both.done, what="the answer about one's goals")
    assert ids(both) == {id_of(app.one, 1), id_of(app.one, 3)}
    wait_for(lambda: app.one.answers[1] and app.one.answers[3], what="the ends of one's goals")
    assert app.one.answers == {1: [("canceled", [-1])], 3: [("canceled", [])]}
    assert app.server.cancels == app.server.started == [1]
    late = app.one.cancel(1)
    wait_for(late.done, what="the answer about a goal that is over")
    assert late.result().return_code == 3


def test_a_cancel_with_a_stamp_means_what_was_accepted_before(start_action_app):
    app = start_action_app()
    for order in (1, 2, 3):
        app.one.send_goal(order)
        wait_for(lambda order=order: order in app.one.handles, what=f"goal {order}")
    answer = app.one.cancel_raw(goal_info=GoalInfo(stamp=app.one.handles[2].stamp))
    wait_for(answer.done, what="the answer")
    assert ids(answer) == {id_of(app.one, 1), id_of(app.one, 2)}
    wait_for(lambda: app.server.started == [1, 3], what="the goal that is left")


def test_a_server_that_does_not_cancel_is_told_as_such(start_action_app):
    app = start_action_app()
    app.one.send_goal(1001)
    wait_for(lambda: app.server.started, what="the goal")
    answer = app.one.cancel(1001)
    wait_for(answer.done, what="the answer")
    assert (answer.result().return_code, answer.result().goals_canceling) == (1, [])
    app.server.finish(1001)
    wait_for(lambda: app.one.answers[1001], what="the end")


def test_what_the_server_rejects_is_rejected_or_aborted_if_it_was_accepted_here(start_action_app):
    app = start_action_app()
    app.one.send_goal(-1)
    wait_for(lambda: app.one.answers[-1], what="the server's no")
    app.one.send_goal(1)
    wait_for(lambda: app.server.started, what="a goal in progress")
    app.two.send_goal(-2, 2)
    wait_for(lambda: 2 in app.two.handles, what="goals that wait")
    app.server.finish(1)
    app.server.finish(2)
    wait_for(lambda: app.two.answers[2], what="the last goal")
    assert app.one.answers[-1] == [("rejected", [])]
    assert app.two.answers == {-2: [("aborted", [])], 2: [("succeeded", [2, 3])]}


@pytest.mark.long
def test_hundreds_of_goals_are_answered_once_each(start_action_app):
    app = start_action_app(queue_size=200)
    chance = Random(7)
    orders = {app.one: range(2000, 2150), app.two: range(3000, 3150)}
    for order in (*orders[app.one], *orders[app.two]):
        app.server.finish(order)
    for pair in zip(*orders.values(), strict=True):
        for client, order in chance.sample(list(zip(orders, pair, strict=True)), 2):
            wait_for(lambda client=client: len(client.open) < 5, what="answers to goals")
            client.send_goal(order)
            if chance.random() < 0.2 and client.handles:
                client.cancel(chance.choice(list(client.handles)))
    for client, own in orders.items():
        wait_for(lambda client=client: all(client.answers.values()), what="all answers", limit_s=60)
        assert client.answers.keys() == set(own)
    for client, own in orders.items():
        app.server.finish(own.stop)
        client.send_goal(own.stop)
        wait_for(lambda client=client, own=own: client.answers[own.stop], what="a later answer")
    answers = [answer for client in orders for answer in client.answers.values()]
    assert {len(answer) for answer in answers} == {1}
    ends = Counter(state for ((state, _),) in answers)
    assert ends["succeeded"] == len(app.server.ended) == len(set(app.server.started))
    assert ends.total() == 302
    assert not ends["rejected"]


def test_a_server_that_dies_leaves_no_goal_unanswered(start_action_app):
    app = start_action_app()
    app.one.send_goal(1)
    wait_for(lambda: app.server.started, what="the goal")
    app.two.send_goal(2)
    wait_for(lambda: 2 in app.two.handles, what="a goal that waits")
    app.end(app.server)
    wait_for(lambda: app.one.answers[1], what="the answer to the goal that is lost")
    assert app.one.answers[1] == [("aborted", [])]
    assert app.two.answers[2] == []
    again = app.keep(Server(app.domain))
    again.finish(2)
    wait_for(lambda: app.two.answers[2], what="the goal that waited")
    assert (again.started, app.two.answers[2]) == ([2], [("succeeded", [2, 3])])


def test_without_a_server_the_action_is_not_there(start_action_app):
    app = start_action_app()
    app.end(app.server)
    wait_for(lambda: not app.one.ready(), what="the action to go")
    app.keep(Server(app.domain))
    wait_for(app.one.ready, what="the action to come back")


def test_a_guard_that_is_restarted_answers_the_goals_of_the_one_before(start_action_app):
    app = start_action_app()
    app.one.send_goal(1)
    wait_for(lambda: app.server.started, what="the goal")
    app.two.send_goal(2)
    wait_for(lambda: 2 in app.two.handles, what="a goal that waits")
    wait_for(lambda: goals_in_handover(app) == 2, what="the handover")
    app.end(app.guard)
    app.guard = app.keep(GuardThread(app.domain, app.plan, HandoverState(app.handovers[-1])))
    wait_for(lambda: app.two.answers[2], what="the answer to the goal that waited")
    assert app.two.answers[2] == [("aborted", [])]
    cancel = app.two.cancel_raw(goal_info=GoalInfo(goal_id=app.one.handles[1].goal_id))
    wait_for(cancel.done, what="the answer about another's goal")
    assert cancel.result().return_code == 2
    app.server.finish(1)
    wait_for(lambda: app.one.answers[1], what="the answer to the goal in progress")
    assert app.one.answers[1] == [("succeeded", [1, 2])]
    app.two.send_goal(3)
    app.server.finish(3)
    wait_for(lambda: app.two.answers[3], what="a new goal")
    assert app.server.started == [1, 3]


@pytest.mark.long
def test_a_goal_that_ends_between_two_deaths_of_the_guard_is_answered(start_action_app):
    app = start_action_app()
    app.one.send_goal(1)
    wait_for(lambda: app.server.started, what="the goal")
    wait_for(lambda: goals_in_handover(app) == 1, what="the handover")
    app.end(app.guard)
    app.guard = app.keep(GuardThread(app.domain, app.plan, handed_over(app)))
    task = app.guard.action.replies.tasks[id_of(app.one, 1)]
    app.server.finish(1)
    # a client that finds the guard before the goal ends has its answer from this one
    wait_for(lambda: task.is_held or app.one.answers[1], what="the end of the goal")
    app.end(app.guard)
    app.guard = app.keep(GuardThread(app.domain, app.plan, handed_over(app)))
    wait_for(lambda: app.one.answers[1], what="the answer")
    assert app.one.answers[1] == [("succeeded", [1, 2])]


@pytest.mark.long
def test_the_goals_of_the_guard_before_are_answered_though_the_server_comes_late(start_action_app):
    app = start_action_app()
    app.one.send_goal(1)
    wait_for(lambda: app.server.started, what="the goal")
    app.two.send_goal(2)
    wait_for(lambda: 2 in app.two.handles, what="a goal that waits")
    wait_for(lambda: goals_in_handover(app) == 2, what="the handover")
    app.end(app.guard)
    app.end(app.server)
    app.guard = app.keep(GuardThread(app.domain, app.plan, HandoverState(app.handovers[-1])))
    over = app.guard.action.replies.results.flow_of
    wait_for(lambda: over(id_of(app.two, 2)), what="the end of the goal that waited")
    app.keep(Server(app.domain))
    wait_for(lambda: app.two.answers[2], what="the answer")
    assert app.two.answers[2] == [("aborted", [])]


def test_strangers_are_rejected_and_cancel_nothing(start_action_app):
    app = start_action_app()
    app.one.send_goal(1)
    wait_for(lambda: app.server.started, what="the goal")
    strangers = [app.client("/mallory"), app.client("/mallory2", "flow1"), app.client(ONE, "flow1")]
    for order, stranger in enumerate(strangers, 10):
        answer = stranger.cancel_raw()
        wait_for(answer.done, what="the answer to a stranger's cancel")
        assert answer.result().return_code == 1
        stranger.send_goal(order)
        wait_for(lambda stranger=stranger, order=order: stranger.answers[order], what="a no")
        assert stranger.answers[order] == [("rejected", [])]
    assert (app.server.started, app.server.cancels) == ([1], [])
    assert app.guard.action.pipeline.tallies["unapproved"].dropped == 3
    app.server.finish(1)
    wait_for(lambda: app.one.answers[1], what="the answer to the goal in progress")
    assert app.one.answers[1] == [("succeeded", [1, 2])]


def test_beside_a_second_server_the_first_keeps_its_goal_and_neither_is_sent_another(
    start_action_app, caplog
):
    app = start_action_app()
    app.one.send_goal(1)
    wait_for(lambda: app.server.started, what="the goal")
    app.two.send_goal(2)
    wait_for(lambda: 2 in app.two.handles, what="a goal that waits")
    other = app.keep(Server(app.domain, "/mallory"))
    wait_for(lambda: app.guard.action.server.doubt, what="two servers to be noticed")
    app.two.send_goal(3)
    wait_for(lambda: app.two.answers[3], what="a no")
    app.guard.wait(LOST_TIMEOUT)
    assert (app.one.answers[1], app.two.answers[3]) == ([], [("rejected", [])])
    app.server.finish(1)
    wait_for(lambda: app.one.answers[1], what="the end that the first tells")
    assert app.one.answers[1][0][0] == "succeeded"
    assert (other.started, app.server.started, app.two.answers[2]) == ([], [1], [])
    assert caplog.text.count("2 nodes serve it") == 1
    app.end(other)
    wait_for(lambda: app.server.started == [1, 2], what="the goal that waited")


def test_who_only_tells_a_status_does_not_keep_a_goal_from_being_cancelled(start_action_app):
    app = start_action_app()
    app.one.send_goal(1)
    wait_for(lambda: app.server.started, what="the goal")
    stranger = app.keep(Client(app.domain, "/mallory", ACTION))
    name = ros2_entity_name(output_topic(ACTION), Ros2ActionEntity.STATUS)
    stranger.node.create_publisher(GoalStatusArray, name, qos_profile_action_status_default)
    wait_for(lambda: app.guard.action.server.doubt, what="the stranger to be noticed")
    app.guard.call(lambda: app.guard.action.brake("a test", "a person is there"))
    wait_for(lambda: app.one.answers[1], what="the end of the goal")
    assert app.one.answers[1][0][0] == "canceled"
    assert app.server.cancels == [1]


@pytest.mark.long
def test_a_second_server_is_an_alarm_that_stops_the_goal_in_progress(start_action_app):
    app = start_action_app()
    guard = app.guard
    response = AlarmResponse(guard.coordinator, guard.transport, OnForeign.STOP, dry_run=False)
    no_others = CommandNodes(ProcessConnection(guard.loop), guard.loop, frozenset())
    auditor = Ros2Auditor(app.plan, guard.transport, response, guard.loop, no_others)
    guard.call(auditor.open)
    app.one.send_goal(1)
    wait_for(lambda: app.server.started, what="the goal")
    assert guard.call(lambda: guard.coordinator.alarms.active) == ()
    app.server.before_canceled_result = lambda: wait_for(
        lambda: guard.knows_status(GoalStatus.STATUS_CANCELED), what="the status before the result"
    )  # beside a second server the guard believes no other
    other = app.keep(Server(app.domain, "/mallory"))
    wait_for(lambda: app.one.answers[1], what="the end of the goal")
    assert app.one.answers[1] == [("canceled", [-1])]
    active = guard.call(lambda: guard.coordinator.alarms.active)
    alarm, latched = (each for each in active if f"offers to serve {ACTION}, too" in each.reason)
    assert (alarm.kind, alarm.peer) == (AlarmKind.FOREIGN_PUBLISHER, "/mallory")
    assert latched.kind is AlarmKind.INTRUSION
    app.end(other)
    clear, refusals = guard.coordinator.intrusions.clear, [""]

    def is_cleared():
        guard.call(lambda: clear(ACTION, refusals.append))
        return not refusals[-1]

    wait_for(is_cleared, what="the guard's leave to go on")
    assert not guard.call(lambda: guard.coordinator.alarms.active)
    app.two.send_goal(2)
    wait_for(lambda: app.server.started == [1, 2], what="a goal after the alarm")
    assert other.started == []


@pytest.mark.long
def test_a_guard_that_comes_after_a_second_server_follows_the_goal_of_the_first(start_action_app):
    app = start_action_app()
    app.one.send_goal(1)
    wait_for(lambda: app.server.started, what="the goal")
    wait_for(lambda: goals_in_handover(app) == 1, what="the handover")
    app.end(app.guard)
    app.keep(Server(app.domain, "/mallory"))
    app.guard = app.keep(GuardThread(app.domain, app.plan, HandoverState(app.handovers[-1])))
    action = app.guard.action
    wait_for(
        lambda: action.server.is_available and action.server.doubt, what="the first and the second"
    )
    app.guard.call(lambda: action.brake("a test", "a person is there"))
    wait_for(lambda: app.server.cancels, what="the cancel")


@pytest.mark.long
def test_who_only_answers_for_results_ends_no_goal(start_action_app):
    app = start_action_app()
    app.one.send_goal(1)
    wait_for(lambda: app.server.started, what="the goal")
    wait_for(lambda: goals_in_handover(app) == 1, what="the handover")
    app.end(app.guard)
    app.keep(ForgedServer(app.domain, "/mallory"))
    app.guard = app.keep(GuardThread(app.domain, app.plan, HandoverState(app.handovers[-1])))
    action = app.guard.action
    wait_for(lambda: action.server.is_available, what="the server")
    wait_for(lambda: action.server.doubt == "/mallory answers in its place", what="the liar")
    app.guard.call(lambda: action.brake("a test", "a person is there"))
    wait_for(lambda: app.server.cancels, what="the cancel")


def handed_over(app):
    return HandoverState(app.handovers[-1], app.handovers.append)


def goals_in_handover(app):
    return len(json.loads(app.handovers[-1]).get("results /fib", ())) if app.handovers else 0


OWN = MessageDefinition(type=TYPE, definition="int32 order\n")


@pytest.mark.parametrize("messages", [(OWN,), ()], ids=["told", "installed"])
def test_a_rule_looks_into_the_goal(start_action_app, messages):
    rule = MissionRule(name="small", block=(ACTION,), action="action.order > 100")
    aflows = (
        GuardedTopic(
            topic=ACTION, type=TYPE, flows=flows((ONE, 0), (TWO, 0)), successors=(SERVER,)
        ),
    )
    msrcn = MSRCN(
        id="msrcn", mode=Mode.ENFORCE, policy=PolicyName.BLOCK, aflows=aflows, rules=(rule,)
    )
    app = start_action_app(more={"msrcn": msrcn, "messages": messages})
    app.one.send_goal(101, 100)
    app.server.finish(100)
    wait_for(lambda: app.one.answers[100], what="the goal that is allowed")
    assert app.one.answers == {101: [("rejected", [])], 100: [("succeeded", [100, 101])]}
    assert app.server.started == [100]


def test_a_brake_cancels_the_goal_in_progress(start_action_app):
    app = start_action_app()
    app.one.send_goal(1)
    wait_for(lambda: app.server.started, what="the goal")
    app.guard.call(lambda: app.guard.action.brake("a test", "a person is there"))
    wait_for(lambda: app.one.answers[1], what="the end of the goal")
    assert app.one.answers[1] == [("canceled", [-1])]
    app.two.send_goal(2)
    wait_for(lambda: app.two.answers[2], what="a no")
    app.guard.call(lambda: app.guard.action.release("a test"))
    app.two.send_goal(3)
    app.server.finish(3)
    wait_for(lambda: app.two.answers[3], what="a goal after the brake")
    assert (app.two.answers[2], app.server.started) == ([("rejected", [])], [1, 3])


@pytest.mark.long
def test_a_client_that_cancels_a_crowd_of_goals_gets_all_the_answers(start_action_app):
    app = start_action_app()
    crowd = range(1, 41)
    for order in crowd:
        wait_for(lambda: len(app.one.open) < 5, what="answers to goals")
        app.one.send_goal(order)
    wait_for(lambda: len(app.one.handles) == len(crowd), what="all goals to be accepted")
    everything = app.one.cancel_raw()
    wait_for(everything.done, what="the answer")
    assert len(everything.result().goals_canceling) == len(crowd)
    wait_for(lambda: all(app.one.answers.values()), what="all results")
    assert {state for ((state, _),) in app.one.answers.values()} == {"canceled"}
    assert app.server.started == [1]


def ids(cancel):
    return {bytes(each.goal_id.uuid) for each in cancel.result().goals_canceling}


def id_of(client, order):
    return bytes(client.handles[order].goal_id.uuid)
