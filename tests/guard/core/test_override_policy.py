"""Supervised overrides: asked for through the guard's door, in force for a while, never beyond."""

import json
import logging
import os
import pwd
import socket
import threading
from concurrent.futures import Future
from contextlib import suppress

import pytest
from streams import peer
from test_velocity_limits import MAX_VEL, NAV, OUT, VELOCITY, guarded, plan
from velocity_messages import FLOAT64, float64, floats, speeds, twist

from rtron.errors import SourceError, WireError
from rtron.guard import runner
from rtron.guard.core.control_socket import ControlSocket, control_path
from rtron.guard.core.event_loop import EventLoop
from rtron.guard.settings.local_overrides import MAX_DURATION, OverrideCommands
from rtron.vocabulary import SECOND, PolicyName


def limited():
    transport, host = guarded(plan(PolicyName.CONSTRAIN, VELOCITY, max_vel_limit=0.2))
    driver = transport.listen(OUT)
    return (
        transport,
        transport.publisher(NAV, peer("/nav")),
        driver,
        OverrideCommands(host, transport),
    )


def asked(duration, reason="docking", id="rsrcn"):
    return {"override": id, "duration": duration, "reason": reason}


def test_what_was_limited_passes_until_the_override_expires():
    transport, nav, driver, overriding = limited()
    overriding.handle("ann", asked(SECOND))
    nav(twist(1.0))
    transport.advance(SECOND - 1)
    nav(twist(1.0))
    transport.advance(1)
    nav(twist(1.0))
    assert [x for x, _ in speeds(driver)] == [1.0, 1.0, 0.2, 0.2]


def test_an_override_can_be_ended_before_its_time():
    _, nav, driver, overriding = limited()
    overriding.handle("ann", asked(SECOND))
    overriding.handle("ann", asked(0, reason=""))
    nav(twist(1.0))
    assert [x for x, _ in speeds(driver)] == [0.2]


def test_the_verdict_tells_who_overrode_it_and_why():
    transport, host = guarded(plan(PolicyName.CONSTRAIN, VELOCITY, max_vel_limit=0.2))
    OverrideCommands(host, transport).handle("ann", asked(SECOND))
    transport.publisher(NAV, peer("/nav"))(twist(1.0))
    reason = host.streams[0].pipeline.tallies["vflow1"].last.reason
    assert reason == "overridden by ann (docking): limited to 0.2 m/s (max_vel_limit)"


def test_an_override_is_told_while_it_lasts():
    transport, host = guarded(plan(PolicyName.CONSTRAIN, VELOCITY, max_vel_limit=0.2))
    OverrideCommands(host, transport).handle("ann", asked(3 * SECOND))
    assert host.statuses()[0].values["overridden rsrcn"] == "by ann, 3 s left: docking"
    assert host.statuses()[0].level == 1
    transport.advance(3 * SECOND)
    assert "overridden rsrcn" not in host.statuses()[0].values
    assert host.statuses()[0].level == 0


def test_what_cannot_be_judged_and_who_is_unknown_stay_out():
    transport, nav, driver, overriding = limited()
    overriding.handle("ann", asked(SECOND))
    nav(twist(float("nan")))
    transport.publisher("/cmd_vel", peer("/rogue"))(twist(1.0))
    transport.publisher(NAV, peer("/rogue"))(twist(1.0))
    assert driver == []


def test_a_limit_of_zero_stops_the_robot_again_when_the_override_expires():
    transport, host = guarded(plan(PolicyName.CONSTRAIN, VELOCITY, max_vel_limit=0.0))
    driver = transport.listen(OUT)
    OverrideCommands(host, transport).handle("ann", asked(SECOND))
    transport.publisher(NAV, peer("/nav"))(twist(1.0))
    transport.advance(SECOND)
    assert [x for x, _ in speeds(driver)] == pytest.approx([1.0, 0.875])


def test_a_maximal_velocity_is_taken_back_when_the_override_expires():
    transport, host = guarded(plan(PolicyName.CONSTRAIN, MAX_VEL, max_vel_limit=0.2))
    driver = transport.listen("/rtron/max_vel/out")
    decider = transport.publisher("/rtron/max_vel/vflow1", peer("/decider", FLOAT64))
    decider(float64(0.1))
    OverrideCommands(host, transport).handle("ann", asked(SECOND))
    decider(float64(2.0))
    transport.advance(SECOND)
    assert floats(driver) == [0.1, 2.0, 0.2]
    transport.advance(10 * SECOND)
    assert floats(driver) == [0.1, 2.0, 0.2]


@pytest.mark.parametrize(
    "request_",
    [
        {},
        asked(SECOND) | {"more": 1},
        asked(SECOND, id="grcn_cmd_vel"),
        asked(SECOND, id=None),
        asked(SECOND, reason="  "),
        asked(SECOND, reason="\n\x1b\u2028\ud800"),
        asked(SECOND, reason=3),
        asked(-1),
        asked(MAX_DURATION + 1),
        asked(duration=True),
        asked(1.5),
    ],
)
def test_a_request_that_is_wrong_grants_nothing(request_):
    _, nav, driver, overriding = limited()
    with pytest.raises(WireError):
        overriding.handle("ann", request_)
    nav(twist(1.0))
    assert [x for x, _ in speeds(driver)] == [0.2]


@pytest.mark.parametrize(
    ("reason", "kept"),
    [
        (r'"dock\ud800ing"', "dock ing"),
        (
            r'"docking\nWARNING rsrcn: overridden by root"',
            "docking WARNING rsrcn: overridden by root",
        ),
        (r'"\u001b[2K\rdo\u0000c\u2028k\u202e "', "[2K do c k"),
        (r'"zum Ladegerät \ud83d\ude00"', "zum Ladegerät \U0001f600"),
        (json.dumps("x" * 300), "x" * 200),
    ],
)
def test_a_reason_is_one_line_of_what_can_be_printed(reason, kept, caplog):
    transport, host = guarded(plan(PolicyName.CONSTRAIN, VELOCITY, max_vel_limit=0.2))
    OverrideCommands(host, transport).handle("ann", asked(SECOND, reason=json.loads(reason)))
    assert caplog.messages == [f"rsrcn: overridden by ann for 1.0 s: {kept}"]
    assert host.statuses()[0].values["overridden rsrcn"].encode().decode().endswith(f": {kept}")
    transport.publisher(NAV, peer("/nav"))(twist(1.0))
    why = host.streams[0].pipeline.tallies["vflow1"].last.reason
    assert f"({kept})" in why.encode().decode()


@pytest.fixture
def door(tmp_path):
    """A loop in a thread of its own, with a door that tells what it was asked."""
    loop = EventLoop()
    path = tmp_path / "door" / "guard.sock"
    control = ControlSocket(loop, path, lambda who, request: {"who": who, **request})
    control.open()
    thread = threading.Thread(target=loop.run)
    thread.start()
    yield path
    loop.post(loop.stop)
    thread.join()
    control.close()
    loop.close()


def talk(path, data):
    with socket.socket(socket.AF_UNIX, socket.SOCK_STREAM) as sock:
        sock.settimeout(5)
        sock.connect(str(path))
        sock.sendall(data)
        sock.shutdown(socket.SHUT_WR)
        return sock.makefile("rb").read()


def test_the_door_answers_line_by_line_and_knows_who_asks(door):
    answers = talk(door, b'{"a": 1}\n{"a": 2}\n').splitlines()
    assert [json.loads(answer)["a"] for answer in answers] == [1, 2]
    assert json.loads(answers[0])["who"]


@pytest.mark.parametrize("error", ["", "not now"])
def test_a_response_that_comes_later_is_sent_although_the_client_says_no_more(tmp_path, error):
    loop, response = EventLoop(), Future()
    control = ControlSocket(loop, tmp_path / "door" / "guard.sock", lambda who, request: response)
    control.open()
    with socket.socket(socket.AF_UNIX, socket.SOCK_STREAM) as sock:
        sock.connect(str(tmp_path / "door" / "guard.sock"))
        sock.sendall(b'{"a": 1}\n')
        sock.shutdown(socket.SHUT_WR)
        for _ in range(5):
            loop.step(0.02)
        sock.settimeout(0)
        with pytest.raises(BlockingIOError):
            sock.recv(1)
        if error:
            response.set_exception(WireError(error))
        else:
            response.set_result({"done": True})
        sock.settimeout(5)
        said = json.loads(sock.makefile("rb").read())
    assert said == ({"error": error} if error else {"done": True})
    control.close()
    loop.close()


def test_a_response_to_a_client_that_is_gone_is_dropped(tmp_path):
    loop, response = EventLoop(), Future()
    control = ControlSocket(loop, tmp_path / "door" / "guard.sock", lambda who, request: response)
    control.open()
    with socket.socket(socket.AF_UNIX, socket.SOCK_STREAM) as sock:
        sock.connect(str(tmp_path / "door" / "guard.sock"))
        sock.sendall(b'{"a": 1}\n')
        for _ in range(5):
            loop.step(0.02)
    response.set_result({"done": True})
    for _ in range(5):
        loop.step(0.02)
    assert talk_with(loop, tmp_path / "door" / "guard.sock") == {"done": True}
    control.close()
    loop.close()


def talk_with(loop, path):
    """Ask on a loop that this thread runs."""
    with socket.socket(socket.AF_UNIX, socket.SOCK_STREAM) as sock:
        sock.connect(str(path))
        sock.sendall(b"{}\n")
        for _ in range(5):
            loop.step(0.02)
        said = json.loads(sock.makefile("rb").readline())
    for _ in range(5):
        loop.step(0.02)
    return said


@pytest.mark.parametrize(
    "data", [b"\n", b"{\n", b"[]\n", b"\xff\xfe\n", b"[" * 3000 + b"\n", b'{"a":NaN' + b"\n"]
)
def test_the_door_refuses_what_is_no_request_and_stays_open(door, data):
    assert "error" in json.loads(talk(door, data))
    assert talk(door, b'{"a": 1}\n')


def test_the_door_does_not_collect_a_line_without_end(door):
    answered = b""
    with suppress(ConnectionError):
        answered = talk(door, b"x" * 20_000)
    assert answered == b""
    assert talk(door, b'{"a": 1}\n')


def test_only_the_guard_s_user_can_reach_the_door(door):
    assert door.stat().st_mode & 0o077 == 0
    assert door.parent.stat().st_mode & 0o077 == 0


def test_a_folder_that_others_may_enter_is_refused(tmp_path):
    folder = tmp_path / "open"
    folder.mkdir(mode=0o755)
    loop = EventLoop()
    with pytest.raises(SourceError, match="others may enter"):
        ControlSocket(loop, folder / "guard.sock", lambda who, request: {})
    loop.close()


@pytest.fixture
def open_control_socket(tmp_path):
    """Return what opens a door at one path, which nobody serves."""
    loop = EventLoop()
    (tmp_path / "door").mkdir(mode=0o700)
    path = tmp_path / "door" / "guard.sock"
    yield lambda: ControlSocket(loop, path, lambda who, request: {}), path
    loop.close()


def test_a_second_guard_leaves_the_door_to_the_first(door):
    loop = EventLoop()
    with pytest.raises(SourceError, match=f"another guard listens at {door}") as refused:
        ControlSocket(loop, door, lambda who, request: {})
    loop.close()
    assert "--control-socket" in refused.value.help
    assert talk(door, b'{"a": 1}\n')


def full(caller, path):
    """Tell whether a door has no room for one more caller; these are not waited for."""
    caller.settimeout(0)
    try:
        caller.connect(str(path))
    except BlockingIOError:
        return True
    return False


def test_a_guard_that_hears_nobody_out_is_there_all_the_same(open_control_socket):
    control, path = open_control_socket
    first = control()
    callers = []
    while not (callers and full(callers[-1], path)):
        callers.append(socket.socket(socket.AF_UNIX, socket.SOCK_STREAM))
    with pytest.raises(SourceError, match="another guard listens"):
        control()
    for caller in callers:
        caller.close()
    first.close()


def test_nobodys_name_is_looked_up_while_the_guard_runs(open_control_socket, monkeypatch):
    """The directory of users may be on the network."""
    open_socket, path = open_control_socket
    control = open_socket()
    control.open()
    monkeypatch.setattr(pwd, "getpwuid", lambda uid: pytest.fail("a look-up"))
    with socket.socket(socket.AF_UNIX) as client:
        client.connect(str(path))
        client.sendall(b"{}\n")
        for _ in range(2):
            control._loop.step(1)
        assert client.recv(100) == b"{}\n"
    control._loop.step(1)
    control.close()


def test_a_socket_that_a_guard_left_behind_is_replaced(open_control_socket):
    control, path = open_control_socket
    with socket.socket(socket.AF_UNIX, socket.SOCK_STREAM) as gone:
        gone.bind(str(path))
    made = control()
    with socket.socket(socket.AF_UNIX, socket.SOCK_STREAM) as caller:
        caller.connect(str(path))
    made.close()
    assert not path.exists()


def test_what_is_no_socket_is_not_replaced(open_control_socket):
    control, path = open_control_socket
    path.write_text("mine")
    with pytest.raises(SourceError, match="in use"):
        control()
    assert path.read_text() == "mine"


def test_at_its_end_a_guard_removes_only_its_own_socket(open_control_socket):
    control, path = open_control_socket
    first = control()
    path.unlink()
    second = control()
    first.close()
    assert path.is_socket()
    second.close()
    assert not path.exists()
    second.close()


def test_a_path_that_is_too_long_for_a_socket_is_refused(tmp_path):
    loop = EventLoop()
    (tmp_path / "door").mkdir(mode=0o700)
    with pytest.raises(SourceError, match="too long") as refused:
        ControlSocket(loop, tmp_path / "door" / ("x" * 108), lambda who, request: {})
    loop.close()
    assert refused.value.help == "choose --control-socket PATH"


def test_a_guard_tells_where_it_listens(open_control_socket, caplog):
    control, path = open_control_socket
    with caplog.at_level(logging.INFO):
        control().close()
    assert caplog.messages == [f"listening for requests at {path}"]


def test_the_door_of_an_app_lies_in_the_user_s_own_folder(monkeypatch, tmp_path):
    monkeypatch.setenv("XDG_RUNTIME_DIR", str(tmp_path))
    assert control_path("my app/../x") == tmp_path / "rtron-my_app____x.sock"
    monkeypatch.setenv("XDG_RUNTIME_DIR", str(tmp_path / "gone"))
    assert control_path("").parent.name == f"rtron-{os.getuid()}"
    monkeypatch.delenv("XDG_RUNTIME_DIR")
    assert control_path("").parent.name == f"rtron-{os.getuid()}"


def test_a_guard_whose_door_cannot_be_opened_guards_without_one(monkeypatch, tmp_path, caplog):
    open_to_all = tmp_path / "open"
    open_to_all.mkdir(mode=0o755)
    monkeypatch.setenv("XDG_RUNTIME_DIR", str(open_to_all))
    loop, small = EventLoop(), plan(PolicyName.CONSTRAIN, VELOCITY, max_vel_limit=0.2)
    assert runner.open_control_socket(loop, small, None, lambda who, request: {}) is None
    assert f"`rtron clear` do not reach this guard: others may enter {open_to_all}; " in caplog.text
    with pytest.raises(SourceError):
        runner.open_control_socket(loop, small, open_to_all / "guard.sock", lambda who, request: {})
    loop.close()
