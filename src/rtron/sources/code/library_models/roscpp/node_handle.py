"""ros::NodeHandle and what is made through it (ROS wiki: roscpp/Overview)."""

from collections.abc import Callable, Mapping
from functools import partial

from rtron.sources.code.interpreter import abstract_values as av
from rtron.sources.code.interpreter.execution.abstract_machine import AbstractMachine
from rtron.sources.code.interpreter.execution.arguments import Arguments
from rtron.sources.code.library_models.common import cpp_arguments
from rtron.sources.code.library_models.common.cpp_arguments import resolve_in_handle
from rtron.sources.code.library_models.common.trivial_functions import (
    returning_field,
    returning_unknown,
)
from rtron.sources.code.library_models.ros1_common import endpoints
from rtron.sources.code.library_models.ros1_common.names import (
    is_set,
    node_namespace,
    parameter_value,
    remap_name,
    resolve_name,
    search_parameter,
    tainted_default,
)
from rtron.sources.declaration import DeclarationKind

_NAME_AND_DEFAULT = 2


def param(machine: AbstractMachine, owner: av.Value, arguments: Arguments) -> av.Value:
    """`param("name", variable, default)`, `param<T>("name", default)`."""
    written = len(arguments.values) > _NAME_AND_DEFAULT
    default = arguments.get(2 if written else 1) or av.UNKNOWN
    name = resolve_in_handle(machine, owner, arguments.get(0))
    found = _cpp_value(parameter_value(machine, name))
    value = value_or_default(found, default)
    slot = arguments.slot(1)
    if not written:
        return value
    if slot is not None:
        machine.undo_log.set(*slot, value)
    return av.FALSE if found is None else av.TRUE


def _cpp_value(value: av.Value | None) -> av.Value | None:
    """Return a parameter as C++ holds it: a struct is a map, whose items are pairs."""
    if isinstance(value, av.MapValue):
        inner = {key: _cpp_value(entry) or av.NONE for key, entry in value.fields.items()}
        return av.MapValue(inner, iterates_pairs=True)
    if isinstance(value, av.ListValue):
        return av.list_of([_cpp_value(item) or av.NONE for item in value.items])
    return value


def value_or_default(found: av.Value | None, default: av.Value) -> av.Value:
    """Return a parameter's value, the default where it is not set, both where that is unknown."""
    if found is None:
        return tainted_default(default)
    return av.join((tainted_default(default), found)) if isinstance(found, av.Unknown) else found


def get_param(machine: AbstractMachine, owner: av.Value, arguments: Arguments) -> av.Value:
    """`getParam("name", variable)`: whether it is set; the variable stays where it is not."""
    name = resolve_in_handle(machine, owner, arguments.get(0))
    found = _cpp_value(parameter_value(machine, name))
    slot = arguments.slot(1)
    if found is None:
        return av.FALSE
    if slot is not None:
        before = slot.holder.get(slot.key)
        default = before if isinstance(before, av.Scalar) and before.value else found
        value = tainted_default(default) if isinstance(found, av.Unknown) else found
        machine.undo_log.set(*slot, value)
    return is_set(found)


def has_param(machine: AbstractMachine, owner: av.Value, arguments: Arguments) -> av.Value:
    """`hasParam("name")`."""
    found = parameter_value(machine, resolve_in_handle(machine, owner, arguments.get(0)))
    return is_set(found)


def set_param(machine: AbstractMachine, owner: av.Value, arguments: Arguments) -> av.Value:
    """`setParam("name", value)`."""
    name = resolve_in_handle(machine, owner, arguments.get(0))
    if isinstance(name, av.Scalar):
        machine.undo_log.set(machine.parameters, str(name.value), arguments.value(1))
    return av.Unknown("setParam")


def search_param(machine: AbstractMachine, owner: av.Value, arguments: Arguments) -> av.Value:
    """`searchParam("name", found)` (ROS wiki: Parameter Server)."""
    namespace = resolve_in_handle(machine, owner, av.Scalar(""))
    found = search_parameter(machine, arguments.value(0), namespace)
    slot = arguments.slot(1)
    if found is None:
        return av.FALSE
    if slot is not None:
        machine.undo_log.set(*slot, found)
    return is_set(found)


FUNCTIONS: Mapping[str, Callable[..., av.Value]] = {
    "param": param,
    "get": get_param,
    "has": has_param,
    "set": set_param,
    "search": search_param,
}
"""The functions of `ros::param`; the methods of a handle are called like them."""


def make_handle(machine: AbstractMachine, arguments: Arguments) -> av.Value:
    """`NodeHandle()`, `NodeHandle("ns")`, `NodeHandle(parent, "ns")`."""
    first, second = arguments.get(0), arguments.get(1)
    if isinstance(arguments.values[-1] if arguments.values else None, av.MapValue):
        note_program_remaps(machine, arguments)
    if isinstance(first, av.Instance) and "namespace" in first.fields:
        parent = first.fields["namespace"]
        if second is None or second == av.Scalar(""):
            return handle(parent)
        return handle(remap_name(machine, resolve_name(machine, second, parent)))
    if first is None or first == av.Scalar(""):
        return handle(av.Scalar(node_namespace(machine)))
    return handle(remap_name(machine, resolve_name(machine, first)))


def note_program_remaps(machine: AbstractMachine, arguments: Arguments) -> None:
    """Note remaps that the program gives itself, beside the launch's."""
    why = "the program remaps names itself; they are shown as declared"
    machine.recorder.add_unresolved("remaps in the program", why, arguments.evidence)


def handle(namespace: av.Value) -> av.Instance:
    """Return a node handle of an absolute namespace."""
    return av.Instance(NODE_HANDLE, {"namespace": namespace})


def private_handle(machine: AbstractMachine) -> av.Instance:
    """Return the handle of the node's private names."""
    return handle(endpoints.resolve_private(machine))


def handle_argument(arguments: Arguments) -> av.Instance | None:
    """Return the first argument that is certainly a node handle."""
    given = (v for v in arguments.values if isinstance(v, av.Instance) and "namespace" in v.fields)
    return next(given, None)


def handle_argument_or_default(machine: AbstractMachine, arguments: Arguments) -> av.Instance:
    """Return the node handle among the arguments, or the node's own."""
    for value in arguments.values:
        for option in av.options(value):
            if isinstance(option, av.Instance) and "namespace" in option.fields:
                return option
    return handle(av.Scalar(node_namespace(machine)))


def _declare_endpoint(
    kind: DeclarationKind,
    machine: AbstractMachine,
    owner: av.Value,
    arguments: Arguments,
    type: str,
    *,
    latched: bool = False,
) -> av.Value:
    """Record what an endpoint's name, or its options in the place of the name, say."""
    name = arguments.value(0)
    if isinstance(name, av.Instance) and name.type is ENDPOINT:
        return name  # rosserial's handle gets what is declared already
    if isinstance(name, av.Instance) and "options" in name.fields:
        type = type or av.text_with_holes(name.fields.get("type", av.Scalar("")))
        name = name.fields["options"]
    full = cpp_arguments.resolve_in_handle(machine, owner, name)
    cpp_arguments.escape_functions(machine, arguments)
    endpoints.declare_endpoint(machine, kind, full, type, arguments, latched=latched)
    return av.Instance(ENDPOINT, {"name": remap_name(machine, full)})


def _make_firmware_endpoint(
    kind: DeclarationKind, machine: AbstractMachine, arguments: Arguments
) -> av.Value:
    """`ros::Subscriber<T> x("topic", callback)` of rosserial; those of roscpp get no name.

    `ros::Publisher x("topic", &message)`, `ros::ServiceServer<Request, Response> x(…)`.
    """
    message = arguments.get(1)
    if not (arguments.values and av.is_text(arguments.values[0])):
        cpp_arguments.escape_functions(machine, arguments)
        return av.Instance(ENDPOINT)
    given = message.type if isinstance(message, av.Unknown) else None
    type = _message_type(machine, arguments)
    type = _service_type(type or cpp_arguments.message_type_of(machine, given, arguments))
    owner = handle(av.Scalar(node_namespace(machine)))
    return _declare_endpoint(kind, machine, owner, arguments, type)


def advertise(machine: AbstractMachine, owner: av.Value, arguments: Arguments) -> av.Value:
    """`advertise<T>(topic, queue_size, …, latch)`, `advertise(AdvertiseOptions)`."""
    options = getattr(arguments.get(0), "fields", {})
    latched = av.TRUE in (*arguments.values[2:], options.get("latch"))
    type = cpp_arguments.template_message_type(machine, arguments)
    kind = DeclarationKind.PUBLISH
    return _declare_endpoint(kind, machine, owner, arguments, type, latched=latched)


def subscribe(machine: AbstractMachine, owner: av.Value, arguments: Arguments) -> av.Value:
    """`subscribe<T>(topic, queue_size, callback, …)`, `subscribe(SubscribeOptions)`."""
    type = _message_type(machine, arguments)
    return _declare_endpoint(DeclarationKind.SUBSCRIBE, machine, owner, arguments, type)


def _declare_service(
    kind: DeclarationKind, machine: AbstractMachine, owner: av.Value, arguments: Arguments
) -> av.Value:
    type = _service_type(_message_type(machine, arguments))
    return _declare_endpoint(kind, machine, owner, arguments, type)


def _message_type(machine: AbstractMachine, arguments: Arguments) -> str:
    """Return the message that is written out, or that the callback takes."""
    written = cpp_arguments.template_message_type(machine, arguments)
    return written or cpp_arguments.callback_message_type(machine, arguments, 1)


def _service_type(request: str) -> str:
    """`std_srvs/EmptyRequest` is std_srvs/Empty."""
    return request.removesuffix("::Request").removesuffix("Request")


def _resolve_name(machine: AbstractMachine, owner: av.Value, arguments: Arguments) -> av.Value:
    name = cpp_arguments.resolve_in_handle(machine, owner, arguments.get(0))
    plain = av.truth(arguments.get(1) or av.TRUE) is False
    return name if plain else remap_name(machine, name)


def _get_namespace(machine: AbstractMachine, owner: av.Value, _: Arguments) -> av.Value:
    return cpp_arguments.resolve_in_handle(machine, owner, av.Scalar(""))


def _register_callback(machine: AbstractMachine, _: av.Value, arguments: Arguments) -> av.Value:
    cpp_arguments.escape_functions(machine, arguments)
    return av.Instance(ENDPOINT)


_HANDLE_METHODS: Mapping[str, Callable[..., av.Value]] = {
    "advertise": advertise,
    "subscribe": subscribe,
    "advertiseService": partial(_declare_service, DeclarationKind.SERVICE),
    "serviceClient": partial(_declare_service, DeclarationKind.SERVICE_CLIENT),
    **{name if name == "param" else name + "Param": f for name, f in FUNCTIONS.items()},
    "getParamCached": FUNCTIONS["get"],
    "resolveName": _resolve_name,
    **dict.fromkeys(("getNamespace", "getUnresolvedNamespace"), _get_namespace),
    **dict.fromkeys(("createTimer", "createWallTimer", "createSteadyTimer"), _register_callback),
}
NODE_HANDLE = av.LibraryClass("ros::NodeHandle", make_handle, dict(_HANDLE_METHODS))
ENDPOINT = av.LibraryClass(
    "ros::Publisher",
    methods={
        **dict.fromkeys(("getTopic", "getService"), returning_field("name", av.Unknown("topic"))),
        **dict.fromkeys(
            ("getNumSubscribers", "getNumPublishers", "isValid"), returning_unknown("set")
        ),
        **dict.fromkeys(("registerCallback", "setCallback", "call"), _register_callback),
    },
)
_HANDLE_POINTER = av.LibraryClass("pointer", lambda machine, arguments: arguments.get(0) or av.NONE)

HANDLE_CLASSES = {
    "ros::NodeHandle": NODE_HANDLE,
    **dict.fromkeys(("ros::NodeHandlePtr", "ros::NodeHandleConstPtr"), _HANDLE_POINTER),
    **{
        name: av.LibraryClass(name, partial(_make_firmware_endpoint, kind), ENDPOINT.methods)
        for name, kind in (
            ("ros::Publisher", DeclarationKind.PUBLISH),
            ("ros::Subscriber", DeclarationKind.SUBSCRIBE),
            ("ros::ServiceServer", DeclarationKind.SERVICE),
            ("ros::ServiceClient", DeclarationKind.SERVICE_CLIENT),
        )
    },
    **dict.fromkeys(("ros::Timer", "ros::WallTimer"), ENDPOINT),
}


def create_options(machine: AbstractMachine, _: object, arguments: Arguments) -> av.Value:
    """`AdvertiseOptions::create<T>(topic, …)`, `SubscribeOptions::create<T>(topic, …)`."""
    cpp_arguments.escape_functions(machine, arguments)
    type = av.Scalar(cpp_arguments.template_message_type(machine, arguments))
    return av.Instance(ADVERTISE_OPTIONS, {"options": arguments.value(0), "type": type})


ADVERTISE_OPTIONS = av.LibraryClass("ros::AdvertiseOptions")
