"""What is live: which guards are connected, what they are at now, and who listens to it.

Every method may be called from any thread.
"""

from collections.abc import Mapping
from concurrent.futures import Future
from dataclasses import dataclass
from threading import Lock
from typing import Any, Protocol

from rtron.service.live.listener import Listener, LiveMessage
from rtron.vocabulary import GuardState, Settings
from rtron.wire.common.link_protocol import CommandResponse, PersonCommand


class GuardLink(Protocol):
    """The connection of one guard, as the hub uses it; all may be called from any thread."""

    def push(self, settings: Settings) -> None:
        """Send settings, unless newer ones are on their way."""

    def send_command(self, command: PersonCommand) -> Future[CommandResponse]:
        """Send a person's command; return what will have the guard's answer."""

    def replace(self) -> None:
        """End the connection: the same robot's guard has made another one."""

    def leave(self) -> None:
        """End the connection: the guard is to look for another replica."""

    def send_heads(self, document: Mapping[str, Any]) -> None:
        """Send signed heads of the audit log, if the guard keeps them."""


@dataclass(frozen=True, slots=True)
class ConnectedGuard:
    """A guard that is connected here, and the last state that it has told."""

    link: GuardLink
    state: GuardState | None
    dry_run: bool


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
        self._state_listeners: set[Listener] = set()

    def is_connected(self, robot: str) -> bool:
        """Tell whether the robot's guard is connected."""
        with self._lock:
            return self._robot(robot).link is not None

    def connected_robots(self) -> frozenset[str]:
        """Return the robots whose guards are connected."""
        with self._lock:
            return frozenset(name for name, each in self._robots.items() if each.link is not None)

    def connection_count(self) -> int:
        """Return how many guards are connected."""
        with self._lock:
            return sum(each.link is not None for each in self._robots.values())

    def connected_guards(self) -> Mapping[str, ConnectedGuard]:
        """Return the guards that are connected, by robot."""
        with self._lock:
            return {
                name: ConnectedGuard(each.link, each.state, each.dry_run)
                for name, each in self._robots.items()
                if each.link is not None
            }

    def state(self, robot: str) -> GuardState | None:
        """Return what the robot's guard last said it is at; None while it is not connected."""
        with self._lock:
            return self._robot(robot).state

    def states(self) -> dict[str, GuardState]:
        """Return what the guards last said they are at, by robot."""
        with self._lock:
            return {name: each.state for name, each in self._robots.items() if each.state}

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

    def push(self, robot: str, settings: Settings) -> bool:
        """Send settings to the robot's guard if it is connected; if not, it asks when it is.

        Return whether it is.
        """
        with self._lock:
            robot_state = self._robots.setdefault(robot, _LiveRobot())
            robot_state.pushed = max(robot_state.pushed, settings, key=_revision)
            link = robot_state.link
        if link is not None:
            link.push(settings)
        return link is not None

    def send_command(self, robot: str, command: PersonCommand) -> Future[CommandResponse] | None:
        """Send a person's command to the robot's guard; None if it is not connected."""
        with self._lock:
            link = self._robot(robot).link
        return link.send_command(command) if link is not None else None

    def send_heads(self, robot: str, document: Mapping[str, Any]) -> None:
        """Send signed heads of the audit log to the robot's guard if it is connected."""
        with self._lock:
            link = self._robot(robot).link
        if link is not None:
            link.send_heads(document)

    def broadcast(self, message: LiveMessage) -> None:
        """Tell a live message to everyone who listens."""
        with self._lock:
            listeners = tuple(self._listeners)
        for listener in listeners:
            listener.put(message)

    def tell_consoles(self, message: LiveMessage) -> None:
        """Tell what another replica has told to all but its own consoles."""
        with self._lock:
            consoles = tuple(self._state_listeners)
        for listener in consoles:
            listener.put(message)

    def close_consoles(self) -> None:
        """End what consoles listen to: they may have missed something, and look again."""
        with self._lock:
            consoles = tuple(self._state_listeners)
        for listener in consoles:
            listener.close()

    @property
    def has_consoles(self) -> bool:
        """Whether anyone listens who wants to know states."""
        return bool(self._state_listeners)

    def broadcast_change(self, robot: str, change: LiveMessage) -> None:
        """Tell everyone what differs of a robot in short, by the keys of `RobotSummary`."""
        self.broadcast(change_message(robot, change))

    def listen(self, *, states: bool = True) -> Listener:
        """Return an async iterator of what is live from now on; close it, or use it in `with`."""
        listener = Listener(self.remove_listener)
        self.add_listener(listener, states=states)
        return listener

    def add_listener(self, listener: Listener, *, states: bool = True) -> None:
        """Tell a listener what is live from now on, states as `GuardState`."""
        with self._lock:
            self._listeners.add(listener)
            if states:
                self._state_listeners.add(listener)

    def remove_listener(self, listener: Listener) -> None:
        """Tell a listener nothing more."""
        with self._lock:
            self._listeners.discard(listener)
            self._state_listeners.discard(listener)

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
        self.broadcast(connection_message(robot, connected=True))
        return is_replacing

    def unregister(self, robot: str, link: GuardLink) -> None:
        """Take note that a connection has ended, unless another has replaced it."""
        with self._lock:
            robot_state = self._robot(robot)
            if robot_state.link is not link:
                return
            robot_state.link, robot_state.state = None, None
        self.broadcast(connection_message(robot, connected=False))

    def set_state(self, robot: str, link: GuardLink, state: GuardState) -> None:
        """Take what a guard is at, unless its connection has been replaced."""
        with self._lock:
            robot_state = self._robot(robot)
            if robot_state.link is not link:
                return
            robot_state.state = state
            listeners = tuple(self._state_listeners)
        for listener in listeners:
            listener.put({"type": "state", "robot": robot, "state": state})

    def add_lost_events(self, robot: str, events: int) -> None:
        """Count events of a robot that are lost for ever."""
        with self._lock:
            self._robots.setdefault(robot, _LiveRobot()).dropped += events

    def _robot(self, name: str) -> _LiveRobot:
        return self._robots.get(name, _NO_ROBOT)


def _revision(settings: Settings) -> int:
    return settings.revision


def change_message(robot: str, change: LiveMessage) -> LiveMessage:
    """Return the live message of what differs of a robot in short."""
    return {"type": "change", "robot": robot, "change": change}


def connection_message(robot: str, *, connected: bool) -> LiveMessage:
    """Return the live message that a robot's guard has come, or gone."""
    return {"type": "connection", "robot": robot, "connected": connected}
