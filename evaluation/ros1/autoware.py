"""Autoware.AI 1.14: the coordination nodes beside the paper's, for one choice of launch files.

The paper does not say which launch files it took. Ours are those of the packages themselves, one
for each step of its demo from the sensor to the vehicle's interface: map, localization, detection,
tracking, prediction, mission and motion planning, control.
"""

from collections.abc import Iterator

from evaluation.common.datasets import Datasets, Reporter
from evaluation.ros1 import coordination_nodes
from evaluation.ros1.app import App
from figures.figure import Figure
from rtron.sources.static.common.scan_options import ScanOptions

AUTOWARE = App(
    name="autoware",
    repositories=(
        "Autoware-AI/common@5820259",
        "Autoware-AI/core_perception@a4ab7af",
        "Autoware-AI/core_planning@a29221c",
        "Autoware-AI/messages@2159806",
        "Autoware-AI/simulation@7281241",
        "Autoware-AI/utilities@2597906",
        "Autoware-AI/visualization@55c5e55",
        "Autoware-AI/drivers@619bb0a",
    ),
    launches=tuple(
        (f"{package}/launch/{file}.launch", {})
        for package, file in (
            ("common/map_file", "points_map_loader"),
            ("common/map_file", "vector_map_loader"),
            ("core_perception/points_downsampler", "points_downsample"),
            ("core_perception/points_preprocessor", "ray_ground_filter"),
            ("core_perception/gnss_localizer", "nmea2tfpose"),
            ("core_perception/lidar_localizer", "ndt_matching"),
            ("core_perception/autoware_connector", "vel_pose_connect"),
            ("core_perception/lidar_euclidean_cluster_detect", "lidar_euclidean_cluster_detect"),
            ("core_perception/vision_darknet_detect", "vision_yolo3_detect"),
            ("core_perception/range_vision_fusion", "range_vision_fusion"),
            ("core_perception/lidar_imm_ukf_pda_track", "imm_ukf_pda_track"),
            ("core_perception/naive_motion_predict", "naive_motion_predict"),
            ("core_planning/waypoint_maker", "waypoint_loader"),
            ("core_planning/lane_planner", "lane_rule_option"),
            ("core_planning/lane_planner", "lane_select"),
            ("core_planning/costmap_generator", "costmap_generator"),
            ("core_planning/waypoint_planner", "astar_avoid"),
            ("core_planning/waypoint_planner", "velocity_set"),
            ("core_planning/pure_pursuit", "pure_pursuit"),
            ("core_planning/twist_filter", "twist_filter"),
            ("drivers/as", "ssc_interface"),
        )
    ),
    environ={"HOME": "/home/user", "ROS_DISTRO": "melodic"},
)
PAPER = {"Perception": 11, "Planning": 3, "Control": 2, "FMN": 1, "RSRCN": 1, "MSRCN": 1}


def figures(datasets: Datasets, reporter: Reporter) -> Iterator[Figure]:
    """Count the coordination nodes of the chosen app."""
    reporter.progress("autoware")
    graph = AUTOWARE.scan(datasets, dependencies=False, options=ScanOptions()).graph
    reporter.lines(
        ["Autoware.AI 1.14, started by", *(f"  {path}" for path, _ in AUTOWARE.launches)]
    )
    reporter.lines([f"  {len(graph.nodes)} nodes, {len(graph.topics)} topics", ""])
    reporter.lines([*coordination_nodes.rows(PAPER, {"ours": graph}), ""])
    reporter.lines([*coordination_nodes.topics(graph), ""])
    reporter.detail([f"  unresolved: {note.what}: {note.why}" for note in graph.unresolved])
    yield from coordination_nodes.figures("autoware", PAPER, graph)
