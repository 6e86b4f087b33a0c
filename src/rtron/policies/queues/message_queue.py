"""What FIFO_Queue and Priority_Queue have in common: messages that wait for their turn.

The rule: **a held message leaves only in `tick`**, and `verdict` passes a message at once only if
nothing stands before it. Each call first lets time pass up to `now`: what is too old is dropped,
a turn that is over ends. If a tick is late, the message that was due is still the next to go, and
a newer one waits behind it. Two exceptions serve the freshest command: a newer message of
the same flow takes an older one's place, and under Priority_Queue a higher flow's command never
waits for a lower one.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace

from rtron.policies.policy import Release
from rtron.policies.queues.held_messages import HeldMessage, HeldMessageQueue, message_size
from rtron.policies.queues.output_lease import OutputLease
from rtron.policies.state_machine import StateMachine, TableEnum, TransitionEffect, TransitionTable
from rtron.policies.state_transfer import LeaseState, PolicyState
from rtron.policies.verdicts import FlowFilter, VerdictCache, format_seconds, owns_output_reason
from rtron.vocabulary import Decision, Flow, PolicySettings, StreamKind, Verdict
from rtron.vocabulary.plan import MAX_QUEUE_BYTES


class QueueState(TableEnum):
    """The states of a queue."""

    FREE = "nobody has the turn"
    TAKEN = "a flow has the turn"


class QueueInput(TableEnum):
    """What happens to a queue."""

    FIRST = "a message that nothing stands before"
    BEHIND = "a message that must wait"
    FULL = "a message that must wait, and the queue is full"
    REFUSED = "a message of a blocked or unknown flow"
    OVER = "the turn is over: done, overdue or silent"
    TURN = "a tick, and a waiting message may go"
    OCCUPIED = "an action is in progress that did not go through here"


TABLE: TransitionTable[QueueState, QueueInput] = {
    (QueueState.FREE, QueueInput.FIRST): (QueueState.TAKEN, TransitionEffect.PASS),
    (QueueState.FREE, QueueInput.BEHIND): (QueueState.FREE, TransitionEffect.HOLD),
    (QueueState.FREE, QueueInput.FULL): (QueueState.FREE, TransitionEffect.DROP),
    (QueueState.FREE, QueueInput.REFUSED): (QueueState.FREE, TransitionEffect.DROP),
    (QueueState.FREE, QueueInput.OVER): (QueueState.FREE, TransitionEffect.NEVER),
    (QueueState.FREE, QueueInput.TURN): (QueueState.TAKEN, TransitionEffect.RELEASE),
    (QueueState.FREE, QueueInput.OCCUPIED): (QueueState.TAKEN, TransitionEffect.NOTHING),
    (QueueState.TAKEN, QueueInput.FIRST): (QueueState.TAKEN, TransitionEffect.PASS),
    (QueueState.TAKEN, QueueInput.BEHIND): (QueueState.TAKEN, TransitionEffect.HOLD),
    (QueueState.TAKEN, QueueInput.FULL): (QueueState.TAKEN, TransitionEffect.DROP),
    (QueueState.TAKEN, QueueInput.REFUSED): (QueueState.TAKEN, TransitionEffect.DROP),
    (QueueState.TAKEN, QueueInput.OVER): (QueueState.FREE, TransitionEffect.NOTHING),
    (QueueState.TAKEN, QueueInput.TURN): (QueueState.TAKEN, TransitionEffect.NEVER),
    (QueueState.TAKEN, QueueInput.OCCUPIED): (QueueState.TAKEN, TransitionEffect.NOTHING),
}


class MessageQueue:
    """A policy that holds messages until `lease` lets them go, in the order of `rank`.

    Of commands, each flow keeps only its freshest. At most `queue_size` messages or
    MAX_QUEUE_BYTES wait, and as many more may be on their way out to the next tick.
    """

    def __init__(
        self, settings: PolicySettings, lease: OutputLease, rank: Callable[[Flow], int]
    ) -> None:
        self._filter = FlowFilter(settings)
        self._pass = VerdictCache(settings, Decision.PASS)
        self._hold = VerdictCache(settings, Decision.HOLD)
        self._drop = VerdictCache(settings, Decision.DROP)
        self._is_command = settings.kind is StreamKind.COMMAND
        self._max_age = settings.max_age
        self._too_old = f"too old: it waited {format_seconds(settings.max_age)}"
        self._queue_size = settings.queue_size
        self._machine = StateMachine(TABLE, QueueState.FREE)
        self._lease = lease
        self._held = HeldMessageQueue(rank)
        self._released: list[Release] = []
        self._now = 0

    def verdict(self, flow: str, message: object, now: int) -> Verdict:
        """Pass the message if nothing stands before it, otherwise hold it if there is room."""
        approved = self._filter.flows.get(flow)
        if approved is None:
            self._machine.step(QueueInput.REFUSED)
            return self._filter.refusal(flow)
        self._advance(now)
        self._lease.record_message(approved, now)
        first = self._held.first()
        reason = self._lease.wait_reason(approved, first.flow if first else None)
        full = self._full_reason(approved, message) if reason else ""
        effect = self._machine.step(
            QueueInput.FULL if full else QueueInput.BEHIND if reason else QueueInput.FIRST
        )
        if effect is TransitionEffect.PASS:
            return self._pass_message(approved, now)
        if effect is TransitionEffect.HOLD:
            self._hold_message(approved, message, now)
            return self._hold.get(flow, reason)
        return self._drop.get(flow, full)

    def refusal(self, flow: str, now: int, message: object = None) -> Verdict | None:  # noqa: ARG002
        """Return the refusal of a flow that is blocked or unknown."""
        return None if flow in self._filter.flows else self._filter.refusal(flow)

    def observe_done(self, now: int) -> None:
        """End the turn: what the output was taken for is done."""
        self._lease.release(now)
        self._advance(now)

    def occupy(self, flow: str, now: int) -> None:
        """Give the turn to `flow`, whoever it is: nothing goes while its action is in progress."""
        self._advance(now)
        self._machine.step(QueueInput.OCCUPIED)
        self._lease.grant(self._filter.flows.get(flow) or Flow(name=flow, publisher=flow), now)

    def withdraw(self, message: object, why: str) -> None:
        """Give up a message that waits."""
        held = self._held.find(message)
        if held:
            self._drop_held(held, why)

    def forget_flow(self, flow: str, now: int) -> None:
        """End the turn of a flow that gives commands, and drop what it wanted; goals stay."""
        if not self._is_command:
            return
        if held := self._held.latest(flow):
            self._drop_held(held, f"{flow} has lost its publisher")
        self._lease.forget(flow, now)
        self._advance(now)

    def tick(self, now: int) -> Sequence[Release]:
        """Let time pass, then let go whose turn it is; return everything that leaves."""
        self._advance(now)
        while held := self._next_ready():
            self._release_next(held, now)
            self._advance(now)
        return self._take_released()

    def close(self) -> Sequence[Release]:
        """Drop every message that still waits."""
        while held := self._held.oldest():
            self._drop_held(held, "the queue was closed")
        return self._take_released()

    def last_message_times(self, now: int) -> Mapping[str, int]:
        """Return when each fresh flow spoke last, and each whose command waits."""
        times = dict(self._lease.last_message_times(now))
        for each in self._held.messages() if self._is_command else ():
            times[each.flow.name] = max(each.arrived_at, times.get(each.flow.name, 0))
        return times

    def export_state(self, now: int) -> PolicyState:
        """Return who waits, whose turn it is, and who is fresh; `close` has what does not wait."""
        self._advance(now)
        held, last_message_times = self._held.messages(), self.last_message_times(now)
        for each in held:
            self._held.remove(each)
        return PolicyState(
            last_message_times=last_message_times,
            has_lease=True,
            lease=self._lease.state(),
            held_messages=held,
        )

    def restore_state(self, state: PolicyState, now: int) -> Sequence[Release]:
        """Hold what waited, in its order, and go on with the turn; refuse what is blocked here."""
        flows = self._filter.flows
        held = [each for each in state.held_messages if each.flow.name in flows]
        refused = [each for each in state.held_messages if each.flow.name not in flows]
        self._held.load(replace(each, flow=flows[each.flow.name]) for each in held)
        last_message_times = {
            name: at for name, at in state.last_message_times.items() if name in flows
        }
        self._lease.restore(
            self._continued_owner(state.lease),
            replace(state, last_message_times=last_message_times),
        )
        if self._lease.owner:
            self._machine.step(QueueInput.OCCUPIED)
        self._advance(now)
        return self._filter.release_held(refused)

    def revise(self, revision: int) -> None:
        """Say from now on that verdicts are by settings of `revision`."""
        for each in (self._filter, self._pass, self._hold, self._drop):
            each.revise(revision)

    def deadline(self) -> int | None:
        """Return when a turn ends or a message grows too old; the present if something is due."""
        if self._released or self._next_ready():
            return self._now
        oldest = self._held.oldest()
        expires = oldest.arrived_at + self._max_age if oldest else None
        times = (self._lease.expiry(), expires)
        return min((time for time in times if time is not None), default=None)

    @property
    def owner(self) -> str | None:
        """The flow whose turn it is, as of the last call."""
        owner = self._lease.owner
        return owner.name if owner else None

    def _continued_owner(self, lease: LeaseState | None) -> Flow | None:
        """Return whose turn goes on: an action is in progress, even if its flow is blocked now."""
        if lease is None:
            return None
        flow = self._filter.flows.get(lease.flow)
        return flow if flow or self._is_command else Flow(name=lease.flow, publisher=lease.flow)

    def _advance(self, now: int) -> None:
        self._now = now
        while (held := self._held.oldest()) and now - held.arrived_at >= self._max_age:
            self._drop_held(held, self._too_old)
        self._lease.expire(now)
        if self._lease.owner is None:
            self._handle_lease_end()

    def _handle_lease_end(self) -> None:
        if self._machine.state is QueueState.TAKEN:
            self._machine.step(QueueInput.OVER)
        if not self._is_command:
            self._held.pin_first()

    def _pass_message(self, flow: Flow, now: int) -> Verdict:
        self._lease.grant(flow, now)
        if older := self._superseded(flow):
            self._held.remove(older)
            self._add_release(older, self._superseded_verdict(flow))
        return self._pass.get(flow.name, owns_output_reason(flow))

    def _hold_message(self, flow: Flow, message: object, now: int) -> None:
        if older := self._superseded(flow):
            self._add_release(older, self._superseded_verdict(flow))
            self._held.replace_message(older, message, now)
        else:
            self._held.add(flow, message, now)

    def _superseded(self, flow: Flow) -> HeldMessage | None:
        return self._held.latest(flow.name) if self._is_command else None

    def _full_reason(self, flow: Flow, message: object) -> str:
        """Return why a message cannot wait, "" if it can."""
        older, waiting, leaving = self._superseded(flow), len(self._held), len(self._released)
        is_full = waiting >= self._queue_size and not older
        if is_full or waiting + leaving >= 2 * self._queue_size:
            return f"the queue is full ({self._queue_size})"
        size = self._held.size + message_size(message) - message_size(older and older.message)
        size_with_leaving = size + sum(message_size(each.message) for each in self._released)
        others = waiting - bool(older)
        if (others and size > MAX_QUEUE_BYTES) or (
            leaving and size_with_leaving > 2 * MAX_QUEUE_BYTES
        ):
            return f"the queue is full ({MAX_QUEUE_BYTES // 10**6} MB)"
        return ""

    def _next_ready(self) -> HeldMessage | None:
        held = self._held.first()
        return held if held and not self._lease.wait_reason(held.flow, None) else None

    def _release_next(self, held: HeldMessage, now: int) -> None:
        self._machine.step(QueueInput.TURN)
        self._lease.grant(held.flow, now)
        self._held.remove(held)
        reason = f"its turn came after {format_seconds(now - held.arrived_at)}"
        self._add_release(held, self._pass.create(held.flow.name, reason))

    def _drop_held(self, held: HeldMessage, reason: str) -> None:
        self._held.remove(held)
        self._add_release(held, self._drop.get(held.flow.name, reason))

    def _superseded_verdict(self, flow: Flow) -> Verdict:
        return self._drop.get(flow.name, f"a newer message of {flow.name} took its place")

    def _add_release(self, held: HeldMessage, verdict: Verdict) -> None:
        self._released.append(Release(held.message, verdict))

    def _take_released(self) -> Sequence[Release]:
        released, self._released = self._released, []
        return released
