"""A parameter decides by which topic a node moves the robot.

## What it finds

A topic that commands motion, and that a node publishes or subscribes under a name from a parameter.

## Why it matters

Every node can set parameters. Who sets this one before the node starts, or starts again, has it
publish the command elsewhere, or obey another topic, past every guard.

## Remedy

Write the name into the code, and remap it in the launch file. Or guard the topic and check with
`rtron verify --live` that the node uses it.

## Example

`/base` subscribes the topic that its parameter `cmd_topic` names: `/cmd_vel`.
"""

from collections.abc import Iterator

from rtron.findings.app_facts import AppFacts
from rtron.findings.rule import FindingRule, make_finding
from rtron.vocabulary import Certainty, Consequence, Finding, FindingLevel, Resolution
from rtron.wording import join_names


def check(app: AppFacts) -> Iterator[Finding]:
    """Yield a finding for each motion topic whose name a parameter gives."""
    for topic in app.motion_topics:
        endpoints = (*app.graph.publishers(topic), *app.graph.subscribers(topic))
        named = [end for end in endpoints if end.resolution is Resolution.PARAMETER]
        nodes = sorted({end.node for end in named})
        if nodes:
            yield make_finding(
                RULE.name,
                topic,
                summary=f"a parameter decides that {join_names(nodes)} uses {topic}",
                cause="every node can set the parameter; it counts when the node starts",
                remedy="write the name into the code and remap it, or check with `rtron verify`",
                consequence=Consequence.ODDITY,
                certainty=Certainty.POSSIBLE,
                level=FindingLevel.AUDITOR,
                nodes=nodes,
                topics=(topic,),
                evidence=app.evidence(named),
            )


RULE = FindingRule(
    name="settable_topic",
    title="A parameter decides by which topic a node moves the robot",
    consequence="oddity",
    since="0.2.0",
    check=check,
)
