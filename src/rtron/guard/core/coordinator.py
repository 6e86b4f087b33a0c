"""The host: every coordination node of a plan in one process, and what they tell the world."""

import logging
import time
from collections.abc import Sequence
from functools import partial

from rtron.guard.action.common.turns import SharingAction
from rtron.guard.action.ros1.simple_goals import FollowedStream, followed_action
from rtron.guard.action.ros1.stream import GuardedAction
from rtron.guard.action.ros2.endpoints import CarriesRequests
from rtron.guard.action.ros2.observed import ObservedAction
from rtron.guard.action.ros2.simple_goals import FollowedRequests
from rtron.guard.action.ros2.stream import RequestedAction
from rtron.guard.core.alarms import Alarms
from rtron.guard.core.diagnostics import active_text, alarm_statuses, emergency_statuses, statuses
from rtron.guard.core.handover_state import Will
from rtron.guard.core.log_throttle import PERIOD, Seldom
from rtron.guard.core.observation_inputs import Watching, Ways
from rtron.guard.core.observations import Senses
from rtron.guard.core.report_messages import (
    DIAGNOSTICS,
    FLOAT64,
    STRING,
    Status,
    diagnostics_message,
    float64_message,
    string_message,
)
from rtron.guard.core.stream import GuardedStream
from rtron.guard.core.stream_settings import Adaptation
from rtron.guard.transport.common.protocol import Output, Transport
from rtron.messages.common.encoding import Encoding
from rtron.policies.mission.rule_status import Standing
from rtron.vocabulary import GUARD_NODE, PRIVATE_ROOT, SECOND, Mode, Stream, flow_topic

log = logging.getLogger(__name__)

_FPS_PERIOD = SECOND // 10


class Host:
    """Opens the streams on a transport and reports: `~active` on change, `/diagnostics` at 1 Hz.

    A dry run lets everything pass and reports what would have become of it.
    """

    def __init__(
        self,
        transport: Transport,
        streams: Sequence[Stream],
        senses: Senses | None = None,
        *,
        dry_run: bool = False,
        will: Will | None = None,
    ) -> None:
        """`will` is what a guard that ended has left to this one."""
        self.senses = senses or Senses()
        self.alarms = Alarms()
        self.emergency = ""
        """Why everything that moves the robot is stopped, or nothing."""
        self._transport = transport
        self._dry_run = dry_run
        self._will = will or Will()
        self.guarded = [self._guarded(stream) for stream in streams]
        self._follow()
        self._watching = Watching(transport, self.senses, _ways(streams), self._heard)
        self._attending = False
        self._seldom = Seldom()
        self._settling: set[str] = set()
        self._armed_for: int | None = None
        self._diagnostics: Output | None = None
        self._reports = 0
        self.senses.mission.changed = self._rule_changed

    def open(self) -> None:
        """Join the graph with every coordination node, and report from now on."""
        self.guard()
        for guarded in self.guarded:
            self._show_owner(guarded)
        for monitor in self.senses.monitors:
            self._show_rate(monitor.id)
        diagnostics = DIAGNOSTICS[self._transport.encoding]
        self._diagnostics = self._announce(GUARD_NODE, "/diagnostics", diagnostics.type)
        self._diagnostics.learn(diagnostics)
        self._report()

    def guard(self) -> None:
        """Join the graph without a report: a recording has nobody who reads it."""
        for guarded in self.guarded:
            guarded.open()
        self._watching.open()

    def killed(self, node: str, reason: str) -> bool:
        """Shut what a killed node took part in; tell whether it was the guard's own node."""
        for guarded in self.guarded:
            if node in guarded.nodes:
                guarded.shut(f"{node} was shut down, {reason}")
        return node == GUARD_NODE

    def statuses(self) -> list[Status]:
        """Return the state of every stream, image node and rule."""
        now = self._transport.now()
        return [
            *statuses(self.guarded, self.senses, now),
            *emergency_statuses(self.emergency, dry_run=self._dry_run),
            *alarm_statuses(self.alarms, now),
        ]

    def adapt(self, senses: Senses, adaptations: Sequence[Adaptation]) -> None:
        """Put other settings of the streams in force, in their order; `attend` after it.

        First all of them change; only then is anybody told what cannot be held any more.
        """
        self.senses = senses
        now = self._transport.now()
        pairs = zip(self.guarded, adaptations, strict=True)
        given_up = [(guarded, guarded.adapt(each, now)) for guarded, each in pairs]
        for guarded, releases in given_up:
            guarded.pipeline.give_up(releases)
        self._heard()

    def _guarded(self, stream: Stream) -> GuardedStream:
        common = (stream, self._transport, self.senses, self._will)
        if stream.by_request:
            return self._requested(stream)
        if stream.mode is Mode.ENFORCE and stream.action:
            action = GuardedAction(*common, dry_run=self._dry_run)
            action.halted = partial(self._halted, action)
            return action
        if stream.done and self._transport.encoding is Encoding.CDR:
            return FollowedRequests(*common, dry_run=self._dry_run)
        if stream.mode is Mode.ENFORCE and followed_action(stream):
            return FollowedStream(*common, dry_run=self._dry_run)
        return GuardedStream(*common, dry_run=self._dry_run)

    def _requested(self, stream: Stream) -> GuardedStream:
        """Return an action of ROS 2; requests need a transport for them, and cannot be observed."""
        common = (stream, self._transport, self.senses, self._will)
        carries = self._transport
        if stream.mode is not Mode.ENFORCE or not isinstance(carries, CarriesRequests):
            return ObservedAction(*common, dry_run=self._dry_run)
        action = RequestedAction(*common, carries, dry_run=self._dry_run)
        action.halted = partial(self._halted, action)
        return action

    def _follow(self) -> None:
        """Let goals without an id be followed where their action is guarded too."""
        actions = {each.name: each for each in self.guarded if isinstance(each, SharingAction)}
        for each in self.guarded:
            if isinstance(each, FollowedStream) and each.stream.mode is Mode.ENFORCE:
                action = actions.get(each.action)
                if action:
                    each.follow(action)

    def _halted(self, action: SharingAction, node: str, why: str) -> None:
        """Keep the server of a goal that was stopped from moving the robot, until it is over."""
        for guarded in self.guarded:
            if guarded is action:
                continue
            if why:
                guarded.bar(action.name, node, why)
            else:
                guarded.release(action.name)

    def _heard(self) -> None:
        """Be called when something changes by time alone, if not before."""
        due = self.senses.deadline(self._transport.now())
        if due is not None and (self._armed_for is None or due < self._armed_for):
            self._armed_for = due
            self._transport.call_at(due, partial(self._look_again, due))

    def _look_again(self, due: int) -> None:
        """Look at the senses again, unless an earlier call has taken the place of this one."""
        if due != self._armed_for:
            return
        self._armed_for = None
        self.senses.catch_up(self._transport.now())
        self.attend()
        self._heard()

    def _rule_changed(self, standing: Standing) -> None:
        self._log_change(standing)
        if not self._attending:
            self._attending = True
            self._transport.call_at(self._transport.now(), self.attend)

    def _log_change(self, standing: Standing) -> None:
        """Log that a rule began or ceased to block; of a flickering one, what it is in the end."""
        now, rule = self._transport.now(), standing.rule.name
        if self._seldom.may_say(rule, now):
            _log_standing(standing)
        elif rule not in self._settling:
            self._settling.add(rule)
            self._transport.call_at(now + PERIOD, partial(self._settled, standing))

    def _settled(self, standing: Standing) -> None:
        self._settling.discard(standing.rule.name)
        _log_standing(standing)

    def attend(self) -> None:
        """Let every stream look whether what moves the robot may go on."""
        self._attending = False
        now = self._transport.now()
        for guarded in self.guarded:
            guarded.attend(now)

    def _announce(self, node: str, topic: str, type: str) -> Output:
        return self._transport.advertise(node, topic, type)

    def _show_owner(self, guarded: GuardedStream) -> None:
        name = guarded.stream.topic.strip("/").replace("/", "_")
        topic = f"{guarded.nodes[0]}/{name}/active"
        active = self._announce(guarded.nodes[0], topic, STRING.type)
        active.learn(STRING)
        guarded.told = partial(_tell, guarded, active, self._transport.encoding)
        guarded.told()

    def _show_rate(self, monitor: str) -> None:
        node = f"{PRIVATE_ROOT}/{monitor}"
        output = self._announce(node, f"{node}/fps", FLOAT64.type)
        output.learn(FLOAT64)
        self._tell_rate(monitor, output)

    def _tell_rate(self, monitor: str, output: Output) -> None:
        now = self._transport.now()
        fps = self.senses.rates.monitors[monitor].rate(now).fps
        output.publish(float64_message(self._transport.encoding, fps))
        self._transport.call_at(now + _FPS_PERIOD, partial(self._tell_rate, monitor, output))

    def _report(self) -> None:
        self._transport.call_at(self._transport.now() + SECOND, self._report)
        if self._diagnostics is not None:
            self._reports += 1
            told = (self._reports, time.time_ns(), self.statuses())
            self._diagnostics.publish(diagnostics_message(self._transport.encoding, *told))


def _log_standing(standing: Standing) -> None:
    log.warning("blocked: %s" if standing.blocks else "free: %s", standing.reason)


def _ways(streams: Sequence[Stream]) -> Ways:
    """Return where the publishers that an enforced stream has remapped speak."""
    return Ways(
        {
            (stream.topic, flow.publisher): flow_topic(stream.topic, flow.name)
            for stream in streams
            if stream.mode is Mode.ENFORCE
            for flow in stream.flows
        }
    )


def _tell(guarded: GuardedStream, active: Output, encoding: Encoding) -> None:
    text = active_text(guarded)
    log.info("%s: %s", guarded.stream.topic, text)
    active.publish(string_message(encoding, text), latched_by=GUARD_NODE)
