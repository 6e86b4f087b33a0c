"""What may throw: a handler is reached only if something that its `try` runs may.

Counted is while a `try` runs, and nothing is trusted but what is listed here: an operation whose
result is known did not throw; libraries' functions throw unless they are known not to, with these
arguments. Left out is that memory runs out, that Ctrl+C is pressed, or that a cast to a
reference fails.
"""

import re
from collections.abc import Iterable
from typing import TYPE_CHECKING

from rtron.sources.code.interpreter.abstract_values.value_types import (
    Choice,
    ExternalSymbol,
    FunctionValue,
    LibraryFunction,
    ListValue,
    MapValue,
    MessageType,
    PartialText,
    Scalar,
    Unknown,
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

if TYPE_CHECKING:
    from rtron.sources.code.interpreter.execution.abstract_machine import ThrownError

_EQUALITY = {"==", "!=", "is", "is not"}
_LOGGING = {"debug", "info", "warn", "warning", "error", "fatal", "critical"}
_MACRO = re.compile(r"(RCLCPP|ROS|RCUTILS)(_[A-Z0-9]+)+")
_PARAMETER_GETTERS: dict[str, type] = {
    "as_string": str,
    "as_int": int,
    "as_double": float,
    "as_bool": bool,
}
_ENDPOINTS = {"create_publisher", "create_subscription", "create_service", "create_client"}
_NON_THROWING = {
    *_ENDPOINTS,
    *("create_timer", "create_wall_timer", "declare_parameter", "get_parameter"),
    *("get_parameter_or", "has_parameter", "get_parameter_value", "get_name", "get_namespace"),
    *("c_str", "empty", "size", "length", "print", "str"),
}
_READ_METHODS = {"get", "get_value"}
_THROWING_NODES = (Opaque, Star, Index, Binary, Unary)
_NON_THROWING_TYPES = {
    *("std::string", "string", "int", "double", "float", "bool", "size_t", "int64_t"),
    *("rclcpp::QoS", "rclcpp::SensorDataQoS", "rclcpp::SystemDefaultsQoS", "rclcpp::Parameter"),
}


def is_fully_known(value: Value) -> bool:
    """Tell whether all that a value may be is known: to make it did not throw."""
    if isinstance(value, Choice):
        return all(map(is_fully_known, value.options))
    if isinstance(value, (ListValue, MapValue)):
        return not value.open
    return not isinstance(value, (Unknown, ExternalSymbol, PartialText))


def operands_fit(operator: str, left: Value, right: Value) -> bool:
    """Tell whether Python's operator takes two values, as far as both are known."""
    if operator in _EQUALITY or not (isinstance(left, Scalar) and isinstance(right, Scalar)):
        return True
    values = (left.value, right.value)
    return None not in values and len({isinstance(value, str) for value in values}) == 1


def expression_may_throw(node: Expr, value: Value, *, dynamic: bool) -> bool:
    """Tell whether an expression that is no call may have thrown; `dynamic` is Python's way."""
    if isinstance(node, New):
        return node.type.name not in _NON_THROWING_TYPES
    if dynamic and isinstance(node, Name):
        return isinstance(value, (Unknown, ExternalSymbol))
    kinds = (Opaque, Star, Index, Binary, Unary, Attr) if dynamic else _THROWING_NODES
    return isinstance(node, kinds) and not is_fully_known(value)


def statement_may_throw(node: Stmt, *, dynamic: bool) -> bool:
    """Tell whether a statement may throw beside its expressions."""
    if isinstance(node, Declare):
        return node.type is not None and node.type.name not in _NON_THROWING_TYPES
    if isinstance(node, Assign):
        return any(not isinstance(target, (Name, Attr)) for target in node.targets)
    return isinstance(node, (ForEach, Import)) or (dynamic and isinstance(node, Delete))


def is_logging_call(node: Call) -> bool:
    """Tell whether a call writes to a node's log: `get_logger().info(…)`, `RCLCPP_INFO(…)`."""
    function = node.function
    if isinstance(function, Name):
        return bool(_MACRO.fullmatch(function.id))
    if not isinstance(function, Attr):
        return False
    receiver_call = function.owner.function if isinstance(function.owner, Call) else None
    named = isinstance(receiver_call, Attr) and receiver_call.name == "get_logger"
    return function.name == "get_logger" or (named and function.name in _LOGGING)


def call_may_throw(called: Value, arguments: Arguments, returned: Value) -> bool:
    """Tell whether a call may have thrown, beside what the function's own body did."""
    given = arguments.all_values
    if isinstance(called, FunctionValue):
        return False
    if isinstance(called, MessageType):
        return bool(given)
    if not isinstance(called, LibraryFunction):
        return True
    name = called.name
    if name in _READ_METHODS or name in _PARAMETER_GETTERS:
        return not _is_scalar_of(returned, _PARAMETER_GETTERS.get(name))
    return name not in _NON_THROWING or not all(map(is_fully_known, given))


def _is_scalar_of(value: Value, kind: type | None) -> bool:
    return isinstance(value, Scalar) and (kind is None or type(value.value) is kind)


def is_caught(handlers: Iterable[tuple[str, ...]], thrown: "ThrownError") -> bool:
    """Tell whether one of the handlers around what runs takes an exception."""
    return any(catches(names, thrown) for names in handlers)


def catches(names: tuple[str, ...], thrown: "ThrownError") -> bool:
    """Tell whether a handler takes an exception; `Exception` does not take SystemExit."""
    if thrown.is_value:
        return True
    wide = {"BaseException", "...", ""}
    if thrown.name != "SystemExit":
        wide |= (
            {"Exception", "LookupError", "exception", "runtime_error"}
            if thrown.has_unknown_bases
            else {"Exception", "exception"}
        )
    plain = {re.split(r"::|[.]", name)[-1] for name in names}
    return not names or bool(plain & {*wide, *thrown.names})
