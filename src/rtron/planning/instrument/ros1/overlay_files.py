"""What the overlay adds to the guarded launch's folder."""

import os.path
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

from rtron.errors import InputError
from rtron.planning.instrument.ros1.launch_copies import Copies
from rtron.planning.instrument.ros1.launch_prefix_script import STARTER
from rtron.planning.instrument.ros1.overlay import Overlay
from rtron.planning.instrument.ros1.package_files import PackagePlace, package_place
from rtron.planning.instrument.ros1.runtime_launch_reach import Reachable
from rtron.vocabulary import LaunchFile

_IGNORE = "CATKIN_IGNORE"
"""Keeps rospack from finding the copies where the guarded launch lies in a workspace."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Overlaid:
    """Texts, copied scripts and links by their places."""

    files: Mapping[Path, str] = field(default_factory=dict)
    copies: Mapping[Path, Path] = field(default_factory=dict)
    links: Mapping[Path, Path] = field(default_factory=dict)


def overlay_files(
    folder: Path, found: Reachable, copies: Copies, left_out: Sequence[Path]
) -> Overlaid:
    """Return the overlay in `folder` for the launch files that nodes start.

    `left_out` is what the guarded launch replaces itself. Raise InputError for a folder that
    cannot hold the packages, or for packages that cannot be mirrored.
    """
    if not found.starters:
        return Overlaid()
    files = _files(found)
    launches = {place: file for place, file in files.items() if copies.changes(file)}
    overlay = Overlay(
        folder=folder,
        launches=launches,
        programs=found.programs,
        modules=found.modules,
        seen=files,
    )
    _check_folder(folder, overlay)
    placed = ((overlay.at(place), file) for place, file in launches.items())
    texts = {at: copies.started(file, _way(at, folder)) for at, file in placed}
    return Overlaid(
        files={**texts, folder / STARTER: overlay.script(), folder / _IGNORE: ""},
        copies=overlay.copies(),
        links=overlay.links([path.parent.resolve() / path.name for path in left_out]),
    )


def _way(copy: Path, folder: Path) -> str:
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


def _files(found: Reachable) -> dict[PackagePlace, LaunchFile]:
    """Return the launch files that the starters start, the first inclusion of each."""
    files: dict[PackagePlace, LaunchFile] = {}
    for one in found.started:
        place = package_place(one.path)
        if place and one.by in found.starters:
            files.setdefault(place, one.tree.root)
    return files
