"""Which of several C++ functions of one name a call means."""

from collections.abc import Mapping

from rtron.sources.code.interpreter.abstract_values.value_types import (
    ClassValue,
    FunctionValue,
    Instance,
    Scalar,
    Unknown,
    Value,
    is_text,
)
from rtron.sources.code.interpreter.execution.arguments import Arguments
from rtron.sources.code.ir import Function, Param, TypeRef

_NUMBERS = {"int", "double", "float", "bool", "long", "short", "size_t", "uint32_t", "int32_t"}
_TEXTS = {"std::string", "string", "char", "QString"}


def choose_overload(functions: tuple[Function, ...], arguments: Arguments) -> Function:
    """Return the function that fits a call best: by the number of arguments, then their types."""
    count = len(arguments.values)
    ranks = [(_accepts_count(function, count), function.body is not None) for function in functions]
    best = max(ranks)
    fitting = [function for function, rank in zip(functions, ranks, strict=True) if rank == best]
    if len(fitting) == 1:
        return fitting[0]
    return max(fitting, key=lambda function: _score(function, arguments))


def _accepts_count(function: Function, count: int) -> bool:
    """Tell whether a function can be called with so many arguments."""
    most = len(function.params)
    least = [param for param in function.params if param.default is None and param.kind == "plain"]
    return len(least) <= count and (
        count <= most or any(param.kind != "plain" for param in function.params)
    )


def _score(function: Function, arguments: Arguments) -> int:
    pairs = zip(function.params, arguments.values, strict=False)
    given = dict(zip(function.template, arguments.types, strict=False))
    return sum([_parameter_score(param, value, function, given) for param, value in pairs])


def _parameter_score(
    param: Param, value: Value, function: Function, given: Mapping[str, TypeRef]
) -> int:
    """Tell how well a value fits a parameter, whose type the call's template arguments may give."""
    if param.type is None:
        return 0
    bound = given.get(param.type.name)
    if param.type.name in function.template and bound is None:
        return 1
    found = _type_score(bound or param.type, value)
    return found or int(bound is not None)


def _unknown_type_score(type: str, value: Unknown) -> int:
    """Tell whether an unknown object fits: it is called like its class."""
    return 3 if value.label.rpartition("::")[2] == f"{type}()" else 0


def _type_score(type: TypeRef, value: Value) -> int:
    last = type.name.rpartition("::")[2]
    if isinstance(value, Unknown):
        return _unknown_type_score(last, value)
    if is_text(value):
        return 2 if type.name in _TEXTS else -_is_scalar(type)
    if isinstance(value, Scalar):
        return 1 if type.name in _NUMBERS else -1
    if isinstance(value, Instance):
        name = value.type.name.rpartition("::")[2]
        return 3 if name == last or name in str(type) else -2 * _is_scalar(type)
    if isinstance(value, (FunctionValue, ClassValue)):
        return -2 * _is_scalar(type)
    return 0


def _is_scalar(type: TypeRef) -> int:
    return int(type.name in _NUMBERS or type.name in _TEXTS)
