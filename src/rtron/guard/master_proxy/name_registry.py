"""Who stands under which name: a name that the plan names is not taken from a node that lives.

rosmaster shuts a node down when another registers under its name, and so it does when a name moves
away from an address (rosmaster/registrations.py). All questions are asked in threads of their own.
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
from rtron.guard.core.event_loop import Loop
from rtron.guard.master_proxy.access_rules import ROSOUT, is_guards
from rtron.vocabulary import GUARD_NODE, SUPERVISOR_NODE, PlannedTopic
from rtron.vocabulary.names import names_node
from rtron.vocabulary.topic_access import ANYBODY
from rtron.wire.ros1.xmlrpc import ros_call, split_uri

log = logging.getLogger(__name__)

CALLER = "/rtron_master"
UNJUDGED = "whether it may could not be found out"
_PATIENCE_S = 1.0
_NEW_S = 5.0
"""How long a node that registers may take to answer, seconds: a robot that starts is busy."""
_WORKERS = 64
_MOST_ASKED = 16
_MOST_STANDS = 1 << 14
_REFRESH_S = 2.0

Then = Callable[[str], None]


@dataclass(frozen=True, slots=True, kw_only=True)
class Stand:
    """Where a node was when it registered: its slave API's address, and its process."""

    name: str
    uri: str
    host: str
    port: int
    pid: int


class Standing:
    """The addresses of the nodes that the plan names, and of the guard's."""

    def __init__(self, loop: Loop, topics: Sequence[PlannedTopic], private: str) -> None:
        self._loop = loop
        self._private = private
        named = {name for each in topics for name in (*each.publishers, *each.subscribers)}
        guards = {GUARD_NODE, SUPERVISOR_NODE} if topics else set()
        self._guards = sorted(guards.union(filter(is_guards, named)))
        self._named = sorted((named | {ROSOUT}) - {ANYBODY, *self._guards}) if topics else []
        self._stands: dict[str, Stand] = {}
        self._asked: Counter[str] = Counter()
        self._waiting: dict[tuple[str, str], list[Then]] = {}
        self._workers = ThreadPoolExecutor(_WORKERS, thread_name_prefix="standing")
        if self._guards:
            loop.post(self._refresh)

    def close(self) -> None:
        """Ask no more."""
        self._workers.shutdown(wait=False, cancel_futures=True)

    def admit(self, name: str, uri: str, then: Then) -> None:
        """Find out whether `name` may register at `uri`; `then` gets why not, or nothing."""
        others = [s for s in self._stands.values() if s.port == split_uri(uri)[1]]
        others = [stand for stand in others if stand.name != name]
        key = next((each for each in self._named if names_node(each, name)), "")
        before = self._stands.get(name)
        if not others and (not key or (before and before.uri == uri)):
            then("")
        elif waiting := self._waiting.get((name, uri)):
            waiting.append(then)  # a node registers many topics at once
        elif self._asked[key] >= _MOST_ASKED:
            then(f"too many ask for the name {name} at once")
        else:
            self._asked[key] += 1
            self._waiting[name, uri] = [then]
            work = partial(_examine, name, uri, before if key else None, others, lives=bool(key))
            self._ask(work, partial(self._examined, key, (name, uri), before))

    def _examined(
        self, key: str, who: tuple[str, str], before: Stand | None, found: Stand | str
    ) -> None:
        self._asked[key] -= 1
        why = found if isinstance(found, str) else self._settle(key, before, found)
        for then in self._waiting.pop(who):
            then(why)

    def _settle(self, key: str, before: Stand | None, found: Stand) -> str:
        """Let a node stand where it was found, unless another was faster."""
        now = self._stands.get(found.name)
        if now is not before and now is not None and now.uri != found.uri:
            return f"{found.name} has just registered at another address"
        if now is None and key != found.name and len(self._stands) >= _MOST_STANDS:
            return f"too many nodes have stood under names like {key}"
        if key:
            self._stands[found.name] = found
        return ""

    def _refresh(self) -> None:
        """Learn where the guard's nodes are: they do not register through the fence."""

        def done(stands: Sequence[Stand]) -> None:
            kept = {n: stand for n, stand in self._stands.items() if not is_guards(n)}
            self._stands = kept | {stand.name: stand for stand in stands}
            self._loop.call_later(_REFRESH_S, self._refresh)

        self._ask(lambda: [s for node in self._guards for s in _at(self._private, node)], done, [])

    def _ask(
        self, work: Callable[[], object], done: Callable[..., None], failed: object = UNJUDGED
    ) -> None:
        """Do `work` in a thread and give its result to `done` in the loop's."""

        def ask() -> None:
            found = failed
            try:
                found = work()
            except Exception:
                log.exception("internal error while asking a node")
            self._loop.post(partial(done, found))

        self._workers.submit(ask)


def _examine(
    name: str, uri: str, before: Stand | None, others: Sequence[Stand], *, lives: bool
) -> Stand | str:
    """Return where a node stands, or why it may not; one that is not named need not answer."""
    host, port = split_uri(uri)
    addresses = _resolved(host)
    if not addresses:
        return f"{host[:80]!r} does not resolve to an address"
    for other in others:
        if addresses & _resolved(other.host) and _still_there(other):
            return f"{uri[:80]!r} is the address of {other.name}, not of {name}"
    if before and before.uri != uri and _still_there(before):
        return f"{name} already stands at another address and still answers there"
    pid = _pid(uri, _NEW_S) if lives else 0
    if pid is None:
        return f"{name} does not answer at {uri[:80]!r}"
    return Stand(name=name, uri=uri, host=host, port=port, pid=pid)


def _still_there(stand: Stand) -> bool:
    """Tell whether a node still lives; one of this machine that hangs has not gone."""
    try:
        return bool(ros_call(stand.uri, "getPid", CALLER, timeout=_PATIENCE_S) == stand.pid)
    except SourceError as error:
        hangs = isinstance(error.__cause__, TimeoutError)
        return hangs and is_local(stand.host)
    except RTronError:
        return False


def _pid(uri: str, timeout: float) -> int | None:
    try:
        pid = ros_call(uri, "getPid", CALLER, timeout=timeout)
    except RTronError:
        return None
    return pid if isinstance(pid, int) else None


def _at(private: str, node: str) -> list[Stand]:
    """Ask the private master where a node is; nothing if there is none that answers."""
    try:
        uri = ros_call(private, "lookupNode", CALLER, node, timeout=_PATIENCE_S)
        host, port = split_uri(uri)
    except (SourceError, WireError):
        return []
    pid = _pid(uri, _PATIENCE_S)
    return [] if pid is None else [Stand(name=node, uri=uri, host=host, port=port, pid=pid)]


def _resolved(host: str) -> frozenset[str]:
    """Return a host's addresses, all of this machine's as one; none if it does not resolve."""
    try:
        found = socket.getaddrinfo(host, None, type=socket.SOCK_STREAM)
    except (OSError, UnicodeError):
        return frozenset()
    addresses = {str(where[0]) for *_, where in found}
    return frozenset("localhost" if is_local(each) else _plain(each) for each in addresses)


def _plain(address: str) -> str:
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
