"""AutoRace, whose core node starts ten launch files: guarded, then read again; nothing is run."""

import os
from pathlib import Path

import pytest
from plans import grcn, plan_of

from rtron.planning.instrument import RuntimeLaunchTree, instrument_ros1, write_guarded_launch
from rtron.planning.instrument.common.guarded_launch import GuardFiles
from rtron.sources.launch.common.packages import find_packages
from rtron.sources.static.ros1.app import scan_app

PARTS = (
    "ROBOTIS-GIT/turtlebot3_autorace@391144a",
    "ROBOTIS-GIT/turtlebot3@4ae959e",
    "ROBOTIS-GIT/turtlebot3_simulations@e9d809c",
    "ros-planning/navigation@9ad6441",
    "ros-simulation/gazebo_ros_pkgs@f9e1a46",
    "ros-perception/image_pipeline@69488e6",
)
LAUNCHES = (
    "turtlebot3_gazebo)/launch/turtlebot3_autorace.launch",
    "turtlebot3_gazebo)/launch/turtlebot3_autorace_mission.launch",
    "turtlebot3_autorace_camera)/launch/turtlebot3_autorace_intrinsic_camera_calibration.launch",
    "turtlebot3_autorace_core)/launch/turtlebot3_autorace_core.launch",
)
ENVIRON = {
    "TURTLEBOT3_MODEL": "burger",
    "GAZEBO_MODE": "true",
    "AUTO_IN_CALIB": "action",
    "AUTO_EX_CALIB": "action",
    "AUTO_DT_CALIB": "action",
}
STARTED = 10
PUBLISHERS = {
    "/cmd_vel": ("/control_lane", "/control_parking", "/detect_tunnel", "/move_base"),
    "/control/max_vel": (
        "/detect_level",
        "/detect_parking",
        "/detect_traffic_light",
        "/detect_tunnel",
    ),
}
SUBSCRIBERS = {"/cmd_vel": ("/gazebo",), "/control/max_vel": ("/control_lane",)}
PLAN = plan_of(*(grcn(topic, PUBLISHERS[topic], SUBSCRIBERS[topic]) for topic in PUBLISHERS))


@pytest.fixture(scope="module")
def folders():
    if "RTRON_APPS" not in os.environ:
        pytest.skip("RTRON_APPS names no folder of apps")
    found = [Path(os.environ["RTRON_APPS"], part) for part in PARTS]
    missing = [str(folder) for folder in found if not folder.is_dir()]
    if missing:
        pytest.skip(f"RTRON_APPS lacks {', '.join(missing)}")
    return found


@pytest.fixture(scope="module")
def app(folders, tmp_path_factory):
    """Read the four launch files that are started by hand as one."""
    launch = tmp_path_factory.mktemp("app") / "autorace.launch"
    includes = "".join(f'<include file="$(find {name}"/>\n' for name in LAUNCHES)
    launch.write_text(f"<launch>\n{includes}</launch>\n")
    return scan_app(folders, [(launch, {})], ENVIRON)


@pytest.fixture(scope="module")
def guarded(app, folders, tmp_path_factory):
    started = [
        RuntimeLaunchTree(tree=tree, starter=file.started_by, evidence=(file.evidence,))
        for tree, file in zip(app.trees[1:], app.started, strict=True)
    ]
    result = instrument_ros1(
        app.trees[0],
        PLAN,
        tmp_path_factory.mktemp("out") / "guarded.launch",
        GuardFiles(""),
        started=started,
        packages=find_packages(folders, ENVIRON),
    )
    write_guarded_launch(result)
    return result


@pytest.fixture(scope="module")
def again(guarded, folders):
    """Read the guarded launch as its nodes see their packages."""
    overlay = guarded.folder / "overlay"
    packages = {path.parent for path in overlay.rglob("package.xml")}
    return scan_app([*sorted(packages), *folders], [(guarded.launch, {})], ENVIRON)


def test_all_that_is_planned_has_its_remap(guarded):
    placed = {(remap.node, remap.topic) for remap in guarded.remaps}
    planned = {(node, t) for side in (PUBLISHERS, SUBSCRIBERS) for t in side for node in side[t]}
    assert planned == placed


def test_nothing_stays_open(guarded, app):
    assert len(app.started) == STARTED
    assert guarded.unenforceable == ()


def test_the_core_node_starts_the_copies(again, guarded):
    overlay = guarded.folder / "overlay"
    assert len(again.started) == STARTED
    assert all(file.path.is_relative_to(overlay) for file in again.started)


@pytest.mark.parametrize("topic", PUBLISHERS)
def test_who_published_now_publishes_its_flow_only(again, topic):
    for number, node in enumerate(PUBLISHERS[topic], 1):
        flow = again.graph.publishers(f"/rtron{topic}/flow{number}")
        assert [endpoint.node for endpoint in flow] == [node]
    assert not {e.node for e in again.graph.publishers(topic)} & set(PUBLISHERS[topic])


def test_who_obeyed_the_limit_now_hears_the_guard(again):
    heard = again.graph.subscribers("/rtron/control/max_vel/out")
    assert [endpoint.node for endpoint in heard] == ["/control_lane"]
    assert not again.graph.subscribers("/control/max_vel")
