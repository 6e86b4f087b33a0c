"""The routes of robots and graphs, over HTTP in this process."""

import json
from contextlib import ExitStack
from dataclasses import replace

import httpx
import pytest
from controller_setup import hello, plan
from harness import LIMIT_S
from service_app import TLS, FakeLink, serve_in_thread

from rtron.service.api.routes import exports
from rtron.service.config import ServiceConfig
from rtron.service.controller import graphs
from rtron.service.domain.principal import AccessScope
from rtron.service.server.app import create_app
from rtron.service.store.accounts.tokens import TokenSpec, create_token
from rtron.service.store.events import EventBatch, add_events
from rtron.service.store.robots import find_robot
from rtron.vocabulary import (
    Alarm,
    AlarmKind,
    Decision,
    EventKind,
    GuardEvent,
    GuardState,
    PolicyName,
)
from rtron.wire.common.link_protocol import Applied

ROBOT = "/api/v1/robots/r2"


@pytest.fixture
def service(database_file):
    app = create_app(ServiceConfig(database=database_file))
    found = app.state.service
    found.controller.handle_hello("r2", hello(plan()))
    yield found, app
    found.database.close()


@pytest.fixture
def parts(service):
    return service[0]


@pytest.fixture
def tokens(parts):
    """The secret of a token for each scope."""
    made = {}
    with parts.database.session() as session:
        for scope in AccessScope:
            robot = "r2" if scope is AccessScope.GUARD else None
            wish = TokenSpec(name=scope.value, scopes=[scope], robot=robot)
            made[scope.value] = create_token(session, parts.clock(), "test", wish)[1]
    return made


@pytest.fixture
def call(service, tokens):
    """Call a path below the robot's as somebody, and return the status and the JSON."""

    def call(method, path="", *, who="developer", base=ROBOT, **keys):
        headers = {"Authorization": f"Bearer {tokens[who]}"}
        answer = client.request(method, base + path, headers=headers, **keys)
        return answer.status_code, answer.json()

    with (
        serve_in_thread(service[1]) as port,
        httpx.Client(base_url=f"http://127.0.0.1:{port}", timeout=LIMIT_S, verify=TLS) as client,
    ):
        yield call


ROBOT_OF = {"settings": {"robot": "r2"}}


@pytest.fixture
def client_of(service, tokens):
    """Return the client of somebody by a scope."""
    with serve_in_thread(service[1]) as port, ExitStack() as clients:

        def client(who):
            headers = {"Authorization": f"Bearer {tokens[who]}"}
            url = f"http://127.0.0.1:{port}"
            return clients.enter_context(
                httpx.Client(base_url=url, headers=headers, timeout=LIMIT_S, verify=TLS)
            )

        yield client


def test_robots_in_short(call, parts):
    link = FakeLink()
    parts.hub.register("r2", link, dry_run=True)
    parts.hub.add_lost_events("r2", 3)
    parts.hub.set_state("r2", link, GuardState(at=5, revision=0))
    parts.controller.handle_hello("a1", hello(plan(), app="other"))
    status, (a1, r2) = call("GET", base="/api/v1/robots", who="read")
    assert (status, a1["name"], a1["app"], a1["connected"], a1["state"]) == (
        200,
        "a1",
        "other",
        False,
        None,
    )
    assert r2 == call("GET")[1]
    assert (r2["connected"], r2["dry_run"], r2["dropped"], r2["state"]["at"]) == (True, True, 3, 5)
    assert (r2["revision"], r2["outcome"], r2["stop"], r2["ros"]) == (0, "pending", None, 1)


def test_robots_are_paged_and_filtered(call, parts):
    for name in ("a1", "a2", "b1"):
        parts.controller.handle_hello(name, hello(plan(), app="other"))
    parts.hub.register("a2", FakeLink(), dry_run=False)

    def names(**query):
        status, robots = call("GET", base="/api/v1/robots", who="read", params=query)
        assert status == 200
        return [robot["name"] for robot in robots]

    assert names() == ["a1", "a2", "b1", "r2"]
    assert names(limit=2) == ["a1", "a2"]
    assert names(limit=2, after="a2") == ["b1", "r2"]
    assert names(text="1") == ["a1", "b1"]
    assert names(text="%") == []
    assert names(app="small") == ["r2"]
    assert names(connected=True) == ["a2"]
    assert names(connected=False) == ["a1", "b1", "r2"]
    assert call("GET", base="/api/v1/robots", who="read", params={"limit": 0})[0] == 422
    assert call("GET", base="/api/v1/robots", who="read", params={"page": 2})[0] == 422


def test_robots_without_their_states(call, parts):
    link = FakeLink()
    alarm = Alarm(kind=AlarmKind.DRIFT, reason="it is another node")
    parts.hub.register("r2", link, dry_run=False)
    state = GuardState(at=5, revision=0, alarms=(alarm,), overridden=("speed",), stopped=True)
    parts.hub.set_state("r2", link, state)
    query = {"states": False}
    _, (robot,) = call("GET", base="/api/v1/robots", who="read", params=query)
    assert "state" not in robot
    assert [each["reason"] for each in robot["alarms"]] == ["it is another node"]
    assert (robot["overridden"], robot["stopped"]) == (["speed"], True)


def test_many_robots_are_stopped_at_once(call, parts):
    parts.controller.handle_hello("a1", hello(plan()))
    link = FakeLink()
    parts.hub.register("a1", link, dry_run=False)
    body = {"robots": ["r2", "a1", "nobody", "a1"], "reason": "smoke"}
    status, result = call("POST", base="/api/v1/robots/stop", who="end_user", json=body)
    assert (status, result["sent"], result["waiting"]) == (200, ["a1"], ["r2"])
    assert result["failed"] == {"nobody": "there is no such robot"}
    assert link.settings.stop.reason == "smoke"
    assert call("GET")[1]["stop"]["by"] == "token:end_user"


@pytest.mark.parametrize("robots", [[], [f"r{n}" for n in range(1001)], ["\u202e"], "r2"])
def test_stops_of_what_is_no_list_of_robots_are_refused(call, robots):
    assert call("POST", base="/api/v1/robots/stop", json={"robots": robots})[0] == 422


def test_a_page_of_robots_leads_to_the_next(service, tokens):
    controller = service[0].controller
    for name in ("a1", "b&1"):
        controller.handle_hello(name, hello(plan(), app="other"))
    headers = {"Authorization": f"Bearer {tokens['read']}"}
    path, names = "/api/v1/robots?limit=1", []
    with serve_in_thread(service[1]) as port, httpx.Client(timeout=LIMIT_S, verify=TLS) as client:
        url = httpx.URL(f"http://127.0.0.1:{port}{path}")
        while url:
            answer = client.get(url, headers=headers)
            names += [robot["name"] for robot in answer.json()]
            link = answer.links.get("next")
            url = url.join(link["url"]) if link else None
    assert names == ["a1", "b&1", "r2"]


def test_a_change_goes_to_the_guard_that_is_connected(call, parts):
    link = FakeLink()
    parts.hub.register("r2", link, dry_run=False)
    change = {"revision": 0, "nodes": {"drive": {"policy": "Block"}}, "reason": "why"}
    status, view = call("PATCH", "/settings", json=change)
    assert (status, view["revision"], view["by"]) == (200, 1, "token:developer")
    assert link.settings.nodes["drive"].policy is PolicyName.BLOCK
    parts.controller.handle_applied("r2", Applied(revision=1))
    assert call("GET", "/settings", who="read")[1]["outcome"] == "applied"
    assert call("GET")[1]["outcome"] == "applied"


def test_the_one_who_was_overtaken_is_told_the_newest(call):
    change = {"revision": 0, "nodes": {"drive": {"policy": "Block"}}, "reason": "why"}
    view = call("PATCH", "/settings", json=change)[1]
    status, told = call("PATCH", "/settings", json=change)
    assert (status, told["newest"]) == (409, view)
    assert told["error"] == "the settings are at revision 1, made by token:developer"


@pytest.mark.parametrize(
    ("change", "status"),
    [
        ({"revision": 0, "nodes": {"drive": {"polcy": 1}}}, 422),
        ({"revision": 0, "nodes": {"drive": None}}, 422),
        ({"revision": -1, "nodes": {}}, 422),
        ({"revision": 1 << 53, "nodes": {}}, 422),
        ({"revision": 0, "nodes": {}, "more": 1}, 422),
        ({"revision": 0, "nodes": {}, "reason": "r" * 201}, 422),
        ({"revision": 0, "nodes": {"speed": {"policy": "Block"}}}, 403),
        ({"revision": 5, "nodes": {}}, 409),
        ({"revision": 0, "nodes": {}}, 200),
    ],
)
def test_a_change_and_its_status(call, change, status):
    assert call("PATCH", "/settings", json={"reason": "why", **change})[0] == status


@pytest.mark.parametrize(
    "reason", [{}, {"reason": ""}, {"reason": " \u200b\u200b\u200b "}, {"reason": "ok"}]
)
def test_a_client_that_gives_no_reason_is_told_what_to_give(call, reason):
    change = {"revision": 0, "nodes": {"drive": {"policy": "Block"}}, **reason}
    status, told = call("PATCH", "/settings", json=change)
    assert (status, told["error"]) == (422, "a change of settings needs a reason")
    assert "`reason`, in at least 3 characters" in told["help"]
    assert call("GET", "/settings")[1]["revision"] == 0
    override = {"duration": 60, "reason": "docking"}
    call("POST", "/nodes/speed/override", json=override, who="end_user")
    keys = {"json": reason} if reason else {}
    status, told = call("DELETE", "/nodes/speed/override", **keys)
    assert (status, told["error"]) == (422, "the end of an override needs a reason")
    assert call("GET", "/nodes/speed")[1]["override"]["reason"] == "docking"


@pytest.mark.parametrize("body", [None, {}, {"reason": ""}, {"reason": "\u200b\u200b\u200b"}])
def test_a_stop_is_never_refused_for_want_of_a_reason_and_says_that_there_is_none(call, body):
    status, view = call("POST", "/stop", **({} if body is None else {"json": body}))
    assert (status, view["reason"]) == (200, "no reason given")
    assert view["settings"]["stop"]["reason"] == "no reason given"
    body = {"robots": ["r2"], **(body or {})}
    assert call("POST", base="/api/v1/robots/stop", json=body)[1]["failed"] == {}
    assert call("GET")[1]["stop"]["reason"] == "no reason given"


def test_the_history_is_paged(call):
    for revision in range(5):
        priority = {"drive": {"flows": {"flow1": {"priority": 10 + revision}}}}
        call("PATCH", "/settings", json={"revision": revision, "nodes": priority, "reason": "why"})
    page = call("GET", "/settings/history?limit=2")[1]
    assert [view["revision"] for view in page] == [5, 4]
    page = call("GET", "/settings/history?limit=200&before=4")[1]
    assert [view["revision"] for view in page] == [3, 2, 1, 0]
    assert call("GET", "/settings/history?limit=0")[0] == 422


def change(call, revision, **node):
    body = {"revision": revision, "nodes": {"drive": node}, "reason": "a test"}
    status, view = call("PATCH", "/settings", json=body)
    assert status == 200
    return view


def restore(call, revision, restored, **keys):
    body = {"revision": revision, "restored": restored, "reason": "as before"}
    return call("POST", "/settings/restore", json=body, **keys)


def test_any_revision_is_restored_as_a_new_one(call):
    change(call, 0, policy="Block")
    change(call, 1, policy=None, flows={"flow1": {"priority": 9}})
    assert call("POST", "/stop", json={"reason": "smoke"})[0] == 200
    status, view = restore(call, 3, 1)
    assert (status, view["revision"], view["reason"]) == (200, 4, "as before")
    assert view["settings"]["nodes"]["drive"]["policy"] == "Block"
    assert view["settings"]["nodes"]["drive"]["flows"] == {}
    assert view["settings"]["stop"]["reason"] == "smoke"
    status, view = restore(call, 4, 0)
    assert (status, view["settings"]["nodes"]) == (200, {})


def test_a_restore_needs_the_newest_revision_and_one_that_there_was(call):
    change(call, 0, policy="Block")
    status, conflict = restore(call, 0, 0)
    assert (status, conflict["newest"]["revision"]) == (409, 1)
    assert restore(call, 1, 7)[0] == 404
    body = {"revision": 1, "restored": 0, "reason": ""}
    assert call("POST", "/settings/restore", json=body)[0] == 422


def test_a_restore_takes_the_rights_of_the_change_that_it_is(call):
    change(call, 0, policy="Block")
    assert restore(call, 1, 0, who="end_user")[0] == 403
    assert restore(call, 1, 0, who="read")[0] == 403
    assert call("GET", "/settings")[1]["revision"] == 1


def test_what_does_not_fit_the_plan_any_more_is_not_restored(call, parts):
    change(call, 0, flows={"flow1": {"priority": 9}})
    without = replace(plan(), grcn=(replace(plan().grcn[0], flows=plan().grcn[0].flows[1:]),))
    parts.controller.handle_hello("r2", hello(without))
    revision = call("GET", "/settings")[1]["revision"]
    status, problem = restore(call, revision, 1)
    assert status == 422
    assert "flow1" in problem["error"]
    assert call("GET", "/settings")[1]["revision"] == revision


@pytest.mark.parametrize("format", ["csv", "json"])
@pytest.mark.parametrize("what", ["robots", "events", "settings", "acknowledgements", "handovers"])
def test_everything_is_exported(client_of, what, format):
    answer = client_of("read").get(
        f"/api/v1/export/{what}", params={"format": format, **ROBOT_OF.get(what, {})}
    )
    assert answer.status_code == 200
    assert answer.headers["content-disposition"].startswith('attachment; filename="rtron-')
    lines = answer.text.splitlines()
    assert json.loads(answer.text) is not None if format == "json" else '","' in lines[0]


def test_chosen_robots_are_exported_in_their_order(client_of, parts):
    for name in ("a1", "b1", "c1"):
        parts.controller.handle_hello(name, hello(plan(), app="=other"))
    client, path = client_of("read"), "/api/v1/export/robots"
    body = {"robots": ["r2", "b1", "nobody", "a1", "r2"]}
    rows = client.post(path, json={**body, "format": "json"}).json()
    assert [row["name"] for row in rows] == ["r2", "b1", "a1"]
    assert rows == [
        {key: value for key, value in row.items() if key != "state"}
        for row in (client.get(f"/api/v1/robots/{name}").json() for name in ("r2", "b1", "a1"))
    ]
    answer = client.post(path, json=body)
    assert answer.headers["content-disposition"] == 'attachment; filename="rtron-robots.csv"'
    assert [line.split(",")[0] for line in answer.text.splitlines()[1:]] == ['"r2"', '"b1"', '"a1"']
    assert '"\'=other"' in answer.text
    assert client.post(path, json={"robots": [], "format": "json"}).json() == []
    for odd in ({"robots": ["\u202e"]}, {"robots": "r2"}, {}, {"robots": ["r"] * 10_001}):
        assert client.post(path, json=odd).status_code == 422


def test_exported_events_fit_the_filter_and_are_all_of_them(client_of, parts, monkeypatch):
    monkeypatch.setattr(exports, "_PAGE", 7)
    with parts.database.session() as session:
        robot, _ = find_robot(session, "r2")
        events = [
            GuardEvent(run="a", number=n, at=n, kind=EventKind.OWNER, reason=f"=event {n}")
            for n in range(1, 31)
        ]
        add_events(session, parts.clock(), [EventBatch(robot.id, "r2", events)])
    query = {"format": "json", "robot": "r2", "until": 21}
    rows = client_of("read").get("/api/v1/export/events", params=query).json()
    assert [row["at"] for row in rows] == list(range(20, 0, -1))
    text = client_of("read").get("/api/v1/export/events", params={"robot": "r2"}).text
    assert text.count("'=event") == 30
    query = {"format": "json", "robot": "nobody"}
    assert client_of("read").get("/api/v1/export/events", params=query).json() == []
    assert client_of("read").get("/api/v1/export/events", params={"page": 1}).status_code == 422


def test_overrides_and_the_stop(call):
    path = "/nodes/speed/override"
    body = {"duration": 60, "reason": "docking"}
    assert call("POST", path, json=body, who="end_user")[0] == 200
    assert call("GET", "/nodes/speed")[1]["override"]["reason"] == "docking"
    assert call("DELETE", path, json={"reason": "docked"})[1]["settings"]["overrides"] == {}
    assert call("POST", path, json={"duration": 3601, "reason": "docking"})[0] == 422
    assert call("POST", path, json=body, who="admin")[0] == 403
    assert call("POST", "/nodes/nothing/override", json=body)[0] == 404
    assert call("POST", "/stop", who="admin")[1]["settings"]["stop"]["by"] == "token:admin"
    assert call("GET")[1]["stop"]["by"] == "token:admin"
    revision = call("GET")[1]["revision"]
    for short in ({"reason": "", "revision": revision}, {"reason": "all clear"}, {"revision": 1}):
        assert call("DELETE", "/stop", json=short)[0] == 422
    call("POST", "/stop", json={"reason": "me too"}, who="end_user")
    body = {"reason": "all clear", "revision": revision}
    status, said = call("DELETE", "/stop", json=body, who="admin")
    assert (status, said["newest"]["revision"]) == (409, revision + 1)
    assert said["newest"]["settings"]["stop"]["reason"] == "me too"
    body["revision"] += 1
    assert call("DELETE", "/stop", json=body)[1]["settings"]["stop"] is None


def test_a_node_has_what_the_console_shows(call):
    status, node = call("GET", "/nodes/speed", who="end_user")
    assert status == 200
    assert (node["id"], node["type"], node["mode"]) == ("speed", "RSRCN", "enforce")
    assert node["topics"] == ["/max_vel"]
    assert node["policies"] == ["Block", "Safe", "Constrain", "Safe+Constrain"]
    assert node["rights"] == ["override", "select_policy", "set_max_vel_limit"]
    assert call("GET", "/nodes/speed", who="read")[1]["rights"] == []
    limit = {"speed": {"max_vel_limit": 0.3}}
    call(
        "PATCH", "/settings", json={"revision": 0, "nodes": limit, "reason": "why"}, who="end_user"
    )
    node = call("GET", "/nodes/speed")[1]
    found = [node[key]["max_vel_limit"] for key in ("plan", "effective", "settings")]
    assert found == [0.5, 0.3, 0.3]
    assert call("GET", "/nodes")[1][1] == node


def test_policies_that_would_deselect_a_mandatory_one_are_not_offered(call, parts):
    from controller_setup import plan_with  # noqa: PLC0415 - only here

    given = plan_with("policy: Safe", "policy: Safe\n  mandatory: Safe")
    parts.controller.handle_hello("r2", hello(given))
    node = call("GET", "/nodes/speed")[1]
    assert (node["policies"], node["mandatory"]) == (["Safe", "Safe+Constrain"], ["Safe"])


def violate(parts, node, **keys):
    event = GuardEvent(
        **{
            "run": "r1",
            "number": 1,
            "at": 77,
            "kind": EventKind.VERDICT,
            "decision": Decision.DROP,
            "node": node,
            "topic": "/cmd_vel",
            **keys,
        }
    )
    with parts.database.session() as session:
        robot = find_robot(session, "r2")[0]
        add_events(session, parts.clock(), [EventBatch(robot.id, "r2", [event])])


@pytest.mark.parametrize(
    ("node", "keys", "rule", "cause", "details"),
    [
        (
            "drive",
            {"flow": "unapproved", "publisher": "/evil", "reason": "not approved"},
            "only the publishers that the plan names may speak on /cmd_vel",
            "/evil on /cmd_vel",
            "drop: not approved (settings 0)",
        ),
        (
            "drive",
            {"flow": "flow2", "reason": "flow1 has it", "revision": 4},
            "Preemption on /cmd_vel: the highest priority that speaks controls it",
            "flow2 on /cmd_vel",
            "drop: flow1 has it (settings 4)",
        ),
        (
            "speed",
            {"publisher": "/lane", "topic": "/max_vel", "decision": Decision.MODIFY},
            "Safe: at most 0.02 m a frame",
            "/lane on /max_vel",
            "modify (settings 0)",
        ),
        (
            "mission",
            {"publisher": "/user", "topic": "/goal", "reason": "rule quiet: night is 1"},
            "quiet: night",
            "/user on /goal",
            "drop: rule quiet: night is 1 (settings 0)",
        ),
    ],
)
def test_the_last_violation_in_the_papers_words(call, parts, node, keys, rule, cause, details):
    violate(parts, node, **keys)
    shown = call("GET", f"/nodes/{node}")[1]
    assert shown["trigger_time"] == 77
    assert shown["violated_rule"] == rule
    assert shown["violation_cause"] == cause
    assert shown["violation_details"] == details


def test_without_a_violation_there_is_none(call):
    shown = call("GET", "/nodes/drive")[1]
    assert (shown["trigger_time"], shown["violated_rule"]) == (None, "")


@pytest.mark.parametrize(
    "path",
    ["", "/plan", "/nodes", "/nodes/drive", "/settings", "/settings/history", "/graph", "/risks"],
)
def test_an_unknown_robot_is_not_found(call, path):
    assert call("GET", path, base="/api/v1/robots/r9")[0] == 404
    assert call("GET", path, base="/api/v1/robots/..%2Fr2")[0] in (404, 422)


def test_a_robot_without_an_app(call, parts):
    from rtron.service.store.robots import register_robot  # noqa: PLC0415 - only here

    with parts.database.session() as session:
        register_robot(session, "bare", 5)
    base = "/api/v1/robots/bare"
    assert call("GET", base=base)[1]["app"] is None
    assert call("GET", "/settings", base=base)[0] == 404
    assert call("POST", "/stop", base=base)[0] == 404


def test_the_plan_is_as_the_guard_says_it(call):
    assert call("GET", "/plan")[1]["grcn"][0]["flows"][0]["name"] == "flow1"


# Graphs.

END = {"topic": "/cmd_vel", "type": "geometry_msgs/Twist"}
GRAPH = {
    "schema": "rtron.graph/1",
    "app": "small",
    "endpoints": [
        {"node": "/teleop", "direction": "publish", **END},
        {"node": "/evil", "direction": "publish", **END},
        {"node": "/base", "direction": "subscribe", **END},
    ],
}


def test_without_an_upload_the_plan_tells_the_graph(call):
    page = call("GET", "/graph", who="read")[1]
    assert (page["source"], page["uploaded"], page["by"]) == ("plan", None, "")
    names = [node["name"] for node in page["nodes"]]
    assert {"/teleop", "/planner", "/base", "/lane", "/signs"} <= set(names)
    assert [each["kind"] for each in page["coordination"]] == [
        "GRCN",
        "fps_monitor",
        "RSRCN",
        "MSRCN",
    ]
    topics = {topic["name"]: topic for topic in page["topics"]}
    assert topics["/cmd_vel"]["domain"] == "Control"
    risks = call("GET", "/risks")[1]
    assert (risks["source"], risks["inventory"], risks["unguarded"]) == ("plan", [], [])


def test_an_uploaded_graph_is_shown_with_its_risks(call):
    status, risks = call("PUT", "/graph", json=GRAPH)
    assert (status, risks["schema"]) == (200, "rtron.risks/2")
    page = call("GET", "/graph")[1]
    assert (page["source"], page["by"]) == ("uploaded", "token:developer")
    assert "/evil" in [node["name"] for node in page["nodes"]]
    shown = call("GET", "/risks", who="read")[1]
    assert shown == {"source": "uploaded", "unguarded": [], **risks}
    (base,) = shown["inventory"]
    assert (base["thing"], base["drivers"]) == ("base", ["/base"])
    assert "/base obeys /cmd_vel" in [row["text"] for row in base["rows"]]
    node = call("GET", "/nodes/drive")[1]
    (risk,) = [risk for risk in node["risk_information"]["risks"] if risk["kind"] == "GR-ST"]
    assert risk["role_nodes"]["publisher"] == ["/evil", "/teleop"]


def test_what_moves_the_robot_past_the_plan_is_told(call):
    motors = {"node": "/base", "name": "/enable_motors", "type": "std_srvs/SetBool"}
    call("PUT", "/graph", json=GRAPH | {"services": [motors]})
    (open_way,) = call("GET", "/risks")[1]["unguarded"]
    assert open_way["thing"] == "arming"
    assert open_way["why"].startswith("/enable_motors: a plan cannot guard services")


def test_a_second_upload_replaces_the_first(call):
    call("PUT", "/graph", json=GRAPH)
    quiet = {"schema": "rtron.graph/1", "app": "quiet"}
    assert call("PUT", "/graph", json=quiet)[1]["risks"] == []
    assert call("GET", "/risks")[1]["risks"] == []


def test_risks_stay_under_a_new_plan(call, parts):
    from controller_setup import plan_with  # noqa: PLC0415 - only here

    call("PUT", "/graph", json=GRAPH)
    parts.controller.handle_hello("r2", hello(plan_with("id: drive", "id: wheels")))
    risks = call("GET", "/nodes/wheels")[1]["risk_information"]["risks"]
    assert "GR-ST:/cmd_vel" in [risk["id"] for risk in risks]


@pytest.mark.parametrize(
    ("body", "told"),
    [
        (b"", "not JSON"),
        (b"[1, 2", "not JSON"),
        (b"[]", "the document"),
        (b'{"schema": "rtron.plan/1"}', "schema"),
        (b'{"schema": "rtron.graph/1", "nodse": []}', "nodse"),
    ],
)
def test_a_graph_that_is_none(call, body, told):
    status, problem = call("PUT", "/graph", content=body)
    assert status == 422
    assert told in problem["error"]
    entry = call("GET", "/audit", base="/api/v1", who="admin")[1]["entries"][0]
    assert (entry["action"], entry["outcome"][:9]) == ("graph", "refused: ")


def test_graphs_are_bounded(call, monkeypatch):
    monkeypatch.setattr(graphs, "MAX_ENDPOINTS", 5)
    assert call("PUT", "/graph", json=GRAPH)[0] == 422
    monkeypatch.setattr(graphs, "MAX_ENDPOINTS", 6)
    assert call("PUT", "/graph", json=GRAPH)[0] == 200
    monkeypatch.setattr(graphs, "MAX_RISKS", 0)
    assert call("PUT", "/graph", json=GRAPH)[0] == 422


def test_a_name_that_no_database_holds_is_refused(call):
    ends = [{**end, "topic": "/" + "t" * 300} for end in GRAPH["endpoints"]]
    assert call("PUT", "/graph", json={**GRAPH, "endpoints": ends})[0] == 422


def test_hostile_names_are_only_names(call):
    name = "/<script>alert(1)</script>\u202e"
    ends = [{**end, "node": name} for end in GRAPH["endpoints"]]
    assert call("PUT", "/graph", json={**GRAPH, "endpoints": ends})[0] == 200
    page = call("GET", "/graph")[1]
    assert "/<script>alert(1)</script>\\u202e" in [node["name"] for node in page["nodes"]]


@pytest.mark.parametrize("who", ["end_user", "admin", "read", "guard", "metrics"])
def test_only_a_developer_uploads(call, who):
    assert call("PUT", "/graph", json=GRAPH, who=who)[0] == 403
