"""Parameters as rclcpp's nodes declare and read them (docs.ros.org: rclcpp::Node)."""

from collections.abc import Callable, Mapping

from rtron.sources.code.interpreter import abstract_values as av
from rtron.sources.code.interpreter.execution.abstract_machine import AbstractMachine
from rtron.sources.code.interpreter.execution.arguments import Arguments
from rtron.sources.code.ir import TypeRef
from rtron.sources.code.library_models.common.cpp_arguments import escape_functions
from rtron.sources.code.library_models.common.trivial_functions import return_owner, returning_field
from rtron.sources.code.library_models.ros2_common import parameter_types, parameters
from rtron.sources.code.library_models.ros2_common.mistyped_parameters import record_mistyped


def parameter_object(name: av.Value, value: av.Value) -> av.Instance:
    """Return an rclcpp::Parameter."""
    return av.Instance(PARAMETER, {"name": name, "value": value})


def declare_parameter(machine: AbstractMachine, owner: av.Value, arguments: Arguments) -> av.Value:
    """`declare_parameter<T>(name[, default])`, `declare_parameter(name, type)`."""
    default = parameters.unwrap_parameter(arguments.get(1))
    if isinstance(default, av.Instance) and not parameter_types.is_parameter_type(default):
        default = None
    record_mistyped(machine, owner, arguments, _declared_type(arguments, default))
    return parameters.declare_node_parameter(machine, owner, arguments.value(0), default)


def _declared_type(arguments: Arguments, default: av.Value | None) -> str:
    """Return a parameter's type; a variable of C++ that holds an int may be a double."""
    if arguments.types:
        return _type_name(arguments.types[0])
    name = parameter_types.type_name(default)
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
        full = parameters.prefixed_name(arguments.get(0), name or av.UNKNOWN)
        found.append(
            parameters.declare_node_parameter(
                machine, owner, full, parameters.unwrap_parameter(default)
            )
        )
    return av.list_of(found)


def get_parameter(machine: AbstractMachine, owner: av.Value, arguments: Arguments) -> av.Value:
    """`get_parameter(name)`, or `get_parameter(name, variable)`, which tells whether it is set."""
    name = arguments.value(0)
    if len(arguments.values) < 2:  # noqa: PLR2004 - a name and a variable
        return parameter_object(name, parameters.read_node_parameter(machine, owner, name))
    return _write(machine, arguments, parameters.node_parameter_value(machine, owner, name))


def _write(machine: AbstractMachine, arguments: Arguments, found: av.Value | None) -> av.Value:
    slot, is_parameter = arguments.slot(1), isinstance(arguments.get(1), av.Instance)
    if found is None or parameter_types.is_unset(found):
        return av.FALSE
    if slot is not None:
        name = arguments.value(0)
        machine.undo_log.set(*slot, parameter_object(name, found) if is_parameter else found)
    return av.Unknown("get_parameter") if isinstance(found, av.Unknown) else av.TRUE


def get_parameter_or(machine: AbstractMachine, owner: av.Value, arguments: Arguments) -> av.Value:
    """`get_parameter_or(name, variable, default)`, `get_parameter_or(name, default)`."""
    default = arguments.value(len(arguments.values) - 1)
    found = parameters.node_parameter_value(machine, owner, arguments.value(0))
    value = parameters.value_or_default(found, default)
    slot = arguments.slot(1)
    if len(arguments.values) < 3:  # noqa: PLR2004 - a name, a variable and a default
        return value
    if slot is not None:
        machine.undo_log.set(*slot, value)
    return av.FALSE if found is None or parameter_types.is_unset(found) else av.TRUE


def get_parameters(machine: AbstractMachine, owner: av.Value, arguments: Arguments) -> av.Value:
    """`get_parameters({name, …})`."""
    names, certain = av.items_of(arguments.get(0) or av.NONE)
    found = [(name, parameters.node_parameter_value(machine, owner, name)) for name in names]
    items = [
        parameter_object(n, av.Unknown("parameter", tainted=True) if v is None else v)
        for n, v in found
    ]
    return av.list_of(items, certain=certain)


def register_callbacks(machine: AbstractMachine, owner: av.Value, arguments: Arguments) -> av.Value:
    """`register_on_configure(…)` and the like."""
    del owner
    escape_functions(machine, arguments)
    return av.Unknown("handle")


def _register_parameter_callbacks(
    machine: AbstractMachine, owner: av.Value, arguments: Arguments
) -> av.Value:
    """`add_on_set_parameters_callback(…)` and the like."""
    parameters.note_parameter_callbacks(machine, arguments)
    return register_callbacks(machine, owner, arguments)


def _make_parameter(_: AbstractMachine, arguments: Arguments) -> av.Value:
    """`rclcpp::Parameter(name, value)`."""
    return parameter_object(
        arguments.value(0), parameters.unwrap_parameter(arguments.get(1)) or av.NONE
    )


def _make_parameter_value(_: AbstractMachine, arguments: Arguments) -> av.Value:
    """`rclcpp::ParameterValue(x)` is x."""
    return parameters.unwrap_parameter(arguments.get(0)) or av.UNKNOWN


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
        **{f"as_{kind}": returning_field("value") for kind in _AS},
        **{f"as_{kind}_array": returning_field("value") for kind in (*_AS, "integer", "byte")},
        **dict.fromkeys(("get_value", "value_to_string", "get"), returning_field("value")),
        "get_parameter_value": return_owner,
        "get_name": returning_field("name"),
        "get_type": lambda _, owner, ___: parameter_types.parameter_type(owner.fields["value"]),
    },
)
PARAMETER_CLASSES: Mapping[str, av.LibraryClass] = {
    "rclcpp::Parameter": PARAMETER,
    "rclcpp::ParameterValue": av.LibraryClass("rclcpp::ParameterValue", _make_parameter_value),
}
PARAMETER_METHODS: Mapping[str, Callable[..., av.Value]] = {
    **parameters.PARAMETER_METHODS,
    "declare_parameter": declare_parameter,
    "declare_parameters": declare_parameters,
    "get_parameter": get_parameter,
    "get_parameter_or": get_parameter_or,
    "get_parameters": get_parameters,
    **dict.fromkeys(parameters.PARAMETER_CALLBACKS, _register_parameter_callbacks),
}
