"""Which messages the packages of a workspace publish and subscribe, found in their programs."""

from collections import defaultdict
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import closing
from dataclasses import dataclass, field
from pathlib import Path

from rtron.sources.declaration import Declaration, DeclarationKind
from rtron.sources.launch.common.packages import find_packages
from rtron.sources.static.common.cache import open_cache
from rtron.sources.static.common.scan_options import ScanOptions
from rtron.sources.static.common.task import InterpretationTask, TaskResult
from rtron.sources.static.common.worker_pool import WorkerPool
from rtron.sources.static.common.workspace_hash import hash_workspace
from rtron.sources.static.programs import workspace_programs
from rtron.sources.workspace import Workspace
from rtron.vocabulary import UnresolvedItem

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
