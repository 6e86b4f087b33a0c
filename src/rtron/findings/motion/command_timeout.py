"""What moves keeps its last command for ever.

## What it finds

The robot goes on with its last command when the node that commands it dies or its link breaks. It
does where

- a parameter for the timeout of commands (`cmd_vel_timeout` and the like) is 0 or less;
- a node that obeys commands opens hardware, and nothing in its source checks the age of a command;
- or a node repeats the last command that it received, in a timer or a loop, without checking its
  age.

For example, `/diff_drive_controller` has `cmd_vel_timeout: 0.0`.

## What to do

Set the timeout to half a second or less. In a driver of your own, send zero when no command came
for so long.

## When it is silent

For autopilots, vendors' bases and the motor controllers moteus, VESC and Roboteq, which mostly stop
by themselves; for simulators; where another node hears the commands and may stop the driver; for
arms, tools, switches and whatever else is told where to go and not how fast. Whether the hardware
stops, no scan sees.
"""

from collections import defaultdict
from collections.abc import Iterator

from rtron.findings.app_facts import AppFacts
from rtron.findings.inventory import take_inventory
from rtron.findings.inventory.stopping import TIMEOUT_NAMES, is_off
from rtron.findings.rule import FindingRule, make_finding
from rtron.vocabulary import Certainty, Consequence, Finding, NodeParameter
from rtron.vocabulary.inventory import Mover
from rtron.wording import join_names


def check(app: AppFacts) -> Iterator[Finding]:
    """Yield a finding for each node that keeps the last command: by a parameter, or its source."""
    off: dict[str, list[NodeParameter]] = defaultdict(list)
    for parameter in app.graph.parameters:
        is_timeout = parameter.name.rpartition(".")[2] in TIMEOUT_NAMES
        if is_timeout and is_off(parameter.value):
            off[parameter.node].append(parameter)
    for node, parameters in off.items():
        yield _finding(app, node, sorted(parameters, key=lambda each: each.name))
    held: dict[str, list[tuple[str, Mover]]] = defaultdict(list)
    for mover in take_inventory(app):
        for node, why in mover.holders:
            if node not in off:
                held[node].append((why, mover))
    for node, reasons in held.items():
        yield _holding(app, node, reasons)


def _holding(app: AppFacts, node: str, reasons: list[tuple[str, Mover]]) -> Finding:
    movers = [mover for _, mover in reasons]
    commands = {command.name for each in movers for command in each.commands}
    inputs = [end for end in app.graph.subscribed_by(node) if end.topic in commands]
    return make_finding(
        RULE.name,
        node,
        summary=f"{node} keeps its last command when its sender dies, unless its hardware stops",
        cause=join_names([*dict.fromkeys(why for why, _ in reasons)]),
        remedy=f"in {node}, or before it, send zero when no command came for 0.5 s; see what the "
        "hardware does by itself",
        consequence=Consequence.MOTION,
        certainty=Certainty.LIKELY,
        nodes=(node,),
        topics=[end.topic for end in inputs],
        evidence=(*app.evidence(inputs), *(place for each in movers for place in each.evidence)),
    )


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
    title="What moves keeps its last command for ever",
    consequence="motion: certain by a parameter, likely from source",
    since="0.1.0",
    check=check,
)
