"""Safe, Constrain and what they share: no velocity goes on above the limit."""

import math
from dataclasses import dataclass, field, replace
from itertools import accumulate, pairwise

import pytest
from event_and_rate_models import NaiveFrameMonitor
from hypothesis import example, given
from hypothesis import strategies as st
from limit_runs import HOSTILE, LEAST_NORMAL, NO_NUMBERS, alike, components, violations
from policy_runs import (
    APPROVED,
    BLOCKED,
    FLOWS,
    HIGH,
    LOW,
    MIDDLE,
    STRANGER,
    often,
    settings,
    watch_effects,
)

from rtron.errors import PlanError
from rtron.messages import DefinitionRegistry, Encoding, velocity_codec
from rtron.policies import FrameMonitors, build_policy
from rtron.policies.state_machine import TransitionEffect
from rtron.policies.velocity_limit.limiter import (
    REISSUE_PERIOD,
    LimitState,
    SpeedLimit,
    VelocityLimiter,
)
from rtron.vocabulary import (
    SECOND,
    UNAPPROVED,
    Decision,
    Flow,
    FpsMonitor,
    PolicyName,
    StreamKind,
    Velocity,
    Verdict,
)

PASS, DROP, MODIFY = Decision.PASS, Decision.DROP, Decision.MODIFY
FLOW = (Flow(name=LOW, publisher="/low"),)
EQUAL = tuple(replace(flow, priority=0) for flow in FLOWS)
RELEASE_AFTER = 10
limits = st.sampled_from([0.22, 1.0, LEAST_NORMAL, 1e300]) | st.floats(1e-3, 1e3)


@dataclass
class Given:
    """A limit that a test sets."""

    speed: float
    is_variable: bool = True
    asked: list[int] = field(default_factory=list)

    def at(self, now):
        self.asked.append(now)
        return SpeedLimit(self.speed, f"{self.speed:g} m/s")


def limiting(speed=0.5, flows=FLOW, *, reissues=False, **others):
    policy = VelocityLimiter(settings(PolicyName.CONSTRAIN, flows=flows, **others), Given(speed))
    policy.reissues = reissues
    return policy


def limited(speed, requested, flow=LOW):
    return limiting(speed).verdict(flow, requested, 0)


# One velocity


@pytest.mark.parametrize("speed", [0.22, 1.0, 1e-300, 1e300])
@pytest.mark.parametrize("sign", [1, -1])
def test_a_velocity_exactly_at_the_limit_is_within_it(speed, sign):
    verdict = limited(speed, Velocity((sign * speed,), (7.0,)))
    assert (verdict.decision, verdict.message) == (PASS, None)
    assert verdict.reason == f"within {speed:g} m/s"


@pytest.mark.parametrize("speed", [0.22, 1.0, 1e-300, 1e300])
@pytest.mark.parametrize("sign", [1, -1])
def test_the_next_number_above_the_limit_is_changed(speed, sign):
    asked = Velocity((sign * math.nextafter(speed, math.inf), 0.0, 0.0))
    verdict = limited(speed, asked)
    assert verdict.decision is MODIFY
    assert verdict.message.speed <= speed
    assert verdict.message.linear[0] == pytest.approx(sign * speed, rel=1e-15)
    assert verdict.reason == f"limited to {speed:g} m/s"


@often
@given(limits, st.data())
def test_what_goes_on_is_within_the_limit_and_on_the_same_curve(speed, data):
    part = st.sampled_from(components(speed)) | st.floats(allow_nan=False, allow_infinity=False)
    drawn = data.draw(st.lists(part, min_size=6, max_size=6))
    asked = Velocity(tuple(drawn[:3]), tuple(drawn[3:]))
    verdict = limited(speed, asked)
    if asked.speed <= speed:
        assert verdict.decision is PASS
    else:
        assert verdict.decision is MODIFY
        assert verdict.message.speed <= speed
        assert alike(asked, verdict.message)


@often
@given(limits, st.floats(0.01, 100), st.floats(-10, 10), st.sampled_from([1, -1]))
def test_the_curvature_is_kept(speed, factor, turn, sign):
    asked = Velocity((sign * speed * (1 + factor), 0.0, 0.0), (0.0, 0.0, turn * speed))
    made = limited(speed, asked).message
    before, after = asked.angular[2] / asked.linear[0], made.angular[2] / made.linear[0]
    assert after == pytest.approx(before, rel=1e-9)
    assert made.speed == pytest.approx(speed, rel=1e-9)


@pytest.mark.parametrize("limit", [0.22, 1.0, 1e-300, LEAST_NORMAL, 1e300])
@pytest.mark.parametrize("seed", [1, 2])
def test_no_violation_is_let_through(limit, seed):
    found = violations(4_000, seed, limit)
    assert found.wrong == ()
    assert found.violations == 0
    assert min(found.passed, found.modified, found.dropped) > 100


@pytest.mark.parametrize("encoding", Encoding)
def test_no_violation_is_let_through_in_the_bytes_of_a_twist(encoding):
    codec = velocity_codec(DefinitionRegistry(()).find("geometry_msgs/Twist"), encoding)
    found = violations(
        4_000,
        3,
        encode=lambda velocity: codec.encode(codec.zero_message, velocity),
        decode=codec.decode,
    )
    assert found.wrong == ()
    assert min(found.passed, found.modified, found.dropped) > 100


def test_a_violation_would_be_found():
    """What looks for violations sees them: a codec that doubles, and one that turns."""

    def bent(velocity):
        return Velocity(velocity.linear, (*velocity.angular[:2], velocity.angular[2] + 1))

    doubled = violations(1_000, 1, 1.0, encode=lambda velocity: velocity.scaled(2))
    assert any(each.startswith("modified") for each in doubled.wrong)
    turned = violations(1_000, 1, 1.0, encode=bent)
    assert any(each.startswith("bent") for each in turned.wrong)
    assert doubled.violations > len(doubled.wrong) == 10


@pytest.mark.parametrize("bad", NO_NUMBERS)
@pytest.mark.parametrize("place", range(6))
def test_one_component_that_is_no_number_is_enough(bad, place):
    parts = [0.1] * 6
    parts[place] = bad
    verdict = limited(0.5, Velocity(tuple(parts[:3]), tuple(parts[3:])))
    assert (verdict.decision, verdict.error) == (DROP, True)
    assert verdict.reason == "NaN or Inf is no velocity"


@pytest.mark.parametrize("value", [*HOSTILE[:7], -0.0])
def test_what_is_almost_nothing_passes_untouched(value):
    assert limited(0.5, Velocity((value, -value), (-value,))).decision is PASS


def test_what_is_no_velocity_is_dropped_with_what_is_said_about_it():
    verdict = limited(0.5, "no velocity: too short")
    assert (verdict.decision, verdict.error) == (DROP, True)
    assert (verdict.flow, verdict.reason) == (LOW, "no velocity: too short")
    for other in (None, b"", 0.3):
        assert limited(0.5, other) == limited(0.5, Velocity((math.nan,)))


@pytest.mark.parametrize("flow", [BLOCKED, STRANGER, UNAPPROVED])
@pytest.mark.parametrize("requested", [Velocity((0.1,)), Velocity((9.0,)), "no velocity"])
def test_blocked_and_unknown_flows_are_refused(flow, requested):
    policy = limiting(flows=FLOWS)
    verdict = policy.verdict(flow, requested, 0)
    assert (verdict.decision, verdict.error) == (DROP, False)
    assert verdict == policy.refusal(flow, 0)
    assert ("blocked" if flow == BLOCKED else "not an approved flow") in verdict.reason


def test_a_pass_builds_no_verdict():
    policy = limiting()
    one, other = (policy.verdict(LOW, Velocity((0.1,)), now) for now in (0, 1))
    assert one is other


# A limit of 0


@pytest.mark.parametrize(
    "requested", [Velocity((0.1,)), Velocity((0.0,), (1.0,)), Velocity((0.0,))]
)
def test_a_limit_of_0_lets_nothing_pass_not_even_a_turn_on_the_spot(requested):
    policy = limiting(0.0)
    verdict = policy.verdict(LOW, requested, 0)
    assert (verdict.decision, verdict.error) == (DROP, False)
    assert verdict.reason == "nothing moves: 0 m/s"
    assert policy.refusal(LOW, 0) is verdict


def test_any_other_limit_refuses_nobody_beforehand():
    assert limiting(5e-324).refusal(LOW, 0) is None


def test_who_asks_what_the_limit_is_learns_that_it_is_0():
    policy = limiting(0.0, reissues=True)
    assert policy.refusal(LOW, 0) is None
    verdict = policy.verdict(LOW, Velocity((1.0,)), 0)
    assert (verdict.decision, verdict.message) == (MODIFY, Velocity((0.0,)))


def test_the_refusal_asks_for_the_limit_of_the_moment():
    policy = limiting(0.0)
    policy.refusal(LOW, 17)
    policy.verdict(LOW, Velocity((1.0,)), 18)
    assert policy._source.asked == [17, 18]


@pytest.mark.parametrize("requested", [0.1, 9.0])
def test_what_is_dropped_leaves_the_state(requested):
    policy = limiting(0.5, FLOWS)
    policy.verdict(HIGH, Velocity((requested,)), 0)
    state = policy._machine.state
    assert state is (LimitState.LIMITED if requested > 0.5 else LimitState.WITHIN)
    policy.verdict(LOW, Velocity((1.0,)), 0)
    policy.verdict(STRANGER, Velocity((1.0,)), 0)
    policy.verdict(HIGH, Velocity((math.nan,)), 0)
    policy._source.speed = 0.0
    policy.verdict(HIGH, Velocity((1.0,)), 0)
    assert policy._machine.state is state


# Priorities


def test_flows_of_one_priority_have_no_order():
    policy = limiting(flows=EQUAL)
    for now, flow in enumerate((HIGH, LOW, MIDDLE, HIGH)):
        assert policy.verdict(flow, Velocity((0.1,)), now).decision is PASS
        assert policy.owner is None


def test_the_unapproved_flow_makes_no_order():
    stranger = Flow(name=UNAPPROVED, publisher="*", priority=-1)
    policy = limiting(flows=(*EQUAL, stranger))
    assert policy.verdict(HIGH, Velocity((0.1,)), 0).decision is PASS
    assert policy.verdict(UNAPPROVED, Velocity((0.1,)), 0).decision is PASS


def test_the_unapproved_flow_has_its_place_in_an_order():
    stranger = Flow(name=UNAPPROVED, publisher="*", priority=-1)
    policy = limiting(flows=(*FLOWS, stranger))
    policy.verdict(LOW, Velocity((0.1,)), 0)
    assert policy.verdict(UNAPPROVED, Velocity((0.1,)), 0).decision is DROP


@pytest.mark.parametrize(
    ("silence", "decision"),
    [(0, DROP), (RELEASE_AFTER - 1, DROP), (RELEASE_AFTER, PASS), (RELEASE_AFTER + 1, PASS)],
)
def test_a_higher_flow_goes_first_while_it_is_fresh(silence, decision):
    policy = limiting(flows=FLOWS)
    assert policy.verdict(HIGH, Velocity((9.0,)), 5).decision is MODIFY
    verdict = policy.verdict(LOW, Velocity((0.1,)), 5 + silence)
    assert verdict.decision is decision
    assert policy.owner == (HIGH if decision is DROP else LOW)
    if decision is DROP:
        assert verdict.reason == "high has the output (priority 3)"
        assert not verdict.error


def test_the_owner_is_that_of_the_last_call():
    policy = limiting(flows=FLOWS)
    assert policy.owner is None
    policy.verdict(HIGH, Velocity((0.1,)), 5)
    policy.verdict(LOW, Velocity((0.1,)), 7)
    assert policy.owner == HIGH
    policy.tick(5 + RELEASE_AFTER)
    assert policy.owner == LOW
    policy.tick(7 + RELEASE_AFTER)
    assert policy.owner is None


def test_without_release_after_nobody_masks():
    policy = limiting(flows=FLOWS, release_after=0)
    policy.verdict(HIGH, Velocity((0.1,)), 5)
    assert policy.verdict(LOW, Velocity((0.1,)), 5).decision is PASS


def test_what_cannot_be_judged_masks_nobody():
    policy = limiting(flows=FLOWS)
    policy.verdict(HIGH, Velocity((math.nan,)), 5)
    policy.verdict(BLOCKED, Velocity((0.1,)), 5)
    assert policy.verdict(LOW, Velocity((0.1,)), 5).decision is PASS


def test_a_blocked_flow_counts_where_priorities_must_differ():
    two = (Flow(name="one", publisher="/a", priority=1), Flow(name="two", publisher="/b"))
    blocked = Flow(name="three", publisher="/c", priority=1, block=True)
    with pytest.raises(PlanError, match="one and three have the same priority 1"):
        limiting(flows=(*two, blocked))


# What goes out again


def reissue(speeds, requested=1.0, first=0.5):
    """Return what goes out at the ticks of one deadline after the other, under changing limits."""
    policy = limiting(first, reissues=True)
    policy.verdict(LOW, Velocity((requested,)), 0)
    out = []
    for speed in speeds:
        policy._source.speed = speed
        out.append([each.message.speed for each in policy.tick(policy.deadline())])
    return policy, out


def test_what_was_asked_for_last_goes_out_again_when_the_limit_changes():
    policy, out = reissue([0.25, 0.25, 0.125, 0.75, 1.0, 1.0, 2.0, 0.5])
    assert out == [[0.25], [], [0.125], [0.75], [1.0], [], [], [0.5]]
    assert policy._machine.state is LimitState.LIMITED


def test_every_change_of_the_limit_is_a_step_in_the_table():
    policy = limiting(0.5, reissues=True)
    effects = watch_effects(policy)
    policy.verdict(LOW, Velocity((1.0,)), 0)
    for speed in (0.25, 0.25, 1.0, 0.5, 0.75):
        policy._source.speed = speed
        policy.tick(policy.deadline())
    assert effects == [TransitionEffect.MODIFY, *(4 * [TransitionEffect.REISSUE])]


def test_the_named_state_follows_the_limit():
    policy, _ = reissue([0.75])
    assert policy._machine.state is LimitState.LIMITED
    policy, _ = reissue([0.75, 1.0])
    assert policy._machine.state is LimitState.WITHIN
    policy, _ = reissue([0.75, 1.0, 0.5])
    assert policy._machine.state is LimitState.LIMITED


def test_what_goes_out_again_tells_why():
    policy = limiting(0.5, reissues=True, revision=4)
    policy.verdict(LOW, Velocity((1.0,)), 0)
    for speed, told in ((0.25, "limited to 0.25 m/s"), (3.0, "within 3 m/s")):
        policy._source.speed = speed
        (release,) = policy.tick(policy.deadline())
        verdict = release.verdict
        assert (verdict.decision, verdict.flow, verdict.revision) == (MODIFY, LOW, 4)
        assert verdict.policy is PolicyName.CONSTRAIN
        assert verdict.message is release.message
        assert verdict.reason == told


@pytest.mark.parametrize(("early", "count"), [(1, 0), (0, 1), (-1, 1)])
def test_it_goes_out_again_ten_times_a_second_at_most(early, count):
    policy = limiting(0.5, reissues=True)
    policy.verdict(LOW, Velocity((1.0,)), 3)
    assert policy.deadline() == 3 + REISSUE_PERIOD == 3 + SECOND // 10
    policy._source.speed = 0.25
    now = 3 + REISSUE_PERIOD - early
    assert len(policy.tick(now)) == count
    assert policy.deadline() == (now + REISSUE_PERIOD if count else 3 + REISSUE_PERIOD)


def test_a_message_puts_the_next_look_off():
    policy = limiting(0.5, reissues=True)
    policy.verdict(LOW, Velocity((1.0,)), 3)
    policy.verdict(LOW, Velocity((0.1,)), 50)
    assert policy.deadline() == 50 + REISSUE_PERIOD


@pytest.mark.parametrize("requested", ["no velocity", Velocity((math.inf,))])
def test_what_is_dropped_does_not_count_as_asked(requested):
    policy = limiting(0.5, reissues=True)
    policy.verdict(LOW, requested, 0)
    policy.verdict(STRANGER, Velocity((1.0,)), 0)
    assert policy.deadline() is None


def test_only_who_asks_for_the_limit_is_told_again():
    policy = limiting(0.5)
    policy.verdict(LOW, Velocity((1.0,)), 0)
    policy._source.speed = 0.25
    assert policy.deadline() == REISSUE_PERIOD
    assert policy.tick(SECOND) == ()
    assert policy.deadline() == SECOND + REISSUE_PERIOD


def test_a_limit_that_stays_needs_no_look():
    policy = limiting(0.5, reissues=True)
    policy._source.is_variable = False
    policy.verdict(LOW, Velocity((1.0,)), 0)
    assert policy.deadline() is None
    assert policy.tick(SECOND) == ()


@pytest.mark.parametrize(("requested", "out"), [(1.0, [0.5]), (0.5, []), (0.1, [])])
@pytest.mark.parametrize(("varies", "later"), [(True, 7 + REISSUE_PERIOD), (False, None)])
def test_what_has_gone_on_whole_meanwhile_is_limited_again(requested, out, varies, later):
    policy = limiting(0.5, reissues=True)
    policy._source.is_variable = varies
    policy.verdict(LOW, Velocity((requested,)), 0)
    policy.reevaluate(7)
    assert policy.deadline() == 7
    releases = policy.tick(7)
    assert [each.message.speed for each in releases] == out
    assert not any(each.restores for each in releases)
    assert policy.deadline() == later
    assert policy.tick(7 + REISSUE_PERIOD) == ()


def test_where_nothing_was_asked_for_nothing_is_limited_again():
    policy = limiting(0.5, reissues=True)
    policy.reevaluate(7)
    assert policy.deadline() is None
    assert policy.tick(7) == ()


def test_only_who_asks_for_the_limit_is_limited_again():
    policy = limiting(0.5)
    policy._source.is_variable = False
    policy.verdict(LOW, Velocity((1.0,)), 0)
    policy.reevaluate(7)
    assert policy.tick(7) == ()
    assert policy.deadline() is None


def test_the_limit_of_a_moment_can_be_asked_for():
    policy = limiting(0.25)
    assert policy.limit(17) == 0.25
    assert policy._source.asked == [17]


def test_nothing_is_held():
    policy = limiting(0.5, reissues=True)
    assert policy.tick(0) == ()
    policy.verdict(LOW, Velocity((1.0,)), 0)
    assert policy.observe_done(1) is None
    assert policy.close() == ()


# The three policies


MONITOR = FpsMonitor(id="fps_a", node="/n", topic="/t", window=SECOND, silent_after=SECOND)
STEP = SECOND // 20


def safe(policy=PolicyName.SAFE, **others):
    rates = FrameMonitors([MONITOR])
    chosen = settings(policy, flows=FLOW, **{"threshold": 0.1, "max_vel_limit": 0.5, **others})
    return rates, build_policy(chosen, rates)


def feed(rates, count, until):
    for number in range(count):
        now = until - SECOND * (count - 1 - number) // count
        rates.monitors["fps_a"].add_frame(number + 1, now)


def reason(policy, now=SECOND):
    return policy.verdict(LOW, Velocity((9.0,)), now).reason


def test_safe_is_threshold_times_fps():
    rates, policy = safe(threshold=0.125)
    for number in range(8):
        rates.monitors["fps_a"].add_frame(number + 1, SECOND * number // 8)
    now = SECOND * 7 // 8
    assert policy.verdict(LOW, Velocity((1.0,)), now).decision is PASS
    verdict = policy.verdict(LOW, Velocity((2.0,), (1.0,)), now)
    assert verdict.message == Velocity((1.0,), (0.5,))
    assert verdict.reason == "limited to 1 m/s (fps_a: 8.0 fps x 0.125 m)"


def test_a_limit_by_rate_is_written_as_people_read_it():
    rates, policy = safe(threshold=0.1)
    for number in range(3):
        rates.monitors["fps_a"].add_frame(number + 1, number)
    assert reason(policy, SECOND * 3 // 7) == "limited to 0.233 m/s (fps_a: 2.3 fps x 0.1 m)"


def test_a_silent_image_node_means_the_lowest_limit_not_the_last():
    rates, policy = safe(lowest=0.03125)
    assert reason(policy, 0) == "limited to 0.03125 m/s (fps_a is silent)"
    rates.monitors["fps_a"].add_frame(1, 0)
    assert reason(policy, SECOND - 1) == "limited to 0.1 m/s (fps_a: 1.0 fps x 0.1 m)"
    assert reason(policy, SECOND) == "limited to 0.03125 m/s (fps_a is silent)"


def test_silence_stops_the_robot_unless_the_plan_says_otherwise():
    rates, policy = safe()
    assert reason(policy, 0) == "nothing moves: 0 m/s (fps_a is silent)"
    assert policy.refusal(LOW, 0).reason == "nothing moves: 0 m/s (fps_a is silent)"
    rates.monitors["fps_a"].add_frame(1, 0)
    assert policy.refusal(LOW, SECOND - 1) is None
    assert policy.refusal(LOW, SECOND).decision is DROP


def test_the_limit_changes_with_the_rate_alone():
    rates, policy = safe()
    feed(rates, 4, SECOND)
    one, other = policy._source.at(SECOND), policy._source.at(SECOND)
    assert one is other
    assert one.speed == pytest.approx(0.4)
    assert policy._source.at(SECOND * 3 // 2).speed == pytest.approx(0.2)


RISE = 0.25


def filmed_limits(gaps, asked_each=SECOND // 100, **others):
    """Return (time, limit) at each frame after these gaps, and between the frames."""
    rates, policy = safe(threshold=0.02, max_accel_limit=RISE, **others)
    found, now = [], 0
    for stamp, gap in enumerate(gaps):
        asked = range(now + asked_each, now + gap, asked_each)
        found += [(at, policy.limit(at)) for at in asked]
        now += gap
        rates.monitors["fps_a"].add_frame(stamp + 1, now)
        found.append((now, policy.limit(now)))
    return found


FAST, SLOW = SECOND // 30, SECOND // 2


def test_a_frame_rate_that_falls_never_lifts_the_limit_while_it_is_low():
    """From 30 to 2 fps: one late frame lifted the limit from 0.044 to 0.32 m/s."""
    fast = filmed_limits([FAST] * 90)
    assert fast[-1][1] == pytest.approx(0.6)
    found = filmed_limits([FAST] * 90 + [SLOW] * 6)[len(fast) :]
    assert all(one >= other for (_, one), (_, other) in pairwise(found))
    assert found[-1][1] == pytest.approx(0.04)


def test_one_late_frame_lowers_the_limit_once_which_then_rises_slowly():
    found = filmed_limits([FAST] * 90 + [SLOW] + [FAST] * 120)
    late = next(at for at, (_, limit) in enumerate(found) if limit < 0.041 and at > 300)
    lifted = [at for at, ((_, one), (_, other)) in enumerate(pairwise(found)) if other > one]
    again = [at for at in lifted if at > late]
    assert found[again[0]][0] - found[late][0] >= SECOND * 9 // 10
    assert found[-1][1] == pytest.approx(0.6)


@pytest.mark.parametrize("lowest", [0.0, 0.125])
def test_after_a_silence_the_limit_rises_from_the_lowest(lowest):
    found = filmed_limits([FAST] * 90 + [5 * SECOND] + [FAST] * 60, lowest=lowest)
    silent = [limit for at, limit in found if 5 * SECOND < at < 7 * SECOND]
    assert set(silent) == {lowest}
    after = [limit for at, limit in found if at >= 8 * SECOND]
    assert max(after) <= max(lowest, 0.02) + RISE
    assert after[-1] > lowest


gaps_of_frames = st.lists(
    st.sampled_from([0, 1, FAST, 2 * FAST, SLOW, SECOND - 1, SECOND, 3 * SECOND]), max_size=25
)


@often
@given(gaps_of_frames, st.sampled_from([SECOND // 100, SECOND // 7, 2 * SECOND]))
def test_a_limit_falls_at_once_and_rises_slowly_whatever_comes(gaps, asked_each):
    for (before, one), (after, other) in pairwise(filmed_limits(gaps, asked_each)):
        assert other <= one + RISE * (after - before) / SECOND + 1e-9


@often
@given(gaps_of_frames)
def test_between_the_frames_of_a_window_no_more_than_the_threshold_is_driven(gaps):
    frames = list(accumulate(gaps))
    for (now, limit), (later, _) in pairwise(filmed_limits(gaps, SECOND // 200)):
        ended = [b - a for a, b in pairwise(frames) if b <= now < b + SECOND and b > a]
        if ended and later > now:
            assert limit * min(max(ended), SECOND) / SECOND <= 0.02 * (1 + 1e-6)


def test_without_an_acceleration_in_the_plan_a_limit_rises_by_half_a_metre_a_second():
    rates, policy = safe(threshold=0.1)
    policy.limit(0)
    for number in range(40):
        rates.monitors["fps_a"].add_frame(number + 1, number * SECOND // 20)
    now = 39 * SECOND // 20
    assert policy.limit(now) == pytest.approx(0.5 * now / SECOND)
    verdict = policy.verdict(LOW, Velocity((9.0,)), now)
    assert verdict.reason == "limited to 0.975 m/s (fps_a: rises slowly to 20.0 fps x 0.1 m)"


def test_a_limit_names_the_image_node_that_it_comes_from():
    other = replace(MONITOR, id="fps_b")
    rates = FrameMonitors([MONITOR, other])
    policy = build_policy(settings(PolicyName.SAFE, flows=FLOW), rates)
    for monitor in rates.monitors.values():
        monitor.add_frame(1, 0)
    assert "fps_a" in reason(policy, 0)
    rates.monitors["fps_a"].add_frame(2, 0)
    assert "(fps_b: 1.0 fps" in reason(policy, 0)


def test_nothing_monitored_means_the_lowest_limit():
    chosen = settings(PolicyName.SAFE, flows=FLOW, lowest=0.25)
    assert reason(build_policy(chosen)) == "limited to 0.25 m/s (no image node is monitored)"


def test_constrain_is_the_users_limit():
    _, policy = safe(PolicyName.CONSTRAIN)
    assert reason(policy) == "limited to 0.5 m/s (max_vel_limit)"
    policy.reissues = True
    policy.verdict(LOW, Velocity((9.0,)), 0)
    assert policy.deadline() is None


@pytest.mark.parametrize(
    ("frames", "speed", "who"), [(4, 0.4, "fps_a"), (5, 0.5, "fps_a"), (6, 0.5, "max_vel_limit")]
)
def test_of_two_limits_the_lower_holds(frames, speed, who):
    rates, policy = safe(PolicyName.SAFE_CONSTRAIN)
    for number in range(frames):
        rates.monitors["fps_a"].add_frame(number + 1, 0)
    verdict = policy.verdict(LOW, Velocity((9.0,)), 0)
    assert verdict.message.speed == pytest.approx(speed)
    assert who in verdict.reason
    policy.reissues = True
    policy.verdict(LOW, Velocity((9.0,)), 0)
    assert policy.deadline() == REISSUE_PERIOD


def test_a_silent_image_node_counts_in_both():
    _, policy = safe(PolicyName.SAFE_CONSTRAIN, lowest=0.125, max_vel_limit=0.0625)
    assert reason(policy) == "limited to 0.0625 m/s (max_vel_limit)"
    _, policy = safe(PolicyName.SAFE_CONSTRAIN, lowest=0.125, max_vel_limit=0.25)
    assert reason(policy) == "limited to 0.125 m/s (fps_a is silent)"


# A whole recording

FRAME = "frame"
SPEEDS = (0.05, 0.1, 0.5, math.nextafter(0.5, 1), 2.0, math.nan)
recordings = st.lists(
    st.tuples(
        st.sampled_from([0, 1, 1, 2, 2, 3, 19, 20, 21]),
        st.sampled_from([FRAME, FRAME, FRAME, *SPEEDS]),
        st.sampled_from([*APPROVED, BLOCKED, STRANGER]),
    ),
    max_size=40,
)


@dataclass
class LimitRun:
    """Plays (gap in steps, frame or speed, flow); `busy` ticks at every step."""

    policy: PolicyName
    flows: tuple[Flow, ...]
    reissues: bool
    busy: bool
    lowest: float = 0.05
    max_accel: float = 1e9
    now: int = 0
    stamp: int = 0
    out: list[tuple[int, bool, Verdict]] = field(default_factory=list)

    def __post_init__(self):
        self.rates = FrameMonitors([MONITOR])
        chosen = settings(
            self.policy,
            flows=self.flows,
            threshold=0.1,
            lowest=self.lowest,
            release_after=3 * STEP,
            max_accel_limit=self.max_accel,
        )
        self.limit = build_policy(chosen, self.rates)
        self.limit.reissues = self.reissues

    def play(self, steps):
        for gap, what, flow in steps:
            for _ in range(gap):
                self.now += STEP
                self.tick()
            self.do(what, flow)
        return self.out

    def tick(self):
        due = self.limit.deadline()
        if self.busy or (due is not None and due <= self.now):
            releases = self.limit.tick(self.now)
            self.out += [(self.now, True, each.verdict) for each in releases]

    def do(self, what, flow):
        if what == FRAME:
            self.stamp += 1
            self.rates.monitors["fps_a"].add_frame(self.stamp, self.now)
        else:
            verdict = self.limit.verdict(flow, Velocity((what,)), self.now)
            assert (verdict.flow, verdict.policy) == (flow, self.policy)
            self.out.append((self.now, False, verdict))


lowests = st.sampled_from([0.0, 0.05])
any_limit = st.sampled_from([PolicyName.SAFE, PolicyName.CONSTRAIN, PolicyName.SAFE_CONSTRAIN])


@often
@given(any_limit, st.sampled_from([FLOWS, EQUAL]), st.booleans(), lowests, recordings)
def test_ticks_at_the_deadlines_are_enough(policy, flows, reissues, lowest, steps):
    prompt, busy = (
        LimitRun(policy, flows, reissues, busy, lowest).play(steps) for busy in (False, True)
    )
    assert busy == prompt


@often
@given(steps=recordings, reissues=st.booleans())
@example(steps=[(0, FRAME, LOW), (0, 2.0, LOW), (20, 2.0, LOW)], reissues=True)
def test_safe_is_what_a_naive_model_says(steps, reissues):
    """What goes on at each step: the last wish, at most the limit, when it or the wish changes.

    The limit rises too fast here to be seen, but not in no time.
    """
    steps = [(gap + 1, what, flow) for gap, what, flow in steps]
    run = LimitRun(PolicyName.SAFE, EQUAL, reissues, busy=False)
    model, wanted, sent, looked, expected = NaiveFrameMonitor(MONITOR), None, None, 0, []

    def limit(now):
        fps, silent = model.rate(now)
        return 0.05 if silent else 0.1 * fps

    for gap, what, flow in steps:
        for _ in range(gap):
            run.now += STEP
            run.tick()
            if reissues and wanted is not None and run.now - looked >= REISSUE_PERIOD:
                looked = run.now
                if sent != min(wanted, limit(run.now)):
                    sent = min(wanted, limit(run.now))
                    expected.append((run.now, sent))
        if what == FRAME:
            model.frames.frame(run.stamp + 1, run.now)
        elif not math.isnan(what) and flow in APPROVED and (reissues or limit(run.now)):
            wanted, looked, sent = what, run.now, min(what, limit(run.now))
            expected.append((run.now, sent))
        run.do(what, flow)
    found = went_on(steps, run.out)
    assert [at for at, _ in found] == [at for at, _ in expected]
    assert [speed for _, speed in found] == pytest.approx([speed for _, speed in expected])


def went_on(steps, out):
    """Return (time, speed) of what passed as it was, or changed, or went out again."""
    asked = iter([what for _, what, _ in steps if what != FRAME])
    found = []
    for now, again, verdict in out:
        said = again or next(asked)
        if verdict.decision is not DROP:
            found.append((now, verdict.message.speed if verdict.message else said))
    return found


@often
@given(any_limit, st.sampled_from([FLOWS, EQUAL]), st.booleans(), lowests, recordings)
def test_what_is_done_is_the_effect_in_the_table(policy, flows, reissues, lowest, steps):
    run = LimitRun(policy, flows, reissues, busy=False, lowest=lowest)
    effects = watch_effects(run.limit)
    run.play(steps)
    done = [
        TransitionEffect.REISSUE if again else TransitionEffect[v.decision.name]
        for _, again, v in run.out
    ]
    assert effects == done


@often
@given(any_limit, st.sampled_from([FLOWS, EQUAL]), st.booleans(), lowests, recordings)
def test_the_named_state_tells_whether_what_was_asked_for_last_is_limited(
    policy, flows, reissues, lowest, steps
):
    run = LimitRun(policy, flows, reissues, busy=True, lowest=lowest)
    for step in steps:
        run.play([step])
        asked = run.limit._last_request
        limited = asked is not None and asked.sent.speed < asked.requested.speed
        assert (run.limit._machine.state is LimitState.LIMITED) is limited


def test_every_kind_of_stream_can_be_limited():
    for kind in StreamKind:
        assert (
            build_policy(settings(PolicyName.CONSTRAIN, kind))
            .verdict(LOW, Velocity((9.0,)), 0)
            .decision
            is MODIFY
        )


def test_only_what_rises_again_restores():
    policy = limiting(0.5, reissues=True)
    policy.verdict(LOW, Velocity((1.0,)), 0)
    policy._source.speed = 0.25
    (fallen,) = policy.tick(REISSUE_PERIOD)
    policy._source.speed = 0.75
    (risen,) = policy.tick(2 * REISSUE_PERIOD)
    assert (fallen.restores, risen.restores) == (False, True)
