"""rclc, by which firmware joins ROS 2 through the agent of micro-ROS (github.com/ros2/rclc).

A function fills in what its first argument points to. Types of messages come from macros of
rosidl, which the preprocessor writes as texts; rclc's nodes have no parameters and no rosout.
"""

from collections.abc import Callable, Iterator, Mapping, Sequence
from functools import partial
from itertools import pairwise

from rtron.sources.code.interpreter import abstract_values as av
from rtron.sources.code.interpreter.execution.abstract_machine import AbstractMachine
from rtron.sources.code.interpreter.execution.arguments import Arguments
from rtron.sources.code.library_models.rclcpp.endpoints import ENDPOINT
from rtron.sources.code.library_models.rclcpp.node import NODE
from rtron.sources.code.library_models.ros2_common import endpoints, nodes
from rtron.sources.code.library_models.ros2_common.qos import QOS_PROFILES
from rtron.sources.declaration import DeclarationKind
from rtron.vocabulary import Evidence, QoS

_Function = Callable[..., av.Value]
_FILE, _LINE = "rclc.file", "rclc.line"
"""Where an entity was initialised: its callback is given elsewhere, to the executor."""


def _fill(machine: AbstractMachine, at: Arguments, made: av.Value) -> av.Value:
    slot = at.slot(0)
    if slot is not None:
        machine.undo_log.set(*slot, made)
    return av.Scalar(0)


def _init_node(machine: AbstractMachine, _: object, at: Arguments) -> av.Value:
    """`rclc_node_init_default(&node, name, namespace, &support)`."""
    namespace = at.get(2) or av.Scalar("")
    words = nodes.NodeArguments(name=at.value(1), namespace=namespace, uses_global_arguments=False)
    full = nodes.full_name(machine, words)
    nodes.record_node(machine, full, words, at)
    fields = {nodes.NAME_FIELD: full, nodes.GLOBAL_ARGUMENTS_FIELD: av.FALSE}
    return _fill(machine, at, av.Instance(NODE, fields))


def _init_endpoint(
    kind: DeclarationKind, qos: QoS | None, machine: AbstractMachine, _: object, at: Arguments
) -> av.Value:
    """`rclc_publisher_init_default(&publisher, &node, type_support, topic)` and the like."""
    texts = [value for value in at.values if not isinstance(value, av.Instance)]
    type, name = next(_type_and_name(texts), ("", at.get(3)))
    node = nodes.first_node(at.values)
    if node is None:
        endpoints.note_unknown_node(machine, kind.value, name, at)
        return av.Scalar(0)
    full = endpoints.declare_endpoint(machine, kind, node, name, type, at, qos=qos)
    place = {_FILE: av.Scalar(at.evidence.file), _LINE: av.Scalar(at.evidence.line)}
    return _fill(machine, at, av.Instance(ENDPOINT, {"name": full, **place}))


def _type_and_name(values: Sequence[av.Value]) -> Iterator[tuple[str, av.Value]]:
    """Yield a type as the macros of rosidl write it, and the name behind it."""
    for type, name in pairwise(values):
        if isinstance(type, av.Scalar) and str(type.value).count("/") > 1:
            yield str(type.value), name


def _add_callback(machine: AbstractMachine, _: object, at: Arguments) -> av.Value:
    """`rclc_executor_add_subscription(&executor, &subscription, &message, &callback, …)`."""
    fields = getattr(at.get(1), "fields", {})
    file, line = fields.get(_FILE), fields.get(_LINE)
    place = Evidence(file=file.value, line=line.value) if file and line else at.evidence
    for value in at.values:
        for option in av.options(value):
            machine.escape(option, place)
    return av.Scalar(0)


_KINDS = {
    "publisher": DeclarationKind.PUBLISH,
    "subscription": DeclarationKind.SUBSCRIBE,
    "service": DeclarationKind.SERVICE,
    "client": DeclarationKind.SERVICE_CLIENT,
    "action_server": DeclarationKind.ACTION_SERVER,
    "action_client": DeclarationKind.ACTION_CLIENT,
}
_QUALITIES = {"default": "default", "best_effort": "sensor_data"}
_ADDED = (
    *("subscription", "subscription_with_context", "timer", "client", "client_with_request_id"),
    *("service", "service_with_context", "service_with_request_id", "guard_condition"),
    *("action_server", "action_client"),
)


def _init_functions() -> Iterator[tuple[str, _Function]]:
    """Yield the functions that initialise an entity; one that takes a quality has none known."""
    for entity, kind in _KINDS.items():
        is_topic = kind in {DeclarationKind.PUBLISH, DeclarationKind.SUBSCRIBE}
        for library in ("rclc", "rcl"):
            yield f"{library}_{entity}_init", partial(_init_endpoint, kind, None)
        for ending, profile in _QUALITIES.items():
            qos = QOS_PROFILES[profile] if is_topic else None
            yield f"rclc_{entity}_init_{ending}", partial(_init_endpoint, kind, qos)


RCLC_FUNCTIONS: Mapping[str, _Function] = {
    **dict.fromkeys(
        ("rclc_node_init_default", "rclc_node_init_with_options", "rcl_node_init"), _init_node
    ),
    **dict(_init_functions()),
    **{f"rclc_executor_add_{entity}": _add_callback for entity in _ADDED},
    **dict.fromkeys(("rclc_timer_init_default", "rclc_timer_init_default2"), _add_callback),
}
