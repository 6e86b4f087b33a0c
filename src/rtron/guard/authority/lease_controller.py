"""The leases of a guard: what happens when one changes hands, is renewed, or ends by itself."""

import logging
from collections.abc import Callable, Mapping
from functools import partial

from rtron.guard.coordinator import Coordinator
from rtron.guard.core.lease_text import lease_values
from rtron.guard.core.log_throttle import LogThrottle
from rtron.guard.transport.common.protocol import Transport
from rtron.policies.authority.command_lease import CommandLease, LeaseAnswer

log = logging.getLogger(__name__)

AskLease = Callable[[CommandLease, int], LeaseAnswer]
"""Asks a lease for something, at a time (ns)."""


class LeaseController:
    """Carries out requests, and stops the robot when whoever moves it has lost the lease."""

    def __init__(self, coordinator: Coordinator, transport: Transport) -> None:
        self.leases: Mapping[str, CommandLease] = coordinator.observations.leases
        self.change_listeners: list[Callable[[CommandLease, str], None]] = []
        """Called when a lease has another grant, or none, with a text that says why."""
        self._coordinator = coordinator
        self._transport = transport
        self._log_throttle = LogThrottle()
        self._last_holders: dict[str, tuple[str, int] | None] = dict.fromkeys(self.leases)
        self._timers: set[str] = set()

    def request(self, name: str, what: str, ask: AskLease) -> LeaseAnswer:
        """Ask a lease for something; `what` says in the log who has asked for what."""
        lease, now = self.leases[name], self._transport.now()
        answer = ask(lease, now)
        self._coordinator.on_lease_answer(name, what, answer)
        if not answer.granted and self._log_throttle.allows((name, what), now):
            log.warning("lease %s: %s is refused: %s", name, what, answer.reason)
        self._update(lease, now, f"{what}: {answer.reason}")
        return answer

    def describe(self, name: str) -> dict[str, object]:
        """Return who holds a lease, since when and why, for programs."""
        return lease_values(self.leases[name], self._transport.now())

    def _update(self, lease: CommandLease, now: int, why: str) -> None:
        """Put a change of a lease into effect; look again when it would end."""
        holder, grant = _holder(lease, now), lease.grant(now)
        if holder != self._last_holders[lease.name]:
            log.warning("lease %s: %s", lease.name, why)
            self._last_holders[lease.name] = holder
            self._recheck(lease, now)
            for listener in self.change_listeners:
                listener(lease, why)
        if grant is not None and lease.name not in self._timers:
            self._timers.add(lease.name)
            self._transport.call_at(grant.expires_at, partial(self._on_deadline, lease))

    def _recheck(self, lease: CommandLease, now: int) -> None:
        for stream in self._coordinator.streams:
            if stream.lease is lease:
                stream.recheck_lease(now)

    def _on_deadline(self, lease: CommandLease) -> None:
        self._timers.discard(lease.name)
        now = self._transport.now()
        self._update(lease, now, f"{lease.status(now)}, it was not renewed")


def _holder(lease: CommandLease, now: int) -> tuple[str, int] | None:
    """Return who holds a lease, and since when (ns)."""
    grant = lease.grant(now)
    return (grant.holder.name, grant.since) if grant else None
