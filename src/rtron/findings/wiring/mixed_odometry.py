"""Nodes of one control loop read raw and fused odometry.

## What it finds

Two nodes of which one sends the other commands of motion, directly or through further nodes. One
reads an odometry as its source sends it, the other reads what a filter makes of it. A filter is a
node that publishes odometry and reads at least two measurements (odometry, an IMU, poses, a fix),
or one of `robot_localization` or `fuse`. A node that reads both does not count, nor do nodes that
send each other no commands.

## Why it matters

The two differ by what the filter corrects: slip, drift, a delay. The second node takes away or adds
speed because of an error that the first one does not see. The robot swings, or does not get to
where it should.

## Remedy

Have both nodes read the filtered odometry.

## Example

`/ekf` makes `/odometry/filtered` of `/odom`. `/controller_server` reads `/odometry/filtered`,
`/velocity_smoother` behind it reads `/odom`.
"""

from collections import defaultdict
from collections.abc import Iterable, Iterator
from typing import NamedTuple

from rtron.findings.app_facts import AppFacts
from rtron.findings.rule import FindingRule, make_finding
from rtron.vocabulary import Certainty, Consequence, Endpoint, Finding, normalise_type
from rtron.wording import conjugate, join_names

_ODOMETRY = "nav_msgs/Odometry"
_MEASUREMENTS = frozenset(
    {
        *(_ODOMETRY, "sensor_msgs/Imu", "sensor_msgs/NavSatFix"),
        *("geometry_msgs/PoseWithCovarianceStamped", "geometry_msgs/TwistWithCovarianceStamped"),
    }
)
_FILTER_PACKAGES = ("robot_localization", "fuse_optimizers")


class _Fusion(NamedTuple):
    """An odometry that a filter makes of a raw one."""

    node: str
    raw: str
    fused: str


def check(app: AppFacts) -> Iterator[Finding]:
    """Yield a finding for each raw and fused odometry that one chain of commands reads."""
    for fusion in _fusions(app):
        raw, fused = (
            set(app.readers(topic)).difference(app.publishers(fusion.raw), {fusion.node})
            for topic in (fusion.raw, fusion.fused)
        )
        both = raw & fused
        links = {
            *_links(app, raw - both, fused - both),
            *((there, here) for here, there in _links(app, fused - both, raw - both)),
        }
        if links:
            yield _finding(app, fusion, links)


def _fusions(app: AppFacts) -> Iterator[_Fusion]:
    """Yield what each filter makes of odometry that comes from a source, not from a filter."""
    made: dict[str, set[str]] = {
        node: {topic for topic in _odometry(app.graph.published_by(node)) if "{" not in topic}
        for node in filter(lambda name: _is_filter(app, name), app.nodes)
    }
    outputs = {topic for topics in made.values() for topic in topics}
    for node, fused in made.items():
        for raw in sorted(_odometry(app.graph.subscribed_by(node)) - outputs):
            yield from (_Fusion(node, raw, topic) for topic in sorted(fused))


def _odometry(endpoints: Iterable[Endpoint]) -> set[str]:
    return {end.topic for end in endpoints if normalise_type(end.type) == _ODOMETRY}


def _is_filter(app: AppFacts, node: str) -> bool:
    if app.nodes[node].package.startswith(_FILTER_PACKAGES):
        return True
    read = {e.topic for e in app.graph.subscribed_by(node) if _is_measurement(e.type)}
    return len(read) > 1 and not any(app.is_motion(e.topic) for e in app.graph.published_by(node))


def _is_measurement(type: str) -> bool:
    return normalise_type(type) in _MEASUREMENTS


def _links(app: AppFacts, first: set[str], second: set[str]) -> Iterator[tuple[str, str]]:
    """Yield pairs of a node and one behind it that its commands reach."""
    origins = {node: node for node in sorted(first)}
    pending = list(origins)
    while pending:
        node = pending.pop()
        for reader in sorted(_commanded(app, node) - origins.keys()):
            origins[reader] = origins[node]
            pending.append(reader)
            if reader in second:
                yield origins[reader], reader


def _commanded(app: AppFacts, node: str) -> set[str]:
    """Return the nodes that read what a node sends to command motion; stops do not count."""
    topics = {end.topic for end in app.graph.published_by(node)}
    moving = (name for name in topics if app.is_motion(name) and not app.is_stop(name))
    return {reader for name in moving for reader in app.readers(name)}


def _finding(app: AppFacts, fusion: _Fusion, links: Iterable[tuple[str, str]]) -> Finding:
    readers: dict[str, set[str]] = defaultdict(set)
    for raw_reader, fused_reader in links:
        readers[fusion.raw].add(raw_reader)
        readers[fusion.fused].add(fused_reader)
    raw, fused = sorted(readers[fusion.raw]), sorted(readers[fusion.fused])
    subscribers = (*app.graph.subscribers(fusion.raw), *app.graph.subscribers(fusion.fused))
    return make_finding(
        RULE.name,
        fusion.raw,
        summary=f"{join_names(raw)} {conjugate(raw, 'read')} {fusion.raw}, {join_names(fused)} in "
        f"the same control loop {conjugate(fused, 'read')} {fusion.fused}",
        cause=f"{fusion.node} makes {fusion.fused} of {fusion.raw}",
        remedy=f"let {join_names(raw)} read {fusion.fused} too",
        consequence=Consequence.FAILURE,
        certainty=Certainty.LIKELY,
        nodes=(*raw, *fused, fusion.node),
        topics=(fusion.raw, fusion.fused),
        evidence=app.evidence(end for end in subscribers if end.node in (*raw, *fused)),
    )


RULE = FindingRule(
    name="mixed_odometry",
    title="Nodes of one control loop read raw and fused odometry",
    consequence="failure: likely",
    since="0.2.0",
    check=check,
)
