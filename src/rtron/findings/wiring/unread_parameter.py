"""A launch sets parameters that their node does not declare.

## What it finds

ROS 2: the parameters of a launch, or of its YAML files, for a node whose source was read whole and
that declares others. Where the node declares a near name that nobody sets, it is likely meant, and
the finding names it; else it is shown from the level `pedantic` on. What a file sets for all nodes
(`/**`), or the launch file itself, counts where the node declares a near name. A parameter that any
node of the app declares does not count. A section of a parameter file for a name that no node has
counts where a node that is given no parameters has a near name.

## Why it matters

rclcpp and rclpy ignore what a node does not declare, without a warning. The node runs with its
default: a limit that was lowered in the YAML file stays as high as it was.

## Remedy

Write the names that the node declares, or remove the parameters.

## Example

`params.yaml` sets `max_velocity` of `/base`, and `/base` declares `max_vel`.
"""

from collections.abc import Iterator

from rtron.findings.app_facts import AppFacts
from rtron.findings.rule import FindingRule, make_finding
from rtron.risks.wording import join_names
from rtron.vocabulary import (
    Certainty,
    Consequence,
    Finding,
    FindingLevel,
    UnresolvedItem,
)
from rtron.vocabulary.causes import UNKNOWN_NODE, UNREAD_PARAMETER


def check(app: AppFacts) -> Iterator[Finding]:
    """Yield a finding for each node, or name of none, whose parameters a launch sets in vain."""
    for note in app.graph.unresolved:
        if note.why.startswith(UNREAD_PARAMETER):
            yield _undeclared(note)
        elif note.why.startswith(UNKNOWN_NODE):
            yield _without_node(note)


def _without_node(note: UnresolvedItem) -> Finding:
    name = note.what.removeprefix("parameters of ")
    near = note.why.removeprefix(f"{UNKNOWN_NODE}; ").removesuffix(" is near")
    return make_finding(
        RULE.name,
        name,
        summary=f"the parameters that the launch sets for {name} reach no node",
        cause=f"no node of this launch has this name, and {near} has no section",
        remedy=f"did you mean {near}?",
        consequence=Consequence.FAILURE,
        certainty=Certainty.LIKELY,
        nodes=(near,),
        evidence=note.evidence,
    )


def _undeclared(note: UnresolvedItem) -> Finding:
    node, _, names = note.what.removeprefix("set for ").partition(": ")
    near = note.why.removeprefix(UNREAD_PARAMETER).removeprefix("; it declares ")
    ignored, meant = join_names(names.split(", ")), join_names(near.split(", "))
    return make_finding(
        RULE.name,
        node if near else f"{node}:undeclared",
        summary=f"{node} ignores parameters that the launch sets: {ignored}",
        cause=f"it does not declare them; it declares {meant}" if near else note.why,
        remedy=f"did you mean {meant}?" if near else "remove them, or declare them in the node",
        consequence=Consequence.FAILURE,
        certainty=Certainty.LIKELY if near else Certainty.POSSIBLE,
        level=FindingLevel.REGULAR if near else FindingLevel.PEDANTIC,
        nodes=(node,),
        evidence=note.evidence,
    )


RULE = FindingRule(
    name="unread_parameter",
    title="A launch sets parameters that their node does not declare",
    consequence="failure: likely where the node declares a near name, else possible",
    since="0.2.0",
    check=check,
)
