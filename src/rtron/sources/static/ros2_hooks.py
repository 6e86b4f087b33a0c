"""Search paths that packages extend when a workspace is sourced, told by their `.dsv` files.

docs.ros.org: the ament_cmake user documentation, environment hooks. A package's prefix is not known
before a build; its share folder is the package.
"""

from collections.abc import Iterator
from pathlib import Path

from rtron.sources.code.workspace_sources import WorkspaceSources

_HOOK_KINDS = frozenset({"prepend-non-duplicate", "prepend-non-duplicate-if-exists"})
_SUFFIXES = (".dsv", ".dsv.in")
_PROJECT = "@PROJECT_NAME@"


def hook_folders(variable: str, files: WorkspaceSources) -> Iterator[Path]:
    """Yield the folders that the workspace's packages put into a variable of the environment."""
    workspace = files.workspace
    for package, folder in workspace.packages.items():
        for name in workspace.files(package).names:
            text = files.read_text(folder / name) if name.endswith(_SUFFIXES) else None
            for line in (text or "").splitlines():
                kind, _, rest = line.strip().replace(_PROJECT, package).partition(";")
                named, _, value = rest.partition(";")
                share = f"share/{package}"
                if (
                    kind in _HOOK_KINDS
                    and named == variable
                    and f"{value}/".startswith(f"{share}/")
                ):
                    yield folder / value.removeprefix(share).strip("/")
