"""A node reads past the one that filters for it.

## What it finds

A node that makes of one topic another of the same type (a filter, a throttle, a merger), whose
output nobody subscribes, while other nodes subscribe its input. Outputs below the node's own name,
which are for people to look at, do not count.

## Why it matters

The filter runs for nothing, and the others work with what it should have taken out: raw data of an
IMU, a scan with the robot's own body in it. Most often a parameter or a remap still has the old
name.

## Remedy

Have the readers subscribe the output, or do not start the node.

## Example

`/imu_filter` makes `/imu_filtered/data` of `/imu/data`, and `/ekf` subscribes `/imu/data`.
"""

from collections.abc import Iterator

from rtron.findings.app_facts import AppFacts
from rtron.findings.rule import FindingRule, make_finding
from rtron.risks.wording import conjugate, join_names
from rtron.vocabulary import Certainty, Consequence, Direction, Finding, FindingLevel


def check(app: AppFacts) -> Iterator[Finding]:
    """Yield a finding for each node whose output nobody reads, while others read its input."""
    for node in app.nodes:
        for output in _unread_outputs(app, node):
            for source in _inputs_like(app, node, output):
                readers = tuple(each for each in app.readers(source) if each != node)
                if readers and app.publishers(source):
                    yield _finding(app, node, source, output, readers)


def _unread_outputs(app: AppFacts, node: str) -> list[str]:
    published = sorted({end.topic for end in app.graph.published_by(node) if not end.implicit})
    return [
        topic
        for topic in published
        if app.publishers(topic) == (node,)
        and not app.graph.subscribers(topic)
        and not topic.startswith(f"{node}/")
        and "{" not in topic
    ]


def _inputs_like(app: AppFacts, node: str, output: str) -> list[str]:
    """Return what a node subscribes that has the type of one of its outputs."""
    types = app.types(output, Direction.PUBLISH).keys()
    subscribed = sorted({end.topic for end in app.graph.subscribed_by(node) if not end.implicit})
    return [t for t in subscribed if types & app.types(t, Direction.SUBSCRIBE).keys()]


def _finding(
    app: AppFacts, node: str, source: str, output: str, readers: tuple[str, ...]
) -> Finding:
    return make_finding(
        RULE.name,
        output,
        summary=f"{join_names(readers)} {conjugate(readers, 'read')} {source} past {node}",
        cause=f"{node} makes {output} of it, which nobody subscribes",
        remedy=f"subscribe {output} instead, or do not start {node}",
        consequence=Consequence.FAILURE,
        certainty=Certainty.POSSIBLE,
        level=FindingLevel.PEDANTIC,
        nodes=(node, *readers),
        topics=(output, source),
        evidence=app.evidence(app.graph.subscribers(source)),
    )


RULE = FindingRule(
    name="bypassed_node",
    title="A node reads past the one that filters for it",
    consequence="failure: possible",
    since="0.2.0",
    check=check,
)
