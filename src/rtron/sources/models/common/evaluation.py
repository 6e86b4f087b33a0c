"""From a model and the place where its node runs to what the node declares."""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from itertools import islice

from rtron.sources.declaration import (
    Declaration,
    DeclarationKind,
    MadeNode,
    NodeInterface,
    NodeSite,
)
from rtron.sources.launch.common.errors import UnresolvableError
from rtron.sources.models.common.catalog import Models, load_models
from rtron.sources.models.common.expressions import Expressions
from rtron.sources.models.common.model_scope import Scope, scope_at
from rtron.sources.models.common.plugin_element import PluginElement
from rtron.sources.models.common.schema import ANY_TYPE, Declare, Model
from rtron.sources.models.common.values import Hole, Value, has_hole, hole, truth
from rtron.sources.models.qos import qos_of
from rtron.sources.models.ros2.site import ros2_site
from rtron.vocabulary import Durability, Evidence, Resolution, Unresolved

MAX_DEPTH = 8
MAX_ITEMS = 1000
MAX_DECLARATIONS = 10_000

_UNKNOWN = (UnresolvableError, ValueError)
_KEPT = ("node", "args", *PluginElement(filename="").variables())


def interface(
    model: Model,
    site: NodeSite,
    variables: Mapping[str, Value] | None = None,
    models: Models | None = None,
) -> NodeInterface:
    """Return what a node of this model declares where it runs.

    Names are absolute and not remapped; only what a library derives from a name that it has
    resolved itself (`IMAGE/compressed`) follows `site.remaps`.
    """
    site = ros2_site(model.name, site) if site.ros > 1 else site
    standard = {"node": site.name, "args": list(site.args)}
    scope = scope_at(site).having({**standard, **(variables or {})})
    return _interface_in(model, scope, models or load_models())


def plugin_interface(
    model: Model, site: NodeSite, plugin: PluginElement, models: Models | None = None
) -> NodeInterface:
    """Return what a Gazebo plugin adds to the node `site`, usually `/gazebo`."""
    return interface(model, site, plugin.variables(), models)


def handle_interface(
    model: Model, site: NodeSite, *, namespace: str, private: str, models: Models | None = None
) -> NodeInterface:
    """Return what a plugin adds to the node `site` through its two handles, as controllers do."""
    scope = Scope(site=site, namespace=namespace, private=private, variables={"node": site.name})
    return _interface_in(model, scope, models or load_models())


def _interface_in(model: Model, scope: Scope, models: Models) -> NodeInterface:
    walk = _Walk(models)
    found = islice(walk.model(model, scope, _Use()), MAX_DECLARATIONS)
    declarations = _merged(found)  # takes the walk, which meets the nodes
    return NodeInterface(
        nodes=tuple(MadeNode(name=name, remaps=scope.site.remaps) for name in walk.nodes),
        declarations=declarations,
        unresolved=tuple(dict.fromkeys(walk.unresolved)),
    )


def _merged(declarations: Iterable[Declaration]) -> tuple[Declaration, ...]:
    """Return each name once, with the evidence of all who declare it."""
    by_name: dict[tuple[DeclarationKind, str, str, str], Declaration] = {}
    for declaration in declarations:
        key = (declaration.kind, declaration.name, declaration.type, declaration.node)
        first = by_name.get(key, declaration)
        evidence = tuple(dict.fromkeys((*first.evidence, *declaration.evidence)))
        by_name[key] = replace(first, evidence=evidence)
    return tuple(by_name.values())


@dataclass(frozen=True, slots=True, kw_only=True)
class _Use:
    """How a model came to be used: how deep, implicitly, under an unknown condition."""

    model: Model | None = None
    depth: int = 0
    implicit: bool = False
    uncertain: bool = False


@dataclass(slots=True)
class _Walk:
    models: Models
    unresolved: list[Unresolved] = field(default_factory=list)
    nodes: dict[str, None] = field(default_factory=dict)

    def model(self, model: Model, scope: Scope, use: _Use) -> Iterator[Declaration]:
        use = replace(use, model=model, implicit=use.implicit or model.implicit)
        self._meet(scope)
        for name, text in model.let.items():
            scope = scope.having({name: self._variable(name, text, scope, model)})
        yield from self._entries(model.declares, scope, use)

    def _meet(self, scope: Scope) -> None:
        if scope.is_ros2:
            self.nodes[scope.private] = None

    def _variable(self, name: str, text: str, scope: Scope, model: Model) -> Value:
        try:
            return Expressions(scope).value(text)
        except _UNKNOWN as error:
            self._unresolved(name, str(error), _evidence(model))
            return hole(name)

    def _entries(
        self, entries: Sequence[Declare], scope: Scope, use: _Use
    ) -> Iterator[Declaration]:
        for entry in entries:
            yield from self._entry(entry, scope, use)

    def _entry(self, entry: Declare, scope: Scope, use: _Use) -> Iterator[Declaration]:
        try:
            for inner in self._repeated(entry, scope):
                yield from self._conditional(entry, inner, use)
        except _UNKNOWN as error:
            what = entry.name or entry.uses or entry.condition or "an entry"
            self._unresolved(what, str(error), _evidence_of(entry, use))

    def _repeated(self, entry: Declare, scope: Scope) -> Iterator[Scope]:
        if entry.loop is None:
            yield from self._letting(entry, scope)
            return
        variable, _, text = entry.loop.partition(" in ")
        items = Expressions(scope).value(text)
        for item in [items] if isinstance(items, Hole) else islice(items, MAX_ITEMS):
            yield from self._letting(entry, scope.having({variable: item}))

    def _letting(self, entry: Declare, scope: Scope) -> Iterator[Scope]:
        for name, text in entry.let.items():
            scope = scope.having({name: Expressions(scope).value(text)})
        yield scope

    def _conditional(self, entry: Declare, scope: Scope, use: _Use) -> Iterator[Declaration]:
        if entry.condition is not None:
            expressions = Expressions(scope)
            holds = _holds(expressions, entry.condition)
            if expressions.met_hole:
                use = replace(use, uncertain=True)
                self._unresolved(entry.condition, "not known", _evidence_of(entry, use))
            elif not holds:
                return
        placed = _placed(entry, scope)
        self._meet(placed)
        yield from self._declared(entry, placed, use)

    def _declared(self, entry: Declare, scope: Scope, use: _Use) -> Iterator[Declaration]:
        if entry.kind is not None:
            yield _declaration(entry, entry.kind, scope, use)
        elif entry.uses is not None:
            yield from self._used(entry, entry.uses, scope, use)
        elif entry.unresolved is not None:
            expressions = Expressions(scope)
            what, why = expressions.text(entry.unresolved), expressions.text(entry.why)
            self._unresolved(what, why, _evidence_of(entry, use))
        else:
            yield from self._entries(entry.declares or (), scope, use)

    def _used(self, entry: Declare, written: str, scope: Scope, use: _Use) -> Iterator[Declaration]:
        expressions = Expressions(scope)
        name = expressions.text(written)
        model = self.models.named(name)
        if model is None or use.depth == MAX_DEPTH:
            why = "no model of it" if model is None else "models use each other too deep"
            self._unresolved(name, why, _evidence_of(entry, use))
            return
        inner = _used_scope(entry, scope, expressions)
        implicit = use.implicit or entry.implicit
        yield from self.model(model, inner, replace(use, depth=use.depth + 1, implicit=implicit))

    def _unresolved(self, what: str, why: str, evidence: tuple[Evidence, ...]) -> None:
        if len(self.unresolved) < MAX_ITEMS:
            self.unresolved.append(Unresolved(what=what, why=why, evidence=evidence))


def _holds(expressions: Expressions, condition: str) -> bool:
    try:
        return truth(expressions.value(condition))
    except _UNKNOWN:
        if expressions.met_hole:
            return True
        raise


def _placed(entry: Declare, scope: Scope) -> Scope:
    expressions = Expressions(scope)
    if entry.node is not None:
        scope = scope.at_node(expressions.name(entry.node))
    namespace = _handle(entry.namespace, scope.namespace, expressions)
    return replace(
        scope, namespace=namespace, private=_handle(entry.private, scope.private, expressions)
    )


def _handle(written: str | None, current: str, expressions: Expressions) -> str:
    return current if written is None else expressions.scope.remapped(expressions.text(written))


def _used_scope(entry: Declare, scope: Scope, expressions: Expressions) -> Scope:
    kept = {name: scope.variables[name] for name in _KEPT if name in scope.variables}
    given = {name: expressions.value(text) for name, text in entry.given.items()}
    return replace(scope, variables={**kept, **given})


def _declaration(entry: Declare, kind: DeclarationKind, scope: Scope, use: _Use) -> Declaration:
    expressions = Expressions(scope)
    name = scope.resolve(expressions.name(entry.name))
    symbolic = use.uncertain or has_hole(name)
    qos = qos_of(expressions.text(entry.qos))
    keeps = qos is not None and qos.durability is Durability.TRANSIENT_LOCAL
    return Declaration(
        kind=kind,
        name=name,
        type="" if entry.type == ANY_TYPE else expressions.text(entry.type),
        implicit=entry.implicit or use.implicit,
        latched=entry.latched or (keeps and kind is DeclarationKind.PUBLISH),
        node=scope.private if scope.is_ros2 else "",
        qos=qos,
        resolution=Resolution.SYMBOLIC if symbolic else Resolution.MODEL,
        evidence=_evidence_of(entry, use),
    )


def _evidence_of(entry: Declare, use: _Use) -> tuple[Evidence, ...]:
    return _evidence(use.model, entry.at, entry.line) if use.model else ()


def _evidence(model: Model, at: str = "", line: int = 0) -> tuple[Evidence, ...]:
    repository, _, path = model.source.partition(" ")
    place, _, number = at.partition(":")
    file = f"{repository} {place or path}".strip()
    return (Evidence(file=file, line=int(number or line or 0)),)
