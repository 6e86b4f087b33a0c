"""Navigation2 as nav2_bringup launches it: which ways a velocity goes, read from source alone.

What is expected was read in the launch files and sources by hand. The TurtleBot 3 in Gazebo is in
another repository; where a command arrives is seen with the simulator that is in this one.
"""

import time
from collections.abc import Iterator, Mapping
from pathlib import Path

from evaluation.common.datasets import Reporter
from figures.figure import Figure
from rtron.risks import discover_risks
from rtron.sources.static.common.scan_options import ScanOptions
from rtron.sources.static.ros2.app import scan_ros2_app
from rtron.vocabulary import InteractionGraph, RiskKind

COMMANDS: Mapping[str, tuple[frozenset[str], frozenset[str]]] = {
    "/cmd_vel_nav": (
        frozenset({"/controller_server", "/behavior_server"}),
        frozenset({"/velocity_smoother"}),
    ),
    "/cmd_vel_smoothed": (frozenset({"/velocity_smoother"}), frozenset({"/collision_monitor"})),
    "/cmd_vel": (
        frozenset({"/collision_monitor", "/docking_server", "/following_server"}),
        frozenset({"/loopback_simulator"}),
    ),
}
"""Who publishes and who subscribes each of the topics that carry a velocity."""

_BRINGUP = "nav2_bringup/launch"
_GAZEBO, _LOOPBACK = "tb3_simulation_launch.py", "tb3_loopback_simulation_launch.py"


def launch_figures(folder: Path, options: ScanOptions, reporter: Reporter) -> Iterator[Figure]:
    """Scan both simulations and compare what carries velocities."""
    before = time.perf_counter()
    gazebo = _scanned(folder, _GAZEBO, options)
    seconds = time.perf_counter() - before
    loopback = _scanned(folder, _LOOPBACK, options)
    routes = list(velocity_routes(gazebo, loopback))
    reporter.detail([f"  DIFFERS {topic}" for topic, equal in routes if not equal])
    yield Figure("nav2.launch.nodes", len(gazebo.nodes), None, "nodes")
    yield Figure("nav2.launch.seconds", seconds, None, "s")
    right = sum(equal for _, equal in routes)
    yield Figure("nav2.launch.ways", right, None, f"of {len(routes)} ways", at_least=len(routes))
    contended = {
        topic
        for risk in discover_risks(loopback).risks
        if risk.kind is RiskKind.GR_ST
        for topic in risk.topics
    }
    yield Figure("nav2.launch.bypass", int("/cmd_vel" in contended), None, "GR-ST", at_least=1)


def velocity_routes(
    gazebo: InteractionGraph, loopback: InteractionGraph
) -> Iterator[tuple[str, bool]]:
    """Yield the topics of each launch, and whether the expected nodes are at them."""
    for topic, (publishers, subscribers) in COMMANDS.items():
        for graph in (gazebo, loopback):
            found = {e.node for e in graph.publishers(topic)}
            yield f"{graph.app} -> {topic}", found == publishers
        yield f"{topic} ->", {e.node for e in loopback.subscribers(topic)} == subscribers


def _scanned(folder: Path, launch: str, options: ScanOptions) -> InteractionGraph:
    return scan_ros2_app([folder], [(folder / _BRINGUP / launch, {})], {}, options)
