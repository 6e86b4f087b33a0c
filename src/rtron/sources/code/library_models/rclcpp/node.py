"""rclcpp::Node, its options, and lifecycle nodes (docs.ros.org: rclcpp, rclcpp_lifecycle)."""

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
from rtron.sources.code.library_models.ros2_common import endpoints
from rtron.sources.code.library_models.ros2_common.nodes import (
    GLOBAL_ARGUMENTS_FIELD,
    NAME_FIELD,
    SUB_NAMESPACE_FIELD,
    NodeArguments,
    full_name,
    node_base_name,
    node_name,
    node_namespace,
    own_parameters,
    resolve_at_node,
    sub_node,
)
from rtron.sources.code.library_models.ros2_common.parameters import (
    AUTOMATIC_FIELD,
    OVERRIDES_FIELD,
)
from rtron.sources.declaration import NodeSite

_ARGUMENTS, _USES_GLOBAL_ARGUMENTS, _OVERRIDES = (
    "options.arguments",
    "options.globally",
    "options.overrides",
)
_OPTIONS = "node.options"
_SERVICES, _AUTOMATIC = "options.services", "options.automatic"
_ROSOUT, _EVENTS, _LOGGERS = "options.rosout", "options.events", "options.loggers"
_FLAG_FIELDS = {
    "use_global_arguments": _USES_GLOBAL_ARGUMENTS,
    "start_parameter_services": _SERVICES,
    "automatically_declare_parameters_from_overrides": _AUTOMATIC,
    "enable_rosout": _ROSOUT,
    "start_parameter_event_publisher": _EVENTS,
    "enable_logger_service": _LOGGERS,
}
_DEFAULTS: Mapping[object, av.Value] = {
    **dict.fromkeys((_USES_GLOBAL_ARGUMENTS, _SERVICES, _ROSOUT, _EVENTS), av.TRUE),
    **dict.fromkeys((_AUTOMATIC, _LOGGERS), av.FALSE),
}
_EXTRA_ARGUMENT_FIELDS = {"forward_global_arguments": _USES_GLOBAL_ARGUMENTS, **_FLAG_FIELDS}
_OPTION_FIELDS = {
    "parameter_services": _SERVICES,
    "rosout": _ROSOUT,
    "parameter_events": _EVENTS,
    "logger_service": _LOGGERS,
}


def make_options(_: AbstractMachine, arguments: Arguments) -> av.Instance:
    """`rclcpp::NodeOptions()`, or a copy of others."""
    given = arguments.get(0)
    before = (
        given.fields
        if isinstance(given, av.Instance) and _USES_GLOBAL_ARGUMENTS in given.fields
        else {}
    )
    fields: dict[object, av.Value] = {_ARGUMENTS: av.list_of(()), _OVERRIDES: av.list_of(())}
    return av.Instance(OPTIONS, {**fields, **_DEFAULTS, **before})


def container_options(machine: AbstractMachine, at: Arguments) -> av.Instance:
    """Return options without parameter services and parameter events, as a container has them."""
    made = make_options(machine, at.with_values())
    made.fields |= {_SERVICES: av.FALSE, _EVENTS: av.FALSE}
    return made


def controller_options(machine: AbstractMachine, at: Arguments) -> av.Instance:
    """Return options by which all that is set is declared, as a controller's node has them."""
    made = make_options(machine, at.with_values())
    made.fields |= {_AUTOMATIC: av.TRUE}
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
    fields |= {_OVERRIDES: av.list_of(tuple(own)), **_DEFAULTS}
    if site.loading is not None:
        extra = dict(site.loading.options)
        fields[_USES_GLOBAL_ARGUMENTS] = av.FALSE
        fields |= {
            _EXTRA_ARGUMENT_FIELDS[name]: av.Scalar(value)
            for name, value in extra.items()
            if name in _EXTRA_ARGUMENT_FIELDS
        }
    return av.Instance(OPTIONS, fields)


def _get_or_set_option(
    field: str, machine: AbstractMachine, owner: av.Instance, arguments: Arguments
) -> av.Value:
    """Set an option and return all; without an argument, return the option."""
    if not arguments.values:
        return owner.fields[field]
    machine.undo_log.set(owner.fields, field, arguments.values[0])
    return owner


def _append_override(
    machine: AbstractMachine, owner: av.Instance, arguments: Arguments
) -> av.Value:
    """`append_parameter_override(name, value)`."""
    before = getattr(owner.fields[_OVERRIDES], "items", ())
    added = parameter_object(arguments.value(0), arguments.get(1) or av.NONE)
    machine.undo_log.set(owner.fields, _OVERRIDES, av.list_of((*before, added)))
    return owner


def make_node(
    machine: AbstractMachine, arguments: Arguments, *, lifecycle: bool = False
) -> av.Instance:
    """`Node(name[, namespace][, options])`."""
    given = [
        v
        for v in arguments.values
        if isinstance(v, av.Instance) and _USES_GLOBAL_ARGUMENTS in v.fields
    ]
    chosen = given[0] if given else make_options(machine, arguments.with_values())
    words = _node_arguments(arguments, chosen)
    fields = {NAME_FIELD: full_name(machine, words), SUB_NAMESPACE_FIELD: av.Scalar("")}
    fields |= {_OPTIONS: chosen, GLOBAL_ARGUMENTS_FIELD: av.Scalar(words.uses_global_arguments)}
    fields |= {
        OVERRIDES_FIELD: _parameter_overrides(chosen),
        AUTOMATIC_FIELD: chosen.fields[_AUTOMATIC],
    }
    made = av.Instance(LIFECYCLE_NODE if lifecycle else NODE, fields)
    _declare_node(machine, made, words, chosen, arguments)
    return made


def _declare_node(
    machine: AbstractMachine,
    made: av.Instance,
    words: NodeArguments,
    chosen: av.Instance,
    at: Arguments,
) -> None:
    def is_enabled(option: str) -> bool:
        field = _OPTION_FIELDS.get(option)
        return field is None or av.truth(chosen.fields[field]) is not False

    endpoints.declare_node(machine, made, words, at, is_enabled)
    if made.type is LIFECYCLE_NODE and not (at.values and at.values[-1] == av.FALSE):
        endpoints.declare_lifecycle(machine, made, at)


def _node_arguments(arguments: Arguments, chosen: av.Instance) -> NodeArguments:
    return NodeArguments(
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
    pairs = own_parameters(chosen.fields[_ARGUMENTS])
    return av.list_of(
        (*(parameter_object(av.Scalar(name), value) for name, value in pairs), *given)
    )


def _sub_node(_: AbstractMachine, owner: av.Instance, arguments: Arguments) -> av.Value:
    return sub_node(owner, arguments.value(0))


def _effective_namespace(_: AbstractMachine, owner: av.Instance, __: Arguments) -> av.Value:
    sub = owner.fields.get(SUB_NAMESPACE_FIELD, av.Scalar(""))
    return (
        node_namespace(owner)
        if sub == av.Scalar("")
        else resolve_at_node(owner, av.Scalar("")) or sub
    )


def _copy_node_options(
    machine: AbstractMachine, owner: av.Instance, arguments: Arguments
) -> av.Value:
    given = owner.fields.get(_OPTIONS)
    values = (given,) if given is not None else ()
    return make_options(machine, arguments.with_values(*values))


def _get_field(
    field: str, _: AbstractMachine, owner: av.Instance, arguments: Arguments
) -> av.Value:
    del arguments
    return owner.fields.get(field, av.UNKNOWN)


def _run_transition(
    callback: str, machine: AbstractMachine, owner: av.Instance, arguments: Arguments
) -> av.Value:
    """`configure()` and the like call the class's method for it."""
    method = machine.runtime.attribute(owner, callback, ())
    if method is not None and (id(owner), callback) not in machine.started_callbacks:
        state = arguments.with_values(av.Unknown("state"))
        machine.started_callbacks.add((id(owner), callback))
        dispatch(machine, method, state)
    return av.Unknown("state")


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
    "get_name": lambda machine, owner, arguments: node_base_name(owner),
    "get_namespace": lambda machine, owner, arguments: node_namespace(owner),
    "get_fully_qualified_name": lambda machine, owner, arguments: node_name(owner),
    "get_sub_namespace": partial(_get_field, SUB_NAMESPACE_FIELD),
    "get_effective_namespace": _effective_namespace,
    "create_sub_node": _sub_node,
    "get_node_options": _copy_node_options,
}
NODE = av.LibraryClass("rclcpp::Node", make_node, dict(NODE_METHODS))
LIFECYCLE_NODE = av.LibraryClass(
    "rclcpp_lifecycle::LifecycleNode",
    partial(make_node, lifecycle=True),
    {
        **NODE_METHODS,
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
        "append_parameter_override": _append_override,
        **{name: partial(_get_or_set_option, field) for name, field in _FLAG_FIELDS.items()},
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
