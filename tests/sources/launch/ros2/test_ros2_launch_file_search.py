"""The arguments that a launch file of ROS 2 declares, for the list of launch files."""

import pytest

from rtron.sources.launch.ros2.file_search import list_ros2_launch_files

FILE = """from launch import LaunchDescription
from launch.actions import DeclareLaunchArgument
import launch

ARGUMENTS = []
{lines}

def generate_launch_description():
    return LaunchDescription(ARGUMENTS)
"""


@pytest.fixture
def listed(tmp_path):
    """Return the required and the optional arguments of a file with these lines."""

    def read(lines):
        (tmp_path / "app.launch.py").write_text(FILE.format(lines=lines))
        (found,) = list_ros2_launch_files([tmp_path])
        return found.required, found.optional

    return read


def test_an_argument_is_listed_as_required_where_it_has_no_default(listed):
    lines = """a = DeclareLaunchArgument("a", default_value="1")
b = launch.actions.DeclareLaunchArgument(name="b", description="which")
c = DeclareLaunchArgument("c", default_value=None)
d = DeclareBooleanLaunchArgument("d", default_value=False)"""
    assert listed(lines) == (("b", "c"), ("a", "d"))


@pytest.mark.parametrize(
    "lines",
    [
        """for part in ["x", "y"]:
    ARGUMENTS.append(DeclareLaunchArgument(part, default_value="0.0"))""",
        "ARGUMENTS += [DeclareLaunchArgument(p, default_value='0') for p in ('x', 'y')]",
        """for part in ("x", "y"):
    for unused in range(2):
        DeclareLaunchArgument(name=part, default_value=str(unused))""",
    ],
)
def test_names_that_a_loop_goes_through_are_listed(listed, lines):
    assert listed(lines) == ((), ("x", "y"))


def test_names_that_are_not_written_out_are_not_listed(listed):
    lines = """for part in names():
    DeclareLaunchArgument(part)
for part in ["x"]:
    for part in names():
        DeclareLaunchArgument(part)
for one, other in [("x", "y")]:
    DeclareLaunchArgument(one + other)
DeclareLaunchArgument(part)"""
    assert listed(lines) == ((), ())


def test_more_arguments_than_anybody_declares_are_a_fault(tmp_path):
    names, calls = "'x', " * 9000, "DeclareLaunchArgument(x), " * 9000
    lines = f"for x in [{names}]:\n    y = [{calls}]"
    (tmp_path / "app.launch.py").write_text(FILE.format(lines=lines))
    (found,) = list_ros2_launch_files([tmp_path])
    assert "declares over 2000 arguments" in found.error


@pytest.mark.parametrize("marker", ["AMENT_IGNORE", "CATKIN_IGNORE", "COLCON_IGNORE"])
def test_what_builds_leave_out_has_no_launch_files(tmp_path, marker):
    for place in ("src", "made/p/share"):
        (tmp_path / place).mkdir(parents=True)
        (tmp_path / place / "x.launch.py").write_text(FILE.format(lines=""))
    (tmp_path / "made" / marker).touch()
    assert [each.path for each in list_ros2_launch_files([tmp_path])] == [
        tmp_path / "src/x.launch.py"
    ]
