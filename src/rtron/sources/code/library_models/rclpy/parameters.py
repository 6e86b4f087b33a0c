"""Parameters as rclpy's nodes declare and read them (docs.ros.org: rclpy.node, rclpy.parameter)."""

from collections.abc import Callable, Mapping

from rtron.sources.code.interpreter import abstract_values as av
from rtron.sources.code.interpreter.execution.abstract_machine import AbstractMachine
from rtron.sources.code.interpreter.execution.arguments import Arguments
from rtron.sources.code.library_models.ros2_common.mistyped_parameters import record_mistyped
from rtron.sources.code.library_models.ros2_common.parameter_types import (
    python_parameter_type,
    type_name,
)
from rtron.sources.code.library_models.ros2_common.parameters import (
    PARAMETER_CALLBACKS,
    declare_node_parameter,
    has_node_parameter,
    list_parameters,
    names_below,
    node_parameter_value,
    note_parameter_callbacks,
    parameter_names,
    prefixed_name,
    read_node_parameter,
    set_node_parameter,
    value_or_default,
)

_VALUES = (
    *("string_value", "integer_value", "double_value", "bool_value", "string_array_value"),
    *("integer_array_value", "double_array_value", "bool_array_value", "byte_array_value"),
)


def parameter_object(name: av.Value, value: av.Value) -> av.Instance:
    """Return an rclpy.parameter.Parameter."""
    return av.Instance(PARAMETER, {"name": name, "value": value, "type_": av.Unknown("type_")})


def _unwrapped(value: av.Value | None) -> av.Value | None:
    is_parameter = isinstance(value, av.Instance) and value.type is PARAMETER
    return value.fields["value"] if is_parameter else value  # type: ignore[union-attr]


def _declare_parameter(machine: AbstractMachine, owner: av.Value, arguments: Arguments) -> av.Value:
    """`declare_parameter(name, value)`; a type instead of the value is no default."""
    name = arguments.value(0, "name")
    default = _declared_default(arguments.get(1, "value"))
    record_mistyped(machine, owner, arguments, type_name(default))
    return parameter_object(name, declare_node_parameter(machine, owner, name, default))


def _declared_default(value: av.Value | None) -> av.Value | None:
    kind = python_parameter_type(value)
    if kind is not None:
        return kind
    is_open = (
        value is None or value == av.NONE or isinstance(value, (av.ExternalSymbol, av.Instance))
    )
    return None if is_open else value


def _declare_parameters(
    machine: AbstractMachine, owner: av.Value, arguments: Arguments
) -> av.Value:
    """`declare_parameters(namespace, [(name, value), …])`."""
    space, given = arguments.get(0, "namespace"), arguments.get(1, "parameters")
    flag = arguments.get(2, "ignore_override")
    items, certain = av.items_of(given or av.NONE)
    found: list[av.Value] = []
    for item in items:
        words = av.items_of(item)[0]
        name, value = (*words, av.UNKNOWN, None)[:2]
        full, default = prefixed_name(space, name or av.UNKNOWN), _declared_default(value)
        call = arguments.with_values(full, *words[1:], *(() if flag is None else (flag,)))
        record_mistyped(machine, owner, call, type_name(default))
        declared = declare_node_parameter(machine, owner, full, default)
        found.append(parameter_object(full, declared))
    return av.list_of(found, certain=certain)


def _get_parameter(machine: AbstractMachine, owner: av.Value, arguments: Arguments) -> av.Value:
    """`get_parameter(name)`."""
    name = arguments.value(0, "name")
    return parameter_object(name, read_node_parameter(machine, owner, name))


def _get_parameter_or(machine: AbstractMachine, owner: av.Value, arguments: Arguments) -> av.Value:
    """`get_parameter_or(name, alternative)`."""
    name = arguments.value(0, "name")
    default = _unwrapped(arguments.get(1, "alternative_value")) or av.NONE
    found = node_parameter_value(machine, owner, name)
    return parameter_object(name, value_or_default(found, default))


def _get_parameters(machine: AbstractMachine, owner: av.Value, arguments: Arguments) -> av.Value:
    """`get_parameters([name, …])`."""
    names, _ = av.items_of(arguments.get(0, "names") or av.NONE)
    return av.list_of([_get_parameter(machine, owner, arguments.with_values(n)) for n in names])


def _get_parameters_by_prefix(
    machine: AbstractMachine, owner: av.Value, arguments: Arguments
) -> av.Value:
    """`get_parameters_by_prefix(prefix)`: what the launch sets below a prefix, and maybe others."""
    prefix = arguments.get(0, "prefix")
    if not isinstance(prefix, av.Scalar):
        return av.MapValue({av.OPEN: av.Unknown("parameter", tainted=True)})
    names, certain = parameter_names(machine, owner)
    found: dict[object, av.Value] = {}
    for name, rest in names_below(names, str(prefix.value)).items():
        value = node_parameter_value(machine, owner, av.Scalar(name)) or av.UNKNOWN
        found[rest] = parameter_object(av.Scalar(name), value)
    if not certain:
        found[av.OPEN] = parameter_object(
            av.UNKNOWN, av.Unknown(f"~{prefix.value}.*", tainted=True)
        )
    return av.MapValue(found)


def _has_parameter(machine: AbstractMachine, owner: av.Value, arguments: Arguments) -> av.Value:
    """`has_parameter(name)`."""
    return has_node_parameter(machine, owner, arguments.value(0, "name"))


def _set_parameters(machine: AbstractMachine, owner: av.Value, arguments: Arguments) -> av.Value:
    """`set_parameters([Parameter(…), …])`."""
    for item in av.items_of(arguments.get(0, "parameter_list") or av.NONE)[0]:
        if isinstance(item, av.Instance) and item.type is PARAMETER:
            set_node_parameter(machine, owner, item.fields["name"], item.fields["value"])
    return av.Unknown("set_parameters")


def _add_parameter_callback(
    machine: AbstractMachine, _: av.Value, arguments: Arguments
) -> av.Value:
    note_parameter_callbacks(machine, arguments)
    machine.escape(arguments.get(0, "callback"))
    return av.NONE


def _make_parameter(_: AbstractMachine, arguments: Arguments) -> av.Value:
    """`Parameter(name, type, value)`."""
    value = arguments.get(2, "value") or av.NONE
    return parameter_object(arguments.value(0, "name"), value)


def _parameter_value_message(_: AbstractMachine, owner: av.Instance, __: Arguments) -> av.Value:
    """`get_parameter_value()`: a message with a field for each type."""
    return av.Instance(_MESSAGE, dict.fromkeys(_VALUES, owner.fields["value"]))


_MESSAGE = av.LibraryClass("rcl_interfaces/ParameterValue")
PARAMETER = av.LibraryClass(
    "rclpy.parameter.Parameter", _make_parameter, {"get_parameter_value": _parameter_value_message}
)
PARAMETER_METHODS: Mapping[str, Callable[..., av.Value]] = {
    "declare_parameter": _declare_parameter,
    "declare_parameters": _declare_parameters,
    "get_parameter": _get_parameter,
    "get_parameter_or": _get_parameter_or,
    "get_parameters": _get_parameters,
    "get_parameters_by_prefix": _get_parameters_by_prefix,
    "has_parameter": _has_parameter,
    "list_parameters": list_parameters,
    **dict.fromkeys(("set_parameters", "set_parameters_atomically"), _set_parameters),
    **dict.fromkeys(PARAMETER_CALLBACKS, _add_parameter_callback),
}
