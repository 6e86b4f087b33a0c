"""Policies: sans-I/O state machines that decide about every message of a coordination node."""

from collections.abc import Callable, Mapping

from rtron.errors import PlanError
from rtron.policies.block import Block
from rtron.policies.fifo_queue import FIFOQueue
from rtron.policies.policy import Policy, Release
from rtron.policies.preemption import Preemption
from rtron.policies.priority_queue import PriorityQueue
from rtron.vocabulary import PolicyName, PolicySettings

__all__ = ["POLICIES", "Policy", "Release", "build"]

POLICIES: Mapping[PolicyName, Callable[[PolicySettings], Policy]] = {
    PolicyName.BLOCK: Block,
    PolicyName.FIFO_QUEUE: FIFOQueue,
    PolicyName.PRIORITY_QUEUE: PriorityQueue,
    PolicyName.PREEMPTION: Preemption,
}


def build(settings: PolicySettings) -> Policy:
    """Return the policy that `settings` name."""
    policy = POLICIES.get(settings.policy)
    if policy is None:
        available = ", ".join(POLICIES)
        raise PlanError(
            f"the policy {settings.policy} is not available yet", help=f"choose from {available}"
        )
    return policy(settings)
