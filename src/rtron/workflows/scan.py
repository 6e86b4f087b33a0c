"""Scan an app: its interaction graph, and what its nodes can do to each other."""

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path
from typing import TypeVar

from rtron.errors import InputError
from rtron.findings import FINDING_RULES, app_facts, find_findings, take_inventory
from rtron.findings.app_facts import AppFacts
from rtron.findings.triage import triage
from rtron.risks import RULES, RiskLists, discover_risks, load_lists
from rtron.sources.bounded_file import read_regular_file
from rtron.sources.ignores import (
    CONFIG_NAME,
    comment_ignores,
    read_baseline,
    read_config,
)
from rtron.vocabulary import (
    Endpoint,
    Evidence,
    Finding,
    Ignore,
    InteractionGraph,
    RiskReport,
    Triage,
    UnresolvedItem,
    WiringFact,
)
from rtron.vocabulary.inventory import Mover

_Part = TypeVar("_Part", Endpoint, UnresolvedItem, WiringFact)

_MAX_SOURCE_BYTES = 4 << 20
_MAX_LINE_LENGTH = 200
_MAX_LINES = 2000


@dataclass(frozen=True)
class ScanResult:
    """The graph of an app, and the paper's risks in it; `lists` are those that the rules use."""

    graph: InteractionGraph
    report: RiskReport
    lists: RiskLists | None = None

    @cached_property
    def findings(self) -> tuple[Finding, ...]:
        """The findings for people, computed when they are first needed."""
        return find_findings(self.app)

    @cached_property
    def inventory(self) -> tuple[Mover, ...]:
        """What can move the robot, computed when it is first needed."""
        return take_inventory(self.app)

    @cached_property
    def app(self) -> AppFacts:
        """What the rules ask of the graph."""
        return app_facts(self.graph, self.lists)


def scan_graph(graph: InteractionGraph, name_lists: Path | None = None) -> ScanResult:
    """Return risks and findings of a graph; `name_lists` adds message types and topic names.

    Raise InputError if that file cannot be used.
    """
    lists = load_lists(name_lists) if name_lists else None
    return ScanResult(graph, discover_risks(graph, lists), lists)


def with_relative_evidence(graph: InteractionGraph, root: Path | None) -> InteractionGraph:
    """Return a graph whose evidence below `root` is named from there, as people read it."""
    if root is None:
        return graph
    prefix = f"{root}/"
    return replace(
        graph,
        endpoints=tuple(_with_relative(each, prefix) for each in graph.endpoints),
        unresolved=tuple(_with_relative(each, prefix) for each in graph.unresolved),
        wiring=tuple(_with_relative(each, prefix) for each in graph.wiring),
    )


def _with_relative(part: _Part, prefix: str) -> _Part:
    return replace(part, evidence=_relative_to(part.evidence, prefix))


def _relative_to(evidence: tuple[Evidence, ...], prefix: str) -> tuple[Evidence, ...]:
    return tuple(replace(each, file=each.file.removeprefix(prefix)) for each in evidence)


RULE_NAMES = (*(rule.name for rule in FINDING_RULES), *(rule.name for rule in RULES))
"""What `rtron.toml` can name."""


def triage_scan(
    result: ScanResult,
    root: Path | None = None,
    config: Path | None = None,
    baseline: Path | None = None,
) -> Triage:
    """Return what is news in a scan of an app below `root`.

    `config` is by default the `rtron.toml` of the working folder, if there is one: never a file of
    the app, which could silence what is found in it. Raise InputError if a file is wrong.
    """
    earlier = read_baseline(baseline) if baseline else None
    ignores = (*_config_ignores(config), *_comment_ignores(result, root))
    return triage(result.graph, result.findings, result.report.risks, ignores, earlier)


def _config_ignores(config: Path | None) -> tuple[Ignore, ...]:
    path = config or Path(CONFIG_NAME)
    if config is None and not path.is_file():
        return ()
    return read_config(path, RULE_NAMES)


def _comment_ignores(result: ScanResult, root: Path | None) -> tuple[Ignore, ...]:
    if root is None:
        return ()
    evidence = (each for finding in result.findings for each in finding.evidence if each.file)
    return tuple(comment_ignores(evidence, root))


def read_source_lines(findings: Iterable[Finding], root: Path | None) -> dict[Evidence, str]:
    """Return the line of each place in a file below `root`; what cannot be read is left out."""
    if root is None:
        return {}
    places = dict.fromkeys(at for each in findings for at in each.evidence if at.file and at.line)
    files: dict[str, list[str]] = {}
    return dict(_source_lines(list(places)[:_MAX_LINES], root, files))


def _source_lines(
    places: Iterable[Evidence], root: Path, files: dict[str, list[str]]
) -> Iterator[tuple[Evidence, str]]:
    for at in places:
        if at.file not in files:
            files[at.file] = _file_lines(root, at.file)
        if at.line <= len(files[at.file]):
            yield at, files[at.file][at.line - 1].strip()[:_MAX_LINE_LENGTH]


def _file_lines(root: Path, name: str) -> list[str]:
    path = (root / name).resolve()
    if not path.is_relative_to(root.resolve()):
        return []
    try:
        data = read_regular_file(path, _MAX_SOURCE_BYTES)
    except InputError:
        return []
    return data.decode("utf-8", errors="replace").splitlines()
