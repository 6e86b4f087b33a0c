"""The stop wave: when it begins, how it falls, and when it is over."""

from itertools import pairwise
from math import ceil

import pytest
from hypothesis import given
from hypothesis import strategies as st
from policy_runs import TICK, often, watch_effects

from rtron.policies.state_machine import TransitionEffect
from rtron.policies.velocity_watchdog import VelocityRamp, VelocityWatchdog, WatchdogState
from rtron.vocabulary import SECOND, Flow, OnSilence, StopProfile, Velocity

SILENT = SECOND // 2
PERIOD, REPEAT, WITHIN = SECOND // 20, SECOND, 3 * SECOND
STOP = StopProfile(decel=2.0, angular_decel=4.0, within=WITHIN, period=PERIOD, repeat=REPEAT)
FLOW = Flow(name="flow1", publisher="/nav", silent_after=SILENT)
RELEASING = Flow(name="flow2", publisher="/nav", silent_after=SILENT, on_silence=OnSilence.RELEASE)
FORWARD = Velocity((1.0, 0.0, 0.0), (0.0, 0.0, 0.5))
RAMP = SECOND // 2
ZEROS = REPEAT // PERIOD


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


def test_a_flow_that_has_lost_its_publisher_is_silent_at_once():
    made = moving(now=7)
    made.forget_flow("flow1", 8)
    assert made.reason == "flow1 has lost its publisher"
    assert (made.deadline(), made.moving_flow, made.stop_count) == (8, None, 1)
    assert made.tick(8).is_moving


def test_a_flow_that_may_be_silent_may_be_gone():
    made = moving(flow=RELEASING)
    made.forget_flow("flow2", 1)
    assert (state(made), made.deadline(), made.stop_count) == (WatchdogState.RELEASED, None, 0)


@pytest.mark.parametrize("flow", ["flow2", "", "unapproved"])
def test_a_flow_that_does_not_move_the_robot_may_be_gone(flow):
    made = moving(now=7)
    made.forget_flow(flow, 8)
    assert (made.moving_flow, made.deadline()) == (FLOW, 7 + SILENT)


def test_who_rests_or_stops_already_is_not_stopped_once_more():
    resting, refused = stopping(), moving()
    refused.refuse("rule", 5)
    for made in (resting, refused):
        made.forget_flow("flow1", 6)
    assert (state(resting), resting.stop_count) == (WatchdogState.RESTING, 0)
    assert (refused.reason, refused.stop_count) == ("rule", 1)


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
    assert [at for at, _ in out] == [number * PERIOD for number in range(29)]
    speeds = [velocity.speed for _, velocity in out]
    assert speeds[:9] == pytest.approx([0.9, 0.8, 0.7, 0.6, 0.5, 0.4, 0.3, 0.2, 0.1])
    assert speeds[9:] == [0.0] * ZEROS
    assert (state(made), made.deadline(), made.reason) == (WatchdogState.RESTING, None, "")


@pytest.mark.parametrize(
    ("velocity", "linear", "turns"),
    [
        (Velocity((1.0,)), SECOND // 2, ()),
        (Velocity((-1.0,)), SECOND // 2, ()),
        (Velocity((3.0, 4.0), (1.0,)), 5 * SECOND // 2, (5 * SECOND // 2,)),
        (Velocity((1.0,), (4.0, -1.0)), SECOND // 2, (SECOND, SECOND // 2)),
        (Velocity((0.0,), (0.0, 0.0, -2.0)), 0, (0, 0, SECOND // 2)),
        (Velocity(()), 0, ()),
        (Velocity((5.9,)), WITHIN - SECOND // 20, ()),
        (Velocity((6.0,)), WITHIN, ()),
        (Velocity((6.1,)), WITHIN, ()),
        (Velocity((0.0,), (11.9,)), 0, (WITHIN - SECOND // 40,)),
        (Velocity((0.0,), (12.0,)), 0, (WITHIN,)),
        (Velocity((1.0,), (12.1, 0.0)), SECOND // 2, (WITHIN, SECOND // 2)),
        (Velocity((1e308, 1e308), (1e308,)), WITHIN, (WITHIN,)),
        (Velocity((1.7e308, 1.7e308)), WITHIN, ()),
        (Velocity((5e-324,)), 0, ()),
    ],
)
def test_each_part_brakes_at_its_own_rate_within_one_bound(velocity, linear, turns):
    ramp = VelocityRamp.for_stop(velocity, STOP, 7)
    assert (ramp.started_at, ramp.velocity) == (7, velocity)
    assert (ramp.linear_duration, ramp.angular_durations) == (linear, turns)
    assert ramp.duration == max(linear, *turns, 0)
    assert not ramp.at(7 + ramp.duration).is_moving


@pytest.mark.parametrize(("at", "share"), [(0, 1), (1, 0.75), (3, 0.25), (4, 0), (5, 0), (99, 0)])
def test_the_ramp_is_straight_and_ends_at_0(at, share):
    ramp = VelocityRamp(FORWARD, 10, 4, (4, 4, 8))
    linear, angular = ramp.at(10 + at).linear, ramp.at(10 + at).angular
    assert linear == FORWARD.scaled(share).linear
    assert angular == (0.0, 0.0, 0.5 * max(0, 8 - at) / 8)


def test_a_turn_that_nobody_can_drive_does_not_keep_the_robot_going():
    """An axis that no base has: 31 rad/s kept 0.2 m/s going for 9.7 s and 0.97 m."""
    made = moving(Velocity((0.2, 0.0, 0.0), (31.0, 0.0, 0.0)), stop=StopProfile())
    made.refuse("rule", 0)
    out = wave(made)
    assert sum(velocity.speed for _, velocity in out) * PERIOD / SECOND < 0.02
    driven = [at for at, velocity in out if velocity.speed]
    turned = [at for at, velocity in out if velocity.is_moving]
    assert max(driven) < SECOND // 5 < max(turned) < SECOND


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


@pytest.mark.parametrize("late", [RAMP, RAMP + REPEAT - 1, RAMP + REPEAT, 60 * SECOND])
def test_a_guard_that_stood_still_sends_every_zero_later(late):
    """Otherwise a machine that stalls would leave the base with the last speed of the ramp."""
    made = moving()
    made.refuse("blocked", 0)
    assert made.tick(0).is_moving
    sent = [(late, made.tick(late)), *wave(made, until=late + REPEAT)]
    assert [at for at, _ in sent] == [late + number * PERIOD for number in range(ZEROS)]
    assert {velocity.is_moving for _, velocity in sent} == {False}
    assert (made.deadline(), made.reason) == (None, "")


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
    unbraked = moving()
    unbraked.refuse("blocked", 0)
    assert wave(made) == wave(unbraked)


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
    within=st.sampled_from([PERIOD, SECOND, 10 * SECOND]),
    period=st.sampled_from([SECOND // 100, PERIOD, SECOND // 2, 2 * SECOND]),
    repeat=st.sampled_from([0, 1, PERIOD - 1, PERIOD, SECOND]),
)
latenesses = st.lists(st.sampled_from([0, 0, 1, PERIOD // 2, 3 * PERIOD]), min_size=1, max_size=5)


def stop_late(velocity, stop, latenesses):
    """Return the wave after silence, asked later than it is due."""
    made, now, out = moving(velocity, stop=stop), SILENT, []
    for number in range(5_000):
        sent = made.tick(now)
        if sent is not None:
            out.append((now, sent))
        if made.deadline() is None:
            break
        now = made.deadline() + latenesses[number % len(latenesses)]
    assert made.deadline() is None
    return out


def parts(velocity):
    return (velocity.speed, *map(abs, velocity.angular))


@often
@given(velocities, stops, latenesses)
def test_no_wave_is_steeper_than_the_plan_allows_unless_it_must_end(velocity, stop, latenesses):
    """Whatever the robot did, and however late the ticks are: each part falls, none too fast."""
    out = stop_late(velocity, stop, latenesses)
    if not velocity.is_moving:
        assert not out
        return
    rates = (stop.decel, *(stop.angular_decel for _ in velocity.angular))
    for (before, one), (after, other) in pairwise([(SILENT - stop.period, velocity), *out]):
        passed = (after - before + 2) / SECOND
        for began, fast, slow, rate in zip(
            parts(velocity), parts(one), parts(other), rates, strict=True
        ):
            assert slow <= fast
            steepest = max(rate, began / stop.within * SECOND)
            assert fast - slow <= steepest * passed * (1 + 1e-6)


@often
@given(velocities, stops, latenesses)
def test_every_wave_is_at_rest_within_the_bound_and_goes_straight(velocity, stop, latenesses):
    for at, sent in stop_late(velocity, stop, latenesses):
        passed = at + stop.period - SILENT
        assert passed < stop.within or not sent.is_moving
        share = sent.speed / velocity.speed if velocity.speed else 0.0
        assert sent.linear == pytest.approx(velocity.scaled(share).linear, rel=1e-6, abs=1e-300)


@often
@given(velocities, stops, latenesses)
def test_every_wave_ends_with_the_same_zeros_however_late(velocity, stop, latenesses):
    zeros = [at for at, sent in stop_late(velocity, stop, latenesses) if not sent.is_moving]
    count = max(1, ceil(stop.repeat / stop.period))
    assert len(zeros) == (count if velocity.is_moving else 0)
    longest = stop.period + max(latenesses)
    assert all(after - before <= longest for before, after in pairwise(zeros))


@often
@given(velocities, stops, latenesses)
def test_a_turn_lasts_at_least_as_long_as_the_way(velocity, stop, latenesses):
    """So the robot stays on its curve, or turns on the spot in the end."""
    for _, sent in stop_late(velocity, stop, latenesses):
        way = sent.speed / velocity.speed if velocity.speed else 0.0
        for began, turn in zip(velocity.angular, sent.angular, strict=True):
            assert abs(turn) >= abs(began) * way * (1 - 1e-6)


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


def test_the_velocity_in_force_is_that_of_the_stop_message_that_went_out_last():
    made = moving()
    assert made.current(SILENT) is None
    while (due := made.deadline()) is not None:
        velocity = made.tick(due)
        assert made.current(due) == velocity
        assert made.current(due + PERIOD // 2) == velocity
    assert velocity is None
