"""What the launch files of the demo start: of ROS 1 the names, of ROS 2 the command lines.

The wheels of ROS 2 have no `ros2 launch`. RTron reads such files itself, so each node's script is
started as launch_ros would: with its name, its namespace and its remaps after `--ros-args`.
"""

import shlex
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from rtron.errors import InputError
from rtron.planning.instrument.common.guard_files import GUARD_SCRIPT
from rtron.sources.launch.common.packages import find_packages
from rtron.sources.launch.ros1.reader import read_launch
from rtron.sources.launch.ros2.reader import read_ros2_launch
from rtron.vocabulary import GUARD_NODE, LaunchNode


@dataclass(frozen=True, slots=True)
class NodeCommand:
    """The full name of what is started, and the command that starts it."""

    node: str
    command: tuple[str, ...]

    @property
    def is_of_app(self) -> bool:
        """Whether it is a node of the app, not the guard."""
        return self.node != GUARD_NODE


def node_names(launch: Path, folders: Sequence[Path], environ: Mapping[str, str]) -> frozenset[str]:
    """Return the names of the nodes that a ROS 1 launch file starts, without the guard."""
    tree = read_launch(launch, {}, find_packages(folders, environ), environ)
    return frozenset(node.name for node in tree.nodes()) - {GUARD_NODE}


def node_commands(
    launch: Path, folders: Sequence[Path], environ: Mapping[str, str], python: Path
) -> tuple[NodeCommand, ...]:
    """Return what starts the nodes of a launch file and its includes, the guard first.

    `folders` have the packages; `python` runs their scripts. InputError for what cannot be read.
    """
    packages = find_packages(folders, environ)
    tree = read_ros2_launch(launch, {}, environ, packages)
    guards = [node for node in tree.nodes() if node.name == GUARD_NODE]
    nodes = [node for node in tree.nodes() if node.name != GUARD_NODE]
    script = launch.with_suffix(".d") / GUARD_SCRIPT
    return (
        *(NodeCommand(guard.name, (str(script),)) for guard in guards),
        *(_command(node, packages, python) for node in nodes),
    )


def _command(node: LaunchNode, packages: Mapping[str, Path], python: Path) -> NodeCommand:
    if node.package not in packages:
        help = "the demo's packages lie in apps and apps/others"
        raise InputError(f"{node.name}: there is no package {node.package!r}", help=help)
    script = packages[node.package] / "scripts" / node.type
    space, _, name = node.name.rpartition("/")
    rules = [f"__node:={name}", f"__ns:={space or '/'}"]
    rules += [f"{remap.written_source}:={remap.written_target}" for remap in node.remaps]
    ros = [word for rule in rules for word in ("-r", rule)]
    return NodeCommand(
        node.name, (str(python), str(script), *shlex.split(node.args), "--ros-args", *ros)
    )
