"""From a model and the place where its node runs to what the node declares."""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from itertools import islice

from rtron.sources.declaration import (
    CreatedNode,
    Declaration,
    DeclarationKind,
    FrameBroadcast,
    FrameUse,
    LoadedPlugin,
    NodeInterface,
    NodeSite,
    PluginId,
)
from rtron.sources.launch.common.errors import UnresolvableError
from rtron.sources.models.common.expressions import ModelExpressions
from rtron.sources.models.common.model_scope import ModelScope, node_scope
from rtron.sources.models.common.node_site import resolve_ros2_site
from rtron.sources.models.common.plugin_element import PluginElement
from rtron.sources.models.common.schema import ANY_TYPE, Model, ModelEntry, parse_qos
from rtron.sources.models.common.values import (
    Placeholder,
    Value,
    as_switch,
    has_placeholder,
    placeholder,
)
from rtron.sources.models.common.yaml_model import ModelCatalog, load_models
from rtron.vocabulary import Durability, Evidence, Resolution, UnresolvedCause, UnresolvedItem

MAX_DEPTH = 8
MAX_ITEMS = 1000
MAX_DECLARATIONS = 10_000

_EVALUATION_ERRORS = (UnresolvableError, ValueError)
_PLUGIN_KINDS = ("costmap_layer", "plugin")
_INHERITED_VARIABLES = ("node", "args", *PluginElement(filename="").variables())


def node_interface(
    model: Model,
    site: NodeSite,
    variables: Mapping[str, Value] | None = None,
    models: ModelCatalog | None = None,
) -> NodeInterface:
    """Return what a node of this model declares where it runs.

    Names are absolute and not remapped; only what a library derives from a name that it has
    resolved itself (`IMAGE/compressed`) follows `site.remaps`.
    """
    site = resolve_ros2_site(model.name, site) if site.ros > 1 else site
    standard = {"node": site.name, "args": list(site.args)}
    scope = node_scope(site).with_variables({**standard, **(variables or {})})
    return _evaluate_in(model, scope, models or load_models())


def plugin_interface(
    model: Model, site: NodeSite, plugin: PluginElement, models: ModelCatalog | None = None
) -> NodeInterface:
    """Return what a Gazebo plugin adds to the node `site`, usually `/gazebo`."""
    return node_interface(model, site, plugin.variables(), models)


def handle_plugin_interface(
    model: Model,
    site: NodeSite,
    *,
    namespace: str,
    private: str,
    models: ModelCatalog | None = None,
) -> NodeInterface:
    """Return what a plugin adds to the node `site` through its two handles, as controllers do."""
    scope = ModelScope(
        site=site, namespace=namespace, private=private, variables={"node": site.name}
    )
    return _evaluate_in(model, scope, models or load_models())


def _evaluate_in(model: Model, scope: ModelScope, models: ModelCatalog) -> NodeInterface:
    walk = _ModelWalk(models)
    walked = islice(walk.walk_model(model, scope, _UseContext()), MAX_DECLARATIONS)
    declarations = _merge(walked)  # takes the walk, which meets the nodes
    return NodeInterface(
        nodes=tuple(CreatedNode(name=name, remaps=scope.site.remaps) for name in walk.nodes),
        declarations=declarations,
        unresolved=tuple(dict.fromkeys(walk.unresolved)),
        frames=tuple(walk.frames),
        frame_uses=tuple(walk.frame_uses),
        plugin_ids=tuple(walk.plugin_ids),
        plugins=tuple(walk.plugins),
    )


def _merge(declarations: Iterable[Declaration]) -> tuple[Declaration, ...]:
    """Return each name once, with the evidence of all who declare it."""
    by_name: dict[tuple[DeclarationKind, str, str, str], Declaration] = {}
    for declaration in declarations:
        key = (declaration.kind, declaration.name, declaration.type, declaration.node)
        first = by_name.get(key, declaration)
        evidence = tuple(dict.fromkeys((*first.evidence, *declaration.evidence)))
        by_name[key] = replace(first, evidence=evidence)
    return tuple(by_name.values())


@dataclass(frozen=True, slots=True, kw_only=True)
class _UseContext:
    """How a model came to be used: how deep, implicitly, under an unknown condition.

    `users` are the places in other models that lead to it, outermost first.
    """

    model: Model | None = None
    users: tuple[Evidence, ...] = ()
    depth: int = 0
    implicit: bool = False
    uncertain: bool = False


@dataclass(slots=True)
class _ModelWalk:
    models: ModelCatalog
    unresolved: list[UnresolvedItem] = field(default_factory=list)
    nodes: dict[str, None] = field(default_factory=dict)
    frames: dict[FrameBroadcast, None] = field(default_factory=dict)
    frame_uses: dict[FrameUse, None] = field(default_factory=dict)
    plugin_ids: dict[PluginId, None] = field(default_factory=dict)
    plugins: dict[LoadedPlugin, None] = field(default_factory=dict)

    def walk_model(
        self, model: Model, scope: ModelScope, use: _UseContext
    ) -> Iterator[Declaration]:
        use = replace(use, model=model, implicit=use.implicit or model.implicit)
        self._add_node(scope)
        for name, text in model.let.items():
            scope = scope.with_variables({name: self._variable(name, text, scope, model)})
        yield from self._entries(model.declares, scope, use)

    def _add_node(self, scope: ModelScope) -> None:
        if scope.is_ros2:
            self.nodes[scope.private] = None

    def _variable(self, name: str, text: str, scope: ModelScope, model: Model) -> Value:
        try:
            return ModelExpressions(scope).value(text)
        except _EVALUATION_ERRORS as error:
            self._note_unresolved(name, str(error), _evidence(model))
            return placeholder(name)

    def _entries(
        self, entries: Sequence[ModelEntry], scope: ModelScope, use: _UseContext
    ) -> Iterator[Declaration]:
        for entry in entries:
            yield from self._entry(entry, scope, use)

    def _entry(
        self, entry: ModelEntry, scope: ModelScope, use: _UseContext
    ) -> Iterator[Declaration]:
        try:
            for inner in self._loop_scopes(entry, scope):
                yield from self._conditional(entry, inner, use)
        except _EVALUATION_ERRORS as error:
            words = (entry.name, entry.uses, entry.broadcast, entry.look_up, entry.condition)
            what = next(filter(None, words), "an entry")
            self._note_unresolved(what, str(error), _evidence_of(entry, use))

    def _loop_scopes(self, entry: ModelEntry, scope: ModelScope) -> Iterator[ModelScope]:
        if entry.loop is None:
            yield from self._with_variables(entry, scope)
            return
        variable, _, text = entry.loop.partition(" in ")
        items = ModelExpressions(scope).value(text)
        for item in [items] if isinstance(items, Placeholder) else islice(items, MAX_ITEMS):
            yield from self._with_variables(entry, scope.with_variables({variable: item}))

    def _with_variables(self, entry: ModelEntry, scope: ModelScope) -> Iterator[ModelScope]:
        for name, text in entry.let.items():
            scope = scope.with_variables({name: ModelExpressions(scope).value(text)})
        yield scope

    def _conditional(
        self, entry: ModelEntry, scope: ModelScope, use: _UseContext
    ) -> Iterator[Declaration]:
        if entry.condition is not None:
            expressions = ModelExpressions(scope)
            holds = _condition_holds(expressions, entry.condition)
            if expressions.has_unknown:
                use = replace(use, uncertain=True)
                if entry.kind or entry.uses or entry.unresolved or entry.declares:
                    self._note_unresolved(entry.condition, "not known", _evidence_of(entry, use))
            elif not holds:
                return
        entry_scope = _entry_scope(entry, scope)
        self._add_node(entry_scope)
        yield from self._entry_declarations(entry, entry_scope, use)

    def _entry_declarations(
        self, entry: ModelEntry, scope: ModelScope, use: _UseContext
    ) -> Iterator[Declaration]:
        if entry.kind is not None:
            yield _declaration(entry, entry.kind, scope, use)
        elif entry.uses is not None:
            yield from self._used_model(entry, entry.uses, scope, use)
        elif entry.broadcast is not None:
            self._add_frame(entry, entry.broadcast, scope, use)
        elif frame := entry.look_up or entry.stamp:
            self._add_frame_use(entry, frame, scope, use)
        elif id_template := entry.offer or entry.request:
            self._add_plugin_id(entry, id_template, scope, use)
        elif entry.unresolved is not None:
            expressions = ModelExpressions(scope)
            what, why = expressions.text(entry.unresolved), expressions.text(entry.why)
            self._note_unresolved(what, why, _evidence_of(entry, use))
        else:
            yield from self._entries(entry.declares or (), scope, use)

    def _add_frame(
        self, entry: ModelEntry, child: str, scope: ModelScope, use: _UseContext
    ) -> None:
        """Record a transform."""
        frame = FrameBroadcast(
            child=_known_text(child, scope) if len(self.frames) < MAX_ITEMS else "",
            parent=_known_text(entry.parent, scope),
            is_fixed=entry.fixed,
            is_certain=not use.uncertain,
            evidence=_evidence_of(entry, use),
        )
        self.frames[frame] = None

    def _add_frame_use(
        self, entry: ModelEntry, frame: str, scope: ModelScope, use: _UseContext
    ) -> None:
        """Record a frame that is certainly looked up, or written into messages."""
        known = "" if use.uncertain else _known_text(frame, scope)
        for place in _evidence_of(entry, use)[-1:] if known else ():
            found = FrameUse(frame=known, evidence=place, is_look_up=entry.look_up is not None)
            self.frame_uses[found] = None

    def _add_plugin_id(
        self, entry: ModelEntry, id_template: str, scope: ModelScope, use: _UseContext
    ) -> None:
        """Record the id of a plugin; one that is asked for counts if that is certain."""
        name = scope.resolve(ModelExpressions(scope).text(id_template))
        is_known = not (use.uncertain or has_placeholder(name))
        for place in _evidence_of(entry, use)[-1:] if entry.offer or is_known else ():
            found = PluginId(name=name, evidence=place, is_request=entry.request is not None)
            self.plugin_ids[found] = None

    def _used_model(
        self, entry: ModelEntry, name_template: str, scope: ModelScope, use: _UseContext
    ) -> Iterator[Declaration]:
        expressions = ModelExpressions(scope)
        name = expressions.text(name_template)
        model = self.models.find(name)
        if model is None or use.depth == MAX_DEPTH:
            why = "no model of it" if model is None else "models use each other too deep"
            why = f"{why}: what it gives {scope.site.name} is missing"
            self._note_unresolved(name, why, _evidence_of(entry, use), UnresolvedCause.MISSING_CODE)
            if model is None and not use.uncertain:
                self._add_plugin(name, _used_scope(entry, scope, expressions))
            return
        inner = _used_scope(entry, scope, expressions)
        implicit = use.implicit or entry.implicit
        users = _evidence_of(entry, use)
        yield from self.walk_model(
            model, inner, replace(use, depth=use.depth + 1, implicit=implicit, users=users)
        )

    def _add_plugin(self, name: str, scope: ModelScope) -> None:
        """Remember a plugin without a model, as the node calls it: its source may be here."""
        kind, _, class_name = name.partition(":")
        called = scope.variables.get("name") or scope.variables.get("layer")
        if not scope.is_ros2:
            called = scope.private.removeprefix(f"{scope.site.name}/")
        if kind in _PLUGIN_KINDS and isinstance(called, str) and not has_placeholder(name + called):
            loaded = LoadedPlugin(class_name=class_name, name=called, node=scope.private)
            self.plugins[loaded] = None

    def _note_unresolved(
        self,
        what: str,
        why: str,
        evidence: tuple[Evidence, ...],
        cause: UnresolvedCause | None = None,
    ) -> None:
        if len(self.unresolved) < MAX_ITEMS:
            note = UnresolvedItem(what=what, why=why, cause=cause, evidence=evidence)
            self.unresolved.append(note)


def _condition_holds(expressions: ModelExpressions, condition: str) -> bool:
    try:
        return as_switch(expressions.value(condition))
    except _EVALUATION_ERRORS:
        if expressions.has_unknown:
            return True
        raise


def _entry_scope(entry: ModelEntry, scope: ModelScope) -> ModelScope:
    expressions = ModelExpressions(scope)
    if entry.node is not None:
        scope = scope.at_node(expressions.name(entry.node))
    namespace = _handle_namespace(entry.namespace, scope.namespace, expressions)
    return replace(
        scope,
        namespace=namespace,
        private=_handle_namespace(entry.private, scope.private, expressions),
    )


def _handle_namespace(template: str | None, current: str, expressions: ModelExpressions) -> str:
    return current if template is None else expressions.scope.remapped(expressions.text(template))


def _used_scope(entry: ModelEntry, scope: ModelScope, expressions: ModelExpressions) -> ModelScope:
    inherited = {
        name: scope.variables[name] for name in _INHERITED_VARIABLES if name in scope.variables
    }
    passed = {name: expressions.value(text) for name, text in entry.passed.items()}
    return replace(scope, variables={**inherited, **passed})


def _declaration(
    entry: ModelEntry, kind: DeclarationKind, scope: ModelScope, use: _UseContext
) -> Declaration:
    expressions = ModelExpressions(scope)
    name = scope.resolve(expressions.name(entry.name))
    symbolic = use.uncertain or has_placeholder(name)
    qos = parse_qos(expressions.text(entry.qos))
    is_transient_local = qos is not None and qos.durability is Durability.TRANSIENT_LOCAL
    return Declaration(
        kind=kind,
        name=name,
        type="" if entry.type == ANY_TYPE else expressions.text(entry.type),
        implicit=entry.implicit or use.implicit,
        latched=entry.latched or (is_transient_local and kind is DeclarationKind.PUBLISH),
        node=scope.private if scope.is_ros2 else "",
        qos=qos,
        resolution=Resolution.SYMBOLIC if symbolic else Resolution.MODEL,
        evidence=_evidence_of(entry, use),
    )


def _known_text(template: str, scope: ModelScope) -> str:
    """Return a text as it is in a scope; empty if not all of it is known."""
    expressions = ModelExpressions(scope)
    text = expressions.text(template)
    return "" if expressions.has_unknown or has_placeholder(text) else text


def _evidence_of(entry: ModelEntry, use: _UseContext) -> tuple[Evidence, ...]:
    return (*use.users, *_evidence(use.model, entry.at, entry.line)) if use.model else ()


def _evidence(model: Model, location: str = "", line: int = 0) -> tuple[Evidence, ...]:
    repository, _, path = model.source.partition(" ")
    path_text, _, number = location.partition(":")
    file = f"{repository} {path_text or path}".strip()
    return (Evidence(file=file, line=int(number or line or 0)),)
