"""The world and its clients, on real sockets: what each role is told, a run, who is let go."""

import asyncio
import os
import signal
import socket
import subprocess
import sys
import termios
from contextlib import contextmanager
from fcntl import ioctl
from functools import partial
from itertools import count, pairwise
from threading import Thread, get_ident

import pytest
from harness import wait_for

from rtron.demos.apps.logic.demo_logic.device import LENGTHS, Device, encode
from rtron.demos.world import server
from rtron.demos.world.client import WorldClient
from rtron.demos.world.scenes.generator import make_scene
from rtron.demos.world.server import StepClock, WorldServer
from rtron.errors import SourceError

SPEED = 8.0
LIMIT = 20.0


@contextmanager
def serving(path):
    """Serve a world until the end of the block."""
    running = []

    async def serve():
        running.extend([asyncio.get_running_loop(), asyncio.current_task()])
        await WorldServer(SPEED).run(path)

    def run():
        with pytest.raises(asyncio.CancelledError):
            asyncio.run(serve())

    thread = Thread(target=run, daemon=True)
    thread.start()
    wait_for(path.exists)
    yield path
    loop, task = running
    loop.call_soon_threadsafe(task.cancel)
    thread.join(LIMIT)
    assert not thread.is_alive()


@contextmanager
def owner_of(path):
    owner = wait_for(lambda: WorldClient.connect(path))
    yield owner
    owner.close()


@pytest.fixture(scope="module")
def path(tmp_path_factory):
    with serving(tmp_path_factory.mktemp("w") / "world") as path:
        yield path


@pytest.fixture
def owner(path):
    with owner_of(path) as owner:
        yield owner


@pytest.fixture
def device(path, owner):
    """Give what connects devices, which are closed at the end."""
    made = []

    def connect(role):
        before = owner.count_devices().get(role, 0)
        made.append(Device(role, str(path)))
        wait_for(lambda: owner.count_devices().get(role, 0) > before)
        return made[-1]

    yield connect
    for each in made:
        each.close()
    wait_for(lambda: owner.count_devices() == {"owner": 1})


def head(device):
    assert device.has_frame(LIMIT)
    return device.receive()[0]


def head_when(device, condition):
    while not condition(found := head(device)):
        pass
    return found


def truth_when(owner, condition):
    """Return the first truth for which a condition holds."""
    for _ in range(400):
        for truth in filter(condition, owner.poll(LIMIT)):
            return truth
    raise AssertionError("it never came true")


def test_devices_get_their_frames_at_their_rates(device, owner):
    owner.reset("rsr", 1, camera_rate=4)
    for role, period, size in (("base", 0.05, 0), ("lidar", 0.2, 1440), ("camera", 0.25, 230400)):
        connected = device(role)
        frames = [connected.receive() for _ in range(5)]
        gaps = [after["t"] - before["t"] for (before, _), (after, _) in pairwise(frames)]
        assert min(gaps) == pytest.approx(period)
        assert {len(blob) for _, blob in frames} == {size}
    level = head(device("battery"))
    assert 0 < level["percentage"] <= 1 < level["voltage"]


def test_a_run_from_reset_to_a_collision(device, owner):
    base, mission = device("base"), device("mission")
    begun = owner.reset("gr", 5)
    owner.start()
    assert head(mission) == {"goal": list(make_scene("gr", 5).goal)}

    def has_hit(truth):
        base.send(velocity=[0.5, 0.6])
        return truth.collided

    hit = truth_when(owner, has_hit)
    assert hit.run == begun.run
    assert hit.commanded == (0.5, 0.6)
    assert head_when(base, lambda at: at["t"] >= hit.t)["pose"] == pytest.approx(hit.pose)
    again = owner.reset("gr", 5)
    assert again.run == begun.run + 1
    assert again.t >= hit.t
    fresh = truth_when(owner, lambda truth: True)
    assert fresh.run == again.run
    assert not fresh.collided
    assert fresh.position == make_scene("gr", 5).start[:2]


def test_where_a_person_drives_the_mission_gets_no_goal(device, owner):
    mission = device("mission")
    owner.reset("agent", 5)
    owner.start()
    owner.reset("gr", 5)
    owner.start()
    assert head(mission) == {"goal": list(make_scene("gr", 5).goal)}


def test_the_robot_stops_when_its_driver_is_gone(device, owner):
    owner.reset("gr", 1)
    owner.start()
    base = device("base")
    base.send(velocity=[0.1, 0.0])
    truth_when(owner, lambda truth: truth.velocity[0] > 0)
    base.close()
    assert not truth_when(owner, lambda truth: truth.velocity[0] == 0.0).collided


def test_the_computer_hears_of_its_rate(device, owner):
    owner.set_image_rate(10.0)
    computer = device("computer")
    assert head(computer) == {"rate": 10.0}
    owner.set_image_rate(2.5)
    assert head(computer) == {"rate": 2.5}
    owner.set_image_rate(10.0)


def test_the_owner_counts_devices(device, owner):
    first, _ = device("lidar"), device("lidar")
    assert owner.count_devices() == {"lidar": 2, "owner": 1}
    first.close()
    wait_for(lambda: owner.count_devices() == {"lidar": 1, "owner": 1})


@pytest.mark.parametrize(
    "data",
    [
        LENGTHS.pack(1, 0) + b"{",
        encode([]),
        encode({"velocity": [1, 0]}),
        encode({"hello": "base"}) + encode({"velocity": [1.0, "x"]}),
        encode({"hello": "lidar"}) + encode({"velocity": [0, 0]}),
        encode({"hello": "owner"})
        + encode({"order": "reset", "case": "x", "seed": 1, "camera_rate": 1}),
        encode({"hello": "owner"}) + encode({"order": "fly"}),
    ],
)
def test_whoever_breaks_the_protocol_is_let_go_and_the_world_goes_on(device, data, path):
    witness = device("base")
    with socket.socket(socket.AF_UNIX) as hostile:
        hostile.settimeout(LIMIT)
        hostile.connect(str(path))
        hostile.sendall(data)
        while hostile.recv(1 << 16):
            pass
    before = head(witness)["t"]
    assert head_when(witness, lambda at: at["t"] > before)


def test_a_reader_that_sleeps_holds_nobody_up(device):
    sleeper, awake = device("camera"), device("base")
    first = head(awake)["t"]
    head_when(awake, lambda at: at["t"] > first + 5.0)
    shown = [head(sleeper)["t"] for _ in range(8)]
    assert shown[-1] - shown[0] > 2.0


def test_a_signal_in_the_middle_of_a_frame_loses_nothing(tmp_path):
    def send_in_halves():
        with listening.accept()[0] as world:
            world.sendall(frame[: len(frame) // 2])
            wait_for(lambda: ioctl(world, termios.TIOCOUTQ, bytes(4)) == bytes(4))
            signal.pthread_kill(reader, signal.SIGUSR1)
            world.sendall(frame[len(frame) // 2 :])

    frame, reader = encode({"t": 1.0}, bytes(1000)), get_ident()
    before = signal.signal(signal.SIGUSR1, lambda *_: None)
    with socket.socket(socket.AF_UNIX) as listening:
        listening.bind(str(tmp_path / "world"))
        listening.listen()
        camera, sender = Device("camera", str(tmp_path / "world")), Thread(target=send_in_halves)
        sender.start()
        assert camera.receive() == ({"t": 1.0}, bytes(1000))
        sender.join()
        camera.close()
    signal.signal(signal.SIGUSR1, before)


def test_a_world_that_is_always_late_listens_all_the_same(tmp_path, monkeypatch):
    monkeypatch.setattr(server, "StepClock", partial(StepClock, wall=count().__next__))
    with serving(tmp_path / "late") as late, owner_of(late) as owner:
        base = Device("base", str(late))
        base.send(velocity=[0.1, 0.0])
        assert truth_when(owner, lambda truth: truth.commanded == (0.1, 0.0))
        base.close()


@pytest.mark.parametrize("number", [signal.SIGTERM, signal.SIGINT])
def test_the_process_ends_cleanly_and_says_nothing(tmp_path, number):
    path = tmp_path / "world"
    command = [sys.executable, "-m", "rtron.demos.world", str(path), "2.0"]
    with subprocess.Popen(
        command, env=os.environ, stdout=subprocess.PIPE, stderr=subprocess.STDOUT
    ) as world:
        with owner_of(path) as owner:
            assert owner.poll(LIMIT)
            world.send_signal(number)
            assert world.wait(LIMIT) == 0
            with pytest.raises(SourceError, match="its log says why"):
                owner.count_devices()
        assert world.communicate() == (b"", None)


def test_where_no_world_is_there_is_no_owner(tmp_path):
    assert WorldClient.connect(tmp_path / "absent") is None
