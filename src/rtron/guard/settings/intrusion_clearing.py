"""Requests of a person at the control socket: overrides, and the end of an intrusion's stop."""

import logging
from collections.abc import Mapping
from typing import Any

from rtron.errors import WireError
from rtron.guard.coordinator import Coordinator
from rtron.guard.core.control_socket import RequestHandler
from rtron.guard.settings.local_overrides import OverrideCommands, read_reason
from rtron.guard.transport.common.protocol import Transport

log = logging.getLogger(__name__)

_KEYS = {"clear", "reason"}


class ClearCommands:
    """Clears the streams that intruders have stopped; see `IntrusionLatch`."""

    def __init__(self, coordinator: Coordinator) -> None:
        self._latch = coordinator.intrusions

    def handle(self, user: str, request: Mapping[str, Any]) -> Mapping[str, Any]:
        """Handle the request of `user`: `{"clear": topic, "reason": text}`; "" clears all streams.

        Those that may not be cleared stay stopped, and the others are cleared all the same.
        """
        if set(request) != _KEYS:
            raise WireError(f"a request has {', '.join(sorted(_KEYS))}")
        reason = read_reason(request["reason"])
        if not reason:
            raise WireError("to clear an intrusion needs a reason")
        by = f"by {user}: {reason}"
        refusals = {topic: self._clear(topic, by) for topic in self._topics(request["clear"])}
        refused = [f"{topic} stays stopped: {why}" for topic, why in refusals.items() if why]
        if refused:
            raise WireError("; ".join(refused))
        return {"cleared": sorted(refusals)}

    def _topics(self, topic: object) -> list[str]:
        stopped = sorted(self._latch.reasons)
        if not stopped:
            raise WireError("no intruder has stopped anything")
        if topic and topic not in stopped:
            raise WireError(f"no intruder has stopped {topic!r}: choose from {stopped}")
        return [str(topic)] if topic else stopped

    def _clear(self, topic: str, by: str) -> str:
        refusal = self._latch.clear(topic)
        if refusal:
            log.warning("%s: not cleared %s: %s", topic, by, refusal)
        else:
            log.warning("%s: cleared %s", topic, by)
            self._latch.on_clear(topic, by)
        return refusal


def create_request_handler(coordinator: Coordinator, transport: Transport) -> RequestHandler:
    """Return what handles every request at the control socket."""
    overrides, clearing = OverrideCommands(coordinator, transport), ClearCommands(coordinator)
    return lambda user, request: (clearing if "clear" in request else overrides).handle(
        user, request
    )
