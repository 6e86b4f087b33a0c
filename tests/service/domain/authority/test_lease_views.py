"""Who is in command as the API shows it, and what may be asked of whom."""

from dataclasses import replace

import pytest
from leased_base import AGENT, NAV, PLAN, TELEOP, TTL
from pydantic import ValidationError

from rtron.service.domain.authority.leases import LeaseChange, check_lease, lease_views, may_command
from rtron.service.domain.errors import ForbiddenError, NotFoundError
from rtron.service.domain.principal import Principal, SessionStage, UserRole
from rtron.vocabulary import CommanderRank, GuardState, LeaseGroup, LeaseStatus, Mode, StreamState

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
