"""The interaction graph of an app as its plan tells it, where nobody has uploaded another."""

from collections.abc import Iterator

from rtron.vocabulary import (
    Direction,
    Endpoint,
    GuardedTopic,
    InteractionGraph,
    Node,
    Plan,
    Resolution,
    Topic,
    WatchedFlow,
)


def planned_graph(plan: Plan) -> InteractionGraph:
    """Return the part of the app that its plan names: publishers, topics and successors."""
    ends = tuple(dict.fromkeys(_ends(plan)))
    types: dict[str, dict[str, None]] = {}
    for end in ends:
        types.setdefault(end.topic, {}).update({end.type: None} if end.type else {})
    return InteractionGraph(
        app=plan.app,
        ros=plan.ros,
        nodes=tuple(Node(name=name) for name in dict.fromkeys(end.node for end in ends)),
        topics=tuple(Topic(name=name, types=tuple(known)) for name, known in types.items()),
        endpoints=ends,
    )


def _ends(plan: Plan) -> Iterator[Endpoint]:
    for guarded in _guarded(plan):
        for flow in guarded.flows:
            yield _end(flow.publisher, guarded.topic, Direction.PUBLISH, guarded.type)
        for successor in guarded.successors:
            yield _end(successor, guarded.topic, Direction.SUBSCRIBE, guarded.type)
    for watched, type in _watched(plan):
        yield _end(watched.publisher, watched.topic, Direction.PUBLISH, type)
    for monitor in plan.fps_monitor:
        yield _end(monitor.node, monitor.topic, Direction.PUBLISH)
        if monitor.camera:
            yield _end(monitor.camera.publisher, monitor.camera.topic, Direction.PUBLISH)
            yield _end(monitor.node, monitor.camera.topic, Direction.SUBSCRIBE)


def _guarded(plan: Plan) -> Iterator[GuardedTopic]:
    for grcn in plan.grcn:
        yield GuardedTopic(
            topic=grcn.topic, type=grcn.type, flows=grcn.flows, successors=grcn.successors
        )
    yield from plan.rsrcn.vflows if plan.rsrcn else ()
    yield from plan.msrcn.aflows if plan.msrcn else ()


def _watched(plan: Plan) -> Iterator[tuple[WatchedFlow, str]]:
    yield from ((flow, "") for flow in plan.rsrcn.iflows) if plan.rsrcn else ()
    for flow in plan.msrcn.eflows if plan.msrcn else ():
        one = WatchedFlow(name=flow.name, topic=flow.topic, publisher=flow.publisher)
        yield one, flow.type


def _end(node: str, topic: str, direction: Direction, type: str = "") -> Endpoint:
    return Endpoint(
        node=node,
        topic=topic,
        direction=direction,
        type=type,
        declared_name=topic,
        resolution=Resolution.LITERAL,
    )
