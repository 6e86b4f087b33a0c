"""Safe and Constrain on real messages: a velocity stream, and the topic of a maximal velocity."""

from dataclasses import replace
from itertools import pairwise

import pytest
from streams import peer
from velocity_messages import FLOAT64, IMAGE, float64, floats, image, speeds, twist

from rtron.guard.coordinator import Coordinator
from rtron.guard.core.observations import observations_of
from rtron.guard.core.override_policy import Override
from rtron.guard.transport.common.memory import MemoryTransport
from rtron.vocabulary import (
    MSRCN,
    RSRCN,
    SECOND,
    EventFlow,
    Flow,
    FpsMonitor,
    GuardedTopic,
    MissionRule,
    Mode,
    OnError,
    OnSilence,
    Plan,
    PolicyName,
    WatchedFlow,
    build_streams,
)

NAV = "/rtron/cmd_vel/vflow1"
OUT = "/rtron/cmd_vel/out"
VELOCITY = GuardedTopic(
    topic="/cmd_vel",
    type="geometry_msgs/Twist",
    flows=(Flow(name="vflow1", publisher="/nav", silent_after=5 * SECOND),),
    successors=("/driver",),
)
MAX_VEL = GuardedTopic(
    topic="/max_vel",
    type="std_msgs/Float64",
    flows=(Flow(name="vflow1", publisher="/decider"), Flow(name="vflow2", publisher="/monitor")),
    successors=("/driver",),
)
MONITOR = FpsMonitor(id="fps_cam", node="/detector", topic="/detector/image")


def plan(policy, *vflows, **more):
    monitors = more.pop("monitors", (MONITOR,))
    values = {"max_accel_limit": 1e4, **more}
    rsrcn = RSRCN(id="rsrcn", mode=Mode.ENFORCE, policy=policy, vflows=vflows, **values)
    return Plan(app="test", rsrcn=rsrcn, fps_monitor=monitors)


def guarded(wanted):
    transport = MemoryTransport()
    host = Coordinator(transport, build_streams(wanted), observations_of(wanted))
    host.open()
    return transport, host


def film(transport, fps, seconds=1.0, say=None):
    """Let the image node work at a rate for a while; return what it speaks into."""
    say = say or transport.publisher("/detector/image", peer("/detector", IMAGE))
    for _ in range(round(fps * seconds)):
        transport.advance(SECOND // fps)
        say(image(transport.now()))
    return say


def test_a_velocity_above_the_user_s_limit_is_scaled_as_a_whole():
    transport, host = guarded(plan(PolicyName.CONSTRAIN, VELOCITY, max_vel_limit=0.5))
    driver = transport.listen(OUT)
    nav = transport.publisher(NAV, peer("/nav"))
    nav(twist(0.5, turn=9.0))
    transport.advance(SECOND // 10)
    nav(twist(-2.0, turn=1.0))
    assert speeds(driver) == [(0.5, 9.0), (-0.5, 0.25)]
    tally = host.streams[0].pipeline.tallies["vflow1"]
    assert (tally.passed, tally.modified) == (1, 1)
    assert tally.last.reason == "limited to 0.5 m/s (max_vel_limit)"


def test_the_maximal_velocity_is_held_at_the_limit():
    transport, _ = guarded(plan(PolicyName.CONSTRAIN, MAX_VEL, max_vel_limit=0.22))
    driver = transport.listen("/rtron/max_vel/out")
    decider = transport.publisher("/rtron/max_vel/vflow1", peer("/decider", FLOAT64))
    attacker = transport.publisher("/rtron/max_vel/vflow2", peer("/monitor", FLOAT64))
    decider(float64(0.22))
    attacker(float64(2.0))
    attacker(float64(float("inf")))
    attacker(float64(float("nan")))
    attacker(float64(-1.0))
    decider(float64(0.1))
    assert floats(driver) == [0.22, 0.22, 0.1]


@pytest.mark.parametrize("bad", [b"", b"\x08\x00\x00\x00", twist(1.0), float64(1.0) + b"\x00"])
def test_what_is_no_velocity_never_passes(bad):
    transport, host = guarded(plan(PolicyName.CONSTRAIN, MAX_VEL, max_vel_limit=9.0))
    driver = transport.listen("/rtron/max_vel/out")
    transport.publisher("/rtron/max_vel/vflow1", peer("/decider", FLOAT64))(bad)
    assert driver == []
    assert host.streams[0].pipeline.tallies["vflow1"].last.error


def test_a_type_that_holds_no_velocity_never_passes():
    topic = replace(MAX_VEL, type="")
    transport, host = guarded(plan(PolicyName.CONSTRAIN, topic, max_vel_limit=9.0))
    driver = transport.listen("/rtron/max_vel/out")
    transport.publisher("/rtron/max_vel/vflow1", peer("/decider", IMAGE))(float64(1.0))
    assert driver == []
    assert "no velocity" in host.streams[0].pipeline.tallies["vflow1"].last.reason


def test_the_limit_follows_the_frame_rate():
    transport, _ = guarded(plan(PolicyName.SAFE, VELOCITY, threshold=0.05))
    driver = transport.listen(OUT)
    nav = transport.publisher(NAV, peer("/nav"))
    camera = film(transport, fps=20)
    nav(twist(2.0, turn=1.0))
    film(transport, fps=10, say=camera)
    transport.advance(SECOND // 100)
    nav(twist(2.0, turn=1.0))
    told = speeds(driver)
    assert (told[0], told[-1]) == ((1.0, 0.5), (0.5, 0.25))


def test_a_silent_image_node_stops_the_robot_on_a_ramp_and_keeps_it_at_rest():
    transport, host = guarded(plan(PolicyName.SAFE, VELOCITY, threshold=0.05))
    driver = transport.listen(OUT)
    nav = transport.publisher(NAV, peer("/nav"))
    film(transport, fps=20)
    nav(twist(1.0))
    transport.advance(SECOND - 1)
    slowed = [x for x, _ in speeds(driver)]
    assert all(one > other for one, other in pairwise(slowed))
    assert slowed[-1] > 0.05
    transport.advance(1)
    assert len(driver) == len(slowed) + 1
    nav(twist(1.0))
    transport.advance(SECOND // 2)
    assert speeds(driver)[-1] == (0.0, 0.0)
    assert max(x for x, _ in speeds(driver)[len(slowed) :]) < slowed[-1]
    assert "fps_cam is silent" in host.streams[0].pipeline.tallies["vflow1"].last.reason


def test_nothing_moves_before_the_first_frame():
    transport, _ = guarded(plan(PolicyName.SAFE, VELOCITY, threshold=0.05))
    driver = transport.listen(OUT)
    transport.publisher(NAV, peer("/nav"))(twist(0.1))
    assert driver == []


def test_the_maximal_velocity_goes_out_again_when_the_frame_rate_changes():
    transport, _ = guarded(plan(PolicyName.SAFE, MAX_VEL, threshold=0.05))
    driver = transport.listen("/rtron/max_vel/out")
    camera = film(transport, fps=20)
    transport.publisher("/rtron/max_vel/vflow1", peer("/decider", FLOAT64))(float64(0.8))
    assert floats(driver) == [0.8]
    film(transport, fps=10, seconds=2, say=camera)
    assert floats(driver)[-1] == pytest.approx(0.5, rel=0.1)
    transport.advance(2 * SECOND)
    assert floats(driver)[-1] == 0.0
    film(transport, fps=20, seconds=2, say=camera)
    assert floats(driver)[-1] == pytest.approx(0.8)


def test_the_lower_of_two_limits_wins():
    wanted = plan(PolicyName.SAFE_CONSTRAIN, VELOCITY, threshold=0.05, max_vel_limit=0.7)
    transport, _ = guarded(wanted)
    driver = transport.listen(OUT)
    nav = transport.publisher(NAV, peer("/nav"))
    camera = film(transport, fps=20)
    nav(twist(2.0))
    film(transport, fps=10, say=camera)
    transport.advance(SECOND // 100)
    nav(twist(2.0))
    told = [x for x, _ in speeds(driver)]
    assert (told[0], told[-1]) == pytest.approx((0.7, 0.5))


def test_only_the_image_node_itself_is_counted():
    transport, _ = guarded(plan(PolicyName.SAFE, VELOCITY, threshold=0.05))
    driver = transport.listen(OUT)
    nav = transport.publisher(NAV, peer("/nav"))
    for liar in (peer("/liar", IMAGE), peer("/detector", IMAGE, verified=False)):
        say = transport.publisher("/detector/image", liar)
        film(transport, fps=50, say=say)
    nav(twist(1.0))
    assert driver == []


def test_a_frame_that_is_sent_again_is_not_a_new_one():
    transport, host = guarded(plan(PolicyName.SAFE, VELOCITY, threshold=0.05))
    say = transport.publisher("/detector/image", peer("/detector", IMAGE))
    for number in range(40):
        transport.advance(SECOND // 40)
        say(image(1 + number // 4))
    assert host.observations.rates.lowest_rate(transport.now()).fps == pytest.approx(10)


def test_the_rate_is_not_above_the_camera_s():
    camera = WatchedFlow(name="camera", topic="/image_raw", publisher="/camera")
    monitor = replace(MONITOR, camera=camera)
    transport, host = guarded(plan(PolicyName.SAFE, VELOCITY, threshold=1.0, monitors=(monitor,)))
    detector = transport.publisher("/detector/image", peer("/detector", IMAGE))
    raw = transport.publisher("/image_raw", peer("/camera", IMAGE))
    for number in range(20):
        transport.advance(SECOND // 20)
        detector(image(transport.now()))
        if number % 2:
            raw(image(transport.now()))
    assert host.observations.rates.lowest_rate(transport.now()).fps == pytest.approx(10)


def test_the_rate_is_published_and_told():
    transport, host = guarded(plan(PolicyName.SAFE, VELOCITY, threshold=1.0))
    rate = transport.listen("/rtron/fps_cam/fps")
    film(transport, fps=20)
    transport.advance(SECOND // 10)
    assert floats(rate)[-1] == pytest.approx(10)
    told = {status.name: status.message for status in host.statuses()}
    assert told["rtron: fps_cam"] == "10.0 fps"
    transport.advance(SECOND)
    assert {s.name: s.message for s in host.statuses()}["rtron: fps_cam"] == "silent"


@pytest.mark.parametrize(("on_error", "stops"), [(OnError.STOP, 1), (OnError.DROP, 0)])
def test_what_cannot_be_judged_stops_the_robot_where_the_plan_says_so(on_error, stops):
    flow = replace(VELOCITY.flows[0], on_error=on_error)
    topic = replace(VELOCITY, flows=(flow,))
    transport, host = guarded(plan(PolicyName.CONSTRAIN, topic, max_vel_limit=1.0))
    driver = transport.listen(OUT)
    nav = transport.publisher(NAV, peer("/nav"))
    nav(twist(1.0))
    nav(twist(float("nan")))
    transport.advance(0)
    assert len(driver) == 1 + stops
    assert host.streams[0].stop_controller.stop_count == stops


def test_a_rule_keeps_a_maximal_velocity_from_rising_again_but_not_from_falling():
    gone = EventFlow(name="gone", topic="/eye", publisher="/eye", silent=SECOND)
    msrcn = MSRCN(
        id="msrcn",
        mode=Mode.ENFORCE,
        policy=PolicyName.BLOCK,
        aflows=(replace(MAX_VEL, flows=(Flow(name="aflow1", publisher="/decider"),)),),
        eflows=(gone,),
        rules=(MissionRule(name="blind", when="gone", block=("/max_vel",)),),
    )
    wanted = replace(plan(PolicyName.SAFE, MAX_VEL, threshold=0.05), msrcn=msrcn)
    transport, _ = guarded(wanted)
    driver = transport.listen("/rtron/max_vel/out")
    eye = transport.publisher("/eye", peer("/eye", FLOAT64))
    camera = film(transport, fps=20)
    eye(float64(0.0))
    decider = transport.publisher("/rtron/max_vel/aflow1", peer("/decider", FLOAT64))
    decider(float64(0.8))
    transport.advance(2 * SECOND)
    assert floats(driver)[-1] == 0.0
    film(transport, fps=20, seconds=2, say=camera)
    assert floats(driver)[-1] == 0.0
    eye(float64(0.0))
    decider(float64(0.7))
    assert floats(driver)[-1] == 0.7


def test_a_velocity_in_force_is_slowed_down_when_the_limit_falls_and_never_sped_up():
    transport, host = guarded(plan(PolicyName.SAFE, VELOCITY, threshold=0.05))
    driver = transport.listen(OUT)
    camera = film(transport, fps=20)
    transport.publisher(NAV, peer("/nav"))(twist(0.9, turn=0.3))
    film(transport, fps=4, seconds=2, say=camera)
    film(transport, fps=20, seconds=2, say=camera)
    told = speeds(driver)
    assert told[0] == (0.9, 0.3)
    assert all(one > other for (one, _), (other, _) in pairwise(told))
    assert told[-1][0] <= 0.25
    assert all(turn == pytest.approx(x / 3) for x, turn in told)
    assert host.streams[0].stop_controller.stop_count == 0


def test_who_rests_is_not_set_in_motion_by_a_limit():
    slow = replace(VELOCITY, flows=(replace(VELOCITY.flows[0], silent_after=SECOND // 10),))
    transport, _ = guarded(plan(PolicyName.SAFE, slow, threshold=0.05))
    driver = transport.listen(OUT)
    camera = film(transport, fps=20)
    transport.publisher(NAV, peer("/nav"))(twist(0.9))
    film(transport, fps=20, seconds=3, say=camera)
    rest = len(driver)
    assert speeds(driver)[-1] == (0.0, 0.0)
    film(transport, fps=4, seconds=2, say=camera)
    assert len(driver) == rest


def test_an_observing_rsrcn_counts_what_it_would_limit():
    wanted = plan(PolicyName.CONSTRAIN, VELOCITY, max_vel_limit=0.5)
    wanted = replace(wanted, rsrcn=replace(wanted.rsrcn, mode=Mode.OBSERVE))
    transport, host = guarded(wanted)
    nav = transport.publisher("/cmd_vel", peer("/nav"))
    nav(twist(0.1))
    nav(twist(2.0))
    tally = host.streams[0].pipeline.tallies["vflow1"]
    assert (tally.passed, tally.modified, tally.dropped) == (1, 1, 0)


def test_a_late_driver_hears_the_latched_maximal_velocity():
    transport, _ = guarded(plan(PolicyName.CONSTRAIN, MAX_VEL, max_vel_limit=0.22))
    decider = peer("/decider", FLOAT64, latching=True)
    transport.publisher("/rtron/max_vel/vflow1", decider)(float64(2.0))
    assert floats(transport.listen("/rtron/max_vel/out")) == [0.22]


def test_what_was_released_is_told_to_rest_when_it_is_above_the_limit():
    flow = replace(VELOCITY.flows[0], silent_after=SECOND // 10, on_silence=OnSilence.RELEASE)
    transport, _ = guarded(plan(PolicyName.SAFE, replace(VELOCITY, flows=(flow,)), threshold=0.05))
    driver = transport.listen(OUT)
    camera = film(transport, fps=20)
    transport.publisher(NAV, peer("/nav"))(twist(0.9))
    film(transport, fps=20, say=camera)
    assert speeds(driver) == [(0.9, 0.0)]
    film(transport, fps=4, seconds=2, say=camera)
    assert set(speeds(driver)[1:]) == {(0.0, 0.0)}


def driven(*wishes, gap=SECOND // 20, **limits):
    """Let navigation say twists, one each `gap`; return what the driver hears, and the host."""
    transport, host = guarded(plan(PolicyName.CONSTRAIN, VELOCITY, max_vel_limit=9.0, **limits))
    driver = transport.listen(OUT)
    nav = transport.publisher(NAV, peer("/nav"))
    for wish in wishes:
        nav(wish)
        transport.advance(gap)
    return driver, host


def reason_of(host):
    return host.streams[0].pipeline.tallies["vflow1"].last.reason


def test_turning_has_a_limit_of_its_own_and_the_curve_stays():
    driver, host = driven(twist(1.0, turn=2.0), twist(1.0, turn=4.0), max_turn_limit=2.0)
    assert speeds(driver) == [(1.0, 2.0), (0.5, 2.0)]
    assert reason_of(host) == "limited to 2 rad/s (max_turn_limit)"


def test_driving_sideways_has_a_limit_of_its_own():
    driver, host = driven(twist(1.0, y=0.25), twist(1.0, y=-0.5, turn=1.0), max_side_limit=0.25)
    assert driver == [twist(1.0, y=0.25), twist(0.5, y=-0.25, turn=0.5)]
    assert reason_of(host) == "limited to 0.25 m/s sideways (max_side_limit)"


def test_the_speed_rises_no_faster_than_the_plan_says_and_falls_at_once():
    wishes = [twist(1.0)] * 5 + [twist(0.1)] + [twist(1.0)] * 2
    driver, host = driven(*wishes, max_accel_limit=2.0)
    expected = [0.2, 0.3, 0.4, 0.5, 0.6, 0.1, 0.2, 0.3]
    assert [x for x, _ in speeds(driver)] == pytest.approx(expected)
    assert reason_of(host) == "limited to 0.3 m/s (max_accel_limit)"


def test_after_a_stop_the_speed_rises_from_rest():
    """The stop's own messages count: what navigation said last is not what the robot does."""
    quick = replace(VELOCITY, flows=(replace(VELOCITY.flows[0], silent_after=SECOND // 10),))
    transport, _ = guarded(
        plan(PolicyName.CONSTRAIN, quick, max_vel_limit=9.0, max_accel_limit=2.0)
    )
    driver = transport.listen(OUT)
    nav = transport.publisher(NAV, peer("/nav"))
    for _ in range(10):
        nav(twist(1.0))
        transport.advance(SECOND // 20)
    fast = speeds(driver)[-1][0]
    transport.advance(SECOND * 3 // 4)
    assert speeds(driver)[-1] == (0.0, 0.0)
    nav(twist(1.0))
    assert fast > 1.0 - 1e-9
    assert speeds(driver)[-1][0] <= 0.2


def test_what_was_overridden_is_turned_down_when_the_override_ends():
    transport, host = guarded(
        plan(PolicyName.CONSTRAIN, VELOCITY, max_vel_limit=9.0, max_turn_limit=1.0)
    )
    driver = transport.listen(OUT)
    policy = host.streams[0].override_policies["rsrcn"]
    policy.grant("local", Override("somebody", "docking", SECOND))
    transport.publisher(NAV, peer("/nav"))(twist(1.0, turn=2.0))
    transport.advance(2 * SECOND)
    assert speeds(driver) == [(1.0, 2.0), (0.5, 1.0)]
