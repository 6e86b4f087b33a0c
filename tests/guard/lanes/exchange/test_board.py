"""The numbers that one process writes and another reads: whole, or not there."""

import os

import pytest
from hypothesis import given
from hypothesis import strategies as st

from rtron.guard.lanes.exchange.board import Board, EventRecord, RateRecord
from rtron.policies.mission.event_bits import EventState

times = st.integers(0, (1 << 63) - 1)
some_times = st.none() | times
states = st.builds(
    EventState,
    st.integers(0, 1 << 20),
    some_times,
    st.sampled_from([True, False, None]),
    some_times,
    st.integers(0, 1 << 40),
)


@pytest.fixture
def boards():
    """A board and the same one as another process sees it."""
    board = Board.create(2, 2)
    other = Board(os.dup(board.descriptor), 2, 2)
    yield board, other
    board.close()
    other.close()


def test_nothing_stands_there_at_first(boards):
    for board in boards:
        assert (board.rate(0), board.event(1)) == (None, None)


@given(st.floats(0, 1000), times, times, states)
def test_what_is_written_is_read_by_the_other_process(fps, last_frame_at, written_at, state):
    board = Board.create(2, 2)
    other = Board(os.dup(board.descriptor), 2, 2)
    board.write_rate(1, RateRecord(fps, last_frame_at, written_at))
    board.write_event(0, EventRecord(state, written_at))
    assert other.rate(1) == RateRecord(fps, last_frame_at, written_at)
    assert other.event(0) == EventRecord(state, written_at)
    assert (other.rate(0), other.event(1)) == (None, None)
    board.close()
    other.close()


def test_a_record_that_is_torn_is_not_there_and_the_one_before_is(boards):
    board, other = boards
    board.write_rate(0, RateRecord(30.0, 7, 8))
    board.write_rate(0, RateRecord(2.0, 9, 10))
    assert other.rate(0) == RateRecord(2.0, 9, 10)
    buffer = board._rates[0]
    newest = buffer._halves[0]
    board._memory[newest + 20] ^= 1
    assert other.rate(0) == RateRecord(30.0, 7, 8)
    board._memory[buffer._halves[1] + 20] ^= 1
    assert other.rate(0) is None
