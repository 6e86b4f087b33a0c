"""Who is in command of a robot, as the API shows it, and who may say so. No database, no guard."""

from typing import Annotated

from pydantic import BaseModel, Field, StringConstraints, model_validator

from rtron.errors import suggestion
from rtron.service.domain.errors import ForbiddenError, NotFoundError
from rtron.service.domain.principal import Principal
from rtron.service.domain.roles import SessionStage, UserRole
from rtron.service.domain.schemas import MIN_REASON_LENGTH, Reason, RequestModel
from rtron.vocabulary import CommanderRank, GuardState, LeaseGroup, LeaseStatus, Plan
from rtron.wire.common.link_protocol import LeaseAction

COMMANDING_ROLES = frozenset({UserRole.DEVELOPER, UserRole.END_USER})
"""Who has one of these, and is logged in, may say who is in command."""


class CommanderView(BaseModel):
    """Who may hold a lease, and its rank."""

    name: str
    rank: CommanderRank


class LeaseView(BaseModel):
    """A lease of a robot's plan; durations are ns.

    `service` is the rank that persons have here, None if they only look; `permitted`: the one who
    asks is one of them. `status` is what the guard has told of it, None if that is not known.
    """

    name: str
    ttl: int
    topics: list[str]
    commanders: list[CommanderView]
    service: CommanderRank | None
    permitted: bool
    status: LeaseStatus | None


class LeaseChange(RequestModel):
    """What to do with a lease while `grant` holds it, 0 for nobody.

    Give it to the commander `to`, renew what you have given, or end it; all but a renewal takes a
    reason.
    """

    do: LeaseAction
    grant: int = Field(ge=0, le=(1 << 53) - 1)
    to: Annotated[str, StringConstraints(max_length=255)] = ""
    reason: Reason = ""

    @model_validator(mode="after")
    def _is_complete(self) -> "LeaseChange":
        if bool(self.to) is not (self.do == "give"):
            raise ValueError("`to` is whom a lease is given to, and goes with nothing else")
        if self.do != "renew" and len(self.reason) < MIN_REASON_LENGTH:
            raise ValueError(f"say why, in at least {MIN_REASON_LENGTH} characters")
        return self


class LeaseOutcome(BaseModel):
    """What the guard has done, and why."""

    reason: str


def may_command(caller: Principal) -> bool:
    """Tell whether a caller may say who is in command: a person, no program, by the role."""
    is_person = caller.has_stage(SessionStage.COMPLETE)
    return is_person and not caller.roles.isdisjoint(COMMANDING_ROLES)


def check_lease(plan: Plan, name: str) -> None:
    """Raise NotFoundError for a lease that the plan has not, ForbiddenError where people look on.

    The guard checks that again, and the ranks.
    """
    leases = {lease.name: lease for lease in plan.leases}
    lease = leases.get(name)
    if lease is None:
        hint = suggestion(name, sorted(leases)) if leases else "the plan has none"
        raise NotFoundError(f"no lease is called {name[:80]}", help=hint)
    if lease.service is None:
        message = f"the plan lets nobody at the service say who holds {name}"
        raise ForbiddenError(message, help="say `service: RANK` at the lease in the plan")


def lease_views(plan: Plan, state: GuardState | None, *, permitted: bool) -> list[LeaseView]:
    """Return the leases of a plan, in its order, with what the guard has told of them last."""
    streams = state.streams if state else ()
    statuses = {each.lease_status.name: each.lease_status for each in streams if each.lease_status}
    return [
        LeaseView(
            name=lease.name,
            ttl=lease.ttl,
            topics=[grcn.topic for grcn in plan.grcn if grcn.lease == lease.name],
            commanders=_commanders(plan, lease),
            service=lease.service,
            permitted=permitted and lease.service is not None,
            status=statuses.get(lease.name),
        )
        for lease in plan.leases
    ]


def _commanders(plan: Plan, lease: LeaseGroup) -> list[CommanderView]:
    """Return who may hold a lease, the highest rank first."""
    flows = [flow for grcn in plan.grcn if grcn.lease == lease.name for flow in grcn.flows]
    ranks = {flow.publisher: flow.rank for flow in flows}
    order = tuple(CommanderRank)
    names = sorted(ranks, key=lambda name: order.index(ranks[name]))
    return [CommanderView(name=name, rank=ranks[name]) for name in names]
