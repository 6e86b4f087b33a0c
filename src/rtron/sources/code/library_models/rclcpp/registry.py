"""rclcpp and the C++ libraries of ROS 2 around it, as far as they join nodes."""

from collections.abc import Callable, Mapping

from rtron.sources.code.interpreter import abstract_values as av
from rtron.sources.code.interpreter.execution.abstract_machine import AbstractMachine
from rtron.sources.code.interpreter.execution.arguments import Arguments
from rtron.sources.code.library_models.common.navigation_plugins import NAVIGATION_CLASSES
from rtron.sources.code.library_models.common.transforms import MESSAGE_CLASSES
from rtron.sources.code.library_models.common.trivial_functions import (
    return_argument,
    returning_unknown,
)
from rtron.sources.code.library_models.rclcpp import qos
from rtron.sources.code.library_models.rclcpp.behavior_tree_ros_nodes import (
    ROS_TREE_CLASSES,
    ROS_TREE_FUNCTIONS,
)
from rtron.sources.code.library_models.rclcpp.behavior_trees import TREE_CLASSES, TREE_FUNCTIONS
from rtron.sources.code.library_models.rclcpp.endpoints import ENDPOINT_FUNCTIONS
from rtron.sources.code.library_models.rclcpp.image_transport import IMAGE_CLASSES, IMAGE_FUNCTIONS
from rtron.sources.code.library_models.rclcpp.libraries import CONTROLLER_CLASSES, LIBRARY_CLASSES
from rtron.sources.code.library_models.rclcpp.nav2_util import NAV2_CLASSES, NAV2_FUNCTIONS
from rtron.sources.code.library_models.rclcpp.node import COMPONENT_CLASSES, NODE_CLASSES
from rtron.sources.code.library_models.rclcpp.parameters import PARAMETER_CLASSES
from rtron.sources.code.library_models.rclcpp.pluginlib import HARDWARE_CLASSES, PLUGIN_CLASSES
from rtron.sources.code.library_models.rclcpp.rclc import RCLC_FUNCTIONS
from rtron.sources.code.library_models.ros2_common.parameter_types import PARAMETER_TYPE_CONSTANTS

_INTERFACES = ("base", "clock", "graph", "logging", "parameters", "services", "timers", "topics")


def _replace_in_string(machine: AbstractMachine, _: object, arguments: Arguments) -> av.Value:
    """`std::replace(text.begin(), text.end(), '/', '_')` changes the text."""
    slot = arguments.slot(0)
    text = slot.holder.get(slot.key) if slot is not None else None
    old, new = arguments.get(2), arguments.get(3)
    known = [v.value for v in (text, old, new) if isinstance(v, av.Scalar) and av.is_text(v)]
    if slot is not None and text is not None:
        all_known = len(known) == len((text, old, new)) and isinstance(text, av.Scalar)
        after = av.Scalar(known[0].replace(known[1], known[2]), text.tainted) if all_known else None
        machine.undo_log.set(*slot, after or av.Unknown(slot.label))
    return av.NONE


def _package_share(machine: AbstractMachine, _: object, arguments: Arguments) -> av.Value:
    """`ament_index_cpp::get_package_share_directory(package)`: where its source lies."""
    name = arguments.get(0)
    files = machine.runtime.files
    path = files.package_path(str(name.value)) if isinstance(name, av.Scalar) else None
    return av.Unknown("package_share") if path is None else av.Scalar(str(path))


NAMESPACE_FUNCTIONS: Mapping[str, Callable[..., av.Value]] = {
    **{
        f"rclcpp::node_interfaces::get_node_{name}_interface": return_argument
        for name in _INTERFACES
    },
    "rclcpp::ok": returning_unknown("ok"),
    **{
        f"ament_index_cpp::get_package_share_{what}": _package_share
        for what in ("directory", "path")
    },
    "std::replace": _replace_in_string,
}

RCLCPP_CLASSES: dict[str, av.LibraryClass] = {
    **NODE_CLASSES,
    **PARAMETER_CLASSES,
    **qos.QOS_CLASSES,
    **qos.OVERRIDING_CLASSES,
    **LIBRARY_CLASSES,
    **NAV2_CLASSES,
    **NAVIGATION_CLASSES,
    **IMAGE_CLASSES,
    **PLUGIN_CLASSES,
    **TREE_CLASSES,
    **ROS_TREE_CLASSES,
    **COMPONENT_CLASSES,
    **CONTROLLER_CLASSES,
    **HARDWARE_CLASSES,
    **MESSAGE_CLASSES,
}
RCLCPP_FUNCTIONS = {
    name: av.LibraryFunction(name, call)
    for name, call in {
        **ENDPOINT_FUNCTIONS,
        **IMAGE_FUNCTIONS,
        **qos.QOS_FUNCTIONS,
        **qos.OVERRIDING_FUNCTIONS,
        **NAMESPACE_FUNCTIONS,
        **TREE_FUNCTIONS,
        **ROS_TREE_FUNCTIONS,
        **NAV2_FUNCTIONS,
        **RCLC_FUNCTIONS,
    }.items()
}
RCLCPP_CONSTANTS: dict[str, av.Value] = {
    **qos.QOS_CONSTANTS,
    **qos.OVERRIDING_CONSTANTS,
    **PARAMETER_TYPE_CONSTANTS,
}
