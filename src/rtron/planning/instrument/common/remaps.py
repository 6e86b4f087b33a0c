"""Which remaps close the plan's enforced topics at both ends (paper section 5.1)."""

import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass

from rtron.errors import PlanError
from rtron.planning.instrument.common.guarded_launch import PlacedRemap
from rtron.planning.instrument.common.nodelets import manager_of
from rtron.vocabulary import (
    ANSWERED,
    ASKED,
    SERVER,
    ActionEnd,
    Flow,
    LaunchNode,
    LaunchTree,
    Mode,
    Plan,
    Stream,
    end_name,
    flow_topic,
    is_action_type,
    names_node,
    output_topic,
    part_topic,
    streams,
)

_LEGAL_TOPIC = re.compile(r"(/[A-Za-z]\w*)+")


@dataclass(frozen=True, slots=True, kw_only=True)
class Side:
    """A node's part in a stream: the flow it publishes, if any, and whether it is a successor."""

    stream: Stream
    flow: Flow | None
    follows: bool

    @property
    def private(self) -> Mapping[str, str]:
        """The private topics that the node's ends of the stream are moved to, by the public ones.

        A node that publishes and follows has one name for both: the guard serves it on its flow.
        An action of ROS 2 moves by its services and topics, below the action's private name.
        """
        action = self.stream.action
        if is_action_type(self.stream.type):
            private = self._asked(action)
            return {end_name(action, end): end_name(private, end) for end in ActionEnd}
        asked = [part_topic(action, part) for part in ASKED] if action else [self.stream.topic]
        answered = [part_topic(action, part) for part in ANSWERED] if action else []
        return {
            **{topic: self._asked(topic) for topic in asked},
            **{topic: self._answered(topic) for topic in answered},
        }

    def _asked(self, topic: str) -> str:
        return flow_topic(topic, self.flow.name) if self.flow else output_topic(topic)

    def _answered(self, topic: str) -> str:
        return flow_topic(topic, SERVER) if self.follows else output_topic(topic)


Wiring = Mapping[LaunchNode, tuple[PlacedRemap, ...]]
"""The remaps that each node should get."""


def enforced_streams(plan: Plan) -> tuple[Stream, ...]:
    """Return the streams that the guard stands in; raise PlanError for an illegal topic."""
    enforced = tuple(stream for stream in streams(plan) if stream.mode is Mode.ENFORCE)
    for stream in enforced:
        for topic in (stream.topic, *(flow_topic(stream.topic, f.name) for f in stream.flows)):
            if not _LEGAL_TOPIC.fullmatch(topic):
                raise PlanError(f"'{topic}' is no name that a topic can have")
    return enforced


def wire(tree: LaunchTree, enforced: tuple[Stream, ...]) -> Wiring:
    """Return the remaps to place on each launched node that has a side in an enforced stream."""
    sides = {node: tuple(_sides(node, enforced)) for node in tree.nodes()}
    return {node: tuple(_remaps(node, found)) for node, found in sides.items() if found}


def names_of(stream: Stream) -> frozenset[str]:
    """Return the names that nodes have for a stream: its topic, or all of an action of ROS 2."""
    if is_action_type(stream.type):
        return frozenset(end_name(stream.action, end) for end in ActionEnd)
    return frozenset({stream.topic})


def side_of(node: LaunchNode, stream: Stream) -> Side | None:
    """Return a launched node's side in a stream.

    The topics of a nodelet appear under its manager: a loader that the plan does not name itself
    has its manager's side.
    """
    manager = manager_of(node)
    return _side(node.name, stream) or (_side(manager, stream) if manager else None)


def private_names(name: str, enforced: tuple[Stream, ...]) -> Mapping[str, str]:
    """Return all private names of a node by the public ones; `name` is as in a plan."""
    sides = filter(None, (_side(name, stream) for stream in enforced))
    return {public: private for side in sides for public, private in side.private.items()}


def _sides(node: LaunchNode, enforced: tuple[Stream, ...]) -> Iterator[Side]:
    return filter(None, (side_of(node, stream) for stream in enforced))


def _side(name: str, stream: Stream) -> Side | None:
    exact = (flow for flow in stream.flows if flow.publisher == name)
    alike = (flow for flow in stream.flows if names_node(flow.publisher, name))
    flow = next(exact, None) or next(alike, None)
    follows = any(names_node(successor, name) for successor in stream.successors)
    return Side(stream=stream, flow=flow, follows=follows) if flow or follows else None


def _remaps(node: LaunchNode, sides: tuple[Side, ...]) -> Iterator[PlacedRemap]:
    """Yield the remaps that take a node from public topics to its private ones.

    Remaps do not chain: one that leads to the public topic gets another target, under its own
    spelling, so that it is replaced; so are others of the same name, for which of two spellings
    counts depends on their order. A topic that the node's own remap takes elsewhere is left.
    """
    private = {topic: name for side in sides for topic, name in side.private.items()}
    taken = {remap.declared for remap in node.remaps}
    replaced = {remap.declared for remap in node.remaps if remap.target in private}
    for remap in node.remaps:
        if remap.declared in replaced:
            target = private.get(remap.target, remap.written_target)
            yield PlacedRemap(
                node=node.name, topic=remap.target, written=remap.written, target=target
            )
    for topic in (topic for topic in private if topic not in taken):
        yield PlacedRemap(node=node.name, topic=topic, written=topic, target=private[topic])
