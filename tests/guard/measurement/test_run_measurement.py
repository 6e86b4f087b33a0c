"""What is kept of a run: figures that are right, and no more of them however long it lasts."""

import math
import random
import struct
import tracemalloc
from dataclasses import replace

import pytest
from app_in_memory import info
from hypothesis import given, settings
from hypothesis import strategies as st
from ros1_action_in_memory import ONE, TWO, Ros1ActionApp
from streams import FLOWS, peer
from test_mission_stream import AT_RED, LIGHT, MOVING, light, string
from test_velocity_limits import VELOCITY, plan
from velocity_messages import image, twist

from rtron.errors import SourceError
from rtron.guard.coordinator import Coordinator
from rtron.guard.measurement.activity import ActivityPhases
from rtron.guard.measurement.frame_rates import FrameRateMeasurement
from rtron.guard.measurement.histogram import Histogram, duration_figures, value_figures
from rtron.guard.measurement.run import WRITE_PERIOD, RunMeasurement
from rtron.guard.measurement.stream import MOST_COMPARED, MOST_OPEN, StreamMeasurement
from rtron.guard.transport.common.memory import MemoryTransport
from rtron.vocabulary import (
    GRCN,
    MSRCN,
    SECOND,
    Decision,
    Domain,
    DurationStatistics,
    Flow,
    Mode,
    Plan,
    PolicyName,
    Sharing,
    StreamKind,
    ValueStatistics,
    build_streams,
)

TWIST, IMAGE, STRING = (
    info(type) for type in ("geometry_msgs/Twist", "sensor_msgs/Image", "std_msgs/String")
)
TENTH = SECOND // 10


def histogram(values):
    made = Histogram()
    for value in values:
        made.add(value)
    return made


@settings(deadline=None)
@given(st.lists(st.integers(0, 10**18), min_size=1, max_size=200), st.floats(0, 1))
def test_a_quantile_is_a_value_and_at_most_a_tenth_too_high(values, part):
    found = histogram(values).quantile(part, 0)
    exact = sorted(values)[max(math.ceil(part * len(values)) - 1, 0)]
    assert found in values
    assert exact <= found <= exact * 1.1000001


@settings(deadline=None)
@given(st.lists(st.integers(0, 10**12), max_size=100), st.integers(0, 10**12))
def test_parting_loses_nothing(values, limit):
    low, high = histogram(values).split_at(limit)
    assert low.count + high.count == len(values)
    assert low.total(0) + high.total(0) == sum(values)
    assert high.minimum(limit + 1) > limit
    assert low.quantile(1, 0) <= limit * 1.1000001


def test_figures_of_nothing_are_zero():
    assert duration_figures(Histogram()) == DurationStatistics()
    assert value_figures(Histogram()) == ValueStatistics()


def test_a_histogram_does_not_grow():
    made = histogram(10.0 ** random.Random(n).uniform(-12, 25) for n in range(20_000))
    assert len(made._buckets) <= 702


def phases(times):
    made = ActivityPhases()
    return made, [made.add_message(time) for time in times]


@pytest.mark.parametrize(("gap", "ends"), [(SECOND, False), (SECOND + 1, True)])
def test_a_phase_of_a_fast_speaker_ends_after_a_second(gap, ends):
    made, _ = phases([n * SECOND // 100 for n in range(100)])
    assert (made.add_message(99 * SECOND // 100 + gap) is None) is ends


@pytest.mark.parametrize(("gap", "ends"), [(10 * SECOND, False), (10 * SECOND + 1, True)])
def test_a_phase_of_a_slow_speaker_ends_after_ten_of_its_gaps(gap, ends):
    made, _ = phases([n * SECOND for n in range(65)])
    assert (made.add_message(64 * SECOND + gap) is None) is ends


def test_gaps_and_pauses_are_told_apart_in_the_end():
    made, _ = phases([start + n * TENTH for start in (0, 60 * SECOND) for n in range(50)])
    gaps, pauses = made.gaps_and_pauses()
    assert (gaps.count, pauses.count) == (98, 1)
    assert gaps.total(0) == 98 * TENTH
    assert pauses.quantile(1, 0) == 60 * SECOND - 49 * TENTH


def grcn(**settings):
    wanted = {
        "id": "grcn_cmd_vel",
        "topic": "/cmd_vel",
        "type": TWIST.type,
        "domain": Domain.CONTROL,
        "kind": StreamKind.COMMAND,
        "sharing": Sharing.CONTEND,
        "mode": Mode.ENFORCE,
        "policy": PolicyName.PREEMPTION,
        "flows": FLOWS,
        "successors": ("/driver",),
    }
    return GRCN(**wanted | settings)


class Dry:
    """A dry run in memory that is measured."""

    def __init__(self, plan):
        self.transport = MemoryTransport()
        self.measuring = RunMeasurement(plan, self.transport)
        self.host = Coordinator(
            self.transport, build_streams(plan), self.measuring.observations, dry_run=True
        )
        self.measuring.measure(self.host.streams)
        self.host.open()

    def says(self, topic, node, info=TWIST):
        return self.transport.publisher(topic, peer(node, info))

    def flow(self, name, stream=0):
        flows = self.measuring.figures().streams[stream].flows
        return next(flow for flow in flows if flow.flow == name)


@pytest.fixture
def dry():
    return Dry(Plan(app="base", grcn=(grcn(),)))


def test_flows_are_measured(dry):
    nav = dry.says("/rtron/cmd_vel/flow1", "/nav")
    teleop = dry.says("/rtron/cmd_vel/flow2", "/teleop")
    for n in range(100):
        nav(twist(0.1 * (n % 3)))
        if n >= 90:
            teleop(twist(1.0))
        dry.transport.advance(TENTH)
    one, other = dry.flow("flow1"), dry.flow("flow2")
    assert (one.messages, other.messages) == (100, 10)
    assert one.gaps == DurationStatistics(count=99, p50=TENTH, p99=TENTH, p999=TENTH, max=TENTH)
    assert one.active == 99 * TENTH
    assert (one.speeds.min, one.speeds.max) == (0.0, pytest.approx(0.2))
    assert not one.refusals
    refusal = other.refusals[0]
    assert (refusal.decision, refusal.count) == (Decision.DROP, 10)
    assert refusal.reason == "flow1 has the output (priority 2)"
    assert [(each.flow, each.duration) for each in other.overlaps] == [("flow1", 9 * TENTH)]
    assert dry.measuring.figures().duration == 10 * SECOND


@pytest.mark.parametrize(("last", "left"), [(0.5, 1), (0.0, 0)])
def test_a_pause_with_the_robot_moving_is_counted(dry, last, left):
    nav = dry.says("/rtron/cmd_vel/flow1", "/nav")
    for speed in (0.5, 0.5, last):
        nav(twist(speed))
        dry.transport.advance(TENTH)
    dry.transport.advance(SECOND - TENTH)
    assert dry.flow("flow1").left_moving == 0
    dry.transport.advance(1)
    assert dry.flow("flow1").left_moving == left
    nav(twist(0.0))
    assert dry.flow("flow1").left_moving == left


def test_strangers_are_named_and_what_they_say_is_a_flow_of_its_own(dry):
    assert len(dry.measuring.figures().streams[0].flows) == 2
    dry.says("/cmd_vel", "/early")
    dry.says("/rtron/cmd_vel/flow1", "/nav")
    rogue = dry.says("/cmd_vel", "/rogue")
    rogue(twist(9.0))
    assert dry.flow("unapproved").messages == 1
    assert dry.measuring.figures().streams[0].strangers == ("/early", "/rogue")


@pytest.mark.parametrize("bad", [b"", b"\x01", twist(math.nan), twist(math.inf)])
def test_what_is_no_velocity_is_counted_but_has_no_speed(dry, bad):
    dry.says("/rtron/cmd_vel/flow1", "/nav")(bad)
    flow = dry.flow("flow1")
    assert (flow.messages, flow.speeds.count) == (1, 0)


def test_waits_are_measured_from_hold_to_release():
    flows = tuple(replace(flow, timeout=2 * SECOND) for flow in FLOWS)
    queue = grcn(policy=PolicyName.PRIORITY_QUEUE, flows=flows, max_age=9 * SECOND)
    dry = Dry(Plan(app="base", grcn=(queue,)))
    dry.says("/rtron/cmd_vel/flow1", "/nav")(twist(1.0))
    dry.transport.advance(SECOND)
    dry.says("/rtron/cmd_vel/flow2", "/teleop")(twist(2.0))
    dry.transport.advance(5 * SECOND)
    flow = dry.flow("flow2")
    assert (flow.waits.count, flow.waits.max) == (1, SECOND)
    assert [(each.decision, each.count) for each in flow.refusals] == [(Decision.HOLD, 1)]
    assert dry.flow("flow1").waits.count == 0


GOALS = {
    "topic": "/goal",
    "kind": StreamKind.ACTION,
    "policy": PolicyName.FIFO_QUEUE,
    "done": "/done",
    "successors": ("/planner",),
}


@pytest.mark.parametrize("more", [0, 1, 2])
def test_held_messages_that_never_go_are_let_go(more):
    queue = grcn(policy=PolicyName.FIFO_QUEUE, kind=StreamKind.STATE, max_age=SECOND)
    dry = Dry(Plan(app="base", grcn=(queue,)))
    dry.says("/rtron/cmd_vel/flow1", "/nav")(twist())
    teleop = dry.says("/rtron/cmd_vel/flow2", "/teleop")
    for _ in range(MOST_OPEN + more):
        teleop(twist())
        dry.transport.advance(2 * SECOND)
    assert dry.flow("flow2").waits.count == 0
    assert len(dry.host.streams[0].measurement._held) == MOST_OPEN


def test_goals_are_measured_until_they_are_done():
    dry = Dry(Plan(app="base", grcn=(grcn(**GOALS),)))
    ask = dry.says("/rtron/goal/flow1", "/nav")
    tell = dry.says("/done", "/planner", STRING)
    tell(string("of what?"))
    for seconds in (3, 7):
        ask(twist())
        dry.transport.advance(seconds * SECOND)
        tell(string("done"))
    ask(twist())
    flow = dry.flow("flow1")
    assert (flow.takes.count, flow.takes.max, flow.undone) == (2, 7 * SECOND, 1)


def test_of_goals_without_ids_only_the_last_is_waited_for():
    dry = Dry(Plan(app="base", grcn=(grcn(**GOALS),)))
    tell = dry.says("/done", "/planner", STRING)
    for node in ("/nav", "/teleop"):
        flow = {"/nav": "flow1", "/teleop": "flow2"}[node]
        dry.says(f"/rtron/goal/{flow}", node)(twist())
        dry.transport.advance(SECOND)
    tell(string("which one?"))
    tell(string("the other"))
    one, other = dry.flow("flow1"), dry.flow("flow2")
    assert (one.takes.count, one.undone) == (0, 1)
    assert (other.takes.max, other.undone) == (SECOND, 0)


def goal(id):
    """Return an ActionGoal without a goal in it: a header, a GoalID."""
    body = struct.pack("<IIII", 0, 0, 0, 0) + struct.pack("<III", 0, 0, len(id)) + id
    return struct.pack("<I", len(body)) + body


WALK = GOALS | {"topic": "/walk/goal", "type": "test/WalkActionGoal", "done": None}


def test_goals_of_an_action_are_known_by_their_ids():
    dry = Dry(Plan(app="base", grcn=(grcn(**WALK),)))
    measured = dry.host.streams[0].measurement
    for id in (b"a", b"b", b"c"):
        measured.add_message("flow1", goal(id), dry.transport.now(), None)
        dry.transport.advance(SECOND)
    measured.add_message("flow1", b"no goal", dry.transport.now(), None)
    measured.finish_goal_without_id(dry.transport.now())
    for id in (b"b", b"b", b"unknown", b""):
        measured.finish_goal(id, dry.transport.now())
    flow = dry.flow("flow1")
    assert (flow.takes.count, flow.takes.max, flow.undone) == (1, 2 * SECOND, 2)


@pytest.mark.parametrize("more", [0, 1, 2])
def test_goals_that_nobody_ends_are_counted_and_let_go(more):
    dry = Dry(Plan(app="base", grcn=(grcn(**WALK),)))
    measured = dry.host.streams[0].measurement
    for n in range(MOST_OPEN + more):
        measured.add_message("flow1", goal(b"%d" % n), n, None)
    assert dry.flow("flow1").undone == MOST_OPEN + more
    assert len(measured._goals) == MOST_OPEN


def test_the_results_of_a_guarded_action_end_its_goals():
    app = Ros1ActionApp()
    measured = app.action.measurement = StreamMeasurement(app.action.spec, FrameRateMeasurement(()))
    app.serve()
    app.send_goal(ONE, b"1")
    app.send_goal(TWO, b"2")
    app.transport.advance(3 * SECOND)
    app.finish(b"1")
    app.transport.advance(4 * SECOND)
    app.finish(b"2")
    one, two, *_ = measured.figures(app.transport.now(), ()).flows
    assert (one.takes.count, one.takes.max, one.undone) == (1, 3 * SECOND, 0)
    assert (two.takes.count, two.takes.max, two.undone) == (1, 7 * SECOND, 0)
    assert (two.waits.count, two.waits.max) == (1, 3 * SECOND)


def test_metres_a_frame_are_measured_once_the_rate_is_known():
    dry = Dry(plan(PolicyName.SAFE, VELOCITY, threshold=0.05))
    nav = dry.says("/rtron/cmd_vel/vflow1", "/nav")
    camera = dry.says("/detector/image", "/detector", IMAGE)
    nav(twist(1.0))
    for n in range(30):
        camera(image(n + 1))
        nav(twist(0.5))
        dry.transport.advance(TENTH)
    dry.says("/cmd_vel", "/rogue")(twist(9.0))
    stream, monitor = dry.measuring.figures().streams[0], dry.measuring.figures().monitors[0]
    assert stream.unseen == 1
    assert stream.per_frame.count == 20
    assert stream.per_frame.max == pytest.approx(0.05)
    assert (monitor.frames, monitor.gaps.max) == (30, TENTH)
    assert monitor.fps.min == monitor.fps.max == pytest.approx(10.0)


def test_a_frozen_picture_is_no_frame():
    dry = Dry(plan(PolicyName.SAFE, VELOCITY, threshold=0.05))
    camera = dry.says("/detector/image", "/detector", IMAGE)
    for _ in range(9):
        camera(image(7))
        dry.transport.advance(TENTH)
    assert dry.measuring.figures().monitors[0].frames == 1


def test_events_are_measured_and_still_judged():
    msrcn = MSRCN(
        id="msrcn",
        mode=Mode.ENFORCE,
        policy=PolicyName.BLOCK,
        aflows=(MOVING,),
        eflows=(LIGHT,),
        rules=(AT_RED,),
    )
    dry = Dry(Plan(app="base", msrcn=msrcn))
    lamp = light(dry.transport)
    nav = dry.says("/rtron/cmd_vel/aflow1", "/nav")
    for colour in ("green", "green", "red"):
        lamp(string(colour))
        dry.transport.advance(TENTH)
    nav(twist(1.0))
    event = dry.measuring.figures().events[0]
    assert (event.name, event.messages, event.gaps.max) == (LIGHT.name, 3, TENTH)
    assert dry.host.streams[0].pipeline.tallies["aflow1"].dropped == 1


def test_figures_are_written_at_once_and_every_now_and_then(dry):
    kept = []
    dry.measuring.write_periodically(kept.append)
    assert len(kept) == 1
    dry.transport.advance(WRITE_PERIOD - 1)
    assert len(kept) == 1
    dry.transport.advance(1)
    dry.transport.advance(3 * WRITE_PERIOD)
    assert [run.duration // WRITE_PERIOD for run in kept] == [0, 1, 2, 3, 4]


def test_a_full_disk_is_told_at_the_start_and_stops_nothing_later(dry, caplog):
    kept = []

    def write(run):
        if len(kept) == 1:
            raise SourceError("no space left")
        kept.append(run)

    dry.measuring.write_periodically(write)
    dry.transport.advance(2 * WRITE_PERIOD)
    assert "no space left" in caplog.text

    def refuse(run):
        raise SourceError("no space left")

    with pytest.raises(SourceError):
        dry.measuring.write_periodically(refuse)


def test_measuring_goes_on_when_a_write_fails_once(dry):
    calls = []

    def write(run):
        calls.append(run)
        if len(calls) == 2:
            raise SourceError("busy")

    dry.measuring.write_periodically(write)
    dry.transport.advance(3 * WRITE_PERIOD)
    assert len(calls) == 4


@pytest.mark.long
def test_nothing_is_kept_of_a_day_but_figures():
    """A day at 1 kHz is only many of the same minute: what is kept must not grow by the second."""
    flows = tuple(
        Flow(name=f"flow{n}", publisher=f"/node{n}", priority=n, timeout=SECOND)
        for n in range(MOST_COMPARED + 8)
    )
    queue = grcn(policy=PolicyName.PRIORITY_QUEUE, flows=flows)
    dry = Dry(Plan(app="base", grcn=(queue,)))
    measured = dry.host.streams[0].measurement
    nodes = [dry.says(f"/rtron/cmd_vel/{flow.name}", flow.publisher) for flow in flows]
    clock = random.Random(1)

    def some(messages):
        for n in range(messages):
            nodes[n % len(nodes)](twist(clock.choice((0.1, 0.2, 0.5))))
            dry.transport.advance(SECOND // 1000)

    def kept():
        own = [tracemalloc.Filter(inclusive=True, filename_pattern="*/guard/measurement/*")]
        return sum(each.size for each in tracemalloc.take_snapshot().filter_traces(own).traces)

    tracemalloc.start()
    some(4_000)
    before = kept()
    some(12_000)
    after = kept()
    tracemalloc.stop()
    assert 0 < after < 1.2 * before
    assert len(measured._held) <= MOST_OPEN
    assert len(measured._active_flows) <= MOST_COMPARED
