"""A plan's streams: all that governs one topic, in the order GRCN, MSRCN, RSRCN."""

from dataclasses import replace

from rtron.vocabulary import (
    GRCN,
    MSRCN,
    RSRCN,
    CoordinationKind,
    Domain,
    Flow,
    GuardedTopic,
    Mode,
    Plan,
    PolicyName,
    Sharing,
    StreamKind,
    streams,
)

GENERAL = GRCN(
    id="grcn_cmd_vel",
    topic="/cmd_vel",
    type="geometry_msgs/Twist",
    domain=Domain.CONTROL,
    kind=StreamKind.COMMAND,
    sharing=Sharing.CONTEND,
    mode=Mode.ENFORCE,
    policy=PolicyName.PREEMPTION,
    flows=(
        Flow(name="flow1", publisher="/nav", priority=2, timeout=7),
        Flow(name="flow2", publisher="/teleop", priority=1, block=True),
    ),
    successors=("/base",),
    release_after=1,
    max_age=2,
    max_hold=3,
    queue_size=4,
    done="/done",
    block_unapproved=False,
)
ACTIONS = GuardedTopic(
    topic="/cmd_vel",
    type="geometry_msgs/Twist",
    flows=(Flow(name="aflow1", publisher="/nav", block=True),),
    successors=("/base",),
)
MISSION = MSRCN(id="msrcn", mode=Mode.ENFORCE, policy=PolicyName.BLOCK, aflows=(ACTIONS,))
ROBOT = RSRCN(id="rsrcn", mode=Mode.ENFORCE, policy=PolicyName.BLOCK, vflows=(ACTIONS,))
PLAN = Plan(app="app", revision=5, grcn=(GENERAL,), rsrcn=ROBOT, msrcn=MISSION)


def test_an_empty_plan_has_no_streams():
    assert streams(Plan(app="app")) == ()


def test_all_that_governs_a_topic_is_one_stream_in_order():
    (stream,) = streams(PLAN)
    kinds = [CoordinationKind.GRCN, CoordinationKind.MSRCN, CoordinationKind.RSRCN]
    assert [stage.coordination for stage in stream.stages] == kinds
    assert [stage.id for stage in stream.stages] == ["grcn_cmd_vel", "msrcn", "rsrcn"]
    assert stream.successors == ("/base",)


def test_the_settings_of_a_grcn_go_with_its_stream():
    (stream,) = streams(Plan(app="app", revision=5, grcn=(GENERAL,)))
    settings = stream.stages[0].settings
    assert stream.flows == settings.flows == GENERAL.flows
    assert (stream.queue_size, stream.done, stream.block_unapproved) == (4, "/done", False)
    assert (settings.release_after, settings.max_age, settings.max_hold) == (1, 2, 3)
    assert (settings.queue_size, settings.kind) == (4, StreamKind.COMMAND)
    assert settings.policy is PolicyName.PREEMPTION


def test_a_later_stage_blocks_a_publisher_before_it_can_take_the_output():
    (stream,) = streams(PLAN)
    general, mission, _ = (stage.settings.flows for stage in stream.stages)
    assert [(flow.name, flow.block) for flow in general] == [("flow1", True), ("flow2", True)]
    assert [(flow.name, flow.block) for flow in mission] == [("flow1", True), ("flow2", False)]


def test_every_stage_knows_the_revision():
    (stream,) = streams(PLAN)
    assert {stage.settings.revision for stage in stream.stages} == {5}


def test_a_topic_without_a_grcn_is_a_stream_of_its_own():
    (stream,) = streams(Plan(app="app", msrcn=MISSION))
    assert stream.topic == "/cmd_vel"
    assert stream.flows == ACTIONS.flows
    assert [stage.id for stage in stream.stages] == ["msrcn"]


def test_what_observes_never_shares_a_stream_with_what_enforces():
    watching = replace(MISSION, mode=Mode.OBSERVE)
    found = streams(replace(PLAN, msrcn=watching))
    stages = {stream.mode: [stage.id for stage in stream.stages] for stream in found}
    assert stages == {Mode.ENFORCE: ["grcn_cmd_vel", "rsrcn"], Mode.OBSERVE: ["msrcn"]}


def test_streams_stand_in_the_order_of_the_plan():
    other = replace(GENERAL, id="grcn_goal", topic="/goal")
    found = streams(replace(PLAN, grcn=(other, GENERAL)))
    assert [stream.topic for stream in found] == ["/goal", "/cmd_vel"]
