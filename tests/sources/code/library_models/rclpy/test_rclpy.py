"""What rclpy's nodes declare (docs.ros.org: rclpy)."""

import pytest
from ros2_runs import (
    UNLAUNCHED,
    explicit_declarations,
    implicit_declarations,
    names,
    only_declaration,
    python,
    settings,
)

from rtron.vocabulary import Durability, QoS, Reliability, Resolution

QOS_NAMES = """(QoSProfile, ReliabilityPolicy, QoSDurabilityPolicy, DurabilityPolicy,
QoSPresetProfiles, qos_profile_sensor_data)"""
BEST, TRANSIENT = Reliability.BEST_EFFORT, Durability.TRANSIENT_LOCAL


@pytest.mark.parametrize(
    ("line", "expected"),
    [
        ("self.create_publisher(Bool, 't', 1)", "publish /ns/t std_msgs/msg/Bool"),
        ("self.create_publisher(Bool, '~/t', 1)", "publish /ns/n/t std_msgs/msg/Bool"),
        ("self.create_publisher(msg_type=Bool, topic='/t', qos_profile=1)",
         "publish /t std_msgs/msg/Bool"),
        ("self.create_subscription(Bool, f'{self.get_name()}/t', lambda m: None, 1)",
         "subscribe /ns/n/t std_msgs/msg/Bool"),
        ("self.create_service(Trigger, 's', lambda a, b: b)", "service /ns/s std_srvs/srv/Trigger"),
        ("self.create_client(Trigger, 's')", "service_client /ns/s std_srvs/srv/Trigger"),
        ("ActionServer(self, Dock, 'd', lambda g: None)", "action_server /ns/d a_msgs/action/Dock"),
        ("ActionClient(self, Dock, 'd')", "action_client /ns/d a_msgs/action/Dock"),
        ("message_filters.Subscriber(self, Bool, 't')", "subscribe /ns/t std_msgs/msg/Bool"),
        ("wait_for_message(Bool, self, 't')", "subscribe /ns/t std_msgs/msg/Bool"),
    ],
)  # fmt: skip
def test_each_call_is_found(line, expected):
    top = """import message_filters
from rclpy.action import ActionClient, ActionServer
from rclpy.wait_for_message import wait_for_message
from std_srvs.srv import Trigger
from a_msgs.action import Dock"""
    assert explicit_declarations(python(line, top)) == [expected]


@pytest.mark.parametrize(
    ("line", "expected"),
    [
        ("self.create_publisher(get_message('std_msgs/msg/Float64'), 't', 1)",
         "publish /ns/t std_msgs/msg/Float64"),
        ("self.create_client(get_service('a/srv/Do'), 's')", "service_client /ns/s a/srv/Do"),
        ("ActionClient(self, get_action('a/action/Do'), 'd')", "action_client /ns/d a/action/Do"),
        ("self.create_publisher(get_message('a/srv/Do'), 't', 1)", "publish /ns/t "),
        ("self.create_publisher(get_message(unknown()), 't', 1)", "publish /ns/t "),
    ],
)  # fmt: skip
def test_an_interface_may_be_named_by_a_text(line, expected):
    top = """from rclpy.action import ActionClient
from rosidl_runtime_py.utilities import get_action, get_message, get_service"""
    assert explicit_declarations(python(line, top)) == [expected]


def test_without_a_launch_the_source_names_the_node():
    found = python("self.create_publisher(Bool, '~/t', 1)", **UNLAUNCHED)
    assert names(found) == ["/written/t"]
    assert [node.name for node in found.nodes] == ["/written"]


def test_a_node_may_be_created_without_a_class():
    top = "other = rclpy.create_node('other', namespace='far', use_global_arguments=False)"
    assert names(python("other.create_publisher(Bool, 't', 1)", top)) == ["/far/t"]


def test_what_is_imported_from_the_module_that_defines_it():
    top = """from a_msgs.action._dock import Dock
from rclpy.action.server import ActionServer
from std_msgs.msg._float64 import Float64
from std_srvs.srv import Trigger"""
    body = """self.create_publisher(Float64, 't', 1)
ActionServer(self, Dock, 'd', lambda g: None)
self.create_publisher(Trigger.Request, 'u', 1)"""
    assert explicit_declarations(python(body, top)) == [
        "publish /ns/t std_msgs/msg/Float64",
        "action_server /ns/d a_msgs/action/Dock",
        "publish /ns/u ",
    ]


@pytest.mark.parametrize(
    ("written_qos", "expected"),
    [
        ("7", QoS(depth=7)),
        ("QoSProfile(depth=3)", QoS(depth=3)),
        ("QoSProfile(depth=3, reliability=ReliabilityPolicy.BEST_EFFORT)",
         QoS(depth=3, reliability=BEST)),
        ("QoSProfile(depth=1, durability=QoSDurabilityPolicy.TRANSIENT_LOCAL)",
         QoS(depth=1, durability=TRANSIENT)),
        ("qos_profile_sensor_data", QoS(depth=5, reliability=BEST)),
        ("QoSPresetProfiles.SENSOR_DATA.value", QoS(depth=5, reliability=BEST)),
        ("profile", QoS(depth=9, durability=TRANSIENT)),
        ("QoSProfile(depth=3, reliability=who_knows())", None),
    ],
)  # fmt: skip
@pytest.mark.parametrize("imported", ["*", QOS_NAMES])
def test_a_literal_quality_of_service_is_read(written_qos, expected, imported):
    top = f"""from rclpy.qos import {imported}
profile = QoSProfile(depth=9)
profile.durability = DurabilityPolicy.TRANSIENT_LOCAL"""
    assert (
        only_declaration(python(f"self.create_publisher(Bool, 't', {written_qos})", top)).qos
        == expected
    )


@pytest.mark.parametrize(
    "read",
    [
        "self.declare_parameter('topic', 'default').value",
        "self.declare_parameter('topic', 'default').get_parameter_value().string_value",
        "self.declare_parameters('', [('topic', 'default')])[0].value",
        "(self.declare_parameter('topic', 'default'), self.get_parameter('topic').value)[1]",
        "self.get_parameter_or('topic', Parameter('x', Parameter.Type.STRING, 'default')).value",
    ],
)
@pytest.mark.parametrize(
    ("given", "expected"), [({}, "/ns/default"), ({"topic": "other"}, "/ns/other")]
)
def test_a_parameter_is_read_in_many_ways(read, given, expected):
    top = "from rclpy.parameter import Parameter"
    found = only_declaration(
        python(f"self.create_publisher(Bool, {read}, 1)", top, settings=settings(**given))
    )
    assert found.name == expected
    assert found.resolution is Resolution.PARAMETER or not given


BELOW_A_PREFIX = """for name, value in {}.get_parameters_by_prefix('in').items():
    self.create_subscription(Bool, value.value, lambda m: None, 1)"""
GIVEN = settings(in__a="first", in__b="second", out__c="third")


def test_parameters_below_a_prefix_are_those_that_are_declared():
    declared = "self.declare_parameter('in.b', 'unused')\n"
    found = python(declared + BELOW_A_PREFIX.format("self"), settings=GIVEN)
    assert names(found) == ["/ns/second"]


def test_a_node_that_declares_what_a_launch_sets_has_all_of_it():
    """Only a node with `automatically_declare_parameters_from_overrides` does, in rclpy too."""
    made = "other = Node('o', automatically_declare_parameters_from_overrides=True)\n"
    found = python(made + BELOW_A_PREFIX.format("other"), settings=GIVEN)
    assert names(found) == ["/ns/first", "/ns/second"]


def test_what_callbacks_make_is_found():
    body = "self.create_timer(1.0, self.tick)"
    members = "def tick(self):\n    self.create_publisher(Bool, 'late', 1)"
    assert names(python(body, members=members)) == ["/ns/late"]


def test_a_base_class_of_the_workspace_declares_too():
    top = """class Base(Node):
    def __init__(self, name, topic):
        super().__init__(name)
        self.create_publisher(Bool, topic, 1)
class Other(Base):
    def __init__(self):
        super().__init__('other', 'based')"""
    assert names(python("Other()", top, **UNLAUNCHED)) == ["/based"]


def test_transforms_are_marked():
    top = "from tf2_ros import Buffer, StaticTransformBroadcaster, TransformListener"
    body = """self.buffer = Buffer()
self.listener = TransformListener(self.buffer, self)
StaticTransformBroadcaster(self)"""
    found = implicit_declarations(python(body, top))
    assert found >= {"subscribe /tf", "subscribe /tf_static", "publish /tf_static"}
    assert "publish /tf" not in found


def test_a_lifecycle_node_is_configured():
    top = """from rclpy.lifecycle import LifecycleNode, TransitionCallbackReturn
class Managed(LifecycleNode):
    def __init__(self):
        super().__init__('managed')
    def on_configure(self, state):
        self.create_lifecycle_publisher(Bool, 'configured', 1)
        return TransitionCallbackReturn.SUCCESS"""
    found = python("Managed()", top, **UNLAUNCHED)
    assert names(found) == ["/configured"]
    own = "service_client /managed/change_state"
    assert "service /managed/change_state" in implicit_declarations(found) - {own}
    found = python("Managed().trigger_activate()", top, **UNLAUNCHED)
    assert own in implicit_declarations(found)


def test_simulated_time_is_a_subscription():
    assert "subscribe /clock" in implicit_declarations(
        python("pass", settings=settings(use_sim_time=True))
    )
    assert "subscribe /clock" not in implicit_declarations(python("pass"))


def test_no_name_of_ros_1_is_a_library_of_ros_2():
    found = python("rospy.Publisher('old', Bool)", "import rospy")
    assert names(found) == []


@pytest.mark.parametrize("automatic", [True, False])
def test_what_is_set_is_declared_where_the_node_says_so(automatic):
    top = "other = rclpy.create_node('other', automatically_declare_parameters_from_overrides="
    found = python("pass", f"{top}{automatic})", settings=settings(of_all=2), has_launch_name=False)
    assert (("of_all", 2) in {(p.name, p.value) for p in found.parameters}) is automatic


@pytest.mark.parametrize("simulated", [True, False])
def test_use_sim_time_is_a_parameter_of_every_node(simulated):
    found = python("pass", settings=settings(use_sim_time=True) if simulated else ()).parameters
    assert [(p.node, p.name, p.value) for p in found] == [("/ns/n", "use_sim_time", simulated)]


def test_a_class_that_nothing_makes_is_noted_by_its_name():
    top = """class Unused(Node):
    def __init__(self):
        super().__init__('unused')
        self.create_publisher(Bool, 't', 1)"""
    found = python("self.create_publisher(Bool, 'u', 1)", top)
    assert explicit_declarations(found) == ["publish /ns/u std_msgs/msg/Bool"]
    (note,) = found.unresolved
    assert note.what == "Unused()"
    assert "nothing that is seen calls it" in note.why


FOREIGN = """from other_library import node, process
class Foreign(node.Node):
    def __init__(self):
        super().__init__('foreign')
        self.create_subscription(Bool, 'obeyed', lambda message: None, 1)
    def setup(self):
        self.create_publisher(Bool, 'hooked', 1)
class Tree(node.Leaf):
    def __init__(self, ros):
        super().__init__('tree')
        self.ros = ros
        ros.create_publisher(Bool, 'lent', 1)"""


def test_a_base_class_that_is_not_here_is_a_node_if_the_class_makes_endpoints():
    found = python("Foreign()\nTree(self)", FOREIGN, **UNLAUNCHED)
    assert sorted(names(found)) == ["/hooked", "/lent", "/obeyed"]
    assert {node.name for node in found.nodes} == {"/written", "/foreign"}
    (note,) = [note.why for note in found.unresolved if note.what == "class Foreign"]
    assert note.startswith("its base class other_library.node.Node is not in the source: ")


def test_a_library_that_is_not_here_makes_the_node_whose_class_it_gets():
    made = ["/hooked", "/obeyed"]
    assert sorted(names(python("process.spin(Foreign)", FOREIGN, **UNLAUNCHED))) == made
    twice = python("process.spin(Foreign)\nForeign()", FOREIGN, **UNLAUNCHED)
    assert sorted(names(twice)) == made
    assert names(python("isinstance(self, Foreign)", FOREIGN, **UNLAUNCHED)) == []


def test_classes_that_are_no_nodes_take_no_turn_of_one_that_is():
    body = "process.spin(Tree)\n" * 450 + "process.spin(Foreign)"
    assert "/obeyed" in names(python(body, FOREIGN, **UNLAUNCHED))


def test_a_call_on_a_node_that_is_not_known_hides_endpoints():
    (note,) = python("Node.create_publisher(unknown(), Bool, 't', 1)").unresolved
    assert note.hides == "endpoints"
