"""Who may take a name or an address, asked of real slave APIs."""

import socket
import threading
from contextlib import ExitStack, contextmanager

import pytest
from harness import LIMIT_S, free_port, wait_for
from masters import Master, Slave, running_proxy, serving
from plans import grcn, plan_of

from rtron.guard.master_proxy import name_registry
from rtron.vocabulary.topic_access import list_topic_access
from rtron.wire.ros1.xmlrpc import call

TOPICS = list_topic_access(plan_of(grcn("/cmd_vel", ["/nav", "/teleop_*"], ["/driver"])))
GUARD = "/rtron/grcn_cmd_vel"
NEVER_S = 3600.0
IPV4_HOSTS = ["127.0.0.1", "localhost", "127.0.0.2", "0.0.0.0"]
HOSTS = [*IPV4_HOSTS, "[::1]", "[::ffff:127.0.0.1]", "localhost.", "no.such.invalid"]


@pytest.fixture
def stack():
    with ExitStack() as entered:
        yield entered


@pytest.fixture
def master():
    return Master()


@pytest.fixture
def register(stack, master):
    """Return what registers a name at an address: whether the proxy lets it."""
    public = stack.enter_context(running_proxy(TOPICS, stack.enter_context(serving(master))))

    def ask(name, uri):
        answer = call(public, "registerSubscriber", name, "/chatter", "*", uri, timeout=LIMIT_S)
        return answer[0] == 1

    return ask


@contextmanager
def hanging():
    """Listen on a port and never answer."""
    with socket.create_server(("127.0.0.1", 0)) as server:
        yield f"http://127.0.0.1:{server.getsockname()[1]}/"


def closed():
    return f"http://127.0.0.1:{free_port()}/"


@pytest.mark.parametrize("name", ["/nav", "/driver", "/teleop_7", "/rosout"])
def test_a_living_node_of_the_plan_keeps_its_name(stack, register, name):
    first, second = (stack.enter_context(serving(Slave(pid))) for pid in (1, 2))
    assert register(name, first)
    assert not register(name, second)
    assert register(name, first)


def test_another_node_does_not(stack, register):
    for pid in (1, 2, 3):
        assert register("/rosbag", stack.enter_context(serving(Slave(pid))))
    assert register("/rosbag", closed())


def test_nodes_that_one_pattern_means_are_different_nodes(stack, register):
    for number in range(1, 4):
        assert register(f"/teleop_{number}", stack.enter_context(serving(Slave(number))))


def test_a_node_that_is_gone_can_be_started_again(stack, register):
    with serving(Slave(1)) as uri:
        assert register("/nav", uri)
    assert register("/nav", stack.enter_context(serving(Slave(2))))


def test_a_node_whose_port_another_process_has_now_is_gone(stack, register):
    slave = Slave(1)
    reused = stack.enter_context(serving(slave))
    assert register("/nav", reused)
    slave.pid = 7
    assert register("/nav", stack.enter_context(serving(Slave(2))))
    assert register("/driver", reused)


def test_a_node_of_this_machine_that_hangs_is_not_gone(stack, register):
    slave = Slave(1)
    with serving(slave) as uri:
        assert register("/nav", uri)
    port = int(uri.rstrip("/").rpartition(":")[2])
    stack.enter_context(socket.create_server(("127.0.0.1", port)))
    assert not register("/nav", stack.enter_context(serving(Slave(2))))


def test_a_node_of_the_plan_must_answer_at_its_address(stack, register):
    assert not register("/nav", closed())
    assert not register("/nav", stack.enter_context(hanging()))
    for pid in ("no pid", 0, -1):
        assert not register("/nav", stack.enter_context(serving(Slave(pid))))
    assert register("/nav", stack.enter_context(serving(Slave(1))))


@pytest.mark.parametrize("host", HOSTS)
def test_the_address_of_a_planned_node_is_no_others(stack, register, host):
    uri = stack.enter_context(serving(Slave(1)))
    assert register("/driver", uri)
    port = uri.rstrip("/").rpartition(":")[2]
    for path in ("", "/", "/RPC2"):
        assert not register("/thief", f"http://{host}:{port}{path}")
        assert not register("/nav", f"http://{host}:{port}{path}")


def test_the_same_port_of_another_machine_is_another_address(stack, register):
    uri = stack.enter_context(serving(Slave(1)))
    assert register("/driver", uri)
    port = uri.rstrip("/").rpartition(":")[2]
    assert register("/elsewhere", f"http://192.0.2.1:{port}/")


def test_the_address_of_the_guard_is_no_others(stack, register, master):
    uri = master.lookups[GUARD] = stack.enter_context(serving(Slave(1)))
    wait_for(lambda: not register("/thief", uri), what="the proxy to know the guard's address")


@pytest.mark.parametrize("node", ["/rtron_guard", "/rtron_supervisor"])
def test_the_address_of_a_restarted_guard_is_no_others(stack, register, master, node):
    for pid in (1, 2):
        uri = master.lookups[node] = stack.enter_context(serving(Slave(pid)))
        wait_for(lambda uri=uri: not register("/thief", uri), what="the proxy to know the address")


def test_names_of_a_pattern_are_bounded_and_those_of_the_plan_are_not(stack, register, monkeypatch):
    monkeypatch.setattr(name_registry, "_MAX_REGISTRATIONS", 2)
    uris = [stack.enter_context(serving(Slave(pid))) for pid in range(1, 6)]
    assert [register(f"/teleop_{n}", uris[n]) for n in range(3)] == [True, True, False]
    assert register("/teleop_0", uris[0])
    assert register("/nav", uris[3])
    assert register("/driver", uris[4])


def test_a_node_registers_many_topics_at_once(stack, register):
    uri = stack.enter_context(serving(Slave(1)))
    answers = []
    asks = [
        threading.Thread(target=lambda: answers.append(register("/nav", uri))) for _ in range(40)
    ]
    for ask in asks:
        ask.start()
    for ask in asks:
        ask.join()
    assert answers == [True] * 40


def test_of_two_that_take_a_name_at_once_one_gets_it(stack, register):
    answers = []
    asks = [
        threading.Thread(target=lambda at=at: answers.append(register("/nav", at)))
        for at in [stack.enter_context(serving(Slave(pid))) for pid in range(1, 11)]
    ]
    for ask in asks:
        ask.start()
    for ask in asks:
        ask.join()
    assert sorted(answers) == [False] * 9 + [True]


def test_hanging_addresses_delay_no_other_node(stack, register, monkeypatch):
    """They hang until all others have registered, however long that takes."""
    monkeypatch.setattr(name_registry, "_REGISTRATION_TIMEOUT_S", NEVER_S)
    with ExitStack() as hung:
        asks = [
            threading.Thread(target=register, args=("/nav", hung.enter_context(hanging())))
            for _ in range(8)
        ]
        for ask in asks:
            ask.start()
        for pid in range(1, 6):
            assert register(f"/teleop_{pid}", stack.enter_context(serving(Slave(pid))))
        assert all(ask.is_alive() for ask in asks)
    for ask in asks:
        ask.join()
