"""Remaps without effect, service clients and nodes that declare nothing, in ROS 1."""

import pytest
from test_static_app import ends, scan

TALK = """#!/usr/bin/env python
import rospy
from std_msgs.msg import String
rospy.init_node("talk")
pub = rospy.Publisher("{}", String, queue_size=1)
rospy.spin()
"""


def scan_remapped(folder, remap, *, before="", name="camera/left/image"):
    """Scan two talkers of different names: one in a group with a remap, one outside of it."""
    for script, topic in (("inside", "chatter"), ("outside", name)):
        path = folder / f"robot/scripts/{script}.py"
        path.write_text(TALK.format(topic))
        path.chmod(0o755)
    (folder / "robot/launch/remapped.launch").write_text(
        f'<launch><group>{before}<remap from="{remap}" to="elsewhere"/>'
        '<node pkg="robot" type="inside.py" name="inside"/></group>'
        '<node pkg="robot" type="outside.py" name="outside"/></launch>'
    )
    return scan(folder, "remapped.launch").graph


def add_to_group(folder, element):
    path = folder / "robot/launch/remapped.launch"
    path.write_text(path.read_text().replace("</group>", f"{element}</group>"))


def idle(graph):
    return {note.what: note.why for note in graph.unresolved if note.what.startswith("remap ")}


@pytest.mark.parametrize("remap", ["camera/left", "camera/left/image"])
def test_a_remap_that_changes_no_name_is_noted_where_others_use_it(folder, remap):
    notes = idle(scan_remapped(folder, remap))
    why = "no node that gets it uses the name; /outside use it or one below it"
    assert notes == {f"remap /{remap} to /elsewhere": why}


@pytest.mark.parametrize("remap", ["chatter", "unknown", "camera/le"])
def test_one_that_changes_a_name_or_that_nobody_uses_is_not(folder, remap):
    assert idle(scan_remapped(folder, remap)) == {}


def test_a_remap_of_a_group_is_used_if_one_node_uses_it(folder):
    user = '<node pkg="robot" type="outside.py" name="user"/>'
    graph = scan_remapped(folder, "camera/left/image")
    assert idle(graph)
    text = (
        (folder / "robot/launch/remapped.launch").read_text().replace("</group>", user + "</group>")
    )
    (folder / "robot/launch/remapped.launch").write_text(text)
    assert idle(scan(folder, "remapped.launch").graph) == {}


def test_a_node_that_was_not_read_may_use_any_name(folder):
    gone = '<node pkg="nowhere" type="gone" name="gone"/>'
    graph = scan_remapped(folder, "camera/left/image")
    text = (
        (folder / "robot/launch/remapped.launch").read_text().replace("</group>", gone + "</group>")
    )
    (folder / "robot/launch/remapped.launch").write_text(text)
    assert idle(graph)
    assert idle(scan(folder, "remapped.launch").graph) == {}


def test_service_clients_are_in_the_graph_under_their_remapped_names(folder):
    path = folder / "robot/scripts/inside.py"
    path.write_text(
        "#!/usr/bin/env python\nimport rospy\nfrom std_srvs.srv import Empty\n"
        'rospy.init_node("inside")\nclear = rospy.ServiceProxy("clear", Empty)\n'
        'odd = rospy.Service("odd", Empty, print)\nrospy.spin()\n'
    )
    path.chmod(0o755)
    (folder / "robot/launch/calls.launch").write_text(
        '<launch><node pkg="robot" type="inside.py" name="inside">'
        '<remap from="clear" to="/map/clear"/></node></launch>'
    )
    graph = scan(folder, "calls.launch").graph
    assert [(c.node, c.name, c.type) for c in graph.clients] == [
        ("/inside", "/map/clear", "std_srvs/Empty")
    ]
    assert [service.name for service in graph.services] == ["/odd"]


def test_a_node_whose_source_declares_nothing_counts_as_not_read(folder):
    path = folder / "robot/scripts/inside.py"
    path.write_text("#!/usr/bin/env python\nprint('nothing')\n")
    path.chmod(0o755)
    (folder / "robot/launch/silent.launch").write_text(
        '<launch><node pkg="robot" type="inside.py" name="inside"/>'
        '<node pkg="robot" type="teleop.py" name="teleop"/></launch>'
    )
    unread = {node.name: node.unread for node in scan(folder, "silent.launch").graph.nodes}
    assert unread == {"/inside": True, "/teleop": False}


def test_a_module_beside_the_importing_one_is_found_as_python_2_does(folder):
    package = folder / "robot/src/arms"
    package.mkdir(parents=True)
    (package / "__init__.py").write_text("import arm_driver\n")
    (package / "arm_driver.py").write_text(
        "import rospy\nfrom std_msgs.msg import String\n"
        "def start():\n    rospy.init_node('arm')\n"
        "    rospy.Publisher('arm', String, queue_size=1)\n"
    )
    path = folder / "robot/scripts/arm.py"
    path.write_text("#!/usr/bin/env python\nimport arms\narms.arm_driver.start()\n")
    path.chmod(0o755)
    (folder / "robot/setup.py").write_text(
        "from catkin_pkg.python_setup import generate_distutils_setup\n"
        "from distutils.core import setup\n"
        "setup(**generate_distutils_setup(packages=['arms'], package_dir={'': 'src'}))\n"
    )
    (folder / "robot/launch/arm.launch").write_text(
        '<launch><node pkg="robot" type="arm.py" name="arm"/></launch>'
    )
    assert ends(scan(folder, "arm.launch").graph, "/arm") == {"> /arm"}
