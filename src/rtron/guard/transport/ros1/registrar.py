"""Registration at the master, in a thread of its own.

All registrations are repeated every few seconds. So a restarted master learns of our nodes, a
registration that somebody has removed returns, and a missed update is made up for.
"""

import logging
import math
import time
from collections.abc import Callable, Iterable
from concurrent.futures import ThreadPoolExecutor
from functools import partial

from rtron.errors import RTronError, SourceError
from rtron.guard.core.event_loop import EventLoop
from rtron.guard.transport.ros1.node import Ros1Node
from rtron.wire.ros1.network import HOST_NETWORK, Network
from rtron.wire.ros1.xmlrpc import ros_call

log = logging.getLogger(__name__)

_TIMEOUT_S = 3.0
_REFRESH_S = 1.0
_REGISTER_EVERY = 5
_LOG_PERIOD_S = 10.0
_MAX_LOGGED = 16
_FENCE = "refused by rtron master"
_HELP = "; start `rtron master` first, then the guard: it finds the master behind its proxy"


class Registrar:
    """Registers the guard's nodes and keeps their lists of publishers up to date."""

    def __init__(
        self,
        loop: EventLoop,
        master: str,
        nodes: Callable[[], Iterable[Ros1Node]],
        network: Network = HOST_NETWORK,
    ) -> None:
        self._loop = loop
        self._master = master
        self._network = network
        self._nodes = nodes
        self._thread = ThreadPoolExecutor(1, thread_name_prefix="master")
        self._pid = 0
        self._round = 0
        self._is_master_lost = False
        self._is_abandoned = False
        self._deadline = math.inf
        self._pending_calls: set[tuple[str, str, str]] = set()
        self._refusal_log = _RefusalLog()
        loop.post(self._schedule_check)

    def publish(self, node: Ros1Node, topic: str) -> None:
        """Register a publication; without a type it waits until the type is learned."""
        publication = node.publications[topic]
        if publication.type:
            self._call_soon(node, "registerPublisher", topic, publication.type, _ignore_answer)

    def subscribe(self, node: Ros1Node, topic: str) -> None:
        """Register a subscription, or ask again who publishes."""
        subscription = node.subscriptions[topic]

        def update(uris: object) -> None:
            if isinstance(uris, list) and topic in node.subscriptions:
                own_uris = frozenset(each.uri for each in self._nodes())
                subscription.update([str(uri) for uri in uris], own_uris)

        self._call_soon(node, "registerSubscriber", topic, subscription.type or "*", update)

    def register_all(self, node: Ros1Node) -> None:
        """Register all that a node has."""
        for topic in list(node.publications):
            self.publish(node, topic)
        for topic in list(node.subscriptions):
            self.subscribe(node, topic)

    def unpublish(self, node: Ros1Node, topic: str) -> None:
        """Unregister a publication."""
        self._thread.submit(self._call, "unregisterPublisher", node.name, topic, node.uri)

    def unsubscribe(self, node: Ros1Node, topic: str) -> None:
        """Unregister a subscription."""
        self._thread.submit(self._call, "unregisterSubscriber", node.name, topic, node.uri)

    def unregister_all(self, node: Ros1Node) -> None:
        """Unregister all that a node has."""
        for topic in node.publications:
            self.unpublish(node, topic)
        for topic in node.subscriptions:
            self.unsubscribe(node, topic)

    def abandon(self) -> None:
        """Wait for no answer: the master is gone."""
        self._is_abandoned = True
        self._deadline = 0.0
        self._thread.shutdown(wait=False, cancel_futures=True)

    def close(self, *, wait: bool = True) -> None:
        """Begin no more calls; wait until all are answered, at most as long as one may take."""
        self._is_abandoned = True
        self._deadline = time.monotonic() + _TIMEOUT_S
        self._thread.shutdown(wait=wait)

    def _call_soon(
        self,
        node: Ros1Node,
        method: str,
        topic: str,
        type: str,
        on_answer: Callable[[object], None],
    ) -> None:
        if self._is_abandoned or (method, node.name, topic) in self._pending_calls:
            return
        self._pending_calls.add((method, node.name, topic))

        def work() -> None:
            self._pending_calls.discard((method, node.name, topic))
            answer = self._call(method, node.name, topic, type, node.uri)
            if answer is not None:
                self._loop.post(lambda: on_answer(answer))

        self._thread.submit(work)

    def _call(self, method: str, *params: str) -> object:
        timeout = min(_TIMEOUT_S, self._deadline - time.monotonic())
        if timeout <= 0:
            return None
        try:
            return ros_call(self._master, method, *params, timeout=timeout, network=self._network)
        except RTronError as error:
            if _is_refusal(error) and method.startswith("register"):
                self._refusal_log.log_once(str(error))
            else:
                log.debug("%s", error)
            return None

    def _schedule_check(self) -> None:
        if self._is_abandoned:
            return
        self._thread.submit(self._check_master).add_done_callback(
            lambda _: self._loop.post(
                lambda: self._loop.call_later(_REFRESH_S, self._schedule_check)
            )
        )

    def _check_master(self) -> None:
        pid = self._call("getPid", "/rtron_guard")
        self._log_availability(is_lost=pid is None)
        self._round += 1
        if isinstance(pid, int) and (pid != self._pid or self._round % _REGISTER_EVERY == 0):
            restarted, self._pid = self._pid not in (0, pid), pid
            self._loop.post(partial(self._register_all, is_restarted=restarted))

    def _register_all(self, *, is_restarted: bool) -> None:
        for node in self._nodes():
            if is_restarted:
                for subscription in node.subscriptions.values():
                    subscription.keep_working_links()
            self.register_all(node)

    def _log_availability(self, *, is_lost: bool) -> None:
        if is_lost != self._is_master_lost:
            self._is_master_lost = is_lost
            state = "does not answer; connections stay" if is_lost else "answers again"
            log.warning("the master at %s %s", self._master, state)


class _RefusalLog:
    """The log of the master's refusals: each once in 10 s, and a bounded number of them."""

    def __init__(self) -> None:
        self._logged_at: dict[str, float] = {}

    def log_once(self, reason: str) -> None:
        now = time.monotonic()
        self._logged_at = {
            each: at for each, at in self._logged_at.items() if now - at < _LOG_PERIOD_S
        }
        if reason in self._logged_at or len(self._logged_at) >= _MAX_LOGGED:
            return
        self._logged_at[reason] = now
        log.error("not registered: %s%s", reason, _HELP if _FENCE in reason else "")


def _is_refusal(error: RTronError) -> bool:
    """Return whether the master has answered with a refusal."""
    return isinstance(error, SourceError) and error.__cause__ is None


def _ignore_answer(answer: object) -> None:
    """Do nothing with an answer."""
    del answer
