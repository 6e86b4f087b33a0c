import json
import struct

import pytest
from rosbags.rosbag1 import Writer
from rosbags.rosbag2 import StoragePlugin
from rosbags.rosbag2 import Writer as Writer2

from rtron.sources.graph_json import read_graph

TWIST = struct.pack("<6d", *range(6))


@pytest.fixture
def bag(tmp_path):
    path = tmp_path / "my run.bag"
    with Writer(path) as writer:
        for node, topic, type in (
            ("/keyboard", "/cmd_vel", "geometry_msgs/msg/Twist"),
            ("/planner", "/cmd_vel", "geometry_msgs/msg/Twist"),
            ("/base", "/odom", "nav_msgs/msg/Odometry"),
            ("/evil\x1b[31m", "/goal", "geometry_msgs/msg/PoseStamped"),
        ):
            stream = writer.add_connection(topic, type, msgdef="x", md5sum="y", callerid=node)
            writer.write(stream, 1, TWIST)
    return path


@pytest.fixture(params=["mcap", "sqlite3"])
def ros2_folder(request, tmp_path):
    path = tmp_path / "recorded"
    with Writer2(path, version=9, storage_plugin=StoragePlugin[request.param.upper()]) as writer:
        writer.write(
            writer.add_connection("/odom", "nav_msgs/msg/Odometry", msgdef="x", rihs01="y"), 1, b"z"
        )
    return path


def test_a_bag_is_scanned(rtron, bag):
    ran = rtron("scan", bag, "--level", "auditor")
    assert (ran.code, ran.err) == (1, "")
    assert f"ROS 1, read from {bag}" in ran.out
    assert "MSR-event:/odom" in ran.out
    assert "subscribers: a bag records who publishes, not who subscribes" in " ".join(
        ran.out.split()
    )
    assert f"rtron plan '{bag}' -o rtron.yaml" in ran.out
    assert "\x1b" not in ran.out


@pytest.mark.parametrize("format", ["text", "json", "graph", "dot", "sarif", "html"])
def test_every_format_works(rtron, bag, format):
    ran = rtron("scan", bag, "--format", format, "--level", "auditor")
    assert (ran.code, ran.err) == (1, "")
    assert "/odom" in ran.out
    assert "\x1b" not in ran.out


def test_the_graph_of_a_bag_is_one_to_scan(rtron, bag, tmp_path):
    copy = tmp_path / "graph.json"
    assert rtron("scan", bag, "--format", "graph", "-o", copy, "--fail-on", "never").code == 0
    assert [each.node for each in read_graph(copy).publishers("/cmd_vel")] == [
        "/keyboard",
        "/planner",
    ]


def test_a_plan_is_proposed_and_can_be_checked(rtron, bag, tmp_path):
    plan = tmp_path / "rtron.yaml"
    ran = rtron("plan", bag, "-o", plan)
    assert (ran.code, ran.err) == (0, "")
    assert rtron("check", plan).code == 0


def test_a_ros2_folder_and_its_file(rtron, ros2_folder):
    (file,) = (path for path in ros2_folder.iterdir() if path.suffix != ".yaml")
    for path in (ros2_folder, file):
        for command, code in (("scan", 0), ("plan", 1)):
            ran = rtron(command, path)
            assert (ran.code, ran.err) == (code, "")
        graph = json.loads(rtron("scan", path, "--format", "graph").out)
        assert [topic["name"] for topic in graph["topics"]] == ["/odom"]
        assert {"subscribers", "/odom"} == {each["what"] for each in graph["unresolved"]}


def test_a_folder_with_another_metadata_is_one_of_source(rtron, tmp_path):
    (tmp_path / "metadata.yaml").write_text("title: no bag\n")
    ran = rtron("scan", tmp_path)
    assert "metadata" not in ran.err
    assert "rosbag2" not in ran.err


@pytest.mark.parametrize("command", ["scan", "plan"])
@pytest.mark.parametrize(
    ("name", "content", "said"),
    [
        ("x.bag", b"", "no ROS 1 bag"),
        ("x.bag", b"#ROSBAG V2.0\n\0", "the bag is damaged"),
        ("x.mcap", b"\x89MCAP0\r\n", "the recording was cut off"),
        ("x.db3", b"SQLite format 3\0", "the bag is damaged"),
        ("x.db3", b"{}", "no SQLite database"),
    ],
)
def test_bad_bags_are_2_with_a_help_line(rtron, tmp_path, command, name, content, said):
    path = tmp_path / name
    path.write_bytes(content)
    ran = rtron(command, path)
    assert (ran.code, ran.out) == (2, "")
    assert ran.err.startswith(f"error: {path}: {said}")
    assert "\nhelp: " in ran.err


def test_a_bag_is_given_alone(rtron, bag, tmp_path):
    ran = rtron("scan", bag, "other.bag")
    assert (ran.code, ran.out) == (2, "")
    assert "what is other.bag?" in ran.err
    assert "one bag" in ran.err
    ran = rtron("scan", tmp_path / "none.bag")
    assert "No such file" in ran.err
    assert "both" in rtron("scan", bag, "--live").err
    ran = rtron("scan", bag, "--launch", "app.launch")
    assert (ran.code, ran.out) == (2, "")
    assert "--launch are given" in ran.err


def test_the_help_names_bags(rtron):
    for command in ("scan", "plan"):
        out = rtron(command, "--help").out
        assert ".mcap" in out
        assert f"rtron {command} run.bag" in out
