"""Python's `with`: what a manager's class does on the way in and out."""

from rtron.sources.code.interpreter import abstract_values as av
from rtron.sources.code.interpreter.execution.abstract_machine import (
    AbstractMachine,
    Outcome,
    ThrownError,
)
from rtron.sources.code.interpreter.execution.arguments import Arguments
from rtron.sources.code.interpreter.execution.assignment import assign
from rtron.sources.code.interpreter.execution.calls import callee_name, dispatch, truth_of
from rtron.sources.code.interpreter.execution.exceptions import catches, is_caught
from rtron.sources.code.interpreter.execution.stack_frame import StackFrame
from rtron.sources.code.ir import With

SUPPRESS = av.LibraryClass("contextlib.suppress")
"""The class of `contextlib.suppress(…)`: its field `names` has the exceptions that it takes."""


def run_with(machine: AbstractMachine, node: With, frame: StackFrame) -> Outcome:
    """Run `with manager as target`; a manager of a library is taken for what it gives."""
    manager = machine.evaluate(node.manager, frame)
    at = Arguments(line=node.line, frame=frame)
    given = _call_method(machine, manager, ("__enter__", "__aenter__"), at)
    if isinstance(manager, av.ListValue) and manager.kind == "generator" and manager.items:
        given = manager.items[0]
    if node.target is not None:
        assign(machine, node.target, manager if given is None else given, frame)
    if isinstance(manager, av.Instance) and manager.type is SUPPRESS:
        return _run_suppressing(machine, node, manager, frame)
    return _run_leaving(machine, node, manager, frame)


def _run_leaving(
    machine: AbstractMachine, node: With, manager: av.Value, frame: StackFrame
) -> Outcome:
    """Run the body, then `__exit__`: an exception goes no further if that may return true."""
    at = Arguments(values=(av.NONE, av.NONE, av.NONE), line=node.line, frame=frame)
    exits = machine.runtime.special_method(manager, "__exit__") is not None
    error, outcome = _run_body(machine, node, frame, ("...",) if exits else None)
    if error is not None or outcome == "raise":
        at = at.with_values(*[av.Unknown("error")] * 3)
    left = _call_method(machine, manager, ("__exit__", "__aexit__"), at)
    goes_on = left is not None and truth_of(machine, left) is not False
    if error is not None and not goes_on:
        if is_caught(machine.active_handlers, error):
            raise error
        return "raise"
    return None if goes_on and outcome == "raise" else outcome


def _run_suppressing(
    machine: AbstractMachine, node: With, manager: av.Instance, frame: StackFrame
) -> Outcome:
    """Run the body; what `suppress` takes goes no further."""
    names = tuple(map(_class_name, av.items_of(manager.fields["names"])[0]))
    before = machine.possible_throws
    error, outcome = _run_body(machine, node, frame, names)
    machine.possible_throws = before
    if error is not None and not catches(names, error):
        raise error
    return None if outcome == "raise" else outcome


def _run_body(
    machine: AbstractMachine, node: With, frame: StackFrame, names: tuple[str, ...] | None
) -> tuple[ThrownError | None, Outcome]:
    depth = len(machine.active_handlers)
    machine.active_handlers.extend([names] if names is not None else [])
    try:
        return None, machine.execute(node.body, frame)
    except ThrownError as error:
        return error, None
    finally:
        del machine.active_handlers[depth:]


def _class_name(value: av.Value) -> str:
    return value.name if isinstance(value, av.ClassValue) else callee_name(value)


def _call_method(
    machine: AbstractMachine, manager: av.Value, names: tuple[str, ...], at: Arguments
) -> av.Value | None:
    for name in names:
        method = machine.runtime.special_method(manager, name)
        if method is not None:
            return dispatch(machine, method, at)
    return None
