"""The stop wave: when it begins, how it falls, and when it is over."""

from itertools import pairwise

import pytest
from hypothesis import given
from hypothesis import strategies as st
from policy_runs import TICK, often, watch_effects

from rtron.policies.state_machine import TransitionEffect
from rtron.policies.velocity_watchdog import (
    MAX_RAMP_DURATION,
    VelocityRamp,
    VelocityWatchdog,
    WatchdogState,
)
from rtron.vocabulary import SECOND, Flow, OnSilence, StopProfile, Velocity

SILENT = SECOND // 2
PERIOD, REPEAT = SECOND // 20, SECOND
STOP = StopProfile(decel=2.0, angular_decel=4.0, period=PERIOD, repeat=REPEAT)
FLOW = Flow(name="flow1", publisher="/nav", silent_after=SILENT)
RELEASING = Flow(name="flow2", publisher="/nav", silent_after=SILENT, on_silence=OnSilence.RELEASE)
FORWARD = Velocity((1.0, 0.0, 0.0), (0.0, 0.0, 0.5))
RAMP = SECOND // 2


def stopping(velocity=FORWARD, stop=STOP):
    return VelocityWatchdog(stop, lambda: velocity)


def moving(velocity=FORWARD, flow=FLOW, now=0, stop=STOP):
    made = stopping(velocity, stop)
    made.record_output(flow, now)
    return made


def wave(stopping, until=60 * SECOND):
    """Return (time, velocity) of what goes out at the deadlines."""
    out = []
    while (due := stopping.deadline()) is not None and due <= until:
        if (velocity := stopping.tick(due)) is not None:
            out.append((due, velocity))
    return out


def state(stopping):
    return stopping._machine.state


# When


def test_a_stream_that_says_nothing_rests():
    made = stopping()
    assert (made.deadline(), made.moving_flow, made.reason, made.last_flow) == (None, None, "", "")
    assert made.tick(10**12) is None


def test_a_message_moves_the_robot():
    made = moving(now=7)
    assert made.moving_flow is FLOW
    assert made.deadline() == 7 + SILENT
    assert made.reason == ""


@pytest.mark.parametrize(("later", "stops"), [(SILENT - 1, False), (SILENT, True)])
def test_silence_counts_from_its_bound(later, stops):
    made = moving(now=7)
    assert (made.tick(7 + later) is not None) is stops
    assert (made.moving_flow is None) is stops
    assert made.reason == ("flow1 has been silent for 0.50 s" if stops else "")


def test_every_message_puts_silence_off():
    made = moving(now=0)
    made.record_output(FLOW, SILENT - 1)
    assert made.tick(SILENT) is None
    assert made.deadline() == 2 * SILENT - 1


def test_a_flow_may_release_the_robot_instead():
    made = moving(flow=RELEASING)
    assert made.tick(SILENT - 1) is None
    assert made.moving_flow is RELEASING
    assert made.tick(SILENT) is None
    assert (state(made), made.deadline(), made.reason) == (WatchdogState.RELEASED, None, "")


def test_what_was_released_is_told_to_rest_without_a_ramp_when_it_may_not_go_on():
    made = moving(flow=RELEASING)
    made.tick(SILENT)
    made.refuse("rule fire: no goals in a fire", SILENT + 9)
    assert made.reason == "rule fire: no goals in a fire"
    assert not made.tick(SILENT + 9).is_moving


def test_what_was_released_may_speak_again():
    made = moving(flow=RELEASING)
    made.tick(SILENT)
    made.record_output(RELEASING, SILENT + 1)
    assert (state(made), made.moving_flow) == (WatchdogState.MOVING, RELEASING)


def test_what_somebody_else_has_stopped_is_not_ramped_down_once_more():
    made = moving()
    made.mark_stopped_elsewhere()
    assert (state(made), made.deadline()) == (WatchdogState.RELEASED, None)
    made.refuse("rule", 5)
    assert {velocity.speed for _, velocity in wave(made)} == {0.0}


def test_what_somebody_else_has_stopped_moves_again_with_the_next_message():
    made = moving()
    made.mark_stopped_elsewhere()
    made.record_output(FLOW, 7)
    assert (state(made), made.deadline()) == (WatchdogState.MOVING, 7 + SILENT)


@pytest.mark.parametrize("refused", [False, True])
def test_who_rests_or_is_being_stopped_is_not_interrupted(refused):
    made = moving() if refused else stopping()
    if refused:
        made.refuse("rule", 5)
    before = (state(made), made.deadline(), made.reason)
    made.mark_stopped_elsewhere()
    assert (state(made), made.deadline(), made.reason) == before


def test_the_last_flow_says_what_silence_means():
    made = moving(flow=RELEASING)
    made.record_output(FLOW, 1)
    assert made.tick(1 + SILENT) is not None
    assert made.last_flow == "flow1"


def test_what_may_not_go_on_is_stopped_at_once():
    made = moving()
    made.refuse("rule fire: no goals in a fire", 9)
    assert made.reason == "rule fire: no goals in a fire"
    assert (made.deadline(), made.moving_flow, made.last_flow) == (9, None, "flow1")
    assert made.tick(9) is not None


def test_a_robot_at_rest_is_not_stopped():
    made = stopping()
    made.refuse("blocked", 5)
    assert (state(made), made.deadline(), made.reason) == (WatchdogState.RESTING, None, "")


@pytest.mark.parametrize("velocity", [Velocity((0.0, -0.0), (0.0,)), Velocity(())])
def test_a_robot_that_was_told_to_rest_is_not_stopped(velocity):
    refused, silent = moving(velocity), moving(velocity)
    refused.refuse("blocked", 5)
    assert silent.tick(SILENT) is None
    for made in (refused, silent):
        assert (state(made), made.deadline(), made.reason) == (WatchdogState.RESTING, None, "")


@pytest.mark.parametrize("velocity", [Velocity((0.0,), (0.1,)), Velocity((5e-324,))])
def test_whatever_moves_is_stopped(velocity):
    assert moving(velocity).tick(SILENT) is not None


def test_a_second_refusal_changes_nothing():
    made = moving()
    made.refuse("one", 0)
    first = made.tick(0)
    made.refuse("other", PERIOD // 2)
    assert (made.reason, made.deadline()) == ("one", PERIOD)
    assert made.tick(PERIOD).speed < first.speed


def test_the_waves_are_counted():
    made, resting = moving(), moving(Velocity((0.0,)))
    assert made.stop_count == 0
    for number in (1, 2, 3):
        made.refuse("blocked", number)
        made.refuse("blocked still", number)
        assert made.stop_count == number
        made.record_output(FLOW, number)
    made.tick(3 + SILENT)
    assert made.stop_count == 4
    resting.refuse("blocked", 0)
    assert resting.stop_count == 0


def test_a_message_ends_the_wave():
    made = moving()
    made.refuse("blocked", 0)
    made.tick(0)
    other = Flow(name="flow3", publisher="/other", silent_after=3)
    made.record_output(other, 10)
    assert (made.reason, made.moving_flow, made.deadline()) == ("", other, 13)
    assert made.tick(12) is None


# How


def test_the_wave():
    """A ramp of 2 m/s2 from 1 m/s, a message each period for what holds until the next."""
    made = moving()
    made.refuse("blocked", 0)
    out = wave(made)
    assert [at for at, _ in out] == [number * PERIOD for number in range(30)]
    speeds = [velocity.speed for _, velocity in out]
    assert speeds[:9] == pytest.approx([0.9, 0.8, 0.7, 0.6, 0.5, 0.4, 0.3, 0.2, 0.1])
    assert speeds[9:] == [0.0] * 21
    assert (state(made), made.deadline(), made.reason) == (WatchdogState.RESTING, None, "")


@pytest.mark.parametrize(
    ("velocity", "lasts"),
    [
        (Velocity((1.0,)), SECOND // 2),
        (Velocity((-1.0,)), SECOND // 2),
        (Velocity((3.0, 4.0), (1.0,)), 5 * SECOND // 2),
        (Velocity((1.0,), (4.0,)), SECOND),
        (Velocity((0.0,), (0.0, 0.0, -2.0)), SECOND // 2),
        (Velocity(()), 0),
        (Velocity((20.0,)), MAX_RAMP_DURATION),
        (Velocity((20.1,)), MAX_RAMP_DURATION),
        (Velocity((0.0,), (40.0,)), MAX_RAMP_DURATION),
        (Velocity((0.0,), (40.1,)), 0),
        (Velocity((1.0,), (40.1,)), SECOND // 2),
        (Velocity((1e308, 1e308), (1e308,)), MAX_RAMP_DURATION),
        (Velocity((1.7e308, 1.7e308)), MAX_RAMP_DURATION),
        (Velocity((5e-324,)), 0),
    ],
)
def test_the_ramp_is_as_steep_as_both_limits_allow_but_ends(velocity, lasts):
    ramp = VelocityRamp.for_stop(velocity, STOP, 7)
    assert (ramp.started_at, ramp.duration, ramp.velocity) == (7, lasts, velocity)
    assert ramp.at(7 + lasts) == velocity.scaled(0.0)


@pytest.mark.parametrize(("at", "share"), [(0, 1), (1, 0.75), (3, 0.25), (4, 0), (5, 0), (99, 0)])
def test_the_ramp_is_straight_and_ends_at_0(at, share):
    assert VelocityRamp(FORWARD, 10, 4).at(10 + at) == FORWARD.scaled(share)


def test_the_ramp_of_the_longest_is_ten_seconds():
    assert MAX_RAMP_DURATION == 10 * SECOND


def test_what_cannot_be_read_is_at_rest_at_once():
    made = moving(None)
    made.refuse("blocked", 0)
    out = wave(made)
    assert [at for at, _ in out] == [number * PERIOD for number in range(20)]
    assert {velocity for _, velocity in out} == {Velocity(())}


def test_what_went_out_last_is_asked_for_when_the_wave_begins():
    last = [FORWARD]
    made = VelocityWatchdog(STOP, lambda: last[0])
    made.record_output(FLOW, 0)
    last[0] = Velocity((0.1,))
    made.refuse("blocked", 0)
    last[0] = Velocity((5.0,))
    assert made.tick(0).speed < 0.1


@pytest.mark.parametrize(("late", "count"), [(-1, 0), (0, 1), (1, 1)])
def test_between_two_messages_lies_a_period(late, count):
    made = moving()
    made.refuse("blocked", 0)
    made.tick(0)
    assert (made.tick(PERIOD + late) is not None) is bool(count)
    assert made.deadline() == (PERIOD + late + PERIOD if count else PERIOD)


@pytest.mark.parametrize(("at", "over"), [(RAMP + REPEAT - 1, False), (RAMP + REPEAT, True)])
def test_zeros_are_repeated_for_their_time(at, over):
    made = moving()
    made.refuse("blocked", 0)
    assert (made.tick(at) is None) is over
    assert (made.deadline() is None) is over
    assert (made.reason == "") is over


@pytest.mark.parametrize("before", ["resting", "moving", "released", "stopping"])
def test_the_brake_holds_until_it_is_loosened_and_then_ends_as_any_stop(before):
    made = {
        "resting": stopping,
        "moving": moving,
        "released": lambda: moving(flow=RELEASING),
        "stopping": moving,
    }[before]()
    if before == "released":
        made.tick(SILENT)
    if before == "stopping":
        made.refuse("blocked", SILENT)
    made.brake("a foreign publisher", SILENT)
    assert made.reason == "a foreign publisher"
    assert made.stop_count == 1
    end = SILENT + RAMP + 10 * REPEAT
    sent = wave(made, until=end)
    ramped = before in ("moving", "stopping")
    assert sent[0][1].is_moving is ramped
    assert not sent[-1][1].is_moving
    assert sent[-1][0] > end - 2 * PERIOD
    made.release_brake()
    assert made.tick(made.deadline()) is None
    assert (made.deadline(), made.reason, state(made)) == (None, "", WatchdogState.RESTING)


def test_a_brake_that_is_loosened_early_lets_the_wave_end_in_its_time():
    made = moving()
    made.brake("a foreign publisher", 0)
    made.release_brake()
    assert made.tick(RAMP + REPEAT - 1) is not None
    assert made.tick(RAMP + REPEAT - 1 + PERIOD) is None


def test_a_stop_goes_on_for_another_reason_as_it_was():
    made = moving()
    made.brake("one", 0)
    sent = made.tick(PERIOD)
    made.set_reason("another")
    assert (made.reason, made.stop_count) == ("another", 1)
    assert made.tick(2 * PERIOD).speed < sent.speed


def test_what_moves_has_no_reason_to_stop():
    made = moving()
    made.set_reason("another")
    assert made.reason == ""


speeds = st.sampled_from([0.0, -0.0, 1e-9, 0.1, 1.0, 5.0, -1.0, 1e308]) | st.floats(-20, 20)
velocities = st.builds(
    lambda parts: Velocity(tuple(parts[:3]), tuple(parts[3:])),
    st.lists(speeds, min_size=6, max_size=6),
)
stops = st.builds(
    StopProfile,
    decel=st.floats(0.1, 10),
    angular_decel=st.floats(0.1, 10),
    period=st.sampled_from([SECOND // 100, PERIOD, SECOND // 2, 2 * SECOND]),
    repeat=st.sampled_from([0, 1, PERIOD - 1, PERIOD, SECOND]),
)
latenesses = st.lists(st.sampled_from([0, 0, 1, PERIOD // 2, 3 * PERIOD]), min_size=1, max_size=5)


@often
@given(velocities, stops, latenesses)
def test_no_wave_is_steeper_than_the_plan_allows(velocity, stop, latenesses):
    """Whatever the robot did, and however late the ticks are: monotone, on its curve, to zeros."""
    made, now, out = moving(velocity, stop=stop), SILENT, []
    for number in range(5_000):
        sent = made.tick(now)
        if sent is not None:
            out.append((now, sent))
        if made.deadline() is None:
            break
        now = made.deadline() + latenesses[number % len(latenesses)]
    assert made.deadline() is None
    if not velocity.is_moving:
        assert not out
        return
    lasts = VelocityRamp.for_stop(velocity, stop, 0).duration
    began = [(SILENT - stop.period, velocity), *out]
    for (before, one), (after, other) in pairwise(began):
        assert other.speed <= one.speed
        assert other.angular_speed <= one.angular_speed
        passed = (after - before + 2) / SECOND
        if lasts < MAX_RAMP_DURATION:
            assert one.speed - other.speed <= stop.decel * passed * (1 + 1e-6)
        if (
            lasts < MAX_RAMP_DURATION
            and velocity.angular_speed <= stop.angular_decel * MAX_RAMP_DURATION / SECOND
        ):
            slower = one.angular_speed - other.angular_speed
            assert slower <= stop.angular_decel * passed * (1 + 1e-6)
    for at, sent in out:
        left = max(0.0, (SILENT + lasts - at - stop.period) / lasts) if lasts else 0.0
        assert sent.linear == pytest.approx(velocity.scaled(left).linear, abs=1e-12)
        assert sent.angular == pytest.approx(velocity.scaled(left).angular, abs=1e-12)
    last = SILENT + lasts + stop.repeat
    assert all(at < last for at, _ in out)


SAID, REFUSED = "said", "refused"
gaps = st.sampled_from([0, 1, PERIOD, *(SILENT + d for d in (-1, 0, 1)), RAMP + REPEAT + PERIOD])
story = st.lists(
    st.tuples(gaps, st.sampled_from([SAID, SAID, REFUSED]), st.sampled_from([FLOW, RELEASING])),
    max_size=15,
)


def play(steps, seldom):
    """Return all that a stop says in a recording, asked at its deadlines or at more times."""
    now, made, out = 0, stopping(), []

    def tick():
        if (velocity := made.tick(now)) is not None:
            out.append((now, velocity, made.reason, made.last_flow))

    for gap, what, flow in steps:
        end = now + gap
        while (due := made.deadline()) is not None and due <= end:
            if not seldom:
                for between in {now, (now + due) // 2, max(now, due - 1)} - {due}:
                    before, now = now, between
                    tick()
                    now = before
            now = max(now, due)
            tick()
        now = end
        if what == SAID:
            made.record_output(flow, now)
        else:
            made.refuse("blocked", now)
        out.append((now, made.moving_flow, made.reason))
    return out


@often
@given(story)
def test_ticks_at_the_deadlines_are_enough(steps):
    assert play(steps, seldom=True) == play(steps, seldom=False)


@often
@given(story)
def test_why_is_told_exactly_while_the_wave_is_sent(steps):
    now, made = 0, stopping()
    for gap, what, flow in steps:
        now += gap
        made.tick(now)
        assert bool(made.reason) is (state(made) is WatchdogState.STOPPING)
        if what == SAID:
            made.record_output(flow, now)
        else:
            made.refuse("blocked", now)
        assert bool(made.reason) is (state(made) is WatchdogState.STOPPING)
        assert (made.moving_flow is None) is (state(made) is not WatchdogState.MOVING)


@often
@given(story)
def test_what_is_done_is_the_effect_in_the_table(steps):
    now, made = 0, stopping()
    effects = watch_effects(made)
    for gap, what, flow in steps:
        now += gap
        for act in (TICK, what):
            before, stepped = made.reason, len(effects)
            if act == TICK:
                made.tick(now)
            elif act == SAID:
                made.record_output(flow, now)
            else:
                made.refuse("blocked", now)
            stops = bool(made.reason) and not before
            assert effects[stepped:].count(TransitionEffect.STOP) == stops
            assert set(effects) <= {TransitionEffect.NOTHING, TransitionEffect.STOP}
