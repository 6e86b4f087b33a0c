"""The functions of roscpp that stand in namespaces (ROS wiki: roscpp/Overview)."""

from collections.abc import Callable, Mapping

from rtron.sources.code.interpreter.abstract_values.value_types import (
    NONE,
    Hole,
    Known,
    ListValue,
    MapValue,
    Value,
    concat,
)
from rtron.sources.code.interpreter.execution.abstract_machine import Machine
from rtron.sources.code.interpreter.execution.arguments import Arguments
from rtron.sources.code.library_models.common.cpp_arguments import message_of
from rtron.sources.code.library_models.ros1_common import endpoints
from rtron.sources.code.library_models.ros1_common.names import node_namespace, remapped, resolve
from rtron.sources.code.library_models.roscpp.node_handle import (
    given_handle,
    handle,
    note_remaps,
    subscribe,
)
from rtron.sources.code.library_models.roscpp.options import options_of
from rtron.sources.code.library_models.roscpp.parameters import (
    get_param,
    has_param,
    param,
    search_param,
    set_param,
)
from rtron.sources.declaration import DeclarationKind

_UNKNOWN = Hole("?")


def _without_handle(method: Callable[..., Value]) -> Callable[..., Value]:
    """`ros::param::get` and its kin resolve in the node's own namespace."""

    def called(machine: Machine, _: object, arguments: Arguments) -> Value:
        return method(machine, handle(Known(node_namespace(machine))), arguments)

    return called


def _wait_for_message(machine: Machine, _: object, arguments: Arguments) -> Value:
    """`ros::topic::waitForMessage<T>(topic, handle)`."""
    owner = given_handle(arguments) or handle(Known(node_namespace(machine)))
    subscribe(machine, owner, arguments)
    return Hole("message")


def _node_name(machine: Machine, _: object, __: Arguments) -> Value:
    return Known(machine.recorder.site.name)


def _node_namespace(machine: Machine, _: object, __: Arguments) -> Value:
    return Known(node_namespace(machine))


def _resolve(machine: Machine, _: object, arguments: Arguments) -> Value:
    return remapped(machine, resolve(machine, arguments.get(len(arguments.values) - 1) or _UNKNOWN))


def _append(_: Machine, __: object, arguments: Arguments) -> Value:
    left, right = arguments.get(0) or _UNKNOWN, arguments.get(1) or _UNKNOWN
    return concat((left, Known("/"), right))


def _call_service(machine: Machine, _: object, arguments: Arguments) -> Value:
    """`ros::service::call("name", service)`."""
    name = resolve(machine, arguments.get(0) or _UNKNOWN)
    service = arguments.get(1)
    made = service.type if isinstance(service, Hole) else None
    type = message_of(machine, made, arguments)
    endpoints.declare(machine, DeclarationKind.SERVICE_CLIENT, name, type, arguments)
    return Hole("call")


def _init(machine: Machine, _: object, arguments: Arguments) -> Value:
    """`ros::init(argc, argv, name)`, or with remaps in the place of the command line."""
    if isinstance(arguments.get(0), (MapValue, ListValue)):
        note_remaps(machine, arguments)
    return NONE


FUNCTIONS: Mapping[str, Callable[..., Value]] = {
    "ros::param::get": _without_handle(get_param),
    "ros::param::getCached": _without_handle(get_param),
    "ros::param::param": _without_handle(param),
    "ros::param::has": _without_handle(has_param),
    "ros::param::set": _without_handle(set_param),
    "ros::param::search": _without_handle(search_param),
    "ros::topic::waitForMessage": _wait_for_message,
    "ros::init": _init,
    "ros::service::call": _call_service,
    "ros::this_node::getName": _node_name,
    "ros::this_node::getNamespace": _node_namespace,
    "ros::names::resolve": _resolve,
    "ros::names::remap": _resolve,
    "ros::names::append": _append,
    "ros::names::clean": lambda machine, owner, arguments: arguments.get(0) or _UNKNOWN,
    "ros::AdvertiseServiceOptions::create": options_of,
    "ros::AdvertiseOptions::create": options_of,
    "ros::SubscribeOptions::create": options_of,
    "ros::ok": lambda machine, owner, arguments: Hole("ok"),
}
