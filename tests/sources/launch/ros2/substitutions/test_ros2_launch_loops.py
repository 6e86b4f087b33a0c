"""What newer releases of launch have: loops in every format, paths by `/`, files' contents."""

import pytest
from app_launch_values import names, values, whys

FOR_EACH = """<launch><arg name="robots" default="{name: a, id: 1};{name: b};{}"/>
  <for_each values="$(var robots)">
    <group><push_ros_namespace namespace="$(for-var name none)"/>
      <node pkg="p" exec="e" name="n$(for-var id 9)"/></group>
  </for_each>{more}</launch>"""
FOR = """launch:
- arg: {name: num, default: "2"}
- for:
    len: $(var num)
    name: i
    children:
    - for: {len: "2", name: j, children: [{node: {pkg: p, exec: e, name: n$(index i)$(index j)}}]}
"""


def xml(text, more=""):
    return text.replace("{more}", more)


def test_a_loop_over_values_reads_its_children_once_for_each(read):
    app = read(xml(FOR_EACH), "xml")
    assert names(app) == ["/a/n1", "/b/n9", "/none/n9"]
    assert app.unresolved == ()
    assert names(read(xml(FOR_EACH), "xml", robots="{name: c, id: 3}")) == ["/c/n3"]
    assert names(read(xml(FOR_EACH), "xml", robots="")) == []


def test_a_loop_over_numbers_stands_in_another(read):
    app = read(FOR, "yaml")
    assert names(app) == ["/n00", "/n01", "/n10", "/n11"]
    assert app.unresolved == ()


def test_what_a_loop_runs_over_may_be_open(read):
    text = xml(FOR_EACH).replace(' default="{name: a, id: 1};{name: b};{}"', "")
    app = read(text, "xml")
    assert names(app) == ["/{for-var name none}/n{for-var id 9}"]
    assert "how often it runs is not known, it is read as if once" in whys(app)


@pytest.mark.parametrize("more", ['<node pkg="p" exec="e" name="$(for-var name)"/>'])
def test_a_variable_of_a_loop_is_not_known_behind_it(read, more):
    app = read(xml(FOR_EACH, more), "xml")
    assert whys(app) == ["no loop around it has 'name'"]


def test_many_rounds_are_bounded(read):
    app = read(FOR, "yaml", num="1000000000")
    assert len(app.starts) <= 2 * 128


def test_values_that_are_no_yaml_are_noted(read):
    app = read(xml(FOR_EACH), "xml", robots="{name: [")
    assert any("not YAML" in why for why in whys(app))


LOOPS = """
def robot(name: str, id: int = 9):
    return [Node(package='p', executable='e', name=name + str(id))]
def numbered(i: int):
    return [Node(package='p', executable='e', name='n' + str(i))]
"""


def test_loops_of_python_call_a_function(python):
    rows = "ForEach(LaunchConfiguration('r', default='{name: a, id: 1};{name: b}'), function=robot)"
    app = python(f"{rows}, ForLoop('2', function=numbered)", LOOPS)
    assert names(app) == ["/a1", "/b9", "/n0", "/n1"]
    assert names(python("ForLoop(length='1', function=numbered)", LOOPS)) == ["/n0"]


PATHS = [
    "FindPackageShare('pkg') / 'config' / 'p.yaml'",
    "PathSubstitution(FindPackageShare('pkg')) / 'config' / ['p', '.yaml']",
    "PathJoinSubstitution([FindPackageShare('pkg'), 'config']) / 'p.yaml'",
    "ThisLaunchFileDir() / '..' / 'config' / 'p.yaml'",
]


@pytest.mark.parametrize("path", PATHS)
def test_substitutions_that_make_paths_are_joined_by_a_slash(python, package, path):
    (package / "config").mkdir()
    (package / "config" / "p.yaml").write_text("/**: {ros__parameters: {a: 1}}")
    app = python(f"Node(package='p', executable='e', name='n', parameters=[{path}])")
    assert values(app.starts[0]) == {"a": 1}
    assert app.unresolved == ()


def test_the_content_of_a_file_is_a_text(read, python, package):
    (package / "name.txt").write_text("told")
    node = '<node pkg="p" exec="e" name="$(file-content $(find-pkg-share pkg)/name.txt)"/>'
    assert names(read(f"<launch>{node}</launch>", "xml")) == ["/told"]
    text = "FileContent(PathJoinSubstitution([FindPackageShare('pkg'), 'name.txt']))"
    assert names(python(f"Node(package='p', executable='e', name={text})")) == ["/told"]
    missing = node.replace("name.txt", "none.txt")
    assert names(read(f"<launch>{missing}</launch>", "xml"))[0].startswith("/{file-content")


def test_a_parameter_for_all_nodes_is_a_text(read):
    node = '<node pkg="p" exec="e" name="$(param who $(var d))"/>'
    text = f'<launch><arg name="d" default="else"/>{node}<set_parameter name="who" value="me"/>'
    assert names(read(f"{text}{node}</launch>", "xml")) == ["/else", "/me"]


def test_a_timer_of_ros_has_two_names(python):
    node = "Node(package='p', executable='e', name='{}')"
    timers = ", ".join(
        f"{name}(period=1.0, actions=[{node.format(name)}])" for name in ("ROSTimer", "RosTimer")
    )
    assert names(python(timers)) == ["/ROSTimer", "/RosTimer"]
