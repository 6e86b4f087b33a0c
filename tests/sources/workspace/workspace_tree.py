"""Writes the packages that the tests of the workspace look into."""

from pathlib import Path

from file_tree import write

from rtron.sources.workspace import PackageContents, Workspace
from rtron.sources.workspace.cmake.evaluator import evaluate_package
from rtron.sources.workspace.package_files import list_files

HEAD = "project(pkg)\n"


def evaluate_cmake(folder: Path, cmake: str, sources: str = "a.cpp b.cpp c.cpp") -> PackageContents:
    """Evaluate a CMakeLists.txt beside some empty sources."""
    write(folder, {"CMakeLists.txt": HEAD + cmake, **dict.fromkeys(sources.split(), "")})
    return evaluate_package("pkg", list_files(folder, ()))


def sources(contents: PackageContents) -> dict[str, list[str]]:
    """Return the sources of each target, relative to the package."""
    return {
        target.name: [str(path.relative_to(contents.path)) for path in target.sources]
        for target in contents.targets
    }


def workspace(folder: Path) -> Workspace:
    """Return the workspace of the packages right below a folder."""
    found = {path.parent.name: path.parent for path in sorted(folder.glob("*/package.xml"))}
    return Workspace(found, [folder])
