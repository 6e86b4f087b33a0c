"""Python's `with`: what a manager's class does on the way in and out."""

from rtron.sources.code.interpreter.abstract_values.items import items_of
from rtron.sources.code.interpreter.abstract_values.value_types import (
    NONE,
    ClassValue,
    Instance,
    LibraryClass,
    ListValue,
    Value,
)
from rtron.sources.code.interpreter.execution.abstract_machine import (
    AbstractMachine,
    Outcome,
    ThrownError,
)
from rtron.sources.code.interpreter.execution.arguments import Arguments
from rtron.sources.code.interpreter.execution.assignment import assign
from rtron.sources.code.interpreter.execution.calls import callee_name, dispatch
from rtron.sources.code.interpreter.execution.exceptions import catches
from rtron.sources.code.interpreter.execution.stack_frame import StackFrame
from rtron.sources.code.ir import With

SUPPRESS = LibraryClass("contextlib.suppress")
"""The class of `contextlib.suppress(…)`: its field `names` has the exceptions that it takes."""


def run_with(machine: AbstractMachine, node: With, frame: StackFrame) -> Outcome:
    """Run `with manager as target`; a manager of a library is taken for what it gives."""
    manager = machine.evaluate(node.manager, frame)
    at = Arguments(line=node.line, frame=frame)
    given = _call_method(machine, manager, ("__enter__", "__aenter__"), at)
    if isinstance(manager, ListValue) and manager.kind == "generator" and manager.items:
        given = manager.items[0]
    if node.target is not None:
        assign(machine, node.target, manager if given is None else given, frame)
    try:
        outcome = _run_suppressing(machine, node, manager, frame)
    finally:
        leaving = at.with_values(NONE, NONE, NONE)
        _call_method(machine, manager, ("__exit__", "__aexit__"), leaving)
    return outcome


def _run_suppressing(
    machine: AbstractMachine, node: With, manager: Value, frame: StackFrame
) -> Outcome:
    """Run the body; what `suppress` takes goes no further."""
    if not (isinstance(manager, Instance) and manager.type is SUPPRESS):
        return machine.execute(node.body, frame)
    names = tuple(map(_class_name, items_of(manager.fields["names"])[0]))
    depth, before = len(machine.active_handlers), machine.possible_throws
    machine.active_handlers.append(names)
    try:
        outcome = machine.execute(node.body, frame)
    except ThrownError as error:
        if not catches(names, error):
            raise
        outcome = None
    finally:
        del machine.active_handlers[depth:]
        machine.possible_throws = before
    return None if outcome == "raise" else outcome


def _class_name(value: Value) -> str:
    return value.name if isinstance(value, ClassValue) else callee_name(value)


def _call_method(
    machine: AbstractMachine, manager: Value, names: tuple[str, ...], at: Arguments
) -> Value | None:
    for name in names:
        method = machine.runtime.special_method(manager, name)
        if method is not None:
            return dispatch(machine, method, at)
    return None
