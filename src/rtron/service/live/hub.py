"""What is live: which guards are connected, what they are at now, and who listens to it.

Every method may be called from any thread.
"""

from dataclasses import dataclass
from threading import Lock
from typing import Protocol

from pydantic import TypeAdapter

from rtron.service.live.listener import Listener, LiveMessage
from rtron.vocabulary import GuardState, Settings

_STATE = TypeAdapter(GuardState)


class GuardLink(Protocol):
    """The connection of one guard, as the hub uses it; both may be called from any thread."""

    def push(self, settings: Settings) -> None:
        """Send settings, unless newer ones are on their way."""

    def replace(self) -> None:
        """End the connection: the same robot's guard has made another one."""


@dataclass(slots=True)
class _LiveRobot:
    link: GuardLink | None = None
    state: GuardState | None = None
    dropped: int = 0
    dry_run: bool = False
    pushed: Settings = Settings()  # noqa: RUF009 - frozen


_NO_ROBOT = _LiveRobot()


class Hub:
    """The live side of the security service; what it holds is bounded by the number of robots."""

    def __init__(self) -> None:
        self._lock = Lock()
        self._robots: dict[str, _LiveRobot] = {}
        self._listeners: set[Listener] = set()

    def is_connected(self, robot: str) -> bool:
        """Tell whether the robot's guard is connected."""
        with self._lock:
            return self._robot(robot).link is not None

    def connection_count(self) -> int:
        """Return how many guards are connected."""
        with self._lock:
            return sum(each.link is not None for each in self._robots.values())

    def state(self, robot: str) -> GuardState | None:
        """Return what the robot's guard last said it is at; None while it is not connected."""
        with self._lock:
            return self._robot(robot).state

    def lost_event_count(self, robot: str) -> int:
        """Return how many events of the robot are known to be lost."""
        with self._lock:
            return self._robot(robot).dropped

    def is_dry_run(self, robot: str) -> bool:
        """Tell whether the robot's guard only says what it would do."""
        with self._lock:
            return self._robot(robot).dry_run

    def last_pushed_settings(self, robot: str) -> Settings:
        """Return the newest settings that were pushed to the robot, connected or not."""
        with self._lock:
            return self._robot(robot).pushed

    def push(self, robot: str, settings: Settings) -> None:
        """Send settings to the robot's guard if it is connected; if not, it asks when it is."""
        with self._lock:
            robot_state = self._robots.setdefault(robot, _LiveRobot())
            robot_state.pushed = max(robot_state.pushed, settings, key=_revision)
            link = robot_state.link
        if link is not None:
            link.push(settings)

    def broadcast(self, message: LiveMessage) -> None:
        """Tell a live message to everyone who listens."""
        with self._lock:
            listeners = tuple(self._listeners)
        for listener in listeners:
            listener.put(message)

    def listen(self) -> Listener:
        """Return an async iterator of what is live from now on; close it, or use it in `with`."""
        listener = Listener(self._remove_listener)
        with self._lock:
            self._listeners.add(listener)
        return listener

    @property
    def has_listeners(self) -> bool:
        """Whether anyone listens."""
        return bool(self._listeners)

    def register(self, robot: str, link: GuardLink, *, dry_run: bool) -> bool:
        """Take a guard's connection; return whether it replaces another one of the robot."""
        with self._lock:
            previous = self._robot(robot)
            previous_link = previous.link
            self._robots[robot] = _LiveRobot(link, None, previous.dropped, dry_run, previous.pushed)
        is_replacing = previous_link is not None and previous_link is not link
        if previous_link is not None and is_replacing:
            previous_link.replace()
        self.broadcast(_connection_message(robot, connected=True))
        return is_replacing

    def unregister(self, robot: str, link: GuardLink) -> None:
        """Take note that a connection has ended, unless another has replaced it."""
        with self._lock:
            robot_state = self._robot(robot)
            if robot_state.link is not link:
                return
            robot_state.link, robot_state.state = None, None
        self.broadcast(_connection_message(robot, connected=False))

    def set_state(self, robot: str, link: GuardLink, state: GuardState) -> None:
        """Take what a guard is at, unless its connection has been replaced."""
        with self._lock:
            robot_state = self._robot(robot)
            if robot_state.link is not link:
                return
            robot_state.state = state
        if self.has_listeners:
            document = _STATE.dump_python(state, mode="json")
            self.broadcast({"type": "state", "robot": robot, "state": document})

    def add_lost_events(self, robot: str, events: int) -> None:
        """Count events of a robot that are lost for ever."""
        with self._lock:
            self._robots.setdefault(robot, _LiveRobot()).dropped += events

    def _robot(self, name: str) -> _LiveRobot:
        return self._robots.get(name, _NO_ROBOT)

    def _remove_listener(self, listener: Listener) -> None:
        with self._lock:
            self._listeners.discard(listener)


def _revision(settings: Settings) -> int:
    return settings.revision


def _connection_message(robot: str, *, connected: bool) -> LiveMessage:
    return {"type": "connection", "robot": robot, "connected": connected}
