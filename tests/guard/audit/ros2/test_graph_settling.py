"""When the audit of ROS 2 has looked at everything; the domain is made by hand."""

from types import SimpleNamespace

import pytest
from domain_scene import DRIVER_SUBSCRIBES, GUARD, NAV_PUBLISHES, OUT, ROGUE, base_plan, publisher

pytest.importorskip("rclpy", reason="needs ROS 2")
from rtron.guard.audit.ros2 import auditor as auditor_module
from rtron.guard.audit.ros2.auditor import Ros2Auditor
from rtron.guard.middleware import Ros2Middleware
from rtron.vocabulary import GUARD_NODE, SECOND, SUPERVISOR_NODE, AlarmKind, Direction, Mode

pytestmark = pytest.mark.ros2
OWN = b"\x02" * 12
"""The bulk process's own participant; its form tells no process, so no process is looked for."""
SUPERVISOR = b"\x03" * 12
UNKNOWN = "the command process has not told its nodes"
CHANGED = "the graph has changed"


class Domain:
    """A graph, and an auditor that looks at it as a bulk process's does."""

    def __init__(self):
        self.now, self.unknown, self.alarms = 0, frozenset(), []
        self.ends = [NAV_PUBLISHES, DRIVER_SUBSCRIBES]
        graph = SimpleNamespace(
            participant=OWN,
            ended=frozenset(),
            listeners=[],
            is_current=True,
            watch=lambda topic: None,
            endpoints=self._endpoints,
            is_own=lambda gid: False,
        )
        self.graph = graph
        session = SimpleNamespace(node=lambda name: None)
        self.supervisor = b""
        transport = SimpleNamespace(
            graph=graph,
            processes=None,
            session=session,
            supervisor_participant=lambda: self.supervisor,
        )
        self.response = SimpleNamespace(
            raise_=lambda alarm, now, *streams: self.alarms.append(alarm),
            settle=self.alarms.remove,
            listen=lambda request: None,
            on_new_listener=lambda topic: None,
        )
        self.commands = SimpleNamespace(
            participants=lambda: frozenset({GUARD}),
            unknown_streams=lambda: self.unknown,
            on_change=lambda: None,
        )
        loop = SimpleNamespace(now=lambda: self.now)
        middleware = Ros2Middleware(base_plan(), transport, loop)
        self.auditor = middleware.create_auditor(self.response, self.commands)
        self.auditor.open()

    def _endpoints(self, topic):
        ends = [each for each in self.ends if each.topic == topic]
        sides = ([e for e in ends if e.direction is side] for side in Direction)
        found = dict(zip(Direction, sides, strict=True))
        return SimpleNamespace(
            publishers=found[Direction.PUBLISH], subscribers=found[Direction.SUBSCRIBE]
        )

    @property
    def missing(self):
        return self.response.find_missing()

    @property
    def gap(self):
        """Why the stream was not looked after within the last second, "" if it was."""
        return self.response.find_unseen(self.now - SECOND).get("/cmd_vel", "")

    def pass_time(self, duration_s):
        """Look at the graph twice a second."""
        for _ in range(int(duration_s * 2)):
            self.now += SECOND // 2
            for listener in self.graph.listeners:
                listener()


@pytest.fixture
def domain(monkeypatch):
    reader = SimpleNamespace(endpoints=lambda topics: ())
    monkeypatch.setattr(auditor_module, "GraphReader", lambda node: reader)
    return Domain()


def test_a_graph_that_stays_the_same_is_known(domain):
    assert domain.missing == "it has not begun"
    domain.pass_time(5)
    assert CHANGED in domain.missing
    domain.pass_time(3)
    assert domain.missing == ""


def test_a_graph_that_changes_is_not(domain):
    domain.pass_time(5)
    domain.ends.remove(NAV_PUBLISHES)
    domain.pass_time(5)
    assert CHANGED in domain.missing
    domain.pass_time(3)
    assert domain.missing == ""


def test_a_stream_is_looked_after_at_each_look_at_a_domain_that_is_known(domain):
    domain.pass_time(3)
    assert domain.gap == "the audit has just joined the domain"
    domain.pass_time(1)
    assert domain.gap == ""
    domain.ends.remove(NAV_PUBLISHES)
    domain.pass_time(1)
    assert domain.gap == "", "a graph that changes is looked at, too"
    domain.unknown = frozenset({"/cmd_vel"})
    assert domain.gap == UNKNOWN
    domain.unknown = frozenset()
    domain.now += SECOND
    assert domain.gap == "the graph does not answer"
    domain.pass_time(1)
    assert domain.gap == ""


def test_a_graph_that_does_not_answer_is_not_looked_at(domain):
    domain.pass_time(5)
    assert domain.gap == ""
    domain.graph.is_current = False
    domain.pass_time(1)
    assert domain.gap == "the graph does not answer"
    domain.graph.is_current = True
    domain.pass_time(1)
    assert domain.gap == ""


def test_a_look_that_fails_is_none(domain, monkeypatch):
    def fail(*_):
        raise ValueError

    domain.pass_time(5)
    monkeypatch.setattr(auditor_module, "drift_alarms", fail)
    for _ in range(2):
        with pytest.raises(ValueError):
            domain.pass_time(0.5)
    assert domain.gap == "the graph does not answer"


def test_another_look_at_what_was_known_is_none(domain):
    domain.pass_time(5)
    domain.now += SECOND
    domain.commands.on_change()
    assert domain.gap == "the graph does not answer"


def test_who_waits_for_its_name_is_told_before_the_graph_is_known(domain):
    domain.ends.append(publisher("/rtron/cmd_vel/flow1", "", ROGUE))
    while domain.missing:
        domain.pass_time(0.5)
    assert AlarmKind.UNREGISTERED_PUBLISHER in [each.kind for each in domain.alarms]


def test_an_intruder_is_judged_at_once_when_the_command_process_has_told_its_nodes(domain):
    domain.pass_time(8)
    assert domain.missing == ""
    domain.unknown = frozenset({"/cmd_vel"})
    assert domain.missing == UNKNOWN
    domain.ends.append(publisher(OUT, "/rogue", ROGUE))
    domain.pass_time(8)
    assert domain.missing == UNKNOWN
    assert domain.alarms == []
    domain.unknown = frozenset()
    assert domain.missing == UNKNOWN, "no look yet"
    domain.commands.on_change()
    assert [each.kind for each in domain.alarms] == [AlarmKind.FOREIGN_PUBLISHER]
    assert domain.missing == ""


def test_the_supervisor_is_who_the_guard_says_it_is_also_when_the_guard_is_gone(domain):
    domain.ends.append(publisher(OUT, SUPERVISOR_NODE, SUPERVISOR))
    domain.supervisor = SUPERVISOR
    domain.pass_time(8)
    domain.supervisor = b""
    domain.pass_time(8)
    assert domain.alarms == []


@pytest.mark.parametrize("name", ["", SUPERVISOR_NODE, GUARD_NODE])
def test_nobody_else_is_it_whatever_name_and_process_it_claims(domain, name):
    """Fast DDS makes a GID of a process id, which anybody can write there."""
    domain.supervisor = SUPERVISOR
    domain.pass_time(4)
    twin = SUPERVISOR[:-1] + b"\7"
    domain.ends.append(publisher(OUT, name, twin))
    domain.pass_time(8)
    assert domain.alarms


def test_a_plan_that_enforces_nothing_has_nothing_to_look_at(domain):
    plan = base_plan(mode=Mode.OBSERVE)
    transport, loop = domain.auditor._transport, domain.auditor._loop
    observing = Ros2Auditor(plan, transport, domain.response, loop, domain.commands)
    observing.open()
    observing.look_again()
    assert domain.missing == ""
