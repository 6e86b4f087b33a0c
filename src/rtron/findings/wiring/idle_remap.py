"""A remap changes nothing.

## What it finds

A remap whose old name no node that gets it uses, while other nodes of the app use that name,
or a name below it. A remap in a group is idle only if no node of the group has a use for it.

## Why it matters

The remap was meant for somebody. Remaps compare whole names: one of `camera/left` does not change
`camera/left/image_raw`, and one that stands behind a node does not reach it.

## Remedy

Write the name that the node uses, or move the remap before the node.

## Example

`<remap from="camera/left" to="left_camera"/>`, and the camera publishes `/camera/left/image_raw`.
"""

from collections.abc import Iterator

from rtron.findings.app_facts import AppFacts
from rtron.findings.rule import FindingRule, make_finding
from rtron.findings.wiring_groups import WiringGroup, wiring_groups
from rtron.vocabulary import (
    Certainty,
    Consequence,
    Finding,
    FindingLevel,
    WiringFactKind,
)
from rtron.wording import conjugate, join_names

_OF_ALL = ("/tf", "/tf_static")
"""Launch files often remap them for every node, be it one that uses them or not."""
_MOST_USERS = 3


def check(app: AppFacts) -> Iterator[Finding]:
    """Yield a finding for each remap without effect."""
    for group in wiring_groups(app.graph, WiringFactKind.IDLE_REMAP):
        if group.subject not in _OF_ALL:
            yield _finding(group)


def _finding(group: WiringGroup) -> Finding:
    users = group.others[:_MOST_USERS]
    return make_finding(
        RULE.name,
        group.subject,
        summary=f"the remap of {group.subject} to {join_names(group.values)} changes nothing",
        cause="no node that gets it uses the name; "
        f"{join_names(users)} {conjugate(users, 'use')} it or one below it",
        remedy="write the whole name that the node uses, or remove the remap",
        consequence=Consequence.FAILURE,
        certainty=Certainty.POSSIBLE,
        level=FindingLevel.PEDANTIC,
        topics=(group.subject, *group.values),
        evidence=group.evidence,
    )


RULE = FindingRule(
    name="idle_remap",
    title="A remap changes nothing",
    consequence="failure: possible",
    since="0.2.0",
    check=check,
)
