"""The coordination nodes that an app has once: RSRCN and MSRCN, and the fps_monitors of the RSRCN.

Both take Block with no bit set. They enforce where a GRCN already enforces one of their topics, so
the flow is closed anyway; then they guard the topics that may be enforced by themselves. Otherwise
they observe all that they know.
"""

from collections.abc import Collection, Iterable, Iterator, Sequence
from itertools import count

from rtron.planning.frames import is_image
from rtron.planning.plan_file.defaults import node_id, with_distinct_ids
from rtron.planning.plan_file.fields import NODE
from rtron.planning.proposal.app_model import Site
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
    Role,
    WatchedFlow,
    normalise_type,
    without_stamp,
)

SEEN = 2 * SECOND
_VELOCITY = "geometry_msgs/Twist"
_Guarded = tuple[Mode, tuple[GuardedTopic, ...]]


def fps_monitors(site: Site) -> tuple[FpsMonitor, ...]:
    """Return a monitor for each image node, on the topic that it publishes for every frame."""
    return with_distinct_ids(
        _monitor(site, node, _per_frame(site, risk, node))
        for risk in site.risks(Role.IMAGE)
        for node in filter(NODE.fits, risk.role_nodes[Role.IMAGE])
        if any(map(site.can_guard, risk.topics))
    )


def _monitor(site: Site, node: str, topic: str) -> FpsMonitor:
    """Return a monitor; what it counts on a topic without images are only detections."""
    return FpsMonitor(
        id=node_id("fps", node),
        node=node,
        topic=topic,
        source=FrameSource.FRAMES if is_image(site.type_of(topic)) else FrameSource.DETECTIONS,
        camera=_camera(site, node),
    )


def _camera(site: Site, node: str) -> WatchedFlow | None:
    """Return the one image topic that a node hears, where one other node publishes it."""
    heard = {e.topic for e in site.graph.subscribed_by(node) if is_image(e.type)}
    for topic in filter(site.can_guard, heard) if len(heard) == 1 else ():
        publishers = {e.node for e in site.graph.publishers(topic)}
        if len(publishers) == 1 and publishers != {node} and all(map(NODE.fits, publishers)):
            return WatchedFlow(name="camera", topic=topic, publisher=publishers.pop())
    return None


def propose_rsrcn(
    site: Site, monitors: Iterable[FpsMonitor], enforced: Collection[str]
) -> RSRCN | None:
    """Return the RSRCN, if a robot-specific risk asks for it.

    It stands before those who obey the maximal velocity; in an app that sets none, before those
    who obey the velocity itself.
    """
    if not any(risk.kind is RiskKind.RSR for risk in site.report.risks):
        return None
    limits = _obeyed(site, Role.MAX_VEL)
    velocities = [topic for topic in _obeyed(site, Role.ACTION) if _is_velocity(site, topic)]
    mode, vflows = _guarded(site, limits or velocities, enforced, "vflow")
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


def propose_msrcn(site: Site, enforced: Collection[str]) -> MSRCN | None:
    """Return the MSRCN, if a mission-specific risk asks for it.

    Events are also what image nodes tell and the app acts on: they are nodes of Perception (paper
    section 4.3), even where neither type nor name of the topic says so.
    """
    if not any(risk.kind is RiskKind.MSR for risk in site.report.risks):
        return None
    mode, aflows = _guarded(site, _obeyed(site, Role.ACTION), enforced, "aflow")
    recognised = (pair for pair in _told(site, Role.IMAGE) if _is_acted_on(site, pair[0]))
    actions = {guarded.topic for guarded in aflows}
    told = dict.fromkeys((*_told(site, Role.EVENT), *recognised))
    events = [(topic, node) for topic, node in told if topic not in actions]
    return MSRCN(
        id="msrcn",
        mode=mode,
        policy=PolicyName.BLOCK,
        aflows=aflows,
        eflows=tuple(_eflow(site, f"eflow{n}", *event) for n, event in enumerate(events, start=1)),
    )


def _eflow(site: Site, name: str, topic: str, node: str) -> EventFlow:
    """Return an event whose bit is 1 while it is seen: what it says, only a person can judge."""
    return EventFlow(name=name, topic=topic, publisher=node, type=site.type_of(topic), present=SEEN)


def _per_frame(site: Site, risk: Risk, node: str) -> str:
    """Return a topic with an image of each frame; the recognition itself if there is none."""
    published = sorted(filter(site.can_guard, {e.topic for e in site.graph.published_by(node)}))
    images = [topic for topic in published if _is_image(site, topic)]
    best = [topic for topic in risk.topics if topic in images]
    return next(topic for topic in (*best, *images, *risk.topics) if site.can_guard(topic))


def _obeyed(site: Site, role: Role) -> list[str]:
    topics = {topic for risk in site.risks(role) for topic in risk.topics}
    return sorted(topic for topic in topics if site.can_guard(topic) and site.successors(topic))


def _is_velocity(site: Site, topic: str) -> bool:
    return without_stamp(normalise_type(site.type_of(topic))) == _VELOCITY


def _is_image(site: Site, topic: str) -> bool:
    return is_image(site.type_of(topic))


def _told(site: Site, role: Role) -> Iterator[tuple[str, str]]:
    for risk in site.risks(role):
        for topic in filter(site.can_guard, risk.topics):
            for node in filter(NODE.fits, risk.role_nodes[role]):
                yield topic, node


def _is_acted_on(site: Site, topic: str) -> bool:
    return bool(site.successors(topic)) and not _is_image(site, topic)


def _guarded(site: Site, topics: Sequence[str], enforced: Collection[str], prefix: str) -> _Guarded:
    enforces = any(topic in enforced for topic in topics)
    kept = filter(site.can_enforce, topics) if enforces else topics
    names = (f"{prefix}{number}" for number in count(1))
    guarded = tuple(_guarded_topic(site, topic, names) for topic in kept)
    return (Mode.ENFORCE if enforces else Mode.OBSERVE), guarded


def _guarded_topic(site: Site, topic: str, names: Iterator[str]) -> GuardedTopic:
    return GuardedTopic(
        topic=topic,
        type=site.type_of(topic),
        flows=tuple(Flow(name=next(names), publisher=n) for n in site.publishers(topic)),
        successors=site.successors(topic),
    )
