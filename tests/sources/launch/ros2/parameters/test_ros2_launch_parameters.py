"""Parameters: where they come from, in which order they count, and for which nodes."""

import pytest
from app_launch_values import values, whys

from rtron.vocabulary import UnknownValue

FILE = """
/**:
  ros__parameters: {all: 1, both: all}
/ns/n:
  ros__parameters: {own: [1, 2], both: own, deep: {er: x}}
ns:
  n:
    ros__parameters: {nested: true}
  other:
    ros__parameters: {not_ours: 1}
"""


@pytest.fixture
def file(package):
    """Return a parameter file of the package."""
    path = package / "params.yaml"
    path.write_text(FILE)
    return path


def node(parameters, name="n", space="/ns"):
    """Return the text of a node with parameters."""
    return f"Node(executable='e', name='{name}', namespace='{space}', parameters=[{parameters}])"


def test_a_parameter_file_for_some_nodes(python, file):
    app = python(node(f"'{file}'") + ", " + node(f"'{file}'", "m"))
    ours, theirs = app.starts
    assert values(ours) == {"all": 1, "both": "own", "own": [1, 2], "deep.er": "x", "nested": True}
    assert values(theirs) == {"all": 1, "both": "all"}
    place = ours.parameters()["own"].evidence
    assert (place.file, place.line) == (str(file), 5)
    assert app.unresolved == ()


def test_what_stands_later_counts(python, file):
    """What is given twice below one name keeps its first place, here before the file's `/**`."""
    assert values(python(node(f"'{file}', {{'both': 'in'}}")).starts[0])["both"] == "in"
    assert values(python(node(f"{{'both': 'in'}}, '{file}'")).starts[0])["both"] == "all"


def test_a_value_in_the_launch_file_is_for_all_nodes_where_no_namespace_is_given(python, package):
    (package / "p.yaml").write_text("n: {ros__parameters: {a: file}}")
    text = f"Node(executable='e', name='n', parameters=['{package}/p.yaml', {{'a': 'in'}}])"
    [started] = python(text).starts
    assert values(started) == {"a": "in"}


@pytest.mark.parametrize(
    ("order", "expected"), [("oa", "all"), ("ao", "own"), ("oao", "all"), ("aoa", "own")]
)
def test_a_pattern_counts_by_its_first_place(python, package, order, expected):
    """As rclpy 9.1.2 and rclcpp gather the files, one after the other."""
    (package / "o.yaml").write_text("/ns/n: {ros__parameters: {a: own}}")
    (package / "a.yaml").write_text("/**: {ros__parameters: {a: all}}")
    files = ", ".join(f"'{package}/{name}.yaml'" for name in order)
    [started] = python(node(files)).starts
    assert values(started) == {"a": expected}


TWICE = """
/**: {ros__parameters: {a: 1, both: first, deep: {x: 1}}}
/other: {ros__parameters: {a: 2}}
/**: {ros__parameters: {b: 3, both: last, deep: {y: 2}}}
"""


@pytest.mark.parametrize("source", ["'{}'", "ParameterFile('{}', allow_substs=True)"])
def test_a_pattern_that_stands_twice_in_a_file(python, package, source):
    """rcl takes both sections; turtlebot3's files for Jazzy are written so."""
    (package / "p.yaml").write_text(TWICE)
    [started] = python(node(source.format(package / "p.yaml"))).starts
    assert values(started) == {"a": 1, "both": "last", "deep.x": 1, "deep.y": 2, "b": 3}


def test_of_a_pattern_that_stands_twice_a_component_takes_the_last(python, package):
    """launch_ros loads the file in Python, where one key has one value."""
    (package / "p.yaml").write_text(TWICE)
    loaded = f"ComposableNode(package='p', plugin='P', parameters=['{package}/p.yaml'])"
    app = python(
        f"LoadComposableNodes(target_container='c', composable_node_descriptions=[{loaded}])"
    )
    assert values(app.starts[0]) == {"both": "last", "deep.y": 2, "b": 3}


def test_a_component_takes_its_sources_one_after_the_other(python, file, package):
    text = "{ros__parameters: {both: last}}\n/**/n: {ros__parameters: {both: other}}"
    (package / "p.yaml").write_text(f"/**: {text}")
    component = "ComposableNode(package='p', plugin='P', name='n', namespace='ns', parameters="
    component += f"['{file}', '{package}/p.yaml'])"
    loaded = f"composable_node_descriptions=[{component}]"
    app = python(f"LoadComposableNodes(target_container='c', {loaded})")
    assert values(app.starts[0]) == {"all": 1, "both": "last", "nested": True}


@pytest.mark.parametrize(
    ("written", "value"),
    [
        ("1", 1),
        ("1.5", 1.5),
        ("True", True),
        ("'text'", "text"),
        ("'1'", "1"),
        ("'true'", "true"),
        ("[1, 2]", [1, 2]),
        ("['a', '1']", ["a", "1"]),
        ("[1.0, 2.0]", [1.0, 2.0]),
        ("[1, 2.5]", [1.0, 2.5]),
        ("('a', 'b')", ["a", "b"]),
        ("LaunchConfiguration('one')", 1),
        ("ParameterValue(LaunchConfiguration('one'), value_type=str)", "1"),
        ("ParameterValue(LaunchConfiguration('one'), value_type=int)", 1),
        ("ParameterValue('x', value_type=str)", "x"),
        ("[LaunchConfiguration('one'), '0']", 10),
        ("LaunchConfiguration('words')", "two words"),
        ("LaunchConfiguration('list')", [1, 2]),
        ("LaunchConfiguration('empty')", ""),
        ("[[LaunchConfiguration('one')], ['2']]", [1, 2]),
    ],
)
def test_the_type_of_a_value(python, written, value):
    declared = {"one": "1", "words": "two words", "list": "[1, 2]", "empty": ""}
    args = "".join(
        f"DeclareLaunchArgument('{k}', default_value='{v}')," for k, v in declared.items()
    )
    app = python(args + node(f"{{'p': {written}}}"))
    found = values(app.starts[0])["p"]
    assert found == value
    assert type(found) is type(value)


def test_nested_values_and_names_that_are_made(program):
    app = program("""
def generate_launch_description():
    shared = {'use_sim_time': True}
    own = {**shared, 'plugins': {'FollowPath': {'speed': 0.5}}}
    own.update(extra='x')
    own['k' + 'ey'] = 1
    return LaunchDescription([Node(executable='e', name='n', parameters=[own])])
""")
    assert values(app.starts[0]) == {
        "use_sim_time": True,
        "plugins.FollowPath.speed": 0.5,
        "extra": "x",
        "key": 1,
    }


def test_a_value_that_is_not_known(python):
    app = python(node("{'p': ['a/', LaunchConfiguration('no')], 'q': Command('ls'), 'r': 1}"))
    found = values(app.starts[0])
    assert found == {"p": UnknownValue("a/{no}"), "q": UnknownValue("{command ls}"), "r": 1}
    assert len(app.unresolved) == 2


def test_parameters_for_all_nodes_come_first(python, file):
    app = python(
        "GroupAction([SetParameter('a', 1), SetParameter(name='both', value='set'), "
        f"SetParametersFromFile('{file}'), SetUseSimTime(True), {node(repr({'a': 2}))}]), "
        + node("{'b': 1}", "m")
    )
    inner, outer = app.starts
    assert values(inner) == {
        "a": 2,
        "all": 1,
        "both": "own",
        "own": [1, 2],
        "deep.er": "x",
        "nested": True,
    }
    assert values(outer) == {"b": 1}


def test_a_list_that_is_there_already_is_shared_with_a_group(python):
    app = python("SetParameter('a', 1), GroupAction([SetParameter('b', 2)]), " + node("{'c': 3}"))
    assert values(app.starts[0]) == {"a": 1, "b": 2, "c": 3}


def test_a_file_with_substitutions_in_it(python, package):
    (package / "p.yaml").write_text(
        "/**: {ros__parameters: {a: $(var x), b: [$(var x)], c: $(var no)}}"
    )
    given = "DeclareLaunchArgument('x', default_value='7'), "
    text = given + node(f"ParameterFile('{package}/p.yaml', allow_substs=True)")
    assert values(python(text).starts[0]) == {"a": 7, "b": [7], "c": UnknownValue("{no}")}
    plain = python(given + node(f"ParameterFile('{package}/p.yaml')")).starts[0]
    assert values(plain)["a"] == "$(var x)"


@pytest.mark.parametrize(
    ("rewriting", "changed"),
    [
        ("{}", {}),
        ("{'both': LaunchConfiguration('x')}", {"both": 7}),
        ("{'both': 'true'}", {"both": True}),
        ("{'both': '1.5'}", {"both": 1.5}),
        ("{'/ns/n.ros__parameters.deep.er': 'y'}", {"deep.er": "y"}),
        ("{'/ns/n.ros__parameters.new': 'z'}", {"new": "z"}),
        ("{}, value_rewrites={'own': 'me'}", {"both": "me"}),
        ("{}, key_rewrites={'er': 'ep'}", {"deep.er": None, "deep.ep": "x"}),
    ],
)
def test_a_rewritten_file(python, file, rewriting, changed):
    before = values(python(node(f"'{file}'")).starts[0])
    rewritten = f"RewrittenYaml('{file}', param_rewrites={rewriting}, convert_types=True)"
    app = python(f"DeclareLaunchArgument('x', default_value='7'), {node(rewritten)}")
    expected = {name: value for name, value in {**before, **changed}.items() if value is not None}
    assert values(app.starts[0]) == expected
    assert app.unresolved == ()


def test_a_rewritten_file_below_a_namespace(python, package):
    (package / "p.yaml").write_text("n: {ros__parameters: {a: $(var x)}}")
    text = "ParameterFile(RewrittenYaml(source_file=[FindPackageShare('pkg'), '/p.yaml'], root_key="
    text += "LaunchConfiguration('ns'), param_rewrites={}), allow_substs=True)"
    args = "DeclareLaunchArgument('ns', default_value='{}'), SetLaunchConfiguration('x', '7'), "
    assert values(python(args.format("ns") + node(text)).starts[0]) == {"a": 7}
    assert values(python(args.format("") + node(text)).starts[0]) == {}
    assert values(python(args.format("") + node(text, space="/")).starts[0]) == {"a": 7}


def test_replaced_texts_and_what_a_file_has(python, package):
    (package / "p.yaml").write_text("n: {ros__parameters: {a: <x>, b: 1}}")
    replaced = f"ReplaceString('{package}/p.yaml', {{'<x>': ['y', 'z']}})"
    assert values(python(node(replaced, space="/")).starts[0]) == {"a": "yz", "b": 1}
    off = f"ReplaceString('{package}/p.yaml', {{'<x>': 'y'}}, condition=IfCondition('false'))"
    assert values(python(node(off, space="/")).starts[0])["a"] == "<x>"
    has = f"IfCondition(HasNodeParams('{package}/p.yaml', '{{}}'))"
    app = python(
        ", ".join(f"Node(executable='e', name='{n}', condition={has.format(n)})" for n in "nm")
    )
    assert [one.name for one in app.starts] == ["n"]


@pytest.mark.parametrize("text", ["no.yaml", "", "/**: [", "- a"])
def test_a_file_that_is_none(python, package, text):
    if text != "no.yaml":
        (package / "p.yaml").write_text(text)
    app = python(node(f"'{package}/p.yaml', {{'a': 1}}"))
    assert values(app.starts[0]) == {"a": 1}
    assert bool(app.unresolved) is (text in {"no.yaml", "/**: ["})


def test_a_file_whose_name_is_not_known(python):
    app = python(node("[LaunchConfiguration('dir'), '/p.yaml'], {'a': 1}"))
    [started] = app.starts
    assert not started.parameters_complete
    assert [source.file for source in started.parameter_sources] == ["{dir}/p.yaml", ""]
    assert whys(app) == ["argument 'dir' is not given"]
    assert python(node("{'a': 1}")).starts[0].parameters_complete


def test_a_file_that_the_build_installs_elsewhere(python, package):
    (package / "config").mkdir()
    (package / "config" / "p.yaml").write_text("/**: {ros__parameters: {a: 1}}")
    app = python(node("[FindPackageShare('pkg'), '/p.yaml']"))
    assert values(app.starts[0]) == {"a": 1}


def test_an_argument_that_names_an_installed_file_names_its_source(python, package):
    source = package / "tools" / "config" / "app.rviz"
    source.parent.mkdir(parents=True)
    source.write_text("")
    shown = "[FindPackageShare('pkg'), '/config/app.rviz']"
    words = f"['-d', {shown}, '/tmp/other.rviz', 'app.rviz']"
    app = python(f"Node(package='rviz2', executable='rviz2', arguments={words})")
    assert app.starts[0].arguments == ("-d", str(source), "/tmp/other.rviz", "app.rviz")


NODES = {
    "a node": "Node(package='p', executable='e', arguments=[{}], name='n', namespace='ns')",
    "a process": "ExecuteProcess(cmd=['ros2', 'run', 'p', 'e', {}, '-r', '__node:=n', '-r', "
    "'__ns:=/ns'])",
}


@pytest.mark.parametrize("how", NODES)
def test_a_file_among_the_arguments_counts_in_its_place(python, file, how):
    words = f"'--ros-args', '-p', 'all:=0', '--params-file', '{file}', '-p', 'both:=last'"
    start = python(NODES[how].format(words)).starts[0]
    found = values(start)
    assert (found["all"], found["own"], found["deep.er"]) == (1, [1, 2], "x")
    assert start.parameters_complete


def test_a_file_among_the_arguments_that_is_not_known_or_not_there(python):
    unknown = "'--ros-args', '--params-file', EnvironmentVariable('WHERE')"
    assert not python(NODES["a node"].format(unknown)).starts[0].parameters_complete
    gone = "'--ros-args', '--params-file', '/none/at/all.yaml'"
    app = python(NODES["a node"].format(gone))
    assert values(app.starts[0]) == {}
    assert any("all.yaml" in note.what + note.why for note in app.unresolved)
