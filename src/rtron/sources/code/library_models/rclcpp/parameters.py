"""Parameters as rclcpp's nodes declare and read them (docs.ros.org: rclcpp::Node)."""

from collections.abc import Callable, Mapping

from rtron.sources.code.interpreter.abstract_values.items import items_of, listed
from rtron.sources.code.interpreter.abstract_values.value_types import (
    FALSE,
    NONE,
    TRUE,
    Hole,
    Instance,
    Known,
    ListValue,
    NativeClass,
    Value,
    concat,
    join,
    options,
)
from rtron.sources.code.interpreter.execution.abstract_machine import Machine
from rtron.sources.code.interpreter.execution.arguments import Arguments
from rtron.sources.code.library_models.common.cpp_arguments import escape_all
from rtron.sources.code.library_models.ros2_common.parameter_types import is_kind, is_unset, kind_of
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


def parameter(name: Value, value: Value) -> Instance:
    """Return an rclcpp::Parameter."""
    return Instance(PARAMETER, {"name": name, "value": value})


def _value(value: Value | None) -> Value | None:
    """Return what a parameter or a ParameterValue holds."""
    is_parameter = isinstance(value, Instance) and value.type is PARAMETER
    return value.fields["value"] if is_parameter else value  # type: ignore[union-attr]


def declare_parameter(machine: Machine, owner: Value, arguments: Arguments) -> Value:
    """`declare_parameter<T>(name[, default])`, `declare_parameter(name, type)`."""
    default = _value(arguments.get(1))
    if isinstance(default, Instance) and not is_kind(default):
        default = None
    return declared(machine, owner, arguments.get(0) or _UNKNOWN, default)


def declare_parameters(machine: Machine, owner: Value, arguments: Arguments) -> Value:
    """`declare_parameters(namespace, {{name, default}, …})`."""
    found: list[Value] = []
    for item in items_of(arguments.get(1) or NONE)[0]:
        name, default = (*items_of(item)[0], _UNKNOWN, None)[:2]
        full = _joined(arguments.get(0), name or _UNKNOWN)
        found.append(declared(machine, owner, full, _value(default)))
    return listed(found)


def _joined(namespace: Value | None, name: Value) -> Value:
    if namespace is None or namespace == Known(""):
        return name
    return concat((namespace, Known("."), name))


def get_parameter(machine: Machine, owner: Value, arguments: Arguments) -> Value:
    """`get_parameter(name)`, or `get_parameter(name, variable)`, which tells whether it is set."""
    name = arguments.get(0) or _UNKNOWN
    if len(arguments.values) < 2:  # noqa: PLR2004 - a name and a variable
        return parameter(name, read(machine, owner, name))
    return _written(machine, arguments, known(machine, owner, name))


def _written(machine: Machine, arguments: Arguments, found: Value | None) -> Value:
    place, is_parameter = arguments.place(1), isinstance(arguments.get(1), Instance)
    if found is None or is_unset(found):
        return FALSE
    if place is not None:
        name = arguments.get(0) or _UNKNOWN
        machine.trail.set(*place, parameter(name, found) if is_parameter else found)
    return Hole("get_parameter") if isinstance(found, Hole) else TRUE


def get_parameter_or(machine: Machine, owner: Value, arguments: Arguments) -> Value:
    """`get_parameter_or(name, variable, default)`, `get_parameter_or(name, default)`."""
    default = arguments.get(len(arguments.values) - 1) or _UNKNOWN
    found = known(machine, owner, arguments.get(0) or _UNKNOWN)
    if found is None or is_unset(found):
        value = default
    else:
        value = join((default, found)) if isinstance(found, Hole) else found
    place = arguments.place(1)
    if len(arguments.values) < 3:  # noqa: PLR2004 - a name, a variable and a default
        return value
    if place is not None:
        machine.trail.set(*place, value)
    return FALSE if found is None or is_unset(found) else TRUE


def get_parameters(machine: Machine, owner: Value, arguments: Arguments) -> Value:
    """`get_parameters({name, …})`."""
    names, certain = items_of(arguments.get(0) or NONE)
    found = [(name, known(machine, owner, name)) for name in names]
    items = [parameter(n, Hole("parameter", tainted=True) if v is None else v) for n, v in found]
    return ListValue({"items": tuple(items), "open": not certain})


def has_parameter(machine: Machine, owner: Value, arguments: Arguments) -> Value:
    """`has_parameter(name)`: whether it is declared."""
    answer = is_declared(machine, owner, arguments.get(0) or _UNKNOWN)
    if answer is False and _declares_all(owner):
        found = known(machine, owner, arguments.get(0) or _UNKNOWN)
        return (
            FALSE if found is None else Hole("has_parameter") if isinstance(found, Hole) else TRUE
        )
    return Hole("has_parameter") if answer is None else Known(answer)


def _declares_all(owner: Value) -> bool:
    return isinstance(owner, Instance) and owner.fields.get(AUTOMATIC) == TRUE


def set_parameter(machine: Machine, owner: Value, arguments: Arguments) -> Value:
    """`set_parameter(Parameter(name, value))`, `set_parameters({…})`."""
    given = arguments.get(0) or NONE
    for item in items_of(given)[0] if isinstance(given, ListValue) else options(given):
        if isinstance(item, Instance) and item.type is PARAMETER:
            written(machine, owner, item.fields["name"], item.fields["value"])
    return Hole("set_parameter")


def watch(machine: Machine, owner: Value, arguments: Arguments) -> Value:
    """`register_on_configure(…)` and its kin."""
    del owner
    escape_all(machine, arguments)
    return Hole("handle")


def _watch_parameters(machine: Machine, owner: Value, arguments: Arguments) -> Value:
    """`add_on_set_parameters_callback(…)` and its kin."""
    watch_changes(machine, arguments)
    return watch(machine, owner, arguments)


def _make_parameter(_: Machine, arguments: Arguments) -> Value:
    """`rclcpp::Parameter(name, value)`."""
    return parameter(arguments.get(0) or _UNKNOWN, _value(arguments.get(1)) or NONE)


def _make_value(_: Machine, arguments: Arguments) -> Value:
    """`rclcpp::ParameterValue(x)` is x."""
    return _value(arguments.get(0)) or _UNKNOWN


def _get(_: Machine, owner: Instance, __: Arguments) -> Value:
    return owner.fields["value"]


def _get_name(_: Machine, owner: Instance, __: Arguments) -> Value:
    return owner.fields["name"]


def _itself(_: Machine, owner: Instance, __: Arguments) -> Value:
    return owner


def _kind(_: Machine, owner: Instance, __: Arguments) -> Value:
    return kind_of(owner.fields["value"])


_AS = ("string", "int", "double", "bool")
PARAMETER = NativeClass(
    "rclcpp::Parameter",
    _make_parameter,
    {
        **{f"as_{kind}": _get for kind in _AS},
        **{f"as_{kind}_array": _get for kind in (*_AS, "integer", "byte")},
        **dict.fromkeys(("get_value", "value_to_string", "get"), _get),
        "get_parameter_value": _itself,
        "get_name": _get_name,
        "get_type": _kind,
    },
)
PARAMETER_CLASSES: Mapping[str, NativeClass] = {
    "rclcpp::Parameter": PARAMETER,
    "rclcpp::ParameterValue": NativeClass("rclcpp::ParameterValue", _make_value),
}
PARAMETER_METHODS: Mapping[str, Callable[..., Value]] = {
    "declare_parameter": declare_parameter,
    "declare_parameters": declare_parameters,
    "get_parameter": get_parameter,
    "get_parameter_or": get_parameter_or,
    "get_parameters": get_parameters,
    "has_parameter": has_parameter,
    **dict.fromkeys(
        ("set_parameter", "set_parameters", "set_parameters_atomically"), set_parameter
    ),
    **dict.fromkeys(
        (
            "add_on_set_parameters_callback",
            "add_post_set_parameters_callback",
            "add_pre_set_parameters_callback",
        ),
        _watch_parameters,
    ),
}
