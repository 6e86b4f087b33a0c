"""The packages of a workspace: programs, plugins, headers and modules, found without a build."""

import os
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import replace
from functools import cached_property
from itertools import chain
from pathlib import Path

from rtron.errors import InputError
from rtron.folders import path_exists
from rtron.sources.launch.common.packages import PackageIndex, find_packages, package_trust
from rtron.sources.workspace.cmake.evaluator import evaluate_package
from rtron.sources.workspace.manifest import Manifest, PluginExport, read_manifest
from rtron.sources.workspace.package_contents import BuildTarget, PackageContents, TargetKind
from rtron.sources.workspace.package_files import (
    PackageFiles,
    find_header,
    index_folders,
    is_inside,
    list_files,
    message_names,
)
from rtron.sources.workspace.plugin_description import (
    Plugin,
    PluginClass,
    library_name,
    read_plugin_description,
)
from rtron.sources.workspace.program import (
    Program,
    ProgramLanguage,
    executable_names,
    find_script,
    script_program,
    target_program,
)
from rtron.sources.workspace.python_package import PythonPackage, module_file, read_python_package
from rtron.vocabulary import Evidence, Trust, UnresolvedItem

NODELET = "nodelet"


class Workspace:
    """Packages by name; each is read when it is first needed, and then remembered.

    Files count only inside the packages and the folders they were looked for in, links followed.
    `folders` are those that the user gave: what lies there is the user's own.
    """

    def __init__(self, packages: PackageIndex, folders: Iterable[Path] = ()) -> None:
        self.packages = dict(packages)
        self.folders = tuple(folder.absolute() for folder in folders)
        self._roots = tuple(folder.resolve() for folder in self.folders)
        self._contents: dict[str, PackageContents] = {}
        self._files: dict[str, PackageFiles] = {}
        self._manifests: dict[str, Manifest] = {}
        self._headers: dict[tuple[str, Path], Path | None] = {}
        self._messages: dict[str, frozenset[str]] = {}
        self._package_by_folder: dict[Path, str | None] = {}
        self._python_packages: dict[str, PythonPackage] = {}
        self._every_branch: dict[str, PackageContents] = {}
        self._taken_as_built: dict[UnresolvedItem, None] = {}
        self._problems: list[UnresolvedItem] = []

    def trust(self, package: str) -> Trust:
        """Return how far a package is trusted; unknown if it is not found."""
        path = self.packages.get(package)
        return Trust.UNKNOWN if path is None else package_trust(path, self.folders)

    def contents(self, package: str) -> PackageContents | None:
        """Return what a package builds and installs; None if it is not found."""
        if package not in self.packages:
            return None
        if package not in self._contents:
            self._contents[package] = evaluate_package(package, self.files(package))
        return self._contents[package]

    def files(self, package: str) -> PackageFiles:
        """Return the files of a package that is in `packages`; raise KeyError for another."""
        if package not in self._files:
            self._files[package] = list_files(self.packages[package], self._roots)
        return self._files[package]

    def manifest(self, package: str) -> Manifest:
        """Return the manifest of a package that is in `packages`; raise KeyError for another."""
        if package not in self._manifests:
            self._manifests[package] = read_manifest(self.packages[package])
        return self._manifests[package]

    def executable(self, package: str, type: str) -> Program | None:
        """Return what `<node pkg=… type=…>` runs: a target of this name, else a script.

        One that a build with the options' defaults leaves out counts too, with a note.
        """
        contents = self.contents(package)
        if contents is None:
            return None
        built = _built_executable(type, contents)
        if built is not None:
            return built
        entry = self.entry_points(package).get(type)
        if entry is not None:
            return self._entry_point_program(package, *entry)
        script = find_script(type, contents, self.files(package))
        script = script or self._python_package(package).scripts.get(type)
        if script is not None and self.files(package).is_file(script):
            return script_program(script, contents)
        return self._left_out(package, type, _executable)

    def component(self, package: str, cls: str) -> Program | None:
        """Return the library that holds a component's class, with that class as `entry` (ROS 2)."""
        contents = self.contents(package)
        if contents is None:
            return None
        return _component(cls, contents) or self._left_out(package, cls, _component)

    def component_names(self, package: str) -> tuple[str, ...]:
        """Return the classes that a package registers as components (ROS 2)."""
        contents = self.contents(package)
        return tuple(dict.fromkeys(c.class_name for c in contents.components)) if contents else ()

    def _left_out(
        self, package: str, name: str, find: Callable[[str, PackageContents], Program | None]
    ) -> Program | None:
        """Return what a build with the options' defaults leaves out: a launch counts on it."""
        if package not in self._every_branch:
            files = self.files(package)
            self._every_branch[package] = evaluate_package(package, files, every_branch=True)
        contents = self._every_branch[package]
        program = find(name, contents)
        names = (name, program.name) if program is not None else ()
        for why in [contents.left_out[each] for each in names if each in contents.left_out][:1]:
            note = UnresolvedItem(
                what=f"program {package}/{name}",
                why=f"a build with the defaults leaves it out ({why.by}); taken as built",
                evidence=(why.evidence,),
            )
            self._taken_as_built[note] = None
        return program

    def program_names(self, package: str) -> tuple[str, ...]:
        """Return the programs that a package makes or installs, in alphabetical order."""
        contents = self.contents(package)
        if contents is None:
            return ()
        built = (t.output_name for t in contents.targets if t.kind is TargetKind.EXECUTABLE)
        made = (c.executable for c in contents.components)
        scripts = (name for name, _ in contents.installed_scripts)
        files = executable_names(self.files(package))
        python = self._python_package(package)
        found = {*built, *made, *scripts, *files, *python.entry_points, *python.scripts}
        return tuple(sorted(filter(None, found)))

    def entry_points(self, package: str) -> Mapping[str, tuple[str, str]]:
        """Return the module and function of each program that a Python package installs."""
        return self._python_package(package).entry_points

    def _python_package(self, package: str) -> PythonPackage:
        if package not in self._python_packages:
            found = read_python_package(self.packages[package], package)
            self._python_packages[package] = found
        return self._python_packages[package]

    def _entry_point_program(self, package: str, module: str, function: str) -> Program | None:
        path = module_file(self._python_package(package).folder, module)
        contents = self.contents(package)
        if path is None or contents is None or not is_inside(path, self._allowed_folders):
            return None
        made = script_program(path, contents)
        return replace(made, language=ProgramLanguage.PYTHON, entry=function)

    def library(self, filename: str, package: str = "") -> Program | None:
        """Return the library of a file name (`libx.so`, `lib/libx`, `x`), `package`'s first."""
        name = library_name(filename)
        contents = self.contents(package)
        target = contents and contents.target(name, TargetKind.LIBRARY)
        if contents and target:
            return target_program(target, contents)
        owner, found = self._libraries.get(name, (None, None))
        return target_program(found, owner) if owner and found else None

    def nodelet(self, class_name: str) -> Plugin | None:
        """Return the nodelet of a name or type, as `nodelet load` takes it."""
        return self.plugin(class_name, NODELET)

    def plugin(self, name: str, base: str) -> Plugin | None:
        """Return the plugin of a name or type; `base` is its base class or the package of that."""
        ours = self.plugins(base)
        named = chain((p for p in ours if p.name == name), (p for p in ours if p.type == name))
        declared = next(named, None)
        if declared is None:
            return None
        program = self.library(declared.library, declared.package)
        return Plugin(plugin_class=declared, program=program)

    def is_plugin(self, name: str) -> bool:
        """Tell whether a class of this name or type is registered, for whatever base."""
        return any(name in {found.name, found.type} for found in self._plugin_classes)

    def plugins(self, base: str) -> tuple[PluginClass, ...]:
        """Return all plugins of a base class, or of the package that they are exported for."""
        return tuple(found for found in self._plugin_classes if base in {found.tag, found.base})

    def header(self, text: str, from_file: Path) -> Path | None:
        """Return the file that `#include` means in a file; None for one that is not ours."""
        key = (text, from_file.parent)
        if key not in self._headers:
            path = find_header(text, self._header_folders(text, from_file))
            self._headers[key] = path if path and is_inside(path, self._allowed_folders) else None
        return self._headers[key]

    def python_module(self, dotted: str, from_package: str, from_file: Path) -> Path | None:
        """Return the file of a module as a script imports it: its folder first, then packages."""
        ours = [self._module_folders[from_package]] if from_package in self._module_folders else []
        top = dotted.partition(".")[0]
        others = self._module_folders_by_name.get(top, ())
        installed = (each for each in self._roots_by_name.get(top, ()) if module_file(each, top))
        folders = (from_file.parent, *ours, *others, *installed)
        found = (module_file(folder, dotted) for folder in folders)
        path = next(filter(None, found), None)
        return path if path and is_inside(path, self._allowed_folders) else None

    def messages(self, package: str) -> frozenset[str]:
        """Return the names that a package's message files bring; none if it is not found."""
        if package in self.packages and package not in self._messages:
            self._messages[package] = message_names(self.files(package))
        return self._messages.get(package, frozenset())

    def package_of(self, path: Path) -> str | None:
        """Return the package that a file lies in."""
        folder = path.parent
        if folder not in self._package_by_folder:
            found = (self._names_by_path.get(parent) for parent in path.parents)
            self._package_by_folder[folder] = next(filter(None, found), None)
        return self._package_by_folder[folder]

    def installed_source(self, path: Path) -> Path:
        """Return what a build installs at a path: the one file of its package with that name.

        What lies there itself counts before; of several files that which CMake installs there.
        """
        package = None if path_exists(path) else self.package_of(path)
        named = self.files(package).files_named(path.name) if package else ()
        if package is None or len(named) == 1:
            return named[0] if named else path
        contents = self.contents(package)
        found = contents.shared_sources(path) if contents is not None else ()
        return next(filter(self.files(package).is_file, found), path)

    def unresolved(self) -> tuple[UnresolvedItem, ...]:
        """Return what could not be resolved in the packages and descriptions read so far."""
        noted = (contents.unresolved for contents in self._contents.values())
        packages = dict.fromkeys((*self._contents, *self._manifests))
        manifests = (self.manifest(package).unresolved for package in packages)
        python = (found.unresolved for found in self._python_packages.values())
        notes = chain.from_iterable((*noted, *manifests, *python))
        return (*notes, *self._problems, *self._taken_as_built)

    def unresolved_in(self, packages: Iterable[str]) -> list[UnresolvedItem]:
        """Return what is unclear in the build files of some packages, as far as they are read."""
        used = {self.packages.get(package) for package in packages}
        folders = tuple(f"{path}/" for path in used if path)
        notes = self.unresolved()
        return [n for n in notes if any(e.file.startswith(folders) for e in n.evidence)]

    def _header_folders(self, text: str, from_file: Path) -> list[Path]:
        contents = self.contents(self.package_of(from_file) or "")
        ours = (*contents.include_dirs, contents.path / "include") if contents else ()
        return [from_file.parent, *ours, *self._include_folders.get(text.partition("/")[0], ())]

    @cached_property
    def _names_by_path(self) -> Mapping[Path, str]:
        return {path: name for name, path in self.packages.items()}

    @cached_property
    def _allowed_folders(self) -> tuple[Path, ...]:
        outside = (path.resolve() for path in self.packages.values())
        return (*self._roots, *(p for p in outside if not is_inside(p, self._roots)))

    @cached_property
    def _include_folders(self) -> Mapping[str, tuple[Path, ...]]:
        return index_folders(path / "include" for path in self.packages.values())

    @cached_property
    def _module_folders(self) -> Mapping[str, Path]:
        return {name: self._python_package(name).folder for name in self.packages}

    @cached_property
    def _module_folders_by_name(self) -> Mapping[str, tuple[Path, ...]]:
        return index_folders(dict.fromkeys(self._module_folders.values()))

    @cached_property
    def _roots_by_name(self) -> Mapping[str, tuple[Path, ...]]:
        """The packages by what stands in them: CMake installs Python from there by any name."""
        return index_folders(self.packages.values())

    @cached_property
    def _libraries(self) -> Mapping[str, tuple[PackageContents, BuildTarget]]:
        found: dict[str, tuple[PackageContents, BuildTarget]] = {}
        for contents in filter(None, map(self.contents, self.packages)):
            for target in contents.targets:
                if target.kind is TargetKind.LIBRARY:
                    found.setdefault(library_name(target.output_name), (contents, target))
        return found

    @cached_property
    def _plugin_classes(self) -> tuple[PluginClass, ...]:
        return tuple(
            found
            for package in self.packages
            for export in (*self.manifest(package).exports, *self._cmake_exports(package))
            for found in self._read_export(export, package)
        )

    def _cmake_exports(self, package: str) -> Iterator[PluginExport]:
        """Yield the descriptions of plugins that a package's CMake files export (ROS 2)."""
        contents = self.contents(package)
        for tag, path in contents.plugin_descriptions if contents else ():
            yield PluginExport(tag=tag, path=path)

    def _read_export(self, export: PluginExport, package: str) -> Iterator[PluginClass]:
        try:
            yield from read_plugin_description(self._check_path(export.path), package, export.tag)
        except InputError as error:
            location = Evidence(file=str(export.path), line=error.line)
            self._problems.append(
                UnresolvedItem(what=export.path.name, why=str(error), evidence=(location,))
            )

    def _check_path(self, path: Path) -> Path:
        if not is_inside(path, self._allowed_folders):
            raise InputError("is not there, or not in a package", path=str(path))
        return path


def _executable(name: str, contents: PackageContents) -> Program | None:
    script = dict(contents.installed_scripts).get(name)
    installed = script_program(script, contents) if script is not None else None
    return _built_executable(name, contents) or installed


def _built_executable(name: str, contents: PackageContents) -> Program | None:
    target = contents.target(name, TargetKind.EXECUTABLE)
    if target is not None:
        return target_program(target, contents)
    made = next((c for c in contents.components if c.executable == name), None)
    return _component(made.class_name, contents) if made else None


def _component(cls: str, contents: PackageContents) -> Program | None:
    found = next((c for c in contents.components if c.class_name == cls), None)
    target = contents.target(found.library, TargetKind.LIBRARY) if found else None
    return replace(target_program(target, contents), entry=cls) if target else None


def read_workspace(folders: Iterable[Path], environ: Mapping[str, str] = os.environ) -> Workspace:
    """Return the workspace of some folders, ROS_PACKAGE_PATH and Debian's packages."""
    given = tuple(folders)
    shared = shared_workspace(given, environ.get("ROS_PACKAGE_PATH", ""))
    return shared or Workspace(find_packages(given, environ), given)


_SHARED: dict[tuple[tuple[Path, ...], str | None], Workspace] = {}


def share_workspaces(*workspaces: tuple[Workspace, str | None]) -> None:
    """Share workspaces, each with its ROS_PACKAGE_PATH or None for ROS 2, instead of earlier ones.

    They are for the processes that this one forks: each finds what was read of them before. No
    other process shares one, since files change.
    """
    _SHARED.clear()
    _SHARED.update({(each.folders, path): each for each, path in workspaces})


def shared_workspace(folders: tuple[Path, ...], package_path: str | None) -> Workspace | None:
    """Return the workspace that is shared of some folders, if there is one."""
    return _SHARED.get((folders, package_path))
