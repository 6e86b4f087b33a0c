"""The connection between guard and supervisor, when one of them leaves or the system fails."""

import os
import signal
import socket
from pathlib import Path

import pytest

from rtron.guard.core.coordinator import Host
from rtron.guard.core.event_loop import Loop
from rtron.guard.supervision.guard_config import Order
from rtron.guard.supervision.guard_process import spawn
from rtron.guard.supervision.shared_memory import Field, Page
from rtron.guard.supervision.supervisor_client import ALONE, Tie
from rtron.guard.supervision.supervisor_handover import LEAVE, Answer, Door, bound
from rtron.guard.transport.common.memory import MemoryTransport
from rtron.vocabulary import SECOND, Plan

NO_FILE = 1 << 14


@pytest.fixture
def loop():
    made = Loop()
    yield made
    made.close()


@pytest.fixture
def master(tmp_path):
    return f"http://localhost/{tmp_path}"


class Tied:
    """A guard that moves nothing, tied to a supervisor; another one cannot be started."""

    def __init__(self, loop, master):
        self.loop = loop
        self.page = Page.new(0)
        self.page[Field.OWNER] = os.getpid()
        self.supervisor, self.life = socket.socketpair()
        order = Order(plan=Plan(app="none", ros=1), master=master)
        self.tie = Tie(order, self.page, self.life, NO_FILE)
        self.tie.open(loop, Host(MemoryTransport(), ()))

    def give_another(self):
        """Let another supervisor take over."""
        self.supervisor.close()
        self.supervisor, self.life = socket.socketpair()
        self.tie._taken(self.life)

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
    made = Tied(loop, master)
    yield made
    made.close()


def test_a_caller_that_leaves_before_the_answer_leaves_no_descriptor_behind(loop, master):
    sock = bound(master)
    door = Door(loop, sock, lambda digest: (Answer.SUPERVISED, -1), lambda life: None)
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


def test_a_supervisor_takes_the_place_of_one_that_has_just_died(tied):
    tied.give_another()
    tied.run(SECOND // 20)
    tied.supervisor.settimeout(0)
    with pytest.raises(BlockingIOError):
        tied.supervisor.recv(1)


def test_a_supervisor_is_told_that_another_takes_its_place(tied):
    with tied.supervisor.dup() as former:
        tied.give_another()
        assert former.recv(len(LEAVE)) == LEAVE


def test_a_guard_beats_and_tries_again_when_no_supervisor_can_be_started(tied, caplog):
    tied.supervisor.close()
    tied.run(2 * ALONE + SECOND // 2)
    assert caplog.text.count("no supervisor can be started") == 2
    beat = tied.page[Field.GUARD_BEAT]
    tied.run(SECOND // 10)
    assert tied.page[Field.GUARD_BEAT] > beat


def open_files():
    return sorted(Path("/proc/self/fd").iterdir())


def test_a_guard_that_cannot_be_started_leaves_nothing_behind():
    before, files = signal.pthread_sigmask(signal.SIG_BLOCK, ()), open_files()
    with pytest.raises(OSError):
        spawn(NO_FILE, 1)
    assert signal.pthread_sigmask(signal.SIG_BLOCK, ()) == before
    assert open_files() == files
