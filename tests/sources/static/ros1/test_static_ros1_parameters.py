"""Parameters that a launch of ROS 1 sets, and those that the node's source does not read."""

import pytest
from test_static_app import scan

BASE = """#!/usr/bin/env python
import rospy
from std_msgs.msg import String
rospy.init_node("base")
speed = rospy.get_param("~max_vel", 1.0)
radius = rospy.get_param("~wheel/radius", 1.0)
{more}
rospy.Publisher("out", String, queue_size=1)
rospy.spin()
"""
OTHER = """#!/usr/bin/env python
import rospy
rospy.init_node("other")
rospy.get_param("/base/of_other")
rospy.get_param("~own")
"""
LAUNCH = """<launch>
<node pkg="robot" type="base.py" name="base">{given}</node>
<node pkg="robot" type="other.py" name="other"/>
</launch>"""


@pytest.fixture
def scanned(folder):
    """Return the graph of an app with a base that is given parameters, and reads some more."""

    def graph(given, more=""):
        programs = {"base.py": BASE.replace("{more}", more), "other.py": OTHER}
        for name, text in programs.items():
            path = folder / "robot/scripts" / name
            path.write_text(text)
            path.chmod(0o755)
        (folder / "robot/launch/given.launch").write_text(LAUNCH.replace("{given}", given))
        return scan(folder, "given.launch").graph

    return graph


@pytest.fixture
def unread(scanned):
    """Return what the base does not read, with the near names."""

    def facts(given, more=""):
        found = [f for f in scanned(given, more).wiring if f.kind.endswith("_parameter")]
        assert all(f.evidence[0].file.endswith("given.launch") for f in found)
        return {(fact.subject, fact.value): fact.others for fact in found}

    return facts


def param(name, value="1.0"):
    return f'<param name="{name}" value="{value}"/>'


def test_a_near_name_that_nobody_sets_is_named(unread):
    assert unread(param("max_vell")) == {("/base", "max_vell"): ("max_vel",)}
    assert unread(param("wheel/radios")) == {("/base", "wheel/radios"): ("wheel/radius",)}


@pytest.mark.parametrize("name", ["vel", "wheel/max_vel", "rate"])
def test_another_word_or_group_is_not_near(unread, name):
    assert unread(param(name)) == {("/base", name): ()}


def test_a_near_name_that_is_set_too_is_not_meant(unread):
    assert unread(param("max_vel") + param("max_vell")) == {("/base", "max_vell"): ()}


@pytest.mark.parametrize("name", ["max_vel", "wheel/radius", "of_other", "own"])
def test_what_the_node_or_another_reads_is_read(unread, name):
    assert unread(param(name)) == {}


@pytest.mark.parametrize(
    "more",
    [
        "rospy.get_param('~')",
        "rospy.get_param('~' + unknown())",
        "exec(unknown())",
        "from dynamic_reconfigure.server import Server\nServer(unknown(), print)",
    ],
)
def test_of_a_node_that_may_read_all_nothing_is_known(unread, more):
    assert unread(param("max_vell"), more) == {}


def test_a_group_that_is_read_as_one_is_read(unread):
    assert unread(param("pid/kp"), "rospy.get_param('~pid')") == {}


def test_what_is_set_for_nodes_is_in_the_graph(scanned):
    given = (
        param("max_vel", "2")
        + "<rosparam>wheel: {sizes: [1, 2], bad: [[1]], far: .inf, all: [1.5, .nan]}</rosparam>"
    )
    values = {(p.node, p.name): p.value for p in scanned(given).parameters}
    assert values == {
        ("/base", "max_vel"): 2,
        ("/base", "wheel.sizes"): (1, 2),
        ("/base", "wheel.bad"): None,
        ("/base", "wheel.far"): None,
        ("/base", "wheel.all"): None,
    }


def test_the_timeout_of_a_controller_is_in_the_graph(scanned):
    outside = "<rosparam ns='/drive'>{cmd_vel_timeout: 0.0, other: 1}</rosparam>"
    graph = scanned(f"</node>{outside}<node pkg='robot' type='other.py' name='third'>")
    values = [(p.node, p.name, p.value) for p in graph.parameters]
    assert values == [("/drive", "cmd_vel_timeout", 0.0)]


def test_maps_in_a_list_are_parameters_of_the_node(scanned):
    given = "<rosparam>topics: [{name: a, topic: a_vel}, {topic: b_vel, priority: 2}]</rosparam>"
    found = {each.name: each.value for each in scanned(given).parameters}
    assert found["topics.0.topic"] == "a_vel"
    assert (found["topics.1.topic"], found["topics.1.priority"]) == ("b_vel", 2)
