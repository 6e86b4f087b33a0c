"""Binding what a call passes to a function's parameters."""

from collections.abc import Callable

from rtron.sources.code.interpreter.abstract_values.items import list_of
from rtron.sources.code.interpreter.abstract_values.value_types import MapValue, Unknown, Value
from rtron.sources.code.interpreter.execution.arguments import Arguments
from rtron.sources.code.ir import Const, Expr, Function, Param


def bind_parameters(
    params: tuple[Param, ...], arguments: Arguments, default: Callable[[Expr], Value]
) -> dict[str, Value]:
    """Return the variables a call begins with; what nobody gives is a hole of its name."""
    variables: dict[str, Value] = {}
    position = 0
    for param in params:
        if param.kind == "star":
            variables[param.name] = list_of(arguments.values[position:], "tuple")
            position = len(arguments.values)
        elif param.kind == "stars":
            named = {p.name for p in params}
            rest = {k: v for k, v in arguments.keywords.items() if k not in named}
            variables[param.name] = MapValue(dict(rest))
        else:
            index = position if param.kind == "plain" else len(arguments.values)
            variables[param.name] = _parameter_value(param, index, arguments, default)
            position += param.kind == "plain"
    return variables


def evaluate_defaults(function: Function, default: Callable[[Expr], Value]) -> dict[str, Value]:
    """Return the defaults that Python evaluates where it meets the definition."""
    return {
        param.name: default(param.default)
        for param in function.params
        if param.default is not None and not isinstance(param.default, Const)
    }


def _parameter_value(
    param: Param, position: int, arguments: Arguments, default: Callable[[Expr], Value]
) -> Value:
    given = arguments.get(position, param.name)
    if given is not None:
        return given
    if param.default is not None:
        return default(param.default)
    return Unknown(param.name, type=param.type)
