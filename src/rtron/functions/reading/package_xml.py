"""A package's manifest as the classifier sees it: name, description, dependencies."""

from pathlib import Path

from rtron.functions.reading.fields import MAX_NAME
from rtron.functions.reading.skipped import UnreadableError
from rtron.functions.repository import Package
from rtron.sources.launch.packages import package_name
from rtron.sources.workspace.manifest import read_manifest

MANIFEST = "package.xml"


def read_package(folder: Path) -> Package:
    """Return a folder's package; raise UnreadableError where its package.xml cannot be read."""
    manifest = read_manifest(folder)
    for fault in manifest.unresolved:
        raise UnreadableError(fault.why.removeprefix(f"{folder / MANIFEST}: "))
    return Package(
        name=package_name(folder)[:MAX_NAME] or folder.name,
        description=manifest.description,
        depends=manifest.depends,
    )
