"""What leaves a program as it runs in silence, and what of the message decided that."""

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field

from rtron.sources.code import ir
from rtron.sources.code.interpreter import abstract_values as av
from rtron.sources.code.interpreter.execution.abstract_machine import AbstractMachine
from rtron.sources.code.interpreter.execution.calls import truth_of
from rtron.sources.code.interpreter.execution.stack_frame import StackFrame
from rtron.sources.code.silent_library import leaves
from rtron.vocabulary import Evidence

MESSAGE = av.Unknown("message", av.MESSAGE)
_MAX_SECONDS = 1e6


@dataclass(frozen=True, slots=True, kw_only=True)
class Output:
    """What left a program: how it was sent, in which round, and what.

    `target` is the object or, of a function alone, its own name; `publisher` the topic.
    `is_because` says that the message decided that it is sent, `is_either` that another message
    would not, `is_doubtful` that something which is not known decides.
    """

    round: int
    target: str
    function: str
    leaves: tuple[av.Value, ...]
    place: Evidence
    publisher: str = ""
    is_because: bool = False
    is_either: bool = False
    is_doubtful: bool = False
    is_choice: bool = False


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
    message was read later; `handed` are functions that the outside got and may call,
    `late_tasks` those that were started since the message came. `because`
    counts the branches around what runs that the message decides.
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
    because: int = 0
    doubts: int = 0
    _either: int = 0
    _others: int = 0
    _answers: dict[tuple[int, str], tuple[bool, float, float | None]] = field(default_factory=dict)

    def truth(self, value: av.Value) -> bool | None:
        """Return whether a value counts as true; a message does."""
        is_whole = isinstance(value, av.Unknown) and value == MESSAGE
        return True if is_whole else truth_of(self.machine, value)

    def send(
        self,
        target: str,
        function: str,
        values: tuple[av.Value, ...],
        place: Evidence,
        publisher: str = "",
    ) -> None:
        """Note an output."""
        sent = Output(
            round=self.round,
            target=target,
            function=function,
            leaves=leaves(values),
            place=place,
            publisher=publisher,
            is_because=self.because > 0,
            is_either=self._either > 0,
            is_doubtful=self.doubts > 0,
            is_choice=any(isinstance(each, av.Choice) for each in values),
        )
        self.outputs.append(sent)

    def caused(self, value: av.Value) -> av.Value:
        """Mark a value that is kept because of the message, or of the outside; zero is zero."""
        is_zero = isinstance(value, av.Scalar) and not value.value and self.because == 1
        cause = av.MESSAGE if self.because and not is_zero else 0
        return av.with_taint(value, cause | (av.OUTSIDE if self._others else 0))

    @contextmanager
    def branch(self, *, is_decided: bool, flags: int) -> Iterator[None]:
        """Run what a test of values decides that come from `flags`."""
        is_because = flags & (av.MESSAGE | av.CLOCK) == av.MESSAGE
        is_either = is_because and not is_decided
        is_others = not is_decided and flags & av.OUTSIDE != 0
        is_doubtful = not (is_decided or flags & (av.MESSAGE | av.OUTSIDE))
        self.because += is_because
        self._either += is_either
        self.doubts += is_doubtful
        self._others += is_others
        try:
            yield
        finally:
            self.because -= is_because
            self._either -= is_either
            self.doubts -= is_doubtful
            self._others -= is_others

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
