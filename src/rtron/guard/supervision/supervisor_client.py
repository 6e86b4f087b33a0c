"""What ties a guard to its supervisor, seen from the guard."""

import json
import logging
import os
import signal
import socket
import subprocess
from contextlib import suppress
from functools import partial

from rtron.guard.core.coordinator import Host
from rtron.guard.core.event_loop import Loop
from rtron.guard.core.handover_state import Will
from rtron.guard.core.out_of_memory import end_if_starving
from rtron.guard.core.stream import GuardedStream
from rtron.guard.supervision.guard_config import Order, stoppable
from rtron.guard.supervision.guard_socket import is_running, peer_of
from rtron.guard.supervision.last_message import Said, info_bytes, said_of
from rtron.guard.supervision.programs import STAND_IN, command
from rtron.guard.supervision.shared_memory import Cell, Field, Page
from rtron.guard.supervision.supervisor_handover import LEAVE, Answer, Door, bound
from rtron.guard.supervision.watchdog import LOOK, Watchdog
from rtron.guard.transport.common.protocol import TypeInfo
from rtron.vocabulary import (
    GUARD_NODE,
    SECOND,
    SUPERVISOR_NODE,
    UNAPPROVED,
    Alarm,
    AlarmKind,
)

log = logging.getLogger(__name__)

HUNG = 2 * SECOND
"""Silence after which a supervisor is killed, ns."""
ALONE = 2 * SECOND
"""How long the guard waits for a supervisor to come before it starts one, ns."""
_REMEMBERED = 30 * SECOND


class Tie:
    """Beats, keeps what the supervisor has to know, and sees to it that there is a supervisor."""

    def __init__(self, order: Order, page: Page, life: socket.socket, order_file: int) -> None:
        """`life` is the connection to the supervisor, `order_file` the order for another one.

        SourceError if there is another guard on the master.
        """
        self.will = Will(page.will.read()[1], page.will.write)
        self._order = order
        self._order_file = order_file
        self._page = page
        self._life: socket.socket | None = None
        self._first = life
        self._address = bound(order.master)
        self._stand_in: subprocess.Popen[bytes] | None = None
        self._stopped_at = 0
        self._lost_at = 0
        self._ends = False

    def open(self, loop: Loop, host: Host) -> None:
        """Keep what the streams of a host say, and beat as soon as the loop runs."""
        self._loop = loop
        self._host = host
        self._watchdog = Watchdog(loop.now())
        self._stopped = [each for each in host.guarded if stoppable(each.stream)]
        cells = zip(self._page.infos, self._page.said, strict=True)
        for guarded, (info, said) in zip(self._stopped, cells, strict=True):
            _report(guarded, info, said, loop)
        if self._address:
            self._door = Door(loop, self._address, self._offered, self._taken)
        else:
            log.warning("somebody else has the name of this guard: it cannot be found")
        self._take(self._first)
        self._tell_why()
        loop.call_at(loop.now(), self._beat)

    def close(self) -> None:
        """Let the supervisor know that the guard ends in order, and be found no more."""
        self._page[Field.LEAVING] = 1
        if self._address:
            self._door.close()

    @property
    def supervisor(self) -> int:
        """Who supervises the guard now, by its process id, 0 if nobody does."""
        return peer_of(self._life)[0] if self._life else 0

    def _beat(self) -> None:
        now = self._loop.now()
        self._loop.call_at(now + LOOK, self._beat)
        end_if_starving()
        self._page[Field.GUARD_BEAT] = now
        self._page[Field.SERVING] = self._page[Field.SERVING] or now
        self._notice_stop()
        self._look(now)

    def _notice_stop(self) -> None:
        """See whether the supervisor has stopped the robot: a ramp would set it in motion again."""
        at = self._page[Field.STOPPED]
        if at == self._stopped_at:
            return
        self._stopped_at = at
        for guarded, said in zip(self._stopped, self._page.said, strict=True):
            if said_of(said.read()[1]).at < at:
                guarded.stopper.interrupt()
        self._remember(AlarmKind.GUARD, "it stood still, and the supervisor stopped the robot")

    def _look(self, now: int) -> None:
        if self._ends:
            self._end_at_rest()
        elif self._life is None:
            self._go_on_alone(now)
        elif self._watchdog.look(now, self._page[Field.SUPERVISOR_BEAT]) >= HUNG:
            self._end_supervisor(self._life)

    def _end_supervisor(self, life: socket.socket) -> None:
        log.error("the supervisor stands still: it is killed")
        self._watchdog = Watchdog(self._loop.now())
        os.kill(peer_of(life)[0], signal.SIGKILL)

    def _go_on_alone(self, now: int) -> None:
        """Wait for a supervisor, then start one, unless nobody is left who would end the guard."""
        if self._stand_in and self._stand_in.poll() is not None:
            self._stand_in = None
        if not is_running(self._page[Field.OWNER]):
            self._leave("the supervisor is gone, and who has started it too")
        elif now - self._lost_at >= ALONE and self._stand_in is None:
            self._lost_at = now
            self._start_supervisor()

    def _start_supervisor(self) -> None:
        words = command(STAND_IN, [self._order_file])
        try:
            self._stand_in = subprocess.Popen(words, pass_fds=[self._order_file])  # noqa: S603
        except OSError as error:
            log.warning("no supervisor can be started, tried again soon: %s", error)
        else:
            log.warning("a supervisor is started, process %d", self._stand_in.pid)

    def _leave(self, why: str) -> None:
        """Stop the robot and end."""
        log.error("%s: the guard ends", why)
        self._ends = True
        for guarded in self._stopped:
            guarded.brake("supervisor", why)
            guarded.stopper.loosen()

    def _end_at_rest(self) -> None:
        if all(guarded.stopper.deadline() is None for guarded in self._stopped):
            self._loop.stop()

    def _offered(self, digest: str) -> tuple[Answer, int]:
        if self._life and not self._is_stand_in(self._life):
            return Answer.SUPERVISED, -1
        if digest != self._order.digest:
            return Answer.OTHER, -1
        return Answer.YES, self._page.descriptor

    def _is_stand_in(self, life: socket.socket) -> bool:
        return self._stand_in is not None and peer_of(life)[0] == self._stand_in.pid

    def _taken(self, life: socket.socket) -> None:
        former = self._life
        if former:
            with suppress(OSError):  # it may have just died
                former.send(LEAVE)
            self._loop.forget(former)
        self._take(life)
        log.warning("the guard has a supervisor, process %d", peer_of(life)[0])

    def _take(self, life: socket.socket) -> None:
        self._life = life
        self._watchdog = Watchdog(self._loop.now())
        life.settimeout(0)
        self._loop.watch(life, partial(self._readable, life), partial(self._broken, life))

    def _readable(self, life: socket.socket) -> None:
        if not life.recv(1):
            self._lose(life)

    def _broken(self, life: socket.socket, error: Exception) -> None:
        log.debug("%s", error)
        self._lose(life)

    def _lose(self, life: socket.socket) -> None:
        self._loop.forget(life)
        self._life, self._lost_at = None, self._loop.now()
        self._remember(AlarmKind.SUPERVISOR, "it is gone; the guard goes on")

    def _tell_why(self) -> None:
        """Tell what became of the guard before, if there was one."""
        news = self._page.news.read()[1]
        if news:
            self._remember(AlarmKind.GUARD, json.loads(news)["why"])

    def _remember(self, kind: AlarmKind, reason: str) -> None:
        """Raise an alarm, and settle it when it has been to be seen for a while."""
        node = GUARD_NODE if kind is AlarmKind.GUARD else SUPERVISOR_NODE
        alarm = Alarm(kind=kind, reason=reason, node=node)
        now = self._loop.now()
        self._host.alarms.raise_(alarm, now)
        self._loop.call_at(now + _REMEMBERED, partial(self._settle, alarm))

    def _settle(self, alarm: Alarm) -> None:
        if alarm.kind is AlarmKind.SUPERVISOR and self._life is None:
            self._loop.call_later(1.0, partial(self._settle, alarm))
        else:
            self._host.alarms.settle(alarm)


def _report(guarded: GuardedStream, info: Cell, said: Cell, loop: Loop) -> None:
    """Keep in shared memory what the stream's type is, and the last message that went out."""
    in_force = {flow.name: flow.silent_after for flow in guarded.stream.flows}
    default = in_force.get(UNAPPROVED, SECOND // 2)

    def learned(learned: TypeInfo) -> None:
        info.write(info_bytes(learned))

    def sent(flow: str, message: bytes) -> None:
        now = loop.now()
        said.write(Said(now, now + in_force.get(flow, default), message).bytes())

    guarded.report(learned, sent)
