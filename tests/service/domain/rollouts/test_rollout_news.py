"""What is new of roll-outs is told once a second at most, and nothing is missed."""

import pytest

from rtron.service.domain.rollouts.observations import RolloutNews, going_back_alert
from rtron.service.domain.rollouts.schemas import RolloutState
from rtron.vocabulary import SECOND


def test_what_changes_within_a_second_is_new_later():
    news = RolloutNews()
    shown = {0: "a", 1: "a", 2: "b", SECOND - 1: "c", SECOND: "c", SECOND + 1: "c"}
    assert [at for at, each in shown.items() if news.is_new(1, each, at)] == [0, SECOND]
    assert not news.is_new(1, "c", 10 * SECOND)
    assert news.is_new(1, "a", 10 * SECOND)
    assert news.is_new(2, "a", 10 * SECOND)


@pytest.mark.parametrize("jump", [-100 * SECOND, 100 * SECOND])
def test_a_clock_that_is_set_hides_nothing(jump):
    news = RolloutNews()
    assert news.is_new(1, "a", 0)
    assert news.is_new(1, "b", jump)


def test_an_end_is_told_once():
    news = RolloutNews()
    for id in (3, 1, 2):
        news.is_new(id, "a", 0)
    assert news.take_ended([2]) == [1, 3]
    assert news.take_ended([2]) == []


BACK = {RolloutState.REVERTING, RolloutState.REVERTED}


@pytest.mark.parametrize("before", RolloutState)
@pytest.mark.parametrize("state", RolloutState)
def test_going_back_is_an_alert_when_it_begins(before, state):
    expected = "roll-out 3 goes back by itself: why" if state in BACK and before not in BACK else ""
    assert going_back_alert(3, before, state, "why") == expected


def test_a_long_reason_is_cut():
    alert = going_back_alert(3, RolloutState.RUNNING, RolloutState.REVERTING, "x" * 5000)
    assert len(alert) == 1000
