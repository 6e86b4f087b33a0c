"""Algorithms of C++ over what stands between two iterators (cppreference.com: algorithm)."""

from collections.abc import Callable, Iterator, Mapping
from functools import partial

from rtron.sources.code.interpreter.abstract_values.operators import binary
from rtron.sources.code.interpreter.abstract_values.value_types import (
    FALSE,
    NONE,
    TRUE,
    Hole,
    Known,
    Value,
    truth,
)
from rtron.sources.code.interpreter.cpp.iterators import end, items_from
from rtron.sources.code.interpreter.execution.abstract_machine import Machine
from rtron.sources.code.interpreter.execution.arguments import Arguments
from rtron.sources.code.interpreter.execution.calls import dispatch

_WANTED = 2
"""The place of the function, or of the value looked for: behind both iterators."""


def _for_each(machine: Machine, _: object, arguments: Arguments) -> Value:
    """`std::for_each(xs.begin(), xs.end(), function)`."""
    found, function = items_from(arguments.get(0)), arguments.get(_WANTED) or NONE
    if found is None:
        machine.escape(function)
        return NONE
    for _place, item in found[0]:
        _called(machine, function, item, arguments)
    return NONE


def _called(machine: Machine, function: Value, item: Value, arguments: Arguments) -> Value:
    given = Arguments(values=(item,), line=arguments.line, frame=arguments.frame)
    return dispatch(machine, function, given)


def _find(machine: Machine, _: object, arguments: Arguments) -> Value:
    """`std::find(xs.begin(), xs.end(), value)`."""
    wanted = arguments.get(_WANTED) or NONE
    return _first(machine, arguments, lambda item: binary("==", item, wanted))


def _find_if(machine: Machine, _: object, arguments: Arguments, *, wanted: bool) -> Value:
    """`std::find_if(xs.begin(), xs.end(), predicate)`."""
    function = arguments.get(_WANTED) or NONE

    def fits(item: Value) -> Value:
        answer = truth(_called(machine, function, item, arguments))
        return Hole("find_if") if answer is None else Known(answer is wanted)

    return _first(machine, arguments, fits)


def _first(machine: Machine, arguments: Arguments, fits: Callable[[Value], Value]) -> Value:
    """Return the place of the first item that fits, the end where certainly none does."""
    found = items_from(arguments.get(0))
    if found is None:
        machine.escape(arguments.get(_WANTED))
        return Hole("find")
    for place, item in found[0]:
        answer = truth(fits(item))
        if answer is not False:
            return place if answer else Hole("find")
    return end(machine, NONE, arguments) if found[1] else Hole("find")


def _any_of(machine: Machine, _: object, arguments: Arguments) -> Value:
    """`std::any_of(xs.begin(), xs.end(), predicate)`."""
    return _among(machine, arguments, decides=True)


def _all_of(machine: Machine, _: object, arguments: Arguments) -> Value:
    """`std::all_of(xs.begin(), xs.end(), predicate)`."""
    return _among(machine, arguments, decides=False)


def _none_of(machine: Machine, _: object, arguments: Arguments) -> Value:
    """`std::none_of(xs.begin(), xs.end(), predicate)`."""
    answer = _among(machine, arguments, decides=True)
    return Known(not answer.value) if isinstance(answer, Known) else answer


def _among(machine: Machine, arguments: Arguments, *, decides: bool) -> Value:
    """Return the answer that one item decides, or the other one where none does."""
    found = items_from(arguments.get(0))
    if found is None:
        machine.escape(arguments.get(_WANTED))
        return Hole("any_of")
    answers = set(_answers(machine, arguments, [item for _, item in found[0]]))
    if decides in answers:
        return Known(decides)
    return (FALSE if decides else TRUE) if found[1] and None not in answers else Hole("any_of")


def _answers(machine: Machine, arguments: Arguments, items: list[Value]) -> Iterator[bool | None]:
    function = arguments.get(_WANTED) or NONE
    for item in items:
        yield truth(_called(machine, function, item, arguments))


ALGORITHMS: Mapping[str, Callable[..., Value]] = {
    "for_each": _for_each,
    "find": _find,
    "find_if": partial(_find_if, wanted=True),
    "find_if_not": partial(_find_if, wanted=False),
    "any_of": _any_of,
    "all_of": _all_of,
    "none_of": _none_of,
}
