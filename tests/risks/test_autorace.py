"""The AutoRace app: what the paper's tables say of it, as far as they agree with the algorithm."""

from app_graphs import AUTORACE

from rtron.risks import discover_risks
from rtron.vocabulary import Domain, RiskRole, Severity

REPORT = discover_risks(AUTORACE)
RISKS = {risk.id: risk for risk in REPORT.risks}


def detectors(*names: str) -> tuple[str, ...]:
    return tuple(f"/detect_{name}" for name in names)


def test_it_has_the_nodes_of_the_paper():
    assert len(AUTORACE.nodes) == 25


def test_the_coordination_nodes_are_those_of_the_paper_but_for_one_in_planning():
    counted = REPORT.coordination_nodes
    assert counted.grcn == {Domain.PERCEPTION: 16, Domain.PLANNING: 3, Domain.CONTROL: 4}
    assert (counted.fps_monitor, counted.rsrcn, counted.msrcn) == (5, 1, 1)


def test_the_examples_of_general_risks():
    goal = RISKS["GR-ST:/move_base_simple/goal"]
    assert goal.role_nodes[RiskRole.PUBLISHER] == ("/detect_tunnel", "/rviz")
    lane = RISKS["GR-MT:/control_lane:std_msgs/Float64"]
    assert lane.topics == ("/control/max_vel", "/detect/lane")
    assert {"/detect_lane", "/detect_traffic_light"} <= set(lane.role_nodes[RiskRole.PUBLISHER])
    assert not lane.one_to_one
    assert RISKS["GR-MT:/core_mode_decider:std_msgs/UInt8"].one_to_one


def test_the_examples_of_robot_specific_risks():
    assert "/detect/traffic_sign" in RISKS["RSR-image:/detect_sign"].topics
    assert RISKS["RSR-image:/detect_sign"].successors == ("/core_mode_decider",)
    publishers = RISKS["RSR-max_vel:/control/max_vel"].role_nodes[RiskRole.MAX_VEL]
    assert publishers == (
        "/detect_level",
        "/detect_parking",
        "/detect_traffic_light",
        "/detect_tunnel",
    )
    images = sorted(risk_id for risk_id in RISKS if risk_id.startswith("RSR-image"))
    assert images == [
        f"RSR-image:/detect_{n}" for n in ("lane", "level", "parking", "sign", "traffic_light")
    ]


def test_the_examples_of_mission_specific_risks():
    tunnel = RISKS["MSR-event:/detect/tunnel_stamped"]
    assert tunnel.role_nodes == {RiskRole.EVENT: ("/detect_tunnel",)}
    assert tunnel.successors == ("/core_node_controller",)
    assert "/detect_tunnel" in RISKS["MSR-action:/cmd_vel"].role_nodes[RiskRole.ACTION]


def test_only_untrusted_nodes_make_a_general_risk_high():
    high = {risk_id for risk_id, risk in RISKS.items() if risk.severity is Severity.HIGH}
    general = {risk_id for risk_id in high if risk_id.startswith("GR")}
    assert general == {"GR-ST:/cmd_vel", "GR-ST:/move_base_simple/goal"}
