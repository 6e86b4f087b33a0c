"""The stop wave on a stream: what moved the robot falls silent or may not go on."""

from dataclasses import replace
from functools import partial
from itertools import pairwise

import pytest
from streams import peer, stage, stream
from velocity_messages import speeds, twist

from rtron.guard.coordinator import Coordinator
from rtron.guard.core.observations import Observations
from rtron.guard.transport.common.memory import MemoryTransport
from rtron.vocabulary import SECOND, Flow, Mode, OnSilence, PolicyName, StopProfile, StreamKind

OUT, NAV, TELEOP = "/rtron/cmd_vel/out", "/rtron/cmd_vel/flow1", "/rtron/cmd_vel/flow2"
STOP = StopProfile(decel=2.0, angular_decel=4.0, period=SECOND // 10, repeat=SECOND // 2)
FLOWS = (
    Flow(name="flow1", publisher="/nav", priority=2, silent_after=SECOND // 4),
    Flow(name="flow2", publisher="/teleop", priority=1, on_silence=OnSilence.RELEASE),
)


def guarded(flows=FLOWS, **more):
    transport = MemoryTransport()
    wanted = stream(stage(flows=flows), flows=flows, stop=STOP, **more)
    host = Coordinator(transport, (wanted,), Observations())
    host.open()
    driver = transport.listen(OUT) if OUT in transport.outputs else []
    return transport, host, driver


def test_a_silent_flow_is_ramped_down_on_its_curve_and_then_told_to_rest():
    transport, _, driver = guarded()
    transport.publisher(NAV, peer("/nav"))(twist(1.0, turn=0.5))
    transport.advance(SECOND // 4 - 1)
    assert len(driver) == 1
    transport.advance(1)
    assert len(driver) == 2
    transport.advance(5 * SECOND)
    sent = speeds(driver)
    assert [x for x, _ in sent[:6]] == pytest.approx([1.0, 0.8, 0.6, 0.4, 0.2, 0.0])
    assert [turn for _, turn in sent[:6]] == pytest.approx([0.5, 0.4, 0.3, 0.2, 0.1, 0.0])
    assert set(sent[5:]) == {(0.0, 0.0)}
    assert len(sent[5:]) == 5
    assert all(one[0] - other[0] <= 2.0 / 10 + 1e-9 for one, other in pairwise(sent))


def test_the_turn_is_ramped_within_its_own_limit():
    transport, _, driver = guarded()
    transport.publisher(NAV, peer("/nav"))(twist(0.1, turn=2.0))
    transport.advance(SECOND)
    turns = [turn for _, turn in speeds(driver)]
    assert turns[:4] == pytest.approx([2.0, 1.6, 1.2, 0.8])


def test_a_message_ends_the_stop():
    transport, _, driver = guarded()
    nav = transport.publisher(NAV, peer("/nav"))
    nav(twist(1.0))
    transport.advance(SECOND // 4 + SECOND // 10)
    nav(twist(0.9))
    transport.advance(SECOND // 4 - 1)
    assert [x for x, _ in speeds(driver)] == pytest.approx([1.0, 0.8, 0.6, 0.9])


def test_another_flow_may_take_over_from_a_stop():
    transport, _, driver = guarded()
    transport.publisher(NAV, peer("/nav"))(twist(1.0))
    transport.advance(SECOND // 2)
    told = len(driver)
    transport.publisher(TELEOP, peer("/teleop"))(twist(0.3))
    transport.advance(10 * SECOND)
    assert [x for x, _ in speeds(driver[told:])] == [0.3]


def test_who_rests_is_not_stopped():
    transport, host, driver = guarded()
    transport.publisher(NAV, peer("/nav"))(twist(0.0))
    transport.advance(10 * SECOND)
    assert len(driver) == 1
    assert host.streams[0].stop_controller.stop_count == 0


@pytest.mark.parametrize("bad", [b"", b"\x00", twist(float("nan")), twist(1.0) + b"\x00"])
def test_what_cannot_be_read_never_goes_out_and_stops_what_moves(bad):
    transport, host, driver = guarded()
    nav = transport.publisher(NAV, peer("/nav"))
    nav(bad)
    transport.advance(5 * SECOND)
    assert driver == []
    nav(twist(1.0))
    nav(bad)
    transport.advance(0)
    assert [x for x, _ in speeds(driver)] == pytest.approx([1.0, 0.8])
    assert host.streams[0].stop_controller.stop_count == 1


def test_a_released_flow_is_left_alone():
    transport, _, driver = guarded()
    transport.publisher(TELEOP, peer("/teleop"))(twist(1.0))
    transport.advance(10 * SECOND)
    assert len(driver) == 1


@pytest.mark.parametrize("more", [{"mode": Mode.OBSERVE}, {"type": "std_msgs/String"}])
def test_only_an_enforced_velocity_is_stopped(more):
    transport, host, driver = guarded(**more)
    transport.publisher(NAV, peer("/nav"))(twist(1.0))
    transport.publisher("/cmd_vel", peer("/nav"))(twist(1.0))
    transport.advance(10 * SECOND)
    assert not speeds(driver)
    assert host.streams[0].stop_controller.stop_count == 0


def test_a_state_is_not_stopped():
    flows = FLOWS
    transport = MemoryTransport()
    state = stream(stage(flows=flows, kind=StreamKind.STATE), flows=flows, stop=STOP)
    Coordinator(transport, (state,)).open()
    driver = transport.listen(OUT)
    transport.publisher(NAV, peer("/nav"))(twist(1.0))
    transport.advance(10 * SECOND)
    assert len(driver) == 1


def test_the_reason_is_told_while_the_robot_is_stopped():
    transport, host, _ = guarded()
    active = transport.listen("/rtron/grcn_cmd_vel/cmd_vel/active")
    transport.publisher(NAV, peer("/nav"))(twist(1.0))
    transport.advance(SECOND // 4)
    assert active[-1].endswith(b"stopping: flow1 has been silent for 0.25 s")
    assert "stopping" in host.statuses()[0].message
    transport.advance(2 * SECOND)
    assert active[-1].endswith(b"idle")


def test_an_internal_error_drops_the_message_and_stops_the_robot(monkeypatch):
    transport, host, driver = guarded()
    nav = transport.publisher(NAV, peer("/nav"))
    nav(twist(1.0))

    def fail(*_):
        raise RuntimeError("a fault of ours")

    policy = host.streams[0].pipeline.policies[0]
    monkeypatch.setattr(type(policy), "verdict", fail)
    nav(twist(2.0))
    assert [x for x, _ in speeds(driver)] == pytest.approx([1.0, 0.8])


def test_a_block_bit_is_no_silence():
    """A blocked flow never moved the robot, so there is nothing to stop."""
    blocked = tuple(replace(flow, block=True) for flow in FLOWS)
    transport, _, driver = guarded(blocked)
    transport.publisher(NAV, peer("/nav"))(twist(1.0))
    transport.advance(5 * SECOND)
    assert driver == []


QUICK = (replace(FLOWS[0], silent_after=SECOND // 10),)


def test_a_silence_is_noticed_in_time_although_the_owner_lapses_later():
    transport, _, driver = guarded(QUICK)
    nav = transport.publisher(NAV, peer("/nav"))
    nav(twist(0.0))
    transport.advance(SECOND // 10)
    nav(twist(1.0))
    transport.advance(SECOND // 10 - 1)
    assert len(driver) == 2
    transport.advance(1)
    assert len(driver) == 3


def test_timers_do_not_pile_up():
    transport, _, _ = guarded(QUICK)
    nav = transport.publisher(NAV, peer("/nav"))
    for n in range(500):
        nav(twist(float(n % 2)))
        transport.advance(SECOND // 8)
    assert len(transport._timers) < 20


# A publisher that is gone


LONG = 60 * SECOND
PATIENT = (
    Flow(name="flow1", publisher="/nav", priority=2, silent_after=LONG),
    Flow(name="flow2", publisher="/teleop", priority=1, silent_after=LONG),
)


def patient(policy=PolicyName.PREEMPTION, flows=PATIENT, **more):
    """Guard flows that may be silent for a minute: only a lost connection explains a stop."""
    transport = MemoryTransport()
    first = stage(policy=policy, flows=flows, release_after=LONG, max_hold=LONG, max_age=LONG)
    host = Coordinator(transport, (stream(first, flows=flows, stop=STOP, **more),), Observations())
    host.open()
    return transport, host, transport.listen(OUT)


def joined(transport, topic=NAV, node="/nav"):
    """Connect a publisher; return what it says things with, and what it leaves with."""
    who = peer(node)
    return transport.publisher(topic, who), partial(transport.leave, topic, who)


@pytest.mark.parametrize(
    "policy",
    [PolicyName.BLOCK, PolicyName.PREEMPTION, PolicyName.FIFO_QUEUE, PolicyName.PRIORITY_QUEUE],
)
def test_a_publisher_that_is_gone_is_silent_at_once(policy):
    transport, host, driver = patient(policy)
    say, leave = joined(transport)
    say(twist(1.0))
    leave()
    transport.advance(0)
    assert [x for x, _ in speeds(driver)] == pytest.approx([1.0, 0.8])
    assert host.streams[0].stop_controller.reason == "flow1 has lost its publisher"
    transport.advance(SECOND)
    assert speeds(driver)[-1] == (0.0, 0.0)


@pytest.mark.parametrize(
    "policy", [PolicyName.PREEMPTION, PolicyName.FIFO_QUEUE, PolicyName.PRIORITY_QUEUE]
)
def test_the_next_flow_drives_on_at_once(policy):
    transport, host, driver = patient(policy)
    say, leave = joined(transport)
    teleop, _ = joined(transport, TELEOP, "/teleop")
    say(twist(1.0))
    transport.advance(SECOND // 10)
    teleop(twist(0.5))
    assert [x for x, _ in speeds(driver)] == [1.0]
    leave()
    transport.advance(0)
    teleop(twist(0.25))
    assert speeds(driver)[-1] == (0.25, 0.0)
    assert host.streams[0].pipeline.owner == "flow2"


def test_what_waited_behind_it_goes_at_once_and_nothing_stops():
    transport, host, driver = patient(PolicyName.PRIORITY_QUEUE)
    say, leave = joined(transport)
    teleop, _ = joined(transport, TELEOP, "/teleop")
    say(twist(1.0))
    teleop(twist(0.5))
    leave()
    transport.advance(0)
    assert [x for x, _ in speeds(driver)] == [1.0, 0.5]
    assert host.streams[0].stop_controller.stop_count == 0


@pytest.mark.parametrize("policy", [PolicyName.FIFO_QUEUE, PolicyName.PRIORITY_QUEUE])
def test_what_it_wanted_itself_is_dropped(policy):
    transport, host, driver = patient(policy)
    nav, nav_leaves = joined(transport)
    teleop, teleop_leaves = joined(transport, TELEOP, "/teleop")
    nav(twist(1.0))
    teleop(twist(0.5))
    teleop_leaves()
    transport.advance(0)
    tally = host.streams[0].pipeline.tallies["flow2"]
    assert tally.last.reason == "flow2 has lost its publisher"
    nav_leaves()
    transport.advance(SECOND)
    assert 0.5 not in [x for x, _ in speeds(driver)]


def test_while_another_publisher_of_the_flow_is_there_nothing_happens():
    flows = (replace(PATIENT[0], publisher="/nav_*"),)
    transport, host, driver = patient(flows=flows)
    one, one_leaves = joined(transport, node="/nav_1")
    _, other_leaves = joined(transport, node="/nav_2")
    one(twist(1.0))
    one_leaves()
    transport.advance(SECOND)
    assert (len(driver), host.streams[0].stop_controller.stop_count) == (1, 0)
    other_leaves()
    transport.advance(SECOND)
    assert host.streams[0].stop_controller.stop_count == 1


def test_a_publisher_that_is_renewed_was_never_gone():
    """ROS 2 takes one away and offers it again where its QoS or its name has changed."""
    transport, host, driver = patient()
    say, leave = joined(transport)
    say(twist(1.0))
    leave()
    joined(transport)
    transport.advance(SECOND)
    assert (len(driver), host.streams[0].stop_controller.stop_count) == (1, 0)


@pytest.mark.parametrize("who", [("/nav", TELEOP), ("/rogue", NAV), ("/rogue", "/cmd_vel")])
def test_a_stranger_that_leaves_stops_nobody(who):
    node, topic = who
    transport, host, driver = patient()
    say, _ = joined(transport)
    say(twist(1.0))
    _, stranger_leaves = joined(transport, topic, node)
    stranger_leaves()
    transport.advance(SECOND)
    assert (len(driver), host.streams[0].stop_controller.stop_count) == (1, 0)


def test_who_does_not_drive_may_leave():
    transport, host, driver = patient()
    nav, _ = joined(transport)
    _, leave = joined(transport, TELEOP, "/teleop")
    nav(twist(1.0))
    leave()
    transport.advance(SECOND)
    assert len(driver) == 1
    assert host.streams[0].pipeline.owner == "flow1"


def test_a_flow_that_may_be_silent_may_leave():
    flows = (replace(PATIENT[0], on_silence=OnSilence.RELEASE),)
    transport, host, driver = patient(flows=flows)
    say, leave = joined(transport)
    say(twist(1.0))
    leave()
    transport.advance(SECOND)
    assert len(driver) == 1
    assert host.streams[0].stop_controller.moving_flow == flows[0]


def test_a_stranger_that_the_plan_lets_drive_is_missed_too():
    transport, host, driver = patient(block_unapproved=False)
    rogue, leave = joined(transport, "/cmd_vel", "/rogue")
    rogue(twist(1.0))
    leave()
    transport.advance(0)
    assert host.streams[0].stop_controller.reason == "unapproved has lost its publisher"
    assert len(driver) == 2


@pytest.mark.parametrize("kind", [StreamKind.ACTION, StreamKind.STATE])
def test_a_goal_outlives_the_client_that_sent_it(kind):
    transport = MemoryTransport()
    queue = stage(policy=PolicyName.FIFO_QUEUE, flows=PATIENT, kind=kind, max_age=LONG)
    host = Coordinator(transport, (stream(queue, flows=PATIENT),), Observations())
    host.open()
    heard = transport.listen(OUT)
    for topic, node, speed in ((NAV, "/nav", 1.0), (TELEOP, "/teleop", 2.0)):
        say, leave = joined(transport, topic, node)
        say(twist(speed))
        leave()
    transport.advance(SECOND)
    assert host.streams[0].pipeline.owner == "flow1"
    host.streams[0].on_action_done()
    assert [x for x, _ in speeds(heard)] == [1.0, 2.0]
