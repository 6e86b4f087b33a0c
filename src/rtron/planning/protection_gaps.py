"""What a valid plan leaves open although it enforces, and what follows for the robot."""

from collections.abc import Iterable, Iterator

from rtron.coherence.flows import duplicates
from rtron.coherence.rsrcn import FRAME_RATE_POLICIES, VELOCITY_LIMIT_POLICIES
from rtron.messages.common.velocity import MOTION_TYPES
from rtron.planning.app_topics import is_large
from rtron.planning.plan_file.fields import NODE_NAME
from rtron.vocabulary import (
    GRCN,
    RSRCN,
    CoordinationKind,
    Flow,
    GuardedTopic,
    Mode,
    OnSilence,
    Plan,
    Stream,
    StreamKind,
    build_streams,
    normalise_type,
    patterns_overlap,
)
from rtron.wording import join_names

_LIMITING = (*FRAME_RATE_POLICIES, *VELOCITY_LIMIT_POLICIES)
_FASTEST = {
    "max_vel_limit": (50, "m/s"),
    "max_side_limit": (50, "m/s"),
    "max_turn_limit": (50, "rad/s"),
    "max_accel_limit": (100, "m/s2"),
    "threshold": (10, "m/frame"),
}
"""What no robot reaches: a limit above it is one of another unit, or a slip."""
Gap = tuple[str, str]
"""Where a plan leaves something open, and what."""


def protection_gaps(plan: Plan) -> Iterator[Gap]:
    """Yield what the enforcing nodes of a plan leave open, and what it accepts in vain."""
    for stream in build_streams(plan):
        if stream.mode is Mode.ENFORCE:
            where = f"{stream.stages[0].coordination_kind} {stream.stages[0].id}"
            yield from ((where, message) for message in _stream_gaps(stream, plan))
    for grcn in plan.grcn:
        if grcn.mode is Mode.ENFORCE and not grcn.block_unapproved:
            message = f"what any other node publishes on {grcn.topic} passes: "
            help = "name who may under `flows`, and leave `block_unapproved: false` out"
            yield f"GRCN {grcn.id}", message + help
    yield from (("RSRCN", message) for message in _limit_gaps(plan))
    msrcn = plan.msrcn
    if msrcn and msrcn.rules and msrcn.mode is not Mode.ENFORCE:
        yield from (("MSRCN", message) for message in _only_watched(msrcn.aflows, plan, "rule"))
    yield from (("plan", message) for message in _accepted_in_vain(plan))


def _stream_gaps(stream: Stream, plan: Plan) -> Iterator[str]:
    moves = is_motion(stream.type)
    kind = stream.stages[0].settings.kind
    if moves and kind is not StreamKind.COMMAND:
        what = "NaN passes, and nothing stops the robot when the publisher falls silent"
        yield f"`kind: {kind}` of a {stream.type}: {what}; if it moves the robot, say `command`"
    is_grcn = stream.stages[0].coordination_kind is CoordinationKind.GRCN
    if is_grcn and stream.is_command and stream.type and not (moves or _is_limit(stream, plan)):
        why = f"which {stream.type} stops the robot is not known"
        help = "if it moves nothing, say `kind: state` or `kind: action`"
        yield f"{why}: no stop follows when the publisher falls silent; {help}"
    passing = [flow for flow in stream.flows if not flow.block]
    if stream.is_command and moves and passing and all(map(_releases_on_silence, passing)):
        what = "the robot goes on at its last velocity, unless its base stops by itself"
        yield f"every flow says `on_silence: release`: when all fall silent, {what}"
    if stream.uses and "linear.x" not in stream.uses:
        used = join_names(stream.uses)
        yield f"`uses` has {used} only: the guard sets linear.x to 0, so it never drives forward"
    for flow in passing:
        if matches_every_node(flow.publisher):
            why = "no node is a stranger, and none is kept out"
            yield f"{flow.publisher} of {flow.name} is every node: {why}; name the nodes"
    for node in duplicates(stream.successors, lambda node: node):
        yield f"the successor {node} stands twice: was another node meant?"


def matches_every_node(publisher: str) -> bool:
    """Return whether a pattern means every node, or every one in a namespace."""
    return not publisher.strip("/*")


def is_motion(type: str) -> bool:
    """Return whether messages of a type are velocities that the robot drives at."""
    return normalise_type(type) in MOTION_TYPES


def _is_limit(stream: Stream, plan: Plan) -> bool:
    """Return whether a topic tells a greatest velocity, which no stop needs; or is told of else."""
    limits = (topic.topic for topic in plan.rsrcn.vflows) if plan.rsrcn else ()
    return stream.topic in limits or is_large(stream.type)


def _releases_on_silence(flow: Flow) -> bool:
    return flow.on_silence is OnSilence.RELEASE


def _limit_gaps(plan: Plan) -> Iterator[str]:
    rsrcn = plan.rsrcn
    if rsrcn is None or rsrcn.policy not in _LIMITING:
        return
    if rsrcn.mode is not Mode.ENFORCE:
        yield from _only_watched(rsrcn.vflows, plan, "limit")
        return
    for key, (most, unit) in _FASTEST.items():
        value = getattr(rsrcn, key)
        if value is not None and value > most:
            yield f"{key} is {value:g} {unit}: nothing that drives is limited by it"
    if rsrcn.policy in VELOCITY_LIMIT_POLICIES and rsrcn.max_vel_limit == 0:
        yield "max_vel_limit is 0 m/s: the robot never moves"
    yield from _unlimited_commands(rsrcn, [g for g in plan.grcn if g.mode is Mode.ENFORCE])
    yield from _unlimited_turns(rsrcn)
    if rsrcn.policy in FRAME_RATE_POLICIES:
        yield from _self_counted_frames(plan, rsrcn)


def _only_watched(topics: Iterable[GuardedTopic], plan: Plan, what: str) -> Iterator[str]:
    """Yield the topics on which a GRCN enforces, and a node with limits or rules does not."""
    enforced = {grcn.topic for grcn in plan.grcn if grcn.mode is Mode.ENFORCE}
    for topic in sorted(enforced.intersection(topic.topic for topic in topics)):
        yield f"it only watches: no {what} holds on {topic}; set `mode: enforce`"


def _unlimited_commands(rsrcn: RSRCN, enforced: Iterable[GRCN]) -> Iterator[str]:
    """Yield the commands past a limit; those that lead into a limited topic have one."""
    if not all(is_motion(topic.type) for topic in rsrcn.vflows):
        return
    limited = {topic.topic for topic in rsrcn.vflows}
    sources = [flow.publisher for topic in rsrcn.vflows for flow in topic.flows]
    for grcn in enforced:
        leads_there = any(
            patterns_overlap(one, other) for one in grcn.successors for other in sources
        )
        if is_motion(grcn.type) and grcn.topic not in limited and not leads_there:
            yield f"no limit holds on {grcn.topic}, a {grcn.type}: add it to `vflows`"


def _unlimited_turns(rsrcn: RSRCN) -> Iterator[str]:
    for topic in rsrcn.vflows:
        turns = not topic.uses or any(name.startswith("angular") for name in topic.uses)
        is_twist = is_motion(topic.type) and "Twist" in topic.type
        if is_twist and turns and rsrcn.max_turn_limit is None:
            yield f"no limit holds for turning on {topic.topic}: set `max_turn_limit`, in rad/s"


def _self_counted_frames(plan: Plan, rsrcn: RSRCN) -> Iterator[str]:
    drivers = [(flow.publisher, topic) for topic in rsrcn.vflows for flow in topic.flows]
    for monitor in plan.fps_monitor:
        topics = [
            topic.topic for publisher, topic in drivers if patterns_overlap(publisher, monitor.node)
        ]
        if topics and monitor.camera is None:
            why = f"the more frames it publishes, the faster it may drive on {join_names(topics)}"
            yield f"{monitor.node} counts for its own limit: {why}; give {monitor.id} a `camera`"


def _accepted_in_vain(plan: Plan) -> Iterator[str]:
    named = {name for stream in build_streams(plan) for name in _node_names(stream)}
    for what in plan.accept_unenforceable:
        if what not in named and ("*" in what or not NODE_NAME.matches(what)):
            help = "write one node's name as `rtron instrument` reports it"
            yield f"`accept_unenforceable` accepts nothing by {what!r}: {help}"


def _node_names(stream: Stream) -> Iterator[str]:
    yield from stream.successors
    yield from (flow.publisher for flow in stream.flows)
