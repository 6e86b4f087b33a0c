"""Python's built-in functions, as far as names of topics depend on them."""

from collections.abc import Callable, Mapping
from functools import partial
from typing import Any

from rtron.sources.code.interpreter.abstract_values.elements import SLICE
from rtron.sources.code.interpreter.abstract_values.items import items_of, listed
from rtron.sources.code.interpreter.abstract_values.operators import binary
from rtron.sources.code.interpreter.abstract_values.value_types import (
    FALSE,
    NONE,
    OPEN,
    TRUE,
    ClassValue,
    Foreign,
    Hole,
    Instance,
    Known,
    ListValue,
    MapValue,
    Native,
    NativeClass,
    Value,
    concat,
    each,
    is_tainted,
    join,
    spelled,
    truth,
)
from rtron.sources.code.interpreter.execution.abstract_machine import Machine
from rtron.sources.code.interpreter.execution.arguments import Arguments
from rtron.sources.code.interpreter.execution.calls import dispatch
from rtron.sources.code.interpreter.python.method_resolution_order import seen_behind
from rtron.sources.code.ir import Class
from rtron.sources.code.library_models.common.sorting import in_order
from rtron.sources.code.library_models.python_std.dynamic_code import HIDDEN_BUILTINS, member

MAX_RANGE = 256


def _str(_: Machine, __: object, arguments: Arguments) -> Value:
    return concat((arguments.get(0) or Known(""),))


def _number(make: Callable[[Any], object], _: Machine, __: object, arguments: Arguments) -> Value:
    def made(value: Value) -> Value:
        if not isinstance(value, Known):
            return value
        try:
            return Known(make(value.value), value.tainted)
        except (TypeError, ValueError, OverflowError):
            return Hole("number")

    return each(arguments.get(0) or Known(0), made)


def _bool(_: Machine, __: object, arguments: Arguments) -> Value:
    value = arguments.get(0) or FALSE
    decided = truth(value)
    return Hole("bool") if decided is None else Known(decided, is_tainted(value))


def _len(_: Machine, __: object, arguments: Arguments) -> Value:
    items, certain = items_of(arguments.get(0) or Hole("?"))
    return Known(len(items)) if certain else Hole("len")


def _range(_: Machine, __: object, arguments: Arguments) -> Value:
    numbers = [
        v.value for v in arguments.values if isinstance(v, Known) and isinstance(v.value, int)
    ]
    if len(numbers) != len(arguments.values) or not 1 <= len(numbers) <= 3:  # noqa: PLR2004
        return Hole("range")
    try:
        found = range(*numbers)
    except ValueError:
        return Hole("range")
    return ListValue(
        {"items": tuple(map(Known, found[:MAX_RANGE])), "open": len(found) > MAX_RANGE}
    )


def _open(_: Machine, __: object, arguments: Arguments) -> Value:
    return Instance(FILE, {"path": arguments.get(0, "file") or Hole("path")})


def _slice(_: Machine, __: object, arguments: Arguments) -> Value:
    values = arguments.values if len(arguments.values) > 1 else (NONE, *arguments.values)
    return Instance(
        SLICE, dict(zip(("start", "stop", "step"), (*values, NONE, NONE), strict=False))
    )


def _enumerate(_: Machine, __: object, arguments: Arguments) -> Value:
    items, certain = items_of(arguments.get(0) or Hole("?"))
    start = arguments.get(1, "start")
    first = start.value if isinstance(start, Known) and isinstance(start.value, int) else 0
    pairs = tuple(listed((Known(first + at), item), "tuple") for at, item in enumerate(items))
    return ListValue({"items": pairs, "open": not certain})


def _zip(_: Machine, __: object, arguments: Arguments) -> Value:
    found = [items_of(value) for value in arguments.values]
    rows = zip(*(items for items, _ in found), strict=False)
    pairs = tuple(listed(row, "tuple") for row in rows)
    return ListValue({"items": pairs, "open": not all(certain for _, certain in found)})


def _copy(kind: str, _: Machine, __: object, arguments: Arguments) -> Value:
    items, certain = items_of(arguments.get(0) or listed(()))
    return ListValue({"items": items, "open": not certain}, kind)


def _called_on(
    machine: Machine, function: Value | None, given: Value, at: Arguments
) -> list[Value]:
    """Call a function, if there is one, on each item of what is given."""
    if function is None or function == NONE:
        return []
    items, certain = items_of(given)
    if not certain:
        machine.escape(function)
    return [
        dispatch(machine, function, Arguments(values=(item,), line=at.line, frame=at.frame))
        for item in items
    ]


def _sorted(machine: Machine, _: object, arguments: Arguments) -> Value:
    items, certain = items_of(arguments.get(0) or Hole("?"))
    if not certain:
        machine.escape(arguments.keywords.get("key"))
    return ListValue({"items": in_order(machine, items, arguments), "open": not certain})


def _dict(_: Machine, __: object, arguments: Arguments) -> Value:
    given = arguments.get(0)
    made = MapValue(dict(given.fields) if isinstance(given, MapValue) else {})
    for item in items_of(given)[0] if isinstance(given, ListValue) else ():
        key, value = (*items_of(item)[0], Hole("?"), Hole("?"))[:2]
        made.fields[key.value if isinstance(key, Known) else OPEN] = value
    made.fields.update(arguments.keywords)
    return made


def _map(machine: Machine, _: object, arguments: Arguments) -> Value:
    function, values = arguments.get(0) or Hole("?"), arguments.get(1) or Hole("?")
    found = _called_on(machine, function, values, arguments)
    return ListValue({"items": tuple(found), "open": not items_of(values)[1]})


def _filter(machine: Machine, _: object, arguments: Arguments) -> Value:
    items, _certain = items_of(arguments.get(1) or Hole("?"))
    _called_on(machine, arguments.get(0), arguments.get(1) or NONE, arguments)
    return ListValue({"items": items, "open": True})


def _isinstance(machine: Machine, _: object, arguments: Arguments) -> Value:
    value, wanted = arguments.get(0), arguments.get(1)
    if isinstance(value, Instance) and isinstance(wanted, ClassValue):
        return Known(any(cls is wanted for cls in machine.world.lineage(value.type)))
    kinds = {"list": "list", "tuple": "tuple", "set": "set"}
    if isinstance(value, ListValue) and isinstance(wanted, Native):
        return Known(kinds.get(wanted.name) == value.kind)
    if isinstance(value, MapValue) and isinstance(wanted, Native):
        return Known(wanted.name == "dict")
    if isinstance(value, Known) and isinstance(wanted, Native):
        names = {"unicode": "str", "basestring": "str", "long": "int"}
        return Known(type(value.value).__name__ == names.get(wanted.name, wanted.name))
    return Hole("isinstance")


def _getattr(machine: Machine, _: object, arguments: Arguments) -> Value:
    owner, name = arguments.get(0) or Hole("?"), arguments.get(1)
    if not isinstance(name, Known):
        return member(machine, owner, name or NONE, arguments)
    found = machine.world.attribute(owner, str(name.value), ())
    return found or arguments.get(2) or Hole(str(name.value))


def _setattr(machine: Machine, _: object, arguments: Arguments) -> Value:
    owner, name = arguments.get(0), arguments.get(1)
    if isinstance(owner, (Instance, ClassValue)) and isinstance(name, Known):
        machine.trail.set(owner.fields, str(name.value), arguments.get(2) or NONE)
    return NONE


def _hasattr(machine: Machine, _: object, arguments: Arguments) -> Value:
    owner, name = arguments.get(0), arguments.get(1)
    if isinstance(owner, (Instance, ClassValue)) and isinstance(name, Known):
        return Known(machine.world.attribute(owner, str(name.value), ()) is not None)
    return Hole("hasattr")


def _super(machine: Machine, _: object, arguments: Arguments) -> Value:
    """`super()`, `super(Class, self)`: the object, as the classes behind see it."""
    cls, owner = arguments.get(0), arguments.get(1)
    frame = arguments.frame
    if owner is None and frame.function is not None and frame.function.params:
        owner, cls = frame.variables.get(frame.function.params[0].name), frame.cls
    if not isinstance(owner, (Instance, ClassValue)) or not isinstance(cls, ClassValue):
        return Hole("super")
    order = tuple(machine.world.lineage(owner.type if isinstance(owner, Instance) else owner))
    return seen_behind(owner, cls, order if cls in order else tuple(machine.world.lineage(cls)))


def _sum(_: Machine, __: object, arguments: Arguments) -> Value:
    items, certain = items_of(arguments.get(0) or Hole("?"))
    total: Value = Known(0)
    for item in items:
        total = binary("+", total, item)
    return total if certain else Hole("sum")


def _extreme(
    pick: Callable[..., object], machine: Machine, _: object, arguments: Arguments
) -> Value:
    values = (
        arguments.values if len(arguments.values) > 1 else items_of(arguments.get(0) or NONE)[0]
    )
    _called_on(machine, arguments.keywords.get("key"), listed(values), arguments)
    known = [value.value for value in values if isinstance(value, Known)]
    if not known or len(known) != len(values):
        return Hole("extreme")
    try:
        return Known(pick(known))
    except TypeError:
        return Hole("extreme")


def _any(_: Machine, __: object, arguments: Arguments, *, wanted: bool) -> Value:
    items, certain = items_of(arguments.get(0) or Hole("?"))
    answers = [truth(item) for item in items]
    if wanted in answers:
        return Known(wanted)
    return Known(not wanted) if certain and None not in answers else Hole("any")


def _type(_: Machine, __: object, arguments: Arguments) -> Value:
    """`type(value)`, or `type("Name", bases, members)`, which makes a class."""
    value, members = arguments.get(0), arguments.get(2)
    if isinstance(members, MapValue):
        name = spelled(value or Hole("?"))
        definition = Class(name=name, file=arguments.frame.file, line=arguments.line)
        bases = items_of(arguments.get(1) or NONE)[0]
        return ClassValue(definition, bases, members.entries)
    return value.type if isinstance(value, Instance) else Hole("type")


def _hole(name: str, machine: Machine, _: object, arguments: Arguments) -> Value:
    for value in arguments.values:
        machine.escape(value)
    return Hole(name)


_CALLS: Mapping[str, Callable[..., Value]] = {
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
    "reversed": lambda machine, _, a: listed(items_of(a.get(0) or NONE)[0][::-1]),
    "iter": partial(_copy, "list"),
    "next": lambda machine, _, a: join(items_of(a.get(0) or NONE)[0] or (Hole("next"),)),
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
    "min": partial(_extreme, min),
    "max": partial(_extreme, max),
    "any": partial(_any, wanted=True),
    "all": partial(_any, wanted=False),
    "type": _type,
    **{name: partial(_hole, name) for name in ("input", "raw_input", "id", "print")},
}
FILE = NativeClass("file")
BUILTINS: Mapping[str, Value] = {
    "True": TRUE,
    "False": FALSE,
    "None": NONE,
    "basestring": Native("str", _str),
    **{name: Foreign(name) for name in ("object", "property", "staticmethod", "classmethod")},
    **{name: Native(name, call) for name, call in _CALLS.items()},
    **HIDDEN_BUILTINS,
}
