"""Which process carries a stream: what can move the robot goes by itself."""

import pytest
from plans import grcn, plan_of

from rtron.guard.lanes.assignment import bulk_part, command_part, lane_nodes
from rtron.vocabulary import (
    MSRCN,
    RSRCN,
    EventFlow,
    Flow,
    FpsMonitor,
    GuardedTopic,
    MissionRule,
    Mode,
    PolicyName,
    StreamKind,
    build_streams,
)

IMAGE = grcn("/image", ["/camera"], ["/viewer"], type="sensor_msgs/Image", kind=StreamKind.STATE)
DRIVE = grcn("/cmd_vel", ["/nav"], ["/driver"])
GOAL = grcn(
    "/move", ["/nav"], ["/base"], type="move_base_msgs/MoveBaseAction", kind=StreamKind.ACTION
)
LIMIT = grcn("/max_vel", ["/decider"], ["/driver"], type="std_msgs/Float64", kind=StreamKind.STATE)


def guarded(node):
    flows = tuple(Flow(name=each.name, publisher=each.publisher) for each in node.flows)
    return GuardedTopic(topic=node.topic, type=node.type, flows=flows, successors=node.successors)


def topics(part):
    return [stream.topic for stream in build_streams(part)]


@pytest.mark.parametrize(
    ("nodes", "command", "bulk"),
    [
        ([IMAGE], [], ["/image"]),
        ([DRIVE], ["/cmd_vel"], []),
        ([GOAL], ["/move"], []),
        ([LIMIT], [], ["/max_vel"]),
        ([DRIVE, IMAGE, GOAL, LIMIT], ["/cmd_vel", "/move"], ["/image", "/max_vel"]),
    ],
)
def test_commands_and_goals_go_by_themselves(nodes, command, bulk):
    plan = plan_of(*nodes)
    assert topics(command_part(plan)) == command
    assert topics(bulk_part(plan)) == bulk


@pytest.mark.parametrize("kind", ["rsrcn", "msrcn"])
def test_what_a_limit_or_a_rule_is_on_goes_with_the_commands(kind):
    rsrcn = RSRCN(
        id="rsrcn", mode=Mode.ENFORCE, policy=PolicyName.CONSTRAIN, vflows=(guarded(LIMIT),)
    )
    msrcn = MSRCN(id="msrcn", mode=Mode.ENFORCE, policy=PolicyName.BLOCK, aflows=(guarded(LIMIT),))
    plan = plan_of(LIMIT, IMAGE, **{kind: {"rsrcn": rsrcn, "msrcn": msrcn}[kind]})
    assert topics(command_part(plan)) == ["/max_vel"]
    assert topics(bulk_part(plan)) == ["/image"]


def test_frames_and_events_are_observed_by_the_bulk_process_and_rules_kept_by_the_other():
    event = EventFlow(name="red", topic="/light", publisher="/light")
    rule = MissionRule(name="light", when="red", block=("/cmd_vel",))
    msrcn = MSRCN(
        id="msrcn",
        mode=Mode.ENFORCE,
        policy=PolicyName.BLOCK,
        aflows=(guarded(DRIVE),),
        eflows=(event,),
        rules=(rule,),
    )
    monitor = FpsMonitor(id="fps", node="/detector", topic="/detector/image")
    plan = plan_of(DRIVE, msrcn=msrcn, fps_monitor=(monitor,))
    assert command_part(plan).msrcn.rules == (rule,)
    assert bulk_part(plan).msrcn.rules == bulk_part(plan).msrcn.aflows == ()
    assert bulk_part(plan).msrcn.eflows == (event,)
    assert bulk_part(plan).fps_monitor == (monitor,)


def test_each_node_lives_in_one_process():
    command, bulk = lane_nodes(plan_of(DRIVE, IMAGE))
    assert command == {"/rtron/grcn_cmd_vel"}
    assert bulk == {"/rtron/grcn_image", "/rtron_bulk"}
