"""XML and YAML launch files, read to all that the graph of an app asks for."""

import pytest
from app_launch_values import names, values, whys

from rtron.sources.launch.common.launch_file import find_ros2_launch_files
from rtron.sources.launch.ros2.result import StartKind

COMPONENT = """<composable_node pkg="p" plugin="P::{0}" name="{0}" namespace="c" {1}>
  <remap from="in" to="out"/><param name="k" value="1"/>
  <extra_arg name="use_intra_process_comms" value="true"/></composable_node>"""


def test_a_node_with_all_it_can_be_given(xml, package):
    (package / "p.yaml").write_text("/**: {ros__parameters: {file: $(var x)}}")
    app = xml(
        """<arg name="x" default="7"/><set_remap from="a" to="b"/>
        <node pkg="p" exec="e" name="n" namespace="ns" args="-d $(var x)_'y z' -- z"
              ros_args="-p q:=2">
          <param name="one" value="$(var x)"/><param name="text" value="$(var x)" type="str"/>
          <param name="deep"><param name="er" value="1.5"/></param>
          <param name="list" value="a;b" value-sep=";"/>
          <param from="$(find-pkg-share pkg)/p.yaml" allow_substs="true"/>
          <remap from="in" to="out"/><env name="K" value="v"/></node>"""
    )
    [node] = app.starts
    assert (node.kind, node.full_name) == (StartKind.NODE, "/ns/n")
    assert node.arguments == ("-d", "7_y z", "--", "z", "--ros-args", "-p", "q:=2")
    assert node.remaps == (("a", "b"), ("in", "out"))
    assert node.environ == (("K", "v"),)
    assert values(node) == {
        "q": 2,
        "one": 7,
        "text": "7",
        "deep.er": 1.5,
        "list": ["a", "b"],
        "file": 7,
    }
    assert app.unresolved == ()


@pytest.mark.parametrize(("type", "value"), [("float", 1.0), ("int", 1), ("str", "1")])
def test_the_type_of_a_value(xml, type, value):
    app = xml(f'<node pkg="p" exec="e"><param name="one" value="1" type="{type}"/></node>')
    found = values(app.starts[0])["one"]
    assert repr(found) == repr(value)


def test_the_same_in_yaml(read):
    app = read(
        """launch:
- arg: {name: x, default: '7'}
- set_remap: {from: a, to: b}
- group:
    - push_ros_namespace: {namespace: g}
    - node:
        pkg: p
        exec: e
        name: n
        namespace: ns
        args: -d $(var x)
        param:
        - {name: one, value: $(var x)}
        - {name: list, value: [1, 2]}
        - {name: texts, value: ['1', b]}
        - {name: deep, param: [{name: er, value: 1.5}]}
        remap:
        - {from: in, to: out}
        env:
        - {name: K, value: v}
""",
        "yaml",
    )
    [node] = app.starts
    assert node.full_name == "/g/ns/n"
    assert node.arguments == ("-d", "7")
    assert node.remaps == (("a", "b"), ("in", "out"))
    assert node.environ == (("K", "v"),)
    assert values(node) == {"one": 7, "list": [1, 2], "texts": ["1", "b"], "deep.er": 1.5}
    assert app.unresolved == ()


def test_containers_and_components(xml):
    app = xml(
        f"""<node_container pkg="c" exec="box" name="box" namespace="ns">
        {COMPONENT.format("one", "")}</node_container>
        <load_composable_node target="/ns/box">{COMPONENT.format("two", 'if="true"')}
        {COMPONENT.format("three", 'if="false"')}</load_composable_node>"""
    )
    container, one, two = app.starts
    assert container.kind is StartKind.CONTAINER
    assert [part.container for part in (one, two)] == ["/ns/box"] * 2
    assert [part.full_name for part in (one, two)] == ["/c/one", "/c/two"]
    assert one.remaps == (("in", "out"),)
    assert values(one) == {"k": 1}
    assert one.extra_arguments["use_intra_process_comms"].value is True


def test_components_with_a_lifecycle(xml, read):
    """They have an element of their own since Lyrical."""
    component = COMPONENT.format("one", "").replace("composable_node", "composable_lifecycle_node")
    app = xml(
        f"""<node_container pkg="c" exec="box" name="box">{component}</node_container>
        <load_composable_node target="/box">{component}</load_composable_node>"""
    )
    assert [(part.full_name, part.container) for part in app.starts[1:]] == [("/c/one", "/box")] * 2
    app = read(
        """
launch:
- load_composable_node:
    target: /box
    composable_lifecycle_node:
    - {pkg: p, plugin: P, name: two}
""",
        "yaml",
    )
    assert [(part.full_name, part.container) for part in app.starts] == [("/two", "/box")]


def test_an_argument_that_is_true_or_false(xml):
    """It has an element of its own since Lyrical."""
    node = '<node pkg="p" exec="e" name="n" if="$(var on)"/>'
    declared = '<bool_arg name="on" default="false" description="whether"/>'
    assert names(xml(declared + node)) == []
    app = xml(declared + node, on="TRUE")
    assert names(app) == ["/n"]
    assert [(one.name, one.default) for one in app.arguments] == [("on", "false")]


def test_settings_for_all_nodes_in_a_group(xml, package):
    (package / "p.yaml").write_text("/**: {ros__parameters: {file: 1}}")
    app = xml(
        f"""<group><push-ros-namespace namespace="g"/><set_parameter name="a" value="1"/>
        <set_parameters_from_file filename="{package}/p.yaml"/>
        <set_env name="E" value="x"/><let name="l" value="m"/>
        <node pkg="p" exec="e" name="$(var l)"/></group><node pkg="p" exec="e" name="n"/>"""
    )
    inner, outer = app.starts
    assert inner.full_name == "/g/m"
    assert values(inner) == {"a": 1, "file": 1}
    assert inner.environ == (("E", "x"),)
    assert (outer.full_name, values(outer), outer.environ) == ("/n", {}, ())


def test_conditions_that_are_known_and_one_that_is_not(xml):
    node = '<node pkg="p" exec="e" name="{}" {}/>'
    app = xml(
        f"""<arg name="on" default="true"/>{node.format("a", 'if="$(var on)"')}
        {node.format("b", 'unless="$(var on)"')}{node.format("c", 'if="$(env NO)"')}
        {node.format("d", 'if="perhaps"')}"""
    )
    assert names(app) == ["/a", "/c", "/d"]
    assert [start.is_uncertain for start in app.starts] == [False, True, True]
    assert any("whether it counts is not known (env NO)" in why for why in whys(app))
    assert any("launch would refuse it" in why for why in whys(app))


def test_a_process_and_a_timer(xml):
    app = xml(
        """<timer period="1"><node pkg="p" exec="late" name="late"/></timer>
        <executable cmd="gz sim $(env W w)"><env name="K" value="v"/></executable>
        <executable cmd="ros2 run p e --ros-args -r __ns:=/x"/>"""
    )
    process, run, late = app.starts
    assert (process.kind, process.arguments) == (StartKind.PROCESS, ("gz", "sim", "w"))
    assert process.environ == (("K", "v"),)
    assert (run.package, run.program, run.full_name) == ("p", "e", "/x/*")
    assert late.name == "late"


@pytest.mark.parametrize("owner", ["p", "$(env P p)"])
def test_a_process_that_is_a_program_of_a_package_is_its_node(xml, owner):
    app = xml(f'<executable cmd="$(exec-in-pkg e {owner}) a --ros-args -r __node:=n"/>')
    (run,) = app.starts
    assert (run.kind, run.package, run.program, run.full_name) == (StartKind.NODE, "p", "e", "/n")
    assert run.arguments == ("a", "--ros-args", "-r", "__node:=n")
    assert not app.unresolved


@pytest.mark.parametrize("words", ["gdb $(exec-in-pkg e p)", "$(exec-in-pkg e p)x", "$(exec-in"])
def test_a_process_with_a_program_of_a_package_elsewhere_stays_one(xml, words):
    assert [start.kind for start in xml(f'<executable cmd="{words}"/>').starts] == [
        StartKind.PROCESS
    ]


def test_a_required_argument_of_the_root_file(xml):
    text = '<arg name="a"/><arg name="b" default="$(var a)_b"/><node pkg="p" exec="$(var b)"/>'
    app = xml(text)
    assert app.starts[0].program == "{a}_b"
    assert [(one.name, one.default) for one in app.arguments] == [("a", None), ("b", "{a}_b")]
    assert xml(text, a="x").starts[0].program == "x_b"


def test_an_action_that_is_not_known(xml):
    app = xml('<launch_it_all name="x"/><node pkg="p" exec="e" name="n"/>')
    assert names(app) == ["/n"]
    [note] = app.unresolved
    assert (note.what, note.evidence[0].line) == ("launch_it_all x", 1)


@pytest.mark.parametrize(
    ("name", "text", "listed"),
    [
        ("a.launch.xml", "<launch/>", True),
        ("launch.yaml", "launch: []", True),
        ("a.launch.py", "def generate_launch_description(): pass", True),
        ("bringup.py", "def generate_launch_description(): pass", True),
        ("a.launch.py", "from b import generate_launch_description", True),
        ("bringup.py", "from b import generate_launch_description", False),
        ("a.launch.py", "x = 1", False),
        ("a.launch", "<launch/>", False),
        ("a.xml", "<launch/>", False),
    ],
)
def test_which_files_are_launch_files(tmp_path, name, text, listed):
    (tmp_path / "deep").mkdir()
    (tmp_path / "deep" / name).write_text(text)
    found = [tmp_path / "deep" / name] if listed else []
    assert list(find_ros2_launch_files([tmp_path])) == found


def test_what_a_build_made_is_not_searched(tmp_path):
    for folder in ("install", "build", ".git"):
        (tmp_path / folder).mkdir()
        (tmp_path / folder / "a.launch.xml").write_text("<launch/>")
    assert find_ros2_launch_files([tmp_path]) == ()


@pytest.mark.parametrize(
    ("args", "words"),
    [
        ("a b c", ("a", "b", "c")),
        ("$(var x)", ("-d file",)),
        ("$(var x) $(var y)", ("-d file", "w")),
        ("$(var x)$(var y) b", ("-d filew", "b")),
        ("a=$(var y) b$(var y)c d", ("a=w", "bwc", "d")),
        ("  a  $(var y)/'b c' ", ("a", "w/b c")),
        ("", ()),
    ],
)
def test_the_words_of_a_command_line_are_those_before_it_is_evaluated(xml, args, words):
    declared = '<arg name="x" default="-d file"/><arg name="y" default="w"/>'
    app = xml(f'{declared}<node pkg="p" exec="e" args="{args}"/><executable cmd="r {args}"/>')
    assert [start.arguments for start in app.starts] == [words, ("r", *words)]
