"""Sign-in at a real provider: who has a mapped role gets it, everybody else gets nothing."""

import base64
import json
from contextlib import ExitStack
from typing import ClassVar
from urllib.parse import parse_qs, urlsplit

import httpx
import pytest
from joserfc import jwt
from joserfc.jwk import RSAKey
from oidc_provider import running_provider
from service_app import PASSWORD, TLS, AccountFactory, open_app, serve_in_thread
from sqlalchemy import update

from rtron.service.api.routes import oidc
from rtron.service.config import ServiceConfig
from rtron.service.domain.oidc import OidcConfig
from rtron.service.domain.one_time_codes import code_at, step_at
from rtron.service.domain.principal import UserRole
from rtron.service.server.app import create_app
from rtron.service.store.accounts.last_use import WarningThrottle
from rtron.service.store.accounts.second_factors import begin_enrolment, confirm_enrolment
from rtron.service.store.accounts.users import get_user, set_disabled, set_groups
from rtron.service.store.tables import SessionRow

# The provider is built on what Authlib wants to drop.
pytestmark = pytest.mark.filterwarnings("ignore::DeprecationWarning")
LOGIN = "/api/v1/login/oidc"
CALLBACK = f"{LOGIN}/callback"
FACTOR = "/api/v1/me/second-factor"


@pytest.fixture
def provider(tmp_path):
    secret = tmp_path / "oidc.secret"
    secret.write_text("hush hush")
    with running_provider() as provider:
        provider.secret_file = str(secret)
        yield provider


def config_for(provider, **changes):
    values = {
        "issuer": provider.url,
        "client_id": "rtron",
        "client_secret_file": provider.secret_file,
        "public_url": "http://127.0.0.1:8600",
        "display_name": "Example",
        "roles": {"robot-developers": ["developer"], "robot-admins": ["admin", "developer"]},
    }
    return OidcConfig(**(values | changes))


@pytest.fixture
def changes():
    return {}


@pytest.fixture
def app(database_file, provider, changes):
    roles = changes.pop("second_factor_roles", frozenset())
    config = ServiceConfig(
        database=database_file, oidc=config_for(provider, **changes), second_factor_roles=roles
    )
    with open_app(config) as app:
        yield app


@pytest.fixture
def people(app):
    return AccountFactory(app.state.service)


@pytest.fixture
def browser(app):
    """A browser with cookies, which follows no redirection by itself."""
    with serve_in_thread(app) as port, new_browser(port) as browser:
        yield browser


def new_browser(port):
    return httpx.Client(base_url=f"http://127.0.0.1:{port}", timeout=60, verify=TLS)


def authorize(browser, sub, **form):
    """Go to the provider and sign in there; return the query of the way back."""
    begun = browser.get(LOGIN)
    assert begun.status_code == 303
    form = form or {"sub": sub}
    answer = httpx.post(begun.headers["location"], data=form, timeout=60, verify=TLS)
    assert answer.status_code == 302
    back = urlsplit(answer.headers["location"])
    assert back.path == CALLBACK
    return {key: value[0] for key, value in parse_qs(back.query).items()}


def sign_in(browser, sub):
    return browser.get(CALLBACK, params=authorize(browser, sub))


def problem_of(answer):
    assert answer.status_code == 303
    return parse_qs(urlsplit(answer.headers["location"]).query).get("sign_in", [""])[0]


def me(browser):
    answer = browser.get("/api/v1/me")
    return answer.json().get("roles") if answer.status_code == 200 else answer.status_code


def test_who_has_a_mapped_group_gets_its_roles(browser, provider, people):
    assert browser.get("/api/v1/login/methods").json() == {"oidc": "Example"}
    answer = sign_in(browser, "sub-mary")
    assert (answer.status_code, answer.headers["location"]) == (303, "/")
    cookies = answer.headers.get_list("set-cookie")
    assert any(each.startswith("rtron=") and "HttpOnly" in each for each in cookies)
    assert any(each.startswith('rtron-sign-in=""') for each in cookies)
    assert me(browser) == ["developer"]
    admin = people.session_headers("root", "admin")
    (user,) = [
        each
        for each in browser.get("/api/v1/users", headers=admin).json()
        if each["name"] == "mary"
    ]
    assert (user["roles"], user["is_from_provider"]) == (["developer"], True)
    entries = browser.get("/api/v1/audit", headers=admin).json()["entries"]
    (login,) = [each for each in entries if each["action"] == "login"]
    assert (login["who"], login["outcome"]) == ("mary", "done")
    assert login["detail"] == {"oidc": f"{provider.url}\nsub-mary", "roles": ["developer"]}


def test_the_browser_that_begins_has_the_secrets_and_the_provider_only_their_digest(browser):
    begun = browser.get(LOGIN)
    asked = parse_qs(urlsplit(begun.headers["location"]).query)
    cookie = begun.headers["set-cookie"]
    assert "HttpOnly" in cookie
    assert "SameSite=lax" in cookie
    state, nonce, verifier = browser.cookies["rtron-sign-in"].split(".")
    assert (asked["state"], asked["nonce"]) == ([state], [nonce])
    assert asked["code_challenge_method"] == ["S256"]
    assert verifier not in begun.headers["location"]
    again = browser.get(LOGIN)
    assert parse_qs(urlsplit(again.headers["location"]).query)["state"] != [state]


def test_who_has_no_mapped_role_gets_nothing_and_is_told_so(browser, people):
    answer = sign_in(browser, "sub-guest")
    assert problem_of(answer) == "no_role"
    assert "rtron" not in browser.cookies
    assert me(browser) == 401
    admin = people.session_headers("root", "admin")
    users = [each["name"] for each in browser.get("/api/v1/users", headers=admin).json()]
    assert users == ["root"]
    entries = browser.get("/api/v1/audit", headers=admin).json()["entries"]
    assert ("guest", "refused: no_role") in [(each["who"], each["outcome"]) for each in entries]


def test_who_loses_the_role_at_the_provider_loses_the_sessions_at_the_next_sign_in(
    browser, provider, app
):
    assert problem_of(sign_in(browser, "sub-mary")) == ""
    provider.set_claims("sub-mary", {"preferred_username": "mary", "groups": ["robot-admins"]})
    with new_browser(browser.base_url.port) as other:
        assert problem_of(sign_in(other, "sub-mary")) == ""
        assert me(other) == ["admin", "developer"]
        assert me(browser) == 401
        provider.set_claims("sub-mary", {"preferred_username": "mary", "groups": []})
        with new_browser(browser.base_url.port) as third:
            assert problem_of(sign_in(third, "sub-mary")) == "no_role"
        assert me(other) == 401


@pytest.mark.parametrize("changes", [{"groups": {"everybody": ["hall-a", "lift"]}}])
def test_who_signs_in_there_is_limited_to_the_groups_that_the_provider_gives(browser, provider):
    def groups_of(sub):
        assert problem_of(sign_in(browser, sub)) == ""
        return browser.get("/api/v1/me").json()["groups"]

    assert groups_of("sub-mary") == ["hall-a", "lift"]
    claims = {"preferred_username": "mary", "groups": ["robot-developers"]}
    provider.set_claims("sub-mary", claims)
    assert groups_of("sub-mary") == []
    provider.set_claims("sub-mary", claims | {"groups": ["robot-admins", "everybody"]})
    assert groups_of("sub-mary") is None


def test_groups_that_an_admin_gives_stay_and_limit_no_admin(browser, provider, app):
    assert problem_of(sign_in(browser, "sub-mary")) == ""
    with app.state.service.database.session() as session:
        set_groups(get_user(session, "mary"), ["hall-a"])
    assert problem_of(sign_in(browser, "sub-mary")) == ""
    assert browser.get("/api/v1/me").json()["groups"] == ["hall-a"]
    provider.set_claims("sub-mary", {"preferred_username": "mary", "groups": ["robot-admins"]})
    assert problem_of(sign_in(browser, "sub-mary")) == ""
    assert browser.get("/api/v1/me").json()["groups"] is None


def test_nobody_takes_the_name_of_a_local_user(browser, people):
    people.add_user("admin", "admin")
    assert problem_of(sign_in(browser, "sub-admin")) == "name_taken"
    assert me(browser) == 401


@pytest.mark.parametrize("name", ["rtron", "RTron", "ROOT"])
def test_nobody_is_called_as_the_service_or_another_user(browser, provider, people, name):
    admin, new = people.session_headers("root", "admin"), {"name": name, "roles": ["admin"]}
    provider.set_claims("sub-mary", {"preferred_username": name, "groups": ["robot-admins"]})
    assert problem_of(sign_in(browser, "sub-mary")) == "name_taken"
    answer = browser.post("/api/v1/users", headers=admin, json=new | {"password": PASSWORD})
    assert answer.status_code == 409


def test_a_name_that_cannot_be_one_here_is_refused(browser):
    assert problem_of(sign_in(browser, "sub-odd")) == "bad_name"


def test_who_is_disabled_here_stays_out(browser, app, people):
    people.add_user("root", "admin")
    assert problem_of(sign_in(browser, "sub-mary")) == ""
    with app.state.service.database.session() as session:
        set_disabled(session, get_user(session, "mary"), disabled=True)
    assert problem_of(sign_in(browser, "sub-mary")) == "disabled"
    assert me(browser) == 401


@pytest.mark.parametrize("password", ["", "nobody", "!", "None", PASSWORD])
def test_who_signs_in_there_has_no_password_here(browser, password):
    assert problem_of(sign_in(browser, "sub-mary")) == ""
    body = {"name": "mary", "password": password}
    assert browser.post("/api/v1/login", json=body).status_code == 401


def age_sessions(app, seconds):
    """Let all sessions have begun so much earlier."""
    with app.state.service.database.session() as session:
        begun = SessionRow.created - seconds * 1_000_000_000
        session.execute(update(SessionRow).values(created=begun))


def test_who_signs_in_there_enrols_codes_with_a_new_sign_in_alone(browser, app):
    def ask(password=""):
        headers = {"X-CSRF-Token": browser.get("/api/v1/me").json()["csrf"]}
        proof = browser.get(FACTOR).json()["proof"]
        answer = browser.post(FACTOR, json={"password": password}, headers=headers)
        return proof, answer.status_code, answer.json().get("error")

    assert problem_of(sign_in(browser, "sub-mary")) == ""
    age_sessions(app, 590)
    assert ask() == ("none", 200, None)
    age_sessions(app, 11)
    for password in ("", "nobody", PASSWORD):
        assert ask(password) == ("sign-in", 403, "the sign-in is too old for that")
    assert problem_of(sign_in(browser, "sub-mary")) == ""
    assert ask() == ("none", 200, None)
    age_sessions(app, -3600)  # the clock was set back
    assert ask()[:2] == ("sign-in", 403)


def test_an_admin_changes_neither_roles_nor_password_of_who_signs_in_there(browser, people):
    assert problem_of(sign_in(browser, "sub-mary")) == ""
    admin, url = people.session_headers("root", "admin"), "/api/v1/users/mary"
    for change in ({"roles": ["admin"]}, {"password": "another fine password"}):
        assert browser.patch(url, json=change, headers=admin).status_code == 409
    assert browser.patch(url, json={"disabled": True}, headers=admin).status_code == 200
    assert me(browser) == 401


def test_a_refusal_there_is_told(browser):
    answer = authorize(browser, "sub-mary", action="deny")
    assert problem_of(browser.get(CALLBACK, params=answer)) in ("refused", "expired")


@pytest.mark.parametrize("part", ["state", "nonce", "verifier"])
def test_an_answer_counts_only_in_the_browser_that_asked(browser, part):
    answer = authorize(browser, "sub-mary")
    state, nonce, verifier = browser.cookies["rtron-sign-in"].split(".")
    parts = {"state": state, "nonce": nonce, "verifier": verifier} | {part: "A" * 43}
    browser.cookies.clear()
    browser.cookies.set("rtron-sign-in", ".".join(parts.values()), domain="127.0.0.1")
    said = problem_of(browser.get(CALLBACK, params=answer))
    assert said == ("expired" if part == "state" else "failed")
    assert me(browser) == 401


@pytest.mark.parametrize("cookie", [None, "a.b", "..", "a.b.c.d"])
def test_without_a_begun_sign_in_nothing_is_asked(browser, provider, cookie):
    browser.cookies.clear()
    if cookie:
        browser.cookies.set("rtron-sign-in", cookie, domain="127.0.0.1")
    answer = browser.get(CALLBACK, params={"code": "x", "state": "y"})
    assert problem_of(answer) == "expired"
    assert provider.requests == []


@pytest.mark.parametrize("nonce", ["", "n", "A" * 43])
def test_a_stolen_answer_counts_in_no_other_browser_where_the_provider_checks_no_challenge(
    browser, provider, nonce
):
    provider.checks_challenge = False
    answer = authorize(browser, "sub-mary")
    with new_browser(browser.base_url.port) as thief:
        cookie = f"{answer['state']}.{nonce}.{'B' * 43}"
        thief.cookies.set("rtron-sign-in", cookie, domain="127.0.0.1")
        assert problem_of(thief.get(CALLBACK, params=answer)) in {"expired", "failed"}
        assert me(thief) == 401


def test_a_code_counts_once(browser):
    answer = authorize(browser, "sub-mary")
    cookie = browser.cookies["rtron-sign-in"]
    assert problem_of(browser.get(CALLBACK, params=answer)) == ""
    with new_browser(browser.base_url.port) as other:
        other.cookies.set("rtron-sign-in", cookie, domain="127.0.0.1")
        assert problem_of(other.get(CALLBACK, params=answer)) == "failed"


def test_an_answer_of_another_provider_is_refused(browser, provider):
    answer = authorize(browser, "sub-mary") | {"iss": "https://evil.example"}
    provider.requests.clear()
    assert problem_of(browser.get(CALLBACK, params=answer)) == "failed"
    assert provider.requests == []


def claims_of(token):
    payload = token.split(".")[1]
    return json.loads(base64.urlsafe_b64decode(payload + "=" * (-len(payload) % 4)))


def unsigned(token, **changes):
    claims = claims_of(token) | changes
    parts = [
        base64.urlsafe_b64encode(json.dumps(each).encode()).decode().rstrip("=")
        for each in ({"alg": "none", "typ": "JWT"}, claims)
    ]
    return f"{parts[0]}.{parts[1]}."


def signed_by_another(token, algorithm="RS256", **changes):
    key = RSAKey.generate_key(2048)
    return jwt.encode({"alg": algorithm}, claims_of(token) | changes, key)


def changed_payload(token, **changes):
    head, _, signature = token.split(".")
    body = base64.urlsafe_b64encode(json.dumps(claims_of(token) | changes).encode()).decode()
    return f"{head}.{body.rstrip('=')}.{signature}"


@pytest.mark.parametrize(
    "forge",
    [
        lambda token: "",
        lambda token: "not.a.token",
        lambda token: token[:-4],
        unsigned,
        signed_by_another,
        lambda token: changed_payload(token, groups=["robot-admins"]),
        lambda token: changed_payload(token, sub="sub-ada"),
    ],
    ids=["none", "garbage", "cut", "unsigned", "other key", "other groups", "other subject"],
)
def test_a_forged_id_token_gives_nothing(browser, provider, forge):
    provider.rewrite = lambda tokens: tokens | {"id_token": forge(tokens["id_token"])}
    assert problem_of(sign_in(browser, "sub-mary")) == "failed"
    assert me(browser) == 401


@pytest.mark.parametrize("changes", [{"client_id": "rtron"}])
def test_a_token_for_another_client_gives_nothing(browser, provider, app):
    app.state.oidc.client._config = config_for(provider, client_id="somebody-else")
    answer = authorize(browser, "sub-mary")
    app.state.oidc.client._config = config_for(provider)
    app.state.oidc.client._client_auth = lambda: httpx.BasicAuth("somebody-else", "")
    assert problem_of(browser.get(CALLBACK, params=answer)) == "failed"


def test_a_token_that_is_over_gives_nothing(browser, app):
    answer = authorize(browser, "sub-mary")
    service = app.state.service
    now = service.clock()
    object.__setattr__(service, "clock", lambda: now + 7200 * 1_000_000_000)
    assert problem_of(browser.get(CALLBACK, params=answer)) == "failed"


def test_a_provider_that_is_away_is_told(browser, app, provider):
    app.state.oidc.client._config = config_for(provider, issuer="http://localhost:1")
    assert problem_of(browser.get(LOGIN)) == "failed"


def test_strangers_do_not_fill_the_log_and_a_fault_is_told_once(
    browser, app, provider, caplog, monkeypatch
):
    monkeypatch.setattr(oidc, "_warnings", WarningThrottle())

    def told():
        return [each.getMessage() for each in caplog.records if each.name == oidc.__name__]

    for _ in range(5):
        browser.get(CALLBACK, params={"code": "x", "state": "y"})
    assert told() == []
    app.state.oidc.client._config = config_for(provider, issuer="http://localhost:1")
    for _ in range(5):
        assert problem_of(browser.get(LOGIN)) == "failed"
    (message,) = told()
    assert message.startswith("the sign-in at the provider fails: failed: GET http://localhost:1/")


class Guest:
    """The request of a browser in which nobody has logged in."""

    cookies: ClassVar = {}


def test_too_many_at_once_do_not_take_the_threads_nor_keep_users_out(browser, app):
    with new_browser(browser.base_url.port) as known, ExitStack() as strangers:
        assert problem_of(sign_in(known, "sub-mary")) == ""
        for _ in range(oidc.MAX_STRANGERS):
            strangers.enter_context(app.state.oidc.place(app.state.service, Guest))
        assert problem_of(browser.get(LOGIN)) == "busy"
        assert problem_of(sign_in(known, "sub-mary")) == ""
    assert problem_of(sign_in(browser, "sub-ada")) == ""


def test_half_a_login_is_logged_as_that(browser, app, people):
    assert problem_of(sign_in(browser, "sub-mary")) == ""
    with app.state.service.database.session() as session:
        key = begin_enrolment(session, 0, get_user(session, "mary"))
        code = code_at(key, step_at(app.state.service.clock()))
        confirm_enrolment(session, app.state.service.clock(), get_user(session, "mary"), code)
    with new_browser(browser.base_url.port) as other:
        assert problem_of(sign_in(other, "sub-mary")) == ""
        assert other.get("/api/v1/me").json()["stage"] == "code"
    admin = people.session_headers("root", "admin")
    entries = browser.get("/api/v1/audit", headers=admin).json()["entries"]
    assert [each["action"] for each in entries] == ["login, provider", "login"]


@pytest.mark.parametrize(
    ("changes", "stage"),
    [
        ({"second_factor_roles": frozenset({UserRole.DEVELOPER})}, "enrolment"),
        (
            {
                "second_factor_roles": frozenset({UserRole.DEVELOPER}),
                "provider_checks_second_factor": True,
            },
            "complete",
        ),
        ({"second_factor_roles": frozenset({UserRole.ADMIN})}, "complete"),
    ],
    ids=["required", "checked there", "of another role"],
)
def test_a_role_that_requires_a_code_requires_it_here_too(browser, stage):
    assert problem_of(sign_in(browser, "sub-mary")) == ""
    assert browser.get("/api/v1/me").json()["stage"] == stage


def test_without_a_provider_there_is_no_such_login(client):
    assert client.get("/api/v1/login/methods").json() == {"oidc": None}


@pytest.fixture
def client(tmp_path):
    app = create_app(ServiceConfig(database=tmp_path / "plain.db"))
    with serve_in_thread(app) as port, new_browser(port) as client:
        assert client.get(LOGIN).status_code == 404
        assert client.get(CALLBACK).status_code == 404
        yield client
