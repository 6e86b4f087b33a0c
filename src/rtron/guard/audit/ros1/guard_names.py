"""The guard's own names: a second node that takes one is found, and the name taken back.

The master lets the newest owner of a name have it, tells subscribers to go there, and asks the
one before to shut down (rosmaster, `_register_node_api`).
"""

import logging
from collections.abc import Callable, Mapping
from functools import partial

from rtron.guard.audit.common.alarm_response import Response
from rtron.guard.audit.ros1.bus_info import plain
from rtron.guard.audit.ros1.expected_graph import Expectations
from rtron.guard.audit.ros1.master_queries import Threads, refuses, uri_of
from rtron.guard.core.event_loop import Loop
from rtron.guard.core.log_throttle import Seldom
from rtron.guard.core.printable import shown
from rtron.guard.transport.ros1.middleware import Ros1Transport
from rtron.vocabulary import Alarm, AlarmKind

log = logging.getLogger(__name__)

_REPLACED = "new node registered with same name"
_MOST_CLAIMED = 256


class OwnNames:
    """Asks the master who has the guard's names; an address where nobody listens does not count."""

    def __init__(
        self,
        loop: Loop,
        master: str,
        transport: Ros1Transport,
        expected: Expectations,
        response: Response,
        claimed: dict[str, str],
    ) -> None:
        """`claimed` is filled with the addresses that had one of the names, and which."""
        self._loop = loop
        self._master = master
        self._transport = transport
        self._expected = expected
        self._response = response
        self._claimed = claimed
        self._threads = Threads(loop, "audit-names", 2)
        self._asking = False
        self._seldom = Seldom()
        self._alarms: dict[str, Alarm] = {}

    @property
    def taken(self) -> bool:
        """Tell whether somebody has one of the names."""
        return bool(self._alarms)

    def check(self) -> None:
        """Ask for all names, unless that is being done."""
        if not self._asking:
            work = partial(_impostors, self._master, self._transport.addresses())
            self._asking = self._threads.submit(work, self._checked)

    def shut(self, node: str, reason: str, obey: Callable[[], None]) -> None:
        """Deal with a call to shut a node down: a kill is obeyed, another node's arrival is not."""
        if _REPLACED not in reason:
            obey()
            return
        if self._seldom.may_say(node, self._loop.now()):
            log.error("%s is not shut down: its name was taken", node)
        own = {name: uri for name, uri in self._transport.addresses().items() if name == node}

        def found(impostors: Mapping[str, str]) -> None:
            self._found(impostors)
            if self._response.stops:
                self._transport.reclaim(node)

        self._threads.submit(partial(_impostors, self._master, own), found)

    def close(self) -> None:
        """Ask nothing any more."""
        self._threads.close()

    def _checked(self, found: Mapping[str, str]) -> None:
        self._asking = False
        for node in [name for name in self._alarms if name not in found]:
            self._response.settle(self._alarms.pop(node))
        self._found(found)

    def _found(self, found: Mapping[str, str]) -> None:
        for node, uri in found.items():
            alarm = _alarm(node, uri)
            if len(self._claimed) < _MOST_CLAIMED:
                self._claimed[plain(uri)] = node
            before = self._alarms.get(node)
            self._alarms[node] = alarm
            self._response.raise_(alarm, self._loop.now(), *self._guarded(node))
            if before and before != alarm:
                self._response.settle(before)
            if self._response.stops:
                self._transport.reclaim(node)

    def _guarded(self, node: str) -> tuple[str, ...]:
        topics = self._expected.topics.values()
        return tuple({topic.guarded for topic in topics if topic.may_publish(node)})


def _alarm(node: str, uri: str) -> Alarm:
    reason = f"{shown(uri)} has taken the name {node}"
    return Alarm(kind=AlarmKind.IMPOSTOR, reason=reason, node=node, peer=shown(uri))


def _impostors(master: str, own: Mapping[str, str]) -> dict[str, str]:
    """Return the names that the master gives to somebody else who is there, with the address."""
    found = {}
    for node, address in own.items():
        uri = uri_of(master, node)
        if uri and plain(uri) != plain(address) and not refuses(uri):
            found[node] = uri
    return found
