"""Two nodes have one name.

## What it finds

The launch files start one node name several times. In ROS 1 the last one ends the others. In ROS 2
both run, and services, parameters and tools reach one of them.

For example, bringup and navigation both start `/robot_state_publisher`.

## What to do

Give the nodes different names or namespaces, or start the node in one launch file only.

## When it is silent

For nodes of the tool `ros2`. Viewers such as RViz are `pedantic`.
"""

from collections.abc import Iterator

from rtron.findings.app_facts import AppFacts
from rtron.findings.rule import FindingRule, make_finding
from rtron.findings.wiring_groups import WiringGroup, wiring_groups
from rtron.vocabulary import Certainty, Consequence, Finding, FindingLevel, WiringFactKind
from rtron.wording import both_or_all, join_names

_TOOL = "_ros2cli"
"""How the nodes of `ros2` are named, which nobody addresses."""
_CAUSES = {
    1: "started at several places; the last that starts ends the others",
    2: "started several times; they all run, and nothing tells them apart",
}


def check(app: AppFacts) -> Iterator[Finding]:
    """Yield a finding for each name that several nodes have."""
    for group in wiring_groups(app.graph, WiringFactKind.DUPLICATE_NODE):
        if not group.subject.rpartition("/")[2].startswith(_TOOL):
            is_viewer = group.subject in app.facts.viewers
            yield _finding(group, app.graph.ros, is_viewer=is_viewer)


def _finding(group: WiringGroup, ros: int, *, is_viewer: bool) -> Finding:
    summary, programs = f"{group.subject} starts more than once", group.others
    remedy = "start it in one launch file only, or give each its own name"
    if programs[1:]:
        summary = f"{join_names(programs)} {both_or_all(programs)} have the name {group.subject}"
        remedy = "give each a name of its own"
    return make_finding(
        RULE.name,
        group.subject,
        summary=summary,
        cause=_CAUSES[ros],
        remedy=remedy,
        consequence=Consequence.FAILURE,
        certainty=Certainty.LIKELY,
        level=FindingLevel.PEDANTIC if is_viewer else None,
        nodes=(group.subject,),
        evidence=group.evidence,
    )


RULE = FindingRule(
    name="duplicate_node",
    title="Two nodes have one name",
    consequence="failure: likely",
    since="0.1.0",
    check=check,
)
