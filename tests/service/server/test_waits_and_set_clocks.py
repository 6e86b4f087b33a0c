"""A wall clock that is set, back or forward, changes nothing about who waits how long."""

import pytest
from service_app import PASSWORD, ManualClock
from webhook_receiver import run_receiver

from rtron.service.domain.login_throttle import ADDRESS_BACKOFF

HOUR = 3600
ALARM = {"id": 1, "robot": "car1", "kind": "alarm", "level": "error", "topic": "/scan"}


@pytest.fixture
def monotonic():
    return ManualClock()


@pytest.fixture
def login(client, people):
    people.add_user("mary", "developer")

    def login(password=PASSWORD):
        body = {"name": "mary", "password": password}
        return client.post("/api/v1/login", json=body)

    return login


@pytest.mark.parametrize("hours", [-2, 2])
def test_a_login_waits_for_its_seconds_and_no_longer(login, clock, monotonic, hours):
    for _ in range(ADDRESS_BACKOFF.free_failures):
        assert login("guess").status_code == 401
    clock.sleep(hours * HOUR)
    answer = login()
    assert (answer.status_code, answer.headers["retry-after"]) == (429, "1")
    monotonic.sleep(1)
    assert login().status_code == 200


def test_alarms_and_new_webhooks_are_not_held_back(app, client, admin, clock, monotonic):
    with run_receiver() as receiver:
        url = f"http://127.0.0.1:{receiver.port}/"
        client.post("/api/v1/webhooks", json={"url": url}, headers=admin)

        def alert():
            app.state.service.hub.broadcast({"type": "event", "event": ALARM})
            return receiver.call()[0]

        assert alert() == "/"
        clock.sleep(-2 * HOUR)
        monotonic.sleep(60)
        assert alert() == "/"
        client.post("/api/v1/webhooks", json={"url": url + "second"}, headers=admin)
        monotonic.sleep(60)
        assert {alert(), receiver.call()[0]} == {"/", "/second"}
