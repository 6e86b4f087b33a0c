"""What runs inside Gazebo: the plugins of the robots that a launch of ROS 2 spawns.

gazebo_ros (src/node.cpp): each plugin is a node of its own, called like it, with the namespace and
the remaps of its `<ros>`; a namespace that the spawner gives counts before it. Of the systems of
the new Gazebo only gz_ros2_control joins ROS 2; the others need a bridge.
"""

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, replace

from rtron.errors import InputError
from rtron.sources.code.workspace_sources import WorkspaceSources
from rtron.sources.declaration import NodeInterface, NodeSite, ParameterSetting
from rtron.sources.gazebo import GazeboPlugin, Sensor, read_plugins, read_sensors
from rtron.sources.models import ModelCatalog, plugin_interface
from rtron.sources.models.common.arguments import option
from rtron.sources.models.common.node_site import resolve_ros2_site
from rtron.sources.models.common.plugin_element import plugin_element
from rtron.sources.models.common.schema import Model, NodeRole
from rtron.sources.static.common.node_part import NodePart
from rtron.sources.static.ros2.endpoints import parameter_file_settings
from rtron.sources.static.ros2.gazebo_topics import plugin_topics, sensor_topics
from rtron.sources.static.ros2.spawned_model import SpawnedModel, find_spawned_model
from rtron.sources.xacro import parse_element
from rtron.vocabulary import UnresolvedCause
from rtron.vocabulary.launch import canonical_name
from rtron.vocabulary.remap_rules import RemapRule, parse_remap_rules

_SYSTEM_PREFIXES = ("gz-sim", "ignition-gazebo", "gz_", "ign_")
PACKAGE = "gazebo_ros"
USE_SIM_TIME = ParameterSetting(node="/**", name="use_sim_time", value=True)
"""gazebo_ros sets it for each of its nodes (include/gazebo_ros/node.hpp)."""
_MANAGER = "controller_manager"


@dataclass(frozen=True, slots=True)
class GazeboPluginNodes:
    """Finds what the spawners among an app's parts bring into Gazebo."""

    models: ModelCatalog
    files: WorkspaceSources

    def parts(self, parts: Iterable[NodePart]) -> Iterator[NodePart]:
        """Yield a part for each plugin."""
        parts = tuple(parts)
        for spawner in parts:
            model = self.models.node(spawner.node.package, spawner.node.type)
            if model is not None and model.role is NodeRole.MODEL_SPAWNER:
                site = resolve_ros2_site(model.name, spawner.node.site)
                resolved = replace(spawner, node=replace(spawner.node, site=site))
                yield from self._spawned_parts(resolved, parts)

    def _spawned_parts(self, spawner: NodePart, parts: tuple[NodePart, ...]) -> Iterator[NodePart]:
        try:
            spawned = find_spawned_model(spawner, parts, self.files)
            model, plugins, sensors = _parts(spawned) if spawned is not None else ("", (), ())
        except InputError as error:
            what = f"what {spawner.node.name} spawns"
            yield replace(spawner, model=None).with_missing_note(what, str(error))
            return
        given = option(spawner.node.site.args, "-name --name") or ""
        topics = (*plugin_topics(plugins, given, model), *sensor_topics(sensors, given, model))
        if topics:
            nodes = spawner.interface.nodes
            yield replace(spawner, interface=NodeInterface(nodes=nodes, gazebo_topics=topics))
        yield from self.plugin_parts(plugins, spawner)

    def plugin_parts(
        self, plugins: Iterable[GazeboPlugin], spawner: NodePart
    ) -> Iterator[NodePart]:
        """Yield a part for each of some plugins; `spawner` may be the server that loads a world."""
        for plugin in plugins:
            model = self.models.gazebo_plugin(plugin.filename)
            if model is not None:
                yield self._part(plugin, model, spawner)
            elif not plugin.filename.startswith(_SYSTEM_PREFIXES):
                what, cause = f"Gazebo plugin {plugin.filename}", UnresolvedCause.MISSING_CODE
                yield replace(spawner, model=None).with_missing_note(what, "no model of it", cause)

    def _part(self, plugin: GazeboPlugin, model: Model, spawner: NodePart) -> NodePart:
        """Return the part of a plugin's node; that of ros2_control hosts controllers."""
        spawner_namespace = option(spawner.node.site.args, "-robot_namespace") or ""
        rules, is_manager = _remap_rules(plugin), model.role is NodeRole.CONTROLLER_MANAGER
        node_name = (
            str(plugin.values.get(f"{_MANAGER}_name", _MANAGER)) if is_manager else plugin.name
        )
        try:
            settings = tuple(self._settings(plugin)) if is_manager else ()
        except InputError as error:
            what = f"parameters of {node_name}"
            return replace(spawner, model=None).with_missing_note(what, str(error))
        site = NodeSite(
            name=canonical_name(f"/{spawner_namespace or _namespace(plugin)}/{node_name}"),
            ros=2,
            environ=spawner.node.site.environ,
            settings=(USE_SIM_TIME, *settings),
            remaps=rules,
        )
        kind = (_MANAGER, "ros2_control_node") if is_manager else (PACKAGE, plugin.filename)
        node = replace(
            spawner.node,
            site=site,
            package=kind[0],
            type=kind[1],
            evidence=plugin.evidence,
            process_remap_rules=rules,
            container="",
        )
        interface = plugin_interface(
            model, site, plugin_element(plugin, spawner_namespace), self.models
        )
        return NodePart(
            node=node,
            owner=site.name,
            model=model,
            interface=interface.with_location(node.evidence),
        )

    def _settings(self, plugin: GazeboPlugin) -> Iterator[ParameterSetting]:
        paths = plugin.values.get("parameters", [])
        for path in paths if isinstance(paths, list) else [paths]:
            yield from parameter_file_settings(str(path).strip(), self.files)


def _parts(
    spawned: SpawnedModel,
) -> tuple[str, tuple[GazeboPlugin, ...], tuple[Sensor, ...]]:
    """Return the name of the robot, its plugins and its sensors."""
    root = parse_element(spawned.text, spawned.location.file)
    name = (root.find("model") or root).attributes.get("name", "")
    plugins, sensors = read_plugins(root), read_sensors(root)
    if not spawned.is_file:
        plugins = tuple(replace(each, evidence=spawned.location) for each in plugins)
        sensors = tuple(replace(each, evidence=spawned.location) for each in sensors)
    return name, plugins, sensors


def _ros_element(plugin: GazeboPlugin) -> Mapping[str, object]:
    ros = plugin.values.get("ros")
    return ros if isinstance(ros, dict) else plugin.values


def _namespace(plugin: GazeboPlugin) -> str:
    return str(_ros_element(plugin).get("namespace", "")).strip()


def _remap_rules(plugin: GazeboPlugin) -> tuple[RemapRule, ...]:
    remappings = _ros_element(plugin).get("remapping", [])
    words = [
        str(remapping).strip()
        for remapping in (remappings if isinstance(remappings, list) else [remappings])
    ]
    return tuple(
        rule for word in words for rule in parse_remap_rules(f"-r {word}", in_ros_args=True)
    )
