"""An SDF world or model file, with the models that it includes (sdformat.org: world, include)."""

import os
import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path

from rtron.errors import InputError
from rtron.folders import path_exists
from rtron.sources.bounded_file import read_regular_file
from rtron.sources.gazebo.plugins import GazeboPlugin, PluginContext, read_plugin
from rtron.sources.launch.common.packages import PackageIndex
from rtron.sources.launch.common.xml_document import MAX_BYTES
from rtron.sources.workspace.package_files import is_inside
from rtron.sources.xacro import XmlElement, parse_element, read_element
from rtron.vocabulary import UnresolvedItem
from rtron.vocabulary.enums import HiddenPart

_BEFORE = re.compile(r"\s+|<!--.*?-->", re.DOTALL)


def read_sdf(path: Path) -> XmlElement:
    """Return a file's root element; raise InputError as `read_element` does."""
    text, at = read_regular_file(path, MAX_BYTES).decode(errors="replace"), 0
    while found := _BEFORE.match(text, at):
        at = found.end()
    if not at or not text.startswith("<?xml", at):
        return read_element(path)
    return parse_element(text[:at] + text[at:].partition("?>")[2], str(path))


MAX_INCLUDES = 1000
MAX_DEPTH = 20

_SCHEMES = ("model://", "file://")
_BUILT_IN_MODELS = frozenset({"model://sun", "model://ground_plane"})
"""Gazebo's own, which have no plugin: one that is not found is not missed."""


@dataclass(frozen=True, slots=True, kw_only=True)
class GazeboWorld:
    """What a world file holds: its plugins, and the includes that were not found."""

    plugins: tuple[GazeboPlugin, ...] = ()
    unresolved: tuple[UnresolvedItem, ...] = ()


def read_world(
    path: Path, packages: PackageIndex, environ: Mapping[str, str] = os.environ
) -> GazeboWorld:
    """Return the plugins of a `.world` or `.sdf` file and of the models it includes.

    `model://` is looked for in GAZEBO_MODEL_PATH, then in the packages' `models` folders. What lies
    neither in those, nor in a package, nor below the file's own folder is not read. Raise
    InputError if the file itself is no XML; an include that fails is in `unresolved`.
    """
    folders = model_folders(packages, environ)
    around = (*folders, *map(Path, packages.values()), path.parent)
    reading = _WorldReader(
        folders=folders, allowed_folders=tuple(each.resolve() for each in around)
    )
    try:
        plugins = tuple(reading.read_plugins_below(read_sdf(path), PluginContext(), (str(path),)))
    except RecursionError:
        raise InputError("is nested too deep", path=str(path)) from None
    return GazeboWorld(plugins=plugins, unresolved=tuple(reading.unresolved))


def model_folders(packages: PackageIndex, environ: Mapping[str, str]) -> tuple[Path, ...]:
    """Return the folders in which Gazebo looks for `model://`, those that exist."""
    listed = (Path(entry) for entry in environ.get("GAZEBO_MODEL_PATH", "").split(":") if entry)
    below = (Path(package) / "models" for package in packages.values())
    return tuple(folder for folder in (*listed, *below) if folder.is_dir())


@dataclass(slots=True, kw_only=True)
class _WorldReader:
    folders: tuple[Path, ...]
    allowed_folders: tuple[Path, ...]
    included: int = 0
    unresolved: list[UnresolvedItem] = field(default_factory=list)
    _roots: dict[str, XmlElement] = field(default_factory=dict)

    def read_plugins_below(
        self, element: XmlElement, context: PluginContext, files: tuple[str, ...]
    ) -> Iterator[GazeboPlugin]:
        """Yield the plugins within an element; `files` are those being read, the innermost last."""
        for child in element.elements():
            if child.tag == "plugin":
                yield read_plugin(child, context)
            elif child.tag == "include":
                yield from self._include(child, context, files)
            else:
                yield from self.read_plugins_below(child, context.child_context(child), files)

    def _include(
        self, include: XmlElement, context: PluginContext, files: tuple[str, ...]
    ) -> Iterator[GazeboPlugin]:
        found = include.find("uri")
        uri = found.text if found else ""
        try:
            path = self._find_included(uri, files)
            root = self._root(path)
        except InputError as error:
            if uri not in _BUILT_IN_MODELS:
                note = UnresolvedItem(
                    what=f"include {uri}".strip(),
                    why=str(error),
                    hides=HiddenPart.NODES,
                    evidence=(include.evidence,),
                )
                self.unresolved.append(note)
            return
        name = include.find("name")
        named = _with_model_name(root, name.text if name else "")
        yield from self.read_plugins_below(named, context, (*files, str(path)))
        own = replace(context, model=name.text if name else "")
        for plugin in include.elements("plugin"):
            yield read_plugin(plugin, own)

    def _find_included(self, uri: str, files: tuple[str, ...]) -> Path:
        self.included += 1
        if self.included > MAX_INCLUDES or len(files) > MAX_DEPTH:
            raise InputError(f"more than {MAX_INCLUDES} includes, or {MAX_DEPTH} deep")
        path = next((path for path in self._candidates(uri, files[-1]) if path_exists(path)), None)
        if path is None:
            help = "add its folder to GAZEBO_MODEL_PATH"
            raise InputError(f"'{uri}' is not found", help=help)
        path = _model_file(path) if path.is_dir() else path
        if not is_inside(path, self.allowed_folders):
            raise InputError("is not in the folders that are read", path=str(path))
        if str(path) in files:
            raise InputError("includes itself", path=str(path))
        return path

    def _candidates(self, uri: str, file: str) -> Iterator[Path]:
        scheme = next((scheme for scheme in _SCHEMES if uri.startswith(scheme)), "")
        name = uri.removeprefix(scheme)
        if not name or "\0" in name or ".." in Path(name).parts:
            return
        if scheme == "model://":
            yield from (folder / name for folder in self.folders)
        elif "://" not in name:
            yield Path(file).parent / name

    def _root(self, path: Path) -> XmlElement:
        if str(path) not in self._roots:
            self._roots[str(path)] = read_sdf(path)
        return self._roots[str(path)]


def _model_file(folder: Path) -> Path:
    """Return the last SDF file that a model's `model.config` names, `model.sdf` without one."""
    try:
        config = read_sdf(folder / "model.config")
    except InputError:
        return folder / "model.sdf"
    named = [sdf.text for sdf in config.elements("sdf") if sdf.text == Path(sdf.text).name]
    return folder / (named[-1] if named and named[-1] else "model.sdf")


def _with_model_name(root: XmlElement, name: str) -> XmlElement:
    """Return an included file's root with its model named as the include wants."""
    if not name:
        return root
    children = (
        replace(child, attributes={**child.attributes, "name": name})
        if isinstance(child, XmlElement) and child.tag == "model"
        else child
        for child in root.children
    )
    return replace(root, children=tuple(children))
