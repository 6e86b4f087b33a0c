"""rclcpp::Node, its options, lifecycle nodes, component managers (docs.ros.org: rclcpp)."""

from collections.abc import Callable, Mapping
from functools import partial

from rtron.sources.code.interpreter import abstract_values as av
from rtron.sources.code.interpreter.execution.abstract_machine import AbstractMachine
from rtron.sources.code.interpreter.execution.arguments import Arguments
from rtron.sources.code.interpreter.execution.calls import dispatch
from rtron.sources.code.library_models.common.trivial_functions import (
    return_owner,
    returning_unknown,
)
from rtron.sources.code.library_models.rclcpp.endpoints import ENDPOINT_METHODS, GRAPH_METHODS
from rtron.sources.code.library_models.rclcpp.parameters import (
    PARAMETER_METHODS,
    parameter_object,
    register_callbacks,
)
from rtron.sources.code.library_models.ros1_common.names import abstract_value
from rtron.sources.code.library_models.ros2_common import endpoints, nodes
from rtron.sources.code.library_models.ros2_common.parameters import (
    AUTOMATIC_FIELD,
    OVERRIDES_FIELD,
)
from rtron.sources.declaration import NodeSite

_OPTIONS, _ARGUMENTS, _OVERRIDES = "node.options", "options.arguments", "options.overrides"
_USES_GLOBAL_ARGUMENTS = "options.use_global_arguments"
_AUTOMATIC = "automatically_declare_parameters_from_overrides"
_FLAGS: Mapping[str, av.Value] = {
    **dict.fromkeys(("use_global_arguments", "start_parameter_services"), av.TRUE),
    **dict.fromkeys(("enable_rosout", "start_parameter_event_publisher"), av.TRUE),
    **dict.fromkeys(("enable_logger_service", _AUTOMATIC), av.FALSE),
}
"""The options that are on or off, with their defaults."""


def make_options(_: AbstractMachine, arguments: Arguments) -> av.Instance:
    """`rclcpp::NodeOptions()`, or a copy of others."""
    given = arguments.get(0)
    fields = given.fields if isinstance(given, av.Instance) else {}
    before = fields if _USES_GLOBAL_ARGUMENTS in fields else {}
    made = {_ARGUMENTS: av.list_of(()), _OVERRIDES: av.list_of(())}
    return av.Instance(OPTIONS, {**made, **_flags(_FLAGS), **before})


def _flags(values: Mapping[str, av.Value]) -> dict[object, av.Value]:
    """Return options by the names of their fields, which no method has."""
    return {f"options.{name}": value for name, value in values.items()}


def container_options(machine: AbstractMachine, at: Arguments) -> av.Instance:
    """Return options without parameter services and parameter events, as a container has them."""
    made = make_options(machine, at.with_values())
    made.fields |= _flags(
        dict.fromkeys(("start_parameter_services", "start_parameter_event_publisher"), av.FALSE)
    )
    return made


def controller_options(machine: AbstractMachine, at: Arguments) -> av.Instance:
    """Return options by which all that is set is declared, as a controller's node has them."""
    made = make_options(machine, at.with_values())
    made.fields |= _flags({_AUTOMATIC: av.TRUE})
    return made


def component_options(site: NodeSite) -> av.Instance:
    """Return the options that a component is made with (rclcpp_components).

    What a container loads takes no arguments of the process, unless its extra arguments say so; an
    executable that is registered for one component makes it with the process's.
    """
    own = (
        parameter_object(av.Scalar(name), abstract_value(value, f"~{name}"))
        for name, value in site.overrides
    )
    fields: dict[object, av.Value] = {_ARGUMENTS: av.list_of(tuple(map(av.Scalar, site.args)))}
    fields |= {_OVERRIDES: av.list_of(tuple(own)), **_flags(_FLAGS)}
    if site.loading is not None:
        extra = {name: av.Scalar(value) for name, value in site.loading.options}
        fields[_USES_GLOBAL_ARGUMENTS] = extra.pop("forward_global_arguments", av.FALSE)
        fields |= _flags({name: value for name, value in extra.items() if name in _FLAGS})
    return av.Instance(OPTIONS, fields)


def _get_or_set_option(
    field: str, machine: AbstractMachine, owner: av.Instance, arguments: Arguments
) -> av.Value:
    """Set an option and return all; without an argument, return the option."""
    if not arguments.values:
        return owner.fields[field]
    machine.undo_log.set(owner.fields, field, arguments.values[0])
    return owner


def _add_override(machine: AbstractMachine, owner: av.Instance, arguments: Arguments) -> av.Value:
    """`append_parameter_override(name, value)`."""
    before = getattr(owner.fields[_OVERRIDES], "items", ())
    added = parameter_object(arguments.value(0), arguments.get(1) or av.NONE)
    machine.undo_log.set(owner.fields, _OVERRIDES, av.list_of((*before, added)))
    return owner


def make_node(
    machine: AbstractMachine, arguments: Arguments, *, lifecycle: bool = False
) -> av.Instance:
    """`Node(name[, namespace][, options])`."""
    objects = (v for v in arguments.values if isinstance(v, av.Instance))
    given = next((v for v in objects if _USES_GLOBAL_ARGUMENTS in v.fields), None)
    chosen = given or make_options(machine, arguments.with_values())
    words = _node_arguments(arguments, chosen)
    fields: dict[object, av.Value] = {
        nodes.NAME_FIELD: nodes.full_name(machine, words),
        _OPTIONS: chosen,
        nodes.GLOBAL_ARGUMENTS_FIELD: av.Scalar(words.uses_global_arguments),
        OVERRIDES_FIELD: _parameter_overrides(chosen),
        AUTOMATIC_FIELD: chosen.fields[f"options.{_AUTOMATIC}"],
    }
    made = av.Instance(LIFECYCLE_NODE if lifecycle else NODE, fields)
    _declare_node(machine, made, words, chosen, arguments)
    return made


def _declare_node(
    machine: AbstractMachine,
    made: av.Instance,
    words: nodes.NodeArguments,
    chosen: av.Instance,
    at: Arguments,
) -> None:
    def is_enabled(option: str) -> bool:
        return av.truth(chosen.fields.get(f"options.{option}", av.TRUE)) is not False

    endpoints.declare_node(machine, made, words, at, is_enabled)
    if made.type is LIFECYCLE_NODE and not (at.values and at.values[-1] == av.FALSE):
        endpoints.declare_lifecycle(machine, made, at)


def _node_arguments(arguments: Arguments, chosen: av.Instance) -> nodes.NodeArguments:
    return nodes.NodeArguments(
        name=arguments.get(0) or av.Unknown("node"),
        namespace=_namespace_argument(arguments) or av.Scalar(""),
        arguments=chosen.fields[_ARGUMENTS],
        uses_global_arguments=av.truth(chosen.fields[_USES_GLOBAL_ARGUMENTS]) is not False,
    )


def _namespace_argument(arguments: Arguments) -> av.Value | None:
    """Return a namespace among the arguments; what is unknown there may be the options."""
    second, third = arguments.get(1), arguments.get(2)
    may_be = any(map(av.is_text, av.options(second))) or (
        isinstance(second, av.Unknown) and third is not None
    )
    return second if may_be else None


def _parameter_overrides(chosen: av.Instance) -> av.Value:
    """Return the parameters that the options set: their overrides count over their arguments."""
    given = getattr(chosen.fields[_OVERRIDES], "items", ())
    pairs = nodes.own_parameters(chosen.fields[_ARGUMENTS])
    return av.list_of(
        (*(parameter_object(av.Scalar(name), value) for name, value in pairs), *given)
    )


def _copy_options(machine: AbstractMachine, owner: av.Instance, arguments: Arguments) -> av.Value:
    given = owner.fields.get(_OPTIONS)
    values = (given,) if given is not None else ()
    return make_options(machine, arguments.with_values(*values))


def _run_transition(
    callback: str, machine: AbstractMachine, owner: av.Instance, arguments: Arguments
) -> av.Value:
    """`configure()` and the like call the class's method for it."""
    method = machine.runtime.attribute(owner, callback, ())
    if method is not None and (id(owner), callback) not in machine.started_callbacks:
        state = arguments.with_values(av.Unknown("state"))
        machine.started_callbacks.add((id(owner), callback))
        dispatch(machine, method, state)
    return endpoints.change_own_state(machine, owner, arguments)


_TRANSITIONS = ("configure", "activate", "deactivate", "cleanup", "shutdown")
_INTERFACES = (
    *("base", "clock", "graph", "logging", "parameters", "services", "time_source", "timers"),
    *("topics", "type_descriptions", "waitables"),
)
NODE_METHODS: Mapping[str, Callable[..., av.Value]] = {
    **ENDPOINT_METHODS,
    **PARAMETER_METHODS,
    **GRAPH_METHODS,
    **{f"get_node_{interface}_interface": return_owner for interface in _INTERFACES},
    **dict.fromkeys(("shared_from_this", "weak_from_this"), return_owner),
    "get_name": lambda machine, owner, arguments: nodes.node_base_name(owner),
    "get_namespace": lambda machine, owner, arguments: nodes.node_namespace(owner),
    "get_fully_qualified_name": lambda machine, owner, arguments: nodes.node_name(owner),
    "get_node_options": _copy_options,
}
NODE = av.LibraryClass("rclcpp::Node", make_node, dict(NODE_METHODS))
LIFECYCLE_NODE = av.LibraryClass(
    "rclcpp_lifecycle::LifecycleNode",
    partial(make_node, lifecycle=True),
    {
        **NODE_METHODS,
        "trigger_transition": endpoints.change_own_state,
        **{name: partial(_run_transition, f"on_{name}") for name in _TRANSITIONS},
        **{f"register_on_{name}": register_callbacks for name in (*_TRANSITIONS, "error")},
        **{f"on_{name}": returning_unknown("success") for name in (*_TRANSITIONS, "error")},
    },
    virtual_callbacks=("on_configure", "on_activate", "on_deactivate", "on_cleanup", "on_shutdown"),
)
OPTIONS = av.LibraryClass(
    "rclcpp::NodeOptions",
    make_options,
    {
        "arguments": partial(_get_or_set_option, _ARGUMENTS),
        "parameter_overrides": partial(_get_or_set_option, _OVERRIDES),
        "append_parameter_override": _add_override,
        **{name: partial(_get_or_set_option, f"options.{name}") for name in _FLAGS},
        **dict.fromkeys(
            (
                *("allow_undeclared_parameters", "use_intra_process_comms", "context", "clock_qos"),
                "use_clock_thread",
                *("parameter_event_qos", "rosout_qos", "enable_topic_statistics", "allocator"),
            ),
            return_owner,
        ),
    },
)
NODE_CLASSES: Mapping[str, av.LibraryClass] = {
    cls.name: cls for cls in (NODE, LIFECYCLE_NODE, OPTIONS)
}


DEFAULT_CONTAINER_NAME = "ComponentManager"
"""What a container without a name is called."""
CONTAINER_SERVICES: Mapping[str, str] = {
    "_container/load_node": "composition_interfaces/srv/LoadNode",
    "_container/unload_node": "composition_interfaces/srv/UnloadNode",
    "_container/list_nodes": "composition_interfaces/srv/ListNodes",
}
"""docs.ros.org: "Composing multiple nodes in a single process"."""


def _make_component_manager(machine: AbstractMachine, arguments: Arguments) -> av.Instance:
    """`ComponentManager(executor[, name][, options])`."""
    name = arguments.get(1) or av.Scalar(DEFAULT_CONTAINER_NAME)
    options = arguments.get(2) or container_options(machine, arguments)
    given = arguments.with_values(name, options)
    made = make_node(machine, given)
    endpoints.declare_services(machine, made, CONTAINER_SERVICES, arguments)
    return made


COMPONENT_CLASSES: Mapping[str, av.LibraryClass] = {
    name: av.LibraryClass(name, _make_component_manager, dict(NODE.methods))
    for name in (
        f"rclcpp_components::{DEFAULT_CONTAINER_NAME}",
        f"rclcpp_components::{DEFAULT_CONTAINER_NAME}Isolated",
    )
}
