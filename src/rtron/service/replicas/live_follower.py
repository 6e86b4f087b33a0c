"""Follows which guards are connected to other replicas, and what they are at."""

import time
from collections.abc import Collection, Iterator, Mapping
from itertools import islice

from rtron.service.live.hub import Hub, connection_message
from rtron.service.live.listener import LiveMessage
from rtron.service.live.live_robots import parse_state
from rtron.service.store.database import Database
from rtron.service.store.live_guards import (
    live_guards,
    live_versions,
)

_BURST = 500
_PAUSE_S = 0.05
"""A console takes so many messages at once, and as many again after a pause."""


class LiveFollower:
    """Looks for changes while a console listens; not for several threads at once."""

    def __init__(self, database: Database, hub: Hub) -> None:
        self._database, self._hub = database, hub
        self._known: Mapping[str, tuple[int, int]] = {}

    def follow(self) -> None:
        """Tell what has changed since the last call."""
        if not self._hub.has_consoles:
            self._known = {}
            return
        own = self._database.replica
        with self._database.session() as session:
            versions = {
                robot: version
                for robot, version in live_versions(session).items()
                if version[0] != own
            }
        messages = self._messages(self._known, versions)
        self._known = versions
        while burst := list(islice(messages, _BURST)):
            for message in burst:
                self._hub.tell_consoles(message)
            time.sleep(_PAUSE_S)

    def _messages(
        self, known: Mapping[str, tuple[int, int]], versions: Mapping[str, tuple[int, int]]
    ) -> Iterator[LiveMessage]:
        for robot in known.keys() - versions.keys():
            if not self._hub.is_connected(robot):
                yield connection_message(robot, connected=False)
        for robot in versions.keys() - known.keys():
            yield connection_message(robot, connected=True)
        yield from self._state_messages(
            [robot for robot, version in versions.items() if known.get(robot) != version]
        )

    def _state_messages(self, robots: Collection[str]) -> Iterator[LiveMessage]:
        remaining = iter(robots)
        while page := list(islice(remaining, _BURST)):
            with self._database.session() as session:
                guards = live_guards(session, page)
            for guard in guards:
                if state := parse_state(guard):
                    yield {"type": "state", "robot": guard.robot, "state": state}
