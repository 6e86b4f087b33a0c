"""A client of a real bridge asks, a person at a real service approves, and it passes once."""

import json

import pytest
from bridge_process import BridgeProcess, hear_until
from driven_base import CMD_VEL_GUARD, start_guard
from harness import wait_for

from rtron.bridge.rights.tokens import token_hash
from rtron.cli.support.control_request import send_request
from rtron.guard.core.control_socket import control_path
from rtron.planning.plan_file.loader import read_plan

pytestmark = pytest.mark.ros1
ROBOT = "r1"
RIGHTS = f"""
schema: rtron.bridge/1
approvers: {{roles: [end_user]}}
clients:
  - name: web
    tokens: ["{token_hash("web")}"]
    publish:
      - {{topic: /chat, type: std_msgs/String, approval: true}}
  - name: screen
    tokens: ["{token_hash("screen")}"]
    subscribe:
      - {{topic: /chat, type: std_msgs/String}}
"""
CHAT = {"op": "publish", "topic": "/chat", "msg": {"data": "go"}, "latch": True}


class Scene:
    """A bridge, its guard with a link, a service, and a person there."""

    def __init__(self, ros1, service, person):
        self.bridge = BridgeProcess(ros1, 1, RIGHTS)
        self.plan = read_plan(self.bridge.plan)
        token = service.create_token(ROBOT, "guard", robot=ROBOT)
        words = ["--service", service.url, "--token-file", token, "--robot", ROBOT]
        start_guard(ros1, self.plan, CMD_VEL_GUARD, *words, "--state-dir", ros1.folder / "state")
        self._person, self._path = person, f"/api/v1/robots/{ROBOT}/requests"
        wait_for(lambda: self.requests() is not None, what="the bridge at the service")

    def requests(self):
        answer = self._person.get(self._path)
        return answer.json()["requests"] if answer.status_code == 200 else None

    def request(self):
        """Wait for the only request."""
        wait_for(lambda: (self.requests() or {}).get("count") == 1, what="the request")
        return self.requests()["shown"][0]

    def answer(self, digest, do="approve"):
        body = {"do": do, "reason": "the corridor is free"}
        return self._person.post(f"{self._path}/{digest}", json=body)


@pytest.fixture
def scene(ros1, service_with_person):
    return Scene(ros1, *service_with_person)


def refusal(web):
    """Let the client try; return why it is refused."""
    return refusal_of(web, CHAT)


def refusal_of(web, frame):
    web.send(json.dumps(frame))
    return hear_until(web, lambda frame: frame.get("level") == "error")["msg"]


def test_what_a_person_approves_passes_once(scene):
    with scene.bridge.connect("web") as web, scene.bridge.connect("screen") as screen:
        screen.send(json.dumps({"op": "subscribe", "topic": "/chat", "type": "std_msgs/String"}))
        assert "request 1 waits" in refusal(web)
        request = scene.request()
        assert (request["client"], request["content"]) == ("web", '{"data":"go"}')
        answer = scene.answer(request["digest"])
        assert answer.status_code == 200, answer.text
        assert answer.json()["reason"].endswith("is approved by ann at the service")
        web.send(json.dumps(CHAT))
        heard = hear_until(screen, lambda frame: frame.get("op") == "publish")
        assert heard["msg"] == {"data": "go"}
        assert scene.answer(request["digest"]).status_code == 409
        assert "request 2 waits" in refusal(web)


@pytest.mark.long
def test_no_client_approves_and_who_answers_on_the_robot_ends_what_a_person_sees(scene):
    with scene.bridge.connect("web") as web:
        assert "request 1 waits" in refusal(web)
        request = scene.request()
        for spoof in (
            {"op": "approval_command", "digest": request["digest"], "do": "approve", "by": "ann"},
            {"type": "approval_command", "number": 1, "digest": request["digest"]},
            {"op": "publish", "topic": "/rtron/approvals", "msg": {"data": request["digest"]}},
            {"op": "call_service", "service": "/rtron/approve", "args": {"number": 1}},
        ):
            assert refusal_of(web, spoof)
        assert scene.request()["digest"] == request["digest"]
        local = {"approval": "refuse", "number": 1, "reason": "not today"}
        send_request(control_path(f"bridge_{scene.plan.app}"), local, "bridge")
        assert scene.answer(request["digest"]).status_code == 409
        wait_for(lambda: scene.requests()["count"] == 0, what="the end of the request")
        assert "has refused request 1" in refusal(web)
