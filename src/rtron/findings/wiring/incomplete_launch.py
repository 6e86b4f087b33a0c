"""Nodes need what this launch does not start.

## What it finds

Topics that nobody publishes, and services and actions that nobody offers, without a near name in
the app. Of nodes that are not your own only measurements count: a sensor, odometry, a map. If no
other launch starts the rest, these nodes wait for ever.

For example, a launch starts `/slam`, which subscribes `/scan`, and no driver of a laser.

## What to do

Scan the launch that starts the rest, too, or start it here.

## When it is silent

Below the level `pedantic`. Commands of motion belong to `open_command`.
"""

from collections.abc import Iterator

from rtron.findings.app_facts import AppFacts
from rtron.findings.rule import FindingRule, make_finding
from rtron.findings.wiring.no_server import unserved_names
from rtron.findings.wiring.unmatched_topic import is_option, unmatched_topics
from rtron.vocabulary import Certainty, Consequence, Finding
from rtron.wording import conjugate, join_names


def check(app: AppFacts) -> Iterator[Finding]:
    """Yield one finding with all that nodes need and nobody of the launch publishes or offers."""
    topics = [topic for topic, near in unmatched_topics(app).items() if not near]
    needed = [topic for topic in topics if not (is_option(app, topic) or app.is_motion(topic))]
    unserved = unserved_names(app).items()
    called = {name: each.nodes for name, each in unserved if not (each.near or each.owner)}
    if needed or called:
        yield _finding(app, needed, called)


def _finding(app: AppFacts, topics: list[str], called: dict[str, list[str]]) -> Finding:
    names = [*topics, *called]
    inputs = [end for topic in topics for end in app.graph.subscribers(topic)]
    callers = sorted({node for nodes in called.values() for node in nodes})
    nodes = sorted({*callers, *(node for topic in topics for node in app.readers(topic))})
    lacks = {"publishes": topics, "offers": list(called)}
    cause = " or ".join(f"{verb} {join_names(each)}" for verb, each in lacks.items() if each)
    return make_finding(
        RULE.name,
        names[0],
        summary=f"{join_names(nodes)} {conjugate(nodes, 'need')} what this launch does not start",
        cause=f"no node of this launch {cause}{app.unread_publisher_hint(topics)}",
        remedy="scan the launch that starts the rest, too, or start it here",
        consequence=Consequence.FAILURE,
        certainty=Certainty.POSSIBLE,
        nodes=nodes,
        topics=names,
        evidence=(*app.evidence(inputs), *app.node_evidence(callers)),
    )


RULE = FindingRule(
    name="incomplete_launch",
    title="Nodes need what this launch does not start",
    consequence="failure: possible",
    since="0.1.0",
    check=check,
)
