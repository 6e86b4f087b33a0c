"""Collects what a program declares while it is interpreted."""

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field, replace
from pathlib import Path

from rtron.sources.code.interpreter.abstract_values.value_types import (
    Hole,
    Known,
    Text,
    Value,
    is_tainted,
    options,
    spelled,
)
from rtron.sources.code.ir import Problem
from rtron.sources.declaration import (
    Declaration,
    DeclarationKind,
    MadeNode,
    NodeInterface,
    NodeSite,
    StartedLaunch,
)
from rtron.vocabulary import Evidence, NodeParameter, PlainValue, QoS, Resolution, Unresolved
from rtron.vocabulary.launch import resolve_name

MAX_DECLARATIONS = 2000
MAX_PLACES = 24


@dataclass(slots=True)
class Recorder:
    """What a node at `site` declares; `muted` counts the trial runs that must leave no trace.

    `spun` says that all is set up and callbacks run, `setting` that one of them runs which a change
    of parameters calls (ROS 2).
    """

    site: NodeSite
    muted: int = 0
    spun: bool = False
    setting: bool = False
    _declarations: dict[tuple[DeclarationKind, str, str, str], Declaration] = field(
        default_factory=dict
    )
    _handling: int = 0
    _caught: dict[tuple[DeclarationKind, str, str, str], Declaration] = field(default_factory=dict)
    _nodes: dict[str, MadeNode] = field(default_factory=dict)
    _parameters: dict[tuple[str, str], NodeParameter] = field(default_factory=dict)
    _starts: dict[StartedLaunch, None] = field(default_factory=dict)
    _unresolved: dict[Unresolved, None] = field(default_factory=dict)

    def declare(
        self,
        kind: DeclarationKind,
        name: Value,
        type: str,
        *evidence: Evidence,
        implicit: bool = False,
        latched: bool = False,
        node: str = "",
        qos: QoS | None = None,
    ) -> None:
        """Record a declared name, once for each of its options."""
        for option in self._first((kind, type, node), self.likely(name), evidence):
            declared = Declaration(
                kind=kind,
                name=resolve_name(spelled(option), self.site.name),
                type=type,
                node=node,
                qos=qos,
                implicit=implicit,
                latched=latched,
                resolution=_resolution(option),
                evidence=evidence,
            )
            self._add(declared)

    def _first(
        self,
        end: tuple[DeclarationKind, str, str],
        found: tuple[Value, ...],
        evidence: tuple[Evidence, ...],
    ) -> tuple[Value, ...]:
        """Leave out the names that callbacks may give later to what a node has; this is noted.

        A callback makes something again if it may have the name that the node has it by, or if a
        change of parameters calls it and the node has something of its kind and type.
        """
        later = [option for option in found if not isinstance(option, Known)]
        if not (later and (self.spun or self.setting)):
            return found
        kept = tuple(option for option in found if option not in later)
        names = {resolve_name(spelled(option), self.site.name) for option in kept}
        had = [name for kind, name, type, node in self._declarations if end == (kind, type, node)]
        if not (names.intersection(had) or (self.setting and had)):
            return found
        name = next((name for name in had if name in names), had[0] if had else "")
        why = "a callback may make it again while it runs, under a name that is not known before"
        self.unresolved(f"{end[0].value} {name} of {end[2]}", why, evidence[0])
        return kept

    @contextmanager
    def in_handler(self) -> Iterator[None]:
        """Record what only an exception handler declares, which may be reached or not."""
        self._handling += 1
        try:
            yield
        finally:
            self._handling -= 1

    def node(self, made: MadeNode) -> None:
        """Record a node that the process makes."""
        if not self.muted and len(self._nodes) < MAX_DECLARATIONS:
            self._nodes.setdefault(made.name, made)

    def parameter(self, node: str, name: str, value: PlainValue | None) -> None:
        """Record a parameter that a node declares; one that may be this or that is not known."""
        if not self.muted and len(self._parameters) < MAX_DECLARATIONS:
            found = NodeParameter(node=node, name=name, value=value)
            known = self._parameters.setdefault((node, name), found)
            if known != found:
                self._parameters[node, name] = replace(found, value=None)

    def likely(self, name: Value) -> tuple[Value, ...]:
        """Return what to report of a name: where no launch is known, a default is the answer."""
        found = options(name)
        known = tuple(option for option in found if isinstance(option, Known))
        return known if known and not self.site.complete else found

    def start(self, path: str, args: tuple[str, ...], evidence: Evidence) -> None:
        """Record a launch file that the node starts."""
        if not self.muted:
            self._starts[StartedLaunch(path=path, args=args, evidence=(evidence,))] = None

    def unresolved(self, what: str, why: str, evidence: Evidence) -> None:
        """Record what could not be found out."""
        if not self.muted and len(self._unresolved) < MAX_DECLARATIONS:
            self._unresolved[Unresolved(what=what, why=why, evidence=(evidence,))] = None

    def problem(self, path: Path, problem: Problem) -> None:
        """Record a part of a file that could not be read."""
        place = Evidence(file=str(path), line=problem.line)
        self.unresolved(path.name, problem.why, place)

    def result(self) -> NodeInterface:
        """Return all that was recorded."""
        for caught in self._caught.values():
            what = f"{caught.kind.value} {caught.name}"
            why = "only an exception handler declares it, and whether that is reached is not known"
            self.unresolved(what, why, caught.evidence[0])
        return NodeInterface(
            nodes=tuple(self._nodes.values()),
            declarations=tuple(self._declarations.values()),
            starts=tuple(self._starts),
            unresolved=tuple(self._unresolved),
            parameters=tuple(self._parameters.values()),
        )

    def _add(self, declared: Declaration) -> None:
        if self.muted or len(self._declarations) >= MAX_DECLARATIONS:
            return
        key = (declared.kind, declared.name, declared.type, declared.node)
        if not self._handling:
            self._caught.pop(key, None)
        elif key not in self._declarations and declared.evidence and not declared.implicit:
            self._caught[key] = declared
        known = self._declarations.setdefault(key, declared)
        if known is not declared and declared.node and len(known.evidence) < MAX_PLACES:
            places = dict.fromkeys((*known.evidence, *declared.evidence))
            self._declarations[key] = replace(known, evidence=tuple(places))


def _resolution(name: Value) -> Resolution:
    if not isinstance(name, Known):
        return Resolution.SYMBOLIC if isinstance(name, (Hole, Text)) else Resolution.LITERAL
    return Resolution.PARAMETER if is_tainted(name) else Resolution.LITERAL
