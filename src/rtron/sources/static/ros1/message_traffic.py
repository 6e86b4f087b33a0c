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
from rtron.sources.static.common.task import Task, TaskResult
from rtron.sources.static.common.worker_pool import Pool
from rtron.sources.static.common.workspace_hash import workspace_state
from rtron.sources.static.programs import programs
from rtron.sources.workspace import Workspace
from rtron.vocabulary import Unresolved

_SENT = frozenset({DeclarationKind.PUBLISH, DeclarationKind.ACTION_CLIENT})
_HEARD = frozenset({DeclarationKind.SUBSCRIBE, DeclarationKind.ACTION_SERVER})
_ACTIONS = frozenset({DeclarationKind.ACTION_CLIENT, DeclarationKind.ACTION_SERVER})


@dataclass(slots=True, kw_only=True)
class PackageTraffic:
    """The message types that a package's programs publish and subscribe; an action's are goals."""

    publishes: set[str] = field(default_factory=set)
    subscribes: set[str] = field(default_factory=set)


@dataclass(frozen=True, slots=True, kw_only=True)
class Traffic:
    """The traffic of packages by their folders, and what could not be found out of them."""

    packages: Mapping[Path, PackageTraffic]
    unresolved: tuple[Unresolved, ...] = ()


def read_traffic(top: Path, packages: Mapping[str, Path], options: ScanOptions) -> Traffic:
    """Return the traffic of those packages, folders by name, that have programs of ROS 1.

    Only what lies below `top` is read. A program that cannot be understood has no traffic, and a
    note in `unresolved`; those that came to nothing stand first.
    """
    workspace = Workspace({**find_packages([top], {}), **packages}, [top])
    owned = [(p, task) for p, task in programs(workspace, top.absolute()) if p in packages]
    state = workspace_state(workspace) if options.cache else ""
    pool = Pool(workspace, options.workers, options.seconds)
    owners = {id(task): packages[package] for package, task in owned}
    found: dict[Path, PackageTraffic] = defaultdict(PackageTraffic)
    lost: list[Unresolved] = []
    notes: list[Unresolved] = []
    with closing(pool):
        results = _results([task for _, task in owned], pool, state, options)
        for done, (task, result) in enumerate(results, 1):
            options.progress(done, len(owned), task.site.name)
            _add(found[owners[id(task)]], result.interface.declarations)
            (notes if result.files else lost).extend(result.interface.unresolved)
    notes.extend(_inside(workspace.unresolved(), packages.values()))
    return Traffic(packages=found, unresolved=(*_ordered(lost), *_ordered(notes)))


def _results(
    tasks: Sequence[Task], pool: Pool, state: str, options: ScanOptions
) -> Iterator[tuple[Task, TaskResult]]:
    cache = open_cache(options.cache, state)
    missing: list[Task] = []
    for task in tasks:
        known = cache.get(task)
        if known is None:
            missing.append(task)
        else:
            yield task, known
    for task, result in pool.run(missing):
        cache.put(task, result)
        yield task, result
    cache.trim()


def _add(traffic: PackageTraffic, declarations: Sequence[Declaration]) -> None:
    for declared in declarations:
        if declared.type and not declared.implicit:
            if declared.kind in _SENT:
                traffic.publishes.add(_type(declared))
            if declared.kind in _HEARD:
                traffic.subscribes.add(_type(declared))


def _type(declared: Declaration) -> str:
    return f"{declared.type}Goal" if declared.kind in _ACTIONS else declared.type


def _inside(notes: Iterable[Unresolved], folders: Iterable[Path]) -> list[Unresolved]:
    """Return the notes about some folders: a workspace has Debian's packages too."""
    tops = tuple(f"{folder}/" for folder in folders)
    return [note for note in notes if any(e.file.startswith(tops) for e in note.evidence)]


def _ordered(notes: Iterable[Unresolved]) -> list[Unresolved]:
    """Return notes, each once and by their places: programs are done in any order."""
    return sorted(set(notes), key=lambda note: (repr(note.evidence), note.what, note.why))
