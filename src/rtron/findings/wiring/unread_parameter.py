"""A launch sets parameters that their node does not declare or read.

## What it finds

A launch, or its YAML file, sets parameters that their node does not declare (ROS 2) or read (ROS
1). ROS ignores them without a warning: a limit that was lowered in the file stays as high as it
was. A section for a name that no node has counts, too, where it is likely meant for a node, and so
does a ROS 2 file without `ros__parameters`. In ROS 1 the last value of a parameter counts for the
whole launch: one that a file within the launch sets back later is lost.

For example, `params.yaml` sets `max_velocity` of `/base`, and `/base` declares `max_vel`.

## What to do

Write the names that the node declares, or remove the parameters. Set a value behind the inclusion.

## When it is silent

Where the source was not read whole, the node has dynamic_reconfigure, or any node uses the
parameter. Without a near name it is `pedantic`, and so is a value that a file within the launch
sets later: a robot's own may be meant to come after the usual ones. It is not if that value is the
default of an argument that the including file does not give.
"""

from collections.abc import Iterator
from pathlib import PurePath

from rtron.findings.app_facts import AppFacts
from rtron.findings.rule import FindingRule
from rtron.findings.wiring_groups import WiringGroup, fact_finding, wiring_groups
from rtron.vocabulary import Certainty, Finding, WiringFactKind
from rtron.wording import conjugate, join_names

_ARGUMENT = "$(arg "
_READS = {1: "read", 2: "declare"}


def check(app: AppFacts) -> Iterator[Finding]:
    """Yield a finding for each node, or name of none, whose parameters a launch sets in vain."""
    reads = _READS[app.graph.ros]
    sections = list(wiring_groups(app.graph, WiringFactKind.SECTION_WITHOUT_NODE))
    yield from map(_without_node, sections)
    malformed = wiring_groups(app.graph, WiringFactKind.MALFORMED_PARAMETER_FILE)
    yield from map(_malformed, malformed)
    overridden = wiring_groups(app.graph, WiringFactKind.OVERRIDDEN_PARAMETER)
    yield from map(_overridden, overridden)
    without_node = {group.subject for group in sections}
    for group in wiring_groups(app.graph, WiringFactKind.MISSPELT_PARAMETER):
        if group.subject not in without_node:
            yield _ignored(group, group.subject, reads)
    for group in wiring_groups(app.graph, WiringFactKind.UNREAD_PARAMETER):
        yield _ignored(group, f"{group.subject}:undeclared", reads)


def _without_node(group: WiringGroup) -> Finding:
    near = join_names(group.others)
    return fact_finding(
        RULE.name,
        group,
        summary=f"the parameters that the launch sets for {group.subject} reach no node",
        cause=f"no node here has this name, and {near} has no parameters of its own there",
        remedy=f"did you mean {near}?",
        nodes=group.others,
    )


def _overridden(group: WiringGroup) -> Finding:
    name, value = group.subject, group.values[-1]
    arguments = [each for each in group.others if each.startswith(_ARGUMENT)]
    earlier = [each for each in group.others if each not in arguments]
    default = f", the default of its {join_names(arguments)}" if arguments else ""
    given = join_names(arguments, "it")
    return fact_finding(
        RULE.name,
        group,
        subject=f"{name}:overridden",
        summary=f"{name} is {value}, although the launch sets it to {join_names(earlier)}",
        cause=f"a file that it includes later sets it, too{default}: the last value counts",
        remedy=f"set {name} behind the inclusion, or give {given} to the included file",
        certainty=Certainty.LIKELY if arguments else Certainty.POSSIBLE,
    )


def _malformed(group: WiringGroup) -> Finding:
    name = "/".join(PurePath(group.subject).parts[-3:])
    return fact_finding(
        RULE.name,
        group,
        subject=name,
        summary=f"the parameters in {name} reach no node",
        cause=f"{join_names(group.others)} {conjugate(group.others, 'get')} the file, which has no "
        "ros__parameters: a node that reads it does not start",
        remedy="put the parameters below the node's name and ros__parameters",
        nodes=group.others,
    )


def _ignored(group: WiringGroup, subject: str, reads: str) -> Finding:
    node, near = group.subject, join_names(group.others, "")
    near_cause = f"it does not {reads} them; it {reads}s {near}"
    return fact_finding(
        RULE.name,
        group,
        subject=subject,
        summary=f"{node} ignores parameters that the launch sets: {join_names(group.values)}",
        cause=near_cause if near else f"the node does not {reads} them",
        remedy=f"did you mean {near}?" if near else f"remove them, or {reads} them in the node",
        certainty=Certainty.LIKELY if near else Certainty.POSSIBLE,
        nodes=(node,),
    )


RULE = FindingRule(
    name="unread_parameter",
    title="A launch sets parameters that their node does not declare or read",
    consequence="failure: likely where the node knows a near name, else possible",
    since="0.1.0",
    check=check,
)
