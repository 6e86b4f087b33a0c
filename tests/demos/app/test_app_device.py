"""How the demo's drivers speak to the world, and what they do when it is not there."""

import json
import socket
from contextlib import contextmanager
from tempfile import TemporaryDirectory
from threading import Thread
from types import SimpleNamespace

import pytest

from rtron.demos.apps.logic.demo_logic import frame_codec
from rtron.demos.apps.logic.demo_logic.device import Device
from rtron.demos.apps.logic.demo_logic.environment import CannotRun, map_file, speed
from rtron.demos.apps.logic.demo_logic.journal import Journal
from rtron.demos.apps.logic.demo_logic.message_fields import send_velocity

LIMIT = 10.0


def exactly_from(data):
    def exactly(size):
        nonlocal data
        part, data = data[:size], data[size:]
        assert len(part) == size
        return part

    return exactly


def next_frame(connection):
    """Return the next frame that the other side sent; ConnectionError at its end."""

    def exactly(size):
        data = connection.recv(size, socket.MSG_WAITALL)
        if len(data) < size:
            raise ConnectionError
        return data

    return frame_codec.read(exactly)


@contextmanager
def world(*frames, welcome=None):
    """Listen as a world that welcomes one device and sends it frames; gives path and connection."""
    accepted = SimpleNamespace(connection=None, hello=None)

    def serve():
        connection, _ = listener.accept()
        accepted.connection, accepted.hello = connection, next_frame(connection)[0]
        first = frame_codec.encode({"welcome": "base", "speed": 2.0, "t": 0.0})
        connection.sendall(first if welcome is None else welcome)
        for frame in frames:
            connection.sendall(frame)

    with TemporaryDirectory(prefix="demo-") as folder, socket.socket(socket.AF_UNIX) as listener:
        accepted.path = f"{folder}/w"
        listener.bind(accepted.path)
        listener.listen()
        accepted.thread = Thread(target=serve, daemon=True)
        accepted.thread.start()
        yield accepted
        accepted.thread.join(LIMIT)
        if accepted.connection:
            accepted.connection.close()


def end(accepted):
    accepted.thread.join(LIMIT)
    accepted.connection.shutdown(socket.SHUT_RDWR)


def test_a_frame_comes_back_as_it_went():
    data = frame_codec.encode({"run": 1, "t": 0.5}, b"\x00\xff")
    assert frame_codec.read(exactly_from(data)) == ({"run": 1, "t": 0.5}, b"\x00\xff")


@pytest.mark.parametrize(("extra", "refused"), [(0, False), (1, True)])
def test_the_longest_frame(extra, refused):
    head = {"": "x" * (frame_codec.MAX_HEAD - len(json.dumps({"": ""})) + extra)}
    blob = bytes(frame_codec.MAX_BLOB + extra)
    lengths = frame_codec.struct.pack("!II", len(json.dumps(head)), len(blob))
    if refused:
        with pytest.raises(ValueError, match="too long"):
            frame_codec.encode(head)
        with pytest.raises(ValueError, match="too long"):
            frame_codec.encode({}, blob)
        with pytest.raises(frame_codec.BrokenFrameError, match="too long"):
            frame_codec.read(exactly_from(lengths))
    else:
        assert frame_codec.read(exactly_from(frame_codec.encode(head, blob))) == (head, blob)


@pytest.mark.parametrize("text", [b"", b"[]", b"1", b"{", b"\xff", b"[" * 60_000])
def test_a_head_that_is_no_object_is_refused(text):
    with pytest.raises(frame_codec.BrokenFrameError):
        frame_codec.read(exactly_from(frame_codec.struct.pack("!II", len(text), 0) + text))


def test_a_device_says_who_it_is_and_gives_frames_until_the_world_ends():
    frames = [frame_codec.encode({"t": t}, bytes(t)) for t in range(3)]
    with world(*frames) as there:
        device = Device("base", there.path)
        assert device.speed == 2.0
        end(there)
        assert list(device) == [({"t": t}, bytes(t)) for t in range(3)]
        assert there.hello == {"hello": "base"}


def test_a_frame_that_is_cut_off_ends_the_device():
    with world(frame_codec.encode({"t": 1})[:-1]) as there:
        device = Device("base", there.path)
        end(there)
        assert list(device) == []


def test_closing_ends_a_device_that_waits_in_another_thread():
    with world() as there:
        device = Device("base", there.path)
        waiting = device.start(lambda head, blob: None)
        device.close()
        waiting.join(LIMIT)
        assert not waiting.is_alive()


def test_what_comes_is_handed_over():
    with world(frame_codec.encode({"t": 1}, b"x")) as there:
        device, taken = Device("base", there.path), []
        end(there)
        device.run(lambda head, blob: taken.append((head, blob)))
        assert taken == [({"t": 1}, b"x")]


def twist(forwards, turn):
    return SimpleNamespace(linear=SimpleNamespace(x=forwards), angular=SimpleNamespace(z=turn))


def test_velocities_reach_the_world_but_those_that_are_none(tmp_path):
    with world() as there:
        device, journal = Device("base", there.path), Journal("/core", str(tmp_path))
        send_velocity(device, journal, twist(float("nan"), 0.0))
        send_velocity(device, journal, twist(0.0, float("inf")))
        send_velocity(device, journal, twist(0.2, -0.1))
        there.thread.join(LIMIT)
        assert next_frame(there.connection)[0] == {"velocity": [0.2, -0.1]}
        end(there)
        assert list(device) == []
    lines = (tmp_path / "core.jsonl").read_text().splitlines()
    assert [json.loads(line)["what"] for line in lines] == ["received"] * 3


def test_what_is_no_number_is_not_sent():
    with world() as there:
        device = Device("base", there.path)
        with pytest.raises(ValueError, match="JSON compliant"):
            device.send(velocity=[float("nan"), 0.0])
        end(there)
        assert list(device) == []


def test_after_the_worlds_end_sending_does_nothing():
    with world() as there:
        device = Device("base", there.path)
        end(there)
        assert list(device) == []
        for _ in range(3):
            device.send(velocity=[0.0, 0.0])


@pytest.mark.parametrize(
    "welcome",
    [
        frame_codec.encode({"welcome": "base"}),
        frame_codec.encode({"speed": None}),
        frame_codec.encode({"speed": "fast"}),
        b"HTTP/1.1 400 Bad Request",
    ],
)
def test_who_does_not_welcome_is_no_world(welcome):
    with world(welcome=welcome) as there, pytest.raises(CannotRun, match="base"):
        Device("base", there.path)


def test_a_frame_that_is_none_ends_the_node_with_its_reason():
    with world(b"\xff" * 8) as there:
        device = Device("base", there.path)
        with pytest.raises(CannotRun, match="too long"):
            list(device)


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


@pytest.mark.parametrize("text", ["", "0.24", "8.1", "nan", "inf", "-1", "fast"])
def test_a_speed_that_no_world_has_is_refused(monkeypatch, text):
    monkeypatch.setenv("DEMO_SPEED", text)
    with pytest.raises(CannotRun, match="DEMO_SPEED"):
        speed()


def test_the_journal_of_a_node(monkeypatch, tmp_path):
    monkeypatch.setenv("DEMO_JOURNAL", str(tmp_path))
    journal = Journal("/robot/monitor")
    assert (tmp_path / "robot_monitor.jsonl").read_bytes() == b""
    journal.sent("/control/max_vel", [2.0], malicious=True)
    journal.received("/goal", (1.0, 2.0))
    first, second = map(json.loads, (tmp_path / "robot_monitor.jsonl").read_text().splitlines())
    assert first.pop("wall") <= second.pop("wall")
    assert first == {"what": "sent", "topic": "/control/max_vel", "value": [2.0], "malicious": True}
    assert second == {"what": "received", "topic": "/goal", "value": [1.0, 2.0]}


def test_without_a_folder_there_is_no_journal(monkeypatch, tmp_path):
    monkeypatch.delenv("DEMO_JOURNAL", raising=False)
    monkeypatch.chdir(tmp_path)
    Journal("/node").received("/goal", (1.0, 2.0))
    assert list(tmp_path.iterdir()) == []
