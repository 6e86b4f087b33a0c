"""A dry run of real nodes, from the guard's start to the plan that fits what they did."""

import signal

import pytest
from driven_base import CMD_VEL_GUARD, drive_plan, start_guard
from harness import wait_for

from rtron.planning.plan_file.loader import read_plan
from rtron.sources.run_json import read_run

pytestmark = pytest.mark.ros1
FLOW1, FLOW2 = "/rtron/cmd_vel/flow1", "/rtron/cmd_vel/flow2"


def figures(path):
    """Return the figures of each flow that are in a file by now."""
    return {flow.flow: flow for flow in read_run(path).streams[0].flows} if path.exists() else {}


@pytest.mark.long
def test_a_dry_run_ends_in_a_plan_that_fits_it(ros1, tmp_path):
    run, tuned = tmp_path / "run.json", tmp_path / "tuned.yaml"
    guard = start_guard(ros1, drive_plan(), CMD_VEL_GUARD, "--dry-run", "--measurements", run)
    wait_for(run.exists, what="figures from the start")
    ros1.node("nav.py", "/nav", f"/cmd_vel:={FLOW1}")
    ros1.node("rogue.py", "/rogue", "50", f"/cmd_vel:={FLOW2}")
    ros1.node("rogue.py", "/by_hand", "20")
    wait_for(lambda: ros1.received(CMD_VEL_GUARD, FLOW1) >= 120, what="what navigation says")
    assert wait_for(lambda: figures(run)["flow1"].messages, what="figures while it runs")
    guard.stop(signal.SIGINT)
    assert guard.code == 0, guard.log
    found = figures(run)
    assert found["flow1"].messages >= 120
    assert 0 < found["flow1"].gaps.p50 <= found["flow1"].gaps.max
    assert found["flow2"].messages > 200
    assert found["flow2"].refusals[0].count > 200
    assert found["unapproved"].messages > 100
    assert read_run(run).streams[0].strangers == ("/by_hand",)
    plan = tmp_path / "rtron.yaml"
    said = ros1.rtron("plan", "--from-run", run, "--plan", plan, "-o", tuned)
    wait_for(lambda: said.ended, what="the tuned plan")
    assert said.code == 0, said.log
    assert "/by_hand is not in the plan" in " ".join(said.log.split())
    before, after = read_plan(plan).grcn[0], read_plan(tuned).grcn[0]
    longest = found["flow1"].gaps.max
    assert after.release_after != before.release_after or after.flows != before.flows
    assert longest < after.release_after
    assert longest < after.flows[0].silent_after
    assert [flow.priority for flow in after.flows] == [flow.priority for flow in before.flows]
    start_guard(ros1, read_plan(tuned), CMD_VEL_GUARD)
    wait_for(lambda: ros1.received(CMD_VEL_GUARD, FLOW1) >= 50, what="navigation, guarded")
