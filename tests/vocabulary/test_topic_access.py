"""Who may publish and hear what: from a plan to its topics."""

import pytest
from plans import grcn, plan_of

from rtron.vocabulary import (
    GUARD_NODE,
    MSRCN,
    RSRCN,
    STOPPER_NODE,
    SUPERVISOR_NODE,
    Flow,
    GuardedTopic,
    LeaseGroup,
    Mode,
    PolicyName,
    StreamKind,
    action_name,
    build_streams,
    list_service_access,
    list_topic_access,
    ros1_topic_name,
    stage_nodes,
)

T, NODE = "/cmd_vel", "/rtron/grcn_cmd_vel"
GOAL = {"type": "p/GoActionGoal", "kind": StreamKind.ACTION}


def planned(*grcns, **more):
    made = {each.topic: each for each in list_topic_access(plan_of(*grcns, **more))}
    return {topic: (each.publishers, each.subscribers) for topic, each in made.items()}


def test_a_velocity_comes_from_the_flows_and_goes_out_by_guard_or_supervisor():
    assert planned(grcn(T, ["/nav", "/joy_*"], ["/base"])) == {
        "/rtron/cmd_vel/flow1": (("/nav",), (NODE,)),
        "/rtron/cmd_vel/flow2": (("/joy_*",), (NODE,)),
        "/rtron/cmd_vel/out": ((NODE, SUPERVISOR_NODE), ("/base",)),
        T: ((NODE, SUPERVISOR_NODE), ("*",)),
    }


@pytest.mark.parametrize("successors", [[], ["/base"]])
def test_the_supervisor_stops_who_listens_to_the_public_name(successors):
    made = planned(grcn(T, ["/nav"], successors, block_unapproved=False))
    assert made[T] == ((NODE, SUPERVISOR_NODE, "*"), ("*",))


def test_the_supervisor_stops_only_what_is_a_command():
    state = planned(grcn(T, ["/nav"], ["/base"], kind=StreamKind.STATE))
    assert state["/rtron/cmd_vel/out"] == ((NODE,), ("/base",))


def test_the_stopper_of_a_cell_publishes_beside_the_supervisor_where_its_node_hears():
    made = planned(
        grcn(T, ["/nav"], ["/base"]), grcn("/arm", ["/nav"], ["/arm_driver"]), cell=("/base",)
    )
    assert made["/rtron/cmd_vel/out"] == ((NODE, SUPERVISOR_NODE, STOPPER_NODE), ("/base",))
    assert STOPPER_NODE not in made["/rtron/arm/out"][0]
    assert STOPPER_NODE not in planned(grcn(T, ["/nav"], []), cell=("/base",))[T][0]


def test_a_node_that_hears_its_own_topic_is_spoken_to_on_its_flow():
    found = planned(grcn(T, ["/nav", "/both"], ["/both"]))
    assert found["/rtron/cmd_vel/flow1"] == (("/nav",), (NODE,))
    assert found["/rtron/cmd_vel/flow2"] == (("/both", NODE), (NODE, "/both"))


def test_what_is_only_observed_is_free():
    assert planned(grcn(T, ["/nav"], ["/base"], mode=Mode.OBSERVE)) == {}


def leased(**more):
    arm = grcn("/arm", ["/nav", "/teleop"], ["/arm_driver"], lease="base", **more)
    leases = (LeaseGroup(name="base"), LeaseGroup(name="unused"))
    return planned(grcn(T, ["/nav"], ["/base"], lease="base", **more), arm, leases=leases)


def test_the_commanders_of_all_streams_ask_the_guard_for_their_lease():
    asked = {topic: ends for topic, ends in leased().items() if "leases" in topic}
    assert asked == {"/rtron/leases/base/request": (("/nav", "/teleop"), (GUARD_NODE,))}


def test_nobody_asks_for_the_lease_of_what_is_only_observed():
    assert leased(mode=Mode.OBSERVE) == {}


def test_stages_are_joined_and_the_last_one_speaks():
    topic = GuardedTopic(topic=T, type="", flows=(Flow(name="v1", publisher="/nav"),))
    more = {
        "msrcn": MSRCN(id="msrcn", mode=Mode.ENFORCE, policy=PolicyName.BLOCK, aflows=(topic,)),
        "rsrcn": RSRCN(id="rsrcn", mode=Mode.ENFORCE, policy=PolicyName.BLOCK, vflows=(topic,)),
    }
    plan = plan_of(grcn(T, ["/nav"], ["/base"]), **more)
    (stream,) = build_streams(plan)
    assert stage_nodes(stream) == (NODE, "/rtron/msrcn", "/rtron/rsrcn")
    found = planned(grcn(T, ["/nav"], ["/base"]), **more)
    assert found["/rtron/cmd_vel/grcn_cmd_vel"] == ((NODE,), ("/rtron/msrcn",))
    assert found["/rtron/cmd_vel/msrcn"] == (("/rtron/msrcn",), ("/rtron/rsrcn",))
    assert found["/rtron/cmd_vel/flow1"] == (("/nav",), (NODE,))
    assert found["/rtron/cmd_vel/out"] == (("/rtron/rsrcn", SUPERVISOR_NODE), ("/base",))


def test_an_action_has_five_topics_and_one_node_that_faces_the_clients():
    found = planned(grcn("/act/goal", ["/one", "/two"], ["/server"], **GOAL))
    node = "/rtron/grcn_act_goal"
    for part in ("goal", "cancel"):
        assert found[f"/rtron/act/{part}/flow1"] == (("/one",), (node,))
        assert found[f"/rtron/act/{part}/out"] == ((node,), ("/server",))
    for part in ("status", "feedback", "result"):
        assert found[f"/rtron/act/{part}/server"] == (("/server",), (node,))
        assert found[f"/rtron/act/{part}/out"] == ((node,), ("/one", "/two"))
        assert found[f"/act/{part}"] == ((node,), ("*",))
    assert len(found) == 5 * 4 - 3 + 0


@pytest.mark.parametrize(("part", "free"), [("goal", True), ("cancel", True), ("result", False)])
def test_strangers_that_may_speak_ask_and_never_answer(part, free):
    found = planned(grcn("/act/goal", ["/one"], ["/server"], block_unapproved=False, **GOAL))
    publishers, _ = found[f"/act/{part}"]
    assert ("*" in publishers) is free


def test_every_topic_stands_there_once_and_knows_its_stream():
    plan = plan_of(grcn(T, ["/nav"], ["/base"]), grcn("/act/goal", ["/one"], ["/server"], **GOAL))
    topics = list_topic_access(plan)
    assert len({each.topic for each in topics}) == len(topics)
    assert {each.stream_topic for each in topics} == {T, "/act/goal"}


def test_names_may_be_patterns():
    output = next(
        t for t in list_topic_access(plan_of(grcn(T, ["/n"], ["/b_*"]))) if "out" in t.topic
    )
    assert output.may_publish(NODE)
    assert output.may_publish(SUPERVISOR_NODE)
    assert not output.may_publish("/n")
    assert output.may_subscribe("/b_1")
    assert not output.may_subscribe("/c_1")


@pytest.mark.parametrize(
    ("topic", "type", "action"),
    [
        ("/a/goal", "p/XActionGoal", "/a"),
        ("/a/goal", "p/msg/XActionGoal", "/a"),
        ("/a/goal", "p/XAction", ""),
        ("/a/goals", "p/XActionGoal", ""),
        ("/a/result", "p/XActionResult", ""),
        ("/a/goal", "", ""),
        ("/a", "p/action/X", "/a"),
        ("/a/goal", "p/action/X", "/a/goal"),
        ("/a", "p/action/X_SendGoal", ""),
        ("/a", "p/action/X/action/Y", ""),
        ("/a", "/action/X", ""),
    ],
)
def test_an_action_is_known_by_its_goals(topic, type, action):
    assert action_name(topic, type) == action
    (stream,) = build_streams(plan_of(grcn(topic, ["/n"], ["/b"], type=type)))
    assert stream.action == action


def test_the_topics_of_an_action_lie_below_it():
    assert ros1_topic_name("/a", "cancel") == "/a/cancel"


def test_an_action_of_ros_2_has_two_topics_and_three_services_under_each_name():
    made = grcn("/act", ["/one", "/two"], ["/server"], **(GOAL | {"type": "p/action/Go"}))
    found, node = planned(made), "/rtron/grcn_act"
    plan = plan_of(made, ros=2)
    served = {each.service: (each.servers, each.clients) for each in list_service_access(plan)}
    for end in ("status", "feedback"):
        assert found.pop(f"/rtron/act/flow1/_action/{end}") == ((node,), ("/one",))
        assert found.pop(f"/rtron/act/flow2/_action/{end}") == ((node,), ("/two",))
        assert found.pop(f"/rtron/act/out/_action/{end}") == (("/server",), (node,))
        assert found.pop(f"/act/_action/{end}") == ((node,), ("*",))
    for end in ("send_goal", "cancel_goal", "get_result"):
        assert served.pop(f"/rtron/act/flow1/_action/{end}") == ((node,), ("/one",))
        assert served.pop(f"/rtron/act/flow2/_action/{end}") == ((node,), ("/two",))
        assert served.pop(f"/rtron/act/out/_action/{end}") == (("/server",), (node,))
        assert served.pop(f"/act/_action/{end}") == ((node,), ("*",))
    assert found == served == {}
    assert {each.stream_topic for each in list_service_access(plan)} == {"/act"}
