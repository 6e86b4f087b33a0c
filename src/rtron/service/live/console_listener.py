"""What one console hears: what differs of all robots, and everything of those that it watches.

Differences are gathered by robot until they are taken, so that neither a fleet that comes back nor
a slow line makes more of them than there are robots.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from threading import Lock
from typing import Any

from pydantic import TypeAdapter

from rtron.service.live.hub import Hub
from rtron.service.live.listener import Listener, LiveMessage
from rtron.vocabulary import Alarm, GuardState
from rtron.wire.common.link_protocol import StateDelta
from rtron.wire.common.state_deltas import state_delta

SILENT_AFTER_S = 4.0
"""A guard that is connected and has told no state for so long is silent."""

Changes = dict[str, dict[str, Any]]
"""What differs, by robot: keys and values as `RobotSummary` has them, and `silent`."""

_STATE = TypeAdapter(GuardState)
_DELTA = TypeAdapter(StateDelta)
_ALARMS = TypeAdapter(tuple[Alarm, ...])
_Brief = tuple[tuple[Alarm, ...], tuple[str, ...], bool, int]


@dataclass(frozen=True, slots=True, kw_only=True)
class Interest:
    """Of which robots a console hears states, settings and events; `events` are those of all."""

    robots: frozenset[str] = frozenset()
    events: bool = True


class ConsoleListener(Listener):
    """A listener whose `put` may come from any thread; the rest is for its event loop."""

    def __init__(self, hub: Hub) -> None:
        super().__init__(hub.remove_listener)
        self._hub = hub
        self._interest = Interest()
        self._gathering = Lock()
        self._changes: Changes = {}
        self._silent: set[str] = set()
        self._last_messages: dict[str, float] = {}
        self._briefs: dict[str, _Brief] = {}
        self._last_states: dict[str, GuardState] = {}
        hub.add_listener(self)
        self._begin()

    def put(self, message: LiveMessage) -> None:
        """Take a live message: gather it, pass it on, or leave it, as its type says."""
        _TAKE.get(message["type"], Listener.put)(self, message)

    def watch(self, interest: Interest) -> None:
        """Tell from now on what the console asks for; whole states of new robots first."""
        added = interest.robots - self._interest.robots
        self._interest = interest
        for robot in self._last_states.keys() - interest.robots:
            self._last_states.pop(robot, None)
        for robot in added:
            state = self._hub.state(robot)
            if state is not None:
                self._tell_state(robot, state)

    def take_changes(self) -> Changes:
        """Return what differs since the last time, for all robots together."""
        with self._gathering:
            limit = self._loop.time() - SILENT_AFTER_S
            for robot, time in self._last_messages.items():
                if time < limit and robot not in self._silent:
                    self._silent.add(robot)
                    self._change(robot, silent=True)
            changes, self._changes = self._changes, {}
        return changes

    def _begin(self) -> None:
        """Take what is so now as told: whoever opens a console asks for all robots afterwards."""
        connected, states, now = self._hub.connected_robots(), self._hub.states(), self._loop.time()
        with self._gathering:
            self._last_messages = {**dict.fromkeys(connected, now), **self._last_messages}
            briefs = {robot: _brief(state) for robot, state in states.items()}
            self._briefs = {**briefs, **self._briefs}

    def _change(self, robot: str, **change: object) -> None:
        self._changes.setdefault(robot, {}).update(change)

    def _take_state(self, message: LiveMessage) -> None:
        robot, state = message["robot"], message["state"]
        with self._gathering:
            self._last_messages[robot] = self._loop.time()
            if robot in self._silent:
                self._silent.discard(robot)
                self._change(robot, silent=False)
            brief = _brief(state)
            if self._briefs.get(robot) != brief:
                self._briefs[robot] = brief
                self._change(robot, **_brief_json(brief))
        if robot in self._interest.robots:
            self._tell_state(robot, state)

    def _tell_state(self, robot: str, state: GuardState) -> None:
        """Tell a whole state, or what differs from the one that was told last."""
        before = self._last_states.get(robot)
        self._last_states[robot] = state
        delta = state_delta(before, state) if before else None
        if delta is None:
            document = _STATE.dump_python(state, mode="json")
            super().put({"type": "state", "robot": robot, "state": document})
        else:
            document = _DELTA.dump_python(delta, mode="json")
            super().put({**document, "type": "state_delta", "robot": robot})

    def _take_settings(self, message: LiveMessage) -> None:
        robot, view = message["robot"], message["view"]
        change = {name: view[name] for name in ("revision", "outcome")}
        with self._gathering:
            self._change(robot, **change, stop=view["settings"]["stop"])
        if robot in self._interest.robots:
            super().put(message)

    def _take_connection(self, message: LiveMessage) -> None:
        robot, connected = message["robot"], message["connected"]
        with self._gathering:
            self._silent.discard(robot)
            self._last_messages.pop(robot, None)
            self._briefs.pop(robot, None)
            self._last_states.pop(robot, None)
            if connected:
                self._last_messages[robot] = self._loop.time()
            gone = {} if connected else _brief_json(_brief(None))
            self._change(robot, connected=connected, silent=False, **gone)

    def _take_change(self, message: LiveMessage) -> None:
        with self._gathering:
            self._change(message["robot"], **message["change"])

    def _take_event(self, message: LiveMessage) -> None:
        if self._interest.events or message["event"]["robot"] in self._interest.robots:
            super().put(message)


_TAKE: Mapping[str, Callable[[ConsoleListener, LiveMessage], None]] = {
    "state": ConsoleListener._take_state,  # noqa: SLF001 - its own
    "settings": ConsoleListener._take_settings,  # noqa: SLF001
    "connection": ConsoleListener._take_connection,  # noqa: SLF001
    "change": ConsoleListener._take_change,  # noqa: SLF001
    "event": ConsoleListener._take_event,  # noqa: SLF001
}


def _brief(state: GuardState | None) -> _Brief:
    if state is None:
        return (), (), False, 0
    requests = state.requests.count if state.requests else 0
    return state.alarms, state.overridden, state.stopped, requests


def _brief_json(brief: _Brief) -> dict[str, Any]:
    alarms, overridden, stopped, requests = brief
    return {
        "alarms": _ALARMS.dump_python(alarms, mode="json"),
        "overridden": list(overridden),
        "stopped": stopped,
        "requests": requests,
    }
