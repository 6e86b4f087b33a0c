"""Who may change which robots, and whose rights may be limited to groups."""

import pytest

from rtron.errors import InputError
from rtron.service.domain.errors import ForbiddenError
from rtron.service.domain.principal import (
    AccessScope,
    Principal,
    UserRole,
    check_group_limit,
    check_reach,
    is_within_reach,
)


@pytest.mark.parametrize(
    ("groups", "labels", "reached"),
    [
        (None, [], True),
        (None, ["hall-a"], True),
        ([], ["hall-a"], False),
        (["hall-a"], [], False),
        (["hall-a"], ["hall-b"], False),
        (["hall-a"], ["hall-a2", "HALL-A", "hall"], False),
        (["hall-a"], ["hall-b", "hall-a"], True),
        (["hall-a", "hall-b"], ["hall-b"], True),
    ],
)
def test_one_common_label_is_within_reach(groups, labels, reached):
    caller = Principal(
        name="ann",
        roles=frozenset({UserRole.END_USER}),
        groups=None if groups is None else frozenset(groups),
    )
    assert is_within_reach(groups, labels) is reached
    if reached:
        check_reach(caller, "car1", labels)
        return
    with pytest.raises(ForbiddenError, match="car1 is in no group of ann"):
        check_reach(caller, "car1", labels)


@pytest.mark.parametrize("roles", [[UserRole.ADMIN], [UserRole.ADMIN, UserRole.END_USER]])
def test_an_admin_has_no_groups(roles):
    check_group_limit(None, roles)
    with pytest.raises(InputError, match="an admin manages all groups"):
        check_group_limit(["hall-a"], roles)


@pytest.mark.parametrize("scope", [AccessScope.GUARD, AccessScope.METRICS, AccessScope.READ])
def test_who_changes_nothing_has_no_groups(scope):
    with pytest.raises(InputError, match="takes a role"):
        check_group_limit(["hall-a"], [scope])


@pytest.mark.parametrize("role", [UserRole.DEVELOPER, AccessScope.END_USER])
def test_who_changes_robots_may_have_groups(role):
    check_group_limit(["hall-a"], [role])
