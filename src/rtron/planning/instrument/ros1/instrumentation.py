"""Plan + launch -> guarded launch (paper section 5.1, Coordination Node Deployment).

Both `$(find …)` and rospkg take the first package of a name on ROS_PACKAGE_PATH and follow links.
The copies lie to each other as the originals do, for scripts that look beside themselves.
"""

import os
import os.path
import re
from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path

from rtron.errors import InputError
from rtron.planning.instrument.common.cells import Cell
from rtron.planning.instrument.common.guarded_launch import (
    EnforcementGap,
    GuardedLaunch,
    GuardFiles,
    guard_element,
)
from rtron.planning.instrument.common.remap_coverage import RemapCoverage
from rtron.planning.instrument.common.remaps import enforced_streams, plan_remaps
from rtron.planning.instrument.ros1.launch_copies import LaunchCopies
from rtron.planning.instrument.ros1.runtime_launch import (
    OVERLAY_FOLDER,
    STARTER_SCRIPT,
    PackageFile,
    RuntimeLaunchTree,
    find_package_file,
    merge_launches,
    starter_script,
)
from rtron.planning.instrument.ros1.runtime_launch_reach import (
    ReachableLaunches,
    find_reachable_launches,
)
from rtron.vocabulary import GUARD_NODE, LaunchFile, LaunchNode, LaunchTree, Plan

_NOTE = "# A launch-prefix: the command behind it is not run.\n"
_NO_PACKAGES: Mapping[str, Path] = {}
_UNQUOTABLE = re.compile(r"""["'&<>$\\\x00-\x1f]""")


def instrument_ros1(
    tree: LaunchTree,
    plan: Plan,
    out: Path,
    guard: GuardFiles,
    *,
    started: Sequence[RuntimeLaunchTree] = (),
    packages: Mapping[str, Path] = _NO_PACKAGES,
    cells: Sequence[Cell] = (),
) -> GuardedLaunch:
    """Return the guarded launch: the app's own launch, plus remaps, plus the guard.

    `out` is its launch file; what else it needs lies in a folder beside it. `started` are the
    launch files that nodes start themselves, `packages` where the app's packages lie, `cells` the
    nodes that run in one. Nothing is written. InputError if `out` cannot be that file, or if a file
    of the launch cannot be changed.
    """
    out = out.absolute()
    folder = out.with_suffix(".d")
    app = merge_launches(tree, started)
    _check_out(app, out, folder)
    enforced = enforced_streams(plan)
    node_remaps = plan_remaps(app, enforced)
    launches = find_reachable_launches(tree, started, node_remaps, packages)
    node_remaps = {
        node: remaps for node, remaps in node_remaps.items() if node not in launches.unreachable
    }
    copies = LaunchCopies(node_remaps, _scripts(app, launches.starters, cells))
    root = copies.root(tree.root, folder.name, guard_element(folder.name))
    overlay = overlay_files(folder, launches, copies, (out, folder))
    cell_texts = {name: text for cell in cells for name, text in cell.texts().items()}
    texts = {**copies.texts, **guard.texts(_NOTE), **cell_texts}
    coverage = RemapCoverage(app, enforced, node_remaps, launches.unreachable)
    return GuardedLaunch(
        launch=out,
        folder=folder,
        files={**{folder / n: text for n, text in texts.items()}, **overlay.files, out: root},
        copies=overlay.copies,
        links=overlay.links,
        remaps=tuple(p for placed in node_remaps.values() for p in placed if p.is_placeable),
        unenforceable=tuple(_with_acceptance(gap, plan) for gap in coverage.gaps()),
        notes=tuple(dict.fromkeys((*coverage.notes(), *(n for cell in cells for n in cell.notes)))),
    )


def _scripts(app: LaunchTree, starters: Iterable[str], cells: Sequence[Cell]) -> dict[str, str]:
    """Return the launch-prefixes of nodes; InputError if a node of a cell cannot have one."""
    scripts = dict.fromkeys(starters, STARTER_SCRIPT)
    started = {node.name for node in app.nodes()}
    for cell in cells:
        node = cell.manifest.node
        if node not in started:
            help = "start it by hand: `rtron cell`"
            raise InputError(
                f"this launch does not start {node}, for which there is a cell", help=help
            )
        if node in scripts:
            raise InputError(f"{node} starts launch files, and so cannot run in a cell")
        scripts[node] = cell.script
    return scripts


def _with_acceptance(gap: EnforcementGap, plan: Plan) -> EnforcementGap:
    return replace(gap, accepted=gap.what in plan.accept_unenforceable)


def _check_out(tree: LaunchTree, out: Path, folder: Path) -> None:
    if folder == out or _UNQUOTABLE.search(str(out)):
        help = "choose a name such as guarded.launch, in a folder of plain name"
        raise InputError("cannot be the guarded launch file", path=str(out), help=help)
    for path in (Path(file.path).resolve() for file in tree.root.walk()):
        if path == out.resolve() or folder.resolve() in path.parents:
            help = "write the guarded launch to another place"
            raise InputError("would be overwritten", path=str(path), help=help)
    if any(node.name == GUARD_NODE for node in tree.nodes()):
        help = "instrument the app's own launch file"
        raise InputError("starts a guard already", path=tree.root.path, help=help)


MAX_LINKS = 20_000


def mirror_links(root: Path, changed: Collection[Path], left_out: Collection[Path]) -> list[Path]:
    """Return what must be linked so that a mirror of `root` lacks only the files `changed`.

    Folders on the way to a changed file are made anew, all beside them is linked; what is
    `left_out` is not, so that no link leads to it. Raise InputError if a folder cannot be listed
    or has too much in it.
    """
    excluded = {*changed, *left_out}
    above = (parent for path in excluded for parent in path.parents)
    folders = {folder for folder in above if folder.is_relative_to(root) and folder.is_dir()}
    not_linked = folders | excluded
    links: list[Path] = []
    for folder in sorted(folders):
        links += (path for path in _listed(folder) if path not in not_linked)
        if len(links) > MAX_LINKS:
            help = "write the guarded launch for fewer packages"
            raise InputError(f"holds more than {MAX_LINKS} files", path=str(folder), help=help)
    return links


def _listed(folder: Path) -> Iterator[Path]:
    try:
        yield from (folder / name for name in sorted(os.listdir(folder)))  # noqa: PTH208
    except OSError as error:
        raise InputError(f"cannot be listed: {error.strerror}", path=str(folder)) from None


@dataclass(frozen=True, slots=True, kw_only=True)
class Overlay:
    """The overlay's content: `launches` are guarded, `programs` and `modules` are copied.

    `unchanged_launches` are other files that must be found beside those; `folder` is that of the
    guarded launch.
    """

    folder: Path
    launches: Collection[PackageFile]
    programs: Mapping[PackageFile, LaunchNode]
    modules: Collection[PackageFile]
    unchanged_launches: Collection[PackageFile]

    @property
    def root(self) -> Path:
        """The folder that is mirrored: the nearest one that holds all the packages."""
        package_files = (*self._changed, *self.unchanged_launches)
        return Path(
            os.path.commonpath([package_file.package.parent for package_file in package_files])
        )

    def overlay_path(self, package_file: PackageFile) -> Path:
        """Return where a file of a package lies in the overlay."""
        return self.folder / OVERLAY_FOLDER / self._relative_path(package_file.path)

    def copies(self) -> dict[Path, Path]:
        """Return the scripts that are copied, and from where."""
        return {
            self.overlay_path(package_file): package_file.path
            for package_file in (*self.programs, *self.modules)
        }

    def links(self, left_out: Collection[Path]) -> dict[Path, Path]:
        """Return the links, and where they lead; raise InputError as `mirror_links` does."""
        changed = [package_file.path for package_file in self._changed]
        links = mirror_links(self.root, changed, left_out)
        return {self.folder / OVERLAY_FOLDER / self._relative_path(link): link for link in links}

    def packages(self) -> list[Path]:
        """Return the packages that are copied."""
        return list(dict.fromkeys(package_file.package for package_file in self._changed))

    def script(self) -> str:
        """Return the launch-prefix of the nodes that start launch files."""
        packages = [self._relative_path(package) for package in self.packages()]
        programs = {
            package_file.path: (
                f"{node.package}/{node.type}",
                self._relative_path(package_file.path),
            )
            for package_file, node in self.programs.items()
        }
        return starter_script(packages, programs)

    @property
    def _changed(self) -> tuple[PackageFile, ...]:
        return (*self.launches, *self.programs, *self.modules)

    def _relative_path(self, path: Path) -> Path:
        return path.relative_to(self.root)


_IGNORE_FILE = "CATKIN_IGNORE"
"""Keeps rospack from finding the copies where the guarded launch lies in a workspace."""


@dataclass(frozen=True, slots=True, kw_only=True)
class OverlayContent:
    """Texts, copied scripts and links by their places."""

    files: Mapping[Path, str] = field(default_factory=dict)
    copies: Mapping[Path, Path] = field(default_factory=dict)
    links: Mapping[Path, Path] = field(default_factory=dict)


def overlay_files(
    folder: Path, reachable: ReachableLaunches, copies: LaunchCopies, left_out: Sequence[Path]
) -> OverlayContent:
    """Return the overlay in `folder` for the launch files that nodes start.

    `left_out` is what the guarded launch replaces itself. Raise InputError for a folder that
    cannot hold the packages, or for packages that cannot be mirrored.
    """
    if not reachable.starters:
        return OverlayContent()
    files = _started_files(reachable)
    launches = {package_file: file for package_file, file in files.items() if copies.changes(file)}
    overlay = Overlay(
        folder=folder,
        launches=launches,
        programs=reachable.programs,
        modules=reachable.modules,
        unchanged_launches=files,
    )
    _check_folder(folder, overlay)
    overlay_launches = (
        (overlay.overlay_path(package_file), file) for package_file, file in launches.items()
    )
    texts = {
        copy_path: copies.render_started(file, _path_to_folder(copy_path, folder))
        for copy_path, file in overlay_launches
    }
    return OverlayContent(
        files={**texts, folder / STARTER_SCRIPT: overlay.script(), folder / _IGNORE_FILE: ""},
        copies=overlay.copies(),
        links=overlay.links([path.parent.resolve() / path.name for path in left_out]),
    )


def _path_to_folder(copy: Path, folder: Path) -> str:
    """Return what leads from a copy's folder to the guarded launch's."""
    return f"/{os.path.relpath(folder, copy.parent)}"


def _check_folder(folder: Path, overlay: Overlay) -> None:
    """Refuse a folder in a copied package: roslaunch finds a file twice below the package."""
    if ":" in str(folder):
        help = "choose a folder with no colon in its name, as ROS_PACKAGE_PATH separates by it"
        raise InputError("cannot hold packages", path=str(folder), help=help)
    if any(folder.resolve().is_relative_to(package) for package in overlay.packages()):
        help = "write the guarded launch outside of the app's packages"
        raise InputError("lies in a package that is to be copied", path=str(folder), help=help)


def _started_files(reachable: ReachableLaunches) -> dict[PackageFile, LaunchFile]:
    """Return the launch files that the starters start, the first inclusion of each."""
    files: dict[PackageFile, LaunchFile] = {}
    for one in reachable.started:
        package_file = find_package_file(one.path)
        if package_file and one.starter in reachable.starters:
            files.setdefault(package_file, one.tree.root)
    return files
