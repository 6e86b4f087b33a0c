"""What the client libraries of ROS 2 declare: the same calls in both languages end here."""

import re
from collections.abc import Callable, Iterator, Mapping

from rtron.sources.code.interpreter import abstract_values as av
from rtron.sources.code.interpreter.execution.abstract_machine import AbstractMachine
from rtron.sources.code.interpreter.execution.arguments import Arguments
from rtron.sources.code.library_models.ros2_common import nodes
from rtron.sources.code.library_models.ros2_common.parameters import (
    declare_node_parameter,
    record_overrides,
)
from rtron.sources.code.library_models.ros2_common.qos import DEFAULT_QOS, QOS_PROFILES
from rtron.sources.declaration import DeclarationKind
from rtron.vocabulary import Durability, Evidence, QoS
from rtron.vocabulary.enums import HiddenPart

MAX_CALLERS = 8
_NAME = re.compile(r"(/[A-Za-z_][A-Za-z0-9_]*)+")

_PUBLISH, _SUBSCRIBE = DeclarationKind.PUBLISH, DeclarationKind.SUBSCRIBE
_SERVICE = DeclarationKind.SERVICE
_TYPE_FOLDERS = {
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


def declare_endpoint(  # noqa: PLR0913 - what the graph has of an endpoint
    machine: AbstractMachine,
    kind: DeclarationKind,
    node: av.Value,
    name: av.Value | None,
    type: str,
    at: Arguments,
    *,
    qos: QoS | None = None,
    implicit: bool = False,
) -> av.Value:
    """Record a name of a node, and return it as it resolves there; note one that is empty."""
    given = _without_empty_names(name)
    if given is None and name is not None:
        return _note_empty_name(machine, kind, type, at)
    full = nodes.resolve_at_node(node, given)
    machine.possible_throws += not (type and _is_valid_name(full))
    locations = tuple(caller_chain(at, name)) if name is not None else (at.evidence,)
    keeps_last = qos is not None and qos.durability is Durability.TRANSIENT_LOCAL
    for owner in av.options(nodes.node_name(node)):
        machine.recorder.declare(
            kind,
            full,
            full_type_name(kind, type),
            *locations,
            implicit=implicit,
            latched=kind is _PUBLISH and keeps_last,
            node=av.text_with_holes(owner),
            qos=qos,
        )
    return full


def _is_valid_name(full: av.Value) -> bool:
    """Tell whether a name is certainly one that rcl takes (design.ros2.org: topic names)."""
    return isinstance(full, av.Scalar) and bool(_NAME.fullmatch(str(full.value)))


def _without_empty_names(name: av.Value | None) -> av.Value | None:
    """Return a name without the options that cannot be one: rcl refuses an empty name."""
    found = [option for option in av.options(name) if not _is_empty_name(option)]
    return av.join(found) if found else None


def _is_empty_name(name: av.Value) -> bool:
    return isinstance(name, av.Scalar) and not str(name.value).strip("/")


def _note_empty_name(
    machine: AbstractMachine, kind: DeclarationKind, type: str, at: Arguments
) -> av.Value:
    machine.possible_throws += 1
    what = f"{kind.value} of type {full_type_name(kind, type) or '?'}"
    machine.recorder.add_unresolved(what, "its name is empty, which ROS refuses", at.evidence)
    return av.Unknown(kind.value)


def full_type_name(kind: DeclarationKind, type: str) -> str:
    """Return a type with the folder of its kind: `std_msgs/String` is std_msgs/msg/String."""
    package, slash, name = type.partition("/")
    return f"{package}/{_TYPE_FOLDERS[kind]}/{name}" if slash and "/" not in name else type


def caller_chain(at: Arguments, name: av.Value) -> Iterator[Evidence]:
    """Yield the calls that hand a name on, from the one where it is given to the one at hand."""
    locations, current = [at.evidence], at.frame.caller
    while isinstance(current, Arguments) and len(locations) < MAX_CALLERS:
        if not any(_is_same(value, name) for value in current.values):
            break
        locations.append(current.evidence)
        current = current.frame.caller
    return reversed(locations)


def _is_same(value: av.Value, name: av.Value) -> bool:
    if value is name:
        return True
    if isinstance(value, (av.Unknown, av.PartialText)):
        return value == name
    if not (isinstance(value, av.Scalar) and isinstance(name, av.Scalar)):
        return False
    return isinstance(value.value, str) and value.value == name.value


def declare_node(
    machine: AbstractMachine,
    node: av.Value,
    words: nodes.NodeArguments,
    at: Arguments,
    is_enabled: Callable[[str], bool],
) -> None:
    """Record a node and what every node declares; `is_enabled` tells whether an option is on.

    `parameter_event_listener` is rclcpp's alone.
    """
    nodes.record_node(machine, nodes.node_name(node), words, at)
    if is_enabled("enable_rosout"):
        _declare_implicit(
            machine, _PUBLISH, node, "/rosout", "rcl_interfaces/msg/Log", at, "rosout"
        )
    event, events = "rcl_interfaces/msg/ParameterEvent", "/parameter_events"
    if is_enabled("start_parameter_event_publisher"):
        _declare_implicit(machine, _PUBLISH, node, events, event, at, "parameter_events")
    if is_enabled("parameter_event_listener"):
        _declare_implicit(machine, _SUBSCRIBE, node, events, event, at, "parameter_events")
    if is_enabled("start_parameter_services"):
        declare_services(machine, node, PARAMETER_SERVICES, at)
    if is_enabled("enable_logger_service"):
        declare_services(machine, node, LOGGER_SERVICES, at)
    description = "type_description_interfaces/srv/GetTypeDescription"
    declare_services(machine, node, {"get_type_description": description}, at)
    record_overrides(machine, node)
    simulated = declare_node_parameter(
        machine, node, av.Scalar("use_sim_time"), av.Scalar(value=False)
    )
    if av.truth(simulated):
        _declare_implicit(
            machine, _SUBSCRIBE, node, "/clock", "rosgraph_msgs/msg/Clock", at, "clock"
        )


def change_own_state(machine: AbstractMachine, owner: av.Value, at: Arguments) -> av.Value:
    """`trigger_transition(…)` and the like: the node does what else its manager does."""
    name, type = av.Scalar("~/change_state"), LIFECYCLE_SERVICES["change_state"]
    kind = DeclarationKind.SERVICE_CLIENT
    declare_endpoint(machine, kind, owner, name, type, at, implicit=True)
    return av.Unknown("state")


def declare_lifecycle(machine: AbstractMachine, node: av.Value, at: Arguments) -> None:
    """Record what a lifecycle node declares (design.ros2.org: Managed nodes)."""
    name, type = av.Scalar("~/transition_event"), "lifecycle_msgs/msg/TransitionEvent"
    declare_endpoint(machine, _PUBLISH, node, name, type, at, qos=DEFAULT_QOS, implicit=True)
    declare_services(machine, node, LIFECYCLE_SERVICES, at)


def declare_services(
    machine: AbstractMachine, node: av.Value, names: Mapping[str, str], at: Arguments
) -> None:
    """Record services below a node that a library offers."""
    for name, type in names.items():
        declare_endpoint(machine, _SERVICE, node, av.Scalar(f"~/{name}"), type, at, implicit=True)


def note_unknown_node(
    machine: AbstractMachine, what: str, name: av.Value | None, at: Arguments
) -> None:
    """Note a call that joins nodes on what is not known to be a node."""
    shown = f"{what}({av.text_with_holes(name or av.Unknown('?'))})"
    machine.recorder.add_unresolved(
        shown, "which node it is called on is not known", at.evidence, hides=HiddenPart.ENDPOINTS
    )


def _declare_implicit(
    machine: AbstractMachine,
    kind: DeclarationKind,
    node: av.Value,
    name: str,
    type: str,
    at: Arguments,
    profile: str,
) -> None:
    qos = QOS_PROFILES[profile]
    declare_endpoint(machine, kind, node, av.Scalar(name), type, at, qos=qos, implicit=True)
