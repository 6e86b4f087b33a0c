"""The leases of a plan: each contradiction is named, and a plan without one is read as it is."""

from dataclasses import replace

import pytest
from plans import grcn

from rtron.coherence import coherence_problems
from rtron.coherence.leases import LEASABLE_TYPES
from rtron.messages.common.velocity import VELOCITY_TYPES
from rtron.vocabulary import (
    CommanderRank,
    Flow,
    LeaseGroup,
    Mode,
    Plan,
    PolicyName,
    StopButton,
    StopSources,
    StreamKind,
)

FLOWS = (
    Flow(name="flow1", publisher="/teleop", rank=CommanderRank.OPERATOR_ON_SITE),
    Flow(name="flow2", publisher="/nav", rank=CommanderRank.AUTONOMY),
)
BASE = grcn("/cmd_vel", (), (), id="grcn", policy=PolicyName.LEASE, flows=FLOWS, lease="base")
UNKNOWN = (
    "Lease is not for /cmd_vel: of a {} it is not known which message is neutral; it is for "
    "velocities"
)
PLAN = Plan(app="app", grcn=(BASE,), leases=(LeaseGroup(name="base"),))


def messages(plan):
    return [message for _, _, message in coherence_problems(plan)]


def with_base(**changes):
    return replace(PLAN, grcn=(replace(BASE, **changes),))


def test_a_plan_with_a_lease_is_coherent():
    assert messages(PLAN) == []


@pytest.mark.parametrize("type", [*LEASABLE_TYPES, "geometry_msgs/msg/Twist"])
def test_every_velocity_can_be_leased(type):
    assert messages(with_base(type=type)) == []


def test_what_can_be_leased_is_what_is_a_velocity_and_no_limit():
    assert set(LEASABLE_TYPES) == VELOCITY_TYPES - {"std_msgs/Float64", "std_msgs/Float32"}


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"lease": ""}, "Lease needs a lease: say `lease: NAME` on /cmd_vel"),
        ({"lease": "bse"}, "no lease is called bse: did you mean base?"),
        (
            {"mode": Mode.OBSERVE},
            "Lease on /cmd_vel needs `mode: enforce`: who only watches grants nothing",
        ),
        (
            {"type": "trajectory_msgs/JointTrajectory"},
            UNKNOWN.format("trajectory_msgs/JointTrajectory"),
        ),
        ({"type": ""}, UNKNOWN.format("type that is not named")),
        ({"kind": StreamKind.STATE}, UNKNOWN.format("geometry_msgs/Twist")),
        (
            {"flows": (replace(FLOWS[0], publisher="/teleop_*"),)},
            "Lease needs the full name of /teleop_*: two nodes would be one commander",
        ),
    ],
)
def test_what_keeps_a_grcn_from_a_lease_is_named(changes, message):
    assert message in messages(with_base(**changes))


def test_a_lease_has_one_name_and_a_grcn():
    twice = replace(PLAN, leases=PLAN.leases * 2)
    assert messages(twice) == ["two leases have the name base"]
    spare = replace(PLAN, leases=(*PLAN.leases, LeaseGroup(name="arm")))
    assert messages(spare) == ["no GRCN says `lease: arm`"]
    none = replace(PLAN, leases=())
    assert messages(none) == ["no lease is called base: there is none under `leases`"]


def test_the_private_topics_of_a_lease_are_no_streams():
    other = replace(BASE, id="other", topic="/leases/base", policy=PolicyName.BLOCK, lease="")
    assert messages(replace(PLAN, grcn=(BASE, other))) == [
        "the private topics of /leases/base are those of a lease"
    ]


def test_a_commander_has_one_rank_under_one_lease():
    flows = (replace(FLOWS[0], rank=CommanderRank.AGENT), FLOWS[1])
    arm = replace(BASE, id="arm", topic="/arm", flows=flows)
    assert messages(replace(PLAN, grcn=(BASE, arm))) == [
        "/teleop is agent here and operator_on_site elsewhere, under the lease base"
    ]
    other = replace(arm, lease="arm")
    leases = (*PLAN.leases, LeaseGroup(name="arm"))
    assert messages(replace(PLAN, grcn=(BASE, other), leases=leases)) == []


def test_a_lease_that_another_policy_does_not_ask_for_is_no_contradiction():
    assert messages(with_base(policy=PolicyName.BLOCK)) == []


BUTTON = StopButton(name="red", topic="/estop", publisher="/estop_driver")


def with_buttons(*buttons):
    return replace(PLAN, stop_sources=StopSources(buttons=buttons))


def test_a_stop_button_is_coherent():
    assert messages(with_buttons(BUTTON)) == []


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"name": "robot"}, "robot is another source's name: choose another one"),
        ({"topic": "/cmd_vel"}, "/cmd_vel is guarded: a stop must not depend on that"),
        ({"topic": "/rtron/estop"}, "/rtron/estop is the guard's private topic"),
        ({"publisher": "/estop_*"}, "a stop button needs the full name of /estop_*"),
    ],
)
def test_what_no_stop_button_may_be_is_named(changes, message):
    assert messages(with_buttons(replace(BUTTON, **changes))) == [message]


def test_stop_buttons_have_names_and_topics_of_their_own():
    other = replace(BUTTON, topic="/other")
    assert messages(with_buttons(BUTTON, other)) == ["two stop buttons have the name red"]
    other = replace(BUTTON, name="other")
    assert messages(with_buttons(BUTTON, other)) == ["two stop buttons are on /estop"]
