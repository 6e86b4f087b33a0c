"""Which messages the packages of a workspace publish and subscribe, found in their programs."""

from collections import defaultdict
from collections.abc import Iterator, Mapping, Sequence
from contextlib import closing
from dataclasses import dataclass, field
from pathlib import Path

from rtron.sources.declaration import Declaration, DeclarationKind
from rtron.sources.static.cache import open_cache
from rtron.sources.static.options import ScanOptions
from rtron.sources.static.pool import Pool
from rtron.sources.static.programs import programs
from rtron.sources.static.structure import workspace_state
from rtron.sources.static.task import Task, TaskResult
from rtron.sources.workspace import read_workspace

_SENT = frozenset({DeclarationKind.PUBLISH, DeclarationKind.ACTION_CLIENT})
_HEARD = frozenset({DeclarationKind.SUBSCRIBE, DeclarationKind.ACTION_SERVER})
_ACTIONS = frozenset({DeclarationKind.ACTION_CLIENT, DeclarationKind.ACTION_SERVER})


@dataclass(slots=True, kw_only=True)
class PackageTraffic:
    """The message types that a package's programs publish and subscribe; an action's are goals."""

    publishes: set[str] = field(default_factory=set)
    subscribes: set[str] = field(default_factory=set)


def read_traffic(folder: Path, options: ScanOptions) -> Mapping[str, PackageTraffic]:
    """Return the traffic of each package below a folder that has programs of ROS 1.

    Only what lies in the folder is read; a program that cannot be understood has no traffic.
    """
    workspace = read_workspace([folder], {})
    owned = list(programs(workspace, folder.absolute()))
    state = workspace_state(workspace) if options.cache else ""
    pool = Pool(workspace, options.workers, options.seconds)
    owners = {id(task): package for package, task in owned}
    found: dict[str, PackageTraffic] = defaultdict(PackageTraffic)
    with closing(pool):
        results = _results([task for _, task in owned], pool, state, options)
        for done, (task, result) in enumerate(results, 1):
            options.progress(done, len(owned), task.site.name)
            _add(found[owners[id(task)]], result.interface.declarations)
    return found


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
