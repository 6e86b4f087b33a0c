"""What a real guard prevents is an incident in the service: both as their users run them."""

from dataclasses import replace

import pytest
from driven_base import CMD_VEL, CMD_VEL_GUARD, PATIENCE, start_guard
from guarded_drive import FAST, speed_plan
from harness import NODES, ROS_PYTHON, wait_for
from linked_app import FLOW1, OUT, ROBOT
from rostopic import TWIST, say

from bench.service.service_process import ServiceProcess
from rtron.vocabulary import SECOND

pytestmark = pytest.mark.ros1
LOWER = 0.2


@pytest.fixture
def service(tmp_path):
    with ServiceProcess(tmp_path) as service:
        yield service


def patient_plan():
    """Return a plan under which no pause of a busy machine is a stop."""
    plan = speed_plan("linked_drive", after=SECOND)
    (limited,), (node,) = plan.rsrcn.vflows, plan.grcn
    flows = tuple(replace(flow, silent_after=PATIENCE) for flow in limited.flows)
    limits = replace(plan.rsrcn, vflows=(replace(limited, flows=flows),))
    return replace(plan, rsrcn=limits, grcn=(replace(node, flows=flows),))


def start_base(ros1, service):
    """Start a base whose guard is linked to the service; wait until it is connected."""
    token = service.create_token(ROBOT, "guard", robot=ROBOT)
    words = ["--service", service.url, "--token-file", token, "--robot", ROBOT]
    start_guard(ros1, patient_plan(), CMD_VEL_GUARD, *words, "--state-dir", ros1.folder / "state")
    driver = [ROS_PYTHON, NODES / "driver.py", ros1.folder / "driven.txt", "__name:=base"]
    ros1.spawn(*driver, f"{CMD_VEL}:={OUT}")
    wait_for(lambda: (service.state(ROBOT) or {}).get("connected"), what="the guard's connection")


def interventions(service):
    """Return the incidents that are no alarm about a machine that is too slow."""
    listed = service.request(f"/api/v1/incidents?robot={ROBOT}")["incidents"]
    return [each for each in listed if each["kind"] == "intervention"]


def test_an_intervention_of_a_real_guard_is_an_incident_in_the_api(ros1, service):
    start_base(ros1, service)
    revision = service.change(ROBOT, {"rsrcn": {"max_vel_limit": LOWER}})["revision"]
    settings = f"/api/v1/robots/{ROBOT}/settings"
    wait_for(lambda: service.request(settings)["outcome"] == "applied", what="the settings")
    say(ros1, "teleop", CMD_VEL, "geometry_msgs/Twist", TWIST % FAST, 20, f"{CMD_VEL}:={FLOW1}")
    found = wait_for(lambda: interventions(service), what="the incident")[0]
    assert (found["topic"], found["flow"]) == (CMD_VEL, "flow1")
    assert (found["publisher"], found["revision"]) == ("/teleop", revision)
    report = service.request(f"/api/v1/robots/{ROBOT}/incidents/{found['name']}")["report"]
    (topic,) = report["topics"]
    (flow,) = topic["flows"]
    assert max(each or 0 for each in flow["speeds"]) == FAST
    assert max(each or 0 for each in topic["output"]) == pytest.approx(LOWER, abs=0.001)
    assert flow["verdicts"]["modify"] > 0
    titles = [each["title"] for each in report["alternatives"]]
    assert titles == ["without the guard", "under the settings before, revision 0"]
    assert "1.00 m/s instead of 0.20 m/s" in report["alternatives"][0]["sentences"][0]
    assert "0.25 m/s instead of 0.20 m/s" in report["alternatives"][1]["sentences"][0]
    events = service.request(f"/api/v1/events?robot={ROBOT}&kind=guard")["events"]
    assert found["name"] in [each["values"].get("incident") for each in events]
