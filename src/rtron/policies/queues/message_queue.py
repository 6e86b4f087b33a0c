"""What FIFO_Queue and Priority_Queue have in common: messages that wait for their turn.

The rule: **a held message leaves only in `tick`**, and `verdict` passes a message at once only if
nothing stands before it. Each call first lets time pass up to `now`: what is too old is dropped,
a turn that is over ends. If a tick is late, the message that was due is still the next to go, and
a newer one waits behind it. Two exceptions serve the freshest command: a newer message of
the same flow takes an older one's place, and under Priority_Queue a higher flow's command never
waits for a lower one.
"""

from collections.abc import Callable, Sequence
from dataclasses import replace

from rtron.policies.policy import Release
from rtron.policies.queues.held_messages import Held, Waiting
from rtron.policies.queues.output_lease import Turn
from rtron.policies.state_machine import Effect, Machine, Named, Table
from rtron.policies.state_transfer import Carried, InTurn
from rtron.policies.verdicts import Answers, Gate, has_output, seconds
from rtron.vocabulary import Decision, Flow, PolicySettings, StreamKind, Verdict


class State(Named):
    """The states of a queue."""

    FREE = "nobody has the turn"
    TAKEN = "a flow has the turn"


class Input(Named):
    """What happens to a queue."""

    FIRST = "a message that nothing stands before"
    BEHIND = "a message that must wait"
    FULL = "a message that must wait, and the queue is full"
    REFUSED = "a message of a blocked or unknown flow"
    OVER = "the turn is over: done, overdue or silent"
    TURN = "a tick, and a waiting message may go"
    OCCUPIED = "an action is in progress that did not go through here"


TABLE: Table[State, Input] = {
    (State.FREE, Input.FIRST): (State.TAKEN, Effect.PASS),
    (State.FREE, Input.BEHIND): (State.FREE, Effect.HOLD),
    (State.FREE, Input.FULL): (State.FREE, Effect.DROP),
    (State.FREE, Input.REFUSED): (State.FREE, Effect.DROP),
    (State.FREE, Input.OVER): (State.FREE, Effect.NEVER),
    (State.FREE, Input.TURN): (State.TAKEN, Effect.LET_GO),
    (State.FREE, Input.OCCUPIED): (State.TAKEN, Effect.NOTHING),
    (State.TAKEN, Input.FIRST): (State.TAKEN, Effect.PASS),
    (State.TAKEN, Input.BEHIND): (State.TAKEN, Effect.HOLD),
    (State.TAKEN, Input.FULL): (State.TAKEN, Effect.DROP),
    (State.TAKEN, Input.REFUSED): (State.TAKEN, Effect.DROP),
    (State.TAKEN, Input.OVER): (State.FREE, Effect.NOTHING),
    (State.TAKEN, Input.TURN): (State.TAKEN, Effect.NEVER),
    (State.TAKEN, Input.OCCUPIED): (State.TAKEN, Effect.NOTHING),
}


class Queue:
    """A policy that holds messages until `turn` lets them go, in the order of `rank`.

    Of commands, each flow keeps only its freshest. At most `queue_size` messages wait, and as
    many more may be on their way out to the next tick.
    """

    def __init__(self, settings: PolicySettings, turn: Turn, rank: Callable[[Flow], int]) -> None:
        self._gate = Gate(settings)
        self._pass = Answers(settings, Decision.PASS)
        self._hold = Answers(settings, Decision.HOLD)
        self._drop = Answers(settings, Decision.DROP)
        self._commands = settings.kind is StreamKind.COMMAND
        self._max_age = settings.max_age
        self._too_old = f"too old: it waited {seconds(settings.max_age)}"
        self._queue_size = settings.queue_size
        self._machine = Machine(TABLE, State.FREE)
        self._turn = turn
        self._waiting = Waiting(rank)
        self._leaving: list[Release] = []
        self._now = 0

    def verdict(self, flow: str, message: object, now: int) -> Verdict:
        """Pass the message if nothing stands before it, otherwise hold it if there is room."""
        known = self._gate.flows.get(flow)
        if known is None:
            self._machine.step(Input.REFUSED)
            return self._gate.refusal(flow)
        self._let_time_pass(now)
        self._turn.hear(known, now)
        first = self._waiting.first()
        reason = self._turn.why_wait(known, first.flow if first else None)
        effect = self._machine.step(self._room(known) if reason else Input.FIRST)
        if effect is Effect.PASS:
            return self._go(known, now)
        if effect is Effect.HOLD:
            self._keep(known, message, now)
            return self._hold.give(flow, reason)
        return self._drop.give(flow, f"the queue is full ({self._queue_size})")

    def refusal(self, flow: str, now: int, message: object = None) -> Verdict | None:  # noqa: ARG002
        """Return the refusal of a flow that is blocked or unknown."""
        return None if flow in self._gate.flows else self._gate.refusal(flow)

    def observe_done(self, now: int) -> None:
        """End the turn: what the output was taken for is done."""
        self._turn.end(now)
        self._let_time_pass(now)

    def occupy(self, flow: str, now: int) -> None:
        """Give the turn to `flow`, whoever it is: nothing goes while its action is in progress."""
        self._let_time_pass(now)
        self._machine.step(Input.OCCUPIED)
        self._turn.take(self._gate.flows.get(flow) or Flow(name=flow, publisher=flow), now)

    def withdraw(self, message: object, why: str) -> None:
        """Give up a message that waits."""
        held = self._waiting.find(message)
        if held:
            self._give_up(held, why)

    def tick(self, now: int) -> Sequence[Release]:
        """Let time pass, then let go whose turn it is; return everything that leaves."""
        self._let_time_pass(now)
        while held := self._due():
            self._let_go(held, now)
            self._let_time_pass(now)
        return self._take_leaving()

    def close(self) -> Sequence[Release]:
        """Drop every message that still waits."""
        while held := self._waiting.oldest():
            self._give_up(held, "the queue was closed")
        return self._take_leaving()

    def carry(self, now: int) -> Carried:
        """Return who waits, whose turn it is, and who is fresh; `close` has what does not wait."""
        self._let_time_pass(now)
        held = self._waiting.all()
        for each in held:
            self._waiting.remove(each)
        spoke = dict(self._turn.spoke(now))
        for each in held if self._commands else ():
            spoke[each.flow.name] = max(each.arrived, spoke.get(each.flow.name, each.arrived))
        return Carried(spoke=spoke, turns=True, turn=self._turn.in_turn(), held=held)

    def resume(self, carried: Carried, now: int) -> Sequence[Release]:
        """Hold what waited, in its order, and go on with the turn; refuse what is blocked here."""
        flows = self._gate.flows
        held = [each for each in carried.held if each.flow.name in flows]
        refused = [each for each in carried.held if each.flow.name not in flows]
        self._waiting.take_over(replace(each, flow=flows[each.flow.name]) for each in held)
        spoke = {name: at for name, at in carried.spoke.items() if name in flows}
        self._turn.resume(self._going_on(carried.turn), replace(carried, spoke=spoke))
        if self._turn.owner:
            self._machine.step(Input.OCCUPIED)
        self._let_time_pass(now)
        return self._gate.give_up(refused)

    def revise(self, revision: int) -> None:
        """Say from now on that verdicts are by settings of `revision`."""
        for each in (self._gate, self._pass, self._hold, self._drop):
            each.revise(revision)

    def deadline(self) -> int | None:
        """Return when a turn ends or a message grows too old; the present if something is due."""
        if self._leaving or self._due():
            return self._now
        oldest = self._waiting.oldest()
        expires = oldest.arrived + self._max_age if oldest else None
        times = (self._turn.ends(), expires)
        return min((time for time in times if time is not None), default=None)

    @property
    def owner(self) -> str | None:
        """The flow whose turn it is, as of the last call."""
        owner = self._turn.owner
        return owner.name if owner else None

    def _going_on(self, turn: InTurn | None) -> Flow | None:
        """Return whose turn goes on: an action is in progress, even if its flow is blocked now."""
        if turn is None:
            return None
        flow = self._gate.flows.get(turn.flow)
        return flow if flow or self._commands else Flow(name=turn.flow, publisher=turn.flow)

    def _let_time_pass(self, now: int) -> None:
        self._now = now
        while (held := self._waiting.oldest()) and now - held.arrived >= self._max_age:
            self._give_up(held, self._too_old)
        self._turn.lapse(now)
        if self._turn.owner is None:
            self._note_end()

    def _note_end(self) -> None:
        if self._machine.state is State.TAKEN:
            self._machine.step(Input.OVER)
        if not self._commands:
            self._waiting.choose()

    def _go(self, flow: Flow, now: int) -> Verdict:
        self._turn.take(flow, now)
        if older := self._replaced(flow):
            self._waiting.remove(older)
            self._leave(older, self._newer(flow))
        return self._pass.give(flow.name, has_output(flow))

    def _keep(self, flow: Flow, message: object, now: int) -> None:
        if older := self._replaced(flow):
            self._leave(older, self._newer(flow))
            self._waiting.refresh(older, message, now)
        else:
            self._waiting.add(flow, message, now)

    def _replaced(self, flow: Flow) -> Held | None:
        return self._waiting.latest(flow.name) if self._commands else None

    def _room(self, flow: Flow) -> Input:
        waiting = len(self._waiting)
        if waiting + len(self._leaving) >= 2 * self._queue_size:
            return Input.FULL
        room = waiting < self._queue_size or self._replaced(flow)
        return Input.BEHIND if room else Input.FULL

    def _due(self) -> Held | None:
        held = self._waiting.first()
        return held if held and not self._turn.why_wait(held.flow, None) else None

    def _let_go(self, held: Held, now: int) -> None:
        self._machine.step(Input.TURN)
        self._turn.take(held.flow, now)
        self._waiting.remove(held)
        reason = f"its turn came after {seconds(now - held.arrived)}"
        self._leave(held, self._pass.once(held.flow.name, reason))

    def _give_up(self, held: Held, reason: str) -> None:
        self._waiting.remove(held)
        self._leave(held, self._drop.give(held.flow.name, reason))

    def _newer(self, flow: Flow) -> Verdict:
        return self._drop.give(flow.name, f"a newer message of {flow.name} took its place")

    def _leave(self, held: Held, verdict: Verdict) -> None:
        self._leaving.append(Release(held.message, verdict))

    def _take_leaving(self) -> Sequence[Release]:
        leaving, self._leaving = self._leaving, []
        return leaving
