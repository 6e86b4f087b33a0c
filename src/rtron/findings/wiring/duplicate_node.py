"""Two nodes have one name.

## What it finds

A node name that the launch files start at several places, or several times.

## Why it matters

In ROS 1 the node that starts last ends the others, so one of the two programs is missing. In ROS 2
both run, and services, parameters and tools reach one of them, nobody knows which.

## Remedy

Give the nodes different names or namespaces, or start the node in one launch file only.

## Example

Bringup and navigation both start `/robot_state_publisher`.
"""

from collections.abc import Iterator

from rtron.findings.app_facts import AppFacts
from rtron.findings.rule import FindingRule, make_finding
from rtron.vocabulary import Certainty, Consequence, Finding

_STARTED = "started "


def check(app: AppFacts) -> Iterator[Finding]:
    """Yield a finding for each name that several nodes have."""
    for note in app.graph.unresolved:
        if note.what.startswith("node ") and note.why.startswith(_STARTED):
            node = note.what.removeprefix("node ")
            yield make_finding(
                RULE.name,
                node,
                summary=f"{node} starts more than once",
                cause=note.why,
                remedy="start it in one launch file only, or give each its own name",
                consequence=Consequence.FAILURE,
                certainty=Certainty.LIKELY,
                nodes=(node,),
                evidence=note.evidence,
            )


RULE = FindingRule(
    name="duplicate_node",
    title="Two nodes have one name",
    consequence="failure: likely",
    since="0.2.0",
    check=check,
)
