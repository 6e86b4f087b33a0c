from threading import BoundedSemaphore

import pytest
from service_app import PASSWORD

from rtron.service.domain.login_throttle import ADDRESS_BACKOFF
from rtron.service.store.accounts import passwords
from rtron.service.store.accounts.users import get_user, remove_user, set_disabled, set_roles

HOUR = 3600


@pytest.fixture
def mary(people):
    return people.add_user("mary", "developer")


@pytest.fixture
def login(client):
    """Log in and return the answer; the cookie is not kept."""

    def login(name="mary", password=PASSWORD, **headers):
        answer = client.post(
            "/api/v1/login", json={"name": name, "password": password}, headers=headers
        )
        client.cookies.clear()
        return answer

    return login


def browser(answer):
    """Return the headers of the browser that has logged in."""
    return {"Cookie": f"rtron={answer.cookies['rtron']}", "X-CSRF-Token": answer.json()["csrf"]}


def me(client, headers):
    return client.get("/api/v1/me", headers=headers).status_code


@pytest.mark.usefixtures("real_password_hashing")
def test_a_login_gives_a_cookie_that_scripts_and_other_sites_cannot_have(client, mary, login):
    answer = login()
    assert answer.status_code == 200
    assert answer.json()["name"] == "mary"
    assert answer.json()["roles"] == ["developer"]
    cookie = answer.headers["set-cookie"]
    assert cookie.startswith("rtron=")
    assert "; HttpOnly" in cookie
    assert "; SameSite=strict" in cookie
    assert "; Path=/" in cookie
    assert "Domain" not in cookie
    told = client.get("/api/v1/me", headers=browser(answer)).json()
    assert told == answer.json()


def test_the_secret_of_a_session_is_not_in_the_database(app, mary, login):
    secret = login().cookies["rtron"]
    assert len(secret) == 43
    app.state.service.database.close()
    folder = app.state.service.config.database.parent
    for file in (path for path in folder.rglob("*") if path.is_file()):
        assert secret.encode() not in file.read_bytes()
        assert PASSWORD.encode() not in file.read_bytes()


@pytest.mark.parametrize(
    ("name", "password"),
    [
        ("mary", PASSWORD + "x"),
        ("mary", PASSWORD[:-1]),
        ("mary", ""),
        ("mary", PASSWORD.upper()),
        ("nobody", PASSWORD),
        ("Mary", PASSWORD),
        ("", ""),
        ("mary' --", "x"),
    ],
)
def test_wrong_logins_are_all_alike(mary, login, name, password):
    answer = login(name, password)
    assert answer.status_code == 401
    assert answer.json()["error"] == "the name or the password is wrong"
    assert "set-cookie" not in answer.headers


def test_brute_force_has_to_wait_longer_and_longer(mary, login, clock):
    for _ in range(ADDRESS_BACKOFF.free_failures):
        assert login(password="guess").status_code == 401
    waits = []
    for _ in range(4):
        answer = login()  # even the right one
        assert answer.status_code == 429
        waits.append(int(answer.headers["retry-after"]))
        clock.sleep(waits[-1])
        assert login(password="guess").status_code == 401
    assert waits == [1, 2, 4, 8]
    clock.sleep(16)
    assert login().status_code == 200


def test_a_login_ends_the_session_that_the_browser_had(client, mary, login):
    """Nobody can have fixed the session beforehand (session fixation)."""
    planted = "A" * 43
    first = login(Cookie=f"rtron={planted}")
    assert first.cookies["rtron"] != planted
    assert me(client, {"Cookie": f"rtron={planted}"}) == 401
    second = login(Cookie=f"rtron={first.cookies['rtron']}")
    assert second.cookies["rtron"] != first.cookies["rtron"]
    assert me(client, browser(first)) == 401
    assert me(client, browser(second)) == 200


def test_after_logout_the_cookie_is_worthless(client, mary, login):
    headers = browser(login())
    answer = client.post("/api/v1/logout", headers=headers)
    assert answer.status_code == 204
    assert 'rtron=""' in answer.headers["set-cookie"]
    assert me(client, headers) == 401


@pytest.mark.parametrize(("pause", "status"), [(2 * HOUR, 200), (2 * HOUR + 1, 401)])
def test_a_session_ends_when_it_is_not_used(client, mary, login, clock, pause, status):
    headers = browser(login())
    clock.sleep(pause)
    assert me(client, headers) == status


@pytest.mark.parametrize(("last", "status"), [(HOUR, 200), (HOUR + 1, 401)])
def test_a_session_ends_however_much_it_is_used(client, mary, login, clock, last, status):
    headers = browser(login())
    for _ in range(11):
        clock.sleep(HOUR)
        assert client.get("/api/v1/robots", headers=headers).status_code == 200
    clock.sleep(last)
    assert me(client, headers) == status


def test_to_ask_who_one_is_keeps_no_session_alive(client, mary, login, clock):
    headers = browser(login())
    clock.sleep(HOUR)
    assert me(client, headers) == 200
    clock.sleep(HOUR + 1)
    assert me(client, headers) == 401


def test_a_new_password_ends_the_other_sessions(client, mary, login, people):
    mine, other = browser(login()), browser(login())
    new = "another fine password"
    change = {"old": PASSWORD, "new": new}
    answer = client.post("/api/v1/me/password", json=change, headers=mine)
    client.cookies.clear()
    assert answer.status_code == 204
    renewed = {**mine, "Cookie": f"rtron={answer.cookies['rtron']}"}
    assert [me(client, each) for each in (renewed, other)] == [200, 401]
    assert me(client, mine) == 401  # whoever has stolen the cookie before
    assert client.post("/api/v1/logout", headers=renewed).status_code == 204
    assert login().status_code == 401
    assert login(password=new).status_code == 200


def test_the_old_password_is_needed_and_cannot_be_guessed(client, mary, login, audit, admin):
    headers = browser(login())
    change = {"old": "guess", "new": "another fine password"}
    answers = [
        client.post("/api/v1/me/password", json=change, headers=headers).status_code
        for _ in range(ADDRESS_BACKOFF.free_failures + 1)
    ]
    assert answers == [403] * ADDRESS_BACKOFF.free_failures + [429]
    assert login().status_code == 429
    refused = ("mary", "change password", "mary", "refused: the old password is wrong")
    assert audit().count(refused) == 1
    entries = client.get("/api/v1/audit", headers=admin).json()["entries"]
    assert [e["detail"]["count"] for e in entries if "count" in e["detail"]] == [
        ADDRESS_BACKOFF.free_failures
    ]


@pytest.mark.parametrize(
    "end",
    [
        lambda session, user: set_disabled(session, user, disabled=True),
        lambda session, user: set_roles(session, user, ["end_user"]),
        remove_user,
    ],
    ids=["disabled", "demoted", "removed"],
)
def test_who_is_disabled_demoted_or_removed_is_logged_out(client, app, admin, mary, login, end):
    headers = browser(login())
    with app.state.service.database.session() as session:
        end(session, get_user(session, "mary"))
    assert me(client, headers) == 401


def test_a_disabled_user_cannot_log_in(client, app, admin, mary, login):
    with app.state.service.database.session() as session:
        set_disabled(session, get_user(session, "mary"), disabled=True)
    answer = login()
    assert answer.status_code == 401
    assert answer.json()["error"] == "the name or the password is wrong"


def test_logins_are_in_the_audit_log_but_not_what_was_typed(client, mary, login, audit):
    login()
    login(password="wrong one")
    login(name="hunter2-in-the-wrong-field")
    assert [each for each in audit() if each[1] == "login"] == [
        ("", "login", "an unknown name", "refused: wrong password"),
        ("mary", "login", "mary", "refused: wrong password"),
        ("mary", "login", "mary", "done"),
    ]


def test_a_wrong_token_is_not_saved_by_a_good_cookie(client, mary, login):
    headers = browser(login()) | {"Authorization": "Bearer rtron_wrong"}
    assert me(client, headers) == 401


@pytest.mark.parametrize("scheme", ["Basic bWFyeTp4", "Bearer", "rtron_x", "Bearer " + "x" * 5000])
def test_other_authorizations_are_refused(client, scheme):
    answer = client.get("/api/v1/me", headers={"Authorization": scheme})
    assert answer.status_code == 401
    assert answer.headers["www-authenticate"] == "Bearer"


def test_old_sessions_make_room(client, mary, login, clock):
    sessions = []
    for _ in range(21):
        clock.sleep(1)
        sessions.append(browser(login()))
    assert [me(client, each) for each in (sessions[0], sessions[1], sessions[-1])] == [
        401,
        200,
        200,
    ]


def test_too_many_at_this_moment_are_no_failures(app, client, monkeypatch, people):
    people.add_user("mary", "end_user")
    login = {"name": "mary", "password": PASSWORD}
    with monkeypatch.context() as patched:
        patched.setattr(passwords, "_admission_slots", BoundedSemaphore(1))
        passwords._admission_slots.acquire()
        for _ in range(3 * ADDRESS_BACKOFF.free_failures):
            answer = client.post("/api/v1/login", json=login)
            assert answer.json()["error"] == "too many logins at this moment"
    assert app.state.login_throttle.failed_count == 0
    assert client.post("/api/v1/login", json=login).status_code == 200
