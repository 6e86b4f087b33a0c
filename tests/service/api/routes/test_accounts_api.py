import json
from threading import Thread

import httpx
import pytest
from service_app import PASSWORD, TLS, AccountFactory, serve_in_thread
from sqlalchemy import create_engine, text

from rtron.service.api.routes.monitoring import lost_messages
from rtron.service.config import ServiceConfig
from rtron.service.server.app import create_app
from rtron.vocabulary import GuardState, Mode, StreamState, VerdictCounts

DAY = 86_400
USERS, TOKENS = "/api/v1/users", "/api/v1/tokens"
NEW = {"name": "mary", "password": PASSWORD, "roles": ["developer"]}


def me(client, headers):
    return client.get("/api/v1/me", headers=headers).status_code


# users


def test_a_user_is_added_listed_changed_and_removed(client, admin, clock):
    made = client.post(USERS, json=NEW, headers=admin)
    assert made.status_code == 201
    view = {"name": "mary", "roles": ["developer"], "disabled": False, "created": clock.now}
    view |= {"is_from_provider": False, "groups": None}
    assert made.json() == view
    assert [each["name"] for each in client.get(USERS, headers=admin).json()] == ["mary", "root"]
    changed = client.patch(f"{USERS}/mary", json={"roles": ["end_user"]}, headers=admin)
    assert changed.json() == view | {"roles": ["end_user"]}
    assert client.delete(f"{USERS}/mary", headers=admin).status_code == 204
    assert client.delete(f"{USERS}/mary", headers=admin).status_code == 404
    assert client.post(USERS, json=NEW, headers=admin).status_code == 201


def test_two_users_have_two_names(client, admin):
    assert client.post(USERS, json=NEW, headers=admin).status_code == 201
    answer = client.post(USERS, json=NEW, headers=admin)
    assert answer.status_code == 409
    assert answer.json()["error"] == "there is a user mary already"


@pytest.mark.parametrize(
    "wrong",
    [
        {"password": "x" * 11},
        {"password": "x" * 201},
        {"name": ""},
        {"name": "a" * 101},
        {"name": "-a"},
        {"name": "a\n"},
        {"name": "a/b"},
        {"name": "token:x"},
        {"name": "\ud800"},
        {"roles": []},
        {"roles": ["root"]},
        {"roles": ["admin"] * 4},
        {"more": 1},
        {"password": 5},
    ],
)
def test_wrong_users_are_refused_and_their_password_is_not_told(client, admin, wrong):
    answer = client.post(
        USERS,
        content=json.dumps({**NEW, **wrong}),
        headers=admin | {"Content-Type": "application/json"},
    )
    assert answer.status_code == 422
    assert PASSWORD not in answer.text
    assert "x" * 11 not in answer.text


@pytest.mark.parametrize(
    ("method", "change"),
    [("PATCH", {"roles": ["developer"]}), ("PATCH", {"disabled": True}), ("DELETE", None)],
)
def test_the_last_admin_stays(client, admin, people, audit, method, change):
    def attempt(headers):
        return client.request(method, f"{USERS}/root", json=change, headers=headers).status_code

    assert attempt(admin) == 409
    assert audit()[0][3].startswith("refused: root is the last admin")
    sleeping = people.session_headers("second", "admin")
    client.patch(f"{USERS}/second", json={"disabled": True}, headers=admin)
    assert attempt(admin) == 409
    assert me(client, sleeping) == 401
    client.patch(f"{USERS}/second", json={"disabled": False}, headers=admin)
    assert attempt(people.session_headers("second")) in {200, 204}


def test_two_admins_cannot_remove_each_other_at_once(client, people, port):
    for _ in range(5):
        names = ("one", "two")
        headers = [people.session_headers(name, "admin") for name in names]
        statuses = []

        def remove(name, given, statuses=statuses):
            statuses.append(client.delete(f"{USERS}/{name}", headers=given).status_code)

        pairs = zip(reversed(names), headers, strict=True)
        threads = [Thread(target=remove, args=pair) for pair in pairs]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        assert sorted(statuses) in ([204, 401], [204, 409])
        (left,) = client.get(USERS, headers=people.token_headers("t", "admin")).json()
        for name in names:
            if name != left["name"]:
                people.session_headers(name, "admin")


def test_of_two_who_add_the_same_user_at_once_one_is_told_so(client, admin):
    statuses = []

    def add():
        statuses.append(client.post(USERS, json=NEW, headers=admin).status_code)

    threads = [Thread(target=add) for _ in range(2)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert sorted(statuses) == [201, 409]


def test_an_admins_new_password_for_a_user_ends_the_sessions(client, admin, people):
    people.add_user("mary", "developer")
    browser = people.session_headers("mary")
    change = {"password": "another fine password"}
    assert client.patch(f"{USERS}/mary", json=change, headers=admin).status_code == 200
    assert me(client, browser) == 401
    login = {"name": "mary", **change}
    assert client.post("/api/v1/login", json=login).status_code == 200


def test_nobody_changes_the_own_roles(client, people):
    for headers in (
        people.session_headers("dev", "developer"),
        people.token_headers("dev", "developer"),
    ):
        change = {"roles": ["admin"]}
        assert client.patch(f"{USERS}/dev", json=change, headers=headers).status_code == 403


# tokens


def make(client, admin, **changed):
    wanted = {"name": "ci", "scopes": ["read"]} | changed
    return client.post(TOKENS, json=wanted, headers=admin)


def bearer(answer):
    return {"Authorization": f"Bearer {answer.json()['secret']}"}


def test_a_token_is_told_once_and_works_until_it_is_revoked(client, admin):
    made = make(client, admin)
    assert made.status_code == 201
    assert made.json()["secret"].startswith("rtron_")
    headers = bearer(made)
    assert me(client, headers) == 200
    listed = client.get(TOKENS, headers=admin)
    assert made.json()["secret"] not in listed.text
    assert listed.json()[0]["by"] == "root"
    assert client.delete(f"{TOKENS}/ci", headers=admin).status_code == 204
    assert me(client, headers) == 401
    assert client.get(TOKENS, headers=admin).json()[0]["revoked"] is not None
    assert make(client, admin).status_code == 409


@pytest.mark.parametrize(("pause", "status"), [(DAY - 1, 200), (DAY, 401)])
def test_a_token_ends_by_time(client, admin, clock, pause, status):
    headers = bearer(make(client, admin, days=1))
    clock.sleep(pause)
    assert me(client, headers) == status


@pytest.mark.parametrize(
    "wrong",
    [
        {"scopes": []},
        {"scopes": ["root"]},
        {"scopes": ["guard"]},
        {"scopes": ["guard", "admin"], "robot": "car1"},
        {"robot": "car1"},
        {"scopes": ["guard"], "robot": "../car1"},
        {"days": 0},
        {"days": 3651},
        {"name": "a" * 81},
        {"name": "a b"},
    ],
)
def test_wrong_tokens_are_refused(client, admin, wrong):
    assert make(client, admin, **wrong).status_code == 422


def test_the_last_use_is_noted_once_a_minute(client, admin, clock):
    headers = bearer(make(client, admin))

    def used():
        return client.get(TOKENS, headers=admin).json()[0]["used"]

    assert used() is None
    client.get("/api/v1/robots", headers=headers)
    first = clock.now
    assert used() == first
    clock.sleep(59)
    client.get("/api/v1/robots", headers=headers)
    assert used() == first
    clock.sleep(1)
    client.get("/api/v1/robots", headers=headers)
    assert used() == clock.now


def test_a_guards_token_speaks_for_its_robot_alone(app, client, people):
    authenticate = app.state.collector.authenticate
    guard = people.token_headers("guard", "guard", robot="car1")["Authorization"].split()[1]
    other = people.token_headers("other", "admin")["Authorization"].split()[1]
    assert authenticate(guard) == "car1"
    assert authenticate(other) is None
    assert authenticate(guard + "x") is None
    assert authenticate("") is None


# the audit log


def test_every_change_is_written_down_and_no_secret(client, admin, audit, caplog, app, people):
    caplog.set_level("DEBUG")
    secrets = [PASSWORD, "another fine password", admin["Cookie"][6:], admin["X-CSRF-Token"]]
    client.post(USERS, json=NEW, headers=admin)
    client.patch(f"{USERS}/mary", json={"password": secrets[1]}, headers=admin)
    made = make(client, admin)
    secrets.append(made.json()["secret"])
    me(client, bearer(made))
    hook = client.post(
        "/api/v1/webhooks", json={"url": "https://example.org/T0/s3cret"}, headers=admin
    )
    secrets += [hook.json()["secret"], "s3cret"]
    client.delete(f"{TOKENS}/ci", headers=admin)
    client.delete(f"{USERS}/mary", headers=admin)
    client.post("/api/v1/login", json={"name": "root", "password": secrets[1]})
    client.get(f"/api/v1/events?text={secrets[4]}", headers=admin)
    dev = people.session_headers("dev", "developer")
    client.post(USERS, json=NEW, headers=dev)
    said = "".join(each.getMessage() for each in caplog.records if "http" not in each.name)
    log = client.get("/api/v1/audit", headers=admin)
    assert [each[:3] for each in reversed(audit())] == [
        ("root", "add user", "mary"),
        ("root", "change user", "mary"),
        ("root", "create token", "ci"),
        ("root", "add webhook", "https://example.org"),
        ("root", "revoke token", "ci"),
        ("root", "remove user", "mary"),
        ("root", "login", "root"),
        ("dev", "post", "/api/v1/users"),
    ]
    assert audit()[0][3] == "refused: dev may not do that"
    assert log.json()["entries"][0]["address"] == "127.0.0.1"
    for secret in secrets:
        assert secret not in log.text
        assert secret not in said


def test_the_audit_log_has_pages_and_is_sifted(client, admin):
    for number in range(5):
        make(client, admin, name=f"t{number}")
    first = client.get("/api/v1/audit?limit=2", headers=admin).json()
    assert [each["target"] for each in first["entries"]] == ["t4", "t3"]
    second = client.get(f"/api/v1/audit?limit=3&before={first['next']}", headers=admin).json()
    assert [each["target"] for each in second["entries"]] == ["t2", "t1", "t0"]
    assert second["next"] is None
    found = client.get("/api/v1/audit?target=t3&who=root&action=create token", headers=admin).json()
    assert len(found["entries"]) == 1
    assert client.get("/api/v1/audit?who=mary", headers=admin).json()["entries"] == []


# metrics and health


def test_metrics_are_what_prometheus_reads(app, client, people):
    headers = people.token_headers("prometheus", "metrics")
    client.post("/api/v1/login", json={"name": "x", "password": "y"})
    answer = client.get("/metrics", headers=headers)
    assert answer.headers["content-type"].startswith("text/plain; version=")
    assert "\nrtron_logins_failed_total 1.0\n" in answer.text
    assert "\nrtron_events_stored_total 0.0\n" in answer.text
    assert "\nrtron_guards_connected 0.0\n" in answer.text
    assert "\nrtron_settings_pending 0.0\n" in answer.text
    assert "rtron_database_bytes " in answer.text


def test_what_guards_lose_is_in_the_metrics(app):
    streams = (
        StreamState(
            topic="/cmd_vel",
            nodes=("grcn",),
            mode=Mode.ENFORCE,
            flows={"nav": VerdictCounts(lost=3), "teleop": VerdictCounts(lost=4)},
            lost_behind=2,
        ),
    )
    state = GuardState(at=1, revision=1, streams=streams, lost_events={"/light": 5})
    found = lost_messages({"car1": state, "car2": None})
    assert found.name == "rtron_messages_lost"
    assert {(*sample.labels.values(), sample.value) for sample in found.samples} == {
        ("car1", "/cmd_vel", "before", 7),
        ("car1", "/cmd_vel", "behind", 2),
        ("car1", "/light", "event", 5),
    }


def test_it_is_not_ready_without_its_database(app, client, monkeypatch):
    assert client.get("/readyz").status_code == 200
    database = app.state.service.database
    monkeypatch.setattr(database, "engine", _gone(database.engine.url))
    answer = client.get("/readyz")
    assert answer.status_code == 503
    assert answer.json()["error"] == "the database does not answer"
    assert client.get("/healthz").status_code == 200


def test_a_database_that_fails_is_told_without_what_was_to_be_stored(
    app, client, admin, monkeypatch, caplog
):
    with app.state.service.database.session() as session:
        session.execute(text("ALTER TABLE audit_log RENAME TO gone"))
    answer = client.post(USERS, json=NEW, headers=admin)
    assert answer.status_code == 503
    assert answer.json()["error"] == "the database does not answer"
    assert "the database failed: OperationalError" in caplog.text
    assert "argon2" not in caplog.text


def test_all_of_it_works_on_each_kind_of_database(where, clock):
    app = create_app(ServiceConfig(database=where), clock, clock)
    people = AccountFactory(app.state.service)
    admin = people.session_headers("root", "admin", "developer")
    people.add_user("mary", "end_user")
    with (
        serve_in_thread(app) as port,
        httpx.Client(base_url=f"http://127.0.0.1:{port}", timeout=60, verify=TLS) as client,
    ):
        login = {"name": "mary", "password": PASSWORD}
        assert client.post("/api/v1/login", json=login).status_code == 200
        client.cookies.clear()
        assert client.post(USERS, json=NEW | {"name": "new"}, headers=admin).status_code == 201
        assert make(client, admin).status_code == 201
        assert client.delete(f"{USERS}/root", headers=admin).status_code == 409
        change = {"disabled": True}
        assert client.patch(f"{USERS}/mary", json=change, headers=admin).status_code == 200
        asked = ("/metrics", "/readyz", "/api/v1/audit", "/api/v1/events?text=x", "/api/v1/robots")
        for path in asked:
            assert client.get(path, headers=admin).status_code == 200
        assert client.get("/api/v1/robots/x/figures", headers=admin).status_code == 404


def _gone(url):
    return create_engine(url.set(database="/nowhere/at/all.db"))
