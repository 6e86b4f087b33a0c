"""Loops: unrolled where the rounds are known, run once in doubt where they are not."""

from collections.abc import Callable, Iterator

from rtron.sources.code.interpreter.abstract_values.items import list_of
from rtron.sources.code.interpreter.abstract_values.value_types import (
    UNKNOWN,
    Instance,
    ListValue,
    PartialText,
    Scalar,
    Unknown,
    Value,
    is_tainted,
)
from rtron.sources.code.interpreter.execution.abstract_machine import AbstractMachine, Outcome
from rtron.sources.code.interpreter.execution.assignment import assign, slot_of
from rtron.sources.code.interpreter.execution.calls import truth_of
from rtron.sources.code.interpreter.execution.stack_frame import StackFrame, StorageSlot
from rtron.sources.code.ir import Expr, ForEach, Name, SequenceExpr, While
from rtron.sources.code.ir.references import assigned_names

MAX_ROUNDS = (128, 32, 8, 2)
"""How often a loop is unrolled: an outermost one, one within it, and so on."""
MAX_DISCOVERIES = 2

_EXITS = {"return", "raise"}


def for_each(machine: AbstractMachine, node: ForEach, frame: StackFrame) -> Outcome:
    """Run `for target in iterable`."""
    before = machine.evaluate(node.iterable, frame)
    items, certain = machine.runtime.iterate(before)
    slot = slot_of(machine, node.iterable, frame) if _changes_items(node) else None
    if slot is not None:
        machine.undo_log.set(*slot, Unknown(slot.label))
    changed: list[Value] = []
    with machine.enter_loop() as depth:
        most = _max_rounds(depth)
        for item in items[:most]:
            assign(machine, node.target, item, frame)
            outcome = machine.execute(node.body, frame)
            if outcome == "break":
                return None
            if outcome in _EXITS:
                return outcome
            changed += [_held_by(machine, node.target, frame)] if slot is not None else []
        is_whole = certain and len(items) <= most
        if slot is not None and is_whole:
            _write_items(machine, slot, before, changed)
        elif not is_whole:
            written = assigned_names(node.body)
            run_once_with_unknowns(
                machine, frame, lambda: _run_unknown_round(machine, node, frame), written
            )
    return _run_else(machine, node, frame, is_reached=is_whole)


def _held_by(machine: AbstractMachine, target: Expr, frame: StackFrame) -> Value:
    slot = slot_of(machine, target, frame)
    return slot.holder.get(slot.key, UNKNOWN) if slot is not None else UNKNOWN


def _write_items(
    machine: AbstractMachine, slot: StorageSlot, before: Value, changed: list[Value]
) -> None:
    """Let a text or a list hold what a loop made of its items, as far as that is known."""
    letters = [item.value for item in changed if isinstance(item, Scalar)]
    if isinstance(before, ListValue):
        machine.undo_log.set(before.fields, "items", tuple(changed))
        machine.undo_log.set(*slot, before)
    elif len(letters) == len(changed) and all(isinstance(letter, str) for letter in letters):
        machine.undo_log.set(*slot, Scalar("".join(letters), is_tainted(before)))


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
    """Tell whether a loop writes to the items: `for (auto& item : items) item = …`."""
    return node.reference and target_name(node.target) in assigned_names(node.body)


def _max_rounds(depth: int) -> int:
    return MAX_ROUNDS[min(depth, len(MAX_ROUNDS)) - 1]


def target_name(target: Expr) -> str:
    """Return what a loop's unknown item is called."""
    return target.id if isinstance(target, Name) else "?"


def _run_unknown_round(machine: AbstractMachine, node: ForEach, frame: StackFrame) -> Outcome:
    assign(machine, node.target, _unknown_item(node.target), frame)
    return machine.execute(node.body, frame)


def _unknown_item(target: Expr) -> Value:
    """Return an item that is not known, named as its variable is; of several each by its own."""
    if isinstance(target, SequenceExpr):
        return list_of(tuple(map(_unknown_item, target.items)), "tuple")
    return Unknown(target_name(target))


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
    with machine.undo_log.gather_writes() as writes:
        machine.undo_log.run_branches([lambda: run() is None, lambda: True], frame.variables)
    for storage, key, before in writes:
        after = storage.get(key)
        if isinstance(before, tuple) and isinstance(after, tuple) and len(after) > len(before):
            machine.undo_log.mark_open(storage)


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
