"""ros::NodeHandle and what is made through it (ROS wiki: roscpp/Overview)."""

from collections.abc import Callable, Mapping
from functools import partial

from rtron.sources.code.interpreter.arguments import Arguments
from rtron.sources.code.interpreter.items import listed
from rtron.sources.code.interpreter.machine import Machine
from rtron.sources.code.interpreter.values import (
    FALSE,
    NONE,
    TRUE,
    FunctionValue,
    Hole,
    Instance,
    Known,
    ListValue,
    MapValue,
    NativeClass,
    Placeholder,
    Value,
    concat,
    join,
    options,
    truth,
)
from rtron.sources.code.ir import TypeRef
from rtron.sources.code.natives import endpoints
from rtron.sources.code.natives.cpp import cpp
from rtron.sources.code.natives.names import (
    node_namespace,
    parameter,
    remapped,
    resolve,
    search,
)
from rtron.sources.declaration import DeclarationKind

_UNKNOWN = Hole("?")
_NAME_AND_DEFAULT = 2


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


def in_handle(machine: Machine, owner: Value, name: Value | None) -> Value:
    """Return a name resolved in a handle, before remapping."""
    namespace = owner.fields.get("namespace") if isinstance(owner, Instance) else None
    return resolve(machine, name if name is not None else _UNKNOWN, namespace)


def typed(machine: Machine, arguments: Arguments, at: int = 0) -> str:
    """Return the message of a template argument; empty where there is none."""
    if len(arguments.types) <= at:
        return ""
    return message_of(machine, arguments.types[at], arguments)


def message_of(machine: Machine, type: TypeRef | None, arguments: Arguments) -> str:
    """Return a C++ type as a message type, typedefs and template parameters followed."""
    if type is None:
        return ""
    return cpp(machine).message_in(type, arguments.frame.scope, arguments.frame.types)


def callback_message(machine: Machine, arguments: Arguments, first: int) -> str:
    """Return the message that the first callback among the arguments takes."""
    for value in arguments.values[first:]:
        for option in options(value):
            if isinstance(option, FunctionValue):
                return _message_taken(machine, option, arguments)
    return ""


def _message_taken(machine: Machine, callback: FunctionValue, arguments: Arguments) -> str:
    given = callback.given
    places = [at for at, value in enumerate(given) if isinstance(value, Placeholder)]
    at = places[0] if places else len(given)
    for function in callback.overloads or (callback.function,):
        if at < len(function.params):
            scope = function.name.rpartition("::")[0]
            types = {**dict(arguments.frame.types), **cpp(machine).types_of(callback)}
            return cpp(machine).message_in(function.params[at].type, scope, types)
    return ""


def escape_all(machine: Machine, arguments: Arguments) -> None:
    """Remember every function among the arguments; a method with its object."""
    owners = [value for value in arguments.values if isinstance(value, Instance)]
    for value in arguments.values:
        for option in options(value):
            machine.escape(_with_object(machine, option, owners))


def _with_object(machine: Machine, value: Value, owners: list[Instance]) -> Value:
    if isinstance(value, FunctionValue) and value.owner is None and owners:
        return cpp(machine).owned(value, owners[0])
    return value


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


def options_of(machine: Machine, _: object, arguments: Arguments) -> Value:
    """`AdvertiseOptions::create<T>(topic, …)`, `SubscribeOptions::create<T>(topic, …)`."""
    escape_all(machine, arguments)
    type = Known(typed(machine, arguments))
    return Instance(OPTIONS, {"options": arguments.get(0) or _UNKNOWN, "type": type})


def param(machine: Machine, owner: Value, arguments: Arguments) -> Value:
    """`param("name", variable, default)`, `param<T>("name", default)`."""
    written = len(arguments.values) > _NAME_AND_DEFAULT
    default = arguments.get(2 if written else 1) or _UNKNOWN
    found = _of_cpp(parameter(machine, in_handle(machine, owner, arguments.get(0))))
    value = or_default(found, default)
    place = arguments.place(1)
    if not written:
        return value
    if place is not None:
        machine.trail.set(*place, value)
    return FALSE if found is None else TRUE


def _of_cpp(value: Value | None) -> Value | None:
    """Return a parameter as C++ holds it: a struct is a map, whose items are pairs."""
    if isinstance(value, MapValue):
        inner = {key: _of_cpp(entry) or NONE for key, entry in value.fields.items()}
        return MapValue(inner, pairs=True)
    if isinstance(value, ListValue):
        return listed([_of_cpp(item) or NONE for item in value.items])
    return value


def or_default(found: Value | None, default: Value) -> Value:
    """Return a parameter's value, the default where it is not set, both where nobody knows."""
    if found is None:
        return _as_parameter(default)
    return join((_as_parameter(default), found)) if isinstance(found, Hole) else found


def _as_parameter(value: Value) -> Value:
    return Known(value.value, tainted=True) if isinstance(value, Known) else value


def get_param(machine: Machine, owner: Value, arguments: Arguments) -> Value:
    """`getParam("name", variable)`: whether it is set; the variable stays where it is not."""
    found = _of_cpp(parameter(machine, in_handle(machine, owner, arguments.get(0))))
    place = arguments.place(1)
    if found is None:
        return FALSE
    if place is not None:
        before = place.holder.get(place.key)
        kept = isinstance(found, Hole) and isinstance(before, Known) and bool(before.value)
        machine.trail.set(*place, _as_parameter(before) if kept and before is not None else found)
    return Hole("getParam") if isinstance(found, Hole) else TRUE


def has_param(machine: Machine, owner: Value, arguments: Arguments) -> Value:
    """`hasParam("name")`."""
    found = parameter(machine, in_handle(machine, owner, arguments.get(0)))
    return FALSE if found is None else Hole("hasParam") if isinstance(found, Hole) else TRUE


def set_param(machine: Machine, owner: Value, arguments: Arguments) -> Value:
    """`setParam("name", value)`."""
    name = in_handle(machine, owner, arguments.get(0))
    if isinstance(name, Known):
        machine.trail.set(machine.parameters, str(name.value), arguments.get(1) or _UNKNOWN)
    return Hole("setParam")


def search_param(machine: Machine, owner: Value, arguments: Arguments) -> Value:
    """`searchParam("name", found)` (ROS wiki: Parameter Server)."""
    namespace = in_handle(machine, owner, Known(""))
    found = search(machine, arguments.get(0) or _UNKNOWN, namespace)
    place = arguments.place(1)
    if found is None:
        return FALSE
    if place is not None:
        machine.trail.set(*place, found)
    return Hole("searchParam") if isinstance(found, Hole) else TRUE


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


Methods = Mapping[str, Callable[..., Value]]

_HANDLE_METHODS: Methods = {
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
OPTIONS = NativeClass("ros::AdvertiseOptions")


def _without_handle(method: Callable[..., Value]) -> Callable[..., Value]:
    """`ros::param::get` and its kin resolve in the node's own namespace."""

    def called(machine: Machine, _: object, arguments: Arguments) -> Value:
        return method(machine, handle(Known(node_namespace(machine))), arguments)

    return called


def _wait_for_message(machine: Machine, _: object, arguments: Arguments) -> Value:
    """`ros::topic::waitForMessage<T>(topic, handle)`."""
    owner = next(
        (v for v in arguments.values if isinstance(v, Instance) and "namespace" in v.fields),
        handle(Known(node_namespace(machine))),
    )
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
