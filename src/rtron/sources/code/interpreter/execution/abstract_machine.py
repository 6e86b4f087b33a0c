"""The abstract machine: runs a program's IR on values that may be known in part only.

Where a condition is decided, one side runs; where it is not, both do, from the same state. Loops
over what is known are unrolled; others run once, with what they change made unknown. What is
called by a library (callbacks, threads, virtual methods) runs after the program.
`possible_throws` counts what may have thrown while a `try` runs. `line` is that of the assignment
that is made.
"""

import re
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field, replace
from functools import partial
from typing import TypeAlias

from rtron.sources.code.interpreter.abstract_values.items import list_of
from rtron.sources.code.interpreter.abstract_values.value_types import (
    OPEN,
    ClassValue,
    FunctionValue,
    Instance,
    LibraryClass,
    LibraryFunction,
    ListValue,
    MapValue,
    Scalar,
    Unknown,
    Value,
    is_tainted,
    join,
)
from rtron.sources.code.interpreter.cpp.overload_resolution import choose_overload
from rtron.sources.code.interpreter.execution.arguments import Arguments
from rtron.sources.code.interpreter.execution.declaration_recorder import DeclarationRecorder
from rtron.sources.code.interpreter.execution.exceptions import (
    expression_may_throw,
    statement_may_throw,
)
from rtron.sources.code.interpreter.execution.language_runtime import LanguageRuntime
from rtron.sources.code.interpreter.execution.stack_frame import StackFrame
from rtron.sources.code.interpreter.execution.undo_log import UndoLog
from rtron.sources.code.ir import Expr, Function, Stmt
from rtron.vocabulary import Evidence

_TEXT = re.compile("string|char|text", re.IGNORECASE)
PARTIAL = "partial"
"""The name of a library's function with arguments that it already has: it is run if it escapes."""
MAX_STEPS = 800_000
MAX_IRRELEVANT_STEPS = 4_000
MAX_DYNAMIC_STEPS = 20_000
"""The steps of a function that joins no nodes, and of one that calls what it does not name."""
MAX_IRRELEVANT_SUM = 8_000
"""The steps of all calls, by callbacks, of a function that joins no nodes and handles no text."""
MAX_CALLS = 48
MAX_RECURSION = 3
MAX_PASSED_FUNCTIONS = 1_000
MAX_CALLBACKS_PER_FUNCTION = 128
"""How many callbacks of one function are run: as often as a loop is unrolled."""

Outcome: TypeAlias = str | None
"""How a block ended: "return", "break", "continue", "raise", or None where it goes on."""


class EndError(Exception):
    """What ends a program before all of it is run; `place` is the statement that did."""

    place: Evidence | None = None


class StepsExceededError(EndError):
    """The program is larger than what is run of it."""


class ThrownError(EndError):
    """An exception of the scanned program that is certain: its class's name, and its bases'.

    `has_unknown_bases` says that not all of the bases are known, `is_value` that it is a number,
    a text or a variable of C++, whose type a handler may have.
    """

    def __init__(
        self, *names: str, has_unknown_bases: bool = False, is_value: bool = False
    ) -> None:
        super().__init__(names[0])
        self.names = names
        self.has_unknown_bases = has_unknown_bases
        self.is_value = is_value

    @property
    def name(self) -> str:
        """The name of its class."""
        return self.names[0]


@dataclass(eq=False, slots=True)
class AbstractMachine:
    """The state of one run: what was written, what was declared, what is still to be called.

    `lambdas` are those of C++ that were made, by the identity of their bodies.
    """

    runtime: LanguageRuntime
    recorder: DeclarationRecorder
    evaluators: dict[type, Callable[["AbstractMachine", "Expr", StackFrame], Value]]
    executors: dict[type, Callable[["AbstractMachine", "Stmt", StackFrame], Outcome]]
    undo_log: UndoLog = field(default_factory=UndoLog)
    pending_callbacks: list[FunctionValue] = field(default_factory=list)
    deferred_actions: list[Callable[[], object]] = field(default_factory=list)
    passed_functions: list[FunctionValue] = field(default_factory=list)
    escaped_functions: list[Function] = field(default_factory=list)
    callbacks_at: dict[Evidence | None, list[Function]] = field(default_factory=dict)
    parameter_callbacks: list[Function] = field(default_factory=list)
    module_loops: list[Function] = field(default_factory=list)
    unknown_method_names: set[str] = field(default_factory=set)
    next_callback: int = 0
    instances: list[Value] = field(default_factory=list)
    volatile: frozenset[str] = frozenset()
    pointer_held: set[int] = field(default_factory=set)
    started_callbacks: set[tuple[int, str]] = field(default_factory=set)
    parameters: dict[str, Value] = field(default_factory=dict)
    joins_cache: dict[tuple[str, int, str], bool] = field(default_factory=dict)
    joins_cache_version: int = 0
    executed_functions: set[tuple[str, int, str]] = field(default_factory=set)
    executed_bodies: set[int] = field(default_factory=set)
    lambdas: dict[int, Function] = field(default_factory=dict)
    active_handlers: list[tuple[str, ...]] = field(default_factory=list)
    possible_throws: int = 0
    trial_depth: int = 0
    line: int = 0
    is_relevant: Callable[["AbstractMachine", Function], bool] = lambda machine, function: True
    _steps: int = 0
    _step_limit: int = field(default_factory=lambda: MAX_STEPS)
    _step_budget: int = field(default_factory=lambda: MAX_STEPS)
    _relevant_steps: int = 0
    _irrelevant_steps: dict[tuple[str, int, str], int] = field(default_factory=dict)
    _loop_depth: int = 0
    _call_stack: list[Function] = field(default_factory=list)

    @property
    def steps_taken(self) -> int:
        """How many steps the program has taken."""
        return self._steps

    def count_steps(self, steps: int) -> None:
        """Count the steps of what takes several; raise StepsExceededError for too many."""
        self._steps += steps
        if self._steps > self._step_limit:
            raise StepsExceededError

    def evaluate(self, node: Expr, frame: StackFrame) -> Value:
        """Return the value of an expression."""
        self._steps += 1
        if self._steps > self._step_limit:
            raise StepsExceededError
        value = self.evaluators[type(node)](self, node, frame)
        if self.active_handlers and expression_may_throw(
            node, value, dynamic=not self.runtime.passes_by_reference
        ):
            self.possible_throws += 1
        return value

    def execute(self, block: tuple[Stmt, ...], frame: StackFrame) -> Outcome:
        """Run statements until one ends the block."""
        statement: Stmt | None = None
        try:
            for statement in block:
                self._steps += 1
                if self._steps > self._step_limit:
                    raise StepsExceededError
                if self.active_handlers and statement_may_throw(
                    statement, dynamic=not self.runtime.passes_by_reference
                ):
                    self.possible_throws += 1
                outcome = self.executors[type(statement)](self, statement, frame)
                if outcome is not None:
                    return outcome
        except EndError as error:
            line = getattr(statement, "line", 0)
            if error.place is None and line:
                error.place = Evidence(file=frame.file, line=line)
            raise
        return None

    def call(self, called: FunctionValue, arguments: Arguments) -> Value:
        """Call a scanned function; recursion that does not end gives an Unknown."""
        if len(called.overloads) > 1:
            typed = replace(arguments, types=called.types) if called.types else arguments
            called = called.with_overload(choose_overload(called.overloads, typed))
        function = called.function
        if function.body is None or not self._may_enter(function):
            self.possible_throws += 1
            self._note_skipped_call(function, arguments)
            return Unknown(f"{function.name}()", type=function.returns)
        self.note_passed_functions(arguments)
        frame = self.runtime.call_frame(called, arguments)
        try:
            ended = self._run_bounded(function, frame)
        except ThrownError:
            if not frame.returns:
                raise
            self.possible_throws += 1
            ended = True
        if not ended:
            self.forget_references(function, arguments)
            return Unknown(f"{function.name}()", type=function.returns)
        if frame.yields:
            return list_of(frame.yields, "generator")
        return join(frame.returns)

    def _run_bounded(self, function: Function, frame: StackFrame) -> bool:
        """Run a function; one that joins no nodes may take few steps. Tell whether it ended."""
        if self.is_relevant(self, function):
            self._run_relevant(function, frame)
            return True
        may_join = self.runtime.calls_unknown(function)
        most = MAX_DYNAMIC_STEPS if may_join else MAX_IRRELEVANT_STEPS
        if self.recorder.is_spinning and not (may_join or _may_handle_text(function)):
            most = min(most, MAX_IRRELEVANT_SUM - self._irrelevant_steps.get(function.key, 0))
        if most <= 0:
            self.possible_throws += 1
            return False
        return self._run_in_steps(function, frame, most, is_noted=may_join)

    def _run_relevant(self, function: Function, frame: StackFrame) -> None:
        """Run a function whose steps do not count to what the functions around it may take."""
        outer, before, relevant = self._step_limit, self._steps, self._relevant_steps
        self._step_limit = self._step_budget
        try:
            self.run(function, frame)
        finally:
            spent = self._steps - before if outer < self._step_budget else 0
            self._relevant_steps = relevant + spent
            self._step_limit = min(outer + spent, self._step_budget)

    def _run_in_steps(
        self, function: Function, frame: StackFrame, most: int, *, is_noted: bool
    ) -> bool:
        """Run a function that may take so many steps; tell whether it ended."""
        outer, before, depth = self._step_limit, self._steps, len(self._call_stack)
        relevant = self._relevant_steps
        self._step_limit = min(outer, before + most)
        try:
            self.run(function, frame)
        except StepsExceededError:
            del self._call_stack[depth:]
            if self._steps > outer + self._relevant_steps - relevant:
                raise
            self.possible_throws += 1
            if is_noted:
                place = Evidence(file=function.file, line=function.line)
                self.recorder.add_too_large(function.name, place)
            return False
        finally:
            relevant = self._relevant_steps - relevant
            self._step_limit = min(outer + relevant, self._step_budget)
            if self.recorder.is_spinning:
                spent = self._irrelevant_steps.get(function.key, 0) + self._steps - before
                self._irrelevant_steps[function.key] = spent - relevant
        return True

    def forget_references(self, function: Function, arguments: Arguments) -> None:
        """Forget what a function gets by reference that is not run to its end, but node handles."""
        for param, slot in zip(function.params, arguments.slots, strict=False):
            before = slot.holder.get(slot.key) if slot is not None else None
            is_handle = isinstance(before, Instance) and isinstance(before.type, LibraryClass)
            if param.reference and slot is not None and not is_handle:
                after = Unknown(slot.label, is_tainted(before) if before else False)
                self.undo_log.set(*slot, after)

    def run(self, function: Function, frame: StackFrame) -> None:
        """Run a function's body in a frame that is ready."""
        if not self._may_enter(function):
            self._note_skipped_call(function, Arguments(line=function.line, frame=frame))
            return
        self.executed_functions.add(function.key)
        self.executed_bodies.add(id(function.body))
        self._call_stack.append(function)
        try:
            outcome = self.execute(function.body or (), frame)
        finally:
            self._call_stack.pop()
        if outcome == "raise" and function.name == "main" and self.runtime.passes_by_reference:
            location = Evidence(file=function.file, line=function.line)
            why = "an exception ends it before all of it is run"
            self.recorder.add_partly_read(function.name, why, location)

    def volatile_value(self, name: str, value: Value) -> Value:
        """Return what a member or global holds; one that callbacks change may hold anything."""
        if name not in self.volatile:
            return value
        if isinstance(value, Scalar):
            return join((value, Unknown(name)))
        if isinstance(value, ListValue) and not value.open:
            self.undo_log.mark_open(value.fields)
        elif isinstance(value, MapValue) and not value.open:
            self.undo_log.set(value.fields, OPEN, Unknown(name))
        return value

    def escape(self, value: Value | None, at: Evidence | None = None) -> None:
        """Remember a function, or an object that is called like one, as a callback given there."""
        if isinstance(value, Instance) and isinstance(value.type, ClassValue):
            name = "operator()" if self.runtime.passes_by_reference else "__call__"
            value = self.runtime.attribute(value, name, ())
        if isinstance(value, FunctionValue):
            self._queue_callback(value)
            self.callbacks_at.setdefault(at, []).append(value.function)
        elif isinstance(value, LibraryFunction) and value.name == PARTIAL:
            given = Arguments(frame=StackFrame(file=""))
            self.deferred_actions.append(partial(value.call, self, value.owner, given))

    def escape_arguments(self, arguments: Arguments) -> None:
        """Remember every function among the arguments of a call."""
        for value in arguments.all_values:
            self.escape(value, arguments.evidence)

    def _queue_callback(self, value: FunctionValue) -> None:
        """Remember a callback once; too many of one function are noted if they could join nodes."""
        function = value.function
        same_function = [other for other in self.pending_callbacks if other.function is function]
        has_room = len(same_function) < MAX_CALLBACKS_PER_FUNCTION
        if not (has_room or self.is_relevant(self, function)):
            return
        if any(_same_call(value, other) for other in same_function):
            return
        if has_room:
            self.pending_callbacks.append(value)
            self.escaped_functions.append(function)
        else:
            location = Evidence(file=function.file, line=function.line)
            self.recorder.add_unresolved(function.name, "more callbacks than are run", location)

    def note_passed_functions(self, arguments: Arguments) -> None:
        """Remember the functions that a call passes, in case that nothing seen calls them."""
        if self.recorder.site.ros > 1 and len(self.passed_functions) < MAX_PASSED_FUNCTIONS:
            given = [value for value in arguments.values if isinstance(value, FunctionValue)]
            self.passed_functions.extend(
                value for value in given if value not in self.passed_functions
            )

    @contextmanager
    def enter_loop(self) -> Iterator[int]:
        """Run a loop; what is given is how many are around its body."""
        self._loop_depth += 1
        try:
            yield self._loop_depth
        finally:
            self._loop_depth -= 1

    @contextmanager
    def step_budget(self, steps: int) -> Iterator[None]:
        """Run something that may take so many steps."""
        before = self._step_limit, self._step_budget
        self._step_limit = self._step_budget = self._steps + steps
        try:
            yield
        finally:
            self._step_limit, self._step_budget = before

    @contextmanager
    def trial_run(self) -> Iterator[None]:
        """Run something only to see what it changes: what it declares is not recorded."""
        self.trial_depth += 1
        self.recorder.muted += 1
        try:
            yield
        finally:
            self.recorder.muted -= 1
            self.trial_depth -= 1

    def _note_skipped_call(self, function: Function, arguments: Arguments) -> None:
        """Note a call that goes too deep, if it could join nodes."""
        if function.body is not None and self.is_relevant(self, function):
            self.recorder.add_unresolved(
                f"{function.name}()", "calls itself, or too deep", arguments.evidence
            )

    def _may_enter(self, function: Function) -> bool:
        same = [active for active in self._call_stack if active is function]
        return len(self._call_stack) < MAX_CALLS and len(same) < MAX_RECURSION


def _same_call(value: FunctionValue, other: FunctionValue) -> bool:
    """Tell whether two callbacks of one function are called with the same."""
    return (
        value.owner is other.owner
        and value.closure is other.closure
        and value.bound_arguments == other.bound_arguments
        and value.bound_keywords == other.bound_keywords
    )


def _may_handle_text(function: Function) -> bool:
    """Tell whether a function gets or gives a text, by its types: what has none may be one."""
    types = (function.returns, *(param.type for param in function.params))
    return any(
        type is None or type.name in function.template or _TEXT.search(str(type)) for type in types
    )
