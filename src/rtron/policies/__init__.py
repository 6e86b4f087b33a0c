"""Policies: sans-I/O state machines that decide about every message of a coordination node."""

from collections.abc import Callable, Mapping

from rtron.policies.block import Block
from rtron.policies.policy import Policy, Release
from rtron.policies.preemption import Preemption
from rtron.policies.queues.fifo import FIFOQueue
from rtron.policies.queues.priority import PriorityQueue
from rtron.policies.velocity_limit.constrain import Constrain
from rtron.policies.velocity_limit.frame_monitors import Rates
from rtron.policies.velocity_limit.safe import Safe
from rtron.policies.velocity_limit.safe_constrain import SafeConstrain
from rtron.vocabulary import PolicyName, PolicySettings

__all__ = ["POLICIES", "Policy", "Rates", "Release", "build"]

_PLAIN: Mapping[PolicyName, Callable[[PolicySettings], Policy]] = {
    PolicyName.BLOCK: Block,
    PolicyName.FIFO_QUEUE: FIFOQueue,
    PolicyName.PRIORITY_QUEUE: PriorityQueue,
    PolicyName.PREEMPTION: Preemption,
}
_LIMITS: Mapping[PolicyName, Callable[[PolicySettings, Rates], Policy]] = {
    PolicyName.SAFE: Safe,
    PolicyName.CONSTRAIN: Constrain,
    PolicyName.SAFE_CONSTRAIN: SafeConstrain,
}
POLICIES: Mapping[PolicyName, Callable[..., Policy]] = {**_PLAIN, **_LIMITS}


def build(settings: PolicySettings, rates: Rates | None = None) -> Policy:
    """Return the policy that `settings` name; `rates` are what Safe is about."""
    limit = _LIMITS.get(settings.policy)
    return limit(settings, rates or Rates()) if limit else _PLAIN[settings.policy](settings)
