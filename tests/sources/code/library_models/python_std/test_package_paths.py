"""Where a node's own files lie, by what each library calls it."""

import pytest
from ros1_runs import names, python, run_text

PATHS = {
    "rospkg": "import rospkg\np = rospkg.RosPack().get_path('p')",
    "roslib": "import roslib\np = roslib.packages.get_pkg_dir('p')",
    "ament": "from ament_index_python import get_package_share_directory\n"
    "p = get_package_share_directory(package_name='p')",
    "ament path": "from ament_index_python.packages import get_package_share_path\n"
    "p = get_package_share_path('p') / '.'",
    "resource": "import resource_retriever as rr\n"
    "p = rr.get_filename('package://p/', use_protocol=False)",
}
AMENT = "from ament_index_python import get_package_share_directory\n"
UNKNOWN = [
    "import resource_retriever as rr\np = rr.get_filename('http://p/n.py')",
    "import resource_retriever as rr\np = rr.get_filename('package://none/n.py')",
    f"{AMENT}p = get_package_share_directory('none')",
]


@pytest.mark.parametrize("found", PATHS.values(), ids=PATHS)
def test_a_file_of_the_package_is_read(found):
    """The program reads its own text, from which it takes a name."""
    text = f"#x#\n{found}\nfirst = open(str(p) + '/n.py').read().split('#')[1]\nP(first)\n"
    assert names(python(text)) == ["x"]


@pytest.mark.parametrize("body", UNKNOWN)
def test_what_is_not_here_is_not_known(body):
    assert all("{" in name for name in names(python(f"{body}\nP(p)")))


def test_a_file_name_with_its_protocol():
    text = "import rospy, resource_retriever as rr\nfrom std_msgs.msg import Bool\n"
    text += "p = rr.get_filename('package://p/n')\nrospy.Publisher(p.split(':')[0], Bool)"
    assert names(run_text(text)) == ["file"]
