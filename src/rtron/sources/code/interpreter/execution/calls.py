"""Calls: of scanned functions and classes, of native ones, and of what nobody knows."""

from collections.abc import Callable, Mapping

from rtron.sources.code.interpreter.abstract_values.items import items_of
from rtron.sources.code.interpreter.abstract_values.value_types import (
    Choice,
    ClassValue,
    Foreign,
    FunctionValue,
    Hole,
    Instance,
    Known,
    MapValue,
    MessageType,
    Native,
    NativeClass,
    Text,
    Value,
    is_tainted,
    is_text,
    join,
    spelled,
)
from rtron.sources.code.interpreter.cpp.iterators import item_at
from rtron.sources.code.interpreter.cpp.mutating_methods import mutate
from rtron.sources.code.interpreter.execution.abstract_machine import Machine, ThrownError
from rtron.sources.code.interpreter.execution.arguments import Arguments
from rtron.sources.code.interpreter.execution.assignment import place_of
from rtron.sources.code.interpreter.execution.exceptions import call_may_throw, is_sure, logs
from rtron.sources.code.interpreter.execution.stack_frame import Frame, Place
from rtron.sources.code.ir import Attr, Call, Expr, Index, Name, Star, TypeRef

WRITING = frozenset(
    {"replace", "transform", "reverse", "rotate", "swap", "generate", "fill", "sort", "strcat"}
)
"""Functions of the standard library that change what they are given."""
READING = frozenset(
    [
        *("printf", "fprintf", "puts", "fputs", "perror", "syslog", "strlen", "strncmp", "strstr"),
        *("stol", "stoll", "stoul", "stoull", "stof", "strtol", "strtoul", "strtod"),
        *("fopen", "open", "access", "stat", "opendir", "mkdir", "unlink", "setenv"),
    ]
)
"""Functions of the C and C++ libraries that leave the texts as they are which they are given."""
JOINING = frozenset({"advertise", "subscribe", "advertiseService", "serviceClient"})


def call(machine: Machine, node: Call, frame: Frame) -> Value:
    """Return what a call returns."""
    if machine.world.by_reference:
        changed = mutate(machine, node, frame)
        if changed is not None:
            machine.doubts += not is_sure(changed)
            return changed
    before = machine.doubts
    called = machine.evaluate(node.function, frame)
    if logs(node):
        machine.doubts = before
    arguments = _arguments(machine, node, frame)
    if isinstance(node.function, Attr) and isinstance(called, Hole):
        machine.asked.add(node.function.name)
        _note_unknown(machine, node.function.name, arguments)
    returned = dispatch(machine, called, arguments)
    if machine.catching and not logs(node) and call_may_throw(called, arguments, returned):
        machine.doubts += 1
    return returned


def _note_unknown(machine: Machine, name: str, arguments: Arguments) -> None:
    """Note a call that would join nodes, if only it were known what it is called on."""
    joins = name in JOINING and arguments.types and arguments.values
    if machine.world.by_reference and joins:
        what = f"{name}({spelled(arguments.values[0])})"
        machine.recorder.unresolved(what, "what it is called on is not known", arguments.evidence)


def dispatch(machine: Machine, called: Value, arguments: Arguments) -> Value:
    """Call any value; of several, each."""
    if isinstance(called, Choice):
        return _dispatch_each(machine, called, arguments)
    return _CALLS.get(type(called), _call_unknown)(machine, called, arguments)


def _dispatch_each(machine: Machine, called: Choice, arguments: Arguments) -> Value:
    """Call each of several; an exception is certain where all of them throw."""
    found: list[Value] = []
    thrown: ThrownError | None = None
    for option in called.options:
        try:
            found.append(dispatch(machine, option, arguments))
        except ThrownError as error:  # noqa: PERF203 - the others are called all the same
            thrown = error
    if thrown is not None and not found:
        raise thrown
    machine.doubts += thrown is not None
    return join(found)


def _call_native_class(machine: Machine, called: NativeClass, arguments: Arguments) -> Value:
    return called.make(machine, arguments) if called.make else Instance(called)


def _call_message(_: Machine, called: MessageType, arguments: Arguments) -> Value:
    return Instance(NativeClass(called.name), dict(arguments.keywords))


def _call_unknown(machine: Machine, called: Value, arguments: Arguments) -> Value:
    """Whoever is called may call back what it is given."""
    if isinstance(called, Instance):
        name = "operator()" if machine.world.by_reference else "__call__"
        method = machine.world.attribute(called, name, ())
        if method is not None:
            return dispatch(machine, method, arguments)
    for value in (*arguments.values, *arguments.keywords.values()):
        machine.escape(value)
    name = called_name(called)
    note_handed(machine, name, arguments)
    if not (name.isupper() or name.removeprefix("std::") in READING):
        _may_write(machine, name.rpartition("::")[2], arguments)
    return Hole(f"{name}()")


def note_handed(machine: Machine, name: str, arguments: Arguments) -> None:
    """Note that code which is not here gets what it takes to join nodes."""
    for value in arguments.values:
        is_handle = isinstance(value, Instance) and "namespace" in value.fields
        is_library = isinstance(value, (Foreign, Native)) and value.name.startswith("rospy")
        if is_handle or is_library:
            why = "is not in the source, and gets what it takes to join nodes"
            machine.recorder.unresolved(f"{name}()", why, arguments.evidence)


def _may_write(machine: Machine, name: str, arguments: Arguments) -> None:
    """Forget the strings that a C++ function nobody knows may have changed."""
    for place in filter(None, arguments.places):
        before = place.holder.get(place.key)
        if isinstance(before, (Known, Text)) and is_text(before):
            after = Hole(str(place.key), is_tainted(before))
            machine.trail.set(*place, after if name in WRITING else join((before, after)))


def called_name(called: Value) -> str:
    """Return what something unknown is called in the source."""
    if isinstance(called, Foreign):
        return called.name
    return called.why if isinstance(called, Hole) else "?"


def _arguments(machine: Machine, node: Call, frame: Frame) -> Arguments:
    values: list[Value] = []
    for arg in node.args:
        if isinstance(arg, Star):
            values.extend(items_of(machine.evaluate(arg.value, frame))[0])
        else:
            value = machine.evaluate(arg, frame)
            values.append(item_at(value) if isinstance(arg, Name) else value)
    by_reference = machine.world.by_reference
    return Arguments(
        values=tuple(values),
        keywords=_keywords(machine, node, frame) if node.keywords else {},
        places=tuple([_place(machine, a, frame) for a in node.args]) if by_reference else (),
        types=_types(node.function),
        line=node.line,
        frame=frame,
    )


def _place(machine: Machine, node: Expr, frame: Frame) -> Place | None:
    """Return where an argument is kept that may be written to; `s.begin()`, `&s[0]` lead to s."""
    if isinstance(node, Name):
        fixed = machine.world.is_constant(node.id, frame)
        return None if fixed else machine.world.place(node.id, frame)
    if isinstance(node, Call) and isinstance(node.function, Attr):
        inner = node.function.owner if node.function.name in {"begin", "end"} else None
        return place_of(machine, inner, frame) if inner is not None else None
    found = place_of(machine, node, frame)
    if found is None and isinstance(node, Index):
        return place_of(machine, node.owner, frame)
    return found


def _keywords(machine: Machine, node: Call, frame: Frame) -> dict[str, Value]:
    keywords: dict[str, Value] = {}
    for name, expression in node.keywords:
        value = machine.evaluate(expression, frame)
        if name != "**":
            keywords[name] = value
        elif isinstance(value, MapValue):
            keywords.update({str(key): entry for key, entry in value.entries.items()})
    return keywords


def _types(function: Expr) -> tuple[TypeRef, ...]:
    return function.types if isinstance(function, (Name, Attr)) else ()


_CALLS: Mapping[type, Callable[..., Value]] = {
    Native: lambda machine, called, arguments: called.call(machine, called.owner, arguments),
    NativeClass: _call_native_class,
    FunctionValue: lambda machine, called, arguments: machine.call(called, arguments),
    ClassValue: lambda machine, called, arguments: machine.world.instantiate(called, arguments),
    MessageType: _call_message,
}
