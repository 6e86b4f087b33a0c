"""Supervised overrides: asked for by name, for a time, with a reason; told in the log, and over."""

import logging
from collections.abc import Mapping, Sequence
from typing import Any

from rtron.errors import WireError
from rtron.guard.core.coordinator import Host
from rtron.guard.core.override_policy import Overridable, Override
from rtron.guard.transport.common.protocol import Transport
from rtron.vocabulary import SECOND

log = logging.getLogger(__name__)

LONGEST = 3600 * SECOND
_LONGEST_REASON = 200
_LONGEST_READ = 4096
_WAY = "local"
_KEYS = {"override", "duration", "reason"}


class Overriding:
    """Grants overrides of the RSRCN and the MSRCN, and ends them in time."""

    def __init__(self, host: Host, transport: Transport) -> None:
        self._host = host
        self._transport = transport

    def answer(self, who: str, request: Mapping[str, Any]) -> Mapping[str, Any]:
        """Grant what `who` asks for: `{"override": id, "duration": ns, "reason": text}`.

        A duration of 0 ends an override.
        """
        if set(request) != _KEYS:
            raise WireError(f"a request has {', '.join(sorted(_KEYS))}")
        policies = self._policies(request["override"])
        duration = _duration(request["duration"])
        reason = _reason(request["reason"])
        if not reason and duration:
            raise WireError("an override needs a reason")
        self._grant(policies, Override(who, reason, self._transport.now() + duration))
        told = "%s: overridden by %s for %s s: %s"
        log.warning(told, request["override"], who, duration / SECOND, reason)
        return {"granted": request["override"], "duration": duration}

    def _policies(self, id: object) -> Sequence[Overridable]:
        found = [
            policy
            for guarded in self._host.guarded
            for name, policy in guarded.overridable.items()
            if name == id
        ]
        if not found:
            known = sorted({name for each in self._host.guarded for name in each.overridable})
            raise WireError(f"nothing to override is called {id!r}: choose from {known}")
        return found

    def _grant(self, policies: Sequence[Overridable], override: Override) -> None:
        for policy in policies:
            policy.grant(_WAY, override)
        self._transport.call_at(override.until, self._host.attend)


def _duration(value: object) -> int:
    if not isinstance(value, int) or isinstance(value, bool) or not 0 <= value <= LONGEST:
        raise WireError(f"a duration is a number of nanoseconds, {LONGEST} at most")
    return value


def _reason(value: object) -> str:
    if not isinstance(value, str):
        raise WireError("a reason is a text")
    return on_one_line(value)


def on_one_line(text: str) -> str:
    """Return what can be printed of a text: the rest could forge lines of a log."""
    printable = "".join(each if each.isprintable() else " " for each in text[:_LONGEST_READ])
    return " ".join(printable.split())[:_LONGEST_REASON]
