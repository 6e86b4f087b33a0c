"""Which node has which name: no name of the plan is taken from a node that is alive.

rosmaster shuts a node down when another registers under its name, and also when a name moves away
from an address (rosmaster/registrations.py). Nodes are asked in threads.
"""

import logging
import socket
from collections import Counter
from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from functools import partial
from ipaddress import ip_address

from rtron.errors import RTronError, SourceError, WireError
from rtron.guard.core.event_loop import EventLoop
from rtron.guard.master_proxy.access_rules import ROSOUT
from rtron.vocabulary import (
    BULK_NODE,
    GUARD_NODE,
    SUPERVISOR_NODE,
    TopicAccess,
    is_guard_name,
    matches_node,
)
from rtron.vocabulary.topic_access import ANY_NODE
from rtron.wire.ros1.ros_api import query_node_uri, query_process_id
from rtron.wire.ros1.xmlrpc import split_uri

log = logging.getLogger(__name__)

CALLER = "/rtron_master"
UNDECIDED = "whether it may could not be found out"
_TIMEOUT_S = 1.0
_REGISTRATION_TIMEOUT_S = 5.0
"""How long a node that registers may take to answer, seconds: a robot that starts is busy."""
_WORKERS = 64
_MAX_QUERIES = 16
_MAX_REGISTRATIONS = 1 << 14
_REFRESH_S = 2.0

OnDecision = Callable[[str], None]


@dataclass(frozen=True, slots=True, kw_only=True)
class NodeRegistration:
    """Where a node was when it registered: its slave API's address, and its process."""

    name: str
    uri: str
    host: str
    port: int
    pid: int


class NameRegistry:
    """The addresses of the nodes that the plan names, and of the guard's."""

    def __init__(self, loop: EventLoop, topics: Sequence[TopicAccess], private: str) -> None:
        self._loop = loop
        self._private = private
        named = {name for each in topics for name in (*each.publishers, *each.subscribers)}
        guards = {GUARD_NODE, BULK_NODE, SUPERVISOR_NODE} if topics else set()
        self._guard_names = sorted(guards.union(filter(is_guard_name, named)))
        self._planned_names = (
            sorted((named | {ROSOUT}) - {ANY_NODE, *self._guard_names}) if topics else []
        )
        self._registrations: dict[str, NodeRegistration] = {}
        self._query_counts: Counter[str] = Counter()
        self._waiting: dict[tuple[str, str], list[OnDecision]] = {}
        self._workers = ThreadPoolExecutor(_WORKERS, thread_name_prefix="name registry")
        if self._guard_names:
            loop.post(self._refresh)

    def close(self) -> None:
        """Ask no more."""
        self._workers.shutdown(wait=False, cancel_futures=True)

    def admit(self, name: str, uri: str, on_decision: OnDecision) -> None:
        """Find out whether `name` may register at `uri`; `on_decision` gets why not, or nothing."""
        others = [s for s in self._registrations.values() if s.port == split_uri(uri)[1]]
        others = [registration for registration in others if registration.name != name]
        pattern = next((each for each in self._planned_names if matches_node(each, name)), "")
        former = self._registrations.get(name)
        if not others and (not pattern or (former and former.uri == uri)):
            on_decision("")
        elif waiting := self._waiting.get((name, uri)):
            waiting.append(on_decision)  # a node registers many topics at once
        elif self._query_counts[pattern] >= _MAX_QUERIES:
            on_decision(f"too many ask for the name {name} at once")
        else:
            self._query_counts[pattern] += 1
            self._waiting[name, uri] = [on_decision]
            work = partial(
                _examine, name, uri, former if pattern else None, others, must_answer=bool(pattern)
            )
            self._submit(work, partial(self._on_examined, pattern, (name, uri), former))

    def _on_examined(
        self,
        pattern: str,
        who: tuple[str, str],
        former: NodeRegistration | None,
        found: NodeRegistration | str,
    ) -> None:
        self._query_counts[pattern] -= 1
        why = found if isinstance(found, str) else self._register(pattern, former, found)
        for on_decision in self._waiting.pop(who):
            on_decision(why)

    def _register(
        self, pattern: str, former: NodeRegistration | None, found: NodeRegistration
    ) -> str:
        """Register a node where it was found, unless another was faster."""
        now = self._registrations.get(found.name)
        if now is not former and now is not None and now.uri != found.uri:
            return f"{found.name} has just registered at another address"
        if now is None and pattern != found.name and len(self._registrations) >= _MAX_REGISTRATIONS:
            return f"too many nodes have registered under names like {pattern}"
        if pattern:
            self._registrations[found.name] = found
        return ""

    def _refresh(self) -> None:
        """Learn where the guard's nodes are: they do not register through the proxy."""

        def done(found: Sequence[NodeRegistration]) -> None:
            others = {n: each for n, each in self._registrations.items() if not is_guard_name(n)}
            self._registrations = others | {each.name: each for each in found}
            self._loop.call_later(_REFRESH_S, self._refresh)

        self._submit(
            lambda: [s for node in self._guard_names for s in _look_up_node(self._private, node)],
            done,
            [],
        )

    def _submit(
        self, work: Callable[[], object], done: Callable[..., None], failed: object = UNDECIDED
    ) -> None:
        """Do `work` in a thread and give its result to `done` in the loop's."""

        def run_work() -> None:
            found = failed
            try:
                found = work()
            except Exception:
                log.exception("internal error while asking a node")
            self._loop.post(partial(done, found))

        self._workers.submit(run_work)


def _examine(
    name: str,
    uri: str,
    former: NodeRegistration | None,
    others: Sequence[NodeRegistration],
    *,
    must_answer: bool,
) -> NodeRegistration | str:
    """Return where a node is, or why it may not register; one that is not named need not answer."""
    host, port = split_uri(uri)
    addresses = _resolve_addresses(host)
    if not addresses:
        return f"{host[:80]!r} does not resolve to an address"
    for other in others:
        if addresses & _resolve_addresses(other.host) and _is_alive(other):
            return f"{uri[:80]!r} is the address of {other.name}, not of {name}"
    if former and former.uri != uri and _is_alive(former):
        return f"{name} is registered at another address and still answers there"
    pid = _query_pid(uri, _REGISTRATION_TIMEOUT_S) if must_answer else 0
    if pid is None:
        return f"{name} does not answer at {uri[:80]!r}"
    return NodeRegistration(name=name, uri=uri, host=host, port=port, pid=pid)


def _is_alive(registration: NodeRegistration) -> bool:
    """Tell whether a node is alive; one of this machine that hangs has not gone."""
    try:
        return query_process_id(registration.uri, CALLER, _TIMEOUT_S) == registration.pid
    except SourceError as error:
        is_hanging = isinstance(error.__cause__, TimeoutError)
        return is_hanging and is_local(registration.host)
    except RTronError:
        return False


def _query_pid(uri: str, timeout: float) -> int | None:
    try:
        return query_process_id(uri, CALLER, timeout)
    except RTronError:
        return None


def _look_up_node(private: str, node: str) -> list[NodeRegistration]:
    """Ask the private master where a node is; nothing if there is none that answers."""
    try:
        uri = query_node_uri(private, CALLER, node, _TIMEOUT_S)
        host, port = split_uri(uri)
    except (SourceError, WireError):
        return []
    pid = _query_pid(uri, _TIMEOUT_S)
    return (
        [] if pid is None else [NodeRegistration(name=node, uri=uri, host=host, port=port, pid=pid)]
    )


def _resolve_addresses(host: str) -> frozenset[str]:
    """Return a host's addresses, all of this machine's as one; none if it does not resolve."""
    try:
        found = socket.getaddrinfo(host, None, type=socket.SOCK_STREAM)
    except (OSError, UnicodeError):
        return frozenset()
    addresses = {str(where[0]) for *_, where in found}
    return frozenset("localhost" if is_local(each) else _unwrap_ipv4(each) for each in addresses)


def _unwrap_ipv4(address: str) -> str:
    """Return an address of IPv4 as such, also where IPv6 wraps it."""
    parsed = ip_address(address.partition("%")[0])
    return str(getattr(parsed, "ipv4_mapped", None) or parsed)


def is_local(host: str) -> bool:
    """Tell whether a host is this machine: then a socket can be bound to its address."""
    family = socket.AF_INET6 if ":" in host else socket.AF_INET
    try:
        with socket.socket(family) as probe:
            probe.bind((host, 0))
    except (OSError, UnicodeError):
        return False
    return True
