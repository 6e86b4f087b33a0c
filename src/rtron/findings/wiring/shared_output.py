"""Two instances of one program publish one topic.

## What it finds

Two nodes, nodelets or components of one program publish one topic, while their other topics differ:
the launch forgot to give it a name of its own.

For example, the nodelets `left_camera` and `right_camera` both publish `/image`.

## What to do

Remap the topic for each instance.

## When it is silent

Below the level `pedantic`; for diagnostics, transforms, joint states, bonds and logs. Commands of
motion belong to `several_publishers`.
"""

from collections.abc import Iterator

from rtron.findings.app_facts import AppFacts
from rtron.findings.rule import FindingRule
from rtron.findings.wiring_groups import WiringGroup, fact_finding, wiring_groups
from rtron.vocabulary import Certainty, Finding, WiringFactKind
from rtron.wording import both_or_all, join_names

_OF_ALL = frozenset({"tf", "tf_static", "diagnostics", "joint_states", "rosout", "bond"})
"""Last names of topics that many nodes publish for all (REP 105, REP 107, bond)."""


def check(app: AppFacts) -> Iterator[Finding]:
    """Yield a finding for each topic that instances of one program share."""
    for group in wiring_groups(app.graph, WiringFactKind.SHARED_OUTPUT):
        is_of_all = group.subject.rpartition("/")[2] in _OF_ALL
        if not (is_of_all or app.is_motion(group.subject)):
            yield _finding(group)


def _finding(group: WiringGroup) -> Finding:
    topic, instances = group.subject, group.others
    return fact_finding(
        RULE.name,
        group,
        summary=f"{join_names(instances)} {both_or_all(instances)} publish {topic}",
        cause="they are instances of one program, and their other topics differ",
        remedy=f"remap {topic} for each of them",
        certainty=Certainty.POSSIBLE,
        nodes=instances,
        topics=(topic,),
    )


RULE = FindingRule(
    name="shared_output",
    title="Two instances of one program publish one topic",
    consequence="failure: possible",
    since="0.1.0",
    check=check,
)
