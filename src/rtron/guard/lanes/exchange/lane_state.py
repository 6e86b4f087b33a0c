"""What one process of the guard tells the security service about its streams."""

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any

from rtron.guard.coordinator import Coordinator
from rtron.guard.link.stream_monitor import StreamMonitor
from rtron.vocabulary import RuleState, StreamState


@dataclass(frozen=True, slots=True, kw_only=True)
class LaneState:
    """The streams and rules of one process; `stopped` by the emergency stop."""

    streams: tuple[StreamState, ...] = ()
    rules: tuple[RuleState, ...] = ()
    overridden: tuple[str, ...] = ()
    stopped: bool = False


def lane_state(
    host: Coordinator, monitors: Iterable[StreamMonitor], now: int, *, stopped: bool
) -> LaneState:
    """Return the state of a host's streams and rules at `now` (ns, steady)."""
    return LaneState(
        streams=tuple(monitor.state(now) for monitor in monitors),
        rules=tuple(
            RuleState(name=each.rule.name, blocks=each.is_blocking, reason=each.reason)
            for each in host.observations.mission.statuses.values()
        ),
        overridden=tuple(_overridden(host, now)),
        stopped=stopped,
    )


def stream_figures(monitors: Iterable[StreamMonitor], now: int) -> dict[str, dict[str, Any]]:
    """Return what became of the messages of each stream since the last call, by topic."""
    figures = {monitor.guarded.spec.topic: monitor.figures(now) for monitor in monitors}
    return {topic: found for topic, found in figures.items() if found}


def _overridden(host: Coordinator, now: int) -> dict[str, None]:
    return {
        id: None
        for guarded in host.streams
        for id, policy in guarded.override_policies.items()
        if policy.active_override and now < policy.active_override.until
    }
