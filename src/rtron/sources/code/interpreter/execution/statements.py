"""What each kind of statement does."""

import re
from collections.abc import Callable, Mapping
from functools import partial

from rtron.sources.code.interpreter.abstract_values.value_types import (
    NONE,
    ClassValue,
    Instance,
    Value,
    truth,
)
from rtron.sources.code.interpreter.execution import loops
from rtron.sources.code.interpreter.execution.abstract_machine import Machine, Outcome, ThrownError
from rtron.sources.code.interpreter.execution.assignment import assign, remove
from rtron.sources.code.interpreter.execution.stack_frame import Frame
from rtron.sources.code.ir import (
    Assign,
    Break,
    Call,
    Continue,
    Declare,
    Define,
    Delete,
    Evaluate,
    Expr,
    ForEach,
    Global,
    If,
    Import,
    Index,
    New,
    Raise,
    Return,
    Stmt,
    Try,
    While,
    Yield,
)
from rtron.sources.code.ir.references import effects


def branch(machine: Machine, frame: Frame, blocks: tuple[tuple[Stmt, ...], ...]) -> Outcome:
    """Run each of the blocks, one of which is taken; return how they all end, if alike."""
    outcomes: list[Outcome] = []

    def run(block: tuple[Stmt, ...]) -> bool:
        try:
            outcomes.append(machine.execute(block, frame))
        except ThrownError:
            outcomes.append("raise")
        machine.doubts += outcomes[-1] == "raise"
        return outcomes[-1] is None

    machine.trail.either([partial(run, block) for block in blocks], frame.variables)
    return outcomes[0] if len(set(outcomes)) == 1 else None


def _evaluate(machine: Machine, node: Evaluate, frame: Frame) -> Outcome:
    machine.evaluate(node.value, frame)
    return None


def _assign(machine: Machine, node: Assign, frame: Frame) -> Outcome:
    value = machine.evaluate(node.value, frame)
    for target in node.targets:
        assign(machine, target, value, frame)
    return None


def _declare(machine: Machine, node: Declare, frame: Frame) -> Outcome:
    machine.world.declare(node, frame)
    return None


def _if(machine: Machine, node: If, frame: Frame) -> Outcome:
    decided = truth(machine.evaluate(node.test, frame))
    if decided is None:
        if machine.recorder.site.ros > 1 and not (effects(node.body) or effects(node.orelse)):
            machine.doubts += 1
            return None
        return branch(machine, frame, (node.body, node.orelse))
    return machine.execute(node.body if decided else node.orelse, frame)


def _return(machine: Machine, node: Return, frame: Frame) -> Outcome:
    value = machine.evaluate(node.value, frame) if node.value is not None else NONE
    frame.returns.append(value)
    return "return"


def _yield(machine: Machine, node: Yield, frame: Frame) -> Outcome:
    if node.value is not None:
        frame.yields.append(machine.evaluate(node.value, frame))
    return None


def _raise(machine: Machine, node: Raise, frame: Frame) -> Outcome:
    """Leave for whoever catches it; where nobody seen does, only this function ends."""
    value = machine.evaluate(node.value, frame) if node.value is not None else None
    thrown = _thrown(machine, node.value, value)
    if not any(_catches(names, thrown) for names in machine.catching):
        machine.doubts += 1
        return "raise"
    raise thrown


def _thrown(machine: Machine, node: Expr | None, value: Value | None) -> ThrownError:
    owner = value.type if isinstance(value, Instance) else value
    if not isinstance(owner, ClassValue):
        return ThrownError(_written(node), open=True)
    lineage = list(machine.world.lineage(owner))
    names = [cls.name.rpartition("::")[2] for cls in lineage if isinstance(cls, ClassValue)]
    return ThrownError(*names, open=len(names) < len(lineage))


def _written(node: Expr | None) -> str:
    """Return the plain name of the exception as it is written."""
    if isinstance(node, Call):
        return _written(node.function)
    if isinstance(node, New):
        return node.type.name.rpartition("::")[2]
    name = getattr(node, "name", None) or getattr(node, "id", None) or "an exception"
    return str(name).rpartition("::")[2]


def _try(machine: Machine, node: Try, frame: Frame) -> Outcome:
    before = machine.doubts
    thrown, outcome = _attempt(machine, node, frame)
    doubted = machine.doubts > before
    if any(_takes_all(names) for names, _, _ in node.handlers):
        machine.doubts = before
    if thrown is None and outcome is None:
        outcome = machine.execute(node.orelse, frame)
    handlers = [b for names, _, b in node.handlers if thrown is None or _catches(names, thrown)]
    if handlers and (thrown is not None or outcome == "raise"):
        outcome = machine.execute(handlers[0], frame)
    elif handlers and thrown is None and doubted:
        with machine.recorder.in_handler():
            branch(machine, frame, ((), *handlers))
    ended = machine.execute(node.final, frame)
    if thrown is not None and not handlers:
        raise thrown
    return ended or outcome


def _takes_all(names: tuple[str, ...]) -> bool:
    """Tell whether a handler takes what may be thrown, whatever it is."""
    return not names or not {"...", "Exception", "BaseException"}.isdisjoint(names)


def _attempt(machine: Machine, node: Try, frame: Frame) -> tuple[ThrownError | None, Outcome]:
    depth = len(machine.catching)
    machine.catching.extend(names for names, _, _ in node.handlers)
    try:
        return None, machine.execute(node.body, frame)
    except ThrownError as error:
        return error, None
    finally:
        del machine.catching[depth:]


def _catches(names: tuple[str, ...], thrown: ThrownError) -> bool:
    """Tell whether a handler takes an exception; `Exception` does not take SystemExit."""
    wide = {"BaseException", "...", ""}
    if thrown.name != "SystemExit":
        wide |= (
            {"Exception", "LookupError", "exception", "runtime_error"}
            if thrown.open
            else {
                "Exception",
                "exception",
            }
        )
    plain = {re.split(r"::|[.]", name)[-1] for name in names}
    return not names or bool(plain & {*wide, *thrown.names})


def _define(machine: Machine, node: Define, frame: Frame) -> Outcome:
    machine.world.define(node, frame)
    return None


def _import(machine: Machine, node: Import, frame: Frame) -> Outcome:
    machine.world.import_(node, frame)
    return None


def _global(_: Machine, node: Global, frame: Frame) -> Outcome:
    frame.globals.update(node.names)
    return None


def _delete(machine: Machine, node: Delete, frame: Frame) -> Outcome:
    for target in node.targets:
        if isinstance(target, Index):
            owner, key = machine.evaluate(target.owner, frame), machine.evaluate(target.key, frame)
            remove(machine, owner, key)
    return None


EXECUTORS: Mapping[type, Callable[..., Outcome]] = {
    Assign: _assign,
    Break: lambda machine, node, frame: "break",
    Continue: lambda machine, node, frame: "continue",
    Declare: _declare,
    Define: _define,
    Delete: _delete,
    Evaluate: _evaluate,
    ForEach: loops.for_each,
    Global: _global,
    If: _if,
    Import: _import,
    Raise: _raise,
    Return: _return,
    Try: _try,
    While: loops.while_,
    Yield: _yield,
}
