"""Where packages lie, as `$(find …)` looks for them (ROS wiki: rospack)."""

import os
from collections.abc import Iterable, Iterator, Mapping
from pathlib import Path
from typing import TypeAlias

from rtron.errors import InputError
from rtron.folders import IGNORE_MARKERS, path_exists, walk
from rtron.sources.launch.common.xml_document import Element, parse_xml
from rtron.vocabulary import Trust

PackageIndex: TypeAlias = Mapping[str, Path]

MAX_FOLDERS = 200_000

_DEBIAN_SHARE = Path("/usr/share")
_TEST_FOLDERS = frozenset({"test", "tests"})
_STOP_MARKER = "rospack_nosubdirs"


def find_packages(
    folders: Iterable[Path], environ: Mapping[str, str] = os.environ
) -> dict[str, Path]:
    """Return the packages below `folders`, then ROS_PACKAGE_PATH, then Debian's; the first wins.

    Links are followed, as rospack does; what cannot be listed, or lies too deep, is left out. Raise
    InputError for a folder that has no end, or is one of `folders` and left out of a build.
    """
    folders = tuple(folders)
    require_no_ignore_marker(folders)
    packages: dict[str, Path] = {}
    path_folders = [
        Path(entry) for entry in environ.get("ROS_PACKAGE_PATH", "").split(":") if entry
    ]
    for folder in (*folders, *path_folders):
        for package in _packages_below(folder.absolute()):
            packages.setdefault(package_name(package), package)
    for manifest in sorted(_DEBIAN_SHARE.glob("*/package.xml")):
        packages.setdefault(package_name(manifest.parent), manifest.parent)
    return packages


def package_folder(file: Path) -> Path | None:
    """Return the folder of the package that a file lies in; None for a file in no package."""
    manifests = ("package.xml", "manifest.xml")
    above = file.absolute().parents
    return next((f for f in above if any(path_exists(f / name) for name in manifests)), None)


def build_types(root: Element) -> frozenset[str]:
    """Return the build types that a manifest gives, whatever their conditions (REP 149)."""
    return frozenset(str(tag.text).strip() for tag in root.iter("build_type"))


def package_of(path: str) -> str:
    """Return the name of the package that a path lies in; empty for one in no package."""
    folder = package_folder(Path(path)) if path else None
    return package_name(folder) if folder else ""


def require_no_ignore_marker(folders: Iterable[Path]) -> None:
    """Raise InputError for a folder that a user names and that builds leave out."""
    for folder in folders:
        for marker in sorted(name for name in IGNORE_MARKERS if path_exists(folder / name)):
            help = "give the folder with the source; build, install and log are made from it"
            raise InputError(f"left out, as {marker} in it says", path=str(folder), help=help)


def package_name(package: Path) -> str:
    """Return the name in a package's manifest, or its folder's where the manifest has none."""
    try:
        name = parse_xml(package / "package.xml").findtext("name")
    except InputError:
        name = None
    return (name or package.name).strip()


def package_trust(package: Path, folders: Iterable[Path]) -> Trust:
    """Return how far a found package is trusted: its user's own if it lies below `folders`."""
    is_own = any(package.is_relative_to(folder.absolute()) for folder in folders)
    return Trust.OWN if is_own else Trust.THIRD_PARTY


def _packages_below(top: Path) -> Iterator[Path]:
    """Yield the package folders below `top`; each counts once, and none nests in another.

    A package that is `top` itself may hold others, but for its tests': a repository often has a
    manifest of its own above the workspace that is built.
    """
    visited: set[str] = set()
    for folder, subfolders, files in walk(top, follow_links=True):
        if len(visited) == MAX_FOLDERS:
            help = "does a link in it lead out of it?"
            raise InputError(f"has more than {MAX_FOLDERS} folders", path=str(top), help=help)
        real = os.path.realpath(folder)
        is_package = "package.xml" in files or "manifest.xml" in files
        is_left_out = real in visited or not IGNORE_MARKERS.isdisjoint(files)
        if is_package and not is_left_out:
            yield Path(folder)
        is_inner = is_package and folder != str(top)
        if is_inner or is_left_out or _STOP_MARKER in files:
            subfolders.clear()
        visited.add(real)
        hidden = _TEST_FOLDERS if is_package else ()
        subfolders[:] = sorted(n for n in subfolders if not n.startswith(".") and n not in hidden)
