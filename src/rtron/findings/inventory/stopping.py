"""Whether what drivers move stops by itself when commands end, as far as it can be told."""

import re
from collections.abc import Collection, Iterable, Iterator
from math import inf
from typing import NamedTuple

from rtron.findings.app_facts import AppFacts
from rtron.findings.inventory.things import COMMAND_NAMES
from rtron.vocabulary import Endpoint, LastMessageFate, WiringFact, WiringFactKind
from rtron.vocabulary.inventory import Command, Stops, Thing
from rtron.vocabulary.names import snake_case
from rtron.wording import conjugate, join_names

_KNOWN = {
    "diff_drive_controller": (Stops.YES, "cmd_vel_timeout, by default 0.5 s"),
    "mecanum_drive_controller": (Stops.YES, "reference_timeout"),
    "ackermann_steering_controller": (Stops.YES, "reference_timeout"),
    "tricycle_controller": (Stops.YES, "cmd_vel_timeout, by default 0.5 s"),
    "kobuki_node": (Stops.YES, "cmd_vel_timeout, by default 0.6 s"),
    "create_driver": (Stops.YES, "latch_cmd_duration, by default 0.2 s"),
    "turtlesim": (Stops.YES, "a turtle stops 1 s after its last command"),
    "turtlebot3_node": (Stops.UNKNOWN, "its firmware decides"),
    "gazebo_ros": (Stops.NO, "Gazebo's plugin keeps the last command"),
    "gazebo_plugins": (Stops.NO, "Gazebo's plugin keeps the last command"),
    "ros_gz_bridge": (Stops.NO, "Gazebo keeps the last command"),
    "stage_ros": (Stops.YES, "watchdog_timeout, by default 0.2 s"),
    "mavros": (Stops.UNKNOWN, "the settings of the autopilot's failsafe decide"),
}
"""What is documented of drivers: control.ros.org, wiki.ros.org, or their own source."""
TIMEOUT_NAMES = (
    "cmd_vel_timeout",
    "cmd_timeout",
    "command_timeout",
    "reference_timeout",
    "timeout_cmd",
)
"""Parameters that say how long a command counts."""
_CLEVER_DEVICES = {
    "moteus": ", by default after 0.1 s",
    "VESC": ", by default after 1 s",
    "Roboteq": ", by default after 1 s",
    **dict.fromkeys(("vehicle link", "vendor SDK", "TCP link"), ""),
}
"""Devices that mostly stop by themselves, and when: an autopilot, a base with its own controller.

Documented are servo.default_timeout_s (mjbots' reference of moteus), APPCONF_TIMEOUT_MSEC (VESC's
firmware) and RWD (Roboteq's user manual).
"""
_VELOCITIES = re.compile(r"geometry_msgs/(?:msg/)?Twist|ackermann_msgs/|sensor_msgs/(?:msg/)?Joy")
_STREAMS = re.compile(rf"{_VELOCITIES.pattern}|/\w*(?:Cmd|Command|Channels|Drive|Motor|Joy)")
"""Types of commands that come again and again, by their names."""
_UNCHECKED = frozenset({LastMessageFate.UNNOTICED, LastMessageFate.REPEATED})
"""What becomes of a last message where nothing looks at its age."""
_ENDING = re.compile(
    r"(?<![a-z])(?:positions?|pos|poses?|goal|height|level|steer\w*|angles?|degrees?)(?![a-z])"
)
"""Words in names and types of what tells where to go: the motion ends there."""
_TRAJECTORY = re.compile(r"(?<![a-z])traj")
_RATES = re.compile(r"(?<![a-z])(?:speed|vel|velocity|velocities|effort|torque|thrust)s?(?![a-z])")
"""Words in names of what tells how fast or how hard to go."""


class Stopping(NamedTuple):
    """Whether it stops, and why; `holder` is who keeps the last command, on a real robot."""

    stops: Stops
    why: str
    holder: str = ""


_ABSENT = Stopping(Stops.UNKNOWN, "what obeys is not in this launch")


def goes_on(thing: Thing, command: Command) -> bool:
    """Return whether what a command moves goes on without more of them: it tells no place.

    What hangs on hardware that is not known may be told once.
    """
    last, type = snake_case(command.name.rpartition("/")[2]), snake_case(command.type)
    words = f"{snake_case(command.name)} {type}"
    if _VELOCITIES.search(command.type) or _RATES.search(last):
        return True
    if _TRAJECTORY.search(words):
        return False
    if _RATES.search(words):
        return True
    if thing is Thing.ARM or _ENDING.search(f"{last} {type}"):
        return False
    is_named = COMMAND_NAMES.search(command.name) and not command.type.endswith("/String")
    is_known = thing is not Thing.DEVICE or bool(is_named)
    return bool(_STREAMS.search(command.type)) or (is_known and not _ENDING.search(words))


def stopping(
    app: AppFacts,
    drivers: tuple[str, ...],
    commands: Collection[Command],
    behind: Collection[tuple[str, Command]],
) -> list[Stopping]:
    """Return what is known of the drivers, and of who forwards the commands behind, worst first.

    A controller of ROS 1 is no node: its topics and its parameters are below its name.
    """
    topics = {command.name for command in commands}
    controllers = {topic.rpartition("/")[0] for topic in topics} - app.nodes.keys()
    found = [_of_driver(app, node, controllers, topics) for node in drivers] or [_ABSENT]
    types = {command.type for command in commands}
    led = topics | {command.name for _, command in behind}
    found += (
        stop
        for node, command in behind
        if command.type in types or _STREAMS.search(command.type)
        for stop in _of_forwarder(app, node, command.name, led)
    )
    return _worst_first(found)


def _worst_first(found: list[Stopping]) -> list[Stopping]:
    order = (Stops.NO, Stops.UNKNOWN, Stops.YES)
    return sorted(found, key=lambda each: order.index(each.stops))


def _of_forwarder(app: AppFacts, node: str, topic: str, led: Collection[str]) -> Iterator[Stopping]:
    """Yield that a node sends its last command on for ever, where its source shows it."""
    if _repeated_topics(app, node, topic).isdisjoint(led):
        return
    if age := next(_facts(app, node, WiringFactKind.COMMAND_AGE), None):
        yield Stopping(Stops.UNKNOWN, f"{node} may look at the age of commands{_place(age)}")
    else:
        yield Stopping(Stops.NO, f"{node} sends its last command for ever when {topic} ends", node)


def _of_driver(
    app: AppFacts, node: str, controllers: Collection[str], topics: Collection[str]
) -> Stopping:
    subscribed = {end.topic for end in app.graph.subscribed_by(node)}.intersection(topics)
    read = _by_source(app, node, sorted(t for t in subscribed if node in app.readers(t)))
    if read and read.stops is Stops.NO:
        return read
    return _by_parameter(app, node, controllers) or read or _documented(app, node, topics)


def _documented(app: AppFacts, node: str, topics: Collection[str]) -> Stopping:
    """Return the worst that is documented of the packages whose code hears the commands."""
    own = app.nodes[node].package if node in app.nodes else ""
    subscribed = [end for end in app.graph.subscribed_by(node) if end.topic in topics]
    silent = Stopping(Stops.UNKNOWN, f"{node} does not tell")
    packages = [each for end in subscribed for each in _library_packages(end) or [_host(end, own)]]
    known = [Stopping(*_KNOWN[each]) if each in _KNOWN else silent for each in packages or [own]]
    return _worst_first(known)[0]


def _host(end: Endpoint, own: str) -> str:
    """Return the package of a node that hears a velocity; of others that it hosts it says less."""
    return own if _STREAMS.search(end.type) else ""


def _library_packages(end: Endpoint) -> list[str]:
    """Return the known packages of models whose code hears a topic, as that of a controller."""
    places = (at.file.partition(" ") for at in end.evidence if at.file.startswith("github.com/"))
    return sorted({path.partition("/")[0] for _, _, path in places} & _KNOWN.keys())


def _by_parameter(app: AppFacts, node: str, controllers: Collection[str]) -> Stopping | None:
    """Return what a timeout says; a driver in whose source nothing is called so has none."""
    kinds = {each.kind for each in app.graph.wiring if each.subject == node}
    if WiringFactKind.DEVICE in kinds and WiringFactKind.COMMAND_AGE not in kinds:
        return None
    found: list[Stopping] = []
    for parameter in app.graph.parameters:
        is_timeout = parameter.name.rpartition(".")[2] in TIMEOUT_NAMES
        is_number = isinstance(parameter.value, (int, float))
        is_own = parameter.node == node or parameter.node in controllers
        if is_own and is_timeout and is_number:
            stops = Stops.NO if is_off(parameter.value) else Stops.YES
            why = f"{parameter.node}: {parameter.name} is {parameter.value}"
            found.append(Stopping(stops, why, parameter.node if stops is Stops.NO else ""))
    return _worst_first(found)[0] if found else None


def _by_source(app: AppFacts, node: str, topics: Collection[str]) -> Stopping | None:
    """Return the worst of what the source of a node does with its topics, each by itself."""
    fates = {topic: app.last_messages(node, {topic}) for topic in topics}
    last = {fate: fact for each in fates.values() for fate, fact in each.items()}
    age = next(_facts(app, node, WiringFactKind.COMMAND_AGE), None)
    is_read = bool(fates) and all(fates.values())
    if age is None or (is_read and _is_of_others(app, node, age)):
        unchecked = [topic for topic in topics if not _UNCHECKED.isdisjoint(fates[topic])]
        if found := _of_unchecked(app, node, unchecked):
            return found
    if is_read and all({*each} == {LastMessageFate.STOPPED} for each in fates.values()):
        return _stopped(node, last[LastMessageFate.STOPPED])
    hint = last.get(LastMessageFate.CHECKED) or (None if is_read else age)
    if hint:
        return Stopping(Stops.UNKNOWN, f"{node} may look at the age of commands{_place(hint)}")
    if stop := last.get(LastMessageFate.STOPPED):
        others = join_names([t for t in topics if {*fates[t]} != {LastMessageFate.STOPPED}])
        why = f"{node} looks at the age of some commands, but is not seen to on {others}"
        return Stopping(Stops.UNKNOWN, f"{why}{_place(stop)}")
    if age:
        why = f"{node} is not seen to look at the age of these commands; a name may tell of it"
        return Stopping(Stops.UNKNOWN, f"{why}{_place(age)}")
    return None


def _stopped(node: str, stop: WiringFact) -> Stopping:
    after = "".join(f", after {seconds}" for seconds in stop.others)
    return Stopping(Stops.YES, f"{node} looks at the age of commands{after}{_place(stop)}")


def _of_unchecked(app: AppFacts, node: str, topics: list[str]) -> Stopping | None:
    """Return what becomes of the commands of a driver in whose source nothing tells of an age."""
    devices = {fact.value for fact in _facts(app, node, WiringFactKind.DEVICE)}
    if topics and (other := _other_stop(app, node, topics)):
        return Stopping(Stops.UNKNOWN, other)
    if topics and devices:
        why = "nothing in the source of"
        where = join_names(topics)
        return Stopping(Stops.NO, f"{why} {node} looks at the age of commands on {where}", node)
    repeated = [t for t in topics if LastMessageFate.REPEATED in app.last_messages(node, {t})]
    condition = f"{join_names(repeated)} {conjugate(repeated, 'end')}"
    why = f"{node} sends its last command for ever when {condition}"
    return Stopping(Stops.NO, why, node) if repeated else None


def _is_of_others(app: AppFacts, node: str, age: WiringFact) -> bool:
    """Return whether the file of a name that tells of an age stops other commands by theirs."""
    topics = {end.topic for end in app.graph.subscribed_by(node)}
    stop = app.last_messages(node, topics).get(LastMessageFate.STOPPED)
    return stop is not None and any(stop.evidence[-1].file == at.file for at in age.evidence[:1])


def _place(fact: WiringFact) -> str:
    return "".join(f", {at.file}:{at.line}" for at in fact.evidence[-1:])


def _facts(app: AppFacts, node: str, kind: WiringFactKind) -> Iterator[WiringFact]:
    return (each for each in app.graph.wiring if each.kind is kind and each.subject == node)


def _other_stop(app: AppFacts, node: str, topics: Iterable[str]) -> str:
    """Return what may stop a driver in whose source nothing looks at the age of its commands.

    Another node that hears them, looks at their age, and sends such itself; or its device.
    """
    watchers = {
        other
        for topic in topics
        for other in app.publishers(topic)
        if other != node and not _UNCHECKED.issuperset(app.last_messages(other, {topic}))
    }
    if watchers:
        return f"{node} does not by itself; {min(watchers)} may stop it"
    opened = {fact.value for fact in app.graph.wiring if fact.subject == node}
    clever = next((each for each in _CLEVER_DEVICES if each in opened), "")
    may = f"its device may{_CLEVER_DEVICES[clever]}" if clever else ""
    return may and f"{node} looks at no age of commands; {may}"


def _repeated_topics(app: AppFacts, node: str, topic: str) -> set[str]:
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


def is_off(value: object) -> bool:
    """Return whether the value of such a parameter turns the timeout off."""
    return (
        isinstance(value, (int, float))
        and not isinstance(value, bool)
        and (value <= 0 or value == inf)
    )
