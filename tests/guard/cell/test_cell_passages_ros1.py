"""What passes between a cell and the app is what the manifest lists, and the rest is refused."""

import socket
from contextlib import ExitStack
from dataclasses import replace
from urllib.parse import urlsplit
from urllib.request import Request, urlopen

import pytest
from celled_base import OUT, celled_plan, needs_cell, ros1_in_open_folder, start_cell
from driven_base import CMD_VEL_GUARD, start_guard
from harness import NODES, ROS_PYTHON, wait_for
from raw_ros1 import LIMIT_S
from rostopic import TopicEcho, say

from rtron.planning.plan_file.writer import write_plan
from rtron.wire.ros1.tcpros import encode_header
from rtron.wire.ros1.xmlrpc import ros_call

pytestmark = [pytest.mark.ros1, needs_cell]
NODE = "/base"
PASSES = {
    "published": [
        {"topic": "/odom", "type": "std_msgs/Float64", "publishers": [NODE]},
        {"topic": "/state", "type": "std_msgs/Float64", "publishers": [NODE]},
    ],
    "subscribed": [{"topic": "/lamp", "type": "std_msgs/String", "publishers": ["/switch"]}],
    "served": [{"service": "/reset", "type": "roscpp/GetLoggers", "clients": ["/nav"]}],
    "called": [{"service": "/map_of", "type": "roscpp/GetLoggers", "clients": [NODE]}],
    "parameters": [NODE],
}


class CarriedBase:
    def __init__(self, ros1):
        self.ros1 = ros1
        self.path = ros1.folder / "base.txt"
        ros1.run("rosparam", "set", f"{NODE}/wheel", "5")
        ros1.run("rosparam", "set", "/other", "6")
        ros1.node("loggers_server.py", "/maps", "/map_of", "house")
        plan = celled_plan()
        successors = tuple(replace(each, successors=(NODE,)) for each in plan.grcn)
        self.guard = start_guard(ros1, replace(plan, grcn=successors, cell=(NODE,)), CMD_VEL_GUARD)
        node = (ROS_PYTHON, NODES / "base_in_cell.py", self.path, "__name:=base")
        self.cell = start_cell(ros1, (*node, f"/cmd_vel:={OUT}"), node=NODE, **PASSES)
        wait_for(lambda: "param" in self.text, what="the base")

    @property
    def text(self):
        return self.path.read_text() if self.path.exists() else ""

    def refuses(self, what):
        wait_for(lambda: f"{what} is refused" in self.cell.log, what=f"the refusal of {what}")


@pytest.fixture(scope="module")
def carried():
    with ros1_in_open_folder() as ros1:
        yield CarriedBase(ros1)


def test_topics_of_the_base_come_out_under_its_name(carried):
    odom = TopicEcho(carried.ros1, "odom_echo", "/odom")
    rows = odom.wait_for(lambda rows: len(rows) >= 10, what="odometry")
    numbers = [number for (number,) in rows]
    assert numbers == [numbers[0] + n for n in range(len(numbers))]
    assert carried.ros1.publishers("/odom") == {NODE}


def test_a_latched_topic_is_latched_outside(carried):
    for name in ("late_echo", "later_echo"):
        state = TopicEcho(carried.ros1, name, "/state")
        assert state.wait_for(len, what="the state") == [[7.0]]


def test_a_topic_that_is_not_listed_stays_inside_and_is_told(carried):
    carried.refuses("/unlisted")
    assert "/unlisted" not in carried.ros1.state()[0]


def test_only_the_listed_publisher_reaches_the_base(carried):
    say(carried.ros1, "stranger", "/lamp", "std_msgs/String", "data: wrong")
    say(carried.ros1, "switch", "/lamp", "std_msgs/String", "data: right")
    wait_for(lambda: "lamp right" in carried.text, what="the lamp")
    carried.refuses("/stranger on /lamp")
    assert "lamp wrong" not in carried.text
    say(carried.ros1, "stranger2", "/unlisted_in", "std_msgs/String", "data: wrong")
    carried.refuses("/unlisted_in")
    assert "unlisted_in wrong" not in carried.text


def test_a_service_of_the_base_is_called_by_its_client_and_nobody_else(carried):
    client = carried.ros1.node("loggers_client.py", "/nav", "/reset")
    wait_for(lambda: client.ended, what="the client")
    assert "answer: was reset" in client.log
    stranger = carried.ros1.node("loggers_client.py", "/stranger3", "/reset")
    wait_for(lambda: stranger.ended, what="the stranger")
    assert "answer" not in stranger.log
    carried.refuses("/stranger3 to /reset")
    assert carried.text.count("reset\n") == 1


def test_the_base_calls_a_service_outside(carried):
    assert "map house" in carried.text


def test_parameters_are_those_of_the_manifest_and_no_change_comes_in(carried):
    assert "wheel 5 other none" in carried.text
    carried.ros1.run("rosparam", "set", f"{NODE}/wheel", "9")
    carried.refuses(f"a change of {NODE}")
    assert "param 9" not in carried.text


def test_a_service_has_so_many_connections_and_no_more(carried):
    uri = urlsplit(ros_call(carried.ros1.uri, "lookupService", "/nav", "/reset", timeout=LIMIT_S))
    header = encode_header({"callerid": "/nav", "service": "/reset", "md5sum": "*"})
    with ExitStack() as stack:
        for _ in range(70):
            sock = stack.enter_context(socket.create_connection((uri.hostname, uri.port)))
            sock.sendall(header)
        carried.refuses("a call of /reset")
    client = carried.ros1.node("loggers_client.py", "/nav", "/reset")
    wait_for(lambda: client.ended, what="the client")
    assert "answer: was reset" in client.log


def test_what_is_refused_stands_in_the_diagnostics(carried):
    carried.refuses("/unlisted")
    echo = carried.ros1.spawn("rostopic", "echo", "/diagnostics")
    wait_for(lambda: "rtron: cell of /base" in echo.log, what="the diagnostics")
    wait_for(lambda: "/unlisted" in echo.log, what="the refusal")


def test_the_node_does_not_start_without_its_parameters(open_ros1):
    ros1, begun = open_ros1, open_ros1.folder / "begun"
    (ros1.folder / "rtron.yaml").write_text(write_plan(celled_plan()))
    ros1.run("rosparam", "set", "/driver/speed", "1")
    set_unreadable(ros1.uri, "/driver/wide")
    cell = start_cell(ros1, ["touch", begun], node="/driver", parameters=["/driver", "/unset"])
    wait_for(lambda: "the start of /driver is refused" in cell.log, what="the refusal")
    assert not begun.exists()
    ros1.run("rosparam", "delete", "/driver/wide")
    wait_for(lambda: cell.ended, what="the end of the node")
    assert begun.exists()


def set_unreadable(master, name):
    """Set a parameter that rosmaster takes and cannot hand out: an integer of over 32 bits."""
    value = "<value><i8>1099511627776</i8></value>"
    params = "".join(
        f"<param>{each}</param>" for each in (text_value("/x"), text_value(name), value)
    )
    body = f"<methodCall><methodName>setParam</methodName><params>{params}</params></methodCall>"
    request = Request(master, body.encode(), {"Content-Type": "text/xml"})
    with urlopen(request, timeout=LIMIT_S) as answer:
        assert b"<int>1</int>" in answer.read()


def text_value(text):
    return f"<value><string>{text}</string></value>"
