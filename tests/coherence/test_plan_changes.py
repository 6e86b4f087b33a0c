"""What another plan may change in a running guard, and what needs a new launch."""

from dataclasses import fields, replace

import pytest
from plans import grcn

from rtron.coherence import plan_changes, relaunch_reasons
from rtron.vocabulary import (
    MSRCN,
    RSRCN,
    Area,
    Audit,
    CommanderRank,
    Domain,
    EventFlow,
    Flow,
    FpsMonitor,
    FrameSource,
    GuardedTopic,
    IncidentRecording,
    LeaseGroup,
    MessageDefinition,
    MissionRule,
    Mode,
    OnError,
    OnForeign,
    OnSilence,
    Plan,
    Point,
    PolicyName,
    Sharing,
    StopButton,
    StopProfile,
    StopSources,
    StreamKind,
    Supervision,
    Transform,
    UnguardedPath,
    WatchedFlow,
    WhenUnknown,
)

pytestmark = pytest.mark.covered

FLOW = Flow(name="flow1", publisher="/teleop")
GOAL = GuardedTopic(topic="/goal", type="geometry_msgs/PoseStamped", flows=(FLOW,))
NIGHT = EventFlow(name="night", topic="/night", publisher="/clock", type="std_msgs/Bool")
RULE = MissionRule(name="quiet", when="night", block=("/goal",))
PLAN = Plan(
    app="small",
    grcn=(grcn("/cmd_vel", (), ["/base"], id="drive", sharing=next(iter(Sharing)), flows=(FLOW,)),),
    rsrcn=RSRCN(id="speed", mode=Mode.ENFORCE, policy=PolicyName.SAFE, vflows=(GOAL,)),
    msrcn=MSRCN(
        id="mission",
        mode=Mode.ENFORCE,
        policy=PolicyName.BLOCK,
        aflows=(GOAL,),
        eflows=(NIGHT,),
        rules=(RULE,),
    ),
    fps_monitor=(FpsMonitor(id="eyes", node="/signs", topic="/signs/image"),),
    leases=(LeaseGroup(name="base"),),
)
LOCKED_RULE = replace(RULE, name="kept", mandatory=True)
LOCKED_MISSION = replace(PLAN, msrcn=replace(PLAN.msrcn, rules=(LOCKED_RULE, RULE)))
LOCKED_SPEED = replace(PLAN, rsrcn=replace(PLAN.rsrcn, mandatory=PolicyName.SAFE))


def with_flow(plan=PLAN, **values):
    return with_grcn(plan, flows=(replace(FLOW, **values),))


def with_grcn(plan=PLAN, **values):
    return replace(plan, grcn=(replace(plan.grcn[0], **values),))


def with_rsrcn(plan=PLAN, **values):
    return replace(plan, rsrcn=replace(plan.rsrcn, **values))


def with_msrcn(plan=PLAN, **values):
    return replace(plan, msrcn=replace(plan.msrcn, **values))


def with_event(plan=PLAN, **values):
    return with_msrcn(plan, eflows=(replace(NIGHT, **values),))


def with_monitor(plan=PLAN, **values):
    return replace(plan, fps_monitor=(replace(plan.fps_monitor[0], **values),))


AREA = Area(name="dock", frame="map", polygon=(Point(x=0, y=0), Point(x=1, y=0), Point(x=0, y=1)))
OTHER_RULES = (replace(RULE, when="!night"), MissionRule(name="new", block=("flow1",)))
MISSION_CHANGES = {
    "policy": {"policy": PolicyName.SAFE},
    "areas": {"areas": (AREA,)},
    "transforms": {"transforms": (Transform(source="a", target="b"),)},
}
EVENT_CHANGES = {
    "when": "event.data",
    "present": 5,
    "silent": 5,
    "max_age": 5,
    "on_silence": WhenUnknown.SET,
    "on_error": WhenUnknown.SET,
}
SPEED_CHANGES = {
    "policy": PolicyName.CONSTRAIN,
    "threshold": 0.5,
    "max_vel_limit": 0.5,
    "max_turn_limit": 0.5,
    "max_side_limit": 0.5,
    "max_accel_limit": 0.5,
    "lowest": 0.5,
}
FLOW_CHANGES = {
    "priority": 7,
    "block": True,
    "timeout": 9,
    "silent_after": 9,
    "on_silence": list(OnSilence)[1],
    "on_error": list(OnError)[1],
    "rank": list(CommanderRank)[1],
}
ALLOWED = [
    *(with_flow(**{key: value}) for key, value in FLOW_CHANGES.items()),
    with_grcn(policy=PolicyName.BLOCK),
    with_grcn(release_after=1),
    with_grcn(max_age=1),
    with_grcn(max_hold=1),
    *(with_rsrcn(**{key: value}) for key, value in SPEED_CHANGES.items()),
    with_rsrcn(vflows=(replace(GOAL, flows=(replace(FLOW, block=True),)),)),
    *(with_msrcn(**values) for values in MISSION_CHANGES.values()),
    with_msrcn(rules=OTHER_RULES),
    with_msrcn(rules=()),
    *(with_event(**{key: value}) for key, value in EVENT_CHANGES.items()),
    with_monitor(window=5),
    with_monitor(silent_after=5),
    replace(PLAN, leases=(LeaseGroup(name="base", ttl=1, service=list(CommanderRank)[1]),)),
    replace(PLAN, revision=3),
    replace(PLAN, unguarded=(UnguardedPath(what="/kill", why="a service"),)),
    with_flow(LOCKED_MISSION, priority=7),
    with_msrcn(LOCKED_MISSION, rules=(LOCKED_RULE, *OTHER_RULES)),
]


def base_of(plan):
    return LOCKED_MISSION if plan.msrcn and LOCKED_RULE in plan.msrcn.rules else PLAN


@pytest.mark.parametrize("new", ALLOWED)
def test_what_needs_no_launch_may_change(new):
    assert new != base_of(new)
    assert list(relaunch_reasons(base_of(new), new)) == []


def test_a_plan_needs_no_launch_for_itself():
    assert list(relaunch_reasons(PLAN, PLAN)) == []
    assert list(relaunch_reasons(Plan(app="a"), Plan(app="a"))) == []


REFUSED = {
    "app": replace(PLAN, app="other"),
    "ros": replace(PLAN, ros=2),
    "grcn": replace(PLAN, grcn=()),
    "grcn drive: id": with_grcn(id="drove"),
    "grcn drive: topic": with_grcn(topic="/cmd"),
    "grcn drive: type": with_grcn(type="x/Y"),
    "grcn drive: domain": with_grcn(domain=list(Domain)[-1]),
    "grcn drive: kind": with_grcn(kind=list(StreamKind)[-1]),
    "grcn drive: sharing": with_grcn(sharing=list(Sharing)[-1]),
    "grcn drive: mode": with_grcn(mode=Mode.OBSERVE),
    "grcn drive: flows": with_grcn(flows=()),
    "grcn drive: flows flow1: name": with_flow(name="flow2"),
    "grcn drive: flows flow1: publisher": with_flow(publisher="/stranger"),
    "grcn drive: successors": with_grcn(successors=()),
    "grcn drive: successors 1": with_grcn(successors=("/other",)),
    "grcn drive: queue_size": with_grcn(queue_size=1),
    "grcn drive: done": with_grcn(done="/done"),
    "grcn drive: block_unapproved": with_grcn(block_unapproved=False),
    "grcn drive: uses": with_grcn(uses=("linear.x",)),
    "grcn drive: lease": with_grcn(lease="base"),
    "rsrcn": replace(PLAN, rsrcn=None),
    "rsrcn: id": with_rsrcn(id="pace"),
    "rsrcn: mode": with_rsrcn(mode=Mode.OBSERVE),
    "rsrcn: mandatory": with_rsrcn(mandatory=PolicyName.SAFE),
    "rsrcn: vflows /goal: topic": with_rsrcn(vflows=(replace(GOAL, topic="/x"),)),
    "rsrcn: iflows": with_rsrcn(iflows=(WatchedFlow(name="i", topic="/i", publisher="/p"),)),
    "msrcn": replace(PLAN, msrcn=None),
    "msrcn: id": with_msrcn(id="task"),
    "msrcn: mode": with_msrcn(mode=Mode.OBSERVE),
    "msrcn: aflows": with_msrcn(aflows=()),
    "msrcn: aflows /goal: type": with_msrcn(aflows=(replace(GOAL, type="x/Y"),)),
    "msrcn: rules": with_msrcn(rules=(LOCKED_RULE, RULE)),
    "msrcn: eflows": with_msrcn(eflows=()),
    "msrcn: eflows night: topic": with_event(topic="/day"),
    "msrcn: eflows night: publisher": with_event(publisher="/sun"),
    "msrcn: eflows night: type": with_event(type="x/Y"),
    "msrcn: eflows night: frame": with_event(frame="map"),
    "fps_monitor": replace(PLAN, fps_monitor=()),
    "fps_monitor eyes: node": with_monitor(node="/x"),
    "fps_monitor eyes: topic": with_monitor(topic="/x"),
    "fps_monitor eyes: source": with_monitor(source=list(FrameSource)[-1]),
    "fps_monitor eyes: camera": with_monitor(
        camera=WatchedFlow(name="c", topic="/c", publisher="/p")
    ),
    "leases": replace(PLAN, leases=()),
    "leases base: name": replace(PLAN, leases=(LeaseGroup(name="arm"),)),
    "stop_sources: buttons": replace(
        PLAN, stop_sources=StopSources(buttons=(StopButton(name="b", topic="/b", publisher="/p"),))
    ),
    "stop_sources: second_person": replace(PLAN, stop_sources=StopSources(second_person=1)),
    "stop: decel": replace(PLAN, stop=StopProfile(decel=0.1)),
    "audit: on_foreign": replace(PLAN, audit=Audit(on_foreign=list(OnForeign)[-1])),
    "audit: period": replace(PLAN, audit=Audit(period=1)),
    "supervision: kill_after": replace(PLAN, supervision=Supervision(kill_after=1)),
    "incidents: keep": replace(PLAN, incidents=IncidentRecording(keep=0)),
    "messages": replace(PLAN, messages=(MessageDefinition(type="x/Y", definition=""),)),
    "cell": replace(PLAN, cell=("/base",)),
    "accept_unenforceable": replace(PLAN, accept_unenforceable=("/x",)),
}


@pytest.mark.parametrize(("place", "new"), REFUSED.items())
def test_everything_else_needs_a_new_launch(place, new):
    assert new != PLAN
    assert list(relaunch_reasons(PLAN, new)) == [place]
    assert list(relaunch_reasons(new, PLAN))


@pytest.mark.parametrize(
    "new",
    [
        *(with_msrcn(LOCKED_MISSION, **values) for values in MISSION_CHANGES.values()),
        *(with_event(LOCKED_MISSION, **{key: value}) for key, value in EVENT_CHANGES.items()),
        with_msrcn(LOCKED_MISSION, rules=(RULE,)),
        with_msrcn(LOCKED_MISSION, rules=(replace(LOCKED_RULE, mandatory=False), RULE)),
        with_msrcn(LOCKED_MISSION, rules=(replace(LOCKED_RULE, when="!night"), RULE)),
        with_msrcn(LOCKED_MISSION, rules=(replace(LOCKED_RULE, block=("flow1",)), RULE)),
    ],
)
def test_a_mandatory_rule_and_what_it_depends_on_stays(new):
    assert len(list(relaunch_reasons(LOCKED_MISSION, new))) == 1


@pytest.mark.parametrize(
    "new",
    [
        *(with_rsrcn(LOCKED_SPEED, **{key: value}) for key, value in SPEED_CHANGES.items()),
        with_rsrcn(LOCKED_SPEED, mandatory=None),
        with_monitor(LOCKED_SPEED, window=5),
        with_monitor(LOCKED_SPEED, silent_after=5),
    ],
)
def test_a_mandatory_policy_and_what_it_depends_on_stays(new):
    assert len(list(relaunch_reasons(LOCKED_SPEED, new))) == 1


def test_every_difference_is_named():
    new = with_flow(with_grcn(topic="/x"), publisher="/stranger")
    assert list(relaunch_reasons(PLAN, new)) == [
        "grcn drive: topic",
        "grcn drive: flows flow1: publisher",
    ]


def test_each_changeable_field_is_one_that_its_part_has():
    for table in (plan_changes._CHANGEABLE, plan_changes._LIMITS, plan_changes._MISSION):
        for part, names in table.items():
            assert names <= {each.name for each in fields(part)}
