"""Calls: of scanned functions and classes, of library models, and of what is unknown."""

from collections.abc import Callable, Mapping

from rtron.sources.code.endpoint_calls import ENDPOINT_METHODS
from rtron.sources.code.interpreter.abstract_values.truth import truth
from rtron.sources.code.interpreter.abstract_values.value_types import (
    UNKNOWN,
    Choice,
    ClassValue,
    ExternalSymbol,
    FunctionValue,
    Instance,
    LibraryClass,
    LibraryFunction,
    MapValue,
    MessageType,
    Unknown,
    Value,
    join,
    text_with_holes,
)
from rtron.sources.code.interpreter.cpp.iterators import dereference
from rtron.sources.code.interpreter.cpp.mutating_methods import mutate
from rtron.sources.code.interpreter.execution.abstract_machine import AbstractMachine, ThrownError
from rtron.sources.code.interpreter.execution.arguments import OPEN_KEYWORD, Arguments
from rtron.sources.code.interpreter.execution.assignment import slot_of
from rtron.sources.code.interpreter.execution.exceptions import (
    call_may_throw,
    is_fully_known,
    is_logging_call,
)
from rtron.sources.code.interpreter.execution.stack_frame import StackFrame, StorageSlot
from rtron.sources.code.interpreter.execution.written_arguments import (
    READ_ONLY_FUNCTIONS,
    forget_pointees,
    forget_written,
    open_container,
)
from rtron.sources.code.ir import Attr, Call, Expr, Index, Name, Star, TypeRef
from rtron.sources.code.library_models.common.message_types import make_message
from rtron.sources.code.library_models.common.transforms import note_look_up
from rtron.vocabulary import UnresolvedCause

_MIN_ARGUMENTS = 2
"""What a call of a client library gets at least, if no template argument tells it from others."""
_HANDLE_FIELDS = {1: "namespace", 2: "node.name"}
"""What node handles of roscpp have, and nodes of ROS 2."""
_ADD_NOTHING = frozenset(
    [
        *("spin", "spin_some", "spin_all", "spin_once", "spin_until_future_complete"),
        *("add_node", "remove_node", "get_node", "CreateTimerROS", "ParamListener"),
        *("rclpy.spin", "rclpy.spin_once", "rclpy.spin_until_future_complete"),
        *("add_callback_group", "RequiredInterfaces", "copy_all_parameter_values"),
        *("TransportHints", "__fromServer__", "__toServer__"),
    ]
)
"""What takes a node, or a node handle, and adds no endpoint to it.

ParamListener is of generate_parameter_library, the last two of what dynamic_reconfigure generates.
"""
READ_ONLY_METHODS = frozenset(
    [
        *("rbegin", "rend", "crbegin", "crend", "capacity", "max_size", "shrink_to_fit"),
        *("lower_bound", "upper_bound", "equal_range", "find", "count", "contains", "length"),
        *("bucket_count", "load_factor", "get_allocator", "key_comp", "value_comp", "substr"),
        *("c_str", "compare", "toXml", "valid", "size", "empty"),
    ]
)
"""Methods of containers that leave them as they are."""


def call(machine: AbstractMachine, node: Call, frame: StackFrame) -> Value:
    """Return what a call returns."""
    if machine.runtime.passes_by_reference:
        changed = mutate(machine, node, frame)
        if changed is not None:
            machine.possible_throws += not is_fully_known(changed)
            return changed
    before = machine.possible_throws
    called = machine.evaluate(node.function, frame)
    if machine.possible_throws != before and is_logging_call(node):
        machine.possible_throws = before
    arguments = _evaluate_arguments(machine, node, frame)
    if isinstance(node.function, Attr) and isinstance(called, Unknown):
        machine.unknown_method_names.add(node.function.name)
        _note_unknown_receiver(machine, node.function.name, arguments)
        if machine.runtime.passes_by_reference:
            _open_container(machine, node.function, frame)
    elif isinstance(called, ExternalSymbol):
        called = machine.runtime.find_by_arguments(called.name, arguments) or called
    if isinstance(called, ExternalSymbol):
        _note_unknown_receiver(machine, called.name.rpartition("::")[2], arguments)
    if isinstance(node.function, Attr) and not isinstance(called, FunctionValue):
        note_look_up(machine, node.function, arguments)
    returned = dispatch(machine, called, arguments)
    if (
        machine.active_handlers
        and not is_logging_call(node)
        and call_may_throw(called, arguments, returned)
    ):
        machine.possible_throws += 1
    return returned


def _note_unknown_receiver(machine: AbstractMachine, name: str, arguments: Arguments) -> None:
    """Note a call that would join nodes, if only it were known what it is called on."""
    given = arguments.values
    joins = name in ENDPOINT_METHODS and (arguments.types or len(given) >= _MIN_ARGUMENTS)
    if machine.runtime.passes_by_reference and joins and given:
        texts = (value for value in given if not isinstance(value, (FunctionValue, Instance)))
        what = f"{name}({text_with_holes(next(texts, given[0]))})"
        machine.recorder.add_unresolved(
            what, "what it is called on is not known", arguments.evidence
        )


def dispatch(machine: AbstractMachine, called: Value, arguments: Arguments) -> Value:
    """Call any value; of several, each."""
    if isinstance(called, Choice):
        return _dispatch_each(machine, called, arguments)
    return _DISPATCH.get(type(called), _call_unknown)(machine, called, arguments)


def _dispatch_each(machine: AbstractMachine, called: Choice, arguments: Arguments) -> Value:
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
    machine.possible_throws += thrown is not None
    return join(found)


def _call_library_class(
    machine: AbstractMachine, called: LibraryClass, arguments: Arguments
) -> Value:
    return called.construct(machine, arguments) if called.construct else Instance(called)


def _call_message(_: AbstractMachine, called: MessageType, arguments: Arguments) -> Value:
    return make_message(called.name, dict(arguments.keywords))


def _call_function(machine: AbstractMachine, called: FunctionValue, arguments: Arguments) -> Value:
    """Call a scanned function; one that is only declared may write to what it gets by reference."""
    returned = machine.call(called, arguments)
    function = called.function
    if function.body is None:
        machine.escape_arguments(arguments)
        note_passed_handle(machine, function.name, arguments)
        machine.forget_references(function, arguments)
        forget_pointees(machine, arguments)
    return returned


def _call_unknown(machine: AbstractMachine, called: Value, arguments: Arguments) -> Value:
    """Escape the arguments: an unknown function may call back what it gets."""
    if isinstance(called, Instance):
        name = "operator()" if machine.runtime.passes_by_reference else "__call__"
        method = machine.runtime.attribute(called, name, ())
        if method is not None:
            return dispatch(machine, method, arguments)
    machine.escape_arguments(arguments)
    name = callee_name(called)
    note_passed_handle(machine, name, arguments)
    machine.runtime.note_unknown_call(called, arguments)
    if not (name.isupper() or name.removeprefix("std::") in READ_ONLY_FUNCTIONS):
        forget_written(machine, name.rpartition("::")[2], arguments)
    return Unknown(f"{name}()")


def _open_container(machine: AbstractMachine, method: Attr, frame: StackFrame) -> None:
    """Leave open what is in a C++ container that has a method called which is not known."""
    slot = None if method.name in READ_ONLY_METHODS else slot_of(machine, method.owner, frame)
    if slot is not None:
        open_container(machine, slot.holder.get(slot.key, UNKNOWN))


def note_passed_handle(machine: AbstractMachine, name: str, arguments: Arguments) -> None:
    """Note that code which is not here gets what it takes to join nodes, and whose source tells."""
    plain = name.rpartition("::")[2]
    if plain in _ADD_NOTHING or plain in ENDPOINT_METHODS:
        return
    for node in filter(None, (_handed_node(machine, value) for value in arguments.values)):
        why = f"its code is not here, and it gets the node {node}: it may give it endpoints"
        package = machine.runtime.missing_package(name)
        given = f"; give the source of {package} too" if package else ""
        machine.recorder.add_unresolved(
            f"{name}()", why + given, arguments.evidence, cause=UnresolvedCause.MISSING_CODE
        )


def _handed_node(machine: AbstractMachine, value: Value) -> str:
    """Return the node that a value gives the means to join, empty for what is no such thing."""
    site = machine.recorder.site
    field = _HANDLE_FIELDS[site.ros]
    if isinstance(value, (ExternalSymbol, LibraryFunction)) and value.name.startswith("rospy"):
        return site.name
    if not (isinstance(value, Instance) and field in value.fields):
        return ""
    return site.name if site.ros == 1 else text_with_holes(value.fields[field])


def truth_of(machine: AbstractMachine, value: Value) -> bool | None:
    """Return whether a value counts as true, as its scanned class says by a method."""
    for name in ("__bool__", "__nonzero__", "__len__"):
        method = machine.runtime.special_method(value, name)
        if method is not None:
            return truth(dispatch(machine, method, Arguments(frame=StackFrame(file=""))))
    return truth(value)


def callee_name(called: Value) -> str:
    """Return what something unknown is called in the source."""
    if isinstance(called, ExternalSymbol):
        return called.name
    return called.label if isinstance(called, Unknown) else "?"


def _evaluate_arguments(machine: AbstractMachine, node: Call, frame: StackFrame) -> Arguments:
    values, is_known = _evaluate_values(machine, node, frame)
    keywords = _evaluate_keywords(machine, node, frame) if node.keywords else {}
    by_reference = machine.runtime.passes_by_reference
    return Arguments(
        values=tuple(values),
        keywords=keywords if is_known else {**keywords, OPEN_KEYWORD: Unknown("*")},
        slots=tuple([_argument_slot(machine, a, frame) for a in node.args]) if by_reference else (),
        types=_template_arguments(node.function),
        line=node.line,
        frame=frame,
        addresses=node.addresses,
    )


def _evaluate_values(
    machine: AbstractMachine, node: Call, frame: StackFrame
) -> tuple[list[Value], bool]:
    """Return the positional arguments, and whether these are all."""
    values: list[Value] = []
    is_known = True
    for arg in node.args:
        value = machine.evaluate(arg.value if isinstance(arg, Star) else arg, frame)
        if isinstance(arg, Star):
            items, certain = machine.runtime.iterate(value)
            values.extend(items if is_known else ())
            is_known = is_known and certain
        elif is_known:
            values.append(dereference(value) if isinstance(arg, Name) else value)
        else:
            values.append(Unknown("*"))
    return values, is_known


def _argument_slot(machine: AbstractMachine, node: Expr, frame: StackFrame) -> StorageSlot | None:
    """Return where an argument is kept that may be written to; `s.begin()`, `&s[0]` lead to s."""
    if isinstance(node, Name):
        fixed = machine.runtime.is_constant(node.id, frame)
        return None if fixed else machine.runtime.slot(node.id, frame)
    if isinstance(node, Call) and isinstance(node.function, Attr):
        inner = node.function.owner if node.function.name in {"begin", "end"} else None
        return slot_of(machine, inner, frame) if inner is not None else None
    found = slot_of(machine, node, frame)
    if found is None and isinstance(node, Index):
        return slot_of(machine, node.owner, frame)
    return found


def _evaluate_keywords(machine: AbstractMachine, node: Call, frame: StackFrame) -> dict[str, Value]:
    keywords: dict[str, Value] = {}
    for name, expression in node.keywords:
        value = machine.evaluate(expression, frame)
        if name != "**":
            keywords[name] = value
        elif isinstance(value, MapValue):
            keywords.update({str(key): entry for key, entry in value.entries.items()})
        if name == "**" and (not isinstance(value, MapValue) or value.open):
            keywords[OPEN_KEYWORD] = Unknown("**")
    return keywords


def _template_arguments(function: Expr) -> tuple[TypeRef, ...]:
    return function.types if isinstance(function, (Name, Attr)) else ()


_DISPATCH: Mapping[type, Callable[..., Value]] = {
    LibraryFunction: lambda machine, called, arguments: called.call(
        machine, called.owner, arguments
    ),
    LibraryClass: _call_library_class,
    FunctionValue: _call_function,
    ClassValue: lambda machine, called, arguments: machine.runtime.instantiate(called, arguments),
    MessageType: _call_message,
}
