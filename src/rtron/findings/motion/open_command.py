"""Nobody in the app publishes a command that a node obeys.

## What it finds

A node of the app obeys topics that command motion, and no node of the app publishes them. Whoever
reaches the network can drive the robot by them.

For example, `/diff_drive_controller` obeys `/cmd_vel`, and this launch starts neither navigation
nor teleoperation.

## What to do

Scan the launch files that send these commands, too. If nobody should send them, guard the topics
with a GRCN without flows, which lets nobody through.

## When it is silent

Below the level `auditor`; for inputs of an arbiter while another one is in use, and inputs that a
stack such as Nav2 always has.
"""

from collections.abc import Iterator

from rtron.findings.app_facts import AppFacts
from rtron.findings.lost_commands import lost_commands
from rtron.findings.node_kinds import arbiters, is_one_stack
from rtron.findings.rule import FindingRule, make_finding
from rtron.vocabulary import Certainty, Consequence, Finding, FindingLevel
from rtron.wording import conjugate, join_names


def check(app: AppFacts) -> Iterator[Finding]:
    """Yield one finding with all motion topics that a node obeys and nobody publishes."""
    others = _spare_inputs(app).union(lost_commands(app).values())
    topics = [
        topic
        for topic in app.motion_topics
        if app.readers(topic) and not app.publishers(topic) and topic not in others
    ]
    topics = [topic for topic in topics if not is_one_stack(app, app.readers(topic))]
    if not topics:
        return
    readers = sorted({reader for topic in topics for reader in app.readers(topic)})
    endpoints = [end for topic in topics for end in app.graph.subscribers(topic)]
    yield make_finding(
        RULE.name,
        topics[0],
        summary=f"any node on the network can {_effect(app, topics)} {join_names(readers)}",
        cause=f"{join_names(readers)} {conjugate(readers, 'obey')} {join_names(topics)}, "
        f"which no node of this launch publishes{app.unread_publisher_hint(topics)}",
        remedy="scan the launch that sends these commands too, or guard the topics",
        consequence=Consequence.MOTION,
        certainty=Certainty.POSSIBLE,
        level=FindingLevel.AUDITOR,
        nodes=readers,
        topics=topics,
        evidence=app.evidence(endpoints),
    )


def _effect(app: AppFacts, topics: list[str]) -> str:
    return "stop and release" if all(map(app.is_stop, topics)) else "drive"


def _spare_inputs(app: AppFacts) -> set[str]:
    """Return the inputs of the arbiters that have another input in use."""
    inputs = (inputs for inputs, _ in arbiters(app).values())
    return {topic for each in inputs if any(map(app.publishers, each)) for topic in each}


RULE = FindingRule(
    name="open_command",
    title="Nobody in the app publishes a command that a node obeys",
    consequence="motion: possible",
    since="0.1.0",
    check=check,
)
