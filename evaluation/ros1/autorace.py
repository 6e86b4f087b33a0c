"""AutoRace, the paper's app, against what was read in its source by hand."""

from collections.abc import Iterator

from evaluation.common.datasets import Datasets, Reporter
from evaluation.ros1 import coordination_nodes
from evaluation.ros1.app import App
from evaluation.ros1.manual_truth import ManualTruth, read_truth
from figures.figure import Figure
from rtron.sources.static.common.scan_options import ScanOptions
from rtron.vocabulary import Direction, InteractionGraph

_NAME = "turtlebot3_autorace"
_AUTORACE = f"{_NAME}/{_NAME}"

AUTORACE = App(
    name="autorace",
    repositories=(
        "ROBOTIS-GIT/turtlebot3_autorace@391144a",
        "ROBOTIS-GIT/turtlebot3@4ae959e",
        "ROBOTIS-GIT/turtlebot3_simulations@e9d809c",
    ),
    dependencies=(
        "ros-planning/navigation@9ad6441",
        "ros-perception/image_pipeline@69488e6",
        "ros-perception/image_common@21aac6a",
        "ros/robot_state_publisher@9afecc8",
        "ros-simulation/gazebo_ros_pkgs@f9e1a46",
    ),
    launches=tuple(
        (path, {})
        for path in (
            "turtlebot3_simulations/turtlebot3_gazebo/launch/turtlebot3_autorace.launch",
            "turtlebot3_simulations/turtlebot3_gazebo/launch/turtlebot3_autorace_mission.launch",
            f"{_AUTORACE}_camera/launch/{_NAME}_intrinsic_camera_calibration.launch",
            f"{_AUTORACE}_core/launch/{_NAME}_core.launch",
        )
    ),
    environ={
        "TURTLEBOT3_MODEL": "burger",
        "ROS_DISTRO": "noetic",
        "GAZEBO_MODE": "true",
        "AUTO_IN_CALIB": "action",
        "AUTO_EX_CALIB": "action",
        "AUTO_DT_CALIB": "action",
    },
)
PAPER = {"Perception": 16, "Planning": 2, "Control": 4, "FMN": 5, "RSRCN": 1, "MSRCN": 1}


def figures(datasets: Datasets, reporter: Reporter) -> Iterator[Figure]:
    """Score the app, its dependencies known by models or by their source."""
    truth = read_truth(datasets.truth("autorace.yaml"))
    for variant, dependencies in (("models", False), ("sources", True)):
        reporter.progress(f"autorace with {variant}")
        graph = AUTORACE.scan(datasets, dependencies=dependencies, options=ScanOptions()).graph
        yield from _scored(f"autorace.{variant}", truth, graph, reporter)
        reporter.lines(
            ["", *coordination_nodes.rows(PAPER, {variant: graph, "truth": truth.graph()}), ""]
        )
        reporter.lines([*coordination_nodes.differences(graph, truth.graph()), ""])
        reporter.detail([*coordination_nodes.topics(graph), ""])
        reporter.detail([f"  unresolved: {note.what}: {note.why}" for note in graph.unresolved])
        yield from coordination_nodes.figures(f"autorace.{variant}", PAPER, graph)


def _scored(
    name: str, truth: ManualTruth, graph: InteractionGraph, reporter: Reporter
) -> Iterator[Figure]:
    all_scores, first_party = truth.score(graph), truth.score(graph, first_party=True)
    explicit = truth.score(graph, explicit=True)
    published, subscribed = (
        first_party.hits_of(Direction.PUBLISH),
        first_party.hits_of(Direction.SUBSCRIBE),
    )
    dead = len(all_scores.reported & all_scores.dead)
    reporter.lines(
        [
            (
                f"{name}: {len(graph.nodes)} nodes, "
                f"{all_scores.matched_nodes} of the truth's {all_scores.nodes}"
            ),
            f"  all          precision {all_scores.precision:.3f} recall {all_scores.recall:.3f}",
            f"  explicit     precision {explicit.precision:.3f} recall {explicit.recall:.3f}",
            f"  first party  precision {first_party.precision:.3f} recall {first_party.recall:.3f}",
            f"  first party  published {published[0]}/{published[1]}",
            f"  first party  subscribed {subscribed[0]}/{subscribed[1]}",
            f"  dead entries reported {dead}/{len(all_scores.dead)}",
        ]
    )
    reporter.detail([f"  {line}" for line in all_scores.differences()])
    yield Figure(
        f"{name}.nodes",
        all_scores.matched_nodes,
        all_scores.nodes,
        "nodes",
        at_least=all_scores.nodes,
    )
    yield Figure(f"{name}.precision", all_scores.precision, None, "share")
    yield Figure(f"{name}.recall", all_scores.recall, None, "share")
    yield Figure(f"{name}.own_published", published[0], None, "publishers", at_least=published[1])
    yield Figure(
        f"{name}.own_subscribed", subscribed[0], None, "subscribers", at_least=subscribed[1]
    )
    yield Figure(f"{name}.dead", dead, None, "dead entries", at_most=0)
