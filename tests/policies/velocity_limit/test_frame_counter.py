"""The frame rate: a window, stamps that say which frame, and floods that are none."""

from copy import deepcopy
from itertools import pairwise

import pytest
from event_and_rate_models import NaiveFrameRate
from hypothesis import given
from hypothesis import strategies as st
from policy_runs import often

from rtron.policies.velocity_limit.frame_counter import MAX_FPS, FrameCounter
from rtron.vocabulary import SECOND

WINDOW = 5_000_000
MOST = 5
gaps = st.sampled_from([0, 0, 1, WINDOW // 5, WINDOW // 2, *(WINDOW + d for d in (-1, 0, 1))])
stamps = st.sampled_from([0, 0, 1, 2, 3, -7, 10**30]) | st.integers(0, 12)
frames = st.lists(st.tuples(gaps, stamps), max_size=40)


def play(frames, window=WINDOW):
    """Return a rate after frames of (arrival, stamp)."""
    rate = FrameCounter(window)
    for at, stamp in frames:
        rate.add_frame(stamp, at)
    return rate


@often
@given(frames, st.sampled_from([WINDOW, 1, 999_999, 1_000_000, 1_500_000, 2_000_000]))
def test_it_is_what_a_naive_model_says(frames, window):
    rate, model, now = FrameCounter(window), NaiveFrameRate(window), 0
    for gap, stamp in frames:
        now += gap
        assert rate.add_frame(stamp, now) is model.frame(stamp, now)
        for later in (0, 1, window - 1, window, window + 1):
            assert FrameCounter.rate(play_copy(rate), now + later) == model.rate(now + later)


def play_copy(rate):
    """Return a copy, since to ask about later forgets what is old then."""
    return deepcopy(rate)


@often
@given(frames, gaps, gaps)
def test_while_no_frame_comes_the_rate_only_falls(frames, one, other):
    rate, now = FrameCounter(WINDOW), 0
    for gap, stamp in frames:
        now += gap
        rate.add_frame(stamp, now)
    rates = [rate.rate(now + later) for later in sorted({0, one, one + other})]
    assert all(before >= after for before, after in pairwise(rates))


@often
@given(frames, gaps)
def test_the_rate_is_never_above_one_frame_in_the_time_since_the_last(frames, gap):
    rate, now, last = FrameCounter(WINDOW), 0, None
    for wait, stamp in frames:
        now += wait
        if rate.add_frame(stamp, now):
            last = now
    now += gap
    if last is not None and now > last:
        assert rate.rate(now) <= SECOND / (now - last)


@often
@given(frames, st.sampled_from([1, 2, 10**18, -3, -(10**18)]))
def test_a_jump_of_the_cameras_clock_does_no_harm(frames, jump):
    """Only whether stamps are the same counts; 0 alone has a meaning."""
    told = [(gap, stamp) for gap, stamp in frames if 0 not in (stamp, stamp + jump)]
    one, other, now = FrameCounter(WINDOW), FrameCounter(WINDOW), 0
    for gap, stamp in told:
        now += gap
        assert one.add_frame(stamp, now) is other.add_frame(stamp + jump, now)
        assert one.rate(now) == other.rate(now)


@pytest.mark.parametrize(("later", "fps"), [(WINDOW - 1, SECOND / (WINDOW - 1)), (WINDOW, 0)])
def test_a_frame_counts_for_the_window(later, fps):
    assert play([(7, 1)]).rate(7 + later) == pytest.approx(min(fps, SECOND / WINDOW), rel=1e-6)


def test_thirty_frames_a_second_are_thirty_fps():
    rate = play([(number * SECOND // 30, number + 1) for number in range(90)], SECOND)
    assert rate.rate(89 * SECOND // 30) == pytest.approx(30, rel=1e-6)


@pytest.mark.parametrize(("gap", "counts"), [(1, False), (WINDOW - 1, False), (WINDOW, True)])
def test_a_stamp_that_was_counted_within_the_window_is_not_counted_again(gap, counts):
    assert play([(7, 1), (8, 2)]).add_frame(1, 7 + gap) is counts


def test_a_stamp_that_was_forgotten_counts_once():
    rate = play([(0, 1), (1, 2), (WINDOW, 1)])
    assert not rate.add_frame(1, 2 * WINDOW - 1)
    assert rate.last_frame_age(2 * WINDOW - 1) == WINDOW - 1


def test_a_frozen_picture_is_no_frame_however_long_it_is_shown():
    rate = play([(0, 1)])
    assert not any(rate.add_frame(1, at * WINDOW // 2) for at in range(9))
    assert rate.rate(9 * WINDOW // 2) == 0
    assert rate.add_frame(2, 5 * WINDOW)


def test_alternating_stamps_are_two_frames():
    rate = play([(at, at % 2 + 1) for at in range(100)])
    assert rate.rate(99) == 2 * SECOND / WINDOW


def test_without_a_stamp_each_message_is_a_frame():
    rate = play([(at, 0) for at in range(4)])
    assert rate.rate(3) == 4 * SECOND / WINDOW


def test_what_leaves_the_window_is_no_longer_counted():
    rate = play([(0, 1), (1, 2), (2, 3)])
    assert [rate.rate(WINDOW + at) > 0 for at in (0, 1, 2)] == [True, True, False]


def test_a_flood_is_no_camera():
    rate = play([(number, number + 1) for number in range(20_000)], SECOND)
    assert rate.rate(19_999) <= MAX_FPS == 1000
    assert len(rate._frames) == len(rate._stamps) == MAX_FPS


def test_after_a_flood_frames_count_again():
    rate = play([(number, number + 1) for number in range(MOST + 1)])
    assert not rate.add_frame(99, WINDOW - 1)
    assert rate.add_frame(99, WINDOW)


def test_the_age_is_that_of_the_last_frame_that_counted():
    rate = play([(0, 1), (10, 2), (20, 2)])
    assert rate.last_frame_age(25) == 15
    assert rate.last_frame_age(10 + WINDOW) is None
    assert FrameCounter(WINDOW).last_frame_age(0) is None


def test_the_rate_before_the_first_frame_is_none():
    assert FrameCounter(WINDOW).rate(10) == 0


def filmed(*parts):
    """Return a rate after frames, each after its gap, and the time of the last."""
    rate, now = FrameCounter(SECOND), 0
    for stamp, gap in enumerate(parts):
        now += gap
        rate.add_frame(stamp + 1, now)
    return rate, now


FAST, SLOW = SECOND // 30, SECOND // 2


@pytest.mark.parametrize("late", range(1, 6))
def test_a_late_frame_does_not_bring_the_fast_ones_back(late):
    """From 30 to 2 fps: the window still holds the fast frames when the first slow one comes."""
    rate, now = filmed(*[FAST] * 60, *[SLOW] * late)
    for later in (0, 1, SLOW // 2, SLOW - 1):
        assert rate.rate(now + later) <= 2
    assert rate.rate(now) == 2


@pytest.mark.parametrize(("after", "fps"), [(0, 2), (1, 2), (29, 2), (30, 2), (31, 30)])
def test_one_late_frame_counts_until_its_gap_leaves_the_window(after, fps):
    rate, now = filmed(*[FAST] * 60, SLOW, *[FAST] * after)
    assert rate.rate(now) == pytest.approx(fps, rel=1e-6)


def test_after_a_silence_the_rate_begins_at_one_frame_in_the_window():
    rate, now = filmed(FAST, FAST, 60 * SECOND, *[FAST] * 10)
    assert rate.rate(now) == 1


@often
@given(frames, gaps)
def test_the_rate_is_never_above_one_frame_in_a_gap_of_the_window(frames, later):
    rate, now, counted = FrameCounter(WINDOW), 0, []
    for wait, stamp in frames:
        now += wait
        if rate.add_frame(stamp, now):
            counted.append(now)
    now += later
    for one, other in pairwise(counted):
        if now - other < WINDOW and other > one:
            assert rate.rate(now) <= SECOND / min(other - one, WINDOW)


@often
@given(frames)
def test_only_the_gaps_that_still_matter_are_kept(frames):
    rate, now = FrameCounter(WINDOW), 0
    for wait, stamp in frames:
        now += wait
        rate.add_frame(stamp, now)
        kept = [gap for _, gap in rate._gaps._longest_first]
        assert kept == sorted(kept, reverse=True)
        assert len(set(kept)) == len(kept)
