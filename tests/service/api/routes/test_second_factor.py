"""One-time codes: enrolled, asked for at a login, used once, and not to be guessed."""

from threading import Thread

import httpx
import pytest
from service_app import PASSWORD, TLS, AccountFactory, serve_in_thread
from sqlalchemy import select

from rtron.service.config import ServiceConfig
from rtron.service.domain.one_time_codes import STEP_S, code_at, step_at
from rtron.service.domain.principal import UserRole
from rtron.service.server.app import create_app
from rtron.service.store.tables import SessionRow

FACTOR = "/api/v1/me/second-factor"
CONFIRMATION = f"{FACTOR}/confirmation"
OWN = {"password": PASSWORD}


@pytest.fixture
def login(client):
    """Log in with the password; return the answer and the headers of that browser."""

    def login(name="mary", port_client=client):
        answer = port_client.post("/api/v1/login", json={"name": name, "password": PASSWORD})
        port_client.cookies.clear()
        assert answer.status_code == 200
        return answer.json(), browser(answer, answer.json()["csrf"])

    return login


def browser(answer, csrf):
    return {"Cookie": f"rtron={answer.cookies['rtron']}", "X-CSRF-Token": csrf}


def enter(client, headers, code):
    answer = client.post("/api/v1/login/code", json={"code": code}, headers=headers)
    client.cookies.clear()
    return answer


class Phone:
    """An authenticator app with the key of a user."""

    def __init__(self, client, headers, clock):
        self.clock = clock
        self.key = client.post(FACTOR, json=OWN, headers=headers).json()["key"]
        body = {"code": self.code()}
        answer = client.post(CONFIRMATION, json=body, headers=headers)
        client.cookies.clear()
        assert answer.status_code == 200
        self.recovery_codes = answer.json()["recovery_codes"]
        self.headers = browser(answer, answer.json()["user"]["csrf"])
        clock.sleep(STEP_S)

    def code(self, steps=0):
        return code_at(self.key, step_at(self.clock.now) + steps)

    def wrong_code(self):
        near = {self.code(steps) for steps in (-1, 0, 1)}
        return next(each for each in ("000000", "111111", "222222", "333333") if each not in near)


@pytest.fixture
def phone(client, people, login, clock):
    people.add_user("mary", "developer")
    return Phone(client, login()[1], clock)


def test_the_codes_are_those_of_the_standard():
    """RFC 6238, appendix B, the last six of eight digits; the key is "12345678901234567890"."""
    key = "GEZDGNBVGY3TQOJQGEZDGNBVGY3TQOJQ"
    times = {59: "287082", 1111111109: "081804", 1234567890: "005924", 20000000000: "353130"}
    assert {at: code_at(key, at // STEP_S) for at in times} == times


def test_a_login_takes_the_code_and_gives_nothing_before(client, phone, login):
    told, begun = login()
    assert (told["stage"], told["roles"]) == ("code", [])
    for path in ("robots", "events", "audit", "users", "tokens"):
        assert client.get(f"/api/v1/{path}", headers=begun).status_code == 403
    for path in ("me/second-factor", "me/password", "robots/r1/stop"):
        body = {"old": PASSWORD, "new": PASSWORD + "x", "reason": "why"}
        answer = client.post(f"/api/v1/{path}", json=body, headers=begun)
        assert answer.status_code in (403, 422)
    answer = enter(client, begun, phone.code())
    assert (answer.json()["stage"], answer.json()["roles"]) == ("complete", ["developer"])
    headers = browser(answer, answer.json()["csrf"])
    assert client.get("/api/v1/robots", headers=headers).status_code == 200
    assert client.get("/api/v1/me", headers=begun).status_code == 401


def test_a_thief_of_the_password_ends_no_session_and_no_begun_login(client, phone, login, clock):
    _, begun = login()
    clock.sleep(1)
    for _ in range(25):
        login()
    assert client.get("/api/v1/robots", headers=phone.headers).status_code == 200
    assert enter(client, begun, phone.code()).status_code == 200


def test_half_logins_fill_no_log(client, phone, login, admin):
    for _ in range(5):
        login()
    entries = client.get("/api/v1/audit", headers=admin).json()["entries"]
    (line,) = [each for each in entries if each["action"] == "login, password"]
    assert line["detail"]["count"] == 5


def test_logins_that_nobody_completes_are_forgotten(client, app, phone, login, clock):
    login()
    clock.sleep(601)
    login()
    with app.state.service.database.session() as session:
        stages = sorted(session.scalars(select(SessionRow.stage)))
    assert stages == ["code", "complete"]


def test_a_code_counts_once(client, phone, login):
    code = phone.code()
    assert enter(client, login()[1], code).status_code == 200
    again = enter(client, login()[1], code)
    assert again.status_code == 403
    assert "used before" in again.json()["error"]
    assert enter(client, login()[1], phone.code(-1)).status_code == 403  # older than the used one
    assert enter(client, login()[1], phone.code(1)).status_code == 200


@pytest.mark.parametrize(
    ("steps", "status"), [(-2, 403), (-1, 200), (0, 200), (1, 200), (2, 403), (3, 403)]
)
def test_a_phone_may_be_half_a_minute_off(client, phone, login, clock, steps, status):
    clock.sleep(10 * STEP_S)
    assert enter(client, login()[1], phone.code(steps)).status_code == status


def test_of_two_at_once_with_one_code_one_gets_in(phone, port, login):
    begun = [login()[1] for _ in range(4)]
    code, statuses = phone.code(), []

    def try_it(headers):
        with httpx.Client(base_url=f"http://127.0.0.1:{port}", timeout=60, verify=TLS) as client:
            statuses.append(enter(client, headers, code).status_code)

    threads = [Thread(target=try_it, args=[headers]) for headers in begun]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert statuses.count(200) == 1


def test_recovery_codes_work_once_each_and_are_hashed(app, client, phone, login, audit):
    assert len(set(phone.recovery_codes)) == 10
    first = phone.recovery_codes[0]
    assert enter(client, login()[1], f" {first.upper()} ").status_code == 200
    assert enter(client, login()[1], first).status_code == 403
    assert enter(client, login()[1], phone.recovery_codes[1]).status_code == 200
    app.state.service.database.close()
    folder = app.state.service.config.database.parent
    for file in (path for path in folder.rglob("*") if path.is_file()):
        for code in phone.recovery_codes:
            assert code.encode() not in file.read_bytes()
            assert code.replace("-", "").encode() not in file.read_bytes()


def test_wrong_codes_wait_and_a_recovery_code_does_not(client, phone, login, audit):
    statuses = [enter(client, login()[1], phone.wrong_code()).status_code for _ in range(6)]
    assert statuses == [403] * 5 + [429]
    begun = login()[1]
    answer = enter(client, begun, phone.code())
    assert (answer.status_code, "recovery code" in answer.json()["help"]) == (429, True)
    assert enter(client, begun, phone.recovery_codes[0]).status_code == 200
    refused = [each for each in audit() if each[3].startswith("refused: the code is wrong")]
    assert refused[0][:3] == ("mary", "login", "mary")


def test_half_a_login_ends_by_itself(client, phone, login, clock):
    begun = login()[1]
    clock.sleep(601)
    assert enter(client, begun, phone.code()).status_code == 401


def test_half_a_login_makes_no_address_known(app, client, people, phone, login):
    throttle = app.state.login_throttle
    assert throttle.is_known("mary", "127.0.0.1")  # she has enrolled from here
    throttle._known.clear()
    begun = login()[1]
    assert not throttle.is_known("mary", "127.0.0.1")
    assert enter(client, begun, phone.code()).status_code == 200
    assert throttle.is_known("mary", "127.0.0.1")


def test_the_key_counts_only_once_it_is_confirmed(client, people, login, clock):
    people.add_user("mary", "developer")
    headers = login()[1]
    made = client.post(FACTOR, json=OWN, headers=headers).json()
    assert made["uri"].startswith("otpauth://totp/RTron%3Amary?secret=")
    assert made["key"] in made["uri"]
    assert {len(row) for row in made["qr"]} == {len(made["qr"])}
    wrong = {"code": "000000" if code_at(made["key"], step_at(clock.now)) != "000000" else "1" * 6}
    assert client.post(CONFIRMATION, json=wrong, headers=headers).status_code == 403
    assert login()[0]["stage"] == "complete"
    again = client.post(FACTOR, json=OWN, headers=headers).json()
    assert again["key"] != made["key"]


def test_a_second_enrolment_takes_the_removal_of_the_first(client, phone, login):
    assert client.post(FACTOR, json=OWN, headers=phone.headers).status_code == 409
    wrong = {"code": phone.wrong_code()}
    assert client.request("DELETE", FACTOR, json=wrong, headers=phone.headers).status_code == 403
    right = {"code": phone.code()}
    assert client.request("DELETE", FACTOR, json=right, headers=phone.headers).status_code == 204
    assert login()[0]["stage"] == "complete"
    assert client.post(FACTOR, json=OWN, headers=phone.headers).status_code == 200


def test_an_admin_removes_the_factor_of_who_has_lost_the_phone(client, phone, admin, login, audit):
    url = "/api/v1/users/mary/second-factor"
    assert client.delete(url, headers=phone.headers).status_code == 403
    assert client.delete(url, headers=admin).status_code == 200
    assert client.get("/api/v1/me", headers=phone.headers).status_code == 401
    assert login()[0]["stage"] == "complete"
    assert ("root", "reset second factor", "mary", "done") in audit()


def test_a_user_with_a_factor_can_be_removed(client, phone, admin):
    assert client.delete("/api/v1/users/mary", headers=admin).status_code == 204


def test_a_role_may_require_a_code(tmp_path, clock):
    config = ServiceConfig(
        database=tmp_path / "strict.db", second_factor_roles=frozenset({UserRole.ADMIN})
    )
    app = create_app(config, clock, clock)
    people = AccountFactory(app.state.service)
    people.add_user("mary", "developer", "admin")
    people.add_user("bob", "developer")
    with (
        serve_in_thread(app, config) as port,
        httpx.Client(base_url=f"http://127.0.0.1:{port}", timeout=60, verify=TLS) as client,
    ):
        body = {"name": "bob", "password": PASSWORD}
        assert client.post("/api/v1/login", json=body).json()["stage"] == "complete"
        client.cookies.clear()
        answer = client.post("/api/v1/login", json=body | {"name": "mary"})
        client.cookies.clear()
        assert (answer.json()["stage"], answer.json()["roles"]) == ("enrolment", [])
        headers = browser(answer, answer.json()["csrf"])
        assert client.get("/api/v1/users", headers=headers).status_code == 403
        change = {"old": PASSWORD, "new": PASSWORD + "x"}
        url = "/api/v1/me/password"
        assert client.post(url, json=change, headers=headers).status_code == 403
        phone = Phone(client, headers, clock)
        assert client.get("/api/v1/users", headers=phone.headers).status_code == 200
        assert client.get("/api/v1/me", headers=headers).status_code == 401
