"""Who is in command of a robot, as the API shows it, and who may say so. No database, no guard.

The bridge has the last word on all of it. No database, no bridge.
"""

from typing import Annotated

from pydantic import BaseModel, Field, StringConstraints, model_validator

from rtron.errors import suggestion
from rtron.service.domain.errors import ConflictError, ForbiddenError, NotFoundError
from rtron.service.domain.principal import Principal, SessionStage, UserRole
from rtron.service.domain.schemas import MIN_REASON_LENGTH, Reason, RequestModel, RequiredReason
from rtron.vocabulary import (
    CommanderRank,
    GuardState,
    LeaseGroup,
    LeaseStatus,
    OpenRequest,
    OpenRequests,
    Plan,
)
from rtron.wire.common.link_protocol import ApprovalAction, LeaseAction

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


_MAX_DETAIL = 2000
"""The longest text that the audit log keeps of a request, characters."""


class RequestsView(BaseModel):
    """The open requests of a robot's bridge; None if no bridge answers its guard.

    `permitted`: the one who asks may answer them.
    """

    requests: OpenRequests | None
    permitted: bool


class RequestAnswer(RequestModel):
    """Whether a client may send once, within a minute, what it has asked for, and why."""

    do: ApprovalAction
    reason: RequiredReason


class RequestOutcome(BaseModel):
    """What the bridge has done."""

    reason: str


def may_answer(caller: Principal, requests: OpenRequests) -> bool:
    """Tell whether the rights of a bridge let a caller answer its requests."""
    is_named = caller.name in requests.names or not caller.roles.isdisjoint(requests.roles)
    return may_command(caller) and is_named


def requests_view(
    requests: OpenRequests | None, caller: Principal, *, is_near: bool
) -> RequestsView:
    """Return what a caller sees of requests; `is_near`: the robot is in a group of the caller."""
    permitted = is_near and requests is not None and may_answer(caller, requests)
    return RequestsView(requests=requests, permitted=permitted)


def check_answer(requests: OpenRequests | None, digest: str, caller: Principal) -> OpenRequest:
    """Return the request of a digest, which the caller may answer.

    NotFoundError if no bridge is there, ForbiddenError if its rights do not let the caller,
    ConflictError if the request does not wait any more.
    """
    if requests is None:
        help = "requests can be answered on the robot: rtron bridge requests"
        raise NotFoundError("no bridge of this robot answers", help=help)
    if not may_answer(caller, requests):
        help = "bridge.yaml says under `approvers` which roles and names may"
        raise ForbiddenError("the rights of the bridge do not let you answer", help=help)
    found = next((each for each in requests.shown if each.digest == digest), None)
    if found is None:
        message = "this request does not wait any more: it is answered, or over"
        raise ConflictError(message, help="look what waits now")
    return found


def seen_detail(request: OpenRequest) -> dict[str, str]:
    """Return what a person has seen, for the audit log; the digest is of all of it."""
    texts = {"client": request.client, "what": request.what, "content": request.content}
    return {name: text[:_MAX_DETAIL].replace("\0", "\ufffd") for name, text in texts.items()}
