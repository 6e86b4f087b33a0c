"""What clients of a bridge ask for is answered at any replica, whichever has the guard."""

import pytest
from asked_guard import AskedGuard
from harness import wait_for


@pytest.fixture
def guard_class():
    return AskedGuard


def test_a_person_at_the_other_replica_sees_a_request_and_approves_it_once(guard, ann, car):
    path, ann = f"/robots/{car}/requests", ann[1]

    def requests():
        answer = ann.get(path)
        return answer.json()["requests"] if answer.status_code == 200 else None

    assert "request 1 waits" in guard.ask_person()
    wait_for(lambda: requests() and requests()["count"] == 1, what="the request")
    (request,) = requests()["shown"]
    body = {"do": "approve", "reason": "the corridor is free"}
    answer = ann.post(f"{path}/{request['digest']}", json=body)
    assert answer.status_code == 200, answer.text
    assert answer.json()["reason"].endswith("is approved by ann at the service")
    wait_for(lambda: requests()["count"] == 0, what="no request")
    assert ann.post(f"{path}/{request['digest']}", json=body).status_code == 409
    assert guard.ask_person() == ""
    assert "request 2 waits" in guard.ask_person()
