"""What is lost without a verdict: counted by flow and by topic, logged now and then, and shown."""

import logging

import pytest
from streams import peer, stage, stream

from rtron.guard.coordinator import Coordinator
from rtron.guard.core.losses import PERIOD, Losses
from rtron.guard.link.stream_monitor import StreamMonitor
from rtron.guard.transport.common.memory import MemoryTransport
from rtron.guard.transport.common.protocol import DEFAULT_OUTPUT
from rtron.vocabulary import SECOND, UNAPPROVED, Mode, StreamKind, VerdictCounts

FLOW1, PUBLIC, OUT = "/rtron/cmd_vel/flow1", "/cmd_vel", "/rtron/cmd_vel/out"


def test_losses_are_logged_at_once_and_then_summed_for_a_while(caplog):
    losses = Losses("/t")
    losses.update({}, 0)
    assert not losses.are_recent(0)
    losses.count("nav", 3)
    losses.count("nav", 4)
    losses.update({"/out": 1}, 5)
    losses.count("nav", 10)
    losses.update({"/out": 1}, PERIOD + 4)
    losses.count("teleop", 1)
    losses.update({"/out": 1}, PERIOD + 5)
    losses.update({"/out": 1}, 9 * PERIOD)
    assert [record.getMessage() for record in caplog.records] == [
        "/t: messages were lost: 7 of nav, before the guard; 1 on /out, behind the guard",
        "/t: messages were lost: 10 of nav, before the guard; 1 of teleop, before the guard",
    ]


def test_losses_are_recent_for_a_while_after_the_last():
    losses = Losses("/t")
    losses.update({"/out": 1}, 5)
    losses.update({"/out": 1}, PERIOD)
    assert losses.are_recent(PERIOD + 4)
    assert not losses.are_recent(PERIOD + 5)
    losses.update({"/out": 2}, 2 * PERIOD)
    assert losses.are_recent(3 * PERIOD - 1)


class Guard:
    """A guard of /cmd_vel in memory."""

    def __init__(self, mode=Mode.ENFORCE):
        self.transport = MemoryTransport()
        self.host = Coordinator(self.transport, [stream(stage(), mode=mode)])
        self.host.open()
        (self.stream,) = self.host.streams

    @property
    def status(self):
        return self.host.statuses()[0]

    @property
    def before(self):
        return self.stream.losses.before


@pytest.mark.parametrize(
    ("topic", "who", "flow"),
    [
        (FLOW1, peer("/nav"), "flow1"),
        (FLOW1, peer("/rogue"), UNAPPROVED),
        (FLOW1, peer("/nav", verified=False), UNAPPROVED),
        (PUBLIC, peer("/nav"), UNAPPROVED),
    ],
)
def test_what_is_lost_before_the_guard_counts_for_its_flow(topic, who, flow):
    guard = Guard()
    guard.transport.miss(topic, who, 3)
    guard.transport.miss(topic, who, 2)
    assert guard.before == {flow: 5}


def test_where_the_guard_only_looks_on_the_public_name_is_that_of_the_flows():
    guard = Guard(mode=Mode.OBSERVE)
    guard.transport.miss(PUBLIC, peer("/nav"), 3)
    guard.transport.miss(PUBLIC, peer("/rogue"), 2)
    assert guard.before == {"flow1": 3, UNAPPROVED: 2}


def test_losses_are_in_the_diagnostics_and_in_the_log(caplog):
    guard = Guard()
    assert not [key for key in guard.status.values if "lost" in key]
    guard.transport.miss(FLOW1, peer("/nav"), 3)
    guard.transport.outputs[OUT].lost = 2
    guard.transport.outputs[PUBLIC].lost = 4
    with caplog.at_level(logging.WARNING):
        guard.transport.advance(SECOND)
    assert (guard.status.level, guard.status.values["lost before the guard, flow1"]) == (1, "3")
    assert guard.status.values[f"lost behind the guard, {OUT}"] == "2"
    assert guard.status.values[f"lost behind the guard, {PUBLIC}"] == "4"
    assert "3 of flow1, before the guard" in caplog.text
    guard.transport.advance(2 * PERIOD)
    assert guard.status.level == 0


def test_losses_go_to_the_service_as_they_happen_and_as_a_sum():
    guard = Guard()
    monitor = StreamMonitor(guard.stream)
    assert monitor.figures(0) is None
    guard.transport.miss(FLOW1, peer("/nav"), 3)
    guard.transport.outputs[OUT].lost = 2
    figures = monitor.figures(0)
    assert (figures["flows"], figures["lost"]) == ({}, [3, 2])
    assert monitor.figures(0) is None
    state = monitor.state(0)
    assert state.flows["flow1"] == VerdictCounts(lost=3)
    assert state.lost_behind == 2


class Depths(MemoryTransport):
    """Knows how much is kept on each topic."""

    def __init__(self):
        super().__init__()
        self.kept = {}

    def advertise(self, node, topic, type, options=DEFAULT_OUTPUT):
        self.kept["out", topic] = (options.queue_size, options.keep_all)
        return super().advertise(node, topic, type, options)

    def subscribe(self, node, topic, type, connect, options):
        self.kept["in", topic] = (options.queue_size, options.keep_all)
        super().subscribe(node, topic, type, connect, options)


@pytest.mark.parametrize(
    ("kind", "all_count"),
    [(StreamKind.STATE, True), (StreamKind.ACTION, True), (StreamKind.COMMAND, False)],
)
def test_the_queues_of_a_stream_are_as_the_plan_says_and_all_of_a_state_is_kept(kind, all_count):
    transport = Depths()
    Coordinator(transport, [stream(stage(kind=kind), queue_size=7)]).open()
    kept = {end: transport.kept[end] for end in (("in", FLOW1), ("in", PUBLIC), ("out", OUT))}
    assert set(kept.values()) == {(7, all_count)}
