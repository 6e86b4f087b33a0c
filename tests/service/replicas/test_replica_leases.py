"""Who is in command of a robot is said at any replica, whichever has its guard."""

import pytest
from harness import wait_for
from leased_base import AGENT, NAV, TELEOP
from leased_guard import LeasedGuard


@pytest.fixture
def guard_class():
    return LeasedGuard


def holder(client, car):
    """Return who is in command, None while this replica does not know."""
    answer = client.get(f"/robots/{car}/leases")
    status = answer.json()[0]["status"] if answer.status_code == 200 else None
    return status and status["holder"]


def give(client, car, guard, to):
    body = {"do": "give", "to": to, "grant": guard.held().grant, "reason": "a trial"}
    return client.post(f"/robots/{car}/leases/base", json=body)


def test_a_person_takes_over_at_either_replica_and_both_see_it(guard, ann, car):
    for client in ann:
        wait_for(lambda client=client: holder(client, car) == "", what="the state")
    for client, to in zip(ann, (NAV, AGENT), strict=True):
        answer = give(client, car, guard, to)
        assert answer.status_code == 200, answer.text
        assert guard.held().holder == to
        for each in ann:
            wait_for(lambda each=each, to=to: holder(each, car) == to, what=to)


def test_a_refusal_and_a_guard_that_is_gone_are_told_at_the_other_replica(guard, ann, car):
    wait_for(lambda: holder(ann[1], car) == "", what="the state")
    answer = give(ann[1], car, guard, TELEOP)
    assert answer.status_code == 409
    assert answer.json()["error"].startswith(
        "/teleop (operator_on_site) has a higher rank than ann"
    )
    guard.close()
    wait_for(lambda: holder(ann[1], car) is None, what="the end of the connection")
    assert give(ann[1], car, guard, NAV).status_code == 503
