"""Where a recorded message would have arrived in the guarded app, and from whom."""

from collections.abc import Iterator
from dataclasses import dataclass, replace

from rtron.errors import InputError
from rtron.guard.transport.common.protocol import Peer, TypeInfo
from rtron.messages.common.definition_parser import parse_definition
from rtron.messages.common.definition_registry import DefinitionRegistry
from rtron.vocabulary import (
    PRIVATE_ROOT,
    ROS1_CLIENT_TOPICS,
    ROS1_SERVER_TOPICS,
    SERVER_FLOW,
    FpsMonitor,
    Mode,
    Plan,
    Ros2ActionEntity,
    Stream,
    build_streams,
    flow_topic,
    matches_node,
    normalise_type,
    ros1_topic_name,
    ros2_entity_name,
)


@dataclass(frozen=True, slots=True, eq=False)
class RecordedStream:
    """A stream of recorded messages: a topic, its type, and its publisher where that is known.

    `md5sum` is empty where the recording has none (ROS 2), `definition` where it has no text.
    """

    topic: str
    type: str
    md5sum: str = ""
    definition: str = ""
    publisher: str = ""
    latching: bool = False


@dataclass(frozen=True, slots=True)
class RecordedStreams:
    """Finds the place of a recorded stream in the guarded app that a plan describes."""

    plan: Plan
    streams: tuple[Stream, ...]
    definitions: DefinitionRegistry

    @classmethod
    def from_plan(cls, plan: Plan) -> "RecordedStreams":
        """Return the places of a plan."""
        spelled = (replace(each, type=normalise_type(each.type)) for each in build_streams(plan))
        return cls(plan, tuple(spelled), DefinitionRegistry(plan.messages, ros=plan.ros))

    def publisher(self, recorded: RecordedStream) -> str:
        """Return who said it: as recorded, or the only one that the plan has for the topic."""
        if recorded.publisher:
            return recorded.publisher
        candidates = set(self._publishers_of(recorded.topic))
        return candidates.pop() if len(candidates) == 1 else ""

    def peer(self, recorded: RecordedStream) -> Peer:
        """Return the publisher as the guard would see it."""
        type = normalise_type(recorded.type)
        info = TypeInfo(type, self._md5sum(recorded), recorded.definition)
        return Peer(self.publisher(recorded), info, recorded.latching)

    def topic(self, recorded: RecordedStream) -> str:
        """Return the topic on which the guard would hear it; "" for what the guard said itself."""
        publisher = self.publisher(recorded)
        if publisher.startswith(PRIVATE_ROOT + "/"):
            return ""
        enforced = (stream for stream in self.streams if stream.mode is Mode.ENFORCE)
        for flow, planned_publisher in (
            each for stream in enforced for each in _flows_on(stream, recorded.topic)
        ):
            if matches_node(planned_publisher, publisher):
                return flow_topic(recorded.topic, flow)
        return recorded.topic

    def _publishers_of(self, topic: str) -> Iterator[str]:
        for stream in self.streams:
            yield from (publisher for _, publisher in _flows_on(stream, topic))
        for stream in self.streams:
            if stream.done and topic in (
                stream.done,
                ros2_entity_name(stream.done, Ros2ActionEntity.STATUS),
            ):
                yield from stream.successors
        if self.plan.msrcn:
            yield from (e.publisher for e in self.plan.msrcn.eflows if e.topic == topic)
        yield from (m.node for m in self.plan.fps_monitor if m.topic == topic)
        yield from _cameras(self.plan.fps_monitor, topic)

    def _md5sum(self, recorded: RecordedStream) -> str:
        if recorded.md5sum:
            return recorded.md5sum
        try:
            if recorded.definition:
                return parse_definition(recorded.type, recorded.definition).md5sum
            definition = self.definitions.find(recorded.type)
        except InputError:
            definition = None
        return definition.md5sum if definition else ""


def _flows_on(stream: Stream, topic: str) -> Iterator[tuple[str, str]]:
    """Yield the flows on which a stream takes a public topic, and their publishers."""
    client_topics = (
        {ros1_topic_name(stream.action, part) for part in ROS1_CLIENT_TOPICS}
        if stream.action
        else ()
    )
    server_topics = (
        {ros1_topic_name(stream.action, part) for part in ROS1_SERVER_TOPICS}
        if stream.action
        else ()
    )
    if topic == stream.topic or topic in client_topics:
        yield from ((flow.name, flow.publisher) for flow in stream.flows)
    elif topic in server_topics:
        yield from ((SERVER_FLOW, node) for node in stream.successors)


def _cameras(monitors: tuple[FpsMonitor, ...], topic: str) -> Iterator[str]:
    cameras = (monitor.camera for monitor in monitors)
    return (camera.publisher for camera in cameras if camera and camera.topic == topic)
