"""A package's manifest as the classifier sees it: name, description, dependencies."""

from pathlib import Path

from rtron.errors import InputError
from rtron.functions.reading.fields import MAX_NAME
from rtron.functions.reading.skipped_entries import UnreadableEntryError
from rtron.functions.repository import SourcePackage
from rtron.sources.launch.common.xml_document import Element, parse_xml
from rtron.sources.workspace.manifest import parse_manifest
from rtron.sources.workspace.package_files import is_inside

MANIFEST = "package.xml"


def read_package(folder: Path, root: Path) -> SourcePackage:
    """Return a folder's package; `root` is the real folder of the repository that it lies in.

    Raise UnreadableError where its package.xml cannot be read, or lies elsewhere.
    """
    document = _parse_manifest(folder / MANIFEST, root)
    manifest = parse_manifest(document, folder)
    return SourcePackage(
        name=(document.findtext("name") or "").strip()[:MAX_NAME] or folder.name,
        description=manifest.description,
        depends=manifest.depends,
        folder=folder,
    )


def _parse_manifest(path: Path, root: Path) -> Element:
    if not is_inside(path, (root,)):
        raise UnreadableEntryError("is a link that leads out of the repository, or nowhere")
    try:
        return parse_xml(path)
    except InputError as error:
        raise UnreadableEntryError(error.reason, line=error.line) from None
