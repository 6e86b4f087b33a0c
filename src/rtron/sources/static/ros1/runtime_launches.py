"""What nodes start themselves: launch files, and programs by rosrun."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from pathlib import Path

from rtron.errors import InputError
from rtron.sources.declaration import NodeSite, StartedLaunch
from rtron.sources.static.common.app_node import AppNode, argument_remaps, with_private
from rtron.sources.static.common.launch_paths import find_launch
from rtron.sources.static.common.node_part import Part
from rtron.sources.static.common.unresolved import Notes
from rtron.sources.workspace import Workspace
from rtron.vocabulary import Evidence, Parameters, Unresolved
from rtron.vocabulary.launch import canonical_name

MAX_STARTED = 1000
ROSRUN = "rosrun"


@dataclass(frozen=True, slots=True, kw_only=True)
class StartedFile:
    """A launch file that a node starts, with its arguments."""

    path: Path
    args: tuple[tuple[str, str], ...]
    by: str
    evidence: Evidence


@dataclass(slots=True)
class Starts:
    """Follows what nodes start, each launch file with its arguments and each node once."""

    workspace: Workspace
    given: Iterable[tuple[Path, Mapping[str, str]]]
    notes: Notes
    _seen: set[tuple[object, ...]] = field(default_factory=set)

    def __post_init__(self) -> None:
        self._seen.update((path.absolute(), tuple(sorted(a.items()))) for path, a in self.given)

    def of(
        self, parts: Iterable[Part], parameters: Parameters
    ) -> tuple[list[StartedFile], list[AppNode]]:
        """Return the launch files and the nodes that parts start, those that are new."""
        files: list[StartedFile] = []
        nodes: list[AppNode] = []
        for part, started in ((p, s) for p in parts for s in p.interface.starts):
            if started.args[:1] == (ROSRUN,):
                nodes.append(started_node(started, part, parameters))
                continue
            file = started_file(started, part, self.workspace)
            if isinstance(file, Unresolved):
                self.notes.unresolved.append(file)
            else:
                files.append(file)
        new_files = [f for f in files if self._is_new((f.path, f.args), f.evidence)]
        return new_files, [n for n in nodes if self._is_new(_key(n), n.evidence)]

    def _is_new(self, key: tuple[object, ...], place: Evidence) -> bool:
        if key in self._seen:
            return False
        self._seen.add(key)
        if len(self._seen) > MAX_STARTED:
            self.notes.add("what nodes start", f"more than {MAX_STARTED} of them", place)
        return len(self._seen) <= MAX_STARTED


def _key(node: AppNode) -> tuple[object, ...]:
    return node.package, node.type, node.name, node.site.args


def started_file(
    started: StartedLaunch, by: Part, workspace: Workspace
) -> StartedFile | Unresolved:
    """Return the launch file that is started, or why it is not known."""
    place = next(iter(started.evidence), by.node.evidence)
    what = f"launch {started.path} that {by.owner} starts"
    if "{" in started.path:
        why = "its name is not known before the app runs"
        return Unresolved(what=what, why=why, evidence=(place,))
    try:
        path = find_launch(started.path, workspace)
    except InputError as error:
        return Unresolved(what=what, why=str(error), evidence=(place,))
    pairs = (word.split(":=", 1) for word in started.args if ":=" in word)
    args = tuple(sorted((name, value) for name, value in pairs))
    return StartedFile(path=path, args=args, by=by.owner, evidence=place)


def started_node(started: StartedLaunch, by: Part, parameters: Parameters) -> AppNode:
    """Return the node that `rosrun PACKAGE TYPE …` starts, named like its program.

    The name that the program gives itself counts where `__name:=` gives none; programs are mostly
    called as they call themselves.
    """
    package, _, type = started.path.partition("/")
    words = started.args[1:]
    names = dict(word.split(":=", 1) for word in words if word.startswith("__") and ":=" in word)
    stem = names.get("__name", Path(type).stem)
    name = canonical_name(f"/{names.get('__ns', '')}/{stem}")
    place = next(iter(started.evidence), by.node.evidence)
    site = NodeSite(
        name=name,
        args=words,
        parameters=with_private(parameters, words, name, place.file),
        remaps=argument_remaps(words, name),
        environ=by.node.site.environ,
    )
    return AppNode(site=site, package=package, type=type, evidence=place, started_by=by.owner)
