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

import re
from collections import defaultdict
from collections.abc import Iterator

from rtron.findings.app_facts import AppFacts
from rtron.findings.rule import FindingRule, make_finding
from rtron.vocabulary import Certainty, Consequence, Finding, FindingLevel, NodeParameterValue
from rtron.vocabulary.remap_rules import expand_name
from rtron.vocabulary.ros_packages import are_one_stack
from rtron.wording import join_names

ARBITER_PACKAGES = frozenset(
    {
        "twist_mux",
        "yocs_cmd_vel_mux",
        "cmd_vel_mux",
        "cras_relative_positional_controller",
        "nav2_collision_monitor",
        "nav2_velocity_smoother",
        "yocs_velocity_smoother",
        "ackermann_mux",
        "joy_teleop_mux",
    }
)
_SOURCE = re.compile(r"(?P<kind>topics|locks)\.(?P<name>[^.]+)\.(?P<key>topic|priority)")
"""The parameters of an input or a lock (ROS package twist_mux)."""
_SAFETY_PACKAGES = ("nav2_collision_monitor",)
"""Arbiters that keep the robot from harm: who passes one by matters in every stack."""
_APPROACHING_PACKAGES = ("opennav_docking", "opennav_following")
"""They drive up to what such an arbiter stops for, and look for collisions themselves."""


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


def priorities(app: AppFacts, node: str, kind: str = "topics") -> dict[str, str]:
    """Return the priorities that a twist_mux gives its inputs, or its `locks`, by topic."""
    sources: dict[str, dict[str, NodeParameterValue | None]] = defaultdict(dict)
    for each in app.graph.parameters:
        match = _SOURCE.fullmatch(each.name) if each.node == node else None
        if match and match["kind"] == kind:
            sources[match["name"]][match["key"]] = each.value
    return {
        expand_name(str(source.get("topic")), node): _written(source.get("priority"))
        for source in sources.values()
    }


def _written(value: NodeParameterValue | None) -> str:
    return "" if value is None else str(value)


def _with_priority(topic: str, priority: str) -> str:
    return f"{topic} (priority {priority})" if priority else topic


def arbiters(app: AppFacts) -> dict[str, tuple[tuple[str, ...], tuple[str, ...]]]:
    """Return the arbiters of an app, each with its inputs and its outputs of motion commands."""
    found = {}
    for node in app.graph.nodes:
        if node.package in ARBITER_PACKAGES:
            inputs = _motion(app, [e.topic for e in app.graph.subscribed_by(node.name)])
            outputs = _motion(app, [e.topic for e in app.graph.published_by(node.name)])
            if inputs and outputs:
                found[node.name] = (inputs, outputs)
    return found


def is_one_stack(app: AppFacts, nodes: tuple[str, ...]) -> bool:
    """Return whether nodes belong to one stack, which lets one of them drive at a time."""
    packages = [app.nodes[node].package if node in app.nodes else "" for node in nodes]
    bound = [each for each in packages if each not in _APPROACHING_PACKAGES]
    is_passed_by = len(bound) > 1 and not set(bound).isdisjoint(_SAFETY_PACKAGES)
    return are_one_stack(packages) and not is_passed_by


def _motion(app: AppFacts, topics: list[str]) -> tuple[str, ...]:
    return tuple(sorted({topic for topic in topics if app.is_motion(topic)}))


RULE = FindingRule(
    name="arbiter",
    title="An arbiter decides between commands",
    consequence="oddity",
    since="0.1.0",
    check=check,
)
