"""Whether a plan agrees with itself: what no single value shows. Each check yields its faults."""

from collections.abc import Callable, Hashable, Iterable, Iterator, Sequence
from itertools import chain, product
from typing import TypeVar

from rtron.vocabulary import (
    GRCN,
    MSRCN,
    RSRCN,
    UNAPPROVED,
    Flow,
    FpsMonitor,
    GuardedTopic,
    Plan,
    PolicyName,
    Sharing,
    WatchedFlow,
    names_node,
)

T = TypeVar("T")
Misfit = tuple[object, str, str]
"""A noun, its key (or an empty text for the whole) and what is wrong with it."""

GRCN_POLICIES = (
    PolicyName.BLOCK,
    PolicyName.FIFO_QUEUE,
    PolicyName.PRIORITY_QUEUE,
    PolicyName.PREEMPTION,
)
RSRCN_POLICIES = (PolicyName.BLOCK, PolicyName.SAFE, PolicyName.CONSTRAIN)
MSRCN_POLICIES = (PolicyName.BLOCK,)
RANKED = (PolicyName.PRIORITY_QUEUE, PolicyName.PREEMPTION)
# The private topics of a guarded topic end in a flow's name, or in `out`.
RESERVED = (UNAPPROVED, "out")
MOST_FLOWS = 1000


def misfits(plan: Plan) -> Iterator[Misfit]:
    """Yield everything in which a plan contradicts itself."""
    yield from _ids(plan)
    yield from _same_topic(plan.grcn, "GRCNs")
    yield from chain.from_iterable(map(_grcn, plan.grcn))
    yield from _rsrcn(plan.rsrcn) if plan.rsrcn else ()
    yield from _msrcn(plan.msrcn) if plan.msrcn else ()


def _ids(plan: Plan) -> Iterator[Misfit]:
    single = [node for node in (plan.rsrcn, plan.msrcn) if node]
    nodes: Sequence[GRCN | RSRCN | MSRCN | FpsMonitor] = [*plan.grcn, *single, *plan.fps_monitor]
    for node in _repeated(nodes, lambda node: node.id):
        yield node, "id", f"two coordination nodes have the id {node.id}"


def _same_topic(guarded: Sequence[GRCN | GuardedTopic], who: str) -> Iterator[Misfit]:
    for noun in _repeated(guarded, lambda noun: noun.topic):
        yield noun, "topic", f"two {who} on {noun.topic}"


def _grcn(grcn: GRCN) -> Iterator[Misfit]:
    yield from _policy(grcn, "a GRCN", grcn.policy, GRCN_POLICIES)
    yield from _flow_names(grcn.flows)
    yield from _publishers(grcn.flows)
    yield from _shared_names(grcn)
    if grcn.policy in RANKED:
        yield from _priorities(grcn)
    if grcn.sharing is Sharing.MERGE and grcn.policy is not PolicyName.BLOCK:
        why = f"the publishers of {grcn.topic} each own a part (merge), they take no turns"
        yield grcn, "policy", f"{grcn.policy} is not for {grcn.topic}: {why}; choose Block"
    if grcn.done == grcn.topic:
        yield grcn, "done", f"{grcn.topic} cannot tell itself that an action is done"


def _shared_names(grcn: GRCN) -> Iterator[Misfit]:
    """Refuse a successor behind a pattern: it would hear its namesakes past the guard."""
    for flow, node in product(grcn.flows, grcn.successors):
        if "*" in flow.publisher + node and _overlap(flow.publisher, node):
            why = f"{flow.publisher} and the successor {node} may be one node"
            yield flow, "publisher", f"{why}: give it a flow under its full name"


def _overlap(one: str, other: str) -> bool:
    return names_node(one, other) or names_node(other, one)


def _rsrcn(rsrcn: RSRCN) -> Iterator[Misfit]:
    yield from _policy(rsrcn, "the RSRCN", rsrcn.policy, RSRCN_POLICIES)
    yield from _guarded(rsrcn.vflows, rsrcn.iflows)


def _msrcn(msrcn: MSRCN) -> Iterator[Misfit]:
    yield from _policy(msrcn, "the MSRCN", msrcn.policy, MSRCN_POLICIES)
    yield from _guarded(msrcn.aflows, msrcn.eflows)


def _guarded(topics: Sequence[GuardedTopic], watched: Sequence[WatchedFlow]) -> Iterator[Misfit]:
    yield from _same_topic(topics, "entries")
    yield from _flow_names([*(flow for topic in topics for flow in topic.flows), *watched])
    yield from chain.from_iterable(_publishers(topic.flows) for topic in topics)


def _policy(
    noun: GRCN | RSRCN | MSRCN, who: str, policy: PolicyName, allowed: Iterable[PolicyName]
) -> Iterator[Misfit]:
    if policy not in allowed:
        yield noun, "policy", f"{policy} is not for {who}: choose from {', '.join(allowed)}"


def _flow_names(flows: Sequence[Flow | WatchedFlow]) -> Iterator[Misfit]:
    for flow in _repeated(flows, lambda flow: flow.name):
        yield flow, "name", f"two flows have the name {flow.name}"
    for flow in flows:
        if flow.name in RESERVED:
            yield flow, "name", f"{flow.name} is the guard's own: choose another name"


def _publishers(flows: Sequence[Flow]) -> Iterator[Misfit]:
    for flow in _repeated(flows, lambda flow: flow.publisher):
        yield flow, "publisher", f"{flow.publisher} has two flows: which one would it take?"
    if len(flows) > MOST_FLOWS:
        yield flows[MOST_FLOWS], "", f"more than {MOST_FLOWS} flows into one topic"
        return
    patterns = [flow for flow in flows if "*" in flow.publisher]
    for pattern, flow in product(patterns, flows):
        if pattern.publisher != flow.publisher and names_node(pattern.publisher, flow.publisher):
            both = f"{pattern.name} ({pattern.publisher}) too"
            yield flow, "publisher", f"{flow.publisher} belongs to {both}"


def _priorities(grcn: GRCN) -> Iterator[Misfit]:
    for flow in _repeated(grcn.flows, lambda flow: flow.priority):
        who = next(f.name for f in grcn.flows if f.priority == flow.priority)
        told = f"{who} and {flow.name} have the same priority {flow.priority}"
        yield flow, "priority", f"{told}: who goes first with {grcn.policy}?"


def _repeated(nouns: Iterable[T], key: Callable[[T], Hashable]) -> Iterator[T]:
    """Yield each noun whose key an earlier one has already."""
    seen: set[Hashable] = set()
    for noun in nouns:
        if key(noun) in seen:
            yield noun
        seen.add(key(noun))
