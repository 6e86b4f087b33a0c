"""ros::NodeHandle and what is made through it (ROS wiki: roscpp/Overview)."""

from collections.abc import Callable, Mapping
from functools import partial

from rtron.sources.code.interpreter.abstract_values.value_types import (
    NONE,
    TRUE,
    Hole,
    Instance,
    Known,
    MapValue,
    NativeClass,
    Value,
    options,
    truth,
)
from rtron.sources.code.interpreter.execution.abstract_machine import Machine
from rtron.sources.code.interpreter.execution.arguments import Arguments
from rtron.sources.code.library_models.common.cpp_arguments import (
    callback_message,
    escape_all,
    in_handle,
    typed,
)
from rtron.sources.code.library_models.ros1_common import endpoints
from rtron.sources.code.library_models.ros1_common.names import node_namespace, remapped, resolve
from rtron.sources.code.library_models.roscpp.parameters import (
    get_param,
    has_param,
    param,
    search_param,
    set_param,
)
from rtron.sources.declaration import DeclarationKind

_UNKNOWN = Hole("?")


def make_handle(machine: Machine, arguments: Arguments) -> Value:
    """`NodeHandle()`, `NodeHandle("ns")`, `NodeHandle(parent, "ns")`."""
    first, second = arguments.get(0), arguments.get(1)
    if isinstance(arguments.values[-1] if arguments.values else None, MapValue):
        note_remaps(machine, arguments)
    if isinstance(first, Instance) and "namespace" in first.fields:
        parent = first.fields["namespace"]
        if second is None or second == Known(""):
            return handle(parent)
        return handle(remapped(machine, resolve(machine, second, parent)))
    if first is None or first == Known(""):
        return handle(Known(node_namespace(machine)))
    return handle(remapped(machine, resolve(machine, first)))


def note_remaps(machine: Machine, arguments: Arguments) -> None:
    """Note remaps that the program gives itself, beside the launch's."""
    why = "the program remaps names itself; they are shown as declared"
    machine.recorder.unresolved("remaps in the program", why, arguments.evidence)


def handle(namespace: Value) -> Instance:
    """Return a node handle of an absolute namespace."""
    return Instance(NODE_HANDLE, {"namespace": namespace})


def private_handle(machine: Machine) -> Instance:
    """Return the handle of the node's private names."""
    return handle(endpoints.own_namespace(machine))


def given_handle(arguments: Arguments) -> Instance | None:
    """Return the first argument that is certainly a node handle."""
    given = (v for v in arguments.values if isinstance(v, Instance) and "namespace" in v.fields)
    return next(given, None)


def handle_among(machine: Machine, arguments: Arguments) -> Instance:
    """Return the node handle among the arguments, or the node's own."""
    for value in arguments.values:
        for option in options(value):
            if isinstance(option, Instance) and "namespace" in option.fields:
                return option
    return handle(Known(node_namespace(machine)))


def advertise(machine: Machine, owner: Value, arguments: Arguments) -> Value:
    """`advertise<T>(topic, queue_size, …, latch)`, `advertise(AdvertiseOptions)`."""
    first = arguments.get(0)
    if isinstance(first, Instance) and "options" in first.fields:
        name, type = first.fields["options"], str(getattr(first.fields["type"], "value", ""))
    else:
        name, type = first or _UNKNOWN, typed(machine, arguments)
    topic = in_handle(machine, owner, name)
    latched = any(value == TRUE for value in arguments.values[2:]) or _says_latch(first)
    escape_all(machine, arguments)
    kind = DeclarationKind.PUBLISH
    endpoints.declare(machine, kind, topic, type, arguments, latched=latched)
    return Instance(ENDPOINT, {"name": remapped(machine, topic)})


def _says_latch(options: Value | None) -> bool:
    return isinstance(options, Instance) and options.fields.get("latch") == TRUE


def subscribe(machine: Machine, owner: Value, arguments: Arguments) -> Value:
    """`subscribe<T>(topic, queue_size, callback, …)`, `subscribe(SubscribeOptions)`."""
    first = arguments.get(0)
    if isinstance(first, Instance) and "options" in first.fields:
        name, type = first.fields["options"], str(getattr(first.fields["type"], "value", ""))
    else:
        name = first or _UNKNOWN
        type = typed(machine, arguments) or callback_message(machine, arguments, 1)
    topic = in_handle(machine, owner, name)
    escape_all(machine, arguments)
    endpoints.declare(machine, DeclarationKind.SUBSCRIBE, topic, type, arguments)
    return Instance(ENDPOINT, {"name": remapped(machine, topic)})


def _service(kind: DeclarationKind, machine: Machine, owner: Value, arguments: Arguments) -> Value:
    first = arguments.get(0)
    given = (
        first.fields["options"]
        if isinstance(first, Instance) and "options" in first.fields
        else first
    )
    name = in_handle(machine, owner, given)
    type = typed(machine, arguments) or _service_type(callback_message(machine, arguments, 1))
    if not type and arguments.types:
        type = _service_type(typed(machine, arguments))
    escape_all(machine, arguments)
    endpoints.declare(machine, kind, name, _service_type(type), arguments)
    return Instance(ENDPOINT, {"name": remapped(machine, name)})


def _service_type(request: str) -> str:
    """`std_srvs/EmptyRequest` is std_srvs/Empty."""
    return request.removesuffix("::Request").removesuffix("Request")


def _resolve_name(machine: Machine, owner: Value, arguments: Arguments) -> Value:
    name = in_handle(machine, owner, arguments.get(0))
    plain = truth(arguments.get(1) or TRUE) is False
    return name if plain else remapped(machine, name)


def _get_namespace(machine: Machine, owner: Value, _: Arguments) -> Value:
    return in_handle(machine, owner, Known(""))


def _callback(machine: Machine, _: Value, arguments: Arguments) -> Value:
    escape_all(machine, arguments)
    return Instance(ENDPOINT)


def _topic(_: Machine, owner: Instance, __: Arguments) -> Value:
    return owner.fields.get("name", Hole("topic"))


def _is_set(_: Machine, __: Instance, ___: Arguments) -> Value:
    return Hole("set")


_HANDLE_METHODS: Mapping[str, Callable[..., Value]] = {
    "advertise": advertise,
    "subscribe": subscribe,
    "advertiseService": partial(_service, DeclarationKind.SERVICE),
    "serviceClient": partial(_service, DeclarationKind.SERVICE_CLIENT),
    "param": param,
    "getParam": get_param,
    "getParamCached": get_param,
    "hasParam": has_param,
    "setParam": set_param,
    "searchParam": search_param,
    "resolveName": _resolve_name,
    "getNamespace": _get_namespace,
    "getUnresolvedNamespace": _get_namespace,
    **dict.fromkeys(("createTimer", "createWallTimer", "createSteadyTimer"), _callback),
}
NODE_HANDLE = NativeClass("ros::NodeHandle", make_handle, dict(_HANDLE_METHODS))
ENDPOINT = NativeClass(
    "ros::Publisher",
    methods={
        **dict.fromkeys(("getTopic", "getService"), _topic),
        **dict.fromkeys(("getNumSubscribers", "getNumPublishers", "isValid"), _is_set),
        **dict.fromkeys(("registerCallback", "setCallback", "call"), _callback),
    },
)
_POINTER = NativeClass("pointer", lambda machine, arguments: arguments.get(0) or NONE)

HANDLE_CLASSES = {
    "ros::NodeHandle": NODE_HANDLE,
    **dict.fromkeys(("ros::NodeHandlePtr", "ros::NodeHandleConstPtr"), _POINTER),
    **dict.fromkeys(("ros::Publisher", "ros::Subscriber", "ros::ServiceServer"), ENDPOINT),
    **dict.fromkeys(("ros::ServiceClient", "ros::Timer", "ros::WallTimer"), ENDPOINT),
}
