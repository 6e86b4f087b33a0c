"""What the command process takes from the board: numbers with their age, the worst where stale."""

import pytest
from plans import plan_of

from rtron.guard.lanes.board import STALE_AFTER, Board, EventRecord, RateRecord
from rtron.guard.lanes.board_observations import BoardObservations
from rtron.policies.mission.event_bits import EventState
from rtron.vocabulary import MSRCN, SECOND, EventFlow, FpsMonitor, MissionRule, Mode, PolicyName

MONITOR = FpsMonitor(id="fps", node="/detector", topic="/image", silent_after=10 * SECOND)
RED = EventFlow(name="red", topic="/light", publisher="/light", max_age=100 * SECOND)
NOW = 1000 * SECOND


def plan(**rule):
    msrcn = MSRCN(
        id="msrcn",
        mode=Mode.ENFORCE,
        policy=PolicyName.BLOCK,
        eflows=(RED,),
        rules=(MissionRule(name="light", when="red", block=("/cmd_vel",), **rule),),
    )
    return plan_of(msrcn=msrcn, fps_monitor=(MONITOR,))


class Boarded:
    """The observations of a command process, and the board that the bulk process writes."""

    def __init__(self, **rule):
        self.observed = BoardObservations(plan(**rule))
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
    assert boarded.observed.view.written_at == 0


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
