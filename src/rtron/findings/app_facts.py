"""What the rules of findings ask of an app: its graph, what was not read, and what moves it."""

from collections import defaultdict
from collections.abc import Collection, Iterable, Iterator
from dataclasses import dataclass
from functools import cached_property
from itertools import chain
from typing import TypeAlias

from rtron.findings.measurement_names import MEASURED_TYPES, is_called_sensor, moves_nothing
from rtron.findings.near_names import MOST_COMPARED, are_beside, near_names
from rtron.risks.graph_facts import GraphFacts, evidence_of
from rtron.vocabulary import (
    Consequence,
    Direction,
    Domain,
    Endpoint,
    Evidence,
    InteractionGraph,
    Node,
    UnresolvedItem,
    WiringFact,
    WiringFactKind,
    fits_open_name,
    normalise_type,
)
from rtron.vocabulary.enums import HiddenPart
from rtron.vocabulary.names import EMERGENCY_STOP, are_nested, snake_case
from rtron.wording import join_names

_UNKNOWN_TYPES = ("", "*", "topic_tools/ShapeShifter")
"""Not known, or any: ShapeShifter takes every type (ROS wiki: topic_tools)."""
_COMMON_PACKAGES = ("std_msgs/", "geometry_msgs/", "sensor_msgs/", "nav_msgs/")
_IMAGES = ("sensor_msgs/Image", "sensor_msgs/CompressedImage")
_INDIRECT_TYPES = frozenset({"sensor_msgs/Joy", "std_msgs/String", "sound_play/SoundRequest"})
"""Types of what a node may turn into motion, or into speech, but that moves nothing itself."""
_ECHOES = ("prev_", "previous_", "last_", "current_")
"""How names begin that tell of a command afterwards."""
_OF_PX4 = {Direction.SUBSCRIBE: "/fmu/in/", Direction.PUBLISH: "/fmu/out/"}
"""What the autopilot subscribes and publishes (PX4: uXRCE-DDS), whose firmware no scan reads."""
_OpenName: TypeAlias = tuple[str, str]
"""A name that is known in part, and the type of its endpoint."""


@dataclass(frozen=True, eq=False)
class AppFacts:
    """The facts of a graph; message types are in ROS 1 spelling throughout.

    Two are equal if they are one object, so that what is computed of the last app can be kept.
    """

    facts: GraphFacts

    @property
    def graph(self) -> InteractionGraph:
        """The app's graph."""
        return self.facts.graph

    @cached_property
    def nodes(self) -> dict[str, Node]:
        """The nodes by name."""
        return {node.name: node for node in self.graph.nodes}

    @cached_property
    def unread_nodes(self) -> tuple[str, ...]:
        """The nodes whose endpoints are not known, or not all; any of them may use any topic."""
        unread = (n.name for n in self.graph.nodes if n.unread)
        return tuple(sorted(name for name in unread if name not in self.facts.viewers))

    @cached_property
    def unread_files(self) -> tuple[str, ...]:
        """What else was not read and may start nodes or name topics: includes, launch files."""
        return tuple(dict.fromkeys(note.what for note in self._hiding(HiddenPart.NODES)))

    def _hiding(self, part: HiddenPart) -> Iterator[UnresolvedItem]:
        """Yield what was not read and may hide a part of the app."""
        return (note for note in self.graph.unresolved if note.hides is part)

    @property
    def unread_hint(self) -> str:
        """What, not being read, may be the missing end; nothing if all was read."""
        names = self.unread_nodes
        if names:
            return f", unless {join_names(names)} (not read) {'do' if names[1:] else 'does'}"
        return f", unless {self.unread_files[0]} (not read) does" if self.unread_files else ""

    def unread_publisher_hint(self, topics: Iterable[str]) -> str:
        """Return what may publish one of some topics that nobody is known to publish."""
        place = next(filter(None, map(self._unread_publishers.get, topics)), None)
        return f", unless {place.file}:{place.line} does" if place else self.unread_hint

    @cached_property
    def _unread_publishers(self) -> dict[str, Evidence]:
        """The places of code that may publish a topic, by topic."""
        facts = self._wiring[WiringFactKind.UNREAD_PUBLISHER]
        return {fact.subject: place for fact in facts for place in fact.evidence}

    def last_messages(self, node: str, topics: Collection[str]) -> dict[str, WiringFact]:
        """Return the fates (LastMessageFate) of the last messages that a node gets on topics."""
        endpoints = (end for end in self.graph.subscribed_by(node) if end.topic in topics)
        places = {place for end in endpoints for place in end.evidence}
        facts = self._wiring[WiringFactKind.LAST_MESSAGE]
        return {fact.value: fact for fact in facts if places.intersection(fact.evidence[:1])}

    def sends_once(self, node: str) -> bool:
        """Return whether a node is a `topic pub` of the launch that sets something, and rests."""
        return any(fact.subject == node for fact in self._wiring[WiringFactKind.SENT_ONCE])

    @cached_property
    def _wiring(self) -> defaultdict[WiringFactKind, list[WiringFact]]:
        """The facts about the wiring, by what they are about."""
        found = defaultdict[WiringFactKind, list[WiringFact]](list)
        for fact in self.graph.wiring:
            found[fact.kind].append(fact)
        return found

    @property
    def is_whole(self) -> bool:
        """Whether everything that could publish, subscribe or serve was read."""
        return not (self.unread_nodes or self.unread_files or self._has_unread_calls)

    @cached_property
    def _has_unread_calls(self) -> bool:
        """Whether something is published, subscribed or served by nobody knows whom."""
        return any(self._hiding(HiddenPart.ENDPOINTS))

    @cached_property
    def explicit_topics(self) -> tuple[str, ...]:
        """The topics with an endpoint that a client library does not add by itself."""
        return tuple(sorted({e.topic for e in self.graph.endpoints if not e.implicit}))

    @cached_property
    def motion_topics(self) -> tuple[str, ...]:
        """The topics that command motion: velocities, setpoints, trajectories and their kin."""
        return tuple(name for name in self.explicit_topics if self.is_motion(name))

    @cached_property
    def obeyed_topics(self) -> tuple[str, ...]:
        """The motion topics that the app's own obey; none where many make names tell little."""
        own = (topic for topic in self.motion_topics if not self._is_of_other_model(topic))
        obeyed = tuple(topic for topic in own if self.readers(topic))
        return obeyed if len(obeyed) <= MOST_COMPARED else ()

    def _is_of_other_model(self, topic: str) -> bool:
        return any(fact.subject == topic for fact in self._wiring[WiringFactKind.OTHER_MODEL])

    def is_motion(self, topic: str) -> bool:
        """Return whether a topic commands motion, by its type and its name."""
        is_indirect = self.facts.topic(topic).type in _INDIRECT_TYPES
        is_indirect |= topic.rpartition("/")[2].startswith(_ECHOES)
        return self.is_stop(topic) or (self.facts.is_motion_command(topic) and not is_indirect)

    def is_stop(self, topic: str) -> bool:
        """Return whether a topic sets and releases an emergency stop."""
        is_named_so = EMERGENCY_STOP.search(snake_case(topic))
        return bool(is_named_so) and self.facts.classify(topic).domain is Domain.CONTROL

    def publishers(self, topic: str) -> tuple[str, ...]:
        """Return the nodes that publish a topic."""
        return self.facts.topic(topic).publishers

    def readers(self, topic: str) -> tuple[str, ...]:
        """Return the nodes that subscribe a topic and do not only show it."""
        return self.facts.topic(topic).successors

    def open_readers(self, topic: str) -> tuple[str, ...]:
        """Return the nodes that subscribe names known in part, one of which may be this topic."""
        subscribed = self._open_names[Direction.SUBSCRIBE].items()
        found = (nodes for open_name, nodes in subscribed if self._may_be(open_name, topic))
        nodes = set(chain.from_iterable(found))
        return tuple(sorted(nodes - self.facts.viewers - set(self.publishers(topic))))

    def users(self, topic: str, direction: Direction) -> tuple[str, ...]:
        """Return the publishers of a topic, or its readers."""
        return self.publishers(topic) if direction is Direction.PUBLISH else self.readers(topic)

    def endpoints(self, topic: str, direction: Direction) -> tuple[Endpoint, ...]:
        """Return the endpoints of one direction."""
        is_published = direction is Direction.PUBLISH
        return self.graph.publishers(topic) if is_published else self.graph.subscribers(topic)

    def types(self, topic: str, direction: Direction) -> dict[str, list[Endpoint]]:
        """Return the endpoints of one direction by their known type, as ROS 1 spells it."""
        found: dict[str, list[Endpoint]] = defaultdict(list)
        for end in self.endpoints(topic, direction):
            if not _is_unknown(end.type):
                found[normalise_type(end.type)].append(end)
        return found

    def has_unknown_type(self, topic: str, direction: Direction) -> bool:
        """Return whether an end of one direction may have any type."""
        return any(_is_unknown(end.type) for end in self.endpoints(topic, direction))

    def may_have_other_end(self, topic: str, direction: Direction) -> bool:
        """Return whether an end that is missing may be one that was not read, or not wholly."""
        if direction is Direction.PUBLISH and topic in self._unread_publishers:
            return True
        if _OF_PX4[direction] in topic or self._has_unread_calls:
            return True
        is_open = any(self._may_be(each, topic) for each in self._open_names[direction])
        return is_open or self._may_be_unread(topic)

    def _may_be_unread(self, topic: str) -> bool:
        """Return whether what was not read may have an end of a topic.

        Who is given names of commands joins no other commands, and no camera commands anything.
        """
        if not self.is_motion(topic):
            return bool(self.unread_nodes or self.unread_files)
        return self._may_unread_command or topic in self._commands_of_unread

    @cached_property
    def _may_unread_command(self) -> bool:
        """Whether something that was not read may use commands of any name."""
        given = {
            fact.subject
            for fact in self._wiring[WiringFactKind.UNREAD_NODE]
            if not self._commands_of_unread.isdisjoint(fact.others)
        }
        nodes = (self.nodes[name] for name in {*self.unread_nodes} - given)
        return not (
            all(map(is_called_sensor, nodes)) and all(map(moves_nothing, self.unread_files))
        )

    @cached_property
    def _commands_of_unread(self) -> frozenset[str]:
        """The commands of motion that remaps and parameters name to nodes that were not read."""
        names = chain.from_iterable(
            fact.others for fact in self._wiring[WiringFactKind.UNREAD_NODE]
        )
        return frozenset(filter(self.is_motion, names))

    def _may_be(self, open_name: _OpenName, topic: str) -> bool:
        """Return whether an endpoint whose name is known in part may be one of a topic."""
        name, type = open_name
        types = self.facts.topic(topic).types
        is_of_type = not types or _is_unknown(type) or normalise_type(type) in types
        return is_of_type and fits_open_name(topic, [name])

    def consequence(self, topic: str, deaf_nodes: Iterable[str]) -> Consequence:
        """Return what follows where nodes do not get a topic; viewers do not move the robot."""
        acts = not self.facts.viewers.issuperset(deaf_nodes)
        return Consequence.MOTION if acts and self.is_motion(topic) else Consequence.FAILURE

    def near_topics(self, topic: str, types: Iterable[str]) -> list[str]:
        """Return published topics of some types with a near name, those that nobody reads first.

        What only the readers of the topic publish, or what is made of it, is not what they wait
        for. Nor is a command on its way through another node, which a remap would lead past. Where
        the topic may have a publisher whose name is not known, or is of another model of Gazebo,
        none is near.
        """
        types = tuple(types)
        is_open = any(self._may_be(each, topic) for each in self._open_names[Direction.PUBLISH])
        if is_open or self._is_of_other_model(topic):
            return []
        sent = [self._sent[type] for type in types if type in self._sent]
        if sum(map(len, sent)) > MOST_COMPARED:
            return []
        readers = set(self.readers(topic))
        others = list(chain.from_iterable(sent))
        near = [
            name
            for name in near_names(topic, others) or self._unread_measurement(topic, others)
            if not readers.issuperset(self.publishers(name))
            and topic not in self.upstream_topics(self.publishers(name), types)
            and not (self.is_motion(name) and self._is_forwarded(name, types))
        ]
        near.sort(key=lambda name: (bool(self.readers(name)), name))
        return near or self._only_partner(topic)

    def _unread_measurement(self, topic: str, others: Iterable[str]) -> list[str]:
        """Return the one measurement below or above a topic, if nobody reads it.

        Where there are more they are things of one kind, such as the odometry of each wheel.
        """
        nested = [other for other in others if other != topic and are_nested(topic, other)]
        is_unread = not any(self.readers(each) or self.open_readers(each) for each in nested)
        is_measured = bool(MEASURED_TYPES.match(self.facts.topic(topic).type))
        return nested if len(nested) == 1 and is_unread and is_measured else []

    def _only_partner(self, topic: str) -> list[str]:
        """Return the only other topic of its namespace with its own type, if nobody reads that.

        Of types that many packages use, only images count: a camera has a namespace of its own.
        """
        type = self.facts.topic(topic).type
        is_own = not type.startswith(_COMMON_PACKAGES) or type in _IMAGES
        of_type = self._topics_of_type.get(type, ()) if is_own else ()
        beside = [
            each
            for each in of_type
            if are_beside(each, topic) and not self._is_made_of(each, topic)
        ]
        return [each for each in beside[:1] if not (beside[1:] or self.graph.subscribers(each))]

    def _is_made_of(self, output: str, topic: str) -> bool:
        """Return whether only who reads a topic sends another one, or nobody."""
        return {*self.publishers(output)} <= {*self.readers(topic)}

    @cached_property
    def _topics_of_type(self) -> dict[str, set[str]]:
        found: dict[str, set[str]] = defaultdict(set)
        for topic in {end.topic for end in self.graph.endpoints}:
            for type in self.facts.topic(topic).types:
                found[type].add(topic)
        return found

    def upstream_topics(self, nodes: Iterable[str], types: Collection[str]) -> set[str]:
        """Return the topics of some types that reach nodes, by themselves or through others."""
        found, pending = set[str](), list(nodes)
        while pending:
            for end in self.graph.subscribed_by(pending.pop()):
                if normalise_type(end.type) in types and end.topic not in found:
                    found.add(end.topic)
                    pending.extend(self.publishers(end.topic))
        return found

    def evidence(self, endpoints: Iterable[Endpoint]) -> tuple[Evidence, ...]:
        """Return where endpoints were read, each place once."""
        return evidence_of(endpoints)

    def node_evidence(self, nodes: Iterable[str]) -> tuple[Evidence, ...]:
        """Return where nodes were read, at the first topic that each of them publishes."""
        return evidence_of(end for node in nodes for end in self.graph.published_by(node)[:1])

    def _is_forwarded(self, topic: str, types: Collection[str]) -> bool:
        """Return whether a reader of a topic publishes one of some types."""
        endpoints = (end for node in self.readers(topic) for end in self.graph.published_by(node))
        return any(normalise_type(end.type) in types for end in endpoints)

    @cached_property
    def _open_names(self) -> dict[Direction, dict[_OpenName, set[str]]]:
        """The names and types of endpoints that are known in part, each with its nodes."""
        found: dict[Direction, dict[_OpenName, set[str]]] = {each: {} for each in Direction}
        for end in self.graph.endpoints:
            if "{" in end.topic:
                found[end.direction].setdefault((end.topic, end.type), set()).add(end.node)
        return found

    @cached_property
    def _sent(self) -> dict[str, list[str]]:
        """The published topics by type, those with a whole name."""
        names: dict[str, list[str]] = defaultdict(list)
        for topic in self.explicit_topics:
            for type in () if "{" in topic else self.types(topic, Direction.PUBLISH):
                names[type].append(topic)
        return names


def _is_unknown(type: str) -> bool:
    """Return whether a type is not known, or not its package: `msg::Map` of a using directive."""
    return type in _UNKNOWN_TYPES or type.startswith("msg/")
