"""The latched stop of a guard: from buttons and persons, over restarts, until all is released."""

import json
import os
import socket
import struct
from concurrent.futures import Future
from dataclasses import replace
from pathlib import Path
from threading import Event

import pytest
from harness import wait_for
from leased_base import NAV, PLAN, STRANGER, TELEOP, TWIST, LeasedBase
from velocity_messages import twist

from rtron.errors import WireError
from rtron.guard.authority.latched_stops import LatchedStops, stop_file
from rtron.guard.authority.lease_commands import StopCommands
from rtron.guard.authority.stop_buttons import StopButtons
from rtron.guard.core.handover_state import STOPS, HandoverState
from rtron.guard.core.state_file import StateFile
from rtron.guard.transport.common.protocol import Peer, TypeInfo
from rtron.vocabulary import SECOND, Mode, PolicyName, StopButton, StopSources

BOOL = TypeInfo("std_msgs/Bool", "8b94c1b53db61fb6aed406028ad6332a")
BUTTON = StopButton(name="red", topic="/estop", publisher="/estop_driver")
PRESSED, FREE = (struct.pack("<IB", 1, each) for each in (1, 0))
RELEASE = {"release": "robot", "reason": "the track is free"}


def state_file(path):
    return StateFile(path, "what is stopped is not kept for the time after a reboot")


def prioritised(plan):
    """Return a plan whose flows need no lease."""
    nodes = (replace(each, policy=PolicyName.BLOCK, lease="") for each in plan.grcn)
    return replace(plan, grcn=tuple(nodes), leases=())


class Stopped(LeasedBase):
    """A base in memory whose guard latches stops."""

    def __init__(self, plan, file, inherited=b""):
        super().__init__(plan)
        self.handed_over = []
        handover = HandoverState(inherited, self.handed_over.append)
        self.stops = LatchedStops(self.host, self.transport, plan)
        self.stops.keep(handover, file)
        self.buttons = StopButtons(plan.stop_sources.buttons, self.stops, self.transport)
        self.buttons.open()
        self.stop_commands = StopCommands(self.stops)

    def ask_guard(self, **request):
        answer = self.stop_commands.handle("ann", request)
        return self.wait_for_disk(answer) if isinstance(answer, Future) else answer

    def wait_for_disk(self, answer):
        def look():
            self.pass_time(SECOND // 100)
            return answer.done()

        wait_for(look, what="the answer to the stop")
        return answer.result()

    def press(self, message=PRESSED, publisher=BUTTON.publisher):
        peer = Peer(publisher, BOOL)
        self._publisher(publisher, BUTTON.topic, BOOL, {})(message)
        return peer

    def lose_button(self):
        self.transport.leave(BUTTON.topic, Peer(BUTTON.publisher, BOOL))
        self._publish.pop((BUTTON.publisher, BUTTON.topic, ()))
        self.pass_time(0)


@pytest.fixture
def file(tmp_path):
    return state_file(tmp_path / "app" / "stops.json")


@pytest.fixture
def base(file):
    return Stopped(prioritised(PLAN), file)


@pytest.fixture
def with_button(file):
    sources = StopSources(buttons=(BUTTON,))
    return Stopped(replace(prioritised(PLAN), stop_sources=sources), file)


def test_a_stop_holds_until_it_is_released(base):
    assert base.drive(NAV, 0.5)
    answer = base.ask_guard(stop="a person on the track")["answer"]
    assert answer == "stopped by ann: a person on the track"
    base.pass_time(SECOND)
    assert base.speeds()[-1] == 0.0
    assert not base.drive(NAV, 0.5)
    assert base.reason("nav") == "latched stop: robot by ann: a person on the track"
    base.pass_time(60 * SECOND)
    assert not base.drive(NAV, 0.5)
    base.pass_time(SECOND)
    released = base.stop_commands.handle("bob", RELEASE)["answer"]
    assert released == "the stop of robot is released by bob: the track is free"
    assert base.drive(NAV, 0.5)


def test_a_stop_needs_no_reason_and_a_release_does(base):
    assert base.ask_guard(stop="")["answer"] == "stopped by ann: no reason given"
    with pytest.raises(WireError, match="to release the stop of robot needs a reason"):
        base.ask_guard(release="robot", reason=" ")
    listed = base.ask_guard(release="", reason="")["stops"]
    assert (listed["robot"]["by"], listed["robot"]["reason"]) == ("ann", "no reason given")


@pytest.mark.parametrize(
    "request_of_a_person",
    [
        {"stop": 3},
        {"stop": "x", "more": 1},
        {"release": "robot"},
        {"release": 3, "reason": "x"},
        {"release": "nobody", "reason": "x"},
    ],
)
def test_a_wrong_request_changes_nothing(base, request_of_a_person):
    base.ask_guard(stop="test")
    with pytest.raises(WireError):
        base.stop_commands.handle("ann", request_of_a_person)
    assert set(base.stops.stops) == {"robot"}


def test_a_release_needs_commanders_that_stand_still(base):
    base.ask_guard(stop="test")
    base.drive(NAV, 0.5)
    base.drive(TELEOP, 0.0)
    with pytest.raises(WireError, match="/nav is not neutral"):
        base.stop_commands.handle("ann", RELEASE)
    base.drive(NAV, 0.0)
    base.ask_guard(**RELEASE)
    assert base.drive(NAV, 0.5)


def test_who_is_silent_stands_still(base):
    base.ask_guard(stop="test")
    base.drive(NAV, 0.5)
    base.pass_time(SECOND)
    base.ask_guard(**RELEASE)
    assert base.drive(NAV, 0.5)


def test_strangers_that_shout_do_not_keep_the_robot_stopped(base):
    base.ask_guard(stop="test")
    base.transport.publisher("/cmd_vel", Peer(STRANGER, TWIST))(twist(0.5))
    base.ask_guard(**RELEASE)
    assert base.drive(NAV, 0.5)


def test_after_a_stop_the_holder_of_a_lease_is_neutral_first(file):
    base = Stopped(PLAN, file)
    base.ask(NAV, "acquire")
    assert base.stand(NAV)
    assert base.drive(NAV, 0.5)
    base.ask_guard(stop="test")
    base.pass_time(SECOND)
    base.ask_guard(**RELEASE)
    assert not base.drive(NAV, 0.5)
    assert base.reason("nav").endswith("must send a neutral command first")
    assert base.stand(NAV)
    assert base.drive(NAV, 0.5)


def test_where_the_plan_says_so_a_second_person_releases_it_too(file):
    sources = StopSources(second_person=60 * SECOND)
    base = Stopped(replace(prioritised(PLAN), stop_sources=sources), file)
    base.ask_guard(stop="test")
    for again in ("ann agrees; a second person must", "ann has agreed already"):
        with pytest.raises(WireError, match=again):
            base.ask_guard(**RELEASE)
    assert not base.drive(NAV, 0.0)
    base.stop_commands.handle("root", RELEASE)
    assert base.drive(NAV, 0.5)


def test_until_a_button_is_heard_nothing_moves(with_button):
    assert not with_button.drive(NAV, 0.5)
    assert with_button.reason("nav") == "nothing is heard of the stop button red"
    with_button.press(FREE)
    assert with_button.drive(NAV, 0.5)


def test_a_pressed_button_stops_until_it_is_free_and_released(with_button):
    with_button.press(FREE)
    assert with_button.drive(NAV, 0.5)
    with_button.press(PRESSED)
    with_button.pass_time(SECOND)
    assert with_button.speeds()[-1] == 0.0
    with pytest.raises(WireError, match="the cause of the stop of red is still there: pressed"):
        with_button.ask_guard(release="red", reason="test")
    with_button.press(FREE)
    assert not with_button.drive(NAV, 0.5)
    with_button.drive(NAV, 0.0)
    with_button.ask_guard(release="red", reason="test")
    assert with_button.drive(NAV, 0.5)


def test_all_sources_must_have_released(with_button):
    with_button.press(PRESSED)
    with_button.ask_guard(stop="test")
    with_button.press(FREE)
    assert "still stopped by red" in with_button.ask_guard(**RELEASE)["answer"]
    assert not with_button.drive(NAV, 0.0)
    with_button.ask_guard(release="red", reason="test")
    assert with_button.drive(NAV, 0.5)


def test_a_button_that_is_gone_stops_until_it_is_back(with_button):
    with_button.press(FREE)
    assert with_button.drive(NAV, 0.5)
    with_button.lose_button()
    with_button.pass_time(SECOND)
    assert with_button.speeds()[-1] == 0.0
    assert not with_button.drive(NAV, 0.5)
    assert with_button.stops.stops == {}
    with_button.press(FREE)
    assert with_button.drive(NAV, 0.5)


def test_a_silent_button_stops_until_it_is_heard_again(file):
    button = replace(BUTTON, silent_after=SECOND)
    sources = StopSources(buttons=(button,))
    base = Stopped(replace(prioritised(PLAN), stop_sources=sources), file)
    for _ in range(4):
        base.press(FREE)
        assert base.drive(NAV, 0.5)
        base.pass_time(SECOND - 1)
    assert base.drive(NAV, 0.5)
    base.pass_time(1)
    assert not base.drive(NAV, 0.0)
    base.pass_time(60 * SECOND)
    base.press(FREE)
    assert base.drive(NAV, 0.5)
    base.pass_time(SECOND)
    assert not base.drive(NAV, 0.0)
    assert base.stops.stops == {}


@pytest.mark.parametrize("message", [b"", b"\1\0\0\0", b"\1\0\0\0\0\0", b"\2\0\0\0\0\0"])
def test_what_a_button_says_that_nobody_can_read_counts_as_pressed(with_button, message):
    with_button.press(FREE)
    with_button.press(message)
    assert "it says what nobody can read" in with_button.stops.stops["red"]["reason"]


def test_a_stranger_presses_no_button_and_frees_none(with_button, caplog):
    with_button.press(FREE, publisher=STRANGER)
    assert not with_button.drive(NAV, 0.0)
    assert "/stranger is ignored: it is not /estop_driver" in caplog.text
    claimed = Peer(BUTTON.publisher, BOOL, verified=False)
    with_button.transport.publisher(BUTTON.topic, claimed)(FREE)
    assert not with_button.drive(NAV, 0.0)
    with_button.press(FREE)
    with_button.press(PRESSED, publisher=STRANGER)
    assert with_button.drive(NAV, 0.5)


def test_the_next_guard_is_stopped_before_it_opens(base, tmp_path):
    base.ask_guard(stop="a person on the track")
    stops = json.loads(base.handed_over[-1])[STOPS]
    assert stops["robot"]["reason"] == "a person on the track"
    other = state_file(tmp_path / "elsewhere" / "stops.json")
    after = Stopped(prioritised(PLAN), other, base.handed_over[-1])
    assert not after.drive(NAV, 0.0)
    after.ask_guard(**RELEASE)
    assert after.drive(NAV, 0.5)
    assert STOPS not in json.loads(after.handed_over[-1])


def test_it_outlives_the_supervisor_and_the_machine(base, file, tmp_path):
    path = tmp_path / "app" / "stops.json"
    base.ask_guard(stop="a person on the track")
    wait_for(path.exists, what="the file")
    assert path.stat().st_mode & 0o077 == 0
    after = Stopped(prioritised(PLAN), state_file(path))
    assert not after.drive(NAV, 0.0)
    assert after.stops.stops["robot"]["by"] == "ann"
    after.ask_guard(**RELEASE)
    wait_for(lambda: not path.exists(), what="the file's end")
    assert Stopped(prioritised(PLAN), state_file(path)).drive(NAV, 0.5)


def test_a_stop_is_confirmed_when_the_disk_has_it(base, tmp_path, monkeypatch):
    synced, go_on, real = [], Event(), os.fsync

    def slow(descriptor):
        go_on.wait()
        synced.append(Path(f"/proc/self/fd/{descriptor}").readlink())
        real(descriptor)

    monkeypatch.setattr(os, "fsync", slow)
    answer = base.stop_commands.handle("ann", {"stop": "test"})
    assert not base.drive(NAV, 0.5)
    base.pass_time(SECOND // 2)
    assert not answer.done()
    go_on.set()
    assert base.wait_for_disk(answer)["answer"] == "stopped by ann: test"
    folder = tmp_path / "app"
    assert synced == [tmp_path, folder / "stops.json.new", folder]
    assert json.loads((folder / "stops.json").read_bytes())["robot"]["by"] == "ann"


def test_a_stop_that_the_disk_has_not_yet_says_so(base, monkeypatch):
    go_on = Event()
    monkeypatch.setattr(os, "fsync", lambda descriptor: go_on.wait())
    answer = base.stop_commands.handle("ann", {"stop": "test"})
    base.pass_time(2 * SECOND)
    go_on.set()
    slow = "; not yet kept for the time after a reboot: the disk is slow"
    assert answer.result(0)["answer"] == f"stopped by ann: test{slow}"
    assert not base.drive(NAV, 0.5)


def test_the_cause_of_a_button_counts_as_there_after_a_restart(with_button, tmp_path):
    with_button.press(PRESSED)
    plan = replace(prioritised(PLAN), stop_sources=StopSources(buttons=(BUTTON,)))
    other = state_file(tmp_path / "elsewhere" / "stops.json")
    after = Stopped(plan, other, with_button.handed_over[-1])
    with pytest.raises(WireError, match="is still there"):
        after.ask_guard(release="red", reason="test")
    after.press(FREE)
    after.ask_guard(release="red", reason="test")
    assert after.drive(NAV, 0.5)


@pytest.mark.parametrize("text", [b"", b"{", b"[]", b"\xff", b"[" * 100_000])
def test_a_file_that_cannot_be_read_stops_the_robot(text, tmp_path):
    path = tmp_path / "app" / "stops.json"
    path.parent.mkdir(mode=0o700)
    path.write_bytes(text)
    base = Stopped(prioritised(PLAN), state_file(path))
    assert not base.drive(NAV, 0.0)
    assert base.reason("nav").startswith("latched stop: file by the guard: ")
    base.ask_guard(release="file", reason="looked at it")
    wait_for(lambda: not path.exists(), what="the file's end")
    assert base.drive(NAV, 0.5)


def test_a_folder_that_others_may_enter_is_not_trusted(tmp_path, caplog):
    path = tmp_path / "app" / "stops.json"
    path.parent.mkdir()
    path.parent.chmod(0o777)
    base = Stopped(prioritised(PLAN), state_file(path))
    assert not base.drive(NAV, 0.0)
    assert "others may enter" in caplog.text
    told = base.ask_guard(stop="test")["answer"]
    assert "not yet kept for the time after a reboot: others may enter" in told
    wait_for(lambda: "is not kept for the time after a reboot" in caplog.text, what="the error")
    assert not path.exists()
    path.parent.chmod(0o700)
    wait_for(path.exists, what="the next try")
    assert set(json.loads(path.read_bytes())) == {"file", "robot"}


def test_each_master_has_a_file_of_its_own(monkeypatch, tmp_path):
    monkeypatch.setenv("XDG_STATE_HOME", str(tmp_path))
    one, other = (stop_file(PLAN, uri).path for uri in ("http://a:11311", "http://b:11311"))
    assert one != other
    assert one.parent == other.parent == tmp_path / "rtron" / "app" / "stops"


@pytest.mark.parametrize("host", ["127.0.0.1", "127.0.1.1", "[::1]", "LOCALHOST", None, "local"])
def test_a_master_on_this_machine_has_one_file_however_it_is_spelled(host):
    own = socket.gethostname()
    spelled = {None: own, "local": f"{own.partition('.')[0]}.local"}.get(host, host)
    one = stop_file(PLAN, "http://localhost:11311").path
    assert stop_file(PLAN, f"http://{spelled}:11311/").path == one
    assert one.name == "http___localhost_11311.json"
    assert stop_file(PLAN, f"http://{spelled}:11312/").path != one


def test_a_domain_has_a_file_of_its_own():
    assert [stop_file(PLAN, each).path.name for each in ("0", "1")] == ["0.json", "1.json"]


def test_where_nothing_is_enforced_a_stop_says_that_it_has_no_effect(file):
    nodes = tuple(replace(each, mode=Mode.OBSERVE) for each in prioritised(PLAN).grcn)
    base = Stopped(replace(prioritised(PLAN), grcn=nodes), file)
    with pytest.raises(WireError, match="there is nothing to stop"):
        base.ask_guard(stop="test")
