"""Whether the coordination nodes on one topic say only what counts.

A stream has the flows and successors of its first node, in the order GRCN, MSRCN, RSRCN. What a
later one says beside its block bits and priorities has to be there, or it would be lost.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from rtron.coherence.flows import MAX_FLOWS, CoherenceProblem
from rtron.vocabulary import (
    GRCN,
    PRIVATE_ROOT,
    ROS2_ACTION_TOPICS,
    EventFlow,
    Flow,
    FpsMonitor,
    GuardedTopic,
    Mode,
    Plan,
    Ros1ActionTopic,
    WatchedFlow,
    action_name,
    is_action_type,
    matches_node,
    patterns_overlap,
    ros1_topic_name,
    ros2_entity_name,
)

_FIRST_NODE_ONLY = ("silent_after", "on_silence", "on_error", "rank")
_DEFAULT = Flow(name="", publisher="")


@dataclass(frozen=True, slots=True)
class _FirstNode:
    """The coordination node whose flows and successors count on a topic, and what it is called."""

    label: str
    part: GRCN | GuardedTopic


def private_topic_problems(plan: Plan) -> Iterator[CoherenceProblem]:
    """Refuse the guard's own topics: its output would come back to it."""
    for part, key, topic in _named_topics(plan):
        if topic.startswith(PRIVATE_ROOT + "/"):
            why = "the guard's own output would come back to it"
            yield part, key, f"{topic} is the guard's private topic: {why}"


def _named_topics(plan: Plan) -> Iterator[tuple[object, str, str]]:
    """Yield each topic of a plan, and the part and the key that name it."""
    guarded: list[GRCN | GuardedTopic] = list(plan.grcn)
    watched: list[FpsMonitor | WatchedFlow | EventFlow] = list(plan.fps_monitor)
    watched += [monitor.camera for monitor in plan.fps_monitor if monitor.camera]
    if plan.rsrcn:
        guarded, watched = [*guarded, *plan.rsrcn.vflows], [*watched, *plan.rsrcn.iflows]
    if plan.msrcn:
        guarded, watched = [*guarded, *plan.msrcn.aflows], [*watched, *plan.msrcn.eflows]
    yield from ((part, "topic", part.topic) for part in (*guarded, *watched))
    yield from ((grcn, "done", grcn.done) for grcn in plan.grcn if grcn.done)


def action_topic_problems(plan: Plan) -> Iterator[CoherenceProblem]:
    """Refuse an enforced topic that moves with an action's goals: it would be moved twice."""
    enforced: list[GRCN | GuardedTopic] = [g for g in plan.grcn if g.mode is Mode.ENFORCE]
    for _, mode, topics in _later_nodes(plan):
        enforced += topics if mode is Mode.ENFORCE else ()
    action_parts = {part: entry.topic for entry in enforced for part in _action_parts(entry)}
    for entry in enforced:
        if entry.topic in action_parts and not action_name(entry.topic, entry.type):
            goal = action_parts[entry.topic]
            message = f"{entry.topic} moves with {goal}, which is guarded: leave it out"
            yield entry, "topic", message
        yield from _ros2_action_problems(entry, plan.ros)


def _action_parts(entry: GRCN | GuardedTopic) -> Iterator[str]:
    """Yield the topics that move with the goals of an action."""
    action = action_name(entry.topic, entry.type)
    if is_action_type(entry.type):
        yield from (ros2_entity_name(action, end) for end in ROS2_ACTION_TOPICS)
    elif action:
        yield from (ros1_topic_name(action, part) for part in Ros1ActionTopic)


def _ros2_action_problems(part: GRCN | GuardedTopic, ros: int) -> Iterator[CoherenceProblem]:
    """Refuse what an action of ROS 2 cannot be: one of ROS 1, or one that its server asks for.

    A remap moves both ends of a node: its requests would go to itself, past the guard.
    """
    if not is_action_type(part.type):
        return
    if ros == 1:
        yield part, "type", f"{part.type} is an action of ROS 2, and the plan says `ros: 1`"
    for flow in part.flows[:MAX_FLOWS]:
        if any(matches_node(flow.publisher, node) for node in part.successors[:MAX_FLOWS]):
            message = f"{flow.publisher} is the server: what it asks of itself cannot be guarded"
            yield flow, "publisher", message


def shared_topic_problems(plan: Plan) -> Iterator[CoherenceProblem]:
    """Yield what a later node on a topic says in vain; one that observes shares with no other."""
    first = {(grcn.topic, grcn.mode): _FirstNode(f"GRCN {grcn.id}", grcn) for grcn in plan.grcn}
    for who, mode, topics in _later_nodes(plan):
        for topic in topics:
            if (topic.topic, mode) in first:
                yield from _ignored_settings(topic, first[topic.topic, mode])
        first_here = {(topic.topic, mode): _FirstNode(who, topic) for topic in topics}
        first = first_here | first


def _later_nodes(plan: Plan) -> Iterator[tuple[str, Mode, Sequence[GuardedTopic]]]:
    if plan.msrcn:
        yield "the MSRCN", plan.msrcn.mode, plan.msrcn.aflows
    if plan.rsrcn:
        yield "the RSRCN", plan.rsrcn.mode, plan.rsrcn.vflows


def _ignored_settings(topic: GuardedTopic, first: _FirstNode) -> Iterator[CoherenceProblem]:
    for flow in topic.flows[:MAX_FLOWS]:
        yield from _ignored_flow_settings(flow, first)
    if topic.uses not in ((), first.part.uses):
        yield topic, "uses", f"uses would be lost: set it on {_first_node_text(first)}"
    for node in _missing_successors(
        topic.successors[:MAX_FLOWS], first.part.successors[:MAX_FLOWS]
    ):
        yield (
            topic,
            "successors",
            f"{node} is no successor of {_first_node_text(first)}: add it there",
        )


def _missing_successors(nodes: Sequence[str], successors: Sequence[str]) -> Iterator[str]:
    """Yield the nodes that are none of the successors."""
    exact_names, patterns = set(successors), [name for name in successors if "*" in name]
    for node in nodes:
        if node not in exact_names and not any(matches_node(pattern, node) for pattern in patterns):
            yield node


def _ignored_flow_settings(flow: Flow, first: _FirstNode) -> Iterator[CoherenceProblem]:
    alike = [each for each in first.part.flows[:MAX_FLOWS] if _publishers_overlap(flow, each)]
    if not alike:
        yield (
            flow,
            "publisher",
            f"{flow.publisher} has no flow in {_first_node_text(first)}: add one there",
        )
    for key in _FIRST_NODE_ONLY:
        value = getattr(flow, key)
        counting = next((each for each in alike if getattr(each, key) != value), None)
        if counting and value != getattr(_DEFAULT, key):
            where = f"the flow {counting.name} of {_first_node_text(first)}"
            yield flow, key, f"{key} of {flow.name} would be lost: set it on {where}"


def _first_node_text(first: _FirstNode) -> str:
    return f"{first.label}, which is first on {first.part.topic}"


def _publishers_overlap(one: Flow, other: Flow) -> bool:
    """Tell whether two flows may be of one node, as in the streams that are made of them."""
    if "*" not in one.publisher + other.publisher:
        return one.publisher == other.publisher
    return patterns_overlap(one.publisher, other.publisher)
