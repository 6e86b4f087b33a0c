"""What the rules ask of a graph: each answer takes time in proportion to its own size, once."""

from collections.abc import Iterable
from dataclasses import dataclass, field
from functools import cached_property, lru_cache
from typing import NamedTuple

from rtron.risks.lists import RiskLists
from rtron.vocabulary import (
    Direction,
    Domain,
    Endpoint,
    Evidence,
    InteractionGraph,
    Sharing,
    StreamKind,
    TopicClass,
    Trust,
    normalise_type,
    with_goal_topics,
)

# A risk that spans several topics names so many nodes of each, or it could grow with the square
# of the graph. Who publishes a topic with more publishers stands in full in its GR-ST.
MAX_NAMED_NODES = 100


class TopicFacts(NamedTuple):
    """A topic's distinct ends in order of name, and its types, those of its publishers first.

    `successors` are the nodes that act on it, so viewers are left out. `own` tells whether all
    publishers are the user's own.
    """

    name: str
    types: tuple[str, ...]
    publishers: tuple[str, ...]
    successors: tuple[str, ...]
    only_own_publishers: bool

    @property
    def type(self) -> str:
        """The type that the publishers use, or an empty text."""
        return self.types[0] if self.types else ""


@dataclass(frozen=True)
class GraphFacts:
    """A graph seen with the lists. Message types are in ROS 1 spelling throughout."""

    graph: InteractionGraph
    lists: RiskLists
    _topics: dict[str, TopicFacts] = field(default_factory=dict, init=False)
    _classes: dict[str, TopicClass] = field(default_factory=dict, init=False)

    @cached_property
    def published_topics(self) -> tuple[str, ...]:
        """The topics with a publisher."""
        return _distinct(e.topic for e in self.graph.endpoints if e.direction is Direction.PUBLISH)

    @cached_property
    def graph_with_goals(self) -> InteractionGraph:
        """The graph with the goals of ROS 2's actions as topics of the actions' names."""
        return with_goal_topics(self.graph)

    @cached_property
    def ros2_actions(self) -> tuple[str, ...]:
        """The actions of ROS 2 with a client."""
        more = self.graph_with_goals.endpoints[len(self.graph.endpoints) :]
        return _distinct(e.topic for e in more if e.direction is Direction.PUBLISH)

    @cached_property
    def subscribing_nodes(self) -> tuple[str, ...]:
        """The nodes with a subscription."""
        return _distinct(e.node for e in self.graph.endpoints if e.direction is Direction.SUBSCRIBE)

    @cached_property
    def viewers(self) -> frozenset[str]:
        """The nodes that only record or show what they subscribe, known by their package."""
        return frozenset(n.name for n in self.graph.nodes if self.lists.is_viewer(n.package))

    def topic(self, name: str) -> TopicFacts:
        """Return what is known of a topic."""
        if name not in self._topics:
            self._topics[name] = self._read_topic(name)
        return self._topics[name]

    def classify(self, name: str) -> TopicClass:
        """Return what a topic is for."""
        if name not in self._classes:
            type = self.topic(name).type
            is_ros2_action = name in self._ros2_action_names
            lookup = (f"{type}ActionGoal", f"{name}/goal") if is_ros2_action else (type, name)
            self._classes[name] = self.lists.classify(*lookup)
        return self._classes[name]

    def is_motion_command(self, name: str) -> bool:
        """Tell whether a topic commands motion: a velocity, a setpoint, a trajectory."""
        topic_class = self.classify(name)
        return (
            topic_class.domain is Domain.CONTROL
            and topic_class.kind is StreamKind.COMMAND
            and topic_class.sharing is Sharing.CONTEND
            and not self.lists.ignores_topic(name)
        )

    def type_of(self, endpoint: Endpoint) -> str:
        """Return an endpoint's type; where it keeps it open, that of its topic if there is one."""
        known = _known_type(endpoint.type)
        declared = () if known else self._declared_types.get(endpoint.topic, ())
        return declared[0] if len(declared) == 1 else known

    def are_own(self, nodes: Iterable[str]) -> bool:
        """Tell whether all the nodes are the user's own."""
        return self._own_nodes.issuperset(nodes)

    def _read_topic(self, name: str) -> TopicFacts:
        publishing, subscribing = (
            self.graph_with_goals.publishers(name),
            self.graph_with_goals.subscribers(name),
        )
        written = tuple([e.type for e in publishing + subscribing])
        publishers = _distinct([e.node for e in publishing])
        acting = {e.node for e in subscribing} - self.viewers if subscribing else ()
        return TopicFacts(
            name,
            _known_types(written, self._declared_types.get(name, ())),
            publishers,
            _distinct(acting),
            self.are_own(publishers),
        )

    @cached_property
    def _ros2_action_names(self) -> frozenset[str]:
        return frozenset(self.ros2_actions)

    @cached_property
    def _own_nodes(self) -> frozenset[str]:
        return frozenset(node.name for node in self.graph.nodes if node.trust is Trust.OWN)

    @cached_property
    def _declared_types(self) -> dict[str, tuple[str, ...]]:
        topics = self.graph.topics
        return {
            t.name: tuple(filter(None, dict.fromkeys(map(_known_type, t.types)))) for t in topics
        }


def evidence_of(endpoints: Iterable[Endpoint]) -> tuple[Evidence, ...]:
    """Return where the endpoints were read, each place once."""
    return tuple(dict.fromkeys([location for e in endpoints for location in e.evidence]))


@lru_cache(4096)
def _known_type(name: str) -> str:
    """Normalise a type; `*` is what a live ROS 1 says of a subscriber that takes any."""
    return "" if name == "*" else normalise_type(name)


@lru_cache(4096)
def _known_types(written: tuple[str, ...], declared: tuple[str, ...]) -> tuple[str, ...]:
    """Return the distinct types in ROS 1 spelling: as the endpoints write them, then declared."""
    return tuple(filter(None, dict.fromkeys([*map(_known_type, written), *declared])))


def _distinct(names: Iterable[str]) -> tuple[str, ...]:
    distinct = set(names)
    return tuple(sorted(distinct) if len(distinct) > 1 else distinct)
