"""One audit of a ROS 2 domain as a result: every planned path, and who is there beside it.

Pure. From outside nobody can prove which of two participants is the guard; it is taken to be the
one with most of the guard's endpoints, and that there are two is told.
"""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass
from typing import TYPE_CHECKING

from rtron.guard.audit.ros1.expected_graph import Entrance, meant
from rtron.guard.audit.ros1.verification import Path, PathState, Verification
from rtron.guard.audit.ros2.endpoint_checks import (
    Participants,
    deaf,
    foreign,
    heard_by,
    named,
    place,
    strays,
    unfit,
    unplanned_listeners,
)
from rtron.guard.audit.ros2.expected_graph import Wanted
from rtron.guard.audit.ros2.unguarded_interfaces import unguarded
from rtron.guard.supervision.guard_config import stopped_streams
from rtron.vocabulary import GUARD_NODE, SUPERVISOR_NODE

if TYPE_CHECKING:
    from collections.abc import Iterator

    from rtron.guard.audit.ros2.observed_graph import Seen
    from rtron.vocabulary import Plan, PlannedTopic
    from rtron.wire.ros2.endpoints import Ros2Endpoint

_NO_NAME = "somebody listens whose node the domain does not name"


@dataclass(frozen=True, slots=True)
class _Scene:
    """What is compared: the plan and the domain, the guard's participants in it, and doubles.

    `brakes` tells whether the supervisor stops anything: only then it has a node of its own.
    """

    wanted: Wanted
    seen: Seen
    ours: Participants
    doubles: dict[str, frozenset[bytes]]
    brakes: bool


def verify_ros2(plan: Plan, seen: Seen) -> Verification:
    """Compare what is in a domain with what the plan says."""
    wanted = Wanted(plan)
    brakes = bool(stopped_streams(plan))
    scene = _Scene(wanted, seen, ours_in(wanted, seen), doubles_in(seen), brakes)
    return Verification(
        paths=(*_exits(scene), *_entrances(scene)),
        problems=tuple(_problems(scene)),
        unguarded=tuple(unguarded(plan, wanted, seen)),
    )


def ours_in(wanted: Wanted, seen: Seen) -> Participants:
    """Return the participant with most endpoints of the guard's nodes, and the one supervisor's."""
    found = seen.participants
    counts = Counter(
        end.participant
        for end in seen.ends
        if end.node in wanted.own and end.node != SUPERVISOR_NODE
    )
    guard = {max(counts, key=lambda each: (counts[each], each))} if counts else set()
    supervisors = found.get(SUPERVISOR_NODE, set())
    return frozenset(guard | (supervisors if len(supervisors) == 1 else set()))


def doubles_in(seen: Seen) -> dict[str, frozenset[bytes]]:
    """Return the node names that several participants have, and which."""
    found = seen.participants
    return {node: frozenset(each) for node, each in found.items() if len(each) > 1}


def _exits(scene: _Scene) -> Iterator[Path]:
    for public, private in scene.wanted.outputs.items():
        for pattern in scene.wanted.topics[private].subscribers:
            if pattern not in scene.wanted.own:
                yield from _exit(scene, public, private, pattern)


def _exit(scene: _Scene, public: str, private: str, pattern: str) -> Iterator[Path]:
    ends = [*scene.seen.subscribers(private), *scene.seen.subscribers(public)]
    nodes = strays(scene.wanted, ends, (pattern,))
    for node in nodes:
        state, reason, strangers = _heard(scene, public, private, node)
        yield _path(public, private, node, state, reason, strangers)
    if nodes:
        return
    if any(not end.node for end in scene.seen.subscribers(private)):
        yield _path(public, private, pattern, PathState.UNKNOWN, _NO_NAME)
    else:
        reason = "it runs, and listens to neither name" if _runs(scene, pattern) else ""
        yield _path(public, private, pattern, PathState.NOT_RUNNING, reason)


def _heard(
    scene: _Scene, public: str, private: str, node: str
) -> tuple[PathState, str, tuple[str, ...]]:
    wanted, seen = scene.wanted, scene.seen
    topics = (wanted.topics[private], wanted.topics[public])
    strangers = named(wanted, heard_by(wanted, seen, topics, node, scene.ours))
    if strangers:
        return PathState.OPEN, f"hears {', '.join(strangers)} past the guard", strangers
    if any(end.node == node for end in seen.subscribers(public)):
        return PathState.DRIFT, f"listens to {place(public)}: its remap is missing", ()
    mine = [end for end in seen.subscribers(private) if end.node == node]
    reasons = filter(None, (deaf(wanted, seen, topics[0], end, scene.ours) for end in mine))
    if why := next(reasons, ""):
        return PathState.DRIFT, f"does not hear the guard: {why}", ()
    return PathState.CLOSED, _also_heard(scene, private), ()


def _entrances(scene: _Scene) -> Iterator[Path]:
    for way in scene.wanted.entrances:
        topic = scene.wanted.topics[way.private]
        strangers = named(scene.wanted, foreign(scene.wanted, scene.seen, topic, scene.ours))
        for node in _speakers(scene, way):
            state, reason, found = _spoken(scene, way, node, strangers)
            yield _path(way.public, way.private, node, state, reason, found)


def _speakers(scene: _Scene, way: Entrance) -> tuple[str, ...]:
    ends = [*scene.seen.publishers(way.private), *scene.seen.publishers(way.public)]
    return strays(scene.wanted, ends, way.publishers) or way.publishers


def _spoken(
    scene: _Scene, way: Entrance, node: str, strangers: tuple[str, ...]
) -> tuple[PathState, str, tuple[str, ...]]:
    mine = [end for end in scene.seen.publishers(way.private) if end.node == node]
    if strangers:
        return PathState.OPEN, f"{', '.join(strangers)} speaks in its place", strangers
    if node in scene.doubles:
        told = _participants(scene.doubles[node])
        reason = f"{len(told)} participants have its name: {', '.join(told)}"
        return PathState.OPEN, reason, tuple(f"{node} of the participant {each}" for each in told)
    if any(end.node == node for end in scene.seen.publishers(way.public)):
        return PathState.DRIFT, f"publishes {place(way.public)}: its remap is missing", ()
    if not mine:
        reason = "it runs, and speaks on neither name" if _runs(scene, node) else ""
        return PathState.NOT_RUNNING, reason, ()
    wrong = next(filter(None, (_unfit(scene, way, end) for end in mine)), "")
    if wrong:
        return PathState.DRIFT, f"is not heard by the guard: {wrong}", ()
    return PathState.CLOSED, _also_heard(scene, way.private), ()


def _unfit(scene: _Scene, way: Entrance, end: Ros2Endpoint) -> str:
    return unfit(scene.wanted, scene.wanted.topics[way.private], end)


def _also_heard(scene: _Scene, private: str) -> str:
    """Return who listens without being planned: that moves nothing, and is only told."""
    others = unplanned_listeners(scene.wanted, scene.seen, scene.wanted.topics[private])
    return f"{', '.join(others)} listens, too" if others else ""


def _problems(scene: _Scene) -> Iterator[str]:
    for node in sorted(scene.wanted.guarding - set(scene.seen.nodes)):
        yield f"the guard's node {node} is not running"
    yield from _taken(scene)
    shown = {way.private for way in scene.wanted.entrances}
    for topic in scene.wanted.private():
        strangers = foreign(scene.wanted, scene.seen, topic, scene.ours)
        told = topic.topic in shown or bool(_listeners(scene, topic))
        for name in named(scene.wanted, strangers) if not told else ():
            yield f"{name} speaks on the private {place(topic)}"


def _listeners(scene: _Scene, topic: PlannedTopic) -> tuple[str, ...]:
    """Return the successors that listen to an output: what they hear is told of their paths."""
    if topic.topic not in scene.wanted.outputs.values():
        return ()
    return strays(scene.wanted, scene.seen.subscribers(topic.topic), topic.subscribers)


def _taken(scene: _Scene) -> Iterator[str]:
    """Yield the guard's names that somebody else has, too."""
    for node in sorted(scene.wanted.own):
        participants = scene.seen.participants.get(node, set())
        others = _participants(participants - scene.ours)
        number = scene.seen.nodes.count(node)
        if others:
            yield f"{', '.join(others)} has the name of the guard's node {node}"
        elif number > _rightful(scene, node):
            yield f"{number} nodes have the name of the guard's node {node}"


def _rightful(scene: _Scene, node: str) -> int:
    """Return how many nodes may have a name: the supervisor, too, sees the graph as the guard."""
    supervised = SUPERVISOR_NODE in scene.seen.nodes or not scene.brakes
    return 2 if node == GUARD_NODE and supervised else 1


def _participants(participants: set[bytes] | frozenset[bytes]) -> tuple[str, ...]:
    return tuple(each.hex() for each in sorted(participants))


def _runs(scene: _Scene, pattern: str) -> bool:
    return any(meant((pattern,), node) for node in scene.seen.nodes)


def _path(
    public: str,
    private: str,
    node: str,
    state: PathState,
    reason: str = "",
    strangers: tuple[str, ...] = (),
) -> Path:
    return Path(
        topic=place(public),
        private=place(private),
        node=node,
        state=state,
        reason=reason,
        foreign=strangers,
    )
