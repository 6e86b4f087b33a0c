"""Whether the coordination nodes on one topic say only what counts.

A stream has the flows and successors of its first node, in the order GRCN, MSRCN, RSRCN. What a
later one says beside its block bits and priorities has to be there, or it would be lost.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from rtron.planning.coherence.flows import MOST_FLOWS, Misfit
from rtron.vocabulary import (
    GRCN,
    TOLD,
    ActionPart,
    Flow,
    GuardedTopic,
    Mode,
    Plan,
    action_of,
    end_name,
    is_action_type,
    names_node,
    part_topic,
)

_FIRST_ONLY = ("silent_after", "on_silence", "on_error")
_DEFAULT = Flow(name="", publisher="")


@dataclass(frozen=True, slots=True)
class _First:
    """The coordination node whose flows and successors count on a topic, and what it is called."""

    who: str
    noun: GRCN | GuardedTopic


def action_misfits(plan: Plan) -> Iterator[Misfit]:
    """Refuse an enforced topic that moves with an action's goals: it would be moved twice."""
    enforced: list[GRCN | GuardedTopic] = [g for g in plan.grcn if g.mode is Mode.ENFORCE]
    for _, mode, topics in _later(plan):
        enforced += topics if mode is Mode.ENFORCE else ()
    parts = {part: noun.topic for noun in enforced for part in _parts(noun)}
    for noun in enforced:
        if noun.topic in parts and not action_of(noun.topic, noun.type):
            goal = parts[noun.topic]
            told = f"{noun.topic} moves with {goal}, which is guarded: leave it out"
            yield noun, "topic", told
        yield from _requests(noun, plan.ros)


def _parts(noun: GRCN | GuardedTopic) -> Iterator[str]:
    """Yield the topics that move with the goals of an action."""
    action = action_of(noun.topic, noun.type)
    if is_action_type(noun.type):
        yield from (end_name(action, end) for end in TOLD)
    elif action:
        yield from (part_topic(action, part) for part in ActionPart)


def _requests(noun: GRCN | GuardedTopic, ros: int) -> Iterator[Misfit]:
    """Refuse what an action of ROS 2 cannot be: one of ROS 1, or one that its server asks for.

    A remap moves both ends of a node: its requests would go to itself, past the guard.
    """
    if not is_action_type(noun.type):
        return
    if ros == 1:
        yield noun, "type", f"{noun.type} is an action of ROS 2, and the plan says `ros: 1`"
    for flow in noun.flows[:MOST_FLOWS]:
        if any(names_node(flow.publisher, node) for node in noun.successors[:MOST_FLOWS]):
            told = f"{flow.publisher} is the server: what it asks of itself cannot be guarded"
            yield flow, "publisher", told


def shared_misfits(plan: Plan) -> Iterator[Misfit]:
    """Yield what a later node on a topic says in vain; one that observes shares with no other."""
    first = {(grcn.topic, grcn.mode): _First(f"GRCN {grcn.id}", grcn) for grcn in plan.grcn}
    for who, mode, topics in _later(plan):
        for topic in topics:
            if (topic.topic, mode) in first:
                yield from _lost(topic, first[topic.topic, mode])
        own = {(topic.topic, mode): _First(who, topic) for topic in topics}
        first = own | first


def _later(plan: Plan) -> Iterator[tuple[str, Mode, Sequence[GuardedTopic]]]:
    if plan.msrcn:
        yield "the MSRCN", plan.msrcn.mode, plan.msrcn.aflows
    if plan.rsrcn:
        yield "the RSRCN", plan.rsrcn.mode, plan.rsrcn.vflows


def _lost(topic: GuardedTopic, first: _First) -> Iterator[Misfit]:
    for flow in topic.flows[:MOST_FLOWS]:
        yield from _lost_of_flow(flow, first)
    for node in _unheard(topic.successors[:MOST_FLOWS], first.noun.successors[:MOST_FLOWS]):
        yield topic, "successors", f"{node} is no successor of {_counts(first)}: add it there"


def _unheard(nodes: Sequence[str], successors: Sequence[str]) -> Iterator[str]:
    """Yield the nodes that are none of the successors."""
    whole, patterns = set(successors), [name for name in successors if "*" in name]
    for node in nodes:
        if node not in whole and not any(names_node(pattern, node) for pattern in patterns):
            yield node


def _lost_of_flow(flow: Flow, first: _First) -> Iterator[Misfit]:
    alike = [each for each in first.noun.flows[:MOST_FLOWS] if _overlap(flow, each)]
    if not alike:
        yield flow, "publisher", f"{flow.publisher} has no flow in {_counts(first)}: add one there"
    for key in _FIRST_ONLY:
        value = getattr(flow, key)
        counting = next((each for each in alike if getattr(each, key) != value), None)
        if counting and value != getattr(_DEFAULT, key):
            where = f"the flow {counting.name} of {_counts(first)}"
            yield flow, key, f"{key} of {flow.name} would be lost: set it on {where}"


def _counts(first: _First) -> str:
    return f"{first.who}, which is first on {first.noun.topic}"


def _overlap(one: Flow, other: Flow) -> bool:
    """Tell whether two flows may be of one node, as in the streams that are made of them."""
    if "*" not in one.publisher + other.publisher:
        return one.publisher == other.publisher
    return names_node(one.publisher, other.publisher) or names_node(other.publisher, one.publisher)
