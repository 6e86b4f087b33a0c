"""What in a valid plan has no effect, stops late or is a guess, and where it leaves a way past."""

from collections.abc import Iterable, Iterator, Mapping, Sequence

from rtron.coherence.duration_bounds import duration_doubts
from rtron.planning.app_topics import action_servers, is_large
from rtron.planning.command_sources import CommandSources
from rtron.planning.problem import PlanProblem, ProblemLevel
from rtron.planning.protection_gaps import protection_gaps
from rtron.planning.queue_sizes import queue_doubts
from rtron.vocabulary import (
    GRCN,
    SECOND,
    Direction,
    Flow,
    InteractionGraph,
    LastMessageFate,
    Mode,
    Plan,
    PolicyName,
    StopProfile,
    Stream,
    StreamKind,
    build_streams,
    matches_node,
)
from rtron.wording import conjugate, join_names

_AMONG_COMMANDS = "pictures and point clouds are carried beside commands, which wait for them"
_JOYSTICKS = frozenset({"joy", "joy_linux"})
_BY_PRIORITY = (PolicyName.PREEMPTION, PolicyName.PRIORITY_QUEUE)
_USUAL_SPEED = 1.0
"""What is taken (m/s, and rad/s for turning) where the plan sets no limit."""
LONGEST_STOP = 2 * SECOND
LONGEST_PERIOD = SECOND // 10
FEWEST_ZEROS = 3


def void_value_warnings(plan: Plan) -> Iterator[PlanProblem]:
    """Yield a warning for each value that makes a coordination node useless, or the whole plan."""
    for grcn in plan.grcn:
        if grcn.mode is Mode.ENFORCE:
            yield from (_warning(f"GRCN {grcn.id}", message) for message in _void_values(grcn))
    if plan.rsrcn:
        for topic in plan.rsrcn.vflows:
            yield from _blocked(f"RSRCN on {topic.topic}", topic.flows)
    yield from (_warning("stop", message) for message in stop_doubts(plan))
    yield from (_warning(where, message) for where, message in protection_gaps(plan))
    yield from (_warning(where, message) for where, message in duration_doubts(plan))
    yield from (_warning(where, message) for where, message in queue_doubts(plan))
    yield from (_warning(where, message) for where, message in _large_commands(plan))
    modes = [node.mode for node in (*plan.grcn, plan.rsrcn, plan.msrcn) if node]
    if Mode.ENFORCE not in modes:
        yield _warning("plan", "nothing enforces: the guard only watches; set `mode: enforce`")


def _void_values(grcn: GRCN) -> Iterator[str]:
    if not grcn.flows:
        yield "it has no flow, so it keeps everybody out: name who may publish it under `flows`"
    elif all(flow.block for flow in grcn.flows):
        yield "every flow is blocked: nothing passes"
    if grcn.lease and grcn.policy is not PolicyName.LEASE:
        yield f"`lease: {grcn.lease}` has no effect: the policy is {grcn.policy}, not Lease"


def _large_commands(plan: Plan) -> Iterator[tuple[str, str]]:
    """Yield the large messages that the process of the commands would carry: where, and why."""
    for grcn in plan.grcn:
        if is_large(grcn.type) and grcn.kind is not StreamKind.STATE:
            yield f"GRCN {grcn.id}", f"{_AMONG_COMMANDS}: say `kind: state`"
    for topic in plan.msrcn.aflows if plan.msrcn else ():
        if is_large(topic.type):
            help = "put the rule on a topic of small messages"
            yield f"MSRCN on {topic.topic}", f"{_AMONG_COMMANDS}: {help}"


def _blocked(where: str, flows: tuple[Flow, ...]) -> Iterator[PlanProblem]:
    if flows and all(flow.block for flow in flows):
        yield _warning(where, "every flow is blocked: nothing passes")


def _warning(where: str, message: str) -> PlanProblem:
    return PlanProblem(ProblemLevel.WARNING, where, message)


def stop_doubts(plan: Plan) -> Iterator[str]:
    """Yield what is odd in how the guard of a plan stops the robot."""
    stop = plan.stop
    yield from _steeper_stop(plan)
    yield from _slow_stop(plan)
    if stop.period > LONGEST_PERIOD:
        how_long = _seconds(stop.period)
        yield f"period is {how_long}: the robot brakes in steps that long; 50 ms is usual"
    zeros = max(1, -(-stop.repeat // stop.period))
    if zeros < FEWEST_ZEROS:
        lost = "a base that misses what says 0 drives on"
        count = "one message" if zeros == 1 else f"{zeros} messages"
        yield f"a stop ends with {count} of velocity 0: {lost}; raise `repeat` (1 s)"


def _steeper_stop(plan: Plan) -> Iterator[str]:
    """Yield where the stop from the greatest speed is steeper than the plan's own ramp."""
    stop = plan.stop
    fastest = (plan.rsrcn and plan.rsrcn.max_vel_limit) or 0.0
    if fastest > stop.decel * stop.within / SECOND:
        ramp = f"at {stop.decel:g} m/s2 it takes {fastest / stop.decel:.2g} s from {fastest:g} m/s"
        yield f"every stop ends within {_seconds(stop.within)}, and {ramp}: it is steeper"


def _slow_stop(plan: Plan) -> Iterator[str]:
    stop = plan.stop
    speed = (plan.rsrcn and plan.rsrcn.max_vel_limit) or _USUAL_SPEED
    duration = _braking_time(speed, stop.decel, stop)
    if duration > LONGEST_STOP:
        metres = speed * duration / SECOND / 2
        how_far = f"from {speed:g} m/s the robot drives {metres:.2g} m on"
        yield f"a stop takes {_seconds(duration)}, and {how_far}: raise `decel`, or lower `within`"
    turning = _braking_time(_USUAL_SPEED, stop.angular_decel, stop)
    if max(turning, LONGEST_STOP) > max(duration, LONGEST_STOP):
        how_long = f"{_seconds(turning)} to end a turn of {_USUAL_SPEED:g} rad/s"
        yield f"a stop takes {how_long}: raise `angular_decel`, or lower `within`"


def _braking_time(speed: float, decel: float, stop: StopProfile) -> int:
    return round(min(speed / decel * SECOND, stop.within))


def _seconds(duration: int) -> str:
    return f"{duration / SECOND:.3g} s"


def order_doubts(plan: Plan, graph: InteractionGraph) -> Iterator[PlanProblem]:
    """Yield a warning for each GRCN whose proposed order nobody has touched and that is a guess."""
    sources = CommandSources(graph, action_servers(graph))
    known = {node.name for node in graph.nodes if not sources.is_guess(node.name)}
    for grcn in plan.grcn:
        is_ordered = grcn.mode is Mode.ENFORCE and grcn.policy in _BY_PRIORITY
        if is_ordered and len(grcn.flows) > 1 and _is_as_proposed(grcn):
            publishers = [flow.publisher for flow in grcn.flows]
            unknown = [each for each in publishers if not _is_known(each, known)]
            ties = sources.unordered(set(publishers).difference(unknown))
            guesses = [f"nothing tells which of these goes first: {join_names(t)}" for t in ties]
            if unknown:
                guesses.insert(0, f"nothing tells what these do: {', '.join(unknown)}")
            yield from (_guess(grcn, guess) for guess in guesses)


def open_way_doubts(plan: Plan, graph: InteractionGraph) -> Iterator[PlanProblem]:
    """Yield a warning for each way past the guard of commands that it stands before."""
    unread = frozenset(node.name for node in graph.nodes if node.unread)
    agents = [node.name for node in graph.nodes if node.package == "micro_ros_agent"]
    for stream in build_streams(plan):
        if stream.mode is Mode.ENFORCE and stream.is_command:
            known = {end.node for end in graph.subscribers(stream.topic)}
            where = f"{stream.stages[0].coordination_kind} {stream.stages[0].id}"
            unclosed = _unclosed_outputs(stream, unread - known, agents)
            ways = (*unclosed, *_self_deliveries(stream))
            yield from (_warning(where, way) for way in ways)


def silence_doubts(plan: Plan, graph: InteractionGraph) -> Iterator[PlanProblem]:
    """Yield a warning for each joystick whose stick says nothing while it is held, as if let go."""
    senders = {
        end.topic: end.node
        for end in graph.endpoints
        if end.direction is Direction.PUBLISH and _sends_on_change(end.node, graph)
    }
    for grcn in plan.grcn if senders else ():
        for flow in grcn.flows if grcn.kind is StreamKind.COMMAND else ():
            for joystick in sorted(_joysticks(flow, senders, graph)):
                message = (
                    f"{joystick} sends on change alone: a stick that is held is silent, and stops "
                    f"{flow.publisher} after {_seconds(flow.silent_after)}; set its "
                    "autorepeat_rate to 10 or more"
                )
                yield _warning(f"GRCN {grcn.id}", message)


def _joysticks(flow: Flow, senders: Mapping[str, str], graph: InteractionGraph) -> set[str]:
    """Return which joysticks a flow's publisher hears, and does not repeat itself."""
    repeating = {f.subject for f in graph.wiring if f.value == LastMessageFate.REPEATED}
    inputs = (
        end.topic
        for end in graph.endpoints
        if end.direction is Direction.SUBSCRIBE and matches_node(flow.publisher, end.node)
        if end.node not in repeating
    )
    return {senders[topic] for topic in inputs if topic in senders}


def _sends_on_change(node: str, graph: InteractionGraph) -> bool:
    """Return whether a node is a joystick's driver that does not repeat (ROS wiki: joy).

    In ROS 2 it repeats by default.
    """
    packages = {each.package for each in graph.nodes if each.name == node}
    rates = [p.value for p in graph.parameters if (p.node, p.name) == (node, "autorepeat_rate")]
    rate = rates[-1] if rates else int(graph.ros > 1)
    return not packages.isdisjoint(_JOYSTICKS) and rate == 0


def _unclosed_outputs(
    stream: Stream, unread: frozenset[str], agents: Sequence[str]
) -> Iterator[str]:
    guessed = sorted(unread.intersection(stream.successors))
    public = (
        "whoever subscribes reads the public topic; any node can publish there, and the guard only "
        "warns of it"
    )
    if not stream.successors:
        yield f"which node obeys it on the robot is not known: {public}"
    elif guessed:
        verb = conjugate(guessed, "obey")
        yield f"that {join_names(guessed)} (not read) {verb} it is a guess; if not, {public}"
    if stream.successors and agents:
        may_obey = f"firmware behind {join_names(agents)} may obey it, too"
        yield f"{may_obey}, and no remap moves what it reads: {public}"


def _self_deliveries(stream: Stream) -> Iterator[str]:
    passed = [flow.publisher for flow in stream.flows if not flow.block]
    own = [name for name in passed if _is_known(name, stream.successors)]
    for publisher in own:
        what = "publishes what it obeys"
        yield f"{publisher} {what}: what it sends itself does not pass the guard"
    if own and own == passed and stream.block_unapproved:
        others = "another that is to command it needs a flow"
        yield f"nobody but {join_names(own)} may send {stream.topic}: {others}"


def _is_known(publisher: str, known: Iterable[str]) -> bool:
    return any(matches_node(publisher, node) for node in known)


def _is_as_proposed(grcn: GRCN) -> bool:
    """Return whether the priorities are those that a proposal counts down."""
    priorities = [flow.priority for flow in grcn.flows]
    return priorities == list(range(len(priorities), 0, -1))


def _guess(grcn: GRCN, guess: str) -> PlanProblem:
    message = (
        f"{guess}; so the order is a guess: decide who goes first, and give the flows priorities "
        "of your own"
    )
    return _warning(f"GRCN {grcn.id}", message)
