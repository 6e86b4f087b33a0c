"""What becomes of calls to shut the guard's nodes down: the slave API lets anybody make them."""

import logging

from rtron.guard.core.coordinator import Host
from rtron.guard.core.event_loop import Loop
from rtron.guard.core.log_throttle import Seldom
from rtron.guard.core.printable import shown
from rtron.guard.core.stream import GuardedStream
from rtron.guard.transport.ros1.middleware import Ros1Transport
from rtron.policies.velocity_watchdog import LONGEST
from rtron.vocabulary import GUARD_NODE, SECOND

log = logging.getLogger(__name__)

_LOOK = SECOND // 50


class Refusing:
    """Goes on: what guards the robot is not ended over the network while it is supervised."""

    def __init__(self, loop: Loop) -> None:
        self._loop = loop
        self._seldom = Seldom()

    def shut(self, node: str, reason: str) -> None:
        """Say how the guard is ended instead, once a second at most."""
        if self._seldom.may_say(node, self._loop.now()):
            told = "%s is not shut down, end rtron guard itself: %s"
            log.warning(told, node, shown(reason))


class Obeying:
    """Shuts nodes down, once what they moved was told to stop."""

    def __init__(self, host: Host, transport: Ros1Transport, loop: Loop) -> None:
        self._host = host
        self._transport = transport
        self._loop = loop
        self._ending: set[str] = set()

    def shut(self, node: str, reason: str) -> None:
        """Stop what a node has moved, then take it out of the graph; end with the guard's own."""
        if node in self._ending:
            return
        self._ending.add(node)
        log.error("%s was shut down: %s", node, shown(reason))
        ends = self._host.killed(node, shown(reason))
        stopped = [each for each in self._host.guarded if ends or node in each.nodes]
        if ends:
            _stop(stopped)
        longest = max((each.stream.stop.repeat for each in stopped), default=0) + LONGEST
        self._leave(node, stopped, self._loop.now() + longest)

    def _leave(self, node: str, stopped: list[GuardedStream], until: int) -> None:
        now = self._loop.now()
        if now < until and any(each.stopper.deadline() is not None for each in stopped):
            self._loop.call_at(now + _LOOK, lambda: self._leave(node, stopped, until))
            return
        self._transport.remove(node)
        if node == GUARD_NODE:
            self._loop.stop()


def _stop(streams: list[GuardedStream]) -> None:
    for each in streams:
        each.brake("shutdown", f"{GUARD_NODE} was shut down")
        each.stopper.loosen()
