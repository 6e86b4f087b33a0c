"""What the command process takes from the board: numbers with their age, the worst where stale."""

from dataclasses import replace

import pytest
from plans import plan_of

from rtron.guard.lanes.command.board_observations import BoardObservations
from rtron.guard.lanes.exchange.board import STALE_AFTER, Board, EventRecord, RateRecord
from rtron.policies.mission.event_bits import EventState
from rtron.vocabulary import (
    MSRCN,
    SECOND,
    EventFlow,
    FpsMonitor,
    MissionRule,
    Mode,
    PolicyName,
    WhenUnknown,
)

MONITOR = FpsMonitor(id="fps", node="/detector", topic="/image", silent_after=10 * SECOND)
RED = EventFlow(name="red", topic="/light", publisher="/light", max_age=100 * SECOND)
NOW = 1000 * SECOND


LENIENT = EventFlow(
    name="red",
    topic="/light",
    publisher="/light",
    max_age=100 * SECOND,
    on_silence=WhenUnknown.CLEAR,
)
PRESENT = replace(LENIENT, present=30 * SECOND)
"""Both count as "not red" when nobody says anything."""


def plan(red=RED, **rule):
    msrcn = MSRCN(
        id="msrcn",
        mode=Mode.ENFORCE,
        policy=PolicyName.BLOCK,
        eflows=(red,),
        rules=(MissionRule(name="light", when="red", block=("/cmd_vel",), **rule),),
    )
    return plan_of(msrcn=msrcn, fps_monitor=(MONITOR,))


class Boarded:
    """The observations of a command process, and the board that the bulk process writes."""

    def __init__(self, red=RED, **rule):
        self.observed = BoardObservations(plan(red, **rule))
        self.board = Board.create(1, 1)

    def connect(self, now=NOW):
        self.observed.connect(self.board, now)

    def frame(self, fps, at=NOW, written_at=NOW):
        self.board.write_rate(0, RateRecord(fps, at, written_at))

    def event(self, *, red, at=NOW, count=0):
        state = EventState(1, at, red, at if red else None, count)
        self.board.write_event(0, EventRecord(state, at))

    def rate(self, now=NOW):
        return self.observed.observations.rates.lowest_rate(now)

    def red(self, now=NOW):
        self.observed.update(now)
        return self.observed.observations.mission.bits.known_values(now).get("red")

    @property
    def rule(self):
        return self.observed.observations.mission.statuses["light"]


@pytest.fixture
def boarded():
    return Boarded()


def test_without_a_board_everything_is_silent(boarded):
    assert boarded.rate().is_silent
    assert boarded.red() is None
    assert boarded.rule.is_blocking


def test_a_rate_is_what_was_counted_and_falls_with_its_age(boarded):
    boarded.connect()
    assert boarded.rate().is_silent
    boarded.frame(30.0)
    assert (boarded.rate().fps, boarded.rate().age) == (30.0, 0)
    assert boarded.rate(NOW + SECOND // 4).fps == 4.0


@pytest.mark.parametrize(
    ("later", "silent"), [(0, False), (STALE_AFTER - 1, False), (STALE_AFTER, True)]
)
def test_a_number_that_is_stale_is_the_worst_one(boarded, later, silent):
    boarded.connect()
    boarded.frame(30.0)
    boarded.event(red=False)
    assert boarded.red() is False
    assert boarded.rate(NOW + later).is_silent is silent
    assert boarded.red(NOW + later) is (None if silent else False)
    assert boarded.rule.is_blocking is silent


def test_an_image_node_is_silent_from_the_plans_bound_although_the_number_is_fresh(boarded):
    boarded.connect()
    last = NOW - MONITOR.silent_after
    boarded.frame(1.0, at=last, written_at=NOW)
    assert boarded.rate(NOW - 1).is_silent is False
    assert boarded.rate().is_silent
    assert boarded.observed.observations.rates.deadline(NOW - 1) == NOW


def test_a_board_that_goes_takes_everything_with_it(boarded):
    boarded.connect()
    boarded.frame(30.0)
    boarded.event(red=False)
    assert not boarded.rate().is_silent
    assert boarded.red() is False
    boarded.observed.connect(None, NOW)
    assert boarded.rate().is_silent
    assert boarded.red() is None


def test_an_event_that_was_heard_before_the_connection_meets_no_rule():
    boarded = Boarded(require="red")
    boarded.event(red=True, count=3)
    boarded.connect()
    assert boarded.red()
    assert boarded.rule.is_blocking
    boarded.event(red=True, count=4)
    assert boarded.red()
    assert not boarded.rule.is_blocking


def test_an_event_that_is_fresh_again_was_not_heard_again():
    boarded = Boarded(require="red")
    boarded.connect()
    for count in (1, 2):
        boarded.event(red=True, count=count)
        boarded.red()
    assert not boarded.rule.is_blocking
    later = NOW + STALE_AFTER
    assert boarded.red(later) is None
    state = EventState(publishers=1, newest=NOW, judged=True, triggered=NOW, true_count=2)
    boarded.board.write_event(0, EventRecord(state, later))
    assert boarded.red(later) is True
    assert boarded.rule.is_blocking


@pytest.mark.parametrize("flow", [LENIENT, PRESENT])
def test_a_stale_bit_is_not_known_whatever_silence_counts_as(flow):
    boarded = Boarded(flow)
    assert boarded.red() is None
    boarded.connect()
    boarded.event(red=True)
    assert boarded.red() is True
    assert boarded.red(NOW + STALE_AFTER) is None
    assert boarded.rule.is_blocking
    boarded.observed.connect(None, NOW)
    assert boarded.red() is None


class Restarted(Boarded):
    """The same, after the bulk process was replaced: the next one has heard nothing yet."""

    def __init__(self, red, *, was_red, publishers=1):
        super().__init__(red)
        self.connect()
        self.event(red=was_red)
        self.red()
        self.observed.connect(None, NOW)
        self.board = Board.create(1, 1)
        self.hears_nothing(publishers)
        self.connect()

    def hears_nothing(self, publishers, now=NOW):
        self.board.write_event(0, EventRecord(EventState(publishers), now))


@pytest.mark.parametrize("publishers", [0, 1])
@pytest.mark.parametrize("flow", [LENIENT, PRESENT])
def test_an_event_outlives_the_process_that_has_heard_it(flow, publishers):
    boarded = Restarted(flow, was_red=True, publishers=publishers)
    assert boarded.red() is True
    assert boarded.rule.is_blocking


def test_what_nobody_says_again_in_time_is_silence():
    boarded = Restarted(LENIENT, was_red=True, publishers=0)
    for later, red in ((5 * SECOND - 1, True), (5 * SECOND, False)):
        boarded.hears_nothing(0, NOW + later)
        assert boarded.red(NOW + later) is red


def test_presence_lasts_as_long_as_the_plan_says_also_over_a_restart():
    boarded = Restarted(PRESENT, was_red=True)
    for later, red in ((30 * SECOND - 1, True), (30 * SECOND, False)):
        boarded.hears_nothing(1, NOW + later)
        assert boarded.red(NOW + later) is red


def test_what_the_next_process_hears_takes_the_place_of_what_was_heard():
    boarded = Restarted(LENIENT, was_red=True)
    boarded.event(red=False, at=NOW + 1)
    assert boarded.red(NOW + 1) is False
    boarded.board.write_event(0, EventRecord(EventState(), NOW + 2))
    assert boarded.red(NOW + 2) is False, "silence, which counts as not red"
    boarded.observed.connect(None, NOW + 3)
    assert boarded.red(NOW + 3) is None


def test_an_old_event_over_a_restart_meets_no_rule():
    boarded = Restarted(RED, was_red=True)
    assert boarded.red() is True
    assert not boarded.rule.is_met
