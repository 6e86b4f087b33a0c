"""The latched stop: several sources can stop the robot, and each of them must be released.

No I/O and no clock: `now` is a time in ns of the wall clock, which a restart does not begin anew.
A stop is never refused. A release is, unless the cause of the source's stop is gone, there is a
reason, all inputs are neutral and, where the plan says so, a second person has released it too.
"""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any

from rtron.policies.verdicts import format_seconds
from rtron.vocabulary import visible_text


@dataclass(frozen=True, slots=True, kw_only=True)
class LatchedStop:
    """What one source has stopped the robot for, by whom and since when (ns).

    `is_caused`: what has caused it is still there, a button that is pressed for instance.
    """

    by: str
    reason: str
    since: int
    is_caused: bool


@dataclass(frozen=True, slots=True)
class _FirstRelease:
    """The release of the first of two persons, at `at` (ns)."""

    by: str
    at: int


@dataclass(frozen=True, slots=True, kw_only=True)
class StopAnswer:
    """Whether the stop of a source is released, and why or why not."""

    released: bool
    reason: str


class StopLatch:
    """The stops of all sources that are not released; while there is one, nothing may move."""

    __slots__ = ("_first_releases", "_second_within", "_stops")

    def __init__(self, second_within: int | None = None) -> None:
        """`second_within` (ns): a second person must release each stop in that time."""
        self._second_within = second_within
        self._stops: dict[str, LatchedStop] = {}
        self._first_releases: dict[str, _FirstRelease] = {}

    @property
    def stops(self) -> Mapping[str, LatchedStop]:
        """What is not released, by source."""
        return dict(self._stops)

    @property
    def reason(self) -> str:
        """Why the robot is stopped, "" if it is not."""
        return "; ".join(
            f"{source} by {each.by}: {each.reason}" for source, each in self._stops.items()
        )

    def stop(self, source: str, by: str, reason: str, now: int, *, is_caused: bool = False) -> bool:
        """Latch the stop of a source; tell whether that source had not stopped the robot before.

        A source that stops again keeps its first reason. What was released of it counts no more.
        """
        before = self._stops.get(source)
        self._first_releases.pop(source, None)
        if before is None:
            self._stops[source] = LatchedStop(by=by, reason=reason, since=now, is_caused=is_caused)
        else:
            self._stops[source] = replace(before, is_caused=before.is_caused or is_caused)
        return before is None

    def end_cause(self, source: str) -> None:
        """Note that what has caused the stop of a source is gone; the stop stays."""
        stop = self._stops.get(source)
        if stop is not None:
            self._stops[source] = replace(stop, is_caused=False)

    def release(
        self, source: str, by: str, reason: str, now: int, *, moving: str = ""
    ) -> StopAnswer:
        """Release the stop of a source; `moving` names an input that is not neutral, "" if none."""
        refusal = self._release_refusal(source, reason, moving)
        if refusal:
            return StopAnswer(released=False, reason=refusal)
        waits = self._wait_for_second(source, by, now)
        if waits:
            return StopAnswer(released=False, reason=waits)
        del self._stops[source]
        self._first_releases.pop(source, None)
        others = f"; still stopped by {', '.join(self._stops)}" if self._stops else ""
        text = f"the stop of {source} is released by {by}: {reason}{others}"
        return StopAnswer(released=True, reason=text)

    def export_state(self) -> dict[str, Any]:
        """Return the stops as JSON can hold them, for `restore_state` after a restart."""
        return {
            source: {"by": each.by, "reason": each.reason, "since": each.since}
            for source, each in self._stops.items()
        }

    def restore_state(self, state: Mapping[str, Any], now: int, caused: frozenset[str]) -> None:
        """Latch what was latched before a restart; a stop that cannot be read is latched too.

        Of the sources in `caused` the cause counts as present until `end_cause`.
        """
        for source, stop in state.items():
            values = stop if isinstance(stop, dict) else {}
            since = values.get("since")
            self._stops[source] = LatchedStop(
                by=str(values.get("by", "somebody")),
                reason=str(values.get("reason", "the reason cannot be read")),
                since=since if isinstance(since, int) else now,
                is_caused=source in caused,
            )

    def _release_refusal(self, source: str, reason: str, moving: str) -> str:
        stop = self._stops.get(source)
        if stop is None:
            return f"{source} has stopped nothing"
        if not visible_text(reason):
            return f"to release the stop of {source} needs a reason"
        if stop.is_caused:
            return f"the cause of the stop of {source} is still there: {stop.reason}"
        return f"{moving} is not neutral" if moving else ""

    def _wait_for_second(self, source: str, by: str, now: int) -> str:
        """Return whom the release waits for, "" if for nobody; note a first release."""
        if self._second_within is None:
            return ""
        first = self._first_releases.get(source)
        if first is None or not 0 <= now - first.at < self._second_within:
            self._first_releases[source] = _FirstRelease(by, now)
            how_long = format_seconds(self._second_within)
            return f"{by} agrees; a second person must release it too within {how_long}"
        return f"{by} has agreed already: a second person must" if first.by == by else ""
