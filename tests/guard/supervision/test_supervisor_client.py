"""The connection between guard and supervisor, when one of them leaves or the system fails."""

import os
import signal
import socket
from contextlib import ExitStack
from functools import partial
from pathlib import Path

import pytest
from harness import wait_for

from rtron.errors import SourceError
from rtron.guard.coordinator import Coordinator
from rtron.guard.core.event_loop import EventLoop
from rtron.guard.supervision import guard_name
from rtron.guard.supervision.guard_config import GuardConfig
from rtron.guard.supervision.guard_name import GUARD, answer_name, await_former_guard, take_name
from rtron.guard.supervision.guard_process import spawn_guard
from rtron.guard.supervision.shared_memory import GuardMemory, StatusWord
from rtron.guard.supervision.supervisor_client import HANG_TIMEOUT, SupervisorClient
from rtron.guard.transport.common.memory import MemoryTransport
from rtron.vocabulary import SECOND, Plan

NO_FILE = 1 << 14
PATIENCE_S = 20


@pytest.fixture
def loop():
    made = EventLoop()
    yield made
    made.close()


@pytest.fixture
def master(tmp_path):
    return f"http://localhost/{tmp_path}"


class ConnectedGuard:
    """A guard that moves nothing, tied to a supervisor."""

    def __init__(self, loop, master):
        self.loop = loop
        self.page = GuardMemory.create(0)
        self.supervisor, self.life = socket.socketpair()
        order = GuardConfig(plan=Plan(app="none", ros=1), master=master)
        self.tie = SupervisorClient(order, self.page, self.life, self.life)
        self.tie.attach(loop, Coordinator(MemoryTransport(), ()))
        self.tie.open()

    def run(self, duration):
        until = self.loop.now() + duration
        while self.loop.now() < until:
            self.loop.step(0.01)

    def close(self):
        self.tie.close()
        for sock in (self.supervisor, self.life, self.tie._name):
            sock.close()


@pytest.fixture
def tied(loop, master):
    made = ConnectedGuard(loop, master)
    yield made
    made.close()


def test_a_supervisor_tells_its_participant(tied):
    assert tied.tie.supervisor_participant() == b""
    tied.page.supervisor_participant.write(b"first")
    assert tied.tie.supervisor_participant() == b"first"


@pytest.fixture
def impatient(monkeypatch):
    monkeypatch.setattr(guard_name, "_PAUSE_S", 0.001)


def address(master):
    return guard_name._address(GUARD, master)


def test_who_has_the_guards_address_and_does_not_listen_keeps_no_guard_from_its_work(
    master, impatient
):
    with socket.socket(socket.AF_UNIX) as stranger:
        stranger.bind(address(master))
        assert take_name(GUARD, master) is None
    take_name(GUARD, master).close()


@pytest.mark.parametrize("waiting", [0, 1])
def test_a_guard_that_is_there_is_not_replaced_however_many_wait_for_it(master, impatient, waiting):
    with socket.socket(socket.AF_UNIX) as guard, ExitStack() as callers:
        guard.bind(address(master))
        guard.listen(0)
        for _ in range(waiting):
            callers.enter_context(socket.socket(socket.AF_UNIX)).connect(address(master))
        with pytest.raises(SourceError, match="a guard is running on"):
            take_name(GUARD, master)


def test_who_asks_for_a_name_leaves_no_connection_behind(loop, master, impatient):
    with take_name(GUARD, master) as name:
        name.listen(0)
        answer_name(loop, name)
        for _ in range(4):
            assert guard_name._holder(GUARD, master) == (os.getpid(), os.getuid())
            loop.step(0)


def test_a_guard_whose_supervisor_is_gone_ends(loop, tied):
    loop.call_later(PATIENCE_S, pytest.fail)
    tied.supervisor.close()
    loop.run()


@pytest.fixture
def killed(monkeypatch):
    """Take the signals that the guard sends: the supervisor is this very process."""
    sent = []

    def kill(pid, number):
        if number:
            sent.append((pid, number))

    monkeypatch.setattr("os.kill", kill)
    return sent


def test_a_supervisor_that_stands_still_is_killed_and_the_guard_ends(loop, tied, killed):
    loop.call_later(PATIENCE_S, pytest.fail)
    tied.page[StatusWord.SUPERVISOR_BEAT] = 1
    begun = loop.now()
    loop.run()
    assert killed == [(os.getpid(), signal.SIGKILL)]
    assert loop.now() - begun >= HANG_TIMEOUT


def open_files():
    return sorted(Path("/proc/self/fd").iterdir())


class Exhausted:
    """A fork server on a machine that has no process left."""

    def start(self, program, files):
        raise BlockingIOError


def test_a_guard_that_cannot_be_started_leaves_nothing_behind():
    before, files = signal.pthread_sigmask(signal.SIG_BLOCK, ()), open_files()
    with socket.socket() as port, pytest.raises(OSError):
        spawn_guard(Exhausted(), NO_FILE, port, 1)
    assert signal.pthread_sigmask(signal.SIG_BLOCK, ()) == before
    assert open_files() == files


def test_a_delivery_that_nobody_watches_is_an_alarm_with_what_to_do(loop, tied):
    def alarms():
        return [alarm.reason for alarm in tied.tie._host.alarms.active]

    tied.page[StatusWord.UNWATCHED] = 1
    wait_for(lambda: loop.step(0.01) or alarms(), what="the alarm")
    (reason,) = alarms()
    assert "nobody knows whether it delivers" in reason
    assert "start rtron guard again" in reason
    tied.page[StatusWord.UNWATCHED] = 0
    wait_for(lambda: loop.step(0.01) or not alarms(), what="its end")


@pytest.fixture
def elsewhere(master, impatient, monkeypatch):
    """Have a guard run that is in another PID namespace: the kernel calls it 0."""
    with take_name(GUARD, master):
        monkeypatch.setattr(guard_name, "peer_credentials", lambda _: (0, os.getuid()))
        yield


@pytest.mark.usefixtures("elsewhere")
def test_a_guard_that_we_cannot_see_is_refused_and_not_signalled(master, killed, monkeypatch):
    """A signal to 0 is one to ourselves."""
    monkeypatch.setattr(guard_name, "END_TIMEOUT", 0)
    for take in (partial(take_name, GUARD), partial(await_former_guard, ramp=0)):
        with pytest.raises(SourceError, match="in another container"):
            take(master)
    assert killed == []


def test_a_guard_that_has_lost_its_supervisor_and_does_not_end_is_killed(
    master, impatient, monkeypatch
):
    name = take_name(GUARD, master)
    sent = []

    def kill(pid, number):
        sent.append((pid, number))
        name.close()

    monkeypatch.setattr("os.kill", kill)
    monkeypatch.setattr(guard_name, "END_TIMEOUT", SECOND // 20)
    await_former_guard(master, 0)
    assert sent == [(os.getpid(), signal.SIGKILL)]


def test_nobody_is_waited_for_where_no_guard_runs(master):
    await_former_guard(master, 0)
