"""An incident: how fast the robot was told to go, how fast it was let go, and where to."""

from collections.abc import Sequence
from itertools import chain, pairwise
from math import dist, nan
from pathlib import Path
from typing import TYPE_CHECKING

from rtron.demos.metrics.case_run import Variant
from rtron.demos.plots.style import (
    AREA,
    COLOURS,
    INK,
    LIMIT,
    MUTED,
    Style,
    figure_file,
    legend_below,
)
from rtron.errors import InputError
from rtron.vocabulary import SECOND, Alternative, Area, Curve, IncidentAccount, TopicAccount
from rtron.workflows.what_if import (
    HOLD,
    SpeedCurve,
    alternative_path,
    first_difference,
    robot_poses,
)

if TYPE_CHECKING:
    from matplotlib.axes import Axes

_HEIGHT = 6.6
_ENDINGS = (".png", ".svg")
_JUMP = 0.5
"""A robot that is so far from where it just was, m, was carried there, or had lost its way."""
_CAUSES = {"intervention": ":", "stop": "--", "alarm": "-"}
_OUTPUT: Style = {"color": COLOURS[Variant.GUARDED], "linewidth": 2.6, "label": "what went out"}
_OTHER: Style = {"color": COLOURS[Variant.ATTACKED], "linewidth": 1.6, "linestyle": (0, (4, 2))}


def draw_incident(
    path: Path,
    account: IncidentAccount,
    alternative: Alternative | None,
    areas: Sequence[Area] = (),
) -> None:
    """Draw the speeds and the path of the topic that the first cause is about, as PNG or SVG.

    InputError for another ending, and if no topic has velocities; SourceError without matplotlib.
    """
    if path.suffix not in _ENDINGS:
        raise InputError("a picture is .png or .svg", path=str(path), help="choose another name")
    topic = _topic(account)
    found = account.topics[topic]
    other = alternative.outputs.get(topic, []) if alternative else []
    title = f"would have been {alternative.title}" if alternative else ""
    try:
        with figure_file(path, _HEIGHT, 2, share_time=False) as (_figure, (speeds, way)):
            _draw_speeds(speeds, found, other, title)
            _mark_causes(speeds, account)
            speeds.set_title(f"{topic}: {account.header.causes[0].reason}"[:90])
            _draw_path(way, account, found.output, other, areas)
            legend_below(_figure, speeds, columns=3)
    except OSError as error:
        raise InputError(error.strerror or "cannot be written", path=str(path)) from None


def _topic(account: IncidentAccount) -> str:
    """Return the topic of the first cause if it has velocities, or else the first that has."""
    topics = [cause.topic for cause in account.header.causes]
    for topic in chain(topics, account.topics):
        found = account.topics.get(topic)
        if found and (found.output or found.commands):
            return topic
    raise InputError("no topic of the incident has velocities", help="there is nothing to draw")


def _draw_speeds(axes: "Axes", found: TopicAccount, other: Curve, title: str) -> None:
    for flow, curve in found.commands.items():
        times = [at / SECOND for at, _ in curve]
        speeds = [each.speed for _, each in curve]
        axes.plot(times, speeds, ".", markersize=2.5, color=MUTED, alpha=0.6, label=f"from {flow}")
    axes.step(*_steps(found.output), where="post", zorder=3, **_OUTPUT)
    if other:
        axes.step(*_steps(other), where="post", zorder=4, label=title, **_OTHER)
    limits = [(at / SECOND, nan if limit is None else limit) for at, limit in found.limits]
    if limits:
        limits.append((max(axes.get_xlim()[1], limits[-1][0]), limits[-1][1]))
        axes.step(
            *zip(*limits, strict=True), where="post", color=LIMIT, linewidth=1.2, label="limit"
        )
    axes.set_ylabel("speed [m/s]")
    axes.set_xlabel("time after the first cause [s]")
    axes.grid(visible=True)


def _steps(curve: Curve) -> tuple[list[float], list[float]]:
    """Return times and speeds; where nothing was said for long, the line is broken."""
    times: list[float] = []
    speeds: list[float] = []
    for at, velocity in curve:
        if times and at / SECOND - times[-1] > HOLD / SECOND:
            times.append(times[-1] + HOLD / SECOND)
            speeds.append(nan)
        times.append(at / SECOND)
        speeds.append(velocity.speed)
    return times, speeds


def _mark_causes(axes: "Axes", account: IncidentAccount) -> None:
    first = account.header.causes[0].at
    for each in account.header.causes:
        at = (each.at - first) / SECOND
        axes.axvline(at, color=INK, linewidth=0.9, linestyle=_CAUSES[each.kind], label=each.kind)


def _draw_path(
    axes: "Axes", account: IncidentAccount, output: Curve, other: Curve, areas: Sequence[Area]
) -> None:
    """Draw where the robot was, as poses say or by dead reckoning, and where it would have been."""
    poses = robot_poses(account, {area.frame for area in areas})
    if poses:
        path = _broken_at_jumps([(each.x, each.y) for each in poses])
        since = first_difference(output, other)
        would_be = alternative_path(poses, other, since) if since is not None else []
        for area in areas:
            if area.frame == poses[0].frame:
                _draw_area(axes, area)
    else:
        path = [(x, y) for _, x, y in SpeedCurve(output).path()]
        would_be = SpeedCurve(other).path()
    if path:
        axes.plot(*zip(*path, strict=True), **_OUTPUT)
        axes.plot(*path[0], "o", color=INK, markersize=5)
    if would_be:
        axes.plot([x for _, x, _ in would_be], [y for _, _, y in would_be], **_OTHER)
    axes.set_aspect("equal", adjustable="datalim")
    how = f"in {poses[0].frame}" if poses else "by dead reckoning of what the base was told"
    axes.set_xlabel(f"x [m], {how}")
    axes.set_ylabel("y [m]")
    axes.grid(visible=True)


def _broken_at_jumps(path: Sequence[tuple[float, float]]) -> list[tuple[float, float]]:
    found = list(path[:1])
    for before, here in pairwise(path):
        found += [(nan, nan), here] if dist(before, here) > _JUMP else [here]
    return found


def _draw_area(axes: "Axes", area: Area) -> None:
    corners = [(each.x, each.y) for each in area.polygon]
    axes.fill(*zip(*corners, strict=True), color=AREA, alpha=0.35, linewidth=0)
    left, top = min(x for x, _ in corners), max(y for _, y in corners)
    axes.annotate(area.name, (left, top), color=MUTED, xytext=(4, -12), textcoords="offset points")
