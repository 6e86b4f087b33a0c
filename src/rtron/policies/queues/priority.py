"""Priority_Queue: the highest first, and lower ones wait.

## What it does

**Commands** (velocities): a message waits while a higher flow has spoken within the `timeout` of
that higher flow (`release_after` if it has none). When all higher flows are silent, the freshest
message of the highest waiting flow goes. Each flow keeps its freshest message only: a newer one
takes the place of the older, which is dropped. A message that no higher flow stands before passes
at once, even if lower ones wait.

**Actions and states**: each message is an action, and nothing interrupts the one in progress. The
next goes when it is done, or overdue: after the `timeout` of its flow, and after `max_hold` in
any case. The next is the one of the highest flow, and of this flow the earliest. It is settled at
the moment the turn ends, even if the tick is late.

A waiting message that reaches `max_age` is dropped, and so is one that finds `queue_size`
messages waiting, or 67 MB of them with it. A message leaves the queue at a tick only.

## When to use it

For flows that must be completed or heard in the order of their importance. Compared with
Preemption, a lower flow's last command is not lost: it goes as soon as the higher flows are
silent, if it is not too old by then.

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

from rtron.policies.queues.message_queue import TABLE, MessageQueue
from rtron.policies.queues.output_lease import ExclusiveLease
from rtron.policies.queues.priority_lease import PriorityLease
from rtron.policies.verdicts import check_priorities
from rtron.vocabulary import PolicySettings, StreamKind

__all__ = ["TABLE", "PriorityQueue"]


class PriorityQueue(MessageQueue):
    """One turn at a time, in order of priority."""

    def __init__(self, settings: PolicySettings) -> None:
        check_priorities(settings)
        commands = settings.kind is StreamKind.COMMAND
        turn = PriorityLease(settings) if commands else ExclusiveLease(settings, renewable=False)
        super().__init__(settings, turn, rank=lambda flow: -flow.priority)
