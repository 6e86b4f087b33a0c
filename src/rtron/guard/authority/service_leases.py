"""What persons at the security service ask of leases: within the rank that the plan gives them."""

from functools import partial

from rtron.guard.authority.lease_controller import LeaseController
from rtron.guard.link.event_recorder import RecordEvent
from rtron.guard.settings.local_overrides import read_reason, single_line
from rtron.policies.authority.command_lease import CommandLease, LeaseAnswer, Person
from rtron.vocabulary import EventKind
from rtron.wire.common.link_protocol import CommandResponse, LeaseCommand


class ServiceLeases:
    """Carries out their commands, and records for the service who holds what."""

    def __init__(self, controller: LeaseController, record: RecordEvent) -> None:
        """`record` makes events of the guard; each lease that changes hands is one."""
        self._controller = controller
        self._record = record
        controller.change_listeners.append(self._record_change)

    def carry_out(self, command: LeaseCommand) -> CommandResponse:
        """Do what a person asks for, or say why not."""
        lease = self._controller.leases.get(command.lease)
        if lease is None or lease.service is None:
            why = "the plan lets nobody at the service say who holds it"
            answer = LeaseAnswer(granted=False, reason=why)
        else:
            by = Person(single_line(command.by), lease.service)
            ask = partial(_ask, command, by)
            answer = self._controller.request(lease.name, f"{command.do} by {by}", ask)
        return CommandResponse(number=command.number, granted=answer.granted, reason=answer.reason)

    def _record_change(self, lease: CommandLease, why: str) -> None:
        values = self._controller.describe(lease.name)
        holder = str(values["holder"])
        self._record(EventKind.LEASE, publisher=holder, reason=why, values=values)


def _ask(command: LeaseCommand, by: Person, lease: CommandLease, now: int) -> LeaseAnswer:
    grant = lease.grant(now)
    if command.grant != (grant.number if grant else 0):
        why = f"{lease.name} has changed hands meanwhile: {lease.status(now)}"
        return LeaseAnswer(granted=False, reason=why)
    if command.do == "renew":
        return lease.renew_given(by, now)
    reason = read_reason(command.reason)
    if not reason:
        return LeaseAnswer(granted=False, reason=f"to {command.do} a lease needs a reason")
    if command.do == "give":
        return lease.give(single_line(command.to), by, now, reason)
    return lease.end(by, now, reason)
