"""What the packages of a folder publish and subscribe, read in their programs."""

import pytest

from rtron.sources.static.options import ScanOptions
from rtron.sources.static.traffic import read_traffic

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
        for file, text in {
            "package.xml": f"<package><name>{name}</name></package>",
            **files,
        }.items():
            path = tmp_path / name / file
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_text(text)
            path.chmod(0o755)
        return tmp_path

    return make_package


def traffic(folder, **options):
    found = read_traffic(folder, ScanOptions(workers=1, **options))
    return {name: (its.publishes, its.subscribes) for name, its in found.items()}


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


def test_what_cannot_be_read_costs_nothing_else(make):
    make("broken", {"scripts/a.py": "#!/usr/bin/env python\nimport rospy\ndef (\n"})
    folder = make("drives", {"scripts/a.py": HEAD + 'rospy.Publisher("v", Twist)\n'})
    found = traffic(folder)
    assert found["drives"] == ({"geometry_msgs/Twist"}, set())
    assert found.get("broken", (set(), set())) == (set(), set())


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
    read_traffic(make("drives", {"scripts/a.py": HEAD}), options)
    assert told == [(1, 1, "/a")]
