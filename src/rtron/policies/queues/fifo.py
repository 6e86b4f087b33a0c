"""FIFO_Queue: one at a time, in order of arrival.

## What it does

**Actions and states**: one action is in progress at a time, and the others wait. The next goes when
the one in progress is done or overdue: after the `timeout` of its flow, at most `max_hold`.

**Commands** (velocities): one flow has the turn, and its messages pass at once, until the flow is
silent for its `timeout`, done, or `max_hold` has passed. Each other flow keeps its freshest message
only. The next turn goes to the flow that has waited longest, and begins with that message.

A waiting message is dropped after `max_age`, and a new one if `queue_size` messages or 67 MB wait.

## When to use it

For actions that must be completed before the next begins, such as goals of a navigation.

## Settings

| setting | of | meaning |
|---|---|---|
| `timeout` | each flow | actions: how long one may take; commands: the silence that ends a turn |
| `max_hold` | the policy | the longest that a turn lasts (600 s) |
| `max_age` | the policy | a message that has waited so long is dropped (0.5 s) |
| `queue_size` | the policy | the number of messages that may wait (100) |
| `release_after` | the policy | commands: the `timeout` of flows that have none (0.5 s) |
| `block` | each flow | the flow's messages are dropped |

For actions, set `max_age` to the time after which a goal is better not reached at all.

## States

Silence counts from the last message that passed, also from one that waited and then went.

## Example

>>> from rtron.policies import build_policy
>>> from rtron.vocabulary import SECOND, Flow, PolicyName, PolicySettings, StreamKind
>>> policy = build_policy(PolicySettings(
...     policy=PolicyName.FIFO_QUEUE,
...     kind=StreamKind.ACTION,
...     flows=(
...         Flow(name="flow1", publisher="/search_manager", timeout=60 * SECOND),
...         Flow(name="flow2", publisher="/rviz"),
...     ),
...     max_age=300 * SECOND,
... ))
>>> policy.verdict("flow1", "kitchen", now=0).reason
'flow1 has the output'
>>> print(policy.verdict("flow2", "street", now=10 * SECOND).decision)
hold
>>> policy.observe_done(now=25 * SECOND)
>>> for release in policy.tick(now=25 * SECOND):
...     print(release.message, release.verdict.decision, "because", release.verdict.reason)
street pass because its turn came after 15.00 s
"""

from rtron.policies.queues.message_queue import TABLE, MessageQueue
from rtron.policies.queues.output_lease import ExclusiveLease
from rtron.vocabulary import PolicySettings, StreamKind

__all__ = ["TABLE", "FIFOQueue"]


class FIFOQueue(MessageQueue):
    """One turn at a time, in order of arrival."""

    def __init__(self, settings: PolicySettings) -> None:
        turn = ExclusiveLease(settings, renewable=settings.kind is StreamKind.COMMAND)
        super().__init__(settings, turn, rank=lambda _: 0)
