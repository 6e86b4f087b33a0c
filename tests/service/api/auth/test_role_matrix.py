"""Who may call what, for every route that there is, and everybody who may come."""

import re

import httpx
import pytest
from harness import LIMIT_S
from service_app import AccountFactory, ManualClock, serve_in_thread
from websockets.exceptions import InvalidStatus
from websockets.sync.client import connect

from rtron.service.config import ServiceConfig
from rtron.service.server.app import create_app

ROLES = ("admin", "developer", "end_user")
SCOPES = ("guard", "metrics", "read", "end_user", "developer", "admin")
SESSIONS = {f"session {role}" for role in ROLES}
TOKENS = {f"token {scope}" for scope in SCOPES}
EVERYBODY = {"nobody"} | SESSIONS | TOKENS

KNOWN = SESSIONS | TOKENS
MEMBERS = SESSIONS | {f"token {role}" for role in ROLES}
READERS = MEMBERS | {"token read"}
MEASURERS = READERS | {"token metrics"}
DEVELOPERS = {"session developer", "token developer"}
ADMINS = {"session admin", "token admin"}

ALLOWED = {
    "GET /healthz": EVERYBODY,
    "GET /readyz": EVERYBODY,
    "GET /readyz/read": EVERYBODY,
    "GET /metrics": MEASURERS,
    "POST /api/v1/login": EVERYBODY,
    "POST /api/v1/login/code": set(),
    "GET /api/v1/login/methods": EVERYBODY,
    "GET /api/v1/login/oidc": EVERYBODY,
    "GET /api/v1/login/oidc/callback": EVERYBODY,
    "POST /api/v1/logout": SESSIONS,
    "GET /api/v1/me": KNOWN,
    "POST /api/v1/me/password": SESSIONS,
    "GET /api/v1/me/second-factor": SESSIONS,
    "POST /api/v1/me/second-factor": SESSIONS,
    "POST /api/v1/me/second-factor/confirmation": SESSIONS,
    "DELETE /api/v1/me/second-factor": SESSIONS,
    "GET /api/v1/robots": READERS,
    "GET /api/v1/robots/{robot}": READERS,
    "GET /api/v1/robots/{robot}/plan": READERS,
    "GET /api/v1/robots/{robot}/graph": READERS,
    "PUT /api/v1/robots/{robot}/graph": DEVELOPERS,
    "GET /api/v1/robots/{robot}/risks": READERS,
    "GET /api/v1/robots/{robot}/nodes": READERS,
    "GET /api/v1/robots/{robot}/nodes/{node}": READERS,
    "GET /api/v1/robots/{robot}/settings": READERS,
    "GET /api/v1/robots/{robot}/settings/history": READERS,
    "PATCH /api/v1/robots/{robot}/settings": MEMBERS,
    "POST /api/v1/robots/{robot}/nodes/{node}/override": MEMBERS,
    "DELETE /api/v1/robots/{robot}/nodes/{node}/override": MEMBERS,
    "POST /api/v1/robots/{robot}/stop": MEMBERS,
    "DELETE /api/v1/robots/{robot}/stop": MEMBERS,
    "POST /api/v1/robots/stop": MEMBERS,
    "GET /api/v1/acknowledgements": READERS,
    "POST /api/v1/acknowledgements": MEMBERS,
    "GET /api/v1/handovers": READERS,
    "POST /api/v1/handovers": MEMBERS,
    "POST /api/v1/robots/{robot}/settings/restore": MEMBERS,
    "GET /api/v1/export/robots": READERS,
    "POST /api/v1/export/robots": READERS,
    "GET /api/v1/export/events": READERS,
    "GET /api/v1/export/settings": READERS,
    "GET /api/v1/export/acknowledgements": READERS,
    "GET /api/v1/export/handovers": READERS,
    "GET /api/v1/robots/{robot}/leases": READERS,
    "POST /api/v1/robots/{robot}/leases/{lease}": {"session developer", "session end_user"},
    "GET /api/v1/robots/{robot}/requests": READERS,
    "POST /api/v1/robots/{robot}/requests/{digest}": {"session developer", "session end_user"},
    "GET /api/v1/robots/{robot}/figures": READERS,
    "PUT /api/v1/robots/{robot}/labels": ADMINS,
    "GET /api/v1/groups": READERS,
    "GET /api/v1/groups/{group}": READERS,
    "PUT /api/v1/groups/{group}": ADMINS,
    "GET /api/v1/rollouts": READERS,
    "POST /api/v1/rollouts": MEMBERS,
    "GET /api/v1/rollouts/{rollout}": READERS,
    "GET /api/v1/rollouts/{rollout}/robots": READERS,
    "POST /api/v1/rollouts/{rollout}/pause": MEMBERS,
    "POST /api/v1/rollouts/{rollout}/resume": MEMBERS,
    "POST /api/v1/rollouts/{rollout}/cancel": MEMBERS,
    "GET /api/v1/events": READERS,
    "GET /api/v1/incidents": READERS,
    "GET /api/v1/robots/{robot}/incidents/{incident}": READERS,
    "GET /api/v1/audit": ADMINS | DEVELOPERS,
    "GET /api/v1/users": ADMINS,
    "POST /api/v1/users": ADMINS,
    "PATCH /api/v1/users/{user}": ADMINS,
    "DELETE /api/v1/users/{user}": ADMINS,
    "DELETE /api/v1/users/{user}/second-factor": ADMINS,
    "GET /api/v1/tokens": ADMINS,
    "POST /api/v1/tokens": ADMINS,
    "POST /api/v1/tokens/renewal": TOKENS - {"token guard"},
    "DELETE /api/v1/tokens/{token}": ADMINS,
    "GET /api/v1/approvals": ADMINS,
    "POST /api/v1/approvals/{id}": ADMINS,
    "DELETE /api/v1/approvals/{id}": ADMINS,
    "GET /api/v1/webhooks": ADMINS,
    "POST /api/v1/webhooks": ADMINS,
    "DELETE /api/v1/webhooks/{webhook}": ADMINS,
}
CHANGES = sorted(each for each in ALLOWED if not each.startswith("GET") and "login" not in each)
SOCKETS = {"/api/v1/live": READERS, "/link/v1": {"token guard"}}
NOT_IN_THE_API = {"/openapi.json", "/", "/console/{version}/{name:path}"}


@pytest.fixture(scope="module")
def site(tmp_path_factory):
    config = ServiceConfig(database=tmp_path_factory.mktemp("matrix") / "rtron.db")
    app = create_app(config, ManualClock())
    with (
        serve_in_thread(app) as port,
        httpx.Client(base_url=f"http://127.0.0.1:{port}", timeout=LIMIT_S) as client,
    ):
        yield client, AccountFactory(app.state.service), app


@pytest.fixture(scope="module")
def tokens(site):
    people = site[1]
    robots = {"guard": "car1"}
    return {scope: people.token_headers(scope, scope, robot=robots.get(scope)) for scope in SCOPES}


@pytest.fixture
def headers(site, tokens):
    """Return the headers of somebody; each browser has a session of its own."""

    def of(who):
        kind, _, word = who.partition(" ")
        if kind == "nobody":
            return {}
        return tokens[word] if kind == "token" else site[1].session_headers(f"the-{word}", word)

    return of


def operations(app):
    return {
        f"{method.upper()} {path}"
        for path, item in app.openapi()["paths"].items()
        for method in item
    }


def routes(router, prefix=""):
    """Yield the path and the kind of every route, of routers within routers too."""
    for route in router.routes:
        if hasattr(route, "path"):
            yield prefix + route.path, type(route).__name__
        else:
            yield from routes(route.original_router, prefix + (route.include_context.prefix or ""))


def test_every_route_has_an_entry(site):
    app = site[2]
    assert operations(app) == set(ALLOWED)
    found = set(routes(app))
    sockets = {path for path, kind in found if "WebSocket" in kind}
    assert sockets == set(SOCKETS)
    paths = {operation.partition(" ")[2] for operation in ALLOWED}
    assert {path for path, _ in found} - sockets - paths == NOT_IN_THE_API


@pytest.mark.parametrize("who", sorted(EVERYBODY))
@pytest.mark.parametrize("operation", sorted(ALLOWED))
def test_who_may_call_what(site, headers, operation, who):
    status = _called(site[0], operation, headers(who))
    if who in ALLOWED[operation]:
        assert status not in {401, 403, 405, 500}
    else:
        assert status == (401 if who == "nobody" else 403)


@pytest.mark.parametrize("given", [{}, {"X-CSRF-Token": ""}, {"X-CSRF-Token": "x" * 43}])
@pytest.mark.parametrize("operation", CHANGES)
def test_no_change_without_the_csrf_token(site, headers, operation, given):
    for role in ROLES:
        cookie = {"Cookie": headers(f"session {role}")["Cookie"]}
        assert _called(site[0], operation, cookie | given) == 403


@pytest.mark.parametrize("who", sorted(EVERYBODY))
@pytest.mark.parametrize("path", sorted(SOCKETS))
def test_who_may_open_which_socket(site, headers, path, who):
    place = site[0].base_url.netloc.decode()
    given = {"origin": f"http://{place}", "additional_headers": headers(who), "proxy": None}
    given["open_timeout"] = LIMIT_S
    if who in SOCKETS[path]:
        with connect(f"ws://{place}{path}", **given):
            return
    with pytest.raises(InvalidStatus) as refused, connect(f"ws://{place}{path}", **given):
        pass
    assert refused.value.response.status_code in {401, 403}


def _called(client, operation, headers):
    """Call it with names that nobody has and an empty object, so that nothing is changed."""
    method, _, path = operation.partition(" ")
    path = (
        path.replace("{webhook}", "999")
        .replace("{rollout}", "999")
        .replace("{id}", "999")
        .replace("{node}", "none")
    )
    path = re.sub(r"\{\w+\}", "nobody.x", path)
    client.cookies.clear()
    return client.request(
        method, path, headers=headers, json={} if method != "GET" else None
    ).status_code
