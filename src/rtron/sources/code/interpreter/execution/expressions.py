"""The value of each kind of expression."""

from collections.abc import Callable
from collections.abc import Mapping as MappingType
from dataclasses import replace
from typing import Any

from rtron.sources.code.interpreter.abstract_values.elements import element
from rtron.sources.code.interpreter.abstract_values.items import items_of, list_of
from rtron.sources.code.interpreter.abstract_values.operators import binary, cpp_binary, unary
from rtron.sources.code.interpreter.abstract_values.value_types import (
    OPEN,
    UNKNOWN,
    Choice,
    ExternalSymbol,
    FunctionValue,
    Instance,
    LibraryClass,
    ListValue,
    MapValue,
    Scalar,
    Unknown,
    Value,
    concat,
    is_tainted,
    join,
    map_key,
    options,
)
from rtron.sources.code.interpreter.execution.abstract_machine import AbstractMachine
from rtron.sources.code.interpreter.execution.arguments import Arguments, evaluate_defaults
from rtron.sources.code.interpreter.execution.assignment import assign, slot_of
from rtron.sources.code.interpreter.execution.calls import call, dispatch, truth_of
from rtron.sources.code.interpreter.execution.exceptions import operands_fit
from rtron.sources.code.interpreter.execution.language_runtime import cpp_runtime
from rtron.sources.code.interpreter.execution.loops import target_name
from rtron.sources.code.interpreter.execution.stack_frame import StackFrame
from rtron.sources.code.ir import (
    AssignExpr,
    Attr,
    Binary,
    Call,
    Comprehension,
    Concat,
    Conditional,
    Const,
    Expansion,
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
IN_PLACE_OPERATORS = {"+=": "+", "|=": "|"}
SPECIAL_METHODS = {
    "+": "add",
    "-": "sub",
    "*": "mul",
    "/": "truediv",
    "//": "floordiv",
    "%": "mod",
    "@": "matmul",
    "<<": "lshift",
    ">>": "rshift",
    "&": "and",
    "|": "or",
    "^": "xor",
    "**": "pow",
    "==": "eq",
    "!=": "ne",
    "<": "lt",
    "<=": "le",
    ">": "gt",
    ">=": "ge",
    "in": "contains",
}
"""What Python calls its operators (docs.python.org: reference/datamodel)."""
_ASSIGNABLE = frozenset({"+", "-", "*", "/", "%", "<<", ">>", "&", "|", "^"})
"""Operators that C++ has together with an assignment: `a += b` is lowered to `a = a + b`."""


def _name(machine: AbstractMachine, node: Name, frame: StackFrame) -> Value:
    return machine.runtime.lookup(node, frame)


def _attr(machine: AbstractMachine, node: Attr, frame: StackFrame) -> Value:
    owner = machine.evaluate(node.owner, frame)
    if isinstance(owner, Choice):
        return join([_member(machine, option, node, frame) for option in owner.options])
    return _member(machine, owner, node, frame)


def _member(machine: AbstractMachine, owner: Value, node: Attr, frame: StackFrame) -> Value:
    found = machine.runtime.attribute(owner, node.name, node.types)
    arrow = overloaded_operator(machine, owner, "->") if found is None else None
    if arrow is not None:
        owner = dispatch(machine, arrow, Arguments(frame=frame))
        found = machine.runtime.attribute(owner, node.name, node.types)
    return Unknown(node.name) if found is None else found


def _index(machine: AbstractMachine, node: Index, frame: StackFrame) -> Value:
    owner, key = machine.evaluate(node.owner, frame), machine.evaluate(node.key, frame)
    method = machine.runtime.special_method(owner, "__getitem__") or overloaded_operator(
        machine, owner, "[]"
    )
    if method is not None:
        return dispatch(machine, method, Arguments(values=(key,), frame=frame))
    if isinstance(owner, MapValue):
        _insert_default(machine, owner, key)
    if isinstance(owner, MapValue) and isinstance(key, Scalar):
        _note_missing(machine, owner, key, frame)
    return join([element(one, other) for one in options(owner) for other in options(key)])


def _insert_default(machine: AbstractMachine, owner: MapValue, key: Value) -> None:
    """`m[key]` makes an entry where std::map, or a defaultdict, has none."""
    name = owner.key_of(key)
    if owner.default_factory is not None and not owner.open and name not in owner.fields:
        machine.undo_log.set(owner.fields, name, owner.default_factory())


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
    at = Arguments(values=(right,), line=node.line, frame=frame)
    if not machine.runtime.passes_by_reference:
        return _python_binary(machine, node.operator, left, at)
    at = replace(at, slots=(slot_of(machine, node.right, frame),))
    overloaded = overloaded_operator(machine, left, node.operator)
    if overloaded is not None:
        return dispatch(machine, overloaded, at)
    is_arithmetic = node.operator in _ASSIGNABLE
    assigning = overloaded_operator(machine, left, f"{node.operator}=") if is_arithmetic else None
    if assigning is not None:
        dispatch(machine, assigning, at)
        return left
    if node.operator == ">>" and not isinstance(left, Scalar):
        _read_into(machine, node.right, frame)
    if isinstance(left, ExternalSymbol) and isinstance(right, ExternalSymbol):
        is_same = cpp_runtime(machine).symbols.are_equal(left.name, right.name)
        if is_same is not None and node.operator in {"==", "!="}:
            return Scalar(is_same is (node.operator == "=="))
    return cpp_binary(node.operator, left, right)


def _python_binary(machine: AbstractMachine, operator: str, left: Value, at: Arguments) -> Value:
    """Return `left operator right`, by the methods of scanned classes where they have some."""
    if operator in IN_PLACE_OPERATORS:
        changed = _change_in_place(machine, operator, left, at)
        if changed is not None:
            return changed
    plain, right = IN_PLACE_OPERATORS.get(operator, operator), at.values[0]
    called, other = _special_operator(machine, plain, left, right)
    if called is not None:
        return dispatch(machine, called, replace(at, values=(other,)))
    machine.possible_throws += not operands_fit(plain, left, right)
    return binary(plain, left, right)


def _special_operator(
    machine: AbstractMachine, operator: str, left: Value, right: Value
) -> tuple[Value | None, Value]:
    """Return Python's method for an operator, bound to its object, and what it gets."""
    name = SPECIAL_METHODS.get(operator)
    own = overloaded_operator(machine, left, operator)
    if own is not None or name is None:
        return own, right
    if operator == "in":
        return machine.runtime.special_method(right, f"__{name}__"), left
    method = machine.runtime.special_method(left, f"__{name}__")
    return (
        (method, right) if method else (machine.runtime.special_method(right, f"__r{name}__"), left)
    )


def _change_in_place(
    machine: AbstractMachine, operator: str, left: Value, at: Arguments
) -> Value | None:
    """Change a list, set or dict itself by `a += b`, `a |= b`; None for what that replaces."""
    name = SPECIAL_METHODS[IN_PLACE_OPERATORS[operator]]
    method = machine.runtime.special_method(left, f"__i{name}__")
    if method is not None:
        return dispatch(machine, method, at)
    if isinstance(left, MapValue) or (isinstance(left, ListValue) and left.kind != "tuple"):
        update = machine.runtime.attribute(left, "extend" if operator == "+=" else "update", ())
        dispatch(machine, update or UNKNOWN, at)
        return left
    return None


def _read_into(machine: AbstractMachine, target: Expr, frame: StackFrame) -> None:
    """`stream >> variable` of an unknown stream."""
    slot = slot_of(machine, target, frame)
    if slot is not None:
        machine.undo_log.set(*slot, Unknown(slot.label))


def overloaded_operator(machine: AbstractMachine, left: Value, operator: str) -> Value | None:
    """Return what a class of C++, or of a library, has for an operator."""
    is_library = isinstance(left, Instance) and isinstance(left.type, LibraryClass)
    if isinstance(left, Instance) and (machine.runtime.passes_by_reference or is_library):
        return machine.runtime.attribute(left, f"operator{operator}", ())
    return None


def _unary(machine: AbstractMachine, node: Unary, frame: StackFrame) -> Value:
    operand = machine.evaluate(node.operand, frame)
    word = "!" if node.operator == "not" else node.operator
    overloaded = overloaded_operator(machine, operand, word)
    if overloaded is not None:
        return dispatch(machine, overloaded, Arguments(frame=frame))
    if node.operator != "not":
        return unary(node.operator, operand)
    decided = truth_of(machine, operand)
    return Unknown("not") if decided is None else Scalar(not decided)


def _logic(machine: AbstractMachine, node: Logic, frame: StackFrame) -> Value:
    deciding = node.operator == "or"
    found: list[Value] = []
    for operand in node.operands:
        value = machine.evaluate(operand, frame)
        decided = truth_of(machine, value)
        if decided is not (not deciding):
            found.append(value)
        if decided is deciding:
            break
        last = value
    return join(found) if found else last


def _conditional(machine: AbstractMachine, node: Conditional, frame: StackFrame) -> Value:
    decided = truth_of(machine, machine.evaluate(node.test, frame))
    if decided is None:
        return join([machine.evaluate(node.body, frame), machine.evaluate(node.orelse, frame)])
    return machine.evaluate(node.body if decided else node.orelse, frame)


def _concat(machine: AbstractMachine, node: Concat, frame: StackFrame) -> Value:
    return concat([machine.runtime.shown(machine.evaluate(part, frame)) for part in node.parts])


def _sequence(machine: AbstractMachine, node: SequenceExpr, frame: StackFrame) -> Value:
    items: list[Value] = []
    certain = True
    for item in node.items:
        if isinstance(item, Star):
            spread, all_known = machine.runtime.iterate(machine.evaluate(item.value, frame))
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
            spread(made.fields, value)
        else:
            made.fields[map_key(machine.evaluate(key_node, frame))] = value
    return made


def spread(fields: dict[Any, Value], value: Value) -> None:
    """Put the entries of a dict into others; what is not known of it may replace any of them."""
    if not isinstance(value, MapValue) or value.open:
        fields.update({name: Unknown(str(name), is_tainted(value)) for name in fields})
    fields.update(value.fields if isinstance(value, MapValue) else {OPEN: value})


def _comprehension(machine: AbstractMachine, node: Comprehension, frame: StackFrame) -> Value:
    found: list[Value] = []
    inner = StackFrame(file=frame.file, closure=frame, body="comprehension", cls=frame.cls)
    certain = _run_loops(machine, node, 0, inner, found)
    if node.kind != "dict":
        return list_of(found, node.kind, certain=certain)
    made = MapValue({} if certain else {OPEN: UNKNOWN})
    for item in found:
        key, value = items_of(item)[0]
        made.fields[map_key(key)] = value
    return made


def _run_loops(
    machine: AbstractMachine, node: Comprehension, depth: int, frame: StackFrame, found: list[Value]
) -> bool:
    """Run the loops from `depth` on; return whether all rounds are known."""
    if depth == len(node.loops):
        found.append(machine.evaluate(node.element, frame))
        return True
    target, iterable, tests = node.loops[depth]
    items, certain = machine.runtime.iterate(machine.evaluate(iterable, frame))
    certain = certain and len(items) <= MAX_ITEMS
    for item in (*items[:MAX_ITEMS], *(() if certain else (Unknown(target_name(target)),))):
        assign(machine, target, item, frame)
        answers = [truth_of(machine, machine.evaluate(test, frame)) for test in tests]
        if False in answers:
            continue
        if len(found) > MAX_ITEMS:
            return False
        certain = (
            _run_loops(machine, node, depth + 1, frame, found) and certain and None not in answers
        )
    return certain


def _lambda(machine: AbstractMachine, node: Lambda, frame: StackFrame) -> Value:
    """Python evaluates default arguments where the function is made, C++ where it is called."""
    if machine.runtime.passes_by_reference:
        machine.lambdas[id(node.function.body)] = node.function
        closure = cpp_runtime(machine).closure_frame(node, frame)
        return FunctionValue(node.function, closure=closure)
    named = evaluate_defaults(node.function, lambda default: machine.evaluate(default, frame))
    around = frame.closure if frame.body == "class" else frame
    return FunctionValue(node.function, closure=around, bound_keywords=named)


def _assign_expr(machine: AbstractMachine, node: AssignExpr, frame: StackFrame) -> Value:
    """Assign in the frame around a comprehension (PEP 572)."""
    value = machine.evaluate(node.value, frame)
    while frame.body == "comprehension" and frame.closure is not None:
        frame = frame.closure
    assign(machine, node.target, value, frame)
    return value


def _expansion(machine: AbstractMachine, node: Expansion, frame: StackFrame) -> Value:
    """Evaluate the pattern for each item of the packs, which are variables of their names."""
    slots = [machine.runtime.slot(name, frame) for name in node.packs]
    packs = [slot.holder.get(slot.key, UNKNOWN) for slot in slots]
    rows = [items_of(pack) for pack in packs]
    found: list[Value] = []
    for at in range(min(len(items) for items, _ in rows)):
        for slot, (items, _) in zip(slots, rows, strict=True):
            machine.undo_log.set(*slot, items[at])
        found.append(machine.evaluate(node.pattern, frame))
    for slot, pack in zip(slots, packs, strict=True):
        machine.undo_log.set(*slot, pack)
    return list_of(found, certain=all(certain for _, certain in rows))


def _star(machine: AbstractMachine, node: Star, frame: StackFrame) -> Value:
    return machine.evaluate(node.value, frame)


def _opaque(machine: AbstractMachine, node: Opaque, frame: StackFrame) -> Value:
    for part in node.parts:
        machine.evaluate(part, frame)
    return Unknown(node.text[:40] or "?")


EVALUATORS: MappingType[type, Callable[..., Value]] = {
    AssignExpr: _assign_expr,
    Attr: _attr,
    Binary: _binary,
    Call: call,
    Comprehension: _comprehension,
    Concat: _concat,
    Conditional: _conditional,
    Expansion: _expansion,
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
