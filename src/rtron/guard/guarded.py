"""One stream of the plan on a transport: its inputs, its pipeline and its outputs."""

import logging
from collections.abc import Callable
from dataclasses import replace
from functools import partial

from rtron.guard.pipeline import Pipeline
from rtron.guard.transport.transport import Output, Peer, Receive, Transport
from rtron.vocabulary import (
    PRIVATE_ROOT,
    UNAPPROVED,
    Decision,
    Flow,
    Mode,
    Stream,
    StreamKind,
    flow_topic,
    names_node,
    output_topic,
)

log = logging.getLogger(__name__)

_LONGEST_NAME = 128
_MOST_STRANGERS = 32


class GuardedStream:
    """Takes what the flows say, asks the pipeline, and gives the successors what it lets go.

    Closed at both ends: an approved publisher speaks on its flow's private topic, a successor
    listens on the private output, and what arrives under the public name is `unapproved`.
    """

    def __init__(self, stream: Stream, transport: Transport) -> None:
        self.stream = _with_unapproved(stream)
        self.nodes = tuple(f"{PRIVATE_ROOT}/{stage.id}" for stage in stream.stages)
        names = [*(flow.name for flow in stream.flows), UNAPPROVED]
        self.pipeline = Pipeline(self.stream.stages, names, self._emit)
        self.owner_changed: Callable[[str | None], None] = lambda owner: None
        self.strangers: dict[str, int] = {}
        self._transport = transport
        # A late subscriber is not told an old velocity.
        self._keeps = stream.stages[0].settings.kind is not StreamKind.COMMAND
        self._armed_for: int | None = None
        self._owner: str | None = None
        self._latching: dict[str, str | None] = dict.fromkeys(names)
        self._outputs: list[Output] = []
        self._mirrors: dict[str, Output] = {}
        self._joints: list[Output] = []

    def open(self) -> None:
        """Join the graph."""
        if self.stream.mode is Mode.ENFORCE:
            self._open_outputs()
            self._open_inputs()
        self._subscribe(self.stream.topic, self._connect_public, self.stream.type)
        if self.stream.done:
            self._subscribe(self.stream.done, self._connect_done, "")

    def shut(self, why: str) -> None:
        """Let nothing through any more: a coordination node of the pipeline is gone."""
        log.error("%s: nothing passes any more: %s", self.stream.topic, why)
        self.pipeline.shut(why)
        for output in (*self._outputs, *self._mirrors.values()):
            output.forget()
        self._tell_owner()

    def _open_outputs(self) -> None:
        last, stream = self.nodes[-1], self.stream
        for topic in (output_topic(stream.topic), stream.topic):
            output = self._transport.advertise(
                last,
                topic,
                stream.type,
                queue_size=stream.queue_size,
                successors=() if topic == stream.topic else stream.successors,
            )
            self._outputs.append(output)
        for before, after, stage in zip(self.nodes, self.nodes[1:], stream.stages, strict=False):
            joint = f"{PRIVATE_ROOT}{stream.topic}/{stage.id}"
            self._joints.append(self._transport.join(before, after, joint, stream.type))

    def _open_inputs(self) -> None:
        for flow in self.stream.flows:
            topic = flow_topic(self.stream.topic, flow.name)
            self._subscribe(topic, partial(self._connect_flow, flow), self.stream.type)
            if any(names_node(flow.publisher, node) for node in self.stream.successors):
                self._mirrors[flow.name] = self._transport.advertise(
                    self.nodes[-1], topic, self.stream.type, queue_size=self.stream.queue_size
                )

    def _subscribe(self, topic: str, connect: Callable[[Peer], Receive | None], type: str) -> None:
        self._transport.subscribe(self.nodes[0], topic, type, connect)

    def _connect_flow(self, flow: Flow, peer: Peer) -> Receive | None:
        if not (peer.verified and names_node(flow.publisher, peer.node)):
            return self._stranger(peer, f"on the private topic of {flow.name}")
        if not self._learn(peer):
            return None
        self._latching[flow.name] = flow.name if peer.latching and self._keeps else None
        return partial(self._receive, flow.name)

    def _connect_public(self, peer: Peer) -> Receive | None:
        if self.stream.mode is Mode.OBSERVE:
            known = (f for f in self.stream.flows if names_node(f.publisher, peer.node))
            flow = next(known, None)
            if flow is not None:
                return partial(self._receive, flow.name)
        return self._stranger(peer, "under the public name")

    def _stranger(self, peer: Peer, where: str) -> Receive | None:
        if not self.stream.block_unapproved and not self._learn(peer):
            return None
        name = peer.node[:_LONGEST_NAME]
        if name in self.strangers or len(self.strangers) < _MOST_STRANGERS:
            self.strangers[name] = self.strangers.get(name, 0) + 1
        log.warning("%s: unapproved publisher %s %s", self.stream.topic, name, where)
        return partial(self._receive, UNAPPROVED)

    def _connect_done(self, peer: Peer) -> Receive | None:
        said_by_successor = any(names_node(each, peer.node) for each in self.stream.successors)
        return self._done if peer.verified and said_by_successor else None

    def _done(self, _message: bytes) -> None:
        now = self._transport.now()
        self.pipeline.done(now)
        self._settle(now)

    def _learn(self, peer: Peer) -> bool:
        outputs = [*self._outputs, *self._mirrors.values(), *self._joints]
        if all(output.learn(peer.info) for output in outputs):
            return True
        log.error("%s: %s has another type, %s", self.stream.topic, peer.node, peer.info.type)
        return False

    def _receive(self, flow: str, message: bytes) -> None:
        now = self._transport.now()
        decision = self.pipeline.receive(flow, message, now)
        if decision is Decision.HOLD:
            self._settle(now)
        elif self._armed_for is None:
            self._arm()
        if self.pipeline.owner != self._owner:
            self._tell_owner()

    def _emit(self, flow: str, message: bytes) -> None:
        latched_by = self._latching[flow]
        for output in self._outputs:
            output.publish(message, latched_by)
        for name, mirror in self._mirrors.items():
            if name != flow:
                mirror.publish(message, latched_by)
        for joint in self._joints:
            joint.publish(message, latched_by)

    def _settle(self, now: int) -> None:
        """Let out what is due, and be called when the next is."""
        due = self.pipeline.deadline()
        if due is not None and due <= now:
            self.pipeline.tick(now)
        self._arm()

    def _arm(self) -> None:
        """Ask to be woken for the next deadline, unless an earlier call is already due."""
        due = self.pipeline.deadline()
        if due is not None and (self._armed_for is None or due < self._armed_for):
            self._armed_for = due
            self._transport.call_at(due, self._wake)

    def _wake(self) -> None:
        self._armed_for = None
        self.pipeline.tick(self._transport.now())
        self._tell_owner()
        self._arm()

    def _tell_owner(self) -> None:
        owner = self.pipeline.owner
        if owner != self._owner:
            self._owner = owner
            self.owner_changed(owner)


def _with_unapproved(stream: Stream) -> Stream:
    """Give the unapproved flow a place behind all others where the plan lets it through."""
    if stream.block_unapproved:
        return stream
    stages = []
    for stage in stream.stages:
        least = min((flow.priority for flow in stage.settings.flows), default=0) - 1
        flow = Flow(name=UNAPPROVED, publisher="*", priority=least)
        settings = replace(stage.settings, flows=(*stage.settings.flows, flow))
        stages.append(replace(stage, settings=settings))
    return replace(stream, stages=tuple(stages))
