"""Parameters as rclcpp's nodes declare and read them (docs.ros.org: rclcpp::Node)."""

from collections.abc import Callable, Mapping

from rtron.sources.code.interpreter import abstract_values as av
from rtron.sources.code.interpreter.execution.abstract_machine import AbstractMachine
from rtron.sources.code.interpreter.execution.arguments import Arguments
from rtron.sources.code.ir import TypeRef
from rtron.sources.code.library_models.common.cpp_arguments import escape_functions
from rtron.sources.code.library_models.common.trivial_functions import return_owner
from rtron.sources.code.library_models.ros2_common.mistyped_parameters import record_mistyped
from rtron.sources.code.library_models.ros2_common.parameter_types import (
    is_parameter_type,
    is_unset,
    parameter_type,
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


def parameter_object(name: av.Value, value: av.Value) -> av.Instance:
    """Return an rclcpp::Parameter."""
    return av.Instance(PARAMETER, {"name": name, "value": value})


def _unwrap_parameter(value: av.Value | None) -> av.Value | None:
    """Return what a parameter or a ParameterValue holds."""
    is_parameter = isinstance(value, av.Instance) and value.type is PARAMETER
    return value.fields["value"] if is_parameter else value  # type: ignore[union-attr]


def declare_parameter(machine: AbstractMachine, owner: av.Value, arguments: Arguments) -> av.Value:
    """`declare_parameter<T>(name[, default])`, `declare_parameter(name, type)`."""
    default = _unwrap_parameter(arguments.get(1))
    if isinstance(default, av.Instance) and not is_parameter_type(default):
        default = None
    record_mistyped(machine, owner, arguments, _declared_type(arguments, default))
    return declare_node_parameter(machine, owner, arguments.value(0), default)


def _declared_type(arguments: Arguments, default: av.Value | None) -> str:
    """Return a parameter's type; a variable of C++ that holds an int may be a double."""
    if arguments.types:
        return _type_name(arguments.types[0])
    name = type_name(default)
    return "" if "integer" in name else name


def _type_name(type: TypeRef) -> str:
    if type.name == "std::vector" and type.args and type.args[0].name in _TYPE_NAMES:
        return f"{_TYPE_NAMES[type.args[0].name]}_array"
    return _TYPE_NAMES.get(type.name, "")


def declare_parameters(machine: AbstractMachine, owner: av.Value, arguments: Arguments) -> av.Value:
    """`declare_parameters(namespace, {{name, default}, …})`."""
    found: list[av.Value] = []
    for item in av.items_of(arguments.get(1) or av.NONE)[0]:
        name, default = (*av.items_of(item)[0], av.UNKNOWN, None)[:2]
        full = prefixed_name(arguments.get(0), name or av.UNKNOWN)
        found.append(declare_node_parameter(machine, owner, full, _unwrap_parameter(default)))
    return av.list_of(found)


def get_parameter(machine: AbstractMachine, owner: av.Value, arguments: Arguments) -> av.Value:
    """`get_parameter(name)`, or `get_parameter(name, variable)`, which tells whether it is set."""
    name = arguments.value(0)
    if len(arguments.values) < 2:  # noqa: PLR2004 - a name and a variable
        return parameter_object(name, read_node_parameter(machine, owner, name))
    return _write_variable(machine, arguments, node_parameter_value(machine, owner, name))


def _write_variable(
    machine: AbstractMachine, arguments: Arguments, found: av.Value | None
) -> av.Value:
    slot, is_parameter = arguments.slot(1), isinstance(arguments.get(1), av.Instance)
    if found is None or is_unset(found):
        return av.FALSE
    if slot is not None:
        name = arguments.value(0)
        machine.undo_log.set(*slot, parameter_object(name, found) if is_parameter else found)
    return av.Unknown("get_parameter") if isinstance(found, av.Unknown) else av.TRUE


def get_parameter_or(machine: AbstractMachine, owner: av.Value, arguments: Arguments) -> av.Value:
    """`get_parameter_or(name, variable, default)`, `get_parameter_or(name, default)`."""
    default = arguments.value(len(arguments.values) - 1)
    found = node_parameter_value(machine, owner, arguments.value(0))
    value = value_or_default(found, default)
    slot = arguments.slot(1)
    if len(arguments.values) < 3:  # noqa: PLR2004 - a name, a variable and a default
        return value
    if slot is not None:
        machine.undo_log.set(*slot, value)
    return av.FALSE if found is None or is_unset(found) else av.TRUE


def get_parameters(machine: AbstractMachine, owner: av.Value, arguments: Arguments) -> av.Value:
    """`get_parameters({name, …})`, `get_parameters(prefix, map)`."""
    if isinstance(arguments.get(1), av.MapValue):
        return _fill_map(machine, owner, arguments)
    names, certain = av.items_of(arguments.get(0) or av.NONE)
    found = [(name, node_parameter_value(machine, owner, name)) for name in names]
    items = [
        parameter_object(n, av.Unknown("parameter", tainted=True) if v is None else v)
        for n, v in found
    ]
    return av.list_of(items, certain=certain)


def _fill_map(machine: AbstractMachine, owner: av.Value, arguments: Arguments) -> av.Value:
    """Put the parameters below a prefix into a map, by what stands behind it."""
    prefix, filled = arguments.value(0), arguments.get(1)
    names, certain = parameter_names(machine, owner)
    below = names_below(names, str(prefix.value)) if isinstance(prefix, av.Scalar) else {}
    if isinstance(filled, av.MapValue):
        for name, rest in below.items():
            value = node_parameter_value(machine, owner, av.Scalar(name)) or av.UNKNOWN
            machine.undo_log.set(filled.fields, rest, value)
        if not (certain and isinstance(prefix, av.Scalar)):
            machine.undo_log.set(filled.fields, av.OPEN, av.UNKNOWN)
    return av.Scalar(bool(below)) if certain else av.Unknown("get_parameters")


def has_parameter(machine: AbstractMachine, owner: av.Value, arguments: Arguments) -> av.Value:
    """`has_parameter(name)`: whether it is declared."""
    return has_node_parameter(machine, owner, arguments.value(0))


def set_parameter(machine: AbstractMachine, owner: av.Value, arguments: Arguments) -> av.Value:
    """`set_parameter(Parameter(name, value))`, `set_parameters({…})`."""
    given = arguments.get(0) or av.NONE
    for item in av.items_of(given)[0] if isinstance(given, av.ListValue) else av.options(given):
        if isinstance(item, av.Instance) and item.type is PARAMETER:
            set_node_parameter(machine, owner, item.fields["name"], item.fields["value"])
    return av.Unknown("set_parameter")


def register_callbacks(machine: AbstractMachine, owner: av.Value, arguments: Arguments) -> av.Value:
    """`register_on_configure(…)` and the like."""
    del owner
    escape_functions(machine, arguments)
    return av.Unknown("handle")


def _register_parameter_callbacks(
    machine: AbstractMachine, owner: av.Value, arguments: Arguments
) -> av.Value:
    """`add_on_set_parameters_callback(…)` and the like."""
    note_parameter_callbacks(machine, arguments)
    return register_callbacks(machine, owner, arguments)


def _make_parameter(_: AbstractMachine, arguments: Arguments) -> av.Value:
    """`rclcpp::Parameter(name, value)`."""
    return parameter_object(arguments.value(0), _unwrap_parameter(arguments.get(1)) or av.NONE)


def _make_parameter_value(_: AbstractMachine, arguments: Arguments) -> av.Value:
    """`rclcpp::ParameterValue(x)` is x."""
    return _unwrap_parameter(arguments.get(0)) or av.UNKNOWN


def _get(_: AbstractMachine, owner: av.Instance, __: Arguments) -> av.Value:
    return owner.fields["value"]


def _get_name(_: AbstractMachine, owner: av.Instance, __: Arguments) -> av.Value:
    return owner.fields["name"]


def _parameter_type(_: AbstractMachine, owner: av.Instance, __: Arguments) -> av.Value:
    return parameter_type(owner.fields["value"])


_INTEGERS = ("int", "long", "int64_t", "int32_t", "uint64_t", "size_t", "std::size_t")
_TYPE_NAMES = {
    **dict.fromkeys(_INTEGERS, "integer"),
    **dict.fromkeys(("double", "float"), "double"),
    "bool": "bool",
    "std::string": "string",
}
_AS = ("string", "int", "double", "bool")
PARAMETER = av.LibraryClass(
    "rclcpp::Parameter",
    _make_parameter,
    {
        **{f"as_{kind}": _get for kind in _AS},
        **{f"as_{kind}_array": _get for kind in (*_AS, "integer", "byte")},
        **dict.fromkeys(("get_value", "value_to_string", "get"), _get),
        "get_parameter_value": return_owner,
        "get_name": _get_name,
        "get_type": _parameter_type,
    },
)
PARAMETER_CLASSES: Mapping[str, av.LibraryClass] = {
    "rclcpp::Parameter": PARAMETER,
    "rclcpp::ParameterValue": av.LibraryClass("rclcpp::ParameterValue", _make_parameter_value),
}
PARAMETER_METHODS: Mapping[str, Callable[..., av.Value]] = {
    "declare_parameter": declare_parameter,
    "declare_parameters": declare_parameters,
    "get_parameter": get_parameter,
    "get_parameter_or": get_parameter_or,
    "get_parameters": get_parameters,
    "has_parameter": has_parameter,
    "list_parameters": list_parameters,
    **dict.fromkeys(
        ("set_parameter", "set_parameters", "set_parameters_atomically"), set_parameter
    ),
    **dict.fromkeys(PARAMETER_CALLBACKS, _register_parameter_callbacks),
}
