"""Tells other replicas which guards are connected here, and what they are at."""

import time
from collections.abc import Collection, Iterator, Mapping
from itertools import islice

from rtron.service.live.hub import ConnectedGuard, GuardLink, Hub, connection_message
from rtron.service.live.listener import LiveMessage
from rtron.service.live.live_robots import parse_state, state_json
from rtron.service.store.database import Database
from rtron.service.store.live_guards import (
    claim_guards,
    delete_orphans,
    guard_owners,
    live_guards,
    live_versions,
    release_guards,
    store_states,
)
from rtron.vocabulary import GuardState


class LivePublisher:
    """Compares the hub with what it has stored; not for several threads at once."""

    def __init__(self, database: Database, hub: Hub) -> None:
        self._database, self._hub = database, hub
        self._claimed: dict[str, GuardLink] = {}
        self._stored: dict[str, GuardState] = {}
        self._has_tidied = False

    def publish(self) -> None:
        """Store what has changed since the last call; what fails is stored by the next one."""
        guards = self._hub.connected_guards()
        new = {robot: each for robot, each in guards.items() if self._is_new(robot, each)}
        changed = {
            robot: each.state
            for robot, each in guards.items()
            if each.state and (robot in new or self._stored.get(robot) is not each.state)
        }
        owners = self._store(guards, new, changed)
        self._has_tidied = True
        self._claimed = {robot: each.link for robot, each in guards.items()}
        self._stored = {robot: self._stored[robot] for robot in guards if robot in self._stored}
        self._stored |= changed
        for robot, guard in guards.items():
            self._check_owner(robot, guard, owners.get(robot))

    def _is_new(self, robot: str, guard: ConnectedGuard) -> bool:
        return self._claimed.get(robot) is not guard.link

    def _store(
        self,
        guards: Mapping[str, ConnectedGuard],
        new: Mapping[str, ConnectedGuard],
        changed: Mapping[str, GuardState],
    ) -> Mapping[str, int]:
        """Return the replica that each guard belongs to now."""
        replica = self._database.replica
        gone = self._claimed.keys() - guards.keys()
        if self._has_tidied and not (guards or gone):
            return {}
        with self._database.session() as session:
            if not self._has_tidied:
                delete_orphans(session)
            claim_guards(session, replica, {robot: each.dry_run for robot, each in new.items()})
            release_guards(session, replica, gone)
            states = {robot: state_json(state) for robot, state in changed.items()}
            store_states(session, replica, states)
            return guard_owners(session, guards.keys())

    def _check_owner(self, robot: str, guard: ConnectedGuard, owner: int | None) -> None:
        """End a connection that a newer one to another replica has replaced.

        A row that is gone is claimed again: PostgreSQL has crashed.
        """
        if owner is None:
            self._claimed.pop(robot)
            self._stored.pop(robot, None)
        elif owner != self._database.replica:
            guard.link.replace()


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
