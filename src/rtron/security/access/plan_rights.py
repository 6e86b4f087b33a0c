"""What a plan makes of what a node does: its ends of a guarded stream move to private names."""

from collections.abc import Iterator

from rtron.security.access.rights import AccessRight, RightKind
from rtron.vocabulary import (
    Flow,
    Mode,
    Plan,
    Stream,
    build_streams,
    flow_topic,
    lease_topic,
    matches_node,
    output_topic,
)

_INTO_GUARD = (RightKind.PUBLISH, RightKind.CALL)


class PlanRights:
    """The enforced streams of a plan, and who may use which name for them."""

    def __init__(self, plan: Plan) -> None:
        self._plan = plan
        enforced = (each for each in build_streams(plan) if each.mode is Mode.ENFORCE)
        self._streams = {stream.topic: stream for stream in enforced}

    def nodes(self) -> tuple[str, ...]:
        """Return the nodes and patterns that the plan gives a right, each once."""
        return tuple(dict.fromkeys(node for node, _ in self._planned()))

    def planned(self, node: str) -> Iterator[AccessRight]:
        """Yield what the plan itself says that a node does, under public names."""
        return (right for name, right in self._planned() if matches_node(name, node))

    def lease_rights(self, node: str) -> Iterator[AccessRight]:
        """Yield the private names on which a node asks for leases and hears the answers."""
        for grcn in self._plan.grcn:
            if grcn.lease and any(matches_node(flow.publisher, node) for flow in grcn.flows):
                yield AccessRight(RightKind.PUBLISH, lease_topic(grcn.lease, "request"))
                yield AccessRight(RightKind.SUBSCRIBE, lease_topic(grcn.lease, "answer"))
                yield AccessRight(RightKind.SUBSCRIBE, lease_topic(grcn.lease, "status"))

    def granted(self, node: str, right: AccessRight) -> AccessRight | None:
        """Return what a node may do instead of what it does by itself; None if nothing.

        Nobody may publish the public name of a stream, unless the plan lets strangers through:
        the guard does. Who subscribes it without being a successor may.
        """
        stream = self._streams.get(right.name)
        if stream is None or stream.is_ros2_action != _is_of_action(right):
            return right
        flow = _flow_of(stream, node)
        if flow:
            return AccessRight(right.kind, flow_topic(stream.topic, flow.name))
        is_input = right.kind in _INTO_GUARD
        if any(matches_node(each, node) for each in stream.successors):
            return None if is_input else AccessRight(right.kind, output_topic(stream.topic))
        is_free = right.kind is RightKind.SUBSCRIBE or (is_input and not stream.block_unapproved)
        return right if is_free else None

    def _planned(self) -> Iterator[tuple[str, AccessRight]]:
        for stream in self._streams.values():
            publish, subscribe = _stream_kinds(stream)
            for flow in stream.flows:
                yield flow.publisher, AccessRight(publish, stream.topic)
            for node in stream.successors:
                yield node, AccessRight(subscribe, stream.topic)
        for topic, publisher in watched_topics(self._plan):
            yield publisher, AccessRight(RightKind.PUBLISH, topic)


def watched_topics(plan: Plan) -> Iterator[tuple[str, str]]:
    """Yield each topic that the guard only reads, with its publisher: events, frames, buttons."""
    for event in plan.msrcn.eflows if plan.msrcn else ():
        yield event.topic, event.publisher
    for frames in plan.rsrcn.iflows if plan.rsrcn else ():
        yield frames.topic, frames.publisher
    for monitor in plan.fps_monitor:
        yield monitor.topic, monitor.node
        if monitor.camera:
            yield monitor.camera.topic, monitor.camera.publisher
    for button in plan.stop_sources.buttons:
        yield button.topic, button.publisher


def _stream_kinds(stream: Stream) -> tuple[RightKind, RightKind]:
    """Return what publishers and what successors do with a stream's name."""
    if stream.is_ros2_action:
        return RightKind.CALL, RightKind.EXECUTE
    return RightKind.PUBLISH, RightKind.SUBSCRIBE


def _is_of_action(right: AccessRight) -> bool:
    return right.kind in (RightKind.CALL, RightKind.EXECUTE)


def _flow_of(stream: Stream, node: str) -> Flow | None:
    """Return a node's flow; a name goes before a pattern, as in the remaps."""
    exact = (flow for flow in stream.flows if flow.publisher == node)
    matching = (flow for flow in stream.flows if matches_node(flow.publisher, node))
    return next(exact, None) or next(matching, None)
