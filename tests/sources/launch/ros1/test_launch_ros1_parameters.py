"""What a launch sets on the parameter server, against ROS's own loader and master."""

import math
import tempfile
from pathlib import Path

import pytest
from file_tree import write
from hypothesis import given, settings
from launch_cases import CASES, INCLUDES, Case
from launch_parameter_cases import DOUBTED, PARAMETERS, REFUSED_PARAMETERS, UNRESOLVED_PARAMETERS
from launch_parameter_files import launches_with_parameters
from roslaunch_oracle import both, nodes_of_tree, started

from example_budget import examples
from rtron.errors import InputError
from rtron.sources.launch.ros1.reader import read_launch, read_launches
from rtron.vocabulary import UnknownValue

pytestmark = pytest.mark.ros1


def leaves(server, prefix=""):
    """Return a master's tree name by name, values with their types."""
    found = {}
    for key, value in server.items():
        name = f"{prefix}/{key}".replace("_rtron_anonymous", "_*")
        found |= leaves(value, name) if isinstance(value, dict) else {name: typed(value)}
    return found


def our_leaves(tree):
    return {name: typed(found.value) for name, found in tree.parameters.leaves.items()}


def typed(value):
    if isinstance(value, list):
        return [typed(inner) for inner in value]
    if isinstance(value, dict):
        return {key: typed(inner) for key, inner in value.items()}
    if isinstance(value, UnknownValue) or value == "binary data":
        return (str, getattr(value, "why", value))
    if isinstance(value, float) and math.isnan(value):
        return (float, "nan")
    value = value.replace("_rtron_anonymous", "_*") if isinstance(value, str) else value
    return (type(value), value)


@pytest.mark.parametrize("case", [*PARAMETERS, *CASES, *INCLUDES], ids=lambda case: case.name)
def test_parameters_are_those_of_ros(ros, tmp_path, case):
    dump, ours = both(ros, tmp_path, case)
    tree = read_launch(*ours)
    assert "error" not in dump, dump
    assert tree.unresolved == ()
    assert our_leaves(tree) == leaves(dump["server"])
    assert nodes_of_tree(tree) == started(dump)


@pytest.mark.parametrize("case", [*PARAMETERS, *INCLUDES], ids=lambda case: case.name)
def test_environments_are_those_of_ros(ros, tmp_path, case):
    dump, ours = both(ros, tmp_path, case)
    found = [[list(pair) for pair in node.environ] for node in read_launch(*ours).nodes()]
    expected = [node["env_args"] for node in [*dump["nodes"], *dump["tests"]]]
    assert sorted(found) == sorted(expected)


@pytest.mark.parametrize("case", DOUBTED, ids=lambda case: case.name)
def test_a_value_that_ros_refuses_is_unknown_and_said(ros, tmp_path, case):
    dump, ours = both(ros, tmp_path, case)
    tree = read_launch(*ours)
    assert "error" in dump
    assert isinstance(tree.parameters.leaves["/a"].value, UnknownValue)
    assert len(tree.unresolved) == 1
    assert tree.unresolved[0].evidence[0].file == str(tmp_path / "app.launch")


@pytest.mark.parametrize("case", UNRESOLVED_PARAMETERS, ids=lambda case: case.name)
def test_what_ros_refuses_is_said(ros, tmp_path, case):
    dump, ours = both(ros, tmp_path, case)
    tree = read_launch(*ours)
    assert "error" in dump
    assert len(tree.unresolved) == 1
    assert tree.parameters.leaves == {}


@pytest.mark.parametrize("case", REFUSED_PARAMETERS, ids=lambda case: case.name)
def test_an_element_that_ros_refuses_is_an_error(ros, tmp_path, case):
    dump, ours = both(ros, tmp_path, case)
    with pytest.raises(InputError) as caught:
        read_launch(*ours)
    assert "error" in dump
    assert str(caught.value).startswith(f"{tmp_path / 'app.launch'}:1: <")


DELETE = '<rosparam command="delete" param="/a/e"/>'
LAUNCHES = (
    ('<param name="a" value="1"/><param name="b" value="1"/>', '<param name="a" value="2"/>'),
    ("<rosparam>a: {b: 1, c: 2}</rosparam>", '<rosparam command="delete" param="a/b"/>'),
    ("<rosparam>a: {b: 1, c: 2}</rosparam>", '<rosparam command="delete"/>'),
    ("<rosparam>a: {b: 1}</rosparam>", '<group ns="a" clear_params="true"/>'),
    ("<rosparam>n: {b: 1}\nm: {b: 1}</rosparam>",
     '<node pkg="p" type="t" name="n" clear_params="true"><param name="c" value="1"/></node>'),
    ("<rosparam>a: {b: 1}</rosparam>", '<group ns="a" clear_params="false"/>'),
    ("<rosparam>a: {b: {c: 1}, d: 2}</rosparam>",
     f'<group ns="a"><group ns="b" clear_params="true"/></group>{DELETE}'),
    ("<rosparam>a: {b: 1}</rosparam>", '<param name="a" value="1"/>',
     "<rosparam>a: {c: 2}</rosparam>"),
)  # fmt: skip


@pytest.mark.parametrize("bodies", LAUNCHES)
def test_later_launches_find_what_earlier_ones_set(ros, tmp_path, bodies):
    files = {f"{n}.launch": f"<launch>{body}</launch>" for n, body in enumerate(bodies)}
    write(tmp_path, files)
    server = {}
    for name in files:
        dump = ros.ask({"path": str(tmp_path / name), "args": {}, "environ": {}, "before": server})
        server = dump["server"]
    trees = read_launches([(tmp_path / name, {}) for name in files], {}, {})
    assert len(trees) == len(bodies)
    assert all(our_leaves(tree) == leaves(server) for tree in trees)


@settings(max_examples=examples(300), deadline=None)
@given(files=launches_with_parameters())
def test_any_launch_sets_the_parameters_that_ros_sets(ros, files):
    with tempfile.TemporaryDirectory() as folder:
        path = write(Path(folder), files) / "app.launch"
        dump = ros.load(path, {})
        tree = read_launch(path, {}, {}, {})
    assert "error" not in dump, dump
    assert tree.unresolved == ()
    assert our_leaves(tree) == leaves(dump["server"])
    assert nodes_of_tree(tree) == started(dump)


def test_cases_differ():
    names = [case.name for case in (*PARAMETERS, *DOUBTED, *UNRESOLVED_PARAMETERS)]
    assert len(names) == len(set(names))
    assert all(isinstance(case, Case) for case in PARAMETERS)
