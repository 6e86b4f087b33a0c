"""What robots are at now, for the API: their guards are connected here, or to another replica."""

from collections.abc import Collection, Mapping
from dataclasses import dataclass
from typing import Protocol

from pydantic import TypeAdapter
from sqlalchemy.orm import Session

from rtron.service.live.hub import Hub
from rtron.service.store.events import lost_events_by_robot
from rtron.service.store.live_guards import LiveGuard, live_guards, live_versions
from rtron.vocabulary import GuardState

_STATE = TypeAdapter(GuardState)


@dataclass(frozen=True, slots=True, kw_only=True)
class LiveRobot:
    """A robot now; `dropped` events are known to be lost."""

    connected: bool = False
    dry_run: bool = False
    dropped: int = 0
    state: GuardState | None = None


class LiveRobots(Protocol):
    """Looks up what is live, with a session of the database."""

    def connected_robots(self, session: Session) -> Collection[str]:
        """Return the robots whose guards are connected."""

    def is_connected(self, session: Session, robot: str) -> bool:
        """Tell whether a robot's guard is connected."""

    def find(self, session: Session, robots: Collection[str]) -> Mapping[str, LiveRobot]:
        """Return each of these robots."""


class LocalLiveRobots:
    """All guards are connected to this process: its memory has everything."""

    def __init__(self, hub: Hub) -> None:
        self._hub = hub

    def connected_robots(self, _session: Session) -> Collection[str]:
        """Return the robots whose guards are connected."""
        return self._hub.connected_robots()

    def is_connected(self, _session: Session, robot: str) -> bool:
        """Tell whether a robot's guard is connected."""
        return self._hub.is_connected(robot)

    def find(self, _session: Session, robots: Collection[str]) -> Mapping[str, LiveRobot]:
        """Return each of these robots."""
        return {robot: self._robot(robot) for robot in robots}

    def _robot(self, robot: str) -> LiveRobot:
        hub = self._hub
        return LiveRobot(
            connected=hub.is_connected(robot),
            dry_run=hub.is_dry_run(robot),
            dropped=hub.lost_event_count(robot),
            state=hub.state(robot),
        )


class SharedLiveRobots:
    """Guards that are connected here are in memory, those of other replicas in the database."""

    def __init__(self, hub: Hub) -> None:
        self._hub = hub

    def connected_robots(self, session: Session) -> Collection[str]:
        """Return the robots whose guards are connected."""
        return self._hub.connected_robots() | live_versions(session).keys()

    def is_connected(self, session: Session, robot: str) -> bool:
        """Tell whether a robot's guard is connected."""
        return self._hub.is_connected(robot) or bool(live_guards(session, [robot]))

    def find(self, session: Session, robots: Collection[str]) -> Mapping[str, LiveRobot]:
        """Return each of these robots."""
        here = self._hub.connected_guards()
        elsewhere = {
            guard.robot: guard for guard in live_guards(session, set(robots) - here.keys())
        }
        dropped = lost_events_by_robot(session, robots)
        found = {}
        for robot in robots:
            guard = here.get(robot) or elsewhere.get(robot)
            state = parse_state(guard) if isinstance(guard, LiveGuard) else guard and guard.state
            found[robot] = LiveRobot(
                connected=guard is not None,
                dry_run=guard is not None and guard.dry_run,
                dropped=dropped.get(robot, 0),
                state=state,
            )
        return found


def parse_state(guard: LiveGuard) -> GuardState | None:
    """Return the state of a guard of another replica."""
    return None if guard.state is None else _STATE.validate_json(guard.state)


def state_json(state: GuardState) -> str:
    """Return a state as other replicas read it; PostgreSQL takes no NUL in it."""
    return _STATE.dump_json(state).decode().replace("\\u0000", "\\ufffd")
