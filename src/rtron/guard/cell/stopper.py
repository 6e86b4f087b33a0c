"""The second stopper: a process in a cell that stops the robot when nobody guards it any more.

While a guard beats, it says nothing. Where only the supervisor does, it waits until that has
stopped the robot. It has connections of its own to the node, so it needs no other process. On ROS 2
a guard may live while its carrier does not: the supervisor does not know, so nothing is waited for.
"""

import logging

from rtron.guard.cell.access import GUARD, SUPERVISOR
from rtron.guard.cell.access_server import AccessServer
from rtron.guard.core.event_loop import EventLoop
from rtron.guard.core.message_types import codec_of, standard_info
from rtron.guard.supervision.watchdog import SchedulingDelay, Watchdog, adapt_bound
from rtron.guard.transport.common.protocol import Output, OutputOptions, Transport
from rtron.vocabulary import SECOND, STOPPER_NODE, Stream, output_topic

log = logging.getLogger(__name__)

SILENCE_LIMIT = SECOND // 10
"""How long a process may be silent before it counts as gone, ns."""
_LONGEST_LIMIT = 3 * SECOND // 10
"""The same on a machine on which everything is late."""
_GRACE = SECOND // 2
"""How much longer than its stop takes a supervisor may be alone, ns."""
_PERIOD = SECOND // 100


class CellStopper:
    """Sends zeros on each stream, one each `period` of the plan's stop, while nobody guards.

    Streams of a type without a standard definition cannot be stopped here.
    """

    def __init__(
        self,
        loop: EventLoop,
        transport: Transport,
        streams: tuple[Stream, ...],
        access: AccessServer,
        *,
        is_carried: bool,
    ) -> None:
        """`is_carried` tells whether guards reach the cell by carriers (ROS 2)."""
        self._loop = loop
        self._access = access
        self._stops = [stop for each in streams if (stop := _stop_of(each, transport))]
        self._is_carried = is_carried
        self._carrier_watchdog = Watchdog(loop.now())
        self._watchdogs = {role: Watchdog(loop.now()) for role in (GUARD, SUPERVISOR)}
        self._guarded_at = 0
        self._delay = SchedulingDelay(loop.now(), _PERIOD)
        self._is_stopping = True
        self._next_stop = loop.now() + _LONGEST_LIMIT  # a guard may be waiting for the next stopper
        self._period = min((each.stop.period for each in streams), default=SECOND)
        self._supervised_limit = max((each.stop.within for each in streams), default=0) + _GRACE

    def open(self) -> None:
        """Watch from now on."""
        self._loop.call_at(self._loop.now() + _PERIOD, self.open)
        self.look()

    def look(self) -> None:
        """Stop the robot if nobody guards it."""
        now = self._loop.now()
        limit = adapt_bound(SILENCE_LIMIT, self._delay.update(now), _LONGEST_LIMIT)
        beating = {role for role in self._watchdogs if self._beats(role, now, limit)}
        if GUARD in beating:
            self._guarded_at = now
        is_cut_off = self._is_cut_off(now, limit)
        is_supervised = (
            SUPERVISOR in beating
            and not is_cut_off
            and now - self._guarded_at < self._supervised_limit
        )
        is_guarded = GUARD in beating or is_supervised
        if is_guarded == self._is_stopping:
            self._change(is_guarded=is_guarded, now=now)
        if self._is_stopping and now >= self._next_stop:
            self._next_stop = now + self._period
            for output, zero in self._stops:
                output.publish(zero)

    def _beats(self, role: bytes, now: int, limit: int) -> bool:
        silence = self._watchdogs[role].update(now, self._access.beats[role])
        return self._access.has(role) and silence < limit

    def _is_cut_off(self, now: int, limit: int) -> bool:
        """Tell whether it is the carrier of the guard that is gone."""
        silence = self._carrier_watchdog.update(now, self._access.carrier_beats)
        if self._access.has(GUARD):
            return self._is_carried and silence >= limit
        return self._is_carried and not self._access.has_left

    def _change(self, *, is_guarded: bool, now: int) -> None:
        self._is_stopping, self._next_stop = not is_guarded, now
        if is_guarded:
            log.info("a guard guards the cell")
        else:
            log.error("nobody guards the cell any more: the robot is stopped")


def _stop_of(stream: Stream, transport: Transport) -> tuple[Output, bytes] | None:
    """Return the output of a stream and the message that stops it, if its type has one."""
    info = standard_info(stream.type, transport.encoding)
    codec = codec_of(info, transport.encoding) if info else None
    if info is None or codec is None or codec.is_limit:
        log.warning("%s cannot be stopped without a guard: %s", stream.topic, stream.type)
        return None
    topic = output_topic(stream.topic)
    options = OutputOptions(queue_size=1)
    output = transport.advertise(STOPPER_NODE, topic, stream.type, options)
    output.learn_type(info)
    return output, codec.zero_message
