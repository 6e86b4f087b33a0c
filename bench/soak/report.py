"""What a soak has shown: each figure beside its bound, for people and for programs."""

import json
from collections.abc import Iterator, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path

from rich.table import Table

from bench.soak.app import PROGRAMS, SoakedApp
from bench.soak.base_log import LONGEST_GAP, BaseLog, Span
from bench.soak.faults import RandomFaults
from bench.soak.goal_log import count_ends, count_forbidden, read_goals, unexplained
from bench.soak.memory import MemoryWatch
from bench.soak.policy_checks import SpeedCheck, blocks, longest_drive, rows
from bench.soak.processor_wait import ProcessorWait
from figures.table import number
from rtron.vocabulary import SECOND

_MS = 1e6
_STOPS_GOALS = ("guard killed", "guard frozen", "dock restarted")


@dataclass(frozen=True, slots=True)
class Row:
    """A figure; without a value it was not measured, without bounds it only informs."""

    key: str
    name: str
    value: float | None
    unit: str
    at_most: float | None = None
    at_least: float | None = None

    @property
    def is_over(self) -> bool:
        """Whether it does not keep its bound."""
        if self.value is None:
            return False
        is_high = self.at_most is not None and self.value > self.at_most
        return is_high or (self.at_least is not None and self.value < self.at_least)

    @property
    def bound(self) -> str:
        """The bound in words."""
        if self.at_most is not None:
            return f"at most {number(self.at_most)}"
        return "" if self.at_least is None else f"at least {number(self.at_least)}"

    @property
    def verdict(self) -> str:
        """Whether the bound is kept."""
        if not self.bound:
            return ""
        if self.value is None:
            return "not measured"
        return "OVER" if self.is_over else "ok"


class Findings:
    """Reads what the processes of an app wrote, and judges it."""

    def __init__(
        self, app: SoakedApp, faults: RandomFaults, memory: MemoryWatch, wait: ProcessorWait
    ) -> None:
        self.base, self.wait = BaseLog.read(app.files["base"]), wait
        self._faults, self._memory = faults, memory
        self.ended = app.ended()
        self.pictures = app.picture_count()
        self._speeds = SpeedCheck([at for at, *_ in rows(app.files["camera"])])
        self._blocks = list(blocks(rows(app.files["detector"])))
        self._goals = read_goals(app.files["planner"])
        self._stops = app.log.times("the guard stands still: the robot is stopped")
        self._guard_cancels = app.log.count(lambda line: "is cancelled: " in line)
        self._started = rows(app.files["dock"])
        self.too_fast = self._speeds.over_limit(self.base.guarded())

    def rows(self) -> Iterator[Row]:
        """Yield all figures, the most important ones first."""
        yield from self._commands()
        yield from self._policies()
        yield from self._actions()
        yield from self._sizes()
        for name, count in self._faults.counts().items():
            yield Row(f"times.{name.replace(' ', '_')}", f"times: {name}", count, "")

    def _commands(self) -> Iterator[Row]:
        base, intrusions = self.base, self._faults.intrusions()
        unguarded, gaps = len(base.unguarded()), base.unexplained_gaps()
        waiting = sum(self.wait.within(gap) > gap.length - LONGEST_GAP for gap in gaps)
        start = max(map(base.time_to_stop, self._faults.intruders), default=0) / SECOND
        longest = base.longest_gap() / _MS
        rest = base.longest_rest([*_merged([*intrusions, *self._block_spans()])]) / SECOND
        stalled = sum(each.length for each in base.stalls) / _MS
        moving = base.moving_share()
        yield Row("commands", "commands at the base", len(base.outputs), "", at_least=1)
        yield Row("moving", "share of them that move it", moving, "", at_least=_MIN_MOVING)
        yield Row("ended", "processes that nobody ended, and are gone", len(self.ended), "", 0)
        yield Row("unguarded", "commands of strangers through the guard", unguarded, "", 0)
        yield Row("gaps", "gaps that nothing explains", len(gaps), "", 0)
        yield Row("gaps.waiting", "  of them, guard or supervisor waited to run", waiting, "")
        yield Row("longest_gap", "longest gap of a moving base", longest, "ms", LONGEST_GAP / _MS)
        yield Row("longest_rest", "longest rest, no person, no intruder", rest, "s", _MAX_REST_S)
        share = base.intruder_share(self._faults.intruders)
        yield Row("intruder_share", "an intruder's share while it is there", share, "", _MAX_SHARE)
        yield Row("intruder_start", "an intruder before a stop", start, "s", _MAX_START_S)
        clear = self._faults.longest_clear()
        clear_s = None if clear is None else clear / SECOND
        yield Row("clear", "an intruder gone, until it is cleared", clear_s, "s", _MAX_CLEAR_S)
        stops = 60 * self._faults.count_unexplained(self._stops) / max(60, base.duration() / SECOND)
        yield Row("false_stops", "stops, none frozen or killed", stops, "/min", _MAX_FALSE_STOPS)
        yield Row("base_stalls", "the base itself did not run", stalled, "ms")

    def _policies(self) -> Iterator[Row]:
        moving = self.base.guarded()
        drive = max((longest_drive(each, moving) for each in self._blocks), default=0) / SECOND
        turn = self.base.longest_turn_of_lower_flow() / SECOND
        yield Row("too_fast", "commands over the frame rate's limit", len(self.too_fast), "", 0)
        yield Row("block_drive", "driven on after a rule blocked", drive, "s", _MAX_DRIVE_S)
        yield Row("lower_flow", "the joystick drove beside the navigation", turn, "s", _MAX_TURN_S)
        yield Row("blocks", "times a rule blocked", len(self._blocks), "")
        yield Row("pictures", "pictures of 10 MB through the guard", self.pictures, "")

    def _actions(self) -> Iterator[Row]:
        goals, ends = self._goals, count_ends(self._goals)
        lost = sum(each.is_lost for each in goals)
        ignored = len(unexplained(goals, self._faults.times(*_STOPS_GOALS)))
        others = sum(each.is_canceled_by_others for each in goals) - self._guard_cancels
        forbidden = count_forbidden(self._started)
        yield Row("goals", "goals sent", len(goals), "", at_least=1)
        yield Row("goals.forbidden", "goals of strangers that were started", forbidden, "", 0)
        yield Row("goals.canceled_by_others", "goals that others cancelled", max(0, others), "", 0)
        yield Row("goals.lost", "accepted goals without a result", lost, "", 0)
        yield Row("goals.ignored", "goals without an answer, all there", ignored, "", 0)
        for name, count in sorted(ends.items()):
            yield Row(f"goals.{name}_count", f"goals {name}", count, "")

    def _sizes(self) -> Iterator[Row]:
        for each in PROGRAMS:
            growth, peak = self._memory.growth(each), self._memory.peak(each)
            most = _MAX_GROWTH[each]
            yield Row(f"growth.{each}", f"growth of the {each} process", growth, "MB", most)
            yield Row(f"peak.{each}", f"most memory of the {each} process", peak, "MB", _MAX_PEAK)

    def _block_spans(self) -> list[Span]:
        return [Span(each.begin, each.end - each.begin + _AFTER_BLOCK) for each in self._blocks]


_MAX_REST_S, _MAX_SHARE, _MAX_START_S = 5.0, 0.5, 2.0
_MIN_MOVING = 0.25
_MAX_DRIVE_S, _MAX_TURN_S = 0.9, 3.0
_MAX_GROWTH = {"guard": 10.0, "supervisor": 10.0, "bulk": 150.0}
"""MB; the bulk process has pictures in its readers and writers, five of 10 MB at most in each."""
_MAX_PEAK = 400.0
_MAX_CLEAR_S, _MAX_FALSE_STOPS = 30.0, 8.0
_AFTER_BLOCK = SECOND // 2


def _merged(spans: Sequence[Span]) -> Iterator[Span]:
    """Yield the spans in order, as one where they touch."""
    begin, end = 0, 0
    for span in sorted(spans, key=lambda each: each.at):
        if span.at > end:
            yield Span(begin, end - begin)
            begin = span.at
        end = max(end, span.at + span.length)
    yield Span(begin, end - begin)


def as_table(rows: Sequence[Row], title: str) -> Table:
    """Return the table for people."""
    shown = Table("figure", title=title)
    for name in ("measured", "bound"):
        shown.add_column(name, justify="right")
    shown.add_column("")
    for row in rows:
        style = "bold red" if row.is_over else None
        measured = f"{number(row.value)} {row.unit}".strip()
        shown.add_row(row.name, measured, row.bound, row.verdict, style=style)
    return shown


def write_json(path: Path, rows: Sequence[Row], **run: object) -> None:
    """Write the figures, their bounds and what was over, for programs."""
    figures = {row.key: asdict(row) | {"verdict": row.verdict} for row in rows}
    over = [row.key for row in rows if row.is_over]
    document = run | {"over": over, "figures": figures}
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(json.dumps(document, indent=2) + "\n", encoding="utf-8")
