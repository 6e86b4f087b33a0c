"""The actions of Python launch files, each read as launch and launch_ros run it."""

import pytest
from app_launch_values import names, values, whys

from rtron.sources.launch.ros2.result import StartKind

NODE = "Node(package='p', executable='e', name='{}')"


def test_a_node_with_all_it_can_be_given(python):
    app = python(
        """Node(package='p', executable='e', name='n', namespace='ns', arguments=['-d', 'x'],
             ros_arguments=['--log-level', 'info'], parameters=[{'a': 1}],
             remappings=[('in', 'out'), ('/tf', 'tf')], additional_env={'K': 'v'})"""
    )
    [node] = app.starts
    assert (node.kind, node.package, node.program) == (StartKind.NODE, "p", "e")
    assert node.full_name == "/ns/n"
    assert node.arguments == ("-d", "x", "--ros-args", "--log-level", "info")
    assert node.remaps == (("in", "out"), ("/tf", "tf"))
    assert node.environ == (("K", "v"),)
    assert values(node) == {"a": 1}
    assert app.unresolved == ()


def test_where_a_node_stands(python, package):
    [node] = python("\n" + NODE.format("n")).starts
    lines = (package / "launch" / "app.launch.py").read_text().splitlines()
    assert "Node(" in lines[node.evidence.line - 1]
    assert node.evidence.file.endswith("app.launch.py")


def test_a_node_that_names_itself(python):
    [node] = python("Node(package='p', executable='e', namespace='ns')").starts
    assert (node.name, node.full_name) == ("", "/ns/*")


def test_names_among_the_arguments_count_first(python):
    words = "['--ros-args', '-r', '__node:=other', '-r', '__ns:=/deep', '-r', 'a:=b', '-p', 'k:=3']"
    [node] = python(
        f"Node(executable='e', name='n', arguments={words}, remappings=[('c', 'd')])"
    ).starts
    assert node.full_name == "/deep/other"
    assert node.remaps == (("a", "b"), ("c", "d"))
    assert values(node) == {"k": 3}


@pytest.mark.parametrize(
    ("attributes", "rule", "full_name"),
    [
        ("", "('__node', 'other')", "/other"),
        ("name='n'", "('__node', 'other')", "/n"),
        ("name='n', namespace='ns'", "('__ns', '/deep')", "/deep/n"),
        ("name='n'", "('__ns', '/deep'), ('__ns', '/second')", "/deep/n"),
    ],
)
def test_names_among_the_remaps_are_no_topics(python, attributes, rule, full_name):
    """launch_ros writes a name before the remaps and a namespace behind them; the first counts."""
    [node] = python(f"Node(executable='e', remappings=[{rule}, ('c', 'd')], {attributes})").starts
    assert node.full_name == full_name
    assert node.remaps == (("c", "d"),)


def test_a_pushed_namespace_ends_with_its_group(python):
    inner = (
        f"PushRosNamespace('a'), {NODE.format('in')}, PushROSNamespace('b'), {NODE.format('deep')}"
    )
    absolute = "Node(executable='e', name='abs', namespace='/x')"
    app = python(f"GroupAction([{inner}, {absolute}]), {NODE.format('out')}")
    assert names(app) == ["/a/in", "/a/b/deep", "/x/abs", "/out"]


@pytest.mark.parametrize(
    ("flags", "after"), [("", "/n"), (", scoped=False", "/a/n"), (", forwarding=False", "/n")]
)
def test_the_scope_of_a_group(python, flags, after):
    app = python(f"GroupAction([PushRosNamespace('a')]{flags}), {NODE.format('n')}")
    assert names(app) == [after]


def test_a_group_that_forwards_nothing_but_what_it_is_given(python):
    name = "[LaunchConfiguration('x'), LaunchConfiguration('y', default='z')]"
    configured = NODE.replace("'{}'", name)
    group = f"GroupAction([{configured}], forwarding=False, launch_configurations={{'x': 'k'}})"
    assert names(python(f"SetLaunchConfiguration('y', 'w'), {group}")) == ["/kz"]


def test_remaps_for_all_nodes_stand_before_their_own(python):
    own = "Node(executable='e', name='n', remappings=[('c', 'd')])"
    app = python(
        f"SetRemap(src='a', dst='b'), {own}, ComposableNodeContainer(package='p', "
        "executable='e', name='box', namespace='', composable_node_descriptions=["
        "ComposableNode(package='p', plugin='P', name='c')])"
    )
    node, container, component = app.starts
    assert node.remaps == (("a", "b"), ("c", "d"))
    assert container.remaps == component.remaps == (("a", "b"),)


@pytest.mark.parametrize(
    ("condition", "starts"),
    [
        ("IfCondition('true')", True),
        ("IfCondition(LaunchConfiguration('yes'))", True),
        ("UnlessCondition(LaunchConfiguration('yes'))", False),
        ("IfCondition(PythonExpression(['not ', LaunchConfiguration('yes')]))", False),
        ("LaunchConfigurationEquals('yes', 'True')", True),
        ("LaunchConfigurationEquals('yes', 'no')", False),
        ("LaunchConfigurationNotEquals('yes', 'no')", True),
        ("LaunchConfigurationEquals('other', 'x')", False),
        (
            "IfCondition(NotSubstitution(EqualsSubstitution(LaunchConfiguration('yes'), 'true')))",
            False,
        ),
    ],
)
def test_conditions_that_are_known(python, condition, starts):
    declared = "DeclareLaunchArgument('yes', default_value='True')"
    app = python(f"{declared}, Node(executable='e', name='n', condition={condition})")
    assert names(app) == (["/n"] if starts else [])
    assert app.unresolved == ()
    if starts:
        [node] = app.starts
        assert not node.is_uncertain


def test_a_condition_that_is_not_known_is_read_as_true_and_noted(python):
    condition = "IfCondition(Command(['which', 'robot']))"
    app = python(f"GroupAction([{NODE.format('n')}], condition={condition}), {NODE.format('m')}")
    inner, outer = app.starts
    assert inner.is_uncertain
    assert not outer.is_uncertain
    assert any("read as if it did" in why for why in whys(app))
    assert any("is not run" in why for why in whys(app))


def test_a_value_set_under_an_unknown_condition_is_not_known(python):
    unknown = "condition=IfCondition(EnvironmentVariable('SIM'))"
    app = python(
        "SetLaunchConfiguration('exe', 'real'), "
        f"SetLaunchConfiguration('exe', 'sim', {unknown}), "
        "Node(package='p', executable=LaunchConfiguration('exe'), name='n')"
    )
    assert app.starts[0].program == "{exe}"


def test_arguments_and_what_they_are_by_default(python):
    declared = "DeclareLaunchArgument('name', default_value=['a', '_b'], description='who')"
    app = python(f"{declared}, Node(executable='e', name=LaunchConfiguration('name'))")
    assert names(app) == ["/a_b"]
    [argument] = app.arguments
    assert (argument.name, argument.default) == ("name", "a_b")
    given = python(f"{declared}, Node(executable='e', name=LaunchConfiguration('name'))", name="c")
    assert names(given) == ["/c"]


def test_an_argument_that_is_true_or_false_and_a_new_environment(python):
    """Actions that are there since Lyrical."""
    app = python(
        "DeclareBooleanLaunchArgument('on', default_value=True), "
        "ReplaceEnvironmentVariables({'WHO': EnvironmentVariable('WHO', default_value='a')}), "
        "Node(executable='e', name=EnvironmentVariable('WHO'), "
        "condition=IfCondition(LaunchConfiguration('on')))"
    )
    assert names(app) == ["/a"]
    assert app.arguments[0].default == "True"
    assert app.unresolved == ()


def test_an_argument_that_must_be_given_stands_in_braces(python):
    declared = "DeclareLaunchArgument('robot')"
    space = "namespace=['fleet/', LaunchConfiguration('robot')]"
    app = python(f"{declared}, Node(executable='e', name='n', {space})")
    assert names(app) == ["/fleet/{robot}/n"]
    assert whys(app) == ["argument 'robot' is not given"]
    assert app.arguments[0].default is None


def test_an_argument_that_is_read_counts_as_one_that_can_be_given(python):
    app = python(
        "DeclareLaunchArgument('name', default_value='a'), "
        "Node(executable='e', name=LaunchConfiguration('other', default='b'))"
    )
    assert app.declared == {"name", "other"}


def test_containers_and_the_components_loaded_into_them(python):
    component = (
        "ComposableNode(package='p', plugin='P::{0}', name='{0}', parameters=[{{'k': '{0}'}}], "
    )
    component += "remappings=[('x', 'y')], extra_arguments=[{{'use_intra_process_comms': True}}])"
    app = python(
        "ComposableNodeContainer(package='rclcpp_components', executable='component_container', "
        f"name='box', namespace='ns', composable_node_descriptions=[{component.format('one')}]), "
        f"LoadComposableNodes(target_container='ns/box', composable_node_descriptions=["
        f"{component.format('two')}])"
    )
    container, *components = app.starts
    assert container.kind is StartKind.CONTAINER
    assert [one.container for one in components] == ["/ns/box"] * 2
    assert [one.full_name for one in components] == ["/one", "/two"]
    assert components[0].program == "P::one"
    assert values(components[1]) == {"k": "two"}
    assert components[1].extra_arguments["use_intra_process_comms"].value is True


def test_components_of_a_container_that_is_given_itself_and_under_conditions(program):
    app = program("""
def generate_launch_description():
    box = ComposableNodeContainer(package='c', executable='e', name='box', namespace='/ns')
    parts = [ComposableNode(package='p', plugin=name, name=name, condition=IfCondition(on))
             for name, on in (('A', 'true'), ('B', 'false'))]
    return LaunchDescription([
        box, LoadComposableNodes(target_container=box, composable_node_descriptions=parts)])
""")
    assert [(one.full_name, one.container) for one in app.starts] == [
        ("/ns/box", ""),
        ("/A", "/ns/box"),
    ]


def test_lifecycle_nodes_and_processes(python):
    app = python(
        "LifecycleNode(package='p', executable='e', name='life', namespace=''), "
        "ExecuteProcess(cmd=['gz', 'sim', ['world:=', LaunchConfiguration('w', default='a')]]), "
        "ExecuteProcess(cmd=['ros2 run pkg exe --ros-args -r __node:=n -r a:=b -p k:=true'])"
    )
    life, process, run = app.starts
    assert life.kind is StartKind.LIFECYCLE_NODE
    assert (process.kind, process.arguments) == (StartKind.PROCESS, ("gz", "sim", "world:=a"))
    assert (run.kind, run.package, run.program, run.full_name) == (
        StartKind.NODE,
        "pkg",
        "exe",
        "/n",
    )
    assert (run.remaps, values(run)) == ((("a", "b"),), {"k": True})


def test_a_process_that_is_a_program_of_a_package_is_its_node(python):
    program = "ExecutableInPackage(package='p', executable='e')"
    app = python(f"ExecuteProcess(cmd=[{program}, 'a b', '--depth', '1'])")
    (run,) = app.starts
    assert (run.kind, run.package, run.program) == (StartKind.NODE, "p", "e")
    assert run.arguments == ("a b", "--depth", "1")
    assert not app.unresolved


def test_the_environment_that_is_set_before_a_node(python):
    app = python(
        "SetEnvironmentVariable('A', '1'), AppendEnvironmentVariable('P', 'x'), "
        f"{NODE.format('n')}, UnsetEnvironmentVariable('A'), {NODE.format('m')}",
        environ={"P": "w"},
    )
    assert [node.environ for node in app.starts] == [(("A", "1"), ("P", "w:x")), (("P", "w:x"),)]


@pytest.mark.parametrize(
    "handler",
    [
        "OnProcessExit(target_action=first, on_exit=[then])",
        "OnProcessStart(target_action=first, on_start=then)",
        "OnExecutionComplete(target_action=first, on_completion=[then])",
        "OnStateTransition(target_lifecycle_node=first, goal_state='active', entities=[then])",
        "OnProcessExit(on_exit=lambda event, context: [then])",
    ],
)
def test_what_starts_on_an_event(program, handler):
    app = program(f"""
def generate_launch_description():
    first, then = {NODE.format("first")}, {NODE.format("then")}
    late = RegisterEventHandler({handler})
    return LaunchDescription([late, first])
""")
    assert names(app) == ["/first", "/then"]
    assert app.unresolved == ()


def test_timers_run_in_their_order_and_a_process_may_say_what_comes_after_it(python):
    timed = f"TimerAction(period=5.0, actions=[{NODE.format('late')}])"
    period = "LaunchConfiguration('t', default='1')"
    sooner = f"TimerAction(period={period}, actions=[{NODE.format('soon')}])"
    after = f"ExecuteProcess(cmd=['x'], on_exit=[{NODE.format('after')}])"
    app = python(f"{timed}, {sooner}, {after}, {NODE.format('now')}")
    assert [one.name for one in app.starts] == ["", "now", "after", "soon", "late"]


def test_actions_that_start_nothing_are_no_matter(python):
    silent = "LogInfo(msg='x'), EmitEvent(event=Shutdown()), Shutdown(), SetROSLogDir('x'), "
    silent += "SetUseSimTime(True)"
    assert python(silent).unresolved == ()


def test_who_an_event_is_for_starts_nothing(program):
    app = program("""
from launch.events import matches_action
from launch_ros.events.lifecycle import ChangeState
def generate_launch_description():
    first = LifecycleNode(package="p", executable="e", name="first", namespace="")
    change = ChangeState(lifecycle_node_matcher=matches_action(first), transition_id=1)
    return LaunchDescription([first, EmitEvent(event=change)])
""")
    assert names(app) == ["/first"]
    assert app.unresolved == ()
    assert [(fact.kind, fact.value) for fact in app.wiring] == [("transition", "first")]


@pytest.mark.parametrize(
    ("event", "values"),
    [
        ("Shutdown()", []),
        ("ShutdownProcess(process_matcher=matches_action(None))", []),
        ("ChangeState(lifecycle_node_matcher=matches_node_name('/ns/slam'))", ["slam"]),
        ("ChangeState(lifecycle_node_matcher=lambda action: True)", [""]),
        ("Other()", [""]),
    ],
)
def test_an_event_that_changes_a_state(program, event, values):
    app = program(f"""
from launch.events import Shutdown, matches_action
from launch.events.process import ShutdownProcess
from launch_ros.events.lifecycle import ChangeState
from launch_ros.events.matchers import matches_node_name
from other import Other
def generate_launch_description():
    return LaunchDescription([EmitEvent(event={event})])
""")
    assert [fact.value for fact in app.wiring] == values


def test_a_node_that_the_launch_activates(python):
    node = "LifecycleNode(package='p', executable='e', name='n', namespace=''{})"
    assert not python(node.format("")).wiring
    assert [fact.value for fact in python(node.format(", autostart=True")).wiring] == ["n"]


def test_an_action_of_another_package_is_noted(python):
    app = python("Robot(), " + NODE.format("n"), before="from robot_launch import Robot")
    assert names(app) == ["/n"]
    [note] = app.unresolved
    assert "robot_launch.Robot" in note.what
    assert note.why == "is not known here: what it starts is not known"
    assert note.hides == "nodes"


@pytest.mark.parametrize("text", ['f"{WHEELS}"', "str(WHEELS)", '"{}".format(WHEELS)'])
def test_an_expression_looks_into_a_dict_that_is_written_as_text(python, text):
    found = python(
        f"DeclareLaunchArgument('model', default_value='b'), Node(package='p', executable='e', "
        f"name=PythonExpression([{text}, \"['\", LaunchConfiguration('model'), \"']\"]))",
        "WHEELS = {'a': 'small', 'b': 'big'}",
    )
    assert names(found) == ["/big"]
    assert found.unresolved == ()
