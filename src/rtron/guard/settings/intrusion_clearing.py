"""What a person may request at the control socket, as to clear an intrusion."""

import logging
from collections.abc import Mapping
from concurrent.futures import Future
from functools import partial
from typing import Any

from rtron.errors import WireError
from rtron.guard.authority.latched_stops import LatchedStops
from rtron.guard.authority.lease_commands import LeaseCommands, StopCommands
from rtron.guard.authority.lease_controller import LeaseController
from rtron.guard.coordinator import Coordinator
from rtron.guard.core.control_socket import RequestHandler, Response
from rtron.guard.settings.local_overrides import OverrideCommands, read_reason
from rtron.guard.transport.common.protocol import Transport

log = logging.getLogger(__name__)

_KEYS = {"clear", "reason"}


class ClearCommands:
    """Clears the streams that intruders have stopped; see `IntrusionLatch`."""

    def __init__(self, coordinator: Coordinator) -> None:
        self._latch = coordinator.intrusions

    def handle(self, user: str, request: Mapping[str, Any]) -> Future[Response]:
        """Handle the request of `user`: `{"clear": topic, "reason": text}`; "" clears all streams.

        Those that may not be cleared stay stopped, and the others are cleared all the same. The
        response is there when the audit has answered.
        """
        if set(request) != _KEYS:
            raise WireError(f"a request has {', '.join(sorted(_KEYS))}")
        reason = read_reason(request["reason"])
        if not reason:
            raise WireError("to clear an intrusion needs a reason")
        by = f"by {user}: {reason}"
        response = _ClearResponse(self._topics(request["clear"]))
        for topic in response.topics:
            self._latch.clear(topic, partial(self._on_answer, response, topic, by))
        return response.future

    def _topics(self, topic: object) -> list[str]:
        stopped = sorted(self._latch.reasons)
        if not stopped:
            raise WireError("no intruder has stopped anything")
        if topic and topic not in stopped:
            raise WireError(f"no intruder has stopped {topic!r}: choose from {stopped}")
        return [str(topic)] if topic else stopped

    def _on_answer(self, response: "_ClearResponse", topic: str, by: str, refusal: str) -> None:
        if refusal:
            log.warning("%s: not cleared %s: %s", topic, by, refusal)
        else:
            log.warning("%s: cleared %s", topic, by)
            self._latch.on_clear(topic, by)
        response.add(topic, refusal)


class _ClearResponse:
    """The response to one request; `future` has it when each of the `topics` has an answer."""

    def __init__(self, topics: list[str]) -> None:
        self.topics = topics
        self.future: Future[Response] = Future()
        self._refusals: dict[str, str] = {}

    def add(self, topic: str, refusal: str) -> None:
        """Take why a topic stays stopped, "" if it does not."""
        self._refusals[topic] = refusal
        if len(self._refusals) < len(self.topics):
            return
        refused = [f"{each} stays stopped: {why}" for each, why in self._refusals.items() if why]
        if refused:
            self.future.set_exception(WireError("; ".join(refused)))
        else:
            self.future.set_result({"cleared": sorted(self._refusals)})


def create_request_handler(
    coordinator: Coordinator, transport: Transport, leases: LeaseController, stops: LatchedStops
) -> RequestHandler:
    """Return what handles every request at the control socket."""
    overrides = OverrideCommands(coordinator, transport)
    stopping = StopCommands(stops)
    commands: Mapping[str, RequestHandler] = {
        "clear": ClearCommands(coordinator).handle,
        "lease": LeaseCommands(leases).handle,
        "stop": stopping.handle,
        "release": stopping.handle,
    }

    def handle(user: str, request: Mapping[str, Any]) -> Response | Future[Response]:
        key = next((key for key in commands if key in request), "")
        return commands.get(key, overrides.handle)(user, request)

    return handle
