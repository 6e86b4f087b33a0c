"""Parameters that ROS 2's launch gives to nodes: where from, for which nodes, and which count.

Sources: docs.ros.org, "Passing ROS arguments to nodes"; rcl's parameter files; launch_ros' Node.
"""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import TypeAlias

from rtron.vocabulary.parameters import Parameter, absolute_pattern, pattern_matches

ALL_NODES = "/**"
"""The pattern of all nodes."""

Entries: TypeAlias = tuple[tuple[str, Mapping[str, Parameter]], ...]
"""What stands for each pattern of node names, in order; names are flat, `a.b`."""


@dataclass(frozen=True, slots=True, kw_only=True)
class ParameterSource:
    """A file, or what stands in the launch file itself (`file` is empty then).

    A file that launch writes on the way is named after the one it is made of, and a number: `a#1`.
    `is_malformed` says that a file has values, and none below `ros__parameters`.
    """

    entries: Entries
    file: str = ""
    is_malformed: bool = False


def merge_node_parameters(sources: Iterable[ParameterSource], node: str) -> dict[str, Parameter]:
    """Return the parameters of a node, the last of a name counts.

    A pattern's place is where it stands first, and a wildcard behind a node's own name counts
    before it: so rclcpp since Humble, and rclpy as 9.1.2 was observed to. An older rclpy (its
    node.cpp at github.com/ros2/rclpy@05327460) knew `/**` only, and took the full name last.
    """
    by_pattern: dict[str, dict[str, Parameter]] = {}
    for source in sources:
        for pattern, values in source.entries:
            by_pattern.setdefault(absolute_pattern(pattern), {}).update(values)
    matching = (values for pattern, values in by_pattern.items() if pattern_matches(pattern, node))
    return {name: value for values in matching for name, value in values.items()}


def merge_component_parameters(
    sources: Iterable[ParameterSource], node: str
) -> dict[str, Parameter]:
    """Return the parameters that a component is loaded with: source after source.

    Of a file count what stands for all nodes, then what stands below the full name itself; no
    other pattern does, and what stands there twice counts where it stands last (launch_ros:
    to_parameters_list).
    """
    merged: dict[str, Parameter] = {}
    for source in sources:
        by_pattern = {absolute_pattern(pattern): values for pattern, values in source.entries}
        for pattern_of_node in (ALL_NODES, node):
            merged.update(by_pattern.get(pattern_of_node, {}))
    return merged
