"""What the overlay adds to the guarded launch's folder."""

import os.path
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

from rtron.errors import InputError
from rtron.planning.instrument.ros1.launch_copies import LaunchCopies
from rtron.planning.instrument.ros1.launch_prefix_script import STARTER_SCRIPT
from rtron.planning.instrument.ros1.overlay import Overlay
from rtron.planning.instrument.ros1.package_files import PackageFile, find_package_file
from rtron.planning.instrument.ros1.runtime_launch_reach import ReachableLaunches
from rtron.vocabulary import LaunchFile

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
