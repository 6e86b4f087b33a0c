"""A plan's streams: all that governs one topic, in the order GRCN, MSRCN, RSRCN."""

from dataclasses import replace

import pytest
from plans import grcn

from rtron.vocabulary import (
    MSRCN,
    RSRCN,
    UNAPPROVED,
    CoordinationKind,
    Flow,
    GuardedTopic,
    MissionRule,
    Mode,
    Plan,
    PolicyName,
    StageRule,
    StopProfile,
    StreamKind,
    build_streams,
    streams,
)

GENERAL = grcn(
    "/cmd_vel",
    (),
    ["/base"],
    flows=(
        Flow(name="flow1", publisher="/nav", priority=2, timeout=7),
        Flow(name="flow2", publisher="/teleop", priority=1, block=True),
    ),
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
    assert build_streams(Plan(app="app")) == ()


def test_all_that_governs_a_topic_is_one_stream_in_order():
    (stream,) = build_streams(PLAN)
    kinds = [CoordinationKind.GRCN, CoordinationKind.MSRCN, CoordinationKind.RSRCN]
    assert [stage.coordination_kind for stage in stream.stages] == kinds
    assert [stage.id for stage in stream.stages] == ["grcn_cmd_vel", "msrcn", "rsrcn"]
    assert stream.successors == ("/base",)


def test_the_settings_of_a_grcn_go_with_its_stream():
    (stream,) = build_streams(Plan(app="app", revision=5, grcn=(GENERAL,)))
    settings = stream.stages[0].settings
    assert stream.flows == settings.flows == GENERAL.flows
    assert (stream.queue_size, stream.done, stream.block_unapproved) == (4, "/done", False)
    assert (settings.release_after, settings.max_age, settings.max_hold) == (1, 2, 3)
    assert (settings.queue_size, settings.kind) == (4, StreamKind.COMMAND)
    assert settings.policy is PolicyName.PREEMPTION


def test_a_later_stage_blocks_a_publisher_before_it_can_take_the_output():
    (stream,) = build_streams(PLAN)
    general, mission, _ = (stage.settings.flows for stage in stream.stages)
    assert [(flow.name, flow.block) for flow in general] == [("flow1", True), ("flow2", True)]
    assert [(flow.name, flow.block) for flow in mission] == [("flow1", True), ("flow2", False)]


def test_every_stage_knows_the_revision():
    (stream,) = build_streams(PLAN)
    assert {stage.settings.revision for stage in stream.stages} == {5}


def test_a_topic_without_a_grcn_is_a_stream_of_its_own():
    (stream,) = build_streams(Plan(app="app", msrcn=MISSION))
    assert stream.topic == "/cmd_vel"
    assert stream.flows == ACTIONS.flows
    assert [stage.id for stage in stream.stages] == ["msrcn"]


def test_what_observes_never_shares_a_stream_with_what_enforces():
    watching = replace(MISSION, mode=Mode.OBSERVE)
    found = build_streams(replace(PLAN, msrcn=watching))
    stages = {stream.mode: [stage.id for stage in stream.stages] for stream in found}
    assert stages == {Mode.ENFORCE: ["grcn_cmd_vel", "rsrcn"], Mode.OBSERVE: ["msrcn"]}


def test_streams_stand_in_the_order_of_the_plan():
    other = replace(GENERAL, id="grcn_goal", topic="/goal")
    found = build_streams(replace(PLAN, grcn=(other, GENERAL)))
    assert [stream.topic for stream in found] == ["/goal", "/cmd_vel"]


# Limits, rules and the stop


def test_the_limits_of_the_rsrcn_go_with_its_stage_alone():
    robot = replace(
        ROBOT, policy=PolicyName.SAFE_CONSTRAIN, threshold=0.05, max_vel_limit=0.22, lowest=0.01
    )
    (stream,) = build_streams(replace(PLAN, rsrcn=robot))
    limits = [(s.threshold, s.max_vel_limit, s.lowest) for s in settings_of(stream)]
    assert limits == [(None, None, 0.0), (None, None, 0.0), (0.05, 0.22, 0.01)]
    assert [s.policy for s in settings_of(stream)][1:] == [MISSION.policy, robot.policy]


def test_every_stream_stops_as_the_plan_says():
    stop = StopProfile(decel=1.0, period=7)
    other = replace(GENERAL, id="grcn_goal", topic="/goal")
    plan = replace(PLAN, grcn=(GENERAL, other), stop=stop)
    assert [stream.stop for stream in build_streams(plan)] == [stop, stop]
    assert build_streams(PLAN)[0].stop == StopProfile()


def settings_of(stream):
    return [stage.settings for stage in stream.stages]


def guarded(*flows, topic="/cmd_vel"):
    return replace(ACTIONS, topic=topic, flows=flows)


def with_rules(*rules, flows=(), topic="/cmd_vel", general=(GENERAL,)):
    """Return the stage rules that the MSRCN's stage of one topic gets."""
    aflows = flows or (
        Flow(name="aflow1", publisher="/nav"),
        Flow(name="aflow2", publisher="/teleop"),
    )
    mission = replace(MISSION, aflows=(guarded(*aflows, topic=topic),), rules=rules)
    found = build_streams(Plan(app="app", grcn=general, msrcn=mission))
    (stage,) = (s for stream in found for s in stream.stages if s.id == "msrcn")
    return stage.settings.rules


def rule(*block, require=""):
    return MissionRule(name="fire", block=block, require=require)


@pytest.mark.parametrize(
    ("block", "require", "blocks", "meets"),
    [
        (("aflow1",), "", {"flow1"}, set()),
        (("aflow1", "aflow2"), "", {"flow1", "flow2"}, set()),
        (("/cmd_vel",), "", {"flow1", "flow2", UNAPPROVED}, set()),
        (("/goal",), "", set(), set()),
        (("aflow1",), "aflow2", {"flow1"}, {"flow2"}),
        (("/goal",), "/cmd_vel", set(), {"flow1", "flow2", UNAPPROVED}),
        (("flow1",), "flow2", set(), set()),
    ],
)
def test_the_flows_of_a_rule_have_their_names_in_the_stream(block, require, blocks, meets):
    expected = StageRule(
        name="fire", blocked_flows=frozenset(blocks), required_flows=frozenset(meets)
    )
    assert with_rules(rule(*block, require=require)) == (expected,)


def test_without_a_grcn_the_flows_keep_their_own_names():
    (made,) = with_rules(rule("aflow2"), general=())
    assert made.blocked_flows == {"aflow2"}


@pytest.mark.parametrize(
    ("publisher", "blocks"),
    [("/nav*", {"flow1"}), ("/na", set()), ("/*", {"flow1", "flow2"}), ("/nav", {"flow1"})],
)
def test_a_pattern_means_every_flow_that_it_fits(publisher, blocks):
    aflow = Flow(name="aflow1", publisher=publisher)
    (made,) = with_rules(rule("aflow1"), flows=(aflow,))
    assert made.blocked_flows == blocks


def test_a_name_is_meant_by_a_pattern_of_the_stream():
    general = replace(GENERAL, flows=(Flow(name="flow1", publisher="/nav*"),))
    aflow = Flow(name="aflow1", publisher="/nav_1")
    (made,) = with_rules(rule("aflow1"), flows=(aflow,), general=(general,))
    assert made.blocked_flows == {"flow1"}


def test_names_are_not_compared_with_each_other(monkeypatch):
    comparisons = []
    overlap = streams.patterns_overlap
    monkeypatch.setattr(
        streams, "patterns_overlap", lambda *p: comparisons.append(p) or overlap(*p)
    )
    flows = tuple(Flow(name=f"flow{n}", publisher=f"/node{n}", block=True) for n in range(100))
    flows += (Flow(name="teleops", publisher="/teleop_*"),)
    general, topic = replace(GENERAL, flows=flows), guarded(*flows)
    mission = replace(MISSION, aflows=(topic,), rules=(rule(*(f.name for f in flows)),))
    robot = replace(ROBOT, vflows=(topic,))
    (made,) = build_streams(Plan(app="app", grcn=(general,), msrcn=mission, rsrcn=robot))
    assert [flow.block for flow in made.stages[0].settings.flows] == [True] * 100 + [False]
    assert len(comparisons) < 20 * len(flows)


def test_each_rule_stands_at_each_topic_in_order():
    first, second = rule("aflow1"), replace(rule("aflow2"), name="wet")
    assert [each.name for each in with_rules(first, second)] == ["fire", "wet"]
    other = with_rules(first, second, topic="/goal", general=())
    assert [each.blocked_flows for each in other] == [{"aflow1"}, {"aflow2"}]


def test_only_the_mission_has_rules():
    mission = replace(MISSION, rules=(rule("aflow1"),))
    (stream,) = build_streams(replace(PLAN, msrcn=mission))
    assert [bool(s.rules) for s in settings_of(stream)] == [False, True, False]


def test_a_stage_has_the_priorities_of_its_own_flows():
    vflows = (
        Flow(name="vflow1", publisher="/teleop", priority=9),
        Flow(name="vflow2", publisher="/tele*", priority=5),
    )
    robot = replace(ROBOT, vflows=(guarded(*vflows),))
    (stream,) = build_streams(replace(PLAN, rsrcn=robot))
    general, mission, limit = ([f.priority for f in s.flows] for s in settings_of(stream))
    assert general == [2, 1]
    assert mission == [0, 0]
    assert limit == [0, 9]


def test_a_stage_takes_over_what_else_a_flow_says():
    (stream,) = build_streams(PLAN)
    general, mission, _ = (s.flows[0] for s in settings_of(stream))
    assert (mission.timeout, mission.publisher) == (general.timeout, "/nav") == (7, "/nav")


def test_a_pattern_blocks_every_flow_that_it_fits_in_its_stage_and_before():
    blocked = Flow(name="aflow1", publisher="/*", block=True)
    (stream,) = build_streams(replace(PLAN, msrcn=replace(MISSION, aflows=(guarded(blocked),))))
    blocks = [[flow.block for flow in s.flows] for s in settings_of(stream)]
    assert blocks == [[True, True], [True, True], [True, False]]


def test_a_topic_of_its_own_takes_over_what_the_plan_says_of_it():
    (stream,) = build_streams(Plan(app="app", rsrcn=ROBOT, revision=3))
    assert (stream.topic, stream.type, stream.mode) == (ACTIONS.topic, ACTIONS.type, ROBOT.mode)
    assert stream.successors == ACTIONS.successors
    (settings,) = settings_of(stream)
    assert (settings.kind, settings.revision) == (StreamKind.COMMAND, 3)
    assert settings.flows == stream.flows == ACTIONS.flows
