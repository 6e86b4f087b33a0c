"""One stream of the plan on a transport: its inputs, its pipeline and its outputs."""

import logging
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import TYPE_CHECKING

from rtron.errors import PlanError
from rtron.guard.ends import Ends
from rtron.guard.latched import Latched
from rtron.guard.override import Overridable
from rtron.guard.pipeline import Pipeline
from rtron.guard.senses import Senses
from rtron.guard.stages import changed_policies, policies_of
from rtron.guard.starvation import end_starved
from rtron.guard.stopper import Stopper
from rtron.guard.transport.transport import Peer, Receive, Transport, TypeInfo
from rtron.guard.types import codec_of, standard_info
from rtron.guard.will import Will
from rtron.policies import Policy, Release
from rtron.policies.mission import Standing
from rtron.vocabulary import (
    PRIVATE_ROOT,
    UNAPPROVED,
    CoordinationKind,
    Decision,
    Flow,
    Mode,
    Stream,
    StreamKind,
    Verdict,
    flow_topic,
    names_node,
)

if TYPE_CHECKING:
    from rtron.guard.delays import Delays
    from rtron.guard.measuring.stream import MeasuredStream
    from rtron.messages.velocity import VelocityCodec

log = logging.getLogger(__name__)

_LONGEST_NAME = 128
_MOST_STRANGERS = 32


@dataclass(frozen=True, slots=True)
class Adaptation:
    """Other settings of a stream, ready to be put in force.

    `policies` are those that change, by the coordination node; `md5sum` is that of the messages
    which rules look into, "" where any will do.
    """

    stream: Stream
    policies: Mapping[str, Policy]
    md5sum: str


class GuardedStream:
    """Takes what the flows say, asks the pipeline, and gives the successors what it lets go.

    Closed at both ends: an approved publisher speaks on its flow's private topic, a successor
    listens on the private output, and what arrives under the public name is `unapproved`.
    """

    def __init__(
        self,
        stream: Stream,
        transport: Transport,
        senses: Senses,
        will: Will,
        *,
        dry_run: bool = False,
    ) -> None:
        self.stream = self._complete(stream)
        self.nodes = tuple(f"{PRIVATE_ROOT}/{stage.id}" for stage in stream.stages)
        names = [*(flow.name for flow in stream.flows), UNAPPROVED]
        policies = policies_of(self.stream, senses)
        self.overridable = {k: v for k, v in policies.items() if isinstance(v, Overridable)}
        self.pipeline = Pipeline(tuple(policies.values()), names, self._passed)
        self.pipeline.revise(_revision(stream))
        self.stopper = Stopper(stream, self._say)
        self.told: Callable[[], None] = lambda: None
        self.strangers: dict[str, int] = {}
        self.dry_run = dry_run
        self._latched = Latched(stream.topic, will)
        self.measured: MeasuredStream | None = None
        self.delays: Delays | None = None
        self._transport = transport
        self._mission = senses.mission
        self._meets = _meets(stream)
        self._md5sum = _written_for(stream, senses)
        self._info: TypeInfo | None = None
        self._codec: VelocityCodec | None = None
        self._is_open = False
        self._armed_for: int | None = None
        self._braked_by: dict[str, str] = {}
        self._state: tuple[str | None, str] = (None, "")
        self._ends = Ends(self.stream, self.nodes, transport)

    def open(self) -> None:
        """Join the graph."""
        if self.stream.mode is Mode.ENFORCE:
            self._ends.open()
            for flow in self.stream.flows:
                topic = flow_topic(self.stream.topic, flow.name)
                self._subscribe(topic, partial(self._connect_flow, flow), self.stream.type)
        self._subscribe(self.stream.topic, self._connect_public, self.stream.type)
        self._open_done()
        self._is_open = True
        for why in self._braked_by.values():
            self._hold(why)

    def report(
        self, learned: Callable[[TypeInfo], None], sent: Callable[[str, bytes], None]
    ) -> None:
        """Tell from now on which type was learned, and each message that goes out."""
        self._ends.report(learned, sent)

    def _open_done(self) -> None:
        if self.stream.done:
            self._subscribe(self.stream.done, self._connect_done, "")

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
        stream = self._complete(stream)
        md5sum = _written_for(stream, senses)
        if self._info and md5sum not in ("", self._info.md5sum):
            told = f"{stream.topic}: its messages are of another version than the rules look into"
            raise PlanError(told)
        policies = changed_policies(self.stream, stream, senses, standings)
        for policy in policies.values():
            if self._codec and isinstance(policy, Overridable):
                policy.learn(self._codec)
        return Adaptation(stream, policies, md5sum)

    def adapt(self, adaptation: Adaptation, now: int) -> Sequence[Release]:
        """Put other settings of the stream in force; return what was held and can be no more.

        It is for `pipeline.give_up`, once all streams have adapted.
        """
        self.stream, self._md5sum = adaptation.stream, adaptation.md5sum
        self._meets = _meets(self.stream)
        given_up: list[Release] = []
        for at, stage in enumerate(self.stream.stages):
            if policy := adaptation.policies.get(stage.id):
                self._keep_overrides(stage.id, policy)
                given_up += self.pipeline.replace(at, policy, now)
        self.pipeline.revise(_revision(self.stream))
        return given_up

    def _keep_overrides(self, id: str, policy: Policy) -> None:
        if isinstance(policy, Overridable):
            policy.take_over(self.overridable[id])
            self.overridable[id] = policy

    def _complete(self, stream: Stream) -> Stream:
        """Return a stream as it is guarded."""
        return _with_unapproved(stream)

    def attend(self, now: int) -> None:
        """Stop the robot if what moves it may not go on: a rule, a limit or a stage has changed."""
        flow = self.stopper.moving
        if flow and (why := self.pipeline.refusal(flow.name, now)):
            self.stopper.refuse(why, now)
        self._slow_down(now)
        self._settle(now)
        self._tell()

    def _slow_down(self, now: int) -> None:
        """Say again, more slowly, what moves the robot, if it is now above a limit."""
        limits = (policy.limit(now) for policy in self.overridable.values())
        limit = min((limit for limit in limits if limit is not None), default=None)
        if limit is not None and self.stopper.moving:
            self.stopper.slow_down(limit, now)

    def _subscribe(self, topic: str, connect: Callable[[Peer], Receive | None], type: str) -> None:
        self._transport.subscribe(self.nodes[0], topic, type, connect)

    def _connect_flow(self, flow: Flow, peer: Peer) -> Receive | None:
        if not (peer.verified and names_node(flow.publisher, peer.node)):
            return self._stranger(peer, f"on the private topic of {flow.name}")
        if not self._learn(peer):
            return None
        self._ends.latch(flow.name, latching=peer.latching and self._keeps(peer))
        if peer.qos:
            self._ends.offer(flow.name, peer.qos)
        return self._taking(flow.name, peer)

    def _connect_public(self, peer: Peer) -> Receive | None:
        if self.stream.mode is Mode.OBSERVE:
            known = (f for f in self.stream.flows if names_node(f.publisher, peer.node))
            flow = next(known, None)
            if flow is not None:
                return self._taking(flow.name, peer) if self._learn(peer) else None
        return self._stranger(peer, "under the public name")

    def _stranger(self, peer: Peer, where: str) -> Receive | None:
        if not self.stream.block_unapproved and not self._learn(peer):
            return None
        name = peer.node[:_LONGEST_NAME]
        if name in self.strangers or len(self.strangers) < _MOST_STRANGERS:
            self.strangers[name] = self.strangers.get(name, 0) + 1
        log.warning("%s: unapproved publisher %s %s", self.stream.topic, name, where)
        if self.dry_run and not self._ends.knows(peer.info):
            return None
        return self._taking(UNAPPROVED, peer)

    def _taking(self, flow: str, peer: Peer) -> Receive:
        """Return what takes the messages of a publisher; a latched goal is taken once."""
        take = partial(self._receive, flow)
        return self._latched.once(peer.node, take) if self._goes_once(peer) else take

    def _goes_once(self, peer: Peer) -> bool:
        goals = self.stream.stages[0].settings.kind is StreamKind.ACTION or self.stream.action
        return bool(goals) and peer.latching and not self.dry_run

    def _connect_done(self, peer: Peer) -> Receive | None:
        said_by_successor = any(names_node(each, peer.node) for each in self.stream.successors)
        return self._done if peer.verified and said_by_successor else None

    def _done(self, _message: bytes) -> None:
        now = self._transport.now()
        if self.measured:
            self.measured.done(now)
        self.pipeline.done(now)
        self._settle(now)

    def _keeps(self, peer: Peer) -> bool:
        """Tell whether a late subscriber is told the last message: only of what is a state."""
        first = self.stream.stages[0]
        if first.coordination is CoordinationKind.GRCN:
            return first.settings.kind is StreamKind.STATE
        codec = codec_of(peer.info, self._transport.encoding)
        return codec is None or codec.is_limit

    def _learn(self, peer: Peer) -> bool:
        written_for = self.dry_run or self._md5sum in ("", peer.info.md5sum)
        if not (written_for and self._ends.learn(peer.info)):
            told = "%s: %s has another type, %s"
            log.error(told, self.stream.topic, peer.node, peer.info.type)
            return False
        self._info = peer.info
        codec = codec_of(peer.info, self._transport.encoding)
        if codec:
            self._codec = codec
            self.stopper.learn(codec)
            if self.measured:
                self.measured.learn(codec)
            for policy in self.overridable.values():
                policy.learn(codec)
        return True

    def _hold(self, why: str) -> None:
        """Stop the robot; nothing passes that would move it again."""
        self._learn_standard()
        self.stopper.brake(why, self._transport.now())
        self.attend(self._transport.now())

    def _learn_standard(self) -> None:
        """Know how to say stop although no publisher has told what its messages are."""
        info = standard_info(self.stream.type, self._transport.encoding)
        if info and not self.stopper.knows:
            self._learn(Peer("", info))

    def _receive(self, flow: str, message: bytes) -> Verdict | None:
        now = self._transport.now()
        if self.dry_run:
            self._ends.send(flow, message)
        verdict = self._judged(flow, message, now)
        if self.measured:
            self.measured.heard(flow, message, now, verdict)
        decision = verdict.decision if verdict else Decision.DROP
        if decision is Decision.HOLD:
            self._settle(now)
        elif decision is Decision.DROP and verdict and self.stopper.moving:
            self._dropped(verdict, now)
        elif self._armed_for is None:
            self._arm()
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
            self._settle(now)
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
        silent_at = self.stopper.deadline()
        if silent_at is not None and (self._armed_for is None or silent_at < self._armed_for):
            self._arm()

    def _say(self, flow: str, message: bytes) -> None:
        if not self.dry_run:
            self._ends.send(flow, message)

    def _settle(self, now: int) -> None:
        """Let out what is due, and be called when the next is."""
        due = self._deadline()
        if due is not None and due <= now:
            self._tick(now)
        self._arm()

    def _deadline(self) -> int | None:
        one, other = self.pipeline.deadline(), self.stopper.deadline()
        return one if other is None else other if one is None else min(one, other)

    def _arm(self) -> None:
        """Ask to be woken for the next deadline, unless an earlier call is already due."""
        due = self._deadline()
        if due is not None and (self._armed_for is None or due < self._armed_for):
            self._armed_for = due
            self._transport.call_at(due, partial(self._wake, due))

    def _wake(self, due: int) -> None:
        """Let out what is due, unless an earlier call has taken the place of this one."""
        if due != self._armed_for:
            return
        self._armed_for = None
        self._tick(self._transport.now())
        self._tell()
        self._arm()

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


def _with_unapproved(stream: Stream) -> Stream:
    """Give the unapproved flow a place behind all others where the plan lets it through."""
    if stream.block_unapproved:
        return stream
    stages = []
    for stage in stream.stages:
        least = min((flow.priority for flow in stage.settings.flows), default=0) - 1
        flow = Flow(name=UNAPPROVED, publisher="*", priority=least)
        settings = replace(stage.settings, flows=(*stage.settings.flows, flow))
        stages.append(replace(stage, settings=settings))
    return replace(stream, stages=tuple(stages))


def _revision(stream: Stream) -> int:
    return max((stage.settings.revision for stage in stream.stages), default=0)


def _written_for(stream: Stream, senses: Senses) -> str:
    """Return the MD5 sum of the messages that the mission's rules look into, or nothing."""
    action = senses.actions.get(stream.topic)
    return action.md5sum if action else ""


def _meets(stream: Stream) -> dict[str, list[str]]:
    """Return the rules whose obligation a message that goes out meets, by its flow."""
    rules = [rule for stage in stream.stages for rule in stage.settings.rules]
    flows = {flow for rule in rules for flow in rule.meets}
    return {flow: [rule.name for rule in rules if flow in rule.meets] for flow in flows}
