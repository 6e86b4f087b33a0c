"""When a stranger is told, and when its silence is excused: the loop and the sockets are real."""

import socket
import threading
import time
from contextlib import ExitStack, contextmanager
from functools import partial
from types import SimpleNamespace
from xmlrpc.server import SimpleXMLRPCServer

import pytest
from harness import free_port
from plans import grcn, plan_of

from rtron.guard.audit.common.alarm_response import AlarmResponse
from rtron.guard.audit.ros1 import intrusions, master_queries
from rtron.guard.audit.ros1.audited_nodes import AuditedNodes
from rtron.guard.audit.ros1.expected_graph import ExpectedGraph
from rtron.guard.audit.ros1.foreign_connections import normalise_uri
from rtron.guard.audit.ros1.intrusions import Intrusions
from rtron.guard.audit.ros1.poll_schedule import PollSchedule
from rtron.guard.core.alarms import Alarms
from rtron.guard.core.event_loop import EventLoop
from rtron.guard.core.handover_state import HandoverState
from rtron.guard.intrusion_latch import IntrusionLatch
from rtron.vocabulary import SECOND, SUPERVISOR_NODE, Alarm, AlarmKind, OnForeign
from rtron.wire.ros1.xmlrpc import encode_response

OUT, DRIVER = "/rtron/cmd_vel/out", "/driver"
EXPECTED = ExpectedGraph(plan_of(grcn("/cmd_vel", ["/nav"], [DRIVER])))
LIMIT_S = 60
NEVER_S = 600
UPDATE = "publisherUpdate"
GHOST = Alarm(kind=AlarmKind.UNREGISTERED_PUBLISHER, reason="a ghost")


class EmptyMaster:
    """Knows of nobody."""

    def _dispatch(self, method, _params):
        return [1, "", [[], [], []]] if method == "getSystemState" else [-1, "unknown", ""]


@contextmanager
def empty_master():
    with SimpleXMLRPCServer(("127.0.0.1", 0), logRequests=False) as server:
        server.register_instance(EmptyMaster())
        thread = threading.Thread(target=server.serve_forever, args=(0.02,))
        thread.start()
        yield f"http://127.0.0.1:{server.server_address[1]}/"
        server.shutdown()
        thread.join()


@contextmanager
def recorded_calls():
    """Serve as a node; yield its address and the methods that it was called with."""
    calls = []
    with SimpleXMLRPCServer(("127.0.0.1", 0), logRequests=False) as server:
        server.register_function(lambda *params: calls.append(params) or [1, "", 0], UPDATE)
        thread = threading.Thread(target=server.serve_forever, args=(0.02,))
        thread.start()
        yield f"http://127.0.0.1:{server.server_address[1]}/", calls
        server.shutdown()
        thread.join()


@contextmanager
def hanging_master():
    with socket.create_server(("127.0.0.1", 0)) as server:
        yield f"http://127.0.0.1:{server.getsockname()[1]}/"


def closed():
    """Return an address where nobody listens."""
    return f"http://127.0.0.1:{free_port()}/"


class AuditedDriver:
    """The driver, whose answers the tests give; `alarms` are those that stand."""

    def __init__(self, master, stack, on_foreign=OnForeign.ALARM, expected=EXPECTED):
        self._loop = EventLoop()
        self.listeners, self.guard_uris, self.unknown = set(), {}, frozenset()
        stack.callback(self._loop.close)
        intrusions = IntrusionLatch(HandoverState())
        host = SimpleNamespace(alarms=Alarms(), streams=[], intrusions=intrusions)
        transport = SimpleNamespace(
            node_uris=lambda: self.guard_uris,
            ports=frozenset(),
            former_uris=frozenset,
            unknown_streams=lambda: self.unknown,
            now=self._loop.now,
            subscribers=lambda _topic: self.listeners,
        )
        nodes = AuditedNodes(self._loop, master, expected, PollSchedule(self._loop, SECOND))
        self.response = AlarmResponse(host, transport, on_foreign, dry_run=False)
        intruders = Intrusions(self._loop, master, transport, expected, nodes, self.response, {})
        self.look_again, self.unidentified = intruders.update_all, intruders.unidentified
        self.learn_publisher = intruders.learn_publisher
        self.keep_listener = partial(intruders.keep_listener, DRIVER, OUT)
        self.calls_back = lambda: bool(intruders._lost_at)
        nodes.on_change = intruders.update
        nodes.watch([DRIVER])
        self._nodes, self._alarms = nodes, host.alarms
        for part in (nodes, intruders):
            stack.callback(part.close)

    @property
    def alarms(self):
        return self._alarms.active

    @property
    def node(self):
        return self._nodes.by_name[DRIVER]

    def answer(self, *sources, topic=OUT):
        """Let the driver answer that it hears these; wait until that was read."""
        rows = [[n, uri, "i", "TCPROS", topic, True, ""] for n, uri in enumerate(sources)]
        body = encode_response([1, "", rows])
        self.node.poll_target.on_response(body)
        assert self.run(lambda: self.node.last_body == body)

    def is_told(self):
        return self.run(lambda: self._alarms.active)

    def run(self, until):
        """Turn the loop until something holds; return it, or what is false at the end."""
        end = time.monotonic() + LIMIT_S

        def look():
            if until() or time.monotonic() > end:
                self._loop.stop()
            else:
                self._loop.call_later(0.005, look)

        self._loop.post(look)
        self._loop.run()
        return until()


@pytest.fixture
def stack():
    with ExitStack() as entered:
        yield entered


@pytest.fixture
def examined(monkeypatch):
    """Return the addresses that the audit has found out about so far."""
    sources = []

    def identify(master, topic, source, names):
        found = master_queries.identify_peer(master, topic, source, names)
        sources.append(normalise_uri(source))
        return found

    monkeypatch.setattr(intrusions, "identify_peer", identify)
    return sources


@pytest.fixture
def audited(stack, monkeypatch):
    """Audit with a master that is waited for, however slow the machine is."""
    monkeypatch.setattr(intrusions, "_PATIENCE_S", NEVER_S)
    monkeypatch.setattr(intrusions, "_EXCUSED", NEVER_S * SECOND)
    return AuditedDriver(stack.enter_context(empty_master()), stack)


def test_an_alarm_does_not_wait_for_a_master_that_hangs(stack, monkeypatch):
    monkeypatch.setattr(master_queries, "_CALL_S", NEVER_S)
    audited = AuditedDriver(stack.enter_context(hanging_master()), stack)
    audited.answer()
    audited.answer(closed())
    assert audited.is_told()


@pytest.mark.parametrize(("topic", "is_told"), [("/rtron/cmd_vel/flow2", False), (OUT, True)])
def test_a_node_that_hears_itself_is_known_before_the_master_says_who_it_is(
    stack, monkeypatch, topic, is_told
):
    monkeypatch.setattr(master_queries, "_CALL_S", NEVER_S)
    expected = ExpectedGraph(plan_of(grcn("/cmd_vel", ["/nav", DRIVER], [DRIVER])))
    master = stack.enter_context(hanging_master())
    audited = AuditedDriver(master, stack, expected=expected)
    own = stack.enter_context(hanging_master())
    audited.node.poll_target.server = master_queries.resolve_uri(own)
    audited.answer()
    audited.answer(own, topic=topic)
    marker = closed()
    audited.answer(own, marker, topic=topic)
    peers = {marker.rstrip("/"), own.rstrip("/")} if is_told else {marker.rstrip("/")}
    assert audited.run(lambda: len(audited.alarms) == len(peers))
    assert {each.peer for each in audited.alarms} == peers


def test_a_dead_address_that_was_there_before_the_guard_is_excused(audited, examined):
    dead = closed()
    audited.answer(dead)
    assert audited.run(lambda: len(examined) >= 4)
    assert audited.alarms == ()
    assert audited.unidentified() == dead.rstrip("/"), "the audit is not complete meanwhile"


def test_who_is_told_is_not_waited_for(stack, audited):
    audited.answer(stack.enter_context(hanging_master()))
    assert audited.unidentified()
    assert audited.is_told()
    assert audited.unidentified() == ""


def test_a_dead_address_that_appears_after_the_first_answer_is_not(audited):
    audited.answer()
    audited.answer(closed())
    assert audited.is_told()


def test_what_was_there_first_is_excused_also_when_it_comes_back(audited, examined):
    dead = closed()
    for sources in ([dead], [], [dead]):
        audited.answer(*sources)
    known = len(examined)
    assert audited.run(lambda: len(examined) >= known + 4)
    assert audited.alarms == ()


def test_a_living_stranger_is_not_excused_although_it_was_there_first(stack, audited):
    audited.answer(stack.enter_context(hanging_master()))
    assert audited.is_told()


def test_a_node_that_has_moved_answers_for_the_first_time_again(audited, examined):
    audited.answer()
    audited.node.reset_address()
    audited.answer(closed())
    assert audited.run(lambda: len(examined) >= 4)
    assert audited.alarms == ()


def test_while_the_guards_nodes_are_unknown_who_was_found_stays_and_nobody_new_is_judged(
    stack, audited, examined
):
    found, new = (stack.enter_context(hanging_master()) for _ in range(2))
    audited.answer()
    audited.answer(found)
    assert audited.run(lambda: len(audited.alarms) == 1)
    audited.unknown = frozenset({"/cmd_vel"})
    audited.answer(found, new)
    known = len(examined)
    assert audited.run(lambda: len(examined) >= known + 2)
    assert set(examined) == {found.rstrip("/")}
    assert [each.peer for each in audited.alarms] == [found.rstrip("/")]
    audited.unknown = frozenset()
    audited.look_again()
    assert audited.run(lambda: len(audited.alarms) == 2)
    audited.unknown = frozenset({"/cmd_vel"})
    audited.answer(new)
    assert audited.run(lambda: len(audited.alarms) == 1)


@pytest.mark.parametrize(("limit", "is_stopped"), [(NEVER_S * SECOND, False), (0, True)])
def test_a_planned_name_excuses_a_stranger_only_where_it_may_have_been_a_mistake(
    stack, monkeypatch, limit, is_stopped
):
    monkeypatch.setattr(intrusions, "_MISTAKE_LIMIT", limit)
    audited = AuditedDriver(stack.enter_context(empty_master()), stack, OnForeign.STOP)
    ghost = stack.enter_context(hanging_master())
    audited.answer()
    audited.answer(ghost)
    assert audited.run(lambda: audited.response.stopped_streams)
    audited.learn_publisher(SUPERVISOR_NODE, normalise_uri(ghost))
    assert audited.run(lambda: not [e for e in audited.alarms if e.kind != AlarmKind.INTRUSION])
    assert bool(audited.response.stopped_streams) is is_stopped


@pytest.fixture
def stopped(stack, monkeypatch):
    """Audit a driver whose stream an intruder has stopped, and record the calls to the driver."""
    audited = AuditedDriver(stack.enter_context(empty_master()), stack, OnForeign.STOP)
    monkeypatch.setattr(intrusions, "_KEEP_DURATION", NEVER_S * SECOND)
    uri, audited.calls = stack.enter_context(recorded_calls())
    audited.node.poll_target.server = master_queries.resolve_uri(uri)
    audited.response.raise_(GHOST, 0, "/cmd_vel")
    audited.response.settle(GHOST)
    return audited


def test_a_driver_that_leaves_is_called_back_until_it_hears_the_guard(stopped):
    stopped.keep_listener()
    assert stopped.run(lambda: len(stopped.calls) > 3)
    assert stopped.calls[0] == ("/rtron_guard", OUT, [])
    stopped.guard_uris["/rtron/grcn_cmd_vel"] = ours = "http://127.0.0.1:7/"
    stopped.answer(ours)
    assert stopped.run(lambda: not stopped.calls_back())


def test_a_driver_is_called_back_although_somebody_listens_under_its_name(stopped):
    stopped.keep_listener()
    stopped.listeners.add(DRIVER)
    stopped.answer("http://127.0.0.1:9/")
    assert stopped.run(lambda: len(stopped.calls) > 20)


def test_a_driver_that_never_hears_the_guard_is_given_up(stopped, monkeypatch):
    monkeypatch.setattr(intrusions, "_KEEP_DURATION", SECOND)
    began = time.monotonic()
    stopped.keep_listener()
    assert stopped.run(lambda: not stopped.calls_back())
    assert time.monotonic() - began >= 1


def test_a_driver_that_leaves_is_called_a_bounded_number_of_times(stopped):
    began = time.monotonic()
    for _ in range(100):
        stopped.keep_listener()
    assert stopped.run(lambda: len(stopped.calls) > 10)
    assert len(stopped.calls) <= 1 + (time.monotonic() - began) / 0.01


def test_a_driver_that_leaves_while_nothing_is_stopped_is_left_alone(stopped):
    refusals = []
    stopped.response._clear("/cmd_vel", refusals.append)
    assert refusals == [""]
    stopped.keep_listener()
    assert not stopped.calls_back()
    assert stopped.calls == []
