"""The private topics of a node in a cell, and which of them somebody outside has a side in."""

import pytest
from plans import grcn, plan_of

from rtron.vocabulary import CellTopics, Mode, cell_topics, may_pass

OUT, FLOW = "/rtron/cmd_vel/out", "/rtron/cmd_vel/flow1"


def cell_of(**parts):
    names = {"subscribed": (), "published": (), "shared": ()} | parts
    return CellTopics(**{part: frozenset(each) for part, each in names.items()})


def test_a_driver_hears_what_the_guard_sends_it():
    plan = plan_of(grcn("/cmd_vel", ["/nav"], ["/base"]), cell=("/base",))
    assert cell_topics(plan, "/base") == cell_of(subscribed=[OUT])


def test_what_a_node_outside_hears_too_is_shared():
    plan = plan_of(grcn("/cmd_vel", ["/nav"], ["/base", "/arm"]), cell=("/base",))
    assert cell_topics(plan, "/base") == cell_of(subscribed=[OUT], shared=[OUT])
    both = plan_of(grcn("/cmd_vel", ["/nav"], ["/base", "/arm"]), cell=("/base", "/arm"))
    assert cell_topics(both, "/base") == cell_of(subscribed=[OUT])


def test_a_node_that_sends_has_its_flow():
    plan = plan_of(grcn("/cmd_vel", ["/nav"], ["/base"]), cell=("/nav",))
    assert cell_topics(plan, "/nav") == cell_of(published=[FLOW])


def test_a_node_that_is_not_planned_or_only_observed_has_none():
    plan = plan_of(grcn("/cmd_vel", ["/nav"], ["/base"]), cell=("/lidar",))
    observed = plan_of(grcn("/cmd_vel", ["/nav"], ["/base"], mode=Mode.OBSERVE), cell=("/base",))
    assert cell_topics(plan, "/lidar") == cell_topics(observed, "/base") == cell_of()


@pytest.mark.parametrize("name", ["/odom", "/arm/joint_states", "/rtron", "/rtron_2/odom"])
def test_a_full_name_that_is_not_the_guards_may_pass(name):
    assert may_pass(name)


@pytest.mark.parametrize(
    "name", [OUT, "/rtron/x", "odom", "~odom", "", "/", "//rtron/x", "/odom/", "/odom\n", "/odöm"]
)
def test_no_name_of_the_guard_and_none_that_a_master_resolves_may_pass(name):
    assert not may_pass(name)
