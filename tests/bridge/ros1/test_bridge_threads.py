"""Calls of clients take a bounded number of threads, whoever comes again and does not wait."""

import socket
import threading

import pytest
from bridge_parts import plan, types
from harness import wait_for

from rtron.bridge.protocol.effects import ParameterVerb, RequestParameter
from rtron.bridge.rights.document import ClientRights, Limits
from rtron.bridge.ros1.node import Ros1NodeFactory
from rtron.errors import RTronError
from rtron.guard.core.event_loop import EventLoop

CALLS = 4
TOKENS = ("sha256:" + "a" * 64,)
LIMITS = Limits(calls=CALLS, call_timeout=1.0)


class Answers:
    """A listener of a node that keeps the answers."""

    def __init__(self):
        self.answers = []

    def on_answer(self, number, answer):
        self.answers.append(answer)


@pytest.fixture
def silent_master():
    """The address of a master that takes connections and says nothing."""
    with socket.socket() as sock:
        sock.bind(("127.0.0.1", 0))
        sock.listen(1000)
        yield f"http://127.0.0.1:{sock.getsockname()[1]}"


@pytest.fixture
def loop():
    running = EventLoop()
    yield running
    running.close()


def call_threads():
    return sum(each.name.startswith("/bridge/") for each in threading.enumerate())


def ask(factory, name):
    """Open a node that reads as many parameters at a time as it may."""
    listener = Answers()
    node = factory.open(ClientRights(name=name, tokens=TOKENS, limits=LIMITS), listener)
    for number in range(CALLS):
        node.access_parameter(RequestParameter(number, ParameterVerb.GET, "/speed"))
    return node, listener


@pytest.mark.parametrize(("clients", "share"), [(3, CALLS), (100, 1), (1000, 1)])
def test_the_threads_of_all_clients_are_bounded(silent_master, loop, clients, share):
    wait_for(lambda: not call_threads(), what="the end of the threads of other tests")
    factory = Ros1NodeFactory(loop, silent_master, types(plan()), clients)
    opened = [ask(factory, f"c{number}") for number in range(3)]
    assert call_threads() == 3 * share
    for node, _ in opened:
        node.close()
        ask(factory, "c0")[0].close()
    assert call_threads() == 3 * share
    factory.close()


def test_a_call_that_waits_in_vain_for_a_thread_has_an_answer(silent_master, loop):
    factory = Ros1NodeFactory(loop, silent_master, types(plan()), 100)
    node, listener = ask(factory, "c0")
    wait_for(lambda: loop.step(0.01) or len(listener.answers) == CALLS, what="the answers")
    assert all(isinstance(each, RTronError) for each in listener.answers)
    assert "had to wait too long" in str(listener.answers[-1])
    node.close()
    factory.close()
