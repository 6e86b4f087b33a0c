"""The guard as a process on a real master, among peers that break the rules."""

import signal
import socket
import struct

import pytest
from harness import Ros1, wait_for
from raw_ros1 import LIMIT_S, RawPublisher, RawSubscriber, tcpros_port, twist

from rtron.errors import RTronError
from rtron.wire.ros1.tcpros import encode_header
from rtron.wire.ros1.xmlrpc import ros_call

pytestmark = pytest.mark.ros1

NODE, OUT = "/rtron/grcn_cmd_vel", "/rtron/cmd_vel/out"
NAV, FLOW2 = "/rtron/cmd_vel/flow1", "/rtron/cmd_vel/flow2"
PLAN = """\
schema: rtron.plan/1
app: robustness
ros: 1
audit: {on_foreign: alarm}  # the master does not know these peers, so nobody can look after them
grcn:
  - id: grcn_cmd_vel
    topic: /cmd_vel
    type: geometry_msgs/Twist
    domain: Control
    kind: command
    sharing: contend
    mode: enforce
    policy: Preemption
    successors: [/driver]
    flows:
      - {name: flow1, publisher: /nav, priority: 2, on_silence: release}
      - {name: flow2, publisher: /teleop, priority: 1, on_silence: release}
"""
HOSTILE = {
    "half open": b"",
    "an absurd header": struct.pack("<I", 0xFFFFFFFF),
    "a header that is none": struct.pack("<I", 8) + struct.pack("<I", 4) + b"abcd",
    "a field longer than its header": struct.pack("<II", 8, 99) + b"abcd",
    "no md5sum": encode_header({"callerid": "/x", "topic": OUT}),
    "another topic": encode_header({"callerid": "/x", "topic": "/no", "md5sum": "*"}),
    "another md5sum and type": encode_header({"topic": OUT, "md5sum": "x", "type": "a/B"}),
    "a huge name": encode_header({"callerid": "x" * 900_000, "topic": OUT, "md5sum": "*"}),
    "noise": bytes(range(256)) * 8,
}


class Guarded:
    """A guard process of the test, on the test's master."""

    def __init__(self, ros1):
        self.master = ros1.uri
        plan = ros1.folder / "rtron.yaml"
        plan.write_text(PLAN)
        self.process = ros1.rtron("guard", "--plan", plan)
        wait_for(self.published, what="the guard's registration")
        self._pid = self.pid

    @property
    def pid(self):
        return ros_call(self.uri, "getPid", "/test", timeout=LIMIT_S)

    @property
    def is_the_same(self):
        """Tell whether the guard lives, and is not another one that the supervisor has started."""
        return self.pid == self._pid

    @property
    def uri(self):
        return ros_call(self.master, "lookupNode", "/test", NODE, timeout=LIMIT_S)

    def published(self):
        try:
            state = ros_call(self.master, "getSystemState", "/test", timeout=LIMIT_S)
        except RTronError:
            return []
        return [topic for topic, nodes in state[0] if NODE in nodes and topic == OUT]

    def subscribe(self):
        subscriber = RawSubscriber(tcpros_port(self.uri, OUT))
        subscriber.subscribe(OUT, callerid="/driver")
        return subscriber

    def nav(self, **header):
        return RawPublisher(self.master, "/nav", NAV, **header)


@pytest.fixture
def guard(ros1):
    return Guarded(ros1)


@pytest.fixture(scope="module")
def attacked_guard(tmp_path_factory):
    """One guard for all attacks that are to leave it as it was."""
    with Ros1(tmp_path_factory.mktemp("attacked")) as ros1:
        yield Guarded(ros1)


def heard(publisher, subscriber, number):
    """Publish a velocity; return what the subscriber hears next."""
    wait_for(lambda: publisher.connections, what="the guard's connection")
    publisher.send(twist(number))
    return subscriber.frame()


@pytest.mark.parametrize("attack", HOSTILE)
def test_a_hostile_subscriber_harms_nobody(attacked_guard, attack):
    guard = attacked_guard
    port = tcpros_port(guard.uri, OUT)
    with socket.create_connection(("localhost", port)) as hostile:
        hostile.sendall(HOSTILE[attack])
        with guard.subscribe() as driver, guard.nav() as nav:
            assert heard(nav, driver, 1) == twist(1)
    assert guard.is_the_same


def test_a_hostile_slave_call_is_answered_or_closed_and_harms_nobody(attacked_guard):
    guard = attacked_guard
    port = int(guard.uri.rstrip("/").rpartition(":")[2])
    for data in (
        b"\xff\r\n\r\n" * 99,
        b"POST / HTTP/1.1\r\nHost: x\r\nContent-Length: 9\r\n\r\n<a>&bomb;",
    ):
        with socket.create_connection(("localhost", port), LIMIT_S) as hostile:
            hostile.sendall(data)
            assert hostile.recv(100) == b""
    for method, arguments in (("noSuch", ()), ("requestTopic", (1,)), ("getBusInfo", ())):
        with pytest.raises(RTronError):
            ros_call(guard.uri, method, *arguments, timeout=LIMIT_S)
    assert guard.is_the_same


@pytest.mark.parametrize(
    ("header", "data"),
    [
        ({"type": "std_msgs/String", "md5sum": "0"}, b""),
        ({"callerid": "/teleop"}, twist(666)),
        ({"callerid": "/nobody"}, twist(666)),
        ({"error": "go away"}, twist(666)),
        ({"md5sum": "*"}, twist(666)),
        ({}, struct.pack("<I", 0xFFFFFFFF) + bytes(100)),
    ],
)
def test_a_publisher_that_lies_is_not_let_through(attacked_guard, header, data):
    guard = attacked_guard
    liar = RawPublisher(guard.master, "/liar", NAV, **header)
    with guard.subscribe() as driver, liar:
        wait_for(lambda: liar.connections, what="the guard's connection")
        liar.connections[-1].sendall(data)
        with guard.nav() as nav:
            assert heard(nav, driver, 1) == twist(1)
    assert guard.is_the_same


@pytest.mark.long
def test_a_publisher_that_comes_back_is_heard_again_but_not_with_another_type(guard):
    with guard.subscribe() as driver:
        for number in range(3):
            with guard.nav() as nav:
                assert heard(nav, driver, number) == twist(number)
        with guard.nav(type="std_msgs/String", md5sum="0") as changed:
            wait_for(lambda: changed.connections, what="the guard's connection")
            changed.connections[-1].sendall(twist(666))
        with guard.nav() as nav:
            assert heard(nav, driver, 9) == twist(9)


def test_a_broken_connection_is_made_again(guard):
    with guard.subscribe() as driver, guard.nav() as nav:
        assert heard(nav, driver, 1) == twist(1)
        nav.connections.pop().close()
        assert heard(nav, driver, 2) == twist(2)


def test_what_was_said_before_the_driver_came_waits_a_moment_for_it(guard):
    with guard.nav() as nav:
        wait_for(lambda: nav.connections, what="the guard's connection")
        nav.send(twist(0) + twist(1))
        with guard.subscribe() as driver:
            assert [driver.frame(), driver.frame()] == [twist(0), twist(1)]


@pytest.mark.long
def test_a_subscriber_that_does_not_read_delays_nobody(guard):
    with guard.subscribe(), guard.subscribe() as driver, guard.nav() as nav:
        wait_for(lambda: nav.connections, what="the guard's connection")
        count, batch = 200_000, 50
        for first in range(0, count, batch):
            nav.send(b"".join(twist(first + n) for n in range(batch)))
            for number in range(first, first + batch):
                assert driver.frame() == twist(number)


def test_a_restarted_master_learns_of_the_guard_again(ros1, guard):
    with guard.subscribe() as driver, guard.nav() as nav:
        assert heard(nav, driver, 1) == twist(1)
        ros1.master.kill()
        nav.send(twist(2))
        assert driver.frame() == twist(2)
        ros1.start_master()
        wait_for(guard.published, what="the guard's registration at the new master")
        nav.send(twist(3))
        assert driver.frame() == twist(3)


@pytest.mark.long
@pytest.mark.parametrize("number", [signal.SIGTERM, signal.SIGINT])
def test_the_guard_takes_back_its_registrations(ros1, guard, number):
    guard.process.tell(number)
    wait_for(lambda: guard.process.ended, what="the guard's end")
    state = ros_call(ros1.uri, "getSystemState", "/test", timeout=LIMIT_S)
    assert [node for kind in state for _, nodes in kind for node in nodes] == []
    assert "Traceback" not in guard.process.log


def test_the_type_is_the_drivers_not_the_first_publishers(guard):
    wrong = {"md5sum": "0" * 32}
    with guard.subscribe() as driver, RawPublisher(guard.master, "/teleop", FLOW2, **wrong) as liar:
        wait_for(lambda: liar.connections, what="the guard's connection")
        liar.connections[-1].sendall(twist(666))
        with guard.nav() as nav:
            assert heard(nav, driver, 1) == twist(1)


class Liar(RawPublisher):
    """A publisher that names a host that is none while it lies, from its first answer on."""

    lies = True

    def _request_topic(self, *_):
        truth = super()._request_topic()
        return [1, "", ["TCPROS", f"{'x' * 70}.example", 1]] if self.lies else truth


@pytest.mark.long
def test_a_publisher_with_a_host_that_is_none_is_tried_again(guard):
    with Liar(guard.master, "/nav", NAV) as liar:
        wait_for(lambda: "a host that is none" in guard.process.log, what="the guard's word")
        liar.lies = False
        with guard.subscribe() as driver:
            assert heard(liar, driver, 1) == twist(1)
    assert "Traceback" not in guard.process.log
