"""A generated app of rclpy nodes: what is read from its source is what runs."""

import sys

import pytest

pytest.importorskip("rclpy", reason="needs ROS 2")

from harness import wait_for
from ros2_harness import Ros2

from rtron.sources.live.ros2.source import Ros2LiveSource
from rtron.sources.static.common.scan_options import ScanOptions
from rtron.sources.static.ros2.app import scan_ros2_app

pytestmark = pytest.mark.ros2
LONG_S = 60.0
NODES = 6 + 2 * 7
TALKER = """import rclpy
from rclpy.node import Node
from rclpy.qos import QoSProfile
from std_msgs.msg import Bool, String
from std_srvs.srv import Empty


class Talker(Node):
    def __init__(self):
        super().__init__('talker', namespace='written')
        topic = self.declare_parameter('topic', 'chatter').value
        for suffix in self.declare_parameter('suffixes', ['a', 'b']).value:
            self.create_publisher(String, f'{topic}/{suffix}', 1)
        self.create_publisher(Bool, '~/own', QoSProfile(depth=3))
        self.create_publisher(Bool, self.get_name() + '_state', 1)
        self.create_subscription(String, '/heard', print, 1)
        if self.declare_parameter('resets', False).value:
            self.create_service(Empty, 'reset', print)


def main():
    rclpy.init()
    node = Talker()
    print('ready', flush=True)
    rclpy.spin(node)
"""
SEVERAL = """import rclpy
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node
from std_msgs.msg import Bool, String


def main():
    rclpy.init()
    executor = SingleThreadedExecutor()
    for number in range(7):
        node = Node(f'n{number}', namespace=f'/group{number % 2}')
        node.create_publisher(Bool, 'out', 1)
        node.create_subscription(String, f'{node.get_namespace()}/x/n{number + 1}', print, 1)
        executor.add_node(node)
    print('ready', flush=True)
    executor.spin()
"""
STARTED = (
    ("talker", "", "", (), {}),
    ("talker", "one", "/", (("chatter/a", "/first"), ("chatter/a", "/second")), {}),
    ("talker", "two", "/deep/er", (("~/own", "mine"), ("/heard", "heard")), {"topic": "/spoken"}),
    ("talker", "three", "", (("one:chatter/a", "no"), ("three:chatter/b", "~/b")),
     {"resets": True}),
    ("talker", "four", "/deep", (("reset", "again"),), {"resets": True, "use_sim_time": True}),
    ("talker", "five", "/deep", (("five_state", "state"),), {"suffixes": ["c"]}),
    ("several", "", "", (("out", "/group1/in"),), {}),
    ("several", "", "/all", (), {}),
)  # fmt: skip
"""Of each process: the program, its node's name and namespace, remaps and parameters."""


def launch():
    """Return a launch file in Python that starts all."""
    nodes = "".join(
        f"        Node(package='app', executable='{program}', name={name or None!r}, "
        f"namespace={space or None!r}, remappings={list(remaps)!r}, parameters=[{given!r}]),\n"
        for program, name, space, remaps, given in STARTED
    )
    imports = "from launch import LaunchDescription\nfrom launch_ros.actions import Node\n"
    body = f"    return LaunchDescription([\n{nodes}    ])\n"
    return f"{imports}\n\ndef generate_launch_description():\n{body}"


def words(name, space, remaps, given):
    """Return the arguments that a launch gives to a process (docs.ros.org: ROS arguments)."""
    named = [("__node", name)] if name else []
    placed = [("__ns", space)] if space else []
    rules = [("-r", f"{a}:={b}") for a, b in (*named, *placed, *remaps)]
    values = [("-p", f"{key}:={yaml(value)}") for key, value in given.items()]
    return ["--ros-args", *(word for pair in (*rules, *values) for word in pair)]


def yaml(value):
    return str(value).lower() if isinstance(value, bool) else str(value)


@pytest.fixture
def package(tmp_path):
    top = tmp_path / "app"
    (top / "app").mkdir(parents=True)
    manifest = "<package><name>app</name><export><build_type>ament_python</build_type></export>"
    entries = [f"{name} = app.{name}:main" for name in ("talker", "several")]
    (top / "package.xml").write_text(f"{manifest}</package>")
    (top / "setup.py").write_text(f"setup(entry_points={{'console_scripts': {entries}}})")
    (top / "app" / "__init__.py").write_text("")
    (top / "app" / "talker.py").write_text(TALKER)
    (top / "app" / "several.py").write_text(SEVERAL)
    (top / "app.launch.py").write_text(launch())
    return top


def content(graph):
    """Return what is compared: nodes, endpoints and services, and what of them is implicit."""
    ends = {(e.node, e.topic, e.direction, e.type, e.implicit) for e in graph.endpoints}
    services = {(s.node, s.name, s.type, s.implicit) for s in graph.services}
    return {node.name for node in graph.nodes}, ends, services


def test_the_graph_of_the_source_is_that_of_the_running_app(package, tmp_path, monkeypatch):
    monkeypatch.setenv("ROS_AUTOMATIC_DISCOVERY_RANGE", "LOCALHOST")
    with Ros2(tmp_path) as ros2:
        for program, *rest in STARTED:
            run = f"from app.{program} import main; main()"
            process = ros2.spawn(sys.executable, "-c", run, *words(*rest), PYTHONPATH=str(package))
            wait_for(lambda p=process: "ready" in p.log or p.ended, what=program)
            assert not process.ended, process.log
        live = Ros2LiveSource(ros2.domain, LONG_S).read()
    launched = [(package / "app.launch.py", {})]
    static = scan_ros2_app([package], launched, {}, ScanOptions(workers=1))
    assert static.unresolved == ()
    for ours, real in zip(content(static), content(live), strict=True):
        assert ours - real == set()
        assert real - ours == set()
    assert len(live.nodes) == NODES
