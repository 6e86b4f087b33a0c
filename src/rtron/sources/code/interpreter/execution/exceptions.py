"""What may throw: a handler is reached only if something that its `try` runs may.

Counted is while a `try` runs, and nothing is trusted but what is listed here: an operation whose
result is known did not throw; libraries' functions throw unless they are known not to, with these
arguments. Left out is that memory runs out, that somebody presses Ctrl+C, or that a cast to a
reference fails.
"""

import re

from rtron.sources.code.interpreter.abstract_values.value_types import (
    Choice,
    Foreign,
    FunctionValue,
    Hole,
    Known,
    ListValue,
    MapValue,
    MessageType,
    Native,
    Text,
    Value,
)
from rtron.sources.code.interpreter.execution.arguments import Arguments
from rtron.sources.code.ir import (
    Assign,
    Attr,
    Binary,
    Call,
    Declare,
    Delete,
    Expr,
    ForEach,
    Import,
    Index,
    Name,
    New,
    Opaque,
    Star,
    Stmt,
    Unary,
)

_EQUALITY = {"==", "!=", "is", "is not"}
_LOGGING = {"debug", "info", "warn", "warning", "error", "fatal", "critical"}
_MACRO = re.compile(r"(RCLCPP|ROS|RCUTILS)(_[A-Z0-9]+)+")
_KINDS: dict[str, type] = {"as_string": str, "as_int": int, "as_double": float, "as_bool": bool}
_ENDPOINTS = {"create_publisher", "create_subscription", "create_service", "create_client"}
_SURE = {
    *_ENDPOINTS,
    *("create_timer", "create_wall_timer", "declare_parameter", "get_parameter"),
    *("get_parameter_or", "has_parameter", "get_parameter_value", "get_name", "get_namespace"),
    *("c_str", "empty", "size", "length", "print", "str"),
}
_READ = {"get", "get_value"}
_OPERATIONS = (Opaque, Star, Index, Binary, Unary)
_PLAIN = {
    *("std::string", "string", "int", "double", "float", "bool", "size_t", "int64_t"),
    *("rclcpp::QoS", "rclcpp::SensorDataQoS", "rclcpp::SystemDefaultsQoS", "rclcpp::Parameter"),
}


def is_sure(value: Value) -> bool:
    """Tell whether all that a value may be is known: to make it did not throw."""
    if isinstance(value, Choice):
        return all(map(is_sure, value.options))
    if isinstance(value, (ListValue, MapValue)):
        return not value.open
    return not isinstance(value, (Hole, Foreign, Text))


def fit(operator: str, left: Value, right: Value) -> bool:
    """Tell whether Python's operator takes two values, as far as both are known."""
    if operator in _EQUALITY or not (isinstance(left, Known) and isinstance(right, Known)):
        return True
    values = (left.value, right.value)
    return None not in values and len({isinstance(value, str) for value in values}) == 1


def may_throw(node: Expr, value: Value, *, dynamic: bool) -> bool:
    """Tell whether an expression that is no call may have thrown; `dynamic` is Python's way."""
    if isinstance(node, New):
        return node.type.name not in _PLAIN
    if dynamic and isinstance(node, Name):
        return isinstance(value, (Hole, Foreign))
    kinds = (Opaque, Star, Index, Binary, Unary, Attr) if dynamic else _OPERATIONS
    return isinstance(node, kinds) and not is_sure(value)


def may_fail(node: Stmt, *, dynamic: bool) -> bool:
    """Tell whether a statement may throw beside its expressions."""
    if isinstance(node, Declare):
        return node.type is not None and node.type.name not in _PLAIN
    if isinstance(node, Assign):
        return any(not isinstance(target, (Name, Attr)) for target in node.targets)
    return isinstance(node, (ForEach, Import)) or (dynamic and isinstance(node, Delete))


def logs(node: Call) -> bool:
    """Tell whether a call writes to a node's log: `get_logger().info(…)`, `RCLCPP_INFO(…)`."""
    function = node.function
    if isinstance(function, Name):
        return bool(_MACRO.fullmatch(function.id))
    if not isinstance(function, Attr):
        return False
    asked = function.owner.function if isinstance(function.owner, Call) else None
    named = isinstance(asked, Attr) and asked.name == "get_logger"
    return function.name == "get_logger" or (named and function.name in _LOGGING)


def call_may_throw(called: Value, arguments: Arguments, returned: Value) -> bool:
    """Tell whether a call may have thrown, beside what the function's own body did."""
    given = (*arguments.values, *arguments.keywords.values())
    if isinstance(called, FunctionValue):
        return False
    if isinstance(called, MessageType):
        return bool(given)
    if not isinstance(called, Native):
        return True
    name = called.name
    if name in _READ or name in _KINDS:
        return not _is_of(returned, _KINDS.get(name))
    return name not in _SURE or not all(map(is_sure, given))


def _is_of(value: Value, kind: type | None) -> bool:
    return isinstance(value, Known) and (kind is None or type(value.value) is kind)
