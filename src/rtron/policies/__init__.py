"""Policies: sans-I/O state machines that decide about every message of a coordination node."""

from collections.abc import Callable, Mapping

from rtron.policies.authority.command_lease import CommandLease
from rtron.policies.authority.lease import Lease
from rtron.policies.block import Block
from rtron.policies.policy import Policy, Release
from rtron.policies.preemption import Preemption
from rtron.policies.queues.fifo import FIFOQueue
from rtron.policies.queues.priority import PriorityQueue
from rtron.policies.velocity_limit.constrain import Constrain
from rtron.policies.velocity_limit.frame_monitors import FrameMonitors
from rtron.policies.velocity_limit.safe import Safe
from rtron.policies.velocity_limit.safe_constrain import SafeConstrain
from rtron.vocabulary import PolicyName, PolicySettings

__all__ = ["POLICIES", "FrameMonitors", "Policy", "Release", "build_policy"]

_FLOW_POLICIES: Mapping[PolicyName, Callable[[PolicySettings], Policy]] = {
    PolicyName.BLOCK: Block,
    PolicyName.FIFO_QUEUE: FIFOQueue,
    PolicyName.PRIORITY_QUEUE: PriorityQueue,
    PolicyName.PREEMPTION: Preemption,
}
_LIMIT_POLICIES: Mapping[PolicyName, Callable[[PolicySettings, FrameMonitors], Policy]] = {
    PolicyName.SAFE: Safe,
    PolicyName.CONSTRAIN: Constrain,
    PolicyName.SAFE_CONSTRAIN: SafeConstrain,
}
POLICIES: Mapping[PolicyName, Callable[..., Policy]] = {
    **_FLOW_POLICIES,
    **_LIMIT_POLICIES,
    PolicyName.LEASE: Lease,
}


def build_policy(
    settings: PolicySettings,
    monitors: FrameMonitors | None = None,
    leases: Mapping[str, CommandLease] | None = None,
) -> Policy:
    """Return the policy that `settings` name.

    `monitors` are what Safe is about, `leases` what Lease is: one that is not there has no
    commander.
    """
    if settings.policy is PolicyName.LEASE:
        unknown = CommandLease(settings.lease, (), ttl=0)
        return Lease(settings, (leases or {}).get(settings.lease, unknown))
    limit = _LIMIT_POLICIES.get(settings.policy)
    return (
        limit(settings, monitors or FrameMonitors())
        if limit
        else _FLOW_POLICIES[settings.policy](settings)
    )
