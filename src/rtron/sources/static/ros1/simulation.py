"""What runs inside Gazebo: the plugins of its world and of spawned robots, and controllers.

ROS wiki: gazebo_ros_pkgs, ros_control; Gazebo's tutorials: ros_gzplugins, ros_roslaunch.
"""

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field, replace
from pathlib import Path

from rtron.errors import InputError
from rtron.sources.declaration import DeclarationKind
from rtron.sources.gazebo import GazeboPlugin, read_plugins, read_world
from rtron.sources.models import ModelCatalog, controller_interface, plugin_interface
from rtron.sources.models.common.arguments import option, user_arguments
from rtron.sources.models.common.plugin_element import plugin_element
from rtron.sources.models.common.schema import NodeRole
from rtron.sources.models.ros1.controllers import add_controller_files
from rtron.sources.static.common.app_node import AppNode
from rtron.sources.static.common.node_part import NodePart
from rtron.sources.static.common.unresolved import UnresolvedList
from rtron.sources.workspace import Workspace
from rtron.sources.workspace.package_files import is_regular
from rtron.sources.xacro import RobotDescriptions, parse_element, read_element
from rtron.vocabulary import Evidence, Parameter, UnresolvedCause, UnresolvedItem
from rtron.vocabulary.launch import canonical_name, resolve_name

_WORLDS = (".world", ".sdf")
_DESCRIPTION = "robot_description"
_LOAD_SERVICE = "controller_manager/load_controller"


@dataclass(slots=True, kw_only=True)
class Simulation:
    """Adds to the nodes of an app what Gazebo loads into its server."""

    workspace: Workspace
    models: ModelCatalog
    descriptions: RobotDescriptions
    _unresolved: UnresolvedList = field(default_factory=UnresolvedList)

    def parts(self, parts: Iterable[NodePart]) -> Iterator[NodePart]:
        """Yield a part for each plugin and each controller, attributed to the node it runs in."""
        parts = tuple(parts)
        servers = [part for part in parts if _role(part) is NodeRole.GAZEBO]
        plugins = [p for server in servers[:1] for p in self._plugins(server, parts)]
        yield from plugins
        for spawner in (part for part in parts if _role(part) is NodeRole.CONTROLLER_SPAWNER):
            host = _controller_manager_part(spawner.node, (*parts, *plugins)) or next(
                iter(servers), None
            )
            if host is None:
                what = f"controllers that {spawner.node.name} spawns"
                why = "no node is known to host their controller manager"
                self._unresolved.add(what, why, spawner.node.evidence)
                continue
            site = add_controller_files(spawner.node.site)
            interface = controller_interface(site, site.parameters, models=self.models)
            yield replace(host, node=host.node, model=None, task=None, interface=interface)

    def unresolved(self) -> tuple[UnresolvedItem, ...]:
        """Return what could not be read of worlds and descriptions so far."""
        return tuple(self._unresolved.entries)

    def _plugins(self, server: NodePart, parts: tuple[NodePart, ...]) -> Iterator[NodePart]:
        for plugin in self._world_plugins(server.node):
            yield self._part(server, plugin, "")
        spawners = [part.node for part in parts if _role(part) is NodeRole.MODEL_SPAWNER]
        spawned = [self._spawned_plugins(node) for node in spawners] or [
            self._described_plugins(server.node)
        ]
        for namespace, plugin in (pair for pairs in spawned for pair in pairs):
            yield self._part(server, plugin, namespace)

    def _part(self, server: NodePart, plugin: GazeboPlugin, namespace: str) -> NodePart:
        part = replace(server, model=None, task=None)
        model = self.models.gazebo_plugin(plugin.filename)
        if model is None:
            part = replace(part, node=replace(server.node, evidence=plugin.evidence))
            what, cause = f"Gazebo plugin {plugin.filename}", UnresolvedCause.MISSING_CODE
            return part.with_missing_note(what, "no model of it", cause)
        element = plugin_element(plugin, namespace)
        interface = plugin_interface(model, server.node.site, element, self.models)
        return replace(part, interface=interface.with_location(plugin.evidence))

    def _world_plugins(self, server: AppNode) -> tuple[GazeboPlugin, ...]:
        for word in user_arguments(server.site.args):
            if not word.endswith(_WORLDS) or word.startswith("-"):
                continue
            try:
                world = read_world(
                    self._world_file(word), self.workspace.packages, self.descriptions.environ
                )
            except InputError as error:
                self._unresolved.add(f"world {word}", str(error), server.evidence)
                return ()
            self._unresolved.entries.extend(world.unresolved)
            return world.plugins
        return ()

    def _world_file(self, path_text: str) -> Path:
        folders = self.descriptions.environ.get("GAZEBO_RESOURCE_PATH", "").split(":")
        candidates = (Path(folder, path_text) for folder in ("/", *filter(None, folders)))
        path = next(filter(is_regular, candidates), None)
        if path is None:
            raise InputError("is not found", help="add its folder to GAZEBO_RESOURCE_PATH")
        return path

    def _spawned_plugins(self, spawner: AppNode) -> list[tuple[str, GazeboPlugin]]:
        args = spawner.site.args
        namespace = option(args, "-robot_namespace") or spawner.name.rpartition("/")[0] or "/"
        name = option(args, "-param")
        if name is None:
            plugins = self._file_plugins(option(args, "-file -f"), spawner)
        else:
            full = resolve_name(name, spawner.name)
            full = dict(spawner.site.remaps).get(full, full)
            parameter = spawner.site.parameters.get(full)
            plugins = self._parameter_plugins(full, parameter, spawner.evidence)
        model = option(args, "-model") or ""
        return [(namespace, p if p.model else replace(p, model=model)) for p in plugins]

    def _described_plugins(self, server: AppNode) -> list[tuple[str, GazeboPlugin]]:
        """Return the plugins of every robot description; who spawns them is not in the launch."""
        return [
            (name.rpartition("/")[0] or "/", plugin)
            for name, parameter in server.site.parameters.leaves.items()
            if name.rpartition("/")[2] == _DESCRIPTION
            for plugin in self._parameter_plugins(name, parameter, server.evidence)
        ]

    def _parameter_plugins(
        self, name: str, parameter: Parameter | None, location: Evidence
    ) -> tuple[GazeboPlugin, ...]:
        if parameter is None or not isinstance(parameter.value, str):
            unknown = getattr(parameter and parameter.value, "why", "the parameter is not set")
            self._unresolved.add(f"description {name}", str(unknown), location)
            return ()
        known = self.descriptions.result_of_text(parameter.value)
        if known is not None:
            return read_plugins(known.root)
        try:
            root = parse_element(parameter.value, parameter.evidence.file)
        except InputError as error:
            self._unresolved.add(f"description {name}", str(error), parameter.evidence)
            return ()
        return tuple(replace(plugin, evidence=parameter.evidence) for plugin in read_plugins(root))

    def _file_plugins(self, path: str | None, spawner: AppNode) -> tuple[GazeboPlugin, ...]:
        what = f"model of {spawner.name}"
        if path is None or not is_regular(Path(path)):
            why = "its description is not known before the app runs"
            self._unresolved.add(what, why, spawner.evidence, cause=UnresolvedCause.RUN_TIME)
            return ()
        try:
            return read_plugins(read_element(Path(path)))
        except InputError as error:
            self._unresolved.add(what, str(error), spawner.evidence)
            return ()


def _role(part: NodePart) -> NodeRole | None:
    return part.model.role if part.model else None


def _controller_manager_part(spawner: AppNode, parts: Iterable[NodePart]) -> NodePart | None:
    """Return the part whose node has the controller manager that a spawner calls."""
    namespace = option(spawner.site.args, "--namespace -n") or spawner.name.rpartition("/")[0]
    service_name = canonical_name(f"/{namespace}/{_LOAD_SERVICE}")
    for part in parts:
        for declared in part.interface.declarations:
            if declared.kind is DeclarationKind.SERVICE and declared.name == service_name:
                return part
    return None
