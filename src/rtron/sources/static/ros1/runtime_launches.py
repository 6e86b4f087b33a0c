"""What nodes start themselves: launch files, and programs by rosrun."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from pathlib import Path

from rtron.errors import InputError
from rtron.sources.declaration import NodeSite, RuntimeStart
from rtron.sources.static.common.app_node import (
    AppNode,
    add_argument_parameters,
    resolve_argument_remaps,
)
from rtron.sources.static.common.launch_paths import find_launch_file
from rtron.sources.static.common.node_part import NodePart
from rtron.sources.static.common.unresolved import UnresolvedList
from rtron.sources.workspace import Workspace
from rtron.vocabulary import Evidence, ParameterTree, UnresolvedCause, UnresolvedItem
from rtron.vocabulary.launch import canonical_name

MAX_RUNTIME_STARTS = 1000
ROSRUN = "rosrun"


@dataclass(frozen=True, slots=True, kw_only=True)
class RuntimeLaunch:
    """A launch file that a node starts, with its arguments."""

    path: Path
    args: tuple[tuple[str, str], ...]
    started_by: str
    evidence: Evidence


@dataclass(slots=True)
class RuntimeLaunches:
    """Follows what nodes start, each launch file with its arguments and each node once."""

    workspace: Workspace
    requested: Iterable[tuple[Path, Mapping[str, str]]]
    unresolved: UnresolvedList
    _known: set[tuple[object, ...]] = field(default_factory=set)

    def __post_init__(self) -> None:
        self._known.update(
            (path.absolute(), tuple(sorted(a.items()))) for path, a in self.requested
        )

    def new_starts(
        self, parts: Iterable[NodePart], parameters: ParameterTree
    ) -> tuple[list[RuntimeLaunch], list[AppNode]]:
        """Return the launch files and the nodes that parts start, those that are new."""
        files: list[RuntimeLaunch] = []
        nodes: list[AppNode] = []
        for part, start in ((p, s) for p in parts for s in p.interface.runtime_starts):
            if start.args[:1] == (ROSRUN,):
                nodes.append(rosrun_node(start, part, parameters))
                continue
            file = runtime_launch(start, part, self.workspace)
            if isinstance(file, UnresolvedItem):
                self.unresolved.entries.append(file)
            else:
                files.append(file)
        new_files = [f for f in files if self._is_new((f.path, f.args), f.evidence)]
        return new_files, [n for n in nodes if self._is_new(_node_key(n), n.evidence)]

    def _is_new(self, key: tuple[object, ...], location: Evidence) -> bool:
        if key in self._known:
            return False
        self._known.add(key)
        if len(self._known) > MAX_RUNTIME_STARTS:
            self.unresolved.add(
                "what nodes start", f"more than {MAX_RUNTIME_STARTS} of them", location
            )
        return len(self._known) <= MAX_RUNTIME_STARTS


def _node_key(node: AppNode) -> tuple[object, ...]:
    return node.package, node.type, node.name, node.site.args


def runtime_launch(
    start: RuntimeStart, part: NodePart, workspace: Workspace
) -> RuntimeLaunch | UnresolvedItem:
    """Return the launch file that is started, or why it is not known."""
    location = next(iter(start.evidence), part.node.evidence)
    if "{" in start.path:
        why = "its name is not known before the app runs"
        return start.unread(part.owner, why, UnresolvedCause.RUN_TIME)
    try:
        path = find_launch_file(start.path, workspace)
    except InputError as error:
        return start.unread(part.owner, str(error))
    pairs = (word.split(":=", 1) for word in start.args if ":=" in word)
    args = tuple(sorted((name, value) for name, value in pairs))
    return RuntimeLaunch(path=path, args=args, started_by=part.owner, evidence=location)


def rosrun_node(start: RuntimeStart, part: NodePart, parameters: ParameterTree) -> AppNode:
    """Return the node that `rosrun PACKAGE TYPE …` starts, named like its program.

    The name that the program gives itself counts where `__name:=` gives none; programs are mostly
    called as they call themselves.
    """
    package, _, type = start.path.partition("/")
    words = start.args[1:]
    names = dict(word.split(":=", 1) for word in words if word.startswith("__") and ":=" in word)
    stem = names.get("__name", Path(type).stem)
    name = canonical_name(f"/{names.get('__ns', '')}/{stem}")
    location = next(iter(start.evidence), part.node.evidence)
    site = NodeSite(
        name=name,
        args=words,
        parameters=add_argument_parameters(parameters, words, name, location.file),
        remaps=resolve_argument_remaps(words, name),
        environ=part.node.site.environ,
    )
    return AppNode(site=site, package=package, type=type, evidence=location, started_by=part.owner)
