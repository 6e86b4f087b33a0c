"""What passes in and out of a cell on ROS 1: topics, services, and parameters at the start."""

import logging
from collections.abc import Callable, Iterable
from concurrent.futures import Future, ThreadPoolExecutor
from functools import partial
from typing import Any

from rtron.errors import RTronError
from rtron.guard.cell.access import WATCH
from rtron.guard.cell.ros1.service_relay import ServiceRelay, ServiceSide
from rtron.guard.cell.topic_relay import CellRefusals, TopicRelay, open_published
from rtron.guard.core.event_loop import EventLoop
from rtron.guard.core.printable import printable
from rtron.guard.transport.ros1.celled_transport import (
    CELL_HOST,
    PRIVATE_MASTER,
    PUBLIC_PORT,
    open_ros1_cell,
)
from rtron.guard.transport.ros1.middleware import Ros1Transport
from rtron.vocabulary import GATEWAY_NODE, PRIVATE_ROOT, CarriedTopic, CellManifest
from rtron.wire.ros1.network import HOST_NETWORK, advertised_host
from rtron.wire.ros1.ros_api import parse_system_state
from rtron.wire.ros1.xmlrpc import RefusalError, ros_call

log = logging.getLogger(__name__)

NODE_ENVIRON = {"ROS_MASTER_URI": f"http://{CELL_HOST}:{PUBLIC_PORT}/", "ROS_IP": CELL_HOST}
"""Where the node in a cell finds its master."""
_TIMEOUT_S = 3.0
_LOOK_S = 2.0
_CHANGED = "the cell keeps what it had at the start: start the node again"
_UNLISTED = "the manifest does not list it"


class Ros1Gateway:
    """The node outside that stands for the one in the cell.

    It has the node's name, topics and services; what others ask of it beside them is refused.
    """

    def __init__(self, loop: EventLoop, address: str, manifest: CellManifest) -> None:
        self._loop = loop
        self._address = address
        self._manifest = manifest
        self._refusals = CellRefusals(manifest.node, loop.now)
        self._outside = Ros1Transport(loop, address)
        self._outside.set_shutdown_handler(self._refuse_shutdown)
        self._cell = open_ros1_cell(loop, address, manifest.node, WATCH)
        self._worker = ThreadPoolExecutor(1, thread_name_prefix="cell")
        self._services: list[ServiceRelay] = []
        self._copied: dict[str, Any] = {}
        self._on_ready: Callable[[], None] = lambda: None

    def open(self, on_ready: Callable[[], None]) -> None:
        """Begin to carry; `on_ready` is called when the node can start."""
        self._on_ready = on_ready
        open_published(self._manifest, self._outside, self._cell, self._refusals)
        self._open_subscribed()
        self._cell.apply(self._enter)

    def close(self) -> None:
        """Leave the graph outside; the cell ends by itself."""
        for service in self._services:
            service.close()
        self._worker.shutdown(wait=False, cancel_futures=True)
        self._outside.close()

    def _open_subscribed(self) -> None:
        for topic in self._manifest.subscribed:
            self._cell.apply(partial(self._open_inward, topic))

    def _open_inward(self, topic: CarriedTopic, inside: Ros1Transport) -> None:
        output = inside.advertise(GATEWAY_NODE, topic.topic, topic.type)
        TopicRelay(topic, output, self._refusals).open(self._outside, self._manifest.node)

    def _enter(self, inside: Ros1Transport) -> None:
        """Do what is to be done before the node starts, now that there is a cell."""
        here, there = self._sides(inside)
        for sides, services in (
            ((here, there), self._manifest.served),
            ((there, here), self._manifest.called),
        ):
            self._services += [
                ServiceRelay(self._loop, each, sides, self._refusals) for each in services
            ]
        self._prepare(there)

    def _sides(self, inside: Ros1Transport) -> tuple[ServiceSide, ServiceSide]:
        node = self._manifest.node
        here = ServiceSide(
            master=self._address,
            network=HOST_NETWORK,
            host=advertised_host(),
            node=node,
            node_uri=self._outside.node_uri(node),
        )
        there = ServiceSide(
            master=PRIVATE_MASTER,
            network=inside.network,
            host=CELL_HOST,
            node=GATEWAY_NODE,
            node_uri=inside.node_uri(GATEWAY_NODE),
        )
        return here, there

    def _prepare(self, inside: ServiceSide) -> None:
        work = self._worker.submit(self._copy_parameters, inside)
        work.add_done_callback(lambda done: self._loop.post(partial(self._start, inside, done)))

    def _start(self, inside: ServiceSide, copying: Future[None]) -> None:
        """Start the node, but not without its parameters: defaults may be for another robot."""
        if copying.cancelled():
            return
        if error := copying.exception():
            reason = f"its parameters cannot be copied: {printable(str(error))}"
            self._refusals.report(f"the start of {self._manifest.node}", reason)
            self._loop.call_later(_LOOK_S, partial(self._prepare, inside))
            return
        self._on_ready()
        self._loop.call_later(_LOOK_S, partial(self._look, inside))

    def _copy_parameters(self, inside: ServiceSide) -> None:
        """Copy what the manifest names into the cell, in a thread."""
        for name in self._manifest.parameters:
            value = self._get_outside(name)
            if value is not None:
                _call(inside, "setParam", name, value)
                self._copied[name] = value

    def _get_outside(self, name: str) -> Any:  # noqa: ANN401 - a parameter of any type
        """Return a parameter, None if it is not set."""
        try:
            params = (self._manifest.node, name)
            return ros_call(self._address, "getParam", *params, timeout=_TIMEOUT_S)
        except RefusalError:
            return None

    def _look(self, inside: ServiceSide) -> None:
        """See what the node does that is not carried, and what was changed outside."""
        if self._cell.side:
            self._worker.submit(self._look_in_thread, inside)
            self._loop.call_later(_LOOK_S, partial(self._look, inside))

    def _look_in_thread(self, inside: ServiceSide) -> None:
        try:
            reports = [*self._changed_parameters(), *self._unlisted(inside)]
        except RTronError as error:
            log.debug("%s", error)
            return
        for subject, reason in reports:
            self._loop.post(partial(self._refusals.report, subject, reason))

    def _changed_parameters(self) -> Iterable[tuple[str, str]]:
        for name, value in self._copied.items():
            now = self._get_outside(name)
            if now is not None and now != value:
                self._copied[name] = now
                yield f"a change of {name}", _CHANGED

    def _unlisted(self, inside: ServiceSide) -> Iterable[tuple[str, str]]:
        """Yield the topics and services of the node that nobody carries."""
        state = parse_system_state(_call(inside, "getSystemState"))
        manifest = self._manifest
        carried = {each.topic for each in (*manifest.published, *manifest.subscribed)}
        services = {each.service for each in (*manifest.served, *manifest.called)}
        for pairs, listed in (
            (state.publishers, carried),
            (state.subscribers, carried),
            (state.services, services),
        ):
            for name, node in pairs:
                is_own = name.startswith(PRIVATE_ROOT + "/") or _is_logger(name)
                if node == manifest.node and name not in listed and not is_own:
                    yield printable(name), _UNLISTED

    def _refuse_shutdown(self, node: str, reason: str) -> None:
        self._refusals.report(f"a shutdown of {node}", printable(reason))


def _is_logger(service: str) -> bool:
    return service.endswith(("/get_loggers", "/set_logger_level"))


def _call(side: ServiceSide, method: str, *params: Any) -> Any:  # noqa: ANN401 - XML-RPC
    arguments = (side.node, *params)
    return ros_call(side.master, method, *arguments, timeout=_TIMEOUT_S, network=side.network)
