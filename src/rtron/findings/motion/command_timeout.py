"""What moves keeps its last command for ever.

## What it finds

The robot goes on with the last command when the node that drives dies or its link breaks, as the
inventory says where it tells that something does not stop, because

- a parameter for the timeout of commands (`cmd_vel_timeout` and the like) is 0 or less;
- a node that obeys commands opens hardware, and nothing in its source checks the age of a command;
- a node repeats the last command that it received, in a timer or a loop, without checking its age;
- or the driver's documentation says so.

For example, `/diff_drive_controller` has `cmd_vel_timeout: 0.0`.

## What to do

Set the timeout to half a second or less. In a driver of your own, send zero when no command came
for so long.

## When it is silent

For autopilots, vendors' bases and the motor controllers moteus, VESC and Roboteq, which mostly stop
by themselves; where another node hears the commands and may stop the driver; and for what is told
where to go, not how fast: it ends there. Whether the hardware stops, no scan sees.
"""

from collections import defaultdict
from collections.abc import Iterator

from rtron.findings.app_facts import AppFacts
from rtron.findings.inventory import take_inventory
from rtron.findings.inventory.stopping import TIMEOUT_NAMES, is_off
from rtron.findings.rule import FindingRule, make_finding
from rtron.vocabulary import Certainty, Consequence, Finding, NodeParameter
from rtron.vocabulary.inventory import Mover, Stops
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
    held: dict[str, list[Mover]] = defaultdict(list)
    for mover in take_inventory(app):
        if mover.stops is Stops.NO and mover.holder not in off:
            held[mover.holder].append(mover)
    for node, movers in held.items():
        yield _holding(app, node, movers)


def _holding(app: AppFacts, node: str, movers: list[Mover]) -> Finding:
    commands = {command.name for each in movers for command in each.commands}
    inputs = [end for end in app.graph.subscribed_by(node) if end.topic in commands]
    return make_finding(
        RULE.name,
        node,
        summary=f"{node} keeps its last command when its sender dies, unless its hardware stops",
        cause=join_names([*dict.fromkeys(each.stop for each in movers)]),
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
