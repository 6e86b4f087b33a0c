"""Algorithms of C++ over what stands between two iterators (cppreference.com: algorithm)."""

from collections.abc import Callable, Iterator, Mapping
from functools import partial

from rtron.sources.code.interpreter import abstract_values as av
from rtron.sources.code.interpreter.cpp.iterators import container_of, end, items_after, position_of
from rtron.sources.code.interpreter.execution.abstract_machine import AbstractMachine
from rtron.sources.code.interpreter.execution.arguments import Arguments
from rtron.sources.code.interpreter.execution.calls import dispatch
from rtron.sources.code.interpreter.execution.written_arguments import open_container

_THIRD_ARGUMENT = 2
"""The index of the function, or of the value looked for: behind both iterators."""


def _for_each(machine: AbstractMachine, _: object, arguments: Arguments) -> av.Value:
    """`std::for_each(xs.begin(), xs.end(), function)`."""
    found, function = items_after(arguments.get(0)), arguments.get(_THIRD_ARGUMENT) or av.NONE
    if found is None:
        machine.escape(function)
        return av.NONE
    for _iterator, item in found[0]:
        _call_with_item(machine, function, item, arguments)
    return av.NONE


def _call_with_item(
    machine: AbstractMachine, function: av.Value, item: av.Value, arguments: Arguments
) -> av.Value:
    given = arguments.with_values(item)
    return dispatch(machine, function, given)


def _copy(
    machine: AbstractMachine, _: object, arguments: Arguments, *, transforms: bool
) -> av.Value:
    """`std::copy(xs.begin(), xs.end(), std::back_inserter(ys))`, `std::transform(…, function)`."""
    place = arguments.get(_THIRD_ARGUMENT)
    target, function = container_of(place), arguments.get(_THIRD_ARGUMENT + 1)
    if not isinstance(target, av.ListValue):
        return _copy_text(machine, function, arguments)
    found = items_after(arguments.get(0))
    if found is None or (transforms and function is None):
        machine.escape(function)
        open_container(machine, target)
        return av.Unknown("copy")
    items = [item for _, item in found[0]]
    if transforms and function is not None:
        items = [_call_with_item(machine, function, item, arguments) for item in items]
    before = target.items if place is target else ()
    rest = target.items[len(items) :] if place is not target else ()
    machine.undo_log.set(target.fields, "items", (*before, *items, *rest))
    if not found[1] or (place is not target and position_of(place)):
        machine.undo_log.mark_open(target.fields)
    return target


def _copy_text(
    machine: AbstractMachine, function: av.Value | None, arguments: Arguments
) -> av.Value:
    """`std::transform(text.begin(), text.end(), text.begin(), ::toupper)`: letter by letter."""
    source, target = arguments.slot(0), arguments.slot(_THIRD_ARGUMENT)
    text = source.holder.get(source.key) if source is not None else None
    letters = av.items_of(text)[0] if isinstance(text, av.Scalar) else ()
    if function is not None and letters:
        letters = tuple(_call_with_item(machine, function, one, arguments) for one in letters)
    else:
        machine.escape(function)
    made = [one.value for one in letters if isinstance(one, av.Scalar)]
    is_known = bool(letters) and len(made) == len(letters) and all(isinstance(x, str) for x in made)
    if target is not None and av.is_text(target.holder.get(target.key, av.NONE)):
        known = av.Scalar("".join(made), any(map(av.is_tainted, letters)))
        machine.undo_log.set(*target, known if is_known else av.Unknown(target.label))
    return av.Unknown("copy")


def _find(machine: AbstractMachine, _: object, arguments: Arguments) -> av.Value:
    """`std::find(xs.begin(), xs.end(), value)`."""
    sought = arguments.get(_THIRD_ARGUMENT) or av.NONE
    return _first_match(machine, arguments, lambda item: av.binary("==", item, sought))


def _find_if(
    machine: AbstractMachine, _: object, arguments: Arguments, *, expected: bool
) -> av.Value:
    """`std::find_if(xs.begin(), xs.end(), predicate)`."""
    function = arguments.get(_THIRD_ARGUMENT) or av.NONE

    def fits(item: av.Value) -> av.Value:
        answer = av.truth(_call_with_item(machine, function, item, arguments))
        return av.Unknown("find_if") if answer is None else av.Scalar(answer is expected)

    return _first_match(machine, arguments, fits)


def _first_match(
    machine: AbstractMachine, arguments: Arguments, fits: Callable[[av.Value], av.Value]
) -> av.Value:
    """Return an iterator at the first item that fits, the end where certainly none does."""
    found = items_after(arguments.get(0))
    if found is None:
        machine.escape(arguments.get(_THIRD_ARGUMENT))
        return av.Unknown("find")
    for iterator, item in found[0]:
        answer = av.truth(fits(item))
        if answer is not False:
            return iterator if answer else av.Unknown("find")
    return end(machine, av.NONE, arguments) if found[1] else av.Unknown("find")


def _any_of(machine: AbstractMachine, _: object, arguments: Arguments) -> av.Value:
    """`std::any_of(xs.begin(), xs.end(), predicate)`."""
    return _quantify(machine, arguments, decides=True)


def _all_of(machine: AbstractMachine, _: object, arguments: Arguments) -> av.Value:
    """`std::all_of(xs.begin(), xs.end(), predicate)`."""
    return _quantify(machine, arguments, decides=False)


def _none_of(machine: AbstractMachine, _: object, arguments: Arguments) -> av.Value:
    """`std::none_of(xs.begin(), xs.end(), predicate)`."""
    answer = _quantify(machine, arguments, decides=True)
    return av.Scalar(not answer.value) if isinstance(answer, av.Scalar) else answer


def _quantify(machine: AbstractMachine, arguments: Arguments, *, decides: bool) -> av.Value:
    """Return the answer that one item decides, or the other one where none does."""
    found = items_after(arguments.get(0))
    if found is None:
        machine.escape(arguments.get(_THIRD_ARGUMENT))
        return av.Unknown("any_of")
    answers = set(_predicate_results(machine, arguments, [item for _, item in found[0]]))
    if decides in answers:
        return av.Scalar(decides)
    unsure = not found[1] or None in answers
    return av.Unknown("any_of") if unsure else av.Scalar(not decides)


def _predicate_results(
    machine: AbstractMachine, arguments: Arguments, items: list[av.Value]
) -> Iterator[bool | None]:
    function = arguments.get(_THIRD_ARGUMENT) or av.NONE
    for item in items:
        yield av.truth(_call_with_item(machine, function, item, arguments))


ALGORITHMS: Mapping[str, Callable[..., av.Value]] = {
    "for_each": _for_each,
    "copy": partial(_copy, transforms=False),
    "transform": partial(_copy, transforms=True),
    "find": _find,
    "find_if": partial(_find_if, expected=True),
    "find_if_not": partial(_find_if, expected=False),
    "any_of": _any_of,
    "all_of": _all_of,
    "none_of": _none_of,
}
