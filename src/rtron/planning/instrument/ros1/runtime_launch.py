"""Launch files that the app's nodes start themselves, and which of those nodes must be led.

`<env>` would do for packages alone. A script that looks beside itself has to run from its copy,
and roslaunch looks a node's executable up before any `<env>` counts; so this is a launch-prefix.
"""

import shlex
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from rtron.planning.instrument.common.remaps import NodeRemaps
from rtron.vocabulary import Evidence, LaunchInclude, LaunchTree


@dataclass(frozen=True, slots=True, kw_only=True)
class RuntimeLaunchTree:
    """A launch file that a node starts, evaluated for the arguments that the node gives.

    `starter` is the node's full name, `evidence` the places in its program.
    """

    tree: LaunchTree
    starter: str
    evidence: tuple[Evidence, ...] = ()

    @property
    def path(self) -> Path:
        """The launch file."""
        return Path(self.tree.root.path)


def merge_launches(tree: LaunchTree, started: Iterable[RuntimeLaunchTree]) -> LaunchTree:
    """Return one tree that has all nodes of a launch and of those that its nodes start."""
    trees = [launch.tree for launch in started]
    added = [LaunchInclude(element_index=0, evaluated_name=t.root.path, file=t.root) for t in trees]
    root = replace(tree.root, includes=(*tree.root.includes, *added))
    unresolved = (note for launch in (tree, *trees) for note in launch.unresolved)
    return replace(tree, root=root, unresolved=tuple(dict.fromkeys(unresolved)))


def starter_nodes(started: Sequence[RuntimeLaunchTree], remaps: NodeRemaps) -> frozenset[str]:
    """Return the nodes that start a launch file which changes, by remaps or by a starter in it."""
    found: set[str] = set()
    for _ in started:
        found |= {
            one.starter
            for one in started
            if any(remaps.get(node) or node.name in found for node in one.tree.nodes())
        }
    return frozenset(found)


STARTER_SCRIPT = "starter"
OVERLAY_FOLDER = "overlay"


def starter_script(packages: Iterable[Path], programs: Mapping[Path, tuple[str, Path]]) -> str:
    """Return the script. `packages` lie below the overlay and come first for the node.

    `programs` maps each original script to its `package/type` and its copy below the overlay.
    catkin's own `lib/package/type`, which runs the original, is replaced as well.
    """
    path = ":".join(f'"$overlay"/{shlex.quote(str(package))}' for package in packages)
    return "\n".join(
        (
            "#!/bin/sh",
            "# A launch-prefix: the node behind it finds the guarded copies of launch files.",
            f'overlay=$(cd "${{0%/*}}/{OVERLAY_FOLDER}" && pwd -P) || exit 1',
            f'ROS_PACKAGE_PATH={path}"${{ROS_PACKAGE_PATH:+:$ROS_PACKAGE_PATH}}"',
            "export ROS_PACKAGE_PATH",
            "for word do",
            "  shift",
            *(line for item in programs.items() for line in _replacing(*item)),
            '  set -- "$@" "$word"',
            "done",
            'exec "$@"',
            "",
        )
    )


def _replacing(original: Path, program: tuple[str, Path]) -> tuple[str, ...]:
    named, copy = program
    put = f'word="$overlay"/{shlex.quote(str(copy))}'
    return (
        f'  if [ "$word" -ef {shlex.quote(str(original))} ]; then {put}; fi',
        f"  case $word in */lib/{shlex.quote(named)}) {put} ;; esac",
    )
