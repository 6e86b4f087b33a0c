"""The map of a case with the ways that the robot took."""

from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from rtron.demos.metrics.case_run import CaseRun, RunsByVariant, Variant
from rtron.demos.metrics.table import COLUMN_TITLES
from rtron.demos.plots.style import (
    AREA,
    COLOURS,
    FAINT,
    GROUND,
    INK,
    MUTED,
    WIDTH,
    Style,
    figure_file,
    legend_below,
)
from rtron.demos.world import robot_base
from rtron.demos.world.ground_truth import GroundTruth, Position
from rtron.demos.world.scenes.scene import Crossing, Obstacle, RoundObstacle, Scene

if TYPE_CHECKING:
    from matplotlib.axes import Axes


Edges = tuple[float, float, float, float]


def scene_bounds(scene: Scene) -> Edges:
    """Return left, bottom, right and top (m) of what there is to see."""
    points = [(x, y) for x1, y1, x2, y2 in scene.walls for x, y in ((x1, y1), (x2, y2))]
    points += [scene.start[:2], scene.goal, *(scene.area or ())]
    xs, ys = [x for x, _ in points], [y for _, y in points]
    return min(xs), min(ys), max(xs), max(ys)


def draw_scenery(axes: "Axes", scene: Scene) -> None:
    """Draw walls, obstacles, the unstable area, the light, start and goals."""
    axes.set_facecolor("white")
    axes.grid(visible=True)
    _draw_area(axes, scene.area)
    for x1, y1, x2, y2 in scene.walls:
        axes.plot((x1, x2), (y1, y2), color=INK, linewidth=3, zorder=3)
    for obstacle in scene.obstacles:
        _draw_obstacle(axes, obstacle)
    _draw_walks(axes, scene.crossings)
    _draw_marks(axes, scene)


def _draw_area(axes: "Axes", area: Sequence[Position] | None) -> None:
    if not area:
        return
    from matplotlib.patches import Polygon  # noqa: PLC0415 - only with the extra

    style: Style = {"facecolor": AREA, "alpha": 0.22, "hatch": "///", "edgecolor": AREA}
    axes.add_patch(Polygon(area, label="area without network", zorder=1, **style))


def _draw_obstacle(axes: "Axes", obstacle: Obstacle) -> None:
    from matplotlib.patches import Circle, Polygon  # noqa: PLC0415 - only with the extra

    style: Style = {"facecolor": FAINT, "edgecolor": MUTED, "zorder": 2}
    if isinstance(obstacle, RoundObstacle):
        axes.add_patch(Circle(obstacle.center, obstacle.radius, **style))
    else:
        axes.add_patch(Polygon(obstacle.polygon, **style))


def _draw_walks(axes: "Axes", walks: Iterable[Crossing]) -> None:
    label: str | None = "a pedestrian's way"
    for walk in walks:
        xs, ys = zip(walk.start, walk.stand, strict=True)
        dots: Style = {"linestyle": (0, (1, 2)), "linewidth": 2, "color": MUTED, "zorder": 2}
        axes.plot(xs, ys, marker="o", markersize=4, label=label, **dots)
        label = None


def _draw_marks(axes: "Axes", scene: Scene) -> None:
    marks = [("start", scene.start[:2], "o", GROUND), ("goal", scene.goal, "*", "#f0c000")]
    if scene.bad_goal:
        marks.append(("the attacker's goal", scene.bad_goal, "*", AREA))
    if scene.light:
        marks.append(("traffic light", scene.light, "s", "#c01030"))
    for label, position, marker, colour in marks:
        size = 190 if marker == "*" else 70
        style: Style = {"s": size, "edgecolors": INK, "linewidths": 1.0, "zorder": 8}
        axes.scatter(position[0], position[1], marker=marker, color=colour, label=label, **style)


_MARGIN = 0.15
_ROOM_FOR_TEXT = 1.5
_LOWEST, _HIGHEST = 2.6, 7.4
_LINES: dict[Variant, Style] = {
    Variant.GUARDED: {"linewidth": 4.5, "alpha": 0.85, "zorder": 4},
    Variant.ATTACKED: {"linewidth": 2.4, "zorder": 6},
    Variant.UNATTACKED: {"linewidth": 1.6, "linestyle": (0, (4, 2)), "zorder": 5},
}


def draw_trajectories(path: Path, title: str, scene: Scene, runs: RunsByVariant) -> None:
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
    positions = run.trajectory
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
        _draw_harm(axes, harm, truth.position)


def _draw_body(axes: "Axes", last: GroundTruth, colour: str) -> None:
    """Draw the robot where it ended up, as large as it is."""
    from matplotlib.patches import Circle  # noqa: PLC0415 - only with the extra

    body = Circle(last.position, robot_base.RADIUS, facecolor=colour, alpha=0.25, edgecolor=colour)
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
