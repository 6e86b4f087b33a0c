"""Commands that nobody reads, each joined to the obeyed topic that it likely means."""

import re
from collections import defaultdict
from collections.abc import Iterable, Mapping
from functools import lru_cache
from itertools import product

from rtron.findings.app_facts import AppFacts
from rtron.findings.inventory.things import is_harmless, thing_of, thing_of_node
from rtron.findings.measurement_names import may_be_measured
from rtron.findings.near_names import says_more
from rtron.findings.node_kinds import ARBITER_PACKAGES, is_one_stack
from rtron.vocabulary import Direction, normalise_type
from rtron.vocabulary.inventory import Means
from rtron.vocabulary.names import are_nested

_MOST_COMPARED = 200
"""Among more topics a pair tells nothing, and comparing them takes long."""
_STAMPED = "Stamped"
_PLAIN = "std_msgs/"
"""Types that say too little to join two topics by them."""
_AMBIGUOUS = (
    "geometry_msgs/Twist",
    "geometry_msgs/Accel",
    "geometry_msgs/Wrench",
    "sensor_msgs/JointState",
)
"""Types of commands that tell of measurements, too."""
_COMMANDS = re.compile(r"cmd|command|teleop|joy|goal|desired|target|setpoint|(?<!wheel_)vel(?:_|$)")
"""What in a name says that it is a command."""
_ECHO = re.compile(r"(?:cmd\w*|vel)_out$")
"""How the names end of what tells of a command afterwards."""
_SIDES = re.compile(
    r"\d+|[a-z]\d|left|right|front|rear|back|upper|lower|top|bottom|port|starboard|[lr]|[a-h]|[xyz]"
)
"""Words that tell twins apart: robots, arms, wheels."""


@lru_cache(maxsize=1)
def lost_commands(app: AppFacts) -> Mapping[str, str]:
    """Return the commands that nobody reads, each with the obeyed topic that it likely means."""
    lost = [topic for topic in app.motion_topics if _is_lost(app, topic)]
    open_topics = _open_topics(app) if len(lost) <= _MOST_COMPARED else {}
    found = (
        (topic, _namesake(app, topic) or _only_open(app, topic, open_topics)) for topic in lost
    )
    return {topic: meant for topic, meant in found if meant}


def _is_lost(app: AppFacts, topic: str) -> bool:
    is_other = _is_measurement(app, topic) or app.graph.subscribers(topic) or "{" in topic
    return bool(app.publishers(topic)) and not is_other


def _is_measurement(app: AppFacts, topic: str) -> bool:
    return is_harmless(topic, app.facts.topic(topic).type) or may_be_measured(topic)


def _namesake(app: AppFacts, lost: str) -> str:
    """Return an obeyed topic of the same name in a namespace above or below, or a near one."""
    near = (obeyed for obeyed in app.obeyed_topics if _is_namesake(app, lost, obeyed))
    return next((obeyed for obeyed in near if _may_be_meant(app, lost, obeyed)), "")


def _is_namesake(app: AppFacts, lost: str, obeyed: str) -> bool:
    (namespace, _, name), (other_namespace, _, other_name) = (
        each.rpartition("/") for each in (lost, obeyed)
    )
    if name == other_name:
        return namespace != other_namespace and are_nested(namespace, other_namespace)
    is_near = namespace == other_namespace and says_more(name, other_name)
    return is_near and not may_be_linked(app, lost, obeyed)


def may_be_linked(app: AppFacts, lost: str, obeyed: str) -> bool:
    """Return whether what was not read may read the one topic or send the other."""
    may_be_read = app.may_have_other_end(lost, Direction.SUBSCRIBE)
    return may_be_read or app.may_have_other_end(obeyed, Direction.PUBLISH)


def _open_topics(app: AppFacts) -> dict[str, list[str]]:
    """Return the obeyed topics that nobody sends, by their types."""
    found: dict[str, list[str]] = defaultdict(list)
    for topic in app.obeyed_topics:
        is_open = not app.publishers(topic) and "{" not in topic and _is_command(app, topic)
        for type in app.types(topic, Direction.SUBSCRIBE) if is_open else ():
            if not (type.startswith(_PLAIN) or _is_spare(app, topic, type)):
                found[type].append(topic)
    return found


def _is_spare(app: AppFacts, topic: str, type: str) -> bool:
    """Return whether all who obey a topic obey another of its type instead, or nobody at times."""
    readers = app.readers(topic)
    return all(
        _has_other_input(app, reader, type) or _is_optional(app, reader) for reader in readers
    )


def _is_optional(app: AppFacts, reader: str) -> bool:
    """Return whether a node of a stack commands also where nobody commands it: Nav2's behaviors."""
    package = app.nodes[reader].package if reader in app.nodes else ""
    sends = any(app.is_motion(end.topic) for end in app.graph.published_by(reader))
    return sends and is_one_stack(app, (reader,)) and package not in ARBITER_PACKAGES


def _has_other_input(app: AppFacts, reader: str, type: str) -> bool:
    inputs = {e.topic for e in app.graph.subscribed_by(reader) if normalise_type(e.type) == type}
    return any(app.publishers(topic) for topic in inputs)


def _only_open(app: AppFacts, lost: str, open_topics: Mapping[str, list[str]]) -> str:
    """Return the open topic that a lost command fits, if there is no more than one."""
    types = app.types(lost, Direction.PUBLISH)
    others = {topic for type in types for topic in open_topics.get(type, ())}
    if not others or not _is_command(app, lost) or _is_second_output(app, lost, types):
        return ""
    fitting = [each for each in sorted(others) if _fits(app, lost, each)]
    is_meant = len(fitting) == 1 and _move_one_thing(app, lost, fitting[0])
    return fitting[0] if is_meant else ""


def _is_command(app: AppFacts, topic: str) -> bool:
    """Return whether a topic commands, and does not tell of a motion by the same type."""
    if _is_measurement(app, topic) or _ECHO.search(topic.lower()):
        return False
    if not app.facts.topic(topic).type.startswith(_AMBIGUOUS) or _COMMANDS.search(topic.lower()):
        return True
    beside = (e for node in app.publishers(topic) for e in app.graph.published_by(node))
    return not any(_measures(normalise_type(each.type)) for each in beside)


def _measures(type: str) -> bool:
    return type.startswith(("nav_msgs/Odometry", "sensor_msgs/")) or "WithCovariance" in type


def _is_second_output(app: AppFacts, lost: str, types: Iterable[str]) -> bool:
    """Return whether those who send a command send another one of its type, too."""
    beside = (e for node in app.publishers(lost) for e in app.graph.published_by(node))
    return any(each.topic != lost and normalise_type(each.type) in types for each in beside)


def _fits(app: AppFacts, lost: str, obeyed: str) -> bool:
    """Return whether two topics may be one though their names are not alike."""
    (namespace, _, name), (other_namespace, _, other_name) = (
        each.rpartition("/") for each in (lost, obeyed)
    )
    is_other_robot = name == other_name and not are_nested(namespace, other_namespace)
    homes = product(
        *(
            {node.rpartition("/")[0] for node in nodes}
            for nodes in (app.publishers(lost), app.readers(obeyed))
        )
    )
    are_apart = is_other_robot or are_twins(lost, obeyed)
    if are_apart or not any(are_nested(*each) for each in homes):
        return False
    return _may_be_meant(app, lost, obeyed) and not may_be_linked(app, lost, obeyed)


def _move_one_thing(app: AppFacts, lost: str, obeyed: str) -> bool:
    """Return whether two topics command the same thing, and no node's name tells of another."""
    thing, other = (
        thing_of(each, app.facts.topic(each).type, Means.TOPIC) for each in (lost, obeyed)
    )
    nodes = (*app.publishers(lost), *app.readers(obeyed))
    return thing is other and {thing, None}.issuperset(map(thing_of_node, nodes))


def are_twins(one: str, other: str) -> bool:
    """Return whether two names differ in words alone that tell robots, arms or wheels apart."""
    words, others = (re.split(r"[/_]|(?<=[a-z])(?=\d+(?:[/_]|$))", name) for name in (one, other))
    differing = [pair for pair in zip(words, others, strict=False) if pair[0] != pair[1]]
    is_alike = len(words) == len(others)
    return is_alike and all(_SIDES.fullmatch(word) for pair in differing for word in pair)


def _may_be_meant(app: AppFacts, lost: str, obeyed: str) -> bool:
    """Return whether types fit, and no sender hears the obeyed topic, or sends both."""
    sent, publishers = app.types(lost, Direction.PUBLISH), set(app.publishers(lost))
    publishes_both = publishers <= set(app.publishers(obeyed))
    if publishes_both or app.open_readers(lost) or not _has_fitting_type(app, lost, obeyed):
        return False
    return obeyed not in app.upstream_topics(publishers, sent.keys())


def _has_fitting_type(app: AppFacts, lost: str, obeyed: str) -> bool:
    """Return whether types are one, or differ in the stamp alone where nobody sends the other."""
    sent, expected = app.types(lost, Direction.PUBLISH), app.types(obeyed, Direction.SUBSCRIBE)
    if not other_type(app, lost, obeyed):
        return bool(sent and expected)
    unstamped = ({type.removesuffix(_STAMPED) for type in types} for types in (sent, expected))
    return not app.publishers(obeyed) and not set.isdisjoint(*unstamped)


def other_type(app: AppFacts, lost: str, obeyed: str) -> str:
    """Return the type of an obeyed topic, nothing if a lost command has it, too."""
    sent, expected = app.types(lost, Direction.PUBLISH), app.types(obeyed, Direction.SUBSCRIBE)
    return "" if sent.keys() & expected.keys() else next(iter(expected), "")
