"""Controllers of ros2_control: nodes that a controller manager makes when a spawner asks for them.

control.ros.org: controller_manager. Remaps of the manager's process count, as they did up to Iron;
later ones come with the spawner's `--controller-ros-args`.
"""

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import NamedTuple

from rtron.errors import InputError
from rtron.sources.code.workspace_sources import WorkspaceSources
from rtron.sources.declaration import CreatedNode, NodeInterface, NodeSite
from rtron.sources.models import ModelCatalog, node_interface
from rtron.sources.models.common.arguments import option, positional
from rtron.sources.models.common.schema import NodeRole
from rtron.sources.static.common.app_node import AppNode
from rtron.sources.static.common.frames import node_name
from rtron.sources.static.common.node_part import NodePart
from rtron.sources.static.common.task import InterpretationTask, TaskKind
from rtron.sources.static.ros2.endpoints import parameter_file_settings, parameter_value
from rtron.sources.workspace.plugin_description import PluginClass
from rtron.vocabulary import UnresolvedItem, WiringFact, WiringFactKind
from rtron.vocabulary.remap_rules import RemapRule, expand_name, parse_remap_rules

_PLUGIN_BASE = "controller_interface"
_MANAGER, _TYPE = "-c --controller-manager", "-t --controller-type"
_ITS_TYPE = ".type"
_FILES, _ARGUMENTS = ("-p", "--param-file"), ("--controller-ros-args",)
_VALUED = (
    f"{_MANAGER} {_TYPE} -n --namespace -p --param-file --controller-ros-args "
    "--controller-manager-timeout --switch-timeout --service-call-timeout"
)


class _ControllerRequest(NamedTuple):
    """A controller that a spawner asks its manager for; the manager's node, if it is known."""

    name: str
    manager: str
    spawner: NodePart
    manager_node: AppNode | None


@dataclass(frozen=True, slots=True)
class ControllerParts:
    """Finds what the spawners among an app's parts load."""

    models: ModelCatalog
    files: WorkspaceSources

    def parts(self, parts: Iterable[NodePart]) -> Iterator[NodePart]:
        """Yield a part for each controller."""
        for each in self._requests(tuple(parts)):
            yield self._part(each)

    def untyped(self, parts: Iterable[NodePart]) -> Iterator[WiringFact]:
        """Yield a fact for each controller that has no type, while its manager knows others'."""
        requests = list(self._requests(tuple(parts)))
        requested = {each.name for each in requests}
        for each in requests:
            names = self._typed_names(each)
            if names and each.name not in names and "{" not in each.name:
                yield WiringFact(
                    kind=WiringFactKind.UNTYPED_CONTROLLER,
                    subject=expand_name(each.name, each.manager),
                    value=node_name(each.spawner),
                    others=tuple(sorted(names - requested)),
                    evidence=(each.spawner.node.evidence,),
                )

    def _typed_names(self, request: _ControllerRequest) -> set[str]:
        """Return the controllers whose types the manager knows; none if it may know others."""
        manager_node = request.manager_node
        if manager_node is None or option(request.spawner.node.site.args, _TYPE):
            return set()
        try:
            site = self._site(request)
        except InputError:
            return set()
        types = {each.name for each in site.settings if each.name.endswith(_ITS_TYPE)}
        is_known = manager_node.site.parameters_complete
        is_known &= parameter_value(site, site.name, _ITS_TYPE[1:]) is None
        return {name.removesuffix(_ITS_TYPE) for name in types} if is_known else set()

    def _requests(self, parts: tuple[NodePart, ...]) -> Iterator[_ControllerRequest]:
        """Yield what spawners ask for."""
        manager_nodes = {
            part.interface.nodes[0].name: part.node
            for part in parts
            if self._role(part) is NodeRole.CONTROLLER_MANAGER and part.interface.nodes
        }
        for spawner in (p for p in parts if self._role(p) is NodeRole.CONTROLLER_SPAWNER):
            args = spawner.node.site.args
            manager = option(args, _MANAGER) or "controller_manager"
            manager = expand_name(manager, spawner.node.name)
            for name in positional(args, _VALUED):
                yield _ControllerRequest(name, manager, spawner, manager_nodes.get(manager))

    def _role(self, part: NodePart) -> NodeRole | None:
        model = self.models.node(part.node.package, part.node.type)
        return model.role if model else None

    def _part(self, request: _ControllerRequest) -> NodePart:
        name, manager, spawner, manager_node = request
        try:
            site = self._site(request)
        except InputError as error:
            return spawner.with_missing_note(f"controller {name}", str(error))
        args = spawner.node.site.args
        controller_type = option(args, _TYPE) or parameter_value(site, manager, f"{name}.type")
        if not isinstance(controller_type, str):
            why = _missing_reason(manager, manager_node)
            return spawner.with_missing_note(f"controller {site.name}", why)
        rules = (*_rules(args), *(manager_node.process_remap_rules if manager_node else ()))
        node = replace(spawner.node, site=site, type=controller_type, process_remap_rules=rules)
        node = replace(node, package=controller_type.partition("/")[0])
        task, model = self._task(controller_type, site), self.models.controller(controller_type)
        if task is not None:
            return NodePart(node=node, owner=site.name, task=task)
        if model is None:
            return _unread_controller(node)
        model_interface = node_interface(model, replace(site, remaps=rules), models=self.models)
        model_interface = model_interface.with_location(node.evidence)
        return NodePart(node=node, owner=site.name, model=model, interface=model_interface)

    def _task(self, type: str, site: NodeSite) -> InterpretationTask | None:
        """Return the task of a controller whose source is in the workspace."""
        plugin = self.files.workspace.plugin(type, _PLUGIN_BASE)
        if plugin is None or plugin.program is None or not plugin.program.sources:
            return None
        return InterpretationTask(
            kind=TaskKind.COMPONENT,
            sources=plugin.program.sources,
            class_name=plugin.plugin_class.type,
            definitions=plugin.program.definitions,
            other_components=tuple(
                c.type for c in self._controller_plugins() if c.type != plugin.plugin_class.type
            ),
            site=site,
        )

    def _controller_plugins(self) -> tuple[PluginClass, ...]:
        return self.files.workspace.plugins(_PLUGIN_BASE)

    def _site(self, request: _ControllerRequest) -> NodeSite:
        manager = request.manager_node.site if request.manager_node else None
        spawner = request.spawner.node.site
        files = _option_values(spawner.args, _FILES)
        return NodeSite(
            name=expand_name(request.name, request.manager),
            ros=2,
            environ=spawner.environ,
            parameters_complete=manager is not None and manager.parameters_complete,
            settings=(
                *(manager.settings if manager else ()),
                *(
                    setting
                    for path in files
                    for setting in parameter_file_settings(path, self.files)
                ),
            ),
        )


def _option_values(args: Iterable[str], options: Iterable[str]) -> list[str]:
    """Return the words behind every one of some options."""
    return [word for option, word in pairwise(args) if option in options]


def _rules(args: Iterable[str]) -> Iterator[RemapRule]:
    for text in _option_values(args, _ARGUMENTS):
        yield from parse_remap_rules(text, in_ros_args=True)


def _unread_controller(node: AppNode) -> NodePart:
    """Return a controller of which nothing but its name and type is known: a node not read."""
    why = f"no model of {node.type[:80]}"
    note = UnresolvedItem(what=f"controller {node.name}", why=why, evidence=(node.evidence,))
    interface = NodeInterface(nodes=(CreatedNode(name=node.name),), unresolved=(note,))
    return NodePart(node=node, owner=node.name, interface=interface)


def _missing_reason(manager: str, manager_node: AppNode | None) -> str:
    hint = "" if manager_node else f", and nothing here starts {manager}"
    return f"its parameter type is not known{hint}"
