"""Command lines that a launch of ROS 2 starts: verbs of `ros2`, and what a shell runs."""

import pytest

from rtron.sources.static.common.scan_options import ScanOptions
from rtron.sources.static.ros2.app import scan_ros2_app
from rtron.vocabulary import ActionRole, Durability, Mode, QoS, Reliability, WiringFactKind
from rtron.workflows.plan import propose
from rtron.workflows.scan import scan_graph

PYTHON = """from launch import LaunchDescription
from launch.actions import ExecuteProcess
from launch.substitutions import FindExecutable, LaunchConfiguration
def generate_launch_description():
    return LaunchDescription([ExecuteProcess(cmd={cmd}, shell={shell})])
"""


@pytest.fixture
def started(tmp_path):
    """Return the graph of an app whose launch starts a process by the words of a `cmd`."""
    (tmp_path / "package.xml").write_text("<package><name>app</name></package>")
    launch = tmp_path / "app.launch.py"

    def scan(*words, shell=True):
        written = [word if word.startswith("[") else repr(word) for word in words]
        launch.write_text(PYTHON.format(cmd=f"[{', '.join(written)}]", shell=shell))
        return scan_ros2_app([tmp_path], [(launch, {})], {}, ScanOptions(workers=1))

    return scan


def joined(endpoints):
    return [(e.node, e.topic, e.type) for e in endpoints if not e.implicit]


def test_a_message_that_is_published(started):
    words = ["-r", "10", "--qos-depth", "3", "--qos-durability", "transient_local"]
    given = ["/cmd_vel", "geometry_msgs/msg/Twist", "{linear: {x: 1.0}}"]
    graph = started("ros2", "topic", "pub", *words, *given)
    (sent,) = graph.publishers("/cmd_vel")
    assert joined([sent]) == [("/_ros2cli_*", "/cmd_vel", "geometry_msgs/msg/Twist")]
    assert sent.qos == QoS(depth=3, durability=Durability.TRANSIENT_LOCAL)
    (node,) = graph.nodes
    assert (node.package, node.executable) == ("ros2topic", "pub")
    assert [s.name for s in graph.services] == ["/_ros2cli_*/get_type_description"]
    assert graph.unresolved == ()


def test_the_base_of_one_that_a_process_commands_is_guarded(started):
    graph = started("ros2", "topic", "pub", "/cmd_vel", "geometry_msgs/msg/Twist")
    (grcn,) = propose(scan_graph(graph)).plan.grcn
    assert [(flow.publisher, grcn.mode) for flow in grcn.flows] == [("/_ros2cli_*", Mode.ENFORCE)]


def test_a_publisher_may_be_named_and_remapped(started):
    ros = ["--ros-args", "-r", "__ns:=/bot", "-r", "a:=b"]
    options = ["-n", "stop", "-1", "--qos-reliability", "best_effort"]
    graph = started("ros2", "topic", "pub", "a", "std_msgs/Bool", *options, *ros)
    (sent,) = graph.publishers("/bot/b")
    assert joined([sent]) == [("/bot/stop", "/bot/b", "std_msgs/msg/Bool")]
    assert sent.qos.reliability is Reliability.BEST_EFFORT


@pytest.mark.parametrize(
    ("options", "once"),
    [
        *(("", []), ("-r 5", []), ("-t 0", []), ("-t x", []), ("-r 50 -t 100000", [])),
        *(("--once", ["/x"]), ("-1", ["/x"]), ("-t 3", ["/x"])),
    ],
)
def test_a_topic_pub_that_is_not_told_how_often_goes_on(started, options, once):
    graph = started(*f"ros2 topic pub {options} -n x /a std_msgs/msg/Bool".split())
    kind = WiringFactKind.SENT_ONCE
    assert [fact.subject for fact in graph.wiring if fact.kind is kind] == once


@pytest.mark.parametrize("line", ["echo /a std_msgs/String --once", "hz -w 5 /a", "echo /a"])
def test_what_listens_subscribes(started, line):
    graph = started("ros2", "topic", *line.split())
    (heard,) = graph.subscribers("/a")
    assert heard.type == ("std_msgs/msg/String" if "String" in line else "")


@pytest.mark.parametrize("type", ["std_srvs/srv/Trigger", "std_srvs/Trigger"])
def test_a_service_that_is_called(started, type):
    graph = started("/opt/ros/bin/ros2 service call /go " + type + ' "{}"')
    (client,) = graph.clients
    assert client.node == "/_ros2cli_requester_std_srvs_Trigger"
    assert (client.name, client.type) == ("/go", "std_srvs/srv/Trigger")


def test_a_lifecycle_node_whose_state_is_set(started):
    graph = started("ros2 lifecycle set /ns/slam activate")
    assert [client.name for client in graph.clients] == ["/ns/slam/change_state"]
    assert graph.unresolved == ()


def test_a_goal_that_is_sent(started):
    graph = started("ros2 action send_goal -f /spin nav2_msgs/action/Spin '{target_yaw: 1.0}'")
    (action,) = graph.actions
    assert action.node == "/_ros2cli_send_goal_nav2_msgs_action_Spin"
    assert (action.name, action.type) == ("/spin", "nav2_msgs/action/Spin")
    assert action.role is ActionRole.CLIENT


def test_a_bag_that_is_recorded(started):
    graph = started("ros2 ", "bag ", "record ", "/scan ", "-o ", "out")
    (heard,) = graph.subscribers("/scan")
    assert heard.node == "/rosbag2_recorder"
    (note,) = started("ros2 bag record -a").unresolved
    assert note.what == "the topics that ros2 bag records"


def test_what_is_not_known_of_a_line_stays_in_its_word(started):
    whole = '["ros2 topic pub /", LaunchConfiguration("a b"), "/x std_msgs/msg/Bool --once"]'
    graph = started(whole)
    (sent,) = [e for e in graph.endpoints if not e.implicit]
    assert (sent.topic, sent.type) == ("/{a b}/x", "std_msgs/msg/Bool")


def test_each_command_of_a_shell_counts(started):
    script = "sleep 5 && ros2 service call /go std_srvs/srv/Empty ; ros2 run demo talker -r x:=y"
    graph = started("bash", "-lc", f"'{script}'", "|", "tee", "log")
    assert {node.name for node in graph.nodes} == {"/talker", "/_ros2cli_requester_std_srvs_Empty"}
    whats = [note.what for note in graph.unresolved]
    assert whats == ["node /talker (demo/talker)", "process tee log"]


SCRIPTS = {
    "ros2 run a b; ros2 run c d": ["/b", "/d"],
    "ros2 run a b;ros2 run c d&": ["/b", "/d"],
    "echo hi; ros2 run a b": ["/b"],
    "cd /x\nros2 run a b # one; ros2 run x y\n# two\nros2 run c d \\\n  -r __ns:=/n": [
        "/b",
        "/n/d",
    ],
    "source /opt/s.bash; ros2 run a b": ["/b"],
    "ros2 run a b > log.txt 2>&1; ros2 run c d </dev/null &>x": ["/b", "/d"],
    "(ros2 run a b) || ros2 run c d 'x;y' \"&& ros2 run e f\"": ["/b", "/d"],
    "bash -c 'sleep 1;sh -c \"ros2 run a b\"'|ros2 run c d": ["/b", "/d"],
}


@pytest.mark.parametrize("script", SCRIPTS)
@pytest.mark.parametrize("by_shell", [True, False])
def test_where_commands_of_a_shell_end(started, script, by_shell):
    graph = started(script) if by_shell else started("bash", "-ec", script, shell=False)
    assert [node.name for node in graph.nodes] == SCRIPTS[script]
    whats = [note.what for note in graph.unresolved]
    programs = {"/b": "a/b", "/d": "c/d", "/n/d": "c/d"}
    assert whats == [f"node {name} ({programs[name]})" for name in SCRIPTS[script]]


def test_what_a_shell_gives_to_a_node_are_its_words_alone(started):
    line = "ros2 topic pub /a std_msgs/msg/String 'data: a;b#c' > log 2>&1; sleep 1"
    (sent,) = started(line).publishers("/a")
    assert sent.type == "std_msgs/msg/String"
    whole = '["sleep 5; ros2 topic pub /", LaunchConfiguration("a;b"), "; ros2 run a b"]'
    graph = started(whole)
    assert [e.topic for e in graph.endpoints if not e.implicit] == ["/{a;b}"]


def test_without_a_shell_no_word_separates(started):
    words = ["echo", "x", "&&", "ros2", "run", "a", "b", ";", "ros2", "topic", "pub"]
    assert not started(*words, shell=False).nodes
    (note,) = started("gz", *words, shell=False).unresolved
    assert note.what == "process gz echo"


def test_a_script_in_a_file_has_options_of_its_own(started):
    (note,) = started("bash", "script.sh", "-c", "ros2 run a b", shell=False).unresolved
    assert note.what == "process bash script.sh"
    (node,) = started("bash", "-o", "pipefail", "-c", "ros2 run a b", shell=False).nodes
    assert node.name == "/b"


@pytest.mark.parametrize(
    ("line", "what"),
    [
        ("echo $(ros2 run a b)", "process echo $(ros2 run a b)"),
        ('echo "`ros2 run a b`"', "process echo `ros2 run a b`"),
        ("cat <<EOF | sh\nros2 run a b\nEOF", "process << EOF"),
    ],
)
def test_what_runs_inside_a_word_is_noted(started, line, what):
    graph = started(line)
    assert not graph.nodes
    assert what in [note.what for note in graph.unresolved]


@pytest.mark.parametrize(
    ("options", "qos"),
    [
        ("--qos-profile sensor_data", QoS(depth=5, reliability=Reliability.BEST_EFFORT)),
        ("--qos-profile sensor_data --qos-reliability reliable --qos-depth 7", QoS(depth=7)),
        ("--qos-profile=action_status_default",
         QoS(depth=1, durability=Durability.TRANSIENT_LOCAL)),
        ("--qos-profile action_status_default --qos-durability volatile", QoS(depth=1)),
        ("--qos-profile parameters", QoS(depth=1000)),
        ("--qos-profile system_default", QoS()),
        ("--qos-profile system_default --qos-durability transient_local",
         QoS(depth=1, durability=Durability.TRANSIENT_LOCAL)),
        ("--qos-profile another --qos-depth 3", None),
    ],
)  # fmt: skip
def test_a_message_is_published_by_a_profile(started, options, qos):
    (sent,) = started(f"ros2 topic pub /a std_msgs/msg/Bool {options}").publishers("/a")
    assert sent.qos == qos


@pytest.mark.parametrize("line", ["ros2 topic list", "ros2 doctor", "ros2", "bash -c", "firefox x"])
def test_another_process_is_noted(started, line):
    (note,) = started(*line.split()).unresolved
    assert note.what == f"process {' '.join(line.split()[:2])}"
    assert not started(*line.split()).nodes


PROGRAMS = {
    "/opt/ros/humble/lib/tf2_ros/buffer_server": ("tf2_ros", "buffer_server"),
    "/ws/install/arm/lib/arm/driver": ("arm", "driver"),
    "rviz2": ("rviz2", "rviz2"),
    "/opt/ros/jazzy/bin/rviz2": ("rviz2", "rviz2"),
}


@pytest.mark.parametrize("program", PROGRAMS)
def test_a_program_that_is_run_by_its_file_is_its_package_s_node(started, program):
    words = ["--ros-args", "-r", "__node:=named", "-r", "__ns:=/bot"]
    nodes = {node.name: node for node in started(program, *words, shell=False).nodes}
    node = nodes["/bot/named"]
    assert (node.package, node.executable) == PROGRAMS[program]


@pytest.mark.parametrize("program", ["lib/p/x", "/usr/lib/x", "/lib/x", "/ws/libs/p/x"])
def test_a_program_elsewhere_is_noted(started, program):
    graph = started(program, shell=False)
    assert not graph.nodes
    assert [note.what for note in graph.unresolved] == [f"process {program}"]
