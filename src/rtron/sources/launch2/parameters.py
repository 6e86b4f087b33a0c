"""Parameters that ROS 2's launch gives to nodes: where from, for which nodes, and which count.

Sources: docs.ros.org, "Passing ROS arguments to nodes"; rcl's parameter files; launch_ros' Node.
"""

import re
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import TypeAlias

from rtron.vocabulary.parameters import Parameter

ALL = "/**"
"""The pattern of all nodes."""

Entries: TypeAlias = tuple[tuple[str, Mapping[str, Parameter]], ...]
"""What stands for each pattern of node names, in order; names are flat, `a.b`."""


@dataclass(frozen=True, slots=True, kw_only=True)
class ParameterSource:
    """A file, or what stands in the launch file itself (`file` is empty then).

    A file that launch writes on the way is named after the one it is made of, and a number: `a#1`.
    `shared` says that it is of `set_parameter` or `set_parameters_from_file`.
    """

    entries: Entries
    file: str = ""
    shared: bool = False


def given_parameters(
    sources: Iterable[ParameterSource], node: str, *, by_order: bool = False
) -> dict[str, Parameter]:
    """Return the parameters of a node, the last of a name counts.

    A pattern that names the node itself counts before wildcards, as rclpy has it and launch_ros
    documents it. `by_order` is rclcpp's way since Humble: by the first place of each pattern.
    """
    gathered: dict[str, dict[str, Parameter]] = {}
    for source in sources:
        for pattern, values in source.entries:
            gathered.setdefault(_absolute(pattern), {}).update(values)
    fitting = [(p, values) for p, values in gathered.items() if names(p, node)]
    if not by_order:
        fitting.sort(key=lambda entry: entry[0] == node)
    return {name: value for _, values in fitting for name, value in values.items()}


def loaded_parameters(sources: Iterable[ParameterSource], node: str) -> dict[str, Parameter]:
    """Return the parameters that a component is loaded with: source after source.

    Of a file count what stands for all nodes, then what stands below the full name itself; no
    other pattern does, and what stands there twice counts where it stands last (launch_ros:
    to_parameters_list).
    """
    found: dict[str, Parameter] = {}
    for source in sources:
        by_pattern = {_absolute(pattern): values for pattern, values in source.entries}
        for wanted in (ALL, node):
            found.update(by_pattern.get(wanted, {}))
    return found


def names(pattern: str, node: str) -> bool:
    """Tell whether a pattern of a parameter file names a node (rclcpp: parameter_map)."""
    parts = _absolute(pattern).split("/")[1:]
    return re.fullmatch("".join(map(_part, parts)), node) is not None


def _part(part: str) -> str:
    if part == "**":
        return r"(/[^/]+)*"
    return "/" + re.escape(part).replace(r"\*", "[^/]+")


def _absolute(pattern: str) -> str:
    return pattern if pattern.startswith("/") else f"/{pattern}"
