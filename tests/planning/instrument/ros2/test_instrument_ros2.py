"""Guarding XML and YAML launch files of ROS 2: which remaps, what stays of the text, what is said.

What comes out is read again: there the first rule that matches a name has to be the private one.
"""

import ast

import pytest
import yaml
from wrapped_launch import HEAD, launch, rules

from rtron.errors import InputError
from rtron.planning.instrument import instrument_ros2, write_guarded_launch
from rtron.planning.instrument.common.guarded_launch import GuardFiles
from rtron.planning.instrument.ros2.launch_copies import arguments_text
from rtron.planning.plan_file.loader import parse_plan
from rtron.sources.launch.ros2.reader import read_ros2_launch
from rtron.vocabulary import LaunchInput

PLAN = """\
schema: rtron.plan/1
app: a
ros: 2
grcn:
  - id: grcn_cmd_vel
    topic: {topic}
    type: {type}
    mode: enforce
    policy: Block
    flows:
      - {{name: teleop, publisher: /teleop, priority: 2}}
      - {{name: nav, publisher: /nav/controller, priority: 1}}
    successors: [/base]
"""
PUSH = '<push_ros_namespace namespace="nav"/>'
BASE = '<node pkg="b" exec="b" name="base"/>'
TELEOP = '<node pkg="t" exec="t" name="teleop"/>'
CONTROLLER = '<node pkg="c" exec="c" name="controller" namespace="nav"/>'
OUT, FIRST, NAV = "/rtron/cmd_vel/out", "/rtron/cmd_vel/teleop", "/rtron/cmd_vel/nav"


@pytest.fixture
def guard(tmp_path):
    """Return a function that guards a launch file, writes it, and returns what it read before."""

    def guarded(text, kind="xml", *, topic="/cmd_vel", type="geometry_msgs/Twist", **arguments):
        app = tmp_path / f"app.launch.{kind}"
        app.write_text(text if kind != "xml" else f"<launch>{text}</launch>")
        tree = read_ros2_launch(app, arguments, {"WHERE": "nav"}, {"pkg": tmp_path})
        plan = PLAN.format(topic=topic, type=type)
        out = tmp_path / "out" / f"guarded.launch.{kind}"
        result = instrument_ros2(
            tree, parse_plan(plan), out, GuardFiles(plan, command=("g", "it's"))
        )
        write_guarded_launch(result)
        return result

    return guarded


def leads(path, tmp_path, **arguments):
    """Return where each node's names lead, the first rule for each."""
    found = {}
    tree = read_ros2_launch(path, arguments, {"WHERE": "nav"}, {"pkg": tmp_path})
    for node in tree.nodes():
        own = found.setdefault(node.name, {})
        for remap in node.remaps:
            own.setdefault(remap.source, remap.target)
    return found


def said(result):
    return [end.what for end in result.unenforceable]


def test_each_node_gets_its_remaps_and_all_else_stays(guard, tmp_path):
    body = f"\n  <!-- kept -->\n  {TELEOP}\n  {BASE}\n  <node pkg='o' exec='o' name='o'/>\n"
    result = guard(body + CONTROLLER)
    text = result.launch.read_text()
    assert leads(result.launch, tmp_path)["/base"] == {"/cmd_vel": OUT}
    assert leads(result.launch, tmp_path)["/teleop"] == {"/cmd_vel": FIRST}
    assert leads(result.launch, tmp_path)["/o"] == {}
    assert "  <!-- kept -->\n" in text
    assert "  <node pkg='o' exec='o' name='o'/>\n" in text
    assert said(result) == []


def test_the_guard_is_the_first_thing_started(guard):
    result = guard(TELEOP + BASE + CONTROLLER)
    assert result.launch.read_text().startswith(
        '<launch>\n  <let name="rtron_folder" value="$(dirname)/guarded.launch.d"/>\n'
        '  <include file="$(var rtron_folder)/arguments.launch.py"/>\n'
        '  <executable cmd="$(var rtron_folder)/guard" name="rtron_guard"'
    )
    script = (result.folder / "guard").read_text()
    assert script == "#!/bin/sh\nexec g 'it'\"'\"'s' --plan \"${0%/*}/rtron.yaml\"\n"
    assert (result.folder / "guard").stat().st_mode & 0o111


@pytest.mark.parametrize(
    ("inside", "expected"),
    [
        ('<remap from="out" to="/cmd_vel"/>', {"/nav/out": NAV}),
        ('<remap from="out" to="../cmd_vel"/>', {}),
        ('<remap from="cmd_vel" to="/cmd_vel"/>', {"/nav/cmd_vel": NAV}),
        ('<remap from="~/out" to="/cmd_vel"/>', {"/nav/controller/out": NAV}),
        ('<remap from="rostopic://out" to="/cmd_vel"/>', {"/nav/out": NAV}),
        ('<remap from="controller:out" to="/cmd_vel"/>', {"/nav/out": NAV}),
        ('<remap from="out" to="/x"/><remap from="out" to="/cmd_vel"/>', {"/nav/out": "/x"}),
    ],
)
def test_own_remaps_that_lead_to_the_guarded_name(guard, tmp_path, inside, expected):
    node = CONTROLLER.replace("/>", f">{inside}</node>")
    result = guard(node + BASE)
    found = leads(result.launch, tmp_path)["/nav/controller"]
    assert {**found, **expected} == found
    assert found["/cmd_vel"] == NAV


def test_a_remap_that_takes_the_name_elsewhere_is_left_and_told(guard, tmp_path):
    result = guard(TELEOP.replace("/>", '><remap from="cmd_vel" to="/x"/></node>') + BASE)
    assert leads(result.launch, tmp_path)["/teleop"] == {"/cmd_vel": "/x"}
    assert said(result) == ["/teleop"]


def test_set_remap_hits_publisher_and_successor_and_each_gets_its_own(guard, tmp_path):
    early = TELEOP.replace("/>", ' args="x &quot;a b&quot;"/>')
    result = guard(f'<set_remap from="v" to="/cmd_vel"/>{early}{BASE}{CONTROLLER}')
    found = leads(result.launch, tmp_path)
    assert (found["/teleop"]["/v"], found["/base"]["/v"]) == (FIRST, OUT)
    assert found["/nav/controller"]["/nav/v"] == NAV
    assert '-- x "a b"' in result.launch.read_text()


def test_own_remaps_of_other_nodes_do_not_hide_what_counts_first(guard, tmp_path):
    other = '<remap from="other:a" to="b"/>'
    result = guard(f'<set_remap from="v" to="/cmd_vel"/>{TELEOP[:-2]}>{other}</node>{BASE}')
    assert leads(result.launch, tmp_path)["/teleop"]["/v"] == FIRST


def test_a_node_of_no_name_under_a_set_remap_gets_its_rules_before_it(guard):
    result = guard('<set_remap from="v" to="/cmd_vel"/><node pkg="c" exec="c"/>' + TELEOP)
    text = result.launch.read_text()
    assert f'args="--ros-args -r base:v:={OUT} -r base:/cmd_vel:={OUT} -r controller:v:' in text


def test_a_set_remap_that_leaves_its_group_is_closed_as_well(guard, tmp_path):
    inside = '<group><set_remap from="v" to="/cmd_vel"/></group>'
    result = guard(inside + TELEOP)
    assert leads(result.launch, tmp_path)["/teleop"] == {"/cmd_vel": FIRST}
    result = guard(f'<set_remap from="w" to="/x"/>{inside}{TELEOP}')
    found = leads(result.launch, tmp_path)["/teleop"]
    assert found == {"/w": "/x", "/v": FIRST, "/cmd_vel": FIRST}


def test_rules_in_a_nodes_arguments_count_before_all_others(guard, tmp_path):
    args = ' args="--ros-args -r v:=/cmd_vel"'
    result = guard(TELEOP.replace("/>", f"{args}/>") + BASE)
    assert leads(result.launch, tmp_path)["/teleop"]["/v"] == FIRST
    assert said(result) == []


@pytest.mark.parametrize("tag", ["composable_node", "composable_lifecycle_node"])
def test_a_component_under_a_set_remap_is_not_reached(guard, tag):
    box = '<node_container pkg="p" exec="e" name="box" namespace="">{}</node_container>'
    component = f'<{tag} pkg="b" plugin="B" name="base"/>'
    result = guard('<set_remap from="v" to="/cmd_vel"/>' + box.format(component) + TELEOP)
    assert said(result) == ["/base"]


@pytest.mark.parametrize("tag", ["composable_node", "composable_lifecycle_node"])
def test_components_of_containers_and_loads(guard, tmp_path, tag):
    box = (
        '<node_container pkg="p" exec="e" name="box" namespace="">'
        f'<{tag} pkg="b" plugin="B" name="base"><remap from="in" to="cmd_vel"/></{tag}>'
        "</node_container>"
        '<group><push_ros_namespace namespace="nav"/><load_composable_node target="/box">'
        f'<{tag} pkg="b" plugin="C" name="controller"/>'
        f'<{tag} pkg="b" plugin="C" name="controller" namespace="/other"/>'
        "</load_composable_node></group>"
    )
    result = guard(box + TELEOP)
    found = leads(result.launch, tmp_path)
    assert found["/base"]["/in"] == OUT
    assert found["/nav/controller"] == {"/cmd_vel": NAV}
    assert found["/other/controller"] == {}


@pytest.mark.parametrize(
    "around",
    [
        '<group><push_ros_namespace namespace="nav"/>{}</group>',
        '<push-ros-namespace namespace="nav"/>{}',
        '<group scoped="false"><push_ros_namespace namespace="nav"/></group>{}',
        '<arg name="n" default="nav"/><push_ros_namespace namespace="$(var n)"/>{}',
        '<let name="n" value="nav"/><push_ros_namespace namespace="$(var n)"/>{}',
        '<push_ros_namespace namespace="$(env WHERE)"/>{}',
        '<push_ros_namespace namespace="$(env NOWHERE nav)"/>{}',
        "<push_ros_namespace namespace=\"$(var n 'nav')\"/>{}",
        "<push_ros_namespace namespace=\"$(eval &quot;'na' + 'v'&quot;)\"/>{}",
        '<push_ros_namespace namespace="/nav/" if="$(not false)"/>{}',
        '<push_ros_namespace namespace="x"/><push_ros_namespace namespace="/nav"/>{}',
        f'<group><push_ros_namespace namespace="x"/></group>{PUSH}{{}}',
        f'<push_ros_namespace namespace="x"/><group forwarding="false">{PUSH}{{}}</group>',
        f'<group><push_ros_namespace namespace="x"/><timer period="1.0">{PUSH}{{}}</timer></group>',
    ],
)
def test_namespaces_and_scopes(guard, tmp_path, around):
    node = '<node pkg="c" exec="c" name="$(var who controller)"/>'
    result = guard(around.format(node) + BASE)
    assert leads(result.launch, tmp_path)["/nav/controller"] == {"/cmd_vel": NAV}


@pytest.mark.parametrize(
    ("condition", "starts"),
    [
        ('if="true"', True),
        ('if="1"', True),
        ('if="$(var on)"', True),
        ('unless="$(var on)"', False),
        ('if="$(and $(var on) false)"', False),
        ("if=\"$(eval '$(var on)' == 'x')\"", None),
    ],
)
def test_conditions(guard, condition, starts):
    node = TELEOP.replace("/>", f" {condition}/>")
    if starts is None:
        with pytest.raises(InputError):
            guard('<arg name="on" default="true"/>' + node + BASE)
        return
    result = guard('<arg name="on" default="true"/>' + node + BASE)
    assert any(remap.node == "/teleop" for remap in result.remaps) is starts


def test_an_unknown_condition_counts_as_true_and_is_noted(guard):
    result = guard(TELEOP.replace("/>", ' if="$(command ls)"/>') + BASE)
    assert any(remap.node == "/teleop" for remap in result.remaps)
    assert any("$(command" in note for note in result.notes)


@pytest.mark.parametrize(
    "set_to", ['<let name="n" value="$(command ls)"/>', '<arg name="n" default="$(command ls)"/>']
)
def test_what_is_set_to_something_unknown_is_not_a_missing_argument(guard, set_to):
    pushed = '<push_ros_namespace namespace="$(var n)"/>'
    text = guard(f"{set_to}<group>{pushed}{TELEOP}</group>{BASE}").launch.read_text()
    assert f'<remap from="teleop:/cmd_vel" to="{FIRST}"/>' in text


def test_a_node_without_a_name_gets_rules_that_begin_with_the_missing_names(guard, tmp_path):
    result = guard('<node pkg="c" exec="c"/>' + TELEOP)
    text = result.launch.read_text()
    assert f'<remap from="base:/cmd_vel" to="{OUT}"/>' in text
    assert f'<remap from="controller:/cmd_vel" to="{NAV}"/>' in text
    assert "teleop:/cmd_vel" not in text
    assert any("has no name" in note for note in result.notes)


def test_a_namespace_that_only_the_launch_knows_is_matched_by_the_name(guard):
    node = CONTROLLER.replace('"nav"', '"$(command hostname)"')
    text = guard(node + BASE).launch.read_text()
    assert f'<remap from="controller:/cmd_vel" to="{NAV}"/>' in text


def test_the_five_names_of_an_action_move_below_its_private_name(guard, tmp_path):
    type = "nav2_msgs/action/NavigateToPose"
    result = guard(TELEOP + BASE + CONTROLLER, topic="/go", type=type)
    assert said(result) == []
    found = leads(result.launch, tmp_path)
    ends = ("send_goal", "cancel_goal", "get_result", "feedback", "status")
    assert found["/teleop"] == {f"/go/_action/{e}": f"/rtron/go/teleop/_action/{e}" for e in ends}
    assert found["/base"] == {f"/go/_action/{e}": f"/rtron/go/out/_action/{e}" for e in ends}


def test_includes_are_led_to_changed_copies_others_stay(guard, tmp_path):
    (tmp_path / "in.launch.xml").write_text(
        f'<launch><node pkg="x" exec="$(dirname)/x" name="n"/>{TELEOP}</launch>'
    )
    (tmp_path / "still.launch.xml").write_text("<launch><log message='hi'/></launch>")
    include = '<include file="$(dirname)/{}.launch.xml"><arg name="a" value="b"/></include>'
    result = guard(include.format("in") + include.format("still") + BASE)
    text = result.launch.read_text()
    assert f'file="$(var rtron_folder {result.folder})/01_in.launch.xml"' in text
    assert f'file="{tmp_path}/still.launch.xml"' in text
    assert f'exec="{tmp_path}/x"' in (result.folder / "01_in.launch.xml").read_text()
    assert leads(result.launch, tmp_path)["/teleop"] == {"/cmd_vel": FIRST}


def test_an_included_python_launch_file_is_wrapped_and_its_nodes_are_guarded(guard, tmp_path):
    node = "Node(package='t', executable='t', name='teleop')"
    (tmp_path / "app.py").write_text(HEAD.format(node))
    result = guard('<include file="$(find-pkg-share pkg)/app.py"/>' + BASE)
    assert said(result) == []
    assert any("/teleop" in note for note in result.notes)
    launched = launch(result.folder / "01_app.py")
    assert f"teleop:/cmd_vel:={FIRST}" in rules(launched["started"][0])


def test_a_python_launch_file_as_the_root(guard, tmp_path):
    nodes = ", ".join(f"Node(package='p', executable='e', name='{n}')" for n in ("teleop", "base"))
    result = guard(HEAD.format(nodes), "py")
    launched = launch(result.launch)
    assert launched["started"][0] == [f"{result.folder}/guard"]
    assert f"base:/cmd_vel:={OUT}" in rules(launched["started"][2])
    assert {(r.node, r.target) for r in result.remaps} >= {("/teleop", FIRST), ("/base", OUT)}
    assert any("if a Python launch file starts them" in note for note in result.notes)


YAML = """\
# kept
launch:
- arg: {name: n, default: nav}

- group:
    - push_ros_namespace:
        namespace: $(var n)
    - node:  # the controller
        pkg: c
        exec: c
        name: controller
        remap:
        -   from: out
            to: /cmd_vel
- node: {pkg: b, exec: b, name: base, remap: [{from: in, to: /cmd_vel}]}
- node:
    pkg: "t"
    exec: 't'
    name: teleop
- node_container:
    pkg: p
    exec: e
    name: box
    namespace: ''
    composable_node:
      - pkg: b
        plugin: B
        name: other
"""


def test_yaml_is_changed_in_place(guard, tmp_path):
    result = guard(YAML, "yaml")
    text = result.launch.read_text()
    found = leads(result.launch, tmp_path)
    assert found["/nav/controller"] == {"/nav/out": NAV, "/cmd_vel": NAV}
    assert found["/base"] == {"/in": OUT, "/cmd_vel": OUT}
    assert found["/teleop"] == {"/cmd_vel": FIRST}
    assert found["/other"] == found["/box"] == {}
    kept = [line for line in YAML.splitlines() if "name: base" not in line]
    left = iter(text.splitlines())
    assert all(any(line.strip() in other for other in left) for line in kept)
    let, check, guard, *_ = yaml.safe_load(text)["launch"]
    folder = {"name": "rtron_folder", "value": "$(dirname)/guarded.launch.d"}
    assert let == {"let": folder}
    assert check == {"include": {"file": "$(var rtron_folder)/arguments.launch.py"}}
    assert guard["executable"]["cmd"] == "$(var rtron_folder)/guard"
    assert all(isinstance(value, str) for value in guard["executable"].values())


def test_yaml_with_set_remap_children_and_include(guard, tmp_path):
    (tmp_path / "in.launch.yml").write_text("launch: [{node: {pkg: t, exec: t, name: teleop}}]")
    text = (
        "launch:\n  children:\n    - set_remap: {from: v, to: /cmd_vel}\n"
        "    - include:\n        file: $(dirname)/in.launch.yml\n"
        "    - node: {pkg: b, exec: b, name: base, args: 'x y'}\n"
    )
    result = guard(text, "yml")
    found = leads(result.launch, tmp_path)
    assert (found["/teleop"]["/v"], found["/base"]["/v"]) == (FIRST, OUT)
    assert "-- x y" in result.launch.read_text()


@pytest.mark.parametrize(
    ("kind", "text", "why"),
    [
        ("xml", b"<!DOCTYPE l [<!ENTITY a 'b'>]><launch>&a;</launch>", "document type"),
        ("xml", b"<launch><node></launch>", "not XML"),
        ("xml", b"<launch>\xff\xfe</launch>", "not XML"),
        ("xml", b"<robot/>", "begins with <robot>"),
        ("xml", b"<launch>" + b" " * 2**20 + b"</launch>", "larger than"),
        ("xml", b'<launch><node pkg="a" exec="b" name="$(var"/></launch>', "without `"),
        ("xml", b'<launch><log if="maybe" message=""/></launch>', "neither true nor false"),
        ("xml", b'<launch><log if="' + b"$(not " * 50 + b'"/></launch>', "in each other"),
        ("xml", b'<launch><let name="a" value="' + b"x" * 20000 + b'"/></launch>', "longer"),
        ("yaml", b"launch: [&a {node: {}}, *a]", "anchors"),
        ("yaml", b"launch: " + b"[" * 80 + b"]" * 80, "levels"),
        ("yaml", b"launch:\n- node: {a: b\n", "not YAML"),
        ("yaml", b"launch: [\xff]", "not UTF-8"),
        ("yaml", b"a: 1\nb: 2", "one root"),
        ("yaml", b"launch: [1]", "one key"),
        ("yaml", b"launch: []\n" + b"#" * 300_000, "larger than"),
        ("yaml", b"", "one root"),
    ],
)
def test_hostile_files_are_refused_with_their_place(tmp_path, kind, text, why):
    app = tmp_path / f"app.launch.{kind}"
    app.write_bytes(text)
    with pytest.raises(InputError, match=why) as caught:
        read_ros2_launch(app, {}, {}, {})
    assert str(app) in str(caught.value)


def test_a_file_that_includes_itself_ends(tmp_path):
    app = tmp_path / "app.launch.xml"
    app.write_text('<launch><include file="$(filename)"/></launch>')
    tree = read_ros2_launch(app, {}, {}, {})
    assert any("include each other" in one.why for one in tree.unresolved)
    app.write_text('<launch><include file="$(filename)"/><include file="$(filename)"/></launch>')
    with pytest.raises(InputError, match="includes itself"):
        read_ros2_launch(app, {}, {}, {})


def test_a_missing_argument_is_named(tmp_path):
    app = tmp_path / "app.launch.xml"
    app.write_text('<launch><arg name="map"/></launch>')
    with pytest.raises(InputError) as caught:
        read_ros2_launch(app, {}, {}, {})
    assert caught.value.help == "add map:=…"


@pytest.mark.parametrize("out", ["app.launch.xml", "g.launch.yaml", "a b.launch.xml", "g"])
def test_what_cannot_be_the_output(tmp_path, out):
    app = tmp_path / "app.launch.xml"
    app.write_text(f"<launch>{BASE}</launch>")
    plan = PLAN.format(topic="/cmd_vel", type="geometry_msgs/Twist")
    tree = read_ros2_launch(app, {}, {}, {})
    with pytest.raises(InputError):
        instrument_ros2(tree, parse_plan(plan), tmp_path / out, GuardFiles(plan))


@pytest.mark.parametrize(("kind", "text"), [("xml", TELEOP), ("py", HEAD), ("yaml", YAML)])
def test_a_guarded_launch_is_not_guarded_again(guard, tmp_path, kind, text):
    result = guard(text, kind)
    tree = read_ros2_launch(result.launch, {}, {}, {})
    plan = PLAN.format(topic="/cmd_vel", type="geometry_msgs/Twist")
    with pytest.raises(InputError, match="guard already"):
        instrument_ros2(tree, parse_plan(plan), tmp_path / f"g2.launch.{kind}", GuardFiles(plan))


def test_other_arguments_than_those_it_was_made_for_end_the_launch(guard, tmp_path):
    robots = {"a": TELEOP, "b": BASE}
    for name, text in robots.items():
        (tmp_path / f"{name}.launch.xml").write_text(f"<launch>{text}</launch>")
    result = guard('<arg name="r" default="a"/><include file="$(dirname)/$(var r).launch.xml"/>')
    check = result.folder / "arguments.launch.py"
    assert launch(check)["error"] == launch(check, "r:=a", "map:=house")["error"] == ""
    error = launch(check, "r:=b")["error"]
    assert "not guarded for r:=b instead of r:=a: run `rtron instrument` again" in error
    assert "ros_namespace:=x" in launch(check, "ros_namespace:=x")["error"]


def test_another_environment_than_that_it_was_made_for_ends_the_launch(guard, monkeypatch):
    result = guard(f'<push_ros_namespace namespace="$(env WHERE)"/>{TELEOP}')
    check = result.folder / "arguments.launch.py"
    monkeypatch.setenv("WHERE", "nav")
    assert launch(check)["error"] == ""
    monkeypatch.setenv("WHERE", "it's")
    assert "WHERE:=it's instead of WHERE:=nav" in launch(check)["error"]
    monkeypatch.delenv("WHERE")
    assert "no WHERE instead of WHERE:=nav" in launch(check)["error"]


def test_what_stands_in_a_value_stays_a_text():
    odd = {"a": "__ENVIRONMENT__", "b": "__ARGUMENTS__", "c": "'\"\\\n"}
    environ = {"+exit()+": "__ARGUMENTS__"}
    choices = [
        LaunchInput(name=name, values=(value,), environment=told is environ)
        for told in (odd, environ)
        for name, value in told.items()
    ]
    tree = ast.parse(arguments_text(tuple(choices)))
    tables = [ast.literal_eval(each.value) for each in tree.body if isinstance(each, ast.Assign)]
    expected = [{name: (value,) for name, value in told.items()} for told in (odd, environ)]
    assert tables == expected


def test_a_publisher_that_no_file_starts_is_noted(guard):
    notes = guard(BASE + TELEOP).notes
    assert [note for note in notes if "/nav/controller is not started" in note]


def test_a_process_that_is_no_node_leaves_open_what_the_plan_misses(guard):
    result = guard('<executable cmd="ros2 run c controller"/>' + BASE + TELEOP)
    assert said(result) == ["/nav/controller"]
    assert "ros2 run c controller" in result.unenforceable[0].why


def test_what_looks_like_a_substitution_in_a_name_stays_text(guard):
    node = TELEOP.replace("/>", '><remap from="$(var a \'\\$(command x)\')" to="/cmd_vel"/></node>')
    text = guard(node + BASE).launch.read_text()
    assert f'<remap from="\\$(command x)" to="{FIRST}"/>' in text


@pytest.mark.parametrize("folder", ['a"b', "a$b", "a&b"])
@pytest.mark.parametrize("kind", ["xml", "yaml"])
def test_a_folder_whose_name_a_launch_file_cannot_say(tmp_path, kind, folder):
    app = tmp_path / folder / f"app.launch.{kind}"
    app.parent.mkdir()
    text = {
        "xml": "<launch><log message='$(dirname)'/></launch>",
        "yaml": "launch: [log: {m: $(dirname)}]",
    }
    app.write_text(text[kind])
    plan = PLAN.format(topic="/cmd_vel", type="geometry_msgs/Twist")
    tree = read_ros2_launch(app, {}, {}, {})
    with pytest.raises(InputError, match="cannot stand in a launch file"):
        instrument_ros2(tree, parse_plan(plan), tmp_path / f"g.launch.{kind}", GuardFiles(plan))
