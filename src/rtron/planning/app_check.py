"""Whether a plan fits the app that it is for; the reader has checked that it fits itself."""

from collections.abc import Collection, Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property

from rtron.errors import suggestion
from rtron.planning.app_topics import action_topics, all_topics, is_sent_per_frame
from rtron.planning.plan_file.fields import TYPE_NAME
from rtron.planning.plan_file.loader import has_expressions
from rtron.planning.problem import PlanProblem, ProblemLevel
from rtron.vocabulary import (
    GRCN,
    EventFlow,
    Flow,
    FpsMonitor,
    FrameSource,
    GuardedTopic,
    InteractionGraph,
    Mode,
    Plan,
    Ros1ActionTopic,
    WatchedFlow,
    action_name,
    is_bridge_client,
    matches_node,
    normalise_type,
    ros1_topic_name,
    with_goal_topics,
)
from rtron.wording import join_names


@dataclass(frozen=True)
class _AppGraph:
    """What a plan may name."""

    graph: InteractionGraph

    @cached_property
    def topics(self) -> frozenset[str]:
        return all_topics(self.graph)

    @cached_property
    def nodes(self) -> frozenset[str]:
        listed = (node.name for node in self.graph.nodes)
        return frozenset(listed).union(endpoint.node for endpoint in self.graph.endpoints)

    @cached_property
    def unread_nodes(self) -> frozenset[str]:
        return frozenset(node.name for node in self.graph.nodes if node.unread)

    def publishers(self, topic: str) -> tuple[str, ...]:
        return tuple(sorted({e.node for e in self.graph.publishers(topic)}))

    def subscribers(self, topic: str) -> tuple[str, ...]:
        return tuple(sorted({e.node for e in self.graph.subscribers(topic)}))

    def types(self, topic: str) -> tuple[str, ...]:
        """Return the known types of a topic, as ROS 1 spells them."""
        endpoints = (*self.graph.publishers(topic), *self.graph.subscribers(topic))
        types = [*(endpoint.type for endpoint in endpoints), *self._declared.get(topic, ())]
        return tuple(
            sorted({normalise_type(name) for name in types if name and TYPE_NAME.matches(name)})
        )

    @cached_property
    def _declared(self) -> dict[str, tuple[str, ...]]:
        return {topic.name: topic.types for topic in self.graph.topics}

    @cached_property
    def actions(self) -> frozenset[str]:
        return action_topics(self.graph)

    @cached_property
    def ros2_actions(self) -> frozenset[str]:
        action_names = frozenset(action.name for action in self.graph.actions)
        return action_names if self.graph.ros != 1 else frozenset()


@dataclass(frozen=True, slots=True)
class _GuardedFlows:
    """One topic that a coordination node stands before."""

    location: str
    mode: Mode
    topic: str
    type: str
    flows: Sequence[Flow]
    successors: Sequence[str]

    @property
    def action(self) -> str:
        """The action that is guarded as a whole, or nothing."""
        return action_name(self.topic, self.type)

    def client_nodes(self, app: _AppGraph) -> tuple[str, ...]:
        """Return the nodes that publish the topic; of an action also those that only cancel."""
        cancels = (
            ros1_topic_name(self.action, Ros1ActionTopic.CANCEL) if self.action else self.topic
        )
        publishers = (*app.publishers(self.topic), *app.publishers(cancels))
        return tuple(dict.fromkeys(publishers))


def check_plan(plan: Plan, graph: InteractionGraph | None = None) -> tuple[PlanProblem, ...]:
    """Return what is odd in a plan, and what is wrong between it and a graph if there is one.

    Errors and warnings stand in the plan's order, those of the rules last.
    """
    problems = [
        *(_app_problems(plan, _AppGraph(with_goal_topics(graph))) if graph else ()),
        *_rule_warnings(plan),
    ]
    return tuple(dict.fromkeys(problems))


def _app_problems(plan: Plan, app: _AppGraph) -> Iterator[PlanProblem]:
    for guard in _guarded_flows(plan):
        yield from _check_guard(guard, app)
    for where, flow in _watched_flows(plan):
        yield from _check_watched(where, flow, app)
    for monitor in plan.fps_monitor:
        yield from _check_source(monitor, app)
    for grcn in plan.grcn:
        if grcn.done:
            yield from _check_done(f"GRCN {grcn.id}, done", grcn, grcn.done, app)


def _rule_warnings(plan: Plan) -> Iterator[PlanProblem]:
    if not has_expressions(plan):
        return
    from rtron.planning.mission_warnings import mission_warnings  # noqa: PLC0415 - seldom needed

    for name, message in mission_warnings(plan):
        yield PlanProblem(ProblemLevel.WARNING, f"MSRCN, {name}", message)


def _guarded_flows(plan: Plan) -> Iterator[_GuardedFlows]:
    for grcn in plan.grcn:
        where = f"GRCN {grcn.id}"
        yield _GuardedFlows(where, grcn.mode, grcn.topic, grcn.type, grcn.flows, grcn.successors)
    if plan.rsrcn:
        yield from _guarded_flows_of("RSRCN", plan.rsrcn.mode, plan.rsrcn.vflows)
    if plan.msrcn:
        yield from _guarded_flows_of("MSRCN", plan.msrcn.mode, plan.msrcn.aflows)


def _guarded_flows_of(
    kind: str, mode: Mode, topics: Sequence[GuardedTopic]
) -> Iterator[_GuardedFlows]:
    for topic in topics:
        where = f"{kind} on {topic.topic}"
        yield _GuardedFlows(where, mode, topic.topic, topic.type, topic.flows, topic.successors)


def _watched_flows(plan: Plan) -> Iterator[tuple[str, WatchedFlow | EventFlow]]:
    iflows = plan.rsrcn.iflows if plan.rsrcn else ()
    eflows = plan.msrcn.eflows if plan.msrcn else ()
    yield from ((f"RSRCN, {flow.name}", flow) for flow in iflows)
    yield from ((f"MSRCN, {flow.name}", flow) for flow in eflows)
    for monitor in plan.fps_monitor:
        flow = WatchedFlow(name=monitor.id, topic=monitor.topic, publisher=monitor.node)
        yield f"fps_monitor {monitor.id}", flow
        if monitor.camera:
            yield f"fps_monitor {monitor.id}, camera", monitor.camera


def _check_guard(guard: _GuardedFlows, app: _AppGraph) -> Iterator[PlanProblem]:
    unknown = list(_check_topic(guard.location, guard.topic, app))
    if unknown:
        yield from unknown
        return
    yield from _check_type(guard.location, guard.topic, guard.type, app)
    for flow in guard.flows:
        yield from _check_publisher(
            f"{guard.location}, {flow.name}",
            flow.publisher,
            guard.topic,
            guard.client_nodes(app),
            app,
        )
    yield from _check_successors(guard, app)
    yield from _unplanned_nodes(guard, app)
    if guard.mode is Mode.ENFORCE and guard.topic in app.actions and not guard.action:
        why = "an action's topics move together, this one alone would part client and server"
        help = "guard its goals, and say their type, pkg/NameActionGoal"
        message = f"{guard.topic} is one topic of an action: {why}; {help}"
        yield PlanProblem(ProblemLevel.WARNING, guard.location, message)
    if guard.topic in app.ros2_actions and not guard.action:
        message = f"{guard.topic} is an action, not a topic: say its type, pkg/action/Name"
        yield PlanProblem(ProblemLevel.ERROR, guard.location, message)


def _check_watched(
    where: str, flow: WatchedFlow | EventFlow, app: _AppGraph
) -> Iterator[PlanProblem]:
    unknown = list(_check_topic(where, flow.topic, app))
    publishers = app.publishers(flow.topic)
    yield from unknown or _check_publisher(where, flow.publisher, flow.topic, publishers, app)
    if isinstance(flow, EventFlow):
        yield from _check_type(where, flow.topic, flow.type, app)


def _check_type(where: str, topic: str, planned: str, app: _AppGraph) -> Iterator[PlanProblem]:
    used = app.types(topic)
    if planned and used and normalise_type(planned) not in used:
        message = f"{topic} carries {' and '.join(used)}, not {planned}"
        yield PlanProblem(ProblemLevel.ERROR, where, message)


def _check_source(monitor: FpsMonitor, app: _AppGraph) -> Iterator[PlanProblem]:
    """Warn where a monitor counts as frames what may come only when something is seen."""
    types = app.types(monitor.topic)
    if monitor.source is FrameSource.FRAMES and types and not any(map(is_sent_per_frame, types)):
        where = f"fps_monitor {monitor.id}"
        why = "if it comes only when something is seen, an empty scene would freeze the robot"
        help = "say `source: detections`, or name a topic that comes with every frame"
        message = f"{monitor.topic} carries no images ({' and '.join(types)}): {why}; {help}"
        yield PlanProblem(ProblemLevel.WARNING, where, message)


def _check_topic(where: str, topic: str, app: _AppGraph) -> Iterator[PlanProblem]:
    if topic not in app.topics:
        yield PlanProblem(
            ProblemLevel.ERROR,
            where,
            f"no topic {topic} in the app: {_suggestion(topic, app.topics)}",
        )


def _check_done(where: str, grcn: GRCN, done: str, app: _AppGraph) -> Iterator[PlanProblem]:
    """Yield what keeps a topic, or an action of ROS 2, from telling that a successor is done."""
    unknown = list(_check_topic(where, done, app))
    yield from unknown
    senders = app.subscribers(done) if done in app.ros2_actions else app.publishers(done)
    is_accepted = any(matches_node(name, node) for name in grcn.successors for node in senders)
    if senders and not is_accepted and not unknown:
        who = " and ".join(senders)
        message = f"{done} is told by {who}, and only a successor of {grcn.topic} is believed"
        yield PlanProblem(ProblemLevel.ERROR, where, message)


def _check_publisher(
    where: str, pattern: str, topic: str, publishers: Sequence[str], app: _AppGraph
) -> Iterator[PlanProblem]:
    if any(matches_node(pattern, node) for node in publishers):
        return
    if is_bridge_client(pattern):  # `rtron bridge check` knows these
        return
    if any(matches_node(pattern, node) for node in app.nodes):
        does = "do" if publishers[1:] else "does"
        who = f"{join_names(publishers)} {does}" if publishers else "nobody does"
        yield PlanProblem(ProblemLevel.ERROR, where, f"{pattern} does not publish {topic}: {who}")
    else:
        yield _no_node(where, pattern, app)


def _check_successors(guard: _GuardedFlows, app: _AppGraph) -> Iterator[PlanProblem]:
    subscribers = (*app.subscribers(guard.topic), *app.unread_nodes)
    for name in guard.successors:
        if any(matches_node(name, node) for node in subscribers):
            continue
        if any(matches_node(name, node) for node in app.nodes):
            message = f"{name} does not subscribe {guard.topic}"
            yield PlanProblem(ProblemLevel.ERROR, guard.location, message)
        else:
            yield _no_node(guard.location, name, app)


def _unplanned_nodes(guard: _GuardedFlows, app: _AppGraph) -> Iterator[PlanProblem]:
    """Yield a warning for each end of the topic in the app that the plan does not name."""
    named = [flow.publisher for flow in guard.flows]
    for node in _not_named(guard.client_nodes(app), named):
        who = node or "a node without a name"
        message = f"no flow names {who}, which publishes {guard.topic}: it counts as unapproved"
        yield PlanProblem(ProblemLevel.WARNING, guard.location, message)
    subscribers = app.subscribers(guard.topic) if guard.mode is Mode.ENFORCE else ()
    for node in _not_named(subscribers, guard.successors):
        message = (
            f"{node} is no successor: it hears the public {guard.topic}, where anyone can speak"
        )
        yield PlanProblem(ProblemLevel.WARNING, guard.location, message)


def _not_named(nodes: Sequence[str], patterns: Sequence[str]) -> list[str]:
    return [node for node in nodes if not any(matches_node(pattern, node) for pattern in patterns)]


def _no_node(where: str, name: str, app: _AppGraph) -> PlanProblem:
    return PlanProblem(
        ProblemLevel.ERROR, where, f"no node {name} in the app: {_suggestion(name, app.nodes)}"
    )


def _suggestion(word: str, known: Collection[str]) -> str:
    return suggestion(word, sorted(known)) if known else "the graph has none"
