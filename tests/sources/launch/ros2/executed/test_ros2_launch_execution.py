"""Launch files that are executed by the double of launch: nothing of them is started.

`RTRON_LAUNCH` has the folders of a real launch and launch_ros, and of what they import (a
PYTHONPATH), with which these tests run instead, in a Python that has rclpy.
"""

import json
import os
import shutil
import sys
from pathlib import Path

import pytest
from app_launch_values import names, values, whys
from harness import lives

from rtron.errors import InputError, SourceError
from rtron.sources.code.workspace_sources import WorkspaceSources
from rtron.sources.launch.ros2.app import read_app_launch
from rtron.sources.launch.ros2.executed.execution import Execution, is_incomplete
from rtron.sources.launch.ros2.result import StartKind
from rtron.sources.workspace import read_workspace
from rtron.vocabulary import UnknownValue

DOUBLE = Path(__file__).parents[4] / "ros2" / "launch_double"
LAUNCH = os.environ.get("RTRON_LAUNCH", str(DOUBLE))
HEAD = """
import os, subprocess, sys, time
from launch import LaunchDescription
from launch.actions import *
from launch.conditions import IfCondition, UnlessCondition
from launch.event_handlers import *
from launch.launch_description_sources import *
from launch.substitutions import *
from launch_ros.actions import *
from launch_ros.descriptions import ComposableNode
"""
NODE = "Node(package='p', executable='e', name={})"


class Folder:
    """A package with a launch file, and what executing it tells."""

    def __init__(self, package, tmp_path):
        self.package, self.mark = package, tmp_path / "mark"
        self.path = package / "launch" / "app.launch.py"
        self.files = WorkspaceSources(read_workspace([package.parent], {}))

    def write(self, actions, before=""):
        body = f"def generate_launch_description():\n    return LaunchDescription([{actions}])\n"
        self.path.write_text(f"{HEAD}{before}\n{body}")

    def execute(self, actions, before="", seconds=30, environ=None, **arguments):
        self.write(actions, before)
        found = {"PYTHONPATH": LAUNCH, "MARK": str(self.mark), **(environ or {})}
        execution = Execution(python=sys.executable, seconds=seconds)
        return execution.launch(self.path, arguments, found, self.files)

    def read(self, **arguments):
        return read_app_launch(self.path, arguments, {}, self.files)


@pytest.fixture
def app(package, tmp_path):
    return Folder(package, tmp_path)


def told(start):
    """Return what a start is, without what only reading, or only executing, knows of it."""
    return (
        *(start.kind, start.package, start.program, start.full_name, start.has_namespace),
        *(start.remaps, start.arguments, start.environ),
        *(start.container, start.awaited_event, values(start), start.extra_arguments),
        start.evidence,
    )


EVERYTHING = """
DeclareLaunchArgument('n', default_value='me', description='who'),
SetLaunchConfiguration('m', LaunchConfiguration('n')),
PushRosNamespace('robot'),
SetRemap('/tf', 'tf'),
Node(package='a', executable='x', name='one', namespace='ns', prefix='nice -n 3',
     arguments=['--foo', LaunchConfiguration('n'), '--ros-args', '-r', 'in:=out'],
     remappings=[('a', 'b'), ('c', LaunchConfiguration('m'))],
     parameters=[{'p': 1, 'q': [1, 2], 'r': 'text', 's': LaunchConfiguration('m')}],
     additional_env={'LEVEL': '3'}),
ComposableNodeContainer(
    name='box', namespace='', package='rclcpp_components', executable='component_container',
    composable_node_descriptions=[
        ComposableNode(package='c', plugin='c::C', name='c', remappings=[('x', 'y')],
                       parameters=[{'f': 2.5}], extra_arguments=[{'ipc': True}]),
        ComposableNode(package='c', plugin='c::D', name='d', condition=IfCondition('false'))]),
LoadComposableNodes(target_container='/other/box', composable_node_descriptions=[
    ComposableNode(package='c', plugin='c::E', name='e', namespace='/else')]),
LifecycleNode(package='l', executable='l', name='life', namespace=''),
ExecuteProcess(cmd=['gz', 'sim', '-r'], additional_env={'A': 'b'}),
ExecuteProcess(cmd=['ros2', 'run', 'p', 'e', '--ros-args', '-r', '__node:=run']),
ExecuteProcess(cmd=['sleep 1;', 'ros2 run s e --ros-args --param k:=2 > log'], shell=True),
Node(package='no', executable='no', condition=UnlessCondition('true')),
TimerAction(period=5.0, actions=[Node(package='t', executable='t', name='late')]),
"""


def test_the_same_as_reading(app):
    executed = app.execute(EVERYTHING, n="you")
    read = app.read(n="you")
    assert [told(start) for start in executed.starts] == [told(start) for start in read.starts]
    assert len(executed.starts) == 10
    assert not is_incomplete(read)
    assert executed.unresolved == read.unresolved == ()
    assert all(start.executed for start in executed.starts)
    assert executed.arguments == read.arguments


def test_what_reading_leaves_open_is_known(app):
    before = "import hashlib\nname = 'n' + hashlib.sha1(b'x').hexdigest()[:6]"
    executed = app.execute(NODE.format("name"), before)
    assert names(executed) == ["/n11f6ad"]
    assert is_incomplete(app.read())
    assert executed.unresolved == ()


@pytest.mark.parametrize(
    "node",
    [
        "package=LaunchConfiguration('no'), executable='e'",
        "package='p', executable='e', arguments=[open('/etc/x').read()]",
        "package='p', executable='e', parameters=[{'a': open('/etc/x').read()}]",
        "package='p', executable='e', parameters=[sys.argv[0]]",
        "package='p', executable='e', remappings=[('a', open('/etc/x').read())]",
        "package='p', executable='e', condition=IfCondition(sys.argv[0])",
    ],
)
def test_what_reading_leaves_open_is_seen(app, node):
    app.write(f"Node({node})")
    assert is_incomplete(app.read())


def test_nothing_is_started(app):
    touch = f"'{sys.executable}', '-c', 'import os; open(os.environ[\"MARK\"], \"w\")'"
    actions = f"""
        ExecuteProcess(cmd=[{touch}]),
        Node(executable='{sys.executable}', arguments=['-c', 'import os; os.mkdir("{app.mark}")']),
        {NODE.format("Command(['touch ', '" + str(app.mark) + "'])")},
        LifecycleNode(package='l', executable='l', name='life', namespace=''),
    """
    executed = app.execute(actions)
    assert [start.kind for start in executed.starts] == [
        *(StartKind.PROCESS, StartKind.NODE, StartKind.NODE, StartKind.LIFECYCLE_NODE)
    ]
    assert not app.mark.exists()
    assert executed.starts[2].name.startswith("{command touch /")
    command = f"touch {app.mark}"
    assert whys(executed) == [f"$(command {command[:80]}) is not run"]


@pytest.mark.parametrize(
    ("file", "name"),
    [
        ("launch/actions/execute_local.py", "async_execute_process"),
        ("launch_ros/ros_adapters.py", "ROSAdapter"),
        ("launch_ros/actions/load_composable_nodes.py", "__target_container"),
    ],
)
def test_another_launch_library_starts_nothing(app, tmp_path, file, name):
    other = tmp_path / "double"
    shutil.copytree(DOUBLE, other)
    changed = other / file
    changed.write_text(changed.read_text().replace(name, f"{name}_now"))
    load = "LoadComposableNodes(target_container='c', composable_node_descriptions=[])"
    with pytest.raises(InputError, match=name):
        app.execute(
            f"ExecuteProcess(cmd=['touch', '{app.mark}']), {load}",
            environ={"PYTHONPATH": str(other)},
        )
    assert not app.mark.exists()


def test_handlers_of_processes_run_in_their_order(app):
    before = "first = " + NODE.format("'first'")
    body = f"""
        first,
        RegisterEventHandler(OnProcessExit(target_action=first, on_exit=[{NODE.format("'b'")}])),
        RegisterEventHandler(OnProcessStart(target_action=first, on_start=[
            Shutdown(), {NODE.format("'a'")}])),
        RegisterEventHandler(OnProcessExit(
            target_action=first,
            on_exit=lambda event, context: [{NODE.format("'c'")}, TimerAction(period=9.0, actions=[
                {NODE.format("'d'")}])])),
        RegisterEventHandler(OnProcessExit(
            target_action=lambda action: False, on_exit=[OpaqueFunction(function=print)])),
    """
    executed = app.execute(body, before)
    assert [(start.name, start.awaited_event) for start in executed.starts] == [
        ("first", ""),
        ("a", "OnProcessStart"),
        ("c", "OnProcessExit"),
        ("b", "OnProcessExit"),
        ("d", "timer"),
    ]
    (note,) = executed.unresolved
    assert note.why == "OnProcessExit: its event does not come while nothing runs"
    assert note.evidence[0].line > 0


def test_packages_of_the_source_are_found_and_stand_where_they_lie(app):
    (app.package / "params.yaml").write_text("/**:\n  ros__parameters:\n    a: 1\n")
    (app.package / "launch" / "in.launch.py").write_text(f"{HEAD}\n" + INCLUDED)
    before = """
def share(name):
    for prefix in os.environ['AMENT_PREFIX_PATH'].split(':'):
        if os.path.exists(f'{prefix}/share/ament_index/resource_index/packages/{name}'):
            return f'{prefix}/share/{name}'
"""
    actions = (
        "IncludeLaunchDescription(AnyLaunchDescriptionSource(share('pkg')+'/launch/in.launch.py'),"
        " launch_arguments=[('map', share('pkg') + '/map.yaml')]),"
        "Node(package='p', executable='e', parameters=[share('pkg') + '/params.yaml'])"
    )
    executed = app.execute(actions, before)
    inner, outer = executed.starts
    assert inner.arguments == (f"{app.package}/map.yaml",)
    assert inner.evidence.file == f"{app.package}/launch/in.launch.py"
    (parameter,) = outer.parameters().values()
    assert (parameter.value, parameter.evidence.file) == (1, f"{app.package}/params.yaml")
    assert parameter.evidence.line == 3
    (included,) = executed.includes
    assert included.file == f"{app.package}/launch/in.launch.py"
    assert included.arguments == (("map", f"{app.package}/map.yaml"),)


def test_a_parameter_file_that_is_not_there_is_noted(app):
    app_launch = app.execute("Node(package='p', executable='e', parameters=['/no/p.yaml'])")
    assert whys(app_launch) == ["/no/p.yaml is no file here: its parameters are not known"]
    assert values(app_launch.starts[0]) == {}


INCLUDED = """
def generate_launch_description():
    return LaunchDescription([
        Node(package='i', executable='i', arguments=[LaunchConfiguration('map')])])
"""


def test_what_launch_makes_up_is_a_pattern(app):
    assert names(app.execute(NODE.format("AnonName('n')"))) == ["/n_*"]


def test_a_robot_of_xacro_is_described_and_xacro_not_run(app):
    (app.package / "r.xacro").write_text("<robot name='r'><link name='base'/></robot>")
    command = f"Command(['xacro ', '{app.package}/r.xacro'])"
    described = f"parameters=[{{'d': {command}, 'e': Command('which gz')}}]"
    executed = app.execute(f"Node(package='p', executable='e', {described})")
    found = values(executed.starts[0])
    assert '<link name="base">' in found["d"]
    assert found["e"] == UnknownValue("{command which gz}")
    assert whys(executed) == ["$(command which gz) is not run"]


def test_what_a_command_prints_may_not_decide_unseen(app):
    condition = "IfCondition(PythonExpression([\"'\", Command('which gz'), \"' == ''\"]))"
    with pytest.raises(InputError, match="`which gz` is not run, and what it prints decides"):
        app.execute(f"Node(package='p', executable='e', condition={condition})")


@pytest.mark.parametrize(
    ("actions", "before", "line", "said"),
    [
        (NODE.format("1 / 0"), "", -1, "ZeroDivisionError: division by zero"),
        ("", "raise ValueError('my text')", 11, "ValueError: my text"),
        ("", "import no_such_module", 11, "ModuleNotFoundError: No module named 'no_such_module'"),
        ("", "import json\njson.loads('{')", 12, "JSONDecodeError"),
        ("", "def (", 11, "SyntaxError"),
        ("OpaqueFunction(function=lambda context: [][1])", "", -1, "IndexError: list index"),
        ("DeclareLaunchArgument('needed')", "", 0, "missing required argument 'needed'"),
        ("", "sys.exit('enough')", 11, "SystemExit: enough"),
    ],
)
def test_an_exception_is_told_with_its_place(app, actions, before, line, said):
    with pytest.raises(InputError) as raised:
        app.execute(actions, before)
    last = len(app.path.read_text().splitlines())
    assert raised.value.reason.startswith("launch ends: ")
    assert said in raised.value.reason
    assert (raised.value.path, raised.value.line) == (str(app.path), last if line < 0 else line)
    assert "without --execute-launch" in raised.value.help


def test_what_it_prints_disturbs_nothing(app):
    before = "print('{}')\nsys.stdout.write('x' * 100_000)\nos.write(1, b'{')\nos.write(2, b'e')"
    assert names(app.execute(NODE.format("'n'"), before)) == ["/n"]


SLEEPER = "import os, time; open(os.environ['MARK'], 'w').write(str(os.getpid())); time.sleep(600)"
AWAY = f"""
subprocess.Popen([sys.executable, '-c', {SLEEPER!r}], start_new_session=True)
while not (os.path.exists(os.environ['MARK']) and open(os.environ['MARK']).read()):
    time.sleep(0.01)
"""


def test_all_that_a_launch_file_starts_itself_ends_with_it(app):
    assert names(app.execute(NODE.format("'n'"), AWAY)) == ["/n"]
    assert not lives(app.mark.read_text())


def test_a_launch_file_that_does_not_end_is_ended(app):
    with pytest.raises(SourceError, match=r"app.launch.py: it did not end within 3 s"):
        app.execute(NODE.format("'n'"), f"{AWAY}\nwhile True: pass", seconds=3)
    assert not lives(app.mark.read_text())


def test_a_launch_file_that_ends_python_is_told(app):
    with pytest.raises(SourceError, match="ended without a word: last words"):
        app.execute("", "os.write(2, b'last words')\nos._exit(0)")


def test_no_trace_stays_behind(app, tmp_path, monkeypatch):
    temporary = tmp_path / "temporary"
    temporary.mkdir()
    monkeypatch.setattr("tempfile.tempdir", str(temporary))
    app.execute("Node(package='p', executable='e', parameters=[{'a': 1}])")
    assert list(temporary.iterdir()) == []
    assert {path.name for path in app.path.parent.iterdir()} == {"app.launch.py"}


FORGED = """
import tempfile
folder = os.path.dirname(tempfile.gettempdir())
open(folder + '/result.json', 'w').write({!r})
"""


def forged(app, change):
    """Return the exception for a launch file that writes the visit's result itself."""
    text = json.dumps({**EMPTY, **change})
    before = FORGED.format(text) + "os._exit(0)"
    with pytest.raises(SourceError) as raised:
        app.execute("", before)
    return str(raised.value)


EMPTY = {
    "schema": "rtron.visit/1",
    **{key: [] for key in ("starts", "arguments", "includes", "notes", "commands")},
    "error": None,
    "missing": "",
}
PLACE = {"file": "f", "line": 1}
START = {"kind": "node", "words": [], "environ": {}, "event": "", "place": PLACE}


@pytest.mark.parametrize(
    ("change", "said"),
    [
        ({"schema": "other"}, "schema: Input should be 'rtron.visit/1'"),
        ({"more": 1}, "more: Extra inputs are not permitted"),
        ({"starts": {}}, "starts: Input should be a valid"),
        ({"starts": [{**START, "kind": "x"}]}, "starts.0: Input tag 'x'"),
        ({"starts": [{**START, "place": {"file": "f", "line": -1}}]}, "line: Input should be"),
        ({"starts": [{**START, "words": [1]}]}, "words.0: Input should be a valid string"),
        ({"starts": [{**START, "program": "x" * 65_537}]}, "at most 65536 characters"),
        ({"starts": [START] * 2_001}, "starts: Tuple should have at most 2000"),
        ({"commands": ["x" * 2**24]}, "wrote a file larger than 16 MiB"),
    ],
)
def test_a_forged_result_is_checked(app, change, said):
    assert said in forged(app, change)


def test_a_forged_result_costs_little(app):
    (app.package / "r.xacro").write_text(f"<robot name='{'x' * 60_000}'/>")
    commands = [f"xacro {app.package}/r.xacro"]
    mark, other = "rtron_command_0_output", "rtron_command_7_output"
    words = [mark * 2_900, mark, other]
    text = json.dumps({**EMPTY, "starts": [{**START, "words": words}], "commands": commands})
    before = FORGED.format(text) + "os._exit(0)"
    (start,) = app.execute("", before).starts
    assert [len(word) < 61_000 for word in start.arguments] == [True] * 3
    assert (start.arguments[0], start.arguments[2]) == ("{a long text}", "{?}")
    file = "os.path.join(tempfile.gettempdir(), 'p.yaml')"
    made = f"open({file}, 'w').write('/**: {{ros__parameters: {{a: ' + 'x' * 100_000 + '}}}}')\n"
    added = ["--params-file", "FILE"] * 200
    text = json.dumps({**EMPTY, "starts": [{**START, "added": added}]})
    before = FORGED.format(text)
    before = before.replace(repr(text), f"{text!r}.replace('FILE', {file})") + f"{made}os._exit(0)"
    with pytest.raises(InputError, match="more than 16777216 bytes"):
        app.execute("", before)


def test_a_python_without_launch(app, tmp_path):
    app.write("")
    with pytest.raises(InputError, match="launch_ros is not installed in ") as raised:
        Execution(python=sys.executable).launch(app.path, {}, {"PYTHONPATH": ""}, app.files)
    assert "source your ROS 2" in raised.value.help
    with pytest.raises(SourceError, match="No such file"):
        Execution(python=str(tmp_path / "no")).launch(app.path, {}, {}, app.files)
