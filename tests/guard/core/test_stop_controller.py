"""The stop wave on a stream: what moved the robot falls silent or may not go on."""

from dataclasses import replace
from itertools import pairwise

import pytest
from streams import peer, stage, stream
from velocity_messages import speeds, twist

from rtron.guard.coordinator import Coordinator
from rtron.guard.core.observations import Observations
from rtron.guard.transport.common.memory import MemoryTransport
from rtron.vocabulary import SECOND, Flow, Mode, OnSilence, StopProfile, StreamKind

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
    assert len(sent[5:]) == 6
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


def test_a_killed_coordination_node_stops_the_robot():
    transport, host, driver = guarded()
    transport.publisher(NAV, peer("/nav"))(twist(1.0))
    host.shut_down_node("/rtron/grcn_cmd_vel", "a test")
    assert [x for x, _ in speeds(driver)] == pytest.approx([1.0, 0.8])
    transport.publisher(NAV, peer("/nav"))(twist(1.0))
    transport.advance(5 * SECOND)
    assert [x for x, _ in speeds(driver)][2:6] == pytest.approx([0.6, 0.4, 0.2, 0.0])


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
