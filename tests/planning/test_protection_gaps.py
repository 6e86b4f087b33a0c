"""What a valid plan leaves open, with what follows for the robot; one row a kind and its bounds."""

from dataclasses import replace

import pytest
from app_graphs import AUTORACE, HOME
from plans import grcn, plan_of

from rtron.planning import propose_plan
from rtron.planning.plan_doubts import void_value_warnings
from rtron.planning.protection_gaps import protection_gaps
from rtron.risks import discover_risks
from rtron.vocabulary import (
    RSRCN,
    Flow,
    FpsMonitor,
    GuardedTopic,
    Mode,
    OnSilence,
    PolicyName,
    StreamKind,
    WatchedFlow,
)

TWIST, STRING = "geometry_msgs/Twist", "std_msgs/String"
DRIVE = "ackermann_msgs/msg/AckermannDriveStamped"
RELEASING, STOPPING, BLOCKED = (
    Flow(name=f"f{n}", publisher=f"/f{n}", on_silence=on_silence, block=n == 2)
    for n, on_silence in enumerate((OnSilence.RELEASE, OnSilence.STOP, OnSilence.STOP))
)
NO_STOP = "no stop follows when the publisher falls silent"
SILENT = "nothing stops the robot when the publisher falls silent"
ON = "the robot goes on at its last velocity"
COMMANDS = [
    ({}, ""),
    ({"type": "geometry_msgs/msg/TwistStamped"}, ""),
    ({"kind": StreamKind.STATE}, f"`kind: state` of a {TWIST}: NaN passes, and {SILENT}"),
    ({"kind": StreamKind.ACTION}, f"`kind: action` of a {TWIST}: NaN passes, and {SILENT}"),
    ({"kind": StreamKind.STATE, "type": DRIVE}, f"`kind: state` of a {DRIVE}: NaN passes"),
    ({"kind": StreamKind.STATE, "type": "nav_msgs/Odometry"}, ""),
    ({"kind": StreamKind.STATE, "mode": Mode.OBSERVE}, ""),
    ({"type": ""}, ""),
    ({"type": STRING}, f"which {STRING} stops the robot is not known: {NO_STOP}"),
    ({"type": STRING, "kind": StreamKind.STATE}, ""),
    ({"type": STRING, "kind": StreamKind.ACTION}, ""),
    ({"type": STRING, "mode": Mode.OBSERVE}, ""),
    ({"type": "my_msgs/WalkActionGoal", "topic": "/walk/goal"}, ""),
    ({"block_unapproved": False}, "what any other node publishes on /cmd_vel passes"),
    ({"block_unapproved": False, "mode": Mode.OBSERVE}, ""),
    ({"flows": (RELEASING,)}, f"when all fall silent, {ON}, unless its base stops by itself"),
    ({"flows": (RELEASING, BLOCKED)}, f"when all fall silent, {ON}"),
    ({"flows": (RELEASING, STOPPING)}, ""),
    ({"flows": (BLOCKED,)}, ""),
    ({"flows": (RELEASING,), "type": "std_msgs/Float64"}, NO_STOP),
    ({"uses": ("linear.x", "angular.z")}, ""),
    ({"uses": ("linear.y", "angular.z")}, "`uses` has linear.y and angular.z only: the guard sets"),
    ({"flows": (Flow(name="f", publisher="/nav*"),)}, ""),
    ({"flows": (Flow(name="f", publisher="/*"),)}, "/* of f is every node: no node is a stranger"),
    ({"flows": (Flow(name="f", publisher="/*/**"),)}, "/*/** of f is every node"),
    ({"flows": (STOPPING, Flow(name="f", publisher="/*", block=True))}, ""),
    ({"successors": ("/base", "/base_2")}, ""),
    ({"successors": ("/base", "/base")}, "the successor /base stands twice"),
]


@pytest.mark.parametrize("graph", [HOME, AUTORACE])
def test_a_proposed_plan_leaves_none_of_it_open(graph):
    assert not list(protection_gaps(propose_plan(graph, discover_risks(graph))))


@pytest.mark.parametrize(("settings", "gap"), COMMANDS)
def test_what_a_grcn_leaves_open(settings, gap):
    node = replace(grcn("/cmd_vel", ["/a"], ["/base"]), **settings)
    found = list(protection_gaps(plan_of(node)))
    assert [where for where, _ in found] == (["GRCN grcn_cmd_vel"] if gap else [])
    assert all(gap in message for _, message in found)


CAMERA = WatchedFlow(name="camera", topic="/image", publisher="/camera")
TURNING = "no limit holds for turning on /cmd_vel: set `max_turn_limit`, in rad/s"
PAST = "no limit holds on /cmd_vel, a geometry_msgs/Twist: add it to `vflows`"
OWN = (
    "/nav counts for its own limit: the more frames it publishes, the faster it may drive on "
    "/cmd_vel; give fps a `camera`"
)
LIMITS = [
    ({}, {}, []),
    (
        {"mode": Mode.OBSERVE},
        {},
        ["it only watches: no limit holds on /cmd_vel; set `mode: enforce`"],
    ),
    ({"mode": Mode.OBSERVE, "policy": PolicyName.BLOCK}, {}, []),
    ({"max_vel_limit": 50.0, "max_side_limit": 50.0, "max_turn_limit": 50.0}, {}, []),
    (
        {"max_vel_limit": 51.0},
        {},
        ["max_vel_limit is 51 m/s: nothing that drives is limited by it"],
    ),
    (
        {"max_turn_limit": 57.3},
        {},
        ["max_turn_limit is 57.3 rad/s: nothing that drives is limited by it"],
    ),
    ({"threshold": 10.1}, {}, ["threshold is 10.1 m/frame: nothing that drives is limited by it"]),
    ({"max_vel_limit": 0.0}, {}, ["max_vel_limit is 0 m/s: the robot never moves"]),
    ({"max_turn_limit": None}, {}, [TURNING]),
    ({"max_turn_limit": None}, {"uses": ("linear.x", "angular.z")}, [TURNING]),
    ({"max_turn_limit": None}, {"uses": ("linear.x",)}, []),
    ({"max_turn_limit": None}, {"type": DRIVE}, []),
    ({"max_turn_limit": None, "policy": PolicyName.BLOCK}, {}, []),
    ({}, {"topic": "/other"}, [PAST]),
    ({}, {"topic": "/other", "flows": (Flow(name="v", publisher="/base"),)}, []),
    ({"max_turn_limit": None}, {"topic": "/max_vel", "type": "std_msgs/Float64"}, []),
]


def limited(topic_settings, **settings):
    """Return a plan with a GRCN on /cmd_vel, and an RSRCN that limits it or another topic."""
    topic = GuardedTopic(
        topic="/cmd_vel",
        type=TWIST,
        flows=(Flow(name="vflow1", publisher="/nav"),),
        successors=("/base",),
    )
    rsrcn = RSRCN(
        id="rsrcn",
        mode=Mode.ENFORCE,
        policy=PolicyName.CONSTRAIN,
        max_vel_limit=1.0,
        max_turn_limit=1.0,
        vflows=(replace(topic, **topic_settings),),
    )
    return plan_of(grcn("/cmd_vel", ["/nav"], ["/base"]), rsrcn=replace(rsrcn, **settings))


@pytest.mark.parametrize(("settings", "topic_settings", "gaps"), LIMITS)
def test_where_no_limit_holds(settings, topic_settings, gaps):
    found = list(protection_gaps(limited(topic_settings, **settings)))
    assert found == [("RSRCN", gap) for gap in gaps]


@pytest.mark.parametrize(
    ("node", "camera", "policy", "gaps"),
    [
        ("/nav", None, PolicyName.SAFE, [OWN]),
        ("/nav", None, PolicyName.SAFE_CONSTRAIN, [OWN]),
        ("/nav", None, PolicyName.CONSTRAIN, []),
        ("/nav", CAMERA, PolicyName.SAFE, []),
        ("/detector", None, PolicyName.SAFE, []),
    ],
)
def test_a_driver_that_counts_for_its_own_limit(node, camera, policy, gaps):
    monitor = FpsMonitor(id="fps", node=node, topic="/people", camera=camera)
    plan = replace(limited({}, policy=policy, threshold=0.1), fps_monitor=(monitor,))
    assert list(protection_gaps(plan)) == [("RSRCN", gap) for gap in gaps]


@pytest.mark.parametrize("what", ["*", "/*", "/**", "/a*", "all", "", "/gazebo: a plugin"])
def test_what_is_accepted_in_vain(what):
    plan = plan_of(grcn("/cmd_vel", ["/nav_*"], ["/base"]), accept_unenforceable=(what,))
    help = "write one node's name as `rtron instrument` reports it"
    told = f"warning: plan: `accept_unenforceable` accepts nothing by {what!r}: {help}"
    assert [str(each) for each in void_value_warnings(plan)] == [told]


@pytest.mark.parametrize("what", ["/base", "/nodelet_manager", "/nav_*"])
def test_what_is_accepted_by_its_name(what):
    plan = plan_of(grcn("/cmd_vel", ["/nav_*"], ["/base"]), accept_unenforceable=(what,))
    assert not list(void_value_warnings(plan))
