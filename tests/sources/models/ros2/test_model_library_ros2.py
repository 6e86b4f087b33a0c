"""Every model of ROS 2's library can be evaluated and followed to its source."""

import pytest
from model_cases import ros2_node_site

from rtron.sources.models import ROS2_LIBRARY, load_models, node_interface

MODELS = load_models(ROS2_LIBRARY)
_FOLDERS = {"publish": "msg", "subscribe": "msg", "service": "srv", "service_client": "srv"}


@pytest.mark.parametrize("name", sorted(n for kind, n in MODELS.by_name if kind == "controller"))
def test_a_controller_has_no_services_of_its_lifecycle(name):
    found = node_interface(MODELS.controller(name), ros2_node_site(name="/arm"), models=MODELS)
    names = {declared.name for declared in found.declarations}
    assert "/arm/transition_event" in names
    assert "/arm/change_state" not in names


@pytest.mark.parametrize("distribution", ["humble", "jazzy", "kilted", "rolling"])
@pytest.mark.parametrize("key", sorted(k for k in MODELS.by_name if k[0] == "node"), ids="/".join)
def test_every_node_of_ros2_is_evaluated_without_parameters(key, distribution):
    at = ros2_node_site(name="/ns/node", environ=[("ROS_DISTRO", distribution)])
    found = node_interface(MODELS.by_name[key], at, models=MODELS)
    assert all("value" not in note.why for note in found.unresolved), found.unresolved
    for declaration in found.declarations:
        assert declaration.name.startswith("/")
        assert "//" not in declaration.name
        folder = _FOLDERS.get(declaration.kind.value, "action")
        typed = declaration.type.split("/")
        assert declaration.type == "" or (len(typed), typed[1]) == (3, folder), declaration
        assert declaration.node in {made.name for made in found.nodes}


def test_every_endpoint_of_nav2_has_its_quality_of_service():
    for (kind, name), model in MODELS.by_name.items():
        nav2 = name.startswith(("nav2_", "opennav_")) and kind in {"node", "part", "plugin"}
        for entry in model.walk() if nav2 else ():
            joins = entry.publish or entry.subscribe
            assert entry.qos or not joins, (name, entry)


PLACELESS = {
    "controller_manager/spawner",
    "rviz2/rviz2",
    "position_controllers/GripperActionController",
}
"""What its command line, its file or an older release tells."""


def test_every_endpoint_of_the_newest_release_names_a_line():
    for (_, name), model in MODELS.by_name.items():
        for entry in model.walk():
            older = "not since" in (entry.condition or "") or "not kilted" in (
                entry.condition or ""
            )
            placed = entry.line or ":" in entry.at
            assert (
                entry.kind is None
                or placed
                or older
                or PLACELESS & {name, *model.node, *model.controller}
            ), (name, entry.name)


TREE = """<root main_tree_to_execute="Main"><BehaviorTree ID="Main"><Sequence>
  <ComputePathToPose goal="{goal}"/><Action ID="Dock" x="1"/><GoalUpdated/>
  <FollowPath server_name="follow_it"/><ClearEntireCostmap service_name="local/clear"/>
  <PlannerSelector topic_name="plan_with"/><IsBatteryLow/>
</Sequence></BehaviorTree></root>"""
POSE_CLIENT = "/robot/driver_navigate_to_pose_rclcpp_node"


def of_tree(path):
    given = {"/**": {"default_nav_to_pose_bt_xml": str(path), "navigators": ["navigate_to_pose"]}}
    model = MODELS.node("nav2_bt_navigator", "bt_navigator")
    found = node_interface(model, ros2_node_site(settings=given), models=MODELS)
    client = [d for d in found.declarations if d.node == POSE_CLIENT and not d.implicit]
    joined = {(d.kind.value, d.name, d.type.rpartition("/")[2]) for d in client}
    return joined - {("publish", "/robot/behavior_tree_log", "BehaviorTreeLog")}, found.unresolved


def test_the_nodes_of_a_tree_of_nav2(tmp_path):
    (tmp_path / "tree.xml").write_text(TREE)
    joined, notes = of_tree(tmp_path / "tree.xml")
    assert joined == {
        ("action_client", "/robot/compute_path_to_pose", "ComputePathToPose"),
        ("action_client", "/robot/follow_it", "FollowPath"),
        ("service_client", "/robot/local/clear", "ClearEntireCostmap"),
        ("subscribe", "/robot/plan_with", "String"),
        ("subscribe", "/battery_status", "BatteryState"),
    }
    assert [note.what for note in notes] == ["tree node Dock of /robot/driver"]


@pytest.mark.parametrize("path", ["", "/opt/navigate_to_pose_w_replanning_and_recovery.xml"])
def test_the_tree_that_nav2_brings(path):
    joined, notes = of_tree(path)
    assert ("action_client", "/robot/backup", "BackUp") in joined
    assert not notes


@pytest.mark.parametrize(("name", "text"), [("gone.xml", None), ("odd.xml", "<root")])
def test_a_tree_that_cannot_be_read_is_noted(tmp_path, name, text):
    if text is not None:
        (tmp_path / name).write_text(text)
    joined, (note,) = of_tree(tmp_path / name)
    assert (joined, note.what) == (set(), f"tree node {name} of /robot/driver")
