"""Who is in command as the API shows it, and what may be asked of whom."""

from dataclasses import replace

import pytest
from leased_base import AGENT, NAV, PLAN, TELEOP, TTL
from pydantic import ValidationError

from rtron.service.domain.authority.leases import (
    LeaseChange,
    RequestAnswer,
    check_answer,
    check_lease,
    lease_views,
    may_answer,
    may_command,
    requests_view,
    seen_detail,
)
from rtron.service.domain.errors import ConflictError, ForbiddenError, NotFoundError
from rtron.service.domain.principal import Principal, SessionStage, UserRole
from rtron.vocabulary import (
    CommanderRank,
    GuardState,
    LeaseGroup,
    LeaseStatus,
    Mode,
    OpenRequest,
    OpenRequests,
    StreamState,
)

REMOTE = CommanderRank.REMOTE_OPERATOR
LEASES = (LeaseGroup(name="base", ttl=TTL, service=REMOTE), LeaseGroup(name="idle"))
SERVED = replace(PLAN, leases=LEASES)


def state(*statuses):
    streams = [
        StreamState(topic=f"/t{n}", nodes=(), mode=Mode.ENFORCE, lease_status=each)
        for n, each in enumerate(statuses)
    ]
    return GuardState(at=1, revision=0, streams=tuple(streams))


def test_each_lease_of_the_plan_is_shown_with_who_may_hold_it_and_who_does():
    held = LeaseStatus(name="base", holder=NAV, rank=CommanderRank.AUTONOMY, grant=3)
    base, idle = lease_views(SERVED, state(None, held, held), permitted=True)
    assert (base.name, base.ttl, base.topics) == ("base", TTL, ["/cmd_vel", "/arm_vel"])
    assert [each.name for each in base.commanders] == [TELEOP, NAV, AGENT]
    assert (base.service, base.permitted, base.status) == (REMOTE, True, held)
    assert (idle.commanders, idle.service, idle.permitted, idle.status) == ([], None, False, None)


def test_what_the_guard_has_not_told_is_not_known():
    assert [each.status for each in lease_views(SERVED, None, permitted=True)] == [None, None]
    assert not lease_views(SERVED, None, permitted=False)[0].permitted


def test_people_may_change_what_the_plan_gives_them_a_rank_for_and_nothing_else():
    check_lease(SERVED, "base")
    with pytest.raises(ForbiddenError, match="the plan lets nobody at the service"):
        check_lease(SERVED, "idle")
    with pytest.raises(NotFoundError) as refused:
        check_lease(SERVED, "bas")
    assert refused.value.help == "did you mean base?"
    with pytest.raises(NotFoundError) as refused:
        check_lease(replace(PLAN, leases=()), "base")
    assert refused.value.help == "the plan has none"


@pytest.mark.parametrize(
    ("roles", "session", "stage", "may"),
    [
        ({"end_user"}, "s", "complete", True),
        ({"developer"}, "s", "complete", True),
        ({"admin", "developer"}, "s", "complete", True),
        ({"admin"}, "s", "complete", False),
        (set(), "s", "complete", False),
        ({"developer", "end_user"}, "", "complete", False),
        ({"developer", "end_user"}, "s", "code", False),
    ],
)
def test_only_a_person_who_is_logged_in_and_has_the_role_may(roles, session, stage, may):
    names = frozenset(map(UserRole, roles))
    caller = Principal(name="ann", roles=names, session=session, stage=SessionStage(stage))
    assert may_command(caller) is may


@pytest.mark.parametrize(
    "body",
    [
        {"do": "give", "grant": 0, "to": NAV, "reason": "a trial"},
        {"do": "end", "grant": 1, "reason": "a trial"},
        {"do": "renew", "grant": 1},
    ],
)
def test_what_may_be_asked(body):
    assert LeaseChange(**body).do == body["do"]


@pytest.mark.parametrize(
    "body",
    [
        {"do": "give", "grant": 0, "reason": "a trial"},
        {"do": "give", "grant": 0, "to": NAV},
        {"do": "give", "grant": 0, "to": NAV, "reason": " \u200b\u2800 "},
        {"do": "give", "grant": -1, "to": NAV, "reason": "a trial"},
        {"do": "give", "to": NAV, "reason": "a trial"},
        {"do": "give", "grant": 0, "to": "/" + "x" * 255, "reason": "a trial"},
        {"do": "end", "grant": 1},
        {"do": "end", "grant": 1, "to": NAV, "reason": "a trial"},
        {"do": "renew", "grant": 1, "to": NAV},
        {"do": "acquire", "grant": 1, "reason": "a trial"},
        {"do": "renew", "grant": 1, "rank": "emergency"},
    ],
)
def test_what_is_not_asked_for_whole_is_refused(body):
    with pytest.raises(ValidationError):
        LeaseChange(**body)


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
