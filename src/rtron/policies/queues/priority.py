"""Priority_Queue: the highest first, and lower ones wait.

## What it does

**Commands** (velocities): a message waits while a higher flow has published within that flow's
`timeout`. Then the freshest message of the highest waiting flow goes. Each flow keeps its freshest
message only. A message passes at once if no higher flow stands before it.

**Actions and states**: nothing interrupts the action in progress. When it is done or overdue (after
the `timeout` of its flow, at most `max_hold`), the earliest one of the highest flow goes.

A waiting message is dropped after `max_age`, and a new one if `queue_size` messages or 67 MB wait.

## When to use it

For flows that must be completed in the order of their importance. Unlike with Preemption, a lower
flow's last command is not lost, if it is not too old when the higher flows are silent.

## Settings

| setting | of | meaning |
|---|---|---|
| `priority` | each flow | the higher goes first; no two flows may have the same |
| `timeout` | each flow | commands: how long lower ones wait; actions: how long one may take |
| `max_hold` | the policy | actions: the longest that one may take (600 s) |
| `max_age` | the policy | a message that has waited so long is dropped (0.5 s) |
| `queue_size` | the policy | the number of messages that may wait (100) |
| `release_after` | the policy | commands: the `timeout` of flows that have none (0.5 s) |
| `block` | each flow | the flow's messages are dropped |

## States

A command that waited counts as spoken when it goes, so that no lower one overrides it at once.
A higher flow takes the turn from a lower one with its first command.

## Example

>>> from rtron.policies import build_policy
>>> from rtron.vocabulary import SECOND, Flow, PolicyName, PolicySettings, StreamKind
>>> policy = build_policy(PolicySettings(
...     policy=PolicyName.PRIORITY_QUEUE,
...     kind=StreamKind.COMMAND,
...     flows=(
...         Flow(name="flow1", publisher="/navigation_control", priority=1),
...         Flow(name="flow2", publisher="/tele_operation", priority=2),
...         Flow(name="flow3", publisher="/safe_control", priority=3, timeout=SECOND // 5),
...     ),
... ))
>>> print(policy.verdict("flow3", "stop", now=0).decision)
pass
>>> verdict = policy.verdict("flow2", "left", now=SECOND // 10)
>>> print(verdict.decision, "because", verdict.reason)
hold because flow3 has the output (priority 3)
>>> policy.deadline() == SECOND // 5
True
>>> for release in policy.tick(now=SECOND // 5):
...     print(release.message, release.verdict.decision, "because", release.verdict.reason)
left pass because its turn came after 0.10 s
"""

from collections.abc import Mapping

from rtron.policies.active_flows import ActiveFlows, FlowActivity
from rtron.policies.queues.message_queue import TABLE, MessageQueue
from rtron.policies.queues.output_lease import ExclusiveLease
from rtron.policies.state_transfer import LeaseState, PolicyState
from rtron.policies.verdicts import (
    check_priorities,
    goes_next_reason,
    owns_output_reason,
    with_priority,
)
from rtron.vocabulary import Flow, PolicySettings, StreamKind

__all__ = ["TABLE", "PriorityQueue"]


class PriorityQueue(MessageQueue):
    """One turn at a time, in order of priority."""

    def __init__(self, settings: PolicySettings) -> None:
        check_priorities(settings)
        commands = settings.kind is StreamKind.COMMAND
        turn = PriorityLease(settings) if commands else ExclusiveLease(settings, renewable=False)
        super().__init__(settings, turn, rank=lambda flow: -flow.priority)


class PriorityLease:
    """A flow that has spoken masks all lower ones until it is silent for its `timeout`.

    `release_after` stands in for a timeout that is not set. A command that goes counts as spoken
    at that moment: what the robot does just now is not overridden at once by a lower flow.
    """

    __slots__ = ("_active_flows", "_highest_active", "_owner")

    def __init__(self, settings: PolicySettings) -> None:
        default = settings.release_after
        self._active_flows = ActiveFlows(
            settings.flows, lambda flow: default if flow.timeout is None else flow.timeout
        )
        self._highest_active: FlowActivity | None = None
        self._owner: FlowActivity | None = None

    @property
    def owner(self) -> Flow | None:
        """The flow whose command went last, while it is fresh."""
        return self._owner.flow if self._owner else None

    def record_message(self, flow: Flow, now: int) -> None:
        """Let `flow` mask the lower ones from now on."""
        self._active_flows.record_message(self._active_flows.by_name[flow.name], now)
        self._highest_active = self._active_flows.highest_priority(now)

    def wait_reason(self, flow: Flow, first: Flow | None) -> str:
        """Let a message go if no higher flow is fresh and none of a higher flow waits."""
        active = self._highest_active
        if active and active.flow.priority > flow.priority:
            reason = owns_output_reason if active is self._owner else goes_next_reason
            return with_priority(active.flow, reason(active.flow))
        if first and first.priority > flow.priority:
            return with_priority(first, goes_next_reason(first))
        return ""

    def grant(self, flow: Flow, now: int) -> None:
        """Give the turn to `flow`, or renew it."""
        self.record_message(flow, now)
        self._owner = self._active_flows.by_name[flow.name]

    def expire(self, now: int) -> None:
        """Forget who fell silent."""
        self._highest_active = self._active_flows.highest_priority(now)
        if self._owner and now >= self._owner.expires_at:
            self._owner = None

    def forget(self, flow: str, now: int) -> None:
        """Take the flow for silent."""
        self._active_flows.forget(flow, now)

    def release(self, now: int) -> None:
        """Take the owner for silent."""
        if self._owner:
            self._owner.expires_at = now

    def expiry(self) -> int | None:
        """Return when the owner falls silent, or a flow that masks although its message is gone."""
        active = self._owner or self._highest_active
        return active.expires_at if active else None

    def state(self) -> LeaseState | None:
        """Return whose turn it is; of a command, only when it went last matters."""
        owner = self._owner
        if owner is None:
            return None
        sent_at = owner.expires_at - owner.timeout
        return LeaseState(owner.flow.name, sent_at, sent_at)

    def last_message_times(self, now: int) -> Mapping[str, int]:
        """Return when each fresh flow spoke last."""
        return self._active_flows.last_message_times(now)

    def restore(self, owner: Flow | None, state: PolicyState) -> None:
        """Know who spoke when; the owner stays the one whose command went last."""
        self._active_flows.restore(state.last_message_times)
        if owner and owner.name in state.last_message_times:
            self._owner = self._active_flows.by_name[owner.name]
