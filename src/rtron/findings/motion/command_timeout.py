"""A base keeps its last command for ever.

## What it finds

The robot goes on with the last velocity when the node that drives dies or its link breaks, because

- a parameter for the timeout of commands (`cmd_vel_timeout` and the like) is 0 or less;
- a node that obeys velocities opens hardware, and nothing in its source checks the age of a
  command;
- or a node repeats the last velocity that it received, in a timer or a loop, without checking its
  age.

For example, `/diff_drive_controller` has `cmd_vel_timeout: 0.0`.

## What to do

Set the timeout to half a second or less. In a driver of your own, send zero when no command came
for so long.

## When it is silent

For autopilots and vendors' bases, which mostly stop by themselves. Whether the hardware stops, no
scan sees.
"""

import re
from collections import defaultdict
from collections.abc import Iterable, Iterator
from math import inf

from rtron.findings.app_facts import AppFacts
from rtron.findings.inventory.things import thing_of
from rtron.findings.measurement_names import is_measured, may_be_measured
from rtron.findings.rule import FindingRule, make_finding
from rtron.vocabulary import (
    Certainty,
    Consequence,
    Endpoint,
    Finding,
    LastMessageFate,
    NodeParameter,
    WiringFact,
    WiringFactKind,
    normalise_type,
)
from rtron.vocabulary.inventory import SIGNALS, Means, Thing
from rtron.wording import conjugate, join_names

TIMEOUT_NAMES = (
    "cmd_vel_timeout",
    "cmd_timeout",
    "command_timeout",
    "reference_timeout",
    "timeout_cmd",
)
"""Parameters that say how long a command counts."""
CLEVER_DEVICES = {
    "moteus": ", by default after 0.1 s",
    "VESC": ", by default after 1 s",
    "Roboteq": ", by default after 1 s",
    **dict.fromkeys(("vehicle link", "vendor SDK", "TCP link"), ""),
}
"""Devices that mostly stop by themselves, and when: an autopilot, a base with its own controller.

Documented are servo.default_timeout_s (mjbots' reference of moteus), APPCONF_TIMEOUT_MSEC (VESC's
firmware) and RWD (Roboteq's user manual).
"""
STREAMS = re.compile(
    r"geometry_msgs/Twist|ackermann_msgs/|sensor_msgs/Joy|/\w*(?:Cmd|Command|Channels|Drive|Motor|Joy)"
)
"""Types of commands that come again and again, by their names."""
UNCHECKED = frozenset({LastMessageFate.UNNOTICED, LastMessageFate.REPEATED})
"""What becomes of a last message where nothing looks at its age."""
_DRIVEN = frozenset({Thing.BASE, Thing.VEHICLE, Thing.THRUSTERS})
_SOURCE = (WiringFactKind.DEVICE, WiringFactKind.COMMAND_AGE, WiringFactKind.LAST_MESSAGE)
_VELOCITIES = ("geometry_msgs/Twist", "ackermann_msgs/")


def check(app: AppFacts) -> Iterator[Finding]:
    """Yield a finding for each node with parameters that turn a timeout of commands off."""
    off: dict[str, list[NodeParameter]] = defaultdict(list)
    for parameter in app.graph.parameters:
        is_timeout = parameter.name.rpartition(".")[2] in TIMEOUT_NAMES
        if is_timeout and is_off(parameter.value):
            off[parameter.node].append(parameter)
    for node, parameters in off.items():
        yield _finding(app, node, sorted(parameters, key=lambda each: each.name))
    for node, device in _ageless_drivers(app):
        if node not in off:
            yield _ageless(app, node, device)
    for node, repeated in _repeaters(app):
        yield _repeating(app, node, repeated)


def _ageless_drivers(app: AppFacts) -> Iterator[tuple[str, WiringFact]]:
    """Yield the nodes that obey velocities by a device, and whose source knows no age of them."""
    kinds = (WiringFactKind.DEVICE, WiringFactKind.COMMAND_AGE)
    devices, aged = ({f.subject: f for f in app.graph.wiring if f.kind is kind} for kind in kinds)
    for node in sorted(devices.keys() - aged.keys()):
        velocities = {end.topic for end in app.graph.subscribed_by(node) if _is_velocity(end)}
        last = set(app.last_messages(node, velocities))
        if last and last <= UNCHECKED and not other_stop(app, node, velocities):
            yield node, devices[node]


def other_stop(app: AppFacts, node: str, topics: Iterable[str]) -> str:
    """Return what may stop a driver in whose source nothing looks at the age of its commands.

    Another node that hears them, looks at their age, and sends such itself; or its device.
    """
    watchers = {
        other
        for topic in topics
        for other in app.publishers(topic)
        if other != node and not UNCHECKED.issuperset(app.last_messages(other, {topic}))
    }
    if watchers:
        return f"{node} does not by itself; {min(watchers)} may stop it"
    opened = {fact.value for fact in app.graph.wiring if fact.subject == node}
    clever = next((each for each in CLEVER_DEVICES if each in opened), "")
    may = f"its device may{CLEVER_DEVICES[clever]}" if clever else ""
    return may and f"{node} looks at no age of commands; {may}"


def _repeaters(app: AppFacts) -> Iterator[tuple[str, dict[str, set[str]]]]:
    """Yield the nodes that drive by what they heard last: what they send again, by its input."""
    facts = {kind: {f.subject for f in app.graph.wiring if f.kind is kind} for kind in _SOURCE}
    known = facts[WiringFactKind.DEVICE] | facts[WiringFactKind.COMMAND_AGE]
    for node in sorted(facts[WiringFactKind.LAST_MESSAGE] - known):
        explicit = [end for end in app.graph.subscribed_by(node) if not end.implicit]
        inputs = [end for end in explicit if normalise_type(end.type) not in SIGNALS]
        velocities = {end.topic for end in inputs if _is_velocity(end)}
        streams = {end.topic for end in inputs if STREAMS.search(normalise_type(end.type))}
        commands = velocities or (streams if len(inputs) == 1 else set())
        driven = set(_driving(app, node))
        sent = {topic: driven & repeated_topics(app, node, topic) for topic in sorted(commands)}
        repeated = {topic: outputs for topic, outputs in sent.items() if outputs}
        if repeated and set(app.last_messages(node, commands)) == {LastMessageFate.REPEATED}:
            yield node, repeated


def repeated_topics(app: AppFacts, node: str, topic: str) -> set[str]:
    """Return where a node sends what it kept of a topic again and again.

    If its source does not tell the publisher, that is known of a node with one topic alone.
    """
    fact = app.last_messages(node, {topic}).get(LastMessageFate.REPEATED)
    if fact is None:
        return set()
    published = [end for end in app.graph.published_by(node) if not end.implicit]
    if places := set(fact.evidence[1:]):
        return {end.topic for end in published if places.intersection(end.evidence)}
    topics = {end.topic for end in published}
    return topics if len(topics) == 1 else set()


def _driving(app: AppFacts, node: str) -> Iterator[str]:
    """Yield what a node publishes that drives a base, and that somebody obeys or may obey."""
    for end in app.graph.published_by(node):
        is_command = thing_of(end.topic, end.type, Means.TOPIC) in _DRIVEN
        is_measurement = is_measured(end.topic) or may_be_measured(end.topic)
        if is_command and not is_measurement and (app.readers(end.topic) or app.unread_nodes):
            yield end.topic


def _is_velocity(end: Endpoint) -> bool:
    """Return whether a topic carries a velocity that is commanded, not measured."""
    return normalise_type(end.type).startswith(_VELOCITIES) and not is_measured(end.topic)


def _ageless(app: AppFacts, node: str, device: WiringFact) -> Finding:
    obeyed = [end for end in app.graph.subscribed_by(node) if app.is_motion(end.topic)]
    return make_finding(
        RULE.name,
        node,
        summary=f"{node} keeps its last command when its sender dies, unless its hardware stops",
        cause=f"its source opens hardware ({device.value}), and nothing in it looks at how old a "
        "command is",
        remedy=f"in {node}, stop the hardware when no command came for 0.5 s; see what it does "
        "by itself",
        consequence=Consequence.MOTION,
        certainty=Certainty.LIKELY,
        nodes=(node,),
        topics=[end.topic for end in obeyed],
        evidence=(*device.evidence, *app.evidence(obeyed)),
    )


def _repeating(app: AppFacts, node: str, repeated: dict[str, set[str]]) -> Finding:
    inputs, sent = tuple(repeated), sorted(set().union(*repeated.values()))
    names, outputs = join_names(inputs), join_names(sent)
    return make_finding(
        RULE.name,
        node,
        summary=f"{node} sends its last command for ever when {names} {conjugate(inputs, 'end')}",
        cause=f"it publishes what it kept of {names} again and again on {outputs}, and nothing in "
        "its source looks at how old that is",
        remedy=f"in {node}, send zero when nothing came for 0.5 s",
        consequence=Consequence.MOTION,
        certainty=Certainty.LIKELY,
        nodes=(node,),
        topics=(*inputs, *sent),
        evidence=app.evidence(e for e in app.graph.subscribed_by(node) if e.topic in inputs),
    )


def is_off(value: object) -> bool:
    """Return whether the value of such a parameter turns the timeout off."""
    return (
        isinstance(value, (int, float))
        and not isinstance(value, bool)
        and (value <= 0 or value == inf)
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
    title="A base keeps its last command for ever",
    consequence="motion: certain by a parameter, likely from source",
    since="0.1.0",
    check=check,
)
