"""Methods of Python's lists and iterators, and the built-in functions that go through them."""

from collections.abc import Callable, Mapping
from functools import partial

from rtron.sources.code.interpreter import abstract_values as av
from rtron.sources.code.interpreter.execution.abstract_machine import AbstractMachine, ThrownError
from rtron.sources.code.interpreter.execution.arguments import Arguments
from rtron.sources.code.interpreter.execution.calls import dispatch
from rtron.sources.code.interpreter.execution.exceptions import is_caught
from rtron.sources.code.library_models.common.containers import (
    LIST_METHODS,
    LibraryMethods,
    sort_items,
)
from rtron.sources.code.library_models.common.trivial_functions import return_owner

ITERATORS = {"iterator", "generator"}
"""The kinds of what gives its items one by one."""


def next_item(machine: AbstractMachine, owner: av.Value, default: av.Value | None) -> av.Value:
    """`next(iterator, default)`: the first item, which the iterator has no longer."""
    if not isinstance(owner, av.ListValue) or (owner.open and not owner.items):
        return av.Unknown("next")
    if owner.items:
        first, *rest = owner.items
        if owner.kind in ITERATORS:
            machine.undo_log.set(owner.fields, "items", tuple(rest))
        return first
    if default is None and is_caught(
        machine.active_handlers, ended := ThrownError("StopIteration")
    ):
        raise ended
    return default or av.Unknown("next")


def _take_next(machine: AbstractMachine, owner: av.ListValue, _: Arguments) -> av.Value:
    return next_item(machine, owner, None)


def _pop_left(machine: AbstractMachine, owner: av.ListValue, _: Arguments) -> av.Value:
    found = av.element(owner, av.Scalar(0)) if owner.items else av.Unknown("popleft")
    machine.undo_log.set(owner.fields, "items", owner.items[1:])
    return found


def _index(_: AbstractMachine, owner: av.ListValue, arguments: Arguments) -> av.Value:
    for at, item in enumerate(owner.items):
        is_same = av.truth(av.binary("==", item, arguments.value(0)))
        if is_same is not False:
            return av.Scalar(at) if is_same else av.Unknown("index")
    return av.Unknown("index")


def _count(_: AbstractMachine, owner: av.ListValue, arguments: Arguments) -> av.Value:
    answers = [av.truth(av.binary("==", item, arguments.value(0))) for item in owner.items]
    unsure = owner.open or None in answers
    return av.Unknown("count") if unsure else av.Scalar(sum(map(bool, answers)))


def _combine(
    operator: str, machine: AbstractMachine, owner: av.ListValue, given: Arguments
) -> av.Value:
    """`union(others…)`, `intersection(…)`, `difference(…)`, `symmetric_difference(…)`."""
    made: av.Value = av.list_of(owner.items, "set", certain=not owner.open)
    for value in given.values:
        items, certain = machine.runtime.iterate(value)
        made = av.binary(operator, made, av.list_of(items, "set", certain=certain))
    return made


def _combine_in_place(
    operator: str, machine: AbstractMachine, owner: av.ListValue, given: Arguments
) -> av.Value:
    made = _combine(operator, machine, owner, given)
    if isinstance(made, av.ListValue):
        machine.undo_log.set(owner.fields, "items", made.items)
        machine.undo_log.set(owner.fields, "open", made.open)
    return av.NONE


_SET_METHODS: dict[str, str] = {
    "union": "|",
    "intersection": "&",
    "difference": "-",
    "symmetric_difference": "^",
}
_METHODS: dict[str, Callable[..., av.Value]] = {
    **dict.fromkeys(("popleft", "get", "get_nowait"), _pop_left),
    **dict.fromkeys(("put", "put_nowait"), LIST_METHODS["append"]),
    "index": _index,
    "count": _count,
    "__iter__": return_owner,
    **dict.fromkeys(("next", "__next__"), _take_next),
    **{name: partial(_combine, operator) for name, operator in _SET_METHODS.items()},
    **{
        f"{name}_update": partial(_combine_in_place, operator)
        for name, operator in _SET_METHODS.items()
        if name != "union"
    },
}
PYTHON_LIST_METHODS: LibraryMethods = {**LIST_METHODS, **_METHODS}


def _enumerate(machine: AbstractMachine, _: object, arguments: Arguments) -> av.Value:
    items, certain = machine.runtime.iterate(arguments.value(0))
    start = arguments.get(1, "start")
    first = start.value if isinstance(start, av.Scalar) and isinstance(start.value, int) else 0
    pairs = tuple(
        av.list_of((av.Scalar(first + at), item), "tuple") for at, item in enumerate(items)
    )
    return av.list_of(pairs, certain=certain)


def _zip(machine: AbstractMachine, _: object, arguments: Arguments) -> av.Value:
    found = [machine.runtime.iterate(value) for value in arguments.values]
    iterators = [iter(items) for items, _ in found]
    for at, value in enumerate(arguments.values):
        first = next(n for n, other in enumerate(arguments.values) if other is value)
        if isinstance(value, av.ListValue) and value.kind in ITERATORS:
            iterators[at] = iterators[first]
    rows = zip(*iterators, strict=False)
    pairs = tuple(av.list_of(row, "tuple") for row in rows)
    return av.list_of(pairs, certain=all(certain for _, certain in found))


def _copy(kind: str, machine: AbstractMachine, _: object, arguments: Arguments) -> av.Value:
    given = arguments.get(0) or av.list_of(())
    if kind in ITERATORS and isinstance(given, av.ListValue) and given.kind in ITERATORS:
        return given
    items, certain = machine.runtime.iterate(given)
    return av.list_of(items, kind, certain=certain)


def _next(machine: AbstractMachine, _: object, arguments: Arguments) -> av.Value:
    """`next(iterator, default)`."""
    method = machine.runtime.special_method(arguments.value(0), "__next__")
    if method is not None:
        return dispatch(machine, method, arguments.with_values())
    found = [next_item(machine, one, arguments.get(1)) for one in av.options(arguments.value(0))]
    return av.join(found)


def _reversed(machine: AbstractMachine, _: object, arguments: Arguments) -> av.Value:
    items, certain = machine.runtime.iterate(arguments.get(0) or av.NONE)
    return av.list_of(items[::-1], "iterator", certain=certain)


def _call_on_items(
    machine: AbstractMachine, function: av.Value | None, given: av.Value, at: Arguments
) -> list[av.Value]:
    """Call a function, if there is one, on each item of what is given."""
    if function is None or function == av.NONE:
        return []
    items, certain = machine.runtime.iterate(given)
    if not certain:
        machine.escape(function)
    return [dispatch(machine, function, at.with_values(item)) for item in items]


def _sorted(machine: AbstractMachine, _: object, arguments: Arguments) -> av.Value:
    items, certain = machine.runtime.iterate(arguments.value(0))
    if not certain:
        machine.escape(arguments.keywords.get("key"))
    return av.list_of(sort_items(machine, items, arguments), certain=certain)


def _map(machine: AbstractMachine, _: object, arguments: Arguments) -> av.Value:
    """`map(function, items, …)`."""
    function = arguments.value(0)
    rows = _zip(machine, None, arguments.without_first(1))
    return call_on_rows(machine, function, rows, arguments)


def call_on_rows(
    machine: AbstractMachine, function: av.Value, rows: av.Value, at: Arguments
) -> av.Value:
    """Call a function with the items of each row, as `map` and `itertools.starmap` do."""
    items, certain = machine.runtime.iterate(rows)
    if not certain:
        machine.escape(function)
    found = [dispatch(machine, function, at.with_values(*av.items_of(row)[0])) for row in items]
    return av.list_of(found, "iterator", certain=certain)


def _filter(machine: AbstractMachine, _: object, arguments: Arguments) -> av.Value:
    function, given = arguments.get(0) or av.NONE, arguments.get(1) or av.NONE
    items, certain = machine.runtime.iterate(given)
    answers = items if function == av.NONE else _call_on_items(machine, function, given, arguments)
    decided = [av.truth(answer) for answer in answers]
    passing = [item for item, keep in zip(items, decided, strict=True) if keep is not False]
    return av.list_of(passing, "iterator", certain=certain and None not in decided)


def _sum(machine: AbstractMachine, _: object, arguments: Arguments) -> av.Value:
    items, certain = machine.runtime.iterate(arguments.value(0))
    total: av.Value = arguments.get(1, "start") or av.Scalar(0)
    for item in items:
        total = av.binary("+", total, item)
    return total if certain else av.Unknown("sum")


def _min_or_max(
    pick: Callable[..., object], machine: AbstractMachine, _: object, arguments: Arguments
) -> av.Value:
    given, key = arguments.get(0) or av.NONE, arguments.keywords.get("key")
    several = len(arguments.values) > 1
    values, certain = (arguments.values, True) if several else machine.runtime.iterate(given)
    by_key = key is not None and key != av.NONE
    keys = _call_on_items(machine, key, av.list_of(values), arguments) if by_key else values
    known = [one.value for one in keys if isinstance(one, av.Scalar)]
    if not values and certain:
        return arguments.keywords.get("default", av.Unknown("extreme"))
    if len(known) != len(values) or not certain:
        return av.Unknown("extreme")
    try:
        return values[known.index(pick(known))]
    except TypeError:
        return av.Unknown("extreme")


def _any_or_all(
    machine: AbstractMachine, _: object, arguments: Arguments, *, deciding: bool
) -> av.Value:
    items, certain = machine.runtime.iterate(arguments.value(0))
    answers = [av.truth(item) for item in items]
    if deciding in answers:
        return av.Scalar(deciding)
    return av.Scalar(not deciding) if certain and None not in answers else av.Unknown("any")


def fold(machine: AbstractMachine, arguments: Arguments) -> av.Value:
    """`reduce(function, items, start)`."""
    function, start = arguments.value(0), arguments.get(2)
    items, certain = machine.runtime.iterate(arguments.value(1))
    if not certain:
        machine.escape(function)
        return av.Unknown("reduce")
    values = (*(() if start is None else (start,)), *items)
    made = values[0] if values else av.Unknown("reduce")
    for item in values[1:]:
        made = dispatch(machine, function, arguments.with_values(made, item))
    return made


ITERATION_FUNCTIONS: Mapping[str, Callable[..., av.Value]] = {
    "enumerate": _enumerate,
    "zip": _zip,
    "list": partial(_copy, "list"),
    "tuple": partial(_copy, "tuple"),
    "set": partial(_copy, "set"),
    "frozenset": partial(_copy, "set"),
    "reversed": _reversed,
    "iter": partial(_copy, "iterator"),
    "next": _next,
    "sorted": _sorted,
    "map": _map,
    "filter": _filter,
    "sum": _sum,
    "min": partial(_min_or_max, min),
    "max": partial(_min_or_max, max),
    "any": partial(_any_or_all, deciding=True),
    "all": partial(_any_or_all, deciding=False),
    "reduce": lambda machine, _, arguments: fold(machine, arguments),
}
