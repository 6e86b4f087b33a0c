"""What each kind of statement does."""

from collections.abc import Callable, Iterable, Mapping, Sequence
from contextlib import nullcontext
from functools import partial

from rtron.sources.code import ir
from rtron.sources.code.interpreter import abstract_values as av
from rtron.sources.code.interpreter.execution import loops
from rtron.sources.code.interpreter.execution.abstract_machine import (
    AbstractMachine,
    Outcome,
    ThrownError,
)
from rtron.sources.code.interpreter.execution.assignment import assign, remove_element, slot_of
from rtron.sources.code.interpreter.execution.calls import truth_of
from rtron.sources.code.interpreter.execution.context_managers import run_with
from rtron.sources.code.interpreter.execution.exceptions import catches, is_caught
from rtron.sources.code.interpreter.execution.language_runtime import cpp_runtime, python_runtime
from rtron.sources.code.interpreter.execution.stack_frame import StackFrame
from rtron.sources.code.interpreter.execution.undo_log import Write
from rtron.sources.code.ir.references import side_effects
from rtron.vocabulary import Evidence

_BRACED = (ir.SequenceExpr, ir.MappingExpr)
"""What `{…}` of C++ is lowered to where no type stands before it."""


def run_branches(
    machine: AbstractMachine, frame: StackFrame, branches: Iterable[Callable[[], Outcome]]
) -> Outcome:
    """Run each of the branches, one of which is taken; return how they all end, if alike."""
    outcomes: list[Outcome] = []

    def run(branch: Callable[[], Outcome]) -> bool:
        try:
            outcomes.append(branch())
        except ThrownError:
            outcomes.append("raise")
        machine.possible_throws += outcomes[-1] == "raise"
        return outcomes[-1] is None

    machine.undo_log.run_branches([partial(run, branch) for branch in branches], frame.variables)
    return outcomes[0] if len(set(outcomes)) == 1 else None


def _evaluate(machine: AbstractMachine, node: ir.Evaluate, frame: StackFrame) -> Outcome:
    machine.evaluate(node.value, frame)
    return None


def _assign(machine: AbstractMachine, node: ir.Assign, frame: StackFrame) -> Outcome:
    value = machine.evaluate(node.value, frame)
    machine.line = node.line
    braced = machine.runtime.passes_by_reference and isinstance(node.value, _BRACED)
    for target in node.targets:
        made = cpp_runtime(machine).braces_for(target, value, frame) if braced else value
        assign(machine, target, made, frame)
    return None


def _declare(machine: AbstractMachine, node: ir.Declare, frame: StackFrame) -> Outcome:
    cpp_runtime(machine).declare(node, frame)
    return None


def _if(machine: AbstractMachine, node: ir.If, frame: StackFrame) -> Outcome:
    test = machine.evaluate(node.test, frame)
    decided = truth_of(machine, test)
    if decided is None:
        return _undecided_if(machine, node, test, frame)
    return machine.execute(node.body if decided else node.orelse, frame)


def _undecided_if(
    machine: AbstractMachine, node: ir.If, test: av.Value, frame: StackFrame
) -> Outcome:
    if machine.recorder.site.ros > 1 and not (side_effects(node.body) or side_effects(node.orelse)):
        machine.possible_throws += 1
        return None
    of_parameter = machine.recorder.undecided_parameter() if av.is_tainted(test) else nullcontext()
    with of_parameter:
        return run_both_sides(machine, node, frame)


def run_both_sides(machine: AbstractMachine, node: ir.If, frame: StackFrame) -> Outcome:
    """Run both sides of a condition that is not decided."""
    sides = (partial(machine.execute, side, frame) for side in (node.body, node.orelse))
    with machine.recorder.undecided_condition():
        return run_branches(machine, frame, sides)


def _breakable(machine: AbstractMachine, node: ir.Breakable, frame: StackFrame) -> Outcome:
    outcome = machine.execute(node.body, frame)
    return None if outcome == "break" else outcome


def _jump(machine: AbstractMachine, node: ir.Jump, frame: StackFrame) -> Outcome:
    """Note a jump, if its function could join nodes: what follows is run as if there were none."""
    function = frame.function
    if function is None or machine.is_relevant(machine, function):
        place = Evidence(file=frame.file, line=node.line)
        machine.recorder.add_unresolved(f"goto {node.label}", "jumps are not followed", place)
    return None


def _return(machine: AbstractMachine, node: ir.Return, frame: StackFrame) -> Outcome:
    value = machine.evaluate(node.value, frame) if node.value is not None else av.NONE
    if machine.runtime.passes_by_reference and isinstance(node.value, _BRACED) and frame.function:
        value = cpp_runtime(machine).convert_braces(frame.function.returns, value, frame)
    frame.returns.append(value)
    return "return"


def _yield(machine: AbstractMachine, node: ir.Yield, frame: StackFrame) -> Outcome:
    """Keep what a generator gives; `yield from` gives all of another."""
    if isinstance(node.value, ir.Star):
        frame.yields.extend(machine.runtime.iterate(machine.evaluate(node.value.value, frame))[0])
    elif node.value is not None:
        frame.yields.append(machine.evaluate(node.value, frame))
    return None


def _raise(machine: AbstractMachine, node: ir.Raise, frame: StackFrame) -> Outcome:
    """Leave for the handler that catches it; without one, only this function ends."""
    value = machine.evaluate(node.value, frame) if node.value is not None else None
    thrown = _thrown_error(machine, node.value, value)
    if not is_caught(machine.active_handlers, thrown):
        machine.possible_throws += 1
        return "raise"
    raise thrown


def _thrown_error(
    machine: AbstractMachine, node: ir.Expr | None, value: av.Value | None
) -> ThrownError:
    owner = value.type if isinstance(value, av.Instance) else value
    if not isinstance(owner, av.ClassValue):
        is_plain = isinstance(node, ir.Name) or isinstance(value, av.Scalar)
        is_value = machine.runtime.passes_by_reference and is_plain
        return ThrownError(_exception_name(node), has_unknown_bases=True, is_value=is_value)
    lineage = list(machine.runtime.lineage(owner))
    names = [cls.name.rpartition("::")[2] for cls in lineage if isinstance(cls, av.ClassValue)]
    return ThrownError(*names, has_unknown_bases=len(names) < len(lineage))


def _exception_name(node: ir.Expr | None) -> str:
    """Return the plain name of the exception as it is written."""
    if isinstance(node, ir.Call):
        return _exception_name(node.function)
    if isinstance(node, ir.New):
        return node.type.name.rpartition("::")[2]
    name = getattr(node, "name", None) or getattr(node, "id", None) or "an exception"
    return str(name).rpartition("::")[2]


def _try(machine: AbstractMachine, node: ir.Try, frame: StackFrame) -> Outcome:
    before = machine.possible_throws
    with machine.undo_log.gather_writes() as writes:
        thrown, outcome = _run_body(machine, node, frame)
    may_have_thrown = machine.possible_throws > before
    if any(_catches_all(names) for names, _, _ in node.handlers):
        machine.possible_throws = before
    try:
        if thrown is None and outcome is None:
            outcome = machine.execute(node.orelse, frame)
        thrown, outcome = _run_handlers(
            machine, node, frame, thrown, outcome, writes if may_have_thrown else None
        )
    except ThrownError as error:
        thrown = error
    ended = machine.execute(node.final, frame)
    if thrown is not None and ended is None:
        raise thrown
    return ended or outcome


def _run_handlers(
    machine: AbstractMachine,
    node: ir.Try,
    frame: StackFrame,
    thrown: ThrownError | None,
    outcome: Outcome,
    writes: Sequence[Write] | None,
) -> tuple[ThrownError | None, Outcome]:
    """Run the handler that is reached, or in doubt each; return what leaves the `try` then.

    `writes` are what the `try` wrote, if it may have thrown.
    """
    handlers = [(v, b) for names, v, b in node.handlers if thrown is None or catches(names, thrown)]
    if handlers and (thrown is not None or outcome == "raise"):
        variable, body = handlers[0]
        if variable and not machine.runtime.passes_by_reference:
            machine.undo_log.set(frame.variables, variable, av.Unknown(variable))
        return None, machine.execute(body, frame)
    if handlers and writes is not None:
        caught = (partial(_run_doubtful_handler, machine, b, frame, writes) for _, b in handlers)
        with machine.recorder.exception_handler():
            run_branches(machine, frame, (lambda: None, *caught))
    return thrown, outcome


def _run_doubtful_handler(
    machine: AbstractMachine, body: tuple[ir.Stmt, ...], frame: StackFrame, writes: Sequence[Write]
) -> Outcome:
    """Run a handler that may be reached: what it leaves alone may be as it was before the `try`."""
    after = [(storage, key, old, storage.get(key)) for storage, key, old in writes]
    outcome = machine.execute(body, frame)
    for storage, key, old, written in after if outcome is None else ():
        if written is None or storage.get(key) is not written:
            continue
        if isinstance(old, av.Scalar) and old != av.NONE:
            machine.undo_log.set(storage, key, av.join([old, storage[key]]))
    return outcome


def _catches_all(names: tuple[str, ...]) -> bool:
    """Tell whether a handler takes what may be thrown, whatever it is."""
    return not names or not {"...", "Exception", "BaseException"}.isdisjoint(names)


def _run_body(
    machine: AbstractMachine, node: ir.Try, frame: StackFrame
) -> tuple[ThrownError | None, Outcome]:
    depth = len(machine.active_handlers)
    machine.active_handlers.extend(names for names, _, _ in node.handlers)
    try:
        return None, machine.execute(node.body, frame)
    except ThrownError as error:
        return error, None
    finally:
        del machine.active_handlers[depth:]


def _define(machine: AbstractMachine, node: ir.Define, frame: StackFrame) -> Outcome:
    python_runtime(machine).define(node, frame)
    return None


def _import(machine: AbstractMachine, node: ir.Import, frame: StackFrame) -> Outcome:
    python_runtime(machine).import_(node, frame)
    return None


def _global(_: AbstractMachine, node: ir.Global, frame: StackFrame) -> Outcome:
    (frame.globals if node.module else frame.nonlocals).update(node.names)
    return None


def _delete(machine: AbstractMachine, node: ir.Delete, frame: StackFrame) -> Outcome:
    for target in node.targets:
        if isinstance(target, ir.Index):
            owner, key = machine.evaluate(target.owner, frame), machine.evaluate(target.key, frame)
            remove_element(machine, owner, key)
        elif not machine.runtime.passes_by_reference:
            slot = slot_of(machine, target, frame)
            if slot is not None and slot.key in slot.holder:
                machine.undo_log.remove(slot.holder, slot.key)
    return None


EXECUTORS: Mapping[type, Callable[..., Outcome]] = {
    ir.Assign: _assign,
    ir.Break: lambda machine, node, frame: "break",
    ir.Breakable: _breakable,
    ir.Continue: lambda machine, node, frame: "continue",
    ir.Declare: _declare,
    ir.Define: _define,
    ir.Delete: _delete,
    ir.Evaluate: _evaluate,
    ir.ForEach: loops.for_each,
    ir.Global: _global,
    ir.If: _if,
    ir.Import: _import,
    ir.Jump: _jump,
    ir.Raise: _raise,
    ir.Return: _return,
    ir.Try: _try,
    ir.While: loops.while_,
    ir.With: run_with,
    ir.Yield: _yield,
}
