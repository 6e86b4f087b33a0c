"""A class of one's own made from one of ROS declares what its base does, however it calls that."""

import pytest
import ros2_runs
from ros1_runs import run_text

HEAD = "import rospy, actionlib, message_filters\nfrom std_msgs.msg import Bool\n"
BASES = {
    "rospy.Publisher": "publish",
    "rospy.Subscriber": "subscribe",
    "rospy.Service": "service",
    "rospy.ServiceProxy": "service_client",
    "message_filters.Subscriber": "subscribe",
    "actionlib.SimpleActionServer": "action_server",
    "actionlib.ActionServer": "action_server",
    "actionlib.SimpleActionClient": "action_client",
}
CALLS = {
    "by its name": "{base}.__init__(self, name, Bool, self.run)",
    "super": "super().__init__(name, Bool, self.run)",
    "super of Python 2": "super(C, self).__init__(name, Bool, self.run)",
    "with a variable": "b = {base}; b.__init__(self, name, Bool, self.run)",
    "with what it gets": "{base}.__init__(self, *(name, Bool), **dict())",
}


@pytest.mark.parametrize("base", BASES)
@pytest.mark.parametrize("call", CALLS.values(), ids=CALLS)
def test_a_class_of_rospy_is_a_base(base, call):
    init = f"    def __init__(self, name): {call.format(base=base)}\n    def run(self, m): pass\n"
    interface = run_text(f"{HEAD}class C({base}):\n{init}C('x')\n")
    (found,) = interface.declarations
    assert (found.kind, found.name) == (BASES[base], "/ns/x")
    assert interface.unresolved == ()


def test_a_callback_of_a_base_runs():
    body = "    def __init__(self): rospy.Subscriber.__init__(self, 'x', Bool, self.run)\n"
    run = "    def run(self, message): rospy.Publisher('y', Bool)\n"
    interface = run_text(f"{HEAD}class C(rospy.Subscriber):\n{body}{run}C()\n")
    assert [found.name for found in interface.declarations] == ["/ns/x", "/ns/y"]


def test_two_classes_of_one_base_reach_it_once():
    mixins = "class A(rospy.Publisher):\n    def __init__(self, n): super().__init__(n + 'a')\n"
    mixins += "class B(rospy.Publisher):\n    def __init__(self, n): super().__init__(n, Bool)\n"
    (found,) = run_text(f"{HEAD}{mixins}class C(A, B): pass\nC('x')\n").declarations
    assert found.name == "/ns/xa"


ROS2 = {
    "Node.__init__(self, 'made'); self.create_publisher(Bool, 'x', 1)": "publish",
    "super().__init__('made'); self.create_subscription(Bool, 'x', print, 1)": "subscribe",
    "ActionServer.__init__(self, N('n'), Bool, 'x', print)": "action_server",
    "super().__init__(N('n'), Bool, 'x')": "action_client",
}


@pytest.mark.parametrize("init", ROS2)
def test_a_class_of_rclpy_is_a_base(init):
    base = {"action_server": "ActionServer", "action_client": "ActionClient"}.get(
        ROS2[init], "Node"
    )
    text = "from rclpy.node import Node\nfrom rclpy.action import ActionClient, ActionServer\n"
    text += "from std_msgs.msg import Bool\nclass N(Node): pass\n"
    text += f"class C({base}):\n    def __init__(self): {init}\ndef main(): C()\n"
    found = ros2_runs.run_text(text, "py")
    assert [d.kind for d in found.declarations if not d.implicit] == [ROS2[init]]
    assert found.unresolved == ()
