"""What the client libraries of ROS 2 declare: the same calls in both languages end here."""

import re
from collections.abc import Callable, Iterator, Mapping

from rtron.sources.code.interpreter.abstract_values.value_types import (
    Hole,
    Known,
    Text,
    Value,
    join,
    options,
    spelled,
    truth,
)
from rtron.sources.code.interpreter.execution.abstract_machine import Machine
from rtron.sources.code.interpreter.execution.arguments import Arguments
from rtron.sources.code.library_models.ros2_common.nodes import NodeWords, name_of, record, resolved
from rtron.sources.code.library_models.ros2_common.parameters import declared, tell_overrides
from rtron.sources.code.library_models.ros2_common.qos import DEFAULT, PROFILES
from rtron.sources.declaration import DeclarationKind
from rtron.vocabulary import Evidence, QoS

MAX_CALLERS = 8
_NAME = re.compile(r"(/[A-Za-z_][A-Za-z0-9_]*)+")

_PUBLISH, _SUBSCRIBE = DeclarationKind.PUBLISH, DeclarationKind.SUBSCRIBE
_SERVICE = DeclarationKind.SERVICE
_FOLDERS = {
    _PUBLISH: "msg",
    _SUBSCRIBE: "msg",
    _SERVICE: "srv",
    DeclarationKind.SERVICE_CLIENT: "srv",
    DeclarationKind.ACTION_CLIENT: "action",
    DeclarationKind.ACTION_SERVER: "action",
}
PARAMETER_SERVICES: Mapping[str, str] = {
    "describe_parameters": "rcl_interfaces/srv/DescribeParameters",
    "get_parameter_types": "rcl_interfaces/srv/GetParameterTypes",
    "get_parameters": "rcl_interfaces/srv/GetParameters",
    "list_parameters": "rcl_interfaces/srv/ListParameters",
    "set_parameters": "rcl_interfaces/srv/SetParameters",
    "set_parameters_atomically": "rcl_interfaces/srv/SetParametersAtomically",
}
LIFECYCLE_SERVICES: Mapping[str, str] = {
    "change_state": "lifecycle_msgs/srv/ChangeState",
    "get_available_states": "lifecycle_msgs/srv/GetAvailableStates",
    "get_available_transitions": "lifecycle_msgs/srv/GetAvailableTransitions",
    "get_state": "lifecycle_msgs/srv/GetState",
    "get_transition_graph": "lifecycle_msgs/srv/GetAvailableTransitions",
}
LOGGER_SERVICES: Mapping[str, str] = {
    "get_logger_levels": "rcl_interfaces/srv/GetLoggerLevels",
    "set_logger_levels": "rcl_interfaces/srv/SetLoggerLevels",
}
_STATIC_TF = QoS(depth=1, durability=PROFILES["rosout"].durability)
_TF = QoS(depth=100)


def declare(  # noqa: PLR0913 - what the graph has of an endpoint
    machine: Machine,
    kind: DeclarationKind,
    node: Value,
    name: Value | None,
    type: str,
    at: Arguments,
    *,
    qos: QoS | None = None,
    implicit: bool = False,
) -> Value:
    """Record a name of a node, and return it as it resolves there."""
    full = resolved(node, _named(name))
    machine.doubts += not (type and _is_name(full))
    places = tuple(chain(at, name)) if name is not None else (at.evidence,)
    for owner in options(name_of(node)):
        machine.recorder.declare(
            kind,
            full,
            typed(kind, type),
            *places,
            implicit=implicit,
            latched=kind is _PUBLISH
            and qos is not None
            and qos.durability is _STATIC_TF.durability,
            node=spelled(owner),
            qos=qos,
        )
    return full


def _is_name(full: Value) -> bool:
    """Tell whether a name is certainly one that rcl takes (design.ros2.org: topic names)."""
    return isinstance(full, Known) and bool(_NAME.fullmatch(str(full.value)))


def _named(name: Value | None) -> Value | None:
    """Return a name without the options that cannot be one: rcl refuses an empty name."""
    found = [option for option in options(name) if getattr(option, "value", None) != ""]
    return join(found) if found else name


def typed(kind: DeclarationKind, type: str) -> str:
    """Return a type with the folder of its kind: `std_msgs/String` is std_msgs/msg/String."""
    package, slash, name = type.partition("/")
    return f"{package}/{_FOLDERS[kind]}/{name}" if slash and "/" not in name else type


def chain(at: Arguments, name: Value) -> Iterator[Evidence]:
    """Yield the calls that hand a name on, from the one where it is given to the one at hand."""
    places, current = [at.evidence], at.frame.caller
    while isinstance(current, Arguments) and len(places) < MAX_CALLERS:
        if not any(_is_same(value, name) for value in current.values):
            break
        places.append(current.evidence)
        current = current.frame.caller
    return reversed(places)


def _is_same(value: Value, name: Value) -> bool:
    if value is name:
        return True
    if isinstance(value, (Hole, Text)):
        return value == name
    is_text = isinstance(value, Known) and isinstance(value.value, str)
    return is_text and isinstance(name, Known) and value.value == name.value  # type: ignore[union-attr]


def join_app(
    machine: Machine, node: Value, words: NodeWords, at: Arguments, ask: Callable[[str], bool]
) -> None:
    """Record a node and what every node declares; `ask` tells whether an option is on.

    `parameter_event_listener` is rclcpp's alone.
    """
    record(machine, name_of(node), words, at)
    if ask("rosout"):
        _implied(machine, _PUBLISH, node, "/rosout", "rcl_interfaces/msg/Log", at, "rosout")
    event, events = "rcl_interfaces/msg/ParameterEvent", "/parameter_events"
    if ask("parameter_events"):
        _implied(machine, _PUBLISH, node, events, event, at, "parameter_events")
    if ask("parameter_event_listener"):
        _implied(machine, _SUBSCRIBE, node, events, event, at, "parameter_events")
    if ask("parameter_services"):
        services(machine, node, PARAMETER_SERVICES, at)
    if ask("logger_service"):
        services(machine, node, LOGGER_SERVICES, at)
    description = "type_description_interfaces/srv/GetTypeDescription"
    services(machine, node, {"get_type_description": description}, at)
    tell_overrides(machine, node)
    simulated = declared(machine, node, Known("use_sim_time"), Known(value=False))
    if truth(simulated):
        _implied(machine, _SUBSCRIBE, node, "/clock", "rosgraph_msgs/msg/Clock", at, "clock")


def lifecycle(machine: Machine, node: Value, at: Arguments) -> None:
    """Record what a lifecycle node declares (design.ros2.org: Managed nodes)."""
    name, type = Known("~/transition_event"), "lifecycle_msgs/msg/TransitionEvent"
    declare(machine, _PUBLISH, node, name, type, at, qos=DEFAULT, implicit=True)
    services(machine, node, LIFECYCLE_SERVICES, at)


def services(machine: Machine, node: Value, names: Mapping[str, str], at: Arguments) -> None:
    """Record services below a node that a library offers."""
    for name, type in names.items():
        declare(machine, _SERVICE, node, Known(f"~/{name}"), type, at, implicit=True)


def transforms(
    machine: Machine, kind: DeclarationKind, node: Value, at: Arguments, *, static: bool = False
) -> None:
    """Record that a node sends or hears transforms (docs.ros.org: tf2)."""
    both = {"/tf": _TF, "/tf_static": _STATIC_TF}
    sent = "/tf_static" if static else "/tf"
    for name, qos in both.items() if kind is _SUBSCRIBE else [(sent, both[sent])]:
        type = "tf2_msgs/msg/TFMessage"
        declare(machine, kind, node, Known(name), type, at, qos=qos, implicit=True)


def diagnostics(machine: Machine, node: Value, at: Arguments) -> None:
    """Record a diagnostic_updater."""
    type = "diagnostic_msgs/msg/DiagnosticArray"
    name = Known("/diagnostics")
    declare(machine, _PUBLISH, node, name, type, at, qos=QoS(depth=1), implicit=True)


def unknown_owner(machine: Machine, what: str, name: Value | None, at: Arguments) -> None:
    """Note a call that joins nodes on what is not known to be a node."""
    shown = f"{what}({spelled(name or Hole('?'))})"
    machine.recorder.unresolved(shown, "which node it is called on is not known", at.evidence)


def _implied(
    machine: Machine,
    kind: DeclarationKind,
    node: Value,
    name: str,
    type: str,
    at: Arguments,
    profile: str,
) -> None:
    qos = PROFILES[profile]
    declare(machine, kind, node, Known(name), type, at, qos=qos, implicit=True)
