"""The abstract machine: runs a program's IR on values that may be known in part only.

Where a condition is decided, one side runs; where it is not, both do, from the same state. Loops
over what is known are unrolled; others run once, with what they change made unknown. What is
called by a library nobody sees (callbacks, threads, virtual methods) runs after the program.
`doubts` counts what may have thrown while a `try` runs.
"""

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from typing import TypeAlias

from rtron.sources.code.interpreter.abstract_values.value_types import (
    OPEN,
    ClassValue,
    FunctionValue,
    Hole,
    Instance,
    Known,
    ListValue,
    MapValue,
    Value,
    join,
)
from rtron.sources.code.interpreter.cpp.overload_resolution import choose
from rtron.sources.code.interpreter.execution.arguments import Arguments
from rtron.sources.code.interpreter.execution.declaration_recorder import Recorder
from rtron.sources.code.interpreter.execution.exceptions import may_fail, may_throw
from rtron.sources.code.interpreter.execution.language_runtime import World
from rtron.sources.code.interpreter.execution.stack_frame import Frame
from rtron.sources.code.interpreter.execution.undo_log import Trail
from rtron.sources.code.ir import Expr, Function, Stmt
from rtron.vocabulary import Evidence

MAX_STEPS = 800_000
MAX_ASIDE = 4_000
MAX_CALLS = 48
MAX_SAME = 3
MAX_HANDED = 1_000
MAX_ALIKE = 128
"""How many callbacks of one function are run: as often as a loop is unrolled."""

Outcome: TypeAlias = str | None
"""How a block ended: "return", "break", "continue", "raise", or None where it goes on."""


class StepsExceededError(Exception):
    """The program is larger than what is run of it."""


class ThrownError(Exception):
    """An exception of the scanned program that is certain: its class's name, and its bases'.

    `open` says that not all of the bases are known.
    """

    def __init__(self, *names: str, open: bool = False) -> None:
        super().__init__(names[0])
        self.names = names
        self.open = open

    @property
    def name(self) -> str:
        """The name of its class."""
        return self.names[0]


@dataclass(eq=False, slots=True)
class Machine:
    """The state of one run: what was written, what was declared, what is still to be called."""

    world: World
    recorder: Recorder
    evaluators: dict[type, Callable[["Machine", "Expr", Frame], Value]]
    executors: dict[type, Callable[["Machine", "Stmt", Frame], Outcome]]
    trail: Trail = field(default_factory=Trail)
    pending: list[FunctionValue] = field(default_factory=list)
    deferred: list[Callable[[], object]] = field(default_factory=list)
    handed: list[FunctionValue] = field(default_factory=list)
    escaped: list[Function] = field(default_factory=list)
    setters: list[Function] = field(default_factory=list)
    asked: set[str] = field(default_factory=set)
    called_back: int = 0
    instances: list[Value] = field(default_factory=list)
    volatile: frozenset[str] = frozenset()
    shared: set[int] = field(default_factory=set)
    transitions: set[tuple[int, str]] = field(default_factory=set)
    parameters: dict[str, Value] = field(default_factory=dict)
    joining: dict[tuple[str, int, str], bool] = field(default_factory=dict)
    joining_at: int = 0
    ran: set[tuple[str, int, str]] = field(default_factory=set)
    catching: list[tuple[str, ...]] = field(default_factory=list)
    doubts: int = 0
    discovering: int = 0
    matters: Callable[["Machine", Function], bool] = lambda machine, function: True
    _steps: int = 0
    _limit: int = MAX_STEPS
    _loops: int = 0
    _stack: list[Function] = field(default_factory=list)

    @property
    def spent(self) -> int:
        """How many steps the program has taken."""
        return self._steps

    def work(self, steps: int) -> None:
        """Count the steps of what takes several; raise StepsExceededError for too many."""
        self._steps += steps
        if self._steps > self._limit:
            raise StepsExceededError

    def evaluate(self, node: Expr, frame: Frame) -> Value:
        """Return the value of an expression."""
        self._steps += 1
        if self._steps > self._limit:
            raise StepsExceededError
        value = self.evaluators[type(node)](self, node, frame)
        if self.catching and may_throw(node, value, dynamic=not self.world.by_reference):
            self.doubts += 1
        return value

    def execute(self, block: tuple[Stmt, ...], frame: Frame) -> Outcome:
        """Run statements until one ends the block."""
        for statement in block:
            self._steps += 1
            if self._steps > self._limit:
                raise StepsExceededError
            if self.catching and may_fail(statement, dynamic=not self.world.by_reference):
                self.doubts += 1
            outcome = self.executors[type(statement)](self, statement, frame)
            if outcome is not None:
                return outcome
        return None

    def call(self, called: FunctionValue, arguments: Arguments) -> Value:
        """Call a scanned function; recursion that does not end is a hole."""
        if len(called.overloads) > 1:
            called = called.chosen(choose(called.overloads, arguments))
        function = called.function
        if function.body is None or not self._may_enter(function):
            self.doubts += 1
            self._note_left(function, arguments)
            return Hole(f"{function.name}()", type=function.returns)
        self.hand_on(arguments)
        frame = self.world.frame(called, arguments)
        try:
            ended = self._run_within(function, frame)
        except ThrownError:
            if not frame.returns:
                raise
            self.doubts += 1
            ended = True
        if not ended:
            return Hole(f"{function.name}()", type=function.returns)
        if frame.yields:
            return ListValue({"items": tuple(frame.yields)})
        return join(frame.returns)

    def _run_within(self, function: Function, frame: Frame) -> bool:
        """Run a function; one that joins no nodes may take few steps. Tell whether it ended."""
        if self.matters(self, function):
            self.run(function, frame)
            return True
        outer, depth = self._limit, len(self._stack)
        self._limit = min(outer, self._steps + MAX_ASIDE)
        try:
            self.run(function, frame)
        except StepsExceededError:
            del self._stack[depth:]
            if self._limit == outer:
                raise
            self.doubts += 1
            return False
        finally:
            self._limit = outer
        return True

    def run(self, function: Function, frame: Frame) -> None:
        """Run a function's body in a frame that is ready."""
        if not self._may_enter(function):
            return
        self.ran.add((function.file, function.line, function.name))
        self._stack.append(function)
        try:
            self.execute(function.body or (), frame)
        finally:
            self._stack.pop()

    def seen(self, name: str, value: Value) -> Value:
        """Return what a member or global holds; one that callbacks change may hold anything."""
        if name not in self.volatile:
            return value
        if isinstance(value, Known):
            return join((value, Hole(name)))
        if isinstance(value, ListValue) and not value.open:
            self.trail.open(value.fields)
        elif isinstance(value, MapValue) and not value.open:
            self.trail.set(value.fields, OPEN, Hole(name))
        return value

    def escape(self, value: Value | None) -> None:
        """Remember a function, or an object that is called like one, for somebody else to call."""
        if isinstance(value, Instance) and isinstance(value.type, ClassValue):
            name = "operator()" if self.world.by_reference else "__call__"
            value = self.world.attribute(value, name, ())
        if isinstance(value, FunctionValue):
            self._wait(value)

    def _wait(self, value: FunctionValue) -> None:
        """Remember a callback once; too many of one function are noted if they could join nodes."""
        function = value.function
        alike = [other for other in self.pending if other.function is function]
        if any(_same_call(value, other) for other in alike):
            return
        if len(alike) < MAX_ALIKE:
            self.pending.append(value)
            self.escaped.append(function)
        elif self.matters(self, function):
            place = Evidence(file=function.file, line=function.line)
            self.recorder.unresolved(function.name, "more callbacks than are run", place)

    def hand_on(self, arguments: Arguments) -> None:
        """Remember the functions that a call passes, in case that nothing seen calls them."""
        if self.recorder.site.ros > 1 and len(self.handed) < MAX_HANDED:
            given = [value for value in arguments.values if isinstance(value, FunctionValue)]
            self.handed.extend(value for value in given if value not in self.handed)

    @contextmanager
    def looping(self) -> Iterator[int]:
        """Run a loop; what is given is how many are around its body."""
        self._loops += 1
        try:
            yield self._loops
        finally:
            self._loops -= 1

    @contextmanager
    def budget(self, steps: int) -> Iterator[None]:
        """Run something that may take so many steps."""
        before, self._limit = self._limit, self._steps + steps
        try:
            yield
        finally:
            self._limit = before

    @contextmanager
    def unheard(self) -> Iterator[None]:
        """Run something only to see what it changes: what it declares is not recorded."""
        self.discovering += 1
        self.recorder.muted += 1
        try:
            yield
        finally:
            self.recorder.muted -= 1
            self.discovering -= 1

    def _note_left(self, function: Function, arguments: Arguments) -> None:
        """Note a call that goes too deep, if it could join nodes."""
        if function.body is not None and self.matters(self, function):
            self.recorder.unresolved(
                f"{function.name}()", "calls itself, or too deep", arguments.evidence
            )

    def _may_enter(self, function: Function) -> bool:
        same = [active for active in self._stack if active is function]
        return len(self._stack) < MAX_CALLS and len(same) < MAX_SAME


def _same_call(value: FunctionValue, other: FunctionValue) -> bool:
    """Tell whether two callbacks of one function are called with the same."""
    return (
        value.owner is other.owner
        and value.closure is other.closure
        and value.given == other.given
        and value.named == other.named
    )
