"""How the demo's drivers speak to the world, and what they do when it is not there."""

import json
import socket
from contextlib import contextmanager
from tempfile import TemporaryDirectory
from threading import Thread
from types import SimpleNamespace

import pytest

from rtron.demos.apps.logic.demo_logic.device import Device, encode
from rtron.demos.apps.logic.demo_logic.environment import CannotRun, map_file, speed
from rtron.demos.apps.logic.demo_logic.journal import Journal
from rtron.demos.apps.logic.demo_logic.message_fields import send_velocity

LIMIT = 10.0


@contextmanager
def world(*frames):
    """Listen as a world that sends one device frames; gives path, connection and what it heard."""
    accepted = SimpleNamespace()

    def serve():
        accepted.connection, _ = listener.accept()
        for frame in frames:
            accepted.connection.sendall(frame)

    with TemporaryDirectory(prefix="demo-") as folder, socket.socket(socket.AF_UNIX) as listener:
        accepted.path = f"{folder}/w"
        listener.bind(accepted.path)
        listener.listen()
        accepted.thread = Thread(target=serve, daemon=True)
        accepted.thread.start()
        yield accepted
        accepted.thread.join(LIMIT)
        accepted.connection.close()


def end(accepted):
    accepted.thread.join(LIMIT)
    accepted.connection.shutdown(socket.SHUT_RDWR)


def heard(accepted):
    """Return all that the device has sent, once it has ended."""
    accepted.thread.join(LIMIT)
    accepted.connection.settimeout(LIMIT)
    return b"".join(iter(lambda: accepted.connection.recv(4096), b""))


def test_a_device_says_who_it_is_and_gives_frames_until_the_world_ends():
    frames = [encode({"t": t}, bytes(t)) for t in range(3)]
    with world(*frames) as there:
        device = Device("base", there.path)
        there.thread.join(LIMIT)
        assert there.connection.recv(4096) == encode({"hello": "base"})
        end(there)
        assert list(device) == [({"t": t}, bytes(t)) for t in range(3)]


def test_a_frame_that_is_cut_off_ends_the_device():
    with world(encode({"t": 1})[:-1]) as there:
        device = Device("base", there.path)
        end(there)
        assert list(device) == []


def test_closing_ends_a_device_that_waits_in_another_thread():
    with world() as there:
        device = Device("base", there.path)
        waiting = Thread(target=list, args=(device,), daemon=True)
        waiting.start()
        device.close()
        waiting.join(LIMIT)
        assert not waiting.is_alive()


def twist(forwards, turn):
    return SimpleNamespace(linear=SimpleNamespace(x=forwards), angular=SimpleNamespace(z=turn))


def test_velocities_reach_the_world_but_those_that_are_none(tmp_path):
    with world() as there:
        device, journal = Device("base", there.path), Journal("/core", str(tmp_path))
        send_velocity(device, journal, twist(float("nan"), 0.0))
        send_velocity(device, journal, twist(0.0, float("inf")))
        send_velocity(device, journal, twist(0.2, -0.1))
        device.close()
        assert heard(there) == encode({"hello": "base"}) + encode({"velocity": [0.2, -0.1]})
    lines = (tmp_path / "core.jsonl").read_text().splitlines()
    assert [json.loads(line)["what"] for line in lines] == ["received"] * 3


def test_what_is_no_number_is_not_sent():
    with world() as there:
        device = Device("base", there.path)
        with pytest.raises(ValueError, match="JSON compliant"):
            device.send(velocity=[float("nan"), 0.0])
        device.close()
        assert heard(there) == encode({"hello": "base"})


def test_after_the_worlds_end_sending_does_nothing():
    with world() as there:
        device = Device("base", there.path)
        end(there)
        assert list(device) == []
        for _ in range(3):
            device.send(velocity=[0.0, 0.0])


def test_no_world_is_said_clearly(monkeypatch, tmp_path):
    with pytest.raises(CannotRun, match="no world at"):
        Device("base", str(tmp_path / "nobody"))
    monkeypatch.delenv("DEMO_WORLD", raising=False)
    with pytest.raises(CannotRun, match="DEMO_WORLD is not set"):
        Device("base")
    monkeypatch.delenv("DEMO_MAP", raising=False)
    with pytest.raises(CannotRun, match="DEMO_MAP is not set"):
        map_file()


@pytest.mark.parametrize(("text", "value"), [("0.25", 0.25), ("8", 8.0), (None, 1.0)])
def test_speed(monkeypatch, text, value):
    monkeypatch.delenv("DEMO_SPEED", raising=False)
    if text:
        monkeypatch.setenv("DEMO_SPEED", text)
    assert speed() == value


def test_the_journal_of_a_node(monkeypatch, tmp_path):
    monkeypatch.setenv("DEMO_JOURNAL", str(tmp_path))
    journal = Journal("/robot/monitor")
    assert (tmp_path / "robot_monitor.jsonl").read_bytes() == b""
    journal.sent("/control/max_vel", [2.0])
    journal.received("/goal", (1.0, 2.0))
    first, second = map(json.loads, (tmp_path / "robot_monitor.jsonl").read_text().splitlines())
    assert first.pop("wall") <= second.pop("wall")
    assert first == {"what": "sent", "topic": "/control/max_vel", "value": [2.0]}
    assert second == {"what": "received", "topic": "/goal", "value": [1.0, 2.0]}


def test_without_a_folder_there_is_no_journal(monkeypatch, tmp_path):
    monkeypatch.delenv("DEMO_JOURNAL", raising=False)
    monkeypatch.chdir(tmp_path)
    Journal("/node").received("/goal", (1.0, 2.0))
    assert list(tmp_path.iterdir()) == []
