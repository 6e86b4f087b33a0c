"""Whether a plan fits the app that it is for; the reader has checked that it fits itself."""

from collections.abc import Collection, Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property

from rtron.planning.app_topics import action_topics, topics_of
from rtron.planning.frames import is_per_frame
from rtron.planning.plan_file.fields import TYPE
from rtron.planning.plan_file.problems import suggestion
from rtron.planning.problem import Level, Problem
from rtron.vocabulary import (
    GRCN,
    PRIVATE_ROOT,
    ActionPart,
    EventFlow,
    Flow,
    FpsMonitor,
    FrameSource,
    GuardedTopic,
    InteractionGraph,
    Mode,
    Plan,
    WatchedFlow,
    action_of,
    names_node,
    normalise_type,
    part_topic,
    with_goals,
)


@dataclass(frozen=True)
class _App:
    """What a plan may name."""

    graph: InteractionGraph

    @cached_property
    def topics(self) -> frozenset[str]:
        return topics_of(self.graph)

    @cached_property
    def nodes(self) -> frozenset[str]:
        listed = (node.name for node in self.graph.nodes)
        return frozenset(listed).union(endpoint.node for endpoint in self.graph.endpoints)

    def publishers(self, topic: str) -> tuple[str, ...]:
        return tuple(sorted({e.node for e in self.graph.publishers(topic)}))

    def subscribers(self, topic: str) -> tuple[str, ...]:
        return tuple(sorted({e.node for e in self.graph.subscribers(topic)}))

    def types(self, topic: str) -> tuple[str, ...]:
        """Return the known types of a topic, as ROS 1 spells them."""
        ends = (*self.graph.publishers(topic), *self.graph.subscribers(topic))
        types = [*(end.type for end in ends), *self._declared.get(topic, ())]
        return tuple(sorted({normalise_type(name) for name in types if name and TYPE.fits(name)}))

    @cached_property
    def _declared(self) -> dict[str, tuple[str, ...]]:
        return {topic.name: topic.types for topic in self.graph.topics}

    @cached_property
    def actions(self) -> frozenset[str]:
        return action_topics(self.graph)

    @cached_property
    def requested(self) -> frozenset[str]:
        named = frozenset(action.name for action in self.graph.actions)
        return named if self.graph.ros != 1 else frozenset()


@dataclass(frozen=True, slots=True)
class _Guard:
    """One topic that a coordination node stands before."""

    where: str
    mode: Mode
    topic: str
    type: str
    flows: Sequence[Flow]
    successors: Sequence[str]

    @property
    def action(self) -> str:
        """The action that is guarded as a whole, or nothing."""
        return action_of(self.topic, self.type)

    def speakers(self, app: _App) -> tuple[str, ...]:
        """Return the nodes that publish the topic; of an action also those that only cancel."""
        cancels = part_topic(self.action, ActionPart.CANCEL) if self.action else self.topic
        both = (*app.publishers(self.topic), *app.publishers(cancels))
        return tuple(dict.fromkeys(both))


def check_plan(plan: Plan, graph: InteractionGraph | None = None) -> tuple[Problem, ...]:
    """Return what is odd in a plan, and what is wrong between it and a graph if there is one.

    Errors and warnings stand in the plan's order, those of the rules last.
    """
    found = [*(_between(plan, _App(with_goals(graph))) if graph else ()), *_doubts(plan)]
    return tuple(dict.fromkeys(found))


def _between(plan: Plan, app: _App) -> Iterator[Problem]:
    for guard in _guards(plan):
        yield from _check_guard(guard, app)
    for where, flow in _watched(plan):
        yield from _check_watched(where, flow, app)
    for monitor in plan.fps_monitor:
        yield from _check_source(monitor, app)
    for grcn in plan.grcn:
        if grcn.done:
            yield from _check_done(f"GRCN {grcn.id}, done", grcn, grcn.done, app)


def _doubts(plan: Plan) -> Iterator[Problem]:
    if plan.msrcn is None or not plan.msrcn.rules:
        return
    from rtron.planning.expressions import doubts  # noqa: PLC0415 - seldom needed

    for name, message in doubts(plan.msrcn):
        yield Problem(Level.WARNING, f"MSRCN, rule {name}", message)


def _guards(plan: Plan) -> Iterator[_Guard]:
    for grcn in plan.grcn:
        where = f"GRCN {grcn.id}"
        yield _Guard(where, grcn.mode, grcn.topic, grcn.type, grcn.flows, grcn.successors)
    if plan.rsrcn:
        yield from _of("RSRCN", plan.rsrcn.mode, plan.rsrcn.vflows)
    if plan.msrcn:
        yield from _of("MSRCN", plan.msrcn.mode, plan.msrcn.aflows)


def _of(kind: str, mode: Mode, topics: Sequence[GuardedTopic]) -> Iterator[_Guard]:
    for one in topics:
        where = f"{kind} on {one.topic}"
        yield _Guard(where, mode, one.topic, one.type, one.flows, one.successors)


def _watched(plan: Plan) -> Iterator[tuple[str, WatchedFlow | EventFlow]]:
    iflows = plan.rsrcn.iflows if plan.rsrcn else ()
    eflows = plan.msrcn.eflows if plan.msrcn else ()
    yield from ((f"RSRCN, {flow.name}", flow) for flow in iflows)
    yield from ((f"MSRCN, {flow.name}", flow) for flow in eflows)
    for monitor in plan.fps_monitor:
        flow = WatchedFlow(name=monitor.id, topic=monitor.topic, publisher=monitor.node)
        yield f"fps_monitor {monitor.id}", flow
        if monitor.camera:
            yield f"fps_monitor {monitor.id}, camera", monitor.camera


def _check_guard(guard: _Guard, app: _App) -> Iterator[Problem]:
    unknown = list(_check_topic(guard.where, guard.topic, app))
    if unknown:
        yield from unknown
        return
    yield from _check_type(guard.where, guard.topic, guard.type, app)
    for flow in guard.flows:
        yield from _check_publisher(
            f"{guard.where}, {flow.name}", flow.publisher, guard.topic, guard.speakers(app), app
        )
    yield from _check_successors(guard, app)
    yield from _forgotten(guard, app)
    if guard.mode is Mode.ENFORCE and guard.topic in app.actions and not guard.action:
        why = "an action's topics move together, this one alone would part client and server"
        help = "guard its goals, and say their type, pkg/NameActionGoal"
        told = f"{guard.topic} is one topic of an action: {why}; {help}"
        yield Problem(Level.WARNING, guard.where, told)
    if guard.topic in app.requested and not guard.action:
        told = f"{guard.topic} is an action, not a topic: say its type, pkg/action/Name"
        yield Problem(Level.ERROR, guard.where, told)


def _check_watched(where: str, flow: WatchedFlow | EventFlow, app: _App) -> Iterator[Problem]:
    unknown = list(_check_topic(where, flow.topic, app))
    publishers = app.publishers(flow.topic)
    yield from unknown or _check_publisher(where, flow.publisher, flow.topic, publishers, app)
    if isinstance(flow, EventFlow):
        yield from _check_type(where, flow.topic, flow.type, app)


def _check_type(where: str, topic: str, planned: str, app: _App) -> Iterator[Problem]:
    used = app.types(topic)
    if planned and used and normalise_type(planned) not in used:
        message = f"{topic} carries {' and '.join(used)}, not {planned}"
        yield Problem(Level.ERROR, where, message)


def _check_source(monitor: FpsMonitor, app: _App) -> Iterator[Problem]:
    """Warn where a monitor counts as frames what may come only when something is seen."""
    types = app.types(monitor.topic)
    if monitor.source is FrameSource.FRAMES and types and not any(map(is_per_frame, types)):
        where = f"fps_monitor {monitor.id}"
        why = "if it comes only when something is seen, an empty scene would freeze the robot"
        help = "say `source: detections`, or name a topic that comes with every frame"
        message = f"{monitor.topic} carries no images ({' and '.join(types)}): {why}; {help}"
        yield Problem(Level.WARNING, where, message)


def _check_topic(where: str, topic: str, app: _App) -> Iterator[Problem]:
    if topic.startswith(PRIVATE_ROOT + "/"):
        why = "the guard's own output would come back to it"
        yield Problem(Level.ERROR, where, f"{topic} is the guard's private topic: {why}")
    elif topic not in app.topics:
        yield Problem(
            Level.ERROR, where, f"no topic {topic} in the app: {_near(topic, app.topics)}"
        )


def _check_done(where: str, grcn: GRCN, done: str, app: _App) -> Iterator[Problem]:
    """Yield what keeps a topic, or an action of ROS 2, from telling that a successor is done."""
    unknown = list(_check_topic(where, done, app))
    yield from unknown
    tellers = app.subscribers(done) if done in app.requested else app.publishers(done)
    believed = any(names_node(name, node) for name in grcn.successors for node in tellers)
    if tellers and not believed and not unknown:
        who = " and ".join(tellers)
        message = f"{done} is told by {who}, and only a successor of {grcn.topic} is believed"
        yield Problem(Level.ERROR, where, message)


def _check_publisher(
    where: str, pattern: str, topic: str, publishers: Sequence[str], app: _App
) -> Iterator[Problem]:
    if any(names_node(pattern, node) for node in publishers):
        return
    if any(names_node(pattern, node) for node in app.nodes):
        who = f"{', '.join(publishers)} does" if publishers else "nobody does"
        yield Problem(Level.ERROR, where, f"{pattern} does not publish {topic}: {who}")
    else:
        yield _no_node(where, pattern, app)


def _check_successors(guard: _Guard, app: _App) -> Iterator[Problem]:
    subscribers = app.subscribers(guard.topic)
    for name in guard.successors:
        if any(names_node(name, node) for node in subscribers):
            continue
        if any(names_node(name, node) for node in app.nodes):
            message = f"{name} does not subscribe {guard.topic}"
            yield Problem(Level.ERROR, guard.where, message)
        else:
            yield _no_node(guard.where, name, app)


def _forgotten(guard: _Guard, app: _App) -> Iterator[Problem]:
    """Yield a warning for each end of the topic in the app that the plan does not name."""
    named = [flow.publisher for flow in guard.flows]
    for node in _not_named(guard.speakers(app), named):
        message = f"no flow names {node}, which publishes {guard.topic}: it counts as unapproved"
        yield Problem(Level.WARNING, guard.where, message)
    heard = app.subscribers(guard.topic) if guard.mode is Mode.ENFORCE else ()
    for node in _not_named(heard, guard.successors):
        message = (
            f"{node} is no successor: it hears the public {guard.topic}, where anyone can speak"
        )
        yield Problem(Level.WARNING, guard.where, message)


def _not_named(nodes: Sequence[str], patterns: Sequence[str]) -> list[str]:
    return [node for node in nodes if not any(names_node(pattern, node) for pattern in patterns)]


def _no_node(where: str, name: str, app: _App) -> Problem:
    return Problem(Level.ERROR, where, f"no node {name} in the app: {_near(name, app.nodes)}")


def _near(word: str, known: Collection[str]) -> str:
    return suggestion(word, sorted(known)) if known else "the graph has none"
