"""What ties a guard to its supervisor, seen from the guard."""

import json
import logging
import os
import signal
import socket
import subprocess
from collections import deque
from contextlib import suppress
from functools import partial
from itertools import count
from typing import TYPE_CHECKING

from rtron.guard.coordinator import Coordinator
from rtron.guard.core.event_loop import EventLoop
from rtron.guard.core.handover_state import HandoverState
from rtron.guard.core.stream import GuardedStream
from rtron.guard.supervision.double_buffer import DoubleBuffer
from rtron.guard.supervision.guard_config import GuardConfig, is_stoppable
from rtron.guard.supervision.programs import BACKUP_SUPERVISOR, command
from rtron.guard.supervision.shared_memory import (
    GuardMemory,
    StatusWord,
    decode_last_message,
    encode_last_message,
    encode_type_info,
)
from rtron.guard.supervision.supervisor_handover import (
    DISMISS_MESSAGE,
    HAND_OVER_MESSAGE,
    WATCHING_MESSAGE,
    HandoverAnswer,
    HandoverSocket,
    bind_guard_socket,
    is_running,
)
from rtron.guard.supervision.watchdog import BEAT_PERIOD, Watchdog
from rtron.guard.system.out_of_memory import exit_if_out_of_memory
from rtron.guard.system.unix_socket import peer_credentials
from rtron.guard.transport.common.protocol import SupervisorId, TypeInfo
from rtron.vocabulary import (
    GUARD_NODE,
    SECOND,
    SUPERVISOR_NODE,
    UNAPPROVED,
    Alarm,
    AlarmKind,
)

if TYPE_CHECKING:
    from collections.abc import Callable

    from rtron.wire.ros2.session import Ros2Session

log = logging.getLogger(__name__)

SUPERVISOR_HANG_TIMEOUT = 2 * SECOND
"""Silence after which a supervisor is dismissed, ns; one that starts may take `start_within`."""
_DISMISS_TIMEOUT = SECOND
"""How long a supervisor that is dismissed may take to end before it is killed, ns."""
UNSUPERVISED_LIMIT = 2 * SECOND
"""How long the guard waits for a supervisor to come before it starts one, ns."""
_MAX_FORMER = 8
"""More supervisors do not end within the time that a dead one may stay in the graph."""
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
    """Beats, keeps what the supervisor has to know, and sees to it that there is a supervisor."""

    def __init__(
        self,
        config: GuardConfig,
        memory: GuardMemory,
        connection: socket.socket,
        config_file: int,
        session: "Ros2Session | None" = None,
    ) -> None:
        """Take the connection to the supervisor, and the configuration for a backup supervisor.

        `session` was opened while the guard waited to begin.

        SourceError if there is another guard on the master.
        """
        self.handover_state = HandoverState(
            memory.handover_state.read()[1], memory.handover_state.write
        )
        self.session = session
        self.configuration = config.digest
        self._config = config
        self._config_file = config_file
        self._memory = memory
        self._connection: socket.socket | None = None
        self._first_connection = connection
        self._guard_socket = bind_guard_socket(config.master)
        self._backup: subprocess.Popen[bytes] | None = None
        self._last_stop = 0
        self._undelivered: Alarm | None = None
        self._is_starting = self._is_dismissed = False
        self._disconnected_at = 0
        self._is_ending = False
        self._turn = count()
        self.on_change: Callable[[], None] = lambda: None
        """Called when a supervisor has come or gone."""
        self._announcement = 0
        """The last announcement of a supervisor that has gone."""
        self._former_participants: deque[bytes] = deque(maxlen=_MAX_FORMER)

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
        if self._guard_socket:
            self._handover_socket = HandoverSocket(
                self._loop, self._guard_socket, self._on_offer, self._on_accept
            )
        else:
            log.warning("somebody else has the name of this guard: it cannot be found")
        self._use_connection(self._first_connection)
        self._report_failure()
        self._loop.call_at(self._loop.now(), self._beat)

    def close(self) -> None:
        """Let the supervisor know that the guard ends in order, and be found no more."""
        self._memory[StatusWord.LEAVING] = 1
        if self._guard_socket:
            self._handover_socket.close()

    def identify_supervisor(self) -> SupervisorId:
        """Return who supervises the guard now, and who did so before."""
        if self._connection is None:
            return SupervisorId()
        process = peer_credentials(self._connection)[0]
        announcement, participant = self._memory.supervisor_participant.read()
        if announcement == self._announcement:
            return SupervisorId(process)
        return SupervisorId(process, frozenset((participant, *self._former_participants)))

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
                guarded.stop_controller.interrupt()
        if not self._memory[StatusWord.UNDELIVERED]:
            self._raise_temporary_alarm(
                AlarmKind.GUARD, "it stood still, and the supervisor stopped the robot"
            )

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
        if self._memory[StatusWord.UNWATCHED] and self._connection:
            self._host.alarms.raise_(_UNWATCHED, now)
        else:
            self._host.alarms.clear(_UNWATCHED)

    def _check_supervisor(self, now: int) -> None:
        if self._is_ending:
            self._end_at_rest()
        elif self._connection is None:
            self._run_unsupervised(now)
        else:
            self._watch_supervisor(self._connection, now)

    def _watch_supervisor(self, connection: socket.socket, now: int) -> None:
        """Dismiss the supervisor if it does not beat, and kill it if it does not leave then."""
        start_within = self._config.plan.supervision.start_within
        limit = start_within if self._is_starting else SUPERVISOR_HANG_TIMEOUT
        silence = self._watchdog.update(now, self._memory[StatusWord.SUPERVISOR_BEAT])
        if silence >= limit + _DISMISS_TIMEOUT:
            os.kill(peer_credentials(connection)[0], signal.SIGKILL)
        elif silence >= limit and not self._is_dismissed:
            log.error("the supervisor stands still: it is ended")
            self._is_dismissed = True
            with suppress(OSError):  # it may have just died
                connection.send(DISMISS_MESSAGE)

    def _run_unsupervised(self, now: int) -> None:
        """Wait for a supervisor, then start one, unless nobody is left who would end the guard."""
        if self._backup and self._backup.poll() is not None:
            self._backup = None
        if not is_running(self._memory[StatusWord.OWNER]):
            self._stop_and_end("the supervisor is gone, and who has started it too")
        elif now - self._disconnected_at >= UNSUPERVISED_LIMIT and self._backup is None:
            self._disconnected_at = now
            self._start_supervisor()

    def _start_supervisor(self) -> None:
        arguments = command(BACKUP_SUPERVISOR, [self._config_file])
        try:
            self._backup = subprocess.Popen(arguments, pass_fds=[self._config_file])  # noqa: S603
        except OSError as error:
            log.warning("no supervisor can be started, tried again soon: %s", error)
        else:
            log.warning("a supervisor is started, process %d", self._backup.pid)

    def _stop_and_end(self, reason: str) -> None:
        """Stop the robot and end."""
        log.error("%s: the guard ends", reason)
        self._is_ending = True
        for guarded in self._stoppable:
            guarded.brake("supervisor", reason)
            guarded.stop_controller.release_brake()

    def _end_at_rest(self) -> None:
        if all(guarded.stop_controller.deadline() is None for guarded in self._stoppable):
            self._loop.stop()

    def _on_offer(self, digest: str) -> tuple[HandoverAnswer, int]:
        if self._connection and not self._is_backup(self._connection):
            return HandoverAnswer.SUPERVISED, -1
        if digest != self._config.digest:
            return HandoverAnswer.OTHER, -1
        return HandoverAnswer.YES, self._memory.descriptor

    def _is_backup(self, connection: socket.socket) -> bool:
        return self._backup is not None and peer_credentials(connection)[0] == self._backup.pid

    def _on_accept(self, connection: socket.socket) -> None:
        former = self._connection
        if former:
            self._note_former_supervisor()
            with suppress(OSError):  # it may have just died
                former.send(HAND_OVER_MESSAGE)
            self._loop.forget(former)
        self._use_connection(connection)
        log.warning("the guard has a supervisor, process %d", peer_credentials(connection)[0])

    def _use_connection(self, connection: socket.socket) -> None:
        self._connection = connection
        self.on_change()
        self._watchdog = Watchdog(self._loop.now())
        self._is_starting, self._is_dismissed = connection is not self._first_connection, False
        connection.settimeout(0)
        self._loop.watch(
            connection, partial(self._on_readable, connection), partial(self._on_error, connection)
        )

    def _on_readable(self, connection: socket.socket) -> None:
        received = connection.recv(len(WATCHING_MESSAGE))
        if not received:
            self._on_connection_lost(connection)
        elif received == WATCHING_MESSAGE:
            self._is_starting = False

    def _on_error(self, connection: socket.socket, error: Exception) -> None:
        log.debug("%s", error)
        self._on_connection_lost(connection)

    def _on_connection_lost(self, connection: socket.socket) -> None:
        self._loop.forget(connection)
        self._connection, self._disconnected_at = None, self._loop.now()
        self._note_former_supervisor()
        self.on_change()
        self._raise_temporary_alarm(AlarmKind.SUPERVISOR, "it is gone; the guard goes on")

    def _note_former_supervisor(self) -> None:
        """Await the next one's announcement; the participant of this one stays in the graph."""
        self._announcement, participant = self._memory.supervisor_participant.read()
        self._former_participants.append(participant)

    def _report_failure(self) -> None:
        """Tell what became of the guard before, if there was one."""
        failure_report = self._memory.failure_report.read()[1]
        if failure_report:
            self._raise_temporary_alarm(AlarmKind.GUARD, json.loads(failure_report)["why"])

    def _raise_temporary_alarm(self, kind: AlarmKind, reason: str) -> None:
        """Raise an alarm, and settle it when it has been to be seen for a while."""
        node = GUARD_NODE if kind is AlarmKind.GUARD else SUPERVISOR_NODE
        alarm = Alarm(kind=kind, reason=reason, node=node)
        now = self._loop.now()
        self._host.alarms.raise_(alarm, now)
        self._loop.call_at(now + _ALARM_DURATION, partial(self._settle, alarm))

    def _settle(self, alarm: Alarm) -> None:
        if alarm.kind is AlarmKind.SUPERVISOR and self._connection is None:
            self._loop.call_later(1.0, partial(self._settle, alarm))
        else:
            self._host.alarms.clear(alarm)


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
