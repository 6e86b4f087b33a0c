"""Which of several C++ functions of one name a call means."""

from collections.abc import Mapping

from rtron.sources.code import ir
from rtron.sources.code.interpreter import abstract_values as av
from rtron.sources.code.interpreter.execution.arguments import Arguments

_NUMBERS = {"int", "double", "float", "bool", "long", "short", "size_t", "uint32_t", "int32_t"}
_FLOATS = {"double", "float"}
_TEXTS = {"std::string", "string", "char", "QString"}
_LISTS = {"initializer_list", "vector", "list", "deque", "set", "array", "map", "unordered_map"}
_LIST_SCORE = 3


def choose_overload(functions: tuple[ir.Function, ...], arguments: Arguments) -> ir.Function:
    """Return the function that fits a call best: by the number of arguments, then their types.

    `template <> void f<int>()` fits a call of `f<int>`, and no other.
    """
    if any(function.specialised for function in functions):
        functions = _of_types(functions, arguments) or functions
    count = len(arguments.values)
    ranks = [(_accepts_count(function, count), function.body is not None) for function in functions]
    best = max(ranks)
    fitting = [function for function, rank in zip(functions, ranks, strict=True) if rank == best]
    if len(fitting) == 1:
        return fitting[0]
    return max(fitting, key=lambda function: _score(function, arguments))


def hides(inner: tuple[ir.Function, ...], outer: tuple[ir.Function, ...]) -> bool:
    """Tell whether methods of a class only hide those of its base, which its base's code calls.

    A method overrides one of the same parameters; no other is visible in the base.
    """
    has_body = any(function.body is not None for function in outer)
    return has_body and set(map(_type_names, inner)).isdisjoint(map(_type_names, outer))


def _type_names(function: ir.Function) -> tuple[str, ...]:
    types = (param.type for param in function.params)
    return tuple(type.name.rpartition("::")[2] if type else "" for type in types)


def _of_types(functions: tuple[ir.Function, ...], arguments: Arguments) -> tuple[ir.Function, ...]:
    """Return the functions that are specialised for a call's types, else those for any."""
    fitting = [f for f in functions if f.specialised == arguments.types[: len(f.specialised)]]
    special = [function for function in fitting if function.specialised]
    return tuple(special or fitting)


def _accepts_count(function: ir.Function, count: int) -> bool:
    """Tell whether a function can be called with so many arguments."""
    most = len(function.params)
    least = [param for param in function.params if param.default is None and param.kind == "plain"]
    return len(least) <= count and (
        count <= most or any(param.kind != "plain" for param in function.params)
    )


def _score(function: ir.Function, arguments: Arguments) -> int:
    pairs = zip(function.params, arguments.values, strict=False)
    given = dict(zip(function.template, arguments.types, strict=False))
    return sum([_parameter_score(param, value, function, given) for param, value in pairs])


def _parameter_score(
    param: ir.Param, value: av.Value, function: ir.Function, given: Mapping[str, ir.TypeRef]
) -> int:
    """Tell how well a value fits a parameter, whose type the call's template arguments may give."""
    if param.type is None:
        return 0
    bound = given.get(param.type.name)
    if param.type.name in function.template and bound is None:
        return 1
    found = _type_score(bound or param.type, value)
    return found or int(bound is not None)


def _unknown_type_score(type: str, value: av.Unknown) -> int:
    """Tell whether an unknown object fits: it is called like its class."""
    return 3 if value.label.rpartition("::")[2] == f"{type}()" else 0


def _number_score(type: str, value: av.Scalar) -> int:
    """Tell how well a number fits: best where nothing of it is converted."""
    if isinstance(value.value, bool) or type == "bool":
        return 1 + (isinstance(value.value, bool) and type == "bool") if type in _NUMBERS else -1
    is_float = isinstance(value.value, float)
    return 1 + (is_float == (type in _FLOATS)) if type in _NUMBERS else -1


def _type_score(type: ir.TypeRef, value: av.Value) -> int:
    last = type.name.rpartition("::")[2]
    if isinstance(value, av.Unknown):
        return _unknown_type_score(last, value)
    if av.is_text(value):
        return 2 if type.name in _TEXTS else -_is_scalar(type)
    if isinstance(value, av.Scalar):
        return _number_score(last, value)
    if isinstance(value, av.Instance):
        name = value.type.name.rpartition("::")[2]
        return 3 if name == last or name in str(type) else -2 * _is_scalar(type)
    if isinstance(value, (av.ListValue, av.MapValue)) and last in _LISTS:
        return _LIST_SCORE
    is_object = isinstance(value, (av.FunctionValue, av.ClassValue, av.ListValue, av.MapValue))
    return -2 * _is_scalar(type) * is_object


def _is_scalar(type: ir.TypeRef) -> int:
    return int(type.name in _NUMBERS or type.name in _TEXTS)
