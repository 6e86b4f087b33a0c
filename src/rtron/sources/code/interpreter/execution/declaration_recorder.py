"""Collects what a program declares while it is interpreted."""

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field, replace
from pathlib import Path

from rtron.sources.code.interpreter import abstract_values as av
from rtron.sources.code.ir import SourceProblem
from rtron.sources.declaration import (
    CreatedNode,
    Declaration,
    DeclarationKind,
    FrameBroadcast,
    FrameUse,
    MistypedParameter,
    NodeInterface,
    NodeSite,
    PluginId,
    RuntimeStart,
)
from rtron.vocabulary import (
    Evidence,
    NodeParameter,
    NodeParameterValue,
    QoS,
    Resolution,
    UnresolvedCause,
    UnresolvedItem,
)
from rtron.vocabulary.enums import HiddenPart
from rtron.vocabulary.launch import resolve_name

MAX_DECLARATIONS = 2000
MAX_LOCATIONS = 24


@dataclass(slots=True)
class DeclarationRecorder:
    """What a node at `site` declares; `muted` counts the trial runs that must leave no trace.

    `is_spinning` says that all is set up and callbacks run, `in_parameter_callback` that a callback
    runs which a change of parameters calls (ROS 2).
    """

    site: NodeSite
    muted: int = 0
    is_spinning: bool = False
    in_parameter_callback: bool = False
    _declarations: dict[tuple[DeclarationKind, str, str, str], Declaration] = field(
        default_factory=dict
    )
    _handler_depth: int = 0
    _handler_declarations: dict[tuple[DeclarationKind, str, str, str], Declaration] = field(
        default_factory=dict
    )
    _nodes: dict[str, CreatedNode] = field(default_factory=dict)
    _parameters: dict[tuple[str, str], NodeParameter] = field(default_factory=dict)
    _frames: dict[FrameBroadcast, None] = field(default_factory=dict)
    _frame_uses: dict[FrameUse, None] = field(default_factory=dict)
    _plugin_ids: dict[PluginId, None] = field(default_factory=dict)
    _mistyped: dict[MistypedParameter, None] = field(default_factory=dict)
    _undecided_parameters: int = 0
    _undecided_conditions: int = 0
    _starts: dict[RuntimeStart, None] = field(default_factory=dict)
    _unresolved: dict[UnresolvedItem, None] = field(default_factory=dict)

    def is_empty(self, file: str) -> bool:
        """Tell whether a program declares nothing by itself, and no note is of a file."""
        noted = (place.file for note in self._unresolved for place in note.evidence)
        declared = (each for each in self._declarations.values() if not each.implicit)
        return file not in noted and not any(declared)

    def declare(
        self,
        kind: DeclarationKind,
        name: av.Value,
        type: str,
        *evidence: Evidence,
        implicit: bool = False,
        latched: bool = False,
        node: str = "",
        qos: QoS | None = None,
    ) -> None:
        """Record a declared name, once for each of its options."""
        for option in self._without_callback_names(
            (kind, type, node), self.reported_options(name), evidence
        ):
            declared = Declaration(
                kind=kind,
                name=resolve_name(av.text_with_holes(option), self.site.name),
                type=type,
                node=node,
                qos=qos,
                implicit=implicit,
                undecided=self._undecided_conditions > 0,
                latched=latched,
                resolution=_resolution(option),
                evidence=evidence,
            )
            self._add_declaration(declared)

    def _without_callback_names(
        self,
        endpoint: tuple[DeclarationKind, str, str],
        found: tuple[av.Value, ...],
        evidence: tuple[Evidence, ...],
    ) -> tuple[av.Value, ...]:
        """Leave out the names that callbacks may give later to what a node has; this is noted.

        A callback makes something again if it may have the name that the node has it by, or if a
        change of parameters calls it and the node has something of its kind and type.
        """
        later = [option for option in found if not isinstance(option, av.Scalar)]
        if not (later and (self.is_spinning or self.in_parameter_callback)):
            return found
        remaining = tuple(option for option in found if option not in later)
        names = {resolve_name(av.text_with_holes(option), self.site.name) for option in remaining}
        existing = [
            name for kind, name, type, node in self._declarations if endpoint == (kind, type, node)
        ]
        if not (names.intersection(existing) or (self.in_parameter_callback and existing)):
            return found
        name = next((name for name in existing if name in names), existing[0] if existing else "")
        why = "a callback may make it again while it runs, under a name that is not known before"
        what, cause = f"{endpoint[0].value} {name} of {endpoint[2]}", UnresolvedCause.RUN_TIME
        self.add_unresolved(what, why, evidence[0], cause=cause)
        return remaining

    @contextmanager
    def undecided_condition(self) -> Iterator[None]:
        """Record what is declared under a condition that is not known."""
        self._undecided_conditions += 1
        try:
            yield
        finally:
            self._undecided_conditions -= 1

    @contextmanager
    def exception_handler(self) -> Iterator[None]:
        """Record what only an exception handler declares, which may be reached or not."""
        self._handler_depth += 1
        try:
            yield
        finally:
            self._handler_depth -= 1

    @contextmanager
    def undecided_parameter(self) -> Iterator[None]:
        """Record what runs only if a parameter, which is not known, says so."""
        self._undecided_parameters += 1
        try:
            yield
        finally:
            self._undecided_parameters -= 1

    def add_frame(self, frame: FrameBroadcast) -> None:
        """Record a transform that the node broadcasts."""
        if not self.muted:
            is_certain = frame.is_certain and not self._undecided_parameters
            found = replace(frame, is_certain=is_certain)
            is_full = len(self._frames) >= MAX_DECLARATIONS
            self._frames[FrameBroadcast(child="") if is_full else found] = None

    def add_frame_use(self, use: FrameUse) -> None:
        """Record a frame that is used, unless a parameter that is not known decides on it."""
        is_certain = not (self.muted or self._undecided_parameters)
        if is_certain and len(self._frame_uses) < MAX_DECLARATIONS:
            self._frame_uses[use] = None

    def add_plugin_id(self, plugin_id: PluginId) -> None:
        """Record the id of a plugin that a request asks for."""
        is_certain = not (self.muted or self._undecided_parameters)
        if is_certain and len(self._plugin_ids) < MAX_DECLARATIONS:
            self._plugin_ids[plugin_id] = None

    def add_node(self, made: CreatedNode) -> None:
        """Record a node that the process makes."""
        if not self.muted and len(self._nodes) < MAX_DECLARATIONS:
            self._nodes.setdefault(made.name, made)

    def add_parameter(self, node: str, name: str, value: NodeParameterValue | None) -> None:
        """Record a parameter that a node declares; one that may be this or that is not known."""
        if not self.muted and len(self._parameters) < MAX_DECLARATIONS:
            found = NodeParameter(node=node, name=name, value=value)
            known = self._parameters.setdefault((node, name), found)
            if known != found:
                self._parameters[node, name] = replace(found, value=None)

    def add_mistyped(self, parameter: MistypedParameter) -> None:
        """Record a parameter of another type than declared, unless a condition decides on it."""
        is_certain = not (self._undecided_conditions or self._undecided_parameters)
        if is_certain and not self.muted and len(self._mistyped) < MAX_DECLARATIONS:
            self._mistyped[parameter] = None

    def reported_options(self, name: av.Value) -> tuple[av.Value, ...]:
        """Return what to report of a name: where no launch is known, a default is the answer."""
        found = av.options(name)
        known = tuple(option for option in found if isinstance(option, av.Scalar))
        return known if known and not self.site.parameters_complete else found

    def add_start(self, path: str, args: tuple[str, ...], evidence: Evidence) -> None:
        """Record a launch file that the node starts."""
        if not self.muted:
            self._starts[RuntimeStart(path=path, args=args, evidence=(evidence,))] = None

    def add_unresolved(
        self,
        what: str,
        why: str,
        *evidence: Evidence,
        hides: HiddenPart | None = None,
        package: str = "",
        cause: UnresolvedCause | None = None,
    ) -> None:
        """Record what could not be found out, where, and what may be behind it."""
        if not self.muted and len(self._unresolved) < MAX_DECLARATIONS:
            note = UnresolvedItem(what=what, why=why, hides=hides, package=package, cause=cause)
            self._unresolved[replace(note, evidence=evidence)] = None

    def add_partly_read(self, what: str, why: str, place: Evidence) -> None:
        """Record what is run or read in part only, and where it ends."""
        self.add_unresolved(what, why, place, cause=UnresolvedCause.PARTLY_READ)

    def add_too_large(self, what: str, place: Evidence) -> None:
        """Record what is not run to its end, because it takes too many steps."""
        self.add_unresolved(what, "too large to be run whole", place, cause=UnresolvedCause.LIMIT)

    def add_problem(self, path: Path, problem: SourceProblem) -> None:
        """Record a part of a file that could not be read."""
        location = Evidence(file=str(path), line=problem.line)
        self.add_unresolved(path.name, problem.why, location, cause=problem.cause)

    def declared(self, kind: DeclarationKind) -> list[Declaration]:
        """Return what was recorded of a kind."""
        return [each for each in self._declarations.values() if each.kind is kind]

    def result(self) -> NodeInterface:
        """Return all that was recorded."""
        for caught in self._handler_declarations.values():
            what = f"{caught.kind.value} {caught.name}"
            why = "only an exception handler declares it, and whether that is reached is not known"
            self.add_unresolved(what, why, caught.evidence[0], cause=UnresolvedCause.RUN_TIME)
        return NodeInterface(
            nodes=tuple(self._nodes.values()),
            declarations=tuple(self._declarations.values()),
            runtime_starts=tuple(self._starts),
            unresolved=tuple(self._unresolved),
            parameters=tuple(self._parameters.values()),
            frames=tuple(self._frames),
            frame_uses=tuple(self._frame_uses),
            plugin_ids=tuple(self._plugin_ids),
            mistyped=tuple(self._mistyped),
        )

    def _add_declaration(self, declared: Declaration) -> None:
        if self.muted:
            return
        if len(self._declarations) >= MAX_DECLARATIONS:
            why = f"more than {MAX_DECLARATIONS} endpoints: this and others are left out"
            self.add_unresolved(self.site.name, why, *declared.evidence[:1])
            return
        key = (declared.kind, declared.name, declared.type, declared.node)
        if not self._handler_depth:
            self._handler_declarations.pop(key, None)
        elif key not in self._declarations and declared.evidence and not declared.implicit:
            self._handler_declarations[key] = declared
        known = self._declarations.setdefault(key, declared)
        if known.undecided and not declared.undecided:
            known = self._declarations[key] = replace(known, undecided=False)
        if known is not declared and declared.node and len(known.evidence) < MAX_LOCATIONS:
            locations = dict.fromkeys((*known.evidence, *declared.evidence))
            self._declarations[key] = replace(known, evidence=tuple(locations))


def _resolution(name: av.Value) -> Resolution:
    if not isinstance(name, av.Scalar):
        return (
            Resolution.SYMBOLIC
            if isinstance(name, (av.Unknown, av.PartialText))
            else Resolution.LITERAL
        )
    return Resolution.PARAMETER if av.is_tainted(name) else Resolution.LITERAL
