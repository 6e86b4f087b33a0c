"""What clients of a robot's bridge ask persons for, as the API shows it, and who may answer.

The bridge has the last word on all of it. No database, no bridge.
"""

from pydantic import BaseModel

from rtron.service.domain.authority.leases import may_command
from rtron.service.domain.errors import ConflictError, ForbiddenError, NotFoundError
from rtron.service.domain.principal import Principal
from rtron.service.domain.schemas import RequestModel, RequiredReason
from rtron.vocabulary import OpenRequest, OpenRequests
from rtron.wire.common.link_protocol import ApprovalAction

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
