"""The bridge on a real ROS 2: nodes of rclpy on one side, roslibpy on the other."""

import json
import signal
import sys
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

pytest.importorskip("rclpy", reason="needs ROS 2")
pytest.importorskip("roslibpy", reason="roslibpy is of the extra `ros2-dev`")

from rtron.wire.ros2.endpoints import publishers_of
from rtron.wire.ros2.session import Ros2Session

pytestmark = pytest.mark.ros2
LAMP = Path(__file__).parent / "nodes" / "lamp.py"
FIB = "{action: /fib, type: test_msgs/action/Fibonacci, rate: 10}"
LIGHT = "      - {topic: /light, type: std_msgs/msg/String}\n"


@pytest.fixture
def bridge(ros2):
    rights = RIGHTS.replace("    subscribe:\n", f"    subscribe:\n{LIGHT}", 1)
    rights = rights.replace("    parameters:", f"    actions: [{FIB}]\n    parameters:")
    return BridgeProcess(ros2, 2, rights)


@pytest.fixture
def lamp(ros2):
    process = ros2.spawn(sys.executable, LAMP)
    wait_for_word(process, "ready")
    return process


@pytest.fixture
def domain(ros2):
    with pytest.MonkeyPatch.context() as patch:
        for name, value in ros2.environ.items():
            patch.setenv(name, value)
        session = Ros2Session(ros2.domain)
        yield session.node("/onlooker")
        session.close()


def first_heard(process):
    return json.loads(wait_for_word(process, "heard:").partition("heard:")[2].splitlines()[0])


def test_a_command_that_no_guard_hears_is_refused(bridge):
    assert drive_unheard(bridge) == (
        "/rtron/cmd_vel/web: the guard does not hear you yet, send it again"
    )


def test_a_lease_is_asked_for_in_the_first_frame(ros2):
    acquire_at_once(BridgeProcess(ros2, 2, LEASED_RIGHTS, plan=LEASED_PLAN))


def test_a_command_of_a_client_passes_the_guard_as_a_flow_of_its_own(ros2, bridge, domain):
    guard = bridge.guard()
    wait_for_word(guard, "guarding 1 topics")
    driver = ros2.node("twist_subscriber.py", "/rtron/cmd_vel/out", name="/driver")
    bridge.client("web", "drive", "0.3")
    wait_for_word(driver, "speed 0.3")

    def names(topic):
        return {each.node for each in publishers_of(domain, topic)}

    wait_for(lambda: names("/rtron/cmd_vel/web") == {"/bridge/web"})
    assert "/bridge/web" not in names("/cmd_vel") | names("/rtron/cmd_vel/out")


def test_messages_go_to_rclpy_and_to_another_client_and_come_back(bridge, lamp):
    screen = bridge.client("screen", "listen", "/chat", "std_msgs/String")
    bridge.client("web", "chat", "hi")
    wait_for_word(lamp, "chat hi")
    assert first_heard(screen) == {"data": "hi"}


def test_a_client_hears_rclpy(bridge, lamp):
    light = bridge.client("web", "listen", "/light", "std_msgs/msg/String")
    assert first_heard(light) == {"data": "grün"}


def test_a_service_of_rclpy_is_called(bridge, lamp):
    process = bridge.client("web", "call", "/lamp", '{"data": true}')
    answer = wait_for_word(process, "answer:").partition("answer:")[2]
    assert json.loads(answer) == {"success": True, "message": "on"}


@pytest.mark.long
@pytest.mark.parametrize(
    ("service", "why"),
    [("/driver/get_loggers", "may not call"), ("/nobody", "no answer within 5 s")],
)
def test_a_service_that_is_refused_or_not_there_has_a_reason(bridge, service, why):
    process = bridge.client("web", "call", service, '{"data": true}')
    assert why in wait_for_word(process, "refused:")


@pytest.mark.parametrize(
    ("what", "word"),
    [
        (("get_param", "/lamp:speed"), "value: 0.5"),
        (("get_param", "/lamp:names"), 'value: ["a", "\\u00e4"]'),
        (("get_param", "/lamp:nothing"), "refused: there is no parameter /lamp:nothing"),
        (("get_param", "/base:speed"), "refused: web may not read /base:speed"),
        (("set_param", "/lamp:speed", "0.75"), "set"),
        (("set_param", "/lamp:speed", '"fast"'), "refused: /lamp:speed is not set"),
        (("set_param", "/lamp:names", '["b"]'), "refused: web may not write /lamp:names"),
    ],
)
def test_parameters_have_rights(bridge, lamp, what, word):
    assert word in wait_for_word(bridge.client("web", *what), word.partition(" ")[0])


def test_a_goal_has_feedback_and_a_result(ros2, bridge):
    ros2.node("fibonacci_server.py", name="/server")
    process = bridge.client("web", "goal", "/fib", "20")
    told = json.loads(wait_for_word(process, "result:").partition("result:")[2])
    assert told == {"status": 4, "values": {"sequence": [20]}}


def test_a_goal_is_cancelled_by_its_client_and_when_that_leaves(ros2, bridge):
    server = ros2.node("fibonacci_server.py", str(ros2.folder / "never"), name="/server")
    process = bridge.client("web", "cancelled_goal", "/fib", "2000")
    assert '"status": 5' in wait_for_word(process, "refused:")
    wait_for_word(server, "canceled 2000")
    process.stop(signal.SIGKILL)
    wait_for_word(bridge.process, "/bridge/web has left")
    other = bridge.client("web", "goal", "/fib", "3000")
    wait_for_word(server, "started 3000")
    other.stop(signal.SIGKILL)
    wait_for_word(server, "canceled 3000")


@pytest.mark.long
def test_goals_that_were_sent_a_moment_ago_are_cancelled_when_their_client_leaves(ros2, bridge):
    server = ros2.node("fibonacci_server.py", str(ros2.folder / "never"), name="/server")
    for order in range(3001, 3006):
        process = bridge.client("web", "goal", "/fib", str(order))
        wait_for_word(server, f"started {order}")
        process.stop(signal.SIGKILL)
        wait_for_word(server, f"canceled {order}")


def test_a_goal_is_cancelled_when_the_bridge_ends(ros2, bridge):
    server = ros2.node("fibonacci_server.py", str(ros2.folder / "never"), name="/server")
    bridge.client("web", "goal", "/fib", "2000")
    wait_for_word(server, "started 2000")
    bridge.process.stop(signal.SIGINT)
    wait_for_word(server, "canceled 2000")


@pytest.mark.long
def test_a_goal_that_was_cancelled_before_its_server_came_is_never_sent(ros2, bridge):
    process = bridge.client("web", "cancelled_goal", "/fib", "2000")
    assert "cancelled before it was served" in wait_for_word(process, "refused:")
    server = ros2.node("fibonacci_server.py", str(ros2.folder / "never"), name="/server")
    process.stop(signal.SIGKILL)
    other = bridge.client("web", "goal", "/fib", "20")
    wait_for_word(other, "result:")
    assert "started 2000" not in server.log


@pytest.mark.long
def test_a_goal_to_nobody_has_a_reason(bridge):
    process = bridge.client("web", "goal", "/fib", "20")
    assert "nobody serves /fib" in wait_for_word(process, "refused:")


@pytest.mark.long
def test_a_goal_whose_server_dies_has_a_reason(ros2, bridge):
    server = ros2.node("fibonacci_server.py", str(ros2.folder / "never"), name="/server")
    process = bridge.client("web", "goal", "/fib", "2000")
    wait_for_word(server, "started 2000")
    server.stop(signal.SIGINT)
    assert "the server of the goal is gone" in wait_for_word(process, "refused:")


def test_a_topic_that_a_client_may_not_read_is_told(bridge):
    process = bridge.client("screen", "listen", "/light", "std_msgs/String")
    assert "screen may not read /light" in wait_for_word(process, "status: error")


@pytest.mark.long
def test_the_node_of_a_client_leaves_with_it_and_comes_again(bridge, lamp, domain):
    def names():
        return {each.node for each in publishers_of(domain, "/chat")}

    process = bridge.client("web", "chat", "hi")
    wait_for(lambda: names() == {"/bridge/web"})
    process.stop(signal.SIGKILL)
    wait_for(lambda: names() == set())
    bridge.client("web", "chat", "again")
    wait_for_word(lamp, "chat again")


@pytest.mark.long
def test_the_bridge_ends_in_order(bridge, lamp):
    bridge.client("web", "chat", "hi")
    wait_for_word(lamp, "chat hi")
    bridge.process.stop(signal.SIGINT)
    assert bridge.process.code == 0
    assert "Traceback" not in bridge.log
