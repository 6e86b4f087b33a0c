"""The supervisor: it watches the guard, stops the robot when the guard cannot, and restarts it."""

import json
import logging
import os
import signal
from collections.abc import Iterable

from rtron.errors import SourceError
from rtron.guard.core.event_loop import Loop
from rtron.guard.core.log_throttle import Seldom
from rtron.guard.core.printable import shown
from rtron.guard.supervision.guard_config import Order, stopped_streams
from rtron.guard.supervision.guard_process import Ward, adopt, spawn
from rtron.guard.supervision.guard_socket import is_running
from rtron.guard.supervision.link_process import Companion
from rtron.guard.supervision.shared_memory import Field, Page
from rtron.guard.supervision.stream_brakes import Brakes
from rtron.guard.supervision.supervisor_fsm import STARVED, Act, Keeper, Phase, Sign
from rtron.guard.supervision.supervisor_handover import LEAVE
from rtron.guard.supervision.watchdog import LOOK, Watchdog
from rtron.guard.transport.factory import open_transport
from rtron.guard.transport.ros1.middleware import Ros1Transport
from rtron.vocabulary import SECOND

log = logging.getLogger(__name__)

_CALM = SECOND
_OWNER_S = 0.5
_AGAIN = 5 * SECOND


class Supervisor:
    """Does what the keeper says, until it says to leave."""

    def __init__(
        self, order: Order, order_file: int, loop: Loop, *, stand_in: bool = False
    ) -> None:
        """Take over the guard that runs on the master, or start one.

        SourceError if that guard has a supervisor, or if there is none to stand in for.
        """
        streams = stopped_streams(order.plan)
        self._count = len(streams)
        self._ward = adopt(order, self._count)
        if stand_in and self._ward is None:
            raise SourceError(f"the guard on {order.master} is gone")
        self._order_file = order_file
        self._loop = loop
        self._transport = open_transport(order.plan.ros, order.master, loop)
        if isinstance(self._transport, Ros1Transport):
            self._transport.killed = self._ignore
        self._seldom = Seldom()
        page = self._ward.page if self._ward else Page.new(self._count)
        self._page = page
        self._brakes = Brakes(streams, self._transport, page)
        self._watchdog = Watchdog(loop.now())
        self._keeper = Keeper(loop.now(), adopted=self._ward is not None)
        self._companion = Companion(order_file) if order.options.get("link") else None
        self._spare: Ward | None = None
        self._spare_due = 0
        self._why = self._news = ""
        self._leaving = self._told_to_end = self._hurries = False
        self._first_owner = 0
        if self._ward:
            log.warning("taking over the guard, process %d", self._ward.pid)
            self._tend(self._ward)
            if stand_in:
                self._first_owner = page[Field.OWNER]
                self._watch_owner()

    def run(self) -> int:
        """Supervise until told to end, or until the guard ends in order; return the exit code."""
        for number in (signal.SIGINT, signal.SIGTERM):
            signal.signal(number, lambda *_: self._loop.post(self._end))
        self._look()
        self._loop.run()
        if self._spare:
            self._spare.dismiss()
        if self._companion:
            self._companion.dismiss()
        self._transport.close()
        self._loop.close()
        return self._keeper.code

    def _look(self) -> None:
        now = self._loop.now()
        self._loop.call_at(now + LOOK, self._look)
        self._page[Field.SUPERVISOR_BEAT] = now
        self._page[Field.OWNER] = self._owner()
        try:
            self._watch_guard(now)
        finally:  # whatever fails there, the robot is stopped
            braking = self._brakes.tick(now)
        if self._leaving and (self._hurries or not braking):
            self._loop.stop()

    def _watch_guard(self, now: int) -> None:
        silent = self._watchdog.look(now, self._page[Field.GUARD_BEAT])
        serving, leaving = (bool(self._page[it]) for it in (Field.SERVING, Field.LEAVING))
        self._do(self._keeper.look(now, Sign(silent, serving, leaving)), now)
        self._bury(now)
        self._prepare(now)
        if self._companion and not self._leaving:
            self._companion.look(now)

    def _owner(self) -> int:
        """Return who has started this, or the first supervisor if a guard has started this."""
        return self._first_owner or os.getppid()

    def _watch_owner(self) -> None:
        """End when nobody is left who would end what a guard has started."""
        if not is_running(self._first_owner):
            log.error("who has started the first supervisor is gone")
            self._end()
        else:
            self._loop.call_later(_OWNER_S, self._watch_owner)

    def _do(self, acts: Iterable[Act], now: int) -> None:
        for act in acts:
            match act:
                case Act.SPAWN:
                    self._spawn(now)
                case Act.BRAKE:
                    self._brake(now)
                case Act.LOOSEN:
                    log.info("the guard guards")
                    self._brakes.loosen()
                case Act.TERMINATE:
                    self._tell(signal.SIGTERM)
                case Act.KILL:
                    self._tell(signal.SIGKILL)
                case Act.LEAVE:
                    self._leaving = True
                    self._brakes.loosen()

    def _spawn(self, now: int) -> None:
        ward = self._ready() or self._started("no guard can be started")
        if ward is None:
            self._keeper.failed(now)
            return
        ward.page[Field.OWNER], ward.page[Field.SUPERVISOR_BEAT] = self._owner(), now
        news = json.dumps({"why": self._news}).encode() if self._news else b""
        ward.begin(self._page.will.read()[1], news)
        self._page, former = ward.page, self._page
        self._brakes.follow(self._page)
        former.close()
        self._watchdog = Watchdog(now)
        self._ward = ward
        self._tend(ward)
        log.info("the guard begins, process %d", ward.pid)

    def _ready(self) -> Ward | None:
        """Return the guard that waits, if it lives."""
        ward, self._spare = self._spare, None
        if ward and ward.code() is not None:
            ward.dismiss()
            return None
        if ward:
            self._keeper.ready()
        return ward

    def _started(self, otherwise: str) -> Ward | None:
        """Start a guard; None if the system has nothing left for it now."""
        try:
            return spawn(self._order_file, self._count)
        except OSError as error:
            log.warning("%s, tried again soon: %s", otherwise, error)
            return None

    def _prepare(self, now: int) -> None:
        """Have another guard ready, when this one has guarded for a moment."""
        serving = self._page[Field.SERVING]
        calm = self._keeper.phase is Phase.SERVING and serving and now - serving > _CALM
        if calm and self._spare is None and now >= self._spare_due:
            self._spare_due = now + _AGAIN
            self._spare = self._started("the next guard cannot be made ready")

    def _tend(self, ward: Ward) -> None:
        self._loop.watch(
            ward.life, lambda: self._readable(ward), lambda error: self._lose(ward, str(error))
        )

    def _readable(self, ward: Ward) -> None:
        said = ward.life.recv(len(LEAVE))
        if not said:
            self._lose(ward, "its connection has ended")
        elif said == LEAVE:
            log.warning("another supervisor takes over")
            self._loop.forget(ward.life)
            self._ward = None
            self._do(self._keeper.dismiss(), self._loop.now())

    def _lose(self, ward: Ward, why: str) -> None:
        log.debug("the guard is lost: %s", why)
        self._loop.forget(ward.life)
        now = self._loop.now()
        self._do(self._keeper.lost(now), now)

    def _brake(self, now: int) -> None:
        """Stop the robot."""
        if not self._page[Field.LEAVING]:
            state = "is gone" if self._keeper.phase is Phase.LOST else "stands still"
            log.error("the guard %s: the robot is stopped", state)
        self._brakes.brake("the guard does not answer", now)

    def _tell(self, number: int) -> None:
        if self._keeper.phase is Phase.KILLED:
            log.error("the guard stands still, or does not end: it is killed")
            self._why = "stood still and was killed"
        if self._ward:
            self._ward.tell(number)

    def _bury(self, now: int) -> None:
        """See whether the guard that was lost has ended, and what comes next."""
        if self._ward is None or self._keeper.phase is not Phase.LOST:
            return
        code = self._ward.code()
        if code is None:
            return
        self._ward = None
        self._do(self._keeper.ended(now, code), now)
        self._tell_end(code, now)

    def _tell_end(self, code: int, now: int) -> None:
        why, self._why = self._why or _told(code), ""
        if self._keeper.phase is Phase.WAITING:
            wait = max(0, self._keeper.due - now) / SECOND
            log.error("the guard %s; the next one begins in %.2g s", why, wait)
            self._news = f"the guard before {why}"

    def _end(self) -> None:
        """End; who says so twice does not want to wait until the robot is at rest."""
        now = self._loop.now()
        self._hurries = self._told_to_end
        self._told_to_end = True
        self._do(self._keeper.end(now), now)

    def _ignore(self, node: str, reason: str) -> None:
        """Go on: what stops the robot is not ended over the network."""
        if self._seldom.may_say(node, self._loop.now()):
            log.error("%s was told to shut down and does not: %s", node, shown(reason))


def _told(code: int) -> str:
    """Return what became of a process."""
    if code < 0:
        return f"was killed by {signal.Signals(-code).name}"
    return "ran out of memory" if code == STARVED else f"ended with exit code {code}"
