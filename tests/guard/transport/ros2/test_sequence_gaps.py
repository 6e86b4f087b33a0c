"""Which messages are missing, by their numbers and by what a queue has replaced."""

import pytest

from rtron.guard.transport.ros2 import delivery
from rtron.guard.transport.ros2.delivery import SequenceGaps

ONE, OTHER = b"one", b"other"


def missing(gaps, numbers, gid=ONE):
    return [gaps.missing_before(gid, number) for number in numbers]


def test_what_is_left_out_between_two_messages_is_missing():
    gaps = SequenceGaps()
    assert missing(gaps, [7, 8, 11, 12]) == [0, 0, 2, 0]
    assert missing(gaps, [100], OTHER) == [0]


def test_what_comes_again_is_not_missing_and_neither_is_what_follows():
    assert missing(SequenceGaps(), [7, 8, 7, 9]) == [0, 0, 0, 0]


def test_without_numbers_nothing_is_known():
    assert missing(SequenceGaps(), [None, 7, None, 8]) == [0, 0, 0, 0]


def test_what_was_seen_and_not_passed_on_is_missing():
    gaps = SequenceGaps()
    gaps.see(ONE, 3)
    gaps.see(ONE, 4)
    gaps.see(OTHER, None)
    assert missing(gaps, [6, 7]) == [3, 0]
    assert missing(gaps, [9], OTHER) == [0]


def test_a_publisher_that_comes_again_begins_anew():
    gaps = SequenceGaps()
    missing(gaps, [7])
    gaps.forget(ONE)
    gaps.forget(OTHER)
    assert missing(gaps, [20]) == [0]


def test_what_was_replaced_and_no_number_shows_was_the_first_of_a_new_publisher():
    gaps = SequenceGaps()
    assert gaps.replaced(0) == (None, 0)
    missing(gaps, [401, 402, 405])
    assert [gaps.replaced(count) for count in (1, 64, 337)] == [(ONE, 0), (ONE, 63), (ONE, 337)]
    missing(gaps, [408])
    assert [gaps.replaced(1), gaps.replaced(1)] == [(ONE, 0)] * 2


def test_gaps_of_others_explain_nothing_of_a_newcomer():
    gaps = SequenceGaps()
    missing(gaps, [1, 9])
    missing(gaps, [5], OTHER)
    assert gaps.replaced(4) == (OTHER, 4)


def test_unknown_publishers_are_bounded(monkeypatch):
    monkeypatch.setattr(delivery, "_MAX_NUMBERED", 1)
    gaps = SequenceGaps()
    gaps.see(ONE, 1)
    gaps.see(OTHER, 1)
    assert missing(gaps, [3]) == [2]
    assert missing(gaps, [3], OTHER) == [0]


@pytest.mark.parametrize("count", [0, 5])
def test_a_newcomer_without_a_loss_has_none(count):
    gaps = SequenceGaps()
    missing(gaps, [1, 2 + count])
    assert gaps.replaced(count) == (ONE, 0)
