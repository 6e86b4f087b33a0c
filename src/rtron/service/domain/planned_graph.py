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
    endpoints = tuple(dict.fromkeys(_endpoints(plan)))
    types: dict[str, dict[str, None]] = {}
    for endpoint in endpoints:
        types.setdefault(endpoint.topic, {}).update({endpoint.type: None} if endpoint.type else {})
    return InteractionGraph(
        app=plan.app,
        ros=plan.ros,
        nodes=tuple(
            Node(name=name) for name in dict.fromkeys(endpoint.node for endpoint in endpoints)
        ),
        topics=tuple(
            Topic(name=name, types=tuple(type_names)) for name, type_names in types.items()
        ),
        endpoints=endpoints,
    )


def _endpoints(plan: Plan) -> Iterator[Endpoint]:
    for guarded in _guarded_topics(plan):
        for flow in guarded.flows:
            yield _endpoint(flow.publisher, guarded.topic, Direction.PUBLISH, guarded.type)
        for successor in guarded.successors:
            yield _endpoint(successor, guarded.topic, Direction.SUBSCRIBE, guarded.type)
    for watched, type in _watched_flows(plan):
        yield _endpoint(watched.publisher, watched.topic, Direction.PUBLISH, type)
    for monitor in plan.fps_monitor:
        yield _endpoint(monitor.node, monitor.topic, Direction.PUBLISH)
        if monitor.camera:
            yield _endpoint(monitor.camera.publisher, monitor.camera.topic, Direction.PUBLISH)
            yield _endpoint(monitor.node, monitor.camera.topic, Direction.SUBSCRIBE)


def _guarded_topics(plan: Plan) -> Iterator[GuardedTopic]:
    for grcn in plan.grcn:
        yield GuardedTopic(
            topic=grcn.topic, type=grcn.type, flows=grcn.flows, successors=grcn.successors
        )
    yield from plan.rsrcn.vflows if plan.rsrcn else ()
    yield from plan.msrcn.aflows if plan.msrcn else ()


def _watched_flows(plan: Plan) -> Iterator[tuple[WatchedFlow, str]]:
    yield from ((flow, "") for flow in plan.rsrcn.iflows) if plan.rsrcn else ()
    for flow in plan.msrcn.eflows if plan.msrcn else ():
        watched = WatchedFlow(name=flow.name, topic=flow.topic, publisher=flow.publisher)
        yield watched, flow.type


def _endpoint(node: str, topic: str, direction: Direction, type: str = "") -> Endpoint:
    return Endpoint(
        node=node,
        topic=topic,
        direction=direction,
        type=type,
        declared_name=topic,
        resolution=Resolution.LITERAL,
    )
