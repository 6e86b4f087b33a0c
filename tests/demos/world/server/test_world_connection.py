"""The clock, the outbox and the socket's file."""

import socket

import pytest

from rtron.demos.world.robot_base import STEP
from rtron.demos.world.server.connection import MAX_REPLACED_STATES, MAX_WAITING, SendQueue
from rtron.demos.world.server.loop import StepClock
from rtron.demos.world.server.unix_socket import listen_on_unix_socket
from rtron.errors import SourceError, WireError


class Wall:
    def __init__(self):
        self.now = 100.0

    def __call__(self):
        return self.now


def steps(clock):
    count = 0
    while clock.is_due():
        count += 1
    return count


def test_steps_come_at_the_speed_and_do_not_drift():
    wall = Wall()
    clock = StepClock(2.0, STEP, wall)
    count = 0
    for _ in range(3000):
        wall.now += 0.01 / 3
        count += steps(clock)
    assert count == pytest.approx(10.0 * 2.0 / STEP, abs=1)
    assert clock.lost_time == 0.0


def test_a_clock_tells_how_long_to_wait_and_what_has_passed_of_a_step():
    wall = Wall()
    clock = StepClock(2.0, STEP, wall)
    assert clock.wait() == pytest.approx(0.025)
    wall.now += 0.020
    assert clock.wait() == pytest.approx(0.005)
    assert clock.step_fraction() == pytest.approx(0.8)
    wall.now += 0.020
    assert (clock.wait(), clock.step_fraction()) == (0.0, 1.0)


def test_a_clock_catches_up_a_little_and_lets_time_go_slower_if_it_is_far_behind():
    wall = Wall()
    clock = StepClock(1.0, STEP, wall)
    wall.now += 0.3
    assert steps(clock) == pytest.approx(6, abs=1)
    wall.now += 60.0
    assert steps(clock) == 1
    assert clock.lost_time == pytest.approx(60.0, abs=0.1)


def test_an_outbox_sends_in_order_however_little_is_taken():
    box, sent = SendQueue(), bytearray()
    box.add(b"first")
    box.replace_state(b"old")
    box.replace_state(b"new")
    box.add(b"second")

    def take(data):
        sent.extend(data[:2])
        return len(data[:2])

    while box:
        box.flush(take)
    assert sent == b"firstsecondnew"


def test_a_state_does_not_cut_a_frame_that_is_half_sent():
    box, sent = SendQueue(), bytearray()
    box.replace_state(b"abcdef")
    box.flush(lambda data: sent.extend(data[:3]) or 3)
    box.replace_state(b"later")
    box.flush(lambda data: sent.extend(data) or len(data))
    assert sent == b"abcdeflater"


def test_who_does_not_take_what_must_arrive_is_given_up():
    box = SendQueue()
    for _ in range(MAX_WAITING):
        box.add(b"x")
    with pytest.raises(WireError):
        box.add(b"x")


def test_who_takes_no_states_is_given_up():
    box = SendQueue()
    for _ in range(MAX_REPLACED_STATES + 2):
        box.replace_state(b"x")
        box.flush(lambda _: 0)
    with pytest.raises(WireError):
        box.replace_state(b"x")


def test_who_reads_slowly_is_kept():
    box = SendQueue()
    for _ in range(3 * MAX_REPLACED_STATES):
        box.replace_state(b"xy")
        box.flush(lambda _: 1)
    assert box


def test_the_socket_is_private_and_goes_with_the_world(tmp_path):
    path = tmp_path / "world"
    with listen_on_unix_socket(path):
        assert path.stat().st_mode & 0o777 == 0o600
    assert not path.exists()


def test_a_living_worlds_socket_is_not_replaced(tmp_path):
    path = tmp_path / "world"
    with listen_on_unix_socket(path):
        inode = path.stat().st_ino
        with pytest.raises(SourceError, match="already lives"), listen_on_unix_socket(path):
            pass
        assert path.stat().st_ino == inode


def test_a_dead_worlds_socket_is_replaced(tmp_path):
    path = tmp_path / "world"
    with socket.socket(socket.AF_UNIX) as dead:
        dead.bind(str(path))
    with listen_on_unix_socket(path) as listener, socket.socket(socket.AF_UNIX) as client:
        client.connect(str(path))
        assert listener.getsockname() == str(path)


def test_what_is_no_socket_is_left_alone(tmp_path):
    path = tmp_path / "world"
    path.write_text("precious")
    with pytest.raises(SourceError, match="no socket"), listen_on_unix_socket(path):
        pass
    assert path.read_text() == "precious"


def test_a_path_that_cannot_be_is_an_error_with_a_reason(tmp_path):
    for path in (tmp_path / "absent" / "world", tmp_path / ("x" * 200)):
        with pytest.raises(SourceError, match="cannot listen"), listen_on_unix_socket(path):
            pass


def test_another_worlds_socket_is_not_removed(tmp_path):
    path = tmp_path / "world"
    with listen_on_unix_socket(path):
        other = tmp_path / "other"
        other.write_text("another world's")
        other.replace(path)
    assert path.exists()
