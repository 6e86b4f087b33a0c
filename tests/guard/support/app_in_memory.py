"""A guarded app in memory that is spoken to in whole messages, written by rosbags."""

from functools import cache

from rosbags.typesys import Stores, get_typestore

from rtron.guard.coordinator import Coordinator
from rtron.guard.core.observations import observations_of
from rtron.guard.transport.common.memory import MemoryTransport
from rtron.guard.transport.common.protocol import Peer, TypeInfo
from rtron.messages.common.encoding import Encoding
from rtron.vocabulary import build_streams, flow_topic, output_topic


@cache
def _store():
    return get_typestore(Stores.ROS1_NOETIC)


def made(type, **fields):
    """Return a message object; what is not given is zero, empty or as `made` says."""
    name = type.replace("/", "/msg/")
    given = {key: fields.pop(key) for key in list(fields)}
    return _store().types[name](**{**_zeros(name), **given})


def _zeros(name):
    return {field: _zero(node) for field, node in _store().fielddefs[name][1]}


def _zero(node):
    kind, detail = node
    if kind.name == "BASE":
        return {"string": "", "bool": False}.get(detail[0], 0.0 if "float" in detail[0] else 0)
    if kind.name == "NAME":
        return _store().types[detail](**_zeros(detail))
    (item, of), length = detail
    if item.name == "BASE" and of[0] != "string":
        import numpy as np  # noqa: PLC0415 - comes with rosbags

        return np.zeros(length, dtype=of[0])
    return []


def written(type, message):
    """Return a message's bytes as ROS 1 frames them."""
    raw = bytes(_store().serialize_ros1(message, type.replace("/", "/msg/")))
    return Encoding.ROS1.prefix(len(raw)) + raw


@cache
def info(type):
    text, md5sum = _store().generate_msgdef(type.replace("/", "/msg/"), ros_version=1)
    return TypeInfo(type, md5sum, text)


class App:
    """The guard of a plan, with the publishers that the plan names."""

    def __init__(self, plan):
        self.transport = MemoryTransport()
        self.host = Coordinator(self.transport, build_streams(plan), observations_of(plan))
        self.host.open()
        self.plan = plan
        self._says = {}

    def event(self, topic, **fields):
        """Let an event's publisher say something."""
        flow = next(flow for flow in self.plan.msrcn.eflows if flow.topic == topic)
        self._say(topic, flow.publisher, flow.type, fields)
        self.transport.advance(0)

    def act(self, flow_name, **fields):
        """Let an action's publisher say something; tell whether it got through unchanged."""
        topic, flow = next(
            (topic, flow)
            for topic in self.plan.msrcn.aflows
            for flow in topic.flows
            if flow.name == flow_name
        )
        heard = self.transport.listen(output_topic(topic.topic))
        place = flow_topic(topic.topic, flow.name)
        message = self._say(place, flow.publisher, topic.type, fields)
        return message in heard

    def reason(self, flow_name):
        """Return the newest verdict's reason on a flow."""
        tallies = [each.pipeline.tallies for each in self.host.streams]
        return next(tally[flow_name].last.reason for tally in tallies if flow_name in tally)

    def _say(self, topic, publisher, type, fields):
        if topic not in self._says:
            peer = Peer(publisher, info(type))
            self._says[topic] = self.transport.publisher(topic, peer)
        message = written(type, made(type, **fields))
        self._says[topic](message)
        return message
