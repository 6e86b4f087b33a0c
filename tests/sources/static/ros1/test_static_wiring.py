"""Remaps without effect, shared outputs, service clients and silent nodes, in ROS 1."""

import pytest
from test_static_app import ends, scan

TALK = """#!/usr/bin/env python
import rospy
from std_msgs.msg import String
rospy.init_node("talk")
pub = rospy.Publisher("{}", String, queue_size=1)
rospy.spin()
"""


def scan_remapped(folder, remap):
    """Scan two talkers of different names: one in a group with a remap, one outside of it."""
    for script, topic in (("inside", "chatter"), ("outside", "camera/left/image")):
        path = folder / f"robot/scripts/{script}.py"
        path.write_text(TALK.format(topic))
        path.chmod(0o755)
    (folder / "robot/launch/remapped.launch").write_text(
        f'<launch><group><remap from="{remap}" to="elsewhere"/>'
        '<node pkg="robot" type="inside.py" name="inside"/></group>'
        '<node pkg="robot" type="outside.py" name="outside"/></launch>'
    )
    return scan(folder, "remapped.launch").graph


def add_to_group(folder, element):
    path = folder / "robot/launch/remapped.launch"
    path.write_text(path.read_text().replace("</group>", f"{element}</group>"))


def facts_of(graph, kind):
    """Return the facts of one kind about an app's wiring."""
    return [fact for fact in graph.wiring if fact.kind == kind]


def idle(graph):
    """Return the remaps without effect, and who uses their names."""
    return {(fact.subject, fact.value): fact.others for fact in facts_of(graph, "idle_remap")}


@pytest.mark.parametrize("remap", ["camera/left", "camera/left/image"])
def test_a_remap_that_changes_no_name_is_noted_where_others_use_it(folder, remap):
    remaps = idle(scan_remapped(folder, remap))
    assert remaps == {(f"/{remap}", "/elsewhere"): ("/outside",)}


@pytest.mark.parametrize("remap", ["unknown", "camera/le"])
def test_one_that_nobody_uses_is_noted_where_the_nodes_are_read_whole(folder, remap):
    graph = scan_remapped(folder, remap)
    assert idle(graph) == {(f"/{remap}", "/elsewhere"): ()}
    (fact,) = facts_of(graph, "unused_remap")
    assert (fact.subject, fact.value, fact.others) == (f"/{remap}", "/elsewhere", ("/inside",))


@pytest.mark.parametrize(
    ("more", "is_noted"),
    [
        ("", True),
        ('<param name="unknown" value="1"/>', False),  # a remap is of parameters, too
        ('<param name="/elsewhere" value="1"/>', False),
        ('<node pkg="nowhere" type="gone" name="gone"/>', False),
        # a remap of a group, for the nodes of all its namespaces
        (
            '<group ns="deep"><remap from="unknown" to="elsewhere"/>{}</group>'.format(
                '<node pkg="robot" type="user.py" name="user"/>'
            ),
            False,
        ),
    ],
)
def test_parameters_and_namespaces_may_have_a_use_for_a_remap(folder, more, is_noted):
    path = folder / "robot/scripts/user.py"
    path.write_text(TALK.format("unknown"))
    path.chmod(0o755)
    scan_remapped(folder, "unknown")
    add_to_group(folder, more)
    remaps = idle(scan(folder, "remapped.launch").graph)
    assert (("/unknown", "/elsewhere") in remaps) is is_noted


def test_one_that_changes_a_name_is_not(folder):
    graph = scan_remapped(folder, "chatter")
    assert idle(graph) == {}
    assert not facts_of(graph, "unused_remap")


def test_a_remap_of_a_group_is_used_if_one_node_uses_it(folder):
    user = '<node pkg="robot" type="outside.py" name="user"/>'
    graph = scan_remapped(folder, "camera/left/image")
    assert idle(graph)
    text = (
        (folder / "robot/launch/remapped.launch").read_text().replace("</group>", user + "</group>")
    )
    (folder / "robot/launch/remapped.launch").write_text(text)
    assert idle(scan(folder, "remapped.launch").graph) == {}


@pytest.mark.parametrize(("name", "is_idle"), [("chat{}", True), ("camera/{}/image", False)])
def test_a_name_known_in_part_may_be_that_of_the_remap(folder, name, is_idle):
    scan_remapped(folder, "camera/left/image")
    talk = TALK.replace('"{}"', f'"{name}".format(unknown())')
    (folder / "robot/scripts/inside.py").write_text(talk)
    assert bool(idle(scan(folder, "remapped.launch").graph)) is is_idle


@pytest.mark.parametrize("behind", ["", '<node pkg="robot" type="gone" name="gone" if="false"/>'])
def test_a_remap_behind_all_that_starts_reaches_nobody(folder, behind):
    scan_remapped(folder, "chatter")
    path = folder / "robot/launch/remapped.launch"
    remap = f'<remap from="camera/left" to="left"/>{behind}</launch>'
    path.write_text(path.read_text().replace("</launch>", remap))
    expected = {} if behind else {("/camera/left", "/left"): ("/outside",)}
    assert idle(scan(folder, "remapped.launch").graph) == expected


def test_a_node_that_was_not_read_may_use_any_name(folder):
    gone = '<node pkg="nowhere" type="gone" name="gone"/>'
    graph = scan_remapped(folder, "camera/left/image")
    text = (
        (folder / "robot/launch/remapped.launch").read_text().replace("</group>", gone + "</group>")
    )
    (folder / "robot/launch/remapped.launch").write_text(text)
    assert idle(graph)
    assert idle(scan(folder, "remapped.launch").graph) == {}


def test_a_node_that_is_not_read_has_the_names_that_the_launch_gives_it(folder):
    inside = '<remap from="in" to="cmd_vel"/><param name="topic" value="fast/vel"/>'
    (folder / "robot/launch/given.launch").write_text(
        f'<launch><node pkg="nowhere" type="gone" name="gone" ns="a">{inside}</node></launch>'
    )
    (fact,) = facts_of(scan(folder, "given.launch").graph, "unread_node")
    assert (fact.subject, fact.others) == ("/a/gone", ("/a/cmd_vel", "/a/fast/vel"))


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


CAMERA = """#!/usr/bin/env python
import rospy
from sensor_msgs.msg import CameraInfo, Image
rospy.init_node("camera")
image = rospy.Publisher("image", Image, queue_size=1)
info = rospy.Publisher("info", CameraInfo, queue_size=1)
rospy.spin()
"""
NODE = '<node pkg="robot" type="{}" name="{}">{}</node>'


def shared_outputs(folder, *nodes):
    """Return the topics that instances share, of nodes given as program, name and remaps."""
    path = folder / "robot/scripts/camera.py"
    path.write_text(CAMERA)
    path.chmod(0o755)
    elements = [
        NODE.format(
            program, name, "".join(f'<remap from="{a}" to="{b}"/>' for a, b in remaps.items())
        )
        for program, name, remaps in nodes
    ]
    (folder / "robot/launch/shared.launch").write_text(f"<launch>{''.join(elements)}</launch>")
    graph = scan(folder, "shared.launch").graph
    facts = facts_of(graph, "shared_output")
    assert all(len(fact.evidence) == len(nodes) for fact in facts)
    return [(fact.subject, *fact.others) for fact in facts]


def test_what_instances_share_while_their_other_topics_differ_is_noted(folder):
    left, right = ("camera.py", "left", {"info": "/l/info"}), ("camera.py", "right", {})
    assert shared_outputs(folder, left, right) == [("/image", "/left", "/right")]


@pytest.mark.parametrize("right", [{"image": "/r/image"}, {"info": "/l/info"}])
def test_what_all_have_apart_or_all_in_common_is_not(folder, right):
    nodes = [("camera.py", "left", {"info": "/l/info"}), ("camera.py", "right", right)]
    assert shared_outputs(folder, *nodes) == []


def test_one_instance_shares_nothing(folder):
    assert shared_outputs(folder, ("camera.py", "left", {}), ("teleop.py", "right", {})) == []


def test_nodelets_count_apart_though_they_are_one_node(folder):
    remap = '<remap from="image" to="/{}/image"/><remap from="~out" to="/out"/>'
    load = '<node pkg="nodelet" type="nodelet" name="{}" args="load robot/Filter /m">{}</node>'
    source = folder / "robot/src/filter.cpp"
    more = 'more_ = getPrivateNodeHandle().advertise<sensor_msgs::Image>("more", 1);\n    sub_ ='
    source.write_text(source.read_text().replace("sub_ =", more, 1))
    nodelets = "".join(load.format(name, remap.format(name)) for name in ("left", "right"))
    manager = '<node pkg="nodelet" type="nodelet" name="m" args="manager"/>'
    (folder / "robot/launch/two.launch").write_text(f"<launch>{manager}{nodelets}</launch>")
    graph = scan(folder, "two.launch").graph
    assert [fact.subject for fact in facts_of(graph, "shared_output")] == ["/out"]


@pytest.mark.parametrize(
    ("value", "is_noted"),
    [
        ("/bases/cmd_vel", True),
        ("/cmd_vel", False),
        ("cmd_vel", False),
        ("/chatter", False),
        ("/base", False),
    ],
)
@pytest.mark.parametrize("name", ["vel_topic", "frame"])
def test_a_parameter_that_names_a_topic_near_one_that_is_used(folder, name, value, is_noted):
    (folder / "robot/launch/named.launch").write_text(
        f'<launch><param name="{name}" value="{value}"/>'
        '<node pkg="robot" type="teleop.py" name="teleop">'
        '<remap from="cmd_vel" to="/base/cmd_vel"/></node>'
        '<node pkg="robot" type="driver" name="driver"/></launch>'
    )
    graph = scan(folder, "named.launch").graph
    facts = facts_of(graph, "topic_parameter")
    is_expected = is_noted and name == "vel_topic"
    expected = [(f"/{name}", value, ("/base/cmd_vel",))] if is_expected else []
    assert [(fact.subject, fact.value, fact.others) for fact in facts] == expected


def test_a_parameter_may_name_the_source_of_a_remap(folder):
    (folder / "robot/launch/named.launch").write_text(
        '<launch><param name="vel_topic" value="/base/cmd_ve"/>'
        '<node pkg="robot" type="teleop.py" name="teleop">'
        '<remap from="/base/cmd_ve" to="x"/><remap from="cmd_vel" to="/base/cmd_vel"/></node>'
        "</launch>"
    )
    graph = scan(folder, "named.launch").graph
    assert not facts_of(graph, "topic_parameter")


def test_a_shell_script_takes_no_name(folder):
    """run.sh starts a node that is named /by_hand: there is one of that name, not two."""
    (folder / "robot/launch/wrapped.launch").write_text(
        '<launch><node pkg="robot" type="run.sh" name="by_hand"/></launch>'
    )
    graph = scan(folder, "wrapped.launch").graph
    assert [end.node for end in graph.publishers("/by_hand/cmd_vel")] == ["/by_hand"]
    assert not facts_of(graph, "duplicate_node")


ODOMETRY = """#!/usr/bin/env python
import rospy
import tf2_ros
from geometry_msgs.msg import TransformStamped
from nav_msgs.msg import Odometry
rospy.init_node("odometry")
broadcaster = tf2_ros.TransformBroadcaster()
def send(odometry):
    transform = TransformStamped()
    transform.header.frame_id = "odom"
    transform.child_frame_id = rospy.get_param("~base", "base_link")
    if rospy.get_param("~publish_tf", True):
        broadcaster.sendTransform(transform)
rospy.Subscriber("odom", Odometry, send)
"""
EKF = (
    '<node pkg="robot_localization" type="ekf_localization_node" name="ekf">'
    '<param name="publish_tf" value="{}"/></node>'
)
FIXED = '<node pkg="{}" type="static_transform_publisher" name="{}" args="0 0 -1 0 0 0 {}"/>'


def doubled_frames(folder, *elements):
    """Return kind, frame, parent and nodes of what is doubled among some nodes."""
    path = folder / "robot/scripts/odometry.py"
    path.write_text(ODOMETRY)
    path.chmod(0o755)
    (folder / "robot/launch/frames.launch").write_text(f"<launch>{''.join(elements)}</launch>")
    facts = [fact for fact in scan(folder, "frames.launch").graph.wiring if "frame" in fact.kind]
    assert all(len(fact.evidence) >= len(fact.others) for fact in facts)
    return [(fact.kind.value, fact.subject, fact.value, *fact.others) for fact in facts]


def odometry(name, **values):
    params = "".join(f'<param name="{key}" value="{value}"/>' for key, value in values.items())
    return f'<node pkg="robot" type="odometry.py" name="{name}">{params}</node>'


def test_a_frame_that_code_and_a_known_node_broadcast_is_found(folder):
    found = doubled_frames(folder, odometry("wheels"), EKF.format("true"))
    assert found == [("double_frame", "base_link", "odom", "/wheels", "/ekf")]


@pytest.mark.parametrize(
    "elements",
    [
        [odometry("wheels"), EKF.format("false")],
        [odometry("wheels", publish_tf="false"), EKF.format("true")],
        [odometry("wheels", base="base_footprint"), EKF.format("true")],
        [odometry("wheels"), odometry("again").replace("again", "wheels")],
    ],
)
def test_one_that_one_node_broadcasts_is_not(folder, elements):
    assert doubled_frames(folder, *elements) == []


@pytest.mark.parametrize(
    ("first", "second", "expected"),
    [
        ("base laser 100", "/base /laser", [("double_fixed_frame", "laser", "base", "/a", "/b")]),
        ("base laser 100", "mast laser",
         [("double_frame", "laser", "base", "/a"), ("double_frame", "laser", "mast", "/b")]),
        ("base laser 100", "base camera", []),
        ("base laser", "base laser", []),
    ],
)  # fmt: skip
def test_fixed_transforms_count_by_their_parents(folder, first, second, expected):
    """The publisher of tf needs a period; with 8 arguments it does not start."""
    nodes = FIXED.format("tf", "a", first), FIXED.format("tf2_ros", "b", second)
    assert doubled_frames(folder, *nodes) == expected


def test_transforms_on_other_topics_are_other_frames(folder):
    group = '<group><remap from="/tf" to="/other/tf"/>{}</group>'
    one, other = (FIXED.format("tf2_ros", name, "base laser") for name in ("a", "b"))
    assert doubled_frames(folder, one, other)
    assert doubled_frames(folder, one, group.format(other)) == []
    (fact,) = doubled_frames(folder, group.format(one), group.format(other))
    assert fact[1] == "laser on /other/tf"


def test_a_robot_s_joints_are_frames_too(folder):
    joint = '<joint type="{}"><parent link="base"/><child link="{}"/></joint>'
    robot = joint.format("fixed", "laser") + joint.format("continuous", "wheel")
    description = f"<robot>{robot}</robot>".replace("<", "&lt;").replace('"', "&quot;")
    nodes = (
        f'<param name="robot_description" value="{description}"/>',
        '<node pkg="robot_state_publisher" type="robot_state_publisher" name="robot"/>',
        FIXED.format("tf2_ros", "a", "base laser"),
        FIXED.format("tf2_ros", "b", "base wheel"),
    )
    assert doubled_frames(folder, *nodes) == [
        ("double_fixed_frame", "laser", "base", "/robot", "/a"),
        ("double_frame", "wheel", "base", "/robot", "/b"),
    ]
