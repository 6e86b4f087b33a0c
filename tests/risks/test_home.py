"""The Home app: what the paper's tables and text say of it must come out of the rules."""

from app_graphs import HOME

from rtron.risks import discover_risks
from rtron.vocabulary import Domain, RiskKind, RiskRole, Severity, Sharing

REPORT = discover_risks(HOME)
RISKS = {risk.id: risk for risk in REPORT.risks}


def topics_of(domain: Domain) -> set[str]:
    kinds = (RiskKind.GR_ST, RiskKind.GR_MT)
    topics = {topic for risk in REPORT.risks if risk.kind in kinds for topic in risk.topics}
    return {topic for topic in topics if REPORT.topic_classes[topic].domain is domain}


def test_it_has_the_size_that_the_paper_gives():
    assert (len(HOME.nodes), len(HOME.topics)) == (21, 125)


def test_the_topics_of_the_grcns_are_the_twelve_of_the_paper():
    assert topics_of(Domain.PERCEPTION) == {
        "/explore_server/status",
        "/move_base/status",
        "/tf",
        "/tf_static",
        "/camera/rgb/image_raw",
        "/camera/depth/image_raw",
        "/move_base/global_costmap/footprint",
        "/move_base/local_costmap/footprint",
    }
    assert topics_of(Domain.PLANNING) == {
        "/move_base/goal",
        "/move_base/cancel",
        "/move_base_simple/goal",
    }
    assert topics_of(Domain.CONTROL) == {"/cmd_vel"}


def test_the_coordination_nodes_are_those_of_the_paper():
    counted = REPORT.coordination_nodes
    assert counted.grcn == {Domain.PERCEPTION: 8, Domain.PLANNING: 3, Domain.CONTROL: 1}
    assert (counted.fps_monitor, counted.rsrcn, counted.msrcn) == (2, 1, 1)


def test_the_examples_of_general_risks():
    cmd_vel = RISKS["GR-ST:/cmd_vel"]
    assert cmd_vel.role_nodes[RiskRole.PUBLISHER] == ("/move_base", "/teleop_twist_keyboard")
    assert cmd_vel.successors == ("/gazebo",)
    assert cmd_vel.severity is Severity.HIGH
    images = RISKS["GR-MT:/find_object_3d:sensor_msgs/Image"]
    assert images.role_nodes[RiskRole.PUBLISHER] == ("/gazebo",)
    assert images.topics == ("/camera/depth/image_raw", "/camera/rgb/image_raw")


def test_the_malicious_rviz_shares_the_goal_and_is_no_successor():
    goal = RISKS["GR-ST:/move_base_simple/goal"]
    assert goal.role_nodes[RiskRole.PUBLISHER] == ("/rviz", "/search_manager")
    assert goal.successors == ("/move_base",)
    assert REPORT.viewers == ("/rviz",)


def test_the_example_of_a_robot_specific_risk():
    finder = RISKS["RSR-image:/find_object_3d"]
    assert "/objects" in finder.topics
    assert finder.successors == ("/search_manager",)
    assert "RSR-image:/person_detector" in RISKS


def test_the_examples_of_mission_specific_risks():
    assert RISKS["MSR-event:/odom"].role_nodes == {RiskRole.EVENT: ("/gazebo",)}
    assert "/move_base" in RISKS["MSR-event:/odom"].successors
    assert RISKS["MSR-action:/rosbot_audio/audio"].role_nodes == {RiskRole.ACTION: ("/rosbot_tts",)}
    assert RISKS["MSR-action:/cmd_vel"].successors == ("/gazebo",)


def test_states_are_told_apart_from_what_is_contended_for():
    merging = {t for t, c in REPORT.topic_classes.items() if c.sharing is Sharing.MERGE}
    assert merging == {"/tf", "/tf_static", "/move_base/status", "/explore_server/status"}


def test_every_rule_could_run():
    assert REPORT.not_run == {}
