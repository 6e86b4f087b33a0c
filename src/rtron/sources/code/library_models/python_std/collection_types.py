"""Python's collections, itertools and functools."""

import itertools
from collections.abc import Callable, Iterable, Mapping
from dataclasses import replace
from functools import partial

from rtron.sources.code.interpreter.abstract_values.items import items_of, listed
from rtron.sources.code.interpreter.abstract_values.value_types import (
    NONE,
    FunctionValue,
    Hole,
    Instance,
    Known,
    ListValue,
    MapValue,
    Native,
    NativeClass,
    Value,
    spelled,
)
from rtron.sources.code.interpreter.execution.abstract_machine import Machine
from rtron.sources.code.interpreter.execution.arguments import Arguments
from rtron.sources.code.interpreter.execution.calls import dispatch
from rtron.sources.code.library_models.python_std.builtin_functions import BUILTINS
from rtron.sources.code.library_models.python_std.data_classes import ENUM

MAX_ROWS = 256
_Choose = Callable[[tuple[Value, ...], int], Iterable[tuple[Value, ...]]]


def _default_dict(machine: Machine, _: object, arguments: Arguments) -> Value:
    machine.escape(arguments.get(0))
    return dispatch(machine, BUILTINS["dict"], arguments.shifted(1))


def _named_tuple(_: Machine, __: object, arguments: Arguments) -> Value:
    """`namedtuple("Name", ["a", "b"])` or `namedtuple("Name", "a b")`."""
    given = arguments.get(1, "field_names") or Hole("?")
    words = map(spelled, given.items) if isinstance(given, ListValue) else [spelled(given)]
    names = " ".join(words).replace(",", " ").split()

    def fields(passed: Arguments) -> dict[str, Value]:
        return {name: passed.get(at, name) or Hole(name) for at, name in enumerate(names)}

    def init(machine: Machine, owner: Instance, passed: Arguments) -> Value:
        for name, value in fields(passed).items():
            machine.trail.set(owner.fields, name, value)
        return NONE

    def make(_: Machine, passed: Arguments) -> Value:
        return Instance(made, dict(fields(passed)))

    methods = {"__init__": init, "_asdict": _as_dict, "_replace": _replaced}
    made = NativeClass(spelled(arguments.get(0) or Hole("?")), make, methods)
    return made


def _as_dict(_: Machine, owner: Instance, __: Arguments) -> Value:
    return MapValue(dict(owner.fields))


def _replaced(_: Machine, owner: Instance, arguments: Arguments) -> Value:
    return Instance(owner.type, {**owner.fields, **arguments.keywords})


def _chain(_: Machine, __: object, arguments: Arguments) -> Value:
    found = [items_of(value) for value in arguments.values]
    items = tuple(item for items, _ in found for item in items)
    return ListValue({"items": items, "open": not all(certain for _, certain in found)})


def _chain_from(machine: Machine, _: object, arguments: Arguments) -> Value:
    values, certain = items_of(arguments.get(0) or Hole("?"))
    passed = (*values, *(() if certain else (Hole("?"),)))
    return _chain(machine, None, Arguments(values=passed, frame=arguments.frame))


def _product(_: Machine, __: object, arguments: Arguments) -> Value:
    times = arguments.keywords.get("repeat", Known(1))
    found = [items_of(value) for value in arguments.values]
    count = times.value if isinstance(times, Known) and times.value in range(1, 5) else 1
    rows = itertools.product(*(items for items, _ in found * count))
    return _rows(rows, certain=all(certain for _, certain in found))


def _chosen(choose: _Choose, _: Machine, __: object, arguments: Arguments) -> Value:
    """`combinations(items, count)`, `permutations(items, count)`."""
    items, certain = items_of(arguments.get(0) or Hole("?"))
    count = arguments.get(1, "r")
    size = count.value if isinstance(count, Known) else len(items)
    if not isinstance(size, int) or size < 0:
        return Hole("combinations")
    return _rows(choose(items, size), certain=certain)


def _rows(rows: Iterable[tuple[Value, ...]], *, certain: bool) -> Value:
    found = [listed(row, "tuple") for row in itertools.islice(rows, MAX_ROWS + 1)]
    unsure = not certain or len(found) > MAX_ROWS
    return ListValue({"items": tuple(found[:MAX_ROWS]), "open": unsure})


def _partial(_: Machine, __: object, arguments: Arguments) -> Value:
    function, given = arguments.get(0) or Hole("?"), arguments.shifted(1)
    if isinstance(function, FunctionValue):
        named = {**function.named, **given.keywords}
        return replace(function, given=(*function.given, *given.values), named=named)

    def call(machine: Machine, _: object, later: Arguments) -> Value:
        values, keywords = (*given.values, *later.values), {**given.keywords, **later.keywords}
        passed = Arguments(values=values, keywords=keywords, line=later.line, frame=later.frame)
        return dispatch(machine, function, passed)

    return Native("partial", call)


def _wraps(_: Machine, __: object, ___: Arguments) -> Value:
    """`@wraps(function)` leaves what it decorates as it is."""
    return Native("wraps", lambda machine, owner, arguments: arguments.get(0) or NONE)


_CALLS: Mapping[str, Callable[..., Value]] = {
    "collections.defaultdict": _default_dict,
    "collections.namedtuple": _named_tuple,
    "functools.partial": _partial,
    "functools.wraps": _wraps,
    "itertools.chain": _chain,
    "itertools.chain.from_iterable": _chain_from,
    "itertools.product": _product,
    "itertools.combinations": partial(_chosen, itertools.combinations),
    "itertools.permutations": partial(_chosen, itertools.permutations),
}
PYTHON_COLLECTIONS: Mapping[str, Value] = {
    **{name: Native(name, call) for name, call in _CALLS.items()},
    "collections.OrderedDict": BUILTINS["dict"],
    "collections.deque": BUILTINS["list"],
    "itertools.izip": BUILTINS["zip"],
    "itertools.imap": BUILTINS["map"],
    "enum.Enum": ENUM,
    "enum.IntEnum": ENUM,
}
