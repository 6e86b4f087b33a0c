"""Groups over HTTP: an operator of hall A changes hall A's robots and no others."""

import pytest
from controller_setup import hello, plan

from rtron.service.server.database_accounts import create_token_record, create_user_record
from rtron.service.store.accounts.users import get_user, set_groups

ROBOTS = "/api/v1/robots"


@pytest.fixture
def robots(app, client, admin):
    """Robots of hall A, of hall B and of none."""
    for robot, labels in {"a1": ["hall-a", "lift"], "b1": ["hall-b", "lift"], "c1": []}.items():
        app.state.service.controller.handle_hello(robot, hello(plan()))
        assert put_labels(client, admin, robot, labels) == 200


@pytest.fixture
def operator(app, people):
    """The headers of an end user and developer of hall A."""
    headers = people.session_headers("tom", "end_user", "developer")
    limit(app, "tom", ["hall-a"])
    return headers


def limit(app, name, groups):
    with app.state.service.database.session() as session:
        set_groups(get_user(session, name), groups)


def put_labels(client, headers, robot, labels):
    answer = client.put(f"{ROBOTS}/{robot}/labels", headers=headers, json={"labels": labels})
    return answer.status_code


def names(client, headers, **query):
    return [each["name"] for each in client.get(ROBOTS, headers=headers, params=query).json()]


def test_labels_find_robots_and_make_groups(client, admin, robots):
    assert names(client, admin, label="lift") == ["a1", "b1"]
    assert names(client, admin, label="lift", text="b") == ["b1"]
    assert names(client, admin, label="none") == []
    groups = client.get("/api/v1/groups", headers=admin).json()
    assert [(each["name"], each["robots"]) for each in groups] == [
        ("hall-a", 1),
        ("hall-b", 1),
        ("lift", 2),
    ]
    assert client.get(f"{ROBOTS}/a1", headers=admin).json()["labels"] == ["hall-a", "lift"]


def test_labels_are_replaced_and_audited(client, admin, robots, audit):
    assert put_labels(client, admin, "a1", ["hall-b", "hall-b"]) == 200
    assert client.get(f"{ROBOTS}/a1", headers=admin).json()["labels"] == ["hall-b"]
    assert audit()[0] == ("root", "labels", "a1", "done")


def test_a_group_is_made_at_once(client, admin, robots, audit):
    def put(names):
        return client.put("/api/v1/groups/night", headers=admin, json={"robots": names})

    assert put(["a1", "c1", "a1"]).json() == {"name": "night", "robots": 2}
    assert put(["b1", "z9"]).status_code == 404
    assert names(client, admin, label="night") == ["a1", "c1"]
    assert put(["b1"]).status_code == 200
    assert names(client, admin, label="night") == ["b1"]
    assert audit()[0] == ("root", "group", "night", "done")
    group = client.get("/api/v1/groups/night", headers=admin).json()
    assert group == {"robots": ["b1"]}
    assert put([]).json()["robots"] == 0


@pytest.mark.parametrize("labels", [["a b"], [""], ["x" * 101], [f"l{i}" for i in range(21)]])
def test_labels_that_are_none(client, admin, robots, labels):
    assert put_labels(client, admin, "a1", labels) == 422


def test_a_robot_that_is_not_known_has_no_labels(client, admin, audit):
    assert put_labels(client, admin, "z9", ["hall-a"]) == 404
    assert audit()[0][1:3] == ("labels", "z9")


def test_an_operator_of_hall_a_stops_its_robots_and_no_others(client, operator, robots, audit):
    stop = {"reason": "child on the track"}
    answers = {
        robot: client.post(f"{ROBOTS}/{robot}/stop", headers=operator, json=stop).status_code
        for robot in ("a1", "b1", "c1", "z9")
    }
    assert answers == {"a1": 200, "b1": 403, "c1": 403, "z9": 403}
    assert [
        client.get(f"{ROBOTS}/{robot}", headers=operator).json()["stop"] is not None
        for robot in ("a1", "b1", "c1")
    ] == [True, False, False]
    refused = [line for line in audit() if line[3].startswith("refused")]
    assert {line[2] for line in refused} == {
        f"{ROBOTS}/{robot}/stop" for robot in ("b1", "c1", "z9")
    }
    assert all(line[0] == "tom" for line in refused)


def test_a_stop_of_many_robots_leaves_out_those_of_others(client, operator, robots, audit):
    body = {"robots": ["a1", "b1", "z9"], "reason": "fire"}
    result = client.post(f"{ROBOTS}/stop", headers=operator, json=body).json()
    assert (result["sent"], result["waiting"]) == ([], ["a1"])
    assert {robot: text.partition(" is in ")[0] for robot, text in result["failed"].items()} == {
        "b1": "b1",
        "z9": "z9",
    }
    refused = [line for line in audit() if line[3].startswith("refused")]
    assert {line[:3] for line in refused} == {("tom", "stop", "b1"), ("tom", "stop", "z9")}
    assert client.get(f"{ROBOTS}/b1", headers=operator).json()["stop"] is None


def robot_changes(app):
    """Every way of changing a robot that the API has."""
    return [
        (method.upper(), path)
        for path, item in app.openapi()["paths"].items()
        for method in item
        if "{robot}" in path and method != "get"
    ]


def test_no_way_of_changing_a_robot_leads_round_the_groups(app, client, operator, robots):
    changes = robot_changes(app)
    assert len(changes) >= 7
    for method, path in changes:
        url = path.replace("{robot}", "b1").replace("{node}", "speed")
        answer = client.request(method, url, headers=operator, json={})
        assert answer.status_code == 403, (method, path)


def test_a_robot_out_of_reach_shows_no_rights(client, operator, robots):
    def rights(robot):
        nodes = client.get(f"{ROBOTS}/{robot}/nodes", headers=operator).json()
        one = client.get(f"{ROBOTS}/{robot}/nodes/speed", headers=operator).json()
        assert one == next(node for node in nodes if node["id"] == "speed")
        return any(node["rights"] for node in nodes)

    assert [rights(robot) for robot in ("a1", "b1", "c1")] == [True, False, False]


def test_a_robot_that_leaves_the_hall_leaves_its_operator(client, admin, operator, robots):
    def stop():
        return client.post(f"{ROBOTS}/a1/stop", headers=operator, json={}).status_code

    assert stop() == 200
    put_labels(client, admin, "a1", ["hall-b"])
    assert stop() == 403


def test_who_has_which_groups_is_an_admins_to_say(client, admin, people):
    people.add_user("eve", "end_user")
    url = "/api/v1/users/eve"

    def change(**body):
        answer = client.patch(url, headers=admin, json=body)
        return answer.status_code, answer.json().get("groups")

    assert change(groups=["hall-b", "hall-a"]) == (200, ["hall-a", "hall-b"])
    assert change(disabled=False) == (200, ["hall-a", "hall-b"])
    assert change(roles=["admin"])[0] == 422
    assert change(groups=[])[0] == 422
    assert change(groups=None) == (200, None)
    assert change(roles=["admin", "end_user"], groups=["hall-a"])[0] == 422
    assert [each["groups"] for each in client.get("/api/v1/users", headers=admin).json()] == [
        None,
        None,
    ]


def test_tokens_have_groups_too(app, client, admin, robots):
    made = client.post(
        "/api/v1/tokens",
        headers=admin,
        json={"name": "shift", "scopes": ["end_user"], "groups": ["hall-a"]},
    ).json()
    headers = {"Authorization": f"Bearer {made['secret']}"}
    assert client.get("/api/v1/me", headers=headers).json()["groups"] == ["hall-a"]
    stops = [client.post(f"{ROBOTS}/{r}/stop", headers=headers, json={}) for r in ("a1", "b1")]
    assert [each.status_code for each in stops] == [200, 403]
    guard = {"name": "g", "scopes": ["guard"], "robot": "a1", "groups": ["hall-a"]}
    assert client.post("/api/v1/tokens", headers=admin, json=guard).status_code == 422


def test_accounts_made_in_the_database_have_groups(app, client):
    database = app.state.service.database
    create_user_record(database, "rtron", "tom", ["end_user"], ["hall-a"])
    request = {"name": "shift", "scopes": ["end_user"], "groups": ["hall-a"]}
    headers = {"Authorization": f"Bearer {create_token_record(database, 'rtron', request)}"}
    assert client.get("/api/v1/me", headers=headers).json()["groups"] == ["hall-a"]
