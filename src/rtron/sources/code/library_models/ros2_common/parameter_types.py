"""What kind a parameter of ROS 2 is (docs.ros.org: rclcpp::ParameterType)."""

from collections.abc import Mapping

from rtron.sources.code.interpreter import abstract_values as av
from rtron.sources.code.interpreter.execution.abstract_machine import AbstractMachine
from rtron.sources.code.interpreter.execution.arguments import Arguments
from rtron.sources.code.ir import TypeRef

_PARAMETER_TYPE = av.LibraryClass("rclcpp::ParameterType")
_UNSET = TypeRef("rclcpp::ParameterType::PARAMETER_NOT_SET")
_SCALAR_TYPES: Mapping[type, str] = {bool: "BOOL", int: "INTEGER", float: "DOUBLE", str: "STRING"}
_ARRAY_TYPES = ("BYTE_ARRAY", "BOOL_ARRAY", "INTEGER_ARRAY", "DOUBLE_ARRAY", "STRING_ARRAY")
_PARAMETER_TYPES = {
    name: av.Instance(_PARAMETER_TYPE)
    for name in ("NOT_SET", *_SCALAR_TYPES.values(), *_ARRAY_TYPES)
}
_NAMESPACES = ("rclcpp::", "rclcpp::ParameterType::", "rcl_interfaces::msg::ParameterType::")
PARAMETER_TYPE_CONSTANTS: Mapping[str, av.Value] = {
    f"{space}PARAMETER_{name}": kind
    for space in _NAMESPACES
    for name, kind in _PARAMETER_TYPES.items()
}


def get_type(_: AbstractMachine, owner: av.Value, __: Arguments) -> av.Value:
    """`ParameterValue::get_type()`; what a ParameterValue holds stands for it."""
    return parameter_type(owner)


def parameter_type(value: av.Value) -> av.Value:
    """Return the kind of a parameter's value."""
    if is_unset(value):
        return _PARAMETER_TYPES["NOT_SET"]
    if isinstance(value, av.Scalar):
        name = _SCALAR_TYPES.get(type(value.value))
    else:
        items = value.items if isinstance(value, av.ListValue) else ()
        first = items[0] if items else None
        kind = _SCALAR_TYPES.get(type(first.value)) if isinstance(first, av.Scalar) else None
        name = f"{kind}_ARRAY"
    return _PARAMETER_TYPES[name] if name in _PARAMETER_TYPES else av.Unknown("get_type")


def type_name(value: av.Value | None) -> str:
    """Return what ROS 2 calls the type of a value, or one that is named; empty if not known."""
    if isinstance(value, av.ListValue) and len({_scalar_type(item) for item in value.items}) > 1:
        return ""
    kind = value if value is None or is_parameter_type(value) else parameter_type(value)
    names = (name for name, each in _PARAMETER_TYPES.items() if each is kind and name != "NOT_SET")
    return next(names, "").lower()


def _scalar_type(value: av.Value) -> type | None:
    return type(value.value) if isinstance(value, av.Scalar) else None


def python_parameter_type(value: av.Value | None) -> av.Value | None:
    """Return the kind that `Parameter.Type.STRING` names in rclpy; None for any other value."""
    if not isinstance(value, (av.Unknown, av.ExternalSymbol)):
        return None
    name = value.label if isinstance(value, av.Unknown) else value.name
    return _PARAMETER_TYPES.get(name.rpartition(".")[2])


def unset_value(name: str) -> av.Unknown:
    """Return what a parameter holds that is declared by its type alone, and that is not set."""
    return av.Unknown(name, tainted=True, type=_UNSET)


def is_unset(value: av.Value | None) -> bool:
    """Tell whether a parameter is declared and certainly not set."""
    return isinstance(value, av.Unknown) and value.type is _UNSET


def is_parameter_type(value: av.Value) -> bool:
    """Tell whether what a parameter is declared with is a type: `rclcpp::PARAMETER_STRING`."""
    if isinstance(value, av.Instance):
        return value.type is _PARAMETER_TYPE
    name = value.name if isinstance(value, av.ExternalSymbol) else ""
    name = value.label if isinstance(value, av.Unknown) else name
    return "PARAMETER_" in name or "Parameter.Type" in name or "get_type" in name
