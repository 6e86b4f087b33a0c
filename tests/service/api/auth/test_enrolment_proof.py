"""Who has stolen a session enrols no second factor: it takes the password again."""

import pytest
from service_app import PASSWORD

from rtron.service.domain.login_throttle import ADDRESS_BACKOFF
from rtron.service.domain.one_time_codes import code_at, step_at

FACTOR = "/api/v1/me/second-factor"


@pytest.fixture
def stolen(people):
    """The headers of mary's session, as whoever has stolen it sends them."""
    people.add_user("mary", "developer")
    return people.session_headers("mary")


def enrol(client, headers, body):
    answer = client.post(FACTOR, json=body, headers=headers)
    return answer.status_code, answer.json().get("error")


def test_the_service_says_what_it_takes(client, stolen):
    view = client.get(FACTOR, headers=stolen).json()
    assert view == {"is_enrolled": False, "recovery_codes": 0, "proof": "password"}


@pytest.mark.parametrize(
    ("body", "answer"),
    [
        ({}, (422, "the password is missing")),
        ({"password": ""}, (422, "the password is missing")),
        ({"password": "correct horse batter"}, (403, "the password is wrong")),
        ({"password": "no hash"}, (403, "the password is wrong")),
    ],
)
def test_a_session_without_the_password_gets_no_key(client, clock, stolen, audit, body, answer):
    assert enrol(client, stolen, body) == answer
    code = {"code": code_at("A" * 32, step_at(clock.now))}
    begun = client.post(f"{FACTOR}/confirmation", json=code, headers=stolen)
    assert begun.status_code == 404
    refused = [each for each in audit() if each[1] == "begin second factor"]
    wrong = ("mary", "begin second factor", "mary", "refused: the password is wrong")
    assert refused == ([wrong] if answer[0] == 403 else [])


def test_a_body_is_needed(client, stolen):
    assert client.post(FACTOR, headers=stolen).status_code == 422


def test_with_the_password_there_is_a_key(client, stolen, audit):
    answer = client.post(FACTOR, json={"password": PASSWORD}, headers=stolen)
    assert len(answer.json()["key"]) == 32
    assert ("mary", "begin second factor", "mary", "done") in audit()


def test_guesses_wait_as_at_a_login(client, stolen):
    guesses = [
        enrol(client, stolen, {"password": f"guess {number}"})[0]
        for number in range(ADDRESS_BACKOFF.free_failures + 1)
    ]
    assert guesses == [403] * ADDRESS_BACKOFF.free_failures + [429]
    assert enrol(client, stolen, {"password": PASSWORD})[0] == 429
    login = {"name": "mary", "password": PASSWORD}
    assert client.post("/api/v1/login", json=login).status_code == 429
