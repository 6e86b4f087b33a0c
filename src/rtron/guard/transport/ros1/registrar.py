"""The master, asked in a thread of its own: what we are is registered, and stays registered.

Every few seconds all registrations are said again; that is how a restarted master learns of us,
how a registration that somebody took back returns, and how a missed update is made good.
"""

import logging
import math
import time
from collections.abc import Callable, Iterable
from concurrent.futures import ThreadPoolExecutor
from functools import partial

from rtron.errors import RTronError, SourceError
from rtron.guard.core.event_loop import Loop
from rtron.guard.transport.ros1.node import Node
from rtron.wire.ros1.xmlrpc import ros_call

log = logging.getLogger(__name__)

_PATIENCE_S = 3.0
_REFRESH_S = 1.0
_EVERY = 5
_SILENT_S = 10.0
_MOST_SAID = 16
_FENCE = "refused by rtron master"
_HELP = "; start `rtron master` first, then the guard: it finds the master behind the fence"


class Registrar:
    """Registers the guard's nodes and keeps their lists of publishers up to date."""

    def __init__(self, loop: Loop, master: str, nodes: Callable[[], Iterable[Node]]) -> None:
        self._loop = loop
        self._master = master
        self._nodes = nodes
        self._thread = ThreadPoolExecutor(1, thread_name_prefix="master")
        self._pid = 0
        self._round = 0
        self._lost = False
        self._until = math.inf
        self._asked: set[tuple[str, str, str]] = set()
        self._refused = _Refused()
        loop.post(self._watch)

    def publish(self, node: Node, topic: str) -> None:
        """Register a publication; without a type it waits until the type is learned."""
        publication = node.publications[topic]
        if publication.type:
            self._ask(node, "registerPublisher", topic, publication.type, _nothing)

    def subscribe(self, node: Node, topic: str) -> None:
        """Register a subscription, or ask again who publishes."""
        subscription = node.subscriptions[topic]

        def update(uris: object) -> None:
            if isinstance(uris, list) and topic in node.subscriptions:
                own = frozenset(each.uri for each in self._nodes())
                subscription.update([str(uri) for uri in uris], own)

        self._ask(node, "registerSubscriber", topic, subscription.type or "*", update)

    def everything(self, node: Node) -> None:
        """Register all that a node has."""
        for topic in list(node.publications):
            self.publish(node, topic)
        for topic in list(node.subscriptions):
            self.subscribe(node, topic)

    def leave(self, node: Node) -> None:
        """Take back all that a node has registered."""
        for method, topics in (
            ("unregisterPublisher", node.publications),
            ("unregisterSubscriber", node.subscriptions),
        ):
            for topic in topics:
                self._thread.submit(self._quietly, method, node.name, topic, node.uri)

    def close(self) -> None:
        """Wait until all that was asked has been said, or the master has had its time."""
        self._until = time.monotonic() + _PATIENCE_S
        self._thread.shutdown(wait=True)

    def _ask(
        self, node: Node, method: str, topic: str, type: str, then: Callable[[object], None]
    ) -> None:
        if (method, node.name, topic) in self._asked:
            return
        self._asked.add((method, node.name, topic))

        def work() -> None:
            self._asked.discard((method, node.name, topic))
            answer = self._quietly(method, node.name, topic, type, node.uri)
            if answer is not None:
                self._loop.post(lambda: then(answer))

        self._thread.submit(work)

    def _quietly(self, method: str, *params: str) -> object:
        left = min(_PATIENCE_S, self._until - time.monotonic())
        if left <= 0:
            return None
        try:
            return ros_call(self._master, method, *params, timeout=left)
        except RTronError as error:
            if _is_refusal(error) and method.startswith("register"):
                self._refused.note(str(error))
            else:
                log.debug("%s", error)
            return None

    def _watch(self) -> None:
        self._thread.submit(self._check).add_done_callback(
            lambda _: self._loop.post(lambda: self._loop.call_later(_REFRESH_S, self._watch))
        )

    def _check(self) -> None:
        pid = self._quietly("getPid", "/rtron_guard")
        self._note(lost=pid is None)
        self._round += 1
        if isinstance(pid, int) and (pid != self._pid or self._round % _EVERY == 0):
            restarted, self._pid = self._pid not in (0, pid), pid
            self._loop.post(partial(self._register_all, restarted=restarted))

    def _register_all(self, *, restarted: bool) -> None:
        for node in self._nodes():
            if restarted:
                for subscription in node.subscriptions.values():
                    subscription.outlive_master()
            self.everything(node)

    def _note(self, *, lost: bool) -> None:
        if lost != self._lost:
            self._lost = lost
            state = "does not answer; connections stay" if lost else "answers again"
            log.warning("the master at %s %s", self._master, state)


class _Refused:
    """The log of what the master refuses: the same once in 10 s, and not too much of it."""

    def __init__(self) -> None:
        self._said: dict[str, float] = {}

    def note(self, why: str) -> None:
        now = time.monotonic()
        self._said = {each: at for each, at in self._said.items() if now - at < _SILENT_S}
        if why in self._said or len(self._said) >= _MOST_SAID:
            return
        self._said[why] = now
        log.error("not registered: %s%s", why, _HELP if _FENCE in why else "")


def _is_refusal(error: RTronError) -> bool:
    """Tell whether the master has answered, and said no."""
    return isinstance(error, SourceError) and error.__cause__ is None


def _nothing(answer: object) -> None:
    """Take an answer that nobody needs."""
    del answer
