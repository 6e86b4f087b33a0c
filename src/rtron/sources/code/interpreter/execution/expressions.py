"""What each kind of expression is worth."""

from collections.abc import Callable
from collections.abc import Mapping as MappingType

from rtron.sources.code.interpreter.abstract_values.elements import element
from rtron.sources.code.interpreter.abstract_values.items import items_of
from rtron.sources.code.interpreter.abstract_values.operators import binary, unary
from rtron.sources.code.interpreter.abstract_values.value_types import (
    OPEN,
    Choice,
    FunctionValue,
    Hole,
    Instance,
    Known,
    ListValue,
    MapValue,
    Value,
    concat,
    join,
    options,
    truth,
)
from rtron.sources.code.interpreter.execution.abstract_machine import Machine
from rtron.sources.code.interpreter.execution.arguments import Arguments
from rtron.sources.code.interpreter.execution.assignment import assign, place_of
from rtron.sources.code.interpreter.execution.binding import defaults
from rtron.sources.code.interpreter.execution.calls import call, dispatch
from rtron.sources.code.interpreter.execution.exceptions import fit
from rtron.sources.code.interpreter.execution.loops import named
from rtron.sources.code.interpreter.execution.stack_frame import Frame
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
    Mapping,
    Name,
    New,
    Opaque,
    Sequence,
    Star,
    Unary,
)

MAX_ITEMS = 256


def _name(machine: Machine, node: Name, frame: Frame) -> Value:
    return machine.world.lookup(node, frame)


def _attr(machine: Machine, node: Attr, frame: Frame) -> Value:
    owner = machine.evaluate(node.owner, frame)
    if isinstance(owner, Choice):
        return join([_member(machine, option, node) for option in owner.options])
    return _member(machine, owner, node)


def _member(machine: Machine, owner: Value, node: Attr) -> Value:
    found = machine.world.attribute(owner, node.name, node.types)
    return Hole(node.name) if found is None else found


def _index(machine: Machine, node: Index, frame: Frame) -> Value:
    owner, key = machine.evaluate(node.owner, frame), machine.evaluate(node.key, frame)
    if isinstance(owner, MapValue) and isinstance(key, Known):
        _fill(machine, owner, key)
    return join([element(one, other) for one in options(owner) for other in options(key)])


def _fill(machine: Machine, owner: MapValue, key: Known) -> None:
    """`m[key]` makes an entry where std::map has none."""
    if owner.missing is not None and not owner.open and key.value not in owner.fields:
        machine.trail.set(owner.fields, key.value, owner.missing())


def _new(machine: Machine, node: New, frame: Frame) -> Value:
    return machine.world.new(node, frame)


def _binary(machine: Machine, node: Binary, frame: Frame) -> Value:
    left, right = machine.evaluate(node.left, frame), machine.evaluate(node.right, frame)
    overloaded = _overloaded(machine, node, left)
    if overloaded is not None:
        places = (place_of(machine, node.right, frame),)
        arguments = Arguments(values=(right,), places=places, line=node.line, frame=frame)
        return dispatch(machine, overloaded, arguments)
    machine.doubts += not (machine.world.by_reference or fit(node.operator, left, right))
    if node.operator == ">>" and machine.world.by_reference and not isinstance(left, Known):
        _read_into(machine, node.right, frame)
    if node.operator == "/" and machine.world.by_reference and _are_whole(left, right):
        return binary("//", left, right)
    return binary(node.operator, left, right)


def _are_whole(left: Value, right: Value) -> bool:
    """C++ divides whole numbers to a whole number."""
    return all(isinstance(side, Known) and isinstance(side.value, int) for side in (left, right))


def _read_into(machine: Machine, target: Expr, frame: Frame) -> None:
    """`stream >> variable` of a stream nobody knows."""
    place = place_of(machine, target, frame)
    if place is not None:
        machine.trail.set(*place, Hole(str(place.key)))


def _overloaded(machine: Machine, node: Binary, left: Value) -> Value | None:
    if not isinstance(left, Instance):
        return None
    return machine.world.attribute(left, f"operator{node.operator}", ())


def _unary(machine: Machine, node: Unary, frame: Frame) -> Value:
    operand = machine.evaluate(node.operand, frame)
    if node.operator != "not":
        return unary(node.operator, operand)
    decided = truth(operand)
    return Hole("not") if decided is None else Known(not decided)


def _logic(machine: Machine, node: Logic, frame: Frame) -> Value:
    wanted = node.operator == "or"
    found: list[Value] = []
    for operand in node.operands:
        value = machine.evaluate(operand, frame)
        decided = truth(value)
        if decided is not (not wanted):
            found.append(value)
        if decided is wanted:
            break
        last = value
    return join(found) if found else last


def _conditional(machine: Machine, node: Conditional, frame: Frame) -> Value:
    decided = truth(machine.evaluate(node.test, frame))
    if decided is None:
        return join([machine.evaluate(node.body, frame), machine.evaluate(node.orelse, frame)])
    return machine.evaluate(node.body if decided else node.orelse, frame)


def _concat(machine: Machine, node: Concat, frame: Frame) -> Value:
    return concat([machine.evaluate(part, frame) for part in node.parts])


def _sequence(machine: Machine, node: Sequence, frame: Frame) -> Value:
    items: list[Value] = []
    certain = True
    for item in node.items:
        if isinstance(item, Star):
            spread, all_known = items_of(machine.evaluate(item.value, frame))
            items.extend(spread)
            certain = certain and all_known
        else:
            items.append(machine.evaluate(item, frame))
    return ListValue({"items": tuple(items), "open": not certain}, node.kind)


def _mapping(machine: Machine, node: Mapping, frame: Frame) -> Value:
    made = MapValue()
    for key_node, value_node in node.items:
        value = machine.evaluate(value_node, frame)
        if key_node is None:
            made.fields.update(value.fields if isinstance(value, MapValue) else {OPEN: value})
            continue
        key = machine.evaluate(key_node, frame)
        made.fields[key.value if isinstance(key, Known) else OPEN] = value
    return made


def _comprehension(machine: Machine, node: Comprehension, frame: Frame) -> Value:
    found: list[Value] = []
    certain = _rounds(machine, node, 0, frame, found)
    if node.kind != "dict":
        return ListValue({"items": tuple(found), "open": not certain}, node.kind)
    made = MapValue({} if certain else {OPEN: Hole("?")})
    for item in found:
        key, value = items_of(item)[0]
        made.fields[key.value if isinstance(key, Known) else OPEN] = value
    return made


def _rounds(
    machine: Machine, node: Comprehension, depth: int, frame: Frame, found: list[Value]
) -> bool:
    """Run the loops from `depth` on; return whether all rounds are known."""
    if depth == len(node.loops):
        found.append(machine.evaluate(node.element, frame))
        return True
    target, iterable, tests = node.loops[depth]
    items, certain = items_of(machine.evaluate(iterable, frame))
    for item in (*items[:MAX_ITEMS], *(() if certain else (Hole(named(target)),))):
        assign(machine, target, item, frame)
        answers = [truth(machine.evaluate(test, frame)) for test in tests]
        if False in answers or len(found) > MAX_ITEMS:
            continue
        certain = (
            _rounds(machine, node, depth + 1, frame, found) and certain and None not in answers
        )
    return certain


def _lambda(machine: Machine, node: Lambda, frame: Frame) -> Value:
    """Python evaluates default arguments where the function is made, C++ where it is called."""
    if machine.world.by_reference:
        return FunctionValue(node.function, closure=machine.world.around(node, frame))
    named = defaults(node.function, lambda default: machine.evaluate(default, frame))
    return FunctionValue(node.function, closure=frame, named=named)


def _star(machine: Machine, node: Star, frame: Frame) -> Value:
    return machine.evaluate(node.value, frame)


def _opaque(machine: Machine, node: Opaque, frame: Frame) -> Value:
    for part in node.parts:
        machine.evaluate(part, frame)
    return Hole(node.text[:40] or "?")


EVALUATORS: MappingType[type, Callable[..., Value]] = {
    Attr: _attr,
    Binary: _binary,
    Call: call,
    Comprehension: _comprehension,
    Concat: _concat,
    Conditional: _conditional,
    Const: lambda machine, node, frame: Known(node.value),
    Index: _index,
    Lambda: _lambda,
    Logic: _logic,
    Mapping: _mapping,
    Name: _name,
    New: _new,
    Opaque: _opaque,
    Sequence: _sequence,
    Star: _star,
    Unary: _unary,
}
