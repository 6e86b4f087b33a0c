"""A guarded Python launch file, run against the double of launch and launch_ros."""

import shutil

import pytest
from wrapped_launch import DOUBLE, HEAD, REMAPS, launch, rules

HANDLED = (
    "RegisterEventHandler(OnProcessExit(on_exit={}, handle_once=True)), ExecuteProcess(cmd=['ls'])"
)
TELEOP = "teleop:/cmd_vel:=/rtron/cmd_vel/teleop"
BASE = "base:/cmd_vel:=/rtron/cmd_vel/out"


def node(name, *, kind="Node", **more):
    given = "".join(f", {key}={value}" for key, value in more.items())
    named = "" if name is None else f", name={name!r}"
    return f"{kind}(package='p', executable='x'{named}{given})"


def component(name, **more):
    given = "".join(f", {key}={value}" for key, value in more.items())
    named = "" if name is None else f", name={name!r}"
    return f"ComposableNode(package='p', plugin='P'{named}{given})"


def own(launched):
    return [rules(command) for command in launched["started"]]


def test_publisher_and_successor_in_one_launch_get_names_of_their_own(guarded):
    launched = guarded(f"{node('teleop')}, {node('base')}")
    assert own(launched) == [[TELEOP, BASE], [TELEOP, BASE]]
    assert launched["error"] == ""
    assert launched["told"] == []


def test_the_rules_come_before_the_nodes_own_and_before_those_of_its_arguments(guarded):
    remapped = "[('cmd_vel', '/elsewhere')]"
    arguments = "['one', '--ros-args', '-r', 'a:=b', '--', 'two']"
    launched = guarded(node("teleop", remappings="[('c', 'd')]", arguments=arguments))
    [command] = launched["started"]
    assert command[:3] == ["/opt/ros/lib/p/x", "one", "--ros-args"]
    assert rules(command)[-2:] == ["a:=b", "c:=d"]
    assert rules(command)[0] == TELEOP
    launched = guarded(node("teleop", remappings=remapped))
    assert TELEOP not in own(launched)[0]


@pytest.mark.parametrize(
    ("written", "expected"),
    [
        ("[('out', '/cmd_vel')]", "teleop:/out:=/rtron/cmd_vel/teleop"),
        ("[('out', 'cmd_vel')]", "teleop:/out:=/rtron/cmd_vel/teleop"),
        ("[('~/out', '/cmd_vel')]", "teleop:/teleop/out:=/rtron/cmd_vel/teleop"),
        ("[('rostopic://out', '/cmd_vel')]", "teleop:/out:=/rtron/cmd_vel/teleop"),
        ("[('teleop:out', '/cmd_vel')]", "teleop:/out:=/rtron/cmd_vel/teleop"),
        ("[('{node}/out', '/cmd_vel')]", "teleop:/teleop/out:=/rtron/cmd_vel/teleop"),
    ],
)
def test_a_rule_that_leads_to_the_guarded_name_leads_to_the_private_one(guarded, written, expected):
    assert expected in own(guarded(node("teleop", remappings=written)))[0]


def test_rules_do_not_chain_and_the_first_counts(guarded):
    remapped = "[('out', '/other'), ('out', '/cmd_vel'), ('other:out2', '/cmd_vel')]"
    [found] = own(guarded(node("teleop", remappings=remapped)))
    assert not any("/out:=/rtron" in rule or "out2:=/rtron" in rule for rule in found)
    assert TELEOP in found


def test_set_remap_hits_publisher_and_successor_and_each_still_gets_its_own(guarded):
    launched = guarded(f"SetRemap('out', '/cmd_vel'), {node('teleop')}, {node('base')}")
    first, second = own(launched)
    assert first.index("teleop:/out:=/rtron/cmd_vel/teleop") < first.index("out:=/cmd_vel")
    assert second.index("base:/out:=/rtron/cmd_vel/out") < second.index("out:=/cmd_vel")


def test_nodes_of_one_name_in_two_namespaces(guarded):
    table = {
        "/a/teleop": {"/cmd_vel": "/rtron/cmd_vel/first"},
        "/b/teleop": {"/cmd_vel": "/rtron/cmd_vel/second"},
    }
    pushed = f"GroupAction([PushROSNamespace('b'), {node('teleop')}])"
    third = node("teleop", namespace="'/c'")
    body = f"{node('teleop', namespace=repr('a'))}, {pushed}, {third}"
    launched = guarded(body, table=table)
    assert own(launched) == [
        ["teleop:/cmd_vel:=/rtron/cmd_vel/first"],
        ["teleop:/cmd_vel:=/rtron/cmd_vel/second"],
        [],
    ]


def test_a_node_of_no_name_gets_the_rules_of_all_it_may_be(guarded):
    [found] = own(guarded(node(None)))
    assert found == [TELEOP, BASE]


def test_what_nobody_can_tell_apart_ends_the_launch_and_does_not_start(guarded):
    table = {"/a/t": {"/x": "/rtron/x/one"}, "/b/t": {"/x": "/rtron/x/two"}}
    launched = guarded(node(None), table=table)
    assert "cannot tell whose t:/x is" in launched["error"]
    assert launched["started"] == []
    assert own(guarded(node("other"), table=table)) == [[]]


def test_of_two_of_one_name_the_one_in_the_namespace_itself_is_meant(guarded):
    table = {"/t": {"/x": "/rtron/x/one"}, "/b/t": {"/x": "/rtron/x/two"}}
    first, second = node(None), node(None, namespace="'b'")
    assert own(guarded(f"{first}, {second}", table=table)) == [
        ["t:/x:=/rtron/x/one"],
        ["t:/x:=/rtron/x/two"],
    ]


def test_another_node_in_the_process_of_a_named_one(guarded):
    table = {**REMAPS, "/costs/costs": {"/map": "/rtron/map/out"}}
    [found] = own(guarded(node("controller"), table=table))
    assert "costs:/map:=/rtron/map/out" in found


def test_a_pattern_takes_the_name_that_is_given_at_the_start(guarded):
    table = {"/rviz*": {"/goal": "/rtron/goal/rviz"}}
    launched = guarded(f"{node('rviz_77')}, {node('other')}, {node(None)}", table=table)
    assert own(launched) == [["rviz_77:/goal:=/rtron/goal/rviz"], [], []]


@pytest.mark.parametrize(
    "later",
    [
        "TimerAction(period=1.0, actions=[{}])",
        HANDLED.format("[{}]"),
        HANDLED.format("lambda event, context: {}"),
        "OpaqueFunction(function=lambda context: [{}])",
        "GroupAction([{}], forwarding=False)",
        "GroupAction([GroupAction([TimerAction(period=1.0, actions=[{}])], scoped=False)])",
    ],
)
def test_what_starts_later_or_deeper_is_guarded_too(guarded, later):
    launched = guarded(later.format(node("teleop")))
    assert TELEOP in own(launched)[-1]
    assert (launched["error"], launched["shutdown"]) == ("", False)


def test_a_timer_is_guarded_where_timers_ran_before(guarded, tmp_path):
    guarded(f"TimerAction(period=1.0, actions=({node('teleop')},))")
    outer = tmp_path / "outer.launch.py"
    include = "IncludeLaunchDescription(AnyLaunchDescriptionSource('{}'))"
    imported = "from launch.launch_description_sources import AnyLaunchDescriptionSource\n"
    first = "TimerAction(period=1.0, actions=[])"
    inner = include.format(tmp_path / "guarded.launch.py")
    outer.write_text(imported + HEAD.format(f"{first}, {inner}"))
    assert TELEOP in own(launch(outer))[0]


def test_a_handler_of_the_app_can_still_be_unregistered(guarded):
    handler = f"(h := OnProcessExit(on_exit=[{node('teleop')}]))"
    body = f"RegisterEventHandler({handler}), UnregisterEventHandler(h), ExecuteProcess(cmd=['ls'])"
    launched = guarded(body)
    assert launched["error"] == ""
    assert launched["started"] == [["ls"]]


UNSEEN = (
    "OpaqueFunction(function=lambda context: context.emit_event_sync("
    "launch.events.IncludeLaunchDescription(LaunchDescription([{}]))))"
)


@pytest.mark.parametrize("on_exit", ["[{}]", "{}", "lambda event, context: [{}]"])
def test_what_starts_when_a_process_ends_is_guarded_too(guarded, on_exit):
    inside = on_exit.format(node("teleop"))
    launched = guarded(f"ExecuteProcess(cmd=['ls'], on_exit={inside})")
    assert TELEOP in own(launched)[-1]
    assert launched["shutdown"] is False


def test_a_node_that_the_wrapper_cannot_see_ends_the_launch(guarded):
    launched = guarded(UNSEEN.format(node("teleop")))
    assert "without its rules" in launched["shutdown"]
    launched = guarded(UNSEEN.format(node("nobody")))
    assert launched["shutdown"] is False


def test_components_that_the_wrapper_cannot_see_end_the_launch(guarded):
    load = "LoadComposableNodes(target_container='/box', composable_node_descriptions=[{}])"
    launched = guarded(UNSEEN.format(load.format(component("teleop"))))
    assert "was loaded into a container" in launched["shutdown"]
    launched = guarded(load.format(component("teleop")))
    assert launched["shutdown"] is False


@pytest.mark.parametrize("named", [[], ["--ros-args", "-r", "__node:=teleop"]])
def test_ros2_run_as_a_process_is_a_node_as_well(guarded, named):
    cmd = ["/opt/ros/bin/ros2", "run", "p", "x", "arg", *named]
    launched = guarded(f"ExecuteProcess(cmd={cmd})")
    assert TELEOP in own(launched)[0]
    assert launched["started"][0][:5] == cmd[:5]
    assert not any("no rules" in told for told in launched["told"])


@pytest.mark.parametrize(
    "cmd",
    [["ros2 run p x --ros-args -r __node:=teleop"], ["gzserver"], ["ros2", "launch", "p", "x"]],
)
def test_a_process_that_gets_no_rules_is_told(guarded, cmd):
    launched = guarded(f"ExecuteProcess(cmd={cmd}, shell=True)")
    assert launched["started"] == [cmd]
    assert "get no rules: " + " ".join(cmd) in launched["told"][0]


def test_of_the_guard_itself_nothing_is_told(guarded):
    launched = guarded(f"{node('teleop')}, {node('base')}", guard="d/guard")
    assert launched["told"] == []


def test_components_get_the_rules_in_their_load_requests_before_their_own(guarded):
    inside = component("teleop", remappings="[('out', '/cmd_vel'), ('c', 'd')]")
    other = component("other", remappings="[('out', '/cmd_vel')]")
    container = node("box", kind="ComposableNodeContainer", namespace="''")
    nodes = f"[{inside}, {other}]"
    launched = guarded(container[:-1] + f", composable_node_descriptions={nodes})")
    first, second = launched["loaded"]
    expected = ["teleop:/out:=/rtron/cmd_vel/teleop", TELEOP]
    assert first["rules"] == [*expected, "out:=/cmd_vel", "c:=d"]
    assert second["rules"] == ["out:=/cmd_vel"]
    assert launched["error"] == ""


def test_components_by_namespace_condition_and_set_remap(guarded):
    table = {
        "/a/teleop": {"/cmd_vel": "/rtron/cmd_vel/first"},
        "/b/teleop": {"/cmd_vel": "/rtron/cmd_vel/second"},
    }
    a = component("teleop", namespace="'a'")
    b = component("teleop", namespace="'/b'")
    off = component("teleop", namespace="'/b'", condition="IfCondition('false')")
    load = "LoadComposableNodes(target_container='/box', composable_node_descriptions=[{}])"
    first, second = load.format(f"{a}, {off}"), load.format(b)
    body = f"SetRemap('out', '/cmd_vel'), {first}, {second}"
    first, second = (one["rules"] for one in guarded(body, table=table)["loaded"])
    assert first == [
        "teleop:/a/out:=/rtron/cmd_vel/first",
        "teleop:/cmd_vel:=/rtron/cmd_vel/first",
        "out:=/cmd_vel",
    ]
    assert second[0] == "teleop:/b/out:=/rtron/cmd_vel/second"


def test_components_of_one_name_in_one_load(guarded):
    table = {
        "/a/teleop": {"/cmd_vel": "/rtron/cmd_vel/first"},
        "/b/teleop": {"/cmd_vel": "/rtron/cmd_vel/second"},
    }
    nodes = ", ".join(component("teleop", namespace=f"'/{space}'") for space in "ab")
    load = f"LoadComposableNodes(target_container='/x', composable_node_descriptions=[{nodes}])"
    first, second = (one["rules"] for one in guarded(load, table=table)["loaded"])
    assert first == ["teleop:/cmd_vel:=/rtron/cmd_vel/first"]
    assert second == ["teleop:/cmd_vel:=/rtron/cmd_vel/second"]


def test_what_a_load_shares_with_others_stays_and_a_load_that_is_off_is_not_read(guarded):
    load = "LoadComposableNodes(target_container='/x', composable_node_descriptions=[{}]{})"
    off = load.format(component("LC"), ", condition=IfCondition('false')")
    off = off.replace("'LC'", "LaunchConfiguration('nowhere')")
    body = f"SetRemap('a', 'b'), {load.format(component('teleop'), '')}, {off}, {node('other')}"
    launched = guarded(body)
    assert [one["rules"] for one in launched["loaded"]] == [[TELEOP, "a:=b"]]
    assert own(launched)[0][-1] == "a:=b"


def test_the_rules_of_one_load_reach_no_other(guarded):
    load = "LoadComposableNodes(target_container='/box', composable_node_descriptions=[{}])"
    stranger = node("stranger", namespace="'/n'")
    launched = guarded(f"{load.format(component('teleop'))}, {stranger}")
    assert own(launched) == [[]]


def test_an_action_that_hides_its_components_ends_the_launch(guarded):
    launched = guarded(
        "type('Hidden', (LoadComposableNodes,), {'__init__': lambda self: Action.__init__(self)})()"
    )
    assert "cannot see" in launched["error"]


def test_arguments_are_shown_required_and_handed_over(guarded):
    named = node("teleop").replace("'teleop'", "LaunchConfiguration('n')")
    body = f"DeclareLaunchArgument('n'), DeclareLaunchArgument('m', default_value='x'), {named}"
    launched = guarded(body, "n:=teleop")
    assert launched["arguments"] == ["n", "m"]
    assert TELEOP in own(launched)[0]
    assert "missing required argument 'n'" in guarded(body)["error"]


def test_the_guard_starts_first_and_gets_no_rule(guarded, tmp_path):
    launched = guarded(node("teleop"), guard="it's.d/guard")
    assert launched["started"][0] == [f"{tmp_path}/it's.d/guard"]


def test_a_node_of_the_plan_that_never_starts_is_told(guarded):
    assert "/base" in guarded(node("teleop"))["told"][0]


@pytest.mark.parametrize(
    ("file", "name"),
    [
        ("actions/__init__.py", "ros_remaps"),
        ("actions/load_composable_nodes.py", "__composable_node_descriptions"),
        ("descriptions.py", "__remappings"),
    ],
)
def test_another_launch_ros_starts_nothing(guarded, tmp_path, file, name):
    guarded(node("teleop"))
    other = tmp_path / "double"
    shutil.copytree(DOUBLE, other)
    changed = other / "launch_ros" / file
    changed.write_text(changed.read_text().replace(name, f"{name}_now"))
    launched = launch(tmp_path / "guarded.launch.py", double=other)
    assert "does not know this launch_ros" in launched["error"] or "cannot see" in launched["error"]
    assert launched["started"] == []
