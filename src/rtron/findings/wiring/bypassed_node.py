"""A node ignores a filtered topic.

## What it finds

A filter or throttle runs for nothing: it republishes a topic under a similar name with the same
type, nobody subscribes its output, and other nodes subscribe its input. Most often a parameter or a
remap still has the old name.

For example, `/imu_filter` makes `/imu_filtered/data` of `/imu/data`, and `/ekf` subscribes
`/imu/data`.

## What to do

Have the readers subscribe the output, or do not start the node.

## When it is silent

Below the level `pedantic`; with several outputs of the type, types of `std_msgs`, and outputs below
the node's own name.
"""

import re
from collections import defaultdict
from collections.abc import Iterable, Iterator

from rtron.findings.app_facts import AppFacts
from rtron.findings.rule import FindingRule, make_finding
from rtron.vocabulary import (
    Certainty,
    Endpoint,
    Finding,
    FindingLevel,
    normalise_type,
)
from rtron.wording import conjugate, join_names

_PLAIN = ("std_msgs/", "*")
_MOST_INPUTS = 2
"""A manager of nodelets may hold a driver and its filter; what has more inputs is no filter."""
_SHORT = 2
"""Words of so many letters are in many names."""


def check(app: AppFacts) -> Iterator[Finding]:
    """Yield a finding for each node whose output nobody reads, while others read its input."""
    for node in app.nodes:
        for source, output in _filtered(app, node):
            readers = tuple(each for each in app.readers(source) if each != node)
            if readers and app.publishers(source) and _is_unread(app, node, output):
                yield _finding(app, node, source, output, readers)


def _filtered(app: AppFacts, node: str) -> Iterator[tuple[str, str]]:
    """Yield the inputs and the output of a type that a node has one output of, of similar names."""
    inputs, outputs = app.graph.subscribed_by(node), app.graph.published_by(node)
    for type, sources in _topics_by_type(inputs).items():
        made = _topics_by_type(outputs).get(type, set()) - sources
        if len(made) == 1 and len(sources) <= _MOST_INPUTS and not type.startswith(_PLAIN):
            (output,) = made
            yield from ((each, output) for each in sources if _words(each) & _words(output))


def _topics_by_type(endpoints: Iterable[Endpoint]) -> dict[str, set[str]]:
    found: dict[str, set[str]] = defaultdict(set)
    for end in endpoints:
        if not end.implicit:
            found[normalise_type(end.type)].add(end.topic)
    return found


def _words(topic: str) -> set[str]:
    return {word for word in re.split("[/_]", topic) if len(word) > _SHORT}


def _is_unread(app: AppFacts, node: str, output: str) -> bool:
    is_open = "{" in output or output.startswith(f"{node}/")
    return app.publishers(output) == (node,) and not (app.graph.subscribers(output) or is_open)


def _finding(
    app: AppFacts, node: str, source: str, output: str, readers: tuple[str, ...]
) -> Finding:
    return make_finding(
        RULE.name,
        output,
        summary=f"{join_names(readers)} {conjugate(readers, 'read')} {source} past {node}",
        cause=f"{node} makes {output} of it, which nobody subscribes",
        remedy=f"subscribe {output} instead, or do not start {node}",
        consequence=app.consequence(source, readers),
        certainty=Certainty.POSSIBLE,
        level=FindingLevel.PEDANTIC,
        nodes=(node, *readers),
        topics=(output, source),
        evidence=app.evidence(app.graph.subscribers(source)),
    )


RULE = FindingRule(
    name="bypassed_node",
    title="A node ignores a filtered topic",
    consequence="motion or failure: possible",
    since="0.1.0",
    check=check,
)
