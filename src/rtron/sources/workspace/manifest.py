"""A package's manifest: what it depends on and which plugins it exports (REP 127, REP 140).

rosbuild's manifest.xml is read too (ROS wiki: Manifest).
"""

from dataclasses import dataclass
from pathlib import Path

from rtron.errors import InputError
from rtron.sources.launch.common.packages import build_types
from rtron.sources.launch.common.xml_document import Element, parse_xml
from rtron.vocabulary import Evidence, UnresolvedItem

MAX_DESCRIPTION = 4096
_DEPENDENCY_TAGS = frozenset(
    {"depend", "build_depend", "build_export_depend", "exec_depend", "run_depend", "test_depend"}
)


@dataclass(frozen=True, slots=True, kw_only=True)
class PluginExport:
    """A plugin description that a package exports under the tag of the package that loads it."""

    tag: str
    path: Path


@dataclass(frozen=True, slots=True, kw_only=True)
class Manifest:
    """What a package says of itself; an unreadable manifest says nothing.

    `description` is on one line, without markup; `build_types` are what may build it (REP 149).
    """

    description: str = ""
    build_types: frozenset[str] = frozenset()
    depends: tuple[str, ...] = ()
    exports: tuple[PluginExport, ...] = ()
    unresolved: tuple[UnresolvedItem, ...] = ()


def read_manifest(package: Path) -> Manifest:
    """Return a package's manifest, package.xml before manifest.xml."""
    path = package / "package.xml"
    path = path if path.is_file() else package / "manifest.xml"
    try:
        root = parse_xml(path)
    except InputError as error:
        location = Evidence(file=error.path, line=error.line)
        return Manifest(
            unresolved=(UnresolvedItem(what=path.name, why=str(error), evidence=(location,)),)
        )
    return parse_manifest(root, package)


def parse_manifest(root: Element, package: Path) -> Manifest:
    """Return what a manifest's root element says of a package."""
    return Manifest(
        description=_description(root),
        build_types=build_types(root),
        depends=_depends(root),
        exports=tuple(_exports(root, package)),
    )


def _description(root: Element) -> str:
    found = root.find("description")
    words = () if found is None else map(str, found.itertext("*"))
    return " ".join(" ".join(words).split())[:MAX_DESCRIPTION]


def _depends(root: Element) -> tuple[str, ...]:
    named = (
        child.get("package") or child.text or ""
        for child in root.iterchildren("*")
        if child.tag in _DEPENDENCY_TAGS
    )
    return tuple(dict.fromkeys(name.strip() for name in named if name.strip()))


def _exports(root: Element, package: Path) -> list[PluginExport]:
    tags = (tag for export in root.iterchildren("export") for tag in export.iterchildren("*"))
    return [
        PluginExport(tag=str(tag.tag), path=Path(text.replace("${prefix}", str(package))))
        for tag in tags
        if (text := tag.get("plugin"))
    ]
