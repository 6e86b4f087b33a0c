"""One stream of the plan on a transport: its inputs, its pipeline and its outputs."""

import logging
from collections.abc import Callable, Mapping, Sequence
from typing import TYPE_CHECKING

from rtron.guard.core.deadline_timer import Waking
from rtron.guard.core.handover_state import Will
from rtron.guard.core.observations import Senses
from rtron.guard.core.out_of_memory import end_starved
from rtron.guard.core.override_policy import Overridable
from rtron.guard.core.pipeline import Pipeline
from rtron.guard.core.stop_controller import Stopper
from rtron.guard.core.stream_endpoints import Connected
from rtron.guard.core.stream_settings import Adaptation, Learned, adaptation
from rtron.guard.derived import met_by, revision_of
from rtron.guard.stages import policies_of
from rtron.guard.transport.common.protocol import Transport
from rtron.policies import Policy, Release
from rtron.policies.mission.rule_status import Standing
from rtron.vocabulary import UNAPPROVED, Decision, Stream, Verdict, names_node

if TYPE_CHECKING:
    from rtron.guard.delays import Delays
    from rtron.guard.measurement.stream import MeasuredStream
    from rtron.messages.common.velocity import VelocityCodec

log = logging.getLogger(__name__)


class GuardedStream(Connected):
    """Takes what the flows say, asks the pipeline, and gives the successors what it lets go."""

    def __init__(
        self,
        stream: Stream,
        transport: Transport,
        senses: Senses,
        will: Will,
        *,
        dry_run: bool = False,
    ) -> None:
        super().__init__(stream, transport, senses, will, dry_run=dry_run)
        names = [*(flow.name for flow in stream.flows), UNAPPROVED]
        policies = policies_of(self.stream, senses)
        self.overridable = {k: v for k, v in policies.items() if isinstance(v, Overridable)}
        self.pipeline = Pipeline(tuple(policies.values()), names, self._passed)
        self.pipeline.revise(revision_of(stream))
        self.stopper = Stopper(stream, self._say)
        self.told: Callable[[], None] = lambda: None
        self.measured: MeasuredStream | None = None
        self.delays: Delays | None = None
        self._mission = senses.mission
        self._meets = met_by(stream)
        self._codec: VelocityCodec | None = None
        self._is_open = False
        self._braked_by: dict[str, str] = {}
        self._state: tuple[str | None, str] = (None, "")
        self._waking = Waking(transport, self._deadline, self._tick, self._tell)

    def open(self) -> None:
        """Join the graph."""
        self._open_ends()
        self._is_open = True
        for why in self._braked_by.values():
            self._hold(why)

    def shut(self, why: str) -> None:
        """Let nothing through any more: a coordination node of the pipeline is gone."""
        log.error("%s: nothing passes any more: %s", self.stream.topic, why)
        self.pipeline.shut(why)
        self._ends.forget()
        self.attend(self._transport.now())

    @property
    def details(self) -> Mapping[str, str]:
        """What there is to tell beside the flows."""
        return {}

    def brake(self, by: str, why: str) -> None:
        """Let nothing pass and keep the robot stopped, until `by` releases it.

        What is not open yet stops the robot when it is.
        """
        self.pipeline.bar(by, self.pipeline.tallies, why)
        self._braked_by[by] = why
        if self._is_open:
            self._hold(why)

    @property
    def braked(self) -> str:
        """Why the robot is kept stopped, or nothing."""
        return next(iter(self._braked_by.values()), "")

    def bar(self, by: str, publisher: str, why: str) -> None:
        """Let nothing of a publisher pass until `by` releases it; stop the robot if it moves it."""
        flows = [f.name for f in self.stream.flows if names_node(f.publisher, publisher)]
        self.pipeline.bar(by, flows, why)
        self.attend(self._transport.now())

    def release(self, by: str) -> None:
        """Let pass again what the policies let pass."""
        self.pipeline.free(by)
        self._braked_by.pop(by, None)
        if self._braked_by:
            self.stopper.explain(self.braked)
        else:
            self.stopper.loosen()
            for policy in self.overridable.values():
                policy.again(self._transport.now())
        self.attend(self._transport.now())

    def prepare(
        self, stream: Stream, senses: Senses, standings: Mapping[str, Standing]
    ) -> Adaptation:
        """Return what `adapt` puts in force; nothing changes yet. PlanError if it cannot be."""
        learned = Learned(self._info, self._codec)
        return adaptation(self.stream, self._complete(stream), senses, standings, learned)

    def adapt(self, adapted: Adaptation, now: int) -> Sequence[Release]:
        """Put other settings of the stream in force; return what was held and can be no more.

        It is for `pipeline.give_up`, once all streams have adapted.
        """
        self.stream, self._md5sum = adapted.stream, adapted.md5sum
        self._meets = met_by(self.stream)
        given_up: list[Release] = []
        for at, stage in enumerate(self.stream.stages):
            if policy := adapted.policies.get(stage.id):
                self._keep_overrides(stage.id, policy)
                given_up += self.pipeline.replace(at, policy, now)
        self.pipeline.revise(revision_of(self.stream))
        return given_up

    def _keep_overrides(self, id: str, policy: Policy) -> None:
        if isinstance(policy, Overridable):
            policy.take_over(self.overridable[id])
            self.overridable[id] = policy

    def attend(self, now: int) -> None:
        """Stop the robot if what moves it may not go on: a rule, a limit or a stage has changed."""
        flow = self.stopper.moving
        if flow and (why := self.pipeline.refusal(flow.name, now)):
            self.stopper.refuse(why, now)
        self._slow_down(now)
        self._waking.settle(now)
        self._tell()

    def _slow_down(self, now: int) -> None:
        """Say again, more slowly, what moves the robot, if it is now above a limit."""
        limits = (policy.limit(now) for policy in self.overridable.values())
        limit = min((limit for limit in limits if limit is not None), default=None)
        if limit is not None and self.stopper.moving:
            self.stopper.slow_down(limit, now)

    def _done(self, _message: bytes) -> None:
        now = self._transport.now()
        if self.measured:
            self.measured.done(now)
        self.pipeline.done(now)
        self._waking.settle(now)

    def _hold(self, why: str) -> None:
        """Stop the robot; nothing passes that would move it again."""
        if not self.stopper.knows:
            self._learn_standard()
        self.stopper.brake(why, self._transport.now())
        self.attend(self._transport.now())

    def _learned(self, codec: "VelocityCodec") -> None:
        self._codec = codec
        self.stopper.learn(codec)
        if self.measured:
            self.measured.learn(codec)
        for policy in self.overridable.values():
            policy.learn(codec)

    def _receive(self, flow: str, message: bytes) -> Verdict | None:
        now = self._transport.now()
        if self.dry_run:
            self._ends.send(flow, message)
        verdict = self._judged(flow, message, now)
        if self.measured:
            self.measured.heard(flow, message, now, verdict)
        decision = verdict.decision if verdict else Decision.DROP
        if decision is Decision.HOLD:
            self._waking.settle(now)
        elif decision is Decision.DROP and verdict and self.stopper.moving:
            self._dropped(verdict, now)
        else:
            self._waking.rely()
        if (self.pipeline.owner, self.stopper.why) != self._state:
            self._tell()
        if self.delays:
            self.delays.add(self._transport.now() - now)
        return verdict

    def _judged(self, flow: str, message: bytes, now: int) -> Verdict | None:
        try:
            return self.pipeline.receive(flow, message, now)
        except MemoryError:
            end_starved()
        except Exception:
            log.exception("%s: internal error, a message of %s is dropped", self.stream.topic, flow)
            self.stopper.refuse("internal error", now)
            self._waking.settle(now)
            return None

    def _dropped(self, verdict: Verdict, now: int) -> None:
        """Stop the robot if a message of the flow that moves it is refused."""
        flow = self.stopper.moving
        if flow and flow.name == verdict.flow:
            self.stopper.dropped(verdict, now)
            self.attend(now)

    def _passed(self, flow: str, message: bytes, now: int) -> None:
        self.stopper.said(flow, message, now)
        if self.measured:
            self.measured.passed(message, now)
        self._say(flow, message)
        if flow in self._meets:
            self._mission.meet(self._meets[flow])
        self._waking.hasten(self.stopper.deadline())

    def _say(self, flow: str, message: bytes) -> None:
        if not self.dry_run:
            self._ends.send(flow, message)

    def _deadline(self) -> int | None:
        one, other = self.pipeline.deadline(), self.stopper.deadline()
        return one if other is None else other if one is None else min(one, other)

    def _tick(self, now: int) -> None:
        self._slow_down(now)
        self.stopper.tick(now)
        try:
            self.pipeline.tick(now)
        except MemoryError:
            end_starved()
        except Exception:
            log.exception("%s: internal error, what was held is lost", self.stream.topic)

    def _tell(self) -> None:
        state = (self.pipeline.owner, self.stopper.why)
        if state != self._state:
            self._state = state
            self.told()
