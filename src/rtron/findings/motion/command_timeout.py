"""A base keeps its last command for ever.

## What it finds

A node whose parameter for the timeout of its commands (`cmd_vel_timeout` and its kin) is 0 or less,
which turns the timeout off. The parameters are those of the launch; a running app tells its own.

## Why it matters

When the node that drives dies, or its link breaks, the robot goes on with the last velocity.

## Remedy

Set the timeout to half a second or less.

## Example

`/diff_drive_controller` has `cmd_vel_timeout: 0.0`.
"""

from collections import defaultdict
from collections.abc import Iterator

from rtron.findings.app_facts import AppFacts
from rtron.findings.rule import FindingRule, make_finding
from rtron.risks.wording import join_names
from rtron.vocabulary import Certainty, Consequence, Finding, NodeParameter

_NAMES = ("cmd_vel_timeout", "cmd_timeout", "command_timeout", "reference_timeout", "timeout_cmd")


def check(app: AppFacts) -> Iterator[Finding]:
    """Yield a finding for each node with parameters that turn a timeout of commands off."""
    off: dict[str, list[NodeParameter]] = defaultdict(list)
    for parameter in app.graph.parameters:
        is_timeout = parameter.name.rpartition(".")[2] in _NAMES
        if is_timeout and _is_off(parameter.value):
            off[parameter.node].append(parameter)
    for node, parameters in off.items():
        yield _finding(app, node, sorted(parameters, key=lambda each: each.name))


def _is_off(value: object) -> bool:
    return isinstance(value, (int, float)) and not isinstance(value, bool) and value <= 0


def _finding(app: AppFacts, node: str, parameters: list[NodeParameter]) -> Finding:
    values = join_names([f"{parameter.name} is {parameter.value}" for parameter in parameters])
    return make_finding(
        RULE.name,
        node,
        summary=f"{node} keeps its last command for ever when its sender dies",
        cause=f"its parameter {values}: no timeout",
        remedy=f"set {join_names([parameter.name for parameter in parameters])} to 0.5 or less",
        consequence=Consequence.MOTION,
        certainty=Certainty.CERTAIN,
        nodes=(node,),
        evidence=app.evidence(app.graph.subscribed_by(node)),
    )


RULE = FindingRule(
    name="command_timeout",
    title="A base keeps its last command for ever",
    consequence="motion: certain",
    since="0.2.0",
    check=check,
)
