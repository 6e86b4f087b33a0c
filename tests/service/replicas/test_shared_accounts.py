"""Logins, sessions and tokens hold, or end, at every replica."""

import httpx
import pytest
from websockets.exceptions import ConnectionClosed

from rtron.cli.main import main
from rtron.service.collector.close_codes import CloseCode
from rtron.service.domain.login_throttle import ADDRESS_BACKOFF

PASSWORD = "correct horse battery"


@pytest.fixture
def mary(people, car):
    """Give a user who may do everything."""
    name = f"mary.{car}"
    new = {"name": name, "password": PASSWORD, "roles": ["admin", "end_user"]}
    assert people[0].ask("/users", "POST", **new).status_code == 201
    return name


@pytest.fixture
def browser():
    with httpx.Client(timeout=60) as client:
        yield client


def log_in(browser, replica, name, password=PASSWORD):
    return browser.post(f"{replica.url}/api/v1/login", json={"name": name, "password": password})


def test_a_session_is_one_at_every_replica(replicas, browser, mary):
    first, second = (f"{each.url}/api/v1" for each in replicas)
    csrf = {"X-CSRF-Token": log_in(browser, replicas[0], mary).json()["csrf"]}
    assert browser.get(f"{second}/me").json()["name"] == mary
    assert browser.post(f"{second}/logout", headers=csrf).status_code == 204
    assert browser.get(f"{first}/me").status_code == 401


def test_failures_at_one_replica_make_the_guesser_wait_at_the_other(replicas, browser, mary):
    for _ in range(ADDRESS_BACKOFF.free_failures):
        assert log_in(browser, replicas[0], mary, "wrong").status_code == 401
    answers = [log_in(browser, replicas[1], mary, "wrong").status_code for _ in range(3)]
    assert 429 in answers


def test_a_revocation_at_one_replica_ends_connections_to_the_other(
    replicas, people, connect_guard, car
):
    guard = connect_guard(replicas, 0, car)
    assert people[1].ask(f"/tokens/{car}", "DELETE").status_code == 204
    assert guard.close_code() == CloseCode.NO_TOKEN
    with pytest.raises(ConnectionClosed):
        guard.store_events("run", [1])


def test_a_revocation_by_the_command_reaches_every_replica(
    replicas, connect_guard, car, monkeypatch
):
    guard = connect_guard(replicas, 1, car)
    monkeypatch.setattr("sys.argv", ["rtron", "token", "revoke", car, "--database", replicas.url])
    with pytest.raises(SystemExit, match="0"):
        main()
    assert guard.close_code() == CloseCode.NO_TOKEN
