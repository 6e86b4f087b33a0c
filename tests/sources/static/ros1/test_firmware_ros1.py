"""Sketches of Arduino: what the bridge of rosserial publishes, subscribes and serves for them."""

from pathlib import Path

import pytest
from file_tree import write

from rtron.sources.static.common.launch_paths import find_launch_file
from rtron.sources.static.common.scan_options import ScanOptions
from rtron.sources.static.ros1.app import scan_app
from rtron.sources.workspace import read_workspace
from rtron.vocabulary import WiringFactKind

SKETCH = """#include <ros.h>
#include <geometry_msgs/Twist.h>
#include <std_msgs/Int16.h>
#include <std_srvs/SetBool.h>
ros::NodeHandle nh;
std_msgs::Int16 ticks;
ros::Publisher left("left_ticks", &ticks);
void onCommand(const geometry_msgs::Twist &msg) { analogWrite(7, msg.linear.x); }
ros::Subscriber<geometry_msgs::Twist> command("cmd_vel", onCommand);
void onLift(const std_srvs::SetBool::Request &q, std_srvs::SetBool::Response &a) {}
ros::ServiceServer<std_srvs::SetBool::Request, std_srvs::SetBool::Response> lift("lift", &onLift);
void setup() {
  nh.initNode();
  nh.advertise(left);
  nh.subscribe(command);
  nh.advertiseService(lift);
}
void loop() { left.publish(&ticks); nh.spinOnce(); }
"""
BRIDGE = '<node pkg="rosserial_python" type="serial_node.py" name="{}" ns="base"/>'


@pytest.fixture
def scan(tmp_path):
    """Return a function that scans an app of some bridges, with sketches by their paths."""

    def graph(sketches, bridges=("board",), extra=""):
        nodes = "".join(map(BRIDGE.format, bridges)) + extra
        manifest = "<package><name>robot</name></package>"
        files = {
            "robot/package.xml": manifest,
            "robot/launch/a.launch": f"<launch>{nodes}</launch>",
        }
        write(tmp_path, {**files, **sketches})
        path = find_launch_file("robot/a.launch", read_workspace([tmp_path], {}))
        return scan_app([tmp_path], [(path, {})], {}, ScanOptions(workers=1)).graph

    return graph


def test_a_sketch_is_what_the_bridge_joins(scan):
    found = scan({"arduino/drive/drive.ino": SKETCH})
    ends = {(str(e.direction), e.topic, e.type) for e in found.endpoints if not e.implicit}
    assert ends == {
        ("publish", "/base/left_ticks", "std_msgs/Int16"),
        ("subscribe", "/base/cmd_vel", "geometry_msgs/Twist"),
    }
    assert [(s.node, s.name, s.type) for s in found.services] == [
        ("/base/board", "/base/lift", "std_srvs/SetBool")]  # fmt: skip
    assert [node.unread for node in found.nodes] == [False]
    assert [note.what for note in found.unresolved] == ["sketch drive.ino"]
    (command,) = [e for e in found.endpoints if e.topic == "/base/cmd_vel"]
    assert command.evidence[0].file.endswith("drive.ino")
    assert command.evidence[0].line == 9


@pytest.mark.parametrize(
    ("names", "bridges"), [(["a/a.ino", "b/b.ino"], ["board"]), (["a/a.ino"], ["left", "right"])]
)
def test_which_sketch_is_whose_is_not_guessed(scan, names, bridges):
    found = scan(dict.fromkeys(names, SKETCH), bridges)
    assert all(node.unread for node in found.nodes)
    notes = [note for note in found.unresolved if note.what.startswith("firmware of /base/")]
    assert [len(note.evidence) for note in notes] == [len(names)] * len(bridges)
    assert not [e for e in found.endpoints if not e.implicit]


@pytest.fixture
def app_sending(scan):
    """Return a function that scans an app whose node sends what sketches may hear."""
    node = "import rospy\nfrom geometry_msgs.msg import Twist\nrospy.init_node('nav')\n"
    node += "rospy.Publisher('/base/cmd_vel', Twist)\n"
    source = {"robot/scripts/nav.py": node}
    return lambda sketches: scan(
        {**source, **sketches}, extra='<node pkg="robot" type="nav.py" name="nav"/>'
    )


def test_a_sketch_that_hears_what_the_app_sends_is_taken_before_others(app_sending):
    other = SKETCH.replace("cmd_vel", "other_vel")
    found = app_sending({"a/a.ino": SKETCH, "b/b.ino": other})
    heard = {e.topic for e in found.endpoints if e.node == "/base/board" and not e.implicit}
    assert heard == {"/base/left_ticks", "/base/cmd_vel"}
    assert not any(node.unread for node in found.nodes)


def test_several_sketches_that_hear_it_are_joined_with_a_note(app_sending):
    more = SKETCH.replace(
        "  nh.subscribe(command);", "  nh.subscribe(command);\n  nh.subscribe(web);"
    )
    more = more.replace(
        "void setup", 'ros::Subscriber<geometry_msgs::Twist> web("web_vel", onCommand);\nvoid setup'
    )
    found = app_sending({"a/a.ino": SKETCH, "b/b.ino": more})
    heard = {e.topic for e in found.endpoints if e.node == "/base/board" and not e.implicit}
    assert {"/base/cmd_vel", "/base/web_vel"} <= heard
    assert [node.unread for node in found.nodes if node.name == "/base/board"] == [True]


@pytest.fixture
def board_topics(scan):
    """Return a function that tells the topics of each bridge of an app that uses three of them."""
    node = "import rospy\nfrom geometry_msgs.msg import Twist\nrospy.init_node('nav')\n"
    for name in ("drive_vel", "arm_vel"):
        node += f"rospy.Publisher('/base/{name}', Twist)\n"
    extra = '<node pkg="robot" type="nav.py" name="nav"/>'

    def topics(sketches, bridges):
        texts = {path: SKETCH.replace("cmd_vel", name) for path, name in sketches.items()}
        found = scan({"robot/scripts/nav.py": node, **texts}, bridges, extra)
        ends = [e for e in found.endpoints if e.topic.endswith("_vel") and e.node != "/nav"]
        return {e.topic.removeprefix("/base/"): e.node.removeprefix("/base/") for e in ends}

    return topics


@pytest.mark.parametrize(
    ("sketches", "expected"),
    [
        ({"arm/a.ino": "arm_vel", "b/b.ino": "drive_vel"}, {"arm_vel": "arm", "drive_vel": "x"}),
        ({"a/a.ino": "arm_vel", "b/b.ino": "drive_vel"}, {"arm_vel": "x", "drive_vel": "arm"}),
        ({"a/a.ino": "other_vel", "b/b.ino": "drive_vel"}, {"drive_vel": "x"}),
    ],
    ids=["by name", "one each", "of another app"],
)
def test_each_sketch_gets_a_bridge_of_several(board_topics, sketches, expected):
    assert board_topics(sketches, ["x", "arm"]) == expected


def test_sketches_for_one_purpose_are_behind_one_bridge(board_topics):
    sketches = {"a/a.ino": "arm_vel", "b/b.ino": "drive_vel", "c/c.ino": "drive_vel"}
    assert board_topics(sketches, ["x", "y"]) == {"arm_vel": "x", "drive_vel": "y"}


@pytest.mark.parametrize("include", ["<ros.h>", '"ros.h"'])
@pytest.mark.parametrize(
    ("name", "start"), [("src/main.cpp", ""), ("src/board.c", "int main() { setup(); loop(); }")]
)
def test_firmware_may_be_in_any_source_file(scan, include, name, start):
    found = scan({name: SKETCH.replace("<ros.h>", include) + start})
    assert {e.topic for e in found.endpoints if not e.implicit} == {
        "/base/left_ticks", "/base/cmd_vel"}  # fmt: skip


def test_programs_of_one_folder_are_not_one(scan):
    found = scan({"a/one.cpp": SKETCH, "a/two.cpp": SKETCH, "a/pins.cpp": "int pin = 2;\n"})
    (note,) = [note for note in found.unresolved if note.what.startswith("firmware of")]
    assert [Path(at.file).name for at in note.evidence] == ["one.cpp", "two.cpp"]


def test_a_node_of_roscpp_is_no_firmware(scan):
    found = scan({"a/node.cpp": SKETCH.replace("<ros.h>", "<ros/ros.h>")})
    assert [node.unread for node in found.nodes] == [True]


def test_firmware_reaches_hardware_and_shows_what_it_opens(scan):
    found = scan({"a/a.ino": "#include <Wire.h> // import serial\n" + SKETCH})
    shown = {(fact.kind, fact.value) for fact in found.wiring if fact.subject == "/base/board"}
    assert (WiringFactKind.DEVICE, "firmware") in shown
    assert (WiringFactKind.DEVICE, "serial port") not in shown


KEEPING = SKETCH.replace(
    "{ analogWrite(7, msg.linear.x); }", "{ speed = msg.linear.x; last = millis(); }"
)
WATCHED = "if (millis() - last > 500) speed = 0; analogWrite(7, speed); nh.spinOnce();"
HEADER = "float speed; unsigned long last;\n"


@pytest.mark.parametrize(
    ("files", "fate"),
    [
        ({"a/a.ino": HEADER + KEEPING.replace("nh.spinOnce();", WATCHED)}, "checked"),
        ({"a/a.ino": HEADER + KEEPING.replace("nh.spinOnce();", "analogWrite(7, speed);")},
         "unnoticed"),
        ({"a/a.ino": '#include "wheels.h"\n' + KEEPING.replace("nh.spinOnce();", "turn();"),
          "a/lib/wheels/wheels.h": HEADER + "void turn();\n",
          "a/lib/wheels/wheels.cpp": f'#include "wheels.h"\nvoid turn() {{ {WATCHED} }}\n'},
         "checked"),
        ({"a/a.ino": HEADER + KEEPING.replace("nh.spinOnce();", "turn();"),
          "a/b.ino": f"namespace w {{\n  void setup() {{}}\n}}\nvoid turn() {{ {WATCHED} }}\n"},
         "checked"),
    ],
    ids=["a clock", "for ever", "in a library", "in another file"],
)  # fmt: skip
def test_what_becomes_of_the_last_command_is_seen_in_all_of_the_firmware(scan, files, fate):
    fates = [f.value for f in scan(files).wiring if f.kind is WiringFactKind.LAST_MESSAGE]
    assert fates == [fate]


@pytest.mark.parametrize(
    "line", ["elapsedMillis since;", "Timeout stopper;", "void f() { xQueueReceive(q, &v, 50); }"]
)
def test_a_timer_of_the_board_may_end_commands(scan, line):
    found = scan({"a/a.ino": SKETCH + line})
    (age,) = [fact for fact in found.wiring if fact.kind is WiringFactKind.COMMAND_AGE]
    assert age.evidence[0].line == SKETCH.count("\n") + 1


def test_a_link_leads_to_no_firmware_outside(scan, tmp_path):
    outside = tmp_path.with_name("outside.ino")
    outside.write_text(SKETCH)
    (tmp_path / "a").mkdir()
    (tmp_path / "a" / "a.ino").symlink_to(outside)
    assert [node.unread for node in scan({}).nodes] == [True]


@pytest.mark.parametrize(
    "name", ["libraries/x/x.ino", "x/examples/x/x.ino", ".git/x/x.ino", "Archived/x/x.ino"]
)
def test_examples_of_libraries_are_no_firmware(scan, name):
    assert [node.unread for node in scan({name: SKETCH}).nodes] == [True]


def test_a_sketch_without_rosserial_is_none(scan):
    found = scan({"a/a.ino": "#include <Servo.h>\nvoid setup() {}\nvoid loop() {}\n"})
    assert [node.unread for node in found.nodes] == [True]
