"""When the guard before was last there."""

import os
import time
from pathlib import Path
from threading import Event

import pytest
from harness import wait_for

from rtron.guard.core.event_loop import EventLoop
from rtron.guard.core.handover_state import HeartbeatFile, heartbeat_path


@pytest.fixture
def path(tmp_path):
    return tmp_path / "robot.heartbeat"


def test_the_first_guard_knows_of_nobody(path):
    assert HeartbeatFile(path).previous_time == 0


def test_the_next_one_knows_when_it_was_there(path):
    before = time.time_ns()
    loop = EventLoop()
    HeartbeatFile(path).beat(loop)
    wait_for(path.exists, what="the first heartbeat")
    assert path.stat().st_mode & 0o777 == 0o600
    os.utime(path, ns=(before - 7, before - 7))
    assert HeartbeatFile(path).previous_time == before - 7
    loop.step()
    wait_for(lambda: HeartbeatFile(path).previous_time > before - 7, what="the next heartbeat")
    loop.close()


def test_a_disk_that_hangs_keeps_nobody_waiting(path, monkeypatch):
    may_go_on, touch = Event(), Path.touch

    def hang(path, **options):
        may_go_on.wait()
        touch(path, **options)

    monkeypatch.setattr(Path, "touch", hang)
    loop, called = EventLoop(), []
    HeartbeatFile(path).beat(loop)
    loop.call_later(1.1, lambda: called.append("two heartbeats later"))
    while not called:
        loop.step()
    assert not path.exists()
    may_go_on.set()
    wait_for(path.exists, what="the heartbeat")
    loop.close()


def test_a_time_to_come_counts_as_now(path):
    path.touch()
    future = time.time_ns() + 10**12
    os.utime(path, ns=(future, future))
    assert HeartbeatFile(path).previous_time <= time.time_ns()


def test_where_nothing_can_be_written_the_guard_goes_on(tmp_path):
    loop, called = EventLoop(), []
    path = tmp_path / "none" / "robot.heartbeat"
    HeartbeatFile(path).beat(loop)
    path.parent.mkdir()
    loop.call_later(1.1, lambda: called.append("the next heartbeat"))
    while not called:
        loop.step()
    wait_for(path.exists, what="the heartbeat")
    loop.close()


@pytest.mark.parametrize(
    ("address", "expected"),
    [
        ("domain 42", "rtron-a-domain_42.heartbeat"),
        ("http://localhost:11311", "rtron-a-http___localhost_11311.heartbeat"),
        ("../" * 40, f"rtron-a-{'_' * 64}.heartbeat"),
    ],
)
def test_each_master_and_domain_has_a_file_of_its_own(address, expected):
    assert heartbeat_path(Path("/run/rtron-a.sock"), address) == Path("/run") / expected
