"""What a person must approve before it passes: once, word for word, and not by the client."""

import pytest
from bridge_parts import RIGHTS, Talk, frames, plan, rights

from rtron.bridge.common.plan_topics import check_rights
from rtron.bridge.protocol import effects
from rtron.bridge.protocol.approvals import HOLDS_FOR, MAX_WAITING, WAITS_FOR, Approvals
from rtron.bridge.server.approval_commands import ApprovalCommands
from rtron.errors import InputError, WireError
from rtron.vocabulary import SECOND

APPROVED = RIGHTS.replace(
    "{{topic: /chat, type: std_msgs/String, rate: 10}}",
    "{{topic: /chat, type: std_msgs/String, rate: 10, approval: true}}",
).replace("type: std_srvs/SetBool, rate: 5", "type: std_srvs/SetBool, rate: 5, approval: true")
CHAT = {"topic": "/chat", "type": "std_msgs/String", "msg": {"data": "go"}}
WAITS = "request 1 waits until a person approves it; then send the same again"


@pytest.fixture
def talk():
    return Talk(text=APPROVED)


def published(decided):
    return [each for each in decided if isinstance(each, effects.PublishBytes)]


def test_a_message_waits_for_a_person_and_passes_once(talk):
    assert talk.refusal("publish", **CHAT) == f"publish /chat: {WAITS}"
    assert [each.content for each in talk.approvals.waiting(talk.now)] == ['{"data":"go"}']
    talk.approvals.answer(1, "ann", talk.now, is_approved=True)
    assert len(published(talk.say("publish", **CHAT))) == 1
    talk.wait(2)
    assert "request 2 waits" in talk.refusal("publish", **CHAT)


def test_other_words_are_another_request(talk):
    talk.say("publish", **CHAT)
    talk.approvals.answer(1, "ann", talk.now, is_approved=True)
    talk.wait(2)
    other = CHAT | {"msg": {"data": "go faster"}}
    assert "request 2 waits" in talk.refusal("publish", **other)
    talk.wait(2)
    assert published(talk.say("publish", **CHAT))


def test_what_a_person_refuses_is_refused(talk):
    talk.say("publish", **CHAT)
    talk.approvals.answer(1, "ann", talk.now, is_approved=False)
    assert talk.refusal("publish", **CHAT) == "publish /chat: ann has refused request 1"


def test_a_call_waits_for_a_person(talk):
    call = {"service": "/lamp", "args": {"data": True}}
    answer, status = frames(talk.say("call_service", id="a", **call))
    assert answer["values"] == f"call /lamp: {WAITS}"
    assert status["level"] == "error"
    talk.approvals.answer(1, "ann", talk.now, is_approved=True)
    talk.wait(2)
    (request,) = talk.say("call_service", **call)
    assert isinstance(request, effects.RequestService)


def test_an_action_of_ros2_waits_for_a_person():
    text = RIGHTS.replace(
        "    parameters:",
        "    actions: [{{action: /dock, type: a/Dock, approval: true}}]\n    parameters:",
    )
    talk = Talk(text=text, ros=2)
    goal = {"action": "/dock", "args": {"berth": 1}}
    refused = frames(talk.say("send_action_goal", id="a", **goal))
    assert refused[0]["values"] == f"goal of /dock: {WAITS}"
    talk.approvals.answer(1, "ann", talk.now, is_approved=True)
    talk.wait(2)
    assert isinstance(talk.say("send_action_goal", id="a", **goal)[0], effects.SendGoal)


def test_in_ros1_the_goal_of_an_action_waits_and_its_cancel_does_not():
    text = RIGHTS.replace(
        "    parameters:",
        "    actions: [{{action: /turn, type: actionlib/TestAction, approval: true}}]\n"
        "    parameters:",
    )
    talk = Talk(text=text)
    stop = {"topic": "/turn/cancel", "msg": {}}
    assert published(talk.say("publish", **stop))


def test_an_approval_ends():
    approvals = Approvals()
    with pytest.raises(WireError):
        approvals.check("web", "x", {}, 0)
    approvals.answer(1, "ann", SECOND, is_approved=True)
    with pytest.raises(WireError, match="request 2 waits"):
        approvals.check("web", "x", {}, SECOND + HOLDS_FOR)
    assert approvals.waiting(SECOND + HOLDS_FOR + WAITS_FOR) == []


def test_nobody_asks_for_too_much():
    approvals = Approvals()
    for number in range(MAX_WAITING):
        with pytest.raises(WireError, match="waits"):
            approvals.check("web", "x", number, 0)
    with pytest.raises(WireError, match="8 requests of yours"):
        approvals.check("web", "x", "more", 0)
    with pytest.raises(WireError, match="request 9 waits"):
        approvals.check("other", "x", "more", 0)
    with pytest.raises(WireError, match="nobody could approve"):
        approvals.check("other", "x", "y" * 5000, 0)


def test_one_client_cannot_use_the_approval_of_another():
    approvals = Approvals()
    with pytest.raises(WireError):
        approvals.check("web", "x", {}, 0)
    approvals.answer(1, "ann", 0, is_approved=True)
    with pytest.raises(WireError, match="request 2"):
        approvals.check("other", "x", {}, 0)


def test_velocities_cannot_be_approved_one_by_one():
    text = RIGHTS.replace("rate: 10}}", "rate: 10, approval: true}}", 1)
    with pytest.raises(InputError, match="nobody can approve each velocity"):
        check_rights(rights(text), plan())


def test_a_person_lists_and_answers_requests():
    approvals = Approvals()
    commands = ApprovalCommands(approvals, lambda: 0)
    with pytest.raises(WireError):
        approvals.check("web", "publish /chat", {"data": "go"}, 0)
    ask = {"approval": "list", "number": 0, "reason": ""}
    (listed,) = commands.handle("ann", ask)["requests"]
    assert listed == {
        "number": 1,
        "client": "web",
        "what": "publish /chat",
        "content": '{"data":"go"}',
    }
    answer = commands.handle("ann", {"approval": "approve", "number": 1, "reason": "free"})
    assert answer == {"answer": "request 1 of web, publish /chat, is approved by ann"}
    approvals.check("web", "publish /chat", {"data": "go"}, 0)


@pytest.mark.parametrize(
    "request_",
    [
        {},
        {"approval": "list"},
        {"approval": "grant", "number": 1, "reason": ""},
        {"approval": "approve", "number": 7, "reason": ""},
        {"approval": "approve", "number": "1", "reason": ""},
    ],
)
def test_a_wrong_request_of_a_person_is_refused(request_):
    with pytest.raises(WireError):
        ApprovalCommands(Approvals(), lambda: 0).handle("ann", request_)
