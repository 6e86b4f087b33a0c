"""What holds for the flows and policies of every coordination node."""

from collections.abc import Callable, Hashable, Iterable, Iterator, Sequence
from itertools import product
from typing import TypeVar

from rtron.vocabulary import (
    GRCN,
    MSRCN,
    RSRCN,
    UNAPPROVED,
    EventFlow,
    Flow,
    GuardedTopic,
    PolicyName,
    WatchedFlow,
    names_node,
)

T = TypeVar("T")
Misfit = tuple[object, str, str]
"""A noun, its key (or an empty text for the whole) and what is wrong with it."""

# The private topics of a guarded topic end in a flow's name, or in `out`.
RESERVED = (UNAPPROVED, "out")
MOST_FLOWS = 1000


def same_topic(guarded: Sequence[GRCN | GuardedTopic], who: str) -> Iterator[Misfit]:
    """Yield each noun on a topic that an earlier one has already."""
    for noun in repeated(guarded, lambda noun: noun.topic):
        yield noun, "topic", f"two {who} on {noun.topic}"


def guarded_misfits(
    topics: Sequence[GuardedTopic], watched: Sequence[WatchedFlow | EventFlow]
) -> Iterator[Misfit]:
    """Yield what is wrong with the flows of an RSRCN or MSRCN."""
    yield from same_topic(topics, "entries")
    yield from flow_names([*(flow for topic in topics for flow in topic.flows), *watched])
    for topic in topics:
        yield from publishers(topic.flows)
        yield from successors(topic)


def policy_misfit(
    noun: GRCN | RSRCN | MSRCN, who: str, policy: PolicyName, allowed: Iterable[PolicyName]
) -> Iterator[Misfit]:
    """Refuse a policy that is for other coordination nodes."""
    if policy not in allowed:
        yield noun, "policy", f"{policy} is not for {who}: choose from {', '.join(allowed)}"


def flow_names(flows: Sequence[Flow | WatchedFlow | EventFlow]) -> Iterator[Misfit]:
    """Refuse names that repeat, and those that the guard uses itself."""
    for flow in repeated(flows, lambda flow: flow.name):
        yield flow, "name", f"two flows have the name {flow.name}"
    for flow in flows:
        if flow.name in RESERVED:
            yield flow, "name", f"{flow.name} is the guard's own: choose another name"


def publishers(flows: Sequence[Flow]) -> Iterator[Misfit]:
    """Refuse a publisher that belongs to two flows of one topic."""
    for flow in repeated(flows, lambda flow: flow.publisher):
        yield flow, "publisher", f"{flow.publisher} has two flows: which one would it take?"
    if len(flows) > MOST_FLOWS:
        yield flows[MOST_FLOWS], "", f"more than {MOST_FLOWS} flows into one topic"
        return
    patterns = [flow for flow in flows if "*" in flow.publisher]
    for pattern, flow in product(patterns, flows):
        if pattern.publisher != flow.publisher and names_node(pattern.publisher, flow.publisher):
            both = f"{pattern.name} ({pattern.publisher}) too"
            yield flow, "publisher", f"{flow.publisher} belongs to {both}"


def successors(noun: GRCN | GuardedTopic) -> Iterator[Misfit]:
    """Refuse more successors than can be compared with each other."""
    if len(noun.successors) > MOST_FLOWS:
        yield noun, "successors", f"more than {MOST_FLOWS} successors of one topic"


def priorities(flows: Sequence[Flow], policy: PolicyName) -> Iterator[Misfit]:
    """Refuse a priority that an earlier flow has already."""
    for flow in repeated(flows, lambda flow: flow.priority):
        who = next(f.name for f in flows if f.priority == flow.priority)
        told = f"{who} and {flow.name} have the same priority {flow.priority}"
        yield flow, "priority", f"{told}: who goes first with {policy}?"


def repeated(nouns: Iterable[T], key: Callable[[T], Hashable]) -> Iterator[T]:
    """Yield each noun whose key an earlier one has already."""
    seen: set[Hashable] = set()
    for noun in nouns:
        if key(noun) in seen:
            yield noun
        seen.add(key(noun))
