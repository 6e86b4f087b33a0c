"""Roll-outs over HTTP, with guards on the real link, and a service that goes on by itself."""

from contextlib import ExitStack

import pytest
from collector_server import hello as guard_hello
from collector_server import receive_message, send_message
from controller_setup import PLAN, plan
from harness import wait_for
from websockets.sync.client import connect

from rtron.vocabulary import Alarm, AlarmKind, GuardState
from rtron.wire.common.link_protocol import (
    Applied,
    PlanDocument,
    PlanRequest,
    StateReport,
    plan_document_digest,
)

ROLLOUTS = "/api/v1/rollouts"
OTHER = PLAN.replace("priority: 2", "priority: 3")
DIGEST = plan_document_digest(OTHER)
NEW = {
    "robots": {"label": "hall-a"},
    "nodes": {"drive": {"policy": "Block"}},
    "reason": "visitors",
    "wait": 0,
}


class Guard:
    """A robot's guard on the real link, which answers settings at once."""

    def __init__(self, robot, socket):
        self.robot, self.socket = robot, socket
        send_message(self.socket, guard_hello(plan=plan(), app="small", run=robot))
        self.answer()

    def answer(self):
        """Answer the next settings, and tell a state."""
        settings = receive_message(self.socket).settings
        send_message(self.socket, Applied(revision=settings.revision))
        self.tell(settings.revision)
        return settings

    def tell(self, revision, *alarms):
        state = GuardState(at=0, revision=revision, alarms=alarms)
        send_message(self.socket, StateReport(state=state))


@pytest.fixture
def guards(app, port, people, client, admin):
    """Ten guards of hall A."""
    url, made = f"ws://127.0.0.1:{port}/link/v1", {}
    stack = ExitStack()
    for robot in (f"car{index}" for index in range(10)):
        headers = people.token_headers(robot, "guard", robot=robot)
        link = connect(url, additional_headers=headers, compression=None, proxy=None)
        made[robot] = Guard(robot, stack.enter_context(link))
    for robot in made:
        labels = {"labels": ["hall-a"]}
        assert client.put(f"/api/v1/robots/{robot}/labels", headers=admin, json=labels).is_success
    hub = app.state.service.hub
    wait_for(lambda: all(hub.state(robot) for robot in made))
    with stack:
        yield made


def view(client, headers, id):
    return client.get(f"{ROLLOUTS}/{id}", headers=headers).json()


def start(client, headers, **values):
    answer = client.post(ROLLOUTS, headers=headers, json=NEW | values)
    assert answer.status_code == 201, answer.text
    return answer.json()["id"]


def test_a_bad_change_stays_at_the_canary(client, admin, guards, audit):
    id = start(client, admin, wait=3600)
    robots = client.get(f"{ROLLOUTS}/{id}/robots", headers=admin).json()["robots"]
    canary = guards[robots[0]["robot"]]
    assert canary.answer().nodes["drive"].policy == "Block"
    wait_for(lambda: view(client, admin, id)["applied"] == 1)
    canary.tell(1, Alarm(kind=AlarmKind.DRIFT, reason="it drifts"))
    assert canary.answer().nodes == {}
    wait_for(lambda: view(client, admin, id)["state"] == "reverted")
    found = view(client, admin, id)
    assert (found["sent"], found["reverted"], found["waiting"]) == (0, 1, 9)
    assert found["note"] == f"alarm: 1 of 1 robots, at most 0: {canary.robot}"
    assert ("rtron", "settings.take_back", canary.robot, "done") in audit()
    assert ("root", "rollout", "robots", "done") in audit()


def test_a_good_change_reaches_all(client, admin, guards, clock):
    id = start(client, admin, stages=["100%"])
    for guard in guards.values():
        assert guard.answer().nodes["drive"].policy == "Block"
    wait_for(lambda: view(client, admin, id)["state"] == "done")
    assert view(client, admin, id)["applied"] == 10


def test_a_robot_gets_the_plan_that_its_settings_name_and_no_other(client, admin, guards):
    body = {"nodes": {}, "plan": OTHER, "robots": {"names": ["car1"]}, "wait": 0}
    id = start(client, admin, **body)
    assert view(client, admin, id)["plan"] == DIGEST
    socket = guards["car1"].socket
    assert receive_message(socket).settings.plan == DIGEST
    send_message(guards["car2"].socket, PlanRequest(digest=DIGEST))
    send_message(socket, PlanRequest(digest="other"))
    send_message(socket, PlanRequest(digest=DIGEST))
    assert receive_message(socket) == PlanDocument(text=OTHER)
    send_message(socket, Applied(revision=1, plan=DIGEST))
    wait_for(lambda: view(client, admin, id)["state"] == "done")
    stop = {"reason": "a child"}
    assert client.post("/api/v1/robots/car2/stop", headers=admin, json=stop).is_success
    assert receive_message(guards["car2"].socket).settings.plan == ""


def test_a_guard_that_knows_of_no_plans_refuses_them(client, admin, guards):
    id = start(client, admin, nodes={}, plan=OTHER, robots={"names": ["car1"]})
    assert guards["car1"].answer().plan == DIGEST
    wait_for(lambda: view(client, admin, id)["state"] == "reverted")
    assert guards["car1"].answer().plan == ""


def test_pages(client, admin, guards):
    first = start(client, admin, wait=3600, robots={"names": ["car1"]})
    second = start(client, admin, wait=3600, robots={"names": ["car2", "car3"]})
    page = client.get(ROLLOUTS, headers=admin, params={"limit": 1}).json()
    assert ([each["id"] for each in page["rollouts"]], page["next"]) == ([second], second)
    page = client.get(ROLLOUTS, headers=admin, params={"before": second}).json()
    assert ([each["id"] for each in page["rollouts"]], page["next"]) == ([first], None)
    url = f"{ROLLOUTS}/{second}/robots"
    page = client.get(url, headers=admin, params={"limit": 1}).json()
    rest = client.get(url, headers=admin, params={"after": page["next"]}).json()
    names = [each["robot"] for each in page["robots"] + rest["robots"]]
    assert (sorted(names), rest["next"]) == (["car2", "car3"], None)


def test_pause_and_cancel(client, admin, guards):
    id = start(client, admin, wait=3600)

    def post(action, **body):
        answer = client.post(f"{ROLLOUTS}/{id}/{action}", headers=admin, json=body)
        return answer.status_code, answer.json().get("state")

    assert post("pause") == (422, None)
    assert post("pause", reason="\u200b\u200b\u200b") == (422, None)
    assert post("pause", reason="lunch") == (200, "paused")
    assert post("pause", reason="lunch") == (409, None)
    assert post("resume", reason="back") == (200, "running")
    assert post("cancel", reason="enough", keep=True) == (200, "cancelled")


NO_ROLLOUTS = (
    {"reason": ""},
    {"robots": {}},
    {"robots": {"names": []}},
    {"robots": {"names": ["car1"], "label": "hall-a"}},
    {"stages": []},
    {"stages": [1, "10%"]},
    {"stages": [0, "100%"]},
    {"stages": ["100"]},
    {"limits": {"noise": 1}},
    {"limits": {"alarm": "a few"}},
    {"wait": -1},
    {"nodes": {}},
    {"nodes": {"drive": {"policy": "Blok"}}},
    {"more": 1},
)


def test_what_is_no_rollout(client, admin, guards):
    for values in NO_ROLLOUTS:
        answer = client.post(ROLLOUTS, headers=admin, json=NEW | values)
        assert answer.status_code == 422, values
    assert client.get(ROLLOUTS, headers=admin).json()["rollouts"] == []


def test_a_rollout_that_is_not_there(client, admin):
    assert client.get(f"{ROLLOUTS}/7", headers=admin).status_code == 404
    assert client.get(f"{ROLLOUTS}/7/robots", headers=admin).status_code == 404
    body = {"reason": "none"}
    assert client.post(f"{ROLLOUTS}/7/pause", headers=admin, json=body).status_code == 404
