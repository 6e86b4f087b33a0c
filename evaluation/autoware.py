"""Autoware.AI 1.14: the coordination nodes beside the paper's, for one choice of launch files.

The paper does not say which launch files it took. Ours are those of the packages themselves, one
for each step of its demo from the sensor to the vehicle's interface: map, localization, detection,
tracking, prediction, mission and motion planning, control.
"""

from collections.abc import Iterator

from evaluation import coordination
from evaluation.app import App
from evaluation.figure import Figure, Tell
from evaluation.place import Place
from rtron.sources.static import ScanOptions

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
    launches=(
        ("common/map_file/launch/points_map_loader.launch", {}),
        ("common/map_file/launch/vector_map_loader.launch", {}),
        ("core_perception/points_downsampler/launch/points_downsample.launch", {}),
        ("core_perception/points_preprocessor/launch/ray_ground_filter.launch", {}),
        ("core_perception/gnss_localizer/launch/nmea2tfpose.launch", {}),
        ("core_perception/lidar_localizer/launch/ndt_matching.launch", {}),
        ("core_perception/autoware_connector/launch/vel_pose_connect.launch", {}),
        (
            "core_perception/lidar_euclidean_cluster_detect/launch/"
            "lidar_euclidean_cluster_detect.launch",
            {},
        ),
        ("core_perception/vision_darknet_detect/launch/vision_yolo3_detect.launch", {}),
        ("core_perception/range_vision_fusion/launch/range_vision_fusion.launch", {}),
        ("core_perception/lidar_imm_ukf_pda_track/launch/imm_ukf_pda_track.launch", {}),
        ("core_perception/naive_motion_predict/launch/naive_motion_predict.launch", {}),
        ("core_planning/waypoint_maker/launch/waypoint_loader.launch", {}),
        ("core_planning/lane_planner/launch/lane_rule_option.launch", {}),
        ("core_planning/lane_planner/launch/lane_select.launch", {}),
        ("core_planning/costmap_generator/launch/costmap_generator.launch", {}),
        ("core_planning/waypoint_planner/launch/astar_avoid.launch", {}),
        ("core_planning/waypoint_planner/launch/velocity_set.launch", {}),
        ("core_planning/pure_pursuit/launch/pure_pursuit.launch", {}),
        ("core_planning/twist_filter/launch/twist_filter.launch", {}),
        ("drivers/as/launch/ssc_interface.launch", {}),
    ),
    environ={"HOME": "/home/user"},
)
PAPER = {"Perception": 11, "Planning": 3, "Control": 2, "FMN": 1, "RSRCN": 1, "MSRCN": 1}


def figures(here: Place, tell: Tell) -> Iterator[Figure]:
    """Count the coordination nodes of the chosen app."""
    tell.progress("autoware")
    graph = AUTOWARE.scan(here, dependencies=False, options=ScanOptions()).graph
    tell.lines(["Autoware.AI 1.14, started by", *(f"  {path}" for path, _ in AUTOWARE.launches)])
    tell.lines([f"  {len(graph.nodes)} nodes, {len(graph.topics)} topics", ""])
    tell.lines([*coordination.rows(PAPER, {"ours": graph}), ""])
    tell.lines([*coordination.topics(graph), ""])
    tell.detail([f"  unresolved: {note.what}: {note.why}" for note in graph.unresolved])
    yield from coordination.figures("autoware", PAPER, graph)
