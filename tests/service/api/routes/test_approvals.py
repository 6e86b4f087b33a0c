"""Four eyes: what gives rights waits for a second admin, and both are in the audit log."""

from pathlib import Path

import httpx
import pytest
from controller_setup import hello, plan
from service_app import PASSWORD, open_app, serve_in_thread

from rtron.service.config import ServiceConfig
from rtron.service.server.app import create_app
from rtron.service.server.database_accounts import create_token_record
from rtron.service.store.accounts.users import get_user, set_groups
from rtron.service.store.fleet.labels import replace_labels
from rtron.service.store.robots import find_robot

APPROVALS, USERS, TOKENS = "/api/v1/approvals", "/api/v1/users", "/api/v1/tokens"
NEW = {"name": "bob", "password": PASSWORD, "roles": ["developer"]}
DAY = 86_400


@pytest.fixture
def app(database_file, clock):
    config = ServiceConfig(database=database_file, four_eyes=True)
    with open_app(config, clock, clock) as app:
        yield app


@pytest.fixture
def ada(people):
    return people.session_headers("ada", "admin")


@pytest.fixture
def eve(people):
    return people.session_headers("eve", "admin")


@pytest.fixture
def bob(people):
    return people.add_user("bob", "end_user")


def ask(client, headers, method, path, body=None):
    """Ask for what gives rights; return the change that waits."""
    answer = client.request(method, path, json=body, headers=headers)
    assert answer.status_code == 202, answer.text
    told = answer.json()
    return told.get("waits", told)


def approve(client, headers, change):
    return client.post(f"{APPROVALS}/{change['id']}", headers=headers)


def roles(client, headers, name):
    users = {each["name"]: each for each in client.get(USERS, headers=headers).json()}
    return users[name]["roles"] if name in users else None


def can_log_in(client, name, password):
    answer = client.post("/api/v1/login", json={"name": name, "password": password})
    client.cookies.clear()
    return answer.status_code == 200


def test_an_admin_alone_adds_nobody(client, ada, eve, audit):
    change = ask(client, ada, "POST", USERS, NEW)
    assert roles(client, ada, "bob") is None
    assert not can_log_in(client, "bob", PASSWORD)
    own = approve(client, ada, change)
    assert (own.status_code, own.json()["error"]) == (403, "you have requested this yourself")
    assert roles(client, ada, "bob") is None
    assert approve(client, eve, change).status_code == 204
    assert roles(client, ada, "bob") == ["developer"]
    assert can_log_in(client, "bob", PASSWORD)
    assert approve(client, eve, change).status_code == 404
    lines = [each for each in audit() if each[2] == "bob" and each[1] != "login"]
    assert lines == [
        ("eve", "approve add user", "bob", "done"),
        ("ada", "approve add user", "bob", "refused: you have requested this yourself"),
        ("ada", "request add user", "bob", "done"),
    ]


def test_who_approves_what_she_has_seen_approves_no_other_change(client, ada, eve):
    seen = ask(client, ada, "POST", USERS, NEW)
    assert client.delete(f"{APPROVALS}/{seen['id']}", headers=ada).status_code == 204
    ask(client, ada, "POST", USERS, {**NEW, "name": "mallory", "roles": ["admin"]})
    assert approve(client, eve, seen).status_code == 404
    assert roles(client, ada, "mallory") is None


@pytest.mark.parametrize(
    "change",
    [
        {"roles": ["end_user", "admin"]},
        {"roles": ["developer"]},
        {"password": "another fine password"},
    ],
)
def test_more_roles_and_others_passwords_wait(client, ada, eve, bob, change):
    waiting = ask(client, ada, "PATCH", f"{USERS}/bob", change)
    assert roles(client, ada, "bob") == ["end_user"]
    assert can_log_in(client, "bob", PASSWORD)
    assert approve(client, eve, waiting).status_code == 204
    assert can_log_in(client, "bob", change.get("password", PASSWORD))
    assert roles(client, ada, "bob") == sorted(change.get("roles", ["end_user"]))


def test_an_admin_gives_itself_nothing_alone(client, ada, eve):
    waiting = ask(client, ada, "PATCH", f"{USERS}/ada", {"roles": ["admin", "developer"]})
    assert approve(client, ada, waiting).status_code == 403
    assert roles(client, ada, "ada") == ["admin"]
    assert approve(client, eve, waiting).status_code == 204
    assert roles(client, eve, "ada") == ["admin", "developer"]


def test_what_takes_rights_away_is_done_at_once(client, ada, bob, people):
    people.add_user("dan", "end_user", "developer")
    for name, change in (("dan", {"roles": ["end_user"]}), ("bob", {"disabled": True})):
        answer = client.patch(f"{USERS}/{name}", json=change, headers=ada)
        assert answer.status_code == 200
    assert roles(client, ada, "dan") == ["end_user"]
    assert not can_log_in(client, "bob", PASSWORD)
    assert client.delete(f"{USERS}/dan", headers=ada).status_code == 204


def test_who_was_disabled_waits_for_a_second_admin(client, ada, eve, bob):
    assert client.patch(f"{USERS}/bob", json={"disabled": True}, headers=ada).status_code == 200
    waiting = ask(client, ada, "PATCH", f"{USERS}/bob", {"disabled": False})
    assert not can_log_in(client, "bob", PASSWORD)
    assert approve(client, eve, waiting).status_code == 204
    assert can_log_in(client, "bob", PASSWORD)


def test_a_second_factor_is_not_taken_away_alone(client, ada, eve, bob):
    waiting = ask(client, ada, "DELETE", f"{USERS}/bob/second-factor")
    assert approve(client, ada, waiting).status_code == 403
    assert approve(client, eve, waiting).status_code == 204


@pytest.mark.parametrize("scope", ["end_user", "developer", "admin"])
def test_a_token_with_a_role_is_one_only_once_it_is_approved(client, ada, eve, scope):
    answer = client.post(TOKENS, json={"name": "t", "scopes": [scope]}, headers=ada)
    headers = {"Authorization": f"Bearer {answer.json()['secret']}"}
    assert answer.status_code == 202
    assert client.get("/api/v1/me", headers=headers).status_code == 401
    assert approve(client, ada, answer.json()["waits"]).status_code == 403
    assert approve(client, eve, answer.json()["waits"]).status_code == 204
    assert client.get("/api/v1/me", headers=headers).json()["roles"] == [scope]
    assert client.get(TOKENS, headers=ada).json()[0]["by"] == "ada"


@pytest.mark.parametrize("body", [{"scopes": ["read"]}, {"scopes": ["guard"], "robot": "r1"}])
def test_tokens_that_change_nothing_do_not_wait(client, ada, body):
    answer = client.post(TOKENS, json={"name": "t", **body}, headers=ada)
    assert answer.status_code == 201


@pytest.mark.parametrize("path", ["robots/b1/labels", "groups/hall-a"])
def test_which_robots_an_operator_may_change_is_not_said_alone(app, client, ada, eve, people, path):
    for robot in ("a1", "b1"):
        app.state.service.controller.handle_hello(robot, hello(plan()))
    with app.state.service.database.session() as session:
        replace_labels(session, find_robot(session, "a1")[0], ["hall-a"])
    tom = people.session_headers("tom", "end_user")
    with app.state.service.database.session() as session:
        set_groups(get_user(session, "tom"), ["hall-a"])

    def put(body):
        return client.put(f"/api/v1/{path}", headers=ada, json=body).status_code

    def can_stop_b1():
        return client.post("/api/v1/robots/b1/stop", headers=tom).status_code == 200

    more, less = (
        ({"robots": ["a1", "b1"]}, {"robots": ["a1"]})
        if "groups" in path
        else ({"labels": ["hall-a"]}, {"labels": []})
    )
    waiting = ask(client, ada, "PUT", f"/api/v1/{path}", more)
    assert not can_stop_b1()
    assert approve(client, ada, waiting).status_code == 403
    assert approve(client, eve, waiting).status_code == 204
    assert can_stop_b1()
    assert put(more) == put(less) == 200
    assert not can_stop_b1()


def test_a_token_is_no_second_pair_of_eyes(client, ada, eve, bob):
    answer = client.post(TOKENS, json={"name": "t", "scopes": ["admin"]}, headers=ada)
    assert approve(client, eve, answer.json()["waits"]).status_code == 204
    token = {"Authorization": f"Bearer {answer.json()['secret']}"}
    waiting = ask(client, ada, "PATCH", f"{USERS}/bob", {"roles": ["admin"]})
    assert approve(client, token, waiting).json()["error"] == "a token cannot approve"
    by_token = ask(client, token, "PATCH", f"{USERS}/bob", {"roles": ["admin"]})
    assert (by_token["by"], by_token["owner"]) == ("token:t", "ada")
    assert approve(client, ada, by_token).status_code == 403
    assert roles(client, ada, "bob") == ["end_user"]
    assert approve(client, eve, by_token).status_code == 204


def test_a_token_that_is_nobodys_asks_for_no_rights(app, client, ada, eve, people, audit):
    made = {"name": "ci", "scopes": ["admin"]}
    secret = create_token_record(app.state.service.database, "rtron", made)
    token = {"Authorization": f"Bearer {secret}"}
    answer = client.post(USERS, json=NEW, headers=token)
    assert (answer.status_code, answer.json()["error"]) == (403, "nobody knows whose token ci is")
    assert client.get(APPROVALS, headers=ada).json() == []
    assert ("token:ci", "request add user", "bob") in [line[:3] for line in audit()]
    people.add_user("dan", "end_user", "developer")
    less = client.patch(f"{USERS}/dan", json={"roles": ["end_user"]}, headers=token)
    assert less.status_code == 200


def test_only_admins_see_and_approve(client, ada, bob, people):
    waiting = ask(client, ada, "PATCH", f"{USERS}/bob", {"roles": ["admin"]})
    developer = people.session_headers("dev", "developer", "end_user")
    assert client.get(APPROVALS, headers=developer).status_code == 403
    assert approve(client, developer, waiting).status_code == 403
    assert client.delete(f"{APPROVALS}/{waiting['id']}", headers=developer).status_code == 403
    assert [each["id"] for each in client.get(APPROVALS, headers=ada).json()] == [waiting["id"]]


def test_a_change_is_rejected_or_withdrawn(client, ada, eve, bob, audit):
    for headers in (ada, eve):
        waiting = ask(client, ada, "PATCH", f"{USERS}/bob", {"roles": ["admin"]})
        url = f"{APPROVALS}/{waiting['id']}"
        assert client.delete(url, headers=headers).status_code == 204
        assert approve(client, eve, waiting).status_code == 404
    assert roles(client, ada, "bob") == ["end_user"]
    assert ("eve", "reject change user", "bob", "done") in audit()


def test_what_nobody_approves_is_over_after_a_week(client, ada, bob, people, clock):
    waiting = ask(client, ada, "PATCH", f"{USERS}/bob", {"roles": ["admin"]})
    clock.sleep(7 * DAY)
    eve = people.session_headers("eve", "admin")
    assert approve(client, eve, waiting).status_code == 404
    assert client.get(APPROVALS, headers=eve).json() == []


def test_what_does_not_fit_any_more_is_refused_and_waits_on(client, ada, eve, audit):
    first, second = (ask(client, ada, "POST", USERS, NEW) for _ in range(2))
    assert approve(client, eve, first).status_code == 204
    assert approve(client, eve, second).status_code == 409
    assert [each["id"] for each in client.get(APPROVALS, headers=ada).json()] == [second["id"]]


def test_no_secret_is_told_of_what_waits(client, ada, app):
    ask(client, ada, "POST", USERS, NEW)
    answer = client.post(TOKENS, json={"name": "t", "scopes": ["admin"]}, headers=ada)
    told = client.get(APPROVALS, headers=ada).text + client.get("/api/v1/audit", headers=ada).text
    assert "argon2" not in told
    assert "digest" not in told
    app.state.service.database.close()
    folder = app.state.service.config.database.parent
    for file in filter(Path.is_file, folder.rglob("*")):
        assert PASSWORD.encode() not in file.read_bytes()
        assert answer.json()["secret"].encode() not in file.read_bytes()


def test_without_the_switch_nothing_waits(tmp_path, clock, people, ada):
    app = create_app(ServiceConfig(database=tmp_path / "rtron.db"), clock, clock)
    with serve_in_thread(app) as port:
        url = f"http://127.0.0.1:{port}{USERS}"
        assert httpx.post(url, json=NEW, headers=ada, timeout=60).status_code == 201
