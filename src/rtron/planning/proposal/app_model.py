"""The app that a plan is made for: a graph and its risks, with the answers that planning needs."""

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property

from rtron.planning.app_topics import action_servers, action_topics, topics_of
from rtron.planning.plan_file.fields import NODE, TOPIC, TYPE
from rtron.planning.proposal.publisher_ranking import Ranking
from rtron.vocabulary import (
    ActionPart,
    Domain,
    InteractionGraph,
    Risk,
    RiskReport,
    Role,
    Sharing,
    TopicClass,
    action_of,
    is_action_type,
    part_topic,
    with_goals,
)


@dataclass(frozen=True)
class Site:
    """A graph and the report on it; the goals of ROS 2's actions are topics here, too."""

    graph: InteractionGraph
    report: RiskReport

    @staticmethod
    def of(graph: InteractionGraph, report: RiskReport) -> "Site":
        """Return the site of a graph as it was read."""
        return Site(with_goals(graph), report)

    @cached_property
    def viewers(self) -> frozenset[str]:
        """The nodes that only record or show what they subscribe."""
        return frozenset(self.report.viewers)

    @cached_property
    def actions(self) -> frozenset[str]:
        """The topics that belong to an action."""
        return action_topics(self.graph)

    @cached_property
    def servers(self) -> dict[str, tuple[str, ...]]:
        """The nodes that serve actions."""
        return action_servers(self.graph)

    @cached_property
    def topics(self) -> frozenset[str]:
        """The topics of the graph."""
        return topics_of(self.graph)

    @cached_property
    def requested(self) -> frozenset[str]:
        """The actions whose goals are requests."""
        named = frozenset(action.name for action in self.graph.actions)
        return named if self.graph.ros != 1 else frozenset()

    def risks(self, role: Role) -> Iterator[Risk]:
        """Yield the risks in which nodes play a role."""
        return (risk for risk in self.report.risks if role in risk.role_nodes)

    def goal_of(self, topic: str) -> str:
        """Return the goal topic of the action that a topic belongs to, or nothing.

        Only where the type of the goals is known can the action be guarded as a whole.
        """
        goal = f"{topic.rpartition('/')[0]}/{ActionPart.GOAL}"
        whole = topic in self.actions and self.can_guard(goal)
        return goal if whole and action_of(goal, self.type_of(goal)) else ""

    def publishers(self, topic: str) -> list[str]:
        """Return the nodes that publish a topic, the one that goes first at the front.

        Who cancels goals publishes them too: both are one way to the server.
        """
        nodes = {e.node for name in self._asked(topic) for e in self.graph.publishers(name)}
        return self._ranking.ordered(filter(NODE.fits, nodes))

    def successors(self, topic: str) -> tuple[str, ...]:
        """Return the nodes that the output goes to.

        A viewer gets it on the public name, unless it publishes the topic too: a remap then moves
        both its ends.
        """
        bystanders = self.viewers.difference(self.publishers(topic))
        nodes = {e.node for e in self.graph.subscribers(topic)} - bystanders
        return tuple(sorted(filter(NODE.fits, nodes)))

    def type_of(self, topic: str) -> str:
        """Return the type that the publishers use, or else the subscribers."""
        ends = (*self.graph.publishers(topic), *self.graph.subscribers(topic))
        return next((e.type for e in ends if TYPE.fits(e.type) and e.type), "")

    def classify(self, topic: str) -> TopicClass:
        """Return what the report says that a topic is for."""
        return self.report.topic_classes.get(topic, TopicClass())

    def can_guard(self, topic: str) -> bool:
        """Tell whether a topic is one of the graph and its name is wholly known.

        Of an action of ROS 2 the type must be known, too: services have it in their names.
        """
        known = topic not in self.requested or is_action_type(self.type_of(topic))
        return known and topic in self.topics and TOPIC.fits(topic)

    def can_enforce(self, topic: str) -> bool:
        """Tell whether standing in a topic's flow is a sound default.

        Only contending topics of Planning and Control; an action as a whole, by its goals; and
        only where nodes are known to publish and to listen, each by its whole name, since whom the
        plan does not name is stopped.
        """
        found = self.classify(topic)
        moves = found.domain in (Domain.PLANNING, Domain.CONTROL)
        part = topic in self.actions and topic != self.goal_of(topic)
        if not moves or found.sharing is Sharing.MERGE or part:
            return False
        asking = (e for name in self._asked(topic) for e in self.graph.publishers(name))
        named = all(NODE.fits(e.node) for e in asking)
        return named and bool(self.publishers(topic) and self.successors(topic))

    def _asked(self, topic: str) -> tuple[str, ...]:
        """Return the topic, with that of the cancels if it is an action's goals."""
        if not topic or topic != self.goal_of(topic):
            return (topic,)
        return (topic, part_topic(topic.rpartition("/")[0], ActionPart.CANCEL))

    @cached_property
    def _ranking(self) -> Ranking:
        nodes = {node.name: node for node in self.graph.nodes}
        return Ranking(self.graph, self.servers, self.viewers, nodes)
