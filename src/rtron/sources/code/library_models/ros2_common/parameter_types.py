"""What kind a parameter of ROS 2 is (docs.ros.org: rclcpp::ParameterType)."""

from collections.abc import Mapping

from rtron.sources.code.interpreter.abstract_values.value_types import (
    Foreign,
    Hole,
    Instance,
    Known,
    ListValue,
    NativeClass,
    Value,
)
from rtron.sources.code.interpreter.execution.abstract_machine import Machine
from rtron.sources.code.interpreter.execution.arguments import Arguments
from rtron.sources.code.ir import TypeRef

_KIND = NativeClass("rclcpp::ParameterType")
_UNSET = TypeRef("rclcpp::ParameterType::PARAMETER_NOT_SET")
_PLAIN: Mapping[type, str] = {
    bool: "BOOL",
    int: "INTEGER",
    float: "DOUBLE",
    str: "STRING",
}
_ARRAYS = ("BYTE_ARRAY", "BOOL_ARRAY", "INTEGER_ARRAY", "DOUBLE_ARRAY", "STRING_ARRAY")
_KINDS = {name: Instance(_KIND) for name in ("NOT_SET", *_PLAIN.values(), *_ARRAYS)}
_SPACES = ("rclcpp::", "rclcpp::ParameterType::", "rcl_interfaces::msg::ParameterType::")
KIND_CONSTANTS: Mapping[str, Value] = {
    f"{space}PARAMETER_{name}": kind for space in _SPACES for name, kind in _KINDS.items()
}


def parameter_kind(_: Machine, owner: Value, __: Arguments) -> Value:
    """`ParameterValue::get_type()`; what a ParameterValue holds stands for it."""
    return kind_of(owner)


def kind_of(value: Value) -> Value:
    """Return the kind of a parameter's value."""
    if is_unset(value):
        return _KINDS["NOT_SET"]
    if isinstance(value, Known):
        name = _PLAIN.get(type(value.value))
    else:
        items = value.items if isinstance(value, ListValue) else ()
        first = items[0] if items else None
        name = f"{_PLAIN.get(type(first.value))}_ARRAY" if isinstance(first, Known) else None
    return _KINDS[name] if name in _KINDS else Hole("get_type")


def python_kind(value: Value | None) -> Value | None:
    """Return the kind that `Parameter.Type.STRING` names in rclpy; None for any other value."""
    name = value.why if isinstance(value, Hole) else getattr(value, "name", "")
    return _KINDS.get(str(name).rpartition(".")[2]) if isinstance(value, (Hole, Foreign)) else None


def unset(name: str) -> Hole:
    """Return what a parameter holds that is declared by its type alone, and that nobody sets."""
    return Hole(name, tainted=True, type=_UNSET)


def is_unset(value: Value | None) -> bool:
    """Tell whether a parameter is declared and certainly not set."""
    return isinstance(value, Hole) and value.type is _UNSET


def is_kind(value: Value) -> bool:
    """Tell whether what a parameter is declared with is a type: `rclcpp::PARAMETER_STRING`."""
    if isinstance(value, Instance):
        return value.type is _KIND
    name = value.name if isinstance(value, Foreign) else ""
    name = value.why if isinstance(value, Hole) else name
    return "PARAMETER_" in name or "Parameter.Type" in name or "get_type" in name
