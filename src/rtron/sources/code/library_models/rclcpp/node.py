"""rclcpp::Node, its options, and lifecycle nodes (docs.ros.org: rclcpp, rclcpp_lifecycle)."""

from collections.abc import Callable, Mapping
from functools import partial

from rtron.sources.code.interpreter.abstract_values.items import listed
from rtron.sources.code.interpreter.abstract_values.value_types import (
    FALSE,
    NONE,
    TRUE,
    Hole,
    Instance,
    Known,
    NativeClass,
    Value,
    is_text,
    options,
    truth,
)
from rtron.sources.code.interpreter.execution.abstract_machine import Machine
from rtron.sources.code.interpreter.execution.arguments import Arguments
from rtron.sources.code.interpreter.execution.calls import dispatch
from rtron.sources.code.library_models.rclcpp.endpoints import ENDPOINT_METHODS
from rtron.sources.code.library_models.rclcpp.graph import GRAPH_METHODS
from rtron.sources.code.library_models.rclcpp.parameters import PARAMETER_METHODS, parameter, watch
from rtron.sources.code.library_models.ros1_common.names import value_of
from rtron.sources.code.library_models.ros2_common import endpoints
from rtron.sources.code.library_models.ros2_common.nodes import (
    GLOBALLY,
    NAME,
    SUB,
    NodeWords,
    base_at,
    full_name,
    name_of,
    namespace_at,
    own_settings,
    resolved,
    sub_node,
)
from rtron.sources.code.library_models.ros2_common.parameters import AUTOMATIC, OVERRIDES
from rtron.sources.declaration import NodeSite

_UNKNOWN = Hole("?")
_ARGUMENTS, _GLOBALLY, _GIVEN = "options.arguments", "options.globally", "options.overrides"
_OPTIONS = "node.options"
_SERVICES, _AUTOMATIC = "options.services", "options.automatic"
_ROSOUT, _EVENTS, _LOGGERS = "options.rosout", "options.events", "options.loggers"
_FLAGS = {
    "use_global_arguments": _GLOBALLY,
    "start_parameter_services": _SERVICES,
    "automatically_declare_parameters_from_overrides": _AUTOMATIC,
    "enable_rosout": _ROSOUT,
    "start_parameter_event_publisher": _EVENTS,
    "enable_logger_service": _LOGGERS,
}
_DEFAULTS: Mapping[object, Value] = {
    **dict.fromkeys((_GLOBALLY, _SERVICES, _ROSOUT, _EVENTS), TRUE),
    **dict.fromkeys((_AUTOMATIC, _LOGGERS), FALSE),
}
_EXTRA = {"forward_global_arguments": _GLOBALLY, **_FLAGS}
_ASKED = {
    "parameter_services": _SERVICES,
    "rosout": _ROSOUT,
    "parameter_events": _EVENTS,
    "logger_service": _LOGGERS,
}


def make_options(_: Machine, arguments: Arguments) -> Instance:
    """`rclcpp::NodeOptions()`, or a copy of others."""
    given = arguments.get(0)
    before = given.fields if isinstance(given, Instance) and _GLOBALLY in given.fields else {}
    fields: dict[object, Value] = {_ARGUMENTS: listed(()), _GIVEN: listed(())}
    return Instance(OPTIONS, {**fields, **_DEFAULTS, **before})


def bare_options(machine: Machine, at: Arguments) -> Instance:
    """Return options without parameter services and parameter events, as a container has them."""
    made = make_options(machine, Arguments(frame=at.frame))
    made.fields |= {_SERVICES: FALSE, _EVENTS: FALSE}
    return made


def declaring_options(machine: Machine, at: Arguments) -> Instance:
    """Return options by which all that is set is declared, as a controller's node has them."""
    made = make_options(machine, Arguments(frame=at.frame))
    made.fields |= {_AUTOMATIC: TRUE}
    return made


def loading_options(site: NodeSite) -> Instance:
    """Return the options that a component is made with (rclcpp_components).

    What a container loads takes no arguments of the process, unless its extra arguments say so; an
    executable that is registered for one component makes it with the process's.
    """
    own = (parameter(Known(name), value_of(value, f"~{name}")) for name, value in site.overrides)
    fields: dict[object, Value] = {_ARGUMENTS: listed(tuple(map(Known, site.args)))}
    fields |= {_GIVEN: listed(tuple(own)), **_DEFAULTS}
    if site.loading is not None:
        extra = dict(site.loading.options)
        fields[_GLOBALLY] = FALSE
        fields |= {_EXTRA[name]: Known(value) for name, value in extra.items() if name in _EXTRA}
    return Instance(OPTIONS, fields)


def _set(field: str, machine: Machine, owner: Instance, arguments: Arguments) -> Value:
    """Set an option and return all; without an argument, return the option."""
    if not arguments.values:
        return owner.fields[field]
    machine.trail.set(owner.fields, field, arguments.values[0])
    return owner


def _append_override(machine: Machine, owner: Instance, arguments: Arguments) -> Value:
    """`append_parameter_override(name, value)`."""
    before = getattr(owner.fields[_GIVEN], "items", ())
    added = parameter(arguments.get(0) or _UNKNOWN, arguments.get(1) or NONE)
    machine.trail.set(owner.fields, _GIVEN, listed((*before, added)))
    return owner


def _itself(_: Machine, owner: Instance, __: Arguments) -> Value:
    return owner


def make_node(machine: Machine, arguments: Arguments, *, lifecycle: bool = False) -> Instance:
    """`Node(name[, namespace][, options])`."""
    given = [v for v in arguments.values if isinstance(v, Instance) and _GLOBALLY in v.fields]
    chosen = given[0] if given else make_options(machine, Arguments(frame=arguments.frame))
    words = _words(arguments, chosen)
    fields = {NAME: full_name(machine, words), SUB: Known("")}
    fields |= {_OPTIONS: chosen, GLOBALLY: Known(words.globally)}
    fields |= {OVERRIDES: _overrides(chosen), AUTOMATIC: chosen.fields[_AUTOMATIC]}
    made = Instance(LIFECYCLE_NODE if lifecycle else NODE, fields)
    _join(machine, made, words, chosen, arguments)
    return made


def _join(
    machine: Machine, made: Instance, words: NodeWords, chosen: Instance, at: Arguments
) -> None:
    def asked(option: str) -> bool:
        field = _ASKED.get(option)
        return field is None or truth(chosen.fields[field]) is not False

    endpoints.join_app(machine, made, words, at, asked)
    if made.type is LIFECYCLE_NODE and not (at.values and at.values[-1] == FALSE):
        endpoints.lifecycle(machine, made, at)


def _words(arguments: Arguments, chosen: Instance) -> NodeWords:
    return NodeWords(
        name=arguments.get(0) or Hole("node"),
        namespace=_space(arguments) or Known(""),
        arguments=chosen.fields[_ARGUMENTS],
        globally=truth(chosen.fields[_GLOBALLY]) is not False,
    )


def _space(arguments: Arguments) -> Value | None:
    """Return a namespace among the arguments; what is unknown there may be the options."""
    second, third = arguments.get(1), arguments.get(2)
    may_be = any(map(is_text, options(second))) or (isinstance(second, Hole) and third is not None)
    return second if may_be else None


def _overrides(chosen: Instance) -> Value:
    """Return the parameters that the options set: their overrides count over their arguments."""
    given = getattr(chosen.fields[_GIVEN], "items", ())
    pairs = own_settings(chosen.fields[_ARGUMENTS])
    return listed((*(parameter(Known(name), value) for name, value in pairs), *given))


def _sub_node(_: Machine, owner: Instance, arguments: Arguments) -> Value:
    return sub_node(owner, arguments.get(0) or _UNKNOWN)


def _effective(_: Machine, owner: Instance, __: Arguments) -> Value:
    sub = owner.fields.get(SUB, Known(""))
    return namespace_at(owner) if sub == Known("") else resolved(owner, Known("")) or sub


def _own_options(machine: Machine, owner: Instance, arguments: Arguments) -> Value:
    given = owner.fields.get(_OPTIONS)
    values = (given,) if given is not None else ()
    return make_options(machine, Arguments(values=values, frame=arguments.frame))


def _field(field: str, _: Machine, owner: Instance, arguments: Arguments) -> Value:
    del arguments
    return owner.fields.get(field, _UNKNOWN)


def _transition(callback: str, machine: Machine, owner: Instance, arguments: Arguments) -> Value:
    """`configure()` and its kin call what the class has for it."""
    method = machine.world.attribute(owner, callback, ())
    if method is not None and (id(owner), callback) not in machine.transitions:
        state = Arguments(values=(Hole("state"),), line=arguments.line, frame=arguments.frame)
        machine.transitions.add((id(owner), callback))
        dispatch(machine, method, state)
    return Hole("state")


def _succeed(_: Machine, __: Instance, ___: Arguments) -> Value:
    return Hole("success")


_TRANSITIONS = ("configure", "activate", "deactivate", "cleanup", "shutdown")
_INTERFACES = (
    *("base", "clock", "graph", "logging", "parameters", "services", "time_source", "timers"),
    *("topics", "type_descriptions", "waitables"),
)
NODE_METHODS: Mapping[str, Callable[..., Value]] = {
    **ENDPOINT_METHODS,
    **PARAMETER_METHODS,
    **GRAPH_METHODS,
    **{f"get_node_{interface}_interface": _itself for interface in _INTERFACES},
    **dict.fromkeys(("shared_from_this", "weak_from_this"), _itself),
    "get_name": lambda machine, owner, arguments: base_at(owner),
    "get_namespace": lambda machine, owner, arguments: namespace_at(owner),
    "get_fully_qualified_name": lambda machine, owner, arguments: name_of(owner),
    "get_sub_namespace": partial(_field, SUB),
    "get_effective_namespace": _effective,
    "create_sub_node": _sub_node,
    "get_node_options": _own_options,
}
NODE = NativeClass("rclcpp::Node", make_node, dict(NODE_METHODS))
LIFECYCLE_NODE = NativeClass(
    "rclcpp_lifecycle::LifecycleNode",
    partial(make_node, lifecycle=True),
    {
        **NODE_METHODS,
        **{name: partial(_transition, f"on_{name}") for name in _TRANSITIONS},
        **{f"register_on_{name}": watch for name in (*_TRANSITIONS, "error")},
        **{f"on_{name}": _succeed for name in (*_TRANSITIONS, "error")},
    },
    called=("on_configure", "on_activate", "on_deactivate", "on_cleanup", "on_shutdown"),
)
OPTIONS = NativeClass(
    "rclcpp::NodeOptions",
    make_options,
    {
        "arguments": partial(_set, _ARGUMENTS),
        "parameter_overrides": partial(_set, _GIVEN),
        "append_parameter_override": _append_override,
        **{name: partial(_set, field) for name, field in _FLAGS.items()},
        **dict.fromkeys(
            (
                *("allow_undeclared_parameters", "use_intra_process_comms", "context", "clock_qos"),
                "use_clock_thread",
                *("parameter_event_qos", "rosout_qos", "enable_topic_statistics", "allocator"),
            ),
            _itself,
        ),
    },
)
NODE_CLASSES: Mapping[str, NativeClass] = {
    native.name: native for native in (NODE, LIFECYCLE_NODE, OPTIONS)
}
