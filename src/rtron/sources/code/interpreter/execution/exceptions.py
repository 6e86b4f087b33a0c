"""What may throw: a handler is reached only if something that its `try` runs may.

Counted is while a `try` runs, and nothing is trusted but what is listed here: an operation whose
result is known did not throw; libraries' functions throw unless they are known not to, with these
arguments. Left out is that memory runs out, that Ctrl+C is pressed, or that a cast to a
reference fails.
"""

import re
from collections.abc import Iterable
from typing import TYPE_CHECKING

from rtron.sources.code import ir
from rtron.sources.code.interpreter import abstract_values as av
from rtron.sources.code.interpreter.execution.arguments import Arguments

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
_THROWING_NODES = (ir.Opaque, ir.Star, ir.Index, ir.Binary, ir.Unary)
_NON_THROWING_TYPES = {
    *("std::string", "string", "int", "double", "float", "bool", "size_t", "int64_t"),
    *("rclcpp::QoS", "rclcpp::SensorDataQoS", "rclcpp::SystemDefaultsQoS", "rclcpp::Parameter"),
}


def is_fully_known(value: av.Value) -> bool:
    """Tell whether all that a value may be is known: to make it did not throw."""
    if isinstance(value, av.Choice):
        return all(map(is_fully_known, value.options))
    if isinstance(value, (av.ListValue, av.MapValue)):
        return not value.open
    return not isinstance(value, (av.Unknown, av.ExternalSymbol, av.PartialText))


def operands_fit(operator: str, left: av.Value, right: av.Value) -> bool:
    """Tell whether Python's operator takes two values, as far as both are known."""
    if operator in _EQUALITY or not (isinstance(left, av.Scalar) and isinstance(right, av.Scalar)):
        return True
    values = (left.value, right.value)
    return None not in values and len({isinstance(value, str) for value in values}) == 1


def expression_may_throw(node: ir.Expr, value: av.Value, *, dynamic: bool) -> bool:
    """Tell whether an expression that is no call may have thrown; `dynamic` is Python's way."""
    if isinstance(node, ir.New):
        return node.type.name not in _NON_THROWING_TYPES
    if dynamic and isinstance(node, ir.Name):
        return isinstance(value, (av.Unknown, av.ExternalSymbol))
    kinds = (
        (ir.Opaque, ir.Star, ir.Index, ir.Binary, ir.Unary, ir.Attr) if dynamic else _THROWING_NODES
    )
    return isinstance(node, kinds) and not is_fully_known(value)


def statement_may_throw(node: ir.Stmt, *, dynamic: bool) -> bool:
    """Tell whether a statement may throw beside its expressions."""
    if isinstance(node, ir.Declare):
        return node.type is not None and node.type.name not in _NON_THROWING_TYPES
    if isinstance(node, ir.Assign):
        return any(not isinstance(target, (ir.Name, ir.Attr)) for target in node.targets)
    return isinstance(node, (ir.ForEach, ir.Import)) or (dynamic and isinstance(node, ir.Delete))


def is_logging_call(node: ir.Call) -> bool:
    """Tell whether a call writes to a node's log: `get_logger().info(…)`, `RCLCPP_INFO(…)`."""
    function = node.function
    if isinstance(function, ir.Name):
        return bool(_MACRO.fullmatch(function.id))
    if not isinstance(function, ir.Attr):
        return False
    receiver_call = function.owner.function if isinstance(function.owner, ir.Call) else None
    named = isinstance(receiver_call, ir.Attr) and receiver_call.name == "get_logger"
    return function.name == "get_logger" or (named and function.name in _LOGGING)


def call_may_throw(called: av.Value, arguments: Arguments, returned: av.Value) -> bool:
    """Tell whether a call may have thrown, beside what the function's own body did."""
    given = arguments.all_values
    if isinstance(called, av.FunctionValue):
        return False
    if isinstance(called, av.MessageType):
        return bool(given)
    if not isinstance(called, av.LibraryFunction):
        return True
    name = called.name
    if name in _READ_METHODS or name in _PARAMETER_GETTERS:
        return not _is_scalar_of(returned, _PARAMETER_GETTERS.get(name))
    return name not in _NON_THROWING or not all(map(is_fully_known, given))


def _is_scalar_of(value: av.Value, kind: type | None) -> bool:
    return isinstance(value, av.Scalar) and (kind is None or type(value.value) is kind)


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
