"""Supervised overrides, requested on the robot: by name, for a time, with a reason."""

import logging
from collections.abc import Mapping, Sequence
from typing import Any

from rtron.errors import WireError
from rtron.guard.coordinator import Coordinator
from rtron.guard.core.override_policy import OverridablePolicy, Override
from rtron.guard.transport.common.protocol import Transport
from rtron.vocabulary import SECOND, visible_text

log = logging.getLogger(__name__)

MAX_DURATION = 3600 * SECOND
_MAX_REASON_LENGTH = 200
_MAX_TEXT_LENGTH = 4096
_CHANNEL = "local"
_KEYS = {"override", "duration", "reason"}


class OverrideCommands:
    """Grants overrides of the RSRCN and the MSRCN."""

    def __init__(self, coordinator: Coordinator, transport: Transport) -> None:
        self._coordinator = coordinator
        self._transport = transport

    def handle(self, user: str, request: Mapping[str, Any]) -> Mapping[str, Any]:
        """Grant the request of `user`: `{"override": id, "duration": ns, "reason": text}`.

        A duration of 0 ends an override.
        """
        if set(request) != _KEYS:
            raise WireError(f"a request has {', '.join(sorted(_KEYS))}")
        policies = self._policies(request["override"])
        duration = _duration(request["duration"])
        reason = read_reason(request["reason"])
        if not reason and duration:
            raise WireError("an override needs a reason")
        self._grant(policies, Override(user, reason, self._transport.now() + duration))
        text = "%s: overridden by %s for %s s: %s"
        log.warning(text, request["override"], user, duration / SECOND, reason)
        return {"granted": request["override"], "duration": duration}

    def _policies(self, id: object) -> Sequence[OverridablePolicy]:
        policies = [
            policy
            for stream in self._coordinator.streams
            for name, policy in stream.override_policies.items()
            if name == id
        ]
        if not policies:
            known_ids = sorted(
                {name for each in self._coordinator.streams for name in each.override_policies}
            )
            raise WireError(f"nothing to override is called {id!r}: choose from {known_ids}")
        return policies

    def _grant(self, policies: Sequence[OverridablePolicy], override: Override) -> None:
        for policy in policies:
            policy.grant(_CHANNEL, override)
        self._transport.call_at(override.until, self._coordinator.recheck)


def _duration(value: object) -> int:
    if not isinstance(value, int) or isinstance(value, bool) or not 0 <= value <= MAX_DURATION:
        raise WireError(f"a duration is a number of nanoseconds, {MAX_DURATION} at most")
    return value


def read_reason(value: object) -> str:
    """Return the reason of a request as a single line, "" for one that nobody can see.

    WireError if it is no text.
    """
    if not isinstance(value, str):
        raise WireError("a reason is a text")
    return visible_text(single_line(value))


def single_line(text: str) -> str:
    """Return a text without unprintable characters, which could forge lines of a log."""
    printable = "".join(each if each.isprintable() else " " for each in text[:_MAX_TEXT_LENGTH])
    return " ".join(printable.split())[:_MAX_REASON_LENGTH]
