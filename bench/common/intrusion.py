"""What the base hears while an intruder is there: who commands it, and for how much of the time.

The time begins with the guard's alarm, or when the base hears the intruder if that is later: DDS
may take seconds until it does. The base obeys what it heard last.
"""

import statistics
import time
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from pathlib import Path

from bench.common.plans import grcn
from bench.common.pubsub import PUBLISHER
from figures.figure import Figure
from rtron.planning.plan_file.writer import write_plan
from rtron.vocabulary import SECOND, Audit, OnForeign, Plan

TOPIC, DRIVER = "/cmd_vel", "/bench_driver"
INTRUDER, NAVIGATION = -0.2, 0.5
"""The turns that the intruder and the planned publisher send, rad/s."""
RATES = (50, 200)
"""Messages a second of the intruder."""
WINDOW = 3 * SECOND
"""How long the base is watched (ns)."""
_LIMIT, _POLL_S = 30 * SECOND, 0.05


def write_intrusion_plan(path: Path, ros: int) -> None:
    """Write the plan of a base whose guard stops what intruders move."""
    path.write_text(write_plan(intrusion_plan(ros)), "utf-8")


def intrusion_plan(ros: int, *, in_cell: bool = False) -> Plan:
    """Return the plan of a base whose guard stops what intruders move."""
    node = replace(grcn(TOPIC, [PUBLISHER]), successors=(DRIVER,))
    audit = Audit(on_foreign=OnForeign.STOP)
    cell = (DRIVER,) if in_cell else ()
    return Plan(app="bench", ros=ros, grcn=(node,), audit=audit, cell=cell)


@dataclass(frozen=True, slots=True)
class BaseLog:
    """What the base heard: (ns of the steady clock, turn in rad/s), in order."""

    messages: Sequence[tuple[int, float]]

    @classmethod
    def read(cls, path: Path) -> "BaseLog":
        """Read a file with a time and a turn on each line; a last line may be cut."""
        text = path.read_text("utf-8")
        lines = text[: text.rfind("\n") + 1].splitlines()
        return cls([(int(at), float(turn)) for at, turn in map(str.split, lines)])

    def share(self, turn: float, begin: int, end: int) -> float:
        """Return for which share of the time messages with this turn command the base."""
        before = [each for each in self.messages if each[0] <= begin][-1:]
        inside = [each for each in self.messages if begin < each[0] < end]
        changes = [*((begin, each[1]) for each in before), *inside, (end, 0.0)]
        commanded = sum(after[0] - now[0] for now, after in pairwise(changes) if now[1] == turn)
        return commanded / (end - begin)

    def heard_at(self, turn: float) -> int:
        """Return when the base first heard messages with this turn (ns), 0 if it has not."""
        return next((at for at, each in self.messages if each == turn), 0)

    def stops(self, begin: int, end: int) -> int:
        """Return how many messages told the base to rest."""
        return sum(begin < at < end and turn == 0 for at, turn in self.messages)


def window_figures(file: Path, alarm_at: int) -> dict[str, float]:
    """Wait until a base has heard an intruder for so long; return who commanded it meanwhile.

    `alarm_at` is when the guard raised its alarm (ns). TimeoutError if the base does not hear it.
    """
    begin = max(alarm_at, _wait_for_intruder(file))
    time.sleep(max(0, begin + WINDOW - time.monotonic_ns()) / SECOND)
    base, end = BaseLog.read(file), begin + WINDOW
    return {
        "share": base.share(INTRUDER, begin, end),
        "navigation_share": base.share(NAVIGATION, begin, end),
        "stops": base.stops(begin, end),
    }


def _wait_for_intruder(file: Path) -> int:
    deadline = time.monotonic_ns() + _LIMIT
    while not (at := BaseLog.read(file).heard_at(INTRUDER)):
        if time.monotonic_ns() > deadline:
            raise TimeoutError("the base does not hear the intruder")
        time.sleep(_POLL_S)
    return at


def intrusion_figures(
    name: str, runs: int, run: Callable[[], dict[str, float]]
) -> Iterator[Figure]:
    """Run an intrusion some times; give median, least and most of each of its figures."""
    found = [run() for _ in range(runs)]
    for what in found[0]:
        values = [each[what] for each in found]
        for kind, value in (
            ("median", statistics.median(values)),
            ("min", min(values)),
            ("max", max(values)),
        ):
            yield Figure(f"{name}.{what}.{kind}", value, None, f"of {runs} runs")
