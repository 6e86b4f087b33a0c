"""What clients of a bridge ask for is answered at any replica, whichever has the guard."""

import time
from types import SimpleNamespace

import httpx
import pytest
from asked_guard import AskedGuard
from harness import wait_for
from replica_processes import LIMIT_S, create_secret
from service_app import TLS, AccountFactory


@pytest.fixture
def guard(replicas, car):
    """A guard at the first replica."""
    secret = create_secret(replicas.database, car, "guard", robot=car)
    made = AskedGuard(replicas[0].port, {"Authorization": f"Bearer {secret}"})
    yield made
    made.close()


@pytest.fixture
def ann(replicas):
    """A person's browser at the other replica."""
    parts = SimpleNamespace(database=replicas.database, clock=time.time_ns)
    headers = AccountFactory(parts).session_headers("ann", "end_user")
    url = f"{replicas[1].url}/api/v1"
    with httpx.Client(base_url=url, headers=headers, timeout=LIMIT_S, verify=TLS) as client:
        yield client


def test_a_person_at_the_other_replica_sees_a_request_and_approves_it_once(guard, ann, car):
    path = f"/robots/{car}/requests"

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
