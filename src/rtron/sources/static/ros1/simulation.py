"""What runs inside Gazebo: the plugins of its world and of spawned robots, and controllers.

ROS wiki: gazebo_ros_pkgs, ros_control; Gazebo's tutorials: ros_gzplugins, ros_roslaunch.
"""

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field, replace
from pathlib import Path

from rtron.errors import InputError
from rtron.sources.declaration import DeclarationKind, NodeInterface
from rtron.sources.gazebo import GazeboPlugin, plugins_of, read_world
from rtron.sources.models import Models, PluginElement, plugin_interface
from rtron.sources.models.common.arguments import option, own_arguments
from rtron.sources.models.common.schema import NodeRole
from rtron.sources.models.ros1 import controllers
from rtron.sources.static.common.app_node import AppNode
from rtron.sources.static.common.node_part import Part
from rtron.sources.static.common.unresolved import Notes
from rtron.sources.static.controller_files import with_controller_files
from rtron.sources.workspace import Workspace
from rtron.sources.workspace.package_files import is_regular
from rtron.sources.xacro import RobotDescriptions, parse_element, read_element
from rtron.vocabulary import Evidence, Parameter, Unresolved
from rtron.vocabulary.launch import canonical_name, resolve_name

_WORLDS = (".world", ".sdf")
_DESCRIPTION = "robot_description"
_LOAD = "controller_manager/load_controller"


@dataclass(slots=True, kw_only=True)
class Simulation:
    """Adds to the nodes of an app what Gazebo loads into its server."""

    workspace: Workspace
    models: Models
    descriptions: RobotDescriptions
    _notes: Notes = field(default_factory=Notes)

    def parts(self, parts: Iterable[Part]) -> Iterator[Part]:
        """Yield a part for each plugin and each controller, attributed to the node it runs in."""
        parts = tuple(parts)
        servers = [part for part in parts if _role(part) is NodeRole.GAZEBO]
        plugins = [p for server in servers[:1] for p in self._plugins(server, parts)]
        yield from plugins
        for spawner in (part for part in parts if _role(part) is NodeRole.CONTROLLER_SPAWNER):
            host = _host(spawner.node, (*parts, *plugins)) or next(iter(servers), None)
            if host is None:
                what = f"controllers that {spawner.node.name} spawns"
                why = "no node is known to host their controller manager"
                self._notes.add(what, why, spawner.node.evidence)
                continue
            site = with_controller_files(spawner.node.site)
            interface = controllers(site, site.parameters, models=self.models)
            yield replace(host, node=host.node, model=None, task=None, interface=interface)

    def unresolved(self) -> tuple[Unresolved, ...]:
        """Return what could not be read of worlds and descriptions so far."""
        return tuple(self._notes.unresolved)

    def _plugins(self, server: Part, parts: tuple[Part, ...]) -> Iterator[Part]:
        for plugin in self._world(server.node):
            yield self._part(server, plugin, "")
        spawners = [part.node for part in parts if _role(part) is NodeRole.MODEL_SPAWNER]
        found = [self._spawned(node) for node in spawners] or [self._described(server.node)]
        for namespace, plugin in (pair for pairs in found for pair in pairs):
            yield self._part(server, plugin, namespace)

    def _part(self, server: Part, plugin: GazeboPlugin, namespace: str) -> Part:
        part = replace(server, model=None, task=None)
        model = self.models.gazebo_plugin(plugin.filename)
        if model is None:
            part = replace(part, node=replace(server.node, evidence=plugin.evidence))
            return part.missing(f"Gazebo plugin {plugin.filename}", "no model of it")
        element = plugin_element(plugin, namespace)
        interface = plugin_interface(model, server.node.site, element, self.models)
        return replace(part, interface=placed(interface, plugin.evidence))

    def _world(self, server: AppNode) -> tuple[GazeboPlugin, ...]:
        for word in own_arguments(server.site.args):
            if not word.endswith(_WORLDS) or word.startswith("-"):
                continue
            try:
                world = read_world(
                    self._world_file(word), self.workspace.packages, self.descriptions.environ
                )
            except InputError as error:
                self._notes.add(f"world {word}", str(error), server.evidence)
                return ()
            self._notes.unresolved.extend(world.unresolved)
            return world.plugins
        return ()

    def _world_file(self, spelled: str) -> Path:
        listed = self.descriptions.environ.get("GAZEBO_RESOURCE_PATH", "").split(":")
        candidates = (Path(folder, spelled) for folder in ("/", *filter(None, listed)))
        found = next(filter(is_regular, candidates), None)
        if found is None:
            raise InputError("is not found", help="add its folder to GAZEBO_RESOURCE_PATH")
        return found

    def _spawned(self, spawner: AppNode) -> list[tuple[str, GazeboPlugin]]:
        args = spawner.site.args
        below = option(args, "-robot_namespace") or spawner.name.rpartition("/")[0] or "/"
        name = option(args, "-param")
        if name is None:
            plugins = self._of_file(option(args, "-file -f"), spawner)
        else:
            full = resolve_name(name, spawner.name)
            full = dict(spawner.site.remaps).get(full, full)
            found = spawner.site.parameters.get(full)
            plugins = self._of_parameter(full, found, spawner.evidence)
        model = option(args, "-model") or ""
        return [(below, p if p.model else replace(p, model=model)) for p in plugins]

    def _described(self, server: AppNode) -> list[tuple[str, GazeboPlugin]]:
        """Return the plugins of every robot description; who spawns them is not in the launch."""
        return [
            (name.rpartition("/")[0] or "/", plugin)
            for name, parameter in server.site.parameters.leaves.items()
            if name.rpartition("/")[2] == _DESCRIPTION
            for plugin in self._of_parameter(name, parameter, server.evidence)
        ]

    def _of_parameter(
        self, name: str, parameter: Parameter | None, place: Evidence
    ) -> tuple[GazeboPlugin, ...]:
        if parameter is None or not isinstance(parameter.value, str):
            unknown = getattr(parameter and parameter.value, "why", "the parameter is not set")
            self._notes.add(f"description {name}", str(unknown), place)
            return ()
        known = self.descriptions.of_text(parameter.value)
        if known is not None:
            return plugins_of(known.root)
        try:
            root = parse_element(parameter.value, parameter.evidence.file)
        except InputError as error:
            self._notes.add(f"description {name}", str(error), parameter.evidence)
            return ()
        return tuple(replace(plugin, evidence=parameter.evidence) for plugin in plugins_of(root))

    def _of_file(self, path: str | None, spawner: AppNode) -> tuple[GazeboPlugin, ...]:
        what = f"model of {spawner.name}"
        if path is None or not is_regular(Path(path)):
            why = "its description is not known before the app runs"
            self._notes.add(what, why, spawner.evidence)
            return ()
        try:
            return plugins_of(read_element(Path(path)))
        except InputError as error:
            self._notes.add(what, str(error), spawner.evidence)
            return ()


def _role(part: Part) -> NodeRole | None:
    return part.model.role if part.model else None


def plugin_element(plugin: GazeboPlugin, namespace: str) -> PluginElement:
    """Return a plugin as its model sees it, with the namespace that its spawner gives."""
    sensor = plugin.sensor
    return PluginElement(
        filename=plugin.filename,
        name=plugin.name,
        values=plugin.values,
        sensor_name=sensor.name if sensor else "",
        sensor_type=sensor.type if sensor else "",
        cameras=sensor.cameras if sensor else (),
        link_name=plugin.link,
        model_name=plugin.model,
        robot_namespace=namespace,
    )


def placed(interface: NodeInterface, place: Evidence) -> NodeInterface:
    """Return what a plugin declares, with the place of its element before the model's."""
    declarations = (replace(d, evidence=(place, *d.evidence)) for d in interface.declarations)
    return replace(interface, declarations=tuple(declarations))


def _host(spawner: AppNode, parts: Iterable[Part]) -> Part | None:
    """Return the part whose node has the controller manager that a spawner calls."""
    below = option(spawner.site.args, "--namespace -n") or spawner.name.rpartition("/")[0]
    wanted = canonical_name(f"/{below}/{_LOAD}")
    for part in parts:
        for declared in part.interface.declarations:
            if declared.kind is DeclarationKind.SERVICE and declared.name == wanted:
                return part
    return None
