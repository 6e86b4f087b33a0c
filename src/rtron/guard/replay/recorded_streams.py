"""Where a recorded message would have arrived in the guarded app, and from whom."""

from collections.abc import Iterator
from dataclasses import dataclass, replace

from rtron.errors import InputError
from rtron.guard.transport.common.protocol import Peer, TypeInfo
from rtron.messages.common.definition_parser import parse_definition
from rtron.messages.common.definition_registry import Definitions
from rtron.vocabulary import (
    ANSWERED,
    ASKED,
    PRIVATE_ROOT,
    SERVER,
    ActionEnd,
    FpsMonitor,
    Mode,
    Plan,
    Stream,
    end_name,
    flow_topic,
    names_node,
    normalise_type,
    part_topic,
    streams,
)


@dataclass(frozen=True, slots=True, eq=False)
class Recorded:
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
class Places:
    """Finds the place of a recorded stream in the guarded app that a plan describes."""

    plan: Plan
    streams: tuple[Stream, ...]
    definitions: Definitions

    @classmethod
    def of(cls, plan: Plan) -> "Places":
        """Return the places of a plan."""
        spelled = (replace(each, type=normalise_type(each.type)) for each in streams(plan))
        return cls(plan, tuple(spelled), Definitions(plan.messages, ros=plan.ros))

    def publisher(self, recorded: Recorded) -> str:
        """Return who said it: as recorded, or the only one that the plan has for the topic."""
        if recorded.publisher:
            return recorded.publisher
        named = set(self._named(recorded.topic))
        return named.pop() if len(named) == 1 else ""

    def peer(self, recorded: Recorded) -> Peer:
        """Return the publisher as the guard would see it."""
        type = normalise_type(recorded.type)
        info = TypeInfo(type, self._md5sum(recorded), recorded.definition)
        return Peer(self.publisher(recorded), info, recorded.latching)

    def topic(self, recorded: Recorded) -> str:
        """Return the topic on which the guard would hear it; "" for what the guard said itself."""
        publisher = self.publisher(recorded)
        if publisher.startswith(PRIVATE_ROOT + "/"):
            return ""
        enforced = (stream for stream in self.streams if stream.mode is Mode.ENFORCE)
        for flow, named in (each for stream in enforced for each in _ways(stream, recorded.topic)):
            if names_node(named, publisher):
                return flow_topic(recorded.topic, flow)
        return recorded.topic

    def _named(self, topic: str) -> Iterator[str]:
        for stream in self.streams:
            yield from (named for _, named in _ways(stream, topic))
        for stream in self.streams:
            if stream.done and topic in (stream.done, end_name(stream.done, ActionEnd.STATUS)):
                yield from stream.successors
        if self.plan.msrcn:
            yield from (e.publisher for e in self.plan.msrcn.eflows if e.topic == topic)
        yield from (m.node for m in self.plan.fps_monitor if m.topic == topic)
        yield from _cameras(self.plan.fps_monitor, topic)

    def _md5sum(self, recorded: Recorded) -> str:
        if recorded.md5sum:
            return recorded.md5sum
        try:
            if recorded.definition:
                return parse_definition(recorded.type, recorded.definition).md5sum
            known = self.definitions.find(recorded.type)
        except InputError:
            known = None
        return known.md5sum if known else ""


def _ways(stream: Stream, topic: str) -> Iterator[tuple[str, str]]:
    """Yield the flows on which a stream takes a public topic, and their publishers."""
    asked = {part_topic(stream.action, part) for part in ASKED} if stream.action else ()
    answered = {part_topic(stream.action, part) for part in ANSWERED} if stream.action else ()
    if topic == stream.topic or topic in asked:
        yield from ((flow.name, flow.publisher) for flow in stream.flows)
    elif topic in answered:
        yield from ((SERVER, node) for node in stream.successors)


def _cameras(monitors: tuple[FpsMonitor, ...], topic: str) -> Iterator[str]:
    cameras = (monitor.camera for monitor in monitors)
    return (camera.publisher for camera in cameras if camera and camera.topic == topic)
