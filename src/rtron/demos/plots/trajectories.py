"""The map of a case with the ways that the robot took."""

from pathlib import Path
from typing import TYPE_CHECKING

from rtron.demos.metrics.case_run import CaseRun, RunsByVariant, Variant
from rtron.demos.metrics.table import COLUMN_TITLES
from rtron.demos.metrics.trajectory import ROBOT_RADIUS, SceneDocument, position_of, trajectory_of
from rtron.demos.plots.scenery import draw_scenery, scene_bounds
from rtron.demos.plots.style import COLOURS, INK, WIDTH, Style, figure_file, legend_below
from rtron.demos.world.ground_truth import GroundTruth, Position

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


def draw_trajectories(path: Path, title: str, scene: SceneDocument, runs: RunsByVariant) -> None:
    """Draw the scene and each run's way into the PNG `path`."""
    left, bottom, right, top = scene_bounds(scene)
    scaled = WIDTH * (top - bottom) / (right - left)
    height = min(_HIGHEST, max(_LOWEST, scaled + _ROOM_FOR_TEXT))
    with figure_file(path, height) as (figure, (axes,)):
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


def _draw_run(axes: "Axes", run: CaseRun) -> None:
    positions = trajectory_of(run.samples)
    if not positions:
        return
    axes.plot(
        [x for x, _ in positions],
        [y for _, y in positions],
        color=COLOURS[run.variant],
        label=COLUMN_TITLES[run.variant],
        **_LINES[run.variant],
    )
    _draw_body(axes, run.samples[-1], COLOURS[run.variant])
    for harm, truth in run.first_harms.items():
        _draw_harm(axes, harm, position_of(truth))


def _draw_body(axes: "Axes", last: GroundTruth, colour: str) -> None:
    """Draw the robot where it ended up, as large as it is."""
    from matplotlib.patches import Circle  # noqa: PLC0415 - only with the extra

    body = Circle(position_of(last), ROBOT_RADIUS, facecolor=colour, alpha=0.25, edgecolor=colour)
    axes.add_patch(body)


def _draw_harm(axes: "Axes", harm: str, where: Position) -> None:
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
