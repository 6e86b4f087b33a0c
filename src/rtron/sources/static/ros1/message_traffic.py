"""Which messages the packages of a workspace publish and subscribe, found in their programs."""

from collections import defaultdict
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import closing
from dataclasses import dataclass, field
from pathlib import Path

from rtron.sources.declaration import Declaration, DeclarationKind, NodeSite
from rtron.sources.launch.common.packages import find_packages
from rtron.sources.static.common.cache import hash_workspace, open_cache
from rtron.sources.static.common.scan_options import ScanOptions
from rtron.sources.static.common.task import InterpretationTask, TaskKind, TaskResult
from rtron.sources.static.common.worker_pool import WorkerPool
from rtron.sources.workspace import Program, ProgramLanguage, Workspace
from rtron.sources.workspace.catalog import NODELET
from rtron.sources.workspace.package_contents import TargetKind
from rtron.sources.workspace.program import is_executable, script_language
from rtron.vocabulary import UnresolvedItem


def workspace_programs(
    workspace: Workspace, folder: Path
) -> Iterator[tuple[str, InterpretationTask]]:
    """Yield the executables, executable Python scripts and nodelets below a folder.

    Each comes with the name of its package.
    """
    packages = [p for p, path in workspace.packages.items() if path.is_relative_to(folder)]
    for package in packages:
        for task in (*_executables(workspace, package), *_scripts(workspace, package)):
            yield package, task
    for plugin in workspace.plugins(NODELET):
        nodelet = workspace.nodelet(plugin.name or plugin.type)
        if plugin.package in packages and nodelet and nodelet.program:
            yield plugin.package, _task(TaskKind.NODELET, nodelet.program, cls=plugin.type)


def _executables(workspace: Workspace, package: str) -> Iterator[InterpretationTask]:
    contents = workspace.contents(package)
    for target in contents.targets if contents else ():
        if target.kind is TargetKind.EXECUTABLE:
            program = workspace.executable(package, target.name)
            if program and program.language is ProgramLanguage.CPP and program.sources:
                yield _task(TaskKind.CPP, program)


def _scripts(workspace: Workspace, package: str) -> Iterator[InterpretationTask]:
    files = workspace.files(package)
    for path in (files.folder / name for name in files.names):
        if (
            files.is_file(path)
            and is_executable(path)
            and script_language(path) is ProgramLanguage.PYTHON
        ):
            site = NodeSite(name=f"/{path.stem}", parameters_complete=False)
            yield InterpretationTask(kind=TaskKind.PYTHON, sources=(path,), site=site)


def _task(kind: TaskKind, program: Program, *, cls: str = "") -> InterpretationTask:
    name = cls.rpartition(":")[2].rpartition("/")[2] or program.name
    site = NodeSite(name=f"/{name}", parameters_complete=False)
    return InterpretationTask(kind=kind, sources=program.sources, class_name=cls, site=site)


_PUBLISHING = frozenset({DeclarationKind.PUBLISH, DeclarationKind.ACTION_CLIENT})
_SUBSCRIBING = frozenset({DeclarationKind.SUBSCRIBE, DeclarationKind.ACTION_SERVER})
_ACTIONS = frozenset({DeclarationKind.ACTION_CLIENT, DeclarationKind.ACTION_SERVER})


@dataclass(slots=True, kw_only=True)
class PackageTraffic:
    """The message types that a package's programs publish and subscribe; an action's are goals."""

    publishes: set[str] = field(default_factory=set)
    subscribes: set[str] = field(default_factory=set)


@dataclass(frozen=True, slots=True, kw_only=True)
class WorkspaceTraffic:
    """The traffic of packages by their folders, and what could not be found out of them."""

    packages: Mapping[Path, PackageTraffic]
    unresolved: tuple[UnresolvedItem, ...] = ()


def read_traffic(top: Path, packages: Mapping[str, Path], options: ScanOptions) -> WorkspaceTraffic:
    """Return the traffic of those packages, folders by name, that have programs of ROS 1.

    Only what lies below `top` is read. A program that cannot be understood has no traffic, and a
    note in `unresolved`; those that came to nothing stand first.
    """
    workspace = Workspace({**find_packages([top], {}), **packages}, [top])
    package_tasks = [
        (p, task) for p, task in workspace_programs(workspace, top.absolute()) if p in packages
    ]
    workspace_hash = hash_workspace(workspace) if options.cache else ""
    pool = WorkerPool(workspace, options.workers, options.seconds)
    owners = {id(task): packages[package] for package, task in package_tasks}
    traffic_by_folder: dict[Path, PackageTraffic] = defaultdict(PackageTraffic)
    failed: list[UnresolvedItem] = []
    notes: list[UnresolvedItem] = []
    with closing(pool):
        results = _results([task for _, task in package_tasks], pool, workspace_hash, options)
        for done, (task, result) in enumerate(results, 1):
            options.progress(done, len(package_tasks), task.site.name)
            _add(traffic_by_folder[owners[id(task)]], result.interface.declarations)
            (notes if result.files else failed).extend(result.interface.unresolved)
    notes.extend(_notes_inside(workspace.unresolved(), packages.values()))
    return WorkspaceTraffic(
        packages=traffic_by_folder, unresolved=(*_sorted_notes(failed), *_sorted_notes(notes))
    )


def _results(
    tasks: Sequence[InterpretationTask], pool: WorkerPool, workspace_hash: str, options: ScanOptions
) -> Iterator[tuple[InterpretationTask, TaskResult]]:
    cache = open_cache(options.cache, workspace_hash)
    missing: list[InterpretationTask] = []
    for task in tasks:
        cached = cache.get(task)
        if cached is None:
            missing.append(task)
        else:
            yield task, cached
    for task, result in pool.run_tasks(missing):
        cache.put(task, result)
        yield task, result
    cache.trim()


def _add(traffic: PackageTraffic, declarations: Sequence[Declaration]) -> None:
    for declared in declarations:
        if declared.type and not declared.implicit:
            if declared.kind in _PUBLISHING:
                traffic.publishes.add(_type(declared))
            if declared.kind in _SUBSCRIBING:
                traffic.subscribes.add(_type(declared))


def _type(declared: Declaration) -> str:
    return f"{declared.type}Goal" if declared.kind in _ACTIONS else declared.type


def _notes_inside(notes: Iterable[UnresolvedItem], folders: Iterable[Path]) -> list[UnresolvedItem]:
    """Return the notes about some folders: a workspace has Debian's packages too."""
    tops = tuple(f"{folder}/" for folder in folders)
    return [note for note in notes if any(e.file.startswith(tops) for e in note.evidence)]


def _sorted_notes(notes: Iterable[UnresolvedItem]) -> list[UnresolvedItem]:
    """Return notes, each once and by their places: programs are done in any order."""
    return sorted(set(notes), key=lambda note: (repr(note.evidence), note.what, note.why))
