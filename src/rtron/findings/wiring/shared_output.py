"""Two nodes publish a topic that should have one source.

## What it finds

Two nodes publish one clock, or one map: time jumps, and the robot plans now with the one map, now
with the other. Or a node publishes joint states beside `joint_state_publisher`, which sends a value
of its own, mostly zero, for each joint. Or two nodes, nodelets or components of one program publish
one topic, while their other topics differ: the launch forgot to give it a name of its own.

For example, `/slam_toolbox` and `/map_server` both publish `/map`; or the nodelets `left_camera`
and `right_camera` both publish `/image`.

## What to do

Start one of them, or remap the topic for each.

## When it is silent

Where a condition that is not known may exclude one; for diagnostics, transforms, bonds and logs,
and for joint states without a `joint_state_publisher`. Commands of motion belong to
`several_publishers`. Instances of one program are `pedantic`.
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
    """Yield a finding for each topic with a second source, or shared by instances of a program."""
    yield from map(_second_source, wiring_groups(app.graph, WiringFactKind.SECOND_SOURCE))
    for group in wiring_groups(app.graph, WiringFactKind.SHARED_OUTPUT):
        is_of_all = group.subject.rpartition("/")[2] in _OF_ALL
        if not (is_of_all or app.is_motion(group.subject)):
            yield _finding(group)


def _second_source(group: WiringGroup) -> Finding:
    topic, nodes = group.subject, group.others
    return fact_finding(
        RULE.name,
        group,
        summary=f"{join_names(nodes)} {both_or_all(nodes)} publish {topic}",
        cause="each publishes its own, and readers take whichever came last",
        remedy="start one of them, or remap the other's topic",
        nodes=nodes,
        topics=(topic,),
    )


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
    title="Two nodes publish a topic that should have one source",
    consequence="failure: likely for a clock, a map or joints, else possible",
    since="0.1.0",
    check=check,
)
