"""The incident of an attack that the guard stopped: what it saved, and what would have been.

Times are simulated: a world of speed 3 drives three times as far in a second of the guard's clock.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TypeVar

from rtron.demos.plots.incident import draw_incident
from rtron.demos.runtime.polling import wait_for
from rtron.reports.incident import comparison_sentence
from rtron.sources.bag.incident import IncidentFile
from rtron.vocabulary import SECOND, IncidentAccount, TopicAccount
from rtron.workflows.incidents import read_account
from rtron.workflows.what_if import compare, plan_areas, without_guard

_LIMIT = 30.0
"""Wall s: half of what is kept, until which the next incident waits, and what is kept behind."""
T = TypeVar("T")


@dataclass(frozen=True, slots=True)
class CaseIncident:
    """A saved incident about a topic, at `speed` simulated s a wall s."""

    path: Path
    topic: str
    speed: float

    @property
    def sentence(self) -> str:
        """What would have been without the guard."""
        account, areas = self._account(), plan_areas(IncidentFile(self.path))
        compared = compare(account, without_guard(account), areas)
        return next(comparison_sentence(each) for each in compared if each.topic == self.topic)

    def draw(self, path: Path) -> None:
        """Draw command, output and path, and what would have been, as a PNG."""
        account = self._account()
        draw_incident(path, account, without_guard(account), plan_areas(IncidentFile(self.path)))

    def _account(self) -> IncidentAccount:
        return in_simulated_time(read_account(IncidentFile(self.path)), self.speed)


def wait_for_incident(state: Path, topic: str, since: float, speed: float) -> CaseIncident:
    """Return the incident about a topic of a guard whose state is below `state`.

    One that was caused from `since` (wall s) on. SourceError if none is saved.
    """
    found = wait_for(lambda: list(_saved(state, topic, since)), "the incident to be saved", _LIMIT)
    return CaseIncident(found[0], topic, speed)


def _saved(state: Path, topic: str, since: float) -> Iterator[Path]:
    for path in sorted(state.glob("**/incidents/*.mcap")):
        causes = IncidentFile(path).header.causes
        if any(each.topic == topic and each.at / SECOND >= since for each in causes):
            yield path


def in_simulated_time(account: IncidentAccount, speed: float) -> IncidentAccount:
    """Return an account whose times count the simulated time, as its velocities do."""
    first = account.header.causes[0].at
    causes = tuple(
        replace(each, at=first + round((each.at - first) * speed)) for each in account.header.causes
    )
    return replace(
        account,
        header=replace(account.header, causes=causes),
        topics={topic: _scaled_topic(each, speed) for topic, each in account.topics.items()},
        poses={
            topic: [replace(each, at=round(each.at * speed)) for each in poses]
            for topic, poses in account.poses.items()
        },
    )


def _scaled_topic(found: TopicAccount, speed: float) -> TopicAccount:
    return replace(
        found,
        commands={flow: _scaled(curve, speed) for flow, curve in found.commands.items()},
        output=_scaled(found.output, speed),
        limits=_scaled(found.limits, speed),
    )


def _scaled(timed: Sequence[tuple[int, T]], speed: float) -> list[tuple[int, T]]:
    return [(round(at * speed), value) for at, value in timed]
