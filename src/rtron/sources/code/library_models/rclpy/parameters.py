"""Parameters as rclpy's nodes declare and read them (docs.ros.org: rclpy.node, rclpy.parameter)."""

from collections.abc import Callable, Mapping

from rtron.sources.code.interpreter.abstract_values.items import items_of, listed
from rtron.sources.code.interpreter.abstract_values.value_types import (
    FALSE,
    NONE,
    OPEN,
    TRUE,
    Foreign,
    Hole,
    Instance,
    Known,
    ListValue,
    MapValue,
    NativeClass,
    Value,
    concat,
    join,
)
from rtron.sources.code.interpreter.execution.abstract_machine import Machine
from rtron.sources.code.interpreter.execution.arguments import Arguments
from rtron.sources.code.library_models.ros2_common.parameter_types import is_unset, python_kind
from rtron.sources.code.library_models.ros2_common.parameters import (
    AUTOMATIC,
    declared,
    is_declared,
    known,
    read,
    watch_changes,
    written,
)

_UNKNOWN = Hole("?")
_VALUES = (
    *("string_value", "integer_value", "double_value", "bool_value", "string_array_value"),
    *("integer_array_value", "double_array_value", "bool_array_value", "byte_array_value"),
)


def parameter(name: Value, value: Value) -> Instance:
    """Return an rclpy.parameter.Parameter."""
    return Instance(PARAMETER, {"name": name, "value": value, "type_": Hole("type_")})


def _value(value: Value | None) -> Value | None:
    is_parameter = isinstance(value, Instance) and value.type is PARAMETER
    return value.fields["value"] if is_parameter else value  # type: ignore[union-attr]


def _declare(machine: Machine, owner: Value, arguments: Arguments) -> Value:
    """`declare_parameter(name, value)`; a type in the value's place is no default."""
    name = arguments.get(0, "name") or _UNKNOWN
    default = arguments.get(1, "value")
    return parameter(name, declared(machine, owner, name, _default(default)))


def _default(value: Value | None) -> Value | None:
    kind = python_kind(value)
    if kind is not None:
        return kind
    is_open = value is None or value == NONE or isinstance(value, (Foreign, Instance))
    return None if is_open else value


def _declare_all(machine: Machine, owner: Value, arguments: Arguments) -> Value:
    """`declare_parameters(namespace, [(name, value), …])`."""
    space, given = arguments.get(0, "namespace"), arguments.get(1, "parameters")
    items, certain = items_of(given or NONE)
    found: list[Value] = []
    for item in items:
        name, value = (*items_of(item)[0], _UNKNOWN, None)[:2]
        full = concat((space, Known("."), name)) if space and space != Known("") else name  # type: ignore[arg-type]
        found.append(parameter(full, declared(machine, owner, full, _default(value))))  # type: ignore[arg-type]
    return ListValue({"items": tuple(found), "open": not certain})


def _get(machine: Machine, owner: Value, arguments: Arguments) -> Value:
    """`get_parameter(name)`."""
    name = arguments.get(0, "name") or _UNKNOWN
    return parameter(name, read(machine, owner, name))


def _get_or(machine: Machine, owner: Value, arguments: Arguments) -> Value:
    """`get_parameter_or(name, alternative)`."""
    name = arguments.get(0, "name") or _UNKNOWN
    default = _value(arguments.get(1, "alternative_value")) or NONE
    found = known(machine, owner, name)
    if found is None or is_unset(found):
        return parameter(name, default)
    return parameter(name, join((default, found)) if isinstance(found, Hole) else found)


def _get_all(machine: Machine, owner: Value, arguments: Arguments) -> Value:
    """`get_parameters([name, …])`."""
    names, _ = items_of(arguments.get(0, "names") or NONE)
    frame, line = arguments.frame, arguments.line
    return listed(
        [_get(machine, owner, Arguments(values=(n,), line=line, frame=frame)) for n in names]
    )


def _by_prefix(machine: Machine, owner: Value, arguments: Arguments) -> Value:
    """`get_parameters_by_prefix(prefix)`: what the launch sets below a prefix, and maybe others."""
    prefix = arguments.get(0, "prefix")
    if not isinstance(prefix, Known):
        return MapValue({OPEN: Hole("parameter", tainted=True)})
    start = f"{prefix.value}." if prefix.value else ""
    names = dict.fromkeys(one.name for one in machine.recorder.site.settings)
    found: dict[object, Value] = {}
    for name in (name for name in names if name.startswith(start)):
        value = known(machine, owner, Known(name))
        if value is not None:
            found[name.removeprefix(start)] = parameter(Known(name), value)
    if not machine.recorder.site.complete:
        found[OPEN] = parameter(_UNKNOWN, Hole(f"~{start}*", tainted=True))
    return MapValue(found)


def _has(machine: Machine, owner: Value, arguments: Arguments) -> Value:
    """`has_parameter(name)`."""
    name = arguments.get(0, "name") or _UNKNOWN
    answer = is_declared(machine, owner, name)
    automatic = isinstance(owner, Instance) and owner.fields.get(AUTOMATIC) == TRUE
    if answer is False and automatic:
        found = known(machine, owner, name)
        return FALSE if found is None else Hole("has_parameter")
    return Hole("has_parameter") if answer is None else Known(answer)


def _set(machine: Machine, owner: Value, arguments: Arguments) -> Value:
    """`set_parameters([Parameter(…), …])`."""
    for item in items_of(arguments.get(0, "parameter_list") or NONE)[0]:
        if isinstance(item, Instance) and item.type is PARAMETER:
            written(machine, owner, item.fields["name"], item.fields["value"])
    return Hole("set_parameters")


def _watch(machine: Machine, _: Value, arguments: Arguments) -> Value:
    watch_changes(machine, arguments)
    machine.escape(arguments.get(0, "callback"))
    return NONE


def _make(_: Machine, arguments: Arguments) -> Value:
    """`Parameter(name, type, value)`."""
    value = arguments.get(2, "value") or NONE
    return parameter(arguments.get(0, "name") or _UNKNOWN, value)


def _message(_: Machine, owner: Instance, __: Arguments) -> Value:
    """`get_parameter_value()`: a message with a field for each type."""
    return Instance(_MESSAGE, dict.fromkeys(_VALUES, owner.fields["value"]))


_MESSAGE = NativeClass("rcl_interfaces/ParameterValue")
PARAMETER = NativeClass("rclpy.parameter.Parameter", _make, {"get_parameter_value": _message})
PARAMETER_METHODS: Mapping[str, Callable[..., Value]] = {
    "declare_parameter": _declare,
    "declare_parameters": _declare_all,
    "get_parameter": _get,
    "get_parameter_or": _get_or,
    "get_parameters": _get_all,
    "get_parameters_by_prefix": _by_prefix,
    "has_parameter": _has,
    **dict.fromkeys(("set_parameters", "set_parameters_atomically"), _set),
    **dict.fromkeys(
        (
            "add_on_set_parameters_callback",
            "add_post_set_parameters_callback",
            "add_pre_set_parameters_callback",
        ),
        _watch,
    ),
}
