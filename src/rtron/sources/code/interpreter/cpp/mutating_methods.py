"""Methods of C++ that change the variable itself: smart pointers and strings.

A smart pointer is kept as what it points at and a string as its value, so that `p.reset(x)` and
`s.append(x)` are writes to the slots of `p` and `s`.
"""

from rtron.sources.code import ir
from rtron.sources.code.interpreter import abstract_values as av
from rtron.sources.code.interpreter.cpp.held_values import emplace
from rtron.sources.code.interpreter.execution.abstract_machine import AbstractMachine
from rtron.sources.code.interpreter.execution.assignment import slot_of
from rtron.sources.code.interpreter.execution.stack_frame import StackFrame

POINTER_METHODS = frozenset({"get", "lock", "release", "toStrongRef"})
_OPTIONAL_METHODS = frozenset({"value", "has_value", "value_or"})
_WRITING_METHODS = frozenset(
    ["reset", "append", "push_back", "pop_back", "assign", "clear", "erase", "insert", "replace"]
)


def mutate(machine: AbstractMachine, node: ir.Call, frame: StackFrame) -> av.Value | None:
    """Do a call that writes to its owner's slot; None for every other call."""
    if not isinstance(node.function, ir.Attr):
        return None
    name = node.function.name
    if name in POINTER_METHODS and not node.args:
        return _pointed_value(machine, node.function, frame)
    if name in _OPTIONAL_METHODS:
        return _optional_value(machine, node, node.function, frame)
    if name not in _WRITING_METHODS and not (name == "emplace" and node.args):
        return None
    owner = machine.evaluate(node.function.owner, frame)
    if any(machine.runtime.attribute(option, name, ()) is not None for option in av.options(owner)):
        return None
    if name == "emplace":
        new = emplace(machine, node, frame)
    else:
        new = _new_value(name, owner, [machine.evaluate(arg, frame) for arg in node.args])
    return _write(machine, node.function, new, frame)


def _pointed_value(
    machine: AbstractMachine, function: ir.Attr, frame: StackFrame
) -> av.Value | None:
    owner = machine.evaluate(function.owner, frame)
    own = any(machine.runtime.attribute(option, function.name, ()) for option in av.options(owner))
    return None if own else owner


def _optional_value(
    machine: AbstractMachine, node: ir.Call, function: ir.Attr, frame: StackFrame
) -> av.Value | None:
    """`value()`, `has_value()`, `value_or(x)` of a std::optional, which is what it holds."""
    held = machine.evaluate(function.owner, frame)
    kinds = (av.Scalar, av.PartialText)
    if not all(isinstance(option, kinds) for option in av.options(held)):
        return None
    filled = truth_of_optional(held)
    if function.name == "has_value":
        return av.Scalar(filled) if filled is not None else av.Unknown("has_value")
    if function.name == "value" or filled:
        return held
    other = machine.evaluate(node.args[0], frame) if node.args else av.NONE
    return av.join([*(one for one in av.options(held) if one != av.NONE), other])


def truth_of_optional(held: av.Value) -> bool | None:
    """Tell whether a std::optional holds anything: 0 and an empty string are something."""
    answers = {option != av.NONE for option in av.options(held)}
    return answers.pop() if len(answers) == 1 else None


def _write(
    machine: AbstractMachine, function: ir.Attr, new: av.Value, frame: StackFrame
) -> av.Value:
    slot = slot_of(machine, function.owner, frame)
    if slot is not None:
        machine.undo_log.set(*slot, new)
    return new


def _new_value(name: str, owner: av.Value, values: list[av.Value]) -> av.Value:
    if name == "reset":
        return values[0] if values else av.NONE
    if name == "clear":
        return av.Scalar("") if av.is_text(owner) else owner
    if name in {"append", "push_back"} and av.is_text(owner) and values:
        return av.concat((owner, values[0]))
    if name == "assign" and values:
        return values[0]
    return _edit_text(name, owner, values)


def _edit_text(name: str, owner: av.Value, values: list[av.Value]) -> av.Value:
    """`s.erase(at, count)`, `s.insert(at, text)`, `s.replace(at, count, text)`, `s.pop_back()`."""
    known = [value.value for value in values if isinstance(value, av.Scalar)]
    if not isinstance(owner, av.Scalar) or len(known) != len(values):
        return av.Unknown(name)
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
            return av.Unknown(name)
    return av.Scalar(text, owner.tainted)
