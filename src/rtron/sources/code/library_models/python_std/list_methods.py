"""Methods of Python's lists, tuples, sets, deques and generators."""

from collections.abc import Callable
from functools import partial

from rtron.sources.code.interpreter import abstract_values as av
from rtron.sources.code.interpreter.execution.abstract_machine import AbstractMachine, ThrownError
from rtron.sources.code.interpreter.execution.arguments import Arguments
from rtron.sources.code.interpreter.execution.exceptions import is_caught
from rtron.sources.code.library_models.common.containers import LIST_METHODS, LibraryMethods
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


def _next(machine: AbstractMachine, owner: av.ListValue, _: Arguments) -> av.Value:
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
    return (
        av.Unknown("count") if owner.open or None in answers else av.Scalar(sum(map(bool, answers)))
    )


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
    **dict.fromkeys(("next", "__next__"), _next),
    **{name: partial(_combine, operator) for name, operator in _SET_METHODS.items()},
    **{
        f"{name}_update": partial(_combine_in_place, operator)
        for name, operator in _SET_METHODS.items()
        if name != "union"
    },
}
PYTHON_LIST_METHODS: LibraryMethods = {**LIST_METHODS, **_METHODS}
