"""Controllers of ros2_control: nodes that a controller manager makes when a spawner asks for them.

control.ros.org: controller_manager. Remaps of the manager's process count, as they did up to Iron;
later ones come with the spawner's `--controller-ros-args`.
"""

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace
from itertools import pairwise

from rtron.errors import InputError
from rtron.sources.code.workspace_sources import WorkspaceFiles
from rtron.sources.declaration import NodeInterface, NodeSite
from rtron.sources.models import Models, interface
from rtron.sources.models.common.arguments import option, positional
from rtron.sources.models.common.schema import NodeRole
from rtron.sources.static.common.app_node import AppNode
from rtron.sources.static.common.node_part import Part
from rtron.sources.static.common.task import Task, TaskKind
from rtron.sources.static.ros1.simulation import placed
from rtron.sources.static.ros2.parameter_values import given_value, settings_of
from rtron.sources.workspace.plugin_description import PluginClass
from rtron.vocabulary import Unresolved
from rtron.vocabulary.remap_rules import Rule, expanded, rules_in

_EXPORTED = "controller_interface"
_MANAGER, _TYPE = "-c --controller-manager", "-t --controller-type"
_FILES, _ARGUMENTS = ("-p", "--param-file"), ("--controller-ros-args",)
_VALUED = (
    f"{_MANAGER} {_TYPE} -n --namespace -p --param-file --controller-ros-args "
    "--controller-manager-timeout --switch-timeout --service-call-timeout"
)


@dataclass(frozen=True, slots=True)
class ControllerNodes:
    """Finds what the spawners among an app's parts load."""

    models: Models
    files: WorkspaceFiles

    def parts(self, parts: Iterable[Part]) -> Iterator[Part]:
        """Yield a part for each controller."""
        parts = tuple(parts)
        hosts = {
            part.interface.nodes[0].name: part.node
            for part in parts
            if self._role(part) is NodeRole.CONTROLLER_MANAGER and part.interface.nodes
        }
        for spawner in (p for p in parts if self._role(p) is NodeRole.CONTROLLER_SPAWNER):
            args = spawner.node.site.args
            manager = option(args, _MANAGER) or "controller_manager"
            manager = expanded(manager, spawner.node.name)
            for name in positional(args, _VALUED):
                yield self._part(name, manager, spawner, hosts.get(manager))

    def _role(self, part: Part) -> NodeRole | None:
        model = self.models.node(part.node.package, part.node.type)
        return model.role if model else None

    def _part(self, name: str, manager: str, spawner: Part, host: AppNode | None) -> Part:
        try:
            site = self._site(name, manager, spawner.node, host)
        except InputError as error:
            return _missing(spawner, name, str(error))
        args = spawner.node.site.args
        given = option(args, _TYPE) or given_value(site, manager, f"{name}.type")
        if not isinstance(given, str):
            return _missing(spawner, site.name, _why(given, manager, host))
        rules = (*_rules(args), *(host.rules if host else ()))
        node = replace(spawner.node, site=site, type=given, rules=rules)
        node = replace(node, package=given.partition("/")[0])
        task, model = self._task(given, site), self.models.controller(given)
        if task is not None:
            return Part(node=node, owner=site.name, task=task)
        if model is None:
            return _missing(spawner, site.name, _why(given, manager, host))
        found = interface(model, replace(site, remaps=rules), models=self.models)
        found = placed(found, node.evidence)
        return Part(node=node, owner=site.name, model=model, interface=found)

    def _task(self, type: str, site: NodeSite) -> Task | None:
        """Return the task of a controller whose source is in the workspace."""
        found = self.files.workspace.plugin(type, _EXPORTED)
        if found is None or found.program is None or not found.program.sources:
            return None
        return Task(
            kind=TaskKind.COMPONENT,
            sources=found.program.sources,
            cls=found.declared.type,
            definitions=found.program.definitions,
            beside=tuple(c.type for c in self._all() if c.type != found.declared.type),
            site=site,
        )

    def _all(self) -> tuple[PluginClass, ...]:
        return self.files.workspace.plugins(_EXPORTED)

    def _site(self, name: str, manager: str, spawner: AppNode, host: AppNode | None) -> NodeSite:
        settings = host.site.settings if host else ()
        files = _after(spawner.site.args, _FILES)
        return NodeSite(
            name=expanded(name, manager),
            ros=2,
            environ=spawner.site.environ,
            settings=(*settings, *(one for path in files for one in settings_of(path, self.files))),
        )


def _after(args: Iterable[str], options: Iterable[str]) -> list[str]:
    """Return the words behind every one of some options."""
    return [word for before, word in pairwise(args) if before in options]


def _rules(args: Iterable[str]) -> Iterator[Rule]:
    for text in _after(args, _ARGUMENTS):
        yield from rules_in(text, ros=True)


def _missing(spawner: Part, name: str, why: str) -> Part:
    """Return the spawner with a note of a controller instead of all that it declares."""
    note = Unresolved(what=f"controller {name}", why=why, evidence=(spawner.node.evidence,))
    nodes = spawner.interface.nodes
    return replace(spawner, interface=NodeInterface(nodes=nodes, unresolved=(note,)))


def _why(type: object, manager: str, host: AppNode | None) -> str:
    if isinstance(type, str):
        return f"no model of {type[:80]}"
    here = "" if host else f", and nothing here starts {manager}"
    return f"its parameter type is not known{here}"
