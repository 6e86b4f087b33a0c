"""The developer's decisions reach the plan, and nothing else in it changes."""

import pytest
import yaml
from demo_runs import PROPOSED

from rtron.demos.runtime.instrumentation import apply_decisions, write_decided_plan
from rtron.errors import InputError
from rtron.planning.plan_file.loader import read_plan
from rtron.vocabulary import Mode, PolicyName


@pytest.fixture
def decided(tmp_path):
    def decided(**decisions):
        (tmp_path / "proposed.yaml").write_text(PROPOSED)
        write_decided_plan(tmp_path / "proposed.yaml", tmp_path / "rtron.yaml", decisions)
        return read_plan(tmp_path / "rtron.yaml")

    return decided


def test_without_decisions_the_plan_stays_as_it_was_proposed(decided, tmp_path):
    assert decided() == read_plan(tmp_path / "proposed.yaml")


def test_a_policy_its_priorities_and_other_settings(decided):
    decision = {
        "policy": "Preemption",
        "flows": {"/move_base": {"priority": 5}},
        "release_after": "2 s",
    }
    commands, goals = decided(grcn={"/cmd_vel": decision}).grcn
    assert (commands.policy, commands.mode) == (PolicyName.PREEMPTION, Mode.ENFORCE)
    assert [flow.priority for flow in commands.flows] == [5, 2]
    assert commands.release_after == 2_000_000_000
    assert goals.policy is PolicyName.PRIORITY_QUEUE


def test_what_counts_for_one_flow(decided):
    _, goals = decided(grcn={"/goal": {"flows": {"/mission": {"timeout": "1 s"}}}}).grcn
    assert (goals.flows[0].timeout, goals.flows[0].priority) == (1_000_000_000, 1)


def test_a_limit_and_the_topics_that_it_is_for(decided):
    limit = {"policy": "Constrain", "max_vel_limit": "0.22 m/s", "vflows": ["/max_vel"]}
    rsrcn = decided(rsrcn=limit).rsrcn
    assert (rsrcn.policy, rsrcn.max_vel_limit) == (PolicyName.CONSTRAIN, 0.22)
    (limits,) = rsrcn.vflows
    assert [flow.publisher for flow in limits.flows] == ["/max_velocity"]
    assert limits.successors == ("/move_base",)


def test_a_rule_on_one_of_the_proposed_actions(decided):
    corners = [{"x": "0 m", "y": "0 m"}, {"x": "1 m", "y": "0 m"}, {"x": "1 m", "y": "1 m"}]
    rule = {"name": "out", "block": ["/goal"], "action": "inside(action.pose.position, pit)"}
    areas = [{"name": "pit", "frame": "map", "polygon": corners}]
    msrcn = decided(msrcn={"aflows": ["/goal"], "areas": areas, "rules": [rule]}).msrcn
    assert [aflow.topic for aflow in msrcn.aflows] == ["/goal"]
    assert [flow.publisher for flow in msrcn.aflows[0].flows] == ["/mission"]
    assert msrcn.areas[0].polygon[1].x == 1.0
    assert msrcn.mode is Mode.ENFORCE


def test_an_fps_monitor_keeps_what_was_proposed_for_it(decided):
    slower = {"node": "/eyes", "topic": "/seen", "window": "3 s"}
    (eyes,) = decided(fps_monitor=[slower]).fps_monitor
    assert (eyes.window, eyes.camera.publisher) == (3_000_000_000, "/camera")


def test_a_client_of_a_bridge_gets_a_flow_under_a_lease(decided):
    ranks = {"/stick": {"rank": "operator_on_site"}, "/bridge/web": {"rank": "agent"}}
    plan = decided(
        clients={"/teleop": ["/bridge/web"]},
        leases=[{"name": "base", "ttl": "2 s"}],
        grcn={"/teleop": {"policy": "Lease", "lease": "base", "flows": ranks}},
        msrcn={"aflows": ["/teleop"]},
        incidents={"keep": "20 s"},
    )
    added = plan.grcn[-1]
    assert (added.id, added.mode, added.policy) == ("grcn_teleop", Mode.ENFORCE, PolicyName.LEASE)
    assert {flow.publisher: str(flow.rank) for flow in added.flows} == {
        node: rank["rank"] for node, rank in ranks.items()
    }
    assert [flow.publisher for flow in plan.msrcn.aflows[0].flows] == list(ranks)
    assert (plan.leases[0].name, plan.incidents.keep) == ("base", 20_000_000_000)


@pytest.mark.parametrize(
    "decisions",
    [
        {"clients": {"/nowhere": ["/bridge/web"]}},
        {"grcn": {"/nowhere": {}}},
        {"grcn": {"/cmd_vel": {"flows": {"/nobody": {"priority": 1}}}}},
        {"grcn": {"/goal": {"flows": {"/nobody": {"timeout": "1 s"}}}}},
        {"msrcn": {"aflows": ["/nowhere"]}},
    ],
)
def test_a_name_that_the_plan_does_not_have_is_refused(decisions):
    with pytest.raises(InputError, match=r"the plan has no .*/no"):
        apply_decisions(yaml.safe_load(PROPOSED), decisions)


def test_the_app_is_called_as_decided(decided):
    assert decided(app="demo, gr").app == "demo, gr"
    assert decided().app == "demo"
