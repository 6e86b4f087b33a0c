"""What the guard decided about whose messages, over time."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from rtron.demos.metrics.case_run import (
    DECISIONS,
    SECOND,
    CaseRun,
    RunsByVariant,
    SecondCounts,
    Variant,
    decision_counts,
)
from rtron.demos.metrics.table import COLUMN_TITLES
from rtron.demos.plots.style import (
    COLOURS,
    FAINT,
    INK,
    LIMIT,
    MUTED,
    Style,
    figure_file,
    legend_below,
    shade_attack,
)
from rtron.demos.world.ground_truth import GroundTruth
from rtron.demos.world.scenes.scene import OVERSPEED
from rtron.vocabulary import UNAPPROVED

if TYPE_CHECKING:
    from matplotlib.axes import Axes


DECISION_LABELS = {"pass": "passed", "hold": "held", "drop": "dropped", "modify": "changed"}


@dataclass(frozen=True, slots=True)
class FlowLane:
    """A flow: for each counted time, when it began (simulated s) and how often which decision."""

    topic: str
    publisher: str
    bars: Sequence[tuple[float, Mapping[str, int]]]

    @property
    def totals(self) -> str:
        """How many messages met which decision, in words."""
        sums = {name: sum(counts[name] for _, counts in self.bars) for name in DECISIONS}
        return ", ".join(
            f"{count} {DECISION_LABELS[name]}" for name, count in sums.items() if count
        )

    @property
    def busiest(self) -> int:
        """How many messages came in the busiest of the counted times."""
        return max(sum(counts.values()) for _, counts in self.bars)


def flow_lanes(run: CaseRun, topics: Sequence[str]) -> tuple[FlowLane, ...]:
    """Return the flows of some topics that spoke in a run, in the order of topics and names."""
    counted = [each for each in decision_counts(run.events) if each.topic in topics]
    found: dict[tuple[str, str], list[SecondCounts]] = {}
    for each in counted:
        found.setdefault((each.topic, each.flow), []).append(each)
    known = {**run.publishers, **{(topic, UNAPPROVED): "whoever else" for topic in topics}}
    ordered = sorted(found, key=lambda key: (topics.index(key[0]), known.get(key, "~")))
    return tuple(
        FlowLane(
            key[0],
            known.get(key, key[1]),
            [(_second_start(run, e.at), e.counts) for e in found[key]],
        )
        for key in ordered
        if any(any(each.counts.values()) for each in found[key])
    )


def _second_start(run: CaseRun, at: int) -> float:
    """Return when (simulated s of the run) the wall second began that ends at `at` (wall ns)."""
    return (at / SECOND - 1 - run.start_wall) * run.speed


_COLOURS = {"pass": "#009e73", "hold": "#56b4e9", "drop": "#d55e00", "modify": "#e6b400"}
_ROW, _AROUND = 0.62, 1.5
_SHARE = 0.78
"""Of a lane's height that the bar of its busiest second takes."""

_GAP = 0.96
"""Of a second's width that its bar takes, so that the seconds can be told apart."""


def draw_timeline(path: Path, title: str, run: CaseRun, topics: Sequence[str]) -> None:
    """Draw a guarded run's decisions on some topics, second by second, into the PNG `path`."""
    found = flow_lanes(run, topics)
    with figure_file(path, _AROUND + _ROW * max(1, len(found))) as (figure, (axes,)):
        axes.set_title(title)
        shade_attack(axes, run)
        for number, lane in enumerate(found):
            _draw(axes, len(found) - 1 - number, lane, run)
        axes.set_ylim(-0.1, len(found))
        axes.set_xlim(0, run.ended)
        axes.set_yticks([])
        axes.spines["left"].set_visible(False)
        axes.set_xlabel("time since the start [simulated s]")
        _add_legend(axes, found)
        legend_below(figure, axes, columns=5)


def _draw(axes: "Axes", row: int, lane: FlowLane, run: CaseRun) -> None:
    wide = _GAP * run.speed
    axes.axhline(row, color=FAINT, linewidth=1)
    for began, counts in lane.bars:
        bottom = float(row)
        for name in DECISIONS:
            height = _SHARE * counts[name] / lane.busiest
            axes.bar(began, height, wide, bottom, align="edge", color=_COLOURS[name])
            bottom += height
    outside: Style = {
        "xycoords": ("axes fraction", "data"),
        "va": "center",
        "annotation_clip": False,
    }
    axes.annotate(f"{lane.publisher}\nto {lane.topic}", (-0.01, row + 0.4), ha="right", **outside)
    totals = lane.totals.replace(", ", "\n")
    axes.annotate(totals, (1.01, row + 0.4), ha="left", color=MUTED, **outside)


def _add_legend(axes: "Axes", found: Sequence[FlowLane]) -> None:
    """Give the legend an entry for each decision that occurs."""
    for name, label in DECISION_LABELS.items():
        if any(counts[name] for lane in found for _, counts in lane.bars):
            axes.bar(0, 0, color=_COLOURS[name], label=label)


_HEIGHT = {1: 3.6, 2: 5.4}
_LINES: dict[Variant, Style] = {
    Variant.GUARDED: {"linewidth": 3.2, "alpha": 0.85, "zorder": 3},
    Variant.ATTACKED: {"linewidth": 1.8, "zorder": 5},
    Variant.UNATTACKED: {"linewidth": 1.4, "linestyle": (0, (4, 2)), "zorder": 4},
}


def draw_velocity(path: Path, title: str, runs: RunsByVariant, *, turn: bool) -> None:
    """Draw the speed of each run, and how fast it turned if `turn`, into the PNG `path`."""
    rows = 2 if turn else 1
    with figure_file(path, _HEIGHT[rows], rows) as (figure, axes):
        axes[0].set_title(title)
        axes[0].set_ylabel("speed [m/s]")
        for run in runs.values():
            _draw_velocity(axes[0], run, _speed)
            if turn:
                _draw_velocity(axes[1], run, _turn)
        if turn:
            axes[1].set_ylabel("turn [rad/s]")
        axes[0].axhline(OVERSPEED, color=LIMIT, linewidth=1.4, label="too fast above this")
        for each in axes:
            shade_attack(each, *runs.values())
            each.margins(y=0.1)
            each.set_xlim(left=0.0)
        axes[-1].set_xlabel("time since the start [simulated s]")
        legend_below(figure, axes[0], columns=3)


def _draw_velocity(axes: "Axes", run: CaseRun, value: Callable[[GroundTruth], float]) -> None:
    times = [sample.t for sample in run.samples]
    label, colour = COLUMN_TITLES[run.variant], COLOURS[run.variant]
    axes.plot(
        times, list(map(value, run.samples)), color=colour, label=label, **_LINES[run.variant]
    )
    axes.grid(visible=True)
    for harm, truth in run.first_harms.items():
        axes.scatter(truth.t, value(truth), marker="X", s=80, color=INK, label=harm, zorder=7)


def _speed(truth: GroundTruth) -> float:
    return truth.velocity[0]


def _turn(truth: GroundTruth) -> float:
    return truth.velocity[1]
