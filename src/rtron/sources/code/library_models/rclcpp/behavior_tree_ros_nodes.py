"""Tree nodes that join ROS: bases of nav2_behavior_tree, and of BehaviorTree.ROS2.

Sources: nav2_behavior_tree, bt_action_node.hpp, bt_cancel_action_node.hpp, bt_service_node.hpp;
behaviortree_ros2, bt_action_node.hpp, bt_service_node.hpp, bt_topic_pub_node.hpp,
bt_topic_sub_node.hpp. The source of Nav2 counts before its model.
"""

from collections.abc import Callable, Mapping
from functools import partial
from typing import TypeAlias

from rtron.sources.code.interpreter import abstract_values as av
from rtron.sources.code.interpreter.execution.abstract_machine import AbstractMachine
from rtron.sources.code.interpreter.execution.arguments import Arguments
from rtron.sources.code.library_models.common.cpp_arguments import template_message_type
from rtron.sources.code.library_models.common.trivial_functions import return_argument
from rtron.sources.code.library_models.rclcpp import behavior_trees
from rtron.sources.code.library_models.ros2_common import endpoints
from rtron.sources.code.library_models.ros2_common.nodes import first_node
from rtron.sources.declaration import DeclarationKind
from rtron.vocabulary import QoS

REGISTER_FUNCTION = "BT_RegisterRosNodeFromPlugin"
"""What CreateRosNodePlugin defines (behaviortree_ros2/plugins.hpp)."""

_Maker: TypeAlias = Callable[[AbstractMachine, Arguments], av.Value]
_ACTION, _SERVICE = DeclarationKind.ACTION_CLIENT, DeclarationKind.SERVICE_CLIENT
_NODE_FIELD, _PORT_FIELD = "nh", "default_port_value"
_NO_NAMES = frozenset({"", "__default__placeholder__"})
_TOPIC_QOS = QoS(depth=1)


def _make_nav2_node(
    kind: DeclarationKind, port: str, name_at: int, machine: AbstractMachine, arguments: Arguments
) -> av.Value:
    """`BtActionNode(tag, action_name, config)`, `BtServiceNode(name, config, service_name)`."""
    made = behavior_trees.make_tree_node(machine, arguments)
    node = behavior_trees.blackboard_entry(made, "node")
    name = behavior_trees.port_value(machine, made, port, arguments)
    if _is_unnamed(name):
        name = arguments.get(name_at) or av.Unknown(f"~{port}", tainted=True)
    return _join(kind, machine, made, (node, name), arguments)


def _make_plain_node(
    kind: DeclarationKind, port: str, machine: AbstractMachine, arguments: Arguments
) -> av.Value:
    """`RosActionNode(instance_name, config, params)`, and the others of its kind."""
    made = behavior_trees.make_tree_node(machine, arguments)
    params = next((v for v in arguments.values if _is_params(v)), None)
    fields = params.fields if isinstance(params, av.Instance) else {}
    name = behavior_trees.port_value(machine, made, port, arguments)
    if _is_unnamed(name):
        name = fields.get(_PORT_FIELD, av.Unknown(f"~{port}", tainted=True))
    return _join(kind, machine, made, (fields.get(_NODE_FIELD, av.UNKNOWN), name), arguments)


def _is_unnamed(name: av.Value | None) -> bool:
    return name is None or (isinstance(name, av.Scalar) and name.value in _NO_NAMES)


def _join(
    kind: DeclarationKind,
    machine: AbstractMachine,
    made: av.Instance,
    joined: tuple[av.Value, av.Value | None],
    arguments: Arguments,
) -> av.Value:
    """Record what a tree node makes by a name at the ROS node that it is given."""
    owner, name = joined
    node = first_node((owner,))
    made.fields["node_"] = owner
    if node is None:
        endpoints.note_unknown_node(machine, kind.value, name, arguments)
        return made
    type = template_message_type(machine, arguments)
    qos = _TOPIC_QOS if kind in {DeclarationKind.PUBLISH, DeclarationKind.SUBSCRIBE} else None
    endpoints.declare_endpoint(machine, kind, node, name, type, arguments, qos=qos)
    return made


def _make_params(_: AbstractMachine, arguments: Arguments) -> av.Value:
    """`BT::RosNodeParams(node, default_port_value)`."""
    names = zip((_NODE_FIELD, _PORT_FIELD), arguments.values, strict=False)
    return av.Instance(_PARAMS, dict(names))


def _is_params(value: av.Value) -> bool:
    return isinstance(value, av.Instance) and value.type is _PARAMS


def _register_plugin(machine: AbstractMachine, _: object, arguments: Arguments) -> av.Value:
    """`RegisterRosNode(factory, path, params)`."""
    factory = arguments.get(0)
    if isinstance(factory, av.Instance):
        behavior_trees.register_library(
            machine, factory, arguments.without_first(1), REGISTER_FUNCTION
        )
    return av.Scalar(None)


_PARAMS = av.LibraryClass("BT::RosNodeParams", _make_params)
_METHODS = {**behavior_trees.TREE_NODE.methods, "providedBasicPorts": return_argument}
"""The ports of the bases themselves have no defaults."""
_NAV2_CALLBACKS = (
    *("on_tick", "on_wait_for_result", "on_success", "on_aborted", "on_cancelled"),
    *("on_completion", "on_server_unavailable", "on_timeout"),
)
_PLAIN_CALLBACKS = (
    *("setGoal", "setRequest", "setMessage", "onTick", "onFeedback", "onResultReceived"),
    *("onResponseReceived", "onFailure", "onHalt"),
)
_NAV2: Mapping[str, _Maker] = {
    "BtActionNode": partial(_make_nav2_node, _ACTION, "server_name", 1),
    "BtCancelActionNode": partial(_make_nav2_node, _ACTION, "server_name", 1),
    "BtServiceNode": partial(_make_nav2_node, _SERVICE, "service_name", 2),
}
_PLAIN: Mapping[str, _Maker] = {
    "RosActionNode": partial(_make_plain_node, _ACTION, "action_name"),
    "RosServiceNode": partial(_make_plain_node, _SERVICE, "service_name"),
    "RosTopicPubNode": partial(_make_plain_node, DeclarationKind.PUBLISH, "topic_name"),
    "RosTopicSubNode": partial(_make_plain_node, DeclarationKind.SUBSCRIBE, "topic_name"),
}
ROS_TREE_CLASSES: Mapping[str, av.LibraryClass] = {
    _PARAMS.name: _PARAMS,
    **{
        f"nav2_behavior_tree::{name}": av.LibraryClass(
            f"nav2_behavior_tree::{name}", make, _METHODS, _NAV2_CALLBACKS, over_source=False
        )
        for name, make in _NAV2.items()
    },
    **{
        f"BT::{name}": av.LibraryClass(f"BT::{name}", make, _METHODS, _PLAIN_CALLBACKS)
        for name, make in _PLAIN.items()
    },
}
ROS_TREE_FUNCTIONS: Mapping[str, Callable[..., av.Value]] = {"RegisterRosNode": _register_plugin}
