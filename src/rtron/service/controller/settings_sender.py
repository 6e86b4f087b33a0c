"""What goes out to the guards: for each robot one after the other, and never backwards."""

from threading import RLock
from typing import Any, Protocol

from rtron.service.domain.revisions import stopped
from rtron.service.domain.schemas import SettingsView
from rtron.vocabulary import Settings

_LOCKS = 64


class Guards(Protocol):
    """What the controller needs of the hub: the way to the guards, and to those who watch."""

    def push(self, robot: str, settings: Settings) -> None:
        """Send settings to the robot's guard, if it is connected."""

    def tell(self, live: dict[str, Any]) -> None:
        """Tell everybody who watches."""


class Outgoing:
    """What was last sent to each robot, and which emergency stops are not stored yet.

    Whoever stores settings holds `alone` from before that until they are sent.
    """

    def __init__(self, hub: Guards) -> None:
        self._hub = hub
        self._locks = tuple(RLock() for _ in range(_LOCKS))
        self._sent: dict[str, Settings] = {}
        self._unstored: dict[str, Settings] = {}

    def alone(self, robot: str) -> RLock:
        """Return the lock of a robot, which may be another's too."""
        return self._locks[hash(robot) % _LOCKS]

    def meet(self, robot: str, settings: Settings) -> None:
        """Note what a guard has in force: a stop that cannot be stored has to go above that."""
        known = self._sent.get(robot, Settings())
        self._sent[robot] = max(settings, known, key=lambda each: each.revision)

    def push(self, robot: str, settings: Settings) -> None:
        """Send settings that are stored."""
        self._hub.push(robot, settings)
        self.note(robot, settings)

    def note(self, robot: str, settings: Settings) -> None:
        """Note that settings that are stored are sent, as the answer to a hello."""
        self._sent[robot] = settings
        unstored = self._unstored.get(robot)
        if unstored and unstored.revision < settings.revision:
            del self._unstored[robot]

    def stop_unstored(self, robot: str, who: str, reason: str, now: int) -> None:
        """Send a stop on top of what was last sent, to be stored before what comes next."""
        before = self._unstored.get(robot) or self._sent.get(robot, Settings())
        self._unstored[robot] = settings = stopped(before, who, reason, now)
        self._hub.push(robot, settings)

    def unstored(self, robot: str) -> Settings | None:
        """Return the stop that is sent, but not stored."""
        return self._unstored.get(robot)

    def forget(self, robot: str) -> None:
        """Drop the stop of a robot that there is not."""
        self._unstored.pop(robot, None)

    def tell(self, robot: str, view: SettingsView) -> None:
        """Tell everybody who watches of settings."""
        live = {"type": "settings", "robot": robot, "view": view.model_dump(mode="json")}
        self._hub.tell(live)
