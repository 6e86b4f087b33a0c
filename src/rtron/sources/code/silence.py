"""Runs a program with one message, and then in silence: what it still sends, and to whom.

Tasks and loops run in rounds, between which the clock goes on in ever longer steps, until nothing
changes any more.
"""

from collections.abc import Iterable
from contextlib import suppress
from dataclasses import dataclass, field
from typing import TypeAlias

from rtron.sources.code import ir
from rtron.sources.code.interpreter import abstract_values as av
from rtron.sources.code.interpreter.execution.abstract_machine import (
    AbstractMachine,
    StepsExceededError,
    ThrownError,
)
from rtron.sources.code.interpreter.execution.arguments import Arguments
from rtron.sources.code.interpreter.execution.calls import dispatch
from rtron.sources.code.interpreter.execution.stack_frame import StackFrame
from rtron.sources.code.interpreter.execution.undo_log import Write
from rtron.sources.code.silent_evaluation import LATE_ROUND, STEP_GROWTH, SilentEvaluation
from rtron.sources.code.silent_outputs import DECIDED, DOUBT, MESSAGE, WaitsError

SMALL = 0.02
"""What counts as zero of a number that decays."""
MAX_STEPS = 6_000
_MAX_ROUNDS, _IDLE_ROUND, _MAX_HANDED = 64, 2, 16
_FIRST_STEP, _END = 0.05, 100.0
"""How long the clock goes on after the first round, and when all timeouts are over (s)."""
_LISTS = (
    *("pending_callbacks", "escaped_functions", "passed_functions", "deferred_actions"),
    *("instances", "tasks"),
)
"""What a machine remembers of what runs, which counts for nothing here."""
_ONCE = "threading.Timer"
_NOTHING = Arguments(frame=StackFrame(file=""))
_GIVEN = Arguments(values=(MESSAGE,), frame=StackFrame(file=""))
Loop: TypeAlias = tuple[ir.While, StackFrame]
"""A loop that does not end, and the frame that it runs in."""


@dataclass(eq=False, slots=True)
class _Task:
    """A function that runs in each round, or the loops that it waits in, the innermost last."""

    function: av.FunctionValue | None
    starter: str = ""
    loops: list[Loop] = field(default_factory=list)
    is_done: bool = False

    @property
    def is_thread(self) -> bool:
        """Whether it runs once, unless it loops."""
        return self.starter.endswith(("hread", "start", _ONCE))


@dataclass(eq=False, slots=True)
class Silence:
    """One run; `is_zeroed` says that what was kept of the message became zero."""

    machine: AbstractMachine
    seen: SilentEvaluation
    is_zeroed: bool = False
    _tasks: list[_Task] = field(default_factory=list)

    def run(self, callbacks: Iterable[av.FunctionValue], loop: Loop | None) -> bool:
        """Run it all, and take it back; return whether nothing changes any more in the end."""
        machine, is_still = self.machine, False
        kept = machine.evaluators, machine.executors, machine.is_relevant
        lists = {name: list(getattr(machine, name)) for name in _LISTS}
        machine.evaluators = {**machine.evaluators, **self.seen.evaluators()}
        machine.executors = {**machine.executors, **self.seen.executors()}
        machine.is_relevant = lambda *_: True

        def simulate() -> bool:
            nonlocal is_still
            self._handle(callbacks, loop)
            is_still = self._run_rounds()
            return True

        try:
            with machine.trial_run(), machine.step_budget(MAX_STEPS):
                machine.undo_log.run_and_undo(simulate)
        except (StepsExceededError, RecursionError):
            is_still = False
        finally:
            machine.evaluators, machine.executors, machine.is_relevant = kept
            for name, before in lists.items():
                setattr(machine, name, before)
        return is_still

    def _handle(self, callbacks: Iterable[av.FunctionValue], loop: Loop | None) -> None:
        """Let callbacks handle the message, beside the tasks that the program has started."""
        self._tasks += [_Task(None, loops=[loop])] if loop else []
        self._tasks += (_Task(*task) for task in self.machine.tasks if task[1] != _ONCE)
        known = len(self.machine.tasks)
        self.seen.reasons.append(DECIDED)
        for callback in callbacks:
            task = _Task(callback)
            self._step(task, _GIVEN)
            self._tasks += [task] if task.loops else []
        self.seen.reasons.pop()
        self.seen.late_tasks += self.machine.tasks[known:]

    def _run_rounds(self) -> bool:
        """Run rounds until nothing changes; return whether nothing of the message does."""
        seen, step, is_still = self.seen, _FIRST_STEP, True
        for seen.round in range(1, _MAX_ROUNDS + 1):
            seen.clock += step
            step *= STEP_GROWTH
            seen.is_timed = False
            with self.machine.undo_log.gather_writes() as writes:
                self._run_round()
            self.is_zeroed |= any(map(_is_zeroed, writes))
            is_waiting = seen.is_timed or bool(seen.late_tasks)
            if seen.round == _IDLE_ROUND and not (seen.is_used or seen.outputs or is_waiting):
                return True
            changes = [each for each in writes if _is_change(each)]
            is_over = seen.clock > _END or not (is_waiting or seen.round < LATE_ROUND + 2)
            if is_over and not changes:
                return True
            is_still = not any(map(_is_of_message, changes))
        return is_still

    def _run_round(self) -> None:
        if self.seen.round == LATE_ROUND:
            self._tasks += (_Task(*task) for task in self.seen.late_tasks)
            self.seen.reasons.append(DOUBT)
            for function in self.seen.handed[:_MAX_HANDED]:
                self._step(_Task(function))
            self.seen.reasons.pop()
        for task in self._tasks:
            self._step(task)

    def _step(self, task: _Task, given: Arguments = _NOTHING) -> None:
        """Let a task go on until it waits."""
        with suppress(ThrownError, RecursionError):
            try:
                if task.loops:
                    if self._is_last_round(*task.loops[-1]):
                        task.loops.pop()
                        task.is_done = not task.loops
                elif task.function is not None and not task.is_done:
                    self.seen.is_starting = task.is_done = task.is_thread
                    dispatch(self.machine, task.function, given)
            except WaitsError as wait:
                task.loops.append((wait.node, wait.frame))
        self.seen.is_starting = False

    def _is_last_round(self, node: ir.While, frame: StackFrame) -> bool:
        """Run a round of a loop; return whether it was the last."""
        if self.seen.truth(self.machine.evaluate(node.test, frame)) is False:
            return True
        if self.machine.execute(node.body, frame) in {"break", "return", "raise"}:
            return True
        self.machine.execute(node.step, frame)
        return False


def _is_zeroed(write: Write) -> bool:
    """Return whether a place held something of the message, and holds zero."""
    storage, key, old = write
    was_message = isinstance(old, (av.Scalar, av.Unknown)) and old.tainted & av.MESSAGE
    new = storage.get(key)
    return bool(was_message) and isinstance(new, av.Scalar) and not new.value


def _is_change(write: Write) -> bool:
    """Return whether a place holds another number or text than before; times do not count."""
    storage, key, old = write
    new = storage.get(key)
    if not (isinstance(old, av.Scalar) and isinstance(new, av.Scalar)):
        return False
    return old.value != new.value and not (old.tainted | new.tainted) & av.CLOCK


def _is_of_message(write: Write) -> bool:
    new: av.Value = write[0].get(write[1], av.NONE)
    number = new.value if isinstance(new, av.Scalar) else None
    is_small = isinstance(number, (int, float)) and abs(number) < SMALL
    return av.taint(new) & av.MESSAGE != 0 and not is_small
