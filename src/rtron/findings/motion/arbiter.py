"""An arbiter decides between commands.

## What it finds

Multiplexers, smoothers and monitors of velocities (twist_mux, yocs_cmd_vel_mux, Nav2's collision
monitor and velocity smoother), with their inputs and outputs. It is no fault: it is for auditors.

## Why it matters

What goes through it obeys its priorities and locks. What publishes its output directly passes it
by: see `several_publishers`.

## Remedy

None is needed.

## Example

`/twist_mux` takes `/joy_vel` and `/nav_vel`, and publishes `/cmd_vel`.
"""

from collections.abc import Iterator

from rtron.findings.app_facts import AppFacts
from rtron.findings.motion.arbiters import arbiters
from rtron.findings.rule import FindingRule, make_finding
from rtron.risks.wording import join_names
from rtron.vocabulary import Certainty, Consequence, Finding, FindingLevel


def check(app: AppFacts) -> Iterator[Finding]:
    """Yield a finding for each arbiter."""
    for node, (inputs, outputs) in arbiters(app).items():
        yield make_finding(
            RULE.name,
            node,
            summary=f"{node} decides who drives on {join_names(outputs)}",
            cause=f"it takes {join_names(inputs)}",
            remedy="nothing to do; check its priorities and locks",
            consequence=Consequence.ODDITY,
            certainty=Certainty.CERTAIN,
            level=FindingLevel.AUDITOR,
            nodes=(node,),
            topics=(*inputs, *outputs),
            evidence=app.evidence(app.graph.published_by(node)),
        )


RULE = FindingRule(
    name="arbiter",
    title="An arbiter decides between commands",
    consequence="oddity",
    since="0.2.0",
    check=check,
)
