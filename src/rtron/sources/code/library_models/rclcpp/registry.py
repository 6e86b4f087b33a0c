"""rclcpp and the C++ libraries of ROS 2 around it, as far as they join nodes."""

from rtron.sources.code.interpreter.abstract_values.value_types import (
    LibraryClass,
    LibraryFunction,
    Value,
)
from rtron.sources.code.library_models.rclcpp.behavior_trees import TREE_CLASSES, TREE_FUNCTIONS
from rtron.sources.code.library_models.rclcpp.component_manager import COMPONENT_CLASSES
from rtron.sources.code.library_models.rclcpp.controllers import CONTROLLER_CLASSES
from rtron.sources.code.library_models.rclcpp.endpoints import ENDPOINT_FUNCTIONS
from rtron.sources.code.library_models.rclcpp.functions import NAMESPACE_FUNCTIONS
from rtron.sources.code.library_models.rclcpp.image_transport import IMAGE_CLASSES, IMAGE_FUNCTIONS
from rtron.sources.code.library_models.rclcpp.libraries import LIBRARY_CLASSES
from rtron.sources.code.library_models.rclcpp.node import NODE_CLASSES
from rtron.sources.code.library_models.rclcpp.parameters import PARAMETER_CLASSES
from rtron.sources.code.library_models.rclcpp.pluginlib import PLUGIN_CLASSES
from rtron.sources.code.library_models.rclcpp.qos import QOS_CLASSES, QOS_CONSTANTS, QOS_FUNCTIONS
from rtron.sources.code.library_models.rclcpp.qos_overrides import (
    OVERRIDING_CLASSES,
    OVERRIDING_CONSTANTS,
    OVERRIDING_FUNCTIONS,
)
from rtron.sources.code.library_models.ros2_common.parameter_types import PARAMETER_TYPE_CONSTANTS

RCLCPP_CLASSES: dict[str, LibraryClass] = {
    **NODE_CLASSES,
    **PARAMETER_CLASSES,
    **QOS_CLASSES,
    **OVERRIDING_CLASSES,
    **LIBRARY_CLASSES,
    **IMAGE_CLASSES,
    **PLUGIN_CLASSES,
    **TREE_CLASSES,
    **COMPONENT_CLASSES,
    **CONTROLLER_CLASSES,
}
RCLCPP_FUNCTIONS = {
    name: LibraryFunction(name, call)
    for name, call in {
        **ENDPOINT_FUNCTIONS,
        **IMAGE_FUNCTIONS,
        **QOS_FUNCTIONS,
        **OVERRIDING_FUNCTIONS,
        **NAMESPACE_FUNCTIONS,
        **TREE_FUNCTIONS,
    }.items()
}
RCLCPP_CONSTANTS: dict[str, Value] = {
    **QOS_CONSTANTS,
    **OVERRIDING_CONSTANTS,
    **PARAMETER_TYPE_CONSTANTS,
}
