"""Python's collections, itertools and functools."""

import itertools
from collections.abc import Callable, Iterable, Mapping
from dataclasses import replace
from functools import partial

from rtron.sources.code.interpreter.abstract_values.items import items_of, list_of
from rtron.sources.code.interpreter.abstract_values.value_types import (
    NONE,
    UNKNOWN,
    FunctionValue,
    Instance,
    LibraryClass,
    LibraryFunction,
    ListValue,
    MapValue,
    Scalar,
    Unknown,
    Value,
    text_with_holes,
)
from rtron.sources.code.interpreter.execution.abstract_machine import AbstractMachine
from rtron.sources.code.interpreter.execution.arguments import Arguments
from rtron.sources.code.interpreter.execution.calls import dispatch
from rtron.sources.code.library_models.python_std.builtin_functions import BUILTINS
from rtron.sources.code.library_models.python_std.data_classes import ENUM

MAX_ROWS = 256
_Combinator = Callable[[tuple[Value, ...], int], Iterable[tuple[Value, ...]]]


def _default_dict(machine: AbstractMachine, _: object, arguments: Arguments) -> Value:
    machine.escape(arguments.get(0))
    return dispatch(machine, BUILTINS["dict"], arguments.without_first(1))


def _named_tuple(_: AbstractMachine, __: object, arguments: Arguments) -> Value:
    """`namedtuple("Name", ["a", "b"])` or `namedtuple("Name", "a b")`."""
    given = arguments.value(1, "field_names")
    items = given.items if isinstance(given, ListValue) else (given,)
    names = " ".join(map(text_with_holes, items)).replace(",", " ").split()

    def fields(passed: Arguments) -> dict[str, Value]:
        return {name: passed.get(at, name) or Unknown(name) for at, name in enumerate(names)}

    def init(machine: AbstractMachine, owner: Instance, passed: Arguments) -> Value:
        for name, value in fields(passed).items():
            machine.undo_log.set(owner.fields, name, value)
        return NONE

    def make(_: AbstractMachine, passed: Arguments) -> Value:
        return Instance(made, dict(fields(passed)))

    methods = {"__init__": init, "_asdict": _as_dict, "_replace": _replace_fields}
    made = LibraryClass(text_with_holes(arguments.value(0)), make, methods)
    return made


def _as_dict(_: AbstractMachine, owner: Instance, __: Arguments) -> Value:
    return MapValue(dict(owner.fields))


def _replace_fields(_: AbstractMachine, owner: Instance, arguments: Arguments) -> Value:
    return Instance(owner.type, {**owner.fields, **arguments.keywords})


def _chain(_: AbstractMachine, __: object, arguments: Arguments) -> Value:
    found = [items_of(value) for value in arguments.values]
    items = tuple(item for items, _ in found for item in items)
    return list_of(items, certain=all(certain for _, certain in found))


def _chain_from_iterable(machine: AbstractMachine, _: object, arguments: Arguments) -> Value:
    values, certain = items_of(arguments.value(0))
    passed = (*values, *(() if certain else (UNKNOWN,)))
    return _chain(machine, None, arguments.with_values(*passed))


def _product(_: AbstractMachine, __: object, arguments: Arguments) -> Value:
    times = arguments.keywords.get("repeat", Scalar(1))
    found = [items_of(value) for value in arguments.values]
    count = times.value if isinstance(times, Scalar) and times.value in range(1, 5) else 1
    rows = itertools.product(*(items for items, _ in found * count))
    return _tuples(rows, certain=all(certain for _, certain in found))


def _combine(choose: _Combinator, _: AbstractMachine, __: object, arguments: Arguments) -> Value:
    """`combinations(items, count)`, `permutations(items, count)`."""
    items, certain = items_of(arguments.value(0))
    count = arguments.get(1, "r")
    size = count.value if isinstance(count, Scalar) else len(items)
    if not isinstance(size, int) or size < 0:
        return Unknown("combinations")
    return _tuples(choose(items, size), certain=certain)


def _tuples(rows: Iterable[tuple[Value, ...]], *, certain: bool) -> Value:
    found = [list_of(row, "tuple") for row in itertools.islice(rows, MAX_ROWS + 1)]
    unsure = not certain or len(found) > MAX_ROWS
    return list_of(found[:MAX_ROWS], certain=not unsure)


def _partial(_: AbstractMachine, __: object, arguments: Arguments) -> Value:
    function, given = arguments.value(0), arguments.without_first(1)
    if isinstance(function, FunctionValue):
        named = {**function.bound_keywords, **given.keywords}
        return replace(
            function,
            bound_arguments=(*function.bound_arguments, *given.values),
            bound_keywords=named,
        )

    def call(machine: AbstractMachine, _: object, later: Arguments) -> Value:
        values, keywords = (*given.values, *later.values), {**given.keywords, **later.keywords}
        passed = Arguments(values=values, keywords=keywords, line=later.line, frame=later.frame)
        return dispatch(machine, function, passed)

    return LibraryFunction("partial", call)


def _wraps(_: AbstractMachine, __: object, ___: Arguments) -> Value:
    """`@wraps(function)` leaves what it decorates as it is."""
    return LibraryFunction("wraps", lambda machine, owner, arguments: arguments.get(0) or NONE)


_CALLS: Mapping[str, Callable[..., Value]] = {
    "collections.defaultdict": _default_dict,
    "collections.namedtuple": _named_tuple,
    "functools.partial": _partial,
    "functools.wraps": _wraps,
    "itertools.chain": _chain,
    "itertools.chain.from_iterable": _chain_from_iterable,
    "itertools.product": _product,
    "itertools.combinations": partial(_combine, itertools.combinations),
    "itertools.permutations": partial(_combine, itertools.permutations),
}
PYTHON_COLLECTIONS: Mapping[str, Value] = {
    **{name: LibraryFunction(name, call) for name, call in _CALLS.items()},
    "collections.OrderedDict": BUILTINS["dict"],
    "collections.deque": BUILTINS["list"],
    "itertools.izip": BUILTINS["zip"],
    "itertools.imap": BUILTINS["map"],
    "enum.Enum": ENUM,
    "enum.IntEnum": ENUM,
}
