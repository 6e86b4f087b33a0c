"""AutoRally and TurtleBot against what was observed in them."""

from collections import Counter
from collections.abc import Iterator, Mapping
from functools import partial

from evaluation.common.datasets import Datasets, Part, Reporter
from evaluation.ros1.app import App
from evaluation.ros1.architecture import (
    KINDS,
    Architecture,
    Score,
    graph_architecture,
    is_ignored,
    read_architecture,
    score,
    without_nodes,
)
from evaluation.ros1.rosdiscover import SYSTEMS
from figures.figure import Figure
from rtron.sources.static.common.scan_options import ScanOptions
from rtron.vocabulary import InteractionGraph, Resolution

AUTORALLY = App(
    name="autorally",
    repositories=(
        "AutoRally/autorally@c2692f2",
        "AutoRally/imu_3dm_gx4@c9652c8",
        "ros-drivers/pointgrey_camera_driver@6c3e4cb",
    ),
    dependencies=(
        "tu-darmstadt-ros-pkg/hector_gazebo@fdc01f6",
        "ros-simulation/gazebo_ros_pkgs@f9e1a46",
        "ros-controls/ros_control@5faa68d",
        "ros-controls/ros_controllers@ffe44f3",
        "ros/robot_state_publisher@9afecc8",
        "ros/nodelet_core@54db9fc",
        "ros/dynamic_reconfigure@7df9855",
        "ros/diagnostics@e59ca2b",
        "ros-perception/image_common@21aac6a",
    ),
    launches=(
        ("autorally/autorally_gazebo/launch/autoRallyTrackGazeboSim.launch", {}),
        ("autorally/autorally_control/launch/waypointFollower.launch", {}),
        ("autorally/autorally_control/launch/constantSpeedController.launch", {}),
    ),
    environ={
        "AR_CONFIG_PATH": "{autorally}/autorally_util/config",
        "AR_MPPI_PARAMS_PATH": "{autorally}/autorally_control/src/path_integral/params/",
        "AR_LEFTCAM": "none",
        "AR_RIGHTCAM": "none",
        "AR_LEFTCAM_CONNECTED": "false",
        "AR_RIGHTCAM_CONNECTED": "false",
        "AR_JOYSTICK": "",
        "HOSTNAME": "localhost",
        "MASTER_HOSTNAME": "localhost",
        "ROS_DISTRO": "melodic",
        "ROS_MASTER_URI": "http://localhost:11311",
        "ROSLAUNCH_SSH_UNKNOWN": "0",
    },
)

_GAZEBO = "{turtlebot_simulator}/turtlebot_gazebo"

TURTLEBOT = App(
    name="turtlebot",
    repositories=(
        "turtlebot/turtlebot_simulator@f0fce83",
        "turtlebot/turtlebot_apps@0690ace",
        "turtlebot/turtlebot@fe98e72",
    ),
    dependencies=(
        "yujinrobot/kobuki@b899a20",
        "yujinrobot/kobuki_desktop@c0d2cdc",
        "yujinrobot/yujin_ocs@340fbd5",
        "ros-planning/navigation@50dd13e",
        "ros-perception/depthimage_to_laserscan@f135fbd",
        "ros-perception/image_pipeline@69488e6",
        "ros-simulation/gazebo_ros_pkgs@f9e1a46",
        "ros/robot_state_publisher@9afecc8",
        "ros/nodelet_core@54db9fc",
        "ros/dynamic_reconfigure@7df9855",
        "ros-perception/image_common@21aac6a",
    ),
    launches=(
        ("turtlebot_simulator/turtlebot_gazebo/launch/turtlebot_world.launch", {}),
        ("turtlebot_simulator/turtlebot_gazebo/launch/amcl_demo.launch", {}),
    ),
    environ={
        "TURTLEBOT_GAZEBO_WORLD_FILE": f"{_GAZEBO}/worlds/playground.world",
        "TURTLEBOT_GAZEBO_MAP_FILE": f"{_GAZEBO}/maps/playground.yaml",
        "TURTLEBOT_3D_SENSOR": "kinect",
        "ROS_DISTRO": "kinetic",
    },
)

EXPERIMENTERS: Mapping[str, frozenset[str]] = {
    "turtlebot": frozenset({"/rostopic_2964_1633637419016"})
}
"""Nodes that the experimenter started by hand: the `run_script` of experiment.yml."""

SHORT_LIVED = frozenset({("gazebo_ros", "spawn_model"), ("gazebo_ros", "spawn_urdf")})
"""Programs that end after they did their work, so that the observer came too late for them."""

_SCORED = ("publishers", "subscribers", "services")
_BOUNDS: Mapping[str, tuple[float, float]] = {"autorally": (0.97, 0.90), "turtlebot": (0.95, 0.85)}
"""Precision and recall under the ignore list, and recall without it, at least."""


def part(app: App) -> Part:
    """Return the part that scores an app."""
    return partial(_figures, app)


def _figures(app: App, datasets: Datasets, reporter: Reporter) -> Iterator[Figure]:
    observed = read_architecture(datasets.truth(f"{app.name}/observed.architecture.yml"))
    for variant, dependencies in (("models", False), ("sources", True)):
        reporter.progress(f"{app.name} with {variant}")
        graph = app.scan(datasets, dependencies=dependencies, options=ScanOptions()).graph
        title = f"{app.name}, dependencies from {variant}"
        _report(title, app.name, observed, graph, reporter)
        yield from _scored(f"{app.name}.{variant}", app.name, observed, graph)


def _report(
    title: str, name: str, observed: Architecture, graph: InteractionGraph, reporter: Reporter
) -> None:
    """Tell all scores, as observed and without the observation's known faults."""
    recovered = graph_architecture(graph)
    for what, observed_pairs, found in (
        ("as observed", observed, recovered),
        ("corrected", *_corrected(name, observed, graph)),
    ):
        filtered, raw = (
            score(observed_pairs, found, raw=False),
            score(observed_pairs, found, raw=True),
        )
        rows = [_row(kind, filtered[kind], raw[kind]) for kind in KINDS]
        reporter.lines([f"{title}, {what}", _HEADER, *rows, ""])
    reporter.lines([*_resolutions(graph), ""])
    reporter.detail(_problems(score(observed_pairs, found, raw=True)))
    reporter.detail([f"  unresolved: {note.what}: {note.why}" for note in graph.unresolved])


_HEADER = (
    f"  {'':16}{'observed':>9}{'found':>7}{'hits':>6}{'precision':>11}{'recall':>8}"
    f"{'raw observed':>14}{'precision':>11}{'recall':>8}"
)


def _row(kind: str, filtered: Score, raw: Score) -> str:
    return (
        f"  {kind:16}{len(filtered.observed):9}{len(filtered.recovered):7}{filtered.hits:6}"
        f"{filtered.precision:11.3f}{filtered.recall:8.3f}"
        f"{len(raw.observed):14}{raw.precision:11.3f}{raw.recall:8.3f}"
    )


def _problems(scores: Mapping[str, Score]) -> list[str]:
    """Return a line for each missed or invented pair; `*` marks names the ignore list has."""
    return [
        f"  {kind:15}{line}{' *' if is_ignored(line.rpartition(' ')[2]) else ''}"
        for kind, found in scores.items()
        for line in found.differences()
    ]


def _resolutions(graph: InteractionGraph) -> Iterator[str]:
    counted = Counter(_origin(end.resolution) for end in graph.endpoints)
    total = max(1, sum(counted.values()))
    for origin in ("source", "model", "symbolic"):
        yield f"  endpoints by {origin}: {counted[origin]} ({counted[origin] / total:.0%})"


def _origin(resolution: Resolution) -> str:
    known = {Resolution.MODEL: "model", Resolution.SYMBOLIC: "symbolic"}
    return known.get(resolution, "source")


def _corrected(
    name: str, observed: Architecture, graph: InteractionGraph
) -> tuple[Architecture, Architecture]:
    """Return both without the experimenter's nodes and without short-lived ones."""
    short = {n.name for n in graph.nodes if (n.package, n.executable) in SHORT_LIVED}
    names = {node for node, _ in observed.nodes}
    observed_pairs = without_nodes(observed, EXPERIMENTERS.get(name, ()))
    return observed_pairs, without_nodes(graph_architecture(graph), short - names)


def _scored(
    prefix: str, name: str, observed: Architecture, graph: InteractionGraph
) -> Iterator[Figure]:
    """Give the figures of what was observed, as the peer's are."""
    found = graph_architecture(graph)
    filtered, raw = score(observed, found, raw=False), score(observed, found, raw=True)
    bound, raw_bound = _BOUNDS[name]
    for kind in _SCORED:
        peer, ours = SYSTEMS[name][kind], filtered[kind]
        label = f"{prefix}.{kind}"
        yield Figure(f"{label}.precision", ours.precision, peer.precision, "share", at_least=bound)
        yield Figure(f"{label}.recall", ours.recall, peer.recall, "share", at_least=bound)
        recall = raw[kind].recall
        yield Figure(f"{label}.raw_recall", recall, peer.raw_recall, "share", at_least=raw_bound)
