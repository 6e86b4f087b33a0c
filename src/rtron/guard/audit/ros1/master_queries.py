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
from rtron.guard.audit.ros1.foreign_connections import PeerIdentity, normalise_uri
from rtron.guard.audit.ros1.xmlrpc_poller import ServerAddress
from rtron.guard.core.event_loop import EventLoop
from rtron.vocabulary import GUARD_NODE
from rtron.wire.ros1.ros_api import query_node_uri, query_system_state
from rtron.wire.ros1.xmlrpc import RefusalError, ros_call, split_uri

log = logging.getLogger(__name__)
_T = TypeVar("_T")

_CALL_S = 1.0
_REFUSAL_S = 0.05
_MAX_LISTED = 16
_MAX_QUEUED = 256


class WorkerThreads:
    """A few threads that work for the loop; what they find is handed to the loop.

    Work that finds too much waiting before it is not taken: strangers cannot fill the memory.
    """

    def __init__(self, loop: EventLoop, name: str, number: int = 1) -> None:
        self._loop = loop
        self._pool = ThreadPoolExecutor(number, thread_name_prefix=name)
        self._free_slots = BoundedSemaphore(_MAX_QUEUED)

    def submit(self, work: Callable[[], _T], on_result: Callable[[_T], None]) -> bool:
        """Let a thread do the work and the loop what comes then; False if it is not taken."""
        if not self._free_slots.acquire(blocking=False):
            return False

        def run() -> None:
            try:
                result = work()
            except Exception:
                log.exception("internal error in the audit")
                return
            finally:
                self._free_slots.release()
            self._loop.post(lambda: on_result(result))

        self._pool.submit(run)
        return True

    def close(self) -> None:
        """Begin no more work."""
        self._pool.shutdown(wait=False, cancel_futures=True)


def resolve_node(master: str, node: str) -> ServerAddress | None:
    """Return where the master says that a node lives, None if it says nothing that can be used."""
    uri = look_up_uri(master, node)
    return resolve_uri(uri) if uri else None


def resolve_uri(uri: str) -> ServerAddress | None:
    """Return what a URI resolves to, None if it resolves to nothing."""
    try:
        host, port = split_uri(uri)
        family, _, _, _, host_port = socket.getaddrinfo(
            host, port, socket.AF_INET, socket.SOCK_STREAM
        )[0]
    except (OSError, UnicodeError, RTronError):
        return None
    return ServerAddress(uri, (family, (str(host_port[0]), int(host_port[1]))))


def look_up_uri(master: str, node: str) -> str:
    """Return the address that the master has for a node, empty if none."""
    return query_uri(master, node) or ""


def query_uri(master: str, node: str) -> str | None:
    """Return the same, but None if the master does not answer."""
    try:
        return query_node_uri(master, GUARD_NODE, node, _CALL_S)
    except RefusalError:
        return ""
    except RTronError:
        return None


def identify_peer(master: str, topic: str, uri: str, names: Iterable[str]) -> PeerIdentity:
    """Find out who speaks from an address: one of the planned `names`, or whom the master lists.

    The master lists a node that was killed until the next one of its name registers.
    """
    listed = _listed_publishers(master, topic)
    for name in dict.fromkeys((*names, *(listed or ()))):
        if normalise_uri(look_up_uri(master, name)) == uri:
            return PeerIdentity(name=name, is_refused=refuses_connections(uri), is_answered=True)
    return PeerIdentity(is_refused=refuses_connections(uri), is_answered=listed is not None)


def refuses_connections(uri: str) -> bool:
    """Tell whether nothing listens at an address; one that does not answer in time may."""
    try:
        host, port = split_uri(uri)
        with socket.create_connection((host, port), _REFUSAL_S):
            return False
    except ConnectionRefusedError:
        return True
    except (OSError, UnicodeError, ValueError, RTronError):
        return False


def send_call(uri: str, method: str, *params: object) -> None:
    """Make a call whose answer nobody needs, under the guard's name."""
    try:
        ros_call(uri, method, GUARD_NODE, *params, timeout=_CALL_S)
    except (RTronError, ValueError) as error:
        log.debug("%s", error)


def _listed_publishers(master: str, topic: str) -> list[str] | None:
    """Return whom the master lists as publishers of a topic; None if it does not answer."""
    try:
        state = query_system_state(master, GUARD_NODE, _CALL_S)
    except RTronError:
        return None
    return sorted({node for name, node in state.publishers if name == topic})[:_MAX_LISTED]
