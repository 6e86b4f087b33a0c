"""What stands in the world of a case, drawn as seen from above."""

from collections.abc import Iterable, Mapping, Sequence
from typing import TYPE_CHECKING, Any

from rtron.demos.metrics.trajectory import SceneDocument
from rtron.demos.plots.style import AREA, FAINT, GROUND, INK, MUTED, Style
from rtron.demos.world.ground_truth import Position

if TYPE_CHECKING:
    from matplotlib.axes import Axes

Edges = tuple[float, float, float, float]


def scene_bounds(scene: SceneDocument) -> Edges:
    """Return left, bottom, right and top (m) of what there is to see."""
    points = [(x, y) for x1, y1, x2, y2 in scene["walls"] for x, y in ((x1, y1), (x2, y2))]
    points += [scene["start"][:2], scene["goal"], *(scene["area"] or ())]
    xs, ys = [x for x, _ in points], [y for _, y in points]
    return min(xs), min(ys), max(xs), max(ys)


def draw_scenery(axes: "Axes", scene: SceneDocument) -> None:
    """Draw walls, obstacles, the unstable area, the light, start and goals."""
    axes.set_facecolor("white")
    axes.grid(visible=True)
    _draw_area(axes, scene["area"])
    for x1, y1, x2, y2 in scene["walls"]:
        axes.plot((x1, x2), (y1, y2), color=INK, linewidth=3, zorder=3)
    for obstacle in scene["obstacles"]:
        _draw_obstacle(axes, obstacle)
    _draw_walks(axes, scene["pedestrian_paths"])
    _draw_marks(axes, scene)


def _draw_area(axes: "Axes", area: Sequence[Position] | None) -> None:
    if not area:
        return
    from matplotlib.patches import Polygon  # noqa: PLC0415 - only with the extra

    style: Style = {"facecolor": AREA, "alpha": 0.22, "hatch": "///", "edgecolor": AREA}
    axes.add_patch(Polygon(area, label="area without network", zorder=1, **style))


def _draw_obstacle(axes: "Axes", obstacle: Mapping[str, Any]) -> None:
    from matplotlib.patches import Circle, Polygon  # noqa: PLC0415 - only with the extra

    style: Style = {"facecolor": FAINT, "edgecolor": MUTED, "zorder": 2}
    if "polygon" in obstacle:
        axes.add_patch(Polygon(obstacle["polygon"], **style))
    else:
        axes.add_patch(Circle(obstacle["center"], obstacle["radius"], **style))


def _draw_walks(axes: "Axes", walks: Iterable[Sequence[Position]]) -> None:
    label: str | None = "a pedestrian's way"
    for walk in walks:
        xs, ys = [position[0] for position in walk], [position[1] for position in walk]
        dots: Style = {"linestyle": (0, (1, 2)), "linewidth": 2, "color": MUTED, "zorder": 2}
        axes.plot(xs, ys, marker="o", markersize=4, label=label, **dots)
        label = None


def _draw_marks(axes: "Axes", scene: SceneDocument) -> None:
    marks = [("start", scene["start"][:2], "o", GROUND), ("goal", scene["goal"], "*", "#f0c000")]
    if scene["bad_goal"]:
        marks.append(("the attacker's goal", scene["bad_goal"], "*", AREA))
    if scene["light"]:
        marks.append(("traffic light", scene["light"], "s", "#c01030"))
    for label, position, marker, colour in marks:
        size = 190 if marker == "*" else 70
        style: Style = {"s": size, "edgecolors": INK, "linewidths": 1.0, "zorder": 8}
        axes.scatter(position[0], position[1], marker=marker, color=colour, label=label, **style)
