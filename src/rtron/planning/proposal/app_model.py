"""The app that a plan is made for: a graph and its risks, with the answers that planning needs."""

from collections.abc import Collection, Iterator, Mapping
from dataclasses import dataclass, field
from functools import cached_property

from rtron.messages.common.definition_registry import DefinitionRegistry
from rtron.planning.app_topics import action_servers, action_topics, all_topics
from rtron.planning.command_sources import CommandSources
from rtron.planning.plan_file.fields import NODE_NAME, TOPIC_NAME, TYPE_NAME
from rtron.vocabulary import (
    Domain,
    InteractionGraph,
    Risk,
    RiskReport,
    RiskRole,
    Ros1ActionTopic,
    Sharing,
    StreamKind,
    TopicClass,
    action_name,
    is_action_type,
    ros1_topic_name,
    with_goal_topics,
)

_MOVING = (Domain.PLANNING, Domain.CONTROL)


@dataclass(frozen=True)
class AppModel:
    """A graph and the report on it; the goals of ROS 2's actions are topics here, too.

    `last_commands` and `measured` are those of `propose_plan`.
    """

    graph: InteractionGraph
    report: RiskReport
    last_commands: Mapping[str, tuple[str, ...]] = field(default_factory=dict)
    measured: Collection[str] = ()

    @staticmethod
    def from_graph(
        graph: InteractionGraph,
        report: RiskReport,
        last_commands: Mapping[str, tuple[str, ...]],
        measured: Collection[str] = (),
    ) -> "AppModel":
        """Return the site of a graph as it was read."""
        return AppModel(with_goal_topics(graph), report, last_commands, measured)

    @cached_property
    def viewers(self) -> frozenset[str]:
        """The nodes that only record or show what they subscribe."""
        return frozenset(self.report.viewers)

    @cached_property
    def definitions(self) -> DefinitionRegistry:
        """The message types that are known here."""
        return DefinitionRegistry(ros=self.graph.ros)

    @cached_property
    def action_parts(self) -> frozenset[str]:
        """The topics that belong to an action."""
        return action_topics(self.graph)

    @cached_property
    def servers(self) -> dict[str, tuple[str, ...]]:
        """The nodes that serve actions."""
        return action_servers(self.graph)

    @cached_property
    def topics(self) -> frozenset[str]:
        """The topics of the graph."""
        return all_topics(self.graph)

    @cached_property
    def ros2_actions(self) -> frozenset[str]:
        """The actions whose goals are requests."""
        action_names = frozenset(action.name for action in self.graph.actions)
        return action_names if self.graph.ros != 1 else frozenset()

    def risks(self, role: RiskRole) -> Iterator[Risk]:
        """Yield the risks in which nodes play a role."""
        return (risk for risk in self.report.risks if role in risk.role_nodes)

    def goal_topic_of(self, topic: str) -> str:
        """Return the goal topic of the action that a topic belongs to, or nothing.

        Only where the type of the goals is known can the action be guarded as a whole.
        """
        goal = f"{topic.rpartition('/')[0]}/{Ros1ActionTopic.GOAL}"
        is_guardable = topic in self.action_parts and self.can_guard(goal)
        return goal if is_guardable and action_name(goal, self.type_of(goal)) else ""

    def publishers(self, topic: str) -> list[str]:
        """Return the nodes that publish a topic, the one that goes first at the front.

        Who cancels goals publishes them too: both are one way to the server.
        """
        nodes = {e.node for name in self._client_topics(topic) for e in self.graph.publishers(name)}
        return self._sources.sort(filter(NODE_NAME.matches, nodes))

    def successors(self, topic: str) -> tuple[str, ...]:
        """Return the nodes that the output goes to.

        A viewer gets it on the public name, unless it publishes the topic too: a remap then moves
        both its ends. A node that was not read may obey a last command: a remap of a name that it
        does not use does nothing.
        """
        publishers = self.publishers(topic)
        viewers_only = self.viewers.difference(publishers)
        nodes = {e.node for e in self.graph.subscribers(topic)} - viewers_only
        nodes |= set(self.last_commands.get(topic, ())).difference(publishers)
        return tuple(sorted(filter(NODE_NAME.matches, nodes)))

    def moves(self, topic: str) -> bool:
        """Tell whether a topic moves the robot, and more than parts of one process or stack."""
        nodes = {*self.publishers(topic), *self.successors(topic)}
        is_moving = self.classify(topic).domain in _MOVING and not self._sources.is_internal(nodes)
        return topic in self.last_commands or (is_moving and topic not in self.measured)

    def type_of(self, topic: str) -> str:
        """Return the type that the publishers use, or else the subscribers."""
        endpoints = (*self.graph.publishers(topic), *self.graph.subscribers(topic))
        return next((e.type for e in endpoints if TYPE_NAME.matches(e.type) and e.type), "")

    def classify(self, topic: str) -> TopicClass:
        """Return what the report says that a topic is for; a last command moves the robot."""
        known = self.report.topic_classes.get(topic, TopicClass())
        if topic in self.last_commands and known.domain not in _MOVING:
            return TopicClass(domain=Domain.CONTROL, kind=StreamKind.COMMAND)
        return known

    def is_shared_channel(self, topic: str) -> bool:
        """Tell whether several nodes may send frames of their own, so that none is to end others.

        So it may be where a driver alone says that a topic commands, and neither type nor name.
        """
        known = self.report.topic_classes.get(topic, TopicClass())
        is_known_by_driver = topic in self.last_commands and known.domain not in _MOVING
        return is_known_by_driver and len(self.publishers(topic)) > 1

    def can_guard(self, topic: str) -> bool:
        """Tell whether a topic is one of the graph and its name is wholly known.

        Of an action of ROS 2 the type must be known, too: services have it in their names.
        """
        is_known = topic not in self.ros2_actions or is_action_type(self.type_of(topic))
        return is_known and topic in self.topics and TOPIC_NAME.matches(topic)

    def can_enforce(self, topic: str) -> bool:
        """Tell whether standing in a topic's flow is a sound default.

        Only contending topics of Planning and Control; an action as a whole, by its goals; and
        only where nodes are known to publish and to listen, each by its whole name, since whom the
        plan does not name is stopped. A last command counts though one of the two is not known: the
        guard decides what leaves the app, and keeps out whoever is not in the plan.
        """
        topic_class = self.classify(topic)
        is_action_part = topic in self.action_parts and topic != self.goal_topic_of(topic)
        if (
            topic_class.domain not in _MOVING
            or topic_class.sharing is Sharing.MERGE
            or is_action_part
            or (topic in self.measured and topic not in self.last_commands)
        ):
            return False
        endpoints = (e for name in self._client_topics(topic) for e in self.graph.publishers(name))
        are_named = all(NODE_NAME.matches(e.node) for e in endpoints)
        is_last = topic in self.last_commands
        return are_named and (is_last or bool(self.publishers(topic) and self.successors(topic)))

    def _client_topics(self, topic: str) -> tuple[str, ...]:
        """Return the topic, with that of the cancels if it is an action's goals."""
        if not topic or topic != self.goal_topic_of(topic):
            return (topic,)
        return (topic, ros1_topic_name(topic.rpartition("/")[0], Ros1ActionTopic.CANCEL))

    @cached_property
    def _sources(self) -> CommandSources:
        return CommandSources(self.graph, self.servers, self.viewers)
