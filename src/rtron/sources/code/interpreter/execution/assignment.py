"""Writes to variables, members and elements."""

from dataclasses import replace

from rtron.sources.code.interpreter.abstract_values.elements import is_slice, slice_of
from rtron.sources.code.interpreter.abstract_values.items import items_of, unpack, unpack_with_rest
from rtron.sources.code.interpreter.abstract_values.value_types import (
    OPEN,
    ClassValue,
    FunctionValue,
    Instance,
    ListValue,
    MapValue,
    ModuleValue,
    Scalar,
    Unknown,
    Value,
    is_text,
    join,
    options,
)
from rtron.sources.code.interpreter.cpp.iterators import write_through
from rtron.sources.code.interpreter.execution.abstract_machine import AbstractMachine
from rtron.sources.code.interpreter.execution.arguments import Arguments
from rtron.sources.code.interpreter.execution.stack_frame import StackFrame, StorageSlot
from rtron.sources.code.ir import Attr, Expr, Index, Name, SequenceExpr, Star


def assign(machine: AbstractMachine, target: Expr, value: Value, frame: StackFrame) -> None:
    """Write a value to what an expression names; what cannot be written to is left."""
    if isinstance(target, Name):
        slot = _target_slot(machine, target.id, frame)
        if not write_through(machine, slot.holder.get(slot.key), value):
            machine.undo_log.set(*slot, value)
    elif isinstance(target, SequenceExpr):
        for item, part in zip(target.items, _unpack_parts(target, value), strict=True):
            assign(machine, item, part, frame)
    elif isinstance(target, Star):
        assign(machine, target.value, value, frame)
    elif isinstance(target, Attr):
        _assign_member(machine, target, value, frame)
    elif isinstance(target, Index):
        _assign_element(machine, target, value, frame)


def _target_slot(machine: AbstractMachine, name: str, frame: StackFrame) -> StorageSlot:
    """Return where a name is kept that is written to: what hides a constant is another variable."""
    if machine.runtime.is_constant(name, frame):
        frame.constants[name] = False
        frame.aliases.pop(name, None)
        return StorageSlot(frame.variables, name)
    return machine.runtime.slot(name, frame)


def slot_of(machine: AbstractMachine, node: Expr, frame: StackFrame) -> StorageSlot | None:
    """Return where the value of an expression is kept; None for one that is kept nowhere."""
    if isinstance(node, Name):
        return machine.runtime.slot(node.id, frame)
    if isinstance(node, Attr):
        owner = machine.evaluate(node.owner, frame)
        return StorageSlot(owner.fields, node.name) if isinstance(owner, Instance) else None
    if isinstance(node, Index):
        return _element_slot(machine, node, frame)
    return None


def _element_slot(machine: AbstractMachine, node: Index, frame: StackFrame) -> StorageSlot | None:
    owner, key = machine.evaluate(node.owner, frame), machine.evaluate(node.key, frame)
    if isinstance(owner, MapValue) and isinstance(key, Scalar):
        return StorageSlot(owner.fields, key.value)
    return None


def _unpack_parts(target: SequenceExpr, value: Value) -> tuple[Value, ...]:
    stars = [at for at, item in enumerate(target.items) if isinstance(item, Star)]
    if not stars:
        return unpack(value, len(target.items))
    return unpack_with_rest(value, stars[0], len(target.items) - stars[0] - 1)


def _assign_member(machine: AbstractMachine, target: Attr, value: Value, frame: StackFrame) -> None:
    owners = options(machine.evaluate(target.owner, frame))
    for owner in owners:
        setter = _setter(machine, owner, target.name)
        if setter is not None:
            machine.call(setter, Arguments(values=(value,), frame=frame))
        elif isinstance(owner, (Instance, ClassValue, ModuleValue)):
            before = owner.fields.get(target.name)
            new = value if len(owners) == 1 or before is None else join([before, value])
            machine.undo_log.set(owner.fields, target.name, new)


def _setter(machine: AbstractMachine, owner: Value, name: str) -> FunctionValue | None:
    """Return the function of a Python property that an assignment calls."""
    for cls in machine.runtime.lineage(owner.type) if isinstance(owner, Instance) else ():
        found = cls.fields.get(name) if isinstance(cls, ClassValue) else None
        setter = found.fields.get("setter") if isinstance(found, Instance) else None
        if isinstance(setter, FunctionValue):
            return replace(setter, owner=owner)
    return None


def _assign_element(
    machine: AbstractMachine, target: Index, value: Value, frame: StackFrame
) -> None:
    key = machine.evaluate(target.key, frame)
    for owner in options(machine.evaluate(target.owner, frame)):
        if isinstance(owner, MapValue):
            name = key.value if isinstance(key, Scalar) else OPEN
            machine.undo_log.set(owner.fields, name, value)
        elif isinstance(owner, ListValue):
            (_assign_slice if is_slice(key) else _assign_item)(machine, owner, key, value)
        elif is_text(owner):
            _assign_character(machine, target, frame)


def _assign_character(machine: AbstractMachine, target: Index, frame: StackFrame) -> None:
    """`s[0] = 'x'`: what the string is then is left open."""
    slot = slot_of(machine, target.owner, frame)
    if slot is not None:
        machine.undo_log.set(*slot, Unknown(str(slot.key)))


def remove_element(machine: AbstractMachine, owner: Value, key: Value) -> None:
    """Take an element away; which one is not known where the key is not."""
    if isinstance(owner, MapValue) and isinstance(key, Scalar):
        remaining = {name: value for name, value in owner.fields.items() if name != key.value}
        for name in set(owner.fields) - set(remaining):
            machine.undo_log.remove(owner.fields, name)
    elif isinstance(owner, ListValue) and isinstance(key, Scalar) and isinstance(key.value, int):
        items = list(owner.items)
        if -len(items) <= key.value < len(items):
            del items[key.value]
            machine.undo_log.set(owner.fields, "items", tuple(items))
    elif isinstance(owner, ListValue) and is_slice(key):
        _assign_slice(machine, owner, key, ListValue())


def _assign_slice(machine: AbstractMachine, owner: ListValue, key: Value, value: Value) -> None:
    """`a[i:j] = b`; where i, j or b are not known, the list may hold all of both."""
    (given, certain), items = items_of(value), list(owner.items)
    bounds = slice_of(key) or slice(len(items), None)
    try:
        items[bounds] = given
    except ValueError:
        certain = False
    if slice_of(key) is None or not certain:
        machine.undo_log.mark_open(owner.fields)
    machine.undo_log.set(owner.fields, "items", tuple(items))


def _assign_item(machine: AbstractMachine, owner: ListValue, key: Value, value: Value) -> None:
    items = list(owner.items)
    if (
        isinstance(key, Scalar)
        and isinstance(key.value, int)
        and -len(items) <= key.value < len(items)
    ):
        items[key.value] = value
    else:
        items.append(value)
        machine.undo_log.mark_open(owner.fields)
    machine.undo_log.set(owner.fields, "items", tuple(items))
