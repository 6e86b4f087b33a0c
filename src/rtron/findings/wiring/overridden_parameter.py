"""A launch file sets a parameter, and a file that it includes later sets it to another value.

## What it finds

In ROS 1 the last value of a parameter counts for the whole launch, also for nodes that start before
it is set. What the outer file says is lost, without a word.

For example, `sim.launch` sets `/use_sim_time` to true and then includes `driver.launch`, which sets
it to false: no node follows the simulated time.

## What to do

Set the parameter behind the inclusion, or let the included file take it as an argument.

## When it is silent

Where a value or a condition around it is not known, and where the outer file sets it last.
"""

from collections.abc import Iterator

from rtron.findings.app_facts import AppFacts
from rtron.findings.rule import FindingRule
from rtron.findings.wiring_groups import WiringGroup, fact_finding, wiring_groups
from rtron.vocabulary import Finding, WiringFactKind
from rtron.wording import join_names


def check(app: AppFacts) -> Iterator[Finding]:
    """Yield a finding for each parameter that an included file sets back."""
    yield from map(_finding, wiring_groups(app.graph, WiringFactKind.OVERRIDDEN_PARAMETER))


def _finding(group: WiringGroup) -> Finding:
    name, value = group.subject, group.values[-1]
    return fact_finding(
        RULE.name,
        group,
        summary=f"{name} is {value}, although the launch sets it to {join_names(group.others)}",
        cause="a file that it includes later sets it, too, and the last value counts for all nodes",
        remedy=f"set {name} behind the inclusion, or give it to the included file as an argument",
    )


RULE = FindingRule(
    name="overridden_parameter",
    title="A launch file sets a parameter, and a file that it includes later sets another value",
    consequence="failure: likely",
    since="0.1.0",
    check=check,
)
