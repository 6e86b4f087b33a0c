"""Nodes of one control loop read raw and fused odometry.

## What it finds

One node sends commands of motion to another one. One of the two reads an odometry as its source
sends it, the other what a filter makes of it. The robot swings, or misses its goal.

For example, `/ekf` makes `/odometry/filtered` of `/odom`. `/controller_server` reads
`/odometry/filtered`, `/velocity_smoother` behind it reads `/odom`.

## What to do

Have both nodes read the filtered odometry.

## When it is silent

Where a node reads both, or more than five odometries. Outside of navigation stacks, where a cascade
may be right, it is `pedantic`.
"""

from collections import defaultdict
from collections.abc import Callable, Iterable, Iterator
from functools import cache, partial
from itertools import product
from typing import NamedTuple, TypeAlias

from rtron.findings.app_facts import AppFacts
from rtron.findings.rule import FindingRule, make_finding
from rtron.vocabulary import Certainty, Consequence, Endpoint, Finding, normalise_type
from rtron.wording import conjugate, join_names

_ODOMETRY = "nav_msgs/Odometry"
_MEASUREMENT_TYPES = frozenset(
    {
        *(_ODOMETRY, "sensor_msgs/Imu", "sensor_msgs/NavSatFix"),
        *("geometry_msgs/PoseWithCovarianceStamped", "geometry_msgs/TwistWithCovarianceStamped"),
    }
)
_FILTER_PACKAGES = ("robot_localization", "fuse_optimizers")
_ONE_POSE = ("nav2_", "opennav_", "move_base", "mbf_", "yocs_velocity_smoother")
"""How packages begin whose nodes plan, follow and smooth with one pose and its velocity."""
_MOST_ODOMETRIES = 5
"""A node with more of them is no filter of one robot, and each pair takes a walk of the graph."""
_Commanded: TypeAlias = Callable[[str], set[str]]


class _Fusion(NamedTuple):
    """An odometry that a filter makes of a raw one."""

    node: str
    raw: str
    fused: str


def check(app: AppFacts) -> Iterator[Finding]:
    """Yield a finding for each raw and fused odometry that one chain of commands reads."""
    commanded = cache(partial(_commanded, app))
    for fusion in _fusions(app):
        raw, fused = (
            set(app.readers(topic)).difference(app.publishers(fusion.raw), {fusion.node})
            for topic in (fusion.raw, fusion.fused)
        )
        both = raw & fused
        links = {
            *_links(commanded, raw - both, fused - both),
            *((there, here) for here, there in _links(commanded, fused - both, raw - both)),
        }
        if links:
            sure = {link for link in links if _need_one_pose(app, link)}
            yield _finding(app, fusion, sure or links, is_sure=bool(sure))


def _fusions(app: AppFacts) -> Iterator[_Fusion]:
    """Yield what each filter makes of odometry that comes from a source, not from a filter."""
    made: dict[str, set[str]] = {
        node: {topic for topic in _odometry(app.graph.published_by(node)) if "{" not in topic}
        for node in filter(lambda name: _is_filter(app, name), app.nodes)
    }
    outputs = {topic for topics in made.values() for topic in topics}
    for node, fused in made.items():
        raw = _odometry(app.graph.subscribed_by(node)) - outputs
        if max(len(raw), len(fused)) <= _MOST_ODOMETRIES:
            yield from (_Fusion(node, *pair) for pair in product(sorted(raw), sorted(fused)))


def _odometry(endpoints: Iterable[Endpoint]) -> set[str]:
    return {end.topic for end in endpoints if normalise_type(end.type) == _ODOMETRY}


def _is_filter(app: AppFacts, node: str) -> bool:
    if app.nodes[node].package.startswith(_FILTER_PACKAGES):
        return True
    read = {e.topic for e in app.graph.subscribed_by(node) if _is_measurement(e.type)}
    return len(read) > 1 and not any(app.is_motion(e.topic) for e in app.graph.published_by(node))


def _is_measurement(type: str) -> bool:
    return normalise_type(type) in _MEASUREMENT_TYPES


def _need_one_pose(app: AppFacts, nodes: Iterable[str]) -> bool:
    """Return whether nodes are known to work with one pose: others may control in a cascade."""
    packages = (app.nodes[node].package if node in app.nodes else "" for node in nodes)
    return all(package.startswith(_ONE_POSE) for package in packages)


def _links(commanded: _Commanded, first: set[str], second: set[str]) -> Iterator[tuple[str, str]]:
    """Yield pairs of a node and one behind it that its commands reach."""
    origins = {node: node for node in sorted(first)}
    pending = list(origins)
    while pending:
        node = pending.pop()
        for reader in sorted(commanded(node) - origins.keys()):
            origins[reader] = origins[node]
            pending.append(reader)
            if reader in second:
                yield origins[reader], reader


def _commanded(app: AppFacts, node: str) -> set[str]:
    """Return the nodes that read what a node sends to command motion; stops do not count."""
    topics = {end.topic for end in app.graph.published_by(node)}
    moving = (name for name in topics if app.is_motion(name) and not app.is_stop(name))
    return {reader for name in moving for reader in app.readers(name)}


def _finding(
    app: AppFacts, fusion: _Fusion, links: Iterable[tuple[str, str]], *, is_sure: bool
) -> Finding:
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
        certainty=Certainty.LIKELY if is_sure else Certainty.POSSIBLE,
        nodes=(*raw, *fused, fusion.node),
        topics=(fusion.raw, fusion.fused),
        evidence=app.evidence(end for end in subscribers if end.node in (*raw, *fused)),
    )


RULE = FindingRule(
    name="mixed_odometry",
    title="Nodes of one control loop read raw and fused odometry",
    consequence="failure: likely between nodes that need one pose, else possible",
    since="0.1.0",
    check=check,
)
