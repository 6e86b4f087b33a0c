"""message_filters and tf's filters: what joins messages before a callback (ROS wiki)."""

from rtron.sources.code.interpreter.abstract_values.value_types import Instance, NativeClass, Value
from rtron.sources.code.interpreter.execution.abstract_machine import Machine
from rtron.sources.code.interpreter.execution.arguments import Arguments
from rtron.sources.code.library_models.common.cpp_arguments import (
    in_handle,
    message_of,
    take_callbacks,
    texts,
)
from rtron.sources.code.library_models.ros1_common import endpoints
from rtron.sources.code.library_models.roscpp.node_handle import handle_among
from rtron.sources.declaration import DeclarationKind


def _filter_subscriber(machine: Machine, arguments: Arguments) -> Value:
    """`message_filters::Subscriber<T>(handle, topic, queue)`, or later by `subscribe`."""
    made = Instance(_FILTER, {}, arguments.types)
    if len(arguments.values) > 1:
        _filter_subscribe(machine, made, arguments)
    return made


def _filter_subscribe(machine: Machine, owner: Instance, arguments: Arguments) -> Value:
    names = texts(arguments)
    topic = in_handle(machine, handle_among(machine, arguments), names[0] if names else None)
    type = message_of(machine, owner.types[0] if owner.types else None, arguments)
    endpoints.declare(machine, DeclarationKind.SUBSCRIBE, topic, type, arguments)
    return owner


_FILTER = NativeClass(
    "message_filters::Subscriber",
    _filter_subscriber,
    {"subscribe": _filter_subscribe, "registerCallback": take_callbacks},
)
_SYNCHRONIZERS = (
    "message_filters::Synchronizer",
    "message_filters::TimeSynchronizer",
    "tf::MessageFilter",
    "tf2_ros::MessageFilter",
    "message_filters::Cache",
)

FILTER_CLASSES = {
    _FILTER.name: _FILTER,
    **{
        name: NativeClass(name, methods={"registerCallback": take_callbacks})
        for name in _SYNCHRONIZERS
    },
}
