"""Launch files that the app's nodes start themselves, and which of those nodes must be led.

`<env>` would do for packages alone. A script that looks beside itself has to run from its copy,
and roslaunch looks a node's executable up before any `<env>` counts; so this is a launch-prefix.
"""

import shlex
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from rtron.folders import walk
from rtron.planning.instrument.common.remaps import NodeRemaps
from rtron.vocabulary import Evidence, LaunchInclude, LaunchNode, LaunchTree


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


_MANIFESTS = ("package.xml", "manifest.xml")


@dataclass(frozen=True, slots=True)
class PackageFile:
    """A file of a package: the package's real folder, and the file's path below it."""

    package: Path
    relative_path: Path

    @property
    def path(self) -> Path:
        """The file, with no link on the way to its package."""
        return self.package / self.relative_path


def find_package_file(path: Path) -> PackageFile | None:
    """Return where a file lies in its package; None if it lies in none."""
    for folder in path.parents:
        if any((folder / name).is_file() for name in _MANIFESTS):
            return PackageFile(folder.resolve(), path.relative_to(folder))
    return None


MAX_FILES = 100_000


def find_scripts(
    nodes: Iterable[LaunchNode], packages: Mapping[str, Path]
) -> dict[PackageFile, LaunchNode]:
    """Return the scripts that nodes run, as far as they lie in the nodes' packages."""
    scripts: dict[PackageFile, LaunchNode] = {}
    for node in nodes:
        for path in _find_by_name(packages.get(node.package), node.type):
            script = find_package_file(path)
            if script and _is_script(path):
                scripts.setdefault(script, node)
    return scripts


def find_modules(
    started: Iterable[RuntimeLaunchTree], programs: Iterable[PackageFile]
) -> set[PackageFile]:
    """Return the files beside the programs in which launch files are started."""
    folders = {program.path.parent for program in programs}
    files = {Path(location.file) for one in started for location in one.evidence}
    modules = {find_package_file(file) for file in files if file.is_file()}
    return {location for location in modules if location and location.path.parent in folders}


def _find_by_name(package: Path | None, name: str) -> Iterator[Path]:
    """Yield a package's files of a name, as roslaunch looks for them."""
    if package is None or not name:
        return
    seen = 0
    for folder, subfolders, files in walk(package):
        subfolders[:] = sorted(sub for sub in subfolders if not sub.startswith("."))
        if name in files:
            yield Path(folder, name)
        seen += len(files)
        if seen > MAX_FILES:
            return


def _is_script(path: Path) -> bool:
    try:
        if not path.is_file():
            return False
        with path.open("rb") as file:
            return file.read(2) == b"#!"
    except OSError:
        return False
