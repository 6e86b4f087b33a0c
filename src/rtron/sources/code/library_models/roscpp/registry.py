"""The functions of roscpp that stand in namespaces (ROS wiki: roscpp/Overview)."""

from collections.abc import Callable, Mapping

from rtron.sources.code.interpreter import abstract_values as av
from rtron.sources.code.interpreter.execution.abstract_machine import AbstractMachine
from rtron.sources.code.interpreter.execution.arguments import Arguments
from rtron.sources.code.library_models.common.command_lines import write_without_remappings
from rtron.sources.code.library_models.common.cpp_arguments import message_type_of
from rtron.sources.code.library_models.common.navigation_plugins import NAVIGATION_CLASSES
from rtron.sources.code.library_models.common.transforms import MESSAGE_CLASSES
from rtron.sources.code.library_models.common.trivial_functions import (
    return_argument,
    returning_unknown,
)
from rtron.sources.code.library_models.ros1_common import endpoints
from rtron.sources.code.library_models.ros1_common.names import (
    node_namespace,
    remap_name,
    resolve_name,
)
from rtron.sources.code.library_models.roscpp import node_handle, parameters
from rtron.sources.code.library_models.roscpp.image_transport import IMAGE_CLASSES
from rtron.sources.code.library_models.roscpp.libraries import FILTER_CLASSES, SERVER_CLASSES
from rtron.sources.code.library_models.roscpp.plugins import NODELET_CLASSES, PLUGIN_CLASSES
from rtron.sources.declaration import DeclarationKind


def _with_node_handle(method: Callable[..., av.Value]) -> Callable[..., av.Value]:
    """`ros::param::get` and the like resolve in the node's own namespace."""

    def called(machine: AbstractMachine, _: object, arguments: Arguments) -> av.Value:
        return method(machine, node_handle.handle(av.Scalar(node_namespace(machine))), arguments)

    return called


def _wait_for_message(machine: AbstractMachine, _: object, arguments: Arguments) -> av.Value:
    """`ros::topic::waitForMessage<T>(topic, handle)`."""
    owner = node_handle.handle_argument(arguments) or node_handle.handle(
        av.Scalar(node_namespace(machine))
    )
    node_handle.subscribe(machine, owner, arguments)
    return av.Unknown("message")


def _resolve(machine: AbstractMachine, _: object, arguments: Arguments) -> av.Value:
    return remap_name(machine, resolve_name(machine, arguments.value(len(arguments.values) - 1)))


def _append(_: AbstractMachine, __: object, arguments: Arguments) -> av.Value:
    left, right = arguments.value(0), arguments.value(1)
    return av.concat((left, av.Scalar("/"), right))


def _call_service(machine: AbstractMachine, _: object, arguments: Arguments) -> av.Value:
    """`ros::service::call("name", service)`."""
    name = resolve_name(machine, arguments.value(0))
    service = arguments.get(1)
    made = service.type if isinstance(service, av.Unknown) else None
    type = message_type_of(machine, made, arguments)
    endpoints.declare_endpoint(machine, DeclarationKind.SERVICE_CLIENT, name, type, arguments)
    return av.Unknown("call")


def _init(machine: AbstractMachine, _: object, arguments: Arguments) -> av.Value:
    """`ros::init(argc, argv, name)`, or with remaps instead of the command line."""
    if isinstance(arguments.get(0), (av.MapValue, av.ListValue)):
        node_handle.note_program_remaps(machine, arguments)
    return av.NONE


ROSCPP_FUNCTIONS: Mapping[str, Callable[..., av.Value]] = {
    "ros::param::get": _with_node_handle(parameters.get_param),
    "ros::param::getCached": _with_node_handle(parameters.get_param),
    "ros::param::param": _with_node_handle(parameters.param),
    "ros::param::has": _with_node_handle(parameters.has_param),
    "ros::param::set": _with_node_handle(parameters.set_param),
    "ros::param::search": _with_node_handle(parameters.search_param),
    "ros::topic::waitForMessage": _wait_for_message,
    "ros::init": _init,
    "ros::removeROSArgs": write_without_remappings,
    "ros::service::call": _call_service,
    "ros::this_node::getName": lambda machine, __, ___: av.Scalar(
        machine.recorder.site.process_name
    ),
    "ros::this_node::getNamespace": lambda machine, __, ___: av.Scalar(node_namespace(machine)),
    "ros::names::resolve": _resolve,
    "ros::names::remap": _resolve,
    "ros::names::append": _append,
    "ros::names::clean": return_argument,
    "ros::AdvertiseServiceOptions::create": node_handle.create_options,
    "ros::AdvertiseOptions::create": node_handle.create_options,
    "ros::SubscribeOptions::create": node_handle.create_options,
    "ros::ok": returning_unknown("ok"),
}

ROSCPP_CLASSES: dict[str, av.LibraryClass] = {
    **node_handle.HANDLE_CLASSES,
    **IMAGE_CLASSES,
    **FILTER_CLASSES,
    **PLUGIN_CLASSES,
    **NAVIGATION_CLASSES,
    **NODELET_CLASSES,
    **SERVER_CLASSES,
    **MESSAGE_CLASSES,
}
ROSCPP_FUNCTION_VALUES = {
    name: av.LibraryFunction(name, call) for name, call in ROSCPP_FUNCTIONS.items()
}
