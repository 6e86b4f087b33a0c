"""What a preview says of a message, and that it is what the guard's own policies say."""

import json

import pytest
from agent_plan import AGENT, PERSON, PLAN, ROGUE, SPEED, TURN
from bridge_parts import interface_text

from rtron.bridge.agents.guard_report import KNOWN_FOR, GuardReport, read_lease_message
from rtron.bridge.agents.preview import GuardPreview
from rtron.bridge.agents.server import check_agent, read_token
from rtron.bridge.common.message_types import MessageTypes
from rtron.errors import InputError, WireError
from rtron.messages.ros1.service_types import find_interface_text
from rtron.planning.plan_file.loader import parse_plan
from rtron.vocabulary import SECOND

NOW = 500 * SECOND


@pytest.fixture(scope="module")
def preview():
    plan = parse_plan(PLAN)
    return GuardPreview(plan, AGENT, MessageTypes(plan, find_interface_text))


def entry(name, message="", level=0, **values):
    pairs = [{"key": key, "value": value} for key, value in values.items()]
    named = {"name": f"rtron: {name}", "hardware_id": "rtron"}
    return {**named, "level": level, "message": message, "values": pairs}


def reported(*entries, holder=""):
    """Return the report of a guard that blocks nothing, but for these entries."""
    report = GuardReport()
    quiet = entry("rule stay_put", "does not hold")
    rules = entry("rule no_kitchen", "while true", level=1)
    report.take_diagnostics({"status": [quiet, rules, *entries]}, NOW)
    report.take_lease("base", {"holder": holder, "since": 1.0})
    return report


def ahead(speed):
    return {"linear": {"x": speed}}


def pose(x, y, frame="map"):
    return {"header": {"frame_id": frame}, "pose": {"position": {"x": x, "y": y}}}


@pytest.mark.parametrize(
    ("holder", "reason"),
    [
        ("", "nobody holds base"),
        (PERSON, f"{PERSON} (operator_on_site) holds base"),
        (ROGUE, f"{ROGUE} (agent) holds base"),
    ],
)
def test_without_the_lease_nothing_passes(preview, holder, reason):
    judged = preview.judge("/cmd_vel", ahead(0.1), reported(holder=holder), NOW)
    assert (judged.passes, judged.rule, judged.reason) == (False, "Lease (grcn_cmd_vel)", reason)


def test_with_the_lease_what_is_within_the_limits_passes(preview):
    judged = preview.judge("/cmd_vel", ahead(0.1), reported(holder=AGENT), NOW)
    assert (judged.passes, judged.decision, judged.exceeded) == (True, "pass", {})


def test_it_says_what_would_be_with_the_lease(preview):
    judged = preview.judge("/cmd_vel", ahead(0.1), reported(), NOW, as_holder=True)
    assert judged.decision == "pass"


def test_what_is_too_fast_has_the_rule_the_value_and_the_limit(preview):
    judged = preview.judge("/cmd_vel", ahead(0.8), reported(holder=AGENT), NOW)
    assert judged.rule == "Constrain (rsrcn)"
    assert judged.value["speed m/s"] == 0.8
    assert judged.exceeded == {"speed m/s": SPEED}
    assert judged.instead["linear"]["x"] == pytest.approx(SPEED)


def test_what_turns_too_fast_has_its_limit(preview):
    judged = preview.judge("/cmd_vel", {"angular": {"z": 3.0}}, reported(holder=AGENT), NOW)
    assert judged.exceeded == {"turn rad/s": TURN}


def test_a_goal_in_a_forbidden_area_is_dropped_and_another_passes(preview):
    inside = preview.judge("/goal", pose(3, 3), reported(), NOW)
    assert (inside.passes, inside.rule) == (False, "Block (msrcn)")
    assert inside.reason == "rule no_kitchen: the kitchen is forbidden"
    assert preview.judge("/goal", pose(1, 3), reported(), NOW).passes


def test_a_rule_that_blocks_at_the_guard_blocks_here(preview):
    report = reported(entry("rule stay_put", "rule stay_put: it is in the kitchen", level=1))
    judged = preview.judge("/cmd_vel", ahead(0.1), report, NOW, as_holder=True)
    assert judged.reason == "rule stay_put: it is in the kitchen"


def test_a_rule_that_the_guard_does_not_report_blocks(preview):
    report = reported()
    late = NOW + KNOWN_FOR
    report.take_diagnostics({"status": [entry("rule no_kitchen", level=1)]}, late)
    assert not preview.judge("/cmd_vel", ahead(0.1), report, late, as_holder=True).passes


@pytest.mark.parametrize(
    "status",
    [
        entry("/cmd_vel (grcn_cmd_vel, rsrcn)", "stopping: latched stop: robot by ann: x", level=2),
        entry("emergency stop", "by ann: x", level=2),
        entry("alarm 1", "foreign_publisher: x", level=2, topic="/cmd_vel"),
    ],
)
def test_while_a_person_must_act_nothing_passes(preview, status):
    judged = preview.judge("/cmd_vel", ahead(0.1), reported(status), NOW, as_holder=True)
    assert not judged.passes
    assert judged.reason.endswith("x")


def test_a_stop_that_ends_by_itself_refuses_nothing(preview):
    status = entry("/cmd_vel (grcn_cmd_vel, rsrcn)", "stopping: agent is silent", level=2)
    assert preview.judge("/cmd_vel", ahead(0.1), reported(status, holder=AGENT), NOW).passes


@pytest.mark.parametrize("value", [float("nan"), float("inf"), "0.1", True, None, [], 10**400])
def test_what_is_no_number_is_refused_with_its_field(preview, value):
    with pytest.raises(WireError, match=r"linear\.x"):
        preview.judge("/cmd_vel", ahead(value), reported(holder=AGENT), NOW)


@pytest.mark.parametrize("topic", ["/other", "", "/rtron/cmd_vel/out"])
def test_what_the_plan_does_not_guard_is_refused(preview, topic):
    with pytest.raises(WireError, match="does not guard"):
        preview.judge(topic, {}, reported(), NOW)


def test_a_preview_changes_nothing(preview):
    report = reported(holder=AGENT)
    first = [preview.judge("/cmd_vel", ahead(each), report, NOW) for each in (0.1, 9, 0.1)]
    assert first[0] == first[2]


def test_entries_of_other_programs_are_not_the_guards():
    report = GuardReport()
    foreign = entry("emergency stop", "x") | {"hardware_id": "battery"}
    report.take_diagnostics({"status": [foreign]}, NOW)
    assert not report.is_known(NOW)


@pytest.mark.parametrize("text", ["", "[]", "5", "{", "null"])
def test_what_is_no_lease_status_says_nothing(text):
    assert read_lease_message({"data": text}) == {}
    assert read_lease_message({"data": json.dumps({"holder": "/a"})}) == {"holder": "/a"}


DOCK = """
schema: rtron.plan/1
app: docking
ros: 2
msrcn:
  id: msrcn
  mode: enforce
  policy: Block
  aflows:
    - topic: /dock
      type: a/action/Dock
      successors: [/dock_server]
      flows: [{name: agent, publisher: /bridge/agent}]
  eflows:
    - {name: person, topic: /person, publisher: /camera, type: std_msgs/msg/Bool, when: event.data}
  rules:
    - {name: alone, block: [/dock], when: person, reason: a person is there}
"""


@pytest.mark.parametrize("level", [0, 1])
def test_a_goal_of_an_action_of_ros2_is_judged(level):
    plan = parse_plan(DOCK)
    preview = GuardPreview(plan, AGENT, MessageTypes(plan, interface_text))
    report = GuardReport()
    report.take_diagnostics({"status": [entry("rule alone", level=level)]}, NOW)
    judged = preview.judge("/dock", {"berth": 3}, report, NOW)
    assert judged.passes is (level == 0)
    assert ("a person is there" in judged.reason) is (level == 1)


def test_an_agent_has_the_lowest_rank_and_needs_a_lease():
    plan = parse_plan(PLAN)
    check_agent(plan, AGENT)
    with pytest.raises(InputError, match="is operator_on_site, an agent has the rank agent"):
        check_agent(plan, PERSON)
    free = PLAN.replace("policy: Lease\n    lease: base", "policy: Preemption")
    free = free.replace("leases:\n  - {name: base, ttl: 2 s}\n", "")
    for number, rank in enumerate(("operator_on_site", "agent", "agent"), start=1):
        free = free.replace(f"rank: {rank}", f"priority: {number}", 1)
    with pytest.raises(InputError, match="would command without a lease"):
        check_agent(parse_plan(free), AGENT)


def test_a_token_is_read_from_a_file_or_the_environment(tmp_path, monkeypatch):
    monkeypatch.delenv("RTRON_BRIDGE_TOKEN", raising=False)
    with pytest.raises(InputError, match="RTRON_BRIDGE_TOKEN"):
        read_token(None)
    path = tmp_path / "token"
    path.write_text("rtb_x\n")
    assert read_token(path) == "rtb_x"
    monkeypatch.setenv("RTRON_BRIDGE_TOKEN", "rtb_y")
    assert read_token(None) == "rtb_y"
    with pytest.raises(InputError):
        read_token(tmp_path / "none")
