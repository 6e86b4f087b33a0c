"""Writes to variables, members and elements."""

from dataclasses import replace

from rtron.sources.code.interpreter.abstract_values.elements import is_slice, slice_of
from rtron.sources.code.interpreter.abstract_values.items import items_of, unpacked, unpacked_around
from rtron.sources.code.interpreter.abstract_values.value_types import (
    OPEN,
    ClassValue,
    FunctionValue,
    Hole,
    Instance,
    Known,
    ListValue,
    MapValue,
    ModuleValue,
    Value,
    is_text,
    join,
    options,
)
from rtron.sources.code.interpreter.cpp.iterators import written
from rtron.sources.code.interpreter.execution.abstract_machine import Machine
from rtron.sources.code.interpreter.execution.arguments import Arguments
from rtron.sources.code.interpreter.execution.stack_frame import Frame, Place
from rtron.sources.code.ir import Attr, Expr, Index, Name, Sequence, Star


def assign(machine: Machine, target: Expr, value: Value, frame: Frame) -> None:
    """Write a value to what an expression names; what cannot be written to is left."""
    if isinstance(target, Name):
        place = _assigned(machine, target.id, frame)
        if not written(machine, place.holder.get(place.key), value):
            machine.trail.set(*place, value)
    elif isinstance(target, Sequence):
        for item, part in zip(target.items, _parts(target, value), strict=True):
            assign(machine, item, part, frame)
    elif isinstance(target, Star):
        assign(machine, target.value, value, frame)
    elif isinstance(target, Attr):
        _assign_member(machine, target, value, frame)
    elif isinstance(target, Index):
        _assign_element(machine, target, value, frame)


def _assigned(machine: Machine, name: str, frame: Frame) -> Place:
    """Return where a name is kept that is written to: what hides a constant is another variable."""
    if machine.world.is_constant(name, frame):
        frame.constants[name] = False
        frame.aliases.pop(name, None)
        return Place(frame.variables, name)
    return machine.world.place(name, frame)


def place_of(machine: Machine, node: Expr, frame: Frame) -> Place | None:
    """Return where the value of an expression is kept; None for one that is kept nowhere."""
    if isinstance(node, Name):
        return machine.world.place(node.id, frame)
    if isinstance(node, Attr):
        owner = machine.evaluate(node.owner, frame)
        return Place(owner.fields, node.name) if isinstance(owner, Instance) else None
    if isinstance(node, Index):
        return _place_of_element(machine, node, frame)
    return None


def _place_of_element(machine: Machine, node: Index, frame: Frame) -> Place | None:
    owner, key = machine.evaluate(node.owner, frame), machine.evaluate(node.key, frame)
    if isinstance(owner, MapValue) and isinstance(key, Known):
        return Place(owner.fields, key.value)
    return None


def _parts(target: Sequence, value: Value) -> tuple[Value, ...]:
    stars = [at for at, item in enumerate(target.items) if isinstance(item, Star)]
    if not stars:
        return unpacked(value, len(target.items))
    return unpacked_around(value, stars[0], len(target.items) - stars[0] - 1)


def _assign_member(machine: Machine, target: Attr, value: Value, frame: Frame) -> None:
    owners = options(machine.evaluate(target.owner, frame))
    for owner in owners:
        setter = _setter(machine, owner, target.name)
        if setter is not None:
            machine.call(setter, Arguments(values=(value,), frame=frame))
        elif isinstance(owner, (Instance, ClassValue, ModuleValue)):
            before = owner.fields.get(target.name)
            new = value if len(owners) == 1 or before is None else join([before, value])
            machine.trail.set(owner.fields, target.name, new)


def _setter(machine: Machine, owner: Value, name: str) -> FunctionValue | None:
    """Return the function of a Python property that an assignment calls."""
    for cls in machine.world.lineage(owner.type) if isinstance(owner, Instance) else ():
        found = cls.fields.get(name) if isinstance(cls, ClassValue) else None
        setter = found.fields.get("setter") if isinstance(found, Instance) else None
        if isinstance(setter, FunctionValue):
            return replace(setter, owner=owner)
    return None


def _assign_element(machine: Machine, target: Index, value: Value, frame: Frame) -> None:
    key = machine.evaluate(target.key, frame)
    for owner in options(machine.evaluate(target.owner, frame)):
        if isinstance(owner, MapValue):
            name = key.value if isinstance(key, Known) else OPEN
            machine.trail.set(owner.fields, name, value)
        elif isinstance(owner, ListValue):
            (_assign_slice if is_slice(key) else _assign_item)(machine, owner, key, value)
        elif is_text(owner):
            _assign_letter(machine, target, frame)


def _assign_letter(machine: Machine, target: Index, frame: Frame) -> None:
    """`s[0] = 'x'`: what the string is then is left open."""
    place = place_of(machine, target.owner, frame)
    if place is not None:
        machine.trail.set(*place, Hole(str(place.key)))


def remove(machine: Machine, owner: Value, key: Value) -> None:
    """Take an element away; which one is not known where the key is not."""
    if isinstance(owner, MapValue) and isinstance(key, Known):
        kept = {name: value for name, value in owner.fields.items() if name != key.value}
        for name in set(owner.fields) - set(kept):
            machine.trail.remove(owner.fields, name)
    elif isinstance(owner, ListValue) and isinstance(key, Known) and isinstance(key.value, int):
        items = list(owner.items)
        if -len(items) <= key.value < len(items):
            del items[key.value]
            machine.trail.set(owner.fields, "items", tuple(items))
    elif isinstance(owner, ListValue) and is_slice(key):
        _assign_slice(machine, owner, key, ListValue())


def _assign_slice(machine: Machine, owner: ListValue, key: Value, value: Value) -> None:
    """`a[i:j] = b`; where the ends or b are not known, the list may hold all of both."""
    (given, certain), items = items_of(value), list(owner.items)
    places = slice_of(key) or slice(len(items), None)
    try:
        items[places] = given
    except ValueError:
        certain = False
    if slice_of(key) is None or not certain:
        machine.trail.open(owner.fields)
    machine.trail.set(owner.fields, "items", tuple(items))


def _assign_item(machine: Machine, owner: ListValue, key: Value, value: Value) -> None:
    items = list(owner.items)
    if (
        isinstance(key, Known)
        and isinstance(key.value, int)
        and -len(items) <= key.value < len(items)
    ):
        items[key.value] = value
    else:
        items.append(value)
        machine.trail.open(owner.fields)
    machine.trail.set(owner.fields, "items", tuple(items))
