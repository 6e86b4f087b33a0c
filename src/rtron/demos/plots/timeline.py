"""What the guard decided about whose messages, over time."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from rtron.demos.metrics.case_run import (
    DECISIONS,
    SECOND,
    CaseRun,
    SecondCounts,
    decision_counts,
)
from rtron.demos.plots.style import (
    FAINT,
    MUTED,
    Style,
    figure_file,
    legend_below,
    shade_attack,
)
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
