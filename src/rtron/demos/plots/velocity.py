"""The speed of each run of a case, drawn."""

from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING

from rtron.demos.metrics.case_run import (
    CaseRun,
    RunsByVariant,
    Variant,
)
from rtron.demos.metrics.table import COLUMN_TITLES
from rtron.demos.plots.style import (
    COLOURS,
    INK,
    LIMIT,
    Style,
    figure_file,
    legend_below,
    shade_attack,
)
from rtron.demos.world.ground_truth import GroundTruth
from rtron.demos.world.scenes.scene import OVERSPEED

if TYPE_CHECKING:
    from matplotlib.axes import Axes


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
