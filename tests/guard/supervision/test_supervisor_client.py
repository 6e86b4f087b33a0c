"""The connection between guard and supervisor, when one of them leaves or the system fails."""

import os
import signal
import socket
from contextlib import ExitStack
from pathlib import Path

import pytest
from harness import wait_for

from rtron.guard.coordinator import Coordinator
from rtron.guard.core.event_loop import EventLoop
from rtron.guard.supervision import supervisor_handover
from rtron.guard.supervision.guard_config import GuardConfig
from rtron.guard.supervision.guard_process import spawn_guard
from rtron.guard.supervision.shared_memory import GuardMemory, StatusWord
from rtron.guard.supervision.supervisor_client import (
    SUPERVISOR_HANG_TIMEOUT,
    UNSUPERVISED_LIMIT,
    SupervisorClient,
)
from rtron.guard.supervision.supervisor_handover import (
    HAND_OVER_MESSAGE,
    WATCHING_MESSAGE,
    GuardExistsError,
    HandoverAnswer,
    HandoverSocket,
    bind_guard_socket,
    guard_address,
    request_handover,
)
from rtron.guard.transport.common.memory import MemoryTransport
from rtron.guard.transport.common.protocol import SupervisorId
from rtron.vocabulary import SECOND, Plan, Supervision

NO_FILE = 1 << 14
BOUNDS = Supervision()


@pytest.fixture
def loop():
    made = EventLoop()
    yield made
    made.close()


@pytest.fixture
def master(tmp_path):
    return f"http://localhost/{tmp_path}"


class ConnectedGuard:
    """A guard that moves nothing, tied to a supervisor; another one cannot be started."""

    def __init__(self, loop, master, bounds=BOUNDS):
        self.loop = loop
        self.page = GuardMemory.create(0)
        self.page[StatusWord.OWNER] = os.getpid()
        self.supervisor, self.life = socket.socketpair()
        order = GuardConfig(plan=Plan(app="none", ros=1, supervision=bounds), master=master)
        self.tie = SupervisorClient(order, self.page, self.life, NO_FILE)
        self.tie.attach(loop, Coordinator(MemoryTransport(), ()))
        self.tie.open()

    def give_another(self):
        """Let another supervisor take over."""
        self.supervisor.close()
        self.supervisor, self.life = socket.socketpair()
        self.tie._on_accept(self.life)

    def received(self):
        """Return what the supervisor was told."""
        self.supervisor.settimeout(0)
        try:
            return self.supervisor.recv(100)
        except BlockingIOError:
            return b""

    def run(self, duration):
        until = self.loop.now() + duration
        while self.loop.now() < until:
            self.loop.step(0.01)

    def close(self):
        self.tie.close()
        for sock in (self.supervisor, self.life):
            sock.close()


@pytest.fixture
def tied(loop, master):
    made = ConnectedGuard(loop, master)
    yield made
    made.close()


def test_a_supervisor_is_identified_once_it_has_told_its_participant(tied):
    changes = []
    tied.tie.on_change = lambda: changes.append(tied.tie.identify_supervisor())
    ours = os.getpid()
    assert tied.tie.identify_supervisor() == SupervisorId(ours)
    tied.page.supervisor_participant.write(b"first")
    assert tied.tie.identify_supervisor() == SupervisorId(ours, frozenset({b"first"}))
    tied.supervisor.close()
    tied.run(SECOND // 20)
    assert changes == [SupervisorId()]
    tied.give_another()
    assert changes[1:] == [SupervisorId(ours)]
    tied.page.supervisor_participant.write(b"second")
    both = frozenset({b"first", b"second"})
    assert tied.tie.identify_supervisor() == SupervisorId(ours, both)


def test_a_caller_that_leaves_before_the_answer_leaves_no_descriptor_behind(loop, master):
    sock = bind_guard_socket(master)
    door = HandoverSocket(
        loop, sock, lambda digest: (HandoverAnswer.SUPERVISED, -1), lambda life: None
    )
    with socket.socket(socket.AF_UNIX) as caller:
        caller.connect(sock.getsockname())
    for _ in range(3):
        loop.step(0.1)
    pairs = [socket.socketpair() for _ in range(4)]
    for each in sum(pairs, ()):
        loop.watch(each, lambda: None, lambda error: None)
    for each in sum(pairs, ()):
        loop.forget(each)
        assert each.fileno() == -1
    door.close()


@pytest.fixture
def impatient(monkeypatch):
    monkeypatch.setattr(supervisor_handover, "_RETRY_S", 0.001)


def test_who_has_the_guards_address_and_does_not_listen_keeps_no_guard_from_its_work(
    master, impatient
):
    with socket.socket(socket.AF_UNIX) as stranger:
        stranger.bind(guard_address(master))
        assert bind_guard_socket(master) is None
    bind_guard_socket(master).close()


@pytest.mark.parametrize("waiting", [0, 1])
def test_a_guard_that_is_there_is_not_replaced_however_many_wait_for_it(master, impatient, waiting):
    with socket.socket(socket.AF_UNIX) as guard, ExitStack() as callers:
        guard.bind(guard_address(master))
        guard.listen(0)
        for _ in range(waiting):
            callers.enter_context(socket.socket(socket.AF_UNIX)).connect(guard_address(master))
        with pytest.raises(GuardExistsError):
            bind_guard_socket(master)


def test_a_supervisor_takes_the_place_of_one_that_has_just_died(tied):
    tied.give_another()
    tied.run(SECOND // 20)
    tied.supervisor.settimeout(0)
    with pytest.raises(BlockingIOError):
        tied.supervisor.recv(1)


def test_a_supervisor_is_told_that_another_takes_its_place(tied):
    with tied.supervisor.dup() as former:
        tied.give_another()
        assert former.recv(len(HAND_OVER_MESSAGE)) == HAND_OVER_MESSAGE


def test_a_guard_beats_and_tries_again_when_no_supervisor_can_be_started(tied, caplog):
    tied.supervisor.close()
    tied.run(2 * UNSUPERVISED_LIMIT + SECOND // 2)
    assert caplog.text.count("no supervisor can be started") == 2
    beat = tied.page[StatusWord.GUARD_BEAT]
    tied.run(SECOND // 10)
    assert tied.page[StatusWord.GUARD_BEAT] > beat


@pytest.fixture
def killed(monkeypatch):
    """Take the signals that the guard sends: the supervisor is this very process."""
    sent = []

    def kill(pid, number):
        if number:
            sent.append((pid, number))

    monkeypatch.setattr("os.kill", kill)
    return sent


def test_a_supervisor_that_starts_has_more_time_than_one_that_watches(tied, killed):
    tied.give_another()
    tied.page[StatusWord.SUPERVISOR_BEAT] = 1  # of the one before, which has not ended yet
    tied.run(SUPERVISOR_HANG_TIMEOUT + SECOND // 2)
    assert tied.received() == b""
    tied.supervisor.send(WATCHING_MESSAGE)
    wait_for(lambda: tied.run(SECOND // 10) or tied.received(), what="the dismissal")
    assert killed == []


def test_a_supervisor_that_does_not_leave_when_it_is_dismissed_is_killed(loop, master, killed):
    guard = ConnectedGuard(loop, master, Supervision(start_within=SECOND // 5))
    guard.give_another()
    wait_for(lambda: guard.run(SECOND // 10) or guard.received(), what="the dismissal")
    assert killed == []
    wait_for(lambda: guard.run(SECOND // 10) or killed, what="the end")
    assert set(killed) == {(os.getpid(), signal.SIGKILL)}
    assert guard.received() == b""
    guard.close()


def open_files():
    return sorted(Path("/proc/self/fd").iterdir())


def test_a_guard_that_cannot_be_started_leaves_nothing_behind():
    before, files = signal.pthread_sigmask(signal.SIG_BLOCK, ()), open_files()
    with pytest.raises(OSError):
        spawn_guard(NO_FILE, 1)
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


def test_a_supervisor_that_is_gone_says_nothing_of_delivery(loop, tied):
    tied.page[StatusWord.UNWATCHED] = 1
    tied.supervisor.close()
    wait_for(
        lambda: loop.step(0.01) or not tied.tie.identify_supervisor().process,
        what="the end of the supervisor",
    )
    tied.run(SECOND // 10)
    assert all("delivers" not in alarm.reason for alarm in tied.tie._host.alarms.active)


def test_a_guard_in_another_pid_namespace_is_neither_adopted_nor_signalled(master, monkeypatch):
    """The kernel calls it 0, and a signal to 0 is one to ourselves."""
    listener = bind_guard_socket(master)
    monkeypatch.setattr(supervisor_handover, "peer_credentials", lambda _: (0, os.getuid()))
    assert request_handover(master, "digest") is None
    with pytest.raises(GuardExistsError, match="in another container"):
        bind_guard_socket(master)
    listener.close()
