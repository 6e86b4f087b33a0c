"""New settings while goals wait or are in progress: each goal is answered once."""

from dataclasses import replace

import pytest
from ros1_action_in_memory import (
    FLOWS,
    GOAL_TYPE,
    ONE,
    SERVER,
    TWO,
    Ros1ActionApp,
    SimpleGoalApp,
    active,
)

from rtron.guard.core.handover_state import HandoverState
from rtron.guard.settings.applier import EmergencyBrake, SettingsApplier
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


class ChangingApp(Ros1ActionApp):
    """An action whose server is there, and whose settings change."""

    def __init__(self, policy=PolicyName.FIFO_QUEUE, **more):
        super().__init__(policy, **more)
        plan = plan_of(policy)
        assert build_streams(plan) == (self.stream,)
        self.applier = SettingsApplier(plan, self.coordinator, self.transport)
        self.revision = 0

    def put(self, stop=None, **values):
        self.revision += 1
        nodes = {"grcn_act": NodeSettings(**values)}
        self.applier.apply(Settings(revision=self.revision, nodes=nodes, stop=stop), 0)
        self.transport.advance(0)

    def cancelled(self):
        return [read_cancel(message).id for message in self.cancels]


@pytest.fixture
def app():
    app = ChangingApp()
    app.serve()
    return app


def waiting(app):
    """Let one goal be in progress, and three wait."""
    app.send_goal(ONE, b"a")
    app.serve(*active(b"a"))
    app.send_goal(ONE, b"b")
    app.send_goal(TWO, b"c")
    app.send_goal(ONE, b"d")
    assert app.started() == [b"a"]


def test_waiting_goals_move_to_priority_queue_and_each_is_answered_once(app):
    waiting(app)
    app.put(policy=PolicyName.PRIORITY_QUEUE)
    assert app.started() == [b"a"]
    for id in (b"a", b"c", b"b", b"d"):
        app.finish(id)
    assert app.started() == [b"a", b"c", b"b", b"d"]
    assert app.answers() == [(id, SUCCEEDED) for id in (b"a", b"c", b"b", b"d")]


def test_waiting_goals_move_back_in_the_order_of_arrival(app):
    waiting(app)
    app.put(policy=PolicyName.PRIORITY_QUEUE)
    app.put(policy=PolicyName.FIFO_QUEUE)
    for id in (b"a", b"b", b"c", b"d"):
        app.finish(id)
    assert app.started() == [b"a", b"b", b"c", b"d"]


@pytest.mark.parametrize("policy", [PolicyName.BLOCK, PolicyName.PREEMPTION])
def test_waiting_goals_are_recalled_where_nothing_waits(app, policy):
    waiting(app)
    app.put(policy=policy)
    assert app.answers() == [(id, RECALLED) for id in (b"b", b"c", b"d")]
    app.finish(b"a")
    assert app.started() == [b"a"]
    assert len(app.answers()) == 4


@pytest.mark.parametrize("before", [PolicyName.BLOCK, PolicyName.PREEMPTION])
def test_a_goal_that_no_queue_let_go_is_in_progress_in_the_queue_that_comes(before):
    app = ChangingApp(before)
    app.serve()
    app.send_goal(ONE, b"a")
    app.serve(*active(b"a"))
    app.put(policy=PolicyName.FIFO_QUEUE)
    app.send_goal(TWO, b"b")
    assert app.started() == [b"a"]
    app.finish(b"a")
    assert app.started() == [b"a", b"b"]


@pytest.mark.parametrize("before", [PolicyName.BLOCK, PolicyName.PREEMPTION])
def test_a_goal_that_is_over_is_not_in_progress_in_the_queue_that_comes(before):
    app = ChangingApp(before)
    app.serve()
    app.send_goal(ONE, b"a")
    app.finish(b"a")
    app.put(policy=PolicyName.FIFO_QUEUE)
    app.send_goal(TWO, b"b")
    assert app.started() == [b"a", b"b"]


def test_what_should_have_left_before_the_change_leaves_with_it(app):
    waiting(app)
    app.transport._time += 60 * SECOND
    app.action.server.state.last_status_time = app.transport.now()
    app.put(policy=PolicyName.PRIORITY_QUEUE)
    assert app.answers() == [(id, RECALLED) for id in (b"b", b"c", b"d")]


def test_a_goal_past_the_guard_is_in_progress_in_the_queue_that_comes():
    app = ChangingApp(PolicyName.PREEMPTION)
    app.serve(*active(b"own"))
    app.put(policy=PolicyName.FIFO_QUEUE)
    app.send_goal(TWO, b"b")
    assert app.started() == []
    app.finish(b"own")
    assert app.started() == [b"b"]


def test_a_goal_in_progress_is_overdue_by_the_new_max_hold_from_its_begin(app):
    app.send_goal(ONE, b"a")
    app.serve(*active(b"a"))
    app.transport.advance(SECOND)
    app.send_goal(TWO, b"b")
    app.put(max_hold=3 * SECOND)
    app.transport.advance(2 * SECOND - 1)
    assert app.started() == [b"a"]
    app.transport.advance(1)
    assert app.started() == [b"a", b"b"]


def test_the_goal_of_a_flow_that_is_blocked_is_cancelled_and_those_that_wait_recalled(app):
    waiting(app)
    app.put(flows={"flow1": FlowSettings(block=True)})
    assert app.cancelled() == [b"a"]
    assert app.answers() == [(b"b", RECALLED), (b"d", RECALLED)]
    assert app.started() == [b"a"]
    app.finish(b"a", PREEMPTED)
    assert app.started() == [b"a", b"c"]
    app.send_goal(ONE, b"e")
    assert app.answers()[-1] == (b"e", REJECTED)


def test_goals_of_other_flows_go_on_when_one_is_blocked(app):
    waiting(app)
    app.put(flows={"flow2": FlowSettings(block=True)})
    assert app.cancelled() == []
    assert app.answers() == [(b"c", RECALLED)]


def test_a_lower_limit_of_age_recalls_what_waits_too_long(app):
    waiting(app)
    app.transport.advance(SECOND)
    app.serve(*active(b"a"))
    app.put(max_age=SECOND)
    assert app.answers() == [(id, RECALLED) for id in (b"b", b"c", b"d")]


def test_an_emergency_stop_cancels_what_is_in_progress_and_recalls_what_waits(app):
    waiting(app)
    app.put(STOP)
    assert app.cancelled() == [b"a"]
    app.send_goal(TWO, b"e")
    app.finish(b"a", PREEMPTED)
    assert app.started() == [b"a"]
    assert sorted(app.answers()) == [
        (b"a", PREEMPTED),
        *((id, RECALLED) for id in (b"b", b"c", b"d")),
        (b"e", REJECTED),
    ]
    app.put()
    app.send_goal(TWO, b"f")
    assert app.started() == [b"a", b"f"]


def test_an_emergency_stop_cancels_goals_that_the_server_gives_itself(app):
    app.serve(*active(b"own"))
    app.put(STOP)
    assert app.cancelled() == [b"own"]
    app.finish(b"own", PREEMPTED)
    app.serve(*active(b"later"))
    assert app.cancelled() == [b"own", b"later"]
    app.finish(b"later", PREEMPTED)
    app.put()
    app.serve(*active(b"after"))
    assert app.cancelled() == [b"own", b"later"]


def test_a_guard_that_begins_under_a_stop_cancels_what_the_one_before_had_sent():
    written = []
    before = ChangingApp(handover=HandoverState(write=written.append))
    before.serve()
    waiting(before)
    before.transport.advance(SECOND)
    after = ChangingApp.__new__(ChangingApp)
    Ros1ActionApp.__init__(after, handover=HandoverState(written[-1]))
    after.applier, after.revision = None, 0
    plan = plan_of(PolicyName.FIFO_QUEUE)
    after.applier = SettingsApplier(plan, after.coordinator, after.transport)
    after.put(STOP)
    after.serve(*active(b"a"))
    assert b"a" in after.cancelled()


def test_a_cancel_that_no_server_could_hear_is_said_again(app):
    app.send_goal(ONE, b"a")
    app.serve(*active(b"a"))
    app.transport.unreachable.add(SERVER)
    app.action.server.state.node, node = "", app.action.server.state.node
    app.action.server._was_ready = False
    app.put(STOP)
    assert app.cancelled() == [b"a"]
    app.transport.unreachable.clear()
    app.action.server.state.node = node
    app.serve(*active(b"a"))
    assert app.cancelled() == [b"a", b"a"]
    app.serve(*active(b"a"))
    assert app.cancelled() == [b"a", b"a"]


def test_goals_may_wait_in_number_after_a_change_too(app):
    app.send_goal(ONE, b"a")
    app.put(policy=PolicyName.PRIORITY_QUEUE)
    room = replace(app.stream.stages[0].settings).queue_size
    stage = app.action.spec.stages[0]
    assert stage.settings.queue_size == room * (len(FLOWS) + 1)


def test_an_emergency_stop_cancels_goals_without_an_id_and_those_that_appear_later():
    app = SimpleGoalApp()
    emergency = EmergencyBrake(app.coordinator, app.transport)
    app.publish_pose(ONE, b"first")
    app.publish_pose(TWO, b"second")
    app.serve(*active(b"s1"))
    emergency.stop(STOP)
    assert {read_cancel(message).id for message in app.cancels} == {b"s1"}
    app.finish(b"s1", PREEMPTED)
    app.publish_pose(ONE, b"third")
    assert app.simple == [b"first"]
    app.serve(*active(b"s2"))
    assert {read_cancel(message).id for message in app.cancels} == {b"s1", b"s2"}
    app.finish(b"s2", PREEMPTED)
    emergency.release()
    app.publish_pose(ONE, b"fourth")
    assert app.simple == [b"first", b"fourth"]


def test_a_queue_of_goals_without_an_id_waits_for_the_server_s_own_after_a_change():
    app = SimpleGoalApp()
    app.publish_pose(ONE, b"first")
    app.serve(*active(b"s1"))
    poses = app.coordinator.streams[1]
    changed = replace(
        poses.spec,
        stages=tuple(
            replace(s, settings=replace(s.settings, policy=PolicyName.PRIORITY_QUEUE))
            for s in poses.spec.stages
        ),
    )
    observations = app.coordinator.observations
    update = poses.prepare_update(changed, observations, observations.mission.statuses)
    assert poses.apply_update(update, app.transport.now()) == []
    app.publish_pose(TWO, b"second")
    assert app.simple == [b"first"]
    app.finish(b"s1")
    assert app.simple == [b"first", b"second"]
