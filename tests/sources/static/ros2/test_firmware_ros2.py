"""Sketches of micro-ROS: the nodes that the agent's microcontrollers have, and what they do."""

import pytest

from rtron.sources.static.common.scan_options import ScanOptions
from rtron.sources.static.ros2.app import scan_ros2_app
from rtron.vocabulary import LastMessageFate, Reliability, WiringFactKind

SKETCH = """#include <micro_ros_arduino.h>
#include <rclc/rclc.h>
#include <std_msgs/msg/int32.h>
#define CHECK(fn) { rcl_ret_t rc = fn; if (rc != RCL_RET_OK) { fail(); } }
rclc_support_t support;
rcl_node_t node;
rcl_publisher_t ticks;
rcl_subscription_t speed;
rcl_service_t lift;
rclc_executor_t executor;
std_msgs__msg__Int32 got;
void fail() { while (1) { delay(100); } }
void onSpeed(const void *in) { analogWrite(7, ((const std_msgs__msg__Int32 *) in)->data); }
void onLift(const void *request, void *response) {}
void setup() {
  CHECK(rclc_node_init_default(&node, "board", "left", &support));
  CHECK(rclc_publisher_init_best_effort(
    &ticks, &node, ROSIDL_GET_MSG_TYPE_SUPPORT(std_msgs, msg, Int32), "ticks"));
  CHECK(rclc_subscription_init_default(
    &speed, &node, ROSIDL_GET_MSG_TYPE_SUPPORT(std_msgs, msg, Int32), "/speed"));
  CHECK(rclc_service_init_default(
    &lift, &node, ROSIDL_GET_SRV_TYPE_SUPPORT(std_srvs, srv, SetBool), "lift"));
  CHECK(rclc_executor_add_subscription(&executor, &speed, &got, &onSpeed, ON_NEW_DATA));
  CHECK(rclc_executor_add_service(&executor, &lift, &got, &got, onLift));
}
void loop() { rclc_executor_spin_some(&executor, RCL_MS_TO_NS(10)); }
"""
AGENT = '<node pkg="micro_ros_agent" exec="micro_ros_agent" name="{}" namespace="agents"/>'


@pytest.fixture
def scan(tmp_path):
    """Return a function that scans an app of some agents, with sketches by their paths."""

    def graph(sketches, agents=("agent",)):
        nodes = "".join(map(AGENT.format, agents))
        files = {"package.xml": "<package><name>own</name></package>", **sketches}
        for name, text in files.items():
            (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
            (tmp_path / name).write_text(text)
        launch = tmp_path / "app.launch.xml"
        launch.write_text(f"<launch>{nodes}</launch>")
        return scan_ros2_app([tmp_path], [(launch, {})], {}, ScanOptions(workers=1, cache=None))

    return graph


def test_the_board_is_a_node_of_its_own(scan):
    found = scan({"board/board.ino": SKETCH})
    assert [(node.name, node.unread) for node in found.nodes] == [("/left/board", False)]
    ends = {(str(e.direction), e.topic, e.type, e.qos.reliability) for e in found.endpoints}
    assert ends == {
        ("publish", "/left/ticks", "std_msgs/msg/Int32", Reliability.BEST_EFFORT),
        ("subscribe", "/speed", "std_msgs/msg/Int32", Reliability.RELIABLE),
    }
    assert [(s.node, s.name, s.type) for s in found.services] == [
        ("/left/board", "/left/lift", "std_srvs/srv/SetBool")]  # fmt: skip
    assert [note.what for note in found.unresolved] == ["sketch board.ino"]


def test_the_boards_hardware_keeps_its_last_command(scan):
    found = scan({"board/board.ino": SKETCH})
    shown = {(fact.kind, fact.subject, fact.value) for fact in found.wiring}
    assert (WiringFactKind.DEVICE, "/left/board", "firmware") in shown
    fates = [fact for fact in found.wiring if fact.kind is WiringFactKind.LAST_MESSAGE]
    assert [fact.value for fact in fates] == [LastMessageFate.UNNOTICED.value]


@pytest.mark.parametrize("start", ["int main()", "void app_main(void)", "void appMain(void *arg)"])
def test_each_framework_begins_by_its_own_function(scan, start):
    found = scan({"src/board.c": SKETCH.replace("void setup()", start)})
    assert [node.name for node in found.nodes] == ["/left/board"]


def test_checks_of_each_call_hide_none(scan):
    more = "".join(
        f'CHECK(rclc_publisher_init_default(&ticks, &node, "std_msgs/msg/Int32", "t{n}"));'
        for n in range(20)
    )
    stop = SKETCH.replace("fail();", "while (true) { delay(100); }")
    found = scan({"a/a.ino": stop.replace("void loop() {", "void loop() {" + more)})
    assert {f"/left/t{n}" for n in range(20)} < {end.topic for end in found.endpoints}


def test_an_agent_without_a_sketch_is_not_read(scan):
    assert [node.unread for node in scan({}).nodes] == [True]


def test_which_board_is_behind_an_agent_is_not_guessed(scan):
    found = scan({"a/a.ino": SKETCH, "b/b.ino": SKETCH.replace('"board"', '"other"')})
    assert [node.unread for node in found.nodes] == [True]
    (note,) = [note for note in found.unresolved if note.what.startswith("firmware of")]
    assert len(note.evidence) == 2
