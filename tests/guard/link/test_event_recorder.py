"""What a guard tells about itself: one event a transition, the rest counted."""

import pytest
from settings_app import GENERAL, WALL, Base, flow, limit

from rtron.guard.link.event_recorder import EventCounter, EventRecorder
from rtron.guard.link.host_events import HostEvents
from rtron.vocabulary import Alarm, AlarmKind, Decision, EventKind, GuardEventLevel, PolicyName


class Told(list):
    """The events, and a place for so many of them."""

    place = 1000

    def of(self, kind):
        return [event for event in self if event.kind is kind]

    def has_place(self):
        return len(self) < self.place


@pytest.fixture
def base():
    return Base()


@pytest.fixture
def told(base, tmp_path):
    told = Told()
    base.recorded = listened(base, told, tmp_path)
    return told


def listened(base, told, folder):
    """Record what a host does."""
    counter = EventCounter(folder, "run")
    recorder = EventRecorder(counter, "run", told.append, told.has_place, lambda: WALL)
    events = HostEvents(base.host, recorder.record)
    events.start()
    events.listen_to_alarms()
    return events


def verdicts(told):
    return [(each.node, each.flow, each.decision) for each in told.of(EventKind.VERDICT)]


def test_events_are_numbered_from_one_and_carry_the_wall_clock(base, told):
    base.drive(1.0)
    base.drive(1.0, by="teleop")
    assert [each.number for each in told] == list(range(1, len(told) + 1))
    assert {(each.run, each.at) for each in told} == {("run", WALL)}


def test_who_takes_control_is_told_once(base, told):
    for _ in range(5):
        base.drive(1.0)
    owners = [(e.node, e.topic, e.flow, e.publisher) for e in told.of(EventKind.OWNER)]
    assert owners == [("grcn", "/cmd_vel", "flow1", "/nav")]
    base.transport.advance(GENERAL.release_after)
    assert [each.flow for each in told.of(EventKind.OWNER)] == ["flow1", ""]


def test_verdicts_that_repeat_are_told_once_and_counted(base, told):
    for _ in range(5):
        base.drive(1.0)
        base.drive(1.0, by="teleop")
    told_of = verdicts(told)
    assert len(told_of) == 2
    assert told_of[1] == ("grcn", "flow2", Decision.DROP)
    figures = base.recorded.stream_monitors["enforce /cmd_vel"].figures(base.transport.now())
    assert figures["flows"] == {"flow1": [5, 0, 0, 0], "flow2": [0, 0, 5, 0]}
    assert base.recorded.stream_monitors["enforce /cmd_vel"].figures(base.transport.now()) is None


@pytest.mark.parametrize(
    ("settings", "speed", "node", "decision", "level"),
    [
        (flow("flow1", block=True), 1.0, "grcn", Decision.DROP, GuardEventLevel.WARNING),
        (limit(0.5), 1.0, "rsrcn", Decision.MODIFY, GuardEventLevel.WARNING),
        (limit(0.5), float("nan"), "grcn", Decision.DROP, GuardEventLevel.ERROR),
    ],
)
def test_a_refusal_names_its_coordination_node(base, told, settings, speed, node, decision, level):
    base.apply(settings)
    base.drive(speed)
    verdict = told.of(EventKind.VERDICT)[-1]
    assert (verdict.node, verdict.decision, verdict.level) == (node, decision, level)
    assert (verdict.topic, verdict.publisher, verdict.revision) == ("/cmd_vel", "/nav", 2)


def test_a_rule_that_begins_to_block_is_told_and_stops_the_robot(base, told):
    base.drive(1.0)
    base.event("red")
    rule = told.of(EventKind.RULE)[-1]
    assert (rule.node, rule.level, rule.values) == (
        "msrcn",
        GuardEventLevel.WARNING,
        {"rule": "red_light", "blocks": True},
    )
    assert "the light is red" in rule.reason
    assert "the light is red" in told.of(EventKind.STOP)[-1].reason
    base.drive(1.0)
    verdict = told.of(EventKind.VERDICT)[-1]
    assert (verdict.node, verdict.policy) == ("msrcn", PolicyName.BLOCK)


def test_alarms_are_told_when_they_are_raised_and_when_they_are_over(base, told):
    alarm = Alarm(kind=AlarmKind.UNREGISTERED_PUBLISHER, reason="a ghost", topic="/cmd_vel")
    base.host.alarms.raise_(alarm, 0)
    base.host.alarms.raise_(alarm, 1)
    base.host.alarms.clear(alarm)
    assert [(each.kind, each.level) for each in told] == [
        (EventKind.ALARM, GuardEventLevel.ERROR),
        (EventKind.ALARM_CLEARED, GuardEventLevel.INFO),
    ]
    assert told[0].values["kind"] == "ghost publisher"


def test_what_finds_no_place_is_told_as_lost_once_there_is_place(base, told):
    told.place = 2
    base.drive(1.0)
    base.drive(1.0, by="teleop")
    kept = len(told)
    base.transport.advance(GENERAL.release_after)
    assert len(told) == kept == 2
    told.place = 1000
    base.drive(1.0)
    lost = told.of(EventKind.LOST)
    assert [each.number for each in lost] == [3]
    assert lost[0].values["events"] >= 1
    assert [each.number for each in told] == list(range(1, len(told) + 1))


def test_reasons_of_strangers_are_cut(base, told):
    base.host.alarms.raise_(Alarm(kind=AlarmKind.UNREGISTERED_PUBLISHER, reason="x" * 5000), 0)
    assert len(told[0].reason) == 300


def test_the_state_tells_owner_speed_limit_and_delay(base, told):
    base.apply(limit(0.5))
    base.drive(1.0)
    watch = base.recorded.stream_monitors["enforce /cmd_vel"]
    watch.figures(base.transport.now())
    state = watch.state(base.transport.now())
    assert (state.owner, state.publisher, state.speed, state.limit) == ("flow1", "/nav", 0.5, 0.5)
    assert state.nodes == ("grcn", "msrcn", "rsrcn")
    assert state.flows["flow1"].modified == 1
    assert state.latency is not None


def test_an_alarm_that_stands_already_is_told_when_the_watch_begins(base, tmp_path):
    base.host.alarms.raise_(Alarm(kind=AlarmKind.DRIFT, reason="drift"), 0)
    told = Told()
    listened(base, told, tmp_path)
    assert [each.reason for each in told] == ["drift"]
