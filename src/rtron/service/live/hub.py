"""What is live: which guards are connected, what they are at now, and who listens to it.

Every method may be called from any thread.
"""

from dataclasses import dataclass
from threading import Lock
from typing import Protocol

from pydantic import TypeAdapter

from rtron.service.live.listener import Listener, Live
from rtron.vocabulary import GuardState, Settings

_STATE = TypeAdapter(GuardState)


class Link(Protocol):
    """The connection of one guard, as the hub uses it; both may be called from any thread."""

    def push(self, settings: Settings) -> None:
        """Send settings, unless newer ones are on their way."""

    def replace(self) -> None:
        """End the connection: the same robot's guard has made another one."""


@dataclass(slots=True)
class _Robot:
    link: Link | None = None
    state: GuardState | None = None
    dropped: int = 0
    dry_run: bool = False
    pushed: Settings = Settings()  # noqa: RUF009 - frozen


_UNSEEN = _Robot()


class Hub:
    """The live side of the security service; what it holds is bounded by the number of robots."""

    def __init__(self) -> None:
        self._lock = Lock()
        self._robots: dict[str, _Robot] = {}
        self._listeners: set[Listener] = set()

    def connected(self, robot: str) -> bool:
        """Tell whether the robot's guard is connected."""
        with self._lock:
            return self._seen(robot).link is not None

    def connections(self) -> int:
        """Return how many guards are connected."""
        with self._lock:
            return sum(each.link is not None for each in self._robots.values())

    def state(self, robot: str) -> GuardState | None:
        """Return what the robot's guard last said it is at; None while it is not connected."""
        with self._lock:
            return self._seen(robot).state

    def dropped(self, robot: str) -> int:
        """Return how many events of the robot are known to be lost."""
        with self._lock:
            return self._seen(robot).dropped

    def dry_run(self, robot: str) -> bool:
        """Tell whether the robot's guard only says what it would do."""
        with self._lock:
            return self._seen(robot).dry_run

    def pushed(self, robot: str) -> Settings:
        """Return the newest settings that were pushed to the robot, connected or not."""
        with self._lock:
            return self._seen(robot).pushed

    def push(self, robot: str, settings: Settings) -> None:
        """Send settings to the robot's guard if it is connected; if not, it asks when it is."""
        with self._lock:
            known = self._robots.setdefault(robot, _Robot())
            known.pushed = max(known.pushed, settings, key=_revision)
            link = known.link
        if link is not None:
            link.push(settings)

    def tell(self, live: Live) -> None:
        """Tell a live message to everyone who listens."""
        with self._lock:
            listeners = tuple(self._listeners)
        for listener in listeners:
            listener.put(live)

    def listen(self) -> Listener:
        """Return an async iterator of what is live from now on; close it, or use it in `with`."""
        listener = Listener(self._forget)
        with self._lock:
            self._listeners.add(listener)
        return listener

    @property
    def listened(self) -> bool:
        """Whether anyone listens."""
        return bool(self._listeners)

    def join(self, robot: str, link: Link, *, dry_run: bool) -> bool:
        """Take a guard's connection; return whether it replaces another one of the robot."""
        with self._lock:
            before = self._seen(robot)
            old = before.link
            self._robots[robot] = _Robot(link, None, before.dropped, dry_run, before.pushed)
        replaced = old is not None and old is not link
        if old is not None and replaced:
            old.replace()
        self.tell(_connection(robot, connected=True))
        return replaced

    def leave(self, robot: str, link: Link) -> None:
        """Take note that a connection has ended, unless another has replaced it."""
        with self._lock:
            known = self._seen(robot)
            if known.link is not link:
                return
            known.link, known.state = None, None
        self.tell(_connection(robot, connected=False))

    def update(self, robot: str, link: Link, state: GuardState) -> None:
        """Take what a guard is at, unless its connection has been replaced."""
        with self._lock:
            known = self._seen(robot)
            if known.link is not link:
                return
            known.state = state
        if self.listened:
            now = _STATE.dump_python(state, mode="json")
            self.tell({"type": "state", "robot": robot, "state": now})

    def lose(self, robot: str, events: int) -> None:
        """Count events of a robot that are lost for ever."""
        with self._lock:
            self._robots.setdefault(robot, _Robot()).dropped += events

    def _seen(self, name: str) -> _Robot:
        return self._robots.get(name, _UNSEEN)

    def _forget(self, listener: Listener) -> None:
        with self._lock:
            self._listeners.discard(listener)


def _revision(settings: Settings) -> int:
    return settings.revision


def _connection(robot: str, *, connected: bool) -> Live:
    return {"type": "connection", "robot": robot, "connected": connected}
