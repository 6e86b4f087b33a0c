"""Every figure of ours in docs/paper.md is what the code gives, and its examples are found."""

from pathlib import Path

import pytest
from app_graphs import AUTORACE, HOME

from rtron.planning import propose_plan
from rtron.risks import default_lists, discover_risks
from rtron.vocabulary import Domain, RiskKind, RiskRole

PAGE = (Path(__file__).parents[2] / "docs" / "paper.md").read_text(encoding="utf-8")
APPS = {"Home": HOME, "AutoRace": AUTORACE}
REPORTS = {app: discover_risks(graph) for app, graph in APPS.items()}
ROWS = [tuple(cell.strip() for cell in row.split("|")[1:-1]) for row in PAGE.splitlines()]

GRCN_TOPICS = {
    "Perception": "/camera/depth/image_raw /camera/rgb/image_raw /explore_server/status "
    "/move_base/global_costmap/footprint /move_base/local_costmap/footprint /move_base/status "
    "/tf /tf_static",
    "Planning": "/move_base/cancel /move_base/goal /move_base_simple/goal",
    "Control": "/cmd_vel",
}
"""The topics of the GRCNs of Home, as the paper lists them."""

EXAMPLES = [
    ("Home", "/move_base", "/cmd_vel", "GR-ST:/cmd_vel"),
    ("Home", "/teleop_twist_keyboard", "/cmd_vel", "GR-ST:/cmd_vel"),
    ("Home", "/gazebo", "/camera/depth/image_raw", "GR-MT:/find_object_3d:sensor_msgs/Image"),
    ("Home", "/gazebo", "/camera/rgb/image_raw", "GR-MT:/find_object_3d:sensor_msgs/Image"),
    ("Home", "/find_object_3d", "/objects", "RSR-image:/find_object_3d"),
    ("Home", "/move_base", "/odom", "MSR-event:/odom"),
    ("Home", "/rosbot_tts", "/rosbot_audio/audio", "MSR-action:/rosbot_audio/audio"),
    ("AutoRace", "/detect_tunnel", "/move_base_simple/goal", "GR-ST:/move_base_simple/goal"),
    ("AutoRace", "/rviz", "/move_base_simple/goal", "GR-ST:/move_base_simple/goal"),
    ("AutoRace", "/detect_lane", "/detect/lane", "GR-MT:/control_lane:std_msgs/Float64"),
    (
        "AutoRace",
        "/detect_traffic_light",
        "/control/max_vel",
        "GR-MT:/control_lane:std_msgs/Float64",
    ),
    ("AutoRace", "/detect_sign", "/detect/traffic_sign", "RSR-image:/detect_sign"),
    ("AutoRace", "/detect_parking", "/control/max_vel", "RSR-max_vel:/control/max_vel"),
    (
        "AutoRace",
        "/core_node_controller",
        "/detect/tunnel_stamped",
        "MSR-event:/detect/tunnel_stamped",
    ),
    ("AutoRace", "/detect_tunnel", "/cmd_vel", "MSR-action:/cmd_vel"),
]
"""The app, node, topic and risk of each example of a high-risk node in the paper."""


@pytest.mark.parametrize("app", APPS)
def test_the_numbers_of_coordination_nodes(app):
    counted = REPORTS[app].coordination_nodes
    domains = (Domain.PERCEPTION, Domain.PLANNING, Domain.CONTROL)
    numbers = [counted.grcn[domain] for domain in domains]
    numbers += [counted.fps_monitor, counted.rsrcn, counted.msrcn]
    assert (app, "ours", *map(str, numbers)) in ROWS
    assert set(counted.grcn) == set(domains)


@pytest.mark.parametrize("domain", GRCN_TOPICS)
def test_the_topics_of_the_grcns_of_home(domain):
    report = REPORTS["Home"]
    general = (RiskKind.GR_ST, RiskKind.GR_MT)
    risky = {topic for risk in report.risks if risk.kind in general for topic in risk.topics}
    topics = [t for t in sorted(risky) if report.topic_classes[t].domain.value == domain]
    assert topics == GRCN_TOPICS[domain].split()


def test_the_plan_has_a_grcn_for_each_but_one_for_an_action():
    report = REPORTS["Home"]
    guarded = {grcn.topic for grcn in propose_plan(HOME, report).grcn}
    named = {topic for topics in GRCN_TOPICS.values() for topic in topics.split()}
    assert named - guarded == {"/move_base/cancel", "/move_base/status"}
    assert guarded <= named


@pytest.mark.parametrize(("app", "node", "topic", "risk_id"), EXAMPLES)
def test_an_example_is_found_as_the_page_says(app, node, topic, risk_id):
    risk = next(risk for risk in REPORTS[app].risks if risk.id == risk_id)
    assert topic in risk.topics
    high_risk = {name for nodes in risk.role_nodes.values() for name in nodes}
    as_successor = f"`{node}` on `{topic}`" in " ".join(PAGE.split())
    assert (node in high_risk) != as_successor
    assert not as_successor or node in risk.successors


def test_the_actions_and_events_of_home():
    risks = REPORTS["Home"].risks
    actions = sorted(t for risk in risks if RiskRole.ACTION in risk.role_nodes for t in risk.topics)
    guarded = ["/cmd_vel", "/explore_server/goal", "/move_base/goal", "/move_base_simple/goal"]
    guarded.append("/rosbot_audio/audio")
    assert actions == sorted([*guarded, "/move_base/current_goal"])
    msrcn = propose_plan(HOME, REPORTS["Home"]).msrcn
    assert [topic.topic for topic in msrcn.aflows] == guarded
    events = {flow.topic for flow in msrcn.eflows}
    assert events == {"/objects", "/person_detector/detections", "/odom"}
    assert [t for risk in risks if RiskRole.EVENT in risk.role_nodes for t in risk.topics] == [
        "/odom",
        "/person_detector/detections",
    ]


def test_the_words_of_recognitions():
    words = "detect people person pedestrian human face object recogni gesture"
    assert list(default_lists().recog_topic_name) == words.split()


@pytest.mark.parametrize("app", APPS)
def test_the_sizes_of_the_apps_beside_their_times(app):
    graph = APPS[app]
    assert f"{app} ({len(graph.nodes)} nodes, {len(graph.topics)} topics" in PAGE
