"""Methods of C++ that change the variable itself: smart pointers and strings.

A smart pointer is kept as what it points at and a string as its value, so that `p.reset(x)` and
`s.append(x)` are writes to the place of `p` and `s`.
"""

from rtron.sources.code.interpreter.abstract_values.value_types import (
    NONE,
    Hole,
    Known,
    Text,
    Value,
    concat,
    options,
)
from rtron.sources.code.interpreter.execution.abstract_machine import Machine
from rtron.sources.code.interpreter.execution.assignment import place_of
from rtron.sources.code.interpreter.execution.stack_frame import Frame
from rtron.sources.code.ir import Attr, Call

POINTER_METHODS = frozenset({"get", "lock", "release", "toStrongRef"})
_WRITERS = frozenset(
    ["reset", "append", "push_back", "pop_back", "assign", "clear", "erase", "insert", "replace"]
)


def mutate(machine: Machine, node: Call, frame: Frame) -> Value | None:
    """Do a call that changes its owner's place; None for every other call."""
    if not isinstance(node.function, Attr):
        return None
    name = node.function.name
    if name in POINTER_METHODS and not node.args:
        return _pointee(machine, node.function, frame)
    if name not in _WRITERS:
        return None
    owner = machine.evaluate(node.function.owner, frame)
    if any(machine.world.attribute(option, name, ()) is not None for option in options(owner)):
        return None
    values = [machine.evaluate(arg, frame) for arg in node.args]
    return _write(machine, node.function, owner, values, frame)


def _pointee(machine: Machine, function: Attr, frame: Frame) -> Value | None:
    owner = machine.evaluate(function.owner, frame)
    own = any(machine.world.attribute(option, function.name, ()) for option in options(owner))
    return None if own else owner


def _write(
    machine: Machine, function: Attr, owner: Value, values: list[Value], frame: Frame
) -> Value:
    place = place_of(machine, function.owner, frame)
    new = _changed(function.name, owner, values)
    if place is not None:
        machine.trail.set(*place, new)
    return new


def _changed(name: str, owner: Value, values: list[Value]) -> Value:
    if name == "reset":
        return values[0] if values else NONE
    if name == "clear":
        return Known("") if _is_text(owner) else owner
    if name in {"append", "push_back"} and _is_text(owner) and values:
        return concat((owner, values[0]))
    if name == "assign" and values:
        return values[0]
    return _edited(name, owner, values)


def _edited(name: str, owner: Value, values: list[Value]) -> Value:
    """`s.erase(at, count)`, `s.insert(at, text)`, `s.replace(at, count, text)`, `s.pop_back()`."""
    known = [value.value for value in values if isinstance(value, Known)]
    if not isinstance(owner, Known) or len(known) != len(values):
        return Hole(name)
    text = str(owner.value)
    match name, known:
        case "pop_back", []:
            text = text[:-1]
        case "erase", [int(at)]:
            text = text[:at]
        case "erase", [int(at), int(count)]:
            text = text[:at] + (text[at + count :] if count >= 0 else "")
        case "insert", [int(at), str(added)]:
            text = text[:at] + added + text[at:]
        case "replace", [int(at), int(count), str(added)]:
            text = text[:at] + added + text[at + count :]
        case _:
            return Hole(name)
    return Known(text, owner.tainted)


def _is_text(value: Value) -> bool:
    return isinstance(value, Text) or (isinstance(value, Known) and isinstance(value.value, str))
