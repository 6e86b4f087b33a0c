"""Whether a GRCN agrees with itself."""

from collections.abc import Iterator
from itertools import product

from rtron.coherence.duration_bounds import command_duration_problems
from rtron.coherence.flows import (
    MAX_FLOWS,
    CoherenceProblem,
    flow_name_problems,
    policy_problems,
    priority_problems,
    publisher_problems,
    successor_problems,
    used_component_problems,
)
from rtron.coherence.leases import lease_policy_problems
from rtron.vocabulary import GRCN, PolicyName, Sharing, patterns_overlap

POLICIES = (
    PolicyName.BLOCK,
    PolicyName.FIFO_QUEUE,
    PolicyName.PRIORITY_QUEUE,
    PolicyName.PREEMPTION,
    PolicyName.LEASE,
)
PRIORITY_POLICIES = (PolicyName.PRIORITY_QUEUE, PolicyName.PREEMPTION)


def grcn_problems(grcn: GRCN) -> Iterator[CoherenceProblem]:
    """Yield everything in which a GRCN contradicts itself."""
    yield from grcn_policy_problems(grcn)
    yield from flow_name_problems(grcn.flows)
    yield from publisher_problems(grcn.flows)
    yield from successor_problems(grcn)
    yield from used_component_problems(grcn)
    yield from _shared_names(grcn)
    if grcn.done == grcn.topic:
        yield grcn, "done", f"{grcn.topic} cannot tell itself that an action is done"
    action, of_action, _ = (grcn.done or "").partition("/_action/")
    if of_action:
        yield grcn, "done", f"{grcn.done} is part of an action: name the action, {action}"


def grcn_policy_problems(grcn: GRCN) -> Iterator[CoherenceProblem]:
    """Yield what is wrong with the policy of a GRCN, its priorities and its durations."""
    yield from policy_problems(grcn, "a GRCN", grcn.policy, POLICIES)
    if grcn.policy in PRIORITY_POLICIES:
        yield from priority_problems(grcn.flows, grcn.policy)
    if grcn.policy is PolicyName.LEASE:
        yield from lease_policy_problems(grcn)
    yield from command_duration_problems(grcn)
    if grcn.sharing is Sharing.MERGE and grcn.policy is not PolicyName.BLOCK:
        why = f"the publishers of {grcn.topic} each own a part (merge), they take no turns"
        yield grcn, "policy", f"{grcn.policy} is not for {grcn.topic}: {why}; choose Block"


def _shared_names(grcn: GRCN) -> Iterator[CoherenceProblem]:
    """Refuse a successor behind a pattern: it would hear its namesakes past the guard."""
    for flow, node in product(grcn.flows, grcn.successors[:MAX_FLOWS]):
        if "*" in flow.publisher + node and patterns_overlap(flow.publisher, node):
            why = f"{flow.publisher} and the successor {node} may be one node"
            yield flow, "publisher", f"{why}: give it a flow under its full name"
