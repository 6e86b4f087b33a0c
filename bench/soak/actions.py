"""What happens to the soaked app, at random."""

import random
import signal
import time
from collections import Counter
from typing import TYPE_CHECKING

from bench.soak.app import SoakedApp

if TYPE_CHECKING:
    from collections.abc import Callable

_CLEAR_S = 60.0
_RETRY_S = 1.0
_INTRUSION_S = (0.5, 3.0)
_FREEZE_S = (0.05, 3.0)


class RandomActions:
    """Does one thing after the other to an app; what, a seed decides."""

    def __init__(self, app: SoakedApp, seed: int) -> None:
        self.done: Counter[str] = Counter()
        self.refused_clears = 0
        self.seed = seed
        self._app = app
        self._random = random.Random(seed)
        self._actions: tuple[tuple[str, int, Callable[[], None]], ...] = (
            ("guard killed", 3, lambda: app.send(app.guard(), signal.SIGKILL)),
            ("guard frozen", 2, lambda: self._freeze(app.guard())),
            ("bulk process killed", 2, lambda: self._kill("bulk")),
            ("bulk process frozen", 2, lambda: self._freeze(*app.pids("bulk"))),
            ("supervisor killed", 1, self._kill_supervisor),
            ("navigation restarted", 3, lambda: self._restart("nav")),
            ("viewer restarted", 1, lambda: self._restart("viewer")),
            ("stranger restarted", 1, lambda: self._restart("rogue")),
            ("pictures on or off", 5, self._toggle_camera),
            ("intruder", 2, self._intrude),
        )

    def act(self) -> str:
        """Do one thing, and tell what."""
        weights = [weight for _, weight, _ in self._actions]
        ((name, _, action),) = self._random.choices(self._actions, weights)
        action()
        self.done[name] += 1
        return name

    def _kill_supervisor(self) -> None:
        """Kill it, and wait until the next one watches: before, nobody stops for the guard."""
        now = time.monotonic_ns()
        self._kill("supervisor")
        self._app.log.wait("its delivery is watched", now, _CLEAR_S)

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

    def _toggle_camera(self) -> None:
        if self._app.is_running("camera"):
            self._app.end("camera")
        else:
            self._app.start("camera")

    def _intrude(self) -> None:
        """Let a node go past the guard for a moment; then a person clears the stream."""
        self._app.start("intruder")
        time.sleep(self._random.uniform(*_INTRUSION_S))
        self._app.end("intruder", signal.SIGKILL)
        deadline = time.monotonic() + _CLEAR_S
        while not self._app.clear() and time.monotonic() < deadline:
            self.refused_clears += 1
            time.sleep(_RETRY_S)
