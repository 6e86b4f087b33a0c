"""Parameters as rclpy's nodes declare and read them (docs.ros.org: rclpy.node, rclpy.parameter)."""

from collections.abc import Callable, Mapping

from rtron.sources.code.interpreter import abstract_values as av
from rtron.sources.code.interpreter.execution.abstract_machine import AbstractMachine
from rtron.sources.code.interpreter.execution.arguments import Arguments
from rtron.sources.code.library_models.ros2_common import parameters
from rtron.sources.code.library_models.ros2_common.mistyped_parameters import record_mistyped
from rtron.sources.code.library_models.ros2_common.parameter_types import (
    python_parameter_type,
    type_name,
)

_VALUES = (
    *("string_value", "integer_value", "double_value", "bool_value", "string_array_value"),
    *("integer_array_value", "double_array_value", "bool_array_value", "byte_array_value"),
)


def parameter_object(name: av.Value, value: av.Value) -> av.Instance:
    """Return an rclpy.parameter.Parameter."""
    return av.Instance(PARAMETER, {"name": name, "value": value, "type_": av.Unknown("type_")})


def _declare_parameter(machine: AbstractMachine, owner: av.Value, arguments: Arguments) -> av.Value:
    """`declare_parameter(name, value)`; a type instead of the value is no default."""
    name = arguments.value(0, "name")
    default = _declared_default(arguments.get(1, "value"))
    record_mistyped(machine, owner, arguments, type_name(default))
    return parameter_object(name, parameters.declare_node_parameter(machine, owner, name, default))


def _declared_default(value: av.Value | None) -> av.Value | None:
    kind = python_parameter_type(value)
    if kind is not None:
        return kind
    is_open = (
        value is None or value == av.NONE or isinstance(value, (av.ExternalSymbol, av.Instance))
    )
    return None if is_open else value


def _declare_all(machine: AbstractMachine, owner: av.Value, arguments: Arguments) -> av.Value:
    """`declare_parameters(namespace, [(name, value), …])`."""
    space, given = arguments.get(0, "namespace"), arguments.get(1, "parameters")
    flag = arguments.get(2, "ignore_override")
    items, certain = av.items_of(given or av.NONE)
    found: list[av.Value] = []
    for item in items:
        words = av.items_of(item)[0]
        name, value = (*words, av.UNKNOWN, None)[:2]
        full, default = (
            parameters.prefixed_name(space, name or av.UNKNOWN),
            _declared_default(value),
        )
        call = arguments.with_values(full, *words[1:], *(() if flag is None else (flag,)))
        record_mistyped(machine, owner, call, type_name(default))
        declared = parameters.declare_node_parameter(machine, owner, full, default)
        found.append(parameter_object(full, declared))
    return av.list_of(found, certain=certain)


def _get_parameter(machine: AbstractMachine, owner: av.Value, arguments: Arguments) -> av.Value:
    """`get_parameter(name)`."""
    name = arguments.value(0, "name")
    return parameter_object(name, parameters.read_node_parameter(machine, owner, name))


def _get_parameter_or(machine: AbstractMachine, owner: av.Value, arguments: Arguments) -> av.Value:
    """`get_parameter_or(name, alternative)`."""
    name = arguments.value(0, "name")
    default = parameters.unwrap_parameter(arguments.get(1, "alternative_value")) or av.NONE
    found = parameters.node_parameter_value(machine, owner, name)
    return parameter_object(name, parameters.value_or_default(found, default))


def _get_parameters(machine: AbstractMachine, owner: av.Value, arguments: Arguments) -> av.Value:
    """`get_parameters([name, …])`."""
    names, _ = av.items_of(arguments.get(0, "names") or av.NONE)
    return av.list_of([_get_parameter(machine, owner, arguments.with_values(n)) for n in names])


def _get_by_prefix(machine: AbstractMachine, owner: av.Value, arguments: Arguments) -> av.Value:
    """`get_parameters_by_prefix(prefix)`: what the launch sets below a prefix, and maybe others."""
    prefix = arguments.get(0, "prefix")
    if not isinstance(prefix, av.Scalar):
        return av.MapValue({av.OPEN: av.Unknown("parameter", tainted=True)})
    names, certain = parameters.parameter_names(machine, owner)
    found: dict[object, av.Value] = {}
    for name, rest in parameters.names_below(names, str(prefix.value)).items():
        value = parameters.node_parameter_value(machine, owner, av.Scalar(name)) or av.UNKNOWN
        found[rest] = parameter_object(av.Scalar(name), value)
    if not certain:
        found[av.OPEN] = parameter_object(
            av.UNKNOWN, av.Unknown(f"~{prefix.value}.*", tainted=True)
        )
    return av.MapValue(found)


def _add_callback(machine: AbstractMachine, _: av.Value, arguments: Arguments) -> av.Value:
    parameters.note_parameter_callbacks(machine, arguments)
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
    **parameters.PARAMETER_METHODS,
    "declare_parameter": _declare_parameter,
    "declare_parameters": _declare_all,
    "get_parameter": _get_parameter,
    "get_parameter_or": _get_parameter_or,
    "get_parameters": _get_parameters,
    "get_parameters_by_prefix": _get_by_prefix,
    **dict.fromkeys(parameters.PARAMETER_CALLBACKS, _add_callback),
}
