"""What happens to the soaked app, at random."""

import random
import signal
import time
from collections import Counter
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass

from bench.soak.app import SoakedApp
from bench.soak.base_log import Span
from bench.soak.names import IMAGE_RATES
from rtron.vocabulary import SECOND

_LIMIT_S, _POLL_S = 60.0, 0.2
_INTRUSION_S = (0.5, 3.0)
_FREEZE_S = (0.05, 3.0)
INTRUSION, FREEZE, KILL = "intruder", "guard frozen", "guard killed"
_AFTER = SECOND
"""How long (ns) after a freeze or a kill the guard may still be late for its supervisor."""
WEIGHTS = {
    KILL: 3,
    FREEZE: 2,
    "bulk process killed": 2,
    "bulk process frozen": 2,
    "supervisor killed": 1,
    "navigation restarted": 3,
    "joystick restarted": 1,
    "viewer restarted": 1,
    "stranger restarted": 1,
    "dock restarted": 1,
    "camera changed": 5,
    "person in the way": 3,
    INTRUSION: 2,
}
"""What can happen, and how often beside the others."""


@dataclass(frozen=True, slots=True)
class Fault:
    """What was done, and when."""

    name: str
    span: Span


class RandomFaults:
    """Does one thing after the other to an app; what, a seed decides."""

    def __init__(self, app: SoakedApp, seed: int, only: Sequence[str] = ()) -> None:
        self.history: list[Fault] = []
        self.intruders: list[Span] = []
        """The time of each intruder, from its start to its end."""
        self._is_person_there = False
        self._app = app
        self._random = random.Random(seed)
        self._weights = {name: WEIGHTS[name] for name in only or WEIGHTS}
        self._actions: dict[str, Callable[[], None]] = {
            KILL: lambda: app.send(app.guard(), signal.SIGKILL),
            FREEZE: lambda: self._freeze(app.guard()),
            "bulk process killed": lambda: self._kill("bulk"),
            "bulk process frozen": lambda: self._freeze(*app.pids("bulk")),
            "supervisor killed": self._kill_supervisor,
            "navigation restarted": lambda: self._restart("nav"),
            "joystick restarted": lambda: self._restart("joystick"),
            "viewer restarted": lambda: self._restart("viewer"),
            "stranger restarted": lambda: self._restart("rogue"),
            "dock restarted": lambda: self._restart("dock"),
            "camera changed": self._change_camera,
            "person in the way": lambda: self._turn_person(is_there=True),
            INTRUSION: self._intrude,
        }

    def wait_for_app(self) -> None:
        """Wait until the app has found together: the base moves."""
        _wait_until(self._app.is_driving)

    def act(self, pause_s: tuple[float, float]) -> str:
        """Wait for a while, do one thing, and return what; a person who was there leaves."""
        time.sleep(self._random.uniform(*pause_s))
        (name,) = self._random.choices([*self._weights], [*self._weights.values()])
        was_person_there = self._is_person_there
        begin = time.monotonic_ns()
        self._actions[name]()
        if was_person_there:
            self._turn_person(is_there=False)
        self.history.append(Fault(name, Span(begin, time.monotonic_ns() - begin)))
        return name

    def times(self, *names: str) -> list[int]:
        """Return when something of those names was done, ns."""
        return [each.span.at for each in self.history if each.name in names]

    def intrusions(self) -> list[Span]:
        """Return the times from an intruder's start until a person has cleared it."""
        return self._spans(INTRUSION)

    def longest_clear(self) -> int | None:
        """Return how long (ns) a person needed at most to clear the stop of an intruder that left.

        None without an intruder.
        """
        pairs = zip(self.intrusions(), self.intruders, strict=True)
        return max((until.end - intruder.end for until, intruder in pairs), default=None)

    def count_unexplained(self, stops: Iterable[int]) -> int:
        """Count the supervisor's stops (ns) that no frozen or killed guard explains."""
        spans = [*self._spans(FREEZE), *self._spans(KILL)]
        return sum(not any(each.at <= at < each.end + _AFTER for each in spans) for at in stops)

    def _spans(self, name: str) -> list[Span]:
        return [each.span for each in self.history if each.name == name]

    def counts(self) -> Counter[str]:
        """Return how often each was done."""
        done = Counter(each.name for each in self.history)
        return Counter({name: done[name] for name in self._weights})

    def _kill_supervisor(self) -> None:
        """Kill it, so that the guard ends, too, and start all anew, as a launch does."""
        now = time.monotonic_ns()
        self._app.end("guard", signal.SIGKILL)
        self._app.start("guard")
        self._app.log.wait("its delivery is watched", now, _LIMIT_S)

    def _kill(self, program: str) -> None:
        for pid in self._app.pids(program):
            self._app.send(pid, signal.SIGKILL)

    def _freeze(self, *pids: int) -> None:
        for pid in pids:
            self._app.send(pid, signal.SIGSTOP)
        time.sleep(self._random.uniform(*_FREEZE_S))
        for pid in pids:
            self._app.send(pid, signal.SIGCONT)

    def _restart(self, role: str) -> None:
        gracefully = self._random.random() < 0.5
        self._app.end(role, signal.SIGINT if gracefully else signal.SIGKILL)
        self._app.start(role)

    def _change_camera(self) -> None:
        """End the camera, or start it with one of its rates."""
        if self._app.is_running("camera"):
            self._app.end("camera", signal.SIGKILL)
        else:
            self._app.film(self._random.choice(IMAGE_RATES))

    def _turn_person(self, *, is_there: bool) -> None:
        """Let the detector see a person, or nobody any more."""
        if is_there != self._is_person_there:
            self._is_person_there = is_there
            self._app.send_to("detector", signal.SIGUSR1)

    def _intrude(self) -> None:
        """Let the base hear a node past the guard for a moment; then a person clears the stream."""
        begin = time.monotonic_ns()
        self._app.start("intruder")
        _wait_until(lambda: self._app.has_heard_intruder(begin))
        time.sleep(self._random.uniform(*_INTRUSION_S))
        self._app.end("intruder", signal.SIGKILL)
        self.intruders.append(Span(begin, time.monotonic_ns() - begin))
        _wait_until(self._app.clear)


def _wait_until(condition: Callable[[], bool]) -> None:
    """Wait for a condition, at most for a while: what does not come is judged at the end."""
    deadline = time.monotonic() + _LIMIT_S
    while not condition() and time.monotonic() < deadline:
        time.sleep(_POLL_S)
