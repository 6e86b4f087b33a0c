"""The transforms form a loop.

## What it finds

Frames of TF each of which is below the other, directly or through further frames, as nodes
certainly broadcast them. The frames are read as for `double_frame`.

## Why it matters

A frame of a loop has no place in the world. tf2 refuses every transform that passes it, and the
parts of the robot below it are nowhere.

## Remedy

Turn one of the transforms round, or off: REP 105 has `map`, `odom`, `base_link` in this order.

## Example

`/ekf` broadcasts `base_link` below `odom`, and `/driver` broadcasts `odom` below `base_link`.
"""

from collections.abc import Iterator

from rtron.findings.app_facts import AppFacts
from rtron.findings.rule import FindingRule
from rtron.findings.wiring_groups import WiringGroup, fact_finding, wiring_groups
from rtron.vocabulary import Finding, WiringFactKind
from rtron.wording import conjugate, join_names


def check(app: AppFacts) -> Iterator[Finding]:
    """Yield a finding for each loop."""
    yield from map(_finding, wiring_groups(app.graph, WiringFactKind.FRAME_LOOP))


def _finding(group: WiringGroup) -> Finding:
    nodes, frames = group.others, join_names(group.values)
    return fact_finding(
        RULE.name,
        group,
        summary=f"the transforms of {frames} form a loop",
        cause=f"each frame is below the other; {join_names(nodes)} "
        f"{conjugate(nodes, 'broadcast')} them",
        remedy="turn one of the transforms round, or off",
        nodes=nodes,
    )


RULE = FindingRule(
    name="frame_loop",
    title="The transforms form a loop",
    consequence="failure: likely",
    since="0.2.0",
    check=check,
)
