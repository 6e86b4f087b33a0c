"""Some nodes follow simulated time, others do not.

## What it finds

Nodes of ROS 2 whose parameter `use_sim_time` differs from that of most others.

## Why it matters

Their stamps are years apart: transforms are not found, messages count as old, and a watchdog that
compares stamps never fires or always does.

## Remedy

Give all nodes the same value: `SetParameter('use_sim_time', …)` at the top of the launch file.

## Example

Eight nodes have `use_sim_time: true`, `/ekf` has not.
"""

from collections.abc import Iterator

from rtron.findings.app_facts import AppFacts
from rtron.findings.rule import FindingRule, make_finding
from rtron.risks.wording import conjugate, join_names
from rtron.vocabulary import Certainty, Consequence, Finding


def check(app: AppFacts) -> Iterator[Finding]:
    """Yield a finding where use_sim_time is not the same everywhere."""
    values: dict[bool, list[str]] = {True: [], False: []}
    for parameter in app.graph.parameters:
        is_time = parameter.name == "use_sim_time" and parameter.node not in app.facts.viewers
        if is_time and isinstance(parameter.value, bool):
            values[parameter.value].append(parameter.node)
    if not values[True] or not values[False]:
        return
    few, value = min((sorted(nodes), value) for value, nodes in values.items())
    if len(values[not value]) < len(few):
        few, value = sorted(values[not value]), not value
    yield make_finding(
        RULE.name,
        "use_sim_time",
        summary=f"{join_names(few)} {conjugate(few, 'live')} in another time than the other nodes",
        cause=f"use_sim_time is {str(value).lower()} there, {str(not value).lower()} elsewhere",
        remedy="set use_sim_time once for all nodes",
        consequence=Consequence.FAILURE,
        certainty=Certainty.CERTAIN,
        nodes=few,
        evidence=app.evidence(e for node in few for e in app.graph.published_by(node)[:1]),
    )


RULE = FindingRule(
    name="sim_time",
    title="Some nodes follow simulated time, others do not",
    consequence="failure: certain",
    since="0.2.0",
    check=check,
)
