"""What the master and strangers are asked in threads: where nodes live, and who a stranger is.

A master that hangs keeps a thread and delays nothing else; each call has its time.
"""

import logging
import socket
from collections.abc import Callable, Iterable
from concurrent.futures import ThreadPoolExecutor
from threading import BoundedSemaphore
from typing import TypeVar

from rtron.errors import RTronError
from rtron.guard.audit.ros1.bus_info import plain
from rtron.guard.audit.ros1.foreign_connections import Identity
from rtron.guard.audit.ros1.registrations import registered
from rtron.guard.audit.ros1.xmlrpc_poller import Place
from rtron.guard.core.event_loop import Loop
from rtron.vocabulary import GUARD_NODE
from rtron.wire.ros1.xmlrpc import ros_call, split_uri

log = logging.getLogger(__name__)
_T = TypeVar("_T")

_CALL_S = 1.0
_REFUSAL_S = 0.05
_MOST_LISTED = 16
_MOST_WAITING = 256


class Threads:
    """A few threads that work for the loop; what they find is handed to the loop.

    Work that finds too much waiting before it is not taken: strangers cannot fill the memory.
    """

    def __init__(self, loop: Loop, name: str, number: int = 1) -> None:
        self._loop = loop
        self._pool = ThreadPoolExecutor(number, thread_name_prefix=name)
        self._room = BoundedSemaphore(_MOST_WAITING)

    def submit(self, work: Callable[[], _T], then: Callable[[_T], None]) -> bool:
        """Let a thread do the work and the loop what comes then; False if it is not taken."""
        if not self._room.acquire(blocking=False):
            return False

        def run() -> None:
            try:
                result = work()
            except Exception:
                log.exception("internal error in the audit")
                return
            finally:
                self._room.release()
            self._loop.post(lambda: then(result))

        self._pool.submit(run)
        return True

    def close(self) -> None:
        """Begin no more work."""
        self._pool.shutdown(wait=False, cancel_futures=True)


def place_of(master: str, node: str) -> Place | None:
    """Return where the master says that a node lives, None if it says nothing that can be used."""
    uri = uri_of(master, node)
    return place_at(uri) if uri else None


def place_at(uri: str) -> Place | None:
    """Return what a URI resolves to, None if it resolves to nothing."""
    try:
        host, port = split_uri(uri)
        family, _, _, _, where = socket.getaddrinfo(host, port, socket.AF_INET, socket.SOCK_STREAM)[
            0
        ]
    except (OSError, UnicodeError, RTronError):
        return None
    return Place(uri, (family, (str(where[0]), int(where[1]))))


def uri_of(master: str, node: str) -> str:
    """Return the address that the master has for a node, empty if none."""
    try:
        uri = ros_call(master, "lookupNode", GUARD_NODE, node, timeout=_CALL_S)
    except RTronError:
        return ""
    return uri if isinstance(uri, str) else ""


def identify(master: str, topic: str, uri: str, names: Iterable[str]) -> Identity:
    """Find out who speaks from an address: one of the planned `names`, or whom the master lists."""
    listed = _listed(master, topic)
    for name in dict.fromkeys((*names, *(listed or ()))):
        if plain(uri_of(master, name)) == uri:
            return Identity(name=name, answered=True)
    return Identity(refused=refuses(uri), answered=listed is not None)


def refuses(uri: str) -> bool:
    """Tell whether nothing listens at an address; one that does not answer in time may."""
    try:
        host, port = split_uri(uri)
        with socket.create_connection((host, port), _REFUSAL_S):
            return False
    except ConnectionRefusedError:
        return True
    except (OSError, UnicodeError, ValueError, RTronError):
        return False


def tell(uri: str, method: str, *params: object) -> None:
    """Make a call whose answer nobody needs, under the guard's name."""
    try:
        ros_call(uri, method, GUARD_NODE, *params, timeout=_CALL_S)
    except (RTronError, ValueError) as error:
        log.debug("%s", error)


def _listed(master: str, topic: str) -> list[str] | None:
    """Return whom the master lists as publishers of a topic; None if it does not answer."""
    try:
        answer = ros_call(master, "getSystemState", GUARD_NODE, timeout=_CALL_S)
        state = registered(answer, {topic: None})
    except RTronError:
        return None
    return sorted(state.publishers.get(topic, ()))[:_MOST_LISTED]
