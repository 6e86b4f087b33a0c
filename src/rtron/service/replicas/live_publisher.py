"""Tells other replicas which guards are connected here, and what they are at."""

from collections.abc import Mapping

from rtron.service.live.hub import ConnectedGuard, GuardLink, Hub
from rtron.service.live.live_robots import state_json
from rtron.service.store.database import Database
from rtron.service.store.live_guards import (
    claim_guards,
    delete_orphans,
    guard_owners,
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
