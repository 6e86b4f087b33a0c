"""Whole launches of public apps against graphs that were read in their sources by hand.

Each truth was written before the app was scanned, and stands in `evaluation/data/graphs/` with its
commit, the places that show each endpoint, and what was decided where the source leaves it open.

Where readers may name the same thing in two ways, both sides are brought to one:

- A nodelet's endpoints count at its `manager`, as a running master shows them; the calls of the
  manager's services that load and unload it count at the nodelet's own name, which is its loader's.
- What the client library puts on a node of its own (`own_node`, whose name a run makes) is listed
  at the node that it serves, and may be found at a node of that name, made in the same file.
"""

import re
from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any, NamedTuple

import yaml

from evaluation.common.datasets import Datasets, Reporter
from figures.figure import Figure
from rtron.errors import InputError
from rtron.sources.static.common.scan_options import ScanOptions
from rtron.sources.static.ros1.app import scan_app
from rtron.sources.static.ros2.app import scan_ros2_app
from rtron.vocabulary import ActionRole, Direction, InteractionGraph, Resolution, UnresolvedItem

TRUTHS = Path(__file__).parents[1] / "data" / "graphs"
KINDS = {
    "publishes": "topic",
    "subscribes": "topic",
    "services": "service",
    "clients": "service",
    "action_servers": "action",
    "action_clients": "action",
}
"""What a node has, and what its name is called in a truth."""
_ENDPOINT_KINDS = {Direction.PUBLISH: "publishes", Direction.SUBSCRIBE: "subscribes"}
GOALS = {"recall": 0.95, "precision": 0.98}
_SHORT_COMMIT = 7
_UNLISTED = ("/rosout", "/rosout_agg", "/parameter_events", "/clock", "/bond")
_UNLISTED_ENDINGS = (
    *("/transition_event", "/get_loggers", "/set_logger_level", "/get_logger_levels"),
    *("/change_state", "/get_state", "/get_available_states", "/get_available_transitions"),
    *("/get_transition_graph", "/set_logger_levels", "/bond"),
)
_PARAMETER_SERVICES = frozenset(
    f"{verb}_parameters" for verb in ("get", "set", "list", "describe")
) | {"get_parameter_types", "set_parameters_atomically"}


class Triple(NamedTuple):
    """A node, what it has, and the name of that."""

    node: str
    kind: str
    name: str


@dataclass(frozen=True, slots=True)
class GraphScore:
    """The triples that are live and those of them that were found; what was claimed, and wrongly.

    `untold` are those that were missed although no note speaks of their node, of their file or of a
    launch file that is not here and may start it, and no endpoint of that kind is reported there
    whose name is open.
    """

    live: frozenset[Triple]
    found: frozenset[Triple]
    reported: frozenset[Triple]
    wrong: frozenset[Triple]
    untold: frozenset[Triple]

    @property
    def recall(self) -> float:
        """Return the share of the live triples that were found."""
        return len(self.found) / len(self.live) if self.live else 1.0

    @property
    def precision(self) -> float:
        """Return the share of what was reported that is there."""
        return 1 - len(self.wrong) / len(self.reported) if self.reported else 1.0

    def differences(self) -> Iterator[str]:
        """Yield a line for each triple that was missed, or is not there."""
        missed = self.live - self.found
        for word, triples in (
            ("SILENT", missed & self.untold),
            ("MISSED", missed - self.untold),
            ("WRONG", self.wrong),
        ):
            yield from (f"  {word} {' '.join(triple)}" for triple in sorted(triples))


@dataclass(frozen=True)
class GraphTruth:
    """The document of a truth."""

    document: Mapping[str, Any]

    @property
    def name(self) -> str:
        """Return the name of the app's repository, without its owner."""
        return str(self.document["repository"]).rpartition("/")[2]

    def repositories(self) -> list[str]:
        """Return the app's repository, and others of its owner that it uses."""
        owner = str(self.document["repository"]).partition("/")[0]
        others = self.document.get("sources") or {}
        ours = {name: sha for name, sha in others.items() if name.partition("/")[0] == owner}
        return [_folder(self.document["repository"], self.document["commit"]), *_folders(ours)]

    def dependencies(self) -> list[str]:
        """Return the repositories of others that were read for the truth."""
        return _folders(self.document.get("sources") or {})

    def scan(self, datasets: Datasets, *, with_dependencies: bool) -> InteractionGraph:
        """Return the graph of the app, others' nodes known by models or by their source."""
        own = datasets.repositories(self.repositories())
        others = datasets.present(self.dependencies()) if with_dependencies else []
        folders = list(dict.fromkeys([*own, *others]))
        arguments = {
            key: str(value) for key, value in (self.document.get("arguments") or {}).items()
        }
        launches = [(own[0] / self.document["launch"], arguments)]
        environ = {
            "ROS_DISTRO": self.document["distro"],
            **(self.document.get("environment") or {}),
        }
        if self.document["ros"] == 1:
            return scan_app(folders, launches, environ, ScanOptions()).graph
        return scan_ros2_app(folders, launches, environ, ScanOptions())

    @cached_property
    def known_nodes(self) -> frozenset[str]:
        """The nodes whose source could be read."""
        return frozenset(
            node["name"] for node in self.document["nodes"] if node.get("source") != "none"
        )

    def score(self, graph: InteractionGraph, *, own_only: bool = False) -> GraphScore:
        """Score what a graph says of the nodes of the truth, or of the app's own."""
        nodes = [n for n in self.document["nodes"] if not (own_only and n.get("third_party"))]
        entries = [each for node in nodes for each in _entries(node)]
        names = {n.get("manager", n["name"]) for n in nodes} | {n["name"] for n in nodes}
        names &= self.known_nodes
        live = frozenset(triple for triple, entry in entries if _is_live(entry))
        explicit = frozenset(
            t for t, entry in entries if _is_live(entry) and not entry.get("implicit")
        )
        others = {t for n in self.document["nodes"] if n not in nodes for t, _ in _entries(n)}
        others -= {triple for triple, _ in entries}
        reported = [
            (t, is_implicit)
            for t, is_implicit in triples_of(graph)
            if t.node in names and t not in others
        ]
        found = {triple for triple, _ in reported}
        found |= {t for t, entry in entries if _is_at_own_node(t, entry, graph)}
        found &= explicit
        claimed = frozenset(
            t for t, is_implicit in reported if not is_implicit and not self._is_open(t)
        )
        told = {
            triple
            for node in nodes
            for triple, entry in _entries(node)
            if _is_told(node, entry, graph.unresolved)
        }
        if any(_is_launch_file(note) for note in graph.unresolved):
            started = {node.name for node in graph.nodes}
            told |= {t for t in explicit if t.node not in started}
        symbolic = set(_symbolic_kinds(graph))
        untold = frozenset(t for t in explicit - found - told if t[:2] not in symbolic)
        return GraphScore(explicit, frozenset(found), claimed, claimed - live, untold)

    def _is_open(self, triple: Triple) -> bool:
        """Tell whether only a run decides on something, by the node and the name's beginning."""
        for entry in self.document.get("open") or ():
            topics = [entry, *entry.get("publishes", ()), *entry.get("subscribes", ())]
            names = [each["topic"] for each in topics if isinstance(each, dict) and "topic" in each]
            is_of_node = triple.node in (entry.get("node"), entry.get("process"))
            if is_of_node and any(triple.name.startswith(_known_part(name)) for name in names):
                return True
        return False


def figures(datasets: Datasets, reporter: Reporter) -> Iterator[Figure]:
    """Score every app whose repositories are here, and all of them together."""
    truths = [
        GraphTruth(yaml.safe_load(path.read_text())) for path in sorted(TRUTHS.glob("*.yaml"))
    ]
    for variant, with_dependencies in (("models", False), ("sources", True)):
        whole, own = [], []
        for truth in truths:
            reporter.progress(f"{truth.name} with {variant}")
            graph = _scanned(truth, datasets, reporter, with_dependencies=with_dependencies)
            whole.append(truth.score(graph))
            own.append(truth.score(graph, own_only=True))
            title = f"{truth.name} with {variant}, ROS {truth.document['ros']}"
            reporter.lines([_row(title, whole[-1]), _row("  its own nodes", own[-1])])
            reporter.detail([*whole[-1].differences(), *_node_differences(truth, graph)])
        yield from _totals(f"graphs.{variant}", whole, reporter)
        yield from _totals(f"graphs.{variant}.own", own, reporter)


def _scanned(
    truth: GraphTruth, datasets: Datasets, reporter: Reporter, *, with_dependencies: bool
) -> InteractionGraph:
    """Return the graph of an app, one with only a note if it is refused."""
    try:
        return truth.scan(datasets, with_dependencies=with_dependencies)
    except InputError as error:
        reporter.lines([f"{truth.name} is refused: {error}"])
        names = " ".join(sorted(truth.known_nodes))
        return InteractionGraph(app="", unresolved=(UnresolvedItem(what=names, why=str(error)),))


def triples_of(graph: InteractionGraph) -> Iterator[tuple[Triple, bool]]:
    """Yield what a graph says that truths list, no symbolic name, and whether it is implicit."""
    for end in graph.endpoints:
        kind = _ENDPOINT_KINDS[end.direction]
        if end.resolution is not Resolution.SYMBOLIC and _is_listed(end.topic):
            yield Triple(end.node, kind, end.topic), end.implicit
    for kind, ends in (("services", graph.services), ("clients", graph.clients)):
        for service in filter(lambda each: _is_listed(each.name), ends):
            yield Triple(service.node, kind, service.name), service.implicit
    for action in graph.actions:
        is_server = action.role is ActionRole.SERVER
        kind = "action_servers" if is_server else "action_clients"
        yield Triple(action.node, kind, action.name), False


def _symbolic_kinds(graph: InteractionGraph) -> Iterator[tuple[str, str]]:
    """Yield the nodes that have endpoints whose names are not known, with their kinds."""
    for end in graph.endpoints:
        if end.resolution is Resolution.SYMBOLIC:
            yield end.node, _ENDPOINT_KINDS[end.direction]
    for kind, ends in (("services", graph.services), ("clients", graph.clients)):
        yield from ((service.node, kind) for service in ends if "{" in service.name)


def _is_listed(name: str) -> bool:
    """Tell whether a truth lists such a name; every node has the others."""
    last = name.rpartition("/")[2]
    unlisted = name in _UNLISTED or name.endswith(_UNLISTED_ENDINGS) or last in _PARAMETER_SERVICES
    return not unlisted and "/_action/" not in name


def _known_part(name: str) -> str:
    """Return the beginning of a name up to what a run decides: `robot0..15`, `robot<id>`."""
    return re.split(r"<|\d+\.\.", name)[0]


def _entries(node: Mapping[str, Any]) -> Iterator[tuple[Triple, Mapping[str, Any]]]:
    for kind, key in KINDS.items():
        for entry in node.get(kind) or ():
            if _is_listed(entry[key]):
                is_dead = node.get("live") is False
                triple = Triple(_home(node, entry[key]), kind, entry[key])
                yield triple, {**entry, "is_dead": is_dead}


def _home(node: Mapping[str, Any], name: str) -> str:
    """Return the node that something counts at: the manager of a nodelet, but for its loader."""
    manager = node.get("manager", node["name"])
    is_of_loader = name in (f"{manager}/load_nodelet", f"{manager}/unload_nodelet")
    return str(node["name"] if is_of_loader else manager)


def _is_at_own_node(triple: Triple, entry: Mapping[str, Any], graph: InteractionGraph) -> bool:
    """Tell whether a subscription is reported at the node that the client library makes for it."""
    if "own_node" not in entry:
        return False
    own, file = "/" + _known_part(entry["own_node"]), _file_name(entry)
    return any(
        end.node.partition("{")[0] == own
        and (_ENDPOINT_KINDS[end.direction], end.topic) == triple[1:]
        and any(Path(place.file).name == file for place in end.evidence)
        for end in graph.endpoints
    )


def _file_name(entry: Mapping[str, Any]) -> str:
    """Return the name of the file that shows an endpoint."""
    return str(entry.get("evidence", "")).rpartition(":")[0].rpartition("/")[2]


def _is_live(entry: Mapping[str, Any]) -> bool:
    return entry.get("live") is not False and not entry["is_dead"]


def _is_told(
    node: Mapping[str, Any], entry: Mapping[str, Any], notes: Collection[UnresolvedItem]
) -> bool:
    """Tell whether a note speaks of the node, of its program, or of the file of an endpoint."""
    file = _file_name(entry)
    words = {node["name"], f"{node.get('package')}/{node.get('program')}"}
    for note in notes:
        texts = (note.what, note.why, note.missing)
        is_of_package = note.missing.startswith(f"{node.get('package')}/")
        if is_of_package or any(word in text for word in words for text in texts):
            return True
        if file and any(Path(place.file).name == file for place in note.evidence):
            return True
    return False


def _is_launch_file(note: UnresolvedItem) -> bool:
    """Tell whether a note is of a launch file that is not here."""
    return note.what.startswith("include")


def _node_differences(truth: GraphTruth, graph: InteractionGraph) -> Iterator[str]:
    expected = {node["name"] for node in truth.document["nodes"] if node.get("live") is not False}
    found = {node.name for node in graph.nodes}
    yield from (f"  MISSED node {name}" for name in sorted(expected - found))
    yield from (f"  OTHER node {name}" for name in sorted(found - expected))


def _totals(name: str, scores: Sequence[GraphScore], reporter: Reporter) -> Iterator[Figure]:
    live, found, reported, wrong, untold = (
        sum(len(getattr(score, part)) for score in scores)
        for part in ("live", "found", "reported", "wrong", "untold")
    )
    recall, precision = found / live, 1 - wrong / reported
    reporter.lines(
        [f"{name}: {found} of {live} found, {wrong} of {reported} wrong, {untold} silent", ""]
    )
    yield Figure(f"{name}.recall", recall, None, "share", at_least=GOALS["recall"])
    yield Figure(f"{name}.precision", precision, None, "share", at_least=GOALS["precision"])
    yield Figure(f"{name}.silent", untold, None, "endpoints", at_most=0)


def _row(title: str, score: GraphScore) -> str:
    return (
        f"{title:44} recall {score.recall:.3f} of {len(score.live):4}  "
        f"precision {score.precision:.3f} of {len(score.reported):4}  silent {len(score.untold)}"
    )


def _folders(repositories: Mapping[str, str]) -> list[str]:
    return [_folder(name, commit) for name, commit in repositories.items()]


def _folder(repository: str, commit: str) -> str:
    return f"{repository}@{commit[:_SHORT_COMMIT]}"
