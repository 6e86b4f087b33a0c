"""message_filters and tf's filters: what joins messages before a callback (ROS wiki)."""

from rtron.sources.code.interpreter.abstract_values.value_types import Instance, LibraryClass, Value
from rtron.sources.code.interpreter.execution.abstract_machine import AbstractMachine
from rtron.sources.code.interpreter.execution.arguments import Arguments
from rtron.sources.code.library_models.common.cpp_arguments import (
    message_type_of,
    name_arguments,
    register_callbacks,
    resolve_in_handle,
)
from rtron.sources.code.library_models.ros1_common import endpoints
from rtron.sources.code.library_models.roscpp.node_handle import handle_argument_or_default
from rtron.sources.declaration import DeclarationKind


def _filter_subscriber(machine: AbstractMachine, arguments: Arguments) -> Value:
    """`message_filters::Subscriber<T>(handle, topic, queue)`, or later by `subscribe`."""
    made = Instance(_FILTER_SUBSCRIBER, {}, arguments.types)
    if len(arguments.values) > 1:
        _filter_subscribe(machine, made, arguments)
    return made


def _filter_subscribe(machine: AbstractMachine, owner: Instance, arguments: Arguments) -> Value:
    names = name_arguments(arguments)
    topic = resolve_in_handle(
        machine, handle_argument_or_default(machine, arguments), names[0] if names else None
    )
    type = message_type_of(machine, owner.types[0] if owner.types else None, arguments)
    endpoints.declare_endpoint(machine, DeclarationKind.SUBSCRIBE, topic, type, arguments)
    return owner


_FILTER_SUBSCRIBER = LibraryClass(
    "message_filters::Subscriber",
    _filter_subscriber,
    {"subscribe": _filter_subscribe, "registerCallback": register_callbacks},
)
_SYNCHRONIZERS = (
    "message_filters::Synchronizer",
    "message_filters::TimeSynchronizer",
    "tf::MessageFilter",
    "tf2_ros::MessageFilter",
    "message_filters::Cache",
)

FILTER_CLASSES = {
    _FILTER_SUBSCRIBER.name: _FILTER_SUBSCRIBER,
    **{
        name: LibraryClass(name, methods={"registerCallback": register_callbacks})
        for name in _SYNCHRONIZERS
    },
}
