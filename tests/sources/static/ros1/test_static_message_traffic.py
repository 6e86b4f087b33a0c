"""What the packages of a folder publish and subscribe, read in their programs."""

from dataclasses import replace

import pytest
from file_tree import package

from rtron.sources.static.common.scan_options import ScanOptions
from rtron.sources.static.ros1.message_traffic import read_traffic

HEAD = """#!/usr/bin/env python
import actionlib, rospy
from geometry_msgs.msg import Twist
from sensor_msgs.msg import LaserScan
from move_base_msgs.msg import MoveBaseAction
"""
CPP = """#include <ros/ros.h>
#include <nav_msgs/Path.h>
int main(int argc, char** argv) {
  ros::init(argc, argv, "plans");
  ros::NodeHandle node;
  ros::Publisher path = node.advertise<nav_msgs::Path>("path", 1);
  ros::spin();
}
"""


@pytest.fixture
def make(tmp_path):
    def make_package(name, files):
        package(tmp_path / name, files)
        return tmp_path

    return make_package


def read(folder, **options):
    packages = {path.parent.name: path.parent for path in folder.rglob("package.xml")}
    return read_traffic(folder, packages, ScanOptions(workers=1, **options))


def traffic(folder, **options):
    found = read(folder, **options).packages
    return {path.name: (its.publishes, its.subscribes) for path, its in found.items()}


def test_scripts_and_programs_of_each_package(make):
    make("drives", {"scripts/a.py": HEAD + 'rospy.Publisher("v", Twist, queue_size=1)\n'})
    make("drives", {"scripts/b.py": HEAD + 'rospy.Subscriber("s", LaserScan)\n'})
    cmake = "project(plans)\nadd_executable(plans src/plans.cpp)\n"
    folder = make("plans", {"CMakeLists.txt": cmake, "src/plans.cpp": CPP})
    assert traffic(folder) == {
        "drives": ({"geometry_msgs/Twist"}, {"sensor_msgs/LaserScan"}),
        "plans": ({"nav_msgs/Path"}, set()),
    }


def test_an_action_is_the_type_of_its_goals(make):
    client = 'actionlib.SimpleActionClient("go", MoveBaseAction)\n'
    server = 'actionlib.SimpleActionServer("go", MoveBaseAction)\n'
    make("asks", {"scripts/a.py": HEAD + client})
    folder = make("serves", {"scripts/b.py": HEAD + server})
    goal = "move_base_msgs/MoveBaseActionGoal"
    assert traffic(folder) == {"asks": ({goal}, set()), "serves": (set(), {goal})}


def test_what_a_library_declares_by_itself_does_not_count(make):
    listens = "import tf\nlistener = tf.TransformListener()\n"
    folder = make("asks", {"scripts/a.py": HEAD + listens + 'rospy.Publisher("v", Twist)\n'})
    assert traffic(folder) == {"asks": ({"geometry_msgs/Twist"}, set())}


def test_a_package_without_programs_has_none(make):
    assert traffic(make("empty", {"scripts/plain.txt": "no program"})) == {}


def test_what_cannot_be_read_costs_nothing_else_and_is_told(make):
    make("broken", {"scripts/a.py": "#!/usr/bin/env python\nimport rospy\ndef (\n"})
    folder = make("drives", {"scripts/a.py": HEAD + 'rospy.Publisher("v", Twist)\n'})
    found = traffic(folder)
    assert found["drives"] == ({"geometry_msgs/Twist"}, set())
    assert found.get("broken", (set(), set())) == (set(), set())
    (note,) = read(folder).unresolved
    assert note.evidence[0].file == str(folder / "broken/scripts/a.py")


def test_a_program_that_takes_too_long_is_told(make):
    folder = make("drives", {"scripts/a.py": HEAD + 'rospy.Publisher("v", Twist)\n'})
    (note,) = read(folder, seconds=1e-6).unresolved
    assert (note.what, note.why) == ("the program of /a", "not done within 1e-06 s")
    assert read(folder).unresolved == ()


def test_programs_that_came_to_nothing_are_told_before_what_is_unclear(make, tmp_path):
    make("a_unclear", {"scripts/a.py": "#!/usr/bin/env python\nimport rospy\ndef (\n"})
    top = make("z_slow", {"scripts/z.py": HEAD + 'rospy.Publisher("v", Twist)\n'})
    packages = {name: top / name for name in ("a_unclear", "z_slow")}
    options = ScanOptions(workers=1, cache=tmp_path / "cache")
    (unclear,) = read_traffic(top, {"a_unclear": top / "a_unclear"}, options).unresolved
    late, known = read_traffic(top, packages, replace(options, seconds=1e-6)).unresolved
    assert late.what == "the program of /z"
    assert known == unclear


def test_a_faulty_description_of_plugins_is_told(make):
    export = "<export><nodelet plugin='${prefix}/plugins.xml'/></export>"
    manifest = f"<package><name>plugs</name>{export}</package>"
    folder = make("plugs", {"package.xml": manifest, "plugins.xml": "<library"})
    (note,) = read(folder).unresolved
    assert note.evidence[0].file == str(folder / "plugs/plugins.xml")


def test_of_two_packages_with_one_name_the_one_asked_for_is_read(make):
    sends, hears = 'rospy.Publisher("v", Twist)\n', 'rospy.Subscriber("v", Twist)\n'
    make("a/my_teleop", {"scripts/a.py": HEAD + sends})
    top = make("b/my_teleop", {"scripts/a.py": HEAD + hears})
    for folder, sent in ((top / "a/my_teleop", True), (top / "b/my_teleop", False)):
        found = read_traffic(top, {"my_teleop": folder}, ScanOptions(workers=1)).packages
        assert list(found) == [folder]
        assert bool(found[folder].publishes) is sent
        assert bool(found[folder].subscribes) is not sent


def test_a_second_time_it_comes_from_the_cache_and_changes_count(make, tmp_path):
    folder = make("drives", {"scripts/a.py": HEAD + 'rospy.Publisher("v", Twist)\n'}) / "drives"
    cache = tmp_path / "cache"
    first = traffic(folder, cache=cache)
    assert traffic(folder, cache=cache) == first == {"drives": ({"geometry_msgs/Twist"}, set())}
    make("drives", {"scripts/a.py": HEAD + 'rospy.Subscriber("v", Twist)\n'})
    assert traffic(folder, cache=cache) == {"drives": (set(), {"geometry_msgs/Twist"})}


def test_progress_is_told_of_each_program(make):
    told = []
    options = ScanOptions(workers=1, progress=lambda *said: told.append(said))
    folder = make("drives", {"scripts/a.py": HEAD})
    read_traffic(folder, {"drives": folder / "drives"}, options)
    assert told == [(1, 1, "/a")]
