"""Goals of ROS 2 in a client's session: sent, cancelled, answered, or refused with a reason."""

import pytest
from bridge_parts import RIGHTS, WALL, Talk, frames, reason

from rtron.bridge.protocol import effects
from rtron.errors import SourceError
from rtron.messages import Encoding
from rtron.messages.common.json_encoder import encode_json

DOCK = "    actions: [{{action: /dock, type: a/action/Dock, rate: 5}}]\n    parameters:"
ACTIONS = RIGHTS.replace("    parameters:", DOCK, 1)
HEAD = b"\0\1\0\0"


@pytest.fixture
def talk():
    return Talk(text=ACTIONS, ros=2)


def send(talk, **fields):
    talk.now += 200_000_000
    fields = {"id": "g:1", "action": "/dock", "action_type": "a/action/Dock"} | fields
    return talk.say("send_action_goal", **fields)


def result_of(decided):
    (found,) = [each for each in frames(decided) if each["op"] == "action_result"]
    return found


def answer(talk, status, **result):
    definition = talk.types.action("a/Dock").result
    value = {"status": status, "result": result}
    return encode_json(definition, Encoding.CDR, value, WALL, 1000)[0]


@pytest.mark.parametrize("type", ["a/action/Dock", "a/Dock", ""])
def test_a_goal_is_sent(talk, type):
    decided = send(talk, args={"berth": 3}, action_type=type)
    assert decided == [effects.SendGoal(1, "/dock", "a/action/Dock", HEAD + b"\3\0\0\0")]


@pytest.mark.parametrize(("status", "is_success"), [(4, True), (5, False), (6, False)])
def test_a_result_ends_a_goal(talk, status, is_success):
    send(talk)
    told = result_of(talk.session.finish_goal(1, answer(talk, status, docked=True)))
    assert told == {
        "op": "action_result",
        "id": "g:1",
        "action": "/dock",
        "status": status,
        "values": {"docked": True},
        "result": is_success,
    }
    assert talk.session.finish_goal(1, answer(talk, status)) == []
    assert "you have no goal" in talk.refusal("cancel_action_goal", id="g:1", action="/dock")


@pytest.mark.parametrize(
    ("given", "why"),
    [
        (SourceError("nobody serves /dock"), "nobody serves /dock"),
        (HEAD, "ends before its fields do"),
        (HEAD + bytes(20_000), "you take at most 10000"),
    ],
)
def test_a_goal_without_a_result_is_told(talk, given, why):
    send(talk)
    told = result_of(talk.session.finish_goal(1, given))
    assert (told["status"], told["result"]) == (0, False)
    assert why in told["values"]


def test_feedback_goes_to_who_wants_it_and_not_too_often(talk):
    near = HEAD + b"\0\0\x80\x3f"
    send(talk)
    send(talk, id="g:2", feedback=True)
    assert talk.session.deliver_feedback(1, near, talk.now) == []
    told = [frames(talk.session.deliver_feedback(2, near, talk.now)) for _ in range(6)]
    assert [len(each) for each in told] == [1, 1, 1, 1, 0, 0]
    assert told[0][0] == {
        "op": "action_feedback",
        "id": "g:2",
        "action": "/dock",
        "values": {"distance": 1.0},
    }
    assert talk.session.deliver_feedback(3, near, talk.now) == []
    talk.wait(1)
    assert "ends before" in reason(talk.session.deliver_feedback(2, HEAD, talk.now))


def test_a_goal_is_cancelled_by_its_own_client_and_id(talk):
    send(talk)
    assert talk.say("cancel_action_goal", id="g:1", action="/dock") == [effects.CancelGoal(1)]
    for id, action in (("g:2", "/dock"), ("g:1", "/other"), (None, "/dock")):
        assert "you have no goal" in talk.refusal("cancel_action_goal", id=id, action=action)


@pytest.mark.parametrize(
    ("fields", "why"),
    [
        ({"action": "/undock"}, "web may not send goals to /undock"),
        ({"action_type": "a/action/Undock"}, "/dock is of type a/action/Dock"),
        ({"args": {"port": 1}}, "no field 'port'"),
        ({"args": {"berth": "3"}}, "berth is a whole number"),
        ({"args": [3]}, "is an object, not a list"),
        ({"fragment_size": -1}, "`fragment_size` is no whole number"),
    ],
)
def test_a_goal_that_is_refused_has_a_result_and_a_status(talk, fields, why):
    decided = send(talk, **fields)
    assert why in reason(decided)
    told = result_of(decided)
    assert (told["id"], told["status"], told["result"]) == ("g:1", 0, False)
    assert why in told["values"]


def test_goals_are_bounded(talk):
    send(talk)
    assert "you have a goal of this id" in reason(send(talk))
    send(talk, id="g:2")
    assert "2 of your goals are not done" in reason(send(talk, id="g:3"))
    talk.session.finish_goal(1, answer(talk, 4))
    assert isinstance(send(talk, id="g:5")[0], effects.SendGoal)


def test_goals_have_their_rate(talk):
    send(talk)
    decided = talk.say("send_action_goal", id="g:2", action="/dock")
    assert "more than 5 goals a second" in reason(decided)


def test_in_ros_1_goals_are_messages():
    talk = Talk(text=ACTIONS, ros=1)
    assert "in ROS 1 goals are messages: publish /dock/goal" in reason(send(talk))
