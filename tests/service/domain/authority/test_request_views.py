"""Open requests as the API shows them, and who may answer: the service asks before the bridge."""

import pytest
from pydantic import ValidationError

from rtron.service.domain.authority.leases import (
    RequestAnswer,
    check_answer,
    may_answer,
    requests_view,
    seen_detail,
)
from rtron.service.domain.errors import ConflictError, ForbiddenError, NotFoundError
from rtron.service.domain.principal import Principal, SessionStage, UserRole
from rtron.vocabulary import OpenRequest, OpenRequests

DIGEST = "a" * 64
REQUEST = OpenRequest(
    number=3, digest=DIGEST, client="assistant", what="publish /goal", content="{}", until=9
)
REQUESTS = OpenRequests(count=1, shown=(REQUEST,), roles=("end_user",), names=("dora",))


def person(name="ann", *roles, session="s", stage=SessionStage.COMPLETE):
    names = frozenset(map(UserRole, roles))
    return Principal(name=name, roles=names, session=session, stage=stage)


@pytest.mark.parametrize(
    ("caller", "may"),
    [
        (person("ann", "end_user"), True),
        (person("ann", "admin", "end_user"), True),
        (person("dora", "developer"), True),
        (person("ann", "developer"), False),
        (person("ann", "admin"), False),
        (person("dora", "admin"), False),
        (person("dora"), False),
        (person("ann", "end_user", session=""), False),
        (person("dora", "developer", session=""), False),
        (person("ann", "end_user", stage=SessionStage.CODE), False),
    ],
)
def test_a_person_who_commands_and_whom_the_bridge_names_may_answer(caller, may):
    assert may_answer(caller, REQUESTS) is may
    assert requests_view(REQUESTS, caller, is_near=True).permitted is may
    assert not requests_view(REQUESTS, caller, is_near=False).permitted
    assert not may_answer(caller, OpenRequests())


def test_without_a_bridge_nothing_is_known_and_nobody_may():
    view = requests_view(None, person("ann", "end_user"), is_near=True)
    assert (view.requests, view.permitted) == (None, False)


def test_what_is_answered_is_what_waits_and_what_the_caller_may():
    ann = person("ann", "end_user")
    assert check_answer(REQUESTS, DIGEST, ann) is REQUEST
    with pytest.raises(ConflictError, match="does not wait any more"):
        check_answer(REQUESTS, "b" * 64, ann)
    with pytest.raises(ForbiddenError, match="do not let you"):
        check_answer(REQUESTS, DIGEST, person("bob", "developer"))
    with pytest.raises(NotFoundError, match="no bridge"):
        check_answer(None, DIGEST, ann)


@pytest.mark.parametrize(
    "body",
    [
        {},
        {"do": "approve"},
        {"do": "approve", "reason": " \u200b "},
        {"do": "approve", "reason": "ok"},
        {"do": "grant", "reason": "it is free"},
        {"do": "approve", "reason": "it is free", "by": "dora"},
        {"do": "approve", "reason": "it is free", "roles": ["end_user"]},
        {"do": "approve", "reason": "x" * 201},
    ],
)
def test_an_answer_has_a_reason_and_nothing_of_who_gives_it(body):
    with pytest.raises(ValidationError):
        RequestAnswer(**body)


def test_the_log_keeps_what_was_seen_within_bounds():
    long = OpenRequest(
        number=1, digest=DIGEST, client="c", what="w", content="a\0" + "x" * 5000, until=0
    )
    detail = seen_detail(long)
    assert detail == {"client": "c", "what": "w", "content": "a\ufffd" + "x" * 1998}
