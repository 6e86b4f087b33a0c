"""Our reading of launch files against ROS's own loader."""

from xml.sax.saxutils import escape

import pytest
from launch_cases import ARGUMENTS, CASES, EXPRESSIONS, INCLUDES, REFUSED, REFUSED_INSIDE, Case
from roslaunch_oracle import both, nodes_of_tree, started

from rtron.errors import InputError
from rtron.sources.launch.ros1.reader import read_launch

pytestmark = pytest.mark.ros1


@pytest.mark.parametrize("case", [*CASES, *INCLUDES], ids=lambda case: case.name)
def test_nodes_and_remaps_are_those_of_ros(ros, tmp_path, case):
    dump, ours = both(ros, tmp_path, case)
    tree = read_launch(*ours)
    assert "error" not in dump, dump
    assert tree.unresolved == ()
    assert nodes_of_tree(tree) == started(dump)


@pytest.mark.parametrize("expression", EXPRESSIONS)
def test_expressions_have_the_value_they_have_in_ros(ros, tmp_path, expression):
    args = escape(f"$(eval {expression})", {'"': "&quot;"})
    case = Case("", f'<node pkg="p" type="t" name="n" args="{args}"/>', args=ARGUMENTS)
    dump, ours = both(ros, tmp_path, case)
    assert nodes_of_tree(read_launch(*ours)) == started(dump)


@pytest.mark.parametrize("case", REFUSED, ids=lambda case: case.name)
def test_what_ros_refuses_is_an_error_with_its_line(ros, tmp_path, case):
    dump, ours = both(ros, tmp_path, case)
    with pytest.raises(InputError) as caught:
        read_launch(*ours)
    assert "error" in dump
    assert str(caught.value).startswith(f"{tmp_path / 'app.launch'}:")


@pytest.mark.parametrize("case", REFUSED_INSIDE, ids=lambda case: case.name)
def test_what_ros_refuses_beyond_the_file_stays_unresolved(ros, tmp_path, case):
    dump, ours = both(ros, tmp_path, case)
    assert "error" in dump
    assert read_launch(*ours).unresolved
