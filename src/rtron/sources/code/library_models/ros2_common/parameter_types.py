"""What kind a parameter of ROS 2 is (docs.ros.org: rclcpp::ParameterType).

Since Galactic a parameter keeps the type of its default, and no value is converted: an integer for
a double throws where the node declares it (docs.ros.org: Notes on statically typed parameters).
"""

import re
from collections.abc import Mapping

from rtron.sources.code.interpreter import abstract_values as av
from rtron.sources.code.interpreter.execution.abstract_machine import AbstractMachine, ThrownError
from rtron.sources.code.interpreter.execution.arguments import Arguments
from rtron.sources.code.interpreter.execution.exceptions import is_caught
from rtron.sources.code.ir import TypeRef
from rtron.sources.code.library_models.ros2_common.nodes import node_name
from rtron.sources.code.library_models.ros2_common.parameters import (
    AUTOMATIC_FIELD,
    is_declared,
    knows_all_overrides,
    override_value,
)
from rtron.sources.declaration import MistypedParameter

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


_THROWN = ThrownError("InvalidParameterTypeException", has_unknown_bases=True)
_PERHAPS_NO_TEXT = re.compile(
    r"|[-+.~\d].*|[yn]|yes|no|on|off|true|false", re.IGNORECASE | re.DOTALL
)
"""What libraries for YAML and rcl's parser may take for a text or for a number or a bool."""


def record_mistyped(
    machine: AbstractMachine, node: av.Value, arguments: Arguments, declared: str
) -> None:
    """Record a parameter whose given value throws where `declare_parameter(name, …)` is called.

    A type that is not known on either side says nothing, nor does a call that may ignore the value
    or take any type, nor one whose exception is caught.
    """
    name = arguments.value(0, "name")
    owner = node_name(node)
    if not (declared and isinstance(name, av.Scalar) and isinstance(owner, av.Scalar)):
        return
    given = _given_type(machine, node, name)
    if (
        given in {"", declared}
        or not _is_typed(arguments)
        or is_caught(machine.active_handlers, _THROWN)
    ):
        return
    machine.recorder.add_mistyped(
        MistypedParameter(
            node=str(owner.value),
            name=str(name.value),
            declared_type=declared,
            given_type=given,
            evidence=arguments.evidence,
        )
    )


def _given_type(machine: AbstractMachine, node: av.Value, name: av.Scalar) -> str:
    """Return the type of what certainly overrides the default; empty if nothing is sure to."""
    is_automatic = (
        isinstance(node, av.Instance) and node.fields.get(AUTOMATIC_FIELD, av.FALSE) != av.FALSE
    )
    if is_automatic or is_declared(machine, node, name) or not knows_all_overrides(machine, node):
        return ""
    value = override_value(machine, node, name)
    is_text = isinstance(value, av.Scalar) and isinstance(value.value, str)
    if is_text and _PERHAPS_NO_TEXT.fullmatch(value.value):  # type: ignore[union-attr]
        return ""
    return type_name(value)


def _is_typed(arguments: Arguments) -> bool:
    """Tell whether a declaration has no descriptor that may ask for any type, and no flags."""
    return len(arguments.values) <= 2 and not arguments.keywords.keys() - {"name", "value"}  # noqa: PLR2004 - a name and a default
