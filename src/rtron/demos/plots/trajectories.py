"""The map of a case with the ways that the robot took."""

from pathlib import Path
from typing import TYPE_CHECKING

from rtron.demos.metrics.case_run import Run, Runs, Variant
from rtron.demos.metrics.table import HEADS
from rtron.demos.metrics.trajectory import ROBOT_RADIUS, Scene, place, way
from rtron.demos.plots.scenery import draw_scenery, edges
from rtron.demos.plots.style import COLOURS, INK, WIDTH, Style, drawn, legend_below
from rtron.demos.world.ground_truth import Place, Truth

if TYPE_CHECKING:
    from matplotlib.axes import Axes

_MARGIN = 0.15
_ROOM_FOR_TEXT = 1.5
_LOWEST, _HIGHEST = 2.6, 7.4
_LINES: dict[Variant, Style] = {
    Variant.GUARDED: {"linewidth": 4.5, "alpha": 0.85, "zorder": 4},
    Variant.ATTACKED: {"linewidth": 2.4, "zorder": 6},
    Variant.UNATTACKED: {"linewidth": 1.6, "linestyle": (0, (4, 2)), "zorder": 5},
}


def trajectories(path: Path, title: str, scene: Scene, runs: Runs) -> None:
    """Draw the scene and each run's way into the PNG `path`."""
    left, bottom, right, top = edges(scene)
    scaled = WIDTH * (top - bottom) / (right - left)
    height = min(_HIGHEST, max(_LOWEST, scaled + _ROOM_FOR_TEXT))
    with drawn(path, height) as (figure, (axes,)):
        axes.set_title(title)
        axes.set_aspect("equal")
        axes.set_xlim(left - _MARGIN, right + _MARGIN)
        axes.set_ylim(bottom - _MARGIN, top + _MARGIN)
        axes.set_xlabel("x [m]")
        axes.set_ylabel("y [m]")
        draw_scenery(axes, scene)
        for run in runs.values():
            _draw_run(axes, run)
        legend_below(figure, axes, columns=4)


def _draw_run(axes: "Axes", run: Run) -> None:
    places = way(run.samples)
    if not places:
        return
    axes.plot(
        [x for x, _ in places],
        [y for _, y in places],
        color=COLOURS[run.variant],
        label=HEADS[run.variant],
        **_LINES[run.variant],
    )
    _draw_body(axes, run.samples[-1], COLOURS[run.variant])
    for harm, truth in run.harms.items():
        _draw_harm(axes, harm, place(truth))


def _draw_body(axes: "Axes", last: Truth, colour: str) -> None:
    """Draw the robot where it ended up, as large as it is."""
    from matplotlib.patches import Circle  # noqa: PLC0415 - only with the extra

    body = Circle(place(last), ROBOT_RADIUS, facecolor=colour, alpha=0.25, edgecolor=colour)
    axes.add_patch(body)


def _draw_harm(axes: "Axes", harm: str, where: Place) -> None:
    axes.scatter(*where, marker="X", s=130, color=INK, edgecolors="white", zorder=9)
    axes.annotate(
        harm,
        where,
        xytext=(13, 0),
        textcoords="offset points",
        va="center",
        weight="bold",
        zorder=10,
        bbox={"boxstyle": "round,pad=0.2", "facecolor": "white", "edgecolor": "none", "alpha": 0.8},
    )
