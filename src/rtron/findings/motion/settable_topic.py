"""A parameter decides by which topic a node moves the robot.

## What it finds

A node publishes or subscribes a topic that commands motion under a name from a parameter. Whoever
sets the parameter before the node starts leads the command past every guard.

For example, `/base` subscribes the topic that its parameter `cmd_topic` names: `/cmd_vel`.

## What to do

Write the name into the code, and remap it in the launch file. Or guard the topic and check it with
`rtron verify --live`.

## When it is silent

Below the level `auditor`, and where the name in the code is fixed.
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
    since="0.1.0",
    check=check,
)
