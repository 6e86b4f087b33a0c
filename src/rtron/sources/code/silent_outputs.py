"""What leaves a program as it runs in silence, and what of the message decided that."""

from dataclasses import dataclass, field
from functools import reduce
from operator import or_
from typing import TypeAlias

from rtron.sources.code import ir
from rtron.sources.code.interpreter import abstract_values as av
from rtron.sources.code.interpreter.execution.abstract_machine import AbstractMachine
from rtron.sources.code.interpreter.execution.calls import truth_of
from rtron.sources.code.interpreter.execution.stack_frame import StackFrame
from rtron.sources.code.silent_library import leaves
from rtron.vocabulary import Evidence

MESSAGE = av.Unknown("message", av.MESSAGE)
DECIDED, EITHER, OUTSIDE, DOUBT = 1, 2, 4, 8
"""Why something runs: the message decided it, perhaps another would not; what others write, or
what is not known, decides it."""
_MAX_SECONDS = 1e6
Values: TypeAlias = tuple[av.Value, ...]


@dataclass(frozen=True, slots=True)
class Output:
    """What left a program: how it was sent, in which round, and why.

    `target` is the object or, of a function alone, its own name; `publisher` the topic. `leaves`
    is what was sent, taken apart; of a choice one of them.
    """

    round: int
    target: str
    function: str
    leaves: tuple[av.Value, ...]
    place: Evidence
    publisher: str
    reason: int
    is_choice: bool


@dataclass(frozen=True, slots=True)
class Expiry:
    """A comparison of times that turned out otherwise than before, and after how long."""

    round: int
    seconds: float | None
    place: Evidence


class WaitsError(Exception):
    """A loop that does not end was reached: it runs as a task. Without one, nothing ever comes."""

    def __init__(self, node: ir.While, frame: StackFrame) -> None:
        super().__init__()
        self.node, self.frame = node, frame


@dataclass(eq=False, slots=True)
class SilentState:
    """The state of one run; what is from `outside` may be anything.

    `round` is 0 while the message is handled, `clock` in seconds. `is_starting` says that a thread
    has not come to its loop, `is_timed` that a time was compared, `is_used` that something of the
    message was read later; `handed` are functions that the outside got and may call, `late_tasks`
    those that were started since the message came. `reasons` are those of the branches around what
    runs.
    """

    machine: AbstractMachine
    outside: frozenset[str]
    outputs: list[Output] = field(default_factory=list)
    expiries: list[Expiry] = field(default_factory=list)
    handed: list[av.FunctionValue] = field(default_factory=list)
    late_tasks: list[tuple[av.FunctionValue, str]] = field(default_factory=list)
    round: int = 0
    clock: float = 0.0
    is_starting: bool = False
    is_timed: bool = False
    is_used: bool = False
    reasons: list[int] = field(default_factory=list)
    _answers: dict[tuple[int, str], tuple[bool, float, float | None]] = field(default_factory=dict)

    def truth(self, value: av.Value) -> bool | None:
        """Return whether a value counts as true; a message does."""
        is_whole = isinstance(value, av.Unknown) and value == MESSAGE
        return True if is_whole else truth_of(self.machine, value)

    def send(
        self, target: str, function: str, values: Values, place: Evidence, publisher: str = ""
    ) -> None:
        """Note an output."""
        reason = reduce(or_, self.reasons, 0)
        is_choice = any(isinstance(each, av.Choice) for each in values)
        sent = (self.round, target, function, leaves(values), place, publisher, reason, is_choice)
        self.outputs.append(Output(*sent))

    def caused(self, value: av.Value) -> av.Value:
        """Mark a value that is kept because of the message, or of the outside; zero is zero."""
        causes = sum(each & DECIDED for each in self.reasons)
        is_zero = isinstance(value, av.Scalar) and not value.value and causes == 1
        cause = av.MESSAGE if causes and not is_zero else 0
        is_others = any(each & OUTSIDE for each in self.reasons)
        return av.with_taint(value, cause | (av.OUTSIDE if is_others else 0))

    def note_comparison(
        self, node: ir.Binary, frame: StackFrame, answer: av.Scalar, distance: av.Value
    ) -> None:
        """Note how a comparison of times turns out, and how far the sides are from each other."""
        near = distance.value if isinstance(distance, av.Scalar) else None
        at = (id(node), frame.file)
        before, then, far = self._answers.get(at, (answer.value, self.clock, None))
        self._answers[at] = answer.value, self.clock, near
        if answer.value is not before:
            seconds = _crossing(then, self.clock, far, near)
            line = node.line or (frame.function.line if frame.function else 0)
            self.expiries.append(Expiry(self.round, seconds, Evidence(file=frame.file, line=line)))


def _crossing(then: float, now: float, far: float | None, near: float | None) -> float | None:
    """Return when a distance that is `far` then, and `near` now, is 0; None if it is not known."""
    if far is None or near is None or far == near:
        return None
    seconds = then - far * (now - then) / (near - far)
    return round(seconds, 3) if 0 <= seconds < _MAX_SECONDS else None


def reason_of(flags: int, *, is_decided: bool) -> int:
    """Return why a branch runs whose test is made of what comes from `flags`."""
    reason = DECIDED if flags & (av.MESSAGE | av.CLOCK) == av.MESSAGE else 0
    if is_decided:
        return reason
    reason |= EITHER if reason else 0
    reason |= OUTSIDE if flags & av.OUTSIDE else 0
    return reason if flags & (av.MESSAGE | av.OUTSIDE) else DOUBT
