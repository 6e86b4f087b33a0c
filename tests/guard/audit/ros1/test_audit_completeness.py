"""When the audit of ROS 1 has looked at everything, and what it takes back; nodes are servers."""

import threading
import time
from contextlib import ExitStack, contextmanager
from types import SimpleNamespace
from xmlrpc.server import SimpleXMLRPCServer

import pytest
from plans import grcn, plan_of

from rtron.guard.audit.ros1 import auditor, intrusions, master_queries
from rtron.guard.audit.ros1.auditor import Ros1Auditor
from rtron.guard.audit.ros1.guard_nodes import GuardNodes
from rtron.guard.audit.ros1.live_verification import verify_live
from rtron.guard.core.event_loop import EventLoop
from rtron.vocabulary import SECOND, AlarmKind, Mode

OUT, DRIVER, GUARD, BULK = "/rtron/cmd_vel/out", "/driver", "/rtron/grcn_cmd_vel", "/rtron_bulk"
PLAN = plan_of(grcn("/cmd_vel", ["/nav"], [DRIVER]))
OURS, NEXT, OTHER = (f"http://127.0.0.1:{port}/" for port in (7, 8, 9))
HANGS = (
    "/driver cannot be audited: no answer within 1 s "
    "(end it or start it again; if its machine is gone, `rosnode cleanup`)"
)
LIMIT_S = 60
SOON_S = 1.5


class Node:
    """A master or a node: what it says can change, and it can hang."""

    def __init__(self):
        self.names, self.sources, self.subscribers = {}, [], [DRIVER]
        self.may_answer = threading.Event()
        self.may_answer.set()
        self.looks = 0
        self.uri = ""

    def _dispatch(self, method, params):
        self.may_answer.wait(LIMIT_S)
        return getattr(self, f"_{method}")(*params)

    def _getSystemState(self, _caller):  # noqa: N802 - ROS's name
        return [1, "", [[], [[OUT, self.subscribers]], []]]

    def _lookupNode(self, _caller, name):  # noqa: N802 - ROS's name
        self.looks += 1
        uri = self.names.get(name, "")
        return [1 if uri else -1, "", uri]

    def _getBusInfo(self, _caller):  # noqa: N802 - ROS's name
        rows = [[n, uri, "i", "TCPROS", OUT, True, ""] for n, uri in enumerate(self.sources)]
        return [1, "", rows]

    def _getPid(self, _caller):  # noqa: N802 - ROS's name
        return [1, "", 9]


@contextmanager
def running_node():
    node = Node()
    with SimpleXMLRPCServer(("127.0.0.1", 0), logRequests=False) as server:
        server.register_instance(node)
        thread = threading.Thread(target=server.serve_forever, args=(0.02,))
        thread.start()
        node.uri = f"http://127.0.0.1:{server.server_address[1]}/"
        yield node
        node.may_answer.set()
        server.shutdown()
        thread.join()


class Response:
    """Keeps what the audit says."""

    stops_streams, stopped_streams = False, frozenset()

    def __init__(self):
        self.alarms, self.settled, self.withdrawn = [], [], []
        self.find_missing = lambda: "never set"
        self.find_unseen = lambda since: {"": "never set"}

    def raise_(self, alarm, _now, *_guarded):
        self.alarms.append(alarm)

    def settle(self, alarm):
        self.alarms.remove(alarm)
        self.settled.append(alarm)

    def withdraw(self, alarm):
        self.alarms.remove(alarm)
        self.withdrawn.append(alarm)

    def on_new_listener(self, topic):
        """Do nothing."""


class Audit:
    """An auditor of one driver."""

    def __init__(self, stack, plan=PLAN):
        self.master, self.driver = (stack.enter_context(running_node()) for _ in range(2))
        self.loop, self.response = EventLoop(), Response()
        stack.callback(self.loop.close)
        self.uris, self.unknown = {GUARD: OURS}, frozenset()
        self.listeners = set()
        self.guard = SimpleNamespace(
            node_uris=lambda: dict(self.uris),
            ports=frozenset(),
            former_uris=frozenset,
            unknown_streams=lambda: self.unknown,
            subscribers=lambda _topic: self.listeners,
            set_shutdown_handler=lambda handler: None,
            set_listener_handlers=lambda on_new, on_lost: None,
            register_node=lambda name: None,
        )
        self.master.names = {DRIVER: self.driver.uri, GUARD: OURS}
        self.driver.sources = [OURS]
        self.auditor = Ros1Auditor(plan, self.master.uri, self.guard, self.response, self.loop)
        stack.callback(self.auditor.close)

    @property
    def missing(self):
        return self.response.find_missing()

    @property
    def gap(self):
        """Why the stream was not looked after within the last half second, "" if it was."""
        return self.response.find_unseen(self.loop.now() - SECOND // 2).get("/cmd_vel", "")

    def kinds(self):
        return [each.kind for each in self.response.alarms]

    def run(self, until, limit_s=LIMIT_S):
        end = time.monotonic() + limit_s
        while not until() and time.monotonic() < end:
            self.loop.step(0.02)
        return until()


@pytest.fixture
def stack():
    with ExitStack() as entered:
        yield entered


@pytest.fixture
def audit(stack):
    return Audit(stack)


def test_an_audit_is_complete_when_master_and_driver_have_answered(audit):
    assert audit.missing == "the master does not answer"
    audit.auditor.open()
    assert audit.run(lambda: not audit.missing)


def test_a_driver_that_hangs_is_waited_for_and_its_intruder_told_first(audit):
    audit.driver.sources = [OURS, OTHER]
    audit.driver.may_answer.clear()
    audit.auditor.open()
    assert not audit.run(lambda: not audit.missing, SOON_S)
    assert "/driver cannot be audited" in audit.missing
    audit.driver.may_answer.set()
    assert audit.run(lambda: AlarmKind.UNREGISTERED_PUBLISHER in audit.kinds() or not audit.missing)
    assert audit.run(lambda: not audit.missing)
    assert AlarmKind.UNREGISTERED_PUBLISHER in audit.kinds()


def test_a_master_that_hangs_is_waited_for(audit):
    audit.master.may_answer.clear()
    audit.auditor.open()
    assert not audit.run(lambda: not audit.missing, SOON_S)
    assert audit.missing == "the master does not answer"
    audit.master.may_answer.set()
    assert audit.run(lambda: not audit.missing)


def test_a_stream_is_looked_after_while_its_driver_answers(audit):
    audit.auditor.open()
    assert audit.gap == "the master has not answered"
    assert audit.run(lambda: not audit.gap)
    audit.driver.may_answer.clear()
    assert audit.run(lambda: audit.gap)
    assert audit.run(lambda: audit.gap == HANGS)
    audit.driver.may_answer.set()
    assert audit.run(lambda: not audit.gap)
    audit.unknown = frozenset({"/cmd_vel"})
    assert audit.gap == "the command process has not told its nodes"


def test_a_driver_whose_machine_is_gone_is_not_waited_for_when_the_master_forgets_it(audit):
    """`rosnode cleanup` takes a node that does not answer out of the master's list."""
    audit.driver.may_answer.clear()
    audit.auditor.open()
    assert audit.run(lambda: audit.gap == HANGS)
    audit.master.subscribers = []
    assert audit.run(lambda: not audit.gap)


def test_an_audit_that_asks_nobody_any_more_looks_after_nothing(audit):
    audit.auditor.open()
    assert audit.run(lambda: not audit.gap)
    audit.auditor._schedule.close()
    assert audit.run(lambda: audit.gap == "/driver cannot be audited: it is asked seldom")


def test_without_the_master_its_drivers_are_looked_after_and_it_is_told(audit, monkeypatch):
    monkeypatch.setattr(auditor, "_MASTER_DELAY", SECOND)
    audit.auditor.open()
    assert audit.run(lambda: not audit.gap)
    audit.master.may_answer.clear()
    assert audit.run(lambda: audit.kinds() == [AlarmKind.UNREACHABLE])
    assert audit.response.alarms[0].reason.startswith("the master does not answer: ")
    assert audit.run(lambda: not audit.gap)
    audit.master.may_answer.set()
    assert audit.run(lambda: not audit.response.alarms)


def test_a_driver_that_has_gone_is_not_waited_for(audit):
    audit.auditor.open()
    assert audit.run(lambda: not audit.gap)
    audit.master.subscribers = []
    audit.driver.may_answer.clear()
    assert audit.run(lambda: audit.auditor._state.subscribers == {})
    assert audit.run(lambda: not audit.gap)


def test_nodes_that_are_not_there_are_not_waited_for(audit):
    del audit.master.names[DRIVER]
    audit.master.subscribers = []
    audit.auditor.open()
    assert audit.run(lambda: not audit.missing)


def test_a_driver_that_hears_the_guard_is_there_although_nobody_lists_it(audit):
    del audit.master.names[DRIVER]
    audit.master.subscribers = []
    audit.listeners.add(DRIVER)
    audit.auditor.open()
    assert not audit.run(lambda: not audit.missing, SOON_S)
    audit.listeners.clear()
    assert audit.run(lambda: not audit.missing)


def test_the_audit_looks_again_when_the_guards_nodes_become_known(audit):
    audit.auditor.open()
    assert audit.run(lambda: not audit.missing)
    audit.unknown = frozenset({"/cmd_vel"})
    assert audit.missing == "the command process has not told its nodes"
    audit.unknown = frozenset()
    audit.auditor.look_again()
    assert audit.missing == "the master does not answer"
    assert audit.run(lambda: not audit.missing)


def test_who_is_excused_is_waited_for(audit, monkeypatch):
    """The address is one where nobody listens: it may be a dead guard's, and be told later."""
    monkeypatch.setattr(intrusions, "_EXCUSED", 3 * SECOND)
    monkeypatch.setattr(intrusions, "_PATIENCE_S", LIMIT_S)
    audit.driver.sources = [OURS, OTHER]
    audit.auditor.open()
    excuse = "it is not known yet who http://127.0.0.1:9 is"
    assert audit.run(lambda: audit.missing == excuse)
    assert audit.response.alarms == []
    audit.run(lambda: audit.missing != excuse)
    assert audit.kinds() == [AlarmKind.UNREGISTERED_PUBLISHER]
    assert audit.run(lambda: not audit.missing)


@pytest.mark.parametrize("reason", ["why", "new node registered with same name"])
def test_without_enforced_streams_nothing_is_missing_and_a_shutdown_is_just_refused(
    stack, caplog, reason
):
    observed = plan_of(grcn("/tf", ["/a"], ["/b"], mode=Mode.OBSERVE))
    audit = Audit(stack, observed)
    commands = SimpleNamespace()
    nodes = GuardNodes(audit.guard, commands)
    Ros1Auditor(observed, audit.master.uri, nodes, audit.response, audit.loop).open()
    assert audit.missing == ""
    commands.on_shutdown_request(GUARD, reason)
    assert caplog.messages == [f"{GUARD} is not shut down, end rtron guard itself: {reason}"]


@pytest.mark.parametrize(
    ("is_late", "said"),
    [(False, "another process has taken its name"), (True, "whether it is the guard's is not")],
)
def test_a_node_that_is_late_is_no_impostor_and_one_that_cannot_tell_its_parent_is(
    stack, is_late, said
):
    master, guard, node = (stack.enter_context(running_node()) for _ in range(3))
    master.names = {"/rtron_guard": guard.uri, GUARD: node.uri}
    guard._getParentPid = lambda _caller: [1, "", 5]
    if is_late:
        is_over = threading.Event()
        stack.callback(is_over.set)
        node._getParentPid = lambda _caller: is_over.wait(LIMIT_S)
    (problem,) = (p for p in verify_live(PLAN, master.uri, SOON_S).problems if GUARD in p)
    assert said in problem


@pytest.fixture
def other(stack):
    """Return the address of a node that takes a name."""
    return stack.enter_context(running_node()).uri


def take_name(audit, uri):
    audit.master.names[GUARD] = uri
    audit.auditor._guard_names.check()


def test_the_next_process_of_the_guard_is_no_impostor(audit, other):
    """The answer about the old nodes comes when the new ones are known."""
    names = audit.auditor._guard_names
    take_name(audit, other)
    audit.uris[GUARD] = other
    names.update()
    assert audit.run(lambda: names.is_checked)
    assert audit.response.alarms == audit.response.settled == []


def test_the_next_process_that_was_an_impostor_for_a_moment_was_a_mistake(audit, other):
    names = audit.auditor._guard_names
    take_name(audit, other)
    assert audit.run(lambda: audit.kinds() == [AlarmKind.IMPOSTOR])
    audit.uris[GUARD] = other
    names.update()
    assert [each.kind for each in audit.response.withdrawn] == [AlarmKind.IMPOSTOR]
    assert audit.run(lambda: names.is_checked)
    assert audit.response.settled == []
    assert not names.has_takeover


def test_a_master_that_does_not_answer_gives_no_name_back(audit, other, monkeypatch):
    names = audit.auditor._guard_names
    take_name(audit, other)
    assert audit.run(lambda: audit.kinds() == [AlarmKind.IMPOSTOR])
    monkeypatch.setattr(master_queries, "_CALL_S", 0.1)
    audit.master.may_answer.clear()
    names.check()
    assert audit.run(lambda: not names.is_checked)
    assert audit.kinds() == [AlarmKind.IMPOSTOR]
    audit.master.names[GUARD] = OURS
    audit.master.may_answer.set()
    names.check()
    assert audit.run(lambda: names.is_checked)
    assert audit.response.alarms == []


def test_a_name_that_is_not_ours_at_the_moment_is_neither_told_nor_settled(audit, other):
    names = audit.auditor._guard_names
    audit.uris[BULK] = NEXT
    take_name(audit, other)
    del audit.uris[GUARD]
    assert audit.run(lambda: names.is_checked)
    assert audit.response.alarms == []
    audit.uris[GUARD] = OURS
    names.update()
    assert audit.run(lambda: audit.kinds() == [AlarmKind.IMPOSTOR])
    del audit.uris[GUARD]
    names.update()
    assert audit.run(lambda: names.is_checked)
    assert audit.kinds() == [AlarmKind.IMPOSTOR]
    audit.uris[GUARD], audit.master.names[GUARD] = OURS, OURS
    names.update()
    assert audit.run(lambda: not audit.response.alarms)
    assert [each.kind for each in audit.response.settled] == [AlarmKind.IMPOSTOR]
