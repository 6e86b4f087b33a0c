"""The value of each kind of expression."""

from collections.abc import Callable
from collections.abc import Mapping as MappingType

from rtron.sources.code.interpreter.abstract_values.elements import element
from rtron.sources.code.interpreter.abstract_values.items import items_of, list_of
from rtron.sources.code.interpreter.abstract_values.operators import binary, unary
from rtron.sources.code.interpreter.abstract_values.value_types import (
    OPEN,
    UNKNOWN,
    Choice,
    FunctionValue,
    Instance,
    MapValue,
    Scalar,
    Unknown,
    Value,
    concat,
    join,
    options,
    truth,
)
from rtron.sources.code.interpreter.execution.abstract_machine import AbstractMachine
from rtron.sources.code.interpreter.execution.arguments import Arguments, evaluate_defaults
from rtron.sources.code.interpreter.execution.assignment import assign, slot_of
from rtron.sources.code.interpreter.execution.calls import call, dispatch
from rtron.sources.code.interpreter.execution.exceptions import operands_fit
from rtron.sources.code.interpreter.execution.language_runtime import cpp_runtime
from rtron.sources.code.interpreter.execution.loops import target_name
from rtron.sources.code.interpreter.execution.stack_frame import StackFrame
from rtron.sources.code.ir import (
    Attr,
    Binary,
    Call,
    Comprehension,
    Concat,
    Conditional,
    Const,
    Expr,
    Index,
    Lambda,
    Logic,
    MappingExpr,
    Name,
    New,
    Opaque,
    SequenceExpr,
    Star,
    Unary,
)

MAX_ITEMS = 256


def _name(machine: AbstractMachine, node: Name, frame: StackFrame) -> Value:
    return machine.runtime.lookup(node, frame)


def _attr(machine: AbstractMachine, node: Attr, frame: StackFrame) -> Value:
    owner = machine.evaluate(node.owner, frame)
    if isinstance(owner, Choice):
        return join([_member(machine, option, node) for option in owner.options])
    return _member(machine, owner, node)


def _member(machine: AbstractMachine, owner: Value, node: Attr) -> Value:
    found = machine.runtime.attribute(owner, node.name, node.types)
    return Unknown(node.name) if found is None else found


def _index(machine: AbstractMachine, node: Index, frame: StackFrame) -> Value:
    owner, key = machine.evaluate(node.owner, frame), machine.evaluate(node.key, frame)
    if isinstance(owner, MapValue) and isinstance(key, Scalar):
        _insert_default(machine, owner, key)
        _note_missing(machine, owner, key, frame)
    return join([element(one, other) for one in options(owner) for other in options(key)])


def _insert_default(machine: AbstractMachine, owner: MapValue, key: Scalar) -> None:
    """`m[key]` makes an entry where std::map has none."""
    if owner.default_factory is not None and not owner.open and key.value not in owner.fields:
        machine.undo_log.set(owner.fields, key.value, owner.default_factory())


def _note_missing(
    machine: AbstractMachine, owner: MapValue, key: Scalar, frame: StackFrame
) -> None:
    note = None if key.value in owner.fields else owner.missing_note(key.value)
    if note:
        place = Arguments(values=(), slots=(), line=0, frame=frame)
        machine.recorder.add_unresolved(*note, place.evidence)


def _new(machine: AbstractMachine, node: New, frame: StackFrame) -> Value:
    return cpp_runtime(machine).new(node, frame)


def _binary(machine: AbstractMachine, node: Binary, frame: StackFrame) -> Value:
    left, right = machine.evaluate(node.left, frame), machine.evaluate(node.right, frame)
    overloaded = _overloaded_operator(machine, node, left)
    if overloaded is not None:
        slots = (slot_of(machine, node.right, frame),)
        arguments = Arguments(values=(right,), slots=slots, line=node.line, frame=frame)
        return dispatch(machine, overloaded, arguments)
    machine.possible_throws += not (
        machine.runtime.passes_by_reference or operands_fit(node.operator, left, right)
    )
    if (
        node.operator == ">>"
        and machine.runtime.passes_by_reference
        and not isinstance(left, Scalar)
    ):
        _read_into(machine, node.right, frame)
    if node.operator == "/" and machine.runtime.passes_by_reference and _are_integers(left, right):
        return binary("//", left, right)
    return binary(node.operator, left, right)


def _are_integers(left: Value, right: Value) -> bool:
    """C++ divides whole numbers to a whole number."""
    return all(isinstance(side, Scalar) and isinstance(side.value, int) for side in (left, right))


def _read_into(machine: AbstractMachine, target: Expr, frame: StackFrame) -> None:
    """`stream >> variable` of an unknown stream."""
    slot = slot_of(machine, target, frame)
    if slot is not None:
        machine.undo_log.set(*slot, Unknown(str(slot.key)))


def _overloaded_operator(machine: AbstractMachine, node: Binary, left: Value) -> Value | None:
    if not isinstance(left, Instance):
        return None
    return machine.runtime.attribute(left, f"operator{node.operator}", ())


def _unary(machine: AbstractMachine, node: Unary, frame: StackFrame) -> Value:
    operand = machine.evaluate(node.operand, frame)
    if node.operator != "not":
        return unary(node.operator, operand)
    decided = truth(operand)
    return Unknown("not") if decided is None else Scalar(not decided)


def _logic(machine: AbstractMachine, node: Logic, frame: StackFrame) -> Value:
    deciding = node.operator == "or"
    found: list[Value] = []
    for operand in node.operands:
        value = machine.evaluate(operand, frame)
        decided = truth(value)
        if decided is not (not deciding):
            found.append(value)
        if decided is deciding:
            break
        last = value
    return join(found) if found else last


def _conditional(machine: AbstractMachine, node: Conditional, frame: StackFrame) -> Value:
    decided = truth(machine.evaluate(node.test, frame))
    if decided is None:
        return join([machine.evaluate(node.body, frame), machine.evaluate(node.orelse, frame)])
    return machine.evaluate(node.body if decided else node.orelse, frame)


def _concat(machine: AbstractMachine, node: Concat, frame: StackFrame) -> Value:
    return concat([machine.evaluate(part, frame) for part in node.parts])


def _sequence(machine: AbstractMachine, node: SequenceExpr, frame: StackFrame) -> Value:
    items: list[Value] = []
    certain = True
    for item in node.items:
        if isinstance(item, Star):
            spread, all_known = items_of(machine.evaluate(item.value, frame))
            items.extend(spread)
            certain = certain and all_known
        else:
            items.append(machine.evaluate(item, frame))
    return list_of(items, node.kind, certain=certain)


def _mapping(machine: AbstractMachine, node: MappingExpr, frame: StackFrame) -> Value:
    made = MapValue()
    for key_node, value_node in node.items:
        value = machine.evaluate(value_node, frame)
        if key_node is None:
            made.fields.update(value.fields if isinstance(value, MapValue) else {OPEN: value})
            continue
        key = machine.evaluate(key_node, frame)
        made.fields[key.value if isinstance(key, Scalar) else OPEN] = value
    return made


def _comprehension(machine: AbstractMachine, node: Comprehension, frame: StackFrame) -> Value:
    found: list[Value] = []
    certain = _run_loops(machine, node, 0, frame, found)
    if node.kind != "dict":
        return list_of(found, node.kind, certain=certain)
    made = MapValue({} if certain else {OPEN: UNKNOWN})
    for item in found:
        key, value = items_of(item)[0]
        made.fields[key.value if isinstance(key, Scalar) else OPEN] = value
    return made


def _run_loops(
    machine: AbstractMachine, node: Comprehension, depth: int, frame: StackFrame, found: list[Value]
) -> bool:
    """Run the loops from `depth` on; return whether all rounds are known."""
    if depth == len(node.loops):
        found.append(machine.evaluate(node.element, frame))
        return True
    target, iterable, tests = node.loops[depth]
    items, certain = items_of(machine.evaluate(iterable, frame))
    for item in (*items[:MAX_ITEMS], *(() if certain else (Unknown(target_name(target)),))):
        assign(machine, target, item, frame)
        answers = [truth(machine.evaluate(test, frame)) for test in tests]
        if False in answers or len(found) > MAX_ITEMS:
            continue
        certain = (
            _run_loops(machine, node, depth + 1, frame, found) and certain and None not in answers
        )
    return certain


def _lambda(machine: AbstractMachine, node: Lambda, frame: StackFrame) -> Value:
    """Python evaluates default arguments where the function is made, C++ where it is called."""
    if machine.runtime.passes_by_reference:
        closure = cpp_runtime(machine).closure_frame(node, frame)
        return FunctionValue(node.function, closure=closure)
    named = evaluate_defaults(node.function, lambda default: machine.evaluate(default, frame))
    return FunctionValue(node.function, closure=frame, bound_keywords=named)


def _star(machine: AbstractMachine, node: Star, frame: StackFrame) -> Value:
    return machine.evaluate(node.value, frame)


def _opaque(machine: AbstractMachine, node: Opaque, frame: StackFrame) -> Value:
    for part in node.parts:
        machine.evaluate(part, frame)
    return Unknown(node.text[:40] or "?")


EVALUATORS: MappingType[type, Callable[..., Value]] = {
    Attr: _attr,
    Binary: _binary,
    Call: call,
    Comprehension: _comprehension,
    Concat: _concat,
    Conditional: _conditional,
    Const: lambda machine, node, frame: Scalar(node.value),
    Index: _index,
    Lambda: _lambda,
    Logic: _logic,
    MappingExpr: _mapping,
    Name: _name,
    New: _new,
    Opaque: _opaque,
    SequenceExpr: _sequence,
    Star: _star,
    Unary: _unary,
}
