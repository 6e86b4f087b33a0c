"""Whether what drivers move stops by itself when commands end, as far as it can be told."""

from collections.abc import Collection, Iterator
from typing import NamedTuple

from rtron.findings.app_facts import AppFacts
from rtron.findings.motion.command_timeout import (
    STREAMS,
    TIMEOUT_NAMES,
    UNCHECKED,
    is_off,
    other_stop,
    repeated_topics,
)
from rtron.vocabulary import Endpoint, LastMessageFate, WiringFact, WiringFactKind
from rtron.vocabulary.inventory import Command, Stops
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


class Stopping(NamedTuple):
    """Whether it stops, and why."""

    stops: Stops
    why: str


_ABSENT = Stopping(Stops.UNKNOWN, "what obeys is not in this launch")


def stopping(
    app: AppFacts,
    drivers: tuple[str, ...],
    commands: Collection[Command],
    behind: Collection[tuple[str, Command]],
) -> Stopping:
    """Return the worst that is known of the drivers, and of who forwards the commands behind.

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
        if command.type in types or STREAMS.search(command.type)
        for stop in _of_forwarder(app, node, command.name, led)
    )
    return _worst(found)


def _worst(found: list[Stopping]) -> Stopping:
    order = (Stops.NO, Stops.UNKNOWN, Stops.YES)
    return min(found, key=lambda each: order.index(each.stops))


def _of_forwarder(app: AppFacts, node: str, topic: str, led: Collection[str]) -> Iterator[Stopping]:
    """Yield that a node sends its last command on for ever, where its source shows it."""
    if not repeated_topics(app, node, topic).isdisjoint(led):
        yield Stopping(Stops.NO, f"{node} sends its last command for ever when {topic} ends")


def _of_driver(
    app: AppFacts, node: str, controllers: Collection[str], topics: Collection[str]
) -> Stopping:
    read = _by_source(app, node, sorted(t for t in topics if node in app.readers(t)))
    if read and read.stops is Stops.NO:
        return read
    return _by_parameter(app, node, controllers) or read or _documented(app, node, topics)


def _documented(app: AppFacts, node: str, topics: Collection[str]) -> Stopping:
    """Return the worst that is documented of the packages whose code hears the commands."""
    own = app.nodes[node].package if node in app.nodes else ""
    subscribed = [end for end in app.graph.subscribed_by(node) if end.topic in topics]
    packages = [each for end in subscribed for each in _library_packages(end) or (own,)] or [own]
    silent = Stopping(Stops.UNKNOWN, f"{node} does not tell")
    return _worst([Stopping(*_KNOWN[each]) if each in _KNOWN else silent for each in packages])


def _library_packages(end: Endpoint) -> list[str]:
    """Return the known packages of models whose code hears a topic, as that of a controller."""
    places = (at.file.partition(" ") for at in end.evidence if at.file.startswith("github.com/"))
    return sorted({path.partition("/")[0] for _, _, path in places} & _KNOWN.keys())


def _by_parameter(app: AppFacts, node: str, controllers: Collection[str]) -> Stopping | None:
    """Return what a timeout says; a driver in whose source nothing is called so has none."""
    kinds = {each.kind for each in app.graph.wiring if each.subject == node}
    if WiringFactKind.DEVICE in kinds and WiringFactKind.COMMAND_AGE not in kinds:
        return None
    nodes, found = {node, *controllers}, []
    for parameter in app.graph.parameters:
        is_timeout = parameter.name.rpartition(".")[2] in TIMEOUT_NAMES
        is_number = isinstance(parameter.value, (int, float))
        if parameter.node in nodes and is_timeout and is_number:
            stops = Stops.NO if is_off(parameter.value) else Stops.YES
            why = f"{parameter.node}: {parameter.name} is {parameter.value}"
            found.append(Stopping(stops, why))
    return _worst(found) if found else None


def _by_source(app: AppFacts, node: str, topics: Collection[str]) -> Stopping | None:
    """Return the worst of what the source of a node does with its topics, each by itself."""
    fates = {topic: app.last_messages(node, {topic}) for topic in topics}
    last = {fate: fact for each in fates.values() for fate, fact in each.items()}
    age = next(_facts(app, node, WiringFactKind.COMMAND_AGE), None)
    is_read = bool(fates) and all(fates.values())
    if age is None or (is_read and _is_of_others(app, node, age)):
        unchecked = [topic for topic in topics if not UNCHECKED.isdisjoint(fates[topic])]
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
    if topics and (other := other_stop(app, node, topics)):
        return Stopping(Stops.UNKNOWN, other)
    if topics and devices:
        why = "nothing in the source of"
        where = join_names(topics)
        return Stopping(Stops.NO, f"{why} {node} looks at the age of commands on {where}")
    repeated = [t for t in topics if LastMessageFate.REPEATED in app.last_messages(node, {t})]
    condition = f"{join_names(repeated)} {conjugate(repeated, 'end')}"
    why = f"{node} sends its last command for ever when {condition}"
    return Stopping(Stops.NO, why) if repeated else None


def _is_of_others(app: AppFacts, node: str, age: WiringFact) -> bool:
    """Return whether the file of a name that tells of an age stops other commands by theirs."""
    topics = {end.topic for end in app.graph.subscribed_by(node)}
    stop = app.last_messages(node, topics).get(LastMessageFate.STOPPED)
    return stop is not None and any(stop.evidence[-1].file == at.file for at in age.evidence[:1])


def _place(fact: WiringFact) -> str:
    return "".join(f", {at.file}:{at.line}" for at in fact.evidence[-1:])


def _facts(app: AppFacts, node: str, kind: WiringFactKind) -> Iterator[WiringFact]:
    return (each for each in app.graph.wiring if each.kind is kind and each.subject == node)
