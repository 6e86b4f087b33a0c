"""What ties a guard to its supervisor, seen from the guard: it ends with it."""

import json
import logging
import os
import signal
import socket
from contextlib import suppress
from functools import partial
from itertools import count
from typing import TYPE_CHECKING

from rtron.guard.coordinator import Coordinator
from rtron.guard.core.event_loop import EventLoop
from rtron.guard.core.handover_state import HandoverState
from rtron.guard.core.stream import GuardedStream
from rtron.guard.supervision.guard_config import GuardConfig, is_stoppable
from rtron.guard.supervision.guard_name import GUARD, answer_name, take_name
from rtron.guard.supervision.shared_memory import (
    DoubleBuffer,
    GuardMemory,
    StatusWord,
    decode_last_message,
    encode_last_message,
    encode_type_info,
)
from rtron.guard.supervision.watchdog import BEAT_PERIOD, Watchdog
from rtron.guard.system.process_attributes import exit_if_out_of_memory
from rtron.guard.system.unix_socket import peer_credentials
from rtron.guard.transport.common.protocol import TypeInfo
from rtron.vocabulary import (
    GUARD_NODE,
    SECOND,
    UNAPPROVED,
    Alarm,
    AlarmKind,
)

if TYPE_CHECKING:
    from rtron.wire.ros2.session import Ros2Session

log = logging.getLogger(__name__)

HANG_TIMEOUT = 2 * SECOND
"""Silence after which a supervisor is killed, ns: it stands still."""
_ALARM_DURATION = 30 * SECOND
_DELIVERY = "delivery"
_UNDELIVERED = "what goes into the guard does not come out in time: the robot is stopped"
_UNWATCHED = Alarm(
    kind=AlarmKind.GUARD,
    reason="nobody knows whether it delivers: no ping of its supervisor has come back for 30 s; "
    "see that both reach each other here (ROS 1: ROS_IP, ROS_HOSTNAME, a firewall; ROS 2: your "
    "profiles of Fast DDS), and start rtron guard again",
    node=GUARD_NODE,
)


class SupervisorClient:
    """Beats, keeps what the supervisor has to know, and ends the guard when the supervisor has."""

    def __init__(
        self,
        config: GuardConfig,
        memory: GuardMemory,
        connection: socket.socket,
        bulk_port: socket.socket,
        session: "Ros2Session | None" = None,
    ) -> None:
        """Take the connection to the supervisor, and the connecting side to the bulk process.

        `session` was opened while the guard waited to begin.

        SourceError if there is another guard on the master.
        """
        self.handover_state = HandoverState(
            memory.handover_state.read()[1], memory.handover_state.write
        )
        self.session = session
        self.configuration, self.bulk_port = config.digest, bulk_port
        self._memory = memory
        self._connection = connection
        self._name = take_name(GUARD, config.master)
        self._last_stop = 0
        self._undelivered: Alarm | None = None
        self._is_ending = False
        self._turn = count()

    def attach(self, loop: EventLoop, host: Coordinator) -> None:
        """Keep what the streams of a host say."""
        self._loop = loop
        self._host = host
        self._watchdog = Watchdog(loop.now())
        self._stoppable = [each for each in host.streams if is_stoppable(each.spec)]
        buffers = zip(self._memory.type_infos, self._memory.last_messages, strict=True)
        for guarded, (info, last_message) in zip(self._stoppable, buffers, strict=True):
            _record_messages(guarded, info, last_message, loop)

    def open(self) -> None:
        """Beat as soon as the loop runs."""
        if self._name:
            answer_name(self._loop, self._name)
        else:
            log.warning("somebody else has the name of this guard: it cannot be found")
        self._connection.settimeout(0)
        self._loop.watch(self._connection, self._on_end, lambda error: self._on_end())
        self._report_failure()
        self._loop.call_at(self._loop.now(), self._beat)

    def close(self) -> None:
        """Let the supervisor know that the guard ends in order; its name goes with it."""
        self._memory[StatusWord.LEAVING] = 1

    def supervisor_participant(self) -> bytes:
        """Return the supervisor's participant in ROS 2."""
        return self._memory.supervisor_participant.read()[1]

    def _beat(self) -> None:
        now = self._loop.now()
        self._loop.call_at(now + BEAT_PERIOD, self._beat)
        exit_if_out_of_memory()
        self._memory[StatusWord.GUARD_BEAT] = now
        self._memory[StatusWord.SERVING] = self._memory[StatusWord.SERVING] or now
        if self._stoppable:
            self._stoppable[next(self._turn) % len(self._stoppable)].store_order()
        self._notice_stop()
        self._follow_delivery(now)
        self._follow_watch(now)
        self._check_supervisor(now)

    def _notice_stop(self) -> None:
        """See whether the supervisor has stopped the robot: a ramp would set it in motion again."""
        stopped_at = self._memory[StatusWord.STOPPED]
        if stopped_at == self._last_stop:
            return
        self._last_stop = stopped_at
        for guarded, last_message in zip(self._stoppable, self._memory.last_messages, strict=True):
            if decode_last_message(last_message.read()[1]).sent_at < stopped_at:
                guarded.stop_controller.mark_stopped_elsewhere()
        if not self._memory[StatusWord.UNDELIVERED]:
            self._raise_temporary_alarm("it stood still, and the supervisor stopped the robot")

    def _follow_delivery(self, now: int) -> None:
        """Keep the robot stopped while the supervisor sees that nothing comes out of the guard."""
        is_undelivered = bool(self._memory[StatusWord.UNDELIVERED])
        if is_undelivered and self._undelivered is None:
            self._undelivered = Alarm(kind=AlarmKind.GUARD, reason=_UNDELIVERED, node=GUARD_NODE)
            self._host.alarms.raise_(self._undelivered, now)
            for guarded in self._stoppable:
                guarded.brake(_DELIVERY, _UNDELIVERED)
        elif self._undelivered and not is_undelivered:
            self._host.alarms.clear(self._undelivered)
            self._undelivered = None
            for guarded in self._stoppable:
                guarded.release(_DELIVERY)

    def _follow_watch(self, now: int) -> None:
        """Say so while nobody watches whether the guard delivers."""
        if self._memory[StatusWord.UNWATCHED]:
            self._host.alarms.raise_(_UNWATCHED, now)
        else:
            self._host.alarms.clear(_UNWATCHED)

    def _check_supervisor(self, now: int) -> None:
        if self._is_ending:
            self._end_at_rest()
        elif self._watchdog.update(now, self._memory[StatusWord.SUPERVISOR_BEAT]) >= HANG_TIMEOUT:
            with suppress(ProcessLookupError):  # who starts it again has to see that it has ended
                os.kill(peer_credentials(self._connection)[0], signal.SIGKILL)
            self._stop_and_end("the supervisor stands still and is killed")

    def _on_end(self) -> None:
        self._loop.forget(self._connection)
        self._stop_and_end("the supervisor is gone")

    def _stop_and_end(self, reason: str) -> None:
        """Stop the robot and end: nobody would stop it if this process failed, too."""
        if self._is_ending:
            return
        log.error("%s: the robot is stopped, and the guard ends; start rtron guard again", reason)
        self._is_ending = True
        for guarded in self._stoppable:
            guarded.dry_run = False  # who ends forwards nothing any more: the base would drive on
            guarded.brake("supervisor", reason)
            guarded.stop_controller.release_brake()

    def _end_at_rest(self) -> None:
        if all(guarded.stop_controller.deadline() is None for guarded in self._stoppable):
            self._loop.stop()

    def _report_failure(self) -> None:
        """Tell what became of the guard before, if there was one."""
        failure_report = self._memory.failure_report.read()[1]
        if failure_report:
            self._raise_temporary_alarm(json.loads(failure_report)["why"])

    def _raise_temporary_alarm(self, reason: str) -> None:
        """Raise an alarm, and settle it when it has been to be seen for a while."""
        alarm = Alarm(kind=AlarmKind.GUARD, reason=reason, node=GUARD_NODE)
        now = self._loop.now()
        self._host.alarms.raise_(alarm, now)
        self._loop.call_at(now + _ALARM_DURATION, partial(self._host.alarms.clear, alarm))


def _record_messages(
    guarded: GuardedStream, type_info: DoubleBuffer, last_message: DoubleBuffer, loop: EventLoop
) -> None:
    """Keep in shared memory what the stream's type is, and the last message that went out."""
    validity = {flow.name: flow.silent_after for flow in guarded.spec.flows}
    default_validity = validity.get(UNAPPROVED, SECOND // 2)

    def learned(learned: TypeInfo) -> None:
        type_info.write(encode_type_info(learned))

    def sent(flow: str, message: bytes) -> None:
        now = loop.now()
        valid_until = now + validity.get(flow, default_validity)
        last_message.write(encode_last_message(now, valid_until, message))

    guarded.set_listeners(learned, sent)
