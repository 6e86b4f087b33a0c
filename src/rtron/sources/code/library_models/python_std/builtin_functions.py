"""Python's built-in functions, as far as names of topics depend on them."""

from collections.abc import Callable, Mapping
from functools import partial
from typing import Any

from rtron.sources.code.interpreter.abstract_values.elements import SLICE
from rtron.sources.code.interpreter.abstract_values.items import items_of, list_of
from rtron.sources.code.interpreter.abstract_values.operators import binary
from rtron.sources.code.interpreter.abstract_values.value_types import (
    FALSE,
    NONE,
    OPEN,
    TRUE,
    UNKNOWN,
    ClassValue,
    ExternalSymbol,
    Instance,
    LibraryClass,
    LibraryFunction,
    ListValue,
    MapValue,
    Scalar,
    Unknown,
    Value,
    concat,
    is_tainted,
    join,
    map_options,
    text_with_holes,
    truth,
)
from rtron.sources.code.interpreter.execution.abstract_machine import AbstractMachine
from rtron.sources.code.interpreter.execution.arguments import Arguments
from rtron.sources.code.interpreter.execution.calls import dispatch
from rtron.sources.code.interpreter.python.method_resolution_order import super_object
from rtron.sources.code.ir import Class
from rtron.sources.code.library_models.common.sorting import sort_items
from rtron.sources.code.library_models.python_std.dynamic_code import (
    DYNAMIC_CODE_BUILTINS,
    get_member,
)

MAX_RANGE = 256


def _str(_: AbstractMachine, __: object, arguments: Arguments) -> Value:
    return concat((arguments.get(0) or Scalar(""),))


def _number(
    make: Callable[[Any], object], _: AbstractMachine, __: object, arguments: Arguments
) -> Value:
    def made(value: Value) -> Value:
        if not isinstance(value, Scalar):
            return value
        try:
            return Scalar(make(value.value), value.tainted)
        except (TypeError, ValueError, OverflowError):
            return Unknown("number")

    return map_options(arguments.get(0) or Scalar(0), made)


def _bool(_: AbstractMachine, __: object, arguments: Arguments) -> Value:
    value = arguments.get(0) or FALSE
    decided = truth(value)
    return Unknown("bool") if decided is None else Scalar(decided, is_tainted(value))


def _len(_: AbstractMachine, __: object, arguments: Arguments) -> Value:
    items, certain = items_of(arguments.value(0))
    return Scalar(len(items)) if certain else Unknown("len")


def _range(_: AbstractMachine, __: object, arguments: Arguments) -> Value:
    numbers = [
        v.value for v in arguments.values if isinstance(v, Scalar) and isinstance(v.value, int)
    ]
    if len(numbers) != len(arguments.values) or not 1 <= len(numbers) <= 3:  # noqa: PLR2004
        return Unknown("range")
    try:
        found = range(*numbers)
    except ValueError:
        return Unknown("range")
    return list_of(map(Scalar, found[:MAX_RANGE]), certain=len(found) <= MAX_RANGE)


def _open(_: AbstractMachine, __: object, arguments: Arguments) -> Value:
    return Instance(FILE, {"path": arguments.get(0, "file") or Unknown("path")})


def _slice(_: AbstractMachine, __: object, arguments: Arguments) -> Value:
    values = arguments.values if len(arguments.values) > 1 else (NONE, *arguments.values)
    return Instance(
        SLICE, dict(zip(("start", "stop", "step"), (*values, NONE, NONE), strict=False))
    )


def _enumerate(_: AbstractMachine, __: object, arguments: Arguments) -> Value:
    items, certain = items_of(arguments.value(0))
    start = arguments.get(1, "start")
    first = start.value if isinstance(start, Scalar) and isinstance(start.value, int) else 0
    pairs = tuple(list_of((Scalar(first + at), item), "tuple") for at, item in enumerate(items))
    return list_of(pairs, certain=certain)


def _zip(_: AbstractMachine, __: object, arguments: Arguments) -> Value:
    found = [items_of(value) for value in arguments.values]
    rows = zip(*(items for items, _ in found), strict=False)
    pairs = tuple(list_of(row, "tuple") for row in rows)
    return list_of(pairs, certain=all(certain for _, certain in found))


def _copy(kind: str, _: AbstractMachine, __: object, arguments: Arguments) -> Value:
    items, certain = items_of(arguments.get(0) or list_of(()))
    return list_of(items, kind, certain=certain)


def _call_on_items(
    machine: AbstractMachine, function: Value | None, given: Value, at: Arguments
) -> list[Value]:
    """Call a function, if there is one, on each item of what is given."""
    if function is None or function == NONE:
        return []
    items, certain = items_of(given)
    if not certain:
        machine.escape(function)
    return [dispatch(machine, function, at.with_values(item)) for item in items]


def _sorted(machine: AbstractMachine, _: object, arguments: Arguments) -> Value:
    items, certain = items_of(arguments.value(0))
    if not certain:
        machine.escape(arguments.keywords.get("key"))
    return list_of(sort_items(machine, items, arguments), certain=certain)


def _dict(_: AbstractMachine, __: object, arguments: Arguments) -> Value:
    given = arguments.get(0)
    made = MapValue(dict(given.fields) if isinstance(given, MapValue) else {})
    for item in items_of(given)[0] if isinstance(given, ListValue) else ():
        key, value = (*items_of(item)[0], UNKNOWN, UNKNOWN)[:2]
        made.fields[key.value if isinstance(key, Scalar) else OPEN] = value
    made.fields.update(arguments.keywords)
    return made


def _map(machine: AbstractMachine, _: object, arguments: Arguments) -> Value:
    function, values = arguments.value(0), arguments.value(1)
    found = _call_on_items(machine, function, values, arguments)
    return list_of(found, certain=items_of(values)[1])


def _filter(machine: AbstractMachine, _: object, arguments: Arguments) -> Value:
    items, _certain = items_of(arguments.value(1))
    _call_on_items(machine, arguments.get(0), arguments.get(1) or NONE, arguments)
    return list_of(items, certain=False)


def _isinstance(machine: AbstractMachine, _: object, arguments: Arguments) -> Value:
    value, expected_class = arguments.get(0), arguments.get(1)
    if isinstance(value, Instance) and isinstance(expected_class, ClassValue):
        return Scalar(any(cls is expected_class for cls in machine.runtime.lineage(value.type)))
    kinds = {"list": "list", "tuple": "tuple", "set": "set"}
    if isinstance(value, ListValue) and isinstance(expected_class, LibraryFunction):
        return Scalar(kinds.get(expected_class.name) == value.kind)
    if isinstance(value, MapValue) and isinstance(expected_class, LibraryFunction):
        return Scalar(expected_class.name == "dict")
    if isinstance(value, Scalar) and isinstance(expected_class, LibraryFunction):
        names = {"unicode": "str", "basestring": "str", "long": "int"}
        return Scalar(
            type(value.value).__name__ == names.get(expected_class.name, expected_class.name)
        )
    return Unknown("isinstance")


def _getattr(machine: AbstractMachine, _: object, arguments: Arguments) -> Value:
    owner, name = arguments.value(0), arguments.get(1)
    if not isinstance(name, Scalar):
        return get_member(machine, owner, name or NONE, arguments)
    found = machine.runtime.attribute(owner, str(name.value), ())
    return found or arguments.get(2) or Unknown(str(name.value))


def _setattr(machine: AbstractMachine, _: object, arguments: Arguments) -> Value:
    owner, name = arguments.get(0), arguments.get(1)
    if isinstance(owner, (Instance, ClassValue)) and isinstance(name, Scalar):
        machine.undo_log.set(owner.fields, str(name.value), arguments.get(2) or NONE)
    return NONE


def _hasattr(machine: AbstractMachine, _: object, arguments: Arguments) -> Value:
    owner, name = arguments.get(0), arguments.get(1)
    if isinstance(owner, (Instance, ClassValue)) and isinstance(name, Scalar):
        return Scalar(machine.runtime.attribute(owner, str(name.value), ()) is not None)
    return Unknown("hasattr")


def _super(machine: AbstractMachine, _: object, arguments: Arguments) -> Value:
    """`super()`, `super(Class, self)`: the object, as the classes behind see it."""
    cls, owner = arguments.get(0), arguments.get(1)
    frame = arguments.frame
    if owner is None and frame.function is not None and frame.function.params:
        owner, cls = frame.variables.get(frame.function.params[0].name), frame.cls
    if not isinstance(owner, (Instance, ClassValue)) or not isinstance(cls, ClassValue):
        return Unknown("super")
    order = tuple(machine.runtime.lineage(owner.type if isinstance(owner, Instance) else owner))
    return super_object(owner, cls, order if cls in order else tuple(machine.runtime.lineage(cls)))


def _sum(_: AbstractMachine, __: object, arguments: Arguments) -> Value:
    items, certain = items_of(arguments.value(0))
    total: Value = Scalar(0)
    for item in items:
        total = binary("+", total, item)
    return total if certain else Unknown("sum")


def _min_or_max(
    pick: Callable[..., object], machine: AbstractMachine, _: object, arguments: Arguments
) -> Value:
    values = (
        arguments.values if len(arguments.values) > 1 else items_of(arguments.get(0) or NONE)[0]
    )
    _call_on_items(machine, arguments.keywords.get("key"), list_of(values), arguments)
    known = [value.value for value in values if isinstance(value, Scalar)]
    if not known or len(known) != len(values):
        return Unknown("extreme")
    try:
        return Scalar(pick(known))
    except TypeError:
        return Unknown("extreme")


def _any_or_all(_: AbstractMachine, __: object, arguments: Arguments, *, deciding: bool) -> Value:
    items, certain = items_of(arguments.value(0))
    answers = [truth(item) for item in items]
    if deciding in answers:
        return Scalar(deciding)
    return Scalar(not deciding) if certain and None not in answers else Unknown("any")


def _type(_: AbstractMachine, __: object, arguments: Arguments) -> Value:
    """`type(value)`, or `type("Name", bases, members)`, which makes a class."""
    value, members = arguments.get(0), arguments.get(2)
    if isinstance(members, MapValue):
        name = text_with_holes(value or UNKNOWN)
        definition = Class(name=name, file=arguments.frame.file, line=arguments.line)
        bases = items_of(arguments.get(1) or NONE)[0]
        return ClassValue(definition, bases, members.entries)
    return value.type if isinstance(value, Instance) else Unknown("type")


def _return_unknown(name: str, machine: AbstractMachine, _: object, arguments: Arguments) -> Value:
    machine.escape_arguments(arguments)
    return Unknown(name)


_BUILTIN_FUNCTIONS: Mapping[str, Callable[..., Value]] = {
    "str": _str,
    "unicode": _str,
    "repr": _str,
    "int": partial(_number, int),
    "long": partial(_number, int),
    "float": partial(_number, float),
    "abs": partial(_number, abs),
    "round": partial(_number, round),
    "bool": _bool,
    "len": _len,
    "range": _range,
    "xrange": _range,
    "open": _open,
    "slice": _slice,
    "enumerate": _enumerate,
    "zip": _zip,
    "list": partial(_copy, "list"),
    "tuple": partial(_copy, "tuple"),
    "set": partial(_copy, "set"),
    "frozenset": partial(_copy, "set"),
    "reversed": lambda machine, _, a: list_of(items_of(a.get(0) or NONE)[0][::-1]),
    "iter": partial(_copy, "list"),
    "next": lambda machine, _, a: join(items_of(a.get(0) or NONE)[0] or (Unknown("next"),)),
    "sorted": _sorted,
    "dict": _dict,
    "map": _map,
    "filter": _filter,
    "isinstance": _isinstance,
    "getattr": _getattr,
    "setattr": _setattr,
    "hasattr": _hasattr,
    "super": _super,
    "sum": _sum,
    "min": partial(_min_or_max, min),
    "max": partial(_min_or_max, max),
    "any": partial(_any_or_all, deciding=True),
    "all": partial(_any_or_all, deciding=False),
    "type": _type,
    **{name: partial(_return_unknown, name) for name in ("input", "raw_input", "id", "print")},
}
FILE = LibraryClass("file")
BUILTINS: Mapping[str, Value] = {
    "True": TRUE,
    "False": FALSE,
    "None": NONE,
    "basestring": LibraryFunction("str", _str),
    **{
        name: ExternalSymbol(name) for name in ("object", "property", "staticmethod", "classmethod")
    },
    **{name: LibraryFunction(name, call) for name, call in _BUILTIN_FUNCTIONS.items()},
    **DYNAMIC_CODE_BUILTINS,
}
