"""Loops: unrolled where the rounds are known, run once in doubt where they are not."""

from collections.abc import Callable, Iterator

from rtron.sources.code.interpreter.abstract_values.items import items_of
from rtron.sources.code.interpreter.abstract_values.value_types import (
    Hole,
    Instance,
    Known,
    Text,
    Value,
    truth,
)
from rtron.sources.code.interpreter.execution.abstract_machine import Machine, Outcome
from rtron.sources.code.interpreter.execution.assignment import assign, place_of
from rtron.sources.code.interpreter.execution.stack_frame import Frame
from rtron.sources.code.ir import Expr, ForEach, Name, While
from rtron.sources.code.ir.references import assigned_names

MAX_ROUNDS = (128, 32, 8, 2)
"""How often a loop is unrolled: an outermost one, one within it, and so on."""
MAX_DISCOVERIES = 2

_LEAVES = {"return", "raise"}


def for_each(machine: Machine, node: ForEach, frame: Frame) -> Outcome:
    """Run `for target in iterable`."""
    items, certain = items_of(machine.evaluate(node.iterable, frame))
    if machine.world.by_reference and _changes_items(node):
        place = place_of(machine, node.iterable, frame)
        if place is not None:
            machine.trail.set(*place, Hole(str(place.key)))
    with machine.looping() as depth:
        most = _rounds(depth)
        for item in items[:most]:
            assign(machine, node.target, item, frame)
            outcome = machine.execute(node.body, frame)
            if outcome == "break":
                return None
            if outcome in _LEAVES:
                return outcome
        if not certain or len(items) > most:
            written = assigned_names(node.body)
            in_doubt(machine, frame, lambda: _round(machine, node, frame), written)
    return None


def _changes_items(node: ForEach) -> bool:
    """`for (auto& item : items) item = …`: what the items are then is left open."""
    return named(node.target) in assigned_names(node.body)


def _rounds(depth: int) -> int:
    return MAX_ROUNDS[min(depth, len(MAX_ROUNDS)) - 1]


def named(target: Expr) -> str:
    """Return what a loop's unknown item is called."""
    return target.id if isinstance(target, Name) else "?"


def _round(machine: Machine, node: ForEach, frame: Frame) -> Outcome:
    hole = Hole(named(node.target))
    assign(machine, node.target, hole, frame)
    return machine.execute(node.body, frame)


def while_(machine: Machine, node: While, frame: Frame) -> Outcome:
    """Run `while`, `do … while` and `for (;;)`."""
    if node.first:
        outcome = machine.execute(node.body, frame)
        if outcome not in {None, "continue"}:
            return outcome if outcome in _LEAVES else None
    with machine.looping() as depth:
        return _turns(machine, node, frame, _rounds(depth))


def _turns(machine: Machine, node: While, frame: Frame, most: int) -> Outcome:
    for _ in range(most):
        decided = truth(machine.evaluate(node.test, frame))
        if decided is None:
            break
        outcome = machine.execute(node.body, frame) if decided else "break"
        if outcome == "break":
            return None
        if outcome in _LEAVES:
            return outcome
        machine.execute(node.step, frame)
    written = assigned_names(node.body) | assigned_names(node.step)
    in_doubt(machine, frame, lambda: machine.execute(node.body + node.step, frame), written)
    return None


def in_doubt(
    machine: Machine,
    frame: Frame,
    run: Callable[[], Outcome],
    written: frozenset[str] | None = None,
) -> None:
    """Run a loop's body once, what it counts made unknown first.

    What it counts is found by a trial, or is what of `written` holds a number or a string.
    """
    if written is not None and machine.recorder.site.ros > 1:
        _unknown(machine, frame, written)
    elif machine.discovering < MAX_DISCOVERIES:
        for place, key, value in list(_changed(machine, run)):
            machine.trail.set(place, key, value)
    machine.trail.either([lambda: run() is None, lambda: True], frame.variables)


def _unknown(machine: Machine, frame: Frame, written: frozenset[str]) -> None:
    for name in written:
        place, key = machine.world.place(name, frame)
        if _is_scalar(place.get(key)):
            machine.trail.set(place, key, Hole(str(key)))


def _changed(
    machine: Machine, run: Callable[[], Outcome]
) -> Iterator[tuple[dict[object, object], object, Value]]:
    """Yield the places whose number or string the body changes, with a hole for each."""
    with machine.unheard():
        writes, _ = machine.trail.trial(lambda: run() is None)
    for place, key, after in writes.values():
        before = place.get(key)
        if _is_scalar(before) and _is_scalar(after) and before != after:
            yield place, key, Hole(str(key))


def _is_scalar(value: object) -> bool:
    return isinstance(value, (Known, Text)) and not isinstance(value, Instance)
