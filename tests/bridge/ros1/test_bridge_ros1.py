"""The bridge on a real ROS 1: nodes of rospy on one side, roslibpy on the other."""

import json
import signal
from contextlib import ExitStack
from pathlib import Path

import pytest
from bridge_process import (
    LEASED_PLAN,
    LEASED_RIGHTS,
    RIGHTS,
    BridgeProcess,
    acquire_at_once,
    drive_unheard,
    wait_for_word,
)
from harness import wait_for
from memory_bridge import hear, say

from rtron.bridge.rights.tokens import token_hash

pytest.importorskip("roslibpy", reason="roslibpy is of the extra `dev`")
pytestmark = pytest.mark.ros1

NODES = Path(__file__).parent / "nodes"
OUT = "/rtron/cmd_vel/out"


@pytest.fixture
def bridge(ros1):
    return BridgeProcess(ros1, 1)


def driver_lines(path):
    text = path.read_text() if path.exists() else ""
    return [line.split() for line in text[: text.rfind("\n") + 1].splitlines()]


def test_a_command_of_a_client_passes_the_guard_as_a_flow_of_its_own(ros1, bridge, tmp_path):
    told = tmp_path / "told"
    bridge.guard()
    ros1.node("driver.py", "/driver", told, f"/cmd_vel:={OUT}")
    bridge.client("web", "drive", "0.3")
    wait_for(lambda: ["0.3", "0", "/rtron/grcn_cmd_vel"] in driver_lines(told))
    assert {sender for _, _, sender in driver_lines(told)} <= {
        "/rtron/grcn_cmd_vel",
        "/rtron_supervisor",
    }
    assert ros1.publishers("/rtron/cmd_vel/web") == {"/bridge/web"}
    assert "/bridge/web" not in ros1.publishers("/cmd_vel") | ros1.publishers(OUT)


def test_without_a_guard_a_command_reaches_no_base(ros1, bridge, tmp_path):
    told = tmp_path / "told"
    ros1.node("driver.py", "/driver", told)
    bridge.client("web", "drive", "0.3")
    wait_for(lambda: ros1.publishers("/rtron/cmd_vel/web") == {"/bridge/web"})
    wait_for(lambda: ros1.subscribers("/cmd_vel") == {"/driver"})
    chat = bridge.client("screen", "listen", "/cmd_vel", "geometry_msgs/Twist")
    assert "screen may not read /cmd_vel" in wait_for_word(chat, "status: error")
    assert ros1.publishers("/cmd_vel") == set()
    assert driver_lines(told) == []


def test_a_command_that_no_guard_hears_is_refused(bridge):
    assert drive_unheard(bridge) == (
        "/rtron/cmd_vel/web: the guard does not hear you yet, send it again"
    )


def test_a_lease_is_asked_for_in_the_first_frame(ros1):
    acquire_at_once(BridgeProcess(ros1, 1, LEASED_RIGHTS, plan=LEASED_PLAN))


def test_who_looks_on_hears_what_the_guard_lets_pass(ros1, bridge):
    bridge.guard()
    wait_for(lambda: ros1.publishers("/cmd_vel"))
    process = bridge.client("web", "listen", "/cmd_vel", "geometry_msgs/Twist")
    nav = ros1.spawn(
        "/usr/bin/python3",
        NODES / "twist_publisher.py",
        "/cmd_vel:=/rtron/cmd_vel/nav",
        "__name:=nav",
    )
    log = wait_for_word(process, "heard:")
    assert json.loads(log.partition("heard:")[2].splitlines()[0])["linear"]["x"] == 0.25
    assert not nav.ended


def test_a_message_reaches_rospy_and_another_client_and_back(ros1, bridge):
    node = ros1.node("string_endpoints.py", "/ends", "</chat")
    screen = bridge.client("screen", "listen", "/chat", "std_msgs/String")
    bridge.client("web", "chat", "grüße")
    assert "gr" in wait_for_word(node, "data:")
    assert json.loads(wait_for_word(screen, "heard:").partition("heard:")[2].splitlines()[0]) == {
        "data": "grüße"
    }
    assert ros1.publishers("/chat") == {"/bridge/web"}
    assert ros1.subscribers("/chat") == {"/bridge/screen", "/ends"}


def test_a_service_of_rospy_is_called(ros1, bridge, tmp_path):
    ros1.node("driver.py", "/driver", tmp_path / "told")
    ros1.wait_for_nodes("/driver")
    level = json.dumps({"logger": "rosout", "level": "debug"})
    process = bridge.client("web", "call", "/driver/set_logger_level", level)
    assert "answer: {}" in wait_for_word(process, "answer:")


@pytest.mark.parametrize(
    ("service", "why"),
    [
        ("/driver/get_loggers", "web may not call /driver/get_loggers"),
        ("/rosapi/nodes", "web may not call /rosapi/nodes"),
        ("/nobody", "nobody offers /nobody"),
        ("/driver/set_logger_level", "no field 'data'"),
    ],
)
def test_a_service_that_is_refused_has_a_reason(bridge, service, why):
    process = bridge.client("web", "call", service, '{"data": true}')
    assert why in wait_for_word(process, "refused:")


def test_another_version_of_a_service_is_refused(ros1, tmp_path):
    text = "string logger\nstring level\nbool more\n---\n"
    bridge = BridgeProcess(ros1, 1, services={"roscpp/srv/SetLoggerLevel.srv": text})
    ros1.node("driver.py", "/driver", tmp_path / "told")
    ros1.wait_for_nodes("/driver")
    process = bridge.client("web", "call", "/driver/set_logger_level", "{}")
    assert "refuses" in wait_for_word(process, "refused:")


def test_parameters(ros1, bridge):
    ros1.ask(ros1.uri, "setParam", "/nav/name", "ä")
    ros1.ask(ros1.uri, "setParam", "/base/secret", 5)
    assert '"\\u00e4"' in wait_for_word(bridge.client("web", "get_param", "/nav/name"), "value:")


@pytest.mark.parametrize(
    ("what", "word", "value"),
    [
        (("set_param", "/nav/speed", "[1, 2.5]"), "set", [1, 2.5]),
        (("set_param", "/nav/name", "1"), "refused:", None),
        (("get_param", "/base/secret"), "refused:", None),
        (("get_param", "/nav/none"), "refused:", None),
    ],
)
def test_parameters_have_rights(ros1, bridge, what, word, value):
    wait_for_word(bridge.client("web", *what), word)
    assert ros1.ask(ros1.uri, "getParam", what[1]) == value


def test_what_a_client_may_not_do_it_is_told(ros1, bridge):
    process = bridge.client("web", "publish", "/rosout", "rosgraph_msgs/Log", "{}")
    assert "web may not publish /rosout" in wait_for_word(process, "status: error")
    assert ros1.publishers("/rosout") == set()


def test_another_type_on_a_topic_is_told(ros1, bridge):
    ros1.spawn("/usr/bin/python3", NODES / "twist_publisher.py", "/cmd_vel:=/chat")
    process = bridge.client("web", "listen", "/chat", "std_msgs/String")
    wait_for(lambda: ros1.subscribers("/chat") == {"/bridge/web"})
    wait_for(lambda: "publishes geometry_msgs/Twist" in bridge.log)
    assert "heard:" not in process.log


def test_what_a_client_no_longer_wants_leaves_the_graph(ros1, bridge):
    with bridge.connect("web") as web:
        for _ in range(3):
            say(web, "subscribe", topic="/chat", type="std_msgs/String")
            say(web, "advertise", topic="/chat", type="std_msgs/String", latch=True)
            wait_for(lambda: ros1.subscribers("/chat") == {"/bridge/web"})
            wait_for(lambda: ros1.publishers("/chat") == {"/bridge/web"})
            say(web, "unsubscribe", topic="/chat")
            say(web, "unadvertise", topic="/chat")
            wait_for(lambda: ros1.subscribers("/chat") == set())
            wait_for(lambda: ros1.publishers("/chat") == set())


def test_a_latched_message_is_there_for_who_comes_later(ros1, bridge):
    with bridge.connect("web") as web, bridge.connect("screen") as screen:
        say(web, "publish", topic="/chat", msg={"data": "kept"}, latch=True)
        wait_for(lambda: ros1.publishers("/chat") == {"/bridge/web"})
        say(screen, "subscribe", topic="/chat", type="std_msgs/String")
        assert hear(screen)["msg"] == {"data": "kept"}


def hundred_rights():
    entry = """
  - name: c{n}
    tokens: ["{token}"]
    subscribe: [{{topic: /chat, type: std_msgs/String}}]"""
    clients = (entry.format(n=n, token=token_hash(f"c{n}")) for n in range(100))
    return RIGHTS + "".join(clients).lstrip("\n") + "\n"


@pytest.mark.long
def test_a_hundred_clients_are_a_hundred_nodes(ros1):
    bridge = BridgeProcess(ros1, 1, hundred_rights())
    with ExitStack() as stack:
        clients = [stack.enter_context(bridge.connect(f"c{n}")) for n in range(100)]
        for client in clients:
            say(client, "subscribe", topic="/chat", type="std_msgs/String")
        wait_for(lambda: ros1.subscribers("/chat") == {f"/bridge/c{n}" for n in range(100)})
        bridge.client("web", "chat", "to all")
        assert all(hear(client)["msg"] == {"data": "to all"} for client in clients)
    wait_for(lambda: ros1.subscribers("/chat") == set())


def test_the_node_of_a_client_leaves_with_it(ros1, bridge):
    process = bridge.client("web", "chat", "hi")
    wait_for(lambda: ros1.publishers("/chat") == {"/bridge/web"})
    process.stop(signal.SIGKILL)
    wait_for(lambda: ros1.publishers("/chat") == set())


def test_a_node_that_is_killed_by_rosnode_ends_its_connection(ros1, bridge):
    bridge.client("web", "chat", "hi")
    wait_for(lambda: ros1.publishers("/chat") == {"/bridge/web"})
    ros1.ask(ros1.uri_of("/bridge/web"), "shutdown", "rosnode kill")
    wait_for_word(bridge.process, "/bridge/web has left")


def test_the_bridge_ends_in_order(ros1, bridge):
    bridge.client("web", "chat", "hi")
    wait_for(lambda: ros1.publishers("/chat") == {"/bridge/web"})
    bridge.process.stop(signal.SIGINT)
    assert bridge.process.code == 0
    assert "Traceback" not in bridge.log
    wait_for(lambda: ros1.publishers("/chat") == set())
