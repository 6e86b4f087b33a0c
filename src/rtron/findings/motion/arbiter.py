"""An arbiter decides between commands.

## What it finds

Multiplexers, smoothers and monitors of velocities, such as twist_mux or Nav2's collision monitor,
with their inputs and outputs. Of a twist_mux of ROS 2 it names priorities and locks. It is no
fault.

For example, `/twist_mux` takes `/joy_vel` (priority 100) and `/nav_vel` (10), and publishes
`/cmd_vel`.

## What to do

Nothing. A node that publishes its output directly passes it by: see `several_publishers`.

## When it is silent

Below the level `auditor`, and for arbiters that RTron does not know by their package.
"""

from collections.abc import Iterator

from rtron.findings.app_facts import AppFacts
from rtron.findings.node_kinds import arbiters, priorities
from rtron.findings.rule import FindingRule, make_finding
from rtron.vocabulary import Certainty, Consequence, Finding, FindingLevel
from rtron.wording import join_names


def check(app: AppFacts) -> Iterator[Finding]:
    """Yield a finding for each arbiter."""
    for node, (inputs, outputs) in arbiters(app).items():
        yield make_finding(
            RULE.name,
            node,
            summary=f"{node} decides who drives on {join_names(outputs)}",
            cause=f"it takes {', '.join(_with_priorities(app, node, inputs))}",
            remedy="nothing to do; check its priorities and locks",
            consequence=Consequence.ODDITY,
            certainty=Certainty.CERTAIN,
            level=FindingLevel.AUDITOR,
            nodes=(node,),
            topics=(*inputs, *outputs),
            evidence=app.evidence(app.graph.published_by(node)),
        )


def _with_priorities(app: AppFacts, node: str, inputs: tuple[str, ...]) -> list[str]:
    """Return the inputs of an arbiter, each with its priority, and its locks (twist_mux)."""
    topics = priorities(app, node)
    locks = sorted(priorities(app, node, "locks").items())
    shown = [_with_priority(topic, topics.get(topic, "")) for topic in inputs]
    return shown + [f"lock {_with_priority(topic, priority)}" for topic, priority in locks]


def _with_priority(topic: str, priority: str) -> str:
    return f"{topic} (priority {priority})" if priority else topic


RULE = FindingRule(
    name="arbiter",
    title="An arbiter decides between commands",
    consequence="oddity",
    since="0.1.0",
    check=check,
)
