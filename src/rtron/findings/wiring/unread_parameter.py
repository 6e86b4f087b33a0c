"""A launch sets a parameter that its node does not declare.

## What it finds

ROS 2: a parameter of a launch or of its YAML files, for a node whose source was read whole, that
declares parameters and not this one. Where the node declares a near name that nobody sets, it is
likely meant, and the finding names it; else it is shown from the level `pedantic` on.

## Why it matters

rclcpp and rclpy ignore what a node does not declare. The node runs with its default, and nobody is
told: a limit that was lowered in the YAML file stays as high as it was.

## Remedy

Write the name that the node declares, or remove the parameter.

## Example

`params.yaml` sets `max_velocity` of `/base`, and `/base` declares `max_vel`.
"""

from collections.abc import Iterator

from rtron.findings.app_facts import AppFacts
from rtron.findings.rule import FindingRule, make_finding
from rtron.vocabulary import (
    UNREAD_PARAMETER,
    Certainty,
    Consequence,
    Finding,
    FindingLevel,
    UnresolvedItem,
)


def check(app: AppFacts) -> Iterator[Finding]:
    """Yield a finding for each parameter that a launch sets in vain."""
    for note in app.graph.unresolved:
        if note.why.startswith(UNREAD_PARAMETER):
            yield _finding(note)


def _finding(note: UnresolvedItem) -> Finding:
    name, _, node = note.what.removeprefix("parameter ").partition(" of ")
    _, _, near = note.why.partition("declares ")
    return make_finding(
        RULE.name,
        f"{node}:{name}",
        summary=f"{node} ignores the parameter {name}, which the launch sets",
        cause=f"its source does not declare it{f', and declares {near}' if near else ''}",
        remedy=f"did you mean {near}?" if near else "remove it, or declare it in the node",
        consequence=Consequence.FAILURE,
        certainty=Certainty.LIKELY if near else Certainty.POSSIBLE,
        level=FindingLevel.REGULAR if near else FindingLevel.PEDANTIC,
        nodes=(node,),
        evidence=note.evidence,
    )


RULE = FindingRule(
    name="unread_parameter",
    title="A launch sets a parameter that its node does not declare",
    consequence="failure: likely where the node declares a near name, else possible",
    since="0.2.0",
    check=check,
)
