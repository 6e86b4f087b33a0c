"""The coordination nodes that an app has once: RSRCN and MSRCN, and the fps_monitors of the RSRCN.

Both take Block with no bit set. They enforce where a GRCN already enforces one of their topics, so
the flow is closed anyway; then they guard the topics that may be enforced by themselves. Otherwise
they observe all that they know.
"""

from collections.abc import Collection, Iterable, Iterator, Sequence
from itertools import count

from rtron.planning.app_topics import is_image
from rtron.planning.plan_file.defaults import node_id, with_distinct_ids
from rtron.planning.plan_file.fields import NODE_NAME
from rtron.planning.proposal.app_model import AppModel
from rtron.vocabulary import (
    MSRCN,
    RSRCN,
    SECOND,
    EventFlow,
    Flow,
    FpsMonitor,
    FrameSource,
    GuardedTopic,
    Mode,
    PolicyName,
    Risk,
    RiskKind,
    RiskRole,
    WatchedFlow,
    normalise_type,
    unstamped_type,
)

EVENT_PRESENCE = 2 * SECOND
_VELOCITY = "geometry_msgs/Twist"
_ModeAndTopics = tuple[Mode, tuple[GuardedTopic, ...]]


def fps_monitors(app: AppModel) -> tuple[FpsMonitor, ...]:
    """Return a monitor for each image node, on the topic that it publishes for every frame."""
    return with_distinct_ids(
        _monitor(app, node, _topic_per_frame(app, risk, node))
        for risk in app.risks(RiskRole.IMAGE)
        for node in filter(NODE_NAME.matches, risk.role_nodes[RiskRole.IMAGE])
        if any(map(app.can_guard, risk.topics))
    )


def _monitor(app: AppModel, node: str, topic: str) -> FpsMonitor:
    """Return a monitor; what it counts on a topic without images are only detections."""
    return FpsMonitor(
        id=node_id("fps", node),
        node=node,
        topic=topic,
        source=FrameSource.FRAMES if is_image(app.type_of(topic)) else FrameSource.DETECTIONS,
        camera=_camera(app, node),
    )


def _camera(app: AppModel, node: str) -> WatchedFlow | None:
    """Return the one image topic that a node hears, where one other node publishes it."""
    image_topics = {e.topic for e in app.graph.subscribed_by(node) if is_image(e.type)}
    for topic in filter(app.can_guard, image_topics) if len(image_topics) == 1 else ():
        publishers = {e.node for e in app.graph.publishers(topic)}
        if (
            len(publishers) == 1
            and publishers != {node}
            and all(map(NODE_NAME.matches, publishers))
        ):
            return WatchedFlow(name="camera", topic=topic, publisher=publishers.pop())
    return None


def propose_rsrcn(
    app: AppModel, monitors: Iterable[FpsMonitor], enforced: Collection[str]
) -> RSRCN | None:
    """Return the RSRCN, if a robot-specific risk asks for it.

    It stands before those who obey the maximal velocity; in an app that sets none, before those
    who obey the velocity itself.
    """
    if not any(risk.kind is RiskKind.RSR for risk in app.report.risks):
        return None
    limits = _topics_with_successors(app, RiskRole.MAX_VEL)
    velocities = [
        topic for topic in _topics_with_successors(app, RiskRole.ACTION) if _is_velocity(app, topic)
    ]
    mode, vflows = _guarded(app, limits or velocities, enforced, "vflow")
    return RSRCN(
        id="rsrcn",
        mode=mode,
        policy=PolicyName.BLOCK,
        vflows=vflows,
        iflows=tuple(
            WatchedFlow(name=f"iflow{number}", topic=monitor.topic, publisher=monitor.node)
            for number, monitor in enumerate(monitors, start=1)
        ),
    )


def propose_msrcn(app: AppModel, enforced: Collection[str]) -> MSRCN | None:
    """Return the MSRCN, if a mission-specific risk asks for it.

    Events are also what image nodes tell and the app acts on: they are nodes of Perception (paper
    section 4.3), even where neither type nor name of the topic says so.
    """
    if not any(risk.kind is RiskKind.MSR for risk in app.report.risks):
        return None
    mode, aflows = _guarded(app, _topics_with_successors(app, RiskRole.ACTION), enforced, "aflow")
    recognitions = (
        pair for pair in _reported_topics(app, RiskRole.IMAGE) if _is_acted_on(app, pair[0])
    )
    actions = {guarded.topic for guarded in aflows}
    reported = dict.fromkeys((*_reported_topics(app, RiskRole.EVENT), *recognitions))
    events = [(topic, node) for topic, node in reported if topic not in actions]
    return MSRCN(
        id="msrcn",
        mode=mode,
        policy=PolicyName.BLOCK,
        aflows=aflows,
        eflows=tuple(_eflow(app, f"eflow{n}", *event) for n, event in enumerate(events, start=1)),
    )


def _eflow(app: AppModel, name: str, topic: str, node: str) -> EventFlow:
    """Return an event whose bit is 1 while it is seen: what it says, only a person can judge."""
    return EventFlow(
        name=name, topic=topic, publisher=node, type=app.type_of(topic), present=EVENT_PRESENCE
    )


def _topic_per_frame(app: AppModel, risk: Risk, node: str) -> str:
    """Return a topic with an image of each frame; the recognition itself if there is none."""
    published = sorted(filter(app.can_guard, {e.topic for e in app.graph.published_by(node)}))
    images = [topic for topic in published if _is_image(app, topic)]
    best = [topic for topic in risk.topics if topic in images]
    return next(topic for topic in (*best, *images, *risk.topics) if app.can_guard(topic))


def _topics_with_successors(app: AppModel, role: RiskRole) -> list[str]:
    topics = {topic for risk in app.risks(role) for topic in risk.topics}
    obeyed = (t for t in topics if t in app.last_commands or app.successors(t))
    return sorted(filter(app.can_guard, obeyed))


def _is_velocity(app: AppModel, topic: str) -> bool:
    return unstamped_type(normalise_type(app.type_of(topic))) == _VELOCITY


def _is_image(app: AppModel, topic: str) -> bool:
    return is_image(app.type_of(topic))


def _reported_topics(app: AppModel, role: RiskRole) -> Iterator[tuple[str, str]]:
    for risk in app.risks(role):
        for topic in filter(app.can_guard, risk.topics):
            for node in filter(NODE_NAME.matches, risk.role_nodes[role]):
                yield topic, node


def _is_acted_on(app: AppModel, topic: str) -> bool:
    return bool(app.successors(topic)) and not _is_image(app, topic)


def _guarded(
    app: AppModel, topics: Sequence[str], enforced: Collection[str], prefix: str
) -> _ModeAndTopics:
    enforces = any(topic in enforced for topic in topics)
    guardable = filter(app.can_enforce, topics) if enforces else topics
    names = (f"{prefix}{number}" for number in count(1))
    guarded = tuple(_guarded_topic(app, topic, names) for topic in guardable)
    return (Mode.ENFORCE if enforces else Mode.OBSERVE), guarded


def _guarded_topic(app: AppModel, topic: str, names: Iterator[str]) -> GuardedTopic:
    return GuardedTopic(
        topic=topic,
        type=app.type_of(topic),
        flows=tuple(Flow(name=next(names), publisher=n) for n in app.publishers(topic)),
        successors=app.successors(topic),
    )
