"""Loops: unrolled where the rounds are known, run once in doubt where they are not."""

from collections.abc import Callable, Iterator

from rtron.sources.code.interpreter.abstract_values.value_types import (
    Instance,
    PartialText,
    Scalar,
    Unknown,
    Value,
)
from rtron.sources.code.interpreter.execution.abstract_machine import AbstractMachine, Outcome
from rtron.sources.code.interpreter.execution.assignment import assign, slot_of
from rtron.sources.code.interpreter.execution.calls import truth_of
from rtron.sources.code.interpreter.execution.stack_frame import StackFrame
from rtron.sources.code.ir import Expr, ForEach, Name, While
from rtron.sources.code.ir.references import assigned_names

MAX_ROUNDS = (128, 32, 8, 2)
"""How often a loop is unrolled: an outermost one, one within it, and so on."""
MAX_DISCOVERIES = 2

_EXITS = {"return", "raise"}


def for_each(machine: AbstractMachine, node: ForEach, frame: StackFrame) -> Outcome:
    """Run `for target in iterable`."""
    items, certain = machine.runtime.iterate(machine.evaluate(node.iterable, frame))
    if machine.runtime.passes_by_reference and _changes_items(node):
        slot = slot_of(machine, node.iterable, frame)
        if slot is not None:
            machine.undo_log.set(*slot, Unknown(slot.label))
    with machine.enter_loop() as depth:
        most = _max_rounds(depth)
        for item in items[:most]:
            assign(machine, node.target, item, frame)
            outcome = machine.execute(node.body, frame)
            if outcome == "break":
                return None
            if outcome in _EXITS:
                return outcome
        is_whole = certain and len(items) <= most
        if not is_whole:
            written = assigned_names(node.body)
            run_once_with_unknowns(
                machine, frame, lambda: _run_unknown_round(machine, node, frame), written
            )
    return _run_else(machine, node, frame, is_reached=is_whole)


def _run_else(
    machine: AbstractMachine, node: ForEach | While, frame: StackFrame, *, is_reached: bool
) -> Outcome:
    """Run the `else` of a loop that no `break` has left, as far as that is known."""
    if is_reached or not node.orelse:
        return machine.execute(node.orelse, frame)
    machine.undo_log.run_branches(
        [lambda: machine.execute(node.orelse, frame) is None, lambda: True], frame.variables
    )
    return None


def _changes_items(node: ForEach) -> bool:
    """`for (auto& item : items) item = …`: what the items are then is left open."""
    return target_name(node.target) in assigned_names(node.body)


def _max_rounds(depth: int) -> int:
    return MAX_ROUNDS[min(depth, len(MAX_ROUNDS)) - 1]


def target_name(target: Expr) -> str:
    """Return what a loop's unknown item is called."""
    return target.id if isinstance(target, Name) else "?"


def _run_unknown_round(machine: AbstractMachine, node: ForEach, frame: StackFrame) -> Outcome:
    hole = Unknown(target_name(node.target))
    assign(machine, node.target, hole, frame)
    return machine.execute(node.body, frame)


def while_(machine: AbstractMachine, node: While, frame: StackFrame) -> Outcome:
    """Run `while`, `do … while` and `for (;;)`."""
    if node.first:
        outcome = machine.execute(node.body, frame)
        if outcome not in {None, "continue"}:
            return outcome if outcome in _EXITS else None
    with machine.enter_loop() as depth:
        return _run_rounds(machine, node, frame, _max_rounds(depth))


def _run_rounds(machine: AbstractMachine, node: While, frame: StackFrame, most: int) -> Outcome:
    for _ in range(most):
        decided = truth_of(machine, machine.evaluate(node.test, frame))
        if decided is None:
            break
        if not decided:
            return _run_else(machine, node, frame, is_reached=True)
        outcome = machine.execute(node.body, frame)
        if outcome == "break":
            return None
        if outcome in _EXITS:
            return outcome
        machine.execute(node.step, frame)
    written = assigned_names(node.body) | assigned_names(node.step)
    run_once_with_unknowns(
        machine, frame, lambda: machine.execute(node.body + node.step, frame), written
    )
    return _run_else(machine, node, frame, is_reached=False)


def run_once_with_unknowns(
    machine: AbstractMachine,
    frame: StackFrame,
    run: Callable[[], Outcome],
    written: frozenset[str] | None = None,
) -> None:
    """Run a loop's body once, what it counts made unknown first.

    What it counts is found by a trial, or is what of `written` holds a number or a string.
    """
    if written is not None and machine.recorder.site.ros > 1:
        _forget_scalars(machine, frame, written)
    elif machine.trial_depth < MAX_DISCOVERIES:
        for storage, key, value in list(_changed_scalars(machine, run)):
            machine.undo_log.set(storage, key, value)
    machine.undo_log.run_branches([lambda: run() is None, lambda: True], frame.variables)


def _forget_scalars(machine: AbstractMachine, frame: StackFrame, written: frozenset[str]) -> None:
    for name in written:
        storage, key = machine.runtime.slot(name, frame)
        if _is_scalar(storage.get(key)):
            machine.undo_log.set(storage, key, Unknown(str(key)))


def _changed_scalars(
    machine: AbstractMachine, run: Callable[[], Outcome]
) -> Iterator[tuple[dict[object, object], object, Value]]:
    """Yield the slots whose number or string the body changes, with an Unknown for each."""
    with machine.trial_run():
        writes, _ = machine.undo_log.run_and_undo(lambda: run() is None)
    for storage, key, after in writes.values():
        before = storage.get(key)
        if _is_scalar(before) and _is_scalar(after) and before != after:
            yield storage, key, Unknown(str(key))


def _is_scalar(value: object) -> bool:
    return isinstance(value, (Scalar, PartialText)) and not isinstance(value, Instance)
