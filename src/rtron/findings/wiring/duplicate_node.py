"""Two nodes have one name.

## What it finds

A node name that the launch files start at several places, or several times. The nodes of the tool
`ros2` do not count.

## Why it matters

In ROS 1 the node that starts last ends the others, so one of the two programs is missing. In ROS 2
both run, and services, parameters and tools reach one of them, nobody knows which.

## Remedy

Give the nodes different names or namespaces, or start the node in one launch file only.

## Example

Bringup and navigation both start `/robot_state_publisher`.
"""

from collections import defaultdict
from collections.abc import Iterator

from rtron.findings.app_facts import AppFacts
from rtron.findings.rule import FindingRule, make_finding
from rtron.vocabulary import Certainty, Consequence, Finding, UnresolvedItem

_STARTED = "started "
_TOOL = "_ros2cli"
"""How the nodes of `ros2` are named, which nobody addresses."""


def check(app: AppFacts) -> Iterator[Finding]:
    """Yield a finding for each name that several nodes have."""
    notes: dict[str, list[UnresolvedItem]] = defaultdict(list)
    for note in app.graph.unresolved:
        node = note.what.removeprefix("node ")
        is_double = note.what != node and note.why.startswith(_STARTED)
        if is_double and not node.rpartition("/")[2].startswith(_TOOL):
            notes[node].append(note)
    for node, of_node in notes.items():
        yield _finding(node, of_node)


def _finding(node: str, notes: list[UnresolvedItem]) -> Finding:
    return make_finding(
        RULE.name,
        node,
        summary=f"{node} starts more than once",
        cause=notes[0].why,
        remedy="start it in one launch file only, or give each its own name",
        consequence=Consequence.FAILURE,
        certainty=Certainty.LIKELY,
        nodes=(node,),
        evidence=dict.fromkeys(place for note in notes for place in note.evidence),
    )


RULE = FindingRule(
    name="duplicate_node",
    title="Two nodes have one name",
    consequence="failure: likely",
    since="0.2.0",
    check=check,
)
