"""What the command process reports of its ROS 1 nodes while strangers flood it."""

import socket
from contextlib import ExitStack
from types import SimpleNamespace

import pytest
from plans import grcn, plan_of

from rtron.guard.core.event_loop import EventLoop
from rtron.guard.lanes.command.node_reports import MAX_PER_PERIOD, MAX_TEXT, NodeReports
from rtron.guard.lanes.exchange.audit_exchange import NodesReport
from rtron.guard.middleware import Ros1Middleware
from rtron.guard.transport.ros1.middleware import Ros1Transport
from rtron.wire.ros1.tcpros import encode_header

NODE, OUT = "/rtron/grcn_cmd_vel", "/rtron/cmd_vel/out"
PLAN = plan_of(grcn("/cmd_vel", ["/nav"], ["/driver"]))
TWIST, MD5 = "geometry_msgs/Twist", "9f195f881246fdfa2798d1d3eebca84a"
NO_MASTER = "http://127.0.0.1:1"


class Scene:
    """The nodes of a command process, and what it sends to the audit."""

    def __init__(self, stack):
        self.loop, self.sent, self._stack = EventLoop(), [], stack
        stack.callback(self.loop.close)
        self.transport = Ros1Transport(self.loop, NO_MASTER, "127.0.0.1")
        stack.callback(self.transport.close)
        self.output = self.transport.advertise(NODE, OUT, TWIST)
        connection = SimpleNamespace(
            send=self.sent.append,
            call=lambda *call: self.sent.append(call),
            on=lambda register_node: None,
            connect_listeners=[],
            is_connected=True,
            former_participants=frozenset,
        )
        supervisor = SimpleNamespace(supervisor_participant=bytes)
        middleware = Ros1Middleware(PLAN, self.transport, self.loop)
        self.reports = NodeReports(connection, middleware, self.loop, supervisor)
        self.reports.open()

    def connect(self, *names):
        """Let nodes subscribe; wait until the guard has answered all."""
        headers = [{"callerid": n, "topic": OUT, "type": TWIST, "md5sum": MD5} for n in names]
        sockets = [self._connect(encode_header(header)) for header in headers]
        end = self.loop.now() + 20 * 10**9
        waiting = set(sockets)
        while waiting:
            assert self.loop.now() < end
            self.loop.step(0.01)
            waiting = {each for each in waiting if not _is_readable(each)}
        return sockets

    def report(self):
        self.reports._report_anew()
        return self.sent[-1][1]

    def _connect(self, header):
        sock = socket.create_connection(("127.0.0.1", self.transport.port), 20)
        self._stack.callback(sock.close)
        sock.settimeout(0)
        self.loop.step(0.01)
        sent = sock.send(header[: 1 << 16])
        while sent < len(header):
            self.loop.step(0.01)
            sent += sock.send(header[sent : sent + (1 << 16)])
        return sock

    def listener_messages(self):
        return [each for each in self.sent if "subscribed" in each[0]]


def _is_readable(sock):
    try:
        sock.recv(1, socket.MSG_PEEK)
    except BlockingIOError:
        return False
    except OSError:
        return True
    return True


@pytest.fixture
def scene():
    with ExitStack() as stack:
        yield Scene(stack)


def test_six_subscribers_with_huge_names_do_not_make_a_huge_report(scene):
    scene.connect(*(f"/{number}" + "x" * 900_000 for number in range(6)))
    report = scene.report()
    assert isinstance(report, NodesReport)
    assert len(str(report)) < 10_000
    assert report.subscribers == {}
    assert scene.listener_messages() == []


def test_strangers_do_not_hide_the_driver(scene):
    scene.connect(*(f"/stranger_{number}" for number in range(300)), "/driver")
    assert scene.report().subscribers == {OUT: {"/driver"}}
    assert scene.listener_messages() == [("subscribed", OUT, "/driver")]


def test_a_stranger_with_the_name_of_the_driver_that_comes_and_goes_is_told_now_and_then(scene):
    for _ in range(5 * MAX_PER_PERIOD):
        scene.transport.on_subscriber(OUT, "/driver")
        scene.transport.on_subscriber_lost(OUT, "/driver")
    assert set(scene.listener_messages()) == {
        ("subscribed", OUT, "/driver"),
        ("unsubscribed", OUT, "/driver"),
    }
    assert len(scene.listener_messages()) < MAX_PER_PERIOD


def test_a_request_to_shut_down_is_cut_short(scene):
    scene.transport._nodes[NODE].dispatch("shutdown", ("/x" * 9999, "y" * 99_999))
    scene.loop.step(0.01)
    ((node, reason),) = [each[1:] for each in scene.sent if each[0] == "shutdown_request"]
    assert node == NODE
    assert len(reason) <= MAX_TEXT
    assert "asked for it: yyy" in reason
