"""New settings while goals wait or are in progress: each goal is answered once."""

from dataclasses import replace

import pytest
from test_action_stream_ros1 import FLOWS, GOAL_TYPE, ONE, SERVER, TWO, Act, Simple, active

from rtron.guard.core.handover_state import HandoverState
from rtron.guard.settings.applier import SettingsApplier
from rtron.guard.settings.emergency_stop import EmergencyBrake
from rtron.messages.ros1.actions import PREEMPTED, RECALLED, REJECTED, SUCCEEDED, read_cancel
from rtron.vocabulary import (
    GRCN,
    SECOND,
    Domain,
    EmergencyStop,
    FlowSettings,
    Mode,
    NodeSettings,
    Plan,
    PolicyName,
    Settings,
    Sharing,
    StreamKind,
    build_streams,
)

STOP = EmergencyStop(by="ann", reason="", at=0)


def plan_of(policy):
    return Plan(
        app="act",
        grcn=(
            GRCN(
                id="grcn_act",
                topic="/act/goal",
                type=GOAL_TYPE,
                domain=Domain.PLANNING,
                kind=StreamKind.ACTION,
                sharing=Sharing.CONTEND,
                mode=Mode.ENFORCE,
                policy=policy,
                flows=FLOWS,
                successors=(SERVER,),
                max_age=60 * SECOND,
            ),
        ),
    )


class Changed(Act):
    """An action whose server is there, and whose settings change."""

    def __init__(self, policy=PolicyName.FIFO_QUEUE, **more):
        super().__init__(policy, **more)
        plan = plan_of(policy)
        assert build_streams(plan) == (self.stream,)
        self.applying = SettingsApplier(plan, self.host, self.transport)
        self.revision = 0

    def put(self, stop=None, **values):
        self.revision += 1
        nodes = {"grcn_act": NodeSettings(**values)}
        self.applying.apply(Settings(revision=self.revision, nodes=nodes, stop=stop), 0)
        self.transport.advance(0)

    def cancelled(self):
        return [read_cancel(message).id for message in self.cancels]


@pytest.fixture
def act():
    made = Changed()
    made.serve()
    return made


def waiting(act):
    """Let one goal be in progress, and three wait."""
    act.ask(ONE, b"a")
    act.serve(*active(b"a"))
    act.ask(ONE, b"b")
    act.ask(TWO, b"c")
    act.ask(ONE, b"d")
    assert act.started() == [b"a"]


def test_waiting_goals_move_to_priority_queue_and_each_is_answered_once(act):
    waiting(act)
    act.put(policy=PolicyName.PRIORITY_QUEUE)
    assert act.started() == [b"a"]
    for id in (b"a", b"c", b"b", b"d"):
        act.finish(id)
    assert act.started() == [b"a", b"c", b"b", b"d"]
    assert act.answers() == [(id, SUCCEEDED) for id in (b"a", b"c", b"b", b"d")]


def test_waiting_goals_move_back_in_the_order_of_arrival(act):
    waiting(act)
    act.put(policy=PolicyName.PRIORITY_QUEUE)
    act.put(policy=PolicyName.FIFO_QUEUE)
    for id in (b"a", b"b", b"c", b"d"):
        act.finish(id)
    assert act.started() == [b"a", b"b", b"c", b"d"]


@pytest.mark.parametrize("policy", [PolicyName.BLOCK, PolicyName.PREEMPTION])
def test_waiting_goals_are_recalled_where_nothing_waits(act, policy):
    waiting(act)
    act.put(policy=policy)
    assert act.answers() == [(id, RECALLED) for id in (b"b", b"c", b"d")]
    act.finish(b"a")
    assert act.started() == [b"a"]
    assert len(act.answers()) == 4


@pytest.mark.parametrize("before", [PolicyName.BLOCK, PolicyName.PREEMPTION])
def test_a_goal_that_no_queue_let_go_is_in_progress_in_the_queue_that_comes(before):
    act = Changed(before)
    act.serve()
    act.ask(ONE, b"a")
    act.serve(*active(b"a"))
    act.put(policy=PolicyName.FIFO_QUEUE)
    act.ask(TWO, b"b")
    assert act.started() == [b"a"]
    act.finish(b"a")
    assert act.started() == [b"a", b"b"]


@pytest.mark.parametrize("before", [PolicyName.BLOCK, PolicyName.PREEMPTION])
def test_a_goal_that_is_over_is_not_in_progress_in_the_queue_that_comes(before):
    act = Changed(before)
    act.serve()
    act.ask(ONE, b"a")
    act.finish(b"a")
    act.put(policy=PolicyName.FIFO_QUEUE)
    act.ask(TWO, b"b")
    assert act.started() == [b"a", b"b"]


def test_what_should_have_left_before_the_change_leaves_with_it(act):
    waiting(act)
    act.transport._time += 60 * SECOND
    act.action.server.at = act.transport.now()
    act.put(policy=PolicyName.PRIORITY_QUEUE)
    assert act.answers() == [(id, RECALLED) for id in (b"b", b"c", b"d")]


def test_a_goal_past_the_guard_is_in_progress_in_the_queue_that_comes():
    act = Changed(PolicyName.PREEMPTION)
    act.serve(*active(b"own"))
    act.put(policy=PolicyName.FIFO_QUEUE)
    act.ask(TWO, b"b")
    assert act.started() == []
    act.finish(b"own")
    assert act.started() == [b"b"]


def test_a_goal_in_progress_is_overdue_by_the_new_max_hold_from_its_begin(act):
    act.ask(ONE, b"a")
    act.serve(*active(b"a"))
    act.transport.advance(SECOND)
    act.ask(TWO, b"b")
    act.put(max_hold=3 * SECOND)
    act.transport.advance(2 * SECOND - 1)
    assert act.started() == [b"a"]
    act.transport.advance(1)
    assert act.started() == [b"a", b"b"]


def test_the_goal_of_a_flow_that_is_blocked_is_cancelled_and_those_that_wait_recalled(act):
    waiting(act)
    act.put(flows={"flow1": FlowSettings(block=True)})
    assert act.cancelled() == [b"a"]
    assert act.answers() == [(b"b", RECALLED), (b"d", RECALLED)]
    assert act.started() == [b"a"]
    act.finish(b"a", PREEMPTED)
    assert act.started() == [b"a", b"c"]
    act.ask(ONE, b"e")
    assert act.answers()[-1] == (b"e", REJECTED)


def test_goals_of_other_flows_go_on_when_one_is_blocked(act):
    waiting(act)
    act.put(flows={"flow2": FlowSettings(block=True)})
    assert act.cancelled() == []
    assert act.answers() == [(b"c", RECALLED)]


def test_a_lower_limit_of_age_recalls_what_waits_too_long(act):
    waiting(act)
    act.transport.advance(SECOND)
    act.serve(*active(b"a"))
    act.put(max_age=SECOND)
    assert act.answers() == [(id, RECALLED) for id in (b"b", b"c", b"d")]


def test_an_emergency_stop_cancels_what_is_in_progress_and_recalls_what_waits(act):
    waiting(act)
    act.put(STOP)
    assert act.cancelled() == [b"a"]
    act.ask(TWO, b"e")
    act.finish(b"a", PREEMPTED)
    assert act.started() == [b"a"]
    assert sorted(act.answers()) == [
        (b"a", PREEMPTED),
        *((id, RECALLED) for id in (b"b", b"c", b"d")),
        (b"e", REJECTED),
    ]
    act.put()
    act.ask(TWO, b"f")
    assert act.started() == [b"a", b"f"]


def test_an_emergency_stop_cancels_goals_that_the_server_gives_itself(act):
    act.serve(*active(b"own"))
    act.put(STOP)
    assert act.cancelled() == [b"own"]
    act.finish(b"own", PREEMPTED)
    act.serve(*active(b"later"))
    assert act.cancelled() == [b"own", b"later"]
    act.finish(b"later", PREEMPTED)
    act.put()
    act.serve(*active(b"after"))
    assert act.cancelled() == [b"own", b"later"]


def test_a_guard_that_begins_under_a_stop_cancels_what_the_one_before_had_sent():
    written = []
    before = Changed(will=HandoverState(write=written.append))
    before.serve()
    waiting(before)
    before.transport.advance(SECOND)
    after = Changed.__new__(Changed)
    Act.__init__(after, will=HandoverState(written[-1]))
    after.applying, after.revision = None, 0
    plan = plan_of(PolicyName.FIFO_QUEUE)
    after.applying = SettingsApplier(plan, after.host, after.transport)
    after.put(STOP)
    after.serve(*active(b"a"))
    assert b"a" in after.cancelled()


def test_a_cancel_that_no_server_could_hear_is_said_again(act):
    act.ask(ONE, b"a")
    act.serve(*active(b"a"))
    act.transport.unreachable.add(SERVER)
    act.action.server.node, node = "", act.action.server.node
    act.action._heard = False
    act.put(STOP)
    assert act.cancelled() == [b"a"]
    act.transport.unreachable.clear()
    act.action.server.node = node
    act.serve(*active(b"a"))
    assert act.cancelled() == [b"a", b"a"]
    act.serve(*active(b"a"))
    assert act.cancelled() == [b"a", b"a"]


def test_goals_may_wait_in_number_after_a_change_too(act):
    act.ask(ONE, b"a")
    act.put(policy=PolicyName.PRIORITY_QUEUE)
    room = replace(act.stream.stages[0].settings).queue_size
    stage = act.action.spec.stages[0]
    assert stage.settings.queue_size == room * (len(FLOWS) + 1)


def test_an_emergency_stop_cancels_goals_without_an_id_and_those_that_appear_later():
    act = Simple()
    emergency = EmergencyBrake(act.host, act.transport)
    act.give(ONE, b"first")
    act.give(TWO, b"second")
    act.serve(*active(b"s1"))
    emergency.stop(STOP)
    assert {read_cancel(message).id for message in act.cancels} == {b"s1"}
    act.finish(b"s1", PREEMPTED)
    act.give(ONE, b"third")
    assert act.simple == [b"first"]
    act.serve(*active(b"s2"))
    assert {read_cancel(message).id for message in act.cancels} == {b"s1", b"s2"}
    act.finish(b"s2", PREEMPTED)
    emergency.release()
    act.give(ONE, b"fourth")
    assert act.simple == [b"first", b"fourth"]


def test_a_queue_of_goals_without_an_id_waits_for_the_server_s_own_after_a_change():
    act = Simple()
    act.give(ONE, b"first")
    act.serve(*active(b"s1"))
    simple = act.host.streams[1]
    changed = replace(
        simple.spec,
        stages=tuple(
            replace(s, settings=replace(s.settings, policy=PolicyName.PRIORITY_QUEUE))
            for s in simple.spec.stages
        ),
    )
    senses = act.host.observations
    adaptation = simple.prepare_update(changed, senses, senses.mission.statuses)
    assert simple.apply_update(adaptation, act.transport.now()) == []
    act.give(TWO, b"second")
    assert act.simple == [b"first"]
    act.finish(b"s1")
    assert act.simple == [b"first", b"second"]
