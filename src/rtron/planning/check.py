"""Whether a plan fits the app that it is for; the reader has checked that it fits itself."""

from collections.abc import Collection, Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property

from rtron.planning.actions import action_topics, topics_of
from rtron.planning.faults import suggestion
from rtron.planning.problem import Level, Problem
from rtron.vocabulary import (
    PRIVATE_ROOT,
    Flow,
    GuardedTopic,
    InteractionGraph,
    Mode,
    Plan,
    WatchedFlow,
    names_node,
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

    @cached_property
    def actions(self) -> frozenset[str]:
        return action_topics(self.graph)


@dataclass(frozen=True, slots=True)
class _Guard:
    """One topic that a coordination node stands before."""

    where: str
    mode: Mode
    topic: str
    flows: Sequence[Flow]
    successors: Sequence[str]


def check_plan(plan: Plan, graph: InteractionGraph) -> tuple[Problem, ...]:
    """Return what is wrong between a plan and a graph, errors and warnings in the plan's order."""
    app = _App(graph)
    found = [problem for guard in _guards(plan) for problem in _check_guard(guard, app)]
    found += [p for where, flow in _watched(plan) for p in _check_watched(where, flow, app)]
    for grcn in plan.grcn:
        if grcn.done:
            found += _check_topic(f"GRCN {grcn.id}, done", grcn.done, app)
    return tuple(dict.fromkeys(found))


def _guards(plan: Plan) -> Iterator[_Guard]:
    for grcn in plan.grcn:
        yield _Guard(f"GRCN {grcn.id}", grcn.mode, grcn.topic, grcn.flows, grcn.successors)
    if plan.rsrcn:
        yield from _of("RSRCN", plan.rsrcn.mode, plan.rsrcn.vflows)
    if plan.msrcn:
        yield from _of("MSRCN", plan.msrcn.mode, plan.msrcn.aflows)


def _of(kind: str, mode: Mode, topics: Sequence[GuardedTopic]) -> Iterator[_Guard]:
    for one in topics:
        yield _Guard(f"{kind} on {one.topic}", mode, one.topic, one.flows, one.successors)


def _watched(plan: Plan) -> Iterator[tuple[str, WatchedFlow]]:
    iflows = plan.rsrcn.iflows if plan.rsrcn else ()
    eflows = plan.msrcn.eflows if plan.msrcn else ()
    for kind, flows in (("RSRCN", iflows), ("MSRCN", eflows)):
        yield from ((f"{kind}, {flow.name}", flow) for flow in flows)
    for monitor in plan.fps_monitor:
        flow = WatchedFlow(name=monitor.id, topic=monitor.topic, publisher=monitor.node)
        yield f"fps_monitor {monitor.id}", flow


def _check_guard(guard: _Guard, app: _App) -> Iterator[Problem]:
    unknown = list(_check_topic(guard.where, guard.topic, app))
    if unknown:
        yield from unknown
        return
    for flow in guard.flows:
        yield from _check_publisher(f"{guard.where}, {flow.name}", flow.publisher, guard.topic, app)
    yield from _check_successors(guard, app)
    yield from _forgotten(guard, app)
    if guard.mode is Mode.ENFORCE and guard.topic in app.actions:
        why = "an action's topics move together, this one alone would part client and server"
        yield Problem(Level.WARNING, guard.where, f"{guard.topic} is one topic of an action: {why}")


def _check_watched(where: str, flow: WatchedFlow, app: _App) -> Iterator[Problem]:
    unknown = list(_check_topic(where, flow.topic, app))
    yield from unknown or _check_publisher(where, flow.publisher, flow.topic, app)


def _check_topic(where: str, topic: str, app: _App) -> Iterator[Problem]:
    if topic.startswith(PRIVATE_ROOT + "/"):
        why = "the guard's own output would come back to it"
        yield Problem(Level.ERROR, where, f"{topic} is the guard's private topic: {why}")
    elif topic not in app.topics:
        yield Problem(
            Level.ERROR, where, f"no topic {topic} in the app: {_near(topic, app.topics)}"
        )


def _check_publisher(where: str, pattern: str, topic: str, app: _App) -> Iterator[Problem]:
    publishers = app.publishers(topic)
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
    for node in _not_named(app.publishers(guard.topic), named):
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
