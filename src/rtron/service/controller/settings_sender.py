"""What goes out to the guards: for each robot one after the other, and never backwards."""

from collections.abc import Collection, Iterator
from contextlib import ExitStack, contextmanager
from threading import RLock

from rtron.service.domain.revisions import add_stop
from rtron.service.domain.schemas import SettingsView
from rtron.service.live.hub import Hub
from rtron.vocabulary import Settings

_LOCK_COUNT = 64


class SettingsSender:
    """What was last sent to each robot, and which emergency stops are not stored yet.

    Whoever stores settings holds `robot_lock` from before that until they are sent.
    """

    def __init__(self, hub: Hub) -> None:
        self._hub = hub
        self._locks = tuple(RLock() for _ in range(_LOCK_COUNT))
        self._last_sent: dict[str, Settings] = {}
        self._unstored_stops: dict[str, Settings] = {}

    def robot_lock(self, robot: str) -> RLock:
        """Return the lock of a robot, which may be another's too."""
        return self._locks[_lock_number(robot)]

    @contextmanager
    def robot_locks(self, robots: Collection[str]) -> Iterator[None]:
        """Hold the locks of robots, taken in one order for all who want several."""
        with ExitStack() as held:
            for number in sorted(set(map(_lock_number, robots))):
                held.enter_context(self._locks[number])
            yield

    def note_guard_settings(self, robot: str, settings: Settings) -> None:
        """Note what a guard has in force: a stop that cannot be stored has to go above that."""
        last_sent = self._last_sent.get(robot, Settings())
        self._last_sent[robot] = max(settings, last_sent, key=lambda each: each.revision)

    def push(self, robot: str, settings: Settings) -> None:
        """Send settings that are stored."""
        self._hub.push(robot, settings)
        self.note_sent(robot, settings)

    def push_stored(self, robot: str, settings: Settings) -> None:
        """Send settings that another replica has stored, unless newer ones are sent."""
        self._hub.push(robot, settings)
        if settings.revision >= self._last_sent.get(robot, Settings()).revision:
            self.note_sent(robot, settings)

    def note_sent(self, robot: str, settings: Settings) -> None:
        """Note that settings that are stored are sent, as the answer to a hello."""
        self._last_sent[robot] = settings
        unstored = self._unstored_stops.get(robot)
        if unstored and unstored.revision < settings.revision:
            del self._unstored_stops[robot]

    def is_connected(self, robot: str) -> bool:
        """Tell whether the robot's guard is connected here."""
        return self._hub.is_connected(robot)

    def send_unstored_stop(self, robot: str, actor: str, reason: str, now: int) -> bool:
        """Send a stop on top of what was last sent, to be stored before what comes next.

        Return whether it is on its way; if not, it waits for the robot.
        """
        previous = self._unstored_stops.get(robot) or self._last_sent.get(robot, Settings())
        self._unstored_stops[robot] = settings = add_stop(previous, actor, reason, now)
        return self._hub.push(robot, settings)

    def unstored_stop(self, robot: str) -> Settings | None:
        """Return the stop that is sent, but not stored."""
        return self._unstored_stops.get(robot)

    def discard_unstored_stop(self, robot: str) -> None:
        """Drop the stop of a robot that there is not."""
        self._unstored_stops.pop(robot, None)

    def broadcast(self, robot: str, view: SettingsView) -> None:
        """Tell everybody who watches of settings."""
        message = {"type": "settings", "robot": robot, "view": view.model_dump(mode="json")}
        self._hub.broadcast(message)


def _lock_number(robot: str) -> int:
    return hash(robot) % _LOCK_COUNT
