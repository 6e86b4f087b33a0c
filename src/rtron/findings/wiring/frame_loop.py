"""The transforms form a loop.

## What it finds

Each of two or more frames of TF is below the other. tf2 refuses every transform that passes the
loop.

For example, `/ekf` broadcasts `base_link` below `odom`, and `/driver` broadcasts `odom` below
`base_link`.

## What to do

Turn one of the transforms round, or off: the order of REP 105 is `map`, `odom`, `base_link`.

## When it is silent

Where it is not certain that the nodes broadcast these frames.
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
    since="0.1.0",
    check=check,
)
